//! An independent statement of the balance of forces from the paper, as rates along the contour: stresses first, then the
//! tangential and the normal balance, with η_b and η_s as printed and the elastic
//! stress from the energy of bending.

use furrow_cell::{Cell, Number, RigidityGradient};
use furrow_mechanics::cortex::equations::{COMPONENTS, J, PHI};

use crate::coefficients::{coefficients, shell_force};

/// Viscous and active in-plane stresses (uu, φφ).
pub fn stress<D: Number>([eta_b, eta_s, xi_s, xi_b]: [D; 4], strain: [D; 2], curvature: [D; 2]) -> [D; 2] {
    let ([s_uu, s_pp], [c1, c2]) = (strain, curvature);
    let isotropic = eta_b * (s_uu + s_pp) + xi_b * (c1 + c2);
    let deviatoric = eta_s * (s_uu - s_pp) + xi_s * (c1 - c2) * 0.5;
    [isotropic + deviatoric, isotropic - deviatoric]
}

/// ∂_s of (r, z, m, ψ, q, v, T), and of a regulator (j, φ) where N is 9, at u, where the contour and φ change by `motion` =
/// ∂_t(r, z, φ) and activity is multiplied by `noise`.
pub fn rates<D: Number, const N: usize>(
    cell: &Cell,
    u: D,
    length: f64,
    pressure: f64,
    noise: f64,
    y: &[D; N],
    motion: [D; 3],
) -> [D; N] {
    let [r, z, m, psi, q, v, t]: [D; COMPONENTS] = std::array::from_fn(|k| y[k]);
    let carried = (N > COMPONENTS).then(|| [y[PHI], y[J] * length]);
    let c = coefficients(cell, u, D::from(length), carried);
    let (sin, cos) = psi.sin_cos();
    let c2 = sin / r;
    let c1 = m / c.kappa + c.spontaneous - c2;
    let v_n = sin * motion[0] + cos * motion[1];
    let s_pp = cos * v / r + c2 * v_n;
    // T is linear in S_uu: its value at S_uu = 0, and the difference.
    let law = [c.eta_b, c.eta_s, c.xi_s * noise, c.xi_b * noise];
    let without = stress(law, [D::from(0.0), s_pp], [c1, c2]);
    let s_uu = (t - without[0]) / (c.eta_b + c.eta_s);
    let t_pp = stress(law, [s_uu, s_pp], [c1, c2])[1];
    // t^ij = (γ + ½κ(C − C0)²) g^ij − κ(C − C0) C^ij, where κ(C − C0) is m.
    let energy = m * m / (c.kappa * 2.0) + c.tension;
    let (h_uu, h_pp) = (energy - m * c1, energy - m * c2);
    let mut t_s = c.friction * v - cos / r * (t - t_pp) - c.tension_s;
    if cell.material.rigidity_gradient == RigidityGradient::Full {
        t_s -= m * m / (c.kappa * c.kappa) * c.kappa_s * 0.5;
    }
    let q_s = c1 * (h_uu + t) + c2 * (h_pp + t_pp) - cos / r * q - pressure - shell_force(cell, r, z, psi)
        + v_n * cell.material.normal_friction;
    let mut out = [D::from(0.0); N];
    out[..COMPONENTS].copy_from_slice(&[cos, -sin, q, c1, q_s, s_uu - c1 * v_n, t_s]);
    if let (Some(regulator), true) = (cell.cue.regulator(), N > COMPONENTS) {
        let (j, phi) = (y[J], y[PHI]);
        // The flux −D j through a ring of the surface changes by storage, advection, concentration, source and loss there.
        let along = cos * motion[0] - sin * motion[1];
        let mut lost = motion[2] + (v - along) * j + (phi - c.source) * regulator.turnover;
        if regulator.diluted {
            lost += (phi + 1.0) * (s_uu + s_pp);
        }
        (out[J], out[PHI]) = (lost / regulator.diffusion - cos / r * j, j);
    }
    out
}
