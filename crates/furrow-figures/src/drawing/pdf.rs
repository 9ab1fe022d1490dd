//! Pictures as PDF, with searchable text.

use std::collections::BTreeMap;
use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use pdf_writer::types::{CidFontType, FontFlags, LineJoinStyle, SystemInfo, TextRenderingMode as Mode, UnicodeCmap};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, Str};
use ttf_parser::{Face, GlyphId};

use super::canvas::{Canvas, Element, Label, Outline, Stroke};
use super::font::{self, BOLD, DROP, FONT, INDEX};
use super::style::Colour;
use super::svg::HALO;

/// Points of a PDF in one unit of the canvas: 72 points and 96 units are an inch.
const POINT: f32 = 0.75;
const CATALOG: Ref = Ref::new(1);
const PAGES: Ref = Ref::new(2);
const PAGE: Ref = Ref::new(3);
const CONTENT: Ref = Ref::new(4);
const TYPE0: Ref = Ref::new(5);
const CID: Ref = Ref::new(6);
const DESCRIPTOR: Ref = Ref::new(7);
const CMAP: Ref = Ref::new(8);
const FILE: Ref = Ref::new(9);
const FONT_NAME: Name<'static> = Name(b"DejaVuSans");
const SYSTEM: SystemInfo<'static> = SystemInfo { registry: Str(b"Adobe"), ordering: Str(b"Identity"), supplement: 0 };

impl Canvas {
    /// The picture as a one-page PDF. Equal pictures give equal bytes; `None` if the font cannot be read.
    pub(crate) fn pdf(&self) -> Option<Vec<u8>> {
        let mut page =
            Page { face: font::face()?, content: Content::new(), glyphs: BTreeMap::new(), opacities: Vec::new() };
        let [width, height] = self.size.map(|length| length as f32);
        // On the canvas y runs downwards.
        page.content.transform([POINT, 0.0, 0.0, -POINT, 0.0, POINT * height]);
        self.elements.iter().for_each(|element| page.draw(element));
        Some(page.file(Rect::new(0.0, 0.0, POINT * width, POINT * height)))
    }
}

/// The page under construction.
struct Page<'f> {
    face: Face<'f>,
    content: Content,
    /// The glyphs in use, with their letters.
    glyphs: BTreeMap<u16, char>,
    /// The opacities in use, in thousandths.
    opacities: Vec<u16>,
}

impl Page<'_> {
    fn draw(&mut self, element: &Element) {
        match element {
            Element::Shape(outline, fill, stroke) => self.shape(outline, *fill, *stroke),
            Element::Text(label) => self.text(label),
            Element::Clip(Some([left, top, right, bottom])) => {
                let [x, y, width, height] = [*left, *top, right - left, bottom - top].map(|x| x as f32);
                self.content.save_state().rect(x, y, width, height).clip_nonzero().end_path();
            }
            Element::Clip(None) => {
                self.content.restore_state();
            }
        }
    }

    fn shape(&mut self, outline: &Outline, fill: Option<(Colour, f64)>, stroke: Option<Stroke>) {
        self.content.save_state();
        if let Some((colour, opacity)) = fill {
            self.fill(colour);
            self.opacity(opacity);
        }
        if let Some(stroke) = stroke {
            self.pen(stroke.colour, stroke.width as f32);
            let dash = stroke.dash.map_or(Vec::new(), |dash| dash.map(|x| x as f32).to_vec());
            self.content.set_dash_pattern(dash, 0.0);
        }
        self.outline(outline);
        match (fill, stroke) {
            (Some(_), Some(_)) => self.content.fill_nonzero_and_stroke(),
            (Some(_), None) => self.content.fill_nonzero(),
            (None, Some(_)) => self.content.stroke(),
            (None, None) => self.content.end_path(),
        };
        self.content.restore_state();
    }

    fn outline(&mut self, outline: &Outline) {
        let content = &mut self.content;
        match outline {
            Outline::Lines(lines, closed) => {
                for line in lines {
                    for (k, [x, y]) in line.iter().map(|point| point.map(|x| x as f32)).enumerate() {
                        if k == 0 {
                            content.move_to(x, y)
                        } else {
                            content.line_to(x, y)
                        };
                    }
                    if *closed {
                        content.close_path();
                    }
                }
            }
            Outline::Circle(at, radius) => {
                let ([x, y], r) = (at.map(|x| x as f32), *radius as f32);
                // Four cubic curves deviate from a circle by at most 3e-4 of its radius.
                let h = 0.552_285 * r;
                content.move_to(x + r, y);
                content.cubic_to(x + r, y + h, x + h, y + r, x, y + r);
                content.cubic_to(x - h, y + r, x - r, y + h, x - r, y);
                content.cubic_to(x - r, y - h, x - h, y - r, x, y - r);
                content.cubic_to(x + h, y - r, x + r, y - h, x + r, y).close_path();
            }
        }
    }

    fn text(&mut self, label: &Label) {
        let size = label.size as f32;
        let length = font::width(&label.content, label.size) as f32;
        let left = label.anchor.beginning(length);
        let [x, y] = label.at.map(|x| x as f32);
        // In text space y runs upwards.
        let place =
            if label.upwards { [0.0, -1.0, -1.0, 0.0, x, y - left] } else { [1.0, 0.0, 0.0, -1.0, x + left, y] };
        let mut layers = Vec::new();
        layers.extend(label.halo.map(|rim| (Mode::Stroke, rim, HALO as f32)));
        layers.push(match label.bold {
            true => (Mode::FillStroke, label.colour, BOLD * size),
            false => (Mode::Fill, label.colour, 0.0),
        });
        for (mode, colour, pen) in layers {
            self.content.save_state();
            self.fill(colour);
            self.pen(colour, pen);
            self.content.begin_text().set_text_rendering_mode(mode).set_text_matrix(place);
            for run in font::runs(&label.content) {
                let (scale, drop) = if run.index { (INDEX as f32, DROP as f32) } else { (1.0, 0.0) };
                let shown: Vec<u8> = run.letters.chars().flat_map(|letter| self.glyph(letter).to_be_bytes()).collect();
                self.content.set_font(FONT_NAME, scale * size).set_rise(-drop * size).show(Str(&shown));
            }
            self.content.end_text().restore_state();
        }
    }

    /// The glyph of a letter. A letter that the font lacks is drawn as an empty box.
    fn glyph(&mut self, letter: char) -> u16 {
        let glyph = self.face.glyph_index(letter).unwrap_or_default().0;
        self.glyphs.insert(glyph, letter);
        glyph
    }

    fn fill(&mut self, colour: Colour) {
        let [r, g, b] = colour.map(|part| f32::from(part) / 255.0);
        self.content.set_fill_rgb(r, g, b);
    }

    fn pen(&mut self, colour: Colour, width: f32) {
        let [r, g, b] = colour.map(|part| f32::from(part) / 255.0);
        self.content.set_stroke_rgb(r, g, b).set_line_width(width).set_line_join(LineJoinStyle::RoundJoin);
    }

    fn opacity(&mut self, opacity: f64) {
        if opacity < 1.0 {
            let thousandths = (1000.0 * opacity.max(0.0)).round() as u16;
            let place = self.opacities.iter().position(|known| *known == thousandths);
            let place = place.unwrap_or_else(|| {
                self.opacities.push(thousandths);
                self.opacities.len() - 1
            });
            self.content.set_parameters(Name(format!("O{place}").as_bytes()));
        }
    }

    /// The whole file.
    fn file(self, media: Rect) -> Vec<u8> {
        let Page { face, content, glyphs, opacities } = self;
        let mut pdf = Pdf::new();
        pdf.catalog(CATALOG).pages(PAGES);
        pdf.pages(PAGES).kids([PAGE]).count(1);
        let mut page = pdf.page(PAGE);
        page.media_box(media).parent(PAGES).contents(CONTENT);
        let mut resources = page.resources();
        resources.fonts().pair(FONT_NAME, TYPE0);
        let mut states = resources.ext_g_states();
        for (place, thousandths) in opacities.iter().enumerate() {
            let mut state = states
                .insert(Name(format!("O{place}").as_bytes()))
                .start::<pdf_writer::writers::ExtGraphicsState<'_>>();
            state.non_stroking_alpha(f32::from(*thousandths) / 1000.0);
        }
        states.finish();
        resources.finish();
        page.finish();
        pdf.stream(CONTENT, &deflated(&content.finish())).filter(Filter::FlateDecode);
        embed(&mut pdf, &face, &glyphs);
        pdf.finish()
    }
}

/// Embeds the font with the characters of its glyphs, so that text can be searched and copied.
fn embed(pdf: &mut Pdf, face: &Face<'_>, glyphs: &BTreeMap<u16, char>) {
    let unit = 1000.0 / f32::from(face.units_per_em());
    pdf.type0_font(TYPE0)
        .base_font(FONT_NAME)
        .encoding_predefined(Name(b"Identity-H"))
        .descendant_font(CID)
        .to_unicode(CMAP);
    let mut cid = pdf.cid_font(CID);
    cid.subtype(CidFontType::Type2)
        .base_font(FONT_NAME)
        .system_info(SYSTEM)
        .font_descriptor(DESCRIPTOR)
        .default_width(0.0);
    let mut widths = cid.widths();
    for glyph in glyphs.keys() {
        let advance = f32::from(face.glyph_hor_advance(GlyphId(*glyph)).unwrap_or(0));
        widths.consecutive(*glyph, [unit * advance]);
    }
    widths.finish();
    cid.cid_to_gid_map_predefined(Name(b"Identity"));
    cid.finish();
    let bounds = face.global_bounding_box();
    let [left, bottom, right, top] =
        [bounds.x_min, bounds.y_min, bounds.x_max, bounds.y_max].map(|x| unit * f32::from(x));
    let height = |of: Option<i16>| unit * f32::from(of.unwrap_or_else(|| face.ascender()));
    pdf.font_descriptor(DESCRIPTOR)
        .name(FONT_NAME)
        .flags(FontFlags::NON_SYMBOLIC)
        .bbox(Rect::new(left, bottom, right, top))
        .italic_angle(0.0)
        .ascent(unit * f32::from(face.ascender()))
        .descent(unit * f32::from(face.descender()))
        .cap_height(height(face.capital_height()))
        .stem_v(80.0)
        .font_file2(FILE);
    let mut cmap = UnicodeCmap::new(Name(b"Letters"), SYSTEM);
    glyphs.iter().for_each(|(glyph, letter)| cmap.pair(*glyph, *letter));
    pdf.cmap(CMAP, &cmap.finish());
    pdf.stream(FILE, &deflated(FONT)).filter(Filter::FlateDecode).pair(Name(b"Length1"), FONT.len() as i32);
}

/// The bytes, compressed; writing to memory does not fail.
fn deflated(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    let written = encoder.write_all(bytes).and_then(|()| encoder.finish());
    written.unwrap_or_default()
}
