//! Stationary states without axial symmetry, and their stability.

use furrow_mechanics::cortex::observables::reduced_volume;
use furrow_mechanics::division::{DivisionError, DivisionInput};

use crate::division::{AtRest, SurfaceDivision, run};
use crate::film::{COLUMNS, ROWS};
use crate::law::Geometry;
use crate::neck::{neck, offset_at, radius_at};
use crate::sample::{Sample, sample};

/// The stationary state that a cell reaches from the passive shape. Mirror-symmetric cells get mirror-symmetric noise, so their state
/// may be unstable to odd disturbances. If [`rest`](SurfaceDivision::rest) is missing, the cell divides.
///
/// # Errors
/// [`DivisionError`].
pub fn steady(input: &DivisionInput) -> Result<SurfaceDivision, DivisionError> {
    run(input, input.cell.is_mirror_symmetric(), &mut |_, _| ())
}

/// The error if a cell divides although a stationary state was requested.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("R0 = {r0}: no state at rest without axial symmetry: the cell divides at t = {t:.3} τ")]
pub struct NoRest {
    r0: f64,
    t: f64,
}

impl SurfaceDivision {
    /// The stationary state of a cell of this radius.
    ///
    /// # Errors
    /// The cell divides.
    pub fn at_rest(&self, r0: f64) -> Result<&AtRest, NoRest> {
        self.rest.as_ref().ok_or(NoRest { r0, t: self.division.t_end })
    }
}

impl AtRest {
    /// Its surface, sampled like a [`Still`](crate::film::Still).
    pub fn samples(&self) -> Vec<Sample> {
        sample(&self.problem, &self.state, ROWS, COLUMNS)
    }

    /// Length of the mean meridian, in L_h.
    pub fn length(&self) -> f64 {
        self.problem.contour_length(&self.state.surface)
    }

    /// Distance of the poles along the axis of the shell, relative to R0.
    pub fn elongation(&self) -> f64 {
        let height = |u: f64| {
            let mut functions = Vec::new();
            let space = &self.problem.space;
            space.functions(&self.state.surface, &space.station(u), &mut functions);
            space.shape(&functions, &space.meridian(0.0))[0][2]
        };
        (height(0.0) - height(1.0)) / self.problem.radius()
    }

    /// Length of the ring in the middle of the mean meridian divided by 2π, in L_h.
    pub fn equator_radius(&self) -> f64 {
        radius_at(&self.problem.space, &self.state.surface, self.middle())
    }

    /// Coordinate u of the ring in the middle of the mean meridian.
    fn middle(&self) -> f64 {
        self.problem.mean_meridian(&self.state.surface).u_at(0.5)
    }

    /// Whether it has a waist.
    pub fn has_waist(&self) -> bool {
        neck(&self.problem.space, &self.state.surface).is_some()
    }

    /// Distance from the axis, in L_h, of the centre of its waist, or without a waist of the ring in the middle of the mean meridian.
    pub fn offset(&self) -> f64 {
        let (space, surface) = (&self.problem.space, &self.state.surface);
        neck(space, surface).map_or_else(|| offset_at(space, surface, self.middle()), |neck| neck.offset.abs())
    }

    /// Reduced volume, the volume divided by the volume of a sphere with the same area, and the energy of bending ∫ ½κ(C − C0)² dA,
    /// in κ0.
    pub fn reduced_volume_and_bending(&self) -> [f64; 2] {
        let space = &self.problem.space;
        let [mut area, mut bending] = [0.0; 2];
        self.problem.for_each_point(&self.state, |q, _, place, x, _, _| {
            let geometry = Geometry::new(x);
            let part = space.stations[q].weight * space.meridian_weight() * geometry.area;
            area += part;
            bending += 0.5 * place.local.kappa * (geometry.mean - place.local.spontaneous).powi(2) * part;
        });
        [reduced_volume(self.problem.radius(), area), bending]
    }

    /// The leading growth rate over all modes of the surface, including odd ones, in 1/τ.
    pub fn growth_rate(&self) -> f64 {
        self.rates.first().map_or(f64::NEG_INFINITY, |rate| rate.re)
    }
}
