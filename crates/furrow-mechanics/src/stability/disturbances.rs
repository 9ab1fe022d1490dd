//! Disturbances as what describes them: their normal displacement w at the collocation points, and δφ − j δw of a regulator.

use furrow_bvp::{CollocationPoint, Direction, Gauss, Residual, Solution};

use crate::cortex::Cortex;
use crate::cortex::equations::{J, LENGTH, PHI, PSI, R, REGULATED, Z};
use crate::cortex::lanes::sin_cos;
use crate::cortex::problem::MotionResponse;

/// How the equations about one shape depend on a disturbance that the past had, and what describes one now.
#[derive(Clone, Debug, Default)]
pub(super) struct Disturbances {
    /// h s times what a motion adds to the equations, at every collocation point.
    response: Vec<MotionResponse>,
    /// (sinψ, cosψ), and j of a regulator.
    normal: Vec<[f64; 3]>,
    /// Quadrature weights of the inner product ∫ w² du; behind them those of the regulator, ∫ (R0 φ)² du.
    pub(super) weights: Vec<f64>,
}

impl Disturbances {
    /// Those of a shape, at a rate s.
    pub(super) fn set(&mut self, cortex: &Cortex, y: &Solution, gauss: &Gauss, rate: f64) {
        self.response.clear();
        self.normal.clear();
        self.weights.clear();
        for i in 0..y.intervals() {
            let h = y.mesh[i + 1] - y.mesh[i];
            for j in 0..y.m {
                let state = y.stage(i, j);
                let at = CollocationPoint { x: y.stage_x(gauss, i, j), index: self.response.len() };
                let response = cortex.response_to_motion(at, state, y.scalars[LENGTH]);
                self.response.push(response.scaled(h * rate));
                let (sin, cos) = sin_cos(state[PSI]);
                self.normal.push([sin, cos, state.get(J).copied().unwrap_or(0.0)]);
                self.weights.push(h * gauss.b[j]);
            }
        }
        if y.components == REGULATED {
            let scale = cortex.cell.r0 * cortex.cell.r0;
            self.weights.extend_from_within(..);
            self.weights[self.normal.len()..].iter_mut().for_each(|weight| *weight *= scale);
        }
    }

    /// s M w, as a residual that was zero or of another w.
    pub(super) fn load(&self, from: &[f64], residual: &mut Residual) {
        let points = self.normal.len();
        let components = residual.stages.len() / points;
        let (displaced, changed) = from.split_at(points);
        for (i, (row, response)) in residual.stages.chunks_exact_mut(components).zip(&self.response).enumerate() {
            // The stage residual is … − h f with ∂f/∂(past w) = −s ∂f/∂v_n.
            response.put(displaced[i], changed.get(i).copied().unwrap_or(0.0), row);
        }
    }

    /// What describes a change of the whole state.
    pub(super) fn read(&self, change: &Direction, to: &mut [f64]) {
        let points = self.normal.len();
        let (displaced, changed) = to.split_at_mut(points);
        let states = change.stages.chunks_exact(change.stages.len() / points);
        for (i, (y, [sin, cos, gradient])) in states.zip(&self.normal).enumerate() {
            displaced[i] = sin * y[R] + cos * y[Z];
            if let Some(changed) = changed.get_mut(i) {
                *changed = y[PHI] - gradient * (cos * y[R] - sin * y[Z]);
            }
        }
    }
}
