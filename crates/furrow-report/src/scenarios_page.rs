//! Several scenarios on the interactive page: the table of founders and scenarios, and every tree.

use std::fmt::Write;

use super::escape;
use super::html::{group, parameters};
use super::observed_table::{Entry, OBSERVED_BESIDE, SCENARIO, founder_lines};
use super::page::{Page, Shown, data};
use super::spread;
use super::summary::TreeSummary;
use super::svg::{colours, small};
use super::table::short;
use furrow_analysis::{LineageRanges, Range};
use furrow_formats::tree_to_json;
use furrow_lineage::{Scenario, Tree};

/// The scenarios as an interactive page: the table of founders and scenarios, every tree, and the parameters.
///
/// `spreads` has the ranges of each scenario over seeds of the noise; it is empty for a single seed.
pub fn scenarios_page(scenarios: &[Scenario], trees: &[Tree], spreads: &[LineageRanges]) -> String {
    let (palette, count) = (palette(trees), scenarios.len());
    let pairs = || scenarios.iter().zip(trees);
    let shown = pairs().enumerate().filter_map(|(k, (scenario, tree))| {
        Some(Shown {
            name: &scenario.name,
            made: made(scenario, tree),
            colours: own_colours(tree, &palette),
            tree: tree_to_json(tree).ok()?,
            spread: spreads.get(k),
        })
    });
    let (Some(first), shown) = (trees.first(), shown.collect::<Vec<_>>()) else { return String::new() };
    let [epsilon, xi_s] = [first.settings.cell.epsilon, first.settings.cell.xi_s].map(short);
    let still: String =
        pairs().enumerate().map(|(k, (scenario, tree))| drawing(k + 1, scenario, tree, &palette)).collect();
    let parameters = format!(
        "<div id=\"of-tree\">\n<p>The parameters of scenario 1; the others differ from it in lineage and cue, as said above and in the tree.json of each.</p>\n{}</div>\n",
        parameters(&first.lineage, &first.settings)
    );
    Page {
        title: format!("{count} scenarios side by side"),
        heading: format!("{count} scenarios side by side"),
        top: format!(
            "<p class=\"sub\">Lineages grown from mechanics at ε = {epsilon}, ξ<sub>s</sub> = {xi_s}, unless a lineage says otherwise. The table sets the scenarios beside each other and the embryo; \
             below, every tree can be walked through.</p>\n"
        ),
        above: table(scenarios, trees, spreads),
        still: format!("<section class=\"card\"><h2>Lineages</h2>\n{}{still}</section>\n", dots(&palette)),
        below: parameters,
        data: data(&first.lineage, &first.settings, &shown),
    }
    .html()
}

/// The lineage and cue of a scenario, in words.
fn made(scenario: &Scenario, tree: &Tree) -> String {
    let cue = scenario.cue.as_ref().map_or(String::new(), |cue| format!("; cue {cue}"));
    format!("{}{cue}", tree.lineage.name)
}

/// Founders and their colours, the same in all drawings. The first tree with a founder gives its colour.
type Palette<'a> = Vec<(&'a str, &'static str)>;

fn palette(trees: &[Tree]) -> Palette<'_> {
    let mut palette: Palette<'_> = Vec::new();
    for tree in trees {
        for (founder, colour) in tree.lineage.founders.iter().zip(colours(&tree.lineage)) {
            if !palette.iter().any(|(name, _)| *name == founder.name) {
                palette.push((&founder.name, colour));
            }
        }
    }
    palette
}

fn own_colours(tree: &Tree, palette: &Palette<'_>) -> Vec<&'static str> {
    let colour = |name: &str| palette.iter().find(|(known, _)| *known == name).map_or("#222222", |(_, colour)| colour);
    tree.lineage.founders.iter().map(|founder| colour(&founder.name)).collect()
}

/// The legend: colours of the founders, and discs.
fn dots(palette: &Palette<'_>) -> String {
    let dot = |(name, colour): &(&str, &str)| {
        format!("<span class=\"dot\" style=\"background:{colour}\"></span>{}&ensp; ", escape(name))
    };
    let dots: String = palette.iter().map(dot).collect();
    format!(
        "<p class=\"sub\">{dots}<br>A full disc divides symmetrically, a ring asymmetrically, an open circle over a bar does not divide. Discs are as wide as the cells. Rows are generations.</p>\n"
    )
}

/// The drawing of a tree for readers without scripts.
fn drawing(number: usize, scenario: &Scenario, tree: &Tree, palette: &Palette<'_>) -> String {
    let limited = TreeSummary::of(tree).limited();
    let limited = if limited { " Some branches were stopped by a limit, not by mechanics." } else { "" };
    let [name, made] = [&scenario.name, &made(scenario, tree)].map(|text| escape(text));
    let (cells, tree) = (tree.len(), small(tree, &own_colours(tree, palette)));
    format!(
        "<figure><figcaption><strong>{number} {name}</strong> <span>{made}; {cells} cells.{limited}</span></figcaption>\n{tree}</figure>\n"
    )
}

/// Whether a founder's column differs from the first scenario's: by more than their spreads, if these are known.
fn differs(column: usize, own: Option<&Range>, first: Option<&Range>, entry: bool) -> bool {
    own.zip(first).map_or(entry, |(own, first)| spread::differs(own, first, column))
}

/// The median over seeds, and the range from 5 to 95 % if it is visible at the printed digits.
fn median(range: &Range, column: usize) -> String {
    let [below, text, above] = spread::texts(range, column);
    if below == above { text } else { format!("{text}<small>{below}–{above}</small>") }
}

fn cells(entry: &Entry, own: &[Option<Range>; 5], first: &[Option<Range>; 5]) -> String {
    let cell = |k: usize| {
        let text = own[k].as_ref().map_or_else(|| entry.texts[k].clone(), |range| median(range, k));
        let class = match (k, differs(k, own[k].as_ref(), first[k].as_ref(), entry.differs[k])) {
            (0, true) => " class=\"s d\"",
            (0, false) => " class=\"s\"",
            (_, true) => " class=\"d\"",
            (_, false) => "",
        };
        format!("<td{class}>{text}</td>")
    };
    (0..SCENARIO.len()).map(cell).collect()
}

/// One row for each founder, columns for each scenario, and the observed counts.
fn table(scenarios: &[Scenario], trees: &[Tree], spreads: &[LineageRanges]) -> String {
    let lines = founder_lines(trees);
    let observed = lines.iter().any(|line| line.observed.is_some());
    let beside = |text: String| if observed { text } else { String::new() };
    let names = scenarios.iter().enumerate().map(|(k, scenario)| {
        let (columns, name) = (SCENARIO.len(), escape(&scenario.name));
        format!("<th colspan=\"{columns}\" class=\"s l\" data-scenario=\"{k}\">{} {name}</th>", k + 1)
    });
    let embryo = format!("<th colspan=\"{}\" class=\"s l\">observed</th>", OBSERVED_BESIDE.len());
    let mut out = format!(
        "<section class=\"card\"><h2>Rounds of division per founder</h2>\n<div class=\"wrap\"><table><thead><tr><th></th>{}{}</tr>\n<tr><th>founder</th>{}{}</tr></thead><tbody>\n",
        names.collect::<String>(),
        beside(embryo),
        group("th", SCENARIO.iter()).repeat(scenarios.len()),
        beside(group("th", OBSERVED_BESIDE.iter()))
    );
    for line in &lines {
        let columns = |k: usize| spread::columns(spreads.get(k), &line.name);
        let first = columns(0);
        let entries = line.entries.iter().enumerate();
        let entries = entries.map(|(k, entry)| cells(entry, &columns(k), &first));
        let seen = beside(group("td", (0..OBSERVED_BESIDE.len()).map(|k| line.observed_text(k))));
        let _ = writeln!(out, "<tr><td>{}</td>{}{seen}</tr>", escape(&line.name), entries.collect::<String>());
    }
    let shaded = if !spreads.is_empty() {
        "Medians over seeds, below them 5–95 %. Shaded: a range that does not meet that of scenario 1; what is not shaded may be the seed's."
    } else {
        "Shaded: another number than in scenario 1."
    };
    let _ = write!(
        out,
        "</tbody></table></div>\n<p>{shaded} Rounds are divisions from the founder to a terminal cell: fewest, mean and most over its terminal cells; χ is the size asymmetry of the founder's own division, cells are its terminal ones."
    );
    if let Some(citation) = trees.iter().find_map(|tree| tree.lineage.citation.as_ref()) {
        let _ = write!(out, " Observed, deaths included: {}.", escape(citation.trim_end_matches('.')));
    }
    out + "</p></section>\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use furrow_analysis::FounderRange;

    #[test]
    fn only_values_beyond_the_spread_differ() {
        let of = |low: f64, high: f64| {
            let cells = Some(Range { p5: low, p50: 0.5 * (low + high), p95: high });
            let founder = FounderRange { name: "AB".to_owned(), cells, ..FounderRange::default() };
            LineageRanges { founders: vec![founder], ..LineageRanges::default() }
        };
        let spreads = [of(10.0, 14.0), of(13.0, 20.0), of(15.0, 15.0)];
        let [first, near, far] = [0, 1, 2].map(|k| spread::columns(spreads.get(k), "AB"));
        assert_eq!(median(&first[4].unwrap(), 4), "12<small>10–14</small>");
        assert_eq!(median(&far[4].unwrap(), 4), "15");
        assert!(first[3].is_none() && spread::columns(spreads.first(), "P1")[4].is_none());
        // The numbers of one seed differ, but the ranges meet.
        assert!(!differs(4, near[4].as_ref(), first[4].as_ref(), true));
        assert!(differs(4, far[4].as_ref(), first[4].as_ref(), false));
        assert!(differs(4, None, None, true));
    }
}
