//! ε y″ + y′ = 0, y(0) = 0, y(1) = 1: a layer of width ε at 0, found by the driver from ten equal intervals.

use bvp::{
    BoundaryJacobian, BoundaryValueProblem, CollocationPoint, Dimensions, Gauss, PointJacobian, Settings, Solution,
    SolveError, mesh, solve,
};

struct Layer {
    epsilon: f64,
}

impl BoundaryValueProblem for Layer {
    fn dimensions(&self) -> Dimensions {
        Dimensions { components: 2, integrable: 1, scalars: 0, left: 1, right: 1, integrals: 0 }
    }

    fn rhs(&self, _: CollocationPoint, y: &[f64], _: &[f64], f: &mut [f64], _: &mut [f64]) {
        f.copy_from_slice(&[y[1], -y[1] / self.epsilon]);
    }

    fn rhs_jacobian(&self, at: CollocationPoint, y: &[f64], p: &[f64], out: &mut PointJacobian<'_>) {
        self.rhs(at, y, p, out.f, out.g);
        out.fy.copy_from_slice(&[0.0, 1.0, 0.0, -1.0 / self.epsilon]);
    }

    fn left(&self, y: &[f64], _: &[f64], out: &mut BoundaryJacobian<'_>) {
        (out.r[0], out.ry[0]) = (y[0], 1.0);
    }

    fn right(&self, y: &[f64], _: &[f64], out: &mut BoundaryJacobian<'_>) {
        (out.r[0], out.ry[0]) = (y[0] - 1.0, 1.0);
    }
}

fn main() -> Result<(), SolveError> {
    let gauss = Gauss::new(4);
    let guess = Solution::from_fn(&gauss, &mesh::uniform(0.0, 1.0, 10), 2, &[], |x, y| y.copy_from_slice(&[x, 1.0]));
    let settings = Settings { tolerance: 1e-8, ..Settings::default() };
    println!("ε       meshes  intervals  y(ε)          exact");
    for epsilon in [1e-1, 1e-2, 1e-3, 1e-4f64] {
        let solved = solve(&mut Layer { epsilon }, &guess, &settings)?;
        let mut y = [0.0; 2];
        solved.solution.eval(&gauss, epsilon, &mut y);
        let exact = (1.0 - (-1.0f64).exp()) / (1.0 - (-1.0 / epsilon).exp());
        let (meshes, intervals) = (solved.work.steps, solved.solution.intervals());
        println!("{epsilon:.0e}  {meshes:6}  {intervals:9}  {:.10}  {exact:.10}", y[0]);
    }
    Ok(())
}
