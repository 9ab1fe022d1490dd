//! Measured divisions for the figures that show some.

use furrow_input::{InputError, open_file};
use furrow_measured::events::{Division, divisions};
use furrow_measured::volumes::{ReadOptions, Volumes};
use std::path::Path;

/// The divisions in a table of volumes, with the table's name.
///
/// # Errors
/// The table cannot be read, or has no division.
pub fn measured_divisions(file: &Path) -> Result<(String, Vec<Division>), InputError> {
    let name = file.display().to_string();
    let mut volumes = Volumes::default();
    volumes.read(open_file(file)?, &name, &ReadOptions::default())?;
    let divisions = divisions(&volumes).divisions;
    match divisions.is_empty() {
        true => Err(InputError::not_allowed(&name, "cells", "no division", "both daughters of one cell at least")),
        false => Ok((name, divisions)),
    }
}
