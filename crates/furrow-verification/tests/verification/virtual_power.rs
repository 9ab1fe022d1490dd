//! The principle of virtual power: the forces of a computed state do no work on any virtual motion.
//!
//! The paper derives its balance of forces in this way, from the variation of a Rayleighian. The principle uses neither the shear
//! nor the elastic stresses of the solved equations, so an error in any of their terms leaves power on some motion.

use std::f64::consts::PI;
use std::sync::atomic::{AtomicBool, Ordering};

use furrow_bvp::newton::NewtonScratch;
use furrow_bvp::{BoundaryValueProblem, Newton, System};
use furrow_cell::{Cell, Numerics, RigidityGradient};
use furrow_mechanics::azimuthal::Azimuthal;
use furrow_mechanics::azimuthal::mode::Mode;
use furrow_mechanics::cortex::equations::{COMPONENTS, J, M, PHI, PSI, Q, R, T, V, Z};
use furrow_mechanics::cortex::observables::positions;
use furrow_mechanics::cortex::{Cortex, Domain};
use furrow_mechanics::division::{DivisionError, DivisionInput, DivisionOptions, Frame, divide_with};
use furrow_verification::coefficients::coefficients;
use furrow_verification::contour::{Computed, Place};
use furrow_verification::displaced::{Displaced, Virtual};
use furrow_verification::report::{near, within};
use furrow_verification::states::{cues, moving, resting, uneven_cell};
use furrow_verification::virtual_power::{Power, motions, power};

/// Accuracy of sums over collocation points as integrals, and of solved shapes.
const EXACT: f64 = 1e-9;

/// The same for a division at its default resolution.
const SOLVED: f64 = 1e-3;

/// The largest imbalance of a state over all motions, relative to the largest of all powers, since on some motions of a
/// symmetric state every power is 0.
fn worst(state: &Computed) -> f64 {
    let largest = |power: &Power| power.parts().iter().fold(0.0, |most: f64, part| most.max(part.abs()));
    let powers: Vec<Power> = motions().iter().map(|motion| power(state, motion)).collect();
    let size = powers.iter().map(largest).fold(0.0, f64::max);
    powers.iter().map(|power| power.imbalance()).fold(0.0, f64::max) / size
}

#[test]
fn forces_at_rest_do_no_work_whatever_the_cue() {
    let mut largest = 0.0f64;
    for cue in cues() {
        let state = resting(&uneven_cell(2.0, 9.0, &cue).unwrap()).unwrap();
        largest = largest.max(worst(&state));
        println!("{cue}: {:.1e}", worst(&state));
    }
    within("virtual power at rest", largest, EXACT);
}

/// The first ten doubles of the Mersenne twister MT19937 of seed 0, as NumPy's `RandomState(0).random_sample(10)` prints them.
const UNIFORM: [f64; 10] = [
    0.5488135039273248,
    0.7151893663724195,
    0.6027633760716439,
    0.5448831829968969,
    0.4236547993389047,
    0.6458941130666561,
    0.4375872112626925,
    0.8917730007820798,
    0.9636627605010293,
    0.3834415188257777,
];

/// Noise that changes in 1000 τ, early in a division: with the activity times 1 + Σ r_n cos(nπu), r_n uniform on ± the amplitude, forces
/// do no work. The noise that the division itself has is not used.
#[test]
fn noise_on_the_activity_has_the_amplitude_that_is_given() {
    let cell = uneven_cell(3.0, 25.0, "none").unwrap();
    let numerics =
        Numerics { noise: 0.5, noise_time: 1000.0, time_tolerance: 1e-7, intervals: 96, ..Numerics::default() };
    let (stop, mut off, mut frames) = (AtomicBool::new(false), 0.0f64, 0);
    let mut observe = |frame: Frame<'_>| {
        if frame.t == 0.0 || frames == 5 {
            return;
        }
        let (y, m) = (frame.shape, frame.shape.m);
        let places = (0..y.intervals() * m).map(|k| y.stage_x(frame.gauss, k / m, k % m));
        let wave = |u: f64| -> f64 {
            let terms = UNIFORM.iter().zip(1..).map(|(x, n)| (2.0 * x - 1.0) * (f64::from(n) * PI * u).cos());
            numerics.noise * terms.sum::<f64>()
        };
        let noise = places.map(|u| 1.0 + wave(u)).collect();
        let moved = y.stages.chunks_exact(COMPONENTS).zip(&frame.cortex.past);
        let motion = moved.map(|(y, past)| [y[R] - past[0], y[Z] - past[1]].map(|d| d * frame.cortex.rate)).collect();
        off = off.max(worst(&Computed { cell: cell.clone(), shape: y.clone(), motion, noise }));
        frames += 1;
        stop.store(frames == 5, Ordering::Relaxed);
    };
    let options = DivisionOptions { cancel: Some(&stop), ..DivisionOptions::observed_by(&mut observe) };
    let ended = divide_with(&DivisionInput { numerics, ..DivisionInput::new(cell.clone()) }, options);
    assert!(matches!(ended, Err(DivisionError::Cancelled { .. })) && frames == 5);
    within("virtual power under noise", off, 1e-6);
}

#[test]
fn forces_in_motion_do_no_work_whatever_the_cue() {
    let mut largest = 0.0f64;
    for cue in cues() {
        let state = moving(&uneven_cell(2.2, 20.0, &cue).unwrap(), 5).unwrap();
        let speed = state.places().iter().fold(0.0f64, |most, place| most.max(place.v_n.abs()));
        assert!(speed > 0.05, "{cue}: the shape moves: {speed}");
        largest = largest.max(worst(&state));
        println!("{cue}: {:.1e}", worst(&state));
    }
    within("virtual power in motion", largest, EXACT);
}

/// If κ stays with the mesh, as in the paper, its gradient exerts no force.
#[test]
fn a_rigidity_that_stays_with_the_mesh_pulls_at_nothing() {
    let mut cell = uneven_cell(2.0, 9.0, "kappa:band,u0=0.44,omega=0.15,amplitude=0.2").unwrap();
    cell.material.rigidity_gradient = RigidityGradient::Dropped;
    let mut state = resting(&cell).unwrap();
    within("virtual power, κ with the mesh", worst(&state), EXACT);
    state.cell.material.rigidity_gradient = RigidityGradient::Full;
    assert!(worst(&state) > 1e-3, "the two readings differ: {:.1e}", worst(&state));
}

/// The state is consistent: its curve is closed at the axis, its moment is κC, its tension follows from the flow, and it has the
/// cell's volume.
#[test]
fn a_state_is_what_its_unknowns_say() {
    let carried = "regulator:band,u0=0.44,omega=0.2,amplitude=0.5,turnover=4,diffusion=0.7,xi_s=0.4";
    let cells = ["none", "kappa:band,u0=0.44,omega=0.15,amplitude=0.2", "viscosity:gradient,amplitude=0.25", carried];
    for cell in cells.map(|cue| uneven_cell(2.2, 9.0, cue).unwrap()) {
        for state in [resting(&cell).unwrap(), moving(&cell, 5).unwrap()] {
            let most = |of: fn(&Place) -> f64| state.places().iter().fold(0.0f64, |most, place| most.max(of(place)));
            within("the curve and κC", most(|p| p.geometry.iter().fold(0.0, |most: f64, g| most.max(g.abs()))), 1e-8);
            within("T_uu", most(|p| (p.viscous[0] + p.active[0] - p.tension).abs()), 1e-8);
            // Smooth at the poles, without point forces.
            let last = state.shape.node(state.shape.intervals());
            let [first, last] =
                [state.shape.node(0), last].map(|y| [y[R], y[PSI], y[Q], y[V], y.get(J).copied().unwrap_or(0.0)]);
            let at_end = [0.0, PI, 0.0, 0.0, 0.0];
            let ends = first.iter().zip(last).zip(at_end).map(|((a, b), at_end)| a.abs().max((b - at_end).abs()));
            within("the poles", ends.fold(0.0, f64::max), 1e-8);
            // By the divergence theorem, 3V = ∮ x·n dA.
            let volume = state.integral(|p| p.r * p.normal[0] + p.z * p.normal[1]) / 3.0;
            near("volume", volume, 4.0 * PI * cell.r0.powi(3) / 3.0, EXACT);
        }
    }
}

/// At every cut the axial resultant of tension, shear and pressure balances the shell's force and friction on one part of the
/// surface. The last cut leaves nothing on the other side.
#[test]
fn axial_forces_balance_at_every_cut() {
    let mut largest = 0.0f64;
    for cue in cues() {
        let state = resting(&uneven_cell(2.0, 9.0, &cue).unwrap()).unwrap();
        let (y, places, mut outside, mut size) = (&state.shape, state.places(), 0.0, 0.0f64);
        for (i, points) in places.chunks(y.m).enumerate() {
            let force = |p: &Place| p.area * (p.shell * p.normal[1] + p.here.friction * p.v * p.normal[0]);
            outside += points.iter().map(force).sum::<f64>();
            size += points.iter().map(|p| force(p).abs()).sum::<f64>();
            let node = y.node(i + 1);
            let (sin, cos) = node[PSI].sin_cos();
            let node = y.node(i + 1);
            let carried = node.get(PHI).map(|phi| [*phi, node[J] * state.length()]);
            let here = coefficients(&state.cell, y.mesh[i + 1], state.length(), carried);
            // At the axis everything vanishes with r.
            let c2 = if i + 1 < y.intervals() { sin / node[R] } else { 0.0 };
            let bent = node[M] / here.kappa;
            let c1 = bent + here.spontaneous - c2;
            let along = node[T] + here.tension + here.kappa * bent * (0.5 * bent - c1);
            let through = 2.0 * PI * node[R] * (node[Q] * cos - along * sin) + state.pressure() * PI * node[R].powi(2);
            largest = largest.max((through + outside).abs() / size);
        }
    }
    within("axial forces at cuts", largest, EXACT);
}

/// At rest the dissipation equals the active power: tension, bending, pressure and shell do no work.
#[test]
fn at_rest_activity_pays_for_all_dissipation() {
    let mut largest = 0.0f64;
    for cue in cues() {
        let state = resting(&uneven_cell(2.0, 9.0, &cue).unwrap()).unwrap();
        let on = |stress: [f64; 2], place: &Place| stress[0] * place.strain[0] + stress[1] * place.strain[1];
        let viscous = state.integral(|place| on(place.viscous, place));
        let friction = state.integral(|place| place.here.friction * place.v * place.v);
        let active = state.integral(|place| on(place.active, place));
        let passive = state.integral(|place| {
            let [c1, c2] = place.curvature;
            let pull = 0.5 * (c1 + c2 - place.here.spontaneous).powi(2) * place.here.kappa_s;
            on([place.here.tension; 2], place) - pull * place.v
        });
        assert!(viscous > 0.0 && friction > 0.0, "{cue}: {viscous} {friction}");
        largest = largest.max((viscous + friction + active + passive).abs() / (viscous + friction));
    }
    within("power at rest", largest, EXACT);
}

/// A division: at t = 0 the balance holds for the cell without activity and cue, on a mirror-symmetric shape; from the first
/// step on it has both.
#[test]
fn the_cue_is_switched_on_with_the_activity() {
    let cue = "kappa:band,u0=0.44,omega=0.15,amplitude=0.2+tension:gradient,amplitude=0.3";
    let cell = Cell::gao2026_thresholds(3.0).with_cue(cue.parse().unwrap());
    let (mut before, mut after, mut frames) = (None, 0.0f64, 0);
    divide_with(
        &DivisionInput::new(cell.clone()),
        DivisionOptions::observed_by(&mut |frame| {
            if frame.t == 0.0 {
                let passive = Cell { xi_s: 0.0, cue: "none".parse().unwrap(), ..cell.clone() };
                let state =
                    Computed { cell: passive, shape: frame.shape.clone(), motion: Vec::new(), noise: Vec::new() };
                before = Some(worst(&state));
                return;
            }
            if frame.neck.is_some() || !frame.cortex.noise.is_empty() {
                return;
            }
            let moved = frame.shape.stages.chunks_exact(COMPONENTS).zip(&frame.cortex.past);
            let motion =
                moved.map(|(y, past)| [y[R] - past[0], y[Z] - past[1]].map(|d| d * frame.cortex.rate)).collect();
            let state = Computed { cell: cell.clone(), shape: frame.shape.clone(), motion, noise: Vec::new() };
            after = after.max(worst(&state));
            frames += 1;
        }),
    )
    .unwrap();
    assert!(frames > 5, "{frames} shapes without noise before there is a neck");
    within("virtual power at t = 0, without cue", before.unwrap(), SOLVED);
    within("virtual power after the first step, with cue", after, SOLVED);
}

/// A mode of azimuthal number m of a shape at rest, the `rank`-th of those that do not oscillate.
fn with_mode(state: &Computed, m: usize, rank: usize) -> Mode {
    let cortex = Cortex::new(&state.cell, Domain::Full, &[]);
    let mut disturbances = Azimuthal::new(&cortex, &state.shape, m);
    let rates = disturbances.leading().unwrap().values;
    let real: Vec<f64> = rates.iter().filter(|rate| rate.im == 0.0).map(|rate| rate.re).collect();
    disturbances.mode(real.get(rank).copied().unwrap_or(real[0])).unwrap()
}

/// The largest imbalance of a state with a mode on it over all virtual motions, relative to the largest of all powers.
fn imbalance(state: &Computed, mode: &Mode) -> f64 {
    let powers = Displaced { state, mode }.powers(&Virtual::all());
    let size = powers.iter().map(|power| power.largest()).fold(0.0, f64::max);
    powers.iter().map(|power| power.imbalance()).fold(0.0, f64::max) / size
}

/// Forces do no work on the displaced surface either, and nothing of a regulator is lost there: every term of the linearised balances.
#[test]
fn forces_do_no_work_where_a_mode_displaces_the_surface() {
    let mut largest = 0.0f64;
    let cues = cues();
    let carried = cues.len() - 4;
    // Every field, profiles in turn, and the last regulators.
    for (k, cue) in cues.iter().enumerate().filter(|(k, _)| k % 4 == 0 || *k >= carried) {
        let state = resting(&uneven_cell(2.0, 9.0, cue).unwrap()).unwrap();
        // Without a cue, every m.
        for m in if k == 0 { 0..4 } else { 1 + k % 3..2 + k % 3 } {
            let mode = with_mode(&state, m, k % 2);
            let displaced = Displaced { state: &state, mode: &mode };
            let worst = imbalance(&state, &mode).max(displaced.arclength_error());
            println!("{cue}, m = {m}, σ = {}: {worst:.1e}", mode.rate);
            largest = largest.max(worst);
        }
    }
    within("virtual power on a displaced surface", largest, EXACT);
}

/// The same of a moving shape, frozen at an instant: it has a normal velocity of its own.
#[test]
fn forces_do_no_work_where_a_mode_displaces_a_moving_surface() {
    let before = moving(&uneven_cell(2.0, 30.0, "none").unwrap(), 6).unwrap();
    let mut cortex = Cortex::new(&before.cell, Domain::Full, &[]);
    cortex.rate = 20.0;
    positions(&before.shape, &mut cortex.past);
    let (mut shape, mut system) = (before.shape.clone(), System::new(cortex.dimensions(), before.shape.m));
    let newton = Newton { tolerance: 1e-11, ..Newton::default() };
    newton.solve(&mut system, &mut NewtonScratch::default(), &mut cortex, &mut shape, &[], false).unwrap();
    let now = shape.stages.chunks_exact(COMPONENTS).zip(&cortex.past);
    let motion: Vec<[f64; 2]> =
        now.map(|(y, past)| [cortex.rate * (y[R] - past[0]), cortex.rate * (y[Z] - past[1])]).collect();
    assert!(motion.iter().any(|rate| rate[0].abs() > 0.1), "it hardly moves");
    let state = Computed { shape, motion, noise: Vec::new(), ..before };
    for m in 0..3 {
        let mut disturbances = Azimuthal::frozen(&cortex, &state.shape, m);
        let rate = disturbances.leading().unwrap().growth_rate();
        let mode = disturbances.mode(rate).unwrap();
        within(&format!("virtual power, m = {m}, σ = {rate}"), imbalance(&state, &mode), EXACT);
    }
}
