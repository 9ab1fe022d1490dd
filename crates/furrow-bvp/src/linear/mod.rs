//! The linearised collocation system.

mod system;

pub use system::System;
