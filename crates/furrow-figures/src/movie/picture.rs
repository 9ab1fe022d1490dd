//! One frame of a movie.

use std::f64::consts::{FRAC_PI_2, TAU};

use super::surface::{self, Fineness, View};
use crate::drawing::cell::{ANTERIOR, POSTERIOR, changes, cue_colours};
use crate::drawing::font;
use crate::drawing::regulator::PhiRange;
use crate::drawing::style::{self, FORCES, text};
use crate::drawing::{Anchor, Canvas, Label, Stroke};
use furrow_cell::Cell;
use furrow_mechanics::division::{Outcome, Snapshot, Trajectory};

/// Width and height of a frame.
pub const SIZE: [f64; 2] = [680.0, 460.0];
/// Arrows on each side of the axis.
const ARROWS: usize = 44;
/// Length of the longest arrow.
const LONGEST: f64 = 42.0;

/// The data that all frames of a movie share.
pub struct Stage<'a> {
    cell: &'a Cell,
    film: &'a Trajectory,
    view: View,
    /// The force of the longest arrow.
    largest: f64,
    /// The resolution of the surface.
    fineness: Fineness,
    /// The range of φ to which the colours of a regulator refer.
    phi: Option<PhiRange>,
}

impl<'a> Stage<'a> {
    /// For a division, at the given times.
    pub fn new(cell: &'a Cell, film: &'a Trajectory, times: &[f64], fineness: Fineness) -> Stage<'a> {
        let [along, across] = film.shell();
        let centre = [0.5 * SIZE[0], 0.5 * SIZE[1] + 12.0];
        let [long, high] = View::new(centre, 1.0).lengths();
        let scale = (0.36 * SIZE[0] / (along * long)).min(0.30 * SIZE[1] / (across * high));
        let view = View::new(centre, scale);
        // Forces at the neck grow without bound near pinch-off: the scale of the arrows leaves out the largest 3 % of
        // the movie.
        let stills: Vec<Snapshot> = times.iter().map(|t| film.at(*t)).collect();
        let mut sizes: Vec<f64> =
            stills.iter().flat_map(|still| arrows(still).into_iter().map(|(_, [r, z])| r.hypot(z))).collect();
        sizes.sort_by(f64::total_cmp);
        let largest = sizes.get(sizes.len() * 97 / 100).copied().unwrap_or(1.0).max(1e-9);
        let phi = PhiRange::of(stills.iter().flat_map(|still| &still.places));
        Stage { cell, film, view, largest, fineness, phi }
    }

    /// The frame at a time.
    pub fn frame(&self, t: f64) -> Canvas {
        let still = self.film.at(t);
        let mut canvas = Canvas::new(SIZE[0], SIZE[1]);
        self.shell(&mut canvas, true);
        surface::draw(&mut canvas, &still, (&self.film.cell().cue, self.phi), &self.view, self.fineness);
        self.shell(&mut canvas, false);
        self.forces(&mut canvas, &still);
        self.words(&mut canvas, &still);
        canvas
    }

    /// The shell as an outline and rings around it; the rings' far halves lie behind the cell.
    fn shell(&self, canvas: &mut Canvas, behind: bool) {
        let [along, across] = self.film.shell();
        let thin = Stroke::solid([0xb5; 3], 1.0);
        for ring in -2..=2 {
            let z = 0.4 * f64::from(ring) * along;
            let r = across * (1.0 - (z / along).powi(2)).sqrt();
            // The near half has a positive third coordinate.
            let from = if behind { FRAC_PI_2 } else { -FRAC_PI_2 };
            let half: Vec<[f64; 2]> = (0..=24).map(|k| self.view.point([r, z], from + k as f64 / 48.0 * TAU)).collect();
            canvas.polyline(&half, thin);
        }
    }

    fn forces(&self, canvas: &mut Canvas, still: &Snapshot) {
        for ([r, z], [force_r, force_z]) in arrows(still) {
            let size = force_r.hypot(force_z);
            if size <= 0.1 * self.largest {
                continue;
            }
            // Longer arrows are cut to the greatest length.
            let length = LONGEST / self.view.scale * (size / self.largest).min(1.0) / size;
            for angle in [FRAC_PI_2, -FRAC_PI_2] {
                let from = self.view.point([r, z], angle);
                let to = self.view.point([r + length * force_r, z + length * force_z], angle);
                canvas.arrow(from, to, FORCES[0].1, 1.9);
            }
        }
    }

    fn words(&self, canvas: &mut Canvas, still: &Snapshot) {
        let Cell { r0, epsilon, xi_s, cue, .. } = self.cell;
        let cued = if cue.is_none() { "no cue" } else { "with a cue" };
        let title = format!("R₀ = {r0}, ε = {epsilon}, ξₛ = {xi_s}, {cued}");
        canvas.text([20.0, 30.0], &title, text::LABEL, Anchor::Start, style::INK);
        let time = format!("t = {} τ", style::time(still.t));
        canvas.text([SIZE[0] - 20.0, 30.0], &time, text::LABEL, Anchor::End, style::INK);
        let bottom = SIZE[1] - 18.0;
        canvas.arrow([20.0, bottom - 5.0], [56.0, bottom - 5.0], FORCES[0].1, 2.2);
        canvas.text([64.0, bottom], "active force", text::TICK, Anchor::Start, style::MUTED);
        let (mut x, mut y) = (176.0, bottom);
        let of_cue = cue_colours(&changes(cue, still.length)).into_iter();
        for (colour, word) in of_cue.chain(self.phi.into_iter().flat_map(PhiRange::colours)) {
            let width = 24.0 + font::width(&word, text::TICK);
            if x + width > SIZE[0] - 12.0 {
                (x, y) = (20.0, y - 22.0);
            }
            canvas.rectangle([x, y - 13.0], [18.0, 14.0], colour, 1.0);
            canvas.text([x + 24.0, y], &word, text::TICK, Anchor::Start, style::MUTED);
            x += 16.0 + width;
        }
        let end = self.film.shell()[0];
        for (x, z, pole, anchor) in
            [(20.0, -end, ANTERIOR, Anchor::Start), (SIZE[0] - 20.0, end, POSTERIOR, Anchor::End)]
        {
            let [_, y] = self.view.point([0.0, z], 0.0);
            canvas.text([x, y + 5.0], pole, text::TICK, anchor, style::MUTED);
        }
        let division = &self.film.division;
        if still.t >= 0.999 * division.t_end {
            let (word, colour) = match (division.outcome(), division.chi()) {
                (Outcome::Arrested, _) => ("stays at rest".to_owned(), style::MUTED),
                (outcome, Some(chi)) => (format!("{outcome}, χ = {chi:.2}"), style::outcome(outcome)),
                (outcome, None) => (outcome.to_string(), style::outcome(outcome)),
            };
            canvas.label(Label::new([SIZE[0] - 20.0, 54.0], &word, text::LABEL, Anchor::End, colour).bold());
        }
    }
}

/// Places (r, z) evenly spaced along the contour, and the active force density there.
fn arrows(still: &Snapshot) -> Vec<([f64; 2], [f64; 2])> {
    (0..ARROWS)
        .filter_map(|k| {
            let u = (k as f64 + 0.5) / ARROWS as f64;
            let place = still.places.get(still.places.partition_point(|place| place.u < u))?;
            Some(([place.r, place.z], place.active_force()))
        })
        .collect()
}
