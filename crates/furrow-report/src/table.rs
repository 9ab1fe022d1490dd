//! The founders' table as text.

use super::observed_table::{Column, MODEL, decimals, observed_columns};
use super::summary::{Generation, TreeSummary};
use furrow_cell::{Cell, Parameter};
use furrow_formats::FounderRow;
use furrow_lineage::{CellId, Founder, TerminalReason, Tree, TreeCell};
use furrow_mechanics::division::Outcome;
use furrow_mechanics::equilibria::azimuthal_threshold::grows_one_sided;
use std::fmt::Write;

/// A number rounded to six decimals.
pub(super) fn short(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}

/// The name of an outcome.
pub(crate) fn outcome_name(outcome: Option<Outcome>) -> &'static str {
    outcome.map_or("-", Outcome::name)
}

/// The cue of a founder, with the number of its own descendants that carry each cue: `stiff +6`, or `stiff, pulled +12`
/// if theirs is another.
pub(super) fn cue_text(row: &FounderRow) -> String {
    let mut out = row.cue.clone();
    let (same, other): (Vec<_>, Vec<_>) = row.cued_descendants.iter().partition(|(name, _)| **name == row.cue);
    same.into_iter().for_each(|(_, count)| out += &format!(" +{count}"));
    other.into_iter().for_each(|(name, count)| out += &format!(", {name} +{count}"));
    out
}

/// Rounds per founder beside the observed ones, the growth by generation, and why branches end.
pub fn founders_table(tree: &Tree, rows: &[FounderRow]) -> String {
    let Cell { r0, epsilon, xi_s, .. } = tree.parameters(tree.first());
    let mut out = format!(
        "{}: {} cells, grown from R0 = {}{} at ε = {epsilon}, ξ_s = {xi_s}\n\n",
        tree.lineage.name,
        tree.len(),
        short(r0),
        tree.lineage.units().in_micrometres(r0),
    );
    out += &(rounds(rows) + &last_divisions(tree, rows) + &cues(tree, rows) + &physics(tree));
    let summary = TreeSummary::of(tree);
    let ended = summary.ended_text();
    out += &(generations(&summary) + &format!("\nBranches end: {ended}.\n"));
    if summary.slow > 0 {
        let cells = if summary.slow == 1 { "1 cell is".to_owned() } else { format!("{} cells are", summary.slow) };
        let how = "slow, and followed by the growth rate there";
        let _ = writeln!(out, "{cells} just above the threshold of division: {how}.");
    }
    let one_sided = one_sided(tree);
    if one_sided > 0 {
        let _ = writeln!(
            out,
            "{one_sided} of these cells rest only while they keep their axis: a bend to one side (m = 1) grows in them by linear theory; --three-dimensional computes how it ends."
        );
    }
    if summary.limited() {
        out += "Some were stopped by a limit of the lineage file, not by mechanics; raise it for the whole tree.\n";
    }
    out
}

/// Number of cells at rest at the ends of branches in which a perturbation with m = 1 grows.
fn one_sided(tree: &Tree) -> usize {
    if tree.settings.numerics.modes > 0 {
        return 0;
    }
    let rests = |cell: &TreeCell| {
        matches!(
            cell.fate.terminal_reason(),
            Some(TerminalReason::AtRest { .. } | TerminalReason::BelowPitchfork { .. })
        )
    };
    let rests = |id: &CellId| rests(tree.cell(*id));
    tree.cells().filter(rests).filter(|id| grows_one_sided(&tree.parameters(*id))).count()
}

/// The columns of a table, each after a blank.
fn texts<T>(columns: &[Column<T>], text: impl Fn(&Column<T>) -> String) -> String {
    columns.iter().map(|column| format!(" {:>1$}", text(column), column.1)).collect()
}

/// Rounds of the founders: the model's and, if known, the observed ones.
fn rounds(rows: &[FounderRow]) -> String {
    let cues: Vec<String> = rows.iter().map(cue_text).collect();
    let name_width = rows.iter().map(|r| r.name.chars().count()).max().unwrap_or(0).max(7);
    let cue_width = cues.iter().map(|cue| cue.chars().count()).max().unwrap_or(0).max(4);
    let in_um = rows.iter().any(|row| row.r0_um.is_some());
    let observed = observed_columns(rows);
    let blank = name_width + cue_width + 30 + if in_um { 8 } else { 0 };
    let um = |text: &str| if in_um { format!("  {text:>6}") } else { String::new() };
    let beside = |sign: &str, text: String| if observed.is_empty() { text } else { format!("{sign}{text}") };
    let line = |text: String| format!("{}\n", text.trim_end());
    let head = if observed.is_empty() { "" } else { " | rounds, observed" };
    let width: usize = observed.iter().map(|column| column.1 + 1).sum();
    let (own, others) = (texts(&MODEL, |column| column.0.to_owned()), texts(&observed, |column| column.0.to_owned()));
    let (um_head, others) = (um("µm"), beside(" |", others));
    let (dashes, rule) = ("-".repeat(blank), beside("+", "-".repeat(width)));
    let mut out = [
        line(format!("{:blank$}| rounds, model               {head}", "")),
        line(format!(
            "{:name_width$}      R0{um_head}  {:cue_width$}  division         χ |{own}{others}",
            "founder", "cue"
        )),
        line(format!("{dashes}+-----------------------------{rule}")),
    ]
    .concat();
    for (row, cue) in rows.iter().zip(&cues) {
        let not_born = || format!(" {:28}", "not born");
        let model = row.rounds.as_ref().map_or_else(not_born, |rounds| texts(&MODEL, |column| column.2(rounds)));
        let seen = texts(&observed, |column| row.observed.as_ref().map_or(String::new(), column.2));
        let (name, outcome, seen) = (&row.name, outcome_name(row.outcome), beside(" |", seen));
        let (r0, r0_um, chi) = (decimals(row.r0, 3), um(&decimals(row.r0_um, 2)), decimals(row.chi, 3));
        out += &line(format!(
            "{name:name_width$}  {r0:>6}{r0_um}  {cue:cue_width$}  {outcome:10}  {chi:>6} |{model}{seen}"
        ));
    }
    out + "\n"
}

/// The meaning of the mark after minutes.
const EXTRAPOLATED: &str = "  * extrapolated: the clock was fitted to cells of other sizes\n";

/// Founders per line of the last divisions.
const IN_A_LINE: usize = 8;

/// The last division among each founder's descendants, in minutes.
fn last_divisions(tree: &Tree, rows: &[FounderRow]) -> String {
    let Some(origin) = tree.time_origin() else { return String::new() };
    let mark = |row: &FounderRow| if row.last_division_extrapolated { "*" } else { "" };
    let last = |row: &FounderRow| Some(format!("{} {:.0}{}", row.name, row.last_division_min?, mark(row)));
    let last: Vec<String> = rows.iter().filter_map(last).collect();
    let lines = last.chunks(IN_A_LINE).map(|some| some.join(", ")).collect::<Vec<_>>().join(",\n  ");
    let is_marked = rows.iter().any(|row| row.last_division_extrapolated);
    let note = if is_marked { EXTRAPOLATED } else { "" };
    format!("last divisions of descendants, in minutes from the {origin}:\n  {lines}\n{note}\n")
}

/// The cues named in the table.
fn cues(tree: &Tree, rows: &[FounderRow]) -> String {
    let used = |name: &String| rows.iter().any(|row| row.cue == *name || row.cued_descendants.contains_key(name));
    let cues = tree.lineage.cues.iter().filter(|(name, _)| used(name));
    paragraph(cues.map(|(name, cue)| format!("cue {name}: {cue}\n")))
}

/// Parameters changed by founders.
fn physics(tree: &Tree) -> String {
    let changes = |founder: &Founder| {
        let changes: Vec<String> = founder.changes().collect();
        let told = || format!("{} and its descendants up to the next founder: {}\n", founder.name, changes.join(", "));
        (!changes.is_empty()).then(told)
    };
    paragraph(tree.lineage.founders.iter().filter_map(changes)) + &paragraph(ruled(tree))
}

/// Parameters set by rules, from the least value to the greatest.
fn ruled(tree: &Tree) -> impl Iterator<Item = String> + '_ {
    Parameter::ALL.into_iter().filter_map(|parameter| {
        let values = tree.cells().filter_map(|id| tree.cell(id).physics.as_ref());
        let mut values = values.flat_map(|physics| physics.values()).filter(|(of, _)| *of == parameter).map(|(_, v)| v);
        let first = values.next()?;
        let (cells, least, most) =
            values.fold((1, first, first), |(n, least, most), v| (n + 1, v.min(least), v.max(most)));
        Some(format!("by rules: {parameter} from {least:.4} to {most:.4} in {cells} cells\n"))
    })
}

/// Lines followed by a blank line, if there are any.
fn paragraph(lines: impl Iterator<Item = String>) -> String {
    let text: String = lines.collect();
    if text.is_empty() { text } else { text + "\n" }
}

fn generations(summary: &TreeSummary) -> String {
    let line = |name: &str, of: &dyn Fn(usize, &Generation) -> usize| {
        let counts = summary.generations.iter().enumerate().map(|(g, row)| format!("{:>4}", of(g, row)));
        format!("{name:<12}{}\n", counts.collect::<String>())
    };
    [
        line("generation", &|g, _| g),
        line("cells", &|_, row| row.cells),
        line("symmetric", &|_, row| row.symmetric),
        line("asymmetric", &|_, row| row.asymmetric),
        line("ended", &|_, row| row.ended),
    ]
    .concat()
}
