//! Contours in tables: one row per point, in order around the cell.
//!
//! The columns are `x` and `y` (or `r` and `z`), in one unit, and for several contours `contour` (or `stage`, `frame`, `id`).
//! A table of two columns of numbers needs no header. Since r is a distance from the axis, points in r and z that run from the axis to the
//! axis are one side of a section; the other is its mirror image.

use std::collections::HashMap;
use std::io::Read;

use furrow_input::table::{Row, Table, columns_listed, malformed, split_unit, text, unit_word};
use furrow_input::{InputError, shown};
use serde::Serialize;

use super::Contour;
use crate::tracked::lengths::length_unit;

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
    /// The unit of lengths of the first file that has one.
    unit: Option<String>,
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
        let Places { columns, contour, third, from_axis, unit } =
            if is_bare { Places { columns: [0, 1], ..Places::default() } } else { Places::of(&header, (file, line))? };
        let scale = unit.map_or(Ok(1.0), |unit| self.scale(&unit, file))?;
        table.share(columns);
        let mut rings = Rings::default();
        if is_bare {
            let point = [0, 1].map(|k: usize| numbers[k].read(header[k].as_bytes()));
            rings.add(String::new(), line as u64, point.map(|x| x.unwrap_or(f64::NAN)), None);
        }
        while let Some(row) = table.next_row()? {
            let name = contour.map_or(String::new(), |at| text(row.text(at)).into_owned());
            let (point, wrong) = point(row, columns);
            let point = point.map(|x| scale * x);
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
        for Ring { name, first_line, mut points, wrong, .. } in rings {
            let mut notes = Vec::new();
            if let Some(both) = both_sides(&points).filter(|_| from_axis) {
                points = both;
                notes.push("is one side of a section, from the axis to the axis: the other side was added".to_owned());
            }
            let off_axis = || (first_line, OFF_AXIS.to_owned());
            match wrong.or_else(|| (from_axis && is_open_side(&points)).then(off_axis)) {
                Some((line, why)) => {
                    self.left_out.push(LeftOut { file: file.to_owned(), contour: name, line: Some(line), why });
                }
                None => self.add(file, name, Some(first_line), points, None, notes),
            }
        }
        Ok(())
    }

    /// The factor from a file's unit of lengths to the first file's.
    ///
    /// # Errors
    /// Units that cannot be converted.
    pub(super) fn scale(&mut self, unit: &str, file: &str) -> Result<f64, InputError> {
        let first = self.unit.get_or_insert_with(|| unit.to_owned());
        match [unit, first].map(length_unit) {
            _ if unit == first => Ok(1.0),
            [Some(own), Some(first)] if own.kind == first.kind => Ok(own.size / first.size),
            _ => Err(InputError::not_allowed(file, "unit", unit, format!("{first}, the unit of the files before"))),
        }
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

/// Why an outline in r and z cannot be used if no point of it is on the axis.
const OFF_AXIS: &str =
    "this is one side of a section that does not reach the axis: its first and last point need r = 0";

/// The distance along the axis from each point to the one before it, as a share of the section's length.
fn gaps(points: &[[f64; 2]]) -> impl Fn(usize) -> f64 {
    let along = points.iter().map(|point| point[1]);
    let length = along.clone().fold(f64::NEG_INFINITY, f64::max) - along.fold(f64::INFINITY, f64::min);
    move |k| (points[k][1] - before(points, k)[1]).abs() / length
}

/// The point before a point of a closed outline.
fn before(points: &[[f64; 2]], k: usize) -> &[f64; 2] {
    &points[(k + points.len() - 1) % points.len()]
}

/// A larger gap than this leaves a section open.
const OPEN: f64 = 0.5;

/// Whether points with r and z are one side of a section that does not reach the axis: exactly one gap is large.
fn is_open_side(points: &[[f64; 2]]) -> bool {
    let gap = gaps(points);
    points.iter().all(|point| point[0] > 0.0) && (0..points.len()).filter(|k| gap(*k) > OPEN).count() == 1
}

/// Distance from the axis, as a share of the largest, up to which a point is on the axis.
const ON_AXIS: f64 = 0.02;

/// Both sides of a section, from the points of one side in r and z; `None` for other points. One side has no point beyond the axis, and
/// two neighbouring points on the axis are more than half of the section's length apart.
fn both_sides(points: &[[f64; 2]]) -> Option<Vec<[f64; 2]>> {
    let widest = points.iter().map(|point| point[0]).fold(0.0, f64::max);
    let is_beside = |point: &[f64; 2]| point[0] >= -ON_AXIS * widest;
    if widest <= 0.0 || !points.iter().all(is_beside) {
        return None;
    }
    let gap = gaps(points);
    let on_axis = |point: &[f64; 2]| point[0] <= ON_AXIS * widest;
    let open = (0..points.len()).filter(|k| on_axis(&points[*k]) && on_axis(before(points, *k)));
    let first = open.max_by(|a, b| gap(*a).total_cmp(&gap(*b))).filter(|k| gap(*k) > OPEN)?;
    let mut side = points.to_vec();
    side.rotate_left(first);
    let other = side.iter().rev().map(|[r, z]| [-r, *z]).collect::<Vec<_>>();
    side.extend(other);
    Some(side)
}

/// The columns of the points, of the name of their contour, and of a third coordinate.
#[derive(Default)]
struct Places {
    columns: [usize; 2],
    contour: Option<usize>,
    third: Option<usize>,
    /// Whether the first column is the distance from the axis.
    from_axis: bool,
    /// The unit in the headings.
    unit: Option<String>,
}

/// The coordinate of a column, `x`, `y`, `r` or `z`, and its unit, as in `x`, `x (µm)` or `x_px`. A number, as in `x2`, numbers outlines.
fn coordinate(heading: &str) -> Option<(char, Option<String>)> {
    let (name, unit) = split_unit(heading);
    let name = name.to_lowercase();
    let of_name = ["um", "px"].into_iter().find_map(|unit| Some((name.strip_suffix(unit)?.strip_suffix('_')?, unit)));
    let (name, unit) = of_name.map_or((&*name, unit), |(name, of_name)| (name, unit.or(Some(of_name))));
    let name = name.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end_matches(['_', '.', ' ']);
    let mut letters = name.chars();
    let letter = letters.next().filter(|letter| "xyrz".contains(*letter) && letters.next().is_none())?;
    Some((letter, unit.map(unit_word)))
}

impl Places {
    fn of(header: &[String], (file, line): (&str, usize)) -> Result<Places, InputError> {
        let refused = |why: String| Err(malformed(file, line, why));
        let coordinates: Vec<Option<(char, Option<String>)>> = header.iter().map(|name| coordinate(name)).collect();
        let is_of = |at: &usize, letter: char| coordinates[*at].as_ref().is_some_and(|(own, _)| *own == letter);
        let find = |letter: char| (0..header.len()).find(|at| is_of(at, letter));
        let contour = header.iter().position(|name| CONTOUR.contains(&split_unit(name).0.to_lowercase().as_str()));
        let (third, across, along) = match (find('x'), find('y'), find('r'), find('z')) {
            (Some(x), Some(y), _, z) => (z, x, y),
            (x, y, r, z) => match (x.or(r), y.or(z)) {
                (Some(across), Some(along)) => (None, across, along),
                _ => {
                    return refused(format!(
                        "a table of contours has the columns x and y (or r and z), and contour if it has several; \
                         the columns here are {}",
                        columns_listed(header)
                    ));
                }
            },
        };
        for column in [across, along] {
            let letter = coordinates[column].as_ref().map_or(' ', |(letter, _)| *letter);
            if let Some(second) = (column + 1..header.len()).find(|at| is_of(at, letter)) {
                let [first, second] = [column, second].map(|at| shown(&header[at]));
                return refused(format!(
                    "{first} and {second} both have {letter}: one of them must be left out; several outlines are below \
                     each other, with a column contour"
                ));
            }
        }
        let unit = |at: usize| coordinates[at].as_ref().and_then(|(_, unit)| unit.as_deref()).unwrap_or("none");
        if unit(across) != unit(along) {
            let [first, second] = [across, along].map(|at| format!("{} has {}", shown(&header[at]), unit(at)));
            return refused(format!("both coordinates must have one unit; {first}, {second}"));
        }
        let from_axis = is_of(&across, 'r') && is_of(&along, 'z');
        let unit = coordinates[across].as_ref().and_then(|(_, unit)| unit.clone());
        Ok(Places { columns: [across, along], contour, third, from_axis, unit })
    }
}

/// Names of the column that tells several contours apart.
const CONTOUR: [&str; 4] = ["contour", "stage", "frame", "id"];
