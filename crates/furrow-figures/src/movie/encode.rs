//! Frames as GIF, animated PNG or animated SVG.

use std::path::Path;

use rayon::prelude::*;

use super::palette::Palette;
use super::picture::{Frame, SIZE, Stage};
use super::raster::Window;
use super::scene::Scene;
use crate::drawing::format::{self, extension};
use crate::drawing::{FigureError, svg};

/// Time for which a frame is shown, in hundredths of a second, and for which the last is shown.
const DELAY: u16 = 5;
const LAST: u16 = 150;
/// Pixels of the surface in a unit of an SVG.
const DENSITY: f64 = 1.5;
/// Frames that are drawn, and kept in memory, at once.
const AT_ONCE: usize = 8;
/// Frames, after the first, from which the palette of a movie is chosen.
const SAMPLES: usize = 2;

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

/// The movie of a scene as a file in the given format.
pub fn bytes(scene: &Scene<'_>, format: MovieFormat, shown: &dyn Fn(usize, usize)) -> Result<Vec<u8>, FigureError> {
    let counted = |k: usize| shown(k + 1, scene.times.len());
    match format {
        MovieFormat::Svg => Ok(animated(&Stage::new(scene, DENSITY)?, &counted)?.into_bytes()),
        MovieFormat::Gif => gif(&Stage::new(scene, 1.0)?, &counted),
        MovieFormat::Png => apng(&Stage::new(scene, 1.0)?, &counted),
    }
}

/// The frame of a scene at a time as a PNG.
pub fn png(scene: &Scene<'_>, t: f64, density: f64) -> Result<Vec<u8>, FigureError> {
    let (pixels, size) = Stage::new(scene, density)?.frame(t)?.pixels()?;
    format::png(&pixels, size, density as f32)
}

/// How long frame k is shown, in hundredths of a second.
fn delay(k: usize, times: &[f64]) -> u16 {
    if k + 1 == times.len() { LAST } else { DELAY }
}

/// Draws the frames at these times, several at once, and uses one after another.
fn drawn<T: Send>(
    stage: &Stage<'_, '_>,
    times: &[f64],
    finish: impl Fn(Frame) -> Result<T, FigureError> + Sync,
    mut using: impl FnMut(usize, T) -> Result<(), FigureError>,
) -> Result<(), FigureError> {
    for (number, batch) in times.chunks(AT_ONCE).enumerate() {
        let frames: Result<Vec<T>, FigureError> = batch.par_iter().map(|t| finish(stage.frame(*t)?)).collect();
        for (k, frame) in frames?.into_iter().enumerate() {
            using(number * AT_ONCE + k, frame)?;
        }
    }
    Ok(())
}

/// The colours of a movie.
fn palette(stage: &Stage<'_, '_>) -> Result<Palette, FigureError> {
    let times = &stage.scene.times;
    let at = |k: usize| times.get(k * times.len().saturating_sub(1) / SAMPLES).copied().unwrap_or(0.0);
    let (mut samples, mut width) = (Vec::new(), 0);
    drawn(stage, &(0..=SAMPLES).map(at).collect::<Vec<_>>(), Frame::pixels, |_, (pixels, [wide, _])| {
        samples.extend(pixels);
        width = wide as usize;
        Ok(())
    })?;
    Ok(Palette::of(&samples, width, &stage.colours()))
}

/// All frames in one palette; each stores only the pixels that change.
fn gif(stage: &Stage<'_, '_>, counted: &dyn Fn(usize)) -> Result<Vec<u8>, FigureError> {
    let times = &stage.scene.times;
    let [width, height] = SIZE.map(|length| length as usize);
    let mut palette = palette(stage)?;
    let mut out = Vec::new();
    let mut encoder = gif::Encoder::new(&mut out, width as u16, height as u16, &palette.bytes())?;
    encoder.set_repeat(gif::Repeat::Infinite)?;
    let mut before: Vec<u8> = Vec::new();
    drawn(stage, times, Frame::pixels, |k, (pixels, _)| {
        let numbers = palette.numbers(&pixels);
        let Window { corner, size } = changed(&before, &numbers, [width, height], 1);
        let unchanged = palette.unchanged();
        let pixel = |at: usize| if before.get(at) == Some(&numbers[at]) { unchanged } else { numbers[at] };
        let rows = (corner[1]..corner[1] + size[1]).map(|y| y * width + corner[0]);
        let buffer: Vec<u8> = rows.flat_map(|from| (from..from + size[0]).map(pixel)).collect();
        let [left, top, wide, high] = [corner[0], corner[1], size[0], size[1]].map(|length| length as u16);
        let mut frame = gif::Frame::from_indexed_pixels(wide, high, buffer, Some(unchanged));
        (frame.left, frame.top, frame.delay) = (left, top, delay(k, times));
        frame.dispose = gif::DisposalMethod::Keep;
        encoder.write_frame(&frame)?;
        before = numbers;
        counted(k);
        Ok(())
    })?;
    drop(encoder);
    Ok(out)
}

/// All frames in full colour; each stores only the rectangle that changes.
fn apng(stage: &Stage<'_, '_>, counted: &dyn Fn(usize)) -> Result<Vec<u8>, FigureError> {
    let times = &stage.scene.times;
    let [width, height] = SIZE.map(|length| length as usize);
    let mut out = Vec::new();
    let mut encoder = format::encoder(&mut out, [width as u32, height as u32], 1.0);
    encoder.set_animated(times.len() as u32, 0)?;
    let mut writer = encoder.write_header()?;
    let mut before: Vec<u8> = Vec::new();
    drawn(stage, times, Frame::pixels, |k, (pixels, _)| {
        let Window { corner, size } = changed(&before, &pixels, [width, height], 3);
        let row = |y: usize| &pixels[3 * (y * width + corner[0])..][..3 * size[0]];
        let part: Vec<u8> = (corner[1]..corner[1] + size[1]).flat_map(row).copied().collect();
        if k > 0 {
            writer.reset_frame_position()?;
            writer.set_frame_dimension(size[0] as u32, size[1] as u32)?;
            writer.set_frame_position(corner[0] as u32, corner[1] as u32)?;
        }
        writer.set_frame_delay(delay(k, times), 100)?;
        writer.write_image_data(&part)?;
        before = pixels;
        counted(k);
        Ok(())
    })?;
    writer.finish()?;
    Ok(out)
}

/// The smallest rectangle that contains all changed pixels, of `parts` bytes each: the whole frame without a frame before,
/// one pixel if nothing changes.
fn changed(before: &[u8], now: &[u8], [width, height]: [usize; 2], parts: usize) -> Window {
    if before.len() != now.len() {
        return Window { corner: [0, 0], size: [width, height] };
    }
    let mut ends = [[usize::MAX; 2], [0; 2]];
    for (k, (a, b)) in before.chunks_exact(parts).zip(now.chunks_exact(parts)).enumerate() {
        if a != b {
            for (c, at) in [k % width, k / width].into_iter().enumerate() {
                (ends[0][c], ends[1][c]) = (ends[0][c].min(at), ends[1][c].max(at));
            }
        }
    }
    let [from, to] = ends;
    if from[0] > to[0] {
        return Window { corner: [0, 0], size: [1, 1] };
    }
    Window { corner: from, size: [to[0] - from[0] + 1, to[1] - from[1] + 1] }
}

/// Every frame as a group that is visible for its time. A viewer without animation shows a frame with a deep furrow.
fn animated(stage: &Stage<'_, '_>, counted: &dyn Fn(usize)) -> Result<String, FigureError> {
    let times = &stage.scene.times;
    let (last, deep) = (times.len().saturating_sub(1), times.len() * 4 / 5);
    let seconds = |k: usize| f64::from(DELAY) * k as f64 / 100.0 * 80.0 / times.len() as f64;
    let total = seconds(last) + f64::from(LAST) / 100.0;
    let mut palette = palette(stage)?;
    let mut groups = String::new();
    drawn(stage, times, Ok, |k, frame| {
        let (from, to) = (seconds(k) / total, seconds(k + 1) / total);
        let (values, moments) = match k {
            0 => ("inline;none", format!("0;{to:.4}")),
            _ if k == last => ("none;inline", format!("0;{from:.4}")),
            _ => ("none;inline;none", format!("0;{from:.4};{to:.4}")),
        };
        let display = if k == deep { "inline" } else { "none" };
        let frame = frame.elements(stage, &mut palette)?;
        groups += &format!(
            "<g display=\"{display}\"><animate attributeName=\"display\" values=\"{values}\" keyTimes=\"{moments}\" \
             dur=\"{total:.2}s\" calcMode=\"discrete\" repeatCount=\"indefinite\"/>{frame}</g>\n"
        );
        counted(k);
        Ok(())
    })?;
    Ok(svg::svg(SIZE, &groups))
}
