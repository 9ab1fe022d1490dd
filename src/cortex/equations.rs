//! The force balance of the cortex as a boundary-value problem.
//!
//! State on u ∈ [0, 1] (or the mirror-symmetric half [0, ½]): y = (r, z, m, ψ, q, v, T) with arclength s = L u; the first
//! three are integrable in the sense of [`Dimensions::integrable`]. The eighth equation of the model, V′ = πr² sinψ, is a
//! quadrature and enters as the integral condition V(1) = 4πR0³/3. Scalar unknowns are (L, p) and any continuation
//! parameters after them.
//!
//! With c2 = sinψ/r, C = m/κ, c1 = C − c2, X = gξ_s and ρ = ξ_b/ξ_s:
//!
//! * \[geometry\] r_s = cosψ, z_s = −sinψ, ψ_s = c1, m_s = q
//! * \[strain rate\] S_φφ = (cosψ/r) v + c2 v_n, S_uu = (T − X\[(½ + ρ)C − c2\] − (η_b − η_s)S_φφ)/(η_b + η_s)
//! * \[stress\] T_φφ = (η_b − η_s)S_uu + (η_b + η_s)S_φφ + X\[(ρ − ½)C + c2\]
//! * \[normal\] q_s = −(cosψ/r) q + c1 T + c2 T_φφ + γC − ½κ(c1 − c2)²C − p − f_c
//! * \[tangential\] T_s = −(cosψ/r)(T − T_φφ) + Γv − ½C²κ_s
//! * \[flow\] v_s = S_uu − c1 v_n, v_n = sinψ ∂_t r + cosψ ∂_t z
//! * \[shell\] f_c = −(2P0/w²) exp\[(z²/a² + r²/b² − 1)/w²\] (r sinψ/b² + z cosψ/a²)
//!
//! The elastic part of \[normal\] uses c1 t_uu + c2 t_φφ = γC − ½κ(c1 − c2)²C.

use num_dual::{Dual64, DualNum};
use std::f64::consts::PI;

use super::control::Control;
use super::cue::Cue;
use super::parameters::{Physics, RigidityGradient};
use crate::numerics::{BoundaryJacobian, BoundaryValueProblem, Dimensions, PointJacobian, Site};

/// Radius r.
pub const R: usize = 0;
/// Axial position z.
pub const Z: usize = 1;
/// Bending moment m = κC.
pub const M: usize = 2;
/// Tangent angle ψ.
pub const PSI: usize = 3;
/// Transverse shear q.
pub const Q: usize = 4;
/// Tangential velocity v.
pub const V: usize = 5;
/// Meridional dissipative tension T_uu.
pub const T: usize = 6;
/// Number of components.
pub const COMPONENTS: usize = 7;
/// Index of L among the scalar unknowns.
pub const LENGTH: usize = 0;
/// Index of p among the scalar unknowns.
pub const PRESSURE: usize = 1;

/// Which part of the contour is solved for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Domain {
    /// u ∈ [0, 1], pole to pole.
    Full,
    /// u ∈ [0, ½] of a mirror-symmetric shape; L and V are still those of the whole cell.
    Half,
}

impl Domain {
    /// Right end of the mesh.
    pub fn end(self) -> f64 {
        match self {
            Domain::Full => 1.0,
            Domain::Half => 0.5,
        }
    }
}

/// Number types the equations can be evaluated in: plain, or carrying derivatives.
pub trait Number: DualNum<Primitive = f64> + Copy {}

impl<D: DualNum<Primitive = f64> + Copy> Number for D {}

/// The material and geometric constants of one cell, ready for evaluation; generic so that their derivatives can be
/// carried along.
#[derive(Clone, Copy, Debug)]
pub struct Constants<D> {
    /// Bending rigidity κ.
    pub kappa: D,
    /// η_b + η_s.
    pub eta_sum: D,
    /// η_b − η_s.
    pub eta_difference: D,
    /// Friction Γ.
    pub friction: D,
    /// Passive tension γ.
    pub tension: D,
    /// Effective anisotropic activity X = gξ_s.
    pub activity: D,
    /// ρ = ξ_b/ξ_s.
    pub ratio: D,
    /// 1/a² and 1/b² of the shell.
    pub inverse_a2: D,
    /// See [`Constants::inverse_a2`].
    pub inverse_b2: D,
    /// 2P0/w².
    pub shell_force: D,
    /// 1/w².
    pub inverse_w2: D,
    /// Cue: centre, 1/ω², amplitude (0 without a cue).
    pub cue: [D; 3],
    /// Whether κ varies at all.
    pub has_cue: bool,
    /// Volume of the whole cell, 4πR0³/3.
    pub volume: D,
    /// Whether ½C²∂_sκ is kept.
    pub rigidity_gradient: bool,
}

impl<D: Number> Constants<D> {
    /// Constants of a cell of radius `r0`; `vary` may replace any named parameter by a dual number.
    pub fn new(physics: &Physics, r0: f64, cue: &Cue, vary: impl Fn(Control, f64) -> D) -> Constants<D> {
        let at = |c: Control| vary(c, c.get(physics, r0, cue));
        let (r0, epsilon, aspect, w) = (at(Control::R0), at(Control::Epsilon), at(Control::Aspect), at(Control::W));
        let b3 = r0.powi(3) / (epsilon * aspect);
        let b2 = b3.powf(2.0 / 3.0);
        let inverse_w2 = w.powi(-2);
        let (eta_b, eta_s) = (at(Control::EtaB), at(Control::EtaS));
        Constants {
            kappa: at(Control::Kappa),
            eta_sum: eta_b + eta_s,
            eta_difference: eta_b - eta_s,
            friction: at(Control::Friction),
            tension: at(Control::Tension),
            activity: at(Control::Gain) * at(Control::Xi),
            ratio: at(Control::XiRatio),
            inverse_a2: (b2 * aspect.powi(2)).recip(),
            inverse_b2: b2.recip(),
            shell_force: at(Control::P0) * inverse_w2 * 2.0,
            inverse_w2,
            cue: [at(Control::CueU0), at(Control::CueOmega).powi(-2), at(Control::CueAmplitude)],
            has_cue: *cue != Cue::None,
            volume: r0.powi(3) * (4.0 * PI / 3.0),
            rigidity_gradient: physics.rigidity_gradient == RigidityGradient::Full,
        }
    }

    /// κ(u) and ∂κ/∂u.
    pub fn rigidity(&self, u: f64) -> (D, D) {
        if !self.has_cue {
            return (self.kappa, D::from(0.0));
        }
        let [u0, inverse_omega2, amplitude] = self.cue;
        let bump = (-(u0 - u).powi(2) * inverse_omega2).exp() * amplitude;
        (self.kappa * (bump + 1.0), self.kappa * bump * (u0 - u) * inverse_omega2 * 2.0)
    }
}

/// Local rates of change entering the equations at one point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// 1/Δt of the implicit step (0 for a stationary shape).
    pub rate: f64,
    /// Past r: ∂_t r = rate · (r − r_past).
    pub r_past: f64,
    /// Past z.
    pub z_past: f64,
}

/// Right-hand side d/du of the seven equations and the integrand of the volume, for any number type.
///
/// `noise` multiplies the activity. This is the readable statement; [`Cortex`] evaluates the same with hand-written
/// derivatives, and a test holds the two together.
pub fn equations<D: Number>(
    c: &Constants<D>,
    u: f64,
    motion: Motion,
    noise: f64,
    y: &[D; COMPONENTS],
    length: D,
    pressure: D,
) -> ([D; COMPONENTS], D) {
    let [r, z, m, psi, q, v, t] = *y;
    let (kappa, kappa_u) = c.rigidity(u);
    let (sin, cos) = psi.sin_cos();
    let inverse_r = r.recip();
    let c2 = sin * inverse_r;
    let mean = m / kappa;
    let c1 = mean - c2;
    let cot = cos * inverse_r;
    let activity = c.activity * noise;
    let v_n = (sin * (r - motion.r_past) + cos * (z - motion.z_past)) * motion.rate;
    let s_phi = cot * v + c2 * v_n;
    let s_u = (t - activity * ((c.ratio + 0.5) * mean - c2) - c.eta_difference * s_phi) / c.eta_sum;
    let t_phi = c.eta_difference * s_u + c.eta_sum * s_phi + activity * ((c.ratio - 0.5) * mean + c2);
    let inside = ((z * z * c.inverse_a2 + r * r * c.inverse_b2 - 1.0) * c.inverse_w2).exp();
    let shell = -(c.shell_force * inside * (r * sin * c.inverse_b2 + z * cos * c.inverse_a2));
    let difference = c1 - c2;
    let elastic = c.tension * mean - kappa * difference * difference * mean * 0.5;
    let mut t_u = (c.friction * v - cot * (t - t_phi)) * length;
    if c.rigidity_gradient {
        t_u -= mean * mean * kappa_u * 0.5;
    }
    (
        [
            length * cos,
            -(length * sin),
            length * q,
            length * c1,
            length * (c1 * t + c2 * t_phi + elastic - cot * q - pressure - shell),
            length * (s_u - c1 * v_n),
            t_u,
        ],
        length * r * r * sin * PI,
    )
}

/// Multiplies the activity in the first step: 1 + Σ_{n=1..10} r_n cos(nπu).
pub fn noise_factor(coefficients: &[f64; 10], u: f64) -> f64 {
    1.0 + coefficients.iter().enumerate().map(|(k, r)| r * ((k + 1) as f64 * PI * u).cos()).sum::<f64>()
}

/// The boundary-value problem of one cell: stationary (`rate` = 0) or one implicit time step.
#[derive(Clone, Debug)]
pub struct Cortex {
    /// Physical parameters.
    pub physics: Physics,
    /// Cell radius R0.
    pub r0: f64,
    /// Cue.
    pub cue: Cue,
    /// Part of the contour.
    pub domain: Domain,
    /// Parameters that are scalar unknowns, in the order they follow (L, p).
    pub controls: Vec<Control>,
    /// 1/Δt of the implicit step; 0 for stationary shapes.
    pub rate: f64,
    /// Past (r, z) at every collocation point; may be empty if `rate` = 0.
    pub past: Vec<[f64; 2]>,
    /// Factor on the activity at every collocation point; empty for none.
    pub noise: Vec<f64>,
    constants: Constants<f64>,
    sensitivities: Vec<Constants<Dual64>>,
}

impl Cortex {
    /// The stationary problem.
    pub fn new(physics: &Physics, r0: f64, cue: &Cue, domain: Domain, controls: &[Control]) -> Cortex {
        let mut cortex = Cortex {
            physics: *physics,
            r0,
            cue: *cue,
            domain,
            controls: controls.to_vec(),
            rate: 0.0,
            past: Vec::new(),
            noise: Vec::new(),
            constants: Constants::new(physics, r0, cue, |_, v| v),
            sensitivities: Vec::new(),
        };
        cortex.update_sensitivities();
        cortex
    }

    /// Sizes for a number of continuation parameters, on either domain.
    pub fn dimensions_for(controls: usize) -> Dimensions {
        Dimensions { components: COMPONENTS, integrable: 3, scalars: 2 + controls, left: 4, right: 4, integrals: 1 }
    }

    /// Constants at the current parameters.
    pub fn constants(&self) -> &Constants<f64> {
        &self.constants
    }

    /// Changes one parameter.
    pub fn set(&mut self, control: Control, value: f64) {
        control.set(value, &mut self.physics, &mut self.r0, &mut self.cue);
        self.refresh();
    }

    /// Current value of a parameter.
    pub fn get(&self, control: Control) -> f64 {
        control.get(&self.physics, self.r0, &self.cue)
    }

    /// Recomputes the constants after `physics`, `r0` or `cue` were changed directly.
    pub fn refresh(&mut self) {
        self.constants = Constants::new(&self.physics, self.r0, &self.cue, |_, v| v);
        self.update_sensitivities();
    }

    fn update_sensitivities(&mut self) {
        self.sensitivities.clear();
        for k in 0..self.controls.len() {
            let varied = self.controls[k];
            self.sensitivities.push(Constants::new(&self.physics, self.r0, &self.cue, |c, v| {
                if c == varied { Dual64::new(v, 1.0) } else { Dual64::from_re(v) }
            }));
        }
    }

    fn motion(&self, site: Site) -> Motion {
        if self.rate == 0.0 {
            return Motion::default();
        }
        let [r_past, z_past] = self.past[site.index];
        Motion { rate: self.rate, r_past, z_past }
    }

    /// ∂f/∂v_n at one point of state `y` and contour length `length`: what a normal velocity of the cortex adds to the
    /// right-hand sides of q′, v′ and T′. The equations are linear in v_n.
    pub fn response_to_normal_velocity(&self, u: f64, y: &[f64], length: f64) -> [f64; COMPONENTS] {
        let c = &self.constants;
        let (sin, cos) = y[PSI].sin_cos();
        let c2 = sin / y[R];
        let c1 = y[M] / c.rigidity(u).0 - c2;
        let d_s_u = -c.eta_difference * c2 / c.eta_sum;
        let d_t_phi = c.eta_difference * d_s_u + c.eta_sum * c2;
        let mut out = [0.0; COMPONENTS];
        out[Q] = length * c2 * d_t_phi;
        out[V] = length * (d_s_u - c1);
        out[T] = length * cos / y[R] * d_t_phi;
        out
    }

    fn noise_at(&self, site: Site) -> f64 {
        self.noise.get(site.index).copied().unwrap_or(1.0)
    }

    /// Target of the volume integral and its part of the whole cell.
    fn volume_share(&self) -> f64 {
        match self.domain {
            Domain::Full => 1.0,
            Domain::Half => 0.5,
        }
    }
}

type Gradient = [f64; 8];

#[inline(always)]
fn combine(terms: &[(f64, &Gradient)]) -> Gradient {
    let mut out = [0.0; 8];
    for (factor, gradient) in terms {
        for k in 0..8 {
            out[k] += factor * gradient[k];
        }
    }
    out
}

impl BoundaryValueProblem for Cortex {
    fn dimensions(&self) -> Dimensions {
        Cortex::dimensions_for(self.controls.len())
    }

    fn prepare(&mut self, p: &[f64]) {
        if self.controls.is_empty() {
            return;
        }
        for k in 0..self.controls.len() {
            self.controls[k].set(p[2 + k], &mut self.physics, &mut self.r0, &mut self.cue);
        }
        self.refresh();
    }

    fn rhs(&self, site: Site, y: &[f64], p: &[f64], f: &mut [f64], g: &mut [f64]) {
        let state: [f64; COMPONENTS] = std::array::from_fn(|k| y[k]);
        let (value, volume) =
            equations(&self.constants, site.x, self.motion(site), self.noise_at(site), &state, p[LENGTH], p[PRESSURE]);
        f.copy_from_slice(&value);
        g[0] = volume;
    }

    fn rhs_jacobian(&self, site: Site, y: &[f64], p: &[f64], out: &mut PointJacobian<'_>) {
        let c = &self.constants;
        let (length, pressure) = (p[LENGTH], p[PRESSURE]);
        let [r, z, m, psi, q, v, t]: [f64; COMPONENTS] = std::array::from_fn(|k| y[k]);
        let motion = self.motion(site);
        let (kappa, kappa_u) = c.rigidity(site.x);
        let (sin, cos) = f64::sin_cos(psi);
        let inverse_r = 1.0 / r;
        let (c2, cot) = (sin * inverse_r, cos * inverse_r);
        let (inverse_kappa, mean) = (1.0 / kappa, m / kappa);
        let c1 = mean - c2;
        let x = c.activity * self.noise_at(site);
        // Gradients with respect to (r, z, m, ψ, q, v, T).
        let d_c2: Gradient = [-c2 * inverse_r, 0.0, 0.0, cot, 0.0, 0.0, 0.0, 0.0];
        let d_c1: Gradient = [c2 * inverse_r, 0.0, inverse_kappa, -cot, 0.0, 0.0, 0.0, 0.0];
        let d_cot: Gradient = [-cot * inverse_r, 0.0, 0.0, -c2, 0.0, 0.0, 0.0, 0.0];
        let (dr, dz) = (motion.rate * (r - motion.r_past), motion.rate * (z - motion.z_past));
        let v_n = sin * dr + cos * dz;
        let d_vn: Gradient = [motion.rate * sin, motion.rate * cos, 0.0, cos * dr - sin * dz, 0.0, 0.0, 0.0, 0.0];
        let s_phi = cot * v + c2 * v_n;
        let mut d_s_phi = combine(&[(v, &d_cot), (v_n, &d_c2), (c2, &d_vn)]);
        d_s_phi[V] += cot;
        let inverse_sum = 1.0 / c.eta_sum;
        let (up, down) = (x * (0.5 + c.ratio), x * (c.ratio - 0.5));
        let s_u = (t - up * mean + x * c2 - c.eta_difference * s_phi) * inverse_sum;
        let mut d_s_u = combine(&[(x * inverse_sum, &d_c2), (-c.eta_difference * inverse_sum, &d_s_phi)]);
        d_s_u[M] -= up * inverse_kappa * inverse_sum;
        d_s_u[T] += inverse_sum;
        let t_phi = c.eta_difference * s_u + c.eta_sum * s_phi + down * mean + x * c2;
        let mut d_t_phi = combine(&[(c.eta_difference, &d_s_u), (c.eta_sum, &d_s_phi), (x, &d_c2)]);
        d_t_phi[M] += down * inverse_kappa;
        let inside = ((z * z * c.inverse_a2 + r * r * c.inverse_b2 - 1.0) * c.inverse_w2).exp();
        let push = c.shell_force * inside;
        let slope = r * sin * c.inverse_b2 + z * cos * c.inverse_a2;
        let shell = -push * slope;
        let difference = c1 - c2;
        let elastic = (c.tension - 0.5 * kappa * difference * difference) * mean;
        let q_s = c1 * t + c2 * t_phi + elastic - cot * q - pressure - shell;
        let shear = -kappa * difference * mean;
        let mut d_q = combine(&[(t + shear, &d_c1), (t_phi - shear, &d_c2), (c2, &d_t_phi), (-q, &d_cot)]);
        d_q[M] += (c.tension - 0.5 * kappa * difference * difference) * inverse_kappa;
        d_q[T] += c1;
        d_q[Q] -= cot;
        d_q[R] += push * (2.0 * r * c.inverse_b2 * c.inverse_w2 * slope + sin * c.inverse_b2);
        d_q[Z] += push * (2.0 * z * c.inverse_a2 * c.inverse_w2 * slope + cos * c.inverse_a2);
        d_q[PSI] += push * (r * cos * c.inverse_b2 - z * sin * c.inverse_a2);
        let v_s = s_u - c1 * v_n;
        let d_v = combine(&[(1.0, &d_s_u), (-v_n, &d_c1), (-c1, &d_vn)]);
        let t_s = c.friction * v - cot * (t - t_phi);
        let mut d_t = combine(&[(t_phi - t, &d_cot), (cot, &d_t_phi)]);
        d_t[V] += c.friction;
        d_t[T] -= cot;
        let band = if c.rigidity_gradient { 0.5 * kappa_u } else { 0.0 };

        let n = COMPONENTS;
        let f_s = [cos, -sin, q, c1, q_s, v_s, t_s];
        for k in 0..n {
            out.f[k] = length * f_s[k];
            out.fp[k * (2 + self.controls.len())] = f_s[k];
        }
        out.f[T] -= band * mean * mean;
        out.fy[R * n + PSI] = -length * sin;
        out.fy[Z * n + PSI] = -length * cos;
        out.fy[M * n + Q] = length;
        for k in 0..n {
            out.fy[PSI * n + k] = length * d_c1[k];
            out.fy[Q * n + k] = length * d_q[k];
            out.fy[V * n + k] = length * d_v[k];
            out.fy[T * n + k] = length * d_t[k];
        }
        out.fy[T * n + M] -= 2.0 * band * mean * inverse_kappa;
        let scalars = 2 + self.controls.len();
        out.fp[Q * scalars + PRESSURE] = -length;
        out.g[0] = PI * length * r * r * sin;
        out.gy[R] = 2.0 * PI * length * r * sin;
        out.gy[PSI] = PI * length * r * r * cos;
        out.gp[LENGTH] = PI * r * r * sin;
        for (k, constants) in self.sensitivities.iter().enumerate() {
            let state: [Dual64; COMPONENTS] = std::array::from_fn(|i| Dual64::from_re(y[i]));
            let (f, _) = equations(
                constants,
                site.x,
                motion,
                self.noise_at(site),
                &state,
                Dual64::from_re(length),
                Dual64::from_re(pressure),
            );
            for i in 0..n {
                out.fp[i * scalars + 2 + k] = f[i].eps;
            }
        }
    }

    fn left(&self, y: &[f64], _p: &[f64], out: &mut BoundaryJacobian<'_>) {
        for (k, component) in [R, PSI, Q, V].into_iter().enumerate() {
            out.r[k] = y[component];
            out.ry[k * COMPONENTS + component] = 1.0;
        }
    }

    fn right(&self, y: &[f64], _p: &[f64], out: &mut BoundaryJacobian<'_>) {
        let (first, angle) = match self.domain {
            Domain::Full => (R, PI),
            Domain::Half => (Z, 0.5 * PI),
        };
        for (k, component) in [first, PSI, Q, V].into_iter().enumerate() {
            out.r[k] = y[component];
            out.ry[k * COMPONENTS + component] = 1.0;
        }
        out.r[1] -= angle;
    }

    fn integral_offset(&self, _k: usize, _p: &[f64], hp: &mut [f64]) -> f64 {
        let share = self.volume_share();
        for (k, constants) in self.sensitivities.iter().enumerate() {
            hp[2 + k] = -share * constants.volume.eps;
        }
        -share * self.constants.volume
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_dual::Dual64;

    /// The hand-written Jacobian equals the derivative of the generic equations at random states.
    #[test]
    fn jacobian_matches_dual_numbers() {
        let physics = Physics { tension: 0.3, eta_s: 0.7, friction: 1.2, ..Physics::GAO2026 };
        let cue = Cue::Kappa { u0: 0.465, omega: 0.0577, amplitude: 0.1 };
        let controls = [Control::Xi, Control::R0, Control::CueU0];
        let mut cortex = Cortex::new(&physics, 2.3, &cue, Domain::Full, &controls);
        cortex.rate = 3.0;
        cortex.past = vec![[1.1, -0.2]];
        cortex.noise = vec![1.03];
        let site = Site { x: 0.44, index: 0 };
        let mut seed = 12345u64;
        let mut random = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 11) as f64 / (1u64 << 53) as f64
        };
        for _ in 0..50 {
            let mut y: [f64; COMPONENTS] = std::array::from_fn(|_| 2.0 * random() - 1.0);
            y[R] = 0.5 + 1.5 * random();
            y[PSI] = 3.0 * random();
            let p = [7.0 + random(), 3.0 * random(), 25.0, 2.3, 0.465];
            cortex.prepare(&p);
            let (n, np) = (COMPONENTS, p.len());
            let (mut f, mut fy, mut fp) = (vec![0.0; n], vec![0.0; n * n], vec![0.0; n * np]);
            let (mut g, mut gy, mut gp) = (vec![0.0], vec![0.0; n], vec![0.0; np]);
            let mut out = PointJacobian { f: &mut f, fy: &mut fy, fp: &mut fp, g: &mut g, gy: &mut gy, gp: &mut gp };
            cortex.rhs_jacobian(site, &y, &p, &mut out);
            let (mut f2, mut g2) = (vec![0.0; n], vec![0.0]);
            cortex.rhs(site, &y, &p, &mut f2, &mut g2);
            let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-11 * (1.0 + a.abs()), "{a} {b}");
            for k in 0..n {
                close(f[k], f2[k]);
            }
            close(g[0], g2[0]);
            // Stepping back by −n/rate is a unit normal velocity.
            let response = cortex.response_to_normal_velocity(site.x, &y, p[0]);
            let (sin, cos) = y[PSI].sin_cos();
            let [r_past, z_past] = cortex.past[0];
            let moved = Motion { rate: 3.0, r_past: r_past - sin / 3.0, z_past: z_past - cos / 3.0 };
            let (f3, _) = equations(&cortex.constants, site.x, moved, 1.03, &y, p[0], p[1]);
            for k in 0..n {
                close(f3[k] - f[k], response[k]);
            }
            let constants = Constants::<Dual64>::new(&cortex.physics, cortex.r0, &cue, |_, v| v.into());
            for k in 0..n + 2 {
                let unit = |i: usize, v: f64| Dual64::new(v, if i == k { 1.0 } else { 0.0 });
                let state: [Dual64; COMPONENTS] = std::array::from_fn(|i| unit(i, y[i]));
                let (d, dg) =
                    equations(&constants, site.x, cortex.motion(site), 1.03, &state, unit(n, p[0]), unit(n + 1, p[1]));
                for i in 0..n {
                    close(d[i].eps, if k < n { fy[i * n + k] } else { fp[i * np + k - n] });
                }
                close(dg.eps, if k < n { gy[k] } else { gp[k - n] });
            }
        }
    }
}
