//! What tests share. None of their programs uses all of it.
#![allow(dead_code)]

pub mod cases;
pub mod command;
pub mod shapes;
pub mod stand_in;
pub mod tables;
