//! Lineage files.

use furrow_lineage::Lineage;

use super::{FILE, says_where, text};

/// A valid lineage survives writing and reading, and every founder has its properties.
pub fn check(data: &[u8]) {
    let Some(text) = text(data) else { return };
    let lineage = match Lineage::parse(text, FILE) {
        Ok(lineage) => lineage,
        Err(error) => return says_where(&error),
    };
    let written = serde_json::to_string(&lineage).expect("a lineage is written");
    let read: Lineage = serde_json::from_str(&written).expect("what is written is read");
    assert_eq!(read, lineage, "read, written and read again");
    read.check(FILE).expect("what was allowed is allowed");
    for founder in 0..lineage.founders.len() {
        if let Some(mother) = lineage.mother(founder) {
            assert_eq!(lineage.generation(founder), lineage.generation(mother) + 1);
        }
        if let Some(r0) = lineage.given_r0(founder) {
            assert!(r0.is_finite() && r0 > 0.0, "R0 = {r0}");
        }
    }
    for (name, cue) in &lineage.cues {
        cue.check().expect("a cue of a lineage is allowed");
        assert_eq!(lineage.cue(name).as_ref(), Some(cue));
    }
}
