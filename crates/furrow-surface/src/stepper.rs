//! Implicit time steps: backward differentiation of second order with variable steps.

use furrow_bvp::Work;

use crate::linear::Factored;
use crate::newton::{Newton, NewtonError};
use crate::problem::{Motion, Problem, State};
use crate::space::Space;

/// A state at a time.
#[derive(Clone, Debug)]
pub struct Level {
    /// Time, in τ.
    pub t: f64,
    /// The state.
    pub state: State,
}

/// The motion of one cell.
#[derive(Clone, Debug)]
pub struct Stepper {
    /// The problem.
    pub problem: Problem,
    /// The latest states, the newest first; at most three.
    pub history: Vec<Level>,
    /// Work so far.
    pub work: Work,
    /// Settings of Newton's method.
    pub newton: Newton,
    /// Whether walls of a furrow touch instead of passing through each other.
    pub contact: bool,
    factored: Option<Factored>,
    /// The density of rings in the last step.
    density_before: Vec<f64>,
    /// Rate of the step at which the Jacobian was computed.
    known_rate: f64,
}

/// Derivatives are reused while the rate of the step changes by less than this factor.
const SAME_RATE: f64 = 1.7;

impl Stepper {
    /// A cell at rest at t = 0.
    pub fn new(problem: Problem, state: State) -> Stepper {
        let newton = Newton { tolerance: 1e-7, share: 0.02, iterations: 20, slow: 0.4 };
        let history = vec![Level { t: 0.0, state }];
        Stepper {
            problem,
            history,
            work: Work::default(),
            newton,
            contact: true,
            factored: None,
            density_before: Vec::new(),
            known_rate: 0.0,
        }
    }

    /// Restarts from the newest state after a sudden change of the forces. Steps that use the previous velocity would extrapolate it
    /// and increase the impulse by half.
    pub fn restart(&mut self) {
        self.history.truncate(1);
        self.factored = None;
    }

    /// Continues with azimuthal mode numbers up to `modes`.
    pub fn take_modes(&mut self, modes: usize) {
        self.problem.take_modes(modes, self.history.iter_mut().map(|level| &mut level.state));
        self.factored = None;
    }

    /// Σ c_k (state k of the history).
    fn combine(&self, coefficients: &[f64], part: impl Fn(&State) -> &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; part(&self.history[0].state).len()];
        for (c, level) in coefficients.iter().zip(&self.history) {
            out.iter_mut().zip(part(&level.state)).for_each(|(out, x)| *out += c * x);
        }
        out
    }

    /// Weights of the history in the polynomial through the newest `count` states at time t.
    fn extrapolation(&self, t: f64, count: usize) -> Vec<f64> {
        let times: Vec<f64> = self.history.iter().take(count).map(|level| level.t).collect();
        let weight = |k: usize| {
            let others = (0..times.len()).filter(|j| *j != k);
            others.map(|j| (t - times[j]) / (times[k] - times[j])).product()
        };
        (0..times.len()).map(weight).collect()
    }

    /// A step of length `dt`: the state, and its local error if three states are known.
    ///
    /// # Errors
    /// [`NewtonError`].
    pub fn attempt(&mut self, dt: f64) -> Result<(Level, Option<f64>), NewtonError> {
        let t = self.history[0].t + dt;
        let known = self.history.len();
        let weights = self.extrapolation(t, known.min(3));
        let surface = self.combine(&weights, |state| &state.surface);
        let smooth = self.extrapolation(t, known.min(2));
        let flow = self.combine(&smooth, |state| &state.flow);
        let pressure = smooth.iter().zip(&self.history).map(|(w, level)| w * level.state.pressure).sum();
        self.problem.spread(&surface);
        if self.contact {
            self.problem.contacts = self.problem.walls(&surface);
        }
        let past: Vec<f64> = match known {
            1 => vec![-1.0 / dt],
            _ => {
                let ratio = dt / (self.history[0].t - self.history[1].t);
                vec![-(1.0 + ratio) / dt, ratio * ratio / (1.0 + ratio) / dt]
            }
        };
        let rate = -past.iter().sum::<f64>();
        self.problem.motion = Motion { rate, past: self.combine(&past, |state| &state.surface) };
        if (rate / self.known_rate).max(self.known_rate / rate) > SAME_RATE {
            self.factored = None;
        }
        let mut state = State { surface: surface.clone(), flow, pressure };
        let known_before = self.factored.is_some();
        let mut solved = self.problem.solve(&self.newton, &mut state, &mut self.factored, &mut self.work);
        if solved.is_err() && known_before {
            self.factored = None;
            state = State { surface: surface.clone(), ..self.history[0].state.clone() };
            solved = self.problem.solve(&self.newton, &mut state, &mut self.factored, &mut self.work);
        }
        if let Err(error) = solved {
            self.factored = None;
            return Err(error);
        }
        if !known_before || self.factored.is_none() {
            self.known_rate = rate;
        }
        let error = (known >= 3).then(|| {
            let [h, h1, h2] = [dt, self.history[0].t - self.history[1].t, self.history[1].t - self.history[2].t];
            let share = h * (h + h1) / ((2.0 * h + h1) * (h + h1 + h2));
            share * self.problem.normal_distance(&state.surface, &surface)
        });
        Ok((Level { t, state }, error))
    }

    /// Accepts a step, and moves the density of rings by a fraction of the way to the target density.
    pub fn accept(&mut self, level: Level, share: f64) {
        self.work.steps += 1;
        let wanted = self.problem.wanted_density(&level.state.surface);
        self.density_before.clone_from(&self.problem.mesh.density);
        for (density, wanted) in self.problem.mesh.density.iter_mut().zip(wanted) {
            *density += share * (wanted - *density);
        }
        self.history.insert(0, level);
        self.history.truncate(3);
    }

    /// Undoes half of the last change of the density, because a shorter step does not reduce the displacement of the rings.
    pub fn slow_down(&mut self) {
        for (density, before) in self.problem.mesh.density.iter_mut().zip(&self.density_before) {
            *density = 0.5 * (*density + before);
        }
    }
}

impl Problem {
    /// Continues with azimuthal mode numbers up to `modes`, also for the given states.
    pub fn take_modes<'a>(&mut self, modes: usize, states: impl IntoIterator<Item = &'a mut State>) {
        let space = Space::new(self.space.elements, modes);
        for state in states {
            state.surface = space.adopt(&state.surface, &self.space);
            state.flow = space.adopt(&state.flow, &self.space);
        }
        self.space = space;
        self.contacts.clear();
        self.noise.clear();
    }

    /// Root mean square over the surface of the normal component of the distance between two surfaces.
    pub fn normal_distance(&self, a: &[f64], b: &[f64]) -> f64 {
        let space = &self.space;
        let [mut here, mut there] = [const { Vec::new() }; 2];
        let [mut square, mut area] = [0.0; 2];
        for station in &space.stations {
            space.functions(a, station, &mut here);
            space.functions(b, station, &mut there);
            for meridian in &space.meridians {
                let (x, y) = (space.shape(&here, meridian), space.shape(&there, meridian));
                let geometry = crate::law::Geometry::new(&x);
                let along: f64 = (0..3).map(|k| (x[0][k] - y[0][k]) * geometry.normal[k]).sum();
                square += station.weight * geometry.area * along * along;
                area += station.weight * geometry.area;
            }
        }
        (square / area).sqrt()
    }
}
