//! The equations at many collocation points side by side.
//!
//! Points are processed in groups of eight, quantity by quantity, so that one loop over a group evaluates [`balances`]
//! or [`linearised`] for one [`Lane`] after the other and is vectorised for the machine's instructions. No sum is
//! reordered and no multiply–add fused, so that the results are the same on all machines.
//!
//! `N` is the number of components: seven, or nine with a regulator.

use furrow_bvp::{CollocationPoints, PointJacobian};
use multiversion::multiversion;

use super::coefficients::COEFFICIENTS;
use super::columns::{Column, Varied};
use super::equations::{
    Balance, BdfTerm, COMPONENTS, Carried, Constants, J, LENGTH, LocalCoefficients, M, PHI, PRESSURE, PSI, Q, R,
    REGULATED, ShellCoefficients, T, Transport, V, Z, balances, carried,
};
use super::jacobian::{Linearised, LinearisedRegulated, linearised, linearised_regulated};
use super::lanes::Lane;

/// The inputs of a sweep.
pub(super) struct Sweep<'a> {
    /// The constants.
    pub constants: &'a Constants<f64>,
    /// 1/Δt of the implicit step; 0 for stationary shapes.
    pub rate: f64,
    /// Past (r, z) at every collocation point.
    pub past: &'a [[f64; 2]],
    /// The past of a regulator at every collocation point.
    pub carried_past: &'a [Carried],
    /// Factor on the activity at every collocation point; empty if it is 1 everywhere.
    pub noise: &'a [f64],
    /// The coefficients at the points of the sweep, without the contribution of a regulator; empty if they are uniform.
    pub local: &'a [LocalCoefficients<f64>],
    /// The cue's profiles at these points; empty if they are not cached.
    pub profiles: &'a [[f64; 2]],
    /// Number of scalar unknowns.
    pub scalars: usize,
}

impl Sweep<'_> {
    /// The coefficients at a point of the sweep, without the contribution of a regulator.
    pub(super) fn painted(&self, point: usize) -> LocalCoefficients<f64> {
        *self.local.get(point).unwrap_or(&self.constants.uniform)
    }
}

/// Points of a group.
pub(super) const GROUP: usize = 8;

/// A quantity at the points of a group.
pub(super) type Values = [f64; GROUP];

/// Quantities at point i of a group.
#[inline(always)]
pub(super) fn lanes<const K: usize>(values: &[Values; K], i: usize) -> [Lane; K] {
    std::array::from_fn(|k| Lane(values[k][i]))
}

/// Sets quantities at point i of a group.
#[inline(always)]
pub(super) fn put<const K: usize>(values: &mut [Values; K], i: usize, numbers: [f64; K]) {
    for k in 0..K {
        values[k][i] = numbers[k];
    }
}

/// The arguments of the equations at the points of a group.
pub(super) struct Group<const N: usize> {
    y: [Values; N],
    local: [Values; COEFFICIENTS],
    /// Derivatives of the coefficients by φ.
    by_phi: [Values; COEFFICIENTS],
    past: [Values; 2],
    carried_past: [Values; 3],
    noise: Values,
}

/// The values common to all points.
#[derive(Clone, Copy)]
pub(super) struct Shared {
    pub shell: ShellCoefficients<f64>,
    /// Zeros without a regulator.
    pub transport: Transport<f64>,
    rate: f64,
    pub length: f64,
    pub pressure: f64,
}

impl<const N: usize> Group<N> {
    /// A group for a cell without a cue, motion and noise.
    fn of(sweep: &Sweep<'_>) -> Group<N> {
        Group {
            y: [[0.0; GROUP]; N],
            local: sweep.constants.uniform.into_array().map(|value| [value; GROUP]),
            by_phi: [[0.0; GROUP]; COEFFICIENTS],
            past: [[0.0; GROUP]; 2],
            carried_past: [[0.0; GROUP]; 3],
            noise: [1.0; GROUP],
        }
    }

    /// Reads the group that starts at point `from`; the last point is repeated to fill the group.
    fn read(&mut self, sweep: &Sweep<'_>, points: CollocationPoints<'_>, from: usize, length: f64) {
        let last = points.x.len() - 1;
        for i in 0..GROUP {
            let point = (from + i).min(last);
            let y = &points.y[point * N..(point + 1) * N];
            for (values, y) in self.y.iter_mut().zip(y) {
                values[i] = *y;
            }
            let index = points.first + point;
            if sweep.rate != 0.0 {
                put(&mut self.past, i, sweep.past[index]);
            }
            if !sweep.noise.is_empty() {
                self.noise[i] = sweep.noise.get(index).copied().unwrap_or(1.0);
            }
            if N == REGULATED {
                if sweep.rate != 0.0 {
                    put(&mut self.carried_past, i, sweep.carried_past[index].parts());
                }
                let painted = sweep.painted(point);
                let (here, by_phi) = sweep.constants.regulated_by_phi(painted, y[PHI], y[J] * length);
                put(&mut self.local, i, here.into_array());
                put(&mut self.by_phi, i, by_phi.into_array());
            } else if let Some(here) = sweep.local.get(point) {
                put(&mut self.local, i, here.into_array());
            }
        }
    }

    /// The arguments of the equations at point i: coefficients, motion, noise, shape, and (j, φ) of a regulator.
    #[inline(always)]
    pub fn at(
        &self,
        i: usize,
        shared: &Shared,
    ) -> (LocalCoefficients<Lane>, BdfTerm<Lane>, Lane, [Lane; COMPONENTS], [Lane; 2]) {
        let ([r_past, z_past], [amount, r_u, z_u]) = (lanes(&self.past, i), lanes(&self.carried_past, i));
        let motion = BdfTerm { rate: Lane(shared.rate), r_past, z_past, carried_past: Carried { amount, r_u, z_u } };
        let shape = std::array::from_fn(|k| Lane(self.y[k][i]));
        let regulator = if N == REGULATED { [J, PHI].map(|k| Lane(self.y[k][i])) } else { [Lane(0.0); 2] };
        (lanes(&self.local, i).into(), motion, Lane(self.noise[i]), shape, regulator)
    }
}

impl Shared {
    fn of(sweep: &Sweep<'_>, p: &[f64]) -> Shared {
        let Constants { shell, regulator, .. } = sweep.constants;
        let transport = regulator.as_ref().map(Transport::of).unwrap_or_default();
        Shared { shell: *shell, transport, rate: sweep.rate, length: p[LENGTH], pressure: p[PRESSURE] }
    }
}

/// f, and the integrand of the volume.
#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
fn evaluate<const N: usize>(group: &Group<N>, shared: &Shared, f: &mut [Values; N], g: &mut Values) {
    let (shell, transport) = (shared.shell.map(Lane), shared.transport.map(Lane));
    let (length, pressure) = (Lane(shared.length), Lane(shared.pressure));
    for i in 0..GROUP {
        let (local, motion, noise, y, state) = group.at(i, shared);
        let Balance { f: shape, volume, place } = balances(&shell, &local, motion, noise, &y, length, pressure);
        for k in 0..COMPONENTS {
            f[k][i] = shape[k].0;
        }
        if N == REGULATED {
            let flux = carried(&transport, local.source, motion, &y, state, &place, length);
            f[J][i] = flux.0 * shared.length;
            f[PHI][i] = state[0].0 * shared.length;
        }
        g[i] = volume.0;
    }
}

/// Numbers of a [`Linearised`].
const NUMBERS: usize = 5 * COMPONENTS + 9;

/// Numbers of a [`LinearisedRegulated`].
const NUMBERS_REGULATED: usize = NUMBERS + COMPONENTS + 1 + REGULATED + 2;

/// All numbers of a [`LinearisedRegulated`] at the points of a group, beginning with the shape's, which are the only
/// ones without a regulator.
type Numbers = [Values; NUMBERS_REGULATED];

/// The equations and their derivatives.
#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
fn linearise<const N: usize>(group: &Group<N>, shared: &Shared, out: &mut Numbers) {
    let (shell, transport) = (shared.shell.map(Lane), shared.transport.map(Lane));
    let (length, pressure) = (Lane(shared.length), Lane(shared.pressure));
    for i in 0..GROUP {
        let (local, motion, noise, y, state) = group.at(i, shared);
        if N == REGULATED {
            let here = [&local, &lanes(&group.by_phi, i).into()];
            linearised_regulated(&shell, &transport, here, motion, noise, &y, state, length, pressure).store(i, out);
        } else {
            linearised(&shell, &local, motion, noise, &y, length, pressure).store(i, out);
        }
    }
}

impl Linearised<Lane> {
    /// Stores its numbers for point i of a group.
    #[inline(always)]
    fn store(&self, i: usize, out: &mut Numbers) {
        let Linearised { f, by_length, geometry, turning, normal, flow, tangential, volume, .. } = self;
        let n = COMPONENTS;
        for k in 0..n {
            out[k][i] = f[k].0;
            out[n + k][i] = by_length[k].0;
            out[2 * n + k][i] = normal[k].0;
            out[3 * n + k][i] = flow[k].0;
            out[4 * n + k][i] = tangential[k].0;
        }
        for k in 0..2 {
            out[5 * n + k][i] = geometry[k].0;
        }
        for k in 0..3 {
            out[5 * n + 2 + k][i] = turning[k].0;
        }
        for k in 0..4 {
            out[5 * n + 5 + k][i] = volume[k].0;
        }
    }
}

impl LinearisedRegulated<Lane> {
    /// Stores its numbers for point i of a group.
    #[inline(always)]
    fn store(&self, i: usize, out: &mut Numbers) {
        self.shape.store(i, out);
        for k in 0..COMPONENTS {
            out[NUMBERS + k][i] = self.by_phi[k].0;
        }
        out[NUMBERS + COMPONENTS][i] = self.tangential_by_j.0;
        let (flux, by) = self.carried;
        for k in 0..REGULATED {
            out[NUMBERS + COMPONENTS + 1 + k][i] = by[k].0;
        }
        out[NUMBERS_REGULATED - 2][i] = flux.0;
        out[NUMBERS_REGULATED - 1][i] = self.carried_by_length.0;
    }
}

/// f and the integrand of the volume at all points.
pub(super) fn rhs_many<const N: usize>(
    sweep: &Sweep<'_>,
    points: CollocationPoints<'_>,
    p: &[f64],
    f: &mut [f64],
    g: &mut [f64],
) {
    let (mut group, shared) = (Group::<N>::of(sweep), Shared::of(sweep, p));
    let (mut values, mut volumes) = ([[0.0; GROUP]; N], [0.0; GROUP]);
    for (j, (f, g)) in f.chunks_mut(GROUP * N).zip(g.chunks_mut(GROUP)).enumerate() {
        group.read(sweep, points, j * GROUP, shared.length);
        evaluate(&group, &shared, &mut values, &mut volumes);
        for (i, (f, g)) in f.chunks_exact_mut(N).zip(g).enumerate() {
            for k in 0..N {
                f[k] = values[k][i];
            }
            *g = volumes[i];
        }
    }
}

/// f, g and their derivatives by the components, L, p and the unknowns of `columns` at all points. Entries that are
/// always zero are not written.
pub(super) fn jacobian_many<'a, const N: usize>(
    sweep: &Sweep<'_>,
    points: CollocationPoints<'_>,
    p: &[f64],
    columns: impl Iterator<Item = Column<'a>>,
    out: &mut PointJacobian<'_>,
) {
    let mut columns: Vec<Varied<'a>> = columns.map(Varied::of).collect();
    let (mut group, shared) = (Group::<N>::of(sweep), Shared::of(sweep, p));
    let (scalars, length) = (sweep.scalars, shared.length);
    let mut numbers = [[0.0; GROUP]; NUMBERS_REGULATED];
    for from in (0..points.x.len()).step_by(GROUP) {
        group.read(sweep, points, from, length);
        linearise(&group, &shared, &mut numbers);
        for i in 0..GROUP.min(points.x.len() - from) {
            let mut out = out.at(from + i, N, scalars, 1);
            scatter::<N>(&numbers, i, length, scalars, &mut out);
            if N == REGULATED {
                scatter_regulator(&numbers, i, group.y[J][i], length, scalars, &mut out);
            }
        }
        columns.iter_mut().for_each(|column| column.add(&group, &shared, sweep, points, from, out));
    }
}

/// Writes the shape's numbers at point i of a group to their places.
#[inline]
fn scatter<const N: usize>(numbers: &Numbers, i: usize, length: f64, scalars: usize, out: &mut PointJacobian<'_>) {
    let m = COMPONENTS;
    let number = |k: usize| numbers[k][i];
    for (k, (f, by_p)) in out.f.iter_mut().zip(out.fp.chunks_exact_mut(scalars)).take(m).enumerate() {
        (*f, by_p[LENGTH]) = (number(k), number(m + k));
    }
    out.fp[Q * scalars + PRESSURE] = -length;
    let fy = out.fy.as_chunks_mut::<N>().0;
    for (block, row) in [Q, V, T].into_iter().enumerate() {
        let row = &mut fy[row];
        for k in 0..m {
            row[k] = number((2 + block) * m + k);
        }
    }
    (fy[R][PSI], fy[Z][PSI], fy[M][Q]) = (number(5 * m), number(5 * m + 1), length);
    for (k, component) in [R, M, PSI].into_iter().enumerate() {
        fy[PSI][component] = number(5 * m + 2 + k);
    }
    let [volume, by_r, by_psi, by_length] = [5, 6, 7, 8].map(|k| number(5 * m + k));
    (out.g[0], out.gy[R], out.gy[PSI], out.gp[LENGTH]) = (volume, by_r, by_psi, by_length);
}

/// Writes the regulator's numbers at point i of a group, where its gradient is j, to their places.
#[inline]
fn scatter_regulator(numbers: &Numbers, i: usize, j: f64, length: f64, scalars: usize, out: &mut PointJacobian<'_>) {
    let n = REGULATED;
    let number = |k: usize| numbers[NUMBERS + k][i];
    for k in [PSI, Q, V, T] {
        out.fy[k * n + PHI] = number(k);
    }
    out.fy[T * n + J] = number(COMPONENTS);
    for k in 0..n {
        out.fy[J * n + k] = length * number(COMPONENTS + 1 + k);
    }
    let [flux, by_length] = [2, 1].map(|k| numbers[NUMBERS_REGULATED - k][i]);
    (out.f[J], out.fp[J * scalars + LENGTH]) = (length * flux, flux + length * by_length);
    (out.f[PHI], out.fp[PHI * scalars + LENGTH], out.fy[PHI * n + J]) = (length * j, j, length);
}
