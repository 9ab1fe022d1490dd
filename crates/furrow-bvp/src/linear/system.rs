//! The linearised collocation system of a problem about a solution: residuals, factors, solves.

use crate::dense::{Determinant, PivotFailure, zeroed};
use crate::dimensions::{Dimensions, MAX_CONDITIONS, MAX_UNKNOWNS};
use crate::direction::{Direction, LinearCondition, Residual};
use crate::gauss::Gauss;
use crate::invalid::{self, InvalidInput, length};
use crate::kernels::{AntisymmetricEnd, BlockFactor, Condensed, EndJacobian, Kernels};
use crate::metric;
use crate::problem::{BoundaryJacobian, BoundaryValueProblem, CollocationPoints, PointJacobian};
use crate::solution::Solution;

/// Workspace for one problem shape: derivatives, condensed intervals, block factors. Reused from call to call; nothing
/// is allocated once it has seen the largest mesh.
///
/// A use is [`factorise`](Self::factorise) and any number of solves.
///
/// # Examples
/// Newton's method by hand, on u″ + λeᵘ = 0 with λ held at 1 by a linear condition. `Oscillator` is in
/// `examples/problems/oscillator.rs`.
///
/// ```
/// # mod oscillator { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/problems/oscillator.rs")); }
/// # use oscillator::Oscillator;
/// use furrow_bvp::{BoundaryValueProblem, Direction, LinearCondition, System, metric};
/// let mut problem = Oscillator::bratu();
/// let mut y = problem.zero(1.0, 10, 4, 1.0);
/// let mut conditions = vec![LinearCondition::default()];
/// metric::scalar_condition(&y, 0, 1.0, &mut conditions[0]);
/// let mut system = System::new(problem.dimensions(), y.m);
/// let mut step = Direction::default();
/// for _ in 0..5 {
///     system.factorise(&mut problem, &y, &conditions)?;
///     system.solve_own(&mut step)?;
///     step.apply(1.0, &mut y);
/// }
/// assert!(step.norm(&y) < 1e-12);
/// # Ok::<(), furrow_bvp::FactorisationError>(())
/// ```
#[derive(Clone, Debug)]
pub struct System {
    /// Collocation coefficients.
    pub gauss: Gauss,
    /// Condensed intervals of the last factorisation.
    pub(crate) condensed: Condensed,
    /// Residual of the last evaluation.
    pub residual: Residual,
    pub(crate) kernels: Kernels,
    pub(super) block: BlockFactor,
    pub(super) ends: EndJacobian,
    /// Mesh and collocation points of the last evaluation, and the integrands there.
    mesh: Vec<f64>,
    pub(super) places: Vec<f64>,
    pub(super) integrands: Vec<f64>,
    /// The derivatives have been evaluated.
    evaluated: bool,
    /// How far the newest factorisation has come.
    progress: Progress,
}

/// Why a linearised system has no factors.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum FactorisationError {
    /// Sizes do not fit each other, or an earlier step is missing.
    #[error(transparent)]
    Invalid(#[from] InvalidInput),
    /// The matrix is singular or not finite.
    #[error(transparent)]
    Pivot(#[from] PivotFailure),
}

/// Completed steps of a factorisation.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub(super) enum Progress {
    #[default]
    Nothing,
    Condensed,
    /// The rows of all intervals are eliminated, though the last block may be singular.
    Eliminated,
    Factored,
}

/// Sizes of a problem as errors name them.
const SIZES: [&str; 7] = [
    "components of the problem",
    "quadratures of the problem",
    "trailing quadratures of the problem",
    "scalars of the problem",
    "left conditions of the problem",
    "right conditions of the problem",
    "integral conditions of the problem",
];

impl System {
    /// Workspace for problems of the given sizes with m stages. Sizes that fail [`Dimensions::check`] are found where it is
    /// used, see [`check`](Self::check).
    pub fn new(dims: Dimensions, m: usize) -> System {
        let gauss = Gauss::nearest(m);
        System {
            condensed: Condensed::new(dims, gauss.m),
            gauss,
            residual: Residual::default(),
            kernels: Kernels::general(),
            block: BlockFactor::default(),
            ends: EndJacobian::default(),
            mesh: Vec::new(),
            places: Vec::new(),
            integrands: Vec::new(),
            evaluated: false,
            progress: Progress::Nothing,
        }
    }

    /// Checks that this workspace, a problem and a solution have the same sizes, and that these can be solved.
    ///
    /// # Errors
    /// [`InvalidInput`] names the first size that does not fit.
    pub fn check(&self, problem: &dyn BoundaryValueProblem, y: &Solution) -> Result<(), InvalidInput> {
        y.fits(self.dimensions())?;
        length("stages of the solution", y.m, self.gauss.m)?;
        let (theirs, own) = (problem.dimensions(), self.dimensions());
        let sizes = |d: Dimensions| {
            [d.components, d.quadratures, d.trailing_quadratures, d.scalars, d.left, d.right, d.integrals]
        };
        for (name, (theirs, own)) in SIZES.into_iter().zip(sizes(theirs).into_iter().zip(sizes(own))) {
            length(name, theirs, own)?;
        }
        Ok(())
    }

    /// Sizes of the problem this workspace is for.
    pub fn dimensions(&self) -> Dimensions {
        self.condensed.dims
    }

    /// Evaluates the residual of `problem` at `y`, and with `derivatives` also all derivatives.
    ///
    /// # Errors
    /// As [`check`](Self::check), and for more than [`MAX_CONDITIONS`] linear conditions. Older factors are then dropped.
    pub fn evaluate(
        &mut self,
        problem: &mut dyn BoundaryValueProblem,
        y: &Solution,
        conditions: &[LinearCondition],
        derivatives: bool,
    ) -> Result<(), InvalidInput> {
        (self.check(problem, y))
            .and_then(|()| invalid::at_most("linear conditions", conditions.len(), MAX_CONDITIONS))
            .inspect_err(|_| (self.evaluated, self.progress) = (false, Progress::Nothing))?;
        self.evaluate_checked(problem, y, conditions, derivatives);
        Ok(())
    }

    /// Evaluates `problem` at `y` with derivatives, and factorises it together with the linear conditions.
    ///
    /// # Errors
    /// As [`evaluate`](Self::evaluate), [`condense`](Self::condense) and [`factor_blocks`](Self::factor_blocks).
    pub fn factorise(
        &mut self,
        problem: &mut dyn BoundaryValueProblem,
        y: &Solution,
        conditions: &[LinearCondition],
    ) -> Result<(), FactorisationError> {
        self.evaluate(problem, y, conditions, true)?;
        self.condense()?;
        self.factor_blocks(conditions)
    }

    /// [`evaluate`](Self::evaluate) of sizes that are known to fit, but for scalar unknowns that the problem keeps to itself.
    pub(crate) fn evaluate_checked(
        &mut self,
        problem: &mut dyn BoundaryValueProblem,
        y: &Solution,
        conditions: &[LinearCondition],
        derivatives: bool,
    ) {
        problem.prepare(&y.scalars);
        self.kernels = problem.kernels(self.gauss.m).matching(self.condensed.dims, self.gauss.m);
        if derivatives {
            // Older factors may go on serving on as many intervals.
            if self.condensed.intervals() != y.intervals() {
                self.progress = Progress::Nothing;
            }
            self.condensed.reset(&y.mesh);
            self.evaluated = true;
        }
        self.evaluate_offsets(problem, y, conditions.len());
        self.evaluate_intervals(problem, y, derivatives);
        self.evaluate_ends(problem, y);
        let border = &mut self.residual.border[self.condensed.dims.integrals..];
        for (row, condition) in border.iter_mut().zip(conditions) {
            *row = metric::evaluate(condition, y) - condition.value;
        }
    }

    /// The parts h(p) of the integral conditions, with room for linear conditions behind them.
    fn evaluate_offsets(&mut self, problem: &dyn BoundaryValueProblem, y: &Solution, conditions: usize) {
        let (np, ni) = (self.dimensions().scalars, self.dimensions().integrals);
        let border = &mut self.residual.border;
        zeroed(border, ni + conditions);
        zeroed(&mut self.ends.offsets, ni * np);
        for k in 0..ni {
            border[k] = problem.integral_offset(k, &y.scalars, &mut self.ends.offsets[k * np..(k + 1) * np]);
        }
    }

    /// The collocation equations, and the integrals over the intervals.
    fn evaluate_intervals(&mut self, problem: &mut dyn BoundaryValueProblem, y: &Solution, derivatives: bool) {
        let dims = self.dimensions();
        let (n, m, ni) = (dims.components, self.gauss.m, dims.integrals);
        let intervals = y.intervals();
        let r = &mut self.residual;
        r.stages.resize(intervals * m * n, 0.0);
        r.nodes.resize(intervals * n, 0.0);
        self.integrands.resize(intervals * m * ni, 0.0);
        if self.mesh != y.mesh {
            self.mesh.clone_from(&y.mesh);
            self.places.clear();
            for interval in y.mesh.windows(2) {
                let h = interval[1] - interval[0];
                self.places.extend(self.gauss.c.iter().map(|c| interval[0] + h * c));
            }
        }
        problem.prepare_points(&self.places, &y.scalars);
        let (f, g) = (&mut r.stages[..], &mut self.integrands[..]);
        let points = CollocationPoints { first: 0, x: &self.places, y: &y.stages };
        if derivatives {
            f.fill(0.0);
            g.fill(0.0);
            let Condensed { fy, fp, gy, gp, .. } = &mut self.condensed;
            problem.rhs_jacobian_many(points, &y.scalars, &mut PointJacobian { f, fy, fp, g, gy, gp });
        } else {
            problem.rhs_many(points, &y.scalars, f, g);
        }
        for (k, sum) in r.border.iter_mut().enumerate().take(ni) {
            for (ends, g) in y.mesh.windows(2).zip(self.integrands.chunks_exact(m * ni)) {
                let h = ends[1] - ends[0];
                for (j, b) in self.gauss.b.iter().enumerate() {
                    *sum += h * b * g[j * ni + k];
                }
            }
        }
        (self.kernels.residuals)(&self.gauss, y, r);
    }

    /// The conditions at both ends and their derivatives.
    fn evaluate_ends(&mut self, problem: &dyn BoundaryValueProblem, y: &Solution) {
        let Dimensions { components: n, scalars: np, left, right, .. } = self.dimensions();
        let r = &mut self.residual;
        let ([ly, lp], [ry, rp]) = (&mut self.ends.left, &mut self.ends.right);
        for (v, size) in [(&mut r.left, left), (&mut *ly, left * n), (&mut *lp, left * np)] {
            zeroed(v, size);
        }
        for (v, size) in [(&mut r.right, right), (&mut *ry, right * n), (&mut *rp, right * np)] {
            zeroed(v, size);
        }
        let (first, last) = (y.node(0), y.node(y.intervals()));
        problem.left(first, &y.scalars, &mut BoundaryJacobian { r: &mut r.left, ry: ly, rp: lp });
        problem.right(last, &y.scalars, &mut BoundaryJacobian { r: &mut r.right, ry, rp });
    }

    /// Condenses all intervals from the derivatives of the last evaluation.
    ///
    /// # Errors
    /// If a pivot of a stage matrix vanishes, or no derivatives were evaluated.
    pub fn condense(&mut self) -> Result<(), FactorisationError> {
        self.progress = Progress::Nothing;
        self.require_derivatives()?;
        (self.kernels.condense)(&mut self.condensed, &self.gauss)?;
        self.progress = Progress::Condensed;
        Ok(())
    }

    /// ∂y(x_{i+1})/∂y(x_i) of the linearised differential equations with fixed scalar unknowns for every interval, each n × n,
    /// row-major, after [`condense`](Self::condense). Their product, from the last to the first, is ∂y(b)/∂y(a); for a periodic orbit
    /// that is the monodromy matrix.
    ///
    /// # Errors
    /// If the intervals are not condensed.
    pub fn transitions(&self) -> Result<Vec<Vec<f64>>, FactorisationError> {
        self.require(Progress::Condensed)?;
        let (n, outputs) = (self.dimensions().components, self.condensed.output_lanes());
        let of_interval = |i: usize| {
            let mut transition = vec![0.0; n * n];
            for (k, column) in self.condensed.transition(i).chunks_exact(outputs).take(n).enumerate() {
                column.as_flattened()[..n].iter().enumerate().for_each(|(row, entry)| transition[row * n + k] = *entry);
            }
            transition
        };
        Ok((0..self.condensed.intervals()).map(of_interval).collect())
    }

    /// Factorises the block system of the problem with the linear conditions, after [`condense`](Self::condense).
    ///
    /// # Errors
    /// If a pivot vanishes, if there are not as many conditions as unknowns, or if the intervals are not condensed.
    pub fn factor_blocks(&mut self, conditions: &[LinearCondition]) -> Result<(), FactorisationError> {
        self.require(Progress::Condensed)?;
        let dims = self.dimensions();
        length("linear conditions", conditions.len(), dims.linear_conditions())?;
        let nodes = (self.condensed.intervals() + 1) * dims.components;
        conditions.iter().try_for_each(|condition| condition.check(nodes, dims.scalars))?;
        self.progress = Progress::Condensed;
        let System { block, condensed, kernels, ends, .. } = self;
        block.begin(condensed, ends, conditions);
        (kernels.eliminate)(block, condensed, conditions)?;
        self.progress = Progress::Eliminated;
        block.factor_last(ends, conditions)?;
        self.progress = Progress::Factored;
        Ok(())
    }

    /// Checks that derivatives were evaluated.
    pub(super) fn require_derivatives(&self) -> Result<(), InvalidInput> {
        invalid::ready(self.evaluated, "evaluated with derivatives")
    }

    /// Checks that a step of the factorisation is completed.
    pub(super) fn require(&self, step: Progress) -> Result<(), InvalidInput> {
        let name = if step == Progress::Condensed { "condensed" } else { "factorised" };
        invalid::ready(self.progress >= step, name)
    }

    /// Checks that the factors of the problem, or of the antisymmetric problem with the given end, are complete.
    pub(super) fn require_factors(&self, end: Option<&AntisymmetricEnd>) -> Result<(), InvalidInput> {
        let Some(end) = end else { return self.require(Progress::Factored) };
        self.require(Progress::Eliminated)?;
        length("components of the factorised antisymmetric end", end.size(), self.dimensions().components)
    }

    /// Checks that the factors are complete and that a residual has their sizes.
    pub(super) fn check_residual(&self, end: Option<&AntisymmetricEnd>, r: &Residual) -> Result<(), InvalidInput> {
        self.require_factors(end)?;
        let Dimensions { components: n, left, right, .. } = self.dimensions();
        let intervals = self.condensed.intervals();
        length("stage rows of the residual", r.stages.len(), intervals * self.gauss.m * n)?;
        length("node rows of the residual", r.nodes.len(), intervals * n)?;
        length("left rows of the residual", r.left.len(), left)?;
        match end {
            Some(_) => length("right rows of the residual", r.right.len(), self.antisymmetric_conditions()),
            None => (length("right rows of the residual", r.right.len(), right))
                .and_then(|()| length("border rows of the residual", r.border.len(), self.block.borders())),
        }
    }

    /// Solves J δ = −residual with the factors of the last factorisation.
    ///
    /// # Errors
    /// [`InvalidInput`] if there are no factors, or the residual has other sizes.
    pub fn solve(&mut self, residual: &Residual, out: &mut Direction) -> Result<(), InvalidInput> {
        self.check_residual(None, residual)?;
        self.solve_everywhere(None, residual, out);
        Ok(())
    }

    /// The last node and the scalar unknowns alone of [`solve`](Self::solve), in their places in `out`.
    ///
    /// # Errors
    /// As [`solve`](Self::solve).
    pub fn solve_last_node(&mut self, residual: &Residual, out: &mut Direction) -> Result<(), InvalidInput> {
        self.check_residual(None, residual)?;
        self.solve_nodes(None, residual, out, false);
        Ok(())
    }

    /// The largest derivative by y of each condition at the left and at the right end; 1 if all are zero.
    pub(crate) fn scales_of_conditions(&self) -> [Vec<f64>; 2] {
        [&self.ends.left, &self.ends.right].map(|[by_y, _]| {
            let rows = by_y.chunks_exact(self.dimensions().components.max(1));
            let largest = rows.map(|row| row.iter().fold(0.0, |largest: f64, d| largest.max(d.abs())));
            largest.map(|size| if size > 0.0 { size } else { 1.0 }).collect()
        })
    }

    /// The nodes and scalars alone of [`solve`](Self::solve).
    pub(crate) fn solve_at_nodes(&mut self, residual: &Residual, out: &mut Direction) -> Result<(), InvalidInput> {
        self.check_residual(None, residual)?;
        self.solve_nodes(None, residual, out, true);
        Ok(())
    }

    /// Solves with the residual of the last evaluation.
    ///
    /// # Errors
    /// As [`solve`](Self::solve).
    pub fn solve_own(&mut self, out: &mut Direction) -> Result<(), InvalidInput> {
        let residual = std::mem::take(&mut self.residual);
        let solved = self.solve(&residual, out);
        self.residual = residual;
        solved
    }

    /// Solves J δ = e with e one in row `which` of the border (integral conditions first) and zero elsewhere.
    ///
    /// # Errors
    /// [`InvalidInput`] if there are no factors, or no such row.
    pub fn solve_unit(&mut self, which: usize, out: &mut Direction) -> Result<(), InvalidInput> {
        self.require_factors(None)?;
        invalid::index("row of the border", which, self.block.borders())?;
        let mut border = [0.0; MAX_UNKNOWNS];
        border[which] = 1.0;
        let right = &[0.0; MAX_UNKNOWNS][..self.dimensions().right];
        self.solve_from_last(None, [right, &border[..self.block.borders()]], out);
        Ok(())
    }

    /// Solves J d = 0 with linear condition `which` raised by 1.
    ///
    /// # Errors
    /// [`InvalidInput`] if there are no factors, or no such condition.
    pub fn null_direction(&mut self, which: usize, out: &mut Direction) -> Result<(), InvalidInput> {
        self.solve_unit(self.dimensions().integrals.saturating_add(which), out)
    }

    /// Solves for right-hand sides that are zero but for [right, border] conditions, of the antisymmetric problem if its end
    /// is given.
    pub(super) fn solve_from_last(
        &mut self,
        end: Option<&AntisymmetricEnd>,
        [right, border]: [&[f64]; 2],
        out: &mut Direction,
    ) {
        let Dimensions { components: n, scalars, left, .. } = self.dimensions();
        zeroed(&mut out.nodes, (self.condensed.intervals() + 1) * n);
        zeroed(&mut out.stages, self.condensed.intervals() * self.gauss.m * n);
        zeroed(&mut out.scalars, scalars);
        self.block.forward_zero();
        self.substitute(end, [&[0.0; MAX_UNKNOWNS][..left], right, border], out, true);
        (self.kernels.complete)(&self.condensed, &self.gauss, out);
    }

    /// Solves for all unknowns, of the antisymmetric problem if its end is given.
    pub(super) fn solve_everywhere(
        &mut self,
        end: Option<&AntisymmetricEnd>,
        residual: &Residual,
        out: &mut Direction,
    ) {
        self.solve_nodes(end, residual, out, true);
        (self.kernels.complete)(&self.condensed, &self.gauss, out);
    }

    /// Nodes (only the last if not `everywhere`), scalars and particular stage values for a residual, of the antisymmetric
    /// problem if its end is given.
    pub(super) fn solve_nodes(
        &mut self,
        end: Option<&AntisymmetricEnd>,
        residual: &Residual,
        out: &mut Direction,
        everywhere: bool,
    ) {
        let Dimensions { components: n, scalars, integrals, .. } = self.dimensions();
        let intervals = self.condensed.intervals();
        out.nodes.resize((intervals + 1) * n, 0.0);
        out.stages.resize(intervals * self.gauss.m * n, 0.0);
        zeroed(&mut out.scalars, scalars);
        let negated = |from: &[f64]| {
            let mut to = [0.0; MAX_UNKNOWNS];
            to.iter_mut().zip(from).for_each(|(to, from)| *to = -from);
            to
        };
        let (mut left, right) = (negated(&residual.left), negated(&residual.right));
        let (mut border, integrals) =
            if end.is_some() { ([0.0; MAX_UNKNOWNS], 0) } else { (negated(&residual.border), integrals) };
        (self.kernels.particular)(&self.condensed, &self.gauss, residual, out, &mut border[..integrals]);
        let (left, border) = (&mut left[..residual.left.len()], &mut border[..self.block.borders()]);
        (self.kernels.forward)(&mut self.block, &out.nodes, left, border);
        let border = if end.is_some() { &[] } else { &*border };
        self.substitute(end, [left, &right[..residual.right.len()], border], out, everywhere);
    }

    /// The last block for forward-eliminated right-hand sides [carried, right, border], and back substitution from there.
    fn substitute(
        &mut self,
        end: Option<&AntisymmetricEnd>,
        sides: [&[f64]; 3],
        out: &mut Direction,
        everywhere: bool,
    ) {
        // The antisymmetric problem has no scalar unknowns.
        let scalars = if end.is_some() { &mut [] } else { &mut out.scalars[..] };
        self.block.solve_last(end, sides, &mut out.nodes, scalars);
        if everywhere {
            (self.kernels.backward)(&mut self.block, &mut out.nodes, scalars);
        }
    }

    /// Determinant of the full factorised system; one of sign 0 if there are no factors.
    pub fn determinant(&self) -> Determinant {
        self.determinant_with(None)
    }

    pub(super) fn determinant_with(&self, end: Option<&AntisymmetricEnd>) -> Determinant {
        let mut det = Determinant::default();
        if self.progress < Progress::Eliminated {
            return Determinant { sign: 0.0, log_abs: f64::NAN };
        }
        self.condensed.multiply_into(&mut det);
        self.block.multiply_into(end, &mut det);
        det
    }

    /// A zero residual of the right shape for the mesh of the last evaluation, to be filled as a right-hand side.
    pub fn zero_residual(&self) -> Residual {
        let mut zero = Residual::default();
        self.zero_residual_into(&mut zero);
        zero
    }

    /// [`zero_residual`](Self::zero_residual) into storage that is reused.
    pub fn zero_residual_into(&self, zero: &mut Residual) {
        let Residual { stages, nodes, left, right, border } = &self.residual;
        zero.reset([stages, nodes, left, right, border].map(Vec::len));
    }
}
