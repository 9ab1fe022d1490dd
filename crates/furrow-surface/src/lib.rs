//! A dividing cell's cortex as a surface without axial symmetry.

pub mod contact;
pub mod crossing;
pub mod division;
pub mod embed;
mod jacobian;
pub mod law;
pub mod linear;
pub mod mesh;
pub mod neck;
pub mod newton;
pub mod noise;
pub mod number;
pub mod problem;
pub mod rates;
pub mod sample;
pub mod space;
pub mod splines;
pub mod steady;
pub mod stepper;
