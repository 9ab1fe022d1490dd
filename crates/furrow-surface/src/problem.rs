//! The discrete problem of one cell: residuals of the balances for all test fields.

use furrow_bvp::Gauss;
use furrow_cell::Cell;
use furrow_mechanics::cortex::equations::{Constants, LocalCoefficients, ShellCoefficients};

use crate::law::{Balance, Contact, Flow, Place, Shape, Vector, balance};
use crate::mesh::Mesh;
use crate::own::Own;
use crate::plane::Plates;
use crate::space::{Entries, Meridian, POINTS, Space, Station};

/// Surface, flow and pressure.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Coefficients of X; spline × harmonic.
    pub surface: Vec<f64>,
    /// Coefficients of v; spline × harmonic.
    pub flow: Vec<f64>,
    /// Pressure p, in κ0/L_h³.
    pub pressure: f64,
}

/// The motion of the surface in an implicit step, ∂_tX = rate·X + past.
#[derive(Clone, Debug, Default)]
pub struct Motion {
    /// Leading coefficient, in 1/τ; 0 for stationary surfaces.
    pub rate: f64,
    /// Coefficients of `past`; empty if `rate` = 0.
    pub past: Vec<f64>,
}

/// The residual: one value for each unknown, and the excess of volume.
#[derive(Clone, Debug, PartialEq)]
pub struct Residual {
    /// Balances, by unknown.
    pub balances: Vec<f64>,
    /// Volume minus the cell's volume, in L_h³.
    pub volume: f64,
}

/// The problem of one cell in its function space.
#[derive(Clone, Debug)]
pub struct Problem {
    /// The function space.
    pub space: Space,
    /// Constants of the cell.
    pub constants: Constants<f64>,
    /// Factors by which plates change 1/x², 1/y², 1/z² for the half-axes of a round shell.
    pub plates: Vector<f64>,
    /// The distribution of the mesh.
    pub mesh: Mesh,
    /// Drag of the mesh, in τ/L_h² at viscosity 1, which sets how fast it follows its target distribution; 0 for stationary surfaces.
    pub drag: f64,
    /// Motion of the surface.
    pub motion: Motion,
    /// Factor of the activity by station × meridian; empty if it is 1.
    pub noise: Vec<f64>,
    /// Walls in contact with points, by station × meridian; empty without contact.
    pub contacts: Vec<Contact>,
    gauss: Gauss,
}

impl Problem {
    /// The stationary problem of a cell.
    pub fn new(cell: &Cell, space: Space) -> Problem {
        Problem {
            mesh: Mesh::uniform(&space),
            space,
            plates: Plates::Beside.factors(cell.shell.flattening),
            constants: Constants::new(cell, |_, value| value),
            motion: Motion::default(),
            drag: 0.0,
            noise: Vec::new(),
            contacts: Vec::new(),
            gauss: Gauss::new(POINTS).unwrap_or_default(),
        }
    }

    /// 1/x², 1/y², 1/z² for the half-axes of the shell, S.7, in 1/L_h².
    pub fn inverse_axes2(&self) -> Vector<f64> {
        let ShellCoefficients { inverse_a2, inverse_b2, .. } = self.constants.shell;
        let [x, y, z] = self.plates;
        [x * inverse_b2, y * inverse_b2, z * inverse_a2]
    }

    /// The weights of the mesh for a surface near the solution.
    pub fn spread(&mut self, surface: &[f64]) {
        let (_, length) = self.speeds(surface);
        self.mesh.follow(&self.space, surface, length, self.viscosity());
    }

    /// The larger of the viscosities η_b and η_s, by which times scale.
    pub fn viscosity(&self) -> f64 {
        let uniform = &self.constants.uniform;
        0.5 * (uniform.eta_sum + uniform.eta_difference.abs())
    }

    /// The volume inside a surface, in L_h³.
    pub fn volume(&self, surface: &[f64]) -> f64 {
        let space = &self.space;
        let mut functions = Vec::new();
        let mut volume = 0.0;
        for station in &space.stations {
            space.functions(surface, station, &mut functions);
            let ring = space.meridians.iter().map(|meridian| volume_density(&space.shape(&functions, meridian)));
            volume += ring.sum::<f64>() * station.weight * space.meridian_weight();
        }
        volume
    }

    /// Contour length L of the mean meridian, in L_h.
    pub fn contour_length(&self, surface: &[f64]) -> f64 {
        self.speeds(surface).1
    }

    /// The quantities at a fraction of the contour, without motion.
    pub fn place_at(&self, share: f64, length: f64) -> Place {
        Place {
            local: self.constants.at(share, length),
            shell: self.constants.shell,
            inverse_axes2: self.inverse_axes2(),
            along: self.constants.law.as_ref().map_or([0.0; 2], |law| law.along(share, length)),
            noise: 1.0,
            rate: 0.0,
            past: [0.0; 3],
            mesh: [0.0; 4],
            drag: 0.0,
            contact: Contact::default(),
        }
    }

    /// The arclength of the mean meridian.
    pub fn mean_meridian(&self, surface: &[f64]) -> MeanMeridian {
        let (speeds, length) = self.speeds(surface);
        let shares = self.shares(&speeds, length);
        MeanMeridian { shares: self.space.stations.iter().map(|station| station.u).zip(shares).collect(), length }
    }

    /// The mean over meridians of |X_u| at every station, and the contour length L of the mean meridian.
    pub fn speeds(&self, surface: &[f64]) -> (Vec<f64>, f64) {
        let space = &self.space;
        let mut functions = Vec::new();
        let mut length = 0.0;
        let speed = |station: &Station| {
            space.functions(surface, station, &mut functions);
            let norm = |meridian: &Meridian| {
                let [_, x_u, ..] = space.shape(&functions, meridian);
                (x_u[0] * x_u[0] + x_u[1] * x_u[1] + x_u[2] * x_u[2]).sqrt()
            };
            let mean = space.meridians.iter().map(norm).sum::<f64>() / space.meridians.len() as f64;
            length += mean * station.weight;
            mean
        };
        (space.stations.iter().map(speed).collect(), length)
    }

    /// The fraction of the contour from the pole u = 0 to every station, by the arclength of the mean meridian.
    pub fn shares(&self, speeds: &[f64], length: f64) -> Vec<f64> {
        let m = self.gauss.m;
        let width = 1.0 / (self.space.elements as f64 * length);
        let mut before = 0.0;
        let mut out = Vec::with_capacity(speeds.len());
        for element in speeds.chunks_exact(m) {
            let until = |q: usize| (0..m).map(|k| self.gauss.a[q * m + k] * element[k]).sum::<f64>() * width;
            out.extend((0..m).map(|q| before + until(q)));
            before += (0..m).map(|k| self.gauss.b[k] * element[k]).sum::<f64>() * width;
        }
        out
    }

    /// Coefficients of the equations at every station, or at every station × meridian for a one-sided cue.
    fn coefficients(&self, surface: &[f64]) -> Vec<LocalCoefficients<f64>> {
        if !self.constants.vary() {
            return vec![self.constants.uniform; self.space.stations.len()];
        }
        let (speeds, length) = self.speeds(surface);
        if self.constants.is_one_sided() {
            let around =
                |share| self.space.meridians.iter().map(move |of| self.constants.beside(share, of.phi, length));
            return self.shares(&speeds, length).into_iter().flat_map(around).collect();
        }
        let at = |(share, speed): (f64, f64)| {
            let mut local = self.constants.at(share, length);
            // The derivative is with respect to the mesh's coordinate.
            local.kappa_u *= speed / length;
            local.tension_u *= speed / length;
            local
        };
        self.shares(&speeds, length).into_iter().zip(speeds).map(at).collect()
    }

    /// u and s at every station if a user-defined law uses them; otherwise empty.
    fn along(&self, surface: &[f64]) -> Vec<[f64; 2]> {
        let Some(law) = self.constants.law.as_ref().filter(|law| law.placed) else { return Vec::new() };
        let (speeds, length) = self.speeds(surface);
        self.shares(&speeds, length).into_iter().map(|share| law.along(share, length)).collect()
    }

    fn place(
        &self,
        q: usize,
        j: usize,
        (local, along): (LocalCoefficients<f64>, [f64; 2]),
        past: &[[f64; 3]],
    ) -> Place {
        let index = q * self.space.meridians.len() + j;
        let past = if past.is_empty() { [0.0; 3] } else { self.space.shape(past, &self.space.meridians[j])[0] };
        Place {
            local,
            shell: self.constants.shell,
            inverse_axes2: self.inverse_axes2(),
            along,
            noise: self.noise.get(index).copied().unwrap_or(1.0),
            rate: self.motion.rate,
            past,
            mesh: self.mesh.weights[q],
            drag: self.drag,
            contact: self.contacts.get(index).copied().unwrap_or_default(),
        }
    }

    /// Calls `each` at every point of the quadrature with its station, meridian, place, surface, flow and the
    /// centre x₀, z₀ of its ring.
    #[inline(always)]
    pub fn for_each_point(
        &self,
        state: &State,
        mut each: impl FnMut(usize, usize, &Place, &Shape<f64>, &Flow<f64>, [f64; 2]),
    ) {
        let space = &self.space;
        let coefficients = self.coefficients(&state.surface);
        let around = coefficients.len() / space.stations.len();
        let along = self.along(&state.surface);
        let [mut surface, mut flow, mut past] = [const { Vec::new() }; 3];
        for (q, station) in space.stations.iter().enumerate() {
            space.functions(&state.surface, station, &mut surface);
            space.functions(&state.flow, station, &mut flow);
            if !self.motion.past.is_empty() {
                space.functions(&self.motion.past, station, &mut past);
            }
            let centre = space.centre().map(|of| of.map_or(0.0, |of| surface[of][0]));
            for (j, meridian) in space.meridians.iter().enumerate() {
                let x = space.shape(&surface, meridian);
                let [v, v_u, v_p, ..] = space.shape(&flow, meridian);
                let local = coefficients[q * around + if around > 1 { j } else { 0 }];
                let along = along.get(q).copied().unwrap_or_default();
                each(q, j, &self.place(q, j, (local, along), &past), &x, &[v, v_u, v_p], centre);
            }
        }
    }

    /// The residual at a state.
    pub fn residual(&self, state: &State) -> Residual {
        let space = &self.space;
        let count = space.harmonics.len();
        let mut out = Residual { balances: vec![0.0; space.unknowns()], volume: -self.constants.volume };
        // Test functions at a station: f, f′, f″ for the flow, and f for the mesh.
        let mut tested = vec![0.0; 4 * count];
        let last = space.meridians.len() - 1;
        let mut own = Own::of(&self.constants);
        self.for_each_point(state, |q, j, place, x, v, centre| {
            let station = &space.stations[q];
            let weight = station.weight * space.meridian_weight();
            let balance = balance(place, x, v, state.pressure, centre, own.as_mut());
            out.volume += weight * volume_density(x);
            test(space, &space.meridians[j], &balance, weight, &mut tested);
            if j == last {
                scatter(space, station, &tested, &mut out.balances);
                tested.fill(0.0);
            }
        });
        out
    }
}

/// ⅓ X·(X_u × X_φ), which integrates to the volume.
pub fn volume_density(x: &Shape<f64>) -> f64 {
    let [x, u, p, ..] = x;
    let across = [u[1] * p[2] - u[2] * p[1], u[2] * p[0] - u[0] * p[2], u[0] * p[1] - u[1] * p[0]];
    (x[0] * across[0] + x[1] * across[1] + x[2] * across[2]) / 3.0
}

/// Adds the balance at a point, tested with every harmonic.
fn test(space: &Space, meridian: &Meridian, balance: &Balance<f64>, weight: f64, tested: &mut [f64]) {
    let count = space.harmonics.len();
    let flat = balance.as_flattened();
    for harmonic in 0..count {
        let entries = &meridian.entries[harmonic];
        for (d, entries) in entries.iter().enumerate() {
            let sum: f64 = entries.list().iter().map(|(k, factor)| flat[*k] * factor).sum();
            tested[d * count + harmonic] += weight * sum;
        }
        let sum: f64 = mesh_entries(&entries[0]).map(|(k, factor)| flat[MESH_ROW + k] * factor).sum();
        tested[3 * count + harmonic] += weight * sum;
    }
}

/// The index in a [`Balance`] at which the part of the mesh starts.
pub(crate) const MESH_ROW: usize = 18;

/// The entries of the field itself, without derivatives with respect to φ.
pub(crate) fn mesh_entries(entries: &Entries) -> impl Iterator<Item = (usize, f64)> {
    entries.list().iter().copied().filter(|(k, _)| *k < 3)
}

/// Adds the contribution of a station to the residual.
fn scatter(space: &Space, station: &Station, tested: &[f64], balances: &mut [f64]) {
    let count = space.harmonics.len();
    for (r, basis) in station.basis.iter().enumerate() {
        for harmonic in 0..count {
            if let Some(row) = space.unknown(station.element + r, 1, harmonic) {
                balances[row] += (0..3).map(|d| basis[d] * tested[d * count + harmonic]).sum::<f64>();
            }
            if let Some(row) = space.unknown(station.element + r, 0, harmonic) {
                balances[row] += basis[0] * tested[3 * count + harmonic];
            }
        }
    }
}

/// The arclength of the mean meridian, interpolated linearly between the stations.
#[derive(Clone, Debug, PartialEq)]
pub struct MeanMeridian {
    /// Coordinate u of the mesh and fraction of the length from the pole u = 0, by station.
    shares: Vec<(f64, f64)>,
    /// Its length, in L_h.
    pub length: f64,
}

impl MeanMeridian {
    /// The fraction of the length from the pole u = 0 to a coordinate u of the mesh.
    pub fn share_at(&self, u: f64) -> f64 {
        self.interpolated(u, |at| at)
    }

    /// The coordinate u of the mesh at a fraction of the length.
    pub fn u_at(&self, share: f64) -> f64 {
        self.interpolated(share, |(u, share)| (share, u))
    }

    fn interpolated(&self, x: f64, axes: impl Fn((f64, f64)) -> (f64, f64)) -> f64 {
        let k = self.shares.partition_point(|at| axes(*at).0 < x).clamp(1, self.shares.len() - 1);
        let [(x0, y0), (x1, y1)] = [self.shares[k - 1], self.shares[k]].map(axes);
        y0 + (x - x0) / (x1 - x0) * (y1 - y0)
    }
}
