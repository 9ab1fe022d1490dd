//! Cells that are known not to divide before their division is computed.

use std::cell::RefCell;

use super::tree::TerminalReason;
use furrow_cell::{Cell, Cue};
use furrow_mechanics::critical::CriticalRadii;
use furrow_mechanics::equilibria::ShapeError;

/// The rule that ends a branch without computing a division.
#[derive(Clone, Copy)]
pub enum EndRule<'a> {
    /// There is no rule; every division is computed.
    Dynamics,
    /// Critical radii. Unknown ones are computed on the workers.
    Thresholds(&'a Thresholds<'a>),
    /// A function that is called on the thread that grows the tree.
    Custom(&'a dyn Fn(&Cell) -> Option<TerminalReason>),
}

/// The cells of a tree for which critical radii are used. For other cells divisions are computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scope {
    /// All cells.
    #[default]
    All,
    /// All cells, but the first cell only if the critical radius is known: its division costs less than a search, and if it fails
    /// there are no other cells.
    FirstIfKnown,
    /// All cells but the first.
    AllButFirst,
    /// Cells with a known critical radius.
    Known,
}

/// A cell below the critical radius of its cue and constants does not divide.
///
/// If no critical radius is found, divisions are computed.
#[derive(Debug)]
pub struct Thresholds<'a> {
    /// Critical radii, which may be computed on any thread.
    pub(super) radii: CriticalRadii<'a>,
    scope: Scope,
    unknown: RefCell<Vec<(Cue, ShapeError)>>,
}

impl<'a> Thresholds<'a> {
    /// Uses the given critical radii.
    pub fn new(radii: CriticalRadii<'a>) -> Thresholds<'a> {
        Thresholds { radii, scope: Scope::All, unknown: RefCell::default() }
    }

    /// The same for a subset of the cells of a tree.
    #[must_use]
    pub fn with_scope(self, scope: Scope) -> Thresholds<'a> {
        Thresholds { scope, ..self }
    }

    /// Whether a critical radius is used for a cell of a tree, which may be the first cell.
    pub(super) fn decides(&self, cell: &Cell, is_first: bool) -> bool {
        self.radii.apply_to(&cell.cue)
            && match self.scope {
                Scope::All => true,
                Scope::FirstIfKnown => !is_first || self.knows(cell),
                Scope::AllButFirst => !is_first,
                Scope::Known => self.knows(cell),
            }
    }

    /// The reason why a cell cannot divide; `None` if it can, or if its division must be computed. The critical radius is computed if
    /// necessary.
    pub fn of(&self, cell: &Cell) -> Option<TerminalReason> {
        match self.radii.ends(cell) {
            Ok(end) => end.map(TerminalReason::from),
            // An interruption of the search is not a property of the cue.
            Err(ShapeError::Interrupted) => None,
            Err(error) => {
                let mut unknown = self.unknown.borrow_mut();
                if !unknown.iter().any(|(cue, _)| *cue == cell.cue) {
                    unknown.push((cell.cue.clone(), error));
                }
                None
            }
        }
    }

    /// Whether the critical radius of cells like this one, or its absence, is known.
    pub fn knows(&self, cell: &Cell) -> bool {
        self.radii.knows(cell)
    }

    /// The radius below which cells like `cell`, but without a cue, do not divide, if it is known.
    pub fn critical_radius(&self, cell: &Cell) -> Option<f64> {
        self.radii.known_radius(&cell.clone().with_cue(Cue::none()))
    }

    /// Cues for which the search for a critical radius failed, and the reason.
    pub fn unknown(&self) -> Vec<(Cue, ShapeError)> {
        self.unknown.borrow().clone()
    }
}
