//! The force balance of the cortex, stated once for any number type.
//!
//! Numbers in brackets refer to the book (`docs/book`), here and wherever comments cite an equation.
//!
//! State on u ∈ [0, 1] (or the mirror-symmetric half [0, ½]): y = (r, z, m, ψ, q, v, T) with arclength s = L u; the first
//! three are quadrature components, see [`Dimensions::quadratures`](furrow_bvp::Dimensions::quadratures). The eighth equation of
//! the model, V′ = πr² sinψ \[M.11 volume\], is a quadrature and enters as the integral condition V(1) = 4πR0³/3. Scalar unknowns are
//! (L, p) and any free parameters after them.
//!
//! With c2 = sinψ/r and C = c1 + c2 \[M.2 curvatures\], where m = κ(C − C0) \[M.3 bending\] gives C = m/κ + C0 and c1 = C − c2, with
//! X_s = gξ_s and X_b = gξ_b, and all coefficients taken at u:
//!
//! * \[M.1 geometry\] r_s = cosψ, z_s = −sinψ, ψ_s = c1, m_s = q
//! * \[M.4 strain rate\] S_φφ = (cosψ/r) v + c2 v_n, S_uu = (T − X_s(½C − c2) − X_b C − (η_b − η_s)S_φφ)/(η_b + η_s)
//! * \[M.5 stress\] T_φφ = (η_b − η_s)S_uu + (η_b + η_s)S_φφ − X_s(½C − c2) + X_b C
//! * \[M.6 normal\] q_s = −(cosψ/r) q + c1 T + c2 T_φφ + γC − ½κ(c1 − c2)²C + κC0(½C0C − 2c1c2) − p − f_c + Γ_n v_n
//! * \[M.7 tangential\] T_s = −(cosψ/r)(T − T_φφ) + Γv − ½(C − C0)²κ_s − γ_s
//! * \[M.8 flow\] v_s = S_uu − c1 v_n, v_n = sinψ ∂_t r + cosψ ∂_t z
//! * \[M.9 shell\] f_c = −(2P0/w²) exp\[(z²/a² + r²/b² − 1)/w²\] (r sinψ/b² + z cosψ/a²)
//!
//! The elastic part of M.6 is c1 t_uu + c2 t_φφ with t^ij = \[γ + ½κ(C − C0)²\]g^ij − κ(C − C0)C^ij.
//!
//! A regulator that the flow carries brings two more components, its gradient j = ∂_sφ and φ = c − 1, c its areal concentration
//! relative to the resting one, and modulates fields of the cortex, X = X0(1 + B φ):
//!
//! * \[M.26 regulator\] φ_s = j, j_s = −(cosψ/r) j + [∂_tφ + (v − w) j + (1 + φ)(S_uu + S_φφ) + k(φ − A f)]/D,
//!   w = cosψ ∂_t r − sinψ ∂_t z the tangential velocity of a place of fixed u; a label of the material lacks the term of S.
//!
//! A step keeps the amount ∫ c dA: with r L the area of a place by 2π du, and E = cosψ ∂_s∂_t r − sinψ ∂_s∂_t z its stretching along
//! the contour,
//!
//! * \[N.18 amount\] ∂_tφ + (v − w) j + (1 + φ)(S_uu + S_φφ) = ∂_t(r L c)/(r L) + (v − w) j + c [S_uu + (cosψ/r)(v − w) − E],
//!
//! where the last terms are the divergence of the flux r c (v − w), which vanishes at the poles.

use std::f64::consts::PI;

pub use super::coefficients::LocalCoefficients;
use super::lanes::{Arithmetic, sin_cos};
use super::own;
use furrow_cell::cue::{Field, Regulator, Source, Term};
use furrow_cell::law::LawValues;
use furrow_cell::profile::Factor;
use furrow_cell::{Cell, Number, Parameter, RigidityGradient};

/// Radius r.
pub const R: usize = 0;
/// Axial position z.
pub const Z: usize = 1;
/// Bending moment m = κ(C − C0).
pub const M: usize = 2;
/// Tangent angle ψ.
pub const PSI: usize = 3;
/// Transverse shear q.
pub const Q: usize = 4;
/// Tangential velocity v.
pub const V: usize = 5;
/// Meridional dissipative tension T_uu.
pub const T: usize = 6;
/// Number of components of a cell without a regulator.
pub const COMPONENTS: usize = 7;
/// Gradient j = ∂_sφ of the regulator, if there is one.
pub const J: usize = 7;
/// The regulator φ.
pub const PHI: usize = 8;
/// Number of components of a cell with a regulator.
pub const REGULATED: usize = 9;
/// Index of L among the scalar unknowns.
pub const LENGTH: usize = 0;
/// Index of p among the scalar unknowns.
pub const PRESSURE: usize = 1;

/// The part of the contour that is solved for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Domain {
    /// u ∈ [0, 1], pole to pole.
    Full,
    /// u ∈ [0, ½] of a mirror-symmetric shape; L and V still refer to the whole cell.
    Half,
}

impl Domain {
    /// Right end of the mesh, which is also its share of the whole contour.
    pub fn end(self) -> f64 {
        if self == Domain::Full { 1.0 } else { 0.5 }
    }

    /// The part that suffices for a cell: half of the contour for a mirror-symmetric cell and shape.
    pub fn of(cell: &Cell) -> Domain {
        if cell.is_mirror_symmetric() { Domain::Half } else { Domain::Full }
    }
}

/// The rates of change that enter the equations at one point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BdfTerm<D = f64> {
    /// 1/Δt of the implicit step (0 for a stationary shape).
    pub rate: D,
    /// Past r: ∂_t r = rate · (r − r_past).
    pub r_past: D,
    /// Past z.
    pub z_past: D,
    /// Past of a regulator.
    pub carried_past: Carried<D>,
}

/// The quantities that define the past of a regulator.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Carried<D = f64> {
    /// r L (1 + φ), or φ of a label of the material.
    pub amount: D,
    /// ∂r/∂u.
    pub r_u: D,
    /// ∂z/∂u.
    pub z_u: D,
}

impl Carried {
    /// The past of a state on a contour of length `length`.
    pub fn of(y: &[f64], length: f64, diluted: bool) -> Carried {
        let (sin, cos) = sin_cos(y[PSI]);
        let amount = if diluted { y[R] * length * (1.0 + y[PHI]) } else { y[PHI] };
        Carried { amount, r_u: length * cos, z_u: -(length * sin) }
    }

    /// Its parts, for linear combinations.
    pub fn parts(self) -> [f64; 3] {
        [self.amount, self.r_u, self.z_u]
    }
}

impl From<[f64; 3]> for Carried {
    fn from([amount, r_u, z_u]: [f64; 3]) -> Carried {
        Carried { amount, r_u, z_u }
    }
}

impl<D> Carried<D> {
    /// The same with numbers of another kind.
    #[inline(always)]
    pub fn map<E>(self, number: impl Fn(D) -> E) -> Carried<E> {
        Carried { amount: number(self.amount), r_u: number(self.r_u), z_u: number(self.z_u) }
    }
}

impl<D> BdfTerm<D> {
    /// The same with numbers of another kind.
    #[inline(always)]
    pub fn map<E>(self, number: impl Fn(D) -> E) -> BdfTerm<E> {
        let BdfTerm { rate, r_past, z_past, carried_past } = self;
        let carried_past = carried_past.map(&number);
        BdfTerm { rate: number(rate), r_past: number(r_past), z_past: number(z_past), carried_past }
    }
}

/// The surroundings: coefficients that are uniform along the contour.
#[derive(Clone, Copy, Debug)]
pub struct ShellCoefficients<D> {
    /// 1/a² of the shell.
    pub inverse_a2: D,
    /// 1/b² of the shell.
    pub inverse_b2: D,
    /// 2P0/w².
    pub shell_force: D,
    /// 1/w².
    pub inverse_w2: D,
    /// Normal friction Γ_n.
    pub normal_friction: D,
    /// Whether the term ½(C − C0)²∂_sκ is kept.
    pub rigidity_gradient: bool,
}

impl<D> ShellCoefficients<D> {
    /// The same with numbers of another kind.
    #[inline(always)]
    pub fn map<E>(self, number: impl Fn(D) -> E) -> ShellCoefficients<E> {
        ShellCoefficients {
            inverse_a2: number(self.inverse_a2),
            inverse_b2: number(self.inverse_b2),
            shell_force: number(self.shell_force),
            inverse_w2: number(self.inverse_w2),
            normal_friction: number(self.normal_friction),
            rigidity_gradient: self.rigidity_gradient,
        }
    }
}

/// The constants of one cell, ready for evaluation; generic so that their derivatives can be carried along.
#[derive(Clone, Debug)]
pub struct Constants<D> {
    /// Coefficients without the cue.
    pub uniform: LocalCoefficients<D>,
    /// The cue's terms.
    pub cue: Vec<Term<D>>,
    /// The regulator that the flow carries.
    pub regulator: Option<Regulator<D>>,
    /// The shell, and the choice of terms in the equations.
    pub shell: ShellCoefficients<D>,
    /// The law of active stress, unless it is the equations' own.
    pub law: Option<LawValues<D>>,
    /// The departure of the shell from its ellipsoid, unless it is the ellipsoid.
    pub shell_factor: Option<Factor>,
    /// Volume of the whole cell, 4πR0³/3.
    pub volume: D,
}

impl<D: Number> Constants<D> {
    /// Constants of a cell, with the half axes of its shell by M.10; `vary` may replace any named parameter by a number
    /// that carries derivatives.
    pub fn new(cell: &Cell, vary: impl Fn(Parameter, f64) -> D) -> Constants<D> {
        let Cell { material, shell, .. } = cell;
        let (r0, epsilon) = (vary(Parameter::R0, cell.r0), vary(Parameter::Epsilon, cell.epsilon));
        let (aspect, w) = (vary(Parameter::Aspect, shell.aspect), vary(Parameter::W, shell.w));
        let b3 = r0.powi(3) / (epsilon * aspect);
        let b2 = b3.powf(2.0 / 3.0);
        let inverse_w2 = w.powi(-2);
        let (eta_b, eta_s) = (vary(Parameter::EtaB, material.eta_b), vary(Parameter::EtaS, material.eta_s));
        let xi_s = vary(Parameter::Gain, material.gain) * vary(Parameter::XiS, cell.xi_s);
        let term = |(term, of): (usize, &Term)| of.map(|quantity, v| vary(Parameter::Cue { term, quantity }, v));
        Constants {
            uniform: LocalCoefficients {
                kappa: vary(Parameter::Kappa, material.kappa),
                kappa_u: D::from(0.0),
                eta_sum: eta_b + eta_s,
                eta_difference: eta_b - eta_s,
                friction: vary(Parameter::Friction, material.friction),
                tension: vary(Parameter::Tension, material.tension),
                tension_u: D::from(0.0),
                xi_s,
                xi_b: xi_s * vary(Parameter::XiRatio, material.xi_ratio),
                source: D::from(0.0),
                spontaneous: vary(Parameter::SpontaneousCurvature, material.spontaneous_curvature),
            },
            regulator: (cell.cue.regulator())
                .map(|regulator| regulator.map(|quantity, v| vary(Parameter::Regulator(quantity), v))),
            cue: cell.cue.terms().iter().enumerate().map(term).collect(),
            shell: ShellCoefficients {
                inverse_a2: (b2 * aspect.powi(2)).recip(),
                inverse_b2: b2.recip(),
                shell_force: vary(Parameter::P0, shell.p0) * inverse_w2 * 2.0,
                inverse_w2,
                normal_friction: vary(Parameter::NormalFriction, material.normal_friction),
                rigidity_gradient: cell.material.rigidity_gradient == RigidityGradient::Full,
            },
            law: cell.law.as_ref().map(|law| LawValues::new(law, cell, &vary)),
            shell_factor: cell.shell_profile.as_ref().map(|profile| profile.factor().clone()),
            volume: r0.powi(3) * (4.0 * PI / 3.0),
        }
    }

    /// ∂²κ/∂u² at u on a contour of length `length`.
    pub(crate) fn rigidity_curvature(&self, u: f64, length: D) -> D {
        let kappa = self.cue.iter().filter(|term| term.field == Field::Kappa);
        kappa.fold(D::from(0.0), |sum, term| sum + self.uniform.kappa * term.at(u, length)[2])
    }

    /// The source of the regulator.
    pub fn source(&self) -> Option<Source<D>> {
        self.regulator.as_ref()?.source
    }

    /// A f and A ∂f/∂u for the cue's terms at u on a contour of length `length`, followed by the regulator's source.
    #[inline]
    pub fn profiles(&self, u: f64, length: D) -> impl Iterator<Item = [D; 2]> {
        let source = self.source().map(|source| source.profile.at(u, length).map(|f| f * source.amplitude));
        self.cue.iter().map(move |term| term.at(u, length)).chain(source).map(|[f, f_u, _]| [f, f_u])
    }

    /// The coefficients at a place with these [`profiles`](Self::profiles).
    #[inline]
    pub fn painted(&self, profiles: impl Iterator<Item = [D; 2]>) -> LocalCoefficients<D> {
        let mut local = self.uniform;
        profiles.enumerate().for_each(|(k, [f, f_u])| match self.cue.get(k) {
            Some(term) => local.modulate(term.field, &self.uniform, f, f_u),
            None => local.source = f,
        });
        local
    }

    /// The coefficients at u on a contour of length `length`.
    #[inline]
    pub fn at(&self, u: f64, length: D) -> LocalCoefficients<D> {
        if self.vary() { self.painted(self.profiles(u, length)) } else { self.uniform }
    }

    /// The coefficients at u and the angle `phi` about the axis, in radians; their slopes are left out.
    pub fn beside(&self, u: f64, phi: f64, length: D) -> LocalCoefficients<D> {
        let mut local = self.uniform;
        for term in &self.cue {
            local.modulate(term.field, &self.uniform, term.beside(u, phi, length), D::from(0.0));
        }
        local
    }

    /// Whether a term is at one side of the axis.
    pub fn is_one_sided(&self) -> bool {
        self.cue.iter().any(|term| term.side.is_some())
    }

    /// Whether the coefficients vary along the contour.
    pub fn vary(&self) -> bool {
        !self.cue.is_empty() || self.source().is_some()
    }

    /// The coefficients at a place with the contribution of the regulator, M.27: `phi` is φ and `phi_u` is L j.
    pub fn regulated(&self, mut here: LocalCoefficients<D>, phi: D, phi_u: D) -> LocalCoefficients<D> {
        for coupling in self.regulator.iter().flat_map(|regulator| &regulator.couplings) {
            let [h, slope, _] = coupling.at(phi);
            here.modulate(coupling.field, &self.uniform, h, slope * phi_u);
        }
        here
    }

    /// The coefficients at u in the state `y`, including the contribution of the regulator.
    #[inline]
    pub fn of_state(&self, u: f64, y: &[D], length: D) -> LocalCoefficients<D> {
        self.in_state(self.at(u, length), y, length)
    }

    /// These coefficients with the contribution of the regulator in the state `y`.
    #[inline]
    pub fn in_state(&self, here: LocalCoefficients<D>, y: &[D], length: D) -> LocalCoefficients<D> {
        if y.len() == REGULATED { self.regulated(here, y[PHI], y[J] * length) } else { here }
    }
}

impl Constants<f64> {
    /// Derivatives by u of the coefficients [`at`](Self::at) u.
    pub fn slope(&self, u: f64, length: f64) -> LocalCoefficients<f64> {
        let mut slope = self.uniform.map(|_| 0.0);
        for term in &self.cue {
            let [_, f_u, f_uu] = term.at(u, length);
            slope.modulate(term.field, &self.uniform, f_u, f_uu);
        }
        if let Some(source) = self.source() {
            slope.source = source.profile.at(u, length)[1] * source.amplitude;
        }
        slope
    }

    /// [`regulated`](Self::regulated), and its derivatives by φ.
    pub(crate) fn regulated_by_phi(
        &self,
        here: LocalCoefficients<f64>,
        phi: f64,
        phi_u: f64,
    ) -> (LocalCoefficients<f64>, LocalCoefficients<f64>) {
        let (mut local, mut by_phi) = (here, here.map(|_| 0.0));
        for coupling in self.regulator.iter().flat_map(|regulator| &regulator.couplings) {
            let [h, slope, bend] = coupling.at(phi);
            local.modulate(coupling.field, &self.uniform, h, slope * phi_u);
            by_phi.modulate(coupling.field, &self.uniform, slope, bend * phi_u);
        }
        (local, by_phi)
    }
}

/// The transport constants of the regulator.
#[derive(Clone, Copy, Debug, Default)]
pub struct Transport<D> {
    /// Turnover k.
    pub turnover: D,
    /// 1/D.
    pub inverse_diffusion: D,
    /// 1 if flow dilutes it, 0 for a label of the material.
    pub dilution: D,
}

impl<D: Number> Transport<D> {
    /// The constants of a regulator.
    pub fn of(regulator: &Regulator<D>) -> Transport<D> {
        Transport {
            turnover: regulator.turnover,
            inverse_diffusion: regulator.diffusion.recip(),
            dilution: D::from(if regulator.diluted { 1.0 } else { 0.0 }),
        }
    }
}

impl<D> Transport<D> {
    /// The same with numbers of another kind.
    #[inline(always)]
    pub fn map<E>(self, number: impl Fn(D) -> E) -> Transport<E> {
        Transport {
            turnover: number(self.turnover),
            inverse_diffusion: number(self.inverse_diffusion),
            dilution: number(self.dilution),
        }
    }
}

/// Right-hand side d/du of the equations and the integrand of the volume, for any number type: seven components, or
/// nine with a regulator.
///
/// `noise` multiplies the activity.
pub fn equations<D: Number, const N: usize>(
    c: &Constants<D>,
    u: f64,
    motion: BdfTerm,
    noise: f64,
    y: &[D; N],
    length: D,
    pressure: D,
) -> ([D; N], D) {
    let (motion, noise) = (motion.map(D::from), D::from(noise));
    if c.is_own() {
        return own::points::equations(c, u, motion, noise, y, [length, pressure]);
    }
    let shape: [D; COMPONENTS] = std::array::from_fn(|k| y[k]);
    let here = c.of_state(u, y, length);
    let Balance { f, volume, place } = balances(&c.shell, &here, motion, noise, &shape, length, pressure);
    let mut out = [D::from(0.0); N];
    out[..COMPONENTS].copy_from_slice(&f);
    if let Some(regulator) = c.regulator.as_ref().filter(|_| N == REGULATED) {
        let transport = Transport::of(regulator);
        out[J] = carried(&transport, here.source, motion, &shape, [y[J], y[PHI]], &place, length) * length;
        out[PHI] = y[J] * length;
    }
    (out, volume)
}

/// Quantities at one place that several balances share; the names follow [`balances`].
#[derive(Clone, Copy, Debug)]
pub struct Place<D> {
    /// sinψ.
    pub sin: D,
    /// cosψ.
    pub cos: D,
    /// cosψ/r.
    pub cot: D,
    /// c1 + c2.
    pub mean: D,
    /// c1.
    pub c1: D,
    /// c2.
    pub c2: D,
    /// v_n.
    pub v_n: D,
    /// S_uu.
    pub s_u: D,
    /// S_φφ.
    pub s_phi: D,
    /// T_φφ.
    pub t_phi: D,
}

/// The right-hand sides of the shape at one place.
#[derive(Clone, Copy, Debug)]
pub struct Balance<D> {
    /// d/du of the seven components.
    pub f: [D; COMPONENTS],
    /// Integrand of the volume.
    pub volume: D,
    /// Shared quantities.
    pub place: Place<D>,
}

/// j_s of M.26: transport of the regulator `[j, φ]` on a moving shape.
#[inline(always)]
pub fn carried<D: Arithmetic>(
    c: &Transport<D>,
    source: D,
    motion: BdfTerm<D>,
    y: &[D; COMPONENTS],
    [j, phi]: [D; 2],
    at: &Place<D>,
    length: D,
) -> D {
    let w = (at.cos * (y[R] - motion.r_past) - at.sin * (y[Z] - motion.z_past)) * motion.rate;
    let (slip, past) = (y[V] - w, motion.carried_past);
    let one = D::from(1.0);
    let stretched = (one - (at.cos * past.r_u - at.sin * past.z_u) / length) * motion.rate;
    let before = past.amount * (c.dilution / (y[R] * length) + one - c.dilution);
    let changed = motion.rate * (phi + c.dilution - before) + slip * j;
    let spread = c.dilution * (phi + one) * (at.s_u + at.cot * slip - stretched);
    (changed + spread + c.turnover * (phi - source)) * c.inverse_diffusion - at.cot * j
}

/// [`equations`] of the shape with given coefficients. This is the readable statement;
/// [`linearised`](super::jacobian::linearised) repeats it with hand-written derivatives, and a test compares the two.
#[inline(always)]
pub fn balances<D: Arithmetic>(
    c: &ShellCoefficients<D>,
    here: &LocalCoefficients<D>,
    motion: BdfTerm<D>,
    noise: D,
    y: &[D; COMPONENTS],
    length: D,
    pressure: D,
) -> Balance<D> {
    let [r, z, m, psi, q, v, t] = *y;
    let (sin, cos) = psi.sin_cos();
    let inverse_r = r.recip();
    let c2 = sin * inverse_r;
    let mean = here.mean(m);
    let c1 = mean - c2;
    let cot = cos * inverse_r;
    let (xi_s, xi_b) = (here.xi_s * noise, here.xi_b * noise);
    let v_n = (sin * (r - motion.r_past) + cos * (z - motion.z_past)) * motion.rate;
    let s_phi = cot * v + c2 * v_n;
    let deviator = xi_s * (mean * 0.5 - c2);
    let s_u = (t - deviator - xi_b * mean - here.eta_difference * s_phi) / here.eta_sum;
    let t_phi = here.eta_difference * s_u + here.eta_sum * s_phi - deviator + xi_b * mean;
    let inside = ((z * z * c.inverse_a2 + r * r * c.inverse_b2 - 1.0) * c.inverse_w2).exp();
    let shell = -(c.shell_force * inside * (r * sin * c.inverse_b2 + z * cos * c.inverse_a2));
    let difference = c1 - c2;
    let spontaneous = here.spontaneous;
    let curled = here.kappa * spontaneous * (spontaneous * mean * 0.5 - c1 * c2 * 2.0);
    let elastic = here.tension * mean - here.kappa * difference * difference * mean * 0.5 + curled;
    let mut t_u = (here.friction * v - cot * (t - t_phi)) * length - here.tension_u;
    if c.rigidity_gradient {
        let bent = mean - spontaneous;
        t_u = t_u - bent * bent * here.kappa_u * 0.5;
    }
    Balance {
        f: [
            length * cos,
            -(length * sin),
            length * q,
            length * c1,
            length * (c1 * t + c2 * t_phi + elastic - cot * q - pressure - shell + c.normal_friction * v_n),
            length * (s_u - c1 * v_n),
            t_u,
        ],
        volume: length * r * r * sin * PI,
        place: Place { sin, cos, cot, mean, c1, c2, v_n, s_u, s_phi, t_phi },
    }
}

/// The factor of the noise on the activity \[M.19 noise\]: 1 + Σ_{n=1..10} r_n cos(nπu).
pub(crate) fn noise_factor(coefficients: &[f64; 10], u: f64) -> f64 {
    1.0 + coefficients.iter().enumerate().map(|(k, r)| r * ((k + 1) as f64 * PI * u).cos()).sum::<f64>()
}
