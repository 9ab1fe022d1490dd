//! The amount of a regulator on the cortex, ∫ c dA. Flow and diffusion conserve it, so that without turnover it is a
//! property of the cell, like its volume: stationary states form families with one state for each amount.

use furrow_bvp::newton::NewtonScratch;
use furrow_bvp::{
    BoundaryValueProblem, CollocationPoint, Gauss, LinearCondition, Newton, NewtonError, NewtonReport, Solution, System,
};

use super::Cortex;
use super::equations::{J, LENGTH, M, PHI, R, REGULATED};

/// Relative accuracy of the amount.
const MET: f64 = 1e-12;
/// Most linear conditions, each about the state that the previous one gave.
const MOST_CONDITIONS: usize = 8;

/// ∫ r c du of a regulator: its amount over 2πL.
fn over_length(gauss: &Gauss, y: &Solution) -> f64 {
    let of = |(i, s): (usize, &[f64])| {
        let interval = i / y.m;
        (y.mesh[interval + 1] - y.mesh[interval]) * gauss.b[i % y.m] * s[R] * (1.0 + s[PHI])
    };
    y.stages.chunks_exact(REGULATED).enumerate().map(of).sum()
}

/// Restores the amount of a regulator after a shape has moved to a new mesh.
pub fn keep(gauss: &Gauss, before: &Solution, after: &mut Solution) {
    let factor = over_length(gauss, before) / over_length(gauss, after);
    for state in after.nodes.chunks_exact_mut(REGULATED).chain(after.stages.chunks_exact_mut(REGULATED)) {
        state[J] *= factor;
        state[PHI] = (1.0 + state[PHI]) * factor - 1.0;
    }
}

/// The amount of a regulator over 2π; 0 without one.
pub fn of(y: &Solution) -> f64 {
    if y.components == REGULATED { y.scalars[LENGTH] * over_length(&y.gauss(), y) } else { 0.0 }
}

/// Solves for the stationary state of a cell without free parameters, from and into `y`. If the regulator has no
/// turnover, `wanted` is its amount.
///
/// # Errors
/// [`NewtonError`] if the iteration does not converge.
pub fn solve_at_rest(
    newton: &Newton,
    cortex: &mut Cortex,
    y: &mut Solution,
    wanted: f64,
) -> Result<NewtonReport, NewtonError> {
    cortex.amount_is_given = cortex.conserves_regulator();
    let (mut system, mut scratch) = (System::new(cortex.dimensions(), y.m), NewtonScratch::default());
    let mut solve = |cortex: &mut Cortex, y: &mut Solution, given: &[LinearCondition]| {
        newton.solve(&mut system, &mut scratch, cortex, y, given, false)
    };
    if !cortex.amount_is_given {
        return solve(cortex, y, &[]);
    }
    let mut total = NewtonReport::default();
    for _ in 0..MOST_CONDITIONS {
        let missing = wanted - of(y);
        if total.iterations > 0 && missing.abs() <= MET * wanted {
            break;
        }
        match solve(cortex, y, &[change_of_amount(y, missing)]) {
            Ok(report) => {
                total.iterations += report.iterations;
                total.factorisations += report.factorisations;
                total.last_correction = report.last_correction;
            }
            Err(error) => {
                cortex.amount_is_given = false;
                return Err(error);
            }
        }
    }
    cortex.amount_is_given = false;
    Ok(total)
}

/// The condition that the amount exceeds the amount of `y` by `more`, linearised and with the trapezoidal rule.
fn change_of_amount(y: &Solution, more: f64) -> LinearCondition {
    let (length, last) = (y.scalars[LENGTH], y.intervals());
    let mut condition =
        LinearCondition { nodes: vec![0.0; y.nodes.len()], scalars: vec![0.0; y.scalars.len()], value: more };
    let states = y.nodes.chunks_exact(REGULATED).zip(condition.nodes.chunks_exact_mut(REGULATED));
    for (i, (state, weights)) in states.enumerate() {
        let weight = 0.5 * (y.mesh[(i + 1).min(last)] - y.mesh[i.saturating_sub(1)]);
        weights[R] = weight * length * (1.0 + state[PHI]);
        weights[PHI] = weight * length * state[R];
        condition.scalars[LENGTH] += weight * state[R] * (1.0 + state[PHI]);
        condition.value += weights[R] * state[R] + weights[PHI] * state[PHI];
    }
    condition.value += condition.scalars[LENGTH] * length;
    condition
}

/// Change of the amount of a conserved regulator by a perturbation: factors of its normal displacement w and of the
/// change of φ in a frame that moves along the normal, at every collocation point. Empty if the regulator is not
/// conserved.
#[derive(Clone, Debug, Default)]
pub(crate) struct AmountOf(Vec<[f64; 2]>);

impl AmountOf {
    /// The factors for perturbations of the shape `y`.
    pub(crate) fn disturbances(cortex: &Cortex, y: &Solution, gauss: &Gauss) -> AmountOf {
        let points = if cortex.conserves_regulator() { y.intervals() * y.m } else { 0 };
        let mut reader = cortex.constants().reader();
        let at = |index: usize| {
            let (i, j) = (index / y.m, index % y.m);
            let (state, x) = (y.stage(i, j), y.stage_x(gauss, i, j));
            let here = cortex.coefficients_at(CollocationPoint { x, index }, state, y.scalars[LENGTH]);
            let area = (y.mesh[i + 1] - y.mesh[i]) * gauss.b[j] * state[R];
            // The order of the operations of a cell without a moment of its own decides the last bit.
            let by_normal = match cortex.constants().law.as_ref().filter(|law| law.bends) {
                Some(_) => {
                    let [mean, _] = reader.mean_curvature(x, &here, state, y.scalars[LENGTH]);
                    area * (1.0 + state[PHI]) * mean
                }
                None if here.spontaneous == 0.0 => area * (1.0 + state[PHI]) * state[M] / here.kappa,
                None => area * (1.0 + state[PHI]) * here.mean(state[M]),
            };
            [by_normal, area]
        };
        AmountOf((0..points).map(at).collect())
    }

    /// The uniform decrease of φ with which a perturbation (w, δφ) leaves the amount unchanged. A change of the amount
    /// neither grows nor decays: it belongs to a different cell.
    pub(crate) fn excess(&self, disturbance: impl Iterator<Item = [f64; 2]>) -> f64 {
        let added: f64 = self.0.iter().zip(disturbance).map(|(by, [w, phi])| by[0] * w + by[1] * phi).sum();
        let area: f64 = self.0.iter().map(|by| by[1]).sum();
        if area > 0.0 { added / area } else { 0.0 }
    }
}
