//! Simple branch points as regular roots: Newton on a minimally augmented system.
//!
//! F has one unknown more than equations. Where two branches cross, its Jacobian J has two null directions instead of one. With a
//! column w and two rows c₁, c₂ that border J to a regular matrix M, the solutions b_k of M (b_k, g_k) = e_k tell: g₁ = g₂ = 0
//! there and nowhere near. As those are two conditions, an unfolding parameter β joins x:
//!
//! * \[N.19 branch point\] F(x) + βw = 0, g₁(x) = 0, g₂(x) = 0
//!
//! is regular at a simple branch point of F + βw. β = 0 says that it is one of F; where an imperfection keeps the branches
//! apart, β measures it. The β of a solution for any right-hand side is its product with the left null vector, so that no system
//! is transposed, and g_k′\[b_j\] are the coefficients of the algebraic bifurcation equation.
//!
//! # References
//! Govaerts, *Numerical Methods for Bifurcations of Dynamical Equilibria*, SIAM 2000, ch. 3–4, 8 (bordered test scalars,
//! unfolded branch points). Keller, in *Applications of Bifurcation Theory*, Academic Press 1977, p. 359 (algebraic bifurcation
//! equation).

use crate::dimensions::Dimensions;
use crate::direction::{Direction, LinearCondition, Residual};
use crate::gauss::Gauss;
use crate::invalid::InvalidInput;
use crate::linear::{FactorisationError, System};
use crate::mesh;
use crate::metric::{self, Metric};
use crate::newton::Work;
use crate::problem::derivatives::{second_differences, second_residual};
use crate::problem::{BoundaryValueProblem, Directional};
use crate::solution::Solution;

use super::unfolded::{Unfolded, unfolded};

/// A problem with its own second derivatives, or with differences in their place.
pub(crate) enum Differentiated<'a> {
    Exactly(&'a mut dyn Directional),
    ByDifferences(&'a mut dyn BoundaryValueProblem),
}

impl Differentiated<'_> {
    pub fn problem(&mut self) -> &mut dyn BoundaryValueProblem {
        match self {
            Differentiated::Exactly(problem) => *problem,
            Differentiated::ByDifferences(problem) => *problem,
        }
    }

    /// D²F\[a, b\] at a solution, with zeros in the given number of linear conditions.
    fn second(&mut self, gauss: &Gauss, y: &Solution, along: [&Direction; 2], conditions: usize, out: &mut Residual) {
        match self {
            Differentiated::Exactly(problem) => second_residual(gauss, *problem, y, along, conditions, out),
            Differentiated::ByDifferences(problem) => second_differences(gauss, *problem, y, along, conditions, out),
        }
    }
}

/// Newton on the extended system.
pub(crate) struct Unfolding {
    /// The unfolded system at the last iterate, bordered by planes across `basis`.
    pub system: System,
    /// Norm of the branch.
    pub metric: Metric,
    /// Both null directions at the last iterate, orthonormal.
    pub basis: [Direction; 2],
    /// g_k′\[b_j\] as (1, 1), (1, 2), (2, 2).
    pub form: [f64; 3],
    /// The unfolding parameter.
    pub beta: f64,
    /// Factorisations and solves.
    pub work: Work,
    weights: Vec<f64>,
    conditions: [LinearCondition; 2],
    residual: Residual,
    step: Direction,
    change: Direction,
}

/// Most iterations.
const MOST_ITERATIONS: usize = 10;

/// Largest correction applied in full.
const FARTHEST: f64 = 0.5;

/// Branches that cross at an angle with a smaller sine touch, as far as rounding can tell.
const SEPARATE: f64 = 1e-6;

/// Iterations end with a correction below this: the remaining error is of the order of its square.
pub(super) const CONVERGED: f64 = 3e-9;

/// Weights w of β in the conditions, and of the row that the second null direction is first found with: no two alike, so that
/// the symmetries of a problem do not make them useless.
pub(super) fn unfolding_weights() -> impl Iterator<Item = f64> {
    let mut state: u64 = 0x9e37_79b9_7f4a_7c15;
    std::iter::repeat_with(move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        0.25 + (state >> 11) as f64 / (1u64 << 53) as f64
    })
}

/// Smaller corrections reuse the form of the previous iterate.
const REUSE_FORM: f64 = 1e-6;

/// How g changes along a correction smaller than this is neglected.
const NEGLIGIBLE: f64 = 1e-2 * CONVERGED;

/// How far along both null directions g vanishes, which has these values and changes by the form.
fn shares([h11, h12, h22]: [f64; 3], [a, b]: [f64; 2]) -> [f64; 2] {
    let determinant = h11 * h22 - h12 * h12;
    [(h12 * b - h22 * a) / determinant, (h12 * a - h11 * b) / determinant]
}

/// Takes β out of a direction of the unfolded problem.
fn split(direction: &mut Direction) -> f64 {
    direction.scalars.pop().unwrap_or(f64::NAN)
}

impl Unfolding {
    /// Returns the workspace in `kept`, or a new one if it has other sizes than the problem; `None` if the kernels cannot take another
    /// scalar unknown, or if the problem is not one condition short of square.
    pub fn reuse_or_new<'a>(
        kept: &'a mut Option<Self>,
        dims: Dimensions,
        stages: usize,
        metric: &Metric,
    ) -> Option<&'a mut Self> {
        let larger = unfolded(dims);
        if larger.check(stages).is_err() || dims.missing_conditions() != 1 {
            return None;
        }
        let fits = |unfolding: &Self| unfolding.system.dimensions() == larger && unfolding.system.gauss.m == stages;
        let unfolding = kept.take().filter(fits).map(|kept| Unfolding { metric: metric.clone(), ..kept });
        Some(kept.insert(unfolding.unwrap_or_else(|| Unfolding {
            system: System::new(larger, stages),
            metric: metric.clone(),
            basis: Default::default(),
            form: [f64::NAN; 3],
            beta: 0.0,
            work: Work::default(),
            weights: unfolding_weights().take(dims.right + dims.integrals + dims.left).collect(),
            conditions: Default::default(),
            residual: Residual::default(),
            step: Direction::default(),
            change: Direction::default(),
        })))
    }

    /// Moves `y` onto the branch point near it, on a branch with the given tangent; `None` if Newton does not converge. System, basis
    /// and form belong to the iterate before the last correction, which is negligible.
    pub fn solve(&mut self, problem: &mut Differentiated<'_>, y: &mut Solution, tangent: &Direction) -> Option<()> {
        let [first, second] = &mut self.conditions;
        self.metric.plane_through(y, tangent, first);
        // Any row does that the second null direction is not orthogonal to.
        second.nodes = unfolding_weights().take(y.nodes.len()).collect();
        second.scalars = unfolding_weights().take(y.scalars.len()).collect();
        self.beta = 0.0;
        self.linearise(problem, y).ok()?;
        self.basis[0].clone_from(tangent);
        self.iterate(problem, y, CONVERGED)
    }

    /// [`solve`](Self::solve) where the null directions are known nearly.
    pub fn solve_from(
        &mut self,
        problem: &mut Differentiated<'_>,
        y: &mut Solution,
        basis: [Direction; 2],
    ) -> Option<()> {
        self.basis = basis;
        self.iterate(problem, y, CONVERGED)
    }

    /// Solves for the branch point `y` on the mesh of halved intervals, until a correction is below `enough`. System, basis and form
    /// then belong to this mesh.
    pub fn on_halved(&mut self, problem: &mut Differentiated<'_>, y: &Solution, enough: f64) -> Option<Solution> {
        let finer = mesh::halved(&y.mesh);
        let mut refined = y.on_mesh(&self.system.gauss, &finer);
        for direction in &mut self.basis {
            metric::transfer_direction(&self.system.gauss, &y.mesh, &finer, direction);
        }
        self.iterate(problem, &mut refined, enough).map(|()| refined)
    }

    /// Newton until a correction is below `enough`.
    fn iterate(&mut self, problem: &mut Differentiated<'_>, y: &mut Solution, enough: f64) -> Option<()> {
        (self.beta, self.form) = (0.0, [f64::NAN; 3]);
        for _ in 0..MOST_ITERATIONS {
            self.border(y);
            let change = self.correction(problem, y).ok()?;
            let size = self.step.norm(y).max(change.abs());
            if !size.is_finite() {
                return None;
            }
            let damping = (FARTHEST / size).min(1.0);
            self.step.apply(damping, y);
            self.beta += damping * change;
            if size < enough {
                return Some(());
            }
        }
        None
    }

    /// The solution x and the β of M (x, β) = −(`residual`, 0, 0).
    pub fn respond(&mut self, residual: &Residual, out: &mut Direction) -> Result<f64, InvalidInput> {
        self.system.solve(residual, out)?;
        Ok(split(out))
    }

    /// That β alone: the product of the residual with −ψ, ψ the left null vector.
    pub fn project(&mut self, residual: &Residual) -> Result<f64, InvalidInput> {
        self.system.solve_last_node(residual, &mut self.change)?;
        Ok(split(&mut self.change))
    }

    /// −ψ D²F\[a, b\].
    fn product(
        &mut self,
        problem: &mut Differentiated<'_>,
        y: &Solution,
        along: [&Direction; 2],
    ) -> Result<f64, InvalidInput> {
        let mut residual = std::mem::take(&mut self.residual);
        problem.second(&self.system.gauss, y, along, self.conditions.len(), &mut residual);
        let product = self.project(&residual);
        self.residual = residual;
        product
    }

    /// Factors at `y` with the conditions as they are.
    fn factorise(&mut self, problem: &mut Differentiated<'_>, y: &Solution) -> Result<(), FactorisationError> {
        let Unfolding { system, weights, beta, conditions, work, .. } = self;
        for condition in conditions.iter_mut() {
            condition.scalars.push(0.0);
        }
        work.factorisations += 1;
        work.iterations += 1;
        // The problem keeps β to itself.
        system.evaluate_checked(&mut Unfolded { inner: problem.problem(), beta: *beta, weights }, y, conditions, true);
        system.condense()?;
        system.factor_blocks(conditions)
    }

    /// Makes the basis orthonormal, and borders with planes across it.
    fn border(&mut self, y: &Solution) {
        let [first, second] = &mut self.basis;
        self.metric.normalise(&y.mesh, first);
        let along = self.metric.dot(&y.mesh, first, second);
        second.add(-along, first);
        self.metric.normalise(&y.mesh, second);
        for (direction, condition) in self.basis.iter().zip(&mut self.conditions) {
            self.metric.plane_through(y, direction, condition);
        }
    }

    /// Factorises and puts the null directions into the basis. Returns their g.
    fn linearise(&mut self, problem: &mut Differentiated<'_>, y: &Solution) -> Result<[f64; 2], FactorisationError> {
        self.factorise(problem, y)?;
        for (k, direction) in self.basis.iter_mut().enumerate() {
            self.system.null_direction(k, direction)?;
        }
        Ok(self.basis.each_mut().map(split))
    }

    /// Computes the form at `y`, the coefficients g_k′\[b_j\].
    pub fn derive(&mut self, problem: &mut Differentiated<'_>, y: &Solution) -> Result<(), InvalidInput> {
        let [a, b] = self.basis.clone();
        self.form = [
            self.product(problem, y, [&a, &a])?,
            self.product(problem, y, [&a, &b])?,
            self.product(problem, y, [&b, &b])?,
        ];
        Ok(())
    }

    /// The correction of one Newton iteration in `step`; returns the correction of β.
    fn correction(&mut self, problem: &mut Differentiated<'_>, y: &Solution) -> Result<f64, FactorisationError> {
        let g = self.linearise(problem, y)?;
        let mut step = std::mem::take(&mut self.step);
        self.system.solve_own(&mut step)?;
        let (change, left) = (split(&mut step), step.norm(y));
        let mut shares = shares(self.form, g);
        // Not a number in the first iteration.
        let reuse = left + shares[0].abs() + shares[1].abs() < REUSE_FORM;
        if !reuse {
            self.derive(problem, y)?;
            let mut there = g;
            if left >= NEGLIGIBLE {
                for (k, direction) in self.basis.clone().iter().enumerate() {
                    there[k] += self.product(problem, y, [direction, &step])?;
                }
            }
            shares = self::shares(self.form, there);
        }
        for (share, direction) in shares.into_iter().zip(&self.basis) {
            step.add(share, direction);
        }
        self.step = step;
        Ok(change + shares[0] * g[0] + shares[1] * g[1])
    }

    /// The roots of the algebraic bifurcation equation h₁₁α₁² + 2h₁₂α₁α₂ + h₂₂α₂² = 0. None if it has no two real ones.
    pub fn roots(&self) -> Option<[[f64; 2]; 2]> {
        let [h11, h12, h22] = self.form;
        let root = (h12 * h12 - h11 * h22).sqrt();
        let size = h11.abs().max(h12.abs()).max(h22.abs());
        if root.is_nan() || root <= SEPARATE * size {
            return None;
        }
        // α₁ : α₂ = q : h₁₁ = h₂₂ : q without cancellation.
        let q = -h12 - root.copysign(h12);
        Some([[q, h11], [h22, q]])
    }

    /// Directions of both branches through the point, of unit length, that nearest to `tangent` first; and the product of both.
    pub fn crossing(&self, mesh: &[f64], tangent: &Direction) -> Option<([Direction; 2], f64)> {
        let roots = self.roots()?;
        let [h11, h12, h22] = self.form;
        let [a, b] = roots;
        let mut product = h11 * a[0] * b[0] + h12 * (a[0] * b[1] + a[1] * b[0]) + h22 * a[1] * b[1];
        let mut directions = roots.map(|shares| {
            let mut direction = self.basis[0].clone();
            direction.scale(shares[0]);
            direction.add(shares[1], &self.basis[1]);
            let size = self.metric.dot(mesh, &direction, &direction).sqrt();
            let size = size.copysign(self.metric.dot(mesh, &direction, tangent));
            direction.scale(1.0 / size);
            product /= size;
            direction
        });
        let [first, second] = [0, 1].map(|k| self.metric.dot(mesh, &directions[k], tangent));
        if second > first {
            directions.swap(0, 1);
        }
        Some((directions, product))
    }

    /// Distance that an imperfection keeps the two branches apart: next to the point they are hyperbolas ½h(α, α) = −β.
    pub fn gap(&self) -> f64 {
        let [h11, h12, h22] = self.form;
        let (mean, half) = (0.5 * (h11 + h22), (0.5 * (h11 - h22)).hypot(h12));
        // The curvature of the form on the side that the hyperbolas lie on.
        let curvature = if self.beta < 0.0 { mean + half } else { half - mean };
        2.0 * (2.0 * self.beta.abs() / curvature.abs()).sqrt()
    }
}
