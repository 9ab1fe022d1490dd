//! How many intervals a tolerance takes along a branch.

use furrow_bvp::{
    Continuation, ContinuationError, ContinuationSettings, DualNum, Metric, SimpleProblem, Solution, Termination,
    locate, mesh,
};

/// The branch of a problem y′ = f(x, y, λ) with one condition at each end from zero at λ = 0.
fn branch(problem: SimpleProblem, tolerance: f64, max_intervals: usize) -> Continuation<SimpleProblem> {
    let guess = Solution::constant(4, &mesh::uniform(0.0, 1.0, 10), &[0.0, 0.0], &[0.0]);
    let settings = ContinuationSettings { tolerance: Some(tolerance), max_intervals, ..Default::default() };
    Continuation::start(problem, guess, Metric::unit(2, 1), settings, true).unwrap()
}

/// Gelfand's problem in the unit ball with its centre, where the equation is singular, at the given end.
fn ball(centre: f64) -> SimpleProblem {
    let sign = 1.0 - 2.0 * centre;
    SimpleProblem::new(2, move |x, y, p, f| {
        f[0] = y[1] * sign;
        f[1] = -(y[1] * (2.0 / (x - centre).abs()) + p[0] * y[0].exp()) * sign;
    })
    .scalars(1)
    .left_conditions(1, move |y, _, r| r[0] = y[1 - centre as usize])
    .right_conditions(1, move |y, _, r| r[0] = y[centre as usize])
}

/// The example `gelfand` prints the same values.
#[test]
fn a_singular_centre_takes_no_more_intervals_than_the_peak_there() {
    for centre in [0.0, 1.0] {
        let mut branch = branch(ball(centre), 1e-7, 2000);
        for (exact, most) in [(3.321_992_118, 30), (1.664_156_190, 90), (2.108_541_102, 150)] {
            let ended = branch.follow([0.0, 10.0], 100, |_, advance| !advance.passed_fold);
            assert_eq!(ended, Ok(Termination::Stopped));
            let fold = locate::last_fold(&mut branch).unwrap().solution;
            assert!((fold.scalars[0] - exact).abs() < 1e-8, "{} {exact}", fold.scalars[0]);
            assert!(fold.intervals() <= most, "{} {most}", fold.intervals());
        }
    }
}

/// Bratu's problem up to λ = 1.
#[test]
fn a_point_on_a_bound_takes_no_more_intervals_than_those_before_it() {
    let problem = SimpleProblem::new(2, |_, y, p, f| (f[0], f[1]) = (y[1], -p[0] * y[0].exp()))
        .scalars(1)
        .left_conditions(1, |y, _, r| r[0] = y[0])
        .right_conditions(1, |y, _, r| r[0] = y[0]);
    let (mut branch, mut intervals) = (branch(problem, 1e-8, 2000), Vec::new());
    let ended = branch.follow([0.0, 1.0], 100, |branch, _| {
        intervals.push(branch.state.solution.intervals());
        true
    });
    assert_eq!(ended, Ok(Termination::ParameterBound(1.0)));
    assert!(intervals.iter().all(|count| *count < 20), "{intervals:?}");
}

/// u″ = λ³u, u(0) = 0, u(1) = 1 has a layer of width λ^(−3/2), on fewer intervals than its tangent would take.
#[test]
fn intervals_that_do_for_the_points_alone_are_used_for_them() {
    let problem = SimpleProblem::new(2, |_, y, p, f| (f[0], f[1]) = (y[1], p[0].powi(3) * y[0]))
        .scalars(1)
        .left_conditions(1, |y, _, r| r[0] = y[0])
        .right_conditions(1, |y, _, r| r[0] = y[0] - 1.0);
    let mut branch = branch(problem, 1e-6, 30);
    let ended = branch.follow([0.0, 10.0], 300, |_, advance| advance.defect.is_some_and(|defect| defect <= 1e-6));
    assert_eq!(ended, Ok(Termination::ParameterBound(10.0)));
}

/// u″ = −λ sin(1/x)/x³ oscillates ever faster towards x = 0, which no mesh resolves.
#[test]
fn what_no_mesh_resolves_ends_with_the_place_in_few_digits() {
    let problem = SimpleProblem::new(2, |x, y, p, f| (f[0], f[1]) = (y[1], -p[0] * (1.0 / x).sin() / x.powi(3)))
        .scalars(1)
        .left_conditions(1, |y, _, r| r[0] = y[0])
        .right_conditions(1, |y, _, r| r[0] = y[0]);
    let mut branch = branch(problem, 1e-6, 400);
    let error = branch.follow([-1.0, 1.0], 100, |_, _| true).unwrap_err();
    assert!(matches!(error, ContinuationError::MeshLimit { .. }), "{error:?}");
    let message = error.to_string();
    assert!(message.len() < 200 && branch.state.solution.mesh[1] > 1e-14, "{message}");
}
