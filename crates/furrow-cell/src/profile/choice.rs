//! The shell selected by a setting or a file: the ellipsoid, or the profile of a table.

use std::path::Path;

use serde::de::value::MapAccessDeserializer;
use serde::{Deserialize, Deserializer, Serialize};

use super::ShellProfile;
use crate::Cell;
use furrow_input::{InputError, shown};

/// The word for a shell without a table.
pub const ELLIPSOID: &str = "ellipsoid";

/// The selected shell.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "WrittenShell", into = "WrittenShell")]
pub enum ShellChoice {
    /// The ellipsoid.
    Ellipsoid,
    /// The profile of a table.
    Profile(Box<ShellProfile>),
}

impl ShellChoice {
    /// Reads a choice: [`ELLIPSOID`], or the file of a table, relative to a folder.
    ///
    /// # Errors
    /// As [`ShellProfile::read`], and `refused` with the allowed values if the text is neither.
    pub fn named(
        text: &str,
        folder: &Path,
        refused: impl FnOnce(String) -> InputError,
    ) -> Result<ShellChoice, InputError> {
        if text == ELLIPSOID {
            return Ok(ShellChoice::Ellipsoid);
        }
        // A word without a folder or an extension was probably meant as a name.
        if !text.contains(['.', '/', '\\']) || text.parse::<f64>().is_ok() {
            return Err(refused(format!("the file of a table of r over z, or {ELLIPSOID}")));
        }
        Ok(ShellChoice::Profile(Box::new(ShellProfile::read(&folder.join(text))?)))
    }

    /// The profile; `None` for the ellipsoid.
    pub fn profile(&self) -> Option<&ShellProfile> {
        match self {
            ShellChoice::Ellipsoid => None,
            ShellChoice::Profile(profile) => Some(profile),
        }
    }

    /// Sets the shell of a cell, including the aspect ratio of a table.
    pub fn apply(&self, cell: &mut Cell) {
        if let Some(profile) = self.profile() {
            cell.shell.aspect = profile.aspect();
        }
        cell.shell_profile = self.profile().cloned().map(Box::new);
    }

    /// The choice in one line.
    pub fn described(&self) -> String {
        self.profile().map_or_else(|| ELLIPSOID.to_owned(), ShellProfile::described)
    }
}

/// A choice in a file, before its table is read.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum WrittenShell {
    /// [`ELLIPSOID`], or the file of a table.
    Named(String),
    /// The profile itself, as in `tree.json`.
    Profile(Box<ShellProfile>),
}

impl<'de> Deserialize<'de> for WrittenShell {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<WrittenShell, D::Error> {
        struct Written;
        impl<'de> serde::de::Visitor<'de> for Written {
            type Value = WrittenShell;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                write!(f, "the file of a table of r over z, as in \"egg.csv\", or {ELLIPSOID:?}")
            }

            fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<WrittenShell, E> {
                Ok(WrittenShell::Named(text.to_owned()))
            }

            fn visit_map<A: serde::de::MapAccess<'de>>(self, map: A) -> Result<WrittenShell, A::Error> {
                let profile = ShellProfile::deserialize(MapAccessDeserializer::new(map))?;
                Ok(WrittenShell::Profile(Box::new(profile)))
            }
        }
        deserializer.deserialize_any(Written)
    }
}

impl From<ShellChoice> for WrittenShell {
    fn from(choice: ShellChoice) -> WrittenShell {
        match choice {
            ShellChoice::Ellipsoid => WrittenShell::Named(ELLIPSOID.to_owned()),
            ShellChoice::Profile(profile) => WrittenShell::Profile(profile),
        }
    }
}

impl TryFrom<WrittenShell> for ShellChoice {
    type Error = String;

    fn try_from(written: WrittenShell) -> Result<ShellChoice, String> {
        match written {
            WrittenShell::Profile(profile) => Ok(ShellChoice::Profile(profile)),
            WrittenShell::Named(word) if word == ELLIPSOID => Ok(ShellChoice::Ellipsoid),
            WrittenShell::Named(word) => {
                Err(format!("shell_profile = {}: must be a profile, or {ELLIPSOID:?}", shown(&word)))
            }
        }
    }
}

impl WrittenShell {
    /// The choice, with its table read from the folder.
    ///
    /// # Errors
    /// As [`ShellChoice::named`].
    pub fn read(
        self,
        folder: &Path,
        refused: impl FnOnce(String, String) -> InputError,
    ) -> Result<ShellChoice, InputError> {
        match self {
            WrittenShell::Profile(profile) => Ok(ShellChoice::Profile(profile)),
            WrittenShell::Named(text) => ShellChoice::named(&text, folder, |allowed| refused(shown(&text), allowed)),
        }
    }
}
