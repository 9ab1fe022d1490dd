//! Figures 1B to 1D and S2, and the movies: single divisions, looked at closely.

use super::context::{Artifact, Figure, Finding, ReproduceError};
use furrow_cell::{Cell, Cue};
use furrow_lineage::batch::scheduler;
use furrow_mechanics::cortex::forces::Place;
use furrow_mechanics::division::{Snapshot, Trajectory};
use rayon::prelude::*;

/// The cell that forces are looked at in: it divides into equal halves.
const R0: f64 = 3.0;

/// The first step at which the neck is at most half as wide as the cell was.
fn half_way(film: &Trajectory) -> Option<Snapshot> {
    let width = film.step(0).places.iter().map(|place| place.r).fold(0.0, f64::max);
    let times = film.times().len();
    (0..times).map(|k| film.step(k)).find(|still| still.neck.is_some_and(|neck| neck.radius <= 0.5 * width))
}

/// Figures 1B to 1D: the forces along the contour.
pub fn furrow(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    let cell = figure.context.cell(R0, 0.87);
    let film = match Trajectory::compute(&figure.context.input(cell.clone())) {
        Ok(film) => film,
        Err(error) => {
            figure.findings = ["furrow", "active_flow"].map(|id| Finding::not_computed(id, &error)).to_vec();
            return Ok(());
        }
    };
    let still = half_way(&film);
    let neck = still.as_ref().and_then(|still| Some((still, still.neck?, nearest(&still.places, still.neck?.u)?)));
    let ((holds, text), flow) = match neck {
        Some((still, neck, place)) => {
            let (outcome, end, force) = (film.division.outcome(), film.division.t_end, place.normal.active);
            // Beside the neck, where the flow into it is; u grows from one pole to the other.
            let beside = |du: f64| nearest(&still.places, neck.u + du).map_or(0.0, |place| place.active_tangential);
            let [before, after] = [beside(-0.02), beside(0.02)];
            let way = match (before > 0.0, after < 0.0) {
                (true, true) => "towards the furrow from both sides",
                (false, false) => "away from the furrow on both sides",
                _ => "the same way on both sides",
            };
            let text = format!("{outcome}, at t = {end:.2} τ; active normal force {force:+.1} κ0/L_h³");
            let flow = format!("{way}: {before:+.1} and {after:+.1} κ0/L_h³ at 0.02 in u from it, at half width");
            ((film.division.chi().is_some() && force < 0.0, text), flow)
        }
        None => ((false, OPEN_NECK.to_owned()), OPEN_NECK.to_owned()),
    };
    figure.judge("furrow", holds, text);
    figure.report("active_flow", flow);
    figure.show("1B-D", Artifact::Film(cell, Box::new(film)));
    Ok(())
}

/// The finding where no step is half-way through.
const OPEN_NECK: &str = "its neck does not close half";

fn nearest(places: &[Place], u: f64) -> Option<&Place> {
    places.iter().min_by(|a, b| (a.u - u).abs().total_cmp(&(b.u - u).abs()))
}

/// Figure S2: the balance of normal forces.
pub fn balance(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    let finding = match Trajectory::compute(&figure.context.input(figure.context.cell(R0, 0.87))) {
        Ok(film) => Finding::judged("balance", half_way(&film).map_or((false, OPEN_NECK.to_owned()), balanced)),
        Err(error) => Finding::not_computed("balance", error),
    };
    figure.findings.push(finding);
    Ok(())
}

/// Whether the normal forces add up to nothing, with the forces at the neck in words.
fn balanced(still: Snapshot) -> (bool, String) {
    // The first and the last place are the poles, where no equation is solved.
    let inner = || still.places.iter().skip(1).take(still.places.len().saturating_sub(2));
    let largest = inner().flat_map(|place| place.normal.parts()).fold(0.0, |most: f64, force| most.max(force.abs()));
    let left = inner().map(|place| place.normal.residual().abs()).fold(0.0, f64::max);
    let names = ["active", "viscous", "elastic", "pressure", "shell"];
    let at_neck = still.neck.and_then(|neck| nearest(&still.places, neck.u)).map(|place| place.normal.parts());
    // Adding 0 takes the sign from a zero.
    let rounded = |force: f64| (10.0 * force).round() / 10.0 + 0.0;
    let parts: Vec<String> =
        at_neck.iter().flatten().zip(names).map(|(force, name)| format!("{name} {:+.1}", rounded(*force))).collect();
    // The sum is rounding and the tolerance of Newton's method, which differ between machines.
    let text = match left < 1e-5 * largest {
        true => format!("balanced; at the neck {}", parts.join(", ")),
        false => format!("off by {:.1e} of the largest", left / largest),
    };
    (left < 1e-5 * largest, text)
}

/// The four cells of the movies.
pub fn movies(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    let context = figure.context;
    let scene = |id: &str| match id {
        "movie_1" => Some(context.cell(3.0, 0.87)),
        "movie_2" => Some(context.cell(2.0, 0.87)),
        "movie_3" => Some(context.cell(1.6, 0.87)),
        "movie_4" => Some(context.cell(5.4, 0.87).with_cue(Cue::published())),
        _ => None,
    };
    let ids = figure.statements.iter().map(|statement| statement.id.as_str());
    let scenes: Vec<(&str, Cell)> = ids.filter_map(|id| Some((id, scene(id)?))).collect();
    let films: Vec<_> = scheduler::pool(context.threads)?
        .install(|| scenes.par_iter().map(|(_, cell)| Trajectory::compute(&context.input(cell.clone()))).collect());
    for ((id, cell), film) in scenes.into_iter().zip(films) {
        match film {
            Ok(film) => {
                let chi = film.division.chi().map_or(String::new(), |chi| format!(", χ = {chi:.3}"));
                figure.report(id, format!("{}{chi}", film.division.outcome()));
                figure.show(id, Artifact::Film(cell, Box::new(film)));
            }
            Err(error) => figure.report(id, format!("not computed: {error}")),
        }
    }
    Ok(())
}
