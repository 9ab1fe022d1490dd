//! Symmetries, which need no reference.

use furrow_bvp::Work;
use furrow_cell::Cell;
use furrow_surface::embed::{ContourPoint, embed};
use furrow_surface::newton::Newton;
use furrow_surface::problem::{Problem, State};
use furrow_surface::rates::Among;
use furrow_surface::rates::Rate;
use furrow_surface::space::{Harmonic, Space};

use crate::states::{bent, turn_about_y, uneven_cell, within};

/// The coefficients of the field turned by half a turn about the axis: x and y change their signs, and φ goes on by π.
fn turned(space: &Space, coefficients: &[f64]) -> Vec<f64> {
    let sign =
        |k: usize| if space.harmonics[k % space.harmonics.len()].azimuthal().is_multiple_of(2) { 1.0 } else { -1.0 };
    coefficients.iter().enumerate().map(|(k, x)| sign(k) * x).collect()
}

/// The coefficients of the field mirrored at z = 0, with u → 1 − u. Mirrored twice, it is the field again.
fn mirrored(space: &Space, coefficients: &[f64]) -> Vec<f64> {
    let count = space.harmonics.len();
    let of = |k: usize| {
        let sign = if let Harmonic::Along(_) = space.harmonics[k % count] { -1.0 } else { 1.0 };
        sign * coefficients[(space.splines() - 1 - k / count) * count + k % count]
    };
    (0..coefficients.len()).map(of).collect()
}

/// A residual as the coefficients of a field, by the fields of the mesh and of the flow.
fn fields(problem: &Problem, state: &State) -> [Vec<f64>; 2] {
    let space = &problem.space;
    let count = space.harmonics.len();
    let balances = problem.residual(state).balances;
    let of = |field: usize| {
        let of = |k: usize| space.unknown(k / count, field, k % count).map_or(0.0, |row| balances[row]);
        (0..space.coefficients()).map(of).collect()
    };
    [0, 1].map(of)
}

/// What is the same after a symmetry of the space, `field`, of a problem with `by` the order of its points.
fn equivariant(what: &str, field: fn(&Space, &[f64]) -> Vec<f64>, by: impl Fn(&Space, usize) -> usize) {
    let (problem, state) = bent(&uneven_cell(2.0, 20.0, "none"), 12, 3, 3);
    let space = &problem.space;
    let mut other = problem.clone();
    other.motion.past = field(space, &problem.motion.past);
    other.noise = (0..problem.noise.len()).map(|k| problem.noise[by(space, k)]).collect();
    let moved = State { surface: field(space, &state.surface), flow: field(space, &state.flow), ..state.clone() };
    other.mesh.density.reverse();
    if by(space, 0) < space.meridians.len() {
        other.mesh.density.reverse();
    }
    other.spread(&moved.surface);
    let [expected, found] = [fields(&problem, &state).map(|of| field(space, &of)), fields(&other, &moved)];
    for (found, expected) in found.iter().zip(&expected) {
        let largest = expected.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let off = found.iter().zip(expected).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
        within(what, off / largest, 1e-11);
    }
}

#[test]
fn half_a_turn_about_the_axis_turns_the_balances() {
    let meridians = |space: &Space| space.meridians.len();
    equivariant("half a turn", turned, |space, k| {
        k - k % meridians(space) + meridians(space) - 1 - k % meridians(space)
    });
}

#[test]
fn the_balances_of_a_mirror_image_are_mirrored() {
    equivariant("mirror image", mirrored, |space, k| {
        let count = space.meridians.len();
        (space.stations.len() - 1 - k / count) * count + k % count
    });
}

/// A field by spline and harmonic.
type Motion<'a> = &'a dyn Fn(usize, Harmonic) -> f64;

/// Inner forces have no resultant and no torque: without shell, friction and pressure the balances vanish on rigid motions.
#[test]
fn inner_forces_do_no_work_on_rigid_motions() {
    let mut cell =
        uneven_cell(2.0, 20.0, "kappa:band,u0=0.4,omega=0.2,amplitude=0.4+tension:band,u0=0.6,omega=0.2,amplitude=0.6");
    (cell.material.friction, cell.material.normal_friction) = (0.0, 0.0);
    cell.shell.p0 = 0.0;
    let (mut problem, mut state) = bent(&uneven_cell(2.0, 20.0, "none"), 12, 4, 3);
    problem.constants = Problem::new(&cell, Space::new(4, 0)).constants;
    state.pressure = 0.0;
    let space = &problem.space;
    let count = space.harmonics.len();
    let [_, forces] = fields(&problem, &state);
    let turn = |spline: usize, of: Harmonic| turn_about_y(space, &state.surface, spline, of);
    let shift = |along: Harmonic| move |_: usize, of: Harmonic| f64::from(u8::from(of == along));
    let motions: [(&str, Motion<'_>); 3] =
        [("along x", &shift(Harmonic::Across(0))), ("along z", &shift(Harmonic::Along(0))), ("about y", &turn)];
    for (what, motion) in motions {
        let (mut power, mut size) = (0.0, 0.0);
        for (k, force) in forces.iter().enumerate() {
            // Two coefficients at a pole are one unknown.
            let twin =
                k / count > 0 && space.unknown(k / count, 1, k % count) == space.unknown(k / count - 1, 1, k % count);
            let part = if twin { 0.0 } else { force * motion(k / count, space.harmonics[k % count]) };
            power += part;
            size += part.abs();
        }
        within(what, power.abs() / size, 1e-12);
    }
}

/// A sphere in a spherical shell has no axis: rates depend on the number l of Legendre's functions alone, and every m ≤ l has them.
#[test]
fn rates_of_a_sphere_do_not_depend_on_the_axis() {
    let mut cell = Cell { xi_s: 12.0, ..Cell::new(1.6) };
    cell.shell.aspect = 1.0;
    let mut problem = Problem::new(&cell, Space::new(40, 3));
    let shares = problem.mesh.shares(&problem.space);
    let mut state = embed(&problem.space, &shares, 0.0, |u| {
        let (sin, cos) = (std::f64::consts::PI * u).sin_cos();
        ContourPoint { r: 1.6 * sin, z: 1.6 * cos, ..ContourPoint::default() }
    });
    problem.spread(&state.surface);
    let newton = Newton { tolerance: 1e-10, share: 1.0, iterations: 20, slow: 0.1 };
    problem.solve(&newton, &mut state, &mut None, &mut Work::default()).unwrap();
    let rates = [0, 1, 2, 3].map(|m| problem.rates(&state, 6, Among::Azimuthal(m)).unwrap());
    for (m, of) in rates.iter().enumerate() {
        println!("m = {m}: {:?}", of.iter().map(|rate| rate.re).collect::<Vec<_>>());
    }
    let nearest = |m: usize, rate: f64| rates[m].iter().map(|of| (of.re - rate).abs()).fold(f64::INFINITY, f64::min);
    // Those of m = 3 are those of l = 3, 4, …, and so on.
    let mut worst: f64 = 0.0;
    for (m, less) in [(1, 0), (2, 0), (2, 1), (3, 0), (3, 1), (3, 2)] {
        for Rate { re, .. } in rates[m].iter().take(3) {
            worst = worst.max(nearest(less, *re) / re.abs().max(1.0));
        }
    }
    within("rates", worst, 1e-5);
}
