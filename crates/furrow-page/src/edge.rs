//! The edge of division on the phase diagram: the activity of the first pitchfork as a function of the radius.

use furrow_cell::{Cell, Cue, Numerics, Parameter};
use furrow_mechanics::equilibria::curves::{CurvePoint, SECOND, coefficient, curve_point, through_pitchfork};
use furrow_mechanics::equilibria::{BranchOptions, PointKind, ShapeError, pitchfork};
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

/// Where to look for the next piece beyond the end of one, as a factor of the radius, and the greatest number of
/// searches.
const BEYOND: f64 = 1.005;
const MOST_SEARCHES: usize = 12;
/// Most steps of a piece.
const MOST_STEPS: usize = 400;

/// The first pitchforks ξ_s*(R0) of cells like the given one without a cue: the edge at which the symmetric furrow
/// loses its stability. In narrow shells it has several pieces, since a curve of pitchforks turns back and another
/// curve has the first pitchfork beyond. If a curve cannot be followed to the end of the range, the answer holds the
/// points found.
///
/// # Errors
/// No pitchfork is found in the range.
pub fn edge(request: &[u8]) -> Result<Answer, PageError> {
    let Request { cell, numerics, range: [from, to] } = serde_json::from_slice(request)?;
    let cell = cell.with_cue(Cue::none());
    let (mut pieces, mut r0, mut refusal) = (Vec::new(), from, None);
    for _ in 0..MOST_SEARCHES {
        if r0 > to {
            break;
        }
        match piece(&cell, &numerics, [r0, to]) {
            Ok(points) => {
                r0 = BEYOND * points.last().map_or(r0, |point| point.r0);
                pieces.push(points);
            }
            Err(error) => {
                refusal.get_or_insert(error);
                r0 *= BEYOND.powi(20);
            }
        }
    }
    if let (true, Some(error)) = (pieces.is_empty(), refusal) {
        return Err(error.into());
    }
    let points =
        |piece: Vec<CurvePoint>| piece.iter().map(|p| json!([p.r0, p.xi_s, p.coefficient])).collect::<Vec<_>>();
    Ok(Answer::of(json!({ "pieces": pieces.into_iter().map(points).collect::<Vec<_>>() }).to_string()))
}

/// The curve from the first pitchfork at one radius to another radius, or to the point where it turns back.
fn piece(cell: &Cell, numerics: &Numerics, [from, to]: [f64; 2]) -> Result<Vec<CurvePoint>, ShapeError> {
    let cell = Cell { r0: from, ..cell.clone() };
    let first = pitchfork::first(&cell, numerics, &BranchOptions::default())?;
    let lost = |source| ShapeError::Curve { kind: PointKind::Pitchfork, parameter: Parameter::R0, value: to, source };
    let mut curve = through_pitchfork(&cell, &first, Parameter::R0, true).map_err(lost)?;
    let mut points = vec![curve_point(&curve, Some(first.coefficient))];
    // The points found before a failure are valid.
    let _ = curve.follow_to(SECOND, to, MOST_STEPS, |curve, report| {
        let y = curve.solution.clone();
        let c = coefficient(curve, &y, report).ok();
        let point = curve_point(curve, c);
        let rises = points.last().is_none_or(|last| point.r0 > last.r0);
        points.extend(rises.then_some(point));
        rises
    });
    Ok(points)
}

#[cfg(test)]
mod tests {
    use serde_json::Value;

    use super::*;

    /// Pieces of (R0, ξ_s) of an edge.
    fn pieces(cell: Cell, range: [f64; 2]) -> Vec<Vec<[f64; 2]>> {
        let request = json!({ "cell": cell, "numerics": Numerics::default(), "range": range });
        let found: Value = serde_json::from_str(&edge(request.to_string().as_bytes()).unwrap().text).unwrap();
        let point = |point: &Value| [0, 1].map(|k| point[k].as_f64().unwrap());
        let piece = |piece: &Value| piece.as_array().unwrap().iter().map(point).collect();
        found["pieces"].as_array().unwrap().iter().map(piece).collect()
    }

    /// ξ_s at a radius.
    fn at(pieces: &[Vec<[f64; 2]>], r0: f64) -> f64 {
        let between = |pair: &&[[f64; 2]]| (pair[0][0]..=pair[1][0]).contains(&r0);
        let [[x, y], [a, b]] = *pieces.iter().find_map(|piece| piece.windows(2).find(between)).unwrap() else {
            panic!()
        };
        y + (b - y) * (r0 - x) / (a - x)
    }

    #[test]
    fn the_edge_passes_the_critical_radius() {
        let found = pieces(Cell::gao2026_thresholds(2.0), [1.6, 2.4]);
        assert!((at(&found, 1.706_324_8) - 25.0).abs() < 0.3, "{found:?}");
    }

    /// In a narrow shell the first curve turns back before the end of the range. The edge is the first pitchfork at every radius.
    #[test]
    fn a_narrow_shell_has_an_edge_in_pieces() {
        let cell = Cell { epsilon: 0.96, ..Cell::new(2.0) };
        let found = pieces(cell.clone(), [2.0, 6.2]);
        let radii: Vec<f64> = found.iter().flatten().map(|point| point[0]).collect();
        assert!(found.len() > 1 && radii.is_sorted() && radii[0] == 2.0 && radii.last() == Some(&6.2), "{radii:?}");
        for r0 in [2.5, 6.0] {
            let alone = pitchfork::first(&Cell { r0, ..cell.clone() }, &Numerics::default(), &BranchOptions::default());
            let expected = alone.unwrap().point.xi_s;
            assert!((at(&found, r0) - expected).abs() < 0.3, "{} {expected}", at(&found, r0));
        }
    }
}
