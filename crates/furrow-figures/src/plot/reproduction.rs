//! The figures of the paper as furrow draws them: each by the picture of what it is.

use super::boundary::Boundary;
use super::branch::Named;
use super::perturbation::Watched;
use super::phase::Edges;
use super::{boundary, branch, division, perturbation, phase, rounds, sweep};
use crate::drawing::Canvas;
use furrow_analysis::reproduce::{Artifact, Panel};
use furrow_cell::Parameter;

/// Places of each mesh interval in the picture of a division.
const DENSE: usize = 6;

/// Draws a panel.
pub fn draw(panel: &Panel) -> Canvas {
    match &panel.artifact {
        Artifact::Sweep(of, rows) => sweep::draw(of, rows),
        Artifact::Map(map) => {
            let edges = Edges { pitchforks: map.pitchforks.clone(), folds: map.folds.clone() };
            phase::draw(&map.plane, &map.diagram, &edges)
        }
        Artifact::Branches(cell, branches) => {
            let named: Vec<Named<'_>> = branches.iter().map(|(name, branch)| Named { name, branch }).collect();
            branch::draw(cell, &named)
        }
        Artifact::Boundary(cell, range, pitchfork, folds) => {
            let cusps: Vec<_> = folds.iter().filter_map(|fold| fold.cusp()).collect();
            boundary::draw(&Boundary {
                cell,
                parameter: Parameter::R0,
                range: *range,
                pitchfork,
                folds,
                cusps: &cusps,
                critical: None,
            })
        }
        Artifact::Film(cell, film) => division::draw(cell, &film.as_ref().clone().with_places(DENSE)),
        Artifact::Perturbations(cell, watched) => {
            let title = format!("Disturbed stationary shapes at R₀ = {}, ε = {}", cell.r0, cell.epsilon);
            let named: Vec<Watched<'_>> =
                watched.iter().map(|(name, perturbation)| Watched { name: name.clone(), perturbation }).collect();
            perturbation::draw_many(&title, &named)
        }
        Artifact::Tree(tree) => rounds::draw(tree),
    }
}
