//! Observables of a stationary shape on a branch.

use furrow_bvp::{Continuation, Gauss, Solution};

use crate::cortex::equations::{LENGTH, PRESSURE, R};
use crate::cortex::problem::SHAPE_SCALARS;
use crate::cortex::{Cortex, Domain, observables};

/// Index of the activity ξ_s among the scalar unknowns of every branch.
pub const XI: usize = SHAPE_SCALARS;

/// A stationary shape on a branch.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShapePoint {
    /// Activity ξ_s.
    pub xi_s: f64,
    /// Elongation H = (z(0) − z(1))/R0.
    pub elongation: f64,
    /// Contour length L, in L_h.
    pub length: f64,
    /// Pressure p, in κ0/L_h³.
    pub pressure: f64,
    /// Radius at the equator u = ½, in L_h.
    pub equator_radius: f64,
    /// Furrow position u_f − ½; 0 for mirror-symmetric shapes, `None` for other shapes without a furrow.
    pub delta_u: Option<f64>,
    /// Reduced volume: the cell's volume divided by the volume of a sphere with the same area.
    pub reduced_volume: f64,
    /// Energy of bending ∫ ½κ(C − C0)² dA, in κ0; 8πκ for a sphere without C0.
    pub bending_energy: f64,
    /// Arclength along the branch.
    pub arclength: f64,
    /// Folds and pitchforks passed since the start of the branch.
    pub passed: usize,
    /// Largest growth rate of perturbations, in 1/τ, if requested and found.
    pub growth_rate: Option<f64>,
}

impl ShapePoint {
    /// Observables of a solution.
    pub fn of(y: &Solution, cortex: &Cortex, gauss: &Gauss) -> ShapePoint {
        let half = cortex.domain == Domain::Half;
        let [area, bending_energy] = observables::area_and_bending(gauss, cortex, y);
        ShapePoint {
            xi_s: y.scalars.get(XI).copied().unwrap_or(cortex.cell.xi_s),
            elongation: observables::elongation(y, cortex.domain, cortex.cell.r0),
            length: y.scalars[LENGTH],
            pressure: y.scalars[PRESSURE],
            equator_radius: if half { y.node(y.intervals())[R] } else { observables::equator_radius(gauss, y) },
            delta_u: if half { Some(0.0) } else { observables::furrow_position(gauss, cortex, y).map(|u| u - 0.5) },
            reduced_volume: observables::reduced_volume(cortex.cell.r0, area),
            bending_energy,
            ..ShapePoint::default()
        }
    }

    /// The newest point of a branch, after `passed` folds and pitchforks.
    pub(super) fn newest(of: &Continuation<Cortex>, passed: usize) -> ShapePoint {
        let (y, cortex) = (&of.state.solution, &of.problem);
        ShapePoint { arclength: of.state.arclength, passed, ..ShapePoint::of(y, cortex, &of.system.gauss) }
    }
}
