//! The step budget of a division, and cells that drift freely.

use super::stepper::{MAX_ORDER, Stepper};
use crate::cortex::{Cortex, Domain};
use crate::stability::Stability;
use furrow_cell::{Numerics, Scheme};

/// Most steps of a division with the preset's numerics.
const MOST_STEPS: f64 = 1e4;
/// What is slower than this, in 1/τ and relative to R0, over all of the time that a division is given, is rounding.
const DRIFT: f64 = 1e-8;

/// Steps after which a cell is given up: what divides, rests or repeats itself takes some hundreds with the preset's numerics,
/// and as many more as they ask for shorter ones. Fixed steps take as many as they take.
pub fn most_steps(numerics: &Numerics) -> usize {
    let Numerics { scheme, step_factor, time_tolerance, .. } = *numerics;
    match scheme {
        Scheme::Published => usize::MAX,
        Scheme::Converged => {
            let finer = (Numerics::default().time_tolerance / time_tolerance).powf(1.0 / (MAX_ORDER as f64 + 1.0));
            (MOST_STEPS * finer.max(1.0) / step_factor) as usize
        }
    }
}

/// The growth rate of a shape at rest under neutral drift. In a very wide shell, whose force at the cell is less than rounding,
/// a cell rests anywhere along the axis, so Newton's method finds no isolated stationary state. The shape's own speed and spectrum
/// decide instead.
pub fn neutral_drift(stepper: &Stepper) -> Option<f64> {
    if stepper.speed() > DRIFT {
        return None;
    }
    let here = &stepper.history[0].y;
    let cortex = Cortex::new(&stepper.cortex.cell, Domain::Full, &[]);
    let spectrum = Stability::new(here.m).leading(&cortex, here).ok()?;
    // The drift along the axis has none but that of rounding, of either sign, which goes with the fastest of all rates.
    let fastest = spectrum.values.iter().map(|rate| rate.re.hypot(rate.im)).fold(1.0, f64::max);
    let growth_rate = spectrum.growth_rate();
    (growth_rate < DRIFT * fastest).then_some(-growth_rate.abs())
}
