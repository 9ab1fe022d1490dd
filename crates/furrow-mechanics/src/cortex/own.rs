//! The force balance of a cell with a law of active stress of its own, for any number type.
//!
//! A law gives the active stress T^a, an isotropic active moment M^a and a force f^a along the outward normal. With
//! m = κC + M^a and T the whole dissipative tension, the equations are those of [`equations`](super::equations) without activity
//! for m − M^a and T − T^a_uu, and
//!
//! * \[M.29 own law, normal\] q_s gains c1 T^a_uu + c2 T^a_φφ − M^a (c1² + c2²) − f^a
//! * \[M.30 own law, tangential\] T_s gains −(cosψ/r)(T^a_uu − T^a_φφ) + M^a ∂_sC
//!
//! The terms of M^a are those of the tension −M^a C^ij, which goes with a moment whose power is M^a times the rate of C.
//!
//! The stress may depend on the rates of strain. S_uu then solves (η_b + η_s) S_uu + (η_b − η_s) S_φφ + T^a_uu = T at each
//! place, by Newton's method in numbers that carry the derivatives asked for.

use furrow_bvp::{CollocationPoints, PointJacobian};
use furrow_cell::law::{Active, Algebra, LawValues, VARIABLES, Variable};
use num_dual::Dual64;

use super::equations::{
    self, Balance, BdfTerm, COMPONENTS, Carried, Constants, J, LENGTH, LocalCoefficients, M, PHI, PRESSURE, PSI, Q, R,
    REGULATED, ShellCoefficients, T, Transport, V, Z, carried,
};
use super::gradient::Gradient;
use super::jets::Jet;
use super::lanes::{Arithmetic, Lane};
use super::sweep::Sweep;

/// Numbers in which cells with a law of their own are evaluated.
pub(crate) trait Lawful: Arithmetic + Algebra {}

impl<D: Arithmetic + Algebra> Lawful for D {}

/// A law, its form for derivatives along one quantity, and working memory.
pub(crate) struct Prepared<D> {
    law: LawValues<D>,
    /// Only of laws that depend on the rates of strain, or have a moment.
    jets: Option<LawValues<Jet<D>>>,
    memory: Vec<D>,
    jet_memory: Vec<Jet<D>>,
}

impl<D: Lawful> Prepared<D> {
    pub fn of(law: &LawValues<D>) -> Prepared<D> {
        let jets = (law.viscous || law.bends).then(|| law.map(|value| Jet { value, slope: D::from(0.0) }));
        Prepared { law: law.clone(), jets, memory: Vec::new(), jet_memory: Vec::new() }
    }
}

/// What the balance of one place needs besides its state.
#[derive(Clone, Copy)]
pub(crate) struct Spot<D> {
    /// The place u.
    pub u: f64,
    /// The regulator φ and its gradient j; 0 without one.
    pub carried: [D; 2],
    /// Factor on stress and normal force.
    pub noise: D,
}

/// Most iterations for a quantity that a law gives implicitly, and those after its number has converged: each doubles the
/// order of the derivatives that are right.
const ITERATIONS: (usize, usize) = (40, 2);

/// Solves for a quantity by the value and the slope of its equation.
fn solved<D: Lawful>(mut x: D, scale: f64, mut equation: impl FnMut(D) -> Jet<D>) -> D {
    let mut further = 0;
    for _ in 0..ITERATIONS.0 {
        let Jet { value, slope } = equation(x);
        let step = value / slope;
        x = x - step;
        // A law without the right sign has no shape: the solver is told so by a number that is none.
        if slope.real() <= 0.0 || !step.real().is_finite() {
            return D::from(f64::NAN);
        }
        further += usize::from(further > 0 || step.real().abs() <= 1e-13 * (scale + x.real().abs()));
        if further > ITERATIONS.1 {
            return x;
        }
    }
    D::from(f64::NAN)
}

/// The quantities of a place that a law may use, with the curvature C still 0 and S_uu too.
fn quantities<D: Lawful>(
    law: &LawValues<D>,
    here: &LocalCoefficients<D>,
    spot: &Spot<D>,
    [r, c2, s_phi]: [D; 3],
    length: D,
) -> [D; VARIABLES] {
    let half = |a: D| a * 0.5;
    let [u, s] = law.along(spot.u, length);
    let zero = D::from(0.0);
    let [eta_b, eta_s] = [half(here.eta_sum + here.eta_difference), half(here.eta_sum - here.eta_difference)];
    let [xi_s, xi_b] = [here.xi_s, here.xi_b].map(|x| x / law.gain());
    let phi = spot.carried[1];
    let (kappa, friction, tension) = (here.kappa, here.friction, here.tension);
    [zero, c2, zero, u, s, r, zero, s_phi, phi, kappa, eta_b, eta_s, friction, tension, xi_s, xi_b]
}

/// The index of a quantity.
const fn at(variable: Variable) -> usize {
    variable as usize
}

/// Sets C, and c1 with it.
fn bend<D: Lawful>(place: &mut [D; VARIABLES], mean: D) {
    place[at(Variable::C)] = mean;
    place[at(Variable::C1)] = mean - place[at(Variable::C2)];
}

/// Quantities with slopes; only those of c1 and C differ from 0 in a law's own slope by C.
fn with_slopes<D: Lawful>(place: &[D; VARIABLES], of: &[(Variable, D)]) -> [Jet<D>; VARIABLES] {
    let mut jets = place.map(|value| Jet { value, slope: D::from(0.0) });
    for (variable, slope) in of {
        jets[at(*variable)].slope = *slope;
    }
    jets
}

impl<D: Lawful> Prepared<D> {
    /// Finds C = (m − M^a)/κ, sets it, and returns M^a and ∂_sC.
    fn moment(
        &mut self,
        place: &mut [D; VARIABLES],
        here: &LocalCoefficients<D>,
        [m, q, cos, j]: [D; 4],
        length: D,
    ) -> [D; 2] {
        let zero = D::from(0.0);
        bend(place, m / here.kappa);
        let Some(jets) = self.jets.as_ref().filter(|_| self.law.bends) else { return [zero; 2] };
        let one = D::from(1.0);
        let memory = &mut self.jet_memory;
        let mut of_mean = |place: &[D; VARIABLES]| {
            jets.moment(&with_slopes(place, &[(Variable::C1, one), (Variable::C, one)]), memory)
        };
        let start = place[at(Variable::C)];
        let scale = start.real().abs() + 1e-3;
        let mut trial = *place;
        let mean = solved(start, scale, |mean| {
            bend(&mut trial, mean);
            let Jet { value, slope } = of_mean(&trial);
            Jet { value: here.kappa * mean + value - m, slope: here.kappa + slope }
        });
        bend(place, mean);
        let Jet { value: moment, slope: by_mean } = of_mean(place);
        // ∂_sM^a if C stayed the same, and from q = ∂_s(κC + M^a) the slope of C.
        let cot = cos / place[at(Variable::R)];
        let turned = cot * (place[at(Variable::C1)] - place[at(Variable::C2)]);
        let [ahead, along] = self.law.direction();
        let slopes = [
            (Variable::C1, -turned),
            (Variable::C2, turned),
            (Variable::U, D::from(ahead) / length),
            (Variable::S, D::from(along)),
            (Variable::R, cos),
            (Variable::Phi, j),
        ];
        let unbent = jets.moment(&with_slopes(place, &slopes), &mut self.jet_memory).slope;
        let mean_s = (q - here.kappa_u / length * mean - unbent) / (here.kappa + by_mean);
        [moment, mean_s]
    }

    /// Everything else that the law gives; of a law with rates of strain, S_uu is found first.
    fn stress(
        &mut self,
        place: &mut [D; VARIABLES],
        here: &LocalCoefficients<D>,
        noise: D,
        tension: D,
    ) -> Active<D> {
        if self.law.viscous
            && let Some(jets) = &self.jets
        {
            let s_phi = place[at(Variable::Sphiphi)];
            let start = (tension - here.eta_difference * s_phi) / here.eta_sum;
            let scale = start.real().abs() + 1e-3;
            let memory = &mut self.jet_memory;
            let mut trial = *place;
            place[at(Variable::Suu)] = solved(start, scale, |s_u| {
                trial[at(Variable::Suu)] = s_u;
                let of_rate = with_slopes(&trial, &[(Variable::Suu, D::from(1.0))]);
                let [Jet { value, slope }, _] = jets.at(&of_rate, memory).stress;
                let value = here.eta_sum * s_u + here.eta_difference * s_phi + value * noise - tension;
                Jet { value, slope: here.eta_sum + slope * noise }
            });
        }
        self.law.at(place, &mut self.memory)
    }

    /// The force balances at one place.
    pub fn balances(
        &mut self,
        c: &ShellCoefficients<D>,
        here: &LocalCoefficients<D>,
        spot: &Spot<D>,
        motion: BdfTerm<D>,
        y: &[D; COMPONENTS],
        length: D,
        pressure: D,
    ) -> Balance<D> {
        let [r, z, m, psi, q, v, t] = *y;
        let (sin, cos) = psi.sin_cos();
        let inverse_r = r.recip();
        let (c2, cot) = (sin * inverse_r, cos * inverse_r);
        let v_n = (sin * (r - motion.r_past) + cos * (z - motion.z_past)) * motion.rate;
        let s_phi = cot * v + c2 * v_n;
        let mut place = quantities(&self.law, here, spot, [r, c2, s_phi], length);
        let [moment, mean_s] = self.moment(&mut place, here, [m, q, cos, spot.carried[0]], length);
        let Active { stress, normal_force, .. } = self.stress(&mut place, here, spot.noise, t);
        let [t_uu, t_phi] = stress.map(|stress| stress * spot.noise);
        let zero = D::from(0.0);
        let passive = LocalCoefficients { xi_s: zero, xi_b: zero, ..*here };
        let state = [r, z, m - moment, psi, q, v, t - t_uu];
        let mut balance = equations::balances(c, &passive, motion, D::from(1.0), &state, length, pressure);
        let (c1, c2) = (balance.place.c1, balance.place.c2);
        let pushed = c1 * t_uu + c2 * t_phi - moment * (c1 * c1 + c2 * c2) - normal_force * spot.noise;
        balance.f[Q] = balance.f[Q] + length * pushed;
        balance.f[T] = balance.f[T] + length * (moment * mean_s - cot * (t_uu - t_phi));
        balance.place.t_phi = balance.place.t_phi + t_phi;
        balance
    }

    /// What the law gives in a state at a distance from the axis, with C and ∂_sC; stress and force with the noise.
    pub fn active(
        &mut self,
        here: &LocalCoefficients<D>,
        spot: &Spot<D>,
        y: &[D; COMPONENTS],
        [v_n, length]: [D; 2],
    ) -> (Active<D>, [D; 2]) {
        let [r, _, m, psi, q, v, t] = *y;
        let (sin, cos) = psi.sin_cos();
        let c2 = sin / r;
        let mut place = quantities(&self.law, here, spot, [r, c2, cos / r * v + c2 * v_n], length);
        let [moment, mean_s] = self.moment(&mut place, here, [m, q, cos, spot.carried[0]], length);
        let Active { stress, normal_force, .. } = self.stress(&mut place, here, spot.noise, t);
        let stress = stress.map(|stress| stress * spot.noise);
        (Active { stress, moment, normal_force: normal_force * spot.noise }, [place[at(Variable::C)], mean_s])
    }

    /// What decides whether the shortest waves decay: κ + ∂M^a/∂C, and the viscosities along and, at given T_uu, around the contour,
    /// 1 and those of the material without a law.
    pub fn moduli(
        &mut self,
        here: &LocalCoefficients<D>,
        spot: &Spot<D>,
        y: &[D; COMPONENTS],
        [v_n, length]: [D; 2],
    ) -> [D; 3] {
        let [r, _, m, psi, q, v, t] = *y;
        let (sin, cos) = psi.sin_cos();
        let c2 = sin / r;
        let s_phi = cos / r * v + c2 * v_n;
        let mut place = quantities(&self.law, here, spot, [r, c2, s_phi], length);
        self.moment(&mut place, here, [m, q, cos, spot.carried[0]], length);
        self.stress(&mut place, here, spot.noise, t);
        let Some(jets) = &self.jets else { return [here.kappa, here.eta_sum, here.eta_sum] };
        let one = D::from(1.0);
        // Where no rate of strain gives this tension, the law is looked at without flow.
        if !place[at(Variable::Suu)].real().is_finite() {
            place[at(Variable::Suu)] = D::from(0.0);
        }
        if !place[at(Variable::C)].real().is_finite() {
            bend(&mut place, m / here.kappa);
        }
        let memory = &mut self.jet_memory;
        let mut slopes = |of: &[Variable]| {
            let of: Vec<(Variable, D)> = of.iter().map(|variable| (*variable, one)).collect();
            jets.at(&with_slopes(&place, &of), memory)
        };
        let bent = slopes(&[Variable::C1, Variable::C]).moment.slope;
        let [along, across] = [Variable::Suu, Variable::Sphiphi].map(|rate| slopes(&[rate]).stress.map(|stress| stress.slope));
        let first = here.eta_sum + along[0];
        let second = here.eta_sum + across[1] - (here.eta_difference + across[0]) * (here.eta_difference + along[1]) / first;
        [here.kappa + bent, first, second]
    }
}

/// The right-hand sides at one place, in components; those of a regulator too.
fn sides<D: Lawful, const N: usize>(
    prepared: &mut Prepared<D>,
    (c, transport): (&ShellCoefficients<D>, &Transport<D>),
    here: &LocalCoefficients<D>,
    spot: &Spot<D>,
    motion: BdfTerm<D>,
    y: &[D; N],
    [length, pressure]: [D; 2],
) -> ([D; N], D) {
    let shape: [D; COMPONENTS] = std::array::from_fn(|k| y[k]);
    let Balance { f, volume, place } = prepared.balances(c, here, spot, motion, &shape, length, pressure);
    let mut out = [D::from(0.0); N];
    out[..COMPONENTS].copy_from_slice(&f);
    if N == REGULATED {
        let flux = carried(transport, here.source, motion, &shape, spot.carried, &place, length);
        (out[J], out[PHI]) = (flux * length, spot.carried[0] * length);
    }
    (out, volume)
}

/// (j, φ) of a state; 0 without a regulator.
fn carried_of<D: Lawful, const N: usize>(y: &[D; N]) -> [D; 2] {
    if N == REGULATED { [y[J], y[PHI]] } else { [D::from(0.0); 2] }
}

/// [`equations`](super::equations::equations) of a cell with a law of its own.
pub(super) fn equations<D: furrow_cell::Number, const N: usize>(
    c: &Constants<D>,
    law: &LawValues<D>,
    u: f64,
    motion: BdfTerm<D>,
    noise: D,
    y: &[D; N],
    of_contour: [D; 2],
) -> ([D; N], D) {
    let here = c.of_state(u, y, of_contour[0]);
    let transport = c.regulator.as_ref().map_or_else(|| Transport::default().map(|x: f64| D::from(x)), Transport::of);
    let spot = Spot { u, carried: carried_of(y), noise };
    sides(&mut Prepared::of(law), (&c.shell, &transport), &here, &spot, motion, y, of_contour)
}

/// The motion at a collocation point of a sweep.
fn motion_at(sweep: &Sweep<'_>, index: usize) -> BdfTerm {
    if sweep.rate == 0.0 {
        return BdfTerm::default();
    }
    let [r_past, z_past] = sweep.past[index];
    let carried_past = sweep.carried_past.get(index).copied().unwrap_or_default();
    BdfTerm { rate: sweep.rate, r_past, z_past, carried_past }
}

/// One point of a sweep.
struct Point<'a> {
    u: f64,
    y: &'a [f64],
    motion: BdfTerm,
    noise: f64,
    painted: LocalCoefficients<f64>,
}

fn point_of<'a>(sweep: &Sweep<'_>, points: CollocationPoints<'a>, k: usize, n: usize) -> Point<'a> {
    let index = points.first + k;
    Point {
        u: points.x[k],
        y: &points.y[k * n..(k + 1) * n],
        motion: motion_at(sweep, index),
        noise: sweep.noise.get(index).copied().unwrap_or(1.0),
        painted: *sweep.local.get(k).unwrap_or(&sweep.constants.uniform),
    }
}

/// f and the integrand of the volume at all points.
pub(super) fn rhs_many<const N: usize>(
    sweep: &Sweep<'_>,
    law: &LawValues<f64>,
    points: CollocationPoints<'_>,
    p: &[f64],
    f: &mut [f64],
    g: &mut [f64],
) {
    let constants = sweep.constants;
    let mut prepared = Prepared::of(&law.map(Lane));
    let shell = constants.shell.map(Lane);
    let transport = constants.regulator.as_ref().map(Transport::of).unwrap_or_default().map(Lane);
    let length = p[LENGTH];
    for (k, (f, g)) in f.chunks_exact_mut(N).zip(g).enumerate() {
        let Point { u, y, motion, noise, painted } = point_of(sweep, points, k, N);
        let here = if N == REGULATED { constants.regulated(painted, y[PHI], y[J] * length) } else { painted };
        let state: [Lane; N] = std::array::from_fn(|k| Lane(y[k]));
        let spot = Spot { u, carried: carried_of(&state), noise: Lane(noise) };
        let of_contour = [length, p[PRESSURE]].map(Lane);
        let (sides, volume) =
            sides(&mut prepared, (&shell, &transport), &here.map(Lane), &spot, motion.map(Lane), &state, of_contour);
        for k in 0..N {
            f[k] = sides[k].0;
        }
        *g = volume.0;
    }
}

/// Coefficients with their derivatives by the state.
fn local_gradient<const N: usize>(
    constants: &Constants<f64>,
    painted: LocalCoefficients<f64>,
    y: &[f64],
    length: f64,
) -> LocalCoefficients<Gradient<N>> {
    if N != REGULATED {
        return painted.map(Gradient::from);
    }
    let (here, by_phi) = constants.regulated_by_phi(painted, y[PHI], y[J] * length);
    let (values, slopes) = (here.into_array(), by_phi.into_array());
    let mut local: LocalCoefficients<Gradient<N>> = std::array::from_fn(|k| {
        let mut number = Gradient::from(values[k]);
        number.by[PHI] = slopes[k];
        number
    })
    .into();
    // κ_u and γ_u are L j times the derivatives of κ and γ by φ.
    local.kappa_u.by[J] = length * by_phi.kappa;
    local.tension_u.by[J] = length * by_phi.tension;
    local
}

/// f, g and their derivatives at all points. `columns` are the constants with derivatives by the scalar unknowns after (L, p), and
/// `along_length` those without any.
pub(super) fn jacobian_many<const N: usize>(
    sweep: &Sweep<'_>,
    law: &LawValues<f64>,
    points: CollocationPoints<'_>,
    p: &[f64],
    (along_length, columns): (&Constants<Dual64>, &[Constants<Dual64>]),
    out: &mut PointJacobian<'_>,
) {
    let constants = sweep.constants;
    let mut prepared = Prepared::of(&law.map(Gradient::<N>::from));
    let shell = constants.shell.map(Gradient::<N>::from);
    let transport = constants.regulator.as_ref().map(Transport::of).unwrap_or_default().map(Gradient::from);
    let length = p[LENGTH];
    let scalars = sweep.scalars;
    let mut varied = Columns::of(along_length, columns, length);
    for k in 0..points.x.len() {
        let point = point_of(sweep, points, k, N);
        let here = local_gradient::<N>(constants, point.painted, point.y, length);
        let state: [Gradient<N>; N] = std::array::from_fn(|k| Gradient::component(k, point.y[k]));
        let spot = Spot { u: point.u, carried: carried_of(&state), noise: point.noise.into() };
        let of_contour = [length, p[PRESSURE]].map(Gradient::from);
        let motion = point.motion.map(Gradient::from);
        let (sides, volume) = sides(&mut prepared, (&shell, &transport), &here, &spot, motion, &state, of_contour);
        let out = out.at(k, N, scalars, 1);
        for k in 0..N {
            out.f[k] = sides[k].value;
            out.fy[k * N..(k + 1) * N].copy_from_slice(&sides[k].by);
        }
        out.g[0] = volume.value;
        out.gy.copy_from_slice(&volume.by);
        varied.put::<N>(&point, p[PRESSURE], scalars, out.fp, out.gp);
        out.fp[Q * scalars + PRESSURE] = -length;
    }
}

/// The columns of the scalar unknowns.
struct Columns<'a> {
    /// Which unknown, the constants, the length, and the law.
    each: Vec<(usize, &'a Constants<Dual64>, Dual64, Option<Prepared<Dual64>>, Transport<Dual64>)>,
}

impl<'a> Columns<'a> {
    fn of(along_length: &'a Constants<Dual64>, columns: &'a [Constants<Dual64>], length: f64) -> Columns<'a> {
        let first = (LENGTH, along_length, Dual64::new(length, 1.0));
        let others = columns.iter().enumerate().map(|(k, constants)| (PRESSURE + 1 + k, constants, length.into()));
        let each = [first].into_iter().chain(others).map(|(scalar, constants, length)| {
            let transport = constants.regulator.as_ref().map(Transport::of);
            let law = constants.law.as_ref().map(Prepared::of);
            (scalar, constants, length, law, transport.unwrap_or_else(|| Transport::default().map(|x: f64| x.into())))
        });
        Columns { each: each.collect() }
    }

    fn put<const N: usize>(&mut self, point: &Point<'_>, pressure: f64, scalars: usize, fp: &mut [f64], gp: &mut [f64]) {
        let state: [Dual64; N] = std::array::from_fn(|k| Dual64::from(point.y[k]));
        let spot = Spot { u: point.u, carried: carried_of(&state), noise: Dual64::from(point.noise) };
        let motion = point.motion.map(Dual64::from);
        for (scalar, constants, length, law, transport) in &mut self.each {
            let Some(law) = law else { continue };
            let here = constants.of_state(point.u, &state, *length);
            let of_contour = [*length, pressure.into()];
            let (sides, volume) = sides(law, (&constants.shell, transport), &here, &spot, motion, &state, of_contour);
            for k in 0..N {
                fp[k * scalars + *scalar] = sides[k].eps;
            }
            gp[*scalar] = volume.eps;
        }
    }
}

/// The place of a shape in motion, with the derivatives of its right-hand sides by v_n: ∂(q′, v′, T′) and ∂S_uu.
pub(super) fn response(
    constants: &Constants<f64>,
    law: &LawValues<f64>,
    u: f64,
    motion: BdfTerm,
    y: &[f64],
    length: f64,
) -> ([f64; 3], f64) {
    let (sin, cos) = super::lanes::sin_cos(y[PSI]);
    let v_n = (sin * (y[R] - motion.r_past) + cos * (y[Z] - motion.z_past)) * motion.rate;
    let moved = Dual64::new(v_n, 1.0);
    // The past that gives this normal velocity in one unit of time.
    let motion = BdfTerm {
        rate: Dual64::from(1.0),
        r_past: Dual64::from(y[R]) - moved * sin,
        z_past: Dual64::from(y[Z]) - moved * cos,
        carried_past: Carried::default().map(|x: f64| Dual64::from(x)),
    };
    let here = constants.of_state(u, y, length).map(Dual64::from);
    let carried = [J, PHI].map(|k| Dual64::from(y.get(k).copied().unwrap_or(0.0)));
    let spot = Spot { u, carried, noise: Dual64::from(1.0) };
    let shape: [Dual64; COMPONENTS] = std::array::from_fn(|k| Dual64::from(y[k]));
    let (shell, length) = (constants.shell.map(Dual64::from), Dual64::from(length));
    let mut prepared = Prepared::of(&law.map(Dual64::from));
    let Balance { f, place, .. } =
        prepared.balances(&shell, &here, &spot, motion, &shape, length, Dual64::from(0.0));
    ([Q, V, T].map(|k| f[k].eps), place.s_u.eps)
}

impl Constants<f64> {
    /// C and ∂_sC in a state at u with these coefficients.
    pub(crate) fn mean_curvature(&self, u: f64, here: &LocalCoefficients<f64>, y: &[f64], length: f64) -> [f64; 2] {
        match self.law.as_ref().filter(|law| law.bends) {
            Some(law) => own_place(self, law, u, (y, 0.0, 1.0), here, length).1,
            None => {
                let mean = y[M] / here.kappa;
                [mean, (y[Q] - mean * here.kappa_u / length) / here.kappa]
            }
        }
    }
}

/// What the law gives in a state `(y, v_n, noise)` away from the axis, with C and ∂_sC.
pub(super) fn own_place(
    constants: &Constants<f64>,
    law: &LawValues<f64>,
    u: f64,
    (y, v_n, noise): (&[f64], f64, f64),
    here: &LocalCoefficients<f64>,
    length: f64,
) -> (Active<f64>, [f64; 2]) {
    let (state, spot) = state_at(constants, u, y, noise);
    let mut prepared = Prepared::of(&law.map(Lane));
    let (active, mean) = prepared.active(&here.map(Lane), &spot, &state, [v_n, length].map(Lane));
    let Active { stress, moment, normal_force } = active;
    let active = Active { stress: stress.map(|x| x.0), moment: moment.0, normal_force: normal_force.0 };
    (active, mean.map(|x| x.0))
}

fn state_at(constants: &Constants<f64>, u: f64, y: &[f64], noise: f64) -> ([Lane; COMPONENTS], Spot<Lane>) {
    let carried = if constants.regulator.is_some() { [J, PHI].map(|k| y.get(k).copied().unwrap_or(0.0)) } else { [0.0; 2] };
    (std::array::from_fn(|k| Lane(y[k])), Spot { u, carried: carried.map(Lane), noise: Lane(noise) })
}

/// The moduli of a law that must be above 0 in a state `(y, v_n)`, with their names, as shares of those without it.
pub(crate) fn moduli(
    constants: &Constants<f64>,
    law: &LawValues<f64>,
    u: f64,
    (y, v_n): (&[f64], f64),
    length: f64,
) -> [(&'static str, f64); 3] {
    let here = constants.of_state(u, y, length);
    let (state, spot) = state_at(constants, u, y, 1.0);
    let mut prepared = Prepared::of(&law.map(Lane));
    let [bending, along, around] =
        prepared.moduli(&here.map(Lane), &spot, &state, [v_n, length].map(Lane)).map(|x| x.0);
    [
        ("the rigidity κ + ∂moment/∂c1", bending / here.kappa),
        ("the viscosity η_b + η_s + ∂stress_uu/∂S_uu", along / here.eta_sum),
        ("the viscosity against S_phiphi", around / here.eta_sum),
    ]
}
