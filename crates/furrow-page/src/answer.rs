//! The form of every answer: a JSON text followed by plain numbers.

use furrow_mechanics::division::DivisionError;
use furrow_mechanics::equilibria::ShapeError;

/// Why there is no answer. The text is for the reader of the page.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PageError {
    /// The request has the wrong form.
    #[error("the request cannot be read: {0}")]
    Request(#[from] serde_json::Error),
    /// A cell lies outside the ranges of the command line.
    #[error(transparent)]
    Refused(#[from] furrow_input::InputError),
    /// A tree cannot be read.
    #[error(transparent)]
    Tree(#[from] furrow_formats::TreeFileError),
    /// A cue cannot be read.
    #[error(transparent)]
    Cue(#[from] furrow_cell::CueError),
    /// A division could not be computed.
    #[error(transparent)]
    Division(#[from] DivisionError),
    /// A curve of thresholds could not be computed.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// A tree could not be grown.
    #[error(transparent)]
    Grow(#[from] furrow_lineage::GrowError),
}

/// A JSON text followed by single-precision numbers, which are exact enough for drawing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Answer {
    /// The JSON text.
    pub text: String,
    /// The numbers, described by the text.
    pub numbers: Vec<f32>,
}

impl Answer {
    /// An answer without numbers.
    pub fn of(text: String) -> Answer {
        Answer { text, numbers: Vec::new() }
    }

    /// The answer to a failed request: `{"error": "…", "refused": …}`, where `refused` says whether the input was bad.
    pub fn refusal(error: &PageError) -> Answer {
        let refused = matches!(error, PageError::Refused(_) | PageError::Cue(_));
        Answer::of(serde_json::json!({ "error": error.to_string(), "refused": refused }).to_string())
    }

    /// As bytes: length of the text and count of the numbers (each a little-endian u32), the text, blanks up to a multiple
    /// of four, the numbers (little-endian f32).
    pub fn bytes(&self) -> Vec<u8> {
        let padding = self.text.len().next_multiple_of(4) - self.text.len();
        let mut out = Vec::with_capacity(8 + self.text.len() + padding + 4 * self.numbers.len());
        for length in [self.text.len() + padding, self.numbers.len()] {
            out.extend_from_slice(&(length as u32).to_le_bytes());
        }
        out.extend_from_slice(self.text.as_bytes());
        out.extend_from_slice(&b"   "[..padding]);
        self.numbers.iter().for_each(|number| out.extend_from_slice(&number.to_le_bytes()));
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_begin_at_a_multiple_of_four() {
        for length in 0..9 {
            let answer = Answer { text: "x".repeat(length), numbers: vec![1.5, -2.0] };
            let bytes = answer.bytes();
            let text = u32::from_le_bytes(bytes[..4].try_into().unwrap()) as usize;
            assert!(text.is_multiple_of(4) && text - length < 4);
            assert_eq!(bytes.len(), 8 + text + 8);
            assert_eq!(bytes[8 + text..8 + text + 4], 1.5f32.to_le_bytes());
        }
    }
}
