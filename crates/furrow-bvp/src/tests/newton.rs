//! Newton's iteration: how it fails, how fast it converges, and its reports.

use super::dense::unknowns;
use super::problems::{Counted, Initial, bratu, factored, solved};
use super::{distance, largest};
use crate::Direction;
use crate::newton::NewtonScratch;
use crate::{BoundaryValueProblem, Newton, NewtonError, NewtonReport, Place, Solution, System, mesh};

const M: usize = 3;

/// Solves from `y` with a workspace of its own.
fn solve<P: BoundaryValueProblem>(
    newton: Newton,
    problem: &mut P,
    y: &mut Solution,
) -> Result<NewtonReport, NewtonError> {
    let mut system = System::new(problem.dimensions(), y.m);
    newton.solve(&mut system, &mut NewtonScratch::default(), problem, y, &[], false)
}

/// The constant `value` on a uniform mesh of `intervals` on [0, 1].
fn constant(components: usize, intervals: usize, m: usize, value: f64) -> Solution {
    Solution::constant(m, &mesh::uniform(0.0, 1.0, intervals), &vec![value; components], &[])
}

/// y(x) = 0 by atan(1000 y(0)) = 0. Far from its root undamped Newton steps overshoot ever more, and with values this
/// small the weights 1 + |y| of the norm play no part.
fn steep() -> Initial {
    Initial { rate: -1.0, condition: |y| ((1e3 * y).atan(), 1e3 / (1.0 + 1e6 * y * y)) }
}

/// Errors that leave the start as it is: rate, condition, start with one stage or M, error.
#[test]
fn singular_systems_and_what_is_not_a_number_are_told_apart() {
    let singular = NewtonError::Singular { column: 0, iterations: 0 };
    let non_finite = |iterations| NewtonError::Undefined { place: Place::Left { index: 0 }, iterations };
    type Equation = fn(f64) -> (f64, f64);
    let cases: [(f64, Equation, usize, f64, NewtonError); 5] = [
        // y(0) is in no condition. The first row to be carried over is zero, whatever the interval does to it.
        (0.0, |_| (1.0, 0.0), 1, 0.5, singular),
        // With one stage D = 2: the stage equation (2 − h f′) δY = … is singular for f′ = 4 and h = 1/2, exactly.
        (4.0, |y| (y - 1.0, 1.0), 1, 0.5, singular),
        // In a derivative, met while factorising.
        (1.0, |_| (1.0, f64::NAN), M, 0.0, non_finite(0)),
        // In a residual, met after the first solve.
        (1.0, |_| (f64::NAN, 1.0), M, 0.0, non_finite(1)),
        // At every damped step: after the first solve factors 1, 1/2 … 1/512 are tried, the last one above 1/1000.
        (1.0, |y| (if y > 0.0 { f64::NAN } else { y - 1.0 }, 1.0), M, 0.0, non_finite(11)),
    ];
    for (rate, condition, stages, start, error) in cases {
        let mut y = constant(1, 2, stages, start);
        assert_eq!(solve(Newton::default(), &mut Initial { rate, condition }, &mut y), Err(error));
        assert_eq!(y, constant(1, 2, stages, start), "no step was accepted");
    }
}

#[test]
fn a_problem_without_solution_stalls() {
    // Beyond the fold at 3.5138 the residual has a smallest value that is not zero.
    let outcome = solve(Newton::default(), &mut bratu(5.0), &mut constant(2, 8, M, 0.0));
    let Err(NewtonError::Stalled { iterations, correction }) = outcome else { panic!("{outcome:?}") };
    assert!(iterations > 1 && correction > Newton::default().tolerance);
    assert!(solve(Newton::default(), &mut bratu(3.0), &mut constant(2, 8, M, 0.0)).is_ok());
}

#[test]
fn limits_of_work_stall() {
    let start = constant(1, 2, M, 0.01);
    for limit in 1..4 {
        let newton = Newton { max_iterations: limit, ..Newton::default() };
        let outcome = solve(newton, &mut steep(), &mut start.clone());
        assert!(matches!(outcome, Err(NewtonError::Stalled { iterations, .. }) if iterations == limit.max(2)));
        let newton = Newton { max_factorisations: limit - 1, ..Newton::default() };
        let mut problem = Counted::new(steep());
        let outcome = solve(newton, &mut problem, &mut start.clone());
        assert!(matches!(outcome, Err(NewtonError::Stalled { .. })), "{limit}: {outcome:?}");
        assert_eq!(problem.derivatives.get(), (limit - 1) * 2 * M);
    }
}

/// Sizes of undamped Newton steps until they are below 1e-13, at most `most`, by the linear system alone.
fn undamped<P: BoundaryValueProblem>(problem: &mut P, mut y: Solution, most: usize) -> Vec<f64> {
    let (mut sizes, mut step) = (Vec::new(), Direction::default());
    while sizes.len() < most && sizes.last().is_none_or(|s| *s > 1e-13) {
        factored(problem, &y, &[]).solve_own(&mut step).unwrap();
        step.apply(1.0, &mut y);
        sizes.push(step.norm(&y));
    }
    sizes
}

#[test]
fn newton_steps_shrink_quadratically() {
    // ln δ doubles from step to step once it is well below 0: with δ_{k+1} = C δ_k² the order seen differs from 2 by
    // ln C / ln δ_k. Steps below 1e-12 are roundings.
    let sizes = undamped(&mut bratu(2.0), constant(2, 6, M, 0.0), 10);
    let seen: Vec<f64> = sizes.iter().copied().filter(|s| *s > 1e-12).collect();
    assert!(seen.len() >= 4 && sizes.len() <= 7, "{sizes:?}");
    let [.., a, b, c] = seen[..] else { unreachable!() };
    let order = (c / b).ln() / (b / a).ln();
    assert!((order - 2.0).abs() < 0.3, "{order} {sizes:?}");
}

#[test]
fn each_factorisation_serves_for_two_steps_of_order_three_together() {
    // A Newton step and one simplified step with the same factors are Shamanskii's method, of order three (Kelley,
    // Iterative Methods for Linear and Nonlinear Equations, SIAM 1995, ch. 5). No further chord steps are allowed.
    let mut problem = bratu(2.0);
    let exact = solved(&mut problem, M, &mesh::uniform(0.0, 1.0, 6));
    let newton = Newton { chord_contraction: 0.0, tolerance: 1e-14, ..Newton::default() };
    let errors: Vec<f64> = (0..3)
        .map(|max_factorisations| {
            let mut y = constant(2, 6, M, 0.0);
            let outcome = solve(Newton { max_factorisations, ..newton }, &mut problem, &mut y);
            assert!(matches!(outcome, Err(NewtonError::Stalled { .. })), "{outcome:?}");
            distance(&unknowns(&y), &unknowns(&exact))
        })
        .collect();
    let order = (errors[2] / errors[1]).ln() / (errors[1] / errors[0]).ln();
    assert!(errors[2] > 1e-12 && (order - 3.0).abs() < 0.5, "{order} {errors:?}");
}

#[test]
fn a_start_from_which_undamped_steps_grow_needs_damping() {
    let start = constant(1, 2, M, 0.01);
    let sizes = undamped(&mut steep(), start.clone(), 3);
    assert!(sizes.windows(2).all(|s| s[1] > s[0]), "{sizes:?}");
    let mut y = start.clone();
    let mut problem = Counted::new(steep());
    let report = solve(Newton::default(), &mut problem, &mut y).unwrap();
    assert!(largest(&unknowns(&y)) <= Newton::default().tolerance);
    assert!(report.iterations > 2 * report.factorisations, "more than one trial for some step: {report:?}");
    // Without leave to damp the first step is refused, and nothing changes.
    let mut y = start.clone();
    let outcome = solve(Newton { min_damping: 1.0, ..Newton::default() }, &mut steep(), &mut y);
    assert!(matches!(outcome, Err(NewtonError::Stalled { iterations: 2, .. })), "{outcome:?}");
    assert_eq!(y, start);
}

#[test]
fn the_report_counts_solves_and_factorisations() {
    // Every linear solve follows one sweep over the mesh, every factorisation one sweep with derivatives.
    for (intervals, parameter) in [(4, 0.5), (6, 2.0), (8, 3.4)] {
        let mut problem = Counted::new(bratu(parameter));
        let report = solve(Newton::default(), &mut problem, &mut constant(2, intervals, M, 0.0)).unwrap();
        assert_eq!(report.iterations, problem.sweeps);
        assert_eq!(report.factorisations * intervals * M, problem.derivatives.get());
        assert!(report.iterations > report.factorisations, "{report:?}");
    }
}

#[test]
fn a_linear_problem_takes_one_factorisation_and_one_check() {
    let mut problem = Initial { rate: -1.0, condition: |y| (y - 2.0, 1.0) };
    let mut y = constant(1, 4, M, 0.0);
    let report = solve(Newton::default(), &mut problem, &mut y).unwrap();
    assert_eq!((report.factorisations, report.iterations), (1, 2));
    // The check finds what rounding left: a few units in the last place of values up to 2.
    assert!(report.last_correction < 100.0 * f64::EPSILON, "{report:?}");
    let report = solve(Newton::default(), &mut problem, &mut y).unwrap();
    assert_eq!((report.factorisations, report.iterations), (1, 1), "from the solution nothing is left to check");
}

#[test]
fn the_correction_reported_bounds_the_error_left() {
    for parameter in [0.5, 2.0, 3.4] {
        let mut problem = bratu(parameter);
        let exact = solved(&mut problem, M, &mesh::uniform(0.0, 1.0, 6));
        let newton = Newton { tolerance: 1e-5, ..Newton::default() };
        let mut y = constant(2, 6, M, 0.0);
        let report = solve(newton, &mut problem, &mut y).unwrap();
        let error = distance(&unknowns(&y), &unknowns(&exact)) / (1.0 + largest(&unknowns(&exact)));
        assert!(error <= newton.tolerance && error <= report.last_correction, "{error:.1e} {report:?}");
    }
}

/// The workspace with factors of the Bratu problem at `parameter`, and its solution there.
fn factors_nearby(parameter: f64) -> (System, Solution) {
    let mut problem = bratu(parameter);
    let y = solved(&mut problem, M, &mesh::uniform(0.0, 1.0, 6));
    (factored(&mut problem, &y, &[]), y)
}

#[test]
fn old_factors_do_for_a_nearby_problem() {
    let (mut system, mut y) = factors_nearby(2.0);
    let mut problem = Counted::new(bratu(2.01));
    let newton = Newton::default();
    let report = newton.solve(&mut system, &mut NewtonScratch::default(), &mut problem, &mut y, &[], true).unwrap();
    assert_eq!((report.factorisations, problem.derivatives.get()), (0, 0));
    assert_eq!(report.iterations, problem.sweeps);
    let exact = solved(&mut problem.inner, M, &y.mesh);
    // The norm is relative to 1 + |value|.
    assert!(distance(&unknowns(&y), &unknowns(&exact)) <= newton.tolerance * (1.0 + largest(&unknowns(&exact))));
}

#[test]
fn old_factors_that_do_not_contract_leave_no_trace() {
    // At 3.5 and 0.1 the derivatives differ too much for chord steps to contract.
    let (mut system, start) = factors_nearby(0.1);
    let mut problem = bratu(3.5);
    let mut scratch = NewtonScratch::default();
    let mut y = start.clone();
    let only_chords = Newton { max_factorisations: 0, ..Newton::default() };
    let outcome = only_chords.solve(&mut system.clone(), &mut scratch, &mut problem, &mut y, &[], true);
    assert!(matches!(outcome, Err(NewtonError::Stalled { .. })), "{outcome:?}");
    assert_eq!(y, start, "restored");
    // If it may factorise, the outcome is the same as of a fresh start, except for the wasted solves.
    let mut fresh = start.clone();
    let plain = solve(Newton::default(), &mut problem, &mut fresh).unwrap();
    let report = Newton::default().solve(&mut system, &mut scratch, &mut problem, &mut y, &[], true).unwrap();
    assert_eq!(y, fresh);
    assert_eq!(report.factorisations, plain.factorisations);
    assert!(report.iterations > plain.iterations);
}

#[test]
fn old_factors_at_a_solution_take_one_solve() {
    let (mut system, mut y) = factors_nearby(2.0);
    let mut scratch = NewtonScratch::default();
    let mut problem = bratu(2.0);
    let report = Newton::default().solve(&mut system, &mut scratch, &mut problem, &mut y, &[], true).unwrap();
    assert_eq!((report.factorisations, report.iterations), (0, 1));
}

#[test]
fn what_is_called_converged_is_a_solution() {
    // y(0) = 0 by atan(y(0)) = 0. An overshooting step to a huge value has a small correction relative to that value;
    // from 3 on the iteration diverges until the correction is small relative to the iterate.
    for start in [2.0, 3.0, 10.0, 100.0] {
        let mut problem = Initial { rate: -1.0, condition: |y| (y.atan(), 1.0 / (1.0 + y * y)) };
        let mut y = constant(1, 2, M, start);
        let outcome = solve(Newton::default(), &mut problem, &mut y);
        assert!(outcome.is_err() || largest(&unknowns(&y)) <= Newton::default().tolerance, "{start}: {outcome:?}");
    }
}

#[test]
fn a_step_larger_than_the_solution_is_no_measure_of_convergence() {
    // y + 10⁻¹² y² = 0 from 10⁶: the first step leaves an error of 1, the second, 10⁻⁶ of the first, one of 10⁻⁶.
    let mut problem = Initial { rate: -1.0, condition: |y| (y + 1e-12 * y * y, 1.0 + 2e-12 * y) };
    let mut y = constant(1, 2, M, 1e6);
    solve(Newton::default(), &mut problem, &mut y).unwrap();
    assert!(largest(&unknowns(&y)) <= Newton::default().tolerance, "{}", largest(&unknowns(&y)));
}
