//! The exact edges of a phase diagram against divisions on both sides of them.

use furrow::cell::{Cell, Cue, Numerics};
use furrow::division::{DivisionInput, Outcome, divide};
use furrow::shapes::at_rest::{Edge, rest_shapes};

/// Below the upper end of its stable symmetric shapes a cell stays at rest; above, it divides. Cells with a subcritical
/// pitchfork first, with an S-shaped branch whose second rise ends in a pitchfork, and whose first rise ends in a fold.
#[test]
fn divisions_agree_with_the_edges() {
    for (r0, epsilon, edge) in [(1.64, 0.87, 25.79676), (2.22, 0.64, 6.24541), (2.22, 0.56, 6.8535)] {
        let cell = Cell { epsilon, ..Cell::new(r0) };
        let shapes = rest_shapes(&cell, &Numerics::default(), 60.0).unwrap();
        let top = shapes.intervals.iter().fold(0.0f64, |top, i| top.max(i[1]));
        assert!((top - edge).abs() < 1e-3, "{top} {edge}");
        for (factor, rests) in [(0.98, true), (1.02, false)] {
            let xi_s = factor * top;
            assert_eq!(shapes.contains(xi_s), rests);
            let division = divide(&DivisionInput::new(Cell { xi_s, ..cell.clone() })).unwrap();
            assert_eq!(division.outcome == Outcome::Failed, rests, "R0 = {r0}, epsilon = {epsilon}, xi_s = {xi_s}");
        }
    }
}

/// With a cue there is no pitchfork: the leaning shape ends in a fold, below which a cell stays at rest.
#[test]
fn divisions_of_cued_cells_agree_with_their_fold() {
    let cell = Cell::new(2.2).with_cue(Cue::published());
    let shapes = rest_shapes(&cell, &Numerics::default(), 40.0).unwrap();
    let Edge::Fold { xi_s: fold, maximum: true } = shapes.edges[0] else { panic!("{shapes:?}") };
    assert_eq!(shapes.intervals, [[0.0, fold]]);
    for (factor, rests) in [(0.98, true), (1.02, false)] {
        let input = DivisionInput::new(Cell { xi_s: factor * fold, ..cell.clone() });
        assert_eq!(shapes.contains(factor * fold), rests);
        assert_eq!(divide(&input).unwrap().outcome == Outcome::Failed, rests, "xi_s = {}", factor * fold);
    }
}

/// A pitchfork between the last free point of a branch and the bound it is cut at was once an error: landing on the bound
/// forgot the point before.
#[test]
fn edges_just_below_the_end_of_the_range() {
    let mut cells = Vec::new();
    cells.extend([22.06, 22.1, 22.5, 23.0, 24.0, 25.0, 26.0].map(|xi_max| (2.0, 0.87, xi_max, 22.05688)));
    cells.extend([25.8, 26.0, 27.0, 28.0, 28.38, 29.0, 31.0].map(|xi_max| (2.22, 0.9, xi_max, 25.70943)));
    for (r0, epsilon, xi_max, edge) in cells {
        let cell = Cell { epsilon, ..Cell::new(r0) };
        let shapes = rest_shapes(&cell, &Numerics::default(), xi_max).unwrap();
        let [Edge::Pitchfork { xi_s, .. }] = shapes.edges[..] else { panic!("{xi_max}: {shapes:?}") };
        assert!((xi_s - edge).abs() < 1e-5, "{xi_max}: {xi_s}");
        assert_eq!(shapes.intervals, [[0.0, xi_s]]);
    }
}
