//! Sizes that are no measurements, and units of sizes and times.

use super::tracks::{TRACKS, table, xml};
use super::*;
use crate::volumes::{ReadOptions, Volumes};

/// Detectors give all spots one size, which is none that was measured. One cell alone may keep its size.
#[test]
fn sizes_that_are_all_the_same_are_unknown() {
    let right = xml("spatialunits=\"micron\" timeunits=\"sec\"");
    let one_radius = TRACKS
        .iter()
        .fold(right.clone(), |text, (.., radius)| text.replace(&format!("RADIUS=\"{radius}\""), "RADIUS=\"2.5\""));
    let why = "spots of mothers and daughters, all of one size, as a detector sets it: sizes are unknown";
    let (_folder, path) = file("film.xml", one_radius);
    let lineage = tracked(&path);
    assert!(lineage.cells.iter().all(|cell| cell.volume.is_none() && cell.sizes == 0));
    assert_eq!(reports(&lineage)[0], format!("7 size 12: {why}"));
    assert_eq!((lineage.skipped_count, lineage.cells[1].lifetime()), (2, Some(3.0)));
    let files = embryo_files(&[path], TableKind::Volumes).unwrap().0;
    let error = Volumes::of_files(&files, &ReadOptions::default()).unwrap_err().to_string();
    assert!(error.contains(&format!("line 7, column size: \"12\": {why}")), "{error}");
    for column in ["radius", "Diameter (µm)", "volume_um3"] {
        let text = table(&format!("track_id,t,y,x,parent_track_id,{column}"), |track, t, mother, _| {
            format!("{track},{t},1,2,{mother},2.5")
        });
        let (_folder, path) = file("tracks.csv", text);
        assert!(tracked(&path).cells.iter().all(|cell| cell.volume.is_none()), "{column}");
    }
    let (_folder, path) = file("tracks.csv", "track_id,t,y,x,parent_track_id,radius\n1,0,0,0,-1,2\n2,0,0,0,-1,2\n");
    assert!(tracked(&path).cells.iter().all(|cell| cell.volume.is_some()));
}

/// Beside `frame`, `time` may be in any unit; in a known one it comes before frames, unless the minutes of a frame are given.
#[test]
fn of_two_columns_of_times_the_one_with_a_known_unit_counts() {
    for (heading, minutes, expected) in [
        ("time,frame", None, (TimeUnit::Frames, 2.0)),
        ("time,frame", Some(1.5), (TimeUnit::Minutes, 3.0)),
        ("t,timepoint", None, (TimeUnit::Frames, 2.0)),
        ("time (s),frame", None, (TimeUnit::Minutes, 3.0)),
        ("time_s,t", None, (TimeUnit::Minutes, 3.0)),
        ("time (s),frame", Some(2.0), (TimeUnit::Minutes, 4.0)),
    ] {
        let rows = "1,0,0,0,0,-1\n2,180,2,0,0,1\n";
        let (_folder, path) = file("tracks.csv", format!("track_id,{heading},y,x,parent_track_id\n{rows}"));
        let options = TrackOptions { frame_minutes: minutes, ..TrackOptions::default() };
        let lineage = read_tracked(&path, &options).unwrap().unwrap();
        assert_eq!((lineage.time, lineage.cells[1].birth), expected, "{heading} {minutes:?}");
    }
}

/// What programs write for nothing is no mother, in tables and in graphs.
#[test]
fn missing_values_are_no_mothers() {
    for none in ["", "NA", "NaN", "None", "<NA>", "null", "#N/A", "-1"] {
        let rows = format!("1,0,0,0,{none}\n2,1,0,0,1\n");
        let (_folder, path) = file("tracks.csv", format!("track_id,t,y,x,parent_track_id\n{rows}"));
        let lineage = tracked(&path);
        assert_eq!((lineage.cells.len(), lineage.cells[1].mother, lineage.skipped_count), (2, Some(0), 0), "{none}");
        let (folder, path) = file("a_tracks.csv", "track_id,t,y,x\n1,0,0,0\n2,1,0,0\n");
        fs::write(folder.path().join("a_graph.csv"), format!("child,parent\n1,{none}\n2,1\n")).unwrap();
        assert_eq!(tracked(&path).cells[1].mother, Some(0), "{none}");
    }
}
