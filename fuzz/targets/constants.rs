//! Tables of constants, as an ensemble is written.

use furrow_analysis::{read_constants, write_constants};

use super::{FILE, says_where, text};

/// Valid sets survive writing and reading.
pub fn check(data: &[u8]) {
    let Some(text) = text(data) else { return };
    match read_constants(text, FILE) {
        Ok(sets) => {
            assert!(sets.iter().map(|set| set.weight).sum::<f64>().is_finite());
            assert_eq!(read_constants(&write_constants(&sets), FILE).expect("what is written is read"), sets);
        }
        Err(error) => says_where(&error),
    }
}
