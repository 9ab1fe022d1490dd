//! Formats that have tracks rather than names: XML of TrackMate and MaMuT, tables of napari, ultrack and btrack, and tracks of the Cell
//! Tracking Challenge.

use super::*;

/// The embryo of [`LIVES`] as tracks: number, first frame, last frame, mother, radius.
pub(super) const TRACKS: [(u32, u32, u32, u32, f64); 5] =
    [(1, 1, 2, 0, 20.0), (2, 3, 4, 1, 15.0), (3, 3, 6, 1, 10.0), (4, 5, 6, 2, 11.0), (5, 5, 6, 2, 12.0)];

/// The lives with the names of tracks.
fn numbered() -> Vec<Life<'static>> {
    let number = |name: &str| ["1", "2", "3", "4", "5"][LIVES.iter().position(|life| life.0 == name).unwrap()];
    LIVES.iter().map(|(name, mother, a, b, c)| (number(name), mother.map(number), *a, *b, *c)).collect()
}

fn by_track(mut lives: Vec<Life<'_>>) -> Vec<Life<'_>> {
    lives.sort_by_key(|life| life.0.to_owned());
    lives
}

/// A table of tracks, with what `row` writes of a track in a frame.
pub(super) fn table(heading: &str, row: impl Fn(u32, u32, u32, f64) -> String) -> String {
    let mut text = format!("{heading}\n");
    for (track, first, last, mother, radius) in TRACKS {
        (first..=last).for_each(|t| text += &format!("{}\n", row(track, t, mother, radius)));
    }
    text
}

/// Tracks of the Cell Tracking Challenge.
fn ctc() -> String {
    TRACKS.map(|(track, first, last, mother, _)| format!("{track} {first} {last} {mother}\n")).concat()
}

pub(super) fn xml(units: &str) -> String {
    let (mut spots, mut edges, mut last) = (String::new(), String::new(), std::collections::HashMap::new());
    for (track, first, until, mother, radius) in TRACKS {
        for t in first..=until {
            let id = 10 * track + t;
            let (before, seconds) = (last.insert(track, id).or(last.get(&mother).copied()), f64::from(t) * 90.0);
            spots += &format!(
                "<Spot ID=\"{id}\" name=\"ID&lt;{id}&gt;\" VISIBILITY=\"1\" RADIUS=\"{radius}\" FRAME=\"{t}\"\n POSITION_T=\"{seconds}\" />\n"
            );
            if let Some(before) = before {
                edges += &format!("<Edge SPOT_SOURCE_ID=\"{before}\" SPOT_TARGET_ID=\"{id}\" />\n");
            }
        }
    }
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<TrackMate version=\"7.11.1\">\n<Log>a &amp; b</Log>\n<Model {units}>\n<AllSpots>\n\
         <SpotsInFrame frame=\"1\">\n{spots}<Spot ID=\"900\" name=\"dust\" RADIUS=\"1\" FRAME=\"1\" POSITION_T=\"90\" />\n\
         <Spot ID=\"901\" name=\"x\" RADIUS=\"1\" FRAME=\"1\" POSITION_T=\"90\" /><Spot ID=\"902\" name=\"x\" RADIUS=\"1\" FRAME=\"2\" \
         POSITION_T=\"180\" />\n</SpotsInFrame>\n</AllSpots>\n<AllTracks>\n<Track name=\"Track_0\" TRACK_ID=\"0\">\n{edges}</Track>\n\
         <Track name=\"Track_1\" TRACK_ID=\"1\">\n<Edge SPOT_SOURCE_ID=\"901\" SPOT_TARGET_ID=\"902\" />\n</Track>\n</AllTracks>\n\
         <FilteredTracks>\n<TrackID TRACK_ID=\"0\" />\n</FilteredTracks>\n</Model>\n</TrackMate>\n"
    )
}

#[test]
fn the_file_of_trackmate_has_the_units_and_the_tracks_that_are_kept() {
    let (_folder, path) = file("film.xml", xml("spatialunits=\"micron\" timeunits=\"sec\""));
    let lineage = tracked(&path);
    assert_eq!(
        (lineage.format, lineage.time, lineage.volumes),
        (Format::TrackMateXml, TimeUnit::Minutes, Unit::CubicMicrometres)
    );
    assert_eq!(lineage.cells.len(), 5);
    assert_eq!(
        (&*lineage.cells[0].name, lineage.cells[0].birth, lineage.cells[0].division),
        ("ID<11>", 1.5, Some(4.5))
    );
    assert!((lineage.cells[0].volume.unwrap() - sphere(40.0)).abs() < 1e-9);
    assert_eq!(lineage.cells[0].place.1, 7);
    assert_eq!(
        reports(&lineage),
        ["31 Spot 900: it belongs to no track, or to one that was filtered out; there are 3 such spots"]
    );
    // Where the system's encoding is Windows-1252, TrackMate writes it under the heading of UTF-8.
    let text = xml("spatialunits=\"µm\" timeunits=\"sec\"");
    for bytes in [text.chars().map(|c| c as u8).collect::<Vec<u8>>(), [b"\xef\xbb\xbf", text.as_bytes()].concat()] {
        let (_folder, path) = file("film.xml", bytes);
        let other = tracked(&path);
        assert_eq!((other.volumes, &other.cells[0].volume), (Unit::CubicMicrometres, &lineage.cells[0].volume));
    }
    // A cell is found by its track, a spot's id and a spot's name.
    for name in ["Track_0", "12", "ID<12>"] {
        assert_eq!(lineage.place_of(name), Place::Cell(0), "{name}");
    }
    assert_eq!(lineage.place_of("Track_1"), Place::Nowhere);
    // Given minutes count frames.
    let options = TrackOptions { pixel: Some(0.5), frame_minutes: Some(2.0), ..TrackOptions::default() };
    let given = read_tracked(&path, &options).unwrap().unwrap();
    assert_eq!((given.cells[0].birth, given.cells[0].division), (2.0, Some(6.0)));
    // Lifetimes need no unit of length.
    let (_folder, path) = file("film.xml", xml("spatialunits=\"parsec\" timeunits=\"sec\""));
    let of_times =
        read_tracked(&path, &TrackOptions { without_sizes: true, ..TrackOptions::default() }).unwrap().unwrap();
    assert_eq!(of_times.cells[0].division, Some(4.5));
    let (_folder, path) = file("film.xml", xml("spatialunits=\"pixel\" timeunits=\"frame\""));
    let plain = tracked(&path);
    assert_eq!((plain.time, plain.volumes, plain.cells[0].birth), (TimeUnit::Frames, Unit::Voxels, 1.0));
    let scaled = read_tracked(&path, &options).unwrap().unwrap();
    assert!((scaled.cells[0].volume.unwrap() - sphere(20.0)).abs() < 1e-9);
}

#[test]
fn wrong_xml_is_refused_with_its_line() {
    let right = xml("spatialunits=\"micron\" timeunits=\"sec\"");
    for (from, to, message) in [
        ("micron", "parsec", "film.xml: spatialunits of Model = \"parsec\": must be one of micron, pixel"),
        ("Spot ID=\"11\"", "Spot ID=\"a\"", "film.xml:7:1: ID of Spot = \"a\": must be a whole number from 0"),
        ("SPOT_SOURCE_ID=\"11\"", "SPOT_SOURCE_ID=\"99\"", "99: must be the ID of a spot"),
        ("<Spot ID=\"12\"", "<Spot ID=\"11\"", "film.xml:9:1: ID = 11: must be of one spot only"),
        ("</AllTracks>", "</AllTrack>", "film.xml:"),
        ("<Edge SPOT_SOURCE_ID=\"11\"", "</Track><Edge SPOT_SOURCE_ID=\"11\"", "film.xml:"),
        ("name=\"dust\"", "name=dust", "film.xml:"),
    ] {
        let changed = right.replacen(from, to, 1);
        assert_ne!(changed, right, "{from}");
        let error = refusal("film.xml", changed);
        assert!(error.contains(message), "{error}\n{message}");
    }
    // Cut anywhere: an error or fewer cells, no panic.
    for end in (0..right.len()).step_by(97) {
        let (_folder, path) = file("film.xml", &right[..end]);
        let _ = read_tracked(&path, &TrackOptions::default());
    }
}

#[test]
fn unusable_and_repeated_elements_of_xml_are_left_out() {
    let right = xml("spatialunits=\"micron\" timeunits=\"sec\"");
    let (cells, edge) = (embryo("film.xml", &right).cells, "<Edge SPOT_SOURCE_ID=\"24\" SPOT_TARGET_ID=\"45\" />\n");
    let spot =
        "<Spot ID=\"34\" name=\"ID&lt;34&gt;\" VISIBILITY=\"1\" RADIUS=\"10\" FRAME=\"4\"\n POSITION_T=\"360\" />\n";
    for (from, to, why) in [
        (spot.to_owned(), spot.replace("360", "NaN"), "POSITION_T NaN: must be a number: the spot 34 is left out"),
        (spot.to_owned(), spot.repeat(2), "ID 34: the row of line"),
        (edge.to_owned(), edge.repeat(2), "a second link from \"ID<24>\""),
    ] {
        let changed = right.replacen(&from, &to, 1);
        assert_ne!(changed, right, "{from}");
        let lineage = embryo("film.xml", changed);
        let times = |cells: &[TrackedCell]| cells.iter().map(|cell| (cell.birth, cell.division)).collect::<Vec<_>>();
        assert_eq!(times(&lineage.cells), times(&cells), "{to}");
        assert!(
            reports(&lineage).iter().any(|report| report.contains(why)) && lineage.skipped_count == 2,
            "{:?}\n{why}",
            reports(&lineage)
        );
    }
}

#[test]
fn tables_of_ultrack_btrack_and_napari_give_the_same_cells() {
    let ultrack = table("track_id,t,z,y,x,id,parent_track_id,parent_id,area", |track, t, mother, radius| {
        let mother = if mother == 0 { -1 } else { i64::from(mother) };
        format!("{track},{t},1,2,3,{},{mother},-1,{}", 1_000_000 * t + track, radius * 10.0)
    });
    let btrack = table(",track_id,t,x,y,z,parent,root,generation,radius", |track, t, mother, radius| {
        let mother = if mother == 0 { track } else { mother };
        format!("0,{track},{t}.0,1,2,3,{mother},1,0,{radius}")
    });
    let napari = table("track_id;t;y;x", |track, t, _, _| format!("{track};{t};1,5;2,5"));
    for (text, unit, volume) in [
        (&ultrack, Unit::Voxels, Some(200.0)),
        (&btrack, Unit::Voxels, Some(sphere(40.0))),
        (&napari, Unit::Voxels, None),
    ] {
        let (folder, path) = file("embryo_tracks.csv", text);
        if text == &napari {
            let error = refused(&path);
            let names = "embryo_graph.csv, embryo_graph.json, embryo_tracks_graph.csv, embryo_tracks_graph.json";
            assert!(error.contains(names), "{error}");
            fs::write(folder.path().join("embryo_graph.json"), "{\"2\": [1], \"3\": 1, \"4\": [2], \"5\": [2]}")
                .unwrap();
        }
        let lineage = tracked(&path);
        assert_eq!((lineage.format, lineage.time, lineage.volumes), (Format::Tracks, TimeUnit::Frames, unit));
        assert_eq!(by_track(lives(&lineage)), numbered());
        assert_eq!(lineage.cells[0].volume.map(|volume| (volume * 1e6).round()), volume.map(|v| (v * 1e6).round()));
        assert_eq!(lineage.skipped_count, 0);
    }
    let (folder, path) = file("embryo.csv", &napari);
    fs::write(folder.path().join("embryo_graph.csv"), "child,parent\n2,1\n3,1\n4,2\n5,2\n").unwrap();
    assert_eq!(by_track(lives(&tracked(&path))), numbered());
    // Two mothers, as where tracks merge.
    fs::write(folder.path().join("embryo_graph.csv"), "child,parent\n2,1\n3,1\n4,2\n5,2\n5,3\n").unwrap();
    let lineage = tracked(&path);
    assert_eq!(reports(&lineage), ["6 child 5: it comes from 2 and from 3: it is left without a mother"]);
    // Volumes in a unit.
    let sized = table("track_id,t,y,x,parent_track_id,volume_um3,name", |track, t, mother, radius| {
        format!("{track},{t},1,2,{mother},{radius},{}", ["", "P0", "AB", "P1", "ABa", "ABp"][track as usize])
    });
    let lineage = embryo("sized.csv", sized);
    assert_eq!((lineage.volumes, lineage.cells[0].volume), (Unit::CubicMicrometres, Some(20.0)));
    assert_eq!(in_order(lives(&lineage)), LIVES);
}

/// Text of btrack with ids of tracks, tables with ids of spots, as funtracks writes them, and ilastik's.
#[test]
fn ids_may_be_of_tracks_or_of_spots() {
    let btrack = table("ID t x y z parent root", |track, t, mother, _| {
        format!("{track} {t} 1.5 2.5 3.5 {} 1", if mother == 0 { track } else { mother })
    });
    let lineage = embryo("embryo.txt", btrack);
    assert_eq!((lineage.format, by_track(lives(&lineage))), (Format::Tracks, numbered()));
    let funtracks = spots_with_ids("t,z,y,x,id,parent_id,track_id", |track| format!(",{track}"));
    assert_eq!(by_track(lives(&embryo("embryo.csv", funtracks))), numbered());
    // Without tracks a cell has the id of its first spot.
    let times =
        |lineage: &TrackedLineage| lineage.cells.iter().map(|cell| (cell.birth, cell.division)).collect::<Vec<_>>();
    let of_spots = embryo("embryo.csv", spots_with_ids("t,z,y,x,id,parent_id", |_| String::new()));
    assert_eq!(times(&of_spots), times(&lineage));
    let ilastik = "frame,trackId,parentTrackId,Size_in_pixels_0\n0,1,0,8\n1,2,1,4\n1,3,1,4\n";
    let lineage = embryo("ilastik.csv", ilastik);
    assert_eq!((lineage.volumes, lineage.cells[0].volume), (Unit::Voxels, Some(8.0)));
}

/// A row for each spot: its id, the id of the spot before, and at the end what `track` gives.
fn spots_with_ids(heading: &str, track: impl Fn(u32) -> String) -> String {
    let of = |number: u32| TRACKS.iter().find(|(track, ..)| *track == number);
    let id = |track: u32, t: u32| 100 * track + t;
    table(heading, |number, t, mother, _| {
        let first = of(number).map_or(0, |(_, first, ..)| *first);
        let parent = match of(mother) {
            _ if t > first => id(number, t - 1).to_string(),
            Some((_, _, last, ..)) => id(mother, *last).to_string(),
            None => String::new(),
        };
        format!("{t},1,2,3,{},{parent}{}", id(number, t), track(number))
    })
}

/// The unit of times is in their heading; without one they are frames.
#[test]
fn times_of_tracks_may_have_a_unit() {
    for (heading, unit, times) in [
        ("t", TimeUnit::Frames, [30.0, 90.0]),
        ("Time (frames)", TimeUnit::Frames, [30.0, 90.0]),
        ("time (min)", TimeUnit::Minutes, [30.0, 90.0]),
        ("Time [s]", TimeUnit::Minutes, [0.5, 1.5]),
        ("time_h", TimeUnit::Minutes, [1800.0, 5400.0]),
        ("t in s", TimeUnit::Minutes, [0.5, 1.5]),
    ] {
        let rows = "1,30,0,0,-1\n2,90,0,0,1\n";
        let lineage = embryo("tracks.csv", format!("track_id,{heading},y (µm),x (µm),parent_track_id\n{rows}"));
        assert_eq!(
            (lineage.time, lineage.cells[0].birth, lineage.cells[1].birth),
            (unit, times[0], times[1]),
            "{heading}"
        );
    }
    for (heading, unit, volume) in [
        ("radius", Unit::Voxels, sphere(4.0)),
        ("Diameter (px)", Unit::Voxels, sphere(2.0)),
        ("Radius (µm)", Unit::CubicMicrometres, sphere(4.0)),
    ] {
        let lineage = embryo("tracks.csv", format!("track_id,t,parent,{heading}\n1,0,-1,2\n"));
        assert_eq!((lineage.volumes, lineage.cells[0].volume), (unit, Some(volume)), "{heading}");
    }
    let why = "tracks.csv:1:1: the unit of column 2, \"time (weeks)\", must be frames or one of min, s, h";
    assert_eq!(refusal("tracks.csv", "track_id,time (weeks),y,x,parent_track_id\n1,0,0,0,-1\n"), why);
}

#[test]
fn wrong_tables_of_tracks_are_refused_with_their_line() {
    let heading = "track_id,t,y,x,parent_track_id";
    for (rows, message) in [
        ("1,zero,0,0,-1\n", "cell that can be used: line 2, t: \"zero\": must be a number of frames"),
        ("1,0,0,0,7\n", "tracks.csv:2:1: parent = 7: must be a track of the table"),
        ("1,0,0,0,-1\n1,0,0,1,-1\n", "tracks.csv:3:1: cell 1 a second time at time 0; the first is on line 2"),
        (
            "1,0,0,0,-1\n2,0,0,0,-1\n2,1,0,0,1\n",
            "tracks.csv:4:1: track 2 comes from no track in rows before, here from track 1",
        ),
        ("", "is not table of tracks with a cell that can be used: it has no spots"),
    ] {
        let error = refusal("tracks.csv", format!("{heading}\n{rows}"));
        assert!(error.contains(message), "{error}\n{message}");
    }
    // A row that cannot be used or is given twice costs no other row.
    for (row, why) in [
        ("a,1,0,0,-1", "3 track_id a: must be a whole number from 0"),
        (",1,0,0,-1", "3 track_id : must be a whole number from 0"),
        ("1,,0,0,-1", "3 t : must be a number of frames"),
        ("1,1,0,0,mother", "3 parent_track_id mother: must be a track_id, or -1"),
        ("1,1,0,0,-1,5", "3  5: line 3 has 6 fields, the heading 5"),
        ("1,0,0,0,-1", "3 track_id 1: the row of line 2 a second time"),
    ] {
        let lineage = embryo("tracks.csv", format!("{heading}\n1,0,0,0,-1\n{row}\n1,2,0,0,-1\n2,3,0,0,1\n"));
        assert_eq!(lives(&lineage), [("1", None, 0.0, Some(3.0), 2.0), ("2", Some("1"), 3.0, None, 3.0)], "{row}");
        assert_eq!(reports(&lineage), [why]);
    }
    // Rows that pandas numbers are repeats too.
    let why = [
        "3 track_id 1: the row of line 2 a second time",
        "5 track_id x: must be a whole number from 0",
        "4 parent 5: must be a track of the table",
    ];
    let rows = "0,1,0,0,0,-1\n1,1,0,0,0,-1\n2,2,1,0,0,5\n3,x,1,0,0,5\n";
    assert_eq!(reports(&embryo("tracks.csv", format!(",{heading}\n{rows}"))), why);
    let why = "4 t 1: it is born while its mother 1 is still there, until time 1";
    assert_eq!(reports(&embryo("tracks.csv", format!("{heading}\n1,0,0,0,-1\n1,1,0,0,-1\n2,1,0,0,1\n"))), [why]);
}

/// Mother and daughter stay two cells where the other daughter is left out or was not followed.
#[test]
fn a_daughter_without_a_sister_is_no_part_of_her_mother() {
    let heading = "track_id,t,y,x,parent_track_id,volume_um3";
    let mother = "1,0,0,0,-1,9\n1,1,0,0,-1,9\n";
    for rows in ["2,1,0,0,1,5\n2,2,0,0,1,5\n3,2,0,0,1,4\n3,3,0,0,1,4\n", "3,2,0,0,1,4\n3,3,0,0,1,4\n"] {
        let lineage = embryo("tracks.csv", format!("{heading}\n{mother}{rows}"));
        let cell = |name: &str| lineage.cells.iter().find(|cell| cell.name == name).unwrap();
        assert_eq!((cell("1").volume, cell("1").division, cell("1").last), (Some(9.0), Some(2.0), 1.0), "{rows}");
        assert_eq!((cell("3").mother, cell("3").birth, cell("3").volume), (Some(0), 2.0, Some(4.0)), "{rows}");
    }
    // One name is one cell, though its track ends.
    let lives_of = [("AB", None, 0.0, Some(4.0), 2.0), ("ABa", Some("AB"), 4.0, None, 4.0)];
    let text = "track_id,t,y,x,parent_track_id,name\n1,0,0,0,-1,AB\n2,2,0,0,1,AB\n3,4,0,0,2,ABa\n";
    assert_eq!(lives(&embryo("tracks.csv", text)), lives_of);
    // Tracks of the Cell Tracking Challenge have gaps, unless a sister is left out.
    let lives_of = [("1", None, 0.0, Some(5.0), 4.0), ("4", None, 4.0, None, 6.0), ("3", Some("1"), 5.0, None, 6.0)];
    assert_eq!(lives(&embryo("01.txt", "1 0 1 0\n2 3 4 1\n3 5 6 2\n4 4 6 2\n")), lives_of);
}

#[test]
fn tracks_of_the_cell_tracking_challenge_are_cells_with_their_labels() {
    let (folder, path) = file("01.txt", ctc());
    let lineage = tracked(&path);
    assert_eq!((lineage.format, lineage.name.as_str()), (Format::Ctc, "01"));
    assert_eq!(by_track(lives(&lineage)), numbered());
    let inside = folder.path().join("02_GT");
    fs::create_dir_all(inside.join("TRA")).unwrap();
    fs::write(inside.join("TRA/man_track.txt"), ctc()).unwrap();
    for place in [inside.clone(), inside.join("TRA"), inside.join("TRA/man_track.txt")] {
        let lineage = tracked(&place);
        assert_eq!((lineage.name.as_str(), lineage.cells.len()), ("02_GT", 5), "{}", place.display());
    }
    for (text, message) in [
        ("1 5 4 0\n", "line 1, line: \"1 5 4 0\": the label must be above 0, and the first frame not after the last"),
        ("1 0 4 0\n1 5 6 0\n", "01.txt:2:1: label = 1: must be of one line only"),
        ("1 0 4 0\n2 5 6 9\n", "01.txt:2:1: mother = 9: must be 0 or a label of the file"),
    ] {
        let error = refusal("01.txt", text);
        assert!(error.contains(message), "{error}\n{message}");
    }
    let (folder, _) = file("man_track.txt", "1 0 4 0\n2 5 8\n1 0 4 0\n3 5 6 2\n");
    let path = folder.path();
    let why = [
        "2 line 2 5 8: must be four whole numbers: label, first and last frame, mother or 0",
        "3 label 1: the row of line 1 a second time",
        "4 mother 2: must be 0 or a label of the file",
    ];
    assert_eq!((tracked(path).cells.len(), reports(&tracked(path))), (2, why.map(str::to_owned).to_vec()));
}

/// Tables in a folder are read, but for graphs and links of others; damaged files are named with the reason.
#[test]
fn folders_have_tables_of_the_kind_that_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let files = [
        ("Sample01_Volume.csv", "time,AB,P1\n1,9,8\n"),
        ("long.csv", "embryo,cell,volume_um3\ne,AB,9\n"),
        ("lives.csv", "cell,lifetime_min\nAB,16\n"),
        ("e_tracks.csv", "track_id,t,y,x\n1,0,0,0\n"),
        ("e_graph.csv", "child,parent\n"),
        ("c.zip", "PK\u{3}\u{4}damaged"),
    ];
    for (name, text) in files {
        fs::write(folder.path().join(name), text).unwrap();
    }
    let paths = [folder.path().to_owned()];
    for (kind, right, wrong) in [
        (
            TableKind::Volumes,
            "Sample01_Volume e_tracks long",
            "lives.csv: is neither an embryo that was followed nor a table of volumes",
        ),
        (
            TableKind::Lifetimes,
            "e_tracks lives",
            "long.csv: is neither an embryo that was followed nor a table of lifetimes",
        ),
    ] {
        let (found, left) = embryo_files(&paths, kind).unwrap();
        let names: Vec<String> = found.into_iter().map(|file| file.name).collect();
        assert_eq!(names.join(" "), right);
        let left = left.into_iter().map(|left| left.why).collect::<Vec<_>>().join("\n");
        assert!(left.contains("c.zip: is not a zip archive") && left.contains(wrong), "{left}");
    }
    files[..5].iter().for_each(|(name, _)| fs::remove_file(folder.path().join(name)).unwrap());
    let error = embryo_files(&paths, TableKind::Volumes).unwrap_err().to_string();
    let (first, last) =
        ("is not a folder with an embryo that was followed or a table of volumes: ", "c.zip: is not a zip archive");
    assert!(error.contains(first) && error.contains(last), "{error}");
}

#[test]
fn folders_and_patterns_stand_for_the_embryos_in_them() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    for name in ["01/TRA", "02/TRA"] {
        fs::create_dir_all(at(name)).unwrap();
        fs::write(at(name).join("man_track.txt"), ctc()).unwrap();
    }
    for name in ["a", "b"] {
        fs::write(at(&format!("{name}_spots.csv")), "LABEL,ID,FRAME\n").unwrap();
        fs::write(at(&format!("{name}_edges.csv")), "").unwrap();
    }
    fs::write(at("notes.txt"), "none\n").unwrap();
    let files = |paths: &[PathBuf]| {
        let (files, left) = embryo_files(paths, TableKind::Volumes)?;
        let left: Vec<String> = left.into_iter().map(|left| left.why).collect();
        Ok::<_, InputError>((files.into_iter().map(|file| file.name).collect::<Vec<_>>(), left))
    };
    let (names, left) = files(&[folder.path().to_owned()]).unwrap();
    assert_eq!(names.join(" "), "01 02 a_spots b_spots");
    let why = "notes.txt: is neither an embryo that was followed nor a table of volumes: 1:1: no column is called";
    assert!(left.len() == 1 && left[0].contains(why), "{left:?}");
    let (names, _) = files(&[at("*_*.csv"), at("01"), at("not there")]).unwrap();
    assert_eq!(names, ["a_spots", "b_spots", "01", "not there"]);
    // Files of one name are called after their folders.
    let paths = ["01", "02"].map(|name| {
        fs::write(at(name).join("film_spots.csv"), "").unwrap();
        at(name).join("film_spots.csv")
    });
    assert_eq!(files(&paths).unwrap().0, ["01/film_spots", "02/film_spots"]);
    let error = files(&[at("*.xml")]).unwrap_err().to_string();
    assert!(error.contains("files = 0: must be a pattern that a file fits; there are 01, 02, a_edges"), "{error}");
    fs::create_dir(at("empty")).unwrap();
    // A file is read once, under any of its paths.
    let (names, left) = files(&[at("a_spots.csv"), at("empty/../a_spots.csv"), at("a_*.csv")]).unwrap();
    assert_eq!((names, left.len()), (vec!["a_spots".to_owned()], 2));
    assert!(left[0].ends_with("a_spots.csv, which is read once"), "{left:?}");
    let error = files(&[at("empty")]).unwrap_err().to_string();
    assert!(error.contains("it is a folder with neither nuclei of AceTree"), "{error}");
}
