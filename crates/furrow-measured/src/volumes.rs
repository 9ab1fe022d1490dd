//! Tables of cell volumes, in the two layouts that segmentations come in.
//!
//! * *Long*: a row for each cell, or for each cell and frame. The columns, in any order: `cell`, `volume` (or with its unit:
//!   `volume_um3`, `volume_voxels`, `relative_volume`, each also with `mean_` before it), `embryo`, and if wanted `group`,
//!   `frame` and `n`.
//! * *Grid*: a row for each frame, a column for each cell, volumes in voxels, of the embryo that the file is named after: the
//!   layout of `Sample04_Volume.csv`.
//!
//! A cell's volume is the mean over the frames in which it is seen. What a row says that cannot be used is skipped and told with
//! its place; a table that is none of the two is refused.

use std::collections::HashMap;
use std::io::Read;

use csv::ByteRecord;
use furrow_input::InputError;
use serde::Serialize;

pub use crate::layout::Unit;
use crate::layout::{Columns, embryo_of_file};
use crate::names::is_cell;
use crate::table::{malformed, next, number, open, whole};

/// How a table is to be read.
#[derive(Clone, Debug, Default)]
pub struct ReadOptions {
    /// Length of a voxel's edge, in µm: volumes in voxels are µm³ by it.
    pub voxel: Option<f64>,
    /// Group of the rows that name none.
    pub group: Option<String>,
}

/// The volume of one cell of an embryo, in the frames in which it is seen.
#[derive(Clone, Debug, PartialEq)]
pub struct Lifespan {
    /// Its name.
    pub cell: String,
    sum: f64,
    /// Frames.
    pub frames: u64,
    /// Line of its first value.
    line: u64,
    /// Frames seen so far, in order, where the table tells them.
    seen: Vec<f64>,
}

impl Lifespan {
    /// The mean over its frames.
    pub fn volume(&self) -> f64 {
        self.sum / self.frames as f64
    }
}

/// An embryo.
#[derive(Clone, Debug, PartialEq)]
pub struct Embryo {
    /// Its name.
    pub name: String,
    /// Its group; empty if it has none.
    pub group: String,
    /// Its cells, in the order of the table.
    pub cells: Vec<Lifespan>,
}

/// Something that a table says and that could not be used.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Skipped {
    /// The file.
    pub file: String,
    /// Line, from 1.
    pub line: u64,
    /// Column, from 1, and its name.
    pub column: String,
    /// What stands there.
    pub value: String,
    /// Why it cannot be used.
    pub why: String,
}

/// How many skipped values are kept with their places; all are counted.
pub const MOST_PLACES: usize = 1000;

/// Volumes of the cells of some embryos.
#[derive(Clone, Debug, Default)]
pub struct Volumes {
    /// Embryos, in the order of the tables.
    pub embryos: Vec<Embryo>,
    /// The unit of all; none before anything is read.
    pub unit: Option<Unit>,
    /// Values used.
    pub used: u64,
    /// Values that could not be used: the first [`MOST_PLACES`] with their places.
    pub skipped: Vec<Skipped>,
    /// How many there are.
    pub skipped_count: u64,
    /// Where embryos are kept, by group and name, and their cells.
    embryo_places: HashMap<(String, String), usize>,
    cell_places: HashMap<(usize, String), usize>,
}

/// A long table that is being read.
struct LongTable<'t> {
    file: &'t str,
    options: &'t ReadOptions,
    columns: &'t Columns,
    /// The unit that the column of volumes is named after.
    named: Option<Unit>,
    /// The unit that rows say.
    said: Option<Unit>,
    /// Group, embryo and cell of the row before, and where its value went: rows of one cell follow each other as a rule.
    last: Option<([Vec<u8>; 3], (usize, usize))>,
    largest: f64,
}

impl LongTable<'_> {
    fn unit(&self) -> Unit {
        // A bare number that is nowhere above 1 is a share.
        let bare = if self.largest <= 1.5 { Unit::Relative } else { Unit::CubicMicrometres };
        self.said.or(self.named).unwrap_or(bare)
    }
}

/// What a volume is multiplied by to be in the unit that its table is taken in.
fn scale(unit: Unit, options: &ReadOptions) -> f64 {
    if unit == Unit::Voxels { options.voxel.map_or(1.0, |voxel| voxel.powi(3)) } else { 1.0 }
}

/// A value with its place.
struct Value<'r> {
    line: u64,
    column: usize,
    name: &'r str,
    text: &'r [u8],
}

impl Volumes {
    /// Adds a table. `file` is what it is called in what is told of it.
    ///
    /// # Errors
    /// A table without the columns that it needs, or in another unit than those before.
    pub fn read(&mut self, from: impl Read, file: &str, options: &ReadOptions) -> Result<(), InputError> {
        let mut reader = open(from, file)?;
        let mut record = ByteRecord::new();
        if !next(&mut reader, &mut record, file)? {
            return Err(malformed(file, 1, "the table is empty; its first line must name its columns"));
        }
        let header: Vec<String> = record.iter().map(|name| String::from_utf8_lossy(name).trim().to_owned()).collect();
        match Columns::of(&header, file)? {
            Some(columns) => self.read_long(&mut reader, file, options, &header, &columns)?,
            None => self.read_grid(&mut reader, file, options, &header)?,
        }
        whole(&reader, file)
    }

    fn read_long<R: Read>(
        &mut self,
        reader: &mut csv::Reader<R>,
        file: &str,
        options: &ReadOptions,
        header: &[String],
        columns: &Columns,
    ) -> Result<(), InputError> {
        let named = Unit::of_column(&header[columns.volume]);
        let mut table = LongTable { file, options, columns, named, said: None, last: None, largest: 0.0 };
        let mut record = ByteRecord::new();
        while next(reader, &mut record, file)? {
            let line = record.position().map_or(0, csv::Position::line);
            let at = |column: usize| Value {
                line,
                column,
                name: header.get(column).map_or("", String::as_str),
                text: record.get(column).unwrap_or_default().trim_ascii(),
            };
            if let Some((value, why)) = self.read_row(&mut table, at)? {
                self.skip(file, &value, &why);
            }
        }
        self.settle(file, options, table.unit())
    }

    /// Takes one row of a long table; gives what cannot be used of it, and why.
    fn read_row<'r>(
        &mut self,
        table: &mut LongTable<'_>,
        at: impl Fn(usize) -> Value<'r>,
    ) -> Result<Option<(Value<'r>, String)>, InputError> {
        let columns = table.columns;
        if let Some(column) = columns.unit {
            note_unit(table.file, &at(column), &mut table.said)?;
        }
        let volume = match positive(at(columns.volume).text) {
            Ok(volume) => volume,
            Err(why) => return Ok(Some((at(columns.volume), why.to_owned()))),
        };
        let group = columns.group.map(|column| at(column).text).unwrap_or_default();
        let (cell, embryo) = (at(columns.cell), at(columns.embryo));
        let names = [group, embryo.text, cell.text];
        let (embryo_place, cell_place) = match &table.last {
            Some((known, places)) if *known == names => *places,
            _ => {
                if !std::str::from_utf8(cell.text).is_ok_and(is_cell) {
                    let why = if cell.text.is_empty() { "no name of a cell" } else { "no name of Sulston's" };
                    return Ok(Some((cell, why.to_owned())));
                }
                if embryo.text.is_empty() {
                    return Ok(Some((embryo, "no name of an embryo".to_owned())));
                }
                let [group, name, cell_name] = names.map(|name| String::from_utf8_lossy(name).into_owned());
                let given = table.options.group.clone().filter(|_| group.is_empty());
                let place = self.embryo(given.unwrap_or(group), name);
                let places = (place, self.cell(place, &cell_name, cell.line));
                table.last = Some((names.map(<[u8]>::to_vec), places));
                places
            }
        };
        let frame = match columns.frame.map(&at) {
            Some(frame) => match number(frame.text) {
                Some(number) => Some(number),
                None => return Ok(Some((frame, "not a number".to_owned()))),
            },
            None => None,
        };
        if let Some(n) = columns.n.map(&at)
            && !n.text.is_empty()
            && number(n.text).is_none_or(|n| n < 1.0)
        {
            return Ok(Some((n, "not a number of frames".to_owned())));
        }
        let scaled = volume * scale(table.unit(), table.options);
        if let Some(why) = self.embryos[embryo_place].cells[cell_place].note(scaled, frame, cell.line) {
            return Ok(Some((cell, why)));
        }
        self.used += 1;
        table.largest = table.largest.max(volume);
        Ok(None)
    }

    fn read_grid<R: Read>(
        &mut self,
        reader: &mut csv::Reader<R>,
        file: &str,
        options: &ReadOptions,
        header: &[String],
    ) -> Result<(), InputError> {
        let stem = embryo_of_file(file);
        let group = options.group.clone().unwrap_or_default();
        let embryo = self.embryo(group, stem);
        let mut places: Vec<Option<usize>> = vec![None];
        for (column, name) in header.iter().enumerate().skip(1) {
            let known = is_cell(name);
            if !known {
                self.skip(file, &Value { line: 1, column, name, text: name.as_bytes() }, "no name of Sulston's");
            }
            places.push(known.then(|| self.cell(embryo, name, 1)));
        }
        let mut record = ByteRecord::new();
        while next(reader, &mut record, file)? {
            let line = record.position().map_or(0, csv::Position::line);
            for (column, text) in record.iter().enumerate().skip(1) {
                let value = Value {
                    line,
                    column,
                    name: header.get(column).map_or("", String::as_str),
                    text: text.trim_ascii(),
                };
                // A cell that is not there in a frame has no volume in it.
                if value.text.is_empty() || value.text.eq_ignore_ascii_case(b"nan") {
                    continue;
                }
                if column >= header.len() {
                    self.skip(file, &value, "no column has a name for it");
                    continue;
                }
                let Some(cell) = places[column] else { continue };
                let volume = match positive(value.text) {
                    Ok(volume) => volume * scale(Unit::Voxels, options),
                    Err(why) => {
                        self.skip(file, &value, why);
                        continue;
                    }
                };
                // Rows are frames, each told once.
                match self.embryos[embryo].cells[cell].note(volume, Some(line as f64), line) {
                    Some(why) => self.skip(file, &value, &why),
                    None => self.used += 1,
                }
            }
        }
        self.settle(file, options, Unit::Voxels)
    }

    /// The unit of a table must be that of all.
    fn settle(&mut self, file: &str, options: &ReadOptions, unit: Unit) -> Result<(), InputError> {
        let unit = match (unit, options.voxel) {
            (Unit::Voxels, Some(_)) => Unit::CubicMicrometres,
            (unit, _) => unit,
        };
        match self.unit.replace(unit).filter(|before| *before != unit) {
            Some(before) => Err(InputError::NotAllowed {
                source_name: file.to_owned(),
                field: "unit".to_owned(),
                value: unit.symbol().to_owned(),
                allowed: format!(
                    "{}, the unit of the tables before (--voxel gives voxels their size)",
                    before.symbol()
                ),
            }),
            None => Ok(()),
        }
    }

    fn embryo(&mut self, group: String, name: String) -> usize {
        let embryos = &mut self.embryos;
        *self.embryo_places.entry((group.clone(), name.clone())).or_insert_with(|| {
            embryos.push(Embryo { name, group, cells: Vec::new() });
            embryos.len() - 1
        })
    }

    fn cell(&mut self, embryo: usize, name: &str, line: u64) -> usize {
        let cells = &mut self.embryos[embryo].cells;
        *self.cell_places.entry((embryo, name.to_owned())).or_insert_with(|| {
            cells.push(Lifespan { cell: name.to_owned(), sum: 0.0, frames: 0, line, seen: Vec::new() });
            cells.len() - 1
        })
    }

    fn skip(&mut self, file: &str, value: &Value<'_>, why: &str) {
        self.skipped_count += 1;
        if self.skipped.len() < MOST_PLACES {
            self.skipped.push(Skipped {
                file: file.to_owned(),
                line: value.line,
                column: format!("{} ({})", value.column + 1, value.name),
                value: String::from_utf8_lossy(&value.text[..value.text.len().min(80)]).into_owned(),
                why: why.to_owned(),
            });
        }
    }
}

impl Lifespan {
    /// Adds a value; says why not if it is one too many.
    fn note(&mut self, volume: f64, frame: Option<f64>, line: u64) -> Option<String> {
        match frame {
            None if self.frames > 0 => {
                return Some(format!(
                    "a second volume of this cell, without a frame; the first is on line {}",
                    self.line
                ));
            }
            None => {}
            Some(frame) => {
                // Frames come in order as a rule.
                let place = match self.seen.last() {
                    Some(last) if frame > *last => Err(self.seen.len()),
                    _ => self.seen.binary_search_by(|seen| seen.total_cmp(&frame)),
                };
                match place {
                    Ok(_) => return Some(format!("a second volume of this cell in frame {frame}")),
                    Err(place) => self.seen.insert(place, frame),
                }
            }
        }
        if self.frames == 0 {
            self.line = line;
        }
        self.sum += volume;
        self.frames += 1;
        None
    }
}

/// A unit column must say the same all along.
fn note_unit(file: &str, value: &Value<'_>, said: &mut Option<Unit>) -> Result<(), InputError> {
    let text = String::from_utf8_lossy(value.text);
    let refused = |allowed: String| InputError::NotAllowed {
        source_name: file.to_owned(),
        field: format!("{} on line {}, column {}", value.name, value.line, value.column + 1),
        value: text.to_string(),
        allowed,
    };
    let unit = Unit::written(&text).ok_or_else(|| refused("um3, voxels or relative".to_owned()))?;
    match said.replace(unit) {
        Some(before) if before != unit => Err(refused(format!("{}, the unit of the rows before", before.symbol()))),
        _ => Ok(()),
    }
}

/// Volumes of any cell, in any unit. Beyond, sums of them would be lost to overflow.
const VOLUMES: [f64; 2] = [1e-100, 1e100];

/// A volume, which is positive; else why it is none.
fn positive(text: &[u8]) -> Result<f64, &'static str> {
    match number(text) {
        Some(volume) if volume > VOLUMES[0] && volume < VOLUMES[1] => Ok(volume),
        Some(volume) if volume > 0.0 => Err("a volume must be from 1e-100 to 1e100"),
        Some(_) => Err("a volume must be above 0"),
        None if text.is_empty() => Err("no volume"),
        None => Err("not a number"),
    }
}
