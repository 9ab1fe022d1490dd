//! Trial divisions near a critical radius: it ends branches of trees only where they come to rest below it.

use std::sync::atomic::AtomicBool;

use super::{BoundaryKind, Method, RestingRadii};
use crate::division::{DivisionError, DivisionInput, Outcome};
use crate::equilibria::budget::StepBudget;
use crate::equilibria::error::{CellName, Result, ShapeError};
use furrow_cell::{Cell, Numerics};

/// The fraction of the critical radius at which the first division is tried.
const JUST_BELOW: f64 = 0.999;

/// The fraction at which a division is tried above it. Closer cells divide after a long time.
const JUST_ABOVE: f64 = 1.02;

/// The fractions at which further divisions are tried, in order.
const TRIED: [f64; 5] = [0.97, 0.9, 0.75, 0.5, 0.2];

/// Whether a cell like `cell` with radius `r0` comes to rest undivided.
///
/// # Errors
/// [`ShapeError::Interrupted`].
fn rests(cell: &Cell, numerics: &Numerics, r0: f64, method: &Method, cancel: Option<&AtomicBool>) -> Result<bool> {
    let input = DivisionInput { cell: Cell { r0, ..cell.clone() }, numerics: *numerics, seed: 0 };
    match (method.divide)(&input, cancel) {
        Ok(division) => Ok(division.outcome() == Outcome::Arrested),
        Err(DivisionError::Cancelled { .. }) => Err(ShapeError::Interrupted),
        Err(_) => Ok(false),
    }
}

/// A radius just below the critical radius `critical_r0` of cells like `cell` at which a trial division comes to rest.
///
/// # Errors
/// [`ShapeError::NoBound`] if the cell divides or does not come to rest; [`ShapeError::Interrupted`].
pub fn rests_below(
    cell: &Cell,
    numerics: &Numerics,
    (kind, critical_r0): (BoundaryKind, f64),
    method: &Method,
    cancel: Option<&AtomicBool>,
) -> Result<f64> {
    let r0 = JUST_BELOW * critical_r0;
    match rests(cell, numerics, r0, method, cancel)? {
        true => Ok(r0),
        false => Err(ShapeError::NoBound { cell: CellName::of(cell), kind: kind.point(), r0: critical_r0 }),
    }
}

/// Whether division begins at the critical radius `critical_r0` of cells like `cell`, by a trial division just above it.
///
/// # Errors
/// [`ShapeError::RestsAbove`] if that cell comes to rest; [`ShapeError::Interrupted`].
pub fn divides_above(
    cell: &Cell,
    numerics: &Numerics,
    (kind, critical_r0): (BoundaryKind, f64),
    method: &Method,
    cancel: Option<&AtomicBool>,
) -> Result<()> {
    let above = JUST_ABOVE * critical_r0;
    match rests(cell, numerics, above, method, cancel)? {
        true => Err(ShapeError::RestsAbove { cell: CellName::of(cell), kind: kind.point(), r0: critical_r0, above }),
        false => Ok(()),
    }
}

/// The smallest radius with a trial division below the critical radius `critical_r0` of cells like `cell`, such that
/// all trial divisions between the two come to rest.
///
/// # Errors
/// The errors of [`rests_below`].
pub fn rests_from(
    cell: &Cell,
    numerics: &Numerics,
    (kind, critical_r0): (BoundaryKind, f64),
    method: &Method,
    cancel: Option<&AtomicBool>,
) -> Result<f64> {
    let mut from = rests_below(cell, numerics, (kind, critical_r0), method, cancel)?;
    for part in TRIED {
        let r0 = part * critical_r0;
        if !rests(cell, numerics, r0, method, cancel)? {
            break;
        }
        from = r0;
    }
    Ok(from)
}

/// The critical radius of cells like `cell`, and the radius down to which a few trial divisions come to rest.
///
/// # Errors
/// The errors of [`Method::radius`] and [`rests_from`].
pub fn resting_radii(
    cell: &Cell,
    numerics: &Numerics,
    method: &Method,
    budget: &StepBudget<'_>,
    cancel: Option<&AtomicBool>,
) -> Result<RestingRadii> {
    let critical = (method.radius)(cell, numerics, budget)?;
    let from = rests_from(cell, numerics, (critical.kind, critical.r0), method, cancel)?;
    Ok(RestingRadii { critical, from })
}
