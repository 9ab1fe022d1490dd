//! The shell, as glass that is visible mainly at its edge.

use super::raster::Window;
use super::view::View;

/// Colour of the glass.
pub const GLASS: [f32; 3] = [104.0, 130.0, 150.0];
/// Opacity of the glass where it faces the viewer, and the opacity added at its edge.
const FACING: f64 = 0.015;
const EDGE: f64 = 0.30;
/// Samples of a pixel along each side.
const SAMPLES: usize = 2;

/// The share of each pixel of a window that the glass of an ellipsoid, with half axes along x, y and z, covers.
pub fn glass(axes: [f64; 3], view: &View, density: f64, window: Window) -> Vec<f32> {
    // In a space where the ellipsoid is the unit sphere.
    let round = |point: [f64; 3]| [0, 1, 2].map(|k| point[k] / axes[k]);
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let towards = view.back([0.0, 0.0, 1.0]);
    let ray = round(towards);
    let share = |x: f64, y: f64| {
        let right = (x / density - view.centre[0]) / view.scale;
        let up = (view.centre[1] - y / density) / view.scale;
        let start = round(view.back([right, up, 0.0]));
        let (a, b, c) = (dot(ray, ray), dot(start, ray), dot(start, start) - 1.0);
        let under = b * b - a * c;
        if under <= 0.0 {
            return 0.0;
        }
        let far = (under.sqrt() - b) / a;
        let normal = round([0, 1, 2].map(|k| start[k] + far * ray[k]));
        let grazing = 1.0 - dot(normal, towards) / dot(normal, normal).sqrt();
        FACING + EDGE * grazing * grazing * grazing
    };
    let [left, top] = window.corner;
    let pixel = |k: usize| {
        let (x, y) = (left + k % window.size[0], top + k / window.size[0]);
        let place = |k: usize, at: usize| at as f64 + (k as f64 + 0.5) / SAMPLES as f64;
        let all = (0..SAMPLES * SAMPLES).map(|k| share(place(k % SAMPLES, x), place(k / SAMPLES, y)));
        (all.sum::<f64>() / (SAMPLES * SAMPLES) as f64) as f32
    };
    (0..window.size[0] * window.size[1]).map(pixel).collect()
}
