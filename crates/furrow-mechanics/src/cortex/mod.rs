//! The active viscous cortex of one cell in its shell: equations, their derivatives, symmetry, observables.
//!
//! | file | contents |
//! |---|---|
//! | [`equations`] | the force balance, once, for any number type |
//! | [`jacobian`] | the same with hand-written derivatives, for speed |
//! | [`lanes`] | numbers for vectorised loops |
//! | `sweep` | both at many points side by side |
//! | `own` | the same of a cell with a law of active stress of its own |
//! | `gradient` | numbers that carry derivatives by the state |
//! | `columns` | derivatives by parameters at many points |
//! | `coefficients` | the coefficients at a place, and a cache for the points of a sweep |
//! | [`problem`] | the boundary-value problem [`Cortex`] |
//! | [`derivatives`] | second and third derivatives, for singular points |
//! | `jets` | the same, and first derivatives by parameters, at many points side by side |
//! | [`symmetry`] | parity under the mirror u → 1 − u, unfolding of half contours |
//! | [`observables`] | observables of a shape: elongation, neck, furrow, volumes |
//! | `amount` | the amount of a regulator without turnover, which belongs to the cell |
//! | [`forces`] | curvatures, tensions, velocities and normal forces at a place |
//! | [`resolution`] | the mesh monitor |
//! | `wall` | the wall of the shell, for pictures |

pub(crate) mod amount;
mod coefficients;
mod columns;
pub mod derivatives;
pub mod equations;
pub mod forces;
mod gradient;
pub mod jacobian;
mod jets;
pub mod lanes;
pub mod observables;
pub(crate) mod own;
pub mod problem;
pub mod resolution;
mod sweep;
pub mod symmetry;
mod wall;

pub use equations::Domain;
pub use problem::Cortex;
pub use wall::Wall;
