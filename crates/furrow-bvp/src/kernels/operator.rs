//! The responses of stages to forces on them, interval by interval, for solves with few forces and readings per stage.

use crate::dense::{self, LANE, Lane, Lanes, add_scaled};
use crate::dimensions::MAX_UNKNOWNS;
use crate::gauss::Gauss;

use super::condense::{Condensed, MAX_STAGE_LANES, QUAD, part, part_mut};
use super::shape::{RuntimeSizes, Shape, Sizes};

/// Most readings of an interval.
pub const MAX_READINGS: usize = MAX_STAGE_LANES * LANE;

/// The parts of the solution operator of a linearised problem on the intervals, each by columns. With forces w on the equations of the
/// stages, readings C of the stages, and S, Y as in [`condense`](super::condense), an interval gives
///
/// * −YᵀS⁻¹Bw to its right node and to the integrals (B puts the forces into σ),
/// * −CS⁻¹Bw + C ∂(stages)/∂(δy₀, δp) (δy₀, δp) to the readings.
#[derive(Clone, Debug, Default)]
pub struct Responses {
    /// Forces per stage.
    pub forces: usize,
    /// Readings per stage.
    pub readings: usize,
    /// −YᵀS⁻¹B; per interval forces × lanes of outputs.
    onto_node: Lanes,
    /// −CS⁻¹B; per interval forces × lanes of readings.
    direct: Lanes,
    /// C ∂(stages)/∂(δy₀, δp); per interval columns × lanes of readings.
    from_unknowns: Lanes,
    /// C by columns of the stage unknowns, of the interval at work.
    read: Lanes,
}

impl Responses {
    /// Lanes of the readings of an interval.
    fn lanes(&self, m: usize) -> usize {
        dense::lanes_for(m * self.readings)
    }

    /// Computes them from condensed intervals. `force` has the forces of a point on the residuals of components that are not quadratures,
    /// components × forces; `reading` has the coefficients of the readings, readings × components. Static sizes have one force and one
    /// reading.
    #[inline(always)]
    pub fn fill_responses<S: Shape>(&mut self, condensed: &Condensed, gauss: &Gauss, force: &[f64], reading: &[f64]) {
        let [forces, readings] = if S::KNOWN { [1, 1] } else { [self.forces, self.readings] };
        self.fill::<S>(condensed, gauss, (force, forces), (reading, readings));
    }

    #[inline(always)]
    fn fill<S: Shape>(
        &mut self,
        condensed: &Condensed,
        gauss: &Gauss,
        (force, forces): (&[f64], usize),
        (reading, readings): (&[f64], usize),
    ) {
        let sizes = condensed.sizes::<S>();
        let Sizes { n, m, nn, s, lanes, outputs, .. } = sizes;
        let width = dense::lanes_for(m * readings);
        let intervals = condensed.intervals();
        self.onto_node.resize(intervals * m * forces * outputs);
        self.direct.resize(intervals * m * forces * width);
        self.from_unknowns.resize(intervals * sizes.columns() * width);
        self.read.resize(s * width);
        for i in 0..intervals {
            let reading = (part(reading, i, m * readings * n), readings);
            let read = &mut self.read[..s * width];
            gather_readings(sizes, condensed, gauss, i, reading, read);
            let inverse = part(&condensed.inverse, i, s * lanes);
            let y = part(&condensed.outputs, i, s * outputs);
            let onto_node = part_mut(&mut self.onto_node, i, m * forces * outputs);
            let direct = part_mut(&mut self.direct, i, m * forces * width);
            let force = part(force, i, m * nn * forces);
            for stage in 0..m {
                let (force, inverse) = (part(force, stage, nn * forces), part(inverse, stage, nn * lanes));
                for k in 0..forces {
                    let mut solved = [[0.0; LANE]; MAX_STAGE_LANES];
                    for beta in 0..nn {
                        let column = part(inverse, beta, lanes);
                        for v in 0..lanes {
                            add_scaled(&mut solved[v], -force[beta * forces + k], &column[v]);
                        }
                    }
                    let solved = &solved.as_flattened()[..s];
                    let at = stage * forces + k;
                    let (onto_node, direct) = (part_mut(onto_node, at, outputs), part_mut(direct, at, width));
                    onto_node.fill([0.0; LANE]);
                    dense::add_columns(onto_node, solved, y, outputs);
                    direct.fill([0.0; LANE]);
                    dense::add_columns(direct, solved, read, width);
                }
            }
            let from_unknowns = part_mut(&mut self.from_unknowns, i, sizes.columns() * width);
            fill_from_unknowns(sizes, condensed, i, reading, read, from_unknowns);
        }
    }

    /// Adds the forces' part of the right nodes of all intervals; their part of the integrals is subtracted from `borders`.
    #[inline(always)]
    pub fn onto_nodes(&self, condensed: &Condensed, from: &[f64], nodes: &mut [f64], borders: &mut [f64]) {
        let Sizes { n, m, outputs, .. } = condensed.sizes::<RuntimeSizes>();
        let columns = m * self.forces;
        for i in 0..condensed.intervals() {
            let mut sums = [[0.0; LANE]; MAX_STAGE_LANES];
            let onto = part(&self.onto_node, i, columns * outputs);
            dense::add_columns(&mut sums[..outputs], part(from, i, columns), onto, outputs);
            let sums = sums.as_flattened();
            part_mut(nodes, i, n).copy_from_slice(&sums[..n]);
            for (border, sum) in borders.iter_mut().zip(&sums[n..]) {
                *border -= sum;
            }
        }
    }

    /// The readings that belong to forces, and to nodes and scalars.
    #[inline(always)]
    pub fn read(&self, condensed: &Condensed, from: &[f64], [nodes, scalars]: [&[f64]; 2], to: &mut [f64]) {
        let Sizes { n, m, np, .. } = condensed.sizes::<RuntimeSizes>();
        let (columns, lanes) = (m * self.forces, self.lanes(m));
        let mut unknowns = [0.0; MAX_UNKNOWNS];
        unknowns[n..n + np].copy_from_slice(&scalars[..np]);
        for i in 0..condensed.intervals() {
            unknowns[..n].copy_from_slice(part(nodes, i, n));
            let mut sums = [[0.0; LANE]; MAX_STAGE_LANES];
            let sums = &mut sums[..lanes];
            dense::add_columns(sums, part(from, i, columns), part(&self.direct, i, columns * lanes), lanes);
            let from_unknowns = part(&self.from_unknowns, i, (n + np) * lanes);
            dense::add_columns(sums, &unknowns[..n + np], from_unknowns, lanes);
            let to = part_mut(to, i, m * self.readings);
            to.copy_from_slice(&sums.as_flattened()[..to.len()]);
        }
    }
}

/// C of interval i, by columns of the stage unknowns.
#[inline(always)]
fn gather_readings(
    sizes: Sizes,
    condensed: &Condensed,
    gauss: &Gauss,
    i: usize,
    (reading, readings): (&[f64], usize),
    read: &mut [Lane],
) {
    let Sizes { n, e, m, nn, s, first, quads, .. } = sizes;
    let lanes = dense::lanes_for(m * readings);
    let from = part(&condensed.from, i, quads * s);
    for j in 0..m {
        let rows = part_mut(read, j, nn * lanes);
        rows.fill([0.0; LANE]);
        for beta in 0..nn {
            let row = part_mut(rows, beta, lanes).as_flattened_mut();
            for o in 0..readings {
                row[j * readings + o] = reading[(j * readings + o) * n + first + beta];
            }
        }
        for k in 0..e {
            // The effect of the slope of component k at stage j on all readings, through its values at all stages.
            let component = sizes.quadrature(k);
            let mut reach = [[0.0; LANE]; MAX_STAGE_LANES];
            let to = reach.as_flattened_mut();
            for stage in 0..m {
                for o in stage * readings..(stage + 1) * readings {
                    to[o] = gauss.a[stage * m + j] * reading[o * n + component];
                }
            }
            let from = part(part(from, k / QUAD, s), j, nn);
            for beta in 0..nn {
                let row = part_mut(rows, beta, lanes);
                for v in 0..lanes {
                    add_scaled(&mut row[v], from[beta][k % QUAD], &reach[v]);
                }
            }
        }
    }
}

/// How the readings of interval i depend on its left node and on the scalar unknowns.
#[inline(always)]
fn fill_from_unknowns(
    sizes: Sizes,
    condensed: &Condensed,
    i: usize,
    (reading, readings): (&[f64], usize),
    read: &[Lane],
    to: &mut [Lane],
) {
    let Sizes { n, e, m, s, lanes, quads, np, .. } = sizes;
    let width = dense::lanes_for(m * readings);
    let map = part(&condensed.map, i, sizes.columns() * lanes);
    let sums = part(&condensed.sums, i, np * quads * m);
    for c in 0..sizes.columns() {
        let to = part_mut(to, c, width);
        to.fill([0.0; LANE]);
        dense::add_columns(to, &part(map, c, lanes).as_flattened()[..s], read, width);
    }
    for k in 0..e {
        let component = sizes.quadrature(k);
        for o in 0..m * readings {
            let reading = reading[o * n + component];
            part_mut(to, component, width).as_flattened_mut()[o] += reading;
            for c in 0..np {
                let sum = part(part(sums, c, quads * m), k / QUAD, m)[o / readings][k % QUAD];
                part_mut(to, n + c, width).as_flattened_mut()[o] += reading * sum;
            }
        }
    }
}
