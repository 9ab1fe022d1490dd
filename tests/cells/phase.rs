//! The exact edges of a phase diagram compared with divisions on both sides.

use crate::common::shapes::{at, check_threshold};
use furrow_cell::{Cell, Cue, Numerics, Parameter};
use furrow_lineage::batch::{Memo, PhasePlane, Quantisation, SchedulerOptions};
use furrow_mechanics::equilibria::at_rest::{Edge, rest_shapes};

/// Below the upper end of its stable symmetric shapes a cell stays at rest; above, it divides. Cells with a subcritical
/// pitchfork first, with an S-shaped branch: its first rise ends in a fold, its second one in a pitchfork.
#[test]
fn divisions_agree_with_the_edges() {
    for (r0, epsilon, edge) in [(1.64, 0.87, 25.79676), (2.22, 0.64, 6.24541), (2.22, 0.56, 6.8535)] {
        let cell = at(r0, epsilon);
        let shapes = rest_shapes(&cell, &Numerics::default(), 60.0).unwrap();
        let top = shapes.intervals.iter().fold(0.0f64, |top, i| top.max(i[1]));
        assert!((top - edge).abs() < 1e-3, "{top} {edge}");
        assert_eq!([0.98, 1.02].map(|factor| shapes.contains(factor * top)), [true, false]);
        check_threshold(0.02, |factor| Cell { xi_s: factor * top, ..cell.clone() });
    }
}

/// With a cue there is no pitchfork: the leaning shape ends in a fold, below which a cell stays at rest.
#[test]
fn divisions_of_cued_cells_agree_with_their_fold() {
    let cell = Cell::gao2026_thresholds(2.2).with_cue(Cue::published());
    let shapes = rest_shapes(&cell, &Numerics::default(), 40.0).unwrap();
    let Edge::Fold { xi_s: fold, maximum: true } = shapes.edges[0] else { panic!("{shapes:?}") };
    assert_eq!(shapes.intervals, [[0.0, fold]]);
    assert_eq!([0.98, 1.02].map(|factor| shapes.contains(factor * fold)), [true, false]);
    check_threshold(0.02, |factor| Cell { xi_s: factor * fold, ..cell.clone() });
}

/// Shapes may begin to oscillate before their pitchfork, or without one.
#[test]
fn stable_shapes_end_where_an_oscillation_grows() {
    for (tension, hopf) in [(0.65, 17.2380), (0.8, 18.5935), (0.9, 19.5162)] {
        let mut cell = Cell::new(5.4);
        Parameter::Tension.set(&mut cell, tension);
        let shapes = rest_shapes(&cell, &Numerics::default(), 25.0).unwrap();
        let [[from, to]] = shapes.intervals[..] else { panic!("{shapes:?}") };
        assert!(from == 0.0 && (to - hopf).abs() < 1e-3, "{tension}: {shapes:?}");
        assert!(matches!(shapes.edges.last(), Some(Edge::Hopf { xi_s, .. }) if *xi_s == to));
    }
}

/// A pitchfork between the last free point of a branch and the bound it is cut at was once an error: landing on the bound
/// forgot the point before.
#[test]
fn edges_just_below_the_end_of_the_range() {
    for (cell, edge, bounds) in [
        (at(2.0, 0.87), 22.05688, [22.06, 22.1, 22.5, 23.0, 24.0, 25.0, 26.0]),
        (at(2.22, 0.9), 25.70943, [25.8, 26.0, 27.0, 28.0, 28.38, 29.0, 31.0]),
    ] {
        for xi_max in bounds {
            let shapes = rest_shapes(&cell, &Numerics::default(), xi_max).unwrap();
            let [Edge::Pitchfork { xi_s, .. }] = shapes.edges[..] else { panic!("{xi_max}: {shapes:?}") };
            assert!((xi_s - edge).abs() < 1e-5, "{xi_max}: {xi_s}");
            assert_eq!(shapes.intervals, [[0.0, xi_s]]);
        }
    }
}

/// A cell with a cue may pass its stable shape on the way from the passive one: only a division shows whether it rests.
#[test]
fn cells_with_a_cue_divide_beside_a_stable_shape() {
    let cue = "tension:gradient,amplitude=0.3".parse().unwrap();
    let cell = Cell { epsilon: 0.64, ..Cell::new(4.0) }.with_cue(cue);
    let plane = PhasePlane {
        cell: cell.clone(),
        numerics: Numerics::default(),
        parameter: Parameter::R0,
        across: vec![4.0, 5.0],
        up: vec![10.0, 11.0],
        seed: 0,
    };
    let stable = rest_shapes(&Cell { xi_s: 10.0, ..cell }, &Numerics::default(), 12.0).unwrap();
    assert!(stable.contains(10.0) && stable.contains(11.0), "{stable:?}");
    let diagram = plane.compute(&Memo::new(Quantisation::DEFAULT), &SchedulerOptions::default()).unwrap();
    let chi: Vec<f64> = diagram.cells.iter().map(|cell| cell.chi.unwrap_or(0.0)).collect();
    let expected = [0.962, 0.490, 0.0, 0.477];
    assert!(chi.iter().zip(expected).all(|(chi, expected)| (chi - expected).abs() < 1e-3), "{chi:?}");
}
