//! Growth rates of the points of a branch, computed concurrently: the branch does not wait for them.

use std::collections::VecDeque;
use std::sync::Mutex;

use furrow_bvp::{Continuation, Solution};

use super::hopf::{HopfPoint, RatesAlong};
use super::point::ShapePoint;
use crate::cortex::Cortex;

/// Receives the next shape of a branch, and the number of folds and pitchforks before it.
pub(super) type TakeIn<'a> = dyn FnMut(&Solution, usize, Shape) + 'a;

/// Kinds of shapes on a branch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shape {
    /// One of its points.
    Point,
    /// A fold or a pitchfork between two points.
    Event,
}

/// The largest growth rates of the points of a branch, and its Hopf points.
pub(super) type Rates = (Vec<Option<f64>>, Vec<HopfPoint>);

/// Points without growth rates yet. Each computation starts from the previous modes, so that only one thread at a time
/// works on them, in order.
struct Queue {
    waiting: Mutex<Waiting>,
    rates: Mutex<RatesAlong>,
}

#[derive(Default)]
struct Waiting {
    points: VecDeque<(Solution, usize, Shape)>,
    /// Whether a thread is working, which also takes points added meanwhile.
    at_work: bool,
}

impl Queue {
    /// Adds a point; returns whether a thread must be started.
    fn add(&self, y: &Solution, passed: usize, shape: Shape) -> bool {
        let mut waiting = self.waiting.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        waiting.points.push_back((y.clone(), passed, shape));
        !std::mem::replace(&mut waiting.at_work, true)
    }

    /// The next point, if there is one.
    fn next(&self) -> Option<(Solution, usize, Shape)> {
        let mut waiting = self.waiting.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        let next = waiting.points.pop_front();
        waiting.at_work = next.is_some();
        next
    }

    /// Computes rates until no point waits, then returns, so that the thread is free until the branch has its next
    /// point.
    fn work(&self) {
        let mut rates = self.rates.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        while let Some((y, passed, shape)) = self.next() {
            rates.take_in(y, passed, shape);
        }
    }
}

/// Runs `follow`, which follows a branch and reports its points; also returns their largest growth rates and the Hopf points of the
/// branch if `wanted`.
pub(super) fn with_rates<T>(
    branch: &mut Continuation<Cortex>,
    wanted: bool,
    follow: impl FnOnce(&mut Continuation<Cortex>, &mut TakeIn<'_>) -> T,
) -> (T, Rates) {
    if !wanted {
        return (follow(branch, &mut |_, _, _| {}), Rates::default());
    }
    let mut rates = RatesAlong::new(&branch.problem, branch.state.solution.m);
    if cfg!(target_family = "wasm") {
        // A page has one thread.
        let out = follow(branch, &mut |y, passed, shape| rates.take_in(y.clone(), passed, shape));
        return (out, (rates.found, rates.hopf));
    }
    let queue = &Queue { waiting: Mutex::default(), rates: Mutex::new(rates) };
    let out = rayon::in_place_scope(|scope| {
        follow(branch, &mut |y, passed, shape| {
            if queue.add(y, passed, shape) {
                scope.spawn(|_| queue.work());
            }
        })
    });
    let mut rates = queue.rates.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    (out, (std::mem::take(&mut rates.found), std::mem::take(&mut rates.hopf)))
}

/// Assigns growth rates to the last points.
pub(super) fn put(rates: &[Option<f64>], points: &mut [ShapePoint]) {
    points.iter_mut().rev().zip(rates.iter().rev()).for_each(|(point, rate)| point.growth_rate = *rate);
}
