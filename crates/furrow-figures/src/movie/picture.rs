//! One frame of a movie.

use std::f64::consts::{PI, TAU};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use tiny_skia::{Pixmap, PremultipliedColorU8};

use super::light;
use super::palette::{Palette, png};
use super::raster::{Part, Window, parts};
use super::scene::{Force, Scene};
use super::shell::{GLASS, glass, outline};
use super::view::View;
use crate::drawing::cell::{ANTERIOR, POSTERIOR};
use crate::drawing::font;
use crate::drawing::raster::colours;
use crate::drawing::style::{self, Colour, FORCES, text};
use crate::drawing::{Anchor, Canvas, FigureError, Label, Stroke};
use furrow_formats::surface::SurfaceMesh;

/// Width and height of a frame.
pub const SIZE: [f64; 2] = [680.0, 460.0];
/// Length of the longest arrow.
const LONGEST: f64 = 42.0;
/// Pieces of a ring around the shell.
const RING: usize = 120;
/// Forces below this share of the largest have no arrow.
const SMALL: f64 = 0.18;
/// Space around the shell in the window of the surface.
const MARGIN: f64 = 3.0;

/// The data that all frames of a movie share.
pub struct Stage<'s, 'a> {
    /// The scene.
    pub scene: &'s Scene<'a>,
    view: View,
    /// The force of the longest arrow; 0 without forces.
    largest: f64,
    /// Pixels in a unit of the canvas.
    density: f64,
    /// The pixels of the shell, and the glass in each.
    window: Window,
    glass: Vec<f32>,
}

/// A frame: pixels of the surface, and lines and text before them.
pub struct Frame {
    pixels: Pixmap,
    before: Canvas,
}

impl<'s, 'a> Stage<'s, 'a> {
    /// For the frames of a scene, with `density` pixels in a unit of the canvas.
    ///
    /// # Errors
    /// Of a shell that is not finite.
    pub fn new(scene: &'s Scene<'a>, density: f64) -> Result<Stage<'s, 'a>, FigureError> {
        let centre = [0.5 * SIZE[0], 0.5 * SIZE[1] + 8.0];
        let [long, high] = outline(&scene.shell, &View::new(centre, 1.0));
        let view = View::new(centre, (0.38 * SIZE[0] / long).min(0.36 * SIZE[1] / high));
        let half = outline(&scene.shell, &view);
        let [(left, right), (top, bottom)] = [0, 1].map(|c| {
            let ends = [-1.0, 1.0].map(|side| density * (centre[c] + side * (half[c] + MARGIN)));
            let most = (density * SIZE[c]).round();
            (ends[0].floor().clamp(0.0, most) as usize, ends[1].ceil().clamp(0.0, most) as usize)
        });
        let window = Window { corner: [left, top], size: [right - left, bottom - top] };
        // Forces at the neck grow without bound near pinch-off: the scale of the arrows leaves out the largest 3 % of
        // the movie.
        let forces = scene.times.iter().flat_map(|t| (scene.forces)(*t));
        let mut sizes: Vec<f64> = forces.map(|force| length(force.vector)).collect();
        sizes.sort_by(f64::total_cmp);
        let largest = sizes.get(sizes.len() * 97 / 100).map_or(0.0, |size| size.max(1e-9));
        let glass = glass(&scene.shell, &view, density, window)?;
        Ok(Stage { scene, view, largest, density, window, glass })
    }

    /// The colours of words, arrows and the legend.
    pub fn colours(&self) -> Vec<Colour> {
        let of_scene = self.scene.legend.iter().map(|(colour, _)| *colour).chain([self.scene.outcome.2]);
        [style::WHITE, style::INK, style::MUTED, FORCES[0].1].into_iter().chain(of_scene).collect()
    }

    /// The frame at a time.
    pub fn frame(&self, t: f64) -> Result<Frame, FigureError> {
        let mut behind = Canvas::new(SIZE[0], SIZE[1]);
        self.rings(&mut behind, true);
        let mut pixels = behind.blank(self.density as f32).ok_or(FigureError::Size(SIZE))?;
        behind.draw_on(&mut pixels, self.density as f32).ok_or(FigureError::Size(SIZE))?;
        self.surface(&mut pixels, &(self.scene.surface)(t).mesh()?);
        let mut before = Canvas::new(SIZE[0], SIZE[1]);
        self.rings(&mut before, false);
        self.forces(&mut before, &(self.scene.forces)(t));
        self.words(&mut before, t);
        Ok(Frame { pixels, before })
    }

    /// Draws the surface and the glass before it.
    fn surface(&self, pixels: &mut Pixmap, mesh: &SurfaceMesh) {
        let parts = parts(mesh, &self.view, self.density, self.window);
        let open = light::open(&parts, self.window.size[0], self.density as f32);
        let width = pixels.width() as usize;
        let Window { corner: [left, top], size: [columns, _] } = self.window;
        for (k, both) in parts.iter().enumerate() {
            let place = (top + k / columns) * width + left + k % columns;
            let Some(pixel) = pixels.pixels_mut().get_mut(place) else { continue };
            let behind = [pixel.red(), pixel.green(), pixel.blue()].map(f32::from);
            let shown = covered(behind, both, open[k]);
            let [r, g, b] = over(shown, GLASS, self.glass[k]).map(|light| light.round() as u8);
            // Premultiplication does not change opaque colours.
            *pixel = PremultipliedColorU8::from_rgba(r, g, b, 255).unwrap_or(*pixel);
        }
    }

    /// Rings around the shell; their far halves lie behind the cell.
    fn rings(&self, canvas: &mut Canvas, behind: bool) {
        let wall = &self.scene.shell;
        let thin = Stroke::solid(if behind { [0xd8; 3] } else { [0xb9; 3] }, 0.9);
        for ring in -2..=2 {
            let angle = (0.4 * f64::from(ring)).acos();
            let place = |k: usize| wall.place(angle, k as f64 / RING as f64 * TAU);
            let hidden = |point: [f64; 3]| self.view.turned(wall.normal(point))[2] < 0.0;
            let is_shown = |k: usize| hidden(place(k)) == behind;
            // The start of the visible arc; 0 if the whole ring is on one side.
            let first = (1..=RING).find(|k| is_shown(*k) && !is_shown(k - 1)).unwrap_or(0);
            let line = (first..=first + RING).take_while(|k| is_shown(*k)).map(|k| self.view.point(place(k)));
            canvas.polyline(&line.collect::<Vec<_>>(), thin);
        }
    }

    fn forces(&self, canvas: &mut Canvas, forces: &[Force]) {
        for force in forces {
            let size = length(force.vector);
            if size <= SMALL * self.largest {
                continue;
            }
            // Longer arrows are cut to the greatest length.
            let stretch = LONGEST / self.view.scale * (size / self.largest).min(1.0) / size;
            let to = [0, 1, 2].map(|c| force.at[c] + stretch * force.vector[c]);
            canvas.arrow(self.view.point(force.at), self.view.point(to), FORCES[0].1, 1.9);
        }
    }

    fn words(&self, canvas: &mut Canvas, t: f64) {
        let Scene { title, shell, legend, outcome: (from, word, colour), .. } = self.scene;
        canvas.text([20.0, 30.0], title, text::LABEL, Anchor::Start, style::INK);
        let time = format!("t = {} τ", style::time(t));
        canvas.text([SIZE[0] - 20.0, 30.0], &time, text::LABEL, Anchor::End, style::INK);
        let bottom = SIZE[1] - 18.0;
        let (mut x, mut y) = (20.0, bottom);
        if self.largest > 0.0 {
            canvas.arrow([20.0, bottom - 5.0], [56.0, bottom - 5.0], FORCES[0].1, 2.2);
            canvas.text([64.0, bottom], "active force", text::TICK, Anchor::Start, style::MUTED);
            x = 176.0;
        }
        for (colour, word) in legend {
            let width = 24.0 + font::width(word, text::TICK);
            if x + width > SIZE[0] - 12.0 {
                (x, y) = (20.0, y - 22.0);
            }
            canvas.rectangle([x, y - 13.0], [18.0, 14.0], *colour, 1.0);
            canvas.text([x + 24.0, y], word, text::TICK, Anchor::Start, style::MUTED);
            x += 16.0 + width;
        }
        for (x, angle, pole, anchor) in
            [(20.0, PI, ANTERIOR, Anchor::Start), (SIZE[0] - 20.0, 0.0, POSTERIOR, Anchor::End)]
        {
            let [_, y] = self.view.point(shell.place(angle, 0.0));
            canvas.text([x, y + 5.0], pole, text::TICK, anchor, style::MUTED);
        }
        if t >= *from {
            canvas.label(Label::new([SIZE[0] - 20.0, 54.0], word, text::LABEL, Anchor::End, *colour).bold());
        }
    }
}

impl Frame {
    /// The surface as an element of an SVG, in the part of the frame where the shell is, and lines and text before it.
    pub fn elements(&self, stage: &Stage<'_, '_>, palette: &mut Palette) -> Result<String, FigureError> {
        let Window { corner: [left, top], size: [width, height] } = stage.window;
        let all = colours(&self.pixels);
        let row = |y: usize| {
            let from = 3 * ((top + y) * self.pixels.width() as usize + left);
            all.get(from..from + 3 * width).unwrap_or_default()
        };
        let shown: Vec<u8> = (0..height).flat_map(row).copied().collect();
        let image = STANDARD.encode(png(&shown, [width as u32, height as u32], palette)?);
        let [x, y, width, height] = [left, top, width, height].map(|length| length as f64 / stage.density);
        Ok(format!(
            "<image x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" href=\"data:image/png;base64,{image}\"/>{}",
            self.before.elements()
        ))
    }

    /// Red, green and blue of each pixel, row by row, and the width and height in pixels.
    pub fn pixels(mut self) -> Result<(Vec<u8>, [u32; 2]), FigureError> {
        let density = self.pixels.width() as f32 / SIZE[0] as f32;
        self.before.draw_on(&mut self.pixels, density).ok_or(FigureError::Size(SIZE))?;
        Ok((colours(&self.pixels), [self.pixels.width(), self.pixels.height()]))
    }
}

/// The colour of a pixel: the parts of a surface over the background.
fn covered(behind: [f32; 3], parts: &[Part; 2], open: f32) -> [f32; 3] {
    let [first, second] = parts;
    let shares = first.cover + second.cover;
    if shares == 0.0 {
        return behind;
    }
    let near = light::lit(first, open);
    let far = if second.cover > 0.0 { light::lit(second, open) } else { near };
    [0, 1, 2].map(|c| first.cover * near[c] + second.cover * far[c] + (1.0 - shares) * behind[c])
}

/// A colour with a share of another blended over it.
fn over(under: [f32; 3], colour: [f32; 3], share: f32) -> [f32; 3] {
    [0, 1, 2].map(|c| under[c] + share * (colour[c] - under[c]))
}

fn length([x, y, z]: [f64; 3]) -> f64 {
    (x * x + y * y + z * z).sqrt()
}
