//! Curves in two parameters, and the boundary of division against division itself.

use furrow::cortex::{Cue, Numerics, Parameter, Physics};
use furrow::division::{DivisionInput, Outcome, divide};
use furrow::shapes::asymmetric;
use furrow::shapes::critical::{Boundary, BoundaryKind};
use furrow::shapes::curves::{self, STARTS};
use furrow::shapes::symmetric::{self, BranchEvent, BranchOptions, Criticality};

const CUE: Cue = Cue::Kappa { u0: 0.465, omega: 0.0577, amplitude: 0.1 };

fn at(epsilon: f64) -> Physics {
    Physics { epsilon, ..Physics::GAO2026 }
}

fn maxima(epsilon: f64) -> [f64; 2] {
    let branch =
        symmetric::follow(&at(epsilon), &Numerics::default(), 2.22, &BranchOptions::default(), |_| true).unwrap();
    let maxima: Vec<f64> = branch
        .events
        .iter()
        .filter_map(|event| match event {
            BranchEvent::Fold(fold) if fold.maximum => Some(fold.point.xi_s),
            _ => None,
        })
        .collect();
    [maxima[0], maxima[1]]
}

/// S-shaped branches at R0 = 2.22 (Fig S4): at ε = 0.64 the large-H fold lies at the higher ξ_s, at ε = 0.56 the small-H
/// fold; in between they change places.
#[test]
fn folds_change_their_order_between_the_two_confinements() {
    let [small, large] = maxima(0.64);
    assert!((small - 6.14).abs() < 0.005 && (large - 6.62).abs() < 0.005, "{small} {large}");
    let [small, large] = maxima(0.56);
    assert!((small - 6.85).abs() < 0.005 && (large - 4.63).abs() < 0.005, "{small} {large}");
    let [small, large] =
        curves::fold_order_swap(&at(0.6), &Numerics::default(), 2.22, Parameter::Epsilon, [0.64, 0.56])
            .unwrap()
            .unwrap();
    println!("the folds change places at epsilon = {:.8}, xi_s = {:.8}", small.value, small.xi_s);
    assert!(0.56 < small.value && small.value < 0.64);
    assert!((small.xi_s - large.xi_s).abs() < 1e-8);
    assert!(large.elongation > small.elongation + 0.1);
    let [below, above] = [maxima(small.value - 1e-4), maxima(small.value + 1e-4)];
    assert!(below[0] > below[1] && above[0] < above[1]);
}

/// The S-shape itself ends where its two lower folds meet, whichever of them is followed there.
#[test]
fn both_folds_of_the_s_shape_end_at_one_cusp() {
    let curves = curves::fold_curves(&at(0.64), &Numerics::default(), 2.22, Parameter::Epsilon, [0.64, 0.9]).unwrap();
    let cusps: Vec<_> = curves.iter().filter_map(|curve| curve.cusp).collect();
    assert_eq!((curves.len(), cusps.len()), (3, 2));
    println!("cusp at epsilon = {:.8}, xi_s = {:.8}", cusps[0].value, cusps[0].xi_s);
    assert!((cusps[0].value - cusps[1].value).abs() < 1e-9);
    assert!((cusps[0].xi_s - cusps[1].xi_s).abs() < 1e-8);
    let folds = |epsilon: f64| {
        let branch =
            symmetric::follow(&at(epsilon), &Numerics::default(), 2.22, &BranchOptions::default(), |_| true).unwrap();
        branch.events.iter().filter(|event| matches!(event, BranchEvent::Fold(_))).count()
    };
    assert_eq!((folds(cusps[0].value - 1e-3), folds(cusps[0].value + 1e-3)), (3, 1));
}

/// In a wide shell the cued branch folds more than once, and its passive shape lies far from that without the cue. The
/// radius found is where divisions begin to fail, from wherever the curve is looked for.
#[test]
fn cued_cells_of_wide_shells_have_their_critical_radius() {
    let numerics = Numerics::default();
    for epsilon in [0.6, 0.8] {
        let physics = at(epsilon);
        let [a, b] = [2.0, 4.0].map(|start| {
            curves::critical_cued_fold(&physics, &numerics, 1.0, &CUE, Parameter::R0, &[start]).unwrap().value
        });
        assert!((a / b - 1.0).abs() < 1e-8, "{a} {b}");
        for (factor, fails) in [(0.985, true), (1.015, false)] {
            let division = divide(&DivisionInput { physics, numerics, r0: factor * a, cue: CUE, seed: 0 }).unwrap();
            assert_eq!(division.outcome == Outcome::Failed, fails, "epsilon = {epsilon}, {factor} of {a}");
        }
    }
}

/// A fold met from one end is not followed again from the other, and steps lengthen as a curve leads to small radii.
#[test]
fn a_fold_is_followed_once_from_whichever_end() {
    let follow = |range| curves::fold_curves(&at(0.87), &Numerics::default(), 2.0, Parameter::R0, range).unwrap();
    for range in [[1.5, 5.4], [5.4, 1.5]] {
        let curves = follow(range);
        let [curve] = &curves[..] else { panic!("{} curves", curves.len()) };
        assert_eq!(curve.stopped_by, None);
        assert_eq!(curve.points.last().unwrap().value, range[1]);
        assert!(curve.points.len() < 300, "{} points", curve.points.len());
    }
}

/// Points of a curve are the pitchforks found one at a time, and criticality changes where the coefficient vanishes.
#[test]
fn the_curve_of_pitchforks_agrees_with_single_ones() {
    let numerics = Numerics::default();
    let curve = curves::pitchfork_curve(&at(0.87), &numerics, 2.0, Parameter::R0, [1.5, 5.4]).unwrap();
    println!("{} points, {} iterations", curve.points.len(), curve.iterations);
    for point in curve.points.iter().step_by(9) {
        let single = symmetric::first_pitchfork(&at(0.87), &numerics, point.r0, &BranchOptions::default()).unwrap();
        assert!((single.point.xi_s / point.xi_s - 1.0).abs() < 2e-8, "{point:?} {}", single.point.xi_s);
        let coefficient = point.coefficient.unwrap();
        assert!((single.coefficient / coefficient - 1.0).abs() < 1e-4, "{point:?} {}", single.coefficient);
    }
    let [degenerate] = curve.degenerate[..] else { panic!("{:?}", curve.degenerate) };
    println!("criticality changes at R0 = {:.8}, xi_s = {:.8}", degenerate.value, degenerate.xi_s);
    for (r0, expected) in
        [(degenerate.value - 0.01, Criticality::Subcritical), (degenerate.value + 0.01, Criticality::Supercritical)]
    {
        let single = symmetric::first_pitchfork(&at(0.87), &numerics, r0, &BranchOptions::default()).unwrap();
        assert_eq!(single.criticality(), expected);
    }
}

/// ε_c at R0 = 2.22, ξ_s = 25 is printed as 0.895, and 0.896 for this preset.
#[test]
fn critical_confinement() {
    let point = curves::critical_pitchfork(&at(0.87), &Numerics::default(), 2.22, Parameter::Epsilon, &[0.88]).unwrap();
    println!("epsilon_c = {:.8}", point.value);
    assert!((point.value - 0.895).abs() < 0.003);
    let again =
        symmetric::first_pitchfork(&at(point.value), &Numerics::default(), 2.22, &BranchOptions::default()).unwrap();
    assert!((again.point.xi_s - 25.0).abs() < 1e-7);
}

/// The normal form against the branch it describes, and the square-root law.
#[test]
fn asymmetric_branches_open_as_their_normal_form_says() {
    for (r0, epsilon) in [(1.64, 0.87), (2.0, 0.87), (2.22, 0.64), (2.22, 0.88)] {
        let physics = at(epsilon);
        let pitchfork =
            symmetric::first_pitchfork(&physics, &Numerics::default(), r0, &BranchOptions::default()).unwrap();
        let followed = asymmetric::follow(&pitchfork, &physics, r0, &BranchOptions::default());
        let scaling = followed.scaling.unwrap();
        println!("R0 = {r0}, epsilon = {epsilon}: c = {:.6}, {scaling:?}", pitchfork.coefficient);
        assert!(scaling.points >= 4);
        assert!((scaling.exponent - 0.5).abs() < 1e-3, "{scaling:?}");
        assert!((scaling.coefficient / pitchfork.coefficient - 1.0).abs() < 2e-3, "{scaling:?}");
    }
}

/// Just below its critical radius a cell comes to rest, just above it divides, with the cue and without.
#[test]
fn division_agrees_with_the_boundary_on_both_sides() {
    let numerics = Numerics::default();
    let boundary = Boundary::new(&Physics::GAO2026, &numerics);
    let radius = |cue: &Cue| boundary.ends(0.5, cue).unwrap().unwrap();
    let (bare, cued) = (radius(&Cue::None), radius(&CUE));
    assert_eq!((bare.kind, cued.kind), (BoundaryKind::Pitchfork, BoundaryKind::CuedFold));
    println!("critical radii: {:.8} without cue, {:.8} with", bare.critical_r0, cued.critical_r0);
    assert!(bare.critical_r0 < cued.critical_r0);
    for (cue, critical) in [(Cue::None, bare.critical_r0), (CUE, cued.critical_r0)] {
        for (factor, divides) in [(0.99, false), (1.01, true)] {
            let r0 = factor * critical;
            let input = DivisionInput { physics: Physics::GAO2026, numerics, r0, cue, seed: 0 };
            let outcome = divide(&input).unwrap().outcome;
            assert_eq!(outcome != Outcome::Failed, divides, "R0 = {r0}: {outcome:?}");
            assert_eq!(boundary.ends(r0, &cue).unwrap().is_none(), divides);
        }
    }
}

/// The critical radius by continuation from elsewhere is where the pitchfork lies at the cell's own activity.
#[test]
fn critical_radius_is_a_pitchfork_at_the_cells_activity() {
    let point = curves::critical_pitchfork(&at(0.87), &Numerics::default(), 1.0, Parameter::R0, &STARTS).unwrap();
    assert!((point.value - 1.70632).abs() < 1e-4, "{point:?}");
    let single =
        symmetric::first_pitchfork(&at(0.87), &Numerics::default(), point.value, &BranchOptions::default()).unwrap();
    assert!((single.point.xi_s - 25.0).abs() < 1e-7, "{}", single.point.xi_s);
}
