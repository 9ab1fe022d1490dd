//! The founders' table as text.

use super::summary::TreeSummary;
use crate::division::Outcome;
use crate::io::FounderRow;
use crate::lineage::Tree;
use std::fmt::Write;

/// A number with three decimals, or a dash.
pub(super) fn decimals(value: Option<f64>, digits: usize) -> String {
    value.map_or("-".to_owned(), |v| format!("{v:.digits$}"))
}

/// The name of an outcome.
pub fn outcome_name(outcome: Option<Outcome>) -> &'static str {
    match outcome {
        Some(Outcome::Symmetric) => "symmetric",
        Some(Outcome::Asymmetric) => "asymmetric",
        Some(Outcome::Failed) => "failed",
        None => "-",
    }
}

/// Rounds per founder beside the observed ones, the growth by generation, and why branches end.
pub fn founders_table(tree: &Tree, rows: &[FounderRow]) -> String {
    let physics = &tree.settings.physics;
    let mut out = String::new();
    let _ = writeln!(
        out,
        "{}: {} cells, grown from R0 = {} at ε = {}, ξ_s = {}",
        tree.lineage.name,
        tree.len(),
        tree.cell(tree.first()).r0,
        physics.epsilon,
        physics.xi_s
    );
    let name_width = rows.iter().map(|r| r.name.chars().count()).max().unwrap_or(0).max(7);
    let _ = writeln!(out);
    let _ = writeln!(
        out,
        "{:name_width$}                            | rounds, model                | rounds, observed",
        ""
    );
    let _ = writeln!(
        out,
        "{:name_width$}      R0  division         χ | min   mean max full sym cells | min   mean max full cells",
        "founder"
    );
    let _ = writeln!(out, "{}-+-----------------------------+-------------------------", "-".repeat(name_width + 28));
    for row in rows {
        let _ = write!(
            out,
            "{:name_width$}  {:>6}  {:10}  {:>6} |",
            row.name,
            decimals(row.r0, 3),
            outcome_name(row.outcome),
            decimals(row.chi, 3),
        );
        let _ = match row.rounds {
            Some(r) => write!(
                out,
                " {:>3} {:>6.2} {:>3} {:>4} {:>3} {:>5} |",
                r.min, r.mean, r.max, r.full_doublings, r.symmetric, r.terminal
            ),
            None => write!(out, " {:28} |", "not born"),
        };
        let _ = match row.sulston {
            Some(s) => {
                writeln!(out, " {:>3} {:>6.2} {:>3} {:>4} {:>5}", s.min, s.mean, s.max, s.full_doublings, s.terminal)
            }
            None => writeln!(out),
        };
    }
    let summary = TreeSummary::of(tree);
    let counts = |count: fn(&super::Generation) -> usize| {
        summary.generations.iter().map(|g| format!("{:>4}", count(g))).collect::<Vec<_>>().join("")
    };
    let _ = writeln!(out);
    let _ =
        writeln!(out, "generation  {}", (0..summary.generations.len()).map(|g| format!("{g:>4}")).collect::<String>());
    let _ = writeln!(out, "cells       {}", counts(|g| g.cells));
    let _ = writeln!(out, "symmetric   {}", counts(|g| g.symmetric));
    let _ = writeln!(out, "asymmetric  {}", counts(|g| g.asymmetric));
    let _ = writeln!(out, "ended       {}", counts(|g| g.ended));
    let _ = writeln!(out);
    let _ = writeln!(out, "Branches end: {}.", summary.ended_text());
    if summary.limited() {
        let _ = writeln!(
            out,
            "Some were stopped by a limit of the lineage file, not by mechanics; raise it for the whole tree."
        );
    }
    out
}
