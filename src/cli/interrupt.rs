//! What Ctrl-C does: it ends a command at once, unless divisions are under way that are worth finishing.

use super::output::say;
use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};

/// Set by Ctrl-C.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);
/// Whether the command looks at [`INTERRUPTED`] itself.
static GENTLY: AtomicBool = AtomicBool::new(false);

/// Begins to listen to Ctrl-C, which from now on ends the command at once: a computation that keeps nothing on the way has
/// nothing to finish.
pub fn listen() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        if let Err(error) = ctrlc::set_handler(interrupt) {
            tracing::debug!("Ctrl-C will stop without a word: {error}");
        }
    });
}

/// From now on the first Ctrl-C only sets [`flag`]. For commands that solve divisions.
pub fn gently() {
    GENTLY.store(true, Ordering::SeqCst);
}

/// From now on Ctrl-C ends the command at once again; one that has come meanwhile does so here. For what follows the divisions
/// and keeps nothing on the way, as pictures.
pub fn at_once() {
    GENTLY.store(false, Ordering::SeqCst);
    if INTERRUPTED.load(Ordering::SeqCst) {
        end();
    }
}

/// Does something that is not to be broken off, such as writing a file.
pub fn unbroken<T>(work: impl FnOnce() -> T) -> T {
    let gently = GENTLY.swap(true, Ordering::SeqCst);
    let done = work();
    GENTLY.store(gently, Ordering::SeqCst);
    if !gently && INTERRUPTED.load(Ordering::SeqCst) {
        end();
    }
    done
}

/// What Ctrl-C sets: divisions under way are finished and kept, none is begun.
pub fn flag() -> &'static AtomicBool {
    &INTERRUPTED
}

fn interrupt() {
    let again = INTERRUPTED.swap(true, Ordering::SeqCst);
    if !GENTLY.load(Ordering::SeqCst) {
        end();
    }
    if again {
        std::process::exit(130);
    }
    say("finishing what is under way; interrupt again to stop at once");
}

fn end() -> ! {
    say("error: interrupted");
    std::process::exit(1);
}
