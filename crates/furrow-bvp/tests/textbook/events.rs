//! Singular points and the estimates of their errors.

use std::f64::consts::PI;

use furrow_bvp::{
    Continuation, ContinuationSettings, Metric, MinimallyAugmented, SymmetryBreaking, Termination, locate,
};

use super::oscillator::{Force, Oscillator};

/// u″ + λ(u + u³) = 0: branches cross u = 0 at λ = (kπ)².
fn cubic(right: usize) -> Oscillator {
    Oscillator { force: Force::Of(|u| [u + u * u * u, 1.0 + 3.0 * u * u, 6.0 * u, 6.0]), right }
}

fn settings(tolerance: Option<f64>) -> ContinuationSettings {
    ContinuationSettings { tolerance, max_step: 5.0, ..Default::default() }
}

/// λ and its estimated error at all branch points of u = 0 up to λ = 1500.
fn branch_points(stages: usize, intervals: usize, tolerance: Option<f64>) -> Vec<[f64; 2]> {
    let (problem, mut found) = (cubic(0), Vec::new());
    let guess = problem.zero(1.0, intervals, stages, 5.0);
    let mut branch = Continuation::start(problem, guess, Metric::unit(2, 1), settings(tolerance), true).unwrap();
    let ended = branch.follow([0.0, 1500.0], 2000, |branch, advance| {
        if advance.passed_branch_point {
            let point = locate::branch_point(branch).unwrap();
            found.push([point.parameter(), point.error]);
        }
        true
    });
    assert_eq!(ended, Ok(Termination::ParameterBound(1500.0)));
    found
}

/// An estimate bounds the error, and is not far above it. What rounding does to both is of no interest.
fn check_estimate(what: &str, error: f64, estimate: f64, rounding: f64) {
    assert!(error <= 1.5 * estimate + rounding, "{what}: {error:.1e}, estimated as {estimate:.1e}");
    assert!(estimate <= 10.0 * error + rounding, "{what}: {error:.1e}, estimated as {estimate:.1e}");
}

/// The zero solution has no defect on any mesh, its branch points have one. Without a tolerance the guess's mesh is used.
#[test]
fn all_branch_points_of_a_trivial_branch_are_found_with_their_errors() {
    for stages in [2, 3, 4] {
        for tolerance in [None, Some(1e-4), Some(1e-6)] {
            let found = branch_points(stages, 200, tolerance);
            assert_eq!(found.len(), 12, "{stages} stages, {tolerance:?}: {found:?}");
            for (k, [lambda, estimate]) in (1..).zip(found) {
                let exact = (f64::from(k) * PI).powi(2);
                let error = (lambda - exact).abs();
                let what = format!("{stages} stages, {tolerance:?}, point {k}");
                check_estimate(&what, error, estimate, 1e-9 * exact);
                let bound = tolerance.map_or(1e-4, |tolerance| 10.0 * tolerance);
                assert!(error < bound * exact, "{what}: {lambda} {exact}");
            }
        }
    }
}

/// A mesh of few intervals is refined before points are passed on it.
#[test]
fn a_coarse_guess_loses_no_branch_point_where_a_tolerance_is_set() {
    assert_eq!(branch_points(2, 10, Some(1e-5)).len(), 12);
}

/// The first fold of Bratu's problem, which is followed from λ = 0.
#[test]
fn a_fold_has_an_estimate_of_its_error() {
    let bratu = Oscillator::bratu();
    for (stages, intervals, tolerance) in [(1, 40, None), (2, 10, None), (3, 6, None), (2, 10, Some(1e-5))] {
        let guess = bratu.zero(1.0, intervals, stages, 0.0);
        let settings = ContinuationSettings { tolerance, ..Default::default() };
        let mut branch = Continuation::start(bratu.clone(), guess, Metric::unit(2, 1), settings, true).unwrap();
        branch.follow([-1.0, 10.0], 200, |_, advance| !advance.passed_fold).unwrap();
        let fold = locate::last_fold(&mut branch).unwrap();
        let error = (fold.solution.scalars[0] - super::bratu_fold()).abs();
        check_estimate(&format!("{stages} stages, {tolerance:?}"), error, fold.error, 1e-10);
    }
}

/// The first pitchfork of u = 0 with a null vector that is odd about the middle.
#[test]
fn a_pitchfork_has_an_estimate_of_its_error() {
    for (stages, intervals) in [(1, 40), (2, 10), (3, 6)] {
        let mut y = cubic(1).zero(0.5, intervals, stages, 38.0);
        let branch = Continuation::start(cubic(1), y.clone(), Metric::unit(2, 1), settings(None), true).unwrap();
        let Continuation { metric, state, .. } = branch;
        let breaking = SymmetryBreaking::default();
        let mut point = MinimallyAugmented::new(cubic(1), breaking, stages, metric, &state.tangent).unwrap();
        point.solve(&mut y, None).unwrap();
        let error = (y.scalars[0] - 4.0 * PI * PI).abs();
        check_estimate(&format!("{stages} stages"), error, point.error_estimate(&y, None), 1e-9);
    }
}
