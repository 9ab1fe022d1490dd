//! Figure S5: stationary shapes that are disturbed.

use super::context::{Artifact, Context, Figure, Finding, ReproduceError};
use furrow_cell::Cell;
use furrow_lineage::batch::scheduler;
use furrow_mechanics::division::{DivisionInput, DivisionOptions};
use furrow_mechanics::equilibria::{BranchOptions, ShapeError, StationaryError, pitchfork, stationary};
use furrow_mechanics::perturbation::{Perturbation, PerturbationError, WATCHED, perturb};

/// Cells with disturbed shapes, R0 and ε: the paper shows their branches.
const CELLS: [[f64; 2]; 4] = [[1.64, 0.87], [2.0, 0.87], [2.22, 0.64], [2.22, 0.88]];
/// Activities, relative to the first pitchfork's.
const ACTIVITIES: [f64; 6] = [0.8, 0.95, 0.99, 1.01, 1.05, 1.1];
/// Seeds of the noise.
const SEEDS: u64 = 3;

/// A disturbed shape at some activity.
type Case = (f64, Result<Perturbation, PerturbationError>);

/// Figure S5: shapes below and above their threshold, disturbed.
pub fn shapes(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    let context = figure.context;
    let pool = scheduler::pool(context.threads)?;
    let threshold = |[r0, epsilon]: &[f64; 2]| {
        let cell = context.cell(*r0, *epsilon);
        let found = pitchfork::first(&cell, &context.converged(), &BranchOptions::default())?;
        Ok((cell, found.point.xi_s))
    };
    // Computes all thresholds, so that the reported error is always the first cell's, independent of threads.
    let thresholds: Vec<Result<(Cell, f64), ShapeError>> =
        pool.install(|| scheduler::in_parallel(CELLS.len(), |k| threshold(&CELLS[k])));
    let cells: Vec<(Cell, f64)> = match thresholds.into_iter().collect::<Result<_, _>>() {
        Ok(cells) => cells,
        Err(error) => {
            let ids = ["perturbed_stable", "perturbed_unstable"];
            figure.findings = ids.map(|id| Finding::not_computed(id, &error)).to_vec();
            return Ok(());
        }
    };
    let at =
        |(cell, threshold): &(Cell, f64)| ACTIVITIES.map(|factor| Cell { xi_s: factor * threshold, ..cell.clone() });
    let inputs: Vec<Cell> = cells.iter().flat_map(at).collect();
    let all: Vec<Vec<Case>> = pool.install(|| scheduler::in_parallel(inputs.len(), |k| cases(context, &inputs[k])));
    context.check_cancelled()?;
    judge(&all, figure);
    let mut all = all.into_iter();
    for (cell, _) in cells {
        // Of each shape the first noise.
        let firsts = all.by_ref().take(ACTIVITIES.len()).filter_map(|cases| cases.into_iter().next());
        let shown = firsts.filter_map(|(xi_s, found)| Some((format!("ξₛ = {xi_s:.2}"), found.ok()?))).collect();
        let name = format!("S5-R0_{}-epsilon_{}", cell.r0, cell.epsilon);
        figure.show(&name, Artifact::Perturbations(cell, shown));
    }
    Ok(())
}

/// A shape with every noise; `None` where the branch turns back before it.
fn cases(context: &Context<'_>, cell: &Cell) -> Vec<Case> {
    let numerics = context.converged();
    let start = match stationary(cell, &numerics) {
        Err(StationaryError::OutOfReach { .. }) => return Vec::new(),
        start => start,
    };
    let one = |seed: u64| {
        let input = DivisionInput { cell: cell.clone(), numerics, seed };
        let start = start.as_ref().map_err(|error| PerturbationError::from(error.clone()));
        (cell.xi_s, start.and_then(|start| perturb(&input, start, WATCHED, DivisionOptions::default())))
    };
    (0..SEEDS).map(one).collect()
}

fn judge(all: &[Vec<Case>], figure: &mut Figure<'_>) {
    let cases: Vec<&Case> = all.iter().flatten().collect();
    for (id, stable) in [("perturbed_stable", true), ("perturbed_unstable", false)] {
        let watched = || cases.iter().filter_map(|(_, found)| found.as_ref().ok());
        let those: Vec<&Perturbation> = watched().filter(|p| (p.start_growth_rate < 0.0) == stable).collect();
        let right = those.iter().filter(|p| p.returned() == stable).count();
        let verb = if stable { "return" } else { "leave" };
        let failed = cases.len() - watched().count();
        let text = format!("{right} of {} {verb}", those.len());
        let text = if failed > 0 { format!("{text}; {failed} not computed") } else { text };
        figure.judge(id, right == those.len() && right > 0 && failed == 0, text);
    }
}
