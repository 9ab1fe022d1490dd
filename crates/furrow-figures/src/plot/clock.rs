//! Lifetimes over volumes, with the power law of each founder.

use furrow_analysis::fit::{FittedClock, FittedLaw};

use crate::drawing::legend::{Key, Legend, Marker, titled};
use crate::drawing::panel::Chart;
use crate::drawing::{Canvas, Stroke, style};
use crate::plot::lifetimes::{coloured, logarithmic};

const WIDTH: f64 = 800.0;
const CHART: f64 = 500.0;

/// Draws the cells of a fitted clock, and the line of each founder that has one.
pub fn draw(found: &FittedClock) -> Canvas {
    let FittedClock { exponents, few, cells, .. } = found;
    let founders: Vec<&str> =
        exponents.iter().map(|law| &*law.founder).chain(few.iter().map(|few| &*few.founder)).collect();
    let colours = coloured(&founders);
    let colour = |founder: &str| colours.iter().find(|(name, _)| name == founder).map_or(style::INK, |known| known.1);
    let entry = |founder: &&str| {
        let exponent = exponents.iter().find(|law| law.founder == **founder).map(|law| law.exponent);
        let law = exponent.map_or(String::new(), |exponent| format!(", exponent {exponent:.3}"));
        (Key::Point(colour(founder), Marker::Disc), format!("{founder}{law}"))
    };
    let legend = Legend::default().with_all(founders.iter().map(entry));
    let (mut canvas, top) = titled(WIDTH, CHART, "Lifetimes as powers of volumes, by founder", &legend);
    let x = logarithmic("volume of the cell, relative to the first cell's", cells.iter().map(|cell| cell.at_volume));
    let ends = |law: &FittedLaw| {
        let FittedLaw { exponent, lifetime_min, at_volume, volumes, .. } = law;
        volumes.map(|volume| [volume, lifetime_min * (volume / at_volume).powf(-exponent)])
    };
    let of_laws = exponents.iter().flat_map(ends).map(|end| end[1]);
    let y = logarithmic("lifetime (min)", cells.iter().map(|cell| cell.lifetime_min).chain(of_laws));
    let mut chart = Chart::new(&mut canvas, [0.0, top], [WIDTH, CHART], x, y);
    for law in exponents {
        chart.line(ends(law), Stroke::solid(colour(&law.founder), 1.6));
    }
    for cell in cells {
        chart.point([cell.at_volume, cell.lifetime_min], 4.5, Marker::Disc, colour(&cell.founder));
    }
    canvas
}
