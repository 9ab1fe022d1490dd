//! Which cells cannot divide, known before their division is computed.

use std::cell::RefCell;

use super::tree::TerminalReason;
use furrow_cell::{Cell, Cue};
use furrow_mechanics::critical::CriticalRadii;
use furrow_mechanics::equilibria::ShapeError;

/// The rule that ends a branch before its division is computed.
#[derive(Clone, Copy)]
pub enum EndRule<'a> {
    /// No rule: every division is computed.
    Dynamics,
    /// Critical radii. Unknown ones are searched for on the workers.
    Thresholds(&'a Thresholds<'a>),
    /// A function, called on the thread that grows the tree.
    Custom(&'a dyn Fn(&Cell) -> Option<TerminalReason>),
}

/// Which cells of a tree critical radii decide about. Divisions decide about the others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scope {
    /// All cells.
    #[default]
    All,
    /// The first cell only if its radius is known: its division costs less than a search, and if it fails there are no
    /// other cells.
    FirstIfKnown,
    /// All cells but the first.
    AllButFirst,
    /// Cells of known radius.
    Known,
}

/// A cell below the critical radius of its cue and constants does not divide.
///
/// Where no critical radius is found, divisions are computed.
#[derive(Debug)]
pub struct Thresholds<'a> {
    /// They may be searched for on any thread.
    pub(super) radii: CriticalRadii<'a>,
    scope: Scope,
    unknown: RefCell<Vec<(Cue, ShapeError)>>,
}

impl<'a> Thresholds<'a> {
    /// By the given radii.
    pub fn new(radii: CriticalRadii<'a>) -> Thresholds<'a> {
        Thresholds { radii, scope: Scope::All, unknown: RefCell::default() }
    }

    /// The same for fewer cells of a tree.
    #[must_use]
    pub fn with_scope(self, scope: Scope) -> Thresholds<'a> {
        Thresholds { scope, ..self }
    }

    /// Whether a critical radius decides about a cell of a tree, its first one or another.
    pub(super) fn decides(&self, cell: &Cell, is_first: bool) -> bool {
        self.radii.apply_to(&cell.cue)
            && match self.scope {
                Scope::All => true,
                Scope::FirstIfKnown => !is_first || self.knows(cell),
                Scope::AllButFirst => !is_first,
                Scope::Known => self.knows(cell),
            }
    }

    /// Why a cell cannot divide; `None` if it can, or if its division must be computed. It searches where it must.
    pub fn of(&self, cell: &Cell) -> Option<TerminalReason> {
        match self.radii.ends(cell) {
            Ok(end) => end.map(TerminalReason::from),
            // An interrupted search is no property of the cue.
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

    /// Whether it is known for cells like this one that there is a critical radius, or that there is no such radius.
    pub fn knows(&self, cell: &Cell) -> bool {
        self.radii.knows(cell)
    }

    /// The radius below which cells like `cell`, but without a cue, do not divide, where it is known.
    pub fn critical_radius(&self, cell: &Cell) -> Option<f64> {
        self.radii.known_radius(&cell.clone().with_cue(Cue::none()))
    }

    /// Cues without a known critical radius, because the search for it failed, and the reason.
    pub fn unknown(&self) -> Vec<(Cue, ShapeError)> {
        self.unknown.borrow().clone()
    }
}
