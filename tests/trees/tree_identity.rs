//! The built-in tree is byte-identical with and without a cache, on any number of threads, interrupted and resumed or not.
#![cfg(unix)]

use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::common::command::command;

fn start(folder: &Path, name: &str, threads: &str, cache: Option<&str>) -> Child {
    let mut command = command(folder, &["tree", "--json", "--threads", threads, "--out", name]);
    match cache {
        Some(cache) => command.args(["--cache", cache]),
        None => command.arg("--no-cache"),
    };
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

fn files(folder: &Path, name: &str) -> [Vec<u8>; 2] {
    ["tree.json", "tree.nwk"].map(|file| std::fs::read(folder.join(name).join(file)).unwrap())
}

fn finished(output: &Output) -> Value {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn grow(folder: &Path, name: &str, threads: &str, cache: Option<&str>) -> (Value, [Vec<u8>; 2]) {
    let answer = finished(&start(folder, name, threads, cache).wait_with_output().unwrap());
    (answer, files(folder, name))
}

/// Whether a division is in the cache.
fn stored(folder: &Path, cache: &str) -> bool {
    folder.join(cache).join("furrow.sqlite-wal").metadata().is_ok_and(|log| log.len() > 0)
}

#[test]
fn tree_is_the_same_file_every_time() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let (cold, tree) = grow(folder, "cold", "1", Some("one"));
    let solved = cold["divisions_solved"].as_u64().unwrap();
    assert!(solved > 20, "{cold}");
    let (warm, again) = grow(folder, "warm", "8", Some("one"));
    assert_eq!(warm["divisions_solved"], 0);
    assert!(again == tree, "warm differs from cold");
    let (_, two) = grow(folder, "two", "2", None);
    assert!(two == tree, "two threads differ from one");

    // Eight threads, stopped once something is stored. A machine fast enough to finish first is given another go.
    for attempt in 0..5 {
        let cache = format!("stopped {attempt}");
        let mut child = start(folder, "resumed", "8", Some(&cache));
        let began = Instant::now();
        while !stored(folder, &cache) && child.try_wait().unwrap().is_none() {
            assert!(began.elapsed() < Duration::from_secs(300), "nothing is ever stored");
            std::thread::sleep(Duration::from_millis(2));
        }
        let signal = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
        let output = child.wait_with_output().unwrap();
        if output.status.success() {
            continue;
        }
        assert!(signal.unwrap().success());
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{stderr}");
        assert!(stderr.contains("interrupted after"), "{stderr}");
        assert!(output.stdout.is_empty() && !folder.join("resumed").exists(), "a stopped run leaves no answer");
        let (resumed, same) = grow(folder, "resumed", "8", Some(&cache));
        let rest = resumed["divisions_solved"].as_u64().unwrap();
        assert!(0 < rest && rest < solved, "{rest} of {solved} left after: {stderr}");
        assert!(same == tree, "interrupted and resumed differs from uninterrupted");
        return;
    }
    panic!("the tree was always grown before it could be interrupted");
}
