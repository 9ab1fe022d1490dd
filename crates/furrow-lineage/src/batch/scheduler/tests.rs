use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Mutex, mpsc};
use std::time::Duration;

use super::*;
use crate::batch::{Quantisation, fake, fake::input};
use furrow_mechanics::division::DivisionError;

/// Waits for a signal, long enough that only a deadlock takes it.
fn wait(signal: &Mutex<mpsc::Receiver<()>>, else_what: &str) {
    signal.lock().unwrap().recv_timeout(Duration::from_secs(20)).expect(else_what);
}

fn signal() -> (mpsc::Sender<()>, Mutex<mpsc::Receiver<()>>) {
    let (sender, receiver) = mpsc::channel();
    (sender, Mutex::new(receiver))
}

fn memo() -> Memo {
    Memo::new(Quantisation::DEFAULT)
}

fn on(threads: usize) -> SchedulerOptions<'static> {
    SchedulerOptions { threads, ..Default::default() }
}

fn jobs(radii: &[f64]) -> Vec<Job> {
    radii.iter().enumerate().map(|(id, &r0)| Job { id, input: input(r0) }).collect()
}

fn solve(input: &DivisionInput) -> Result<Division, DivisionError> {
    Ok(fake::divide(input))
}

/// Solves cells of these radii, from which nothing follows.
fn run_radii(radii: &[f64], memo: &Memo, options: &SchedulerOptions<'_>, solve: impl Solve) -> Result<Summary> {
    run(jobs(radii), memo, options, solve, |_, _| Vec::new())
}

/// All cells of a tree by their numbers, 1 being the root and `2n`, `2n + 1` the daughters of `n`.
type Cells = BTreeMap<usize, (u64, Division)>;

fn grow(r0: f64, memo: &Memo, options: &SchedulerOptions<'_>) -> (Cells, Summary) {
    let (mut radii, mut cells) = (BTreeMap::from([(1, r0)]), Cells::new());
    let summary = run(vec![Job { id: 1, input: input(r0) }], memo, options, solve, |id, division| {
        cells.insert(id, (radii[&id].to_bits(), division.clone()));
        let daughters = division.daughters().into_iter().flatten().zip([2 * id, 2 * id + 1]);
        let following: Vec<Job> = daughters.map(|(r0, id)| Job { id, input: input(r0) }).collect();
        radii.extend(following.iter().map(|job| (job.id, job.input.cell.r0)));
        following
    });
    (cells, summary.unwrap())
}

#[test]
fn trees_are_the_same_at_any_thread_count_and_from_a_warm_memo() {
    let mut reference = None;
    for threads in [1, 2, 8] {
        let memo = memo();
        let (cold, summary) = grow(20.0, &memo, &on(threads));
        assert_eq!((summary.jobs, summary.solved + summary.memo_hits), (cold.len(), cold.len()));
        let (warm, again) = grow(20.0, &memo, &on(threads));
        assert_eq!((again.solved, again.memo_hits), (0, cold.len()));
        assert_eq!(warm, cold);
        assert_eq!(*reference.get_or_insert((warm, summary.solved)), (cold, summary.solved));
    }
}

#[test]
fn equal_divisions_are_solved_once() {
    let memo = memo();
    let (cells, summary) = grow(8.0 * 2.0_f64.powf(4.9), &memo, &SchedulerOptions::default());
    assert_eq!(cells.values().filter(|(_, division)| division.chi() == Some(0.0)).count(), 31);
    let radii = cells.values().map(|(bits, _)| memo.quantisation().apply(f64::from_bits(*bits)).to_bits());
    assert_eq!(summary.solved, radii.collect::<BTreeSet<_>>().len());
    assert!(summary.solved < cells.len() / 10, "{summary:?}");
}

#[test]
fn rounding_loses_no_radius_and_reports_its_effect() {
    let memo = Memo::new(Quantisation::with_relative_step(1e-3).unwrap());
    let (cells, summary) = grow(21.0, &memo, &SchedulerOptions::default());
    for (r0, division) in cells.values() {
        if let Some([left, right]) = division.daughters() {
            assert!(((left + right) / f64::from_bits(*r0) - 1.0).abs() < 1e-14);
        }
    }
    assert!(summary.max_size_shift > 0.0 && summary.max_size_shift <= 0.5 * memo.quantisation().relative_step());
    // The stand-in's slope |dχ/d ln R0| is at most 0.8.
    assert!(summary.shift_effect > 0.0 && summary.shift_effect <= 0.8 * summary.max_size_shift);

    let (_, summary) = grow(21.0, &Memo::new(Quantisation::EXACT), &SchedulerOptions::default());
    assert_eq!((summary.max_size_shift, summary.shift_effect), (0.0, 0.0));
}

#[test]
fn jobs_with_a_division_in_flight_do_not_occupy_workers() {
    let (other_done, other_is_done) = signal();
    let solves = AtomicUsize::new(0);
    // Nine jobs share the cell of radius 4. It is solved only after the cell of radius 2.
    let mut radii = [4.0; 10];
    radii[9] = 2.0;
    let solve = |input: &DivisionInput| {
        solves.fetch_add(1, Relaxed);
        match input.cell.r0 == 4.0 {
            true => wait(&other_is_done, "a waiting job holds the other worker"),
            false => other_done.send(()).unwrap(),
        }
        solve(input)
    };
    let mut done = BTreeSet::new();
    let summary = run(jobs(&radii), &memo(), &on(2), solve, |id, _| {
        assert!(done.insert(id));
        Vec::new()
    });
    let summary = summary.unwrap();
    assert_eq!((solves.into_inner(), summary.solved, summary.memo_hits), (2, 2, 8));
    assert!(done.into_iter().eq(0..10));
}

#[test]
fn two_runs_on_one_memo_share_divisions_in_flight() {
    let (memo, solves) = (&memo(), &AtomicUsize::new(0));
    let ((begun, is_begun), (other_done, other_is_done)) = (signal(), signal());
    let (first, second) = std::thread::scope(|scope| {
        let first = scope.spawn(move || {
            let solve = |input: &DivisionInput| {
                solves.fetch_add(1, Relaxed);
                begun.send(()).unwrap();
                wait(&other_is_done, "the second run waits on a thread");
                solve(input)
            };
            run_radii(&[4.0], memo, &on(1), solve).unwrap()
        });
        wait(&is_begun, "the first run begins");
        // The second run wants radius 4 first but solves radius 2 meanwhile on its only worker.
        let second = scope.spawn(move || {
            let solve = |input: &DivisionInput| {
                solves.fetch_add(1, Relaxed);
                other_done.send(()).unwrap();
                solve(input)
            };
            run_radii(&[4.0, 2.0], memo, &on(1), solve).unwrap()
        });
        (first.join().unwrap(), second.join().unwrap())
    });
    assert_eq!(solves.load(Relaxed), 2);
    assert_eq!([first.solved, first.memo_hits, second.solved, second.memo_hits], [1, 0, 1, 1]);
}

#[test]
fn a_run_takes_over_divisions_of_an_interrupted_run() {
    let (memo, stop) = (&memo(), &AtomicBool::new(false));
    let ((begun, is_begun), (release, is_released)) = (signal(), signal());
    std::thread::scope(|scope| {
        let first = scope.spawn(move || {
            let solve = |input: &DivisionInput| {
                begun.send(()).unwrap();
                wait(&is_released, "the second run ends");
                solve(input)
            };
            let options = SchedulerOptions { interrupt: Some(stop), ..on(1) };
            run_radii(&[4.0, 2.0], memo, &options, solve).unwrap()
        });
        wait(&is_begun, "the first run begins");
        // The whole of the first run's queue is wanted here, and this worker is idle.
        let second = scope.spawn(move || run_radii(&[2.0], memo, &SchedulerOptions::default(), solve).unwrap());
        stop.store(true, Relaxed);
        let second = second.join().unwrap();
        assert_eq!((second.jobs, second.solved, second.interrupted), (1, 1, false));
        release.send(()).unwrap();
        let first = first.join().unwrap();
        assert_eq!((first.jobs, first.solved, first.interrupted), (1, 1, true));
    });
    assert_eq!(memo.len(), 2);
}

#[test]
fn the_most_expected_work_is_begun_first_by_default_the_largest() {
    let order = |options: &SchedulerOptions<'_>| {
        let order = Mutex::new(Vec::new());
        let solve = |input: &DivisionInput| {
            order.lock().unwrap().push(input.cell.r0);
            solve(input)
        };
        run_radii(&[5.0, 1.5, 3.25, 2.0], &memo(), options, solve).unwrap();
        order.into_inner().unwrap()
    };
    assert_eq!(order(&on(1)), [5.0, 3.25, 2.0, 1.5]);
    let expected_work = |input: &DivisionInput| -(input.cell.r0 - 3.0).abs();
    assert_eq!(order(&SchedulerOptions { expected_work: &expected_work, ..on(1) }), [3.25, 2.0, 1.5, 5.0]);
}

#[test]
fn an_interrupted_run_is_resumed_without_solving_anything_twice() {
    let (fresh, once) = grow(20.0, &memo(), &SchedulerOptions::default());
    for (stop_after, threads) in (0..6).flat_map(|stop_after| [(stop_after, 1), (stop_after, 2)]) {
        let (memo, stop, solves) = (memo(), AtomicBool::new(stop_after == 0), AtomicUsize::new(0));
        let solve = |input: &DivisionInput| {
            if solves.fetch_add(1, Relaxed) + 1 >= stop_after {
                stop.store(true, Relaxed);
            }
            solve(input)
        };
        let following = |_: usize, division: &Division| division.daughters().map_or(vec![], |radii| jobs(&radii));
        let options = SchedulerOptions { interrupt: Some(&stop), ..on(threads) };
        let first = run(jobs(&[20.0]), &memo, &options, solve, following).unwrap();
        assert_eq!((first.interrupted, first.solved), (true, memo.len()));
        let (resumed, rest) = grow(20.0, &memo, &SchedulerOptions::default());
        assert_eq!(resumed, fresh);
        assert_eq!(first.solved + rest.solved, once.solved);
    }
}

#[test]
fn a_failed_division_is_named_and_the_others_are_kept() {
    for threads in [1, 2, 8] {
        let (memo, solves) = (memo(), AtomicUsize::new(0));
        let solve = |input: &DivisionInput| {
            solves.fetch_add(1, Relaxed);
            match input.cell.r0 {
                value if value < 3.5 => Err(DivisionError::BadInput { field: "r0", value, allowed: "more" }),
                _ => solve(input),
            }
        };
        let error = run_radii(&[3.0, 4.0, 3.25, 5.0, 3.25], &memo, &on(threads), solve).unwrap_err();
        assert_eq!(error.to_string(), "division 2 (R0 = 3.25): r0 = 3.25: more (2 further divisions failed)");
        let SchedulerError::Unsolved { jobs, summary } = error else { panic!("{error}") };
        assert!(jobs.iter().map(|job| job.id).eq([2, 4, 0]));
        assert_eq!((summary.jobs, summary.solved, memo.len(), solves.into_inner()), (2, 2, 2, 4));
    }
}

#[test]
fn a_panicking_solver_is_an_error_of_its_division_alone() {
    let memo = memo();
    let solve = |input: &DivisionInput| {
        assert!(input.cell.r0 > 2.5, "radius {}", input.cell.r0);
        solve(input)
    };
    let error = run_radii(&[3.0, 2.0, 4.0], &memo, &on(2), solve).unwrap_err();
    assert!(error.to_string().contains("radius 2"), "{error}");
    assert_eq!(memo.len(), 2);
}

#[test]
fn progress_ends_with_the_summarys_numbers() {
    let seen = std::cell::RefCell::new(Vec::new());
    let progress = |progress: Progress| seen.borrow_mut().push(progress);
    let (_, summary) = grow(20.0, &memo(), &SchedulerOptions { progress: Some(&progress), ..on(2) });
    let seen = seen.into_inner();
    assert!(seen.iter().all(|progress| progress.running <= 2) && seen.iter().any(|progress| progress.running > 0));
    let Summary { solved, memo_hits, .. } = summary;
    assert_eq!(seen.last(), Some(&Progress { solved, running: 0, queued: 0, memo_hits }));
}

#[test]
fn a_run_solves_nothing_that_is_known_and_nothing_for_no_jobs() {
    let mut next = 1;
    let expand = |_: usize, _: &Division| {
        let following = [next, next + 1].map(|id| Job { id, input: input(4.0) });
        next += 2;
        if next <= 100_001 { following.to_vec() } else { Vec::new() }
    };
    let summary = run(jobs(&[4.0]), &memo(), &SchedulerOptions::default(), solve, expand).unwrap();
    assert_eq!((summary.solved, summary.memo_hits), (1, 100_000));
    let never = |_: &DivisionInput| -> Result<Division, DivisionError> { unreachable!("nothing to solve") };
    let summary = run_radii(&[], &memo(), &SchedulerOptions::default(), never).unwrap();
    assert_eq!(summary, Summary::default());
}

/// A worker that waits for a pool of its own takes up other work, on top of the work it has begun: many trees once filled its stack.
#[test]
fn a_run_on_one_thread_inside_a_worker_begins_no_other() {
    use rayon::prelude::*;
    use std::cell::Cell;
    thread_local!(static BEGUN: Cell<usize> = const { Cell::new(0) });
    let deepest = AtomicUsize::new(0);
    let tree = |k: usize| {
        deepest.fetch_max(BEGUN.replace(BEGUN.get() + 1) + 1, Relaxed);
        let (cells, _) = grow(20.0 + 1e-3 * k as f64, &memo(), &on(1));
        BEGUN.set(BEGUN.get() - 1);
        cells.len()
    };
    let cells: Vec<usize> = pool(4).unwrap().install(|| (0..400).into_par_iter().map(tree).collect());
    assert!(cells.iter().all(|cells| *cells > 10));
    assert_eq!(deepest.into_inner(), 1);
}
