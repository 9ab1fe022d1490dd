//! The figures of the paper, drawn with the pictures of the commands.

use super::{branch, division, perturbation, phase, rounds, sweep};
use crate::drawing::Canvas;
use furrow_analysis::reproduce::{Artifact, NamedArtifact};

/// Places in each mesh interval for the picture of a division.
const DENSE: usize = 6;

/// Draws a panel.
pub fn draw(panel: &NamedArtifact) -> Canvas {
    match &panel.artifact {
        Artifact::Sweep(of, rows) => sweep::draw(of, rows),
        Artifact::Map(map) => phase::draw(&map.plane, &map.diagram, &map.edges),
        Artifact::Branches(cell, branches) => branch::draw(cell, branches, None),
        Artifact::Film(cell, film) => division::draw(cell, &film.as_ref().clone().with_places(DENSE)),
        Artifact::Perturbations(cell, watched) => {
            let title = format!("Disturbed stationary shapes at R₀ = {}, ε = {}", cell.r0, cell.epsilon);
            perturbation::draw(&title, watched)
        }
        Artifact::Tree(tree) => rounds::draw(tree),
    }
}
