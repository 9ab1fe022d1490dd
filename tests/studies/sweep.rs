//! Killed sweeps resume from their finished rows and from the store. Other tests of sweeps: `tests/command/sessions/sweeps.txt`.

use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};

use crate::common::command::{command, json};

/// The files of a sweep, as bytes.
fn files(folder: &Path, out: &str) -> [Vec<u8>; 3] {
    ["results.csv", "results.jsonl", "sweep.json"].map(|name| fs::read(folder.join(out).join(name)).unwrap())
}

/// Starts a command and kills it once something is kept.
fn kill_once(folder: &Path, arguments: &[&str], mut is_kept: impl FnMut() -> bool) {
    let mut child = command(folder, arguments).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let start = Instant::now();
    while !is_kept() {
        assert!(child.try_wait().unwrap().is_none(), "{arguments:?}: it ended before it was killed");
        assert!(start.elapsed() < Duration::from_secs(120), "{arguments:?}: nothing is kept");
        std::thread::sleep(Duration::from_millis(1));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(!folder.join("out/results.csv").exists());
}

#[test]
fn a_killed_sweep_resumes_from_its_rows_and_the_store() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let text = r#"Sweep(kind: division, axes: [(parameter: "r0", range: (from: 1.8, to: 2.2, count: 60))])"#;
    fs::write(at.join("s.ron"), text).unwrap();
    let arguments = ["sweep", "s.ron", "--out", "out", "--cache", "store", "--threads", "1"];
    let entries = || json(at, &["cache", "stat", "--cache", "store"])["entries"].as_u64().unwrap();
    kill_once(at, &arguments, || at.join("store").exists() && entries() >= 5);
    let kept = entries();
    assert!((5..60).contains(&kept), "{kept}");
    let said = json(at, &arguments);
    let [solved, reused, resumed] = ["solved", "reused", "resumed"].map(|name| said[name].as_u64().unwrap());
    assert!(resumed > 0 && solved <= 60 - kept && solved + reused + resumed == 60, "{kept}: {said}");
    json(at, &["sweep", "s.ron", "--out", "at-once", "--no-cache"]);
    assert_eq!(files(at, "out"), files(at, "at-once"));
}

/// Starts a sweep over one axis, kills it as soon as it has finished another row, and so on; then lets it end. Without a cache, so
/// that only the finished rows tell what was done.
fn resumes_after_kills(kind: &str, axis: &str, points: u64) {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let lineage = r#"Lineage(name: "one", founders: [(name: "S", r0: 4.0)], limits: (max_depth: 2))"#;
    fs::write(at.join("one.ron"), lineage).unwrap();
    let text = format!("Sweep(kind: {kind}, axes: [(parameter: {axis}, count: {points}))])");
    fs::write(at.join("s.ron"), text).unwrap();
    let arguments = ["sweep", "s.ron", "--out", "out", "--no-cache", "--threads", "1"];
    let journal = at.join("out/results.partial.jsonl");
    let rows = || fs::read_to_string(&journal).map_or(0, |text| text.matches('\n').count().saturating_sub(1) as u64);
    for _ in 0..3 {
        let before = rows();
        kill_once(at, &arguments, || rows() > before);
        // A kill in mid-write.
        let kept = fs::read_to_string(&journal).unwrap();
        let whole = kept.rfind('\n').map_or(0, |last| last + 1);
        fs::write(&journal, format!("{}{{\"index\":0,\"r", &kept[..whole])).unwrap();
    }
    let kept = rows();
    assert!((3..points).contains(&kept), "{kind}: {kept}");
    let said = json(at, &arguments);
    assert_eq!((&said["points"], &said["resumed"]), (&points.into(), &kept.into()), "{kind}");
    assert!(kind.starts_with("tree") || said["solved"] == points - kept, "{kind}: {said}");
    assert!(!journal.exists());
    json(at, &["sweep", "s.ron", "--out", "at-once", "--no-cache"]);
    assert_eq!(files(at, "out"), files(at, "at-once"), "{kind}");
}

#[test]
fn killed_sweeps_resume_without_a_cache() {
    for (kind, axis, points) in [
        ("division", r#""r0", range: (from: 1.8, to: 2.2"#, 30),
        ("pitchfork", r#""r0", range: (from: 1.7, to: 2.3"#, 16),
        ("critical", r#""epsilon", range: (from: 0.8, to: 0.88"#, 9),
        (r#"tree, lineage: "one.ron""#, r#""r0", range: (from: 1.5, to: 2.6"#, 9),
    ] {
        resumes_after_kills(kind, axis, points);
    }
}
