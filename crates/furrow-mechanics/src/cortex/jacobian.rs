//! The equations with hand-written derivatives, for the collocation sweep of Newton's method.
//!
//! Each line repeats a line of [`balances`] with its derivatives; tests in `crates/furrow-verification` compare the two
//! for every field and profile of a cue.

use std::f64::consts::PI;

use super::equations::{
    Balance, BdfTerm, COMPONENTS, J, LocalCoefficients, PHI, PSI, Place, Q, R, REGULATED, ShellCoefficients, T,
    Transport, V, Z, balances, carried,
};
use super::lanes::Arithmetic;

/// The equations at one place and their derivatives. Derivatives without a field here are zero.
#[derive(Clone, Copy, Debug)]
pub struct Linearised<D> {
    /// Right-hand sides f.
    pub f: [D; COMPONENTS],
    /// ∂f/∂L, without the contribution of widths in L_h.
    pub by_length: [D; COMPONENTS],
    /// ∂(r′, z′)/∂ψ.
    pub geometry: [D; 2],
    /// ∂ψ′/∂(r, m, ψ).
    pub turning: [D; 3],
    /// ∂q′/∂(r, z, m, ψ, q, v, T).
    pub normal: [D; COMPONENTS],
    /// ∂v′/∂(r, z, m, ψ, q, v, T).
    pub flow: [D; COMPONENTS],
    /// ∂T′/∂(r, z, m, ψ, q, v, T).
    pub tangential: [D; COMPONENTS],
    /// Integrand of the volume, and its derivatives by r, ψ and L.
    pub volume: [D; 4],
    /// ∂S_uu/∂(r, z, m, ψ, q, v, T).
    pub strain: [D; COMPONENTS],
    /// Shared quantities.
    pub place: Place<D>,
}

/// The equations of a cell with a regulator at one place and their derivatives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LinearisedRegulated<D> {
    /// The shape's equations.
    pub shape: Linearised<D>,
    /// ∂f/∂φ of the shape's right-hand sides.
    pub by_phi: [D; COMPONENTS],
    /// ∂T′/∂j.
    pub tangential_by_j: D,
    /// j_s, and its derivatives by all nine components, in units of arclength.
    pub carried: (D, [D; REGULATED]),
    /// ∂j_s/∂L, without the contribution of widths in L_h.
    pub carried_by_length: D,
}

/// The force balances at one place and their derivatives, in units of arclength. Names follow [`balances`], with `_r`,
/// `_z`, `_m`, `_psi`, `_v` and `_t` for derivatives.
#[inline(always)]
pub fn linearised<D: Arithmetic>(
    c: &ShellCoefficients<D>,
    here: &LocalCoefficients<D>,
    motion: BdfTerm<D>,
    noise: D,
    y: &[D; COMPONENTS],
    length: D,
    pressure: D,
) -> Linearised<D> {
    let [r, z, m, psi, q, v, t] = *y;
    let (sin, cos) = psi.sin_cos();
    let (inverse_r, inverse_kappa) = (r.recip(), here.kappa.recip());
    let (c2, cot, bent) = (sin * inverse_r, cos * inverse_r, m / here.kappa);
    let mean = bent + here.spontaneous;
    let (c2_r, cot_r) = (-(c2 * inverse_r), -(cot * inverse_r));
    let c1 = mean - c2;
    let (dr, dz) = (motion.rate * (r - motion.r_past), motion.rate * (z - motion.z_past));
    let v_n = sin * dr + cos * dz;
    let (n_r, n_z, n_psi) = (motion.rate * sin, motion.rate * cos, cos * dr - sin * dz);

    // S_φφ, S_uu and T_φφ.
    let s_phi = cot * v + c2 * v_n;
    let s_r = cot_r * v + c2_r * v_n + c2 * n_r;
    let s_z = c2 * n_z;
    let s_psi = cot * v_n - c2 * v + c2 * n_psi;
    let (xi_s, xi_b) = (here.xi_s * noise, here.xi_b * noise);
    let (along, around) = (xi_s * 0.5 + xi_b, xi_b - xi_s * 0.5);
    let u_t = here.eta_sum.recip();
    let mixing = here.eta_difference * u_t;
    let s_u = (t - along * mean + xi_s * c2 - here.eta_difference * s_phi) * u_t;
    let pull = xi_s * u_t;
    let (u_r, u_z, u_m) = (pull * c2_r - mixing * s_r, -(mixing * s_z), -(along * inverse_kappa * u_t));
    let (u_psi, u_v) = (pull * cot - mixing * s_psi, -(mixing * cot));
    let t_phi = here.eta_difference * s_u + here.eta_sum * s_phi + around * mean + xi_s * c2;
    let t_r = here.eta_difference * u_r + here.eta_sum * s_r + xi_s * c2_r;
    let t_z = here.eta_difference * u_z + here.eta_sum * s_z;
    let t_m = here.eta_difference * u_m + around * inverse_kappa;
    let t_psi = here.eta_difference * u_psi + here.eta_sum * s_psi + xi_s * cot;
    let t_v = here.eta_difference * u_v + here.eta_sum * cot;
    let t_t = mixing;

    // The normal balance, without the pressure.
    let (by_a2, by_b2) = (z * c.inverse_a2, r * c.inverse_b2);
    let inside = ((z * by_a2 + r * by_b2 - 1.0) * c.inverse_w2).exp();
    let push = c.shell_force * inside;
    let slope = by_b2 * sin + by_a2 * cos;
    let steeper = slope * c.inverse_w2 * 2.0;
    let difference = c1 - c2;
    let drag = c.normal_friction;
    let curl = here.kappa * here.spontaneous;
    let curled = curl * (here.spontaneous * 0.5 - mean);
    let stretch = here.tension - here.kappa * difference * difference * 0.5 + curled;
    let shear = -(here.kappa * difference * bent);
    let (first, second) = (t + shear, t_phi - shear);
    let q_s = c1 * t + c2 * t_phi + stretch * mean - cot * q + push * slope + curl * (c1 * c1 + c2 * c2) + drag * v_n;
    let normal = [
        c2_r * (second - first) + t_r * c2 - cot_r * q + push * (by_b2 * steeper + sin * c.inverse_b2) + drag * n_r,
        t_z * c2 + push * (by_a2 * steeper + cos * c.inverse_a2) + drag * n_z,
        inverse_kappa * (first + stretch) + t_m * c2,
        cot * (second - first) + t_psi * c2 + c2 * q + push * (by_b2 * cos - by_a2 * sin) + drag * n_psi,
        -cot,
        t_v * c2,
        t_t * c2 + c1,
    ];

    // The tangential balance, without the terms of a varying κ and γ, and the flow.
    let t_s = here.friction * v - cot * (t - t_phi);
    let hoop = t_phi - t;
    let mut tangential = [
        (cot_r * hoop + t_r * cot) * length,
        t_z * cot * length,
        t_m * cot * length,
        (t_psi * cot - c2 * hoop) * length,
        D::from(0.0),
        (t_v * cot + here.friction) * length,
        (t_t * cot - cot) * length,
    ];
    let v_s = s_u - c1 * v_n;
    let flow = [
        u_r + c2_r * v_n - c1 * n_r,
        u_z - c1 * n_z,
        u_m - inverse_kappa * v_n,
        u_psi + cot * v_n - c1 * n_psi,
        D::from(0.0),
        u_v,
        u_t,
    ];
    let mut t_u = t_s * length - here.tension_u;
    if c.rigidity_gradient {
        let band = bent * here.kappa_u;
        t_u = t_u - band * bent * 0.5;
        tangential[2] = tangential[2] - band * inverse_kappa;
    }
    let by_length = [cos, -sin, q, c1, q_s - pressure, v_s, t_s];
    let mut f = by_length.map(|slope| length * slope);
    f[COMPONENTS - 1] = t_u;
    let area = r * sin * PI;
    Linearised {
        f,
        by_length,
        geometry: [-(length * sin), -(length * cos)],
        turning: [-(length * c2_r), length * inverse_kappa, -(length * cot)],
        normal: normal.map(|d| length * d),
        flow: flow.map(|d| length * d),
        tangential,
        volume: [length * r * area, length * area * 2.0, length * r * r * cos * PI, r * area],
        strain: [u_r, u_z, u_m, u_psi, D::from(0.0), u_v, u_t],
        place: Place { sin, cos, cot, mean, c1, c2, v_n, s_u, s_phi, t_phi },
    }
}

/// [`linearised`] for a cell with a regulator `[j, φ]`: `here` are the coefficients with its contribution, `by_phi`
/// their derivatives by φ.
#[inline(always)]
pub(crate) fn linearised_regulated<D: Arithmetic>(
    c: &ShellCoefficients<D>,
    transport: &Transport<D>,
    [here, by_phi]: [&LocalCoefficients<D>; 2],
    motion: BdfTerm<D>,
    noise: D,
    y: &[D; COMPONENTS],
    [j, phi]: [D; 2],
    length: D,
    pressure: D,
) -> LinearisedRegulated<D> {
    let mut shape = linearised(c, here, motion, noise, y, length, pressure);
    let (by_phi_f, strain_phi) = through_coefficients(c, [here, by_phi], noise, y, &shape.place, length);
    // κ_u and γ_u are L j times the derivatives of κ and γ by φ.
    let bent = shape.place.mean - here.spontaneous;
    let mut pull = by_phi.tension;
    if c.rigidity_gradient {
        pull = pull + bent * bent * by_phi.kappa * 0.5;
    }
    shape.by_length[T] = shape.by_length[T] - pull * j;

    let (rate, past) = (motion.rate, motion.carried_past);
    let Place { sin, cos, cot, s_u, v_n, .. } = shape.place;
    let (dr, dz) = (rate * (y[R] - motion.r_past), rate * (y[Z] - motion.z_past));
    let one = D::from(1.0);
    let (inverse_r, inverse_length) = (y[R].recip(), length.recip());
    let slip = y[V] - (cos * dr - sin * dz);
    // E, with its derivatives by ψ and L.
    let followed = (cos * past.r_u - sin * past.z_u) * inverse_length;
    let stretched = (one - followed) * rate;
    let stretched_psi = (sin * past.r_u + cos * past.z_u) * inverse_length * rate;
    let stored = rate * transport.dilution * past.amount * inverse_r * inverse_length;
    let dilution = transport.dilution * (phi + one);
    // Factor of v − w.
    let by_slip = j + dilution * cot;
    let mut by = [D::from(0.0); REGULATED];
    for k in 0..COMPONENTS {
        by[k] = dilution * shape.strain[k];
    }
    by[R] = by[R] - rate * cos * by_slip + (stored - dilution * cot * slip) * inverse_r;
    by[Z] = by[Z] + rate * sin * by_slip;
    by[PSI] = by[PSI] + v_n * by_slip - dilution * (sin * inverse_r * slip + stretched_psi);
    by[V] = by[V] + by_slip;
    by[J] = slip;
    let spread = s_u + cot * slip - stretched;
    by[PHI] = rate + transport.turnover + transport.dilution * spread + dilution * strain_phi;
    for k in 0..REGULATED {
        by[k] = by[k] * transport.inverse_diffusion;
    }
    by[R] = by[R] + cot * inverse_r * j;
    by[PSI] = by[PSI] + sin * inverse_r * j;
    by[J] = by[J] - cot;
    let by_length = (stored - dilution * rate * followed) * inverse_length * transport.inverse_diffusion;
    LinearisedRegulated {
        by_phi: by_phi_f,
        tangential_by_j: -(pull * length),
        carried: (carried(transport, here.source, motion, y, [j, phi], &shape.place, length), by),
        carried_by_length: by_length,
        shape,
    }
}

/// ∂f/∂φ of the shape's right-hand sides and ∂S_uu/∂φ, which act through the coefficients only; `_phi` marks
/// derivatives. The same holds for any other number that coefficients depend on.
#[inline(always)]
fn through_coefficients<D: Arithmetic>(
    c: &ShellCoefficients<D>,
    [here, by_phi]: [&LocalCoefficients<D>; 2],
    noise: D,
    y: &[D; COMPONENTS],
    at: &Place<D>,
    length: D,
) -> ([D; COMPONENTS], D) {
    let Place { cot, mean, c1, c2, v_n, s_u, s_phi, .. } = *at;
    let [along, around] = [1.0, -1.0].map(|sign| (here.xi_b + here.xi_s * (0.5 * sign)) * noise);
    let [along_phi, around_phi] = [1.0, -1.0].map(|sign| (by_phi.xi_b + by_phi.xi_s * (0.5 * sign)) * noise);
    let deviator_phi = by_phi.xi_s * noise * c2;
    let spontaneous = here.spontaneous;
    let bent = mean - spontaneous;
    let bent_phi = -(bent * by_phi.kappa / here.kappa);
    let mean_phi = bent_phi + by_phi.spontaneous;
    let pressed = deviator_phi - along_phi * mean - along * mean_phi;
    let s_u_phi = (pressed - by_phi.eta_difference * s_phi - by_phi.eta_sum * s_u) / here.eta_sum;
    let t_phi_phi = by_phi.eta_difference * s_u
        + here.eta_difference * s_u_phi
        + by_phi.eta_sum * s_phi
        + around_phi * mean
        + around * mean_phi
        + deviator_phi;
    let difference = c1 - c2;
    let stretch = here.tension - here.kappa * difference * difference * 0.5;
    let stretch_phi =
        by_phi.tension - by_phi.kappa * difference * difference * 0.5 - here.kappa * difference * mean_phi;
    // Of κC0(½C0C − 2c1c2), by C, by κ and by C0.
    let gauss = c1 * c2 * 2.0;
    let curled_phi = here.kappa * spontaneous * (spontaneous * 0.5 - c2 * 2.0) * mean_phi
        + by_phi.kappa * spontaneous * (spontaneous * mean * 0.5 - gauss)
        + by_phi.spontaneous * here.kappa * (spontaneous * mean - gauss);
    let q_phi = mean_phi * (y[T] + stretch) + c2 * t_phi_phi + stretch_phi * mean + curled_phi;
    let mut t_u_phi = (by_phi.friction * y[V] + cot * t_phi_phi) * length - by_phi.tension_u;
    if c.rigidity_gradient {
        t_u_phi = t_u_phi - (bent_phi * here.kappa_u + bent * by_phi.kappa_u * 0.5) * bent;
    }
    let mut f = [D::from(0.0); COMPONENTS];
    (f[PSI], f[Q], f[T]) = (length * mean_phi, length * q_phi, t_u_phi);
    f[V] = length * (s_u_phi - mean_phi * v_n);
    (f, s_u_phi)
}

/// Derivatives of [`balances`] and of S_uu by a number that enters only through the coefficients: of the shell and of
/// the place, each followed by its own derivatives.
#[inline(always)]
pub fn varied<D: Arithmetic>(
    [c, by]: &[ShellCoefficients<D>; 2],
    here: [&LocalCoefficients<D>; 2],
    motion: BdfTerm<D>,
    noise: D,
    y: &[D; COMPONENTS],
    length: D,
    pressure: D,
) -> ([D; COMPONENTS], D, Place<D>) {
    let Balance { place, .. } = balances(c, here[0], motion, noise, y, length, pressure);
    let (mut f, strain) = through_coefficients(c, here, noise, y, &place, length);
    let (r2, z2, along, across) = (y[R] * y[R], y[Z] * y[Z], y[Z] * place.cos, y[R] * place.sin);
    let ellipse = z2 * c.inverse_a2 + r2 * c.inverse_b2 - 1.0;
    let steeper = (z2 * by.inverse_a2 + r2 * by.inverse_b2) * c.inverse_w2 + ellipse * by.inverse_w2;
    let slope = across * c.inverse_b2 + along * c.inverse_a2;
    let turned = across * by.inverse_b2 + along * by.inverse_a2;
    let push = by.shell_force * slope + c.shell_force * (steeper * slope + turned);
    f[Q] = f[Q] + length * (ellipse * c.inverse_w2).exp() * push + length * by.normal_friction * place.v_n;
    (f, strain, place)
}

/// The derivative of [`carried`] by such a number, on which the transport and the source may depend too; `strain` is
/// ∂S_uu.
#[inline(always)]
pub(crate) fn varied_flux<D: Arithmetic>(
    [c, by]: &[Transport<D>; 2],
    [source, source_by]: [D; 2],
    motion: BdfTerm<D>,
    y: &[D; COMPONENTS],
    [j, phi]: [D; 2],
    at: &Place<D>,
    strain: D,
    length: D,
) -> D {
    let spread = carried(c, source, motion, y, [j, phi], at, length) + at.cot * j;
    let changed = c.dilution * (phi + D::from(1.0)) * strain + by.turnover * (phi - source) - c.turnover * source_by;
    changed * c.inverse_diffusion + spread * by.inverse_diffusion / c.inverse_diffusion
}
