//! The store among processes: killed writers, growers on one cache.

use std::{
    env,
    io::{BufRead, BufReader, Read, Write},
    path::Path,
    process::{Command, Stdio},
    time::Duration,
};

use furrow_cell::Cell;
use furrow_lineage::batch::{Key, Store, store::maintenance::verify};
use furrow_mechanics::division::{Division, DivisionInput};

use crate::common::{
    command::{command, json},
    stand_in::fake,
};

/// A number from which this test binary writes entries, if it runs as another process, and the cache that it writes to.
const FIRST: &str = "FURROW_TEST_FIRST";
const CACHE: &str = "FURROW_TEST_CACHE";

/// A lineage of 18 divisions.
const GROW: [&str; 7] = ["tree", "--set", "r0=3", "--threads", "2", "--cache", "cache"];

fn open(cache: &Path) -> Store {
    Store::open(cache).unwrap()
}

/// The key and the input of a numbered entry, and its division.
fn numbered(number: u64) -> (Key, DivisionInput, Division) {
    let input = DivisionInput { seed: number, ..DivisionInput::new(Cell::gao2026_thresholds(3.0)) };
    (Key::new(&input), input.clone(), Division { t_end: number as f64, ..fake(&input).unwrap() })
}

fn commit(store: &Store, number: u64) {
    let (key, input, division) = numbered(number);
    store.commit(&key, &input, &division);
}

/// The other process: writes entries and says so until it is killed. The test is empty without a first entry in the environment.
#[test]
fn other_process() {
    let (Ok(first), Some(cache)) = (env::var(FIRST), env::var_os(CACHE)) else { return };
    let store = open(cache.as_ref());
    for number in first.parse::<u64>().unwrap().. {
        commit(&store, number);
        // One write call a line: the parent reads it whole or not at all.
        std::io::stdout().write_all(format!("committed {number}\n").as_bytes()).unwrap();
    }
}

fn writer(first: u64, cache: &Path) -> Command {
    let mut command = Command::new(env::current_exe().unwrap());
    // The test's path in this binary: the path of this file without the binary's name.
    let (_, file) = module_path!().split_once("::").unwrap();
    command.args(["--exact", &format!("{file}::other_process"), "--nocapture", "--test-threads=1"]);
    command.env(FIRST, first.to_string()).env(CACHE, cache).stdout(Stdio::piped()).stderr(Stdio::null());
    command
}

#[test]
fn fifty_killed_writers_lose_no_committed_entry() {
    let cache = tempfile::tempdir().unwrap();
    // Reads and writes all the while.
    let witness = open(cache.path());
    let mut committed = Vec::new();
    let mut next = 0_u64;
    let mut random = 0x9e37_79b9_7f4a_7c15_u64;
    for round in 0..50 {
        let mut child = writer(next, cache.path()).spawn().unwrap();
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let mut reader = BufReader::new(child.stdout.take().unwrap());
        let mut text = String::new();
        // Every other writer is killed some time after its first entry, the rest at any time, start-up included.
        while round % 2 == 0 && !text.contains("committed") {
            assert!(reader.read_line(&mut text).unwrap() > 0, "the writer ended by itself");
        }
        std::thread::sleep(Duration::from_micros((random >> 33) % 15_000));
        let before = committed.len();
        let own = (1 << 40) + round;
        commit(&witness, own);
        committed.push(own);
        child.kill().unwrap();
        child.wait().unwrap();
        reader.read_to_string(&mut text).unwrap();
        // Without its newline a number may be half a number.
        let lines = text.split_inclusive('\n').filter_map(|line| line.strip_suffix('\n'));
        let acknowledged: Vec<u64> = lines.filter_map(|line| line.split_once("committed ")?.1.parse().ok()).collect();
        committed.extend(&acknowledged);
        // One more entry may have been written and not acknowledged.
        next = acknowledged.last().map_or(next, |last| last + 2);

        // A lost entry stays lost: the entries of this round are checked at once, and all entries now and then.
        let store = open(cache.path());
        let looked_for = if round % 10 == 9 { &committed[..] } else { &committed[before..] };
        for &number in looked_for {
            let (key, _, division) = numbered(number);
            assert_eq!(store.get(&key), Some(division), "entry {number} in round {round}");
        }
    }
    commit(&witness, next);
    let report = verify(cache.path()).unwrap();
    assert_eq!((report.corrupt, witness.take_warnings()), (0, vec![]));
    assert!(report.entries > committed.len());
}

/// Grows in `folder`, without a cache; the tree, and how many divisions were solved for it.
fn reference(folder: &Path) -> (Vec<u8>, u64) {
    let answer = json(folder, &[&GROW[..5], &["--no-cache", "--out", "reference"]].concat());
    (tree(folder, "reference"), answer["divisions_solved"].as_u64().unwrap())
}

fn tree(folder: &Path, out: &str) -> Vec<u8> {
    std::fs::read(folder.join(out).join("tree.json")).unwrap()
}

fn grower(folder: &Path, out: &str) -> Command {
    let mut command = command(folder, &[&GROW[..], &["--out", out]].concat());
    command.stdout(Stdio::null()).stderr(Stdio::piped());
    command
}

/// Grows once more, in peace: the same tree, and a cache without damage that has every division.
fn assert_complete(folder: &Path, reference: (Vec<u8>, u64)) {
    let output = grower(folder, "complete").output().unwrap();
    assert!(output.status.success() && !String::from_utf8_lossy(&output.stderr).contains("WARN"), "{output:?}");
    assert!(tree(folder, "complete") == reference.0);
    let report = verify(&folder.join("cache")).unwrap();
    assert_eq!((report.entries as u64, report.corrupt), (reference.1, 0));
}

#[test]
fn four_processes_on_one_cache_agree() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let reference = reference(folder);
    let children = ["1", "2", "3", "4"].map(|out| (out, grower(folder, out).spawn().unwrap()));
    for (out, child) in children {
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success() && !String::from_utf8_lossy(&output.stderr).contains("WARN"), "{output:?}");
        assert!(tree(folder, out) == reference.0);
    }
    assert_complete(folder, reference);
}

#[test]
fn a_grower_killed_again_and_again_ends_with_the_same_tree() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let reference = reference(folder);
    // Each lives a little longer than the one before, so that some get somewhere on however slow a machine.
    let mut life = Duration::from_millis(5);
    while (verify(&folder.join("cache")).unwrap().entries as u64) < reference.1 / 2 {
        life += Duration::from_millis(5);
        let mut child = grower(folder, "killed").spawn().unwrap();
        std::thread::sleep(life);
        child.kill().unwrap();
        child.wait().unwrap();
    }
    assert_complete(folder, reference);
}
