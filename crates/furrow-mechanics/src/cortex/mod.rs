//! The active viscous cortex of one cell in its shell: equations, their derivatives, symmetry, observables.
//!
//! | file | what it says |
//! |---|---|
//! | [`equations`] | the force balance, once, for any number type |
//! | [`jacobian`] | the same with hand-written derivatives, for speed |
//! | [`lanes`] | numbers whose loops become vector code |
//! | `sweep` | both at many points side by side |
//! | `columns` | derivatives by parameters, at as many |
//! | `coefficients` | their coefficients at a place, and at the points of a sweep, kept for the next |
//! | [`problem`] | the boundary-value problem [`Cortex`] that is solved |
//! | [`derivatives`] | second and third derivatives, for singular points |
//! | `jets` | the same, and first derivatives by parameters, at many points side by side |
//! | [`symmetry`] | parity under the mirror u → 1 − u, halves unfolded |
//! | [`observables`] | what is read off a shape: elongation, neck, furrow, volumes |
//! | `amount` | the amount of a regulator without turnover, which belongs to the cell |
//! | [`forces`] | what acts at a place: curvatures, tensions, velocities, the normal forces by what they come from |
//! | [`resolution`] | where a mesh has to be fine |

pub(crate) mod amount;
mod coefficients;
mod columns;
pub mod derivatives;
pub mod equations;
pub mod forces;
pub mod jacobian;
mod jets;
pub mod lanes;
pub mod observables;
pub mod problem;
pub mod resolution;
mod sweep;
pub mod symmetry;

pub use equations::Domain;
pub use problem::Cortex;
