//! Several scenarios as one table of text.

use std::fmt::Write;
use std::ops::Range;

use super::observed_table::{FounderLine, OBSERVED_BESIDE, SCENARIO, founder_lines};
use furrow_cell::Cell;
use furrow_lineage::{Scenario, Tree};

/// Width of the table in characters, beyond which it wraps into blocks of scenarios.
const PAGE: usize = 120;

/// One row for each founder; for each scenario the fewest, mean and most rounds, χ of the founder's division and the
/// terminal cells; then the observed counts. A star marks a number that differs from the first scenario's.
pub fn scenarios_table(scenarios: &[Scenario], trees: &[Tree]) -> String {
    let lines = founder_lines(trees);
    let widths = Widths::of(&lines);
    let titles: Vec<String> = scenarios.iter().enumerate().map(|(k, s)| format!("{} {}", k + 1, s.name)).collect();
    let observed = widths.observed.iter().sum::<usize>();
    let room = PAGE.saturating_sub(widths.founder + observed + usize::from(observed > 0));
    let at_once = (room / (1 + widths.model.iter().sum::<usize>())).max(1);
    let starts = (0..titles.len()).step_by(at_once);
    let blocks = starts.map(|first| block(&lines, &titles, first..(first + at_once).min(titles.len()), &widths));
    let blocks: String = blocks.collect();
    format!(
        "{}{blocks}\
         * another number than in scenario 1. Rounds are divisions from the founder to a terminal cell: fewest, mean, most;\n\
         χ is the size asymmetry of the founder's own division, cells are its terminal ones.\n",
        list(scenarios, trees)
    )
}

/// The numbered scenarios, with cue or lineage and number of cells.
fn list(scenarios: &[Scenario], trees: &[Tree]) -> String {
    let mut out = String::new();
    let width = scenarios.iter().map(|scenario| scenario.name.chars().count()).max().unwrap_or(0);
    let digits = trees.iter().map(|tree| tree.len().to_string().len()).max().unwrap_or(0);
    let number = scenarios.len().to_string().len();
    for (k, (Scenario { name, cue, .. }, tree)) in scenarios.iter().zip(trees).enumerate() {
        let (place, cells, first) = (k + 1, tree.len(), tree.cell(tree.first()).r0);
        let made_of = cue.as_ref().map_or(tree.lineage.name.clone(), |cue| format!("cue {cue}"));
        let _ = writeln!(out, "{place:>number$} {name:width$}  {cells:>digits$} cells from R0 = {first}; {made_of}");
    }
    if let Some(tree) = trees.first() {
        let Cell { epsilon, xi_s, .. } = tree.settings.cell;
        let _ = writeln!(out, "ε = {epsilon}, ξ_s = {xi_s}, unless a lineage says otherwise\n");
    }
    out
}

/// Widths of the columns, with a blank before each and room for a star after the numbers of a scenario.
struct Widths {
    founder: usize,
    model: [usize; 5],
    /// Zero without observed counts.
    observed: [usize; 4],
}

impl Widths {
    fn of(lines: &[FounderLine]) -> Widths {
        let width = |text: &str| text.chars().count();
        let widest = |heading: &str, texts: &mut dyn Iterator<Item = usize>| {
            1 + texts.chain([width(heading)]).max().unwrap_or(0)
        };
        let entries = || lines.iter().flat_map(|line| &line.entries);
        let model = |k: usize| widest(SCENARIO[k], &mut entries().map(|entry| 1 + width(&entry.texts[k])));
        let seen = |k: usize| widest(OBSERVED_BESIDE[k], &mut lines.iter().map(|line| width(line.observed_text(k))));
        let any = lines.iter().any(|line| (0..OBSERVED_BESIDE.len()).any(|k| !line.observed_text(k).is_empty()));
        Widths {
            founder: widest("founder", &mut lines.iter().map(|line| width(&line.name))),
            model: std::array::from_fn(model),
            observed: if any { std::array::from_fn(seen) } else { [0; 4] },
        }
    }
}

/// The given range of scenarios, and the observed counts.
fn block(lines: &[FounderLine], titles: &[String], shown: Range<usize>, widths: &Widths) -> String {
    let Widths { founder, model, observed } = *widths;
    let (scenario, beside) = (model.iter().sum::<usize>(), observed.iter().sum::<usize>());
    // A line consists of the founder's column, the columns of each scenario, and the observed counts.
    let line = |first: &str, sign: char, of: &dyn Fn(usize) -> String, last: String| -> String {
        let scenarios = shown.clone().map(|k| format!("{sign}{}", of(k)));
        let last = if beside > 0 { format!("{sign}{last}") } else { String::new() };
        let text = format!("{first:founder$}{}{last}", scenarios.collect::<String>());
        format!("{}\n", text.trim_end())
    };
    let names = |names: &[&str], widths: &[usize]| -> String {
        names.iter().zip(widths).map(|(name, width)| format!("{name:>width$}")).collect()
    };
    let title = |k: usize| format!(" {:1$}", shortened(&titles[k], scenario - 1), scenario - 1);
    let rule = "-".repeat(founder);
    let mut out = [
        line("", '|', &title, " observed".to_owned()),
        line("founder", '|', &|_| names(&SCENARIO, &model), names(&OBSERVED_BESIDE, &observed)),
        line(&rule, '+', &|_| "-".repeat(scenario), "-".repeat(beside)),
    ]
    .concat();
    for of in lines {
        let entry = |k: usize| -> String {
            let cells = of.entries[k].texts.iter().zip(of.entries[k].differs).zip(model);
            cells.map(|((cell, differs), w)| format!("{cell:>0$}{1}", w - 1, if differs { '*' } else { ' ' })).collect()
        };
        let seen: Vec<&str> = (0..observed.len()).map(|k| of.observed_text(k)).collect();
        out += &line(&of.name, '|', &entry, names(&seen, &observed));
    }
    out + "\n"
}

/// A title shortened to its columns; the list above the table has the full title.
fn shortened(title: &str, width: usize) -> String {
    match title.chars().count() > width {
        true => title.chars().take(width.saturating_sub(1)).chain(['…']).collect(),
        false => title.to_owned(),
    }
}
