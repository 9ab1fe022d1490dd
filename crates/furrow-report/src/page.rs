//! The frame of an interactive page: style, scripts, the solver and its data.
//!
//! The files of `page/` are embedded unchanged, so that a page is one file and needs no network. `furrow-page` builds the
//! solver.

use std::fmt::Write;

use serde_json::{Value, json};

use super::svg::colours;
use furrow_analysis::LineageRanges;
use furrow_cell::{Cell, Numerics, Settings};
use furrow_lineage::{Lineage, TreeSettings};
use furrow_mechanics::critical::Stored;

const STYLE: &str = include_str!("page/page.css");
const LINEAGE: &str = include_str!("page/lineage.html");
const WHAT_IF: &str = include_str!("page/whatif.html");
/// The script of the worker, which runs the solver.
const WORKER: &str = include_str!("page/worker.js");
/// Scripts that the page of a film also uses.
pub const PARTS: &str = include_str!("page/parts.js");
pub const THEME: &str = include_str!("page/theme.js");
pub const PLAYING: &str = include_str!("page/playing.js");
/// In the order of the page, so that definitions precede their use.
const SCRIPTS: [&str; 16] = [
    PARTS,
    include_str!("page/solver.js"),
    include_str!("page/data.js"),
    THEME,
    include_str!("page/paint.js"),
    include_str!("page/save.js"),
    include_str!("page/labels.js"),
    include_str!("page/lineage.js"),
    include_str!("page/walk.js"),
    PLAYING,
    include_str!("page/film.js"),
    include_str!("page/cell.js"),
    include_str!("page/phase.js"),
    concat!(include_str!("page/whatif.js"), include_str!("page/regrow.js")),
    include_str!("page/scenarios.js"),
    include_str!("page/main.js"),
];
/// The solver: its version on the first line, gzipped and in base64 on the second.
const MODULE: &str = include_str!("page/furrow.wasm.txt");

/// A page runs its own scripts and fetches nothing.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline' 'wasm-unsafe-eval'; worker-src blob:; img-src data:";

/// The parts that differ from page to page, as HTML.
pub struct Page {
    /// Title of the document.
    pub title: String,
    /// Heading of the page.
    pub heading: String,
    /// Below the heading.
    pub top: String,
    /// Before the lineage.
    pub above: String,
    /// Replaces the lineage where scripts do not run.
    pub still: String,
    /// At the end.
    pub below: String,
    /// Data of the scripts, as JSON.
    pub data: String,
}

impl Page {
    /// The whole page.
    pub fn html(&self) -> String {
        let Page { title, heading, top, above, still, below, data } = self;
        let main = format!(
            "<p id=\"without-solver\" class=\"card notice\" role=\"status\" hidden></p>\n{above}<div id=\"live\" hidden>\n{LINEAGE}{WHAT_IF}</div>\n<noscript>\n{still}</noscript>\n{below}"
        );
        let texts = [
            ("application/json", "furrow-data", data.as_str()),
            ("text/plain", "furrow-module", MODULE.lines().nth(1).unwrap_or_default()),
            ("text/plain", "furrow-worker", WORKER),
        ];
        document([title, heading, top, &main], &texts, &SCRIPTS)
    }
}

/// A whole page. `main` is its content and `top` is below the heading; `texts` are data elements, as type, name and text.
pub fn document([title, heading, top, main]: [&str; 4], texts: &[(&str, &str, &str)], scripts: &[&str]) -> String {
    let content = main.len() + texts.iter().map(|(.., text)| text.len()).sum::<usize>();
    let mut out = String::with_capacity(content + 200_000);
    let _ = write!(
        out,
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\"><link rel=\"icon\" href=\"data:,\"><title>{title}</title>\n<style>\n{STYLE}</style></head><body>\n\
         <header class=\"top\"><div class=\"grow\"><h1>{heading}</h1>\n{top}</div><button id=\"theme\" type=\"button\" hidden>Dark</button></header>\n<main>\n{main}</main>\n"
    );
    for (kind, id, text) in texts {
        let _ = writeln!(out, "<script type=\"{kind}\" id=\"{id}\">{text}</script>");
    }
    out.push_str("<script>\n\"use strict\";\n(() => {\n");
    scripts.iter().for_each(|script| out.push_str(script));
    out.push_str("})();\n</script>\n</body></html>\n");
    out
}

/// The edge of division that the page begins with, at one ε: pitchforks (R0, ξ_s, coefficient of the normal form). Null
/// for cells whose parameters differ from the stored preset's in more than ε and ξ_s.
fn edge(cell: &Cell, numerics: &Numerics) -> Value {
    let Cell { epsilon, xi_s, .. } = Cell::new(1.0);
    let Ok(stored) = Stored::preset(&Cell { epsilon, xi_s, ..cell.clone() }, numerics) else { return Value::Null };
    let points: Vec<_> = stored.pitchfork.iter().map(|p| (p.r0, p.xi_s, p.coefficient)).collect();
    json!({ "epsilon": epsilon, "points": points })
}

/// A tree of the page.
pub struct Shown<'a> {
    /// Its name beside other trees; empty for a single tree.
    pub name: &'a str,
    /// Its lineage and cue.
    pub made: String,
    /// Colours of its founders.
    pub colours: Vec<&'static str>,
    /// Its `tree.json`.
    pub tree: String,
    /// Its ranges over seeds, if several were run.
    pub spread: Option<&'a LineageRanges>,
}

/// Data of the scripts, as JSON: parameters of all divisions, from which the page grows trees, colours of founders, the edge of
/// division, the preset's settings, and the trees: the text of `tree.json` of the first under `tree`, of the others under `others`.
pub fn data(lineage: &Lineage, settings: &TreeSettings, shown: &[Shown<'_>]) -> String {
    let TreeSettings { cell, numerics, seed, r0_step } = settings;
    let head = json!({ "lineage": lineage, "cell": cell, "numerics": numerics, "seed": seed, "r0_step": r0_step });
    let usual = Settings::default();
    let names = shown.iter().map(|Shown { name, made, colours, spread, .. }| {
        json!({ "name": name, "made": made, "colours": colours, "spread": spread.map(|spread| &spread.founders) })
    });
    let told = json!({
        "head": head,
        "colours": colours(lineage),
        "edge": edge(cell, numerics),
        "preset": { "cell": usual.cell, "numerics": usual.numerics },
        "scenarios": names.collect::<Vec<_>>(),
    });
    let told = told.to_string();
    let (tree, others) = match shown {
        [] => ("null", &[][..]),
        [first, others @ ..] => (first.tree.as_str(), others),
    };
    let others = others.iter().map(|shown| shown.tree.as_str()).collect::<Vec<_>>().join(",");
    // The texts are joined into one object without parsing them again. `<` is escaped, since a name could close the
    // script element.
    let told = told.strip_suffix('}').unwrap_or_default();
    format!("{told},\"tree\":{tree},\"others\":[{others}]}}").replace('<', "\\u003c")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_name_closes_the_script_element_of_the_data() {
        let mut lineage = Lineage::c_elegans().unwrap();
        lineage.name = "</script><script>alert(1)".to_owned();
        let text = data(&lineage, &TreeSettings::default(), &[]);
        assert!(!text.contains('<'));
        let read: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(read["head"]["lineage"]["name"], lineage.name);
        assert!(read["tree"].is_null() && read["edge"]["points"].as_array().unwrap().len() > 10);
    }

    #[test]
    fn other_constants_have_no_stored_edge() {
        let numerics = Numerics::default();
        let mut cell = Cell { epsilon: 0.7, ..Cell::new(3.0) };
        assert!(!edge(&cell, &numerics).is_null());
        cell.shell.aspect = 1.3;
        assert!(edge(&cell, &numerics).is_null());
    }

    #[test]
    fn no_script_closes_its_own_element() {
        for script in SCRIPTS.iter().chain([&WORKER]) {
            assert!(!script.contains("</script") && !script.contains("<!--"));
        }
        assert!(MODULE.lines().count() == 2 && MODULE.lines().nth(1).is_some_and(|text| text.starts_with("H4sI")));
    }
}
