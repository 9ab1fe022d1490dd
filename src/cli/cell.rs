//! Options that name one cell.

use super::context::Context;
use crate::cortex::Cue;
use crate::input::InputError;
use crate::io::parse_cue;
use crate::lineage::Lineage;
use clap::Args;
use std::path::{Path, PathBuf};

/// One cell at one activity.
#[derive(Debug, Args)]
pub struct CellArgs {
    /// Radius R0 of the sphere with the cell's volume, in L_h
    #[arg(long, value_name = "R", allow_negative_numbers = true)]
    pub r0: f64,
    /// Volume of the cell over that of its shell, ε
    #[arg(long, value_name = "E", allow_negative_numbers = true)]
    pub epsilon: Option<f64>,
    /// Activity ξ_s, as published
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    pub xi: Option<f64>,
    /// Polarity cue: none, a name in the lineage file, or kappa:u0=..,omega=..,amplitude=..
    #[arg(long, value_name = "CUE", default_value = "none")]
    pub cue: String,
    /// Lineage file whose cues have names here; default the built-in one
    #[arg(long, value_name = "LINEAGE.ron")]
    pub lineage: Option<PathBuf>,
}

/// A cell read from options; ε and ξ_s are in the settings.
#[derive(Clone, Copy, Debug)]
pub struct Cell {
    /// Radius R0.
    pub r0: f64,
    /// Cue.
    pub cue: Cue,
}

impl CellArgs {
    /// Checks the cell and puts its ε and ξ_s into the settings.
    ///
    /// # Errors
    /// Names the option, its value and what is allowed.
    pub fn read(&self, context: &mut Context) -> Result<Cell, InputError> {
        if !(self.r0.is_finite() && self.r0 > 0.0) {
            return Err(InputError::not_allowed("--r0", "r0", self.r0, "a finite number above 0"));
        }
        if let Some(epsilon) = self.epsilon {
            context.settings.set_number("--epsilon", "epsilon", epsilon)?;
        }
        if let Some(xi) = self.xi {
            context.settings.set_number("--xi", "xi_s", xi)?;
        }
        Ok(Cell { r0: self.r0, cue: read_cue(&self.cue, self.lineage.as_deref())? })
    }
}

/// One cell at any activity, without a cue.
#[derive(Debug, Args)]
pub struct SizeArgs {
    /// Radius R0 of the sphere with the cell's volume, in L_h
    #[arg(long, value_name = "R", allow_negative_numbers = true)]
    r0: f64,
    /// Volume of the cell over that of its shell, ε
    #[arg(long, value_name = "E", allow_negative_numbers = true)]
    epsilon: Option<f64>,
}

impl SizeArgs {
    /// Checks the cell, puts its ε into the settings and gives its R0.
    ///
    /// # Errors
    /// Names the option, its value and what is allowed.
    pub fn read(&self, context: &mut Context) -> Result<f64, InputError> {
        if let Some(epsilon) = self.epsilon {
            context.settings.set_number("--epsilon", "epsilon", epsilon)?;
        }
        positive("--r0", "r0", self.r0)
    }
}

/// A cue from its option, by the names of a lineage file or else of the built-in lineage.
///
/// # Errors
/// Names the option, its value and what is allowed; or the file and what is wrong with it.
pub fn read_cue(cue: &str, lineage: Option<&Path>) -> Result<Cue, InputError> {
    parse_cue(cue, &Lineage::load(lineage)?)
}

/// A finite number above 0 from an option.
///
/// # Errors
/// Names the option, its value and what is allowed.
pub fn positive(option: &str, field: &str, value: f64) -> Result<f64, InputError> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(InputError::not_allowed(option, field, value, "a finite number above 0"))
    }
}
