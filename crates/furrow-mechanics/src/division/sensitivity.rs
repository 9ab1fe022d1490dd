//! Sensitivities: exact derivatives of the outcome of a division by the cell's parameters.
//!
//! A step solves F(y; past, p) = 0 for the new shape y. Its derivative by a parameter p is carried from step to step,
//!
//! * \[N.17 tangent\] ∂F/∂y · dy/dp = −∂F/∂p − ∂F/∂past · d(past)/dp,
//!
//! with the Jacobian of Newton's method at the solution: one more factorisation in each step, and one solve for each
//! parameter. The past is the combination of former shapes in the backward differentiation formula, and its derivative
//! is the same combination of their derivatives. Steps and meshes are held fixed: they affect the error of the
//! division, not its outcome.
//!
//! The division ends when the neck is as narrow as [`PINCH_OFF`], at a time t\* that depends on p too: with the rates
//! of change of the last shape, dt\*/dp = −(∂(neck)/∂p − 10⁻³ ∂R0/∂p)/(d neck/dt) and dχ/dp = ∂χ/∂p + dχ/dt · dt\*/dp.
//!
//! # References
//! Maly & Petzold, *Appl. Numer. Math.* 20, 57 (1996), staggered direct method.

use furrow_bvp::{
    BoundaryValueProblem, CollocationPoint, Direction, InvalidInput, LinearCondition, Solution, System, metric,
};
use serde::{Deserialize, Serialize};

use super::stepper::{MAX_ORDER, Stepper};
use crate::cortex::equations::{COMPONENTS, LENGTH, PHI, PSI, R, REGULATED, Z};
use crate::cortex::observables::{self, PINCH_OFF, with_components};
use crate::cortex::problem::SHAPE_SCALARS;
use crate::cortex::{Cortex, Domain};
use furrow_cell::Parameter;

/// Largest displacement, relative to R0, for differences of observables of the last shape: small compared with the
/// neck.
const DISPLACEMENT: f64 = 1e-5;

/// Derivatives of a division's outcome by one parameter, in the unit of the outcome over the parameter's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Sensitivity {
    /// Of the signed size asymmetry χ.
    pub chi_signed: f64,
    /// Of the furrow's position in u.
    pub u_furrow: f64,
    /// Of the time of pinch-off, in τ.
    pub t_end: f64,
}

impl Sensitivity {
    /// Its sum with another one times a factor.
    pub(super) fn plus(self, factor: f64, other: &Sensitivity) -> Sensitivity {
        Sensitivity {
            chi_signed: self.chi_signed + factor * other.chi_signed,
            u_furrow: self.u_furrow + factor * other.u_furrow,
            t_end: self.t_end + factor * other.t_end,
        }
    }
}

/// Derivatives of the shapes of a running division by some parameters.
pub(super) struct Tangent {
    parameters: Vec<Parameter>,
    /// The problem of a step with the parameters as unknowns, each fixed at its value.
    cortex: Cortex,
    system: System,
    held: Vec<LinearCondition>,
    /// Derivatives of the last shapes by each parameter, newest first, on the mesh of the newest.
    history: Vec<Vec<Solution>>,
    /// Whether all steps so far could be differentiated.
    sound: bool,
}

impl Tangent {
    /// At the passive shape, the start of a division.
    pub(super) fn of_start(stepper: &Stepper, parameters: &[Parameter]) -> Tangent {
        let cell = &stepper.cortex.cell;
        let stages = stepper.history[0].y.m;
        // The start has neither activity nor cue, so that their parameters are replaced by one on which shapes at rest
        // do not depend either; their derivatives are then zero.
        let acts = |p: &Parameter| matches!(p, Parameter::XiS | Parameter::Cue { .. } | Parameter::Regulator(_));
        let known = parameters.iter().map(|p| if acts(p) { Parameter::Friction } else { *p });
        let mut tangent = Tangent {
            parameters: parameters.to_vec(),
            cortex: Cortex::new(&cell.passive(), Domain::Full, &known.collect::<Vec<_>>()),
            system: System::new(Cortex::dimensions_for(&cell.passive(), parameters.len()), stages),
            held: vec![LinearCondition::default(); parameters.len()],
            history: Vec::new(),
            sound: true,
        };
        let y = with_components(&stepper.history[0].y, COMPONENTS);
        let start = tangent.solve(&y, &vec![Vec::new(); parameters.len()]);
        tangent.cortex = Cortex::new(cell, Domain::Full, parameters);
        tangent.system = System::new(tangent.cortex.dimensions(), stages);
        let n = tangent.cortex.components();
        tangent.history.push(start.iter().map(|derivative| with_components(derivative, n)).collect());
        tangent
    }

    /// Follows the step just accepted.
    pub(super) fn follow(&mut self, stepper: &Stepper) {
        if !self.sound {
            return;
        }
        let y = &stepper.history[0].y;
        let gauss = &self.system.gauss;
        // The shapes in the formula of the step: a restart has discarded the older ones.
        self.history.truncate(stepper.weights.len() - 1);
        for derivative in self.history.iter_mut().flatten().filter(|derivative| derivative.mesh != y.mesh) {
            *derivative = derivative.on_mesh(gauss, &y.mesh);
        }
        let n = y.components;
        let points = y.stages.len() / n;
        let weights = &stepper.weights;
        let levels: Vec<&Solution> = stepper.history[1..].iter().map(|level| &level.y).collect();
        let diluted = self.cortex.cell.cue.regulator().is_some_and(|regulator| regulator.diluted);
        let past_of = |k: usize| -> Vec<PastChange> {
            let of = |i: usize| self.history.iter().zip(&weights[1..]).map(|(l, w)| w * l[k].stages[i]).sum::<f64>();
            let at = |i: usize, c: usize| -of(i * n + c) / weights[0];
            let carried = |i: usize| {
                let mut sum = [0.0; 3];
                let pairs = self.history.iter().zip(&levels).zip(&weights[1..]).filter(|_| n == REGULATED);
                for ((derivatives, level), weight) in pairs {
                    let change = change_of_carried(level, &derivatives[k], i, diluted);
                    sum.iter_mut().zip(change).for_each(|(sum, change)| *sum -= weight / weights[0] * change);
                }
                sum
            };
            (0..points).map(|i| PastChange { place: [at(i, R), at(i, Z)], carried: carried(i) }).collect()
        };
        let pasts: Vec<Vec<PastChange>> = (0..self.parameters.len()).map(past_of).collect();
        self.cortex.rate = stepper.cortex.rate;
        self.cortex.past.clone_from(&stepper.cortex.past);
        self.cortex.carried_past.clone_from(&stepper.cortex.carried_past);
        self.cortex.noise.clone_from(&stepper.cortex.noise);
        let newest = self.solve(y, &pasts);
        self.history.insert(0, newest);
        self.history.truncate(MAX_ORDER + 1);
    }

    /// Derivatives of the solution `y` of the current problem, given the derivatives of the past at every collocation
    /// point.
    fn solve(&mut self, y: &Solution, pasts: &[Vec<PastChange>]) -> Vec<Solution> {
        let mut y = y.clone();
        y.scalars.truncate(SHAPE_SCALARS);
        y.scalars.extend(self.cortex.free.iter().map(|p| p.get(&self.cortex.cell)));
        for (k, condition) in self.held.iter_mut().enumerate() {
            metric::scalar_condition(&y, SHAPE_SCALARS + k, y.scalars[SHAPE_SCALARS + k], condition);
        }
        self.sound &= self.system.factorise(&mut self.cortex, &y, &self.held).is_ok();
        if !self.sound {
            return Vec::new();
        }
        let integrals = self.system.dimensions().integrals;
        let one = |(k, past): (usize, &Vec<PastChange>)| -> Result<Solution, InvalidInput> {
            let (mut residual, mut direction) = (self.system.zero_residual(), Direction::default());
            self.add_past(&y, past, &mut residual.stages);
            // The system solves J δ = −residual: the parameter moves by one.
            residual.border[integrals + k] = -1.0;
            self.system.solve(&residual, &mut direction)?;
            let Direction { nodes, stages, scalars } = direction;
            Ok(Solution { mesh: y.mesh.clone(), nodes, stages, scalars, ..y })
        };
        let solved: Result<Vec<Solution>, InvalidInput> = pasts.iter().enumerate().map(one).collect();
        self.sound &= solved.is_ok();
        solved.unwrap_or_default()
    }

    /// Adds ∂F/∂past · `past` to the residuals at the stages. The equations are linear in the velocities, and these in
    /// the past, so that a difference of any size is the derivative.
    fn add_past(&self, y: &Solution, past: &[PastChange], stages: &mut [f64]) {
        if self.cortex.rate == 0.0 {
            return;
        }
        let mut moved = self.cortex.clone();
        for (place, change) in moved.past.iter_mut().zip(past) {
            place[0] += change.place[0];
            place[1] += change.place[1];
        }
        for (place, change) in moved.carried_past.iter_mut().zip(past) {
            let parts = place.parts();
            *place = std::array::from_fn(|k| parts[k] + change.carried[k]).into();
        }
        let (gauss, n) = (&self.system.gauss, y.components);
        let ([mut here, mut there], mut integrand) = ([[0.0; REGULATED]; 2], [0.0]);
        let (here, there) = (&mut here[..n], &mut there[..n]);
        for index in 0..y.intervals() * y.m {
            let (i, j) = (index / y.m, index % y.m);
            let at = CollocationPoint { x: y.stage_x(gauss, i, j), index };
            self.cortex.rhs(at, y.stage(i, j), &y.scalars, here, &mut integrand);
            moved.rhs(at, y.stage(i, j), &y.scalars, there, &mut integrand);
            let h = y.mesh[i + 1] - y.mesh[i];
            for c in 0..n {
                stages[index * n + c] -= h * (there[c] - here[c]);
            }
        }
    }

    /// Derivatives of the outcome at the last shape; `None` if a step could not be differentiated.
    pub(super) fn read(&self, stepper: &Stepper) -> Option<Vec<Sensitivity>> {
        let newest = self.history.first().filter(|_| self.sound)?;
        let shapes: Vec<&Solution> = stepper.history.iter().map(|level| &level.y).collect();
        let velocity = combination(&shapes[..stepper.weights.len()], &stepper.weights);
        let [chi_rate, u_rate, neck_rate] = self.along(shapes[0], &velocity)?;
        let of = |(k, derivative): (usize, &Solution)| {
            let [chi, u, neck] = self.along(shapes[0], derivative)?;
            let widened = if self.parameters[k] == Parameter::R0 { PINCH_OFF } else { 0.0 };
            let t_end = -(neck - widened) / neck_rate;
            // χ and u are evaluated on the last shape, and corrected for the shift t_end of the time of pinch-off.
            Some(Sensitivity { chi_signed: chi + chi_rate * t_end, u_furrow: u + u_rate * t_end, t_end })
        };
        newest.iter().enumerate().map(of).collect()
    }

    /// Derivatives of χ, the furrow's u and the neck's radius at shape `y` along a direction.
    fn along(&self, y: &Solution, direction: &Solution) -> Option<[f64; 3]> {
        let gauss = &self.system.gauss;
        let places = direction.stages.chunks_exact(direction.components);
        let largest = places.map(|s| s[R].abs().max(s[Z].abs())).fold(0.0, f64::max);
        if largest == 0.0 {
            return Some([0.0; 3]);
        }
        let step = DISPLACEMENT * self.cortex.cell.r0 / largest;
        let at = |amount: f64| {
            let moved = combination(&[y, direction], &[1.0, amount]);
            let neck = observables::neck(gauss, &moved)?;
            Some([observables::asymmetry(gauss, &moved, neck.u), neck.u, neck.radius])
        };
        let (above, below) = (at(step)?, at(-step)?);
        Some(std::array::from_fn(|i| (above[i] - below[i]) / (2.0 * step)))
    }
}

/// Derivatives of the past at a collocation point by a parameter.
#[derive(Clone, Copy)]
struct PastChange {
    /// Derivatives of (r, z).
    place: [f64; 2],
    /// Derivatives of the past of a regulator.
    carried: [f64; 3],
}

/// Derivatives of the parts of [`Carried`] at stage i of a shape along a direction.
fn change_of_carried(y: &Solution, direction: &Solution, i: usize, diluted: bool) -> [f64; 3] {
    let n = y.components;
    let (state, change) = (&y.stages[i * n..(i + 1) * n], &direction.stages[i * n..(i + 1) * n]);
    let (length, longer) = (y.scalars[LENGTH], direction.scalars[LENGTH]);
    let (sin, cos) = state[PSI].sin_cos();
    let c = 1.0 + state[PHI];
    let amount = match diluted {
        true => change[R] * length * c + state[R] * (longer * c + length * change[PHI]),
        false => change[PHI],
    };
    [amount, longer * cos - length * sin * change[PSI], -longer * sin - length * cos * change[PSI]]
}

/// Σ w_j y_j of solutions on one mesh.
fn combination(of: &[&Solution], weights: &[f64]) -> Solution {
    let sum = |get: fn(&Solution) -> &[f64]| -> Vec<f64> {
        let entry = |i: usize| of.iter().zip(weights).map(|(y, w)| w * get(y)[i]).sum();
        (0..get(of[0]).len()).map(entry).collect()
    };
    let (nodes, stages, scalars) = (sum(|y| &y.nodes), sum(|y| &y.stages), sum(|y| &y.scalars[..SHAPE_SCALARS]));
    Solution { mesh: of[0].mesh.clone(), nodes, stages, scalars, ..*of[0] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::division::{DivisionInput, DivisionOptions, divide, divide_with};
    use furrow_cell::cue::Quantity;
    use furrow_cell::{Cell, Cue, Numerics};

    /// Central differences of converged divisions by a parameter, of fourth order in the relative step `step`.
    fn differences(input: &DivisionInput, parameter: Parameter, step: f64) -> [f64; 3] {
        let value = parameter.get(&input.cell);
        let at = |amount: f64| {
            let mut moved = input.clone();
            parameter.set(&mut moved.cell, value * (1.0 + amount));
            let division = divide(&moved).unwrap();
            [division.chi_signed().unwrap(), division.u_furrow().unwrap(), division.t_end]
        };
        let [far, near] = [2.0, 1.0].map(|k| {
            let (above, below) = (at(k * step), at(-k * step));
            std::array::from_fn::<f64, 3, _>(|i| (above[i] - below[i]) / (2.0 * k * step * value))
        });
        std::array::from_fn(|i| (4.0 * near[i] - far[i]) / 3.0)
    }

    #[test]
    fn tangents_agree_with_differences() {
        let cue = |quantity| Parameter::Cue { term: 0, quantity };
        // Steps within which the outcome is smooth: it varies quickly with ε, and slowly enough with the others that
        // the remaining error of a division, 10⁻⁶, is small compared with the difference.
        let steps = [
            (Parameter::R0, 1e-2),
            (Parameter::XiS, 1e-2),
            (Parameter::Epsilon, 2e-3),
            (cue(Quantity::U0), 1e-2),
            (cue(Quantity::Omega), 2e-2),
            (cue(Quantity::Amplitude), 2e-2),
        ];
        let parameters = steps.map(|(parameter, _)| parameter);
        // Fine enough that differences of divisions approximate derivatives.
        let numerics = Numerics { time_tolerance: 1e-8, intervals: 96, noise: 0.0, ..Numerics::default() };
        let input =
            DivisionInput { numerics, ..DivisionInput::new(Cell::gao2026_thresholds(3.3).with_cue(Cue::published())) };
        let options = DivisionOptions { parameters: &parameters, ..DivisionOptions::default() };
        let (division, sensitivities) = divide_with(&input, options).unwrap();
        assert_eq!(division, divide(&input).unwrap());
        for ((parameter, step), found) in steps.into_iter().zip(sensitivities.unwrap()) {
            let expected = differences(&input, parameter, step);
            let found = [found.chi_signed, found.u_furrow, found.t_end];
            // A derivative close to zero is compared on the scale of a change of the parameter by its whole value.
            let floor = 3e-4 / parameter.get(&input.cell);
            for (found, expected) in found.into_iter().zip(expected) {
                assert!((found - expected).abs() < 5e-3 * expected.abs() + floor, "{parameter}: {found} {expected}");
            }
        }
    }

    #[test]
    fn an_undivided_cell_has_no_sensitivities() {
        let options = DivisionOptions { parameters: &[Parameter::R0], ..DivisionOptions::default() };
        let (division, sensitivities) =
            divide_with(&DivisionInput::new(Cell::gao2026_thresholds(1.6)), options).unwrap();
        assert!(division.chi().is_none() && sensitivities.is_none());
    }
}
