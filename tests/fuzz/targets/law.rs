//! Laws of active stress.

use furrow_cell::{Cell, Law};

use super::{FILE, accepted, survives_json, text};

/// A valid law survives writing and reading as JSON, mirrored twice it is itself, and a cell with it has a symmetry.
pub fn check(data: &[u8]) {
    let Some(text) = text(data) else { return };
    let Some(law) = accepted(Law::parse(text, FILE)) else { return };
    survives_json(&law);
    assert_eq!(law.mirrored().mirrored(), law);
    let cell = Cell::new(2.0).with_law(law);
    let _ = cell.is_mirror_symmetric();
    assert!(cell.law.iter().flat_map(|law| law.parameters()).all(|parameter| parameter.is_of(&cell)));
}
