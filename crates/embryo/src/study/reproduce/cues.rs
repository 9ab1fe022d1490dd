//! Figure 4: the polarity cue.

use serde_json::json;

use super::lab::{Finding, Found, Lab, LabError, Shown};
use super::paper::Statement;
use super::series::{Reading, between, chi_at, edge, level, readings};

/// The sweeps that ship.
const POSITION: &str = include_str!("../../../../../studies/cue-position.ron");
const SIZE: &str = include_str!("../../../../../studies/cue-size.ron");
const CONFINEMENT: &str = include_str!("../../../../../studies/cue-confinement.ron");

/// χ in words.
fn chi(value: Option<f64>) -> String {
    value.map_or("-".to_owned(), |chi| format!("{chi:.3}"))
}

/// Middle and half-width of a range, in words, and the half-width relative to the middle.
fn flatness(readings: &[Reading]) -> (String, f64) {
    match level(readings) {
        Some([middle, half]) => (
            format!("χ = {:.3} to {:.3}, ±{:.0} %", middle - half, middle + half, 100.0 * half / middle),
            half / middle,
        ),
        None => ("not all divide".to_owned(), f64::INFINITY),
    }
}

/// Whether χ or the furrow over the place of a cue is as it should be, and what it is.
type Judge = fn(&[Reading]) -> (bool, String);

/// Figures 4B and 4C: narrow and broad, weak and strong cues over their place.
pub fn places(lab: &Lab<'_>, statements: &[Statement]) -> Result<Found, LabError> {
    let mut found = Found::default();
    let (sweep, rows) = lab.sweep(POSITION, "cue-position.ron", &mut found)?;
    let of = |scheme: &str, omega: f64, amplitude: f64| {
        let held = [("scheme", json!(scheme)), ("cue.omega", json!(omega)), ("cue.amplitude", json!(amplitude))];
        let mut all = readings(&sweep, &rows, "cue.u0", &held);
        all.sort_by(|a, b| a.x.total_cmp(&b.x));
        all
    };
    let both = |omega: f64, amplitude: f64| ["converged", "published"].map(|scheme| of(scheme, omega, amplitude));
    for statement in statements {
        let id = statement.id.as_str();
        let (omega, amplitude, judge): (f64, f64, Judge) = match id {
            "cue_narrow" => (0.0577, 0.1, narrow),
            "cue_broad" => (0.3, 0.1, broad),
            "cue_weak" => (0.0577, 0.005, weak),
            "cue_strong" => (0.0577, 2.0, strong),
            _ => continue,
        };
        let [(holds, converged), (coarse_holds, published)] = both(omega, amplitude).map(|readings| judge(&readings));
        let finding = Finding::words(id, holds, converged).beside_judged(coarse_holds, published);
        found.say(match id {
            "cue_weak" => finding.noting("converged, the zygote divides unequally without any cue"),
            _ => finding,
        });
    }
    // Whoever asks for 4C alone gets 4B-C as well.
    if statements.iter().any(|statement| statement.figure == "4B-C") {
        let (converged, published) = rows.into_iter().partition(|row| row.cells.first() == Some(&json!("converged")));
        found.show("4B-C", Shown::Sweep(Box::new(sweep.clone()), converged));
        found.show("4B-C-published_scheme", Shown::Sweep(Box::new(sweep), published));
    }
    Ok(found)
}

fn narrow(readings: &[Reading]) -> (bool, String) {
    let ratios: Option<Vec<f64>> =
        between(readings, [0.46, 0.49]).iter().map(|reading| Some(reading.chi? / (0.5 - reading.x))).collect();
    let Some(ratios) = ratios.filter(|ratios| !ratios.is_empty()) else { return (false, "not all divide".to_owned()) };
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    let worst = ratios.iter().map(|ratio| (ratio / mean - 1.0).abs()).fold(0.0, f64::max);
    (worst <= 0.1, format!("χ/(½ − u0) = {mean:.2} within {:.0} %", 100.0 * worst))
}

fn broad(readings: &[Reading]) -> (bool, String) {
    let (text, flat) = flatness(&between(readings, [0.35, 0.45]));
    (flat <= 0.15, text)
}

/// At how many places the furrow is where it should be, by its distance from the middle and the cue's.
fn furrows(readings: &[Reading], as_it_should: fn(f64, f64) -> bool) -> (bool, String) {
    let count = readings
        .iter()
        .filter(|reading| reading.u_furrow.is_some_and(|u| as_it_should((u - 0.5).abs(), 0.5 - reading.x)))
        .count();
    let example = readings.get(readings.len() / 2).and_then(|reading| Some((reading.x, reading.u_furrow?)));
    let example = example.map_or(String::new(), |(u0, u)| format!("; u = {u:.3} for u0 = {u0:.2}"));
    (count == readings.len() && count > 0, format!("at {count} of {} places{example}", readings.len()))
}

fn weak(readings: &[Reading]) -> (bool, String) {
    furrows(&between(readings, [0.35, 0.48]), |furrow, cue| furrow < cue)
}

fn strong(readings: &[Reading]) -> (bool, String) {
    furrows(&between(readings, [0.44, 0.48]), |furrow, cue| furrow > cue)
}

/// Figure 4D: χ over R0 with the cue.
pub fn sizes(lab: &Lab<'_>, _: &[Statement]) -> Result<Found, LabError> {
    let mut found = Found::default();
    let (sweep, rows) = lab.sweep(SIZE, "cue-size.ron", &mut found)?;
    let [converged, published] =
        ["converged", "published"].map(|scheme| readings(&sweep, &rows, "r0", &[("scheme", json!(scheme))]));
    let rest = |edge: Option<[f64; 2]>| match edge {
        Some([last, first]) => format!("at rest up to R0 = {last:.2}, all divide from {first:.2} on"),
        None => "no single edge".to_owned(),
    };
    let ends = edge(&converged);
    let within = |ends: Option<[f64; 2]>| ends.is_some_and(|[last, first]| last >= 1.8 - 1e-9 && first <= 2.0 + 1e-9);
    let coarse_ends = edge(&published);
    let finding = Finding::words("cued_rest", within(ends), rest(ends));
    found.say(finding.beside_judged(within(coarse_ends), rest(coarse_ends)));
    let [steep, coarse] = [&converged, &published].map(|readings| [2.0, 2.6].map(|r0| chi_at(readings, r0)));
    let text = |[small, large]: [Option<f64>; 2]| format!("χ = {} at R0 = 2.0, {} at 2.6", chi(small), chi(large));
    let falls = |chi: [Option<f64>; 2]| matches!(chi, [Some(small), Some(large)] if small >= 3.0 * large);
    found.say(Finding::words("cued_steep", falls(steep), text(steep)).beside_judged(falls(coarse), text(coarse)));
    let [(plateau, flat), (coarse, coarse_flat)] =
        [&converged, &published].map(|readings| flatness(&between(readings, [3.0, 5.4])));
    found.say(Finding::words("cued_plateau", flat <= 0.15, plateau).beside_judged(coarse_flat <= 0.15, coarse));
    found.show("4D", Shown::Sweep(Box::new(sweep), rows));
    Ok(found)
}

/// Figure 4E: χ over ε with the cue.
pub fn confinement(lab: &Lab<'_>, _: &[Statement]) -> Result<Found, LabError> {
    let mut found = Found::default();
    let (sweep, rows) = lab.sweep(CONFINEMENT, "cue-confinement.ron", &mut found)?;
    let [converged, published] = ["converged", "published"].map(|scheme| {
        let all = readings(&sweep, &rows, "epsilon", &[("scheme", json!(scheme))]);
        between(&all, [0.60, 0.91])
    });
    let rises = |all: &[Reading]| all.windows(2).all(|pair| pair[0].chi.zip(pair[1].chi).is_some_and(|(a, b)| b > a));
    let text = |readings: &[Reading]| {
        let chis = readings.iter().filter_map(|reading| Some((reading.x, reading.chi?)));
        let least = chis.min_by(|a, b| a.1.total_cmp(&b.1));
        let [first, last] = [readings.first(), readings.last()].map(|reading| chi(reading.and_then(|r| r.chi)));
        match least {
            Some((x, least)) => format!("χ = {first} at ε = 0.60, least {least:.3} at {x:.2}, {last} at 0.91"),
            None => "none divides".to_owned(),
        }
    };
    found.say(
        Finding::words("cued_confinement", rises(&converged), text(&converged))
            .beside_judged(rises(&published), text(&published)),
    );
    found.show("4E", Shown::Sweep(Box::new(sweep), rows));
    Ok(found)
}
