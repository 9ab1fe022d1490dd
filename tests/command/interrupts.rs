//! What Ctrl-C does.
#![cfg(target_os = "linux")]

use std::fs::{self, File};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use crate::common::command::{command, names};

/// Starts a command, sends it Ctrl-C `wait` milliseconds after it handles the signal and has `threads` threads, and returns its stderr.
/// It must end with exit code 1 and without a file.
fn interrupted(folder: &Path, arguments: &[&str], stderr: Stdio, threads: u64, wait: u64) -> String {
    let mut child = command(folder, arguments).stdout(Stdio::null()).stderr(stderr).spawn().unwrap();
    let listens = |status: String| {
        let number = |field: &str, radix: u32| {
            let value = status.lines().find_map(|line| line.strip_prefix(field)).unwrap_or("0");
            u64::from_str_radix(value.trim(), radix).unwrap_or(0)
        };
        // The second bit is for SIGINT.
        number("SigCgt:", 16) & 2 != 0 && number("Threads:", 10) >= threads
    };
    while !fs::read_to_string(format!("/proc/{}/status", child.id())).is_ok_and(listens) {
        assert!(child.try_wait().unwrap().is_none(), "it ended before it listened");
        std::thread::sleep(Duration::from_millis(1));
    }
    std::thread::sleep(Duration::from_millis(wait));
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(1), "{arguments:?}");
    assert_eq!(names(folder), [""; 0], "{arguments:?}");
    String::from_utf8(output.stderr).unwrap()
}

/// Uncached commands stop immediately. Each would take longer than the test's time limit.
#[test]
fn a_computation() {
    let folder = tempfile::tempdir().unwrap();
    let targets = concat!("calibrate ", env!("CARGO_MANIFEST_DIR"), "/data/thresholds.ron");
    for line in [
        "boundary --vary r0 --from 2 --to 1.7",
        "phase --vary r0 --from 1.5 --to 3 --xi-from 10 --xi-to 30 --no-cache",
        targets,
        "pitchfork --r0 2",
        "branch --r0 2",
        "steady --r0 2",
    ] {
        let arguments: Vec<&str> = line.split(' ').chain(["--set", "intervals=4000"]).collect();
        let said = interrupted(folder.path(), &arguments, Stdio::piped(), 2, 0);
        assert_eq!(said, "furrow: error: interrupted; nothing is kept\n", "{line}");
    }
}

/// Ctrl-C ends work after a division, here a movie of minutes, whether it comes before or after the division
/// is solved. The message names kept divisions if it came before.
#[test]
fn work_after_a_division() {
    for wait in [0, 400] {
        let folder = tempfile::tempdir().unwrap();
        let movie = ["divide", "--r0", "2.5", "--no-cache", "--movie", "long.gif", "--movie-frames", "2000"];
        let said = interrupted(folder.path(), &movie, Stdio::piped(), 2, wait);
        let kept = ["nothing is kept", "solved divisions are kept in the cache (unless --no-cache)"];
        let expected = kept.map(|kept| format!("furrow: error: interrupted; {kept}"));
        let last = said.lines().last().unwrap_or_default();
        assert!(expected.iter().any(|line| line == last), "{said}");
    }
}

/// A tree of some hundreds of divisions, whatever becomes of stderr. Six threads are its own, two for curves, the one that waits for
/// Ctrl-C, and the workers, which begin once there are divisions to finish.
#[test]
fn a_tree() {
    let folder = tempfile::tempdir().unwrap();
    let tree = "tree --no-cache --threads 2 --r0-step 0 --set epsilon=0.5 --set xi=30".split(' ').collect::<Vec<_>>();
    interrupted(folder.path(), &tree, File::options().write(true).open("/dev/full").unwrap().into(), 6, 0);
    let said = interrupted(folder.path(), &tree, Stdio::piped(), 6, 0);
    assert!(
        said.contains("finishing the divisions that have begun") && said.contains("error: interrupted after"),
        "{said}"
    );
}
