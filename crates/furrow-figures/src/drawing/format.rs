//! Pictures as files.

use std::path::Path;

use super::canvas::Canvas;

/// Pixels of a PNG for each unit of the canvas.
const DENSITY: f32 = 2.0;
/// Units of the canvas in an inch, as in SVG.
const INCH: f32 = 96.0;

/// Why a picture could not be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FigureError {
    /// It has no pixels or more than fit into memory, or, in a PDF, the font cannot be read.
    #[error("a picture of {} × {} cannot be drawn as pixels", .0[0], .0[1])]
    Size([f64; 2]),
    /// A PNG could not be written.
    #[error(transparent)]
    Png(#[from] png::EncodingError),
    /// A GIF could not be written.
    #[error(transparent)]
    Gif(#[from] gif::EncodingError),
    /// A surface is not closed.
    #[error(transparent)]
    Surface(#[from] furrow_formats::surface::SurfaceError),
}

/// The file format of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Lines and text, at any size.
    Svg,
    /// Pixels.
    Png,
    /// One page, with searchable text.
    Pdf,
}

impl Format {
    /// All formats, by the extensions of their files.
    pub const ALL: [(&str, Format); 3] = [("svg", Format::Svg), ("pdf", Format::Pdf), ("png", Format::Png)];
    /// The allowed file names.
    pub const ALLOWED: &str = "a file whose name ends in .svg, .pdf or .png";

    /// The format that a file's extension names, in upper or lower case; `None` unless [`ALLOWED`](Self::ALLOWED).
    pub fn of(path: &Path) -> Option<Format> {
        let extension = extension(path)?;
        Format::ALL.into_iter().find_map(|(name, format)| (name == extension).then_some(format))
    }
}

/// An encoder of PNGs that records the size in print, with `density` pixels for each unit of the canvas.
pub(crate) fn encoder(out: &mut Vec<u8>, [width, height]: [u32; 2], density: f32) -> png::Encoder<'_, &mut Vec<u8>> {
    let metre = (density * INCH / 0.0254).round() as u32;
    let mut encoder = png::Encoder::new(out, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_pixel_dims(Some(png::PixelDimensions { xppu: metre, yppu: metre, unit: png::Unit::Meter }));
    encoder
}

/// Pixels as a PNG.
pub(crate) fn png(pixels: &[u8], size: [u32; 2], density: f32) -> Result<Vec<u8>, FigureError> {
    let mut bytes = Vec::new();
    encoder(&mut bytes, size, density).write_header()?.write_image_data(pixels)?;
    Ok(bytes)
}

/// The extension of a file, in lower case.
pub(crate) fn extension(path: &Path) -> Option<String> {
    Some(path.extension()?.to_str()?.to_ascii_lowercase())
}

impl Canvas {
    /// The picture as a file in the given format.
    ///
    /// # Errors
    /// [`FigureError`], for PNG and PDF.
    pub fn bytes(&self, format: Format) -> Result<Vec<u8>, FigureError> {
        match format {
            Format::Svg => Ok(self.svg().into_bytes()),
            Format::Pdf => self.pdf().ok_or(FigureError::Size(self.size)),
            Format::Png => {
                let (pixels, size) = self.pixels(DENSITY).ok_or(FigureError::Size(self.size))?;
                png(&pixels, size, DENSITY)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::canvas::Label;
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
    fn a_png_records_its_size_in_print() {
        let bytes = Canvas::new(40.0, 20.0).bytes(Format::Png).unwrap();
        let place = bytes.windows(4).position(|name| name == b"pHYs").expect("no pHYs");
        // 192 dots an inch, in dots a metre, across and down.
        assert_eq!(bytes[place + 4..place + 13], [0, 0, 0x1d, 0x87, 0, 0, 0x1d, 0x87, 1]);
    }

    #[test]
    fn a_vertical_label_has_the_pixels_of_a_horizontal_one() {
        let label = |upwards: bool| {
            let mut canvas = Canvas::new(160.0, 160.0);
            let label = Label::new([80.0, 80.0], "normal force ξₛ", 17, Anchor::Middle, INK);
            canvas.label(if upwards { label.upwards() } else { label });
            let (pixels, [width, _]) = canvas.pixels(2.0).unwrap();
            let pixels: Vec<[u8; 3]> = pixels.chunks_exact(3).map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
            (pixels, width as usize)
        };
        let ((lying, width), (upright, _)) = (label(false), label(true));
        let turned = |k: usize| upright[(width - 1 - k % width) * width + k / width];
        // A letter is drawn on white through a picture of its own, which adds a rounding.
        let off = |k: &usize| (0..3).any(|c| lying[*k][c].abs_diff(turned(*k)[c]) > 2);
        assert_eq!((0..lying.len()).filter(off).count(), 0);
        assert!(lying.iter().filter(|pixel| **pixel == INK).count() > 200);
    }

    #[test]
    fn subscripts_are_smaller_and_lower_letters() {
        let mut canvas = Canvas::new(40.0, 20.0);
        canvas.text([0.0, 10.0], "ξₛ < R₀", 10, Anchor::Start, INK);
        let svg = canvas.svg();
        let set = "ξ<tspan dy=\"2\" font-size=\"7\">s</tspan><tspan dy=\"-2\"> &lt; R</tspan><tspan dy=\"2\" font-size=\"7\">0</tspan></text>";
        assert!(svg.contains(set), "{svg}");
    }

    #[test]
    fn formats_follow_the_extension_in_either_case() {
        for (name, format) in [
            ("a/b.SVG", Some(Format::Svg)),
            ("x.y.png", Some(Format::Png)),
            ("svg", None),
            ("a.pdf", Some(Format::Pdf)),
            ("a.eps", None),
        ] {
            assert_eq!(Format::of(Path::new(name)), format);
        }
    }
}
