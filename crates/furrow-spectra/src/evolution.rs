//! Eigenvalues and Hopf points of steady states of evolution equations in one dimension.
//!
//! A steady state is a solution of y′ = f(x, y, p). In time the equations are y′ = f + B ∂y/∂t with constant B: for u_t = Du″ + g(u) as
//! y = (u, Du′) B₂₁ = 1 is the only entry. A disturbance η e^{λt} satisfies η′ = f_y η + λBη and the linearised
//! conditions, so the λ are the reciprocals of the eigenvalues of the map η ↦ ζ, ζ′ = f_y ζ + Bη, and those nearest to 0 come first.
//! Scalar unknowns other than the parameter follow the disturbance at once.

use furrow_bvp::{
    BoundaryValueProblem, Continuation, Direction, FactorisationError, InvalidInput, LinearCondition, Solution, System,
    metric,
};

use crate::arnoldi::{Arnoldi, EigenError, Krylov, NoEigenvalues};
use crate::floquet::Complex;
use crate::root::{self, Root};

/// B_rc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassTerm {
    /// The component r. Its equation contains the time derivative.
    pub row: usize,
    /// The component c that is differentiated.
    pub column: usize,
    /// The coefficient.
    pub coefficient: f64,
}

/// Which equations have time derivatives, and how many eigenvalues are computed.
#[derive(Clone, Debug, PartialEq)]
pub struct Evolution {
    /// The entries of B that are not 0.
    pub mass: Vec<MassTerm>,
    /// The iteration for the eigenvalues nearest to 0; a Hopf point is found if its pair is among them. The tolerance bounds the error of 1/λ.
    pub arnoldi: Arnoldi,
}

/// Why eigenvalues or Hopf points were not found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EvolutionError {
    /// The problem has no such components, or lacks another number of conditions than one.
    #[error(transparent)]
    Invalid(#[from] InvalidInput),
    /// The steady state is singular.
    #[error(transparent)]
    Singular(#[from] FactorisationError),
    /// The iteration fails.
    #[error(transparent)]
    Eigenvalues(#[from] EigenError),
    /// There is a Hopf point between two steady states, but no steady state between them could be computed.
    #[error("the branch is lost between parameters {} and {}", .parameters[0], .parameters[1])]
    Lost {
        /// Parameters of the two.
        parameters: [f64; 2],
    },
}

impl From<NoEigenvalues> for EvolutionError {
    fn from(error: NoEigenvalues) -> Self {
        EvolutionError::Eigenvalues(error.into())
    }
}

impl Evolution {
    /// The eigenvalues nearest to 0 of a steady state with the parameter, its last scalar unknown, held fixed; by falling real part,
    /// complex pairs with both signs.
    ///
    /// # Errors
    /// [`EvolutionError`].
    pub fn eigenvalues<P: BoundaryValueProblem>(
        &self,
        problem: &mut P,
        y: &Solution,
    ) -> Result<Vec<Complex<f64>>, EvolutionError> {
        let dims = problem.dimensions();
        y.check()?;
        for index in self.mass.iter().flat_map(|term| [term.row, term.column]) {
            if index >= dims.components {
                return Err(InvalidInput::Index { name: "component", index, count: dims.components }.into());
            }
        }
        if dims.missing_conditions() != 1 {
            return Err(InvalidInput::NotSquare { missing: dims.missing_conditions(), allowed: "1" }.into());
        }
        let mut fixed = LinearCondition::default();
        let last = y.scalars.len().saturating_sub(1);
        metric::scalar_condition(y, last, y.scalars.get(last).copied().unwrap_or(f64::NAN), &mut fixed);
        let mut system = System::new(dims, y.m);
        system.factorise(problem, y, &[fixed])?;
        let mut columns: Vec<usize> = self.mass.iter().map(|term| term.column).collect();
        columns.sort_unstable();
        columns.dedup();
        let (n, points, held) = (y.components, y.intervals() * y.m, columns.len());
        let width = |k: usize| y.mesh[k / y.m + 1] - y.mesh[k / y.m];
        let weight = |k: usize| width(k) * system.gauss.b[k % y.m];
        let weights: Vec<f64> = (0..points * held).map(|k| weight(k / held)).collect();
        let (mut forces, mut response) = (system.zero_residual(), Direction::default());
        let apply = |from: &[f64], to: &mut [f64]| {
            forces.stages.fill(0.0);
            for (k, from) in from.chunks_exact(held).enumerate() {
                for MassTerm { row, column, coefficient } in &self.mass {
                    let place = columns.partition_point(|c| c < column);
                    forces.stages[k * n + row] -= width(k) * coefficient * from[place];
                }
            }
            system.solve(&forces, &mut response)?;
            for (to, at) in to.chunks_exact_mut(held).zip(response.stages.chunks_exact(n)) {
                to.iter_mut().zip(&columns).for_each(|(to, column)| *to = at[*column]);
            }
            Ok::<(), EvolutionError>(())
        };
        if held == 0 {
            return Ok(Vec::new());
        }
        let found = self.arnoldi.largest(&mut Krylov::default(), &weights, apply)?;
        let mut all: Vec<Complex<f64>> = found.iter().map(|v| Complex::new(v.re, v.im).inv()).collect();
        all.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
        Ok(all)
    }
}

/// A Hopf point of steady states: oscillations begin here, with the period 2π/ω.
#[derive(Clone, Debug, PartialEq)]
pub struct SteadyHopfPoint {
    /// The steady state.
    pub solution: Solution,
    /// Its arclength along the branch.
    pub arclength: f64,
    /// ω.
    pub frequency: f64,
    /// Estimated error of the parameter, by its change where the intervals are halved; infinite if it is not found there.
    pub error: f64,
}

impl SteadyHopfPoint {
    /// The parameter there.
    pub fn parameter(&self) -> f64 {
        self.solution.scalars.last().copied().unwrap_or(f64::NAN)
    }
}

/// Watches a branch of steady states: gives the eigenvalues of every one, and the Hopf points in the step to it.
///
/// # Examples
/// The Brusselator with diffusion on \[0, ℓ\], with fixed values at both ends. The state without patterns oscillates from
/// ℓ = π √(0.012/0.45) on.
///
/// ```
/// use furrow_bvp::{Continuation, ContinuationSettings, DualNum, Metric, SimpleProblem, Solution, mesh};
/// use furrow_spectra::evolution::{Evolution, EvolutionWatch, MassTerm};
/// use furrow_spectra::Arnoldi;
/// use std::f64::consts::PI;
///
/// // y = (u, v, D₁u′/ℓ², D₂v′/ℓ²) and p = ℓ.
/// let (a, b, [first, second]) = (2.0, 5.45, [0.008, 0.004]);
/// let problem = SimpleProblem::new(4, move |_, y, p, f| {
///     let (square, reaction) = (p[0].powi(2), y[0].powi(2) * y[1]);
///     f[0] = y[2] * square / first;
///     f[1] = y[3] * square / second;
///     f[2] = y[0] * (b + 1.0) - reaction - a;
///     f[3] = reaction - y[0] * b;
/// })
/// .scalars(1)
/// .left_conditions(2, move |y, _, r| (r[0], r[1]) = (y[0] - a, y[1] - b / a))
/// .right_conditions(2, move |y, _, r| (r[0], r[1]) = (y[0] - a, y[1] - b / a));
/// let guess = Solution::constant(4, &mesh::uniform(0.0, 1.0, 16), &[a, b / a, 0.0, 0.0], &[0.4]);
/// let settings = ContinuationSettings { max_step: 0.05, ..Default::default() };
/// let mut branch = Continuation::start(problem, guess, Metric::unit(4, 1), settings, true)?;
///
/// // u_t and v_t are in the third and the fourth equation.
/// let mass = [0, 1].map(|k| MassTerm { row: k + 2, column: k, coefficient: 1.0 }).to_vec();
/// let evolution = Evolution { mass, arnoldi: Arnoldi { wanted: 4, ..Default::default() } };
/// let (mut watch, mut found) = (EvolutionWatch::start(evolution, &mut branch)?, Vec::new());
/// branch.follow([0.0, 0.6], 100, |branch, _| {
///     found.push(watch.look(branch));
///     true
/// })?;
/// let points = found.into_iter().collect::<Result<Vec<_>, _>>()?.concat();
/// assert!(points.len() == 1 && (points[0].parameter() - PI * (0.012f64 / 0.45).sqrt()).abs() < 1e-8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct EvolutionWatch {
    /// How the equations evolve.
    pub evolution: Evolution,
    /// The eigenvalues nearest to 0 of the newest steady state, by falling real part; complex pairs with both signs.
    pub eigenvalues: Vec<Complex<f64>>,
}

fn growing(eigenvalues: &[Complex<f64>]) -> usize {
    eigenvalues.iter().filter(|value| value.re > 0.0).count()
}

impl EvolutionWatch {
    /// At the newest point of a branch.
    ///
    /// # Errors
    /// As [`Evolution::eigenvalues`].
    pub fn start<P: BoundaryValueProblem>(
        evolution: Evolution,
        branch: &mut Continuation<P>,
    ) -> Result<EvolutionWatch, EvolutionError> {
        let eigenvalues = evolution.eigenvalues(&mut branch.problem, &branch.state.solution)?;
        Ok(EvolutionWatch { evolution, eigenvalues })
    }

    /// The Hopf point between the last two steady states, after every step: there the number of growing disturbances changes by two.
    ///
    /// # Errors
    /// [`EvolutionError`].
    pub fn look<P: BoundaryValueProblem>(
        &mut self,
        branch: &mut Continuation<P>,
    ) -> Result<Vec<SteadyHopfPoint>, EvolutionError> {
        let now = self.evolution.eigenvalues(&mut branch.problem, &branch.state.solution)?;
        let before = std::mem::replace(&mut self.eigenvalues, now);
        let counts = [&before, &self.eigenvalues].map(|all| growing(all));
        if counts[0].abs_diff(counts[1]) != 2 {
            return Ok(Vec::new());
        }
        // The real part of the pair that crosses, which comes behind those that grow at both ends.
        let which = counts[0].min(counts[1]);
        let values = [&before, &self.eigenvalues].map(|all| all.get(which).map_or(f64::NAN, |value| value.re));
        Ok(self.located(branch, which, values)?.into_iter().collect())
    }

    fn located<P: BoundaryValueProblem>(
        &self,
        branch: &mut Continuation<P>,
        which: usize,
        values: [f64; 2],
    ) -> Result<Option<SteadyHopfPoint>, EvolutionError> {
        let test = |problem: &mut P, y: &Solution| {
            let all = self.evolution.eigenvalues(problem, y)?;
            let pair = all.get(which).copied().unwrap_or(Complex::new(f64::NAN, f64::NAN));
            Ok::<_, EvolutionError>((pair.re, pair.im.abs()))
        };
        let lost = |parameters| EvolutionError::Lost { parameters };
        let Some(root) = root::between(branch, values, lost, test)? else { return Ok(None) };
        let error = root.error(branch, test);
        let Root { solution, arclength, found: frequency, .. } = root;
        // Two real eigenvalues that pass 0 together make no Hopf point.
        Ok((frequency > 0.0).then_some(SteadyHopfPoint { solution, arclength, frequency, error }))
    }
}
