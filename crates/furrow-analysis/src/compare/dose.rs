//! Asymmetry of a division over the dose of a protein, beside the model's over the strength of its cue.
//!
//! The model knows no protein. It takes the amplitude of the cue to be proportional to the dose: dose 1, the wild type, has the
//! whole cue, and without the protein there is none.

use furrow_cell::{Cell, Cue, Numerics};
use furrow_lineage::batch::scheduler::{SchedulerError, SchedulerOptions};
use furrow_lineage::batch::{Memo, scheduler};
use furrow_mechanics::division::{DivisionInput, Outcome, divide};
use serde::Serialize;

/// The model's division of a cell whose cue is as strong as the dose.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DoseModel {
    /// The dose.
    pub dose: f64,
    /// How the division ends; `None` where it could not be computed.
    pub outcome: Option<Outcome>,
    /// χ, if the cell divides.
    pub chi: Option<f64>,
}

/// Points of the model's curve.
const POINTS: usize = 25;

/// Doses from 0 to `most`, with 1 among them, for a curve: closer near 0, where χ is steep.
pub fn doses_to(most: f64) -> Vec<f64> {
    let mut doses: Vec<f64> = (0..POINTS).map(|k| most * (k as f64 / (POINTS - 1) as f64).powi(2)).collect();
    doses.push(1.0);
    doses.sort_by(f64::total_cmp);
    doses.dedup();
    doses
}

/// The model's divisions of a cell, with all of its cue at dose 1, at some doses.
///
/// # Errors
/// [`SchedulerError`] if no workers can be started. A division that cannot be computed has no outcome.
pub fn over_dose(
    cell: &Cell,
    cue: &Cue,
    doses: &[f64],
    (numerics, seed): (Numerics, u64),
    memo: &Memo,
    options: &SchedulerOptions<'_>,
) -> Result<Vec<DoseModel>, SchedulerError> {
    let input = |dose: &f64| {
        let cue = if *dose == 0.0 { Cue::none() } else { cue.scaled(*dose) };
        DivisionInput { cell: cell.clone().with_cue(cue), numerics, seed }
    };
    let found = scheduler::solve_all(doses.iter().map(input), memo, options, divide)?.divisions;
    let of = |(dose, found): (&f64, &Option<furrow_mechanics::division::Division>)| DoseModel {
        dose: *dose,
        outcome: found.as_ref().map(furrow_mechanics::division::Division::outcome),
        chi: found.as_ref().and_then(furrow_mechanics::division::Division::chi),
    };
    Ok(doses.iter().zip(&found).map(of).collect())
}
