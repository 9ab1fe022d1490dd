//! Markers and legends.

use super::canvas::{Anchor, Canvas, Stroke};
use super::font;
use super::style::{self, Colour, INK, MUTED, WHITE, text};
use furrow_mechanics::division::Outcome;
use furrow_mechanics::equilibria::curves::Curve;

/// The shape of a marker.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marker {
    /// A filled disc.
    Disc,
    /// A ring.
    Ring,
    /// A filled square on its corner.
    Diamond,
    /// A filled square.
    Square,
    /// A filled triangle.
    Triangle,
}

/// The symbol of a legend entry.
#[derive(Clone, Copy, Debug)]
pub enum Key {
    /// A line of a colour.
    Line(Colour),
    /// A dashed line of a colour, by the lengths of dashes and gaps.
    Dashes(Colour, [f64; 2]),
    /// A point of a colour.
    Point(Colour, Marker),
    /// An area of a colour.
    Area(Colour),
    /// No symbol: text only.
    Nothing,
}

impl Key {
    /// Width of the symbol and the space after it.
    fn width(self) -> f64 {
        if matches!(self, Key::Nothing) { 0.0 } else { 42.0 }
    }
}

/// The entries of a legend, in order.
#[derive(Clone, Debug, Default)]
pub struct Legend(Vec<(Key, String)>);

/// Distance between two lines of a legend.
const LINE: f64 = 26.0;

impl Legend {
    /// Adds an entry.
    pub fn with(self, key: Key, word: impl Into<String>) -> Legend {
        self.with_if(true, key, word)
    }

    /// Adds an entry if it is shown.
    pub fn with_if(mut self, shown: bool, key: Key, word: impl Into<String>) -> Legend {
        if shown {
            self.0.push((key, word.into()));
        }
        self
    }

    /// Adds entries.
    pub fn with_all<W: Into<String>>(self, entries: impl IntoIterator<Item = (Key, W)>) -> Legend {
        entries.into_iter().fold(self, |legend, (key, word)| legend.with(key, word))
    }

    /// Adds the tiles of a map of outcomes, of which `has` tells the shown ones; `None` is an undecided division.
    pub fn with_tiles(self, has: impl Fn(Option<Outcome>) -> bool) -> Legend {
        let tiles = [
            (Some(Outcome::Symmetric), "symmetric"),
            (Some(Outcome::Asymmetric), "asymmetric, χ by shade"),
            (Some(Outcome::Arrested), "stays at rest"),
            (None, "undecided"),
        ];
        let shown = tiles.into_iter().filter(|(outcome, _)| has(*outcome));
        self.with_all(shown.map(|(outcome, word)| (Key::Area(style::tile(outcome, Some(0.7))), word)))
    }

    /// Adds curves above which disturbances of these wave numbers grow.
    pub fn with_azimuthal<'a>(self, curves: impl IntoIterator<Item = &'a (usize, Curve)>) -> Legend {
        self.with_all(curves.into_iter().map(|(m, _)| {
            let words = format!("disturbances cos {}φ grow above", style::factor(*m));
            (Key::Line(style::azimuthal(*m)), words)
        }))
    }

    /// Positions of the entries in rows of at most the given width.
    fn places(&self, width: f64) -> Vec<[f64; 2]> {
        let (mut at, mut row) = (0.0, 0.0);
        let mut places = Vec::new();
        for (key, word) in &self.0 {
            let needed = key.width() + 20.0 + font::width(word, text::TICK);
            if at > 0.0 && at + needed > width {
                (at, row) = (0.0, row + 1.0);
            }
            places.push([at, LINE * (row + 0.5)]);
            at += needed;
        }
        places
    }

    /// Its height in rows of at most the given width.
    pub fn height(&self, width: f64) -> f64 {
        self.places(width).last().map_or(0.0, |[_, middle]| middle + 0.5 * LINE)
    }

    /// Draws it in rows of at most the given width, with its upper left corner at the given point.
    pub fn draw(&self, canvas: &mut Canvas, [x, y]: [f64; 2], width: f64) {
        for ((key, word), [dx, dy]) in self.0.iter().zip(self.places(width)) {
            let (x, y) = (x + dx, y + dy);
            let line = [[x, y], [x + 34.0, y]];
            match *key {
                Key::Line(colour) => canvas.polyline(&line, Stroke::solid(colour, 3.0)),
                Key::Dashes(colour, dash) => canvas.polyline(&line, Stroke::dashed(colour, 3.0, dash)),
                Key::Point(colour, marker) => point(canvas, [x + 17.0, y], 6.5, marker, colour),
                Key::Nothing => {}
                Key::Area(colour) => {
                    let corners = [[x + 6.0, y - 8.0], [x + 28.0, y - 8.0], [x + 28.0, y + 8.0], [x + 6.0, y + 8.0]];
                    canvas.polygon(&corners, colour, 1.0, Some(Stroke::solid(INK, 0.6)));
                }
            }
            canvas.text([x + key.width(), y + 5.0], word, text::TICK, Anchor::Start, INK);
        }
    }
}

/// A canvas with a title, its further lines in smaller text, and a legend, above a free area of height `below`, with
/// the y coordinate where that area begins. Lines too long for the canvas are broken.
pub fn titled(width: f64, below: f64, title: &str, legend: &Legend) -> (Canvas, f64) {
    let style = |k: usize| if k == 0 { (text::TITLE, INK) } else { (text::TICK, MUTED) };
    let broken = |(k, line)| font::wrapped(line, style(k).0, width - 44.0).into_iter().map(move |line| (k, line));
    let title: Vec<(usize, String)> = title.lines().enumerate().flat_map(broken).collect();
    let lines = 18.0 + 24.0 * title.len() as f64;
    let top = lines + legend.height(width - 40.0) + 4.0;
    let mut canvas = Canvas::new(width, top + below);
    for (row, (k, line)) in title.iter().enumerate() {
        let (size, colour) = style(*k);
        canvas.text([24.0, 30.0 + 24.0 * row as f64], line, size, Anchor::Start, colour);
    }
    legend.draw(&mut canvas, [24.0, lines], width - 40.0);
    (canvas, top)
}

/// Draws a marker with a thin white rim that separates it from the lines below it.
pub fn point(canvas: &mut Canvas, [x, y]: [f64; 2], size: f64, marker: Marker, colour: Colour) {
    let rim = Some(Stroke::solid(WHITE, 1.2));
    let corners: &[[f64; 2]] = match marker {
        Marker::Disc => return canvas.disc([x, y], size, colour, 1.0, rim),
        Marker::Ring => return canvas.disc([x, y], size - 0.5, WHITE, 1.0, Some(Stroke::solid(colour, 2.4))),
        Marker::Diamond => &[[0.0, -1.3], [1.3, 0.0], [0.0, 1.3], [-1.3, 0.0]],
        Marker::Square => &[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]],
        Marker::Triangle => &[[0.0, -1.25], [1.15, 0.9], [-1.15, 0.9]],
    };
    let around: Vec<[f64; 2]> = corners.iter().map(|[dx, dy]| [x + size * dx, y + size * dy]).collect();
    canvas.polygon(&around, colour, 1.0, rim);
}
