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
use crate::{
    batch::Quantisation,
    cortex::{Cue, Numerics, Physics},
    division::Outcome,
};

/// Long enough that only a deadlock takes it.
const DEADLOCK: Duration = Duration::from_secs(20);

fn input(r0: f64) -> DivisionInput {
    DivisionInput { physics: Physics::GAO2026, numerics: Numerics::default(), r0, cue: Cue::None, seed: 1 }
}

fn jobs(radii: &[f64]) -> Vec<Job> {
    radii.iter().enumerate().map(|(cell, &r0)| Job { cell, input: input(r0) }).collect()
}

/// Stands in for the solver: symmetric when large, asymmetric when medium, failed when small.
fn model(input: &DivisionInput) -> Division {
    let chi = match input.r0 {
        r0 if r0 < 1.6 => None,
        r0 if r0 < 2.3 => Some(0.6 * (2.3 - r0)),
        _ => Some(0.0),
    };
    let volume = |sign: f64| chi.map(|chi| input.r0 * (0.5 * (1.0 + sign * chi)).cbrt());
    Division {
        outcome: match chi {
            None => Outcome::Failed,
            Some(0.0) => Outcome::Symmetric,
            Some(_) => Outcome::Asymmetric,
        },
        chi,
        chi_signed: chi,
        u_furrow: chi.map(|chi| 0.5 + 0.1 * chi),
        t_end: 1.0 / input.r0,
        daughters: volume(-1.0).zip(volume(1.0)).map(|(anterior, posterior)| [anterior, posterior]),
        growth_rate: None,
        volume_drift: 1e-12,
        steps: 100,
        rejected: 1,
        newton_iterations: 300,
        factorisations: 120,
        remeshings: 5,
    }
}

/// A whole tree by the cells' names, `1` being the root and `2n`, `2n + 1` the daughters of `n`.
type Tree = BTreeMap<usize, (u64, Division)>;

fn grow(r0: f64, memo: &Memo, options: &SchedulerOptions<'_>) -> (Tree, Summary) {
    let mut radii = BTreeMap::from([(1, r0)]);
    let mut tree = Tree::new();
    let summary = run(
        vec![Job { cell: 1, input: input(r0) }],
        memo,
        options,
        |input| Ok(model(input)),
        |cell, division| {
            tree.insert(cell, (radii[&cell].to_bits(), division.clone()));
            let children: Vec<(usize, f64)> =
                division.daughters.into_iter().flatten().zip([2 * cell, 2 * cell + 1]).map(|(r, c)| (c, r)).collect();
            radii.extend(children.iter().copied());
            children.into_iter().map(|(cell, r0)| Job { cell, input: input(r0) }).collect()
        },
    );
    (tree, summary.unwrap())
}

#[test]
fn trees_are_the_same_at_any_thread_count_and_from_a_warm_memo() {
    let mut reference = None;
    for threads in [1, 2, 8] {
        let memo = Memo::new(Quantisation::DEFAULT);
        let options = SchedulerOptions { threads, ..Default::default() };
        let (cold, summary) = grow(5.4, &memo, &options);
        assert_eq!(summary.cells, cold.len());
        assert_eq!(summary.cells, summary.divisions_solved + summary.memo_hits);
        let (warm, again) = grow(5.4, &memo, &options);
        assert_eq!(again.divisions_solved, 0);
        assert_eq!(again.memo_hits, cold.len());
        assert_eq!(warm, cold);
        let (tree, solved) = reference.get_or_insert_with(|| (cold.clone(), summary.divisions_solved));
        assert_eq!(*tree, cold);
        assert_eq!(*solved, summary.divisions_solved);
    }
}

#[test]
fn a_symmetric_lineage_costs_one_division_a_generation() {
    let memo = Memo::new(Quantisation::DEFAULT);
    let (tree, summary) = grow(2.3 * 2.0_f64.powf(4.9 / 3.0), &memo, &SchedulerOptions::default());
    let symmetric = tree.values().filter(|(_, division)| division.outcome == Outcome::Symmetric).count();
    assert_eq!(symmetric, 31);
    assert!(summary.divisions_solved < 20, "{summary:?}");
}

#[test]
fn quantisation_keeps_volumes_and_reports_its_effect() {
    let memo = Memo::new(Quantisation::with_relative_step(1e-3).unwrap());
    let (tree, summary) = grow(4.1, &memo, &SchedulerOptions::default());
    for (r0, division) in tree.values() {
        if let Some([anterior, posterior]) = division.daughters {
            let volume = f64::from_bits(*r0).powi(3);
            assert!(((anterior.powi(3) + posterior.powi(3)) / volume - 1.0).abs() < 1e-14);
        }
    }
    assert!(summary.max_r0_shift > 0.0 && summary.max_r0_shift <= 0.5 * memo.quantisation().relative_step());
    // |dχ/d ln R0| of the model is at most 0.6·2.3.
    assert!(summary.chi_effect > 0.0 && summary.chi_effect <= 0.6 * 2.3 * summary.max_r0_shift);

    let exact = Memo::new(Quantisation::EXACT);
    let (_, summary) = grow(4.1, &exact, &SchedulerOptions::default());
    assert_eq!((summary.max_r0_shift, summary.chi_effect), (0.0, 0.0));
}

#[test]
fn cells_with_a_division_in_flight_do_not_occupy_workers() {
    let memo = Memo::new(Quantisation::DEFAULT);
    let options = SchedulerOptions { threads: 2, ..Default::default() };
    let (other_done, wait_for_other) = mpsc::channel();
    let wait_for_other = Mutex::new(wait_for_other);
    let solves = AtomicUsize::new(0);
    // Nine cells share the division of R0 = 4, which is not over before that of R0 = 2 is.
    let mut radii = [4.0; 10];
    radii[9] = 2.0;
    let mut cells = Vec::new();
    let summary = run(
        jobs(&radii),
        &memo,
        &options,
        |input| {
            solves.fetch_add(1, Relaxed);
            if input.r0 == 4.0 {
                wait_for_other.lock().unwrap().recv_timeout(DEADLOCK).expect("a waiting cell holds the other worker");
            } else {
                other_done.send(()).unwrap();
            }
            Ok(model(input))
        },
        |cell, _| {
            cells.push(cell);
            Vec::new()
        },
    )
    .unwrap();
    assert_eq!(solves.into_inner(), 2);
    assert_eq!((summary.divisions_solved, summary.memo_hits), (2, 8));
    cells.sort_unstable();
    assert_eq!(cells, (0..10).collect::<Vec<_>>());
}

#[test]
fn two_trees_on_one_memo_share_what_is_in_flight() {
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
                wait_for_other.lock().unwrap().recv_timeout(DEADLOCK).expect("the second tree waits on a thread");
                Ok(model(input))
            };
            run(jobs(&[4.0]), memo, &options(), solve, |_, _| Vec::new()).unwrap()
        });
        wait_begun.recv_timeout(DEADLOCK).unwrap();
        // The second tree wants R0 = 4 first but solves R0 = 2 meanwhile on its only worker.
        let second = scope.spawn(move || {
            let solve = |input: &DivisionInput| {
                solves.fetch_add(1, Relaxed);
                other_done.send(()).unwrap();
                Ok(model(input))
            };
            run(jobs(&[4.0, 2.0]), memo, &options(), solve, |_, _| Vec::new()).unwrap()
        });
        (first.join().unwrap(), second.join().unwrap())
    });
    assert_eq!(solves.into_inner(), 2);
    assert_eq!((first.divisions_solved, first.memo_hits), (1, 0));
    assert_eq!((second.divisions_solved, second.memo_hits), (1, 1));
}

#[test]
fn a_tree_takes_over_what_an_interrupted_one_gave_up() {
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
                Ok(model(input))
            };
            run(jobs(&[4.0, 2.0]), memo, &options, solve, |_, _| Vec::new()).unwrap()
        });
        wait_begun.recv_timeout(DEADLOCK).unwrap();
        let second = scope.spawn(move || {
            // The whole of the first tree's queue is wanted here, and this worker is idle.
            let solve = |input: &DivisionInput| Ok(model(input));
            run(jobs(&[2.0]), memo, &SchedulerOptions::default(), solve, |_, _| Vec::new()).unwrap()
        });
        stop.store(true, Relaxed);
        let second = second.join().unwrap();
        assert_eq!((second.cells, second.divisions_solved, second.interrupted), (1, 1, false));
        release.send(()).unwrap();
        let first = first.join().unwrap();
        assert_eq!((first.cells, first.divisions_solved, first.interrupted), (1, 1, true));
    });
    assert_eq!(memo.len(), 2);
}

#[test]
fn the_longest_expected_work_is_begun_first() {
    let memo = Memo::new(Quantisation::DEFAULT);
    let expected_work = |input: &DivisionInput| -(input.r0 - 3.0).abs();
    let options = SchedulerOptions { threads: 1, expected_work: &expected_work, ..Default::default() };
    let order = Mutex::new(Vec::new());
    let solve = |input: &DivisionInput| {
        order.lock().unwrap().push(input.r0);
        Ok(model(input))
    };
    run(jobs(&[5.0, 1.5, 3.25, 2.0]), &memo, &options, solve, |_, _| Vec::new()).unwrap();
    assert_eq!(order.into_inner().unwrap(), [3.25, 2.0, 1.5, 5.0]);
}

#[test]
fn larger_cells_hold_up_more_and_slow_ones_weigh_more() {
    let work = |r0| expected_work(&input(r0));
    assert!(work(5.4) > work(4.2) && work(4.2) > work(3.3));
    assert!(work(2.0) > work(1.4));
    assert!(work(f64::NAN).is_finite() && work(f64::INFINITY).is_finite() && work(-1.0).is_finite());
}

#[test]
fn an_interrupted_tree_is_resumed_without_solving_anything_twice() {
    for stop_after in 0..6 {
        for threads in [1, 2] {
            let memo = Memo::new(Quantisation::DEFAULT);
            let stop = AtomicBool::new(stop_after == 0);
            let solves = AtomicUsize::new(0);
            let solve = |input: &DivisionInput| {
                if solves.fetch_add(1, Relaxed) + 1 >= stop_after {
                    stop.store(true, Relaxed);
                }
                Ok(model(input))
            };
            let children =
                |_: usize, division: &Division| jobs(&division.daughters.into_iter().flatten().collect::<Vec<_>>());
            let options = SchedulerOptions { threads, interrupt: Some(&stop), ..Default::default() };
            let first = run(jobs(&[5.4]), &memo, &options, solve, children).unwrap();
            assert!(first.interrupted);
            assert_eq!(first.divisions_solved, memo.len());
            let resumed = grow(5.4, &memo, &SchedulerOptions::default());
            let fresh = grow(5.4, &Memo::new(Quantisation::DEFAULT), &SchedulerOptions::default());
            assert_eq!(resumed.0, fresh.0);
            assert_eq!(first.divisions_solved + resumed.1.divisions_solved, fresh.1.divisions_solved);
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
            match input.r0 {
                r0 if r0 < 3.5 => Err(DivisionError::Undecided { r0, t_max: 2000.0 }),
                _ => Ok(model(input)),
            }
        };
        let error = run(jobs(&[3.0, 4.0, 3.25, 5.0, 3.25]), &memo, &options, solve, |_, _| Vec::new()).unwrap_err();
        assert_eq!(
            error.to_string(),
            "cell 2 (R0 = 3.25): the cell with R0 = 3.25 neither divided nor came to rest within t = 2000; raise t_max"
        );
        assert!(matches!(error, SchedulerError::Division { failed_cells: 3, .. }));
        assert_eq!(memo.len(), 2);
        assert_eq!(solves.into_inner(), 4);
    }
}

#[test]
fn a_panicking_solver_is_an_error_of_its_cell_alone() {
    let memo = Memo::new(Quantisation::DEFAULT);
    let options = SchedulerOptions { threads: 2, ..Default::default() };
    let solve = |input: &DivisionInput| {
        assert!(input.r0 > 2.5, "radius {}", input.r0);
        Ok(model(input))
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
    let (_, summary) = grow(5.4, &memo, &options);
    let seen = seen.into_inner();
    assert!(seen.iter().all(|progress| progress.running <= 2));
    assert!(seen.iter().any(|progress| progress.running > 0));
    let last = seen.last().unwrap();
    assert_eq!((last.solved, last.memo_hits), (summary.divisions_solved, summary.memo_hits));
    assert_eq!((last.running, last.queued), (0, 0));
}

#[test]
fn an_empty_list_of_roots_is_an_empty_run() {
    let memo = Memo::new(Quantisation::DEFAULT);
    let never = |_: &DivisionInput| -> Result<Division, DivisionError> { unreachable!("nothing to solve") };
    let summary = run(Vec::new(), &memo, &SchedulerOptions::default(), never, |_, _| Vec::new()).unwrap();
    assert_eq!(summary, Summary::default());
}

#[test]
fn a_hundred_thousand_known_cells_need_no_worker() {
    let memo = Memo::new(Quantisation::DEFAULT);
    let mut next = 1;
    let mut expand = |_: usize, _: &Division| {
        let children = [next, next + 1].map(|cell| Job { cell, input: input(4.0) });
        next += 2;
        if next <= 100_001 { children.to_vec() } else { Vec::new() }
    };
    let root = vec![Job { cell: 0, input: input(4.0) }];
    let summary = run(root, &memo, &SchedulerOptions::default(), |input| Ok(model(input)), &mut expand).unwrap();
    assert_eq!((summary.divisions_solved, summary.memo_hits), (1, 100_000));
}
