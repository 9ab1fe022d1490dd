//! Divisions tried below a critical radius: it ends branches of trees only where they rest.

use std::sync::atomic::AtomicBool;

use super::{BoundaryKind, RestingRadii, critical_radius_within};
use crate::division::{DivisionError, DivisionInput, DivisionOptions, Outcome, divide_with};
use crate::equilibria::budget::StepBudget;
use crate::equilibria::error::{CellName, Result, ShapeError};
use furrow_cell::{Cell, Numerics};

/// The part of the critical radius at which a division is tried first.
const JUST_BELOW: f64 = 0.999;

/// The parts at which more divisions are tried, in this order.
const TRIED: [f64; 5] = [0.97, 0.9, 0.75, 0.5, 0.2];

/// Whether the division of a cell like `cell`, of radius R0 `r0`, comes to rest.
///
/// # Errors
/// [`ShapeError::Interrupted`].
fn rests(cell: &Cell, numerics: &Numerics, r0: f64, cancel: Option<&AtomicBool>) -> Result<bool> {
    let input = DivisionInput { cell: Cell { r0, ..cell.clone() }, numerics: *numerics, seed: 0 };
    match divide_with(&input, DivisionOptions { cancel, ..DivisionOptions::default() }) {
        Ok((division, _)) => Ok(division.outcome() == Outcome::Arrested),
        Err(DivisionError::Cancelled { .. }) => Err(ShapeError::Interrupted),
        Err(_) => Ok(false),
    }
}

/// The radius R0 just below the critical radius `critical_r0` of cells like `cell`, where a division was tried and rests.
///
/// # Errors
/// [`ShapeError::NoBound`] if it divides or does not come to rest; [`ShapeError::Interrupted`].
pub fn rests_below(
    cell: &Cell,
    numerics: &Numerics,
    (kind, critical_r0): (BoundaryKind, f64),
    cancel: Option<&AtomicBool>,
) -> Result<f64> {
    let r0 = JUST_BELOW * critical_r0;
    match rests(cell, numerics, r0, cancel)? {
        true => Ok(r0),
        false => Err(ShapeError::NoBound { cell: CellName::of(cell), kind: kind.point(), r0: critical_r0 }),
    }
}

/// The smallest radius R0 of which a division was tried below the critical radius `critical_r0` of cells like `cell`: those that
/// were tried between the two rest.
///
/// # Errors
/// Those of [`rests_below`].
pub fn rests_from(
    cell: &Cell,
    numerics: &Numerics,
    (kind, critical_r0): (BoundaryKind, f64),
    cancel: Option<&AtomicBool>,
) -> Result<f64> {
    let mut from = rests_below(cell, numerics, (kind, critical_r0), cancel)?;
    for part in TRIED {
        let r0 = part * critical_r0;
        if !rests(cell, numerics, r0, cancel)? {
            break;
        }
        from = r0;
    }
    Ok(from)
}

/// The critical radius of cells like `cell`, and down to which radius divisions rest, of a few that are tried.
///
/// # Errors
/// Those of [`critical_radius_within`] and [`rests_from`].
pub fn resting_radii(
    cell: &Cell,
    numerics: &Numerics,
    budget: &StepBudget<'_>,
    cancel: Option<&AtomicBool>,
) -> Result<RestingRadii> {
    let critical = critical_radius_within(cell, numerics, budget)?;
    let from = rests_from(cell, numerics, (critical.kind, critical.r0), cancel)?;
    Ok(RestingRadii { critical, from })
}
