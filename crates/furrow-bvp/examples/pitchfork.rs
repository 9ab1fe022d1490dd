//! The elastica u″ + λ sin u = 0, u(0) = u(1) = 0, a rod under the load λ: where the straight rod buckles to an
//! antisymmetric shape, and how. Solved on the half [0, ½] with a mirror at ½.

use std::f64::consts::PI;

use furrow_bvp::normal_form::pitchfork_normal_form;
use furrow_bvp::{Continuation, ContinuationSettings, Metric, MinimallyAugmented, SymmetryBreaking, locate};

#[path = "problems/oscillator.rs"]
mod oscillator;

use oscillator::Oscillator;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let problem = Oscillator::elastica(1);
    let guess = problem.zero(0.5, 12, 4, 20.0);
    let settings = ContinuationSettings { max_step: 3.0, ..Default::default() };
    let mut branch = Continuation::start(problem.clone(), guess, Metric::unit(2, 1), settings, true)?;
    // Follow the straight rod until the determinant of antisymmetric perturbations changes its sign.
    let mut breaking = SymmetryBreaking::default();
    let mut signs = [0.0; 2];
    let mut failure = None;
    branch.follow([0.0, 100.0], 100, |branch, _| match breaking.test(&branch.system, &branch.problem) {
        Ok((sign, _)) => {
            signs = [signs[1], sign];
            signs[0] * signs[1] >= 0.0
        }
        Err(error) => {
            failure = Some(error);
            false
        }
    })?;
    failure.map_or(Ok(()), Err)?;
    let found = locate::between_last_points(&mut branch, breaking, signs)?;
    let (mut point, y): (MinimallyAugmented<_, _>, _) = (found.augmented, found.solution);
    println!("pitchfork at λ = {:.10}, exact (2π)² = {:.10}", y.scalars[0], 4.0 * PI * PI);
    // Along the buckled branch λ = λ* + c a². With u = a sin 2πx the exact c is λ*/8; φ has φ′(½) = 1 instead of −2π.
    let form = pitchfork_normal_form(&mut point, &y)?;
    let coefficient = form.parameters[0] * (2.0 * PI).powi(2);
    println!("normal form  c = {coefficient:.10}, exact λ*/8 = {:.10}", PI * PI / 2.0);
    Ok(())
}
