//! Layouts of tables in which a row or a column may be taken for another.

use furrow_measured::events::divisions;
use furrow_measured::lifetimes::Lifetimes;
use furrow_measured::volumes::{ReadOptions, Unit, Volumes};

fn read_with(table: &str, options: &ReadOptions) -> Volumes {
    let mut volumes = Volumes::default();
    volumes.read(table.as_bytes(), "t.csv", options).unwrap();
    volumes
}

fn read(table: &str) -> Volumes {
    read_with(table, &ReadOptions::default())
}

fn why(volumes: &Volumes) -> Vec<String> {
    volumes.skipped.iter().map(|skipped| format!("{}: {}", skipped.line, skipped.why)).collect()
}

/// As `furrow export` writes cells.
#[test]
fn chi_of_a_row_with_a_cell_and_its_mother_is_the_cells() {
    for name in ["name", "cell"] {
        let table = format!("{name},mother,chi,chi_signed\nP0,,0.18,0.18\nAB,P0,0.01,-0.01\nP1,P0,0.2,0.2\nEMS,P1,,\n");
        let volumes = read(&table);
        let chi: Vec<(&str, f64)> =
            volumes.divisions.iter().map(|division| (division.mother.as_str(), division.chi_signed)).collect();
        assert_eq!(chi, [("P0", 0.18), ("AB", -0.01), ("P1", 0.2)]);
        assert_eq!(why(&volumes), ["5: empty"]);
    }
}

#[test]
fn the_name_of_a_file_makes_no_row_a_summary() {
    for table in ["mother,chi\nP0,0.2\n", "mother,chi_signed\nP0,-0.2\n"] {
        let mut volumes = Volumes::default();
        volumes.read(table.as_bytes(), "mean.csv", &ReadOptions::default()).unwrap();
        assert_eq!((volumes.divisions.len(), why(&volumes)), (1, vec![]));
    }
}

#[test]
fn a_cell_without_a_mother_in_a_column_of_mothers_has_no_birth() {
    let table = "name,mother,birth_min,division_min\nAB,,0,16\nABa,AB,16,33\n";
    let lifetimes = Lifetimes::read(table.as_bytes(), "t.csv").unwrap();
    assert_eq!(lifetimes.cells.iter().map(|cell| (cell.cell.as_str(), cell.mean)).collect::<Vec<_>>(), [("ABa", 17.0)]);
    assert!(lifetimes.skipped[0].why.starts_with("no mother"), "{:?}", lifetimes.skipped);
}

#[test]
fn rows_of_a_grid_may_be_embryos() {
    for (heading, names) in [
        ("embryo", ["a", "b"]),
        ("Embryo ID", ["a", "b"]),
        ("Animal", ["a", "b"]),
        ("replicate", ["a", "b"]),
        ("strain", ["a:2", "b:3"]),
    ] {
        let volumes = read(&format!("{heading},AB,P1\na,600,400\nb,700,300\nMean,650,350\nS.E.M.,70,50\nn,2,2\n"));
        let found: Vec<(String, f64)> =
            divisions(&volumes).divisions.into_iter().map(|one| (one.embryo, one.chi_signed)).collect();
        assert_eq!(found, [(names[0].to_owned(), 0.2), (names[1].to_owned(), 0.4)], "{heading}");
        assert_eq!(
            why(&volumes),
            [4, 5, 6].map(|line| format!("{line}: a summary of other rows, which is no measurement"))
        );
    }
    let frames = read("embryo,frame,AB,P1\na,1,590,400\na,2,610,400\na,2,1,1\nb,1,700,300\n");
    assert_eq!(frames.embryos.iter().map(|embryo| embryo.cells[0].volume()).collect::<Vec<_>>(), [600.0, 700.0]);
    assert_eq!(
        why(&frames),
        ["4: a second volume of this cell in frame 2", "4: a second volume of this cell in frame 2"]
    );
    let groups = read("frame,group,AB,P1\n1,wt,590,400\n2,wt,610,400\n");
    assert_eq!((groups.embryos.len(), groups.embryos[0].group.as_str()), (1, "wt"));
}

#[test]
fn rows_of_a_grid_without_a_heading_are_frames_or_are_asked_for() {
    let frames = read(",AB,P1\nt1,590,400\nFrame 2,610,400\n00:03,600,400\n,600,400\n");
    assert_eq!((frames.embryos.len(), frames.used, frames.skipped_count), (1, 8, 0));
    let unknown = read(",AB,P1\n1,600,400\nemb2,700,300\nmean,650,350\n");
    assert_eq!(unknown.used, 2);
    assert_eq!(
        why(&unknown),
        [
            "3: may be an embryo or a frame: the column must be called embryo or frame",
            "4: a summary of other rows, which is no measurement"
        ]
    );
}

#[test]
fn summaries_in_other_tables_are_no_measurements() {
    let volumes = read("embryo,cell,volume\ne,AB,600\ne,P1,400\nmean,AB,600\nSD,AB,10\n");
    assert_eq!((volumes.embryos.len(), volumes.used, volumes.skipped_count), (1, 2, 2));
    let divided = read("embryo,mother,larger_um3,smaller_um3\ne,P0,600,400\nmean,P0,600,400\n");
    assert_eq!((divided.divisions.len(), divided.skipped_count), (1, 1));
    let lives = "embryo,cell,lifetime_min\n1,AB,16\nmean,AB,16\n";
    assert_eq!(Lifetimes::read(lives.as_bytes(), "t.csv").unwrap().skipped_count, 1);
}

/// The unit and the edges of voxels act on volumes without a unit, or are refused.
#[test]
fn units_and_voxels_that_are_given_say_something() {
    let voxel = ReadOptions { voxel: Some(0.5).into(), ..ReadOptions::default() };
    let voxels = ReadOptions { unit: Some(Unit::Voxels), ..voxel.clone() };
    let relative = ReadOptions { unit: Some(Unit::Relative), ..ReadOptions::default() };
    let size = |table: &str, options: &ReadOptions| {
        let volumes = read_with(table, options);
        let size = divisions(&volumes).divisions[0].mother_volume();
        (size, volumes.unit, volumes.require_options().err().map(|error| error.to_string()))
    };
    let without_unit = [
        "embryo,mother,larger,smaller\ne,P0,600,400\n",
        "embryo,cell,volume\ne,AB,600\ne,P1,400\n",
        ",AB,P1\n1,600,400\n",
    ];
    for table in without_unit {
        for options in [&voxel, &voxels] {
            assert_eq!(size(table, options), (125.0, Some(Unit::CubicMicrometres), None), "{table}");
        }
        assert_eq!(size(table, &relative), (1000.0, Some(Unit::Relative), None), "{table}");
    }
    let in_voxels = "embryo,mother,larger_voxels,smaller_voxels\ne,P0,600,400\n";
    assert_eq!(size(in_voxels, &voxel), (125.0, Some(Unit::CubicMicrometres), None));
    let no_unit =
        "--unit: unit = relative: must be left out: no volume of the tables is without a unit, or in this one";
    let no_voxel = "--voxel: voxel = (given): must be left out: no volume is in voxels, and no diameter in pixels";
    for table in ["embryo,cell,volume_um3\ne,AB,600\ne,P1,400\n", "mother,chi\nP0,0.2\n"] {
        assert_eq!(size(table, &relative).2.as_deref(), Some(no_unit));
        assert_eq!(size(table, &voxel).2.as_deref(), Some(no_voxel));
    }
    let same = ReadOptions { unit: Some(Unit::CubicMicrometres), ..ReadOptions::default() };
    assert_eq!(size("embryo,cell,volume_um3\ne,AB,600\ne,P1,400\n", &same).2, None);
}

#[test]
fn dates_and_names_do_not_say_how_volumes_are_written() {
    let doubtful = "may be 1.450 or 1450: no other number of its column says which";
    for table in [
        "embryo;date;cell;volume\n1.1;12.03;AB;1.450\n1.1;12.03;P1;1.017\n",
        "embryo;cell;volume\n1,1;AB;1.450\n1,1;P1;1.017\n",
    ] {
        assert_eq!(why(&read(table)).first().cloned().unwrap_or_default(), format!("2: {doubtful}"), "{table}");
    }
    // Other volumes do.
    let grid = read("frame;AB;P1\n1;1.450;1.017,5\n");
    assert_eq!(grid.embryos[0].cells[0].volume(), 1450.0);
    let chi = read("embryo;date;mother;larger;smaller\n1.1;12.03;P0;2.450;1.980,5\n");
    assert_eq!(chi.divisions[0].volumes, [2450.0, 1980.5]);
}

#[test]
fn embryos_of_lifetimes_have_many_headings() {
    for heading in ["Embryo ID", "Embryo_ID", "embryo_id", "Embryo No", "sample", "animal"] {
        let table = format!("cell,{heading},lifetime_min\nAB,1,16\nAB,2,17\n");
        let lifetimes = Lifetimes::read(table.as_bytes(), "t.csv").unwrap();
        assert_eq!(lifetimes.embryos.len(), 2, "{heading}");
    }
}

#[test]
fn lines_are_counted_with_any_line_ends() {
    for end in ["\n", "\r\n", "\r"] {
        let table = "embryo,cell,volume\n\ne,AB,x\n\n\ne,\"P1\n\",y\ne,P2,z".replace('\n', end);
        assert_eq!(why(&read(&table)), ["3: not a number", "6: not a number", "8: not a number"], "{end:?}");
    }
}

#[test]
fn tables_of_r_and_thousands_in_quotes_are_read() {
    for table in [
        "\"embryo\" \"cell\" \"volume_um3\"\n\"1\" \"e\" \"AB\" 14596\n\"2\" \"e\" \"P1\" 9904.5\n",
        "embryo,cell,volume_um3\ne,AB,\"14,596\"\ne,P1,\"9,904.5\"\n",
        "embryo,cell,volume_um3\ne,AB,14'596\ne,P1,9’904.5\n",
    ] {
        let volumes = read(table);
        assert_eq!(divisions(&volumes).divisions[0].volumes, [14596.0, 9904.5], "{table}");
    }
}

#[test]
fn columns_of_frames_have_many_headings() {
    for heading in ["frame_number", "Slice", "time_min", "Time (min)", "t_s", "time_step"] {
        let volumes = read(&format!("embryo,cell,{heading},volume\ne,AB,1,600\ne,AB,2,620\ne,P1,1,400\n"));
        assert_eq!((volumes.used, volumes.embryos[0].cells[0].volume()), (3, 610.0), "{heading}");
    }
}

/// A copy of a table adds nothing, if its embryos have the same names.
#[test]
fn divisions_of_another_table_are_used_once() {
    for table in
        ["embryo,mother,chi\n1,P0,0.2\n1,P1,0.3\n", "embryo,mother,larger_um3,smaller_um3\n1,P0,6,4\n1,P1,3,1\n"]
    {
        let mut volumes = Volumes::default();
        let options = ReadOptions::default();
        volumes.read(table.as_bytes(), "a.csv", &options).unwrap();
        let used = volumes.used;
        volumes.read(table.as_bytes(), "b.csv", &options).unwrap();
        assert_eq!((volumes.divisions.len(), volumes.used, volumes.skipped_count), (2, used, 2));
        let first = &volumes.skipped[0];
        assert_eq!((first.file.as_str(), first.line, first.value.as_str()), ("b.csv", 2, "P0"));
    }
    let unknown = divisions(&read("mother,chi\nP0,0.2\n")).keep_populations("--population", &["foo".to_owned()]);
    assert!(unknown.unwrap_err().to_string().ends_with("(a column population, group or condition)"));
}

#[test]
fn shares_may_be_in_per_cent() {
    let table = "dose,larger_share (%)\n1,59\n0.5,101\n";
    let doses = furrow_measured::dose::Doses::read(table.as_bytes(), "t.csv").unwrap();
    assert_eq!((doses.divisions[0].larger_share, doses.skipped_count), (0.59, 1));
}
