//! Singular points of a branch as roots: Newton on the extended system.
//!
//! A singularity is a scalar g on the solutions of F(x) = 0 that vanishes with it. With the problem's own Jacobian
//! bordered by a normalising row, regular at folds and pitchforks alike, the null directions b_k of F and the Newton
//! correction δ₀ follow from one factorisation, and
//!
//! * \[N.10 augmented\] g + g′\[δ₀\] + Σ_k s_k g′\[b_k\] = 0, x ← x + δ₀ + Σ_k s_k b_k
//!
//! is Newton's method on (F, g), with exact g′ from directional second derivatives: quadratic to machine precision. With
//! one free parameter there is one null direction; with two there are two, and a further linear condition closes the
//! system: the plane of a continuation, or a value for any one unknown.
//!
//! # References
//! Govaerts, *Numerical Methods for Bifurcations of Dynamical Equilibria*, SIAM 2000, ch. 3–4 (bordered test scalars).

use std::ops::AddAssign;

use crate::direction::{Direction, LinearCondition};
use crate::invalid::{InvalidInput, length};
use crate::linear::System;
use crate::mesh::{self, error_of_change};
use crate::metric::{self, Metric};
use crate::newton::Work;
use crate::problem::Directional;
use crate::solution::Solution;

use super::singularity::{SingularError, Singularity};

/// Newton on the extended system for a problem with one or two free parameters (its last scalar unknowns).
///
/// # Examples
/// The fold of u″ + λeᵘ = 0, u(0) = u(1) = 0, from the first point of the branch behind it. `Oscillator` is in
/// `examples/problems/oscillator.rs`.
///
/// ```
/// # mod oscillator { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/problems/oscillator.rs")); }
/// # use oscillator::Oscillator;
/// use furrow_bvp::{Continuation, ContinuationSettings, Fold, Metric, MinimallyAugmented};
/// let problem = Oscillator::bratu();
/// let (guess, metric) = (problem.zero(1.0, 20, 4, 0.0), Metric::unit(2, 1));
/// let settings = ContinuationSettings::default();
/// let mut branch = Continuation::start(problem.clone(), guess, metric.clone(), settings, true)?;
/// branch.follow([0.0, 10.0], 100, |_, advance| !advance.passed_fold)?;
/// let mut y = branch.state.solution.clone();
/// let mut point = MinimallyAugmented::new(problem, Fold::new(0), y.m, metric, &branch.state.tangent)?;
/// point.solve(&mut y, None)?;
/// assert!((y.scalars[0] - 3.513830719).abs() < 1e-8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct MinimallyAugmented<P, S> {
    /// The problem, one or two conditions short of square.
    pub problem: P,
    /// The singularity.
    pub singularity: S,
    /// Factors at the last iterate.
    pub system: System,
    /// Norm for the normalising row.
    pub metric: Metric,
    /// Null directions b_k at the last iterate: b_1 with the second parameter fixed.
    pub basis: [Direction; 2],
    /// g′\[b_k\] at the last iterate.
    pub slopes: [f64; 2],
    /// Iterations stop when a correction is below this.
    pub tolerance: f64,
    /// Iterations also stop when the next correction, predicted from the observed convergence, is below the tolerance. That saves one
    /// iteration; directions and slopes are then less accurate than the point. Iterations fail if corrections shrink slowly.
    pub predict_convergence: bool,
    /// The last ratio of a correction to the square of the correction before, or half of its value before if that is larger; 0 at first.
    contraction: f64,
    conditions: Vec<LinearCondition>,
    reference: Direction,
    step: Direction,
}

/// Work and quality of a singular point found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AugmentedReport {
    /// Newton iterations.
    pub iterations: usize,
    /// The first correction: the error of the start.
    pub first_correction: f64,
    /// The last correction.
    pub correction: f64,
    /// |g| before the last correction, relative to its slope along the branch: the distance still to go.
    pub distance: f64,
}

impl AddAssign<AugmentedReport> for Work {
    /// Every iteration has a factorisation of its own.
    fn add_assign(&mut self, report: AugmentedReport) {
        self.iterations += report.iterations;
        self.factorisations += report.iterations;
    }
}

/// Convergence is predicted only after corrections below this: directions and slopes, and with them the normal form, belong to the
/// iterate before the last correction.
const SMALL: f64 = 1e-6;

/// An estimate of the error needs no further iteration after a correction below this: the next is about its square.
const ROUGH: f64 = 1e-3;

/// Most iterations.
const MOST_ITERATIONS: usize = 15;

/// On the way along a curve, corrections that shrink no faster than this end the iteration.
const CONTRACTION: f64 = 0.5;

/// Largest correction applied in full.
const FARTHEST: f64 = 0.5;

/// Corrections that show the rate of convergence: rounding spoils the rate of smaller ones, the next order the rate of larger ones.
const RATES: std::ops::Range<f64> = 1e-8..1e-3;

impl<P: Directional, S: Singularity<P>> MinimallyAugmented<P, S> {
    /// For a problem near a point with the given tangent of its branch.
    ///
    /// # Errors
    /// [`SingularError::Invalid`] if the problem does not lack one condition for every free parameter, or cannot have such a
    /// singularity.
    pub fn new(
        problem: P,
        singularity: S,
        stages: usize,
        metric: Metric,
        tangent: &Direction,
    ) -> Result<Self, SingularError> {
        let dims = problem.dimensions();
        dims.check(stages).map_err(InvalidInput::from)?;
        let missing = dims.missing_conditions();
        if !(1..=2).contains(&missing) {
            return Err(InvalidInput::NotSquare { missing, allowed: "1 or 2" }.into());
        }
        let missing = missing.unsigned_abs();
        if dims.scalars < missing {
            let (name, length) = ("scalar unknowns", dims.scalars);
            return Err(InvalidInput::Length { name, length, expected: missing }.into());
        }
        singularity.check(&problem, dims)?;
        let mut reference = tangent.clone();
        // A tangent from a problem with fewer free parameters.
        reference.scalars.resize(dims.scalars, 0.0);
        Ok(MinimallyAugmented {
            system: System::new(dims, stages),
            problem,
            singularity,
            metric,
            basis: Default::default(),
            slopes: [0.0; 2],
            tolerance: 1e-11,
            predict_convergence: false,
            contraction: 0.0,
            conditions: vec![LinearCondition::default(); missing],
            reference,
            step: Direction::default(),
        })
    }

    /// Normalises by a direction that the branch is known to follow.
    pub fn set_reference(&mut self, tangent: &Direction) {
        self.reference.clone_from(tangent);
        self.reference.scalars.resize(self.system.dimensions().scalars, 0.0);
    }

    /// Sign of the singularity at a point of the branch.
    ///
    /// # Errors
    /// If a pivot vanishes.
    pub fn sign_at(&mut self, y: &Solution) -> Result<f64, SingularError> {
        let g = self.linearise(y)?;
        Ok(self.singularity.sign(g))
    }

    /// Carries the normalising direction over to another mesh.
    pub fn move_to(&mut self, from: &[f64], to: &[f64]) {
        metric::transfer_direction(&self.system.gauss, from, to, &mut self.reference);
        for direction in &mut self.basis {
            metric::transfer_direction(&self.system.gauss, from, to, direction);
        }
    }

    /// Factors, null directions and δ₀ at `y`; returns g.
    fn linearise(&mut self, y: &Solution) -> Result<f64, SingularError> {
        self.check(y)?;
        let MinimallyAugmented { problem, singularity, system, metric, basis, conditions, reference, step, .. } = self;
        metric.plane_through(y, reference, &mut conditions[0]);
        if conditions.len() > 1 {
            let last = y.scalars.len() - 1;
            metric::scalar_condition(y, last, y.scalars[last], &mut conditions[1]);
        }
        system.factorise(problem, y, conditions)?;
        system.solve_own(step)?;
        for (k, direction) in basis.iter_mut().enumerate().take(conditions.len()) {
            system.null_direction(k, direction)?;
        }
        reference.clone_from(&basis[0]);
        metric.normalise(&y.mesh, reference);
        Ok(singularity.evaluate(system, problem, &basis[0])?)
    }

    /// Checks that point, metric and normalising direction fit the problem; fields are public.
    fn check(&self, y: &Solution) -> Result<(), InvalidInput> {
        let MinimallyAugmented { problem, singularity, system, metric, reference, conditions, .. } = self;
        system.check(problem, y)?;
        length("free parameters of the problem", system.dimensions().linear_conditions(), conditions.len())?;
        length("scalars of the direction", reference.scalars.len(), y.scalars.len())?;
        length("node values of the direction", reference.nodes.len(), y.nodes.len())?;
        metric.check(y)?;
        singularity.check(problem, system.dimensions())
    }

    /// g′ along null direction `k`, or along δ₀.
    fn slope(&mut self, y: &Solution, k: Option<usize>) -> Result<f64, InvalidInput> {
        let MinimallyAugmented { problem, singularity, system, basis, step, .. } = self;
        singularity.derivative(system, problem, y, &basis[0], k.map_or(step, |k| &basis[k]))
    }

    /// Moves `y` onto the singular point. With two free parameters `closing` is needed.
    ///
    /// # Errors
    /// [`SingularError`]; `y` is then anywhere.
    pub fn solve(
        &mut self,
        y: &mut Solution,
        closing: Option<&LinearCondition>,
    ) -> Result<AugmentedReport, SingularError> {
        let mut report = AugmentedReport { correction: f64::INFINITY, ..Default::default() };
        while report.iterations < MOST_ITERATIONS {
            let before = report.correction;
            self.correction(y, closing, &mut report)?;
            // Far out, only a part of the step can be trusted.
            self.step.apply((FARTHEST / report.correction).min(1.0), y);
            if self.is_converged(before, report.correction) {
                self.problem.prepare(&y.scalars);
                return Ok(report);
            }
            // A curve can take a shorter step.
            if self.predict_convergence && report.correction > CONTRACTION * before {
                break;
            }
        }
        Err(SingularError::Stalled { iterations: report.iterations, correction: report.correction })
    }

    /// The correction of one Newton iteration on (F, g), in `step`.
    fn correction(
        &mut self,
        y: &Solution,
        closing: Option<&LinearCondition>,
        report: &mut AugmentedReport,
    ) -> Result<(), SingularError> {
        let g = self.linearise(y).map_err(|error| match error {
            SingularError::Invalid(_) => error,
            _ => SingularError::Singular { iterations: report.iterations },
        })?;
        if let Some(closing) = closing {
            closing.check(y.nodes.len(), y.scalars.len())?;
        }
        length("closing conditions", usize::from(closing.is_some()), self.conditions.len() - 1)?;
        report.iterations += 1;
        let constant = g + self.slope(y, None)?;
        self.slopes[0] = self.slope(y, Some(0))?;
        report.distance = (g / self.slopes[0]).abs();
        let shares = match closing {
            None => [-constant / self.slopes[0], 0.0],
            Some(closing) => {
                self.slopes[1] = self.slope(y, Some(1))?;
                self.closed_by(closing, y, constant)
            }
        };
        let MinimallyAugmented { basis, step, .. } = self;
        for (share, direction) in shares.iter().zip(basis.iter()).take(self.conditions.len()) {
            step.add(*share, direction);
        }
        report.correction = step.norm(y);
        if report.iterations == 1 {
            report.first_correction = report.correction;
        }
        if report.correction.is_finite() {
            Ok(())
        } else {
            Err(SingularError::Singular { iterations: report.iterations })
        }
    }

    /// Shares of both null directions in the correction: g′ along it is −`constant`, and it fulfils `closing`.
    fn closed_by(&self, closing: &LinearCondition, y: &Solution, constant: f64) -> [f64; 2] {
        let form = |d: &Direction| closing.form(&d.nodes, &d.scalars);
        let rest = metric::evaluate(closing, y) + form(&self.step) - closing.value;
        let [a, b] = self.slopes;
        let (c, d) = (form(&self.basis[0]), form(&self.basis[1]));
        let determinant = a * d - b * c;
        [(b * rest - d * constant) / determinant, (c * constant - a * rest) / determinant]
    }

    /// Whether a correction of norm `size` after one of norm `before` was the last.
    fn is_converged(&mut self, before: f64, size: f64) -> bool {
        if RATES.contains(&before) {
            self.contraction = (0.5 * self.contraction).max(size / (before * before));
        }
        // Quadratic convergence: the error after a step of size δ is of order δ².
        let expected = if self.predict_convergence && self.contraction > 0.0 {
            4.0 * self.contraction * size * size
        } else {
            f64::INFINITY
        };
        size <= self.tolerance.max(1e-3 * self.tolerance.sqrt()) || size < SMALL && expected <= self.tolerance
    }

    /// Recomputes factors, null directions and g′ along the branch at a point found by [predicted convergence](Self::predict_convergence).
    ///
    /// # Errors
    /// [`SingularError`] if a pivot vanishes.
    pub fn refresh(&mut self, y: &Solution) -> Result<(), SingularError> {
        self.linearise(y)?;
        self.slopes[0] = self.slope(y, Some(0))?;
        Ok(())
    }

    /// Direction of the curve of singular points in the two free parameters, of unit length.
    pub fn curve_direction(&self, y: &Solution) -> Direction {
        let mut direction = self.basis[0].clone();
        direction.scale(-self.slopes[1]);
        direction.add(self.slopes[0], &self.basis[1]);
        self.metric.normalise(&y.mesh, &mut direction);
        direction
    }
}

impl<P: Directional + Clone, S: Singularity<P> + Clone> MinimallyAugmented<P, S> {
    /// Estimates the error of the free parameters at a singular point that was found at `y`, by their change where the intervals
    /// are halved; infinite if the point is not found there. With two free parameters `along` is the tangent of the curve.
    pub fn error_estimate(&self, y: &Solution, along: Option<&Direction>) -> f64 {
        let free = y.scalars.len() - self.conditions.len().min(y.scalars.len());
        let change = |refined: Solution| {
            let changes = refined.scalars[free..].iter().zip(&y.scalars[free..]).map(|(to, from)| (to - from).abs());
            error_of_change(changes.fold(0.0, f64::max), y.m)
        };
        self.on_halved(y, along).map_or(f64::INFINITY, change)
    }

    /// The singular point on the mesh of halved intervals, to the accuracy that an estimate needs.
    fn on_halved(&self, y: &Solution, along: Option<&Direction>) -> Result<Solution, SingularError> {
        let (gauss, finer) = (&self.system.gauss, mesh::halved(&y.mesh));
        let moved = |direction: &Direction| {
            let mut direction = direction.clone();
            metric::transfer_direction(gauss, &y.mesh, &finer, &mut direction);
            direction
        };
        let mut refined = y.on_mesh(gauss, &finer);
        let closing = along.map(|along| {
            let mut closing = LinearCondition::default();
            self.metric.plane_through(&refined, &moved(along), &mut closing);
            closing
        });
        let (problem, singularity, reference) =
            (self.problem.clone(), self.singularity.clone(), moved(&self.reference));
        let mut point = MinimallyAugmented::new(problem, singularity, y.m, self.metric.clone(), &reference)?;
        let mut report = AugmentedReport::default();
        while report.iterations < MOST_ITERATIONS {
            point.correction(&refined, closing.as_ref(), &mut report)?;
            point.step.apply((FARTHEST / report.correction).min(1.0), &mut refined);
            if report.correction < ROUGH {
                return Ok(refined);
            }
        }
        Err(SingularError::Stalled { iterations: report.iterations, correction: report.correction })
    }
}
