//! Non-axisymmetric modes of a stationary shape: the contour at φ and at φ + π, and the surface.

use nalgebra::{Rotation3, Vector3};
use ordered_float::OrderedFloat;

use crate::drawing::cell::{Site, extent, shell};
use crate::drawing::legend::{Key, Legend, titled};
use crate::drawing::style::{self, Colour, text};
use crate::drawing::{Anchor, Canvas, Label, Stroke};
use furrow_mechanics::azimuthal::mode::{Displacement, Mode};
use furrow_mechanics::cortex::{Cortex, Wall};

const WIDTH: f64 = 1000.0;
/// Height of the row of one mode.
const ROW: f64 = 250.0;
/// Largest displacement drawn, in R0.
const AMPLITUDE: f64 = 0.18;
/// Numbers of facets from pole to pole and around.
const FACETS: [usize; 2] = [72, 72];
/// Angles by which the axis is turned towards the viewer, and by which the viewer looks down.
const TURNED: [f64; 2] = [0.42, 0.55];
/// Direction of the light.
const LIGHT: [f64; 3] = [-0.25, 0.70, 1.0];
/// Colours of undisplaced places, of outward and of inward displacement.
const STILL: [f64; 3] = [226.0, 232.0, 238.0];
const OUT: [f64; 3] = [214.0, 96.0, 77.0];
const IN: [f64; 3] = [67.0, 131.0, 195.0];

/// Draws the modes of a shape, one in a row.
pub fn draw(cortex: &Cortex, modes: &[Mode]) -> Canvas {
    let cell = &cortex.cell;
    let title = format!(
        "Disturbances w cos mφ of the stationary shape at {}\nthe leading mode of each m, its size chosen; growth rates in 1/τ",
        style::described(cell, &[])
    );
    let legend = Legend::default()
        .with(Key::Line(style::MODEL), "displaced, at φ above and at φ + π below")
        .with(Key::Dashes(style::INK, style::DASHED), "the shape")
        .with(Key::Dashes(style::SHELL, [5.0, 4.0]), "the shell")
        .with(Key::Area(OUT.map(|c| c as u8)), "moved outwards")
        .with(Key::Area(IN.map(|c| c as u8)), "moved inwards");
    let (mut canvas, top) = titled(WIDTH, ROW * modes.len() as f64 + 10.0, &title, &legend);
    let wall = Wall::of(cortex).contour();
    let axes = extent(&wall);
    let scale = (0.40 * 0.5 * WIDTH / axes[0]).min(0.36 * ROW / axes[1]);
    for (k, mode) in modes.iter().enumerate() {
        let middle = top + ROW * (k as f64 + 0.5);
        let words = format!("m = {}", mode.m);
        canvas.label(Label::new([24.0, middle - 8.0], &words, text::LABEL, Anchor::Start, style::INK).bold());
        canvas.text([24.0, middle + 16.0], &format!("{:.4}", mode.rate), text::TICK, Anchor::Start, style::MUTED);
        let site = Site { centre: [0.32 * WIDTH, middle], scale };
        outlines(&mut canvas, mode, AMPLITUDE * cell.r0, &site);
        shell(&mut canvas, &wall, &site);
        surface(&mut canvas, mode, AMPLITUDE * cell.r0, &Site { centre: [0.76 * WIDTH, middle], scale });
    }
    canvas
}

/// A place displaced by `amount` times the mode.
fn moved(place: &Displacement, amount: f64) -> [f64; 2] {
    [0, 1].map(|k| place.at[k] + amount * place.w * place.normal[k])
}

/// The contour at φ above the axis and at φ + π below it, with and without the displacement.
fn outlines(canvas: &mut Canvas, mode: &Mode, amplitude: f64, site: &Site) {
    let places = mode.meridian(240);
    let opposite = if mode.m % 2 == 1 { -amplitude } else { amplitude };
    let closed = |above: f64, below: f64| -> Vec<[f64; 2]> {
        let up = places.iter().map(|place| site.point(moved(place, above)));
        let down = places.iter().rev().map(|place| {
            let [r, z] = moved(place, below);
            site.point([-r, z])
        });
        up.chain(down).collect()
    };
    let displaced = closed(amplitude, opposite);
    canvas.polygon(&displaced, style::CYTOPLASM, 1.0, Some(Stroke::solid(style::MODEL, 2.2)));
    let shape = closed(0.0, 0.0);
    canvas.polyline(&shape, Stroke::dashed(style::INK, 1.2, style::DASHED));
}

/// The displaced surface, coloured by the displacement, the far facets first.
fn surface(canvas: &mut Canvas, mode: &Mode, amplitude: f64, site: &Site) {
    let [along, around] = FACETS;
    let places = mode.meridian(along);
    let rotation = Rotation3::from_axis_angle(&Vector3::x_axis(), TURNED[1])
        * Rotation3::from_axis_angle(&Vector3::y_axis(), -TURNED[0]);
    let light = Vector3::from(LIGHT).normalize();
    let at = |i: usize, k: usize| {
        let angle = k as f64 / around as f64 * std::f64::consts::TAU;
        let [r, z] = moved(&places[i], amplitude * (mode.m as f64 * angle).cos());
        // φ = 0 points upwards.
        rotation * Vector3::new(z, r * angle.cos(), r * angle.sin())
    };
    let mut facets: Vec<(f64, [[f64; 2]; 4], Colour)> = Vec::new();
    for i in 0..along {
        for k in 0..around {
            let corners = [at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)];
            let outwards = (corners[2] - corners[0]).cross(&(corners[3] - corners[1]));
            let Some(normal) = outwards.try_normalize(1e-14).filter(|normal| normal.z >= -0.02) else { continue };
            let angle = (k as f64 + 0.5) / around as f64 * std::f64::consts::TAU;
            let change = 0.5 * (places[i].w + places[i + 1].w) * (mode.m as f64 * angle).cos();
            let colour = shade(change, 0.62 + 0.38 * normal.dot(&light).max(0.0));
            let depth = corners.iter().map(|corner| corner.z).sum();
            let flat = corners.map(|c| [site.centre[0] + site.scale * c.x, site.centre[1] - site.scale * c.y]);
            facets.push((depth, flat, colour));
        }
    }
    facets.sort_by_cached_key(|item| OrderedFloat(item.0));
    for (_, corners, colour) in facets {
        canvas.facets([corners], colour);
    }
}

fn shade(change: f64, light: f64) -> Colour {
    let towards = if change > 0.0 { OUT } else { IN };
    [0, 1, 2].map(|c| (light * (STILL[c] + change.abs().min(1.0) * (towards[c] - STILL[c]))).clamp(0.0, 255.0) as u8)
}
