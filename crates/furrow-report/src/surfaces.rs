//! Cells without axial symmetry as records.

use furrow_mechanics::equilibria::Criticality;
use furrow_surface::bent::{BentBranch, BentPoint};
use furrow_surface::division::{AtRest, NeckAt, SurfaceDivision};
use serde_json::{Value, json};

/// A state at rest, and its leading growth rates over all modes; `found` led to it.
pub fn rest_report(found: &SurfaceDivision, rest: &AtRest) -> Value {
    let rates: Vec<Value> = rest.rates.iter().map(|rate| json!({ "re": rate.re, "im": rate.im })).collect();
    let [reduced_volume, bending_energy] = rest.reduced_volume_and_bending();
    json!({
        "L": rest.length(), "p": rest.state.pressure, "H": rest.elongation(), "r_eq": rest.equator_radius(),
        "stable": rest.growth_rate() < 0.0, "growth_rate": rest.growth_rate(), "growth_rates": rates,
        "neck_offset": rest.offset(), "modes": found.modes,
        "reduced_volume": reduced_volume, "bending_energy": bending_energy,
    })
}

/// The number of azimuthal modes at the end of a division, its neck over time, and at rest the distance of the cell from the axis.
pub fn neck_report(found: &SurfaceDivision) -> Value {
    let over_time = |value: fn(&NeckAt) -> f64| found.necks.iter().map(value).collect::<Vec<_>>();
    let mut report = json!({
        "modes": found.modes,
        "neck": {
            "t": over_time(|at| at.t),
            "radius": over_time(|at| at.neck.radius),
            "offset": over_time(|at| at.neck.offset),
            "position": over_time(|at| at.neck.height),
            "tilt": over_time(|at| at.neck.tilt),
        },
    });
    if let Some(rest) = &found.rest {
        report["neck_offset"] = json!(rest.offset());
    }
    report
}

/// Where the bent states of a cell begin, with c of ξ_s = ξ₁ + c bend², their odd pitchfork and their fold.
pub fn bent_report(bent: &BentBranch) -> Value {
    let point = |point: &BentPoint| {
        json!({
            "xi_s": point.xi_s, "bend": point.bend, "H": point.elongation, "L": point.length, "p": point.pressure,
            "neck_offset": point.neck_offset, "growth_rates": { "even": point.even, "odd": point.odd },
        })
    };
    let (threshold, located) = (bent.threshold, |at: &Option<BentPoint>| at.as_ref().map(point));
    json!({
        "xi_s": threshold.xi_s, "coefficient": threshold.coefficient,
        "criticality": Criticality::of(threshold.coefficient),
        "odd_pitchfork": located(&bent.pitchfork), "fold": located(&bent.fold),
    })
}
