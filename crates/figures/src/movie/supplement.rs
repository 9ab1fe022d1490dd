//! The four kinds of division that the paper is about, as it shows them beside its text: by size alone a cell divides into equal
//! halves, into unequal ones or not at all, and a cue makes a large one divide unequally.

use crate::cell::{Cell, Cue};

/// A movie of the supplement.
pub struct Scene {
    /// The name of its file, without the extension.
    pub name: &'static str,
    /// What it shows.
    pub shows: &'static str,
    /// Its cell.
    pub cell: Cell,
}

/// All four, of cells with the constants of `like`.
pub fn scenes(like: &Cell) -> [Scene; 4] {
    let cell = |r0: f64, cue: Cue| Cell { r0, cue, ..like.clone() };
    [
        Scene { name: "1_symmetric", shows: "a large cell, without a cue: equal halves", cell: cell(3.0, Cue::none()) },
        Scene {
            name: "2_asymmetric",
            shows: "a smaller one: the symmetric furrow is unstable",
            cell: cell(2.0, Cue::none()),
        },
        Scene { name: "3_failed", shows: "below the critical radius: it stays at rest", cell: cell(1.6, Cue::none()) },
        Scene { name: "4_cued", shows: "the zygote, with the cue of the germline", cell: cell(5.4, Cue::published()) },
    ]
}
