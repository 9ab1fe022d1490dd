//! The wall of a shell, as pictures show it.

use std::f64::consts::PI;

use super::Cortex;
use furrow_cell::profile::Factor;

/// The wall of a shell: an ellipsoid, or the profile of a table around it.
#[derive(Clone, Debug, PartialEq)]
pub struct Wall {
    /// Half axes along x, y and z of the ellipsoid, in L_h. With a profile it has the volume and second moments of the shell.
    pub axes: [f64; 3],
    /// The departure from the ellipsoid, if there is one.
    pub profile: Option<Factor>,
}

/// Parts of a contour.
const PARTS: usize = 48;

impl Wall {
    /// The wall around a cell with an axis.
    pub fn of(cortex: &Cortex) -> Wall {
        let constants = cortex.constants();
        let [along, across] =
            [constants.shell.inverse_a2, constants.shell.inverse_b2].map(|inverse| inverse.powf(-0.5));
        Wall { axes: [across, across, along], profile: constants.shell_factor.clone() }
    }

    /// Where it is at an angle from the pole u = 0, across and along the axis, in units of the half axes.
    pub fn at(&self, angle: f64) -> [f64; 2] {
        let (sin, cos) = angle.sin_cos();
        let radius = self.profile.as_ref().map_or(1.0, |profile| profile.radius(cos));
        [sin * radius, cos * radius]
    }

    /// A place at an angle from the pole u = 0 and another around the axis, in L_h.
    pub fn place(&self, angle: f64, around: f64) -> [f64; 3] {
        let ([r, z], (sin, cos), [x, y, along]) = (self.at(angle), around.sin_cos(), self.axes);
        [x * r * cos, y * r * sin, along * z]
    }

    /// The outward normal at a place, of length 1.
    pub fn normal(&self, place: [f64; 3]) -> [f64; 3] {
        let inverse = self.axes.map(|axis| 1.0 / (axis * axis));
        let outwards = match &self.profile {
            None => [0, 1, 2].map(|k| place[k] * inverse[k]),
            Some(profile) => profile.level(place, inverse).1,
        };
        let size = outwards.iter().map(|x| x * x).sum::<f64>().sqrt();
        outwards.map(|x| x / size)
    }

    /// The section through the axis and x as (r, z) from the pole u = 0 to the other, in L_h.
    pub fn contour(&self) -> Vec<[f64; 2]> {
        let [across, _, along] = self.axes;
        let place = |k: usize| {
            let [r, z] = self.at(k as f64 / PARTS as f64 * PI);
            [across * r, along * z]
        };
        (0..=PARTS).map(place).collect()
    }
}
