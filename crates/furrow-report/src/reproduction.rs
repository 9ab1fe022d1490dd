//! The paper reproduced, as a page of Markdown and as lines for a terminal.

use std::fmt::Write;

use furrow_analysis::reproduce::{Artifact, Item, NamedArtifact, Reproduction, Verdict};
use furrow_analysis::table::{csv_text, records_csv};
use furrow_formats::files::{FileSet, WriteError};
use serde_json::Value;

/// An empty cell of the table.
const NOTHING: &str = "-";

/// The page that ships as `docs/reproduction.md`, for the named constants. It contains no times, so that equal inputs
/// give equal bytes.
pub fn markdown(found: &Reproduction, constants: &str) -> String {
    let mut out = format!("{HEAD}\n{}\n", counts(found, constants));
    let without_axis = found.items.iter().any(|item| item.without_axis.is_some());
    let (column, rule) = if without_axis { (" without the axis |", "---|") } else { ("", "") };
    let _ =
        writeln!(out, "\n| figure | quantity | paper | furrow | Δt = 0.1 τ | Δt = 0.01 τ | off by | verdict |{column}");
    let _ = writeln!(out, "|---|---|---|---|---|---|---|---|{rule}");
    for item in &found.items {
        out.push_str(&row(item));
        if without_axis {
            // After the bar that ends the row.
            out.truncate(out.trim_end().len());
            let _ = writeln!(out, " {} |", beyond(item).replace('|', "\\|"));
        }
    }
    out.push_str("\n## Criteria and notes\n\n");
    for group in found.items.chunk_by(|a, b| a.figure == b.figure) {
        for item in group {
            let _ = write!(out, "- **{}**, {}: ", item.figure, item.quantity);
            let note = item.note.as_ref().map_or(String::new(), |note| format!(". {}", capital(note)));
            let _ = match item.verdict {
                Verdict::Apart => writeln!(out, "not judged{note}."),
                _ => writeln!(out, "{}{note}.", item.criterion),
            };
        }
    }
    out
}

const HEAD: &str = "# The paper, reproduced

The statements of the paper (Gao, Guan, Tang & Ma) and the results of furrow. `furrow reproduce --table docs/reproduction.md`
writes this page; `furrow reproduce --out DIR` also draws the figures. Single rows can be computed too, as with
`furrow reproduce 2C S5`.

*furrow* is the converged result. The two columns of Δt are the results of the paper's kind of time step, backward Euler with noise
for one step, where divisions are followed in time; the paper does not print its Δt. A row **agrees** if a printed number is met to
the tolerance below, or if a statement in words is true by the criterion below, which is ours. What is **set apart** is not judged
and not counted; its note says why. The paper does not print the constants of the shell: they are chosen by its statements
(`furrow calibrate data/statements.ron`).
";

fn counts(found: &Reproduction, constants: &str) -> String {
    let [agrees, differs, apart] =
        [Verdict::Agrees, Verdict::Differs, Verdict::Apart].map(|verdict| found.count(verdict));
    format!("With the constants `{constants}`: {agrees} statements agree, {differs} differ; {apart} are set apart.")
}

/// The row of a statement in the table.
pub fn row(item: &Item) -> String {
    let verdict = match item.verdict {
        Verdict::Differs => "**differs**".to_owned(),
        verdict => verdict.to_string(),
    };
    let cells = [
        item.figure.clone(),
        item.quantity.clone(),
        value(&item.paper),
        value(&item.computed),
        published(item, item.published_scheme.as_deref(), item.published_scheme_agrees),
        published(item, item.published_fine.as_deref(), item.published_fine_agrees),
        item.rel_error.map_or(NOTHING.to_owned(), off_by),
        verdict,
    ];
    format!("| {} |\n", cells.map(|cell| cell.replace('|', "\\|")).join(" | "))
}

/// The result without axial symmetry, with a note if its agreement with the paper differs from the other's.
fn beyond(item: &Item) -> String {
    published(item, item.without_axis.as_ref().map(value).as_deref(), item.without_axis_agrees)
}

/// A result of the published scheme, with a note if its agreement with the paper differs from the converged result's.
fn published(item: &Item, computed: Option<&str>, agrees: Option<bool>) -> String {
    let verdict = match agrees {
        Some(true) if !item.pass => " (agrees)",
        Some(false) if item.pass => " (differs)",
        _ => "",
    };
    format!("{}{verdict}", computed.unwrap_or(NOTHING))
}

/// Text with its first letter capitalised; symbols are unchanged.
fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| std::iter::once(first.to_ascii_uppercase()).chain(letters).collect())
}

/// A number to five digits, or text.
pub fn value(value: &Value) -> String {
    let Some(number) = value.as_f64() else { return value.as_str().unwrap_or(NOTHING).to_owned() };
    let digits = if number == 0.0 { 0 } else { 4 - number.abs().log10().floor() as i32 };
    let text = format!("{number:.*}", digits.clamp(0, 12) as usize);
    let short = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    short.replace('-', "−")
}

/// A relative error in percent, to two digits.
fn off_by(error: f64) -> String {
    if error == 0.0 {
        return "0".to_owned();
    }
    let percent = 100.0 * error;
    let digits = (1 - percent.log10().floor() as i32).clamp(0, 9) as usize;
    format!("{percent:.digits$} %")
}

/// Lines for a terminal.
pub fn text(found: &Reproduction, constants: &str) -> String {
    let mut out = String::new();
    for group in found.items.chunk_by(|a, b| a.figure == b.figure) {
        let Some(first) = group.first() else { continue };
        let _ = writeln!(out, "{} ({:.1} s)", first.figure, first.seconds);
        for item in group {
            let _ = writeln!(out, "  {:<16} {}", item.verdict.to_string(), item.quantity);
            let _ = writeln!(out, "{:19}paper: {}", "", value(&item.paper));
            let off = item.rel_error.map_or(String::new(), |error| format!(" (off by {})", off_by(error)));
            let _ = writeln!(out, "{:19}furrow: {}{off}", "", value(&item.computed));
            let published = [
                ("0.1", &item.published_scheme, item.published_scheme_agrees),
                ("0.01", &item.published_fine, item.published_fine_agrees),
            ];
            for (dt, computed, agrees) in published.into_iter().filter(|(_, computed, _)| computed.is_some()) {
                let _ = writeln!(out, "{:19}Δt = {dt} τ: {}", "", self::published(item, computed.as_deref(), agrees));
            }
            if item.without_axis.is_some() {
                let _ = writeln!(out, "{:19}without the axis: {}", "", beyond(item));
            }
        }
    }
    let _ = writeln!(out, "{}", counts(found, constants));
    out
}

/// The columns of results.csv.
const HEADER: &str =
    "figure,id,quantity,paper,computed,published_scheme,published_fine,rel_error,pass,verdict,criterion,note,seconds";

/// Files other than pictures and tables of panels.
pub const FILES: [&str; 3] = ["reproduction.md", "reproduce.json", "results.csv"];

/// Stages the page, the document, the table of all statements, and a picture of every panel, with a table if the panel
/// is drawn from many cells. `draw` returns the bytes of a picture; picture files end in `extension`.
///
/// # Errors
/// A picture cannot be drawn or a file cannot be written.
pub fn stage<E: From<WriteError> + From<serde_json::Error>>(
    files: &mut FileSet,
    found: &Reproduction,
    (page, json): (&str, &str),
    extension: &str,
    draw: impl Fn(&NamedArtifact) -> Result<Vec<u8>, E>,
) -> Result<(), E> {
    files.stage("reproduction.md", page.as_bytes())?;
    files.stage("reproduce.json", json.as_bytes())?;
    files.stage("results.csv", &records_csv(HEADER, &found.items)?)?;
    for panel in &found.panels {
        files.stage(&format!("{}.{extension}", panel.name), &draw(panel)?)?;
        if let Some(table) = table(panel)? {
            files.stage(&format!("{}.csv", panel.name), &table)?;
        }
    }
    Ok(())
}

/// The table of a panel that is drawn from many cells.
fn table(panel: &NamedArtifact) -> Result<Option<Vec<u8>>, serde_json::Error> {
    Ok(match &panel.artifact {
        Artifact::Sweep(sweep, rows) => Some(csv_text(&sweep.columns(), rows).into_bytes()),
        Artifact::Map(map) => Some(records_csv("x,xi_s,outcome,chi,by", &map.diagram.cells)?),
        Artifact::Perturbations(_, watched) => {
            let rows =
                watched.iter().flat_map(|(shape, found)| found.distances.iter().map(move |[t, dis]| (shape, t, dis)));
            Some(records_csv("shape,t,dis", rows)?)
        }
        _ => None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_five_digits_and_errors_two() {
        let shown = |number: f64| value(&number.into());
        assert_eq!(
            [25.796_83, 0.5, -2.5, 0.0, 4.0, 0.895_398, 20_890.4].map(shown),
            ["25.797", "0.5", "−2.5", "0", "4", "0.8954", "20890"]
        );
        assert_eq!([0.0, 0.002_31, 0.045, 3.0e-5].map(off_by), ["0", "0.23 %", "4.5 %", "0.0030 %"]);
        assert_eq!(value(&Value::Null), "-");
        assert_eq!([capital("ε is"), capital("it is")], ["ε is", "It is"]);
    }
}
