//! Documents, the page's module, the fuzz corpus, and what a release needs.

mod documents;
mod hostile_corpus;
mod page_artefact;
mod release;
