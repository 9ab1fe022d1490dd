//! What tests share. None of their programs uses all of it.
#![allow(dead_code)]

pub mod command;
pub mod stand_in;
pub mod tables;
