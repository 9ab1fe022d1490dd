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

/// The bound on the error holds, or the solve fails, where f jumps, is not smooth, is small, or where rounding is amplified.
#[test]
fn the_bound_on_the_error_holds_for_rough_small_and_nearly_singular_problems() {
    let within = |allowed: f64| Settings { error: Some(allowed), ..Settings::default() };
    type Rhs<'f> = &'f dyn Fn(f64, &[Jet], &mut [Jet]);
    let from_zero = |n: usize, intervals: usize, settings: &Settings, rhs: Rhs<'_>| {
        let zeros = vec![0.0; intervals + 1];
        let guess: Vec<&[f64]> = (0..n).map(|_| &zeros[..]).collect();
        let conditions = |ya: &[Jet], yb: &[Jet], _: &[Jet], r: &mut [Jet]| {
            r[0] = ya[0];
            if n > 1 {
                r[1] = yb[0];
            }
        };
        let rhs = |x: f64, y: &[Jet], _: &[Jet], f: &mut [Jet]| rhs(x, y, f);
        solve_bvp(rhs, conditions, &mesh::uniform(0.0, 1.0, intervals), &guess, &[], settings)
    };
    let check =
        |case: &str, found: Result<furrow_bvp::Solved, SolveError>, allowed: f64, exact: &dyn Fn(f64) -> f64| {
            let Ok(solved) = found else { return };
            let y = &solved.solution;
            let size = |(i, x): (usize, &f64)| (y.node(i)[0] - exact(*x)).abs() / (1.0 + exact(*x).abs());
            let error = y.mesh.iter().enumerate().map(size).fold(0.0, f64::max);
            assert!(error <= allowed, "{case}: {error:.1e}, estimated {:.1e}", solved.error.unwrap_or(f64::NAN));
        };
    for c in [0.8473154362416108, 0.3, 1.0 / 7.0] {
        let found = from_zero(1, 10, &within(1e-8), &|x, _, f| f[0] = Jet::from(f64::from(x > c)));
        check("a jump", found, 1e-8, &|x: f64| (x - c).max(0.0));
    }
    let found = from_zero(1, 10, &within(1e-8), &|x, _, f| f[0] = Jet::from(0.5 / x.sqrt()));
    check("a root", found, 1e-8, &|x: f64| x.sqrt());
    // Bratu's problem in units of k: its solution for λ = 1 is 0.140539 in the middle.
    for k in [1e-6, 1e-7, 1e-8] {
        let small = |_: f64, y: &[Jet], f: &mut [Jet]| {
            f[0] = y[1];
            f[1] = -(y[0] / k).exp() * k;
        };
        let found = from_zero(2, 4, &within(1e-10), &small).unwrap().solution;
        let mut at_middle = [0.0; 2];
        found.eval(&found.gauss(), 0.5, &mut at_middle);
        let middle = at_middle[0] / k;
        assert!((middle - 0.140_539).abs() < 1e-10 / k + 1e-6, "{k}: {middle}");
    }
    // u″ = 1 − c u near the first resonance, c = π².
    let c = 9.869604431089359_f64;
    let exact = |x: f64| (1.0 - (c.sqrt() * (x - 0.5)).cos() / (0.5 * c.sqrt()).cos()) / c;
    let resonance = |_: f64, y: &[Jet], f: &mut [Jet]| {
        f[0] = y[1];
        f[1] = Jet::from(1.0) - y[0] * c;
    };
    // The exact solution itself is known to 1e-8 only.
    check("a resonance", from_zero(2, 4, &within(1e-8), &resonance), 3e-8, &exact);
}

/// Van der Pol's equation with its period as an unknown: at rest every period fits.
#[test]
fn a_trivial_solution_that_leaves_a_scalar_free_is_singular() {
    let grid = mesh::uniform(0.0, 1.0, 50);
    for (period, error) in [3.0, 4.0, 5.0, 6.0].into_iter().flat_map(|period| [(period, Some(1e-8)), (period, None)]) {
        let wave = |of: fn(f64) -> f64| grid.iter().map(|x| of(TAU * x)).collect::<Vec<f64>>();
        let found = solve_bvp(
            |_, y: &[Jet], p, f: &mut [Jet]| {
                f[0] = p[0] * y[1];
                f[1] = p[0] * ((-y[0] * y[0] + 1.0) * y[1] * 2.0 - y[0]);
            },
            |ya, yb, _, r| {
                r[0] = ya[0] - yb[0];
                r[1] = ya[1] - yb[1];
                r[2] = ya[1];
            },
            &grid,
            &[&wave(f64::cos), &wave(|x| -x.sin())],
            &[period],
            &Settings { error, ..Settings::default() },
        );
        match found {
            Ok(solved) => assert!(solved.solution.node(0)[0].abs() > 1.0, "{period}: {:.1e}", solved.condition),
            Err(error) => assert!(
                matches!(error, SolveError::Singular { .. }),
                "{period}: {}",
                error.to_string().chars().take(200).collect::<String>()
            ),
        }
    }
}

type Row = fn(f64) -> f64;
type Rhs = fn(f64, &[Jet], &[Jet], &mut [Jet]);
type Conditions = fn(&[Jet], &[Jet], &[Jet], &mut [Jet]);

/// Problems to which Newton's method and the homotopy find no solution from guesses such as zeros, a constant or a line.
#[test]
fn rough_guesses_are_carried_from_mesh_to_mesh() {
    let solved = |grid: &[f64], guess: &[Row], p: &[f64], rhs: Rhs, conditions: Conditions| {
        let rows: Vec<Vec<f64>> = guess.iter().map(|row| grid.iter().map(|x| row(*x)).collect()).collect();
        let rows: Vec<&[f64]> = rows.iter().map(|row| &row[..]).collect();
        solve_bvp(rhs, conditions, grid, &rows, p, &Settings::default()).unwrap().solution
    };
    let [one, zero]: [Row; 2] = [|_| 1.0, |_| 0.0];
    // Falkner and Skan with β = −0.15 and reversed flow at the wall, from ones.
    let flow = solved(
        &mesh::uniform(0.0, 10.0, 14),
        &[one, one, one],
        &[],
        |_, y, _, f| (f[0], f[1], f[2]) = (y[1], y[2], -y[0] * y[2] + (-y[1] * y[1] + 1.0) * 0.15),
        |ya, yb, _, r| (r[0], r[1], r[2]) = (ya[0], ya[1], yb[1] - 1.0),
    );
    assert!((flow.node(0)[2] + 0.1334212).abs() < 1e-6, "{}", flow.node(0)[2]);
    // Allen and Cahn, ε = 0.1, from zeros: the front is where the condition puts it.
    let front = solved(
        &mesh::uniform(0.0, 1.0, 10),
        &[zero, zero],
        &[],
        |_, y, _, f| (f[0], f[1]) = (y[1], (y[0] * y[0] * y[0] - y[0]) * 100.0),
        |ya, yb, _, r| (r[0], r[1]) = (ya[0] + 1.0, yb[0] - 1.0),
    );
    let mut middle = [0.0; 2];
    front.eval(&furrow_bvp::Gauss::default(), 0.5, &mut middle);
    assert!(middle[0].abs() < 1e-6 && (middle[1] - 7.07123).abs() < 1e-5, "{middle:?}");
    // The lowest characteristic number of Mathieu's equation with q = 5, from −1.
    let mathieu = solved(
        &mesh::uniform(0.0, PI / 2.0, 14),
        &[|_| -1.0, |_| -1.0],
        &[0.0],
        |x, y, p, f| (f[0], f[1]) = (y[1], -(p[0] - 10.0 * (2.0 * x).cos()) * y[0]),
        |ya, yb, _, r| (r[0], r[1], r[2]) = (ya[0] - 1.0, ya[1], yb[1]),
    );
    assert!((mathieu.scalars[0] + 5.800046).abs() < 1e-6, "{:?}", mathieu.scalars);
    // The second transcendent of Painlevé, from −1.
    let painleve = solved(
        &mesh::uniform(-8.0, 6.0, 14),
        &[|_| -1.0, |_| -1.0],
        &[],
        |x, y, _, f| (f[0], f[1]) = (y[1], y[0] * y[0] * y[0] * 2.0 + y[0] * x),
        |ya, yb, _, r| (r[0], r[1]) = (ya[0] - 2.0, yb[0] - 9.9e-6),
    );
    let mut middle = [0.0; 2];
    painleve.eval(&furrow_bvp::Gauss::default(), 0.0, &mut middle);
    assert!((middle[0] - 0.3670615).abs() < 1e-6, "{middle:?}");
}

/// A kink and a pulse on long intervals have conditions of 1e7 and 1e10, which do not grow as the mesh is refined.
#[test]
fn a_large_condition_that_settles_is_no_singularity() {
    let grid = mesh::uniform(-10.0, 10.0, 40);
    let row = |of: fn(f64) -> f64| grid.iter().map(|x| of(*x)).collect::<Vec<f64>>();
    for tolerance in [1e-3, 1e-4, 1e-6, 1e-8] {
        let settings = Settings { tolerance, ..Settings::default() };
        let kink = solve_bvp(
            |_, y: &[Jet], _, f: &mut [Jet]| (f[0], f[1]) = (y[1], y[0].sin()),
            |ya, yb, _, r| {
                (r[0], r[1]) = (ya[0] - 4.0 * (-10f64).exp().atan(), yb[0] - 4.0 * 10f64.exp().atan());
            },
            &grid,
            &[&row(|x| PI * (1.0 + x / 10.0)), &row(|_| PI / 10.0)],
            &[],
            &settings,
        );
        let (mut at, kink) = ([0.0; 2], kink.unwrap());
        kink.eval(&furrow_bvp::Gauss::default(), 0.0, &mut at);
        assert!((at[0] - PI).abs() < 2e-3 && (at[1] - 2.0).abs() < 1e-5, "{tolerance:.0e}: {at:?}");
        let pulse = solve_bvp(
            |_, y: &[Jet], _, f: &mut [Jet]| (f[0], f[1]) = (y[1], y[0] - y[0] * y[0]),
            |ya, yb, _, r| (r[0], r[1]) = (ya[0] - ya[1], yb[0] + yb[1]),
            &grid,
            &[&row(|x| 1.5 / (0.5 * x).cosh().powi(2)), &row(|_| 0.0)],
            &[],
            &settings,
        );
        let (mut at, pulse) = ([0.0; 2], pulse.unwrap());
        pulse.eval(&furrow_bvp::Gauss::default(), 0.0, &mut at);
        assert!((at[0] - 1.5).abs() < 1e-5, "{tolerance:.0e}: {at:?}");
    }
}

/// A dead core: u″ = 48 √max(u, 0) with u′(0) = 0 and u(1) = 1 has u = (2x − 1)⁴ beyond x = ½ and 0 before it. Newton's method stalls
/// near the tolerance, since the derivative of f is infinite where u reaches 0.
#[test]
fn a_dead_core_is_solved_to_the_tolerance() {
    let grid = mesh::uniform(0.0, 1.0, 10);
    let line: [f64; 11] = std::array::from_fn(|i| grid[i]);
    for guess in [[1.0; 11], line] {
        let solved = solve_bvp(
            |_, y: &[Jet], _, f: &mut [Jet]| {
                f[0] = y[1];
                f[1] = if y[0].re > 0.0 { y[0].sqrt() * 48.0 } else { y[0] * 0.0 };
            },
            |ya, yb, _, r| {
                r[0] = ya[1];
                r[1] = yb[0] - 1.0;
            },
            &grid,
            &[&guess, &[0.0; 11]],
            &[],
            &Settings { tolerance: 1e-3, ..Settings::default() },
        )
        .unwrap();
        let found = solved.solution;
        for (i, x) in found.mesh.iter().enumerate() {
            let exact = (2.0 * x - 1.0).max(0.0).powi(4);
            assert!((found.node(i)[0] - exact).abs() < 1e-4, "{x}: {} {exact}", found.node(i)[0]);
        }
    }
}
