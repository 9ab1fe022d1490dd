//! Manufactured solutions: a chosen moving state, and the sources that make it solve the equations from pole to pole.
//!
//! The sources come from the independent statement of the balance of forces. If the solved equations differ from it, the
//! solution differs from the chosen state on any mesh. If they agree, the error falls with the order of the collocation, even
//! at the poles, where the equations are singular.

use furrow_bvp::newton::NewtonScratch;
use furrow_bvp::{
    BoundaryJacobian, BoundaryValueProblem, CollocationPoint, Dimensions, Gauss, Newton, PointJacobian, Solution,
    System, mesh,
};
use furrow_cell::{Cell, Number, Shell};
use furrow_mechanics::cortex::equations::{COMPONENTS, PSI, REGULATED};
use furrow_mechanics::cortex::{Cortex, Domain};
use furrow_verification::balance::{rates, stress};
use furrow_verification::coefficients::coefficients;
use furrow_verification::report::within;
use furrow_verification::states::{carried_past, cues, resting, uneven_cell};
use num_dual::Dual64;
use std::f64::consts::PI;

/// Contour length, pressure and rate of the step of the chosen state.
const LENGTH: f64 = 6.5;
const PRESSURE: f64 = 1.7;
const RATE: f64 = 2.5;

/// sin kπu and cos kπu.
fn wave<D: Number>(k: f64, u: D) -> [D; 2] {
    let (sin, cos) = (u * (k * PI)).sin_cos();
    [sin, cos]
}

/// ∂_t(r, z) of the chosen state.
fn motion<D: Number>(u: D) -> [D; 2] {
    let ([s1, c1], [s2, c2]) = (wave(1.0, u), wave(2.0, u));
    [s1 * 0.3 + s1 * s2 * s2 * 0.4, c1 * -0.2 + c1 * c2 * 0.3 + c2 * 0.1]
}

/// The chosen regulator φ, its slope by u, and ∂_tφ. It is even at both poles.
fn carried<D: Number>(u: D) -> [D; 3] {
    let ([s1, c1], [s2, c2]) = (wave(1.0, u), wave(2.0, u));
    [c1 * 0.2 + c2 * 0.1, s1 * (-0.2 * PI) - s2 * (0.1 * 2.0 * PI), c1 * -0.3 + c2 * 0.2]
}

/// The chosen state. As on any smooth surface, both principal curvatures and both strain rates are equal at the poles: that
/// fixes how r and v start there, and with them m and T.
fn chosen<D: Number, const N: usize>(cell: &Cell, u: D) -> [D; N] {
    let ([s1, c1], [s2, c2]) = (wave(1.0, u), wave(2.0, u));
    let psi = u * PI + s2 * 0.25 + s1 * s1 * s2 * 0.2;
    // Of sin²πu sin 2πu the slope is 2π(sin πu cos πu sin 2πu + sin²πu cos 2πu).
    let psi_u = c2 * (0.25 * 2.0 * PI) + (s1 * c1 * s2 + s1 * s1 * c2) * (0.2 * 2.0 * PI) + PI;
    let r = s1 * (s1 * s1 * 0.3 + 1.0) * (LENGTH / PI);
    let z = c1 * 1.9 + c2 * 0.1;
    let (v, v_u) = (s1 * 0.2 - s2 * 0.3, c1 * (0.2 * PI) - c2 * (0.3 * 2.0 * PI));
    let q = s1 * 0.4 + s2 * 0.6;
    let [phi, phi_u, _] = carried(u);
    let here = coefficients(cell, u, D::from(LENGTH), Some([phi, phi_u]));
    let (sin, cos) = psi.sin_cos();
    let curvature = [psi_u / LENGTH, sin / r];
    let [r_t, z_t] = motion(u);
    let v_n = sin * r_t + cos * z_t;
    let strain = [v_u / LENGTH + curvature[0] * v_n, cos * v / r + curvature[1] * v_n];
    let t = stress([here.eta_b, here.eta_s, here.xi_s, here.xi_b], strain, curvature)[0];
    let all: [D; REGULATED] = [
        r,
        z,
        here.kappa * (curvature[0] + curvature[1] - here.spontaneous),
        psi,
        q,
        v,
        t,
        phi_u * (1.0 / LENGTH),
        phi,
    ];
    std::array::from_fn(|k| all[k])
}

/// The cortex with sources.
struct Forced<const N: usize>(Cortex);

impl<const N: usize> Forced<N> {
    /// The sources at u that make the chosen state a solution.
    fn source(&self, u: f64) -> [f64; N] {
        let cell = &self.0.cell;
        let slope = chosen::<_, N>(cell, Dual64::new(u, 1.0)).map(|y| y.eps);
        let ([r_t, z_t], [_, _, phi_t]) = (motion(u), carried(u));
        let rates = rates(cell, u, LENGTH, PRESSURE, 1.0, &chosen::<_, N>(cell, u), [r_t, z_t, phi_t]);
        std::array::from_fn(|k| slope[k] - LENGTH * rates[k])
    }
}

impl<const N: usize> BoundaryValueProblem for Forced<N> {
    fn dimensions(&self) -> Dimensions {
        self.0.dimensions()
    }

    fn rhs(&self, at: CollocationPoint, y: &[f64], p: &[f64], f: &mut [f64], g: &mut [f64]) {
        self.0.rhs(at, y, p, f, g);
        f.iter_mut().zip(self.source(at.x)).for_each(|(f, source)| *f += source);
    }

    fn rhs_jacobian(&self, at: CollocationPoint, y: &[f64], p: &[f64], out: &mut PointJacobian<'_>) {
        self.0.rhs_jacobian(at, y, p, out);
        out.f.iter_mut().zip(self.source(at.x)).for_each(|(f, source)| *f += source);
    }

    fn left(&self, y: &[f64], p: &[f64], out: &mut BoundaryJacobian<'_>) {
        self.0.left(y, p, out);
    }

    fn right(&self, y: &[f64], p: &[f64], out: &mut BoundaryJacobian<'_>) {
        self.0.right(y, p, out);
    }

    fn integral_offset(&self, k: usize, p: &[f64], hp: &mut [f64]) -> f64 {
        self.0.integral_offset(k, p, hp)
    }
}

/// A cell with the volume of the chosen state.
fn cell(cue: &str) -> Cell {
    let gauss = Gauss::new(5).unwrap();
    let grid = mesh::uniform(0.0, 1.0, 64);
    let plain = uneven_cell(2.0, 8.0, cue).unwrap();
    let density = |u: f64| {
        let y: [f64; COMPONENTS] = chosen(&plain, u);
        PI * LENGTH * y[0] * y[0] * y[3].sin()
    };
    let volume: f64 = grid
        .windows(2)
        .flat_map(|x| gauss.c.iter().zip(&gauss.b).map(|(c, b)| b * (x[1] - x[0]) * density(x[0] + c * (x[1] - x[0]))))
        .sum();
    // The chosen state is far from the shell's shape: a soft shell keeps the forces small.
    let shell = Shell { aspect: 1.2, p0: 0.5, w: 0.7, ..Shell::GAO2026 };
    Cell { r0: (0.75 * volume / PI).cbrt(), epsilon: 0.8, shell, ..plain }
}

/// Largest errors of the solution.
struct Errors {
    /// Of the components at nodes away from the poles.
    nodes: f64,
    /// Of the components anywhere.
    anywhere: f64,
    /// Of (L, p).
    scalars: f64,
}

/// Solves from a guess near the chosen state and compares with that state.
fn errors(cue: &str, m: usize, intervals: usize) -> Errors {
    let cell = cell(cue);
    match cell.cue.regulator() {
        Some(_) => errors_of::<REGULATED>(cell, m, intervals),
        None => errors_of::<COMPONENTS>(cell, m, intervals),
    }
}

fn errors_of<const N: usize>(cell: Cell, m: usize, intervals: usize) -> Errors {
    let gauss = Gauss::new(m).unwrap();
    let grid = mesh::uniform(0.0, 1.0, intervals);
    let mut y = Solution::from_fn(&gauss, &grid, N, &[LENGTH * 1.001, PRESSURE * 1.01], |u, y| {
        // r vanishes at the poles: the guess starts a little beside them.
        y.copy_from_slice(&chosen::<_, N>(&cell, u.clamp(1e-6, 1.0 - 1e-6)));
        y.iter_mut().enumerate().for_each(|(k, y)| *y *= 1.0 + 1e-3 * (k as f64 + 5.0 * u).sin());
    })
    .unwrap();
    let mut cortex = Cortex::new(&cell, Domain::Full, &[]);
    cortex.rate = RATE;
    for i in 0..intervals {
        for j in 0..m {
            let u = y.stage_x(&gauss, i, j);
            let (state, moved) = (chosen::<_, REGULATED>(&cell, u), motion(u));
            let (sin, cos) = state[PSI].sin_cos();
            let by_u = motion(Dual64::new(u, 1.0)).map(|moved| moved.eps);
            let stretching = (cos * by_u[0] - sin * by_u[1]) / LENGTH;
            let rates = [carried(u)[2], moved[0], stretching];
            cortex.carried_past.push(carried_past(&cell, &state, LENGTH, RATE, rates));
            cortex.past.push([state[0] - moved[0] / RATE, state[1] - moved[1] / RATE]);
        }
    }
    let mut forced = Forced::<N>(cortex);
    let mut system = System::new(forced.dimensions(), m);
    let newton = Newton { tolerance: 1e-9, ..Newton::default() };
    newton.solve(&mut system, &mut NewtonScratch::default(), &mut forced, &mut y, &[], false).unwrap();
    let off = |u: f64, found: &[f64]| {
        let exact: [f64; N] = chosen(&cell, u.clamp(1e-9, 1.0 - 1e-9));
        exact.iter().zip(found).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()))
    };
    let away = (1..intervals).filter(|&i| (0.25..=0.75).contains(&y.mesh[i]));
    let nodes = away.map(|i| off(y.mesh[i], y.node(i))).fold(0.0, f64::max);
    let mut anywhere = 0.0f64;
    let mut value = [0.0; N];
    for i in 0..intervals {
        for theta in [0.15, 0.4, 0.7, 0.9] {
            y.eval_in(&gauss, i, theta, &mut value);
            anywhere = anywhere.max(off(y.mesh[i] + theta * (y.mesh[i + 1] - y.mesh[i]), &value));
        }
    }
    Errors { nodes, anywhere, scalars: (y.scalars[0] - LENGTH).abs().max((y.scalars[1] - PRESSURE).abs()) }
}

/// The chosen state is found for every cue, with its pressure and contour length.
#[test]
fn a_chosen_state_is_found_again_whatever_the_cue() {
    let mut largest = 0.0f64;
    for cue in cues() {
        let Errors { nodes, scalars, .. } = errors(&cue, 4, 32);
        println!("{cue}: {nodes:.1e} {scalars:.1e}");
        largest = largest.max(nodes).max(scalars);
    }
    within("chosen states", largest, 1e-8);
}

/// The same of the paper's law as text.
#[test]
fn a_chosen_state_is_found_again_by_a_law_as_text() {
    let law = furrow_cell::Law::parse(include_str!("../../../../examples/laws/paper.ron"), "paper.ron").unwrap();
    let mut largest = 0.0f64;
    for cue in cues().iter().step_by(3) {
        let cell = cell(cue).with_law(law.clone());
        let Errors { nodes, scalars, .. } = match cell.cue.regulator() {
            Some(_) => errors_of::<REGULATED>(cell, 4, 32),
            None => errors_of::<COMPONENTS>(cell, 4, 32),
        };
        largest = largest.max(nodes).max(scalars);
    }
    within("chosen states, law as text", largest, 1e-8);
}

/// Expected orders at nodes rise by two with each stage.
const ORDER: f64 = 0.8;

/// The order seen between two numbers of intervals, one twice the other.
fn order(coarse: f64, fine: f64) -> f64 {
    (coarse / fine).log2()
}

/// The order is 2m at nodes and in (L, p). Elsewhere, even next to the singular poles, it is m + 1 for an odd number of stages
/// and m for an even one.
#[test]
fn the_collocation_of_a_cell_has_order_2m() {
    for (m, intervals) in [(1, 32), (2, 32), (3, 32), (4, 16), (5, 12)] {
        let [coarse, fine] = [1, 2].map(|k| errors("none", m, k * intervals));
        let (at_nodes, expected) = (order(coarse.nodes, fine.nodes), 2.0 * m as f64);
        let [a, b] = [1, 2].map(|k| errors("none", m, 32 * k).anywhere);
        let (anywhere, least) = (order(a, b), if m % 2 == 0 { m } else { m + 1 } as f64);
        println!("m = {m}: {at_nodes:.2} at nodes, {anywhere:.2} anywhere");
        within(&format!("order at nodes, m = {m}"), (at_nodes - expected).abs(), ORDER);
        within(&format!("order anywhere, m = {m}"), (anywhere - least).abs(), 0.6);
        if m < 5 {
            // With five stages the scalars are exact to rounding on the finer mesh.
            let scalars = order(coarse.scalars, fine.scalars);
            within(&format!("order of (L, p), m = {m}"), (scalars - expected).abs(), ORDER);
        }
    }
}

/// For a shape at rest, without a known solution: each mesh refinement changes (L, p) 2^(2m) times less.
#[test]
fn shapes_at_rest_converge_with_order_2m() {
    let cell = uneven_cell(2.0, 9.0, "kappa:band,u0=0.44,omega=0.3,amplitude=0.2").unwrap();
    let exact = resting(&cell).unwrap().shape;
    let scalars = |m: usize, intervals: usize| {
        let gauss = Gauss::new(m).unwrap();
        let grid = mesh::uniform(0.0, 1.0, intervals);
        let from = |u: f64, y: &mut [f64]| exact.eval(&exact.gauss(), u, y);
        let mut y = Solution::from_fn(&gauss, &grid, COMPONENTS, &exact.scalars, from).unwrap();
        let mut cortex = Cortex::new(&cell, Domain::Full, &[]);
        let mut system = System::new(cortex.dimensions(), m);
        Newton::default().solve(&mut system, &mut NewtonScratch::default(), &mut cortex, &mut y, &[], false).unwrap();
        y.scalars
    };
    for (m, intervals) in [(1, 48), (2, 24), (3, 12), (4, 12)] {
        let found = [1, 2, 4].map(|k| scalars(m, k * intervals));
        let change = |a: usize, b: usize| (found[a][0] - found[b][0]).hypot(found[a][1] - found[b][1]);
        let seen = order(change(0, 1), change(1, 2));
        println!("m = {m}: {seen:.2}, from changes of {:.1e} and {:.1e}", change(0, 1), change(1, 2));
        within(&format!("order at rest, m = {m}"), (seen - 2.0 * m as f64).abs(), ORDER);
    }
}
