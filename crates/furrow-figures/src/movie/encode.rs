//! Frames as GIF, animated PNG or animated SVG.

use std::borrow::Cow;
use std::fmt::Write;
use std::path::Path;

use super::picture::{SIZE, Stage};
use super::surface::Fineness;
use crate::drawing::format::extension;
use crate::drawing::{FigureError, svg};
use furrow_cell::Cell;
use furrow_mechanics::division::Film;

/// How long a frame is shown, in hundredths of a second, and the last.
const DELAY: u16 = 5;
const LAST: u16 = 150;
/// Speed of the GIF encoder, from 1 (slowest) to 30.
const HASTE: i32 = 10;

/// The file format of a movie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MovieFormat {
    /// Dots in 256 colours a frame; plays everywhere.
    Gif,
    /// Dots in all colours.
    Png,
    /// Lines and areas at any size; plays in browsers.
    Svg,
}

impl MovieFormat {
    /// By a file's extension, in any case: `.gif`, `.png`, `.apng` or `.svg`.
    pub fn of(path: &Path) -> Option<MovieFormat> {
        match extension(path)?.as_str() {
            "gif" => Some(MovieFormat::Gif),
            "png" | "apng" => Some(MovieFormat::Png),
            "svg" => Some(MovieFormat::Svg),
            _ => None,
        }
    }

    /// Frames of a movie of that kind, unless told otherwise.
    pub fn usual_frames(self) -> usize {
        match self {
            MovieFormat::Gif | MovieFormat::Png => 80,
            MovieFormat::Svg => 20,
        }
    }

    fn fineness(self) -> Fineness {
        match self {
            MovieFormat::Gif | MovieFormat::Png => Fineness { along: 110, around: 72, shades: 64.0 },
            // A text that holds every corner of every frame.
            MovieFormat::Svg => Fineness { along: 36, around: 20, shades: 20.0 },
        }
    }
}

/// A division in frames at even times, and its last shape.
pub struct Movie<'a> {
    /// The cell.
    pub cell: &'a Cell,
    /// Its division.
    pub film: &'a Film,
    /// Frames.
    pub frames: usize,
}

impl Movie<'_> {
    /// The times of its frames.
    pub fn times(&self) -> Vec<f64> {
        let end = self.film.times().last().copied().unwrap_or(0.0);
        let last = self.frames.max(2) - 1;
        (0..=last).map(|k| end * k as f64 / last as f64).collect()
    }

    /// As a file of that format.
    ///
    /// # Errors
    /// [`FigureError`].
    pub fn bytes(&self, format: MovieFormat) -> Result<Vec<u8>, FigureError> {
        let times = self.times();
        let stage = Stage::new(self.cell, self.film, &times, format.fineness());
        match format {
            MovieFormat::Gif => gif(&stage, &times),
            MovieFormat::Png => apng(&stage, &times),
            MovieFormat::Svg => Ok(animated(&stage, &times).into_bytes()),
        }
    }
}

/// Red, green and blue of the pixels of a frame.
fn pixels(stage: &Stage<'_>, t: f64) -> Result<Vec<u8>, FigureError> {
    Ok(stage.frame(t).pixels(1.0).ok_or(FigureError::Size(SIZE))?.0)
}

fn delay(k: usize, of: usize) -> u16 {
    if k + 1 == of { LAST } else { DELAY }
}

fn gif(stage: &Stage<'_>, times: &[f64]) -> Result<Vec<u8>, FigureError> {
    let mut out = Vec::new();
    let mut encoder = gif::Encoder::new(&mut out, SIZE[0] as u16, SIZE[1] as u16, &[])?;
    encoder.set_repeat(gif::Repeat::Infinite)?;
    for (k, t) in times.iter().enumerate() {
        let mut frame = gif::Frame::from_rgb_speed(SIZE[0] as u16, SIZE[1] as u16, &pixels(stage, *t)?, HASTE);
        frame.delay = delay(k, times.len());
        encoder.write_frame(&frame)?;
    }
    drop(encoder);
    Ok(out)
}

fn apng(stage: &Stage<'_>, times: &[f64]) -> Result<Vec<u8>, FigureError> {
    let mut out = Vec::new();
    let mut encoder = png::Encoder::new(&mut out, SIZE[0] as u32, SIZE[1] as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_animated(times.len() as u32, 0)?;
    let mut writer = encoder.write_header()?;
    for (k, t) in times.iter().enumerate() {
        writer.set_frame_delay(delay(k, times.len()), 100)?;
        writer.write_image_data(&pixels(stage, *t)?)?;
    }
    writer.finish()?;
    Ok(out)
}

/// Every frame as a group that is seen for its time. A reader that plays nothing shows the frame in which the furrow is deep.
fn animated(stage: &Stage<'_>, times: &[f64]) -> String {
    let seconds = |k: usize| f64::from(DELAY) * k as f64 / 100.0 * 80.0 / times.len() as f64;
    let total = seconds(times.len() - 1) + f64::from(LAST) / 100.0;
    let still = times.len() * 4 / 5;
    let mut out = String::new();
    for (k, t) in times.iter().enumerate() {
        let from = seconds(k) / total;
        let to = if k + 1 == times.len() { 1.0 } else { seconds(k + 1) / total };
        let (values, moments): (Cow<'_, str>, String) = match k {
            0 => ("inline;none".into(), format!("0;{to:.4}")),
            _ if k + 1 == times.len() => ("none;inline".into(), format!("0;{from:.4}")),
            _ => ("none;inline;none".into(), format!("0;{from:.4};{to:.4}")),
        };
        let shown = if k == still { "inline" } else { "none" };
        let _ = writeln!(
            out,
            "<g display=\"{shown}\"><animate attributeName=\"display\" values=\"{values}\" keyTimes=\"{moments}\" \
             dur=\"{total:.2}s\" calcMode=\"discrete\" repeatCount=\"indefinite\"/>{}</g>",
            stage.frame(*t).elements()
        );
    }
    svg::svg(SIZE, &out)
}
