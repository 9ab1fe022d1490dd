//! A problem with one more scalar unknown β, which unfolds its branch points.

use crate::dimensions::Dimensions;
use crate::problem::{BoundaryJacobian, BoundaryValueProblem, CollocationPoint, CollocationPoints, PointJacobian};

/// F(x) + βw = 0: multiples of β are added to all conditions. A left null vector that is zero in all of them is zero everywhere.
/// The value of β is kept here, so that a solution has the scalars of the problem itself.
pub(super) struct Unfolded<'a> {
    pub inner: &'a mut dyn BoundaryValueProblem,
    pub beta: f64,
    /// w: of the right conditions, then of the integral and of the left ones.
    pub weights: &'a [f64],
}

/// The sizes of a problem with β.
pub(super) fn unfolded(dims: Dimensions) -> Dimensions {
    Dimensions { scalars: dims.scalars + 1, ..dims }
}

/// Copies rows of `width` numbers into rows that have one more, which is left alone.
fn widen(from: &[f64], width: usize, to: &mut [f64]) {
    for (from, to) in from.chunks_exact(width).zip(to.chunks_exact_mut(width + 1)) {
        to[..width].copy_from_slice(from);
    }
}

impl Unfolded<'_> {
    /// Derivatives by the scalars in the widths of the problem itself, to be widened by the caller.
    fn narrow(&self, widened: &[f64]) -> (usize, Vec<f64>) {
        let width = self.inner.dimensions().scalars;
        (width, vec![0.0; widened.len() / (width + 1) * width])
    }

    /// Adds βw to conditions, for the weights from `first` on.
    fn unfold(&self, first: usize, out: &mut BoundaryJacobian<'_>) {
        let rows = out.rp.chunks_exact_mut(self.inner.dimensions().scalars + 1);
        for ((r, row), w) in out.r.iter_mut().zip(rows).zip(&self.weights[first..]) {
            *r += w * self.beta;
            row[row.len() - 1] = *w;
        }
    }
}

impl BoundaryValueProblem for Unfolded<'_> {
    fn dimensions(&self) -> Dimensions {
        unfolded(self.inner.dimensions())
    }

    fn prepare(&mut self, p: &[f64]) {
        self.inner.prepare(p);
    }

    fn prepare_points(&mut self, x: &[f64], p: &[f64]) {
        self.inner.prepare_points(x, p);
    }

    fn rhs(&self, at: CollocationPoint, y: &[f64], p: &[f64], f: &mut [f64], g: &mut [f64]) {
        self.inner.rhs(at, y, p, f, g);
    }

    fn rhs_jacobian(&self, at: CollocationPoint, y: &[f64], p: &[f64], out: &mut PointJacobian<'_>) {
        let points = CollocationPoints { first: at.index, x: &[at.x], y };
        self.rhs_jacobian_many(points, p, out);
    }

    fn rhs_many(&self, points: CollocationPoints<'_>, p: &[f64], f: &mut [f64], g: &mut [f64]) {
        self.inner.rhs_many(points, p, f, g);
    }

    fn rhs_jacobian_many(&self, points: CollocationPoints<'_>, p: &[f64], out: &mut PointJacobian<'_>) {
        let (width, mut fp) = self.narrow(out.fp);
        let (_, mut gp) = self.narrow(out.gp);
        let PointJacobian { f, fy, g, gy, .. } = out;
        self.inner.rhs_jacobian_many(points, p, &mut PointJacobian { f, fy, fp: &mut fp, g, gy, gp: &mut gp });
        widen(&fp, width, out.fp);
        widen(&gp, width, out.gp);
    }

    fn left(&self, y: &[f64], p: &[f64], out: &mut BoundaryJacobian<'_>) {
        let (width, mut rp) = self.narrow(out.rp);
        self.inner.left(y, p, &mut BoundaryJacobian { r: out.r, ry: out.ry, rp: &mut rp });
        widen(&rp, width, out.rp);
        let Dimensions { right, integrals, .. } = self.inner.dimensions();
        self.unfold(right + integrals, out);
    }

    fn right(&self, y: &[f64], p: &[f64], out: &mut BoundaryJacobian<'_>) {
        let (width, mut rp) = self.narrow(out.rp);
        self.inner.right(y, p, &mut BoundaryJacobian { r: out.r, ry: out.ry, rp: &mut rp });
        widen(&rp, width, out.rp);
        self.unfold(0, out);
    }

    fn integral_offset(&self, k: usize, p: &[f64], hp: &mut [f64]) -> f64 {
        let Dimensions { scalars, right, .. } = self.inner.dimensions();
        let w = self.weights[right + k];
        hp[scalars] += w;
        self.inner.integral_offset(k, p, &mut hp[..scalars]) + w * self.beta
    }
}
