//! Documents, the page's module, the fuzz corpus, and the requirements of a release.

mod documents;
mod hostile_corpus;
mod page_artefact;
mod release;
