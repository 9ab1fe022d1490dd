//! Temporary.
use furrow_cell::{Cell, Numerics, Parameter};
use furrow_mechanics::equilibria::StepBudget;
use furrow_surface::bent_curves::{critical_radius, curves};
fn main() {
    let args: Vec<f64> = std::env::args().skip(1).filter_map(|a| a.parse().ok()).collect();
    let m = args.first().copied().unwrap_or(4.0) as usize;
    let eps = args.get(1).copied().unwrap_or(0.87);
    let numerics = Numerics { modes: m, ..Numerics::default() };
    let t = std::time::Instant::now();
    let cell = Cell { epsilon: eps, ..Cell::new(1.0) };
    println!("{:?} {:?}", critical_radius(&cell, &numerics, &StepBudget::unlimited()), t.elapsed());
    if args.len() > 2 {
        let t = std::time::Instant::now();
        for (event, curve) in curves(&cell, &numerics, Parameter::R0, [args[2], args[3]]).unwrap() {
            println!("{event:?} {:?}", curve.ended);
            for p in curve.points {
                println!("{:.6} {:.6} {:.4}", p.value, p.xi_s, p.slope);
            }
        }
        println!("{:?}", t.elapsed());
    }
}
