//! The command as users meet it: exit codes, the text of complaints, JSON keys, files.

use std::path::Path;

use serde_json::Value;

use crate::common::command::{HERE, furrow, json, refusal};

fn write(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn numbers_out_of_range_name_option_field_and_value() {
    for (arguments, complaint) in [
        (&["divide", "--r0", "nan"][..], "--r0: r0 = NaN: must be a finite number above 0, from 1e-6 to 1e6"),
        (&["divide", "--r0", "-1"], "--r0: r0 = -1: must be a finite number above 0, from 1e-6 to 1e6"),
        (&["divide", "--r0", "0"], "--r0: r0 = 0: must be a finite number above 0, from 1e-6 to 1e6"),
        (&["divide", "--r0", "2", "--epsilon", "1"], "--epsilon: epsilon = 1: must be above 0 and below 1"),
        (&["divide", "--r0", "2", "--xi", "inf"], "--xi: xi_s = inf: must be a finite number"),
        (&["tree", "--set", "eps=1.2"], "--set: physics.epsilon = 1.2: must be above 0 and below 1"),
        (&["tree", "--set", "stages=9"], "--set: numerics.stages = 9: must be a whole number from 1 to 5"),
        (&["tree", "--set", "w=thin"], "--set: w = thin: must be a finite number above 0"),
        (&["tree", "--set", "xi"], "--set: setting = \"xi\": must be of the form key=value"),
        (&["tree", "--r0-step", "-1"], "--r0-step: r0_step = -1: must be from 0 to 0.5"),
        (&["tree", "no-such-file.ron"], "no-such-file.ron: cannot be read: No such file or directory (os error 2)"),
    ] {
        assert_eq!(refusal(HERE, arguments), format!("furrow: error: {complaint}\n"));
    }
    let unknown = refusal(HERE, &["tree", "--set", "radius=3"]);
    assert!(unknown.starts_with("furrow: error: --set: key = \"radius\": must be one of kappa, eta_b,"), "{unknown}");
    assert!(
        refusal(HERE, &["tree", "--threads", "0"])
            .contains("invalid value '0' for '--threads <N>': 0 is not in 1..=1024")
    );
    assert!(refusal(HERE, &["divide", "--r0", "big"]).contains("invalid value 'big' for '--r0 <R>'"));
}

/// A cue that is refused is told by its part, its value and what is allowed, in every command that takes one.
#[test]
fn cues_that_are_none_are_refused() {
    for (arguments, complaint) in [
        (
            &["divide", "--r0", "2", "--cue", "kappa:u0=1.5,omega=0.1,amplitude=0.1"][..],
            "--cue: kappa.u0 = 1.5: must be from 0 to 1",
        ),
        (
            &["divide", "--r0", "2", "--cue", "kappa:u0=0.4,amplitude=0.1"],
            "--cue: kappa.omega = (not given): must be given: a band has no default for it",
        ),
        (
            &["divide", "--r0", "2", "--cue", "polar"],
            "--cue: cue = \"polar\": must be none, germline, or terms FIELD:PROFILE,key=value,.. joined by +",
        ),
        (
            &["tree", "--cue", "germ+tension:gradient,amplitude=0.1"],
            "--cue: cue = \"germ\": must be none, germline, or terms FIELD:PROFILE,key=value,.. joined by +",
        ),
        (
            &["tree", "--cue", "germlime"],
            "--cue: cue = \"germlime\": must be none, germline, or terms FIELD:PROFILE,key=value,.. joined by +; did you mean germline?",
        ),
        (
            &["divide", "--r0", "2", "--cue", "germline+friction:gradient,amplitude=1.5"],
            "--cue: cue[1].friction.amplitude = 1.5: must be above -1 and below 1",
        ),
    ] {
        assert_eq!(refusal(HERE, arguments), format!("furrow: error: {complaint}\n"));
    }
}

#[test]
fn configuration_file_complaints() {
    let folder = tempfile::tempdir().unwrap();
    for (text, complaint) in [
        ("Config(physics: (epsilon: 1.0))", ": physics.epsilon = 1: must be above 0 and below 1"),
        ("Config(physics: (r0: NaN))", ": physics.r0 = NaN: must be a finite number above 0, from 1e-6 to 1e6"),
        ("Config(numerics: (intervals: 7))", ": numerics.intervals = 7: must be an even whole number from 16 to 4096"),
        ("Config(\n  physics: (epsilon 0.8))", ":2:21: physics: expected a colon, found 0.8"),
    ] {
        let file = write(folder.path(), "c.ron", text);
        assert_eq!(refusal(HERE, &["tree", "--config", &file]), format!("furrow: error: {file}{complaint}\n"));
    }
    let file = write(folder.path(), "c.ron", "Config(physics: (radius: 2))");
    let complaint = refusal(HERE, &["tree", "--config", &file]);
    assert!(complaint.contains("c.ron:1:18: physics: unknown field \"radius\": must be one of kappa"), "{complaint}");
}

#[test]
fn lineage_file_complaints() {
    let folder = tempfile::tempdir().unwrap();
    let founders = |list: &str| format!("Lineage(name: \"x\", founders: [\n{list}\n])");
    for (text, complaint) in [
        (
            founders("(name: \"A\"),\n(name: \"B\", mother: \"Q\", daughter: larger)"),
            ":3: founder \"B\": mother = \"Q\": must be a founder of this file: A, B",
        ),
        (
            founders("(name: \"A\", mother: \"B\", daughter: larger),\n(name: \"B\", mother: \"A\", daughter: larger)"),
            ":2: the founders' mothers form a cycle: A <- B <- A; one founder must have no mother, and all others descend from it",
        ),
        (founders("(name: \"A\""), ":3:1: founders[0].name: expected a comma or the closing bracket, found ]"),
    ] {
        let file = write(folder.path(), "l.ron", &text);
        let said = refusal(HERE, &["tree", &file]);
        assert_eq!(said, format!("furrow: error: {file}{complaint}\n"));
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "nothing but the input may be left");
}

#[test]
fn divide_answers() {
    let cued = json(HERE, &["divide", "--r0", "5.4", "--cue", "germline", "--no-cache"]);
    assert_eq!(cued["outcome"], "asymmetric");
    for spelled in ["kappa:u0=0.465,omega=0.0577,amplitude=0.1", "kappa:band, amplitude=1e-1, omega=0.0577, u0=0.465"] {
        assert_eq!(cued, json(HERE, &["divide", "--r0", "5.4", "--cue", spelled, "--no-cache"]));
    }
    for key in ["chi", "u_furrow", "t_end", "steps", "newton_iterations", "chi_mean", "chi_sd"] {
        assert!(cued[key].is_number(), "{key}");
    }
    let volume: f64 = cued["daughters"].as_array().unwrap().iter().map(|r| r.as_f64().unwrap().powi(3)).sum();
    assert!((volume / 5.4f64.powi(3) - 1.0).abs() < 1e-12, "{volume}");

    let several =
        json(HERE, &["divide", "--r0", "2.5", "--replicates", "3", "--seed", "7", "--no-cache", "--threads", "2"]);
    assert_eq!(several["outcome"], "symmetric");
    let seeds: Vec<u64> =
        several["replicates"].as_array().unwrap().iter().map(|r| r["seed"].as_u64().unwrap()).collect();
    assert_eq!(seeds, [7, 8, 9]);
    assert!(several["chi_sd"].as_f64().unwrap() < 0.005);
}

#[test]
fn divide_frames() {
    let folder = tempfile::tempdir().unwrap();
    let frames = folder.path().join("frames");
    let output = furrow(HERE, &["divide", "--r0", "2.5", "--no-cache", "--frames", frames.to_str().unwrap()]);
    assert!(output.status.success());
    let index: Value = serde_json::from_str(&std::fs::read_to_string(frames.join("frames.json")).unwrap()).unwrap();
    let entries = index.as_array().unwrap();
    assert!(entries.len() > 10);
    let last = entries.last().unwrap();
    // Pinch-off is at a thousandth of R0.
    assert!(last["neck_radius"].as_f64().unwrap() < 2.6e-3);
    let contour = std::fs::read_to_string(frames.join(last["file"].as_str().unwrap())).unwrap();
    let row = |line: &str| line.split(',').map(|x| x.parse::<f64>().unwrap()).collect::<Vec<f64>>();
    let rows: Vec<Vec<f64>> = contour.lines().skip(1).map(row).collect();
    let (first, last) = (&rows[0], &rows[rows.len() - 1]);
    assert_eq!((first[0], last[0]), (0.0, 1.0));
    assert!(first[1].abs() < 1e-9 && last[1].abs() < 1e-9 && first[2] > 0.0 && last[2] < 0.0);
}

/// A shallow lineage of the built-in founders' shape, to keep the test short.
fn shallow(folder: &Path) -> String {
    let text = furrow::lineage::C_ELEGANS.replace("max_depth: 200", "max_depth: 3");
    assert!(text.contains("max_depth: 3"));
    write(folder, "shallow.ron", &text)
}

#[test]
fn tree_writes_the_same_files_cold_warm_and_on_more_threads() {
    let folder = tempfile::tempdir().unwrap();
    let lineage = shallow(folder.path());
    let cache = folder.path().join("store");
    let grow = |name: &str, threads: &str, cached: bool| -> (Value, String) {
        let out = folder.path().join(name);
        let mut arguments = vec!["tree", &lineage, "--threads", threads, "--out", out.to_str().unwrap()];
        if cached {
            arguments.extend(["--cache", cache.to_str().unwrap()]);
        } else {
            arguments.push("--no-cache");
        }
        let answer = json(HERE, &arguments);
        for file in ["tree.nwk", "tree.svg", "report.html", "run.json"] {
            assert!(out.join(file).is_file(), "{file}");
        }
        assert_eq!(std::fs::read_dir(&out).unwrap().count(), 5);
        (answer, std::fs::read_to_string(out.join("tree.json")).unwrap())
    };
    let (cold, tree) = grow("cold", "1", true);
    assert_eq!(cold["cells"], 15);
    assert_eq!(cold["divisions_solved"].as_u64().unwrap() + cold["memo_hits"].as_u64().unwrap(), 7);
    assert_eq!(cold["founders"][0]["name"], "P0");
    assert_eq!(cold["founders"][1]["rounds"]["full_doublings"], 2);
    assert_eq!(cold["founders"][1]["sulston"]["terminal"], 487);
    let (warm, again) = grow("warm", "2", true);
    assert_eq!(warm["divisions_solved"], 0);
    assert_eq!(again, tree);
    assert_eq!(grow("two", "2", false).1, tree);
    assert_eq!(furrow::lineage::Tree::from_json(&tree).unwrap().len(), 15);
}

#[test]
fn cache_command() {
    let folder = tempfile::tempdir().unwrap();
    let cache = folder.path().to_str().unwrap();
    assert!(furrow(HERE, &["divide", "--r0", "2.5", "--cache", cache]).status.success());
    let stat = json(HERE, &["cache", "stat", "--cache", cache]);
    assert_eq!((&stat["entries"], &stat["corrupt"]), (&Value::from(1), &Value::from(0)));
    assert!(stat["bytes"].as_u64().unwrap() > 0);
    assert!(furrow(HERE, &["cache", "clear", "--cache", cache]).status.success());
    assert_eq!(json(HERE, &["cache", "stat", "--cache", cache])["entries"], 0);
    let file = write(folder.path(), "file", "");
    assert_eq!(
        refusal(HERE, &["divide", "--r0", "2.5", "--cache", &file]),
        format!("furrow: error: the cache {file} is not a folder\n")
    );
}

#[test]
fn completions() {
    let script = String::from_utf8(furrow(HERE, &["completions", "bash"]).stdout).unwrap();
    assert!(script.contains("--replicates"));
}

/// `tree` takes the cell's options as `divide` does, and what they say counts over the lineage's own radius.
#[test]
fn tree_takes_the_cell_of_its_options() {
    let folder = tempfile::tempdir().unwrap();
    let lineage = "Lineage(name: \"x\", limits: (max_depth: 1), founders: [(name: \"A\", r0: 5.0)])";
    let lineage = write(folder.path(), "l.ron", lineage);
    let out = folder.path().join("out");
    let out = out.to_str().unwrap();
    let cell = ["--r0", "2.5", "--epsilon", "0.8", "--xi", "22"];
    let tree = |more: &[&str]| {
        let answer = json(HERE, &[&["tree", &lineage, "--out", out, "--no-cache"], more].concat());
        let written = std::fs::read_to_string(Path::new(out).join("tree.json")).unwrap();
        (answer, serde_json::from_str::<Value>(&written).unwrap())
    };
    let (answer, file) = tree(&cell);
    assert_eq!(answer["founders"][0]["r0"], 2.5);
    assert_eq!((&file["cell"]["epsilon"], &file["cell"]["xi_s"]), (&Value::from(0.8), &Value::from(22.0)));
    let alone = json(HERE, &[&["divide", "--no-cache"], &cell[..]].concat());
    assert_eq!(file["cells"][0]["t_end"], alone["t_end"]);
    assert_eq!(tree(&[]).0["founders"][0]["r0"], 5.0, "without the option the lineage's radius counts");
    for (option, complaint) in [
        ("--r0=0", "--r0: r0 = 0: must be a finite number above 0, from 1e-6 to 1e6"),
        ("--epsilon=1.5", "--epsilon: epsilon = 1.5: must be above 0 and below 1"),
        ("--xi=nan", "--xi: xi_s = NaN: must be a finite number"),
    ] {
        assert_eq!(refusal(HERE, &["tree", option]), format!("furrow: error: {complaint}\n"));
    }
}
