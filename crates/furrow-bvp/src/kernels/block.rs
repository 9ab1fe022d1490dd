//! The almost block diagonal system of the nodes, bordered by scalar unknowns and by rows that touch every node.
//!
//! Unknowns are δy_0 … δy_N (n each) and δp. Elimination walks from left to right: the rows that still involve only δy_i
//! (first the left conditions) join the n rows −G_i δy_i + δy_{i+1} − B_i δp = c_i (N.4), partial pivoting removes δy_i, and
//! what remains is carried to the next interval. Because [carried; −G_i] always has full column rank, a singular system
//! (a fold, a pitchfork) shows only in the last small block; its determinant is therefore a test function.
//!
//! # References
//! Ascher, Mattheij & Russell 1995, ch. 7 (stability of block elimination with row pivoting for separated conditions).

use crate::dense::{self, Determinant, LANE, Lanes, Lu, MAX_LANES, PivotFailure};
use crate::dimensions::{Dimensions, MAX_ROWS, MAX_UNKNOWN_LANES, MAX_UNKNOWNS};
use crate::direction::LinearCondition;

use super::condense::Condensed;
use super::shape::{RuntimeSizes, Shape, Sizes};

/// Derivatives of the conditions at the ends and of the offsets of the integral conditions; row-major.
#[derive(Clone, Debug, Default)]
pub struct EndJacobian {
    /// ∂/∂y and ∂/∂p of the left conditions; × n and × scalars.
    pub left: [Vec<f64>; 2],
    /// The same of the right conditions.
    pub right: [Vec<f64>; 2],
    /// ∂h/∂p of the integral conditions, × scalars; their other derivatives are in the condensed intervals.
    pub offsets: Vec<f64>,
}

/// Factors of the bordered almost block diagonal matrix.
#[derive(Clone, Debug, Default)]
pub struct BlockFactor {
    /// Components.
    n: usize,
    /// Scalar unknowns.
    np: usize,
    /// Left, right, integral and border conditions; the last are the integral and the linear ones.
    nl: usize,
    nr: usize,
    ni: usize,
    nb: usize,
    intervals: usize,
    /// Rows of the interval at work: carried, transition, border.
    panel: Lanes,
    /// Pivots of every interval: their reciprocals and the rows exchanged for them.
    reciprocal: Vec<f64>,
    exchange: Vec<u8>,
    /// The last block.
    last: Lu,
    /// What elimination does to the right-hand sides of an interval once its rows are exchanged, by columns of the n pivots: rows
    /// (solved δy_i, carried, border); per interval n × lanes_for(rows).
    transform: Lanes,
    /// −∂δy_i/∂(δy_{i+1}, δp) by columns, one lane run of n rows each; per interval.
    backward: Lanes,
    /// U⁻¹ times the forward-eliminated right-hand side of each interval.
    forward: Lanes,
}

/// Factors of the last block of the antisymmetric problem on a mirror-symmetric half, see
/// [`System::factor_antisymmetric`](crate::System::factor_antisymmetric). The symmetric problem has the same other blocks.
#[derive(Clone, Debug, Default)]
pub struct AntisymmetricEnd {
    last: Lu,
    /// Rows of the conditions at the right end; × n.
    pub(crate) rows: Vec<f64>,
}

impl AntisymmetricEnd {
    /// The rows of n entries that make the given components vanish.
    pub(crate) fn set_vanishing(&mut self, components: &[usize], n: usize) {
        dense::zeroed(&mut self.rows, components.len() * n);
        for (row, &component) in self.rows.chunks_exact_mut(n.max(1)).zip(components) {
            if let Some(entry) = row.get_mut(component) {
                *entry = 1.0;
            }
        }
    }

    /// Components of the problem that it was factorised for.
    pub(crate) fn size(&self) -> usize {
        self.last.size()
    }
}

/// Widths of the panel, the rows of one interval: carried, transition and border rows, as columns of δy_i, δy_{i+1} and δp.
/// Elimination replaces the columns of δy_i by its row operations.
#[derive(Clone, Copy)]
struct Panel {
    /// Rows.
    rows: usize,
    /// Lanes of a row.
    lanes: usize,
}

impl BlockFactor {
    /// Takes over the sizes, makes room and loads the rows that are carried from the left end. The elimination is complete
    /// after [`eliminate`](Self::eliminate) and [`factor_last`](Self::factor_last). There have to be as many conditions as unknowns.
    pub fn begin(&mut self, condensed: &Condensed, ends: &EndJacobian, conditions: &[LinearCondition]) {
        self.reset(condensed, conditions.len());
        let (n, np, lanes) = (self.n, self.np, self.panel_widths().lanes);
        for k in 0..self.nl {
            let row = self.panel[k * lanes..(k + 1) * lanes].as_flattened_mut();
            row[..n].copy_from_slice(&ends.left[0][k * n..(k + 1) * n]);
            row[2 * n..2 * n + np].copy_from_slice(&ends.left[1][k * np..(k + 1) * np]);
        }
        for k in 0..self.nb {
            let at = (self.nl + n + k) * lanes;
            let source = match k.checked_sub(self.ni) {
                None => &ends.offsets[k * np..(k + 1) * np],
                Some(k) => &conditions[k].scalars[..np],
            };
            self.panel[at..at + lanes].as_flattened_mut()[2 * n..2 * n + np].copy_from_slice(source);
        }
    }

    /// Eliminates the intervals from left to right.
    ///
    /// # Errors
    /// If a pivot vanishes.
    #[inline(always)]
    pub(crate) fn eliminate<S: Shape>(
        &mut self,
        condensed: &Condensed,
        conditions: &[LinearCondition],
    ) -> Result<(), PivotFailure> {
        let [n, nl, _] = self.sizes::<S>();
        let lanes = self.panel::<S>().lanes;
        for i in 0..self.intervals {
            self.load_interval::<S>(condensed, conditions, i);
            let pivots = i * n..(i + 1) * n;
            let (reciprocal, exchange) = (&mut self.reciprocal[pivots.clone()], &mut self.exchange[pivots]);
            dense::eliminate_in_place(&mut self.panel, lanes, n, nl + n, reciprocal, exchange)?;
            self.store_interval::<S>(i);
            if i + 1 < self.intervals {
                self.shift_panel::<S>();
            }
        }
        Ok(())
    }

    /// Components, left conditions and scalar unknowns.
    #[inline(always)]
    fn sizes<S: Shape>(&self) -> [usize; 3] {
        let BlockFactor { n: components, nl: left, np: scalars, .. } = *self;
        // Stages do not matter.
        let Sizes { n, left, np, .. } = S::sizes(Dimensions { components, left, scalars, ..Dimensions::default() }, 1);
        [n, left, np]
    }

    #[inline(always)]
    fn panel<S: Shape>(&self) -> Panel {
        let [n, nl, np] = self.sizes::<S>();
        Panel { rows: nl + n + self.nb, lanes: dense::lanes_for(2 * n + np) }
    }

    fn panel_widths(&self) -> Panel {
        self.panel::<RuntimeSizes>()
    }

    fn reset(&mut self, condensed: &Condensed, conditions: usize) {
        let Dimensions { components: n, scalars: np, left: nl, right: nr, integrals: ni, .. } = condensed.dims;
        let nb = ni + conditions;
        let nf = n + np;
        debug_assert_eq!(nl + nr + nb, nf, "as many conditions as unknowns");
        (self.n, self.np, self.nl, self.nr, self.ni, self.nb) = (n, np, nl, nr, ni, nb);
        self.intervals = condensed.intervals();
        let Panel { rows, lanes, .. } = self.panel_widths();
        let (tall, height) = (dense::lanes_for(rows), dense::lanes_for(n));
        self.panel.resize(rows * lanes);
        self.panel.fill([0.0; LANE]);
        self.reciprocal.resize(self.intervals * n, 0.0);
        self.exchange.resize(self.intervals * n, 0);
        self.transform.resize(self.intervals * n * tall);
        self.backward.resize(self.intervals * nf * height);
        self.forward.resize(self.intervals * height);
    }

    /// Adds the rows of interval i to those carried on.
    #[inline(always)]
    fn load_interval<S: Shape>(&mut self, condensed: &Condensed, conditions: &[LinearCondition], i: usize) {
        let ([n, nl, _], ni) = (self.sizes::<S>(), self.ni);
        let (lanes, outputs) = (self.panel::<S>().lanes, condensed.output_lanes());
        let (transition, borders) = self.panel[nl * lanes..].split_at_mut(n * lanes);
        transition.fill([0.0; LANE]);
        for k in 0..n {
            transition[k * lanes..(k + 1) * lanes].as_flattened_mut()[n + k] = 1.0;
        }
        for (c, column) in condensed.transition(i).chunks_exact(outputs).enumerate() {
            let (column, to) = (column.as_flattened(), if c < n { c } else { n + c });
            for (k, entry) in column[..n].iter().enumerate() {
                transition[k * lanes..(k + 1) * lanes].as_flattened_mut()[to] = -entry;
            }
            for (row, entry) in borders.chunks_exact_mut(lanes).zip(&column[n..n + ni]) {
                row.as_flattened_mut()[to] += entry;
            }
        }
        for (row, condition) in borders.chunks_exact_mut(lanes).skip(ni).zip(conditions) {
            for (entry, weight) in row.as_flattened_mut().iter_mut().zip(&condition.nodes[i * n..(i + 1) * n]) {
                *entry += weight;
            }
        }
    }

    /// Keeps what solves need of the eliminated interval i.
    #[inline(always)]
    fn store_interval<S: Shape>(&mut self, i: usize) {
        let [n, _, np] = self.sizes::<S>();
        let nf = n + np;
        let Panel { rows, lanes } = self.panel::<S>();
        let (height, tall) = (dense::lanes_for(n), dense::lanes_for(rows));
        let backward = &mut self.backward[i * nf * height..(i + 1) * nf * height];
        let transform = &mut self.transform[i * n * tall..(i + 1) * n * tall];
        for (k, row) in self.panel.chunks_exact(lanes).enumerate() {
            let row = row.as_flattened();
            let (lane, offset) = (k / LANE, k % LANE);
            for c in 0..n {
                transform[c * tall + lane][offset] = row[c];
            }
            if k < n {
                for c in 0..nf {
                    backward[c * height + lane][offset] = row[n + c];
                }
            }
        }
    }

    /// Moves the remaining carried and border rows to the next interval: δy_{i+1} takes the place of δy_i.
    /// Carried rows follow the n pivot rows.
    #[inline(always)]
    fn shift_panel<S: Shape>(&mut self) {
        let [n, nl, _] = self.sizes::<S>();
        let lanes = self.panel::<S>().lanes;
        let panel = &mut self.panel[..];
        for k in 0..nl + self.nb {
            let from = (n + k) * lanes;
            let to = if k < nl { k } else { k + n } * lanes;
            panel.copy_within(from..from + lanes, to);
            let row = panel[to..to + lanes].as_flattened_mut();
            row.copy_within(n..2 * n, 0);
            row[n..2 * n].fill(0.0);
        }
    }

    /// Factorises the last block: carried rows, right conditions and borders in δy_N and δp.
    ///
    /// # Errors
    /// If a pivot vanishes: the system is singular.
    pub fn factor_last(&mut self, ends: &EndJacobian, conditions: &[LinearCondition]) -> Result<(), PivotFailure> {
        let (n, np, nl, nf) = (self.n, self.np, self.nl, self.n + self.np);
        let (lanes, fl) = (self.panel_widths().lanes, dense::lanes_for(nf));
        let mut last = vec![[0.0; LANE]; nf * fl];
        for k in 0..nl + self.nb {
            let source = self.panel[(n + k) * lanes..(n + k + 1) * lanes].as_flattened();
            let to = if k < nl { k } else { k + self.nr };
            let target = last[to * fl..(to + 1) * fl].as_flattened_mut();
            target[..nf].copy_from_slice(&source[n..n + nf]);
            if k >= nl + self.ni {
                let condition = &conditions[k - nl - self.ni];
                for c in 0..n {
                    target[c] += condition.nodes[self.intervals * n + c];
                }
            }
        }
        for k in 0..self.nr {
            let row = last[(nl + k) * fl..(nl + k + 1) * fl].as_flattened_mut();
            row[..n].copy_from_slice(&ends.right[0][k * n..(k + 1) * n]);
            row[n..nf].copy_from_slice(&ends.right[1][k * np..(k + 1) * np]);
        }
        self.last.factorise(&mut last, nf)
    }

    /// Factorises the last block of the antisymmetric problem, with the right end rows of `end` and without scalar unknowns,
    /// integral and linear conditions. Borders are never pivots, so that up to this block both eliminations are the same.
    /// End rows and left conditions have to be as many as the components.
    ///
    /// # Errors
    /// If a pivot vanishes.
    pub fn factor_antisymmetric(&self, end: &mut AntisymmetricEnd) -> Result<(), PivotFailure> {
        let n = self.n;
        debug_assert_eq!(self.nl * n + end.rows.len(), n * n, "as many conditions as unknowns");
        let (fl, lanes) = (dense::lanes_for(n), self.panel_widths().lanes);
        let mut last = vec![[0.0; LANE]; n * fl];
        let (carried, right) = last.split_at_mut(self.nl * fl);
        for (k, row) in carried.chunks_exact_mut(fl).enumerate() {
            let source = self.panel[(n + k) * lanes..(n + k + 1) * lanes].as_flattened();
            row.as_flattened_mut()[..n].copy_from_slice(&source[n..2 * n]);
        }
        for (row, source) in right.chunks_exact_mut(fl).zip(end.rows.chunks_exact(n)) {
            row.as_flattened_mut()[..n].copy_from_slice(source);
        }
        end.last.factorise(&mut last, n)
    }

    /// Border conditions: integral and linear ones.
    pub fn borders(&self) -> usize {
        self.nb
    }

    /// In place of [`forward`](Self::forward) for right-hand sides that are zero except in the last block.
    pub fn forward_zero(&mut self) {
        self.forward.fill([0.0; LANE]);
    }

    /// Eliminates the right-hand sides of all intervals. `carried` and `border` are right-hand sides of the left and border conditions
    /// on entry, and of the last block on return.
    #[inline(always)]
    pub(crate) fn forward<S: Shape>(&mut self, nodes: &[f64], carried: &mut [f64], border: &mut [f64]) {
        let [n, nl, _] = self.sizes::<S>();
        let rows = nl + n + border.len();
        let (height, tall) = (dense::lanes_for(n), dense::lanes_for(rows));
        let (mut before, mut after) = ([0.0; MAX_ROWS], [[0.0; LANE]; MAX_LANES]);
        before[..nl].copy_from_slice(&carried[..nl]);
        before[nl + n..rows].copy_from_slice(border);
        for i in 0..self.intervals {
            before[nl..nl + n].copy_from_slice(&nodes[i * n..(i + 1) * n]);
            for (k, other) in self.exchange[i * n..(i + 1) * n].iter().enumerate() {
                before.swap(k, *other as usize % MAX_ROWS);
            }
            let x = after.as_flattened_mut();
            x[..n].fill(0.0);
            x[n..n + nl].copy_from_slice(&before[n..n + nl]);
            x[n + nl..rows].copy_from_slice(&before[n + nl..rows]);
            let transform = &self.transform[i * n * tall..(i + 1) * n * tall];
            dense::add_columns(&mut after[..tall], &before[..n], transform, tall);
            self.forward[i * height..(i + 1) * height].copy_from_slice(&after[..height]);
            // Carried rows move to the front; border rows stay behind the next n.
            let x = after.as_flattened();
            before[..nl].copy_from_slice(&x[n..n + nl]);
            before[n + nl..rows].copy_from_slice(&x[n + nl..rows]);
        }
        carried.copy_from_slice(&before[..nl]);
        border.copy_from_slice(&before[nl + n..rows]);
    }

    /// Solves the last block, or the antisymmetric problem's, for the last node and the scalar unknowns.
    pub fn solve_last(
        &self,
        antisymmetric: Option<&AntisymmetricEnd>,
        [carried, right, border]: [&[f64]; 3],
        nodes: &mut [f64],
        scalars: &mut [f64],
    ) {
        let last = antisymmetric.map_or(&self.last, |end| &end.last);
        let mut x = [[0.0; LANE]; MAX_UNKNOWN_LANES];
        let y = x.as_flattened_mut();
        y[..self.nl].copy_from_slice(carried);
        y[self.nl..self.nl + right.len()].copy_from_slice(right);
        y[self.nl + right.len()..last.size()].copy_from_slice(border);
        last.solve(&mut x);
        let y = x.as_flattened();
        nodes[self.intervals * self.n..].copy_from_slice(&y[..self.n]);
        scalars.copy_from_slice(&y[self.n..last.size()]);
    }

    /// Substitution from the last node to the left.
    #[inline(always)]
    pub(crate) fn backward<S: Shape>(&mut self, nodes: &mut [f64], scalars: &[f64]) {
        let [n, _, np] = self.sizes::<S>();
        let height = dense::lanes_for(n);
        let stride = (n + np) * height;
        let mut from = [0.0; MAX_UNKNOWNS];
        for (x, scalar) in from[n..].iter_mut().zip(scalars) {
            *x = -scalar;
        }
        for i in (0..self.intervals).rev() {
            let columns = &self.backward[i * stride..(i + 1) * stride];
            let (to, next) = nodes[i * n..(i + 2) * n].split_at_mut(n);
            for (x, next) in from.iter_mut().zip(next.iter()) {
                *x = -*next;
            }
            let mut sums = [[0.0; LANE]; MAX_UNKNOWN_LANES];
            let sums = &mut sums[..height];
            sums.copy_from_slice(&self.forward[i * height..(i + 1) * height]);
            dense::add_columns(sums, &from[..n + scalars.len()], columns, height);
            to.copy_from_slice(&sums.as_flattened()[..n]);
        }
    }

    /// Multiplies the determinant of the factorised matrix, or of the antisymmetric problem, into `det`.
    pub fn multiply_into(&self, antisymmetric: Option<&AntisymmetricEnd>, det: &mut Determinant) {
        // Moving the right rows ahead of the border rows is a fixed permutation; its sign is left out.
        for (r, e) in self.reciprocal.chunks_exact(self.n).zip(self.exchange.chunks_exact(self.n)) {
            det.multiply(r, e);
        }
        antisymmetric.map_or(&self.last, |end| &end.last).multiply_into(det);
    }
}
