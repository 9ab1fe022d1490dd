//! Figures 1 and S2, and the movies: single divisions, looked at closely.

use super::context::{Artifact, Figure, Finding, ReproduceError};
use furrow_cell::{Cell, Cue, ZYGOTE};
use furrow_mechanics::cortex::forces::Place;
use furrow_mechanics::division::{Outcome, Snapshot, Trajectory};

/// A cell that divides into equal halves, one that divides unequally, and one that comes to rest: the paper prints no R0.
const EQUAL: f64 = 3.0;
const UNEQUAL: f64 = 2.0;
const FAILING: f64 = 1.6;
/// A furrow nearer to u = ½ than this is at the equator.
const AT_EQUATOR: f64 = 0.02;
/// A furrow farther from u = ½ than this has left it.
const AWAY: f64 = 0.05;

/// The finding where no step is half-way through.
const OPEN_NECK: &str = "its neck does not close half";

/// A division of the figure's, shown under its name; what cannot be computed is the finding of all of its statements.
fn film(figure: &mut Figure<'_>, cell: Cell) -> Option<Trajectory> {
    match Trajectory::compute(&figure.context.input(cell.clone())) {
        Ok(film) => {
            figure.show(&figure.name().replace("Movie ", "movie_"), Artifact::Film(cell, Box::new(film.clone())));
            Some(film)
        }
        Err(error) => {
            let ids = figure.statements.iter().map(|statement| statement.id.as_str());
            figure.findings.extend(ids.map(|id| Finding::not_computed(id, &error)));
            None
        }
    }
}

/// All steps of a division from the first with a neck on.
fn with_neck(film: &Trajectory) -> Vec<Snapshot> {
    (0..film.times().len()).map(|k| film.step(k)).filter(|still| still.neck.is_some()).collect()
}

/// The place where the meridional curvature is most negative: the paper's furrow.
fn furrow(still: &Snapshot) -> Option<&Place> {
    still.places.iter().min_by(|a, b| a.c_uu.total_cmp(&b.c_uu))
}

/// Where the furrow is, from the first step with a neck to the last.
pub fn place_of_furrow(film: &Trajectory) -> Vec<f64> {
    with_neck(film).iter().filter_map(|still| Some(furrow(still)?.u)).collect()
}

/// Largest radius of the contour at the start.
fn first_width(film: &Trajectory) -> f64 {
    film.step(0).places.iter().map(|place| place.r).fold(0.0, f64::max)
}

/// The first step at which the neck is at most this part of the cell's first width.
fn narrowed(film: &Trajectory, part: f64) -> Option<Snapshot> {
    let width = first_width(film);
    let narrow = |still: &Snapshot| still.neck.is_some_and(|neck| neck.radius <= part * width);
    (0..film.times().len()).map(|k| film.step(k)).find(narrow)
}

/// Figure 1, text: where the passive shape is curved.
pub fn rest_shape(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    let Some(film) = film(figure, figure.context.cell(EQUAL, 0.87)) else { return Ok(()) };
    let places = film.step(0).places;
    let most =
        |of: fn(&Place) -> f64| places.iter().max_by(|a, b| of(a).total_cmp(&of(b))).map_or(0.0, |place| place.u);
    let (anisotropy, mean) = (most(|place| place.c_pp - place.c_uu), most(|place| place.c_uu + place.c_pp));
    let [width, length] =
        [|place: &Place| place.r, |place: &Place| place.z].map(|of| places.iter().map(of).fold(0.0, f64::max));
    let holds = length > width && (anisotropy - 0.5).abs() < 0.05 && mean.min(1.0 - mean) < 0.05;
    let text = format!(
        "{:.2} times as long as wide; C_φφ − C_uu is largest at u = {anisotropy:.2}, C at {mean:.2}",
        length / width
    );
    figure.judge("rest_shape", holds, text);
    Ok(())
}

/// Figure 1B: curvatures and active stress at the furrow.
pub fn curvatures(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    let cell = figure.context.cell(EQUAL, 0.87);
    let (xi_s, xi_b, gain) = (cell.xi_s, cell.xi_s * cell.material.xi_ratio, cell.material.gain);
    let Some(film) = film(figure, cell) else { return Ok(()) };
    let at_furrow = |still: &Snapshot| {
        furrow(still).map(|place| {
            let (c_uu, c_pp) = (place.c_uu, place.c_pp);
            [c_uu, c_pp, gain * (0.5 * xi_s * (c_pp - c_uu) + xi_b * (c_uu + c_pp))]
        })
    };
    let found: Vec<[f64; 3]> = with_neck(&film).iter().filter_map(at_furrow).collect();
    let (Some(first), Some(last)) = (found.first(), found.last()) else {
        figure.judge("furrow_curvatures", false, OPEN_NECK.to_owned());
        return Ok(());
    };
    let deepens = |pair: &&[[f64; 3]]| pair[1][0] < pair[0][0] && pair[1][1] > pair[0][1] && pair[1][2] > pair[0][2];
    let steps = found.len() - 1;
    let right = found.windows(2).filter(deepens).count();
    let text = format!(
        "in {right} of {steps} steps; C_uu from {:.2} to {:.0}, C_φφ from {:.2} to {:.0} /L_h, t^a_φφ from {:.1} to {:.0} κ0/L_h²",
        first[0], last[0], first[1], last[1], first[2], last[2]
    );
    figure.judge("furrow_curvatures", right == steps && steps > 0, text);
    Ok(())
}

/// Figure 1C: how much of the active force acts next to the neck.
pub fn concentration(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    let Some(film) = film(figure, figure.context.cell(EQUAL, 0.87)) else { return Ok(()) };
    let share = |part: f64| {
        let still = narrowed(&film, part)?;
        let neck = still.neck?.u;
        let size = |place: &Place| place.active_force().iter().map(|f| f * f).sum::<f64>().sqrt();
        Some(integral(&still.places, size, |u| (u - neck).abs() < 0.05) / integral(&still.places, size, |_| true))
    };
    let shares: Option<Vec<f64>> = [0.6, 0.4, 0.2, 0.05].map(share).into_iter().collect();
    let Some(shares) = shares else {
        figure.judge("force_share", false, OPEN_NECK.to_owned());
        return Ok(());
    };
    let holds = shares.windows(2).all(|pair| pair[1] > pair[0]) && shares[3] > 0.5;
    let text = shares.iter().map(|share| format!("{:.0} %", 100.0 * share)).collect::<Vec<_>>().join(", ");
    figure.judge("force_share", holds, text);
    Ok(())
}

/// Distance from the equator.
pub fn away(u: f64) -> f64 {
    (u - 0.5).abs()
}

/// Whether a furrow that begins and ends there begins at the equator and leaves it.
pub fn leaves_equator(first: f64, last: f64) -> bool {
    away(first) < AT_EQUATOR && away(last) > AWAY
}

/// Whether a furrow begins at the equator and moves to a pole, and in words how.
fn slipping(film: &Trajectory) -> (bool, String) {
    let places = place_of_furrow(film);
    let (Some(first), Some(last)) = (places.first(), places.last()) else { return (false, OPEN_NECK.to_owned()) };
    let farthest = places.iter().copied().max_by(|a, b| away(*a).total_cmp(&away(*b))).unwrap_or(*last);
    let words = format!("from u = {first:.3} to {last:.3}, at most {farthest:.3}");
    (leaves_equator(*first, *last), words)
}

/// Figure 1D: a furrow that slips.
pub fn slip(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    let Some(film) = film(figure, figure.context.cell(UNEQUAL, 0.87)) else { return Ok(()) };
    figure.findings.push(Finding::judged("slip", slipping(&film)));
    Ok(())
}

/// The widths, in parts of the first, at which figure S2 takes the normal forces apart.
const STAGES: [f64; 4] = [0.8, 0.5, 0.2, 0.05];

/// Figure S2: the balance of normal forces, of an equal division and of an unequal one.
pub fn balance(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    type Judge = fn(&[Snapshot]) -> (bool, String);
    let judges: [(&str, f64, Judge); 2] = [("balance", EQUAL, concentrated), ("balance_unequal", UNEQUAL, lopsided)];
    for (id, r0, judge) in judges {
        let film = Trajectory::compute(&figure.context.input(figure.context.cell(r0, 0.87)));
        let judged = film.map(|film| {
            let stills: Option<Vec<Snapshot>> = STAGES.iter().map(|part| narrowed(&film, *part)).collect();
            stills.map_or((false, OPEN_NECK.to_owned()), |stills| judge(&stills))
        });
        figure.judge_found(id, judged);
    }
    Ok(())
}

/// The largest sum of the normal forces of a step, relative to the largest of them.
fn unbalanced(still: &Snapshot) -> f64 {
    // The first and the last place are the poles, where no equation is solved.
    let inner = || still.places.iter().skip(1).take(still.places.len().saturating_sub(2));
    let largest = inner().flat_map(|place| place.normal.parts()).fold(0.0, |most: f64, force| most.max(force.abs()));
    inner().map(|place| place.normal.residual().abs()).fold(0.0, f64::max) / largest
}

/// Whether the normal forces of some steps add up to nothing, and in words. The sum is rounding and the tolerance of Newton's method,
/// which differ between machines.
fn balanced(stills: &[Snapshot]) -> (bool, String) {
    let off = stills.iter().map(unbalanced).fold(0.0, f64::max);
    if off < 1e-5 { (true, "balanced".to_owned()) } else { (false, format!("off by {off:.1e} of the largest")) }
}

/// ∫ of a size over u where `inside` holds, by trapezoids.
fn integral(places: &[Place], size: impl Fn(&Place) -> f64, inside: impl Fn(f64) -> bool) -> f64 {
    let pairs = places.windows(2).filter(|pair| inside(0.5 * (pair[0].u + pair[1].u)));
    pairs.map(|pair| 0.5 * (size(&pair[0]) + size(&pair[1])) * (pair[1].u - pair[0].u)).sum()
}

/// Figure S2a: whether the active normal force gathers ever more at the equator.
fn concentrated(stills: &[Snapshot]) -> (bool, String) {
    let (holds, text) = balanced(stills);
    let size = |place: &Place| place.normal.active.abs();
    let share =
        |still: &Snapshot| integral(&still.places, size, |u| away(u) < 0.05) / integral(&still.places, size, |_| true);
    let shares: Vec<f64> = stills.iter().map(share).collect();
    let rises = shares.windows(2).all(|pair| pair[1] > pair[0]);
    let shares = shares.iter().map(|share| format!("{:.0} %", 100.0 * share)).collect::<Vec<_>>().join(", ");
    (holds && rises, format!("{text}; share of the active force at the equator {shares}"))
}

/// Figure S2b: whether the furrow leaves the equator, and the active and the viscous force do so with it.
fn lopsided(stills: &[Snapshot]) -> (bool, String) {
    let (balanced, text) = balanced(stills);
    let distances = |of: fn(&Place) -> f64| -> Vec<f64> {
        let moment = |places: &[Place], lever: fn(&Place) -> f64| {
            integral(places, |place| lever(place) * of(place).abs(), |_| true)
        };
        stills
            .iter()
            .map(|still| away(moment(&still.places, |place| place.u) / moment(&still.places, |_| 1.0)))
            .collect()
    };
    let forces = [distances(|place| place.normal.active), distances(|place| place.normal.viscous)];
    let leaves = |of: &Vec<f64>| of.first().zip(of.last()).is_some_and(|(first, last)| last > first && *last > AWAY);
    let furrow_leaves = stills.last().and_then(furrow).is_some_and(|place| away(place.u) > AWAY);
    let [active, viscous] =
        [&forces[0], &forces[1]].map(|of| of.iter().map(|off| format!("{off:.3}")).collect::<Vec<_>>().join(", "));
    let holds = balanced && furrow_leaves && forces.iter().all(leaves);
    (holds, format!("{text}; centres of the forces from the equator: active {active}, viscous {viscous}"))
}

/// The cell of a movie.
pub fn movie(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    let context = figure.context;
    let cell = match figure.name() {
        "Movie 1" => context.cell(EQUAL, 0.87),
        "Movie 2" => context.cell(UNEQUAL, 0.87),
        "Movie 3" => context.cell(FAILING, 0.87),
        _ => context.cell(ZYGOTE, 0.87).with_cue(Cue::published()),
    };
    let Some(film) = film(figure, cell) else { return Ok(()) };
    if figure.statements[0].apart.is_some() {
        return Ok(());
    }
    let division = &film.division;
    let chi = division.chi().map_or(String::new(), |chi| format!(", χ = {chi:.3}"));
    let outcome = format!("{}{chi}", division.outcome());
    let last = film.step(film.times().len());
    let (holds, text) = match figure.name() {
        "Movie 3" => {
            let width = first_width(&film);
            let shallow = last.neck.is_some_and(|neck| neck.radius > 0.5 * width && away(neck.u) < AT_EQUATOR);
            let neck = last.neck.map_or("no neck".to_owned(), |neck| {
                format!("neck of {:.2} of the width at u = {:.3}", neck.radius / width, neck.u)
            });
            (shallow && division.outcome() == Outcome::Arrested, format!("{outcome}; {neck}"))
        }
        _ => {
            let off = division.chi_signed().is_some_and(|chi| chi > 0.0 && chi < 0.3);
            (off, format!("{outcome}, the part at smaller u the smaller"))
        }
    };
    let id = figure.statements[0].id.clone();
    figure.judge(&id, holds, text);
    Ok(())
}
