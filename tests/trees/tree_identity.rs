//! A tree that was interrupted and resumed is the same file as one that was not.
#![cfg(unix)]

use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::common::command::{command, json};

const TREE: [&str; 5] = ["tree", "--threads", "8", "--out", "out"];

/// Starts a tree, and waits until a division is in its cache or the tree is grown.
fn start(folder: &Path, cache: &str) -> Child {
    let mut command = command(folder, &[&TREE[..], &["--cache", cache]].concat());
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let (log, began) = (folder.join(cache).join("furrow.sqlite-wal"), Instant::now());
    while !log.metadata().is_ok_and(|log| log.len() > 0) && child.try_wait().unwrap().is_none() {
        assert!(began.elapsed() < Duration::from_secs(300), "nothing is ever stored");
        std::thread::sleep(Duration::from_millis(2));
    }
    child
}

#[test]
fn an_interrupted_tree_is_resumed() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let files = || ["tree.json", "tree.nwk"].map(|file| std::fs::read(at.join("out").join(file)).unwrap());
    let solved = json(at, &[&TREE[..], &["--no-cache"]].concat())["divisions_solved"].as_u64().unwrap();
    let whole = files();
    // A machine fast enough to finish first is given another go.
    for attempt in 0..5 {
        std::fs::remove_dir_all(at.join("out")).unwrap();
        let cache = format!("stopped {attempt}");
        let child = start(at, &cache);
        Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
        let output = child.wait_with_output().unwrap();
        if output.status.success() {
            continue;
        }
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(1) && said.contains("interrupted after"), "{said}");
        assert!(output.stdout.is_empty() && !at.join("out").exists(), "a stopped run leaves no answer");
        let rest = json(at, &[&TREE[..], &["--cache", &cache]].concat())["divisions_solved"].as_u64().unwrap();
        assert!(0 < rest && rest < solved, "{rest} of {solved} left after: {said}");
        assert!(files() == whole, "interrupted and resumed differs from uninterrupted");
        return;
    }
    panic!("the tree was always grown before it could be interrupted");
}
