//! The paper reproduced, as a page of Markdown and as lines for a terminal.

use std::fmt::Write;

use furrow_analysis::reproduce::{Item, Reproduction, Verdict};
use serde_json::Value;

/// An empty cell of the table.
const NOTHING: &str = "-";

/// The page that ships as `docs/reproduction.md`, of the constants that `constants` names. It has no times: equal inputs give
/// equal bytes.
pub fn markdown(found: &Reproduction, constants: &str) -> String {
    let mut out = format!("{HEAD}\n{}\n", counts(found, constants));
    out.push_str("\n| figure | quantity | paper | furrow | published scheme | off by | verdict |\n|---|---|---|---|---|---|---|\n");
    for item in &found.items {
        out.push_str(&row(item));
    }
    out.push_str("\n## Criteria and notes\n\n");
    for group in found.items.chunk_by(|a, b| a.figure == b.figure) {
        for item in group {
            let _ = write!(out, "- **{}**, {}: ", figure(item), item.quantity);
            let judged = if item.criterion == "none" { "nothing is judged" } else { item.criterion.as_str() };
            let note = item.note.as_ref().map_or(String::new(), |note| format!(". {}", capital(note)));
            let _ = writeln!(out, "{judged}{note}.");
        }
    }
    out
}

const HEAD: &str = "# The paper, reproduced

The statements of the paper (Gao, Guan, Tang & Ma) and the results of furrow. `furrow reproduce --table docs/reproduction.md`
writes this page; `furrow reproduce --out DIR` also draws the figures. Single rows can be computed too, as with
`furrow reproduce 2C S5`.

*furrow* is the converged result. *Published scheme* is the result of backward Euler at Δt = 0.1 τ, the paper's kind of time step,
for rows that follow divisions in time; the paper does not print its Δt. A note says if only one of the two agrees, or neither. A
row **agrees** if a printed number is met to the tolerance below, or if a statement in words is true by the criterion below, which
is ours. It is **not pinned down** if the paper's statement is not known here or is not specific enough: the result is given and
not judged. The paper does not print the constants of the shell; they are fitted to its four thresholds only.
";

fn counts(found: &Reproduction, constants: &str) -> String {
    let [agrees, differs, open] =
        [Verdict::Agrees, Verdict::Differs, Verdict::NotPinnedDown].map(|verdict| found.count(verdict));
    format!(
        "With the constants `{constants}`: {agrees} statements agree, {differs} differ, {open} are not pinned down."
    )
}

/// The row of a statement in the table.
pub fn row(item: &Item) -> String {
    let verdict = match item.verdict {
        Verdict::Differs => "**differs**".to_owned(),
        verdict => verdict.to_string(),
    };
    let cells = [
        figure(item),
        item.quantity.clone(),
        value(item.paper.as_ref()),
        value(Some(&item.computed)),
        published(item),
        item.rel_error.map_or(NOTHING.to_owned(), off_by),
        verdict,
    ];
    format!("| {} |\n", cells.map(|cell| cell.replace('|', "\\|")).join(" | "))
}

/// The result of the published scheme, and whether it agrees where the converged result does not.
fn published(item: &Item) -> String {
    let told = match (item.verdict, item.published_scheme_agrees) {
        (Verdict::Differs, Some(true)) => " (agrees)",
        (Verdict::Differs | Verdict::Agrees, Some(false)) => " (differs)",
        _ => "",
    };
    format!("{}{told}", value(item.published_scheme.as_ref()))
}

/// A figure as it is printed: panels from one to another.
fn figure(item: &Item) -> String {
    item.figure.replace('-', "–")
}

/// Text with a capital at its beginning; symbols stay as they are.
fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| std::iter::once(first.to_ascii_uppercase()).chain(letters).collect())
}

/// A number to five digits, or words.
pub fn value(value: Option<&Value>) -> String {
    let Some(number) = value.and_then(Value::as_f64) else {
        return value.and_then(Value::as_str).unwrap_or(NOTHING).to_owned();
    };
    let digits = if number == 0.0 { 0 } else { 4 - number.abs().log10().floor() as i32 };
    let text = format!("{number:.*}", digits.clamp(0, 12) as usize);
    let short = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    short.replace('-', "−")
}

/// A relative error in percent, to two digits.
fn off_by(error: f64) -> String {
    let percent = 100.0 * error;
    let digits = (1 - percent.log10().floor() as i32).clamp(0, 9) as usize;
    if error == 0.0 { "0".to_owned() } else { format!("{percent:.digits$} %") }
}

/// Lines for a terminal.
pub fn text(found: &Reproduction, constants: &str) -> String {
    let mut out = String::new();
    for group in found.items.chunk_by(|a, b| a.figure == b.figure) {
        let Some(first) = group.first() else { continue };
        let _ = writeln!(out, "{} ({:.1} s)", figure(first), first.seconds);
        for item in group {
            let _ = writeln!(out, "  {:<16} {}", item.verdict.to_string(), item.quantity);
            let paper = item.paper.as_ref().map_or("not known".to_owned(), |paper| value(Some(paper)));
            let _ = writeln!(out, "{:19}paper: {paper}", "");
            let off = item.rel_error.map_or(String::new(), |error| format!(" (off by {})", off_by(error)));
            let _ = writeln!(out, "{:19}furrow: {}{off}", "", value(Some(&item.computed)));
            if item.published_scheme.is_some() {
                let _ = writeln!(out, "{:19}published scheme: {}", "", published(item));
            }
        }
    }
    let _ = writeln!(out, "{}", counts(found, constants));
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_five_digits_and_errors_two() {
        let shown = |number: f64| value(Some(&number.into()));
        assert_eq!(
            [25.796_83, 0.5, -2.5, 0.0, 4.0, 0.895_398, 20_890.4].map(shown),
            ["25.797", "0.5", "−2.5", "0", "4", "0.8954", "20890"]
        );
        assert_eq!([0.0, 0.002_31, 0.045, 3.0e-5].map(off_by), ["0", "0.23 %", "4.5 %", "0.0030 %"]);
        assert_eq!(value(None), "-");
        assert_eq!([capital("ε is"), capital("it is")], ["ε is", "It is"]);
    }
}
