//! Headings, groups, summaries and missing values as people and their programs write them.

use furrow_measured::events::{divisions, summaries};
use furrow_measured::lifetimes::Lifetimes;
use furrow_measured::volumes::{ReadOptions, Unit, Volumes};

fn read(table: &str) -> Result<Volumes, String> {
    let mut volumes = Volumes::default();
    let read = volumes.read(table.as_bytes(), "t.csv", &ReadOptions::default());
    read.map(|()| volumes).map_err(|error| error.to_string())
}

/// The groups with their mean χ of P0 and its number, and the values that were skipped.
fn found(table: &str) -> (Vec<(String, f64, usize)>, Vec<String>) {
    let volumes = read(table).unwrap();
    let groups = summaries(&divisions(&volumes).divisions).into_iter().flat_map(|group| {
        let of_p0 = group.events.into_iter().filter(|event| event.mother == "P0");
        of_p0.map(move |event| (group.group.clone(), (1e3 * event.mean).round() / 1e3, event.n)).collect::<Vec<_>>()
    });
    (groups.collect(), volumes.skipped.iter().map(|skipped| skipped.value.clone()).collect())
}

fn of_group(group: &str, chi: f64, n: usize) -> (String, f64, usize) {
    (group.to_owned(), chi, n)
}

#[test]
fn rows_that_spreadsheets_and_programs_add_are_no_embryos() {
    let rows = "e1,14596,10120\ne2,14000,10000\n";
    for summaries in [
        &["count", "mean", "std", "min", "25%", "50%", "75%", "max"][..],
        &[
            "Number of values",
            "Minimum",
            "25% Percentile",
            "Maximum",
            "Mean",
            "Std. Deviation",
            "Std. Error of Mean",
            "Range",
        ],
        &[
            "Mode",
            "Sample Variance",
            "Kurtosis",
            "Skewness",
            "Confidence Level(95.0%)",
            "Sum",
            "Count",
            "Standard Error",
        ],
        &["Min.", "1st Qu.", "Median", "Mean", "3rd Qu.", "Max.", "Lower 95% CI of mean", "p value"],
    ] {
        let table: String = summaries.iter().map(|name| format!("{name},14000,10000\n")).collect();
        let (groups, skipped) = found(&format!("embryo,AB,P1\n{rows}{table}"));
        assert_eq!(groups, [of_group("", 0.174, 2)]);
        assert_eq!(skipped, summaries);
    }
    // Embryos may be called so.
    let (groups, skipped) = found("embryo,AB,P1\nmax3,14596,10120\n25,14000,10000\n1st,14000,10000\n");
    assert_eq!((groups[0].2, skipped.len()), (3, 0));
}

#[test]
fn numbers_under_a_heading_may_be_embryos() {
    let rows = "1,14596,10120\n2,12500,12200\n";
    for heading in ["Embryo #", "embryos", "Emb", "Specimen"] {
        let (groups, _) = found(&format!("{heading},AB,P1\n{rows}"));
        assert_eq!(groups, [of_group("", 0.097, 2)], "{heading}");
    }
    for heading in ["", "Unnamed: 0", "index", "#", "frame", "Time (min)"] {
        let (groups, _) = found(&format!("{heading},AB,P1\n{rows}"));
        assert_eq!(groups, [of_group("", 0.097, 1)], "{heading}");
    }
    for heading in ["movie", "dataset", "id", "Date"] {
        let volumes = read(&format!("{heading},AB,P1\n{rows}")).unwrap();
        assert_eq!(volumes.used, 0, "{heading}");
        assert!(volumes.skipped[0].why.contains("must be called embryo or frame"), "{heading}");
    }
    // NumPy writes headings as comments; a first column that is no cell is not passed over.
    assert_eq!(found("# AB,P1\n14596,10120\n").0, [of_group("", 0.181, 1)]);
    assert_eq!(read("ab,P1\n14596,10120\n").unwrap().used, 0);
}

#[test]
fn groups_have_the_same_names_in_all_layouts() {
    for heading in ["group", "condition", "strain", "genotype", "treatment"] {
        let expected = [of_group("wt", 0.181, 1), of_group("par-2", 0.004, 1)];
        for table in [
            format!("embryo,{heading},AB,P1\nw,wt,14596,10120\nm,par-2,12400,12300\n"),
            format!("embryo,{heading},cell,volume\nw,wt,AB,14596\nw,wt,P1,10120\nm,par-2,AB,12400\nm,par-2,P1,12300\n"),
            format!("embryo,{heading},mother,larger_um3,smaller_um3\nw,wt,P0,14596,10120\nm,par-2,P0,12400,12300\n"),
            format!("embryo,{heading},mother,chi\nw,wt,P0,0.181\nm,par-2,P0,0.004\n"),
        ] {
            assert_eq!(found(&table).0, expected, "{table}");
        }
        let lifetimes = format!("embryo,{heading},cell,lifetime_min\nw,wt,AB,17.9\nm,mut,AB,27.9\n");
        let error = Lifetimes::read(lifetimes.as_bytes(), "t.csv").unwrap_err().to_string();
        assert!(
            error.starts_with(&format!("t.csv: {heading} on line 3, column 2 = \"mut\": must be \"wt\", the group")),
            "{error}"
        );
    }
    // Spreadsheets leave merged fields empty but for the first.
    let (groups, skipped) = found("embryo,group,AB,P1\ne1,wt,14596,10120\ne2,,14000,10000\n");
    assert_eq!((groups, skipped.len()), (vec![of_group("wt", 0.181, 1)], 1));
    // A column of groups may be empty.
    assert_eq!(found("embryo,group,AB,P1\ne1,,14596,10120\n").0, [of_group("", 0.181, 1)]);
}

#[test]
fn units_are_read_from_their_column_under_any_heading() {
    for (unit, size) in [("pL", 1e3), ("um3", 1.0)] {
        for heading in ["unit", "units", "volume_unit", "Volume units"] {
            let long = read(&format!("embryo,cell,volume,{heading}\ne,AB,14.596,{unit}\n")).unwrap();
            assert!((long.embryos[0].cells[0].volume() / (14.596 * size) - 1.0).abs() < 1e-12, "{heading}");
            let of_divisions = format!("embryo,mother,larger,smaller,{heading}\ne,P0,14.596,10.12,{unit}\n");
            let first = &read(&of_divisions).unwrap().divisions[0];
            assert!((first.volumes[0] / (14.596 * size) - 1.0).abs() < 1e-12, "{heading}");
        }
    }
    let voxels = read("embryo,mother,larger,smaller,unit\ne,P0,1459600,1012000,voxels\n").unwrap();
    assert_eq!(voxels.unit, Some(Unit::Voxels));
    let error = read("embryo,cell,volume_um3,unit\ne,AB,14.596,pL\n").unwrap_err();
    assert!(
        error.contains("\"pL\": must be um3, the unit of the heading") || error.contains("pL: must be um3"),
        "{error}"
    );
    for table in ["time,AB,P1\nmin,pL,pL\n0,14.596,10.120\n", "embryo,cell,volume\n,,(pL)\ne,AB,14.596\n"] {
        let error = read(table).unwrap_err();
        assert!(error.starts_with("t.csv:2:1: ") && error.contains("is a unit: it must be in the heading"), "{error}");
    }
}

#[test]
fn values_that_are_not_there_are_written_in_many_ways() {
    for absent in ["NA", "nan", "None", "-", "N/A", ""] {
        let table = format!("embryo,mother,chi,chi_sd,mother_um3\ne,P0,0.18,{absent},{absent}\n");
        let division = &read(&table).unwrap().divisions[0];
        assert_eq!((division.chi_sd, division.mother_measured), (None, None), "{absent}");
        let births = format!("cell,mother,birth_min,division_min\nAB,{absent},12,17.9\nABa,AB,17.9,36\n");
        let lifetimes = Lifetimes::read(births.as_bytes(), "t.csv").unwrap();
        assert_eq!((lifetimes.cells.len(), lifetimes.skipped_count), (1, 1), "{absent}");
    }
}

#[test]
fn a_minimum_is_not_a_time_in_minutes() {
    let table = "cell,lifetime_mean,lifetime_min,lifetime_max\nABa,1074,966,1164\n";
    let error = Lifetimes::read(table.as_bytes(), "t.csv").unwrap_err().to_string();
    let why = "t.csv:1:1: column 3, \"lifetime_min\", may be the minimum or in minutes beside \"lifetime_mean\": call it lifetime (min)";
    assert_eq!(error, why);
    let clear = "cell,lifetime_mean,lifetime (min)\nABa,1074,16\n";
    assert_eq!(Lifetimes::read(clear.as_bytes(), "t.csv").unwrap().cells[0].mean, 16.0);
}
