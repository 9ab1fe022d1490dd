//! The picture of the floors: a row for each, a dot where it imports from the floor that a column is named after.

use std::collections::BTreeSet;
use std::fmt::Write;

/// A crate, its colour, and its floors from the highest to the lowest.
pub type Group = (&'static str, &'static str, Vec<&'static str>);

/// Side of a place of the table.
const SIDE: usize = 20;
/// Room for names on the left, and above for those of the columns.
const NAMES: [usize; 2] = [104, 104];
/// Room for names of crates on the right.
const CRATES: usize = 86;

/// The picture of `imports`, pairs of floors of which the first imports from the second.
pub fn picture(groups: &[Group], imports: &BTreeSet<(&str, &str)>) -> String {
    let floors: Vec<&str> = groups.iter().flat_map(|(_, _, floors)| floors.iter().copied()).collect();
    let [left, top] = NAMES;
    let (width, height) = (left + SIDE * floors.len() + CRATES, top + SIDE * floors.len() + 12);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
         font-family=\"sans-serif\" font-size=\"17\">\n<title>Floors of the code, and which imports from which</title>\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n"
    );
    let mut first = 0;
    for (name, colour, floors) in groups {
        bands(&mut out, [width, height], [first, floors.len()], name, colour);
        first += floors.len();
    }
    for (row, floor) in floors.iter().enumerate() {
        let (x, y) = (left + SIDE * row + SIDE / 2, top + SIDE * row + SIDE / 2);
        let _ = writeln!(out, "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{floor}</text>", left - 8, y + 6);
        let _ = writeln!(out, "<text transform=\"translate({} {}) rotate(-60)\">{floor}</text>", x + 2, top - 8);
        let _ = writeln!(out, "<rect x=\"{}\" y=\"{}\" width=\"12\" height=\"12\" fill=\"#bbbbbb\"/>", x - 6, y - 6);
        for (column, below) in floors.iter().enumerate() {
            if imports.contains(&(*floor, *below)) && row != column {
                let x = left + SIDE * column + SIDE / 2;
                let _ = writeln!(
                    out,
                    "<circle cx=\"{x}\" cy=\"{y}\" r=\"5\"><title>{floor} imports from {below}</title></circle>"
                );
            }
        }
    }
    out + "</svg>\n"
}

/// A crate's rows as a band, with its name at the end of it, and its columns as a square on the diagonal.
fn bands(out: &mut String, [width, _]: [usize; 2], [first, count]: [usize; 2], name: &str, colour: &str) {
    let [left, top] = NAMES;
    let (start, size) = (SIDE * first, SIDE * count);
    let y = top + start;
    let _ =
        writeln!(out, "<rect y=\"{y}\" width=\"{width}\" height=\"{size}\" fill=\"{colour}\" fill-opacity=\"0.18\"/>");
    let (x, middle) = (left + start, y + size / 2 + 5);
    let _ = writeln!(
        out,
        "<rect x=\"{x}\" y=\"{y}\" width=\"{size}\" height=\"{size}\" fill=\"{colour}\" fill-opacity=\"0.25\"/>"
    );
    let _ = writeln!(
        out,
        "<text x=\"{}\" y=\"{middle}\" text-anchor=\"end\" fill=\"#333333\" font-size=\"15\">{name}</text>",
        width - 6
    );
}
