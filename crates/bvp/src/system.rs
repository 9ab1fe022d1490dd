//! The linearised collocation system of a problem about a solution: residuals, factors, solves.

use crate::block::{AntisymmetricEnd, BlockFactor, Conditions, EndRows, LinearForm};
use crate::condense::Condensed;
use crate::dense::{Determinant, PivotFailure, zeroed};
use crate::gauss::{Gauss, MAX_STAGES};
use crate::kernels::Kernels;
use crate::metric;
use crate::problem::{
    BoundaryJacobian, BoundaryValueProblem, CollocationPoints, Dimensions, MAX_CONDITIONS, MAX_UNKNOWNS,
};
use crate::stages::Interval;
use crate::{Direction, LinearCondition, Solution};

/// Residuals of all equations; also serves as a general right-hand side (the system solved is J δ = −residual).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Residual {
    /// Σ_k D_jk (Y_k − y₀) − h f(Y_j); N × m × n.
    pub stages: Vec<f64>,
    /// y₀ + Σ d_j (Y_j − y₀) − y₁; N × n.
    pub nodes: Vec<f64>,
    /// Left conditions.
    pub left: Vec<f64>,
    /// Right conditions.
    pub right: Vec<f64>,
    /// Integral conditions, then linear conditions.
    pub border: Vec<f64>,
}

/// Workspace for one problem shape: derivatives, condensed intervals, block factors. Reused from call to call; nothing
/// is allocated once it has seen the largest mesh.
///
/// A use is [`evaluate`](Self::evaluate), [`condense`](Self::condense), [`factor_blocks`](Self::factor_blocks) and any
/// number of solves.
///
/// # Examples
/// Newton's method by hand, on u″ + λeᵘ = 0 with λ held at 1 by a linear condition. `Oscillator` is in
/// `examples/problems/oscillator.rs`.
///
/// ```
/// # mod oscillator { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/problems/oscillator.rs")); }
/// # use oscillator::Oscillator;
/// use bvp::{BoundaryValueProblem, Direction, LinearCondition, System, metric};
/// let mut problem = Oscillator { force: |u| [u.exp(); 4], right: 0 };
/// let mut y = problem.zero(1.0, 10, 4, 1.0);
/// let mut conditions = vec![LinearCondition::default()];
/// metric::scalar_condition(&y, 0, 1.0, &mut conditions[0]);
/// let mut system = System::new(problem.dimensions(), y.m);
/// let mut step = Direction::default();
/// for _ in 0..5 {
///     system.evaluate(&mut problem, &y, &conditions, true);
///     system.condense()?;
///     system.factor_blocks(&conditions)?;
///     system.solve_own(&mut step);
///     step.apply(1.0, &mut y);
/// }
/// assert!(step.norm(&y) < 1e-12);
/// # Ok::<(), bvp::PivotFailure>(())
/// ```
#[derive(Clone, Debug)]
pub struct System {
    /// Collocation coefficients.
    pub gauss: Gauss,
    /// Condensed intervals of the last factorisation.
    pub(crate) condensed: Condensed,
    /// Residual of the last evaluation.
    pub residual: Residual,
    kernels: Kernels,
    block: BlockFactor,
    ends: Ends,
    borders: Vec<f64>,
    /// Collocation points of the last evaluation, and the integrands there.
    places: Vec<f64>,
    integrands: Vec<f64>,
}

#[derive(Clone, Debug, Default)]
struct Ends {
    ly: Vec<f64>,
    lp: Vec<f64>,
    ry: Vec<f64>,
    rp: Vec<f64>,
    hp: Vec<f64>,
}

impl System {
    /// Workspace for problems of the given sizes with m stages.
    ///
    /// # Panics
    /// If [`Dimensions::check`] refuses the sizes.
    pub fn new(dims: Dimensions, m: usize) -> System {
        if let Err(error) = dims.check(m) {
            panic!("{error}");
        }
        System {
            gauss: Gauss::new(m),
            condensed: Condensed::new(dims, m),
            residual: Residual::default(),
            kernels: Kernels::general(),
            block: BlockFactor::default(),
            ends: Ends::default(),
            borders: Vec::new(),
            places: Vec::new(),
            integrands: Vec::new(),
        }
    }

    /// Sizes of the problem this workspace is for.
    pub fn dimensions(&self) -> Dimensions {
        self.condensed.layout.dims
    }

    /// Evaluates the residual of `problem` at `y`, and with `derivatives` also all derivatives.
    pub fn evaluate<P: BoundaryValueProblem>(
        &mut self,
        problem: &mut P,
        y: &Solution,
        conditions: &[LinearCondition],
        derivatives: bool,
    ) {
        problem.prepare(&y.scalars);
        self.kernels = problem.kernels(self.gauss.m).suited_to(&self.condensed.layout);
        if derivatives {
            self.condensed.reset(&y.mesh);
        }
        self.evaluate_offsets(problem, y, conditions.len());
        self.evaluate_intervals(problem, y, derivatives);
        self.evaluate_ends(problem, y);
        let border = &mut self.residual.border[self.condensed.layout.dims.integrals..];
        for (row, condition) in border.iter_mut().zip(conditions) {
            *row = metric::evaluate(condition, y) - condition.value;
        }
    }

    /// The parts h(p) of the integral conditions, with room for linear conditions behind them.
    fn evaluate_offsets<P: BoundaryValueProblem>(&mut self, problem: &P, y: &Solution, conditions: usize) {
        let (np, ni) = (self.dimensions().scalars, self.dimensions().integrals);
        let border = &mut self.residual.border;
        zeroed(border, ni + conditions);
        zeroed(&mut self.ends.hp, ni * np);
        for k in 0..ni {
            border[k] = problem.integral_offset(k, &y.scalars, &mut self.ends.hp[k * np..(k + 1) * np]);
        }
    }

    /// The collocation equations, and the integrals over the intervals.
    fn evaluate_intervals<P: BoundaryValueProblem>(&mut self, problem: &P, y: &Solution, derivatives: bool) {
        let dims = self.dimensions();
        let (n, m, ni) = (dims.components, self.gauss.m, dims.integrals);
        let intervals = y.intervals();
        let r = &mut self.residual;
        r.stages.resize(intervals * m * n, 0.0);
        r.nodes.resize(intervals * n, 0.0);
        self.integrands.resize(intervals * m * ni, 0.0);
        self.places.clear();
        for interval in y.mesh.windows(2) {
            let h = interval[1] - interval[0];
            self.places.extend(self.gauss.c.iter().map(|c| interval[0] + h * c));
        }
        let (f, g) = (&mut r.stages[..], &mut self.integrands[..]);
        let points = CollocationPoints { first: 0, x: &self.places, y: &y.stages };
        if derivatives {
            f.fill(0.0);
            g.fill(0.0);
            problem.rhs_jacobian_many(points, &y.scalars, &mut self.condensed.jacobian(f, g));
        } else {
            problem.rhs_many(points, &y.scalars, f, g);
        }
        for i in 0..intervals {
            let h = y.mesh[i + 1] - y.mesh[i];
            for j in 0..m {
                for k in 0..ni {
                    r.border[k] += h * self.gauss.b[j] * self.integrands[(i * m + j) * ni + k];
                }
            }
            let range = i * m * n..(i + 1) * m * n;
            let rows = &mut r.stages[range.clone()];
            for row in rows.iter_mut() {
                *row *= -h;
            }
            let interval = Interval { left: y.node(i), stages: &y.stages[range], right: y.node(i + 1) };
            (self.kernels.differences)(&self.gauss, interval, rows, &mut r.nodes[i * n..(i + 1) * n]);
        }
    }

    /// The conditions at both ends and their derivatives.
    fn evaluate_ends<P: BoundaryValueProblem>(&mut self, problem: &P, y: &Solution) {
        let dims = self.dimensions();
        let (n, np) = (dims.components, dims.scalars);
        let (r, e) = (&mut self.residual, &mut self.ends);
        zeroed(&mut r.left, dims.left);
        zeroed(&mut r.right, dims.right);
        zeroed(&mut e.ly, dims.left * n);
        zeroed(&mut e.lp, dims.left * np);
        zeroed(&mut e.ry, dims.right * n);
        zeroed(&mut e.rp, dims.right * np);
        let (first, last) = (y.node(0), y.node(y.intervals()));
        problem.left(first, &y.scalars, &mut BoundaryJacobian { r: &mut r.left, ry: &mut e.ly, rp: &mut e.lp });
        problem.right(last, &y.scalars, &mut BoundaryJacobian { r: &mut r.right, ry: &mut e.ry, rp: &mut e.rp });
    }

    /// Condenses all intervals from the derivatives of the last evaluation.
    pub fn condense(&mut self) -> Result<(), PivotFailure> {
        (self.kernels.condense)(&mut self.condensed, &self.gauss)
    }

    /// Factorises the block system of the problem itself, after [`condense`](Self::condense).
    pub fn factor_blocks(&mut self, conditions: &[LinearCondition]) -> Result<(), PivotFailure> {
        let dims = self.dimensions();
        let e = &self.ends;
        // At most a handful of linear conditions: the small vector of views lives on the stack.
        let mut forms = [LinearForm { nodes: &[], scalars: &[] }; MAX_CONDITIONS];
        for (form, c) in forms.iter_mut().zip(conditions) {
            *form = LinearForm { nodes: &c.nodes, scalars: &c.scalars };
        }
        let conditions = Conditions {
            left: EndRows { ry: &e.ly, rp: &e.lp, rows: dims.left },
            right: EndRows { ry: &e.ry, rp: &e.rp, rows: dims.right },
            offsets: &e.hp,
            forms: &forms[..conditions.len()],
        };
        self.block.factor(&self.kernels, &self.condensed, &conditions)
    }

    /// Solves J δ = −residual with the factors at hand.
    pub fn solve(&mut self, residual: &Residual, out: &mut Direction) {
        self.particular(residual, out, true);
        let System { block, borders, kernels, .. } = self;
        // End rows with their signs turned, in the scratch behind the border entries.
        let ni = borders.len();
        borders.extend(residual.left.iter().map(|v| -v));
        borders.extend(residual.right.iter().map(|v| -v));
        let (border, ends) = borders.split_at(ni);
        let (left, right) = ends.split_at(residual.left.len());
        block.solve(kernels, &mut out.nodes, [left, right, border], &mut out.scalars);
        self.complete(out);
    }

    /// Solves with the residual of the last evaluation.
    pub fn solve_own(&mut self, out: &mut Direction) {
        let residual = std::mem::take(&mut self.residual);
        self.solve(&residual, out);
        self.residual = residual;
    }

    /// Solves J δ = e with e one in row `which` of the border (integral conditions first) and zero elsewhere.
    pub fn solve_unit(&mut self, which: usize, out: &mut Direction) {
        let dims = self.dimensions();
        let rows = dims.integrals + dims.missing_conditions().max(0) as usize;
        zeroed(&mut self.borders, rows + dims.right);
        self.borders[which] = 1.0;
        let (border, right) = self.borders.split_at(rows);
        zeroed(&mut out.nodes, (self.condensed.intervals() + 1) * dims.components);
        zeroed(&mut out.stages, self.condensed.intervals() * self.gauss.m * dims.components);
        zeroed(&mut out.scalars, dims.scalars);
        self.block.solve_last(&self.kernels, &mut out.nodes, [right, border], &mut out.scalars);
        self.complete(out);
    }

    /// Particular stage values and node constants for a residual; border right-hand sides into the scratch.
    fn particular(&mut self, residual: &Residual, out: &mut Direction, with_border: bool) {
        let dims = self.dimensions();
        let (n, m) = (dims.components, self.gauss.m);
        let intervals = self.condensed.intervals();
        out.nodes.resize((intervals + 1) * n, 0.0);
        out.stages.resize(intervals * m * n, 0.0);
        zeroed(&mut out.scalars, dims.scalars);
        self.borders.clear();
        if with_border {
            self.borders.extend(residual.border.iter().map(|v| -v));
        }
        let integrals = if with_border { dims.integrals } else { 0 };
        let borders = &mut self.borders[..integrals];
        (self.kernels.particular)(&self.condensed, &self.gauss, residual, out, borders);
    }

    fn complete(&mut self, out: &mut Direction) {
        (self.kernels.complete)(&self.condensed, out);
    }

    /// Factorises the antisymmetric problem that belongs to the factorised one on a mirror-symmetric half: the same
    /// intervals and left conditions, the components in `vanishing` zero at the mirror in place of the right conditions, and
    /// neither scalar unknowns nor integral conditions. The determinant includes the stages.
    ///
    /// # Errors
    /// A pivot that is not finite; one that is zero makes the determinant zero.
    pub fn factor_antisymmetric(
        &self,
        vanishing: &[usize],
        end: &mut AntisymmetricEnd,
    ) -> Result<Determinant, PivotFailure> {
        let eliminated = self.eliminate_antisymmetric(vanishing, end);
        self.antisymmetric_determinant(eliminated, end)
    }

    /// The same without the determinant, which takes a logarithm for every pivot.
    ///
    /// # Errors
    /// A pivot that is zero or not finite.
    pub fn eliminate_antisymmetric(&self, vanishing: &[usize], end: &mut AntisymmetricEnd) -> Result<(), PivotFailure> {
        let n = self.dimensions().components;
        let mut rows = std::mem::take(&mut end.rows);
        zeroed(&mut rows, vanishing.len() * n);
        for (k, &component) in vanishing.iter().enumerate() {
            rows[k * n + component] = 1.0;
        }
        let result = self.block.factor_antisymmetric(EndRows { ry: &rows, rp: &[], rows: vanishing.len() }, end);
        end.rows = rows;
        result
    }

    /// [`factor_antisymmetric`](Self::factor_antisymmetric) for any right end rows, as tests hold it against dense matrices.
    #[cfg(test)]
    pub(crate) fn factor_antisymmetric_rows(
        &self,
        right: EndRows<'_>,
        end: &mut AntisymmetricEnd,
    ) -> Result<Determinant, PivotFailure> {
        let eliminated = self.block.factor_antisymmetric(right, end);
        self.antisymmetric_determinant(eliminated, end)
    }

    /// The determinant of the antisymmetric problem whose elimination ended so.
    fn antisymmetric_determinant(
        &self,
        eliminated: Result<(), PivotFailure>,
        end: &AntisymmetricEnd,
    ) -> Result<Determinant, PivotFailure> {
        let mut det = Determinant::default();
        self.condensed.accumulate_determinant(&mut det);
        self.block.accumulate_antisymmetric(end, &mut det);
        match eliminated {
            Ok(()) => Ok(det),
            // Exactly singular in the last block: the zero itself.
            Err(failure) if !failure.non_finite => Ok(Determinant { sign: 0.0, log_abs: f64::NEG_INFINITY }),
            Err(failure) => Err(failure),
        }
    }

    /// Adds J δ to `out`, J being the antisymmetric problem where the system was evaluated last with derivatives, whatever factors
    /// are at hand: what is left of a residual after a correction with older ones.
    pub fn apply_antisymmetric(&mut self, end: &AntisymmetricEnd, direction: &Direction, out: &mut Residual) {
        let (n, m) = (self.dimensions().components, self.gauss.m);
        let mut scratch = [0.0; (MAX_STAGES + 1) * MAX_UNKNOWNS];
        let (rows, node) = scratch[..(m + 1) * n].split_at_mut(m * n);
        for (i, h) in self.condensed.h.iter().enumerate() {
            let stages = &direction.stages[i * m * n..(i + 1) * m * n];
            for (j, (rows, y)) in rows.chunks_exact_mut(n).zip(stages.chunks_exact(n)).enumerate() {
                let f = self.condensed.fy[(i * m + j) * n * n..(i * m + j + 1) * n * n].chunks_exact(n);
                for (row, f) in rows.iter_mut().zip(f) {
                    *row = -h * product(f, y);
                }
            }
            let [left, right] = [i, i + 1].map(|k| &direction.nodes[k * n..(k + 1) * n]);
            (self.kernels.differences)(&self.gauss, Interval { left, stages, right }, rows, node);
            add(&mut out.stages[i * m * n..(i + 1) * m * n], rows);
            add(&mut out.nodes[i * n..(i + 1) * n], node);
        }
        let (first, last) = (&direction.nodes[..n], &direction.nodes[direction.nodes.len() - n..]);
        for (rows, y, out) in [(&self.ends.ly, first, &mut out.left), (&end.rows, last, &mut out.right)] {
            out.iter_mut().zip(rows.chunks_exact(n)).for_each(|(out, row)| *out += product(row, y));
        }
    }

    /// Solves the antisymmetric problem factorised by [`factor_antisymmetric`](Self::factor_antisymmetric) for stage and
    /// node residuals and right-hand sides of its end rows.
    pub fn solve_antisymmetric(&mut self, end: &AntisymmetricEnd, residual: &Residual, out: &mut Direction) {
        self.solve_antisymmetric_nodes(end, residual, out, true);
        self.complete(out);
    }

    /// The last node alone of [`solve_antisymmetric`](Self::solve_antisymmetric), in its place in `out`.
    pub fn solve_antisymmetric_last_node(&mut self, end: &AntisymmetricEnd, residual: &Residual, out: &mut Direction) {
        self.solve_antisymmetric_nodes(end, residual, out, false);
    }

    fn solve_antisymmetric_nodes(
        &mut self,
        end: &AntisymmetricEnd,
        residual: &Residual,
        out: &mut Direction,
        everywhere: bool,
    ) {
        self.particular(residual, out, false);
        let System { block, borders, kernels, .. } = self;
        borders.extend(residual.left.iter().chain(&residual.right).map(|v| -v));
        let (left, right) = borders.split_at(residual.left.len());
        block.solve_antisymmetric(kernels, end, &mut out.nodes, [left, right], everywhere);
    }

    /// The solution of the antisymmetric problem for right-hand sides that are zero but for `right` of its right end rows.
    pub fn solve_antisymmetric_unit(&mut self, end: &AntisymmetricEnd, right: &[f64], out: &mut Direction) {
        let dims = self.dimensions();
        zeroed(&mut out.nodes, (self.condensed.intervals() + 1) * dims.components);
        zeroed(&mut out.stages, self.condensed.intervals() * self.gauss.m * dims.components);
        zeroed(&mut out.scalars, dims.scalars);
        self.block.solve_antisymmetric_last(&self.kernels, end, &mut out.nodes, right);
        self.complete(out);
    }

    /// Determinant of the full factorised system.
    pub fn determinant(&self) -> Determinant {
        let mut det = Determinant::default();
        self.condensed.accumulate_determinant(&mut det);
        self.block.accumulate_determinant(&mut det);
        det
    }

    /// A zero residual of the right shape for the mesh of the last evaluation, to be filled as a right-hand side.
    pub fn zero_residual(&self) -> Residual {
        let mut zero = Residual::default();
        self.zero_residual_into(&mut zero);
        zero
    }

    /// The same, into one at hand.
    pub fn zero_residual_into(&self, zero: &mut Residual) {
        let like = &self.residual;
        for (to, from) in [
            (&mut zero.stages, &like.stages),
            (&mut zero.nodes, &like.nodes),
            (&mut zero.left, &like.left),
            (&mut zero.right, &like.right),
            (&mut zero.border, &like.border),
        ] {
            zeroed(to, from.len());
        }
    }
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn add(to: &mut [f64], terms: &[f64]) {
    to.iter_mut().zip(terms).for_each(|(to, term)| *to += term);
}
