//! A canvas for lines, areas and text, and the picture on it as SVG or PNG.

use std::fmt::Write;
use std::path::Path;

use kuva::RasterBackend;
use kuva::backend::svg::SvgBackend;
use kuva::render::color::Color;
use kuva::render::render::{PathData, Primitive, Scene, TextAnchor};

/// Fonts by name, the first that the reader has; PNG has the first, which comes with the program.
pub const FONTS: &str = "DejaVu Sans, Verdana, Arial, sans-serif";
/// Dots of a PNG for each unit of the canvas.
const DENSITY: f32 = 2.0;

/// Why a picture could not be made.
#[derive(Debug, thiserror::Error)]
pub enum FigureError {
    /// It could not be turned into dots.
    #[error("the picture could not be drawn: {0}")]
    Raster(String),
    /// The dots of a movie could not be read back.
    #[error(transparent)]
    Png(#[from] png::DecodingError),
    /// An animated PNG could not be put together.
    #[error(transparent)]
    Apng(#[from] png::EncodingError),
    /// A GIF could not be put together.
    #[error(transparent)]
    Gif(#[from] gif::EncodingError),
}

/// What kind of file a picture becomes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Lines and text, at any size.
    Svg,
    /// Dots.
    Png,
}

impl Format {
    /// By the extension of a file, in any case; none if it is neither `.svg` nor `.png`.
    pub fn of(path: &Path) -> Option<Format> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        match extension.as_str() {
            "svg" => Some(Format::Svg),
            "png" => Some(Format::Png),
            _ => None,
        }
    }
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug)]
pub struct Stroke<'a> {
    /// Colour.
    pub colour: &'a str,
    /// Width.
    pub width: f64,
    /// Lengths of dashes and of the gaps between them.
    pub dash: Option<[f64; 2]>,
}

impl<'a> Stroke<'a> {
    /// An unbroken line.
    pub fn solid(colour: &'a str, width: f64) -> Stroke<'a> {
        Stroke { colour, width, dash: None }
    }

    /// A broken line.
    pub fn dashed(colour: &'a str, width: f64, dash: [f64; 2]) -> Stroke<'a> {
        Stroke { colour, width, dash: Some(dash) }
    }
}

/// Which part of a text stands at its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// Its beginning.
    Start,
    /// Its middle.
    Middle,
    /// Its end.
    End,
}

/// A canvas; x runs to the right and y downwards.
#[derive(Debug)]
pub struct Canvas {
    scene: Scene,
}

/// A finished picture.
///
/// # Examples
/// A division as its chart, and as the dots of a small movie:
///
/// ```
/// use figures::movie::{Movie, MovieFormat};
/// use figures::plot;
/// use mechanics::cell::Cell;
/// use mechanics::division::{DivisionInput, film};
/// let cell = Cell::new(3.0);
/// let film = film(&DivisionInput::new(cell.clone()))?;
/// assert!(plot::division::draw(&cell, &film).svg().starts_with("<svg"));
/// let movie = Movie { cell: &cell, film: &film, frames: 2 };
/// assert!(movie.bytes(MovieFormat::Gif)?.starts_with(b"GIF89a"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Drawing {
    scene: Scene,
}

impl Canvas {
    /// A white canvas.
    pub fn new(width: f64, height: f64) -> Canvas {
        let mut scene = Scene::new(width, height);
        scene.background_color = Some("white".to_owned());
        scene.font_family = Some(FONTS.to_owned());
        Canvas { scene }
    }

    /// Its width.
    pub fn width(&self) -> f64 {
        self.scene.width
    }

    /// A line through points. Dashes are cut here and run on from one short piece to the next, which in dots they would not.
    pub fn polyline(&mut self, points: &[[f64; 2]], stroke: Stroke<'_>) {
        let mut put = |points: Vec<(f64, f64)>| {
            if points.len() > 1 {
                self.scene.add(Primitive::PolyLine {
                    points,
                    stroke: Color::from(stroke.colour),
                    stroke_width: stroke.width,
                    stroke_dasharray: None,
                });
            }
        };
        match stroke.dash {
            None => put(points.iter().map(|[x, y]| (*x, *y)).collect()),
            Some(dash) => dashes(points, dash).into_iter().for_each(put),
        }
    }

    /// A closed area, seen through where `opacity` is below 1; an outline if there is one.
    pub fn polygon(&mut self, points: &[[f64; 2]], fill: &str, opacity: f64, outline: Option<Stroke<'_>>) {
        let mut d = String::new();
        for (k, [x, y]) in points.iter().enumerate() {
            let _ = write!(d, "{}{x:.2} {y:.2}", if k == 0 { 'M' } else { 'L' });
        }
        d.push('Z');
        self.scene.add(Primitive::Path(Box::new(PathData {
            d,
            fill: Some(Color::from(fill)),
            stroke: outline.map_or(Color::None, |stroke| Color::from(stroke.colour)),
            stroke_width: outline.map_or(0.0, |stroke| stroke.width),
            opacity: (opacity < 1.0).then_some(opacity),
            stroke_dasharray: None,
        })));
    }

    /// Small areas of one colour, whose corners need not be told as exactly.
    pub fn facets(&mut self, areas: impl Iterator<Item = impl AsRef<[[f64; 2]]>>, fill: &str) {
        let mut d = String::new();
        for corners in areas {
            for (k, [x, y]) in corners.as_ref().iter().enumerate() {
                let _ = write!(d, "{}{x:.1} {y:.1}", if k == 0 { 'M' } else { 'L' });
            }
            d.push('Z');
        }
        self.scene.add(Primitive::Path(Box::new(PathData {
            d,
            fill: Some(Color::from(fill)),
            stroke: Color::None,
            stroke_width: 0.0,
            opacity: None,
            stroke_dasharray: None,
        })));
    }

    /// A rectangle.
    pub fn rectangle(&mut self, [x, y]: [f64; 2], [width, height]: [f64; 2], fill: &str, opacity: f64) {
        self.scene.add(Primitive::Rect {
            x,
            y,
            width,
            height,
            fill: Color::from(fill),
            stroke: None,
            stroke_width: None,
            opacity: (opacity < 1.0).then_some(opacity),
        });
    }

    /// A disc.
    pub fn disc(&mut self, [x, y]: [f64; 2], radius: f64, fill: &str, opacity: f64, outline: Option<Stroke<'_>>) {
        self.scene.add(Primitive::Circle {
            cx: x,
            cy: y,
            r: radius,
            fill: Color::from(fill),
            fill_opacity: (opacity < 1.0).then_some(opacity),
            stroke: outline.map(|stroke| Color::from(stroke.colour)),
            stroke_width: outline.map(|stroke| stroke.width),
        });
    }

    /// A line of text on a base line.
    pub fn text(&mut self, [x, y]: [f64; 2], content: &str, size: u32, anchor: Anchor, colour: &str) {
        self.words([x, y], content, size, anchor, colour, None, false);
    }

    /// The same in bold.
    pub fn bold(&mut self, at: [f64; 2], content: &str, size: u32, anchor: Anchor, colour: &str) {
        self.words(at, content, size, anchor, colour, None, true);
    }

    /// Text that runs upwards.
    pub fn upwards(&mut self, at: [f64; 2], content: &str, size: u32, colour: &str) {
        self.words(at, content, size, Anchor::Middle, colour, Some(-90.0), false);
    }

    fn words(
        &mut self,
        [x, y]: [f64; 2],
        content: &str,
        size: u32,
        anchor: Anchor,
        colour: &str,
        rotate: Option<f64>,
        bold: bool,
    ) {
        let anchor = match anchor {
            Anchor::Start => TextAnchor::Start,
            Anchor::Middle => TextAnchor::Middle,
            Anchor::End => TextAnchor::End,
        };
        self.scene.add(Primitive::Text {
            x,
            y,
            // A dollar would begin a formula.
            content: content.replace('$', "\\$"),
            size,
            anchor,
            rotate,
            bold,
            color: Some(Color::from(colour)),
        });
    }

    /// An arrow from one point to another, with a head that fits its length.
    pub fn arrow(&mut self, from: [f64; 2], to: [f64; 2], colour: &str, width: f64) {
        let along = [to[0] - from[0], to[1] - from[1]];
        let length = along[0].hypot(along[1]);
        if length < 1.5 {
            return;
        }
        let (ux, uy) = (along[0] / length, along[1] / length);
        let head = (0.45 * length).min(4.0 * width);
        let aside = |[x, y]: [f64; 2], by: f64| [x - by * uy, y + by * ux];
        let neck = [to[0] - head * ux, to[1] - head * uy];
        let (thick, wide) = (0.5 * width, 0.5 * head.max(1.6 * width));
        let corners = [
            aside(from, thick),
            aside(neck, thick),
            aside(neck, wide),
            to,
            aside(neck, -wide),
            aside(neck, -thick),
            aside(from, -thick),
        ];
        self.facets(std::iter::once(corners), colour);
    }

    /// Puts another picture on this one, its upper left corner at a point; of its first clipped part the beginning is where
    /// `under` is put, behind the data and before the grid.
    pub(super) fn place(&mut self, picture: Scene, [x, y]: [f64; 2], under: Option<Canvas>) {
        self.scene.defs.extend(picture.defs);
        let moved = Some(format!("translate({x},{y})"));
        self.scene.add(Primitive::GroupStart { transform: moved, title: None, extra_attrs: None });
        let mut under = under;
        for element in picture.elements {
            let begins = matches!(element, Primitive::ClipStart { .. });
            self.scene.add(element);
            if let Some(under) = under.take_if(|_| begins) {
                under.scene.elements.into_iter().for_each(|element| self.scene.add(element));
            }
        }
        self.scene.add(Primitive::GroupEnd);
    }

    /// The picture.
    pub fn finish(self) -> Drawing {
        Drawing { scene: self.scene }
    }
}

/// The dashes of a broken line through points.
fn dashes(points: &[[f64; 2]], [dash, gap]: [f64; 2]) -> Vec<Vec<(f64, f64)>> {
    let mut found = Vec::new();
    let mut open: Vec<(f64, f64)> = points.first().map(|[x, y]| (*x, *y)).into_iter().collect();
    let (mut drawing, mut left) = (true, dash);
    for pair in points.windows(2) {
        let ([x, y], [x2, y2]) = (pair[0], pair[1]);
        let length = (x2 - x).hypot(y2 - y);
        let mut passed = 0.0;
        while length - passed > left {
            passed += left;
            let share = passed / length;
            let here = (x + share * (x2 - x), y + share * (y2 - y));
            if drawing {
                open.push(here);
                found.push(std::mem::take(&mut open));
            } else {
                open = vec![here];
            }
            drawing = !drawing;
            left = if drawing { dash } else { gap };
        }
        left -= length - passed;
        if drawing {
            open.push((x2, y2));
        }
    }
    if drawing {
        found.push(open);
    }
    found
}

/// Digits behind the point with which a number is told to be one that was meant to have two.
const NOISY: usize = 9;

/// A picture without the last digits of numbers such as 14.120000000000001, which are most of its length.
fn without_noise(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find('.') {
        let digits = rest[at + 1..].bytes().take_while(u8::is_ascii_digit).count();
        let begin = rest[..at].rfind(|c: char| !c.is_ascii_digit() && c != '-').map_or(0, |k| k + 1);
        let end = at + 1 + digits;
        match rest.get(begin..end).and_then(|number| number.parse::<f64>().ok()).filter(|_| digits >= NOISY) {
            Some(number) => {
                out.push_str(&rest[..begin]);
                let _ = write!(out, "{}", (number * 100.0).round() / 100.0);
            }
            None => out.push_str(&rest[..end]),
        }
        rest = &rest[end..];
    }
    out.push_str(rest);
    out
}

impl Drawing {
    /// As a file of that format.
    ///
    /// # Errors
    /// [`FigureError::Raster`].
    pub fn bytes(&self, format: Format) -> Result<Vec<u8>, FigureError> {
        match format {
            Format::Svg => Ok(self.svg().into_bytes()),
            Format::Png => self.png(DENSITY),
        }
    }

    /// As SVG.
    pub fn svg(&self) -> String {
        let mut text = without_noise(&SvgBackend::new().render_scene(&self.scene));
        if !text.ends_with('\n') {
            text.push('\n');
        }
        text
    }

    /// As PNG, with so many dots for each unit of the canvas.
    ///
    /// # Errors
    /// [`FigureError::Raster`].
    pub fn png(&self, density: f32) -> Result<Vec<u8>, FigureError> {
        RasterBackend::new().with_scale(density).render_scene(&self.scene).map_err(FigureError::Raster)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dashes_run_on_from_one_piece_of_a_line_to_the_next() {
        let points: Vec<[f64; 2]> = (0..=100).map(|k| [f64::from(k), 0.0]).collect();
        let found = dashes(&points, [9.0, 6.0]);
        assert_eq!(found.len(), 7);
        for (k, dash) in found.iter().enumerate() {
            let (first, last) = (dash[0].0, dash[dash.len() - 1].0);
            assert!((first - 15.0 * k as f64).abs() < 1e-9, "{first}");
            assert!((last - first - 9.0).abs() < 1e-9 || last == 100.0);
        }
    }

    #[test]
    fn numbers_lose_their_noise_and_nothing_else() {
        let noisy = "<path d=\"M14.120000000000001 -0.35000000000000003L3 4.5\"/>χ = 0.1546. 1.7063 ü.";
        assert_eq!(without_noise(noisy), "<path d=\"M14.12 -0.35L3 4.5\"/>χ = 0.1546. 1.7063 ü.");
    }

    #[test]
    fn formats_are_told_by_the_extension_in_any_case() {
        assert_eq!(Format::of(Path::new("a/b.SVG")), Some(Format::Svg));
        assert_eq!(Format::of(Path::new("x.y.png")), Some(Format::Png));
        assert_eq!(Format::of(Path::new("svg")), None);
        assert_eq!(Format::of(Path::new("a.pdf")), None);
    }
}
