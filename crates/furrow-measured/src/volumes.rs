//! Tables of cell volumes, in four layouts.
//!
//! * *Long*: one row per cell, or per cell and frame. The columns, in any order: `cell`, `volume` (or with its unit:
//!   `volume_um3`, `volume_voxels`, `relative_volume`, each also with the prefix `mean_`), `embryo`, and optionally `group`,
//!   `frame`, `unit` and `n`: the number of frames in a mean, at least 1, which gives it no more weight.
//! * *Grid*: one row per frame, one column per cell, in voxels. The file is named after the embryo, as `Sample04_Volume.csv`; or one
//!   row per embryo, with a column `embryo`.
//! * *Divisions*: one row per division, with the volumes of both daughters, `larger_um3` and `smaller_um3`, beside `embryo` and
//!   `mother`, and optionally `mother_um3`, `population` and `generation`.
//! * *χ*: one row per division, with `mother` (or one per cell, with `cell` and `mother`: χ is the cell's) and `chi` or `chi_signed`, and optionally `embryo`, `group`, the standard deviation of
//!   χ, `chi_sd`, and the mother's volume with its unit, `mother_um3`.
//!
//! Rows that begin with `#` are comments.
//!
//! A cell's volume is the mean over its frames. A value that cannot be used is skipped and reported with its place; a table
//! with another layout is an error.

use std::cell::Cell;
use std::collections::{BTreeSet, HashMap};
use std::io::Read;

use furrow_input::table::{Header, Numbers, Row, Table, malformed, text, unit_of};
use furrow_input::{InputError, csv_value};
use serde::Serialize;

use crate::division_table::{chi_division, division};
use crate::events::Division;
pub use crate::layout::Unit;
use crate::layout::{
    ChiColumns, Columns, DivisionColumns, POPULATION, SUMMARY, VOLUMES, VolumeUnit, embryo_of_file, is_absent,
    is_summary, volume_column,
};
use crate::matching::Matched;
use crate::names::Names;
use crate::pace::{InEmbryos, Shares, shares};
use crate::per_embryo::PerEmbryo;
use crate::several::Source;
use crate::tracked::{EmbryoFile, TrackOptions, TrackedCell, TrackedLineage, open_table, read_tracked};

/// Options for reading a table.
#[derive(Clone, Debug, Default)]
pub struct ReadOptions {
    /// Edge of a voxel in µm, which converts voxels to µm³.
    pub voxel: PerEmbryo,
    /// Group of rows without one.
    pub group: Option<String>,
    /// Unit of tables without a unit in headings and columns.
    pub unit: Option<Unit>,
    /// Names of cells in long tables and of cells that were followed; grids have Sulston's.
    pub names: Names,
    /// Columns of tables of divisions and of χ that name the mother's class by their joined texts. An embryo may have several mothers
    /// of one class.
    pub class: Vec<String>,
}

impl ReadOptions {
    /// The kind of unit of volumes: as a table states it, else as it is given. Volumes without a unit are in voxels if these have a size.
    pub(crate) fn kind_of(&self, stated: Option<VolumeUnit>) -> Option<Unit> {
        let of_voxels = (!self.voxel.is_empty()).then_some(Unit::Voxels);
        stated.map(|unit| unit.kind).or(self.unit).or(of_voxels)
    }

    /// The factor from a volume's unit to the unit of results.
    pub(crate) fn factor(&self, stated: Option<VolumeUnit>, embryo: &str) -> f64 {
        match self.kind_of(stated) {
            Some(Unit::Voxels) => self.voxel_volume(embryo),
            _ => stated.map_or(1.0, |unit| unit.size),
        }
    }

    /// The volume of a voxel of an embryo, 1 if unknown.
    pub(crate) fn voxel_volume(&self, embryo: &str) -> f64 {
        self.voxel.of(embryo).map_or(1.0, |voxel| voxel.powi(3))
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
    pub(crate) line: u64,
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
    /// Its group; empty without groups.
    pub group: String,
    /// Its cells, in the order of the table.
    pub cells: Vec<Lifespan>,
    /// Its name in its table, and the table.
    pub(crate) source: Source,
}

/// An embryo beside the others.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EmbryoSize {
    /// Its name.
    pub embryo: String,
    /// Its group; empty without groups.
    pub group: String,
    /// Its cells with a volume.
    pub cells: usize,
    /// How many of these other embryos have too.
    pub shared: usize,
    /// Edge of its voxels in µm, where it is given.
    pub voxel: Option<f64>,
    /// The volumes of its cells divided by the volumes in all embryos; `None` if no shared cells connect it with most embryos.
    pub size_factor: Option<f64>,
    /// Standard deviation of ln volume about what its factor gives.
    pub scatter: Option<f64>,
    /// One L_h in this embryo, where one of all is known: in proportion to the cube root of its factor.
    pub length_scale: Option<f64>,
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
            value: text(&value.text[..value.text.len().min(80)]).into_owned(),
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
        // A field beyond the heading has no column.
        let column = if column.is_empty() { String::new() } else { format!(", column {column}") };
        write!(f, "{file}:{line}{column}: {value:?}: {why}")
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

/// Requires that a table has a value that can be used, or names the first one that cannot.
pub(crate) fn require_used(used: u64, place: (&str, &str), skipped: &[Skipped], count: u64) -> Result<(), InputError> {
    let first = skipped.first().map_or("the table has no rows".to_owned(), Skipped::described);
    let (value, allowed) = (format!("none used, {count} skipped"), format!("at least one that can be used ({first})"));
    InputError::require(used > 0, place.0, place.1, value, allowed)
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
    /// Whether groups are populations of cells in the same embryos rather than groups of embryos.
    pub of_populations: bool,
    /// The names of cells, as the last table was read.
    pub names: Names,
    /// How the cells of embryos that were followed were matched to the names.
    pub matched: Vec<Matched>,
    /// Tables and embryos that were read.
    pub files: usize,
    /// Edges of voxels, as the last table was read.
    pub voxels: PerEmbryo,
    /// Whether volumes are divided by the size factor of their embryo before they are averaged.
    pub common_size: bool,
    /// The unit given for volumes without one, as the last table was read.
    given_unit: Option<Unit>,
    /// Whether a volume had no unit, or the given one; and whether one was in voxels or pixels.
    takes_unit: bool,
    in_voxels: bool,
    /// The first embryo in voxels without an edge, where other embryos have one.
    without_voxel: Option<String>,
    /// Indices of embryos by group and name, and of their cells.
    embryo_places: HashMap<(String, String), usize>,
    cell_places: HashMap<(usize, String), usize>,
    /// Lines of divisions by file, embryo, group and mother.
    pub(crate) division_lines: HashMap<[String; 4], u64>,
    /// Embryos of the divisions, as their tables name them.
    pub(crate) division_sources: Vec<Source>,
    /// The texts that make up the name of each class.
    pub(crate) classes: HashMap<String, Vec<String>>,
}

/// A value with its place.
#[derive(Clone, Copy)]
pub(crate) struct Value<'r> {
    pub(crate) line: u64,
    column: usize,
    pub(crate) name: &'r str,
    pub(crate) text: &'r [u8],
    numbers: Numbers,
}

impl<'r> Value<'r> {
    pub(crate) fn new(row: Row<'r>, column: usize) -> Value<'r> {
        Value { line: row.line, column, name: row.name(column), text: row.text(column), numbers: row.numbers(column) }
    }

    /// The number, or the reason why the text is not a number.
    pub(crate) fn number(self) -> Result<f64, Rejected<'r>> {
        self.numbers.read(self.text).map_err(|why| (self, why))
    }

    /// The name of `what`, an embryo or a mother.
    ///
    /// # Errors
    /// The field is empty, or the row summarises others.
    pub(crate) fn named(self, what: &str) -> Result<String, Rejected<'r>> {
        match self.text {
            name if is_absent(name) => Err((self, format!("no name of {what}"))),
            name if is_summary(name) => Err((self, SUMMARY.to_owned())),
            _ => Ok(self.written()),
        }
    }

    /// A heading as a value.
    pub(crate) fn of_heading(line: u64, column: usize, name: &'r str) -> Value<'r> {
        Value { line, column, name, text: name.as_bytes(), numbers: Numbers::default() }
    }

    /// Its place, for an error.
    pub(crate) fn field(&self) -> String {
        format!("{} on line {}, column {}", self.name, self.line, self.column + 1)
    }

    /// The text; an apostrophe that guards it in spreadsheets is no part of it.
    pub(crate) fn written(self) -> String {
        csv_value(&text(self.text)).to_owned()
    }
}

/// The row, unless it is longer than the heading.
pub(crate) fn fitting(row: Row<'_>) -> Result<Row<'_>, Rejected<'_>> {
    row.surplus().map_or(Ok(row), |(column, why)| Err((Value::new(row, column), why)))
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
        let embryo = embryo_of_file(file);
        let is_grid = |header: &[String]| options.names.any_on_top(&embryo, header);
        let header = table.columns(is_grid)?;
        self.begin_file(options);
        let (embryos, divisions) = (self.embryos.len(), self.divisions.len());
        let class = header.named(&options.class)?;
        let others_in_voxels = std::mem::take(&mut self.in_voxels);
        let unit = if let Some(columns) = DivisionColumns::of(&header, class.clone())? {
            self.of_populations |= header.find(&[POPULATION]).is_some();
            table.share(columns.daughters.into_iter().chain(columns.mother_volume));
            let said = Cell::new(None);
            self.read_divisions(&mut table, (file, &class), 2, |row| division(row, &columns, options, &said))?;
            let unit = said.get().or(columns.unit);
            self.note_unit(unit, options);
            options.kind_of(unit).unwrap_or(Unit::CubicMicrometres)
        } else if let Some(columns) = ChiColumns::of(&header, class.clone())? {
            self.read_divisions(&mut table, (file, &class), 1, |row| chi_division(row, &columns, (file, options)))?;
            let new = &mut self.divisions[divisions..];
            // A column of χ with negative values has signs.
            let is_signed = new.iter().any(|division| division.chi_signed < 0.0);
            new.iter_mut().for_each(|division| division.is_signed |= is_signed);
            self.note_unused(&header, file)?;
            columns.mother_volume.into_iter().for_each(|(_, unit)| self.note_unit(Some(unit), options));
            Unit::OfMother
        } else if !class.is_empty() {
            return Err(header.refused("--class is for tables of divisions and of χ, with a mother in each row"));
        } else if let Some(columns) = Columns::of(&header, &embryo, &options.names)? {
            self.read_long(&mut table, file, options, &columns)?
        } else {
            self.read_grid(&mut table, file, options, &header)?
        };
        self.refuse_units_below(header.line, file)?;
        if self.in_voxels && !options.voxel.is_empty() {
            let sources = self.embryos[embryos..].iter().map(|embryo| &embryo.source);
            let mut names = sources.chain(&self.division_sources[divisions..]).map(|source| &source.name);
            let first = names.find(|name| options.voxel.of(name).is_none()).cloned();
            self.without_voxel = self.without_voxel.take().or(first);
        }
        self.in_voxels |= others_in_voxels;
        self.join_embryos(embryos);
        self.join_divisions(divisions, if unit == Unit::OfMother { 1 } else { 2 });
        let unit = if unit == Unit::Voxels && !options.voxel.is_empty() { Unit::CubicMicrometres } else { unit };
        self.require_unit(unit, file)
    }

    /// Notes the column of volumes in a table of χ, which is not used.
    fn note_unused(&mut self, header: &Header<'_>, file: &str) -> Result<(), InputError> {
        if let Some((column, _)) = volume_column(header)? {
            let value = Value::of_heading(header.line as u64, column, &header.names[column]);
            self.skip(file, &(value, "not used: the table has χ; leave out one of the two".to_owned()));
        }
        Ok(())
    }

    /// Adds a file: a table, or cells that another program [followed over time](crate::tracked).
    ///
    /// # Errors
    /// As [`Volumes::read`] and [`Volumes::add_tracked`].
    pub fn read_file(
        &mut self,
        EmbryoFile { path, name }: &EmbryoFile,
        options: &ReadOptions,
    ) -> Result<(), InputError> {
        let of_tracks = TrackOptions { pixel: options.voxel.of(name), unit: options.unit, ..TrackOptions::default() };
        match read_tracked(path, &of_tracks)? {
            Some(mut lineage) => {
                lineage.name.clone_from(name);
                self.add_tracked(lineage, options)
            }
            None => self.read(open_table(path)?, &path.display().to_string(), options),
        }
    }

    /// The volumes of some files.
    ///
    /// # Errors
    /// As [`Volumes::read_file`], and files without a volume that can be used.
    pub fn of_files(files: &[EmbryoFile], options: &ReadOptions) -> Result<Volumes, InputError> {
        let mut volumes = Volumes::default();
        files.iter().try_for_each(|file| volumes.read_file(file, options))?;
        volumes.require_used(&files.first().map_or(String::new(), |file| file.path.display().to_string()))?;
        volumes.require_options()?;
        Ok(volumes)
    }

    /// Refuses a table with units in the row below the heading: without a unit in the heading another one would be taken.
    fn refuse_units_below(&self, heading: usize, file: &str) -> Result<(), InputError> {
        let is_unit = |skipped: &&Skipped| {
            let is_text = !skipped.value.is_empty() && skipped.value.parse::<f64>().is_err();
            let is_below = skipped.file == file && skipped.line == heading as u64 + 1;
            is_text && is_below && unit_of(skipped.value.trim_matches(['(', ')', '[', ']']), &VOLUMES).is_some()
        };
        match self.skipped.iter().find(is_unit) {
            None => Ok(()),
            Some(Skipped { line, value, .. }) => {
                let why = format!(
                    "{value:?} is a unit: it must be in the heading, as volume ({value}), and this row left out"
                );
                Err(malformed(file, *line as usize, why))
            }
        }
    }

    /// Notes the unit that volumes of a table state.
    pub(crate) fn note_unit(&mut self, stated: Option<VolumeUnit>, options: &ReadOptions) {
        self.takes_unit |= stated.is_none_or(|unit| Some(unit.kind) == options.unit);
        self.in_voxels |= options.kind_of(stated) == Some(Unit::Voxels);
    }

    /// Requires that the unit and the edges of voxels that were given say something of some volume, that each embryo with an edge
    /// of its own is in the tables, and that no embryo in voxels lacks an edge that others have.
    ///
    /// # Errors
    /// The option that says nothing, or the first embryo that is not there.
    pub fn require_options(&self) -> Result<(), InputError> {
        if let Some(unit) = self.given_unit.filter(|_| !self.takes_unit) {
            let allowed = "left out: no volume of the tables is without a unit, or in this one";
            return Err(InputError::not_allowed("--unit", "unit", unit.symbol(), allowed));
        }
        let allowed = "left out: no volume is in voxels, and no diameter in pixels";
        InputError::require(self.voxels.is_empty() || self.in_voxels, "--voxel", "voxel", "(given)", allowed)?;
        let of_cells = self.embryos.iter().map(|embryo| embryo.source.name.as_str());
        let of_divisions = self.division_sources.iter().map(|source| source.name.as_str());
        let mut names: Vec<&str> = of_cells.chain(of_divisions).collect();
        names.sort_unstable();
        names.dedup();
        self.voxels.require_known(&names, "--voxel")?;
        match &self.without_voxel {
            None => Ok(()),
            Some(name) => {
                let allowed = format!(
                    "given too, as --voxel {name}=UM: its volumes are in voxels, and others are converted to µm³"
                );
                Err(InputError::not_allowed("--voxel", "embryo", format!("{name:?}"), allowed))
            }
        }
    }

    /// Adds the cells of an embryo that were followed over time, [matched](crate::matching) to the names. Cells without a name of the
    /// lineage's and cells without a size are skipped.
    ///
    /// # Errors
    /// Volumes are in another unit than earlier volumes, and as [`TrackedLineage::match_names`].
    pub fn add_tracked(&mut self, mut lineage: TrackedLineage, options: &ReadOptions) -> Result<(), InputError> {
        lineage.match_names(&options.names)?;
        self.matched.extend(lineage.matched.take());
        let (is_of_nuclei, unit) = (lineage.of_nuclei(), lineage.volumes);
        self.in_voxels |= lineage.takes.pixel;
        self.takes_unit |= lineage.takes.unit || Some(unit) == options.unit;
        let names = &options.names;
        let file = lineage.cells.first().map_or("", |cell| &cell.place.0);
        self.begin_file(options);
        let embryo = self.embryo(options.group.clone().unwrap_or_default(), lineage.name, file);
        // First, since it tells why volumes are missing.
        if let Some(sizes) = lineage.unknown_sizes.take() {
            note(&mut self.skipped, &mut self.skipped_count, || sizes);
        }
        self.skipped_count += lineage.skipped_count;
        self.skipped.extend(lineage.skipped.into_iter().take(MOST_PLACES.saturating_sub(self.skipped.len())));
        for cell in &lineage.cells {
            let TrackedCell { name, volume, sizes, place: (_, line), .. } = cell;
            let noted = match volume {
                _ if !names.is_cell(name) => Err(names.unknown().to_owned()),
                None => Err("no size, such as a volume, a radius or a diameter".to_owned()),
                Some(volume) => {
                    let place = self.cell(embryo, name, *line);
                    let lifespan = &mut self.embryos[embryo].cells[place];
                    if lifespan.frames > 0 {
                        Err(format!("a second cell of this name; the first begins on line {}", lifespan.line))
                    } else {
                        (lifespan.sum, lifespan.frames) = (volume * *sizes as f64, *sizes);
                        Ok(())
                    }
                }
            };
            match noted {
                Ok(()) => self.used += sizes,
                Err(why) => note(&mut self.skipped, &mut self.skipped_count, || cell.unused(&why)),
            }
        }
        self.join_embryos(embryo);
        self.of_nuclei |= is_of_nuclei;
        let file = lineage.cells.first().map_or("", |cell| &cell.place.0);
        self.require_unit(unit, file)
    }

    /// Each embryo beside the others, in the order of the tables; empty for tables of divisions.
    pub fn sizes(&self) -> Vec<EmbryoSize> {
        let measured = self.embryos.iter().map(|embryo| embryo.cells.iter().filter(|cell| cell.frames > 0));
        let volumes: InEmbryos<'_> = measured
            .enumerate()
            .flat_map(|(k, cells)| cells.map(move |cell| (k, cell.cell.as_str(), cell.volume().ln())))
            .collect();
        let Shares { of, scatter, shared } = shares(&volumes, self.embryos.len());
        let size = |(k, embryo): (usize, &Embryo)| EmbryoSize {
            embryo: embryo.name.clone(),
            group: embryo.group.clone(),
            cells: volumes.iter().filter(|(of, ..)| *of == k).count(),
            shared: shared[k],
            voxel: self.voxels.of(&embryo.source.name),
            size_factor: of[k].map(f64::exp),
            scatter: scatter[k],
            length_scale: None,
        };
        self.embryos.iter().enumerate().map(size).collect()
    }

    /// Requires that all volumes are in one unit.
    fn require_unit(&mut self, unit: Unit, file: &str) -> Result<(), InputError> {
        match self.unit.replace(unit).filter(|before| *before != unit) {
            Some(before) => {
                let before = before.symbol();
                let allowed = format!("{before}, the unit of the tables before (a voxel's edge in µm converts voxels)");
                Err(InputError::not_allowed(file, "unit", unit.symbol(), allowed))
            }
            None => Ok(()),
        }
    }

    /// Requires that a volume was used of the tables that were read; `tables` is their name if they have no rows.
    ///
    /// # Errors
    /// No volume was used: the error has a cell of the matching that no table has, else the first value that could not be used.
    pub fn require_used(&self, tables: &str) -> Result<(), InputError> {
        if self.used == 0 {
            self.names.require_met()?;
        }
        let file = self.skipped.first().map_or(tables, |skipped| &skipped.file);
        require_used(self.used, (file, "volumes"), &self.skipped, self.skipped_count)
    }

    /// Embryos of earlier files with the same names are compared at the end of a file, and may move then.
    fn begin_file(&mut self, options: &ReadOptions) {
        (self.names, self.voxels, self.given_unit) = (options.names.clone(), options.voxel.clone(), options.unit);
        self.files += 1;
        self.embryo_places.clear();
        self.cell_places.clear();
    }

    pub(crate) fn embryo(&mut self, group: String, name: String, file: &str) -> usize {
        let embryos = &mut self.embryos;
        *self.embryo_places.entry((group.clone(), name.clone())).or_insert_with(|| {
            let source = Source { name: name.clone(), file: file.to_owned() };
            embryos.push(Embryo { name, group, cells: Vec::new(), source });
            embryos.len() - 1
        })
    }

    pub(crate) fn cell(&mut self, embryo: usize, name: &str, line: u64) -> usize {
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
    /// Adds a value, or returns the reason why it is one too many.
    pub(crate) fn note(&mut self, volume: f64, frame: Option<f64>, line: u64) -> Result<(), String> {
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

/// Limits of a volume in any unit and of an error; sums beyond them could overflow.
const ALLOWED: [f64; 2] = [1e-100, 1e100];

/// A volume, which is positive.
pub(crate) fn positive(value: Value<'_>) -> Result<f64, Rejected<'_>> {
    if value.text.is_empty() {
        return Err((value, "no volume".to_owned()));
    }
    positive_of(value, "a volume")
}

/// A positive number; `what` names it in errors.
pub(crate) fn positive_of<'v>(value: Value<'v>, what: &str) -> Result<f64, Rejected<'v>> {
    let allowed = match value.number()? {
        number if number > ALLOWED[0] && number < ALLOWED[1] => return Ok(number),
        number if number > 0.0 => "from 1e-100 to 1e100",
        _ => "above 0",
    };
    Err((value, format!("{what} must be {allowed}")))
}
