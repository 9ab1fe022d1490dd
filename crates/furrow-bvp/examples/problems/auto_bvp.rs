// u″ + (λπ)²u − u² = 0, the demo `bvp` of AUTO. Shared by examples and tests.

use furrow_bvp::{
    BoundaryJacobian, BoundaryValueProblem, CollocationPoint, Dimensions, Directional, Gauss, PointDirection,
    PointJacobian, PointValues, Solution, mesh,
};

/// v″ + (λπ)²v − v² = 0 for v = u − q, u = 0 at both ends, as y = (u, u′). The branch v = 0 is crossed at λ = 1, 2, 3 …
#[derive(Clone, Debug)]
pub struct AutoBvp {
    /// q(x) and q″(x), with q = 0 at both ends. AUTO's problem has q = 0.
    pub profile: fn(f64) -> [f64; 2],
    /// Added to the force.
    pub imperfection: f64,
}

impl AutoBvp {
    /// The problem of AUTO.
    pub const PERFECT: AutoBvp = AutoBvp { profile: |_| [0.0; 2], imperfection: 0.0 };

    /// u = q at λ, with the slope 0 for u′, which a start corrects.
    pub fn guess(&self, intervals: usize, lambda: f64) -> Solution {
        let profile = |x: f64, y: &mut [f64]| y.copy_from_slice(&[(self.profile)(x)[0], 0.0]);
        Solution::from_fn(&Gauss::default(), &mesh::uniform(0.0, 1.0, intervals), 2, &[lambda], profile)
            .expect("a mesh")
    }
}

fn squared(lambda: f64) -> f64 {
    (lambda * std::f64::consts::PI).powi(2)
}

impl BoundaryValueProblem for AutoBvp {
    fn dimensions(&self) -> Dimensions {
        Dimensions { components: 2, scalars: 1, left: 1, right: 1, ..Dimensions::default() }
    }

    fn rhs(&self, at: CollocationPoint, y: &[f64], p: &[f64], f: &mut [f64], _: &mut [f64]) {
        let [q, bent] = (self.profile)(at.x);
        let v = y[0] - q;
        f.copy_from_slice(&[y[1], bent - squared(p[0]) * v + v * v + self.imperfection]);
    }

    fn rhs_jacobian(&self, at: CollocationPoint, y: &[f64], p: &[f64], out: &mut PointJacobian<'_>) {
        self.rhs(at, y, p, out.f, out.g);
        let v = y[0] - (self.profile)(at.x)[0];
        out.fy.copy_from_slice(&[0.0, 1.0, 2.0 * v - squared(p[0]), 0.0]);
        out.fp[1] = -2.0 * squared(1.0) * p[0] * v;
    }

    fn left(&self, y: &[f64], _: &[f64], out: &mut BoundaryJacobian<'_>) {
        (out.r[0], out.ry[0]) = (y[0], 1.0);
    }

    fn right(&self, y: &[f64], _: &[f64], out: &mut BoundaryJacobian<'_>) {
        (out.r[0], out.ry[0]) = (y[0], 1.0);
    }
}

impl Directional for AutoBvp {
    fn second(&self, point: PointValues, [a, b]: [PointDirection; 2], [f, _]: [&mut [f64]; 2]) {
        let v = point.y[0] - (self.profile)(point.at.x)[0];
        let mixed = a.p[0] * b.y[0] + b.p[0] * a.y[0];
        f[1] = 2.0 * a.y[0] * b.y[0] - 2.0 * squared(1.0) * (point.p[0] * mixed + v * a.p[0] * b.p[0]);
    }

    fn third(&self, point: PointValues, a: PointDirection, [second, [third, _]]: [[&mut [f64]; 2]; 2]) -> bool {
        self.second(point, [a, a], second);
        third[1] = -6.0 * squared(1.0) * a.p[0] * a.p[0] * a.y[0];
        true
    }
}
