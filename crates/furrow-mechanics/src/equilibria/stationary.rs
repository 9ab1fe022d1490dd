//! One stationary shape: the first one at a given activity on the branch that starts at the passive shape.

use furrow_bvp::newton::NewtonScratch;
use furrow_bvp::{
    BoundaryValueProblem, ContinuationError, ContinuationSettings, Gauss, Newton, NewtonError, Solution, System,
    Termination, mesh,
};

use super::error::{CellName, Result, ShapeError, digits, resolved};
use super::{locate, primary};
use crate::azimuthal::Azimuthal;
use crate::cortex::equations::{LENGTH, PRESSURE, R};
use crate::cortex::problem::SHAPE_SCALARS;
use crate::cortex::{Cortex, Domain, observables};
use crate::law;
use crate::stability::{Spectrum, Stability, StabilityError};
use furrow_cell::{Cell, Numerics};

/// A stationary shape of one cell.
#[derive(Clone, Debug)]
pub struct StationaryShape {
    /// The cell; its domain says which part of the contour `solution` covers.
    pub cortex: Cortex,
    /// The shape with (L, p): half of the contour of a mirror-symmetric cell, else the whole contour.
    pub solution: Solution,
    /// ξ_s at the folds passed on the way to this shape.
    pub folds: Vec<f64>,
}

/// Why there is no such shape.
#[expect(missing_docs, reason = "the messages say what the fields are")]
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StationaryError {
    /// The branch could not be followed.
    #[error(transparent)]
    Branch(#[from] ShapeError),
    /// The branch does not reach the requested activity.
    #[error(
        "{cell}: no stationary shape at xi_s = {} on the branch of the passive shape, which turns back at xi_s = {}",
        digits(*xi_s),
        digits(*turn)
    )]
    OutOfReach { cell: CellName, xi_s: f64, turn: f64 },
    /// Continuation failed before the requested activity.
    #[error("{cell}: the branch of the passive shape could not be followed to xi_s = {}: {source}", digits(*xi_s))]
    Lost { cell: CellName, xi_s: f64, source: ContinuationError },
    /// The branch needs too many points to reach the requested activity.
    #[error("{cell}: the branch of the passive shape does not reach xi_s = {} in {points} points", digits(*xi_s))]
    PointLimit { cell: CellName, xi_s: f64, points: usize },
}

/// Most points of a branch followed for one shape.
const MOST_POINTS: usize = 400;
/// Beyond a fold, the branch is abandoned when its waist falls below this fraction of R0, since it leads to pinched
/// shapes.
pub(crate) const PINCHING: f64 = 0.25;

/// Longest steps along the branch, in its arclength. Landing on ξ_s extrapolates over one step: shorter steps are tried
/// if this fails.
const STEPS: [f64; 3] = [3.0, 0.6, 0.1];

/// The narrowest waist, or the largest radius of a contour without one.
pub(crate) fn waist(gauss: &Gauss, y: &Solution, domain: Domain) -> f64 {
    let widest = || y.stages.chunks_exact(y.components).map(|s| s[R]).fold(0.0, f64::max);
    match domain {
        Domain::Half => y.node(y.intervals())[R],
        Domain::Full => observables::neck(gauss, y).map_or_else(widest, |neck| neck.radius),
    }
}

/// The first stationary shape at the activity of the cell along its primary branch.
///
/// # Examples
/// A cell below the critical radius has a shape at rest; a large cell has no such shape and must divide.
///
/// ```
/// use furrow_cell::{Cell, Numerics};
/// use furrow_mechanics::equilibria::stationary::stationary;
/// let small = stationary(&Cell::new(1.6), &Numerics::default())?;
/// assert!(small.folds.is_empty());
/// assert!(stationary(&Cell::new(3.0), &Numerics::default()).is_err());
/// # Ok::<(), furrow_mechanics::equilibria::StationaryError>(())
/// ```
///
/// # Errors
/// [`StationaryError`]; `OutOfReach` if the cell has no such shape, like a cell that must divide.
pub fn stationary(cell: &Cell, numerics: &Numerics) -> Result<StationaryShape, StationaryError> {
    let cell = &*resolved(cell)?;
    let [long, shorter @ ..] = STEPS;
    // The branch is followed on a coarse mesh; if it turns back or is lost there, the given mesh decides.
    let (quick, parts) = primary::coarse(numerics);
    if parts > 1
        && let Ok((shape, false)) = along_branch(cell, &quick, long)
        && shape.folds.is_empty()
        && let Some(shape) = shape.refined(parts)
    {
        shape.holds()?;
        return Ok(shape);
    }
    let (mut shape, _) =
        shorter.into_iter().fold(along_branch(cell, numerics, long), |found, max_step| match found {
            Err(StationaryError::Lost { .. } | StationaryError::PointLimit { .. }) => {
                along_branch(cell, numerics, max_step)
            }
            found => found,
        })?;
    // At a fold the accuracy of the branch must suffice.
    let _ = shape.polish();
    shape.holds()?;
    Ok(shape)
}

/// A slope of ξ_s over the arclength below this part of the steepest is near a fold.
const FLAT: f64 = 0.1;

/// The shape, and whether it is near a fold, where two shapes are alike and the mesh decides which is found.
fn along_branch(cell: &Cell, numerics: &Numerics, max_step: f64) -> Result<(StationaryShape, bool), StationaryError> {
    let (name, xi_s) = (CellName::of(cell), cell.xi_s);
    let settings = ContinuationSettings { first_step: 0.3f64.min(max_step), max_step, ..Default::default() };
    let mut branch = primary::start(cell, numerics, &settings)?;
    let domain = branch.problem.domain;
    let (mut folds, mut steepest, mut is_reached) = (Vec::new(), branch.state.parameter_slope().abs(), false);
    // A subnormal number counts as zero and leaves no room between itself and 0.
    if xi_s.abs() > f64::MIN_POSITIVE {
        if xi_s < 0.0 {
            branch.reverse();
        }
        let range = if xi_s > 0.0 { [f64::MIN_POSITIVE, xi_s] } else { [xi_s, -f64::MIN_POSITIVE] };
        let farther = |a: f64, b: f64| if b.abs() > a.abs() { b } else { a };
        let (mut furthest, mut before, mut course) = (0.0f64, 0.0, xi_s.signum());
        let ended = branch.follow(range, MOST_POINTS, |branch, _| {
            let (here, slope) = (branch.state.parameter(), branch.state.parameter_slope());
            (furthest, steepest) = (farther(furthest, here), steepest.max(slope.abs()));
            // The point on the bound of the range may lie before the fold that the step has passed.
            if slope * course < 0.0 {
                let fold = locate::fold_near(branch);
                // A step over a fold may pass ξ_s twice: the shape before the fold comes first.
                is_reached = fold.as_ref().is_ok_and(|fold| locate::reached_before(branch, fold, xi_s));
                if is_reached {
                    return false;
                }
                // The exact fold, or else the nearest point to it.
                folds.push(fold.map_or(before, |fold| fold.point.xi_s));
                course = -course;
            }
            before = here;
            folds.is_empty() || waist(&branch.system.gauss, &branch.state.solution, domain) > PINCHING * cell.r0
        });
        let turn = folds.iter().copied().fold(furthest, farther);
        match ended {
            _ if is_reached => {}
            Ok(Termination::ParameterBound(bound)) if bound == xi_s => {}
            Err(source) if folds.is_empty() => return Err(StationaryError::Lost { cell: name, xi_s, source }),
            Ok(Termination::PointLimit(points)) if folds.is_empty() => {
                return Err(StationaryError::PointLimit { cell: name, xi_s, points });
            }
            // The branch returned to ξ_s = 0 without a detected fold, or was stopped: it has no such shape.
            _ => return Err(StationaryError::OutOfReach { cell: name, xi_s, turn }),
        }
    }
    let is_near_fold = is_reached || branch.state.parameter_slope().abs() < FLAT * steepest;
    let (cortex, mut solution) = (Cortex::new(cell, domain, &[]), branch.state.solution);
    solution.scalars.truncate(SHAPE_SCALARS);
    Ok((StationaryShape { cortex, solution, folds }, is_near_fold))
}

/// A shape on a coarse mesh is accepted if its contour length agrees with a fine mesh to this relative accuracy.
const SAME: f64 = 1e-3;

impl StationaryShape {
    /// Refuses a shape at which the cell's own law cannot hold.
    fn holds(&self) -> Result<()> {
        let found = law::short_waves(&self.cortex, &self.solution);
        let cell = CellName::of(&self.cortex.cell);
        found.map_or(Ok(()), |source| Err(ShapeError::Law { cell, source }))
    }

    /// Solves for the shape to rounding; leaves it unchanged if this fails.
    fn polish(&mut self) -> Result<(), NewtonError> {
        let mut system = System::new(self.cortex.dimensions(), self.solution.m);
        let newton = Newton { tolerance: 1e-12, max_factorisations: 4, ..Newton::default() };
        let mut polished = self.solution.clone();
        newton.solve(&mut system, &mut NewtonScratch::default(), &mut self.cortex, &mut polished, &[], false)?;
        self.solution = polished;
        Ok(())
    }

    /// The same shape with every interval of its mesh divided into `parts`; `None` if the finer mesh does not confirm
    /// it.
    fn refined(self, parts: usize) -> Option<StationaryShape> {
        let coarse = &self.solution;
        let solution = coarse.on_mesh(&coarse.gauss(), &mesh::subdivided(&coarse.mesh, parts));
        let length = self.length();
        let mut fine = StationaryShape { solution, ..self };
        (fine.polish().is_ok() && (fine.length() - length).abs() < SAME * length).then_some(fine)
    }

    /// Contour length L.
    pub fn length(&self) -> f64 {
        self.solution.scalars[LENGTH]
    }

    /// Pressure p.
    pub fn pressure(&self) -> f64 {
        self.solution.scalars[PRESSURE]
    }

    /// Elongation H = (z(0) − z(1))/R0.
    pub fn elongation(&self) -> f64 {
        observables::elongation(&self.solution, self.cortex.domain, self.cortex.cell.r0)
    }

    /// Radius at u = ½, in L_h.
    pub fn equator_radius(&self) -> f64 {
        observables::equator_radius(&self.solution.gauss(), &self.solution)
    }

    /// The regulator φ at u; `None` without a regulator.
    pub fn regulator_at(&self, u: f64) -> Option<f64> {
        observables::regulator_at(&self.solution.gauss(), &self.solution, self.cortex.domain, u)
    }

    /// Perturbations of azimuthal number m, which need not be axisymmetric.
    pub fn azimuthal(&self, m: usize) -> Azimuthal {
        Azimuthal::new(&self.cortex, &self.solution, m)
    }

    /// The rightmost growth rates.
    ///
    /// # Errors
    /// Reduced volume, and energy of bending in κ0: see [`ShapePoint`](super::ShapePoint).
    pub fn reduced_volume_and_bending(&self) -> [f64; 2] {
        let [area, bending] = observables::area_and_bending(&self.solution.gauss(), &self.cortex, &self.solution);
        [observables::reduced_volume(self.cortex.cell.r0, area), bending]
    }

    /// As [`Stability::leading`].
    pub fn spectrum(&self) -> Result<Spectrum, StabilityError> {
        Stability::new(self.solution.m).leading(&self.cortex, &self.solution)
    }

    /// The error of the largest growth rate of `spectrum`: its change on halved intervals, infinite if they have no such shape.
    pub fn growth_rate_error(&self, spectrum: &Spectrum) -> f64 {
        let finer = self.clone().refined(2).and_then(|finer| finer.spectrum().ok());
        finer.map_or(f64::INFINITY, |finer| (finer.growth_rate() - spectrum.growth_rate()).abs())
    }
}
