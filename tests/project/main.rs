//! The project itself: its documents, the fingerprint of the solver, what fuzzers found.

#[path = "../common/mod.rs"]
mod common;

mod documents;
mod fingerprint;
mod hostile_corpus;
mod page_artefact;
