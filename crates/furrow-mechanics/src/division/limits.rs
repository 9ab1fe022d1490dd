//! The step budget of a division, cells that drift freely, and coefficients that a regulator takes away.

use super::outcome::DivisionError;
use super::stepper::{HistoryPoint, MAX_ORDER, Stepper};
use crate::cortex::equations::{LENGTH, LocalCoefficients, PHI};
use crate::cortex::{Cortex, Domain};
use crate::stability::Stability;
use furrow_cell::cue::Field;
use furrow_cell::{Numerics, Scheme};

/// Most steps of a division with the preset's numerics.
const MOST_STEPS: f64 = 1e4;
/// What is slower than this, in 1/τ and relative to R0, over all of the time that a division is given, is rounding.
const DRIFT: f64 = 1e-8;

/// A shape slower than this, in 1/τ and relative to R0, creeps: it needs few steps for however long.
const CREEPING: f64 = 1e-4;
/// How many times longer than others a shape that creeps is followed.
const MORE_TIME: f64 = 1e5;

/// What is left of a coefficient that must be positive, relative to its value without a regulator, where no step can be solved any
/// more.
pub const TAKEN_AWAY: f64 = 0.02;

/// A concentration so many times that at rest, where no step can be solved any more, is that of a regulator that collapses to a point.
const COLLAPSED: f64 = 100.0;

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

/// Whether the newest shape moves too slowly to get anywhere in the time that a division is given, as in a loose shell, where a flow
/// along the axis pushes the cell against next to nothing: it is followed until it rests, or divides elsewhere.
pub fn creeps(stepper: &Stepper, t_max: f64) -> bool {
    stepper.speed() < CREEPING && stepper.history[0].t < MORE_TIME * t_max
}

/// The coefficient that a regulator has left least of in the newest shape, if that is less than a `share` of its value without.
pub fn taken_away(stepper: &Stepper, share: f64) -> Option<DivisionError> {
    let regulator = stepper.cortex.cell.cue.regulator()?;
    if !regulator.couplings.iter().any(|coupling| Field::POSITIVE.iter().any(|at| coupling.field.modulates(*at))) {
        return None;
    }
    let (constants, HistoryPoint { t, y, .. }) = (stepper.cortex.constants(), &stepper.history[0]);
    let uniform = positive(&constants.uniform);
    let (mut least, mut found) = (share, None);
    for (k, state) in y.stages.chunks_exact(y.components).enumerate() {
        let u = y.stage_x(&stepper.system.gauss, k / y.m, k % y.m);
        let here = positive(&constants.of_state(u, state, y.scalars[LENGTH]));
        for ((field, value), without) in Field::POSITIVE.into_iter().zip(here).zip(uniform) {
            if value / without < least {
                (least, found) = (value / without, Some((field.name(), u, value)));
            }
        }
    }
    let r0 = stepper.cortex.cell.r0;
    found.map(|(field, u, value)| DivisionError::Coefficient { r0, t: *t, field, u, value })
}

/// A regulator that flow and its own pull gather in ever less of the cortex, as a pole: no mesh resolves that for long.
pub fn collapsed(stepper: &Stepper) -> Option<DivisionError> {
    if !stepper.cortex.is_regulated() {
        return None;
    }
    let HistoryPoint { t, y, .. } = &stepper.history[0];
    let phi = y.stages.chunks_exact(y.components).map(|state| state[PHI]);
    let (k, most) = phi.enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let (r0, u) = (stepper.cortex.cell.r0, y.stage_x(&stepper.system.gauss, k / y.m, k % y.m));
    (1.0 + most > COLLAPSED).then_some(DivisionError::Collapses { r0, t: *t, u, c: 1.0 + most })
}

/// Values of the coefficients of [`Field::POSITIVE`].
fn positive(at: &LocalCoefficients<f64>) -> [f64; 4] {
    let [eta_b, eta_s] = [1.0, -1.0].map(|sign| 0.5 * (at.eta_sum + sign * at.eta_difference));
    [at.kappa, eta_b, eta_s, at.friction]
}

#[cfg(test)]
mod tests {
    use crate::division::{DivisionInput, Outcome, divide};
    use furrow_cell::Cell;

    /// Friction that differs between the halves makes a cell swim along a loose shell, slower and slower: to rest, or to where it divides.
    #[test]
    fn cells_that_creep_along_loose_shells_are_followed_to_their_outcome() {
        let cue = "friction:step,u0=0.3,omega=0.2,amplitude=0.5";
        for (r0, epsilon, outcome) in [(2.8, 0.50, Outcome::Arrested), (2.9, 0.50, Outcome::Asymmetric)] {
            let cell = Cell { epsilon, xi_s: 6.5, ..Cell::new(r0) }.with_cue(cue.parse().unwrap());
            let division = divide(&DivisionInput::new(cell)).unwrap();
            assert_eq!(division.outcome(), outcome);
            // Longer than `t_max`, in a few more steps.
            assert!(division.t_end > 1e4 && division.work.steps < 200, "{division:?}");
            assert!(division.growth_rate().is_none_or(|rate| rate < -1e-5), "{division:?}");
        }
    }
}
