//! Second and third derivatives of a problem along directions.

use crate::dimensions::Dimensions;

use super::differences;
use super::statement::{BoundaryValueProblem, CollocationPoint, CollocationPoints};

/// A collocation point with the unknowns there.
#[derive(Clone, Copy, Debug)]
pub struct PointValues<'a> {
    /// The point.
    pub at: CollocationPoint,
    /// Components of y.
    pub y: &'a [f64],
    /// Scalar unknowns.
    pub p: &'a [f64],
}

/// A direction in the unknowns: components of y, at one point or at many one behind the other, and scalar unknowns.
#[derive(Clone, Copy, Debug)]
pub struct PointDirection<'a> {
    /// Along y.
    pub y: &'a [f64],
    /// Along the scalar unknowns.
    pub p: &'a [f64],
}

/// The unknowns in boundary conditions and in the parts h(p) of integral conditions, or a direction in them.
#[derive(Clone, Copy, Debug)]
pub struct EndValues<'a> {
    /// y at the left end.
    pub left: &'a [f64],
    /// y at the right end.
    pub right: &'a [f64],
    /// Scalar unknowns.
    pub p: &'a [f64],
}

/// A derivative of boundary conditions and of the parts h(p) of integral conditions along directions.
#[derive(Debug)]
pub struct EndDerivatives<'a> {
    /// Of the left conditions.
    pub left: &'a mut [f64],
    /// Of the right conditions.
    pub right: &'a mut [f64],
    /// Of h(p).
    pub offsets: &'a mut [f64],
}

/// Problems with second and third derivatives of their equations along directions, as folds, pitchforks and normal
/// forms need. Only [`second`](Self::second) must be written; `Auto` writes all.
///
/// [`prepare`](BoundaryValueProblem::prepare) is called before every sweep. Outputs are zero before every call.
pub trait Directional: BoundaryValueProblem {
    /// D²f\[a, b\] and D²g\[a, b\] at one point into the two of `out`.
    fn second(&self, point: PointValues, along: [PointDirection; 2], out: [&mut [f64]; 2]);

    /// D²f\[a, a\] and D²g\[a, a\] into the first pair of `out`, D³f\[a, a, a\] and D³g\[a, a, a\] into the second. Returns
    /// whether it is written: by default it is not, and differences of [`second_many`](Self::second_many) are taken.
    fn third(&self, _point: PointValues, _along: PointDirection, _out: [[&mut [f64]; 2]; 2]) -> bool {
        false
    }

    /// [`second`](Self::second) at many points. A problem may compute here, once, what depends on the scalars alone.
    fn second_many(
        &self,
        points: CollocationPoints<'_>,
        p: &[f64],
        along: [PointDirection; 2],
        [f, g]: [&mut [f64]; 2],
    ) {
        let Dimensions { components: n, integrals: ni, .. } = self.dimensions();
        for i in 0..points.x.len() {
            let along = along.map(|d| d.of_point(i, n));
            let out = [&mut f[i * n..(i + 1) * n], &mut g[i * ni..(i + 1) * ni]];
            self.second(points.point(i, n, p), along, out);
        }
    }

    /// [`third`](Self::third) at many points.
    fn third_many(
        &mut self,
        points: CollocationPoints<'_>,
        p: &[f64],
        along: PointDirection,
        [[f2, g2], [f3, g3]]: [[&mut [f64]; 2]; 2],
    ) {
        let Dimensions { components: n, integrals: ni, .. } = self.dimensions();
        for i in 0..points.x.len() {
            let (f, g) = (i * n..(i + 1) * n, i * ni..(i + 1) * ni);
            let out = [[&mut f2[f.clone()], &mut g2[g.clone()]], [&mut f3[f], &mut g3[g]]];
            if !self.third(points.point(i, n, p), along.of_point(i, n), out) {
                return differences::third(self, points, p, along, [[f2, g2], [f3, g3]]);
            }
        }
    }

    /// D²r\[a, b\] of the boundary conditions and D²h\[a, b\] of integral conditions. By default differences of their first
    /// derivatives, which are exactly zero for linear conditions.
    fn second_at_ends(&mut self, at: EndValues, along: [EndValues; 2], out: EndDerivatives<'_>) {
        differences::second_at_ends(self, at, along, out);
    }

    /// D³r\[a, a, a\] and D³h\[a, a, a\], by default by differences.
    fn third_at_ends(&mut self, at: EndValues, along: EndValues, out: EndDerivatives<'_>) {
        differences::third_at_ends(self, at, along, out);
    }
}

impl<'a> CollocationPoints<'a> {
    /// Point i of these.
    fn point(&self, i: usize, n: usize, p: &'a [f64]) -> PointValues<'a> {
        let at = CollocationPoint { x: self.x[i], index: self.first + i };
        PointValues { at, y: &self.y[i * n..(i + 1) * n], p }
    }
}

impl<'a> PointDirection<'a> {
    /// Of a direction at many points, that at point i.
    fn of_point(&self, i: usize, n: usize) -> PointDirection<'a> {
        PointDirection { y: &self.y[i * n..(i + 1) * n], p: self.p }
    }
}
