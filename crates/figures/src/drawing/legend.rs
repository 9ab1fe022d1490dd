//! What a colour, a dash or a marker stands for.

use super::canvas::{Anchor, Canvas, Stroke};
use super::style::{INK, text};

/// The form of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marker {
    /// A filled disc.
    Disc,
    /// A ring.
    Ring,
    /// A filled square that stands on a corner.
    Diamond,
    /// A filled square.
    Square,
    /// A filled triangle.
    Triangle,
}

/// What stands before a word of a legend.
#[derive(Clone, Debug)]
pub enum Key {
    /// A line.
    Line {
        /// Its colour.
        colour: String,
        /// Its dashes.
        dash: Option<[f64; 2]>,
    },
    /// A point.
    Point {
        /// Its colour.
        colour: String,
        /// Its form.
        marker: Marker,
    },
    /// An area.
    Area {
        /// Its colour.
        colour: String,
    },
}

impl Key {
    /// A line of a colour.
    pub fn line(colour: &str, dash: Option<[f64; 2]>) -> Key {
        Key::Line { colour: colour.to_owned(), dash }
    }

    /// A point of a colour.
    pub fn point(colour: &str, marker: Marker) -> Key {
        Key::Point { colour: colour.to_owned(), marker }
    }

    /// An area of a colour.
    pub fn area(colour: &str) -> Key {
        Key::Area { colour: colour.to_owned() }
    }
}

/// Distance of two lines of a legend.
pub const LINE: f64 = 26.0;

/// Draws a legend as a column, its upper left corner at a point.
pub fn column(canvas: &mut Canvas, [x, y]: [f64; 2], entries: &[(Key, String)]) {
    for (k, (key, word)) in entries.iter().enumerate() {
        let middle = y + LINE * (k as f64 + 0.5);
        draw(canvas, [x, middle], key);
        canvas.text([x + 42.0, middle + 5.0], word, text::TICK, Anchor::Start, INK);
    }
}

/// How wide an entry is, with the gap behind it.
fn width_of(word: &str) -> f64 {
    60.0 + 8.4 * word.chars().count() as f64
}

/// How high [`rows`] are.
pub fn height(width: f64, entries: &[(Key, String)]) -> f64 {
    let (mut at, mut row) = (0.0, 1.0);
    for (_, word) in entries {
        if at > 0.0 && at + width_of(word) > width {
            (at, row) = (0.0, row + 1.0);
        }
        at += width_of(word);
    }
    LINE * row
}

/// Draws a legend as a row, and as many further rows as it takes to stay within `width`; gives how high it is.
pub fn rows(canvas: &mut Canvas, [x, y]: [f64; 2], width: f64, entries: &[(Key, String)]) -> f64 {
    let (mut at, mut row) = (0.0, 0.0);
    for (key, word) in entries {
        let needed = width_of(word);
        if at > 0.0 && at + needed > width {
            (at, row) = (0.0, row + 1.0);
        }
        let middle = y + LINE * (row + 0.5);
        draw(canvas, [x + at, middle], key);
        canvas.text([x + at + 42.0, middle + 5.0], word, text::TICK, Anchor::Start, INK);
        at += needed;
    }
    LINE * (row + 1.0)
}

fn draw(canvas: &mut Canvas, [x, y]: [f64; 2], key: &Key) {
    match key {
        Key::Line { colour, dash } => {
            canvas.polyline(&[[x, y], [x + 34.0, y]], Stroke { colour, width: 3.0, dash: *dash });
        }
        Key::Point { colour, marker } => point(canvas, [x + 17.0, y], 6.5, *marker, colour),
        Key::Area { colour } => {
            let corners = [[x + 6.0, y - 8.0], [x + 28.0, y - 8.0], [x + 28.0, y + 8.0], [x + 6.0, y + 8.0]];
            canvas.polygon(&corners, colour, 1.0, Some(Stroke::solid(INK, 0.6)));
        }
    }
}

/// An error bar from one end to the other, which are above each other, with ticks of half the given width.
pub fn error_bar(canvas: &mut Canvas, ends: [[f64; 2]; 2], half: f64, stroke: Stroke<'_>) {
    canvas.polyline(&ends, stroke);
    for [x, y] in ends {
        canvas.polyline(&[[x - half, y], [x + half, y]], stroke);
    }
}

/// Draws a point of a form, with a thin white rim that keeps it apart from the lines it lies on.
pub fn point(canvas: &mut Canvas, [x, y]: [f64; 2], size: f64, marker: Marker, colour: &str) {
    let rim = Some(Stroke::solid("#ffffff", 1.2));
    let around = |corners: &[[f64; 2]]| -> Vec<[f64; 2]> {
        corners.iter().map(|[dx, dy]| [x + size * dx, y + size * dy]).collect()
    };
    match marker {
        Marker::Disc => canvas.disc([x, y], size, colour, 1.0, rim),
        Marker::Ring => canvas.disc([x, y], size - 0.5, "#ffffff", 1.0, Some(Stroke::solid(colour, 2.4))),
        Marker::Diamond => {
            canvas.polygon(&around(&[[0.0, -1.3], [1.3, 0.0], [0.0, 1.3], [-1.3, 0.0]]), colour, 1.0, rim);
        }
        Marker::Square => {
            canvas.polygon(&around(&[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]), colour, 1.0, rim);
        }
        Marker::Triangle => canvas.polygon(&around(&[[0.0, -1.25], [1.15, 0.9], [-1.15, 0.9]]), colour, 1.0, rim),
    }
}
