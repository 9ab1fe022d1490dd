//! The almost block diagonal system of the nodes, bordered by scalar unknowns and by rows that touch every node.
//!
//! Unknowns are δy_0 … δy_N (n each) and δp. Elimination walks from left to right: the rows that still involve only δy_i
//! (first the left conditions) join the n rows −G_i δy_i + δy_{i+1} − B_i δp = c_i (N.4), partial pivoting removes δy_i, and
//! what remains is carried to the next interval. Because [carried; −G_i] always has full column rank, a singular system
//! (a fold, a pitchfork) shows only in the last small block, whose determinant is therefore a test function.
//!
//! # References
//! Ascher, Mattheij & Russell 1995, ch. 7 (stability of block elimination with row pivoting for separated conditions).

use crate::condense::Condensed;
use crate::dense::{self, Determinant, Factors, FactorsRef, LANE, Lanes, MAX_LANES, PivotFailure};
use crate::kernels::Kernels;
use crate::problem::{MAX_ROWS, MAX_UNKNOWN_LANES, MAX_UNKNOWNS};

/// Rows at one end: `rows` conditions with derivatives by y (× n) and by p (× scalars), row-major.
#[derive(Clone, Copy, Debug)]
pub struct EndRows<'a> {
    /// ∂r/∂y.
    pub ry: &'a [f64],
    /// ∂r/∂p.
    pub rp: &'a [f64],
    /// Number of conditions.
    pub rows: usize,
}

/// A dense linear form on all nodes and scalars: Σ w_i·y_i + w_p·p.
#[derive(Clone, Copy, Debug)]
pub struct LinearForm<'a> {
    /// Weights of the node values; (N + 1) × n.
    pub nodes: &'a [f64],
    /// Weights of the scalar unknowns.
    pub scalars: &'a [f64],
}

/// All rows but those of the intervals.
#[derive(Clone, Copy, Debug)]
pub struct Conditions<'a> {
    /// Conditions at the left end.
    pub left: EndRows<'a>,
    /// Conditions at the right end.
    pub right: EndRows<'a>,
    /// Derivatives ∂h/∂p of the integral conditions, whose other derivatives are in the condensed intervals; integrals ×
    /// scalars.
    pub offsets: &'a [f64],
    /// Linear conditions.
    pub forms: &'a [LinearForm<'a>],
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
    last: FactorStore,
    /// What elimination does to the right-hand sides of an interval once its rows are exchanged, by columns of the n pivots: rows
    /// (solved δy_i, carried, border); per interval n × lanes_for(rows).
    transform: Lanes,
    /// −∂δy_i/∂(δy_{i+1}, δp) by columns, one lane run of n rows each; per interval.
    backward: Lanes,
    /// U⁻¹ times the forward-eliminated right-hand side of each interval.
    forward: Lanes,
}

/// Factors of the last block of the antisymmetric problem on a mirror-symmetric half, see
/// [`System::factor_antisymmetric`](crate::System::factor_antisymmetric): up to there the elimination is that of the
/// symmetric problem.
#[derive(Clone, Debug, Default)]
pub struct AntisymmetricEnd {
    last: FactorStore,
    /// Right end rows, kept for the next factorisation.
    pub(crate) rows: Vec<f64>,
}

#[derive(Clone, Debug, Default)]
struct FactorStore {
    columns: usize,
    rows: usize,
    lower: Lanes,
    upper: Lanes,
    reciprocal: Vec<f64>,
    exchange: Vec<u8>,
}

impl FactorStore {
    fn reset(&mut self, blocks: usize, columns: usize, rows: usize) {
        (self.columns, self.rows) = (columns, rows);
        self.lower.resize(blocks * columns * dense::lanes_for(rows));
        self.upper.resize(blocks * columns * dense::lanes_for(columns));
        self.reciprocal.resize(blocks * columns, 0.0);
        self.exchange.resize(blocks * columns, 0);
    }

    fn write(&mut self, i: usize) -> Factors<'_> {
        let (c, l, u) = (self.columns, dense::lanes_for(self.rows), dense::lanes_for(self.columns));
        Factors {
            lower: &mut self.lower[i * c * l..(i + 1) * c * l],
            upper: &mut self.upper[i * c * u..(i + 1) * c * u],
            reciprocal: &mut self.reciprocal[i * c..(i + 1) * c],
            exchange: &mut self.exchange[i * c..(i + 1) * c],
        }
    }

    fn accumulate_determinant(&self, det: &mut Determinant) {
        let c = self.columns;
        for (r, e) in self.reciprocal.chunks_exact(c).zip(self.exchange.chunks_exact(c)) {
            dense::accumulate_determinant(r, e, det);
        }
    }

    fn read(&self, i: usize) -> FactorsRef<'_> {
        let (c, l, u) = (self.columns, dense::lanes_for(self.rows), dense::lanes_for(self.columns));
        FactorsRef {
            lower: &self.lower[i * c * l..(i + 1) * c * l],
            upper: &self.upper[i * c * u..(i + 1) * c * u],
            reciprocal: &self.reciprocal[i * c..(i + 1) * c],
            exchange: &self.exchange[i * c..(i + 1) * c],
        }
    }
}

/// Widths of the panel, the rows of one interval: carried, transition and border rows, as columns of δy_i, δy_{i+1} and δp.
/// Those of δy_i become what elimination does to the rows.
#[derive(Clone, Copy)]
struct Panel {
    /// Rows.
    rows: usize,
    /// Lanes of a row.
    lanes: usize,
}

impl BlockFactor {
    /// Factorises the condensed intervals with the conditions that make the system square.
    ///
    /// # Errors
    /// If a pivot vanishes: in the last block where the system is singular.
    ///
    /// # Panics
    /// If there are not as many conditions as unknowns.
    pub fn factor(
        &mut self,
        kernels: &Kernels,
        condensed: &Condensed,
        conditions: &Conditions<'_>,
    ) -> Result<(), PivotFailure> {
        self.reset(condensed, conditions);
        self.begin(conditions);
        (kernels.eliminate)(self, condensed, conditions.forms)?;
        self.factor_last(conditions)
    }

    /// Eliminates the intervals from left to right. Sizes (components, left conditions) are known at compile time unless 0, here
    /// and below.
    ///
    /// # Errors
    /// If a pivot vanishes.
    #[inline(always)]
    pub(crate) fn eliminate<const N: usize, const LEFT: usize>(
        &mut self,
        condensed: &Condensed,
        forms: &[LinearForm<'_>],
    ) -> Result<(), PivotFailure> {
        let (n, nl) = self.sizes::<N, LEFT>();
        let lanes = self.panel_widths().lanes;
        for i in 0..self.intervals {
            self.load_interval::<N, LEFT>(condensed, forms, i);
            let pivots = i * n..(i + 1) * n;
            let (reciprocal, exchange) = (&mut self.reciprocal[pivots.clone()], &mut self.exchange[pivots]);
            dense::eliminate_in_place(&mut self.panel, lanes, n, nl + n, reciprocal, exchange)?;
            self.store_interval::<N, LEFT>(i);
            if i + 1 < self.intervals {
                self.carry_on::<N, LEFT>();
            }
        }
        Ok(())
    }

    /// Components and left conditions, known at compile time where the generic parameters are not 0.
    #[inline(always)]
    fn sizes<const N: usize, const LEFT: usize>(&self) -> (usize, usize) {
        if N > 0 { (N, LEFT) } else { (self.n, self.nl) }
    }

    fn panel_widths(&self) -> Panel {
        let rows = self.nl + self.n + self.nb;
        Panel { rows, lanes: dense::lanes_for(2 * self.n + self.np) }
    }

    /// Takes over sizes and makes room.
    fn reset(&mut self, condensed: &Condensed, conditions: &Conditions<'_>) {
        let dims = condensed.layout.dims;
        let (n, np) = (dims.components, dims.scalars);
        let (nl, nr, ni) = (conditions.left.rows, conditions.right.rows, dims.integrals);
        let nb = ni + conditions.forms.len();
        let nf = n + np;
        assert_eq!(nl + nr + nb, nf, "as many conditions as unknowns");
        (self.n, self.np, self.nl, self.nr, self.ni, self.nb) = (n, np, nl, nr, ni, nb);
        self.intervals = condensed.intervals();
        let Panel { rows, lanes, .. } = self.panel_widths();
        let (tall, height) = (dense::lanes_for(rows), dense::lanes_for(n));
        self.panel.resize(rows * lanes);
        self.panel.fill([0.0; LANE]);
        self.reciprocal.resize(self.intervals * n, 0.0);
        self.exchange.resize(self.intervals * n, 0);
        self.transform.resize(self.intervals * n * tall);
        self.last.reset(1, nf, nf);
        self.backward.resize(self.intervals * nf * height);
        self.forward.resize(self.intervals * height);
    }

    /// Writes end condition k: derivatives by the components in front, those by the scalars at column `p_at`.
    fn put_end(&self, row: &mut [f64], end: &EndRows<'_>, k: usize, p_at: usize) {
        let (n, np) = (self.n, self.np);
        row[..n].copy_from_slice(&end.ry[k * n..(k + 1) * n]);
        row[p_at..p_at + np].copy_from_slice(&end.rp[k * np..(k + 1) * np]);
    }

    /// The rows that are carried from interval to interval, before the first: left conditions, and of the borders what
    /// belongs to the scalars.
    fn begin(&mut self, conditions: &Conditions<'_>) {
        let (n, np, lanes) = (self.n, self.np, self.panel_widths().lanes);
        let mut panel = std::mem::take(&mut self.panel);
        for k in 0..self.nl {
            self.put_end(panel[k * lanes..(k + 1) * lanes].as_flattened_mut(), &conditions.left, k, 2 * n);
        }
        for k in 0..self.nb {
            let at = (self.nl + n + k) * lanes;
            let row = panel[at..at + lanes].as_flattened_mut();
            let source = match k.checked_sub(self.ni) {
                None => &conditions.offsets[k * np..(k + 1) * np],
                Some(form) => &conditions.forms[form].scalars[..np],
            };
            row[2 * n..2 * n + np].copy_from_slice(source);
        }
        self.panel = panel;
    }

    /// Adds the rows of interval i to those carried on.
    #[inline(always)]
    fn load_interval<const N: usize, const LEFT: usize>(
        &mut self,
        condensed: &Condensed,
        forms: &[LinearForm<'_>],
        i: usize,
    ) {
        let (n, nl) = self.sizes::<N, LEFT>();
        let (nf, ni) = (n + self.np, self.ni);
        let (lanes, height) = (self.panel_widths().lanes, dense::lanes_for(n));
        let transition = &mut self.panel[nl * lanes..(nl + n) * lanes];
        transition.fill([0.0; LANE]);
        let columns = condensed.transition(i);
        for (k, row) in transition.chunks_exact_mut(lanes).enumerate() {
            let row = row.as_flattened_mut();
            for c in 0..n {
                row[c] = -columns[c * height + k / LANE][k % LANE];
            }
            row[n + k] = 1.0;
            for c in n..nf {
                row[n + c] = -columns[c * height + k / LANE][k % LANE];
            }
        }
        let integral = condensed.integral(i);
        for k in 0..self.nb {
            let at = (nl + n + k) * lanes;
            let row = self.panel[at..at + lanes].as_flattened_mut();
            if k < ni {
                let source = &integral[k * nf..(k + 1) * nf];
                for c in 0..n {
                    row[c] += source[c];
                }
                for c in n..nf {
                    row[n + c] += source[c];
                }
            } else {
                for c in 0..n {
                    row[c] += forms[k - ni].nodes[i * n + c];
                }
            }
        }
    }

    /// Keeps what solves need of the eliminated interval i.
    #[inline(always)]
    fn store_interval<const N: usize, const LEFT: usize>(&mut self, i: usize) {
        let (n, _) = self.sizes::<N, LEFT>();
        let nf = n + self.np;
        let Panel { rows, lanes } = self.panel_widths();
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

    /// Moves what is left of the carried and border rows on to the next interval: δy_{i+1} takes the place of δy_i.
    /// Carried rows stand right behind the n pivot rows.
    #[inline(always)]
    fn carry_on<const N: usize, const LEFT: usize>(&mut self) {
        let (n, nl) = self.sizes::<N, LEFT>();
        let lanes = self.panel_widths().lanes;
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
    fn factor_last(&mut self, conditions: &Conditions<'_>) -> Result<(), PivotFailure> {
        let (n, nl, nf) = (self.n, self.nl, self.n + self.np);
        let (lanes, fl) = (self.panel_widths().lanes, dense::lanes_for(nf));
        let mut last = [[0.0; LANE]; MAX_UNKNOWNS * MAX_UNKNOWN_LANES];
        let last = &mut last[..nf * fl];
        for k in 0..nl + self.nb {
            let source = self.panel[(n + k) * lanes..(n + k + 1) * lanes].as_flattened();
            let to = if k < nl { k } else { k + self.nr };
            let target = last[to * fl..(to + 1) * fl].as_flattened_mut();
            target[..nf].copy_from_slice(&source[n..n + nf]);
            if k >= nl + self.ni {
                let form = &conditions.forms[k - nl - self.ni];
                for c in 0..n {
                    target[c] += form.nodes[self.intervals * n + c];
                }
            }
        }
        for k in 0..self.nr {
            let to = nl + k;
            self.put_end(last[to * fl..(to + 1) * fl].as_flattened_mut(), &conditions.right, k, n);
        }
        dense::eliminate(last, fl, nf, nf, &mut self.last.write(0))
    }

    /// Solves for node updates (`nodes`, holding on entry c_i of interval i at index i·n, length (N + 1)·n) and scalar
    /// updates. `left`, `right` and `border` are right-hand sides of the condition rows (integrals first in `border`).
    pub fn solve(
        &mut self,
        kernels: &Kernels,
        nodes: &mut [f64],
        [left, right, border]: [&[f64]; 3],
        scalars: &mut [f64],
    ) {
        let mut carried = [0.0; MAX_UNKNOWNS];
        let mut rest = [0.0; MAX_UNKNOWNS];
        let (carried, rest) = (&mut carried[..self.nl], &mut rest[..self.nb]);
        carried.copy_from_slice(left);
        rest.copy_from_slice(border);
        (kernels.forward)(self, nodes, carried, rest);
        self.solve_end(carried, right, rest, nodes, scalars);
        (kernels.backward)(self, nodes, scalars);
    }

    /// [`solve`](Self::solve) for right-hand sides that are zero but for the last conditions.
    pub fn solve_last(
        &mut self,
        kernels: &Kernels,
        nodes: &mut [f64],
        [right, border]: [&[f64]; 2],
        scalars: &mut [f64],
    ) {
        self.forward.fill([0.0; LANE]);
        self.solve_end(&[0.0; MAX_UNKNOWNS][..self.nl], right, border, nodes, scalars);
        (kernels.backward)(self, nodes, scalars);
    }

    /// Eliminates the right-hand sides of all intervals: `carried` and `border` go in as those of the left and border
    /// conditions and come out as those of the last block.
    #[inline(always)]
    pub(crate) fn forward<const N: usize, const LEFT: usize>(
        &mut self,
        nodes: &[f64],
        carried: &mut [f64],
        border: &mut [f64],
    ) {
        let (n, nl) = self.sizes::<N, LEFT>();
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
            for v in 0..tall {
                let mut sum = after[v];
                for k in 0..n {
                    dense::add_scaled(&mut sum, before[k], &transform[k * tall + v]);
                }
                after[v] = sum;
            }
            self.forward[i * height..(i + 1) * height].copy_from_slice(&after[..height]);
            // Carried rows move to the front; border rows stay behind the next n.
            let x = after.as_flattened();
            before[..nl].copy_from_slice(&x[n..n + nl]);
            before[n + nl..rows].copy_from_slice(&x[n + nl..rows]);
        }
        carried.copy_from_slice(&before[..nl]);
        border.copy_from_slice(&before[nl + n..rows]);
    }

    /// The last node and the scalar unknowns.
    fn solve_end(&self, carried: &[f64], right: &[f64], border: &[f64], nodes: &mut [f64], scalars: &mut [f64]) {
        let nf = self.n + self.np;
        let mut end = [[0.0; LANE]; MAX_UNKNOWN_LANES];
        let y = end.as_flattened_mut();
        y[..self.nl].copy_from_slice(carried);
        y[self.nl..self.nl + self.nr].copy_from_slice(right);
        y[self.nl + self.nr..nf].copy_from_slice(border);
        dense::solve_vector(self.last.read(0), nf, &mut end);
        let y = end.as_flattened();
        nodes[self.intervals * self.n..].copy_from_slice(&y[..self.n]);
        scalars[..self.np].copy_from_slice(&y[self.n..nf]);
    }

    /// Substitution from the last node to the left.
    #[inline(always)]
    pub(crate) fn backward<const N: usize, const LEFT: usize>(&mut self, nodes: &mut [f64], scalars: &[f64]) {
        let (n, _) = self.sizes::<N, LEFT>();
        let height = dense::lanes_for(n);
        let stride = (n + self.np) * height;
        for i in (0..self.intervals).rev() {
            let columns = &self.backward[i * stride..(i + 1) * stride];
            let (to, from) = nodes[i * n..(i + 2) * n].split_at_mut(n);
            for (v, to) in to.chunks_mut(LANE).enumerate() {
                let mut sum = self.forward[i * height + v];
                for c in 0..n {
                    dense::add_scaled(&mut sum, -from[c], &columns[c * height + v]);
                }
                for (c, factor) in scalars.iter().enumerate() {
                    dense::add_scaled(&mut sum, -factor, &columns[(n + c) * height + v]);
                }
                for (value, sum) in to.iter_mut().zip(sum) {
                    *value = sum;
                }
            }
        }
    }

    /// Factorises the antisymmetric problem, with other right end rows and without scalar unknowns, integral and linear
    /// conditions. Borders are never pivots, so that up to its last block the elimination is the one at hand.
    ///
    /// # Errors
    /// A vanishing pivot in the last block.
    pub fn factor_antisymmetric(&self, right: EndRows<'_>, end: &mut AntisymmetricEnd) -> Result<(), PivotFailure> {
        let n = self.n;
        assert_eq!(self.nl + right.rows, n, "as many conditions as unknowns");
        let (fl, lanes) = (dense::lanes_for(n), self.panel_widths().lanes);
        let mut last = [[0.0; LANE]; MAX_UNKNOWNS * MAX_UNKNOWN_LANES];
        let last = &mut last[..n * fl];
        for k in 0..self.nl {
            let source = self.panel[(n + k) * lanes..(n + k + 1) * lanes].as_flattened();
            last[k * fl..(k + 1) * fl].as_flattened_mut()[..n].copy_from_slice(&source[n..2 * n]);
        }
        for k in 0..right.rows {
            let row = last[(self.nl + k) * fl..(self.nl + k + 1) * fl].as_flattened_mut();
            row[..n].copy_from_slice(&right.ry[k * n..(k + 1) * n]);
        }
        end.last.reset(1, n, n);
        dense::eliminate(last, fl, n, n, &mut end.last.write(0))
    }

    /// [`solve`](Self::solve) for the antisymmetric problem; of the solution only its last node if not `everywhere`.
    pub fn solve_antisymmetric(
        &mut self,
        kernels: &Kernels,
        end: &AntisymmetricEnd,
        nodes: &mut [f64],
        [left, right]: [&[f64]; 2],
        everywhere: bool,
    ) {
        let (mut carried, mut border) = ([0.0; MAX_UNKNOWNS], [0.0; MAX_UNKNOWNS]);
        let carried = &mut carried[..self.nl];
        carried.copy_from_slice(left);
        let nb = self.nb;
        (kernels.forward)(self, nodes, carried, &mut border[..nb]);
        self.solve_antisymmetric_end(end, carried, right, nodes);
        if everywhere {
            (kernels.backward)(self, nodes, &[]);
        }
    }

    /// [`solve_last`](Self::solve_last) for the antisymmetric problem.
    pub fn solve_antisymmetric_last(
        &mut self,
        kernels: &Kernels,
        end: &AntisymmetricEnd,
        nodes: &mut [f64],
        right: &[f64],
    ) {
        self.forward.fill([0.0; LANE]);
        self.solve_antisymmetric_end(end, &[0.0; MAX_UNKNOWNS][..self.nl], right, nodes);
        (kernels.backward)(self, nodes, &[]);
    }

    fn solve_antisymmetric_end(&self, end: &AntisymmetricEnd, carried: &[f64], right: &[f64], nodes: &mut [f64]) {
        let n = self.n;
        let mut x = [[0.0; LANE]; MAX_UNKNOWN_LANES];
        let y = x.as_flattened_mut();
        y[..self.nl].copy_from_slice(carried);
        y[self.nl..n].copy_from_slice(right);
        dense::solve_vector(end.last.read(0), n, &mut x);
        nodes[self.intervals * n..].copy_from_slice(&x.as_flattened()[..n]);
    }

    /// Multiplies the determinant of the antisymmetric problem into `det`.
    pub fn accumulate_antisymmetric(&self, end: &AntisymmetricEnd, det: &mut Determinant) {
        self.accumulate_pivots(det);
        end.last.accumulate_determinant(det);
    }

    /// Multiplies the determinant of the factorised matrix into `det`.
    pub fn accumulate_determinant(&self, det: &mut Determinant) {
        // Moving the right rows ahead of the border rows is a fixed permutation; its sign is left out.
        self.accumulate_pivots(det);
        self.last.accumulate_determinant(det);
    }

    fn accumulate_pivots(&self, det: &mut Determinant) {
        for (r, e) in self.reciprocal.chunks_exact(self.n).zip(self.exchange.chunks_exact(self.n)) {
            dense::accumulate_determinant(r, e, det);
        }
    }
}
