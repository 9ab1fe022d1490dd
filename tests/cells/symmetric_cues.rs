//! Symmetric cues: amplitude 0 has no effect, and even cues keep the pitchfork.

use crate::common::shapes::{check_threshold, first, whole};
use crate::common::stand_in;
use furrow_cell::cue::Quantity;
use furrow_cell::{Cell, Cue, Numerics, Parameter};
use furrow_lineage::batch::{Memo, PhasePlane, Quantisation, SchedulerOptions, phase::PhaseOutcome};
use furrow_lineage::{Lineage, Thresholds, Tree, TreeSettings};
use furrow_mechanics::cortex::{Cortex, Domain, symmetry};
use furrow_mechanics::critical::BoundaryKind;
use furrow_mechanics::critical::{CriticalRadii, critical_radius};
use furrow_mechanics::division::{DivisionInput, divide};
use furrow_mechanics::equilibria::at_rest::Edge;
use furrow_mechanics::equilibria::{BranchOptions, StepBudget, curves, primary, rest_shapes};
use furrow_mechanics::stability::{Parity, Stability};

/// Cues of amplitude 0, on the field of the equations' highest derivatives, with a width that the contour's length enters,
/// and of several terms.
const IDLE: [&str; 3] = [
    "kappa:u0=0.465,omega=0.0577,amplitude=0",
    "kappa:step,u0=0.3,omega=0.4Lh,amplitude=0",
    "activity:u0=0.4,omega=0.1,amplitude=0+tension:gradient,amplitude=0",
];

fn idle() -> impl Iterator<Item = Cue> {
    IDLE.into_iter().map(|text| text.parse().unwrap())
}

/// An even band, and a pair of steps that are mirror images.
fn even() -> [Cue; 2] {
    [
        "kappa:u0=0.5,omega=0.1,amplitude=0.1",
        "activity:step,u0=0.3,omega=0.1,amplitude=0.1+activity:step,u0=0.7,omega=-0.1,amplitude=0.1",
    ]
    .map(|text| text.parse().unwrap())
}

/// The same branch, boundary, shapes at rest and division to the last bit.
#[test]
fn a_cue_without_amplitude_is_no_cue() {
    let (numerics, options) = (Numerics::default(), BranchOptions { growth_rates: true, ..BranchOptions::default() });
    let plain = Cell::gao2026_thresholds(2.0);
    for cue in idle() {
        let cell = plain.clone().with_cue(cue.clone());
        let [a, b] = [&plain, &cell].map(|cell| primary::follow(cell, &numerics, &options, |_| true).unwrap());
        let [c, d] = [&plain, &cell]
            .map(|cell| curves::boundary_curves(cell, &numerics, Parameter::R0, [2.0, 1.7], None).unwrap());
        let [e, f] = [&plain, &cell].map(|cell| rest_shapes(cell, &numerics, 30.0).unwrap());
        let [g, h] = [&plain, &cell].map(|cell| divide(&DivisionInput::new(cell.clone())).unwrap());
        assert!(a == b && c == d && e == f && g == h, "{cue}: {} {} {} {}", a == b, c == d, e == f, g == h);
        assert_eq!(c.pitchforks.len(), 1);
    }
}

/// The built-in lineage with one cue in the place of its own, cut at six generations; divisions solved for it.
fn grow(cue: &Cue, by_critical_radius: bool) -> (Tree, usize) {
    let mut lineage = Lineage::c_elegans().unwrap().with_cues_replaced("idle", cue);
    lineage.limits.max_depth = 6;
    let rule = Thresholds::new(CriticalRadii::new(&Numerics::default()));
    let ends = |cell: &Cell| if by_critical_radius { rule.of(cell) } else { None };
    let (tree, summary) = stand_in::grow(&lineage, &TreeSettings::default(), 2, &ends, divide);
    (tree, summary.solved)
}

/// The same tree from the same number of divisions: cells with such a cue are found in the memo where those without are,
/// and critical radii are those without.
#[test]
fn a_tree_with_a_cue_without_amplitude_is_the_tree_without() {
    for by_critical_radius in [false, true] {
        let (plain, solved) = grow(&Cue::none(), by_critical_radius);
        assert!(plain.len() > 60 && solved > 5, "{} {solved}", plain.len());
        for cue in idle() {
            let (tree, same) = grow(&cue, by_critical_radius);
            assert_eq!((tree.len(), same), (plain.len(), solved), "{cue}");
            for (a, b) in tree.cells().zip(plain.cells()) {
                let (a, b) = (tree.cell(a), plain.cell(b));
                assert_eq!((&a.name, a.r0, &a.fate), (&b.name, b.r0, &b.fate), "{cue}");
            }
        }
    }
}

/// The pitchfork of a cell with an even cue is no artefact of the half contour it is computed on: on the whole contour the
/// odd mode neither grows nor decays there.
#[test]
fn even_cues_keep_the_pitchfork() {
    let numerics = Numerics::default();
    let without = first(&Cell::gao2026_thresholds(2.0)).point.xi_s;
    for cue in even() {
        let cell = Cell::gao2026_thresholds(2.0).with_cue(cue.clone());
        assert!(cell.is_mirror_symmetric());
        let branch = whole(&cell);
        let found = branch.pitchforks().next().unwrap();
        println!("{cue}: pitchfork at {:.6}, without {without:.6}", found.point.xi_s);
        assert!((found.point.xi_s - without).abs() > 0.05, "the cue moves it");
        assert!(branch.points.iter().all(|point| point.delta_u == Some(0.0)));
        let active = Cell { xi_s: found.point.xi_s, ..cell.clone() };
        let mut half = found.shape.clone();
        half.scalars.truncate(2);
        let whole = symmetry::unfold(&half);
        let spectrum =
            Stability::new(numerics.stages).leading(&Cortex::new(&active, Domain::Full, &[]), &whole).unwrap();
        assert!(spectrum.growth_rate().abs() < 1e-5, "{cue}: {spectrum:?}");
        assert_eq!(spectrum.values[0].parity, Parity::Mixed);

        let curve =
            curves::boundary_curves(&cell, &numerics, Parameter::R0, [2.0, 2.2], None).unwrap().pitchforks.remove(0);
        assert!((curve.points[0].xi_s / found.point.xi_s - 1.0).abs() < 1e-7);
        let shapes = rest_shapes(&cell, &numerics, 30.0).unwrap();
        let Edge::Pitchfork { xi_s, .. } = shapes.edges[0] else { panic!("{shapes:?}") };
        assert!((xi_s / found.point.xi_s - 1.0).abs() < 1e-7);
        assert_eq!(shapes.intervals, [[0.0, xi_s]]);
    }
}

/// In a phase diagram a cell with an even cue rests below its pitchfork and divides above, as its divisions say.
#[test]
fn phase_diagrams_of_even_cues_have_a_pitchfork() {
    let [cue, _] = even();
    let cell = Cell::gao2026_thresholds(2.0).with_cue(cue);
    let numerics = Numerics::default();
    let threshold = first(&cell).point.xi_s;
    let up = vec![0.985 * threshold, 1.015 * threshold];
    let plane = PhasePlane { cell, numerics, parameter: Parameter::R0, across: vec![2.0], up, seed: 0 };
    let memo = Memo::new(Quantisation::EXACT);
    let diagram = plane.compute(&memo, &SchedulerOptions::default()).unwrap();
    assert!(
        matches!(diagram.columns[0].edges[0], Edge::Pitchfork { xi_s, .. } if (xi_s / threshold - 1.0).abs() < 1e-7)
    );
    let outcomes: Vec<PhaseOutcome> = diagram.cells.iter().map(|cell| cell.outcome).collect();
    assert_eq!(outcomes, [PhaseOutcome::Failed, PhaseOutcome::Asymmetric]);
}

#[test]
fn divisions_agree_with_the_critical_radius_of_even_cues() {
    for cue in even() {
        let cell = Cell::gao2026_thresholds(1.0).with_cue(cue.clone());
        let critical = critical_radius(&cell, &Numerics::default()).unwrap();
        println!("{cue}: critical radius {:.6}", critical.r0);
        assert_eq!(critical.kind, BoundaryKind::Pitchfork);
        check_threshold(0.015, |factor| Cell { r0: factor * critical.r0, ..cell.clone() });
    }
}

/// Where the symmetric branch itself folds, cells with and without a cue are bounded by one curve of folds. Followed from
/// amplitude 0, where half the contour would do, it leads to the fold of the cue.
#[test]
fn boundaries_over_an_amplitude_pass_from_no_cue_to_a_cue() {
    let numerics = Numerics::default();
    let amplitude = Parameter::Cue { term: 0, quantity: Quantity::Amplitude };
    for (r0, epsilon) in [(2.22, 0.56), (3.0, 0.5)] {
        let cell = Cell { epsilon, ..Cell::gao2026_thresholds(r0) }.with_cue(Cue::published());
        let fold = primary::failure_fold(&cell, &numerics, &StepBudget::unlimited()).unwrap().point.xi_s;
        for range in [[0.0, 0.1], [0.1, 0.0]] {
            let found = curves::boundary_curves(&cell, &numerics, amplitude, range, None).unwrap();
            let end = found.folds[0].points.iter().find(|point| point.value == 0.1).unwrap();
            assert!(found.pitchforks.is_empty());
            assert!((end.xi_s / fold - 1.0).abs() < 1e-7, "R0 = {r0}, {range:?}: {} {fold}", end.xi_s);
        }
    }
}

/// A cue that is even by a pair of terms is not where one of the two varies.
#[test]
fn one_term_of_an_even_pair_breaks_the_symmetry() {
    let [_, pair] = even();
    let cell = Cell::gao2026_thresholds(2.2).with_cue(pair);
    let amplitude = Parameter::Cue { term: 0, quantity: Quantity::Amplitude };
    let varied = |value: f64| {
        let mut cell = cell.clone();
        amplitude.set(&mut cell, value);
        primary::failure_fold(&cell, &Numerics::default(), &StepBudget::unlimited()).unwrap().point.xi_s
    };
    let found = curves::boundary_curves(&cell, &Numerics::default(), amplitude, [0.15, 0.12], None).unwrap();
    assert!(found.pitchforks.is_empty());
    for (point, value) in [(&found.folds[0].points[0], 0.15), (found.folds[0].points.last().unwrap(), 0.12)] {
        assert!((point.xi_s / varied(value) - 1.0).abs() < 1e-7, "{point:?}");
    }
}

/// A cell with two equal furrows and without noise keeps its mirror symmetry: both necks close at once, whichever counts as the first.
#[test]
fn a_cell_that_falls_into_three_parts_says_so() {
    let cue = "kappa:band,u0=0.3,omega=0.1,amplitude=0.2+kappa:band,u0=0.7,omega=0.1,amplitude=0.2";
    let numerics = Numerics { noise: 0.0, ..Numerics::default() };
    let cell = Cell::new(4.0).with_cue(cue.parse().unwrap());
    let found = divide(&DivisionInput { numerics, ..DivisionInput::new(cell) }).unwrap();
    let (u, second) = (found.u_furrow().unwrap(), found.second_neck.unwrap());
    println!("{u} and {second:?}, {:?}", found.shares());
    assert!((u + second.u - 1.0).abs() < 1e-6 && second.radius < 0.01, "{u} and {second:?}");
    let outer = found.shares().unwrap().into_iter().fold(1.0, f64::min);
    assert!((second.share - outer).abs() < 1e-6, "{second:?} beside {outer}");
    assert_eq!(found.clone().mirrored().second_neck.unwrap().u, 1.0 - second.u);
    // The two ends of a tube are one neck.
    let tube =
        Cell { epsilon: 0.6, ..Cell::new(5.4) }.with_cue("kappa:u0=0.465,omega=0.0577,amplitude=0.1".parse().unwrap());
    assert_eq!(divide(&DivisionInput::new(tube)).unwrap().second_neck, None);
}
