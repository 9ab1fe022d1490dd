//! Frames as GIF, animated PNG or animated SVG.

use std::path::Path;

use super::picture::{SIZE, Stage};
use super::surface::Fineness;
use crate::drawing::format::{extension, resolution};
use crate::drawing::{FigureError, svg};
use furrow_cell::Cell;
use furrow_mechanics::division::Trajectory;

/// Time for which a frame is shown, in hundredths of a second, and for which the last is shown.
const DELAY: u16 = 5;
const LAST: u16 = 150;
/// Speed of the GIF encoder, from 1 (slowest) to 30.
const HASTE: i32 = 10;

/// The file format of a movie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MovieFormat {
    /// Pixels in 256 colours a frame; plays everywhere.
    Gif,
    /// Pixels in full colour.
    Png,
    /// Lines and areas at any size; plays in browsers.
    Svg,
}

impl MovieFormat {
    /// The format of a file's extension, in upper or lower case: `.gif`, `.png`, `.apng` or `.svg`.
    pub fn of(path: &Path) -> Option<MovieFormat> {
        match extension(path)?.as_str() {
            "gif" => Some(MovieFormat::Gif),
            "png" | "apng" => Some(MovieFormat::Png),
            "svg" => Some(MovieFormat::Svg),
            _ => None,
        }
    }

    /// Default number of frames.
    pub fn usual_frames(self) -> usize {
        if self == MovieFormat::Svg { 20 } else { 80 }
    }
}

/// A division as frames at evenly spaced times, up to its last shape.
pub struct Movie<'a> {
    /// The cell.
    pub cell: &'a Cell,
    /// Its division.
    pub film: &'a Trajectory,
    /// Number of frames.
    pub frames: usize,
}

impl Movie<'_> {
    /// The movie as a file in the given format.
    ///
    /// # Errors
    /// [`FigureError`].
    pub fn bytes(&self, format: MovieFormat) -> Result<Vec<u8>, FigureError> {
        self.bytes_shown(format, &|_, _| ())
    }

    /// The same; `shown` is called with the numbers of drawn and of all frames.
    ///
    /// # Errors
    /// [`FigureError`].
    pub fn bytes_shown(&self, format: MovieFormat, shown: &dyn Fn(usize, usize)) -> Result<Vec<u8>, FigureError> {
        let end = self.film.times().last().copied().unwrap_or(0.0);
        let last = self.frames.max(2) - 1;
        let times: Vec<f64> = (0..=last).map(|k| end * k as f64 / last as f64).collect();
        let fineness = match format {
            // The text of an SVG holds every corner of every frame.
            MovieFormat::Svg => Fineness { along: 36, around: 20, shades: 20.0 },
            _ => Fineness { along: 110, around: 72, shades: 64.0 },
        };
        let stage = Stage::new(self.cell, self.film, &times, fineness);
        let delay = |k: usize| if k == last { LAST } else { DELAY };
        let pixels = |t: f64| stage.frame(t).pixels(1.0).map(|(colours, _)| colours).ok_or(FigureError::Size(SIZE));
        let mut out = Vec::new();
        match format {
            MovieFormat::Svg => out = animated(&stage, &times, shown).into_bytes(),
            MovieFormat::Gif => {
                let [width, height] = SIZE.map(|length| length as u16);
                let mut encoder = gif::Encoder::new(&mut out, width, height, &[])?;
                encoder.set_repeat(gif::Repeat::Infinite)?;
                for (k, t) in times.iter().enumerate() {
                    let mut frame = gif::Frame::from_rgb_speed(width, height, &pixels(*t)?, HASTE);
                    frame.delay = delay(k);
                    encoder.write_frame(&frame)?;
                    shown(k + 1, times.len());
                }
            }
            MovieFormat::Png => {
                let mut encoder = png::Encoder::new(&mut out, SIZE[0] as u32, SIZE[1] as u32);
                encoder.set_color(png::ColorType::Rgb);
                encoder.set_pixel_dims(Some(resolution(1.0)));
                encoder.set_animated(times.len() as u32, 0)?;
                let mut writer = encoder.write_header()?;
                for (k, t) in times.iter().enumerate() {
                    writer.set_frame_delay(delay(k), 100)?;
                    writer.write_image_data(&pixels(*t)?)?;
                    shown(k + 1, times.len());
                }
                writer.finish()?;
            }
        }
        Ok(out)
    }
}

/// Every frame as a group that is visible for its time. A viewer without animation shows a frame with a deep furrow.
fn animated(stage: &Stage<'_>, times: &[f64], shown: &dyn Fn(usize, usize)) -> String {
    let (last, deep) = (times.len() - 1, times.len() * 4 / 5);
    let seconds = |k: usize| f64::from(DELAY) * k as f64 / 100.0 * 80.0 / times.len() as f64;
    let total = seconds(last) + f64::from(LAST) / 100.0;
    let group = |(k, t): (usize, &f64)| {
        let (from, to) = (seconds(k) / total, seconds(k + 1) / total);
        let (values, moments) = match k {
            0 => ("inline;none", format!("0;{to:.4}")),
            _ if k == last => ("none;inline", format!("0;{from:.4}")),
            _ => ("none;inline;none", format!("0;{from:.4};{to:.4}")),
        };
        let (display, frame) = (if k == deep { "inline" } else { "none" }, stage.frame(*t).elements());
        shown(k + 1, times.len());
        format!(
            "<g display=\"{display}\"><animate attributeName=\"display\" values=\"{values}\" keyTimes=\"{moments}\" \
             dur=\"{total:.2}s\" calcMode=\"discrete\" repeatCount=\"indefinite\"/>{frame}</g>\n"
        )
    };
    svg::svg(SIZE, &times.iter().enumerate().map(group).collect::<String>())
}
