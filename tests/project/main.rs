//! The project itself: its floors, its dependencies, the commands that its documents name, what fuzzers found.

#[path = "../common/mod.rs"]
mod common;

mod dependencies;
mod documented_commands;
mod floors;
mod hostile_corpus;
mod page_artefact;
