//! Prints the threshold ξ_s*(R0) at which the symmetric furrow loses stability, its criticality, and the critical radius at
//! the preset's activity.
//!
//! `cargo run --release --example thresholds`

use furrow::{Cell, Numerics};
use furrow_mechanics::critical::critical_radius;
use furrow_mechanics::equilibria::{BranchOptions, pitchfork};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (numerics, options) = (Numerics::default(), BranchOptions::default());
    for r0 in [1.64, 2.0, 3.0, 5.4] {
        let found = pitchfork::first(&Cell::new(r0), &numerics, &options)?;
        println!("R0 = {r0}: ξ_s* = {:.6}, {}", found.point.xi_s, found.criticality());
    }
    let critical = critical_radius(&Cell::new(1.0), &numerics)?;
    println!("ξ_s* = 25 at R0 = {:.7}", critical.r0);
    Ok(())
}
