//! The contour of a cell in a mask: a PNG picture with the cell in one colour and its surroundings in another.

use std::cmp::Reverse;
use std::io::Read;

use furrow_input::InputError;
use png::{BitDepth, ColorType, Decoder, Limits, Transformations};

use super::MOST_POINTS;
use super::polygons::{Contours, LeftOut};

/// Pixels that a mask has at most.
const MOST_PIXELS: usize = 100_000_000;

/// Bytes that one byte of compressed data unpacks to at most.
const UNPACKS_TO: usize = 1032;

/// What begins a PNG picture.
const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Most labels that an error lists.
const MOST_LISTED: usize = 12;

/// A picture by its values: grey values, or labels.
struct Picture {
    width: usize,
    height: usize,
    values: Vec<u16>,
    /// Whether its pixels are numbers, grey values or of a palette, and no colours.
    is_of_numbers: bool,
}

impl Picture {
    /// The values of a picture of labels; `None` for a mask. The edges of a mask have values between its two commonest ones, but these
    /// values fill no areas.
    fn labels(&self) -> Option<Vec<u16>> {
        let mut counts = vec![0_usize; 1 << 16];
        self.values.iter().for_each(|value| counts[usize::from(*value)] += 1);
        let mut labels: Vec<u16> = (0..=u16::MAX).filter(|value| counts[usize::from(*value)] > 0).collect();
        labels.sort_unstable_by_key(|value| (Reverse(counts[usize::from(*value)]), *value));
        let commonest = [*labels.first()?, *labels.get(1)?];
        let places = (0..self.values.len()).filter(|at| !commonest.contains(&self.values[*at]));
        let (count, inner) =
            places.fold((0, 0), |(count, inner), at| (count + 1, inner + usize::from(self.is_within_its_value(at))));
        labels.sort_unstable();
        (count > 0 && 2 * inner > count).then_some(labels)
    }

    /// Whether all pixels around one have its value.
    fn is_within_its_value(&self, at: usize) -> bool {
        let around = |place: usize, end: usize| place.saturating_sub(1)..(place + 2).min(end);
        let (columns, own) = (around(at % self.width, self.width), self.values[at]);
        let rows = around(at / self.width, self.height);
        rows.flat_map(|y| &self.values[y * self.width..][columns.clone()]).all(|value| *value == own)
    }

    fn is_on_rim(&self, at: usize) -> bool {
        [0, self.width - 1].contains(&(at % self.width)) || [0, self.height - 1].contains(&(at / self.width))
    }
}

impl Contours {
    /// Adds the contour of the largest piece of the cell in a mask. Pixels of the cell are darker or brighter than the middle between the
    /// darkest and the brightest value, unlike most of the picture's rim; in a picture of labels they have the value `label`. The contour
    /// runs through the middles of the outer sides of its pixels; holes are filled.
    ///
    /// # Errors
    /// A file that is not such a picture, or a picture of several labels without `label`.
    pub fn read_mask(&mut self, from: impl Read, file: &str, label: Option<u16>) -> Result<(), InputError> {
        let bytes = bytes_of(from, file)?;
        self.scale("px", file)?;
        let mut picture = decode(&bytes, file, Transformations::IDENTITY)?;
        let inside = match (label, picture.labels().filter(|_| picture.is_of_numbers)) {
            (Some(_), _) if !picture.is_of_numbers => {
                let why = "labels are grey values or numbers of a palette; this picture has colours";
                return Err(refused(file, why.to_owned()));
            }
            (Some(label), _) => picture.values.iter().map(|value| *value == label).collect(),
            (None, Some(labels)) => return Err(label_needed(file, &labels)),
            (None, None) => {
                picture = decode(&bytes, file, Transformations::EXPAND)?;
                foreground(&picture)
            }
        };
        let Some((piece, notes)) = largest_piece(&picture, inside) else {
            let why = label
                .map_or("it has one colour alone".to_owned(), |label| format!("no pixel of it has the label {label}"));
            self.left_out.push(LeftOut { file: file.to_owned(), contour: String::new(), line: None, why });
            return Ok(());
        };
        self.add(file, String::new(), None, outline(&piece, picture.width), Some(1.0), notes);
        Ok(())
    }
}

fn refused(file: &str, reason: String) -> InputError {
    InputError::other_file(file, "a mask, a PNG picture", reason)
}

/// The error for a picture of labels without a chosen label.
fn label_needed(file: &str, labels: &[u16]) -> InputError {
    let mut listed: Vec<String> = labels.iter().take(MOST_LISTED).map(u16::to_string).collect();
    listed.extend((labels.len() > MOST_LISTED).then(|| format!("{} more", labels.len() - MOST_LISTED)));
    let allowed = format!(
        "given with --label: the picture has the labels {}, and a mask has one colour on another",
        listed.join(", ")
    );
    InputError::not_allowed(file, "label", "(not given)", allowed)
}

/// The bytes of a PNG picture.
fn bytes_of(from: impl Read, file: &str) -> Result<Vec<u8>, InputError> {
    let refused = |reason: String| refused(file, reason);
    // The decoder has to seek, which a pipe does not allow. The file is therefore read first, up to two bytes for each allowed pixel.
    let mut bytes = Vec::new();
    let mut from = from.take(2 * MOST_PIXELS as u64);
    from.by_ref().take(SIGNATURE.len() as u64).read_to_end(&mut bytes).map_err(|e| refused(e.to_string()))?;
    if bytes != SIGNATURE {
        return Err(refused("it does not begin as one".to_owned()));
    }
    from.read_to_end(&mut bytes).map_err(|e| refused(e.to_string()))?;
    Ok(bytes)
}

fn decode(bytes: &[u8], file: &str, transformations: Transformations) -> Result<Picture, InputError> {
    let refused = |reason: String| refused(file, reason);
    let length = bytes.len();
    let mut decoder = Decoder::new_with_limits(std::io::Cursor::new(bytes), Limits { bytes: 16 * MOST_PIXELS });
    decoder.set_ignore_text_chunk(true);
    decoder.set_transformations(transformations);
    let mut reader = decoder.read_info().map_err(|e| refused(e.to_string()))?;
    let [width, height] = [reader.info().width as usize, reader.info().height as usize];
    if width.saturating_mul(height) > MOST_PIXELS {
        return Err(refused(format!("{width} × {height} pixels; at most {MOST_PIXELS} are read")));
    }
    let size = reader.output_buffer_size().ok_or_else(|| refused("it is too large".to_owned()))?;
    // Each row begins with the number of its filter.
    let row = 1 + width.saturating_mul(reader.info().bits_per_pixel()).div_ceil(8);
    if height.saturating_mul(row) > length.saturating_mul(UNPACKS_TO) {
        return Err(refused(format!("{width} × {height} pixels cannot be in {length} bytes")));
    }
    let mut buffer = vec![0; size];
    let frame = reader.next_frame(&mut buffer).map_err(|e| refused(e.to_string()))?;
    let is_of_numbers = matches!(frame.color_type, ColorType::Grayscale | ColorType::Indexed);
    let rows = buffer.chunks_exact(frame.line_size).take(height);
    let values = rows.flat_map(|row| (0..width).map(|x| value(row, x, frame.color_type, frame.bit_depth))).collect();
    Ok(Picture { width, height, values, is_of_numbers })
}

/// The value of a pixel: the mean of its colours, 0 where it is transparent.
fn value(row: &[u8], x: usize, color: ColorType, depth: BitDepth) -> u16 {
    let channel = |at: usize| match depth {
        BitDepth::Sixteen => u16::from_be_bytes([row[2 * at], row[2 * at + 1]]),
        BitDepth::Eight => u16::from(row[at]),
        packed => {
            let bits = packed as usize;
            let shift = 8 - bits - (at * bits) % 8;
            u16::from(row[at * bits / 8] >> shift) & ((1 << bits) - 1)
        }
    };
    let samples = color.samples();
    let with_alpha = matches!(color, ColorType::GrayscaleAlpha | ColorType::Rgba);
    let colours = samples - usize::from(with_alpha);
    let sum: u32 = (0..colours).map(|k| u32::from(channel(samples * x + k))).sum();
    let clear = with_alpha && channel(samples * x + samples - 1) == 0;
    if clear { 0 } else { (sum / colours as u32) as u16 }
}

/// Pixels unlike most of the rim.
fn foreground(picture: &Picture) -> Vec<bool> {
    let (least, most) = picture.values.iter().fold((u16::MAX, 0), |(a, b), v| (a.min(*v), b.max(*v)));
    let middle = (u32::from(least) + u32::from(most)) / 2;
    let bright = |at: &usize| u32::from(picture.values[*at]) > middle;
    let all = 0..picture.values.len();
    let rim: Vec<usize> = all.clone().filter(|at| picture.is_on_rim(*at)).collect();
    let dark_cell = 2 * rim.iter().filter(|at| bright(at)).count() > rim.len();
    all.map(|at| least < most && bright(&at) != dark_cell).collect()
}

/// The pixels of the largest piece that hangs together by sides, and what there is to say of the others; `None` without a pixel.
fn largest_piece(picture: &Picture, mut inside: Vec<bool>) -> Option<(Vec<bool>, Vec<String>)> {
    let (width, height) = (picture.width, picture.height);
    let mut pieces: Vec<Vec<usize>> = Vec::new();
    for start in 0..inside.len() {
        if !std::mem::take(&mut inside[start]) {
            continue;
        }
        let (mut piece, mut next) = (vec![start], 0);
        while let Some(&at) = piece.get(next) {
            next += 1;
            let (x, y) = (at % width, at / width);
            let sides = [
                (x > 0).then(|| at - 1),
                (x + 1 < width).then(|| at + 1),
                (y > 0).then(|| at - width),
                (y + 1 < height).then(|| at + width),
            ];
            for side in sides.into_iter().flatten() {
                if std::mem::take(&mut inside[side]) {
                    piece.push(side);
                }
            }
        }
        pieces.push(piece);
    }
    // Of equal ones the first.
    let largest = (0..pieces.len()).rev().max_by_key(|k| pieces[*k].len())?;
    let piece = pieces.swap_remove(largest);
    let mut notes = Vec::new();
    if !pieces.is_empty() {
        let others: usize = pieces.iter().map(Vec::len).sum();
        let (count, of) = (pieces.len(), piece.len());
        notes.push(format!("{count} smaller pieces, {others} pixels beside {of}, were left out"));
    }
    if piece.iter().any(|at| picture.is_on_rim(*at)) {
        notes.push("touches the picture's rim, where the cell may go on".to_owned());
    }
    let mut pixels = vec![false; width * height];
    for at in piece {
        pixels[at] = true;
    }
    Some((pixels, notes))
}

/// The outline of a piece, through the middles of the outer sides of its pixels: a walk along these sides with the piece on the
/// right-hand side. It ends at [`MOST_POINTS`], which are too many: the sides of a comb or of dust are as many as its pixels.
fn outline(piece: &[bool], width: usize) -> Vec<[f64; 2]> {
    let Some(first) = piece.iter().position(|inside| *inside) else { return Vec::new() };
    let inside = |x: i64, y: i64| {
        let (column, row) = (usize::try_from(x), usize::try_from(y));
        let (Ok(column), Ok(row)) = (column, row) else { return false };
        column < width && piece.get(row * width + column).copied().unwrap_or(false)
    };
    const WAYS: [[i64; 2]; 4] = [[1, 0], [0, 1], [-1, 0], [0, -1]];
    // The first pixel of all is the leftmost of the topmost ones: its upper side is an outer one.
    let start = [(first % width) as i64, (first / width) as i64];
    let (mut corner, mut way) = (start, 0);
    let mut points = Vec::new();
    loop {
        let [dx, dy] = WAYS[way];
        points.push([corner[0] as f64 + 0.5 * dx as f64, corner[1] as f64 + 0.5 * dy as f64]);
        corner = [corner[0] + dx, corner[1] + dy];
        // The pixels ahead on both sides of the way; the one with the corner as its upper left is (x, y).
        let ahead = |right: bool| {
            let [x, y] = corner;
            let [px, py] = if right { [-dy, dx] } else { [dy, -dx] };
            inside(x + (dx + px - 1) / 2, y + (dy + py - 1) / 2)
        };
        // Pixels that touch only at a corner are not connected.
        if !ahead(true) {
            way = (way + 1) % 4;
        } else if ahead(false) {
            way = (way + 3) % 4;
        }
        if (corner, way) == (start, 0) || points.len() >= MOST_POINTS {
            return points;
        }
    }
}
