//! The driver: layers known in closed form, and errors.

use super::problems::{bratu, layer, quadratic};
use super::second_order::SecondOrder;
use crate::{Gauss, InvalidInput, NewtonError, Settings, Solution, SolveError, Solved, TooLarge, mesh, solve};

/// Solves from the straight line between the ends on a uniform mesh.
fn from_line(problem: &mut SecondOrder, m: usize, intervals: usize, settings: &Settings) -> Result<Solved, SolveError> {
    let guess = problem.line(m, &mesh::uniform(0.0, 1.0, intervals));
    solve(problem, &guess, settings)
}

/// Largest error of y between the nodes as well.
fn error(y: &Solution, exact: impl Fn(f64) -> f64) -> f64 {
    let (gauss, mut value, mut largest) = (Gauss::new(y.m).unwrap(), [0.0; 2], 0.0f64);
    for i in 0..y.intervals() {
        for k in 0..=8 {
            let theta = k as f64 / 8.0;
            y.eval_in(&gauss, i, theta, &mut value);
            largest = largest.max((value[0] - exact(y.mesh[i] + theta * (y.mesh[i + 1] - y.mesh[i]))).abs());
        }
    }
    largest
}

#[test]
fn layers_are_resolved_however_thin() {
    let settings = Settings { tolerance: 1e-7, ..Settings::default() };
    for epsilon in [1e-1, 1e-2, 1e-3, 1e-4f64] {
        // ε y″ + y′ = 0: a layer of width ε at 0. ε y″ = y: layers of width √ε at both ends.
        let left = |x: f64| (1.0 - (-x / epsilon).exp()) / (1.0 - (-1.0 / epsilon).exp());
        let decay = |x: f64| (-x / epsilon.sqrt()).exp();
        let both = |x: f64| (decay(x) + decay(1.0 - x)) / (1.0 + decay(1.0));
        let cases: [(_, _, &dyn Fn(f64) -> f64); 2] =
            [([0.0, 0.0, -1.0], [0.0, 1.0], &left), ([1.0, 0.0, 0.0], [1.0, 1.0], &both)];
        for m in [2, 3, 4] {
            for (terms, ends, exact) in cases {
                let solved = from_line(&mut layer(epsilon, terms, ends), m, 10, &settings).unwrap();
                assert!(solved.defect <= settings.tolerance);
                let error = error(&solved.solution, exact);
                assert!(error < 10.0 * settings.tolerance, "{epsilon} {m}: {error:.1e}");
            }
        }
    }
}

#[test]
fn a_shock_inside_is_found() {
    // ε y″ = y y′ is solved by −tanh((x − ½)/2ε). Thinner shocks are held in place by less than rounding: the condition is
    // of order exp(1/2ε).
    for epsilon in [0.1, 0.05, 0.03f64] {
        let exact = |x: f64| -((x - 0.5) / (2.0 * epsilon)).tanh();
        let mut problem = layer(epsilon, [0.0, 1.0, 0.0], [exact(0.0), exact(1.0)]);
        let solved = from_line(&mut problem, 4, 10, &Settings::default()).unwrap();
        let error = error(&solved.solution, exact);
        assert!(error < 1e-5, "{epsilon}: {error:.1e}");
    }
}

#[test]
fn a_limit_of_intervals_is_an_error_with_the_best_solution() {
    let settings = Settings { tolerance: 1e-12, max_intervals: 40, ..Settings::default() };
    let outcome = from_line(&mut layer(1e-3, [0.0, 0.0, -1.0], [0.0, 1.0]), 3, 10, &settings);
    let Err(SolveError::MeshLimit { limit: 40, best }) = &outcome else { panic!("{outcome:?}") };
    assert!(best.solution.intervals() <= 40 && best.defect > settings.tolerance && best.work.steps > 1);
    // The best solution is as accurate as its defect says.
    let exact = |x: f64| 1.0 - (-x * 1e3).exp();
    assert!(error(&best.solution, exact) < 10.0 * best.defect, "{:.1e}", best.defect);
}

#[test]
fn a_right_hand_side_that_is_undefined_between_the_stages_is_not_accepted() {
    // y″ = 0 but for a force that is not a number next to x = 0, where no stage lies: with three stages the first is at
    // 0.1127 h, above the hole for h = 1/100, and the sample at half of it is not.
    let force = |x: f64, _: [f64; 2]| [if x < 1e-3 { f64::NAN } else { 0.0 }, 0.0, 0.0];
    let mut hole = SecondOrder { force: Box::new(force), ends: [0.0, 1.0] };
    let outcome = from_line(&mut hole, 3, 100, &Settings::default());
    let Err(SolveError::Newton { source: NewtonError::NonFinite { .. }, best: Some(best), .. }) = outcome else {
        panic!("{outcome:?}")
    };
    assert_eq!(best.defect, f64::INFINITY);
}

#[test]
fn a_problem_without_solution_is_an_error() {
    let outcome = from_line(&mut bratu(5.0), 3, 8, &Settings::default());
    let Err(SolveError::Newton { intervals: 32, source: NewtonError::Stalled { .. }, best: None }) = outcome else {
        panic!("{outcome:?}")
    };
}

#[test]
fn guesses_of_other_sizes_are_errors() {
    let guess = || quadratic().line(3, &mesh::uniform(0.0, 1.0, 4));
    for (guess, error) in [
        (Solution { m: 7, ..guess() }, TooLarge::Stages { stages: 7 }.into()),
        (
            Solution { scalars: vec![1.0], ..guess() },
            InvalidInput::Length { name: "scalars of the solution", length: 1, expected: 0 },
        ),
    ] {
        assert_eq!(solve(&mut quadratic(), &guess, &Settings::default()), Err(SolveError::Invalid(error)));
    }
}
