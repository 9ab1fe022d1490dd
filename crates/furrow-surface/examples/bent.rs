//! The bent states of one cell; arguments are KEY=VALUE.
use furrow_cell::{Cell, Numerics};
use furrow_surface::bent::branch;
use std::time::Instant;

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let get = |name: &str, default: f64| {
        args.iter().find_map(|a| a.strip_prefix(&format!("{name}="))).map_or(default, |v| v.parse().unwrap())
    };
    let cell = Cell { epsilon: get("eps", 0.87), ..Cell::new(get("r0", 1.4)) };
    let numerics = Numerics { modes: get("m", 4.0) as usize, elements: get("n", 44.0) as usize, ..Numerics::default() };
    let start = Instant::now();
    match branch(&cell, &numerics, get("xi", 60.0)) {
        Ok(found) => {
            println!("{:?}", found.threshold);
            for p in &found.points {
                println!(
                    "{:.5} bend {:.4} slope {:.3} even {:.4} odd {:.4} neck {:?} {:?}",
                    p.xi_s, p.bend, p.slope, p.even, p.odd, p.neck, p.neck_offset
                );
            }
            println!("pitchfork {:?}\nfold {:?}", found.pitchfork, found.fold);
        }
        Err(error) => println!("{error}"),
    }
    println!("{:.1?}", start.elapsed());
}
