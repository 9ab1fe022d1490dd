//! Perturbations described at every collocation point: by their normal displacement w and, for a regulator, δφ − j δw.

use furrow_bvp::{CollocationPoint, Direction, Gauss, InvalidInput, Residual, Solution, SolutionOperator, System};

use crate::cortex::Cortex;
use crate::cortex::amount::AmountOf;
use crate::cortex::equations::{COMPONENTS, J, LENGTH, PHI, PSI, R, REGULATED, Z};
use crate::cortex::lanes::sin_cos;
use crate::cortex::problem::{MotionResponse, QUADRATURES};

/// Components that are not quadratures, with a regulator.
const MOST_FORCED: usize = REGULATED - QUADRATURES - 1;

/// The dependence of the equations about one shape on a perturbation of the past, and the description of the present
/// one.
#[derive(Clone, Debug, Default)]
pub(super) struct Disturbances {
    /// h s times the response of the equations to motion, at every collocation point.
    response: Vec<MotionResponse>,
    /// (sinψ, cosψ), and j of a regulator.
    normal: Vec<[f64; 3]>,
    /// Quadrature weights of the inner product ∫ w² du, and of ∫ (R0 φ)² du.
    pub(super) weights: Vec<f64>,
    amount: AmountOf,
    /// Numbers per collocation point: 2 with a regulator.
    pub(super) per_point: usize,
    /// The response and the reading of a perturbation as matrices, see [`SolutionOperator::assemble`].
    force: Vec<f64>,
    reading: Vec<f64>,
}

impl Disturbances {
    /// Sets the data for a shape, at a rate s.
    pub(super) fn set(&mut self, cortex: &Cortex, y: &Solution, gauss: &Gauss, rate: f64) {
        self.response.clear();
        self.normal.clear();
        self.weights.clear();
        self.amount = AmountOf::disturbances(cortex, y, gauss);
        self.per_point = if y.components == REGULATED { 2 } else { 1 };
        let scales = [1.0, cortex.cell.r0 * cortex.cell.r0];
        for i in 0..y.intervals() {
            let h = y.mesh[i + 1] - y.mesh[i];
            for j in 0..y.m {
                let state = y.stage(i, j);
                let at = CollocationPoint { x: y.stage_x(gauss, i, j), index: self.response.len() };
                let response = cortex.response_to_motion(at, state, y.scalars[LENGTH]);
                self.response.push(response.scaled(h * rate));
                let (sin, cos) = sin_cos(state[PSI]);
                self.normal.push([sin, cos, state.get(J).copied().unwrap_or(0.0)]);
                self.weights.extend(scales[..self.per_point].iter().map(|scale| h * gauss.b[j] * scale));
            }
        }
    }

    /// The map from a perturbation of the past to the present one, for a condensed system.
    pub(super) fn assemble(&mut self, system: &System, operator: &mut SolutionOperator) -> Result<(), InvalidInput> {
        self.force.clear();
        self.reading.clear();
        let (components, forced) =
            if self.per_point == 2 { (REGULATED, MOST_FORCED) } else { (COMPONENTS, COMPONENTS - QUADRATURES) };
        for (response, [sin, cos, gradient]) in self.response.iter().zip(&self.normal) {
            let mut columns = [[0.0; REGULATED]; 2];
            response.put(1.0, 0.0, &mut columns[0][..components]);
            response.put(0.0, 1.0, &mut columns[1][..components]);
            for row in QUADRATURES..QUADRATURES + forced {
                self.force.extend(columns[..self.per_point].iter().map(|column| column[row]));
            }
            let mut rows = [[0.0; REGULATED]; 2];
            (rows[0][R], rows[0][Z]) = (*sin, *cos);
            (rows[1][PHI], rows[1][R], rows[1][Z]) = (1.0, -gradient * cos, gradient * sin);
            rows[..self.per_point].iter().for_each(|row| self.reading.extend(&row[..components]));
        }
        operator.assemble(system, [self.per_point; 2], &self.force, &self.reading)
    }

    /// Removes the part of a perturbation that changes the amount of a conserved regulator.
    pub(super) fn conserve(&self, disturbance: &mut [f64]) {
        if self.per_point == 2 {
            let excess = self.amount.excess(disturbance.as_chunks::<2>().0.iter().copied());
            disturbance.iter_mut().skip(1).step_by(2).for_each(|phi| *phi -= excess);
        }
    }

    /// s M w, written to a residual that was zero or belongs to another w.
    pub(super) fn load(&self, from: &[f64], residual: &mut Residual) {
        let components = residual.stages.len() / self.response.len();
        let (rows, from) = (residual.stages.chunks_exact_mut(components), from.chunks_exact(self.per_point));
        for ((row, from), response) in rows.zip(from).zip(&self.response) {
            // The stage residual is … − h f with ∂f/∂(past w) = −s ∂f/∂v_n.
            response.put(from[0], from.get(1).copied().unwrap_or(0.0), row);
        }
    }

    /// Reads the perturbation from a change of the whole state.
    pub(super) fn read(&self, change: &Direction, to: &mut [f64]) {
        let states = change.stages.chunks_exact(change.stages.len() / self.normal.len());
        for ((y, to), [sin, cos, gradient]) in states.zip(to.chunks_exact_mut(self.per_point)).zip(&self.normal) {
            to[0] = sin * y[R] + cos * y[Z];
            if let Some(changed) = to.get_mut(1) {
                *changed = y[PHI] - gradient * (cos * y[R] - sin * y[Z]);
            }
        }
    }
}
