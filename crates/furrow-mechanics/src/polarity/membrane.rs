//! The surface on which the chemistry runs: a passive shape, in µm, or a line.

use std::f64::consts::PI;

use furrow_bvp::{Gauss, NewtonError, Solution};

use crate::cortex::equations::{COMPONENTS, LENGTH, PSI, R};
use crate::equilibria::{passive, passive_whole};
use furrow_cell::cue::{ParConstants, SurfaceToVolume};
use furrow_cell::{Cell, Numerics};

/// The surface of a cell at rest.
#[derive(Clone, Debug)]
pub struct Membrane {
    /// The passive shape: up to its mirror, in a mirror-symmetric shell; `None` for a line.
    shape: Option<Solution>,
    /// Whether it is half of the contour.
    is_half: bool,
    gauss: Gauss,
    /// ∫ r du over the whole contour, in L_h.
    mean_radius: f64,
    /// Radius R0 of the cell, in L_h.
    pub r0: f64,
    /// Contour length from pole to pole, in µm.
    pub length: f64,
    /// Surface over volume, in 1/µm.
    pub surface_to_volume: f64,
}

/// Points of the quadrature over half an ellipse.
const ARC: usize = 64;

impl Membrane {
    /// The membrane of a cell, for a unit of length L_h of `length_um` µm.
    ///
    /// # Errors
    /// The cell has no passive shape.
    pub fn of(cell: &Cell, numerics: &Numerics, length_um: f64) -> Result<Membrane, NewtonError> {
        let is_half = cell.has_even_shell();
        let (shape, _) = if is_half { passive(cell, numerics) } else { passive_whole(cell, numerics) }?;
        let parts = if is_half { 2.0 } else { 1.0 };
        let gauss = shape.gauss();
        let mut mean_radius = 0.0;
        for i in 0..shape.intervals() {
            let h = shape.mesh[i + 1] - shape.mesh[i];
            mean_radius += (0..shape.m).map(|j| parts * h * gauss.b[j] * shape.stage(i, j)[R]).sum::<f64>();
        }
        let length = shape.scalars[LENGTH];
        let surface_to_volume = 2.0 * PI * length * mean_radius / cell.volume() / length_um;
        Ok(Membrane {
            shape: Some(shape),
            is_half,
            gauss,
            mean_radius,
            r0: cell.r0,
            length: length * length_um,
            surface_to_volume,
        })
    }

    /// A line from pole to pole, as if every place had the same distance from the axis, of half the circumference of a prolate
    /// spheroid with the volume of a sphere of radius `r0`, in L_h, and half axes in the ratio `aspect`, above 1. The chemistry has the
    /// spheroid's surface per volume.
    pub fn line(r0: f64, aspect: f64, length_um: f64) -> Membrane {
        let b = r0 / aspect.cbrt();
        let eccentricity = (1.0 - aspect.powi(-2)).sqrt();
        let surface = 2.0 * PI * b * b * (1.0 + aspect / eccentricity * eccentricity.asin());
        // Half of the circumference, by the trapezoidal rule, which converges exponentially on periodic functions.
        let speed = |k: usize| {
            let (sin, cos) = (PI * (k as f64 + 0.5) / ARC as f64).sin_cos();
            b * (cos * cos + aspect * aspect * sin * sin).sqrt()
        };
        let length = (0..ARC).map(speed).sum::<f64>() * PI / ARC as f64;
        Membrane {
            shape: None,
            is_half: false,
            gauss: Gauss::default(),
            mean_radius: 1.0,
            r0,
            length: length * length_um,
            surface_to_volume: surface / (4.0 / 3.0 * PI * r0.powi(3)) / length_um,
        }
    }

    /// ψ of the chemistry, in 1/µm, for a cell `scale` times as large.
    pub fn psi(&self, constants: &ParConstants, scale: f64) -> f64 {
        match constants.surface_to_volume {
            SurfaceToVolume::Shape => self.surface_to_volume / scale,
            SurfaceToVolume::Fixed(psi) => psi,
        }
    }

    /// (1/r) ∂r/∂u and r/∫ r du, between the poles.
    pub fn at(&self, u: f64) -> [f64; 2] {
        let Some(shape) = &self.shape else { return [0.0, 1.0] };
        let mut at = [0.0; COMPONENTS];
        let mirrored = self.is_half && u > 0.5;
        shape.eval(&self.gauss, if mirrored { 1.0 - u } else { u }, &mut at);
        let widening = shape.scalars[LENGTH] * at[PSI].cos() / at[R];
        [if mirrored { -widening } else { widening }, at[R] / self.mean_radius]
    }
}
