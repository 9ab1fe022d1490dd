//! The solution operator of a linearised problem: its discrete Green's function.

use crate::dimensions::{Dimensions, MAX_UNKNOWNS};
use crate::invalid::{self, InvalidInput};
use crate::kernels::{AntisymmetricEnd, MAX_READINGS, Responses, forces_onto_nodes, read_responses};

use super::system::{Progress, System};

/// The map from forces at the collocation points to readings of the solution there: −C J⁻¹ B, where few forces and readings belong to a
/// point. Iterations for eigenvalues apply it many times. Each application takes less than a [`solve`](System::solve), since the
/// responses inside the intervals are precomputed.
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
/// system.factorise(&mut problem, &y, &conditions)?;
/// // Residuals are −h f, with u″ = −1 where the load is one; the width of the intervals is 1/5.
/// let (force, reading) = ([0.0, 0.2].repeat(15), [1.0, 0.0].repeat(15));
/// let (mut operator, mut u) = (SolutionOperator::default(), [0.0; 15]);
/// operator.assemble(&system, [1, 1], &force, &reading)?;
/// operator.apply(&mut system, None, &[1.0; 15], &mut u, &mut [0.0])?;
/// // The eighth of the fifteen points lies at x = ½.
/// assert!((u[7] - 0.125).abs() < 1e-14);
/// # Ok::<(), furrow_bvp::FactorisationError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct SolutionOperator {
    responses: Responses,
    /// Sizes, stages and intervals of the assembled system.
    assembled: Option<(Dimensions, usize, usize)>,
    /// Nodes of the last product.
    nodes: Vec<f64>,
}

impl SolutionOperator {
    /// Precomputes the responses inside the intervals of a condensed system.
    ///
    /// There are `forces` and `readings` per collocation point. `force` has the contributions of unit forces to the residuals of the
    /// components that are not quadratures; points × components × forces. `reading` has the coefficients of the readings in all
    /// components; points × readings × components.
    ///
    /// # Errors
    /// [`InvalidInput`] if the system is not condensed, lengths do not fit, or an interval has more than 64 readings.
    pub fn assemble(
        &mut self,
        system: &System,
        [forces, readings]: [usize; 2],
        force: &[f64],
        reading: &[f64],
    ) -> Result<(), InvalidInput> {
        self.assembled = None;
        system.require(Progress::Condensed)?;
        let (dims, m, intervals) = (system.dimensions(), system.gauss.m, system.condensed.intervals());
        let own = dims.components.saturating_sub(dims.all_quadratures());
        let entries = |per_point: usize, count: usize| (intervals * m * per_point).saturating_mul(count);
        invalid::length("coefficients of forces", force.len(), entries(own, forces))?;
        invalid::length("coefficients of readings", reading.len(), entries(dims.components, readings))?;
        invalid::at_most("readings of an interval", m.saturating_mul(readings), MAX_READINGS)?;
        (self.responses.forces, self.responses.readings) = (forces, readings);
        (system.kernels.fill_responses)(&mut self.responses, &system.condensed, &system.gauss, force, reading);
        self.assembled = Some((dims, m, intervals));
        Ok(())
    }

    /// Computes the readings `to`, points × readings, and the scalar unknowns that belong to the forces `from`, points × forces. With an
    /// `end` the antisymmetric problem is solved, which has no scalar unknowns. The system has to be the
    /// [assembled](Self::assemble) one.
    ///
    /// # Errors
    /// [`InvalidInput`] if the system has other sizes or no factors, or lengths do not fit.
    pub fn apply(
        &mut self,
        system: &mut System,
        end: Option<&AntisymmetricEnd>,
        from: &[f64],
        to: &mut [f64],
        scalars: &mut [f64],
    ) -> Result<(), InvalidInput> {
        let Dimensions { components: n, scalars: np, left, right, integrals, .. } = system.dimensions();
        let (intervals, m) = (system.condensed.intervals(), system.gauss.m);
        let Responses { forces, readings, .. } = self.responses;
        system.require_factors(end)?;
        invalid::ready(self.assembled == Some((system.dimensions(), m, intervals)), "assembled into the operator")?;
        invalid::length("forces", from.len(), intervals * m * forces)?;
        invalid::length("readings", to.len(), intervals * m * readings)?;
        invalid::length("scalars", scalars.len(), np)?;
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
        Ok(())
    }
}
