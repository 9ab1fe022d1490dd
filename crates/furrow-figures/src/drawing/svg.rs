//! Pictures as SVG.

use std::fmt::Write;

use super::canvas::{Anchor, Canvas, Element, Outline, Stroke, Words};
use super::style::Colour;

/// Fonts of an SVG, the first that the reader has. A PNG is drawn with the first, which is part of the program.
const FONTS: &str = "DejaVu Sans, Verdana, Arial, sans-serif";

impl Canvas {
    /// The picture as SVG.
    pub fn svg(&self) -> String {
        svg(self.size, &self.elements())
    }

    /// What is inside the outermost element of an SVG.
    pub(crate) fn elements(&self) -> String {
        let mut out = String::new();
        for element in &self.elements {
            // Writing to a string cannot fail.
            let _ = match element {
                Element::Shape(outline, fill, stroke) => shape(&mut out, outline, *fill, *stroke),
                Element::Text(words) => writing(&mut out, words),
                // An inner picture is cut off at its own frame.
                Element::Clip(Some([left, top, right, bottom])) => {
                    let [x, y, width, height] = [*left, *top, right - left, bottom - top].map(short);
                    write!(
                        out,
                        r#"<svg x="{x}" y="{y}" width="{width}" height="{height}" viewBox="{x} {y} {width} {height}">"#
                    )
                }
                Element::Clip(None) => write!(out, "</svg>"),
            };
        }
        out
    }
}

/// An SVG of a size with these elements on white.
pub(crate) fn svg([width, height]: [f64; 2], elements: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
         font-family=\"{FONTS}\"><rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>{elements}</svg>\n"
    )
}

fn shape(out: &mut String, outline: &Outline, fill: Option<(Colour, f64)>, stroke: Option<Stroke>) -> std::fmt::Result {
    let path = |out: &mut String, points: &[[f64; 2]]| -> std::fmt::Result {
        for (k, point) in points.iter().enumerate() {
            let [x, y] = point.map(short);
            write!(out, "{}{x} {y}", if k == 0 { 'M' } else { 'L' })?;
        }
        Ok(())
    };
    match outline {
        Outline::Line(points) => {
            write!(out, "<path d=\"")?;
            path(out, points)?;
        }
        Outline::Polygons(rings) => {
            write!(out, "<path d=\"")?;
            for ring in rings {
                path(out, ring)?;
                out.push('Z');
            }
        }
        Outline::Circle(at, radius) => {
            let [x, y] = at.map(short);
            write!(out, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{}", short(*radius))?;
        }
    }
    match fill {
        None => write!(out, "\" fill=\"none\"")?,
        Some((colour, opacity)) => {
            write!(out, "\" fill=\"{}\"", hex(colour))?;
            if opacity < 1.0 {
                write!(out, " fill-opacity=\"{}\"", short(opacity))?;
            }
        }
    }
    if let Some(Stroke { colour, width, dash }) = stroke {
        write!(out, " stroke=\"{}\" stroke-width=\"{}\" stroke-linejoin=\"round\"", hex(colour), short(width))?;
        if let Some([dash, gap]) = dash {
            write!(out, " stroke-dasharray=\"{dash} {gap}\"")?;
        }
    }
    write!(out, "/>")
}

fn writing(out: &mut String, words: &Words) -> std::fmt::Result {
    let [x, y] = words.at.map(short);
    let anchor = match words.anchor {
        Anchor::Start => "start",
        Anchor::Middle => "middle",
        Anchor::End => "end",
    };
    write!(out, "<text x=\"{x}\" y=\"{y}\" font-size=\"{}\" text-anchor=\"{anchor}\"", words.size)?;
    write!(out, " fill=\"{}\"", hex(words.colour))?;
    if words.bold {
        write!(out, " font-weight=\"bold\"")?;
    }
    if words.upwards {
        write!(out, " transform=\"rotate(-90,{x},{y})\"")?;
    }
    write!(out, ">{}</text>", words.content.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;"))
}

/// A number with two digits behind the point, without a minus before a zero.
fn short(value: f64) -> f64 {
    (100.0 * value).round() / 100.0 + 0.0
}

fn hex([r, g, b]: Colour) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}
