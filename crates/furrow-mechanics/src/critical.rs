//! Critical radii: the radius below which a cell does not divide, and the singular point that sets it.
//!
//! For a mirror-symmetric cell it is the pitchfork, ξ_s*(R0_c, ε) = ξ_s; with a cue that breaks the symmetry, the fold
//! at which its stable branch ends. With a strong one-sided cue that fold need not bound division: a cell may pass by
//! the stable shape, the shape may oscillate, and the curve of folds may turn back, so that even smaller cells have no
//! stable shape. Divisions below the critical radius are therefore tried first, and a radius ends branches only where
//! the tried divisions come to rest.
//!
//! The radii of the preset are stored in a small file in `data/`, compiled in, with a hash of their parameters; others
//! are computed when first needed.

use std::sync::atomic::AtomicBool;
use std::sync::{Mutex, MutexGuard, PoisonError};

use furrow_bvp::{AugmentedReport, Codim2Curve, CurveError, Singularity};
use serde::{Deserialize, Serialize};

use crate::cortex::{Cortex, Domain};
use crate::division::{Division, DivisionError, DivisionInput, DivisionOptions, divide_with};
use crate::equilibria::branch::BranchOptions;
use crate::equilibria::budget::StepBudget;
use crate::equilibria::curves::{
    self, BoundaryCurves, Curve, CurvePoint, MOST_STEPS, SECOND, at_value, curve_point, pitchfork_point,
};
use crate::equilibria::error::{CellName, PointKind, Result, ShapeError};
use crate::equilibria::point::XI;
use crate::equilibria::{pitchfork, primary};
use furrow_cell::{Cell, Cue, Numerics, Parameter};

pub use trials::{divides_above, resting_radii, rests_below, rests_from};

mod trials;

/// Version of the file's format and of the method behind its numbers.
pub const FORMAT: u32 = 3;

/// The file stored for the preset `gao2026`; `furrow boundary` regenerates it.
const PRESET: &str = include_str!("../data/gao2026.boundary.json");

/// The singular point that bounds division.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum BoundaryKind {
    /// The pitchfork of the mirror-symmetric branch.
    Pitchfork,
    /// The fold at the end of the stable branch of a cell with a cue that breaks the symmetry.
    CuedFold,
    /// Without axial symmetry, the pitchfork of the bent states.
    BentPitchfork,
    /// Without axial symmetry, the fold of the bent states, where it comes before their pitchfork.
    BentFold,
}

impl BoundaryKind {
    /// Its kind of singular point.
    pub fn point(self) -> PointKind {
        match self {
            BoundaryKind::Pitchfork | BoundaryKind::BentPitchfork => PointKind::Pitchfork,
            BoundaryKind::CuedFold | BoundaryKind::BentFold => PointKind::Fold,
        }
    }
}

/// The radius at which cells with one cue begin to divide.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CriticalRadius {
    /// Their cue.
    pub cue: Cue,
    /// The singular point that bounds them.
    pub kind: BoundaryKind,
    /// Critical radius R0, in L_h.
    pub r0: f64,
    /// Slope dξ_s/dR0 of the curve there.
    pub slope: f64,
}

/// Radii at which cells with one cue rest undivided: from `from` to the critical radius.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RestingRadii {
    /// The upper end.
    #[serde(flatten)]
    pub critical: CriticalRadius,
    /// The smallest R0 at which a division was tried, in L_h. All divisions tried between it and the critical radius
    /// come to rest.
    pub from: f64,
}

/// The reason why a cell cannot divide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct End {
    /// The singular point that bounds it.
    pub kind: BoundaryKind,
    /// Radius below which cells like it do not divide.
    pub critical_r0: f64,
    /// R0/critical − 1 of the cell: negative.
    pub margin: f64,
}

/// Why a stored boundary is not used.
#[expect(missing_docs, reason = "the messages say what the fields are")]
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BoundaryError {
    /// It is not a boundary file.
    #[error("{file}: not a boundary file: {reason}")]
    Malformed { file: String, reason: String },
    /// It belongs to other parameters or to an older method.
    #[error("{file}: stale: computed for parameters {found}, not {expected}; compute it anew")]
    Stale { file: String, expected: String, found: String },
}

/// A boundary as stored.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stored {
    /// Version of the format.
    pub format: u32,
    /// Hash of all inputs of the numbers, see [`parameters_hash`].
    pub parameters: String,
    /// The kind of cell, for readers of the file; its radius and cue are ignored.
    pub cell: Cell,
    /// Critical radii at the activity of `cell`.
    pub radii: Vec<RestingRadii>,
    /// The curve of pitchforks ξ_s*(R0) of cells without a cue.
    pub pitchfork: Vec<CurvePoint>,
    /// Points at which the criticality changes.
    pub degenerate: Vec<CurvePoint>,
}

/// The common properties of cells that differ only by radius and cue.
fn without_size_and_cue(cell: &Cell) -> Cell {
    Cell { r0: 1.0, cue: Cue::none(), ..cell.clone() }
}

/// Hash of all inputs of a boundary: the cell except its radius and cue, collocation, and the version of the method.
pub fn parameters_hash(cell: &Cell, numerics: &Numerics) -> String {
    // Fields in the order of their declaration and numbers in shortest form, so that the text is the same on every host.
    let text = serde_json::to_string(&(FORMAT, without_size_and_cue(cell), numerics.stages, numerics.intervals))
        .unwrap_or_default();
    blake3::hash(text.as_bytes()).to_hex()[..16].to_string()
}

impl Stored {
    /// Computes the boundary of cells like `cell` for a set of cues, with the curve of pitchforks over a range of R0.
    /// Cues with a critical radius that bounds no division are left out.
    ///
    /// # Errors
    /// [`ShapeError`].
    pub fn compute(cell: &Cell, numerics: &Numerics, cues: &[Cue], range: [f64; 2]) -> Result<Stored> {
        let (cell, parameters) = (without_size_and_cue(cell), parameters_hash(cell, numerics));
        let budget = StepBudget::unlimited();
        let radius =
            |cue: &Cue| resting_radii(&cell.clone().with_cue(cue.clone()), numerics, &AXISYMMETRIC, &budget, None);
        let bounds = |found: &Result<_>| !matches!(found, Err(ShapeError::NoBound { .. }));
        let radii = cues.iter().map(radius).filter(bounds).collect::<Result<_>>()?;
        let Curve { points, degenerate, .. } = curves::pitchfork_curve(&cell, numerics, Parameter::R0, range)?;
        Ok(Stored { format: FORMAT, parameters, cell, radii, pitchfork: points, degenerate })
    }

    /// The boundary stored for the preset `gao2026`, for cells with its parameters.
    ///
    /// # Errors
    /// [`BoundaryError::Stale`] for other parameters.
    pub fn preset(cell: &Cell, numerics: &Numerics) -> Result<Stored, BoundaryError> {
        Stored::parse(PRESET, "gao2026.boundary.json", cell, numerics)
    }

    /// Reads a stored boundary and refuses one for other parameters; `file` is its name in errors.
    ///
    /// # Errors
    /// [`BoundaryError`].
    pub fn parse(text: &str, file: &str, cell: &Cell, numerics: &Numerics) -> Result<Stored, BoundaryError> {
        let stored: Stored = serde_json::from_str(text)
            .map_err(|error| BoundaryError::Malformed { file: file.into(), reason: error.to_string() })?;
        let expected = parameters_hash(cell, numerics);
        if stored.format != FORMAT || stored.parameters != expected {
            return Err(BoundaryError::Stale { file: file.into(), expected, found: stored.parameters });
        }
        Ok(stored)
    }
}

/// Radii at which the search for a curve starts, in order.
pub const STARTS: [f64; 7] = [2.0, 2.5, 3.0, 1.6, 4.0, 6.0, 1.0];

/// Follows a curve to the point with ξ_s = `xi_s`, in the direction that leads there, and returns the report of the
/// last Newton iteration. Where a curve of folds turns back in the parameter there is a cusp, beyond which it describes
/// another fold. A curve is abandoned when it leads well away from ξ_s again.
fn to_activity<S: Singularity<Cortex> + Clone>(
    curve: &mut Codim2Curve<Cortex, S>,
    xi_s: f64,
    parameter: Parameter,
    through_cusps: bool,
    budget: &StepBudget<'_>,
) -> Result<AugmentedReport, CurveError> {
    curve.head_for(XI, xi_s);
    let (mut tried, mut last) = (curve.work.steps + curve.work.rejected, AugmentedReport::default());
    let direction = curve.tangent.scalars[SECOND];
    // Allowed values of the parameter along the curve.
    let allowed = match parameter {
        Parameter::R0 => 0.05..50.0,
        Parameter::Epsilon => 0.05..0.99,
        _ => f64::NEG_INFINITY..f64::INFINITY,
    };
    let mut nearest = f64::INFINITY;
    curve.follow_to(XI, xi_s, MOST_STEPS, |curve, report| {
        last = *report;
        let distance = (curve.solution.scalars[XI] - xi_s).abs();
        nearest = nearest.min(distance);
        let goes_on = through_cusps || curve.tangent.scalars[SECOND] * direction > 0.0;
        let before = std::mem::replace(&mut tried, curve.work.steps + curve.work.rejected);
        let affordable = budget.spend(tried - before);
        affordable && goes_on && distance < 2.0 * nearest + 1.0 && allowed.contains(&curve.solution.scalars[SECOND])
    })?;
    Ok(last)
}

/// Whether a point of a curve bounds division. A curve that rises with R0 does not: smaller cells have no stable shape.
fn bounds(parameter: Parameter, point: &CurvePoint) -> bool {
    let rises = point.slope > 0.0;
    parameter != Parameter::R0 || !rises
}

/// The answer of [`critical_value`] without a search, from curves over a range that were computed with the cell's
/// activity: where they [pass](passage) it.
pub fn value_on(curves: &BoundaryCurves, parameter: Parameter) -> Option<(BoundaryKind, CurvePoint)> {
    passage(curves).filter(|(_, point)| bounds(parameter, point))
}

/// The point where the only curve of pitchforks, or the first of folds, passes the activity that it was computed with, if it does so
/// once.
pub fn passage(curves: &BoundaryCurves) -> Option<(BoundaryKind, CurvePoint)> {
    let (kind, curve) = match &curves.pitchforks[..] {
        [curve] => (BoundaryKind::Pitchfork, curve),
        [] => (BoundaryKind::CuedFold, curves.folds.first()?),
        // Each has first pitchforks on only a part of it.
        _ => return None,
    };
    curve.at_activity.map(|point| (kind, point))
}

/// The value of `parameter` that bounds the division of a cell at its activity ξ_s: at the first pitchfork if the cell
/// is mirror-symmetric for every value, else at the fold that ends its stable shapes. The search for the curve starts
/// at each of `starts` in turn. Along R0 this is the critical radius; smaller cells do not divide.
///
/// # Errors
/// [`ShapeError`] if the curve does not pass that activity.
pub fn critical_value(
    cell: &Cell,
    numerics: &Numerics,
    parameter: Parameter,
    starts: &[f64],
    budget: &StepBudget<'_>,
) -> Result<(BoundaryKind, CurvePoint)> {
    let kind = match curves::domain_along(cell, parameter) {
        Domain::Half => BoundaryKind::Pitchfork,
        Domain::Full => BoundaryKind::CuedFold,
    };
    curves::refuse_par(cell, kind.point())?;
    let lost = curves::lost(kind.point(), Parameter::XiS, cell.xi_s);
    let attempt = |cell: &Cell| {
        if kind == BoundaryKind::CuedFold {
            let fold = primary::failure_fold(cell, numerics, budget)?;
            let mut curve = curves::through_fold(cell, &fold, parameter, true).map_err(&lost)?;
            to_activity(&mut curve, cell.xi_s, parameter, false, budget).map_err(&lost)?;
            return Ok(curve_point(&curve, None));
        }
        let first = pitchfork::first_within(cell, numerics, &BranchOptions::default(), budget)?;
        let mut curve = curves::through_pitchfork(cell, &first, parameter, true).map_err(&lost)?;
        let report = to_activity(&mut curve, cell.xi_s, parameter, true, budget).map_err(&lost)?;
        Ok(pitchfork_point(&mut curve, &report).map_err(|error| lost(CurveError::Start(error)))?.0)
    };
    let mut last = lost(CurveError::NotReached { steps: 0, reached: f64::NAN });
    for start in starts {
        match attempt(&at_value(cell, parameter, *start)) {
            Ok(point) if bounds(parameter, &point) => return Ok((kind, point)),
            Ok(CurvePoint { value: r0, .. }) => {
                last = ShapeError::NoBound { cell: CellName::of(cell), kind: kind.point(), r0 };
            }
            Err(error) => last = error,
        }
        budget.check(cell)?;
    }
    Err(last)
}

/// The critical radius of cells like `cell`, for any radius of `cell`, computed without stored radii.
///
/// ```
/// use furrow_cell::{Cell, Numerics};
///
/// let critical = furrow_mechanics::critical::critical_radius(&Cell::new(1.0), &Numerics::default())?;
/// assert!((critical.r0 - 1.7207572).abs() < 1e-6);
/// # Ok::<(), furrow_mechanics::equilibria::ShapeError>(())
/// ```
///
/// # Errors
/// [`ShapeError`] if there is no critical radius.
pub fn critical_radius(cell: &Cell, numerics: &Numerics) -> Result<CriticalRadius> {
    critical_radius_within(cell, numerics, &StepBudget::unlimited())
}

/// As [`critical_radius`], within a budget.
///
/// # Errors
/// The errors of [`critical_radius`]; [`ShapeError::OutOfBudget`] and [`ShapeError::Interrupted`] if the search is
/// stopped before its end.
pub fn critical_radius_within(cell: &Cell, numerics: &Numerics, budget: &StepBudget<'_>) -> Result<CriticalRadius> {
    let (kind, point) = critical_value(cell, numerics, Parameter::R0, &STARTS, budget)?;
    Ok(CriticalRadius { cue: cell.cue.clone(), kind, r0: point.value, slope: point.slope })
}

/// How critical radii are computed.
#[derive(Clone, Copy, Debug)]
pub struct Method {
    /// Its name and version in an [`Archive`].
    pub name: &'static str,
    /// Whether cells with a cue have a critical radius.
    pub applies: fn(&Cue) -> bool,
    /// The critical radius of cells like one.
    pub radius: fn(&Cell, &Numerics, &StepBudget<'_>) -> Result<CriticalRadius>,
    /// A division that is tried below a critical radius, until the flag is set.
    pub divide: fn(&DivisionInput, Option<&AtomicBool>) -> Result<Division, DivisionError>,
    /// The numerics for cells close to their critical radius.
    pub refined: fn(&Numerics) -> Numerics,
}

/// Cells with axial symmetry.
pub const AXISYMMETRIC: Method = Method {
    name: "axisymmetric 1",
    applies: |_| true,
    radius: critical_radius_within,
    divide: |input, cancel| {
        divide_with(input, DivisionOptions { cancel, ..DivisionOptions::default() }).map(|found| found.0)
    },
    refined: |numerics| Numerics { intervals: 2 * numerics.intervals, ..*numerics },
};

/// Keeps critical radii for later runs. Both are JSON texts.
pub trait Archive: std::fmt::Debug + Sync {
    /// The stored result of a search.
    fn get(&self, search: &str) -> Option<String>;
    /// Stores the result of a search.
    fn put(&self, search: &str, found: &str);
}

/// A search for the critical radius of cells that differ only by their radius.
#[derive(Clone, Debug, PartialEq)]
pub struct Search {
    /// One of the cells, with radius 1.
    cell: Cell,
    /// Whether the numerics are refined, for cells close to their critical radius.
    fine: bool,
}

impl Search {
    fn of(cell: &Cell, fine: bool) -> Search {
        Search { cell: Cell { r0: 1.0, cue: cell.simplified_cue(), ..cell.clone() }, fine }
    }
}

/// Determines which cells rest undivided, from stored critical radii if they apply, and from one search each for
/// others.
///
/// [`ends`](Self::ends) searches if necessary. A program with several threads asks for the [`missing`](Self::missing)
/// searches and [runs](Self::run) them on any thread; no lock is held meanwhile.
#[derive(Debug)]
pub struct CriticalRadii<'a> {
    numerics: Numerics,
    method: Method,
    archive: Option<&'a dyn Archive>,
    interrupt: Option<&'a AtomicBool>,
    found: Mutex<Vec<(Search, Result<RestingRadii>)>>,
}

/// Most steps, along branches and curves, of a search for one critical radius. Nearly all successful searches take 20
/// to 500 steps; searches without a result, or with a very small radius, take a thousand to ten thousand. A radius
/// saves some dozens of divisions of cells that are too small, and each of them costs as much as 20 to 40 steps.
pub const MOST_SEARCHED: usize = 600;

/// Cells within this relative distance of their critical radius are compared with a radius from a mesh twice as fine.
const NEAR: f64 = 1e-3;

impl<'a> CriticalRadii<'a> {
    /// With the stored radii of the preset `gao2026`.
    pub fn new(numerics: &Numerics) -> CriticalRadii<'a> {
        let preset = Cell::new(1.0);
        let stored = Stored::preset(&preset, numerics);
        CriticalRadii::with_radii(&preset, numerics, stored.map_or_else(|_| Vec::new(), |stored| stored.radii))
    }

    /// With given radii of cells like `cell`.
    pub(crate) fn with_radii(cell: &Cell, numerics: &Numerics, radii: Vec<RestingRadii>) -> CriticalRadii<'a> {
        let entry = |radii: RestingRadii| {
            let cell = without_size_and_cue(cell).with_cue(radii.critical.cue.clone());
            (Search { cell, fine: false }, Ok(radii))
        };
        let found = Mutex::new(radii.into_iter().map(entry).collect());
        CriticalRadii { numerics: *numerics, method: AXISYMMETRIC, archive: None, interrupt: None, found }
    }

    /// By another method, without stored radii.
    pub fn by(method: Method, numerics: &Numerics) -> CriticalRadii<'a> {
        CriticalRadii { method, ..CriticalRadii::with_radii(&Cell::new(1.0), numerics, Vec::new()) }
    }

    /// The same with an archive, which searches read before they begin.
    #[must_use]
    pub fn kept_in(self, archive: Option<&'a dyn Archive>) -> CriticalRadii<'a> {
        CriticalRadii { archive, ..self }
    }

    /// Whether cells with a cue can have a critical radius.
    pub fn apply_to(&self, cue: &Cue) -> bool {
        (self.method.applies)(cue)
    }

    /// The same, with searches that end when the flag is set.
    #[must_use]
    pub fn interrupted_by(self, flag: &'a AtomicBool) -> CriticalRadii<'a> {
        CriticalRadii { interrupt: Some(flag), ..self }
    }

    /// Whether the critical radius of cells like this one is known, or is known not to exist.
    pub fn knows(&self, cell: &Cell) -> bool {
        self.result(&Search::of(cell, false)).is_some()
    }

    /// The search that the answer for a cell needs next; `None` if the answer is known. A cell close to its critical
    /// radius needs two.
    pub fn missing(&self, cell: &Cell) -> Option<Search> {
        self.known_end(cell).err().map(|search| *search)
    }

    /// Runs a search, with at most [`MOST_SEARCHED`] steps. An interrupted search leaves no result.
    pub fn run(&self, search: &Search) {
        let numerics = if search.fine { (self.method.refined)(&self.numerics) } else { self.numerics };
        let key = serde_json::to_string(&(self.method.name, &search.cell, search.fine, &numerics)).unwrap_or_default();
        let kept = self.archive.and_then(|archive| serde_json::from_str(&archive.get(&key)?).ok());
        let found = match kept {
            Some(radii) => Ok(radii),
            None => {
                let found = self.search(search, &numerics);
                if let (Some(archive), Ok(radii)) = (self.archive, &found) {
                    archive.put(&key, &serde_json::to_string(radii).unwrap_or_default());
                }
                found
            }
        };
        if found != Err(ShapeError::Interrupted) {
            self.lock().push((search.clone(), found));
        }
    }

    fn search(&self, search: &Search, numerics: &Numerics) -> Result<RestingRadii> {
        let budget = StepBudget::new(MOST_SEARCHED, self.interrupt);
        match search.fine {
            // The divisions were tried with the coarser radius.
            true => (self.method.radius)(&search.cell, numerics, &budget)
                .map(|critical| RestingRadii { from: critical.r0, critical }),
            false => resting_radii(&search.cell, numerics, &self.method, &budget, self.interrupt),
        }
    }

    /// The reason why a cell cannot divide; `None` if it can, or if it is smaller than all radii with a tried division.
    ///
    /// # Errors
    /// [`ShapeError`] if its critical radius is not found in [`MOST_SEARCHED`] steps, or bounds no division; the search
    /// is made only once.
    pub fn ends(&self, cell: &Cell) -> Result<Option<End>> {
        let mut last = None;
        loop {
            match self.known_end(cell) {
                Ok(end) => return end,
                Err(search) if last.as_ref() == Some(&search) => return Err(ShapeError::Interrupted),
                Err(search) => {
                    self.run(&search);
                    last = Some(search);
                }
            }
        }
    }

    /// As [`ends`](Self::ends) if no search is needed, else the next search.
    fn known_end(&self, cell: &Cell) -> Result<Result<Option<End>>, Box<Search>> {
        let known = |fine| {
            let search = Search::of(cell, fine);
            self.result(&search).ok_or_else(|| Box::new(search))
        };
        let coarse = known(false)?;
        // Cells farther away keep the coarser radius: the answer for a cell must not depend on earlier questions, which
        // come in an order that depends on timing.
        let near = coarse.as_ref().is_ok_and(|radii| (cell.r0 / radii.critical.r0 - 1.0).abs() < NEAR);
        let fine = if near { Some(known(true)?) } else { None };
        Ok(coarse.and_then(|RestingRadii { critical, from }| {
            let CriticalRadius { kind, r0: critical_r0, .. } = fine.transpose()?.map_or(critical, |fine| fine.critical);
            let margin = cell.r0 / critical_r0 - 1.0;
            Ok((margin < 0.0 && cell.r0 >= from).then_some(End { kind, critical_r0, margin }))
        }))
    }

    /// The radius below which cells like this one rest, if it is known.
    pub fn known_radius(&self, cell: &Cell) -> Option<f64> {
        Some(self.result(&Search::of(cell, false))?.ok()?.critical.r0)
    }

    fn result(&self, search: &Search) -> Option<Result<RestingRadii>> {
        self.lock().iter().find(|(other, _)| other == search).map(|(_, found)| found.clone())
    }

    fn lock(&self) -> MutexGuard<'_, Vec<(Search, Result<RestingRadii>)>> {
        // Entries are added only when complete, so that a poisoned lock is harmless.
        self.found.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn preset() -> Stored {
        Stored::parse(PRESET, "preset", &Cell::new(1.0), &Numerics::default()).unwrap()
    }

    #[test]
    fn the_stored_boundary_is_fresh_and_right() {
        let stored = preset();
        assert!(stored.radii.len() >= 2);
        for RestingRadii { critical: radius, from } in &stored.radii {
            assert!(*from < 0.21 * radius.r0);
            let cell = Cell::new(1.0).with_cue(radius.cue.clone());
            let again = critical_radius(&cell, &Numerics::default()).unwrap();
            assert_eq!(again.kind, radius.kind);
            assert!((again.r0 / radius.r0 - 1.0).abs() < 1e-9, "{again:?} {radius:?}");
        }
    }

    #[test]
    fn other_parameters_are_refused() {
        let cell = Cell { epsilon: 0.86, ..Cell::new(1.0) };
        let error = Stored::parse(PRESET, "preset", &cell, &Numerics::default()).unwrap_err();
        assert!(matches!(error, BoundaryError::Stale { .. }), "{error}");
        let error = Stored::parse("{}", "preset", &cell, &Numerics::default()).unwrap_err();
        assert!(matches!(error, BoundaryError::Malformed { .. }), "{error}");
        // Radius and cue are not parameters of the boundary.
        let cell = Cell::new(4.0).with_cue(Cue::published());
        assert!(Stored::parse(PRESET, "preset", &cell, &Numerics::default()).is_ok());
    }

    #[test]
    fn cells_near_the_boundary_are_judged_by_a_finer_solution() {
        // A stored radius with an error of 5e-4 must not decide about a cell within 1e-3 of it.
        let exact = preset().radii.into_iter().find(|radii| radii.critical.cue.is_none()).unwrap();
        let r0_c = exact.critical.r0;
        let off = CriticalRadius { r0: r0_c * 1.0005, ..exact.critical };
        let off = RestingRadii { critical: off, ..exact };
        let radii = CriticalRadii::with_radii(&Cell::new(1.0), &Numerics::default(), vec![off]);
        assert_eq!(radii.ends(&Cell::new(r0_c * 1.0002)).unwrap(), None);
        let end = radii.ends(&Cell::new(r0_c * 0.9999)).unwrap().unwrap();
        assert!((end.critical_r0 / r0_c - 1.0).abs() < 1e-8);
        assert!((end.margin + 1e-4).abs() < 1e-7);
    }
}
