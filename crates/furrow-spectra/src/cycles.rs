//! Where cycles on a branch change their stability: folds, period doublings and tori, and the cycles of twice the period.
//!
//! A fold is one of the branch and is found as such. Period doublings and tori show in the multipliers at both ends of a step, where
//! these are accurate. Between them the test function of [`CycleBifurcation`] is a smooth function of the arclength with a simple root,
//! and the orbit at every arclength that is tried is corrected onto the branch.

use furrow_bvp::continuation::{Advance, State, predictor::History};
use furrow_bvp::{
    Auto, Continuation, ContinuationError, Direction, FactorisationError, PeriodicOrbit, SingularError, Solution,
    VectorField,
    locate::{self, Located},
};

use crate::floquet::{Complex, CycleBifurcation, Multipliers, NoMultipliers};
use crate::root::{self, Root};

/// A branch of cycles.
pub type CycleBranch<V> = Continuation<Auto<PeriodicOrbit<V>>>;

/// A cycle at which stability changes.
#[derive(Clone, Debug, PartialEq)]
pub struct CyclePoint {
    /// What happens there.
    pub bifurcation: CycleBifurcation,
    /// The orbit, with the scalar unknowns of [`PeriodicOrbit`].
    pub solution: Solution,
    /// Its arclength along the branch.
    pub arclength: f64,
    /// Its multipliers.
    pub multipliers: Multipliers,
    /// Estimated error of the parameter, by its change where the intervals are halved; infinite if it is not found there.
    pub error: f64,
}

impl CyclePoint {
    /// The parameter there.
    pub fn parameter(&self) -> f64 {
        self.solution.scalars.last().copied().unwrap_or(f64::NAN)
    }

    /// The period there.
    pub fn period(&self) -> f64 {
        self.solution.scalars.get(self.solution.components).copied().unwrap_or(f64::NAN)
    }

    /// The angle by which the pair on the unit circle turns disturbances in a period, between 0 and π: for a torus.
    pub fn angle(&self) -> f64 {
        let nearest = self.multipliers.others.iter().filter(|m| m.im > 0.0);
        nearest.min_by(|a, b| off_circle(a).total_cmp(&off_circle(b))).map_or(f64::NAN, |m| m.im.atan2(m.re))
    }
}

fn off_circle(multiplier: &Complex<f64>) -> f64 {
    (multiplier.norm_sqr().sqrt() - 1.0).abs()
}

/// Why bifurcations of cycles were not found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CycleError {
    /// The orbit has no transition matrices.
    #[error(transparent)]
    Orbit(#[from] FactorisationError),
    /// Transition matrices have no multipliers.
    #[error(transparent)]
    Multipliers(#[from] NoMultipliers),
    /// A fold was not found, or not the point where orbits of twice the period branch.
    #[error(transparent)]
    Singular(#[from] SingularError),
    /// There is a bifurcation between two orbits of the branch, but no orbit between them could be computed.
    #[error("the branch is lost between parameters {} and {}", .parameters[0], .parameters[1])]
    Lost {
        /// Parameters of the two orbits.
        parameters: [f64; 2],
    },
    /// A branch was not followed.
    #[error(transparent)]
    Branch(#[from] ContinuationError),
    /// Orbits of twice the period branch from a period doubling alone.
    #[error("no orbits of twice the period branch from a {}", match .bifurcation { CycleBifurcation::Fold => "fold", _ => "torus" })]
    NoDoubling {
        /// What was found at the point.
        bifurcation: CycleBifurcation,
    },
}

/// The multipliers of an orbit, from the transitions over its intervals. In the plane the multiplier other than 1 is the exponential of
/// the integrated divergence, which is as accurate as the orbit: transitions are approximated, and their errors grow with disturbances.
///
/// # Errors
/// [`CycleError::Orbit`] or [`CycleError::Multipliers`].
pub fn multipliers<V: VectorField>(
    problem: &mut Auto<PeriodicOrbit<V>>,
    orbit: &Solution,
) -> Result<Multipliers, CycleError> {
    let mut found = Multipliers::of_transitions(&problem.transitions(orbit)?)?;
    if let [other] = &mut found.others[..] {
        *other = Complex::new(problem.divergence(orbit).exp(), 0.0);
    }
    Ok(found)
}

/// Watches a branch of cycles: gives the multipliers of every orbit, and the bifurcations in the step to it.
///
/// # Examples
/// The cycle of Rössler's equations doubles its period; `c` is the parameter.
///
/// ```
/// use furrow_bvp::{Continuation, ContinuationSettings, Gauss, Metric, Number, PeriodicOrbit, VectorField, mesh};
/// use furrow_spectra::cycles::CycleWatch;
/// use furrow_spectra::floquet::CycleBifurcation;
/// use std::f64::consts::TAU;
///
/// #[derive(Clone)]
/// struct Rossler;
///
/// impl VectorField for Rossler {
///     fn components(&self) -> usize {
///         3
///     }
///     fn parameters(&self) -> usize {
///         1
///     }
///     fn velocity<D: Number>(&self, y: &[D], p: &[D], v: &mut [D]) {
///         v[0] = -y[1] - y[2];
///         v[1] = y[0] + y[1] * 0.2;
///         v[2] = y[2] * (y[0] - p[0]) + 0.2;
///     }
/// }
///
/// let (gauss, grid) = (Gauss::new(4)?, mesh::uniform(0.0, 1.0, 40));
/// let (sine, cosine) = (|x: f64| (TAU * x).sin(), |x: f64| (TAU * x).cos());
/// let orbit = |x: f64, y: &mut [f64]| y.copy_from_slice(&[3.2 * cosine(x), 3.2 * sine(x) - 0.5, 0.4]);
/// let (problem, guess) = PeriodicOrbit::near(Rossler, &gauss, &grid, 5.8, &[2.2], orbit)?;
/// let metric = Metric { components: vec![1.0; 3], scalars: vec![0.0, 0.0, 0.0, 0.0, 1.0] };
/// let settings = ContinuationSettings { max_step: 0.3, ..Default::default() };
/// let mut branch = Continuation::start(problem, guess, metric, settings, true)?;
/// let (mut watch, mut found) = (CycleWatch::start(&mut branch)?, Vec::new());
/// branch.follow([2.0, 3.0], 100, |branch, advance| {
///     found.push(watch.look(branch, advance));
///     true
/// })?;
/// let points = found.into_iter().collect::<Result<Vec<_>, _>>()?.concat();
/// assert_eq!(points[0].bifurcation, CycleBifurcation::PeriodDoubling);
/// assert!((points[0].parameter() - 2.832445028).abs() < 1e-7);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct CycleWatch {
    /// Of the newest orbit.
    pub multipliers: Multipliers,
    /// How often a test has changed its sign although no orbit nearby has the multipliers of a bifurcation, which happens where they are
    /// inaccurate. No bifurcation is reported there.
    pub unclear: usize,
}

/// The test of a torus also vanishes for two real multipliers μ and 1/μ. Imaginary parts below this count as real: the pairs of 1 that
/// conservative families have are split by the root of the rounding error.
const REAL: f64 = 1e-4;

/// Multipliers at 1 are split like the one of a shift in time, but for such a factor.
const SPLIT: f64 = 10.0;

/// Largest distance from their exact values of the multiplier of a shift in time and of those at a bifurcation.
const NEAR: f64 = 1e-2;

impl CycleWatch {
    /// At the newest orbit of a branch.
    ///
    /// # Errors
    /// As [`multipliers`].
    pub fn start<V: VectorField>(branch: &mut CycleBranch<V>) -> Result<CycleWatch, CycleError> {
        Ok(CycleWatch { multipliers: multipliers(&mut branch.problem, &branch.state.solution)?, unclear: 0 })
    }

    /// The bifurcations between the last two orbits, after every step, in the order of their arclength. Two of a kind within one step
    /// are not seen.
    ///
    /// # Errors
    /// [`CycleError`].
    pub fn look<V: VectorField + Clone>(
        &mut self,
        branch: &mut CycleBranch<V>,
        advance: Advance,
    ) -> Result<Vec<CyclePoint>, CycleError> {
        let now = multipliers(&mut branch.problem, &branch.state.solution)?;
        let before = std::mem::replace(&mut self.multipliers, now);
        let mut points = Vec::new();
        if advance.passed_fold && !branch.is_still() {
            let Located { solution, arclength, error, .. } = locate::last_fold(branch)?;
            let multipliers = multipliers(&mut branch.problem, &solution)?;
            let error = if multipliers.others.iter().all(|m| m.re.is_finite()) { error } else { f64::INFINITY };
            points.push(CyclePoint { bifurcation: CycleBifurcation::Fold, solution, arclength, multipliers, error });
        }
        for bifurcation in [CycleBifurcation::PeriodDoubling, CycleBifurcation::Torus] {
            let values = [&before, &self.multipliers].map(|m| bifurcation.scaled_test(m));
            if values[0] * values[1] < 0.0 {
                let found = located(branch, bifurcation, values)?;
                self.unclear += usize::from(found.as_ref().is_some_and(|point| !is_clear(point)));
                points.extend(found.filter(is_clear));
            }
        }
        points.sort_by(|a, b| a.arclength.total_cmp(&b.arclength));
        Ok(points)
    }
}

/// Whether a point has the multipliers of its bifurcation. Next to homoclinic orbits errors alone can change the sign of the test.
fn is_clear(point: &CyclePoint) -> bool {
    let Multipliers { trivial, others } = &point.multipliers;
    let off_minus_one = |m: &Complex<f64>| (m + 1.0).norm_sqr().sqrt();
    let off = if point.bifurcation == CycleBifurcation::PeriodDoubling { off_minus_one } else { off_circle };
    others.iter().any(|m| off(m) < NEAR) && (trivial - 1.0).norm_sqr().sqrt() < NEAR
}

/// The root of the test between the last two orbits, where it has these values; `None` for a neutral saddle, and for multipliers at 1.
fn located<V: VectorField>(
    branch: &mut CycleBranch<V>,
    bifurcation: CycleBifurcation,
    values: [f64; 2],
) -> Result<Option<CyclePoint>, CycleError> {
    let test = |problem: &mut Auto<PeriodicOrbit<V>>, y: &Solution| {
        multipliers(problem, y).map(|found| (bifurcation.scaled_test(&found), found))
    };
    let lost = |parameters| CycleError::Lost { parameters };
    let Some(root) = root::between(branch, values, lost, test)? else { return Ok(None) };
    let nearest = root.found.others.iter().min_by(|a, b| off_circle(a).total_cmp(&off_circle(b)));
    let noise = SPLIT * (root.found.trivial - 1.0).norm_sqr().sqrt();
    if bifurcation == CycleBifurcation::Torus && nearest.is_none_or(|m| m.im.abs() < noise.max(REAL)) {
        return Ok(None);
    }
    let error = root.error(branch, test);
    let Root { solution, arclength, found: multipliers, .. } = root;
    Ok(Some(CyclePoint { bifurcation, solution, arclength, multipliers, error }))
}

/// The branch of orbits of twice the period that begins at a period doubling of a branch, which was found in its last step; to both sides
/// the orbits are the same but for a shift by half their period.
///
/// # Errors
/// [`CycleError::NoDoubling`] for another point, otherwise as [`locate::branch_point`] and
/// [`BranchPoint::switch`](furrow_bvp::BranchPoint::switch).
pub fn doubled<V: VectorField + Clone>(
    branch: &CycleBranch<V>,
    point: &CyclePoint,
) -> Result<CycleBranch<V>, CycleError> {
    if point.bifurcation != CycleBifurcation::PeriodDoubling {
        return Err(CycleError::NoDoubling { bifurcation: point.bifurcation });
    }
    let (metric, settings, orbit) = (branch.metric.clone(), branch.settings.clone(), &branch.problem);
    let (problem, solution) = orbit.repeated(&point.solution, 2);
    // On the mesh of the point a direction is the difference of two orbits.
    let ahead = {
        let mut ahead = point.solution.clone();
        branch.state.tangent.apply(1.0, &mut ahead);
        orbit.repeated(&ahead, 2).1
    };
    let mut tangent = difference(&ahead, &solution);
    metric.normalise(&solution.mesh, &mut tangent);
    // Twice the orbit is one of the branch that other orbits of twice the period cross, behind a step of the length of the first.
    let (mut history, mut before) = (History::default(), solution.clone());
    let step = settings.first_step;
    tangent.apply(-step, &mut before);
    history.push(0.0, &before);
    history.push(step, &solution);
    let state =
        State { solution, tangent, arclength: step, step, points: 2, direction: 0.0, orientation: 0.0, history };
    let mut twice = Continuation::resume(problem.clone(), state, metric.clone(), settings.clone());
    let crossing = locate::branch_point(&mut twice)?;
    let first = crossing.switch(&mut twice, true)?;
    Ok(Continuation::resume(problem, first, metric, settings))
}

/// b − a.
fn difference(b: &Solution, a: &Solution) -> Direction {
    let minus = |b: &[f64], a: &[f64]| b.iter().zip(a).map(|(b, a)| b - a).collect();
    Direction {
        nodes: minus(&b.nodes, &a.nodes),
        stages: minus(&b.stages, &a.stages),
        scalars: minus(&b.scalars, &a.scalars),
    }
}
