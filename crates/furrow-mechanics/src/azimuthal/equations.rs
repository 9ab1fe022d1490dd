//! The linearised force balance of a perturbation with azimuthal number m.
//!
//! Numbers in brackets refer to `docs/book/src/theory/azimuthal.md`, which derives the equations.
//!
//! Every point of an axisymmetric shape is displaced along its normal by w cos mφ. The coordinate lines of the surface
//! stay orthogonal, with lengths A = 1 + c1 w and B = r(1 + c2 w) by ds and dφ. Quantities even in φ vary as cos mφ,
//! odd ones as sin mφ. The state is (M, a, w, β, Q, v1, τ, v2, χ): changes M of the bending moment and a = ∫ c1 w ds of
//! the arclength of a meridian, β = w_s, the shear Q, the tangential velocity (v1, v2), and the stresses τ and χ, T_ss
//! and T_sφ; with a regulator they are followed by (J, P), the changes of its gradient and of φ. With cot = cosψ/r, C =
//! c1 + c2, u the fraction of a meridian's arclength, and δX the change of a coefficient X(u, L, φ):
//!
//! * \[A.1 curvatures\] K = (M − (C − C0) δκ)/κ, k2 = m²w/r² − cot β − c2²w, k1 = K − k2, k12 = (m/r)(β − cot w)
//! * \[A.2 shape\] w_s = β, β_s = −c1²w − k1, a_s = c1 w
//! * \[A.3 lines\] δcot = c2(β − cot w): the geodesic curvature of the parallels
//! * \[A.4 strain rate\] S22 = (m/r)v2 + cot v1 + δcot v + c2 σw + k2 v_n,
//!   S11 = \[τ − η₋S22 − X_s(½K − k2) − X_b K − …\]/η₊, η± = η_b ± η_s
//! * \[A.5 stress\] τ2 = η₋S11 + η₊S22 − X_s(½K − k2) + X_b K + …, χ = 2η_s S12 + X_s k12
//! * \[A.6 flow\] v1_s = S11 + c1 w v_s − c1 σw − k1 v_n, v2_s = cot v2 + (m/r)(v1 − c1 v w) + 2S12 − 2k12 v_n
//! * \[A.7 shear\] M_s = Q + c1 w q, Q_s = −cot Q − δcot q + c1 w q_s + m²M/r² + δ\[γC + κC(2c1c2 − ½C²) + κC0(½C0C − 2c1c2)\] + k1 T + k2 T_φφ + c1 τ + c2 τ2 −
//!   δp − δf_c + Γ_n σw
//! * \[A.8 tangential\] τ_s = c1 w T_s − cot(τ − τ2) − δcot(T − T_φφ) − (m/r)χ + Γv1 + v δΓ − (C − C0) K κ_s − ½(C − C0)²δκ_s − δγ_s
//! * \[A.9 azimuthal\] χ_s = −2cot χ + (m/r)\[τ2 + c1 w(T_φφ − T) + ½(C − C0)²δκ + δγ\] + Γv2
//! * \[A.10 shell\] δf_c = β ∂_sU − w ∂_n²U, U the shell's potential
//! * \[A.11 regulator\] P_s = J + c1 w j, D(J_s + …) = σP + v1 j + v J + …

use super::base::Base;
use crate::cortex::equations::LocalCoefficients;

/// Change M of the bending moment.
pub(crate) const MOMENT: usize = 0;
/// Change a of a meridian's arclength from the pole.
pub const ARC: usize = 1;
/// Normal displacement w.
pub const W: usize = 2;
/// β = w_s.
pub const TILT: usize = 3;
/// Change Q of the transverse shear.
pub(crate) const SHEAR: usize = 4;
/// Change v1 of the meridional velocity.
pub const V1: usize = 5;
/// Change τ of T_ss.
pub(crate) const T11: usize = 6;
/// Azimuthal velocity v2.
pub const V2: usize = 7;
/// Stress χ = T_sφ.
pub(crate) const T12: usize = 8;
/// Number of components without a regulator.
pub const COMPONENTS: usize = 9;
/// Change J of the regulator's gradient along the meridian.
pub(crate) const GRADIENT: usize = 9;
/// Change P of the regulator.
pub const REGULATOR: usize = 10;
/// Number of components with a regulator.
pub const REGULATED: usize = 11;
/// Among the scalar unknowns: change of the length of a meridian.
pub const LENGTH: usize = 0;
/// Among the scalar unknowns: change of the pressure, 0 unless m = 0.
pub const PRESSURE: usize = 1;

/// Motion of the surface, the only contribution of growth to the equations.
#[derive(Clone, Copy, Debug, Default)]
pub struct Motion {
    /// Normal velocity σw.
    pub normal: f64,
    /// ∂_tP in the frame that moves along the normal, σP.
    pub regulator: f64,
}

/// Changes of curvature, A.1.
#[derive(Clone, Copy, Debug)]
struct Curvatures {
    mean: f64,
    k1: f64,
    k2: f64,
    k12: f64,
}

/// Changes of strain rate and stress, A.4 and A.5.
#[derive(Clone, Copy, Debug)]
struct Stresses {
    s11: f64,
    s22: f64,
    t22: f64,
    shear_rate: f64,
}

/// d/du of a perturbation `x` at one place: linear in `x`, `scalars` and `motion` together.
pub fn rates<const N: usize>(b: &Base, m: f64, x: &[f64; N], scalars: [f64; 2], motion: Motion) -> [f64; N] {
    let carried = if N == REGULATED { [x[GRADIENT], x[REGULATOR]] } else { [0.0; 2] };
    let varied = b.varied(x[ARC], scalars[LENGTH], carried);
    let (w, tilt, per_r) = (x[W], x[TILT], m / b.r);
    let k2 = per_r * per_r * w - b.cot * tilt - b.c2 * b.c2 * w;
    let mean = (x[MOMENT] - b.bent() * varied.kappa) / b.here.kappa;
    let k = Curvatures { mean, k1: mean - k2, k2, k12: per_r * (tilt - b.cot * w) };
    let stretch = b.c1 * w;
    let line = b.c2 * (tilt - b.cot * w);
    let s = stresses(b, per_r, x, &varied, &k, line, motion.normal);
    let mut out = [0.0; N];
    out[MOMENT] = x[SHEAR] + stretch * b.q;
    out[ARC] = stretch;
    out[W] = tilt;
    out[TILT] = -b.c1 * b.c1 * w - k.k1;
    out[SHEAR] = spread(b, per_r, [x[SHEAR], x[MOMENT]], [w, line], [b.q, b.q_s])
        + elastic(b, &varied, &k)
        + k.k1 * b.t
        + k.k2 * b.t_phi
        + b.c1 * x[T11]
        + b.c2 * s.t22
        - scalars[PRESSURE]
        - (tilt * b.push_along - w * b.push_outwards)
        + b.normal_friction * motion.normal;
    out[V1] = s.s11 + stretch * b.v_s - b.c1 * motion.normal - k.k1 * b.v_n;
    out[T11] = stretch * b.t_s - b.cot * (x[T11] - s.t22) - line * (b.t - b.t_phi) - per_r * x[T12]
        + b.here.friction * x[V1]
        + varied.friction * b.v
        - tangential_gradient(b, &varied, &k, scalars[LENGTH]);
    // No torque acts about the axis: rotation is left out for m = 0.
    if m != 0.0 {
        out[V2] = b.cot * x[V2] + per_r * (x[V1] - stretch * b.v) + s.shear_rate - 2.0 * k.k12 * b.v_n;
        let gradient = b.rigidity_gradient * 0.5 * b.bent() * b.bent() * varied.kappa + varied.tension;
        out[T12] =
            -2.0 * b.cot * x[T12] + per_r * (s.t22 + stretch * (b.t_phi - b.t) + gradient) + b.here.friction * x[V2];
    }
    if N == REGULATED {
        let [gradient, change] = carried;
        out[REGULATOR] = gradient + stretch * b.j;
        let supply = motion.regulator
            + x[V1] * b.j
            + b.v * gradient
            + b.dilution * (change * (b.s_u + b.s_phi) + (1.0 + b.phi) * (s.s11 + s.s22))
            + b.turnover * (change - varied.source);
        out[GRADIENT] = spread(b, per_r, carried, [w, line], [b.j, b.j_s]) + supply / b.diffusion;
    }
    out.map(|rate| rate * b.length)
}

/// The derivative along the meridian of the change of the meridional component g of ∇Φ if ΔΦ does not change, A.7:
/// `change` is (δg, δΦ), `base` is (g, ∂_s g) of the shape, and `line` is δcot.
fn spread(b: &Base, per_r: f64, change: [f64; 2], [w, line]: [f64; 2], base: [f64; 2]) -> f64 {
    -b.cot * change[0] - line * base[0] + b.c1 * w * base[1] + per_r * per_r * change[1]
}

/// Change of the normal force due to passive tension and bending, γC + κC(2C1C2 − ½C²) + κC0(½C0C − 2C1C2).
fn elastic(b: &Base, varied: &LocalCoefficients<f64>, k: &Curvatures) -> f64 {
    let (kappa, mean, gauss) = (b.here.kappa, b.mean, b.c1 * b.c2);
    let spontaneous = b.here.spontaneous;
    let by_mean = b.here.tension + kappa * (2.0 * gauss - 1.5 * mean * mean + 0.5 * spontaneous * spontaneous);
    let gauss_change = b.c1 * k.k2 + b.c2 * k.k1;
    by_mean * k.mean
        + 2.0 * kappa * b.bent() * gauss_change
        + mean * varied.tension
        + (mean * (2.0 * gauss - 0.5 * mean * mean) + spontaneous * (0.5 * spontaneous * mean - 2.0 * gauss))
            * varied.kappa
}

/// Change of ½(C − C0)²∂_sκ + ∂_sγ, with ∂_s by the arclength of the displaced meridian.
fn tangential_gradient(b: &Base, varied: &LocalCoefficients<f64>, k: &Curvatures, longer: f64) -> f64 {
    // κ_u/L with the changed length of the meridian.
    let along = |by_u: f64, change: f64| (change - by_u * longer / b.length) / b.length;
    let kappa = along(b.here.kappa_u, varied.kappa_u);
    let bent = b.bent();
    let rigidity = bent * k.mean * b.here.kappa_u / b.length + 0.5 * bent * bent * kappa;
    b.rigidity_gradient * rigidity + along(b.here.tension_u, varied.tension_u)
}

fn stresses<const N: usize>(
    b: &Base,
    per_r: f64,
    x: &[f64; N],
    varied: &LocalCoefficients<f64>,
    k: &Curvatures,
    line: f64,
    v_n: f64,
) -> Stresses {
    let LocalCoefficients { eta_sum, eta_difference, xi_s, xi_b, .. } = b.here;
    let s22 = per_r * x[V2] + b.cot * x[V1] + line * b.v + b.c2 * v_n + k.k2 * b.v_n;
    let deviator = xi_s * (0.5 * k.mean - k.k2) + varied.xi_s * (0.5 * b.mean - b.c2);
    let isotropic = xi_b * k.mean + varied.xi_b * b.mean;
    let thicker = [
        varied.eta_sum * b.s_u + varied.eta_difference * b.s_phi,
        varied.eta_difference * b.s_u + varied.eta_sum * b.s_phi,
    ];
    let s11 = (x[T11] - eta_difference * s22 - deviator - isotropic - thicker[0]) / eta_sum;
    let t22 = eta_difference * s11 + eta_sum * s22 - deviator + isotropic + thicker[1];
    // 2 S12 = 2 (χ − X_s k12)/(η₊ − η₋).
    let shear_rate = 2.0 * (x[T12] - xi_s * k.k12) / (eta_sum - eta_difference);
    Stresses { s11, s22, t22, shear_rate }
}
