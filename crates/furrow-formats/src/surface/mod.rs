//! The surface of a cell as a grid, with or without an axis of symmetry, and as triangles.
//!
//! | file | content |
//! |---|---|
//! | `mesh` | the grid as a closed mesh of triangles |
//! | `colour` | the colour of a value |
//! | `ply`, `glb` | the mesh as a file that other programs open |

mod colour;
mod glb;
mod mesh;
mod ply;

pub use colour::{LOWERED, RAISED, blended, strongest};
pub use glb::glb;
pub use mesh::SurfaceMesh;
pub use ply::ply;

use furrow_mechanics::cortex::forces::Place;

/// A closed surface at points on a grid: rows from pole to pole, columns around the axis.
///
/// Point k = row · `columns` + column. The first row is the posterior pole and the last the anterior one; all points of
/// such a row are the same. Columns go around the axis once, and the first column is not repeated. Lengths are in L_h and
/// the axis of the shell is z.
///
/// ```
/// use furrow_cell::Cell;
/// use furrow_formats::surface::SurfaceGrid;
/// use furrow_mechanics::division::{DivisionInput, Trajectory};
///
/// let film = Trajectory::compute(&DivisionInput::new(Cell::new(2.5)))?;
/// let surface = SurfaceGrid::revolved(&film.at(0.5).places, 48, |place| place.t_uu);
/// let volume = 4.0 / 3.0 * std::f64::consts::PI * 2.5_f64.powi(3);
/// assert!((surface.mesh()?.volume() / volume - 1.0).abs() < 0.01);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SurfaceGrid {
    /// Number of rows, with both poles.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
    /// x, y and z of every point.
    pub points: Vec<[f64; 3]>,
    /// Outward normals of length 1.
    pub normals: Vec<[f64; 3]>,
    /// The value at every point.
    pub values: Vec<f64>,
}

impl SurfaceGrid {
    /// The surface of revolution of a contour, with a row at each of its places and the normals of their tangent angles.
    pub fn revolved(places: &[Place], columns: usize, value: impl Fn(&Place) -> f64) -> SurfaceGrid {
        let mut grid = SurfaceGrid { rows: places.len(), columns, ..SurfaceGrid::default() };
        let turn = |column: usize| (column as f64 / columns as f64 * std::f64::consts::TAU).sin_cos();
        let turns: Vec<(f64, f64)> = (0..columns).map(turn).collect();
        for (row, place) in places.iter().enumerate() {
            let at_pole = row == 0 || row + 1 == places.len();
            let r = if at_pole { 0.0 } else { place.r.max(0.0) };
            let (out, along) = if at_pole { (0.0, place.psi.cos().signum()) } else { place.psi.sin_cos() };
            grid.points.extend(turns.iter().map(|(sin, cos)| [r * cos, r * sin, place.z]));
            grid.normals.extend(turns.iter().map(|(sin, cos)| [out * cos, out * sin, along]));
            grid.values.extend(std::iter::repeat_n(value(place), columns));
        }
        grid
    }
}

/// Why a grid is no closed surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SurfaceError {
    /// Too few rows or columns.
    #[error("a surface has {rows} rows and {columns} columns: at least 3 of each are needed")]
    Small {
        /// The number of rows.
        rows: usize,
        /// The number of columns.
        columns: usize,
    },
    /// A list that is not as long as the grid has points.
    #[error("a surface has {found} {name}: {wanted}, one for each point of its grid, are needed")]
    Count {
        /// The name of the list.
        name: &'static str,
        /// The length of the list.
        found: usize,
        /// The number of points.
        wanted: usize,
    },
    /// A number that is infinite or not a number.
    #[error("{name} of a surface at row {row}, column {column} must be finite")]
    NotFinite {
        /// The quantity.
        name: &'static str,
        /// The row, from 0.
        row: usize,
        /// The column, from 0.
        column: usize,
    },
    /// A first or last row that is not one point.
    #[error("the points in row {row} of a surface, a pole, must be one point, but are {apart:.3e} L_h apart")]
    OpenPole {
        /// The row, from 0.
        row: usize,
        /// The largest distance from its first point.
        apart: f64,
    },
    /// More frames than one file can hold.
    #[error("a binary glTF file holds at most 4 GB: write fewer frames")]
    Large,
}

/// One surface of a division.
#[derive(Clone, Debug, Default)]
pub struct SurfaceFrame {
    /// The surface.
    pub surface: SurfaceGrid,
    /// Metadata for the list of frames and for glTF's extras, such as the time `t` in τ.
    pub about: serde_json::Map<String, serde_json::Value>,
}

#[cfg(test)]
mod tests;
