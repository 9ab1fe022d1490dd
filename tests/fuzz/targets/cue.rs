//! Cues as options have them, and keys and values of `--set`.

use furrow_cell::settings::Settings;
use furrow_lineage::parse_cue;

use super::{built_in, survives_json, text};

/// A valid cue survives writing and reading, as text and as JSON; mirrored twice it is itself; its fields are finite everywhere.
pub fn check(data: &[u8]) {
    let Some(text) = text(data) else { return };
    check_setting(text);
    let lineage = built_in();
    let cue = match parse_cue(text, lineage) {
        Ok(cue) => cue,
        Err(error) => {
            let said = error.to_string();
            assert!(said.starts_with("--cue: "), "{said}");
            assert!(said.len() < 4000, "an error of {} bytes", said.len());
            return;
        }
    };
    cue.check().expect("what is read is allowed");
    let written = cue.to_string();
    assert_eq!(parse_cue(&written, lineage).expect("what is written is read"), cue, "{written}");
    survives_json(&cue);
    assert_eq!(cue.mirrored().mirrored().terms().len(), cue.terms().len());
    if let Some(regulator) = cue.regulator() {
        assert_eq!(cue.mirrored().regulator().map(|image| &image.couplings), Some(&regulator.couplings));
        for quantity in regulator.quantities() {
            assert!(regulator.quantity(quantity).is_some_and(f64::is_finite), "{regulator}");
        }
    }
    for place in 0..=16 {
        let u = f64::from(place) / 16.0;
        for term in cue.terms() {
            assert!(term.at(u, 8.0).iter().all(|value| value.is_finite()), "{term} at u = {u}");
        }
    }
}

/// A setting is accepted, or the error names --set.
fn check_setting(text: &str) {
    let mut settings = Settings::default();
    match settings.apply_overrides(&[text.to_owned()]) {
        Ok(()) => settings.check("--set").expect("what was allowed is allowed"),
        Err(error) => assert!(error.to_string().starts_with("--set: "), "{error}"),
    }
}
