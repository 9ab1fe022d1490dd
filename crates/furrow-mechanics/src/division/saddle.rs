//! Cells that wait at a saddle longer than the allowed time.
//!
//! Just above a threshold of division the stationary shape is a saddle with a growth rate σ near zero. The cell
//! approaches it along the decaying modes and leaves it along the single growing mode, as a e^{σt}, M.24. This linear
//! growth is known, so that it is skipped up to an amplitude that is still small; the division continues from there.

use furrow_bvp::{Direction, Gauss, Solution};

use crate::cortex::Cortex;
use crate::cortex::equations::{R, Z};
use crate::stability::{Stability, StabilityError};

/// Amplitude after the skip, relative to R0, as the L² norm of (r, z) over u: far below 1, so that the growing mode is
/// still linear, and far above the accuracy of a time step.
const DEPARTURE: f64 = 1e-3;
/// A smaller amplitude than this, relative to R0, is rounding.
const ROUNDING: f64 = 1e-12;

/// The departure of a shape from a saddle.
pub struct Departure {
    /// The shape at departure, on the saddle's mesh.
    pub shape: Solution,
    /// Time that is skipped, in τ: ln(amplitude after/amplitude before)/σ.
    pub waited: f64,
}

/// The shape that `here` becomes after its wait at `saddle`, a stationary shape on the same mesh with growth rate
/// `growth`. It leaves towards the side of `here`; without noise, rounding decides.
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

/// Amplitude of the distance of `here` from `saddle` along `mode`, a direction of length 1.
fn amplitude(gauss: &Gauss, here: &Solution, saddle: &Solution, mode: &Direction) -> f64 {
    let part = |i: usize| (here.stages[i] - saddle.stages[i]) * mode.stages[i];
    let at = |k: usize| {
        let weight = (saddle.mesh[k / saddle.m + 1] - saddle.mesh[k / saddle.m]) * gauss.b[k % saddle.m];
        weight * (part(k * here.components + R) + part(k * here.components + Z))
    };
    (0..saddle.intervals() * saddle.m).map(at).sum()
}
