//! Pictures as pixels.

use tiny_skia::{
    Color, FillRule, LineJoin, Mask, Paint, Path, PathBuilder, Pixmap, Rect, Shader, StrokeDash, Transform,
};
use ttf_parser::{Face, OutlineBuilder};

use super::canvas::{Canvas, Element, Label, Outline, Stroke};
use super::font::{self, BOLD, DROP, INDEX};
use super::style::Colour;
use super::svg::HALO;

impl Canvas {
    /// Red, green and blue of each pixel, row by row, and the width and height in pixels; `None` if there are no pixels
    /// or too many.
    pub(crate) fn pixels(&self, density: f32) -> Option<(Vec<u8>, [u32; 2])> {
        let mut pixmap = self.blank(density)?;
        self.draw_on(&mut pixmap, density)?;
        Some((colours(&pixmap), [pixmap.width(), pixmap.height()]))
    }

    /// White pixels of the size of the canvas; `None` if there are no pixels or too many.
    pub(crate) fn blank(&self, density: f32) -> Option<Pixmap> {
        let [width, height] = self.size.map(|length| (length as f32 * density).round() as u32);
        let mut pixmap = Pixmap::new(width, height)?;
        pixmap.fill(Color::WHITE);
        Some(pixmap)
    }

    /// Draws the canvas over opaque pixels.
    pub(crate) fn draw_on(&self, pixmap: &mut Pixmap, density: f32) -> Option<()> {
        let (width, height) = (pixmap.width(), pixmap.height());
        let face = font::face()?;
        let scale = Transform::from_scale(density, density);
        let mut clip: Option<Mask> = None;
        for element in &self.elements {
            match element {
                Element::Shape(outline, fill, stroke) => {
                    let Some(path) = path(outline) else { continue };
                    if let Some((colour, opacity)) = fill {
                        pixmap.fill_path(&path, &paint(*colour, *opacity), FillRule::Winding, scale, clip.as_ref());
                    }
                    if let Some(stroke) = stroke {
                        let colour = paint(stroke.colour, 1.0);
                        pixmap.stroke_path(&path, &colour, &pen(*stroke), scale, clip.as_ref());
                    }
                }
                Element::Text(label) if label.upwards => upwards(pixmap, &face, label, density, clip.as_ref())?,
                Element::Text(label) => {
                    let [x, y] = label.at.map(|x| x as f32);
                    write(pixmap, &face, label, scale.pre_translate(x, y), clip.as_ref());
                }
                Element::Clip(None) => clip = None,
                Element::Clip(Some(frame)) => {
                    let [left, top, right, bottom] = frame.map(|x| x as f32);
                    let frame = PathBuilder::from_rect(Rect::from_ltrb(left, top, right, bottom)?);
                    let mut mask = Mask::new(width, height)?;
                    mask.fill_path(&frame, FillRule::Winding, true, scale);
                    clip = Some(mask);
                }
            }
        }
        Some(())
    }
}

/// Red, green and blue of opaque pixels.
pub(crate) fn colours(pixmap: &Pixmap) -> Vec<u8> {
    pixmap.data().chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect()
}

fn paint([r, g, b]: Colour, opacity: f64) -> Paint<'static> {
    let shader = Shader::SolidColor(Color::from_rgba8(r, g, b, (255.0 * opacity.clamp(0.0, 1.0)).round() as u8));
    Paint { shader, ..Paint::default() }
}

fn pen(stroke: Stroke) -> tiny_skia::Stroke {
    let dash = stroke.dash.and_then(|dash| StrokeDash::new(dash.map(|x| x as f32).to_vec(), 0.0));
    tiny_skia::Stroke { width: stroke.width as f32, line_join: LineJoin::Round, dash, ..tiny_skia::Stroke::default() }
}

fn path(outline: &Outline) -> Option<Path> {
    let mut builder = PathBuilder::new();
    match outline {
        Outline::Circle([x, y], radius) => return PathBuilder::from_circle(*x as f32, *y as f32, *radius as f32),
        Outline::Lines(lines, closed) => {
            for line in lines {
                for (k, point) in line.iter().enumerate() {
                    let [x, y] = point.map(|x| x as f32);
                    if k == 0 { builder.move_to(x, y) } else { builder.line_to(x, y) }
                }
                if *closed {
                    builder.close();
                }
            }
        }
    }
    builder.finish()
}

/// Draws a horizontal line of text; `place` is the position of its anchor.
fn write(pixmap: &mut Pixmap, face: &Face<'_>, label: &Label, place: Transform, clip: Option<&Mask>) {
    let Some(path) = letters(face, label) else { return };
    let units = f32::from(face.units_per_em());
    let unit = label.size as f32 / units;
    let place = place.pre_scale(unit, unit);
    let wide = |width: f32| tiny_skia::Stroke { width, line_join: LineJoin::Round, ..tiny_skia::Stroke::default() };
    if let Some(rim) = label.halo {
        pixmap.stroke_path(&path, &paint(rim, 1.0), &wide(HALO as f32 / unit), place, clip);
    }
    let colour = paint(label.colour, 1.0);
    pixmap.fill_path(&path, &colour, FillRule::Winding, place, clip);
    if label.bold {
        pixmap.stroke_path(&path, &colour, &wide(BOLD * units), place, clip);
    }
}

/// Draws a line of text from bottom to top: horizontally first, then rotated pixel by pixel. Letters rotated as
/// outlines would fall on different fractions of a pixel and look uneven.
fn upwards(pixmap: &mut Pixmap, face: &Face<'_>, label: &Label, density: f32, clip: Option<&Mask>) -> Option<()> {
    let length = (font::width(&label.content, label.size) as f32 * density).ceil() as u32 + 8;
    let half = (label.size as f32 * density).ceil() as u32 * 2;
    // The whole text fits, whichever part of it lies at its position.
    let (middle, mut lying) = (length, Pixmap::new(2 * length, 2 * half)?);
    let scale = Transform::from_scale(density, density);
    let place = Transform::from_translate(middle as f32, half as f32).pre_concat(scale);
    write(&mut lying, face, label, place, None);
    let mut upright = Pixmap::new(lying.height(), lying.width())?;
    let (wide, high) = (lying.width() as usize, lying.height() as usize);
    for (k, pixel) in lying.pixels().iter().enumerate() {
        upright.pixels_mut()[(wide - 1 - k % wide) * high + k / wide] = *pixel;
    }
    let [x, y] = label.at.map(|x| (x as f32 * density).round() as i32);
    let corner = [x - half as i32, y + middle as i32 - wide as i32];
    let (plain, unturned) = (tiny_skia::PixmapPaint::default(), Transform::identity());
    pixmap.draw_pixmap(corner[0], corner[1], upright.as_ref(), &plain, unturned, clip);
    Some(())
}

/// The outlines of a line of text in units of the font, with its anchor at the origin.
fn letters(face: &Face<'_>, label: &Label) -> Option<Path> {
    let units = f64::from(face.units_per_em());
    let length = (font::width(&label.content, label.size) * units / f64::from(label.size)) as f32;
    let left = label.anchor.beginning(length);
    let mut pen = Pen { builder: PathBuilder::new(), left, scale: 1.0, down: 0.0 };
    for run in font::runs(&label.content) {
        (pen.scale, pen.down) = if run.index { (INDEX as f32, (DROP * units) as f32) } else { (1.0, 0.0) };
        for letter in run.letters.chars() {
            // A character that the font lacks is drawn as its empty box.
            let glyph = face.glyph_index(letter).unwrap_or_default();
            face.outline_glyph(glyph, &mut pen);
            pen.left += pen.scale * f32::from(face.glyph_hor_advance(glyph).unwrap_or(0));
        }
    }
    pen.builder.finish()
}

/// Places the outlines of glyphs side by side; their second coordinate runs upwards.
struct Pen {
    builder: PathBuilder,
    left: f32,
    /// Size of the glyph, and its distance below the base line.
    scale: f32,
    down: f32,
}

impl Pen {
    fn at(&self, x: f32, y: f32) -> (f32, f32) {
        (self.left + self.scale * x, self.down - self.scale * y)
    }
}

impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.builder.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.builder.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let ((x1, y1), (x, y)) = (self.at(x1, y1), self.at(x, y));
        self.builder.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let ((x1, y1), (x2, y2), (x, y)) = (self.at(x1, y1), self.at(x2, y2), self.at(x, y));
        self.builder.cubic_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.builder.close();
    }
}
