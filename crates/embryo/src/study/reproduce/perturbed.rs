//! Figure S5: stationary shapes that are disturbed.

use rayon::prelude::*;

use super::lab::{Finding, Found, Lab, LabError, Shown};
use super::paper::Statement;
use crate::batch::scheduler;
use crate::cell::Cell;
use crate::division::DivisionInput;
use crate::perturbation::{Perturbation, PerturbationError, WATCHED, perturbed_from};
use crate::shapes::{BranchOptions, ShapeError, StationaryError, pitchfork, stationary};

/// Cells whose shapes are disturbed, R0 and ε: those whose branches the paper shows.
const CELLS: [[f64; 2]; 4] = [[1.64, 0.87], [2.0, 0.87], [2.22, 0.64], [2.22, 0.88]];
/// Activities, relative to that of the first pitchfork.
const ACTIVITIES: [f64; 6] = [0.8, 0.95, 0.99, 1.01, 1.05, 1.1];
/// Seeds of the noise.
const SEEDS: u64 = 3;

/// A disturbed shape.
struct Case {
    name: String,
    found: Result<Perturbation, PerturbationError>,
}

/// What becomes of shapes below and above their threshold.
pub fn shapes(lab: &Lab<'_>, _: &[Statement]) -> Result<Found, LabError> {
    let mut found = Found::default();
    let pool = scheduler::pool(lab.threads)?;
    let thresholds: Vec<Result<(Cell, f64), ShapeError>> = pool.install(|| {
        let threshold = |[r0, epsilon]: &[f64; 2]| {
            let cell = lab.cell(*r0, *epsilon);
            let found = pitchfork::first(&cell, &lab.numerics(), &BranchOptions::default())?;
            Ok((cell, found.point.xi_s))
        };
        CELLS.par_iter().map(threshold).collect()
    });
    let cells: Result<Vec<(Cell, f64)>, ShapeError> = thresholds.into_iter().collect();
    let cells = match cells {
        Ok(cells) => cells,
        Err(error) => {
            found.findings =
                ["perturbed_stable", "perturbed_unstable"].map(|id| Finding::not_computed(id, &error)).to_vec();
            return Ok(found);
        }
    };
    let at =
        |(cell, threshold): &(Cell, f64)| ACTIVITIES.map(|factor| Cell { xi_s: factor * threshold, ..cell.clone() });
    let inputs: Vec<Cell> = cells.iter().flat_map(at).collect();
    let mut all: Vec<Vec<Case>> = pool.install(|| inputs.par_iter().map(|cell| cases(lab, cell)).collect());
    lab.go_on()?;
    judge(&all, &mut found);
    for (cell, _) in cells.into_iter().rev() {
        let own = all.split_off(all.len().saturating_sub(ACTIVITIES.len()));
        // Of each shape the first noise.
        let firsts = own.into_iter().filter_map(|cases| cases.into_iter().next());
        let shown = firsts.filter_map(|case| Some((case.name, case.found.ok()?))).collect();
        let name = format!("S5-R0_{}-epsilon_{}", cell.r0, cell.epsilon);
        found.show(&name, Shown::Perturbations(cell, shown));
    }
    found.panels.reverse();
    Ok(found)
}

/// A shape with every noise; none where the branch turns back before it.
fn cases(lab: &Lab<'_>, cell: &Cell) -> Vec<Case> {
    let numerics = lab.numerics();
    let start = match stationary(cell, &numerics) {
        Err(StationaryError::OutOfReach { .. }) => return Vec::new(),
        start => start,
    };
    let one = |seed: u64| {
        let input = DivisionInput { cell: cell.clone(), numerics, seed };
        let start = start.as_ref().map_err(|error| PerturbationError::from(error.clone()));
        let found = start.and_then(|start| perturbed_from(&input, start, WATCHED));
        Case { name: format!("ξₛ = {:.2}", cell.xi_s), found }
    };
    (0..SEEDS).map(one).collect()
}

fn judge(all: &[Vec<Case>], found: &mut Found) {
    let cases: Vec<&Case> = all.iter().flatten().collect();
    for (id, stable) in [("perturbed_stable", true), ("perturbed_unstable", false)] {
        let watched = || cases.iter().filter_map(|case| case.found.as_ref().ok());
        let those: Vec<&Perturbation> = watched().filter(|p| (p.start_growth_rate < 0.0) == stable).collect();
        let right = those.iter().filter(|p| p.returned() == stable).count();
        let verb = if stable { "return" } else { "leave" };
        let failed = cases.len() - watched().count();
        let text = format!("{right} of {} {verb}", those.len());
        let text = if failed > 0 { format!("{text}; {failed} not computed") } else { text };
        found.say(Finding::words(id, right == those.len() && right > 0 && failed == 0, text));
    }
}
