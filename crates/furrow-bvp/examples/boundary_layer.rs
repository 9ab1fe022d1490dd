//! ε y″ + y′ = 0, y(0) = 0, y(1) = 1: a layer of width ε at 0, found by the driver from ten equal intervals.

use furrow_bvp::{Gauss, Settings, SolveError, mesh, solve};

#[path = "problems/second_order.rs"]
mod second_order;

use second_order::SecondOrder;

fn main() -> Result<(), SolveError> {
    let gauss = Gauss::new(4)?;
    let settings = Settings { tolerance: 1e-8, ..Settings::default() };
    println!("ε       meshes  intervals  y(ε)          exact");
    for epsilon in [1e-2, 1e-4, 1e-6, 1e-8f64] {
        let force = move |_: f64, [_, slope]: [f64; 2]| [-slope / epsilon, 0.0, -1.0 / epsilon];
        let mut layer = SecondOrder { force: Box::new(force), ends: [0.0, 1.0] };
        let guess = layer.line(gauss.m, &mesh::uniform(0.0, 1.0, 10));
        let solved = solve(&mut layer, &guess, &settings)?;
        let mut y = [0.0; 2];
        solved.eval(&gauss, epsilon, &mut y);
        let exact = (1.0 - (-1.0f64).exp()) / (1.0 - (-1.0 / epsilon).exp());
        let (meshes, intervals) = (solved.work.steps, solved.solution.intervals());
        println!("{epsilon:.0e}  {meshes:6}  {intervals:9}  {:.10}  {exact:.10}", y[0]);
    }
    Ok(())
}
