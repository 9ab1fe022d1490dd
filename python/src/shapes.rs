//! Where division begins: boundaries, phase diagrams, critical radii, disturbed shapes, PAR polarity.

use furrow_analysis::bent::{bent_edges, boundary_with_bent, can_vary};
use furrow_analysis::boundary::over_range;
use furrow_analysis::polarity::{Follows, NamedCell, PolarityStudyError, germline, polarity as studied};
use furrow_analysis::{BoundaryOptions, edges};
use furrow_cell::{Cell, Parameter};
use furrow_figures::drawing::style::described;
use furrow_figures::plot;
use furrow_lineage::batch::PhasePlane;
use furrow_lineage::batch::method;
use furrow_lineage::batch::perturbations::perturbations;
use furrow_lineage::batch::phase::spaced;
use furrow_mechanics::equilibria::StepBudget;
use furrow_mechanics::perturbation::Perturbation;
use furrow_mechanics::polarity::{Chemistry, LENGTH_UM, ParConstants};
use pyo3::prelude::*;
use serde_json::{Value, json};

use crate::document::Document;
use crate::drawings::Drawing;
use crate::errors::{ARGUMENTS, Error};
use crate::inputs::{Given, Inputs, Named, lineage_of};
use crate::memo::{Memo, run_warnings};
use crate::solve::parameter;
use crate::supervise::{Interrupt, supervised};
use crate::trees::one_of;

/// A result, its picture, and its warnings.
type Drawn = (Document, Drawing, Vec<String>);

/// A parameter that varies, and the cell at its first value.
fn varied(inputs: &Inputs, name: &str, range: [f64; 2]) -> Result<(Parameter, Cell), Error> {
    let parameter = parameter("vary", name, inputs)?;
    if parameter == Parameter::XiS {
        let allowed = "another parameter: curves and diagrams run over ξ_s as it is";
        return Err(Error::not_allowed("vary", name, allowed));
    }
    let cell = over_range(&mut inputs.settings(), inputs.cell.clone(), parameter, range, [ARGUMENTS; 2])?;
    Ok((parameter, cell))
}

/// The boundary of division of a cell over one parameter.
#[pyfunction]
#[pyo3(signature = (inputs, vary, range, folds, critical, azimuthal=None))]
pub fn boundary(
    py: Python<'_>,
    inputs: &Inputs,
    vary: &str,
    range: [f64; 2],
    folds: bool,
    critical: bool,
    azimuthal: Option<usize>,
) -> Result<Drawn, Error> {
    let (parameter, cell) = varied(inputs, vary, range)?;
    if range[0] == range[1] {
        return Err(Error::not_allowed("last", range[1], "different from the first value"));
    }
    let numerics = inputs.numerics;
    if numerics.modes > 0 && !can_vary(parameter) {
        return Err(Error::not_allowed("vary", vary, "r0 or epsilon without axial symmetry"));
    }
    supervised(py, Interrupt::Abandons, None, move |_| {
        let options = BoundaryOptions { folds, critical, azimuthal };
        let found = boundary_with_bent(&cell, &numerics, parameter, range, options).map_err(Error::no_outcome)?;
        let drawing = Drawing::of(plot::boundary::draw(&found));
        Ok((found.document().into(), drawing, found.warnings))
    })
}

/// Outcomes over one parameter and ξ_s; `axes` are the first and last value and the number of values of each.
#[pyfunction]
#[pyo3(signature = (inputs, memo, seed, vary, axes, azimuthal, threads, progress=None))]
pub fn phase(
    py: Python<'_>,
    inputs: &Inputs,
    memo: &Memo,
    seed: u64,
    vary: &str,
    axes: [(f64, f64, usize); 2],
    azimuthal: usize,
    threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> Result<Drawn, Error> {
    let [(from, to, points), (xi_from, xi_to, xi_points)] = axes;
    if let Some(xi) = [xi_from, xi_to].into_iter().find(|xi| !(xi.is_finite() && *xi >= 0.0)) {
        return Err(Error::not_allowed("xi_s", xi, "a finite number, 0 or above"));
    }
    let (parameter, cell) = varied(inputs, vary, [from, to])?;
    inputs.settings().check_divisions(ARGUMENTS)?;
    let (across, up) = (spaced(from, to, points), spaced(xi_from, xi_to, xi_points));
    let plane = PhasePlane { cell, numerics: inputs.numerics, parameter, across, up, seed };
    let memo = memo.solved()?;
    supervised(py, Interrupt::Finishes, progress, move |watch| {
        let diagram = watch.scheduled(threads, |options| plane.compute(&memo, options))?;
        if diagram.summary.interrupted {
            return Err(Error::Interrupted(0));
        }
        let (mut edges, mut warnings) = edges(&plane, azimuthal);
        edges.bent = bent_edges(&plane, &mut warnings);
        warnings.extend(run_warnings(&diagram.summary, &memo));
        warnings.extend(diagram.undecided.iter().map(|(why, count)| format!("{count} undecided: {why}")));
        let failed = |column: &furrow_lineage::batch::phase::Column| {
            let error = column.error.as_ref()?;
            Some(format!("no edges at {} = {}, left to divisions: {error}", plane.parameter, column.x))
        };
        warnings.extend(diagram.columns.iter().filter_map(failed));
        let document = json!({
            "vary": parameter.to_string(), "cue": plane.cell.cue, "cells": diagram.cells, "columns": diagram.columns,
        });
        Ok((document.into(), Drawing::of(plot::phase::draw(&plane, &diagram, &edges)), warnings))
    })
}

/// The radius below which cells like this one do not divide.
#[pyfunction]
pub fn critical_radius(py: Python<'_>, inputs: &Inputs) -> Result<Document, Error> {
    let Inputs { cell, numerics } = inputs.clone();
    supervised(py, Interrupt::Abandons, None, move |_| {
        let found =
            (method(&numerics).radius)(&cell, &numerics, &StepBudget::unlimited()).map_err(Error::no_outcome)?;
        Ok(json!({ "r0": found.r0, "kind": found.kind, "slope": found.slope }).into())
    })
}

/// The stationary shape disturbed by the noise of several seeds; with failures by seed.
#[pyfunction]
pub fn perturb(
    py: Python<'_>,
    inputs: &Inputs,
    seed: u64,
    count: usize,
    until: f64,
    threads: usize,
) -> Result<Drawn, Error> {
    let input = inputs.division(seed)?;
    supervised(py, Interrupt::Abandons, None, move |_| {
        let (mut solved, mut failed): (Vec<(String, Perturbation)>, Vec<String>) = Default::default();
        let mut rows: Vec<Value> = Vec::new();
        for one in perturbations(&input, count, until, threads)? {
            match one.found {
                Ok(found) => {
                    rows.push(json!({
                        "seed": one.seed, "division": found.division, "returned": found.returned(),
                        "distances": found.distances, "start_growth_rate": found.start_growth_rate,
                    }));
                    solved.push((format!("seed {}", one.seed), found));
                }
                Err(error) => failed.push(format!("seed {}: {error}", one.seed)),
            }
        }
        if let (true, Some(why)) = (rows.is_empty(), failed.pop()) {
            return Err(Error::NoOutcome(why));
        }
        let title = format!("Disturbed stationary shape at {}", described(&input.cell, &[]));
        Ok((Value::from(rows).into(), Drawing::of(plot::perturbation::draw(&title, &solved)), failed))
    })
}

/// The name of a cell, and u, A and P along its contour.
type Profile = (String, Vec<[f64; 3]>);

/// PAR polarity of one cell, or of the germline of a lineage: the result, and for each polarised cell u, A and P along its contour.
#[pyfunction]
#[pyo3(signature = (given, lineage, one, par, length_um, profile, amplitude))]
pub fn polarity(
    py: Python<'_>,
    mut given: Given,
    lineage: Option<String>,
    one: bool,
    par: Named,
    length_um: Option<f64>,
    profile: &str,
    amplitude: f64,
) -> Result<(Document, Vec<Profile>), Error> {
    let follows = one_of("profile", profile, Follows::NAMED)?;
    if !(amplitude.is_finite() && amplitude > -1.0) {
        let allowed = "a finite number above -1: kappa stays positive";
        return Err(Error::not_allowed("amplitude", amplitude, allowed));
    }
    let mut constants = ParConstants::GOEHRING2011;
    par.0.iter().try_for_each(|(name, value)| constants.assign(ARGUMENTS, name, value))?;
    let lineage = lineage_of(lineage.as_deref())?;
    let length_um = length_um.or(lineage.units().length_um).unwrap_or(LENGTH_UM);
    given.parameters.scale_radius(&lineage)?;
    let settings = given.for_divisions()?;
    settings.check_axisymmetric(ARGUMENTS)?;
    supervised(py, Interrupt::Abandons, None, move |_| {
        let failed = |error: PolarityStudyError| Error::no_outcome(error);
        let cells = match one {
            true => vec![NamedCell { name: None, cell: settings.cell.clone() }],
            false => germline(&lineage, &settings).map_err(failed)?,
        };
        let chemistry = Chemistry { numerics: settings.numerics, ..Chemistry::new(constants, length_um) };
        let found = studied(&cells, &settings, &chemistry, (follows, amplitude)).map_err(failed)?;
        let profiles = found
            .cells
            .iter()
            .map(|cell| (cell.name.clone().unwrap_or_else(|| "cell".to_owned()), cell.profile.clone()));
        Ok((found.document(&chemistry, amplitude).into(), profiles.collect()))
    })
}
