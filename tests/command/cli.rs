//! JSON keys and files of commands.

use furrow_formats::tree_from_json;
use std::path::Path;

use serde_json::Value;

use crate::common::command::{HERE, answer, json, names};

fn write(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
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
    let seeds: Vec<&Value> = several["replicates"].as_array().unwrap().iter().map(|r| &r["seed"]).collect();
    assert_eq!(seeds, [7, 8, 9]);
    assert!(several["chi_sd"].as_f64().unwrap() < 0.005);
}

/// Three generations of the built-in founders, to keep the test short. That the tree is the same cold, warm and at any number of
/// threads is said of the whole tree, in `tests/trees/tree_identity.rs`.
#[test]
fn tree_answers_and_writes_its_files() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "shallow.ron", "(base: \"c_elegans\", limits: (max_depth: 3))");
    let answer = json(folder.path(), &["tree", "shallow.ron", "--out", "out", "--no-cache"]);
    let out = folder.path().join("out");
    assert_eq!(names(&out), ["report.html", "run.json", "tree.json", "tree.nwk", "tree.svg"]);
    assert_eq!(answer["cells"], 15);
    assert_eq!(answer["divisions_solved"].as_u64().unwrap() + answer["memo_hits"].as_u64().unwrap(), 7);
    assert_eq!(answer["founders"][0]["name"], "P0");
    assert_eq!(answer["founders"][1]["rounds"]["full_doublings"], 2);
    assert_eq!(answer["founders"][1]["sulston"]["terminal"], 487);
    let tree = std::fs::read_to_string(out.join("tree.json")).unwrap();
    assert_eq!(tree_from_json(&tree).unwrap().len(), 15);
}

#[test]
fn cache_command() {
    let folder = tempfile::tempdir().unwrap();
    let cache = folder.path().to_str().unwrap();
    answer(HERE, &["divide", "--r0", "2.5", "--cache", cache]);
    let stat = json(HERE, &["cache", "stat", "--cache", cache]);
    assert_eq!((&stat["entries"], &stat["corrupt"]), (&Value::from(1), &Value::from(0)));
    assert!(stat["bytes"].as_u64().unwrap() > 0);
    answer(HERE, &["cache", "clear", "--cache", cache]);
    assert_eq!(json(HERE, &["cache", "stat", "--cache", cache])["entries"], 0);
}

#[test]
fn completions() {
    assert!(answer(HERE, &["completions", "bash"]).contains("--replicates"));
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
}
