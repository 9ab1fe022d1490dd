//! The step budget of a division, cells under neutral drift, and coefficients that a regulator reduces to zero.

use super::outcome::{DivisionError, pull};
use super::stepper::{HistoryPoint, MAX_ORDER, Stepper};
use crate::cortex::equations::{LENGTH, LocalCoefficients, PHI};
use crate::cortex::{Cortex, Domain};
use crate::law;
use crate::stability::Stability;
use furrow_cell::cue::Field;
use furrow_cell::{Numerics, Scheme};

/// Most steps of a division with the preset's numerics.
const MOST_STEPS: f64 = 1e4;
/// Slower motion than this at the end of the allowed time, in 1/τ and relative to R0, is rounding.
const DRIFT: f64 = 1e-8;

/// A shape slower than this, in 1/τ and relative to R0, creeps: it needs few steps for any length of time.
const CREEPING: f64 = 1e-4;
/// Factor by which the allowed time of a creeping shape is longer.
const MORE_TIME: f64 = 1e5;

/// A step that cannot be solved is blamed on the regulator if it reduces a coefficient that must be positive below this
/// share of its value without the regulator.
pub const TAKEN_AWAY: f64 = 0.02;

/// A step that cannot be solved is blamed on the regulator's collapse to a point if its concentration exceeds this
/// multiple of the resting one.
const COLLAPSED: f64 = 100.0;

/// Steps after which a cell is given up: cells that divide, rest or oscillate take some hundreds with the preset's
/// numerics, and proportionally more with shorter steps. A step on a mesh twice as fine as the numerics' counts as two. The number of
/// fixed steps is not limited.
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

/// The growth rate of a shape at rest under neutral drift. In a very wide shell, where the force on the cell is below
/// rounding, a cell rests anywhere along the axis, so that Newton's method finds no isolated stationary state. The
/// shape's own speed and spectrum decide instead.
pub fn neutral_drift(stepper: &Stepper) -> Option<f64> {
    if stepper.speed() > DRIFT {
        return None;
    }
    let here = &stepper.history[0].y;
    let cortex = Cortex::new(&stepper.cortex.cell, Domain::Full, &[]);
    let spectrum = Stability::new(here.m).leading(&cortex, here).ok()?;
    // The growth rate of the drift along the axis is zero up to rounding, which scales with the fastest rate.
    let fastest = spectrum.values.iter().map(|rate| rate.re.hypot(rate.im)).fold(1.0, f64::max);
    let growth_rate = spectrum.growth_rate();
    (growth_rate < DRIFT * fastest).then_some(-growth_rate.abs())
}

/// Whether the newest shape moves too slowly to reach a result in the allowed time, as in a loose shell, where a flow
/// along the axis pushes the cell against very little resistance: it is followed until it rests, or divides elsewhere.
pub fn creeps(stepper: &Stepper, t_max: f64) -> bool {
    stepper.speed() < CREEPING && stepper.history[0].t < MORE_TIME * t_max
}

/// An error for a law that cannot hold in the newest shape.
pub fn short_waves(stepper: &Stepper) -> Option<DivisionError> {
    let found = law::short_waves(&stepper.cortex, &stepper.history[0].y);
    found.map(|source| DivisionError::Law { r0: stepper.cortex.cell.r0, source })
}

/// An error for the coefficient that a regulator has reduced most in the newest shape, if less than `share` of its
/// value without the regulator is left.
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

/// An error if flow and the regulator's own pull concentrate it in an ever smaller part of the cortex, such as a pole:
/// no mesh resolves this for long.
pub fn collapsed(stepper: &Stepper) -> Option<DivisionError> {
    if !stepper.cortex.is_regulated() {
        return None;
    }
    let HistoryPoint { t, y, .. } = &stepper.history[0];
    let phi = y.stages.chunks_exact(y.components).map(|state| state[PHI]);
    let (k, most) = phi.enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let (r0, u) = (stepper.cortex.cell.r0, y.stage_x(&stepper.system.gauss, k / y.m, k % y.m));
    let pull = pull(&stepper.cortex.cell.cue);
    (1.0 + most > COLLAPSED).then_some(DivisionError::Collapses { r0, t: *t, u, c: 1.0 + most, pull })
}

/// The coefficients listed in [`Field::POSITIVE`].
fn positive(at: &LocalCoefficients<f64>) -> [f64; 4] {
    let [eta_b, eta_s] = [1.0, -1.0].map(|sign| 0.5 * (at.eta_sum + sign * at.eta_difference));
    [at.kappa, eta_b, eta_s, at.friction]
}

#[cfg(test)]
mod tests {
    use crate::division::{DivisionInput, Outcome, divide};
    use furrow_cell::Cell;

    /// Friction that differs between the halves moves a cell along a loose shell, more and more slowly, until it rests
    /// or divides.
    #[test]
    fn cells_that_creep_along_loose_shells_are_followed_to_their_outcome() {
        let cue = "friction:step,u0=0.3,omega=0.2,amplitude=0.5";
        for (r0, epsilon, outcome) in [(2.8, 0.50, Outcome::Arrested), (2.9, 0.50, Outcome::Asymmetric)] {
            let cell = Cell { epsilon, xi_s: 6.5, ..Cell::new(r0) }.with_cue(cue.parse().unwrap());
            let division = divide(&DivisionInput::new(cell)).unwrap();
            assert_eq!(division.outcome(), outcome);
            // Later than `t_max`, but with few more steps.
            assert!(division.t_end > 1e4 && division.work.steps < 200, "{division:?}");
            assert!(division.growth_rate().is_none_or(|rate| rate < -1e-5), "{division:?}");
        }
    }
}
