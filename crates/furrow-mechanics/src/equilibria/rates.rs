//! Growth rates of the points of a branch, computed concurrently: the branch does not wait for them.

use std::collections::VecDeque;
use std::sync::Mutex;

use furrow_bvp::{Continuation, Solution};

use super::point::ShapePoint;
use crate::cortex::Cortex;
use crate::stability::following::FollowedRates;

/// Receives the next point of a branch, and the number of folds and pitchforks before it.
pub(super) type TakeIn<'a> = dyn FnMut(&Solution, usize) + 'a;

/// Points without growth rates yet. Each computation starts from the previous modes, so that only one thread at a time
/// works on them, in order.
struct Queue {
    waiting: Mutex<Waiting>,
    rates: Mutex<(FollowedRates, Vec<Option<f64>>)>,
}

#[derive(Default)]
struct Waiting {
    points: VecDeque<(Solution, usize)>,
    /// Whether a thread is working, which also takes points added meanwhile.
    at_work: bool,
}

impl Queue {
    /// Adds a point; returns whether a thread must be started.
    fn add(&self, y: &Solution, passed: usize) -> bool {
        let mut waiting = self.waiting.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        waiting.points.push_back((y.clone(), passed));
        !std::mem::replace(&mut waiting.at_work, true)
    }

    /// The next point, if there is one.
    fn next(&self) -> Option<(Solution, usize)> {
        let mut waiting = self.waiting.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        let next = waiting.points.pop_front();
        waiting.at_work = next.is_some();
        next
    }

    /// Computes rates until no point waits, then returns, so that the thread is free until the branch has its next
    /// point.
    fn work(&self) {
        let mut rates = self.rates.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        let (rates, found) = &mut *rates;
        while let Some((y, passed)) = self.next() {
            found.push(rates.at(&y, passed));
        }
    }
}

/// Runs `follow`, which follows a branch and reports its points; also returns their largest growth rates if `wanted`.
pub(super) fn with_rates<T>(
    branch: &mut Continuation<Cortex>,
    wanted: bool,
    follow: impl FnOnce(&mut Continuation<Cortex>, &mut TakeIn<'_>) -> T,
) -> (T, Vec<Option<f64>>) {
    if !wanted {
        return (follow(branch, &mut |_, _| {}), Vec::new());
    }
    let mut rates = FollowedRates::new(&branch.problem, branch.state.solution.m);
    if cfg!(target_family = "wasm") {
        // A page has one thread.
        let mut found = Vec::new();
        let out = follow(branch, &mut |y, passed| found.push(rates.at(y, passed)));
        return (out, found);
    }
    let queue = &Queue { waiting: Mutex::default(), rates: Mutex::new((rates, Vec::new())) };
    let out = rayon::in_place_scope(|scope| {
        follow(branch, &mut |y, passed| {
            if queue.add(y, passed) {
                scope.spawn(|_| queue.work());
            }
        })
    });
    let mut rates = queue.rates.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    (out, std::mem::take(&mut rates.1))
}

/// Assigns growth rates to the last points.
pub(super) fn put(rates: &[Option<f64>], points: &mut [ShapePoint]) {
    points.iter_mut().rev().zip(rates.iter().rev()).for_each(|(point, rate)| point.growth_rate = *rate);
}
