//! Tables of constants, as an ensemble is written.

use furrow_analysis::{read_constants, write_constants};

use super::{FILE, accepted, text};

/// Valid sets survive writing and reading.
pub fn check(data: &[u8]) {
    let Some(text) = text(data) else { return };
    let Some(sets) = accepted(read_constants(text, FILE)) else { return };
    assert!(sets.iter().map(|set| set.weight).sum::<f64>().is_finite());
    assert_eq!(read_constants(&write_constants(&sets), FILE).expect("what is written is read"), sets);
}
