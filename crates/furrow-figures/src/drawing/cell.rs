//! A cell: its contour in its shell, and the cue along it.

use super::canvas::{Anchor, Canvas, Stroke};
use super::legend::{Key, Legend};
use super::regulator::PhiRange;
use super::style::{self, CUE_LOWERS, CUE_RAISES, CYTOPLASM, Colour, INK, SHELL, text};
use furrow_cell::Cue;
use furrow_cell::cue::{Field, Term};
use furrow_mechanics::cortex::forces::Place;
use furrow_mechanics::division::Snapshot;

/// Position and scale of a drawn cell. Its axis is horizontal, with the anterior pole, u = 1, on the left.
#[derive(Clone, Copy, Debug)]
pub struct Site {
    /// The centre of its shell on the canvas.
    pub centre: [f64; 2],
    /// Units of the canvas for one L_h.
    pub scale: f64,
}

impl Site {
    /// A point (r, z) on the canvas, on the upper side of the axis.
    pub fn point(&self, [r, z]: [f64; 2]) -> [f64; 2] {
        [self.centre[0] + self.scale * z, self.centre[1] - self.scale * r]
    }
}

/// The outline of a contour (r, z) from pole to pole, on both sides of the axis.
fn outline(contour: &[[f64; 2]], site: &Site) -> Vec<[f64; 2]> {
    let above = contour.iter().map(|[r, z]| site.point([r.max(0.0), *z]));
    let below = contour.iter().rev().map(|[r, z]| site.point([-r.max(0.0), *z]));
    above.chain(below).collect()
}

/// The shell, given by its contour (r, z), as a dashed line.
pub fn shell(canvas: &mut Canvas, contour: &[[f64; 2]], site: &Site) {
    let above = contour.iter().map(|place| site.point(*place));
    let below = contour.iter().rev().skip(1).map(|[r, z]| site.point([-r, *z]));
    let points: Vec<[f64; 2]> = above.chain(below).collect();
    canvas.polyline(&points, Stroke::dashed(SHELL, 1.4, [5.0, 4.0]));
}

/// How far a shell's contour reaches along the axis and across.
pub fn extent(contour: &[[f64; 2]]) -> [f64; 2] {
    [1, 0].map(|k| contour.iter().map(|place| place[k].abs()).fold(0.0, f64::max))
}

/// The inside of a cell and its contour.
pub fn body(canvas: &mut Canvas, contour: &[[f64; 2]], site: &Site, width: f64) {
    canvas.polygon(&outline(contour, site), CYTOPLASM, 1.0, Some(Stroke::solid(INK, width)));
}

/// Parts of a cue weaker than this share of its maximum are not drawn.
pub(super) const FAINTEST: f64 = 0.08;

/// The change of one field along a contour that a cue causes.
pub struct Change<'a> {
    /// The field.
    pub field: Field,
    terms: Vec<&'a Term>,
    length: f64,
    /// The largest absolute change.
    largest: f64,
}

impl Change<'_> {
    fn sum(&self, u: f64) -> f64 {
        self.terms.iter().map(|term| term.at(u, self.length)[0]).sum()
    }

    /// The change of the field at u relative to the largest, from −1 to 1.
    pub fn at(&self, u: f64) -> f64 {
        (self.sum(u) / self.largest).clamp(-1.0, 1.0)
    }

    /// Whether the cue raises the field somewhere, and whether it lowers it, above the threshold of drawing.
    fn signs(&self) -> [bool; 2] {
        [1.0, -1.0].map(|sign| (0..=400).any(|k| sign * self.at(f64::from(k) / 400.0) >= FAINTEST))
    }
}

/// The change of each field by a cue, on a contour of length `length`. Fields have different units and are not summed.
pub fn changes(cue: &Cue, length: f64) -> Vec<Change<'_>> {
    let mut found: Vec<Change<'_>> = Vec::new();
    for term in cue.terms() {
        match found.iter_mut().find(|change| change.field == term.field) {
            Some(change) => change.terms.push(term),
            None => found.push(Change { field: term.field, terms: vec![term], length, largest: 0.0 }),
        }
    }
    for change in &mut found {
        change.largest = (0..=400).map(|k| change.sum(f64::from(k) / 400.0).abs()).fold(0.0, f64::max);
    }
    found.retain(|change| change.largest > 0.0);
    found
}

/// The relative change at u with the largest absolute value among all fields, from −1 to 1.
pub fn strongest(changes: &[Change<'_>], u: f64) -> f64 {
    changes
        .iter()
        .map(|change| change.at(u))
        .fold(0.0, |most: f64, here| if here.abs() > most.abs() { here } else { most })
}

/// The colour of a cue that raises a field (by a positive number) or lowers it.
pub fn cue_colour(strength: f64) -> Colour {
    if strength < 0.0 { CUE_LOWERS } else { CUE_RAISES }
}

/// The colours of a cue that occur, with their meanings.
pub fn cue_colours(changes: &[Change<'_>]) -> Vec<(Colour, String)> {
    let what = match changes {
        [only] => format!(" {}", style::field(only.field)),
        _ => String::new(),
    };
    let shown = |sign: usize| changes.iter().any(|change| change.signs()[sign]);
    let both = [(CUE_RAISES, "raises"), (CUE_LOWERS, "lowers")].into_iter().enumerate();
    both.filter(|(sign, _)| shown(*sign)).map(|(_, (colour, verb))| (colour, format!("cue {verb}{what}"))).collect()
}

/// The legend of a cue drawn as strips, with the range of φ in the shapes if it has a regulator.
pub fn cue_legend(cue: &Cue, length: f64, phi: Option<PhiRange>) -> Legend {
    let changes = changes(cue, length);
    let colours = cue_colours(&changes).into_iter().chain(phi.into_iter().flat_map(PhiRange::colours));
    let legend = Legend::default().with_all(colours.map(|(colour, word)| (Key::Area(colour), word)));
    let fields = changes.iter().map(|change| style::field(change.field));
    let names: Vec<&str> = phi.map(|_| "regulator").into_iter().chain(fields).collect();
    legend.with_if(names.len() > 1, Key::Nothing, format!("strips from the inside: {}", names.join(", ")))
}

/// The cue of a shape, as strips along the outside of its contour: φ of its regulator, and one strip for each changed
/// field, in the colour of the change's sign and with its strength.
pub fn cue(canvas: &mut Canvas, (cue, phi): (&Cue, Option<PhiRange>), still: &Snapshot, site: &Site, width: f64) {
    let points = |value: fn(&Place) -> f64| still.places.iter().map(move |p| [value(p), p.r, p.z]).collect::<Vec<_>>();
    let mut inside = 0.0;
    if let Some(range) = phi {
        strip(canvas, &points(|p| p.phi.unwrap_or(0.0)), site, [inside, width], |phi| range.share(phi));
        inside += width;
    }
    for change in changes(cue, still.length) {
        strip(canvas, &points(|p| p.u), site, [inside, width], |u| change.at(u));
        inside += width;
    }
}

/// A strip along the outside of a contour, at the given distance and of the given width. `places` are (value, r, z)
/// from pole to pole; `strength` maps a value to the strength of the colour, from −1 to 1.
fn strip(
    canvas: &mut Canvas,
    places: &[[f64; 3]],
    site: &Site,
    [inside, width]: [f64; 2],
    strength: impl Fn(f64) -> f64,
) {
    for side in [1.0, -1.0] {
        for pair in places.windows(2) {
            let ([value, r, z], [value2, r2, z2]) = (pair[0], pair[1]);
            let here = strength(0.5 * (value + value2));
            let (a, b) = (site.point([side * r, z]), site.point([side * r2, z2]));
            let length = (b[0] - a[0]).hypot(b[1] - a[1]);
            if here.abs() < FAINTEST || length < 1e-6 {
                continue;
            }
            let along = [(b[0] - a[0]) / length, (b[1] - a[1]) / length];
            // Outwards from the drawn contour: to the left of its direction above the axis, to the right below.
            let normal = [side * along[1], -side * along[0]];
            let out = |p: [f64; 2], by: f64| [p[0] - by * normal[0], p[1] - by * normal[1]];
            // Opaque and slightly extended, so that no seams show.
            let b = [b[0] + SEAM * along[0], b[1] + SEAM * along[1]];
            let [near, far] = [inside + 1.0, inside + width];
            let corners = [out(a, near), out(b, near), out(b, far), out(a, far)];
            canvas.polygon(&corners, style::tint(cue_colour(here), here.abs()), 1.0, None);
        }
    }
}

/// Overlap of the pieces of a strip.
const SEAM: f64 = 0.5;

/// The names of the poles above a cell; its shell extends `half` along the axis and `high` above it on both sides of
/// the centre.
pub fn poles(canvas: &mut Canvas, site: &Site, [half, high]: [f64; 2]) {
    let y = site.centre[1] - site.scale * high - 6.0;
    for (side, name, anchor) in [(-1.0, ANTERIOR, Anchor::Start), (1.0, POSTERIOR, Anchor::End)] {
        let x = site.centre[0] + side * site.scale * half;
        canvas.text([x, y], name, text::TICK, anchor, style::MUTED);
    }
}

/// The pole on the left in every picture.
pub const ANTERIOR: &str = "anterior";
/// The pole on the right.
pub const POSTERIOR: &str = "posterior";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gradient_raises_at_one_pole_and_lowers_at_the_other() {
        let cue: Cue = "tension:gradient,amplitude=-0.3".parse().unwrap();
        let found = changes(&cue, 7.0);
        assert_eq!([found[0].at(0.0), found[0].at(0.5), found[0].at(1.0)], [-1.0, 0.0, 1.0]);
        let words: Vec<String> = cue_colours(&found).into_iter().map(|(_, word)| word).collect();
        assert_eq!(words, ["cue raises tension", "cue lowers tension"]);
    }

    #[test]
    fn fields_are_not_summed_and_absent_signs_are_not_named() {
        // Tension is raised where rigidity is lowered, so that a sum would vanish.
        let cue: Cue = "tension:u0=0.4,omega=0.1,amplitude=0.1+kappa:u0=0.4,omega=0.1,amplitude=-0.1".parse().unwrap();
        let found = changes(&cue, 7.0);
        assert_eq!([found.len(), cue_colours(&found).len()], [2, 2]);
        assert_eq!(strongest(&found, 0.4).abs(), 1.0);
        let one = Cue::published();
        let colours = cue_colours(&changes(&one, 7.0));
        assert_eq!(colours, [(CUE_RAISES, "cue raises rigidity".to_owned())]);
        assert!(changes(&Cue::none(), 7.0).is_empty());
    }
}
