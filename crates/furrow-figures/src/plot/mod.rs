//! A picture of what each command computes.
//!
//! | file | what it shows |
//! |---|---|
//! | [`division`] | a cell as it divides, χ and its neck over time, the normal forces half-way |
//! | [`azimuthal`] | modes of a stationary shape that are not axisymmetric |
//! | [`branch`] | a bifurcation diagram, with shapes |
//! | [`boundary`] | curves of pitchforks and folds, the critical value |
//! | [`perturbation`] | how far disturbed stationary shapes come from where they started |
//! | [`phase`] | outcomes over a plane, with their exact edges |
//! | [`sweep`] | results over one axis or two |
//! | [`calibration`] | thresholds wanted and met; an ensemble of constants |
//! | [`comparison`] | measured size asymmetries beside the model's |
//! | [`lifetimes`] | lifetimes of cells beside the model's, and cells alive over time |
//! | [`contours`] | measured outlines of a dividing cell, with the model's over them |
//! | [`dose`] | asymmetry over the dose of a protein beside the model's over the strength of its cue |
//! | [`fit`] | constants, activities and cues that fit |
//! | [`reproduction`] | the figures of the paper, each by what it is |
//! | [`rounds`] | rounds of the founders beside the observed ones |

pub mod azimuthal;
pub mod boundary;
pub mod branch;
pub mod calibration;
pub mod comparison;
pub mod contours;
pub mod division;
pub mod dose;
// Nothing is fitted on wasm32.
#[cfg(not(target_family = "wasm"))]
pub mod fit;
pub mod lifetimes;
pub mod perturbation;
pub mod phase;
pub mod reproduction;
pub mod rounds;
pub mod sweep;
