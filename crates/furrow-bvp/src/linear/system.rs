//! The linearised collocation system of a problem about a solution: residuals, factors, solves.

use crate::dense::{Determinant, PivotFailure, zeroed};
use crate::dimensions::{Dimensions, MAX_CONDITIONS, MAX_UNKNOWNS};
use crate::direction::{Direction, LinearCondition, Residual};
use crate::gauss::{Gauss, MAX_STAGES};
use crate::invalid::{InvalidInput, length};
use crate::kernels::{AntisymmetricEnd, BlockFactor, Condensed, EndJacobian, Interval, Kernels};
use crate::metric;
use crate::problem::{BoundaryJacobian, BoundaryValueProblem, CollocationPoints, PointJacobian};
use crate::solution::Solution;

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
/// # use oscillator::{Force, Oscillator};
/// use furrow_bvp::{BoundaryValueProblem, Direction, LinearCondition, System, metric};
/// let mut problem = Oscillator { force: Force::Of(|u| [u.exp(); 4]), right: 0 };
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
/// # Ok::<(), furrow_bvp::PivotFailure>(())
/// ```
#[derive(Clone, Debug)]
pub struct System {
    /// Collocation coefficients.
    pub gauss: Gauss,
    /// Condensed intervals of the last factorisation.
    pub(crate) condensed: Condensed,
    /// Residual of the last evaluation.
    pub residual: Residual,
    pub(super) kernels: Kernels,
    pub(super) block: BlockFactor,
    ends: EndJacobian,
    /// Collocation points of the last evaluation, and the integrands there.
    places: Vec<f64>,
    integrands: Vec<f64>,
    /// Derivatives were evaluated at what fits.
    evaluated: bool,
    /// How far the newest factorisation has come.
    pub(super) stage: Progress,
}

/// Steps of a factorisation that are done. What needs more than is done gives no numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub(super) enum Progress {
    #[default]
    Nothing,
    Condensed,
    /// The rows of all intervals are eliminated, though the last block may be singular.
    Eliminated,
    Factored,
}

/// A value of the equations, counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Place {
    /// A component of the right-hand side.
    #[error("component {component} of the right-hand side at x = {x}")]
    Rhs {
        /// The component.
        component: usize,
        /// Where.
        x: f64,
    },
    /// A derivative of a component of the right-hand side.
    #[error("a derivative of component {component} of the right-hand side at x = {x}")]
    RhsDerivative {
        /// The component.
        component: usize,
        /// Where.
        x: f64,
    },
    /// A condition at the left end, or a derivative of it.
    #[error("condition {index} at the left end")]
    Left {
        /// The condition.
        index: usize,
    },
    /// A condition at the right end, or a derivative of it.
    #[error("condition {index} at the right end")]
    Right {
        /// The condition.
        index: usize,
    },
    /// An integrand, or a derivative of it.
    #[error("integrand {index} at x = {x}")]
    Integrand {
        /// The integral condition.
        index: usize,
        /// Where.
        x: f64,
    },
    /// The part of an integral condition that depends on the scalar unknowns alone, or a derivative of it.
    #[error("integral condition {index}")]
    Integral {
        /// The condition.
        index: usize,
    },
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

/// A missing pivot is not finite.
const NO_MATRIX: PivotFailure = PivotFailure { column: 0, non_finite: true };

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
            places: Vec::new(),
            integrands: Vec::new(),
            evaluated: false,
            stage: Progress::Nothing,
        }
    }

    /// Checks that this workspace, a problem and a solution have the same sizes, and that these can be solved.
    ///
    /// # Errors
    /// [`InvalidInput`] names the first size that does not fit.
    pub fn check<P: BoundaryValueProblem>(&self, problem: &P, y: &Solution) -> Result<(), InvalidInput> {
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
    /// What fails [`check`](Self::check) is not evaluated: factorisations then fail, and solves give NaN.
    pub fn evaluate<P: BoundaryValueProblem>(
        &mut self,
        problem: &mut P,
        y: &Solution,
        conditions: &[LinearCondition],
        derivatives: bool,
    ) {
        if self.check(problem, y).is_err() || conditions.len() > MAX_CONDITIONS {
            (self.evaluated, self.stage) = (false, Progress::Nothing);
            return;
        }
        self.evaluate_checked(problem, y, conditions, derivatives);
    }

    /// [`evaluate`](Self::evaluate) of sizes that are known to fit, but for scalar unknowns that the problem keeps to itself.
    pub(crate) fn evaluate_checked<P: BoundaryValueProblem>(
        &mut self,
        problem: &mut P,
        y: &Solution,
        conditions: &[LinearCondition],
        derivatives: bool,
    ) {
        problem.prepare(&y.scalars);
        self.kernels = problem.kernels(self.gauss.m).suited_to(self.condensed.dims, self.gauss.m);
        if derivatives {
            // Older factors may go on serving on as many intervals.
            if self.condensed.intervals() != y.intervals() {
                self.stage = Progress::Nothing;
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

    /// The first value of the last evaluation that is not finite.
    pub(crate) fn undefined(&self) -> Option<Place> {
        let Dimensions { components: n, scalars: np, integrals: ni, .. } = self.dimensions();
        let first = |values: &[f64]| values.iter().position(|v| !v.is_finite());
        let at = |equation: usize, width: usize, values: &[f64], part: fn(usize, f64) -> Place| {
            let index = first(values)? / width.max(1);
            let x = self.places.get(index / equation.max(1)).copied().unwrap_or(f64::NAN);
            Some(part(index % equation.max(1), x))
        };
        let Residual { stages, left, right, border, .. } = &self.residual;
        let Condensed { fy, fp, gy, gp, .. } = &self.condensed;
        let ends = &self.ends;
        let condition = |parts: [(&[f64], usize); 3], place: fn(usize) -> Place| {
            parts.into_iter().find_map(|(values, width)| first(values).map(|index| place(index / width.max(1))))
        };
        at(n, 1, stages, |component, x| Place::Rhs { component, x })
            .or_else(|| condition([(left, 1), (&ends.left[0], n), (&ends.left[1], np)], |index| Place::Left { index }))
            .or_else(|| {
                condition([(right, 1), (&ends.right[0], n), (&ends.right[1], np)], |index| Place::Right { index })
            })
            .or_else(|| at(ni, 1, &self.integrands, |index, x| Place::Integrand { index, x }))
            .or_else(|| {
                condition([(border.get(..ni).unwrap_or_default(), 1), (&ends.offsets, np), (&[], 1)], |index| {
                    Place::Integral { index }
                })
            })
            .or_else(|| at(n, n, fy, |component, x| Place::RhsDerivative { component, x }))
            .or_else(|| at(n, np, fp, |component, x| Place::RhsDerivative { component, x }))
            .or_else(|| at(ni, n, gy, |index, x| Place::Integrand { index, x }))
            .or_else(|| at(ni, np, gp, |index, x| Place::Integrand { index, x }))
    }

    /// The parts h(p) of the integral conditions, with room for linear conditions behind them.
    fn evaluate_offsets<P: BoundaryValueProblem>(&mut self, problem: &P, y: &Solution, conditions: usize) {
        let (np, ni) = (self.dimensions().scalars, self.dimensions().integrals);
        let border = &mut self.residual.border;
        zeroed(border, ni + conditions);
        zeroed(&mut self.ends.offsets, ni * np);
        for k in 0..ni {
            border[k] = problem.integral_offset(k, &y.scalars, &mut self.ends.offsets[k * np..(k + 1) * np]);
        }
    }

    /// The collocation equations, and the integrals over the intervals.
    fn evaluate_intervals<P: BoundaryValueProblem>(&mut self, problem: &mut P, y: &Solution, derivatives: bool) {
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
    /// If a pivot of a stage matrix vanishes.
    pub fn condense(&mut self) -> Result<(), PivotFailure> {
        self.stage = Progress::Nothing;
        if !self.evaluated {
            return Err(NO_MATRIX);
        }
        (self.kernels.condense)(&mut self.condensed, &self.gauss)?;
        self.stage = Progress::Condensed;
        Ok(())
    }

    /// Factorises the block system of the problem with the linear conditions, after [`condense`](Self::condense).
    ///
    /// # Errors
    /// If a pivot vanishes, or if there are not as many conditions as unknowns.
    pub fn factor_blocks(&mut self, conditions: &[LinearCondition]) -> Result<(), PivotFailure> {
        let Dimensions { components: n, scalars, .. } = self.dimensions();
        let nodes = (self.condensed.intervals() + 1) * n;
        let fits = |c: &LinearCondition| c.nodes.len() == nodes && c.scalars.len() == scalars;
        let square = isize::try_from(conditions.len()) == Ok(self.dimensions().missing_conditions());
        if self.stage < Progress::Condensed || !square || !conditions.iter().all(fits) {
            return Err(NO_MATRIX);
        }
        self.stage = Progress::Condensed;
        let System { block, condensed, kernels, ends, .. } = self;
        block.begin(condensed, ends, conditions);
        (kernels.eliminate)(block, condensed, conditions)?;
        self.stage = Progress::Eliminated;
        block.factor_last(ends, conditions)?;
        self.stage = Progress::Factored;
        Ok(())
    }

    /// Whether the factors are there and what they are used for `fits` them; if not, `out` is NaN.
    fn is_factored(&self, needed: Progress, fits: bool, out: &mut Direction) -> bool {
        let Dimensions { components: n, scalars, .. } = self.dimensions();
        let there = fits && self.stage >= needed;
        if !there {
            let intervals = self.condensed.intervals();
            for (values, len) in [
                (&mut out.nodes, (intervals + 1).saturating_mul(n.min(MAX_UNKNOWNS))),
                (&mut out.stages, intervals * self.gauss.m * n.min(MAX_UNKNOWNS)),
                (&mut out.scalars, scalars.min(MAX_UNKNOWNS)),
            ] {
                values.clear();
                values.resize(len, f64::NAN);
            }
        }
        there
    }

    /// [`is_factored`](Self::is_factored) for a residual with `right` conditions at the right end.
    fn can_solve(
        &self,
        end: Option<&AntisymmetricEnd>,
        residual: &Residual,
        right: usize,
        out: &mut Direction,
    ) -> bool {
        let Dimensions { components: n, left, .. } = self.dimensions();
        let intervals = self.condensed.intervals();
        let Residual { stages, nodes, left: at_left, right: at_right, .. } = residual;
        let lengths = [stages.len(), nodes.len(), at_left.len(), at_right.len()];
        let fits = lengths == [intervals * self.gauss.m * n, intervals * n, left, right];
        match end {
            None => self.is_factored(Progress::Factored, fits, out),
            Some(end) => self.is_factored(Progress::Eliminated, fits && end.size() == n && left <= n, out),
        }
    }

    /// Conditions at the mirror that make the antisymmetric problem square.
    pub(super) fn antisymmetric_conditions(&self) -> usize {
        let Dimensions { components, left, .. } = self.dimensions();
        components.saturating_sub(left)
    }

    /// Solves J δ = −residual with the factors of the last factorisation.
    pub fn solve(&mut self, residual: &Residual, out: &mut Direction) {
        let right = self.dimensions().right;
        if !self.can_solve(None, residual, right, out) {
            return;
        }
        self.solve_nodes(None, residual, out, true);
        (self.kernels.complete)(&self.condensed, &self.gauss, out);
    }

    /// The last node and the scalar unknowns alone of [`solve`](Self::solve), in their places in `out`.
    pub fn solve_last_node(&mut self, residual: &Residual, out: &mut Direction) {
        let right = self.dimensions().right;
        if self.can_solve(None, residual, right, out) {
            self.solve_nodes(None, residual, out, false);
        }
    }

    /// Solves with the residual of the last evaluation.
    pub fn solve_own(&mut self, out: &mut Direction) {
        let residual = std::mem::take(&mut self.residual);
        self.solve(&residual, out);
        self.residual = residual;
    }

    /// Solves J δ = e with e one in row `which` of the border (integral conditions first) and zero elsewhere.
    pub fn solve_unit(&mut self, which: usize, out: &mut Direction) {
        if !self.is_factored(Progress::Factored, which < self.block.borders(), out) {
            return;
        }
        let mut border = [0.0; MAX_UNKNOWNS];
        border[which] = 1.0;
        let right = &[0.0; MAX_UNKNOWNS][..self.dimensions().right];
        self.solve_from_last(None, [right, &border[..self.block.borders()]], out);
    }

    /// Solves J d = 0 with linear condition `which` raised by 1.
    pub fn null_direction(&mut self, which: usize, out: &mut Direction) {
        self.solve_unit(self.dimensions().integrals.saturating_add(which), out);
    }

    /// Solves for right-hand sides that are zero but for [right, border] conditions, of the antisymmetric problem if its end
    /// is given.
    fn solve_from_last(&mut self, end: Option<&AntisymmetricEnd>, [right, border]: [&[f64]; 2], out: &mut Direction) {
        let Dimensions { components: n, scalars, left, .. } = self.dimensions();
        zeroed(&mut out.nodes, (self.condensed.intervals() + 1) * n);
        zeroed(&mut out.stages, self.condensed.intervals() * self.gauss.m * n);
        zeroed(&mut out.scalars, scalars);
        self.block.forward_zero();
        self.substitute(end, [&[0.0; MAX_UNKNOWNS][..left], right, border], out, true);
        (self.kernels.complete)(&self.condensed, &self.gauss, out);
    }

    /// Nodes (of which only the last if not `everywhere`), scalars and particular stage values for a residual, of the
    /// antisymmetric problem if its end is given.
    fn solve_nodes(
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

    /// Factorises the antisymmetric problem that belongs to the factorised one on a mirror-symmetric half: the same
    /// intervals and left conditions, the components in `vanishing` zero at the mirror in place of the right conditions, and
    /// neither scalar unknowns nor integral conditions. The determinant includes the stages.
    ///
    /// # Errors
    /// A pivot that is not finite, or components that do not make the problem square; a pivot that is zero makes the
    /// determinant zero.
    pub fn factor_antisymmetric(
        &self,
        vanishing: &[usize],
        end: &mut AntisymmetricEnd,
    ) -> Result<Determinant, PivotFailure> {
        self.set_vanishing(vanishing, end)?;
        self.factor_antisymmetric_rows(end)
    }

    /// [`factor_antisymmetric`](Self::factor_antisymmetric) with the right end rows of `end`.
    pub(crate) fn factor_antisymmetric_rows(&self, end: &mut AntisymmetricEnd) -> Result<Determinant, PivotFailure> {
        let Dimensions { components: n, left, .. } = self.dimensions();
        let square = n.checked_sub(left).and_then(|open| open.checked_mul(n)) == Some(end.rows.len());
        if self.stage < Progress::Eliminated || !square {
            return Err(NO_MATRIX);
        }
        let factored = self.block.factor_antisymmetric(end);
        match factored {
            Ok(()) => Ok(self.determinant_with(Some(end))),
            // Exactly singular in the last block: the zero itself.
            Err(failure) if !failure.non_finite => Ok(Determinant { sign: 0.0, log_abs: f64::NEG_INFINITY }),
            Err(failure) => Err(failure),
        }
    }

    /// [`factor_antisymmetric`](Self::factor_antisymmetric) without the determinant, which takes a logarithm for every pivot.
    ///
    /// # Errors
    /// A pivot that is zero or not finite, or components that do not make the problem square.
    pub fn eliminate_antisymmetric(&self, vanishing: &[usize], end: &mut AntisymmetricEnd) -> Result<(), PivotFailure> {
        self.set_vanishing(vanishing, end)?;
        self.block.factor_antisymmetric(end)
    }

    /// The end rows of an antisymmetric problem that is square.
    fn set_vanishing(&self, vanishing: &[usize], end: &mut AntisymmetricEnd) -> Result<(), PivotFailure> {
        let Dimensions { components: n, left, .. } = self.dimensions();
        let square = n.checked_sub(left) == Some(vanishing.len()) && vanishing.iter().all(|c| *c < n);
        if self.stage < Progress::Eliminated || !square {
            return Err(NO_MATRIX);
        }
        end.set_vanishing(vanishing, n);
        Ok(())
    }

    /// Adds J δ to `out`, J being the antisymmetric problem where the system was evaluated last with derivatives: what is left
    /// of a residual after a correction with older factors.
    pub fn apply_antisymmetric(&mut self, end: &AntisymmetricEnd, direction: &Direction, out: &mut Residual) {
        let (n, m) = (self.dimensions().components, self.gauss.m);
        let intervals = self.condensed.intervals();
        let [stages, nodes] = [intervals * m * n, intervals * n];
        let fits = [direction.stages.len(), out.stages.len(), direction.nodes.len(), out.nodes.len()]
            == [stages, stages, nodes + n, nodes];
        if !self.evaluated || !fits {
            out.stages.fill(f64::NAN);
            return;
        }
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
        for (rows, y, out) in [(&self.ends.left[0], first, &mut out.left), (&end.rows, last, &mut out.right)] {
            out.iter_mut().zip(rows.chunks_exact(n)).for_each(|(out, row)| *out += product(row, y));
        }
    }

    /// Solves the antisymmetric problem factorised by [`factor_antisymmetric`](Self::factor_antisymmetric) for stage and
    /// node residuals and right-hand sides of its end rows.
    pub fn solve_antisymmetric(&mut self, end: &AntisymmetricEnd, residual: &Residual, out: &mut Direction) {
        if !self.can_solve(Some(end), residual, self.antisymmetric_conditions(), out) {
            return;
        }
        self.solve_nodes(Some(end), residual, out, true);
        (self.kernels.complete)(&self.condensed, &self.gauss, out);
    }

    /// The last node alone of [`solve_antisymmetric`](Self::solve_antisymmetric), in its place in `out`.
    pub fn solve_antisymmetric_last_node(&mut self, end: &AntisymmetricEnd, residual: &Residual, out: &mut Direction) {
        if self.can_solve(Some(end), residual, self.antisymmetric_conditions(), out) {
            self.solve_nodes(Some(end), residual, out, false);
        }
    }

    /// The solution of the antisymmetric problem for right-hand sides that are zero but for `right` of its right end rows.
    pub fn solve_antisymmetric_unit(&mut self, end: &AntisymmetricEnd, right: &[f64], out: &mut Direction) {
        let fits = right.len() == self.antisymmetric_conditions() && end.size() == self.dimensions().components;
        if self.is_factored(Progress::Eliminated, fits, out) {
            self.solve_from_last(Some(end), [right, &[]], out);
        }
    }

    /// Determinant of the full factorised system; one of sign 0 if there are no factors.
    pub fn determinant(&self) -> Determinant {
        self.determinant_with(None)
    }

    fn determinant_with(&self, end: Option<&AntisymmetricEnd>) -> Determinant {
        let mut det = Determinant::default();
        if self.stage < Progress::Eliminated {
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

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn add(to: &mut [f64], terms: &[f64]) {
    to.iter_mut().zip(terms).for_each(|(to, term)| *to += term);
}
