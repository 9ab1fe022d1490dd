//! A division as a page: its film as a surface that readers turn.

use std::f64::consts::PI;
use std::io::{self, Write};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::GzEncoder;
use furrow_cell::{Cell, Settings};
use furrow_formats::surface::{SurfaceFrame, blended, strongest};
use furrow_mechanics::cortex::Wall;
use furrow_mechanics::division::{Division, DivisionInput};
use serde_json::json;

use super::escape;
use super::html::listed;
use super::page::{PARTS, PLAYING, THEME, document};
use super::table::short;

const STAGE: &str = include_str!("page/turned.html");
const SCRIPTS: [&str; 4] = [PARTS, THEME, PLAYING, include_str!("page/turned.js")];
/// The whole numbers of the largest coordinate and of the value with the strongest colour.
const LARGEST: [f64; 2] = [32767.0, 127.0];

/// Where rings around the shell are, as shares of its half axis if it is an ellipsoid.
const RINGS: [f64; 5] = [-0.8, -0.4, 0.0, 0.4, 0.8];

/// The film of a division.
pub struct FilmPage<'a> {
    /// What was divided.
    pub input: &'a DivisionInput,
    /// How it ended.
    pub division: &'a Division,
    /// The wall of the shell.
    pub wall: &'a Wall,
    /// The quantity and unit of the surfaces' values.
    pub value: &'a str,
    /// Its surfaces, with the numbers of each in [`About`](furrow_formats::frames::About).
    pub frames: &'a [SurfaceFrame],
}

impl FilmPage<'_> {
    /// The page.
    ///
    /// # Errors
    /// Of compression, which does not fail in memory.
    pub fn html(&self) -> io::Result<String> {
        let FilmPage { input: DivisionInput { cell, numerics, seed }, division, wall, value, frames } = *self;
        let Cell { r0, epsilon, xi_s, cue, .. } = cell;
        let coordinates = frames.iter().flat_map(|frame| &frame.surface.points).flatten();
        let extent = coordinates.fold(f64::MIN_POSITIVE, |most, x| most.max(x.abs()));
        let strongest = strongest(frames);
        let colours = [-1.0, 0.0, 1.0].map(blended);
        let rings = RINGS.map(|along| wall.at(along.acos()));
        let poles = [0.0, PI].map(|angle| wall.at(angle)[1]);
        let data = json!({
            "shell": wall.axes,
            "rings": rings,
            "poles": poles,
            "colours": colours,
            "unit": extent / LARGEST[0],
            "steps": LARGEST[1],
            "columns": frames.first().map_or(0, |frame| frame.surface.columns),
            "rows": frames.iter().map(|frame| frame.surface.rows).collect::<Vec<_>>(),
            "frames": frames.iter().map(|frame| &frame.about).collect::<Vec<_>>(),
        });
        let packed = packed(frames, [extent, strongest])?;
        let [low, zero, high] = colours.map(|[r, g, b]| format!("rgb({r:.0},{g:.0},{b:.0})"));
        let legend = format!(
            "<p class=\"small\">{}</p>\n<div class=\"colours\" style=\"background:linear-gradient(to right,{low},{zero},{high})\"></div>\n\
             <p class=\"bar small\"><span>≤ −{strongest:.1}</span><span class=\"grow\"></span><span>0</span><span class=\"grow\"></span><span>≥ {strongest:.1}</span></p>\n",
            // As the other units of the page.
            escape(&value.replace("κ0", "κ₀").replace("L_h", "Lₕ"))
        );
        let [r0, epsilon, xi_s] = [*r0, *epsilon, *xi_s].map(short);
        let chi = division.chi().map_or(String::new(), |chi| format!(", χ = {chi:.4}"));
        let end = format!("{}{chi}, at t = {:.4} τ", division.outcome(), division.t_end);
        let law = cell.law.as_ref().map_or(String::new(), |law| format!(", law {}", escape(law.name())));
        let heading = format!("Division of a cell of R0 = {r0}");
        let top = format!(
            "<p class=\"sub\">ε = {epsilon}, ξ<sub>s</sub> = {xi_s}{law}, {}: {end}</p>\n",
            if cell.has_cue() { escape(&cue.to_string()) } else { "no cue".to_owned() }
        );
        let settings = Settings::of(cell.clone(), *numerics);
        let main =
            STAGE.replace("<!-- legend -->\n", &legend) + &listed(settings, &format!("cue = {cue}\nseed = {seed}\n"));
        let texts = [("application/json", "furrow-data", data.to_string()), ("text/plain", "film-frames", packed)];
        let texts = texts.each_ref().map(|(kind, id, text)| (*kind, *id, text.as_str()));
        Ok(document([&heading, &heading, &top, &main], &texts, &SCRIPTS))
    }
}

/// The coordinates and values of all frames as 16-bit integers, compressed and in base64; `turned.js` unpacks them. Each is stored as
/// its difference from a prediction along its meridian and around the axis: these differences are small and compress well. The low
/// bytes of all numbers come before the high bytes.
fn packed(frames: &[SurfaceFrame], [extent, strongest]: [f64; 2]) -> io::Result<String> {
    let (mut low, mut high) = (Vec::new(), Vec::new());
    for SurfaceFrame { surface, .. } in frames {
        let (rows, columns) = (surface.rows, surface.columns);
        for part in 0..4 {
            let whole = |row: usize, column: usize| {
                let place = row * columns + column;
                let number = match surface.points[place].get(part) {
                    Some(x) => LARGEST[0] * x / extent,
                    None => LARGEST[1] * (surface.values[place] / strongest).clamp(-1.0, 1.0),
                };
                number.round() as i16
            };
            // Differences wrap around, and so do the sums of the page.
            let bend = |row: usize, column: usize| {
                let before = |back: usize| row.checked_sub(back).map_or(0, |row| whole(row, column));
                whole(row, column).wrapping_sub(before(1).wrapping_mul(2)).wrapping_add(before(2))
            };
            for (column, row) in (0..columns).flat_map(|column| (0..rows).map(move |row| (column, row))) {
                let beside = column.checked_sub(1).map_or(0, |column| bend(row, column));
                let rest = bend(row, column).wrapping_sub(beside);
                // Small numbers of either sign become small ones without a sign.
                let [first, second] = ((rest << 1) ^ (rest >> 15)).to_le_bytes();
                low.push(first);
                high.push(second);
            }
        }
    }
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(&low)?;
    encoder.write_all(&high)?;
    Ok(STANDARD.encode(encoder.finish()?))
}
