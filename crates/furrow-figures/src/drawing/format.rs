//! Pictures as files.

use std::path::Path;

use super::canvas::Canvas;

/// Pixels of a PNG for each unit of the canvas.
const DENSITY: f32 = 2.0;

/// Why a picture could not be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FigureError {
    /// It has more pixels than fit into memory, or none.
    #[error("a picture of {} × {} cannot be drawn as pixels", .0[0], .0[1])]
    Size([f64; 2]),
    /// A PNG could not be written.
    #[error(transparent)]
    Png(#[from] png::EncodingError),
    /// A GIF could not be written.
    #[error(transparent)]
    Gif(#[from] gif::EncodingError),
}

/// The file format of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Lines and text, at any size.
    Svg,
    /// Pixels.
    Png,
}

impl Format {
    /// The format that a file's extension names, in any case; `None` if that is neither `.svg` nor `.png`.
    pub fn of(path: &Path) -> Option<Format> {
        match extension(path)?.as_str() {
            "svg" => Some(Format::Svg),
            "png" => Some(Format::Png),
            _ => None,
        }
    }
}

/// The extension of a file, in lower case.
pub(crate) fn extension(path: &Path) -> Option<String> {
    Some(path.extension()?.to_str()?.to_ascii_lowercase())
}

impl Canvas {
    /// The picture as a file of a format.
    ///
    /// # Errors
    /// [`FigureError`], for PNG alone.
    pub fn bytes(&self, format: Format) -> Result<Vec<u8>, FigureError> {
        match format {
            Format::Svg => Ok(self.svg().into_bytes()),
            Format::Png => {
                let (pixels, [width, height]) = self.pixels(DENSITY).ok_or(FigureError::Size(self.size))?;
                let mut bytes = Vec::new();
                let mut encoder = png::Encoder::new(&mut bytes, width, height);
                encoder.set_color(png::ColorType::Rgb);
                encoder.write_header()?.write_image_data(&pixels)?;
                Ok(bytes)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Anchor, Stroke, style::INK};
    use super::*;

    #[test]
    fn an_svg_and_a_png_show_the_same() {
        let mut canvas = Canvas::new(40.0, 20.0);
        canvas.clipped([0.0, 0.0, 20.0, 20.0], |canvas| canvas.rectangle([10.0, 0.0], [20.0, 20.0], [255, 0, 0], 1.0));
        canvas.polyline(&[[0.0, 5.000000001], [10.0, 5.0]], Stroke::dashed([0, 0, 255], 4.0, [5.0, 5.0]));
        canvas.text([0.0, 10.0], "a < b & c", 8, Anchor::Start, INK);
        let svg = canvas.svg();
        assert!(svg.contains("M0 5L10 5\"") && svg.contains(">a &lt; b &amp; c</text>"), "{svg}");
        assert!(svg.contains("viewBox=\"0 0 20 20\"") && svg.contains("stroke-dasharray=\"5 5\""), "{svg}");
        let (pixels, [width, height]) = canvas.pixels(2.0).unwrap();
        assert_eq!([width, height], [80, 40]);
        let pixel = |x: usize, y: usize| &pixels[3 * (x * 2 + 80 * 2 * y)..][..3];
        assert_eq!([pixel(15, 15), pixel(25, 15)], [[255, 0, 0], [255; 3]]);
        assert_eq!([pixel(2, 5), pixel(8, 5)], [[0, 0, 255], [255; 3]]);
        assert!(pixels.chunks_exact(3).any(|pixel| pixel == INK), "the text is not drawn");
    }

    #[test]
    fn formats_follow_the_extension_in_any_case() {
        for (name, format) in
            [("a/b.SVG", Some(Format::Svg)), ("x.y.png", Some(Format::Png)), ("svg", None), ("a.pdf", None)]
        {
            assert_eq!(Format::of(Path::new(name)), format);
        }
    }
}
