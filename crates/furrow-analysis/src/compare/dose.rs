//! Asymmetry of a division over the dose of a protein, beside the model's over the strength of its cue.
//!
//! The model knows no protein. It takes the amplitude of the cue to be proportional to the dose: dose 1, the wild type, has the
//! full cue, and without the protein there is no cue.

use furrow_cell::{Cell, Cue, Numerics};
use furrow_input::InputError;
use furrow_lineage::batch::scheduler::{SchedulerError, SchedulerOptions};
use furrow_lineage::batch::{Memo, scheduler, solve};
use furrow_measured::dose::{DoseGroup, DoseTrend, Doses, by_condition, by_dose, trend};
use furrow_measured::published::{DOSE_SOURCE, rodrigues2024};
use furrow_mechanics::division::{Division, DivisionInput, Outcome};
use serde::Serialize;
use serde_json::{Value, json};

/// The measured side.
#[derive(Clone, Debug)]
pub struct MeasuredDoses {
    /// The publication; `None` for a user's table.
    pub source: Option<&'static str>,
    /// Single divisions; empty for published data, which are shipped as groups only.
    pub doses: Doses,
    /// By condition.
    pub conditions: Vec<DoseGroup>,
    /// By dose.
    pub bins: Vec<DoseGroup>,
    /// Over all divisions.
    pub trend: DoseTrend,
}

impl MeasuredDoses {
    /// The published groups.
    ///
    /// # Errors
    /// Only if the shipped table is invalid.
    pub fn published() -> Result<MeasuredDoses, InputError> {
        let [conditions, bins] = rodrigues2024()?;
        let source = Some(DOSE_SOURCE);
        Ok(MeasuredDoses { source, doses: Doses::default(), conditions, bins, trend: trend(&[]) })
    }

    /// The divisions of a table, with the edges of bins, by default 0.2 apart.
    pub fn of(doses: Doses, edges: Option<&[f64]>) -> MeasuredDoses {
        let (conditions, bins) = (by_condition(&doses.divisions), by_dose(&doses.divisions, edges));
        let trend = trend(&doses.divisions);
        MeasuredDoses { source: None, doses, conditions, bins, trend }
    }

    /// Divisions of a table with doses outside the bins.
    pub fn outside_bins(&self) -> usize {
        self.doses.divisions.len().saturating_sub(self.bins.iter().map(|bin| bin.n).sum())
    }
}

/// The model's side.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelDoses {
    /// A curve from no dose to the largest measured one.
    pub curve: Vec<DoseModel>,
    /// At the mean dose of each bin.
    pub by_bin: Vec<DoseModel>,
}

/// The model's division of a cell with a cue as strong as the dose.
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
fn doses_to(most: f64) -> Vec<f64> {
    let mut doses: Vec<f64> = (0..POINTS).map(|k| most * (k as f64 / (POINTS - 1) as f64).powi(2)).collect();
    doses.push(1.0);
    doses.sort_by(f64::total_cmp);
    doses.dedup();
    doses
}

/// The model's divisions of a cell, with all of its cue at dose 1, over the measured doses.
///
/// # Errors
/// [`SchedulerError`] if no workers can be started. A division that cannot be computed has no outcome.
pub fn over_dose(
    cell: &Cell,
    cue: &Cue,
    measured: &MeasuredDoses,
    numerics: Numerics,
    memo: &Memo,
    options: &SchedulerOptions<'_>,
) -> Result<ModelDoses, SchedulerError> {
    let means = || measured.bins.iter().map(|bin| bin.dose.mean);
    let single = measured.doses.divisions.iter().map(|division| division.dose);
    let mut doses = doses_to(single.chain(means()).fold(1.0, f64::max));
    let count = doses.len();
    doses.extend(means());
    let input = |dose: &f64| {
        let cue = if *dose == 0.0 { Cue::none() } else { cue.scaled(*dose) };
        DivisionInput { cell: cell.clone().with_cue(cue), numerics, seed: 0 }
    };
    let found = scheduler::solve_all(doses.iter().map(input), memo, options, solve)?.divisions;
    let of = |(dose, found): (&f64, &Option<Division>)| DoseModel {
        dose: *dose,
        outcome: found.as_ref().map(Division::outcome),
        chi: found.as_ref().and_then(Division::chi),
    };
    let mut curve: Vec<DoseModel> = doses.iter().zip(&found).map(of).collect();
    let by_bin = curve.split_off(count);
    Ok(ModelDoses { curve, by_bin })
}

/// Both sides as JSON; `cue` is the cue of the model's cell as it was given.
pub fn document(measured: &MeasuredDoses, model: &ModelDoses, (r0, cue): (f64, &str)) -> Value {
    let MeasuredDoses { source, doses, conditions, bins, trend } = measured;
    let beside = bins.iter().zip(&model.by_bin).map(|(bin, model)| {
        let mut row = json!(bin);
        row["model"] = json!(model);
        row
    });
    json!({
        "source": source,
        "used": doses.divisions.len(),
        "skipped": doses.skipped,
        "skipped_count": doses.skipped_count,
        "conditions": conditions,
        "bins": beside.collect::<Vec<_>>(),
        "outside_bins": measured.outside_bins(),
        "trend": trend,
        "model": { "r0": r0, "cue": cue, "points": model.curve },
    })
}
