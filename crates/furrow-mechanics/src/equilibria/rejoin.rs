//! The return of an asymmetric branch to mirror-symmetric shapes, at one of their pitchforks.
//!
//! ξ_s turns there along the asymmetric branch as at a fold, because the branch continues as its own mirror image. The
//! equations of the full contour are singular at the point; on the half contour it is a regular root, like every
//! pitchfork.

use furrow_bvp::locate::Located;
use furrow_bvp::{Continuation, Direction, Gauss, MinimallyAugmented, SingularError, Solution, SymmetryBreaking};

use super::branch::{Pitchfork, mesh_monitor};
use super::curves::along_scalar;
use super::locate::pitchfork_at;
use super::point::XI;
use crate::cortex::equations::{R, REGULATED, Z};
use crate::cortex::symmetry::fold;
use crate::cortex::{Cortex, Domain};

/// The deviation of a full contour from its mirror image, at places along it: r(u) − r(1 − u) and z(u) + z(1 − u).
pub(super) fn asymmetry(gauss: &Gauss, y: &Solution) -> Vec<f64> {
    const PLACES: usize = 32;
    let (mut here, mut there) = ([0.0; REGULATED], [0.0; REGULATED]);
    let (here, there) = (&mut here[..y.components], &mut there[..y.components]);
    let at = |k: usize| {
        let u = k as f64 / (2 * PLACES) as f64;
        y.eval(gauss, u, here);
        y.eval(gauss, 1.0 - u, there);
        [here[R] - there[R], here[Z] + there[Z]]
    };
    (0..=PLACES).flat_map(at).collect()
}

/// Largest remaining asymmetry at the root, relative to the step's change, for a step that returns to mirror symmetry.
const LEFT: f64 = 0.5;
/// A root closer to the start of the step than this fraction is the pitchfork at which the step begins.
const BEGINS: f64 = 1e-3;

/// The fraction of the way from the first to the last shape, up to `reach`, at which their asymmetry vanishes; `None`
/// if it does not.
pub(super) fn vanishes(first: &[f64], last: &[f64], reach: f64) -> Option<f64> {
    let (mut along, mut length, mut size) = (0.0, 0.0, 0.0);
    for (a, b) in first.iter().zip(last) {
        along -= a * (b - a);
        length += (b - a) * (b - a);
        size += a * a;
    }
    let share = along / length;
    (share > BEGINS && share <= reach && size - share * along < LEFT * LEFT * length).then_some(share)
}

/// The mirror-symmetric mesh nearest to one of the full contour.
pub(super) fn mirrored(mesh: &[f64]) -> Vec<f64> {
    mesh.iter().zip(mesh.iter().rev()).map(|(a, b)| 0.5 * (a + 1.0 - b)).collect()
}

/// [`mesh_monitor`] made mirror-symmetric, so that a mirror-symmetric mesh stays so.
pub(super) fn mirrored_monitor(cortex: &Cortex, y: &Solution, weight: &mut Vec<f64>) {
    mesh_monitor(cortex, y, weight);
    let half = weight.len() / 2;
    let (first, second) = weight.split_at_mut(half);
    for (a, b) in first.iter_mut().zip(second.iter_mut().rev()) {
        let mean = 0.5 * (*a + *b);
        (*a, *b) = (mean, mean);
    }
}

/// The pitchfork at the fraction `share` of the last step of an asymmetric branch. It lies within one step length of
/// that point: the step may end on the mirror-symmetric branch, anywhere beyond the pitchfork.
///
/// # Errors
/// [`SingularError`].
pub(super) fn rejoined(branch: &Continuation<Cortex>, share: f64) -> Result<Pitchfork, SingularError> {
    let history = &branch.state.history;
    let none = SingularError::Stalled { iterations: 0, correction: f64::NAN };
    let (now, newest) = history.back(0).ok_or(none)?;
    let (before, _) = history.back(1).ok_or(none)?;
    let arclength = before + share * (now - before);
    let mut full = newest.clone();
    history.extrapolate(arclength, &mut full);
    let mesh = mirrored(&full.mesh);
    let mut y = full.clone();
    fold(&full.on_mesh(&branch.system.gauss, &mesh), &mut y, &mut Direction::default());
    let cortex = Cortex::new(&branch.problem.cell, Domain::Half, &branch.problem.free);
    let guess = along_scalar(&y, y.scalars.len(), XI);
    let breaking = SymmetryBreaking::default();
    let mut at = MinimallyAugmented::new(cortex, breaking, y.m, branch.metric.clone(), &guess)?;
    let start = y.clone();
    let report = at.solve(&mut y, None)?;
    let difference = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a - b).collect();
    let off = Direction {
        nodes: difference(&y.nodes, &start.nodes),
        stages: Vec::new(),
        scalars: difference(&y.scalars, &start.scalars),
    };
    let distance = branch.metric.dot(&y.mesh, &off, &off).sqrt() / (now - before);
    if distance > 1.0 {
        return Err(SingularError::Elsewhere { distance });
    }
    let error = at.error_estimate(&y, None);
    pitchfork_at(Located { augmented: at, solution: y, arclength, error, report })
}
