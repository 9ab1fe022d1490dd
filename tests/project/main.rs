//! Documents, the page's module, and the fuzz corpus.

#[path = "../common/mod.rs"]
mod common;

mod documents;
mod hostile_corpus;
mod page_artefact;
