//! What the tests of this crate share: a second statement of the mechanics, which shares no formula with
//! `furrow_mechanics::cortex`, and the states that it is held against.
//!
//! | module | role |
//! |---|---|
//! | [`coefficients`] | κ, η_b, η_s, Γ, γ, ξ_s, ξ_b at a place, from the cue's definition |
//! | [`balance`] | the balance of forces as rates along the contour, term by term from the paper |
//! | [`contour`] | a computed shape as a surface: curvatures and strain rates from its positions and velocities alone |
//! | [`virtual_power`] | the balance of forces in its weak form, from energy and stress power |
//! | [`states`] | shapes at rest, shapes in motion, states drawn at random |
//! | [`report`] | a number that must be small, and how small it is |
//! | [`mutants`] | the table of errors that the tests must see |
//!
//! The tests themselves are in `tests/`, one file for each kind of argument; `tests/mutations/` of the whole says which of
//! them sees which error of the model.

pub mod balance;
pub mod coefficients;
pub mod contour;
pub mod mutants;
pub mod report;
pub mod states;
pub mod virtual_power;
