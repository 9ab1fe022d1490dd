//! The direction from which a movie shows a cell.

use nalgebra::{Rotation3, Vector3};

/// Angles in radians by which the axis is turned towards the viewer, and by which the viewer looks down.
const TURNED: [f64; 2] = [0.42, 0.30];

/// A viewing direction.
#[derive(Clone, Copy, Debug)]
pub struct View {
    rotation: Rotation3<f64>,
    /// The centre of the shell on the canvas.
    pub centre: [f64; 2],
    /// Units of the canvas for one L_h.
    pub scale: f64,
}

impl View {
    /// The usual view. The axis z is horizontal, with the anterior pole, u = 1, on the left and away from the viewer;
    /// x is upwards.
    pub fn new(centre: [f64; 2], scale: f64) -> View {
        let [turn, down] = TURNED;
        let rotation = Rotation3::from_axis_angle(&Vector3::x_axis(), down)
            * Rotation3::from_axis_angle(&Vector3::y_axis(), -turn);
        View { rotation, centre, scale }
    }

    /// A direction in space as its parts to the right, upwards and towards the viewer.
    pub fn turned(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        (self.rotation * Vector3::new(z, x, y)).into()
    }

    /// A point on the canvas, and its distance towards the viewer, in units of the canvas.
    pub fn project(&self, point: [f64; 3]) -> [f64; 3] {
        let [right, up, near] = self.turned(point);
        [self.centre[0] + self.scale * right, self.centre[1] - self.scale * up, self.scale * near]
    }

    /// A point on the canvas.
    pub fn point(&self, point: [f64; 3]) -> [f64; 2] {
        let [x, y, _] = self.project(point);
        [x, y]
    }
}
