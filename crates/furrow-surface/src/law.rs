//! The force balance of the cortex at a point of a general surface, generic over the number type.
//!
//! The surface is X(u, φ) with the outward normal n = X_u × X_φ/J, J = |X_u × X_φ|, the metric g_ij = ∂_iX·∂_jX and the
//! curvatures C_ij = −n·∂_i∂_jX, C = g^ij C_ij. For every test field W the virtual power vanishes:
//!
//! * \[S.1 virtual power\] ∫ [T^ij ∂_iX·∂_jW + Γ v_t·W + Γ_n v·n n·W − (p + f_c) n·W] dA + δ_W ∫ (½κ(C − C0)² + γ) dA = 0,
//! * \[S.2 stress\] T^ij = (η_b − η_s) S^k_k g^ij + 2η_s S^ij + X_s (C^ij − ½C g^ij) + X_b C g^ij,
//!   S_ij = ½(∂_iX·∂_jv + ∂_jX·∂_iv), X_s = gξ_s and X_b = gξ_b,
//! * \[S.3 energy\] δ_W ∫ (½κ(C − C0)² + γ) dA = ∫ {κ(C − C0) [−g^ij n·(∂_i∂_jW − Γ^k_ij ∂_kW) − 2C^ij ∂_iX·∂_jW] + (½κ(C − C0)² + γ) g^ij ∂_iX·∂_jW} dA
//!   with the Christoffel symbols Γ^k_ij, where κ and γ move with the material.
//!
//! v is the velocity of the material. The mesh has the same normal velocity, \[S.4 surface\] (∂_tX − v)·n = 0, and is distributed
//! along the surface by \[S.5 mesh\], the tangential part of ∂_u(a X_u) + b (X_φφ + X − (x₀, 0, z₀)) = c (x₀, 0, 0), where
//! (x₀, 0, z₀) is the centre of the ring: every meridian acts as a string under tension, and rings are drawn towards circles. Since
//! this would leave the poles free to move along the surface, the centres of the rings near them are drawn to the axis.

use crate::number::Number;
use crate::own::Own;
use furrow_cell::law::Algebra;
use furrow_cell::profile::Factor;
use furrow_mechanics::cortex::equations::{LocalCoefficients, ShellCoefficients};

/// A vector (x, y, z).
pub type Vector<D> = [D; 3];

/// Derivatives of the surface at a point, in the order X, X_u, X_φ, X_uu, X_uφ, X_φφ.
pub type Shape<D> = [Vector<D>; 6];

/// The velocity of the material at a point and its derivatives: v, v_u, v_φ.
pub type Flow<D> = [Vector<D>; 3];

/// The coefficients of W, W_u, W_φ, W_uu, W_uφ, W_φφ in the virtual power, per du dφ; and, at the end, the coefficient of a
/// test field of the mesh in S.4 and S.5, which is the same for all fields, since a normal field is a sum of many of them.
pub type Balance<D> = [Vector<D>; BALANCES];

/// Number of vectors in a [`Balance`].
pub const BALANCES: usize = 7;

/// All quantities at a point that do not depend on the unknowns.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// Coefficients of the equations, with the cue.
    pub local: LocalCoefficients<f64>,
    /// Constants of the shell.
    pub shell: ShellCoefficients<f64>,
    /// 1/x², 1/y², 1/z² for its half-axes.
    pub inverse_axes2: Vector<f64>,
    /// u and s on the mean meridian, if a user-defined law uses them.
    pub along: [f64; 2],
    /// Factor of the activity from the noise.
    pub noise: f64,
    /// Leading coefficient of the implicit step, about 1/Δt.
    pub rate: f64,
    /// Remaining part of the implicit step: ∂_tX = rate·X + past.
    pub past: Vector<f64>,
    /// a, ∂_ua, b and c of the mesh.
    pub mesh: [f64; 4],
    /// Drag of the mesh, in τ/L_h².
    pub drag: f64,
    /// The wall that this point may touch.
    pub contact: Contact,
}

/// The repulsion of the wall opposite to a point, S.6: the pressure f exp((2n·(X − X₀) − d)/λ), since the wall at distance d from X₀
/// moves by the same distance as the point.
#[derive(Clone, Copy, Debug, Default)]
pub struct Contact {
    /// Pressure at distance 0; 0 without a wall.
    pub pressure: f64,
    /// 1/λ.
    pub decay: f64,
    /// Point at which the distance was measured.
    pub origin: Vector<f64>,
    /// Normal along which it was measured.
    pub normal: Vector<f64>,
    /// The distance.
    pub distance: f64,
}

#[inline(always)]
fn dot<D: Number>(a: &Vector<D>, b: &Vector<D>) -> D {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn cross<D: Number>(a: &Vector<D>, b: &Vector<D>) -> Vector<D> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Adds s·a to `to`.
#[inline(always)]
fn add<D: Number>(to: &mut Vector<D>, s: D, a: &Vector<D>) {
    for (to, a) in to.iter_mut().zip(a) {
        *to += s * *a;
    }
}

/// A symmetric tensor by its components uu, uφ, φφ.
pub type Symmetric<D> = [D; 3];

/// a·s + b·t.
#[inline(always)]
pub(crate) fn mix<D: Number>(a: Symmetric<D>, b: Symmetric<D>, s: D, t: D) -> Symmetric<D> {
    [a[0] * s + b[0] * t, a[1] * s + b[1] * t, a[2] * s + b[2] * t]
}

/// The trace a^ij b_ij.
#[inline(always)]
fn trace<D: Number>(a: &Symmetric<D>, b: &Symmetric<D>) -> D {
    a[0] * b[0] + a[2] * b[2] + a[1] * b[1] * 2.0
}

/// g^ik g^jl a_kl.
#[inline(always)]
pub(crate) fn raise<D: Number>(g: &Symmetric<D>, a: &Symmetric<D>) -> Symmetric<D> {
    let [g_uu, g_up, g_pp] = *g;
    let [uu, up, pp] = *a;
    // a^i_l with the first index raised.
    let (u_u, u_p) = (g_uu * uu + g_up * up, g_uu * up + g_up * pp);
    let (p_u, p_p) = (g_up * uu + g_pp * up, g_up * up + g_pp * pp);
    [u_u * g_uu + u_p * g_up, u_u * g_up + u_p * g_pp, p_u * g_up + p_p * g_pp]
}

/// The geometry of the surface at a point.
#[derive(Clone, Copy, Debug)]
pub struct Geometry<D> {
    /// Area per du dφ.
    pub area: D,
    /// Outward normal.
    pub normal: Vector<D>,
    /// g^ij.
    pub inverse_metric: Symmetric<D>,
    /// C_ij.
    pub curvature: Symmetric<D>,
    /// C.
    pub mean: D,
}

impl<D: Number> Geometry<D> {
    /// The geometry of a surface with these derivatives.
    #[inline(always)]
    pub fn new(x: &Shape<D>) -> Geometry<D> {
        let across = cross(&x[1], &x[2]);
        let area = dot(&across, &across).sqrt();
        let normal = [across[0] / area, across[1] / area, across[2] / area];
        let over = (area * area).recip();
        let inverse_metric = [dot(&x[2], &x[2]) * over, -dot(&x[1], &x[2]) * over, dot(&x[1], &x[1]) * over];
        let curvature = [-dot(&normal, &x[3]), -dot(&normal, &x[4]), -dot(&normal, &x[5])];
        let mean = trace(&inverse_metric, &curvature);
        Geometry { area, normal, inverse_metric, curvature, mean }
    }

    /// Γ^k_ij for each k.
    #[inline(always)]
    fn christoffel(&self, x: &Shape<D>) -> [Symmetric<D>; 2] {
        let g = &self.inverse_metric;
        let u = [dot(&x[1], &x[3]), dot(&x[1], &x[4]), dot(&x[1], &x[5])];
        let p = [dot(&x[2], &x[3]), dot(&x[2], &x[4]), dot(&x[2], &x[5])];
        [mix(u, p, g[0], g[1]), mix(u, p, g[1], g[2])]
    }
}

/// The active part of T^ij, S.2.
#[inline(always)]
pub fn active_stress<D: Number>(place: &Place, geometry: &Geometry<D>) -> Symmetric<D> {
    let Geometry { inverse_metric: g, curvature, mean, .. } = geometry;
    let (xi_s, xi_b) = (place.local.xi_s * place.noise, place.local.xi_b * place.noise);
    mix(raise(g, curvature), *g, D::from(xi_s), *mean * (xi_b - 0.5 * xi_s))
}

/// The viscous part of T^ij, S.2, which is linear in the flow.
#[inline(always)]
pub fn viscous_stress<D: Number>(place: &Place, geometry: &Geometry<D>, x: &Shape<D>, v: &Flow<D>) -> Symmetric<D> {
    let (g, local) = (&geometry.inverse_metric, &place.local);
    let strain = [dot(&x[1], &v[1]), (dot(&x[1], &v[2]) + dot(&x[2], &v[1])) * 0.5, dot(&x[2], &v[2])];
    // (η_b + η_s) − (η_b − η_s) = 2η_s.
    let shear = local.eta_sum - local.eta_difference;
    mix(raise(g, &strain), *g, D::from(shear), trace(g, &strain) * local.eta_difference)
}

/// The normal force f_c of the shell (M.9 with the half-axes of S.7, or M.31 of its profile) and of a wall in contact with the point.
#[inline(always)]
pub fn wall_force<D: Number + Algebra>(
    place: &Place,
    normal: &Vector<D>,
    x: &Vector<D>,
    profile: Option<&Factor>,
) -> D {
    let ShellCoefficients { shell_force, inverse_w2, .. } = place.shell;
    let (level, slope) = match profile {
        Some(profile) => profile.level(*x, place.inverse_axes2.map(D::from)),
        None => {
            let scaled: Vector<D> = std::array::from_fn(|k| x[k] * place.inverse_axes2[k]);
            (dot(&scaled, x), scaled)
        }
    };
    let reach = ((level - 1.0) * inverse_w2).exp();
    let shell = -(reach * dot(&slope, normal)) * shell_force;
    let Contact { pressure, decay, origin, normal, distance } = place.contact;
    if pressure == 0.0 {
        return shell;
    }
    let moved = (0..3).fold(D::from(-distance), |sum, k| sum + (x[k] - origin[k]) * (2.0 * normal[k]));
    shell - (moved * decay).exp() * pressure
}

/// Adds a tension T^ij to a balance, per du dφ.
#[inline(always)]
fn add_tension<D: Number>(out: &mut Balance<D>, tension: &Symmetric<D>, x: &Shape<D>) {
    for (k, [along_u, along_p]) in [[0, 1], [1, 2]].into_iter().enumerate() {
        add(&mut out[1 + k], tension[along_u], &x[1]);
        add(&mut out[1 + k], tension[along_p], &x[2]);
    }
}

/// The balance at a point: see [`Balance`]. `centre` is x₀ and z₀ of the ring's centre, `own` is a user-defined law instead of S.2,
/// and the profile of the shell.
#[inline(always)]
pub fn balance<D: Number + Algebra>(
    place: &Place,
    x: &Shape<D>,
    v: &Flow<D>,
    pressure: D,
    centre: [D; 2],
    own: Option<&mut Own<D>>,
) -> Balance<D> {
    let geometry = Geometry::new(x);
    let Geometry { area, normal, inverse_metric: g, curvature, mean } = &geometry;
    let local = &place.local;
    let mut out = by_flow(place, &geometry, x, v);
    let bent = *mean - local.spontaneous;
    let mut moment = bent * local.kappa;
    let energy = moment * bent * 0.5 + local.tension;
    let profile = own.as_deref().and_then(Own::profile);
    let mut force = wall_force(place, normal, &x[0], profile);
    let active = match own.and_then(|own| own.at(place, &geometry, &x[0])) {
        None => active_stress(place, &geometry),
        Some(own) => {
            moment += own.moment;
            force += own.normal_force;
            own.stress
        }
    };
    // Tension along the surface: active tension and the contribution of the bending energy.
    let elastic = mix(*g, raise(g, curvature), energy, moment * -2.0);
    add_tension(&mut out, &mix(active, elastic, *area, *area), x);
    let bending = moment * *area;
    for (k, christoffel) in geometry.christoffel(x).iter().enumerate() {
        add(&mut out[1 + k], trace(g, christoffel) * bending, normal);
    }
    for (ij, factor) in [1.0, 2.0, 1.0].into_iter().enumerate() {
        add(&mut out[3 + ij], -bending * g[ij] * factor, normal);
    }
    add(&mut out[0], -*area * (pressure + force), normal);
    if !place.shell.rigidity_gradient {
        // The paper's formulation lacks ½(C − C0)²∇κ, which follows from the energy.
        let slope = bent * bent * *area * (0.5 * local.kappa_u);
        add(&mut out[0], slope * g[0], &x[1]);
        add(&mut out[0], slope * g[1], &x[2]);
    }
    let motion: Vector<D> = std::array::from_fn(|k| (x[0][k] * place.rate + place.past[k]) * *area);
    add(&mut out[6], D::from(1.0), &mesh_balance(place, normal, x, &motion, centre));
    out
}

/// The part of the balance that is linear in the flow: viscous stress, friction, and the normal velocity of S.4.
#[inline(always)]
pub fn by_flow<D: Number>(place: &Place, geometry: &Geometry<D>, x: &Shape<D>, v: &Flow<D>) -> Balance<D> {
    let Geometry { area, normal, .. } = geometry;
    let mut out = [[D::from(0.0); 3]; BALANCES];
    let stress = viscous_stress(place, geometry, x, v);
    add_tension(&mut out, &[stress[0] * *area, stress[1] * *area, stress[2] * *area], x);
    let v_n = dot(&v[0], normal) * *area;
    add(&mut out[0], *area * place.local.friction, &v[0]);
    add(&mut out[0], v_n * (place.shell.normal_friction - place.local.friction), normal);
    add(&mut out[6], -v_n, normal);
    out
}

/// The coefficient of the pressure in the balance.
pub fn by_pressure(geometry: &Geometry<f64>) -> Balance<f64> {
    let mut out = [[0.0; 3]; BALANCES];
    add(&mut out[0], -geometry.area, &geometry.normal);
    out
}

/// The coefficients of x₀ and z₀ of the ring's centre in the balance of the mesh.
pub fn by_centre(place: &Place, geometry: &Geometry<f64>) -> [Vector<f64>; 2] {
    let [.., b, c] = place.mesh;
    [(0, b + c), (2, b)].map(|(axis, weight)| {
        let along = -weight * geometry.normal[axis];
        let mut out = geometry.normal.map(|n| along * n);
        out[axis] += weight;
        out
    })
}

/// The normal part is S.4 without the flow, with `motion` = J ∂_tX; the tangential part is S.5.
#[inline(always)]
fn mesh_balance<D: Number>(
    place: &Place,
    normal: &Vector<D>,
    x: &Shape<D>,
    motion: &Vector<D>,
    centre: [D; 2],
) -> Vector<D> {
    let [a, a_u, b, c] = place.mesh;
    let mut spread = [centre[0] * -(b + c), D::from(0.0), centre[1] * -b];
    add(&mut spread, D::from(b), &x[0]);
    add(&mut spread, D::from(a), &x[3]);
    add(&mut spread, D::from(a_u), &x[1]);
    add(&mut spread, D::from(b), &x[5]);
    add(&mut spread, D::from(-place.drag), motion);
    let along = dot(motion, normal) + dot(&spread, normal);
    [along * normal[0] - spread[0], along * normal[1] - spread[1], along * normal[2] - spread[2]]
}
