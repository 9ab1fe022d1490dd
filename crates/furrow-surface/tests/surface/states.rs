//! States on which the engine is tested.

use std::sync::LazyLock;

use furrow_bvp::{Gauss, Work};
use furrow_cell::{Cell, Numerics};
use furrow_mechanics::cortex::Domain;
use furrow_mechanics::cortex::equations::{COMPONENTS, PRESSURE, PSI, R, V, Z};
use furrow_mechanics::cortex::symmetry::unfold;
use furrow_mechanics::division::DivisionInput;
use furrow_mechanics::equilibria::{StationaryShape, stationary};
use furrow_surface::division::divide;
use furrow_surface::embed::{ContourPoint, embed};
use furrow_surface::newton::Newton;
use furrow_surface::problem::{Motion, Problem, State};
use furrow_surface::space::{Harmonic, Space};

/// Asserts that `found` is below `allowed`, and prints both.
#[track_caller]
pub fn within(what: &str, found: f64, allowed: f64) {
    println!("{what}: off by {found:.1e} of {allowed:.0e} allowed");
    assert!(found < allowed, "{what}: off by {found:.1e}, allowed is {allowed:.0e}");
}

/// Numbers between −1 and 1, the same on every machine.
#[derive(Clone, Debug)]
pub struct Draws(pub u64);

impl Draws {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        2.0 * (self.0 >> 11) as f64 / (1u64 << 53) as f64 - 1.0
    }
}

/// Intervals of the axisymmetric shapes with which the engine is compared.
pub fn fine() -> Numerics {
    Numerics { intervals: 120, ..Numerics::default() }
}

/// A cell at rest without its axial symmetry in use: the axisymmetric shape of furrow-mechanics, and the engine's.
pub fn at_rest(cell: &Cell, elements: usize, modes: usize) -> (StationaryShape, Problem, State) {
    let shape = stationary(cell, &fine()).unwrap();
    let full = match shape.cortex.domain {
        Domain::Half => unfold(&shape.solution),
        Domain::Full => shape.solution.clone(),
    };
    let gauss = Gauss::new(fine().stages).unwrap();
    let mut problem = Problem::new(cell, Space::new(elements, modes));
    let shares = problem.mesh.shares(&problem.space);
    let mut state = embed(&problem.space, &shares, full.scalars[PRESSURE], |u| {
        let mut y = [0.0; COMPONENTS];
        full.eval(&gauss, u, &mut y);
        let (sin, cos) = y[PSI].sin_cos();
        ContourPoint { r: y[R], z: y[Z], v_r: y[V] * cos, v_z: -y[V] * sin }
    });
    problem.spread(&state.surface);
    let newton = Newton { tolerance: 1e-10, share: 1.0, iterations: 20, slow: 0.1 };
    problem.solve(&newton, &mut state, &mut None, &mut Work::default()).unwrap();
    (shape, problem, state)
}

/// A cell with constants that differ from each other and from 1.
pub fn uneven_cell(r0: f64, xi_s: f64, cue: &str) -> Cell {
    let mut cell = Cell { xi_s, ..Cell::new(r0).with_cue(cue.parse().unwrap()) };
    let material = &mut cell.material;
    (material.kappa, material.eta_b, material.eta_s) = (1.3, 0.9, 0.7);
    (material.friction, material.tension, material.xi_ratio) = (1.2, 0.15, -0.12);
    (material.spontaneous_curvature, material.normal_friction) = (0.2, 0.35);
    cell
}

/// A moving cell of any shape: harmonics up to m = `bent` of the passive surface are changed, it flows, and the activity is noisy.
pub fn bent(cell: &Cell, elements: usize, modes: usize, bent: usize) -> (Problem, State) {
    let (_, mut problem, mut state) = at_rest(&cell.passive(), elements, modes);
    problem.constants = Problem::new(cell, Space::new(4, 0)).constants;
    let mut draws = Draws(7);
    let count = problem.space.harmonics.len();
    let (size, speed) = (0.06 * cell.r0, 0.4 * cell.r0);
    let mut change = vec![0.0; problem.space.unknowns()];
    for spline in 0..problem.space.splines() {
        let u = spline as f64 / (problem.space.splines() - 1) as f64;
        for harmonic in 0..count {
            let m = problem.space.harmonics[harmonic].azimuthal();
            let wave = (3.0 * u + m as f64 + harmonic as f64).sin() / (1.0 + m as f64);
            let share = if m <= bent { 1.0 } else { 0.0 };
            if let Some(k) = problem.space.unknown(spline, 0, harmonic) {
                change[k] = share * size * wave;
            }
            if let Some(k) = problem.space.unknown(spline, 1, harmonic) {
                change[k] = share * speed * (wave + 0.1 * draws.next());
            }
        }
    }
    // Within the shell, where its force is small.
    state.surface.iter_mut().for_each(|x| *x *= 0.85);
    problem.change(&mut state, &change, 0.3);
    problem.spread(&state.surface);
    let past = state.surface.iter().map(|x| -7.0 * x + 0.5 * draws.next()).collect();
    problem.motion = Motion { rate: 7.0, past };
    let points = problem.space.stations.len() * problem.space.meridians.len();
    problem.noise = (0..points).map(|_| 1.0 + 0.2 * draws.next()).collect();
    (problem, state)
}

/// Places of the harmonics of a space.
pub fn place(space: &Space, harmonic: Harmonic) -> Option<usize> {
    space.harmonics.iter().position(|of| *of == harmonic)
}

/// The coefficient of δx = z, δz = −x: the surface turns about y.
pub fn turn_about_y(space: &Space, surface: &[f64], spline: usize, of: Harmonic) -> f64 {
    let x = |of: Harmonic| place(space, of).map_or(0.0, |k| surface[spline * space.harmonics.len() + k]);
    match of {
        Harmonic::Across(0) => x(Harmonic::Along(0)),
        Harmonic::Across(k) => 0.5 * x(Harmonic::Along(k.abs())),
        Harmonic::Along(0) => -x(Harmonic::Across(0)),
        Harmonic::Along(m) => -x(Harmonic::Across(m)) - x(Harmonic::Across(-m)),
    }
}

/// Every step of a division: its time, the problem and the state.
pub fn steps(cell: Cell, numerics: Numerics) -> Vec<(f64, Problem, State)> {
    let mut out = Vec::new();
    let input = DivisionInput { numerics, ..DivisionInput::new(cell) };
    let found = divide(&input, &mut |problem, level| out.push((level.t, problem.clone(), level.state.clone())));
    println!("{:?}", found.map(|found| (found.division.t_end, found.division.volume_drift, found.division.work)));
    out
}

/// A division from one side, R0 = 2.0, with contact of its walls.
pub fn one_sided_steps() -> &'static [(f64, Problem, State)] {
    static STEPS: LazyLock<Vec<(f64, Problem, State)>> =
        LazyLock::new(|| steps(Cell::new(2.0), Numerics { modes: 3, elements: 36, ..Numerics::default() }));
    &STEPS
}

/// Five of its states, the last at pinch-off.
pub fn one_sided() -> Vec<&'static (f64, Problem, State)> {
    let after = |t: &f64| one_sided_steps().iter().find(|(time, ..)| time >= t);
    [0.0005, 0.5, 1.2, 1.43].iter().filter_map(after).chain(one_sided_steps().last()).collect()
}
