//! Figure 2A and 2B: size without a cue.

use serde_json::json;

use super::lab::{Finding, Found, Lab, LabError, Shown};
use super::paper::Statement;
use super::series::{all_equal, between, chi_at, edge, readings, unequal_stretches};
use crate::batch::phase::{PhaseDiagram, PhaseOutcome, PhasePlane, spaced};
use crate::cell::{Numerics, Parameter};
use crate::shapes::critical_radius;

/// The sweep that ships.
const SIZE: &str = include_str!("../../../../../studies/size.ron");

/// Figure 2A: χ over R0.
pub fn sizes(lab: &Lab<'_>, _: &[Statement]) -> Result<Found, LabError> {
    let mut found = Found::default();
    let (sweep, rows) = lab.sweep(SIZE, "size.ron", &mut found)?;
    let [converged, published] =
        ["converged", "published"].map(|scheme| readings(&sweep, &rows, "r0", &[("scheme", json!(scheme))]));
    let critical = critical_radius(&lab.cell(1.0, 0.87), &lab.numerics());
    let rest = |id: &str, edge: Option<[f64; 2]>, within: [f64; 2]| match edge {
        Some([last, first]) => {
            let holds = within[0] <= last && first <= within[1] + 1e-9;
            Finding::words(id, holds, format!("at rest up to R0 = {last:.2}, all divide from {first:.2} on"))
        }
        None => Finding::words(id, false, "no single edge".to_owned()),
    };
    let size_rest = rest("size_rest", edge(&converged), [1.6, 1.8]);
    found.say(match critical {
        Ok(critical) => size_rest.noting(format!("the pitchfork is at ξ_s = 25 for R0_c = {:.4}", critical.r0)),
        Err(error) => size_rest.noting(error.to_string()),
    });
    let chi: Option<Vec<f64>> = [1.8, 1.9, 2.0, 2.1, 2.2].into_iter().map(|r0| chi_at(&converged, r0)).collect();
    found.say(match chi.as_deref() {
        Some(chi @ [first, .., last]) => {
            let falls = chi.windows(2).all(|pair| pair[1] < pair[0]);
            let text = format!("χ = {first:.2} at R0 = 1.8, {last:.2} at 2.2");
            Finding::words("size_unequal", falls && *first > 0.8 && *last < 0.7, text)
        }
        _ => Finding::words("size_unequal", false, "not all divide".to_owned()),
    });
    let [large, coarse] = [&converged, &published].map(|readings| between(readings, [2.3, 5.4]));
    let halves = Finding::words("size_halves", all_equal(&large), unequal_stretches(&large));
    found.say(
        halves
            .beside_judged(all_equal(&coarse), unequal_stretches(&coarse))
            .noting("several modes of a large cell's furrow grow early on; backward Euler at Δt = 0.1 τ damps them"),
    );
    found.show("2A", Shown::Sweep(Box::new(sweep), rows));
    Ok(found)
}

/// Values of R0 and of ξ_s in the map.
const ACROSS: usize = 20;
const UP: usize = 9;

/// Figure 2B: outcomes over R0 and ξ_s.
pub fn plane(lab: &Lab<'_>, _: &[Statement]) -> Result<Found, LabError> {
    let mut found = Found::default();
    let mut map = |name: &str, numerics: Numerics| {
        let (cell, across) = (lab.cell(1.0, 0.87), spaced(1.6, 5.4, ACROSS));
        let up = spaced(10.0, 30.0, UP);
        lab.plane(name, PhasePlane { cell, numerics, parameter: Parameter::R0, across, up, seed: 0 }, &mut found)
    };
    let diagram = map("2B", lab.numerics())?;
    let coarse = map("2B-published_scheme", lab.published())?;
    found.say(Finding::open("plane_order", outcomes(&diagram)).beside(outcomes(&coarse)));
    let [(equal, all), (coarse_equal, _)] = [&diagram, &coarse].map(corner);
    let text = |equal: usize| format!("{equal} of {all} are equal halves");
    found.say(
        Finding::words("plane_corner", equal == all, text(equal))
            .beside_judged(coarse_equal == all, text(coarse_equal)),
    );
    Ok(found)
}

/// How many points of a map end how, in words.
pub fn outcomes(diagram: &PhaseDiagram) -> String {
    let count = |outcome: PhaseOutcome| diagram.cells.iter().filter(|cell| cell.outcome == outcome).count();
    let named = [
        (PhaseOutcome::Failed, "no division"),
        (PhaseOutcome::Asymmetric, "unequal"),
        (PhaseOutcome::Symmetric, "equal"),
        (PhaseOutcome::Undecided, "undecided"),
    ];
    let parts = named.iter().map(|(outcome, name)| (count(*outcome), name)).filter(|(count, _)| *count > 0);
    let parts: Vec<String> = parts.map(|(count, name)| format!("{count} {name}")).collect();
    format!("of {} points {}", diagram.cells.len(), parts.join(", "))
}

/// Points in the upper right corner that divide into equal halves, and all of them.
fn corner(diagram: &PhaseDiagram) -> (usize, usize) {
    let inside: Vec<_> = diagram.cells.iter().filter(|cell| cell.x >= 4.9 - 1e-9 && cell.xi_s >= 20.0 - 1e-9).collect();
    (inside.iter().filter(|cell| cell.outcome == PhaseOutcome::Symmetric).count(), inside.len())
}
