//! The start of a division: the passive shape, or a stationary shape of the active cell.

use furrow_bvp::newton::NewtonScratch;
use furrow_bvp::{Newton, NewtonReport, Solution};

use super::outcome::DivisionError;
use super::stepper::Stepper;
use crate::cortex::observables::with_components;
use crate::cortex::{Cortex, Domain};
use crate::equilibria::error::CellName;
use crate::equilibria::passive_whole;
use crate::law;
use furrow_cell::{Cell, Numerics};

/// Imbalance of the mesh above which it is rebuilt before the first step.
pub(super) const FIRST_MESH: f64 = 1.2;

/// The start of a division, and its duration.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Start<'a> {
    /// The passive shape without the cue, which is switched on together with the activity.
    Passive,
    /// A stationary shape of the cell on the whole contour. The motion that follows is observed for a given time,
    /// without skipping a wait at a saddle.
    Stationary {
        /// The shape.
        shape: &'a Solution,
        /// Duration of the observation, in τ.
        until: f64,
        /// Longest time step, in τ: the error of a step does not reveal growth from a tiny perturbation, and a long
        /// step would damp it.
        longest_step: f64,
    },
}

/// Validates the sizes of a cell.
pub(super) fn check(cell: &Cell) -> Result<(), DivisionError> {
    let Cell { r0, epsilon, .. } = *cell;
    let (field, value, allowed) = match (r0.is_finite() && r0 > 0.0, epsilon > 0.0 && epsilon < 1.0) {
        (false, _) => ("r0", r0, "a finite radius above 0"),
        (_, false) => ("epsilon", epsilon, "a volume fraction between 0 and 1, both excluded"),
        _ => return law::check(cell).map_err(|source| DivisionError::Law { r0: cell.r0, source }),
    };
    Err(DivisionError::BadInput { field, value, allowed })
}

impl Start<'_> {
    /// The cell at t = 0.
    pub(super) fn stepper(&self, cell: &Cell, numerics: &Numerics) -> Result<Stepper, DivisionError> {
        // Equivalent cues have one key, and so must give bit-identical results.
        let active = Cell { cue: cell.simplified_cue(), ..cell.clone() };
        let cortex = Cortex::new(&active, Domain::Full, &[]);
        let (shape, report) = match self {
            Start::Passive => {
                let (whole, report) = passive_whole(cell, numerics).map_err(|source| match law::cannot_rest(cell) {
                    Some(source) => DivisionError::Law { r0: cell.r0, source },
                    None => DivisionError::NoPassiveShape { cell: CellName::of(cell), source },
                })?;
                (with_components(&whole, cortex.components()), report)
            }
            Start::Stationary { shape, .. } => ((*shape).clone(), NewtonReport::default()),
        };
        let mut stepper = Stepper::new(cortex, numerics.stages, numerics.intervals, shape);
        stepper.solve_for(numerics.time_tolerance);
        stepper.count(report);
        if let Start::Stationary { .. } = self {
            stepper.exacting();
            stepper.adapt(cell.is_mirror_symmetric(), FIRST_MESH);
            settle(&mut stepper)?;
        }
        Ok(stepper)
    }

    /// The problem solved by the shape at t = 0.
    pub(super) fn cortex(&self, cell: &Cell) -> Cortex {
        let passive = cell.passive();
        Cortex::new(if let Start::Passive = self { &passive } else { cell }, Domain::Full, &[])
    }

    /// The end of the observation and the longest time step, in τ; `None` from the passive shape.
    pub(super) fn watched(&self) -> Option<[f64; 2]> {
        if let Start::Stationary { until, longest_step, .. } = *self { Some([until, longest_step]) } else { None }
    }
}

/// Makes the start shape stationary on the mesh of the division. A shape from another mesh is stationary only to the
/// accuracy of that mesh, which may be a larger perturbation than the noise.
fn settle(stepper: &mut Stepper) -> Result<(), DivisionError> {
    let mut cortex = Cortex::new(&stepper.cortex.cell, Domain::Full, &[]);
    let newton = Newton { tolerance: 1e-11, ..Newton::default() };
    let level = &mut stepper.history[0];
    let solved =
        newton.solve(&mut stepper.system, &mut NewtonScratch::default(), &mut cortex, &mut level.y, &[], false);
    let report = solved.map_err(|source| DivisionError::NotStationary { cell: CellName::of(&cortex.cell), source })?;
    stepper.count(report);
    Ok(())
}
