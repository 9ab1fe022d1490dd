//! The workflows that run a sweep as jobs. Each test is skipped if its engine is not installed.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use crate::common::command::answer;

const SWEEP: &str =
    r#"Sweep(kind: division, axes: [(parameter: "r0", range: (from: 1.5, to: 1.8, count: 8))], replicates: 2)"#;

const FILES: [&str; 3] = ["results.csv", "results.jsonl", "sweep.json"];

fn workflow(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("workflows").join(name).display().to_string()
}

/// Whether a program runs; prints why not.
fn answers(program: &str, arguments: &[&str]) -> bool {
    match Command::new(program).args(arguments).output() {
        Ok(output) if output.status.success() => true,
        Ok(output) => {
            eprintln!("skipped: {program} is installed but says {}", String::from_utf8_lossy(&output.stderr));
            false
        }
        Err(error) => {
            eprintln!("skipped: {program} cannot be run: {error}");
            false
        }
    }
}

fn succeeded(output: &Output) {
    let said = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    assert!(output.status.success(), "{}\n{}", said(&output.stdout), said(&output.stderr));
}

/// A folder with a sweep, solved as a whole.
fn solved() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("s.ron"), SWEEP).unwrap();
    answer(folder.path(), &["sweep", "s.ron", "--out", "whole", "--no-cache"]);
    folder
}

fn is_whole(folder: &Path, out: &str) {
    for file in FILES {
        let bytes = |out: &str| fs::read(folder.join(out).join(file)).unwrap();
        assert!(bytes(out) == bytes("whole"), "{file} differs");
    }
}

#[test]
fn snakemake_merges_parts_to_the_whole_after_one_of_them_was_lost() {
    if !answers("snakemake", &["--version"]) {
        return;
    }
    let folder = solved();
    let run = || {
        let furrow = format!("furrow={}", env!("CARGO_BIN_EXE_furrow"));
        let mut command = Command::new("snakemake");
        command.args(["--snakefile", &workflow("Snakefile"), "--cores", "2", "--config", "sweep=s.ron", "out=out"]);
        succeeded(&command.args(["shards=3", &furrow]).current_dir(folder.path()).output().unwrap());
        is_whole(folder.path(), "out");
    };
    run();
    // A killed job leaves no results of its part, and no merged ones.
    fs::remove_dir_all(folder.path().join("out/parts/2")).unwrap();
    FILES.into_iter().for_each(|file| fs::remove_file(folder.path().join("out").join(file)).unwrap());
    run();
}

#[test]
fn an_array_of_slurm_solves_the_parts() {
    if !answers("sinfo", &[]) {
        return;
    }
    let folder = solved();
    let mut command = Command::new("sbatch");
    command.args(["--wait", "--array=1-3", "--time=5", "--mem=100", &workflow("slurm-array.sh"), "s.ron", "out", "3"]);
    command.env("FURROW", env!("CARGO_BIN_EXE_furrow")).current_dir(folder.path());
    succeeded(&command.output().unwrap());
    answer(folder.path(), &["merge", "out/parts/1", "out/parts/2", "out/parts/3", "--out", "out"]);
    is_whole(folder.path(), "out");
}

/// The script runs without Slurm, given a task number and its arguments.
#[test]
fn the_script_of_the_array_solves_one_part_and_says_how_it_is_called() {
    if !answers("sh", &["-c", "true"]) {
        return;
    }
    let folder = solved();
    let run = |task: &str, arguments: &[&str]| {
        let mut command = Command::new("sh");
        command.arg(workflow("slurm-array.sh")).args(arguments).current_dir(folder.path());
        command.env("FURROW", env!("CARGO_BIN_EXE_furrow"));
        if task.is_empty() {
            command.env_remove("SLURM_ARRAY_TASK_ID")
        } else {
            command.env("SLURM_ARRAY_TASK_ID", task)
        };
        command.output().unwrap()
    };
    for part in ["1", "2"] {
        succeeded(&run(part, &["s.ron", "out", "2"]));
    }
    answer(folder.path(), &["merge", "out/parts/1", "out/parts/2", "--out", "out"]);
    is_whole(folder.path(), "out");
    assert_eq!(run("1", &["s.ron"]).status.code(), Some(2));
    let output = run("", &["s.ron", "out", "2"]);
    assert!(!output.status.success());
    assert!(String::from_utf8_lossy(&output.stderr).contains("sbatch --array=1-2"));
}
