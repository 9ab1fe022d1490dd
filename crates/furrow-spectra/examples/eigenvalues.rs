//! The smallest eigenvalues of −u″ = λu, u(0) = u(1) = 0: the largest of the inverse, which a boundary-value problem
//! applies to a vector with the factors of one Newton step, by Arnoldi iteration.

use std::f64::consts::PI;

use furrow_bvp::{Direction, LinearCondition, System, metric};
use furrow_spectra::{Arnoldi, Krylov};

#[path = "../../furrow-bvp/examples/problems/oscillator.rs"]
mod oscillator;

use oscillator::{Force, Oscillator};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // u″ + λu = 0 about λ = 0, held there by a linear condition.
    let mut problem = Oscillator { force: Force::Of(|u| [u, 1.0, 0.0, 0.0]), right: 0 };
    let y = problem.zero(1.0, 20, 4, 0.0);
    let mut fixed = vec![LinearCondition::default()];
    metric::scalar_condition(&y, 0, 0.0, &mut fixed[0]);
    let mut system = System::new(furrow_bvp::BoundaryValueProblem::dimensions(&problem), y.m);
    system.evaluate(&mut problem, &y, &fixed, true);
    system.condense()?;
    system.factor_blocks(&fixed)?;
    // A vector holds v at the collocation points; −u″ = v adds h v to the residual of the second component.
    let points = y.intervals() * y.m;
    let width = |k: usize| y.mesh[k / y.m + 1] - y.mesh[k / y.m];
    let weights: Vec<f64> = (0..points).map(|k| width(k) * system.gauss.b[k % y.m]).collect();
    let (mut right, mut u) = (system.zero_residual(), Direction::default());
    let inverse = |from: &[f64], to: &mut [f64]| {
        for (k, v) in from.iter().enumerate() {
            right.stages[2 * k + 1] = width(k) * v;
        }
        system.solve(&right, &mut u);
        for (k, v) in to.iter_mut().enumerate() {
            *v = u.stages[2 * k];
        }
    };
    let settings = Arnoldi { wanted: 4, tolerance: 1e-12, ..Arnoldi::default() };
    let found = settings.largest(&mut Krylov::default(), &weights, inverse)?;
    for (k, value) in found.iter().enumerate() {
        println!("λ = {:.9}, exact {:.9}", 1.0 / value.re, ((k + 1) as f64 * PI).powi(2));
    }
    Ok(())
}
