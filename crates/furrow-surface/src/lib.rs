//! A dividing cell's cortex as a surface without axial symmetry.
//!
//! The surface and its flow are splines of degree 4 along the contour times Fourier modes around it. The book numbers the
//! equations S.1 to S.9.
//!
//! | module | content |
//! |---|---|
//! | [`law`] | balance of forces by virtual power, for any type of number: S.1–S.6 |
//! | [`own`] | laws of active stress of the cell's own: S.9 |
//! | [`splines`], [`space`] | functions on the surface, regular at the poles |
//! | [`problem`], [`newton`], [`linear`] | the discrete equations and their solution |
//! | [`mesh`] | how rings are spread along the surface |
//! | [`plane`] | the mirror plane, a flattened shell and cues at one side of the axis |
//! | [`contact`], [`crossing`] | walls of a furrow that touch, and surfaces that cross themselves |
//! | [`stepper`], [`division`], [`noise`] | motion in time up to pinch-off or rest |
//! | [`steady`], [`rates`] | states at rest and their growth rates |
//! | [`bent`], [`bent_curves`] | branches of bent states at rest; their odd pitchfork and fold over R0 or ε |
//! | [`neck`], [`sample`], [`film`] | observables and samples of a shape |

pub mod bent;
pub mod bent_curves;
pub mod contact;
pub mod crossing;
pub mod division;
pub mod embed;
pub mod film;
mod jacobian;
pub mod law;
pub mod linear;
pub mod mesh;
pub mod neck;
pub mod newton;
pub mod noise;
pub mod number;
pub mod own;
pub mod plane;
pub mod problem;
pub mod rates;
pub mod sample;
pub mod space;
pub mod splines;
pub mod steady;
pub mod stepper;
