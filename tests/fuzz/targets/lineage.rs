//! Lineage files.

use furrow_lineage::Lineage;

use super::{FILE, accepted, survives_json, text};

/// A valid lineage survives writing and reading, and every founder has its properties.
pub fn check(data: &[u8]) {
    let Some(text) = text(data) else { return };
    let Some(lineage) = accepted(Lineage::parse(text, FILE)) else { return };
    survives_json(&lineage);
    lineage.check(FILE).expect("what was allowed is allowed");
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
