//! Output: full or closed streams, unwritable places, full disks, files of earlier runs, Ctrl-C.

use std::fs::{self, File};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;

fn furrow() -> Command {
    Command::new(env!("CARGO_BIN_EXE_furrow"))
}

fn full() -> Stdio {
    File::options().write(true).open("/dev/full").unwrap().into()
}

/// Runs a command in a folder and returns its exit code and what it says on stderr.
fn run(folder: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    let Output { status, stderr, .. } = furrow().current_dir(folder).args(arguments).output().unwrap();
    (status.code(), String::from_utf8(stderr).unwrap())
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// A lineage of three generations, to keep the tests short.
fn shallow(folder: &Path) {
    let text = furrow_lineage::C_ELEGANS.replace("max_depth: 200", "max_depth: 2");
    assert!(text.contains("max_depth: 2"));
    fs::write(folder.join("shallow.ron"), text).unwrap();
}

const TREE: [&str; 3] = ["tree", "shallow.ron", "--no-cache"];
const TREE_FILES: [&str; 5] = ["report.html", "run.json", "tree.json", "tree.nwk", "tree.svg"];

#[cfg(target_os = "linux")]
#[test]
fn a_full_stderr_changes_no_exit_code() {
    for (arguments, code) in [
        (&["tree", "--set", "xi=bad"][..], 2),
        (&["divide", "--r0", "4", "--set", "t_max=0.1", "--no-cache"], 1),
        (&["no-such-command"], 2),
        (&[], 2),
    ] {
        let status = furrow().args(arguments).stdout(Stdio::null()).stderr(full()).status().unwrap();
        assert_eq!(status.code(), Some(code), "{arguments:?}");
        // A pipe that nobody reads.
        let mut child = furrow().args(arguments).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stderr.take());
        assert_eq!(child.wait().unwrap().code(), Some(code), "{arguments:?}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_warning_to_a_full_stderr_costs_no_file() {
    let folder = tempfile::tempdir().unwrap();
    shallow(folder.path());
    let mut command = furrow();
    // No cache folder can be made, of which the command warns.
    command.current_dir(folder.path()).env("HOME", "/dev/null").env("XDG_CACHE_HOME", "/dev/null/cache");
    command.args(["tree", "shallow.ron"]);
    let told = command.output().unwrap();
    assert!(String::from_utf8(told.stderr).unwrap().contains("going on without storing"));
    let status = command.args(["--out", "full"]).stdout(Stdio::null()).stderr(full()).status().unwrap();
    assert_eq!(status.code(), Some(0));
    assert_eq!(names(&folder.path().join("full")), TREE_FILES);
}

#[cfg(target_os = "linux")]
#[test]
fn an_answer_that_cannot_be_written_is_an_error() {
    for arguments in [&["--help"][..], &["--version"], &["divide", "--help"], &["completions", "bash"]] {
        let output = furrow().args(arguments).stdout(full()).stderr(Stdio::piped()).output().unwrap();
        assert_eq!(output.status.code(), Some(1), "{arguments:?}");
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(said.starts_with("furrow: error: stdout: No space left"), "{said}");
        let both = furrow().args(arguments).stdout(full()).stderr(full()).status().unwrap();
        assert_eq!(both.code(), Some(1), "{arguments:?}");
        let mut child = furrow().args(arguments).stdout(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        assert_eq!(child.wait().unwrap().code(), Some(0), "{arguments:?}");
    }
}

/// A device or a pipe is not replaced by a file of its name.
#[cfg(target_os = "linux")]
#[test]
fn devices_and_pipes_are_not_replaced() {
    use std::os::unix::fs::FileTypeExt;
    let folder = tempfile::tempdir().unwrap();
    assert!(Command::new("mkfifo").arg(folder.path().join("pipe.svg")).status().unwrap().success());
    for option in ["--plot", "--movie"] {
        let (code, said) = run(folder.path(), &["divide", "--r0", "2.5", "--no-cache", option, "pipe.svg"]);
        assert_eq!(code, Some(2), "{said}");
        assert!(said.ends_with("must be a file that can be written (it is a device or a pipe)\n"), "{said}");
    }
    assert!(fs::metadata(folder.path().join("pipe.svg")).unwrap().file_type().is_fifo());
    assert_eq!(names(folder.path()), ["pipe.svg"]);
}

/// Refusals come before the work: each of these computations would fail, with exit code 1.
#[cfg(unix)]
#[test]
fn places_that_cannot_be_written_are_refused_before_the_work() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("file"), "").unwrap();
    fs::create_dir_all(folder.path().join("taken/tree.json")).unwrap();
    fs::create_dir_all(folder.path().join("taken/frames.json")).unwrap();
    let long = "x".repeat(300);
    let before = names(folder.path());
    let fails = ["--set", "t_max=0.1", "--no-cache"];
    for place in ["file", "file/below", long.as_str(), "taken"] {
        for (command, option, field) in
            [(&["tree"][..], "--out", "out"), (&["divide", "--r0", "4"], "--frames", "frames")]
        {
            let (code, said) = run(folder.path(), &[command, &[option, place], &fails].concat());
            assert_eq!(code, Some(2), "{said}");
            let start =
                format!("furrow: error: {option}: {field} = {place:?}: must be a folder that can be written to (");
            assert!(said.starts_with(&start), "{said}");
        }
    }
    for place in ["file/below", "taken", &long] {
        let arguments = ["boundary", "--vary", "r0", "--from", "0.01", "--to", "0.02", "--write", place];
        let (code, said) = run(folder.path(), &arguments);
        assert_eq!(code, Some(2), "{said}");
        assert!(said.starts_with(&format!("furrow: error: --write: write = {place:?}: must be a file")), "{said}");
    }
    // A folder that was made to find out is gone when the work fails.
    let (code, said) = run(folder.path(), &[&["divide", "--r0", "4", "--frames", "new/folder"], &fails[..]].concat());
    assert_eq!(code, Some(1), "{said}");
    assert_eq!(names(folder.path()), before);
}

/// A limit on file size simulates a full disk; the largest file of the set is not the first.
#[cfg(unix)]
#[test]
fn a_full_disk_leaves_all_files_of_a_run_or_none() {
    let folder = tempfile::tempdir().unwrap();
    shallow(folder.path());
    let limited = |arguments: &[&str]| {
        let mut command = Command::new("sh");
        command.args(["-c", r#"ulimit -f 8; exec "$0" "$@""#, env!("CARGO_BIN_EXE_furrow")]);
        let output = command.args(arguments).current_dir(folder.path()).output().unwrap();
        assert_eq!(output.status.code(), Some(1), "{:?}", output.status);
        String::from_utf8(output.stderr).unwrap()
    };
    let said = limited(&[&TREE[..], &["--out", "new"]].concat());
    assert!(said.contains("new/") && said.contains(": cannot be written: File too large"), "{said}");
    assert_eq!(names(&folder.path().join("new")), [""; 0]);
    // What was there is untouched: a tree of the same inputs, whose files the run would replace.
    assert_eq!(run(folder.path(), &[&TREE[..], &["--out", "old"]].concat()).0, Some(0));
    let old = folder.path().join("old");
    let content = || -> Vec<Vec<u8>> { TREE_FILES.iter().map(|name| fs::read(old.join(name)).unwrap()).collect() };
    let before = content();
    limited(&[&TREE[..], &["--out", "old"]].concat());
    assert_eq!(names(&old), TREE_FILES);
    assert!(content() == before);
}

#[test]
fn an_earlier_tree_is_overwritten_and_other_files_stay() {
    let folder = tempfile::tempdir().unwrap();
    shallow(folder.path());
    let out = folder.path().join("furrow-out");
    fs::create_dir(&out).unwrap();
    fs::write(out.join("notes.txt"), "mine").unwrap();
    let tree = |other: &[&str]| {
        assert_eq!(run(folder.path(), &[&TREE[..], other].concat()), (Some(0), String::new()));
        assert_eq!(names(&out), [&["notes.txt"], &TREE_FILES[..]].concat());
        fs::read_to_string(out.join("tree.json")).unwrap()
    };
    let first = tree(&[]);
    assert_ne!(tree(&["--set", "epsilon=0.8"]), first);
    assert_eq!(tree(&[]), first);
    assert_eq!(fs::read_to_string(out.join("notes.txt")).unwrap(), "mine");
}

#[cfg(unix)]
#[test]
fn frames_are_those_of_one_division() {
    let folder = tempfile::tempdir().unwrap();
    let frames = folder.path().join("frames");
    let divide = |r0: &str, factor: &str| {
        let step = format!("step_factor={factor}");
        let arguments = ["divide", "--r0", r0, "--set", &step, "--no-cache", "--frames", "frames"];
        assert_eq!(run(folder.path(), &arguments), (Some(0), String::new()));
        let index = fs::read_to_string(frames.join("frames.json")).unwrap();
        serde_json::from_str::<serde_json::Value>(&index).unwrap().as_array().unwrap().len()
    };
    let many = divide("3", "0.5");
    let others = ["frame_00001.csv", "frame_9999.csv.bak", "frame_last.csv", "my_frame_9999.csv"];
    for name in others {
        fs::write(frames.join(name), "mine").unwrap();
    }
    let fine = fs::read(frames.join("frame_0005.csv")).unwrap();
    // A division whose files do not fit leaves the earlier one.
    let mut limited = Command::new("sh");
    limited.args(["-c", r#"ulimit -f 2; exec "$0" "$@""#, env!("CARGO_BIN_EXE_furrow")]).current_dir(folder.path());
    let failed = limited.args(["divide", "--r0", "3", "--no-cache", "--frames", "frames"]).output().unwrap();
    assert_eq!(failed.status.code(), Some(1));
    assert_eq!(names(&frames).len(), many + 1 + others.len());
    assert_eq!(fs::read(frames.join("frame_0005.csv")).unwrap(), fine);

    let few = divide("3", "1");
    assert!(few < many, "{few} {many}");
    let mut expected: Vec<String> = (0..few).map(|k| format!("frame_{k:04}.csv")).collect();
    expected.extend(others.iter().chain(&["frames.json"]).map(|&name| name.to_owned()));
    expected.sort();
    assert_eq!(names(&frames), expected);
    assert_ne!(fs::read(frames.join("frame_0005.csv")).unwrap(), fine);
}

/// Starts a command and waits until it listens to Ctrl-C and has so many threads.
#[cfg(target_os = "linux")]
fn listening(command: &mut Command, threads: u64) -> Child {
    let mut child = command.stdout(Stdio::null()).spawn().unwrap();
    let listens = |status: String| {
        let number = |field: &str, radix: u32| {
            let value = status.lines().find_map(|line| line.strip_prefix(field)).unwrap_or("0");
            u64::from_str_radix(value.trim(), radix).unwrap_or(0)
        };
        // The second bit is that of SIGINT.
        number("SigCgt:", 16) & 2 != 0 && number("Threads:", 10) >= threads
    };
    while !fs::read_to_string(format!("/proc/{}/status", child.id())).is_ok_and(listens) {
        assert!(child.try_wait().unwrap().is_none(), "it ended before it listened");
        std::thread::sleep(Duration::from_millis(1));
    }
    child
}

#[cfg(target_os = "linux")]
fn interrupt(child: &Child) {
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
}

/// Uncached commands stop immediately. None of these would end within the test's time limit.
#[cfg(target_os = "linux")]
#[test]
fn ctrl_c_ends_a_computation() {
    let folder = tempfile::tempdir().unwrap();
    let targets = concat!(env!("CARGO_MANIFEST_DIR"), "/data/thresholds.ron");
    let slow = ["--set", "intervals=4000"];
    for arguments in [
        &["boundary", "--vary", "r0", "--from", "2", "--to", "1.7"][..],
        &["phase", "--vary", "r0", "--from", "1.5", "--to", "3", "--xi-from", "10", "--xi-to", "30", "--no-cache"],
        &["calibrate", targets],
        &["pitchfork", "--r0", "2"],
        &["branch", "--r0", "2"],
        &["steady", "--r0", "2"],
    ] {
        let mut command = furrow();
        command.args(arguments).args(slow).current_dir(folder.path()).stderr(Stdio::piped());
        let child = listening(&mut command, 2);
        interrupt(&child);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(1), "{arguments:?}");
        assert_eq!(String::from_utf8(output.stderr).unwrap(), "furrow: error: interrupted\n", "{arguments:?}");
    }
    assert_eq!(names(folder.path()), [""; 0]);
}

/// What follows a division, here a movie of minutes, is ended by the first Ctrl-C, whether it comes before or after the division
/// is solved. A message longer by what is kept says that it came before.
#[cfg(target_os = "linux")]
#[test]
fn ctrl_c_ends_what_follows_a_division() {
    for wait in [0, 400] {
        let folder = tempfile::tempdir().unwrap();
        let mut command = furrow();
        command.args(["divide", "--r0", "2.5", "--no-cache", "--movie", "long.gif", "--movie-frames", "2000"]);
        let child = listening(command.current_dir(folder.path()).stderr(Stdio::piped()), 2);
        std::thread::sleep(Duration::from_millis(wait));
        interrupt(&child);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(1));
        let said = String::from_utf8(output.stderr).unwrap();
        let last = said.lines().last().unwrap_or_default();
        let kept = "; solved divisions are kept in the cache (unless --no-cache)";
        assert_eq!(last.strip_suffix(kept).unwrap_or(last), "furrow: error: interrupted", "{said}");
        assert_eq!(names(folder.path()), [""; 0]);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn ctrl_c_stops_a_tree_whatever_becomes_of_stderr() {
    let folder = tempfile::tempdir().unwrap();
    for stderr in [Some(full()), None] {
        let mut command = furrow();
        // Some hundreds of divisions.
        command.args([
            "tree",
            "--no-cache",
            "--threads",
            "2",
            "--r0-step",
            "0",
            "--set",
            "epsilon=0.5",
            "--set",
            "xi=30",
        ]);
        let told = stderr.is_none();
        command.current_dir(folder.path()).stderr(stderr.unwrap_or_else(Stdio::piped));
        // Its own, the one that waits for Ctrl-C, and the workers, which begin once there are divisions to finish.
        let child = listening(&mut command, 4);
        interrupt(&child);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(1));
        if told {
            let said = String::from_utf8(output.stderr).unwrap();
            assert!(
                said.contains("finishing the divisions that have begun") && said.contains("error: interrupted after"),
                "{said}"
            );
        }
    }
    assert_eq!(names(folder.path()), [""; 0]);
}
