use std::sync::{
    Mutex,
    atomic::{AtomicUsize, Ordering::Relaxed},
};

use tempfile::TempDir;

use super::{slot::SLOT, *};
use crate::batch::{
    Job, Memo, Quantisation, SchedulerOptions, Summary, scheduler,
    stick::{Broken, Stick},
};

const SOLVER: SolverVersion = SolverVersion::new(7);

fn key(number: u8) -> Key {
    Key::from_bytes(*blake3::hash(&[number]).as_bytes())
}

fn record(number: u8) -> Arc<Broken> {
    let real = f64::from(number);
    Arc::new(Broken { skew: Some(real / 300.0), pieces: None, sound: std::f64::consts::PI * real })
}

fn store(cache: &TempDir) -> Store<Broken> {
    Store::open(cache.path(), SOLVER).unwrap()
}

/// A cache with the entries 0 to `n` − 1, and its file.
fn filled(n: u8) -> (TempDir, PathBuf) {
    let cache = tempfile::tempdir().unwrap();
    let store = store(&cache);
    for number in 0..n {
        store.commit(&key(number), &record(number));
    }
    assert_eq!(store.take_warnings(), []);
    let path = store.path.clone();
    (cache, path)
}

fn assert_holds(store: &Store<Broken>, numbers: impl IntoIterator<Item = u8>) {
    for number in numbers {
        assert_eq!(store.get(&key(number)), Some(record(number)), "entry {number}");
    }
}

#[test]
fn entries_survive_reopening() {
    let (cache, _) = filled(100);
    let store = store(&cache);
    assert_eq!(store.len(), 100);
    assert_holds(&store, 0..100);
    let report = upkeep::verify::<Broken>(cache.path(), SOLVER).unwrap();
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

        let report = upkeep::verify::<Broken>(cache.path(), SOLVER).unwrap();
        assert_eq!((report.entries, report.corrupt), (whole, torn), "cut by {cut}");
        if cut == 100 {
            upkeep::repair::<Broken>(cache.path(), SOLVER).unwrap();
            let report = upkeep::verify::<Broken>(cache.path(), SOLVER).unwrap();
            assert_eq!((report.entries, report.corrupt, report.bytes), (whole, 0, (whole * SLOT) as u64));
            continue;
        }
        let store = store(&cache);
        assert_eq!((store.len(), store.damaged()), (whole, torn));
        assert_eq!(store.take_warnings().len(), torn);
        for number in 0..10 {
            store.commit(&key(number), &record(number));
        }
        let report = upkeep::verify::<Broken>(cache.path(), SOLVER).unwrap();
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

        let report = upkeep::verify::<Broken>(cache.path(), SOLVER).unwrap();
        assert_eq!((report.entries, report.corrupt), (4, 1));
        assert_eq!(report.damaged, [DamagedEntry { file: path.clone(), offset: (place * SLOT) as u64 }]);

        let store = store(&cache);
        assert_eq!(store.damaged(), 1);
        let warnings = store.take_warnings();
        assert_eq!(warnings, [StoreWarning::Damaged { entries: 1, file: path.clone() }]);
        let text = warnings[0].to_string();
        assert!(text.starts_with("1 damaged entry in ") && text.ends_with("solved again when needed"), "{text}");
        let lost = key(place as u8);
        assert_eq!(store.get(&lost), None);
        assert_holds(&store, (0..5).filter(|&number| usize::from(number) != place));
        assert!(matches!(store.claim(&lost), Claimed::Yours(Some(_))));
        store.commit(&lost, &record(place as u8));
        assert_holds(&self::store(&cache), 0..5);

        // Reported until repaired, and then no more.
        assert_eq!(upkeep::repair::<Broken>(cache.path(), SOLVER).unwrap().corrupt, 1);
        let report = upkeep::verify::<Broken>(cache.path(), SOLVER).unwrap();
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
    newer.commit(&key(0), &record(9));
    assert_eq!(fs::read(&path).unwrap(), before);
    let report = upkeep::verify::<Broken>(cache.path(), SolverVersion::new(8)).unwrap();
    assert_eq!((report.entries, report.other_versions, report.corrupt), (1, 3, 0));
    assert_holds(&store(&cache), 0..3);

    upkeep::clear::<Broken>(cache.path(), SOLVER).unwrap();
    assert_eq!(fs::read(&foreign).unwrap(), b"an older layout");
}

#[test]
fn what_one_store_commits_another_sees_and_does_not_commit_again() {
    let cache = tempfile::tempdir().unwrap();
    let (left, right) = (store(&cache), store(&cache));
    left.commit(&key(1), &record(1));
    assert!(matches!(right.claim(&key(1)), Claimed::Stored(found) if found == record(1)));
    left.commit(&key(2), &record(2));
    right.commit(&key(2), &record(2));
    assert_eq!((left.committed(), right.committed(), right.duplicates()), (2, 0, 1));
    assert_eq!(upkeep::verify::<Broken>(cache.path(), SOLVER).unwrap().duplicates, 0);
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
    right.commit(&key(1), &record(1));
    assert!(matches!(left.claim(&key(1)), Claimed::Stored(_)));
    drop(claim);
    assert_eq!(fs::read_dir(left.folder.join(upkeep::CLAIMS)).unwrap().count(), 0);
}

#[test]
fn clearing_empties_every_version_while_others_go_on() {
    let (cache, _) = filled(4);
    let stranger = cache.path().join("boundary.ron");
    fs::write(&stranger, "kept").unwrap();
    let other = Store::<Broken>::open(cache.path(), SolverVersion::new(8)).unwrap();
    other.commit(&key(1), &record(1));
    let open = store(&cache);
    fs::write(open.folder.join(upkeep::CLAIMS).join("00.claim"), "").unwrap_or_else(|_| {
        fs::create_dir_all(open.folder.join(upkeep::CLAIMS)).unwrap();
        fs::write(open.folder.join(upkeep::CLAIMS).join("00.claim"), "").unwrap();
    });

    let before = upkeep::clear::<Broken>(cache.path(), SOLVER).unwrap();
    assert_eq!((before.entries, before.other_versions), (4, 1));
    let after = upkeep::verify::<Broken>(cache.path(), SOLVER).unwrap();
    assert_eq!((after.entries, after.other_versions, after.bytes), (0, 0, 0));
    assert_eq!(fs::read_dir(open.folder.join(upkeep::CLAIMS)).unwrap().count(), 0);
    assert_eq!(fs::read_to_string(&stranger).unwrap(), "kept");

    assert_holds(&open, 0..4);
    open.commit(&key(5), &record(5));
    assert!(matches!(store(&cache).claim(&key(5)), Claimed::Stored(_)));
    assert_eq!(upkeep::verify::<Broken>(cache.path(), SOLVER).unwrap().entries, 1);
}

#[test]
fn folders_that_cannot_hold_a_store_are_named() {
    let cache = tempfile::tempdir().unwrap();
    let file = cache.path().join("file");
    fs::write(&file, "").unwrap();
    let text = Store::<Broken>::open(&file, SOLVER).unwrap_err().to_string();
    assert_eq!(text, format!("the cache {} is not a folder", file.display()));

    // A new folder is made with the first write; nothing before that makes one.
    let fresh = cache.path().join("a").join("b");
    let store = Store::open(&fresh, SOLVER).unwrap();
    assert_eq!(upkeep::verify::<Broken>(&fresh, SOLVER).unwrap().entries, 0);
    assert!(!fresh.exists());
    store.commit(&key(1), &record(1));
    assert_eq!(upkeep::verify::<Broken>(&fresh, SOLVER).unwrap().entries, 1);
}

#[test]
fn a_store_that_cannot_be_written_warns_once_and_remembers_in_memory() {
    let cache = tempfile::tempdir().unwrap();
    let store = store(&cache);
    // Where the folder of the logs should be made, there is a file.
    fs::write(cache.path().join(Broken::FOLDER), "").unwrap();
    assert!(matches!(store.claim(&key(1)), Claimed::Yours(None)));
    for number in 1..4 {
        store.commit(&key(number), &record(number));
    }
    let warnings = store.take_warnings();
    assert_eq!(warnings.len(), 1);
    assert!(matches!(warnings[0], StoreWarning::GivenUp { .. }), "{warnings:?}");
    assert!(warnings[0].to_string().ends_with("going on without storing"), "{warnings:?}");
    assert_holds(&store, 1..4);
    assert_eq!(store.committed(), 0);
}

// The scheduler on a store.

fn memo(cache: &TempDir) -> Memo<Stick> {
    let store = Store::open(cache.path(), SolverVersion::current()).unwrap();
    Memo::new(Quantisation::DEFAULT).with_store(store)
}

fn run(
    lengths: &[f64],
    memo: &Memo<Stick>,
    solve: impl Fn(&Stick) -> Broken + Sync,
) -> (Summary, Vec<(usize, Broken)>) {
    let options = SchedulerOptions { threads: 1, ..Default::default() };
    let jobs = lengths.iter().enumerate().map(|(id, &length)| Job { id, task: Stick::new(length) }).collect();
    let mut done = Vec::new();
    let summary = scheduler::run(
        jobs,
        memo,
        &options,
        |stick| Ok(solve(stick)),
        |id, broken| {
            done.push((id, broken.clone()));
            Vec::new()
        },
    );
    done.sort_by_key(|(id, _)| *id);
    (summary.unwrap(), done)
}

#[test]
fn a_second_run_takes_everything_from_the_store_bit_for_bit() {
    let cache = tempfile::tempdir().unwrap();
    let lengths = [5.4, 4.1, 4.1, 3.3, 2.0];
    let (cold, first) = run(&lengths, &memo(&cache), Stick::break_in_two);
    assert_eq!((cold.solved, cold.memo_hits, cold.store_hits), (4, 1, 0));
    let (warm, second) = run(&lengths, &memo(&cache), |_| unreachable!("solved already"));
    assert_eq!((warm.solved, warm.memo_hits, warm.store_hits), (0, 5, 4));
    assert_eq!(first, second);
}

#[test]
fn a_damaged_entry_is_solved_again_and_reported_in_the_summary() {
    let cache = tempfile::tempdir().unwrap();
    let lengths = [5.4, 4.1, 3.3];
    let (_, first) = run(&lengths, &memo(&cache), Stick::break_in_two);
    let path = memo(&cache).store().unwrap().path.clone();
    let mut bytes = fs::read(&path).unwrap();
    bytes[SLOT + 60] ^= 4;
    fs::write(&path, bytes).unwrap();
    let (summary, second) = run(&lengths, &memo(&cache), Stick::break_in_two);
    assert_eq!((summary.solved, summary.store_hits, summary.corrupt), (1, 2, 1));
    assert_eq!(summary.warnings.len(), 1);
    assert_eq!(first, second);
}

#[test]
fn a_task_another_process_is_at_is_taken_from_it() {
    let cache = tempfile::tempdir().unwrap();
    let memo = memo(&cache);
    let other = Store::<Broken>::open(cache.path(), SolverVersion::current()).unwrap();
    let wanted = memo.key(&memo.canonical(&Stick::new(5.4)));
    let Claimed::Yours(Some(claim)) = other.claim(&wanted) else { panic!("nobody else wants it") };
    let claim = Mutex::new(Some(claim));
    // The only worker solves length 2 while the other process has length 5.4, whose record it then commits.
    let (summary, done) = run(&[5.4, 2.0], &memo, |stick| {
        assert!(stick.length < 3.0);
        other.commit(&wanted, &record(5));
        claim.lock().unwrap().take();
        stick.break_in_two()
    });
    assert_eq!((summary.solved, summary.memo_hits, summary.store_hits), (1, 1, 1));
    assert_eq!(done[0].1, *record(5));
}

#[test]
fn a_claim_given_up_without_a_result_is_taken_over() {
    let cache = tempfile::tempdir().unwrap();
    let memo = memo(&cache);
    let other = Store::<Broken>::open(cache.path(), SolverVersion::current()).unwrap();
    let wanted = memo.key(&memo.canonical(&Stick::new(5.4)));
    let claim = Mutex::new(Some(other.claim(&wanted)));
    let solves = AtomicUsize::new(0);
    let (summary, _) = run(&[5.4, 2.0], &memo, |stick| {
        if solves.fetch_add(1, Relaxed) == 0 {
            assert!(stick.length < 3.0);
            claim.lock().unwrap().take();
        }
        stick.break_in_two()
    });
    assert_eq!((summary.solved, summary.store_hits), (2, 0));
}

#[test]
fn a_process_that_sits_on_its_claim_is_not_waited_for_for_ever() {
    let cache = tempfile::tempdir().unwrap();
    let store = Store::open(cache.path(), SolverVersion::current()).unwrap().with_patience(Duration::ZERO);
    let memo = Memo::new(Quantisation::DEFAULT).with_store(store);
    let other = Store::<Broken>::open(cache.path(), SolverVersion::current()).unwrap();
    let claim = other.claim(&memo.key(&memo.canonical(&Stick::new(5.4))));
    let (summary, _) = run(&[5.4], &memo, Stick::break_in_two);
    assert_eq!(summary.solved, 1);
    drop(claim);
}
