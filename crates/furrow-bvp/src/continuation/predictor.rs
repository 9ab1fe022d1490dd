//! Points known along a curve, and extrapolation from them: the predictor of every continuation.

use serde::{Deserialize, Serialize};

use crate::direction::LinearCondition;
use crate::gauss::Gauss;
use crate::invalid::{self, InvalidInput};
use crate::metric::evaluate;
use crate::solution::{Solution, Transfer};

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

    /// Checks that all points are on the mesh of `y`, and of its sizes.
    ///
    /// # Errors
    /// [`InvalidInput`].
    pub fn check(&self, y: &Solution) -> Result<(), InvalidInput> {
        invalid::setting("the order of the history", self.limit as f64, self.limit > 0, "a whole number from 1")?;
        for (position, point) in &self.points {
            invalid::setting("a position in the history", *position, position.is_finite(), "a finite number")?;
            invalid::length("stages of a point in the history", point.m, y.m)?;
            invalid::length("components of a point in the history", point.components, y.components)?;
            invalid::length("scalars of a point in the history", point.scalars.len(), y.scalars.len())?;
            invalid::length("mesh nodes of a point in the history", point.mesh.len(), y.mesh.len())?;
            point.check()?;
        }
        Ok(())
    }

    /// Adds a point; the oldest makes room.
    pub fn push(&mut self, position: f64, y: &Solution) {
        if self.points.len() < self.limit.max(1) {
            self.points.push((position, y.clone()));
        } else {
            self.points.rotate_left(1);
            let Some((at, newest)) = self.points.last_mut() else { return };
            *at = position;
            newest.clone_from(y);
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

    /// The point `k` before the newest, the newest itself for 0.
    pub fn back(&self, k: usize) -> Option<(f64, &Solution)> {
        self.points.iter().rev().nth(k).map(|(position, y)| (*position, y))
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
        let Some((_, first)) = self.points.first() else { return };
        let transfer = Transfer::new(gauss, &first.mesh, mesh);
        for (_, y) in &mut self.points {
            let mut moved = y.clone();
            transfer.apply(y, &mut moved);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh;
    use crate::metric::scalar_condition;

    #[test]
    fn extrapolates_cubics_exactly_and_over_a_change_of_mesh() {
        let gauss = Gauss::new(4).unwrap();
        let at = |s: f64, grid: &[f64]| {
            Solution::from_fn(&gauss, grid, 1, &[s * s * s], |x, y| y[0] = x * x * (s - 1.0) + s * s).unwrap()
        };
        let (coarse, fine) = (mesh::uniform(0.0, 1.0, 3), mesh::uniform(0.0, 1.0, 5));
        let mut history = History::default();
        for s in [0.0, 0.2, 0.5, 0.6, 1.1] {
            history.push(s, &at(s, &coarse));
        }
        history.transfer(&gauss, &fine);
        let mut out = Solution::from_fn(&gauss, &fine, 1, &[0.0], |_, _| {}).unwrap();
        history.extrapolate(1.4, &mut out);
        let exact = at(1.4, &fine);
        for (a, b) in out.nodes.iter().chain(&out.scalars).zip(exact.nodes.iter().chain(&exact.scalars)) {
            assert!((a - b).abs() < 1e-12, "{a} {b}");
        }
    }

    /// Points at uneven places of the curve (s, s², s³ − s), the last two behind a turn against t.
    #[test]
    fn predicts_in_a_plane_exactly_and_leaves_out_what_ran_against_it() {
        let (gauss, grid) = (Gauss::new(2).unwrap(), mesh::uniform(0.0, 1.0, 2));
        let at = |s: f64| Solution::from_fn(&gauss, &grid, 1, &[s, s * s, s * s * s - s], |_, y| y[0] = 0.0).unwrap();
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
