//! Shared by the tests of this crate: a second statement of the mechanics, which shares no formula with
//! `furrow_mechanics::cortex`, and the states on which the two are compared.
//!
//! | module | role |
//! |---|---|
//! | [`coefficients`] | κ, η_b, η_s, Γ, γ, ξ_s, ξ_b at a point, from the cue's definition |
//! | [`balance`] | the balance of forces as rates along the contour, term by term from the paper |
//! | [`contour`] | curvatures and strain rates of a computed shape, from its positions and velocities alone |
//! | [`virtual_power`] | the balance of forces in its weak form, from energy and stress power |
//! | [`displaced`] | the weak form on a surface that is not axisymmetric |
//! | [`states`] | shapes at rest, moving shapes, random states |
//! | [`report`] | assertions that print the compared values |
//!
//! The tests are in `tests/`, one file for each kind of argument. `mutations.py` runs them on models with small errors.

pub mod balance;
pub mod coefficients;
pub mod contour;
pub mod displaced;
pub mod report;
pub mod states;
pub mod virtual_power;
