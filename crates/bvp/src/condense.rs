//! Static condensation: the stages of one interval expressed by its left node and the scalar unknowns.
//!
//! With E the integrable components and N the others, linearising N.1 gives on every interval
//!
//! * δY_E,j = δy_E + Σ_k a_jk (h F_EN,k δY_N,k + h F_Ep,k δp − R_E,k),
//! * Σ_j [D_ij I − δ_ij h F_NN,i − h² a_ij F_NE,i F_EN,j] δY_N,j
//!   \[N.3 condensed\] = s_i δy_N + h F_NE,i δy_E + (h F_Np,i + h² F_NE,i Σ_k a_ik F_Ep,k) δp − R_N,i − h F_NE,i Σ_k a_ik R_E,k,
//!
//! with s_i = Σ_j D_ij and R the stage residual. Eliminating leaves δy₁ = G δy₀ + B δp + c. The matrix is factorised once;
//! new residuals R only need triangular solves.

use multiversion::multiversion;

use crate::dense::{self, Determinant, Factors, LANE, Lane, Lanes, PivotFailure};
use crate::gauss::Gauss;
use crate::problem::{Dimensions, MAX_UNKNOWN_LANES, PointJacobian};

/// Lanes that hold the stage unknowns of one interval: the widest block holds a matrix and its inverse.
const MAX_STAGE_LANES: usize = dense::MAX_LANES / 2;

/// Shapes of the condensed storage, fixed per problem and stage count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Sizes of the problem.
    pub dims: Dimensions,
    /// Stages m.
    pub m: usize,
    /// Stage unknowns left after integrating: m times the components that are not integrable.
    pub s: usize,
    /// Lane at which the right-hand sides start.
    pub rhs_lane: usize,
    /// Lanes of one row of the stage matrix: itself, its right-hand sides, and columns that become its inverse.
    pub lanes: usize,
    /// Lanes of one row of the condensed map: n + scalars columns.
    pub map_lanes: usize,
}

impl Layout {
    /// Layout for a problem and a stage count.
    pub fn new(dims: Dimensions, m: usize) -> Layout {
        let s = m * (dims.components - dims.integrable);
        let rhs_lane = dense::lanes_for(s);
        let map_lanes = dense::lanes_for(dims.components + dims.scalars);
        Layout { dims, m, s, rhs_lane, lanes: 2 * rhs_lane + map_lanes, map_lanes }
    }
}

/// Derivatives at the stages of all intervals, and the factorised stage matrices.
#[derive(Clone, Debug)]
pub struct Condensed {
    /// Shapes.
    pub layout: Layout,
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
    /// Stage matrix of one interval beside its right-hand sides: s × lanes of scratch.
    matrix: Lanes,
    /// Factors of that interval.
    lower: Lanes,
    upper: Lanes,
    /// Pivots of all intervals, for determinants.
    reciprocal: Vec<f64>,
    exchange: Vec<u8>,
    /// Derivatives of the integrable components by the scalars, gathered for one stage: e × scalars of scratch.
    spread: Vec<f64>,
    /// Inverse stage matrices by columns; per interval s × lanes_for(s). Applying an inverse is a sum of scaled columns,
    /// without the serial dependence of triangular solves; Newton corrects its rounding.
    inverse: Lanes,
    /// δY as a linear map of (δy₀, δp); per interval (m · n) × map_lanes.
    map: Lanes,
    /// [G B] per interval; n × map_lanes.
    transition: Lanes,
    /// Linear form of the integrals per interval: integrals × map_lanes.
    integral: Lanes,
}

#[inline(always)]
fn add_scaled(target: &mut [Lane], factor: f64, source: &[Lane]) {
    for (x, y) in target.iter_mut().zip(source) {
        for t in 0..LANE {
            x[t] += factor * y[t];
        }
    }
}

impl Condensed {
    /// Empty storage.
    pub fn new(dims: Dimensions, m: usize) -> Condensed {
        Condensed {
            layout: Layout::new(dims, m),
            h: Vec::new(),
            fy: Vec::new(),
            fp: Vec::new(),
            gy: Vec::new(),
            gp: Vec::new(),
            matrix: Lanes::default(),
            lower: Lanes::default(),
            upper: Lanes::default(),
            reciprocal: Vec::new(),
            exchange: Vec::new(),
            spread: Vec::new(),
            inverse: Lanes::default(),
            map: Lanes::default(),
            transition: Lanes::default(),
            integral: Lanes::default(),
        }
    }

    /// Number of intervals.
    pub fn intervals(&self) -> usize {
        self.h.len()
    }

    /// Sizes the storage for a mesh and zeroes the derivatives.
    pub fn reset(&mut self, mesh: &[f64]) {
        let l = self.layout;
        let intervals = mesh.len() - 1;
        let (n, points) = (l.dims.components, intervals * l.m);
        self.h.clear();
        self.h.extend(mesh.windows(2).map(|w| w[1] - w[0]));
        for (v, size) in [
            (&mut self.fy, points * n * n),
            (&mut self.fp, points * n * l.dims.scalars),
            (&mut self.gy, points * l.dims.integrals * n),
            (&mut self.gp, points * l.dims.integrals * l.dims.scalars),
        ] {
            v.clear();
            v.resize(size, 0.0);
        }
        self.matrix.resize(l.s * l.lanes);
        self.lower.resize(l.s * l.rhs_lane);
        self.upper.resize(l.s * l.rhs_lane);
        self.inverse.resize(intervals * l.s * l.rhs_lane);
        self.reciprocal.resize(intervals * l.s, 0.0);
        self.exchange.resize(intervals * l.s, 0);
        self.spread.resize(l.dims.integrable * l.dims.scalars, 0.0);
        self.map.resize(points * n * l.map_lanes);
        self.transition.resize(intervals * n * l.map_lanes);
        self.integral.resize(intervals * l.dims.integrals * l.map_lanes);
    }

    /// Where the derivatives at collocation point `index` go, with f and g.
    pub fn point_jacobian<'a>(&'a mut self, index: usize, f: &'a mut [f64], g: &'a mut [f64]) -> PointJacobian<'a> {
        let Dimensions { components: n, scalars: np, integrals: ni, .. } = self.layout.dims;
        PointJacobian {
            f,
            fy: &mut self.fy[index * n * n..(index + 1) * n * n],
            fp: &mut self.fp[index * n * np..(index + 1) * n * np],
            g,
            gy: &mut self.gy[index * ni * n..(index + 1) * ni * n],
            gp: &mut self.gp[index * ni * np..(index + 1) * ni * np],
        }
    }

    /// [G B] of interval i; n rows of `map_lanes` lanes.
    pub fn transition(&self, i: usize) -> &[Lane] {
        let size = self.layout.dims.components * self.layout.map_lanes;
        &self.transition[i * size..(i + 1) * size]
    }

    /// Coefficients of (δy₀, δp) in the integrals over interval i.
    pub fn integral(&self, i: usize) -> &[Lane] {
        let size = self.layout.dims.integrals * self.layout.map_lanes;
        &self.integral[i * size..(i + 1) * size]
    }

    /// Factorises interval i from the derivatives stored for it. Sizes (components, integrable ones, stages, lanes of the
    /// map) are known at compile time unless 0.
    ///
    /// # Errors
    /// If a pivot of the stage matrix vanishes.
    #[inline(always)]
    pub fn factor<const N: usize, const E: usize, const M: usize, const ML: usize>(
        &mut self,
        gauss: &Gauss,
        i: usize,
    ) -> Result<(), PivotFailure> {
        let l = self.layout;
        self.matrix.fill([0.0; LANE]);
        for stage in 0..self.sizes::<N, E, M>().2 {
            self.gather_spread::<N, E, M>(gauss, i, stage);
            self.fill_stage_rows::<N, E, M>(gauss, i, stage);
        }
        let stages = i * l.s..(i + 1) * l.s;
        let mut factors = Factors {
            lower: &mut self.lower,
            upper: &mut self.upper,
            reciprocal: &mut self.reciprocal[stages.clone()],
            exchange: &mut self.exchange[stages.clone()],
        };
        dense::eliminate(&mut self.matrix, l.lanes, l.s, l.s, &mut factors)?;
        dense::back_substitute(&mut self.matrix, l.lanes, l.s, &self.upper, &self.reciprocal[stages]);
        self.keep_inverse::<N, E, M>(i);
        self.map_stages::<N, E, M, ML>(i);
        self.map_integrable::<N, E, M, ML>(gauss, i);
        self.finish_transition::<N, E, M, ML>(gauss, i);
        self.map_integrals::<N, E, M, ML>(gauss, i);
        Ok(())
    }

    /// h² Σ_k a_ik F_Ep,k of one stage for every integrable component and scalar.
    #[inline(always)]
    fn gather_spread<const N: usize, const E: usize, const M: usize>(&mut self, gauss: &Gauss, i: usize, stage: usize) {
        let (n, e, m) = self.sizes::<N, E, M>();
        let (np, h) = (self.layout.dims.scalars, self.h[i]);
        let fp = &self.fp[i * m * n * np..(i + 1) * m * n * np];
        let spread = &mut self.spread[..];
        spread.fill(0.0);
        for k in 0..e {
            for j in 0..m {
                for q in 0..np {
                    spread[k * np + q] += h * h * gauss.a[stage * m + j] * fp[(j * n + k) * np + q];
                }
            }
        }
    }

    /// The rows of one stage: its part of the stage matrix, right-hand sides for δy₀ and δp, and the identity.
    #[inline(always)]
    fn fill_stage_rows<const N: usize, const E: usize, const M: usize>(
        &mut self,
        gauss: &Gauss,
        i: usize,
        stage: usize,
    ) {
        let l = self.layout;
        let (n, e, m) = self.sizes::<N, E, M>();
        let (nn, np) = (n - e, l.dims.scalars);
        let h = self.h[i];
        let fy = &self.fy[i * m * n * n..(i + 1) * m * n * n];
        let fp = &self.fp[i * m * n * np..(i + 1) * m * n * np];
        let (matrix, spread) = (&mut self.matrix[..], &self.spread[..]);
        let f = &fy[stage * n * n..(stage + 1) * n * n];
        let row_sum: f64 = gauss.d_matrix[stage * m..(stage + 1) * m].iter().sum();
        for alpha in 0..nn {
            let row_index = stage * nn + alpha;
            let row = matrix[row_index * l.lanes..(row_index + 1) * l.lanes].as_flattened_mut();
            let f_row = &f[(e + alpha) * n..(e + alpha + 1) * n];
            for j in 0..m {
                let block = &mut row[j * nn..(j + 1) * nn];
                let scale = h * h * gauss.a[stage * m + j];
                for k in 0..e {
                    let weight = -scale * f_row[k];
                    let f_en = &fy[j * n * n + k * n + e..j * n * n + (k + 1) * n];
                    for (x, v) in block.iter_mut().zip(f_en) {
                        *x += weight * v;
                    }
                }
                block[alpha] += gauss.d_matrix[stage * m + j];
            }
            for (x, v) in row[stage * nn..(stage + 1) * nn].iter_mut().zip(&f_row[e..]) {
                *x -= h * v;
            }
            row[(l.rhs_lane + l.map_lanes) * LANE + row_index] = 1.0;
            let rhs = &mut row[l.rhs_lane * LANE..];
            for k in 0..e {
                rhs[k] = h * f_row[k];
            }
            rhs[e + alpha] = row_sum;
            for q in 0..np {
                let mut value = h * fp[(stage * n + e + alpha) * np + q];
                for k in 0..e {
                    value += f_row[k] * spread[k * np + q];
                }
                rhs[n + q] = value;
            }
        }
    }

    /// Keeps the inverse of the stage matrix of interval i, by columns.
    #[inline(always)]
    fn keep_inverse<const N: usize, const E: usize, const M: usize>(&mut self, i: usize) {
        let l = self.layout;
        let (n, e, m) = self.sizes::<N, E, M>();
        let s = m * (n - e);
        let inverse = &mut self.inverse[i * l.s * l.rhs_lane..(i + 1) * l.s * l.rhs_lane];
        let from = (l.rhs_lane + l.map_lanes) * LANE;
        for k in 0..s {
            let row = &self.matrix[k * l.lanes..(k + 1) * l.lanes].as_flattened()[from..];
            for c in 0..s {
                inverse[c * l.rhs_lane + k / LANE][k % LANE] = row[c];
            }
        }
    }

    /// The map δY(δy₀, δp) of a factorised interval: solved for the other components, begun with δy₀ for the integrable.
    #[inline(always)]
    fn map_stages<const N: usize, const E: usize, const M: usize, const ML: usize>(&mut self, i: usize) {
        let l = self.layout;
        let (n, e, m) = self.sizes::<N, E, M>();
        let (nn, ml) = (n - e, self.map_lanes::<ML>());
        let map = &mut self.map[i * m * n * ml..(i + 1) * m * n * ml];
        for stage in 0..m {
            for beta in 0..nn {
                let from = (stage * nn + beta) * l.lanes + l.rhs_lane;
                let to = (stage * n + e + beta) * ml;
                map[to..to + ml].copy_from_slice(&self.matrix[from..from + ml]);
            }
            for k in 0..e {
                let row = &mut map[(stage * n + k) * ml..(stage * n + k + 1) * ml];
                row.fill([0.0; LANE]);
                row.as_flattened_mut()[k] = 1.0;
            }
        }
    }

    /// Spreads the slopes Q_k = h F_EN δY_N + h F_Ep δp of the integrable components over the stages and the right node.
    #[inline(always)]
    fn map_integrable<const N: usize, const E: usize, const M: usize, const ML: usize>(
        &mut self,
        gauss: &Gauss,
        i: usize,
    ) {
        let (n, e, m) = self.sizes::<N, E, M>();
        let (np, h, ml) = (self.layout.dims.scalars, self.h[i], self.map_lanes::<ML>());
        let map = &mut self.map[i * m * n * ml..(i + 1) * m * n * ml];
        let transition = &mut self.transition[i * n * ml..(i + 1) * n * ml];
        transition.fill([0.0; LANE]);
        let mut slope = [[0.0; LANE]; MAX_UNKNOWN_LANES];
        for stage in 0..m {
            let f = &self.fy[(i * m + stage) * n * n..(i * m + stage + 1) * n * n];
            let fp = &self.fp[(i * m + stage) * n * np..(i * m + stage + 1) * n * np];
            for k in 0..e {
                let slope = &mut slope[..ml];
                slope.fill([0.0; LANE]);
                for beta in 0..n - e {
                    let weight = h * f[k * n + e + beta];
                    if weight != 0.0 {
                        let from = (stage * n + e + beta) * ml;
                        add_scaled(slope, weight, &map[from..from + ml]);
                    }
                }
                for q in 0..np {
                    slope.as_flattened_mut()[n + q] += h * fp[k * np + q];
                }
                for j in 0..m {
                    let to = (j * n + k) * ml;
                    add_scaled(&mut map[to..to + ml], gauss.a[j * m + stage], slope);
                }
                add_scaled(&mut transition[k * ml..(k + 1) * ml], gauss.b[stage], slope);
            }
        }
    }

    /// The transition [G B], of which the slopes of the integrable components are there.
    #[inline(always)]
    fn finish_transition<const N: usize, const E: usize, const M: usize, const ML: usize>(
        &mut self,
        gauss: &Gauss,
        i: usize,
    ) {
        let (n, e, m) = self.sizes::<N, E, M>();
        let ml = self.map_lanes::<ML>();
        let map = &self.map[i * m * n * ml..(i + 1) * m * n * ml];
        let transition = &mut self.transition[i * n * ml..(i + 1) * n * ml];
        let rest = 1.0 - gauss.d.iter().sum::<f64>();
        for k in 0..e {
            transition[k * ml..(k + 1) * ml].as_flattened_mut()[k] += 1.0;
        }
        for beta in 0..n - e {
            let row = &mut transition[(e + beta) * ml..(e + beta + 1) * ml];
            row.as_flattened_mut()[e + beta] += rest;
            for stage in 0..m {
                let from = (stage * n + e + beta) * ml;
                add_scaled(row, gauss.d[stage], &map[from..from + ml]);
            }
        }
    }

    /// The rows of the integral conditions: Σ h b_j (∂g/∂y δY_j + ∂g/∂p δp).
    #[inline(always)]
    fn map_integrals<const N: usize, const E: usize, const M: usize, const ML: usize>(
        &mut self,
        gauss: &Gauss,
        i: usize,
    ) {
        let (n, _, m) = self.sizes::<N, E, M>();
        let (ni, np) = (self.layout.dims.integrals, self.layout.dims.scalars);
        let (h, ml) = (self.h[i], self.map_lanes::<ML>());
        let map = &self.map[i * m * n * ml..(i + 1) * m * n * ml];
        let integral = &mut self.integral[i * ni * ml..(i + 1) * ni * ml];
        integral.fill([0.0; LANE]);
        for stage in 0..m {
            let point = i * m + stage;
            for k in 0..ni {
                let row = &mut integral[k * ml..(k + 1) * ml];
                for c in 0..n {
                    let weight = h * gauss.b[stage] * self.gy[(point * ni + k) * n + c];
                    if weight != 0.0 {
                        let from = (stage * n + c) * ml;
                        add_scaled(row, weight, &map[from..from + ml]);
                    }
                }
                for q in 0..np {
                    row.as_flattened_mut()[n + q] += h * gauss.b[stage] * self.gp[(point * ni + k) * np + q];
                }
            }
        }
    }

    /// Lanes of a row of the map, known at compile time unless 0.
    #[inline(always)]
    fn map_lanes<const ML: usize>(&self) -> usize {
        if ML > 0 { ML } else { self.layout.map_lanes }
    }

    /// (n, e, m), known at compile time where the generic parameters are not 0.
    #[inline(always)]
    fn sizes<const N: usize, const E: usize, const M: usize>(&self) -> (usize, usize, usize) {
        let l = self.layout;
        if N > 0 { (N, E, M) } else { (l.dims.components, l.dims.integrable, l.m) }
    }

    /// Particular stage values of interval i for stage residuals `r` (m × n), with δy₀ = δp = 0, into `y` (m × n).
    /// Returns nothing else: [`particular_node`](Self::particular_node) gives c and the integrals follow from `y`.
    #[inline(always)]
    pub fn particular_stages<const N: usize, const E: usize, const M: usize>(
        &self,
        gauss: &Gauss,
        i: usize,
        r: &[f64],
        y: &mut [f64],
    ) {
        let (n, e, m) = self.sizes::<N, E, M>();
        let l = self.layout;
        let nn = n - e;
        let h = self.h[i];
        let fy = &self.fy[i * m * n * n..(i + 1) * m * n * n];
        let (r, y) = (&r[..m * n], &mut y[..m * n]);
        let mut lanes = [[0.0; LANE]; MAX_STAGE_LANES];
        let x = lanes.as_flattened_mut();
        for stage in 0..m {
            for k in 0..e {
                let mut sum = 0.0;
                for j in 0..m {
                    sum -= gauss.a[stage * m + j] * r[j * n + k];
                }
                y[stage * n + k] = sum;
            }
            for alpha in 0..nn {
                let f_row = &fy[(stage * n + e + alpha) * n..(stage * n + e + alpha + 1) * n];
                let mut value = -r[stage * n + e + alpha];
                for k in 0..e {
                    value += h * f_row[k] * y[stage * n + k];
                }
                x[stage * nn + alpha] = value;
            }
        }
        let mut solved = [[0.0; LANE]; MAX_STAGE_LANES];
        let solved = &mut solved[..dense::lanes_for(m * nn)];
        let inverse = &self.inverse[i * l.s * l.rhs_lane..(i + 1) * l.s * l.rhs_lane];
        // Without stage unknowns there are no columns, and a chunk needs a length all the same.
        for (column, value) in inverse.chunks_exact(dense::lanes_for(m * nn).max(1)).zip(&x[..m * nn]) {
            add_scaled(solved, *value, column);
        }
        let x = solved.as_flattened();
        for stage in 0..m {
            y[stage * n + e..(stage + 1) * n].copy_from_slice(&x[stage * nn..(stage + 1) * nn]);
        }
        for stage in 0..m {
            for k in 0..e {
                let f_row = &fy[(stage * n + k) * n..(stage * n + k + 1) * n];
                let mut slope = 0.0;
                for b in 0..nn {
                    slope += f_row[e + b] * y[stage * n + e + b];
                }
                for j in 0..m {
                    y[j * n + k] += h * gauss.a[j * m + stage] * slope;
                }
            }
        }
    }

    /// The constant c = δy₁ for δy₀ = δp = 0 from the particular stage values and the node residual ρ, into `c`.
    pub fn particular_node(&self, gauss: &Gauss, y: &[f64], rho: &[f64], c: &mut [f64]) {
        let n = self.layout.dims.components;
        for k in 0..n {
            c[k] = rho[k] + (0..self.layout.m).map(|j| gauss.d[j] * y[j * n + k]).sum::<f64>();
        }
    }

    /// Adds the map of interval i times (δy₀, δp) to the particular stage values in `y`.
    pub fn complete_stages(&self, i: usize, dy0: &[f64], dp: &[f64], y: &mut [f64]) {
        let l = self.layout;
        let n = l.dims.components;
        let mut x = [0.0; MAX_UNKNOWN_LANES * LANE];
        x[..n].copy_from_slice(dy0);
        x[n..n + dp.len()].copy_from_slice(dp);
        complete(&self.map[i * l.m * n * l.map_lanes..(i + 1) * l.m * n * l.map_lanes], l.map_lanes, &x, y);
    }

    /// Multiplies the determinants of all stage matrices into `det`.
    pub fn accumulate_determinant(&self, det: &mut Determinant) {
        let l = self.layout;
        for i in 0..self.intervals() {
            let stages = i * l.s..(i + 1) * l.s;
            dense::accumulate_determinant(&self.reciprocal[stages.clone()], &self.exchange[stages], det);
        }
    }
}

#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx+avx2", "aarch64+neon"))]
fn complete(map: &[Lane], lanes: usize, x: &[f64], y: &mut [f64]) {
    for (value, row) in y.iter_mut().zip(map.chunks_exact(lanes)) {
        let mut sum = [0.0; LANE];
        for (part, x) in row.iter().zip(x.as_chunks::<LANE>().0) {
            for t in 0..LANE {
                sum[t] += part[t] * x[t];
            }
        }
        *value += ((sum[0] + sum[4]) + (sum[1] + sum[5])) + ((sum[2] + sum[6]) + (sum[3] + sum[7]));
    }
}
