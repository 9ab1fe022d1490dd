//! The figures of the paper as furrow draws them: each by the picture of what it is.

use super::boundary::Boundary;
use super::branch::Named;
use super::perturbation::Watched;
use super::phase::Edges;
use super::{boundary, branch, division, perturbation, phase, rounds, sweep};
use crate::cell::Parameter;
use crate::drawing::Canvas;
use crate::study::reproduce::{Panel, Shown};

/// Places of each mesh interval in the picture of a division.
const DENSE: usize = 6;

/// Draws a panel.
pub fn draw(panel: &Panel) -> Canvas {
    match &panel.shown {
        Shown::Sweep(of, rows) => sweep::draw(of, rows),
        Shown::Map(map) => {
            let edges = Edges { pitchforks: map.pitchforks.clone(), folds: map.folds.clone() };
            phase::draw(&map.plane, &map.diagram, &edges)
        }
        Shown::Branches(cell, branches) => {
            let named: Vec<Named<'_>> = branches.iter().map(|(name, branch)| Named { name, branch }).collect();
            branch::draw(cell, &named)
        }
        Shown::Boundary(cell, range, pitchfork, folds) => {
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
        Shown::Film(cell, film) => division::draw(cell, &film.as_ref().clone().with_places(DENSE)),
        Shown::Perturbations(cell, watched) => {
            let title = format!("Disturbed stationary shapes at R₀ = {}, ε = {}", cell.r0, cell.epsilon);
            let named: Vec<Watched<'_>> =
                watched.iter().map(|(name, perturbation)| Watched { name: name.clone(), perturbation }).collect();
            perturbation::draw_many(&title, &named)
        }
        Shown::Tree(tree) => rounds::draw(tree),
    }
}
