//! Tables of volumes as people write them.

use furrow_measured::dose::{Doses, by_condition, by_dose};
use furrow_measured::events::{Division, divisions, summaries};
use furrow_measured::names::{NamedFounder, Names};
use furrow_measured::per_embryo::PerEmbryo;
use furrow_measured::trend::{adjacent_tests, volume_bins};
use furrow_measured::volumes::{ReadOptions, Unit, Volumes};

fn read_as(file: &str, table: impl AsRef<[u8]>, options: &ReadOptions) -> Volumes {
    let mut volumes = Volumes::default();
    volumes.read(table.as_ref(), file, options).unwrap();
    volumes
}

fn read(table: impl AsRef<[u8]>) -> Volumes {
    read_as("t.csv", table, &ReadOptions::default())
}

fn refused(table: impl AsRef<[u8]>) -> String {
    Volumes::default().read(table.as_ref(), "t.csv", &ReadOptions::default()).unwrap_err().to_string()
}

fn skipped(table: &str) -> Vec<String> {
    let volumes = read(table);
    assert_eq!(volumes.skipped_count as usize, volumes.skipped.len());
    volumes.skipped.iter().map(|s| format!("{}:{}: {} = {:?}: {}", s.file, s.line, s.column, s.value, s.why)).collect()
}

/// A table of χ may have the error of each χ and the volume of each mother, as a spreadsheet may call it.
#[test]
fn a_table_of_chi_may_have_errors_and_volumes_of_mothers() {
    let text = "embryo,mother,chi,sd,V_mother_um3\ne,P0,0.18,0.02,25000\ne,P1,0.17,,\ne,P2,0.4,-1,4000\n";
    let volumes = read(text);
    let found: Vec<_> = volumes.divisions.iter().map(|d| (d.mother.as_str(), d.chi_sd, d.mother_measured)).collect();
    assert_eq!(found, [("P0", Some(0.02), Some(25000.0)), ("P1", None, None)]);
    assert_eq!((volumes.skipped_count, volumes.unit), (1, Some(Unit::OfMother)));
    let both = "mother,chi,sd,chi_sd\nP0,0.1,0.1,0.1\n";
    let refusal = refused(both);
    assert!(refusal.contains("both have the standard deviation of χ"), "{refusal}");
}

#[test]
fn columns_may_stand_in_any_order_and_groups_are_kept_apart() {
    let table = "n,group,volume,cell,embryo,remark\n3,wt,60,AB,e1,x\n3,wt,40,P1,e1,\n1,hot,50,P1,e1,\n1,hot,50,AB,e1,\n,wt,58,AB,e2,\n,wt,42,P1,e2,\n";
    let volumes = read(table);
    assert_eq!((volumes.used, volumes.unit), (6, Some(Unit::CubicMicrometres)));
    let groups = summaries(&divisions(&volumes).divisions);
    let names: Vec<(&str, usize)> = groups.iter().map(|group| (group.group.as_str(), group.embryos)).collect();
    assert_eq!(names, [("wt", 2), ("hot", 1)]);
    let p0 = &groups[0].events[0];
    assert_eq!((p0.mother.as_str(), p0.n), ("P0", 2));
    assert!((p0.mean - 0.18).abs() < 1e-15 && (p0.sd.unwrap() - 0.0282842712474619).abs() < 1e-14);
    assert_eq!((groups[1].events[0].mean, groups[1].events[0].sd), (0.0, None));
}

#[test]
fn the_sign_follows_the_daughter_named_first() {
    let volumes = read(b"embryo,cell,relative_volume\ne,ABal,0.04\ne,ABar,0.06\ne,C,0.03\ne,P3,0.01\n");
    let found = divisions(&volumes).divisions;
    let of = |mother: &str| found.iter().find(|division| division.mother == mother).unwrap().chi_signed;
    assert!((of("ABa") + 0.2).abs() < 1e-15);
    assert!((of("P2") - 0.5).abs() < 1e-15);
    assert_eq!(volumes.unit, Some(Unit::Relative));
}

#[test]
fn frames_are_averaged_and_grids_are_read() {
    let long = read(b"embryo,cell,frame,volume_um3\ne,AB,1,10\ne,AB,2,14\ne,P1,2,8\n");
    assert_eq!(long.embryos[0].cells.iter().map(|cell| cell.volume()).collect::<Vec<_>>(), [12.0, 8.0]);
    let options = ReadOptions { voxel: Some(0.25).into(), ..ReadOptions::default() };
    let grid = read_as("data/Sample04_Volume.csv", ",AB,P1,Nuc3\n1,640,,7\n2,1280,320,\n3,,320,\n", &options);
    assert_eq!(grid.embryos[0].name, "Sample04");
    assert_eq!(grid.embryos[0].cells.iter().map(|cell| cell.volume()).collect::<Vec<_>>(), [15.0, 5.0]);
    assert_eq!((grid.used, grid.skipped_count, grid.unit), (4, 1, Some(Unit::CubicMicrometres)));
}

#[test]
fn unusable_values_are_reported_with_their_place() {
    let table = "embryo,cell,volume,frame\ne,AB,10,1\ne,Ab,10,1\ne,P1,,1\ne,P1,-3,1\ne,P1,0,1\ne,P1,1e999,1\ne,P1,ten,1\n,P1,3,1\ne,AB,11,1\ne,P1,3,one\ne\n";
    assert_eq!(skipped(table).join("\n"), include_str!("data/skipped.txt").trim_end());
    assert_eq!(
        skipped("embryo,cell,volume\ne,AB,10\ne,AB,10\n"),
        ["t.csv:3: 2 (cell) = \"AB\": a second volume of this cell, without a frame; the first is on line 2"]
    );
}

#[test]
fn marks_line_ends_and_separators_of_other_programs_are_read() {
    let plain = read(b"embryo,cell,volume\ne,AB,60\ne,P1,40\n");
    for table in [
        &b"\xef\xbb\xbfembryo,cell,volume\r\ne,AB,60\r\ne,P1,40\r\n"[..],
        b"Embryo;Cell;Volume\ne;AB;60\ne;P1;40",
        b"embryo\tcell\tvolume\n\"e\"\tAB\t 60 \n\ne\tP1\t40\n",
    ] {
        let found = read(table);
        assert_eq!(divisions(&found).divisions, divisions(&plain).divisions);
        assert_eq!(found.skipped_count, 0);
    }
}

#[test]
fn other_tables_than_of_volumes_are_refused() {
    for (table, expected) in [
        (&b""[..], "t.csv:1:1: the table is empty"),
        (b"cell,volume\nAB,1\n", "no column is called embryo"),
        (b"x,y\n1,2\n", "no column is called cell or volume or embryo"),
        (b"embryo,cell,volume,cell\n", "two columns are called \"cell\""),
        (b"\xff\xfee\0", "this is UTF-16"),
        (
            b"embryo,cell,volume,unit\ne,AB,1,um3\ne,P1,1,pints\n",
            "unit on line 3, column 4 = pints: must be one of um3",
        ),
        (b"embryo,cell,volume,unit\ne,AB,1,um3\ne,P1,1,voxels\n", "must be µm³, the unit of the rows before"),
    ] {
        let said = refused(table);
        assert!(said.contains(expected), "{said}");
    }
    let mut volumes = read(b"embryo,cell,volume_um3\ne,AB,60\n");
    let said = volumes.read(&b"embryo,cell,relative_volume\nf,AB,0.6\n"[..], "u.csv", &ReadOptions::default());
    assert!(said.unwrap_err().to_string().starts_with("u.csv: unit = relative: must be µm³"));
}

#[test]
fn very_wide_tables_and_very_long_names_are_read_in_passing() {
    let header: String = (0..200_000).map(|k| format!(",x{k}")).collect();
    let said = refused(format!("{header}\n1\n"));
    assert!(said.contains("and 199993 more"), "{said}");
    let long = "a".repeat(1_000_000);
    assert_eq!(
        read(format!("embryo,cell,volume\ne,AB{long},1\n")).skipped[0].why,
        "no name of Sulston's; other names need the file of their lineage (--lineage), or to be matched (--names, --root)"
    );
}

#[test]
fn divisions_with_one_daughter_are_reported() {
    let found = divisions(&read(b"embryo,cell,volume\ne,AB,60\ne,ABa,30\ne,ABp,31\n"));
    assert_eq!(found.divisions.len(), 1);
    assert_eq!(found.half_seen.len(), 1);
    assert_eq!((found.half_seen[0].mother.as_str(), found.half_seen[0].missing.as_str()), ("P0", "P1"));
}

#[test]
fn bins_are_decades_from_the_largest_cells_to_the_smallest() {
    let mut table = "embryo,cell,volume\n".to_owned();
    for (k, chi) in [0.30, 0.35, 0.42].into_iter().enumerate() {
        // Mothers of 10000 exactly, which belong to the decade above, and of 900.
        table += &format!("e{k},AB,{}\ne{k},P1,{}\n", 5000.0 + 100.0 * k as f64, 5000.0 - 100.0 * k as f64);
        table += &format!("e{k},MSa,{}\ne{k},MSp,{}\n", 450.0 * (1.0 + chi), 450.0 * (1.0 - chi));
    }
    let bins = volume_bins(&divisions(&read(&table)).divisions, None);
    let names: Vec<(String, usize)> = bins.iter().map(|bin| (bin.name(), bin.n)).collect();
    assert_eq!(names, [("10000..100000".to_owned(), 3), ("100..1000".to_owned(), 3)]);
    let tests = adjacent_tests(&bins);
    assert_eq!((tests[0].test.u, tests[0].test.p, tests[0].stars), (9.0, 0.05, "*"));
    let own = volume_bins(&divisions(&read(&table)).divisions, Some(&[0.0, 901.0]));
    assert_eq!((own.len(), own[0].n), (1, 3));
}

/// A decimal comma in a table that commas separate shifts the columns of its row.
#[test]
fn rows_longer_than_the_heading_are_not_used() {
    let why = "line 2 has 4 fields, the heading 3";
    for table in [
        "embryo,cell,volume_um3\ne,AB,14,5\ne,P1,9\n",
        "embryo,cell,volume_um3,,\ne,AB,14,5,\ne,P1,9,,\n",
        "embryo,mother,larger_um3,smaller_um3\ne,P0,14,5,9,9\ne,AB,60,40\n",
        "mother,embryo,chi\nP0,e,0,2\nAB,e,0.1\n",
        ",AB,P1\n1,14,5,9\n2,14,9\n",
    ] {
        let said = skipped(table);
        assert_eq!(said.len(), 1, "{table}");
        assert!(
            said[0].ends_with(why) || said[0].contains(": line 2 has ") && said[0].contains(" fields, the heading "),
            "{said:?}"
        );
    }
    let said = skipped("embryo,,cell,volume\ne,5,AB,14\ne,,P1,9\n");
    assert_eq!(said, ["t.csv:2: 2 () = \"5\": line 2 has a value in column 2, which has no name"]);
    let doses = Doses::read(&b"dose,larger_share\n1,0,57\n1,0.6\n"[..], "d.csv").unwrap();
    assert_eq!((doses.divisions.len(), &*doses.skipped[0].why), (1, "line 2 has 3 fields, the heading 2"));
}

#[test]
fn empty_columns_and_rows_and_numbers_of_rows_are_ignored() {
    let plain = divisions(&read(b"embryo,cell,volume\ne,AB,60\ne,P1,40\n")).divisions;
    for table in [
        ",,,,\nembryo,cell,volume,,\ne,AB,60,,\n,,,,\ne,P1,40,,\n , ,,,\n",
        "embryo,,cell,,volume\ne,,AB,,60\ne,,P1,,40\n",
        ",embryo,cell,volume\n0,e,AB,60\n1,e,P1,40\n",
        "Unnamed: 0.1,Unnamed: 0,embryo,cell,volume\n0,0,e,AB,60\n1,1,e,P1,40\n",
    ] {
        let found = read(table);
        assert_eq!((divisions(&found).divisions, found.skipped_count), (plain.clone(), 0), "{table}");
    }
    let grid = read(b",frame,AB,P1,,\n0,1,60,40,,\n,,,,,\n");
    assert_eq!((grid.used, grid.skipped_count), (2, 0));
}

#[test]
fn units_in_headings_and_columns_are_read_in_any_writing() {
    let micrometres = |table: &[u8]| {
        let found = read(table);
        assert_eq!((found.unit, found.skipped_count), (Some(Unit::CubicMicrometres), 0));
        found.embryos[0].cells[0].volume()
    };
    for heading in [
        &b"Volume (\xc2\xb5m\xc2\xb3)"[..],
        b"Volume [\xce\xbcm^3]",
        b"volume (\xb5m\xb3)",
        b"volume_um3",
        b"Mean volume / \xb5m\xb3",
        b"volume (fL)",
    ] {
        let table = [&b"embryo,cell,"[..], heading, b"\ne,AB,0.6\ne,P1,0.4\n"].concat();
        assert_eq!(micrometres(&table), 0.6, "{}", String::from_utf8_lossy(heading));
    }
    assert_eq!(micrometres(b"embryo,cell,Volume (pL)\ne,AB,0.6\n"), 600.0);
    assert_eq!(micrometres(b"embryo,cell,volume,unit\ne,AB,0.6,\xb5m\xb3\ne,P1,0.4,\xce\xbcm3\n"), 0.6);
    let divided = read(b"embryo,mother,Mother (um3),Larger (\xb5m\xb3),Smaller (\xb5m\xb3)\ne,P0,100,60,40\n");
    assert_eq!((divided.divisions[0].mother_measured, divided.unit), (Some(100.0), Some(Unit::CubicMicrometres)));
    let said = refused(b"embryo,cell,Volume (pints)\ne,AB,1\n");
    assert!(said.contains("\"Volume (pints)\", must be one of um3, pl, nl, mm3, nm3, voxels, relative, %"), "{said}");
    // Names in the same encoding stay apart.
    let groups = read(b"embryo,cell,volume,group\ne,AB,60,\xe4\ne,AB,60,\xf6\n");
    assert_eq!(groups.embryos.iter().map(|embryo| &*embryo.group).collect::<Vec<_>>(), ["ä", "ö"]);
}

#[test]
fn a_grid_can_be_in_cubic_micrometres() {
    let unit = |table: &str, options: &ReadOptions| {
        let volumes = read_as("Sample04_Volume.csv", table, options);
        assert_eq!(volumes.skipped_count, 0);
        (volumes.unit.unwrap(), volumes.embryos[0].cells[0].volume())
    };
    let plain = ReadOptions::default();
    let counted = ",AB,P1\n1,640,320\n";
    assert_eq!(unit(counted, &plain), (Unit::Voxels, 640.0));
    // Voxels are counted: a number with decimals is a volume.
    assert_eq!(unit(",AB,P1\n1,640.5,320\n", &plain), (Unit::CubicMicrometres, 640.5));
    assert_eq!(unit(",AB,P1\n1,0.6,0.4\n", &plain), (Unit::Relative, 0.6));
    for table in [",AB (\u{3bc}m\u{b3}),P1 (\u{3bc}m\u{b3})\n1,640,320\n", "frame (um3),AB,P1\n1,640,320\n"] {
        let options = ReadOptions { voxel: Some(0.25).into(), ..ReadOptions::default() };
        assert_eq!(unit(table, &options), (Unit::CubicMicrometres, 640.0));
    }
    let given = ReadOptions { unit: Some(Unit::CubicMicrometres), ..ReadOptions::default() };
    assert_eq!(unit(counted, &given), (Unit::CubicMicrometres, 640.0));
    assert!(refused(b",AB (pints),P1\n1,640,320\n").contains("must be one of um3"));
    assert!(refused(b",AB (um3),P1 (voxels)\n1,640,320\n").contains("must be the unit of the columns before"));
}

/// A quotation mark that is never closed would take in all that follows.
#[test]
fn a_row_without_an_end_is_refused() {
    let endless = std::io::Read::chain(&b"embryo,cell,volume\ne,AB,\""[..], std::io::repeat(b'7'));
    let said = Volumes::default().read(endless, "t.csv", &ReadOptions::default()).unwrap_err().to_string();
    assert!(said.contains("a row is longer than 16 MB"), "{said}");
}

proptest::proptest! {
    #[test]
    fn no_bytes_break_it(bytes in proptest::collection::vec(proptest::prelude::any::<u8>(), 0..300)) {
        let _ = Volumes::default().read(&bytes[..], "t.csv", &ReadOptions::default());
        let mut table = b"embryo,cell,volume,frame,n,unit\ne,AB,".to_vec();
        table.extend(bytes);
        let mut volumes = Volumes::default();
        if volumes.read(&table[..], "t.csv", &ReadOptions::default()).is_ok() {
            let _ = volume_bins(&divisions(&volumes).divisions, None);
        }
    }
}

#[test]
fn a_long_table_in_descending_frames_is_read() {
    // A sorted list with insertions at its front took minutes for these.
    let rows: String = (0..400_000).rev().map(|frame| format!("e,AB,{frame},10\n")).collect();
    let volumes = read(format!("embryo,cell,frame,volume_um3\n{rows}e,AB,7,10\n"));
    assert_eq!((volumes.used, volumes.skipped_count), (400_000, 1));
    assert!(volumes.skipped[0].why.contains("a second volume of this cell in frame 7"));
}

/// A grid may begin with a cell, and a quote that is not closed must not swallow the cells below it.
#[test]
fn no_cell_of_a_table_is_lost() {
    let grid = read(b"AB,P1,ABa,ABp\n14500,9900,7000,7100\n");
    assert_eq!((grid.used, grid.skipped_count, divisions(&grid).divisions.len()), (4, 0, 2));
    let table = b"embryo,cell,volume,note\ne,AB,59,ok\ne,P1,41,\"5 inch\ne,ABa,30,x\ne,ABp,29,x\n";
    let error = refused(table);
    assert!(error.starts_with("t.csv:3") && error.contains("a quote that opens in this row is not closed"), "{error}");
    for table in [
        "embryo,cell,volume_um3,note\ne1,AB,59,\ne1,P1,41,\"late\ne2,AB,60,\ne2,P1,40,\"late\n",
        "embryo,cell,volume_um3\ne1,AB,59\n\",P1,41\ne2,AB,60\n\",P1,40\n",
    ] {
        let error = refused(table);
        assert!(error.starts_with("t.csv:3") && error.contains("has what may be a row"), "{error}");
    }
    let notes = read(b"embryo,cell,volume_um3,note\ne1,AB,59,\"late,\nthen early\"\ne1,P1,41,\"5\"\" long\"\n");
    assert_eq!((notes.used, notes.skipped_count), (2, 0));
}

/// Numbers of embryos begin again in every table, group and class.
#[test]
fn embryos_of_one_name_are_told_apart() {
    let of_files = |tables: &[(&str, &str)]| {
        let mut volumes = Volumes::default();
        for (file, table) in tables {
            volumes.read(table.as_bytes(), file, &ReadOptions::default()).unwrap();
        }
        volumes
    };
    let names = |volumes: &Volumes| volumes.embryos.iter().map(|embryo| embryo.name.clone()).collect::<Vec<_>>();
    let head = "embryo,frame,cell,volume_um3\n";
    let [monday, tuesday] = ["1,1,AB,60\n1,1,P1,40\n", "1,2,AB,55\n1,2,P1,45\n"].map(|rows| format!("{head}{rows}"));
    let others = of_files(&[("mon/a.csv", &monday), ("tue/b.csv", &tuesday)]);
    assert_eq!((names(&others), divisions(&others).divisions.len()), (vec!["a/1".to_owned(), "b/1".to_owned()], 2));
    let alike = of_files(&[("mon/a.csv", &monday), ("tue/a.csv", &tuesday)]);
    assert_eq!(names(&alike), ["mon/a/1", "tue/a/1"]);
    let parts = of_files(&[("a.csv", &monday), ("b.csv", "embryo,frame,cell,volume_um3\n1,3,ABa,30\n1,3,ABp,30\n")]);
    assert_eq!((names(&parts), divisions(&parts).divisions.len(), parts.skipped_count), (vec!["1".to_owned()], 2, 0));
    let repeated = of_files(&[("a.csv", &monday), ("copy.csv", &monday)]);
    assert_eq!((names(&repeated), repeated.used, repeated.skipped_count), (vec!["1".to_owned()], 2, 2));
    let third =
        of_files(&[("a.csv", &monday), ("copy.csv", &monday), ("b.csv", "embryo,cell,volume_um3\n2,P1,45\n2,AB,55\n")]);
    assert_eq!((names(&third), divisions(&third).divisions.len()), (vec!["1".to_owned(), "2".to_owned()], 2));
    let grids = ["frame,AB,P1\n1,600,400\n", "frame,AB,P1\n1,550,450\n"];
    let grids = of_files(&[("mon/S1_Volume.csv", grids[0]), ("tue/S1_Volume.csv", grids[1])]);
    assert_eq!(names(&grids), ["mon/S1", "tue/S1"]);

    let chi = ["embryo,mother,chi_signed\n1,P0,0.18\n", "embryo,mother,chi_signed\n1,P0,0.05\n1,AB,0.01\n"];
    let chi = of_files(&[("a.csv", chi[0]), ("b.csv", chi[1])]);
    let embryos: Vec<&str> = chi.divisions.iter().map(|division| division.embryo.as_str()).collect();
    assert_eq!(embryos, ["a/1", "b/1", "b/1"]);
    let groups = read(b"group,embryo,mother,chi_signed\nwt,1,P0,0.18\nwt,2,P0,0.20\nmut,1,P0,0.05\nmut,2,P0,0.01\n");
    assert_eq!((groups.divisions.len(), groups.skipped_count), (4, 0));
    let hint = "a second division of this cell; the first is on line 2 (a column embryo tells embryos apart)";
    assert_eq!(read(b"mother,chi\nP0,0.1\nP0,0.2\n").skipped[0].why, hint);
}

#[test]
fn classes_that_read_alike_are_not_pooled() {
    let options = ReadOptions { class: vec!["stage".to_owned(), "generation".to_owned()], ..ReadOptions::default() };
    let table =
        b"embryo,mother,stage,generation,larger_um3,smaller_um3\n1,a,1,12,60,40\n1,b,11,2,90,10\n1,c,1,12,55,45\n";
    let volumes = read_as("t.csv", table, &options);
    assert_eq!(volumes.divisions.len(), 2);
    assert_eq!(volumes.skipped[0].why, "the class 112 is 11 + 2 here and 1 + 12 before");
}

#[test]
fn times_with_units_are_frames() {
    for heading in ["Time (min)", "t", "timepoint", "Time / h", "frame"] {
        let table =
            format!("embryo,cell,{heading},volume_um3\ne,AB,0,14000\ne,AB,1,15000\ne,P1,0,10000\ne,P1,1,9000\n");
        let volumes = read(table);
        assert_eq!((volumes.skipped_count, volumes.embryos[0].cells[0].volume()), (0, 14500.0), "{heading}");
    }
}

#[test]
fn decimal_commas_are_read_where_they_do_not_separate_columns() {
    let chi = |table: &[u8]| {
        let volumes = read(table);
        assert_eq!(volumes.skipped_count, 0);
        divisions(&volumes).divisions[0].chi_signed
    };
    let expected = (1014.5 - 509.9) / (1014.5 + 509.9);
    assert_eq!(chi(b"embryo,cell,volume_um3\ne1,AB,1014.5\ne1,P1,509.9\n"), expected);
    for table in [
        "embryo;cell;volume_um3\ne1;AB;1014,5\ne1;P1;509,9\n",
        "embryo\tcell\tvolume_um3\ne1\tAB\t1.014,5\ne1\tP1\t509,9\n",
        "sep=;\nembryo;cell;volume_um3\ne1;AB;1014,500\ne1;P1;509,900\n",
    ] {
        assert_eq!(chi(table.as_bytes()), expected, "{table}");
    }
    let volumes = read(b"embryo,cell,volume\ne,AB,\"60,5\"\ne,P1,\"40,2\"\n");
    let said = volumes.require_used("t.csv").unwrap_err().to_string();
    assert!(said.contains("none used, 2 skipped") && said.contains("decimals need a point"), "{said}");
    let doubtful = skipped("embryo;cell;volume\ne;AB;1,017\ne;P1;2,345\n");
    assert_eq!(
        doubtful[0],
        "t.csv:2: 3 (volume) = \"1,017\": may be 1.017 or 1017: no other number of its column says which"
    );
    // pandas names the column that a cut decimal comma makes.
    let cut = skipped("embryo,cell,volume,Unnamed: 3\ne,AB,14,5\ne,P1,9,9\n");
    assert!(cut[0].contains("has 4 fields, the heading 3"), "{cut:?}");
    assert!(read(b"embryo,cell,volume\n").require_used("t.csv").unwrap_err().to_string().contains("no rows"));
    read(b"embryo,cell,volume\ne,AB,60\n").require_used("t.csv").unwrap();
}

#[test]
fn cells_of_any_spelling_and_of_a_lineage_are_read_with_units_and_decimal_commas() {
    let grid = read(b"frame;AB al (\xb5m3);ABAR (\xb5m3)\n1;15,6;14,5\n");
    let cells = |volumes: &Volumes| -> Vec<(String, f64)> {
        volumes.embryos[0].cells.iter().map(|cell| (cell.cell.clone(), cell.volume())).collect()
    };
    assert_eq!(cells(&grid), [("ABal".to_owned(), 15.6), ("ABar".to_owned(), 14.5)]);
    assert_eq!((grid.skipped_count, grid.unit), (0, Some(Unit::CubicMicrometres)));
    let founder =
        |name: &str| NamedFounder { name: name.to_owned(), mother: None, is_smaller: false, letters: Vec::new() };
    let names = Names::of(vec![founder("z\u{fc}")], ('1', '2'));
    let table = b"embryo;cell;volume (fl)\ne;z\xfc1;15,6\ne;z\xfc2;14,5\ne;ABal;7,5\ne;zu;1,5\n";
    let long = read_as("t.csv", table, &ReadOptions { names, ..ReadOptions::default() });
    let expected =
        [("z\u{fc}1", 15.6), ("z\u{fc}2", 14.5), ("ABal", 7.5)].map(|(name, volume)| (name.to_owned(), volume));
    assert_eq!(cells(&long), expected);
    assert_eq!(
        long.skipped.iter().map(|skipped| skipped.why.as_str()).collect::<Vec<_>>(),
        ["no name of the lineage's cells; other names can be matched (--names, --root)"]
    );
}

#[test]
fn two_columns_of_one_quantity_are_refused() {
    let why = refused("embryo,cell,Volume (\u{b5}m\u{b3}),relative_volume\ne,AB,60,0.6\n");
    assert!(
        why.contains("columns 3 and 4, \"Volume (\u{b5}m\u{b3})\" and \"relative_volume\", both have the volume"),
        "{why}"
    );
    let why = refused(b"embryo,mother,larger_um3,larger_voxels,smaller_um3\ne,P0,6,6,4\n");
    assert!(why.contains("columns 3 and 4") && why.contains("both have the volume of the larger"), "{why}");
    let why = Doses::read(&b"dose,par6_dose,larger_share\n1,1,0.57\n"[..], "t.csv").unwrap_err().to_string();
    assert!(why.contains("columns 1 and 2, \"dose\" and \"par6_dose\", both have the dose"), "{why}");
}

/// Tables of some programs have a number or a tissue in the column `name`.
#[test]
fn the_column_cell_has_the_cell_wherever_it_is() {
    let volumes = read(b"name,embryo,cell,volume\n1,e,AB,60\n2,e,P1,40\n");
    assert_eq!(volumes.embryos[0].cells.iter().map(|cell| cell.cell.as_str()).collect::<Vec<_>>(), ["AB", "P1"]);
}

/// A row of data that begins with # is reported, and a comment is not.
#[test]
fn a_row_that_may_be_a_comment_is_reported() {
    let found = skipped("embryo,cell,volume\n# measured twice\n#1,AB,60\n2,AB,58\n2,P1,42\n");
    let [row] = &found[..] else { panic!("{found:?}") };
    assert!(row.starts_with("t.csv:3: 1 (embryo) = \"#1\"") && row.contains("a comment, or data"), "{row}");
}

/// Without a unit in one row the others are used.
#[test]
fn a_row_without_a_unit_costs_the_row() {
    let found = skipped("embryo,cell,volume,unit\ne,AB,60,um3\ne,P1,40,\ne,ABa,30,um3\n");
    assert_eq!(found, ["t.csv:3: 4 (unit) = \"\": no unit"]);
}

#[test]
fn mothers_of_any_spelling_are_one_mother() {
    let volumes = read(b"mother,chi,embryo\nAB al,0.1,e\nAB.al,0.2,e\nABAL,0.3,f\n");
    let found: Vec<(&str, f64)> = volumes.divisions.iter().map(|d| (d.mother.as_str(), d.chi_signed)).collect();
    assert_eq!(found, [("ABal", 0.1), ("ABal", 0.3)]);
    assert_eq!(volumes.skipped[0].why, "a second division of this cell; the first is on line 2");
}

#[test]
fn doses_in_per_cent_are_shares_of_the_wild_type() {
    let doses = Doses::read("PAR-6 dosage (%),larger_share\n50,0.6\n100,59%\n".as_bytes(), "t.csv").unwrap();
    assert_eq!(doses.divisions.iter().map(|division| division.dose).collect::<Vec<_>>(), [0.5]);
    assert!(doses.skipped[0].why.contains("write per cent as a fraction, 59% as 0.59"), "{:?}", doses.skipped);
    let why = Doses::read(&b"dose (mM),larger_share\n1,0.57\n"[..], "t.csv").unwrap_err().to_string();
    assert!(why.contains("\"dose (mM)\", must be one of 1, %"), "{why}");
}

/// A heading in brackets over columns that semicolons separate is not a tree in Newick's format.
#[test]
fn a_heading_in_brackets_begins_a_grid() {
    let grid = read(b"(frame);AB;P1\n1;640;320\n");
    assert_eq!((grid.embryos[0].cells.len(), grid.used), (2, 2));
}

#[test]
fn names_that_were_written_for_spreadsheets_read_back_as_they_were() {
    let written = furrow_input::csv_field("=wt");
    let volumes = read(format!("embryo,cell,volume,group\n+e1,AB,60,{written}\n"));
    assert_eq!((volumes.embryos[0].group.as_str(), volumes.embryos[0].name.as_str()), ("=wt", "+e1"));
}

/// A table of divisions with a comment, a mother that was not measured and rows that cannot be used.
const DIVISIONS: &str = "\
# Made up, in um^3; one \"quote\" more
embryo,mother,population,generation,mother_um3,larger_um3,smaller_um3
1,a,Mac,6,100,60,40
1,b,Mac,10,,55,45
# In between.
1,b,Mac,10,99,55,45
2,a,Mes,6,98,40,60
2,b,Mes,6,x,60,40
2,c,Mes,six,100,60,40
2,,Mes,6,100,60,40
2,d,Mes,7,110,75,25
";

#[test]
fn divisions_are_read_row_by_row() {
    let volumes = read(DIVISIONS);
    let found = divisions(&volumes).divisions;
    let of = |d: &Division| (d.group.clone(), d.mother.clone(), d.daughters[0].clone(), d.mother_measured);
    let expected = [("Mac", "6", "a", Some(100.0)), ("Mac", "10", "b", None), ("Mes", "7", "d", Some(110.0))];
    let expected = expected.map(|(group, generation, mother, own)| {
        (group.to_owned(), format!("generation {generation}"), format!("{mother} larger"), own)
    });
    assert_eq!(found.iter().map(of).collect::<Vec<_>>(), expected);
    assert_eq!(found.iter().map(|d| (100.0 * d.chi()).round() as i32).collect::<Vec<_>>(), [20, 10, 50]);
    // Generation 10 follows generation 6, though not by the alphabet.
    let groups = summaries(&found);
    assert_eq!(
        groups[0].events.iter().map(|event| &event.mother[..]).collect::<Vec<_>>(),
        ["generation 6", "generation 10"]
    );
    assert_eq!((volumes.used, volumes.unit), (8, Some(Unit::CubicMicrometres)));
    assert_eq!(
        skipped(DIVISIONS),
        [
            "t.csv:6: 2 (mother) = \"b\": a second division of this cell; the first is on line 4",
            "t.csv:7: 6 (larger_um3) = \"40\": the larger daughter must not be the smaller one",
            "t.csv:8: 5 (mother_um3) = \"x\": not a number",
            "t.csv:9: 4 (generation) = \"six\": not a whole number of a generation",
            "t.csv:10: 2 (mother) = \"\": no name of a mother",
        ]
    );
    let refusal = refused(b"# x\nembryo,larger_um3\n1,2\n");
    assert!(
        refusal.starts_with("t.csv:2:1: no column is called mother or smaller_um3; a table of divisions"),
        "{refusal}"
    );
    assert!(refused(b"embryo,mother,larger_um3,smaller_voxels\n").ends_with("larger and smaller have different units"));
}

#[test]
fn a_table_of_chi_needs_no_volumes() {
    let table = "mother,chi\nP0,0.2\nP1,-0.1\nP2,1\nP3,\n";
    let found = divisions(&read(table)).divisions;
    let of = |d: &Division| (d.embryo.clone(), d.mother.clone(), d.chi_signed);
    assert_eq!(
        found.iter().map(of).collect::<Vec<_>>(),
        [("t".into(), "P0".into(), 0.2), ("t".into(), "P1".into(), -0.1)]
    );
    assert_eq!(
        skipped(table),
        ["t.csv:4: 2 (chi) = \"1\": χ must be above -1 and below 1", "t.csv:5: 2 (chi) = \"\": empty"]
    );
}

#[test]
fn a_comment_is_no_header_but_the_first_column_of_a_grid_may_be_called_anything() {
    let grid = read(b"#,AB,P1\n1,60,40\n");
    assert_eq!(grid.used, 2);
    assert_eq!(read(b"# made up; by hand; today\nembryo,cell,volume\n# AB\ne,AB,1\n").used, 1);
}

#[test]
fn shares_are_read_as_areas_and_as_volumes() {
    let table =
        "# c\npar6_dosage,larger_share,condition\n1,0.57,wt\n0.1,0.5,rnai\n0.3,0.51,rnai\n0.2,1.2,rnai\n-1,0.5,wt\n";
    let doses = Doses::read(table.as_bytes(), "d.csv").unwrap();
    let wild = &doses.divisions[0];
    // By hand: s^1.5 of 0.57 and 0.43 are 0.430345 and 0.281971.
    assert!(
        (wild.chi_area() - 0.208299).abs() < 1e-5 && (wild.chi_volume() - 0.14).abs() < 1e-15,
        "{}",
        wild.chi_area()
    );
    assert_eq!((doses.divisions.len(), doses.skipped_count), (3, 2));
    assert_eq!(
        doses.skipped.iter().map(|skipped| skipped.described()).collect::<Vec<_>>(),
        [
            "line 6, column 2 (larger_share): \"1.2\": must be from 0.5, the larger daughter's, and below 1",
            "line 7, column 1 (par6_dosage): \"-1\": must be from 0 to 1e6; 1 is the wild type",
        ]
    );
    let names = |groups: Vec<furrow_measured::dose::DoseGroup>| {
        groups.into_iter().map(|group| (group.name, group.n)).collect::<Vec<_>>()
    };
    assert_eq!(names(by_condition(&doses.divisions)), [("wt".to_owned(), 1), ("rnai".to_owned(), 2)]);
    let bins = names(by_dose(&doses.divisions, None));
    assert_eq!(bins, [("0..0.2".to_owned(), 1), ("0.2..0.4".to_owned(), 1), ("1..1.2".to_owned(), 1)]);
    assert_eq!(names(by_dose(&doses.divisions, Some(&[0.0, 0.5]))), [("0..0.5".to_owned(), 2)]);
    for (table, why) in [
        ("dose\n1\n", "d.csv:1:1: no column is called larger_share"),
        ("", "d.csv:1:1: the table is empty"),
        (
            "dose,larger_share\n",
            "d.csv: rows = none used: must be at least one that can be used (the table has no rows)",
        ),
    ] {
        let refusal = Doses::read(table.as_bytes(), "d.csv").unwrap_err().to_string();
        assert!(refusal.starts_with(why), "{refusal}");
    }
}

#[test]
fn each_embryo_has_its_size_and_its_voxels() {
    let table = "embryo,cell,volume_voxels\none,AB,8\none,P1,4\ntwo,AB,16\ntwo,P1,8\n";
    let voxel = PerEmbryo::new([(None, 2.0), (Some("two".to_owned()), 4.0)]);
    let options = ReadOptions { voxel, ..ReadOptions::default() };
    let mut volumes = read_as("t.csv", table, &options);
    let sizes = volumes.sizes();
    assert_eq!(volumes.unit, Some(Unit::CubicMicrometres));
    let factors: Vec<f64> = sizes.iter().map(|size| size.size_factor.unwrap()).collect();
    // Twice the voxels of eight times the volume.
    assert!((factors[1] / factors[0] - 16.0).abs() < 1e-9 && (factors[0] * factors[1] - 1.0).abs() < 1e-9);
    assert_eq!([sizes[0].voxel, sizes[1].voxel], [Some(2.0), Some(4.0)]);
    assert_eq!((sizes[0].cells, sizes[0].shared), (2, 2));
    volumes.require_options().unwrap();
    volumes.voxels = PerEmbryo::new([(Some("three".to_owned()), 4.0)]);
    let error = volumes.require_options().unwrap_err().to_string();
    assert_eq!(error, "--voxel: embryo = \"three\": must be one of the embryos: one, two");
}

#[test]
fn an_embryo_in_voxels_needs_an_edge_where_another_has_one() {
    let of_one = ReadOptions { voxel: PerEmbryo::new([(Some("one".to_owned()), 0.1)]), ..ReadOptions::default() };
    let refused = "--voxel: embryo = \"two\": must be given too, as --voxel two=UM: its volumes are in voxels, and others are \
                   converted to µm³";
    for (table, said) in [
        ("embryo,cell,volume_voxels\none,AB,8\none,P1,4\ntwo,AB,16\n", Some(refused)),
        ("embryo,cell,volume\none,AB,8\none,P1,4\ntwo,AB,16\n", Some(refused)),
        ("embryo,mother,larger_voxels,smaller_voxels\none,P0,8,4\ntwo,P0,16,8\n", Some(refused)),
        ("embryo,mother,chi,mother_voxels\none,P0,0.2,8\ntwo,P0,0.3,16\n", Some(refused)),
        ("embryo,AB,P1\none,8,4\ntwo,16,8\n", Some(refused)),
        ("embryo,cell,volume_voxels\none,AB,8\none,P1,4\n", None),
    ] {
        let volumes = read_as("t.csv", table, &of_one);
        let error = volumes.require_options().err().map(|error| error.to_string());
        assert_eq!(error.as_deref(), said, "{table}");
    }
    let twice = [(Some("one".to_owned()), 0.1), (Some("one".to_owned()), 0.2)];
    let error = PerEmbryo::of_list(&twice, "--voxel").unwrap_err().to_string();
    assert_eq!(error, "--voxel: value = 0.2: must be left out: it is the second one of \"one\"");
}
