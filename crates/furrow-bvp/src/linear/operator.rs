//! The solution operator of a linearised problem: its discrete Green's function.

use crate::dimensions::{Dimensions, MAX_UNKNOWNS};
use crate::kernels::{AntisymmetricEnd, MAX_READINGS, Responses, forces_onto_nodes, read_responses};

use super::system::{Progress, System};

/// The map from forces at the collocation points to readings of the solution there: −C J⁻¹ B, where few forces and readings belong to a
/// point. Iterations for eigenvalues apply it many times. Each application takes less than a [`solve`](System::solve), since what happens
/// inside the intervals is precomputed.
///
/// # Examples
/// Displacement u = x (1 − x)/2 of a string under its weight, u″ + λ w = 0 with u(0) = u(1) = 0, for a load on the equation of u′
/// and a reading of u. `Oscillator` is in `examples/problems/oscillator.rs`; its λ is held by a linear condition.
///
/// ```
/// # mod oscillator { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/problems/oscillator.rs")); }
/// # use oscillator::{Force, Oscillator};
/// use furrow_bvp::{BoundaryValueProblem, LinearCondition, SolutionOperator, System, metric};
/// let mut problem = Oscillator { force: Force::Of(|_| [0.0; 4]), right: 0 };
/// let y = problem.zero(1.0, 5, 3, 0.0);
/// let mut conditions = vec![LinearCondition::default()];
/// metric::scalar_condition(&y, 0, 0.0, &mut conditions[0]);
/// let mut system = System::new(problem.dimensions(), y.m);
/// system.evaluate(&mut problem, &y, &conditions, true);
/// system.condense()?;
/// system.factor_blocks(&conditions)?;
/// // Residuals are −h f, with u″ = −1 where the load is one; the width of the intervals is 1/5.
/// let (force, reading) = ([0.0, 0.2].repeat(15), [1.0, 0.0].repeat(15));
/// let (mut operator, mut u) = (SolutionOperator::default(), [0.0; 15]);
/// operator.assemble(&system, [1, 1], &force, &reading);
/// operator.apply(&mut system, None, &[1.0; 15], &mut u, &mut [0.0]);
/// // The eighth of the fifteen points lies at x = ½.
/// assert!((u[7] - 0.125).abs() < 1e-14);
/// # Ok::<(), furrow_bvp::PivotFailure>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct SolutionOperator {
    responses: Responses,
    /// Sizes, stages and intervals of the system that was assembled; `None` if it did not fit.
    assembled: Option<(Dimensions, usize, usize)>,
    /// Nodes of the last product.
    nodes: Vec<f64>,
}

impl SolutionOperator {
    /// Precomputes what happens inside the intervals of a condensed system.
    ///
    /// There are `forces` and `readings` per collocation point. `force` has what they add to the residuals of the components that are not
    /// quadratures; points × components × forces. `reading` has the readings of all components; points × readings × components. If their
    /// lengths do not fit, or an interval has more than 64 readings, products are NaN.
    pub fn assemble(&mut self, system: &System, [forces, readings]: [usize; 2], force: &[f64], reading: &[f64]) {
        let (dims, m, intervals) = (system.dimensions(), system.gauss.m, system.condensed.intervals());
        let own = dims.components.saturating_sub(dims.all_quadratures());
        let entries = |sizes: [usize; 3]| sizes.into_iter().fold(intervals, usize::saturating_mul);
        let fits = system.stage >= Progress::Condensed
            && [force.len(), reading.len()] == [entries([m, own, forces]), entries([m, readings, dims.components])]
            && m.saturating_mul(readings) <= MAX_READINGS;
        self.assembled = fits.then_some((dims, m, intervals));
        if fits {
            (self.responses.forces, self.responses.readings) = (forces, readings);
            (system.kernels.fill_responses)(&mut self.responses, &system.condensed, &system.gauss, force, reading);
        }
    }

    /// The readings `to`, points × readings, that belong to the forces `from`, points × forces, and the scalar unknowns; those of the
    /// antisymmetric problem if its end is given, which has none. The factors are to be of the system that was
    /// [assembled](Self::assemble). NaN if they are not there, or lengths do not fit.
    pub fn apply(
        &mut self,
        system: &mut System,
        end: Option<&AntisymmetricEnd>,
        from: &[f64],
        to: &mut [f64],
        scalars: &mut [f64],
    ) {
        let Dimensions { components: n, scalars: np, left, right, integrals, .. } = system.dimensions();
        let (intervals, m) = (system.condensed.intervals(), system.gauss.m);
        let Responses { forces, readings, .. } = self.responses;
        let there = match end {
            Some(end) => system.stage >= Progress::Eliminated && end.size() == n && left <= n,
            None => system.stage >= Progress::Factored,
        };
        let fits = self.assembled == Some((system.dimensions(), m, intervals))
            && [from.len(), to.len(), scalars.len()] == [intervals * m * forces, intervals * m * readings, np];
        if !there || !fits {
            to.fill(f64::NAN);
            scalars.fill(f64::NAN);
            return;
        }
        self.nodes.resize((intervals + 1) * n, 0.0);
        let (mut carried, mut border) = ([0.0; MAX_UNKNOWNS], [0.0; MAX_UNKNOWNS]);
        let integrals = if end.is_some() { 0 } else { integrals };
        forces_onto_nodes(&self.responses, &system.condensed, from, &mut self.nodes, &mut border[..integrals]);
        let (carried, border) = (&mut carried[..left], &mut border[..system.block.borders()]);
        (system.kernels.forward)(&mut system.block, &self.nodes, carried, border);
        let right = if end.is_some() { system.antisymmetric_conditions() } else { right };
        let right = &[0.0; MAX_UNKNOWNS][..right];
        scalars.fill(0.0);
        let (found, border) = if end.is_some() { (&mut [][..], &[][..]) } else { (&mut *scalars, &*border) };
        system.block.solve_last(end, [carried, right, border], &mut self.nodes, found);
        (system.kernels.backward)(&mut system.block, &mut self.nodes, found);
        read_responses(&self.responses, &system.condensed, from, [&self.nodes, scalars], to);
    }
}
