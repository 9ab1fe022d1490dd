//! A solution between its nodes.
//!
//! The collocation polynomial p of degree m has an error of order h^(m+1) between the nodes, though h^(2m) at them. Its slopes at the Gauss points
//! are f(Y_j). The integral of the polynomial through these slopes and f at both nodes, N.22, has an error of order h^(m+2).
//!
//! # References
//! Enright & Muir, SIAM J. Sci. Comput. 17, 479 (1996) (interpolants of Runge–Kutta formulas by evaluations at nodes).

use crate::gauss::Gauss;
use crate::solution::Solution;

use super::work::Work;

/// A solution, its defect and its cost.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Solved {
    /// The solution, on a mesh of its own.
    pub solution: Solution,
    /// Its largest defect.
    pub defect: f64,
    /// Estimated condition of the problem there, from a few solves and from below: by how much the solution changes, in |δ|/(1 + |value|),
    /// per change of the right-hand side by 1 + |value|, of conditions at the ends by their largest derivative and of others by 1. Infinite for the best solution of a solve that was
    /// stopped, which has no factors to estimate it with.
    pub condition: f64,
    /// Estimated error, where [`Settings::error`](crate::Settings::error) asks for it: the largest |δ|/(1 + |value|) at its nodes between it
    /// and the solution on every other node, over 2^m − 1, as an error of order h^m falls. Smooth solutions are more accurate.
    #[serde(default)]
    pub error: Option<f64>,
    /// Steps are meshes on which Newton converged, those rejected meshes on which it did not.
    pub work: Work,
    /// h (p′ − f) at both nodes of every interval, from its side; N × 2 × n. Empty for a solution that is not accurate enough.
    pub(super) slopes: Vec<f64>,
}

impl Solved {
    /// A solution that was not checked for more than its defect.
    pub(super) fn unchecked(solution: Solution, defect: f64, work: Work) -> Solved {
        Solved { solution, defect, condition: f64::INFINITY, error: None, work, slopes: Vec::new() }
    }

    /// The solution at x, all components into `out`, between nodes more accurate than [`Solution::eval`].
    pub fn eval(&self, gauss: &Gauss, x: f64, out: &mut [f64]) {
        self.solution.eval(gauss, x, out);
        self.correct(x, |theta, _| gauss.corrections(theta).values, out);
    }

    /// Its derivative with respect to x.
    pub fn slope(&self, gauss: &Gauss, x: f64, out: &mut [f64]) {
        let Some((i, theta, _)) = self.place(x) else { return out.fill(f64::NAN) };
        self.solution.slope_in(gauss, i, theta, out);
        self.correct(x, |theta, h| gauss.corrections(theta).slopes.map(|slope| slope / h), out);
    }

    /// The interval of x, its place there from 0 to 1, and the width of the interval.
    fn place(&self, x: f64) -> Option<(usize, f64, f64)> {
        let i = self.solution.interval_of(x);
        let [left, right] = *self.solution.mesh.get(i..i + 2)? else { return None };
        Some((i, (x - left) / (right - left), right - left))
    }

    /// Corrects for both slopes at x. `weights` are for a place from 0 to 1 in an interval of some width.
    fn correct(&self, x: f64, weights: impl Fn(f64, f64) -> [f64; 2], out: &mut [f64]) {
        let (Some((i, theta, h)), n) = (self.place(x), self.solution.components) else { return };
        let Some(slopes) = self.slopes.get(2 * i * n..2 * (i + 1) * n) else { return };
        let weights = weights(theta, h);
        for (weight, slopes) in weights.into_iter().zip(slopes.chunks_exact(n)) {
            out.iter_mut().zip(slopes).for_each(|(out, slope)| *out -= weight * slope);
        }
    }
}

/// A smooth f differs from p′ at a node at most by this many times the defect of the interval.
pub(super) const SMOOTH: f64 = 10.0;

/// [`Solved::slopes`] from (p′ − f) h beside the nodes of intervals with these defects: 0 where f is not smooth, as at a singular end.
pub(super) fn smooth_slopes(y: &Solution, mut beside_nodes: Vec<f64>, defects: &[f64]) -> Vec<f64> {
    let n = y.components;
    for (k, slopes) in beside_nodes.chunks_exact_mut(n).enumerate() {
        let (i, end) = (k / 2, k % 2);
        let most = SMOOTH * defects.get(i).copied().unwrap_or(0.0);
        if !slopes.iter().zip(y.node(i + end)).all(|(slope, value)| slope.abs() <= most * (1.0 + value.abs())) {
            slopes.fill(0.0);
        }
    }
    beside_nodes
}
