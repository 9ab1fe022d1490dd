use std::sync::{
    Mutex,
    atomic::{AtomicUsize, Ordering::Relaxed},
};

use tempfile::TempDir;

use super::{slot::SLOT, *};
use crate::{
    batch::{Job, Memo, Quantisation, SchedulerOptions, scheduler},
    cortex::{Cue, Numerics, Physics},
    division::{DivisionInput, Outcome},
};

const SOLVER: SolverVersion = SolverVersion::new(7);

fn key(number: u8) -> Key {
    Key::from_bytes(*blake3::hash(&[number]).as_bytes())
}

fn division(number: u8) -> Arc<Division> {
    Arc::new(Division {
        outcome: Outcome::Asymmetric,
        chi: Some(f64::from(number) / 300.0),
        chi_signed: Some(-f64::from(number) / 300.0),
        u_furrow: Some(0.1),
        t_end: std::f64::consts::PI * f64::from(number),
        daughters: Some([1.0 / 3.0, 2.0 / 3.0]),
        growth_rate: None,
        volume_drift: 5e-324,
        steps: 1,
        rejected: 2,
        newton_iterations: 3,
        factorisations: u32::MAX,
        remeshings: number.into(),
    })
}

fn store(cache: &TempDir) -> Store {
    Store::open(cache.path(), SOLVER).unwrap()
}

/// A cache with the entries 0 to `n` − 1, and its file.
fn filled(n: u8) -> (TempDir, PathBuf) {
    let cache = tempfile::tempdir().unwrap();
    let store = store(&cache);
    for number in 0..n {
        store.commit(&key(number), &division(number));
    }
    assert_eq!(store.take_warnings(), [] as [String; 0]);
    let path = store.path.clone();
    (cache, path)
}

fn assert_holds(store: &Store, numbers: impl IntoIterator<Item = u8>) {
    for number in numbers {
        assert_eq!(store.get(&key(number)), Some(division(number)), "entry {number}");
    }
}

#[test]
fn entries_survive_reopening() {
    let (cache, _) = filled(100);
    let store = store(&cache);
    assert_eq!(store.len(), 100);
    assert_holds(&store, 0..100);
    let report = upkeep::verify(cache.path(), SOLVER).unwrap();
    assert_eq!((report.entries, report.bytes, report.corrupt), (100, 100 * SLOT as u64, 0));
}

#[test]
fn a_cut_file_loses_what_was_cut_off_and_is_written_on() {
    for cut in [1, 17, 100, 255, 256, 300, 700] {
        let (cache, path) = filled(5);
        let file = fs::OpenOptions::new().write(true).open(&path).unwrap();
        file.set_len(5 * SLOT as u64 - cut).unwrap();
        let whole = 5 - (cut as usize).div_ceil(SLOT);
        let torn = usize::from(!cut.is_multiple_of(SLOT as u64));

        let report = upkeep::verify(cache.path(), SOLVER).unwrap();
        assert_eq!((report.entries, report.corrupt), (whole, torn), "cut by {cut}");
        if cut == 100 {
            upkeep::repair(cache.path(), SOLVER).unwrap();
            let report = upkeep::verify(cache.path(), SOLVER).unwrap();
            assert_eq!((report.entries, report.corrupt, report.bytes), (whole, 0, (whole * SLOT) as u64));
            continue;
        }
        let store = store(&cache);
        assert_eq!((store.len(), store.damaged()), (whole, torn));
        assert_eq!(store.take_warnings().len(), torn);
        for number in 0..10 {
            store.commit(&key(number), &division(number));
        }
        let report = upkeep::verify(cache.path(), SOLVER).unwrap();
        assert_eq!((report.entries, report.corrupt, report.duplicates), (10, 0, 0));
    }
}

#[test]
fn a_flipped_bit_costs_its_own_entry_and_no_other() {
    for (place, bit) in [(0, 3), (1, 8 * 20), (2, 8 * 50 + 7), (3, 8 * 255), (4, 8 * 200 + 1)] {
        let (cache, path) = filled(5);
        let mut bytes = fs::read(&path).unwrap();
        bytes[place * SLOT + bit / 8] ^= 1 << (bit % 8);
        fs::write(&path, bytes).unwrap();

        let report = upkeep::verify(cache.path(), SOLVER).unwrap();
        assert_eq!((report.entries, report.corrupt), (4, 1));
        assert_eq!(report.damaged, [DamagedEntry { file: path.clone(), offset: (place * SLOT) as u64 }]);

        let store = store(&cache);
        assert_eq!(store.damaged(), 1);
        let warning = store.take_warnings().concat();
        assert!(
            warning.starts_with("1 damaged entry in ") && warning.contains("solved again when needed"),
            "{warning}"
        );
        let lost = key(place as u8);
        assert_eq!(store.get(&lost), None);
        assert_holds(&store, (0..5).filter(|&number| usize::from(number) != place));
        assert!(matches!(store.claim(&lost), Claimed::Yours(Some(_))));
        store.commit(&lost, &division(place as u8));
        assert_holds(&self::store(&cache), 0..5);

        // Reported until repaired, and then no more.
        assert_eq!(upkeep::repair(cache.path(), SOLVER).unwrap().corrupt, 1);
        let report = upkeep::verify(cache.path(), SOLVER).unwrap();
        assert_eq!((report.entries, report.corrupt, report.duplicates), (5, 0, 0));
        assert_holds(&self::store(&cache), 0..5);
    }
}

#[test]
fn entries_of_other_versions_are_neither_used_nor_touched() {
    let (cache, path) = filled(3);
    let foreign = path.with_file_name("0000000000000007.v0.log");
    fs::write(&foreign, b"an older layout").unwrap();
    let before = fs::read(&path).unwrap();

    let newer = Store::open(cache.path(), SolverVersion::new(8)).unwrap();
    assert!(newer.is_empty());
    newer.commit(&key(0), &division(9));
    assert_eq!(fs::read(&path).unwrap(), before);
    let report = upkeep::verify(cache.path(), SolverVersion::new(8)).unwrap();
    assert_eq!((report.entries, report.other_versions, report.corrupt), (1, 3, 0));
    assert_holds(&store(&cache), 0..3);

    upkeep::clear(cache.path(), SOLVER).unwrap();
    assert_eq!(fs::read(&foreign).unwrap(), b"an older layout");
}

#[test]
fn what_one_store_commits_another_sees_and_does_not_commit_again() {
    let cache = tempfile::tempdir().unwrap();
    let (left, right) = (store(&cache), store(&cache));
    left.commit(&key(1), &division(1));
    assert!(matches!(right.claim(&key(1)), Claimed::Stored(found) if found == division(1)));
    left.commit(&key(2), &division(2));
    right.commit(&key(2), &division(2));
    assert_eq!((left.committed(), right.committed(), right.duplicates()), (2, 0, 1));
    assert_eq!(upkeep::verify(cache.path(), SOLVER).unwrap().duplicates, 0);
}

#[test]
fn a_claim_is_held_by_one_until_it_is_dropped() {
    let cache = tempfile::tempdir().unwrap();
    let (left, right) = (store(&cache), store(&cache));
    let Claimed::Yours(claim) = left.claim(&key(1)) else { panic!("nobody else wants it") };
    assert!(claim.is_some());
    assert!(matches!(right.claim(&key(1)), Claimed::Busy));
    assert!(matches!(right.claim(&key(2)), Claimed::Yours(Some(_))));
    drop(claim);
    let Claimed::Yours(claim) = right.claim(&key(1)) else { panic!("the claim was given up") };
    assert!(matches!(left.claim(&key(1)), Claimed::Busy));
    right.commit(&key(1), &division(1));
    assert!(matches!(left.claim(&key(1)), Claimed::Stored(_)));
    drop(claim);
    assert_eq!(fs::read_dir(left.folder.join(upkeep::CLAIMS)).unwrap().count(), 0);
}

#[test]
fn clearing_empties_every_version_while_others_go_on() {
    let (cache, _) = filled(4);
    let stranger = cache.path().join("boundary.ron");
    fs::write(&stranger, "kept").unwrap();
    let other = Store::open(cache.path(), SolverVersion::new(8)).unwrap();
    other.commit(&key(1), &division(1));
    let open = store(&cache);
    fs::write(open.folder.join(upkeep::CLAIMS).join("00.claim"), "").unwrap_or_else(|_| {
        fs::create_dir_all(open.folder.join(upkeep::CLAIMS)).unwrap();
        fs::write(open.folder.join(upkeep::CLAIMS).join("00.claim"), "").unwrap();
    });

    let before = upkeep::clear(cache.path(), SOLVER).unwrap();
    assert_eq!((before.entries, before.other_versions), (4, 1));
    let after = upkeep::verify(cache.path(), SOLVER).unwrap();
    assert_eq!((after.entries, after.other_versions, after.bytes), (0, 0, 0));
    assert_eq!(fs::read_dir(open.folder.join(upkeep::CLAIMS)).unwrap().count(), 0);
    assert_eq!(fs::read_to_string(&stranger).unwrap(), "kept");

    assert_holds(&open, 0..4);
    open.commit(&key(5), &division(5));
    assert!(matches!(store(&cache).claim(&key(5)), Claimed::Stored(_)));
    assert_eq!(upkeep::verify(cache.path(), SOLVER).unwrap().entries, 1);
}

#[test]
fn folders_that_cannot_hold_a_store_are_named() {
    let cache = tempfile::tempdir().unwrap();
    let file = cache.path().join("file");
    fs::write(&file, "").unwrap();
    let text = Store::open(&file, SOLVER).unwrap_err().to_string();
    assert_eq!(text, format!("the cache {} is not a folder", file.display()));

    // A new folder is made with the first write; nothing before that makes one.
    let fresh = cache.path().join("a").join("b");
    let store = Store::open(&fresh, SOLVER).unwrap();
    assert_eq!(upkeep::verify(&fresh, SOLVER).unwrap().entries, 0);
    assert!(!fresh.exists());
    store.commit(&key(1), &division(1));
    assert_eq!(upkeep::verify(&fresh, SOLVER).unwrap().entries, 1);
}

#[test]
fn a_store_that_cannot_be_written_warns_once_and_remembers_in_memory() {
    let cache = tempfile::tempdir().unwrap();
    let store = store(&cache);
    // Where the folder of the logs should be made, there is a file.
    fs::write(cache.path().join(upkeep::FOLDER), "").unwrap();
    assert!(matches!(store.claim(&key(1)), Claimed::Yours(None)));
    for number in 1..4 {
        store.commit(&key(number), &division(number));
    }
    let warnings = store.take_warnings();
    assert_eq!(warnings.len(), 1);
    assert!(warnings[0].contains("going on without storing"), "{warnings:?}");
    assert_holds(&store, 1..4);
    assert_eq!(store.committed(), 0);
}

// The scheduler on a store.

fn input(r0: f64) -> DivisionInput {
    DivisionInput { physics: Physics::GAO2026, numerics: Numerics::default(), r0, cue: Cue::None, seed: 1 }
}

fn memo(cache: &TempDir) -> Memo {
    let store = Store::open(cache.path(), SolverVersion::current()).unwrap();
    Memo::new(Quantisation::DEFAULT).with_store(store)
}

fn run(
    radii: &[f64],
    memo: &Memo,
    solve: impl Fn(&DivisionInput) -> Division + Sync,
) -> (scheduler::Summary, Vec<(usize, Division)>) {
    let options = SchedulerOptions { threads: 1, ..Default::default() };
    let jobs = radii.iter().enumerate().map(|(cell, &r0)| Job { cell, input: input(r0) }).collect();
    let mut cells = Vec::new();
    let summary = scheduler::run(
        jobs,
        memo,
        &options,
        |input| Ok(solve(input)),
        |cell, division| {
            cells.push((cell, division.clone()));
            Vec::new()
        },
    );
    cells.sort_by_key(|(cell, _)| *cell);
    (summary.unwrap(), cells)
}

/// Stands in for the solver.
fn model(input: &DivisionInput) -> Division {
    Division { t_end: input.r0.sin(), ..(*division(1)).clone() }
}

#[test]
fn a_second_run_takes_everything_from_the_store_bit_for_bit() {
    let cache = tempfile::tempdir().unwrap();
    let radii = [5.4, 4.1, 4.1, 3.3, 2.0];
    let (cold, first) = run(&radii, &memo(&cache), model);
    assert_eq!((cold.divisions_solved, cold.memo_hits, cold.store_hits), (4, 1, 0));
    let (warm, second) = run(&radii, &memo(&cache), |_| unreachable!("solved already"));
    assert_eq!((warm.divisions_solved, warm.memo_hits, warm.store_hits), (0, 5, 4));
    assert_eq!(first, second);
}

#[test]
fn a_damaged_entry_is_solved_again_and_reported_in_the_summary() {
    let cache = tempfile::tempdir().unwrap();
    let radii = [5.4, 4.1, 3.3];
    let (_, first) = run(&radii, &memo(&cache), model);
    let path = memo(&cache).store().unwrap().path.clone();
    let mut bytes = fs::read(&path).unwrap();
    bytes[SLOT + 60] ^= 4;
    fs::write(&path, bytes).unwrap();
    let (summary, second) = run(&radii, &memo(&cache), model);
    assert_eq!((summary.divisions_solved, summary.store_hits, summary.corrupt), (1, 2, 1));
    assert_eq!(summary.warnings.len(), 1);
    assert_eq!(first, second);
}

#[test]
fn a_division_another_process_is_at_is_taken_from_it() {
    let cache = tempfile::tempdir().unwrap();
    let memo = memo(&cache);
    let other = Store::open(cache.path(), SolverVersion::current()).unwrap();
    let wanted = memo.key(&memo.canonical(&input(5.4)));
    let Claimed::Yours(Some(claim)) = other.claim(&wanted) else { panic!("nobody else wants it") };
    let claim = Mutex::new(Some(claim));
    // The only worker solves R0 = 2 while the other process has R0 = 5.4, which it then commits.
    let (summary, cells) = run(&[5.4, 2.0], &memo, |input| {
        assert!(input.r0 < 3.0);
        other.commit(&wanted, &division(5));
        claim.lock().unwrap().take();
        model(input)
    });
    assert_eq!((summary.divisions_solved, summary.memo_hits, summary.store_hits), (1, 1, 1));
    assert_eq!(cells[0].1.t_end, division(5).t_end);
}

#[test]
fn a_claim_given_up_without_a_result_is_taken_over() {
    let cache = tempfile::tempdir().unwrap();
    let memo = memo(&cache);
    let other = Store::open(cache.path(), SolverVersion::current()).unwrap();
    let wanted = memo.key(&memo.canonical(&input(5.4)));
    let claim = Mutex::new(Some(other.claim(&wanted)));
    let solves = AtomicUsize::new(0);
    let (summary, _) = run(&[5.4, 2.0], &memo, |input| {
        if solves.fetch_add(1, Relaxed) == 0 {
            assert!(input.r0 < 3.0);
            claim.lock().unwrap().take();
        }
        model(input)
    });
    assert_eq!((summary.divisions_solved, summary.store_hits), (2, 0));
}

#[test]
fn a_process_that_sits_on_its_claim_is_not_waited_for_for_ever() {
    let cache = tempfile::tempdir().unwrap();
    let store = Store::open(cache.path(), SolverVersion::current()).unwrap().with_patience(Duration::ZERO);
    let memo = Memo::new(Quantisation::DEFAULT).with_store(store);
    let other = Store::open(cache.path(), SolverVersion::current()).unwrap();
    let claim = other.claim(&memo.key(&memo.canonical(&input(5.4))));
    let (summary, _) = run(&[5.4], &memo, model);
    assert_eq!(summary.divisions_solved, 1);
    drop(claim);
}
