//! Pictures, movies and frames of what the commands compute.

use std::fs;

use crate::common::command::{answer, json, refusal};
use serde_json::Value;

/// Commands that draw, quick ones, each with words that its picture must have.
const DRAWN: [(&str, &[&str]); 6] = [
    ("branch --r0 2 --xi-max 30", &["supercritical", "unstable", "pitchfork", "fold", "elongation H"]),
    (
        "boundary --vary r0 --from 1.6 --to 1.9 --critical --no-folds",
        &["1.7063", "criticality changes", "radius R₀ (Lₕ)", "activity ξₛ (κ₀/Lₕ)"],
    ),
    (
        "phase --vary r0 --from 1.6 --to 2.4 --points 3 --xi-from 20 --xi-points 2",
        &["stays at rest", "symmetric", "pitchfork"],
    ),
    ("divide --r0 4 --cue germline", &["χ = 0.15", "pressure", "neck radius", "t = 0.00 τ"]),
    ("tree --xi 20 --r0 2.4 --out tree", &["observed", "EMS", "terminal cells"]),
    ("sweep sweep.ron --out sweep", &["size asymmetry χ", "ε = 0.8", "ε = 0.87"]),
];

fn with_sweep() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let axes = r#"[(parameter: "r0", list: [1.5, 1.8, 2.5]), (parameter: "epsilon", list: [0.8, 0.87])]"#;
    fs::write(folder.path().join("sweep.ron"), format!("Sweep(kind: division, axes: {axes})")).unwrap();
    folder
}

#[test]
fn every_picture_says_what_it_shows_and_is_the_same_at_any_number_of_threads() {
    let folder = with_sweep();
    for (arguments, words) in DRAWN {
        let arguments: Vec<&str> = arguments.split(' ').collect();
        let draw = |threads: &str| {
            let drawn = [&arguments[..], &["--plot", "a.svg", "--no-cache", "--threads", threads]].concat();
            assert!(json(folder.path(), &drawn).is_object());
            fs::read_to_string(folder.path().join("a.svg")).unwrap()
        };
        let (picture, again) = (draw("1"), draw("2"));
        assert!(picture.starts_with("<svg") && picture.trim_end().ends_with("</svg>"));
        assert_eq!(picture.matches("<g").count(), picture.matches("</g>").count());
        assert!(!picture.contains("NaN") && !picture.contains("inf"), "{arguments:?}");
        for word in words {
            assert!(picture.contains(word), "{arguments:?}: {word}");
        }
        assert_eq!(picture, again, "{arguments:?}");
    }
}

#[test]
fn pictures_are_written_as_dots_too_and_replace_what_was_there() {
    let folder = with_sweep();
    for (arguments, _) in DRAWN {
        let arguments: Vec<&str> = arguments.split(' ').collect();
        fs::write(folder.path().join("a.PNG"), "not a picture").unwrap();
        answer(folder.path(), &[&arguments[..], &["--plot", "a.PNG"]].concat());
        let bytes = fs::read(folder.path().join("a.PNG")).unwrap();
        let reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let (width, height) = reader.info().size();
        assert!(width > 1000 && height > 800, "{arguments:?}: {width} {height}");
    }
}

#[test]
fn a_calibration_and_a_sample_are_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let targets = concat!(env!("CARGO_MANIFEST_DIR"), "/data/thresholds.ron");
    let quick = ["--set", "stages=3", "--set", "intervals=32"];
    answer(folder.path(), &[&["calibrate", targets, "--plot", "fit.svg"], &quick[..]].concat());
    let picture = fs::read_to_string(folder.path().join("fit.svg")).unwrap();
    for word in ["R₀ = 1.64, ε = 0.87", "tolerance", "deviation of ξₛ* (%)"] {
        assert!(picture.contains(word), "{word}");
    }
    answer(folder.path(), &[&["calibrate", targets, "--ensemble", "3", "--plot", "pairs.svg"], &quick[..]].concat());
    let picture = fs::read_to_string(folder.path().join("pairs.svg")).unwrap();
    assert!(picture.contains("3 admissible sets of constants") && picture.contains("shell, a/b"));
}

#[test]
fn trees_are_drawn_side_by_side_and_over_constants() {
    let folder = tempfile::tempdir().unwrap();
    let small = ["--xi", "20", "--r0", "2.4", "--no-cache"];
    let cues = ["tree", "--cue", "none", "--cue", "germline", "--out", "cues", "--plot", "cues.svg"];
    answer(folder.path(), &[&cues[..], &small].concat());
    let picture = fs::read_to_string(folder.path().join("cues.svg")).unwrap();
    assert!(
        picture.contains("c_elegans-none") && picture.contains("c_elegans-germline") && picture.contains("observed")
    );
    fs::write(folder.path().join("sets.csv"), "aspect,weight\n1.45,0.5\n1.5,0.5\n").unwrap();
    answer(folder.path(), &[&["tree", "--constants", "sets.csv", "--plot", "sets.svg"], &small[..]].concat());
    let picture = fs::read_to_string(folder.path().join("sets.svg")).unwrap();
    assert!(picture.contains("5–95 % of 2 sets of constants"));
}

#[test]
fn branches_and_boundaries_print_their_events_and_write_their_points() {
    let folder = tempfile::tempdir().unwrap();
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    for arguments in [
        &["branch", "--r0", "2", "--xi-max", "30"][..],
        &["boundary", "--vary", "r0", "--from", "1.6", "--to", "1.9", "--critical"],
    ] {
        let summary = answer(folder.path(), arguments);
        let all = answer(folder.path(), &[arguments, &["--points", "--csv", "points.csv"]].concat());
        assert!(summary.lines().count() < 12 && all.lines().count() > 20, "{summary}");
        let json = json(folder.path(), arguments);
        let csv = read("points.csv");
        let rows: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
        let column = |name: &str| rows[0].iter().position(|column| *column == name).unwrap();
        let (first, count) = match arguments[0] {
            "branch" => (&json["points"][0], json["points"].as_array().unwrap().len()),
            _ => {
                let counts = ["pitchfork", "folds", "degenerate", "cusps"].map(|k| json[k].as_array().unwrap().len());
                (&json["pitchfork"][0], counts.iter().sum::<usize>() + 1)
            }
        };
        assert_eq!(rows.len(), count + 1);
        for name in ["xi_s", "H"] {
            assert_eq!(rows[1][column(name)].parse::<f64>().unwrap(), first[name].as_f64().unwrap());
        }
    }
    assert!(answer(folder.path(), &["branch", "--r0", "2", "--xi-max", "30"]).contains("supercritical"));
}

/// Frames at even times: their columns, the balance of forces, and nothing of the frames that were there before.
#[test]
fn frames_tell_what_acts_on_a_cell_at_even_times() {
    let folder = tempfile::tempdir().unwrap();
    let frames = folder.path().join("frames");
    let divide = ["divide", "--r0", "2.5", "--no-cache", "--frames", "frames"];
    let index = || -> Vec<Value> {
        let text = fs::read_to_string(frames.join("frames.json")).unwrap();
        serde_json::from_str(&text).unwrap()
    };
    // The columns of a frame, by name.
    let table = |name: &str| {
        let text = fs::read_to_string(frames.join(name)).unwrap();
        let header: Vec<String> = text.lines().next().unwrap().split(',').map(str::to_owned).collect();
        let row = |line: &str| line.split(',').map(|x| x.parse().unwrap()).collect();
        (header, text.lines().skip(1).map(row).collect::<Vec<Vec<f64>>>())
    };
    answer(folder.path(), &divide);
    let steps = fs::read_dir(&frames).unwrap().count();
    let entries = index();
    assert!(entries.len() > 10);
    let last = entries.last().unwrap();
    // Pinch-off is at a thousandth of R0; the contour runs from pole to pole.
    assert!(last["neck_radius"].as_f64().unwrap() < 2.6e-3);
    let (_, rows) = table(last["file"].as_str().unwrap());
    let (first, last) = (&rows[0], &rows[rows.len() - 1]);
    assert_eq!((first[0], last[0]), (0.0, 1.0));
    assert!(first[1].abs() < 1e-9 && last[1].abs() < 1e-9 && first[2] > 0.0 && last[2] < 0.0);

    answer(folder.path(), &[&divide[..], &["--frame-step", "0.5"]].concat());
    let entries = index();
    assert_eq!(fs::read_dir(&frames).unwrap().count(), entries.len() + 1);
    assert!(entries.len() + 1 < steps);
    for (k, entry) in entries[..entries.len() - 1].iter().enumerate() {
        assert_eq!(entry["t"].as_f64().unwrap(), 0.5 * k as f64);
    }
    let (header, rows) = table("frame_0002.csv");
    assert_eq!(header[..4], ["u", "r", "z", "psi"]);
    assert!(rows.len() > 60);
    let column = |name: &str| header.iter().position(|column| *column == name).unwrap();
    let parts = ["active_n", "viscous_n", "elastic_n", "pressure_n", "shell_n"].map(column);
    for row in &rows {
        let sum: f64 = parts.iter().map(|k| row[*k]).sum();
        let size: f64 = parts.iter().map(|k| row[*k].abs()).sum();
        assert!((sum - row[column("residual_n")]).abs() < 1e-9 * size && sum.abs() < 1e-2 * size, "{row:?}");
    }
    let said = refusal(folder.path(), &[&divide[..], &["--frame-step", "1e-9"]].concat());
    assert!(said.starts_with("furrow: error: --frame-step: frame_step = 0.000000001: must be at least"), "{said}");
}

#[test]
fn a_division_moves_in_every_format() {
    let folder = tempfile::tempdir().unwrap();
    let movie = |name: &str| {
        let arguments = ["divide", "--r0", "4", "--cue", "germline", "--movie", name, "--movie-frames", "4"];
        answer(folder.path(), &arguments);
        fs::read(folder.path().join(name)).unwrap()
    };
    let bytes = movie("a.gif");
    let mut decoder = gif::DecodeOptions::new().read_info(&bytes[..]).unwrap();
    let mut frames = Vec::new();
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        frames.push((frame.delay, frame.buffer.clone()));
    }
    assert_eq!(frames.len(), 4);
    assert!(frames[3].0 > frames[0].0 && frames.windows(2).all(|pair| pair[0].1 != pair[1].1));
    let bytes = movie("a.png");
    let reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    assert_eq!(reader.info().animation_control().unwrap().num_frames, 4);
    let text = String::from_utf8(movie("a.svg")).unwrap();
    assert_eq!(text.matches("<animate ").count(), 4);
    assert!(text.contains("asymmetric, χ = 0.15") && text.matches("display=\"inline\"").count() == 1);
}
