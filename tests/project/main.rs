//! Documents, the page's module, and the fuzz corpus.

mod documents;
mod hostile_corpus;
mod page_artefact;
