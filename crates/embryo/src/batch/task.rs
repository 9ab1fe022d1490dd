//! What this floor needs to know of the things it computes: of a task, and of the record that comes of it.

use std::{error::Error, fmt::Debug};

use super::{key::CanonicalBytes, store::PAYLOAD};

/// Something to compute, given by all that its record depends on: equal tasks have bit-identical records.
///
/// Every task has a size. Sizes are rounded before a task is looked up or solved, so that sizes that differ by rounding
/// errors share one record.
pub trait Task: Clone + Debug + Send + Sync + 'static {
    /// What comes of it.
    type Record: Record;
    /// Why nothing comes of it.
    type Error: Error + Clone + Send + Sync + 'static;

    /// Writes everything the record depends on, the size included, always in the same order.
    fn write_canonical(&self, bytes: &mut CanonicalBytes);

    /// The size: finite and above 0 in every task that can be solved.
    fn size(&self) -> f64;

    /// The same task at another size.
    #[must_use]
    fn with_size(&self, size: f64) -> Self;
}

/// The result of a task.
pub trait Record: Clone + Debug + Send + Sync + 'static {
    /// Folder of these records inside a cache folder; no two kinds of record have the same.
    const FOLDER: &'static str;

    /// The record as bytes of a slot in a store.
    fn encode(&self) -> [u8; PAYLOAD];

    /// What [`Record::encode`] wrote, bit for bit; `None` if it cannot have written this.
    fn decode(payload: &[u8; PAYLOAD]) -> Option<Self>;

    /// The record as it is handed to a task of `factor` times the size that was solved: what is handed on in proportion
    /// to the size is multiplied, so that nothing of it is lost to rounding the size.
    #[must_use]
    fn scaled(&self, factor: f64) -> Self;

    /// The number in which the effect of rounding sizes is reported, if this record has it.
    fn response(&self) -> Option<f64>;
}
