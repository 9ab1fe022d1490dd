//! A picture for each command.
//!
//! | file | content |
//! |---|---|
//! | [`division`] | a cell as it divides, χ and its neck over time, the normal forces half-way |
//! | [`surface`] | the same without axial symmetry: sections, the neck's radius and distance from the axis over time |
//! | [`azimuthal`] | modes of a stationary shape that are not axisymmetric |
//! | [`branch`] | a bifurcation diagram, with shapes |
//! | [`boundary`] | curves of pitchforks and folds, the critical value |
//! | [`perturbation`] | distances of perturbed stationary shapes from their initial shapes |
//! | [`phase`] | outcomes over a plane, with their exact edges |
//! | [`sweep`] | results over one axis or two |
//! | [`calibration`] | given and computed thresholds; an ensemble of constants |
//! | [`comparison`] | measured size asymmetries beside the model's |
//! | [`lifetimes`] | lifetimes of cells beside the model's, and cells alive over time |
//! | [`contours`] | measured outlines of a dividing cell, overlaid with the model's |
//! | [`curves`] | curves over any quantity, for results that no command has |
//! | [`dose`] | asymmetry over the dose of a protein, beside the model's over the strength of its cue |
//! | [`fit`] | fitted constants, activities and cues |
//! | [`hypotheses`] | measured χ with each hypothesis as a line |
//! | [`reproduction`] | the figures of the paper |
//! | [`rounds`] | rounds of the founders beside the observed ones |

pub mod azimuthal;
pub mod boundary;
pub mod branch;
pub mod calibration;
pub mod clock;
pub mod comparison;
pub mod contours;
pub mod curves;
pub mod division;
pub mod dose;
// Fits are not available on wasm32.
#[cfg(not(target_family = "wasm"))]
pub mod fit;
#[cfg(not(target_family = "wasm"))]
pub mod hypotheses;
pub mod lifetimes;
pub mod perturbation;
pub mod phase;
pub mod reproduction;
pub mod rounds;
pub mod surface;
pub mod sweep;
