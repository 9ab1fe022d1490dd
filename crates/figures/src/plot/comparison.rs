//! Size asymmetries of measured divisions beside the model's: by mother, and over the mother's volume.

use measured::events::Division;

use crate::drawing::legend::{self, Key, Marker};
use crate::drawing::panel::{Axis, Mapping, Panel, widened};
use crate::drawing::style::{self, text};
use crate::drawing::{Anchor, Canvas, Drawing, Stroke};
use crate::study::compare::volumes::{Beside, GroupBeside, Modelled};

/// Height of the chart by mother, and of that over volume.
const CHARTS: [f64; 2] = [440.0, 400.0];
/// Width that a picture has at most.
const WIDEST: f64 = 1400.0;

/// Draws groups beside the model, and below them, where single divisions are known, χ over the mother's volume. `micrometres` is
/// one L_h in µm, by which the model's cells have a volume too; `unit` is that of the volumes.
pub fn draw(groups: &[GroupBeside], divisions: &[Division], unit: &str, micrometres: Option<f64>) -> Drawing {
    let mothers = mothers(groups);
    let each = 30.0 + 24.0 * groups.len() as f64;
    // As many mothers in a row as leave the text large enough to be read.
    let in_row = (((WIDEST - 150.0) / each) as usize).clamp(1, mothers.len().max(1));
    let width = (150.0 + in_row as f64 * each).max(760.0);
    let rows: Vec<&[String]> = mothers.chunks(in_row).collect();
    let height = if rows.len() > 1 { CHARTS[0] * 0.75 } else { CHARTS[0] };
    let entries = entries(groups);
    let second = if divisions.is_empty() { 0.0 } else { CHARTS[1] };
    let charts = height * rows.len() as f64 + second;
    let mut canvas = Canvas::new(width, 52.0 + charts + legend::height(width - 40.0, &entries));
    canvas.text([24.0, 30.0], "Size asymmetry of divisions, by mother", text::TITLE, Anchor::Start, style::INK);
    let top = 48.0 + legend::rows(&mut canvas, [24.0, 42.0], width - 40.0, &entries);
    let most = groups.iter().flat_map(|group| &group.events).map(highest).fold(0.3, f64::max);
    for (k, row) in rows.iter().enumerate() {
        let name = if k + 1 == rows.len() { "mother" } else { "" };
        let x = Axis::new(name, [-0.6, in_row as f64 - 0.4]).every(1.0).unnumbered();
        let y = Axis::new(style::CHI, [-0.02, 1.06 * most]);
        let panel = Panel::new([0.0, top + k as f64 * height], [width, height], x, y);
        by_mother(&mut canvas, &panel, groups, row);
    }
    let below = top + height * rows.len() as f64;
    if !divisions.is_empty() {
        over_volume(&mut canvas, [below, width], groups, divisions, unit, micrometres);
    }
    canvas.finish()
}

/// What the legend says.
fn entries(groups: &[GroupBeside]) -> Vec<(Key, String)> {
    let name = |group: &GroupBeside| if group.group.is_empty() { "measured".to_owned() } else { group.group.clone() };
    let of = |(k, group): (usize, &GroupBeside)| {
        let what = format!("{}, mean ± sd of {} embryos", name(group), group.embryos);
        (Key::point(&colour(k), Marker::Disc), what)
    };
    let mut out: Vec<(Key, String)> = groups.iter().enumerate().map(of).collect();
    out.push((Key::point(style::MODEL, Marker::Diamond), "model".to_owned()));
    out.push((Key::point(style::MODEL, Marker::Ring), "model, AB and P1 as measured".to_owned()));
    out
}

/// The largest χ that is drawn of a division.
fn highest(event: &Beside) -> f64 {
    let measured = event.measured.mean + event.measured.sd.unwrap_or(0.0);
    let of = |modelled: &Option<Modelled>| modelled.and_then(|modelled| modelled.chi).unwrap_or(0.0);
    measured.max(of(&event.model)).max(of(&event.given_first))
}

/// One row of mothers.
fn by_mother(canvas: &mut Canvas, panel: &Panel, groups: &[GroupBeside], mothers: &[String]) {
    let map = panel.draw(canvas, &[], |_, _| {});
    for (k, group) in groups.iter().enumerate() {
        let apart = 0.8 / (groups.len() as f64).max(2.0);
        let aside = (k as f64 - 0.5 * groups.len() as f64 + 0.2) * apart;
        for event in &group.events {
            if let Some(place) = mothers.iter().position(|mother| *mother == event.measured.mother) {
                beside(canvas, &map, [place as f64 + aside, apart], event, &colour(k));
            }
        }
    }
    for (k, mother) in mothers.iter().enumerate() {
        let at = [map.point([k as f64, 0.0])[0], map.frame()[3] + 24.0];
        canvas.text(at, mother, text::TICK, Anchor::Middle, style::INK);
    }
}

/// Mothers of all groups, in the order in which they are first told.
fn mothers(groups: &[GroupBeside]) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    for event in groups.iter().flat_map(|group| &group.events) {
        if !out.contains(&event.measured.mother) {
            out.push(event.measured.mother.clone());
        }
    }
    out
}

/// The colour of a group: green is the model's.
fn colour(group: usize) -> String {
    let hues = ["#000000", "#e69f00", "#0072b2", "#cc79a7", "#56b4e9", "#d55e00"];
    hues[group % hues.len()].to_owned()
}

/// A division beside the model's, at `x` and to the right of it by parts of `apart`, the distance of two groups.
fn beside(canvas: &mut Canvas, map: &Mapping, [x, apart]: [f64; 2], event: &Beside, colour: &str) {
    let Beside { measured, model, given_first } = event;
    if let Some(sd) = measured.sd {
        let ends = [measured.mean - sd, measured.mean + sd].map(|y| map.point([x, y.max(-0.02)]));
        legend::error_bar(canvas, ends, 4.0, Stroke::solid(colour, 1.8));
    }
    legend::point(canvas, map.point([x, measured.mean]), 5.5, Marker::Disc, colour);
    for (of, marker, aside) in [(model, Marker::Diamond, 0.3), (given_first, Marker::Ring, 0.6)] {
        if let Some(Modelled { chi: Some(chi), .. }) = of {
            legend::point(canvas, map.point([x + aside * apart, *chi]), 5.5, marker, style::MODEL);
        }
    }
}

/// χ over the mother's volume: every division, the means of the decades, and the model's cells.
fn over_volume(
    canvas: &mut Canvas,
    [top, width]: [f64; 2],
    groups: &[GroupBeside],
    divisions: &[Division],
    unit: &str,
    micrometres: Option<f64>,
) {
    let volume_of = |model: &Modelled, scale: f64| 4.0 / 3.0 * std::f64::consts::PI * (scale * model.r0).powi(3);
    let modelled: Vec<[f64; 2]> = groups
        .iter()
        .flat_map(|group| &group.events)
        .filter_map(|event| Some([volume_of(event.model.as_ref()?, micrometres?), event.model.as_ref()?.chi?]))
        .collect();
    let volumes = divisions.iter().map(Division::mother_volume).chain(modelled.iter().map(|point| point[0]));
    let [least, most] = widened(volumes.map(f64::log10), 0.06);
    let highest = divisions.iter().map(Division::chi).chain(modelled.iter().map(|point| point[1])).fold(0.3, f64::max);
    let x = Axis::new(format!("volume of the mother {unit}"), [10_f64.powf(least), 10_f64.powf(most)]).logarithmic();
    let panel = Panel::new([0.0, top], [width, CHARTS[1]], x, Axis::new(style::CHI, [-0.02, 1.1 * highest]));
    let map = panel.draw(canvas, &[], |_, _| {});
    for division in divisions {
        let group = groups.iter().position(|group| group.group == division.group).unwrap_or(0);
        canvas.disc(map.point([division.mother_volume(), division.chi()]), 3.2, &colour(group), 0.55, None);
    }
    for point in modelled {
        legend::point(canvas, map.point(point), 6.0, Marker::Diamond, style::MODEL);
    }
}
