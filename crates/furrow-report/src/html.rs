//! The report, one self-contained page, and the same page without a tree.

use super::escape;
use super::observed_table::{MODEL, decimals, observed_columns};
use super::page::{Page, data};
use super::summary::TreeSummary;
use super::svg::{colours, svg};
use super::table::{cue_text, outcome_name};
use furrow_cell::settings::{Settings, listing};
use furrow_formats::tree_to_json;
use furrow_formats::{FounderRow, Provenance};
use furrow_lineage::{Lineage, Tree, TreeSettings};
use std::fmt::Write;

/// A tree as a page that computes: its lineage to walk through, divisions played, the founders' table, the generations and the
/// parameters. Without scripts it shows the drawing and the tables.
pub fn html(tree: &Tree, rows: &[FounderRow]) -> String {
    let summary = TreeSummary::of(tree);
    let cell = &tree.settings.cell;
    let name = escape(&tree.lineage.name);
    let mut top = format!(
        "<p class=\"sub\">{} cells from one of R0 = {} at ε = {}, ξ<sub>s</sub> = {}. Branches end: {}.</p>\n",
        tree.len(),
        tree.cell(tree.first()).r0,
        cell.epsilon,
        cell.xi_s,
        summary.ended_text()
    );
    if summary.limited() {
        top.push_str(
            "<p><strong>Some branches were stopped by a limit of the lineage file, not by mechanics.</strong></p>\n",
        );
    }
    let mut below = String::new();
    founders(&mut below, tree, rows);
    generations(&mut below, &summary);
    parameters(&mut below, tree);
    let still =
        format!("<section class=\"card\"><h2>Lineage</h2>\n<div class=\"tree\">{}</div></section>\n", svg(tree));
    Page {
        title: format!("{name} grown from mechanics"),
        heading: format!("{name}, grown from mechanics"),
        top,
        still,
        below,
        data: data(&tree.lineage, &tree.settings, tree_to_json(tree).ok()),
    }
    .html()
}

/// The page that computes, without a tree: any cell you choose, and a lineage to grow.
pub fn explorer(lineage: &Lineage, settings: &TreeSettings) -> String {
    let name = escape(&lineage.name);
    let mut below = String::new();
    listed_parameters(&mut below, lineage, settings);
    Page {
        title: "furrow: what a cell does".to_owned(),
        heading: "What does a cell of this size do?".to_owned(),
        top: format!(
            "<p class=\"sub\">One division after another, computed in this page from mechanics, and the founders of {name} grown from one cell.</p>\n"
        ),
        still: "<p>Everything here is computed by a script, which does not run.</p>\n".to_owned(),
        below,
        data: data(lineage, settings, None),
    }
    .html()
}

fn founders(out: &mut String, tree: &Tree, rows: &[FounderRow]) {
    let observed = observed_columns(rows);
    let in_um = rows.iter().any(|row| row.r0_um.is_some());
    let _ = write!(
        out,
        "<section class=\"card\"><h2>Rounds of division per founder</h2>\n<div class=\"wrap\"><table><thead><tr><th colspan=\"{}\"></th><th colspan=\"6\" class=\"s l\">model</th>{}</tr>\
         <tr><th>founder</th><th>R0</th>{}<th class=\"l\">cue</th><th class=\"l\">its division</th><th>χ</th>",
        if in_um { 6 } else { 5 },
        match observed.len() {
            0 => String::new(),
            columns => format!("<th colspan=\"{columns}\" class=\"s l\">observed</th>"),
        },
        if in_um { "<th>R0, µm</th>" } else { "" },
    );
    group(out, "th", MODEL.iter().map(|(name, ..)| in_full(name)));
    group(out, "th", observed.iter().map(|(name, ..)| in_full(name)));
    out.push_str("</tr></thead><tbody>\n");
    for (row, colour) in rows.iter().zip(colours(&tree.lineage)) {
        let _ = write!(
            out,
            "<tr><td><span class=\"dot\" style=\"background:{colour}\"></span>{}</td><td>{}</td>{}<td class=\"l\">{}</td><td class=\"l\">{}</td><td>{}</td>",
            escape(&row.name),
            decimals(row.r0, 3),
            if in_um { format!("<td>{}</td>", decimals(row.r0_um, 2)) } else { String::new() },
            escape(&cue_text(row)),
            outcome_name(row.outcome),
            decimals(row.chi, 3)
        );
        match &row.rounds {
            Some(rounds) => group(out, "td", MODEL.iter().map(|(_, _, text)| text(rounds))),
            None => out.push_str("<td class=\"s l\" colspan=\"6\">not born</td>"),
        }
        group(out, "td", observed.iter().map(|(_, _, text)| row.observed.as_ref().map_or(String::new(), text)));
        out.push_str("</tr>\n");
    }
    out.push_str("</tbody></table></div>\n<p>Rounds are divisions from the founder to a terminal cell: fewest, mean and most over its terminal cells. Full doublings are the generations, counted from the founder, in which every cell divided; symmetric, those in which every cell divided into equal halves. Size asymmetry χ = |V₁ − V₂|/V.");
    if let Some(citation) = &tree.lineage.citation {
        let deaths = rows.iter().any(|row| row.observed.is_some_and(|observed| observed.deaths.is_some()));
        let what = if deaths { "Observed, deaths included" } else { "Observed" };
        let _ = write!(out, " {what}: {}.", escape(citation.trim_end_matches('.')));
    }
    out.push_str("</p></section>\n");
}

/// Cells of a group of columns, with a border before the first.
pub(super) fn group<T: std::fmt::Display>(out: &mut String, tag: &str, texts: impl Iterator<Item = T>) {
    for (k, text) in texts.enumerate() {
        let _ = write!(out, "<{tag}{}>{text}</{tag}>", if k == 0 { " class=\"s\"" } else { "" });
    }
}

/// The heading of a column of counts in full.
fn in_full(heading: &'static str) -> &'static str {
    match heading {
        "full" => "full doublings",
        "sym" => "symmetric",
        "cells" => "terminal cells",
        heading => heading,
    }
}

fn generations(out: &mut String, summary: &TreeSummary) {
    out.push_str("<section class=\"card\"><h2>Generations</h2>\n<div class=\"wrap\"><table><thead><tr><th>generation</th><th>cells</th><th>divide symmetrically</th><th>asymmetrically</th><th>do not divide</th><th>smallest R0</th><th>largest R0</th></tr></thead><tbody>\n");
    for (g, row) in summary.generations.iter().enumerate() {
        let _ = writeln!(
            out,
            "<tr><td>{g}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{:.3}</td><td>{:.3}</td></tr>",
            row.cells, row.symmetric, row.asymmetric, row.ended, row.r0[0], row.r0[1]
        );
    }
    out.push_str("</tbody></table></div></section>\n");
}

/// The parameters that a tree was grown with.
pub(super) fn parameters(out: &mut String, tree: &Tree) {
    listed_parameters(out, &tree.lineage, &tree.settings);
}

fn listed_parameters(out: &mut String, lineage: &Lineage, settings: &TreeSettings) {
    let mut text = String::new();
    let shown = Settings { cell: settings.cell.clone(), numerics: settings.numerics };
    for (section, name, value) in listing(&shown) {
        let _ = writeln!(text, "{section}.{name} = {value}");
    }
    let _ = writeln!(text, "seed = {}\nR0 rounded to a relative step of {:e}", settings.seed, settings.r0_step);
    for (name, cue) in &lineage.cues {
        let _ = writeln!(text, "cue {name}: {cue}");
    }
    let provenance = Provenance::current();
    let commit = provenance.git_commit.map_or(String::new(), |commit| format!(", commit {commit}"));
    let _ = write!(text, "furrow {}{commit}", provenance.furrow);
    let _ = write!(
        out,
        "<section class=\"card\"><h2>Parameters</h2>\n<p>Units: energy κ₀, length L<sub>h</sub> = √(η<sub>b</sub>/Γ), time τ = η<sub>b</sub>L<sub>h</sub>²/κ₀. The shell constants (aspect, p0, w) and the gain of the preset are not printed in the paper; they were recovered by fitting its four printed thresholds.</p>\n<pre>{}</pre></section>\n",
        escape(&text)
    );
}
