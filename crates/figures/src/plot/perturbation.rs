//! How far disturbed stationary shapes are from where they started, over time: what returns falls, what leaves rises.

use crate::cell::Cell;
use crate::drawing::legend::{self, Key, Marker};
use crate::drawing::panel::{Axis, Panel};
use crate::drawing::style::{self, text};
use crate::drawing::{Anchor, Canvas, Drawing, Stroke};
use crate::perturbation::Perturbation;

const WIDTH: f64 = 1000.0;
const HEIGHT: f64 = 600.0;
/// Smallest distance that is drawn, in L_h: below it there is rounding.
const SMALLEST: f64 = 1e-9;
/// Most curves that a legend names.
const NAMED: usize = 12;

/// A disturbed shape and what it is called.
#[derive(Clone, Debug)]
pub struct Watched<'a> {
    /// Its name in the legend.
    pub name: String,
    /// What became of it.
    pub perturbation: &'a Perturbation,
}

/// Draws what became of disturbances of one cell's shape, with noise of several seeds.
pub fn draw(cell: &Cell, watched: &[Watched<'_>]) -> Drawing {
    let mut title = format!("Disturbed stationary shape at R₀ = {}, ε = {}, ξₛ = {}", cell.r0, cell.epsilon, cell.xi_s);
    if !cell.cue.is_none() {
        title += &format!(", cue {}", cell.cue);
    }
    draw_many(&title, watched)
}

/// Draws disturbances of several shapes under a title of their own.
pub fn draw_many(title: &str, watched: &[Watched<'_>]) -> Drawing {
    let mut canvas = Canvas::new(WIDTH, HEIGHT);
    canvas.text([24.0, 30.0], title, text::TITLE, Anchor::Start, style::INK);
    let colour = |k: usize| match watched.len() {
        count if count <= style::SERIES.len() => style::SERIES[k % style::SERIES.len()].to_owned(),
        count => style::ramp(k, count),
    };
    let mut entries: Vec<(Key, String)> = Vec::new();
    if watched.len() <= NAMED {
        let entry = |(k, w): (usize, &Watched<'_>)| {
            let dash = (!w.perturbation.returned()).then_some(style::DASHED);
            (Key::line(&colour(k), dash), w.name.clone())
        };
        entries.extend(watched.iter().enumerate().map(entry));
    }
    entries.push((Key::line(style::INK, None), "returns".to_owned()));
    entries.push((Key::line(style::INK, Some(style::DASHED)), "leaves".to_owned()));
    if watched.iter().any(|w| w.perturbation.division.chi.is_some()) {
        entries.push((Key::point(style::INK, Marker::Disc), "pinches off".to_owned()));
    }
    let top = 46.0 + legend::rows(&mut canvas, [24.0, 42.0], WIDTH - 40.0, &entries);
    let points = || watched.iter().flat_map(|w| w.perturbation.distances.iter().skip(1));
    let last = points().map(|[t, _]| *t).fold(0.0, f64::max);
    let (least, most) = points().fold((1.0, 1e-3), |(low, high): (f64, f64), [_, d]| (low.min(*d), high.max(*d)));
    let up = [10f64.powf(least.max(SMALLEST).log10().floor()), 10f64.powf(most.log10().ceil())];
    let across = Axis::new(style::TIME, [0.0, 1.02 * last]);
    let y = Axis::new("distance dis(t) from the start (Lₕ)", up).logarithmic();
    let map = Panel::new([0.0, top], [WIDTH, HEIGHT - top], across, y).draw(&mut canvas, &[], |_, _| {});
    for (k, w) in watched.iter().enumerate() {
        let dash = (!w.perturbation.returned()).then_some(style::DASHED);
        // What has come back to rounding is drawn no further.
        let drawn = w.perturbation.distances.iter().skip(1).take_while(|[_, distance]| *distance >= up[0]);
        let curve: Vec<[f64; 2]> = drawn.map(|point| map.point(*point)).collect();
        canvas.polyline(&curve, Stroke { colour: &colour(k), width: style::CURVE, dash });
        if let (Some(_), Some(at)) = (w.perturbation.division.chi, curve.last()) {
            legend::point(&mut canvas, *at, 5.5, Marker::Disc, &colour(k));
        }
    }
    canvas.finish()
}
