//! Founders over many seeds of the noise, as tables of text.

use std::fmt::Write;

use super::observed_table::decimals;
use super::spread::{columns, differs, texts};
use furrow_analysis::{FounderRange, LineageRanges, Range};
use furrow_lineage::Scenario;

/// The column with the numbers of cells.
const CELLS: usize = 4;

/// For each scenario the founders' χ, rounds and cells over the seeds, beside the observed counts: the median, and the
/// range of 90 % of the seeds if it is wider than the last digit. A star marks values that differ from the first
/// scenario's by more than the spread of both.
pub fn spread_table(scenarios: &[Scenario], spread: &[LineageRanges]) -> String {
    let members = spread.first().map_or(0, |ranges| ranges.members);
    let several = scenarios.len() > 1;
    let plural = if members == 1 { "" } else { "s" };
    let mut out =
        format!("{members} seed{plural} of the noise: median, and [5 %, 95 %] where it differs from the median\n");
    for (k, (scenario, ranges)) in scenarios.iter().zip(spread).enumerate() {
        out.push('\n');
        if several {
            let _ = writeln!(out, "{} {}: {}", k + 1, scenario.name, scenario.made_of());
        }
        if let Some(cells) = ranges.cells {
            let _ = writeln!(out, "{} cells", shown(&cells, CELLS));
        }
        let _ = writeln!(
            out,
            "{:<8} {:>22} {:>22} {:>12} {:>12} {:>18}   observed: mean, cells",
            "founder", "χ ", "rounds: mean ", "min ", "max ", "cells "
        );
        for (founder, FounderRange { name, .. }) in ranges.founders.iter().enumerate() {
            // A founder that scenario 1 lacks is not compared.
            let has = |ranges: &LineageRanges| ranges.founders.iter().any(|first| first.name == *name);
            let first = (k > 0 && has(&spread[0])).then(|| columns(Some(&spread[0]), name));
            let _ = writeln!(out, "{}", line(scenario, founder, columns(Some(ranges), name), first));
        }
    }
    if several {
        out.push_str("\n* differs from scenario 1 by more than the spread of both\n");
    }
    out + "\nRounds are divisions from the founder to a terminal cell, χ is the size asymmetry of the founder's own division,\n\
           cells are its terminal ones.\n"
}

fn line(scenario: &Scenario, founder: usize, own: [Option<Range>; 5], first: Option<[Option<Range>; 5]>) -> String {
    let text = |column: usize| {
        let differs = first.is_some_and(|first| match (&own[column], &first[column]) {
            (Some(own), Some(first)) => differs(own, first, column),
            (own, first) => own.is_some() != first.is_some(),
        });
        let text = own[column].map_or("-".to_owned(), |own| shown(&own, column));
        format!("{text}{}", if differs { '*' } else { ' ' })
    };
    let [min, mean, max, chi, cells] = std::array::from_fn(text);
    let founder = &scenario.lineage.founders[founder];
    let observed = founder.observed.map_or(String::new(), |observed| {
        let cells = observed.terminal.map_or(String::new(), |cells| cells.to_string());
        format!("{:>6} {cells:>6}", decimals(observed.mean, 2))
    });
    let line = format!("{:<8} {chi:>22} {mean:>22} {min:>12} {max:>12} {cells:>18}  {observed}", founder.name);
    line.trim_end().to_owned()
}

/// The median, and the range if it is visible at the printed digits.
fn shown(range: &Range, column: usize) -> String {
    let [p5, p50, p95] = texts(range, column);
    if p5 == p95 { p50 } else { format!("{p50} [{p5}, {p95}]") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_is_shown_where_it_is_wider_than_the_last_digit() {
        let range = |p5, p50, p95| Range { p5, p50, p95 };
        assert_eq!(shown(&range(6.251, 6.25, 6.254), 1), "6.25");
        assert_eq!(shown(&range(6.2, 6.25, 6.9), 1), "6.25 [6.20, 6.90]");
        assert!(differs(&range(1.0, 2.0, 3.0), &range(3.1, 4.0, 5.0), 1));
        assert!(!differs(&range(1.0, 2.0, 3.0), &range(3.0, 4.0, 5.0), 1));
        // χ of 10⁻⁵ and 10⁻⁴ print alike.
        assert!(!differs(&range(1e-5, 1e-5, 1e-5), &range(1e-4, 1e-4, 1e-4), 3));
    }
}
