//! Several scenarios as one table of text.

use std::fmt::Write;

use super::observed_table::{FounderLine, OBSERVED_BESIDE, SCENARIO, founder_lines};
use furrow_lineage::{Scenario, Tree};

/// Columns of a terminal that the table keeps to, by wrapping into blocks of scenarios.
const PAGE: usize = 120;

/// Founders down, scenarios across: fewest, mean and most rounds, χ of the founder's division, terminal cells, and observed
/// counts. A star marks a number that differs from the first scenario's.
pub fn scenarios_table(scenarios: &[Scenario], trees: &[Tree]) -> String {
    let mut out = String::new();
    list(&mut out, scenarios, trees);
    let lines = founder_lines(trees);
    let table = Widths::of(&lines);
    let titles: Vec<String> = scenarios.iter().enumerate().map(|(k, s)| format!("{} {}", k + 1, s.name)).collect();
    let room = PAGE.saturating_sub(table.founder + table.observed_width());
    let at_once = (room / table.scenario_width()).max(1);
    for first in (0..titles.len()).step_by(at_once) {
        block(&mut out, &lines, &titles, first..(first + at_once).min(titles.len()), &table);
        out.push('\n');
    }
    out.push_str("* another number than in scenario 1. Rounds are divisions from the founder to a terminal cell: fewest, mean, most;\n");
    out.push_str("χ is the size asymmetry of the founder's own division, cells are its terminal ones.\n");
    out
}

/// The numbered scenarios, with cue or lineage and number of cells.
fn list(out: &mut String, scenarios: &[Scenario], trees: &[Tree]) {
    let widest = |texts: &mut dyn Iterator<Item = usize>| texts.max().unwrap_or(0);
    let name = widest(&mut scenarios.iter().map(|scenario| scenario.name.chars().count()));
    let cells = widest(&mut trees.iter().map(|tree| tree.len().to_string().len()));
    let number = scenarios.len().to_string().len();
    for (k, (scenario, tree)) in scenarios.iter().zip(trees).enumerate() {
        let first = tree.cell(tree.first()).r0;
        let made_of = match &scenario.cue {
            Some(cue) => format!("cue {cue}"),
            None => tree.lineage.name.clone(),
        };
        let _ = writeln!(
            out,
            "{:>number$} {:name$}  {:>cells$} cells from R0 = {first}; {made_of}",
            k + 1,
            scenario.name,
            tree.len()
        );
    }
    if let Some(tree) = trees.first() {
        let cell = &tree.settings.cell;
        let _ = writeln!(out, "ε = {}, ξ_s = {}, unless a lineage says otherwise\n", cell.epsilon, cell.xi_s);
    }
}

/// Widths of the columns, with a blank before each and room for the star of a scenario's numbers.
struct Widths {
    founder: usize,
    model: [usize; 5],
    observed: [usize; 4],
}

impl Widths {
    fn of(lines: &[FounderLine]) -> Widths {
        let widest = |heading: &str, texts: &mut dyn Iterator<Item = usize>| {
            texts.chain([heading.chars().count()]).max().unwrap_or(0)
        };
        let model = |k: usize| {
            let texts = lines.iter().flat_map(|line| &line.entries).map(|entry| 1 + entry.texts[k].chars().count());
            1 + widest(SCENARIO[k], &mut texts.into_iter())
        };
        let observed = |k: usize| {
            let texts = lines.iter().map(|line| line.observed_text(k).chars().count());
            1 + widest(OBSERVED_BESIDE[k], &mut texts.into_iter())
        };
        let any = lines.iter().any(|line| (0..OBSERVED_BESIDE.len()).any(|k| !line.observed_text(k).is_empty()));
        Widths {
            founder: 1 + widest("founder", &mut lines.iter().map(|line| line.name.chars().count())),
            model: std::array::from_fn(model),
            observed: if any { std::array::from_fn(observed) } else { [0; 4] },
        }
    }

    /// With the bar before it.
    fn scenario_width(&self) -> usize {
        1 + self.model.iter().sum::<usize>()
    }

    /// With the bar before it; nothing where nothing was observed.
    fn observed_width(&self) -> usize {
        match self.observed.iter().sum::<usize>() {
            0 => 0,
            width => 1 + width,
        }
    }
}

/// The scenarios of a range, and the observed counts.
fn block(out: &mut String, lines: &[FounderLine], titles: &[String], shown: std::ops::Range<usize>, widths: &Widths) {
    let observed = widths.observed_width() > 0;
    let scenario = widths.scenario_width() - 1;
    let mut heading = " ".repeat(widths.founder);
    let mut columns = format!("{:1$}", "founder", widths.founder);
    let mut rule = "-".repeat(widths.founder);
    for title in &titles[shown.clone()] {
        let _ = write!(heading, "| {:1$}", shortened(title, scenario - 1), scenario - 1);
        columns.push('|');
        SCENARIO.iter().zip(widths.model).for_each(|(name, width)| columns.push_str(&format!("{name:>width$}")));
        let _ = write!(rule, "+{}", "-".repeat(scenario));
    }
    if observed {
        heading.push_str("| observed");
        columns.push('|');
        OBSERVED_BESIDE
            .iter()
            .zip(widths.observed)
            .for_each(|(name, width)| columns.push_str(&format!("{name:>width$}")));
        let _ = write!(rule, "+{}", "-".repeat(widths.observed_width() - 1));
    }
    for line in [&heading, &columns, &rule] {
        let _ = writeln!(out, "{}", line.trim_end());
    }
    for line in lines {
        let mut text = format!("{:1$}", line.name, widths.founder);
        for entry in &line.entries[shown.clone()] {
            text.push('|');
            for ((cell, differs), width) in entry.texts.iter().zip(entry.differs).zip(widths.model) {
                let _ = write!(text, "{cell:>0$}{1}", width - 1, if differs { '*' } else { ' ' });
            }
        }
        if observed {
            text.push('|');
            for (k, width) in widths.observed.into_iter().enumerate() {
                let _ = write!(text, "{:>width$}", line.observed_text(k));
            }
        }
        let _ = writeln!(out, "{}", text.trim_end());
    }
}

/// A title that fits into its columns; the list above the table has it whole.
fn shortened(title: &str, width: usize) -> String {
    match title.chars().count() > width {
        true => title.chars().take(width.saturating_sub(1)).chain(['…']).collect(),
        false => title.to_owned(),
    }
}
