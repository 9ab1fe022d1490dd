//! The equations at many collocation points side by side.
//!
//! Points go through in groups of eight, quantity by quantity, so that one loop over a group evaluates [`balances`] or
//! [`linearised`] for [`Each`] of them, and becomes vector code for whatever instructions the machine has. No sum is reordered
//! and no multiply–add fused: the results are the same on all of them.

use furrow_bvp::{CollocationPoints, PointJacobian};
use multiversion::multiversion;

use super::equations::{
    BdfTerm, COMPONENTS, Constants, LENGTH, LocalCoefficients, M, PRESSURE, PSI, Q, R, ShellCoefficients, T, V, Z,
    balances,
};
use super::jacobian::{Linearised, linearised};
use super::lanes::Each;

/// What a sweep reads of the problem.
pub(super) struct Sweep<'a> {
    /// The constants.
    pub constants: &'a Constants<f64>,
    /// 1/Δt of the implicit step; 0 for stationary shapes.
    pub rate: f64,
    /// Past (r, z) at every collocation point.
    pub past: &'a [[f64; 2]],
    /// Factor on the activity at every collocation point; empty for none.
    pub noise: &'a [f64],
    /// The coefficients at the points of the sweep; empty without a cue.
    pub local: &'a [LocalCoefficients<f64>],
    /// Number of scalar unknowns.
    pub scalars: usize,
}

/// Points of a group.
const GROUP: usize = 8;

/// A quantity at the points of a group.
type Values = [f64; GROUP];

/// What the equations read at the points of a group.
struct Group {
    y: [Values; COMPONENTS],
    local: LocalCoefficients<Values>,
    past: [Values; 2],
    noise: Values,
}

/// What is the same at all points.
#[derive(Clone, Copy)]
struct Shared {
    shell: ShellCoefficients<f64>,
    rate: f64,
    length: f64,
    pressure: f64,
}

impl Group {
    /// A group of a cell without a cue, and without motion and noise.
    fn of(sweep: &Sweep<'_>) -> Group {
        let local = sweep.constants.uniform.map(|value| [value; GROUP]);
        Group { y: [[0.0; GROUP]; COMPONENTS], local, past: [[0.0; GROUP]; 2], noise: [1.0; GROUP] }
    }

    /// Reads the group that starts at point `from`; behind the last point it is repeated.
    fn read(&mut self, sweep: &Sweep<'_>, points: CollocationPoints<'_>, from: usize) {
        let last = points.x.len() - 1;
        for i in 0..GROUP {
            let point = (from + i).min(last);
            let y = &points.y[point * COMPONENTS..(point + 1) * COMPONENTS];
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
    fn at(&self, i: usize, shared: &Shared) -> (LocalCoefficients<Each>, BdfTerm<Each>, Each, [Each; COMPONENTS]) {
        let motion = BdfTerm { rate: Each(shared.rate), r_past: Each(self.past[0][i]), z_past: Each(self.past[1][i]) };
        (self.local.each(i), motion, Each(self.noise[i]), std::array::from_fn(|k| Each(self.y[k][i])))
    }
}

impl LocalCoefficients<Values> {
    fn put(&mut self, i: usize, here: LocalCoefficients<f64>) {
        self.kappa[i] = here.kappa;
        self.kappa_u[i] = here.kappa_u;
        self.eta_sum[i] = here.eta_sum;
        self.eta_difference[i] = here.eta_difference;
        self.friction[i] = here.friction;
        self.tension[i] = here.tension;
        self.tension_u[i] = here.tension_u;
        self.xi_s[i] = here.xi_s;
        self.xi_b[i] = here.xi_b;
    }

    #[inline(always)]
    fn each(&self, i: usize) -> LocalCoefficients<Each> {
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
        }
    }
}

impl Shared {
    fn of(sweep: &Sweep<'_>, p: &[f64]) -> Shared {
        let shell = sweep.constants.shell;
        Shared { shell, rate: sweep.rate, length: p[LENGTH], pressure: p[PRESSURE] }
    }
}

/// f, and behind it the integrand of the volume.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx+avx2", "aarch64+neon"))]
fn evaluate(group: &Group, shared: &Shared, out: &mut [Values; COMPONENTS + 1]) {
    let shell = shared.shell.map(Each);
    for i in 0..GROUP {
        let (local, motion, noise, y) = group.at(i, shared);
        let (f, volume) = balances(&shell, &local, motion, noise, &y, Each(shared.length), Each(shared.pressure));
        for k in 0..COMPONENTS {
            out[k][i] = f[k].0;
        }
        out[COMPONENTS][i] = volume.0;
    }
}

/// Numbers of a [`Linearised`].
const NUMBERS: usize = 5 * COMPONENTS + 9;

/// All numbers of a [`Linearised`], in the order of its fields.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx+avx2", "aarch64+neon"))]
fn linearise(group: &Group, shared: &Shared, out: &mut [Values; NUMBERS]) {
    let shell = shared.shell.map(Each);
    for i in 0..GROUP {
        let (local, motion, noise, y) = group.at(i, shared);
        let Linearised { f, by_length, geometry, turning, normal, flow, tangential, volume } =
            linearised(&shell, &local, motion, noise, &y, Each(shared.length), Each(shared.pressure));
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
        group.read(sweep, points, j * GROUP);
        evaluate(&group, &shared, &mut out);
        for (i, (f, g)) in f.chunks_exact_mut(COMPONENTS).zip(g).enumerate() {
            for k in 0..COMPONENTS {
                f[k] = out[k][i];
            }
            *g = out[COMPONENTS][i];
        }
    }
}

/// f, g and their derivatives by the components, L and p at all points, but for what widths in L_h add to ∂f/∂L. What is zero
/// is left as it is.
pub(super) fn jacobian_many(sweep: &Sweep<'_>, points: CollocationPoints<'_>, p: &[f64], out: &mut PointJacobian<'_>) {
    let (mut group, shared) = (Group::of(sweep), Shared::of(sweep, p));
    let scalars = sweep.scalars;
    let mut numbers = [[0.0; GROUP]; NUMBERS];
    for from in (0..points.x.len()).step_by(GROUP) {
        group.read(sweep, points, from);
        linearise(&group, &shared, &mut numbers);
        for i in 0..GROUP.min(points.x.len() - from) {
            scatter(&numbers, i, shared.length, scalars, &mut out.at(from + i, COMPONENTS, scalars, 1));
        }
    }
}

/// Puts the numbers of point i of a group into their places.
#[inline]
fn scatter(numbers: &[Values; NUMBERS], i: usize, length: f64, scalars: usize, out: &mut PointJacobian<'_>) {
    let n = COMPONENTS;
    let number = |k: usize| numbers[k][i];
    for k in 0..n {
        out.f[k] = number(k);
        out.fp[k * scalars + LENGTH] = number(n + k);
        out.fy[Q * n + k] = number(2 * n + k);
        out.fy[V * n + k] = number(3 * n + k);
        out.fy[T * n + k] = number(4 * n + k);
    }
    out.fp[Q * scalars + PRESSURE] = -length;
    (out.fy[R * n + PSI], out.fy[Z * n + PSI], out.fy[M * n + Q]) = (number(5 * n), number(5 * n + 1), length);
    for (k, component) in [R, M, PSI].into_iter().enumerate() {
        out.fy[PSI * n + component] = number(5 * n + 2 + k);
    }
    let [volume, by_r, by_psi, by_length] = [5, 6, 7, 8].map(|k| number(5 * n + k));
    (out.g[0], out.gy[R], out.gy[PSI], out.gp[LENGTH]) = (volume, by_r, by_psi, by_length);
}
