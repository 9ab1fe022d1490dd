//! A grid as a closed mesh of triangles.

use super::{SurfaceError, SurfaceGrid};

/// The points of a pole may differ by this share of the size of the surface.
const POLE: f64 = 1e-6;

/// A closed surface of triangles, with one vertex at each pole.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SurfaceMesh {
    /// x, y and z of every vertex, in L_h.
    pub points: Vec<[f64; 3]>,
    /// Outward normals of length 1.
    pub normals: Vec<[f64; 3]>,
    /// The value at every vertex.
    pub values: Vec<f64>,
    /// Numbers of the vertices, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl SurfaceGrid {
    /// The surface as triangles: two in each field of the grid, one in fields at a pole.
    ///
    /// # Errors
    /// [`SurfaceError`] of a grid that is no closed surface.
    pub fn mesh(&self) -> Result<SurfaceMesh, SurfaceError> {
        self.check()?;
        let (columns, last) = (self.columns, (self.rows - 1) * self.columns);
        let mut mesh = SurfaceMesh::default();
        for k in std::iter::once(0).chain(columns..last).chain([last]) {
            mesh.points.push(self.points[k]);
            mesh.values.push(self.values[k]);
            let at_pole = k == 0 || k == last;
            mesh.normals.push(unit(if at_pole { sum(&self.normals[k..k + columns]) } else { self.normals[k] }));
        }
        mesh.triangles = triangles(self.rows, columns);
        // Grids may go around the axis in either direction.
        if mesh.volume() < 0.0 {
            mesh.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
        }
        Ok(mesh)
    }

    fn check(&self) -> Result<(), SurfaceError> {
        let SurfaceGrid { rows, columns, points, normals, values } = self;
        let (rows, columns) = (*rows, *columns);
        if rows < 3 || columns < 3 {
            return Err(SurfaceError::Small { rows, columns });
        }
        let wanted = rows.saturating_mul(columns);
        for (name, found) in [("points", points.len()), ("normals", normals.len()), ("values", values.len())] {
            if found != wanted {
                return Err(SurfaceError::Count { name, found, wanted });
            }
        }
        let finite = |vector: &[f64; 3]| vector.iter().all(|x| x.is_finite());
        for k in 0..wanted {
            let parts =
                [("point", finite(&points[k])), ("normal", finite(&normals[k])), ("value", values[k].is_finite())];
            if let Some((name, _)) = parts.into_iter().find(|(_, finite)| !finite) {
                return Err(SurfaceError::NotFinite { name, row: k / columns, column: k % columns });
            }
        }
        let size = points.iter().map(|point| apart(*point, points[0])).fold(0.0, f64::max);
        for row in [0, rows - 1] {
            let pole = &points[row * columns..][..columns];
            let apart = pole.iter().map(|point| apart(*point, pole[0])).fold(0.0, f64::max);
            if apart > POLE * size {
                return Err(SurfaceError::OpenPole { row, apart });
            }
        }
        Ok(())
    }
}

/// The triangles of a grid with one vertex at each pole.
fn triangles(rows: usize, columns: usize) -> Vec<[u32; 3]> {
    let end = (rows - 2) * columns + 1;
    let vertex = |row: usize, column: usize| match row {
        0 => 0,
        _ if row == rows - 1 => end as u32,
        _ => (1 + (row - 1) * columns + column % columns) as u32,
    };
    let mut found = Vec::with_capacity(2 * (rows - 2) * columns);
    for row in 0..rows - 1 {
        for column in 0..columns {
            let [a, b] = [vertex(row, column), vertex(row + 1, column)];
            let [d, c] = [vertex(row, column + 1), vertex(row + 1, column + 1)];
            if b != c {
                found.push([a, b, c]);
            }
            if a != d {
                found.push([a, c, d]);
            }
        }
    }
    found
}

impl SurfaceMesh {
    /// The enclosed volume, in L_h³; positive if the triangles are counter-clockwise seen from outside.
    pub fn volume(&self) -> f64 {
        let corner = |k: u32| self.points[k as usize];
        let of = |[a, b, c]: &[u32; 3]| dot(corner(*a), cross(corner(*b), corner(*c)));
        self.triangles.iter().map(of).sum::<f64>() / 6.0
    }
}

fn sum(vectors: &[[f64; 3]]) -> [f64; 3] {
    [0, 1, 2].map(|c| vectors.iter().map(|vector| vector[c]).sum())
}

fn unit(vector: [f64; 3]) -> [f64; 3] {
    let length = dot(vector, vector).sqrt();
    if length > 0.0 { vector.map(|x| x / length) } else { [0.0, 0.0, 1.0] }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    let between = [0, 1, 2].map(|c| a[c] - b[c]);
    dot(between, between).sqrt()
}
