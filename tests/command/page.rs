//! The interactive page and its WebAssembly module give the results of the command line.
//!
//! The tests need Node, and two need Chromium (`FURROW_CHROMIUM` names one), so they are ignored; `.ci/run` runs them if the programs
//! are there. `FURROW_SCREENSHOTS` names a folder for pictures of the pages, `FURROW_LARGE_REPORT` a report of many cells: a test then
//! measures how long it takes to open.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::{Value, json};

use crate::common::command::{self, answer};

/// The preset's first cell, as far as a test must repeat it.
const P0: [&str; 4] = ["--r0", "5.4", "--cue", "germline"];

fn told(folder: &Path, arguments: &[&str]) -> Value {
    command::json(folder, &[arguments, &["--cache", "cache"]].concat())
}

/// The first of some programs that starts.
fn program(candidates: impl IntoIterator<Item = String>) -> Option<String> {
    candidates.into_iter().find(|name| Command::new(name).arg("--version").output().is_ok_and(|o| o.status.success()))
}

fn chromium() -> String {
    let named = std::env::var("FURROW_CHROMIUM").ok();
    let usual = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"].map(str::to_owned);
    program(named.into_iter().chain(usual)).expect("Chromium, which FURROW_CHROMIUM may name")
}

/// The command line's error for a zygote that it refuses.
fn refusal(folder: &Path, arguments: &[&str]) -> String {
    let output = command::furrow(folder, &[&["divide", "--r0", "5.4"], arguments].concat());
    assert_eq!(output.status.code(), Some(2));
    String::from_utf8(output.stderr).unwrap().trim().trim_start_matches("furrow: error: ").to_owned()
}

/// The settings saved in the page give the page's results.
fn saved_settings_divide(folder: &Path, sliders: &Value) {
    let found = told(folder, &[&["divide", "--config", "saves/furrow.ron"][..], &P0].concat());
    assert_eq!((&found["outcome"], &found["chi"]), (&sliders["outcome"], &sliders["chi"]));
    let tree = told(folder, &["tree", "--config", "saves/tree.ron", "--out", "again"]);
    let first = std::fs::read(folder.join("out/tree.json")).unwrap();
    assert_eq!(std::fs::read(folder.join("again/tree.json")).unwrap(), first, "{tree}");
    // What was saved as tree.json is read as one.
    answer(folder, &["export", "saves/tree.json", "--to", "newick"]);
}

/// A page of a lineage with a clock, and when its cell E is born.
fn timed(folder: &Path) -> Value {
    let lineage = "(base: \"c_elegans\", clock: (lifetime_min: 15, exponent: 0.3))";
    std::fs::write(folder.join("timed.ron"), lineage).unwrap();
    answer(folder, &["tree", "timed.ron", "--out", "timed", "--cache", "cache"]);
    let tree: Value = serde_json::from_slice(&std::fs::read(folder.join("timed/tree.json")).unwrap()).unwrap();
    let born = tree["cells"].as_array().unwrap().iter().find(|cell| cell["name"] == "E").unwrap()["birth_min"].clone();
    json!({ "page": folder.join("timed/report.html"), "born": born })
}

/// The results that the page must show, from the command line.
fn expected(folder: &Path) -> Value {
    answer(folder, &["tree", "--out", "out", "--cache", "cache"]);
    answer(folder, &["explore", "--out", "explore.html"]);
    let tree: Value = serde_json::from_slice(&std::fs::read(folder.join("out/tree.json")).unwrap()).unwrap();
    let slider = |epsilon: f64| {
        let found = told(folder, &[&["divide", "--epsilon", &epsilon.to_string()][..], &P0].concat());
        json!({ "epsilon": epsilon, "outcome": found["outcome"], "chi": found["chi"] })
    };
    let sliders = [slider(0.9), slider(0.93)];
    assert_ne!(sliders[0]["outcome"], sliders[1]["outcome"]);
    let p0 = &tree["cells"][0];
    let carried = "regulator:step,u0=0.45,omega=0.1,amplitude=1,turnover=5,diffusion=1,activity=0.3";
    let regulated = told(folder, &["divide", "--r0", "5.4", "--cue", carried]);
    let cues = ["germline", "none", "my tension=tension:gradient,amplitude=0.3"].map(|cue| ["--cue", cue]).concat();
    let scenarios = told(folder, &[&["tree", "--out", "several"], &cues[..]].concat());
    let of =
        |field: &str| scenarios["scenarios"].as_array().unwrap().iter().map(|s| s[field].clone()).collect::<Vec<_>>();
    json!({
        "scenarios": { "page": folder.join("several/report.html"), "names": of("name"), "cells": of("cells") },
        // Quantity of the sliders, a refused value, an allowed value, and the command line's words.
        "refusals": [
            ("xi_s", 200, 25, refusal(folder, &["--xi", "200"])),
            ("u0", 3, 0.465, refusal(folder, &["--cue", "kappa:u0=3,omega=0.0577,amplitude=0.1"])),
            ("epsilon", 1.5, 0.87, refusal(folder, &["--epsilon", "1.5"])),
        ],
        "regulator": {
            "cue": carried, "outcome": regulated["outcome"], "chi": regulated["chi"], "phi": regulated["phi"],
        },
        "saves": folder.join("saves"),
        "newick": std::fs::read_to_string(folder.join("out/tree.nwk")).unwrap(),
        "cells": tree["cells"].as_array().unwrap().len(),
        "timed": timed(folder),
        "report": folder.join("out/report.html"),
        "explorer": folder.join("explore.html"),
        "large": std::env::var("FURROW_LARGE_REPORT").ok(),
        "p0": { "outcome": p0["outcome"], "chi": p0["chi"] },
        "sliders": sliders,
        "none": told(folder, &["tree", "--cue", "none", "--out", "none"]),
    })
}

/// Runs a script of `tests/browser/` and prints its measures.
fn run_script(script: &str, arguments: &[PathBuf]) {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/browser").join(script);
    let output = Command::new("node").arg(script).args(arguments).output().expect("Node starts");
    println!("{}", String::from_utf8_lossy(&output.stdout));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
#[ignore = "needs Node"]
fn the_module_divides_and_grows_as_the_command_line_does() {
    let folder = tempfile::tempdir().unwrap();
    let module = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates/furrow-report/src/page/furrow.wasm.txt");
    // The second has a founder with physics of its own, µm, and cues by rules; the third a regulator.
    let carried = "--cue=regulator:step,u0=0.45,omega=0.1,amplitude=1,turnover=5,diffusion=1,activity=0.3";
    for (lineage, more) in [("c_elegans", "--quiet"), ("template", "--quiet"), ("c_elegans", carried)] {
        let lineage = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("lineages/{lineage}.ron"));
        answer(folder.path(), &["tree", &lineage.display().to_string(), "--cache", "cache", more]);
        run_script("module.mjs", &[module.clone(), folder.path().join("furrow-out/tree.json")]);
    }
}

/// Runs a script that drives Chromium and compares the page with the expected results.
fn drive(script: &str, folder: &Path, expected: &Value) {
    let file = folder.join("expected.json");
    std::fs::write(&file, expected.to_string()).unwrap();
    let mut arguments = vec![PathBuf::from(chromium()), file];
    if let Some(shots) = std::env::var_os("FURROW_SCREENSHOTS").map(PathBuf::from) {
        std::fs::create_dir_all(&shots).unwrap();
        arguments.push(shots);
    }
    run_script(script, &arguments);
}

#[test]
#[ignore = "needs Node and Chromium"]
fn the_page_says_what_the_command_line_says() {
    let folder = tempfile::tempdir().unwrap();
    let expected = expected(folder.path());
    drive("report.mjs", folder.path(), &expected);
    saved_settings_divide(folder.path(), &expected["sliders"][0]);
}

/// Whatever is shown: folded, in minutes, grown anew, in µm, at any ε, on dark ground, on a telephone.
#[test]
#[ignore = "needs Node and Chromium"]
fn every_figure_of_the_page_follows() {
    let temporary = tempfile::tempdir().unwrap();
    let folder = temporary.path();
    let template = Path::new(env!("CARGO_MANIFEST_DIR")).join("lineages/template.ron").display().to_string();
    let template = template.as_str();
    for arguments in [["--out", "out"].as_slice(), &["--cue", "none", "--out", "none"], &[template, "--out", "um"]] {
        answer(folder, &[&["tree", "--cache", "cache"], arguments].concat());
    }
    let tree: Value = serde_json::from_slice(&std::fs::read(folder.join("out/tree.json")).unwrap()).unwrap();
    let mut generations: Vec<u32> = Vec::new();
    for cell in tree["cells"].as_array().unwrap() {
        let generation = cell["generation"].as_u64().unwrap() as usize;
        generations.resize(generations.len().max(generation + 1), 0);
        generations[generation] += 1;
    }
    let report = |of: &str| folder.join(of).join("report.html");
    let p0 = json!({ "outcome": tree["cells"][0]["outcome"], "chi": tree["cells"][0]["chi"] });
    let expected = json!({
        "report": report("out"), "none": report("none"), "micrometres": report("um"),
        "generations": generations, "p0": p0, "founders": tree["founders"],
    });
    drive("figures.mjs", folder, &expected);
}

/// A cell that bends, in a film that is turned and played.
#[test]
#[ignore = "needs Node and Chromium"]
fn a_film_turns_and_tells_the_numbers_of_the_division() {
    let folder = tempfile::tempdir().unwrap();
    let cell = ["divide", "--r0", "2", "--three-dimensional", "--modes", "2", "--set", "elements=32"];
    let film = ["--movie", "film.html", "--movie-frames", "12"];
    let found = told(folder.path(), &[&cell[..], &film].concat());
    drive("film.mjs", folder.path(), &json!({ "film": folder.path().join("film.html"), "found": found }));
}
