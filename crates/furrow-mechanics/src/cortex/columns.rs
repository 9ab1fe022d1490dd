//! ∂f/∂p for scalar unknowns that enter through the coefficients of the equations: free parameters, and the length of
//! the contour through the cue's widths.

use furrow_bvp::{CollocationPoints, PointJacobian};
use multiversion::multiversion;
use num_dual::Dual64;

use super::coefficients::COEFFICIENTS;
use super::equations::{COMPONENTS, Constants, J, PHI, PSI, Q, REGULATED, ShellCoefficients, T, Transport, V};
use super::jacobian::{varied, varied_flux};
use super::lanes::Lane;
use super::sweep::{GROUP, Group, Shared, Sweep, Values, lanes, put};

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
    local: [Values; COEFFICIENTS],
    shell: ShellCoefficients<f64>,
    transport: Transport<f64>,
}

impl<'a> Varied<'a> {
    pub fn of(column: Column<'a>) -> Varied<'a> {
        let Constants { uniform, shell, regulator, .. } = column.constants;
        let transport = regulator.as_ref().map(|regulator| Transport::of(regulator).map(|value| value.eps));
        Varied {
            column,
            local: uniform.into_array().map(|value| [value.eps; GROUP]),
            shell: shell.map(|value| value.eps),
            transport: transport.unwrap_or_default(),
        }
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
            put(&mut self.local, i, here.map(|value| value.eps).into_array());
        }
    }

    /// Adds the column at the points of a group.
    pub fn add<const N: usize>(
        &mut self,
        group: &Group<N>,
        shared: &Shared,
        sweep: &Sweep<'_>,
        points: CollocationPoints<'_>,
        from: usize,
        out: &mut PointJacobian<'_>,
    ) {
        self.read::<N>(sweep, points, from);
        let mut column = [[0.0; GROUP]; N];
        vary(group, self, shared, &mut column);
        let places = out.fp[from * N * sweep.scalars..].chunks_exact_mut(N * sweep.scalars);
        for (i, fp) in places.take(GROUP).enumerate() {
            for k in [PSI, Q, V, T, J].into_iter().filter(|k| *k < N) {
                fp[k * sweep.scalars + self.column.scalar] += column[k][i];
            }
        }
    }
}

/// The column at the points of a group.
#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
fn vary<const N: usize>(group: &Group<N>, by: &Varied<'_>, shared: &Shared, out: &mut [Values; N]) {
    let shell = [shared.shell.map(Lane), by.shell.map(Lane)];
    let transport = [shared.transport.map(Lane), by.transport.map(Lane)];
    let (length, pressure) = (Lane(shared.length), Lane(shared.pressure));
    for i in 0..GROUP {
        let (local, motion, noise, y, state) = group.at(i, shared);
        let by = lanes(&by.local, i).into();
        let (f, strain, place) = varied(&shell, [&local, &by], motion, noise, &y, length, pressure);
        for k in 0..COMPONENTS {
            out[k][i] = f[k].0;
        }
        if N == REGULATED {
            let source = [local.source, by.source];
            out[J][i] = varied_flux(&transport, source, motion, &y, state, &place, strain, length).0 * shared.length;
        }
    }
}
