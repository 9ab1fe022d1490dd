//! The colour of a value on a surface.

use super::SurfaceFrame;

/// The colour of the value 0.
const CORTEX: [u8; 3] = [186, 222, 244];
/// The colour of positive values and of fields that a cue raises.
pub const RAISED: [u8; 3] = [0xe6, 0x9f, 0x00];
/// The colour of negative values and of fields that a cue lowers.
pub const LOWERED: [u8; 3] = [0x00, 0x72, 0xb2];
/// Share of the tint at the largest value.
const STRENGTH: f64 = 0.85;
/// Share of all values that are not beyond the strongest colour: at a closing neck forces grow without bound.
const COVERED: f64 = 0.97;

/// Red, green and blue, from 0 to 255, of a value relative to the one with the strongest colour, −1 to 1.
pub fn blended(share: f64) -> [f64; 3] {
    let tint = if share < 0.0 { LOWERED } else { RAISED };
    let by = STRENGTH * share.abs().min(1.0);
    [0, 1, 2].map(|c| f64::from(CORTEX[c]) + by * (f64::from(tint[c]) - f64::from(CORTEX[c])))
}

/// The same, rounded.
pub fn colour(share: f64) -> [u8; 3] {
    blended(share).map(|light| light.round() as u8)
}

/// The absolute value that has the strongest colour in all frames; 1 if all are 0.
pub fn strongest(frames: &[SurfaceFrame]) -> f64 {
    let values = frames.iter().flat_map(|frame| &frame.surface.values);
    let mut sizes: Vec<f64> = values.map(|value| value.abs()).filter(|size| size.is_finite()).collect();
    sizes.sort_unstable_by(f64::total_cmp);
    let last = sizes.last().copied().unwrap_or(0.0);
    let covered = sizes.get((COVERED * sizes.len() as f64) as usize).copied().unwrap_or(last);
    [covered, last, 1.0].into_iter().find(|size| *size > 0.0).unwrap_or(1.0)
}
