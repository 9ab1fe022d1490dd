// u″ = w(x, u, u′) with u given at both ends. Shared by examples and tests.

use furrow_bvp::{
    BoundaryJacobian, BoundaryValueProblem, CollocationPoint, Dimensions, Gauss, PointJacobian, Solution,
};

/// u″ = w(x, u, u′) with y = (u, u′) and u given at both ends.
pub struct SecondOrder {
    /// w and its derivatives by u and by u′, at x and (u, u′).
    pub force: Box<dyn Fn(f64, [f64; 2]) -> [f64; 3]>,
    /// u at the left and at the right end.
    pub ends: [f64; 2],
}

impl SecondOrder {
    /// The straight line between the ends of the mesh, as a guess.
    pub fn line(&self, stages: usize, mesh: &[f64]) -> Solution {
        let (first, length) = (mesh[0], mesh[mesh.len() - 1] - mesh[0]);
        let slope = (self.ends[1] - self.ends[0]) / length;
        let line = |x: f64, y: &mut [f64]| y.copy_from_slice(&[self.ends[0] + slope * (x - first), slope]);
        Solution::from_fn(&Gauss::new(stages).expect("stages from 1 to 5"), mesh, 2, &[], line).expect("a mesh")
    }
}

impl BoundaryValueProblem for SecondOrder {
    fn dimensions(&self) -> Dimensions {
        Dimensions { components: 2, quadratures: 1, left: 1, right: 1, ..Dimensions::default() }
    }

    fn rhs(&self, at: CollocationPoint, y: &[f64], _: &[f64], f: &mut [f64], _: &mut [f64]) {
        f.copy_from_slice(&[y[1], (self.force)(at.x, [y[0], y[1]])[0]]);
    }

    fn rhs_jacobian(&self, at: CollocationPoint, y: &[f64], _: &[f64], out: &mut PointJacobian<'_>) {
        let [w, by_u, by_slope] = (self.force)(at.x, [y[0], y[1]]);
        out.f.copy_from_slice(&[y[1], w]);
        out.fy.copy_from_slice(&[0.0, 1.0, by_u, by_slope]);
    }

    fn left(&self, y: &[f64], _: &[f64], out: &mut BoundaryJacobian<'_>) {
        (out.r[0], out.ry[0]) = (y[0] - self.ends[0], 1.0);
    }

    fn right(&self, y: &[f64], _: &[f64], out: &mut BoundaryJacobian<'_>) {
        (out.r[0], out.ry[0]) = (y[0] - self.ends[1], 1.0);
    }
}
