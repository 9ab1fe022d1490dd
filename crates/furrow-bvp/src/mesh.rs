//! Meshes: equidistribution of a monitor, defect of a solution.

use crate::dense::weighted_maximum;
use crate::direction::Direction;
use crate::gauss::{Gauss, MAX_STAGES};
use crate::invalid::{self, InvalidInput};
use crate::problem::{BoundaryValueProblem, CollocationPoints};
use crate::solution::Solution;

/// Checks that nodes are a mesh: at least two, finite and increasing.
///
/// # Errors
/// [`InvalidInput::ShortMesh`] or [`InvalidInput::Mesh`].
pub fn check(nodes: &[f64]) -> Result<(), InvalidInput> {
    invalid::mesh(nodes)
}

/// n equal intervals on [from, to].
pub fn uniform(from: f64, to: f64, n: usize) -> Vec<f64> {
    (0..=n).map(|i| if i == n { to } else { from + (to - from) * i as f64 / n as f64 }).collect()
}

/// The mesh with every interval cut in two.
pub fn halved(mesh: &[f64]) -> Vec<f64> {
    let mut out = Vec::with_capacity(2 * mesh.len());
    for pair in mesh.windows(2) {
        out.extend([pair[0], 0.5 * (pair[0] + pair[1])]);
    }
    out.extend(mesh.last());
    out
}

/// The mesh with every interval cut into the given number of equal parts.
pub fn subdivided(mesh: &[f64], parts: usize) -> Vec<f64> {
    let mut out = Vec::new();
    for pair in mesh.windows(2) {
        out.extend((0..parts).map(|k| pair[0] + (pair[1] - pair[0]) * k as f64 / parts as f64));
    }
    out.extend(mesh.last());
    out
}

/// A mesh of `n` intervals on which the piecewise constant monitor `weight` (one positive value per interval of `mesh`)
/// has equal integrals. Without an interval or a monitor it is `mesh` itself.
pub fn equidistribute(mesh: &[f64], weight: &[f64], n: usize, out: &mut Vec<f64>) {
    let total: f64 = mesh.windows(2).zip(weight).map(|(x, w)| (x[1] - x[0]) * w).sum();
    out.clear();
    if mesh.len() < 2 || weight.is_empty() {
        return out.extend_from_slice(mesh);
    }
    let weight = &weight[..weight.len().min(mesh.len() - 1)];
    out.push(mesh[0]);
    let (mut i, mut done) = (0, 0.0);
    for k in 1..n {
        let target = total * k as f64 / n as f64;
        while i + 1 < weight.len() && done + (mesh[i + 1] - mesh[i]) * weight[i] < target {
            done += (mesh[i + 1] - mesh[i]) * weight[i];
            i += 1;
        }
        out.push(mesh[i] + ((target - done) / weight[i]).min(mesh[i + 1] - mesh[i]));
    }
    out.push(mesh[mesh.len() - 1]);
}

/// Largest over mean integral of the monitor over the intervals: 1 on an equidistributing mesh.
pub fn imbalance(mesh: &[f64], weight: &[f64]) -> f64 {
    let parts = mesh.windows(2).zip(weight).map(|(x, w)| (x[1] - x[0]) * w);
    let (largest, total) = parts.fold((0.0, 0.0), |(l, t): (f64, f64), p| (l.max(p), t + p));
    largest * weight.len() as f64 / total
}

/// The mesh of as many intervals that equidistributes the monitor, if the largest interval carries more than `above` times
/// its share; `None` if the monitor is not finite.
pub fn rebalanced(mesh: &[f64], weight: &[f64], above: f64) -> Option<Vec<f64>> {
    let imbalance = imbalance(mesh, weight);
    if !(imbalance > above && imbalance.is_finite()) {
        return None;
    }
    let mut grid = Vec::new();
    equidistribute(mesh, weight, weight.len(), &mut grid);
    // Where the monitor is extreme, nodes may coincide within rounding.
    check(&grid).is_ok().then_some(grid)
}

/// Where [`defect`] is sampled: as many points as stages in every interval.
pub(crate) fn samples(gauss: &Gauss, mesh: &[f64]) -> Vec<f64> {
    let m = gauss.m;
    let theta = |k: usize| if k < m { 0.5 * (gauss.c[k - 1] + gauss.c[k]) } else { 0.5 * gauss.c[0] };
    mesh.windows(2).flat_map(|x| (1..=m).map(move |k| x[0] + theta(k) * (x[1] - x[0]))).collect()
}

/// Largest defect |u′ − f(u)| · h / (1 + |u|) (N.6) of the collocation polynomial u on every interval of width h, sampled midway
/// between neighbouring Gauss points, and midway between the left node and the first of them. (At the Gauss points
/// themselves it is zero.) It is infinite where f is not a number, and everywhere if `y` does not fit the problem.
pub fn defect<P: BoundaryValueProblem>(gauss: &Gauss, problem: &mut P, y: &Solution) -> Vec<f64> {
    match residuals(gauss, problem, y) {
        Some([residuals, values]) => largest_of_intervals(y, &residuals, &values),
        None => vec![f64::INFINITY; y.intervals()],
    }
}

/// [`defect`] of a direction at `y`, of the linearised equation: |d′ − f′(u)d| · h / (1 + |u|) where |d| / (1 + |u|) is 1 at most.
pub(crate) fn direction_defect<P: BoundaryValueProblem>(
    gauss: &Gauss,
    problem: &mut P,
    y: &Solution,
    direction: &Direction,
) -> Vec<f64> {
    // Rounding and truncation are about alike.
    const SHARE: f64 = 1e-5;
    let mut at = |share: f64| {
        let mut moved = y.clone();
        direction.apply(share / direction.norm(y), &mut moved);
        residuals(gauss, problem, &moved)
    };
    let sides = [SHARE, -SHARE].map(&mut at);
    problem.prepare(&y.scalars);
    let [Some([mut ahead, values]), Some([behind, _])] = sides else { return vec![f64::INFINITY; y.intervals()] };
    ahead.iter_mut().zip(&behind).for_each(|(ahead, behind)| *ahead = (*ahead - behind) / (2.0 * SHARE));
    largest_of_intervals(y, &ahead, &values)
}

/// The largest residual over 1 + |value| of every interval, infinite where it is not a number.
fn largest_of_intervals(y: &Solution, residuals: &[f64], values: &[f64]) -> Vec<f64> {
    let width = y.m * y.components;
    let intervals = residuals.chunks_exact(width).zip(values.chunks_exact(width));
    intervals.map(|(r, v)| weighted_maximum(r, v)).map(|r| if r.is_nan() { f64::INFINITY } else { r }).collect()
}

/// (u′ − f(u)) h where the defect is sampled, and u there. None if `y` does not fit the problem.
fn residuals<P: BoundaryValueProblem>(gauss: &Gauss, problem: &mut P, y: &Solution) -> Option<[Vec<f64>; 2]> {
    let dims = problem.dimensions();
    if y.fits(dims).is_err() || gauss.m != y.m {
        return None;
    }
    problem.prepare(&y.scalars);
    let (n, m) = (y.components, y.m);
    let points = y.intervals() * m;
    let (x, mut values, mut slopes) = (samples(gauss, &y.mesh), vec![0.0; points * n], vec![0.0; points * n]);
    let [mut basis, mut slope] = [[0.0; MAX_STAGES + 1]; 2];
    for k in 0..m {
        let theta = (x[k] - y.mesh[0]) / (y.mesh[1] - y.mesh[0]);
        gauss.basis(theta, &mut basis[..=m]);
        gauss.basis_derivative(theta, &mut slope[..=m]);
        for i in 0..y.intervals() {
            let point = (i * m + k) * n..(i * m + k + 1) * n;
            y.combine(i, &basis, &mut values[point.clone()]);
            y.combine(i, &slope, &mut slopes[point]);
        }
    }
    let (mut f, mut g) = (vec![0.0; points * n], vec![0.0; points * dims.integrals]);
    problem.rhs_many(CollocationPoints { first: 0, x: &x, y: &values }, &y.scalars, &mut f, &mut g);
    for (x, (slopes, f)) in y.mesh.windows(2).zip(slopes.chunks_exact_mut(m * n).zip(f.chunks_exact(m * n))) {
        slopes.iter_mut().zip(f).for_each(|(slope, f)| *slope -= (x[1] - x[0]) * f);
    }
    Some([slopes, values])
}

/// The error of a number found on a mesh, of order 2m, from its change where the intervals are halved.
pub fn error_of_change(change: f64, m: usize) -> f64 {
    change.abs() / (1.0 - 0.25f64.powi(m as i32))
}

/// Monitor for [`equidistribute`] from the defect: proportional to defect^(1/(m+1)) per unit length, bounded below by a
/// fraction of its mean so that no region is left empty.
pub fn defect_monitor(mesh: &[f64], defect: &[f64], m: usize, weight: &mut Vec<f64>) {
    weight.clear();
    weight.extend(mesh.windows(2).zip(defect).map(|(x, d)| d.max(1e-300).powf(1.0 / (m as f64 + 1.0)) / (x[1] - x[0])));
    let (Some(first), Some(last)) = (mesh.first(), mesh.last()) else { return };
    let length = last - first;
    let mean = mesh.windows(2).zip(weight.iter()).map(|(x, w)| (x[1] - x[0]) * w).sum::<f64>() / length;
    for w in weight.iter_mut() {
        *w = 0.5 * (*w + mean);
    }
}

/// Intervals of an equidistributing mesh with defects below `tolerance`: a defect is proportional to h^(m+1), so that
/// Σ defect^(1/(m+1)) does not depend on the mesh. The monitor leaves half of the intervals to regions of small defects.
pub(crate) fn intervals_for(defects: &[f64], m: usize, tolerance: f64) -> usize {
    let order = 1.0 / (m as f64 + 1.0);
    let sum: f64 = defects.iter().map(|d| d.powf(order)).sum();
    // A float beyond the largest index becomes that one.
    (2.0 * sum * tolerance.powf(-order)).ceil() as usize
}

/// The mesh of `intervals` that have equal shares of the defects.
pub(crate) fn redistributed(mesh: &[f64], defects: &[f64], m: usize, intervals: usize) -> Vec<f64> {
    let (mut weight, mut grid) = (Vec::new(), Vec::new());
    if defects.iter().all(|defect| defect.is_finite()) {
        defect_monitor(mesh, defects, m, &mut weight);
    } else {
        // The right-hand side is not defined somewhere between the stages: that says nothing of a better mesh.
        weight.extend(mesh.windows(2).map(|x| 1.0 / (x[1] - x[0])));
    }
    equidistribute(mesh, &weight, intervals, &mut grid);
    grid
}

/// A redistributed mesh is worth another try with as many intervals if the last one brought the defect down to this
/// fraction.
const PROGRESS: f64 = 0.5;

/// Largest growth of the number of intervals from one mesh to the next: a coarse mesh gives a rough estimate only.
const GROWTH: usize = 2;

/// Numbers of intervals from mesh to mesh, until the defect is below a tolerance.
pub(crate) struct Refinement {
    tolerance: f64,
    limit: usize,
    /// The defect on the last mesh, if that had as many intervals.
    before: Option<f64>,
}

impl Refinement {
    pub fn new(tolerance: f64, limit: usize) -> Refinement {
        Refinement { tolerance, limit, before: None }
    }

    /// Intervals of the next mesh after one with these defects; `None` if more are not allowed and the same number does not help.
    pub fn next(&mut self, defects: &[f64], m: usize) -> Option<usize> {
        let (intervals, defect) = (defects.len(), defects.iter().copied().fold(0.0, f64::max));
        // A defect that is infinite twice is no progress either.
        let stagnates = self.before.is_some_and(|before| defect > PROGRESS * before || !defect.is_finite());
        if intervals >= self.limit && stagnates {
            return None;
        }
        let needed = if stagnates { usize::MAX } else { intervals_for(defects, m, self.tolerance) };
        let next = needed.clamp(intervals, GROWTH * intervals).min(self.limit.max(intervals));
        // More intervals are a new beginning: there may be no progress yet where the first layers come into sight.
        self.before = (next == intervals).then_some(defect);
        Some(next)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refinement_ends_on_a_defect_that_stays_infinite() {
        let mut refinement = Refinement::new(1e-3, 4);
        assert_eq!(
            [3, 4, 4].map(|intervals| refinement.next(&vec![f64::INFINITY; intervals], 4)),
            [Some(4), Some(4), None]
        );
    }

    #[test]
    fn equidistributes_a_step() {
        let mesh = uniform(0.0, 1.0, 10);
        let weight: Vec<f64> = (0..10).map(|i| if i < 5 { 3.0 } else { 1.0 }).collect();
        let mut out = Vec::new();
        equidistribute(&mesh, &weight, 8, &mut out);
        assert_eq!(out.len(), 9);
        for (i, x) in out.iter().enumerate() {
            let expected = if i <= 6 { i as f64 / 12.0 } else { 0.5 + (i as f64 - 6.0) / 4.0 };
            assert!((x - expected).abs() < 1e-14, "{i}: {x} {expected}");
        }
    }
}
