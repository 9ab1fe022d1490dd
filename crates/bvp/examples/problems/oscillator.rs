// u″ + λ w(u) = 0: with w = eᵘ Bratu's problem, with w = sin u the elastica. Shared by examples and tests.

use bvp::derivatives::PointDirection;
use bvp::{
    BoundaryJacobian, BoundaryValueProblem, CollocationPoint, Dimensions, Directional, Gauss, MirrorSymmetric,
    PointJacobian, Solution, mesh,
};

/// u″ + λ w(u) = 0 with y = (u, u′): u(0) = 0 and at the right end either u = 0 or, on a mirror-symmetric half, u′ = 0.
#[derive(Clone, Debug)]
pub struct Oscillator {
    /// w and its first three derivatives.
    pub force: fn(f64) -> [f64; 4],
    /// Component that vanishes at the right end.
    pub right: usize,
}

impl Oscillator {
    /// u = 0 on `intervals` of [0, end], which solves where w(0) = 0 or λ = 0.
    pub fn zero(&self, end: f64, intervals: usize, stages: usize, lambda: f64) -> Solution {
        Solution::from_fn(&Gauss::new(stages), &mesh::uniform(0.0, end, intervals), 2, &[lambda], |_, y| y.fill(0.0))
    }
}

impl BoundaryValueProblem for Oscillator {
    fn dimensions(&self) -> Dimensions {
        Dimensions { components: 2, integrable: 0, scalars: 1, left: 1, right: 1, integrals: 0 }
    }

    fn rhs(&self, _: CollocationPoint, y: &[f64], p: &[f64], f: &mut [f64], _: &mut [f64]) {
        f[0] = y[1];
        f[1] = -p[0] * (self.force)(y[0])[0];
    }

    fn rhs_jacobian(&self, _: CollocationPoint, y: &[f64], p: &[f64], out: &mut PointJacobian<'_>) {
        let w = (self.force)(y[0]);
        out.f[0] = y[1];
        out.f[1] = -p[0] * w[0];
        out.fy[1] = 1.0;
        out.fy[2] = -p[0] * w[1];
        out.fp[1] = -w[0];
    }

    fn left(&self, y: &[f64], _: &[f64], out: &mut BoundaryJacobian<'_>) {
        out.r[0] = y[0];
        out.ry[0] = 1.0;
    }

    fn right(&self, y: &[f64], _: &[f64], out: &mut BoundaryJacobian<'_>) {
        out.r[0] = y[self.right];
        out.ry[self.right] = 1.0;
    }
}

impl Directional for Oscillator {
    type Second = ();
    type Third = ();

    fn prepare_second(&self, _: &[f64], _: &[f64], _: &[f64]) {}

    fn second(
        &self,
        _: &(),
        _: CollocationPoint,
        y: &[f64],
        p: &[f64],
        a: PointDirection<'_>,
        b: PointDirection<'_>,
        f: &mut [f64],
        _: &mut [f64],
    ) {
        let w = (self.force)(y[0]);
        f[1] = -p[0] * w[2] * a.y[0] * b.y[0] - w[1] * (a.p[0] * b.y[0] + b.p[0] * a.y[0]);
    }

    fn prepare_third(&self, _: &[f64], _: &[f64]) {}

    fn third(
        &self,
        _: &(),
        _: CollocationPoint,
        y: &[f64],
        p: &[f64],
        a: PointDirection<'_>,
        f2: &mut [f64],
        _: &mut [f64],
        f3: &mut [f64],
    ) {
        let w = (self.force)(y[0]);
        f2[1] = -p[0] * w[2] * a.y[0] * a.y[0];
        f3[1] = -p[0] * w[3] * a.y[0] * a.y[0] * a.y[0];
    }
}

impl MirrorSymmetric for Oscillator {
    fn vanishing_at_mirror(&self) -> &[usize] {
        &[0]
    }

    fn free_at_mirror(&self) -> &[usize] {
        &[1]
    }
}
