//! Messages on stderr other than errors: warnings unless `--quiet`, and more with `-v`.

use std::fmt::{Arguments, Display};
use std::io::IsTerminal;
use std::sync::atomic::{AtomicU8, Ordering};

use furrow_input::printable_lines;

use super::context::Globals;
use super::output;

/// Prints a warning.
macro_rules! warning {
    ($($message:tt)*) => {
        $crate::cli::messages::write($crate::cli::messages::Level::Warn, format_args!($($message)*))
    };
}

/// Levels of messages, the most important first.
#[derive(Clone, Copy)]
pub enum Level {
    /// A warning.
    Warn = 1,
    /// Printed with `-v`.
    Info,
    /// Printed with `-vv`.
    Debug,
}

/// The least important level that is printed.
static PRINTED: AtomicU8 = AtomicU8::new(Level::Warn as u8);

/// Sets the level of printed messages from the options.
pub fn set_level(globals: &Globals) {
    let printed = if globals.quiet { 0 } else { (Level::Warn as u8).saturating_add(globals.verbose) };
    PRINTED.store(printed, Ordering::Relaxed);
}

/// Whether messages of a level are printed.
pub fn is_printed(level: Level) -> bool {
    level as u8 <= PRINTED.load(Ordering::Relaxed)
}

/// Prints a message if its level is enabled.
pub fn write(level: Level, message: Arguments<'_>) {
    if !is_printed(level) {
        return;
    }
    let (colour, name) = match level {
        Level::Warn => (33, " WARN"),
        Level::Info => (32, " INFO"),
        Level::Debug => (34, "DEBUG"),
    };
    // Paths and names of files may contain control characters.
    let message = message.to_string();
    let message = printable_lines(&message);
    output::write_error(&match std::io::stderr().is_terminal() {
        true => format!("\x1b[{colour}m{name}\x1b[0m {message}\n"),
        false => format!("{name} {message}\n"),
    });
}

/// Prints each message as a warning.
pub fn warn_of(warnings: impl IntoIterator<Item = impl Display>) {
    warnings.into_iter().for_each(|warning| warning!("{warning}"));
}

pub(super) use warning;
