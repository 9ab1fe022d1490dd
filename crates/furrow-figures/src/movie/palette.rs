//! Pixels in 256 colours.

use crate::drawing::FigureError;

/// Speed of the choice of colours, from 1 (slowest) to 30.
const HASTE: i32 = 10;
/// Bits of each part of a colour by which its place in the palette is remembered.
const BITS: usize = 7;

/// At most 255 colours. The index after the last marks unchanged pixels.
pub struct Palette {
    /// Red, green and blue of each.
    pub colours: Vec<[u8; 3]>,
    /// The number of the nearest colour, by the leading bits of the parts, where it is known.
    known: Vec<Option<u8>>,
}

impl Palette {
    /// The colours of these pixels, row by row and `width` in each; `exact` are among them.
    pub fn of(pixels: &[u8], width: usize, exact: &[[u8; 3]]) -> Palette {
        let height = pixels.len() / 3 / width.max(1);
        let chosen = gif::Frame::from_rgb_speed(width as u16, height as u16, &pixels[..3 * width * height], HASTE);
        let mut colours: Vec<[u8; 3]> = exact.to_vec();
        let palette = chosen.palette.unwrap_or_default();
        colours.extend(palette.chunks_exact(3).map(|colour| [colour[0], colour[1], colour[2]]));
        // One of the two most similar colours is removed until the others fit.
        while colours.len() > 255 {
            let pairs = (exact.len()..colours.len()).flat_map(|k| (0..k).map(move |j| (j, k)));
            let Some((_, k)) = pairs.min_by_key(|(j, k)| apart(colours[*j], colours[*k])) else { break };
            colours.remove(k);
        }
        // Neighbours on the surface have neighbouring numbers, which a PNG stores in little space.
        colours.sort_unstable_by_key(|[r, g, b]| (r > b, u32::from(*r) + u32::from(*g) + u32::from(*b)));
        Palette { colours, known: vec![None; 1 << (3 * BITS)] }
    }

    /// The number of the colour nearest to another.
    pub fn number(&mut self, colour: [u8; 3]) -> u8 {
        let place = colour.iter().fold(0, |place, part| place << BITS | usize::from(part >> (8 - BITS)));
        *self.known[place].get_or_insert_with(|| {
            let nearest = (0..self.colours.len()).min_by_key(|k| apart(self.colours[*k], colour));
            nearest.unwrap_or(0) as u8
        })
    }

    /// The numbers of the colours of all pixels.
    pub fn numbers(&mut self, pixels: &[u8]) -> Vec<u8> {
        pixels.chunks_exact(3).map(|pixel| self.number([pixel[0], pixel[1], pixel[2]])).collect()
    }

    /// The index that marks unchanged pixels.
    pub fn unchanged(&self) -> u8 {
        self.colours.len() as u8
    }

    /// All colours one after another.
    pub fn bytes(&self) -> Vec<u8> {
        self.colours.concat()
    }
}

fn apart(a: [u8; 3], b: [u8; 3]) -> u32 {
    (0..3).map(|c| u32::from(a[c].abs_diff(b[c])).pow(2)).sum()
}

/// Pixels as a PNG of 256 colours.
pub fn png(pixels: &[u8], [width, height]: [u32; 2], palette: &mut Palette) -> Result<Vec<u8>, FigureError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_palette(palette.bytes());
    // Filters compress intensities, not indices.
    encoder.set_filter(png::Filter::NoFilter);
    encoder.write_header()?.write_image_data(&palette.numbers(pixels))?;
    Ok(bytes)
}
