//! A collocation solution: mesh, node values, stage values, scalar unknowns.

use crate::gauss::{Gauss, MAX_STAGES};

/// A piecewise polynomial of degree m on a mesh, with the scalar unknowns that belong to it.
///
/// On interval i the polynomial takes the values `node(i)` at the left node and `stage(i, j)` at the Gauss points.
///
/// # Examples
/// ```
/// use bvp::{Gauss, Solution, mesh};
/// let gauss = Gauss::new(4);
/// let sine = |x: f64, y: &mut [f64]| y.copy_from_slice(&[x.sin(), x.cos()]);
/// let y = Solution::from_fn(&gauss, &mesh::uniform(0.0, 3.0, 12), 2, &[], sine);
/// let finer = y.on_mesh(&gauss, &mesh::halved(&y.mesh));
/// let mut value = [0.0; 2];
/// finer.eval(&gauss, 1.0, &mut value);
/// assert!((value[0] - 1f64.sin()).abs() < 1e-5);
/// ```
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Solution {
    /// Components n.
    pub components: usize,
    /// Stages m.
    pub m: usize,
    /// Mesh x₀ < … < x_N; length N + 1.
    pub mesh: Vec<f64>,
    /// Node values; (N + 1) × n.
    pub nodes: Vec<f64>,
    /// Stage values; N × m × n.
    pub stages: Vec<f64>,
    /// Scalar unknowns.
    pub scalars: Vec<f64>,
}

impl Solution {
    /// Samples `value` (writing n components at x) on a mesh.
    pub fn from_fn(
        gauss: &Gauss,
        mesh: &[f64],
        components: usize,
        scalars: &[f64],
        mut value: impl FnMut(f64, &mut [f64]),
    ) -> Solution {
        let n_intervals = mesh.len() - 1;
        let mut s = Solution {
            components,
            m: gauss.m,
            mesh: mesh.to_vec(),
            nodes: vec![0.0; mesh.len() * components],
            stages: vec![0.0; n_intervals * gauss.m * components],
            scalars: scalars.to_vec(),
        };
        for (i, &x) in mesh.iter().enumerate() {
            value(x, &mut s.nodes[i * components..(i + 1) * components]);
        }
        for i in 0..n_intervals {
            for j in 0..gauss.m {
                let k = i * gauss.m + j;
                value(s.stage_x(gauss, i, j), &mut s.stages[k * components..(k + 1) * components]);
            }
        }
        s
    }

    /// Number of mesh intervals N.
    pub fn intervals(&self) -> usize {
        self.mesh.len() - 1
    }

    /// Values at node i.
    pub fn node(&self, i: usize) -> &[f64] {
        &self.nodes[i * self.components..(i + 1) * self.components]
    }

    /// Values at stage j of interval i.
    pub fn stage(&self, i: usize, j: usize) -> &[f64] {
        let k = i * self.m + j;
        &self.stages[k * self.components..(k + 1) * self.components]
    }

    /// Position of stage j of interval i.
    pub fn stage_x(&self, gauss: &Gauss, i: usize, j: usize) -> f64 {
        self.mesh[i] + (self.mesh[i + 1] - self.mesh[i]) * gauss.c[j]
    }

    /// The interval that contains x (clamped to the mesh).
    pub fn interval_of(&self, x: f64) -> usize {
        let after = self.mesh.partition_point(|&node| node <= x);
        after.saturating_sub(1).min(self.intervals() - 1)
    }

    /// The collocation polynomial at x, all components into `out`.
    pub fn eval(&self, gauss: &Gauss, x: f64, out: &mut [f64]) {
        let i = self.interval_of(x);
        self.eval_in(gauss, i, (x - self.mesh[i]) / (self.mesh[i + 1] - self.mesh[i]), out);
    }

    /// The polynomial of interval i at θ ∈ [0, 1].
    pub fn eval_in(&self, gauss: &Gauss, i: usize, theta: f64, out: &mut [f64]) {
        let mut basis = [0.0; MAX_STAGES + 1];
        gauss.basis(theta, &mut basis[..=self.m]);
        self.combine(i, &basis, out);
    }

    /// Derivative with respect to x of the polynomial of interval i at θ ∈ [0, 1].
    pub fn slope_in(&self, gauss: &Gauss, i: usize, theta: f64, out: &mut [f64]) {
        let mut basis = [0.0; MAX_STAGES + 1];
        gauss.basis_derivative(theta, &mut basis[..=self.m]);
        let h = self.mesh[i + 1] - self.mesh[i];
        basis.iter_mut().for_each(|b| *b /= h);
        self.combine(i, &basis, out);
    }

    /// The polynomial of degree m + 1 through both nodes and the stages of interval i at θ ∈ [0, 1].
    fn eval_between_nodes(&self, gauss: &Gauss, i: usize, theta: f64, out: &mut [f64]) {
        let mut basis = [0.0; MAX_STAGES + 2];
        gauss.basis_between_nodes(theta, &mut basis);
        self.combine(i, &basis, out);
        let (weight, right) = (basis[self.m + 1], self.node(i + 1));
        for (c, o) in out.iter_mut().enumerate() {
            *o += weight * right[c];
        }
    }

    /// basis₀ y₀ + Σ_j basis_j Y_j of interval i.
    pub(crate) fn combine(&self, i: usize, basis: &[f64], out: &mut [f64]) {
        let y0 = self.node(i);
        for (c, o) in out.iter_mut().enumerate() {
            *o = basis[0] * y0[c];
        }
        for j in 0..self.m {
            let y = self.stage(i, j);
            for (c, o) in out.iter_mut().enumerate() {
                *o += basis[j + 1] * y[c];
            }
        }
    }

    /// The same function on another mesh of the same stage count, by the polynomials through both nodes and the stages of
    /// each interval. For a solution they are its collocation polynomials; for values that only approximate one, such as
    /// those carried over before, they treat left and right alike: a mirrored problem stays a mirrored problem.
    pub fn on_mesh(&self, gauss: &Gauss, mesh: &[f64]) -> Solution {
        let mut out = Solution {
            components: self.components,
            m: self.m,
            mesh: Vec::new(),
            nodes: Vec::new(),
            stages: Vec::new(),
            scalars: Vec::new(),
        };
        self.transfer_into(gauss, mesh, &mut out);
        out
    }

    /// [`on_mesh`](Self::on_mesh) into storage that is reused.
    pub fn transfer_into(&self, gauss: &Gauss, mesh: &[f64], out: &mut Solution) {
        let n = self.components;
        out.components = n;
        out.m = self.m;
        out.mesh.clear();
        out.mesh.extend_from_slice(mesh);
        out.scalars.clear();
        out.scalars.extend_from_slice(&self.scalars);
        out.nodes.resize(mesh.len() * n, 0.0);
        out.stages.resize((mesh.len() - 1) * self.m * n, 0.0);
        let last = self.intervals() - 1;
        let mut from = 0;
        let mut put = |x: f64, value: &mut [f64]| {
            while from < last && x > self.mesh[from + 1] {
                from += 1;
            }
            // A node of the old mesh keeps its superconvergent value.
            if x == self.mesh[from + 1] {
                value.copy_from_slice(self.node(from + 1));
            } else {
                self.eval_between_nodes(
                    gauss,
                    from,
                    (x - self.mesh[from]) / (self.mesh[from + 1] - self.mesh[from]),
                    value,
                );
            }
        };
        for i in 0..mesh.len() {
            put(mesh[i], &mut out.nodes[i * n..(i + 1) * n]);
            if i + 1 < mesh.len() {
                let h = mesh[i + 1] - mesh[i];
                for j in 0..self.m {
                    let k = i * self.m + j;
                    put(mesh[i] + h * gauss.c[j], &mut out.stages[k * n..(k + 1) * n]);
                }
            }
        }
    }
}
