//! Right-hand sides and stage values of condensed intervals, see [`condense`](super::condense).

use crate::dense::{self, LANE};
use crate::dimensions::MAX_UNKNOWNS;
use crate::direction::{Direction, Residual};
use crate::gauss::{Gauss, MAX_STAGES};

use super::condense::{Condensed, MAX_STAGE_LANES, QUAD, add_onto, integrated, of_quadratures, part, part_mut};
use super::shape::{Shape, Sizes};

impl Condensed {
    /// Writes the contributions of a residual to the right nodes of all intervals, to the stage unknowns and to the quadrature components
    /// into the nodes and stages of `out`, where [`complete`](Self::complete) uses them. Subtracts its contributions to the integrals from
    /// `borders`, which is empty or has one entry for each integral.
    #[inline(always)]
    pub fn particular<S: Shape>(&self, gauss: &Gauss, residual: &Residual, out: &mut Direction, borders: &mut [f64]) {
        let sizes = self.sizes::<S>();
        let Sizes { n, e, m, nn, s, lanes, first, quads, np, ni, outputs, .. } = sizes;
        for i in 0..self.intervals() {
            let r = part(&residual.stages, i, m * n);
            let stages = part_mut(&mut out.stages, i, m * n);
            let weights = part(&self.weights, i, ni * m * n);
            let onto = part(&self.onto, i, (e + np) * lanes);
            let mut sigma = [[0.0; LANE]; MAX_STAGE_LANES];
            let mut output = [[0.0; LANE]; MAX_STAGE_LANES];
            for stage in 0..m {
                let (r, to) = (part(r, stage, n), part_mut(sigma.as_flattened_mut(), stage, nn));
                for beta in 0..nn {
                    to[beta] = -r[first + beta];
                }
            }
            for quad in 0..quads {
                let mut slopes = [[0.0; QUAD]; MAX_STAGES];
                for j in 0..m {
                    for t in 0..sizes.width(quad * QUAD) {
                        let component = sizes.quadrature(quad * QUAD + t);
                        slopes[j][t] = -part(r, j, n)[component];
                        output.as_flattened_mut()[component] += gauss.b[j] * slopes[j][t];
                    }
                }
                let values = integrated(&gauss.a[..m * m], m, &slopes);
                add_onto(sizes, onto, quad, &values, &mut sigma);
                for j in 0..m {
                    for t in 0..sizes.width(quad * QUAD) {
                        part_mut(stages, j, n)[sizes.quadrature(quad * QUAD + t)] = values[j][t];
                    }
                }
                for k in 0..borders.len().min(ni) {
                    borders[k] -= of_quadratures(sizes, part(weights, k, m * n), quad, &values);
                }
            }
            let mut solved = [[0.0; LANE]; MAX_STAGE_LANES];
            let inverse = part(&self.inverse, i, s * lanes);
            dense::add_columns(&mut solved[..lanes], &sigma.as_flattened()[..s], inverse, lanes);
            let solved = solved.as_flattened();
            for stage in 0..m {
                let (from, to) = (part(solved, stage, nn), part_mut(stages, stage, n));
                to[first..first + nn].copy_from_slice(from);
            }
            dense::add_columns(&mut output[..outputs], &solved[..s], part(&self.outputs, i, s * outputs), outputs);
            let output = output.as_flattened();
            let (node, r) = (part_mut(&mut out.nodes, i, n), part(&residual.nodes, i, n));
            for c in 0..n {
                node[c] = r[c] + output[c];
            }
            for k in 0..borders.len().min(ni) {
                borders[k] -= output[n + k];
            }
        }
    }

    /// Stage values of all intervals, from what [`particular`](Self::particular) has left of a residual, and from the nodes and scalars of
    /// `out`.
    #[inline(always)]
    pub fn complete<S: Shape>(&self, gauss: &Gauss, out: &mut Direction) {
        let sizes = self.sizes::<S>();
        let Sizes { n, m, nn, lanes, first, np, .. } = sizes;
        let mut inputs = [0.0; MAX_UNKNOWNS];
        inputs[n..n + np].copy_from_slice(&out.scalars[..np]);
        for i in 0..self.intervals() {
            inputs[..n].copy_from_slice(part(&out.nodes, i, n));
            let stages = part_mut(&mut out.stages, i, m * n);
            let mut solved = [[0.0; LANE]; MAX_STAGE_LANES];
            for stage in 0..m {
                let (from, to) = (part(stages, stage, n), part_mut(solved.as_flattened_mut(), stage, nn));
                to.copy_from_slice(&from[first..first + nn]);
            }
            let map = part(&self.map, i, sizes.columns() * lanes);
            dense::add_columns(&mut solved[..lanes], &inputs[..n + np], map, lanes);
            self.write_stages(sizes, gauss, i, (&inputs, solved.as_flattened()), stages);
        }
    }

    /// Writes the stage values of interval i; its stage unknowns are `solved`.
    #[inline(always)]
    fn write_stages(
        &self,
        sizes: Sizes,
        gauss: &Gauss,
        i: usize,
        (inputs, solved): (&[f64; MAX_UNKNOWNS], &[f64]),
        stages: &mut [f64],
    ) {
        let Sizes { n, m, nn, s, first, quads, np, .. } = sizes;
        let sums = part(&self.sums, i, np * quads * m);
        let from = part(&self.from, i, quads * s);
        for quad in 0..quads {
            let mut slopes = [[0.0; QUAD]; MAX_STAGES];
            for j in 0..m {
                let (solved, from) = (part(solved, j, nn), part(part(from, quad, s), j, nn));
                for beta in 0..nn {
                    for t in 0..QUAD {
                        slopes[j][t] += solved[beta] * from[beta][t];
                    }
                }
            }
            let mut values = integrated(&gauss.a[..m * m], m, &slopes);
            for c in 0..np {
                let sums = part(part(sums, c, quads * m), quad, m);
                for j in 0..m {
                    for t in 0..QUAD {
                        values[j][t] += inputs[n + c] * sums[j][t];
                    }
                }
            }
            for j in 0..m {
                for t in 0..sizes.width(quad * QUAD) {
                    let component = sizes.quadrature(quad * QUAD + t);
                    part_mut(stages, j, n)[component] += inputs[component] + values[j][t];
                }
            }
        }
        for stage in 0..m {
            let (from, to) = (part(solved, stage, nn), part_mut(stages, stage, n));
            to[first..first + nn].copy_from_slice(from);
        }
    }
}
