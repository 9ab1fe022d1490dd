//! Problems in one call, with conditions that involve both ends.

use furrow_bvp::{DualNum, InvalidInput, Jet, Settings, SolveError, mesh, solve_bvp};
use std::f64::consts::{LN_2, PI, TAU};

fn fine() -> Settings {
    Settings { tolerance: 1e-9, ..Settings::default() }
}

/// u″ = u + cos x has the one periodic solution −cos(x)/2.
#[test]
fn a_forced_oscillation_is_periodic() {
    let grid = mesh::uniform(0.0, TAU, 8);
    let zeros = [0.0; 9];
    let solved = solve_bvp(
        |x, y: &[Jet], _, f: &mut [Jet]| {
            f[0] = y[1];
            f[1] = y[0] + x.cos();
        },
        |ya, yb, _, r| {
            r[0] = ya[0] - yb[0];
            r[1] = ya[1] - yb[1];
        },
        &grid,
        &[&zeros, &zeros],
        &[],
        &fine(),
    )
    .unwrap();
    let found = solved.solution;
    assert!(found.scalars.is_empty());
    for (i, x) in found.mesh.iter().enumerate() {
        assert!((found.node(i)[0] + x.cos() / 2.0).abs() < 1e-9);
    }
}

/// y′ = p y with y(0) = 1 and y(0) y(1) = 2: p = ln 2. The guess is 0 at the right end, where the product does not depend on y(0).
#[test]
fn a_product_of_both_ends_is_a_condition() {
    let solved = solve_bvp(
        |_, y: &[Jet], p, f: &mut [Jet]| f[0] = p[0] * y[0],
        |ya, yb, _, r| {
            r[0] = ya[0] - 1.0;
            r[1] = ya[0] * yb[0] - 2.0;
        },
        &mesh::uniform(0.0, 1.0, 4),
        &[&[1.0, 1.0, 1.0, 1.0, 0.0]],
        &[0.3],
        &fine(),
    )
    .unwrap();
    assert!((solved.solution.scalars[0] - LN_2).abs() < 1e-10);
    assert!((solved.solution.node(solved.solution.intervals())[0] - 2.0).abs() < 1e-10);
}

/// u″ + k² u = 0 with u(0) = u(1) = 0 and u′(0) = k from a guess with one full wave: k = 2π.
#[test]
fn an_eigenvalue_is_a_scalar_unknown() {
    let grid = mesh::uniform(0.0, 1.0, 8);
    let wave: Vec<f64> = grid.iter().map(|x| (TAU * x).sin()).collect();
    let slope: Vec<f64> = grid.iter().map(|x| 6.0 * (TAU * x).cos()).collect();
    let solved = solve_bvp(
        |_, y: &[Jet], p, f: &mut [Jet]| {
            f[0] = y[1];
            f[1] = -p[0].powi(2) * y[0];
        },
        |ya, yb, p, r| {
            r[0] = ya[0];
            r[1] = yb[0];
            r[2] = ya[1] - p[0];
        },
        &grid,
        &[&wave, &slope],
        &[6.0],
        &fine(),
    )
    .unwrap();
    assert!((solved.solution.scalars[0] - 2.0 * PI).abs() < 1e-9);
}

#[test]
fn a_guess_that_does_not_fit_the_mesh_is_refused() {
    let grid = mesh::uniform(0.0, 1.0, 4);
    let refused = solve_bvp(|_, _, _, _| (), |_, _, _, _| (), &grid, &[&[0.0; 4]], &[], &fine());
    let expected = InvalidInput::Length { name: "values in a row of the guess", length: 4, expected: 5 };
    assert_eq!(refused.unwrap_err(), SolveError::Invalid(expected));
}

/// y″ = 0 with y′(0) = 3 and y(0) + max(y(1) − 2, 0) = 2: y = ½ + 3x. Near the guess the second condition does not depend on y(1).
#[test]
fn a_condition_may_depend_on_an_end_far_from_the_guess_alone() {
    let zeros = [0.0; 5];
    let solved = solve_bvp(
        |_, y: &[Jet], _, f: &mut [Jet]| (f[0], f[1]) = (y[1], 0.0.into()),
        |ya, yb, _, r| {
            r[0] = ya[0] + if yb[0].re > 2.0 { yb[0] - 2.0 } else { 0.0.into() } - 2.0;
            r[1] = ya[1] - 3.0;
        },
        &mesh::uniform(0.0, 1.0, 4),
        &[&zeros, &zeros],
        &[],
        &fine(),
    )
    .unwrap();
    assert!((solved.solution.node(0)[0] - 0.5).abs() < 1e-9);
}

/// y″ = 0 with y(0) = 0 and ln y(1) = 1. At the left end the logarithm has no value.
#[test]
fn conditions_at_one_end_are_computed_with_the_guess_at_the_other() {
    let grid = mesh::uniform(0.0, 1.0, 4);
    let line: Vec<f64> = grid.iter().map(|x| 2.0 * x).collect();
    let solved = solve_bvp(
        |_, y: &[Jet], _, f: &mut [Jet]| (f[0], f[1]) = (y[1], 0.0.into()),
        |ya, yb, _, r| {
            r[0] = if yb[0].re > 0.0 { ya[0] } else { f64::NAN.into() };
            r[1] = yb[0].ln() - 1.0;
        },
        &grid,
        &[&line, &[2.0; 5]],
        &[],
        &fine(),
    )
    .unwrap();
    assert!((solved.solution.node(solved.solution.intervals())[0] - 1f64.exp()).abs() < 1e-9);
}

/// Twenty-four equations y′ = −y: two stages instead of four.
#[test]
fn many_equations_have_fewer_stages() {
    let (ones, rows) = ([1.0; 5], 24);
    let solved = solve_bvp(
        |_, y: &[Jet], _, f: &mut [Jet]| f.iter_mut().zip(y).for_each(|(f, y)| *f = -*y),
        |ya, _, _, r| r.iter_mut().zip(ya).for_each(|(r, y)| *r = *y - 1.0),
        &mesh::uniform(0.0, 1.0, 4),
        &vec![&ones[..]; rows],
        &[],
        &fine(),
    )
    .unwrap();
    let last = solved.solution.node(solved.solution.intervals());
    assert!(last.iter().all(|y| (y - (-1f64).exp()).abs() < 1e-8), "{last:?}");
}

/// y″ = 3/2 y² with y(0) = 4 and y(1) = 1, conditions divided by 1e13.
#[test]
fn the_scale_of_conditions_does_not_matter() {
    let grid = mesh::uniform(0.0, 1.0, 4);
    let line: Vec<f64> = grid.iter().map(|x| 4.0 - 3.0 * x).collect();
    let solved = solve_bvp(
        |_, y: &[Jet], _, f: &mut [Jet]| (f[0], f[1]) = (y[1], y[0] * y[0] * 1.5),
        |ya, yb, _, r| (r[0], r[1]) = ((ya[0] - 4.0) * 1e-13, (yb[0] - 1.0) * 1e-13),
        &grid,
        &[&line, &[-3.0; 5]],
        &[],
        &fine(),
    )
    .unwrap();
    let mut y = [0.0; 2];
    solved.eval(&solved.solution.gauss(), 0.5, &mut y);
    assert!((y[0] - 16.0 / 9.0).abs() < 1e-9 && solved.condition < 100.0, "{y:?}, {}", solved.condition);
}
