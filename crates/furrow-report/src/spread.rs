//! Numbers of founders over many seeds of the noise, for the table of text and the page.

use furrow_analysis::{FounderRange, LineageRanges, Range};

/// Decimals of each column of [`SCENARIO`](super::observed_table::SCENARIO).
const DIGITS: [usize; 5] = [0, 2, 0, 3, 0];

/// The columns of [`SCENARIO`](super::observed_table::SCENARIO) of a founder; `None` without such a number.
pub fn columns(spread: Option<&LineageRanges>, founder: &str) -> [Option<Range>; 5] {
    let found = spread.and_then(|spread| spread.founders.iter().find(|row| row.name == founder));
    let Some(FounderRange { rounds, chi, cells, .. }) = found else { return [None; 5] };
    let rounds = rounds.as_ref();
    [rounds.map(|r| r.min), rounds.map(|r| r.mean), rounds.map(|r| r.max), *chi, *cells]
}

/// The 5 % quantile, the median and the 95 % quantile of a column as printed.
pub fn texts(range: &Range, column: usize) -> [String; 3] {
    [range.p5, range.p50, range.p95].map(|number| format!("{number:.0$}", DIGITS[column]))
}

/// Whether a column differs from the first scenario's beyond the spread of both. Values that print alike do not differ.
pub fn differs(own: &Range, first: &Range, column: usize) -> bool {
    own.is_apart_from(first) && texts(own, column) != texts(first, column)
}
