//! The command line: sessions, help, errors, what Ctrl-C does, hostile files, readers of exports, and the page.

#[path = "../common/mod.rs"]
mod common;

mod configuration;
mod hostile_files;
mod interrupts;
mod movies;
mod page;
mod readers;
mod sessions;
mod stored_boundary;
mod usage;
