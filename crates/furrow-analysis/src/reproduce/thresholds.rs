//! Figures 2B and 2H: thresholds over size and over confinement, and χ past them; with figure 3D the size at which cells with a
//! cue fail.

use super::context::{Figure, Finding, ReproduceError};
use super::readings::chi_in_words;
use super::sweeps::Compares;
use furrow_cell::{Cell, Cue, Parameter};
use furrow_lineage::batch::phase::{PhasePlane, spaced};
use furrow_lineage::batch::{method, scheduler};
use furrow_mechanics::division::DivisionInput;
use furrow_mechanics::equilibria::{BranchOptions, ShapeError, StepBudget, curves, pitchfork};
use ordered_float::OrderedFloat;

/// Activity over ξ_s* at which cells are compared past their thresholds: below the turning points of all of them.
const PAST: f64 = 1.05;
/// Largest relative change of the critical radius that counts as slight.
const SLIGHT: f64 = 0.05;

/// Figure 2B: the curve of pitchforks over R0, outcomes about it, and χ past it.
pub fn over_radius(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    let cell = figure.context.cell(2.0, 0.87);
    thresholds(figure, "plane_thresholds", &cell, Parameter::R0, [1.5, 2.4], |a, b| b < a);
    past_threshold(figure, "plane_unequal", &cell, (Parameter::R0, "R0", [1.6, 1.8, 2.0, 2.2]), |a, b| b < a)?;
    let (across, up) = (spaced(1.6, 5.4, 20), spaced(10.0, 30.0, 9));
    let numerics = figure.context.converged();
    figure.plane(PhasePlane { cell, numerics, parameter: Parameter::R0, across, up, seed: 0 })
}

/// Figure 2H: the curve of pitchforks over ε, outcomes about it, and χ past it.
pub fn over_confinement(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    let cell = figure.context.cell(2.22, 0.87);
    thresholds(figure, "confinement_thresholds", &cell, Parameter::Epsilon, [0.6, 0.92], |a, b| b > a);
    let along = (Parameter::Epsilon, "ε", [0.75, 0.8, 0.85, 0.9]);
    past_threshold(figure, "confinement_past", &cell, along, |a, b| b > a)?;
    let (across, up) = (spaced(0.54, 0.92, 20), spaced(3.0, 27.0, 9));
    let numerics = figure.context.converged();
    figure.plane(PhasePlane { cell, numerics, parameter: Parameter::Epsilon, across, up, seed: 0 })
}

/// How χ changes along a parameter, named by its symbol, among cells that are equally far past their own thresholds.
fn past_threshold(
    figure: &mut Figure<'_>,
    id: &str,
    cell: &Cell,
    (parameter, symbol, values): (Parameter, &str, [f64; 4]),
    in_order: Compares,
) -> Result<(), ReproduceError> {
    let context = figure.context;
    let numerics = context.converged();
    let past = |value: &f64| -> Result<DivisionInput, ShapeError> {
        let mut cell = cell.clone();
        parameter.set(&mut cell, *value);
        let first = pitchfork::first(&cell, &numerics, &BranchOptions::default())?;
        Ok(context.input(Cell { xi_s: PAST * first.point.xi_s, ..cell }))
    };
    let inputs: Result<Vec<DivisionInput>, ShapeError> = scheduler::pool(context.threads)?
        .install(|| scheduler::in_parallel(values.len(), |k| past(&values[k])))
        .into_iter()
        .collect();
    context.check_cancelled()?;
    let finding = match inputs {
        Ok(inputs) => {
            let divisions = figure.divisions(inputs)?;
            let chi: Vec<Option<f64>> = divisions.iter().map(|division| division.as_ref()?.chi()).collect();
            let holds = chi.windows(2).all(|pair| pair[0].zip(pair[1]).is_some_and(|(a, b)| in_order(a, b)));
            let each = chi.iter().zip(values).map(|(chi, value)| format!("{} at {value}", chi_in_words(*chi)));
            let text = format!("χ over {symbol}: {}", each.collect::<Vec<_>>().join(", "));
            Finding::judged(id, (holds, text))
        }
        Err(error) => Finding::not_computed(id, error),
    };
    figure.findings.push(finding);
    Ok(())
}

/// How far the cue moves the size below which cells fail.
pub fn cued_boundary(figure: &mut Figure<'_>) {
    let (cell, numerics) = (figure.context.cell(1.0, 0.87), figure.context.converged());
    let radius = |cue: Cue| {
        let cell = cell.clone().with_cue(cue);
        (method(&numerics).radius)(&cell, &numerics, &StepBudget::unlimited()).map(|critical| critical.r0)
    };
    let both = radius(Cue::none()).and_then(|plain| Ok([plain, radius(Cue::published())?]));
    let judged = both.map(|[plain, cued]| {
        let shift = cued / plain - 1.0;
        let text = format!("R0 = {plain:.3} without, {cued:.3} with the cue, {:+.1} %", 100.0 * shift);
        (shift != 0.0 && shift.abs() < SLIGHT, text)
    });
    figure.judge_found("cued_boundary", judged);
}

/// Whether ξ_s* goes one way along the curve of pitchforks.
fn thresholds(
    figure: &mut Figure<'_>,
    id: &str,
    cell: &Cell,
    parameter: Parameter,
    range: [f64; 2],
    in_order: Compares,
) {
    let judged = curves::pitchfork_curve(cell, &figure.context.converged(), parameter, range).map(|curve| {
        let mut points = curve.points;
        points.sort_by_cached_key(|item| OrderedFloat(item.value));
        let xi: Vec<f64> = points.iter().map(|point| point.xi_s).collect();
        let ends = [xi.first(), xi.last()].map(|xi| xi.copied().unwrap_or(f64::NAN));
        let holds = xi.len() > 1 && xi.windows(2).all(|pair| in_order(pair[0], pair[1]));
        (holds, format!("ξ_s* = {:.2} to {:.2}", ends[0], ends[1]))
    });
    figure.judge_found(id, judged);
}
