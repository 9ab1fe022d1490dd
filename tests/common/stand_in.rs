//! A fake division solver, to test growth without mechanics.

use furrow_cell::Cell;
use furrow_formats::tree_to_json;
use furrow_lineage::batch::{Memo, Quantisation, SchedulerOptions, Summary};
use furrow_lineage::{EndRule, Grower, Lineage, TerminalReason, Tree, TreeSettings};
use furrow_mechanics::division::{Division, DivisionError, DivisionInput, Ending, Outcome};

/// Symmetric above R0 = 2.25, asymmetric with χ = 0.88 down to 1.7, failed below; with a cue χ = 0.2 above 1.7.
pub fn fake(input: &DivisionInput) -> Result<Division, DivisionError> {
    let cued = !input.cell.cue.is_none();
    Ok(match input.cell.r0 {
        r0 if r0 < 1.7 => division(r0, Outcome::Arrested, 0.0),
        r0 if cued => division(r0, Outcome::Asymmetric, 0.2),
        r0 if r0 < 2.25 => division(r0, Outcome::Asymmetric, -0.88),
        r0 => division(r0, Outcome::Symmetric, 0.0),
    })
}

/// A division with the given signed χ.
pub fn division(r0: f64, outcome: Outcome, chi_signed: f64) -> Division {
    let ending = match outcome {
        Outcome::Arrested => Ending::Arrested { growth_rate: Some(-0.25) },
        _ => Ending::Divided {
            symmetric: outcome == Outcome::Symmetric,
            chi_signed,
            u_furrow: 0.5 - 0.2 * chi_signed,
            daughters: [1.0 - chi_signed, 1.0 + chi_signed].map(|share| r0 * f64::cbrt(0.5 * share)),
        },
    };
    Division {
        ending,
        t_end: 1.0 + 1.0 / r0,
        slow_growth_rate: None,
        phi: None,
        neck_offset: None,
        second_neck: None,
        volume_drift: 0.0,
        work: furrow_bvp::Work { steps: 1, iterations: 1, factorisations: 1, ..furrow_bvp::Work::default() },
    }
}

/// A tree grown with a memo of its own.
pub fn grow(
    lineage: &Lineage,
    settings: &TreeSettings,
    threads: usize,
    ends: &dyn Fn(&Cell) -> Option<TerminalReason>,
    solve: impl Fn(&DivisionInput) -> Result<Division, DivisionError> + Sync,
) -> (Tree, Summary) {
    let memo = Memo::new(Quantisation::DEFAULT);
    let options = SchedulerOptions { threads, ..SchedulerOptions::default() };
    Grower { lineage, settings: settings.clone(), ends: EndRule::Custom(ends), memo: &memo, options }
        .grow(solve)
        .unwrap()
}

/// A tree of the default settings grown on one thread, by a simulated solver.
pub fn grown(
    lineage: &Lineage,
    ends: &dyn Fn(&Cell) -> Option<TerminalReason>,
    solve: impl Fn(&DivisionInput) -> Result<Division, DivisionError> + Sync,
) -> Tree {
    grow(lineage, &TreeSettings::default(), 1, ends, solve).0
}

/// `tree.json` of the founders of C. elegans and a few generations below them.
pub fn small_tree_file() -> String {
    let mut lineage = Lineage::c_elegans().unwrap();
    lineage.limits.max_depth = 4;
    tree_to_json(&grown(&lineage, &|_| None, fake)).unwrap()
}
