//! Curves in two parameters, and the boundary of division compared with divisions.

use crate::common::shapes::{at, check_threshold, first, whole};
use furrow_cell::cue::Quantity;
use furrow_cell::{Cell, Cue, Numerics, Parameter};
use furrow_mechanics::critical::CriticalRadii;
use furrow_mechanics::critical::{self, BoundaryKind, STARTS};
use furrow_mechanics::equilibria::curves::{self, CurveEnd, CurvePoint, FoldCurve, SECOND};
use furrow_mechanics::equilibria::{BranchOptions, Criticality, StepBudget, asymmetric, primary};

fn maxima(epsilon: f64) -> [f64; 2] {
    let branch = whole(&at(2.22, epsilon));
    let maxima: Vec<f64> = branch.folds().filter(|fold| fold.maximum).map(|fold| fold.point.xi_s).collect();
    [maxima[0], maxima[1]]
}

/// The points of the two curves of maxima of a cell where both lie at the same ξ_s, by Newton with the slopes of both
/// curves, ε within a range that begins at the cell's own.
fn fold_order_swap(cell: &Cell, [from, to]: [f64; 2]) -> [CurvePoint; 2] {
    assert_eq!(cell.epsilon, from);
    let mut curves: Vec<FoldCurve> = whole(cell)
        .folds()
        .filter(|fold| fold.maximum)
        .map(|fold| curves::through_fold(cell, fold, Parameter::Epsilon, to > from).unwrap())
        .collect();
    for _ in 0..50 {
        let [small, large] = [&curves[0], &curves[1]].map(|curve| curves::curve_point(curve, None));
        let step = -(small.xi_s - large.xi_s) / (small.slope - large.slope);
        if step.abs() < 1e-11 * small.value.abs() {
            return [small, large];
        }
        let next = (small.value + step).clamp(from.min(to), from.max(to));
        assert!(next != small.value, "the folds do not change places between {from} and {to}");
        for curve in &mut curves {
            curve.head_for(SECOND, next);
            curve.follow_to(SECOND, next, 2000, |_, _| true).unwrap();
        }
    }
    panic!("Newton does not converge on the order swap");
}

/// S-shaped branches at R0 = 2.22 (Fig S4): at ε = 0.64 the large-H fold lies at the higher ξ_s, at ε = 0.56 the small-H
/// fold; in between they change places.
#[test]
fn folds_change_their_order_between_the_two_confinements() {
    let [small, large] = maxima(0.64);
    assert!((small - 6.14).abs() < 0.005 && (large - 6.62).abs() < 0.005, "{small} {large}");
    let [small, large] = maxima(0.56);
    assert!((small - 6.85).abs() < 0.005 && (large - 4.63).abs() < 0.005, "{small} {large}");
    let [small, large] = fold_order_swap(&at(2.22, 0.64), [0.64, 0.56]);
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
    let curves =
        curves::boundary_and_folds(&at(2.22, 0.64), &Numerics::default(), Parameter::Epsilon, [0.64, 0.9], None)
            .unwrap()
            .folds;
    let cusps: Vec<_> = curves.iter().filter_map(|curve| curve.cusp()).collect();
    assert_eq!((curves.len(), cusps.len()), (3, 2));
    println!("cusp at epsilon = {:.8}, xi_s = {:.8}", cusps[0].value, cusps[0].xi_s);
    assert!((cusps[0].value - cusps[1].value).abs() < 1e-9);
    assert!((cusps[0].xi_s - cusps[1].xi_s).abs() < 1e-8);
    let folds = |epsilon: f64| whole(&at(2.22, epsilon)).folds().count();
    assert_eq!((folds(cusps[0].value - 1e-3), folds(cusps[0].value + 1e-3)), (3, 1));
}

fn critical_value(cell: &Cell, parameter: Parameter, starts: &[f64]) -> CurvePoint {
    critical::critical_value(cell, &Numerics::default(), parameter, starts, &StepBudget::unlimited()).unwrap().1
}

/// In a wide shell the cued branch folds more than once, and its passive shape lies far from that without the cue. The
/// radius found is where divisions begin to fail, from wherever the curve is looked for.
#[test]
fn cued_cells_of_wide_shells_have_their_critical_radius() {
    for epsilon in [0.6, 0.8] {
        let cell = at(1.0, epsilon).with_cue(Cue::published());
        let [a, b] = [2.0, 4.0].map(|start| critical_value(&cell, Parameter::R0, &[start]).value);
        assert!((a / b - 1.0).abs() < 1e-8, "{a} {b}");
        check_threshold(0.015, |factor| Cell { r0: factor * a, ..cell.clone() });
    }
}

/// A fold met from one end is not followed again from the other, and steps lengthen as a curve leads to small radii.
#[test]
fn a_fold_is_followed_once_from_whichever_end() {
    for range in [[1.5, 5.4], [5.4, 1.5]] {
        let curves =
            curves::boundary_and_folds(&at(2.0, 0.87), &Numerics::default(), Parameter::R0, range, None).unwrap().folds;
        let [curve] = &curves[..] else { panic!("{} curves", curves.len()) };
        assert_eq!(curve.ended, CurveEnd::Reached);
        assert_eq!(curve.points.last().unwrap().value, range[1]);
        assert!(curve.points.len() < 300, "{} points", curve.points.len());
    }
}

/// The curve of folds that ends the stable shapes lies between two cusps and does not reach the ends of the range.
#[test]
fn a_boundary_has_the_folds_within_its_range() {
    let cell = at(2.2, 0.87).with_cue(Cue::published());
    let u0 = Parameter::Cue { term: 0, quantity: Quantity::U0 };
    let found = curves::boundary_and_folds(&cell, &Numerics::default(), u0, [0.2, 0.8], None).unwrap().folds;
    let highest = |value: f64| {
        let curves = found.iter().flat_map(|curve| curve.points.windows(2));
        let around = curves.filter(|ends| (ends[0].value - value) * (ends[1].value - value) <= 0.0);
        around.map(|ends| f64::max(ends[0].xi_s, ends[1].xi_s)).fold(0.0, f64::max)
    };
    for value in [0.3, 0.4, 0.45, 0.55, 0.7] {
        let mut cell = cell.clone();
        u0.set(&mut cell, value);
        let fold = primary::failure_fold(&cell, &Numerics::default(), &StepBudget::unlimited()).unwrap().point.xi_s;
        println!("u0 = {value}: {fold} beside {}", highest(value));
        assert!((highest(value) / fold - 1.0).abs() < 0.02, "u0 = {value}: {fold} beside {}", highest(value));
    }
}

/// Where two pitchforks meet, both end, and a later one is the first: the curve through the first pitchfork at one end of the range does
/// not lead to that at the other end.
#[test]
fn a_boundary_has_the_first_pitchforks_of_its_range() {
    let cell = Cell::new(5.4);
    let (numerics, tension) = (Numerics::default(), Parameter::Tension);
    let along = |folds: bool| match folds {
        true => curves::boundary_and_folds(&cell, &numerics, tension, [0.0, 1.0], None),
        false => curves::boundary_curves(&cell, &numerics, tension, [0.0, 1.0], None),
    };
    let [all, few] = [true, false].map(|folds| along(folds).unwrap().pitchforks);
    for (curves, values) in [(all, &[0.0, 0.2, 0.5, 0.75, 1.0][..]), (few, &[0.0, 1.0])] {
        for value in values {
            let mut cell = cell.clone();
            tension.set(&mut cell, *value);
            let first = first(&cell).point.xi_s;
            let around = |ends: &&[CurvePoint]| (ends[0].value - value) * (ends[1].value - value) <= 0.0;
            let near = |ends: &[CurvePoint]| {
                let low = f64::min(ends[0].xi_s, ends[1].xi_s) - 1e-3;
                (low..=f64::max(ends[0].xi_s, ends[1].xi_s) + 1e-3).contains(&first)
            };
            let found = curves.iter().any(|curve| curve.points.windows(2).filter(around).any(near));
            assert!(found, "tension = {value}: {first}");
        }
    }
}

/// Points of a curve are the pitchforks found one at a time, and criticality changes where the coefficient vanishes.
#[test]
fn the_curve_of_pitchforks_agrees_with_single_ones() {
    let curve = curves::pitchfork_curve(&at(2.0, 0.87), &Numerics::default(), Parameter::R0, [1.5, 5.4]).unwrap();
    println!("{} points, {} iterations", curve.points.len(), curve.iterations);
    for point in curve.points.iter().step_by(9) {
        let single = first(&at(point.r0, 0.87));
        assert!((single.point.xi_s / point.xi_s - 1.0).abs() < 2e-8, "{point:?} {}", single.point.xi_s);
        let coefficient = point.coefficient.unwrap();
        assert!((single.coefficient / coefficient - 1.0).abs() < 1e-4, "{point:?} {}", single.coefficient);
    }
    let [degenerate] = curve.degenerate[..] else { panic!("{:?}", curve.degenerate) };
    println!("criticality changes at R0 = {:.8}, xi_s = {:.8}", degenerate.value, degenerate.xi_s);
    for (shift, expected) in [(-0.01, Criticality::Subcritical), (0.01, Criticality::Supercritical)] {
        assert_eq!(first(&at(degenerate.value + shift, 0.87)).criticality(), expected);
    }
}

/// A critical radius or confinement by continuation from elsewhere is where the pitchfork lies at the cell's own activity. The paper
/// prints ε_c = 0.895 at R0 = 2.22, which is 0.896 for this preset.
#[test]
fn critical_cells_have_their_pitchfork_at_their_own_activity() {
    for (cell, parameter, starts, expected, tolerance) in [
        (at(1.0, 0.87), Parameter::R0, &STARTS[..], 1.70632, 1e-4),
        (at(2.22, 0.87), Parameter::Epsilon, &[0.88], 0.895, 0.003),
    ] {
        let point = critical_value(&cell, parameter, starts);
        println!("{parameter} = {:.8}", point.value);
        assert!((point.value - expected).abs() < tolerance, "{point:?}");
        let mut critical = cell;
        parameter.set(&mut critical, point.value);
        assert!((first(&critical).point.xi_s - 25.0).abs() < 1e-7, "{point:?}");
    }
}

/// The normal form against the branch it describes, and the square-root law.
#[test]
fn asymmetric_branches_open_as_their_normal_form_says() {
    for (r0, epsilon) in [(1.64, 0.87), (2.0, 0.87), (2.22, 0.64), (2.22, 0.88)] {
        let cell = at(r0, epsilon);
        let pitchfork = first(&cell);
        let followed = asymmetric::follow(&pitchfork, &cell, &BranchOptions::default());
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
    let radii = CriticalRadii::new(&Numerics::default());
    let cell = |r0: f64, cue: &Cue| Cell::gao2026_thresholds(r0).with_cue(cue.clone());
    let radius = |cue: &Cue| radii.ends(&cell(0.5, cue)).unwrap().unwrap();
    let (bare, cued) = (radius(&Cue::none()), radius(&Cue::published()));
    assert_eq!((bare.kind, cued.kind), (BoundaryKind::Pitchfork, BoundaryKind::CuedFold));
    println!("critical radii: {:.8} without cue, {:.8} with", bare.critical_r0, cued.critical_r0);
    assert!(bare.critical_r0 < cued.critical_r0);
    for (cue, critical) in [(Cue::none(), bare.critical_r0), (Cue::published(), cued.critical_r0)] {
        let at = |factor: f64| cell(factor * critical, &cue);
        check_threshold(0.01, at);
        assert_eq!([0.99, 1.01].map(|factor| radii.ends(&at(factor)).unwrap().is_none()), [false, true]);
    }
}

/// At ε = 0.64 cells rest on the first sheet of their branch, which folds above their activity, on both sides of the pitchfork.
#[test]
fn cells_that_rest_above_their_critical_radius_are_told() {
    let told = |epsilon: f64, critical: f64| {
        let found = (BoundaryKind::Pitchfork, critical);
        critical::divides_above(&at(1.0, epsilon), &Numerics::default(), found, &critical::AXISYMMETRIC, None)
    };
    let error = told(0.64, 0.478335).unwrap_err().to_string();
    assert!(
        error.contains("division begins above the pitchfork at R0 = 0.478335: cells of 0.487902 rest too"),
        "{error}"
    );
    assert!(told(0.87, 1.720757).is_ok());
}
