//! The equations at many collocation points side by side.
//!
//! Points are processed in groups of eight, quantity by quantity, so that one loop over a group evaluates [`balances`]
//! or [`linearised`] for [`Each`] of them and is vectorised for the machine's instructions. No sum is reordered and no
//! multiply–add fused, so that the results are the same on all machines.

use furrow_bvp::{CollocationPoints, PointJacobian};
use multiversion::multiversion;

use super::columns::{Column, Varied};
use super::equations::{
    Balance, BdfTerm, COMPONENTS, Carried, Constants, J, LENGTH, LocalCoefficients, M, PHI, PRESSURE, PSI, Q, R,
    REGULATED, ShellCoefficients, T, Transport, V, Z, balances, carried,
};
use super::jacobian::{Linearised, LinearisedRegulated, linearised, linearised_regulated};
use super::lanes::Each;

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

/// Points of a group.
pub(super) const GROUP: usize = 8;

/// A quantity at the points of a group.
pub(super) type Values = [f64; GROUP];

/// The arguments of the equations at the points of a group.
pub(super) struct Group {
    y: [Values; COMPONENTS],
    local: LocalCoefficients<Values>,
    past: [Values; 2],
    noise: Values,
}

/// The values common to all points.
#[derive(Clone, Copy)]
pub(super) struct Shared {
    pub shell: ShellCoefficients<f64>,
    rate: f64,
    pub length: f64,
    pub pressure: f64,
}

impl Group {
    /// A group for a cell without a cue, motion and noise.
    fn of(sweep: &Sweep<'_>) -> Group {
        let local = sweep.constants.uniform.map(|value| [value; GROUP]);
        Group { y: [[0.0; GROUP]; COMPONENTS], local, past: [[0.0; GROUP]; 2], noise: [1.0; GROUP] }
    }

    /// Reads the group that starts at point `from`; the last point is repeated to fill the group.
    fn read<const N: usize>(&mut self, sweep: &Sweep<'_>, points: CollocationPoints<'_>, from: usize) {
        let last = points.x.len() - 1;
        for i in 0..GROUP {
            let point = (from + i).min(last);
            let y = &points.y[point * N..(point + 1) * N];
            for (values, y) in self.y.iter_mut().zip(y) {
                values[i] = *y;
            }
            let index = points.first + point;
            if sweep.rate != 0.0 {
                [self.past[0][i], self.past[1][i]] = sweep.past[index];
            }
            if !sweep.noise.is_empty() {
                self.noise[i] = sweep.noise.get(index).copied().unwrap_or(1.0);
            }
            if let Some(here) = sweep.local.get(point) {
                self.local.put(i, *here);
            }
        }
    }

    /// The arguments of the equations at point i.
    #[inline(always)]
    pub fn at(&self, i: usize, shared: &Shared) -> (LocalCoefficients<Each>, BdfTerm<Each>, Each, [Each; COMPONENTS]) {
        let motion = BdfTerm {
            rate: Each(shared.rate),
            r_past: Each(self.past[0][i]),
            z_past: Each(self.past[1][i]),
            carried_past: Carried { amount: Each(0.0), r_u: Each(0.0), z_u: Each(0.0) },
        };
        (self.local.each(i), motion, Each(self.noise[i]), std::array::from_fn(|k| Each(self.y[k][i])))
    }
}

impl LocalCoefficients<Values> {
    pub(super) fn put(&mut self, i: usize, here: LocalCoefficients<f64>) {
        self.kappa[i] = here.kappa;
        self.kappa_u[i] = here.kappa_u;
        self.eta_sum[i] = here.eta_sum;
        self.eta_difference[i] = here.eta_difference;
        self.friction[i] = here.friction;
        self.tension[i] = here.tension;
        self.tension_u[i] = here.tension_u;
        self.xi_s[i] = here.xi_s;
        self.xi_b[i] = here.xi_b;
        self.source[i] = here.source;
    }

    #[inline(always)]
    pub(super) fn each(&self, i: usize) -> LocalCoefficients<Each> {
        LocalCoefficients {
            kappa: Each(self.kappa[i]),
            kappa_u: Each(self.kappa_u[i]),
            eta_sum: Each(self.eta_sum[i]),
            eta_difference: Each(self.eta_difference[i]),
            friction: Each(self.friction[i]),
            tension: Each(self.tension[i]),
            tension_u: Each(self.tension_u[i]),
            xi_s: Each(self.xi_s[i]),
            xi_b: Each(self.xi_b[i]),
            source: Each(self.source[i]),
        }
    }
}

impl Shared {
    fn of(sweep: &Sweep<'_>, p: &[f64]) -> Shared {
        let shell = sweep.constants.shell;
        Shared { shell, rate: sweep.rate, length: p[LENGTH], pressure: p[PRESSURE] }
    }
}

/// f, followed by the integrand of the volume.
#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
fn evaluate(group: &Group, shared: &Shared, out: &mut [Values; COMPONENTS + 1]) {
    let shell = shared.shell.map(Each);
    for i in 0..GROUP {
        let (local, motion, noise, y) = group.at(i, shared);
        let Balance { f, volume, .. } =
            balances(&shell, &local, motion, noise, &y, Each(shared.length), Each(shared.pressure));
        for k in 0..COMPONENTS {
            out[k][i] = f[k].0;
        }
        out[COMPONENTS][i] = volume.0;
    }
}

/// Numbers of a [`Linearised`].
const NUMBERS: usize = 5 * COMPONENTS + 9;

/// All numbers of a [`Linearised`], in the order of its fields.
#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
fn linearise(group: &Group, shared: &Shared, out: &mut [Values; NUMBERS]) {
    let shell = shared.shell.map(Each);
    for i in 0..GROUP {
        let (local, motion, noise, y) = group.at(i, shared);
        let shape = linearised(&shell, &local, motion, noise, &y, Each(shared.length), Each(shared.pressure));
        shape.store(i, out);
    }
}

impl Linearised<Each> {
    /// Stores its numbers for point i of a group.
    #[inline(always)]
    fn store<const K: usize>(&self, i: usize, out: &mut [Values; K]) {
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

/// f and the integrand of the volume at all points.
pub(super) fn rhs_many(sweep: &Sweep<'_>, points: CollocationPoints<'_>, p: &[f64], f: &mut [f64], g: &mut [f64]) {
    let (mut group, shared) = (Group::of(sweep), Shared::of(sweep, p));
    let mut out = [[0.0; GROUP]; COMPONENTS + 1];
    let parts = f.chunks_mut(GROUP * COMPONENTS).zip(g.chunks_mut(GROUP));
    for (j, (f, g)) in parts.enumerate() {
        group.read::<COMPONENTS>(sweep, points, j * GROUP);
        evaluate(&group, &shared, &mut out);
        for (i, (f, g)) in f.chunks_exact_mut(COMPONENTS).zip(g).enumerate() {
            for k in 0..COMPONENTS {
                f[k] = out[k][i];
            }
            *g = out[COMPONENTS][i];
        }
    }
}

/// f, g and their derivatives by the components, L, p and the unknowns of `columns` at all points. Entries that are
/// always zero are not written.
pub(super) fn jacobian_many<'a>(
    sweep: &Sweep<'_>,
    points: CollocationPoints<'_>,
    p: &[f64],
    columns: impl Iterator<Item = Column<'a>>,
    out: &mut PointJacobian<'_>,
) {
    let mut columns: Vec<Varied<'a>> = columns.map(Varied::of).collect();
    let (mut group, shared) = (Group::of(sweep), Shared::of(sweep, p));
    let scalars = sweep.scalars;
    let mut numbers = [[0.0; GROUP]; NUMBERS];
    for from in (0..points.x.len()).step_by(GROUP) {
        group.read::<COMPONENTS>(sweep, points, from);
        linearise(&group, &shared, &mut numbers);
        for i in 0..GROUP.min(points.x.len() - from) {
            scatter::<NUMBERS, COMPONENTS>(
                &numbers,
                i,
                shared.length,
                scalars,
                &mut out.at(from + i, COMPONENTS, scalars, 1),
            );
        }
        columns.iter_mut().for_each(|column| column.add(&group, &shared, sweep, points, from, out));
    }
}

/// Writes the numbers of point i of a group to their places.
#[inline]
fn scatter<const K: usize, const N: usize>(
    numbers: &[Values; K],
    i: usize,
    length: f64,
    scalars: usize,
    out: &mut PointJacobian<'_>,
) {
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

/// The arguments of the equations at the points of a group, for a cell with a regulator.
pub(super) struct Regulated {
    shape: Group,
    /// Derivatives of the coefficients by φ.
    by_phi: LocalCoefficients<Values>,
    /// j and φ.
    state: [Values; 2],
    past: Carried<Values>,
}

impl Regulated {
    fn of(sweep: &Sweep<'_>) -> Regulated {
        let shape = Group::of(sweep);
        let by_phi = shape.local.map(|_| [0.0; GROUP]);
        Regulated { shape, by_phi, state: [[0.0; GROUP]; 2], past: Carried::default().map(|_: f64| [0.0; GROUP]) }
    }

    fn read(&mut self, sweep: &Sweep<'_>, points: CollocationPoints<'_>, from: usize, length: f64) {
        self.shape.read::<REGULATED>(sweep, points, from);
        let last = points.x.len() - 1;
        for i in 0..GROUP {
            let point = (from + i).min(last);
            let y = &points.y[point * REGULATED..(point + 1) * REGULATED];
            (self.state[0][i], self.state[1][i]) = (y[J], y[PHI]);
            if sweep.rate != 0.0 {
                let Carried { amount, r_u, z_u } = sweep.carried_past[points.first + point];
                (self.past.amount[i], self.past.r_u[i], self.past.z_u[i]) = (amount, r_u, z_u);
            }
            let painted = *sweep.local.get(point).unwrap_or(&sweep.constants.uniform);
            let (here, by_phi) = sweep.constants.regulated_by_phi(painted, y[PHI], y[J] * length);
            self.shape.local.put(i, here);
            self.by_phi.put(i, by_phi);
        }
    }

    #[inline(always)]
    pub fn at(
        &self,
        i: usize,
        shared: &Shared,
    ) -> (LocalCoefficients<Each>, BdfTerm<Each>, Each, [Each; COMPONENTS], [Each; 2]) {
        let (local, motion, noise, y) = self.shape.at(i, shared);
        let Carried { amount, r_u, z_u } = &self.past;
        let carried_past = Carried { amount: Each(amount[i]), r_u: Each(r_u[i]), z_u: Each(z_u[i]) };
        let motion = BdfTerm { carried_past, ..motion };
        (local, motion, noise, y, [Each(self.state[0][i]), Each(self.state[1][i])])
    }
}

/// f of a cell with a regulator, followed by the integrand of the volume.
#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
fn evaluate_regulated(
    group: &Regulated,
    shared: &Shared,
    transport: Transport<f64>,
    out: &mut [Values; REGULATED + 1],
) {
    let (shell, transport) = (shared.shell.map(Each), transport.map(Each));
    for i in 0..GROUP {
        let (local, motion, noise, y, state) = group.at(i, shared);
        let Balance { f, volume, place } =
            balances(&shell, &local, motion, noise, &y, Each(shared.length), Each(shared.pressure));
        let flux = carried(&transport, local.source, motion, &y, state, &place, Each(shared.length));
        for k in 0..COMPONENTS {
            out[k][i] = f[k].0;
        }
        out[J][i] = flux.0 * shared.length;
        out[PHI][i] = state[0].0 * shared.length;
        out[REGULATED][i] = volume.0;
    }
}

/// Numbers of a [`LinearisedRegulated`].
const NUMBERS_REGULATED: usize = NUMBERS + COMPONENTS + 1 + REGULATED + 2;

/// All numbers of a [`LinearisedRegulated`], beginning with the shape's.
#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
fn linearise_regulated(
    group: &Regulated,
    shared: &Shared,
    transport: Transport<f64>,
    out: &mut [Values; NUMBERS_REGULATED],
) {
    let (shell, transport) = (shared.shell.map(Each), transport.map(Each));
    for i in 0..GROUP {
        let (local, motion, noise, y, state) = group.at(i, shared);
        let here = [&local, &group.by_phi.each(i)];
        let (length, pressure) = (Each(shared.length), Each(shared.pressure));
        let LinearisedRegulated { shape, by_phi, tangential_by_j, carried, carried_by_length } =
            linearised_regulated(&shell, &transport, here, motion, noise, &y, state, length, pressure);
        shape.store(i, out);
        for k in 0..COMPONENTS {
            out[NUMBERS + k][i] = by_phi[k].0;
        }
        out[NUMBERS + COMPONENTS][i] = tangential_by_j.0;
        for k in 0..REGULATED {
            out[NUMBERS + COMPONENTS + 1 + k][i] = carried.1[k].0;
        }
        out[NUMBERS_REGULATED - 2][i] = carried.0.0;
        out[NUMBERS_REGULATED - 1][i] = carried_by_length.0;
    }
}

/// [`rhs_many`] for a cell with a regulator.
pub(super) fn rhs_many_regulated(
    sweep: &Sweep<'_>,
    points: CollocationPoints<'_>,
    p: &[f64],
    f: &mut [f64],
    g: &mut [f64],
) {
    let Some(regulator) = &sweep.constants.regulator else { return };
    let (mut group, shared, transport) = (Regulated::of(sweep), Shared::of(sweep, p), Transport::of(regulator));
    let mut out = [[0.0; GROUP]; REGULATED + 1];
    let parts = f.chunks_mut(GROUP * REGULATED).zip(g.chunks_mut(GROUP));
    for (j, (f, g)) in parts.enumerate() {
        group.read(sweep, points, j * GROUP, shared.length);
        evaluate_regulated(&group, &shared, transport, &mut out);
        for (i, (f, g)) in f.chunks_exact_mut(REGULATED).zip(g).enumerate() {
            for k in 0..REGULATED {
                f[k] = out[k][i];
            }
            *g = out[REGULATED][i];
        }
    }
}

/// [`jacobian_many`] for a cell with a regulator.
pub(super) fn jacobian_many_regulated<'a>(
    sweep: &Sweep<'_>,
    points: CollocationPoints<'_>,
    p: &[f64],
    columns: impl Iterator<Item = Column<'a>>,
    out: &mut PointJacobian<'_>,
) {
    let Some(regulator) = &sweep.constants.regulator else { return };
    let mut columns: Vec<Varied<'a>> = columns.map(Varied::of).collect();
    let (mut group, shared, transport) = (Regulated::of(sweep), Shared::of(sweep, p), Transport::of(regulator));
    let (scalars, length, n) = (sweep.scalars, shared.length, REGULATED);
    let mut numbers = [[0.0; GROUP]; NUMBERS_REGULATED];
    for from in (0..points.x.len()).step_by(GROUP) {
        group.read(sweep, points, from, length);
        linearise_regulated(&group, &shared, transport, &mut numbers);
        for i in 0..GROUP.min(points.x.len() - from) {
            let mut out = out.at(from + i, n, scalars, 1);
            scatter::<NUMBERS_REGULATED, REGULATED>(&numbers, i, length, scalars, &mut out);
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
            let j = group.state[0][i];
            (out.f[PHI], out.fp[PHI * scalars + LENGTH], out.fy[PHI * n + J]) = (length * j, j, length);
        }
        let group = &group;
        columns.iter_mut().for_each(|column| column.add_regulated(group, &shared, transport, sweep, points, from, out));
    }
}
