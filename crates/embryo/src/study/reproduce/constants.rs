//! Table S3: the constants in force beside those printed.

use super::lab::{Finding, Found, Lab, LabError};
use super::paper::Statement;
use crate::cell::Parameter;
use crate::cell::cue::Quantity;
use crate::lineage::Lineage;

/// Every constant that the table is known to print, and the shell, which it does not.
pub fn table(lab: &Lab<'_>, statements: &[Statement]) -> Result<Found, LabError> {
    let mut found = Found::default();
    let cell = &lab.settings.cell;
    let cue = Lineage::c_elegans()?.cue("germline");
    let term = cue.as_ref().and_then(|cue| cue.terms().first());
    for statement in statements {
        let id = statement.id.as_str();
        let value = match statement.constant.as_deref() {
            None => continue,
            Some("xi_b") => Some(cell.xi_s * cell.material.xi_ratio),
            Some("cue.amplitude") => term.map(|term| term.amplitude),
            Some("cue.omega") => term.and_then(|term| term.profile.quantity(Quantity::Omega)),
            Some("cue.u0") => term.and_then(|term| term.profile.quantity(Quantity::U0)),
            Some(name) => name.parse::<Parameter>().ok().map(|parameter| parameter.get(cell)),
        };
        found.say(match value {
            Some(value) => Finding::number(id, value),
            None => Finding::not_computed(id, "there is no such constant"),
        });
    }
    let (shell, gain) = (cell.shell, cell.material.gain);
    let text = format!("a/b = {}, p0 = {}, w = {}; g = {gain}", shell.aspect, shell.p0, shell.w);
    found.say(Finding::open("table_shell", text));
    Ok(found)
}
