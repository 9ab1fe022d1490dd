//! Tables of cell volumes, in four layouts.
//!
//! * *Long*: one row per cell, or per cell and frame. The columns, in any order: `cell`, `volume` (or with its unit:
//!   `volume_um3`, `volume_voxels`, `relative_volume`, each also with the prefix `mean_`), `embryo`, and optionally `group`,
//!   `frame`, `n` and `unit`.
//! * *Grid*: one row per frame, one column per cell, in voxels. The file is named after the embryo, as `Sample04_Volume.csv`.
//! * *Divisions*: one row per division, with the volumes of both daughters, `larger_um3` and `smaller_um3`, beside `embryo` and
//!   `mother`, and optionally `mother_um3`, `population` and `generation`.
//! * *χ*: one row per division, with `mother` and `chi` or `chi_signed`, and optionally `embryo` and `group`.
//!
//! Rows that begin with `#` are comments.
//!
//! A cell's volume is the mean over its frames. A value that cannot be used is skipped and reported with its place; a table
//! with none of these layouts is an error.

use std::collections::{BTreeSet, HashMap};
use std::io::Read;
use std::path::{Path, PathBuf};

use furrow_input::{InputError, csv_value, open_file};
use serde::Serialize;

use crate::events::Division;
pub use crate::layout::Unit;
use crate::layout::{ChiColumns, Columns, DivisionColumns, embryo_of_file};
use crate::names::{Names, understood};
use crate::table::{Table, number};
use crate::tracked::{TrackOptions, TrackedCell, TrackedLineage, read_tracked};

/// Options for reading a table.
#[derive(Clone, Debug, Default)]
pub struct ReadOptions {
    /// Edge of a voxel in µm, which converts voxels to µm³.
    pub voxel: Option<f64>,
    /// Group of rows without one.
    pub group: Option<String>,
    /// Names of cells in long tables and of cells that were followed; grids have Sulston's.
    pub names: Names,
}

impl ReadOptions {
    /// The volume of a voxel, 1 if unknown.
    pub(crate) fn voxel_volume(&self) -> f64 {
        self.voxel.map_or(1.0, |voxel| voxel.powi(3))
    }
}

/// The volume of one cell of an embryo, over its frames.
#[derive(Clone, Debug, PartialEq)]
pub struct Lifespan {
    /// Its name.
    pub cell: String,
    sum: f64,
    /// Frames.
    pub frames: u64,
    /// Line of its first value.
    line: u64,
    /// Its frames by their bits, where the table has a column of frames.
    seen: BTreeSet<u64>,
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

/// A value that could not be used.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Skipped {
    /// The file.
    pub file: String,
    /// Line, from 1.
    pub line: u64,
    /// Column, from 1, and its name.
    pub column: String,
    /// The text there.
    pub value: String,
    /// Why it cannot be used.
    pub why: String,
}

impl Skipped {
    pub(crate) fn new(file: &str, (value, why): &Rejected<'_>) -> Skipped {
        Skipped {
            file: file.to_owned(),
            line: value.line,
            column: format!("{} ({})", value.column + 1, value.name),
            value: String::from_utf8_lossy(&value.text[..value.text.len().min(80)]).into_owned(),
            why: why.clone(),
        }
    }

    /// The line, column, value and why, for an error that names the file itself.
    pub fn described(&self) -> String {
        let Skipped { line, column, value, why, .. } = self;
        format!("line {line}, column {column}: {value:?}: {why}")
    }
}

/// The place with its file, the value and why.
impl std::fmt::Display for Skipped {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Skipped { file, line, column, value, why } = self;
        write!(f, "{file}:{line}, column {column}: {value:?}: {why}")
    }
}

/// Most skipped values that are kept; all are counted.
pub const MOST_PLACES: usize = 1000;

/// Counts a value that cannot be used, and keeps it among the first.
pub(crate) fn note(kept: &mut Vec<Skipped>, count: &mut u64, skipped: impl FnOnce() -> Skipped) {
    *count += 1;
    if kept.len() < MOST_PLACES {
        kept.push(skipped());
    }
}

/// Volumes of the cells of some embryos.
#[derive(Clone, Debug, Default)]
pub struct Volumes {
    /// Embryos, in the order of the tables.
    pub embryos: Vec<Embryo>,
    /// Divisions of tables that have both daughters in a row, in the order of the tables.
    pub divisions: Vec<Division>,
    /// The unit of all; `None` before a table is read.
    pub unit: Option<Unit>,
    /// Values used.
    pub used: u64,
    /// Values that could not be used, at most [`MOST_PLACES`].
    pub skipped: Vec<Skipped>,
    /// How many there are.
    pub skipped_count: u64,
    /// Whether some are of nuclei rather than of cells.
    pub of_nuclei: bool,
    /// The names of cells, as the last table was read.
    pub names: Names,
    /// Indices of embryos by group and name, and of their cells.
    embryo_places: HashMap<(String, String), usize>,
    cell_places: HashMap<(usize, String), usize>,
    /// Lines of divisions by file, embryo and mother.
    pub(crate) division_lines: HashMap<(String, String, String), u64>,
}

/// A value with its place.
#[derive(Clone, Copy)]
pub(crate) struct Value<'r> {
    pub(crate) line: u64,
    column: usize,
    name: &'r str,
    pub(crate) text: &'r [u8],
}

impl<'r> Value<'r> {
    pub(crate) fn new((line, record): (u64, &'r csv::ByteRecord), header: &'r [String], column: usize) -> Value<'r> {
        let name = header.get(column).map_or("", String::as_str);
        Value { line, column, name, text: record.get(column).unwrap_or_default().trim_ascii() }
    }
}

/// A value that cannot be used, and why.
pub(crate) type Rejected<'r> = (Value<'r>, String);

impl Volumes {
    /// Adds a table. Reports name it `file`.
    ///
    /// # Errors
    /// A table without the required columns, or in another unit than the tables before.
    pub fn read(&mut self, from: impl Read, file: &str, options: &ReadOptions) -> Result<(), InputError> {
        let mut table = Table::open(from, file)?;
        // The first column of a grid may be called anything.
        let (line, header) = table.header(|header| header.iter().skip(1).any(|name| understood(name).is_some()))?;
        self.names = options.names.clone();
        let unit = if let Some(columns) = DivisionColumns::of(&header, (file, line))? {
            self.read_divisions(&mut table, file, options, &header, &columns)?
        } else if let Some(columns) = ChiColumns::of(&header, (file, line))? {
            self.read_chi(&mut table, file, options, &header, &columns)?
        } else if let Some(columns) = Columns::of(&header, (file, line))? {
            self.read_long(&mut table, file, options, &header, &columns)?
        } else {
            self.read_grid(&mut table, file, options, &header)?
        };
        let unit = if unit == Unit::Voxels && options.voxel.is_some() { Unit::CubicMicrometres } else { unit };
        self.require_unit(unit, file)
    }

    /// Adds a file: a table, or cells that another program [followed over time](crate::tracked).
    ///
    /// # Errors
    /// As [`Volumes::read`] and [`Volumes::add_tracked`].
    pub fn read_file(&mut self, path: &Path, options: &ReadOptions) -> Result<(), InputError> {
        match read_tracked(path, &TrackOptions { pixel: options.voxel, frame_minutes: None })? {
            Some(lineage) => self.add_tracked(lineage, options),
            None => self.read(open_file(path)?, &path.display().to_string(), options),
        }
    }

    /// The volumes of some files.
    ///
    /// # Errors
    /// As [`Volumes::read_file`], and files without a volume that can be used.
    pub fn of_files(files: &[PathBuf], options: &ReadOptions) -> Result<Volumes, InputError> {
        let mut volumes = Volumes::default();
        files.iter().try_for_each(|file| volumes.read_file(file, options))?;
        volumes.require_used(&files.first().map_or(String::new(), |file| file.display().to_string()))?;
        Ok(volumes)
    }

    /// Adds the cells of an embryo that were followed over time. Cells without a name of Sulston's and cells without a size are
    /// skipped.
    ///
    /// # Errors
    /// Volumes are in another unit than those before.
    pub fn add_tracked(&mut self, lineage: TrackedLineage, options: &ReadOptions) -> Result<(), InputError> {
        let (is_of_nuclei, unit) = (lineage.of_nuclei(), lineage.volumes);
        let names = &options.names;
        self.names = names.clone();
        let embryo = self.embryo(options.group.clone().unwrap_or_default(), lineage.name);
        self.skipped_count += lineage.skipped_count;
        self.skipped.extend(lineage.skipped.into_iter().take(MOST_PLACES.saturating_sub(self.skipped.len())));
        for TrackedCell { name, volume, sizes, place: (file, line), .. } in &lineage.cells {
            let value = Value { line: *line, column: 0, name: "name", text: name.as_bytes() };
            let refused = |why: &str| Err((value, why.to_owned()));
            let noted = match volume {
                _ if !names.is_cell(name) => refused(names.unknown()),
                None => refused("no size"),
                Some(volume) => {
                    let cell = self.cell(embryo, name, *line);
                    let lifespan = &mut self.embryos[embryo].cells[cell];
                    if lifespan.frames > 0 {
                        let why = "a second cell of this name; the first begins on line";
                        Err((value, format!("{why} {}", lifespan.line)))
                    } else {
                        (lifespan.sum, lifespan.frames) = (volume * *sizes as f64, *sizes);
                        Ok(())
                    }
                }
            };
            match noted {
                Ok(()) => self.used += sizes,
                Err(rejected) => self.skip(file, &rejected),
            }
        }
        self.of_nuclei |= is_of_nuclei;
        let file = lineage.cells.first().map_or("", |cell| &cell.place.0);
        self.require_unit(unit, file)
    }

    /// Requires that all volumes are in one unit.
    fn require_unit(&mut self, unit: Unit, file: &str) -> Result<(), InputError> {
        match self.unit.replace(unit).filter(|before| *before != unit) {
            Some(before) => {
                let before = before.symbol();
                let allowed = format!("{before}, the unit of the tables before (--voxel gives voxels their size)");
                Err(InputError::not_allowed(file, "unit", unit.symbol(), allowed))
            }
            None => Ok(()),
        }
    }

    /// Requires that a volume was used of the tables that were read; `tables` is their name if they have no rows.
    ///
    /// # Errors
    /// None was; the error has the first value that could not be used.
    pub fn require_used(&self, tables: &str) -> Result<(), InputError> {
        let first = self.skipped.first();
        let file = first.map_or(tables, |skipped| skipped.file.as_str());
        let value = format!("none used, {} skipped", self.skipped_count);
        let why = first.map_or("the table has no rows".to_owned(), Skipped::described);
        InputError::require(self.used > 0, file, "volumes", value, format!("at least one that can be used ({why})"))
    }

    fn read_long<R: Read>(
        &mut self,
        table: &mut Table<'_, R>,
        file: &str,
        options: &ReadOptions,
        header: &[String],
        columns: &Columns,
    ) -> Result<Unit, InputError> {
        let named = Unit::of_column(&header[columns.volume]);
        let (mut said, mut largest) = (None, 0.0_f64);
        while let Some(row) = table.next_row()? {
            let at = |column: usize| Value::new(row, header, column);
            if let Some(column) = columns.unit {
                note_unit(file, &at(column), &mut said)?;
            }
            let factor = if said.or(named) == Some(Unit::Voxels) { options.voxel_volume() } else { 1.0 };
            match self.read_row(columns, at, options, factor) {
                Ok(volume) => largest = largest.max(volume),
                Err(rejected) => self.skip(file, &rejected),
            }
        }
        // Without a unit, numbers that never exceed 1 are fractions.
        let bare = if largest <= 1.5 { Unit::Relative } else { Unit::CubicMicrometres };
        Ok(said.or(named).unwrap_or(bare))
    }

    /// Adds the volume, times `factor`, of a row of a long table, and returns it as written.
    fn read_row<'r>(
        &mut self,
        columns: &Columns,
        at: impl Fn(usize) -> Value<'r>,
        options: &ReadOptions,
        factor: f64,
    ) -> Result<f64, Rejected<'r>> {
        let volume = positive(at(columns.volume))?;
        let (cell, embryo) = (at(columns.cell), at(columns.embryo));
        let name = str::from_utf8(cell.text).ok().and_then(|name| options.names.understood(name)).ok_or_else(|| {
            (cell, (if cell.text.is_empty() { "no name of a cell" } else { options.names.unknown() }).to_owned())
        })?;
        if embryo.text.is_empty() {
            return Err((embryo, "no name of an embryo".to_owned()));
        }
        let text = |value: Value<'_>| csv_value(&String::from_utf8_lossy(value.text)).to_owned();
        let group = columns.group.map(|column| text(at(column))).unwrap_or_default();
        let given = options.group.clone().filter(|_| group.is_empty());
        let embryo = self.embryo(given.unwrap_or(group), text(embryo));
        let cell_place = self.cell(embryo, &name, cell.line);
        let frame = columns.frame.map(&at);
        let frame = frame.map(|frame| number(frame.text).ok_or((frame, "not a number".to_owned()))).transpose()?;
        if let Some(n) = columns.n.map(&at)
            && !n.text.is_empty()
            && number(n.text).is_none_or(|n| n < 1.0)
        {
            return Err((n, "not a number of frames".to_owned()));
        }
        let lifespan = &mut self.embryos[embryo].cells[cell_place];
        lifespan.note(volume * factor, frame, cell.line).map_err(|why| (cell, why))?;
        self.used += 1;
        Ok(volume)
    }

    fn read_grid<R: Read>(
        &mut self,
        table: &mut Table<'_, R>,
        file: &str,
        options: &ReadOptions,
        header: &[String],
    ) -> Result<Unit, InputError> {
        let embryo = self.embryo(options.group.clone().unwrap_or_default(), embryo_of_file(file));
        let mut places: Vec<Option<usize>> = vec![None];
        for (column, name) in header.iter().enumerate().skip(1) {
            let known = understood(name);
            if known.is_none() {
                let value = Value { line: 1, column, name, text: name.as_bytes() };
                self.skip(file, &(value, "no name of Sulston's".to_owned()));
            }
            places.push(known.map(|name| self.cell(embryo, &name, 1)));
        }
        while let Some(row) = table.next()? {
            for column in 1..row.1.len() {
                let value = Value::new(row, header, column);
                // An empty field: the cell does not exist in this frame.
                if value.text.is_empty() || value.text.eq_ignore_ascii_case(b"nan") {
                    continue;
                }
                let noted = match places.get(column) {
                    None => Err((value, "no column has a name for it".to_owned())),
                    Some(None) => continue,
                    Some(Some(cell)) => positive(value).and_then(|volume| {
                        let lifespan = &mut self.embryos[embryo].cells[*cell];
                        let noted = lifespan.note(volume * options.voxel_volume(), Some(row.0 as f64), value.line);
                        noted.map_err(|why| (value, why))
                    }),
                };
                match noted {
                    Ok(()) => self.used += 1,
                    Err(rejected) => self.skip(file, &rejected),
                }
            }
        }
        Ok(Unit::Voxels)
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
            cells.push(Lifespan { cell: name.to_owned(), sum: 0.0, frames: 0, line, seen: BTreeSet::new() });
            cells.len() - 1
        })
    }

    pub(crate) fn skip(&mut self, file: &str, rejected: &Rejected<'_>) {
        note(&mut self.skipped, &mut self.skipped_count, || Skipped::new(file, rejected));
    }
}

impl Lifespan {
    /// Adds a value, or says why it is one too many.
    fn note(&mut self, volume: f64, frame: Option<f64>, line: u64) -> Result<(), String> {
        if let Some(frame) = frame {
            if !self.seen.insert(frame.to_bits()) {
                return Err(format!("a second volume of this cell in frame {frame}"));
            }
        } else if self.frames > 0 {
            return Err(format!("a second volume of this cell, without a frame; the first is on line {}", self.line));
        }
        if self.frames == 0 {
            self.line = line;
        }
        self.sum += volume;
        self.frames += 1;
        Ok(())
    }
}

/// Requires one unit in all rows.
fn note_unit(file: &str, value: &Value<'_>, said: &mut Option<Unit>) -> Result<(), InputError> {
    let text = String::from_utf8_lossy(value.text);
    let field = format!("{} on line {}, column {}", value.name, value.line, value.column + 1);
    let refused = |allowed: String| InputError::not_allowed(file, &field, &text, allowed);
    let unit = Unit::written(&text).ok_or_else(|| refused("um3, voxels or relative".to_owned()))?;
    match said.replace(unit) {
        Some(before) if before != unit => Err(refused(format!("{}, the unit of the rows before", before.symbol()))),
        _ => Ok(()),
    }
}

/// Limits of a volume in any unit; sums beyond them could overflow.
const VOLUMES: [f64; 2] = [1e-100, 1e100];

/// Whether a text is a number but for its decimal comma, as spreadsheets of many countries write it.
fn has_decimal_comma(text: &[u8]) -> bool {
    let commas = text.iter().filter(|byte| **byte == b',').count();
    let point = text.iter().map(|byte| if *byte == b',' { b'.' } else { *byte }).collect::<Vec<u8>>();
    commas == 1 && number(&point).is_some()
}

/// A volume, which is positive.
pub(crate) fn positive(value: Value<'_>) -> Result<f64, Rejected<'_>> {
    let why = match number(value.text) {
        Some(volume) if volume > VOLUMES[0] && volume < VOLUMES[1] => return Ok(volume),
        Some(volume) if volume > 0.0 => "a volume must be from 1e-100 to 1e100",
        Some(_) => "a volume must be above 0",
        None if value.text.is_empty() => "no volume",
        None if has_decimal_comma(value.text) => "not a number: decimals need a point, as in 12.5",
        None => "not a number",
    };
    Err((value, why.to_owned()))
}
