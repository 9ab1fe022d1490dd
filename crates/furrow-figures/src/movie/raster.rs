//! A closed surface in pixels.

use furrow_formats::surface::SurfaceMesh;

use super::view::View;

/// Parts of a surface in one pixel that are farther apart than this, in pixels towards the viewer, are apart.
const APART: f32 = 24.0;

/// Weights of corners may be negative by this much, so that rounding leaves no gaps between triangles.
const INSIDE: f32 = 1e-4;

/// The part of a surface in a pixel.
#[derive(Clone, Copy, Debug, Default)]
pub struct Part {
    /// Share of the pixel.
    pub cover: f32,
    /// Distance towards the viewer, in pixels.
    pub near: f32,
    /// Normal: to the right, upwards, towards the viewer.
    pub normal: [f32; 3],
    /// The value.
    pub value: f32,
}

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Its upper left corner.
    pub corner: [usize; 2],
    /// Width and height.
    pub size: [usize; 2],
}

/// The nearest sample so far.
#[derive(Clone, Copy)]
struct Sample {
    near: f32,
    normal: [f32; 3],
    value: f32,
}

/// A vertex in samples of the window.
#[derive(Clone, Copy, Default)]
struct Corner {
    at: [f32; 3],
    normal: [f32; 3],
    value: f32,
}

/// The parts of a surface in each pixel of a window, the nearest first; a second one shows behind the edge of the first.
/// `density` is the number of pixels in a unit of the canvas.
pub fn parts(mesh: &SurfaceMesh, view: &View, density: f64, window: Window) -> Vec<[Part; 2]> {
    // Samples of a pixel along each side: fewer where pixels are small.
    let count = if density < 1.25 { 3 } else { 2 };
    let [width, height] = window.size.map(|length| length * count);
    let empty = Sample { near: f32::NEG_INFINITY, normal: [0.0; 3], value: 0.0 };
    let mut samples = vec![empty; width * height];
    let corners: Vec<Corner> = (0..mesh.points.len()).map(|k| corner(mesh, k, view, density, window, count)).collect();
    for triangle in &mesh.triangles {
        fill(&mut samples, [width, height], triangle.map(|k| corners.get(k as usize).copied().unwrap_or_default()));
    }
    let pixel = |k: usize| {
        let (x, y) = (k % window.size[0] * count, k / window.size[0] * count);
        resolve((0..count).flat_map(|row| &samples[(y + row) * width + x..][..count]), count)
    };
    (0..window.size[0] * window.size[1]).map(pixel).collect()
}

fn corner(mesh: &SurfaceMesh, k: usize, view: &View, density: f64, window: Window, count: usize) -> Corner {
    let [x, y, near] = view.project(mesh.points[k]).map(|x| density * x);
    let sample = |at: f64, corner: usize| ((at - corner as f64) * count as f64) as f32;
    Corner {
        at: [sample(x, window.corner[0]), sample(y, window.corner[1]), near as f32],
        normal: view.turned(mesh.normals[k]).map(|x| x as f32),
        value: mesh.values[k] as f32,
    }
}

/// Draws a triangle where it is nearer than the samples drawn before. Triangles that face away are skipped.
fn fill(samples: &mut [Sample], [width, height]: [usize; 2], corners: [Corner; 3]) {
    let [a, b, c] = corners.map(|corner| corner.at);
    // Twice the area: negative of what faces the viewer, as y runs downwards.
    let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    if area >= 0.0 {
        return;
    }
    let range = |k: usize, most: usize| {
        let (low, high) = (a[k].min(b[k]).min(c[k]), a[k].max(b[k]).max(c[k]));
        let first = (low - 0.5).ceil().max(0.0) as usize;
        first..((high - 0.5).floor() + 1.0).clamp(0.0, most as f32) as usize
    };
    let columns = range(0, width);
    // The weight of a corner: 1 there, 0 on the opposite side.
    let sides = [(b, c), (c, a), (a, b)];
    let right = sides.map(|(p, q)| (p[1] - q[1]) / area);
    for row in range(1, height) {
        let (x, y) = (columns.start as f32 + 0.5, row as f32 + 0.5);
        let first = sides.map(|(p, q)| ((q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0])) / area);
        for column in columns.clone() {
            let by = (column - columns.start) as f32;
            let [u, v, w] = [first[0] + by * right[0], first[1] + by * right[1], first[2] + by * right[2]];
            if u.min(v).min(w) < -INSIDE {
                continue;
            }
            let sample = &mut samples[row * width + column];
            let near = u * a[2] + v * b[2] + w * c[2];
            if near > sample.near {
                let blend = |of: fn(&Corner) -> f32| u * of(&corners[0]) + v * of(&corners[1]) + w * of(&corners[2]);
                let normal = [blend(|c| c.normal[0]), blend(|c| c.normal[1]), blend(|c| c.normal[2])];
                *sample = Sample { near, normal, value: blend(|c| c.value) };
            }
        }
    }
}

/// Averages the samples of a pixel, separately for the nearest part and for the parts behind it.
fn resolve<'s>(samples: impl Iterator<Item = &'s Sample> + Clone, count: usize) -> [Part; 2] {
    let nearest = samples.clone().map(|sample| sample.near).fold(f32::NEG_INFINITY, f32::max);
    let mut parts = [Part::default(); 2];
    for sample in samples.filter(|sample| sample.near > f32::NEG_INFINITY) {
        let part = &mut parts[usize::from(nearest - sample.near > APART)];
        part.cover += 1.0;
        part.near += sample.near;
        part.value += sample.value;
        (0..3).for_each(|c| part.normal[c] += sample.normal[c]);
    }
    parts.map(|part| {
        if part.cover == 0.0 {
            return part;
        }
        let length = part.normal.iter().map(|x| x * x).sum::<f32>().sqrt().max(1e-6);
        Part {
            cover: part.cover / (count * count) as f32,
            near: part.near / part.cover,
            normal: part.normal.map(|x| x / length),
            value: part.value / part.cover,
        }
    })
}
