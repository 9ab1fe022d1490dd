//! Bent states, without axial symmetry, beside the axisymmetric shapes of the same studies.

use crate::boundary::{BoundaryOptions, BoundaryStudy, boundary, trials};
use crate::diagram::{Diagram, diagram};
use furrow_cell::{Cell, Numerics, Parameter};
use furrow_lineage::batch::PhasePlane;
use furrow_lineage::batch::scheduler;
use furrow_mechanics::equilibria::curves::{Curve, CurvePoint};
use furrow_mechanics::equilibria::{BranchOptions, ShapeError, StepBudget};
use furrow_surface::bent::{self, BentBranch, BentError};
use furrow_surface::bent_curves;

/// Name of the curve where bent states begin.
const THRESHOLD: &str = "threshold";
/// Steps of that curve.
const POINTS: u32 = 24;

/// [`diagram`], with the bent branch among its branches if the numerics have azimuthal modes, and the bent states; they are `None`
/// if they cannot be followed, with a warning. The growth rate of an axisymmetric shape is then the largest for all modes of the
/// numerics, as for a bent state.
///
/// # Errors
/// [`BentError::NoMirror`], and a branch of axisymmetric shapes that cannot be followed.
pub fn diagram_with_bent(
    cell: &Cell,
    numerics: &Numerics,
    options: &BranchOptions,
) -> Result<(Diagram, Option<BentBranch>), BentError> {
    let xi_max = options.xi[1];
    // Before the other branches: a cell without bent states is refused at once.
    let (found, warning) = match (numerics.modes > 0).then(|| bent::branch(cell, numerics, xi_max)).transpose() {
        Err(error @ BentError::NoMirror { .. }) => return Err(error),
        Err(error) => (None, Some(format!("no bent branch: {error}"))),
        Ok(found) => (found, None),
    };
    // The linear theory of disturbances around the axis has the paper's law alone.
    let modes = if cell.law.is_none() { numerics.modes } else { 0 };
    let options = BranchOptions { azimuthal: options.azimuthal.max(modes), ..options.clone() };
    let mut all = diagram(cell, numerics, &options)?;
    for (_, branch) in all.branches.iter_mut().filter(|_| modes > 0) {
        for (point, rates) in branch.points.iter_mut().zip(&branch.azimuthal.rates) {
            let largest = |most: Option<f64>, rate: &Option<f64>| most.zip(*rate).map(|(a, b)| a.max(b));
            point.growth_rate = rates.iter().take(modes).fold(point.growth_rate, largest);
        }
    }
    all.warnings.extend(warning);
    all.branches.extend(found.iter().map(|found| ("bent", found.shapes())));
    Ok((all, found))
}

/// [`boundary`], with the curves where bent states begin and where they end if the numerics have azimuthal modes.
///
/// # Errors
/// The errors of [`boundary`], and that neither critical radius was found. If one of them was found, a warning names the other, with or
/// without axial symmetry. Another warning says that no bent states are stable at the first value of the range.
pub fn boundary_with_bent(
    cell: &Cell,
    numerics: &Numerics,
    parameter: Parameter,
    range: [f64; 2],
    options: BoundaryOptions,
) -> Result<BoundaryStudy, ShapeError> {
    let axisymmetric = |options| boundary(cell, &Numerics { modes: 0, ..*numerics }, parameter, range, options);
    if numerics.modes == 0 {
        return axisymmetric(options);
    }
    let mut found = match axisymmetric(options) {
        Err(error) if options.critical => {
            let mut found = axisymmetric(BoundaryOptions { critical: false, ..options })?;
            found.warnings.push(format!("with axial symmetry: {error}"));
            found
        }
        found => found?,
    };
    let begin = thresholds(cell, numerics, parameter, range, &mut found.warnings);
    let wants_critical = options.critical && parameter == Parameter::R0;
    let critical = || wants_critical.then(|| bent_curves::critical_radius(cell, numerics, &StepBudget::unlimited()));
    let ends = || curves(cell, numerics, parameter, range, &mut found.warnings);
    let (ends, critical) = rayon::join(ends, critical);
    let ends = ends.unwrap_or_else(|error| {
        found.warnings.push(format!("no curves that end bent states: {error}"));
        Vec::new()
    });
    found.bent = Some(std::iter::once((THRESHOLD, begin)).chain(ends).collect());
    if let Some(critical) = critical {
        let critical = match critical {
            Err(error) if found.critical.is_some() => {
                found.warnings.push(format!("without axial symmetry: {error}"));
                return Ok(found);
            }
            critical => critical?,
        };
        found.warnings.extend(trials(cell, numerics, (critical.kind, critical.r0), &bent_curves::WITHOUT_AXIS, None));
        found.bent_critical = Some(CurvePoint {
            r0: critical.r0,
            epsilon: cell.epsilon,
            value: critical.r0,
            xi_s: cell.xi_s,
            slope: critical.slope,
            elongation: f64::NAN,
            coefficient: None,
        });
    }
    Ok(found)
}

/// Curves of the events that end stable bent states, over the horizontal parameter of a phase plane. The list is empty with axial
/// symmetry, for a parameter that bent states cannot be followed in, and if the curves cannot be followed.
pub fn bent_edges(plane: &PhasePlane, warnings: &mut Vec<String>) -> Vec<(&'static str, Curve)> {
    let PhasePlane { cell, numerics, parameter, across, .. } = plane;
    let range = match (across.first(), across.last()) {
        (Some(&from), Some(&to)) if from != to && numerics.modes > 0 && can_vary(*parameter) => [from, to],
        _ => return Vec::new(),
    };
    curves(cell, numerics, *parameter, range, warnings).unwrap_or_else(|error| {
        warnings.push(format!("the picture shows the edges of bent states at each value, without curves: {error}"));
        Vec::new()
    })
}

/// Whether curves of bent states can be followed over a parameter.
pub fn can_vary(parameter: Parameter) -> bool {
    matches!(parameter, Parameter::R0 | Parameter::Epsilon)
}

fn thresholds(
    cell: &Cell,
    numerics: &Numerics,
    parameter: Parameter,
    [from, to]: [f64; 2],
    warnings: &mut Vec<String>,
) -> Curve {
    let values: Vec<f64> = (0..=POINTS).map(|k| from + (to - from) * f64::from(k) / f64::from(POINTS)).collect();
    let at = |value| bent_curves::threshold(cell, numerics, parameter, value);
    let (curve, missing) = bent_curves::threshold_curve(scheduler::in_parallel(values.len(), |k| at(values[k])), at);
    match (curve.points.is_empty(), missing.first()) {
        // Without a single threshold the reasons agree, such as a law without equations for bent states.
        (true, Some(error)) => warnings.push(format!("no thresholds of bent states: {error}")),
        _ => warnings.extend(missing.iter().map(|error| format!("a threshold of bent states is missing: {error}"))),
    }
    curve
}

fn curves(
    cell: &Cell,
    numerics: &Numerics,
    parameter: Parameter,
    range: [f64; 2],
    warnings: &mut Vec<String>,
) -> Result<Vec<(&'static str, Curve)>, ShapeError> {
    let found = bent_curves::curves(cell, numerics, parameter, range)?;
    for (event, curve) in &found {
        if let Some(error) = curve.error() {
            warnings.push(format!("the {}s of bent states are followed no further: {error}", event.name()));
        }
    }
    Ok(found.into_iter().map(|(event, curve)| (event.name(), curve)).collect())
}
