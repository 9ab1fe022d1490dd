//! Several scenarios on one self-contained page: small drawings and the table.

use std::fmt::Write;

use super::escape;
use super::html::{group, parameters};
use super::observed_table::{OBSERVED_BESIDE, SCENARIO, founder_lines};
use super::summary::TreeSummary;
use super::svg::{colours, small};
use furrow_lineage::{Scenario, Tree};

const STYLE: &str = "body{font:15px/1.5 Helvetica,Arial,sans-serif;color:#222;margin:2rem auto;max-width:1320px;padding:0 1rem}\
h1{font-size:1.5rem;margin-bottom:0}h2{font-size:1.15rem;margin-top:2rem}p.sub{color:#666;margin-top:.2rem}\
table{border-collapse:collapse;font-variant-numeric:tabular-nums}th,td{padding:.2rem .5rem;text-align:right;border-bottom:1px solid #e6e8eb}\
th{font-weight:600;color:#444}td:first-child,th:first-child,td.l,th.l{text-align:left}td.s,th.s{border-left:2px solid #bbb}\
.dot{display:inline-block;width:.7em;height:.7em;border-radius:50%;margin-right:.45em}.tree{overflow-x:auto;border:1px solid #e6e8eb}.tree svg{display:block;width:100%;min-width:1100px;height:auto}\
code,pre{font:13px/1.45 Menlo,Consolas,monospace}pre{background:#f6f7f9;padding:.8rem;overflow-x:auto}.wrap{overflow-x:auto}";
/// Style of the drawings' grid.
const GRID: &str = ".grid{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(100%,380px),1fr));gap:1rem}figure{margin:0;border:1px solid #e6e8eb;padding:.5rem;min-width:0}\
figcaption{font-size:.87rem;overflow-wrap:anywhere}figcaption span{color:#666}figure svg{display:block;width:100%;height:auto}td.d{font-weight:600;background:#fff3d6}";

/// The scenarios as a page: a small drawing of each tree, the table of founders and scenarios, and the parameters.
pub fn scenarios_page(scenarios: &[Scenario], trees: &[Tree]) -> String {
    let (palette, count) = (palette(trees), scenarios.len());
    let pairs = scenarios.iter().zip(trees).enumerate();
    let drawings: String = pairs.map(|(k, (scenario, tree))| drawing(k + 1, scenario, tree, &palette)).collect();
    let parameters = trees.first().map_or(String::new(), |tree| {
        format!(
            "<p>The parameters of scenario 1; the others differ from it in lineage and cue, as said above and in the tree.json of each.</p>\n{}",
            parameters(&tree.lineage, &tree.settings)
        )
    });
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width\"><title>{count} scenarios side by side</title><style>{STYLE}{GRID}</style></head><body>\n<h1>{count} scenarios side by side</h1>\n\
         {}<div class=\"grid\">\n{drawings}</div>\n{}{parameters}</body></html>\n",
        dots(&palette),
        table(scenarios, trees)
    )
}

/// Founders and their colours, the same in all drawings: those that the first tree with the founder gives it.
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

fn drawing(number: usize, scenario: &Scenario, tree: &Tree, palette: &Palette<'_>) -> String {
    let colour = |name: &str| palette.iter().find(|(known, _)| *known == name).map_or("#222", |(_, colour)| colour);
    let colours: Vec<&str> = tree.lineage.founders.iter().map(|founder| colour(&founder.name)).collect();
    let cue = scenario.cue.as_ref().map_or(String::new(), |cue| format!("; cue {}", escape(cue)));
    let limited = TreeSummary::of(tree).limited();
    let limited = if limited { " Some branches were stopped by a limit, not by mechanics." } else { "" };
    let [name, lineage] = [&scenario.name, &tree.lineage.name].map(|name| escape(name));
    let (cells, tree) = (tree.len(), small(tree, &colours));
    format!(
        "<figure><figcaption><strong>{number} {name}</strong> <span>{lineage}{cue}; {cells} cells.{limited}</span></figcaption>\n{tree}</figure>\n"
    )
}

fn table(scenarios: &[Scenario], trees: &[Tree]) -> String {
    let lines = founder_lines(trees);
    let observed = lines.iter().any(|line| line.observed.is_some());
    let heading = |columns: usize, text: &str| format!("<th colspan=\"{columns}\" class=\"s l\">{text}</th>");
    let beside = |text: String| if observed { text } else { String::new() };
    let names = scenarios.iter().enumerate();
    let names = names.map(|(k, scenario)| heading(SCENARIO.len(), &format!("{} {}", k + 1, escape(&scenario.name))));
    let mut out = format!(
        "<h2>Rounds of division per founder</h2>\n<div class=\"wrap\"><table><thead><tr><th></th>{}{}</tr>\n<tr><th>founder</th>{}{}</tr></thead><tbody>\n",
        names.collect::<String>(),
        beside(heading(OBSERVED_BESIDE.len(), "observed")),
        group("th", SCENARIO.iter()).repeat(scenarios.len()),
        beside(group("th", OBSERVED_BESIDE.iter()))
    );
    for line in &lines {
        let _ = write!(out, "<tr><td>{}</td>", escape(&line.name));
        for entry in &line.entries {
            for (k, (text, differs)) in entry.texts.iter().zip(entry.differs).enumerate() {
                let class = match (k, differs) {
                    (0, true) => " class=\"s d\"",
                    (0, false) => " class=\"s\"",
                    (_, true) => " class=\"d\"",
                    (_, false) => "",
                };
                let _ = write!(out, "<td{class}>{text}</td>");
            }
        }
        out += &beside(group("td", (0..OBSERVED_BESIDE.len()).map(|k| line.observed_text(k))));
        out.push_str("</tr>\n");
    }
    out.push_str("</tbody></table></div>\n<p>Shaded: another number than in scenario 1. Rounds are divisions from the founder to a terminal cell: fewest, mean and most over its terminal cells; χ is the size asymmetry of the founder's own division, cells are its terminal ones.");
    if let Some(citation) = trees.iter().find_map(|tree| tree.lineage.citation.as_ref()) {
        let _ = write!(out, " Observed, deaths included: {}.", escape(citation.trim_end_matches('.')));
    }
    out + "</p>\n"
}
