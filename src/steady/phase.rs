//! Where a cell without cue comes to rest undivided: exact intervals of ξ_s from the folds and pitchforks of the
//! mirror-symmetric branch.
//!
//! The branch starts stable at ξ_s = 0. Along it every maximum of ξ_s makes one even mode grow and every minimum lets one
//! decay again; pitchforks do the same to odd modes. Wherever no mode grows, the cell has a stable shape to rest in.

use serde::Serialize;

use super::symmetric::{self, BranchEvent, BranchOptions, Criticality, SteadyError};
use crate::cortex::{Numerics, Physics};

/// A fold or pitchfork in a phase diagram.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Edge {
    /// The mirror symmetry breaks.
    Pitchfork {
        /// ξ_s*.
        xi_s: f64,
        /// Sub- or supercritical.
        criticality: Criticality,
    },
    /// The branch turns.
    Fold {
        /// Where.
        xi_s: f64,
        /// Whether ξ_s is largest here.
        maximum: bool,
    },
}

/// The stable part of the symmetric branch of one cell.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RestShapes {
    /// Intervals of ξ_s with a stable symmetric shape, in order along the branch.
    pub intervals: Vec<[f64; 2]>,
    /// Folds and pitchforks in order along the branch.
    pub edges: Vec<Edge>,
}

impl RestShapes {
    /// Whether there is a stable symmetric shape at ξ_s.
    pub fn contains(&self, xi_s: f64) -> bool {
        self.intervals.iter().any(|[low, high]| (*low..=*high).contains(&xi_s))
    }
}

/// The stable symmetric shapes of a cell without cue for ξ_s from 0 to `xi_max`.
///
/// # Errors
/// [`SteadyError`] if the branch cannot be followed.
pub fn rest_shapes(physics: &Physics, numerics: &Numerics, r0: f64, xi_max: f64) -> Result<RestShapes, SteadyError> {
    let options = BranchOptions { xi: [0.0, xi_max], ..BranchOptions::default() };
    let branch = symmetric::follow(physics, numerics, r0, &options, |_| true)?;
    let end = branch.points.last().map_or(0.0, |p| p.xi_s);
    Ok(from_events(&branch.events, end))
}

fn from_events(events: &[BranchEvent], end: f64) -> RestShapes {
    let edges: Vec<Edge> = events
        .iter()
        .map(|event| match event {
            BranchEvent::Pitchfork(p) => Edge::Pitchfork { xi_s: p.point.xi_s, criticality: p.criticality() },
            BranchEvent::Fold(f) => Edge::Fold { xi_s: f.point.xi_s, maximum: f.maximum },
        })
        .collect();
    let intervals = stable_intervals(&edges, end);
    RestShapes { intervals, edges }
}

fn stable_intervals(edges: &[Edge], end: f64) -> Vec<[f64; 2]> {
    let mut intervals = Vec::new();
    let (mut even, mut odd, mut from) = (0i32, 0i32, 0.0);
    let mut rising = true;
    let mut close = |stable: bool, from: f64, to: f64| {
        if stable {
            intervals.push([f64::min(from, to), f64::max(from, to)]);
        }
    };
    for edge in edges {
        let (Edge::Pitchfork { xi_s, .. } | Edge::Fold { xi_s, .. }) = *edge;
        close(even == 0 && odd == 0, from, xi_s);
        from = xi_s;
        match edge {
            Edge::Fold { maximum, .. } => {
                even += if *maximum { 1 } else { -1 };
                rising = !maximum;
            }
            // An odd mode that grows beyond a pitchfork passed with rising ξ_s decays beyond one passed on the way back.
            Edge::Pitchfork { .. } => odd += if rising || odd == 0 { 1 } else { -1 },
        }
    }
    close(even == 0 && odd == 0, from, end);
    intervals
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fold(xi_s: f64, maximum: bool) -> Edge {
        Edge::Fold { xi_s, maximum }
    }

    fn pitchfork(xi_s: f64) -> Edge {
        Edge::Pitchfork { xi_s, criticality: Criticality::Subcritical }
    }

    #[test]
    fn intervals_of_an_s_shaped_branch() {
        let edges = [fold(6.14, true), fold(3.9, false), pitchfork(6.24), fold(6.6, true)];
        assert_eq!(stable_intervals(&edges, 0.0), [[0.0, 6.14], [3.9, 6.24]]);
        assert_eq!(stable_intervals(&[], 5.0), [[0.0, 5.0]]);
        assert_eq!(stable_intervals(&[fold(6.85, true)], 0.0), [[0.0, 6.85]]);
    }
}
