//! Static condensation: the stages of one interval expressed by its left node and the scalar unknowns.
//!
//! With E the quadrature components and N the others, linearising N.1 gives on every interval
//!
//! * δY_E,j = δy_E + Σ_k a_jk (h F_EN,k δY_N,k + h F_Ep,k δp − R_E,k),
//! * Σ_j [D_ij I − δ_ij h F_NN,i − h² a_ij F_NE,i F_EN,j] δY_N,j
//!   \[N.3 condensed\] = s_i δy_N + h F_NE,i δy_E + (h F_Np,i + h² F_NE,i Σ_k a_ik F_Ep,k) δp − R_N,i − h F_NE,i Σ_k a_ik R_E,k,
//!
//! with s_i = Σ_j D_ij and R the stage residual. Eliminating leaves δy₁ = G δy₀ + B δp + c. The matrix is inverted once; a new
//! residual R, and each column of the map from (δy₀, δp), which is the answer to a residual too, is a product with the inverse.
//!
//! Everything that a solve runs over is kept by columns padded to whole lanes, so that every product is a sum of scaled
//! vectors, without reductions.

use crate::dense::{self, Determinant, LANE, Lane, Lanes, PivotFailure, add_scaled};
use crate::dimensions::{Dimensions, MAX_UNKNOWNS};
use crate::direction::{Direction, Residual};
use crate::gauss::{Gauss, MAX_STAGES};

/// Most lanes of the stage unknowns of one interval.
const MAX_STAGE_LANES: usize = dense::MAX_LANES;

/// Lanes of stage values that are summed at a time: those of a cell in one batch.
const BATCH: usize = 8;

/// Entries of a quad: there are few quadrature components.
const QUAD: usize = 4;

/// Up to four quadrature components of one stage.
type Quad = [f64; QUAD];

/// Derivatives at the stages of all intervals, and the condensed intervals.
#[derive(Clone, Debug, Default)]
pub struct Condensed {
    /// Sizes of the problem.
    pub dims: Dimensions,
    /// Stages m.
    pub m: usize,
    /// Interval widths h.
    pub h: Vec<f64>,
    /// ∂f/∂y at the stages; (interval · m + stage) × n × n.
    pub fy: Vec<f64>,
    /// ∂f/∂p at the stages; × n × scalars.
    pub fp: Vec<f64>,
    /// ∂g/∂y at the stages; × integrals × n.
    pub gy: Vec<f64>,
    /// ∂g/∂p at the stages; × integrals × scalars.
    pub gp: Vec<f64>,
    /// Pivots of all intervals, for determinants; intervals × s.
    reciprocal: Vec<f64>,
    exchange: Vec<u8>,
    /// Residual of one column of the map, as scratch; m × n.
    column: Vec<f64>,
    /// h F_NE by columns; per interval and stage e × (n − e).
    onto: Vec<f64>,
    /// h F_EN by columns, of which each is padded to whole quads; per interval quads of e × stage unknowns.
    from: Vec<Quad>,
    /// Inverse stage matrices by columns; per interval s × lanes. Newton corrects their rounding.
    inverse: Lanes,
    /// δY by columns of (δy₀, δp); per interval columns × lanes of its stage values.
    map: Lanes,
    /// [G B] by columns; per interval columns × lanes of a node.
    transition: Lanes,
    /// Integrals over the interval by (δy₀, δp); per interval and integral its columns.
    integral: Vec<f64>,
    /// h b_j ∂g/∂y; per interval and integral lanes of its stage values.
    weights: Lanes,
}

impl Condensed {
    /// Empty storage for a problem and a stage count.
    pub fn new(dims: Dimensions, m: usize) -> Condensed {
        Condensed { dims, m, ..Condensed::default() }
    }

    /// Columns of the map: components and scalar unknowns.
    fn columns(&self) -> usize {
        self.dims.components + self.dims.scalars
    }

    /// Lanes of a node.
    fn node_lanes(&self) -> usize {
        dense::lanes_for(self.dims.components)
    }

    /// Number of intervals.
    pub fn intervals(&self) -> usize {
        self.h.len()
    }

    /// Sizes the storage for a mesh and zeroes the derivatives.
    pub fn reset(&mut self, mesh: &[f64]) {
        let (intervals, columns, node_lanes) = (mesh.len() - 1, self.columns(), self.node_lanes());
        let Dimensions { scalars: np, integrals: ni, .. } = self.dims;
        let Sizes { n, e, m, nn, s, lanes, values, .. } = self.sizes::<0, 0, 0, 0>();
        let points = intervals * m;
        self.h.clear();
        self.h.extend(mesh.windows(2).map(|w| w[1] - w[0]));
        for (v, size) in [
            (&mut self.fy, points * n * n),
            (&mut self.fp, points * n * np),
            (&mut self.gy, points * ni * n),
            (&mut self.gp, points * ni * np),
        ] {
            dense::zeroed(v, size);
        }
        self.inverse.resize(intervals * s * lanes);
        self.map.resize(intervals * columns * values);
        self.transition.resize(intervals * columns * node_lanes);
        self.weights.resize(intervals * ni * values);
        self.onto.resize(points * e * nn, 0.0);
        self.from.resize(intervals * e.div_ceil(QUAD) * s, [0.0; QUAD]);
        self.reciprocal.resize(intervals * s, 0.0);
        self.exchange.resize(intervals * s, 0);
        self.integral.resize(intervals * ni * columns, 0.0);
        self.column.resize(m * n, 0.0);
    }

    /// [G B] of interval i by columns, each a node's lanes.
    pub fn transition(&self, i: usize) -> &[Lane] {
        part(&self.transition, i, self.columns() * self.node_lanes())
    }

    /// Coefficients of (δy₀, δp) in the integrals over interval i; integrals × columns.
    pub fn integral(&self, i: usize) -> &[f64] {
        part(&self.integral, i, self.dims.integrals * self.columns())
    }

    /// Multiplies the determinants of all stage matrices into `det`.
    pub fn multiply_into(&self, det: &mut Determinant) {
        let s = self.sizes::<0, 0, 0, 0>().s;
        for i in 0..self.intervals() {
            det.multiply(part(&self.reciprocal, i, s), part(&self.exchange, i, s));
        }
    }

    /// Condenses every interval from the derivatives stored for it. Sizes (components, quadratures, those of them that are
    /// trailing, stages) are known at
    /// compile time unless 0, here and below.
    ///
    /// # Errors
    /// If a pivot of a stage matrix vanishes.
    #[inline(always)]
    pub fn condense<const N: usize, const E: usize, const T: usize, const M: usize>(
        &mut self,
        gauss: &Gauss,
    ) -> Result<(), PivotFailure> {
        for i in 0..self.intervals() {
            self.gather::<N, E, T, M>(gauss, i);
            self.fill_stage_matrix::<N, E, T, M>(gauss, i);
            self.invert::<N, E, T, M>(i)?;
            self.map_columns::<N, E, T, M>(gauss, i);
        }
        Ok(())
    }

    /// The couplings h F_NE and h F_EN and the weights of the integrals of interval i.
    #[inline(always)]
    fn gather<const N: usize, const E: usize, const T: usize, const M: usize>(&mut self, gauss: &Gauss, i: usize) {
        let sizes = self.sizes::<N, E, T, M>();
        let Sizes { n, e, m, nn, s, values, first, .. } = sizes;
        let (h, ni) = (self.h[i], self.dims.integrals);
        let fy = part(&self.fy, i, m * n * n);
        let onto = part_mut(&mut self.onto, i, m * e * nn);
        let from = part_mut(&mut self.from, i, e.div_ceil(QUAD) * s);
        for stage in 0..m {
            let f = &fy[stage * n * n..(stage + 1) * n * n];
            for k in 0..e {
                let component = sizes.quadrature(k);
                for beta in 0..nn {
                    onto[(stage * e + k) * nn + beta] = h * f[(first + beta) * n + component];
                    from[k / QUAD * s + stage * nn + beta][k % QUAD] = h * f[component * n + first + beta];
                }
            }
        }
        let weights = part_mut(&mut self.weights, i, ni * values).as_flattened_mut();
        for stage in 0..m {
            let weight = h * gauss.b[stage];
            for k in 0..ni {
                let gy = &self.gy[((i * m + stage) * ni + k) * n..((i * m + stage) * ni + k + 1) * n];
                let to = &mut weights[k * values * LANE + stage * n..][..n];
                for (w, g) in to.iter_mut().zip(gy) {
                    *w = weight * g;
                }
            }
        }
    }

    /// The transpose of the stage matrix of interval i, in the place of its inverse: row (j, β) has the coefficients of
    /// δY_N,j,β in all equations.
    #[inline(always)]
    fn fill_stage_matrix<const N: usize, const E: usize, const T: usize, const M: usize>(
        &mut self,
        gauss: &Gauss,
        i: usize,
    ) {
        let Sizes { n, e, m, nn, s, lanes, first, .. } = self.sizes::<N, E, T, M>();
        let h = self.h[i];
        let fy = part(&self.fy, i, m * n * n);
        let (onto, from) = (part(&self.onto, i, m * e * nn), part(&self.from, i, e.div_ceil(QUAD) * s));
        let matrix = part_mut(&mut self.inverse, i, s * lanes);
        matrix.fill([0.0; LANE]);
        for j in 0..m {
            let rows = &mut matrix[j * nn * lanes..(j + 1) * nn * lanes];
            for k in 0..e {
                // What the slope of component k at stage j does to all equations, through its values at all stages.
                let mut reach = [[0.0; LANE]; MAX_STAGE_LANES];
                for stage in 0..m {
                    let onto = &onto[(stage * e + k) * nn..(stage * e + k + 1) * nn];
                    for alpha in 0..nn {
                        reach.as_flattened_mut()[stage * nn + alpha] = gauss.a[stage * m + j] * onto[alpha];
                    }
                }
                for beta in 0..nn {
                    let factor = -from[k / QUAD * s + j * nn + beta][k % QUAD];
                    for v in 0..lanes {
                        add_scaled(&mut rows[beta * lanes + v], factor, &reach[v]);
                    }
                }
            }
            let f = &fy[j * n * n..(j + 1) * n * n];
            for beta in 0..nn {
                let row = rows[beta * lanes..(beta + 1) * lanes].as_flattened_mut();
                for stage in 0..m {
                    row[stage * nn + beta] += gauss.d_matrix[stage * m + j];
                }
                for alpha in 0..nn {
                    row[j * nn + alpha] -= h * f[(first + alpha) * n + first + beta];
                }
            }
        }
    }

    /// Inverts the stage matrix of interval i in its place. It stands there by columns, as rows, and so does its inverse.
    #[inline(always)]
    fn invert<const N: usize, const E: usize, const T: usize, const M: usize>(
        &mut self,
        i: usize,
    ) -> Result<(), PivotFailure> {
        let Sizes { s, lanes, .. } = self.sizes::<N, E, T, M>();
        let matrix = part_mut(&mut self.inverse, i, s * lanes);
        let (reciprocal, exchange) = (part_mut(&mut self.reciprocal, i, s), part_mut(&mut self.exchange, i, s));
        dense::eliminate_square_in_place(matrix, lanes, reciprocal, exchange)?;
        for k in (0..s).rev() {
            let other = exchange[k] as usize;
            if other != k {
                for row in matrix.chunks_exact_mut(lanes) {
                    row.as_flattened_mut().swap(k, other);
                }
            }
        }
        Ok(())
    }

    /// The map (δy₀, δp) → δY of interval i, its transition and its integrals: each column answers the residual that a unit of
    /// δy₀ or δp makes.
    #[inline(always)]
    fn map_columns<const N: usize, const E: usize, const T: usize, const M: usize>(&mut self, gauss: &Gauss, i: usize) {
        let sizes = self.sizes::<N, E, T, M>();
        let Sizes { n, m, values, .. } = sizes;
        let (columns, node_lanes) = (self.columns(), self.node_lanes());
        let Dimensions { scalars: np, integrals: ni, .. } = self.dims;
        let h = self.h[i];
        let rest = 1.0 - gauss.d[..m].iter().sum::<f64>();
        let mut residual = std::mem::take(&mut self.column);
        let (mut map, mut transitions) = (std::mem::take(&mut self.map), std::mem::take(&mut self.transition));
        let mut integrals = std::mem::take(&mut self.integral);
        let stages = self.stages(sizes, gauss, i);
        let weights = part(&self.weights, i, ni * values);
        let (fp, gp) = (part(&self.fp, i, m * n * np), part(&self.gp, i, m * ni * np));
        let integral = part_mut(&mut integrals, i, ni * columns);
        let r = &mut residual[..m * n];
        let map_here = part_mut(&mut map, i, columns * values);
        for (c, column) in map_here.chunks_exact_mut(values).enumerate() {
            r.fill(0.0);
            for stage in 0..m {
                if c < n {
                    r[stage * n + c] = -gauss.d_matrix[stage * m..(stage + 1) * m].iter().sum::<f64>();
                } else {
                    for k in 0..n {
                        r[stage * n + k] = -h * fp[(stage * n + k) * np + c - n];
                    }
                }
            }
            stages.particular(r, &mut column.as_flattened_mut()[..m * n]);
        }
        // In a loop of its own: what was just written in parts is waited for if it is read as a whole.
        let of_nodes = part_mut(&mut transitions, i, columns * node_lanes).chunks_exact_mut(node_lanes);
        for (c, (column, transition)) in map_here.chunks_exact(values).zip(of_nodes).enumerate() {
            let y = &column.as_flattened()[..m * n];
            let transition = &mut transition.as_flattened_mut()[..n];
            transition.fill(0.0);
            if c < n {
                transition[c] = rest;
            }
            add_stages(&gauss.d[..m], y, transition);
            for k in 0..ni {
                let mut value = dense::dot(&part(weights, k, values).as_flattened()[..m * n], y);
                if c >= n {
                    for stage in 0..m {
                        value += h * gauss.b[stage] * gp[(stage * ni + k) * np + c - n];
                    }
                }
                integral[k * columns + c] = value;
            }
        }
        (self.transition, self.integral) = (transitions, integrals);
        (self.column, self.map) = (residual, map);
    }

    /// What the stages of interval i are solved with.
    #[inline(always)]
    fn stages<'a>(&'a self, sizes: Sizes, gauss: &'a Gauss, i: usize) -> Stages<'a> {
        let Sizes { e, m, nn, s, lanes, .. } = sizes;
        Stages {
            sizes,
            a: &gauss.a[..m * m],
            onto: part(&self.onto, i, m * e * nn),
            from: part(&self.from, i, e.div_ceil(QUAD) * s),
            inverse: part(&self.inverse, i, s * lanes),
        }
    }

    /// Particular stage values (into `out.stages`) and node constants (into the nodes) of all intervals for a residual; what they
    /// add to the integrals is taken from `borders`, of which there are as many as integrals or none.
    #[inline(always)]
    pub fn particular<const N: usize, const E: usize, const T: usize, const M: usize>(
        &self,
        gauss: &Gauss,
        residual: &Residual,
        out: &mut Direction,
        borders: &mut [f64],
    ) {
        let sizes = self.sizes::<N, E, T, M>();
        let Sizes { n, m, values, .. } = sizes;
        let ni = self.dims.integrals;
        for i in 0..self.intervals() {
            let y = part_mut(&mut out.stages, i, m * n);
            self.stages(sizes, gauss, i).particular(part(&residual.stages, i, m * n), y);
        }
        for i in 0..self.intervals() {
            let y = part(&out.stages, i, m * n);
            let node = part_mut(&mut out.nodes, i, n);
            node.copy_from_slice(part(&residual.nodes, i, n));
            add_stages(&gauss.d[..m], y, node);
            for (k, border) in borders.iter_mut().enumerate() {
                *border -= dense::dot(&part(&self.weights, i * ni + k, values).as_flattened()[..m * n], y);
            }
        }
    }

    /// Adds the maps of all intervals, applied to the nodes and scalars of `out`, to its stage values.
    #[inline(always)]
    pub fn complete<const N: usize, const E: usize, const T: usize, const M: usize>(&self, out: &mut Direction) {
        let Sizes { n, m, values, .. } = self.sizes::<N, E, T, M>();
        let columns = self.columns();
        let mut x = [0.0; MAX_UNKNOWNS];
        x[n..columns].copy_from_slice(&out.scalars);
        for i in 0..self.intervals() {
            let map = part(&self.map, i, columns * values);
            x[..n].copy_from_slice(part(&out.nodes, i, n));
            let stages = part_mut(&mut out.stages, i, m * n);
            for (part, y) in stages.chunks_mut(BATCH * LANE).enumerate() {
                let mut sums = [[0.0; LANE]; BATCH];
                let lanes = dense::lanes_for(y.len());
                dense::add_columns(&mut sums[..lanes], x[..columns].iter().copied(), &map[part * BATCH..], values);
                for (y, sum) in y.iter_mut().zip(sums.as_flattened()) {
                    *y += sum;
                }
            }
        }
    }

    /// Sizes that are known at compile time where the generic parameters are not 0.
    #[inline(always)]
    fn sizes<const N: usize, const E: usize, const T: usize, const M: usize>(&self) -> Sizes {
        let (n, e, m) = if N > 0 { (N, E, M) } else { (self.dims.components, self.dims.all_quadratures(), self.m) };
        let s = m * (n - e);
        let first = if N > 0 { E - T } else { self.dims.quadratures };
        Sizes { n, e, m, nn: n - e, first, s, lanes: dense::lanes_for(s), values: dense::lanes_for(m * n) }
    }
}

/// What the stages of one interval are solved with.
#[derive(Clone, Copy)]
struct Stages<'a> {
    sizes: Sizes,
    /// Runge–Kutta matrix; m × m.
    a: &'a [f64],
    /// See [`Condensed::onto`].
    onto: &'a [f64],
    /// See [`Condensed::from`].
    from: &'a [Quad],
    /// See [`Condensed::inverse`].
    inverse: &'a [Lane],
}

impl Stages<'_> {
    /// Stage values for stage residuals `r` (m × n), with δy₀ = δp = 0, into `y` (m × n).
    #[inline(always)]
    fn particular(&self, r: &[f64], y: &mut [f64]) {
        let Stages { sizes, a, onto, from, inverse } = *self;
        let Sizes { n, e, m, nn, s, lanes, first: others, .. } = sizes;
        let (r, y) = (&r[..m * n], &mut y[..m * n]);
        let mut x = [[0.0; LANE]; MAX_STAGE_LANES];
        for stage in 0..m {
            for alpha in 0..nn {
                x.as_flattened_mut()[stage * nn + alpha] = -r[stage * n + others + alpha];
            }
        }
        for first in (0..e).step_by(QUAD) {
            let width = (e - first).min(QUAD);
            let mut slopes = [[0.0; QUAD]; MAX_STAGES];
            for j in 0..m {
                for t in 0..width {
                    slopes[j][t] = -r[j * n + sizes.quadrature(first + t)];
                }
            }
            let values = integrated(a, m, &slopes);
            for stage in 0..m {
                for t in 0..width {
                    let (value, k) = (values[stage][t], first + t);
                    y[stage * n + sizes.quadrature(k)] = value;
                    for alpha in 0..nn {
                        x.as_flattened_mut()[stage * nn + alpha] += onto[(stage * e + k) * nn + alpha] * value;
                    }
                }
            }
        }
        let mut solved = [[0.0; LANE]; MAX_STAGE_LANES];
        dense::add_columns(&mut solved[..lanes], x.as_flattened()[..s].iter().copied(), inverse, lanes);
        let x = solved.as_flattened();
        for first in (0..e).step_by(QUAD) {
            let from = part(from, first / QUAD, s);
            let mut slopes = [[0.0; QUAD]; MAX_STAGES];
            for j in 0..m {
                for beta in 0..nn {
                    for t in 0..QUAD {
                        slopes[j][t] += x[j * nn + beta] * from[j * nn + beta][t];
                    }
                }
            }
            let values = integrated(a, m, &slopes);
            for stage in 0..m {
                for t in 0..(e - first).min(QUAD) {
                    y[stage * n + sizes.quadrature(first + t)] += values[stage][t];
                }
            }
        }
        for stage in 0..m {
            for alpha in 0..nn {
                y[stage * n + others + alpha] = x[stage * nn + alpha];
            }
        }
    }
}

/// Sizes that kernels work with.
#[derive(Clone, Copy)]
struct Sizes {
    /// Components.
    n: usize,
    /// Quadrature components.
    e: usize,
    /// Stages.
    m: usize,
    /// Components that are not quadratures, one behind the other.
    nn: usize,
    /// The first of them.
    first: usize,
    /// Stage unknowns.
    s: usize,
    /// Lanes of the stage unknowns.
    lanes: usize,
    /// Lanes of all stage values.
    values: usize,
}

impl Sizes {
    /// Which component the quadrature k is: some stand before the others, some behind.
    #[inline(always)]
    fn quadrature(self, k: usize) -> usize {
        if k < self.first { k } else { self.nn + k }
    }
}

#[inline(always)]
fn part<T>(of: &[T], i: usize, size: usize) -> &[T] {
    &of[i * size..(i + 1) * size]
}

#[inline(always)]
fn part_mut<T>(of: &mut [T], i: usize, size: usize) -> &mut [T] {
    &mut of[i * size..(i + 1) * size]
}

/// Σ_j a_ij q_j at every stage i, of slopes q.
#[inline(always)]
fn integrated(a: &[f64], m: usize, slopes: &[Quad; MAX_STAGES]) -> [Quad; MAX_STAGES] {
    let mut values = [[0.0; QUAD]; MAX_STAGES];
    for i in 0..m {
        for j in 0..m {
            for t in 0..QUAD {
                values[i][t] += a[i * m + j] * slopes[j][t];
            }
        }
    }
    values
}

/// Adds Σ_j d_j Y_j to the values of a node.
#[inline(always)]
fn add_stages(d: &[f64], y: &[f64], node: &mut [f64]) {
    let n = node.len();
    for (j, weight) in d.iter().enumerate() {
        for (value, y) in node.iter_mut().zip(&y[j * n..(j + 1) * n]) {
            *value += weight * y;
        }
    }
}
