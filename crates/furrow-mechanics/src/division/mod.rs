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

pub use crate::cortex::observables::SecondNeck;
pub use outcome::{Division, DivisionError, DivisionRow, Ending, Outcome, advice_on_motion};
pub use run::{DivisionOptions, Frame, divide, divide_with};
pub use sensitivity::Sensitivity;
pub use statistics::Statistics;
pub use trajectory::{Recorder, Snapshot, Trajectory, uniform_times};

use furrow_cell::settings::{GREATEST_TIME_TOLERANCE, MOST_INTERVALS};
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

    /// The same on twice as many mesh intervals, with a quarter of the tolerance in time where rounding allows it; `None` above the
    /// largest number of intervals.
    ///
    /// ```
    /// use furrow_cell::Cell;
    /// use furrow_mechanics::division::{DivisionInput, divide};
    /// // In a large cell two furrows compete, and small errors decide.
    /// let input = DivisionInput::new(Cell { epsilon: 0.95, xi_s: 50.0, ..Cell::new(10.0) });
    /// let finer = input.refined().ok_or("as fine as a mesh may be")?;
    /// assert!(divide(&input)?.depends_on_numerics(&divide(&finer)?, true));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn refined(&self) -> Option<DivisionInput> {
        let given = self.numerics.time_tolerance;
        let intervals = 2 * self.numerics.intervals;
        let time_tolerance = (0.25 * given).max(self.numerics.least_time_tolerance()).min(given);
        let numerics = Numerics { intervals, time_tolerance, ..self.numerics };
        (intervals <= MOST_INTERVALS).then(|| DivisionInput { numerics, ..self.clone() })
    }

    /// The same on half as many mesh intervals, with four times the tolerance in time up to the largest one; `None` if no division can
    /// be computed on so few.
    ///
    /// ```
    /// use furrow_cell::Cell;
    /// use furrow_mechanics::division::DivisionInput;
    /// let coarser = DivisionInput::new(Cell::new(2.5)).coarsened().ok_or("as coarse as a mesh may be")?;
    /// assert_eq!((coarser.numerics.intervals, coarser.numerics.time_tolerance), (24, 6.4e-5));
    /// assert_eq!(coarser.coarsened(), None);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn coarsened(&self) -> Option<DivisionInput> {
        let intervals = self.numerics.intervals / 4 * 2;
        let time_tolerance = (4.0 * self.numerics.time_tolerance).min(GREATEST_TIME_TOLERANCE);
        let numerics = Numerics { intervals, time_tolerance, ..self.numerics };
        (intervals >= numerics.least_intervals()).then(|| DivisionInput { numerics, ..self.clone() })
    }
}
