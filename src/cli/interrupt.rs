//! Ctrl-C stops the command immediately, unless the command finishes divisions in progress.

use super::error::CliError;
use super::messages::{self, Level};
use super::output::eprint;
use furrow_formats::write_atomically;
use std::path::Path;
use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};

/// Set by Ctrl-C.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);
/// Whether the command checks [`INTERRUPTED`] itself.
static FINISH: AtomicBool = AtomicBool::new(false);

/// Whether solved divisions go to the cache.
static CACHES: AtomicBool = AtomicBool::new(false);

/// Declares that solved divisions go to the cache from now on; the message printed at Ctrl-C mentions this.
pub fn cached() {
    CACHES.store(true, Ordering::SeqCst);
}

/// Starts to listen, once. Until [`finish`] is called Ctrl-C stops the command immediately, since there are no results to keep.
pub fn listen() {
    static ONCE: Once = Once::new();
    ONCE.call_once(set_handler);
}

fn set_handler() {
    if let Err(error) = on_interrupt(interrupt) {
        messages::write(Level::Debug, format_args!("Ctrl-C will stop without a message: {error}"));
    }
}

/// Calls `act` on a separate thread at every Ctrl-C, termination request and loss of the terminal.
#[cfg(unix)]
fn on_interrupt(act: fn()) -> std::io::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    let mut signals = signal_hook::iterator::Signals::new([SIGINT, SIGTERM, SIGHUP])?;
    std::thread::Builder::new().name("interrupts".to_owned()).spawn(move || signals.forever().for_each(|_| act()))?;
    Ok(())
}

#[cfg(not(unix))]
fn on_interrupt(act: fn()) -> Result<(), ctrlc::Error> {
    ctrlc::set_handler(act)
}

/// From now on the first Ctrl-C only sets [`flag`]: divisions in progress are finished and kept.
pub fn finish() {
    FINISH.store(true, Ordering::SeqCst);
}

/// From now on Ctrl-C stops the command immediately again. If it was pressed before, the command stops here.
pub fn abort() {
    FINISH.store(false, Ordering::SeqCst);
    if INTERRUPTED.load(Ordering::SeqCst) {
        exit();
    }
}

/// Defers an interruption until the given work, such as writing files, is finished.
pub fn defer<T>(work: impl FnOnce() -> T) -> T {
    let finish = FINISH.swap(true, Ordering::SeqCst);
    let done = work();
    FINISH.store(finish, Ordering::SeqCst);
    if !finish && INTERRUPTED.load(Ordering::SeqCst) {
        exit();
    }
    done
}

/// Writes a complete file; an interruption is deferred until then.
pub fn write_deferred(file: &Path, bytes: &[u8]) -> Result<(), CliError> {
    Ok(defer(|| write_atomically(file, bytes))?)
}

/// The flag that Ctrl-C sets.
pub fn flag() -> &'static AtomicBool {
    &INTERRUPTED
}

fn interrupt() {
    let again = INTERRUPTED.swap(true, Ordering::SeqCst);
    if !FINISH.load(Ordering::SeqCst) {
        exit();
    }
    if again {
        std::process::exit(130);
    }
    eprint("finishing the divisions that have begun; interrupt again to stop at once");
}

fn exit() -> ! {
    let cached = CACHES.load(Ordering::SeqCst);
    let kept = if cached { "solved divisions are kept in the cache, nothing else" } else { "nothing is kept" };
    eprint(&format!("error: interrupted; {kept}"));
    std::process::exit(1);
}
