//! Bratu's problem u″ + λeᵘ = 0, u(0) = u(1) = 0: the branch of its solutions, and the fold beyond which there are none.

use furrow_bvp::{Continuation, ContinuationSettings, Fold, Metric, MinimallyAugmented};

#[path = "problems/oscillator.rs"]
mod oscillator;

use oscillator::{Force, Oscillator};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let problem = Oscillator { force: Force::Of(|u| [u.exp(); 4]), right: 0 };
    let metric = Metric::unit(2, 1);
    let guess = problem.zero(1.0, 24, 4, 0.0);
    let settings = ContinuationSettings { max_step: 0.8, ..Default::default() };
    let mut branch = Continuation::start(problem.clone(), guess, metric.clone(), settings, true)?;
    let mut middle = [0.0; 2];
    let mut folds = Vec::new();
    println!("  λ           u(½)      λ of a solution with this u(½)");
    branch.follow([0.0, 10.0], 60, |branch, advance| {
        let y = &branch.state.solution;
        y.eval(&branch.system.gauss, 0.5, &mut middle);
        // u(½) = 2 ln cosh θ belongs to λ = 8(θ/cosh θ)².
        let cosh = (0.5 * middle[0]).exp();
        println!("  {:.8}  {:.6}  {:.8}", y.scalars[0], middle[0], 8.0 * (cosh.acosh() / cosh).powi(2));
        if advance.passed_fold {
            folds.push((y.clone(), branch.state.tangent.clone()));
        }
        middle[0] < 5.0
    })?;
    for (mut y, tangent) in folds {
        let mut fold = MinimallyAugmented::new(problem.clone(), Fold::new(0), y.m, metric.clone(), &tangent)?;
        let report = fold.solve(&mut y, None)?;
        println!("fold at λ = {:.9} (exact 3.513830719), {} iterations", y.scalars[0], report.iterations);
    }
    Ok(())
}
