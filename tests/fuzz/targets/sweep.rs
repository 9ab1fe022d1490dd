//! Sweep files.

use furrow_analysis::Sweep;
use furrow_cell::settings::{Overrides, Settings};

use super::{FILE, accepted, says_where, text};

/// Most points that are checked one by one.
const LOOKED_AT: usize = 16;

/// Every point of a valid sweep has a value of each axis, and a valid cell or a reason why not.
pub fn check(data: &[u8]) {
    let Some(text) = text(data).filter(|text| has_few_points(text) && !names_a_file(text)) else { return };
    let read = || Sweep::parse(text, FILE, &Settings::default(), &Overrides::default());
    let Some(sweep) = accepted(read()) else { return };
    let points = sweep.points();
    assert!(points > 0);
    for index in (0..points).step_by(points.div_ceil(LOOKED_AT)) {
        assert_eq!(sweep.axes.values(index).len(), sweep.axes.0.len());
        let point = sweep.point(index);
        assert_eq!(point.index, index);
        match point.invalid {
            Some(why) => says_where(&why),
            None => {
                let cell = &point.input.cell;
                cell.cue.check().expect("the cue of a point that is not refused");
                assert!(cell.r0.is_finite() && cell.r0 > 0.0, "R0 = {}", cell.r0);
                assert!(cell.epsilon > 0.0 && cell.epsilon < 1.0, "ε = {}", cell.epsilon);
            }
        }
    }
    assert_eq!(read().expect("what was read is read"), sweep);
}

/// Ten million points are allowed but take seconds, and find nothing more here.
fn has_few_points(text: &str) -> bool {
    let long = |rest: &str| {
        let number = rest.trim_start_matches([':', ' ', '\t', '\n', '\r']);
        number.chars().take_while(|c| c.is_alphanumeric() || *c == '_').count() > 4 || number.starts_with('/')
    };
    !text.split("count").skip(1).any(long)
}

/// Lineage files have their own target.
fn names_a_file(text: &str) -> bool {
    text.contains("lineage")
}
