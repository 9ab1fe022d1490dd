//! A bifurcation diagram: elongation and furrow position over activity, solid for stable shapes and dashed for unstable
//! ones, with folds, pitchforks, Hopf points and some of the shapes.

use std::collections::BTreeSet;

use crate::drawing::cell::{ANTERIOR, POSTERIOR, Site, body, extent, shell};
use crate::drawing::font;
use crate::drawing::legend::{Key, Legend, Marker, titled};
use crate::drawing::panel::{Axis, Chart, Mark, widened};
use crate::drawing::style::{self, Colour, text};
use crate::drawing::{Anchor, Canvas, Label, Stroke};
use furrow_cell::{Cell, Parameter};
use furrow_mechanics::cortex::{Cortex, Domain, Wall};
use furrow_mechanics::equilibria::{Branch, Criticality, PointKind, ShapePoint};
use furrow_surface::bent::{BentBranch, BentPoint};
use ordered_float::OrderedFloat;

/// A branch with contours under its name: `symmetric`, `asymmetric` or `cued`.
type Named = (&'static str, Branch);

/// Name of the branch of bent states.
const BENT: &str = "bent";

/// Most shapes beside the diagram.
const MOST_SHAPES: usize = 6;
const WIDTH: f64 = 1000.0;
/// Height of the row of shapes.
const SHAPES: f64 = 150.0;
/// Height of each chart.
const CHART: f64 = 330.0;

/// The letter of a drawn shape, its place, and its contour.
type Shape<'a> = (char, ShapePoint, &'a [[f64; 2]]);

/// Draws the branches of one cell; `bent` has the events of the bent one.
pub fn draw(cell: &Cell, branches: &[Named], bent: Option<&BentBranch>) -> Canvas {
    let at = |point: &Option<BentPoint>| point.as_ref().map(BentPoint::shape);
    let [pitchfork, fold] = bent.map_or([None; 2], |bent| [at(&bent.pitchfork), at(&bent.fold)]);
    let mut branches = branches.to_vec();
    // The stability of the branch changes there.
    let located = [pitchfork, fold].into_iter().flatten().map(|point| ShapePoint { growth_rate: None, ..point });
    branches.iter_mut().filter(|(name, _)| *name == BENT).for_each(|(_, bent)| bent.points.extend(located.clone()));
    let branches = branches.as_slice();
    let points = || branches.iter().flat_map(|(_, branch)| &branch.points);
    let breaks = points().any(|point| point.delta_u.is_some_and(|shift| shift.abs() > 1e-6));
    let mut title = format!(
        "Stationary shapes at {}\nshapes from the {ANTERIOR} pole on the left to the {POSTERIOR} pole on the right",
        style::described(cell, &[Parameter::XiS])
    );
    if breaks {
        title += "; δu > 0 if the furrow is nearer to the anterior pole";
    }
    // Mirror-symmetric shapes all have δu = 0.
    if breaks && branches.len() > 1 {
        title += "; lines that coincide are drawn side by side";
    }
    let below = SHAPES + 12.0 + CHART * if breaks { 2.0 } else { 1.0 };
    let (mut canvas, top) =
        titled(WIDTH, below, &title, &legend(branches, [pitchfork, fold].map(|point| point.is_some())));
    let shapes = chosen(branches);
    row_of_shapes(&mut canvas, cell, &shapes, top);
    let top = top + SHAPES + 12.0;
    let bent = [(pitchfork, Marker::Disc, style::INK), (fold, Marker::Diamond, colour(BENT))];
    let bent: Vec<_> = bent.into_iter().filter_map(|(point, marker, colour)| Some((point?, marker, colour))).collect();
    chart(&mut canvas, (branches, &bent), &shapes, top, "elongation H", |point| point.elongation);
    if breaks {
        // Shapes without a furrow interrupt the lines.
        let shift = |point: &ShapePoint| point.delta_u.unwrap_or(f64::NAN);
        chart(&mut canvas, (branches, &bent), &shapes, top + CHART, "furrow position δu", shift);
    }
    canvas
}

/// The legend; `bent` says whether the bent branch has a pitchfork and a fold.
fn legend(branches: &[Named], bent: [bool; 2]) -> Legend {
    let has = |kind| branches.iter().flat_map(|(_, branch)| &branch.events).any(|event| event.kind() == kind);
    let lines = || branches.iter().flat_map(|(_, branch)| pieces(branch, |point| point.elongation));
    let is = |stable| lines().any(|(kind, _)| kind == stable);
    let crossings = crossings(branches).map(|(m, grows)| {
        let verb = if grows { "begin to grow" } else { "stop growing" };
        let words = format!("disturbances cos {}φ {verb}", style::factor(m));
        (Key::Point(style::azimuthal(m), crossing(grows)), words)
    });
    Legend::default()
        .with_all(branches.iter().map(|(name, _)| (Key::Line(colour(name)), format!("{name} shapes"))))
        .with_if(is(true), Key::Line(style::INK), "stable")
        .with_if(is(false), Key::Dashes(style::INK, style::DASHED), "unstable")
        .with_if(bent[0] || has(PointKind::Pitchfork), Key::Point(style::INK, Marker::Disc), "pitchfork")
        .with_if(bent[1] || has(PointKind::Fold), Key::Point(style::INK, Marker::Diamond), "fold")
        .with_if(
            branches.iter().any(|(_, branch)| !branch.hopf.is_empty()),
            Key::Point(style::INK, Marker::Ring),
            "Hopf point",
        )
        .with_all(crossings)
}

/// The kinds of crossings that occur: the azimuthal number, and whether its perturbations grow beyond.
fn crossings(branches: &[Named]) -> impl Iterator<Item = (usize, bool)> {
    let all = branches.iter().flat_map(|(_, branch)| &branch.azimuthal.crossings);
    let kinds: BTreeSet<(usize, bool)> = all.map(|crossing| (crossing.m, !crossing.grows)).collect();
    kinds.into_iter().map(|(m, stops)| (m, !stops))
}

/// The marker of a crossing.
fn crossing(grows: bool) -> Marker {
    if grows { Marker::Ring } else { Marker::Square }
}

/// The colour of a branch: the colour of the outcome with such shapes.
fn colour(name: &str) -> Colour {
    match name {
        "symmetric" => style::SYMMETRIC,
        "asymmetric" => style::ASYMMETRIC,
        _ => style::MODEL,
    }
}

/// The most informative shapes: the first, those at folds and pitchforks, and those at the ends; evenly thinned out if
/// there are too many.
fn chosen<'a>(branches: &'a [Named]) -> Vec<Shape<'a>> {
    let mut found: Vec<(ShapePoint, &'a [[f64; 2]])> = Vec::new();
    for (k, (_, branch)) in branches.iter().enumerate() {
        let at = |index: usize| Some((*branch.points.get(index)?, branch.contours.get(index)?.as_slice()));
        if k == 0 {
            found.extend(at(0));
        }
        for event in &branch.events {
            let s = event.point().arclength;
            // The first point of an asymmetric branch lies on the branch of its origin.
            let near = (1..branch.points.len()).min_by(|a, b| {
                (branch.points[*a].arclength - s).abs().total_cmp(&(branch.points[*b].arclength - s).abs())
            });
            found.extend(near.and_then(at).map(|(_, contour)| (*event.point(), contour)));
        }
        found.extend(at(branch.points.len().saturating_sub(1)).filter(|_| branch.points.len() > 1));
    }
    let count = found.len();
    let shown = count.min(MOST_SHAPES);
    let kept = (0..shown).map(|k| if count > shown { found[k * (count - 1) / (shown - 1)] } else { found[k] });
    ('a'..).zip(kept).map(|(letter, (point, contour))| (letter, point, contour)).collect()
}

fn row_of_shapes(canvas: &mut Canvas, cell: &Cell, shapes: &[Shape<'_>], top: f64) {
    let wall = Wall::of(&Cortex::new(cell, Domain::Full, &[])).contour();
    let axes = extent(&wall);
    let width = (WIDTH - 40.0) / shapes.len().max(1) as f64;
    let scale = (0.44 * width / axes[0]).min(0.40 * SHAPES / axes[1]);
    for (k, (letter, _, contour)) in shapes.iter().enumerate() {
        let site = Site { centre: [20.0 + width * (k as f64 + 0.5), top + 6.0 + 0.5 * SHAPES], scale };
        body(canvas, contour, &site, 1.8);
        shell(canvas, &wall, &site);
        let corner = [site.centre[0] - scale * axes[0], site.centre[1] - 0.36 * SHAPES];
        canvas.label(Label::new(corner, &letter.to_string(), text::LABEL, Anchor::Middle, style::INK).bold());
    }
}

/// One chart. Points of `value` outside the range over all branches do not occur.
fn chart(
    canvas: &mut Canvas,
    (branches, bent): (&[Named], &[(ShapePoint, Marker, Colour)]),
    shapes: &[Shape<'_>],
    top: f64,
    label: &str,
    value: fn(&ShapePoint) -> f64,
) {
    let points = || branches.iter().flat_map(|(_, branch)| &branch.points);
    let x = Axis::new(style::ACTIVITY, widened(points().map(|p| p.xi_s), 0.03));
    let y = Axis::new(label, widened(points().map(value), 0.12));
    let mut chart = Chart::new(canvas, [0.0, top], [WIDTH, CHART], x, y);
    lines(&mut chart, branches, value);
    for (_, point, _) in shapes {
        let at = [point.xi_s, value(point)];
        if chart.holds(at) {
            let at = chart.at(at);
            chart.canvas.disc(at, 2.6, style::INK, 1.0, None);
        }
    }
    let crossings = branches.iter().flat_map(|(_, branch)| &branch.azimuthal.crossings);
    let crossings = crossings.map(|at| (at.point, crossing(at.grows), style::azimuthal(at.m)));
    let hopfs = branches.iter().flat_map(|(_, branch)| &branch.hopf);
    let hopfs = hopfs.map(|hopf| (hopf.point, Marker::Ring, style::INK));
    let events = || branches.iter().flat_map(|(name, branch)| branch.events.iter().map(move |event| (*name, event)));
    let folds = events().filter(|(_, event)| event.pitchfork().is_none());
    let folds = folds.map(|(name, event)| (*event.point(), Marker::Diamond, colour(name)));
    let pitchforks = || events().filter_map(|(_, event)| Some((*event.point(), event.pitchfork()?.criticality())));
    let discs = pitchforks().map(|(point, _)| (point, Marker::Disc, style::INK));
    let marks = crossings.chain(hopfs).chain(folds).chain(discs).chain(bent.iter().copied());
    let marks = marks.filter(|(point, ..)| value(point).is_finite());
    let marks: Vec<Mark> = marks.map(|(point, marker, colour)| ([point.xi_s, value(&point)], marker, colour)).collect();
    chart.marks(&marks, 6.5);
    let mut words: Vec<([f64; 2], Anchor, &str)> = Vec::new();
    for (point, criticality) in pitchforks() {
        let kind = match criticality {
            Criticality::Subcritical => "subcritical",
            _ => "supercritical",
        };
        let at = chart.at([point.xi_s, value(&point)]);
        let (aside, anchor) = if at[0] + 130.0 > chart.frame[2] { (-12.0, Anchor::End) } else { (12.0, Anchor::Start) };
        words.push(([at[0] + aside, at[1] + 22.0], anchor, kind));
    }
    // Above the lines, with a rim.
    let mut taken = Vec::new();
    for (at, anchor, word) in words {
        let width = font::width(word, text::TICK);
        let middle = at[0] + if anchor == Anchor::End { -0.5 } else { 0.5 } * width;
        taken.push(([middle, at[1] - 5.0], [0.5 * width, 7.0]));
        chart.canvas.label(Label::new(at, word, text::TICK, anchor, style::MUTED).over(style::WHITE));
    }
    letters(&mut chart, shapes, value, taken);
}

/// Distance between lines that would otherwise lie on each other.
const BESIDE: f64 = 2.0 * style::CURVE;

/// A line on the canvas, and by how many steps of [`BESIDE`] it is drawn above its place.
type Drawn = (usize, Vec<[f64; 2]>);

/// The lines of the branches. Those that lie on earlier ones are drawn above them, so that both can be seen.
fn lines(chart: &mut Chart<'_>, branches: &[Named], value: fn(&ShapePoint) -> f64) {
    let mut drawn: Vec<Drawn> = Vec::new();
    for (name, branch) in branches {
        for (stable, piece) in pieces(branch, value) {
            let dash = (!stable).then_some(style::DASHED);
            let piece: Vec<[f64; 2]> = piece.into_iter().map(|point| chart.at(point)).collect();
            for run in runs(&piece) {
                let level = level(run, &drawn);
                let up = BESIDE * level as f64;
                let shifted: Vec<[f64; 2]> = run.iter().map(|[x, y]| [*x, y - up]).collect();
                let stroke = Stroke { colour: colour(name), width: style::CURVE, dash };
                chart.canvas.clipped(chart.frame, |canvas| canvas.polyline(&shifted, stroke));
                drawn.push((level, run.to_vec()));
            }
        }
    }
}

/// A line in parts that run to one side: a branch turns back at its folds.
fn runs(line: &[[f64; 2]]) -> Vec<&[[f64; 2]]> {
    let mut found = Vec::new();
    let mut from = 0;
    for k in 1..line.len() {
        let turns = line.get(k + 1).is_none_or(|next| (next[0] - line[k][0]) * (line[k][0] - line[k - 1][0]) < 0.0);
        if turns {
            found.push(&line[from..=k]);
            from = k;
        }
    }
    found
}

/// The level of a line among earlier ones: 0 unless each of its points is less than its width from one of them. Lines that cross it do
/// not count.
fn level(line: &[[f64; 2]], drawn: &[Drawn]) -> usize {
    let covers = |[x, y]: &[f64; 2], pair: &[[f64; 2]]| {
        let [a, b] = [pair[0], pair[1]];
        let share = (x - a[0]) / (b[0] - a[0]);
        (0.0..=1.0).contains(&share) && (a[1] + share * (b[1] - a[1]) - y).abs() < style::CURVE
    };
    let lies_on = |point: &[f64; 2], other: &[[f64; 2]]| other.windows(2).any(|pair| covers(point, pair));
    if !line.iter().all(|point| drawn.iter().any(|(_, other)| lies_on(point, other))) {
        return 0;
    }
    let beside = |other: &[[f64; 2]]| 10 * line.iter().filter(|point| lies_on(point, other)).count() >= line.len();
    let taken: Vec<usize> = drawn.iter().filter(|(_, other)| beside(other)).map(|(level, _)| *level).collect();
    (0..=taken.len()).find(|level| !taken.contains(level)).unwrap_or(0)
}

/// The middle of a text on the canvas, and half its width and height.
type Taken = ([f64; 2], [f64; 2]);

/// The letters of the shapes beside their points, clear of each other and of other text.
fn letters(chart: &mut Chart<'_>, shapes: &[Shape<'_>], value: fn(&ShapePoint) -> f64, mut taken: Vec<Taken>) {
    const HALF: [f64; 2] = [7.0, 8.0];
    let [left, top, right, bottom] = chart.frame;
    for (letter, point, _) in shapes {
        let data = [point.xi_s, value(point)];
        if !chart.holds(data) {
            continue;
        }
        let at = chart.at(data);
        let free = |place: &[f64; 2]| {
            let inside = (left + 8.0..right - 8.0).contains(&place[0]) && (top + 9.0..bottom - 9.0).contains(&place[1]);
            let apart = |(middle, half): &Taken| (0..2).any(|c| (middle[c] - place[c]).abs() > half[c] + HALF[c]);
            inside && taken.iter().all(apart)
        };
        let sides = [[1.0, -1.0], [-1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let around =
            (0..6).flat_map(|step| sides.map(|[x, y]| [at[0] + x * (14.0 + 15.0 * f64::from(step)), at[1] + 17.0 * y]));
        let place = around.into_iter().find(free).unwrap_or([at[0] + 14.0, at[1] - 17.0]);
        taken.push((place, HALF));
        let base = [place[0], place[1] + 6.0];
        chart.canvas.label(
            Label::new(base, &letter.to_string(), text::LABEL, Anchor::Middle, style::INK).bold().over(style::WHITE),
        );
    }
}

/// Interpolated points between two points of a branch, for a smooth curve.
const BETWEEN: usize = 8;

/// Arclength, ξ_s and the value at a point of a branch.
type Knot = [f64; 3];

/// The smooth curve through knots: cubics with the slope, at each knot, of the parabola through it and its neighbours.
fn smooth(knots: &[Knot]) -> Vec<[f64; 2]> {
    let slope = |k: usize, c: usize| {
        let here = knots[k];
        // A knot without a value has no influence on its neighbours.
        let beside = |other: usize| if knots[other][2].is_finite() { knots[other] } else { here };
        let (a, b) = (beside(k.saturating_sub(1)), beside((k + 1).min(knots.len() - 1)));
        let (h, h2) = (here[0] - a[0], b[0] - here[0]);
        let (left, right) = ((here[c] - a[c]) / h, (b[c] - here[c]) / h2);
        match (h > 0.0, h2 > 0.0) {
            (true, true) => (left * h2 + right * h) / (h + h2),
            (true, false) => left,
            (false, true) => right,
            _ => 0.0,
        }
    };
    let mut points: Vec<[f64; 2]> = knots.first().map(|[_, x, y]| [*x, *y]).into_iter().collect();
    for k in 1..knots.len() {
        let (a, b) = (knots[k - 1], knots[k]);
        let h = b[0] - a[0];
        for j in 1..BETWEEN {
            let s = j as f64 / BETWEEN as f64;
            let ease = s * s * (3.0 - 2.0 * s);
            let along = |c: usize| {
                let (left, right) = (s * (1.0 - s) * (1.0 - s) * h, s * s * (s - 1.0) * h);
                a[c] + ease * (b[c] - a[c]) + left * slope(k - 1, c) + right * slope(k, c)
            };
            points.push([along(1), along(2)]);
        }
        points.push([b[1], b[2]]);
    }
    points
}

/// A place of a branch: its knot, whether it is stable if that is known, and whether the branch is stable right behind it.
type Place = (Knot, Option<bool>, Option<bool>);

/// The arclength at which a branch through these knots passes a point of a given ξ_s and value.
fn arclength_of(knots: &[Place], [xi_s, value]: [f64; 2]) -> Option<f64> {
    let passed = |pair: &[Place]| {
        let [(a, ..), (b, ..)] = pair else { return None };
        let share = (xi_s - a[1]) / (b[1] - a[1]);
        let off = (a[2] + share * (b[2] - a[2]) - value).abs();
        (0.0..=1.0).contains(&share).then_some((off, a[0] + share * (b[0] - a[0])))
    };
    let nearest = knots.windows(2).filter_map(passed).min_by(|a, b| a.0.total_cmp(&b.0));
    nearest.map(|(_, arclength)| arclength)
}

/// The branch in pieces of constant stability: stability changes at folds, pitchforks and Hopf points, and where disturbances
/// around the axis start or stop growing, where the pieces meet. Points without a value interrupt it.
fn pieces(branch: &Branch, value: fn(&ShapePoint) -> f64) -> Vec<(bool, Vec<[f64; 2]>)> {
    let knot = |s: f64, point: &ShapePoint| [s, point.xi_s, value(point)];
    let points = branch.points.iter().enumerate().map(|(k, point)| match k {
        // The first point of a branch that begins at a pitchfork has the arclength of its parent branch, and a growth
        // rate of zero.
        0 => (knot(0.0, point), None, None),
        _ => (knot(point.arclength, point), point.growth_rate.map(|rate| rate < 0.0), None),
    });
    let events = branch.events.iter().map(|event| (knot(event.point().arclength, event.point()), None, None));
    let mut all: Vec<Place> = points.chain(events).collect();
    let in_order = |all: &mut Vec<Place>| all.sort_by_cached_key(|(at, ..)| OrderedFloat(at[0]));
    in_order(&mut all);
    let hopf = branch.hopf.iter().filter_map(|hopf| {
        let arclength = arclength_of(&all, [hopf.point.xi_s, value(&hopf.point)])?;
        Some((knot(arclength, &hopf.point), None, Some(!hopf.grows)))
    });
    let crossings = branch.azimuthal.crossings.iter().filter_map(|crossing| {
        let arclength = arclength_of(&all, [crossing.point.xi_s, value(&crossing.point)])?;
        Some((knot(arclength, &crossing.point), None, None))
    });
    let more: Vec<Place> = hopf.chain(crossings).collect();
    all.extend(more);
    in_order(&mut all);
    all.dedup_by(|(a, ..), (b, ..)| (a[0] - b[0]).abs() < 1e-9);
    let curve = smooth(&all.iter().map(|(knot, ..)| *knot).collect::<Vec<_>>());
    let mut found: Vec<(bool, Vec<[f64; 2]>)> = Vec::new();
    let mut interrupted = false;
    for (k, pair) in all.windows(2).enumerate() {
        let [(start, before, behind), (end, here, _)] = pair else { continue };
        if !(start[2].is_finite() && end[2].is_finite()) {
            interrupted = true;
            continue;
        }
        let known = behind.or(*here).or(*before);
        let from = BETWEEN * k;
        match found.last_mut() {
            Some((same, piece)) if !interrupted && known.is_none_or(|stable| stable == *same) => {
                piece.extend(&curve[from + 1..=from + BETWEEN]);
            }
            _ => found.push((known.unwrap_or(true), curve[from..=from + BETWEEN].to_vec())),
        }
        interrupted = false;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_without_a_furrow_interrupt_a_line() {
        let point =
            |k: usize, delta_u| ShapePoint { xi_s: k as f64, arclength: k as f64, delta_u, ..ShapePoint::default() };
        let shifts = [None, Some(0.1), Some(0.2), None, Some(0.4), Some(0.5)];
        let points = shifts.into_iter().enumerate().map(|(k, shift)| point(k, shift)).collect();
        let branch = Branch {
            points,
            contours: Vec::new(),
            azimuthal: Default::default(),
            events: Vec::new(),
            hopf: Vec::new(),
            ended: furrow_mechanics::equilibria::BranchEnd::Enough,
            work: Default::default(),
        };
        let found = pieces(&branch, |point| point.delta_u.unwrap_or(f64::NAN));
        let ends: Vec<[f64; 2]> = found.iter().map(|(_, piece)| [piece[0][0], piece[piece.len() - 1][0]]).collect();
        assert_eq!(ends, [[1.0, 2.0], [4.0, 5.0]]);
        assert!(found.iter().flat_map(|(_, piece)| piece).all(|[_, y]| y.is_finite()));
    }

    /// A branch that goes up to a fold and back at the same height lies on itself; one that crosses it does not.
    #[test]
    fn lines_that_coincide_are_told_from_lines_that_cross() {
        let there_and_back = [[0.0, 5.0], [10.0, 5.0], [20.0, 5.0], [12.0, 5.5], [1.0, 5.0]];
        let found = runs(&there_and_back);
        assert_eq!(found, [&there_and_back[..3], &there_and_back[2..]]);
        let drawn = [(0, found[0].to_vec())];
        assert_eq!(level(found[1], &drawn), 1);
        assert_eq!(level(&[[0.0, 0.0], [5.0, 3.0], [10.0, 5.0], [15.0, 8.0], [20.0, 10.0]], &drawn), 0);
        // A line that leaves another one keeps its place.
        assert_eq!(level(&[[0.0, 5.0], [5.0, 5.0], [10.0, 5.0], [15.0, 8.0]], &drawn), 0);
        assert!(runs(&there_and_back[..1]).is_empty());
    }
}
