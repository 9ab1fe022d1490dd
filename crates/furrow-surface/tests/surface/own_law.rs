//! Laws of the cell's own.

use furrow_cell::{Cell, Law, Numerics};
use furrow_mechanics::division::{DivisionError, DivisionInput};
use furrow_mechanics::law::LawError;
use furrow_surface::division::divide;
use furrow_surface::problem::{Problem, Residual};
use furrow_surface::rates::Among;
use furrow_surface::space::Space;

use crate::states::{at_rest, bent, uneven_cell, within};

const PAPER: &str = include_str!("../../../../examples/laws/paper.ron");
const SATURATING: &str = include_str!("../../../../examples/laws/saturating.ron");
const BENDING: &str = include_str!("../../../../examples/laws/spontaneous_curvature.ron");

/// Uses all that surfaces have: both curvatures, places, parameters, a moment that depends on the curvature, and a force.
const UNEVEN: &str = r#"Law(
    name: "uneven",
    stress_uu: "gain*(xi_s*(c1 - c2)/2/(1 + abs(c1 - c2)/9) + xi_b*C*(1 + u/4)) + tension*sin(s/3)*kappa + eta_b/5",
    stress_phiphi: "gain*(xi_b*C*(1 + u/4) - xi_s*(c1 - c2)/2/(1 + abs(c1 - c2)/9)) + tension*sin(s/3)*kappa + eta_b/5",
    moment: "0.2*tanh(C) - 0.1*c1*c2",
    normal_force: "0.1*cos(r)*xi_s*exp(-C^2) + 0.2*friction*eta_s",
)"#;

fn with(text: &str, cell: Cell) -> Cell {
    cell.with_law(Law::parse(text, "law.ron").unwrap())
}

fn largest(a: &[f64], b: &[f64]) -> f64 {
    let scale = a.iter().fold(0.0f64, |most, x| most.max(x.abs()));
    a.iter().zip(b).fold(0.0f64, |most, (a, b)| most.max((a - b).abs())) / scale
}

fn residual(problem: &Problem, state: &furrow_surface::problem::State) -> Vec<f64> {
    let Residual { balances, volume } = problem.residual(state);
    balances.into_iter().chain([volume]).collect()
}

/// On a bent, moving surface with noise and a cue the text gives the forces of the built-in law.
#[test]
fn the_papers_law_as_text_is_the_built_in_law() {
    let cell = uneven_cell(1.64, 17.0, "kappa:band,u0=0.4,omega=0.2,amplitude=0.3+activity:gradient,amplitude=0.1");
    let (mut problem, state) = bent(&cell, 12, 3, 3);
    let built_in = residual(&problem, &state);
    problem.constants = Problem::new(&with(PAPER, cell), Space::new(4, 0)).constants;
    within("forces", largest(&built_in, &residual(&problem, &state)), 1e-10);
}

/// A moment of its own is the spontaneous curvature that the cell has without a law.
#[test]
fn a_moment_bends_a_surface_as_spontaneous_curvature_does() {
    let mut curved = Cell { xi_s: 17.0, ..Cell::new(1.64) };
    curved.material.spontaneous_curvature = 0.3;
    let (mut problem, state) = bent(&curved, 12, 3, 3);
    problem.noise.clear();
    let built_in = residual(&problem, &state);
    let own = with(BENDING, Cell { xi_s: 17.0, ..Cell::new(1.64) });
    problem.constants = Problem::new(&own, Space::new(4, 0)).constants;
    within("forces", largest(&built_in, &residual(&problem, &state)), 1e-10);
}

#[test]
fn a_one_sided_division_by_the_papers_law_as_text_is_that_of_the_built_in_law() {
    let numerics = Numerics { modes: 3, elements: 32, ..Numerics::default() };
    let found = [Cell::new(1.64), with(PAPER, Cell::new(1.64))].map(|cell| {
        let input = DivisionInput { numerics, ..DivisionInput::new(cell) };
        divide(&input, &mut |_, _| ()).unwrap().division
    });
    let [a, b] = found.map(|of| [of.chi().unwrap(), of.t_end, of.neck_offset.unwrap()]);
    assert!(a[2] > 0.8, "{a:?}");
    within("χ, t_end, offset", largest(&a, &b), 1e-8);
}

/// Derivatives of the residual by the state, where u and s stay.
#[test]
fn derivatives_of_a_law_are_differences() {
    let text = UNEVEN.replace("*(1 + u/4)", "").replace("*sin(s/3)", "");
    let (problem, state) = bent(&with(&text, uneven_cell(1.64, 17.0, "none")), 10, 2, 2);
    let direction: Vec<f64> = (0..problem.space.unknowns()).map(|k| (k as f64 * 1.7).sin()).collect();
    let h = 1e-5;
    let at = |h: f64| {
        let mut moved = state.clone();
        problem.change(&mut moved, &direction.iter().map(|d| h * d).collect::<Vec<_>>(), 0.0);
        problem.residual(&moved).balances
    };
    let quotient: Vec<f64> = at(h).iter().zip(at(-h)).map(|(a, b)| (a - b) / (2.0 * h)).collect();
    let derivatives = problem.jacobian(&state).apply(&direction.iter().copied().chain([0.0]).collect::<Vec<_>>());
    within("derivatives", largest(&quotient, &derivatives[..quotient.len()]), 1e-6);
}

/// Shapes at rest and growth rates of laws in axial symmetry.
#[test]
fn rest_shapes_of_laws_are_those_of_the_axisymmetric_equations() {
    for (text, r0, xi_s) in [(SATURATING, 2.0, 15.0), (UNEVEN, 2.0, 9.0)] {
        let cell = with(text, Cell { xi_s, ..Cell::new(r0) });
        let (shape, problem, state) = at_rest(&cell, 44, 0);
        let (_, length) = problem.speeds(&state.surface);
        let off = largest(&[shape.length(), shape.pressure()], &[length, state.pressure]);
        within("L, p", off, 1e-6);
        let expected = shape.spectrum().unwrap().values[0].re;
        let found = problem.rates(&state, 4, Among::Azimuthal(0)).unwrap()[0].re;
        within("growth rate", (found / expected - 1.0).abs(), 1e-4);
    }
}

#[test]
fn a_division_by_a_law_is_that_of_the_axisymmetric_equations() {
    let cell = with(SATURATING, Cell::new(4.0));
    let expected = furrow_mechanics::division::divide(&DivisionInput::new(cell.clone())).unwrap();
    let found = divide(&DivisionInput::new(cell), &mut |_, _| ()).unwrap().division;
    within("χ", (found.chi().unwrap() - expected.chi().unwrap()).abs(), 0.002);
    within("t_end", (found.t_end / expected.t_end - 1.0).abs(), 0.005);
}

#[test]
fn laws_that_need_an_axis_are_refused_with_the_reason() {
    let law =
        |along: &str, around: &str| format!("Law(name: \"x\", stress_uu: \"{along}\", stress_phiphi: \"{around}\")");
    for (text, reason) in [
        (law("xi_s*(1 + phi)", "xi_s*(1 + phi)"), "it uses phi, and a regulator has"),
        (law("xi_s*C + S_uu", "xi_s*C + S_phiphi"), "it uses S_uu, which leaves out the shear"),
        (law("0", "xi_s*sin(pi*u)^2"), "it tells the direction around the axis from the other: at c1 = "),
        (law("xi_s*(c1 + 2*c2)", "xi_s*(c1 + 2*c2)"), "it tells the direction around the axis from the other"),
    ] {
        let error = divide(&DivisionInput::new(with(&text, Cell::new(2.0))), &mut |_, _| ()).err().unwrap();
        assert!(matches!(error, DivisionError::Law { source: LawError::NeedsAxis { .. }, .. }), "{error}");
        assert!(error.to_string().contains(reason), "{error}");
    }
}
