//! Static condensation: the stages of one interval expressed by its left node and the scalar unknowns.
//!
//! With E the quadrature components and N the others, linearising N.1 gives on every interval
//!
//! * δY_E,j = δy_E + Σ_k a_jk (h F_EN,k δY_N,k + h F_Ep,k δp − R_E,k),
//! * S δY_N = σ, S_ij = D_ij I − δ_ij h F_NN,i − h² a_ij F_NE,i F_EN,j
//!   \[N.3 condensed\], σ_i = s_i δy_N + h F_NE,i δy_E + (h F_Np,i + h² F_NE,i Σ_k a_ik F_Ep,k) δp − R_N,i − h F_NE,i Σ_k a_ik R_E,k,
//!
//! with s_i = Σ_j D_ij and R the stage residual. S is inverted once. The columns of the map from (δy₀, δp) to δY_N, and the answer to a
//! new residual, are products with the inverse. The stages contribute YᵀδY_N to the right node and the integrals, with one column of Y for
//! each of them, computed from these columns and answers: where S is nearly singular, stages and nodes have the same error.
//!
//! Everything that a solve runs over is kept by columns padded to whole lanes, so that every product is a sum of scaled
//! vectors, without reductions.

use crate::dense::{self, Determinant, LANE, Lane, Lanes, PivotFailure, add_scaled};
use crate::dimensions::Dimensions;
use crate::gauss::{Gauss, MAX_STAGES};

use super::shape::{RuntimeSizes, Shape, Sizes};

/// Most lanes of the stage unknowns of one interval.
pub const MAX_STAGE_LANES: usize = dense::MAX_LANES;

/// Entries of a quad: there are few quadrature components.
pub const QUAD: usize = 4;

/// Up to four quadrature components of one stage.
pub type Quad = [f64; QUAD];

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
    /// S⁻¹ by columns; per interval s × lanes of s. Newton corrects its rounding.
    pub(super) inverse: Lanes,
    /// Pivots of all intervals, for determinants; intervals × s.
    reciprocal: Vec<f64>,
    exchange: Vec<u8>,
    /// δY_N by columns of (δy₀, δp); per interval columns × lanes of s.
    pub(super) map: Lanes,
    /// Y; per interval s × lanes of outputs.
    pub(super) outputs: Lanes,
    /// σ by columns of δy_E (h F_NE) and of δp; per interval e + scalars × lanes of s.
    pub(super) onto: Lanes,
    /// h F_EN by columns, padded to whole quads; per interval quads of e × stage unknowns.
    pub(super) from: Vec<Quad>,
    /// h Σ_k a_jk F_Ep,k, padded to quads of e; per interval scalars × quads of e × m.
    pub(super) sums: Vec<Quad>,
    /// [G B], and the integrals behind the components of the node, by columns; per interval columns × lanes of outputs.
    transition: Lanes,
    /// h b_j ∂g/∂y; per interval integrals × m × n.
    pub(super) weights: Vec<f64>,
}

impl Condensed {
    /// Empty storage for a problem and a stage count.
    pub fn new(dims: Dimensions, m: usize) -> Condensed {
        Condensed { dims, m, ..Condensed::default() }
    }

    /// Lanes of the outputs of an interval: the components of its right node, then the integrals.
    pub fn output_lanes(&self) -> usize {
        self.sizes::<RuntimeSizes>().outputs
    }

    /// Number of intervals.
    pub fn intervals(&self) -> usize {
        self.h.len()
    }

    /// Sizes the storage for a mesh and zeroes the derivatives.
    pub fn reset(&mut self, mesh: &[f64]) {
        let sizes = self.sizes::<RuntimeSizes>();
        let Sizes { n, e, m, s, lanes, quads, np, ni, outputs, .. } = sizes;
        let intervals = mesh.len() - 1;
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
        self.reciprocal.resize(intervals * s, 0.0);
        self.exchange.resize(intervals * s, 0);
        self.map.resize(intervals * sizes.columns() * lanes);
        self.outputs.resize(intervals * s * outputs);
        self.onto.resize(intervals * (e + np) * lanes);
        self.from.resize(intervals * quads * s, [0.0; QUAD]);
        self.sums.resize(intervals * np * quads * m, [0.0; QUAD]);
        self.transition.resize(intervals * sizes.columns() * outputs);
        self.weights.resize(points * ni * n, 0.0);
    }

    /// The transition of interval i and its integrals by columns of (δy₀, δp), each the lanes of outputs.
    pub fn transition(&self, i: usize) -> &[Lane] {
        let sizes = self.sizes::<RuntimeSizes>();
        part(&self.transition, i, sizes.columns() * sizes.outputs)
    }

    /// Multiplies the determinants of all stage matrices into `det`.
    pub fn multiply_into(&self, det: &mut Determinant) {
        let s = self.sizes::<RuntimeSizes>().s;
        for i in 0..self.intervals() {
            det.multiply(part(&self.reciprocal, i, s), part(&self.exchange, i, s));
        }
    }

    /// Condenses every interval from the derivatives stored for it.
    ///
    /// # Errors
    /// If a pivot of a stage matrix vanishes.
    #[inline(always)]
    pub fn condense<S: Shape>(&mut self, gauss: &Gauss) -> Result<(), PivotFailure> {
        for i in 0..self.intervals() {
            self.gather::<S>(gauss, i);
            self.gather_scalars::<S>(gauss, i);
            self.fill_stage_matrix::<S>(gauss, i);
            self.fill_outputs::<S>(gauss, i);
            self.invert::<S>(i)?;
            self.fill_transition::<S>(gauss, i);
        }
        Ok(())
    }

    /// The couplings h F_NE and h F_EN and the weights of the integrals of interval i.
    #[inline(always)]
    fn gather<S: Shape>(&mut self, gauss: &Gauss, i: usize) {
        let sizes = self.sizes::<S>();
        let Sizes { n, e, m, nn, s, lanes, first, quads, np, ni, .. } = sizes;
        let h = self.h[i];
        let fy = part(&self.fy, i, m * n * n);
        let onto = &mut part_mut(&mut self.onto, i, (e + np) * lanes)[..e * lanes];
        let from = part_mut(&mut self.from, i, quads * s);
        for stage in 0..m {
            let f = part(fy, stage, n * n);
            for k in 0..e {
                let component = sizes.quadrature(k);
                let column = part_mut(part_mut(onto, k, lanes).as_flattened_mut(), stage, nn);
                let quad = part_mut(part_mut(from, k / QUAD, s), stage, nn);
                for beta in 0..nn {
                    column[beta] = h * f[(first + beta) * n + component];
                    quad[beta][k % QUAD] = h * f[component * n + first + beta];
                }
            }
        }
        let gy = part(&self.gy, i, m * ni * n);
        let weights = part_mut(&mut self.weights, i, ni * m * n);
        for stage in 0..m {
            let weight = h * gauss.b[stage];
            for k in 0..ni {
                let gy = part(part(gy, stage, ni * n), k, n);
                let weights = part_mut(part_mut(weights, k, m * n), stage, n);
                for c in 0..n {
                    weights[c] = weight * gy[c];
                }
            }
        }
    }

    /// The contributions of the scalar unknowns of interval i to σ, to the quadrature components, to its transition and to the integrals,
    /// without the contribution through δY_N.
    #[inline(always)]
    fn gather_scalars<S: Shape>(&mut self, gauss: &Gauss, i: usize) {
        let sizes = self.sizes::<S>();
        let Sizes { n, e, m, nn, lanes, first, quads, np, ni, outputs, .. } = sizes;
        let h = self.h[i];
        let (fp, gp) = (part(&self.fp, i, m * n * np), part(&self.gp, i, m * ni * np));
        let (onto, onto_scalars) = part_mut(&mut self.onto, i, (e + np) * lanes).split_at_mut(e * lanes);
        let sums = part_mut(&mut self.sums, i, np * quads * m);
        let weights = part(&self.weights, i, ni * m * n);
        let transition = &mut part_mut(&mut self.transition, i, sizes.columns() * outputs)[n * outputs..];
        for c in 0..np {
            let column = part_mut(onto_scalars, c, lanes);
            let output = part_mut(transition, c, outputs);
            output.fill([0.0; LANE]);
            let output = output.as_flattened_mut();
            for stage in 0..m {
                let f = part(fp, stage, n * np);
                let column = part_mut(column.as_flattened_mut(), stage, nn);
                for beta in 0..nn {
                    column[beta] = h * f[(first + beta) * np + c];
                }
                for k in 0..ni {
                    output[n + k] += h * gauss.b[stage] * part(gp, stage, ni * np)[k * np + c];
                }
            }
            for quad in 0..quads {
                let mut slopes = [[0.0; QUAD]; MAX_STAGES];
                for stage in 0..m {
                    let f = part(fp, stage, n * np);
                    for t in 0..sizes.width(quad * QUAD) {
                        let component = sizes.quadrature(quad * QUAD + t);
                        slopes[stage][t] = h * f[component * np + c];
                        output[component] += gauss.b[stage] * slopes[stage][t];
                    }
                }
                let values = integrated(&gauss.a[..m * m], m, &slopes);
                part_mut(part_mut(sums, c, quads * m), quad, m).copy_from_slice(&values[..m]);
                add_onto(sizes, onto, quad, &values, column);
                for k in 0..ni {
                    output[n + k] += of_quadratures(sizes, part(weights, k, m * n), quad, &values);
                }
            }
        }
    }

    /// Sᵀ of interval i, in the place of the inverse: row (j, β) has the coefficients of δY_N,j,β in all equations.
    #[inline(always)]
    fn fill_stage_matrix<S: Shape>(&mut self, gauss: &Gauss, i: usize) {
        let Sizes { n, e, m, nn, s, lanes, first, quads, np, .. } = self.sizes::<S>();
        let h = self.h[i];
        let fy = part(&self.fy, i, m * n * n);
        let onto = part(&self.onto, i, (e + np) * lanes);
        let from = part(&self.from, i, quads * s);
        let matrix = part_mut(&mut self.inverse, i, s * lanes);
        if e == 0 {
            matrix.fill([0.0; LANE]);
        }
        for j in 0..m {
            let rows = part_mut(matrix, j, nn * lanes);
            for k in 0..e {
                // The effect of the slope of component k at stage j on all equations, through its values at all stages.
                let mut reach = [[0.0; LANE]; MAX_STAGE_LANES];
                let column = part(onto, k, lanes).as_flattened();
                for stage in 0..m {
                    let to = part_mut(reach.as_flattened_mut(), stage, nn);
                    for alpha in 0..nn {
                        to[alpha] = gauss.a[stage * m + j] * part(column, stage, nn)[alpha];
                    }
                }
                let from = part(part(from, k / QUAD, s), j, nn);
                for beta in 0..nn {
                    let row = part_mut(rows, beta, lanes);
                    for v in 0..lanes {
                        if k == 0 {
                            row[v] = [0.0; LANE];
                        }
                        add_scaled(&mut row[v], -from[beta][k % QUAD], &reach[v]);
                    }
                }
            }
            let f = part(fy, j, n * n);
            for beta in 0..nn {
                let row = part_mut(rows, beta, lanes).as_flattened_mut();
                for stage in 0..m {
                    row[stage * nn + beta] += gauss.d_matrix[stage * m + j];
                }
                let own = part_mut(row, j, nn);
                for alpha in 0..nn {
                    own[alpha] -= h * f[(first + alpha) * n + first + beta];
                }
            }
        }
    }

    /// Y of interval i: row (j, β) has what δY_N,j,β adds to the right node and to the integrals.
    #[inline(always)]
    fn fill_outputs<S: Shape>(&mut self, gauss: &Gauss, i: usize) {
        let sizes = self.sizes::<S>();
        let Sizes { n, e, m, nn, s, first, quads, ni, outputs, .. } = sizes;
        let from = part(&self.from, i, quads * s);
        let weights = part(&self.weights, i, ni * m * n);
        let y = part_mut(&mut self.outputs, i, s * outputs);
        y.fill([0.0; LANE]);
        for j in 0..m {
            for beta in 0..nn {
                let at = j * nn + beta;
                let row = part_mut(y, at, outputs).as_flattened_mut();
                row[first + beta] = gauss.d[j];
                for k in 0..e {
                    // Σ_i d_i a_ij = b_j.
                    row[sizes.quadrature(k)] = gauss.b[j] * part(from, k / QUAD, s)[at][k % QUAD];
                }
                for k in 0..ni {
                    row[n + k] = part(part(weights, k, m * n), j, n)[first + beta];
                }
            }
            for integral in 0..ni {
                let weights = part(weights, integral, m * n);
                for k in 0..e {
                    let mut sum = 0.0;
                    for i in 0..m {
                        sum += part(weights, i, n)[sizes.quadrature(k)] * gauss.a[i * m + j];
                    }
                    for at in j * nn..(j + 1) * nn {
                        let row = part_mut(y, at, outputs).as_flattened_mut();
                        row[n + integral] += sum * part(from, k / QUAD, s)[at][k % QUAD];
                    }
                }
            }
        }
    }

    /// The inverse of the stage matrix of interval i.
    #[inline(always)]
    fn invert<S: Shape>(&mut self, i: usize) -> Result<(), PivotFailure> {
        let Sizes { s, lanes, .. } = self.sizes::<S>();
        let inverse = part_mut(&mut self.inverse, i, s * lanes);
        let (reciprocal, exchange) = (part_mut(&mut self.reciprocal, i, s), part_mut(&mut self.exchange, i, s));
        // The block holds Sᵀ by rows, so its inverse by rows is S⁻¹ by columns.
        dense::invert(inverse, lanes, reciprocal, exchange)
    }

    /// The map of interval i, its transition and its integrals.
    #[inline(always)]
    fn fill_transition<S: Shape>(&mut self, gauss: &Gauss, i: usize) {
        let sizes = self.sizes::<S>();
        let Sizes { n, e, m, nn, s, lanes, first, np, ni, outputs, .. } = sizes;
        let inverse = part(&self.inverse, i, s * lanes);
        let y = part(&self.outputs, i, s * outputs);
        let onto = part(&self.onto, i, (e + np) * lanes);
        let weights = part(&self.weights, i, ni * m * n);
        let map = part_mut(&mut self.map, i, sizes.columns() * lanes);
        let transition = part_mut(&mut self.transition, i, sizes.columns() * outputs);
        let rest = 1.0 - gauss.d[..m].iter().sum::<f64>();
        for beta in 0..nn {
            let column = part_mut(map, first + beta, lanes);
            column.fill([0.0; LANE]);
            for stage in 0..m {
                let share = gauss.d_matrix[stage * m..(stage + 1) * m].iter().sum::<f64>();
                let row = part(part(inverse, stage, nn * lanes), beta, lanes);
                for v in 0..lanes {
                    add_scaled(&mut column[v], share, &row[v]);
                }
            }
            let sum = part_mut(transition, first + beta, outputs);
            sum.fill([0.0; LANE]);
            sum.as_flattened_mut()[first + beta] = rest;
            dense::add_columns(sum, &column.as_flattened()[..s], y, outputs);
        }
        for k in 0..e + np {
            let c = if k < e { sizes.quadrature(k) } else { n + k - e };
            let (column, sum) = (part_mut(map, c, lanes), part_mut(transition, c, outputs));
            column.fill([0.0; LANE]);
            dense::add_columns(column, &part(onto, k, lanes).as_flattened()[..s], inverse, lanes);
            if k < e {
                sum.fill([0.0; LANE]);
                sum.as_flattened_mut()[c] = 1.0;
                for integral in 0..ni {
                    let weights = part(weights, integral, m * n);
                    for j in 0..m {
                        sum.as_flattened_mut()[n + integral] += part(weights, j, n)[c];
                    }
                }
            }
            dense::add_columns(sum, &column.as_flattened()[..s], y, outputs);
        }
    }

    /// Sizes as a shape knows them.
    #[inline(always)]
    pub(super) fn sizes<S: Shape>(&self) -> Sizes {
        S::sizes(self.dims, self.m)
    }
}

#[inline(always)]
pub(super) fn part<T>(of: &[T], i: usize, size: usize) -> &[T] {
    &of[i * size..(i + 1) * size]
}

#[inline(always)]
pub(super) fn part_mut<T>(of: &mut [T], i: usize, size: usize) -> &mut [T] {
    &mut of[i * size..(i + 1) * size]
}

/// Σ_j a_ij q_j at every stage i, of slopes q.
#[inline(always)]
pub(super) fn integrated(a: &[f64], m: usize, slopes: &[Quad; MAX_STAGES]) -> [Quad; MAX_STAGES] {
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

/// Adds the effect of the values of a quad of quadratures at the stages on σ.
#[inline(always)]
pub(super) fn add_onto(sizes: Sizes, onto: &[Lane], quad: usize, values: &[Quad; MAX_STAGES], to: &mut [Lane]) {
    let Sizes { m, nn, lanes, .. } = sizes;
    for t in 0..sizes.width(quad * QUAD) {
        let onto = part(onto, quad * QUAD + t, lanes).as_flattened();
        for stage in 0..m {
            let (to, onto) = (part_mut(to.as_flattened_mut(), stage, nn), part(onto, stage, nn));
            for beta in 0..nn {
                to[beta] += onto[beta] * values[stage][t];
            }
        }
    }
}

/// The contribution of the values of a quad of quadratures at the stages to an integral with these weights.
#[inline(always)]
pub(super) fn of_quadratures(sizes: Sizes, weights: &[f64], quad: usize, values: &[Quad; MAX_STAGES]) -> f64 {
    let mut sum = 0.0;
    for stage in 0..sizes.m {
        for t in 0..sizes.width(quad * QUAD) {
            sum += part(weights, stage, sizes.n)[sizes.quadrature(quad * QUAD + t)] * values[stage][t];
        }
    }
    sum
}
