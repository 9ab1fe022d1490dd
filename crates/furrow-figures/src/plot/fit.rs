//! Fits to the embryo: the front between its counts and the published thresholds, activities by founder, a cue's χ.

use crate::drawing::legend::{Key, Legend, Marker, titled};
use crate::drawing::panel::{Axis, Chart, Mark, widened};
use crate::drawing::{Canvas, Stroke, style};
use furrow_analysis::fit::{ChiResidual, FittedConstants, FittedCue, FounderActivity};

const WIDTH: f64 = 900.0;
const CHART: f64 = 488.0;
/// Height of a founder in the chart of activities.
const ROW: f64 = 40.0;

/// Draws the front: the deviation of the mean rounds over the deviation of the published thresholds.
pub fn draw_constants(found: &FittedConstants) -> Canvas {
    let name = |(parameter, value): &(_, f64)| format!("{} = {value:.4}", style::symbol(*parameter));
    let constants: Vec<String> = found.best.constants.iter().map(name).collect();
    let at = |rms: Option<f64>, rounds: f64| Some([100.0 * rms?, rounds]);
    let front: Vec<[f64; 2]> = found.front.iter().filter_map(|set| at(set.thresholds_rms, set.parts.rounds)).collect();
    let [best, start] = [&found.best, &found.start].map(|set| at(set.thresholds_rms, set.parts.rounds));
    let legend = Legend::default()
        .with_if(!front.is_empty(), Key::Point(style::MODEL, Marker::Disc), "front")
        .with_if(best.is_some(), Key::Point(style::ASYMMETRIC, Marker::Diamond), "best by the embryo alone")
        .with_if(start.is_some(), Key::Point(style::INK, Marker::Square), "start");
    let (mut canvas, top) = titled(WIDTH, CHART, &format!("Best constants\n{}", constants.join(", ")), &legend);
    let all: Vec<[f64; 2]> = front.iter().copied().chain(best).chain(start).collect();
    let x = Axis::over("published thresholds, off by (%, root mean square)", all.iter().map(|point| point[0]));
    let y = Axis::over("mean rounds of the founders, off by", all.iter().map(|point| point[1]));
    let mut chart = Chart::new(&mut canvas, [0.0, top], [WIDTH, CHART], x, y);
    let marks = front.into_iter().map(|at| (at, Marker::Disc, style::MODEL));
    let ends = [(best, Marker::Diamond, style::ASYMMETRIC), (start, Marker::Square, style::INK)];
    let marks: Vec<Mark> =
        marks.chain(ends.into_iter().filter_map(|(at, marker, colour)| Some((at?, marker, colour)))).collect();
    chart.marks(&marks, 6.5);
    canvas
}

/// Whether the nearest activity is drawn, because no activity gives the observed rounds.
fn nearest(founder: &FounderActivity) -> bool {
    founder.intervals.is_empty() && founder.nearest.is_some()
}

/// Draws the activities at which each founder has the observed rounds; `xi_s` is the activity of the run.
pub fn draw_activities(founders: &[FounderActivity], xi_s: f64) -> Canvas {
    let diamond = Key::Point(style::ASYMMETRIC, Marker::Diamond);
    let observed = founders.iter().any(|founder| !founder.intervals.is_empty());
    let own = || founders.iter().enumerate().filter(|(_, founder)| founder.run_xi_s != xi_s);
    let legend = Legend::default()
        .with_if(observed, Key::Area(style::MODEL), "as observed, to half a round")
        .with_if(founders.iter().any(nearest), diamond, "nearest tried, where there is none")
        .with(Key::Dashes(style::MUTED, style::DASHED), "of all others")
        .with_if(own().next().is_some(), Key::Line(style::INK), "its own, by the lineage file");
    let height = 78.0 + ROW * founders.len() as f64;
    let title = "Activity with which each founder has the observed rounds";
    let (mut canvas, top) = titled(WIDTH, height, title, &legend);
    let ends = founders.iter().flat_map(|f| f.intervals.iter().flatten().copied().chain(f.nearest.map(|(xi, _)| xi)));
    let given = founders.iter().map(|founder| founder.run_xi_s);
    let x = Axis::new(style::ACTIVITY, widened(ends.chain([xi_s]).chain(given), 0.06));
    let y = Axis::names("", founders.iter().map(|founder| founder.name.clone()).collect(), true);
    let [low, high] = y.range;
    let mut chart = Chart::new(&mut canvas, [0.0, top], [WIDTH, height], x, y);
    chart.line([[xi_s, low], [xi_s, high]], Stroke::dashed(style::MUTED, 1.8, style::DASHED));
    for (k, founder) in founders.iter().enumerate() {
        let y = k as f64;
        for [from, to] in &founder.intervals {
            chart.area([*from, y - 0.28], [*to, y + 0.28], 3.0, style::MODEL, 1.0);
        }
        if let (true, Some((xi, _))) = (founder.intervals.is_empty(), founder.nearest) {
            chart.point([xi, y], 6.5, Marker::Diamond, style::ASYMMETRIC);
        }
    }
    for (k, founder) in own() {
        let (x, y) = (founder.run_xi_s, k as f64);
        chart.line([[x, y - 0.42], [x, y + 0.42]], Stroke::solid(style::INK, 2.0));
    }
    canvas
}

/// Draws the measured χ beside the model's with the best cue, and the data left out of the fit beside the predictions.
pub fn draw_cue(found: &FittedCue) -> Canvas {
    let all: Vec<&ChiResidual> = found.residuals.iter().chain(&found.out_of_sample).collect();
    let (modelled, predicted) = (all.iter().any(|r| r.computed.is_some()), !found.out_of_sample.is_empty());
    let legend = Legend::default().with(Key::Point(style::OBSERVED, Marker::Disc), "measured, mean ± sd").with_if(
        modelled,
        Key::Point(style::MODEL, Marker::Diamond),
        "model",
    );
    let (mut canvas, top) = titled(WIDTH, CHART, &format!("Best cue: χ² = {:.1}", found.goodness.chi_squared), &legend);
    let most = all.iter().flat_map(|r| [r.measured + r.sd, r.computed.unwrap_or(0.0)]).fold(0.1, f64::max);
    let cells = all.iter().map(|residual| residual.cell.clone()).collect();
    let label = if predicted { "division (predicted ones behind the line)" } else { "division" };
    let x = Axis::names(label, cells, false);
    let y = Axis::new(style::CHI, [-0.02, 1.08 * most]);
    let mut chart = Chart::new(&mut canvas, [0.0, top], [WIDTH, CHART], x, y);
    let border = found.residuals.len() as f64 - 0.5;
    if predicted {
        chart.line([[border, 0.0], [border, 1.05 * most]], Stroke::dashed(style::MUTED, 1.6, style::DASHED));
    }
    for (k, residual) in all.iter().enumerate() {
        let (x, ChiResidual { measured, sd, .. }) = (k as f64, *residual);
        chart.line([[x, measured - sd], [x, measured + sd]], Stroke::solid(style::OBSERVED, 1.8));
        chart.point([x, *measured], 6.0, Marker::Disc, style::OBSERVED);
        if let Some(chi) = residual.computed {
            chart.point([x + 0.1, chi], 6.5, Marker::Diamond, style::MODEL);
        }
    }
    canvas
}
