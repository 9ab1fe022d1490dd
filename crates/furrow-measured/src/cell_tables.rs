//! Tables with a volume in every row, and grids of frames by cells.

use std::collections::HashMap;
use std::io::Read;

use furrow_input::table::{Header, Row, TIMES, Table, split_unit, text, unit_of, units_listed};
use furrow_input::{InputError, shown};

use crate::layout::{
    Columns, FRAME, GridColumns, SUMMARY, Unit, VOLUMES, VolumeUnit, embryo_of_file, is_absent, is_summary, unit_in,
};
use crate::names::Names;
use crate::volumes::{ReadOptions, Rejected, Value, Volumes, fitting, positive};

/// Volumes without a unit that never exceed this are fractions.
const LARGEST_FRACTION: f64 = 1.5;

impl Volumes {
    pub(crate) fn read_long<R: Read>(
        &mut self,
        table: &mut Table<'_, R>,
        file: &str,
        options: &ReadOptions,
        columns: &Columns,
    ) -> Result<Unit, InputError> {
        let (mut said, mut largest) = (None, 0.0_f64);
        while let Some(row) = table.next_row()? {
            let embryo = Value::new(row, columns.embryo).written();
            let read = fitting(row).map(|row| columns.unit.map(|column| Value::new(row, column)));
            let noted = match read {
                Ok(Some(unit)) if unit.text.is_empty() => Err((unit, "no unit".to_owned())),
                Ok(unit) => {
                    let read = |value: Value<'_>| {
                        let refused = |allowed| InputError::not_allowed(file, value.field(), text(value.text), allowed);
                        unit_in(value.text, columns.volume.1, said).map_err(refused)
                    };
                    let unit = unit.map(read).transpose()?;
                    said = unit.or(said);
                    let factor = options.factor(unit.or(columns.volume.1), &embryo);
                    self.read_row(columns, row, (file, options), factor)
                }
                Err(rejected) => Err(rejected),
            };
            match noted {
                Ok(volume) => largest = largest.max(volume),
                Err(rejected) => self.skip(file, &rejected),
            }
        }
        let bare = if largest <= LARGEST_FRACTION { Unit::Relative } else { Unit::CubicMicrometres };
        let stated = said.or(columns.volume.1);
        self.note_unit(stated, options);
        Ok(options.kind_of(stated).unwrap_or(bare))
    }

    /// Adds the volume, times `factor`, of a row of a long table, and returns it as written.
    fn read_row<'r>(
        &mut self,
        columns: &Columns,
        row: Row<'r>,
        (file, options): (&str, &ReadOptions),
        factor: f64,
    ) -> Result<f64, Rejected<'r>> {
        let at = |column: usize| Value::new(row, column);
        let volume = positive(at(columns.volume.0))?;
        let (cell, embryo) = (at(columns.cell), at(columns.embryo));
        let name = options.names.understood(&embryo.written(), &cell.written()).ok_or_else(|| {
            (cell, (if cell.text.is_empty() { "no name of a cell" } else { options.names.unknown() }).to_owned())
        })?;
        let (group, embryo) = (columns.group.group_of(row, options.group.as_ref())?, embryo.named("an embryo")?);
        columns.common.require(row, &embryo, &group)?;
        let embryo = self.embryo(group, embryo, file);
        let cell_place = self.cell(embryo, &name, cell.line);
        let frame = columns.frame.map(|column| at(column).number()).transpose()?;
        if let Some(n) = columns.n.map(at).filter(|n| !n.text.is_empty())
            && n.number()? < 1.0
        {
            return Err((n, "not a number of frames".to_owned()));
        }
        let lifespan = &mut self.embryos[embryo].cells[cell_place];
        lifespan.note(volume * factor, frame, cell.line).map_err(|why| (cell, why))?;
        self.used += 1;
        Ok(volume)
    }

    pub(crate) fn read_grid<R: Read>(
        &mut self,
        table: &mut Table<'_, R>,
        file: &str,
        options: &ReadOptions,
        header: &Header<'_>,
    ) -> Result<Unit, InputError> {
        let of_file = embryo_of_file(file);
        let named = grid_unit(header, &of_file, &options.names)?;
        let is_cell = |name: &str| options.names.understood(&of_file, split_unit(name).0).is_some();
        let columns = GridColumns::of(header, is_cell)?;
        for (column, name) in header.names.iter().enumerate().filter(|(_, name)| !is_cell(name)) {
            if column > 0 && !name.is_empty() && !columns.has(column) {
                let value = Value::of_heading(header.line as u64, column, name);
                self.skip(file, &(value, options.names.unknown().to_owned()));
            }
        }
        table.share((0..header.names.len()).filter(|column| is_cell(&header.names[*column])));
        self.note_unit(named, options);
        let mut places: HashMap<(String, String), GridEmbryo> = HashMap::new();
        // Voxels are counted: a number with decimals is in another unit.
        let (mut is_counted, mut largest) = (true, 0.0_f64);
        while let Some(row) = table.next_row()? {
            let read = fitting(row).and_then(|row| columns.row(row, &of_file, options));
            let (key, frame) = match read {
                Ok(read) => read,
                Err(rejected) => {
                    self.skip(file, &rejected);
                    continue;
                }
            };
            let known = places.entry(key).or_insert_with_key(|key| self.grid_embryo(key, header, (file, options)));
            let factor = options.factor(named, &self.embryos[known.embryo].source.name);
            for (column, cell) in known.cells.iter().enumerate().filter_map(|(column, cell)| Some((column, (*cell)?))) {
                let value = Value::new(row, column);
                // An empty field: the cell does not exist in this frame.
                if is_absent(value.text) {
                    continue;
                }
                let noted = positive(value).and_then(|volume| {
                    (is_counted, largest) = (is_counted && volume.fract() == 0.0, largest.max(volume));
                    let lifespan = &mut self.embryos[known.embryo].cells[cell];
                    lifespan.note(volume * factor, frame, value.line).map_err(|why| (value, why))
                });
                match noted {
                    Ok(()) => self.used += 1,
                    Err(rejected) => self.skip(file, &rejected),
                }
            }
        }
        let bare = match () {
            () if is_counted => Unit::Voxels,
            () if largest <= LARGEST_FRACTION => Unit::Relative,
            () => Unit::CubicMicrometres,
        };
        Ok(options.kind_of(named).unwrap_or(bare))
    }

    /// Adds an embryo of a grid by its group and name.
    fn grid_embryo(
        &mut self,
        (group, name): &(String, String),
        header: &Header<'_>,
        (file, options): (&str, &ReadOptions),
    ) -> GridEmbryo {
        let embryo = self.embryo(group.clone(), name.clone(), file);
        let cell = |heading: &String| options.names.understood(name, split_unit(heading).0);
        let cells = header.names.iter().map(|heading| Some(self.cell(embryo, &cell(heading)?, header.line as u64)));
        GridEmbryo { embryo, cells: cells.collect() }
    }
}

/// An embryo of a grid, and its cells by their columns.
struct GridEmbryo {
    embryo: usize,
    cells: Vec<Option<usize>>,
}

impl GridColumns {
    fn has(&self, column: usize) -> bool {
        [self.embryo, self.group.column, self.frame].contains(&Some(column))
    }

    /// The group and embryo of a row, and its frame. Without a column of embryos all rows are frames of the file's embryo.
    fn row<'r>(
        &self,
        row: Row<'r>,
        of_file: &str,
        options: &ReadOptions,
    ) -> Result<((String, String), Option<f64>), Rejected<'r>> {
        let at = |column: usize| Value::new(row, column);
        let is_unit = |label: &Value<'_>| label.line == self.first_line && unit_of(&label.written(), &TIMES).is_some();
        if let Some(label) = self.label.map(at).filter(|label| is_summary(label.text) && !is_unit(label)) {
            return Err((label, SUMMARY.to_owned()));
        }
        let group = self.group.group_of(row, options.group.as_ref())?;
        let Some(embryo) = self.embryo else {
            let label = self.label.filter(|label| self.frame != Some(*label)).map(at);
            if let Some(label) = label.filter(|label| !label.may_be_frame()) {
                let why = "may be an embryo or a frame: the column must be called embryo or frame";
                return Err((label, why.to_owned()));
            }
            // Where a frame is not a number, its line takes the place of the number.
            let frame = self.frame.and_then(|column| at(column).number().ok()).unwrap_or(-(row.line as f64));
            return Ok(((group, of_file.to_owned()), Some(frame)));
        };
        let name = at(embryo).named("an embryo")?;
        self.common.require(row, &name, &group)?;
        // Rows of a strain are embryos without names.
        let name = if self.group.column == Some(embryo) { format!("{name}:{}", row.line) } else { name };
        let frame = self.frame.map(|column| at(column).number()).transpose()?;
        Ok(((group, name), frame))
    }
}

/// Headings of numbers of rows. Under any other heading a number may be an embryo's.
const NUMBERS: [&str; 6] = ["", "index", "row", "image", "tp", "frames"];

impl Value<'_> {
    /// Whether a row's name can be a frame by its column's heading and by itself.
    fn may_be_frame(&self) -> bool {
        let heading = self.name.to_lowercase();
        let heading = heading.trim_matches(|c: char| !c.is_alphanumeric());
        let is_of_numbers = NUMBERS.contains(&heading) || FRAME.contains(&heading);
        self.text.is_empty() || is_of_numbers && may_be_frame(&self.written())
    }
}

/// Whether a text can be a frame: a number, a time, t12 or frame 12, but no date.
fn may_be_frame(label: &str) -> bool {
    let number = label.trim_start_matches(|c: char| !c.is_ascii_digit());
    let word = label[..label.len() - number.len()].to_lowercase();
    let word = word.trim_matches(|c: char| !c.is_alphabetic());
    let is_number = || number.is_empty() || number.bytes().all(|byte| byte.is_ascii_digit() || b".,:".contains(&byte));
    word.is_empty() && is_number() || !number.is_empty() && (FRAME.contains(&word) || ["tp", "image"].contains(&word))
}

/// The unit in the headings of a grid: of its cells, or of the frames.
fn grid_unit(header: &Header<'_>, embryo: &str, names: &Names) -> Result<Option<VolumeUnit>, InputError> {
    let mut found: Option<VolumeUnit> = None;
    for (column, heading) in header.names.iter().enumerate() {
        let (name, Some(written)) = split_unit(heading) else { continue };
        let unit = unit_of(written, &VOLUMES).copied();
        if unit.is_none() && names.understood(embryo, name).is_none() {
            continue;
        }
        let refused = |allowed: String| {
            header.refused(format!("the unit of column {}, {}, must be {allowed}", column + 1, shown(heading)))
        };
        let unit = unit.ok_or_else(|| refused(format!("one of {}", units_listed(&VOLUMES))))?;
        if found.is_some_and(|before| before != unit) {
            return Err(refused("the unit of the columns before".to_owned()));
        }
        found = Some(unit);
    }
    Ok(found)
}
