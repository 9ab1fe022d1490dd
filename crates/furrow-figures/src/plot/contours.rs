//! Measured outlines of a dividing cell, overlaid with the model's, stage by stage.

use furrow_measured::contour::Contour;
use furrow_measured::contour::series::{ContourMatch, Series};

use crate::drawing::cell::Site;
use crate::drawing::legend::{Key, Legend, titled};
use crate::drawing::style::{self, Colour, text};
use crate::drawing::{Anchor, Canvas, Stroke};

/// Stages in a row.
const IN_ROW: usize = 3;
const WIDTH: f64 = 1080.0;
/// Height of the two lines of text under a stage.
const WORDS: f64 = 50.0;
/// The inside of a measured cell.
const MEASURED: Colour = [0xc9; 3];

/// Draws the stages of a series, ending with the deepest furrow. The long axis is horizontal.
pub fn draw(series: &Series) -> Canvas {
    let mut stages: Vec<&ContourMatch> = series.contours.iter().filter(|beside| beside.stage.is_some()).collect();
    stages.sort_by_cached_key(|beside| beside.stage);
    let in_row = stages.len().clamp(1, IN_ROW);
    let each = (WIDTH - 40.0) / in_row as f64;
    // All stages have the same scale, so that they can be compared.
    let reach = |k: usize| {
        let points = stages.iter().flat_map(|beside| &beside.aligned).flat_map(Contour::points);
        points.map(|point| point[k].abs()).fold(0.0, f64::max)
    };
    let (long, wide) = (reach(1), reach(0));
    let scale = (0.46 * each / long).min(140.0 / wide);
    let height = 2.0 * scale * wide + 24.0 + WORDS;
    let rows = stages.len().div_ceil(in_row);
    let legend = Legend::default().with(Key::Area(MEASURED), "measured").with(Key::Line(style::MODEL), "model");
    let sd = series.similarity_sd.map_or(String::new(), |sd| format!(" ± {sd:.3}"));
    let title = format!("Outlines beside the model: similarity {:.3}{sd}, n = {}", series.similarity, series.n);
    let (mut canvas, top) = titled(WIDTH, height * rows as f64 + 10.0, &title, &legend);
    for (k, beside) in stages.into_iter().enumerate() {
        let centre =
            [20.0 + each * (0.5 + (k % in_row) as f64), top + height * (k / in_row) as f64 + 0.5 * (height - WORDS)];
        stage(&mut canvas, beside, &Site { centre, scale });
        let words = [
            format!("|A∩B|/|A| = {:.3}", beside.overlap.similarity),
            format!("furrow {:.2}, model {:.2}", beside.measured.depth, beside.model.depth),
        ];
        for (line, word) in words.iter().enumerate() {
            let at = [centre[0], centre[1] + 0.5 * (height - WORDS) + 14.0 + 21.0 * line as f64];
            let colour = if line == 0 { style::INK } else { style::MUTED };
            canvas.text(at, word, text::TICK, Anchor::Middle, colour);
        }
    }
    canvas
}

/// Both contours of a stage.
fn stage(canvas: &mut Canvas, beside: &ContourMatch, site: &Site) {
    let closed = |contour: &Contour| -> Vec<[f64; 2]> {
        let points = contour.points();
        points.iter().chain(points.first()).map(|point| site.point([point.x, point.y])).collect()
    };
    let [measured, model] = beside.aligned.each_ref().map(closed);
    canvas.polygon(&measured, MEASURED, 1.0, Some(Stroke::solid(style::OBSERVED, 1.6)));
    canvas.polyline(&model, Stroke::solid(style::MODEL, 2.4));
}
