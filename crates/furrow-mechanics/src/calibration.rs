//! Material and shell constants from measured thresholds.
//!
//! Given pitchfork thresholds ξ_s at some (R0, ε), the parameters θ minimise Σ_i ρ_i² with
//!
//! * \[F.1 residual\] ρ_i = weight_i (ξ_s*(R0_i, ε_i; θ) / ξ_s,i − 1),
//!
//! where a weight that is not given is in inverse proportion to the tolerance, so that Σ_i ρ_i² is least where χ² is.
//!
//! by Levenberg–Marquardt steps. The sensitivities ∂ξ_s*/∂θ are exact: directions of the curve of pitchforks in the
//! plane (ξ_s, θ), from the extended system. Singular values of ∂ρ/∂ln θ show the combinations of parameters that the
//! thresholds determine, and those that they leave open: stationary shapes depend on κ, p0, γ and the activity gξ only
//! through their ratios (M.18), and not at all on a common factor of the viscosities and the friction.
//!
//! # References
//! Nocedal & Wright, *Numerical Optimization*, Springer 2006, ch. 10.

use furrow_bvp::metric::scalar_condition;
use furrow_bvp::{LinearCondition, MinimallyAugmented, SingularError, Solution, SymmetryBreaking};
use furrow_spectra::{NoSingularValues, Svd};
use serde::{Deserialize, Serialize};

use crate::cortex::observables::elongation;
use crate::cortex::{Cortex, Domain};
use crate::equilibria::branch::metric;
use crate::equilibria::curves::along_scalar;
use crate::equilibria::point::XI;
use crate::equilibria::{BranchOptions, ShapeError, pitchfork};
use furrow_cell::{Cell, Numerics, Parameter};
use furrow_input::InputError;

pub mod statements;

use statements::{
    GivenCriticality, GivenDivision, GivenEpsilon, GivenFolds, GivenWindow, Prior, check_numbers, tolerance,
};

/// A measured pitchfork threshold.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Threshold {
    /// Cell radius R0.
    pub r0: f64,
    /// Volume fraction ε.
    pub epsilon: f64,
    /// Threshold ξ_s*, as published.
    pub xi_s: f64,
    /// Weight of its relative deviation; default: in inverse proportion to the tolerance.
    #[serde(default)]
    pub weight: Option<f64>,
    /// Its relative tolerance: the standard deviation for an ensemble of constants.
    #[serde(default = "tolerance")]
    pub tolerance: f64,
}

impl Threshold {
    /// The measured cell, with the constants of another.
    pub fn cell(&self, constants: &Cell) -> Cell {
        Cell { r0: self.r0, epsilon: self.epsilon, ..constants.clone() }
    }

    /// Checks every value; `name` is the threshold's place in the file, which errors call `source_name`.
    ///
    /// # Errors
    /// Names the field, its value and the allowed values.
    pub fn check(&self, source_name: &str, name: &str) -> Result<(), InputError> {
        let Threshold { r0, epsilon, xi_s, weight, tolerance } = *self;
        let weight = weight.unwrap_or(1.0);
        let numbers = [("r0", r0), ("epsilon", epsilon), ("xi_s", xi_s), ("weight", weight), ("tolerance", tolerance)];
        check_numbers(source_name, name, &numbers)
    }
}

/// A parameter to fit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Unknown {
    /// The parameter.
    pub parameter: Parameter,
    /// Its starting value; default: its present value.
    #[serde(default)]
    pub start: Option<f64>,
}

/// The fitted parameters, and the data.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Targets {
    /// Parameters to fit.
    pub unknowns: Vec<Unknown>,
    /// Measured thresholds.
    pub thresholds: Vec<Threshold>,
    /// Known sides of asymmetric branches.
    #[serde(default)]
    pub criticalities: Vec<GivenCriticality>,
    /// Known orders of folds.
    #[serde(default)]
    pub folds: Vec<GivenFolds>,
    /// Activities between a pitchfork and a turning point.
    #[serde(default)]
    pub windows: Vec<GivenWindow>,
    /// Known divisions.
    #[serde(default)]
    pub divisions: Vec<GivenDivision>,
    /// Critical volume fractions of division.
    #[serde(default)]
    pub critical_epsilons: Vec<GivenEpsilon>,
    /// Prior knowledge of constants.
    #[serde(default)]
    pub priors: Vec<Prior>,
}

/// A given threshold beside the computed one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ThresholdResidual {
    /// Cell radius R0.
    pub r0: f64,
    /// Volume fraction ε.
    pub epsilon: f64,
    /// Threshold ξ_s* given.
    pub xi_s: f64,
    /// Threshold ξ_s* of the model.
    pub computed: f64,
    /// computed / given − 1.
    pub relative: f64,
    /// Weight.
    pub weight: f64,
}

/// A direction in the space of the parameters, and how well the thresholds determine it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Combination {
    /// Relative change of the thresholds per relative change of the parameters along this direction.
    pub singular_value: f64,
    /// Whether the thresholds determine it at all.
    pub determined: bool,
    /// Its components, one for each parameter: relative changes, with Σ² = 1.
    pub components: Vec<f64>,
}

/// The fitted parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    /// Parameters with their values.
    pub parameters: Vec<(Parameter, f64)>,
    /// The cell with these parameters; all others are unchanged.
    pub cell: Cell,
    /// Given thresholds beside the computed ones.
    pub residuals: Vec<ThresholdResidual>,
    /// Root mean square of the relative deviations.
    pub rms: f64,
    /// Directions in order of decreasing singular value.
    pub combinations: Vec<Combination>,
    /// Steps accepted.
    pub iterations: usize,
}

/// Why no parameters were found.
#[expect(missing_docs, reason = "the messages say what the fields are")]
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CalibrateError {
    /// A threshold cannot be computed at the start of the search.
    #[error("threshold {index}: {source}; start from other values")]
    Threshold { index: usize, source: ShapeError },
    /// The sensitivity of a threshold cannot be computed.
    #[error("threshold {index}: no sensitivity to {parameter}: {source}")]
    Sensitivity { index: usize, parameter: Parameter, source: SingularError },
    /// The sensitivities have no singular values.
    #[error("the sensitivities of the thresholds: {0}")]
    NotFinite(#[from] NoSingularValues),
    /// The search does not end.
    #[error("the deviations are still {rms:.3e} (rms) and falling after {iterations} steps; start from other values")]
    Stalled { iterations: usize, rms: f64 },
}

type Result<T, E = CalibrateError> = std::result::Result<T, E>;

/// Most steps.
const MOST: usize = 100;
/// Longest step in ln θ.
const LONGEST: f64 = 0.25;
/// Singular values below this fraction of the largest count as zero.
const NIL: f64 = 1e-7;

impl Targets {
    /// The starting values of the unknowns: their own, or else the values of `cell`.
    pub fn starts(&self, cell: &Cell) -> Vec<(Parameter, f64)> {
        self.unknowns.iter().map(|u| (u.parameter, u.start.unwrap_or(u.parameter.get(cell)))).collect()
    }

    /// The weights of the thresholds. Those that are not given are in inverse proportion to the tolerances, with a mean square of 1.
    pub fn weights(&self) -> Vec<f64> {
        let own: Vec<&Threshold> = self.thresholds.iter().filter(|t| t.weight.is_none()).collect();
        let scale = (own.iter().map(|t| t.tolerance.powi(-2)).sum::<f64>() / own.len() as f64).sqrt().recip();
        // Of tolerances that are all equal the weight is 1 without rounding.
        let is_equal = own.windows(2).all(|pair| pair[0].tolerance == pair[1].tolerance);
        let of = |t: &Threshold| t.weight.unwrap_or(if is_equal { 1.0 } else { scale / t.tolerance });
        self.thresholds.iter().map(of).collect()
    }

    /// Whether all weights are in inverse proportion to the tolerances.
    pub fn is_weighted_by_tolerances(&self) -> bool {
        let shares = self.weights().into_iter().zip(&self.thresholds).map(|(weight, t)| weight * t.tolerance);
        let [least, most] = shares.fold([f64::INFINITY, 0.0], |[a, b]: [f64; 2], x| [a.min(x), b.max(x)]);
        most - least <= 1e-9 * most
    }

    /// Checks every value; `source_name` is the name of the file in errors.
    ///
    /// # Errors
    /// Names the field, its value and the allowed values.
    pub fn check(&self, source_name: &str) -> Result<(), InputError> {
        let refuse =
            |field: &str, value: &str, allowed: &str| Err(InputError::not_allowed(source_name, field, value, allowed));
        if self.unknowns.is_empty() {
            return refuse("unknowns", "[]", "at least one parameter");
        }
        if self.thresholds.is_empty() {
            return refuse("thresholds", "[]", "at least one threshold");
        }
        for (k, &Unknown { parameter, start }) in self.unknowns.iter().enumerate() {
            let (name, shown) = (format!("unknowns[{k}].parameter"), parameter.to_string());
            if !LOGARITHMIC.contains(&parameter) && !LINEAR.contains(&parameter) {
                let allowed = "one of gain, xi_ratio, aspect, p0, w, kappa, eta_b, eta_s, friction, tension, spontaneous_curvature";
                return refuse(&name, &shown, allowed);
            }
            if self.unknowns[..k].iter().any(|other| other.parameter == parameter) {
                return refuse(&name, &shown, "named only once");
            }
            let (low, allowed) = match LINEAR.contains(&parameter) {
                true => (f64::NEG_INFINITY, "a finite number"),
                false => (0.0, "a finite number above 0"),
            };
            if let Some(value) = start.filter(|value| !(value.is_finite() && *value > low)) {
                return refuse(&format!("unknowns[{k}].start"), &value.to_string(), allowed);
            }
        }
        for (k, t) in self.thresholds.iter().enumerate() {
            t.check(source_name, &format!("thresholds[{k}]"))?;
        }
        self.check_statements(source_name)
    }
}

/// Positive parameters, varied by their logarithm.
const LOGARITHMIC: [Parameter; 8] = {
    use Parameter::{Aspect, EtaB, EtaS, Friction, Gain, Kappa, P0, W};
    [Gain, Aspect, P0, W, Kappa, EtaB, EtaS, Friction]
};
/// Parameters of either sign, varied in units of 1 (or of their size, if larger).
const LINEAR: [Parameter; 3] = [Parameter::XiRatio, Parameter::Tension, Parameter::SpontaneousCurvature];

/// A cell with other values of some parameters.
pub fn with_values(cell: &Cell, parameters: &[(Parameter, f64)]) -> Cell {
    let mut out = cell.clone();
    parameters.iter().for_each(|(parameter, value)| parameter.set(&mut out, *value));
    out
}

/// θ moved by δ in the coordinates of the search: relative changes; for parameters of either sign, changes relative to
/// their size or 1.
pub fn moved(parameters: &[(Parameter, f64)], delta: &[f64]) -> Vec<(Parameter, f64)> {
    let step = |(&(parameter, value), d): (&(Parameter, f64), &f64)| match LINEAR.contains(&parameter) {
        true => (parameter, value + d * value.abs().max(1.0)),
        false => (parameter, value * d.exp()),
    };
    parameters.iter().zip(delta).map(step).collect()
}

impl Calibration {
    /// The δ with which [`moved`] leads from other values of these parameters to the fitted ones.
    pub fn moves_from(&self, start: &[(Parameter, f64)]) -> Vec<f64> {
        let offset = |(&(parameter, from), &(_, to)): (&(Parameter, f64), &(Parameter, f64))| {
            if LINEAR.contains(&parameter) { (to - from) / from.abs().max(1.0) } else { (to / from).ln() }
        };
        start.iter().zip(&self.parameters).map(offset).collect()
    }
}

/// dθ/dx for the coordinates x of the search.
fn unit(parameter: Parameter, value: f64) -> f64 {
    if LINEAR.contains(&parameter) { value.abs().max(1.0) } else { value }
}

/// The first pitchfork at given parameters: by Newton's method from a neighbouring pitchfork if there is one, else
/// along the branch.
fn threshold(cell: &Cell, numerics: &Numerics, near: Option<&Solution>) -> Result<Solution, ShapeError> {
    if let Some(near) = near {
        let free = [Parameter::XiS];
        let cortex = Cortex::new(cell, Domain::Half, &free);
        let metric = metric(cell, &free);
        let mut y = near.clone();
        let tangent = along_scalar(&y, y.scalars.len(), XI);
        let augmented = MinimallyAugmented::new(cortex, SymmetryBreaking::default(), y.m, metric, &tangent);
        if let Ok(report) = augmented.and_then(|mut augmented| augmented.solve(&mut y, None)) {
            let [before, after] = [near, &y].map(|y| elongation(y, Domain::Half, cell.r0));
            // A larger change of elongation would mean another pitchfork.
            if report.iterations <= 8 && (before - after).abs() < 0.1 && y.scalars[XI] > 0.0 {
                return Ok(y);
            }
        }
    }
    pitchfork::first(cell, numerics, &BranchOptions::default()).map(|pitchfork| pitchfork.shape)
}

/// ∂ξ_s*/∂θ of the pitchfork `y`.
///
/// # Errors
/// [`SingularError`] if the curve of pitchforks has no such slope.
pub fn sensitivity(cell: &Cell, y: &Solution, parameter: Parameter) -> Result<f64, SingularError> {
    let free = [Parameter::XiS, parameter];
    let cortex = Cortex::new(cell, Domain::Half, &free);
    let metric = metric(cell, &free);
    let (mut y, value) = (y.clone(), cortex.get(parameter));
    y.scalars.push(value);
    let tangent = along_scalar(&y, y.scalars.len(), XI);
    let mut augmented = MinimallyAugmented::new(cortex, SymmetryBreaking::default(), y.m, metric, &tangent)?;
    let mut closing = LinearCondition::default();
    scalar_condition(&y, XI + 1, value, &mut closing);
    augmented.solve(&mut y, Some(&closing))?;
    let direction = augmented.curve_direction(&y);
    Ok(direction.scalars[XI] / direction.scalars[XI + 1])
}

/// The thresholds at one set of parameters.
struct Evaluation {
    shapes: Vec<Solution>,
    residuals: Vec<f64>,
    cost: f64,
}

fn evaluate(targets: &Targets, cell: &Cell, numerics: &Numerics, near: Option<&[Solution]>) -> Result<Evaluation> {
    let mut out = Evaluation { shapes: Vec::new(), residuals: Vec::new(), cost: 0.0 };
    for (index, (t, weight)) in targets.thresholds.iter().zip(targets.weights()).enumerate() {
        let y = threshold(&t.cell(cell), numerics, near.map(|near| &near[index]))
            .map_err(|source| CalibrateError::Threshold { index, source })?;
        let residual = weight * (y.scalars[XI] / t.xi_s - 1.0);
        out.cost += residual * residual;
        out.residuals.push(residual);
        out.shapes.push(y);
    }
    Ok(out)
}

/// ∂ρ/∂x in the search's coordinates.
fn jacobian(targets: &Targets, cell: &Cell, theta: &[(Parameter, f64)], shapes: &[Solution]) -> Result<Vec<Vec<f64>>> {
    let weights = targets.weights();
    let entry = |index: usize, parameter: Parameter, value: f64| {
        let t = &targets.thresholds[index];
        let slope = sensitivity(&t.cell(cell), &shapes[index], parameter)
            .map_err(|source| CalibrateError::Sensitivity { index, parameter, source })?;
        Ok(weights[index] / t.xi_s * slope * unit(parameter, value))
    };
    let row = |index| theta.iter().map(|&(parameter, value)| entry(index, parameter, value)).collect();
    (0..targets.thresholds.len()).map(row).collect()
}

/// The step −(JᵀJ + λ²)⁻¹ Jᵀ ρ, zero in directions without sensitivity.
fn step(svd: &Svd, residuals: &[f64], lambda: f64) -> Vec<f64> {
    let mut out = vec![0.0; svd.right.len()];
    for (k, &value) in svd.values.iter().enumerate() {
        if value <= NIL * svd.values[0] {
            continue;
        }
        let along: f64 = svd.left[k].iter().zip(residuals).map(|(u, r)| u * r).sum();
        let size = -value * along / (value * value + lambda * lambda);
        out.iter_mut().zip(&svd.right[k]).for_each(|(x, v)| *x += size * v);
    }
    let longest = out.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    if longest > LONGEST {
        out.iter_mut().for_each(|x| *x *= LONGEST / longest);
    }
    out
}

fn combinations(svd: &Svd) -> Vec<Combination> {
    let one = |(k, right): (usize, &Vec<f64>)| {
        let singular_value = svd.values.get(k).copied().unwrap_or(0.0);
        let determined = singular_value > NIL * svd.values[0];
        // The largest component is positive.
        let largest = right.iter().fold(0.0f64, |m, v| if v.abs() > m.abs() { *v } else { m });
        Combination { singular_value, determined, components: right.iter().map(|v| v * largest.signum()).collect() }
    };
    svd.right.iter().enumerate().map(one).collect()
}

/// Finds the parameters that fit the thresholds best, starting from the constants of `cell` and the starts of the unknowns.
///
/// # Examples
/// The shell's strength from one threshold of the paper:
///
/// ```
/// use furrow_mechanics::calibration::{Targets, calibrate};
/// use furrow_cell::{Cell, Numerics};
/// use furrow_input::parse_document;
/// let text = "Targets(unknowns: [(parameter: p0)], thresholds: [(r0: 2, epsilon: 0.87, xi_s: 22.006)])";
/// let targets: Targets = parse_document(text, "targets.ron", "a file of targets", "Targets")?;
/// let found = calibrate(&targets, &Cell::new(2.0), &Numerics { intervals: 32, ..Numerics::default() })?;
/// assert!(found.rms < 1e-6 && (found.cell.shell.p0 - 0.1).abs() < 0.003);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`CalibrateError`].
pub fn calibrate(targets: &Targets, cell: &Cell, numerics: &Numerics) -> Result<Calibration> {
    let mut parameters = targets.starts(cell);
    let mut now = evaluate(targets, &with_values(cell, &parameters), numerics, None)?;
    let (mut lambda, mut iterations, count) = (None, 0, targets.thresholds.len() as f64);
    let decomposition = loop {
        let here = with_values(cell, &parameters);
        let decomposition = Svd::of_rows(&jacobian(targets, &here, &parameters, &now.shapes)?)?;
        let mut damping = lambda.unwrap_or(1e-2 * decomposition.values[0]);
        let settled = loop {
            let step = step(&decomposition, &now.residuals, damping);
            let size = step.iter().fold(0.0f64, |m, v| m.max(v.abs()));
            if size < 1e-11 {
                break true;
            }
            let trial = moved(&parameters, &step);
            match evaluate(targets, &with_values(cell, &trial), numerics, Some(&now.shapes)) {
                // At the level of rounding, the cost no longer decreases.
                Ok(next) if next.cost < now.cost => {
                    let settled = now.cost - next.cost < 1e-15 * now.cost && size < 1e-7;
                    (parameters, now) = (trial, next);
                    iterations += 1;
                    damping *= 0.1;
                    break settled;
                }
                _ if size < 1e-8 => break true,
                _ => damping = (damping * 8.0).max(1e-6 * decomposition.values[0]),
            }
        };
        lambda = Some(if damping < 1e-9 * decomposition.values[0] { 0.0 } else { damping });
        if settled {
            let here = with_values(cell, &parameters);
            break Svd::of_rows(&jacobian(targets, &here, &parameters, &now.shapes)?)?;
        }
        if iterations >= MOST {
            return Err(CalibrateError::Stalled { iterations, rms: (now.cost / count).sqrt() });
        }
    };
    // Newton's method from neighbours may have left the first pitchfork of the branch: search again from the passive
    // shape.
    let fitted = with_values(cell, &parameters);
    let last = evaluate(targets, &fitted, numerics, None)?;
    let row = |((t, y), weight): ((&Threshold, &Solution), f64)| ThresholdResidual {
        r0: t.r0,
        epsilon: t.epsilon,
        xi_s: t.xi_s,
        computed: y.scalars[XI],
        relative: y.scalars[XI] / t.xi_s - 1.0,
        weight,
    };
    let residuals: Vec<_> = targets.thresholds.iter().zip(&last.shapes).zip(targets.weights()).map(row).collect();
    Ok(Calibration {
        cell: fitted,
        rms: (residuals.iter().map(|residual| residual.relative.powi(2)).sum::<f64>() / count).sqrt(),
        residuals,
        combinations: combinations(&decomposition),
        parameters,
        iterations,
    })
}
