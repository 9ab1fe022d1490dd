//! Laws of active stress as text.

use std::time::Instant;

use furrow_cell::law::Law;
use furrow_cell::{Cell, Numerics};
use furrow_mechanics::division::{DivisionInput, divide};
use furrow_mechanics::equilibria::BranchOptions;
use furrow_mechanics::equilibria::pitchfork::first as pitchfork;

const PAPER: &str = include_str!("../../../laws/paper.ron");

fn paper() -> Law {
    Law::parse(PAPER, "paper.ron").unwrap()
}

#[test]
fn the_papers_law_as_text_divides_as_the_built_in_one() {
    let cue = "kappa:u0=0.465,omega=0.0577,amplitude=0.1";
    for cell in [Cell::new(2.5), Cell::new(2.0), Cell::new(5.4).with_cue(cue.parse().unwrap())] {
        let started = Instant::now();
        let built_in = divide(&DivisionInput::new(cell.clone())).unwrap();
        let quick = started.elapsed();
        let started = Instant::now();
        let own = divide(&DivisionInput::new(cell.with_law(paper()))).unwrap();
        let slow = started.elapsed();
        println!("{:?}\n{:?}\n{quick:?} {slow:?}", built_in, own);
    }
    for r0 in [1.64, 2.0] {
        let built_in = pitchfork(&Cell::new(r0), &Numerics::default(), &BranchOptions::default()).unwrap();
        let own = pitchfork(&Cell::new(r0).with_law(paper()), &Numerics::default(), &BranchOptions::default()).unwrap();
        println!("{} {} {} {}", built_in.point.xi_s, own.point.xi_s, built_in.coefficient, own.coefficient);
    }
}
