//! Which cells cannot divide, known before their division is computed.

use std::cell::RefCell;

use super::tree::TerminalReason;
use furrow_cell::{Cell, Cue};
use furrow_mechanics::equilibria::{CriticalRadii, ShapeError};

/// The rule that ends branches: a cell below the critical radius of its cue and constants does not divide.
///
/// Where no critical radius is found, divisions are computed.
#[derive(Debug)]
pub struct Thresholds<'a> {
    radii: CriticalRadii<'a>,
    unknown: RefCell<Vec<(Cue, ShapeError)>>,
}

impl<'a> Thresholds<'a> {
    /// By the given radii.
    pub fn new(radii: CriticalRadii<'a>) -> Thresholds<'a> {
        Thresholds { radii, unknown: RefCell::default() }
    }

    /// Why a cell cannot divide; `None` if it can, or if its division must be computed.
    pub fn of(&self, cell: &Cell) -> Option<TerminalReason> {
        self.radii
            .ends(cell)
            .unwrap_or_else(|error| {
                let mut unknown = self.unknown.borrow_mut();
                // An interrupted search is no property of the cue.
                let told = error != ShapeError::Interrupted;
                if told && !unknown.iter().any(|(cue, _)| *cue == cell.cue) {
                    unknown.push((cell.cue.clone(), error));
                }
                None
            })
            .map(TerminalReason::from)
    }

    /// Whether an answer about cells like this one takes no search for a radius.
    pub fn knows(&self, cell: &Cell) -> bool {
        self.radii.knows(cell)
    }

    /// The radius below which cells like `cell`, but without a cue, do not divide, where it is known.
    pub fn critical_radius(&self, cell: &Cell) -> Option<f64> {
        // The smallest cell is below any boundary.
        let smallest = Cell { r0: f64::MIN_POSITIVE, cue: Cue::none(), ..cell.clone() };
        self.radii.ends(&smallest).ok()?.map(|end| end.critical_r0)
    }

    /// Cues whose critical radius could not be found, and why.
    pub fn unknown(&self) -> Vec<(Cue, ShapeError)> {
        self.unknown.borrow().clone()
    }
}
