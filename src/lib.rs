//! furrow
pub mod calibration;
pub mod cell;
pub mod cortex;
pub mod division;
pub mod input;
pub mod shapes;
pub mod stability;
