//! The shell, as glass that is visible mainly at its edge.

use std::f64::consts::{PI, TAU};

use super::raster::{Part, Window, parts};
use super::view::View;
use crate::drawing::FigureError;
use furrow_formats::surface::SurfaceGrid;
use furrow_mechanics::cortex::Wall;

/// Colour of the glass.
pub const GLASS: [f32; 3] = [104.0, 130.0, 150.0];
/// Opacity of the glass where it faces the viewer, and the opacity added at its edge.
const FACING: f32 = 0.015;
const EDGE: f32 = 0.30;
/// Rows and columns of its surface, enough for a smooth outline.
const ROWS: usize = 145;
const COLUMNS: usize = 192;

/// Lengths on the canvas of half the picture of a shell, to the right and upwards.
pub fn outline(wall: &Wall, view: &View) -> [f64; 2] {
    let points = (0..ROWS * COLUMNS).map(|k| view.point(place(wall, k)));
    points.fold([0.0; 2], |most, point| [0, 1].map(|c| f64::max(most[c], (point[c] - view.centre[c]).abs())))
}

/// A point of the grid.
fn place(wall: &Wall, k: usize) -> [f64; 3] {
    let around = (k % COLUMNS) as f64 / COLUMNS as f64 * TAU;
    match k / COLUMNS {
        // Rounding leaves sin π above 0, and a pole is one point.
        row if row + 1 == ROWS => wall.place(PI, 0.0),
        row => wall.place(row as f64 / (ROWS - 1) as f64 * PI, around),
    }
}

/// The share of each pixel of a window that the glass of a shell covers.
///
/// # Errors
/// Of a shell that is not finite.
pub fn glass(wall: &Wall, view: &View, density: f64, window: Window) -> Result<Vec<f32>, FigureError> {
    let points: Vec<[f64; 3]> = (0..ROWS * COLUMNS).map(|k| place(wall, k)).collect();
    let normals = points.iter().map(|point| wall.normal(*point)).collect();
    let grid = SurfaceGrid { rows: ROWS, columns: COLUMNS, values: vec![0.0; points.len()], points, normals };
    let share = |part: &Part| {
        let grazing = 1.0 - part.normal[2].clamp(0.0, 1.0);
        part.cover * (FACING + EDGE * grazing * grazing * grazing)
    };
    let all = parts(&grid.mesh()?, view, density, window);
    Ok(all.iter().map(|both| both.iter().map(share).sum()).collect())
}
