//! Wrong and missing links, and links that contradict names.

use super::*;

/// Spots of TrackMate by name, id and frame, with these edges.
fn trackmate(spots: &[(&str, u32, u32)], edges: &[(u32, u32)]) -> (TempDir, PathBuf) {
    let rows: String = spots.iter().map(|(name, id, t)| format!("{name},{id},0,{t}\n")).collect();
    let (folder, path) = file("a_spots.csv", format!("LABEL,ID,TRACK_ID,FRAME\n{rows}"));
    let rows: String = edges.iter().map(|(a, b)| format!("{a},{b}\n")).collect();
    fs::write(folder.path().join("a_edges.csv"), format!("SPOT_SOURCE_ID,SPOT_TARGET_ID\n{rows}")).unwrap();
    (folder, path)
}

/// A table of spots with their mothers and names.
fn table(rows: &[(u32, Option<u32>, u32, &str)]) -> String {
    let row = |(id, parent, t, name): &(u32, Option<u32>, u32, &str)| {
        format!("{id},{},{t},1,1,1,{name}\n", parent.map_or(String::new(), |id| id.to_string()))
    };
    format!("id,parent_id,t,z,y,x,name\n{}", rows.iter().map(row).collect::<String>())
}

/// The embryo of a table, as commands use it.
fn named(text: &str) -> TrackedLineage {
    let (_folder, path) = file("a.csv", text);
    read_embryo(&path, &TrackOptions::default(), &Names::default()).unwrap()
}

/// Divisions are looked for without the links of spots with two mothers, in any order of the links.
#[test]
fn a_wrong_link_to_another_cell_ends_no_cell() {
    let frames = [0, 1, 2, 3, 4, 4, 1, 2, 3, 4];
    let names: Vec<String> = (0..10).map(|id| format!("ID{id}")).collect();
    let spots: Vec<(&str, u32, u32)> = (0..10).map(|id| (&*names[id as usize], id, frames[id as usize])).collect();
    let right = [(0, 1), (1, 2), (2, 3), (3, 4), (3, 5), (0, 6), (6, 7), (7, 8), (8, 9)];
    for wrong in 0..=right.len() {
        let mut edges = right.to_vec();
        edges.insert(wrong, (1, 9));
        let (_folder, path) = trackmate(&spots, &edges);
        let lineage = tracked(&path);
        let life = |name: &str| lineage.cells.iter().find(|cell| cell.name == name).and_then(TrackedCell::lifetime);
        assert_eq!((life("ID1"), lineage.cells.len()), (Some(3.0), 6), "{wrong}");
        assert_eq!(lineage.skipped_count, 1);
        assert!(lineage.skipped[0].why.ends_with("it is left without a mother"), "{:?}", lineage.skipped);
    }
    // Neither does a link that would be the third of a cell.
    let (_folder, path) = trackmate(&spots, &[&right[..], &[(3, 9)]].concat());
    let lineage = tracked(&path);
    assert_eq!(lineage.cells.iter().find(|cell| cell.name == "ID1").unwrap().daughters.len(), 2);
}

/// A track that follows another one without a gap is a daughter; after a gap it is the same cell.
#[test]
fn a_single_track_of_the_cell_tracking_challenge_is_a_daughter_unless_there_is_a_gap() {
    let rest = "5 31 45 4\n6 31 45 4\n";
    let lineage = embryo("res_track.txt", format!("1 0 0 0\n2 1 15 1\n3 1 17 1\n4 16 30 2\n{rest}"));
    let lives_of = lives(&lineage);
    assert_eq!(lives_of[1], ("2", Some("1"), 1.0, Some(16.0), 15.0));
    assert_eq!(lives_of[3], ("4", Some("2"), 16.0, Some(31.0), 30.0));
    let lineage = embryo("res_track.txt", format!("1 0 0 0\n2 1 15 1\n3 1 17 1\n4 17 30 2\n{rest}"));
    assert_eq!(lives(&lineage)[1], ("2", Some("1"), 1.0, Some(31.0), 30.0));
}

/// AB's daughters by links are EMS and P2, while ABa and ABp have no mother.
#[test]
fn names_come_before_links_that_contradict_them() {
    let lineage = named(&table(&[
        (0, None, 0, "P0"),
        (1, Some(0), 1, "AB"),
        (2, Some(1), 2, "AB"),
        (3, Some(0), 1, "P1"),
        (4, Some(3), 2, "P1"),
        (5, Some(4), 3, "P1"),
        (6, None, 3, "ABa"),
        (7, None, 3, "ABp"),
        (8, Some(2), 4, "EMS"),
        (9, Some(2), 4, "P2"),
    ]));
    let right = [
        ("P0", None, 0.0, Some(1.0), 0.0),
        ("AB", Some("P0"), 1.0, Some(3.0), 2.0),
        ("P1", Some("P0"), 1.0, Some(4.0), 3.0),
        ("ABa", Some("AB"), 3.0, None, 3.0),
        ("ABp", Some("AB"), 3.0, None, 3.0),
        ("EMS", Some("P1"), 4.0, None, 4.0),
        ("P2", Some("P1"), 4.0, None, 4.0),
    ];
    assert_eq!(lives(&lineage), right);
    let why = "a link makes it a daughter of AB (line 3), and by its name it has the mother P1: names are used";
    assert_eq!(reports(&lineage), [format!("10 name EMS: {why}"), format!("11 name P2: {why}")]);
    let names = Names::default();
    let found = lineage.rounds(&["P0", "AB", "P1"], &names);
    let rounds = found.founders;
    assert_eq!(rounds, [rounds_of("P0", 4, 2, 2.0, 2), rounds_of("AB", 2, 1, 1.0, 1), rounds_of("P1", 2, 1, 1.0, 1)]);
    assert_eq!(found.terminal, 4);
}

/// A name that skips a generation is no daughter, and the cell before it was not seen to divide.
#[test]
fn a_grandmother_is_no_mother() {
    let lineage = named(&table(&[(1, None, 1, "AB"), (2, Some(1), 2, "ABal"), (3, Some(1), 2, "ABar")]));
    let right = [("AB", None, 1.0, None, 1.0), ("ABal", None, 2.0, None, 2.0), ("ABar", None, 2.0, None, 2.0)];
    assert_eq!(lives(&lineage), right);
    assert!(lineage.skipped[1].why.starts_with("a link makes it a daughter of AB (line 2), and by its name"));
    // Names of other animals and labels say nothing.
    let lineage = named(&table(&[(1, None, 1, "x"), (2, Some(1), 2, "ABal"), (3, Some(1), 2, "17")]));
    assert_eq!((lineage.cells[1].mother, lineage.cells[2].mother, lineage.skipped_count), (Some(0), Some(0), 0));
}

/// Two cells have exchanged names: the links below them are dropped.
#[test]
fn cells_are_not_linked_by_names_past_a_gap() {
    let lineage = named(&table(&[
        (1, None, 1, "AB"),
        (2, None, 1, "P1"),
        (3, Some(1), 4, "EMS"),
        (4, Some(1), 4, "P2"),
        (5, Some(2), 2, "ABa"),
        (6, Some(2), 2, "ABp"),
    ]));
    let right = [
        ("AB", None, 1.0, Some(2.0), 1.0),
        ("P1", None, 1.0, None, 1.0),
        ("ABa", Some("AB"), 2.0, None, 2.0),
        ("ABp", Some("AB"), 2.0, None, 2.0),
        ("EMS", None, 4.0, None, 4.0),
        ("P2", None, 4.0, None, 4.0),
    ];
    assert_eq!(lives(&lineage), right);
}

/// A daughter is not born with a cell that is no sister of hers.
#[test]
fn a_daughter_is_born_when_she_is_seen_if_her_sister_is_none() {
    let lineage = named(&table(&[(1, None, 1, "AB"), (2, Some(1), 2, "EMS"), (3, Some(1), 3, "ABa")]));
    let right = [("AB", None, 1.0, Some(3.0), 1.0), ("EMS", None, 2.0, None, 2.0), ("ABa", Some("AB"), 3.0, None, 3.0)];
    assert_eq!(lives(&lineage), right);
}

/// Where the sister has a daughter's name, the division is real.
#[test]
fn a_daughter_with_the_name_of_her_mother_ends_no_division() {
    let lineage =
        named(&table(&[(0, None, 0, "P0"), (1, Some(0), 1, "AB"), (2, Some(1), 2, "AB"), (3, Some(1), 2, "ABp")]));
    let ab = lineage.cells.iter().find(|cell| cell.name == "AB" && cell.mother.is_some()).unwrap();
    assert_eq!((ab.division, ab.daughters.len()), (Some(2.0), 1));
    let why = "a link makes it a daughter of AB (line 3), and by its name it has the mother P0: names are used";
    assert_eq!(reports(&lineage), [format!("4 name AB: {why}")]);
}

/// By name AB goes on in the branch that was followed further.
#[test]
fn a_cell_that_divides_into_itself_is_one_cell() {
    let lineage = named(&table(&[
        (1, None, 1, "AB"),
        (2, Some(1), 2, "AB"),
        (3, Some(1), 2, "AB"),
        (4, Some(3), 3, "AB"),
        (5, Some(4), 4, "ABa"),
        (6, Some(4), 4, "ABp"),
    ]));
    let right = [
        ("AB", None, 1.0, Some(4.0), 3.0),
        ("AB", None, 2.0, None, 2.0),
        ("ABa", Some("AB"), 4.0, None, 4.0),
        ("ABp", Some("AB"), 4.0, None, 4.0),
    ];
    let mut found = lives(&lineage);
    found.sort_by(|one, other| (one.0, one.2).partial_cmp(&(other.0, other.2)).unwrap());
    assert_eq!(found, right);
    assert_eq!(
        reports(&lineage),
        ["3 name AB: it branches off AB, which goes on by its name: it is left without a mother"]
    );
}

/// A cell that is lost at a broken link is reported with the lifetimes, too.
#[test]
fn a_second_cell_of_a_name_is_reported_with_lifetimes() {
    let (_folder, path) = file(
        "a.csv",
        table(&[
            (0, None, 0, "P0"),
            (1, Some(0), 1, "AB"),
            (2, None, 2, "AB"),
            (3, Some(0), 1, "P1"),
            (4, Some(2), 3, "ABa"),
            (5, Some(2), 3, "ABp"),
            (6, Some(3), 2, "EMS"),
            (7, Some(3), 2, "P2"),
        ]),
    );
    let found = lifetimes(&path, Some(1.0)).unwrap();
    let cells: Vec<(&str, f64)> = found.cells.iter().map(|life| (life.cell.as_str(), life.mean)).collect();
    assert_eq!(cells, [("P1", 1.0)]);
    let second = &found.skipped[0];
    let why = "a second cell of this name; the first begins on line 3";
    assert_eq!((second.line, second.value.as_str(), second.why.as_str(), found.skipped_count), (4, "AB", why, 1));
}

/// A sister that is detected late was born with the other one.
#[test]
fn sisters_are_born_at_one_division() {
    let rows = |text: &str| text.split(' ').map(|row| format!("{row},1\n")).collect::<String>();
    let table = rows("P0:1 AB:2 AB:3 P1:2 P1:3 P1:4 ABa:4 ABa:5 ABa:6 ABp:6 ABal:7 ABar:7 ABpl:7 ABpr:7");
    let lineage = embryo("CD.csv", format!("Cell & Time,X\n{table}"));
    let life = |name: &str| lineage.cells.iter().find(|cell| cell.name == name).unwrap().lifetime();
    assert_eq!([life("AB"), life("ABa"), life("ABp")], [Some(2.0), Some(3.0), Some(3.0)]);
    let why = "11 first time of ABp 6: its sister is seen from time 4 on: both are born then";
    assert_eq!(reports(&lineage), [why]);
    // Both are late: the time between is not known.
    let lineage = embryo("CD.csv", format!("Cell & Time,X\n{}", rows("AB:1 AB:2 ABa:5 ABp:5")));
    assert_eq!(lineage.cells[0].division, Some(5.0));
    let why = "4 first time of ABa 5: its mother was seen last at time 2: the division may be earlier";
    assert_eq!(reports(&lineage), [why]);
}

/// A nucleus without a name is found by its frame and number.
#[test]
fn roots_without_names_are_listed_by_what_stands_for_them() {
    let line = |k: u32, before: i32, after: &str| format!("{k},1,{before},{after},0,0,0,9,,0\n");
    let frames = [
        line(1, -1, "1,2") + &line(2, -1, "3,4"),
        line(1, 1, "-1,-1") + &line(2, 1, "-1,-1") + &line(3, 2, "-1,-1") + &line(4, 2, "-1,-1"),
    ];
    let folder = nuclei(&[&frames[0], &frames[1]]);
    let with = |root: &str| {
        let matching = crate::matching::Matching::read(None, &[root.to_owned()], "--root").unwrap();
        read_embryo(folder.path(), &TrackOptions::default(), &Names::default().matched_by(matching).unwrap())
    };
    let error = with("P0").unwrap_err().to_string();
    assert!(error.ends_with("that have no mother: 1:1 (2 descendants), 1:2 (2 descendants)"), "{error}");
    let embryo = with("1:2=P0").unwrap();
    assert_eq!(embryo.cells.iter().filter(|cell| cell.name == "P0").count(), 1);
}
