//! Which cells cannot divide, told ahead of their division.

use std::cell::RefCell;

use super::tree::EndReason;
use crate::cell::{Cell, Cue};
use crate::shapes::{CriticalRadii, ShapeError};

/// The rule that ends branches: a cell below the critical radius of its kind does not divide.
///
/// A kind of cell whose critical radius cannot be found is left to its dynamics: its divisions tell.
#[derive(Debug)]
pub struct Ends<'a> {
    radii: CriticalRadii<'a>,
    unknown: RefCell<Vec<(Cue, ShapeError)>>,
}

impl<'a> Ends<'a> {
    /// By the given radii.
    pub fn new(radii: CriticalRadii<'a>) -> Ends<'a> {
        Ends { radii, unknown: RefCell::default() }
    }

    /// Why a cell cannot divide; `None` if it can, or if only its division tells.
    pub fn of(&self, cell: &Cell) -> Option<EndReason> {
        self.radii
            .ends(cell)
            .unwrap_or_else(|error| {
                let mut unknown = self.unknown.borrow_mut();
                // An interrupted search says nothing of the cue, and the growth that asked is about to end.
                let told = error != ShapeError::Interrupted;
                if told && !unknown.iter().any(|(cue, _)| *cue == cell.cue) {
                    unknown.push((cell.cue.clone(), error));
                }
                None
            })
            .map(EndReason::from)
    }

    /// Whether an answer about cells like this one takes no search for a radius.
    pub fn knows(&self, cell: &Cell) -> bool {
        self.radii.knows(cell)
    }

    /// The radius below which cells like `cell`, but without a cue, do not divide, where it is known.
    pub fn critical_radius(&self, cell: &Cell) -> Option<f64> {
        // There is no cell so small that it divides, so that this one is told its boundary.
        let smallest = Cell { r0: f64::MIN_POSITIVE, cue: Cue::none(), ..cell.clone() };
        self.radii.ends(&smallest).ok()?.map(|end| end.critical_r0)
    }

    /// Cues whose critical radius could not be found, and why.
    pub fn unknown(&self) -> Vec<(Cue, ShapeError)> {
        self.unknown.borrow().clone()
    }
}
