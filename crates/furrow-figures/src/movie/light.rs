//! The lighting of a surface, with ambient occlusion.

use furrow_formats::surface::blended;

use super::raster::Part;

/// Direction to the light: from above, from the left and from the viewer's side.
const LIGHT: [f32; 3] = [-0.38, 0.66, 0.65];
/// Half way between the light and the viewer, where the highlight is.
const HALF: [f32; 3] = [-0.209, 0.363, 0.908];
/// Strengths of ambient light, sky light and the lamp.
const AMBIENT: f32 = 0.55;
const SKY: f32 = 0.13;
const LAMP: f32 = 0.42;
/// Colours of ambient light and of the lamp.
const COOL: [f32; 3] = [0.91, 0.98, 1.08];
const WARM: [f32; 3] = [1.03, 1.0, 0.96];
/// How far the lamp's light wraps around the surface.
const WRAP: f32 = 0.25;
/// Strength of the highlight, as a share of white.
const HIGHLIGHT: f32 = 0.22;
/// Colour and strength of the rim, where the surface turns away from the viewer.
const RIM: [f32; 3] = [38.0, 84.0, 122.0];
const RIM_SHARE: f32 = 0.62;
/// Strength of ambient occlusion, and the distance within which it is sampled, in units of the canvas.
const HIDDEN: f32 = 1.25;
const REACH: f32 = 46.0;
/// Distance at which an occluder counts half, in the same unit, and the slope up to which it does not count.
const FADES: f32 = 69.0;
const FLAT: f32 = 0.05;
/// Samples around a pixel: directions, and radii relative to the largest distance.
const DIRECTIONS: usize = 8;
const RINGS: [f32; 3] = [0.16, 0.45, 1.0];

/// The colour of a part of a surface, from 0 to 255. `open` is the share of ambient light that reaches it.
pub fn lit(part: &Part, open: f32) -> [f32; 3] {
    let dot = |a: [f32; 3]| a[0] * part.normal[0] + a[1] * part.normal[1] + a[2] * part.normal[2];
    let lamp = ((dot(LIGHT) + WRAP) / (1.0 + WRAP)).max(0.0);
    let sky = 0.5 + 0.5 * part.normal[1];
    let (around, lamp) = (open * (AMBIENT + SKY * sky), (0.35 + 0.65 * open) * LAMP * lamp);
    let square = |x: f32| x * x;
    let shine = square(square(square(square(square(dot(HALF).max(0.0))))));
    let grazing = 1.0 - part.normal[2].clamp(0.0, 1.0);
    let rim = RIM_SHARE * grazing * square(grazing);
    let colour = blended(f64::from(part.value)).map(|x| x as f32);
    [0, 1, 2].map(|c| {
        let here = colour[c] * (around * COOL[c] + lamp * WARM[c]);
        let here = here + rim * (RIM[c] - here);
        (here + HIGHLIGHT * shine * open * (255.0 - here)).clamp(0.0, 255.0)
    })
}

/// The share of ambient light that reaches the nearest part of each pixel. Nearby parts block it where they rise above the
/// tangent plane, so that a convex surface is lit in full.
pub fn open(parts: &[[Part; 2]], width: usize, density: f32) -> Vec<f32> {
    let height = parts.len() / width.max(1);
    let reach = (REACH * density).ceil() as usize;
    // Pixels around the window are empty.
    let stride = width + 2 * reach;
    let mut near = vec![f32::NEG_INFINITY; stride * (height + 2 * reach)];
    for (k, [part, _]) in parts.iter().enumerate().filter(|(_, [part, _])| part.cover > 0.0) {
        near[(reach + k / width) * stride + reach + k % width] = part.near;
    }
    let offsets = offsets(density);
    let pixel = |(k, [part, _]): (usize, &[Part; 2])| {
        if part.cover == 0.0 {
            return 1.0;
        }
        let place = ((reach + k / width) * stride + reach + k % width) as isize;
        let hidden = |[right, down]: &[isize; 2]| {
            let above = near[(place + down * stride as isize + right) as usize] - part.near;
            let to = [*right as f32, -*down as f32, above];
            let rise = to[0] * part.normal[0] + to[1] * part.normal[1] + to[2] * part.normal[2];
            if rise <= 0.0 {
                return 0.0;
            }
            let square = to[0] * to[0] + to[1] * to[1] + to[2] * to[2];
            let fades = 1.0 / (1.0 + square / (FADES * density * FADES * density));
            (rise / square.sqrt() - FLAT).max(0.0) * fades
        };
        let sum: f32 = offsets.iter().map(hidden).sum();
        (1.0 - HIDDEN * sum / offsets.len() as f32).clamp(0.25, 1.0)
    };
    parts.iter().enumerate().map(pixel).collect()
}

/// Offsets of the samples around a pixel.
fn offsets(density: f32) -> Vec<[isize; 2]> {
    let ring = |(k, share): (usize, &f32)| {
        // Each ring is rotated against the one inside it.
        let turn =
            move |j: usize| (j as f32 + k as f32 / RINGS.len() as f32) / DIRECTIONS as f32 * std::f32::consts::TAU;
        let radius = share * REACH * density;
        (0..DIRECTIONS).map(move |j| {
            let (sin, cos) = turn(j).sin_cos();
            [(radius * cos) as isize, (radius * sin) as isize]
        })
    };
    RINGS.iter().enumerate().flat_map(ring).collect()
}
