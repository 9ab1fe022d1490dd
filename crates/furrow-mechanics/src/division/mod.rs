//! One division in time: implicit stepping of the cortex from the passive shape, or from a stationary one, to pinch-off or rest.
//!
//! | file | what it says |
//! |---|---|
//! | [`run`] | one division: noise, steps, pinch-off or rest |
//! | [`stepper`] | backward differentiation formulas on a moving mesh |
//! | `halves` | their steps on half of the contour, while the shape is nearly mirror-symmetric |
//! | `step_size` | how long the next step is |
//! | `start` | what it starts from |
//! | [`noise`] | the seeded noise of the first step |
//! | [`sensitivity`] | how the outcome changes with parameters, by the tangent of every step |
//! | [`slow`] | cells that wait at a stationary shape for longer than can be waited for |
//! | `oscillation` | cells that wander from side to side for ever |
//! | [`outcome`] | how a division ended: [`Division`], the one record of it |
//! | [`film`](mod@film) | a division that is kept, with what acts on every shape |
//! | [`statistics`] | what several divisions say together |

pub mod film;
mod halves;
mod limits;
pub mod noise;
mod oscillation;
pub mod outcome;
mod rest;
pub mod run;
pub mod sensitivity;
pub mod slow;
pub(crate) mod start;
pub mod statistics;
mod step_size;
pub mod stepper;

pub use film::{Film, Still, film};
pub use outcome::{Division, DivisionError, DivisionRow, Ending, Outcome};
pub use run::{Frame, divide, divide_observed, divide_with_sensitivities};
pub use sensitivity::Sensitivity;
pub use statistics::Statistics;

use furrow_cell::{Cell, Numerics};

/// What one division depends on, and all it depends on: equal inputs give bit-identical outcomes.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct DivisionInput {
    /// The cell.
    pub cell: Cell,
    /// Discretisation.
    pub numerics: Numerics,
    /// Seed of the noise in the first step.
    pub seed: u64,
}

impl DivisionInput {
    /// A cell's division with the default discretisation and seed 0.
    pub fn new(cell: Cell) -> DivisionInput {
        DivisionInput { cell, numerics: Numerics::default(), seed: 0 }
    }
}
