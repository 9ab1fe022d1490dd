//! Tables of volumes as people write them.

use furrow_measured::events::{divisions, summaries};
use furrow_measured::trend::{adjacent_tests, volume_bins};
use furrow_measured::volumes::{ReadOptions, Unit, Volumes};

fn read(table: &[u8]) -> Volumes {
    let mut volumes = Volumes::default();
    volumes.read(table, "t.csv", &ReadOptions::default()).unwrap();
    volumes
}

fn refused(table: &[u8]) -> String {
    Volumes::default().read(table, "t.csv", &ReadOptions::default()).unwrap_err().to_string()
}

fn skipped(table: &str) -> Vec<String> {
    let volumes = read(table.as_bytes());
    assert_eq!(volumes.skipped_count as usize, volumes.skipped.len());
    volumes.skipped.iter().map(|s| format!("{}:{}: {} = {:?}: {}", s.file, s.line, s.column, s.value, s.why)).collect()
}

#[test]
fn columns_may_stand_in_any_order_and_groups_are_kept_apart() {
    let table = "n,group,volume,cell,embryo,remark\n3,wt,60,AB,e1,x\n3,wt,40,P1,e1,\n1,hot,50,P1,e1,\n1,hot,50,AB,e1,\n,wt,58,AB,e2,\n,wt,42,P1,e2,\n";
    let volumes = read(table.as_bytes());
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
fn the_sign_is_that_of_the_daughter_named_first() {
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
    let mut grid = Volumes::default();
    let options = ReadOptions { voxel: Some(0.25), group: None };
    grid.read(&b",AB,P1,Nuc3\n1,640,,7\n2,1280,320,\n3,,320,\n"[..], "data/Sample04_Volume.csv", &options).unwrap();
    assert_eq!(grid.embryos[0].name, "Sample04");
    assert_eq!(grid.embryos[0].cells.iter().map(|cell| cell.volume()).collect::<Vec<_>>(), [15.0, 5.0]);
    assert_eq!((grid.used, grid.skipped_count, grid.unit), (4, 1, Some(Unit::CubicMicrometres)));
}

#[test]
fn what_cannot_be_used_is_told_with_its_place() {
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
fn what_is_no_table_of_volumes_is_refused() {
    for (table, expected) in [
        (&b""[..], "t.csv:1:1: the table is empty"),
        (b"cell,volume\nAB,1\n", "no column is called embryo"),
        (b"x,y\n1,2\n", "no column is called cell or volume or embryo"),
        (b"embryo,cell,volume,cell\n", "two columns are called \"cell\""),
        (b"\xff\xfee\0", "this is UTF-16"),
        (b"embryo,cell,volume,unit\ne,AB,1,um3\ne,P1,1,pints\n", "unit on line 3, column 4 = pints: must be um3"),
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
    let said = refused(format!("{header}\n1\n").as_bytes());
    assert!(said.contains("and 199993 more"), "{said}");
    let long = "a".repeat(1_000_000);
    assert_eq!(read(format!("embryo,cell,volume\ne,AB{long},1\n").as_bytes()).skipped[0].why, "no name of Sulston's");
}

#[test]
fn divisions_with_one_daughter_are_told() {
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
    let bins = volume_bins(&divisions(&read(table.as_bytes())).divisions, None);
    let names: Vec<(String, usize)> = bins.iter().map(|bin| (bin.name(), bin.n)).collect();
    assert_eq!(names, [("10000..100000".to_owned(), 3), ("100..1000".to_owned(), 3)]);
    let tests = adjacent_tests(&bins);
    assert_eq!((tests[0].test.u, tests[0].test.p, tests[0].stars), (9.0, 0.05, "*"));
    let own = volume_bins(&divisions(&read(table.as_bytes())).divisions, Some(&[0.0, 901.0]));
    assert_eq!((own.len(), own[0].n), (1, 3));
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
fn a_table_in_descending_frames_is_read_in_time_that_grows_as_its_rows() {
    // A sorted list with insertions at its front took minutes for these.
    let rows: String = (0..400_000).rev().map(|frame| format!("e,AB,{frame},10\n")).collect();
    let start = std::time::Instant::now();
    let volumes = read(format!("embryo,cell,frame,volume_um3\n{rows}e,AB,7,10\n").as_bytes());
    assert!(start.elapsed().as_secs_f64() < 5.0, "{:?}", start.elapsed());
    assert_eq!((volumes.used, volumes.skipped_count), (400_000, 1));
    assert!(volumes.skipped[0].why.contains("a second volume of this cell in frame 7"));
}

#[test]
fn decimal_commas_are_named_where_nothing_is_used() {
    let volumes = read(b"embryo;cell;volume\ne;AB;60,5\ne;P1;40,2\n");
    let said = volumes.require_used("t.csv").unwrap_err().to_string();
    assert!(said.contains("none used, 2 skipped") && said.contains("decimals need a point"), "{said}");
    assert!(read(b"embryo,cell,volume\n").require_used("t.csv").unwrap_err().to_string().contains("no rows"));
    read(b"embryo,cell,volume\ne,AB,60\n").require_used("t.csv").unwrap();
}

#[test]
fn names_that_were_written_for_spreadsheets_read_back_as_they_were() {
    let written = furrow_input::csv_field("=wt");
    let volumes = read(format!("embryo,cell,volume,group\n+e1,AB,60,{written}\n").as_bytes());
    assert_eq!((volumes.embryos[0].group.as_str(), volumes.embryos[0].name.as_str()), ("=wt", "+e1"));
}
