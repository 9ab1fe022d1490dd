//! Shells of any profile: the equations against their second statement, derivatives against differences, and virtual power.

use std::f64::consts::PI;

use furrow_bvp::BoundaryValueProblem;
use furrow_cell::{Cell, Parameter, ShellProfile};
use furrow_mechanics::cortex::equations::{COMPONENTS, PSI, R, Z};
use furrow_mechanics::cortex::{Cortex, Domain};
use furrow_mechanics::equilibria::passive_whole;
use furrow_verification::balance::rates;
use furrow_verification::report::within;
use furrow_verification::states::{Draws, moving, resting, uneven_cell};
use furrow_verification::virtual_power::{Power, motions, power};

use crate::differences::{AT, largest_error, values};

/// r = sin θ √(1 + kx), z = 1.4 x with x = cos θ.
pub fn egg(k: f64) -> ShellProfile {
    let place = |i: usize| {
        let (sin, cos) = (f64::from(i as u32) * PI / 40.0).sin_cos();
        let r = if i.is_multiple_of(40) { 0.0 } else { sin * (1.0 + k * cos).sqrt() };
        format!("{},{r}\n", 1.4 * cos)
    };
    let text = format!("z,r\n{}", (0..=40).map(place).collect::<String>());
    ShellProfile::from_table(text.as_bytes(), "egg", "egg.csv").unwrap()
}

fn cells(xi_s: f64) -> Vec<Cell> {
    let of = |cue| uneven_cell(2.0, xi_s, cue).unwrap().with_shell_profile(egg(0.25));
    ["none", "kappa:band,u0=0.44,omega=0.3,amplitude=0.1"].map(of).to_vec()
}

fn state(draws: &mut Draws) -> [f64; COMPONENTS] {
    let mut y = [0.0; COMPONENTS];
    y.iter_mut().for_each(|y| *y = draws.between(-1.0, 1.0));
    (y[R], y[PSI]) = (draws.between(0.5, 2.0), draws.between(0.1, 3.0));
    y
}

#[test]
fn the_equations_are_those_of_the_second_statement() {
    let (mut draws, mut largest) = (Draws(21), 0.0f64);
    for cell in cells(21.0) {
        let mut cortex = Cortex::new(&cell, Domain::Full, &[]);
        (cortex.rate, cortex.past, cortex.noise) = (3.0, vec![[1.1, -0.2]], vec![1.03]);
        for _ in 0..20 {
            let (y, p) = (state(&mut draws), [draws.between(6.0, 8.0), draws.between(0.0, 3.0)]);
            let [r_t, z_t] = [y[R] - 1.1, y[Z] + 0.2].map(|d| 3.0 * d);
            let expected = rates::<_, COMPONENTS>(&cell, AT.x, p[0], p[1], 1.03, &y, [r_t, z_t, 0.0]);
            cortex.prepare(&p);
            for (found, expected) in values(&cortex, &y, &p).iter().zip(expected) {
                largest = largest.max((found / p[0] - expected).abs() / (1.0 + expected.abs()));
            }
        }
    }
    within("profiles, the second statement", largest, 1e-11);
}

#[test]
fn jacobians_are_differences() {
    let free = [Parameter::XiS, Parameter::R0, Parameter::Epsilon, Parameter::Aspect, Parameter::W, Parameter::P0];
    let (mut draws, mut largest) = (Draws(22), 0.0f64);
    for cell in cells(21.0) {
        let mut cortex = Cortex::new(&cell, Domain::Full, &free);
        (cortex.rate, cortex.past, cortex.noise) = (3.0, vec![[1.1, -0.2]], vec![1.03]);
        for _ in 0..5 {
            let y = state(&mut draws);
            let mut p = vec![draws.between(6.0, 8.0), draws.between(0.0, 3.0)];
            p.extend(free.iter().map(|parameter| parameter.get(&cell)));
            largest = largest.max(largest_error(&mut cortex, &y, &p, 5e-5));
        }
    }
    within("profiles by differences", largest, 1e-6);
}

#[test]
fn forces_do_no_work_at_rest_and_in_motion() {
    let mut largest = 0.0f64;
    let at_rest = cells(8.0).into_iter().map(|cell| resting(&cell).unwrap());
    for state in at_rest.chain(cells(18.0).into_iter().map(|cell| moving(&cell, 5).unwrap())) {
        let most = |power: &Power| power.parts().iter().fold(0.0, |most: f64, part| most.max(part.abs()));
        let powers: Vec<Power> = motions().iter().map(|motion| power(&state, motion)).collect();
        let size = powers.iter().map(most).fold(0.0, f64::max);
        largest = largest.max(powers.iter().map(|power| power.imbalance()).fold(0.0, f64::max) / size);
    }
    within("virtual power in a shell with a profile", largest, 1e-8);
}

/// A passive cell in an egg is an egg itself; in its mirror image it is the mirror image.
#[test]
fn a_cell_at_rest_takes_the_side_of_its_shell() {
    let cell = Cell::new(2.0).with_shell_profile(egg(0.25));
    let numerics = furrow_cell::Numerics::default();
    let (one, _) = passive_whole(&cell, &numerics).unwrap();
    let (other, _) = passive_whole(&cell.mirrored(), &numerics).unwrap();
    let last = one.intervals();
    within("mirrored z", (one.node(0)[Z] + other.node(last)[Z]).abs(), 1e-8);
    // The blunt half is at the pole u = 0.
    let [blunt, pointed] = [last / 4, last - last / 4].map(|k| one.node(k)[R]);
    assert!(blunt > 1.005 * pointed, "{blunt} {pointed}");
}
