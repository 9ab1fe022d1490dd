//! A collocation solution: mesh, node values, stage values, scalar unknowns.

use multiversion::multiversion;

use crate::dense::add_multiple;
use crate::dimensions::{Dimensions, TooLarge};
use crate::gauss::{Gauss, MAX_STAGES};
use crate::invalid::{self, InvalidInput, length};

/// A piecewise polynomial of degree m on a mesh, with the scalar unknowns that belong to it.
///
/// On interval i the polynomial takes the values `node(i)` at the left node and `stage(i, j)` at the Gauss points.
///
/// # Examples
/// ```
/// use furrow_bvp::{Gauss, Solution, mesh};
/// let gauss = Gauss::new(4)?;
/// let sine = |x: f64, y: &mut [f64]| y.copy_from_slice(&[x.sin(), x.cos()]);
/// let y = Solution::from_fn(&gauss, &mesh::uniform(0.0, 3.0, 12), 2, &[], sine)?;
/// let finer = y.on_mesh(&gauss, &mesh::halved(&y.mesh));
/// let mut value = [0.0; 2];
/// finer.eval(&gauss, 1.0, &mut value);
/// assert!((value[0] - 1f64.sin()).abs() < 1e-5);
/// # Ok::<(), furrow_bvp::InvalidInput>(())
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
    ///
    /// # Errors
    /// [`InvalidInput`] if there are no components, or if the mesh is invalid (see [`mesh::check`](crate::mesh::check)).
    pub fn from_fn(
        gauss: &Gauss,
        mesh: &[f64],
        components: usize,
        scalars: &[f64],
        value: impl FnMut(f64, &mut [f64]),
    ) -> Result<Solution, InvalidInput> {
        invalid::mesh(mesh)?;
        if components == 0 {
            return Err(TooLarge::Components { components, quadratures: 0 }.into());
        }
        Ok(Solution::sampled(gauss, mesh, components, scalars, value))
    }

    /// [`from_fn`](Self::from_fn) on a mesh that is known to be one.
    fn sampled(
        gauss: &Gauss,
        mesh: &[f64],
        components: usize,
        scalars: &[f64],
        mut value: impl FnMut(f64, &mut [f64]),
    ) -> Solution {
        let n_intervals = mesh.len().saturating_sub(1);
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

    /// Another solution of the same kind on the same mesh: samples `value` at the nodes and stages of this one.
    pub fn resampled(&self, components: usize, scalars: &[f64], value: impl FnMut(f64, &mut [f64])) -> Solution {
        Solution::sampled(&self.gauss(), &self.mesh, components, scalars, value)
    }

    /// The collocation that the stages belong to. (Of an `m` that is not offered, which [`check`](Self::check) refuses, the
    /// nearest.)
    pub fn gauss(&self) -> Gauss {
        Gauss::nearest(self.m)
    }

    /// Checks the public fields: the number of stages, the mesh, and the numbers of node and stage values. Solvers check every
    /// solution they are given.
    ///
    /// # Errors
    /// [`InvalidInput`] names the field.
    pub fn check(&self) -> Result<(), InvalidInput> {
        let Solution { components: n, m, mesh, nodes, stages, .. } = self;
        if !(1..=MAX_STAGES).contains(m) {
            return Err(TooLarge::Stages { stages: *m }.into());
        }
        if *n == 0 {
            return Err(TooLarge::Components { components: 0, quadratures: 0 }.into());
        }
        invalid::mesh(mesh)?;
        length("node values of the solution", nodes.len(), mesh.len().saturating_mul(*n))?;
        length("stage values of the solution", stages.len(), self.intervals().saturating_mul(n.saturating_mul(*m)))
    }

    /// [`check`](Self::check), and the sizes of a problem.
    pub(crate) fn fits(&self, dims: Dimensions) -> Result<(), InvalidInput> {
        dims.check(self.m)?;
        length("components of the solution", self.components, dims.components)?;
        length("scalars of the solution", self.scalars.len(), dims.scalars)?;
        self.check()
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
        self.mesh.len().saturating_sub(1)
    }

    /// Values at node i.
    ///
    /// # Panics
    /// If there is no such interval or node, as for a slice.
    pub fn node(&self, i: usize) -> &[f64] {
        &self.nodes[i * self.components..(i + 1) * self.components]
    }

    /// Values at stage j of interval i.
    ///
    /// # Panics
    /// If there is no such interval or node, as for a slice.
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
        after.saturating_sub(1).min(self.intervals().saturating_sub(1))
    }

    /// The collocation polynomial at x, all components into `out`.
    pub fn eval(&self, gauss: &Gauss, x: f64, out: &mut [f64]) {
        let i = self.interval_of(x);
        let Some([left, right]) = self.mesh.get(i..i + 2) else { return out.fill(f64::NAN) };
        self.eval_in(gauss, i, (x - left) / (right - left), out);
    }

    /// The polynomial of interval i at θ ∈ [0, 1].
    pub fn eval_in(&self, gauss: &Gauss, i: usize, theta: f64, out: &mut [f64]) {
        let mut basis = [0.0; MAX_STAGES + 1];
        gauss.basis(theta, &mut basis);
        self.interpolate(i, &basis, out);
    }

    /// One component of the polynomial of interval i at θ ∈ [0, 1]; NaN if there is no such interval or component.
    pub fn component_in(&self, gauss: &Gauss, i: usize, theta: f64, component: usize) -> f64 {
        let mut basis = [0.0; MAX_STAGES + 1];
        gauss.basis(theta, &mut basis);
        let at = |values: &[f64]| values.get(component).copied().unwrap_or(f64::NAN);
        let stages = rows(&self.stages, i, self.m * self.components).chunks_exact(self.components.max(1));
        stages
            .zip(&basis[1..])
            .fold(basis[0] * at(rows(&self.nodes, i, self.components)), |sum, (y, weight)| sum + weight * at(y))
    }

    /// Derivative with respect to x of the polynomial of interval i at θ ∈ [0, 1].
    pub fn slope_in(&self, gauss: &Gauss, i: usize, theta: f64, out: &mut [f64]) {
        let mut basis = [0.0; MAX_STAGES + 1];
        gauss.basis_derivative(theta, &mut basis);
        let Some([left, right]) = self.mesh.get(i..i + 2) else { return out.fill(f64::NAN) };
        let h = right - left;
        basis.iter_mut().for_each(|b| *b /= h);
        self.interpolate(i, &basis, out);
    }

    /// Multiplies all values by a factor, then adds multiples of solutions on the same mesh.
    pub fn combine<'a>(&mut self, factor: f64, terms: impl Iterator<Item = (&'a Solution, f64)>) {
        let Solution { nodes, stages, scalars, .. } = self;
        for values in [&mut *nodes, &mut *stages, &mut *scalars] {
            values.iter_mut().for_each(|v| *v *= factor);
        }
        for (y, weight) in terms {
            for (to, from) in [(&mut *nodes, &y.nodes), (&mut *stages, &y.stages), (&mut *scalars, &y.scalars)] {
                add_multiple(to, weight, from);
            }
        }
    }

    /// basis₀ y₀ + Σ_j basis_j Y_j of interval i.
    pub(crate) fn interpolate(&self, i: usize, basis: &[f64], out: &mut [f64]) {
        self.weigh_values(self.components, i, basis, &[], out);
    }

    /// basis₀ y₀ + Σ_j basis_j Y_j + basis_{m+1} y₁ of interval i and all n components, without the last term if `right` (y₁) is empty.
    /// Inlined where n is known, it has no branches.
    #[inline(always)]
    fn weigh_values(&self, n: usize, i: usize, basis: &[f64], right: &[f64], out: &mut [f64]) {
        let (node, stages) = (rows(&self.nodes, i, n), rows(&self.stages, i, self.m * n));
        match n {
            1 => sized::<1>(node, stages, right, basis, out),
            2 => sized::<2>(node, stages, right, basis, out),
            3 => sized::<3>(node, stages, right, basis, out),
            4 => sized::<4>(node, stages, right, basis, out),
            6 => sized::<6>(node, stages, right, basis, out),
            7 => sized::<7>(node, stages, right, basis, out),
            9 => sized::<9>(node, stages, right, basis, out),
            _ => {
                out.iter_mut().zip(node).for_each(|(o, y)| *o = basis[0] * y);
                for (weight, y) in basis[1..].iter().zip(stages.chunks_exact(n.max(1)).chain([right])) {
                    out.iter_mut().zip(y).for_each(|(o, y)| *o += weight * y);
                }
            }
        }
    }

    /// The same function on another mesh of the same stage count, by the polynomials through both nodes and the stages of
    /// each interval. For a solution they are its collocation polynomials; for values that only approximate one, such as
    /// those carried over before, they treat left and right alike: a mirrored problem stays a mirrored problem.
    ///
    /// The mesh is checked when a problem is solved on it; an invalid mesh gives no error here.
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
/// let gauss = Gauss::new(4)?;
/// let from = mesh::uniform(0.0, 3.0, 12);
/// let transfer = Transfer::new(&gauss, &from, &mesh::halved(&from));
/// let y = Solution::from_fn(&gauss, &from, 1, &[], |x, y| y[0] = x.sin())?;
/// let mut finer = y.clone();
/// transfer.apply(&y, &mut finer);
/// assert_eq!(finer, y.on_mesh(&gauss, &mesh::halved(&from)));
/// # Ok::<(), furrow_bvp::InvalidInput>(())
/// ```
#[derive(Clone, Debug)]
pub struct Transfer {
    /// Stages and intervals of the solutions that it is for.
    m: usize,
    intervals: usize,
    mesh: Vec<f64>,
    /// For every node and stage of the new mesh, in order, the interval of the old one and the weights of its left node, its stages
    /// and its right node.
    places: Vec<(usize, [f64; MAX_STAGES + 2])>,
}

impl Transfer {
    /// From one mesh to another of the same range.
    pub fn new(gauss: &Gauss, from: &[f64], to: &[f64]) -> Transfer {
        let intervals = from.len().saturating_sub(1);
        let Some(last) = intervals.checked_sub(1) else {
            return Transfer { m: gauss.m, intervals, mesh: to.to_vec(), places: Vec::new() };
        };
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
        let mut places = Vec::with_capacity(to.len() * (gauss.m + 1));
        for (i, &x) in to.iter().enumerate() {
            places.push(place(x));
            if let Some(next) = to.get(i + 1) {
                places.extend(gauss.c.iter().map(|c| place(x + (next - x) * c)));
            }
        }
        Transfer { m: gauss.m, intervals, mesh: to.to_vec(), places }
    }

    /// Transfers values. For a solution on another mesh, or with other stages, the weights are made anew.
    pub fn apply(&self, from: &Solution, to: &mut Solution) {
        if (from.m, from.intervals()) == (self.m, self.intervals) {
            self.weigh(from, to);
        } else {
            let gauss = from.gauss();
            Transfer { m: from.m, ..Transfer::new(&gauss, &from.mesh, &self.mesh) }.weigh(from, to);
        }
    }

    fn weigh(&self, from: &Solution, to: &mut Solution) {
        let (n, m) = (from.components, from.m);
        (to.components, to.m) = (n, m);
        to.mesh.clone_from(&self.mesh);
        to.scalars.clone_from(&from.scalars);
        to.nodes.resize(to.mesh.len() * n, 0.0);
        to.stages.resize(to.intervals() * m * n, 0.0);
        let Solution { nodes, stages, .. } = to;
        transfer_values(self, from, nodes, stages);
    }
}

/// The part of values that belongs to interval or node i; empty beyond the end.
#[inline(always)]
fn rows(values: &[f64], i: usize, size: usize) -> &[f64] {
    values.get(i * size..(i + 1) * size).unwrap_or(&[])
}

/// [`Solution::weigh_values`] for N components, with sums in registers.
#[inline(always)]
fn sized<const N: usize>(node: &[f64], stages: &[f64], right: &[f64], basis: &[f64], out: &mut [f64]) {
    let (Some(node), Some(out)) = (node.first_chunk::<N>(), out.first_chunk_mut::<N>()) else { return };
    let mut sum = [0.0; N];
    for c in 0..N {
        sum[c] = basis[0] * node[c];
    }
    let stages = stages.as_chunks::<N>().0;
    if let ([y1, y2, y3, y4], [_, b1, b2, b3, b4, ..]) = (stages, basis) {
        // The usual four stages are unrolled.
        for (weight, y) in [(b1, y1), (b2, y2), (b3, y3), (b4, y4)] {
            for c in 0..N {
                sum[c] += weight * y[c];
            }
        }
    } else {
        for (weight, y) in basis[1..].iter().zip(stages) {
            for c in 0..N {
                sum[c] += weight * y[c];
            }
        }
    }
    if let (Some(right), Some(weight)) = (right.first_chunk::<N>(), basis.get(stages.len() + 1)) {
        for c in 0..N {
            sum[c] += weight * right[c];
        }
    }
    *out = sum;
}

/// The nodes and stages of a solution on another mesh.
#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
fn transfer_values(transfer: &Transfer, from: &Solution, nodes: &mut [f64], stages: &mut [f64]) {
    // Numbers of components that are worth a loop of their own.
    match from.components {
        7 => transfer_components(7, transfer, from, nodes, stages),
        9 => transfer_components(9, transfer, from, nodes, stages),
        n => transfer_components(n, transfer, from, nodes, stages),
    }
}

#[inline(always)]
fn transfer_components(n: usize, transfer: &Transfer, from: &Solution, nodes: &mut [f64], stages: &mut [f64]) {
    let m = from.m;
    for (i, places) in transfer.places.chunks(m + 1).enumerate() {
        for (j, (interval, weights)) in places.iter().enumerate() {
            let (to, k) = if j == 0 { (&mut *nodes, i) } else { (&mut *stages, i * m + j - 1) };
            let (Some(out), Some(&weight)) = (to.get_mut(k * n..(k + 1) * n), weights.get(m + 1)) else { continue };
            let right = rows(&from.nodes, interval + 1, n);
            if weight == 1.0 {
                out.iter_mut().zip(right).for_each(|(o, right)| *o = *right);
                continue;
            }
            from.weigh_values(n, *interval, weights, right, out);
        }
    }
}
