//! The functions that a page calls, in the C ABI.
//!
//! A page asks for room with [`furrow_request`], writes a JSON text there, calls one of the functions with its length
//! and reads the answer (see [`Answer::bytes`]) from the returned address. Both buffers are valid until the next call.
//! The module imports one function, `page.progress`, which it calls as a tree grows.

// The language treats exported names as unsafe, since two could clash; these are the only ones.
#![allow(unsafe_code)]

use std::sync::{Mutex, MutexGuard, PoisonError};

use super::answer::{Answer, PageError};
use super::{division, edge, tree};

static REQUEST: Mutex<Vec<u8>> = Mutex::new(Vec::new());
static ANSWER: Mutex<Vec<u8>> = Mutex::new(Vec::new());

/// A page runs each instance of the module on one thread, so that the lock is always free.
fn hold(bytes: &'static Mutex<Vec<u8>>) -> MutexGuard<'static, Vec<u8>> {
    bytes.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Room for a request of the given number of bytes.
#[unsafe(no_mangle)]
pub extern "C" fn furrow_request(length: usize) -> *mut u8 {
    let mut request = hold(&REQUEST);
    request.clear();
    request.resize(length, 0);
    request.as_mut_ptr()
}

/// Answers the request with `function` and returns the address of the answer.
fn answer(function: impl FnOnce(&[u8]) -> Result<Answer, PageError>) -> *const u8 {
    let found = function(&hold(&REQUEST)).unwrap_or_else(|error| Answer::refusal(&error));
    let mut bytes = hold(&ANSWER);
    *bytes = found.bytes();
    bytes.as_ptr()
}

/// One division: see [`division::divide`].
#[unsafe(no_mangle)]
pub extern "C" fn furrow_divide() -> *const u8 {
    answer(division::divide)
}

/// A tree: see [`tree::regrow`].
#[unsafe(no_mangle)]
pub extern "C" fn furrow_regrow() -> *const u8 {
    answer(|request| tree::regrow(request, &tell))
}

/// A tree as Newick: see [`tree::as_newick`].
#[unsafe(no_mangle)]
pub extern "C" fn furrow_newick() -> *const u8 {
    answer(tree::as_newick)
}

/// The sections of a page on a tree: see [`tree::told`].
#[unsafe(no_mangle)]
pub extern "C" fn furrow_told() -> *const u8 {
    answer(tree::told)
}

/// A curve of pitchforks: see [`edge::edge`].
#[unsafe(no_mangle)]
pub extern "C" fn furrow_edge() -> *const u8 {
    answer(edge::edge)
}

#[cfg(target_family = "wasm")]
#[link(wasm_import_module = "page")]
unsafe extern "C" {
    /// Called after each solved division of a growing tree, with the number solved and the number known to be waiting.
    safe fn progress(solved: u32, waiting: u32);
}

#[cfg(target_family = "wasm")]
fn tell(solved: usize, waiting: usize) {
    progress(solved as u32, waiting as u32);
}

/// A native build has no page to report to.
#[cfg(not(target_family = "wasm"))]
fn tell(_solved: usize, _waiting: usize) {}
