//! Contours in tables: one row per point, in order around the cell.
//!
//! The columns are `x` and `y` (or `r` and `z`), in one unit, and for several contours `contour` (or `stage`, `frame`, `id`).
//! A table of two columns of numbers needs no header.

use std::collections::HashMap;
use std::io::Read;

use csv::ByteRecord;
use furrow_input::{InputError, shown};
use serde::Serialize;

use super::Contour;
use crate::table::{Table, listed, malformed, names, number};

/// A contour as it was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Traced {
    /// Its file.
    pub file: String,
    /// Its name within the file; empty if the file has no other.
    pub name: String,
    /// The contour, in the unit of the file; of a mask in pixels.
    pub contour: Contour,
    /// Side of a pixel in that unit, if it was traced in pixels.
    pub pixel: Option<f64>,
    /// Remarks, such as loops that were cut off.
    pub notes: Vec<String>,
}

/// A contour that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct LeftOut {
    /// Its file.
    pub file: String,
    /// Its name within the file.
    pub contour: String,
    /// The line where that is found, if the file has lines.
    pub line: Option<u64>,
    /// Why not.
    pub why: String,
}

/// The contours of some files.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contours {
    /// Contours, in the order of the files.
    pub traced: Vec<Traced>,
    /// Those that cannot be used.
    pub left_out: Vec<LeftOut>,
}

/// The points of a contour, and what is wrong with one.
#[derive(Default)]
struct Ring {
    name: String,
    first_line: u64,
    points: Vec<[f64; 2]>,
    wrong: Option<(u64, String)>,
}

impl Contours {
    /// Adds the contours of a table. Reports name it `file`.
    ///
    /// # Errors
    /// A table without the required columns.
    pub fn read_table(&mut self, from: impl Read, file: &str) -> Result<(), InputError> {
        let mut table = Table::open(from, file)?;
        let Some((line, record)) = table.next()? else {
            return Err(malformed(file, 1, "the table is empty; its columns are x and y, a row for each point"));
        };
        let bare = record.len() == 2 && record.iter().all(|text| number(text.trim_ascii()).is_some());
        let (columns, contour) = if bare { ([0, 1], None) } else { places(record, file)? };
        let mut rings: Vec<Ring> = Vec::new();
        let mut known: HashMap<String, usize> = HashMap::new();
        let mut take = |line: u64, record: &ByteRecord| {
            let text = |column: usize| record.get(column).unwrap_or_default().trim_ascii();
            let name = contour.map_or(String::new(), |at| String::from_utf8_lossy(text(at)).into_owned());
            let place = *known.entry(name).or_insert_with_key(|name| {
                rings.push(Ring { name: name.clone(), first_line: line, ..Ring::default() });
                rings.len() - 1
            });
            // An unreadable point would leave a dent, so its contour is not used.
            let Ring { points, wrong, .. } = &mut rings[place];
            points.push(columns.map(|column| {
                number(text(column)).unwrap_or_else(|| {
                    let text = shown(&String::from_utf8_lossy(text(column)));
                    wrong.get_or_insert((line, format!("column {}: {text} is not a finite number", column + 1)));
                    f64::NAN
                })
            }));
        };
        if bare {
            take(line, record);
        }
        while let Some((line, record)) = table.next()? {
            take(line, record);
        }
        if rings.is_empty() {
            return Err(malformed(file, 1, "the table has columns but no points"));
        }
        for Ring { name, first_line, points, wrong } in rings {
            match wrong {
                Some((line, why)) => {
                    self.left_out.push(LeftOut { file: file.to_owned(), contour: name, line: Some(line), why });
                }
                None => self.add(file, name, Some(first_line), points, None, Vec::new()),
            }
        }
        Ok(())
    }

    /// Adds the contour through these points, if it is one.
    pub(super) fn add(
        &mut self,
        file: &str,
        name: String,
        line: Option<u64>,
        points: Vec<[f64; 2]>,
        pixel: Option<f64>,
        mut notes: Vec<String>,
    ) {
        let file = file.to_owned();
        match Contour::new(points) {
            Ok((contour, cut)) => {
                if cut > 0.0 {
                    notes.push(format!("crosses itself; loops of {:.2} % of its area were cut off", 100.0 * cut));
                }
                self.traced.push(Traced { file, name, contour, pixel, notes });
            }
            Err(why) => self.left_out.push(LeftOut { file, contour: name, line, why: why.to_string() }),
        }
    }
}

/// The columns of the points, and of the name of their contour.
fn places(header: &ByteRecord, file: &str) -> Result<([usize; 2], Option<usize>), InputError> {
    let names: Vec<String> = names(header).iter().map(|name| name.to_lowercase()).collect();
    let find = |known: &[&str]| names.iter().position(|name| known.contains(&name.as_str()));
    if let (Some(x), Some(y)) = (find(&["x", "x_um", "x_px", "r"]), find(&["y", "y_um", "y_px", "z"])) {
        return Ok(([x, y], find(&["contour", "stage", "frame", "id"])));
    }
    let message = format!(
        "a table of contours has the columns x and y (or r and z), and contour if it has several; the columns here are {}",
        listed(&names)
    );
    Err(malformed(file, 1, message))
}
