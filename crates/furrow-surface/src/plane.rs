//! The mirror plane of a cell without axial symmetry, φ = 0 and π, which contains the axis and the sides of all one-sided terms.

use std::f64::consts::{FRAC_PI_2, PI};

use furrow_cell::cue::Side;
use furrow_cell::{Cell, RigidityGradient};
use furrow_mechanics::division::DivisionError;

use crate::law::Vector;

/// Orientation of the plates that flatten a shell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plates {
    /// Parallel to the mirror plane: the cell may bend within the plane midway between the plates.
    Beside,
    /// Perpendicular to the mirror plane: the cell may bend towards the plates.
    Across,
}

impl Plates {
    /// Factors that convert 1/x², 1/y², 1/z² from the half-axes of a round shell to the half-axes of S.7.
    pub fn factors(self, flattening: f64) -> Vector<f64> {
        let (wide, thin) = (flattening, 1.0 / (flattening * flattening));
        match self {
            Plates::Beside => [wide, thin, wide],
            Plates::Across => [thin, wide, wide],
        }
    }
}

/// Angles that differ by less than this, in radians, are equal.
const EQUAL: f64 = 1e-9;

/// The cell rotated so that all sides of its cue are at φ = 0 or π, and the resulting orientation of the plates.
///
/// # Errors
/// No mirror plane contains them, or the law needs slopes that they do not have.
pub fn turned(cell: &Cell) -> Result<(Cell, Plates), DivisionError> {
    let unsupported = |what, instead| Err(DivisionError::Unsupported { what, instead });
    let mut turned = Cell { cue: cell.cue.simplified(), ..cell.clone() };
    let Some(turn) = turned.cue.terms().iter().find_map(|term| term.side).map(|side| side.at) else {
        return Ok((turned, Plates::Beside));
    };
    if cell.material.rigidity_gradient == RigidityGradient::Dropped {
        return unsupported(
            "a cue at one side of the axis needs the full force balance",
            "set rigidity_gradient = full",
        );
    }
    for Side { at, .. } in turned.cue.terms_mut().iter_mut().filter_map(|term| term.side.as_mut()) {
        let Some(half_turns) = multiple(*at - turn, PI) else {
            return unsupported(
                "the terms of the cue lie on no common plane through the axis",
                "place them at the same angle or at opposite ones",
            );
        };
        *at = if half_turns % 2 == 0 { 0.0 } else { PI };
    }
    if cell.shell.flattening == 1.0 {
        return Ok((turned, Plates::Beside));
    }
    match multiple(turn, FRAC_PI_2) {
        Some(quarters) if quarters % 2 == 0 => Ok((turned, Plates::Beside)),
        Some(_) => Ok((turned, Plates::Across)),
        None => unsupported(
            "between plates a cue lies midway between them or faces one",
            "set at = 0deg, 90deg, 180deg or 270deg",
        ),
    }
}

/// The angle divided by `unit`, if it is an integer multiple.
fn multiple(angle: f64, unit: f64) -> Option<i64> {
    let times = (angle / unit).round();
    ((angle - times * unit).abs() < EQUAL).then_some(times as i64)
}
