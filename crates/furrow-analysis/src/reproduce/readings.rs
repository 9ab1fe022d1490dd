//! χ of a sweep along one axis, with the other axes held, and readings of the curve.

use ordered_float::OrderedFloat;
use serde_json::Value;

use crate::{Row, Sweep};

/// Below this mean χ, divisions are into equal halves.
const EQUAL: f64 = 0.005;

/// The divisions at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChiPoint {
    /// Where along the axis.
    pub x: f64,
    /// χ, or its mean over those that divided.
    pub chi: Option<f64>,
    /// The furrow's place, of a single division.
    pub u_furrow: Option<f64>,
    /// Divisions that failed.
    pub failed: u64,
    /// Divisions with an outcome.
    pub ended: u64,
}

/// The points along the axis `x` at which other axes have these values, from the smallest x on.
pub fn readings(sweep: &Sweep, rows: &[Row], x: &str, held: &[(&str, Value)]) -> Vec<ChiPoint> {
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
        Some(ChiPoint {
            x: number(x)?,
            chi: number("chi").or(number("chi_mean")),
            u_furrow: number("u_furrow"),
            failed,
            ended,
        })
    };
    let mut found: Vec<ChiPoint> = rows.iter().filter(here).filter_map(reading).collect();
    found.sort_by_cached_key(|item| OrderedFloat(item.x));
    found
}

/// The points from one place of the axis to another.
pub fn between(readings: &[ChiPoint], [from, to]: [f64; 2]) -> Vec<ChiPoint> {
    // Places are sums of steps.
    readings.iter().copied().filter(|reading| (from - 1e-9..=to + 1e-9).contains(&reading.x)).collect()
}

/// χ at one place.
pub fn chi_at(readings: &[ChiPoint], x: f64) -> Option<f64> {
    between(readings, [x, x]).first()?.chi
}

/// The last place up to which every division fails, and the next, from which all succeed; `None` if there are no such places.
pub fn edge(readings: &[ChiPoint]) -> Option<[f64; 2]> {
    let resting = readings.iter().take_while(|reading| reading.ended > 0 && reading.failed == reading.ended).count();
    let divides = readings.get(resting..)?.iter().all(|reading| reading.ended > 0 && reading.failed == 0);
    divides.then_some([readings.get(resting.checked_sub(1)?)?.x, readings.get(resting)?.x])
}

/// χ in words.
pub fn chi_in_words(chi: Option<f64>) -> String {
    chi.map_or("-".to_owned(), |chi| format!("{chi:.3}"))
}

/// χ of all readings; `None` if one of them does not divide.
fn all_chi(readings: &[ChiPoint]) -> Option<Vec<f64>> {
    readings.iter().map(|reading| reading.chi).collect()
}

fn extremes(chis: impl Iterator<Item = f64>) -> (f64, f64) {
    chis.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), chi| (low.min(chi), high.max(chi)))
}

/// The first and the last χ, and whether all neighbours are in order; `None` if not all divide.
pub fn monotone_ends(readings: &[ChiPoint], in_order: fn(f64, f64) -> bool) -> Option<([f64; 2], bool)> {
    match all_chi(readings)?[..] {
        ref chi @ [first, .., last] => Some(([first, last], chi.windows(2).all(|pair| in_order(pair[0], pair[1])))),
        _ => None,
    }
}

/// Half-width of the range of χ relative to its middle, and the range in words; infinite if not all divide.
pub fn flatness(readings: &[ChiPoint]) -> (f64, String) {
    let Some(all) = all_chi(readings).filter(|all| !all.is_empty()) else {
        return (f64::INFINITY, "not all divide".to_owned());
    };
    let (low, high) = extremes(all.into_iter());
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let text = format!("χ = {:.3} to {:.3}, ±{:.0} %", middle - half, middle + half, 100.0 * half / middle);
    (half / middle, text)
}

/// Whether every division is into equal halves, and in words where they are not.
pub fn halves(readings: &[ChiPoint]) -> (bool, String) {
    let unequal = |reading: &ChiPoint| reading.chi.is_none_or(|chi| chi >= EQUAL);
    let all_equal = !readings.is_empty() && readings.iter().all(|reading| reading.failed == 0 && !unequal(reading));
    let mut stretches = Vec::new();
    for stretch in readings.chunk_by(|a, b| unequal(a) == unequal(b)).filter(|stretch| unequal(&stretch[0])) {
        let (first, last) = (stretch[0].x, stretch[stretch.len() - 1].x);
        let (low, high) = extremes(stretch.iter().filter_map(|reading| reading.chi));
        stretches.push(match stretch.len() {
            1 => format!("χ = {high:.2} at {first:.2}"),
            _ => format!("χ = {low:.2} to {high:.2} from {first:.2} to {last:.2}"),
        });
    }
    let text = match stretches.is_empty() {
        true => "equal halves everywhere".to_owned(),
        false => format!("{}; else equal halves", stretches.join(", ")),
    };
    (all_equal, text)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64, chi: Option<f64>) -> ChiPoint {
        ChiPoint { x, chi, u_furrow: None, failed: u64::from(chi.is_none()), ended: 1 }
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
    fn stretches_are_described_in_words() {
        let rows =
            [at(1.0, Some(0.5)), at(2.0, Some(0.001)), at(3.0, Some(0.002)), at(4.0, Some(0.2)), at(5.0, Some(0.3))];
        let text = "χ = 0.50 at 1.00, χ = 0.20 to 0.30 from 4.00 to 5.00; else equal halves";
        assert_eq!(halves(&rows), (false, text.to_owned()));
        assert_eq!(halves(&rows[1..3]), (true, "equal halves everywhere".to_owned()));
        assert!(!halves(&[]).0);
        assert_eq!(flatness(&rows[3..]).1, "χ = 0.200 to 0.300, ±20 %");
        assert_eq!(flatness(&[rows[0], at(2.0, None)]).0, f64::INFINITY);
    }
}
