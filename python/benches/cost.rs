//! Cost of divisions in Rust, of the same cells that `cost.py` divides from Python. Prints the seconds of each round.

use std::time::Instant;

use furrow_cell::{Cell, Cue};
use furrow_lineage::batch::{Memo, Quantisation, SchedulerOptions, replicates};
use furrow_mechanics::division::DivisionInput;

/// Cells of a round, and rounds.
const CELLS: usize = 40;
const ROUNDS: usize = 5;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for _ in 0..ROUNDS {
        let memo = Memo::new(Quantisation::DEFAULT);
        let start = Instant::now();
        for k in 0..CELLS {
            let cell = Cell::new(2.5 + 0.05 * k as f64).with_cue(Cue::published());
            let options = SchedulerOptions { threads: 1, ..SchedulerOptions::default() };
            let found = replicates(&DivisionInput::new(cell), 1, &memo, &options)?;
            assert_eq!(found.divisions.len(), 1);
        }
        println!("{}", start.elapsed().as_secs_f64());
    }
    Ok(())
}
