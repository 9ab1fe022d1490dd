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
    outcome.map_or("-", Outcome::name)
}

/// The cue of a founder, with the numbers of its own descendants that carry one: `stiff +6`, or `stiff, pulled +12` where
/// theirs is another.
pub(super) fn cue_text(row: &FounderRow) -> String {
    let mut out = row.cue.clone();
    for (name, count) in &row.cued_descendants {
        let _ = if *name == row.cue { write!(out, " +{count}") } else { write!(out, ", {name} +{count}") };
    }
    out
}

/// Rounds per founder beside the observed ones, the growth by generation, and why branches end.
pub fn founders_table(tree: &Tree, rows: &[FounderRow]) -> String {
    let cell = &tree.settings.cell;
    let mut out = format!(
        "{}: {} cells, grown from R0 = {} at ε = {}, ξ_s = {}\n\n",
        tree.lineage.name,
        tree.len(),
        tree.cell(tree.first()).r0,
        cell.epsilon,
        cell.xi_s
    );
    rounds(&mut out, rows);
    cues(&mut out, tree, rows);
    let summary = TreeSummary::of(tree);
    generations(&mut out, &summary);
    let _ = writeln!(out, "\nBranches end: {}.", summary.ended_text());
    if summary.slow > 0 {
        let cells = if summary.slow == 1 { "cell is" } else { "cells are" };
        let _ = writeln!(
            out,
            "{} {cells} just above the threshold of division: slow, and followed by the growth rate there.",
            summary.slow
        );
    }
    if summary.limited() {
        let _ = writeln!(
            out,
            "Some were stopped by a limit of the lineage file, not by mechanics; raise it for the whole tree."
        );
    }
    out
}

fn rounds(out: &mut String, rows: &[FounderRow]) {
    let name_width = rows.iter().map(|r| r.name.chars().count()).max().unwrap_or(0).max(7);
    let cues: Vec<String> = rows.iter().map(cue_text).collect();
    let cue_width = cues.iter().map(|cue| cue.chars().count()).max().unwrap_or(0).max(4);
    let blank = name_width + cue_width + 30;
    let _ = writeln!(out, "{:blank$}| rounds, model                | rounds, observed", "");
    let _ = writeln!(
        out,
        "{:name_width$}      R0  {:cue_width$}  division         χ | min   mean max full sym cells | min   mean max full cells",
        "founder", "cue"
    );
    let _ = writeln!(out, "{}+-----------------------------+-------------------------", "-".repeat(blank));
    for (row, cue) in rows.iter().zip(&cues) {
        let _ = write!(
            out,
            "{:name_width$}  {:>6}  {cue:cue_width$}  {:10}  {:>6} |",
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
    out.push('\n');
}

/// What the cues are that the table names.
fn cues(out: &mut String, tree: &Tree, rows: &[FounderRow]) {
    let used = |name: &String| rows.iter().any(|row| row.cue == *name || row.cued_descendants.contains_key(name));
    let mut any = false;
    for (name, cue) in tree.lineage.cues.iter().filter(|(name, _)| used(name)) {
        let _ = writeln!(out, "cue {name}: {cue}");
        any = true;
    }
    if any {
        out.push('\n');
    }
}

fn generations(out: &mut String, summary: &TreeSummary) {
    let counts = |count: fn(&super::Generation) -> usize| {
        summary.generations.iter().map(|g| format!("{:>4}", count(g))).collect::<String>()
    };
    let numbers: String = (0..summary.generations.len()).map(|g| format!("{g:>4}")).collect();
    let _ = writeln!(out, "generation  {numbers}");
    let _ = writeln!(out, "cells       {}", counts(|g| g.cells));
    let _ = writeln!(out, "symmetric   {}", counts(|g| g.symmetric));
    let _ = writeln!(out, "asymmetric  {}", counts(|g| g.asymmetric));
    let _ = writeln!(out, "ended       {}", counts(|g| g.ended));
}
