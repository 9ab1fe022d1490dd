//! The store shared by processes: killed writers, two runs on one cache, a full disk.
//!
//! The other processes run this test binary; an environment variable selects their role.

use std::{
    collections::BTreeMap,
    env,
    io::{BufRead, BufReader, Read, Write},
    path::Path,
    process::{Child, Command, ExitStatus, Stdio},
    time::Duration,
};

use furrow_cell::Cell;
use furrow_lineage::batch::{
    Job, Key, Memo, Quantisation, SchedulerOptions, Store, Summary, scheduler,
    store::maintenance::{self, CacheReport},
};
use furrow_mechanics::division::{Division, DivisionInput, Outcome};

const ROLE: &str = "FURROW_TEST_ROLE";
const CACHE: &str = "FURROW_TEST_CACHE";

fn open(cache: &Path) -> Store {
    Store::open(cache).unwrap()
}

fn input(r0: f64) -> DivisionInput {
    DivisionInput { seed: 1, ..DivisionInput::new(Cell::new(r0)) }
}

/// Stands in for the solver: unequal at every size, so that hardly two cells are alike.
fn model(input: &DivisionInput) -> Division {
    let r0 = input.cell.r0;
    let chi = (r0 > 2.2).then_some(0.2 + 0.1 * r0.sin());
    let radius = |sign: f64| chi.map(|chi| r0 * (0.5 * (1.0 + sign * chi)).cbrt());
    Division {
        outcome: if chi.is_some() { Outcome::Asymmetric } else { Outcome::Failed },
        chi,
        chi_signed: chi,
        u_furrow: chi,
        t_end: 1.0 / r0,
        daughters: radius(-1.0).zip(radius(1.0)).map(|(anterior, posterior)| [anterior, posterior]),
        growth_rate: None,
        slow_growth_rate: None,
        volume_drift: 1e-12,
        work: furrow_bvp::Work { steps: 100, rejected: 1, iterations: 300, factorisations: 120, remeshings: 5 },
    }
}

/// A whole tree as text, cells in the order of their names, and what growing it took.
fn grow(memo: &Memo, pause: Duration) -> (String, Summary) {
    let mut radii = BTreeMap::from([(1, 5.4)]);
    let mut tree = BTreeMap::new();
    let solve = |input: &DivisionInput| {
        std::thread::sleep(pause);
        Ok(model(input))
    };
    let expand = |cell: usize, division: &Division| {
        tree.insert(cell, format!("{:x} {division:?}", f64::to_bits(radii[&cell])));
        let daughters = division.daughters.into_iter().flatten().zip([2 * cell, 2 * cell + 1]);
        let named: Vec<(f64, usize)> = daughters.collect();
        radii.extend(named.iter().map(|&(r0, cell)| (cell, r0)));
        named.into_iter().map(|(r0, cell)| Job { id: cell, input: input(r0) }).collect()
    };
    let options = SchedulerOptions { threads: 2, ..Default::default() };
    let roots = vec![Job { id: 1, input: input(5.4) }];
    let summary = scheduler::run(roots, memo, &options, solve, expand).unwrap();
    (blake3::hash(format!("{tree:?}").as_bytes()).to_string(), summary)
}

/// The tree as it should be and its number of distinct divisions.
fn reference() -> (String, usize) {
    let (tree, summary) = grow(&Memo::new(Quantisation::DEFAULT), Duration::ZERO);
    (tree, summary.solved)
}

/// The key and the input of a numbered entry, and its division.
fn numbered(number: u64) -> (Key, DivisionInput, Division) {
    let input = DivisionInput { seed: number, ..input(3.0) };
    (Key::new(&input), input.clone(), Division { t_end: number as f64, ..model(&input) })
}

fn commit(store: &Store, number: u64) {
    let (key, input, division) = numbered(number);
    store.commit(&key, &input, &division);
}

/// What this binary does when it is one of the other processes; without a role it is an empty test.
#[test]
fn other_process() {
    let (Ok(role), Some(cache)) = (env::var(ROLE), env::var_os(CACHE)) else { return };
    let store = open(cache.as_ref());
    // One write call a line: the parent reads it whole or not at all.
    let say = |line: String| std::io::stdout().write_all(line.as_bytes()).unwrap();
    match role.split_once(' ').unwrap_or((&role, "")) {
        ("write", first) => {
            for number in first.parse::<u64>().unwrap().. {
                commit(&store, number);
                say(format!("committed {number}\n"));
            }
        }
        ("grow", _) => {
            let (tree, summary) = grow(&Memo::new(Quantisation::DEFAULT).with_store(store), Duration::from_millis(2));
            say(format!("solved {} warnings {} tree {tree}\n", summary.solved, summary.warnings.len()));
        }
        (role, _) => panic!("no such role: {role}"),
    }
}

fn other_process_command(role: &str, cache: &Path) -> Command {
    let mut command = Command::new(env::current_exe().unwrap());
    as_other_process(&mut command, role, cache);
    command
}

fn as_other_process(command: &mut Command, role: &str, cache: &Path) {
    // By its path in this binary, which is that of this file without the binary's own name.
    let (_, file) = module_path!().split_once("::").unwrap();
    command.args(["--exact", &format!("{file}::other_process"), "--nocapture", "--test-threads=1"]);
    command.env(ROLE, role).env(CACHE, cache).stdout(Stdio::piped()).stderr(Stdio::null());
}

/// Waits for a process and returns the lines it printed whole.
fn finish(mut child: Child) -> (ExitStatus, Vec<String>) {
    let mut reader = BufReader::new(child.stdout.take().unwrap());
    let mut lines = Vec::new();
    let mut line = String::new();
    while reader.read_line(&mut line).unwrap() > 0 {
        if line.ends_with('\n') {
            lines.push(line.trim_end().to_owned());
        }
        line.clear();
    }
    (child.wait().unwrap(), lines)
}

/// What a grower printed.
struct Grown {
    tree: String,
    solved: usize,
    warnings: usize,
}

fn grown(child: Child) -> Grown {
    let (status, lines) = finish(child);
    assert!(status.success(), "{lines:?}");
    let line = lines.iter().find(|line| line.contains("solved ")).expect("the process printed no result");
    let field = |name: &str| line.split(' ').skip_while(|&word| word != name).nth(1).unwrap();
    Grown {
        tree: field("tree").to_owned(),
        solved: field("solved").parse().unwrap(),
        warnings: field("warnings").parse().unwrap(),
    }
}

fn verify(cache: &Path) -> CacheReport {
    maintenance::verify(cache).unwrap()
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
        let mut child = other_process_command(&format!("write {next}"), cache.path()).spawn().unwrap();
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let mut reader = BufReader::new(child.stdout.take().unwrap());
        let mut line = String::new();
        // Every other writer is killed some time after its first entry, the rest at any time, start-up included.
        if round % 2 == 0 {
            while !line.contains("committed") {
                line.clear();
                assert!(reader.read_line(&mut line).unwrap() > 0, "the writer ended by itself");
            }
        }
        std::thread::sleep(Duration::from_micros((random >> 33) % 15_000));
        let before = committed.len();
        let own = (1 << 40) + round;
        commit(&witness, own);
        committed.push(own);
        child.kill().unwrap();
        child.wait().unwrap();
        let mut text = line;
        reader.read_to_string(&mut text).unwrap();
        // Without its newline a number may be half a number.
        let lines = text.split_inclusive('\n').filter_map(|line| line.strip_suffix('\n'));
        let acknowledged: Vec<u64> = lines.filter_map(|line| line.split_once("committed ")?.1.parse().ok()).collect();
        committed.extend(&acknowledged);
        // One more entry may have been written and not acknowledged.
        next = acknowledged.last().map_or(next, |last| last + 2);

        // What is lost stays lost: all are looked for now and then, and those of this round at once.
        let store = open(cache.path());
        let looked_for = if round % 10 == 9 { &committed[..] } else { &committed[before..] };
        for &number in looked_for {
            let (key, _, division) = numbered(number);
            assert_eq!(store.get(&key), Some(division), "entry {number} in round {round}");
        }
    }
    commit(&witness, next);
    let report = verify(cache.path());
    assert_eq!((report.corrupt, witness.take_warnings()), (0, vec![]));
    assert!(report.entries > committed.len());
}

#[test]
fn four_processes_on_one_cache_agree() {
    let (tree, solved) = reference();
    let cache = tempfile::tempdir().unwrap();
    let children = [0; 4].map(|_| other_process_command("grow", cache.path()).spawn().unwrap());
    for child in children.map(grown) {
        assert_eq!((&child.tree, child.warnings), (&tree, 0));
    }
    let report = verify(cache.path());
    assert_eq!((report.entries, report.corrupt), (solved, 0));
}

#[test]
fn a_grower_killed_again_and_again_ends_with_the_same_tree() {
    let (tree, solved) = reference();
    let cache = tempfile::tempdir().unwrap();
    // Each lives a little longer than the one before, so that some get somewhere on however slow a machine.
    let mut life = Duration::from_millis(5);
    while verify(cache.path()).entries < solved / 2 {
        life += Duration::from_millis(3);
        let mut child = other_process_command("grow", cache.path()).spawn().unwrap();
        std::thread::sleep(life);
        child.kill().unwrap();
        finish(child);
    }
    let last = grown(other_process_command("grow", cache.path()).spawn().unwrap());
    assert_eq!(last.tree, tree);
    assert!(last.solved <= solved.div_ceil(2));
    let report = verify(cache.path());
    assert_eq!((report.entries, report.corrupt), (solved, 0));
}

/// A limit on file size simulates a full disk.
#[cfg(unix)]
#[test]
fn a_full_disk_is_reported_and_the_tree_still_grows() {
    let (tree, solved) = reference();
    let cache = tempfile::tempdir().unwrap();
    let mut command = Command::new("sh");
    command.args(["-c", r#"trap "" XFSZ; ulimit -f 160; exec "$0" "$@""#]).arg(env::current_exe().unwrap());
    as_other_process(&mut command, "grow", cache.path());
    let full = grown(command.spawn().unwrap());
    assert_eq!((&full.tree, full.solved, full.warnings), (&tree, solved, 1));
    let report = verify(cache.path());
    assert!(report.entries >= 1 && report.entries < solved, "{report:?}");
    assert_eq!(report.corrupt, 0);

    // With space again, the next run adds what is missing.
    let again = grown(other_process_command("grow", cache.path()).spawn().unwrap());
    assert_eq!((&again.tree, again.solved, again.warnings), (&tree, solved - report.entries, 0));
}
