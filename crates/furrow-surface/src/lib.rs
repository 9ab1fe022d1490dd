//! The cortex of a dividing cell as a surface without axial symmetry.
//!
//! The surface and its flow are splines of degree 4 along the contour times Fourier modes around it. The book numbers the
//! equations S.1 to S.9.
//!
//! | module | content |
//! |---|---|
//! | [`law`] | balance of forces by virtual power, for any number type: S.1–S.6 |
//! | [`own`] | user-defined laws of active stress: S.9 |
//! | [`splines`], [`space`] | functions on the surface, regular at the poles |
//! | [`problem`], [`newton`], [`linear`] | the discrete equations and their solution |
//! | [`mesh`] | distribution of rings along the surface |
//! | [`plane`] | the mirror plane, a flattened shell and one-sided cues |
//! | [`contact`], [`crossing`] | contact of the walls of a furrow, self-intersections |
//! | [`stepper`], [`division`], [`noise`] | motion in time up to pinch-off or rest |
//! | [`steady`], [`rates`] | stationary states and their growth rates |
//! | [`bent`], [`bent_curves`] | branches of bent stationary states; their odd pitchfork and fold over R0 or ε |
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
