//! The store: solved divisions in the file `furrow.sqlite` of the cache folder, for later runs and other processes.
//!
//! An SQLite database with one table, `division`, and one row for each division and version of the solver. Its columns
//! have the names of the parameters and of the output of `furrow divide --json`, so that `sqlite3` and every language can
//! query it. It is robust against:
//!
//! - *Several processes.* The database is in WAL mode: readers never wait, writers take turns. Two processes may solve the
//!   same division at the same time; they write the same row. A network folder is unsuitable: WAL needs shared memory.
//! - *A kill at any moment.* A committed division is in the file or its log; SQLite rolls back all others. (A
//!   power failure may lose the last seconds.)
//! - *A full disk, a read-only folder, a damaged file.* The first failure causes a warning, and the run continues without the store.
//! - *A flipped byte.* Every row has a checksum over its values. If the checksum is wrong, the division is solved and written again.
//! - *Other versions.* Rows of another solver are not used. A file with a newer schema is not modified.
//!
//! Only with the feature `store`: there are no files in a web page.

#[cfg(not(feature = "store"))]
mod absent;
#[cfg(feature = "store")]
pub mod maintenance;
#[cfg(feature = "store")]
mod row;
#[cfg(feature = "store")]
mod sqlite;
#[cfg(all(test, feature = "store"))]
mod tests;

use std::path::PathBuf;

#[cfg(not(feature = "store"))]
pub use absent::Store;
#[cfg(feature = "store")]
pub use sqlite::{FILE, Store, StoreError};

/// Warnings for the user of a store; they affect only the computing time.
#[expect(missing_docs, reason = "the messages say what the fields are")]
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum StoreWarning {
    /// Rows failed their checksum.
    #[error("{} in {} ignored and solved again", damaged_entries(*.entries), .file.display())]
    Damaged { entries: usize, file: PathBuf },
    /// The store could not be read or written.
    #[error("cannot {access} {} ({reason}); going on without storing", .file.display())]
    GivenUp { access: &'static str, file: PathBuf, reason: String },
}

fn damaged_entries(number: usize) -> String {
    format!("{number} damaged {}", if number == 1 { "entry" } else { "entries" })
}
