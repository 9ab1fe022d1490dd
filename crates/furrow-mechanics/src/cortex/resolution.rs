//! The mesh monitor, which determines where a mesh is fine.

use furrow_bvp::{CollocationPoint, Solution};

use super::Cortex;
use super::coefficients::CoefficientCache;
use super::equations::{J, LENGTH, PHI, PSI, R, REGULATED};

/// Floor added to the mesh monitor everywhere, as a fraction of its mean.
const FLOOR: f64 = 0.3;
/// Growth of the interval width per interval that the monitor allows.
const GRADING: f64 = 1.0;

/// Weight of a cue's slope relative to the turning of the contour.
const CUE: f64 = 10.0;

/// Weight of a regulator's slope relative to the turning of the contour.
const REGULATOR: f64 = 0.4;

/// Steepness of the cue in an interval, summed over its terms with their amplitudes relative to the field. Steep places
/// between the collocation points count however narrow they are, so that the mesh resolves the narrowest term.
fn steepest(cortex: &Cortex, from: f64, to: f64, length: f64) -> f64 {
    let term = |term: &furrow_cell::cue::Term| {
        let amplitude = term.amplitude.abs();
        CUE * amplitude / (1.0 + amplitude) * term.profile.steepest(from, to, length)
    };
    let source = cortex.constants().source();
    let sourced = source.map_or(0.0, |source| {
        let amplitude = source.amplitude.abs();
        CUE * amplitude / (1.0 + amplitude) * source.profile.steepest(from, to, length)
    });
    cortex.constants().cue.iter().map(term).sum::<f64>() + sourced
}

/// Steepness of the regulator at a point of state `y`, relative to the turning of the contour.
fn gradient(y: &[f64], length: f64) -> f64 {
    if y.len() == REGULATED { REGULATOR * length * y[J].abs() / (1.0 + y[PHI].abs()) } else { 0.0 }
}

/// Where a monitor evaluates the cue of a cell: the coefficients there and the steepness of the intervals change only with the mesh.
#[derive(Default)]
pub struct Places {
    u: Vec<f64>,
    coefficients: Option<CoefficientCache>,
    /// Empty without a cue.
    steepness: Vec<f64>,
}

/// Mesh monitor per interval, N.7: turning of the contour |c1| + |c2| and the slopes of the cue and the regulator, plus
/// a floor of three tenths of their mean, so that no region is left empty. `symmetric` averages it with its mirror
/// image on a mirror-symmetric mesh. `places` belong to one cell.
pub fn monitor(cortex: &Cortex, y: &Solution, symmetric: bool, places: &mut Places, weight: &mut Vec<f64>) {
    let (length, constants) = (y.scalars[LENGTH], cortex.constants());
    let end = y.mesh[y.intervals()] - y.mesh[0];
    weight.clear();
    let Places { u, coefficients, steepness } = places;
    u.clear();
    for x in y.mesh.windows(2) {
        u.extend((0..y.m).map(|j| x[0] + (x[1] - x[0]) * (j as f64 + 0.5) / y.m as f64));
    }
    let cache = coefficients.get_or_insert_with(|| cortex.coefficient_cache());
    if constants.vary() && !cache.holds(u, length) {
        cache.prepare(constants, u, length);
        steepness.clear();
        steepness.extend(y.mesh.windows(2).map(|x| steepest(cortex, x[0], x[1], length)));
    }
    let mut reader = constants.reader();
    for i in 0..y.intervals() {
        let (mut largest, mut carried): (f64, f64) = (0.0, 0.0);
        for j in 0..y.m {
            let (index, s) = (i * y.m + j, y.stage(i, j));
            let c2 = s[PSI].sin() / s[R];
            let here = cache.at(constants, CollocationPoint { x: u[index], index }, length);
            let here = constants.in_state(here, s, length);
            let c1 = reader.mean_curvature(u[index], &here, s, length)[0] - c2;
            largest = largest.max(length * (c1.abs() + c2.abs()));
            carried = carried.max(gradient(s, length));
        }
        weight.push(largest + steepness.get(i).map_or(carried, |steepness| steepness.max(carried)));
    }
    if symmetric {
        let n = weight.len();
        for i in 0..n / 2 {
            let both = 0.5 * (weight[i] + weight[n - 1 - i]);
            (weight[i], weight[n - 1 - i]) = (both, both);
        }
    }
    spread(&y.mesh, end, weight);
}

/// Adds the floor to the weights and smooths the resulting interval widths: the wanted width 1/w may grow by at most
/// [`GRADING`] per unit of u.
fn spread(mesh: &[f64], end: f64, weight: &mut [f64]) {
    let n = weight.len();
    let total = |weight: &[f64]| mesh.windows(2).zip(weight).map(|(x, w)| (x[1] - x[0]) * w).sum::<f64>();
    let floor = FLOOR * total(weight) / end;
    weight.iter_mut().for_each(|w| *w += floor);
    let slope = GRADING * n as f64 / total(weight);
    for i in 1..n {
        let distance = 0.5 * (mesh[i + 1] - mesh[i - 1]);
        weight[i] = weight[i].max(1.0 / (1.0 / weight[i - 1] + slope * distance));
    }
    for i in (0..n - 1).rev() {
        let distance = 0.5 * (mesh[i + 2] - mesh[i]);
        weight[i] = weight[i].max(1.0 / (1.0 / weight[i + 1] + slope * distance));
    }
}
