//! The founders' table as text.

use super::observed_table::{Column, MODEL, decimals, observed_columns};
use super::summary::TreeSummary;
use furrow_formats::FounderRow;
use furrow_lineage::Tree;
use furrow_mechanics::division::Outcome;
use std::fmt::Write;

/// A number rounded to six decimals.
pub(super) fn short(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
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
        "{}: {} cells, grown from R0 = {}{} at ε = {}, ξ_s = {}\n\n",
        tree.lineage.name,
        tree.len(),
        short(tree.cell(tree.first()).r0),
        tree.lineage.units().in_micrometres(tree.cell(tree.first()).r0),
        cell.epsilon,
        cell.xi_s
    );
    rounds(&mut out, rows);
    cues(&mut out, tree, rows);
    physics(&mut out, tree);
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

/// The columns of a table, each after a blank.
fn texts<T>(columns: &[Column<T>], text: impl Fn(&Column<T>) -> String) -> String {
    columns.iter().map(|column| format!(" {:>1$}", text(column), column.1)).collect()
}

/// Rounds of the founders: the model's and, if there are any, the observed ones.
fn rounds(out: &mut String, rows: &[FounderRow]) {
    let name_width = rows.iter().map(|r| r.name.chars().count()).max().unwrap_or(0).max(7);
    let cues: Vec<String> = rows.iter().map(cue_text).collect();
    let cue_width = cues.iter().map(|cue| cue.chars().count()).max().unwrap_or(0).max(4);
    let in_um = rows.iter().any(|row| row.r0_um.is_some());
    let observed = observed_columns(rows);
    let blank = name_width + cue_width + 30 + if in_um { 8 } else { 0 };
    let um = |text: &str| if in_um { format!("  {text:>6}") } else { String::new() };
    let beside = |text: String| if observed.is_empty() { String::new() } else { format!(" |{text}") };
    let line = |out: &mut String, text: String| {
        let _ = writeln!(out, "{}", text.trim_end());
    };
    let head = if observed.is_empty() { "" } else { " | rounds, observed" };
    line(out, format!("{:blank$}| rounds, model               {head}", ""));
    line(
        out,
        format!(
            "{:name_width$}      R0{}  {:cue_width$}  division         χ |{}{}",
            "founder",
            um("µm"),
            "cue",
            texts(&MODEL, |column| column.0.to_owned()),
            beside(texts(&observed, |column| column.0.to_owned()))
        ),
    );
    let width: usize = observed.iter().map(|column| column.1 + 1).sum();
    let ruled = if observed.is_empty() { String::new() } else { format!("+{}", "-".repeat(width)) };
    line(out, format!("{}+-----------------------------{ruled}", "-".repeat(blank)));
    for (row, cue) in rows.iter().zip(&cues) {
        let model = match &row.rounds {
            Some(rounds) => texts(&MODEL, |column| column.2(rounds)),
            None => format!(" {:28}", "not born"),
        };
        line(
            out,
            format!(
                "{:name_width$}  {:>6}{}  {cue:cue_width$}  {:10}  {:>6} |{model}{}",
                row.name,
                decimals(row.r0, 3),
                um(&decimals(row.r0_um, 2)),
                outcome_name(row.outcome),
                decimals(row.chi, 3),
                beside(texts(&observed, |column| row.observed.as_ref().map_or(String::new(), column.2)))
            ),
        );
    }
    out.push('\n');
}

/// The cues that the table names.
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

/// Parameters that founders change.
fn physics(out: &mut String, tree: &Tree) {
    let mut any = false;
    for founder in tree.lineage.founders.iter().filter(|founder| !founder.physics.is_empty()) {
        let values: Vec<String> = founder.physics.values().map(|(name, value)| format!("{name} = {value}")).collect();
        let _ = writeln!(out, "{} and its descendants up to the next founder: {}", founder.name, values.join(", "));
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
