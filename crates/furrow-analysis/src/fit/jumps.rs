//! Fitted divisions that jump next to the best cue: past the edge of a window of sizes χ falls to 0 or the cell rests, so that an
//! error by the slope at the best cue means nothing.
//!
//! χ is followed over each number of the cue, as far as its error and one percent at least, and over each cell's own radius, one
//! percent to either side.

use super::error::FitError;
use super::germline::{ChiResidual, CueNumber, Objective};
use super::search::moved;
use furrow_lineage::batch::scheduler;
use serde::Serialize;

/// How far a number or a radius is followed at least, relative to itself.
const REACH: f64 = 0.01;
/// Steps to either side.
const STEPS: usize = 4;
/// A change of χ as large as this within [`WITHIN`] of the value is a jump.
const JUMP: f64 = 0.1;
const WITHIN: f64 = 1e-3;
/// A jump ends where χ changes by less than `LEVEL`, at the latest after `LONGER` steps, each twice as long as the one before.
const LEVEL: f64 = 0.01;
const LONGER: usize = 4;

/// A division that jumps.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Jump {
    /// The cell that divides.
    pub cell: String,
    /// What changes: a number of the cue, or `r0`, the cell's radius.
    pub by: String,
    /// Its best value.
    pub best: f64,
    /// Its values on both sides of the jump, from the best value on.
    pub between: [f64; 2],
    /// χ there; `None` where the cell does not divide.
    pub chi: [Option<f64>; 2],
}

/// χ of some cells at a value.
type Chi<'a> = &'a (dyn Fn(f64) -> Vec<Option<f64>> + Sync);

/// The first jump of each cell to either side of the best cue.
pub(super) fn jumps(
    objective: &Objective<'_>,
    numbers: &[CueNumber],
    residuals: &[ChiResidual],
) -> Result<Vec<Jump>, FitError> {
    let mut found = Vec::new();
    let best: Vec<f64> = numbers.iter().map(|number| number.value).collect();
    for (k, number) in numbers.iter().enumerate() {
        let at = |value: f64| objective.chi(&moved(&best, k, value));
        let reach = number.sd.unwrap_or(0.0).max(REACH * number.value.abs());
        let [a, b] = number.searched;
        let ends = [-reach, reach].map(|to| (number.value + to).clamp(a.min(b), a.max(b)));
        let cells = residuals.iter().map(|residual| residual.cell.as_str()).collect::<Vec<_>>();
        found.extend(along(&number.name, number.value, ends, &cells, &at));
        objective.check_cancelled()?;
    }
    for residual in residuals {
        let Some(r0) = residual.r0 else { continue };
        let at = |r0: f64| vec![objective.model.chi_over_r0(&best, &residual.cell, r0)];
        found.extend(along("r0", r0, [-REACH, REACH].map(|to| r0 * (1.0 + to)), &[&residual.cell], &at));
        objective.check_cancelled()?;
    }
    Ok(found)
}

/// The first jump of each cell on the way from the best value to each of two ends.
fn along(by: &str, best: f64, ends: [f64; 2], cells: &[&str], chi: Chi<'_>) -> Vec<Jump> {
    let value = |end: f64, k: usize| best + (end - best) * k as f64 / STEPS as f64;
    let places: Vec<f64> = ends.into_iter().flat_map(|end| (0..=STEPS).map(move |k| value(end, k))).collect();
    let computed: Vec<Vec<Option<f64>>> = scheduler::in_parallel(places.len(), |k| chi(places[k]));
    let mut found = Vec::new();
    for (side, of_side) in places.chunks(STEPS + 1).zip(computed.chunks(STEPS + 1)) {
        for (index, cell) in cells.iter().enumerate() {
            let jump = (1..=STEPS).find_map(|k| {
                let between = [side[k - 1], side[k]];
                let ends = [&of_side[k - 1], &of_side[k]].map(|all| all[index]);
                narrowed(between, ends, WITHIN * best.abs(), &|value| chi(value)[index])
            });
            found.extend(jump.map(|(between, chi)| Jump {
                cell: (*cell).to_owned(),
                by: by.to_owned(),
                best,
                between,
                chi,
            }));
        }
    }
    found
}

/// How much χ changes: without bound between dividing and not.
fn change([a, b]: [Option<f64>; 2]) -> f64 {
    match (a, b) {
        (Some(a), Some(b)) => (a - b).abs(),
        (None, None) => 0.0,
        _ => f64::INFINITY,
    }
}

/// An interval narrowed to a width about the largest change of χ, with χ at its ends; `None` if χ does not jump there.
fn narrowed(
    mut between: [f64; 2],
    mut chi: [Option<f64>; 2],
    width: f64,
    at: &dyn Fn(f64) -> Option<f64>,
) -> Option<([f64; 2], [Option<f64>; 2])> {
    while change(chi) >= JUMP {
        if (between[1] - between[0]).abs() <= width {
            return Some(to_its_end(between, chi, at));
        }
        let middle = 0.5 * (between[0] + between[1]);
        let halfway = at(middle);
        let second = change([chi[0], halfway]) < change([halfway, chi[1]]);
        between[usize::from(!second)] = middle;
        chi[usize::from(!second)] = halfway;
    }
    None
}

/// The interval of a jump with its far end moved on, in ever longer steps, to where χ changes little.
fn to_its_end(
    mut between: [f64; 2],
    mut chi: [Option<f64>; 2],
    at: &dyn Fn(f64) -> Option<f64>,
) -> ([f64; 2], [Option<f64>; 2]) {
    for _ in 0..LONGER {
        let next = 2.0 * between[1] - between[0];
        let beyond = at(next);
        if change([chi[1], beyond]) < LEVEL {
            break;
        }
        (between[1], chi[1]) = (next, beyond);
    }
    (between, chi)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edge_differs_from_a_steep_slope() {
        let chi = |x: f64| {
            vec![
                (x < 2.006).then_some(4.0 * (2.1 - x)),
                Some(if x > 1.985 { 0.41 } else { 0.0005 }),
                Some(30.0 * (x - 1.97)),
            ]
        };
        let found = along("r0", 2.0, [1.98, 2.02], &["A", "B", "C"], &chi);
        let places = found.iter().map(|jump| (jump.cell.as_str(), jump.between, jump.chi)).collect::<Vec<_>>();
        let [("B", [b_near, b_far], b), ("A", [a_near, a_far], a)] = places[..] else { panic!("{places:?}") };
        assert!(b_far <= 1.985 && 1.985 < b_near && b_near - b_far <= 0.002, "{places:?}");
        assert!(a_near < 2.006 && 2.006 <= a_far && a_far - a_near <= 0.002, "{places:?}");
        assert_eq!(b, [Some(0.41), Some(0.0005)]);
        assert!(a[0].is_some() && a[1].is_none());
    }
}
