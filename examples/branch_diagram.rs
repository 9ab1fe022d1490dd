//! Prints the branch diagram of one cell: symmetric and asymmetric stationary shapes over ξ_s, their stability, folds and
//! pitchforks.
//!
//! `cargo run --release --example branch_diagram -- 2.22 0.64`

use furrow::{Cell, Numerics};
use furrow_mechanics::equilibria::{Branch, BranchOptions, asymmetric, primary};

fn print(name: &str, branch: &Branch) {
    for point in &branch.points {
        let stable = point.growth_rate.map_or("?", |rate| if rate < 0.0 { "stable" } else { "unstable" });
        println!(
            "{name:10} {:9.5} {:9.6} {:9.5} {stable}",
            point.xi_s,
            point.elongation,
            point.delta_u.unwrap_or(f64::NAN)
        );
    }
    for event in &branch.events {
        println!("# {} of the {name} branch at ξ_s = {:.6}", event.kind(), event.point().xi_s);
    }
    println!("# the {name} branch ends: {}", branch.ended);
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1).map(|text| text.parse::<f64>());
    let r0 = arguments.next().transpose()?.unwrap_or(2.0);
    let epsilon = arguments.next().transpose()?.unwrap_or(0.87);
    let cell = Cell { epsilon, ..Cell::new(r0) };
    let options = BranchOptions { growth_rates: true, ..BranchOptions::default() }.with_max_step(1.0);
    println!("# branch         ξ_s         H        Δu");
    let symmetric = primary::follow(&cell, &Numerics::default(), &options, |_| true)?;
    print("symmetric", &symmetric);
    if let Some(pitchfork) = symmetric.pitchforks().next() {
        print("asymmetric", &asymmetric::follow(pitchfork, &cell, &options).branch);
    }
    Ok(())
}
