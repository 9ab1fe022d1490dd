//! The smallest eigenvalues of −u″ = λu, u(0) = u(1) = 0: the largest of the inverse, which a boundary-value problem
//! applies to a vector with the factors of one Newton step, by Arnoldi iteration.

use std::f64::consts::PI;

use furrow_bvp::{
    Auto, BoundaryValueProblem, Dimensions, Direction, Equations, LinearCondition, Number, Solution, System, mesh,
    metric,
};
use furrow_spectra::{Arnoldi, Krylov};

/// u″ + λu = 0, u(0) = u(1) = 0 as y = (u, u′), p = λ.
#[derive(Clone)]
struct Oscillation;

impl Equations for Oscillation {
    fn dimensions(&self) -> Dimensions {
        Dimensions { components: 2, scalars: 1, left: 1, right: 1, ..Dimensions::default() }
    }

    fn rhs<D: Number>(&self, _x: f64, y: &[D], p: &[D], f: &mut [D]) {
        (f[0], f[1]) = (y[1], -p[0] * y[0]);
    }

    fn left<D: Number>(&self, y: &[D], _p: &[D], r: &mut [D]) {
        r[0] = y[0];
    }

    fn right<D: Number>(&self, y: &[D], _p: &[D], r: &mut [D]) {
        r[0] = y[0];
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // About λ = 0, held there by a linear condition.
    let mut problem = Auto(Oscillation);
    let y = Solution::constant(4, &mesh::uniform(0.0, 1.0, 20), &[0.0, 0.0], &[0.0]);
    let mut fixed = vec![LinearCondition::default()];
    metric::scalar_condition(&y, 0, 0.0, &mut fixed[0]);
    let mut system = System::new(problem.dimensions(), y.m);
    system.factorise(&mut problem, &y, &fixed)?;
    // A vector holds v at the collocation points; −u″ = v adds h v to the residual of the second component.
    let points = y.intervals() * y.m;
    let width = |k: usize| y.mesh[k / y.m + 1] - y.mesh[k / y.m];
    let weights: Vec<f64> = (0..points).map(|k| width(k) * system.gauss.b[k % y.m]).collect();
    let (mut right, mut u) = (system.zero_residual(), Direction::default());
    let inverse = |from: &[f64], to: &mut [f64]| {
        for (k, v) in from.iter().enumerate() {
            right.stages[2 * k + 1] = width(k) * v;
        }
        system.solve(&right, &mut u)?;
        for (k, v) in to.iter_mut().enumerate() {
            *v = u.stages[2 * k];
        }
        Ok::<(), Box<dyn std::error::Error>>(())
    };
    let settings = Arnoldi { wanted: 4, tolerance: 1e-12, ..Arnoldi::default() };
    let found = settings.largest(&mut Krylov::default(), &weights, inverse)?;
    for (k, value) in found.iter().enumerate() {
        println!("λ = {:.9}, exact {:.9}", 1.0 / value.re, ((k + 1) as f64 * PI).powi(2));
    }
    Ok(())
}
