//! Contours in tables: one row per point, in order around the cell.
//!
//! The columns are `x` and `y` (or `r` and `z`), in one unit, and for several contours `contour` (or `stage`, `frame`, `id`).
//! A table of two columns of numbers needs no header.

use std::collections::HashMap;
use std::io::Read;

use furrow_input::table::{Row, Table, columns_listed, malformed, split_unit, text};
use furrow_input::{InputError, shown};
use serde::Serialize;

use super::Contour;

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
    /// Its line, if the file has lines.
    pub line: Option<u64>,
    /// Why not.
    pub why: String,
}

/// The contours of some files.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contours {
    /// Contours, in the order of the files.
    pub traced: Vec<Traced>,
    /// Contours that cannot be used.
    pub left_out: Vec<LeftOut>,
}

/// The points of a contour, and the first error in one, with its line.
#[derive(Default)]
struct Ring {
    name: String,
    first_line: u64,
    points: Vec<[f64; 2]>,
    wrong: Option<(u64, String)>,
    /// The text of its first point in a third column of coordinates.
    depth: Option<Vec<u8>>,
}

impl Contours {
    /// Adds the contours of a table. Reports name it `file`.
    ///
    /// # Errors
    /// A table without the required columns.
    pub fn read_table(&mut self, from: impl Read, file: &str) -> Result<(), InputError> {
        let mut table = Table::open(from, file)?;
        let (line, header) = table.header(|_| false)?;
        table.share([0, 1]);
        let numbers = [0, 1].map(|column| table.numbers(column));
        let first = || numbers.iter().zip(&header).map(|(numbers, text)| numbers.read(text.as_bytes()));
        let is_bare = header.len() == 2 && first().all(|number| number.is_ok());
        let Places { columns, contour, third } =
            if is_bare { Places { columns: [0, 1], ..Places::default() } } else { Places::of(&header, (file, line))? };
        table.share(columns);
        let mut rings = Rings::default();
        if is_bare {
            let point = [0, 1].map(|k: usize| numbers[k].read(header[k].as_bytes()));
            rings.add(String::new(), line as u64, point.map(|x| x.unwrap_or(f64::NAN)), None);
        }
        while let Some(row) = table.next_row()? {
            let name = contour.map_or(String::new(), |at| text(row.text(at)).into_owned());
            let (point, wrong) = point(row, columns);
            let ring = rings.add(name, row.line, point, wrong);
            let depth = third.map(|at| (row.text(at), ring.depth.get_or_insert_with(|| row.text(at).to_vec())));
            if let Some((own, first)) = depth.filter(|(own, first)| own != first) {
                let [first, own] = [&*first, own].map(|text| shown(&self::text(text)));
                let why = format!(
                    "z is {first} before and {own} here: with x and y, z must be the same in the whole outline"
                );
                ring.wrong.get_or_insert((row.line, why));
            }
        }
        let is_of_points = contour.is_some_and(|at| header[at].eq_ignore_ascii_case("id"));
        let rings = if is_of_points { rings.joined_points() } else { rings.0 };
        if rings.is_empty() {
            return Err(malformed(file, 1, "the table has columns but no points"));
        }
        for Ring { name, first_line, points, wrong, .. } in rings {
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

/// Rings in the order of their first points, found by their names.
#[derive(Default)]
struct Rings(Vec<Ring>, HashMap<String, usize>);

impl Rings {
    /// The rings; where each has one point, the names are of points, which make one ring.
    fn joined_points(self) -> Vec<Ring> {
        let Rings(mut rings, _) = self;
        if rings.len() > 1 && rings.iter().all(|ring| ring.points.len() == 1) {
            let others = rings.split_off(1);
            rings[0].name.clear();
            for other in others {
                rings[0].points.extend(other.points);
                rings[0].wrong = rings[0].wrong.take().or(other.wrong);
            }
        }
        rings
    }

    /// Adds a point to the ring of this name.
    fn add(&mut self, name: String, line: u64, point: [f64; 2], wrong: Option<String>) -> &mut Ring {
        let Rings(rings, known) = self;
        let place = *known.entry(name).or_insert_with_key(|name| {
            rings.push(Ring { name: name.clone(), first_line: line, ..Ring::default() });
            rings.len() - 1
        });
        // An unreadable point would leave a dent, so its contour is not used.
        rings[place].points.push(point);
        if let Some(why) = wrong {
            rings[place].wrong.get_or_insert((line, why));
        }
        &mut rings[place]
    }
}

/// The point of a row, and its first error.
fn point(row: Row<'_>, columns: [usize; 2]) -> ([f64; 2], Option<String>) {
    let mut wrong = row.surplus().map(|(_, why)| why);
    let point = columns.map(|column| {
        row.number(column).unwrap_or_else(|why| {
            let text = shown(&text(row.text(column)));
            wrong.get_or_insert(format!("column {}: {text} is {why}", column + 1));
            f64::NAN
        })
    });
    (point, wrong)
}

/// The columns of the points, of the name of their contour, and of a third coordinate.
#[derive(Default)]
struct Places {
    columns: [usize; 2],
    contour: Option<usize>,
    third: Option<usize>,
}

impl Places {
    fn of(header: &[String], (file, line): (&str, usize)) -> Result<Places, InputError> {
        let names: Vec<String> = header.iter().map(|name| split_unit(name).0.to_lowercase()).collect();
        let find = |known: &[&str]| names.iter().position(|name| known.contains(&name.as_str()));
        let [x, y] = [find(&["x", "x_um", "x_px"]), find(&["y", "y_um", "y_px"])];
        let [r, z] = [find(&["r"]), find(&["z"])];
        let contour = find(&["contour", "stage", "frame", "id"]);
        if let (Some(x), Some(y)) = (x, y) {
            return Ok(Places { columns: [x, y], contour, third: z });
        }
        if let (Some(r), Some(z)) = (x.or(r), y.or(z)) {
            return Ok(Places { columns: [r, z], contour, third: None });
        }
        let message = format!(
            "a table of contours has the columns x and y (or r and z), and contour if it has several; the columns here are {}",
            columns_listed(header)
        );
        Err(malformed(file, line, message))
    }
}
