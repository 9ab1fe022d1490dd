//! Files of targets: of `calibrate`, and of `fit`.

use furrow_analysis::fit;
use furrow_input::parse_document;
use furrow_mechanics::calibration;

use super::{FILE, built_in, says_where, text};

/// Valid targets survive writing and reading. Those of a fit begin with another word and are checked against the built-in lineage.
pub fn check(data: &[u8]) {
    let Some(text) = text(data) else { return };
    let read = parse_document::<calibration::Targets>(text, FILE, "a file of targets", "Targets");
    match read.and_then(|targets| targets.check(FILE).map(|()| targets)) {
        Ok(targets) => {
            let written = serde_json::to_string(&targets).expect("targets are written");
            let again: calibration::Targets = serde_json::from_str(&written).expect("what is written is read");
            assert_eq!(again, targets);
            again.check(FILE).expect("what was allowed is allowed");
        }
        Err(error) => says_where(&error),
    }
    let read = parse_document::<fit::Targets>(text, FILE, "a file of targets of a fit", "Fit");
    match read.and_then(|targets| targets.check(FILE, built_in()).map(|()| targets)) {
        Ok(targets) => {
            for unknown in &targets.unknowns {
                assert!(unknown.from.is_finite() && unknown.to.is_finite() && unknown.from < unknown.to);
            }
        }
        Err(error) => says_where(&error),
    }
}
