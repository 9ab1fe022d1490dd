//! ∂f/∂p for scalar unknowns that enter through the coefficients of the equations: free parameters, and the length of
//! the contour through the cue's widths.

use furrow_bvp::{CollocationPoints, PointJacobian};
use multiversion::multiversion;
use num_dual::Dual64;

use super::equations::{
    COMPONENTS, Constants, J, LocalCoefficients, PHI, PSI, Q, REGULATED, ShellCoefficients, T, Transport, V,
};
use super::jacobian::{varied, varied_flux};
use super::lanes::Each;
use super::sweep::{GROUP, Group, Regulated, Shared, Sweep, Values};

/// A scalar unknown, and the derivatives of the coefficients by it.
#[derive(Clone, Copy)]
pub(super) struct Column<'a> {
    /// Its index among the scalar unknowns.
    pub scalar: usize,
    /// The constants with their derivatives by the unknown.
    pub constants: &'a Constants<Dual64>,
    /// The length of the contour, with its derivative if the unknown is the length in the cue's widths.
    pub length: Dual64,
    /// Whether the cue's profiles depend on the unknown.
    pub paints: bool,
}

/// Derivatives of the equations by one unknown at the points of a group.
pub(super) struct Varied<'a> {
    column: Column<'a>,
    local: LocalCoefficients<Values>,
    shell: ShellCoefficients<f64>,
}

impl<'a> Varied<'a> {
    pub fn of(column: Column<'a>) -> Varied<'a> {
        let Constants { uniform, shell, .. } = column.constants;
        Varied { column, local: uniform.map(|value| [value.eps; GROUP]), shell: shell.map(|value| value.eps) }
    }

    /// Derivatives of the coefficients at the group that starts at point `from`.
    fn read<const N: usize>(&mut self, sweep: &Sweep<'_>, points: CollocationPoints<'_>, from: usize) {
        let Column { constants, length, paints, .. } = self.column;
        if !constants.vary() && N != REGULATED {
            return;
        }
        let each = sweep.profiles.len() / points.x.len();
        for (i, &x) in points.x[from..].iter().take(GROUP).enumerate() {
            let known = || sweep.profiles[(from + i) * each..][..each].iter().map(|f| f.map(Dual64::from_re));
            let mut here = if paints || each == 0 { constants.at(x, length) } else { constants.painted(known()) };
            if N == REGULATED {
                let y = &points.y[(from + i) * N..][..N];
                here = constants.regulated(here, y[PHI].into(), (y[J] * length.re).into());
            }
            self.local.put(i, here.map(|value| value.eps));
        }
    }

    /// Adds the column at the points of a group.
    pub fn add(
        &mut self,
        group: &Group,
        shared: &Shared,
        sweep: &Sweep<'_>,
        points: CollocationPoints<'_>,
        from: usize,
        out: &mut PointJacobian<'_>,
    ) {
        self.read::<COMPONENTS>(sweep, points, from);
        let mut column = [[0.0; GROUP]; COMPONENTS];
        vary(group, self, shared, &mut column);
        self.scatter(&column, [PSI, Q, V, T], sweep, from, out);
    }

    /// [`add`](Self::add) for a cell with a regulator.
    pub fn add_regulated(
        &mut self,
        group: &Regulated,
        shared: &Shared,
        transport: Transport<f64>,
        sweep: &Sweep<'_>,
        points: CollocationPoints<'_>,
        from: usize,
        out: &mut PointJacobian<'_>,
    ) {
        self.read::<REGULATED>(sweep, points, from);
        let Some(regulator) = &self.column.constants.regulator else { return };
        let by = Transport::of(regulator).map(|value| value.eps);
        let mut column = [[0.0; GROUP]; REGULATED];
        vary_regulated(group, self, shared, [transport, by], &mut column);
        self.scatter(&column, [PSI, Q, V, T, J], sweep, from, out);
    }

    fn scatter<const N: usize, const K: usize>(
        &self,
        column: &[Values; N],
        rows: [usize; K],
        sweep: &Sweep<'_>,
        from: usize,
        out: &mut PointJacobian<'_>,
    ) {
        let places = out.fp[from * N * sweep.scalars..].chunks_exact_mut(N * sweep.scalars);
        for (i, fp) in places.take(GROUP).enumerate() {
            for k in rows {
                fp[k * sweep.scalars + self.column.scalar] += column[k][i];
            }
        }
    }
}

/// The column for a cell without a regulator.
#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
fn vary(group: &Group, by: &Varied<'_>, shared: &Shared, out: &mut [Values; COMPONENTS]) {
    let shell = [shared.shell.map(Each), by.shell.map(Each)];
    for i in 0..GROUP {
        let (local, motion, noise, y) = group.at(i, shared);
        let here = [&local, &by.local.each(i)];
        let (f, ..) = varied(&shell, here, motion, noise, &y, Each(shared.length), Each(shared.pressure));
        for k in 0..COMPONENTS {
            out[k][i] = f[k].0;
        }
    }
}

/// The column for a cell with a regulator.
#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
fn vary_regulated(
    group: &Regulated,
    by: &Varied<'_>,
    shared: &Shared,
    transport: [Transport<f64>; 2],
    out: &mut [Values; REGULATED],
) {
    let (shell, transport) = ([shared.shell.map(Each), by.shell.map(Each)], transport.map(|c| c.map(Each)));
    for i in 0..GROUP {
        let (local, motion, noise, y, state) = group.at(i, shared);
        let by = by.local.each(i);
        let (length, pressure) = (Each(shared.length), Each(shared.pressure));
        let (f, strain, place) = varied(&shell, [&local, &by], motion, noise, &y, length, pressure);
        let flux = varied_flux(&transport, [local.source, by.source], motion, &y, state, &place, strain, length);
        for k in 0..COMPONENTS {
            out[k][i] = f[k].0;
        }
        out[J][i] = flux.0 * shared.length;
    }
}
