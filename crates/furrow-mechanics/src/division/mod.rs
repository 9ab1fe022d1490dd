//! One division in time: implicit stepping of the cortex from the passive shape, or from a stationary one, to pinch-off or rest.
//!
//! | file | contents |
//! |---|---|
//! | [`run`] | one division: noise, steps, pinch-off or rest |
//! | [`stepper`] | backward differentiation formulas on a moving mesh |
//! | `halves` | steps on half of the contour, while the shape is nearly mirror-symmetric |
//! | `step_size` | the length of the next step |
//! | `start` | the start shape |
//! | [`noise`] | the seeded noise of the first step |
//! | [`sensitivity`] | derivatives of the outcome, by the tangent of every step |
//! | `followed` | the same where the cue follows PAR polarity |
//! | `rest` | detection of equilibria |
//! | [`saddle`] | skips the linear growth at a saddle where a cell waits longer than the allowed time |
//! | [`oscillation`] | detection of limit cycles |
//! | `limits` | the step budget, and cells that drift or creep |
//! | [`outcome`] | the outcome of a division: [`Division`] |
//! | [`trajectory`] | all shapes of a division, with their forces |
//! | [`statistics`] | statistics of several divisions |

mod followed;
mod halves;
mod limits;
pub mod noise;
pub mod oscillation;
pub mod outcome;
mod rest;
pub mod run;
pub mod saddle;
pub mod sensitivity;
pub(crate) mod start;
pub mod statistics;
mod step_size;
pub mod stepper;
pub mod trajectory;

pub use outcome::{Division, DivisionError, DivisionRow, Ending, Outcome, advice_on_motion};
pub use run::{DivisionOptions, Frame, divide, divide_with};
pub use sensitivity::Sensitivity;
pub use statistics::Statistics;
pub use trajectory::{Recorder, Snapshot, Trajectory, uniform_times};

use furrow_cell::settings::MOST_INTERVALS;
use furrow_cell::{Cell, Numerics};

/// All inputs of a division: equal inputs give bit-identical outcomes.
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

    /// The same on twice as many mesh intervals; `None` above the largest number of intervals.
    ///
    /// ```
    /// use furrow_cell::Cell;
    /// use furrow_mechanics::division::{DivisionInput, divide};
    /// // A bud at the pole grows from next to nothing, and cuts itself off or does not.
    /// let cue = "activity:step,u0=0.2307,omega=0.29531,amplitude=0.7099".parse()?;
    /// let cell = Cell { epsilon: 0.9533, xi_s: 50.211, ..Cell::new(7.7227) }.with_cue(cue);
    /// let input = DivisionInput::new(cell);
    /// let finer = input.on_twice_the_mesh().ok_or("as fine as a mesh may be")?;
    /// assert!(divide(&input)?.depends_on_mesh(&divide(&finer)?, false));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn on_twice_the_mesh(&self) -> Option<DivisionInput> {
        let intervals = 2 * self.numerics.intervals;
        (intervals <= MOST_INTERVALS)
            .then(|| DivisionInput { numerics: Numerics { intervals, ..self.numerics }, ..self.clone() })
    }
}
