//! Pictures as pixels.

use tiny_skia::{
    Color, FillRule, LineJoin, Mask, Paint, Path, PathBuilder, Pixmap, Rect, Shader, StrokeDash, Transform,
};
use ttf_parser::{Face, GlyphId, OutlineBuilder};

use super::canvas::{Anchor, Canvas, Element, Outline, Stroke, Words};
use super::style::Colour;

/// DejaVu Sans, without the scripts that no name of a quantity or a cell is written in (`fonts/README.md`).
const FONT: &[u8] = include_bytes!("../../fonts/DejaVuSans.ttf");
/// Width of the outline that makes text bold, as a share of its size.
const BOLD: f32 = 0.05;

impl Canvas {
    /// Red, green and blue of each pixel, row by row, and how many there are across and down; `None` if these are none or
    /// too many.
    pub(crate) fn pixels(&self, density: f32) -> Option<(Vec<u8>, [u32; 2])> {
        let [width, height] = self.size.map(|length| (length as f32 * density).round() as u32);
        let mut pixmap = Pixmap::new(width, height)?;
        pixmap.fill(Color::WHITE);
        let face = Face::parse(FONT, 0).ok()?;
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
                Element::Text(words) => {
                    let Some(path) = letters(&face, words) else { continue };
                    let [x, y] = words.at.map(|x| x as f32);
                    let place = scale.pre_translate(x, y).pre_rotate(if words.upwards { -90.0 } else { 0.0 });
                    let unit = words.size as f32 / f32::from(face.units_per_em());
                    let place = place.pre_scale(unit, unit);
                    let colour = paint(words.colour, 1.0);
                    pixmap.fill_path(&path, &colour, FillRule::Winding, place, clip.as_ref());
                    if words.bold {
                        let width = BOLD * f32::from(face.units_per_em());
                        let pen = tiny_skia::Stroke { width, ..tiny_skia::Stroke::default() };
                        pixmap.stroke_path(&path, &colour, &pen, place, clip.as_ref());
                    }
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
        // Nothing can be seen through.
        let colours = pixmap.data().chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
        Some((colours, [width, height]))
    }
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

/// The outlines of a line of text in units of the font, whose anchor is the origin.
fn letters(face: &Face<'_>, words: &Words) -> Option<Path> {
    // What the font lacks is drawn as its empty box.
    let glyphs: Vec<_> = words.content.chars().map(|letter| face.glyph_index(letter).unwrap_or_default()).collect();
    let advance = |glyph: &GlyphId| f32::from(face.glyph_hor_advance(*glyph).unwrap_or(0));
    let length: f32 = glyphs.iter().map(advance).sum();
    let left = match words.anchor {
        Anchor::Start => 0.0,
        Anchor::Middle => -0.5 * length,
        Anchor::End => -length,
    };
    let mut pen = Pen { builder: PathBuilder::new(), left };
    for glyph in glyphs {
        face.outline_glyph(glyph, &mut pen);
        pen.left += advance(&glyph);
    }
    pen.builder.finish()
}

/// Puts the outlines of glyphs, whose second coordinate runs upwards, side by side.
struct Pen {
    builder: PathBuilder,
    left: f32,
}

impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.builder.move_to(self.left + x, -y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.builder.line_to(self.left + x, -y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.builder.quad_to(self.left + x1, -y1, self.left + x, -y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.builder.cubic_to(self.left + x1, -y1, self.left + x2, -y2, self.left + x, -y);
    }

    fn close(&mut self) {
        self.builder.close();
    }
}
