//! Further solutions of a problem with several: Newton's method on equations from which the known solutions are taken out.
//!
//! With the distances d_k of y from the known solutions, η(y) F(y) = 0 with η = Π (1/d_k² + 1) has the solutions of F(y) = 0 but for the
//! known ones (N.21). Its Newton correction is τδ, where δ is the correction for F, Jδ = −F:
//!
//! * τ = 1/(1 − η′\[δ\]/η), η′\[δ\]/η = −2 Σ_k ⟨y − y_k, δ⟩/(d_k² (1 + d_k²))
//!
//! so every iteration costs one of Newton's method.
//!
//! # References
//! Farrell, Birkisson & Funke, SIAM J. Sci. Comput. 37, A2026 (2015).

use crate::direction::Direction;
use crate::invalid::{self, InvalidInput};
use crate::linear::{FactorisationError, System};
use crate::metric::Metric;
use crate::newton::{Settings, SolveError, Solved, solve};
use crate::problem::BoundaryValueProblem;
use crate::solution::Solution;

/// Settings of the search for further solutions.
#[derive(Clone, Debug, PartialEq)]
pub struct Deflation {
    /// How each solution is solved to an accuracy once it is nearly found.
    pub settings: Settings,
    /// The norm of distances. Without a metric all weights are 1.
    pub metric: Option<Metric>,
    /// Most iterations of one search; there are up to three, with shorter and longer steps.
    pub max_iterations: usize,
    /// Solutions nearer to each other than this are the same.
    pub separation: f64,
}

impl Default for Deflation {
    fn default() -> Self {
        Deflation { settings: Settings::default(), metric: None, max_iterations: 200, separation: 1e-4 }
    }
}

/// Why no further solution was found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DeflationError {
    /// The problem, a guess, a known solution or the settings are refused.
    #[error(transparent)]
    Invalid(#[from] InvalidInput),
    /// The iteration does not converge. This guess leads to no further solution; there may be no other solution.
    #[error(
        "no further solution in {iterations} iterations besides the {known} known ones (last correction {correction:.1e})"
    )]
    NotFound {
        /// Iterations done.
        iterations: usize,
        /// Solutions taken out.
        known: usize,
        /// Norm of the last correction.
        correction: f64,
    },
    /// A further solution was nearly found, and then not solved to the accuracy asked for.
    #[error(transparent)]
    Unsolved(#[from] SolveError),
}

/// Largest corrections applied in full, relative to 1 + ‖y‖: a search is repeated with the next where it fails.
const FARTHEST: [f64; 3] = [2.0, f64::INFINITY, 0.3];

/// After a correction below this the solution is left to [`solve`].
const NEAR: f64 = 1e-6;

impl Deflation {
    /// A solution other than the known ones, from a guess on any mesh; the search is on this mesh, and the solution found on one of
    /// its own.
    ///
    /// # Errors
    /// [`DeflationError`].
    ///
    /// # Examples
    /// Bratu's problem u″ + eᵘ = 0, u(0) = u(1) = 0 has two solutions:
    ///
    /// ```
    /// use furrow_bvp::{Deflation, DualNum, Settings, SimpleProblem, Solution, mesh, solve};
    ///
    /// let mut problem = SimpleProblem::new(2, |_x, y, _p, f| {
    ///     f[0] = y[1];
    ///     f[1] = -y[0].exp();
    /// })
    /// .left_conditions(1, |y, _p, r| r[0] = y[0])
    /// .right_conditions(1, |y, _p, r| r[0] = y[0]);
    /// let guess = Solution::constant(4, &mesh::uniform(0.0, 1.0, 10), &[0.0, 0.0], &[]);
    /// let first = solve(&mut problem, &guess, &Settings::default())?.solution;
    /// let second = Deflation::default().solve(&mut problem, &guess, &[first.clone()])?.solution;
    /// assert!((first.node(0)[1] - 0.549353).abs() < 1e-5 && (second.node(0)[1] - 10.846900).abs() < 1e-5);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn solve(
        &self,
        problem: &mut dyn BoundaryValueProblem,
        guess: &Solution,
        known: &[Solution],
    ) -> Result<Solved, DeflationError> {
        let dims = problem.dimensions();
        self.settings.check()?;
        invalid::positive("the separation", self.separation)?;
        guess.fits(dims)?;
        if dims.missing_conditions() != 0 {
            return Err(InvalidInput::NotSquare { missing: dims.missing_conditions(), allowed: "0" }.into());
        }
        known.iter().try_for_each(|y| y.fits(dims).and_then(|()| invalid::interval(&y.mesh, &guess.mesh)))?;
        let metric = self.norm(guess);
        metric.check(guess)?;
        let mut last = DeflationError::NotFound { iterations: 0, known: known.len(), correction: f64::INFINITY };
        for farthest in FARTHEST {
            match self.attempt(problem, guess, known, (&metric, farthest)) {
                Ok(solved) => return Ok(solved),
                Err(DeflationError::Invalid(input)) => return Err(input.into()),
                Err(error) => last = error,
            }
        }
        Err(last)
    }

    fn attempt(
        &self,
        problem: &mut dyn BoundaryValueProblem,
        guess: &Solution,
        known: &[Solution],
        limit: (&Metric, f64),
    ) -> Result<Solved, DeflationError> {
        let (near, iterations, correction) = self.search(problem, guess, known, limit)?;
        let solved = solve(problem, &near, &self.settings)?;
        if self.is_known(&solved.solution, known) {
            return Err(DeflationError::NotFound { iterations, known: known.len(), correction });
        }
        Ok(solved)
    }

    /// All solutions that are reached from guesses, up to a number: first by Newton's method alone, then with the known ones taken out until
    /// a guess leads to no further one.
    ///
    /// # Errors
    /// [`DeflationError::Invalid`] for input that is refused.
    pub fn solve_all(
        &self,
        problem: &mut dyn BoundaryValueProblem,
        guesses: &[Solution],
        most: usize,
    ) -> Result<Vec<Solved>, DeflationError> {
        let (mut all, mut known): (Vec<Solved>, Vec<Solution>) = (Vec::new(), Vec::new());
        for guess in guesses {
            let mut plain = true;
            while all.len() < most {
                let taken_out = if plain { &[][..] } else { &known };
                match self.solve(problem, guess, taken_out) {
                    Ok(solved) if plain && self.is_known(&solved.solution, &known) => {}
                    Ok(solved) => {
                        known.push(solved.solution.clone());
                        all.push(solved);
                    }
                    Err(DeflationError::Invalid(input)) => return Err(input.into()),
                    Err(_) if plain => {}
                    Err(_) => break,
                }
                plain = false;
            }
        }
        Ok(all)
    }

    fn norm(&self, y: &Solution) -> Metric {
        self.metric.clone().unwrap_or_else(|| Metric::unit(y.components, y.scalars.len()))
    }

    /// Whether a solution is one of the known ones.
    fn is_known(&self, y: &Solution, known: &[Solution]) -> bool {
        let metric = self.norm(y);
        known.iter().any(|k| distance(&metric, y, k) < self.separation)
    }

    /// A point next to a further solution, on the mesh of the guess, with the iterations done and the last correction.
    fn search(
        &self,
        problem: &mut dyn BoundaryValueProblem,
        guess: &Solution,
        known: &[Solution],
        (metric, farthest): (&Metric, f64),
    ) -> Result<(Solution, usize, f64), DeflationError> {
        let mut y = guess.clone();
        let known: Vec<Solution> = known.iter().map(|k| at_places_of(guess, k)).collect();
        let (mut system, mut step) = (System::new(problem.dimensions(), guess.m), Direction::default());
        let mut correction = f64::INFINITY;
        for iterations in 1..=self.max_iterations {
            let failed = DeflationError::NotFound { iterations, known: known.len(), correction };
            match system.factorise(problem, &y, &[]) {
                Ok(()) => {}
                Err(FactorisationError::Invalid(input)) => return Err(input.into()),
                Err(FactorisationError::Pivot(_)) => return Err(failed),
            }
            system.solve_own(&mut step)?;
            let share: f64 = known.iter().map(|k| slope_share(metric, &y, k, &step)).sum();
            step.scale(1.0 / (1.0 - share));
            correction = step.norm(&y);
            if !correction.is_finite() {
                return Err(failed);
            }
            let size = |d: &Direction| metric.dot(&y.mesh, d, d).sqrt();
            let damping = (farthest * (1.0 + size(&values_of(&y))) / size(&step)).min(1.0);
            step.apply(damping, &mut y);
            if correction < NEAR {
                return Ok((y, iterations, correction));
            }
        }
        Err(DeflationError::NotFound { iterations: self.max_iterations, known: known.len(), correction })
    }
}

/// The values of a function as a direction, without its stages.
fn values_of(y: &Solution) -> Direction {
    Direction { nodes: y.nodes.clone(), stages: Vec::new(), scalars: y.scalars.clone() }
}

/// y − k on the mesh of y.
fn difference(y: &Solution, k: &Solution) -> Direction {
    let minus = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a - b).collect();
    Direction { nodes: minus(&y.nodes, &k.nodes), stages: Vec::new(), scalars: minus(&y.scalars, &k.scalars) }
}

/// A solution on the mesh, and with the stages, of another.
fn at_places_of(y: &Solution, k: &Solution) -> Solution {
    let gauss = k.gauss();
    y.resampled(k.components, &k.scalars, |x, out| k.eval(&gauss, x, out))
}

/// The distance of two solutions, by the nodes of the first.
fn distance(metric: &Metric, y: &Solution, k: &Solution) -> f64 {
    let way = difference(y, &at_places_of(y, k));
    metric.dot(&y.mesh, &way, &way).sqrt()
}

/// The part of η′\[δ\]/η that belongs to one known solution.
fn slope_share(metric: &Metric, y: &Solution, k: &Solution, step: &Direction) -> f64 {
    let way = difference(y, k);
    let square = metric.dot(&y.mesh, &way, &way);
    -2.0 * metric.dot(&y.mesh, &way, step) / (square * (1.0 + square))
}
