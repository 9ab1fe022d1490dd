//! Curvatures, tensions, velocities and the balance of normal forces at a place of the contour (Figs 1B–D and S2 of the
//! paper).
//!
//! The normal balance of the model, ∂_s q + (cosψ/r) q − c1 (t_uu + T_uu) − c2 (t_φφ + T_φφ) + p + f_c = 0, is split by
//! the origin of its terms (M.12); outwards is positive:
//!
//! | part | |
//! |---|---|
//! | active | −(c1 Tᵃ_uu + c2 Tᵃ_φφ), Tᵃ_uu = ½X_s(c1 − c2) + X_b C, Tᵃ_φφ = −½X_s(c1 − c2) + X_b C |
//! | viscous | −(c1 Tᵈ_uu + c2 Tᵈ_φφ) with the remainder of T, η_b(S_uu + S_φφ) ± η_s(S_uu − S_φφ), and normal friction −Γ_n v_n |
//! | elastic | ∂_s q + (cosψ/r) q − γC + ½κ(c1 − c2)²C − κC0(½C0C − 2c1c2): bending, and passive tension |
//! | pressure | p |
//! | shell | f_c |
//!
//! At collocation points the parts sum to zero with the accuracy of the solution; between them, with the accuracy of
//! the collocation polynomial.

use furrow_bvp::{Gauss, Solution};

use super::Cortex;
use super::equations::{J, LENGTH, M, PHI, PRESSURE, PSI, Q, R, REGULATED, T, V, Z};
use super::own;
use furrow_cell::cue::Field;
use furrow_cell::law::Active;

/// Closer to the axis than this, relative to R0, cosψ/r and sinψ/r are replaced by their limits.
const ON_AXIS: f64 = 1e-9;

/// A small part of an interval.
const NUDGE: f64 = 1e-3;

/// The normal forces at a place by their origin; outwards is positive, in κ0/L_h³.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NormalForces {
    /// Due to active tension.
    pub active: f64,
    /// Due to viscous tension and normal friction.
    pub viscous: f64,
    /// Due to bending and passive tension.
    pub elastic: f64,
    /// Pressure p.
    pub pressure: f64,
    /// Due to the shell.
    pub shell: f64,
}

impl NormalForces {
    /// All parts, in the order of their names in files: active, viscous, elastic, pressure, shell.
    pub fn parts(&self) -> [f64; 5] {
        [self.active, self.viscous, self.elastic, self.pressure, self.shell]
    }

    /// The sum of all parts: 0 for an exact solution.
    pub fn residual(&self) -> f64 {
        self.parts().iter().sum()
    }
}

/// The state of one place of the contour. Lengths in L_h, tensions in κ0/L_h², velocities in L_h/τ.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Place {
    /// Arclength fraction u.
    pub u: f64,
    /// Distance from the axis r.
    pub r: f64,
    /// Position along the axis z.
    pub z: f64,
    /// Tangent angle ψ.
    pub psi: f64,
    /// Meridional curvature c1 = C^u_u.
    pub c_uu: f64,
    /// Azimuthal curvature c2 = C^φ_φ.
    pub c_pp: f64,
    /// Meridional tension T_uu, active and viscous.
    pub t_uu: f64,
    /// Azimuthal tension T_φφ, active and viscous.
    pub t_pp: f64,
    /// Tangential velocity v, towards larger u.
    pub v: f64,
    /// Normal velocity v_n, outwards.
    pub v_n: f64,
    /// ∂_t r and ∂_t z at fixed u: the motion of the contour in its own coordinate, which differs from the flow of the
    /// cortex.
    pub moving: [f64; 2],
    /// Tangential active force density ∂_s Tᵃ_uu + (cosψ/r)(Tᵃ_uu − Tᵃ_φφ), towards larger u, in κ0/L_h³; its normal
    /// component is `normal.active`.
    pub active_tangential: f64,
    /// The normal forces.
    pub normal: NormalForces,
    /// The regulator φ, if the cell has one.
    pub phi: Option<f64>,
}

impl Place {
    /// The state between this place and another at the same u, a time `dt` later, at `share` of the way. The contour
    /// follows the cubic with the rates at both ends, all other quantities a straight line: normal forces that balance
    /// at both ends also balance in between.
    pub fn between(&self, later: &Place, share: f64, dt: f64) -> Place {
        let line = |a: f64, b: f64| a + share * (b - a);
        let (left, right) = (share * (1.0 - share) * (1.0 - share) * dt, share * share * (share - 1.0) * dt);
        let ease = share * share * (3.0 - 2.0 * share);
        let cubic = |a: f64, b: f64, k: usize| a + ease * (b - a) + left * self.moving[k] + right * later.moving[k];
        let (from, to) = (self.normal.parts(), later.normal.parts());
        let [active, viscous, elastic, pressure, shell] = std::array::from_fn(|k| line(from[k], to[k]));
        Place {
            u: self.u,
            r: cubic(self.r, later.r, 0),
            z: cubic(self.z, later.z, 1),
            psi: line(self.psi, later.psi),
            c_uu: line(self.c_uu, later.c_uu),
            c_pp: line(self.c_pp, later.c_pp),
            t_uu: line(self.t_uu, later.t_uu),
            t_pp: line(self.t_pp, later.t_pp),
            v: line(self.v, later.v),
            v_n: line(self.v_n, later.v_n),
            moving: [0, 1].map(|k| line(self.moving[k], later.moving[k])),
            active_tangential: line(self.active_tangential, later.active_tangential),
            normal: NormalForces { active, viscous, elastic, pressure, shell },
            phi: self.phi.zip(later.phi).map(|(a, b)| line(a, b)),
        }
    }

    /// The active force density as a vector (r, z).
    pub fn active_force(&self) -> [f64; 2] {
        let (sin, cos) = self.psi.sin_cos();
        let (along, outwards) = (self.active_tangential, self.normal.active);
        [along * cos + outwards * sin, -along * sin + outwards * cos]
    }
}

/// The shape and its rate of change at one place.
struct State {
    u: f64,
    y: [f64; REGULATED],
    /// ∂y/∂u.
    slope: [f64; REGULATED],
    /// ∂_t (r, z) at fixed u.
    rate: [f64; 2],
    /// Factor on the activity.
    noise: f64,
}

/// The state at u of a shape `y` of `cortex`. The cortex must hold the motion that the shape was solved with: its rate,
/// and the past at the collocation points of the mesh of `y`.
pub fn at(cortex: &Cortex, gauss: &Gauss, y: &Solution, u: f64) -> Place {
    let i = y.interval_of(u);
    let theta = (u - y.mesh[i]) / (y.mesh[i + 1] - y.mesh[i]);
    place(cortex, gauss, y, (i, theta))
}

/// The states at the collocation points, where the equations were solved, and at the two ends of the mesh.
///
/// # Examples
/// The normal forces on a cell at rest sum to zero:
///
/// ```
/// use furrow_cell::{Cell, Numerics};
/// use furrow_mechanics::cortex::forces;
/// use furrow_mechanics::equilibria::stationary::stationary;
/// let shape = stationary(&Cell::new(1.6), &Numerics::default())?;
/// let gauss = shape.solution.gauss();
/// let places = forces::profile(&shape.cortex, &gauss, &shape.solution);
/// // The ends, where a derivative is only as good as the mesh, aside.
/// let inside = &places[1..places.len() - 1];
/// assert!(inside.iter().all(|place| place.normal.residual().abs() < 1e-6));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn profile(cortex: &Cortex, gauss: &Gauss, y: &Solution) -> Vec<Place> {
    along(cortex, gauss, y, &gauss.c)
}

/// The states at `count` evenly spaced places of each mesh interval, and at the two ends of the mesh: for pictures,
/// where the collocation points are too far apart.
pub(crate) fn dense_profile(cortex: &Cortex, gauss: &Gauss, y: &Solution, count: usize) -> Vec<Place> {
    let thetas: Vec<f64> = (0..count).map(|k| (k as f64 + 0.5) / count as f64).collect();
    along(cortex, gauss, y, &thetas)
}

/// The states at the same places θ of each mesh interval, and at the two ends of the mesh.
fn along(cortex: &Cortex, gauss: &Gauss, y: &Solution, thetas: &[f64]) -> Vec<Place> {
    let inside = (0..y.intervals()).flat_map(|i| thetas.iter().map(move |theta| (i, *theta)));
    let all = [(0, 0.0)].into_iter().chain(inside).chain([(y.intervals() - 1, 1.0)]);
    all.map(|at| place(cortex, gauss, y, at)).collect()
}

/// The shape and its rate of change at θ in interval i, by their polynomials; the rate is known at the Gauss points.
fn between(cortex: &Cortex, gauss: &Gauss, y: &Solution, i: usize, theta: f64) -> State {
    let mut state = State {
        u: y.mesh[i] + theta * (y.mesh[i + 1] - y.mesh[i]),
        y: [0.0; REGULATED],
        slope: [0.0; REGULATED],
        rate: [0.0; 2],
        noise: if cortex.noise.is_empty() { 1.0 } else { 0.0 },
    };
    y.eval_in(gauss, i, theta, &mut state.y[..y.components]);
    y.slope_in(gauss, i, theta, &mut state.slope[..y.components]);
    for j in 0..y.m {
        let others = (0..y.m).filter(|k| *k != j);
        let weight: f64 = others.map(|k| (theta - gauss.c[k]) / (gauss.c[j] - gauss.c[k])).product();
        let (index, stage) = (i * y.m + j, y.stage(i, j));
        if let Some([r_past, z_past]) = cortex.past.get(index).filter(|_| cortex.rate != 0.0) {
            state.rate[0] += weight * cortex.rate * (stage[R] - r_past);
            state.rate[1] += weight * cortex.rate * (stage[Z] - z_past);
        }
        state.noise += weight * cortex.noise.get(index).copied().unwrap_or(0.0);
    }
    state
}

fn place(cortex: &Cortex, gauss: &Gauss, shape: &Solution, at: (usize, f64)) -> Place {
    let state = &between(cortex, gauss, shape, at.0, at.1);
    let State { u, y, slope, rate, noise } = state;
    let (length, constants) = (shape.scalars[LENGTH], cortex.constants());
    let here = constants.of_state(*u, &y[..shape.components], length);
    let (sin, cos) = y[PSI].sin_cos();
    let on_axis = y[R].abs() < ON_AXIS * cortex.cell.r0;
    let own = constants.law.as_ref().map(|_| Own { cortex, gauss, shape, on_axis });
    let given = own.as_ref().and_then(|own| own.at(at));
    let mean = given.map_or(here.mean(y[M]), |(_, [mean, _])| mean);
    // Quantities multiplied by cosψ/r vanish on the axis, where the quotient equals their derivative.
    let by_r = |value: f64, value_u: f64| if on_axis { value_u / length } else { cos / y[R] * value };
    let c_pp = if on_axis { 0.5 * mean } else { sin / y[R] };
    let c_uu = mean - c_pp;
    let difference = c_uu - c_pp;
    let v_n = sin * rate[0] + cos * rate[1];
    let s_pp = by_r(y[V], slope[V]) + c_pp * v_n;
    let (x_s, x_b) = (here.xi_s * noise, here.xi_b * noise);
    let (active_uu, active_pp, pushed) = match given {
        Some((Active { stress: [along, around], moment, normal_force }, _)) => {
            (along, around, normal_force + moment * (c_uu * c_uu + c_pp * c_pp))
        }
        None => (0.5 * x_s * difference + x_b * mean, -0.5 * x_s * difference + x_b * mean, 0.0),
    };
    let viscous_uu = y[T] - active_uu;
    let s_uu = (viscous_uu - here.eta_difference * s_pp) / here.eta_sum;
    let viscous_pp = here.eta_difference * s_uu + here.eta_sum * s_pp;
    let bending = slope[Q] / length + by_r(y[Q], slope[Q]);
    let curled = here.kappa * here.spontaneous * (0.5 * here.spontaneous * mean - 2.0 * c_uu * c_pp);
    Place {
        u: *u,
        r: y[R],
        z: y[Z],
        psi: y[PSI],
        c_uu,
        c_pp,
        t_uu: y[T],
        t_pp: active_pp + viscous_pp,
        v: y[V],
        v_n,
        moving: *rate,
        active_tangential: match &own {
            _ if on_axis => 0.0,
            Some(own) => own.tangential(at, cos / y[R] * (active_uu - active_pp)),
            None => active_tangential(cortex, shape, state),
        },
        normal: NormalForces {
            active: pushed - (c_uu * active_uu + c_pp * active_pp),
            viscous: -(c_uu * viscous_uu + c_pp * viscous_pp) - constants.shell.normal_friction * v_n,
            elastic: bending - here.tension * mean + 0.5 * here.kappa * difference * difference * mean - curled,
            pressure: shape.scalars[PRESSURE],
            shell: own::shell::force_at(constants, y),
        },
        phi: (shape.components == REGULATED).then_some(y[PHI]),
    }
}

/// T^a_uu and T^a_φφ that the cell's own law gives in a state without motion, and C and ∂_sC; `None` without such a law.
pub fn own_stress(cortex: &Cortex, u: f64, y: &[f64], length: f64) -> Option<[[f64; 2]; 2]> {
    let constants = cortex.constants();
    let here = constants.of_state(u, y, length);
    let (active, mean) = constants.reader().active(u, (y, 0.0, 1.0), &here, length)?;
    Some([active.stress, mean])
}

/// The law of a cell that has one of its own, on a shape.
struct Own<'a> {
    cortex: &'a Cortex,
    gauss: &'a Gauss,
    shape: &'a Solution,
    on_axis: bool,
}

impl Own<'_> {
    /// The law's values at θ in interval i, with C and ∂_sC; on the axis, those very near it.
    fn at(&self, (i, theta): (usize, f64)) -> Option<(Active<f64>, [f64; 2])> {
        let theta = if self.on_axis { theta.clamp(NUDGE, 1.0 - NUDGE) } else { theta };
        let State { u, y, rate, noise, .. } = between(self.cortex, self.gauss, self.shape, i, theta);
        let (length, constants) = (self.shape.scalars[LENGTH], self.cortex.constants());
        let y = &y[..self.shape.components];
        let here = constants.of_state(u, y, length);
        let (sin, cos) = y[PSI].sin_cos();
        let v_n = sin * rate[0] + cos * rate[1];
        constants.reader().active(u, (y, v_n, noise), &here, length)
    }

    /// The tangential active force, by a difference along the contour; `round` is its part (cosψ/r)(Tᵃ_uu − Tᵃ_φφ). Of a
    /// moment it has M ∂_sC.
    fn tangential(&self, (i, theta): (usize, f64), round: f64) -> f64 {
        let [before, after] =
            [-NUDGE, NUDGE].map(|step| self.at((i, theta + step)).map_or(0.0, |(it, _)| it.stress[0]));
        let width = self.shape.mesh[i + 1] - self.shape.mesh[i];
        let bent = self.at((i, theta)).map_or(0.0, |(Active { moment, .. }, [_, mean_s])| moment * mean_s);
        (after - before) / (2.0 * NUDGE * width * self.shape.scalars[LENGTH]) + round - bent
    }
}

/// ∂_s Tᵃ_uu + (cosψ/r)(Tᵃ_uu − Tᵃ_φφ) off the axis. The slope of the noise is neglected.
fn active_tangential(cortex: &Cortex, shape: &Solution, state: &State) -> f64 {
    let State { u, y, noise, .. } = state;
    let (length, constants) = (shape.scalars[LENGTH], cortex.constants());
    let here = constants.of_state(*u, &y[..shape.components], length);
    let (sin, cos) = y[PSI].sin_cos();
    let mean = here.mean(y[M]);
    let (c_pp, cot) = (sin / y[R], cos / y[R]);
    let c_uu = mean - c_pp;
    // Derivatives by arclength of C, from m′ = q, and of sinψ/r.
    let mean_s = here.mean_slope(y[Q], mean, length);
    let c_pp_s = cot * (c_uu - c_pp);
    let (mut x_s_u, mut x_b_u) = (0.0, 0.0);
    for term in &constants.cue {
        let [_, f_u, _] = term.at(*u, length);
        if matches!(term.field, Field::Activity | Field::XiS) {
            x_s_u += constants.uniform.xi_s * f_u;
        }
        if matches!(term.field, Field::Activity | Field::XiB) {
            x_b_u += constants.uniform.xi_b * f_u;
        }
    }
    for coupling in constants.regulator.iter().flat_map(|regulator| &regulator.couplings) {
        let f_u = coupling.at(y[PHI])[1] * y[J] * length;
        if matches!(coupling.field, Field::Activity | Field::XiS) {
            x_s_u += constants.uniform.xi_s * f_u;
        }
        if matches!(coupling.field, Field::Activity | Field::XiB) {
            x_b_u += constants.uniform.xi_b * f_u;
        }
    }
    let along = (x_s_u * (0.5 * mean - c_pp) + x_b_u * mean) / length
        + here.xi_s * (0.5 * mean_s - c_pp_s)
        + here.xi_b * mean_s;
    noise * (along + cot * here.xi_s * (c_uu - c_pp))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::division::stepper::SOLVED_TO;
    use crate::division::{DivisionInput, DivisionOptions, Frame, divide_with};
    use furrow_cell::{Cell, Cue};
    use std::f64::consts::PI;

    fn observe(cell: Cell, observer: &mut dyn FnMut(Frame<'_>)) {
        divide_with(&DivisionInput::new(cell), DivisionOptions::observed_by(observer)).unwrap();
    }

    fn cued() -> Cell {
        let cue = "kappa:u0=0.465,omega=0.0577,amplitude=0.1+xi_s:step,u0=0.6,omega=0.2,amplitude=0.1";
        Cell::gao2026_thresholds(4.0).with_cue(cue.parse().unwrap())
    }

    /// A shape is solved to a few 1e-7 of its size, and its velocities, which are differences of shapes, to the same
    /// times the rate of the step; forces are sums of several terms of both kinds.
    #[test]
    fn normal_forces_sum_to_zero_at_every_collocation_point_of_a_division() {
        for cell in [Cell::gao2026_thresholds(2.0), cued()] {
            observe(cell, &mut |frame| {
                let places = profile(frame.cortex, frame.gauss, frame.shape);
                for place in &places[1..places.len() - 1] {
                    let largest = place.normal.parts().iter().fold(1.0, |m: f64, part| m.max(part.abs()));
                    let solved_to = SOLVED_TO * (30.0 * largest + 3.0 * frame.cortex.rate);
                    assert!(place.normal.residual().abs() < solved_to, "{} {place:?}", place.normal.residual());
                }
            });
        }
    }

    #[test]
    fn normal_forces_balance_between_collocation_points_to_the_accuracy_of_the_mesh() {
        let mut checked = 0;
        observe(cued(), &mut |frame| {
            // A narrow neck closes faster than the mesh resolves the walls beside it, where forces are small.
            if frame.neck.is_some_and(|neck| neck.radius < 0.2 * frame.cortex.cell.r0) {
                return;
            }
            for k in 1..200 {
                let place = at(frame.cortex, frame.gauss, frame.shape, k as f64 / 200.0);
                let size: f64 = place.normal.parts().iter().map(|part| part.abs()).sum();
                assert!(place.normal.residual().abs() < 0.05 * size, "{place:?}");
                checked += 1;
            }
        });
        assert!(checked > 5000, "{checked}");
    }

    /// The shell and friction are the only external forces on the cell: their axial components cancel.
    #[test]
    fn forces_from_outside_cancel_along_the_axis() {
        observe(cued(), &mut |frame| {
            let part = |p: &Place| 2.0 * PI * p.r * (p.normal.shell * p.psi.cos() + p.v * p.psi.sin());
            let (mut sum, mut size) = (0.0, 0.0);
            for pair in profile(frame.cortex, frame.gauss, frame.shape).windows(2) {
                let ([a, b], step) = ([part(&pair[0]), part(&pair[1])], pair[1].u - pair[0].u);
                sum += (a + b) * step;
                size += (a.abs() + b.abs()) * step;
            }
            assert!(frame.t == 0.0 || sum.abs() < 1e-2 * size, "{sum} of {size}");
        });
    }

    #[test]
    fn the_tangential_active_force_is_the_divergence_of_active_tension() {
        let mut checked = 0;
        observe(cued(), &mut |frame| {
            if !frame.cortex.noise.is_empty() {
                return;
            }
            let tension = |u: f64| {
                let place = at(frame.cortex, frame.gauss, frame.shape, u);
                let here = frame.cortex.constants().at(u, frame.shape.scalars[LENGTH]);
                let (difference, mean) = (place.c_uu - place.c_pp, place.c_uu + place.c_pp);
                0.5 * here.xi_s * difference + here.xi_b * mean
            };
            let y = frame.shape;
            for i in (1..y.intervals() - 1).step_by(3) {
                let u = y.stage_x(frame.gauss, i, 1);
                let step = 1e-3 * (y.mesh[i + 1] - y.mesh[i]);
                let place = at(frame.cortex, frame.gauss, y, u);
                let here = frame.cortex.constants().at(u, y.scalars[LENGTH]);
                let along = (tension(u + step) - tension(u - step)) / (2.0 * step * y.scalars[LENGTH]);
                let round = place.psi.cos() / place.r * here.xi_s * (place.c_uu - place.c_pp);
                let size = along.abs() + round.abs() + 1.0;
                assert!((along + round - place.active_tangential).abs() < 1e-4 * size, "{}: {place:?}", along + round);
                checked += 1;
            }
        });
        assert!(checked > 200, "{checked}");
    }

    #[test]
    fn a_cell_without_activity_has_no_active_and_no_viscous_force() {
        let mut first = Vec::new();
        observe(Cell { cue: Cue::none(), ..cued() }, &mut |frame| {
            if frame.t == 0.0 {
                first = profile(frame.cortex, frame.gauss, frame.shape);
            }
        });
        assert!(first.iter().all(|place| place.normal.active == 0.0 && place.normal.viscous.abs() < 1e-9));
        // The remaining forces are bending, pressure and the shell.
        assert!(first.iter().all(|place| place.normal.residual().abs() < 1e-3), "{first:?}");
        assert!(first.iter().any(|place| place.normal.shell < -0.01) && first[0].normal.pressure != 0.0, "{first:?}");
    }
}
