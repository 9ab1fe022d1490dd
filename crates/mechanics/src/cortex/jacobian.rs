//! The equations with hand-written derivatives, for the collocation sweep of Newton's method.
//!
//! Gradients are with respect to (r, z, m, ψ, q, v, T), padded to eight entries so that they fill a vector register. Each
//! step below repeats a line of [`equations`](super::equations::equations) and differentiates it; a test holds the two
//! together for every field and profile of a cue.

use std::f64::consts::PI;

use bvp::{CollocationPoint, PointJacobian};
use nalgebra::SVector;

use super::Cortex;
use super::equations::{COMPONENTS, Constants, LENGTH, Local, M, PRESSURE, PSI, Q, R, T, V, Z};

type Gradient = SVector<f64, 8>;

/// A quantity with its gradient.
type Valued = (f64, Gradient);

/// What the equations at one point share.
struct Point<'a> {
    constants: &'a Constants<f64>,
    here: Local<f64>,
    y: [f64; COMPONENTS],
    sin: f64,
    cos: f64,
    /// 1/κ.
    inverse_kappa: f64,
    /// C = m/κ.
    mean: f64,
    c1: Valued,
    c2: Valued,
    /// cosψ/r.
    cot: Valued,
    v_n: Valued,
}

fn gradient(entries: [(usize, f64); 3]) -> Gradient {
    let mut out = Gradient::zeros();
    for (component, value) in entries {
        out[component] += value;
    }
    out
}

/// S_uu and T_φφ.
fn stresses(point: &Point<'_>, noise: f64) -> [Valued; 2] {
    let Point { here, inverse_kappa, mean, c2, cot, v_n, .. } = point;
    let (v, t) = (point.y[V], point.y[T]);
    let s_phi = cot.0 * v + c2.0 * v_n.0;
    let mut d_s_phi = cot.1 * v + c2.1 * v_n.0 + v_n.1 * c2.0;
    d_s_phi[V] += cot.0;
    let (xi_s, xi_b) = (here.xi_s * noise, here.xi_b * noise);
    let (along, around) = (0.5 * xi_s + xi_b, xi_b - 0.5 * xi_s);
    let inverse_sum = 1.0 / here.eta_sum;
    let s_u = (t - along * mean + xi_s * c2.0 - here.eta_difference * s_phi) * inverse_sum;
    let mut d_s_u = c2.1 * (xi_s * inverse_sum) + d_s_phi * (-here.eta_difference * inverse_sum);
    d_s_u[M] -= along * inverse_kappa * inverse_sum;
    d_s_u[T] += inverse_sum;
    let t_phi = here.eta_difference * s_u + here.eta_sum * s_phi + around * mean + xi_s * c2.0;
    let mut d_t_phi = d_s_u * here.eta_difference + d_s_phi * here.eta_sum + c2.1 * xi_s;
    d_t_phi[M] += around * inverse_kappa;
    [(s_u, d_s_u), (t_phi, d_t_phi)]
}

/// q_s without the pressure: the normal force balance.
fn normal(point: &Point<'_>, t_phi: &Valued) -> Valued {
    let Point { constants: c, here, inverse_kappa, mean, c1, c2, cot, sin, cos, .. } = point;
    let [r, z, _, _, q, _, t] = point.y;
    let inside = ((z * z * c.inverse_a2 + r * r * c.inverse_b2 - 1.0) * c.inverse_w2).exp();
    let push = c.shell_force * inside;
    let slope = r * sin * c.inverse_b2 + z * cos * c.inverse_a2;
    let difference = c1.0 - c2.0;
    let stretch = here.tension - 0.5 * here.kappa * difference * difference;
    let shear = -here.kappa * difference * mean;
    let value = c1.0 * t + c2.0 * t_phi.0 + stretch * mean - cot.0 * q + push * slope;
    let mut d = c1.1 * (t + shear) + c2.1 * (t_phi.0 - shear) + t_phi.1 * c2.0 + cot.1 * -q;
    d[M] += stretch * inverse_kappa;
    d[T] += c1.0;
    d[Q] -= cot.0;
    d[R] += push * (2.0 * r * c.inverse_b2 * c.inverse_w2 * slope + sin * c.inverse_b2);
    d[Z] += push * (2.0 * z * c.inverse_a2 * c.inverse_w2 * slope + cos * c.inverse_a2);
    d[PSI] += push * (r * cos * c.inverse_b2 - z * sin * c.inverse_a2);
    (value, d)
}

/// T_s without the terms of a varying κ and γ: the tangential force balance.
fn tangential(point: &Point<'_>, t_phi: &Valued) -> Valued {
    let Point { here, cot, .. } = point;
    let (v, t) = (point.y[V], point.y[T]);
    let mut d = cot.1 * (t_phi.0 - t) + t_phi.1 * cot.0;
    d[V] += here.friction;
    d[T] -= cot.0;
    (here.friction * v - cot.0 * (t - t_phi.0), d)
}

/// f, ∂f/∂y, ∂f/∂(L, p), g and its derivatives at one collocation point.
#[inline]
pub fn jacobian(cortex: &Cortex, at: CollocationPoint, y: &[f64], p: &[f64], out: &mut PointJacobian<'_>) {
    let (length, pressure) = (p[LENGTH], p[PRESSURE]);
    let scalars = super::problem::SHAPE_SCALARS + cortex.free.len();
    let constants = cortex.constants();
    let y: [f64; COMPONENTS] = std::array::from_fn(|k| y[k]);
    let [r, z, m, psi, q, ..] = y;
    let here = constants.at(at.x, length);
    let motion = cortex.motion(at);
    let (sin, cos) = psi.sin_cos();
    let inverse_r = 1.0 / r;
    let inverse_kappa = 1.0 / here.kappa;
    let (c2, cot, mean) = (sin * inverse_r, cos * inverse_r, m / here.kappa);
    let (dr, dz) = (motion.rate * (r - motion.r_past), motion.rate * (z - motion.z_past));
    let point = Point {
        constants,
        here,
        y,
        sin,
        cos,
        inverse_kappa,
        mean,
        c1: (mean - c2, gradient([(R, c2 * inverse_r), (M, inverse_kappa), (PSI, -cot)])),
        c2: (c2, gradient([(R, -c2 * inverse_r), (PSI, cot), (V, 0.0)])),
        cot: (cot, gradient([(R, -cot * inverse_r), (PSI, -c2), (V, 0.0)])),
        v_n: (
            sin * dr + cos * dz,
            gradient([(R, motion.rate * sin), (Z, motion.rate * cos), (PSI, cos * dr - sin * dz)]),
        ),
    };
    let [s_u, t_phi] = stresses(&point, cortex.noise_at(at));
    let (q_s, d_q) = normal(&point, &t_phi);
    let (t_s, d_t) = tangential(&point, &t_phi);
    let v_s = s_u.0 - point.c1.0 * point.v_n.0;
    let d_v = s_u.1 + point.c1.1 * -point.v_n.0 + point.v_n.1 * -point.c1.0;
    let band = if constants.rigidity_gradient { 0.5 * here.kappa_u } else { 0.0 };

    let n = COMPONENTS;
    let f_s = [cos, -sin, q, point.c1.0, q_s - pressure, v_s, t_s];
    for k in 0..n {
        out.f[k] = length * f_s[k];
        out.fp[k * scalars + LENGTH] = f_s[k];
    }
    out.f[T] -= band * mean * mean + here.tension_u;
    out.fp[Q * scalars + PRESSURE] = -length;
    out.fy[R * n + PSI] = -length * sin;
    out.fy[Z * n + PSI] = -length * cos;
    out.fy[M * n + Q] = length;
    for (row, d) in [(PSI, &point.c1.1), (Q, &d_q), (V, &d_v), (T, &d_t)] {
        for k in 0..n {
            out.fy[row * n + k] = length * d[k];
        }
    }
    out.fy[T * n + M] -= 2.0 * band * mean * inverse_kappa;
    out.g[0] = PI * length * r * r * sin;
    out.gy[R] = 2.0 * PI * length * r * sin;
    out.gy[PSI] = PI * length * r * r * cos;
    out.gp[LENGTH] = PI * r * r * sin;
}

#[cfg(test)]
mod tests {
    use bvp::BoundaryValueProblem;
    use num_dual::Dual64;

    use super::*;
    use crate::cell::cue::{Field, Quantity};
    use crate::cell::{Cell, Cue, Material, Parameter};
    use crate::cortex::Domain;
    use crate::cortex::equations::{Motion, equations};

    /// Numbers in [0, 1), the same on every run.
    fn stream() -> impl FnMut() -> f64 {
        let mut seed = 12345u64;
        move || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 11) as f64 / (1u64 << 53) as f64
        }
    }

    fn close(a: f64, b: f64, what: &str) {
        assert!((a - b).abs() < 1e-11 * (1.0 + a.abs()), "{what}: {a} {b}");
    }

    /// Every field with every profile, widths in u and in L_h, and sums of them.
    fn cues() -> Vec<Cue> {
        let mut texts = vec!["none".to_owned()];
        for field in Field::ALL {
            let name = field.name();
            texts.push(format!("{name}:u0=0.465,omega=0.0577,amplitude=0.1"));
            texts.push(format!("{name}:step,u0=0.4,omega=0.7Lh,amplitude=-0.3"));
            texts.push(format!("{name}:gradient,amplitude=0.2+kappa:u0=0.4,omega=0.3Lh,amplitude=0.5"));
        }
        texts.iter().map(|text| text.parse().unwrap()).collect()
    }

    /// The hand-written Jacobian, and the columns of free parameters, are derivatives of the equations at random states.
    #[test]
    fn it_is_the_derivative_of_the_equations_for_every_cue() {
        let mut random = stream();
        for cue in cues() {
            let material = Material { tension: 0.3, eta_s: 0.7, friction: 1.2, ..Material::GAO2026 };
            let cell = Cell { material, cue: cue.clone(), ..Cell::new(2.3) };
            let mut free = vec![Parameter::XiS, Parameter::R0];
            let quantities = Quantity::ALL.map(|quantity| Parameter::Cue { term: 0, quantity });
            free.extend(quantities.into_iter().filter(|parameter| parameter.is_of(&cell)));
            let mut cortex = Cortex::new(&cell, Domain::Full, &free);
            (cortex.rate, cortex.past, cortex.noise) = (3.0, vec![[1.1, -0.2]], vec![1.03]);
            for _ in 0..5 {
                let mut y: [f64; COMPONENTS] = std::array::from_fn(|_| 2.0 * random() - 1.0);
                (y[R], y[PSI]) = (0.5 + 1.5 * random(), 3.0 * random());
                let mut p = vec![7.0 + random(), 3.0 * random()];
                p.extend(free.iter().map(|parameter| parameter.get(&cell)));
                check(&mut cortex, &y, &p, &cue.to_string());
            }
        }
    }

    fn check(cortex: &mut Cortex, y: &[f64; COMPONENTS], p: &[f64], what: &str) {
        cortex.prepare(p);
        let at = CollocationPoint { x: 0.44, index: 0 };
        let (n, np) = (COMPONENTS, p.len());
        let (mut f, mut fy, mut fp) = (vec![0.0; n], vec![0.0; n * n], vec![0.0; n * np]);
        let (mut g, mut gy, mut gp) = (vec![0.0], vec![0.0; n], vec![0.0; np]);
        let mut out = PointJacobian { f: &mut f, fy: &mut fy, fp: &mut fp, g: &mut g, gy: &mut gy, gp: &mut gp };
        cortex.rhs_jacobian(at, y, p, &mut out);
        let (mut f2, mut g2) = (vec![0.0; n], vec![0.0]);
        cortex.rhs(at, y, p, &mut f2, &mut g2);
        (0..n).for_each(|k| close(f[k], f2[k], what));
        close(g[0], g2[0], what);
        // Stepping back by −n/rate is a unit normal velocity.
        let response = cortex.response_to_normal_velocity(at.x, y, p[0]);
        let (sin, cos) = y[PSI].sin_cos();
        let [r_past, z_past] = cortex.past[0];
        let moved = Motion { rate: 3.0, r_past: r_past - sin / 3.0, z_past: z_past - cos / 3.0 };
        let (f3, _) = equations(cortex.constants(), at.x, moved, 1.03, y, p[0], p[1]);
        (0..n).for_each(|k| close(f3[k] - f[k], response[k], what));
        for k in 0..n + np {
            let unit = |i: usize, v: f64| Dual64::new(v, if i == k { 1.0 } else { 0.0 });
            let constants = Constants::<Dual64>::new(&cortex.cell, |parameter, v| {
                cortex.free.iter().position(|f| *f == parameter).map_or(Dual64::from_re(v), |i| unit(n + 2 + i, v))
            });
            let state: [Dual64; COMPONENTS] = std::array::from_fn(|i| unit(i, y[i]));
            let (d, dg) =
                equations(&constants, at.x, cortex.motion(at), 1.03, &state, unit(n, p[0]), unit(n + 1, p[1]));
            for i in 0..n {
                close(d[i].eps, if k < n { fy[i * n + k] } else { fp[i * np + k - n] }, what);
            }
            close(dg.eps, if k < n { gy[k] } else { gp[k - n] }, what);
        }
    }
}
