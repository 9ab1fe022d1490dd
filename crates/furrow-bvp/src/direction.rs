//! Directions in the space of solutions, residuals of equations and linear conditions on solutions.

use crate::dense::{add_multiple, largest, weighted_maximum, zeroed};
use crate::invalid::{InvalidInput, length};
use crate::solution::Solution;

/// A linear condition Σ w_i·y_i + w_p·p = value on all nodes and scalars, e.g. the pseudo-arclength condition.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LinearCondition {
    /// Weights of the node values; (N + 1) × n.
    pub nodes: Vec<f64>,
    /// Weights of the scalar unknowns.
    pub scalars: Vec<f64>,
    /// Right-hand side.
    pub value: f64,
}

impl LinearCondition {
    /// Checks the numbers of node values and of scalar unknowns.
    pub(crate) fn check(&self, nodes: usize, scalars: usize) -> Result<(), InvalidInput> {
        length("node weights in a linear condition", self.nodes.len(), nodes)?;
        length("scalar weights in a linear condition", self.scalars.len(), scalars)
    }

    /// Σ w_i·y_i + w_p·p.
    pub(crate) fn form(&self, nodes: &[f64], scalars: &[f64]) -> f64 {
        let dot = |w: &[f64], v: &[f64]| w.iter().zip(v).map(|(w, v)| w * v).sum::<f64>();
        dot(&self.nodes, nodes) + dot(&self.scalars, scalars)
    }
}

/// Residuals of all equations; also a general right-hand side: the system solved is J δ = −residual.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Residual {
    /// Σ_k D_jk (Y_k − y₀) − h f(Y_j); N × m × n.
    pub stages: Vec<f64>,
    /// y₀ + Σ d_j (Y_j − y₀) − y₁; N × n.
    pub nodes: Vec<f64>,
    /// Left conditions.
    pub left: Vec<f64>,
    /// Right conditions.
    pub right: Vec<f64>,
    /// Integral conditions, then linear conditions.
    pub border: Vec<f64>,
}

impl Residual {
    /// Makes it zero, with the given lengths in the order of the fields.
    pub(crate) fn reset(&mut self, lengths: [usize; 5]) {
        let Residual { stages, nodes, left, right, border } = self;
        for (v, len) in [stages, nodes, left, right, border].into_iter().zip(lengths) {
            zeroed(v, len);
        }
    }

    /// The largest size of an entry, NaN if any is not a number.
    pub(crate) fn largest(&self) -> f64 {
        let parts = [&self.stages, &self.nodes, &self.left, &self.right, &self.border].map(|part| largest(part));
        largest(&parts)
    }

    /// Adds λ times another residual of the same shape.
    pub(crate) fn add(&mut self, lambda: f64, other: &Residual) {
        let to = [&mut self.stages, &mut self.nodes, &mut self.left, &mut self.right, &mut self.border];
        for (to, from) in to.into_iter().zip([&other.stages, &other.nodes, &other.left, &other.right, &other.border]) {
            add_multiple(to, lambda, from);
        }
    }
}

/// An update δ of a solution, or a direction along a curve of solutions.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Direction {
    /// Node values; (N + 1) × n.
    pub nodes: Vec<f64>,
    /// Stage values; N × m × n.
    pub stages: Vec<f64>,
    /// Scalar unknowns.
    pub scalars: Vec<f64>,
}

impl Direction {
    /// Checks the lengths for a solution.
    pub(crate) fn check(&self, y: &Solution) -> Result<(), InvalidInput> {
        length("node values of the direction", self.nodes.len(), y.nodes.len())?;
        length("stage values of the direction", self.stages.len(), y.stages.len())?;
        length("scalars of the direction", self.scalars.len(), y.scalars.len())
    }

    /// Largest entry of |δ| / (1 + |value|).
    pub fn norm(&self, about: &Solution) -> f64 {
        let norms = [
            weighted_maximum(&self.nodes, &about.nodes),
            weighted_maximum(&self.stages, &about.stages),
            weighted_maximum(&self.scalars, &about.scalars),
        ];
        if norms.iter().any(|n| n.is_nan()) { f64::NAN } else { norms.into_iter().fold(0.0, f64::max) }
    }

    /// Largest size of a node value, NaN if any is not a number.
    pub fn largest_at_nodes(&self) -> f64 {
        largest(&self.nodes)
    }

    /// Multiplies by a factor.
    pub fn scale(&mut self, factor: f64) {
        for v in self.nodes.iter_mut().chain(&mut self.stages).chain(&mut self.scalars) {
            *v *= factor;
        }
    }

    /// Adds λ times another update of the same shape.
    pub fn add(&mut self, lambda: f64, other: &Direction) {
        for (v, d) in
            [(&mut self.nodes, &other.nodes), (&mut self.stages, &other.stages), (&mut self.scalars, &other.scalars)]
        {
            add_multiple(v, lambda, d);
        }
    }

    /// Adds λδ to a solution.
    pub fn apply(&self, lambda: f64, to: &mut Solution) {
        for (d, v) in [(&self.nodes, &mut to.nodes), (&self.stages, &mut to.stages), (&self.scalars, &mut to.scalars)] {
            add_multiple(v, lambda, d);
        }
    }
}
