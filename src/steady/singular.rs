//! Singular points of a branch as roots: Newton on the extended system.
//!
//! A singularity is a scalar g on the solutions of F(x) = 0 that vanishes with it. With the problem's own Jacobian
//! bordered by a normalising row, regular at folds and pitchforks alike, the null directions b_k of F and the Newton
//! correction δ₀ follow from one factorisation, and
//!
//! * \[extended\] g + g′\[δ₀\] + Σ_k s_k g′\[b_k\] = 0, x ← x + δ₀ + Σ_k s_k b_k
//!
//! is Newton's method on (F, g), with exact g′ from directional second derivatives: quadratic to machine precision. With
//! one free parameter there is one null direction; with two there are two, and a further linear condition closes the
//! system: the plane of a continuation, or a value for any one unknown.
//!
//! # References
//! Govaerts, *Numerical Methods for Bifurcations of Dynamical Equilibria*, SIAM 2000, ch. 3–4 (bordered test scalars).

use super::directional::{Directional, second_residual};
use super::path::{self, Metric};
use crate::numerics::block::{EndRows, VariantEnd};
use crate::numerics::dense::PivotFailure;
use crate::numerics::system::{Residual, Update};
use crate::numerics::{BoundaryValueProblem, LinearCondition, Solution, System};

/// Why a singular point was not found.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SingularError {
    /// A pivot vanished where the extended system should be regular.
    #[error(
        "the extended system is singular after {iterations} iterations: two singularities coincide, or none is near"
    )]
    Singular {
        /// Iterations done.
        iterations: usize,
    },
    /// The iteration does not converge.
    #[error("no convergence to the singular point in {iterations} iterations (last correction {correction:.3e})")]
    Stalled {
        /// Iterations done.
        iterations: usize,
        /// Last correction.
        correction: f64,
    },
    /// The iteration converges, but to another singular point than the one looked for.
    #[error("the iteration leads to another one, {distance:.1e} times the distance of the points around it away")]
    Elsewhere {
        /// How far outside the bracket, in its lengths.
        distance: f64,
    },
}

impl From<PivotFailure> for SingularError {
    fn from(_: PivotFailure) -> Self {
        SingularError::Singular { iterations: 0 }
    }
}

/// A scalar g(x) that vanishes at a kind of singular point.
pub trait Singularity<P> {
    /// g at the point whose factors `system` holds; `w` is the null direction of F with all but the first free parameter
    /// fixed, normalised by the first linear condition of `system`.
    ///
    /// # Errors
    /// If g cannot be computed for a vanishing pivot.
    fn evaluate(&mut self, system: &mut System, problem: &P, w: &Update) -> Result<f64, PivotFailure>;

    /// Sign that changes at the singularity and nowhere else, for the value of g just computed.
    fn sign(&self, g: f64) -> f64 {
        g.signum()
    }

    /// Derivative of g along `d`, after [`evaluate`](Self::evaluate) at the same place.
    fn derivative(&mut self, system: &mut System, problem: &mut P, y: &Solution, w: &Update, d: &Update) -> f64;
}

/// A turning point of scalar unknown `parameter`: g = its component in w.
#[derive(Clone, Debug)]
pub struct Fold {
    /// Index of the parameter among the scalar unknowns.
    pub parameter: usize,
    residual: Residual,
    change: Update,
}

impl Fold {
    /// For a parameter given by its index.
    pub fn new(parameter: usize) -> Fold {
        Fold { parameter, residual: Residual::default(), change: Update::default() }
    }
}

impl<P: Directional> Singularity<P> for Fold {
    fn evaluate(&mut self, _: &mut System, _: &P, w: &Update) -> Result<f64, PivotFailure> {
        Ok(w.scalars[self.parameter])
    }

    /// J w = 0 along x + d: J w′ = −D²F\[d, w\].
    fn derivative(&mut self, system: &mut System, problem: &mut P, y: &Solution, w: &Update, d: &Update) -> f64 {
        let conditions = free_parameters(system);
        second_residual(&system.gauss, problem, y, [d, w], conditions, &mut self.residual);
        system.solve(&self.residual, &mut self.change);
        self.change.scalars[self.parameter]
    }
}

fn free_parameters(system: &System) -> usize {
    system.dimensions().missing_conditions().max(0) as usize
}

/// A problem on the half of a mirror-symmetric domain, whose right end is the mirror.
pub trait MirrorSymmetric: BoundaryValueProblem {
    /// Components that vanish at the mirror in antisymmetric perturbations: as many as make these, with the left
    /// conditions, a square problem.
    fn vanishing_at_mirror(&self) -> &[usize];

    /// Components that are free at the mirror in antisymmetric perturbations, the preferred one for normalising first.
    fn free_at_mirror(&self) -> &[usize];
}

/// A pitchfork: the antisymmetric problem J_a φ = 0 on the half domain has a solution.
///
/// With the last of the conditions at the mirror replaced by (component `normaliser` of φ) = 1, g is what φ leaves of the
/// condition replaced. Then det J_a = g · det of the replaced problem, and the same factors project any right-hand side
/// on the left null vector.
#[derive(Clone, Debug, Default)]
pub struct SymmetryBreaking {
    /// The antisymmetric solution φ of the replaced problem; at g = 0 the null vector.
    pub null: Update,
    /// The replaced problem is regular for this component at the mirror set to 1.
    pub normaliser: usize,
    /// Sign of det J_a (up to a sign fixed per problem), and ln |det J_a|.
    pub determinant: (f64, f64),
    replaced: usize,
    end: VariantEnd,
    right: Vec<f64>,
    residual: Residual,
    change: Update,
}

impl SymmetryBreaking {
    /// Sign and logarithm of det J_a alone, for watching a branch: the antisymmetric determinant on the factorised
    /// intervals in `system`.
    ///
    /// # Errors
    /// If a pivot is not finite.
    pub fn test<P: MirrorSymmetric>(&mut self, system: &System, problem: &P) -> Result<(f64, f64), PivotFailure> {
        let det = self.factor(system, problem.vanishing_at_mirror().iter().copied())?;
        Ok((det.sign, det.log_abs))
    }

    /// Factors of the antisymmetric problem with the components in `vanishing` zero at the mirror.
    fn factor(
        &mut self,
        system: &System,
        vanishing: impl Iterator<Item = usize>,
    ) -> Result<crate::numerics::dense::Determinant, PivotFailure> {
        let n = system.dimensions().components;
        self.right.clear();
        let mut rows = 0;
        for component in vanishing {
            self.right.extend((0..n).map(|c| if c == component { 1.0 } else { 0.0 }));
            rows += 1;
        }
        system.factor_variant(EndRows { ry: &self.right, rp: &[], rows }, &mut self.end)
    }

    /// Component of J_a⁻¹-like projection: what the solution for −`residual` leaves of the condition replaced. Zero for
    /// every residual in the range of J_a at g = 0.
    pub fn project(&mut self, system: &mut System, residual: &Residual) -> f64 {
        system.solve_variant_last_node(&self.end, residual, &mut self.change);
        self.change.nodes[self.change.nodes.len() - system.dimensions().components + self.replaced]
    }
}

/// A null vector this much larger than its normalising component asks for another one.
const LARGE: f64 = 1e4;

impl<P: Directional + MirrorSymmetric> Singularity<P> for SymmetryBreaking {
    fn evaluate(&mut self, system: &mut System, problem: &P, _w: &Update) -> Result<f64, PivotFailure> {
        let n = system.dimensions().components;
        let mut failure = PivotFailure { column: 0, non_finite: false };
        for attempt in 0..problem.free_at_mirror().len() {
            let vanishing = problem.vanishing_at_mirror();
            let count = vanishing.len();
            let normaliser = problem.free_at_mirror()[attempt];
            let rows = vanishing[..count - 1].iter().copied().chain([normaliser]);
            self.replaced = vanishing[count - 1];
            self.normaliser = normaliser;
            let det = match self.factor(system, rows) {
                Ok(det) if det.sign != 0.0 => det,
                Ok(_) => continue,
                Err(error) => {
                    failure = error;
                    continue;
                }
            };
            let mut right = [0.0; 32];
            right[count - 1] = 1.0;
            system.solve_variant_unit(&self.end, &right[..count], &mut self.null);
            let largest = self.null.nodes.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
            if largest < LARGE || attempt + 1 == problem.free_at_mirror().len() {
                let g = self.null.nodes[self.null.nodes.len() - n + self.replaced];
                self.determinant = (det.sign * g.signum(), det.log_abs + g.abs().ln());
                return Ok(g);
            }
        }
        Err(failure)
    }

    /// g changes sign at the poles of the replaced problem as well.
    fn sign(&self, _: f64) -> f64 {
        self.determinant.0
    }

    /// The replaced problem K φ = const along x + d: K φ′ = −D²F\[d, φ\].
    fn derivative(&mut self, system: &mut System, problem: &mut P, y: &Solution, _w: &Update, d: &Update) -> f64 {
        let mut residual = std::mem::take(&mut self.residual);
        second_residual(&system.gauss, problem, y, [d, &self.null], 0, &mut residual);
        residual.right.clear();
        residual.right.resize(problem.vanishing_at_mirror().len(), 0.0);
        let change = self.project(system, &residual);
        self.residual = residual;
        change
    }
}

/// Newton on the extended system for a problem with one or two free parameters (its last scalar unknowns).
#[derive(Clone, Debug)]
pub struct Extended<P, S> {
    /// The problem, one or two conditions short of square.
    pub problem: P,
    /// The singularity.
    pub singularity: S,
    /// Factors at the last iterate.
    pub system: System,
    /// Norm for the normalising row.
    pub metric: Metric,
    /// Null directions b_k at the last iterate: b_1 with the second parameter fixed.
    pub basis: [Update; 2],
    /// g′\[b_k\] at the last iterate.
    pub slopes: [f64; 2],
    /// Iterations stop when a correction is below this.
    pub tolerance: f64,
    /// Iterations also stop when, from the convergence seen so far, the next correction would be below the tolerance:
    /// one iteration less, with directions and slopes that are less exact than the point.
    pub trusting: bool,
    /// Largest ratio seen of a correction to the square of the one before; 0 if none was seen.
    contraction: f64,
    conditions: Vec<LinearCondition>,
    reference: Update,
    step: Update,
}

/// Work and quality of a singular point found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ExtendedReport {
    /// Newton iterations.
    pub iterations: usize,
    /// The first correction: the error of the start.
    pub first_correction: f64,
    /// The last correction.
    pub correction: f64,
    /// |g| before the last correction, relative to its slope along the branch: the distance still to go.
    pub distance: f64,
}

/// Only after corrections below this may the last one be taken on trust: directions and slopes, and the normal form that
/// follows from them, are those of the iterate before it.
const SMALL: f64 = 1e-6;

impl<P: Directional, S: Singularity<P>> Extended<P, S> {
    /// For a problem near a point whose branch has the given tangent.
    pub fn new(problem: P, singularity: S, stages: usize, metric: Metric, tangent: &Update) -> Self {
        let dims = problem.dimensions();
        let mut reference = tangent.clone();
        // A tangent from a problem with fewer free parameters.
        reference.scalars.resize(dims.scalars, 0.0);
        Extended {
            system: System::new(dims, stages),
            problem,
            singularity,
            metric,
            basis: Default::default(),
            slopes: [0.0; 2],
            tolerance: 1e-11,
            trusting: false,
            contraction: 0.0,
            conditions: vec![LinearCondition::default(); dims.missing_conditions().max(0) as usize],
            reference,
            step: Update::default(),
        }
    }

    /// Normalises by a direction that the branch is known to follow.
    pub fn set_reference(&mut self, tangent: &Update) {
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
        path::transfer_direction(&self.system.gauss, from, to, &mut self.reference);
        for direction in &mut self.basis {
            path::transfer_direction(&self.system.gauss, from, to, direction);
        }
    }

    /// Factors, null directions and δ₀ at `y`; returns g.
    fn linearise(&mut self, y: &Solution) -> Result<f64, SingularError> {
        let Extended { problem, singularity, system, metric, basis, conditions, reference, step, .. } = self;
        metric.plane_through(y, reference, &mut conditions[0]);
        if conditions.len() > 1 {
            let last = y.scalars.len() - 1;
            path::scalar_condition(y, last, y.scalars[last], &mut conditions[1]);
        }
        system.evaluate(problem, y, conditions, true);
        system.condense()?;
        system.factor_blocks(conditions)?;
        system.solve_own(step);
        for (k, direction) in basis.iter_mut().enumerate().take(conditions.len()) {
            path::null_direction(system, k, direction);
        }
        reference.clone_from(&basis[0]);
        metric.normalise(&y.mesh, reference);
        Ok(singularity.evaluate(system, problem, &basis[0])?)
    }

    fn slope(&mut self, y: &Solution, along: Along) -> f64 {
        let Extended { problem, singularity, system, basis, step, .. } = self;
        let d = match along {
            Along::Step => &*step,
            Along::Basis(k) => &basis[k],
        };
        singularity.derivative(system, problem, y, &basis[0], d)
    }

    /// Moves `y` onto the singular point. With two free parameters `closing` is needed.
    ///
    /// # Errors
    /// [`SingularError`]; `y` is then anywhere.
    pub fn solve(
        &mut self,
        y: &mut Solution,
        closing: Option<&LinearCondition>,
    ) -> Result<ExtendedReport, SingularError> {
        const MOST: usize = 15;
        let mut report = ExtendedReport { correction: f64::INFINITY, ..Default::default() };
        let mut before = f64::INFINITY;
        while report.iterations < MOST {
            let singular = |_| SingularError::Singular { iterations: report.iterations };
            let g = self.linearise(y).map_err(singular)?;
            report.iterations += 1;
            let constant = g + self.slope(y, Along::Step);
            self.slopes[0] = self.slope(y, Along::Basis(0));
            report.distance = (g / self.slopes[0]).abs();
            let s = match closing {
                None => [-constant / self.slopes[0], 0.0],
                Some(closing) => {
                    self.slopes[1] = self.slope(y, Along::Basis(1));
                    let form = |d: &Update| {
                        let dot = |w: &[f64], v: &[f64]| w.iter().zip(v).map(|(w, v)| w * v).sum::<f64>();
                        dot(&closing.nodes, &d.nodes) + dot(&closing.scalars, &d.scalars)
                    };
                    let rest = path::evaluate(closing, y) + form(&self.step) - closing.value;
                    let [a, b] = self.slopes;
                    let (c, d) = (form(&self.basis[0]), form(&self.basis[1]));
                    let determinant = a * d - b * c;
                    [(b * rest - d * constant) / determinant, (c * constant - a * rest) / determinant]
                }
            };
            let Extended { basis, step, .. } = self;
            for (s, direction) in s.iter().zip(basis.iter()).take(self.conditions.len()) {
                step.add(*s, direction);
            }
            report.correction = step.norm(y);
            if report.iterations == 1 {
                report.first_correction = report.correction;
            }
            if !report.correction.is_finite() {
                return Err(SingularError::Singular { iterations: report.iterations });
            }
            // Far out, only a part of the step can be trusted.
            step.apply((0.5 / report.correction).min(1.0), y);
            let size = report.correction;
            // Below 1e-8 rounding spoils the ratio, above 1e-3 the next order does.
            if (1e-8..1e-3).contains(&before) {
                self.contraction = self.contraction.max(size / (before * before));
            }
            before = size;
            // Quadratic convergence: what is left after a step of size δ is of order δ².
            let expected = if self.trusting && self.contraction > 0.0 {
                4.0 * self.contraction * size * size
            } else {
                f64::INFINITY
            };
            if size <= self.tolerance.max(1e-3 * self.tolerance.sqrt()) || size < SMALL && expected <= self.tolerance {
                self.problem.prepare(&y.scalars);
                return Ok(report);
            }
        }
        Err(SingularError::Stalled { iterations: report.iterations, correction: report.correction })
    }

    /// Recomputes factors, null directions and g′ along the branch at a point that a trusting iteration converged to.
    ///
    /// # Errors
    /// [`SingularError`] if a pivot vanishes.
    pub fn refresh(&mut self, y: &Solution) -> Result<(), SingularError> {
        self.linearise(y)?;
        self.slopes[0] = self.slope(y, Along::Basis(0));
        Ok(())
    }

    /// Direction of the curve of singular points in the two free parameters, of unit length.
    pub fn curve_direction(&self, y: &Solution) -> Update {
        let mut direction = self.basis[0].clone();
        direction.scale(-self.slopes[1]);
        direction.add(self.slopes[0], &self.basis[1]);
        self.metric.normalise(&y.mesh, &mut direction);
        direction
    }
}

#[derive(Clone, Copy)]
enum Along {
    Step,
    Basis(usize),
}
