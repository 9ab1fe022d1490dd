use std::{
    collections::BTreeMap,
    sync::{
        Mutex,
        atomic::{AtomicUsize, Ordering::Relaxed},
        mpsc,
    },
    time::Duration,
};

use super::*;
use crate::batch::{Quantisation, fake, fake::input};

/// Long enough that only a deadlock takes it.
const DEADLOCK: Duration = Duration::from_secs(20);

fn jobs(radii: &[f64]) -> Vec<Job> {
    radii.iter().enumerate().map(|(id, &r0)| Job { id, input: input(r0) }).collect()
}

fn solve(input: &DivisionInput) -> Result<Division, DivisionError> {
    Ok(fake::divide(input))
}

/// All cells of a tree by their numbers, 1 being the root and `2n`, `2n + 1` the daughters of `n`.
type Cells = BTreeMap<usize, (u64, Division)>;

fn grow(r0: f64, memo: &Memo, options: &SchedulerOptions<'_>) -> (Cells, Summary) {
    let mut radii = BTreeMap::from([(1, r0)]);
    let mut cells = Cells::new();
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
        let memo = Memo::new(Quantisation::DEFAULT);
        let options = SchedulerOptions { threads, ..Default::default() };
        let (cold, summary) = grow(20.0, &memo, &options);
        assert_eq!(summary.jobs, cold.len());
        assert_eq!(summary.jobs, summary.solved + summary.memo_hits);
        let (warm, again) = grow(20.0, &memo, &options);
        assert_eq!(again.solved, 0);
        assert_eq!(again.memo_hits, cold.len());
        assert_eq!(warm, cold);
        let (cells, solved) = reference.get_or_insert_with(|| (cold.clone(), summary.solved));
        assert_eq!(*cells, cold);
        assert_eq!(*solved, summary.solved);
    }
}

#[test]
fn equal_divisions_are_solved_once() {
    let memo = Memo::new(Quantisation::DEFAULT);
    let (cells, summary) = grow(8.0 * 2.0_f64.powf(4.9), &memo, &SchedulerOptions::default());
    assert_eq!(cells.values().filter(|(_, division)| division.chi() == Some(0.0)).count(), 31);
    let radii = cells.values().map(|(bits, _)| memo.quantisation().apply(f64::from_bits(*bits)).to_bits());
    assert_eq!(summary.solved, radii.collect::<std::collections::BTreeSet<_>>().len());
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
    // |dχ/d ln R0| of the stand-in is at most 0.8.
    assert!(summary.shift_effect > 0.0 && summary.shift_effect <= 0.8 * summary.max_size_shift);

    let exact = Memo::new(Quantisation::EXACT);
    let (_, summary) = grow(21.0, &exact, &SchedulerOptions::default());
    assert_eq!((summary.max_size_shift, summary.shift_effect), (0.0, 0.0));
}

#[test]
fn jobs_whose_division_is_in_flight_do_not_occupy_workers() {
    let memo = Memo::new(Quantisation::DEFAULT);
    let options = SchedulerOptions { threads: 2, ..Default::default() };
    let (other_done, wait_for_other) = mpsc::channel();
    let wait_for_other = Mutex::new(wait_for_other);
    let solves = AtomicUsize::new(0);
    // Nine jobs share the cell of radius 4, which is not solved before that of radius 2 is.
    let mut radii = [4.0; 10];
    radii[9] = 2.0;
    let mut done = Vec::new();
    let summary = run(
        jobs(&radii),
        &memo,
        &options,
        |input| {
            solves.fetch_add(1, Relaxed);
            if input.cell.r0 == 4.0 {
                wait_for_other.lock().unwrap().recv_timeout(DEADLOCK).expect("a waiting job holds the other worker");
            } else {
                other_done.send(()).unwrap();
            }
            solve(input)
        },
        |id, _| {
            done.push(id);
            Vec::new()
        },
    )
    .unwrap();
    assert_eq!(solves.into_inner(), 2);
    assert_eq!((summary.solved, summary.memo_hits), (2, 8));
    done.sort_unstable();
    assert_eq!(done, (0..10).collect::<Vec<_>>());
}

#[test]
fn two_runs_on_one_memo_share_what_is_in_flight() {
    let memo = Memo::new(Quantisation::DEFAULT);
    let options = || SchedulerOptions { threads: 1, ..Default::default() };
    let solves = AtomicUsize::new(0);
    let (begun, wait_begun) = mpsc::channel();
    let (other_done, wait_for_other) = mpsc::channel();
    let wait_for_other = Mutex::new(wait_for_other);
    let (first, second) = std::thread::scope(|scope| {
        let (memo, solves) = (&memo, &solves);
        let first = scope.spawn(move || {
            let solve = |input: &DivisionInput| {
                solves.fetch_add(1, Relaxed);
                begun.send(()).unwrap();
                wait_for_other.lock().unwrap().recv_timeout(DEADLOCK).expect("the second run waits on a thread");
                solve(input)
            };
            run(jobs(&[4.0]), memo, &options(), solve, |_, _| Vec::new()).unwrap()
        });
        wait_begun.recv_timeout(DEADLOCK).unwrap();
        // The second run wants radius 4 first but solves radius 2 meanwhile on its only worker.
        let second = scope.spawn(move || {
            let solve = |input: &DivisionInput| {
                solves.fetch_add(1, Relaxed);
                other_done.send(()).unwrap();
                solve(input)
            };
            run(jobs(&[4.0, 2.0]), memo, &options(), solve, |_, _| Vec::new()).unwrap()
        });
        (first.join().unwrap(), second.join().unwrap())
    });
    assert_eq!(solves.into_inner(), 2);
    assert_eq!((first.solved, first.memo_hits), (1, 0));
    assert_eq!((second.solved, second.memo_hits), (1, 1));
}

#[test]
fn a_run_takes_over_what_an_interrupted_one_gave_up() {
    let memo = Memo::new(Quantisation::DEFAULT);
    let stop = AtomicBool::new(false);
    let (begun, wait_begun) = mpsc::channel();
    let (release, wait_release) = mpsc::channel::<()>();
    let wait_release = Mutex::new(wait_release);
    std::thread::scope(|scope| {
        let (memo, stop) = (&memo, &stop);
        let first = scope.spawn(move || {
            let options = SchedulerOptions { threads: 1, interrupt: Some(stop), ..Default::default() };
            let solve = |input: &DivisionInput| {
                begun.send(()).unwrap();
                wait_release.lock().unwrap().recv_timeout(DEADLOCK).unwrap();
                solve(input)
            };
            run(jobs(&[4.0, 2.0]), memo, &options, solve, |_, _| Vec::new()).unwrap()
        });
        wait_begun.recv_timeout(DEADLOCK).unwrap();
        let second = scope.spawn(move || {
            // The whole of the first run's queue is wanted here, and this worker is idle.
            run(jobs(&[2.0]), memo, &SchedulerOptions::default(), solve, |_, _| Vec::new()).unwrap()
        });
        stop.store(true, Relaxed);
        let second = second.join().unwrap();
        assert_eq!((second.jobs, second.solved, second.interrupted), (1, 1, false));
        release.send(()).unwrap();
        let first = first.join().unwrap();
        assert_eq!((first.jobs, first.solved, first.interrupted), (1, 1, true));
    });
    assert_eq!(memo.len(), 2);
}

fn order(options: &SchedulerOptions<'_>) -> Vec<f64> {
    let memo = Memo::new(Quantisation::DEFAULT);
    let order = Mutex::new(Vec::new());
    let solve = |input: &DivisionInput| {
        order.lock().unwrap().push(input.cell.r0);
        solve(input)
    };
    run(jobs(&[5.0, 1.5, 3.25, 2.0]), &memo, options, solve, |_, _| Vec::new()).unwrap();
    order.into_inner().unwrap()
}

#[test]
fn the_most_expected_work_is_begun_first_by_default_the_largest() {
    let options = SchedulerOptions { threads: 1, ..Default::default() };
    assert_eq!(order(&options), [5.0, 3.25, 2.0, 1.5]);
    let expected_work = |input: &DivisionInput| -(input.cell.r0 - 3.0).abs();
    assert_eq!(order(&SchedulerOptions { expected_work: &expected_work, ..options }), [3.25, 2.0, 1.5, 5.0]);
}

#[test]
fn an_interrupted_run_is_resumed_without_solving_anything_twice() {
    for stop_after in 0..6 {
        for threads in [1, 2] {
            let memo = Memo::new(Quantisation::DEFAULT);
            let stop = AtomicBool::new(stop_after == 0);
            let solves = AtomicUsize::new(0);
            let solve = |input: &DivisionInput| {
                if solves.fetch_add(1, Relaxed) + 1 >= stop_after {
                    stop.store(true, Relaxed);
                }
                solve(input)
            };
            let following =
                |_: usize, division: &Division| jobs(&division.daughters().into_iter().flatten().collect::<Vec<_>>());
            let options = SchedulerOptions { threads, interrupt: Some(&stop), ..Default::default() };
            let first = run(jobs(&[20.0]), &memo, &options, solve, following).unwrap();
            assert!(first.interrupted);
            assert_eq!(first.solved, memo.len());
            let resumed = grow(20.0, &memo, &SchedulerOptions::default());
            let fresh = grow(20.0, &Memo::new(Quantisation::DEFAULT), &SchedulerOptions::default());
            assert_eq!(resumed.0, fresh.0);
            assert_eq!(first.solved + resumed.1.solved, fresh.1.solved);
        }
    }
}

#[test]
fn a_failed_division_is_named_and_the_others_are_kept() {
    for threads in [1, 2, 8] {
        let memo = Memo::new(Quantisation::DEFAULT);
        let options = SchedulerOptions { threads, ..Default::default() };
        let solves = AtomicUsize::new(0);
        let solve = |input: &DivisionInput| {
            solves.fetch_add(1, Relaxed);
            match input.cell.r0 {
                value if value < 3.5 => Err(DivisionError::BadInput { field: "r0", value, allowed: "more" }),
                _ => solve(input),
            }
        };
        let error = run(jobs(&[3.0, 4.0, 3.25, 5.0, 3.25]), &memo, &options, solve, |_, _| Vec::new()).unwrap_err();
        assert_eq!(error.to_string(), "division 2 (R0 = 3.25): r0 = 3.25: more (2 further divisions failed)");
        let SchedulerError::Unsolved { jobs, summary } = error else { panic!("{error}") };
        assert_eq!(jobs.iter().map(|job| job.id).collect::<Vec<_>>(), [2, 4, 0]);
        assert_eq!((summary.jobs, summary.solved), (2, 2));
        assert_eq!(memo.len(), 2);
        assert_eq!(solves.into_inner(), 4);
    }
}

#[test]
fn a_panicking_solver_is_an_error_of_its_division_alone() {
    let memo = Memo::new(Quantisation::DEFAULT);
    let options = SchedulerOptions { threads: 2, ..Default::default() };
    let solve = |input: &DivisionInput| {
        assert!(input.cell.r0 > 2.5, "radius {}", input.cell.r0);
        solve(input)
    };
    let error = run(jobs(&[3.0, 2.0, 4.0]), &memo, &options, solve, |_, _| Vec::new()).unwrap_err();
    assert!(error.to_string().contains("radius 2"), "{error}");
    assert_eq!(memo.len(), 2);
}

#[test]
fn progress_ends_with_the_summarys_numbers() {
    let memo = Memo::new(Quantisation::DEFAULT);
    let seen = std::cell::RefCell::new(Vec::new());
    let progress = |progress: Progress| seen.borrow_mut().push(progress);
    let options = SchedulerOptions { threads: 2, progress: Some(&progress), ..Default::default() };
    let (_, summary) = grow(20.0, &memo, &options);
    let seen = seen.into_inner();
    assert!(seen.iter().all(|progress| progress.running <= 2));
    assert!(seen.iter().any(|progress| progress.running > 0));
    let last = seen.last().unwrap();
    assert_eq!((last.solved, last.memo_hits), (summary.solved, summary.memo_hits));
    assert_eq!((last.running, last.queued), (0, 0));
}

#[test]
fn no_jobs_are_an_empty_run() {
    let memo = Memo::new(Quantisation::DEFAULT);
    let never = |_: &DivisionInput| -> Result<Division, DivisionError> { unreachable!("nothing to solve") };
    let summary = run(Vec::new(), &memo, &SchedulerOptions::default(), never, |_, _| Vec::new()).unwrap();
    assert_eq!(summary, Summary::default());
}

#[test]
fn a_hundred_thousand_known_divisions_need_no_worker() {
    let memo = Memo::new(Quantisation::DEFAULT);
    let mut next = 1;
    let mut expand = |_: usize, _: &Division| {
        let following = [next, next + 1].map(|id| Job { id, input: input(4.0) });
        next += 2;
        if next <= 100_001 { following.to_vec() } else { Vec::new() }
    };
    let summary = run(jobs(&[4.0]), &memo, &SchedulerOptions::default(), solve, &mut expand).unwrap();
    assert_eq!((summary.solved, summary.memo_hits), (1, 100_000));
}
