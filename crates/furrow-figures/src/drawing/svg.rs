//! Pictures as SVG.

use super::canvas::{Anchor, Canvas, Element, Label, Outline, Stroke};
use super::font::{self, DROP, INDEX};
use super::style::Colour;

/// Fonts of an SVG in order of preference. A PNG uses the first, which is embedded in the program.
const FONTS: &str = "DejaVu Sans, Verdana, Arial, sans-serif";

/// Width of the rim that separates text from the lines behind it; half of it is visible.
pub(super) const HALO: f64 = 5.0;

impl Canvas {
    /// The picture as SVG.
    pub fn svg(&self) -> String {
        svg(self.size, &self.elements())
    }

    /// The content of the outermost element of an SVG.
    pub(crate) fn elements(&self) -> String {
        let written = |element: &Element| match element {
            Element::Shape(outline, fill, stroke) => shape(outline, *fill, *stroke),
            Element::Text(label) => writing(label),
            // An inner picture clips at its own frame.
            Element::Clip(Some([left, top, right, bottom])) => {
                let [x, y, width, height] = [*left, *top, right - left, bottom - top].map(short);
                format!(r#"<svg x="{x}" y="{y}" width="{width}" height="{height}" viewBox="{x} {y} {width} {height}">"#)
            }
            Element::Clip(None) => "</svg>".to_owned(),
        };
        self.elements.iter().map(written).collect()
    }
}

/// An SVG of the given size with these elements on white.
pub(crate) fn svg([width, height]: [f64; 2], elements: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
         font-family=\"{FONTS}\"><rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>{elements}</svg>\n"
    )
}

fn shape(outline: &Outline, fill: Option<(Colour, f64)>, stroke: Option<Stroke>) -> String {
    let outline = match outline {
        Outline::Lines(lines, closed) => {
            let point = |(k, point): (usize, &[f64; 2])| {
                let [x, y] = point.map(short);
                format!("{}{x} {y}", if k == 0 { 'M' } else { 'L' })
            };
            let line = |line: &Vec<_>| line.iter().enumerate().map(point).collect::<String>();
            let end = if *closed { "Z" } else { "" };
            format!("path d=\"{}\"", lines.iter().map(|points| line(points) + end).collect::<String>())
        }
        Outline::Circle(at, radius) => {
            let [x, y, radius] = [at[0], at[1], *radius].map(short);
            format!("circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\"")
        }
    };
    let fill = match fill {
        None => "none".to_owned(),
        Some((colour, opacity)) if opacity < 1.0 => format!("{}\" fill-opacity=\"{}", hex(colour), short(opacity)),
        Some((colour, _)) => hex(colour),
    };
    let stroke = stroke.map_or(String::new(), |Stroke { colour, width, dash }| {
        let dash = dash.map_or(String::new(), |[dash, gap]| format!(" stroke-dasharray=\"{dash} {gap}\""));
        format!(" stroke=\"{}\" stroke-width=\"{}\" stroke-linejoin=\"round\"{dash}", hex(colour), short(width))
    });
    format!("<{outline} fill=\"{fill}\"{stroke}/>")
}

fn writing(Label { at, content, size, anchor, colour, bold, upwards, halo }: &Label) -> String {
    let [x, y] = at.map(short);
    let anchor = match anchor {
        Anchor::Start => "start",
        Anchor::Middle => "middle",
        Anchor::End => "end",
    };
    let bold = if *bold { " font-weight=\"bold\"" } else { "" };
    let turned = if *upwards { format!(" transform=\"rotate(-90,{x},{y})\"") } else { String::new() };
    let halo = halo.map_or(String::new(), |rim| {
        format!(" paint-order=\"stroke\" stroke=\"{}\" stroke-width=\"{HALO}\" stroke-linejoin=\"round\"", hex(rim))
    });
    let (content, fill) = (set(content, *size), hex(*colour));
    format!(
        "<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\" text-anchor=\"{anchor}\" fill=\"{fill}\"{bold}{halo}{turned}>{content}</text>"
    )
}

/// The text with its subscripts smaller and lower, by attributes that every SVG viewer supports.
fn set(content: &str, size: u32) -> String {
    let escaped = |text: &str| text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    let (index, drop) = (short(INDEX * f64::from(size)), short(DROP * f64::from(size)));
    let mut lowered = false;
    let part = |run: font::Run| {
        let letters = escaped(&run.letters);
        let part = match (run.index, lowered) {
            (true, _) => format!("<tspan dy=\"{drop}\" font-size=\"{index}\">{letters}</tspan>"),
            (false, true) => format!("<tspan dy=\"-{drop}\">{letters}</tspan>"),
            (false, false) => letters,
        };
        lowered = run.index;
        part
    };
    font::runs(content).into_iter().map(part).collect()
}

/// A number rounded to two decimals, without a minus sign before zero.
fn short(value: f64) -> f64 {
    (100.0 * value).round() / 100.0 + 0.0
}

fn hex([r, g, b]: Colour) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}
