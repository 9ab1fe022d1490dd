//! Derivatives of the residual: forward differentiation at every point, then summation around each ring and along the
//! meridian.

use multiversion::multiversion;

use crate::law::{BALANCES, Balance, Flow, Geometry, Place, Shape, Vector, balance, by_centre, by_flow, by_pressure};
use crate::linear::Bordered;
use crate::number::Gradient;
use crate::own::Own;
use crate::problem::{MESH_ROW, Problem, State, mesh_entries};
use crate::space::{Meridian, Space, Station};
use crate::splines::LOCAL;

/// Number of inputs of the balance at a point: X and its five derivatives, v and its two, p, x₀ and z₀ of the ring's centre.
const INPUTS: usize = 30;
/// Number of inputs with respect to which the balance is differentiated: X and its derivatives. It is linear in the others.
const SHAPE: usize = 18;
/// Index of the input p.
const PRESSURE: usize = 27;
/// Indices of the inputs x₀ and z₀.
const CENTRE: usize = 28;
/// Number of entries of a balance.
const OUTPUTS: usize = 3 * BALANCES;
/// Number of functions of u for each harmonic: f, f′, f″ of X, then f and f′ of v.
const TRIALS: usize = 5;
/// Number of test functions for each harmonic: f, f′, f″ in the virtual power, and f for the mesh.
const TESTS: usize = 4;

type Dual = Gradient<SHAPE>;

/// Derivatives of the balance at a point, by input.
type Local = [[f64; OUTPUTS]; INPUTS];

#[inline(always)]
fn local(
    place: &Place,
    x: &Shape<f64>,
    v: &Flow<f64>,
    pressure: f64,
    centre: [f64; 2],
    own: Option<&mut Own<Dual>>,
    out: &mut Local,
) {
    let mut carried: Shape<Dual> = [[Dual::from(0.0); 3]; 6];
    for (k, (to, from)) in carried.as_flattened_mut().iter_mut().zip(x.as_flattened()).enumerate() {
        *to = Dual::variable(*from, k);
    }
    let constant = |v: &Vector<f64>| -> Vector<Dual> { [Dual::from(v[0]), Dual::from(v[1]), Dual::from(v[2])] };
    let flow: Flow<Dual> = [constant(&v[0]), constant(&v[1]), constant(&v[2])];
    let balance = balance(place, &carried, &flow, Dual::from(pressure), centre.map(Dual::from), own);
    for (k, value) in balance.as_flattened().iter().enumerate() {
        for input in 0..SHAPE {
            out[input][k] = value.by[input];
        }
    }
    let geometry = Geometry::new(x);
    for input in 0..9 {
        let mut unit: Flow<f64> = [[0.0; 3]; 3];
        unit.as_flattened_mut()[input] = 1.0;
        out[SHAPE + input] = flatten(&by_flow(place, &geometry, x, &unit));
    }
    out[PRESSURE] = flatten(&by_pressure(&geometry));
    for (out, by) in out[CENTRE..].iter_mut().zip(by_centre(place, &geometry)) {
        *out = [0.0; OUTPUTS];
        out[MESH_ROW..].copy_from_slice(&by);
    }
}

fn flatten(balance: &Balance<f64>) -> [f64; OUTPUTS] {
    let mut out = [0.0; OUTPUTS];
    out.copy_from_slice(balance.as_flattened());
    out
}

/// sum + factor · row, in registers.
#[inline(always)]
fn add(sum: &mut [f64; OUTPUTS], factor: f64, row: &[f64; OUTPUTS]) {
    for k in 0..OUTPUTS {
        sum[k] += factor * row[k];
    }
}

/// Sums over a ring.
struct Ring {
    /// Number of harmonics.
    count: usize,
    /// Derivatives at a point by each function: outputs × (trial × harmonic, and p).
    columns: Vec<f64>,
    /// Tested: (test × harmonic) × (trial × harmonic, and p).
    tested: Vec<f64>,
}

impl Ring {
    fn new(count: usize) -> Ring {
        let width = TRIALS * count + 1;
        Ring { count, columns: vec![0.0; OUTPUTS * width], tested: vec![0.0; TESTS * count * width] }
    }

    /// Adds a point.
    #[inline(always)]
    fn add(&mut self, space: &Space, meridian: &Meridian, derivatives: &Local, weight: f64) {
        let count = self.count;
        let width = TRIALS * count + 1;
        let mut column = |at: usize, values: &[f64; OUTPUTS]| {
            for (row, value) in self.columns.chunks_exact_mut(width).zip(values) {
                row[at] = *value;
            }
        };
        let centres = space.centre();
        for (harmonic, entries) in meridian.entries.iter().enumerate() {
            for (trial, (d, first, limit)) in
                [(0, 0, 18), (1, 0, 18), (2, 0, 18), (0, 18, 9), (1, 18, 6)].into_iter().enumerate()
            {
                let mut sum = [0.0; OUTPUTS];
                // Only v, v_u and v_φ occur, no second derivatives of the flow.
                for (k, factor) in entries[d].list().iter().filter(|(k, _)| *k < limit) {
                    add(&mut sum, factor * weight, &derivatives[first + k]);
                }
                if trial == 0 {
                    let of = |(centre, _): &(&Option<usize>, _)| **centre == Some(harmonic);
                    let by = centres.iter().zip(&derivatives[CENTRE..]).filter(of);
                    by.for_each(|(_, by)| add(&mut sum, weight, by));
                }
                column(trial * count + harmonic, &sum);
            }
        }
        column(width - 1, &derivatives[PRESSURE].map(|by| weight * by));
        for harmonic in 0..count {
            let entries = &meridian.entries[harmonic];
            let tests = (0..3).flat_map(|d| entries[d].list().iter().map(move |(k, factor)| (d, *k, *factor)));
            let mesh = mesh_entries(&entries[0]).map(|(k, factor)| (3, MESH_ROW + k, factor));
            for (test, output, factor) in tests.chain(mesh) {
                let from = &self.columns[output * width..][..width];
                let to = &mut self.tested[(test * count + harmonic) * width..][..width];
                to.iter_mut().zip(from).for_each(|(to, from)| *to += factor * from);
            }
        }
    }
}

/// Sums over an element, with rows (spline, mesh or flow, harmonic), columns (spline, X or v, harmonic), and p.
struct Element {
    count: usize,
    matrix: Vec<f64>,
    pressure: Vec<f64>,
    /// One ring multiplied by the splines of the columns.
    trial: Vec<f64>,
}

impl Element {
    fn new(count: usize) -> Element {
        let size = LOCAL * 2 * count;
        Element {
            count,
            matrix: vec![0.0; size * size],
            pressure: vec![0.0; size],
            trial: vec![0.0; TESTS * count * LOCAL * 2 * count],
        }
    }

    /// Adds a ring.
    #[inline(always)]
    fn add(&mut self, station: &Station, tested: &[f64]) {
        let count = self.count;
        let (width, size) = (TRIALS * count + 1, LOCAL * 2 * count);
        for (row, trial) in tested.chunks_exact(width).zip(self.trial.chunks_exact_mut(size)) {
            for (&[b, b_u, b_uu], to) in station.basis.iter().zip(trial.chunks_exact_mut(2 * count)) {
                let (surface, flow) = to.split_at_mut(count);
                let [f, f_u, f_uu, v, v_u] = std::array::from_fn(|trial| &row[trial * count..][..count]);
                for k in 0..count {
                    surface[k] = b * f[k] + b_u * f_u[k] + b_uu * f_uu[k];
                    flow[k] = b * v[k] + b_u * v_u[k];
                }
            }
        }
        for (r, basis) in station.basis.iter().enumerate() {
            for harmonic in 0..count {
                let (mesh, flow) = ((2 * r) * count + harmonic, (2 * r + 1) * count + harmonic);
                for d in 0..3 {
                    let from = &self.trial[(d * count + harmonic) * size..][..size];
                    let to = &mut self.matrix[flow * size..][..size];
                    to.iter_mut().zip(from).for_each(|(to, from)| *to += basis[d] * from);
                    self.pressure[flow] += basis[d] * tested[(d * count + harmonic) * width + width - 1];
                }
                let from = &self.trial[(3 * count + harmonic) * size..][..size];
                let to = &mut self.matrix[mesh * size..][..size];
                to.iter_mut().zip(from).for_each(|(to, from)| *to += basis[0] * from);
            }
        }
    }

    /// Adds the element to the matrix of all unknowns, and clears it.
    fn scatter(&mut self, space: &Space, first: usize, into: &mut Bordered) {
        let count = self.count;
        let size = LOCAL * 2 * count;
        let unknown = |k: usize| space.unknown(first + k / (2 * count), k / count % 2, k % count);
        let unknowns: Vec<Option<usize>> = (0..size).map(unknown).collect();
        for (row, values) in unknowns.iter().zip(self.matrix.chunks_exact(size)) {
            let Some(row) = row else { continue };
            for (column, value) in unknowns.iter().zip(values) {
                if let Some(column) = column {
                    into.add(*row, *column, *value);
                }
            }
        }
        for k in (0..size).filter(|k| k / count % 2 == 1) {
            if let Some(row) = unknowns[k] {
                into.borders[0].column[row] += self.pressure[k];
            }
            // The volume increases by ∫ n·δX dA, which is minus the coefficient of p.
            if let Some(column) = unknowns[k - count] {
                into.borders[0].row[column] -= self.pressure[k];
            }
        }
        self.matrix.fill(0.0);
        self.pressure.fill(0.0);
    }
}

impl Problem {
    /// Derivatives of the residual at a state: balances by unknowns, the pressure last, and the volume in the last row. The
    /// dependence of the cue's position on the surface is neglected.
    pub fn jacobian(&self, state: &State) -> Bordered {
        let mut out = Bordered::zeros(&self.space.blocks);
        assemble(self, state, &mut out);
        out
    }
}

#[multiversion(targets("x86_64+avx+avx2+fma", "aarch64+neon"))]
fn assemble(problem: &Problem, state: &State, out: &mut Bordered) {
    let space = &problem.space;
    let count = space.harmonics.len();
    let (mut ring, mut element) = (Ring::new(count), Element::new(count));
    let mut derivatives = [[0.0; OUTPUTS]; INPUTS];
    let mut own = Own::of(&problem.constants);
    let last = space.meridians.len() - 1;
    problem.for_each_point(state, |q, j, place, x, v, centre| {
        let station = &space.stations[q];
        local(place, x, v, state.pressure, centre, own.as_mut(), &mut derivatives);
        ring.add(space, &space.meridians[j], &derivatives, station.weight * space.meridian_weight());
        if j == last {
            element.add(station, &ring.tested);
            ring.tested.fill(0.0);
            if space.stations.get(q + 1).is_none_or(|next| next.element != station.element) {
                element.scatter(space, station.element, out);
            }
        }
    });
}
