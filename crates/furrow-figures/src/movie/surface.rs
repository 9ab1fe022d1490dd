//! The surface of a cell as facets: turned, projected and shaded.

use nalgebra::{Rotation3, Vector3};

use crate::drawing::Canvas;
use crate::drawing::cell::{changes, cue_colour, strongest};
use crate::drawing::regulator::PhiRange;
use crate::drawing::style::Colour;
use furrow_cell::Cue;
use furrow_mechanics::division::Snapshot;

/// Angles in radians by which the axis is turned towards the viewer, and by which the viewer looks down.
const TURNED: [f64; 2] = [0.42, 0.30];
/// Direction of the light: from above, from the left and from the viewer's side.
const LIGHT: [f64; 3] = [-0.25, 0.70, 1.0];
/// Colour of the cortex in full light.
const CORTEX: [f64; 3] = [186.0, 222.0, 244.0];
/// Share of the light that reaches every facet.
const AMBIENT: f64 = 0.58;
/// Enlargement of the facets, so that no gaps show between them.
const OVERLAP: f64 = 0.9;

/// A viewing direction.
#[derive(Clone, Copy, Debug)]
pub struct View {
    rotation: Rotation3<f64>,
    /// The centre of the shell on the canvas.
    pub centre: [f64; 2],
    /// Units of the canvas for one L_h.
    pub scale: f64,
}

impl View {
    /// The usual view. The axis is horizontal, with the anterior pole, u = 1, on the left and away from the viewer.
    pub fn new(centre: [f64; 2], scale: f64) -> View {
        let [turn, down] = TURNED;
        let rotation = Rotation3::from_axis_angle(&Vector3::x_axis(), down)
            * Rotation3::from_axis_angle(&Vector3::y_axis(), -turn);
        View { rotation, centre, scale }
    }

    /// A point at distance r from the axis, at an angle around it (a quarter turn is upwards), and at z along it.
    fn place([r, z]: [f64; 2], angle: f64) -> Vector3<f64> {
        let (sin, cos) = angle.sin_cos();
        Vector3::new(z, r * sin, r * cos)
    }

    /// The position of such a point on the canvas.
    pub fn point(&self, at: [f64; 2], angle: f64) -> [f64; 2] {
        self.project(&(self.rotation * View::place(at, angle)))
    }

    /// Lengths on the canvas of a unit along the axis and of a unit upwards from it.
    pub fn lengths(&self) -> [f64; 2] {
        let origin = self.point([0.0, 0.0], 0.0);
        let length = |[x, y]: [f64; 2]| (x - origin[0]).hypot(y - origin[1]);
        [length(self.point([0.0, 1.0], 0.0)), length(self.point([1.0, 0.0], std::f64::consts::FRAC_PI_2))]
    }

    fn project(&self, turned: &Vector3<f64>) -> [f64; 2] {
        [self.centre[0] + self.scale * turned.x, self.centre[1] - self.scale * turned.y]
    }
}

/// One facet on the canvas.
struct Facet {
    /// Position of the ring's centre along the line of sight; larger is nearer.
    depth: f64,
    corners: [[f64; 2]; 4],
    colour: Colour,
}

/// The resolution of a surface.
#[derive(Clone, Copy, Debug)]
pub struct Fineness {
    /// Facets from pole to pole.
    pub along: usize,
    /// Facets around the axis.
    pub around: usize,
    /// Number of shades.
    pub shades: f64,
}

/// The meridian at evenly spaced values of a measure between u and arclength of the outline: (u, r, z, φ).
fn meridian(still: &Snapshot, count: usize) -> Vec<[f64; 4]> {
    let places = &still.places;
    let at = |k: usize| {
        let u = k as f64 / count as f64;
        let behind = places.partition_point(|place| place.u < u).clamp(1, places.len().max(2) - 1);
        match (places.get(behind - 1), places.get(behind)) {
            (Some(a), Some(b)) if b.u > a.u => {
                let share = (u - a.u) / (b.u - a.u);
                let phi = a.phi.zip(b.phi).map_or(0.0, |(a, b)| a + share * (b - a));
                [u, (a.r + share * (b.r - a.r)).max(0.0), a.z + share * (b.z - a.z), phi]
            }
            (a, _) => a.map_or([u, 0.0, 0.0, 0.0], |a| [u, a.r.max(0.0), a.z, a.phi.unwrap_or(0.0)]),
        }
    };
    (0..=count).map(at).collect()
}

/// Draws the surface of a cell ring by ring, from far to near. The visible facets of a ring do not cover each other, so
/// that facets of the same colour are drawn as one shape.
pub fn draw(canvas: &mut Canvas, still: &Snapshot, cue: (&Cue, Option<PhiRange>), view: &View, fineness: Fineness) {
    let mut facets = facets(still, cue, view, fineness);
    facets.sort_by(|a, b| a.depth.total_cmp(&b.depth).then(a.colour.cmp(&b.colour)));
    for alike in facets.chunk_by(|a, b| a.depth == b.depth && a.colour == b.colour) {
        canvas.facets(alike.iter().map(|facet| facet.corners), alike[0].colour);
    }
}

/// The facets that face the viewer.
fn facets(still: &Snapshot, (cue, phi): (&Cue, Option<PhiRange>), view: &View, fineness: Fineness) -> Vec<Facet> {
    let Fineness { along, around, shades } = fineness;
    let line = meridian(still, along);
    let changes = changes(cue, still.length);
    let light = Vector3::from(LIGHT).normalize();
    let angle = |k: usize| k as f64 / around as f64 * std::f64::consts::TAU;
    let mut found = Vec::new();
    for pair in line.windows(2) {
        let ([u, r, z, phi1], [u2, r2, z2, phi2]) = (pair[0], pair[1]);
        let depth = (view.rotation * View::place([0.0, 0.5 * (z + z2)], 0.0)).z;
        let of_cue = if still.t > 0.0 { strongest(&changes, 0.5 * (u + u2)) } else { 0.0 };
        let carried = phi.map_or(0.0, |range| range.share(0.5 * (phi1 + phi2)));
        let here = if carried.abs() > of_cue.abs() { carried } else { of_cue };
        let tint = cue_colour(here).map(f64::from);
        for k in 0..around {
            let corners = [([r, z], k), ([r2, z2], k), ([r2, z2], k + 1), ([r, z], k + 1)];
            let corners = corners.map(|(place, k)| view.rotation * View::place(place, angle(k)));
            // From the diagonals, which do not vanish at the poles.
            let outwards = (corners[3] - corners[1]).cross(&(corners[2] - corners[0]));
            let Some(normal) = outwards.try_normalize(1e-14).filter(|normal| normal.z >= -0.02) else { continue };
            let lit = (AMBIENT + (1.0 - AMBIENT) * normal.dot(&light).max(0.0)).min(1.0);
            let lit = (lit * shades).round() / shades;
            let colour = [0, 1, 2].map(|c| lit * (CORTEX[c] + 0.85 * here.abs() * (tint[c] - CORTEX[c])));
            let colour = colour.map(|light: f64| light.clamp(0.0, 255.0) as u8);
            found.push(Facet { depth, corners: larger(corners.map(|corner| view.project(&corner))), colour });
        }
    }
    found
}

fn larger(corners: [[f64; 2]; 4]) -> [[f64; 2]; 4] {
    let middle = [0, 1].map(|c| corners.iter().map(|corner| corner[c]).sum::<f64>() / 4.0);
    corners.map(|[x, y]| {
        let (dx, dy) = (x - middle[0], y - middle[1]);
        let length = dx.hypot(dy).max(1e-9);
        [x + OVERLAP * dx / length, y + OVERLAP * dy / length]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use furrow_cell::Cell;
    use furrow_mechanics::division::{DivisionInput, Trajectory};

    #[test]
    fn the_visible_facets_cover_the_outline_of_the_cell() {
        let film = Trajectory::compute(&DivisionInput::new(Cell::gao2026_thresholds(2.5))).unwrap();
        let view = View::new([0.0, 0.0], 1.0);
        let fineness = Fineness { along: 60, around: 48, shades: 32.0 };
        for t in [0.0, 0.5 * film.division.t_end] {
            let still = film.at(t);
            let found = facets(&still, (&Cue::none(), None), &view, fineness);
            // The outline of a nearly spherical body of revolution contains the disc of its least radius and lies
            // within the disc of its largest.
            let reach = still.places.iter().map(|p| p.r.hypot(p.z)).fold(0.0, f64::max) + 2.0 * OVERLAP;
            assert!(found.len() > 60 * 48 / 3 && found.len() < 60 * 48 * 2 / 3, "{}", found.len());
            assert!(found.iter().flat_map(|f| f.corners).all(|[x, y]| x.hypot(y) < reach));
        }
    }
}
