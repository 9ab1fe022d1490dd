//! Powers: what activity does is dissipated or stored, and the volume is kept.

use std::collections::HashSet;

use furrow_cell::RigidityGradient;
use furrow_surface::law::{Contact, Flow, Geometry, Place, Shape, Vector};
use furrow_surface::neck::neck;
use furrow_surface::number::Gradient;
use furrow_surface::problem::{Problem, State};

use crate::states::{Draws, bent, one_sided, one_sided_steps, uneven_cell, within};

fn dot(a: &Vector<f64>, b: &Vector<f64>) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Viscosity, friction, change of energy, activity, and the pressures less their signs, on the flow itself.
#[derive(Clone, Copy, Debug, Default)]
struct Powers {
    dissipation: f64,
    elastic: f64,
    active: f64,
    pressure: f64,
    walls: f64,
    /// What κ of the mesh, rather than of the material, takes away.
    dropped: f64,
}

impl Powers {
    fn parts(&self) -> [f64; 6] {
        [self.dissipation, self.elastic, self.active, self.pressure, self.walls, self.dropped]
    }

    fn size(&self) -> f64 {
        self.parts().iter().map(|part| part.abs()).sum()
    }

    /// Adds a point, with the stresses of S.2 in an orthonormal frame of the surface.
    fn add(&mut self, weight: f64, place: &Place, x: &Shape<f64>, v: &Flow<f64>, pressure: f64) {
        let geometry = Geometry::new(x);
        let (n, local) = (geometry.normal, &place.local);
        let area = weight * geometry.area;
        let v_n = dot(&v[0], &n);
        // Columns of `frame` are the components of X_u and X_φ in the frame; its inverse turns ∂_i into derivatives along the frame.
        let size = dot(&x[1], &x[1]).sqrt();
        let e1 = x[1].map(|x| x / size);
        let e2 = [n[1] * e1[2] - n[2] * e1[1], n[2] * e1[0] - n[0] * e1[2], n[0] * e1[1] - n[1] * e1[0]];
        let (along, across) = (dot(&x[2], &e1), dot(&x[2], &e2));
        let by = |u: f64, p: f64| [u / size, (p - u * along / size) / across];
        let slope = |e: &Vector<f64>| by(dot(&v[1], e), dot(&v[2], e));
        let (s1, s2) = (slope(&e1), slope(&e2));
        let strain = [s1[0], 0.5 * (s1[1] + s2[0]), s2[1]];
        let [c_uu, c_up, c_pp] = geometry.curvature;
        let (first, second) = (by(c_uu, c_up), by(c_up, c_pp));
        let turned = [by(first[0], second[0]), by(first[1], second[1])];
        let bend = [turned[0][0], turned[0][1], turned[1][1]];
        let (grown, mean) = (strain[0] + strain[2], bend[0] + bend[2]);
        let [eta_b, eta_s] =
            [0.5 * (local.eta_sum + local.eta_difference), 0.5 * (local.eta_sum - local.eta_difference)];
        let squared = strain[0].powi(2) + 2.0 * strain[1].powi(2) + strain[2].powi(2);
        let sheared = 2.0 * (squared - 0.5 * grown * grown);
        let slipping = dot(&v[0], &v[0]) - v_n * v_n;
        self.dissipation += area
            * (eta_b * grown * grown
                + eta_s * sheared
                + local.friction * slipping
                + place.shell.normal_friction * v_n * v_n);
        let shear = bend[0] * strain[0] + 2.0 * bend[1] * strain[1] + bend[2] * strain[2] - 0.5 * mean * grown;
        self.active += area * place.noise * (local.xi_s * shear + local.xi_b * mean * grown);
        self.pressure -= area * pressure * v_n;
        let shell = &place.shell;
        let inside = (x[0][0].powi(2) + x[0][1].powi(2)) * shell.inverse_b2 + x[0][2].powi(2) * shell.inverse_a2 - 1.0;
        let outwards = (x[0][0] * n[0] + x[0][1] * n[1]) * shell.inverse_b2 + x[0][2] * n[2] * shell.inverse_a2;
        self.walls += area * v_n * shell.shell_force * (inside * shell.inverse_w2).exp() * outwards;
        let Contact { pressure, decay, origin, normal, distance } = place.contact;
        let moved: Vector<f64> = std::array::from_fn(|k| x[0][k] - origin[k]);
        self.walls += area * v_n * pressure * ((2.0 * dot(&moved, &normal) - distance) * decay).exp();
        if !shell.rigidity_gradient {
            let gradient = by(local.kappa_u, 0.0);
            let flow = [dot(&v[0], &e1), dot(&v[0], &e2)];
            let bent = mean - local.spontaneous;
            self.dropped += area * 0.5 * bent * bent * (gradient[0] * flow[0] + gradient[1] * flow[1]);
        }
    }
}

/// The powers of a state, and the balances' power on the flow.
fn powers(problem: &Problem, state: &State) -> (Powers, f64) {
    let space = &problem.space;
    let mut out = Powers::default();
    let mut flow = Vec::new();
    problem.for_each_point(state, |q, j, place, x, v, _| {
        let weight = space.stations[q].weight * space.meridian_weight();
        out.add(weight, place, x, v, state.pressure);
        space.functions(&state.flow, &space.stations[q], &mut flow);
        let moving = space.shape(&flow, &space.meridians[j]);
        // The energy of the surface X + εv, where every point keeps its κ and γ.
        let moved: Shape<Gradient<1>> =
            std::array::from_fn(|d| std::array::from_fn(|k| Gradient { value: x[d][k], by: [moving[d][k]] }));
        let geometry = Geometry::new(&moved);
        let bent = geometry.mean - place.local.spontaneous;
        let density = (bent * bent * (0.5 * place.local.kappa) + place.local.tension) * geometry.area;
        out.elastic += weight * density.by[0];
    });
    let balances = problem.residual(state).balances;
    let count = space.harmonics.len();
    let mut seen = HashSet::new();
    let mut power = 0.0;
    for k in 0..state.flow.len() {
        if let Some(row) = space.unknown(k / count, 1, k % count).filter(|row| seen.insert(*row)) {
            power += balances[row] * state.flow[k];
        }
    }
    (out, power)
}

/// For any state, the balances' power on its flow is the sum of the powers.
#[test]
fn powers_of_any_state_are_those_of_its_balances() {
    let cue = "kappa:band,u0=0.4,omega=0.2,amplitude=0.4+activity:gradient,amplitude=0.3+viscosity:gradient,amplitude=0.4\
               +eta_s:band,u0=0.5,omega=0.3,amplitude=-0.3+friction:gradient,amplitude=-0.5+tension:band,u0=0.6,omega=0.2,amplitude=0.6";
    for reading in [RigidityGradient::Full, RigidityGradient::Dropped] {
        let mut cell = uneven_cell(2.0, 20.0, cue);
        cell.material.rigidity_gradient = reading;
        let (mut problem, state) = bent(&cell, 16, 3, 3);
        let mut draws = Draws(11);
        problem.contacts = (0..problem.noise.len())
            .map(|_| {
                let [normal, origin] = [0; 2].map(|_| [draws.next(), draws.next(), draws.next()]);
                Contact { pressure: 0.7, decay: 0.4, origin, normal, distance: draws.next() }
            })
            .collect();
        let (found, power) = powers(&problem, &state);
        println!("{found:?}");
        within("power", (found.parts().iter().sum::<f64>() - power).abs() / found.size(), 1e-12);
    }
}

/// During a one-sided division activity pays for dissipation and energy.
#[test]
fn activity_pays_for_dissipation_and_energy() {
    for (_, problem, state) in one_sided() {
        let (found, power) = powers(problem, state);
        within("power", (found.parts().iter().sum::<f64>() - power).abs() / found.size(), 1e-10);
        within("imbalance", power.abs() / found.size(), 1e-5);
        println!("{found:?}");
        assert!(found.dissipation > 0.0, "{found:?}");
        let volume = problem.volume(&state.surface) / problem.constants.volume - 1.0;
        within("volume", volume.abs(), 1e-8);
    }
}

/// The bending energy of a state; without a cue κ is the same everywhere.
fn energy(problem: &Problem, state: &State) -> f64 {
    let space = &problem.space;
    let mut out = 0.0;
    problem.for_each_point(state, |q, _, place, x, _, _| {
        let geometry = Geometry::new(x);
        let bent = geometry.mean - place.local.spontaneous;
        let density = 0.5 * place.local.kappa * bent * bent + place.local.tension;
        out += space.stations[q].weight * space.meridian_weight() * geometry.area * density;
    });
    out
}

/// From step to step the energy grows by its power: the surface moves as the flow says, however the mesh moves.
#[test]
fn the_energy_grows_by_its_power() {
    let [mut off, mut spent] = [0.0; 2];
    let mut before: Option<(f64, f64, Powers)> = None;
    // The first state does not move yet.
    for (t, problem, state) in one_sided_steps().iter().skip(1) {
        let (found, imbalance) = powers(problem, state);
        within("imbalance", imbalance.abs() / found.size(), 1e-4);
        let stored = energy(problem, state);
        if let Some((last, was, powers)) = before.replace((*t, stored, found)) {
            let dt = t - last;
            off += (stored - was - 0.5 * dt * (powers.elastic + found.elastic)).abs();
            spent += 0.5 * dt * (powers.dissipation + found.dissipation);
        }
        if neck(&problem.space, &state.surface).is_some_and(|neck| neck.radius < 0.6) {
            break;
        }
    }
    println!("{off} of {spent}");
    within("energy beside its power", off / spent, 0.005);
}
