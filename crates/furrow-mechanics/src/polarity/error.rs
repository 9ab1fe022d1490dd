//! Why polarity could not be computed.

use furrow_bvp::{ContinuationError, NewtonError, SingularError};
use furrow_cell::CueError;
use furrow_input::shown_number;

/// Why polarity could not be computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PolarityError {
    /// The cell has no passive shape.
    #[error("R0 = {}: no passive shape to polarise: {source}", shown_number(*.r0))]
    Shape {
        /// Radius R0.
        r0: f64,
        /// Error of the solver.
        source: NewtonError,
    },
    /// The evolution in time failed.
    #[error("R0 = {}: the evolution of both antagonists stops after {time:.3e} s: {source}", shown_number(*.r0))]
    Evolution {
        /// Radius R0.
        r0: f64,
        /// Seconds from its start.
        time: f64,
        /// Error of the solver.
        source: NewtonError,
    },
    /// The boundary is too narrow for the mesh.
    #[error(
        "R0 = {}: the mesh does not resolve the boundary of both antagonists (defect {defect:.1e}); \
         raise d_a and d_p",
        shown_number(*.r0)
    )]
    Unresolved {
        /// Radius R0.
        r0: f64,
        /// Largest defect.
        defect: f64,
    },
    /// No tried size of cell is polarised.
    #[error("no polarised state found for cells of R0 from {:.3} to {:.3} with these constants", .range[0], .range[1])]
    NoPolarity {
        /// Smallest and largest radius R0 tried.
        range: [f64; 2],
    },
    /// Without polarity, the rest of a cue is not allowed.
    #[error(transparent)]
    Cue(#[from] CueError),
    /// Continuation of the branch of polarised states failed.
    #[error("the branch of polarised states is lost: {0}")]
    Branch(#[from] ContinuationError),
    /// The branch does not end in a fold.
    #[error("polarised states do not end in a fold: {why}")]
    NoFold {
        /// Description of the end that was found.
        why: String,
    },
    /// The fold was not located.
    #[error("the fold that ends polarised states: {0}")]
    Fold(#[from] SingularError),
}
