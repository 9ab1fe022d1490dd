//! Meshes: equidistribution of a monitor, defect of a solution.

use crate::dense::weighted_maximum;
use crate::direction::Direction;
use crate::gauss::{Gauss, MAX_STAGES};
use crate::invalid::{self, InvalidInput};
use crate::problem::{BoundaryValueProblem, CollocationPoints};
use crate::solution::Solution;

/// The narrowest interval, relative to the largest node.
const NARROWEST: f64 = 64.0 * f64::EPSILON;

/// Checks that nodes are a mesh: at least two, finite and increasing.
///
/// # Errors
/// [`InvalidInput::ShortMesh`] or [`InvalidInput::Mesh`].
pub fn check(nodes: &[f64]) -> Result<(), InvalidInput> {
    invalid::mesh(nodes)
}

/// Whether all intervals are so wide that the numbers of a mesh can be told apart within them.
pub(crate) fn is_distinct(nodes: &[f64]) -> bool {
    let least = NARROWEST * nodes.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    check(nodes).is_ok() && nodes.windows(2).all(|x| x[1] - x[0] >= least)
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
    is_distinct(&grid).then_some(grid)
}

/// Where in an interval [`defect`] is sampled: at as many places as there are stages.
fn places(gauss: &Gauss) -> Vec<f64> {
    let m = gauss.m;
    (1..=m).map(|k| if k < m { 0.5 * (gauss.c[k - 1] + gauss.c[k]) } else { 0.5 * gauss.c[0] }).collect()
}

/// All points at which [`defect`] is sampled.
pub(crate) fn samples(gauss: &Gauss, mesh: &[f64]) -> Vec<f64> {
    at_places(&places(gauss), mesh)
}

fn at_places(places: &[f64], mesh: &[f64]) -> Vec<f64> {
    let mut all = Vec::with_capacity(mesh.len() * places.len());
    for x in mesh.windows(2) {
        all.extend(places.iter().map(|theta| x[0] + theta * (x[1] - x[0])));
    }
    all
}

/// Largest defect |u′ − f(u)| · h / (1 + |u|) (N.6) of the collocation polynomial u on every interval of width h, sampled midway
/// between neighbouring Gauss points, and midway between the left node and the first of them. (At the Gauss points
/// themselves it is zero.) It is infinite where f is not a number, and everywhere if `y` does not fit the problem.
pub fn defect(gauss: &Gauss, problem: &mut dyn BoundaryValueProblem, y: &Solution) -> Vec<f64> {
    match residuals(&places(gauss), gauss, problem, y) {
        Some([residuals, values]) => largest_of_intervals(y, &residuals, &values),
        None => vec![f64::INFINITY; y.intervals()],
    }
}

/// So far from a node, as a share of the interval, f counts as its value at this side of the node.
const BESIDE: f64 = 1e-7;

/// (u′ − f(u)) h beside both nodes of every interval, N × 2 × n, and its largest size over 1 + |u| in every interval.
pub(crate) fn beside_nodes(
    gauss: &Gauss,
    problem: &mut dyn BoundaryValueProblem,
    y: &Solution,
) -> Option<[Vec<f64>; 2]> {
    let [residuals, values] = residuals(&[BESIDE, 1.0 - BESIDE], gauss, problem, y)?;
    let largest = largest_of_intervals(y, &residuals, &values);
    Some([residuals, largest])
}

/// Halvings of the distance from a node at which [`missed`] looks.
const HALVINGS: usize = 24;

/// For every interval, the integral of |u′ − f(u)| between a node and the nearest Gauss point, and the largest |u′ − f(u)| h there, over
/// 1 + |u|. [`defect`] samples too little of these gaps to find a jump of f there, which would change the solution by this integral.
pub(crate) fn missed(gauss: &Gauss, problem: &mut dyn BoundaryValueProblem, y: &Solution) -> Vec<[f64; 2]> {
    let gap = gauss.c[0];
    let distance = |k: usize| gap * 0.75 * 0.5f64.powi(k as i32);
    let places: Vec<f64> = (0..HALVINGS).flat_map(|k| [distance(k), 1.0 - distance(k)]).collect();
    let Some([residuals, values]) = residuals(&places, gauss, problem, y) else {
        return vec![[f64::INFINITY; 2]; y.intervals()];
    };
    let (n, width) = (y.components, 2 * HALVINGS * y.components);
    let of_interval = |(residuals, values): (&[f64], &[f64])| {
        let (mut integral, mut largest) = (vec![0.0; n], 0.0f64);
        for (k, (residual, value)) in residuals.iter().zip(values).enumerate() {
            // A place at distance d represents distances from 2d/3 to 4d/3.
            let (size, share) = (residual.abs() / (1.0 + value.abs()), distance(k / n / 2) / 1.5);
            if size.is_finite() {
                integral[k % n] += share * size;
                largest = largest.max(size);
            }
        }
        [integral.into_iter().fold(0.0, f64::max), largest]
    };
    residuals.chunks_exact(width).zip(values.chunks_exact(width)).map(of_interval).collect()
}

/// A disturbance g of u′ = f(u) times `scale` h at some places of every interval: as smooth as can be, and without any symmetry that
/// would leave an eigenvector out of its response.
pub(crate) fn disturbance(places: &[f64], y: &Solution, scale: f64) -> Vec<f64> {
    let (from, to) = (y.mesh[0], y.mesh[y.intervals()]);
    let at = |(k, x): (usize, f64)| {
        let (i, length) = (k / places.len(), to - from);
        let g = scale * (y.mesh[i + 1] - y.mesh[i]) * (0.5 + (x - from) / length) / length;
        (0..y.components).map(move |c| (1.0 + 0.37 * c as f64) * g)
    };
    at_places(places, &y.mesh).into_iter().enumerate().flat_map(at).collect()
}

/// [`defect`] of a direction at `y`, of the linearised equation: |d′ − f′(u)d − g| · h / (1 + |u|) where |d| / (1 + |u|) is 1 at most.
/// The number with the direction is the scale of the [`disturbance`] g that it responds to.
pub(crate) fn direction_defect(
    gauss: &Gauss,
    problem: &mut dyn BoundaryValueProblem,
    y: &Solution,
    (direction, disturbed): (&Direction, f64),
) -> Vec<f64> {
    // Rounding and truncation are about alike.
    const SHARE: f64 = 1e-5;
    let norm = direction.norm(y);
    let mut at = |share: f64| {
        let mut moved = y.clone();
        direction.apply(share / norm, &mut moved);
        residuals(&places(gauss), gauss, problem, &moved)
    };
    let sides = [SHARE, -SHARE].map(&mut at);
    problem.prepare(&y.scalars);
    let [Some([mut ahead, values]), Some([behind, _])] = sides else { return vec![f64::INFINITY; y.intervals()] };
    let disturbance = disturbance(&places(gauss), y, disturbed / norm);
    for (ahead, (behind, g)) in ahead.iter_mut().zip(behind.iter().zip(disturbance)) {
        *ahead = (*ahead - behind) / (2.0 * SHARE) - g;
    }
    largest_of_intervals(y, &ahead, &values)
}

/// The largest residual over 1 + |value| of every interval, infinite where it is not a number.
fn largest_of_intervals(y: &Solution, residuals: &[f64], values: &[f64]) -> Vec<f64> {
    let width = residuals.len() / y.intervals().max(1);
    let intervals = residuals.chunks_exact(width).zip(values.chunks_exact(width));
    intervals.map(|(r, v)| weighted_maximum(r, v)).map(|r| if r.is_nan() { f64::INFINITY } else { r }).collect()
}

/// (u′ − f(u)) h at some places of every interval, and u there. None if `y` does not fit the problem.
fn residuals(
    places: &[f64],
    gauss: &Gauss,
    problem: &mut dyn BoundaryValueProblem,
    y: &Solution,
) -> Option<[Vec<f64>; 2]> {
    let dims = problem.dimensions();
    if y.fits(dims).is_err() || gauss.m != y.m {
        return None;
    }
    problem.prepare(&y.scalars);
    let (n, m, count) = (y.components, y.m, places.len());
    let points = y.intervals() * count;
    let (x, mut values, mut slopes) = (at_places(places, &y.mesh), vec![0.0; points * n], vec![0.0; points * n]);
    let [mut basis, mut slope] = [[0.0; MAX_STAGES + 1]; 2];
    for k in 0..count {
        let theta = (x[k] - y.mesh[0]) / (y.mesh[1] - y.mesh[0]);
        gauss.basis(theta, &mut basis[..=m]);
        gauss.basis_derivative(theta, &mut slope[..=m]);
        for i in 0..y.intervals() {
            let point = (i * count + k) * n..(i * count + k + 1) * n;
            y.interpolate(i, &basis, &mut values[point.clone()]);
            y.interpolate(i, &slope, &mut slopes[point]);
        }
    }
    let (mut f, mut g) = (vec![0.0; points * n], vec![0.0; points * dims.integrals]);
    problem.rhs_many(CollocationPoints { first: 0, x: &x, y: &values }, &y.scalars, &mut f, &mut g);
    for (x, (slopes, f)) in y.mesh.windows(2).zip(slopes.chunks_exact_mut(count * n).zip(f.chunks_exact(count * n))) {
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
    monitor_above(0.5, mesh, defect, m, weight);
}

/// [`defect_monitor`] that leaves the fraction `floor` of all intervals to the length.
fn monitor_above(floor: f64, mesh: &[f64], defect: &[f64], m: usize, weight: &mut Vec<f64>) {
    weight.clear();
    weight.extend(mesh.windows(2).zip(defect).map(|(x, d)| d.max(1e-300).powf(1.0 / (m as f64 + 1.0)) / (x[1] - x[0])));
    let (Some(first), Some(last)) = (mesh.first(), mesh.last()) else { return };
    let length = last - first;
    let mean = mesh.windows(2).zip(weight.iter()).map(|(x, w)| (x[1] - x[0]) * w).sum::<f64>() / length;
    for w in weight.iter_mut() {
        *w = (1.0 - floor) * *w + floor * mean;
    }
}

/// Share of the intervals of a [`redistributed`] mesh that goes by length.
const FLOOR: f64 = 0.2;

/// Intervals beyond those that the largest defect asks for: the next mesh follows the defects of this one, and not yet its own.
const MARGIN: f64 = 1.3;

/// Intervals of a [`redistributed`] mesh with defects below `tolerance`. A defect is proportional to h^(m+1), so that
/// Σ defect^(1/(m+1)) does not depend on the mesh; the largest defect is where the monitor, before its floor, is largest.
pub(crate) fn intervals_for(mesh: &[f64], defects: &[f64], m: usize, tolerance: f64) -> usize {
    let order = 1.0 / (m as f64 + 1.0);
    let (mut sum, mut peak) = (0.0, 0.0f64);
    for (x, defect) in mesh.windows(2).zip(defects) {
        let part = defect.powf(order);
        (sum, peak) = (sum + part, peak.max(part / (x[1] - x[0])));
    }
    if peak.is_infinite() {
        return usize::MAX;
    }
    let mean = sum / (mesh[mesh.len() - 1] - mesh[0]);
    let needed = sum * tolerance.powf(-order) * peak / ((1.0 - FLOOR) * peak + FLOOR * mean);
    // A float beyond the largest index becomes that one; no defect at all, 0.
    (MARGIN * needed).ceil() as usize
}

/// A mesh of `intervals` that have equal shares of the defects, and of more where neighbours would differ too much in width,
/// but for meshes of more than `most`.
pub(crate) fn redistributed(mesh: &[f64], defects: &[f64], m: usize, intervals: usize, most: usize) -> Vec<f64> {
    let (mut weight, mut grid) = (Vec::new(), Vec::new());
    if defects.iter().all(|defect| defect.is_finite()) {
        monitor_above(FLOOR, mesh, defects, m, &mut weight);
    } else {
        // The right-hand side is not defined somewhere between the stages: that says nothing of a better mesh.
        weight.extend(mesh.windows(2).map(|x| 1.0 / (x[1] - x[0])));
    }
    equidistribute(mesh, &weight, intervals, &mut grid);
    let graded = graded(&grid);
    if graded.len() <= most.saturating_add(1) { graded } else { grid }
}

/// Largest ratio of the widths of neighbouring intervals.
const RATIO: f64 = 2.0;

/// The mesh with intervals halved towards narrower neighbours until the widths of neighbours differ at most by [`RATIO`]. On a wide
/// interval next to a layer, collocation hardly damps the fast component of the solution: it oscillates, and the mesh would follow
/// the defect of these oscillations.
fn graded(mesh: &[f64]) -> Vec<f64> {
    /// Appends what lies between two places, next to intervals of these widths.
    fn halve(out: &mut Vec<f64>, [from, to]: [f64; 2], [left, right]: [f64; 2]) {
        let (half, least) = (0.5 * (to - from), left.min(right));
        let middle = from + half;
        if 2.0 * half > RATIO * least && from < middle && middle < to {
            halve(out, [from, middle], [left, least + half]);
            halve(out, [middle, to], [least + half, right]);
        } else {
            out.push(to);
        }
    }
    let width = |i: usize| mesh.get(i..i + 2).map_or(f64::INFINITY, |x| x[1] - x[0]);
    let mut out = mesh[..1].to_vec();
    for (i, x) in mesh.windows(2).enumerate() {
        halve(&mut out, [x[0], x[1]], [width(i.wrapping_sub(1)), width(i + 1)]);
    }
    out
}

/// The mesh with every interval cut into as many equal parts as `parts` says.
pub(crate) fn cut(mesh: &[f64], parts: impl Fn(usize) -> usize) -> Vec<f64> {
    let mut grid = mesh[..1].to_vec();
    for (i, pair) in mesh.windows(2).enumerate() {
        grid.extend(&subdivided(pair, parts(i))[1..]);
    }
    grid
}

/// By how much the components change within every interval: the largest share of its whole range that any of them passes.
fn changes(y: &Solution) -> Vec<f64> {
    let (n, m) = (y.components, y.m);
    let span = |values: &mut dyn Iterator<Item = f64>| {
        let [least, most] = values.fold([f64::INFINITY, -f64::INFINITY], |[a, b], v| [a.min(v), b.max(v)]);
        most - least
    };
    let mut all = vec![0.0f64; y.intervals()];
    for c in 0..n {
        let range = span(&mut y.nodes.iter().chain(&y.stages).skip(c).step_by(n).copied());
        for (i, change) in all.iter_mut().enumerate() {
            let stages = &y.stages[i * m * n..(i + 1) * m * n];
            let within = span(&mut y.nodes[i * n..(i + 2) * n].iter().chain(stages).skip(c).step_by(n).copied());
            *change = change.max(within / range.max(f64::MIN_POSITIVE));
        }
    }
    all
}

/// Where a defect is larger, a layer is too thin for the mesh to see. The solution then oscillates all over the interval, damped
/// little from one end of an interval to the other, and its defects do not tell where the layer is.
const UNSEEN: f64 = 10.0;

/// Where the search does not lead on, it halves the intervals of larger defects.
const BAD: f64 = 0.1;

/// Parts into which the search for a layer cuts intervals.
const PARTS: usize = 6;

/// A redistributed mesh is worth another try with as many intervals if the last one brought the defect down to this
/// fraction.
const PROGRESS: f64 = 0.5;

/// Largest growth of the number of intervals from one mesh to the next: a coarse mesh gives a rough estimate only.
const GROWTH: usize = 4;

/// Meshes, until the defect is below a tolerance.
pub(crate) struct Refinement {
    tolerance: f64,
    limit: usize,
    /// Intervals and defect of the last mesh, if that was redistributed.
    before: Option<(usize, f64)>,
    /// Where the search for a layer has cut intervals.
    searched: Option<[f64; 2]>,
}

impl Refinement {
    pub fn new(tolerance: f64, limit: usize) -> Refinement {
        Refinement { tolerance, limit, before: None, searched: None }
    }

    /// The next mesh after a solution with these defects; `None` if more intervals are not allowed and the same number does not
    /// help.
    pub fn next(&mut self, y: &Solution, defects: &[f64]) -> Option<Vec<f64>> {
        let (intervals, defect) = (y.intervals(), defects.iter().copied().fold(0.0, f64::max));
        let room = self.limit.max(intervals);
        // With more intervals there may be no progress yet where the first layers come into sight.
        let (again, goal) = match self.before.take() {
            Some((last, before)) if last == intervals => (true, PROGRESS * before),
            Some((_, before)) => (false, before),
            None => (false, f64::INFINITY),
        };
        // A defect that is infinite twice is no progress either.
        let stagnates = defect > goal || (again && !defect.is_finite());
        if again && stagnates && intervals >= self.limit {
            return None;
        }
        if defect > UNSEEN && defect.is_finite() {
            let grid = self.toward_layer(y, defects);
            if grid.len() <= room {
                return Some(grid);
            }
        }
        self.before = Some((intervals, defect));
        let needed = intervals_for(&y.mesh, defects, y.m, self.tolerance).clamp(intervals, GROWTH * intervals);
        let next = if stagnates { 2 * intervals } else { needed };
        Some(redistributed(&y.mesh, defects, y.m, next.min(room), room))
    }

    /// The mesh with more intervals where the solution changes most, and next to it, as long as that leads on; then with all
    /// intervals halved that have too large a defect.
    fn toward_layer(&mut self, y: &Solution, defects: &[f64]) -> Vec<f64> {
        let changes = changes(y);
        // Changes that differ by rounding are alike: the first of them.
        let most = changes.iter().copied().fold(0.0, f64::max) * (1.0 - 1e-9);
        let at = changes.iter().position(|change| *change >= most).unwrap_or(0);
        let leads_on = |[from, to]: [f64; 2]| y.mesh[at] >= from && y.mesh[at + 1] <= to;
        if !self.searched.take().is_none_or(leads_on) {
            return cut(&y.mesh, |i| if defects[i] > BAD { 2 } else { 1 });
        }
        let (from, to) = (at.saturating_sub(1), (at + 2).min(y.intervals()));
        self.searched = Some([y.mesh[from], y.mesh[to]]);
        cut(&y.mesh, |i| if (from..to).contains(&i) { PARTS } else { 1 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refinement_ends_on_a_defect_that_stays_infinite() {
        let mut refinement = Refinement::new(1e-3, 4);
        let mut next = |intervals: usize| {
            let y = Solution::constant(4, &uniform(0.0, 1.0, intervals), &[1.0], &[]);
            refinement.next(&y, &vec![f64::INFINITY; intervals]).map(|mesh| mesh.len() - 1)
        };
        assert_eq!([3, 4, 4].map(&mut next), [Some(4), Some(4), None]);
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
