//! Helpers that tests share. No test program uses all of them.
#![allow(dead_code)]

pub mod cases;
pub mod command;
pub mod shapes;
pub mod stand_in;
pub mod tables;
