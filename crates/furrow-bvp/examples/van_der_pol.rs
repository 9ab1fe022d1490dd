//! Van der Pol's equation u″ − μ(1 − u²)u′ + u = 0: its limit cycle from the circle of radius 2 at small μ to a relaxation
//! oscillation, with the known period at three μ.

use std::f64::consts::TAU;

use furrow_bvp::{Continuation, ContinuationSettings, Gauss, Metric, Number, PeriodicOrbit, VectorField, mesh};

#[derive(Clone)]
struct VanDerPol;

impl VectorField for VanDerPol {
    fn components(&self) -> usize {
        2
    }

    fn parameters(&self) -> usize {
        1
    }

    fn velocity<D: Number>(&self, y: &[D], p: &[D], v: &mut [D]) {
        v[0] = y[1];
        v[1] = p[0] * (-y[0].powi(2) + 1.0) * y[1] - y[0];
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let circle = |x: f64, y: &mut [f64]| y.copy_from_slice(&[2.0 * (TAU * x).cos(), -2.0 * (TAU * x).sin()]);
    let (gauss, grid) = (Gauss::new(4)?, mesh::uniform(0.0, 1.0, 60));
    let (problem, guess) = PeriodicOrbit::near(VanDerPol, &gauss, &grid, TAU, &[0.1], circle)?;
    // c and T follow from the orbit and need no weight of their own.
    let metric = Metric { components: vec![1.0; 2], scalars: vec![0.0, 0.0, 0.0, 1.0] };
    let mut cycle = Continuation::start(problem, guess, metric, ContinuationSettings::default(), true)?;
    println!("μ  period        exact");
    for (mu, exact) in [(1.0, 6.6632868593), (2.0, 7.6298744797), (5.0, 11.6122306677)] {
        cycle.follow([0.0, mu], 300, |_, _| true)?;
        println!("{mu}  {:.10}  {exact:.10}", PeriodicOrbit::<VanDerPol>::period(&cycle.state.solution));
    }
    Ok(())
}
