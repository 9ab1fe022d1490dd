//! What the book has to know of Markdown: headings, links, formulas, and where they stand.

use std::ops::Range;

use pulldown_cmark::{CodeBlockKind, Event, Options, Parser, Tag, TagEnd};

/// A heading.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Heading {
    /// 1 for a title, 2 for a section and so on.
    pub level: usize,
    /// Its text, without marks.
    pub text: String,
    /// Its anchor: lower case, blanks as `-`, nothing but letters, digits, `-` and `_`.
    pub anchor: String,
    /// Where it stands in the text.
    pub place: Range<usize>,
}

/// A piece of a text that the book changes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Mark {
    /// The destination of a link or picture.
    Link(String),
    /// A formula within a line.
    Inline(String),
    /// A formula of its own.
    Display(String),
    /// Text that is neither code nor part of a link or heading.
    Words(String),
}

fn parser(text: &str) -> pulldown_cmark::OffsetIter<'_> {
    Parser::new_ext(text, Options::ENABLE_TABLES | Options::ENABLE_MATH).into_offset_iter()
}

/// The anchor that a heading has.
pub fn anchor(text: &str) -> String {
    let kept = text.trim().to_lowercase().replace(' ', "-");
    kept.chars().filter(|c| c.is_alphanumeric() || ['-', '_'].contains(c)).collect()
}

/// The headings of a text, in order.
pub fn headings(text: &str) -> Vec<Heading> {
    let mut found: Vec<Heading> = Vec::new();
    let mut inside = false;
    for (event, place) in parser(text) {
        match event {
            Event::Start(Tag::Heading { level, .. }) => {
                inside = true;
                found.push(Heading { level: level as usize, text: String::new(), anchor: String::new(), place });
            }
            Event::End(TagEnd::Heading(_)) => {
                inside = false;
                if let Some(last) = found.last_mut() {
                    last.anchor = anchor(&last.text);
                }
            }
            Event::Text(words) | Event::Code(words) if inside => {
                if let Some(last) = found.last_mut() {
                    last.text.push_str(&words);
                }
            }
            _ => {}
        }
    }
    found
}

/// The section below a heading with the heading itself, up to the next one of its level or above.
pub fn section<'t>(text: &'t str, anchor: &str) -> Option<&'t str> {
    let headings = headings(text);
    let at = headings.iter().position(|heading| heading.anchor == anchor)?;
    let first = headings.get(at)?;
    let end = headings.iter().skip(at + 1).find(|heading| heading.level <= first.level);
    text.get(first.place.start..end.map_or(text.len(), |heading| heading.place.start))
}

/// What the book changes, with its places, in order.
pub fn marks(text: &str) -> Vec<(Mark, Range<usize>)> {
    let mut found = Vec::new();
    let (mut code, mut depth) = (false, 0_usize);
    for (event, place) in parser(text) {
        match event {
            Event::Start(Tag::CodeBlock(CodeBlockKind::Fenced(_) | CodeBlockKind::Indented)) => code = true,
            Event::End(TagEnd::CodeBlock) => code = false,
            Event::Start(Tag::Link { dest_url, .. } | Tag::Image { dest_url, .. }) => {
                found.push((Mark::Link(dest_url.into_string()), place));
                depth += 1;
            }
            Event::Start(Tag::Heading { .. }) => depth += 1,
            Event::End(TagEnd::Link | TagEnd::Image | TagEnd::Heading(_)) => depth = depth.saturating_sub(1),
            Event::InlineMath(latex) => found.push((Mark::Inline(latex.into_string()), place)),
            Event::DisplayMath(latex) => found.push((Mark::Display(latex.into_string()), place)),
            Event::Text(words) if !code && depth == 0 => found.push((Mark::Words(words.into_string()), place)),
            _ => {}
        }
    }
    found
}

/// The text with every heading moved `up` levels towards the title.
pub fn promoted(text: &str, up: usize) -> String {
    let mut out = text.to_owned();
    for heading in headings(text).into_iter().rev() {
        let marks = heading.level.min(up + 1) - 1;
        let start = heading.place.start;
        if marks > 0 && text.get(start..).is_some_and(|rest| rest.starts_with('#')) {
            out.replace_range(start..start + marks.min(up), "");
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "# A title\n\n## Trees & `code`\none\n\n### Below\ntwo\n```sh\n## no heading, [no](link)\n```\n## Last\nthree\n";

    #[test]
    fn headings_have_anchors_and_code_has_none() {
        let found: Vec<_> = headings(TEXT).into_iter().map(|heading| (heading.level, heading.anchor)).collect();
        let expected = [(1, "a-title"), (2, "trees--code"), (3, "below"), (2, "last")];
        assert_eq!(found, expected.map(|(level, anchor)| (level, anchor.to_owned())));
    }

    #[test]
    fn a_section_ends_before_the_next_of_its_level() {
        let found = section(TEXT, "trees--code").unwrap();
        assert!(found.starts_with("## Trees") && found.contains("two") && !found.contains("Last"), "{found}");
        assert_eq!(section(TEXT, "nothing"), None);
        assert!(promoted(found, 1).starts_with("# Trees") && promoted(found, 1).contains("\n## Below"));
        assert!(promoted(found, 1).contains("\n## no heading"));
    }

    #[test]
    fn links_and_formulas_are_found_outside_code() {
        let text = "[a](b.md) and $x_1$ `[c](d)` ![p](e.svg)\n\n$$ y $$\n\n```\n$ z [f](g)\n```\n";
        let found: Vec<Mark> = marks(text).into_iter().map(|(mark, _)| mark).collect();
        let of = |mark: &Mark| found.iter().filter(|found| *found == mark).count();
        assert_eq!(of(&Mark::Link("b.md".into())) + of(&Mark::Link("e.svg".into())), 2);
        assert_eq!(found.iter().filter(|mark| matches!(mark, Mark::Link(_))).count(), 2);
        assert_eq!((of(&Mark::Inline("x_1".into())), of(&Mark::Display(" y ".into()))), (1, 1));
    }
}
