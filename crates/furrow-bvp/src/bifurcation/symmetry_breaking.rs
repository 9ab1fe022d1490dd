//! Pitchforks of mirror-symmetric branches: an antisymmetric null vector appears.

use crate::dense::{Determinant, PivotFailure};
use crate::dimensions::{Dimensions, MAX_UNKNOWNS};
use crate::direction::{Direction, Residual};
use crate::invalid::{self, InvalidInput};
use crate::kernels::AntisymmetricEnd;
use crate::linear::{FactorisationError, System};
use crate::problem::derivatives::second_residual;
use crate::problem::{Directional, MirrorSymmetric};
use crate::solution::Solution;

use super::singularity::Singularity;

/// A pitchfork: the antisymmetric problem J_a φ = 0 on the half domain has a solution.
///
/// With the last of the conditions at the mirror replaced by (component `normaliser` of φ) = 1, g is what φ leaves of the
/// condition replaced. Then det J_a = g · det of the replaced problem (N.9), and the same factors project any right-hand side
/// on the left null vector.
///
/// # Examples
/// A rod u″ + λ sin u = 0, u(0) = u(1) = 0 buckles to an antisymmetric shape at λ = (2π)². `Oscillator` is in
/// `examples/problems/oscillator.rs`; here it is on the half [0, ½], with a mirror at ½.
///
/// ```
/// # mod oscillator { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/problems/oscillator.rs")); }
/// # use oscillator::Oscillator;
/// use furrow_bvp::{Continuation, ContinuationSettings, Metric, MinimallyAugmented, SymmetryBreaking};
/// let problem = Oscillator::elastica(1);
/// let (mut y, metric) = (problem.zero(0.5, 10, 4, 38.0), Metric::unit(2, 1));
/// let settings = ContinuationSettings::default();
/// let branch = Continuation::start(problem.clone(), y.clone(), metric.clone(), settings, true)?;
/// let tangent = &branch.state.tangent;
/// let mut point = MinimallyAugmented::new(problem, SymmetryBreaking::default(), y.m, metric, tangent)?;
/// point.solve(&mut y, None)?;
/// assert!((y.scalars[0] - (2.0 * std::f64::consts::PI).powi(2)).abs() < 1e-8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct SymmetryBreaking {
    /// The antisymmetric solution φ of the replaced problem; at g = 0 the null vector.
    pub null: Direction,
    /// The replaced problem is regular for this component at the mirror set to 1.
    pub normaliser: usize,
    /// Sign of det J_a (up to a sign fixed per problem), and ln |det J_a|.
    pub determinant: (f64, f64),
    replaced: usize,
    end: AntisymmetricEnd,
    /// Components that vanish at the mirror in the replaced problem.
    rows: Vec<usize>,
    residual: Residual,
    change: Direction,
}

impl SymmetryBreaking {
    /// Sign and logarithm of det J_a alone, for watching a branch: the antisymmetric determinant on the factorised
    /// intervals in `system`.
    ///
    /// # Errors
    /// If a pivot is not finite.
    pub fn test<P: MirrorSymmetric>(&mut self, system: &System, problem: &P) -> Result<(f64, f64), FactorisationError> {
        let det = system.factor_antisymmetric(problem.vanishing_at_mirror(), &mut self.end)?;
        Ok((det.sign, det.log_abs))
    }

    /// Solves the replaced problem for −`residual` and returns the residual of the replaced condition. At g = 0 it is zero for every
    /// `residual` in the range of J_a.
    ///
    /// # Errors
    /// If there are no factors, or the residual has other sizes.
    pub fn project(&mut self, system: &mut System, residual: &Residual) -> Result<f64, InvalidInput> {
        system.solve_antisymmetric_last_node(&self.end, residual, &mut self.change)?;
        Ok(self.remainder(system, &self.change))
    }

    /// Factorises the problem with the last of the components that vanish replaced by `normaliser`.
    fn replace(
        &mut self,
        system: &System,
        vanishing: &[usize],
        normaliser: usize,
    ) -> Result<Determinant, FactorisationError> {
        let Some((&replaced, others)) = vanishing.split_last() else {
            let (name, length) = ("components that vanish at the mirror", 0);
            return Err(InvalidInput::Length { name, length, expected: 1 }.into());
        };
        self.rows.clear();
        self.rows.extend_from_slice(others);
        self.rows.push(normaliser);
        self.replaced = replaced;
        self.normaliser = normaliser;
        system.factor_antisymmetric(&self.rows, &mut self.end)
    }

    /// Solves the replaced problem for φ with its normalising component 1; returns g.
    fn solve_replaced(&mut self, system: &mut System) -> Result<f64, InvalidInput> {
        let count = self.rows.len();
        let mut right = [0.0; MAX_UNKNOWNS];
        let right = &mut right[..count.min(MAX_UNKNOWNS)];
        if let Some(normalising) = right.last_mut() {
            *normalising = 1.0;
        }
        system.solve_antisymmetric_unit(&self.end, right, &mut self.null)?;
        Ok(self.remainder(system, &self.null))
    }

    /// The component at the mirror that the condition replaced would make vanish.
    fn remainder(&self, system: &System, direction: &Direction) -> f64 {
        let last = direction.nodes.rchunks(system.dimensions().components.max(1)).next();
        last.and_then(|node| node.get(self.replaced)).copied().unwrap_or(f64::NAN)
    }
}

/// A null vector this much larger than its normalising component asks for another one.
const LARGE: f64 = 1e4;

impl<P: Directional + MirrorSymmetric> Singularity<P> for SymmetryBreaking {
    fn check(&self, problem: &P, dims: Dimensions) -> Result<(), InvalidInput> {
        let (vanishing, free) = (problem.vanishing_at_mirror(), problem.free_at_mirror());
        let needed = dims.components.saturating_sub(dims.left);
        invalid::length("components that vanish at the mirror", vanishing.len(), needed)?;
        invalid::index("component that vanishes at the mirror", 0, vanishing.len())?;
        invalid::index("component that is free at the mirror", 0, free.len())?;
        vanishing.iter().chain(free).try_for_each(|&c| invalid::index("component", c, dims.components))
    }

    fn evaluate(&mut self, system: &mut System, problem: &P, _w: &Direction) -> Result<f64, FactorisationError> {
        let mut failure = PivotFailure { column: 0, non_finite: false }.into();
        let normalisers = problem.free_at_mirror();
        for (attempt, &normaliser) in normalisers.iter().enumerate() {
            let det = match self.replace(system, problem.vanishing_at_mirror(), normaliser) {
                Ok(det) if det.sign != 0.0 => det,
                Ok(_) => continue,
                Err(error) => {
                    failure = error;
                    continue;
                }
            };
            let g = self.solve_replaced(system)?;
            let largest = self.null.nodes.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
            if largest < LARGE || attempt + 1 == normalisers.len() {
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
    fn derivative(
        &mut self,
        system: &mut System,
        problem: &mut P,
        y: &Solution,
        _w: &Direction,
        d: &Direction,
    ) -> Result<f64, InvalidInput> {
        let mut residual = std::mem::take(&mut self.residual);
        second_residual(&system.gauss, problem, y, [d, &self.null], 0, &mut residual);
        residual.right.clear();
        residual.right.resize(problem.vanishing_at_mirror().len(), 0.0);
        let change = self.project(system, &residual);
        self.residual = residual;
        change
    }
}
