//! The project itself: its documents, the module of its page, what fuzzers found.

#[path = "../common/mod.rs"]
mod common;

mod documents;
mod hostile_corpus;
mod page_artefact;
