//! The pictures of [furrow](https://docs.rs/furrow): charts of what its commands compute, drawings and movies of dividing
//! cells.
//!
//! `furrow` gives all of it under its own name (`furrow::plot`, `furrow::movie`), and everybody takes it from there. Nothing is
//! computed here that is not needed to draw: what is drawn is what the floors below have found.
//!
//! | module | role |
//! |---|---|
//! | [`drawing`] | one style, a canvas for SVG and PNG, axes, legends, cells |
//! | [`plot`] | a picture of what each command computes |
//! | [`movie`] | a division as a moving picture |

pub mod drawing;
pub mod movie;
pub mod plot;

// The floors below, by the names they have in `furrow`.
use embryo::{batch, lineage, study};
use mechanics::{calibration, cell, cortex, division, perturbation, shapes};
