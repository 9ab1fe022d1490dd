//! The demo `bvp` of AUTO, u″ + (λπ)²u − u² = 0, u(0) = u(1) = 0: other branches cross u = 0 at λ = 1, 2, 3 … Finds these branch
//! points, tells how the branches cross, and switches to them.

use furrow_bvp::{Continuation, ContinuationSettings, Metric, locate};

#[path = "problems/auto_bvp.rs"]
mod auto_bvp;

use auto_bvp::AutoBvp;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (problem, metric) = (AutoBvp::PERFECT, Metric::unit(2, 1));
    let settings = ContinuationSettings { max_step: 0.5, ..ContinuationSettings::default() };
    let mut branch =
        Continuation::start(problem.clone(), problem.guess(40, 0.5), metric.clone(), settings.clone(), true)?;
    let mut points = Vec::new();
    branch.follow([0.0, 5.5], 100, |branch, advance| {
        if advance.passed_branch_point {
            points.push(locate::branch_point(branch));
        }
        true
    })?;
    for (exact, point) in (1..).zip(points) {
        let point = point?;
        println!("λ = {:.10}, exact {exact}: {:?}", point.parameter(), point.kind());
        for forwards in [true, false] {
            let state = point.switch(&mut branch, forwards)?;
            let mut crossing = Continuation::resume(problem.clone(), state, metric.clone(), settings.clone());
            crossing.follow([0.0, 5.5], 10, |_, _| true)?;
            let y = &crossing.state.solution;
            println!("  ten steps along the other branch: λ = {:.6}, u'(0) = {:.6}", y.scalars[0], y.nodes[1]);
        }
    }
    println!("{} steps, {} factorisations", branch.work.steps, branch.work.factorisations);
    Ok(())
}
