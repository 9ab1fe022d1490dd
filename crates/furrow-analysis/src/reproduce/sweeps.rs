//! Figures 2A, 2B, 2G and 4: χ over size, over confinement, and over the place of a cue.

use super::context::{Artifact, Figure, Finding, ReproduceError};
use super::paper::{Criterion, Study};
use super::readings::{ChiPoint, between, chi_at, chi_in_words, edge, flatness, halves, monotone_ends, readings};
use furrow_cell::{Parameter, Scheme};
use furrow_lineage::batch::phase::{PhaseDiagram, PhaseOutcome, PhasePlane, spaced};
use furrow_mechanics::division::Outcome;
use furrow_mechanics::equilibria::critical_radius;
use serde_json::json;

/// The name, the text and the axis of a shipped sweep.
fn shipped(study: Study) -> [&'static str; 3] {
    match study {
        Study::Size => ["size.ron", include_str!("../../studies/size.ron"), "r0"],
        Study::Confinement => ["confinement.ron", include_str!("../../studies/confinement.ron"), "epsilon"],
        Study::CuePosition => ["cue-position.ron", include_str!("../../studies/cue-position.ron"), "cue.u0"],
        Study::CueSize => ["cue-size.ron", include_str!("../../studies/cue-size.ron"), "r0"],
        Study::CueConfinement => ["cue-confinement.ron", include_str!("../../studies/cue-confinement.ron"), "epsilon"],
    }
}

/// Whether χ does within a range what a criterion says, and what it does in words.
fn meets(criterion: Criterion, all: &[ChiPoint], range: [f64; 2]) -> (bool, String) {
    let part = &between(all, range);
    match criterion {
        Criterion::Rest => at_rest(all, range),
        Criterion::Halves => halves(part),
        Criterion::Falling => trend(part, |a, b| b < a, |first, last| first > 0.8 && last < 0.7, ["R0 = 1.8", "2.2"]),
        Criterion::Tightening => trend(part, |a, b| b > a, |first, _| first > 0.5, ["ε = 0.87", "0.89"]),
        Criterion::Flat => {
            let (half_width, text) = flatness(part);
            (half_width <= 0.15, text)
        }
        Criterion::Proportional => proportional(part),
        Criterion::FurrowShort => furrows(part, |furrow, cue| furrow < cue),
        Criterion::FurrowBeyond => furrows(part, |furrow, cue| furrow > cue),
        Criterion::Steep => steep(part),
        Criterion::Rising => rising(part),
    }
}

/// Figures 2A, 2G and 4B to 4E: solves the sweep of the figure's statements, compares χ with them, and shows it.
pub fn over_axis(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    let Some(study) = figure.statements.iter().find_map(|statement| Some(statement.over.as_ref()?.study)) else {
        return Ok(());
    };
    let [file, text, axis] = shipped(study);
    let (sweep, rows) = figure.sweep(text, file)?;
    let has_schemes = sweep.columns().iter().any(|column| column == "scheme");
    for statement in figure.statements {
        let Some(over) = &statement.over else { continue };
        let judged = |scheme: &str| {
            let held = over.held.iter().map(|(name, value)| (name.as_str(), json!(value)));
            let held: Vec<_> = held.chain(has_schemes.then(|| ("scheme", json!(scheme)))).collect();
            meets(over.criterion, &readings(&sweep, &rows, axis, &held), over.range)
        };
        let mut finding = Finding::judged(&statement.id, judged("converged"));
        if over.both_schemes {
            finding = finding.beside(judged("published"));
        }
        finding.note.clone_from(&over.note);
        figure.findings.push(finding);
    }
    match figure.name() {
        // Two pictures of one sweep; figure 4C is drawn with 4B-C.
        "4B-C" => {
            let (converged, published) =
                rows.into_iter().partition(|row| row.cells.first() == Some(&json!("converged")));
            figure.show("4B-C", Artifact::Sweep(Box::new(sweep.clone()), converged));
            figure.show("4B-C-published_scheme", Artifact::Sweep(Box::new(sweep), published));
        }
        "4C" => {}
        name => figure.show(name, Artifact::Sweep(Box::new(sweep), rows)),
    }
    Ok(())
}

/// A condition on two numbers.
type Compares = fn(f64, f64) -> bool;

/// Whether all cells below some size in these limits rest and all above divide.
fn at_rest(readings: &[ChiPoint], [from, to]: [f64; 2]) -> (bool, String) {
    let Some([last, first]) = edge(readings) else { return (false, "no single edge".to_owned()) };
    let holds = last >= from - 1e-9 && first <= to + 1e-9;
    (holds, format!("at rest up to R0 = {last:.2}, all divide from {first:.2} on"))
}

/// Whether χ goes one way, from a first to a last value that are as they should be.
fn trend(readings: &[ChiPoint], in_order: Compares, ends: Compares, [from, to]: [&str; 2]) -> (bool, String) {
    let Some(([first, last], ordered)) = monotone_ends(readings, in_order) else {
        return (false, "not all divide".to_owned());
    };
    (ordered && ends(first, last), format!("χ = {first:.2} at {from}, {last:.2} at {to}"))
}

/// Whether χ is proportional to the distance of the cue from the middle.
fn proportional(readings: &[ChiPoint]) -> (bool, String) {
    let ratios: Option<Vec<f64>> = readings.iter().map(|reading| Some(reading.chi? / (0.5 - reading.x))).collect();
    let Some(ratios) = ratios.filter(|ratios| !ratios.is_empty()) else { return (false, "not all divide".to_owned()) };
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    let worst = ratios.iter().map(|ratio| (ratio / mean - 1.0).abs()).fold(0.0, f64::max);
    (worst <= 0.1, format!("χ/(½ − u0) = {mean:.2} within {:.0} %", 100.0 * worst))
}

/// Whether every furrow compares with its cue as it should, by their distances from the middle.
fn furrows(readings: &[ChiPoint], compares: Compares) -> (bool, String) {
    let right = |reading: &&ChiPoint| reading.u_furrow.is_some_and(|u| compares((u - 0.5).abs(), 0.5 - reading.x));
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

/// Whether χ rises with ε.
fn rising(readings: &[ChiPoint]) -> (bool, String) {
    let rises = readings.windows(2).all(|pair| pair[0].chi.zip(pair[1].chi).is_some_and(|(a, b)| b > a));
    let chis = readings.iter().filter_map(|reading| Some((reading.x, reading.chi?)));
    let Some((x, least)) = chis.min_by(|a, b| a.1.total_cmp(&b.1)) else { return (rises, "none divides".to_owned()) };
    let [first, last] = [readings.first(), readings.last()].map(|reading| chi_in_words(reading.and_then(|r| r.chi)));
    (rises, format!("χ = {first} at ε = 0.60, least {least:.3} at {x:.2}, {last} at 0.91"))
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
    Ok(())
}

/// Figure 2G: χ over ε without a cue, and where division ends.
pub fn confinement(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    over_axis(figure)?;
    let note =
        "found by bisection to 0.0001; just above it cells rest off the centre, up to the pitchfork's ε of figure 2H-L";
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

/// Values of R0 and of ξ_s in the map.
const ACROSS: usize = 20;
const UP: usize = 9;

/// Figure 2B: outcomes over R0 and ξ_s.
pub fn plane(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    let mut map = |name: &str, scheme: Scheme| {
        let (cell, numerics) = (figure.context.cell(1.0, 0.87), figure.context.numerics(scheme));
        let (across, up) = (spaced(1.6, 5.4, ACROSS), spaced(10.0, 30.0, UP));
        figure.plane(name, PhasePlane { cell, numerics, parameter: Parameter::R0, across, up, seed: 0 })
    };
    let diagrams = [map("2B", Scheme::Converged)?, map("2B-published_scheme", Scheme::Published)?];
    let [order, coarse_order] = diagrams.each_ref().map(outcomes);
    let order = Finding::new("plane_order", order);
    figure.findings.push(Finding { published_scheme: Some(coarse_order.into()), ..order });
    let [corner, coarse_corner] = diagrams.each_ref().map(corner);
    figure.findings.push(Finding::judged("plane_corner", corner).beside(coarse_corner));
    Ok(())
}

/// The number of points of a map by outcome, in words.
pub fn outcomes(diagram: &PhaseDiagram) -> String {
    let named = [
        (PhaseOutcome::Failed, "no division"),
        (PhaseOutcome::Asymmetric, "unequal"),
        (PhaseOutcome::Symmetric, "equal"),
        (PhaseOutcome::Undecided, "undecided"),
    ];
    let parts = named.iter().filter_map(|(outcome, name)| {
        let count = diagram.cells.iter().filter(|cell| cell.outcome == *outcome).count();
        (count > 0).then(|| format!("{count} {name}"))
    });
    format!("of {} points {}", diagram.cells.len(), parts.collect::<Vec<_>>().join(", "))
}

/// Whether all points in the upper right corner divide into equal halves.
fn corner(diagram: &PhaseDiagram) -> (bool, String) {
    let inside: Vec<_> = diagram.cells.iter().filter(|cell| cell.x >= 4.9 - 1e-9 && cell.xi_s >= 20.0 - 1e-9).collect();
    let equal = inside.iter().filter(|cell| cell.outcome == PhaseOutcome::Symmetric).count();
    (equal == inside.len(), format!("{equal} of {} are equal halves", inside.len()))
}
