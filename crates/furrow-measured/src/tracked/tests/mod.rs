//! Small made-up embryos in every format, and files that are wrong.

mod damaged;
mod formats;
mod graphs;
mod links;
mod sizes;
mod tracks;

use std::fs;
use std::io::{Cursor, Write};
use std::path::{Path, PathBuf};

use tempfile::TempDir;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::lengths::sphere;
use super::*;
use crate::lifetimes::{LifetimeOptions, Lifetimes};
use crate::names::Names;

/// Nuclei of P0 in frames 1 and 2, AB and P1 from 3 on, AB's daughters from 5 on; P1 is last seen in 6.
const NUCLEI: [&str; 6] = [
    "1, 1, -1, 1, -1, 100, 90, 10.5, 40, P0, 500\n2, 0, -1, -1, -1, 5, 5, 1, 7, Nuc2, 1\n",
    "1, 1, 1, 2, 3, 100, 90, 10.5, 40, P0, 500\n",
    "2, 1, 1, 1, nill, 80, 90, 10, 30, AB, 500\n3, 1, 1, 2, -1, 120, 90, 10, 20, P1, 500\n",
    "1, 1, 2, 1, 2, 80, 90, 10, 30, AB, 500\n2, 1, 3, 3, -1, 120, 90, 10, 20, P1, 500\n",
    "1,1,1,1,-1,70,80,9,22,Nuc7,9,0,0,0,ABa\n2,1,1,2,-1,70,99,9,24,ABp,9\n3,1,2,3,-1,120,90,10,20,P1,9\n",
    "1,1,1,-1,-1,70,80,9,22,ABa,9\n2,1,2,-1,-1,70,99,9,24,ABp,9\n3,1,3,-1,-1,120,90,10,20,P1,9\n",
];

/// A folder of nuclei.
fn nuclei(files: &[&str]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("nuclei")).unwrap();
    for (k, text) in files.iter().enumerate() {
        fs::write(folder.path().join(format!("nuclei/t{:03}-nuclei", k + 1)), text).unwrap();
    }
    folder
}

/// A zip archive; every second file is deflated.
fn zip(files: &[(String, Vec<u8>)]) -> Vec<u8> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    for (k, (name, content)) in files.iter().enumerate() {
        let method = [CompressionMethod::Stored, CompressionMethod::Deflated][k % 2];
        writer.start_file(&**name, SimpleFileOptions::default().compression_method(method)).unwrap();
        writer.write_all(content).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

fn zipped(files: &[&str]) -> Vec<u8> {
    let named =
        files.iter().enumerate().map(|(k, text)| (format!("nuclei/t{:03}-nuclei", k + 1), text.as_bytes().into()));
    zip(&named.collect::<Vec<_>>())
}

/// A file in a folder of its own.
fn file(name: &str, content: impl AsRef<[u8]>) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    fs::write(&path, content).unwrap();
    (folder, path)
}

fn tracked(path: &Path) -> TrackedLineage {
    read_tracked(path, &TrackOptions::default()).unwrap().unwrap()
}

/// The embryo of a file.
fn embryo(name: &str, content: impl AsRef<[u8]>) -> TrackedLineage {
    tracked(&file(name, content).1)
}

/// Cases of a text file: lines that begin with `> `, and the message below each.
fn cases(text: &str) -> impl Iterator<Item = (Vec<&str>, &str)> {
    text.trim_end().split("> ").skip(1).map(|case| {
        let (changes, message) = case.trim_end().split_once('\n').unwrap();
        (changes.split(" | ").collect(), message)
    })
}

/// What was skipped, with the places.
fn reports(lineage: &TrackedLineage) -> Vec<String> {
    lineage.skipped.iter().map(|s| format!("{} {} {}: {}", s.line, s.column, s.value, s.why)).collect()
}

/// The error, without the folder's name.
fn refused(path: &Path) -> String {
    let error = read_tracked(path, &TrackOptions::default()).unwrap_err().to_string();
    let folder = path.parent().unwrap().display().to_string();
    error.replace(&format!("{}/", path.display()), "").replace(&format!("{folder}/"), "")
}

/// Why a file is refused.
fn refusal(name: &str, content: impl AsRef<[u8]>) -> String {
    refused(&file(name, content).1)
}

/// The lifetimes of an embryo.
fn lifetimes(path: &Path, frame_minutes: Option<f64>) -> Result<Lifetimes, InputError> {
    let options = LifetimeOptions { frame_minutes: frame_minutes.into(), ..LifetimeOptions::default() };
    Lifetimes::read_files(&embryo_files(&[path.to_owned()], TableKind::Lifetimes)?.0, &options)
}

/// Name, mother's name, birth, division and last time of each cell.
type Life<'a> = (&'a str, Option<&'a str>, f64, Option<f64>, f64);

fn lives(lineage: &TrackedLineage) -> Vec<Life<'_>> {
    let name = |cell: usize| lineage.cells[cell].name.as_str();
    let life = |cell: &TrackedCell| cell.mother.map(name);
    let each = lineage.cells.iter().map(|cell| (cell.name.as_str(), life(cell), cell.birth, cell.division, cell.last));
    each.collect()
}

fn rounds_of(cell: &str, terminal: u32, min: u32, mean: f64, max: u32) -> TrackedRounds {
    TrackedRounds { cell: cell.to_owned(), terminal, min, mean, max }
}

/// The cells in the order of [`LIVES`].
fn in_order(mut lives: Vec<Life<'_>>) -> Vec<Life<'_>> {
    lives.sort_by_key(|life| LIVES.iter().position(|known| known.0 == life.0));
    lives
}

const LIVES: [Life<'static>; 5] = [
    ("P0", None, 1.0, Some(3.0), 2.0),
    ("AB", Some("P0"), 3.0, Some(5.0), 4.0),
    ("P1", Some("P0"), 3.0, None, 6.0),
    ("ABa", Some("AB"), 5.0, None, 6.0),
    ("ABp", Some("AB"), 5.0, None, 6.0),
];

#[test]
fn nuclei_in_a_folder_and_in_an_archive_are_the_same_cells() {
    let folder = nuclei(&NUCLEI);
    let lineage = tracked(folder.path());
    assert_eq!((lineage.format, lineage.time, lineage.volumes), (Format::AceTree, TimeUnit::Frames, Unit::Voxels));
    assert_eq!(lives(&lineage), LIVES);
    assert_eq!((lineage.skipped_count, lineage.of_nuclei()), (0, true));
    assert_eq!(lineage.cells[0].daughters, [1, 2]);
    assert_eq!(
        lineage.cells.iter().map(TrackedCell::lifetime).collect::<Vec<_>>(),
        [None, Some(2.0), None, None, None]
    );
    // A sphere of 40 pixels.
    assert!((lineage.cells[0].volume.unwrap() - 33_510.321_638_291_13).abs() < 1e-9);

    let (_folder, path) = file("embryo.zip", zipped(&NUCLEI));
    assert_eq!(lives(&tracked(&path)), LIVES);
    assert_eq!(tracked(&path).name, "embryo");
    let options = TrackOptions { pixel: Some(0.5), frame_minutes: Some(1.5), ..TrackOptions::default() };
    let scaled = read_tracked(&path, &options).unwrap().unwrap();
    assert_eq!((scaled.time, scaled.volumes), (TimeUnit::Minutes, Unit::CubicMicrometres));
    assert_eq!((scaled.cells[1].birth, scaled.cells[1].lifetime()), (4.5, Some(3.0)));
    assert!((scaled.cells[0].volume.unwrap() - 33_510.321_638_291_13 / 8.0).abs() < 1e-9);
}

/// A CD table of the same embryo.
fn cd_table() -> String {
    let mut table = "cellTime,cell,time,none,global,local,blot,cross,z,x,y,size,gweight\n".to_owned();
    for (cell, times, size) in
        [("AB", 3..5, 30), ("P0", 1..3, 40), ("P1", 3..7, 20), ("ABa", 5..7, 22), ("ABp", 5..7, 24)]
    {
        times.for_each(|t| table += &format!("{cell}:{t},{cell},{t},1,2,3,4,5,10.5,80,90,{size},700\n"));
    }
    table
}

#[test]
fn a_cd_table_gives_the_cells_that_the_nuclei_give() {
    let (_folder, path) = file("CDembryo.csv", cd_table());
    let (cd, folder) = (tracked(&path), nuclei(&NUCLEI));
    assert_eq!(in_order(lives(&cd)), LIVES);
    for cell in &tracked(folder.path()).cells {
        let same = cd.cells.iter().find(|other| other.name == cell.name).unwrap();
        assert_eq!((same.volume, same.sizes), (cell.volume, cell.sizes), "{}", cell.name);
    }
}

/// Where only one daughter was followed, the name shows the division.
#[test]
fn a_new_name_of_a_daughter_begins_a_cell() {
    let folder = nuclei(&["1,1,-1,1,-1,0,0,0,11,AB,0\n", "1,1,1,1,-1,0,0,0,9,ABa,0\n", "1,1,1,-1,-1,0,0,0,9,ABpr,0\n"]);
    let lineage = tracked(folder.path());
    assert_eq!(lives(&lineage), [("AB", None, 1.0, Some(2.0), 1.0), ("ABa", Some("AB"), 2.0, None, 3.0)]);
    let skipped = &lineage.skipped[0];
    assert_eq!((lineage.skipped_count, skipped.value.as_str(), skipped.line), (1, "ABpr", 1));
    assert_eq!(skipped.why, "the cell is called ABa before");
}

#[test]
fn three_hundred_and_sixty_frames_are_read() {
    let frame = |k: usize| {
        let before = |n: usize| if k == 0 { -1 } else { n as i64 };
        let after = |n: usize| if k == 359 { -1 } else { n as i64 };
        let line = |n| {
            format!(
                "{n}, 1, {}, {}, -1, 100, 90, 10.5, 40, Nuc{n}, 500, 0, 0, 0, , 1, 2, 3, 4, 5\n",
                before(n),
                after(n)
            )
        };
        (format!("nuclei/t{:03}-nuclei", k + 1), (1..=550).map(line).collect::<String>().into_bytes())
    };
    let lineage = embryo("long.zip", zip(&(0..360).map(frame).collect::<Vec<_>>()));
    assert_eq!((lineage.cells.len(), lineage.cells[7].sizes), (550, 360));
}

#[test]
fn wrong_nuclei_are_refused_with_their_place() {
    for (frames, message) in cases(include_str!("wrong_nuclei.txt")) {
        let frames: Vec<String> = frames.iter().map(|frame| frame.replace(' ', "\n")).collect();
        let error = refused(nuclei(&frames.iter().map(String::as_str).collect::<Vec<_>>()).path());
        assert!(error.contains(message), "{error}\n{message}");
    }
    for (frames, message) in [
        (&["", ""][..], "is not nuclei of AceTree with a cell that can be used: it has no spots"),
        (&["\u{feff}\u{0}"], "this is no text: it has a byte 0"),
    ] {
        assert!(refused(nuclei(frames).path()).contains(message));
    }
    let folder = nuclei(&NUCLEI);
    fs::remove_file(folder.path().join("nuclei/t004-nuclei")).unwrap();
    assert!(refused(folder.path()).ends_with("from t001-nuclei to t006-nuclei, but not t004-nuclei"));
    // Contradictory links and invalid sizes are reported; the cells are read.
    let folder =
        nuclei(&[NUCLEI[0], "1,1,1,-1,-1,0,0,0,-3,P0,0\n2,1,1,-1,-1,0,0,0,9,AB,0\n3,1,2,-1,-1,0,0,0,9,P1,0\n"]);
    let lineage = tracked(folder.path());
    assert_eq!(
        reports(&lineage),
        [
            "1 9 (size) -3: must be a diameter above 0, in pixels",
            "2 3 (predecessor) 1: nucleus 1 of frame 1 does not name 2 as a successor",
            "3 3 (predecessor) 2: nucleus 2 of frame 1 is not valid",
        ]
    );
}

#[test]
fn wrong_archives_and_cd_tables_are_refused() {
    let whole = zipped(&NUCLEI);
    let at = whole.windows(4).position(|four| four == b"PK\x01\x02").unwrap();
    let with = |place: usize, bits: u8| {
        let mut changed = whole.clone();
        changed[place] ^= bits;
        changed
    };
    for (content, message) in [
        (&whole[..whole.len() - 30], "is not a zip archive: its directory is damaged"),
        (&zip(&[("readme".to_owned(), vec![])]), "it has no file nuclei/t001-nuclei"),
        (&with(at + 8, 1), "nuclei/t001-nuclei: is not a file that can be unpacked: it is encrypted"),
        (&with(30 + 18 + 3, 1), "its length or its checksum is wrong"),
        (&with(at + 27, 0x80), "its files are longer than 64 MB, the most that is unpacked of it"),
        (&with(at + 10, 12), "it is packed by method 12; stored (0) and deflated (8) files are read"),
    ] {
        let error = refusal("embryo.zip", content);
        assert!(error.contains(message), "{error}\n{message}");
    }
    let (folder, _) = file("there.zip", "");
    assert!(refused(&folder.path().join("not_there.zip")).contains("cannot be read"));
    let header = "cellTime,cell,time,none,size\n";
    for (table, message) in [
        ("cellTime,cell,time\n".to_owned(), "CD.csv: is not CD table with a cell that can be used: it has no spots"),
        ("cellTime,size\nAB,9\n".to_owned(), "line 2, cellTime: \"AB\": must be a cell and a frame, as AB:3"),
        (header.to_owned(), "CD.csv: is not CD table with a cell that can be used: it has no spots"),
        (
            format!("{header}AB:1,AB,1,0,9\nAB:1,AB,1,0,8\n"),
            "CD.csv:3:1: cell AB a second time at time 1; the first is on line 2",
        ),
        (format!("{header}AB:1,AB,NaN,0,9\n"), "line 2, time: \"NaN\": must be a number of frames from 0"),
    ] {
        let error = refusal("CD.csv", table);
        assert!(error.contains(message), "{error}\n{message}");
    }
    let lineage = embryo("CD.csv", format!("{header}a,AB,5,0,9\nb,ABa,5,0,-9\nc,,5,0,9\n"));
    let why: Vec<&str> = lineage.skipped.iter().map(|s| s.why.as_str()).collect();
    let twice = format!("{header}AB:1,AB,1,0,9\nAB:1,AB,1,0,9\n");
    assert_eq!(reports(&embryo("CD.csv", twice)), ["3 cell AB: the row of line 2 a second time"]);
    let late = "it is born while its mother AB is still there, until time 5";
    assert_eq!(why, ["must be a diameter above 0, in pixels", "must be the name of a cell", late]);
}

/// As pandas writes a CD table, and as the programs that segment cells do.
#[test]
fn cd_tables_of_other_programs_are_read() {
    let rows = |table: &str| table.lines().map(str::to_owned).collect::<Vec<_>>();
    let numbered: String = rows(&cd_table()).iter().map(|row| format!("0,{row}\n")).collect();
    let numbered = numbered.replacen("0,cellTime", ",cellTime", 1);
    let joined = rows(&cd_table())
        .iter()
        .skip(1)
        .map(|row| format!("{},7,8,9\n", row.split(',').next().unwrap()))
        .collect::<String>();
    for (table, has_sizes) in
        [(numbered, true), (format!("Cell & Time,X (Pixel),Y (Pixel),Z (Pixel)\n{joined}"), false)]
    {
        let cd = embryo("CDembryo.csv", table);
        assert_eq!((in_order(lives(&cd)), cd.skipped_count), (LIVES.to_vec(), 0));
        assert_eq!(cd.cells.iter().all(|cell| cell.volume.is_some()), has_sizes);
    }
}

/// Lines before the heading, as spreadsheets and people write them, do not hide the format.
#[test]
fn a_separator_and_comments_may_precede_the_heading() {
    let semicolons = cd_table().replace(',', ";");
    let (_folder, path) = file("CDembryo.csv", format!("sep=;\n# exported\n{semicolons}"));
    let cd = tracked(&path);
    assert_eq!((cd.cells.len(), cd.skipped_count), (LIVES.len(), 0));
}

/// A frame beyond the largest number is missed, not passed over.
#[test]
fn a_frame_with_too_large_a_number_is_reported() {
    let folder = nuclei(&NUCLEI);
    fs::write(folder.path().join("nuclei/t99999999999-nuclei"), NUCLEI[1]).unwrap();
    let error = refused(folder.path());
    assert!(error.contains("t4294967295-nuclei, but not t"), "{error}");
}

/// The usual spellings of a cell's name are read; a cell with another name is counted as skipped, and its name is shown.
#[test]
fn names_are_understood_or_skipped() {
    let lifetimes = |from: &str, to: &str| {
        let texts: Vec<String> = NUCLEI.iter().map(|text| text.replace(from, to)).collect();
        let folder = nuclei(&texts.iter().map(String::as_str).collect::<Vec<_>>());
        let options = TrackOptions { pixel: None, frame_minutes: Some(1.0), ..TrackOptions::default() };
        let embryo = read_tracked(folder.path(), &options).unwrap().unwrap();
        (super::tests::lifetimes(folder.path(), Some(1.0)), embryo.skipped_with_names(&Names::default()))
    };
    for name in ["AB", "A B", "AB.", " AB"] {
        let (found, (skipped, count)) = lifetimes("AB", name);
        assert_eq!((found.unwrap().cells[0].cell.as_str(), count), ("AB", 0), "{name} {skipped:?}");
    }
    let (found, (skipped, count)) = lifetimes("AB,", "upper,");
    let error = found.unwrap_err().to_string();
    assert!(error.contains("the first of 1 skipped") && error.contains("\"upper\": no name of Sulston's"), "{error}");
    assert_eq!((count, skipped[0].value.as_str(), skipped[0].line), (1, "upper", 1));
}

/// A mother that divided before the recording has the rounds of her daughters and one more.
#[test]
fn rounds_of_mothers_that_were_not_followed_come_from_their_daughters() {
    let rows: Vec<&str> = [
        "1,1,1,1,-1,0,0,0,9,ABa,0\n",
        "2,1,2,2,-1,0,0,0,9,ABpl,0\n",
        "3,1,3,3,-1,0,0,0,9,ABpr,0\n",
        "4,1,4,4,5,0,0,0,9,EMS,0\n",
    ]
    .to_vec();
    let last = "1,1,1,-1,-1,0,0,0,9,ABa,0\n2,1,2,-1,-1,0,0,0,9,ABpl,0\n3,1,3,-1,-1,0,0,0,9,ABpr,0\n4,1,4,-1,-1,0,0,0,9,MS,0\n5,1,4,-1,-1,0,0,0,9,E,0\n";
    let first: String = rows.iter().map(|row| row.replacen(&row[..6], &format!("{},1,-1,", &row[..1]), 1)).collect();
    let folder = nuclei(&[&first, last]);
    let lineage = tracked(folder.path());
    let FollowedRounds { founders: found, absent, terminal, not_followed } =
        lineage.rounds(&["P0", "AB", "P1", "EMS", "P2", "MS", "E", "C"], &Names::default());
    let expected = [
        rounds_of("AB", 3, 1, 5.0 / 3.0, 2),
        rounds_of("EMS", 2, 1, 1.0, 1),
        rounds_of("MS", 1, 0, 0.0, 0),
        rounds_of("E", 1, 0, 0.0, 0),
    ];
    assert_eq!(found, expected, "{:?}", lineage.skipped);
    assert_eq!((terminal, not_followed.len()), (5, 0));
    let why: Vec<String> = absent.iter().map(|absent| format!("{}: {}", absent.founder, absent.why)).collect();
    let neither = "neither it nor its daughters were followed";
    assert_eq!(
        why,
        [
            "P0: it was not followed, and of its daughters only AB".to_owned(),
            "P1: it was not followed, and of its daughters only EMS".to_owned(),
            format!("P2: {neither}"),
            format!("C: {neither}"),
        ]
    );
}

/// Errors name the kind of an unsuitable file.
#[test]
fn files_of_other_kinds_are_named() {
    for (name, content, message) in [
        ("film.xml", "<embryo>\n<nuclei file=\"a.zip\"/>\n</embryo>\n", "it is AceTree's configuration (XML)"),
        ("tree.json", "{\n\"format\": 1, \"cells\": []\n}\n", "it is JSON, as furrow's tree.json is"),
        ("tree.nwk", "((ABa:1,ABp:1)AB:2,P1:3)P0;\n", "it is a tree (Newick or Nexus)"),
        ("tree.json", "{\n  \"schema\": \"furrow.tree\",\n", "it is JSON, as furrow's tree.json is"),
        ("tree.nex", "#NEXUS\nbegin trees;\n", "it is a tree (Newick or Nexus)"),
        ("t.csv.gz", "\u{1f}", ""),
    ] {
        let (folder, path) = file(name, content);
        if message.is_empty() {
            fs::write(&path, b"\x1f\x8b\x08\0").unwrap();
        }
        let error = refused(&path);
        assert!(error.contains(message) && error.contains("is not a table or an embryo that was followed"), "{error}");
        let error = crate::lifetimes::Lifetimes::read(fs::File::open(&path).unwrap(), "table").unwrap_err().to_string();
        assert!(error.contains(message) && error.contains("is not a table (CSV)"), "{error}");
        drop(folder);
    }
    // A command that reads only tables names the kind of embryo.
    for (name, content, message) in [
        (
            "film.xml",
            "<?xml version=\"1.0\"?>\n<TrackMate version=\"7\">\n",
            "it is a file of TrackMate or MaMuT (XML)",
        ),
        ("man_track.txt", "1 0 14 0\n2 15 32 1\n3 15 34 1\n", "it is tracks of the Cell Tracking Challenge"),
    ] {
        let (_folder, path) = file(name, content);
        let error = crate::lifetimes::Lifetimes::read(fs::File::open(&path).unwrap(), "table").unwrap_err().to_string();
        assert!(error.contains(message) && error.contains("is not a table (CSV)"), "{error}");
    }
    for (inside, message) in [
        ("project.xml", "it is a project of Mastodon"),
        ("xl/workbook.xml", "it is a workbook of Excel"),
        ("tracks.geff/.zattrs", "it is a Zarr container in an archive: unpack it"),
    ] {
        let error = refusal("film.zip", zip(&[(inside.to_owned(), vec![1])]));
        assert!(error.contains(message), "{error}");
    }
    let (folder, path) = file("t001-nuclei", NUCLEI[0]);
    assert!(refused(&path).contains("it has the nuclei of one frame"), "{}", refused(&path));
    fs::remove_file(path).unwrap();
    assert!(refused(folder.path()).contains("it is a folder with neither nuclei of AceTree"));
}

/// Which of two files of one frame is the right one is not known.
#[test]
fn two_files_of_one_frame_are_refused() {
    for other in ["nuclei/t2-nuclei", "nuclei/t002-nuclei~", "t002-nuclei"] {
        let folder = nuclei(&NUCLEI);
        fs::write(folder.path().join(other), NUCLEI[1]).unwrap();
        let error = refused(folder.path());
        assert!(error.contains("t002-nuclei and ") || error.contains(" and nuclei/t002-nuclei"), "{error}");
        assert!(error.contains(other) && error.contains("are both of frame 2"), "{error}");
    }
    let mut files: Vec<(String, Vec<u8>)> = Vec::new();
    for folder in ["nuclei", "old/nuclei"] {
        let named = |(k, text): (usize, &&str)| (format!("{folder}/t{:03}-nuclei", k + 1), text.as_bytes().to_vec());
        files.extend(NUCLEI.iter().enumerate().map(named));
    }
    let error = refusal("embryo.zip", zip(&files));
    assert!(error.contains("nuclei/t001-nuclei and old/nuclei/t001-nuclei are both of frame 1"), "{error}");
}

/// A nucleus names a successor, and this names another predecessor.
#[test]
fn one_sided_successors_are_reported() {
    let folder = nuclei(&[
        "1,1,-1,1,2,0,0,0,11,P0,0\n2,1,-1,3,9,0,0,0,9,X,0\n",
        "1,1,1,-1,-1,0,0,0,9,AB,0\n2,1,-1,-1,-1,0,0,0,9,P1,0\n3,0,2,-1,-1,0,0,0,9,X,0\n",
    ]);
    let lineage = tracked(folder.path());
    assert_eq!(
        reports(&lineage),
        [
            "1 5 (successor 2) 2: nucleus 2 of frame 2 does not name 1 as where it comes from",
            "2 4 (successor 1) 3: nucleus 3 of frame 2 is not valid",
            "2 5 (successor 2) 9: frame 2 has no nucleus 9",
        ]
    );
}

#[test]
fn rounds_count_divisions_to_the_last_cells() {
    let folder = nuclei(&NUCLEI);
    let lineage = tracked(folder.path());
    let FollowedRounds { founders: found, absent, terminal, .. } =
        lineage.rounds(&["P0", "E", "AB", "P1"], &Names::default());
    let expected = [rounds_of("P0", 3, 1, 5.0 / 3.0, 2), rounds_of("AB", 2, 1, 1.0, 1), rounds_of("P1", 1, 0, 0.0, 0)];
    assert_eq!((found, terminal), (expected.to_vec(), 3));
    assert_eq!((absent.len(), absent[0].why.as_str()), (1, "neither it nor its daughters were followed"));
}

/// A sister that was not followed counts as one terminal cell, or as her own daughters if these were followed, and is reported. Cells
/// without a name count if they descend from a cell with a name.
#[test]
fn sisters_that_were_not_followed_count_as_terminal_cells() {
    let rounds = |cells: &[(&str, u32, u32)]| {
        let rows =
            cells.iter().flat_map(|(cell, from, to)| (*from..=*to).map(move |time| format!("{cell},{time},9\n")));
        let (_folder, path) = file("CDm.csv", format!("cell,time,size,cellTime\n{}", rows.collect::<String>()));
        tracked(&path).rounds(&["P0", "AB", "P1"], &Names::default())
    };
    let shared = [("P0", 1, 3), ("AB", 4, 8), ("P1", 4, 9)];
    let with = |more: &[(&str, u32, u32)]| rounds(&[&shared[..], more].concat());
    for (more, terminal, ab, lost) in [
        (&[("ABa", 9, 12)][..], 3, rounds_of("AB", 2, 1, 1.0, 1), &["ABp"][..]),
        (&[("ABa", 9, 10), ("ABp", 9, 10), ("ABal", 11, 12)], 4, rounds_of("AB", 3, 1, 5.0 / 3.0, 2), &["ABar"]),
        // ABp is missing, and her daughters are not.
        (&[("ABa", 9, 12), ("ABpl", 11, 12), ("ABpr", 11, 12)], 4, rounds_of("AB", 3, 1, 5.0 / 3.0, 2), &[]),
        (&[("ABal", 11, 12), ("ABar", 11, 12)], 4, rounds_of("AB", 3, 1, 5.0 / 3.0, 2), &["ABp"]),
    ] {
        let found = with(more);
        assert_eq!((found.terminal, &found.founders[1]), (terminal, &ab), "{more:?}");
        assert_eq!(found.not_followed, lost, "{more:?}");
        assert_eq!(found.founders[0].terminal, terminal, "{more:?}");
    }
}

#[test]
fn lifetimes_need_minutes_and_both_ends() {
    let folder = nuclei(&NUCLEI);
    let error = lifetimes(folder.path(), None).unwrap_err().to_string();
    assert_eq!(error.split(':').next(), Some("--frame-minutes"), "{error}");
    let found = lifetimes(folder.path(), Some(1.5)).unwrap();
    // P0 is there from the start, and the others were not seen to divide.
    let [ab] = &found.cells[..] else { panic!("{found:?}") };
    assert_eq!((ab.cell.as_str(), ab.founder.as_str(), ab.n, ab.mean, ab.birth), ("AB", "AB", 1, 3.0, Some(4.5)));
    let folder = nuclei(&NUCLEI[..2]);
    let error = lifetimes(folder.path(), Some(1.5)).unwrap_err().to_string();
    assert!(error.contains(": cells = 1: must be at least one cell"), "{error}");
}
