//! A rod that is held in place on average.

use furrow_bvp::{
    BoundaryJacobian, BoundaryValueProblem, CollocationPoint, Dimensions, Directional, Gauss, PointDirection,
    PointJacobian, PointValues, Solution, mesh,
};

/// u″ + λ sin u + μ = 0, u = 0 at both ends, ∫ u = 0, with y = (u, u′) and p = (μ, λ). The integral condition is
/// written as ∫ (u + μ/2) − μ/2, so that both of its parts depend on μ.
#[derive(Clone, Debug)]
pub struct Held;

impl Held {
    /// u = 0, μ = 0.
    pub fn guess(intervals: usize, lambda: f64) -> Solution {
        let (gauss, mesh) = (Gauss::default(), mesh::uniform(0.0, 1.0, intervals));
        Solution::from_fn(&gauss, &mesh, 2, &[0.0, lambda], |_, y| y.fill(0.0)).unwrap()
    }
}

impl BoundaryValueProblem for Held {
    fn dimensions(&self) -> Dimensions {
        Dimensions { components: 2, scalars: 2, left: 1, right: 1, integrals: 1, ..Dimensions::default() }
    }

    fn rhs(&self, _: CollocationPoint, y: &[f64], p: &[f64], f: &mut [f64], g: &mut [f64]) {
        f.copy_from_slice(&[y[1], -p[1] * y[0].sin() - p[0]]);
        g[0] = y[0] + 0.5 * p[0];
    }

    fn rhs_jacobian(&self, at: CollocationPoint, y: &[f64], p: &[f64], out: &mut PointJacobian<'_>) {
        self.rhs(at, y, p, out.f, out.g);
        out.fy.copy_from_slice(&[0.0, 1.0, -p[1] * y[0].cos(), 0.0]);
        out.fp[2..].copy_from_slice(&[-1.0, -y[0].sin()]);
        (out.gy[0], out.gp[0]) = (1.0, 0.5);
    }

    fn left(&self, y: &[f64], _: &[f64], out: &mut BoundaryJacobian<'_>) {
        (out.r[0], out.ry[0]) = (y[0], 1.0);
    }

    fn right(&self, y: &[f64], _: &[f64], out: &mut BoundaryJacobian<'_>) {
        (out.r[0], out.ry[0]) = (y[0], 1.0);
    }

    fn integral_offset(&self, _: usize, p: &[f64], hp: &mut [f64]) -> f64 {
        hp[0] -= 0.5;
        -0.5 * p[0]
    }
}

impl Directional for Held {
    fn second(&self, at: PointValues, [a, b]: [PointDirection; 2], [f, _]: [&mut [f64]; 2]) {
        let (sine, cosine) = at.y[0].sin_cos();
        f[1] = at.p[1] * sine * a.y[0] * b.y[0] - cosine * (a.p[1] * b.y[0] + b.p[1] * a.y[0]);
    }
}
