//! The inner product that gives curves of solutions a length, and linear conditions made from it.

use serde::{Deserialize, Serialize};

use crate::direction::{Direction, LinearCondition};
use crate::gauss::Gauss;
use crate::invalid::{self, InvalidInput};
use crate::solution::Solution;

/// The inner product ⟨a, b⟩ = Σ_c W_c ∫ a_c b_c dx / (x_N − x₀) + Σ_k w_k a_k b_k on solutions, by the trapezoidal rule
/// on the nodes, so that an arclength does not depend on the mesh.
///
/// Weights make unknowns comparable: 1/s² for one of typical size s, 0 for one that follows from the others. The module
/// `tutorial` has more on the choice.
///
/// # Examples
/// ```
/// use furrow_bvp::{Direction, Metric, mesh};
/// let mesh = mesh::uniform(0.0, 4.0, 2);
/// // One component that is 3 at all nodes, and a scalar 4: the length is 5 on any mesh.
/// let mut direction = Direction { nodes: vec![3.0; 3], stages: vec![3.0; 4], scalars: vec![4.0] };
/// let metric = Metric::unit(1, 1);
/// assert_eq!(metric.dot(&mesh, &direction, &direction), 25.0);
/// metric.normalise(&mesh, &mut direction);
/// assert!((direction.scalars[0] - 0.8).abs() < 1e-15);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Metric {
    /// Weights W_c of the components.
    pub components: Vec<f64>,
    /// Weights w_k of the scalar unknowns.
    pub scalars: Vec<f64>,
}

impl Metric {
    /// All weights 1.
    pub fn unit(components: usize, scalars: usize) -> Metric {
        Metric { components: vec![1.0; components], scalars: vec![1.0; scalars] }
    }

    /// Checks that every unknown of a solution has a weight, that no weight is negative, and that one is not 0.
    ///
    /// # Errors
    /// [`InvalidInput`].
    pub fn check(&self, y: &Solution) -> Result<(), InvalidInput> {
        invalid::length("component weights in the metric", self.components.len(), y.components)?;
        invalid::length("scalar weights in the metric", self.scalars.len(), y.scalars.len())?;
        let weights = || self.components.iter().chain(&self.scalars).copied();
        for weight in weights() {
            invalid::setting("a weight of the metric", weight, weight >= 0.0 && weight.is_finite(), "a number from 0")?;
        }
        invalid::positive("the largest weight of the metric", weights().fold(0.0, f64::max))
    }

    fn node_weight(mesh: &[f64], i: usize) -> f64 {
        let last = mesh.len() - 1;
        0.5 * (mesh[(i + 1).min(last)] - mesh[i.saturating_sub(1)]) / (mesh[last] - mesh[0])
    }

    /// ⟨a, b⟩.
    pub fn dot(&self, mesh: &[f64], a: &Direction, b: &Direction) -> f64 {
        let n = self.components.len().max(1);
        let mut sum = 0.0;
        for (i, (a, b)) in (0..mesh.len()).zip(a.nodes.chunks_exact(n).zip(b.nodes.chunks_exact(n))) {
            let part: f64 = self.components.iter().zip(a.iter().zip(b)).map(|(w, (a, b))| w * a * b).sum();
            sum += Metric::node_weight(mesh, i) * part;
        }
        sum + self.scalars.iter().zip(a.scalars.iter().zip(&b.scalars)).map(|(w, (a, b))| w * a * b).sum::<f64>()
    }

    /// Scales `direction` to length 1.
    pub fn normalise(&self, mesh: &[f64], direction: &mut Direction) {
        let scale = self.dot(mesh, direction, direction).sqrt().recip();
        direction.scale(scale);
    }

    /// The condition ⟨direction, x − y⟩ = 0 on the unknown x.
    pub fn plane_through(&self, y: &Solution, direction: &Direction, out: &mut LinearCondition) {
        let n = self.components.len().max(1);
        out.nodes.clear();
        for (i, direction) in (0..y.mesh.len()).zip(direction.nodes.chunks_exact(n)) {
            let weight = Metric::node_weight(&y.mesh, i);
            out.nodes.extend(self.components.iter().zip(direction).map(|(w, d)| weight * w * d));
        }
        out.scalars.clear();
        out.scalars.extend(self.scalars.iter().zip(&direction.scalars).map(|(w, d)| w * d));
        out.value = evaluate(out, y);
    }
}

/// Value of the linear form of a condition at a solution.
pub fn evaluate(condition: &LinearCondition, y: &Solution) -> f64 {
    condition.form(&y.nodes, &y.scalars)
}

/// The condition that scalar unknown `index` takes a value. Where there is no such unknown no solution satisfies it.
pub fn scalar_condition(y: &Solution, index: usize, value: f64, out: &mut LinearCondition) {
    out.nodes.clear();
    out.nodes.resize(y.nodes.len(), 0.0);
    out.scalars.clear();
    out.scalars.resize(y.scalars.len(), 0.0);
    if let Some(weight) = out.scalars.get_mut(index) {
        *weight = 1.0;
    }
    out.value = value;
}

/// Carries a direction over to another mesh.
pub fn transfer_direction(gauss: &Gauss, from: &[f64], to: &[f64], direction: &mut Direction) {
    let components = direction.nodes.len() / from.len().max(1);
    let before = Solution {
        components,
        m: gauss.m,
        mesh: from.to_vec(),
        nodes: std::mem::take(&mut direction.nodes),
        stages: std::mem::take(&mut direction.stages),
        scalars: std::mem::take(&mut direction.scalars),
    };
    let Solution { nodes, stages, scalars, .. } = before.on_mesh(gauss, to);
    *direction = Direction { nodes, stages, scalars };
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By trapezes over nodes that are not evenly spaced, relative to the range, each component and scalar with its weight.
    #[test]
    fn the_product_of_directions_is_a_mean_over_the_mesh() {
        let metric = Metric { components: vec![1.0, 3.0], scalars: vec![0.5] };
        let direction = |nodes: [f64; 6], scalar: f64| Direction {
            nodes: nodes.to_vec(),
            stages: Vec::new(),
            scalars: vec![scalar],
        };
        let (a, b) = (direction([1.0, 0.0, 2.0, 1.0, 4.0, 0.0], 2.0), direction([1.0, 5.0, 1.0, 2.0, 0.5, 7.0], 3.0));
        // Products 1, 2 + 3·2 and 2 at 0, 1 and 4.
        let expected = (0.5 * (1.0 + 8.0) * 1.0 + 0.5 * (8.0 + 2.0) * 3.0) / 4.0 + 0.5 * 2.0 * 3.0;
        assert!((metric.dot(&[0.0, 1.0, 4.0], &a, &b) - expected).abs() < 1e-14);
    }
}
