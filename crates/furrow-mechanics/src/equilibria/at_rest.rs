//! Shapes at which a cell rests undivided: exact intervals of ξ_s between the folds, pitchforks and Hopf points of the
//! branch that starts at the passive shape.
//!
//! Stability changes at these points alone, so that whole segments between them are stable or unstable. If a shape
//! becomes unstable by oscillation and the Hopf point is not located, the interval ends between the two points of the
//! branch that show it.

use serde::Serialize;

use super::branch::{BranchEvent, BranchOptions, Criticality};
use super::error::Result;
use super::hopf::HopfPoint;
use super::point::ShapePoint;
use super::primary;
use furrow_cell::{Cell, Numerics};

/// A point in a phase diagram at which stability changes.
#[expect(missing_docs, reason = "as at `Pitchfork`, `FoldPoint` and `HopfPoint`")]
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[non_exhaustive]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Edge {
    /// The mirror symmetry breaks.
    Pitchfork { xi_s: f64, criticality: Criticality },
    /// The branch turns.
    Fold { xi_s: f64, maximum: bool },
    /// Shapes begin or cease to oscillate.
    Hopf { xi_s: f64, period: f64 },
    /// The mirror symmetry of bent states breaks.
    BentPitchfork { xi_s: f64 },
    /// The bent states turn.
    BentFold { xi_s: f64 },
}

impl Edge {
    /// Its ξ_s.
    pub fn xi_s(&self) -> f64 {
        let (Edge::Pitchfork { xi_s, .. }
        | Edge::Fold { xi_s, .. }
        | Edge::Hopf { xi_s, .. }
        | Edge::BentPitchfork { xi_s }
        | Edge::BentFold { xi_s }) = self;
        *xi_s
    }
}

/// The stable part of the branch of one cell.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct RestShapes {
    /// Intervals of ξ_s with a stable shape, in order along the branch.
    pub intervals: Vec<[f64; 2]>,
    /// Folds and pitchforks in order along the branch, then its Hopf points.
    pub edges: Vec<Edge>,
}

impl RestShapes {
    /// Whether there is a stable shape at ξ_s.
    pub fn contains(&self, xi_s: f64) -> bool {
        self.intervals.iter().any(|[low, high]| (*low..=*high).contains(&xi_s))
    }
}

/// The stable shapes on the primary branch of a cell for ξ_s from 0 to `xi_max`.
///
/// # Errors
/// [`ShapeError`](super::ShapeError) if the branch cannot be followed.
pub fn rest_shapes(cell: &Cell, numerics: &Numerics, xi_max: f64) -> Result<RestShapes> {
    let options = BranchOptions { xi: [0.0, xi_max], growth_rates: true, ..BranchOptions::default() };
    let branch = primary::follow(cell, numerics, &options, |_| true)?;
    let edge = |event: &BranchEvent| match event {
        BranchEvent::Pitchfork(p) => Edge::Pitchfork { xi_s: p.point.xi_s, criticality: p.criticality() },
        BranchEvent::Fold(f) => Edge::Fold { xi_s: f.point.xi_s, maximum: f.maximum },
    };
    let mut edges: Vec<Edge> = branch.events.iter().map(edge).collect();
    let intervals = stable_intervals(&edges, &branch.points, &branch.hopf);
    edges.extend(branch.hopf.iter().map(|hopf| Edge::Hopf { xi_s: hopf.point.xi_s, period: hopf.period }));
    Ok(RestShapes { intervals, edges })
}

/// Growth rates closer to zero than this, in 1/τ, belong to an edge, and may have either sign next to it.
const MARGINAL: f64 = 1e-3;

/// The stable parts of every segment between two folds or pitchforks. Hopf points divide a segment into stable and unstable
/// parts. A segment without them is judged by its middle point; one shorter than a step has no point and is left to divisions.
fn stable_intervals(edges: &[Edge], points: &[ShapePoint], hopf: &[HopfPoint]) -> Vec<[f64; 2]> {
    let ends: Vec<f64> = edges.iter().map(Edge::xi_s).collect();
    let [Some(first), Some(last)] = [points.first(), points.last()] else { return Vec::new() };
    let stable = |segment: usize| {
        let from = if segment == 0 { first.xi_s } else { ends[segment - 1] };
        let to = ends.get(segment).copied().unwrap_or(last.xi_s);
        let mut within: Vec<&HopfPoint> = hopf.iter().filter(|hopf| hopf.point.passed == segment).collect();
        within.sort_by(|a, b| (a.point.xi_s - from).abs().total_cmp(&(b.point.xi_s - from).abs()));
        if within.is_empty() {
            let inside: Vec<&ShapePoint> = points.iter().filter(|point| point.passed == segment).collect();
            return stable_around_middle(&inside, [from, to]).into_iter().collect();
        }
        // The part before a Hopf point is stable if the oscillation grows beyond it, and the part after it otherwise.
        let mut parts = Vec::new();
        let mut start = within[0].grows.then_some(from);
        for hopf in within {
            let at = hopf.point.xi_s;
            if hopf.grows {
                parts.extend(start.take().map(|start| [start, at]));
            } else {
                start = Some(at);
            }
        }
        parts.extend(start.map(|start| [start, to]));
        parts
    };
    (0..=edges.len()).flat_map(stable).map(|[a, b]| [a.min(b), a.max(b)]).collect()
}

/// The part of a segment around the middle of its points, if this one is stable.
fn stable_around_middle(inside: &[&ShapePoint], [from, to]: [f64; 2]) -> Option<[f64; 2]> {
    let middle = inside.len() / 2;
    inside.get(middle)?.growth_rate.filter(|rate| *rate < 0.0)?;
    let before: Vec<&ShapePoint> = inside[..=middle].iter().rev().copied().collect();
    Some([oscillates_at(&before).unwrap_or(from), oscillates_at(&inside[middle..]).unwrap_or(to)])
}

/// The ξ_s at which stability is clearly lost along points that begin with a stable one: without a fold or a pitchfork,
/// by a pair of complex rates, as a cue can cause. The rate is interpolated linearly between the two points.
fn oscillates_at(points: &[&ShapePoint]) -> Option<f64> {
    points.windows(2).find_map(|pair| {
        let [a, b] = [pair[0].growth_rate?, pair[1].growth_rate?];
        (a < 0.0 && b > MARGINAL).then(|| pair[0].xi_s + (pair[1].xi_s - pair[0].xi_s) * a / (a - b))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(passed: usize, xi_s: f64, growth_rate: f64) -> ShapePoint {
        ShapePoint { xi_s, passed, growth_rate: Some(growth_rate), ..ShapePoint::default() }
    }

    #[test]
    fn intervals_of_an_s_shaped_branch() {
        let fold = |xi_s, maximum| Edge::Fold { xi_s, maximum };
        let pitchfork = Edge::Pitchfork { xi_s: 6.24, criticality: Criticality::Subcritical };
        let edges = [fold(6.14, true), fold(3.9, false), pitchfork, fold(6.6, true)];
        let points = [
            point(0, 0.0, -3.0),
            point(0, 3.0, -1.0),
            point(0, 6.0, -0.2),
            point(1, 5.0, 0.5),
            // The first growth rate after an edge is nearly zero, and may have either sign.
            point(2, 3.91, 1e-9),
            point(2, 5.0, -0.3),
            point(2, 6.2, -0.1),
            point(3, 6.3, 0.2),
            point(4, 2.0, 0.7),
        ];
        assert_eq!(stable_intervals(&edges, &points, &[]), [[0.0, 6.14], [3.9, 6.24]]);
        assert_eq!(stable_intervals(&[], &points[..2], &[]), [[0.0, 3.0]]);
        // Stability is lost by oscillation, a quarter of the way from 6 to 8.
        let lost = [point(0, 0.0, -3.0), point(0, 3.0, -1.0), point(0, 6.0, -0.2), point(0, 8.0, 0.6)];
        assert_eq!(stable_intervals(&[fold(8.2, true)], &lost, &[]), [[0.0, 6.5]]);
        assert_eq!(stable_intervals(&[fold(6.85, true)], &points[..3], &[]), [[0.0, 6.85]]);
        // Hopf points divide a segment, also between its last point and the edge.
        let hopf = |xi_s, grows| HopfPoint { point: point(0, xi_s, 0.0), period: 1.0, grows };
        let edges = [fold(8.2, true)];
        assert_eq!(stable_intervals(&edges, &points[..3], &[hopf(7.5, true)]), [[0.0, 7.5]]);
        let twice = [hopf(2.0, true), hopf(5.0, false)];
        assert_eq!(stable_intervals(&edges, &points[..3], &twice), [[0.0, 2.0], [5.0, 8.2]]);
        assert_eq!(stable_intervals(&edges, &points[..3], &twice[1..]), [[5.0, 8.2]]);
    }
}
