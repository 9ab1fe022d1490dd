//! Formulas: LaTeX, as it is written in the chapters, to MathML.

use pulldown_latex::config::{DisplayMode, RenderConfig};
use pulldown_latex::{Parser, Storage, push_mathml};

use crate::BookError;

/// MathML of a formula, on one line; `display` gives it a line of its own.
///
/// # Errors
/// What is no LaTeX, and what the converter makes no proper MathML of, as of `\big`.
pub fn mathml(latex: &str, display: bool) -> Result<String, BookError> {
    let wrong = |why: String| BookError::Formula { latex: latex.trim().to_owned(), why };
    let storage = Storage::new();
    let mut events = Vec::new();
    for event in Parser::new(latex, &storage) {
        events.push(event.map_err(|error| wrong(error.to_string()))?);
    }
    let mut out = String::new();
    let display_mode = if display { DisplayMode::Block } else { DisplayMode::Inline };
    let config = RenderConfig { display_mode, ..RenderConfig::default() };
    let events = events.into_iter().map(Ok::<_, std::convert::Infallible>);
    push_mathml(&mut out, events, config).map_err(|error| wrong(error.to_string()))?;
    if !attributes_are_apart(&out) {
        return Err(wrong("its MathML is broken; write it in other words".to_owned()));
    }
    // Markdown would end a block of HTML at an empty line, and signs of order are written as they are.
    Ok(out.replace('\n', " ").replace("><</", ">&lt;</"))
}

/// Whether a blank or the end of a tag follows each attribute.
fn attributes_are_apart(html: &str) -> bool {
    html.split("=\"").skip(1).all(|rest| {
        let behind = rest.split_once('"').map_or("", |(_, behind)| behind);
        behind.starts_with([' ', '/', '>'])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_become_mathml_and_mistakes_are_told() {
        let block = mathml(r"\frac{1}{2}\kappa\,C^2", true).unwrap();
        assert!(block.contains("display=\"block\"") && block.contains("<mfrac>") && block.contains('κ'), "{block}");
        assert!(mathml(r"\big[ a \big]", false).unwrap_err().to_string().contains("broken"));
        assert!(mathml("a < b", false).unwrap().contains("&lt;"));
        assert!(!mathml("a\n+ b", false).unwrap().contains('\n'));
        let said = mathml(r"\frac{1}{", false).unwrap_err().to_string();
        assert!(said.starts_with(r"the formula \frac{1}{: "), "{said}");
    }
}
