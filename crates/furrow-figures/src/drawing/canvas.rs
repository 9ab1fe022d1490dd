//! A canvas for lines, areas and text.

use furrow_input::printable;

use super::style::Colour;

/// The appearance of a line.
#[derive(Clone, Copy, Debug)]
pub struct Stroke {
    /// Colour.
    pub colour: Colour,
    /// Width.
    pub width: f64,
    /// Lengths of dashes and of the gaps between them.
    pub dash: Option<[f64; 2]>,
}

impl Stroke {
    /// A solid line.
    pub(crate) fn solid(colour: Colour, width: f64) -> Stroke {
        Stroke { colour, width, dash: None }
    }

    /// A dashed line.
    pub(crate) fn dashed(colour: Colour, width: f64, dash: [f64; 2]) -> Stroke {
        Stroke { colour, width, dash: Some(dash) }
    }
}

/// The part of a text that lies at its position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// Its beginning.
    Start,
    /// Its middle.
    Middle,
    /// Its end.
    End,
}

impl Anchor {
    /// From the position to the beginning of a text with this length.
    pub(super) fn beginning(self, length: f32) -> f32 {
        match self {
            Anchor::Start => 0.0,
            Anchor::Middle => -0.5 * length,
            Anchor::End => -length,
        }
    }
}

/// The outline of a shape.
#[derive(Clone, Debug)]
pub(super) enum Outline {
    /// Lines through points, all open or all closed.
    Lines(Vec<Vec<[f64; 2]>>, bool),
    Circle([f64; 2], f64),
}

/// One line of text.
#[derive(Clone, Debug)]
pub struct Label {
    pub(super) at: [f64; 2],
    pub(super) content: String,
    pub(super) size: u32,
    pub(super) anchor: Anchor,
    pub(super) colour: Colour,
    pub(super) bold: bool,
    pub(super) upwards: bool,
    pub(super) halo: Option<Colour>,
}

impl Label {
    /// A label on a base line.
    pub fn new(at: [f64; 2], content: &str, size: u32, anchor: Anchor, colour: Colour) -> Label {
        let content = printable(content).into_owned();
        Label { at, content, size, anchor, colour, bold: false, upwards: false, halo: None }
    }

    /// The label in bold letters.
    pub fn bold(self) -> Label {
        Label { bold: true, ..self }
    }

    /// The label turned to be read from below.
    pub fn upwards(self) -> Label {
        Label { upwards: true, ..self }
    }

    /// The label with a rim that separates it from the lines behind it.
    pub fn over(self, rim: Colour) -> Label {
        Label { halo: Some(rim), ..self }
    }
}

#[derive(Clone, Debug)]
pub(super) enum Element {
    /// A shape with its fill, the fill's opacity, and its stroke.
    Shape(Outline, Option<(Colour, f64)>, Option<Stroke>),
    Text(Label),
    /// Clips the following elements to [left, top, right, bottom]; `None` ends the clipping.
    Clip(Option<[f64; 4]>),
}

/// A picture; x runs to the right and y downwards.
#[derive(Debug)]
pub struct Canvas {
    pub(super) size: [f64; 2],
    pub(super) elements: Vec<Element>,
}

impl Canvas {
    /// A white canvas.
    pub fn new(width: f64, height: f64) -> Canvas {
        Canvas { size: [width, height], elements: Vec::new() }
    }

    /// A line through points.
    pub(crate) fn polyline(&mut self, points: &[[f64; 2]], stroke: Stroke) {
        if points.len() > 1 {
            self.elements.push(Element::Shape(Outline::Lines(vec![points.to_vec()], false), None, Some(stroke)));
        }
    }

    /// A closed area, with an outline if one is given.
    pub(crate) fn polygon(&mut self, points: &[[f64; 2]], fill: Colour, opacity: f64, outline: Option<Stroke>) {
        let outer = Outline::Lines(vec![points.to_vec()], true);
        self.elements.push(Element::Shape(outer, Some((fill, opacity)), outline));
    }

    /// Small areas of one colour, with corners rounded to a tenth of a unit.
    pub(crate) fn facets(&mut self, areas: impl IntoIterator<Item = impl AsRef<[[f64; 2]]>>, fill: Colour) {
        let tenth = |corner: &[f64; 2]| corner.map(|x| (10.0 * x).round() / 10.0);
        let areas = areas.into_iter().map(|corners| corners.as_ref().iter().map(tenth).collect()).collect();
        self.elements.push(Element::Shape(Outline::Lines(areas, true), Some((fill, 1.0)), None));
    }

    /// A rectangle by its upper left corner and its size.
    pub(crate) fn rectangle(&mut self, [x, y]: [f64; 2], [width, height]: [f64; 2], fill: Colour, opacity: f64) {
        self.polygon(&[[x, y], [x + width, y], [x + width, y + height], [x, y + height]], fill, opacity, None);
    }

    /// A filled circle.
    pub fn disc(&mut self, at: [f64; 2], radius: f64, fill: Colour, opacity: f64, outline: Option<Stroke>) {
        self.elements.push(Element::Shape(Outline::Circle(at, radius), Some((fill, opacity)), outline));
    }

    /// A line of text on a base line.
    pub fn text(&mut self, at: [f64; 2], content: &str, size: u32, anchor: Anchor, colour: Colour) {
        self.label(Label::new(at, content, size, anchor, colour));
    }

    /// A line of text.
    pub fn label(&mut self, label: Label) {
        self.elements.push(Element::Text(label));
    }

    /// The outline of a rectangle [left, top, right, bottom].
    pub fn frame(&mut self, [left, top, right, bottom]: [f64; 4], stroke: Stroke) {
        self.polyline(&[[left, top], [right, top], [right, bottom], [left, bottom], [left, top]], stroke);
    }

    /// Clips everything that `draw` adds to [left, top, right, bottom].
    pub(crate) fn clipped(&mut self, frame: [f64; 4], draw: impl FnOnce(&mut Canvas)) {
        self.elements.push(Element::Clip(Some(frame)));
        draw(self);
        self.elements.push(Element::Clip(None));
    }

    /// An arrow from one point to another, with a head that fits its length.
    pub(crate) fn arrow(&mut self, from: [f64; 2], to: [f64; 2], colour: Colour, width: f64) {
        let along = [to[0] - from[0], to[1] - from[1]];
        let length = along[0].hypot(along[1]);
        if length < 1.5 {
            return;
        }
        let (ux, uy) = (along[0] / length, along[1] / length);
        let head = (0.45 * length).min(4.0 * width);
        let aside = |[x, y]: [f64; 2], by: f64| [x - by * uy, y + by * ux];
        let neck = [to[0] - head * ux, to[1] - head * uy];
        let (thick, wide) = (0.5 * width, 0.5 * head.max(1.6 * width));
        let corners = [
            aside(from, thick),
            aside(neck, thick),
            aside(neck, wide),
            to,
            aside(neck, -wide),
            aside(neck, -thick),
            aside(from, -thick),
        ];
        self.facets([corners], colour);
    }
}
