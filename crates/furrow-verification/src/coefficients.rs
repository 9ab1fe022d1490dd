//! The coefficients of the model at a point of the contour, from the definition of a cue:
//! X(u) = X0·(1 + Σ A f(u)) for every field but tension, for which γ(u) = γ0 + Σ A f(u); a regulator adds B φ.

use furrow_cell::cue::{Coupling, Field, Profile, Width};
use furrow_cell::{Cell, Number};

/// Coefficients at one point, activities with the gain. Units are as in [`Cell`].
#[derive(Clone, Copy, Debug)]
pub struct Coefficients<D> {
    /// Bending rigidity κ.
    pub kappa: D,
    /// ∂_s κ.
    pub kappa_s: D,
    /// Bulk viscosity η_b.
    pub eta_b: D,
    /// Shear viscosity η_s.
    pub eta_s: D,
    /// Friction Γ.
    pub friction: D,
    /// Passive tension γ.
    pub tension: D,
    /// ∂_s γ.
    pub tension_s: D,
    /// gξ_s.
    pub xi_s: D,
    /// gξ_b.
    pub xi_b: D,
    /// A f of the regulator's source.
    pub source: D,
    /// Spontaneous curvature C0.
    pub spontaneous: D,
}

/// A profile f and ∂f/∂u.
fn profile<D: Number>(profile: &Profile, u: D, length: D) -> [D; 2] {
    let in_u = |omega: Width| match omega {
        Width::Fraction(omega) => D::from(omega),
        Width::Length(omega) => length.recip() * omega,
    };
    match *profile {
        Profile::Band { u0, omega } => {
            let omega = in_u(omega);
            let x = (u - u0) / omega;
            let f = (-(x * x)).exp();
            [f, f * x * -2.0 / omega]
        }
        Profile::Step { u0, omega } => {
            // ½(1 + tanh x) = 1/(1 + e^(−2x)), and its slope by the logistic's f(1 − f).
            let omega = in_u(omega);
            let f = (((u - u0) * -2.0 / omega).exp() + 1.0).recip();
            [f, f * (-f + 1.0) * 2.0 / omega]
        }
        Profile::Gradient => [u * -2.0 + 1.0, D::from(-2.0)],
        // What follows PAR polarity is a step or a band by now.
        Profile::Par { .. } => [D::from(0.0); 2],
        // Add new profiles of the model here too.
    }
}

/// The coefficients of a cell at u on a contour of length `length`, where its regulator is `carried`: φ and ∂φ/∂u.
///
/// # Panics
/// For a field or a profile of the model that is missing here.
pub fn coefficients<D: Number>(cell: &Cell, u: D, length: D, carried: Option<[D; 2]>) -> Coefficients<D> {
    let one = D::from(1.0);
    let [mut kappa, mut eta_b, mut eta_s, mut friction, mut xi_s, mut xi_b] = [one; 6];
    let (mut kappa_u, mut tension, mut tension_u) = (D::from(0.0), D::from(cell.material.tension), D::from(0.0));
    let painted = cell.cue.terms().iter();
    let painted = painted.map(|term| (term.field, profile(&term.profile, u, length).map(|f| f * term.amplitude)));
    let couplings =
        cell.cue.regulator().into_iter().flat_map(|regulator| &regulator.couplings).zip(carried.into_iter().cycle());
    let couplings = couplings.map(|(coupling, carried)| (coupling.field, acts(coupling, carried)));
    for (field, [f, f_u]) in painted.chain(couplings) {
        match field {
            Field::Kappa => (kappa, kappa_u) = (kappa + f, kappa_u + f_u),
            Field::Activity => (xi_s, xi_b) = (xi_s + f, xi_b + f),
            Field::XiS => xi_s += f,
            Field::XiB => xi_b += f,
            Field::EtaB => eta_b += f,
            Field::EtaS => eta_s += f,
            Field::Viscosity => (eta_b, eta_s) = (eta_b + f, eta_s + f),
            Field::Friction => friction += f,
            Field::Tension => (tension, tension_u) = (tension + f, tension_u + f_u),
        }
    }
    let material = &cell.material;
    let activity = material.gain * cell.xi_s;
    Coefficients {
        kappa: kappa * material.kappa,
        kappa_s: kappa_u * material.kappa / length,
        eta_b: eta_b * material.eta_b,
        eta_s: eta_s * material.eta_s,
        friction: friction * material.friction,
        tension,
        tension_s: tension_u / length,
        xi_s: xi_s * activity,
        xi_b: xi_b * (activity * material.xi_ratio),
        spontaneous: D::from(material.spontaneous_curvature),
        source: cell
            .cue
            .regulator()
            .and_then(|regulator| regulator.source)
            .map_or(D::from(0.0), |source| profile(&source.profile, u, length)[0] * source.amplitude),
    }
}

/// B φ, or B c²/(K² + c²), and its derivative by u.
fn acts<D: Number>(coupling: &Coupling, [phi, phi_u]: [D; 2]) -> [D; 2] {
    let Some(half) = coupling.half else { return [phi * coupling.strength, phi_u * coupling.strength] };
    // c²/(K² + c²) = 1/(1 + (K/c)²).
    let ratio = (phi + 1.0).recip() * half;
    let share = (ratio * ratio + 1.0).recip();
    let slope = share * share * ratio * ratio * 2.0 / (phi + 1.0);
    [share * coupling.strength, slope * phi_u * coupling.strength]
}

/// Half axes a (along z) and b of the shell: 4πab²/3 is the cell's volume over ε.
pub fn shell_axes(cell: &Cell) -> [f64; 2] {
    let b = (cell.r0.powi(3) / (cell.epsilon * cell.shell.aspect)).cbrt();
    [cell.shell.aspect * b, b]
}

/// ∂_rU and ∂_zU of the shell's potential U = P0 exp[(E − 1)/w²] at a point: E = z²/a² + r²/b² = ρ², times Σ c_l P_l(cosθ) in a
/// shell with a profile, in polar coordinates ρ, θ of the plane (z/a, r/b).
pub fn shell_gradient<D: Number>(cell: &Cell, r: D, z: D) -> [D; 2] {
    let ([a, b], w2) = (shell_axes(cell), cell.shell.w * cell.shell.w);
    let (along, across) = (z / a, r / b);
    let square = along * along + across * across;
    let series = cell.shell_profile.as_ref().map_or(&[1.0][..], |profile| profile.factor().series());
    let (rho, cos) = (square.sqrt(), along / square.sqrt());
    let sin = across / rho;
    // h, and sin²θ h′ by (1 − x²) P_l′ = l (P_{l−1} − x P_l).
    let (mut h, mut turned) = (D::from(0.0), D::from(0.0));
    let (mut before, mut here) = (D::from(0.0), D::from(1.0));
    for (l, c) in series.iter().enumerate() {
        h += here * *c;
        turned += (before - cos * here) * (l as f64 * c);
        let next = (cos * here * (2.0 * l as f64 + 1.0) - before * l as f64) / (l as f64 + 1.0);
        (before, here) = (here, next);
    }
    let potential = ((square * h - 1.0) / w2).exp() * (cell.shell.p0 / w2);
    let (outwards, around) = (rho * h * 2.0, -(rho * turned / sin));
    let by_across = sin * outwards + cos * around;
    let by_along = cos * outwards - sin * around;
    [potential * by_across / b, potential * by_along / a]
}

/// The outward normal force f_c = −n·∇U of the shell at a point (r, z) with tangent angle ψ.
pub fn shell_force<D: Number>(cell: &Cell, r: D, z: D, psi: D) -> D {
    let [by_r, by_z] = shell_gradient(cell, r, z);
    -(by_r * psi.sin() + by_z * psi.cos())
}
