//! Spots and links: TrackMate, Mastodon, GEFF.

use serde_json::json;

use super::*;

const TRACKMATE_SPOTS: &str = "\
LABEL,ID,TRACK_ID,QUALITY,POSITION_X,POSITION_Y,POSITION_Z,POSITION_T,FRAME,RADIUS,VISIBILITY
Label,Spot ID,Track ID,Quality,X,Y,Z,T,Frame,Radius,Visibility
Label,Spot ID,Track ID,Quality,X,Y,Z,T,Frame,R,Visibility
,,,(quality),(micron),(micron),(micron),(sec),,(micron),
P0,10,0,1,1,1,1,60,1,20,1
ID11,11,0,1,1,1,1,120,2,20,1
AB,12,0,1,1,1,1,180,3,15,1
P1,13,0,1,1,1,1,180,3,10,1
AB,14,0,1,1,1,1,240,4,15,1
P1,15,0,1,1,1,1,360,6,10,1
ABa,16,0,1,1,1,1,300,5,11,1
ABp,17,0,1,1,1,1,300,5,12,1
ABa,18,0,1,1,1,1,360,6,11,1
ABp,19,0,1,1,1,1,360,6,12,1
";

const EDGES: [(u32, u32); 9] =
    [(10, 11), (11, 12), (13, 11), (12, 14), (13, 15), (14, 16), (14, 17), (16, 18), (17, 19)];

fn trackmate_edges(edges: &[(u32, u32)]) -> String {
    let heading = "LABEL,TRACK_ID,SPOT_SOURCE_ID,SPOT_TARGET_ID\nLabel,Track ID,Source spot ID,Target spot ID\n\
                   Label,Track ID,Source ID,Target ID\n,,,\n";
    heading.to_owned() + &edges.iter().map(|(a, b)| format!("ID{a} → ID{b},0,{a},{b}\n")).collect::<String>()
}

fn trackmate(spots: &str, edges: &str) -> (TempDir, PathBuf) {
    let (folder, path) = file("film_spots.csv", spots);
    fs::write(folder.path().join("film_edges.csv"), edges).unwrap();
    (folder, path)
}

fn of_trackmate(spots: &str, edges: &str) -> TrackedLineage {
    tracked(&trackmate(spots, edges).1)
}

#[test]
fn trackmate_and_mastodon_give_the_same_cells() {
    // One edge leads backwards in time, as TrackMate may write it.
    let lineage = of_trackmate(TRACKMATE_SPOTS, &trackmate_edges(&EDGES));
    assert_eq!((lineage.format, lineage.volumes), (Format::TrackMate, Unit::CubicMicrometres));
    assert_eq!(lives(&lineage), LIVES);
    assert!((lineage.cells[0].volume.unwrap() - 33_510.321_638_291_13).abs() < 1e-9);

    let spots = TRACKMATE_SPOTS.lines().skip(4).map(|line| {
        let field: Vec<&str> = line.split(',').collect();
        format!("{},{},{},1.0,2.0,3.0,{},0\n", field[0], field[1], field[8], field[9])
    });
    let spots: String = spots.collect();
    let heading = "\"Label\",\"ID\",\"Spot frame\",\"Spot position\",\"Spot position\",\"Spot position\",\"Spot radius\",\"Spot track ID\"\n\
                   \"\",\"\",\"\",\"X\",\"Y\",\"Z\",\"\",\"\"\n\"\",\"\",\"\",\"(pixel)\",\"(pixel)\",\"(pixel)\",\"(pixel)\",\"\"\n";
    let (folder, path) = file("film-Spot.csv", format!("{heading}{spots}"));
    let links: String = EDGES.iter().map(|(a, b)| format!("{a} - {b},0,1.5,{a}.0,{b}\n")).collect();
    let heading =
        "Label,ID,Link displacement,Link target IDs,Link target IDs\n,,,Source spot id,Target spot id\n,,(pixel),,\n";
    fs::write(folder.path().join("film-Link.csv"), format!("{heading}{links}")).unwrap();
    let lineage = tracked(&path);
    assert_eq!((lineage.format, lineage.volumes), (Format::Mastodon, Unit::Voxels));
    assert_eq!(lives(&lineage), LIVES);
    let error = refused(&folder.path().join("film-Link.csv"));
    assert_eq!(error, "film-Link.csv: is not a table of spots: it has links; they are read with their spots");
}

/// A spot that cannot be used or is given twice costs no other spot, and cells go on past it.
#[test]
fn unusable_and_repeated_spots_and_links_are_left_out() {
    // The last spot of a cell may be the one that is left out.
    let ends_of = |lives: &[Life<'_>]| {
        lives.iter().map(|life| format!("{:?}", (life.0, life.1, life.2, life.3))).collect::<Vec<_>>()
    };
    let ends = |lineage: &TrackedLineage| ends_of(&lives(lineage));
    let forwards = EDGES.map(|(a, b)| (a.min(b), a.max(b)));
    let edges = trackmate_edges(&forwards);
    let twice = |row: &str| (row.to_owned(), format!("{row}{row}"));
    let replaced = |from: &str, to: &str| (from.to_owned(), to.to_owned());
    for (is_spot, (from, to), why) in [
        (true, replaced("ID11,11,", "ID11,-11,"), "6 ID -11: must be a whole number from 0"),
        (true, replaced("120,2,20", "120,NaN,20"), "6 FRAME NaN: must be a whole number from 0"),
        (true, twice("ID11,11,0,1,1,1,1,120,2,20,1\n"), "7 ID 11: the row of line 6 a second time"),
        (false, twice("ID11 → ID12,0,11,12\n"), "7 link AB: a second link from \"ID11\" (film_spots.csv:6) to"),
    ] {
        let (spots, edges) = match is_spot {
            true => (TRACKMATE_SPOTS.replace(&from, &to), edges.clone()),
            false => (TRACKMATE_SPOTS.to_owned(), edges.replace(&from, &to)),
        };
        let (folder, path) = trackmate(&spots, &edges);
        let (lineage, folder) = (tracked(&path), format!("{}/", folder.path().display()));
        assert_eq!(ends(&lineage), ends_of(&LIVES), "{to}");
        let reports = reports(&lineage).join("\n").replace(&folder, "");
        // Without its only spot before the division the last time of a mother is unknown, which is a second report.
        let count = 1 + u64::from(reports.contains("its mother was seen last at time 1: the division may be earlier"));
        assert!(reports.starts_with(why) && lineage.skipped_count == count, "{reports}\n{why}");
    }
    for version in [2, 3] {
        let mut files = geff(version, 10);
        let times =
            files.iter_mut().find(|(name, _)| name.ends_with("props/t/values/0") || name.ends_with("t/values/c/0"));
        times.unwrap().1[32..40].copy_from_slice(&f64::NAN.to_le_bytes());
        let lineage = tracked(&written(&files).path().join("embryo.geff"));
        assert_eq!(ends(&lineage), ends_of(&LIVES));
        assert_eq!(reports(&lineage), ["0 nodes/props/t of node 14 NaN: must be a number"]);
    }
}

/// Single spots of TrackMate are no cells; of Mastodon they are, but do not push out the cell of their name.
#[test]
fn single_spots_push_out_no_cell() {
    let stray = "AB,30,,1,1,1,1,60,1,9,1\n,31,,1,1,1,1,60,1,9,1\n";
    let lineage = of_trackmate(&(TRACKMATE_SPOTS.to_owned() + stray), &trackmate_edges(&EDGES));
    assert_eq!(lives(&lineage), LIVES);
    assert_eq!(
        reports(&lineage),
        ["15 ID 30: no link of film_edges.csv names it, so that it belongs to no track; there are 2 such spots"]
    );
    assert_eq!((lineage.place_of("30"), lineage.place_of("AB")), (Place::Nowhere, Place::Cell(1)));

    let spots = "Label,ID,Spot frame\nAB,9,0\nABa,8,0\nP0,1,1\nAB,2,2\nP1,3,2\nAB,4,3\n";
    let (folder, path) = file("film-Spot.csv", spots);
    let links = "Source spot id,Target spot id\n1,2\n1,3\n2,4\n";
    fs::write(folder.path().join("film-Link.csv"), links).unwrap();
    let lineage = tracked(&path);
    let names: Vec<(&str, u64)> = lineage.cells.iter().map(|cell| (&*cell.name, cell.place.1)).collect();
    assert_eq!(names, [("ABa", 3), ("P0", 4), ("AB", 5), ("P1", 6), ("AB", 2)]);
    assert_eq!(lineage.cells[1].daughters, [2, 3]);
    assert_eq!((lineage.cells[2].mother, lineage.cells[4].mother), (Some(1), None));
    let (skipped, count) = lineage.skipped_with_names(&Names::default());
    assert_eq!((count, skipped[0].line), (1, 2));
    assert_eq!(skipped[0].why, "a second cell of this name; the first begins on line 5");
}

#[test]
fn wrong_spots_and_links_are_refused_with_their_place() {
    let fine = trackmate_edges(&EDGES);
    for (change, message) in cases(include_str!("wrong_spots.txt")) {
        let (mut spots, mut edges) = (TRACKMATE_SPOTS.to_owned(), fine.clone());
        match change[..] {
            ["spots", from, to] => spots = spots.replace(from, to),
            ["edges", from, to] => edges = edges.replace(from, to),
            ["add", from, to] => edges += &format!("ID{from} → ID{to},0,{from},{to}\n"),
            _ => panic!("{change:?}"),
        }
        assert!(spots != TRACKMATE_SPOTS || edges != fine, "{change:?}");
        let (_folder, path) = trackmate(&spots, &edges);
        let error = refused(&path);
        assert!(error.contains(message), "{error}\n{message}");
    }
    let spots = |from: &str, to: &str| TRACKMATE_SPOTS.replace(from, to);
    // Without a heading that it knows a table is of no program, and without radii cells have no size.
    let (_folder, path) = trackmate(&spots("FRAME", "FRAMES"), &fine);
    assert!(read_tracked(&path, &TrackOptions::default()).unwrap().is_none());
    assert!(of_trackmate(&spots(",RADIUS", ",FRAMEX"), &fine).cells[0].volume.is_none());
    let none = TRACKMATE_SPOTS.lines().take(4).collect::<Vec<_>>().join("\n");
    let (_folder, path) = trackmate(&none, &fine);
    assert!(refused(&path).contains("must be the ID of a spot"));
    let error = refusal("film_spots.csv", TRACKMATE_SPOTS);
    assert!(
        error.contains("links = none: must be beside a table of links (film_edges.csv or film_links.csv)"),
        "{error}"
    );
    let skipped = &of_trackmate(&spots("180,3,15", "180,3,0"), &fine).skipped[0];
    assert_eq!((skipped.line, skipped.column.as_str(), skipped.value.as_str()), (7, "RADIUS", "0"));
}

/// As Excel saves them where decimals have a comma, with a column that has no name and no values.
#[test]
fn spots_with_decimal_commas_are_those_with_points() {
    let written = |table: &str| table.replace(',', ";").replace('\n', ";\n");
    let spots = |sign: char| written(TRACKMATE_SPOTS).replace(";15;1;", &format!(";15{sign}5;1;"));
    let volumes = [',', '.'].map(|sign| {
        let lineage = of_trackmate(&spots(sign), &written(&trackmate_edges(&EDGES)));
        assert_eq!((lives(&lineage), lineage.skipped_count), (LIVES.to_vec(), 0));
        lineage.cells.iter().map(|cell| cell.volume).collect::<Vec<_>>()
    });
    assert_eq!(volumes[0], volumes[1]);
    assert!(volumes[0].contains(&Some(std::f64::consts::FRAC_PI_6 * 31_f64.powi(3))));
}

/// Two cells that become one, or one that becomes three, cost these cells and not the file.
#[test]
fn merges_and_triple_splits_cost_the_cell() {
    let lives_of = |edges: &[(u32, u32)]| {
        let (_folder, path) = trackmate(TRACKMATE_SPOTS, &trackmate_edges(&[&EDGES[..], edges].concat()));
        let lineage = tracked(&path);
        let place = format!("{}/", path.parent().unwrap().display());
        let why: Vec<String> =
            lineage.skipped.iter().map(|s| format!("{} {}: {}", s.line, s.value, s.why.replace(&place, ""))).collect();
        let lives: Vec<(String, Option<usize>, Option<f64>)> =
            lineage.cells.iter().map(|cell| (cell.name.clone(), cell.mother, cell.division)).collect();
        (lives, why)
    };
    // The second spot of AB also comes from P1: AB is not followed further, and P1 goes on under its name.
    let (lives, why) = lives_of(&[(13, 14)]);
    let from =
        "it comes from \"AB\" (film_spots.csv:7) and from \"P1\" (film_spots.csv:8): it is left without a mother";
    assert_eq!(why, [format!("14 AB: {from}")]);
    let life = |name: &str, mother, division| (name.to_owned(), mother, division);
    let after = [life("AB", None, Some(5.0)), life("ABa", Some(3), None), life("ABp", Some(3), None)];
    let before = [life("P0", None, Some(3.0)), life("AB", Some(0), None), life("P1", Some(0), None)];
    assert_eq!(lives, [&before[..], &after].concat());
    // AB has three daughters.
    let (lives, why) = lives_of(&[(14, 15)]);
    assert_eq!(why.len(), 1);
    assert!(why[0].starts_with("14 P1: it comes from \"P1\""), "{why:?}");
    assert_eq!(lives.len(), 6);
    let edges: Vec<(u32, u32)> = EDGES.iter().copied().filter(|edge| *edge != (13, 15)).chain([(14, 15)]).collect();
    let lineage = of_trackmate(TRACKMATE_SPOTS, &trackmate_edges(&edges));
    assert!(lineage.skipped[0].why.starts_with("a third link from \"AB\""), "{:?}", lineage.skipped);
    let ab = lineage.cells.iter().find(|cell| cell.name == "AB").unwrap();
    assert_eq!((ab.division, ab.daughters.len(), lineage.skipped_count), (None, 0, 1));
    assert!(lineage.cells.iter().filter(|cell| cell.name.starts_with("ABa")).all(|cell| cell.mother.is_none()));
}

/// People remove the lines of a heading that their programs cannot read, of one table or of both, or add a column of row numbers.
#[test]
fn headings_of_any_number_of_lines_are_read() {
    let without = |text: &str, lines: &[usize]| {
        let kept = text.lines().enumerate().filter(|(k, _)| !lines.contains(k));
        kept.map(|(_, line)| format!("{line}\n")).collect::<String>()
    };
    let edges = trackmate_edges(&EDGES);
    let one = [1, 2, 3];
    for (of_spots, of_edges) in
        [(&one[..], &one[..]), (&one, &[]), (&[], &one), (&[3], &[1]), (&[0], &[0]), (&[0, 1], &[0, 1]), (&[], &[3])]
    {
        let (_folder, path) = trackmate(&without(TRACKMATE_SPOTS, of_spots), &without(&edges, of_edges));
        match read_tracked(&path, &TrackOptions::default()).unwrap() {
            Some(lineage) => {
                assert_eq!((lives(&lineage), lineage.skipped_count), (LIVES.to_vec(), 0), "{of_spots:?} {of_edges:?}");
                let unit = if of_spots.contains(&3) { Unit::Relative } else { Unit::CubicMicrometres };
                assert_eq!(lineage.volumes, unit);
            }
            None => panic!("{of_spots:?}"),
        }
    }
    let numbered = |text: &str| text.lines().enumerate().map(|(k, line)| format!("{k},{line}\n")).collect::<String>();
    assert_eq!(lives(&of_trackmate(&numbered(TRACKMATE_SPOTS), &numbered(&without(&edges, &one)))), LIVES);
    // A row without ids is no heading.
    let lineage = of_trackmate(&without(TRACKMATE_SPOTS, &one).replace("P0,10,0", "P0,,0"), &edges);
    assert_eq!(reports(&lineage), ["2 ID : must be a whole number from 0"]);
}

/// Ids beyond 2^53, and as another program may write them.
#[test]
fn ids_are_read_to_the_last_digit() {
    let long = |text: &str, end: &str| {
        let mut text = text.to_owned();
        for id in 10..20 {
            for (before, after) in [(",", ","), (",", "\n")] {
                let long = format!("{before}11529215046068469{id}{end}{after}");
                text = text.replace(&format!("{before}{id}{after}"), &long);
            }
        }
        text
    };
    // Row by row: the first field with an id, not a size.
    let spots: String = TRACKMATE_SPOTS
        .lines()
        .map(|line| match line.split_once(',') {
            Some((name, rest)) if rest.as_bytes()[0].is_ascii_digit() => format!("{name},11529215046068469{rest}\n"),
            _ => format!("{line}\n"),
        })
        .collect();
    for end in ["", ".0"] {
        assert_eq!(lives(&of_trackmate(&spots, &long(&trackmate_edges(&EDGES), end))), LIVES, "{end}");
    }
}

/// Id, frame, radius and name of a spot.
type Row = (u64, f64, f64, &'static str);

/// Files of a GEFF by their names.
pub(super) type Files = Vec<(String, Vec<u8>)>;

/// A GEFF of the same embryo, a node per spot, in Zarr version 2 or 3; `chunk` rows in a chunk.
pub(super) fn geff(version: u8, chunk: usize) -> Files {
    let spots = TRACKMATE_SPOTS.lines().skip(4).map(|line| line.split(',').collect::<Vec<&'static str>>());
    let spots: Vec<Row> =
        spots.map(|s| (s[1].parse().unwrap(), s[8].parse().unwrap(), s[9].parse().unwrap(), s[0])).collect();
    let mut files = Files::new();
    let metadata = json!({ "geff": {
        "geff_version": "1.3", "directed": true, "sphere": "size",
        "axes": [{ "name": "t", "type": "time", "unit": "second" }, { "name": "x", "type": "space", "unit": "micrometer" }],
        "node_props_metadata": { "size": { "identifier": "size", "dtype": "float64" } },
    } });
    match version {
        2 => {
            files.push((".zgroup".to_owned(), br#"{"zarr_format": 2}"#.to_vec()));
            files.push((".zattrs".to_owned(), metadata.to_string().into_bytes()));
        }
        _ => files.push((
            "zarr.json".to_owned(),
            json!({ "zarr_format": 3, "attributes": metadata }).to_string().into_bytes(),
        )),
    }
    let mut array = |name: &str, types: [serde_json::Value; 2], width: usize, values: Vec<Vec<u8>>| {
        let rows = values.len() / width;
        let (shape, chunks) =
            if width > 1 { (json!([rows, width]), json!([chunk, width])) } else { (json!([rows]), json!([chunk])) };
        let [second, third] = types;
        let (file, document) = match version {
            2 => (
                ".zarray",
                json!({ "zarr_format": 2, "shape": shape, "chunks": chunks, "dtype": second, "compressor": null,
                "fill_value": 0, "order": "C", "filters": null }),
            ),
            _ => (
                "zarr.json",
                json!({ "zarr_format": 3, "node_type": "array", "shape": shape, "data_type": third,
                "chunk_grid": { "name": "regular", "configuration": { "chunk_shape": chunks } },
                "chunk_key_encoding": { "name": "default", "configuration": { "separator": "/" } }, "fill_value": 0,
                "codecs": [{ "name": "bytes", "configuration": { "endian": "little" } }] }),
            ),
        };
        files.push((format!("{name}/{file}"), document.to_string().into_bytes()));
        for (k, part) in values.chunks(chunk * width).enumerate() {
            let key = match (version, width) {
                (2, 1) => format!("{k}"),
                (2, _) => format!("{k}.0"),
                (_, 1) => format!("c/{k}"),
                _ => format!("c/{k}/0"),
            };
            let mut bytes = part.concat();
            // Chunks are whole.
            bytes.resize(chunk * width * values[0].len(), 0);
            files.push((format!("{name}/{key}"), bytes));
        }
    };
    let float = || [json!("<f8"), json!("float64")];
    let each = |of: &dyn Fn(&Row) -> Vec<u8>| spots.iter().map(of).collect::<Vec<_>>();
    array("nodes/ids", [json!("<u8"), json!("uint64")], 1, each(&|s| s.0.to_le_bytes().into()));
    array("nodes/props/t/values", float(), 1, each(&|s| (60.0 * s.1).to_le_bytes().into()));
    array("nodes/props/size/values", float(), 1, each(&|s| s.2.to_le_bytes().into()));
    let missing = |s: &Row| vec![u8::from(s.3 == "P1")];
    array("nodes/props/size/missing", [json!("|b1"), json!("bool")], 1, each(&missing));
    let text =
        |name: &str| (0..4).flat_map(|k| name.chars().nth(k).map_or(0, u32::from).to_le_bytes()).collect::<Vec<u8>>();
    let fixed = json!({ "name": "fixed_length_utf32", "configuration": { "length_bytes": 16 } });
    array("nodes/props/name/values", [json!("<U4"), fixed], 1, each(&|s| text(s.3)));
    let ends = EDGES.iter().flat_map(|(a, b)| [a.to_le_bytes().to_vec(), b.to_le_bytes().to_vec()]).collect();
    array("edges/ids", [json!("<u4"), json!("uint32")], 2, ends);
    files
}

pub(super) fn written(files: &Files) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, content) in files {
        let path = folder.path().join("embryo.geff").join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, content).unwrap();
    }
    folder
}

/// As Python's Zarr writes them: chunks of two rows in shards of eight, most of them compressed with Zstandard; of the edges also one chunk
/// for each column (`make_sharded.py`).
#[test]
fn shards_of_chunks_give_the_same_cells() {
    let folder = tempfile::tempdir().unwrap();
    zip::ZipArchive::new(Cursor::new(include_bytes!("sharded.zip"))).unwrap().extract(folder.path()).unwrap();
    let path = folder.path().join("embryo.geff");
    let lineage = tracked(&path);
    assert_eq!(lives(&lineage), LIVES);
    assert!((lineage.cells[0].volume.unwrap() - 33_510.321_638_291_13).abs() < 1e-9);
    // Cut short or with another index: an error or other cells, no panic.
    let shard = path.join("nodes/ids/c/0");
    let whole = fs::read(&shard).unwrap();
    for end in 0..whole.len() {
        fs::write(&shard, &whole[..end]).unwrap();
        assert!(refused(&path).contains("is not a chunk of an array"), "{end}: {}", refused(&path));
        let mut changed = whole.clone();
        changed[end] ^= 0x7f;
        fs::write(&shard, changed).unwrap();
        let _ = read_tracked(&path, &TrackOptions::default());
    }
}

#[test]
fn geff_gives_the_same_cells() {
    for (version, chunk) in [(2, 10), (3, 10), (2, 4), (3, 3)] {
        let folder = written(&geff(version, chunk));
        let lineage = tracked(&folder.path().join("embryo.geff"));
        assert_eq!((lineage.format, lineage.time, lineage.name.as_str()), (Format::Geff, TimeUnit::Minutes, "embryo"));
        assert_eq!((lives(&lineage), lineage.volumes), (LIVES.to_vec(), Unit::CubicMicrometres));
        assert!((lineage.cells[0].volume.unwrap() - 33_510.321_638_291_13).abs() < 1e-9);
        assert_eq!(lineage.cells[2].volume, None);
    }
}

/// Other spellings of units, and a property in other letters.
#[test]
fn geff_may_spell_units_and_properties_otherwise() {
    for (time, length, size) in [
        ("s", "um", 1.0),
        ("sec", "µm", 1.0),
        ("seconds", "Micron", 1.0),
        ("second", "nanometer", 1e-9),
        ("second", "mm", 1e9),
    ] {
        let mut files = geff(2, 10);
        for (name, content) in &mut files {
            *name = name.replace("props/size", "props/RADIUS");
            if name == ".zattrs" {
                let text = String::from_utf8_lossy(content).replace("\"second\"", &format!("{time:?}"));
                let text = text.replace("micrometer", length).replace("\"sphere\":\"size\",", "");
                *content = text.replace("\"size\"", "\"RADIUS\"").into_bytes();
            }
        }
        let lineage = tracked(&written(&files).path().join("embryo.geff"));
        assert_eq!((lives(&lineage), lineage.volumes), (LIVES.to_vec(), Unit::CubicMicrometres), "{time} {length}");
        assert!((lineage.cells[0].volume.unwrap() / (33_510.321_638_291_13 * size) - 1.0).abs() < 1e-12, "{length}");
    }
}

/// TrackMate up to 6 has other names of files. Windows-1252 has one byte for µ.
#[test]
fn tables_of_trackmate_6_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let spots = folder.path().join("Spots in tracks statistics.csv");
    let latin = |text: String| text.chars().map(|c| c as u8).collect::<Vec<u8>>();
    fs::write(&spots, latin(TRACKMATE_SPOTS.replace("(micron)", "(µm)"))).unwrap();
    let edges: String = EDGES.iter().map(|(from, to)| format!("ID1,0,{from},{to},0.5\n")).collect();
    let heading = "Label,TRACK_ID,SPOT_SOURCE_ID,SPOT_TARGET_ID,LINK_COST\n";
    fs::write(folder.path().join("Links in tracks statistics.csv"), heading.to_owned() + &edges).unwrap();
    let lineage = tracked(&spots);
    assert_eq!((lineage.format, lineage.volumes), (Format::TrackMate, Unit::CubicMicrometres));
    assert_eq!(lineage.cells.len(), LIVES.len());
    let (files, _) = embryo_files(&[folder.path().to_owned()], TableKind::Lifetimes).unwrap();
    assert_eq!(files.len(), 1);
}

/// Ids of 64 bits, which doubles do not tell apart, in edges of another kind of integer; and a name that is missing.
#[test]
fn geff_has_ids_of_64_bits_and_missing_names() {
    for first in [u64::MAX - 100, 1 << 60, (1 << 53) - 3] {
        let mut files = geff(2, 10);
        let file = |files: &Files, name: &str| files.iter().position(|(known, _)| known == name).unwrap();
        let (ids, edges) = (file(&files, "nodes/ids/0"), file(&files, "edges/ids/0.0"));
        let id = |old: u64| (first + old - 10).to_le_bytes();
        files[ids].1 = (10..20).flat_map(id).collect();
        files[edges].1 = EDGES.iter().flat_map(|(a, b)| [id((*a).into()), id((*b).into())].concat()).collect();
        files[edges].1.resize(160, 0);
        let kinds = file(&files, "edges/ids/.zarray");
        replace(&mut files[kinds].1, "<u4", if first < 1 << 63 { "<i8" } else { "<u8" });
        let missing = files[file(&files, "nodes/props/size/missing/.zarray")].1.clone();
        files.push(("nodes/props/name/missing/.zarray".to_owned(), missing));
        files.push(("nodes/props/name/missing/0".to_owned(), vec![1, 0, 0, 0, 0, 0, 0, 0, 0, 0]));
        let folder = written(&files);
        let lineage = tracked(&folder.path().join("embryo.geff"));
        let mut expected = LIVES.to_vec();
        // P0 has two spots; the second is called ID11.
        let name = first.to_string();
        expected[0].0 = &name;
        expected[1].1 = Some(&name);
        expected[2].1 = Some(&name);
        assert_eq!(lives(&lineage), expected, "{first}");
        // An edge to an id that is not there, but is the same double.
        files[edges].1[8..16].copy_from_slice(&(first + 60).to_le_bytes());
        let error = refused(&written(&files).path().join("embryo.geff"));
        assert!(error.contains(&format!("edges/ids[0] = {}: must be a node's id", first + 60)), "{error}");
    }
}

/// A container with one GEFF is read as this GEFF; a container with two is refused.
#[test]
fn the_geff_in_a_container_is_read() {
    let folder = written(&geff(2, 10));
    let inside = folder.path().join("embryo.geff");
    fs::write(folder.path().join(".zgroup"), "{\"zarr_format\": 2}").unwrap();
    assert_eq!(lives(&tracked(folder.path())), LIVES);
    assert_eq!(located(folder.path()).unwrap().unwrap().0, Format::Geff);
    fs::create_dir(folder.path().join("tables")).unwrap();
    fs::rename(&inside, folder.path().join("tables/tracks.geff")).unwrap();
    assert_eq!(lives(&tracked(folder.path())), LIVES);
    let other = folder.path().join("other.geff");
    fs::create_dir(&other).unwrap();
    for name in [".zgroup", ".zattrs"] {
        fs::copy(folder.path().join("tables/tracks.geff").join(name), other.join(name)).unwrap();
    }
    let error = refused(folder.path());
    assert!(
        error.contains("it holds 2 GEFFs; one of them must be given") && error.contains("tables/tracks.geff"),
        "{error}"
    );
}

/// Arrays that are said to be huge, with few bytes of chunks: refused before memory is taken for them, and without a look for
/// every chunk.
#[test]
fn huge_arrays_are_refused_at_once() {
    for (name, changes) in [
        ("nodes/ids/.zarray", &[("\"shape\":[10]", "\"shape\":[134217728]")][..]),
        ("nodes/props/name/values/.zarray", &[("\"shape\":[10]", "\"shape\":[134217728]")]),
        ("nodes/props/size/missing/.zarray", &[("\"shape\":[10]", "\"shape\":[1073741824]")]),
        ("edges/ids/.zarray", &[("[9,2]", "[134217728,2]")]),
        ("edges/ids/.zarray", &[("[9,2]", "[134217728,2]"), ("[10,2]", "[1,1]")]),
        ("edges/ids/.zarray", &[("[9,2]", "[67108864,2]"), ("[10,2]", "[67108864,2]")]),
        ("nodes/props/t/values/.zarray", &[("\"chunks\":[10]", "\"chunks\":[134217728]")]),
    ] {
        let mut files = geff(2, 10);
        let (_, content) = files.iter_mut().find(|(known, _)| known == name).unwrap();
        changes.iter().for_each(|(from, to)| replace(content, from, to));
        let error = refused(&written(&files).path().join("embryo.geff"));
        assert!(error.contains(name) && error.contains("rows") || error.contains("of at most 64 MB"), "{error}");
    }
}

#[test]
fn wrong_geff_is_refused_with_its_place() {
    for (change, message) in cases(include_str!("wrong_geff.txt")) {
        let mut files = geff(2, 10);
        let file = files.iter().position(|(known, _)| known == change[0]).unwrap();
        match change[1..] {
            ["removed"] => drop(files.remove(file)),
            ["byte", at, byte] => files[file].1[at.parse::<usize>().unwrap()] = byte.parse().unwrap(),
            [from, to] => replace(&mut files[file].1, from, to),
            _ => panic!("{change:?}"),
        }
        let folder = written(&files);
        let error = refused(&folder.path().join("embryo.geff"));
        assert!(error.contains(message), "{error}\n{message}");
    }
}

/// Replaces a text that must be there.
fn replace(content: &mut Vec<u8>, from: &str, to: &str) {
    let text = String::from_utf8(content.clone()).unwrap();
    assert!(text.contains(from), "{text}: {from}");
    *content = text.replace(from, to).into_bytes();
}
