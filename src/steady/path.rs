//! Curves of solutions: the norm that gives them a length, and extrapolation along them.

use serde::{Deserialize, Serialize};

use crate::numerics::{Gauss, LinearCondition, Solution, System, system::Update};

/// The inner product ⟨a, b⟩ = Σ_c W_c ∫ a_c b_c dx / (x_N − x₀) + Σ_k w_k a_k b_k on solutions, by the trapezoidal rule
/// on the nodes, so that an arclength does not depend on the mesh.
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

    fn node_weight(mesh: &[f64], i: usize) -> f64 {
        let last = mesh.len() - 1;
        0.5 * (mesh[(i + 1).min(last)] - mesh[i.saturating_sub(1)]) / (mesh[last] - mesh[0])
    }

    /// ⟨a, b⟩.
    pub fn dot(&self, mesh: &[f64], a: &Update, b: &Update) -> f64 {
        let n = self.components.len();
        let mut sum = 0.0;
        for i in 0..mesh.len() {
            let (a, b) = (&a.nodes[i * n..(i + 1) * n], &b.nodes[i * n..(i + 1) * n]);
            let part: f64 = (0..n).map(|c| self.components[c] * a[c] * b[c]).sum();
            sum += Metric::node_weight(mesh, i) * part;
        }
        sum + self.scalars.iter().zip(a.scalars.iter().zip(&b.scalars)).map(|(w, (a, b))| w * a * b).sum::<f64>()
    }

    /// Scales `direction` to length 1.
    pub fn normalise(&self, mesh: &[f64], direction: &mut Update) {
        let scale = self.dot(mesh, direction, direction).sqrt().recip();
        direction.scale(scale);
    }

    /// The condition ⟨direction, x − y⟩ = 0 on the unknown x.
    pub fn plane_through(&self, y: &Solution, direction: &Update, out: &mut LinearCondition) {
        let n = self.components.len();
        out.nodes.clear();
        for i in 0..y.mesh.len() {
            let weight = Metric::node_weight(&y.mesh, i);
            out.nodes.extend((0..n).map(|c| weight * self.components[c] * direction.nodes[i * n + c]));
        }
        out.scalars.clear();
        out.scalars.extend(self.scalars.iter().zip(&direction.scalars).map(|(w, d)| w * d));
        out.value = evaluate(out, y);
    }
}

/// Value of the linear form of a condition at a solution.
pub fn evaluate(condition: &LinearCondition, y: &Solution) -> f64 {
    let dot = |w: &[f64], v: &[f64]| w.iter().zip(v).map(|(w, v)| w * v).sum::<f64>();
    dot(&condition.nodes, &y.nodes) + dot(&condition.scalars, &y.scalars)
}

/// The condition that scalar unknown `index` takes a value.
pub fn scalar_condition(y: &Solution, index: usize, value: f64, out: &mut LinearCondition) {
    out.nodes.clear();
    out.nodes.resize(y.nodes.len(), 0.0);
    out.scalars.clear();
    out.scalars.resize(y.scalars.len(), 0.0);
    out.scalars[index] = 1.0;
    out.value = value;
}

/// Solutions at known positions along a curve, all on one mesh, for predicting the next.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct History {
    points: Vec<(f64, Solution)>,
    limit: usize,
}

impl Default for History {
    /// Extrapolation by a cubic.
    fn default() -> History {
        History::of_order(4)
    }
}

impl History {
    /// Keeps up to `order` points, by which extrapolation is of that order in the step.
    pub fn of_order(order: usize) -> History {
        History { points: Vec::new(), limit: order.max(1) }
    }

    /// Adds a point; the oldest makes room.
    pub fn push(&mut self, position: f64, y: &Solution) {
        if self.points.len() < self.limit {
            self.points.push((position, y.clone()));
        } else {
            self.points.rotate_left(1);
            let slot = &mut self.points[self.limit - 1];
            slot.0 = position;
            slot.1.clone_from(y);
        }
    }

    /// Puts another point in the place of the newest, and of any others not before it.
    pub fn replace_newest(&mut self, position: f64, y: &Solution) {
        self.points.pop();
        self.points.retain(|(earlier, _)| *earlier < position);
        self.push(position, y);
    }

    /// Points held.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether no point is held.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Forgets all points.
    pub fn clear(&mut self) {
        self.points.clear();
    }

    /// The newest point and its position.
    pub fn newest(&self) -> Option<(f64, &Solution)> {
        self.points.last().map(|(s, y)| (*s, y))
    }

    /// The point before the newest.
    pub fn before_newest(&self) -> Option<(f64, &Solution)> {
        self.back(1)
    }

    /// The point `k` before the newest.
    pub fn back(&self, k: usize) -> Option<(f64, &Solution)> {
        self.points.len().checked_sub(k + 1).map(|k| (self.points[k].0, &self.points[k].1))
    }

    /// Value at `position` of the polynomial through the newest points.
    pub fn extrapolate(&self, position: f64, out: &mut Solution) {
        let known: Vec<(f64, &Solution)> = self.points.iter().rev().map(|(s, y)| (*s, y)).collect();
        extrapolate(&known, position, out);
    }

    /// Predicts the point in the plane ⟨t, x⟩ = value, by extrapolation in the position along t: unlike an arclength put
    /// together from steps that is a smooth parameter of the curve, and exact of the point to be found. Points from where
    /// the curve ran against t are left out.
    pub fn predict(&self, plane: &LinearCondition, out: &mut Solution) {
        let mut known: Vec<(f64, &Solution)> = Vec::with_capacity(self.points.len());
        for (_, y) in self.points.iter().rev() {
            let position = evaluate(plane, y);
            if known.last().is_some_and(|(later, _)| position >= *later) {
                break;
            }
            known.push((position, y));
        }
        extrapolate(&known, plane.value, out);
    }

    /// Carries all points over to another mesh.
    pub fn transfer(&mut self, gauss: &Gauss, mesh: &[f64]) {
        for (_, y) in &mut self.points {
            let mut moved = y.clone();
            y.transfer_into(gauss, mesh, &mut moved);
            *y = moved;
        }
    }
}

/// Value at `position` of the polynomial through points, the newest first.
fn extrapolate(known: &[(f64, &Solution)], position: f64, out: &mut Solution) {
    let Some((_, newest)) = known.first() else { return };
    out.clone_from(newest);
    for values in [&mut out.nodes, &mut out.stages, &mut out.scalars] {
        values.fill(0.0);
    }
    for (k, (s, y)) in known.iter().enumerate() {
        let mut weight = 1.0;
        for (_, (other, _)) in known.iter().enumerate().filter(|(j, _)| *j != k) {
            weight *= (position - other) / (s - other);
        }
        for (to, from) in [(&mut out.nodes, &y.nodes), (&mut out.stages, &y.stages), (&mut out.scalars, &y.scalars)] {
            for (to, from) in to.iter_mut().zip(from) {
                *to += weight * from;
            }
        }
    }
}

/// Carries a direction over to another mesh.
pub fn transfer_direction(gauss: &Gauss, from: &[f64], to: &[f64], direction: &mut Update) {
    let components = direction.nodes.len() / from.len();
    let mut before = Solution {
        components,
        m: gauss.m,
        mesh: from.to_vec(),
        nodes: std::mem::take(&mut direction.nodes),
        stages: std::mem::take(&mut direction.stages),
        scalars: std::mem::take(&mut direction.scalars),
    };
    let mut after = before.clone();
    before.transfer_into(gauss, to, &mut after);
    before = after;
    (direction.nodes, direction.stages, direction.scalars) = (before.nodes, before.stages, before.scalars);
}

/// Solves J d = 0 with condition `which` of the linear conditions raised by 1, for the factors in `system`.
pub fn null_direction(system: &mut System, which: usize, out: &mut Update) {
    system.solve_unit(system.dimensions().integrals + which, out);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::mesh;

    #[test]
    fn extrapolates_cubics_exactly_and_over_a_change_of_mesh() {
        let gauss = Gauss::new(4);
        let at = |s: f64, grid: &[f64]| {
            Solution::from_fn(&gauss, grid, 1, &[s * s * s], |x, y| y[0] = x * x * (s - 1.0) + s * s)
        };
        let (coarse, fine) = (mesh::uniform(0.0, 1.0, 3), mesh::uniform(0.0, 1.0, 5));
        let mut history = History::default();
        for s in [0.0, 0.2, 0.5, 0.6, 1.1] {
            history.push(s, &at(s, &coarse));
        }
        history.transfer(&gauss, &fine);
        let mut out = Solution::from_fn(&gauss, &fine, 1, &[0.0], |_, _| {});
        history.extrapolate(1.4, &mut out);
        let exact = at(1.4, &fine);
        for (a, b) in out.nodes.iter().chain(&out.scalars).zip(exact.nodes.iter().chain(&exact.scalars)) {
            assert!((a - b).abs() < 1e-12, "{a} {b}");
        }
    }

    /// Points at uneven places of the curve (s, s², s³ − s), the last two behind a turn against t.
    #[test]
    fn predicts_in_a_plane_exactly_and_leaves_out_what_ran_against_it() {
        let (gauss, grid) = (Gauss::new(2), mesh::uniform(0.0, 1.0, 2));
        let at = |s: f64| Solution::from_fn(&gauss, &grid, 1, &[s, s * s, s * s * s - s], |_, y| y[0] = 0.0);
        let (mut history, here) = (History::of_order(6), 0.9);
        for s in [1.4, 1.1, 0.2, 0.3, 0.65, here] {
            history.push(0.0, &at(s));
        }
        let mut plane = LinearCondition::default();
        scalar_condition(&at(here), 0, here + 0.5, &mut plane);
        let mut out = at(0.0);
        history.predict(&plane, &mut out);
        for (found, exact) in out.scalars.iter().zip(at(here + 0.5).scalars) {
            assert!((found - exact).abs() < 1e-13, "{found} {exact}");
        }
    }
}
