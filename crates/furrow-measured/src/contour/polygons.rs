//! Contours in a table: a row for each point, in order around the cell.
//!
//! The columns are `x` and `y` (or `r` and `z`), in one length unit, and if the table has several contours `contour` (or `stage`,
//! `frame`, `id`), which is the same in all rows of one. A table of two columns of numbers needs no names.

use std::collections::HashMap;
use std::io::Read;

use csv::ByteRecord;
use furrow_input::{InputError, shown};
use serde::Serialize;

use super::Contour;
use crate::layout::listed;
use crate::table::{malformed, next, number, open, whole};

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
    /// What was done to it or is to be known of it.
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

/// What files of contours say.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contours {
    /// Contours, in the order of the files.
    pub traced: Vec<Traced>,
    /// Those that cannot be used.
    pub left_out: Vec<LeftOut>,
}

/// Where points, and the name of their contour, stand.
struct Places {
    x: usize,
    y: usize,
    contour: Option<usize>,
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
    /// Adds the contours of a table. `file` is what it is called in what is told of it.
    ///
    /// # Errors
    /// A table without the columns that it needs.
    pub fn read_table(&mut self, from: impl Read, file: &str) -> Result<(), InputError> {
        let mut reader = open(from, file)?;
        let mut record = ByteRecord::new();
        if !next(&mut reader, &mut record, file)? {
            return Err(malformed(file, 1, "the table is empty; its columns are x and y, a row for each point"));
        }
        let bare = record.len() == 2 && record.iter().all(|text| number(text.trim_ascii()).is_some());
        let places = if bare { Places { x: 0, y: 1, contour: None } } else { places(&record, file)? };
        let mut rings: Vec<Ring> = Vec::new();
        let mut known: HashMap<String, usize> = HashMap::new();
        let mut more = bare || next(&mut reader, &mut record, file)?;
        while more {
            let line = record.position().map_or(0, csv::Position::line);
            let text = |column: usize| record.get(column).unwrap_or_default().trim_ascii();
            let name = places.contour.map_or(String::new(), |at| String::from_utf8_lossy(text(at)).into_owned());
            let ring = *known.entry(name).or_insert_with_key(|name| {
                rings.push(Ring { name: name.clone(), first_line: line, ..Ring::default() });
                rings.len() - 1
            });
            rings[ring].take(line, [places.x, places.y].map(|column| (column, text(column))));
            more = next(&mut reader, &mut record, file)?;
        }
        whole(&reader, file)?;
        if rings.is_empty() {
            return Err(malformed(file, 1, "the table has columns but no points"));
        }
        for ring in rings {
            self.close(ring, file);
        }
        Ok(())
    }

    fn close(&mut self, ring: Ring, file: &str) {
        let (file, name) = (file.to_owned(), ring.name);
        if let Some((line, why)) = ring.wrong {
            self.left_out.push(LeftOut { file, contour: name, line: Some(line), why });
            return;
        }
        match Contour::new(ring.points) {
            Ok((contour, cut)) => {
                let told = format!("crosses itself; loops of {:.2} % of its area were cut off", 100.0 * cut);
                let notes = if cut > 0.0 { vec![told] } else { Vec::new() };
                self.traced.push(Traced { file, name, contour, pixel: None, notes });
            }
            Err(why) => {
                let line = Some(ring.first_line);
                self.left_out.push(LeftOut { file, contour: name, line, why: why.to_string() });
            }
        }
    }
}

impl Ring {
    /// Takes a point. One that cannot be read would leave a dent where it is missing: its contour is not used.
    fn take(&mut self, line: u64, texts: [(usize, &[u8]); 2]) {
        let mut point = [0.0; 2];
        for (value, (column, text)) in point.iter_mut().zip(texts) {
            match number(text) {
                Some(number) => *value = number,
                None if self.wrong.is_none() => {
                    let text = shown(&String::from_utf8_lossy(text));
                    self.wrong = Some((line, format!("column {}: {text} is not a finite number", column + 1)));
                }
                None => {}
            }
        }
        self.points.push(point);
    }
}

fn places(header: &ByteRecord, file: &str) -> Result<Places, InputError> {
    let names: Vec<String> = header.iter().map(|name| String::from_utf8_lossy(name).trim().to_lowercase()).collect();
    let find = |known: &[&str]| names.iter().position(|name| known.contains(&name.as_str()));
    let x = find(&["x", "x_um", "x_px", "r"]);
    let y = find(&["y", "y_um", "y_px", "z"]);
    let contour = find(&["contour", "stage", "frame", "id"]);
    match (x, y) {
        (Some(x), Some(y)) => Ok(Places { x, y, contour }),
        _ => {
            let message = format!(
                "a table of contours has the columns x and y (or r and z), and contour if it has several; the columns here are {}",
                listed(&names)
            );
            Err(malformed(file, 1, &message))
        }
    }
}
