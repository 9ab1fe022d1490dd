//! The report, one self-contained page, and the same page without a tree.

use super::observed_table::{MODEL, decimals, observed_columns};
use super::over_time;
use super::page::{Page, Shown, data};
use super::summary::{Generation, TreeSummary};
use super::svg::{colours, svg};
use super::table::{cue_text, outcome_name, short};
use super::time_axis::TimeAxis;
use super::{escape, rounded};

use furrow_analysis::LineageRanges;
use furrow_cell::settings::{Settings, listing};
use furrow_formats::{FounderRow, Provenance, tree_to_json};
use furrow_lineage::{Lineage, Tree, TreeSettings};
use serde::Serialize;
use std::fmt::Write;

/// An interactive page of a tree: its lineage, played divisions, the founders' table, the generations and the
/// parameters. Without scripts it shows the drawing and the tables. `spread` has the ranges over seeds, if they are
/// known.
pub fn html(tree: &Tree, rows: &[FounderRow], spread: Option<&LineageRanges>) -> String {
    let name = escape(&tree.lineage.name);
    let OfTree { summary, below } = OfTree::new(tree, rows);
    let alone =
        |tree_json| Shown { name: "", made: String::new(), colours: colours(&tree.lineage), tree: tree_json, spread };
    let shown: Vec<Shown<'_>> = tree_to_json(tree).ok().map(alone).into_iter().collect();
    Page {
        title: format!("{name} grown from mechanics"),
        heading: format!("{name}, grown from mechanics"),
        top: format!("<div id=\"summary\" class=\"sub\">{summary}</div>\n"),
        above: String::new(),
        still: format!(
            "<section class=\"card\"><h2>Lineage</h2>\n<div class=\"tree\">{}</div></section>\n",
            svg(tree, TimeAxis::Generations)
        ),
        below: format!("<div id=\"of-tree\">\n{below}</div>\n"),
        data: data(&tree.lineage, &tree.settings, &shown),
    }
    .html()
}

/// The sections of a page that depend on the tree, as HTML. After the page has grown a tree, it asks its module for
/// them again.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OfTree {
    /// The tree in a sentence, below the heading.
    pub summary: String,
    /// Its sections below the lineage: founders, cells over time, generations, parameters.
    pub below: String,
}

impl OfTree {
    /// Of a tree and the rows of its founders.
    pub fn new(tree: &Tree, rows: &[FounderRow]) -> OfTree {
        let counts = TreeSummary::of(tree);
        let (cells, ended) = (tree.len(), counts.ended_text());
        let first = tree.parameters(tree.first());
        let um = tree.lineage.units().in_micrometres(first.r0);
        let [r0, epsilon, xi_s] = [first.r0, first.epsilon, first.xi_s].map(short);
        let mut summary = format!(
            "<p>{cells} cells from one of R0 = {r0}{um} at ε = {epsilon}, ξ<sub>s</sub> = {xi_s}. Branches end: {ended}.</p>\n"
        );
        if counts.limited() {
            summary += "<p><strong>Some branches were stopped by a limit of the lineage file, not by mechanics.</strong></p>\n";
        }
        let parameters = parameters(&tree.lineage, &tree.settings);
        let below = founders(tree, rows) + &over_time::section(tree) + &generations(&counts) + &parameters;
        OfTree { summary, below }
    }
}

/// The interactive page without a tree: a cell with chosen parameters, and a lineage to grow.
pub fn explorer(lineage: &Lineage, settings: &TreeSettings) -> String {
    let name = escape(&lineage.name);
    Page {
        title: "furrow: what a cell does".to_owned(),
        heading: "What does a cell of this size do?".to_owned(),
        top: format!(
            "<p class=\"sub\">Divisions computed in this page from mechanics. Under <strong>What if</strong>, on the left sliders of one cell, to begin with the zygote of {name}; \
             in the middle that cell at the end of its division, in its shell; on the right where it lies in the plane of size and activity, and the line beyond which cells divide. \
             <strong>Grow</strong> repeats the divisions of daughters, from the first cell to the last, and compares the founders with the embryo.</p>\n"
        ),
        above: String::new(),
        still: "<p>Everything here is computed by a script, which does not run.</p>\n".to_owned(),
        below: format!("<div id=\"of-tree\">\n{}</div>\n", parameters(lineage, settings)),
        data: data(lineage, settings, &[]),
    }
    .html()
}

fn founders(tree: &Tree, rows: &[FounderRow]) -> String {
    let observed = observed_columns(rows);
    let in_um = rows.iter().any(|row| row.r0_um.is_some());
    let (own, um) = if in_um { (6, "<th>R0, µm</th>") } else { (5, "") };
    let seen = match observed.len() {
        0 => String::new(),
        columns => format!("<th colspan=\"{columns}\" class=\"s l\">observed</th>"),
    };
    let mut out = format!(
        "<section class=\"card\"><h2>Rounds of division per founder</h2>\n<div class=\"wrap\"><table><thead><tr><th colspan=\"{own}\"></th><th colspan=\"6\" class=\"s l\">model</th>{seen}</tr>\
         <tr><th>founder</th><th>R0</th>{um}<th class=\"l\">cue</th><th class=\"l\">its division</th><th>χ</th>{}{}</tr></thead><tbody>\n",
        group("th", MODEL.iter().map(|(name, ..)| in_full(name))),
        group("th", observed.iter().map(|(name, ..)| in_full(name)))
    );
    for (row, colour) in rows.iter().zip(colours(&tree.lineage)) {
        let um = if in_um { format!("<td>{}</td>", decimals(row.r0_um, 2)) } else { String::new() };
        let (name, r0, cue, chi) =
            (escape(&row.name), decimals(row.r0, 3), escape(&cue_text(row)), decimals(row.chi, 3));
        let outcome = outcome_name(row.outcome);
        let model = match &row.rounds {
            Some(rounds) => group("td", MODEL.iter().map(|(_, _, text)| text(rounds))),
            None => "<td class=\"s l\" colspan=\"6\">not born</td>".to_owned(),
        };
        let seen = observed.iter().map(|(_, _, text)| row.observed.as_ref().map_or(String::new(), text));
        let seen = group("td", seen);
        let _ = writeln!(
            out,
            "<tr><td><span class=\"dot\" style=\"background:{colour}\"></span>{name}</td><td>{r0}</td>{um}<td class=\"l\">{cue}</td><td class=\"l\">{outcome}</td><td>{chi}</td>{model}{seen}</tr>"
        );
    }
    out.push_str("</tbody></table></div>\n<p>Rounds are divisions from the founder to a terminal cell: fewest, mean and most over its terminal cells. Full doublings are the generations, counted from the founder, in which every cell divided; symmetric, those in which every cell divided into equal halves. Size asymmetry χ = |V₁ − V₂|/V.");
    if let Some(citation) = &tree.lineage.citation {
        let deaths = rows.iter().any(|row| row.observed.is_some_and(|observed| observed.deaths.is_some()));
        let what = if deaths { "Observed, deaths included" } else { "Observed" };
        let _ = write!(out, " {what}: {}.", escape(citation.trim_end_matches('.')));
    }
    out + "</p></section>\n"
}

/// Cells of a group of columns, with a border before the first.
pub(super) fn group<T: std::fmt::Display>(tag: &str, texts: impl Iterator<Item = T>) -> String {
    let class = |k: usize| if k == 0 { " class=\"s\"" } else { "" };
    texts.enumerate().map(|(k, text)| format!("<{tag}{}>{text}</{tag}>", class(k))).collect()
}

/// The full heading of a column of counts.
fn in_full(heading: &'static str) -> &'static str {
    match heading {
        "full" => "full doublings",
        "sym" => "symmetric",
        "cells" => "terminal cells",
        heading => heading,
    }
}

fn generations(summary: &TreeSummary) -> String {
    let row = |(g, row): (usize, &Generation)| {
        let Generation { cells, symmetric, asymmetric, ended, r0: [least, most] } = row;
        format!(
            "<tr><td>{g}</td><td>{cells}</td><td>{symmetric}</td><td>{asymmetric}</td><td>{ended}</td><td>{least:.3}</td><td>{most:.3}</td></tr>\n"
        )
    };
    let rows: String = summary.generations.iter().enumerate().map(row).collect();
    format!(
        "<section class=\"card\"><h2>Generations</h2>\n<div class=\"wrap\"><table><thead><tr><th>generation</th><th>cells</th><th>divide symmetrically</th><th>asymmetrically</th><th>do not divide</th><th>smallest R0</th><th>largest R0</th></tr></thead><tbody>\n{rows}</tbody></table></div></section>\n"
    )
}

/// The parameters that a tree is grown with.
pub(super) fn parameters(lineage: &Lineage, settings: &TreeSettings) -> String {
    let TreeSettings { cell, numerics, seed, r0_step } = settings.clone();
    let mut more = format!("seed = {seed}\nR0 rounded to a relative step of {r0_step:e}\n");
    for (name, cue) in &lineage.cues {
        let _ = writeln!(more, "cue {name}: {cue}");
    }
    listed(Settings::of(cell, numerics), &more)
}

/// The section of parameters: the settings, then the lines of `more`.
pub(super) fn listed(settings: Settings, more: &str) -> String {
    let mut text = String::new();
    for (section, name, value) in listing(&settings) {
        let _ = writeln!(text, "{section}.{name} = {value}");
    }
    if let Some(law) = &settings.cell.law {
        let _ = writeln!(text, "law = {}", law.described());
    }
    if let Some(profile) = &settings.cell.shell_profile {
        let _ = writeln!(text, "shell_profile = {}", profile.described());
    }
    let Provenance { furrow, git_commit, .. } = Provenance::current();
    let commit = git_commit.map_or(String::new(), |commit| format!(", commit {commit}"));
    let text = escape(&format!("{}furrow {furrow}{commit}", rounded(&(text + more))));
    format!(
        "<section class=\"card\"><h2>Parameters</h2>\n<p>Units: energy κ₀, length L<sub>h</sub> = √(η<sub>b</sub>/Γ), time τ = η<sub>b</sub>L<sub>h</sub>²/κ₀. The paper prints neither the shell constants (aspect, p0, w) nor the gain. The preset gao2026 fits them to all statements of the paper, gao2026-thresholds only to its four printed thresholds, sulston1983 to the rounds of the C. elegans founders.</p>\n<pre>{text}</pre></section>\n"
    )
}
