//! Sizes that are no measurements, and units of sizes and times.

use super::tracks::{TRACKS, table, xml};
use super::*;
use crate::volumes::{ReadOptions, Volumes};

/// Detectors give all spots one size, which was not measured. A single cell keeps its size.
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
    let report = lineage.unknown_sizes.as_ref().map(|skipped| (skipped.line, skipped.why.as_str()));
    assert_eq!(report, Some((7, why)));
    assert_eq!((lineage.skipped_count, lineage.cells[1].lifetime()), (1, Some(3.0)));
    let files = embryo_files(&[path], TableKind::Volumes).unwrap().0;
    let error = Volumes::of_files(&files, &ReadOptions::default()).unwrap_err().to_string();
    assert!(error.contains(&format!("line 7, column size: \"12\": {why}")), "{error}");
    for column in ["radius", "Diameter (µm)", "volume_um3"] {
        let text = table(&format!("track_id,t,y,x,parent_track_id,{column}"), |track, t, mother, _| {
            format!("{track},{t},1,2,{mother},2.5")
        });
        assert!(embryo("tracks.csv", text).cells.iter().all(|cell| cell.volume.is_none()), "{column}");
    }
    let single = embryo("tracks.csv", "track_id,t,y,x,parent_track_id,radius\n1,0,0,0,-1,2\n2,0,0,0,-1,2\n");
    assert!(single.cells.iter().all(|cell| cell.volume.is_some()));
}

/// Programs write z = 0 for films in two dimensions.
#[test]
fn areas_in_the_plane_z_0_are_no_volumes() {
    let at = |z: u32| {
        table("track_id,t,z,y,x,parent_track_id,area", |track, t, mother, radius| {
            format!("{track},{t},{z},1,2,{mother},{radius}")
        })
    };
    let lineage = embryo("tracks.csv", at(0));
    assert!(lineage.cells.iter().all(|cell| cell.volume.is_none()));
    assert_eq!(lineage.unknown_sizes.map(|report| (report.line, report.column)), Some((2, "z".to_owned())));
    assert!(embryo("tracks.csv", at(1)).cells.iter().all(|cell| cell.volume.is_some()));
}

/// `--unit` says what volumes without a unit are; lengths may have theirs behind an underscore, too.
#[test]
fn volumes_without_a_unit_take_the_given_one() {
    let text = table("track_id,t,y,x,parent_track_id,volume", |track, t, mother, radius| {
        format!("{track},{t},1,2,{mother},{radius}")
    });
    let (_folder, path) = file("tracks.csv", &text);
    let files = embryo_files(&[path], TableKind::Volumes).unwrap().0;
    let found = |unit: Option<Unit>, voxel: Option<f64>| {
        let names = Names::default();
        let options = ReadOptions { unit, voxel: voxel.into(), names, ..ReadOptions::default() };
        let mut volumes = Volumes::default();
        volumes.read_file(&files[0], &options)?;
        volumes.require_options()?;
        Ok::<_, InputError>(volumes.unit)
    };
    for (unit, voxel, expected) in [
        (None, None, Unit::Voxels),
        (None, Some(0.1), Unit::CubicMicrometres),
        (Some(Unit::CubicMicrometres), None, Unit::CubicMicrometres),
        (Some(Unit::Relative), None, Unit::Relative),
        (Some(Unit::Voxels), Some(0.1), Unit::CubicMicrometres),
    ] {
        assert_eq!(found(unit, voxel).unwrap(), Some(expected), "{unit:?} {voxel:?}");
    }
    let error = found(Some(Unit::CubicMicrometres), Some(0.1)).unwrap_err().to_string();
    assert!(error.contains("--voxel: voxel = (given): must be left out"), "{error}");
    for (heading, unit, volume) in [
        ("radius_um,y", Unit::CubicMicrometres, sphere(4.0)),
        ("Diameter in nm,y", Unit::CubicMicrometres, sphere(2e-3)),
        ("radius_px,y", Unit::Voxels, sphere(4.0)),
        ("radius,radius_um", Unit::CubicMicrometres, sphere(6.0)),
    ] {
        let lineage = embryo("tracks.csv", format!("track_id,t,parent,{heading}\n1,0,-1,2,3\n"));
        assert_eq!((lineage.volumes, lineage.cells[0].volume), (unit, Some(volume)), "{heading}");
    }
}

/// Beside `frame`, `time` may be in any unit; in a known one it comes before frames, unless the minutes of a frame are given.
#[test]
fn of_two_columns_of_times_the_one_with_a_known_unit_counts() {
    for (heading, minutes, expected) in [
        ("time,frame", None, (TimeUnit::Frames, 2.0)),
        ("time,frame", Some(1.5), (TimeUnit::Minutes, 3.0)),
        ("t,timepoint", None, (TimeUnit::Frames, 2.0)),
        ("time (s),frame", None, (TimeUnit::Minutes, 3.0)),
        ("time (weeks),t", None, (TimeUnit::Frames, 2.0)),
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

/// Options without effect are refused: minutes of frames where times have a unit, and edges of pixels where lengths have one.
#[test]
fn options_that_say_nothing_of_a_followed_embryo_are_refused() {
    let named = |heading: &str| {
        let name = |track: u32| ["", "P0", "AB", "P1", "ABa", "ABp"][track as usize];
        table(heading, |track, t, mother, radius| format!("{track},{t},1,2,{mother},{radius},{}", name(track)))
    };
    let (_folder, path) = file("timed.csv", named("track_id,t (min),y,x,parent_track_id,radius (um),name"));
    let (_other, counted) = file("counted.csv", named("track_id,t,y,x,parent_track_id,radius,name"));
    let allowed = "must be left out: tables have times in a unit, and no file has frames";
    let error = lifetimes(&path, Some(10.0)).unwrap_err().to_string();
    assert_eq!(error, format!("--frame-minutes: frame_minutes = (given): {allowed}"));
    assert_eq!(lifetimes(&path, None).unwrap().cells[0].mean, 2.0);
    assert_eq!(lifetimes(&counted, Some(10.0)).unwrap().cells[0].mean, 20.0);
    let options = ReadOptions { voxel: Some(0.1).into(), ..ReadOptions::default() };
    let volumes = |path: &Path| {
        let files = embryo_files(&[path.to_owned()], TableKind::Volumes)?.0;
        Volumes::of_files(&files, &options).map(|volumes| volumes.unit)
    };
    let error = volumes(&path).unwrap_err().to_string();
    assert!(error.starts_with("--voxel: voxel = (given): must be left out: no volume is in voxels"), "{error}");
    assert_eq!(volumes(&counted).unwrap(), Some(Unit::CubicMicrometres));
    let both = TrackOptions { pixel: Some(0.1), frame_minutes: Some(1.0), ..TrackOptions::default() };
    let lineage = read_tracked(&path, &both).unwrap().unwrap();
    let error = lineage.require_options(&both).unwrap_err().to_string();
    assert!(error.contains("must be left out: the times of timed are in minutes"), "{error}");
    let error = lineage.require_options(&TrackOptions { frame_minutes: None, ..both }).unwrap_err().to_string();
    assert!(error.contains("must be left out: timed has no sizes in voxels or pixels"), "{error}");
    read_tracked(&counted, &both).unwrap().unwrap().require_options(&both).unwrap();
    // Minutes of a frame come before the XML's times.
    let (_folder, path) = file("film.xml", xml("spatialunits=\"pixel\" timeunits=\"sec\""));
    read_tracked(&path, &both).unwrap().unwrap().require_options(&both).unwrap();
}

/// What programs write for nothing is no mother, in tables and in graphs.
#[test]
fn missing_values_are_no_mothers() {
    for none in ["", "NA", "NaN", "None", "<NA>", "null", "#N/A", "-1"] {
        let rows = format!("1,0,0,0,{none}\n2,1,0,0,1\n");
        let lineage = embryo("tracks.csv", format!("track_id,t,y,x,parent_track_id\n{rows}"));
        assert_eq!((lineage.cells.len(), lineage.cells[1].mother, lineage.skipped_count), (2, Some(0), 0), "{none}");
        let (folder, path) = file("a_tracks.csv", "track_id,t,y,x\n1,0,0,0\n2,1,0,0\n");
        fs::write(folder.path().join("a_graph.csv"), format!("child,parent\n1,{none}\n2,1\n")).unwrap();
        assert_eq!(tracked(&path).cells[1].mother, Some(0), "{none}");
    }
}
