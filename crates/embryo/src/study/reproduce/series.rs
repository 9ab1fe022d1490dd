//! Rows of a sweep as they are judged: χ along one axis, the other axes held.

use serde_json::Value;

use crate::study::{Row, Sweep};

/// Below this mean χ, divisions are into equal halves.
pub const EQUAL: f64 = 0.005;

/// What the divisions at one point say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Where along the axis.
    pub x: f64,
    /// χ, or its mean over those that divided.
    pub chi: Option<f64>,
    /// The furrow's place, of a single division.
    pub u_furrow: Option<f64>,
    /// How many came to rest.
    pub failed: u64,
    /// How many ended at all.
    pub ended: u64,
}

/// The points along the axis `x` at which other axes have these values, in the order of the axis.
pub fn readings(sweep: &Sweep, rows: &[Row], x: &str, held: &[(&str, Value)]) -> Vec<Reading> {
    let columns = sweep.columns();
    let cell = |row: &Row, name: &str| {
        let at = columns.iter().position(|column| column == name)?;
        row.cells.get(at).filter(|cell| !cell.is_null()).cloned()
    };
    let here = |row: &&Row| held.iter().all(|(name, value)| cell(row, name).as_ref() == Some(value));
    let reading = |row: &Row| {
        let number = |name: &str| cell(row, name).and_then(|value| value.as_f64());
        let count = |name: &str| cell(row, name).and_then(|value| value.as_u64());
        let single = cell(row, "outcome").and_then(|outcome| outcome.as_str().map(str::to_owned));
        let (failed, ended) = match single.as_deref() {
            Some("undecided") => (0, 0),
            Some(outcome) => (u64::from(outcome == "failed"), 1),
            None => {
                let of = ["symmetric", "asymmetric", "failed"].map(|name| count(name).unwrap_or(0));
                (of[2], of.iter().sum())
            }
        };
        Some(Reading {
            x: number(x)?,
            chi: number("chi").or(number("chi_mean")),
            u_furrow: number("u_furrow"),
            failed,
            ended,
        })
    };
    rows.iter().filter(here).filter_map(reading).collect()
}

/// Those from one place of the axis to another.
pub fn between(readings: &[Reading], [from, to]: [f64; 2]) -> Vec<Reading> {
    // Places are sums of steps.
    readings.iter().copied().filter(|reading| (from - 1e-9..=to + 1e-9).contains(&reading.x)).collect()
}

/// χ at one place.
pub fn chi_at(readings: &[Reading], x: f64) -> Option<f64> {
    between(readings, [x, x]).first()?.chi
}

/// The last place up to which every division fails and the first from which none does, if there are such places and nothing
/// between.
pub fn edge(readings: &[Reading]) -> Option<[f64; 2]> {
    let resting = readings.iter().take_while(|reading| reading.ended > 0 && reading.failed == reading.ended).count();
    let divides = readings.get(resting..)?.iter().all(|reading| reading.ended > 0 && reading.failed == 0);
    divides.then_some([readings.get(resting.checked_sub(1)?)?.x, readings.get(resting)?.x])
}

/// Middle and half-width of the range of χ, and that all divided.
pub fn level(readings: &[Reading]) -> Option<[f64; 2]> {
    let all: Option<Vec<f64>> = readings.iter().map(|reading| reading.chi).collect();
    let all = all.filter(|all| !all.is_empty())?;
    let (low, high) = all.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), chi| (low.min(*chi), high.max(*chi)));
    Some([0.5 * (low + high), 0.5 * (high - low)])
}

/// Whether every division is into equal halves.
pub fn all_equal(readings: &[Reading]) -> bool {
    !readings.is_empty() && readings.iter().all(|reading| reading.failed == 0 && reading.chi.is_some_and(|c| c < EQUAL))
}

/// Where divisions are unequal, in words.
pub fn unequal_stretches(readings: &[Reading]) -> String {
    let unequal = |reading: &Reading| reading.chi.is_none_or(|chi| chi >= EQUAL);
    let mut stretches = Vec::new();
    for stretch in readings.chunk_by(|a, b| unequal(a) == unequal(b)) {
        let (Some(first), Some(last)) = (stretch.first().filter(|first| unequal(first)), stretch.last()) else {
            continue;
        };
        let chis = || stretch.iter().filter_map(|reading| reading.chi);
        let (low, high) = chis().fold((f64::INFINITY, 0.0_f64), |(low, high), chi| (low.min(chi), high.max(chi)));
        stretches.push(match stretch.len() {
            1 => format!("χ = {high:.2} at {:.2}", first.x),
            _ => format!("χ = {low:.2} to {high:.2} from {:.2} to {:.2}", first.x, last.x),
        });
    }
    if stretches.is_empty() {
        "equal halves everywhere".to_owned()
    } else {
        format!("{}; else equal halves", stretches.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64, chi: Option<f64>) -> Reading {
        Reading { x, chi, u_furrow: None, failed: u64::from(chi.is_none()), ended: 1 }
    }

    #[test]
    fn an_edge_has_rest_below_and_divisions_above() {
        let rows = [at(1.6, None), at(1.7, None), at(1.8, Some(0.9)), at(1.9, Some(0.8))];
        assert_eq!(edge(&rows), Some([1.7, 1.8]));
        assert_eq!(edge(&rows[2..]), None);
        assert_eq!(edge(&rows[..2]), None);
        assert_eq!(edge(&[rows[0], rows[2], rows[1], rows[3]]), None);
    }

    #[test]
    fn stretches_are_told_in_words() {
        let rows =
            [at(1.0, Some(0.5)), at(2.0, Some(0.001)), at(3.0, Some(0.002)), at(4.0, Some(0.2)), at(5.0, Some(0.3))];
        assert_eq!(unequal_stretches(&rows), "χ = 0.50 at 1.00, χ = 0.20 to 0.30 from 4.00 to 5.00; else equal halves");
        assert_eq!(unequal_stretches(&rows[1..3]), "equal halves everywhere");
        assert!(all_equal(&rows[1..3]) && !all_equal(&rows) && !all_equal(&[]));
        assert_eq!(level(&rows[3..]).map(|[middle, _]| middle), Some(0.25));
        assert_eq!(level(&[rows[0], at(2.0, None)]), None);
    }
}
