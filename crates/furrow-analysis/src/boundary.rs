//! The boundary of division over a parameter: curves of pitchforks and folds, and the place of the boundary at a cell's own activity.

use crate::diagram::Edges;
use crate::json::filled;
use furrow_cell::{Cell, Numerics, Parameter, Settings};
use furrow_input::InputError;
use furrow_lineage::batch::PhasePlane;
use furrow_mechanics::critical::{self, BoundaryKind, Method};
use furrow_mechanics::equilibria::azimuthal_threshold::threshold_curve;
use furrow_mechanics::equilibria::curves::{self, BoundaryCurves, Curve, CurveEnd, CurvePoint};
use furrow_mechanics::equilibria::{ShapeError, StepBudget};
use serde_json::{Value, json};
use std::sync::atomic::AtomicBool;

/// The boundary of division over a parameter.
#[derive(Clone, Debug)]
pub struct BoundaryStudy {
    /// The cell, without what varies.
    pub cell: Cell,
    /// What varies.
    pub parameter: Parameter,
    /// Its range.
    pub range: [f64; 2],
    /// The curves through the first pitchforks; empty if a cue breaks the symmetry.
    pub pitchforks: Vec<Curve>,
    /// Curves of folds.
    pub folds: Vec<Curve>,
    /// Where two folds are born.
    pub cusps: Vec<CurvePoint>,
    /// The place of the boundary at the cell's own activity.
    pub critical: Option<CurvePoint>,
    /// Thresholds of disturbances that are not axisymmetric, by azimuthal number; `None` if they were not asked for.
    pub azimuthal: Option<Vec<(usize, Curve)>>,
    /// Without axial symmetry, the curves where bent states begin and where the stable ones end, by name; `None` if they were not asked for.
    pub bent: Option<Vec<(&'static str, Curve)>>,
    /// Where stable bent states end at the cell's activity, over R0.
    pub bent_critical: Option<CurvePoint>,
    /// What could not be followed or found.
    pub warnings: Vec<String>,
}

/// Values at which a cue is checked over the range of one of its numbers.
const STEPS: u32 = 64;

/// A cell at the first value of a range of one of its parameters, and `settings` with it. `sources` are what errors call the first
/// and the last value.
///
/// # Errors
/// A value in the range is not allowed.
pub fn over_range(
    settings: &mut Settings,
    mut cell: Cell,
    parameter: Parameter,
    [from, to]: [f64; 2],
    sources: [&str; 2],
) -> Result<Cell, InputError> {
    for (source, value) in [(sources[1], to), (sources[0], from)] {
        if parameter.is_of_cue() {
            // On the way as well: two bands may be far enough apart at both ends and not in between.
            for k in 0..=STEPS {
                let way = from + (to - from) * f64::from(k) / f64::from(STEPS);
                parameter.set(&mut cell, if value == to { value } else { way });
                cell.cue.check().map_err(|e| InputError::not_allowed(source, e.field, e.value, e.allowed))?;
            }
        } else {
            settings.set_number(source, parameter.name(), value)?;
            settings.check_shell(source)?;
        }
        parameter.set(&mut cell, value);
    }
    Ok(cell)
}

/// Further curves and points to compute beside the curve that bounds division.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoundaryOptions {
    /// The folds of mirror-symmetric shapes too.
    pub folds: bool,
    /// Whether to find the boundary at the cell's own activity.
    pub critical: bool,
    /// Thresholds of disturbances cos mφ up to this m.
    pub azimuthal: Option<usize>,
}

/// Follows the boundary of division of a cell over the range of a parameter.
///
/// # Errors
/// [`ShapeError`]: the boundary, or the point on it that was asked for, cannot be found.
pub fn boundary(
    cell: &Cell,
    numerics: &Numerics,
    parameter: Parameter,
    range: [f64; 2],
    options: BoundaryOptions,
) -> Result<BoundaryStudy, ShapeError> {
    let activity = options.critical.then_some(cell.xi_s);
    let found = match options.folds {
        true => curves::boundary_and_folds(cell, numerics, parameter, range, activity)?,
        false => curves::boundary_curves(cell, numerics, parameter, range, activity)?,
    };
    let mut warnings = Vec::new();
    let is_symmetric = |value: f64| {
        let mut cell = cell.clone();
        parameter.set(&mut cell, value);
        cell.is_mirror_symmetric()
    };
    if found.pitchforks.is_empty() && range.into_iter().all(is_symmetric) {
        warnings.push("no end of the range has a pitchfork; the curves are those of folds".to_owned());
    }
    let point = || critical_point(cell, numerics, parameter, range, &found, &mut warnings);
    let critical = match options.critical.then(point) {
        // The curves stay an answer.
        Some(Err(error)) => {
            warnings.push(format!("no critical {parameter}: {error}"));
            None
        }
        found => found.transpose()?,
    };
    if let Some(point) = critical.filter(|point| !is_inside(range, point)) {
        warnings.push(format!("the critical {parameter} = {:.6} is outside the range", point.value));
    }
    let BoundaryCurves { pitchforks, folds } = found;
    let symmetric = !pitchforks.is_empty();
    for (k, curve) in pitchforks.iter().enumerate() {
        warnings.extend(curve.error().map(|error| format!("{} is followed no further: {error}", pitchfork_name(k))));
    }
    for (k, fold) in folds.iter().enumerate() {
        match &fold.ended {
            CurveEnd::Stopped(error) => warnings.push(format!("fold {k} is followed no further: {error}")),
            CurveEnd::Cusp(cusp) if !symmetric => {
                warnings.push(format!("fold {k} ends within the range, in a cusp at {parameter} = {:.6}", cusp.value));
            }
            _ => {}
        }
    }
    let azimuthal = options.azimuthal.map(|most| thresholds(cell, numerics, parameter, range, most, &mut warnings));
    Ok(BoundaryStudy {
        cell: cell.clone(),
        parameter,
        range,
        pitchforks,
        cusps: cusps(&folds),
        folds,
        critical,
        azimuthal,
        bent: None,
        bent_critical: None,
        warnings,
    })
}

/// The curves that bound the outcomes of a plane, with the thresholds of disturbances cos mφ for m up to `azimuthal`, and what could
/// not be followed. None over a single value.
pub fn edges(plane: &PhasePlane, azimuthal: usize) -> (Edges, Vec<String>) {
    let PhasePlane { cell, numerics, parameter, across, .. } = plane;
    let numerics = &Numerics { modes: 0, ..*numerics };
    let mut warnings = Vec::new();
    let range = match (across.first(), across.last()) {
        (Some(&from), Some(&to)) if across.len() > 1 && from != to => [from, to],
        _ => return (Edges::default(), warnings),
    };
    let found = curves::boundary_and_folds(cell, numerics, *parameter, range, None).map(|found| Edges {
        pitchforks: found.pitchforks,
        folds: found.folds,
        ..Edges::default()
    });
    let found = found.unwrap_or_else(|error| {
        warnings.push(format!("the picture shows the edges at each value, without curves: {error}"));
        Edges::default()
    });
    (Edges { azimuthal: thresholds(cell, numerics, *parameter, range, azimuthal, &mut warnings), ..found }, warnings)
}

/// The thresholds of disturbances of azimuthal number 1 … `most`, with a warning for each that is not found or is incomplete.
fn thresholds(
    cell: &Cell,
    numerics: &Numerics,
    parameter: Parameter,
    range: [f64; 2],
    most: usize,
    warnings: &mut Vec<String>,
) -> Vec<(usize, Curve)> {
    let mut found = Vec::new();
    for m in 1..=most {
        match threshold_curve(cell, numerics, parameter, range, m) {
            Ok(curve) => {
                warnings.extend(curve.error().map(ToString::to_string));
                found.push((m, curve));
            }
            Err(error) => warnings.push(format!("no threshold for m = {m}: {error}")),
        }
    }
    found
}

/// Whether a point of a curve is in a range of the parameter.
fn is_inside([from, to]: [f64; 2], point: &CurvePoint) -> bool {
    (from.min(to)..=from.max(to)).contains(&point.value)
}

/// The name of a curve of pitchforks.
fn pitchfork_name(k: usize) -> String {
    if k == 0 { "pitchfork".to_owned() } else { format!("pitchfork {k}") }
}

/// Where the boundary lies at the cell's activity: where the curve over the range passes it, else it is searched for.
/// Along R0 it is the critical radius of a tree, from wherever the range begins: a curve of folds that begins at the smallest radii
/// may be another one. If this radius is outside the range, and the curve passes the activity inside it where ξ_s* rises with R0, this
/// point is given. Warnings say if smaller cells divide, or larger ones rest, all the same.
fn critical_point(
    cell: &Cell,
    numerics: &Numerics,
    parameter: Parameter,
    range: [f64; 2],
    curves: &BoundaryCurves,
    warnings: &mut Vec<String>,
) -> Result<CurvePoint, ShapeError> {
    let [from, to] = range;
    let middle = [0.5 * (from + to), from, to];
    let over_r0 = parameter == Parameter::R0;
    let starts = if over_r0 { &critical::STARTS[..] } else { &middle };
    let search = || critical::critical_value(cell, numerics, parameter, starts, &StepBudget::unlimited());
    let same_fold = |(kind, _): &(BoundaryKind, CurvePoint)| !over_r0 || *kind == BoundaryKind::Pitchfork;
    let found = critical::value_on(curves, parameter).filter(same_fold).map_or_else(search, Ok);
    let rising = critical::passage(curves).filter(|(kind, point)| {
        let rises = *kind == BoundaryKind::Pitchfork && point.slope > 0.0;
        over_r0 && rises && !found.as_ref().is_ok_and(|(_, found)| is_inside(range, found))
    });
    if let Some((_, point)) = rising {
        let r0 = point.value;
        warnings
            .push(format!("ξ_s* rises with R0 at {r0:.6}: smaller cells divide there, and larger ones come to rest"));
        return Ok(point);
    }
    let (kind, point) = found?;
    if over_r0 {
        warnings.extend(trials(cell, numerics, (kind, point.value), &critical::AXISYMMETRIC, None));
    }
    Ok(point)
}

/// What trial divisions just below and just above a critical radius say against it.
pub(crate) fn trials(
    cell: &Cell,
    numerics: &Numerics,
    at: (BoundaryKind, f64),
    method: &Method,
    cancel: Option<&AtomicBool>,
) -> impl Iterator<Item = String> {
    let below = critical::rests_below(cell, numerics, at, method, cancel).err();
    let above = critical::divides_above(cell, numerics, at, method, cancel).err();
    below.into_iter().chain(above).map(|error| error.to_string())
}

/// The cusps of fold curves, each once although two curves lead to it.
fn cusps(folds: &[Curve]) -> Vec<CurvePoint> {
    let mut cusps: Vec<CurvePoint> = Vec::new();
    for cusp in folds.iter().filter_map(Curve::cusp) {
        let same =
            |c: &CurvePoint| (c.value - cusp.value).abs() + (c.xi_s - cusp.xi_s).abs() < 1e-6 * (1.0 + cusp.xi_s.abs());
        if !cusps.iter().any(same) {
            cusps.push(cusp);
        }
    }
    cusps
}

/// A point of a curve, with the curve's name if there are several; `value` is the value of the parameter that varies.
pub fn point_document(curve: impl Into<Value>, p: &CurvePoint) -> Value {
    filled(json!({
        "curve": curve.into(), "r0": p.r0, "epsilon": p.epsilon, "value": p.value, "xi_s": p.xi_s, "H": p.elongation,
        "criticality": p.criticality(), "coefficient": p.coefficient,
    }))
}

impl BoundaryStudy {
    /// As `furrow boundary --json` prints it.
    pub fn document(&self) -> Value {
        let points = |points: &[CurvePoint]| points.iter().map(|p| point_document(Value::Null, p)).collect::<Vec<_>>();
        let folds = || self.folds.iter().enumerate();
        let end = |(curve, fold): (usize, &Curve)| {
            let value = fold.cusp().or(fold.points.last().copied()).map_or(f64::NAN, |point| point.value);
            json!({ "curve": curve, "value": value, "reason": fold.ended.name() })
        };
        let of_folds = folds().flat_map(|(k, fold)| fold.points.iter().map(move |p| point_document(k, p)));
        // Several curves are numbered.
        let number = |k: usize| if self.pitchforks.len() > 1 { k.into() } else { Value::Null };
        let of_pitchforks = self
            .pitchforks
            .iter()
            .enumerate()
            .flat_map(|(k, curve)| curve.points.iter().map(move |point| point_document(number(k), point)));
        let mut document = json!({
            "vary": self.parameter.to_string(),
            "cue": self.cell.cue,
            "pitchfork": of_pitchforks.collect::<Vec<_>>(),
            "degenerate": points(&self.degenerate()),
            "folds": of_folds.collect::<Vec<_>>(),
            "ends": folds().map(end).collect::<Vec<_>>(),
            "cusps": points(&self.cusps),
            "critical": self.critical.map(|point| point.value),
        });
        if let Some(point) = &self.critical {
            document["critical_point"] = point_document(Value::Null, point);
        }
        if let Some(curves) = &self.azimuthal {
            let of = |m: usize, p: &CurvePoint| json!({ "m": m, "r0": p.r0, "epsilon": p.epsilon, "value": p.value, "xi_s": p.xi_s, "H": p.elongation });
            let rows = curves.iter().flat_map(|(m, curve)| curve.points.iter().map(move |p| of(*m, p)));
            document["azimuthal"] = rows.collect();
        }
        if let Some(curves) = &self.bent {
            let of = |(name, curve): &(&'static str, Curve)| ((*name).to_owned(), points(&curve.points).into());
            let mut bent: serde_json::Map<String, Value> = curves.iter().map(of).collect();
            bent.insert("degenerate".to_owned(), points(&self.bent_degenerate()).into());
            bent.insert("critical".to_owned(), self.bent_critical.map(|point| point.value).into());
            document["bent"] = filled(Value::Object(bent));
        }
        document
    }

    /// Where criticality changes along curves of pitchforks, in the range.
    fn degenerate(&self) -> Vec<CurvePoint> {
        let found = self.pitchforks.iter().flat_map(degenerate);
        found.filter(|point| is_inside(self.range, point)).collect()
    }

    /// The names of the curves of pitchforks.
    pub fn pitchfork_names(&self) -> impl Iterator<Item = (String, &Curve)> {
        self.pitchforks.iter().enumerate().map(|(k, curve)| (pitchfork_name(k), curve))
    }

    fn bent_degenerate(&self) -> Vec<CurvePoint> {
        self.bent.iter().flatten().flat_map(|(_, curve)| degenerate(curve)).collect()
    }

    /// All points with the names of their curves.
    pub fn named(&self) -> Vec<(String, CurvePoint)> {
        let folds = self.folds.iter().enumerate().map(|(k, fold)| (format!("fold {k}"), fold.points.clone()));
        let pitchforks = self.pitchfork_names().map(|(name, curve)| (name, curve.points.clone()));
        let before = pitchforks.chain([("degenerate".to_owned(), self.degenerate())]);
        let after = [("cusp".to_owned(), self.cusps.clone()), ("critical".to_owned(), Vec::from_iter(self.critical))];
        let azimuthal = self.azimuthal.iter().flatten().map(|(m, curve)| (format!("m = {m}"), curve.points.clone()));
        let bent = self.bent.iter().flatten().map(|(name, curve)| (format!("bent {name}"), curve.points.clone()));
        let bent_after = [
            ("bent degenerate".to_owned(), self.bent_degenerate()),
            ("bent critical".to_owned(), Vec::from_iter(self.bent_critical)),
        ];
        let curves = before.chain(folds).chain(azimuthal).chain(bent).chain(after).chain(bent_after);
        curves.flat_map(|(name, points)| points.into_iter().map(move |point| (name.clone(), point))).collect()
    }
}

/// Where criticality changes along a curve; such points are neither sub- nor supercritical.
fn degenerate(curve: &Curve) -> Vec<CurvePoint> {
    curve.degenerate.iter().map(|p| CurvePoint { coefficient: None, ..*p }).collect()
}
