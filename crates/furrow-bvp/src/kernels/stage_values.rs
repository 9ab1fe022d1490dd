//! Right-hand sides and stage values of condensed intervals, see [`condense`](super::condense).

use crate::dense::{self, LANE, Lane};
use crate::dimensions::MAX_UNKNOWNS;
use crate::direction::{Direction, Residual};
use crate::gauss::{Gauss, MAX_STAGES};

use super::condense::{Condensed, MAX_STAGE_LANES, QUAD, add_onto, integrated, of_quadratures, part, part_mut};
use super::shape::{Shape, Sizes};

impl Condensed {
    /// What a residual adds to the right nodes of all intervals (into the nodes) and to σ and the values of quadrature components (into
    /// the stages, where [`complete`](Self::complete) finds them); what it adds to the integrals is taken from `borders`, of which there
    /// are as many as integrals or none.
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
            for stage in 0..m {
                let (from, to) = (part(sigma.as_flattened(), stage, nn), part_mut(stages, stage, n));
                for beta in 0..nn {
                    to[first + beta] = from[beta];
                }
            }
            dense::add_columns(
                &mut output[..outputs],
                &sigma.as_flattened()[..s],
                part(&self.outputs, i, s * outputs),
                outputs,
            );
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
        let Sizes { n, e, m, s, lanes, np, .. } = sizes;
        let mut inputs = [0.0; MAX_UNKNOWNS];
        inputs[e..e + np].copy_from_slice(&out.scalars[..np]);
        for i in 0..self.intervals() {
            let (node, stages) = (part(&out.nodes, i, n), part_mut(&mut out.stages, i, m * n));
            for k in 0..e {
                inputs[k] = node[sizes.quadrature(k)];
            }
            let sigma = self.sum_sigma(sizes, gauss, i, (node, &inputs), stages);
            let mut solved = [[0.0; LANE]; MAX_STAGE_LANES];
            let inverse = part(&self.inverse, i, s * lanes);
            dense::add_columns(&mut solved[..lanes], &sigma.as_flattened()[..s], inverse, lanes);
            self.put_stages(sizes, gauss, i, (&inputs, solved.as_flattened()), stages);
        }
    }

    /// σ of interval i: what a residual has left of it in the stages, and what the node and the `inputs`, quadrature components and
    /// scalars, add.
    #[inline(always)]
    fn sum_sigma(
        &self,
        sizes: Sizes,
        gauss: &Gauss,
        i: usize,
        (node, inputs): (&[f64], &[f64; MAX_UNKNOWNS]),
        stages: &[f64],
    ) -> [Lane; MAX_STAGE_LANES] {
        let Sizes { n, e, m, nn, lanes, first, np, .. } = sizes;
        let mut sigma = [[0.0; LANE]; MAX_STAGE_LANES];
        for stage in 0..m {
            let share = gauss.d_matrix[stage * m..(stage + 1) * m].iter().sum::<f64>();
            let (from, to) = (part(stages, stage, n), part_mut(sigma.as_flattened_mut(), stage, nn));
            for beta in 0..nn {
                to[beta] = from[first + beta] + share * node[first + beta];
            }
        }
        let onto = part(&self.onto, i, (e + np) * lanes);
        dense::add_columns(&mut sigma[..lanes], &inputs[..e + np], onto, lanes);
        sigma
    }

    /// Writes the stage values of interval i, of which the stage unknowns are `solved`.
    #[inline(always)]
    fn put_stages(
        &self,
        sizes: Sizes,
        gauss: &Gauss,
        i: usize,
        (inputs, solved): (&[f64; MAX_UNKNOWNS], &[f64]),
        stages: &mut [f64],
    ) {
        let Sizes { n, e, m, nn, s, first, quads, np, .. } = sizes;
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
                        values[j][t] += inputs[e + c] * sums[j][t];
                    }
                }
            }
            for j in 0..m {
                for t in 0..sizes.width(quad * QUAD) {
                    let k = quad * QUAD + t;
                    part_mut(stages, j, n)[sizes.quadrature(k)] += inputs[k] + values[j][t];
                }
            }
        }
        for stage in 0..m {
            let (from, to) = (part(solved, stage, nn), part_mut(stages, stage, n));
            for beta in 0..nn {
                to[first + beta] = from[beta];
            }
        }
    }
}
