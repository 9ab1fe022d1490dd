//! Which furrow wrote a file.

use serde::{Deserialize, Serialize};

/// Version and commit of the program; nothing about the machine or the time, so equal runs write equal files.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Provenance {
    /// Crate version.
    pub furrow: String,
    /// Git commit of a release built from a checkout, with `-modified` if sources were changed; otherwise `None`.
    pub git_commit: Option<String>,
}

impl Provenance {
    /// This program.
    pub fn current() -> Provenance {
        Provenance {
            furrow: env!("CARGO_PKG_VERSION").to_owned(),
            git_commit: option_env!("FURROW_COMMIT").map(str::to_owned),
        }
    }
}
