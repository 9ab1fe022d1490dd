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

#[test]
fn trackmate_and_mastodon_give_the_same_cells() {
    // One edge leads backwards in time, as TrackMate may write it.
    let (_folder, path) = trackmate(TRACKMATE_SPOTS, &trackmate_edges(&EDGES));
    let lineage = tracked(&path);
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

#[test]
fn wrong_spots_and_links_are_refused_with_their_place() {
    let fine = trackmate_edges(&EDGES);
    let with = |edges: &[(u32, u32)]| trackmate_edges(&[&EDGES[..], edges].concat());
    let spots = |from: &str, to: &str| TRACKMATE_SPOTS.replace(from, to);
    for (spots, edges, message) in [
        (spots("FRAME", "FRAMES"), &fine, "film_spots.csv: cannot be read"),
        (spots(",RADIUS", ",FRAMEX"), &fine, ""),
        (spots("P0,10,", "P0,-10,"), &fine, "film_spots.csv:5:1: ID = \"-10\": must be a whole number from 0"),
        (spots("60,1,20", "60,NaN,20"), &fine, "film_spots.csv:5:1: FRAME = \"NaN\": must be a whole number from 0"),
        (
            spots("ID11,11,", "ID11,10,"),
            &fine,
            "film_spots.csv:6:1: ID = 10: must be of one spot only; line 5 has it too",
        ),
        (
            spots("(sec),,(micron)", "(sec),,(inch)"),
            &fine,
            "film_spots.csv:4:1: the unit of radii is \"(inch)\": must be",
        ),
        (spots("", ""), &with(&[(10, 10)]), "film_edges.csv:14:1: a link from \"P0\" (film_spots.csv:5) to \"P0\""),
        (spots("", ""), &with(&[(10, 12)]), "film_edges.csv:14:1: \"AB\" (film_spots.csv:7) has two mothers, \"ID11\""),
        (
            spots("", ""),
            &with(&[(11, 12)]),
            "film_edges.csv:14:1: a second link from \"ID11\" (film_spots.csv:6) to \"AB\"",
        ),
        (spots("", ""), &with(&[(12, 13)]), "both at time 3: links must lead to a later time"),
        (spots("", ""), &with(&[(10, 99)]), "film_edges.csv:14:1: SPOT_TARGET_ID = \"99\": must be the ID of a spot"),
        (
            spots("", ""),
            &trackmate_edges(&[(10, 11), (10, 12), (10, 13)]),
            "\"P0\" (film_spots.csv:5) has a third link",
        ),
        (
            spots("", ""),
            &fine.replace("SPOT_SOURCE_ID", "FROM"),
            "film_edges.csv:1:1: no column is called \"SPOT_SOURCE_ID\"",
        ),
        (TRACKMATE_SPOTS.lines().take(4).collect::<Vec<_>>().join("\n"), &fine, "must be the ID of a spot"),
    ] {
        let (_folder, path) = trackmate(&spots, edges);
        match read_tracked(&path, &TrackOptions::default()) {
            Err(_) => {
                let error = refused(&path);
                assert!(error.contains(message), "{error}\n{message}");
            }
            // Without a heading that it knows a table is of no program, and without radii cells have no size.
            Ok(None) => assert!(spots.contains("FRAMES")),
            Ok(Some(lineage)) => assert!(spots.contains("FRAMEX") && lineage.cells[0].volume.is_none()),
        }
    }
    let (_folder, path) = file("film_spots.csv", TRACKMATE_SPOTS);
    let error = refused(&path);
    assert!(
        error.contains("links = none: must be beside a table of links (film_edges.csv or film_links.csv)"),
        "{error}"
    );
    let (_folder, path) = trackmate(&spots("180,3,15", "180,3,0"), &fine);
    let skipped = &tracked(&path).skipped[0];
    assert_eq!((skipped.line, skipped.column.as_str(), skipped.value.as_str()), (7, "RADIUS", "0"));
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

#[test]
fn wrong_geff_is_refused_with_its_place() {
    let change = |name: &str, from: &str, to: &str| {
        let mut files = geff(2, 10);
        let file = files.iter_mut().find(|(known, _)| known == name).unwrap();
        let text = String::from_utf8(file.1.clone()).unwrap();
        assert!(text.contains(from), "{name}: {from}");
        file.1 = text.replace(from, to).into_bytes();
        files
    };
    let bytes = |name: &str, at: usize, byte: u8| {
        let mut files = geff(2, 10);
        files.iter_mut().find(|(known, _)| known == name).unwrap().1[at] = byte;
        files
    };
    let without = |name: &str| geff(2, 10).into_iter().filter(|(known, _)| known != name).collect::<Files>();
    for (files, message) in [
        (change(".zattrs", "geff\":", "graph\":"), "geff = null: must be metadata of GEFF in the attributes"),
        (
            change(".zattrs", "true", "false"),
            "geff.directed = false: must be true: edges lead from mothers to daughters",
        ),
        (change(".zattrs", "\"time\"", "\"channel\""), "geff.axes = "),
        (change(".zattrs", "second", "fortnight"), "geff.axes.unit = \"fortnight\": must be minute, second,"),
        (change(".zattrs", "micrometer", "furlong"), "unit of size = furlong: must be micrometer, pixel, or none"),
        (change(".zattrs", "{\"geff\":", "{\"geff\""), ".zattrs:1:"),
        (without("nodes/ids/.zarray"), "nodes/ids/.zarray: cannot be read"),
        (without("nodes/props/t/values/0"), "edges/ids:1:1: a link from \"P0\" to \"ID11\", both at time 0"),
        (
            change("nodes/ids/.zarray", "<u8", ">u8"),
            ".zarray: data type = \">u8\": must be integers, floating-point numbers",
        ),
        (
            change("nodes/ids/.zarray", "\"compressor\":null", "\"compressor\":{\"id\":\"lzma\"}"),
            "codecs = {\"id\":\"lzma\"}: must be none",
        ),
        (
            change("nodes/ids/.zarray", "[10],\"chunks\"", "[9],\"chunks\""),
            "numbers of shape [10]: must be one number per node",
        ),
        (
            change("nodes/ids/.zarray", "\"shape\":[10]", "\"shape\":[99999999999999]"),
            "shape = [99999999999999]: must be of at most 1024 MB",
        ),
        (
            change("nodes/ids/.zarray", "\"chunks\":[10]", "\"chunks\":[0]"),
            "chunks = [0]: must be as many whole numbers above 0",
        ),
        (change("nodes/ids/.zarray", "\"chunks\":[10]", "\"chunks\":[11]"), "it has 80 bytes; 11 values have 88"),
        (bytes("nodes/ids/0", 8, 10), "nodes/ids = 10: must be of one node only"),
        (bytes("edges/ids/0.0", 0, 77), "edges/ids[0] = 77: must be a node's id"),
        (bytes("edges/ids/0.0", 4, 10), "edges/ids:1:1: a link from \"P0\" to \"P0\", both at time 1"),
        (bytes("edges/ids/0.0", 68, 18), "edges/ids:9:1: \"ABa\" has two mothers, \"ABa\" and \"ABp\""),
    ] {
        let folder = written(&files);
        let error = refused(&folder.path().join("embryo.geff"));
        assert!(error.contains(message), "{error}\n{message}");
    }
}
