//! Headings, groups, summaries and missing values as people and their programs write them.

use furrow_measured::dose::Doses;
use furrow_measured::events::{divisions, summaries};
use furrow_measured::lifetimes::{Lifetimes, mean_volumes};
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
fn an_error_without_a_unit_has_the_unit_of_chi() {
    for sd in ["chi_sd", "chi_sd (%)"] {
        let division = read(&format!("embryo,mother,chi (%),{sd}\ne,P0,18,2\n")).unwrap().divisions.remove(0);
        assert_eq!((division.chi_signed, division.chi_sd), (0.18, Some(0.02)), "{sd}");
    }
    assert_eq!(found("embryo,mother,chi,chi_sd\ne,P0,0.18,2\n"), (vec![], vec!["2".to_owned()]));
}

#[test]
fn a_frame_occurs_once_in_a_grid_of_one_embryo() {
    let twice = read("frame,AB,P1\n1,14000,10000\n2,14400,10200\n1,12000,11000\n").unwrap();
    assert_eq!((twice.used, twice.skipped_count), (4, 2));
    assert_eq!(twice.skipped[0].why, "a second volume of this cell in frame 1");
    assert_eq!(read("time,AB,P1\n0:10,14000,10000\n0:20,14400,10200\n").unwrap().used, 4);
}

#[test]
fn generations_may_be_written_with_decimals() {
    let rows = "1,P0,6.0,9,6\n2,P0,6,8,6\n";
    let volumes = read(&format!("embryo,mother,generation,larger_um3,smaller_um3\n{rows}")).unwrap();
    assert_eq!((volumes.divisions.len(), &volumes.divisions[0].mother), (2, &volumes.divisions[1].mother));
}

#[test]
fn the_germ_cells_have_two_names() {
    let (volumes, chi) = (read("embryo,cell,volume_um3\ne,Z2,100\ne,P4a,110\n").unwrap(), 10.0 / 210.0);
    let division = &divisions(&volumes).divisions[0];
    assert!(division.mother == "P4" && (division.chi_signed - chi).abs() < 1e-12);
}

#[test]
fn a_row_of_lifetimes_is_of_one_embryo_or_of_many() {
    let table = "embryo,cell,lifetime_min,n\n1,ABa,17,3\n";
    let why = Lifetimes::read(table.as_bytes(), "t.csv").unwrap_err().to_string();
    assert!(why.ends_with("leave out one of the two columns"), "{why}");
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

#[test]
fn means_are_no_embryos_whatever_else_is_in_their_names() {
    for summary in [
        "Moyenne",
        "Écart-type",
        "Ecart type",
        "Médiane",
        "StdAbw",
        "Summe",
        "Promedio",
        "Mean value",
        "Mean of all",
        "Average of 2",
        "Control mean",
        "WT average",
        "Std Error",
        "CI95",
        "Geometric mean",
        "Grand Total",
        "Subtotal",
        "Row mean",
        "Pooled",
        "Number of embryos",
        "平均",
        "σ",
        "Gesamtergebnis",
        "Gesamt",
        "Durchschnitt",
        "合計",
        "標準偏差",
        "Totals",
        "Summary",
        "n = 3",
        "N=12",
    ] {
        let (groups, skipped) = found(&format!("embryo,AB,P1\ne1,14596,10120\ne2,14000,10000\n{summary},1,2\n"));
        assert_eq!((groups, skipped), (vec![of_group("", 0.174, 2)], vec![summary.to_owned()]));
    }
    let (groups, skipped) = found("embryo,group,AB,P1\ne1,wt,14596,10120\n,mean,14000,10000\n");
    assert_eq!((groups, skipped), (vec![of_group("wt", 0.181, 1)], vec!["mean".to_owned()]));
    let (groups, _) = found("embryo,group,AB,P1\ne1,all,14596,10120\n");
    assert_eq!(groups, [of_group("all", 0.181, 1)]);
}

#[test]
fn rows_with_another_replicate_are_of_another_embryo() {
    for columns in ["sample,replicate", "embryo,date", "embryo,movie"] {
        let table = format!("{columns},frame,cell,volume_um3\n1,1,1,AB,14000\n1,1,1,P1,7000\n1,2,2,AB,12000\n");
        let volumes = read(&table).unwrap();
        let why = &volumes.skipped[0].why;
        assert_eq!((volumes.used, volumes.skipped_count), (2, 1), "{columns}");
        assert!(why.contains("each needs a name of its own"), "{why}");
    }
    let table = "strain,treatment,embryo,mother,chi\nN2,ctrl,1,P0,0.1\nN2,heat,1,P0,0.3\n";
    assert_eq!(found(table), (vec![of_group("N2", 0.1, 1)], vec!["heat".to_owned()]));
    let lifetimes = "strain,treatment,cell,lifetime_min\nN2,ctrl,AB,17\nN2,heat,AB,27\n";
    let why = Lifetimes::read(lifetimes.as_bytes(), "t.csv").unwrap_err().to_string();
    assert!(why.contains("treatment on line 3, column 2 = \"heat\""), "{why}");
}

#[test]
fn a_second_heading_is_refused() {
    for table in [
        "frame,AB,P1\n1,14000,10000\n\nframe,ABa,ABp\n2,7000,6900\n",
        "embryo,cell,volume_um3\n1,AB,5\nembryo,cell,radius\n",
    ] {
        let why = read(table).unwrap_err();
        assert!(why.ends_with("another heading: each table needs a file of its own"), "{why}");
    }
    let table = "cell,lifetime_min\nAB,17\n\ncell,lifetime_s\nAB,1100\n";
    let why = Lifetimes::read(table.as_bytes(), "t.csv").unwrap_err().to_string();
    assert!(why.starts_with("t.csv:4:1: another heading"), "{why}");
}

#[test]
fn missing_ids_are_no_names() {
    let volumes = read("embryo,cell,volume_um3\nNaN,AB,14000\nnan,P1,7000\ne,AB,14596\ne,P1,10120\n").unwrap();
    assert_eq!((volumes.embryos.len(), volumes.skipped_count), (1, 2));
    let volumes = read("embryo,mother,chi\ne,NA,0.1\ne,P0,0.2\n").unwrap();
    assert_eq!((volumes.divisions.len(), &*volumes.skipped[0].why), (1, "no name of a mother"));
}

#[test]
fn columns_that_contradict_each_other_are_reported() {
    let chi = |table: &str| {
        let volumes = read(table).unwrap();
        let why = volumes.skipped.first().map_or(String::new(), |skipped| skipped.why.clone());
        (volumes.divisions.iter().map(|division| division.chi_signed).collect::<Vec<_>>(), why)
    };
    let (found, why) = chi("embryo,mother,chi,chi_signed\n1,P0,0.18,-0.18\n2,P0,0.17,0.2\n");
    assert_eq!((&found[..], &*why), (&[-0.18][..], "this χ is not the signed one without its sign, 0.2"));
    let (found, why) = chi("embryo,mother,chi,larger_um3,smaller_um3\n1,P0,0.5,14000,10000\n2,P0,0.167,14000,10000\n");
    assert_eq!((found.len(), &*why), (1, "this χ is not that of the volumes, 0.167"));
    let (_, why) = chi("embryo,cell,mother,volume_um3,chi\n1,AB,P0,14000,0.01\n");
    assert!(why.starts_with("not used: the table has χ"), "{why}");
    let lives = Lifetimes::read(
        &b"cell,lifetime_min,birth_h,division_h,censored\nP1,19.8,0,0.9,0\nAB,17,0,0.283,no\nEMS,9,0,,1\n"[..],
        "t.csv",
    )
    .unwrap();
    let why: Vec<&str> = lives.skipped.iter().map(|skipped| &*skipped.why).collect();
    let expected = ["not birth and lifetime together, 19.8 min", "censored: the cell was not seen to divide"];
    assert_eq!((lives.cells.len(), &why[..]), (1, &expected[..]));
}

#[test]
fn chi_has_a_sign_only_where_the_table_has() {
    let signed = |table: &str| {
        let events = &summaries(&divisions(&read(table).unwrap()).divisions)[0].events;
        events[0].mean_signed.map(|signed| (1e3 * signed).round() / 1e3)
    };
    assert_eq!(signed("embryo,mother,chi\n1,EMS,0.05\n2,EMS,0.07\n"), None);
    assert_eq!(signed("embryo,mother,larger_um3,smaller_um3\n1,EMS,60,40\n"), None);
    assert_eq!(signed("embryo,mother,chi_signed\n1,EMS,0.05\n2,EMS,0.07\n"), Some(0.06));
    assert_eq!(signed("embryo,mother,chi (%)\n1,EMS,−5\n2,EMS,7\n"), Some(0.01));
}

#[test]
fn headings_of_other_programs_have_units() {
    for (heading, volume) in [
        ("Volume..um3.", 5.0),
        ("vol_um3", 5.0),
        ("Cell volume (um^3)", 5.0),
        ("Volume (nL)", 5e6),
        ("Volume (10^3 µm^3)", 5e3),
    ] {
        let volumes = read(&format!("embryo,cell,{heading}\ne,AB,5\n")).unwrap();
        assert_eq!(volumes.embryos[0].cells[0].volume(), volume, "{heading}");
        assert_eq!(volumes.unit, Some(Unit::CubicMicrometres), "{heading}");
    }
    for heading in ["volume_pixels", "Volume (px)", "Volume (vx)"] {
        assert_eq!(read(&format!("embryo,cell,{heading}\ne,AB,5\n")).unwrap().unit, Some(Unit::Voxels), "{heading}");
    }
    let dates = read(",AB,P1\n2024-03-01,14000,7000\n2024-03-02,12000,11000\n").unwrap();
    assert_eq!((dates.used, dates.skipped_count), (0, 2));
    assert!(dates.skipped[0].why.starts_with("may be an embryo or a frame"), "{}", dates.skipped[0].why);
}

#[test]
fn doses_are_neither_logarithms_nor_summaries() {
    let doses = |table: &str| Doses::read(table.as_bytes(), "t.csv");
    for heading in ["log2_dose", "log_dose", "log10 dose", "ln_dosage"] {
        let why = doses(&format!("{heading},larger_share\n0,0.59\n1,0.62\n")).unwrap_err().to_string();
        assert!(why.contains("must have doses and not their logarithms"), "{why}");
    }
    let found = doses("condition,dose,larger_share\nwt,1,0.59\nmean,0.53,0.557\nSD,0.4,0.03\nn,3,0.9\n").unwrap();
    assert_eq!((found.divisions.len(), found.skipped_count), (1, 3));
    let found = doses("strain,Dose / %,larger_share\nwt,100,0.59\nmut,50,0.41\n").unwrap();
    assert_eq!((found.divisions[0].dose, &*found.divisions[0].condition, found.skipped_count), (1.0, "wt", 1));
}

#[test]
fn a_cell_without_a_volume_in_one_embryo_has_the_mean_of_the_others() {
    for table in [
        "embryo,AB,P1\na,600,400\nb,,300\n",
        "embryo,cell,volume,frame\na,AB,600,1\na,P1,400,1\nb,AB,600,one\nb,P1,300,1\n",
    ] {
        let means = mean_volumes(&read(table).unwrap());
        assert_eq!(means.into_iter().collect::<Vec<_>>(), [("AB".to_owned(), 600.0), ("P1".to_owned(), 350.0)]);
    }
}
