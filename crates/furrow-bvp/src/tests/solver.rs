//! The driver: layers known in closed form, and errors.

use super::cash_mazzia::{self, largest_difference};
use super::problems::{bratu, layer, quadratic};
use super::second_order::SecondOrder;
use crate::{Gauss, InvalidInput, NewtonError, Place, Settings, Solution, SolveError, Solved, TooLarge, mesh, solve};

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
fn linear_problems_take_one_solve_on_a_mesh() {
    for number in 1..=18 {
        let mut problem = cash_mazzia::problem(number, 1e-2).unwrap();
        let guess = problem.line(4, 10);
        let Ok(solved) = solve(&mut problem, &guess, &Settings::default()) else {
            // Problem 17 is singular there.
            assert_eq!(number, 17);
            continue;
        };
        let work = solved.work;
        assert_eq!(work.factorisations, work.steps, "{number}");
        // Problem 9 has values of 100, and rounding leaves a residual on one mesh. A second solve confirms that step.
        assert_eq!(work.iterations, work.steps + usize::from(number == 9), "{number}");
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
    // The solution moves with the value given at the right end, all along the interval.
    assert!((1.0..10.0).contains(&best.condition), "{:.1e}", best.condition);
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
    let Err(SolveError::Newton { source: NewtonError::Undefined { place, .. }, best: Some(best), .. }) = outcome else {
        panic!("{outcome:?}")
    };
    assert_eq!(best.defect, f64::INFINITY);
    let Place::Rhs { component: 1, x } = place else { panic!("{place}") };
    assert!(x < 1e-3, "{x}");
    assert_eq!(place.to_string(), "component 1 of the right-hand side at x = 7.043854e-5");
}

#[test]
fn a_problem_without_solution_is_an_error() {
    // Halved as long as the limit allows.
    let settings = Settings { max_intervals: 200, ..Settings::default() };
    let outcome = from_line(&mut bratu(5.0), 3, 8, &settings);
    let Err(SolveError::Newton { intervals: 128, source: NewtonError::Stalled { .. }, best: None }) = outcome else {
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

/// A problem of Cash and Mazzia from the straight line on ten equal intervals.
fn test_problem(number: usize, epsilon: f64) -> (cash_mazzia::TestProblem, Result<Solved, SolveError>) {
    let mut problem = cash_mazzia::problem(number, epsilon).unwrap();
    let guess = problem.line(4, 10);
    let outcome = solve(&mut problem, &guess, &Settings::default());
    (problem, outcome)
}

#[test]
fn test_problems_with_known_solutions_are_solved() {
    for (number, epsilon) in [(2, 1e-4), (4, 1e-4), (6, 1e-3), (7, 1e-4), (9, 1e-3), (12, 1e-4), (17, 1e-4), (21, 1e-4)]
    {
        let (problem, outcome) = test_problem(number, epsilon);
        let solved = outcome.unwrap();
        let error = problem.error(&solved).unwrap();
        assert!(error < 1e-6 && solved.defect <= 1e-6, "{number} {epsilon}: {error:.1e}");
    }
}

#[test]
fn layers_of_a_hundred_millionth_of_the_interval_are_found_from_a_line() {
    // At the left or right end, of width ε = 1e-8; in the problems 6, 7 and 10 at a turning point x = 0, of width √ε.
    for number in [2, 4, 6, 7, 8, 10, 18] {
        let (problem, outcome) = test_problem(number, 1e-8);
        let solved = outcome.unwrap();
        let (error, intervals) = (problem.error(&solved).unwrap(), solved.solution.intervals());
        assert!(error < 1e-6 && solved.defect <= 1e-6, "{number}: {error:.1e}");
        assert!(intervals < 1000 && solved.work.factorisations < 20, "{number}: {intervals} {:?}", solved.work);
    }
}

#[test]
fn thin_layers_are_followed_on_few_intervals() {
    // A turning point, two corners, and shocks inside.
    for number in [6, 7, 20, 24, 26, 30] {
        let (mut epsilon, mut y) = (0.1, test_problem(number, 0.1).1.unwrap().solution);
        while epsilon > 1e-8 {
            epsilon = f64::max(1e-8, 0.5 * epsilon);
            let mut problem = cash_mazzia::problem(number, epsilon).unwrap();
            y = solve(&mut problem, &y, &Settings::default()).unwrap().solution;
            assert!(y.intervals() < 1200, "{number} at {epsilon:.0e}: {}", y.intervals());
        }
    }
}

#[test]
fn a_homotopy_leads_to_layers_that_newton_does_not_find() {
    // A corner of width ε that starts at an end and ends at 0.745.
    let (problem, outcome) = test_problem(20, 1e-3);
    let solved = outcome.unwrap();
    assert!(problem.error(&solved).unwrap() < 1e-6 && solved.work.rejected >= 3, "{:?}", solved.work);
    // Layers that reach zero inside; their outer solutions are y = 1 − …, 0 and x − 2/3.
    let (_, outcome) = test_problem(27, 1e-4);
    let y = outcome.unwrap().solution;
    let outer = |x: f64| if x > 0.7 { x - 2.0 / 3.0 } else { f64::NAN };
    let mut value = [0.0; 2];
    y.eval(&Gauss::default(), 0.8, &mut value);
    assert!((value[0] - outer(0.8)).abs() < 1e-3, "{value:?}");
}

/// u″ + k²u = 1, u(0) = u(1) = 0, singular for k = π.
fn resonator(k: f64) -> SecondOrder {
    SecondOrder { force: Box::new(move |_, [u, _]| [1.0 - k * k * u, -k * k, 0.0]), ends: [0.0; 2] }
}

#[test]
fn a_singular_problem_is_said_to_be_singular() {
    for m in 2..=5 {
        // No solution at all.
        let outcome = from_line(&mut resonator(std::f64::consts::PI), m, 10, &Settings::default());
        let Err(SolveError::Singular { condition, .. }) = outcome else { panic!("{m}: {outcome:?}") };
        assert!(condition > 1e6, "{condition:.1e}");
    }
    // At ε = 1e-2 the seventeenth problem has a second solution that vanishes at both ends, √ε = 0.1 from the middle.
    let (_, outcome) = test_problem(17, 1e-2);
    let Err(SolveError::Singular { condition, .. }) = outcome else { panic!("{outcome:?}") };
    assert!(condition.is_finite() && condition > 1e12, "{condition:.1e}");
}

#[test]
fn the_condition_doubles_where_the_distance_to_a_singular_problem_is_halved() {
    let condition = |distance: f64| {
        let solved = from_line(&mut resonator(std::f64::consts::PI + distance), 4, 10, &Settings::default());
        solved.unwrap().condition
    };
    let ratio = condition(1e-3) / condition(2e-3);
    assert!((ratio - 2.0).abs() < 0.1, "{ratio}");
    assert!(condition(1.0) < 10.0);
}

#[test]
fn an_accuracy_beyond_rounding_ends_with_the_best_solution() {
    let settings = Settings { tolerance: 1e-17, max_intervals: 100_000, ..Settings::default() };
    let outcome = from_line(&mut layer(0.1, [1.0, 0.0, 0.0], [1.0, 0.0]), 4, 10, &settings);
    let Err(SolveError::Rounding { best }) = outcome else { panic!("{outcome:?}") };
    assert!(best.defect < 1e-13 && best.solution.intervals() < 20_000, "{:.1e}", best.defect);
    // A layer of width exp(−50) next to x = 1, where numbers are 1e-16 apart.
    let mut troesch = cash_mazzia::problem(23, 1e-2).unwrap();
    let guess = troesch.line(4, 10);
    assert!(solve(&mut troesch, &guess, &Settings::default()).is_err());
}

#[test]
fn a_mesh_that_is_too_fine_is_coarsened() {
    let mut problem = layer(0.1, [1.0, 0.0, 0.0], [1.0, 0.0]);
    let settings = Settings::default();
    let solved = from_line(&mut problem, 4, 500, &settings).unwrap();
    assert!(solved.solution.intervals() < 50 && solved.defect <= settings.tolerance, "{}", solved.solution.intervals());
    let exact = |x: f64| ((1.0 - x) / 0.1f64.sqrt()).sinh() / (1.0 / 0.1f64.sqrt()).sinh();
    assert!(largest_difference(&solved, exact) < 1e-6);
}

#[test]
fn the_error_is_bounded_where_it_is_asked_for() {
    let allowed = 1e-9;
    let (mut all, mut by_defect_alone) = (0, 0);
    for (number, epsilon) in (1..=21).flat_map(|number| [1e-1, 1e-2, 1e-3].map(|epsilon| (number, epsilon))) {
        let by = |error| {
            let mut problem = cash_mazzia::problem(number, epsilon)?;
            let guess = problem.line(4, 10);
            let settings = Settings { tolerance: 1e-4, error, ..Settings::default() };
            let solved = solve(&mut problem, &guess, &settings).ok()?;
            Some((problem.error(&solved)?, solved.error))
        };
        let (Some((error, Some(estimate))), Some((rough, None))) = (by(Some(allowed)), by(None)) else { continue };
        assert!(error <= estimate && estimate <= allowed, "{number} at {epsilon}: {error:.1e} {estimate:.1e}");
        (all, by_defect_alone) = (all + 1, by_defect_alone + usize::from(rough <= allowed));
    }
    assert!(all > 50 && by_defect_alone < 5, "{by_defect_alone} of {all}");
    // Where the equation is stiff and the solution smooth, the defect is 1e8 times the error.
    for number in [3, 5] {
        let mut problem = cash_mazzia::problem(number, 1e-8).unwrap();
        let guess = problem.line(4, 10);
        let by = Settings { tolerance: 1e3, error: Some(1e-6), ..Settings::default() };
        let solved = solve(&mut problem, &guess, &by).unwrap();
        assert!(solved.defect > 1e-6 && problem.error(&solved).unwrap() < 1e-9, "{number}: {:.1e}", solved.defect);
    }
    // Too few intervals for a second solution.
    let settings = Settings { tolerance: 1e-3, error: Some(1e-6), max_intervals: 15, ..Settings::default() };
    let outcome = from_line(&mut layer(0.1, [0.0, 0.0, -1.0], [0.0, 1.0]), 4, 10, &settings);
    let message = outcome.as_ref().unwrap_err().to_string();
    assert!(message.contains("15 intervals is reached before the bound on the error"), "{message}");
    let refused =
        from_line(&mut layer(0.1, [0.0, 0.0, -1.0], [0.0, 1.0]), 4, 10, &Settings { error: Some(0.0), ..settings });
    assert!(matches!(refused, Err(SolveError::Invalid(InvalidInput::Setting { .. }))), "{refused:?}");
}
