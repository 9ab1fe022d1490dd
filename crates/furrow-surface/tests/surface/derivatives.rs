//! Derivatives of the residual against differences.

use furrow_cell::RigidityGradient;
use furrow_surface::law::Contact;
use furrow_surface::problem::{Problem, Residual, State};
use furrow_surface::space::Harmonic;

use crate::states::{Draws, bent, place, turn_about_y, uneven_cell, within};

/// Puts walls of different kinds before some points.
fn put_walls(problem: &mut Problem) {
    let mut draws = Draws(3);
    let points = problem.space.stations.len() * problem.space.meridians.len();
    let wall = |k: usize| {
        if !k.is_multiple_of(3) {
            return Contact::default();
        }
        let [normal, origin] = [0; 2].map(|_| [draws.next(), draws.next(), draws.next()]);
        Contact { pressure: 0.7, decay: 0.4, origin, normal, distance: draws.next() }
    };
    problem.contacts = (0..points).map(wall).collect();
}

/// The difference quotient of the residual along a direction of all unknowns, the pressure last, minus the derivatives,
/// relative to the largest change; and the same for the volume.
fn off(problem: &Problem, state: &State, direction: &[f64], pressure: f64) -> [f64; 2] {
    let h = 2e-4;
    let at = |h: f64| {
        let mut moved = state.clone();
        let by: Vec<f64> = direction.iter().map(|d| h * d).collect();
        problem.change(&mut moved, &by, h * pressure);
        problem.residual(&moved)
    };
    // Of fourth order.
    let [lower, low, high, higher] = [-2.0 * h, -h, h, 2.0 * h].map(at);
    let slope = |of: &dyn Fn(&Residual) -> f64| (8.0 * (of(&high) - of(&low)) - of(&higher) + of(&lower)) / (12.0 * h);
    let jacobian = problem.jacobian(state);
    let mut expected = jacobian.apply(direction);
    expected.iter_mut().zip(&jacobian.borders[0].column).for_each(|(e, c)| *e += pressure * c);
    let mut worst: f64 = 0.0;
    for (row, expected) in expected.iter().enumerate() {
        worst = worst.max((slope(&|residual| residual.balances[row]) - expected).abs());
    }
    let volume: f64 = jacobian.borders[0].row.iter().zip(direction).map(|(row, d)| row * d).sum();
    let off = (slope(&|residual| residual.volume) - volume).abs();
    [worst / expected.iter().fold(0.0, |most: f64, expected| most.max(expected.abs())), off / problem.radius().powi(2)]
}

fn largest(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0].max(b[0]), a[1].max(b[1])]
}

/// Every column of the Jacobian at a moving, bent cell with noise and walls, for both readings of ∇κ.
#[test]
fn derivatives_are_differences() {
    for reading in [RigidityGradient::Full, RigidityGradient::Dropped] {
        let mut cell = uneven_cell(2.0, 20.0, "none");
        cell.material.rigidity_gradient = reading;
        let (mut problem, state) = bent(&cell, 9, 3, 3);
        put_walls(&mut problem);
        let unknowns = problem.space.unknowns();
        let mut worst = off(&problem, &state, &vec![0.0; unknowns], 1.0);
        for k in 0..unknowns {
            let mut direction = vec![0.0; unknowns];
            direction[k] = 1.0;
            worst = largest(worst, off(&problem, &state, &direction, 0.0));
        }
        within(&format!("balances by {unknowns} unknowns"), worst[0], 1e-8);
        // ∫ n·δX dA is the change of the volume as exactly as the quadrature is.
        within("volume by them", worst[1], 1e-6);
    }
}

/// With a cue of all fields the derivatives hold where its place does not move: for any flow, and for motions that leave shares of the
/// contour as they are (it is moved, turned or made larger).
#[test]
fn derivatives_with_a_cue_are_differences_where_shares_are_kept() {
    let cue = "kappa:band,u0=0.4,omega=0.2,amplitude=0.4+activity:gradient,amplitude=0.3+xi_b:step,u0=0.6,omega=0.2,amplitude=0.5\
               +viscosity:gradient,amplitude=0.4+eta_s:band,u0=0.5,omega=0.3,amplitude=-0.3+friction:gradient,amplitude=-0.5\
               +tension:band,u0=0.6,omega=0.2,amplitude=0.6";
    for reading in [RigidityGradient::Full, RigidityGradient::Dropped] {
        let mut cell = uneven_cell(2.0, 20.0, cue);
        cell.material.rigidity_gradient = reading;
        let (mut problem, state) = bent(&cell, 9, 3, 2);
        put_walls(&mut problem);
        let of = |direction: &Vec<f64>| off(&problem, &state, direction, 0.0);
        let worst = kept(&problem, &state).iter().map(of).fold([0.0; 2], largest);
        within("larger, along z, along x, turned about y, flow", worst[0], 1e-7);
        within("volume by them", worst[1], 1e-6);
    }
}

/// Directions that keep shares.
fn kept(problem: &Problem, state: &State) -> Vec<Vec<f64>> {
    let space = &problem.space;
    let count = space.harmonics.len();
    let all = |field: usize, value: &dyn Fn(usize, usize) -> f64| {
        let mut direction = vec![0.0; space.unknowns()];
        for (spline, harmonic) in (0..space.splines() * count).map(|k| (k / count, k % count)) {
            if let Some(k) = space.unknown(spline, field, harmonic) {
                direction[k] = value(spline, harmonic);
            }
        }
        direction
    };
    let only = |of: Harmonic| move |_: usize, harmonic: usize| f64::from(u8::from(Some(harmonic) == place(space, of)));
    let turned =
        |spline: usize, harmonic: usize| turn_about_y(space, &state.surface, spline, space.harmonics[harmonic]);
    let mut draws = Draws(5);
    let drawn: Vec<f64> = (0..space.coefficients()).map(|_| draws.next()).collect();
    vec![
        all(0, &|spline, harmonic| state.surface[spline * count + harmonic]),
        all(0, &only(Harmonic::Along(0))),
        all(0, &only(Harmonic::Across(0))),
        all(0, &turned),
        all(1, &|spline, harmonic| drawn[spline * count + harmonic]),
    ]
}
