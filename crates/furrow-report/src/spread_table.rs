//! Founders over many seeds of the noise, as tables of text.

use std::fmt::Write;

use super::observed_table::decimals;
use furrow_analysis::{FounderRange, LineageRanges, Range};
use furrow_lineage::Scenario;

/// For each scenario the founders' χ, rounds and cells over the seeds, beside the observed counts: the median, and the range that
/// 90 % of the seeds give where it is wider than the last digit. A star marks what differs from the first scenario by more than
/// the spread of the two.
pub fn spread_table(scenarios: &[Scenario], spread: &[LineageRanges]) -> String {
    let members = spread.first().map_or(0, |ranges| ranges.members);
    let several = scenarios.len() > 1;
    let mut out = format!("{members} seeds of the noise: median, and [5 %, 95 %] where it differs from the median\n");
    for (k, (scenario, ranges)) in scenarios.iter().zip(spread).enumerate() {
        out.push('\n');
        if several {
            let _ = writeln!(out, "{} {}: {}", k + 1, scenario.name, scenario.made_of());
        }
        if let Some(cells) = ranges.cells {
            let _ = writeln!(out, "{} cells", shown(&cells, 0));
        }
        let _ = writeln!(
            out,
            "{:<8} {:>22} {:>22} {:>12} {:>12} {:>18}   observed: mean, cells",
            "founder", "χ ", "rounds: mean ", "min ", "max ", "cells "
        );
        for (founder, range) in ranges.founders.iter().enumerate() {
            let first = spread[0].founders.iter().find(|first| first.name == range.name).filter(|_| k > 0);
            let _ = writeln!(out, "{}", line(scenario, founder, range, first));
        }
    }
    if several {
        out.push_str("\n* differs from scenario 1 by more than the spread of both\n");
    }
    out + "\nRounds are divisions from the founder to a terminal cell, χ is the size asymmetry of the founder's own division,\n\
           cells are its terminal ones.\n"
}

fn line(scenario: &Scenario, founder: usize, range: &FounderRange, first: Option<&FounderRange>) -> String {
    let columns = |of: &FounderRange| {
        let rounds = of.rounds.as_ref();
        [of.chi, rounds.map(|r| r.mean), rounds.map(|r| r.min), rounds.map(|r| r.max), of.cells]
    };
    let digits = [3, 2, 0, 0, 0];
    let firsts = first.map(columns);
    let texts: Vec<String> = columns(range)
        .iter()
        .enumerate()
        .map(|(k, own)| {
            let text = |of: &Option<Range>| of.as_ref().map_or("-".to_owned(), |of| shown(of, digits[k]));
            // What looks alike is not marked.
            let differs =
                firsts.is_some_and(|firsts| apart(own.as_ref(), firsts[k].as_ref()) && text(own) != text(&firsts[k]));
            let text = text(own);
            format!("{text}{}", if differs { '*' } else { ' ' })
        })
        .collect();
    let observed = scenario.lineage.founders[founder].observed.map_or(String::new(), |observed| {
        let cells = observed.terminal.map_or(String::new(), |cells| cells.to_string());
        format!("{:>6} {cells:>6}", decimals(observed.mean, 2))
    });
    let [chi, mean, min, max, cells] = &texts[..] else { unreachable!("five columns") };
    format!("{:<8} {chi:>22} {mean:>22} {min:>12} {max:>12} {cells:>18}  {observed}", range.name).trim_end().to_owned()
}

/// Whether two ranges differ beyond their spread; one that is there differs from one that is not.
fn apart(own: Option<&Range>, first: Option<&Range>) -> bool {
    match (own, first) {
        (Some(own), Some(first)) => own.is_apart_from(first),
        (own, first) => own.is_some() != first.is_some(),
    }
}

/// The median, and the range where it shows.
fn shown(range: &Range, digits: usize) -> String {
    let [p5, p50, p95] = [range.p5, range.p50, range.p95].map(|number| format!("{number:.digits$}"));
    if p5 == p50 && p95 == p50 { p50 } else { format!("{p50} [{p5}, {p95}]") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_is_shown_where_it_is_wider_than_the_last_digit() {
        let range = |p5, p50, p95| Range { p5, p50, p95 };
        assert_eq!(shown(&range(6.251, 6.25, 6.254), 2), "6.25");
        assert_eq!(shown(&range(6.2, 6.25, 6.9), 2), "6.25 [6.20, 6.90]");
        assert!(apart(Some(&range(1.0, 2.0, 3.0)), Some(&range(3.1, 4.0, 5.0))));
        assert!(!apart(Some(&range(1.0, 2.0, 3.0)), Some(&range(3.0, 4.0, 5.0))));
        assert!(apart(None, Some(&range(1.0, 1.0, 1.0))) && !apart(None, None));
    }
}
