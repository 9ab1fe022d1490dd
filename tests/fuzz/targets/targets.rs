//! Files of targets: of `calibrate`, and of `fit`.

use furrow_analysis::fit;
use furrow_input::parse_document;
use furrow_mechanics::calibration;

use super::{FILE, accepted, built_in, survives_json, text};

/// Valid targets survive writing and reading. Targets of a fit begin with another word and are checked against the built-in lineage.
pub fn check(data: &[u8]) {
    let Some(text) = text(data) else { return };
    let read = parse_document::<calibration::Targets>(text, FILE, "a file of targets", "Targets");
    if let Some(targets) = accepted(read.and_then(|targets| targets.check(FILE).map(|()| targets))) {
        survives_json(&targets);
    }
    let read = parse_document::<fit::Targets>(text, FILE, "a file of targets of a fit", "Fit");
    if let Some(targets) = accepted(read.and_then(|targets| targets.check(FILE, built_in()).map(|()| targets))) {
        for unknown in &targets.unknowns {
            assert!(unknown.from.is_finite() && unknown.to.is_finite() && unknown.from < unknown.to);
        }
    }
}
