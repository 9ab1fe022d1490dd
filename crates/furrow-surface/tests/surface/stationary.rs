//! Axisymmetric shapes at rest, and small disturbances of them, against furrow-mechanics.

use furrow_cell::{Cell, Numerics, RigidityGradient};
use furrow_mechanics::division::DivisionInput;
use furrow_mechanics::stability::{Parity, Spectrum};
use furrow_surface::problem::{Problem, State};
use furrow_surface::rates::Among;
use furrow_surface::steady::steady;

use crate::states::{at_rest, within};

/// The four cells of the checks: R0 and ξ_s.
const CELLS: [[f64; 2]; 4] = [[2.0, 15.0], [1.64, 25.0], [1.443, 25.0], [1.0, 25.0]];

fn cell([r0, xi_s]: [f64; 2]) -> Cell {
    Cell { xi_s, ..Cell::new(r0) }
}

/// Elongation H of a surface.
fn elongation(problem: &Problem, state: &State) -> f64 {
    let height = |u: f64| {
        let mut functions = Vec::new();
        problem.space.functions(&state.surface, &problem.space.station(u), &mut functions);
        problem.space.shape(&functions, &problem.space.meridian(0.0))[0][2]
    };
    (height(0.0) - height(1.0)) / problem.radius()
}

/// The largest relative difference of L, H and p.
fn differences(cell: &Cell, elements: usize) -> f64 {
    let (shape, problem, state) = at_rest(cell, elements, 0);
    let (_, length) = problem.speeds(&state.surface);
    let found = [length, elongation(&problem, &state), state.pressure];
    let expected = [shape.length(), shape.elongation(), shape.pressure()];
    let off: Vec<f64> = found.iter().zip(expected).map(|(found, expected)| (found / expected - 1.0).abs()).collect();
    println!("R0 = {}, ξ_s = {}, {elements} elements: L, H, p off by {off:?}", cell.r0, cell.xi_s);
    off.into_iter().fold(0.0, f64::max)
}

#[test]
fn shapes_at_rest_are_those_of_the_axisymmetric_equations() {
    for of in CELLS.into_iter().chain([[2.0, 25.0]]) {
        differences(&cell(of), 44);
        within("L, H, p", differences(&cell(of), 64), 1e-6);
    }
}

/// With a cue of every field, for both readings of ∇κ.
#[test]
fn cued_shapes_at_rest_are_those_of_the_axisymmetric_equations() {
    let cue = "kappa:band,u0=0.4,omega=0.2,amplitude=0.3+activity:gradient,amplitude=0.1+xi_b:step,u0=0.6,omega=0.3,amplitude=0.2\
               +viscosity:gradient,amplitude=0.4+eta_s:band,u0=0.5,omega=0.3,amplitude=-0.3+friction:gradient,amplitude=-0.5\
               +tension:band,u0=0.6,omega=0.2,amplitude=0.3";
    let mut found = Vec::new();
    for reading in [RigidityGradient::Full, RigidityGradient::Dropped] {
        let mut cell = cell([2.0, 9.0]).with_cue(cue.parse().unwrap());
        cell.material.rigidity_gradient = reading;
        within("L, H, p", differences(&cell, 44), 1e-6);
        found.push(at_rest(&cell, 30, 0).2.pressure);
    }
    assert!((found[0] / found[1] - 1.0).abs() > 1e-3, "the readings differ: {found:?}");
}

/// The engine finds the two leading rates, and the leading one of each parity.
fn off(found: &[furrow_surface::rates::Rate], expected: &Spectrum) -> f64 {
    let leading = expected.values.iter().take(2);
    let of = [Parity::Even, Parity::Odd].into_iter().filter_map(|parity| expected.rightmost(Some(parity)));
    let nearest =
        |re: f64, im: f64| found.iter().map(|rate| (rate.re - re).hypot(rate.im - im)).fold(f64::INFINITY, f64::min);
    leading.chain(of).map(|rate| nearest(rate.re, rate.im) / rate.re.hypot(rate.im).max(1.0)).fold(0.0, f64::max)
}

fn rates(elements: usize) -> f64 {
    let mut worst = 0.0f64;
    for of in CELLS {
        let (shape, problem, state) = at_rest(&cell(of), elements, 3);
        for m in 0..=3 {
            let expected = if m == 0 { shape.spectrum() } else { shape.azimuthal(m).leading() }.unwrap();
            let found = problem.rates(&state, 8, Among::Azimuthal(m)).unwrap();
            let leading: Vec<String> =
                expected.values.iter().take(3).map(|rate| format!("{:.6} {:?}", rate.re, rate.parity)).collect();
            println!("R0 = {}, m = {m}, {elements} elements: {:.1e}; {leading:?}", of[0], off(&found, &expected));
            worst = worst.max(off(&found, &expected));
        }
    }
    worst
}

#[test]
fn growth_rates_are_those_of_the_axisymmetric_equations() {
    within("rates of m = 0 … 3", rates(44), 1e-5);
}

/// Just above the threshold a bend grows slowly, by 0.19/τ, and the straight shape looks at rest for long.
#[test]
fn a_straight_shape_that_is_unstable_to_a_bend_is_left() {
    let numerics = Numerics { modes: 4, ..Numerics::default() };
    let found = steady(&DivisionInput { numerics, ..DivisionInput::new(cell([2.0, 12.0])) }).unwrap();
    let rate = found.at_rest(2.0).unwrap().growth_rate();
    within("growth rate of the bent shape", (rate + 0.438233).abs(), 1e-4);
}
