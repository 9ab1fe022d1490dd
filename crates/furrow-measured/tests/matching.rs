//! Cells with other names than the lineage's.

use std::fs;
use std::path::{Path, PathBuf};

use furrow_input::InputError;
use furrow_measured::events::divisions;
use furrow_measured::lifetimes::{LifetimeOptions, Lifetimes};
use furrow_measured::matching::{By, Matched, Matching};
use furrow_measured::names::{NamedFounder, Names};
use furrow_measured::tracked::{TableKind, TrackOptions, TrackedLineage, embryo_files, read_embryo};
use furrow_measured::volumes::{ReadOptions, Volumes};

/// An egg that divides into animal (smaller) and vegetal, and animal into A1 (larger) and A2; letters below.
fn names() -> Names {
    let founder = |name: &str, mother, is_smaller| NamedFounder {
        name: name.to_owned(),
        mother,
        is_smaller,
        letters: Vec::new(),
    };
    let founders = vec![
        founder("egg", None, false),
        founder("animal", Some(0), true),
        founder("vegetal", Some(0), false),
        founder("A1", Some(1), false),
        founder("A2", Some(1), true),
    ];
    Names::of(founders, ('x', 'y'))
}

/// Spots of an egg (1, 2), its daughters 3 and 4 in frame 2, the daughters of 3 (5, 6) in frame 4, of 4 (7, 8) in frames 4 and 5,
/// and two spots of something else (9, 13).
const SPOTS: &str = "LABEL,ID,FRAME,RADIUS\n\
    ID1,1,0,10\nID2,2,1,10\nID3,3,2,9\nID4,4,2,6\nID5,5,4,7\nID6,6,4,7\nID7,7,4,3\nID8,8,5,4\nID10,10,6,4\nID9,9,0,2\nID13,13,1,2\n";
const EDGES: &str = "SPOT_SOURCE_ID,SPOT_TARGET_ID\n1,2\n2,3\n2,4\n3,5\n3,6\n4,7\n4,8\n8,10\n9,13\n";

/// Names alone link the cells of a CD table, by whatever rule the lineage has.
#[test]
fn cells_of_a_cd_table_are_linked_by_the_names_of_the_lineage() {
    let files = Files::new();
    let table = "cellTime,cell,time,size\negg:1,egg,1,40\nanimal:2,animal,2,30\nvegetal:2,vegetal,2,34\n\
        A1:3,A1,3,20\nA2:3,A2,3,18\nA1x:4,A1x,4,15\nA1y:4,A1y,4,15\n";
    let path = files.write("CD.csv", table);
    let lineage = read_embryo(&path, &TrackOptions::default(), &names()).unwrap();
    let mothers: Vec<Option<&str>> =
        lineage.cells.iter().map(|cell| cell.mother.map(|mother| lineage.cells[mother].name.as_str())).collect();
    assert_eq!(mothers, [None, Some("egg"), Some("egg"), Some("animal"), Some("animal"), Some("A1"), Some("A1")]);
    // Other names, matched to Sulston's.
    let mapped = files.write("CD2.csv", "cellTime,cell,time\nX:1,X,1\nXa:2,Xa,2\nXp:2,Xp,2\n");
    let map = "tracked,name\nX,AB\nXa,ABa\nXp,ABp\n";
    let matched = Names::default().matched_by(Matching::parse(map, "map.csv", &[], "--root").unwrap()).unwrap();
    let lineage = read_embryo(&mapped, &TrackOptions::default(), &matched).unwrap();
    assert_eq!((lineage.cells[0].name.as_str(), lineage.cells[0].daughters.len()), ("AB", 2));
}

struct Files {
    folder: tempfile::TempDir,
}

impl Files {
    fn new() -> Files {
        let files = Files { folder: tempfile::tempdir().unwrap() };
        files.write("e_spots.csv", SPOTS);
        files.write("e_edges.csv", EDGES);
        files
    }

    fn write(&self, name: &str, text: &str) -> PathBuf {
        let path = self.folder.path().join(name);
        fs::write(&path, text).unwrap();
        path
    }

    fn matching(&self, map: Option<&str>, roots: &[&str]) -> Result<Names, String> {
        let map = map.map(|text| self.write("map.csv", text));
        let roots: Vec<String> = roots.iter().map(|root| (*root).to_owned()).collect();
        let matching = Matching::read(map.as_deref(), &roots, "--root").map_err(|error| self.short(error))?;
        names().matched_by(matching).map_err(|error| self.short(error))
    }

    /// An error without the folder's name.
    fn short(&self, error: impl ToString) -> String {
        error.to_string().replace(&format!("{}/", self.folder.path().display()), "")
    }

    fn embryo(&self, map: Option<&str>, roots: &[&str]) -> Result<TrackedLineage, String> {
        let names = self.matching(map, roots)?;
        let read = || {
            let embryo = read_embryo(&self.folder.path().join("e_spots.csv"), &TrackOptions::default(), &names)?;
            names.require_met().map(|()| embryo)
        };
        read().map_err(|error| self.short(error))
    }
}

/// The lifetimes of a table.
fn lifetimes(path: &Path, names: Names) -> Result<Lifetimes, InputError> {
    Lifetimes::read_files(
        &embryo_files(&[path.to_owned()], TableKind::Lifetimes)?.0,
        &LifetimeOptions { names, ..LifetimeOptions::default() },
    )
}

fn named(embryo: &TrackedLineage) -> Vec<&str> {
    embryo.cells.iter().map(|cell| cell.name.as_str()).collect()
}

fn bys(matched: &Matched) -> Vec<(&str, By)> {
    matched.divisions.iter().map(|division| (division.mother.as_str(), division.by)).collect()
}

#[test]
fn cells_below_a_root_are_matched_by_size_then_descendants_then_order() {
    let files = Files::new();
    // ID1 is the only cell without a mother that divides.
    for root in ["egg", "ID1=egg", "2=egg"] {
        let embryo = files.embryo(None, &[root]).unwrap();
        assert_eq!(named(&embryo), ["egg", "ID9", "vegetal", "animal", "vegetalx", "vegetaly", "A2", "A1"], "{root}");
        let matched = embryo.matched.unwrap();
        // The daughters of ID3 have equal sizes and births. The daughters of ID4 differ in size, and the larger one is born later.
        assert_eq!(bys(&matched), [("egg", By::Sizes), ("vegetal", By::Order), ("animal", By::Sizes)]);
        assert_eq!((matched.without_name, matched.by_table, matched.unmatched.len()), (1, 0, 0));
        let chi = matched.divisions[0].chi.unwrap();
        assert!((chi - (729.0 - 216.0) / (729.0 + 216.0)).abs() < 1e-12, "{chi}");
    }
    // The daughters of the egg are nearly equal. Only the smaller one, ID3, has two generations below it, as the founder animal has
    // in the lineage.
    let text = "LABEL,ID,FRAME,RADIUS\nID11,11,9,2\nID12,12,9,2\nID14,14,9,9.1\n";
    let spots = SPOTS.replace("ID4,4,2,6", "ID4,4,2,9.1") + &text[text.find("ID11").unwrap()..];
    files.write("e_spots.csv", &spots.replace("ID7,7,4,3\nID8,8,5,4\nID10,10,6,4\n", ""));
    files.write("e_edges.csv", &(EDGES.replace("4,7\n4,8\n8,10\n", "4,14\n") + "5,11\n5,12\n"));
    let embryo = files.embryo(None, &["egg"]).unwrap();
    let matched = embryo.matched.as_ref().unwrap();
    assert_eq!(bys(matched), [("egg", By::Descendants)]);
    // A1 and A2 are founders of equal sizes.
    assert_eq!(matched.unmatched[0].mother, "animal");
    assert_eq!(matched.divisions[0].tracked_daughters, ["ID4", "ID3"]);
}

/// A recording of the Cell Tracking Challenge.
fn ctc(files: &Files, tracks: &str) -> PathBuf {
    fs::create_dir_all(files.folder.path().join("film")).unwrap();
    files.write("film/res_track.txt", tracks);
    files.folder.path().join("film")
}

/// Names of the worm, with a root.
fn of_worm(root: &str) -> Names {
    Names::default().matched_by(Matching::read(None, &[root.to_owned()], "--root").unwrap()).unwrap()
}

#[test]
fn without_sizes_the_order_of_divisions_decides() {
    let files = Files::new();
    let read = |tracks: &str| {
        let path = ctc(&files, tracks);
        let embryo = read_embryo(&path, &TrackOptions::default(), &of_worm("1=P0")).unwrap();
        let lives: Vec<(String, Option<f64>)> =
            embryo.cells.iter().map(|cell| (cell.name.clone(), cell.lifetime())).collect();
        (lives, embryo.matched.unwrap())
    };
    // AB divides before P1, which is followed until then.
    for tracks in
        ["1 0 0 0\n2 1 15 1\n3 1 16 1\n4 16 16 2\n5 16 16 2\n", "1 0 0 0\n3 1 16 1\n2 1 15 1\n4 16 16 2\n5 16 16 2\n"]
    {
        let (lives, matched) = read(tracks);
        assert!(
            lives.contains(&("AB".to_owned(), Some(15.0))) && lives.contains(&("P1".to_owned(), None)),
            "{lives:?}"
        );
        assert_eq!(bys(&matched), [("P0", By::Divisions), ("AB", By::Order)]);
        let text = matched.to_string();
        assert!(text.contains("  daughters of 1 by the order of their divisions: P0\n"), "{text}");
        assert!(text.contains("  daughters of 1 by their order in the file: AB\n"), "{text}");
    }
    // The other daughter is lost before, both are lost, or both divide in one frame: nothing tells AB from P1.
    for tracks in [
        "1 0 0 0\n2 1 15 1\n3 1 12 1\n4 16 16 2\n5 16 16 2\n",
        "1 0 0 0\n2 1 15 1\n3 1 15 1\n",
        "1 0 0 0\n2 1 15 1\n3 1 15 1\n4 16 16 2\n5 16 16 2\n6 16 16 3\n7 16 16 3\n",
    ] {
        let matched = read(tracks).1;
        assert_eq!((bys(&matched), matched.unmatched[0].mother.as_str()), (vec![], "P0"));
        let why = "sizes and divisions do not show which is AB and which is P1: a table of names (--names) can";
        assert_eq!(matched.unmatched[0].why, why);
    }
}

/// Sulston's chart up to a minute, as tracks in any order: each cell's name by its label.
fn cut(end: u32, is_turned: bool) -> (String, Vec<String>) {
    let rows: Vec<(&str, &str, u32)> = furrow_measured::published::sulston()
        .filter_map(|(cell, mother, birth)| Some((cell, mother, birth? as u32)))
        .filter(|(.., birth)| *birth < end)
        .collect();
    let label = |name: &str| rows.iter().position(|(cell, ..)| *cell == name).map_or(0, |at| at + 1);
    let line = |(cell, mother, birth): &(&str, &str, u32)| {
        let divides = rows.iter().find(|(_, mother, _)| mother == cell).map_or(end, |(.., birth)| *birth);
        format!("{} {birth} {} {}\n", label(cell), divides - 1, label(mother))
    };
    let mut lines: Vec<String> = rows.iter().map(line).collect();
    if is_turned {
        lines.reverse();
    }
    (lines.concat(), rows.iter().map(|(cell, ..)| (*cell).to_owned()).collect())
}

/// The recording has no sizes. No founder gets a wrong name, in either order of the tracks.
#[test]
fn founders_in_sulstons_chart_cut_at_any_minute_get_no_wrong_names() {
    let files = Files::new();
    for (end, is_turned, named) in
        [(30, false, 1), (61, true, 3), (75, true, 3), (105, false, 5), (150, true, 5), (200, false, 5), (300, true, 5)]
    {
        let (tracks, names) = cut(end, is_turned);
        let embryo = read_embryo(&ctc(&files, &tracks), &TrackOptions::default(), &of_worm("1=P0")).unwrap();
        let founders = ["P0", "AB", "P1", "EMS", "P2", "MS", "E", "C", "P3", "D", "P4"];
        let mut right = 0;
        for cell in &embryo.cells {
            let own = &names[cell.tracked.parse::<usize>().unwrap() - 1];
            let is_named = cell.name != cell.tracked;
            if is_named && (founders.contains(&own.as_str()) || founders.contains(&cell.name.as_str())) {
                assert_eq!(&cell.name, own, "{end}");
                right += 1;
            }
            // Letters depend on the order of tracks, founders do not.
            let founder = |name: &str| furrow_measured::names::founder(name).map(str::to_owned);
            assert!(!is_named || founder(&cell.name) == founder(own), "{end} {own} {}", cell.name);
        }
        assert_eq!(right, named, "{end}");
    }
}

#[test]
fn a_table_gives_names_and_decides_which_daughter_is_which() {
    let files = Files::new();
    let embryo =
        files.embryo(Some("tracked,name\nID4,vegetal\n5,animalx\n"), &[]).map(|embryo| named(&embryo).join(" "));
    // The lineage has founders below animal, so no animalx.
    assert!(
        embryo
            .unwrap_err()
            .starts_with("map.csv:3:1: name = \"animalx\": must be a name of the lineage's: egg, animal")
    );
    let embryo = files.embryo(Some("tracked,name\nID4,vegetal\n6,A2\n"), &["egg"]).unwrap();
    assert_eq!(named(&embryo), ["egg", "ID9", "animal", "vegetal", "A1", "A2", "vegetaly", "vegetalx"]);
    let matched = embryo.matched.unwrap();
    assert_eq!(bys(&matched), [("egg", By::Names), ("animal", By::Names), ("vegetal", By::Sizes)]);
    assert_eq!(matched.by_table, 2);
    let text = matched.to_string();
    assert!(
        text.starts_with(
            "cells of e_spots matched; 1 have no name in the lineage\n  2 by the table of names\n  root ID1 = egg\n"
        ),
        "{text}"
    );
    assert!(text.contains("  daughters of 2 by names: egg, animal\n  daughters of 1 by sizes: vegetal\n"), "{text}");
}

#[test]
fn what_cannot_be_matched_is_reported() {
    let files = Files::new();
    // ID5 is no daughter of the cell that is called animal.
    let embryo = files.embryo(Some("tracked,name\nID5,A1\n"), &["egg"]).unwrap();
    assert_eq!(named(&embryo), ["egg", "ID9", "vegetal", "animal", "A1", "ID6", "A2", "A1"]);
    let unmatched = embryo.matched.unwrap().unmatched;
    assert_eq!((unmatched[0].mother.as_str(), unmatched[0].tracked.as_str()), ("vegetal", "ID3"));
    assert_eq!(unmatched[0].why, "they are A1 and without a name, not vegetalx and vegetaly");
}

#[test]
fn wrong_maps_and_roots_are_refused_with_their_place() {
    let files = Files::new();
    for (map, roots, message) in [
        (
            Some("a,b\n1,egg\n"),
            &[][..],
            "map.csv:1:1: no column is called tracked or name; a map of names has the columns",
        ),
        (Some("tracked,name\n"), &[], "map.csv: rows = 0: must be at least one"),
        (Some("tracked,name\nID1,\n"), &[], "map.csv:2:1: name is empty"),
        (
            Some("tracked,name\nID1,egg\nID1,animal\n"),
            &[],
            "map.csv:3:1: a second name of \"ID1\"; line 2 calls it egg",
        ),
        (Some("tracked,name\nID1,egg\nID3,egg\n"), &[], "map.csv:3:1: a second cell called egg; \"ID1\" on line 2 is"),
        (Some("tracked,name\nID1,eg\n"), &[], "did you mean egg?"),
        (Some("tracked,name\nID1,AB\n"), &[], "map.csv:2:1: name = \"AB\": must be a name of the lineage's"),
        (
            Some("tracked,name\nID1,egg\nID99,animal\n"),
            &[],
            "map.csv:3:1: tracked = \"ID99\": must be a cell in the tables",
        ),
        (Some("tracked,name\nID1,egg\n2,animal\n"), &[], "map.csv:3:1: \"ID1\" and \"2\" are the same cell"),
        (
            Some("tracked,name,embryo\nID1,egg,other\n"),
            &[],
            "map.csv:2:1: embryo = \"other\": must be an embryo of the tables",
        ),
        (None, &["ID99=egg"], "--root: root = \"ID99\": must be a cell of a tracked embryo"),
        (None, &["=egg"], "--root: root = \"=egg\": must be TRACKED=NAME, or NAME"),
        (None, &["ID1=eg"], "--root: name of a root = \"eg\": must be a name of the lineage's"),
        (None, &["egg", "ID3=egg"], "must be another cell and another name than the roots before"),
    ] {
        let error = files.embryo(map, roots).unwrap_err();
        assert!(error.contains(message), "{error}\n{message}");
    }
    files.write("e_edges.csv", &EDGES.replace("2,4\n", ""));
    let error = files.embryo(None, &["egg"]).unwrap_err();
    let message = "must be TRACKED=egg with one of the cells of e_spots that have no mother: ID1 (2 descendants), ID4 (2 descendants)";
    assert!(error.contains(message), "{error}");
    // A table of cells has no mothers.
    let table = files.write("t.csv", "cell,lifetime_min\negg,9\n");
    let names = files.matching(None, &["egg"]).unwrap();
    lifetimes(&table, names.clone()).unwrap();
    let error = names.require_met().unwrap_err();
    assert!(error.to_string().contains("given with an embryo that has mothers and daughters"), "{error}");
}

#[test]
fn tables_of_volumes_divisions_and_lifetimes_use_the_map() {
    let files = Files::new();
    let map = "tracked,name,embryo\n7,animal,e1\n8,vegetal,e1\n7,vegetal,e2\n8,animal,e2\n1,egg,\n";
    let read = |text: &str, names: &Names| {
        let mut volumes = Volumes::default();
        let options = ReadOptions { names: names.clone(), ..ReadOptions::default() };
        volumes.read(text.as_bytes(), "t.csv", &options).unwrap();
        volumes
    };
    let names = files.matching(Some(map), &[]).unwrap();
    let volumes = read("embryo,cell,volume_um3\ne1,7,1\ne1,8,3\ne2,7,4\ne2,8,1\ne2,other,1\n", &names);
    let found = divisions(&volumes).divisions;
    // The animal cell is listed first.
    assert_eq!(found.iter().map(|division| division.chi_signed).collect::<Vec<_>>(), [-0.5, -0.6]);
    assert_eq!(volumes.skipped[0].why, "no name of the lineage's cells, and none was matched to it");
    assert!(names.require_met().unwrap_err().to_string().contains("map.csv:6:1: tracked = \"1\": must be a cell"));
    let chi = read("embryo,mother,chi\ne1,1,0.2\n", &names);
    assert_eq!(divisions(&chi).divisions[0].mother, "egg");
    names.require_met().unwrap();
    let lives = lifetimes(
        &files.write("t.csv", "cell,lifetime_min\n12,9\n13,8\n"),
        files.matching(Some("id;cell\n12;egg\n13;animal\n"), &[]).unwrap(),
    );
    assert_eq!(lives.unwrap().cells.iter().map(|life| life.cell.as_str()).collect::<Vec<_>>(), ["egg", "animal"]);
}
