//! Cells with a law or a shell of their own at many places: right-hand sides, Jacobian, response to motion, and the law's parts for listings.

use furrow_bvp::{CollocationPoints, PointJacobian};
use furrow_cell::law::{Active, LawValues};
use num_dual::Dual64;

use super::shell::Balances;
use super::{Lawful, Prepared, Spot};
use crate::cortex::equations::{
    Balance, BdfTerm, COMPONENTS, Carried, Constants, J, LENGTH, LocalCoefficients, M, PHI, PRESSURE, PSI, Q, R,
    REGULATED, ShellCoefficients, T, Transport, V, Z, carried,
};
use crate::cortex::gradient::Gradient;
use crate::cortex::lanes::{Lane, sin_cos};
use crate::cortex::sweep::Sweep;

/// Right-hand sides at one place, with the regulator.
fn sides<D: Lawful, const N: usize>(
    balances: &mut Balances<D>,
    (c, transport): (&ShellCoefficients<D>, &Transport<D>),
    here: &LocalCoefficients<D>,
    spot: &Spot<D>,
    motion: BdfTerm<D>,
    y: &[D; N],
    [length, pressure]: [D; 2],
) -> ([D; N], D) {
    let shape: [D; COMPONENTS] = std::array::from_fn(|k| y[k]);
    let Balance { f, volume, place } = balances.at(c, here, spot, motion, &shape, length, pressure);
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

/// [`equations`](crate::cortex::equations::equations) of a cell with a law or a shell of its own.
pub(in crate::cortex) fn equations<D: furrow_cell::Number, const N: usize>(
    c: &Constants<D>,
    u: f64,
    motion: BdfTerm<D>,
    noise: D,
    y: &[D; N],
    of_contour: [D; 2],
) -> ([D; N], D) {
    let here = c.of_state(u, y, of_contour[0]);
    let transport = c.regulator.as_ref().map_or_else(|| Transport::default().map(|x: f64| D::from(x)), Transport::of);
    let spot = Spot { u, carried: carried_of(y), noise };
    let mut balances = Balances::of(c.law.clone(), c.shell_factor.as_ref(), 3);
    sides(&mut balances, (&c.shell, &transport), &here, &spot, motion, y, of_contour)
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
        painted: sweep.painted(k),
    }
}

/// f and the integrand of the volume at all points.
pub(in crate::cortex) fn rhs_many<const N: usize>(
    sweep: &Sweep<'_>,
    points: CollocationPoints<'_>,
    p: &[f64],
    f: &mut [f64],
    g: &mut [f64],
) {
    let constants = sweep.constants;
    let law = constants.law.as_ref().map(|law| law.map(Lane));
    let mut balances = Balances::of(law, constants.shell_factor.as_ref(), 0);
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
            sides(&mut balances, (&shell, &transport), &here.map(Lane), &spot, motion.map(Lane), &state, of_contour);
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
pub(in crate::cortex) fn jacobian_many<const N: usize>(
    sweep: &Sweep<'_>,
    points: CollocationPoints<'_>,
    p: &[f64],
    (along_length, columns): (&Constants<Dual64>, &[Constants<Dual64>]),
    out: &mut PointJacobian<'_>,
) {
    let constants = sweep.constants;
    let law = constants.law.as_ref().map(|law| law.map(Gradient::<N>::from));
    let mut balances = Balances::of(law, constants.shell_factor.as_ref(), 1);
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
        let (sides, volume) = sides(&mut balances, (&shell, &transport), &here, &spot, motion, &state, of_contour);
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

/// A scalar unknown: its index, the constants, the length, the balances and the transport.
type Unknown<'a> = (usize, &'a Constants<Dual64>, Dual64, Balances<Dual64>, Transport<Dual64>);

/// The columns of the scalar unknowns.
struct Columns<'a> {
    each: Vec<Unknown<'a>>,
}

impl<'a> Columns<'a> {
    fn of(along_length: &'a Constants<Dual64>, columns: &'a [Constants<Dual64>], length: f64) -> Columns<'a> {
        let first = (LENGTH, along_length, Dual64::new(length, 1.0));
        let others = columns.iter().enumerate().map(|(k, constants)| (PRESSURE + 1 + k, constants, length.into()));
        let each = [first].into_iter().chain(others).map(|(scalar, constants, length)| {
            let transport = constants.regulator.as_ref().map(Transport::of);
            let balances = Balances::of(constants.law.clone(), constants.shell_factor.as_ref(), 1);
            (
                scalar,
                constants,
                length,
                balances,
                transport.unwrap_or_else(|| Transport::default().map(|x: f64| x.into())),
            )
        });
        Columns { each: each.collect() }
    }

    fn put<const N: usize>(
        &mut self,
        point: &Point<'_>,
        pressure: f64,
        scalars: usize,
        fp: &mut [f64],
        gp: &mut [f64],
    ) {
        let state: [Dual64; N] = std::array::from_fn(|k| Dual64::from(point.y[k]));
        let spot = Spot { u: point.u, carried: carried_of(&state), noise: Dual64::from(point.noise) };
        let motion = point.motion.map(Dual64::from);
        for (scalar, constants, length, balances, transport) in &mut self.each {
            let here = constants.of_state(point.u, &state, *length);
            let of_contour = [*length, pressure.into()];
            let (sides, volume) =
                sides(balances, (&constants.shell, transport), &here, &spot, motion, &state, of_contour);
            for k in 0..N {
                fp[k * scalars + *scalar] = sides[k].eps;
            }
            gp[*scalar] = volume.eps;
        }
    }
}

/// The place of a shape in motion, with the derivatives of its right-hand sides by v_n: ∂(q′, v′, T′) and ∂S_uu.
pub(in crate::cortex) fn response(
    constants: &Constants<f64>,
    law: &LawValues<f64>,
    u: f64,
    motion: BdfTerm,
    y: &[f64],
    length: f64,
) -> ([f64; 3], f64) {
    let (sin, cos) = sin_cos(y[PSI]);
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
    let mut prepared = Prepared::of(&law.map(Dual64::from), 1);
    let Balance { f, place, .. } = prepared.balances(&shell, &here, &spot, motion, &shape, length, Dual64::from(0.0));
    ([Q, V, T].map(|k| f[k].eps), place.s_u.eps)
}

/// Reads curvatures and the law's parts at places of a shape.
pub(crate) struct Reader<'a> {
    constants: &'a Constants<f64>,
    prepared: Option<Prepared<Lane>>,
    /// Whether the law has a moment.
    bends: bool,
}

impl Constants<f64> {
    /// A reader of shapes with these constants.
    pub(crate) fn reader(&self) -> Reader<'_> {
        let prepared = self.law.as_ref().map(|law| Prepared::of(&law.map(Lane), 0));
        Reader { constants: self, prepared, bends: self.law.as_ref().is_some_and(|law| law.bends) }
    }
}

impl Reader<'_> {
    /// C and ∂_sC in a state at u with these coefficients.
    pub(crate) fn mean_curvature(&mut self, u: f64, here: &LocalCoefficients<f64>, y: &[f64], length: f64) -> [f64; 2] {
        if self.bends
            && let Some((_, mean)) = self.active(u, (y, 0.0, 1.0), here, length)
        {
            return mean;
        }
        let mean = here.mean(y[M]);
        [mean, here.mean_slope(y[Q], mean, length)]
    }

    /// The law's values in a state `(y, v_n, noise)` away from the axis, with C and ∂_sC; `None` without a law.
    pub(crate) fn active(
        &mut self,
        u: f64,
        (y, v_n, noise): (&[f64], f64, f64),
        here: &LocalCoefficients<f64>,
        length: f64,
    ) -> Option<(Active<f64>, [f64; 2])> {
        let (state, spot) = self.state_at(u, y, noise);
        let (active, mean) = self.prepared.as_mut()?.active(&here.map(Lane), &spot, &state, [v_n, length].map(Lane));
        let Active { stress, moment, normal_force } = active;
        let active = Active { stress: stress.map(|x| x.0), moment: moment.0, normal_force: normal_force.0 };
        Some((active, mean.map(|x| x.0)))
    }

    /// The moduli of the law that must be above 0 in a state `(y, v_n)`, with their names, as shares of those without it.
    pub(crate) fn moduli(&mut self, u: f64, (y, v_n): (&[f64], f64), length: f64) -> Option<[(&'static str, f64); 3]> {
        let here = self.constants.of_state(u, y, length);
        let (state, spot) = self.state_at(u, y, 1.0);
        let moduli = self.prepared.as_mut()?.moduli(&here.map(Lane), &spot, &state, [v_n, length].map(Lane));
        let [bending, along, around] = moduli.map(|x| x.0);
        Some([
            ("the rigidity κ + ∂moment/∂c1", bending / here.kappa),
            ("the viscosity η_b + η_s + ∂stress_uu/∂S_uu", along / here.eta_sum),
            ("the viscosity against S_phiphi", around / here.eta_sum),
        ])
    }

    fn state_at(&self, u: f64, y: &[f64], noise: f64) -> ([Lane; COMPONENTS], Spot<Lane>) {
        let regulated = self.constants.regulator.is_some();
        let carried = [J, PHI].map(|k| Lane(y.get(k).copied().filter(|_| regulated).unwrap_or(0.0)));
        (std::array::from_fn(|k| Lane(y[k])), Spot { u, carried, noise: Lane(noise) })
    }
}
