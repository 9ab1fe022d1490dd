//! Axisymmetric surfaces in the function space, from which every division and every branch starts.

use faer::linalg::solvers::Solve;

use crate::problem::State;
use crate::space::{Harmonic, Space};

/// A point of an axisymmetric contour.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContourPoint {
    /// Distance r from the axis.
    pub r: f64,
    /// Position z along the axis.
    pub z: f64,
    /// Radial velocity of the material.
    pub v_r: f64,
    /// Axial velocity of the material.
    pub v_z: f64,
}

/// The state closest to a contour, which is given as a function of the fraction of arclength from the pole u = 0; `shares` by station, see
/// [`Mesh::shares`](crate::mesh::Mesh::shares).
pub fn embed(space: &Space, shares: &[f64], pressure: f64, contour: impl Fn(f64) -> ContourPoint) -> State {
    let points: Vec<ContourPoint> = shares.iter().map(|share| contour(*share)).collect();
    let size = space.coefficients();
    let mut state = State { surface: vec![0.0; size], flow: vec![0.0; size], pressure };
    let mut fill = |harmonic: Harmonic, value: &dyn Fn(&ContourPoint) -> [f64; 2]| {
        let Some(place) = space.harmonics.iter().position(|of| *of == harmonic) else { return };
        let values: Vec<[f64; 2]> = points.iter().map(value).collect();
        for (spline, [surface, flow]) in project(space, place, &values).into_iter().enumerate() {
            state.surface[spline * space.harmonics.len() + place] = surface;
            state.flow[spline * space.harmonics.len() + place] = flow;
        }
    };
    fill(Harmonic::Across(1), &|point| [point.r, point.v_r]);
    fill(Harmonic::Along(0), &|point| [point.z, point.v_z]);
    state
}

/// Coefficients of the functions of u closest to `values` at the stations, with the conditions of a harmonic at the poles.
pub fn project(space: &Space, harmonic: usize, values: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let splines = space.splines();
    // The unknowns of this harmonic, in order.
    let mut numbers: Vec<usize> = (0..splines).filter_map(|spline| space.unknown(spline, 0, harmonic)).collect();
    numbers.sort_unstable();
    numbers.dedup();
    let of = |spline: usize| numbers.binary_search(&space.unknown(spline, 0, harmonic)?).ok();
    let mut mass = faer::Mat::<f64>::zeros(numbers.len(), numbers.len());
    let mut load = faer::Mat::<f64>::zeros(numbers.len(), 2);
    for (station, value) in space.stations.iter().zip(values) {
        for (r, basis) in station.basis.iter().enumerate() {
            let Some(row) = of(station.element + r) else { continue };
            let weight = station.weight * basis[0];
            (0..2).for_each(|k| load[(row, k)] += weight * value[k]);
            for (s, other) in station.basis.iter().enumerate() {
                if let Some(column) = of(station.element + s) {
                    mass[(row, column)] += weight * other[0];
                }
            }
        }
    }
    mass.partial_piv_lu().solve_in_place(load.as_mut());
    (0..splines).map(|spline| of(spline).map_or([0.0; 2], |row| [load[(row, 0)], load[(row, 1)]])).collect()
}
