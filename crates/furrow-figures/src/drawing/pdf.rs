//! Pictures as PDF, with text as text.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use ttf_parser::{Face, GlyphId};

use super::canvas::{Anchor, Canvas, Element, Outline, Stroke, Words};
use super::font::{self, DROP, INDEX};
use super::raster::BOLD;
use super::style::Colour;
use super::svg::HALO;

/// Points of print for each unit of the canvas, of which an inch has 96.
const POINTS: f64 = 0.75;
/// Distance of the handles of a cubic curve that is a quarter of a circle of radius 1.
const QUARTER: f64 = 0.552_284_75;

impl Canvas {
    /// The picture as PDF; `None` without the font.
    pub(super) fn pdf(&self) -> Option<Vec<u8>> {
        let face = font::face()?;
        let [width, height] = self.size.map(|length| POINTS * length);
        let mut page = Page { face: &face, drawn: String::new(), glyphs: BTreeMap::new(), opacities: BTreeSet::new() };
        // y runs downwards.
        let _ = writeln!(page.drawn, "{POINTS} 0 0 -{POINTS} 0 {height} cm 1 j");
        self.elements.iter().for_each(|element| page.draw(element));
        let Page { drawn, glyphs, opacities, .. } = page;
        let states: String =
            opacities.iter().map(|percent| format!("/G{percent} << /ca {} >> ", shade(*percent))).collect();
        let name = "/BaseFont /DejaVuSans";
        let objects = [
            b"<< /Type /Catalog /Pages 2 0 R >>".to_vec(),
            b"<< /Type /Pages /Kids [3 0 R] /Count 1 >>".to_vec(),
            format!(
                "<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {width} {height}] /Contents 4 0 R \
                 /Resources << /Font << /F 5 0 R >> /ExtGState << {states}>> >> >>"
            )
            .into_bytes(),
            stream("", drawn.as_bytes()),
            format!(
                "<< /Type /Font /Subtype /Type0 {name} /Encoding /Identity-H /DescendantFonts [6 0 R] /ToUnicode 9 0 R >>"
            )
            .into_bytes(),
            format!(
                "<< /Type /Font /Subtype /CIDFontType2 {name} /CIDToGIDMap /Identity /FontDescriptor 7 0 R \
                 /CIDSystemInfo << /Registry (Adobe) /Ordering (Identity) /Supplement 0 >> /W [{}] >>",
                widths(&face, &glyphs)
            )
            .into_bytes(),
            descriptor(&face).into_bytes(),
            stream(&format!("/Length1 {} ", font::FONT.len()), font::FONT),
            stream("", letters(&glyphs).as_bytes()),
        ];
        Some(file(&objects))
    }
}

/// What a page shows, and what that needs.
struct Page<'a> {
    face: &'a Face<'a>,
    drawn: String,
    /// The letter of each glyph.
    glyphs: BTreeMap<u16, char>,
    /// Opacities of areas, in per cent.
    opacities: BTreeSet<u32>,
}

impl Page<'_> {
    fn draw(&mut self, element: &Element) {
        let out = &mut self.drawn;
        match element {
            Element::Shape(outline, fill, stroke) => self.shape(outline, *fill, *stroke),
            Element::Text(words) => self.text(words),
            Element::Clip(Some([left, top, right, bottom])) => {
                let _ = writeln!(out, "q {left:.2} {top:.2} {:.2} {:.2} re W n", right - left, bottom - top);
            }
            Element::Clip(None) => out.push_str("Q\n"),
        }
    }

    fn shape(&mut self, outline: &Outline, fill: Option<(Colour, f64)>, stroke: Option<Stroke>) {
        if let Some((fill, opacity)) = fill {
            let percent = (100.0 * opacity.clamp(0.0, 1.0)).round() as u32;
            self.opacities.insert(percent);
            let _ = write!(self.drawn, "/G{percent} gs {} rg ", colour(fill));
        }
        if let Some(Stroke { colour: of, width, dash }) = stroke {
            let dash = dash.map_or(String::new(), |[dash, gap]| format!("{dash} {gap}"));
            let _ = write!(self.drawn, "{} RG {width} w [{dash}] 0 d ", colour(of));
        }
        self.drawn.push_str(&path(outline));
        self.drawn.push_str(match (fill, stroke) {
            (Some(_), Some(_)) => "B\n",
            (Some(_), None) => "f\n",
            (None, Some(_)) => "S\n",
            (None, None) => "n\n",
        });
    }

    /// A line of text, with its rim below it.
    fn text(&mut self, words: &Words) {
        let Words { at: [x, y], content, size, anchor, colour: of, bold, upwards, halo } = words;
        let back = font::width(content, *size)
            * match anchor {
                Anchor::Start => 0.0,
                Anchor::Middle => 0.5,
                Anchor::End => 1.0,
            };
        let place = match upwards {
            false => format!("1 0 0 -1 {:.2} {y:.2}", x - back),
            true => format!("0 -1 -1 0 {x:.2} {:.2}", y + back),
        };
        let size = f64::from(*size);
        let letters: String = font::runs(content).iter().map(|run| self.run(run, size)).collect();
        self.opacities.insert(100);
        let rim = halo
            .map_or(String::new(), |rim| format!("BT {} RG {HALO} w [] 0 d 1 Tr {place} Tm {letters}ET ", colour(rim)));
        let (mode, of) = (if *bold { 2 } else { 0 }, colour(*of));
        let wide = f64::from(BOLD) * size;
        let _ = writeln!(
            self.drawn,
            "/G100 gs {rim}BT {of} rg {of} RG {wide:.2} w [] 0 d {mode} Tr {place} Tm {letters}ET"
        );
    }

    fn run(&mut self, run: &font::Run, size: f64) -> String {
        let (size, rise) = if run.index { (INDEX * size, -DROP * size) } else { (size, 0.0) };
        let mut glyphs = String::new();
        for letter in run.letters.chars() {
            let glyph = self.face.glyph_index(letter).unwrap_or_default().0;
            self.glyphs.insert(glyph, letter);
            let _ = write!(glyphs, "{glyph:04x}");
        }
        format!("/F {size:.2} Tf {rise:.2} Ts <{glyphs}> Tj ")
    }
}

fn path(outline: &Outline) -> String {
    let mut out = String::new();
    match outline {
        Outline::Circle([x, y], r) => {
            let handle = QUARTER * r;
            let _ = write!(out, "{:.2} {y:.2} m ", x + r);
            for [dx, dy] in [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0_f64]] {
                // From (dx, dy) to the point a quarter further, (−dy, dx).
                let point = |along: f64, across: f64| {
                    format!("{:.2} {:.2} ", x + along * dx - across * dy, y + along * dy + across * dx)
                };
                out += &(point(*r, handle) + &point(handle, *r) + &point(0.0, *r) + "c ");
            }
            out.push_str("h ");
        }
        Outline::Lines(lines, closed) => {
            for line in lines {
                for (k, [x, y]) in line.iter().enumerate() {
                    let _ = write!(out, "{x:.2} {y:.2} {} ", if k == 0 { 'm' } else { 'l' });
                }
                out.push_str(if *closed { "h " } else { "" });
            }
        }
    }
    out
}

fn colour(colour: Colour) -> String {
    let [r, g, b] = colour.map(|part| f64::from(part) / 255.0);
    format!("{r:.3} {g:.3} {b:.3}")
}

fn shade(percent: u32) -> f64 {
    f64::from(percent) / 100.0
}

/// Widths of glyphs, in thousandths of the size.
fn widths(face: &Face<'_>, glyphs: &BTreeMap<u16, char>) -> String {
    let width = |glyph: u16| f64::from(face.glyph_hor_advance(GlyphId(glyph)).unwrap_or(0));
    let scale = 1000.0 / f64::from(face.units_per_em());
    glyphs.keys().map(|glyph| format!("{glyph} [{:.0}] ", scale * width(*glyph))).collect()
}

fn descriptor(face: &Face<'_>) -> String {
    let scaled = |value: i16| (1000.0 * f64::from(value) / f64::from(face.units_per_em())).round();
    let frame = face.global_bounding_box();
    let [left, low, right, high] = [frame.x_min, frame.y_min, frame.x_max, frame.y_max].map(scaled);
    let (ascent, descent) = (scaled(face.ascender()), scaled(face.descender()));
    format!(
        "<< /Type /FontDescriptor /FontName /DejaVuSans /Flags 4 /FontBBox [{left} {low} {right} {high}] /ItalicAngle 0 \
         /Ascent {ascent} /Descent {descent} /CapHeight 729 /StemV 80 /FontFile2 8 0 R >>"
    )
}

/// Which letter each glyph is, for search and copies.
fn letters(glyphs: &BTreeMap<u16, char>) -> String {
    // A block may have a hundred lines.
    let pairs: Vec<String> = glyphs
        .iter()
        .map(|(glyph, letter)| {
            let mut units = [0; 2];
            let letter: String = letter.encode_utf16(&mut units).iter().map(|unit| format!("{unit:04x}")).collect();
            format!("<{glyph:04x}> <{letter}>\n")
        })
        .collect();
    let blocks = pairs.chunks(100).map(|some| format!("{} beginbfchar\n{}endbfchar\n", some.len(), some.concat()));
    format!(
        "/CIDInit /ProcSet findresource begin 12 dict begin begincmap\n/CMapName /Letters def /CMapType 2 def\n\
         1 begincodespacerange <0000> <ffff> endcodespacerange\n{}endcmap CMapName currentdict /CMap defineresource pop end end\n",
        blocks.collect::<String>()
    )
}

fn stream(keys: &str, content: &[u8]) -> Vec<u8> {
    let head = format!("<< {keys}/Length {} >>\nstream\n", content.len());
    [head.as_bytes(), content, b"\nendstream"].concat()
}

/// A file of these objects, the first of which is its catalogue.
fn file(objects: &[Vec<u8>]) -> Vec<u8> {
    let mut out = b"%PDF-1.4\n%\xe2\xe3\xcf\xd3\n".to_vec();
    let mut places = String::new();
    for (k, object) in objects.iter().enumerate() {
        let _ = write!(places, "{:010} 00000 n \n", out.len());
        out.extend([format!("{} 0 obj\n", k + 1).as_bytes(), object, b"\nendobj\n"].concat());
    }
    let (count, table) = (objects.len() + 1, out.len());
    let end = format!(
        "xref\n0 {count}\n0000000000 65535 f \n{places}trailer\n<< /Size {count} /Root 1 0 R >>\nstartxref\n{table}\n%%EOF\n"
    );
    out.extend(end.as_bytes());
    out
}

#[cfg(test)]
mod tests {
    use super::super::style::INK;
    use super::*;

    #[test]
    fn the_table_of_a_file_leads_to_its_objects() {
        let mut canvas = Canvas::new(40.0, 20.0);
        canvas.disc([10.0, 10.0], 5.0, [255, 0, 0], 0.5, Some(Stroke::dashed(INK, 1.0, [2.0, 3.0])));
        canvas.clipped([0.0, 0.0, 20.0, 20.0], |canvas| canvas.bold([0.0, 10.0], "ξₛ (χ)", 8, Anchor::Middle, INK));
        let bytes = canvas.pdf().unwrap();
        let text = String::from_utf8_lossy(&bytes);
        assert!(text.contains("/MediaBox [0 0 30 15]") && text.contains("/G50 << /ca 0.5 >>"), "{}", &text[..400]);
        // ξ is U+03BE, and is found by searching.
        assert!(text.contains("> <03be>"));
        let at = |marker: &[u8]| bytes.windows(marker.len()).rposition(|part| part == marker).unwrap();
        let table = at(b"\nxref\n") + 1;
        assert!(text.ends_with(&format!("startxref\n{table}\n%%EOF\n")));
        let rows = String::from_utf8(bytes[table..].to_vec()).unwrap();
        let rows: Vec<usize> =
            rows.lines().skip(3).take_while(|row| row.ends_with("n ")).map(|row| row[..10].parse().unwrap()).collect();
        assert_eq!(rows.len(), 9);
        for (k, place) in rows.into_iter().enumerate() {
            assert!(bytes[place..].starts_with(format!("{} 0 obj\n", k + 1).as_bytes()), "object {k}");
        }
    }
}
