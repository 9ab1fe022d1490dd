//! The edge of division on the phase diagram: activities at which pitchforks lie, over the radius.

use furrow_cell::{Cell, Cue, Numerics, Parameter};
use furrow_mechanics::equilibria::curves::pitchfork_curve;
use serde::Deserialize;
use serde_json::json;

use super::answer::{Answer, PageError};

#[derive(Debug, Deserialize)]
struct Request {
    cell: Cell,
    numerics: Numerics,
    /// Radii R0 between which the curve is wanted, in L_h.
    range: [f64; 2],
}

/// The curve ξ_s*(R0) of cells like the given one without a cue: the edge at which the symmetric furrow loses its stability.
/// Where the curve cannot be followed to the end of the range, what was found is the answer.
///
/// # Errors
/// No pitchfork is found to begin with.
pub fn edge(request: &[u8]) -> Result<Answer, PageError> {
    let Request { cell, numerics, range } = serde_json::from_slice(request)?;
    let curve = pitchfork_curve(&cell.with_cue(Cue::none()), &numerics, Parameter::R0, range)?;
    let points = curve.points.iter().map(|p| json!({ "r0": p.r0, "xi_s": p.xi_s, "coefficient": p.coefficient }));
    Ok(Answer::of(json!({ "points": points.collect::<Vec<_>>() }).to_string()))
}

#[cfg(test)]
mod tests {
    use serde_json::Value;

    use super::*;

    #[test]
    fn the_edge_passes_the_critical_radius() {
        let request =
            json!({ "cell": Cell::gao2026_thresholds(2.0), "numerics": Numerics::default(), "range": [1.6, 2.4] });
        let answer = edge(request.to_string().as_bytes()).unwrap();
        let found: Value = serde_json::from_str(&answer.text).unwrap();
        let points: Vec<[f64; 2]> = found["points"]
            .as_array()
            .unwrap()
            .iter()
            .map(|p| ["r0", "xi_s"].map(|k| p[k].as_f64().unwrap()))
            .collect();
        let k = points.iter().position(|point| point[0] > 1.7063).unwrap();
        let ([x, y], [a, b]) = (points[k - 1], points[k]);
        let at = y + (b - y) * (1.706_324_8 - x) / (a - x);
        assert!((at - 25.0).abs() < 0.3, "{at}");
    }
}
