//! Cells that wait at a saddle for longer than the time they are given.
//!
//! Just above a threshold of division the stationary shape is a saddle that grows at a rate σ near zero. The cell approaches
//! it along the decaying modes and leaves it along the one growing mode, as a e^{σt}, M.24. This linear growth is known without
//! stepping through it, so it is skipped, to an amplitude that is still small, and the division continues from there.

use furrow_bvp::{Direction, Gauss, Solution};

use crate::cortex::Cortex;
use crate::cortex::equations::{R, Z};
use crate::stability::{Stability, StabilityError};

/// Amplitude, relative to R0 and as the L² norm of (r, z) over u, after the skip: far below 1, so that the
/// growing mode is still linear, and far above what a time step is solved to.
const DEPARTURE: f64 = 1e-3;
/// A smaller amplitude than this, relative to R0, is rounding.
const ROUNDING: f64 = 1e-12;

/// Where a shape leaves a saddle.
pub struct Departure {
    /// The shape there, on the saddle's mesh.
    pub shape: Solution,
    /// Time that is skipped, in τ: ln(amplitude after/amplitude before)/σ.
    pub waited: f64,
}

/// The shape that `here` becomes after its wait at `saddle`, a stationary shape on the same mesh that grows at `growth`, to
/// the side on which it is. Without noise that is rounding.
///
/// # Errors
/// The growing direction cannot be computed.
pub fn leave(cortex: &Cortex, here: &Solution, saddle: &Solution, growth: f64) -> Result<Departure, StabilityError> {
    let mut stability = Stability::new(saddle.m);
    let mode = stability.unstable_direction(cortex, saddle, growth)?;
    let r0 = cortex.cell.r0;
    let before = amplitude(&saddle.gauss(), here, saddle, &mode);
    let known = before.abs().max(ROUNDING * r0);
    let after = known.max(DEPARTURE * r0);
    let (mut shape, amount) = (saddle.clone(), after.copysign(before));
    let Direction { nodes, stages, scalars } = &mode;
    for (to, by) in [(&mut shape.nodes, nodes), (&mut shape.stages, stages), (&mut shape.scalars, scalars)] {
        to.iter_mut().zip(by).for_each(|(to, by)| *to += amount * by);
    }
    Ok(Departure { shape, waited: (after / known).ln() / growth })
}

/// How far `here` is from `saddle` along `mode`, a direction of length 1.
fn amplitude(gauss: &Gauss, here: &Solution, saddle: &Solution, mode: &Direction) -> f64 {
    let part = |i: usize| (here.stages[i] - saddle.stages[i]) * mode.stages[i];
    let at = |k: usize| {
        let weight = (saddle.mesh[k / saddle.m + 1] - saddle.mesh[k / saddle.m]) * gauss.b[k % saddle.m];
        weight * (part(k * here.components + R) + part(k * here.components + Z))
    };
    (0..saddle.intervals() * saddle.m).map(at).sum()
}
