use furrow::cortex::{Cue, Numerics, Physics};
use furrow::division::{DivisionInput, divide_observed};
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let get = |k: &str, d: f64| args.iter().position(|a| a == k).map_or(d, |i| args[i + 1].parse().unwrap());
    let has = |k: &str| args.iter().any(|a| a == k);
    let physics = Physics { epsilon: get("-e", 0.87), ..Physics::GAO2026 };
    let numerics = Numerics { intervals: get("-n", 48.0) as usize, stages: get("-m", 4.0) as usize, time_tolerance: get("-tol", 1e-4), step_factor: get("-f", 1.0), ..Numerics::default() };
    let cue = if has("-cue") { Cue::Kappa { u0: get("-u0", 0.465), omega: get("-om", 0.0577), amplitude: get("-dk", 0.1) } } else { Cue::None };
    let input = DivisionInput { physics, numerics, r0: get("-r", 2.5), cue, seed: get("-s", 0.0) as u64 };
    let start = std::time::Instant::now();
    let verbose = has("-v");
    let mut last = 0.0;
    let d = divide_observed(&input, |f| {
        if verbose {
            eprintln!("t {:.5} dt {:.5} L {:.4} p {:.4} neck {:?}", f.t, f.t - last, f.shape.scalars[0], f.shape.scalars[1], f.neck.map(|n| (n.u, n.radius)));
            last = f.t;
        }
    });
    let first = start.elapsed();
    let reps = get("-reps", 1.0) as usize;
    let start = std::time::Instant::now();
    for _ in 1..reps { let _ = divide_observed(&input, |_| {}); }
    let per = if reps > 1 { start.elapsed() / (reps as u32 - 1) } else { first };
    match d { Ok(d) => println!("R0 {} {:?} chi {:?} u {:?} t_end {:.4} drift {:.1e} steps {} rej {} newton {} fact {} remesh {} time {:?}", input.r0, d.outcome, d.chi_signed, d.u_furrow, d.t_end, d.volume_drift, d.steps, d.rejected, d.newton_iterations, d.factorisations, d.remeshings, per), Err(e) => println!("R0 {} ERR {e} time {per:?}", input.r0) }
}
