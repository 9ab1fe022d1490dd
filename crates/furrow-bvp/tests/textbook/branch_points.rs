//! Branch points without mirror symmetry: AUTO's `bvp`, the elastica on the whole interval and with an integral condition, and a
//! branch that a coarse mesh knows only nearly.

use std::f64::consts::PI;

use furrow_bvp::{
    BranchPoint, BranchPointKind, Continuation, ContinuationSettings, Directional, Metric, Solution, Termination,
    locate,
};

use super::oscillator::Oscillator;

#[path = "../../examples/problems/auto_bvp.rs"]
mod auto_bvp;
#[path = "held.rs"]
mod held;

use auto_bvp::AutoBvp;
use held::Held;

fn start<P: Directional>(problem: P, guess: Solution, max_step: f64) -> Continuation<P> {
    let metric = Metric::unit(2, guess.scalars.len());
    let settings = ContinuationSettings { max_step, ..ContinuationSettings::default() };
    Continuation::start(problem, guess, metric, settings, true).unwrap()
}

/// Follows a branch up to a bound; the branch points on the way.
fn points_up_to<P: Directional>(branch: &mut Continuation<P>, bound: f64) -> Vec<BranchPoint> {
    let mut points = Vec::new();
    let ended = branch.follow([f64::NEG_INFINITY, bound], 2000, |branch, advance| {
        if advance.passed_branch_point {
            points.push(locate::branch_point(branch).unwrap());
        }
        true
    });
    assert_eq!(ended.unwrap(), Termination::ParameterBound(bound));
    points
}

/// The crossing branch to either side, after a few steps.
fn sides<P: Directional + Clone>(branch: &mut Continuation<P>, point: &BranchPoint) -> [Solution; 2] {
    [true, false].map(|forwards| {
        let state = point.switch(branch, forwards).unwrap();
        assert!(state.arclength > 0.0 && state.arclength <= branch.settings.first_step);
        let mut crossing =
            Continuation::resume(branch.problem.clone(), state, branch.metric.clone(), branch.settings.clone());
        for _ in 0..5 {
            assert!(!crossing.advance().unwrap().passed_branch_point);
        }
        crossing.state.solution
    })
}

/// K(k), the complete elliptic integral of the first kind, by the arithmetic-geometric mean.
fn elliptic(k: f64) -> f64 {
    let (mut a, mut b) = (1.0, (1.0 - k * k).sqrt());
    for _ in 0..8 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    0.5 * PI / a
}

/// A branch of few steps, so that the branch points are most of the work. u = 0 is crossed at λ = n. With u = a sin nπx + … there, λ = n + 4a/(3π³n²) for odd n, and λ = n + 5a²/(12π⁴n³) for even n.
#[test]
fn the_branch_points_of_autos_bvp_are_transcritical_and_pitchforks_in_turn() {
    let mut branch = start(AutoBvp::PERFECT, AutoBvp::PERFECT.guess(48, 0.5), 0.5);
    let points = points_up_to(&mut branch, 5.5);
    let work = branch.work;
    assert!(work.steps < 16 && 2 * work.factorisations <= 5 * work.steps, "{work:?}");
    assert_eq!(points.len(), 5);
    for (n, point) in (1..).zip(&points) {
        let odd = n % 2 == 1;
        let n = f64::from(n);
        assert!((point.parameter() - n).abs() < 1e-8, "{n}: {}", point.parameter());
        assert!((point.arclength - (n - 0.5)).abs() < 1e-6, "{n}: {}", point.arclength);
        assert!(point.gap < 1e-5, "{n}: {}", point.gap);
        let [before, after] = sides(&mut branch, point);
        assert!(before.nodes[1] * after.nodes[1] < 0.0);
        let shifts = [&before, &after].map(|y| y.scalars[0] - n);
        let slope = point.tangents[1].scalars[0];
        // a of the unit tangent, u′(0) = nπa.
        let a = point.tangents[1].nodes[1] / (n * PI);
        if odd {
            assert_eq!(point.kind(), BranchPointKind::Transcritical);
            assert!((slope / a / (4.0 / (3.0 * PI.powi(3) * n * n)) - 1.0).abs() < 1e-6, "{n}: {}", slope / a);
            assert!(shifts[0] * shifts[1] < 0.0, "{n}: {shifts:?}");
        } else {
            assert_eq!(point.kind(), BranchPointKind::SupercriticalPitchfork);
            let c = point.curvatures[1] / (a * a);
            assert!((c / (5.0 / (12.0 * PI.powi(4) * n.powi(3))) - 1.0).abs() < 1e-5, "{n}: {c}");
            assert!(shifts[0] > 0.0 && shifts[1] > 0.0, "{n}: {shifts:?}");
        }
    }
}

/// u = 0 is crossed at λ = (nπ)²; with u = a sin nπx + … there, λ grows by a²/8 of itself. A buckled rod has
/// λ = (2nK(k))² with 2k√λ = |u′(0)|. Every step of the straight rod needs a factorisation; branch points may double that.
#[test]
fn the_whole_elastica_buckles_in_five_pitchforks_that_are_switched_at() {
    let problem = Oscillator::elastica(0);
    let mut branch = start(problem.clone(), problem.zero(1.0, 48, 4, 5.0), 12.0);
    let points = points_up_to(&mut branch, 260.0);
    let work = branch.work;
    assert!(work.factorisations <= 2 * work.steps, "{work:?}");
    assert_eq!(points.len(), 5);
    for (n, point) in (1..).zip(&points) {
        let n = f64::from(n);
        let exact = (n * PI).powi(2);
        assert!((point.parameter() - exact).abs() < 1e-8, "{n}: {} {exact}", point.parameter());
        assert_eq!(point.kind(), BranchPointKind::SupercriticalPitchfork);
        let a = point.tangents[1].nodes[1] / (n * PI);
        let c = point.curvatures[1] / (a * a);
        assert!((c / (exact / 8.0) - 1.0).abs() < 1e-6, "{n}: {c}");
        let ends = sides(&mut branch, point);
        assert!(ends[0].nodes[1] * ends[1].nodes[1] < 0.0);
        for y in ends {
            let lambda = y.scalars[0];
            let k = y.nodes[1].abs() / (2.0 * lambda.sqrt());
            assert!(k > 0.01, "{n}: {k}");
            assert!(((2.0 * n * elliptic(k)).powi(2) / lambda - 1.0).abs() < 1e-8, "{n}: {lambda}");
        }
    }
}

/// u″ + λ sin u + μ = 0 with u = 0 at both ends and ∫ u = 0: the straight rod is crossed at (2π)², at (4π)² and, in between, at
/// λ = ω² with tan ω/2 = ω/2.
#[test]
fn branch_points_are_found_with_integral_conditions_and_further_unknowns() {
    let mut branch = start(Held, Held::guess(48, 20.0), 8.0);
    let points = points_up_to(&mut branch, 170.0);
    let mut half: f64 = 4.49;
    for _ in 0..20 {
        half -= (half.tan() - half) / half.tan().powi(2);
    }
    let exact = [4.0 * PI * PI, 4.0 * half * half, 16.0 * PI * PI];
    assert_eq!(points.len(), exact.len());
    for (point, exact) in points.iter().zip(exact) {
        assert!((point.parameter() - exact).abs() < 1e-8, "{} {exact}", point.parameter());
        assert_eq!(point.kind(), BranchPointKind::SupercriticalPitchfork);
        let [one, other] = sides(&mut branch, point);
        assert!(one.nodes[1] * other.nodes[1] < 0.0 && one.scalars[1] > exact);
    }
}

/// The branch that crosses a pitchfork goes through it as well: there λ has an extremum on the branch followed.
#[test]
fn a_pitchfork_is_passed_along_the_branch_that_bends_too() {
    let problem = Oscillator::elastica(0);
    let mut straight = start(problem.clone(), problem.zero(1.0, 24, 4, 5.0), 4.0);
    let point = points_up_to(&mut straight, 14.0).remove(0);
    let state = point.switch(&mut straight, true).unwrap();
    let mut bent = Continuation::resume(problem, state, straight.metric.clone(), straight.settings.clone());
    bent.follow([0.0, 12.0], 100, |_, _| true).unwrap();
    bent.reverse();
    let points = points_up_to(&mut bent, 12.5);
    assert_eq!(points.len(), 1);
    assert!((points[0].parameter() - PI * PI).abs() < 1e-8, "{}", points[0].parameter());
    assert_eq!(points[0].kind(), BranchPointKind::SupercriticalPitchfork);
    assert!(points[0].slopes()[0].abs() < 1e-8 && points[0].slopes()[1].abs() > 0.99, "{:?}", points[0].slopes());
}

/// u = q is a solution for all λ, but polynomials approximate q: on a mesh the branches do not meet. This gap shrinks as the mesh is
/// refined, and the branch goes on; the gap of an imperfect problem stays, and the branch does not go on.
#[test]
fn a_gap_of_the_mesh_is_passed_and_one_of_the_problem_is_not() {
    let profile = |x: f64| {
        let (sine, cosine) = (3.0 * PI * x).sin_cos();
        let bent = (3.0 * PI).powi(2);
        [sine * sine * sine, 6.0 * bent * sine * cosine * cosine - 3.0 * bent * sine * sine * sine]
    };
    let meshed = AutoBvp { profile, imperfection: 0.0 };
    let mut branch = start(meshed.clone(), meshed.guess(10, 0.5), 0.1);
    let points = points_up_to(&mut branch, 1.4);
    assert_eq!(points.len(), 1);
    assert_eq!(points[0].kind(), BranchPointKind::Transcritical);
    assert!((points[0].parameter() - 1.0).abs() < 1e-3, "{}", points[0].parameter());
    assert!(points[0].gap > 1e-4, "{}", points[0].gap);
    for imperfection in [1e-6, -1e-6] {
        let imperfect = AutoBvp { imperfection, ..AutoBvp::PERFECT };
        let mut branch = start(imperfect.clone(), imperfect.guess(10, 0.5), 0.1);
        let mut far = 0.0;
        let ended = branch.follow([0.4, 1.02], 2000, |branch, advance| {
            assert!(!advance.passed_branch_point);
            far = branch.state.solution.nodes[1].abs();
            true
        });
        ended.unwrap();
        assert!(far > 0.1, "{imperfection}: u'(0) = {far}");
    }
}
