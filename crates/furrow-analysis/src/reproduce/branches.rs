//! Stationary shapes over ξ_s: figures 2C to 2F, 2H to 2L, S3 and S4.

use super::context::{Artifact, Figure, Finding, PUBLISHED_ACTIVITY, ReproduceError};
use super::paper::Statement;
use super::sweeps::outcomes;
use crate::constraints::extreme_maxima;
use crate::diagram::{Diagram, diagram};
use furrow_cell::{Cell, Parameter, Scheme};
use furrow_lineage::batch::phase::{PhasePlane, spaced};
use furrow_lineage::batch::scheduler;
use furrow_mechanics::calibration::statements::HigherFold;
use furrow_mechanics::equilibria::critical::critical_value;
use furrow_mechanics::equilibria::{BranchOptions, StepBudget, curves};
use rayon::prelude::*;

/// Longest step along a branch, for smooth pictures.
const STEP: f64 = 1.0;
/// Largest ξ_s of the branches.
const XI_MAX: f64 = 30.0;
/// A statement on a curve of pitchforks, not on the branches of its cell.
const ON_CURVE: &str = "confinement_pitchfork";

/// The finding of a statement about the first pitchfork, how it opens, or the folds; `None` for another statement.
fn finding(found: &Diagram, statement: &Statement) -> Option<Finding> {
    let id = statement.id.as_str();
    let (_, symmetric) = found.branches.first()?;
    let pitchfork = symmetric.pitchforks().next();
    let missing = || Finding::not_computed(id, "there is no pitchfork");
    if let Some(kind) = statement.kind {
        return Some(pitchfork.map_or_else(missing, |found| {
            let words = format!("{}, coefficient {:+.2}", found.criticality(), found.coefficient);
            Finding::judged(id, (found.criticality() == kind, words))
        }));
    }
    if let Some(higher) = statement.higher {
        let judged = match extreme_maxima(symmetric) {
            Some([short, long]) => {
                let holds = (higher == HigherFold::LargeH) == (long > short);
                (holds, format!("ξ_s = {short:.2} at small H, {long:.2} at large H"))
            }
            None => (false, "fewer than two folds".to_owned()),
        };
        return Some(Finding::judged(id, judged));
    }
    let threshold = pitchfork.map(|found| found.point.xi_s);
    match id.split('_').next()? {
        "threshold" => Some(threshold.map_or_else(missing, |threshold| Finding::new(id, threshold))),
        "opening" => {
            let missing = || Finding::not_computed(id, "no asymmetric branch");
            Some(found.scaling.map_or_else(missing, |scaling| Finding::new(id, scaling.exponent)))
        }
        "window" => {
            let fold = symmetric.folds().find(|fold| fold.maximum).map(|fold| fold.point.xi_s);
            Some(match (threshold, fold) {
                (Some(low), Some(high)) => {
                    let holds = low < PUBLISHED_ACTIVITY && PUBLISHED_ACTIVITY < high;
                    Finding::judged(id, (holds, format!("{low:.2} < 25 < {high:.2}")))
                }
                _ => Finding::not_computed(id, "there is no pitchfork, or no fold"),
            })
        }
        _ => None,
    }
}

/// Figures 2C to 2F and S4: the branches of all cells that statements are about, each followed once.
pub fn shapes(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    let on_branches = |statement: &&Statement| statement.cell.is_some() && statement.id != ON_CURVE;
    let statements: Vec<(&Statement, Cell)> =
        figure.statements.iter().filter(on_branches).map(|statement| (statement, figure.cell_of(statement))).collect();
    let mut cells: Vec<Cell> = Vec::new();
    for (_, cell) in &statements {
        if !cells.contains(cell) {
            cells.push(cell.clone());
        }
    }
    let options = BranchOptions { xi: [0.0, XI_MAX], growth_rates: true, contours: true, ..BranchOptions::default() };
    let (options, numerics) = (options.with_max_step(STEP), figure.context.converged());
    let pool = scheduler::pool(figure.context.threads)?;
    let found: Vec<_> = pool.install(|| cells.par_iter().map(|cell| diagram(cell, &numerics, &options)).collect());
    for (statement, of) in statements {
        match cells.iter().zip(&found).find(|(cell, _)| **cell == of) {
            Some((_, Ok(found))) => figure.findings.extend(finding(found, statement)),
            Some((_, Err(error))) => figure.findings.push(Finding::not_computed(&statement.id, error)),
            None => {}
        }
    }
    for (cell, found) in cells.into_iter().zip(found) {
        if let Ok(Diagram { branches, .. }) = found {
            let name = format!("{}-R0_{}-epsilon_{}", figure.name(), cell.r0, cell.epsilon);
            figure.show(&name, Artifact::Branches(cell, branches));
        }
    }
    Ok(())
}

/// Figures 2H to 2L: the branches of cells in two shells, and the plane that they are in.
pub fn over_confinement(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    shapes(figure)?;
    let (cell, numerics) = (figure.context.cell(2.22, 0.895), figure.context.numerics(Scheme::Converged));
    let pitchfork =
        critical_value(&cell, &numerics, Parameter::Epsilon, &[0.895, 0.85, 0.76], &StepBudget::unlimited());
    figure.number(ON_CURVE, pitchfork.map(|(_, point)| point.value));
    let (across, up) = (spaced(0.54, 0.92, 20), spaced(3.0, 27.0, 9));
    let plane = PhasePlane { cell, numerics, parameter: Parameter::Epsilon, across, up, seed: 0 };
    let diagram = figure.plane("2H-L", plane)?;
    figure.report("confinement_plane", outcomes(&diagram));
    Ok(())
}

/// Range of R0 of the curves.
const RADII: [f64; 2] = [1.6, 2.4];

/// Figure S3: the boundaries of division over R0.
pub fn over_radius(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    let (cell, numerics) = (figure.context.cell(2.0, 0.87), figure.context.converged());
    let both = curves::pitchfork_curve(&cell, &numerics, Parameter::R0, RADII)
        .and_then(|pitchforks| Ok((pitchforks, curves::fold_curves(&cell, &numerics, Parameter::R0, RADII)?)));
    let (pitchforks, folds) = match both {
        Ok(both) => both,
        Err(error) => {
            figure.report("curves", format!("not computed: {error}"));
            return Ok(());
        }
    };
    let ends = pitchforks.points.first().zip(pitchforks.points.last());
    let range = ends.map_or(String::new(), |(a, b)| format!("ξ_s* = {:.2} to {:.2}", a.xi_s, b.xi_s));
    let changes: Vec<String> = pitchforks.degenerate.iter().map(|p| format!("{:.3}", p.r0)).collect();
    let changes = match changes.is_empty() {
        true => "one kind throughout".to_owned(),
        false => format!("the kind changes at R0 = {}", changes.join(", ")),
    };
    figure.report("curves", format!("{range}; {changes}"));
    figure.show("S3", Artifact::Boundary(cell, RADII, pitchforks, folds));
    Ok(())
}
