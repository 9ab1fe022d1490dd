//! States of the chemistry at one size: evolution in time, observables.

use furrow_bvp::BoundaryValueProblem;
use furrow_bvp::newton::NewtonScratch;
use furrow_bvp::{Gauss, InvalidInput, Newton, NewtonError, NewtonReport, Solution, System, mesh};
use furrow_cell::cue::{Profile, Width};
use serde::Serialize;

use super::problem::{A, A_U, COMPONENTS, MEAN_A, P, P_U, Polarity};

/// Discretisation of the chemistry: the boundary is far narrower than the furrow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution {
    /// Mesh intervals.
    pub intervals: usize,
    /// Gauss points in each interval.
    pub stages: usize,
}

impl Default for Resolution {
    fn default() -> Self {
        Resolution { intervals: 120, stages: 4 }
    }
}

/// Newton's tolerance for states.
pub(super) const NEWTON: Newton = Newton {
    tolerance: 1e-10,
    max_factorisations: 30,
    max_iterations: 100,
    min_damping: 1e-3,
    leniency: 1.0,
    chord_contraction: 0.3,
};

/// Width of the boundary in an initial state, in µm.
const START_WIDTH: f64 = 1.5;

/// Both antagonists, P at the posterior pole, with a boundary at `u`: the initial state of the evolution.
///
/// # Errors
/// [`InvalidInput`] for an unsupported resolution.
pub fn step(problem: &Polarity, resolution: Resolution, u: f64) -> Result<Solution, InvalidInput> {
    let scale = problem.fixed_scale.unwrap_or(1.0);
    let c = &problem.constants;
    let psi = problem.membrane.psi(c, scale);
    let alone = |k_on: f64, k_off: f64, rho: f64| k_on * rho / (k_off + k_on * psi);
    // Each as without the other on its own side; the pool holds the amount missing on the other side.
    let (a, p) = (alone(c.k_on_a, c.k_off_a, c.rho_a), alone(c.k_on_p, c.k_off_p, c.rho_p));
    let omega = START_WIDTH / (problem.membrane.length * scale);
    let gauss = Gauss::new(resolution.stages)?;
    let grid = mesh::uniform(0.0, 1.0, resolution.intervals);
    Solution::from_fn(&gauss, &grid, COMPONENTS, &[0.5 * a, 0.5 * p], |x, y| {
        let t = ((x - u) / omega).clamp(-300.0, 300.0).tanh();
        let (rise, slope) = (0.5 * (1.0 + t), 0.5 * (1.0 - t * t) / omega);
        (y[A], y[P]) = (a * rise, p * (1.0 - rise));
        (y[A_U], y[P_U]) = (a * slope, -p * slope);
    })
}

/// Evolution in time by implicit steps, on a mesh that follows the boundary.
pub(crate) struct Evolution {
    /// The problem at a given scale.
    pub problem: Polarity,
    /// The state.
    pub state: Solution,
    /// Time passed, in s.
    pub time: f64,
    system: System,
    scratch: NewtonScratch,
    weight: Vec<f64>,
}

/// The mesh moves when its largest interval carries this many times its share of the defect.
const REMESH_ABOVE: f64 = 1.8;

impl Evolution {
    /// Starts from a state of a problem of fixed scale.
    pub fn new(problem: Polarity, state: Solution) -> Evolution {
        let system = System::new(problem.dimensions(), state.m);
        Evolution { problem, state, time: 0.0, system, scratch: NewtonScratch::default(), weight: Vec::new() }
    }

    /// Largest defect of the state as a stationary one, see [`mesh::defect`].
    pub fn defect(&mut self) -> f64 {
        mesh::defect(&self.system.gauss, &mut self.problem, &self.state).into_iter().fold(0.0, f64::max)
    }

    /// Moves the mesh if it no longer fits the state.
    fn remesh(&mut self) {
        let Evolution { problem, state, weight, system, .. } = self;
        let defect = mesh::defect(&system.gauss, problem, state);
        mesh::defect_monitor(&state.mesh, &defect, state.m, weight);
        let imbalance = mesh::imbalance(&state.mesh, weight);
        if imbalance > REMESH_ABOVE && imbalance.is_finite() {
            let mut grid = Vec::new();
            mesh::equidistribute(&state.mesh, weight, weight.len(), &mut grid);
            *state = state.on_mesh(&system.gauss, &grid);
            self.remember();
        }
    }

    /// Stores the state as the past of the next step.
    fn remember(&mut self) {
        let values = &mut self.problem.past.values;
        values.clear();
        values.extend(self.state.stages.chunks_exact(COMPONENTS).map(|y| [y[A], y[P]]));
    }

    /// One implicit step of `dt` seconds; an infinite step gives a stationary state. The state is unchanged on an
    /// error.
    ///
    /// # Errors
    /// Newton's method does not converge.
    pub fn advance(&mut self, dt: f64) -> Result<NewtonReport, NewtonError> {
        self.problem.past.rate = 0.0;
        self.remesh();
        self.remember();
        self.problem.past.rate = dt.recip();
        let mut next = self.state.clone();
        let Evolution { problem, system, scratch, .. } = self;
        let report = NEWTON.solve(system, scratch, problem, &mut next, &[], false);
        self.problem.past.rate = 0.0;
        let report = report?;
        self.state = next;
        self.time += dt;
        Ok(report)
    }

    /// Follows the state until `time` seconds have passed, by steps that grow from `first` while they succeed.
    ///
    /// # Errors
    /// Newton's method does not converge for the shortest step.
    pub fn until(&mut self, time: f64, first: f64) -> Result<(), NewtonError> {
        let mut dt = first;
        while self.time < time {
            match self.advance(dt.min(time - self.time)) {
                Ok(_) => dt *= GROWTH,
                Err(error) if dt < 1e-6 => return Err(error),
                Err(_) => dt *= 0.2,
            }
        }
        Ok(())
    }

    /// Follows the state to rest.
    ///
    /// # Errors
    /// Newton's method does not converge for the shortest step.
    pub fn rest(&mut self) -> Result<(), NewtonError> {
        self.until(LONG, FIRST_STEP)?;
        // The second time on the mesh of the stationary state itself.
        for _ in 0..2 {
            self.advance(f64::INFINITY)?;
        }
        self.time = LONG;
        Ok(())
    }
}

/// Seconds after which every state rests.
const LONG: f64 = 1e9;

/// Growth of the steps: evolution to rest takes about fifty steps.
const GROWTH: f64 = 1.6;

/// The first step, in s.
const FIRST_STEP: f64 = 0.1;

/// Observables of a polarised state.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Readings {
    /// The boundary: the position where P equals the mean of its values at the poles.
    pub u0: f64,
    /// Width, P.3: the ω for which ½(1 + tanh((u − u0)/ω)), between the values at the poles, has the slope of P at the
    /// boundary. Negative, since P decreases from the posterior pole, u = 0.
    pub omega: f64,
    /// A at the posterior and at the anterior pole, 1/µm².
    pub a: [f64; 2],
    /// P at the same poles.
    pub p: [f64; 2],
    /// Means over the surface of A and P.
    pub means: [f64; 2],
}

impl Readings {
    /// The profile of a term that follows P: a step between the poles, or a band at the boundary with its width.
    pub fn followed(&self, band: bool) -> Profile {
        let Readings { u0, omega, .. } = *self;
        match band {
            true => Profile::Band { u0, omega: Width::Fraction(omega.abs()) },
            false => Profile::Step { u0, omega: Width::Fraction(omega) },
        }
    }
}

/// A state is polarised if P differs between the poles by more than this fraction of the sum.
pub(crate) const POLARISED: f64 = 0.05;

/// (P(0) − P(1))/(P(0) + P(1)): 0 for even states, 1 for complete polarity with P at the posterior pole.
pub fn polarity(y: &Solution) -> f64 {
    let (first, last) = (y.node(0)[P], y.node(y.intervals())[P]);
    (first - last) / (first + last)
}

/// Whether a state is polarised, in either direction.
pub(crate) fn is_polarised(y: &Solution) -> bool {
    polarity(y).abs() > POLARISED
}

/// The observables of a state; `None` unless it is polarised with P at the posterior pole.
pub fn readings(y: &Solution) -> Option<Readings> {
    if polarity(y) <= POLARISED {
        return None;
    }
    let gauss = y.gauss();
    let (first, last) = (y.node(0), y.node(y.intervals()));
    let middle = 0.5 * (first[P] + last[P]);
    let i = (0..y.intervals()).find(|&i| y.node(i)[P] >= middle && y.node(i + 1)[P] < middle)?;
    let mut value = [0.0; COMPONENTS];
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let theta = 0.5 * (low + high);
        y.eval_in(&gauss, i, theta, &mut value);
        if value[P] >= middle { low = theta } else { high = theta }
    }
    let u0 = y.mesh[i] + low * (y.mesh[i + 1] - y.mesh[i]);
    let omega = (first[P] - last[P]) / (2.0 * value[P_U]);
    let means = [y.scalars[MEAN_A], y.scalars[MEAN_A + 1]];
    Some(Readings { u0, omega, a: [first[A], last[A]], p: [first[P], last[P]], means })
}

/// A and P at `count` + 1 evenly spaced places from pole to pole: u, A, P.
pub fn profile(y: &Solution, count: usize) -> Vec<[f64; 3]> {
    let gauss = y.gauss();
    let mut value = [0.0; COMPONENTS];
    let mut at = |k: usize| {
        let u = k as f64 / count as f64;
        y.eval(&gauss, u, &mut value);
        [u, value[A], value[P]]
    };
    (0..=count).map(&mut at).collect()
}
