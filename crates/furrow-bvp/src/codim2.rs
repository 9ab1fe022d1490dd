//! Curves of singular points in two parameters.
//!
//! A [`Codim2Curve`] holds a problem with two free parameters (λ, μ), its last scalar unknowns, and a singularity g. Its points are the
//! roots of (F, g), one condition short; the closing condition is the plane of pseudo-arclength continuation, or a value
//! for any one scalar unknown: that is how a critical point is solved for directly by the value of another
//! parameter.

use crate::bifurcation::{AugmentedReport, MinimallyAugmented, SingularError, Singularity};
use crate::bracket::Bracket;
use crate::continuation::predictor::History;
use crate::continuation::{MeshMonitor, SHORTER};
use crate::direction::{Direction, LinearCondition};
use crate::invalid::{self, InvalidInput, short};
use crate::mesh;
use crate::metric::{self, Metric};
use crate::newton::Work;
use crate::problem::Directional;
use crate::solution::Solution;

/// Settings of a curve.
#[derive(Clone, Debug, PartialEq)]
pub struct CurveSettings {
    /// First step, in arclength.
    pub first_step: f64,
    /// Smallest step before giving up.
    pub min_step: f64,
    /// Largest step.
    pub max_step: f64,
    /// Smallest cosine between neighbouring tangents.
    pub min_cosine: f64,
    /// First Newton correction aimed at: small enough for a single iteration.
    pub target_correction: f64,
    /// Accuracy of the points on the way; a point asked for by value is found to rounding.
    pub tolerance: f64,
    /// Move the mesh when the largest interval carries this many times its share of the monitor.
    pub remesh_above: f64,
}

impl Default for CurveSettings {
    fn default() -> Self {
        CurveSettings {
            first_step: 0.01,
            min_step: 1e-7,
            max_step: 0.2,
            min_cosine: 0.8,
            target_correction: 1e-7,
            tolerance: 1e-10,
            remesh_above: 1.8,
        }
    }
}

impl CurveSettings {
    /// Checks the settings.
    ///
    /// # Errors
    /// [`InvalidInput::Setting`].
    pub fn check(&self) -> Result<(), InvalidInput> {
        let CurveSettings { first_step, min_step, max_step, min_cosine, target_correction, tolerance, remesh_above } =
            *self;
        for (name, value) in [
            ("first_step", first_step),
            ("min_step", min_step),
            ("target_correction", target_correction),
            ("the tolerance of a curve", tolerance),
        ] {
            invalid::positive(name, value)?;
        }
        invalid::setting("max_step", max_step, max_step > 0.0, "a number above 0")?;
        invalid::setting("min_cosine", min_cosine, (0.0..1.0).contains(&min_cosine), "a number from 0, below 1")?;
        invalid::setting("remesh_above", remesh_above, remesh_above >= 1.0, "a number from 1")
    }
}

/// Points a prediction goes through: a curve costs one factorisation per point, and curves are smooth.
const ORDER: usize = 7;

/// Most iterations for a turning point, and the accuracy of its arclength.
const MOST_TURNS: usize = 60;
const TURN: f64 = 1e-9;

/// Tolerance of points asked for by value.
const ROUNDING: f64 = 1e-12;

/// Why following a curve failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CurveError {
    /// The problem, the point to start from, the metric, the settings or an index are refused.
    #[error(transparent)]
    Invalid(#[from] InvalidInput),
    /// No first point.
    #[error("no first point: {0}")]
    Start(SingularError),
    /// The corrector fails for the smallest step.
    #[error("the curve is lost at ({}, {}): {source}", short(*first), short(*second))]
    Lost {
        /// First free parameter.
        first: f64,
        /// Second free parameter.
        second: f64,
        /// Last error of the solver.
        source: SingularError,
    },
    /// A value of an unknown is not on the curve in the number of steps allowed.
    #[error("not reached in {steps} steps, which lead to {}", short(*reached))]
    NotReached {
        /// Steps taken.
        steps: usize,
        /// Value reached.
        reached: f64,
    },
}

/// A curve of singular points being followed.
///
/// # Examples
/// The folds of u″ + λ exp(u/(1 + μu)) = 0, u(0) = u(1) = 0 from Bratu's problem at μ = 0 to μ = 0.1. `Oscillator`
/// is in `examples/problems/oscillator.rs`; here it is on the half [0, ½].
///
/// ```
/// # mod oscillator { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/problems/oscillator.rs")); }
/// # use oscillator::{Force, Oscillator};
/// use furrow_bvp::{Codim2Curve, CurveSettings, Direction, Fold, Gauss, Metric, Solution, mesh};
/// let (gauss, mesh) = (Gauss::new(4)?, mesh::uniform(0.0, 0.5, 12));
/// // At the fold u is about 1.19 at ½, and all of it grows along the branch.
/// let bump = |x: f64, y: &mut [f64]| y.copy_from_slice(&[4.75 * x * (1.0 - x), 4.75 * (1.0 - 2.0 * x)]);
/// let guess = Solution::from_fn(&gauss, &mesh, 2, &[3.5, 0.0], bump)?;
/// let tangent = Direction { nodes: guess.nodes.clone(), stages: guess.stages.clone(), scalars: vec![0.0; 2] };
/// let (metric, settings) = (Metric::unit(2, 2), CurveSettings::default());
/// let problem = Oscillator { force: Force::With(oscillator::gelfand), right: 1 };
/// let mut curve = Codim2Curve::start(problem, Fold::new(0), guess, metric, &tangent, settings, true)?;
/// assert!((curve.parameters()[0] - 3.513830719).abs() < 1e-8);
/// curve.follow_to(1, 0.1, 100, |_, _| true)?;
/// assert_eq!(curve.parameters()[1], 0.1);
/// assert!(curve.parameters()[0] > 3.9, "the fold comes later");
/// # Ok::<(), furrow_bvp::CurveError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Codim2Curve<P, S> {
    /// Factors, directions and the singularity at the newest point.
    pub augmented: MinimallyAugmented<P, S>,
    /// The newest point.
    pub solution: Solution,
    /// Unit tangent of the curve.
    pub tangent: Direction,
    /// Arclength from the first point.
    pub arclength: f64,
    /// The step to try next.
    pub step: f64,
    /// Settings.
    pub settings: CurveSettings,
    /// Monitor that the mesh equidistributes; by default the mesh stays.
    pub monitor: Option<MeshMonitor<P>>,
    /// Work so far.
    pub work: Work,
    history: History,
    /// Length and first correction of the newest step.
    last: Option<[f64; 2]>,
    /// Largest first correction that a shorter step did not reduce.
    rounding: f64,
    closing: LinearCondition,
    trial: Solution,
    weight: Vec<f64>,
}

impl<P: Directional + Clone, S: Singularity<P> + Clone> Codim2Curve<P, S> {
    /// Starts at the singular point near `guess` with the μ of `guess`, towards larger μ if `upwards`. `branch_tangent`
    /// is the tangent of the branch the point is on.
    ///
    /// # Errors
    /// [`CurveError::Start`], or [`CurveError::Invalid`] for input that is refused.
    pub fn start(
        problem: P,
        singularity: S,
        guess: Solution,
        metric: Metric,
        branch_tangent: &Direction,
        settings: CurveSettings,
        upwards: bool,
    ) -> Result<Self, CurveError> {
        settings.check()?;
        let dims = problem.dimensions();
        guess.fits(dims)?;
        if dims.missing_conditions() != 2 {
            return Err(InvalidInput::NotSquare { missing: dims.missing_conditions(), allowed: "2" }.into());
        }
        let augmented = MinimallyAugmented::new(problem, singularity, guess.m, metric, branch_tangent).map_err(
            |error| match error {
                SingularError::Invalid(input) => CurveError::Invalid(input),
                error => CurveError::Start(error),
            },
        )?;
        let mut curve = Codim2Curve {
            augmented,
            trial: guess.clone(),
            solution: guess,
            tangent: Direction::default(),
            arclength: 0.0,
            step: settings.first_step,
            settings,
            monitor: None,
            work: Work::default(),
            history: History::of_order(ORDER),
            last: None,
            rounding: 0.0,
            closing: LinearCondition::default(),
            weight: Vec::new(),
        };
        let last = curve.solution.scalars.len() - 1;
        let value = curve.solution.scalars[last];
        metric::scalar_condition(&curve.solution, last, value, &mut curve.closing);
        let report = curve.augmented.solve(&mut curve.solution, Some(&curve.closing)).map_err(CurveError::Start)?;
        curve.work += report;
        curve.tangent = curve.augmented.curve_direction(&curve.solution);
        if (curve.tangent.scalars[last] > 0.0) != upwards {
            curve.tangent.scale(-1.0);
        }
        curve.history.push(0.0, &curve.solution);
        Ok(curve)
    }

    /// Values of the two free parameters (λ, μ).
    pub fn parameters(&self) -> [f64; 2] {
        self.solution.scalars.last_chunk().copied().unwrap_or([f64::NAN; 2])
    }

    /// Reverses the direction.
    pub fn reverse(&mut self) {
        self.tangent.scale(-1.0);
        self.history.clear();
        self.history.push(self.arclength, &self.solution);
        self.step = self.settings.first_step;
    }

    /// Reverses the direction if scalar unknown `index` would move away from `value`.
    pub fn head_for(&mut self, index: usize, value: f64) {
        let (now, slope) = (self.solution.scalars.get(index), self.tangent.scalars.get(index));
        if now.zip(slope).is_some_and(|(now, slope)| (value - now) * slope < 0.0) {
            self.reverse();
        }
    }

    /// Takes one step.
    ///
    /// # Errors
    /// [`CurveError::Lost`]; the state is left at the last point.
    pub fn advance(&mut self) -> Result<AugmentedReport, CurveError> {
        self.check()?;
        self.remesh();
        let mut step = self.step.min(self.settings.max_step);
        loop {
            self.predict(step);
            let before = (self.augmented.basis.clone(), self.augmented.slopes);
            let source = match self.correct() {
                Ok((report, tangent)) => {
                    self.accept(step, report, tangent);
                    return Ok(report);
                }
                Err(error) => error,
            };
            (self.augmented.basis, self.augmented.slopes) = before;
            self.augmented.set_reference(&self.augmented.basis[0].clone());
            self.work.rejected += 1;
            step *= SHORTER;
            if step < self.settings.min_step {
                return Err(self.lost(source));
            }
        }
    }

    /// Checks the public fields, which may have changed since the last step.
    fn check(&self) -> Result<(), InvalidInput> {
        self.settings.check()?;
        self.augmented.system.check(&self.augmented.problem, &self.solution)?;
        self.tangent.check(&self.solution)?;
        self.history.check(&self.solution)?;
        invalid::setting("the step", self.step, self.step > 0.0, "a number above 0")
    }

    fn lost(&self, source: SingularError) -> CurveError {
        let [first, second] = self.parameters();
        CurveError::Lost { first, second, source }
    }

    /// The plane at distance `step`, and a prediction in it.
    fn predict(&mut self, step: f64) {
        self.augmented.metric.plane_through(&self.solution, &self.tangent, &mut self.closing);
        self.closing.value += step;
        if self.history.len() > 1 {
            self.history.predict(&self.closing, &mut self.trial);
        } else {
            self.trial.clone_from(&self.solution);
            self.tangent.apply(step, &mut self.trial);
        }
    }

    /// Corrects the prediction in the plane; the tangent at the point found.
    fn correct(&mut self) -> Result<(AugmentedReport, Direction), SingularError> {
        (self.augmented.tolerance, self.augmented.predict_convergence) = (self.settings.tolerance, true);
        let solved = self.augmented.solve(&mut self.trial, Some(&self.closing));
        (self.augmented.tolerance, self.augmented.predict_convergence) = (ROUNDING, false);
        let report = solved?;
        self.work += report;
        let (tangent, cosine) = self.tangent_at(&self.trial);
        if cosine >= self.settings.min_cosine {
            Ok((report, tangent))
        } else {
            Err(SingularError::Stalled { iterations: report.iterations, correction: report.correction })
        }
    }

    /// Unit tangent at a point solved for, turned the way the curve is followed, and the cosine of the angle between them.
    fn tangent_at(&self, y: &Solution) -> (Direction, f64) {
        let mut tangent = self.augmented.curve_direction(y);
        let cosine = self.augmented.metric.dot(&y.mesh, &tangent, &self.tangent);
        if cosine < 0.0 {
            tangent.scale(-1.0);
        }
        (tangent, cosine.abs())
    }

    /// Makes the corrected prediction the newest point.
    fn accept(&mut self, step: f64, report: AugmentedReport, tangent: Direction) {
        self.tangent = tangent;
        std::mem::swap(&mut self.solution, &mut self.trial);
        self.arclength += step;
        self.history.push(self.arclength, &self.solution);
        self.augmented.problem.accepted(&self.solution);
        self.step = self.step_after(step, report.first_correction);
        self.work.steps += 1;
    }

    /// The next step length. The first correction of a step is of the order of the predictor, the number of known points, in the
    /// step length. No step becomes shorter than a quarter of the first for accuracy: corrections there are rounding errors, which do not
    /// shrink with the step.
    fn step_after(&mut self, step: f64, correction: f64) -> f64 {
        let order = self.history.len() as f64;
        if let Some([longer, before]) = self.last
            && step < 0.8 * longer
            && correction > 0.5 * before
            && correction < 100.0 * self.settings.target_correction
        {
            // A shorter step with the same correction: only rounding is left.
            self.rounding = self.rounding.max(correction);
        }
        self.last = Some([step, correction]);
        let target = self.settings.target_correction.max(self.rounding);
        let shortest = 0.25 * self.settings.first_step;
        let ratio = (target / correction.max(1e-300)).powf(1.0 / order).clamp(0.3, 3.0);
        let next = step * if correction < 10.0 * target { ratio.max(1.0) } else { ratio };
        if next < shortest { shortest.min(2.0 * step) } else { next }
    }

    /// The point between the last two at which the curve turns in scalar unknown `index`, by the Illinois method on the
    /// tangent; `None` if a corrector fails on the way. The curve itself stays where it is.
    pub fn turning_point(&mut self, index: usize) -> Option<Solution> {
        invalid::index("scalar unknown", index, self.tangent.scalars.len()).and_then(|()| self.check()).ok()?;
        let (before, _) = self.history.back(1)?;
        let (_, at_start) = self.turning_at(index, before)?;
        let mut bracket = Bracket::new([[before, at_start], [self.arclength, self.tangent.scalars[index]]]);
        let mut last = f64::INFINITY;
        for _ in 0..MOST_TURNS {
            let [[a, at_a], [b, at_b]] = bracket.ends;
            // Without a change of sign, which an inexact tangent at the first point can hide, the middle.
            let here = if at_a * at_b < 0.0 { bracket.secant() } else { a + 0.5 * (b - a) };
            let (y, slope) = self.turning_at(index, here)?;
            // Both parameters are quadratic about a cusp: half the digits of arclength give all digits of theirs.
            if (here - last).abs() <= TURN * (1.0 + here.abs()) || slope == 0.0 {
                return Some(y);
            }
            last = here;
            bracket.keep([here, slope]);
        }
        None
    }

    /// Estimated error of the two parameters at a point of the curve that was just found, such as a cusp, by their change where the
    /// intervals are halved.
    pub fn error_estimate(&self, y: &Solution) -> f64 {
        self.augmented.error_estimate(y, Some(&self.tangent))
    }

    /// The point at an arclength between the last two, and scalar `index` of the tangent there.
    fn turning_at(&mut self, index: usize, arclength: f64) -> Option<(Solution, f64)> {
        let mut y = self.solution.clone();
        self.history.extrapolate(arclength, &mut y);
        self.augmented.metric.plane_through(&y, &self.tangent, &mut self.closing);
        self.work += self.augmented.solve(&mut y, Some(&self.closing)).ok()?;
        let slope = self.tangent_at(&y).0.scalars[index];
        Some((y, slope))
    }

    /// Solves for the point near the newest where scalar unknown `index` has a value; the curve itself stays where it
    /// is, but the factors in `augmented` belong to the point found.
    ///
    /// # Errors
    /// [`CurveError::Lost`].
    pub fn at(&mut self, index: usize, value: f64) -> Result<(Solution, AugmentedReport), CurveError> {
        self.check()?;
        invalid::index("scalar unknown", index, self.tangent.scalars.len())?;
        let mut y = self.solution.clone();
        let slope = self.tangent.scalars[index];
        match self.history.back(1) {
            Some((before, earlier)) if (earlier.scalars[index] - value) * (y.scalars[index] - value) <= 0.0 => {
                let share = (value - earlier.scalars[index]) / (y.scalars[index] - earlier.scalars[index]);
                self.history.extrapolate(before + share * (self.arclength - before), &mut y);
            }
            _ if slope != 0.0 => self.tangent.apply((value - y.scalars[index]) / slope, &mut y),
            _ => {}
        }
        metric::scalar_condition(&y, index, value, &mut self.closing);
        let report = self.augmented.solve(&mut y, Some(&self.closing)).map_err(|source| self.lost(source))?;
        self.work += report;
        Ok((y, report))
    }

    /// Follows the curve until scalar unknown `index` passes `value`, showing every point to `visit` (which may end it
    /// by returning false), and makes the point with exactly that value the newest.
    ///
    /// # Errors
    /// [`CurveError`]; `NotReached` also if `visit` ended it.
    pub fn follow_to(
        &mut self,
        index: usize,
        value: f64,
        limit: usize,
        mut visit: impl FnMut(&mut Self, &AugmentedReport) -> bool,
    ) -> Result<(), CurveError> {
        invalid::index("scalar unknown", index, self.solution.scalars.len())?;
        for steps in 0..limit {
            let before = self.solution.scalars[index] - value;
            if before == 0.0 {
                return Ok(());
            }
            let report = self.advance()?;
            if before * (self.solution.scalars[index] - value) <= 0.0 {
                let (y, report) = self.at(index, value)?;
                self.tangent = self.tangent_at(&y).0;
                self.solution = y;
                self.history.clear();
                self.history.push(self.arclength, &self.solution);
                self.step = self.settings.first_step;
                visit(self, &report);
                return Ok(());
            }
            if !visit(self, &report) {
                return Err(CurveError::NotReached { steps, reached: self.solution.scalars[index] });
            }
        }
        Err(CurveError::NotReached { steps: limit, reached: self.solution.scalars[index] })
    }

    /// Moves the mesh if it no longer fits.
    fn remesh(&mut self) {
        let Some(monitor) = self.monitor else { return };
        let y = &self.solution;
        monitor(&self.augmented.problem, y, &mut self.weight);
        let Some(grid) = mesh::rebalanced(&y.mesh, &self.weight, self.settings.remesh_above) else { return };
        let gauss = self.augmented.system.gauss.clone();
        metric::transfer_direction(&gauss, &y.mesh, &grid, &mut self.tangent);
        self.augmented.move_to(&y.mesh, &grid);
        self.solution.transfer_into(&gauss, &grid, &mut self.trial);
        std::mem::swap(&mut self.solution, &mut self.trial);
        self.history.transfer(&gauss, &grid);
        self.augmented.metric.normalise(&grid, &mut self.tangent);
        self.work.remeshings += 1;
    }
}
