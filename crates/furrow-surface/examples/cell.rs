//! Divides one cell without axial symmetry and prints its outcome; arguments are KEY=VALUE, as in `r0=2 cue=germline m=4 n=44`, and `v`
//! prints the neck after every step.
use furrow_cell::{Cell, Numerics};
use furrow_mechanics::division::DivisionInput;
use furrow_surface::division::divide;
use std::time::Instant;

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let get = |name: &str, default: f64| {
        args.iter().find_map(|a| a.strip_prefix(&format!("{name}="))).map_or(default, |v| v.parse().unwrap())
    };
    let cue = args.iter().find_map(|a| a.strip_prefix("cue=")).unwrap_or("none");
    let mut cell = Cell { epsilon: get("eps", 0.87), xi_s: get("xi", 25.0), ..Cell::new(get("r0", 2.0)) };
    if cue == "germline" {
        cell = cell.with_cue(furrow_cell::Cue::published());
    } else if cue != "none" {
        cell = cell.with_cue(cue.parse().unwrap());
    }
    cell.shell.flattening = get("flat", 1.0);
    let d = Numerics::default();
    let numerics = Numerics {
        time_tolerance: d.time_tolerance * get("tol", 1.0),
        noise: get("noise", 0.01),
        first_step: get("first", 1e-3),
        t_max: get("tmax", 10000.0),
        modes: get("m", 4.0) as usize,
        elements: get("n", 44.0) as usize,
        contact: get("contact", 1.0) > 0.0,
        ..d
    };
    let input = DivisionInput { cell, numerics, seed: get("seed", 0.0) as u64 };
    let start = Instant::now();
    let verbose = args.iter().any(|a| a == "v");
    let found = divide(&input, &mut |problem, level| {
        if verbose {
            let n = furrow_surface::neck::neck(&problem.space, &level.state.surface);
            println!(
                "{:.5} M{} {:?}",
                level.t,
                problem.space.modes,
                n.map(|n| [
                    n.radius / input.cell.r0,
                    n.offset / input.cell.r0,
                    n.roundness,
                    n.tilt,
                    furrow_surface::neck::asymmetry(&problem.space, &level.state.surface, &n)
                ])
            );
        }
    });
    match found {
        Ok(f) => println!(
            "{} {:?} chi {:?} u {:?} t {:.5} neck {:?} offset {:?} M {} rate {:?} drift {:.1e} {:?} {:.1?}",
            args.join(" "),
            f.division.outcome(),
            f.division.chi_signed(),
            f.division.u_furrow(),
            f.division.t_end,
            f.necks.last().map(|n| n.neck.radius / input.cell.r0),
            f.division.neck_offset.map(|o| o / input.cell.r0),
            f.modes,
            f.division.growth_rate(),
            f.division.volume_drift,
            f.division.work,
            start.elapsed()
        ),
        Err(e) => println!("{} {e} {:.1?}", args.join(" "), start.elapsed()),
    }
}
