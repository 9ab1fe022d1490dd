//! Figures 2A, 2G and 3: χ over size, over confinement, and over the place of a cue.

use super::context::{Artifact, Figure, Finding, PUBLISHED_CONFINEMENT, PUBLISHED_STEPS, ReproduceError};
use super::films::{away, leaves_equator, place_of_furrow};
use super::paper::{Criterion, OverAxis, Study};
use super::readings::{ChiPoint, between, chi_at, chi_in_words, edge, flatness, halves, monotone_ends, readings};
use super::thresholds::cued_boundary;
use crate::Row;
use furrow_cell::cue::Quantity;
use furrow_cell::{Cue, Numerics, Parameter, ZYGOTE};
use furrow_lineage::batch::phase::spaced;
use furrow_lineage::batch::scheduler;
use furrow_mechanics::calibration::statements::FurrowPlace;
use furrow_mechanics::critical::{critical_radius, critical_value};
use furrow_mechanics::division::{DivisionInput, Outcome, Statistics, Trajectory};
use furrow_mechanics::equilibria::StepBudget;
use serde_json::{Value, json};

/// The name, the text and the axis of a shipped sweep.
fn shipped(study: Study) -> [&'static str; 3] {
    match study {
        Study::Size => ["size.ron", include_str!("../../studies/size.ron"), "r0"],
        Study::Confinement => ["confinement.ron", include_str!("../../studies/confinement.ron"), "epsilon"],
        Study::CueWidth => ["cue-width.ron", include_str!("../../studies/cue-width.ron"), "cue.u0"],
        Study::CueAmplitude => ["cue-amplitude.ron", include_str!("../../studies/cue-amplitude.ron"), "cue.u0"],
        Study::CueSize => ["cue-size.ron", include_str!("../../studies/cue-size.ron"), "r0"],
        Study::CueConfinement => ["cue-confinement.ron", include_str!("../../studies/cue-confinement.ron"), "epsilon"],
    }
}

/// Widths ω of the cue in figure 3B, as exact values of the printed 0.06, 0.14 and 0.31.
const WIDTHS: [f64; 3] = [0.0577, 0.1414, 0.3162];

/// Whether χ meets a criterion within a range, and a description of χ in words.
fn meets(criterion: Criterion, all: &[ChiPoint], range: [f64; 2]) -> (bool, String) {
    let part = &between(all, range);
    match criterion {
        Criterion::Rest => at_rest(all, range),
        Criterion::Halves => halves(part),
        Criterion::Falling => trend(part, |a, b| b < a),
        Criterion::Rising => trend(part, |a, b| b > a),
        Criterion::Flat => {
            let (half_width, text) = flatness(part);
            (half_width <= 0.15, text)
        }
        Criterion::Proportional | Criterion::Flatter => proportional(part),
        Criterion::Furrow(place) => furrows(part, place),
        Criterion::Steep => steep(part),
    }
}

/// Whether χ over an axis agrees with a statement, with a scheme and its step.
fn judged(over: &OverAxis, read: impl Fn(&[(&str, Value)]) -> Vec<ChiPoint>, scheme: &str, dt: f64) -> (bool, String) {
    let at = |width: Option<f64>| {
        let held = over.held.iter().map(|(name, value)| (name.as_str(), json!(value)));
        let held = held.chain([("scheme", json!(scheme)), ("dt", json!(dt))]);
        let held: Vec<_> = held.chain(width.map(|width| ("cue.omega", json!(width)))).collect();
        read(&held)
    };
    match over.criterion {
        Criterion::Flatter => flatter(WIDTHS.map(|width| between(&at(Some(width)), over.range))),
        criterion => meets(criterion, &at(None), over.range),
    }
}

/// Solves the sweep of the figure's statements, compares χ with them, and shows it.
pub fn over_axis(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    let Some(study) = figure.statements.iter().find_map(|statement| Some(statement.over.as_ref()?.study)) else {
        return Ok(());
    };
    let [file, text, axis] = shipped(study);
    let (sweep, rows) = figure.sweep(text, file)?;
    for statement in figure.statements {
        let Some(over) = &statement.over else { continue };
        let judged = |scheme: &str, dt: f64| judged(over, |held| readings(&sweep, &rows, axis, held), scheme, dt);
        let mut finding = Finding::judged(&statement.id, judged("converged", PUBLISHED_STEPS[0]));
        if over.both_schemes {
            finding.published = PUBLISHED_STEPS.map(|dt| judged("published", dt)).to_vec();
        }
        figure.findings.push(finding);
    }
    // A picture for each scheme and step; the converged scheme does not use the published steps.
    for (scheme, dt) in
        [("converged", PUBLISHED_STEPS[0]), ("published", PUBLISHED_STEPS[0]), ("published", PUBLISHED_STEPS[1])]
    {
        let name = match scheme {
            "converged" => figure.name().to_owned(),
            _ => format!("{}-published_{dt}", figure.name()),
        };
        let those = |row: &&Row| row.cells.starts_with(&[json!(scheme), json!(dt)]);
        figure.show(&name, Artifact::Sweep(Box::new(sweep.clone()), rows.iter().filter(those).cloned().collect()));
    }
    Ok(())
}

/// A condition on two numbers.
pub type Compares = fn(f64, f64) -> bool;

/// Whether all cells below some size in these limits rest and all above divide.
fn at_rest(readings: &[ChiPoint], [from, to]: [f64; 2]) -> (bool, String) {
    let Some([last, first]) = edge(readings) else { return (false, "no single edge".to_owned()) };
    let holds = last >= from - 1e-9 && first <= to + 1e-9;
    (holds, format!("at rest up to R0 = {last:.2}, all divide from {first:.2} on"))
}

/// Whether χ goes one way.
fn trend(readings: &[ChiPoint], in_order: Compares) -> (bool, String) {
    let Some(([first, last], ordered)) = monotone_ends(readings, in_order) else {
        return (false, "not all divide".to_owned());
    };
    let ends = [readings.first(), readings.last()].map(|reading| reading.map_or(0.0, |reading| reading.x));
    let out_of_order =
        readings.windows(2).find(|pair| pair[0].chi.zip(pair[1].chi).is_none_or(|(a, b)| !in_order(a, b)));
    let but = out_of_order.map_or(String::new(), |pair| format!("; not from {:.2} to {:.2}", pair[0].x, pair[1].x));
    (ordered, format!("χ = {first:.3} at {:.2}, {last:.3} at {:.2}{but}", ends[0], ends[1]))
}

/// Mean of χ over the distance of the cue from the middle, and the largest relative deviation from it; `None` unless all divide.
fn slope(readings: &[ChiPoint]) -> Option<[f64; 2]> {
    let ratios: Option<Vec<f64>> = readings.iter().map(|reading| Some(reading.chi? / (0.5 - reading.x))).collect();
    let ratios = ratios.filter(|ratios| !ratios.is_empty())?;
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    Some([mean, ratios.iter().map(|ratio| (ratio / mean - 1.0).abs()).fold(0.0, f64::max)])
}

/// Whether χ is proportional to the distance of the cue from the middle.
fn proportional(readings: &[ChiPoint]) -> (bool, String) {
    let Some([mean, worst]) = slope(readings) else { return (false, "not all divide".to_owned()) };
    (worst <= 0.15, format!("χ/(½ − u0) = {mean:.2} within {:.0} %", 100.0 * worst))
}

/// Whether χ rises less with the distance of the cue from the middle for each width than for the one before.
fn flatter(widths: [Vec<ChiPoint>; 3]) -> (bool, String) {
    let slopes: Option<Vec<f64>> = widths.iter().map(|readings| slope(readings).map(|[mean, _]| mean)).collect();
    let Some(slopes) = slopes else { return (false, "not all divide".to_owned()) };
    let text = slopes.iter().map(|slope| format!("{slope:.2}")).collect::<Vec<_>>().join(", ");
    (slopes.windows(2).all(|pair| pair[1] < pair[0]), format!("mean χ/(½ − u0) = {text}"))
}

/// Whether every furrow has a place beside its cue, by their distances from the middle: its side does not count.
fn furrows(readings: &[ChiPoint], place: FurrowPlace) -> (bool, String) {
    let right = |reading: &&ChiPoint| reading.u_furrow.is_some_and(|u| place.holds(0.5 - (u - 0.5).abs(), reading.x));
    let count = readings.iter().filter(right).count();
    let example = readings.get(readings.len() / 2).and_then(|reading| Some((reading.x, reading.u_furrow?)));
    let example = example.map_or(String::new(), |(u0, u)| format!("; u = {u:.3} for u0 = {u0:.2}"));
    (count == readings.len() && count > 0, format!("at {count} of {} places{example}", readings.len()))
}

/// Whether χ falls to a third from R0 = 2 to 2.6.
fn steep(readings: &[ChiPoint]) -> (bool, String) {
    let [small, large] = [2.0, 2.6].map(|r0| chi_at(readings, r0));
    let falls = small.zip(large).is_some_and(|(small, large)| small >= 3.0 * large);
    (falls, format!("χ = {} at R0 = 2.0, {} at 2.6", chi_in_words(small), chi_in_words(large)))
}

/// Amplitudes of strong cues, each twice the one before, and the largest relative change of χ that counts as saturated.
const STRONG: [f64; 4] = [1.0, 2.0, 4.0, 8.0];
const SATURATED: f64 = 0.1;

/// Figure 3C: χ over the place of the cue, and over its amplitude where that is large.
pub fn over_amplitude(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    over_axis(figure)?;
    let context = figure.context;
    let input = |amplitude: f64| {
        let mut cell = context.cell(ZYGOTE, PUBLISHED_CONFINEMENT).with_cue(Cue::published());
        Parameter::Cue { term: 0, quantity: Quantity::Amplitude }.set(&mut cell, amplitude);
        context.input(cell)
    };
    let divisions = figure.divisions(STRONG.map(input).to_vec())?;
    let chi: Vec<Option<f64>> = divisions.iter().map(|division| division.as_ref()?.chi()).collect();
    let close = |pair: &[Option<f64>]| pair[0].zip(pair[1]).is_some_and(|(a, b)| (b / a - 1.0).abs() < SATURATED);
    let each = chi.iter().zip(STRONG).map(|(chi, amplitude)| match chi {
        Some(chi) => format!("{chi:.3} at {amplitude}"),
        None => format!("no division at {amplitude}"),
    });
    let text = format!("χ over Δκ: {}", each.collect::<Vec<_>>().join(", "));
    figure.judge("cue_saturation", chi.windows(2).all(close), text);
    Ok(())
}

/// Figure 3D: χ over R0 with the cue, and where cells with it fail.
pub fn cued_sizes(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    over_axis(figure)?;
    cued_boundary(figure);
    Ok(())
}

/// Figure 2A: χ over R0 without a cue.
pub fn sizes(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    over_axis(figure)?;
    let critical = critical_radius(&figure.context.cell(1.0, 0.87), &figure.context.converged());
    if let Some(rest) = figure.findings.iter_mut().find(|finding| finding.id == "size_rest") {
        rest.note = Some(match critical {
            Ok(critical) => format!("the pitchfork is at ξ_s = 25 for R0_c = {:.4}", critical.r0),
            Err(error) => error.to_string(),
        });
    }
    let continuous = continuous(figure)?;
    figure.findings.push(continuous);
    let slips = slips(figure)?;
    figure.findings.push(slips);
    Ok(())
}

/// Sizes about the one at which equal divisions begin, and seeds at each.
const EDGE: [f64; 2] = [2.2, 2.3];
const SEEDS: u64 = 10;
/// Largest change of mean χ between neighbouring sizes that counts as continuous.
const CONTINUOUS: f64 = 0.2;

/// How mean χ over seeds changes about the size at which equal divisions begin.
fn continuous(figure: &mut Figure<'_>) -> Result<Finding, ReproduceError> {
    let context = figure.context;
    let sizes = spaced(EDGE[0], EDGE[1], 11);
    let mut judged = |numerics: Numerics| -> Result<(bool, String), ReproduceError> {
        let input = |r0: f64, seed: u64| DivisionInput { cell: context.cell(r0, 0.87), numerics, seed };
        let inputs = sizes.iter().flat_map(|r0| (0..SEEDS).map(move |seed| input(*r0, seed))).collect();
        let divisions = figure.divisions(inputs)?;
        let at_size = |of_size: &[Option<_>]| Statistics::of(of_size.iter().flatten());
        let found: Vec<Statistics> = divisions.chunks(SEEDS as usize).map(at_size).collect();
        let means: Vec<f64> = found.iter().map(|found| found.chi_mean.unwrap_or(1.0)).collect();
        let largest = means.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
        let spread = found.iter().filter_map(|found| found.chi_sd).fold(0.0, f64::max);
        let text = format!("χ changes by at most {largest:.2} from size to size; sd up to {spread:.2}");
        Ok((largest < CONTINUOUS, text))
    };
    let converged = judged(context.converged())?;
    let published = PUBLISHED_STEPS.map(|dt| judged(context.published(dt)));
    let published = published.into_iter().collect::<Result<Vec<_>, _>>()?;
    Ok(Finding { published, ..Finding::judged("size_continuous", converged) })
}

/// Whether the furrows of intermediate cells start at the equator and end away from it.
fn slips(figure: &Figure<'_>) -> Result<Finding, ReproduceError> {
    let context = figure.context;
    let place = |r0: &f64| Some(place_of_furrow(&Trajectory::compute(&context.input(context.cell(*r0, 0.87))).ok()?));
    let sizes = [1.8, 1.9, 2.0, 2.1, 2.2];
    let found: Vec<Option<Vec<f64>>> =
        scheduler::pool(context.threads)?.install(|| scheduler::in_parallel(sizes.len(), |k| place(&sizes[k])));
    let ends: Option<Vec<[f64; 2]>> =
        found.iter().map(|u| u.as_ref().and_then(|u| Some([*u.first()?, *u.last()?]))).collect();
    let Some(ends) = ends else { return Ok(Finding::not_computed("size_slip", "a cell has no furrow")) };
    let holds = ends.iter().all(|[first, last]| leaves_equator(*first, *last));
    let [first, last] = [0, 1].map(|end| ends.iter().map(|ends| away(ends[end])).collect::<Vec<_>>());
    let text = |values: &[f64]| values.iter().map(|v| format!("{v:.3}")).collect::<Vec<_>>().join(", ");
    Ok(Finding::judged("size_slip", (holds, format!("|u − ½| from {} to {}", text(&first), text(&last)))))
}

/// Figure 2G: χ over ε without a cue, and where division ends.
pub fn confinement(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    over_axis(figure)?;
    let cell = figure.context.cell(2.22, 0.895);
    let starts = [0.895, 0.85, 0.76];
    let pitchfork =
        critical_value(&cell, &figure.context.converged(), Parameter::Epsilon, &starts, &StepBudget::unlimited());
    let pitchfork = pitchfork.map_or_else(|error| error.to_string(), |(_, point)| format!("{:.4}", point.value));
    let note = format!("found by bisection to 0.0001; the pitchfork is at ξ_s = 25 for ε = {pitchfork}");
    let finding = match confinement_edge(figure)? {
        Some(edge) => Finding::new("confinement_edge", edge).noting(note),
        None => Finding::not_computed("confinement_edge", "divisions do not end between ε = 0.88 and 0.91"),
    };
    figure.findings.push(finding);
    Ok(())
}

/// Halvings of the interval of the edge.
const HALVINGS: usize = 8;

/// The volume fraction above which a cell of R0 = 2.22 comes to rest.
fn confinement_edge(figure: &mut Figure<'_>) -> Result<Option<f64>, ReproduceError> {
    let mut rests = |epsilons: &[f64]| -> Result<Vec<Option<bool>>, ReproduceError> {
        let input = |epsilon: &f64| figure.context.input(figure.context.cell(2.22, *epsilon));
        let divisions = figure.divisions(epsilons.iter().map(input).collect())?;
        Ok(divisions.iter().map(|division| Some(division.as_ref()?.outcome() == Outcome::Arrested)).collect())
    };
    let [mut low, mut high] = [0.88, 0.91];
    if rests(&[low, high])? != [Some(false), Some(true)] {
        return Ok(None);
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        match rests(&[middle])?[..] {
            [Some(true)] => high = middle,
            [Some(false)] => low = middle,
            _ => return Ok(None),
        }
    }
    Ok(Some(0.5 * (low + high)))
}
