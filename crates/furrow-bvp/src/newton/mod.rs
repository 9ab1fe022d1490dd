//! Newton's method on a given mesh, and on meshes of its own choice.

mod carried;
mod condition;
mod homotopy;
mod iteration;
mod limits;
mod solved;
mod solver;
mod work;

pub use iteration::{Newton, NewtonError, NewtonReport, NewtonScratch};
pub(crate) use limits::WorkLimit;
pub use limits::{Interrupt, Stop};
pub use solved::Solved;
pub(crate) use solver::{BUDGET, NEWTON_SHARE};
pub use solver::{Settings, SolveError, solve};
pub use work::Work;
