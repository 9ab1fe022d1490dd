//! Units of times and sizes, and other spellings of formats.

use serde_json::{Value, json};

use super::graphs::{Files, geff, written};
use super::tracks::xml;
use super::*;

/// A GEFF of version 2 with changed metadata.
fn with_metadata(change: impl Fn(&mut Value)) -> Files {
    let mut files = geff(2, 10);
    let (_, content) = files.iter_mut().find(|(name, _)| name == ".zattrs").unwrap();
    let mut metadata: Value = serde_json::from_slice(content).unwrap();
    change(&mut metadata["geff"]);
    *content = metadata.to_string().into_bytes();
    files
}

fn read_geff(files: &Files, options: &TrackOptions) -> Result<TrackedLineage, String> {
    let folder = written(files);
    let path = folder.path().join("embryo.geff");
    read_tracked(&path, options).map(Option::unwrap).map_err(|error| error.to_string())
}

/// Values of an axis in frames or pixels are multiplied by its scale. The times of the file are 60, 120 and so on.
#[test]
fn scaled_axes_of_geff_are_in_their_units() {
    let axis = |kind: &str, name: &str, unit: &str, scale: Value, scaled: Value| json!({ "name": name, "type": kind, "unit": unit, "scale": scale, "scaled_unit": scaled });
    let space = |name: &str, scale: f64| axis("space", name, "pixel", json!(scale), json!("micrometer"));
    let scaled = |scales: [f64; 3]| {
        with_metadata(|geff| {
            let time = axis("time", "t", "frame", json!(1.5), json!("minute"));
            geff["axes"] = json!([time, space("z", scales[0]), space("y", scales[1]), space("x", scales[2])]);
        })
    };
    let options = TrackOptions::default();
    let lineage = read_geff(&scaled([0.2; 3]), &options).unwrap();
    assert_eq!((lineage.time, lineage.volumes), (TimeUnit::Minutes, Unit::CubicMicrometres));
    // AB from frame 180 to 300; a radius of 15 pixels.
    assert_eq!((lineage.cells[1].birth, lineage.cells[1].lifetime()), (270.0, Some(180.0)));
    assert!((lineage.cells[1].volume.unwrap() / sphere(6.0) - 1.0).abs() < 1e-12);
    // Minutes per frame count frames.
    let given = TrackOptions { frame_minutes: Some(2.0), ..options };
    assert_eq!(read_geff(&scaled([0.2; 3]), &given).unwrap().cells[1].lifetime(), Some(240.0));
    // Radii have one scale.
    let error = read_geff(&scaled([0.5, 0.2, 0.2]), &options).unwrap_err();
    assert!(error.contains("unit of size = pixel: must be a unit of length that is not pixels"), "{error}");
    for (scale, unit, message) in [
        (json!(1.5), Value::Null, "geff.axes.t.scale = 1.5: must be a number above 0, given together with scaled_unit"),
        (json!(0), json!("minute"), "geff.axes.t.scale = 0: must be a number above 0"),
        (json!(2), json!("fortnight"), "geff.axes.scaled_unit = \"fortnight\": must be one of min, s, h, ms, d, frame"),
    ] {
        let files = with_metadata(|geff| geff["axes"][0] = axis("time", "t", "frame", scale.clone(), unit.clone()));
        let error = read_geff(&files, &options).unwrap_err();
        assert!(error.contains(message), "{error}\n{message}");
    }
}

/// Volumes have the unit of their metadata.
#[test]
fn volumes_of_geff_have_their_unit() {
    let volumes = |unit: Value| {
        let mut files = with_metadata(|geff| {
            geff["sphere"] = Value::Null;
            geff["node_props_metadata"] = json!({ "volume": { "identifier": "volume", "unit": unit } });
        });
        files.iter_mut().for_each(|(name, _)| *name = name.replace("props/size", "props/volume"));
        files
    };
    let options = TrackOptions::default();
    for (unit, kind, size) in [
        ("micrometer**3", Unit::CubicMicrometres, 1.0),
        ("nanometer**3", Unit::CubicMicrometres, 1e-9),
        ("nm^3", Unit::CubicMicrometres, 1e-9),
        ("µm³", Unit::CubicMicrometres, 1.0),
        ("pixel**3", Unit::Voxels, 1.0),
    ] {
        let lineage = read_geff(&volumes(json!(unit)), &options).unwrap();
        assert_eq!(lineage.volumes, kind, "{unit}");
        assert!((lineage.cells[1].volume.unwrap() / (15.0 * size) - 1.0).abs() < 1e-12, "{unit}");
    }
    assert_eq!(read_geff(&volumes(Value::Null), &options).unwrap().volumes, Unit::Relative);
    let error = read_geff(&volumes(json!("barrel")), &options).unwrap_err();
    assert!(error.contains("unit of volume = barrel: must be one of um3"), "{error}");
    // Lifetimes need no sizes.
    let options = TrackOptions { without_sizes: true, ..options };
    assert_eq!(lives(&read_geff(&volumes(json!("barrel")), &options).unwrap()), LIVES);
}

/// Names of any length, as Python's Zarr writes them by default.
#[test]
fn names_of_geff_may_have_any_length() {
    for (version, file, kinds) in [
        (2, ".zarray", [("\"<U4\"", "\"|O\""), ("\"filters\":null", "\"filters\":[{\"id\":\"vlen-utf8\"}]")]),
        (
            3,
            "zarr.json",
            [
                ("{\"name\":\"fixed_length_utf32\",\"configuration\":{\"length_bytes\":16}}", "\"string\""),
                ("{\"name\":\"bytes\",\"configuration\":{\"endian\":\"little\"}}", "{\"name\":\"vlen-utf8\"}"),
            ],
        ),
    ] {
        let mut files = geff(version, 10);
        let chunk = if version == 2 { "nodes/props/name/values/0" } else { "nodes/props/name/values/c/0" };
        for (name, content) in &mut files {
            if *name == format!("nodes/props/name/values/{file}") {
                let mut text = String::from_utf8(content.clone()).unwrap();
                for (from, to) in kinds {
                    assert!(text.contains(from), "{text}");
                    text = text.replace(from, to);
                }
                *content = text.into_bytes();
            } else if name == chunk {
                let names = content.chunks(16).map(|name| {
                    name.chunks(4).map(|point| char::from(point[0])).filter(|c| *c != '\0').collect::<String>()
                });
                let names: Vec<String> = names.collect();
                let texts =
                    names.iter().flat_map(|name| [&(name.len() as u32).to_le_bytes()[..], name.as_bytes()].concat());
                *content = (names.len() as u32).to_le_bytes().into_iter().chain(texts).collect();
            }
        }
        assert_eq!(lives(&read_geff(&files, &TrackOptions::default()).unwrap()), LIVES, "{version}");
        // Cut short or damaged: an error or other names, no panic.
        let at = files.iter().position(|(name, _)| name == chunk).unwrap();
        let whole = files[at].1.clone();
        for end in 0..whole.len() {
            files[at].1 = whole[..end].to_vec();
            let error = read_geff(&files, &TrackOptions::default()).unwrap_err();
            assert!(error.contains("it ends within a text"), "{end} {error}");
            files[at].1 = whole.clone();
            files[at].1[end] ^= 0x7f;
            let _ = read_geff(&files, &TrackOptions::default());
        }
    }
}

#[test]
fn tracks_of_the_cell_tracking_challenge_may_be_written_otherwise() {
    let rows = [[1, 0, 0, 0], [2, 1, 15, 1], [3, 1, 17, 1], [4, 16, 19, 2], [5, 16, 19, 2]];
    let table = |heading: &str, between: &str, number: &dyn Fn(u32) -> String| {
        let row = |row: &[u32; 4]| row.map(number).join(between) + "\n";
        heading.to_owned() + &rows.iter().map(row).collect::<String>()
    };
    let plain = |number: u32| number.to_string();
    // As numpy.savetxt writes 16: 1.600000000000000000e+01.
    let numpy = |number: u32| {
        let power = if number >= 10 { 1 } else { 0 };
        format!("{:.18}e+0{power}", f64::from(number) / 10_f64.powi(power))
    };
    let right = embryo("res_track.txt", table("", " ", &plain));
    for (name, text) in [
        ("a.txt", table("L B E P\n", " ", &plain)),
        ("a.txt", table("", "\t", &plain)),
        ("a.csv", table("L,B,E,P\n", ",", &plain)),
        ("a.csv", table("", ", ", &plain)),
        ("a.txt", table("# L B E P\n", " ", &numpy)),
    ] {
        let lineage = embryo(name, &text);
        assert_eq!((lineage.format, lives(&lineage)), (Format::Ctc, lives(&right)), "{text}");
    }
    let fifth = table("", " ", &plain).replace('\n', " 0\n");
    let why = "is not tracks of the Cell Tracking Challenge: a line of it must be four whole numbers: label, first and last frame";
    assert!(refusal("res_track.txt", &fifth).contains(why), "{}", refusal("res_track.txt", &fifth));
    let (folder, _) = file("man_track.txt", &fifth);
    assert!(refused(folder.path()).contains("must be four whole numbers: label, first"), "{}", refused(folder.path()));
}

/// `POSITION_T` has the times where the heading has its unit.
#[test]
fn tables_of_trackmate_have_the_unit_of_their_times() {
    let of = |unit: &str, times: [&str; 4], options: &TrackOptions| {
        let heading = format!("LABEL,ID,POSITION_T,FRAME\nLabel,Spot ID,T,Frame\nLabel,Spot ID,T,Frame\n,,{unit},\n");
        let rows: String = (0..4).map(|k| format!("ID{k},{k},{},{}\n", times[k], [0, 1, 2, 2][k])).collect();
        let (folder, path) = file("a_spots.csv", heading + &rows);
        fs::write(folder.path().join("a_edges.csv"), "SPOT_SOURCE_ID,SPOT_TARGET_ID\n0,1\n1,2\n1,3\n").unwrap();
        let lineage = read_tracked(&path, options).unwrap().unwrap();
        (lineage.time, lineage.cells[0].division, reports(&lineage))
    };
    let (times, options) = (["0", "90", "180", "180"], TrackOptions::default());
    assert_eq!(of("(sec)", times, &options), (TimeUnit::Minutes, Some(3.0), vec![]));
    assert_eq!(of("(min)", times, &options), (TimeUnit::Minutes, Some(180.0), vec![]));
    assert_eq!(of("(frame)", times, &options), (TimeUnit::Frames, Some(2.0), vec![]));
    // Minutes per frame count frames.
    let given = TrackOptions { frame_minutes: Some(10.0), ..options };
    assert_eq!(of("(sec)", times, &given), (TimeUnit::Minutes, Some(20.0), vec![]));
    // Without an interval all times are 0.
    let why = "0 POSITION_T : must be a number in every row, and larger in later frames: frames are used".to_owned();
    assert_eq!(of("(sec)", ["0"; 4], &options), (TimeUnit::Frames, Some(2.0), vec![why]));
}

#[test]
fn other_units_of_time_are_read() {
    for (unit, minutes) in [("msec", 4.5 / 1000.0), ("day", 270.0 * 1440.0), ("min", 270.0)] {
        let lineage = embryo("film.xml", xml(&format!("spatialunits=\"micron\" timeunits=\"{unit}\"")));
        assert_eq!(lineage.time, TimeUnit::Minutes, "{unit}");
        let division = lineage.cells[0].division.unwrap();
        assert!((division / minutes - 1.0).abs() < 1e-12, "{unit} {division}");
    }
}

/// With minutes per frame, a time between frames is in another unit.
#[test]
fn half_a_frame_is_no_time() {
    let (_folder, path) = file("tracks.csv", "track_id,t,y,x,parent_track_id\n1,0,0,0,-1\n1,1.5,0,0,-1\n");
    let given = TrackOptions { frame_minutes: Some(1.0), ..TrackOptions::default() };
    let error = read_tracked(&path, &given).unwrap_err().to_string();
    assert!(error.contains("tracks.csv:3:1: t = 1.5: must be a whole number of frames"), "{error}");
    assert_eq!(tracked(&path).cells[0].last, 1.5);
}
