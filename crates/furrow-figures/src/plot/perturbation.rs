//! Distances of perturbed stationary shapes from the stationary shape over time: they fall for shapes that return, and
//! rise for those that leave.

use crate::drawing::legend::{Key, Legend, Marker, titled};
use crate::drawing::panel::{Axis, Chart};
use crate::drawing::style::{self, SERIES};
use crate::drawing::{Canvas, Stroke};
use furrow_mechanics::perturbation::Perturbation;

const WIDTH: f64 = 1000.0;
const CHART: f64 = 528.0;
/// Smallest distance drawn, in L_h: below it rounding dominates.
const SMALLEST: f64 = 1e-9;
/// Most curves with an entry in the legend.
const NAMED: usize = 12;

/// Draws perturbed shapes, named in the legend.
pub fn draw(title: &str, watched: &[(String, Perturbation)]) -> Canvas {
    let colour = |k: usize| style::series(k, watched.len(), &SERIES);
    let key = |colour, returned| if returned { Key::Line(colour) } else { Key::Dashes(colour, style::DASHED) };
    let named = watched.iter().enumerate().filter(|_| watched.len() <= NAMED);
    let named = named.map(|(k, (name, perturbation))| (key(colour(k), perturbation.returned()), name.as_str()));
    let divided = watched.iter().any(|(_, perturbation)| perturbation.division.chi().is_some());
    let returned = |returned: bool| watched.iter().any(|(_, perturbation)| perturbation.returned() == returned);
    let legend = Legend::default()
        .with_all(named)
        .with_if(returned(true), key(style::INK, true), "returns")
        .with_if(returned(false), key(style::INK, false), "leaves")
        .with_if(divided, Key::Point(style::INK, Marker::Disc), "pinches off");
    let points = || watched.iter().flat_map(|(_, perturbation)| perturbation.distances.iter().skip(1));
    let cut = points().any(|[_, distance]| *distance < SMALLEST);
    let note = if cut { "\ncurves end at 1e-9 Lₕ, below which distances are rounding errors" } else { "" };
    let (mut canvas, top) = titled(WIDTH, CHART, &format!("{title}{note}"), &legend);
    let last = points().map(|[t, _]| *t).fold(0.0, f64::max);
    let (least, most) = points().fold((1.0, 1e-3), |(low, high): (f64, f64), [_, d]| (low.min(*d), high.max(*d)));
    let up = [10f64.powf(least.max(SMALLEST).log10().floor()), 10f64.powf(most.log10().ceil())];
    let across = Axis::new(style::TIME, [0.0, 1.02 * last]);
    let y = Axis::new("distance dis(t) from the start (Lₕ)", up).logarithmic();
    let mut chart = Chart::new(&mut canvas, [0.0, top], [WIDTH, CHART], across, y);
    for (k, (_, perturbation)) in watched.iter().enumerate() {
        let dash = (!perturbation.returned()).then_some(style::DASHED);
        // A curve ends where its distance reaches rounding.
        let drawn: Vec<[f64; 2]> =
            perturbation.distances.iter().skip(1).take_while(|[_, distance]| *distance >= up[0]).copied().collect();
        chart.line(drawn.iter().copied(), Stroke { colour: colour(k), width: style::CURVE, dash });
        if let (Some(_), Some(end)) = (perturbation.division.chi(), drawn.last()) {
            chart.point(*end, 5.5, Marker::Disc, colour(k));
        }
    }
    canvas
}
