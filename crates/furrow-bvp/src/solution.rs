//! A collocation solution: mesh, node values, stage values, scalar unknowns.

use crate::gauss::{Gauss, MAX_STAGES};

/// A piecewise polynomial of degree m on a mesh, with the scalar unknowns that belong to it.
///
/// On interval i the polynomial takes the values `node(i)` at the left node and `stage(i, j)` at the Gauss points.
///
/// # Examples
/// ```
/// use furrow_bvp::{Gauss, Solution, mesh};
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

    /// The same values everywhere on a mesh, as a guess: `y` of the components and `scalars` of the scalar unknowns.
    pub fn constant(stages: usize, mesh: &[f64], y: &[f64], scalars: &[f64]) -> Solution {
        Solution {
            components: y.len(),
            m: stages,
            mesh: mesh.to_vec(),
            nodes: y.repeat(mesh.len()),
            stages: y.repeat(mesh.len().saturating_sub(1) * stages),
            scalars: scalars.to_vec(),
        }
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

    /// basis₀ y₀ + Σ_j basis_j Y_j of interval i.
    pub(crate) fn combine(&self, i: usize, basis: &[f64], out: &mut [f64]) {
        /// Sums of N components are kept in registers.
        fn sized<const N: usize>(stages: &[f64], basis: &[f64], out: &mut [f64]) {
            let Some(out) = out.first_chunk_mut::<N>() else { return };
            let mut sum = *out;
            for (weight, y) in basis.iter().zip(stages.as_chunks::<N>().0) {
                for c in 0..N {
                    sum[c] += weight * y[c];
                }
            }
            *out = sum;
        }
        fn any(stages: &[f64], basis: &[f64], out: &mut [f64]) {
            for (weight, y) in basis.iter().zip(stages.chunks_exact(out.len().max(1))) {
                for (o, y) in out.iter_mut().zip(y) {
                    *o += weight * y;
                }
            }
        }
        let (n, m) = (self.components, self.m);
        for (o, y) in out.iter_mut().zip(self.node(i)) {
            *o = basis[0] * y;
        }
        type Sum = fn(&[f64], &[f64], &mut [f64]);
        const SIZED: [Sum; 10] = [
            any, sized::<1>, sized::<2>, sized::<3>, sized::<4>, sized::<5>, sized::<6>, sized::<7>, sized::<8>,
            sized::<9>,
        ];
        let sum = SIZED.get(n).copied().unwrap_or(any);
        sum(&self.stages[i * m * n..(i + 1) * m * n], &basis[1..], out);
    }

    /// The same function on another mesh of the same stage count, by the polynomials through both nodes and the stages of
    /// each interval. For a solution they are its collocation polynomials; for values that only approximate one, such as
    /// those carried over before, they treat left and right alike: a mirrored problem stays a mirrored problem.
    pub fn on_mesh(&self, gauss: &Gauss, mesh: &[f64]) -> Solution {
        let mut out = self.clone();
        self.transfer_into(gauss, mesh, &mut out);
        out
    }

    /// [`on_mesh`](Self::on_mesh) into storage that is reused.
    pub fn transfer_into(&self, gauss: &Gauss, mesh: &[f64], out: &mut Solution) {
        Transfer::new(gauss, &self.mesh, mesh).apply(self, out);
    }
}

/// How values on one mesh are carried over to another: see [`Solution::on_mesh`]. Made once for all solutions on a mesh.
///
/// # Examples
/// ```
/// use furrow_bvp::{Gauss, Solution, Transfer, mesh};
/// let gauss = Gauss::new(4);
/// let from = mesh::uniform(0.0, 3.0, 12);
/// let transfer = Transfer::new(&gauss, &from, &mesh::halved(&from));
/// let y = Solution::from_fn(&gauss, &from, 1, &[], |x, y| y[0] = x.sin());
/// let mut finer = y.clone();
/// transfer.apply(&y, &mut finer);
/// assert_eq!(finer, y.on_mesh(&gauss, &mesh::halved(&from)));
/// ```
#[derive(Clone, Debug)]
pub struct Transfer {
    mesh: Vec<f64>,
    /// For every node and stage of the new mesh, in order, the interval of the old one and the weights of its left node, its stages
    /// and its right node.
    places: Vec<(usize, [f64; MAX_STAGES + 2])>,
}

impl Transfer {
    /// From one mesh to another of the same range.
    pub fn new(gauss: &Gauss, from: &[f64], to: &[f64]) -> Transfer {
        let last = from.len() - 2;
        let mut interval = 0;
        let mut place = |x: f64| {
            while interval < last && x > from[interval + 1] {
                interval += 1;
            }
            let mut weights = [0.0; MAX_STAGES + 2];
            if x == from[interval + 1] {
                // A node of the old mesh keeps its superconvergent value.
                weights[gauss.m + 1] = 1.0;
            } else {
                let theta = (x - from[interval]) / (from[interval + 1] - from[interval]);
                gauss.basis_between_nodes(theta, &mut weights);
            }
            (interval, weights)
        };
        let mut places = Vec::with_capacity((to.len() - 1) * (gauss.m + 1) + 1);
        for (i, &x) in to.iter().enumerate() {
            places.push(place(x));
            if let Some(next) = to.get(i + 1) {
                places.extend(gauss.c.iter().map(|c| place(x + (next - x) * c)));
            }
        }
        Transfer { mesh: to.to_vec(), places }
    }

    /// Transfers values.
    pub fn apply(&self, from: &Solution, to: &mut Solution) {
        let (n, m) = (from.components, from.m);
        (to.components, to.m) = (n, m);
        to.mesh.clone_from(&self.mesh);
        to.scalars.clone_from(&from.scalars);
        to.nodes.resize(self.mesh.len() * n, 0.0);
        to.stages.resize((self.mesh.len() - 1) * m * n, 0.0);
        for (k, (interval, weights)) in self.places.iter().enumerate() {
            let (i, j) = (k / (m + 1), k % (m + 1));
            let out = match j.checked_sub(1) {
                None => &mut to.nodes[i * n..(i + 1) * n],
                Some(j) => &mut to.stages[(i * m + j) * n..(i * m + j + 1) * n],
            };
            if weights[m + 1] == 1.0 {
                out.copy_from_slice(from.node(interval + 1));
                continue;
            }
            from.combine(*interval, weights, out);
            for (o, right) in out.iter_mut().zip(from.node(interval + 1)) {
                *o += weights[m + 1] * right;
            }
        }
    }
}
