//! The font of all pictures: widths of text, subscripts, line breaks.

use ttf_parser::Face;

/// DejaVu Sans, without the scripts that the names of quantities and cells do not need (`fonts/README.md`).
pub(super) const FONT: &[u8] = include_bytes!("../../fonts/DejaVuSans.ttf");
/// Size of a subscript, and its distance below the base line, as shares of the text's size.
pub(super) const INDEX: f64 = 0.7;
pub(super) const DROP: f64 = 0.2;
/// Width of the outline that makes text bold, as a share of its size.
pub(super) const BOLD: f32 = 0.05;

pub(super) fn face() -> Option<Face<'static>> {
    Face::parse(FONT, 0).ok()
}

/// A part of a text, set either as a subscript or normally.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Run {
    pub(super) letters: String,
    pub(super) index: bool,
}

/// A text in parts. Unicode's subscripts (ξₛ, R₀) become letters to be set smaller and lower: few fonts have all of
/// them, and those fonts draw them in different sizes.
pub(super) fn runs(content: &str) -> Vec<Run> {
    let mut found: Vec<Run> = Vec::new();
    for letter in content.chars() {
        let (letter, index) = base(letter).map_or((letter, false), |base| (base, true));
        match found.last_mut() {
            Some(run) if run.index == index => run.letters.push(letter),
            _ => found.push(Run { letters: letter.to_string(), index }),
        }
    }
    found
}

/// The letter or digit of a subscript character.
fn base(letter: char) -> Option<char> {
    const INDICES: [(&str, &str); 2] = [("₀₁₂₃₄₅₆₇₈₉", "0123456789"), ("ₐₑₒₓₕₖₗₘₙₚₛₜ", "aeoxhklmnpst")];
    let pairs = INDICES.into_iter().flat_map(|(indices, letters)| indices.chars().zip(letters.chars()));
    pairs.into_iter().find_map(|(index, plain)| (index == letter).then_some(plain))
}

/// The width of a text at a font size.
pub fn width(content: &str, size: u32) -> f64 {
    let Some(face) = face() else { return 0.0 };
    let advance = |letter: char| {
        let glyph = face.glyph_index(letter).unwrap_or_default();
        f64::from(face.glyph_hor_advance(glyph).unwrap_or(0))
    };
    let of = |run: &Run| run.letters.chars().map(advance).sum::<f64>() * if run.index { INDEX } else { 1.0 };
    runs(content).iter().map(of).sum::<f64>() * f64::from(size) / f64::from(face.units_per_em())
}

/// A text broken into lines of at most the given width, after spaces or, within cues, after commas and plus signs.
pub fn wrapped(content: &str, size: u32, most: f64) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in content.split_inclusive([' ', ',', '+']) {
        let line = lines.last().map_or("", String::as_str);
        if !line.is_empty() && width(&format!("{line}{}", word.trim_end()), size) > most {
            lines.push(String::new());
        }
        lines.iter_mut().last().into_iter().for_each(|line| line.push_str(word));
    }
    lines.iter().map(|line| line.trim_end().to_owned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn subscripts_are_separate_and_narrower() {
        let parts = runs("R₀ of ξₛ₁");
        let indices: Vec<&str> = parts.iter().filter(|run| run.index).map(|run| run.letters.as_str()).collect();
        assert_eq!(indices, ["0", "s1"]);
        assert!((width("ₛ", 100) / width("s", 100) - INDEX).abs() < 1e-12 && width("s", 100) > 40.0);
    }

    #[test]
    fn long_cues_break_where_a_reader_would() {
        let cue = "cue tension:gradient,amplitude=0.3+kappa:band,u0=0.465,omega=0.0577,amplitude=0.1: χ = 0.1";
        let lines = wrapped(cue, 20, 400.0);
        assert!(lines.len() > 2 && lines.iter().all(|line| width(line, 20) <= 400.0), "{lines:?}");
        assert_eq!(lines.concat().replace(' ', ""), cue.replace(' ', ""));
        assert!(lines[..lines.len() - 1].iter().all(|line| line.ends_with([',', '+', ' ', '=']) || line.len() > 20));
        // A single word that is too long is not broken.
        assert_eq!(wrapped("Caenorhabditis", 20, 10.0), ["Caenorhabditis"]);
    }
}
