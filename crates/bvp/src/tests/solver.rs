//! The driver: layers known in closed form, and how it ends.

use super::problems::SecondOrder;
use crate::{
    BoundaryJacobian, BoundaryValueProblem, CollocationPoint, Dimensions, Gauss, NewtonError, PointJacobian, Settings,
    Solution, SolveError, TooLarge, mesh, solve,
};

/// ε y″ = a y + b y y′ + c y′ with y given at both ends, as (y, y′).
struct Layer {
    epsilon: f64,
    /// (a, b, c).
    terms: [f64; 3],
    ends: [f64; 2],
}

impl BoundaryValueProblem for Layer {
    fn dimensions(&self) -> Dimensions {
        Dimensions { components: 2, integrable: 1, scalars: 0, left: 1, right: 1, integrals: 0 }
    }

    fn rhs(&self, _: CollocationPoint, y: &[f64], _: &[f64], f: &mut [f64], _: &mut [f64]) {
        let [a, b, c] = self.terms;
        f.copy_from_slice(&[y[1], (a * y[0] + b * y[0] * y[1] + c * y[1]) / self.epsilon]);
    }

    fn rhs_jacobian(&self, at: CollocationPoint, y: &[f64], p: &[f64], out: &mut PointJacobian<'_>) {
        let [a, b, c] = self.terms;
        self.rhs(at, y, p, out.f, out.g);
        out.fy.copy_from_slice(&[0.0, 1.0, (a + b * y[1]) / self.epsilon, (b * y[0] + c) / self.epsilon]);
    }

    fn left(&self, y: &[f64], _: &[f64], out: &mut BoundaryJacobian<'_>) {
        (out.r[0], out.ry[0]) = (y[0] - self.ends[0], 1.0);
    }

    fn right(&self, y: &[f64], _: &[f64], out: &mut BoundaryJacobian<'_>) {
        (out.r[0], out.ry[0]) = (y[0] - self.ends[1], 1.0);
    }
}

/// The straight line between the ends.
fn line(ends: [f64; 2], m: usize, intervals: usize) -> Solution {
    let slope = ends[1] - ends[0];
    let value = |x: f64, y: &mut [f64]| y.copy_from_slice(&[ends[0] + slope * x, slope]);
    Solution::from_fn(&Gauss::new(m), &mesh::uniform(0.0, 1.0, intervals), 2, &[], value)
}

/// Largest error of y between the nodes as well.
fn error(y: &Solution, exact: impl Fn(f64) -> f64) -> f64 {
    let (gauss, mut value, mut largest) = (Gauss::new(y.m), [0.0; 2], 0.0f64);
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
    for epsilon in [1e-1, 1e-2, 1e-3, 1e-4f64] {
        for m in [2, 3, 4] {
            // ε y″ + y′ = 0: a layer of width ε at 0.
            let mut problem = Layer { epsilon, terms: [0.0, 0.0, -1.0], ends: [0.0, 1.0] };
            let settings = Settings { tolerance: 1e-7, ..Settings::default() };
            let guess = line(problem.ends, m, 10);
            let solved = solve(&mut problem, &guess, &settings).unwrap();
            let exact = |x: f64| (1.0 - (-x / epsilon).exp()) / (1.0 - (-1.0 / epsilon).exp());
            assert!(solved.defect <= settings.tolerance);
            let error = self::error(&solved.solution, exact);
            assert!(error < 10.0 * settings.tolerance, "{epsilon} {m}: {error:.1e}");
            // ε y″ = y: layers of width √ε at both ends.
            let mut problem = Layer { epsilon, terms: [1.0, 0.0, 0.0], ends: [1.0, 1.0] };
            let guess = line(problem.ends, m, 10);
            let solved = solve(&mut problem, &guess, &settings).unwrap();
            let decay = |x: f64| (-x / epsilon.sqrt()).exp();
            let exact = |x: f64| (decay(x) + decay(1.0 - x)) / (1.0 + decay(1.0));
            let error = self::error(&solved.solution, exact);
            assert!(error < 10.0 * settings.tolerance, "{epsilon} {m}: {error:.1e}");
        }
    }
}

#[test]
fn a_shock_inside_is_found() {
    // ε y″ = y y′ is solved by −tanh((x − ½)/2ε). Thinner shocks are held in place by less than rounding: the condition is
    // of order exp(1/2ε).
    for epsilon in [0.1, 0.05, 0.03f64] {
        let exact = |x: f64| -((x - 0.5) / (2.0 * epsilon)).tanh();
        let mut problem = Layer { epsilon, terms: [0.0, 1.0, 0.0], ends: [exact(0.0), exact(1.0)] };
        let guess = line(problem.ends, 4, 10);
        let solved = solve(&mut problem, &guess, &Settings::default()).unwrap();
        let error = error(&solved.solution, exact);
        assert!(error < 1e-5, "{epsilon}: {error:.1e}");
    }
}

#[test]
fn a_limit_of_intervals_is_an_error_with_the_best_solution() {
    let mut problem = Layer { epsilon: 1e-3, terms: [0.0, 0.0, -1.0], ends: [0.0, 1.0] };
    let settings = Settings { tolerance: 1e-12, max_intervals: 40, ..Settings::default() };
    let guess = line(problem.ends, 3, 10);
    let outcome = solve(&mut problem, &guess, &settings);
    let Err(SolveError::MeshLimit { limit: 40, best }) = &outcome else { panic!("{outcome:?}") };
    assert!(best.solution.intervals() <= 40 && best.defect > settings.tolerance && best.work.steps > 1);
    // What is kept is a solution to the accuracy it says.
    let exact = |x: f64| 1.0 - (-x * 1e3).exp();
    assert!(error(&best.solution, exact) < 10.0 * best.defect, "{:.1e}", best.defect);
}

#[test]
fn a_right_hand_side_that_is_undefined_between_the_stages_is_not_accepted() {
    // y″ = 0 but for a force that is not a number next to x = 0, where no stage lies.
    struct Hole;
    impl BoundaryValueProblem for Hole {
        fn dimensions(&self) -> Dimensions {
            SecondOrder::quadratic().dimensions()
        }
        fn rhs(&self, at: CollocationPoint, y: &[f64], _: &[f64], f: &mut [f64], _: &mut [f64]) {
            f.copy_from_slice(&[y[1], if at.x < 1e-3 { f64::NAN } else { 0.0 }]);
        }
        fn rhs_jacobian(&self, at: CollocationPoint, y: &[f64], p: &[f64], out: &mut PointJacobian<'_>) {
            self.rhs(at, y, p, out.f, out.g);
            out.fy[1] = 1.0;
        }
        fn left(&self, y: &[f64], _: &[f64], out: &mut BoundaryJacobian<'_>) {
            (out.r[0], out.ry[0]) = (y[0], 1.0);
        }
        fn right(&self, y: &[f64], _: &[f64], out: &mut BoundaryJacobian<'_>) {
            (out.r[0], out.ry[0]) = (y[0] - 1.0, 1.0);
        }
    }
    // With three stages the first is at 0.1127 h: above the hole for h = 1/100, and the sample at half of it is not.
    let outcome = solve(&mut Hole, &line([0.0, 1.0], 3, 100), &Settings::default());
    let Err(SolveError::Newton { source: NewtonError::NonFinite { .. }, best: Some(best), .. }) = outcome else {
        panic!("{outcome:?}")
    };
    assert_eq!(best.defect, f64::INFINITY);
}

#[test]
fn a_problem_without_solution_is_said_to_have_none() {
    let mut problem = SecondOrder::bratu(5.0);
    let outcome = solve(&mut problem, &line([0.0, 0.0], 3, 8), &Settings::default());
    let Err(SolveError::Newton { intervals: 32, source: NewtonError::Stalled { .. }, best: None }) = outcome else {
        panic!("{outcome:?}")
    };
}

#[test]
fn problems_and_guesses_that_do_not_fit_are_refused() {
    let mut problem = SecondOrder::quadratic();
    let guess = Solution { m: 7, ..line([4.0, 1.0], 3, 4) };
    let outcome = solve(&mut problem, &guess, &Settings::default());
    assert_eq!(outcome, Err(SolveError::TooLarge(TooLarge::Stages { stages: 7 })));
    let guess = Solution { scalars: vec![1.0], ..line([4.0, 1.0], 3, 4) };
    let outcome = solve(&mut problem, &guess, &Settings::default());
    assert_eq!(outcome, Err(SolveError::Guess { components: 2, scalars: 1 }));
}
