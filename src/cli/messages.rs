//! Messages on stderr besides errors: warnings unless `--quiet`, and more with `-v`.

use std::fmt::Arguments;
use std::io::IsTerminal;
use std::sync::atomic::{AtomicU8, Ordering};

use super::context::Globals;
use super::output;

/// What a message is, the most important first.
#[derive(Clone, Copy)]
pub enum Level {
    /// Something that the user should know of.
    Warn = 1,
    /// What `-v` prints.
    Info,
    /// What `-vv` prints.
    Debug,
}

/// The least important level that is printed.
static PRINTED: AtomicU8 = AtomicU8::new(Level::Warn as u8);

/// Sets from the options what is printed.
pub fn set_level(globals: &Globals) {
    let printed = if globals.quiet { 0 } else { (Level::Warn as u8).saturating_add(globals.verbose) };
    PRINTED.store(printed, Ordering::Relaxed);
}

/// Prints a message, if its level is.
pub fn write(level: Level, message: Arguments<'_>) {
    if level as u8 > PRINTED.load(Ordering::Relaxed) {
        return;
    }
    let (colour, name) = match level {
        Level::Warn => (33, " WARN"),
        Level::Info => (32, " INFO"),
        Level::Debug => (34, "DEBUG"),
    };
    output::write_error(&match std::io::stderr().is_terminal() {
        true => format!("\x1b[{colour}m{name}\x1b[0m {message}\n"),
        false => format!("{name} {message}\n"),
    });
}

/// Prints a warning.
macro_rules! warning {
    ($($message:tt)*) => {
        $crate::cli::messages::write($crate::cli::messages::Level::Warn, format_args!($($message)*))
    };
}

pub(super) use warning;
