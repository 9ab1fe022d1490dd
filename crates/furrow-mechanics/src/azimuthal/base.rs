//! An axisymmetric shape at one place, with the quantities that the linearised equations need.

use num_dual::Dual64;

use crate::cortex::Cortex;
use crate::cortex::equations::{
    BdfTerm, COMPONENTS, Constants, J, LENGTH, LocalCoefficients, PHI, PRESSURE, PSI, Q, R, T, Transport, V, Z, carried,
};
use crate::cortex::own::Spot;
use crate::cortex::own::shell::{Balances, force};

/// The shape at one place; the names follow the equations.
#[derive(Clone, Debug)]
pub struct Base {
    /// Length L of the contour.
    pub length: f64,
    /// Distance r from the axis.
    pub r: f64,
    /// cosψ/r.
    pub cot: f64,
    /// Meridional curvature.
    pub c1: f64,
    /// Azimuthal curvature.
    pub c2: f64,
    /// C = c1 + c2.
    pub mean: f64,
    /// Shear q.
    pub q: f64,
    /// q_s.
    pub q_s: f64,
    /// Tangential velocity v.
    pub v: f64,
    /// v_s.
    pub v_s: f64,
    /// T_uu.
    pub t: f64,
    /// ∂_sT_uu.
    pub t_s: f64,
    /// T_φφ.
    pub t_phi: f64,
    /// S_uu.
    pub s_u: f64,
    /// S_φφ.
    pub s_phi: f64,
    /// Normal velocity, 0 at rest.
    pub v_n: f64,
    /// Coefficients.
    pub here: LocalCoefficients<f64>,
    /// 1 if the term ½(C − C0)²∂_sκ is kept, else 0.
    pub rigidity_gradient: f64,
    /// e_s·∇U of the shell's potential U.
    pub push_along: f64,
    /// n·∇∇U·n.
    pub push_outwards: f64,
    /// Normal friction Γ_n.
    pub normal_friction: f64,
    /// Gradient j of the regulator.
    pub j: f64,
    /// j_s.
    pub j_s: f64,
    /// The regulator φ.
    pub phi: f64,
    /// Its turnover k.
    pub turnover: f64,
    /// Its diffusion D.
    pub diffusion: f64,
    /// 1 if flow dilutes it, else 0.
    pub dilution: f64,
    /// The place u.
    u: f64,
    /// Derivatives of the coefficients by the place u, by L, by φ, and by ∂_uφ.
    by: [LocalCoefficients<f64>; 4],
}

/// The constants of a cell, with and without derivatives by the length of the contour.
#[derive(Clone, Debug)]
pub(crate) struct BaseConstants<'a> {
    constants: &'a Constants<f64>,
    along_length: Constants<Dual64>,
}

impl<'a> BaseConstants<'a> {
    /// The constants of the cell of `cortex`.
    pub fn of(cortex: &'a Cortex) -> BaseConstants<'a> {
        BaseConstants {
            constants: cortex.constants(),
            along_length: Constants::new(&cortex.cell, |_, value| Dual64::from_re(value)),
        }
    }

    /// The shape at u in the state `y` with `scalars` (L, p); the contour moves by `motion`.
    pub fn at(&self, u: f64, y: &[f64], scalars: &[f64], motion: BdfTerm) -> Base {
        let (c, length) = (self.constants, scalars[LENGTH]);
        let shape: [f64; COMPONENTS] = std::array::from_fn(|k| y[k]);
        let here = c.of_state(u, y, length);
        let spot = Spot { u, carried: [0.0; 2], noise: 1.0 };
        let mut balances = Balances::of(None, c.shell_factor.as_ref(), 0);
        let found = balances.at(&c.shell, &here, &spot, motion, &shape, length, scalars[PRESSURE]);
        let place = found.place;
        let mut base = Base {
            length,
            r: y[R],
            cot: place.cot,
            c1: place.c1,
            c2: place.c2,
            mean: place.mean,
            q: y[Q],
            q_s: found.f[Q] / length,
            v: y[V],
            v_s: found.f[V] / length,
            t: y[T],
            t_s: found.f[T] / length,
            t_phi: place.t_phi,
            s_u: place.s_u,
            s_phi: place.s_phi,
            v_n: place.v_n,
            here,
            rigidity_gradient: if c.shell.rigidity_gradient { 1.0 } else { 0.0 },
            push_along: 0.0,
            push_outwards: 0.0,
            normal_friction: c.shell.normal_friction,
            j: 0.0,
            j_s: 0.0,
            phi: 0.0,
            turnover: 0.0,
            diffusion: 1.0,
            dilution: 0.0,
            u,
            by: self.slopes(u, y, length),
        };
        (base.push_along, base.push_outwards) = self.shell(y);
        if let Some(regulator) = c.regulator.as_ref().filter(|_| y.len() > COMPONENTS) {
            let transport = Transport::of(regulator);
            base.j_s = carried(&transport, here.source, motion, &shape, [y[J], y[PHI]], &place, length);
            (base.j, base.phi) = (y[J], y[PHI]);
            (base.turnover, base.diffusion) = (regulator.turnover, regulator.diffusion);
            base.dilution = transport.dilution;
        }
        base
    }

    /// e_s·∇U and n·∇∇U·n of U = P0 exp\[(z²/a² + r²/b² − 1)/w²\], A.10, or of the U of a shell's profile, M.30.
    fn shell(&self, y: &[f64]) -> (f64, f64) {
        let shell = &self.constants.shell;
        let (sin, cos) = y[PSI].sin_cos();
        if let Some(factor) = &self.constants.shell_factor {
            let ([r, z], lifted) =
                ([(y[R], sin), (y[Z], cos)].map(|(x, by)| Dual64::new(x, by)), shell.map(Dual64::from));
            let outwards = force(factor, &lifted, [r, z], [sin, cos].map(Dual64::from));
            return (-force(factor, shell, [y[R], y[Z]], [cos, -sin]), -outwards.eps);
        }
        let (by_r, by_z) = (y[R] * shell.inverse_b2, y[Z] * shell.inverse_a2);
        let inside = (y[Z] * by_z + y[R] * by_r - 1.0) * shell.inverse_w2;
        let force = shell.shell_force * inside.exp();
        let (along, outwards) = (by_r * cos - by_z * sin, by_r * sin + by_z * cos);
        let bend = sin * sin * shell.inverse_b2 + cos * cos * shell.inverse_a2;
        (force * along, force * (bend + 2.0 * shell.inverse_w2 * outwards * outwards))
    }

    /// Derivatives of the coefficients by u, L, φ and ∂_uφ.
    fn slopes(&self, u: f64, y: &[f64], length: f64) -> [LocalCoefficients<f64>; 4] {
        let c = self.constants;
        let by_u = if c.vary() { c.slope(u, length) } else { c.uniform.map(|_| 0.0) };
        let mut by_length = c.uniform.map(|_| 0.0);
        if c.vary() {
            by_length = self.along_length.at(u, Dual64::new(length, 1.0)).map(|value| value.eps);
        }
        let nothing = c.uniform.map(|_| 0.0);
        let (mut by_phi, mut by_phi_u) = (nothing, nothing);
        if y.len() > COMPONENTS {
            by_phi = c.regulated_by_phi(nothing, y[PHI], y[J] * length).1;
            let unit = c.regulated(nothing, y[PHI], 1.0);
            (by_phi_u.kappa_u, by_phi_u.tension_u) = (unit.kappa_u, unit.tension_u);
        }
        [by_u, by_length, by_phi, by_phi_u]
    }
}

impl Base {
    /// C − C0.
    pub fn bent(&self) -> f64 {
        self.mean - self.here.spontaneous
    }

    /// Changes of the coefficients if a point of the surface lies further along its meridian by `arc`, the meridian is
    /// longer by `longer`, and (j, φ) of a regulator change by `carried`.
    pub fn varied(&self, arc: f64, longer: f64, [gradient, change]: [f64; 2]) -> LocalCoefficients<f64> {
        let by_u = (arc - self.u * longer) / self.length;
        let by_phi_u = gradient * self.length + self.j * longer;
        let mut out = self.here.map(|_| 0.0);
        for (factor, slope) in [by_u, longer, change, by_phi_u].into_iter().zip(&self.by) {
            out.add(factor, slope);
        }
        out
    }
}
