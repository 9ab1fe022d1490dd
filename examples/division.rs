//! Computes one division: the C. elegans zygote with its published cue.
//!
//! `cargo run --release --example division`

use furrow::{Cell, Cue};
use furrow::{DivisionInput, divide};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let zygote = Cell::new(5.4).with_cue(Cue::published());
    let division = divide(&DivisionInput::new(zygote))?;
    println!("{}: χ = {:?}, furrow at u = {:?}", division.outcome(), division.chi(), division.u_furrow());
    println!("daughters R0 = {:?} L_h, after {:.3} τ", division.daughters(), division.t_end);
    Ok(())
}
