//! `furrow sweep` and `furrow merge`: tables, shards, rejected input, and resuming after a kill.

use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::common::command::{command, furrow, json};

fn write(folder: &Path, name: &str, text: &str) {
    fs::write(folder.join(name), text).unwrap();
}

fn table(folder: &Path, out: &str) -> Vec<Vec<String>> {
    let text = fs::read_to_string(folder.join(out).join("results.csv")).unwrap();
    text.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

/// The files of a sweep, as bytes.
fn files(folder: &Path, out: &str) -> [Vec<u8>; 3] {
    ["results.csv", "results.jsonl", "sweep.json"].map(|name| fs::read(folder.join(out).join(name)).unwrap())
}

#[test]
fn divisions_are_those_of_divide_in_the_order_of_the_axes() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(
        at,
        "s.ron",
        r#"Sweep(kind: division, axes: [
        (parameter: "R0", range: (from: 1.5, to: 2.5, count: 3)), (parameter: "eps", list: [0.8, 0.87]),
    ])"#,
    );
    let said = json(at, &["sweep", "s.ron", "--out", "out", "--no-cache"]);
    assert_eq!((&said["points"], &said["solved"], &said["reused"]), (&6.into(), &6.into(), &0.into()));
    let rows = table(at, "out");
    assert_eq!(rows[0], ["R0", "eps", "outcome", "chi", "u_furrow", "t_end"]);
    let axes: Vec<[&str; 2]> = rows[1..].iter().map(|row| [row[0].as_str(), row[1].as_str()]).collect();
    assert_eq!(axes, [["1.5", "0.8"], ["1.5", "0.87"], ["2", "0.8"], ["2", "0.87"], ["2.5", "0.8"], ["2.5", "0.87"]]);
    assert_eq!(rows[2][2..5], ["failed", "", ""], "{:?}", rows[2]);
    let single = json(at, &["divide", "--r0", "2", "--epsilon", "0.87", "--no-cache"]);
    assert_eq!(rows[4][2], single["outcome"].as_str().unwrap());
    for (cell, name) in rows[4][3..].iter().zip(["chi", "u_furrow", "t_end"]) {
        assert_eq!(cell.parse::<f64>().unwrap(), single[name].as_f64().unwrap(), "{name}");
    }
    let lines = fs::read_to_string(at.join("out/results.jsonl")).unwrap();
    let fourth: Value = serde_json::from_str(lines.lines().nth(3).unwrap()).unwrap();
    assert_eq!((&fourth["index"], &fourth["R0"], &fourth["chi"]), (&3.into(), &2.0.into(), &single["chi"]));
}

#[test]
fn replicates_give_counts_and_equal_inputs_are_solved_once() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(
        at,
        "s.ron",
        r#"Sweep(kind: division, replicates: 3, seed: 7,
        axes: [(parameter: "r0", list: [2.1, 1.5, 2.1]), (parameter: "scheme", list: ["converged"])])"#,
    );
    let said = json(at, &["sweep", "s.ron", "--out", "out", "--no-cache"]);
    assert_eq!((&said["points"], &said["solved"], &said["reused"]), (&3.into(), &6.into(), &3.into()));
    let rows = table(at, "out");
    assert_eq!(rows[0], ["r0", "scheme", "symmetric", "asymmetric", "failed", "chi_mean", "chi_sd"]);
    assert_eq!(rows[2], ["1.5", "converged", "0", "0", "3", "", ""]);
    assert_eq!(rows[1], rows[3]);
    let single = json(at, &["divide", "--r0", "2.1", "--seed", "7", "--replicates", "3", "--no-cache"]);
    assert_eq!(rows[1][2..5], ["0", "3", "0"]);
    assert_eq!(rows[1][5].parse::<f64>().unwrap(), single["chi_mean"].as_f64().unwrap());
    assert_eq!(rows[1][6].parse::<f64>().unwrap(), single["chi_sd"].as_f64().unwrap());
}

#[test]
fn pitchforks_and_critical_radii_are_those_of_their_commands() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(
        at,
        "p.ron",
        r#"Sweep(kind: pitchfork, axes: [
        (parameter: "r0", list: [2, 2.0, 1.64]), (parameter: "cue", list: ["none", "germline"])])"#,
    );
    let said = json(at, &["sweep", "p.ron", "--out", "p", "--no-cache"]);
    assert_eq!((&said["points"], &said["solved"], &said["reused"]), (&6.into(), &4.into(), &2.into()));
    let rows = table(at, "p");
    assert_eq!(rows[0], ["r0", "cue", "xi_s", "criticality", "coefficient", "H"]);
    let single = json(at, &["pitchfork", "--r0", "2"]);
    assert_eq!(rows[1][2].parse::<f64>().unwrap(), single["xi_s"].as_f64().unwrap());
    assert_eq!((rows[1][3].as_str(), rows[5][3].as_str()), ("supercritical", "subcritical"));
    // A cue that breaks the symmetry leaves no pitchfork, which is an answer.
    assert_eq!(rows[2][2..], ["", "none", "", ""]);
    write(at, "c.ron", r#"Sweep(kind: critical, axes: [(parameter: "cue", list: ["none", "germline"])])"#);
    json(at, &["sweep", "c.ron", "--out", "c", "--no-cache"]);
    let rows = table(at, "c");
    assert_eq!(rows[0], ["cue", "r0_c", "kind"]);
    assert!((rows[1][1].parse::<f64>().unwrap() - 1.706_324_8).abs() < 1e-6);
    assert_eq!((rows[1][2].as_str(), rows[2][2].as_str()), ("pitchfork", "cued_fold"));
}

#[test]
fn trees_have_the_founders_counts_of_the_tree_itself() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::create_dir(at.join("animals")).unwrap();
    let lineage = r#"Lineage(name: "x", founders: [(name: "S", r0: 9.0),
        (name: "L", mother: "S", daughter: larger), (name: "M", mother: "S", daughter: smaller)])"#;
    write(at, "animals/x.ron", lineage);
    write(at, "animals/s.ron", r#"Sweep(kind: tree, lineage: "x.ron", axes: [(parameter: "r0", list: [1.5, 2.5])])"#);
    json(at, &["sweep", "animals/s.ron", "--out", "out", "--no-cache"]);
    let rows = table(at, "out");
    assert_eq!(rows[0][..5], ["r0", "cells", "S_min", "S_mean", "S_max"]);
    assert_eq!(rows[0].len(), 2 + 3 * 6);
    // Too small to divide: its daughters are never born.
    assert_eq!(rows[1][..8], ["1.5", "1", "0", "0", "0", "0", "1", ""]);
    assert!(rows[1][8..].iter().all(String::is_empty));
    let tree = json(at, &["tree", "animals/x.ron", "--r0", "2.5", "--no-cache", "--out", "tree"]);
    assert_eq!(rows[2][1], tree["cells"].to_string());
    for (k, founder) in tree["founders"].as_array().unwrap().iter().enumerate() {
        for (j, name) in ["min", "mean", "max", "full_doublings", "terminal"].iter().enumerate() {
            let expected = founder["rounds"][name].as_f64().unwrap();
            assert_eq!(rows[2][2 + 6 * k + j].parse::<f64>().unwrap(), expected, "{name} of {founder}");
        }
        assert_eq!(rows[2][7 + 6 * k].parse().ok(), founder["chi"].as_f64());
    }
}

/// The points of this one are quick to solve, and some of them alike.
const PARTS: &str = r#"Sweep(kind: division, axes: [
    (parameter: "r0", list: [1.5, 2.6, 1.55, 1.5]), (parameter: "epsilon", sample: (from: 0.8, to: 0.9, count: 5))],
    replicates: 2)"#;

#[test]
fn parts_merge_to_the_bytes_of_the_whole_at_any_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "s.ron", PARTS);
    json(at, &["sweep", "s.ron", "--out", "whole", "--no-cache", "--threads", "1"]);
    let mut sizes = Vec::new();
    for (part, threads) in [("1", "4"), ("2", "1"), ("3", "2")] {
        let (shard, out) = (format!("{part}/3"), format!("part-{part}"));
        let said = json(at, &["sweep", "s.ron", "--out", &out, "--shard", &shard, "--no-cache", "--threads", threads]);
        sizes.push(said["points"].as_u64().unwrap());
    }
    assert_eq!(sizes.iter().sum::<u64>(), 20);
    assert!(sizes.iter().all(|size| *size > 0), "{sizes:?}");
    let said = json(at, &["merge", "part-3", "part-1", "part-2", "--out", "merged"]);
    assert_eq!((&said["points"], &said["solved"], &said["reused"]), (&20.into(), &0.into(), &20.into()));
    assert_eq!(files(at, "merged"), files(at, "whole"));
    // A point stays in its part when others are added.
    let more = PARTS.replace("1.55", "1.55, 1.6").replace("count: 5", "count: 7");
    write(at, "more.ron", &more);
    json(at, &["sweep", "more.ron", "--out", "more-1", "--shard", "1/3", "--no-cache"]);
    let rows = table(at, "more-1");
    assert!(table(at, "part-1").iter().all(|row| rows.contains(row)));
}

/// A tree of one part is not told what another part has searched for: critical radii that are not stored.
#[test]
fn trees_in_parts_are_those_of_the_whole() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "one.ron", r#"Lineage(name: "one", founders: [(name: "S", r0: 4.0)])"#);
    let text = r#"Sweep(kind: tree, lineage: "one.ron", physics: (epsilon: 0.86), axes: [
        (parameter: "r0", list: [1.55, 1.9, 2.05, 2.1]), (parameter: "cue", list: ["none", "kappa:u0=0.46,omega=0.06,amplitude=0.1"])])"#;
    write(at, "s.ron", text);
    json(at, &["sweep", "s.ron", "--out", "whole", "--no-cache", "--threads", "2"]);
    for part in ["1", "2"] {
        let shard = format!("{part}/2");
        let said = json(at, &["sweep", "s.ron", "--out", part, "--shard", &shard, "--no-cache", "--threads", "1"]);
        assert_ne!(said["points"], 0);
    }
    json(at, &["merge", "1", "2", "--out", "merged"]);
    assert_eq!(files(at, "merged"), files(at, "whole"));
    let cells: Vec<usize> = table(at, "whole")[1..].iter().map(|row| row[row.len() - 7].parse().unwrap()).collect();
    assert!(cells[0] == 1 && cells.iter().any(|count| *count > 2), "{cells:?}");
}

#[test]
fn what_does_not_make_a_whole_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let quick = r#"Sweep(kind: division, axes: [(parameter: "r0", list: [1.5, 1.52, 1.54, 1.56, 1.58])])"#;
    write(at, "s.ron", quick);
    write(at, "other.ron", &quick.replace("kind", "seed: 1, kind"));
    for (file, out, shard) in
        [("s.ron", "one", "1/2"), ("s.ron", "two", "2/2"), ("s.ron", "third", "2/3"), ("other.ron", "other", "2/2")]
    {
        json(at, &["sweep", file, "--out", out, "--shard", shard, "--cache", "cache"]);
    }
    json(at, &["sweep", "s.ron", "--out", "whole", "--cache", "cache"]);
    let rows = fs::read_to_string(at.join("two/results.jsonl")).unwrap();
    let part = |name: &str, lines: &str, from: &str, to: &str| {
        fs::create_dir(at.join(name)).unwrap();
        let head = fs::read_to_string(at.join("two/sweep.json")).unwrap();
        assert!(head.contains(from), "{head}");
        write(at, &format!("{name}/sweep.json"), &head.replace(from, to));
        write(at, &format!("{name}/results.jsonl"), lines);
    };
    part("cut", rows.split_inclusive('\n').next().unwrap(), "{", "{");
    part("altered", &rows.replace("failed", "symmetric"), "{", "{");
    part("solver", &rows, "\"solver\": ", "\"solver\": 9");
    part("garbled", &rows.replace("\"r0\":", "\"r1\":"), "{", "{");
    let refused = |folders: &[&str], said: &str| {
        let output = furrow(at, &[&["merge"], folders, &["--out", "m"]].concat());
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{folders:?}: {stderr}");
        assert!(stderr.contains(said), "{folders:?}: {stderr}");
        assert!(!at.join("m").exists(), "{folders:?}");
    };
    refused(&["one"], "parts = 1: must be all 2 of them; missing: 2/2");
    refused(
        &["one", "other"],
        "definition = another one: must be that of one: they differ (sweep.seed = 0 there, 1 now)",
    );
    refused(&["one", "third"], "shard = 2/3: must be one of 2 parts");
    refused(&["one", "solver"], "sweep.solver");
    refused(&["one", "two", "altered"], "row of point = ");
    refused(&["one", "cut"], "results.jsonl: rows = 1: must be");
    refused(&["one", "garbled"], "results.jsonl:1:1: this is no row");
    refused(&["one", "whole"], "it is a whole sweep");
    refused(&["one", "nowhere"], "nowhere/sweep.json: cannot be read");
    let output = furrow(at, &["merge", "one", "two", "--out", "two"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8(output.stderr).unwrap().contains("another folder than those of the parts"));
    // The same part twice says nothing else.
    json(at, &["merge", "one", "two", "one", "--out", "m"]);
    assert_eq!(files(at, "m"), files(at, "whole"));
}

#[test]
fn a_killed_sweep_resumes_from_its_rows_and_the_store() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let text = r#"Sweep(kind: division, axes: [(parameter: "r0", range: (from: 1.8, to: 2.2, count: 60))])"#;
    write(at, "s.ron", text);
    let arguments = ["sweep", "s.ron", "--out", "out", "--cache", "store", "--threads", "1"];
    let entries = || json(at, &["cache", "stat", "--cache", "store"])["entries"].as_u64().unwrap();
    let mut child = command(at, &arguments).stdout(Stdio::null()).spawn().unwrap();
    let start = Instant::now();
    while !at.join("store").exists() || entries() < 5 {
        assert!(child.try_wait().unwrap().is_none(), "it ended before it was killed");
        assert!(start.elapsed() < Duration::from_secs(120), "nothing is kept");
        std::thread::sleep(Duration::from_millis(5));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let kept = entries();
    assert!((5..60).contains(&kept), "{kept}");
    assert!(!at.join("out/results.csv").exists());
    let said = json(at, &arguments);
    let [solved, reused, resumed] = ["solved", "reused", "resumed"].map(|name| said[name].as_u64().unwrap());
    assert!(resumed > 0 && solved <= 60 - kept && solved + reused + resumed == 60, "{kept}: {said}");
    json(at, &["sweep", "s.ron", "--out", "at-once", "--no-cache"]);
    assert_eq!(files(at, "out"), files(at, "at-once"));
}

/// Starts a sweep, kills it as soon as it has finished another row, and so on; then lets it end. Without a cache, so that only
/// the finished rows tell what was done.
fn resumes_after_kills(text: &str, points: u64) {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "one.ron", r#"Lineage(name: "one", founders: [(name: "S", r0: 4.0)], limits: (max_depth: 2))"#);
    write(at, "s.ron", text);
    let arguments = ["sweep", "s.ron", "--out", "out", "--no-cache", "--threads", "1"];
    let journal = at.join("out/results.partial.jsonl");
    let rows = || fs::read_to_string(&journal).map_or(0, |text| text.matches('\n').count().saturating_sub(1));
    for kill in 1..=3 {
        let before = rows();
        let mut child = command(at, &arguments).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        let start = Instant::now();
        while rows() <= before {
            assert!(child.try_wait().unwrap().is_none(), "{text}: it ended before kill {kill}");
            assert!(start.elapsed() < Duration::from_secs(120), "{text}: no row is kept");
            std::thread::sleep(Duration::from_millis(1));
        }
        child.kill().unwrap();
        child.wait().unwrap();
        assert!(!at.join("out/results.csv").exists());
        // A kill in mid-write.
        let kept = fs::read_to_string(&journal).unwrap();
        let whole = kept.rfind('\n').map_or(0, |last| last + 1);
        fs::write(&journal, format!("{}{{\"index\":0,\"r", &kept[..whole])).unwrap();
    }
    let kept = rows() as u64;
    assert!((3..points).contains(&kept), "{text}: {kept}");
    let said = json(at, &arguments);
    assert_eq!((&said["points"], &said["resumed"]), (&points.into(), &kept.into()), "{text}");
    if !text.contains("tree") {
        assert_eq!(said["solved"], points - kept, "{text}");
    }
    assert!(!journal.exists());
    json(at, &["sweep", "s.ron", "--out", "at-once", "--no-cache"]);
    assert_eq!(files(at, "out"), files(at, "at-once"), "{text}");
}

#[test]
fn killed_sweeps_of_divisions_resume_without_a_cache() {
    resumes_after_kills(
        r#"Sweep(kind: division, axes: [(parameter: "r0", range: (from: 1.8, to: 2.2, count: 30))])"#,
        30,
    );
}

#[test]
fn killed_sweeps_of_pitchforks_resume() {
    resumes_after_kills(
        r#"Sweep(kind: pitchfork, axes: [(parameter: "r0", range: (from: 1.7, to: 2.3, count: 16))])"#,
        16,
    );
}

#[test]
fn killed_sweeps_of_critical_radii_resume() {
    resumes_after_kills(
        r#"Sweep(kind: critical, axes: [(parameter: "epsilon", range: (from: 0.8, to: 0.88, count: 9))])"#,
        9,
    );
}

#[test]
fn killed_sweeps_of_trees_resume() {
    resumes_after_kills(
        r#"Sweep(kind: tree, lineage: "one.ron", axes: [(parameter: "r0", range: (from: 1.5, to: 2.6, count: 9))])"#,
        9,
    );
}

#[test]
fn finished_rows_of_another_sweep_are_not_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "s.ron", r#"Sweep(kind: division, axes: [(parameter: "r0", list: [1.5])])"#);
    fs::create_dir(at.join("out")).unwrap();
    write(at, "out/results.partial.jsonl", "{\"kind\":\"tree\"}\n");
    let output = furrow(at, &["sweep", "s.ron", "--out", "out", "--no-cache"]);
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.code() == Some(1) && stderr.contains("finished rows of another sweep"), "{stderr}");
    assert_eq!(fs::read(at.join("out/results.partial.jsonl")).unwrap(), b"{\"kind\":\"tree\"}\n");
}

#[test]
fn a_point_that_cannot_be_computed_is_a_row() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(
        at,
        "s.ron",
        r#"Sweep(kind: division, physics: (r0: 1.5),
        axes: [(parameter: "gain", list: [0.5, 4]), (parameter: "xi", list: [1, 25])])"#,
    );
    let output = furrow(at, &["sweep", "s.ron", "--out", "out", "--no-cache"]);
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{stderr}");
    assert_eq!(stderr.matches("WARN").count(), 1, "{stderr}");
    assert!(stderr.contains("1 of 4 points are undecided") && stderr.contains("index 3: s.ron: xi_s = 25"), "{stderr}");
    let rows = table(at, "out");
    assert_eq!(rows[4], ["4", "25", "undecided", "", "", ""]);
    assert!(rows[1..4].iter().all(|row| row[2] != "undecided"));
    let lines = fs::read_to_string(at.join("out/results.jsonl")).unwrap();
    assert!(lines.lines().last().unwrap().contains("\"why\":\"s.ron: xi_s = 25: must be from"), "{lines}");
}

#[test]
fn what_is_wrong_with_a_file_is_named_with_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let axis = |axis: &str| format!("Sweep(kind: division, axes: [{axis}])");
    let r0 = r#"(parameter: "r0", list: [2])"#;
    for (text, said) in [
        (String::new(), "s.ron: is not a sweep file: it is empty, and a sweep file is RON that begins with Sweep("),
        (r"Sweep(kind: divison, axes: [])".into(), "s.ron:1:13: kind: unknown name \"divison\""),
        (r"Sweep(kind: division, axis: [])".into(), "did you mean axes?"),
        (axis(r#"(parameter: "epsilom", list: [2])"#), "axes[0].parameter = \"epsilom\": must be one of kappa,"),
        (axis(r#"(parameter: "epsilom", list: [2])"#), "; did you mean epsilon?"),
        (
            axis(r#"(parameter: "epsilon", list: [0.8, 1.2])"#),
            "axes[0].list[1] (epsilon) = 1.2: must be above 0 and below 1",
        ),
        (axis(r#"(parameter: "eps", range: (from: 0.8, to: 1.2, count: 3))"#), "axes[0].range (epsilon) = 1: must be"),
        (axis(r#"(parameter: "r0", range: (from: 1, to: inf, count: 3))"#), "axes[0].range.to = inf: must be a finite"),
        (axis(r#"(parameter: "r0", range: (from: 1, to: 2, count: 0))"#), "axes[0].range.count = 0: must be a whole"),
        (axis(r#"(parameter: "r0", list: [])"#), "axes[0].list = []: must be a list of one value at least"),
        (axis(r#"(parameter: "r0", list: ["2"])"#), "axes[0].list[0] (r0) = \"2\": must be a number without quotes"),
        (axis(r#"(parameter: "intervals", list: [47])"#), "(intervals) = 47: must be an even whole number"),
        (axis(r#"(parameter: "intervals", list: [48.5])"#), "(intervals) = 48.5: must be an even whole number"),
        (
            axis(r#"(parameter: "scheme", list: ["publishd"])"#),
            "(scheme) = \"publishd\": must be converged or published",
        ),
        (axis(r#"(parameter: "r0")"#), "axes[0] = \"r0\": must be given with one of range, list, sample"),
        (
            axis(&format!(r#"{r0}, (parameter: "R0", list: [3])"#)),
            "axes[1].parameter = \"R0\": must be a parameter of one axis",
        ),
        (axis(r#"(parameter: "cue", list: ["germlin"])"#), "axes[0].list[0] = \"germlin\": must be none, germline,"),
        (axis(r#"(parameter: "cue", list: [1])"#), "axes[0].list[0] = 1: must be a cue in quotes"),
        (
            axis(r#"(parameter: "cue.u0", list: [0.4])"#),
            "axes[0].parameter = \"cue.u0\": must be a number of a cue, and none",
        ),
        (
            r#"Sweep(kind: division, cue: "germline", axes: [(parameter: "cue.u0", list: [1.4])])"#.into(),
            "axes[0]: kappa.u0 = 1.4: must be",
        ),
        (r#"Sweep(kind: tree, replicates: 2, axes: [])"#.into(), "replicates = 2: must be 1, or of divisions more"),
        (
            r#"Sweep(kind: pitchfork, axes: [(parameter: "xi", list: [1])])"#.into(),
            "must be another parameter: pitchforks",
        ),
        (
            r#"Sweep(kind: critical, axes: [(parameter: "r0", list: [1])])"#.into(),
            "must be another parameter: critical",
        ),
        (
            axis(
                r#"(parameter: "r0", sample: (from: 1, to: 2, count: 9)), (parameter: "eps", sample: (from: 0.8, to: 0.9, count: 8))"#,
            ),
            "axes[1].sample.count = 8: must be 9, the count of axes[0]",
        ),
        (
            axis(
                r#"(parameter: "r0", range: (from: 1, to: 2, count: 9999)), (parameter: "eps", range: (from: 0.8, to: 0.9, count: 9999))"#,
            ),
            "axes = 9999 × 9999: must be axes that span",
        ),
        (
            r#"Sweep(kind: division, numerics: (dt: 0.05), axes: [])"#.into(),
            "s.ron: numerics.dt = 0.05: must be given with",
        ),
        (
            r#"Sweep(kind: division, physics: (epsilon: 2), axes: [])"#.into(),
            "s.ron: physics.epsilon = 2: must be above 0",
        ),
        (r#"Sweep(kind: tree, lineage: "no.ron", axes: [])"#.into(), "no.ron: cannot be read"),
    ] {
        write(at, "s.ron", &text);
        let output = furrow(at, &["sweep", "s.ron", "--out", "out", "--no-cache"]);
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{text}: {stderr}");
        assert!(stderr.contains(said), "{text}:\n{stderr}\n{said}");
        assert!(!at.join("out").exists());
    }
    write(at, "s.ron", &axis(r0));
    for shard in ["0/2", "3/2", "x", "1/0"] {
        let output = furrow(at, &["sweep", "s.ron", "--out", "out", "--shard", shard]);
        assert_eq!(output.status.code(), Some(2), "{shard}");
        assert!(String::from_utf8(output.stderr).unwrap().contains("must be K/N with 1 ≤ K ≤ N"), "{shard}");
    }
    // A scheme that only an axis gives is no reason to refuse its step.
    write(
        at,
        "s.ron",
        r#"Sweep(kind: division, numerics: (dt: 0.05),
        axes: [(parameter: "scheme", list: ["published"]), (parameter: "r0", list: [1.5])])"#,
    );
    json(at, &["sweep", "s.ron", "--out", "out", "--no-cache"]);
}

#[test]
fn settings_of_the_command_line_come_after_the_file_and_before_the_axes() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "c.ron", "Config(physics: (aspect: 1.3, epsilon: 0.8, w: 0.15))");
    write(
        at,
        "s.ron",
        r#"Sweep(kind: pitchfork, physics: (epsilon: 0.86, aspect: 1.45), axes: [(parameter: "r0", list: [2])])"#,
    );
    json(
        at,
        &["sweep", "s.ron", "--out", "out", "--no-cache", "--config", "c.ron", "--set", "aspect=1.4", "--set", "r0=3"],
    );
    let cell = |name: &str| serde_json::from_slice::<Value>(&files(at, name)[2]).unwrap()["cell"].clone();
    let shell = &cell("out")["shell"];
    assert_eq!((&cell("out")["epsilon"], &shell["aspect"], &shell["w"]), (&0.86.into(), &1.4.into(), &0.15.into()));
    let single = ["pitchfork", "--r0", "2", "--epsilon", "0.86", "--set", "aspect=1.4", "--set", "w=0.15"];
    let expected = json(at, &single)["xi_s"].as_f64().unwrap();
    assert_eq!(table(at, "out")[1][1].parse::<f64>().unwrap(), expected);
}

#[test]
fn the_studies_that_ship_are_sound() {
    let studies = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies");
    let folder = tempfile::tempdir().unwrap();
    let mut seen = 0;
    for entry in fs::read_dir(studies).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            // Those far from the paper, which not every cell of has an outcome: docs/robustness.md.
            continue;
        }
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.starts_with("// Fig") && text.contains("// Expect: "), "{}", path.display());
        let name = path.file_stem().unwrap().to_str().unwrap();
        let said =
            json(folder.path(), &["sweep", path.to_str().unwrap(), "--out", name, "--shard", "1/30", "--no-cache"]);
        assert_eq!(said["undecided"], 0, "{name}");
        seen += 1;
    }
    assert_eq!(seen, 5);
}
