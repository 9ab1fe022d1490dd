//! Tables with a volume in every row, and grids of frames by cells.

use std::io::Read;

use furrow_input::table::{Header, Row, Table, split_unit, text, unit_of, units_listed};
use furrow_input::{InputError, shown};

use crate::layout::{Columns, FRAME, Unit, VOLUMES, VolumeUnit, embryo_of_file};
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
                    let unit = unit.map(|unit| note_unit(file, &unit, &mut said)).transpose()?;
                    let factor = factor(unit.or(columns.volume.1), &embryo, options);
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
        let named = said.or(columns.volume.1.map(|unit| unit.kind)).or(options.unit);
        Ok(named.unwrap_or(bare))
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
        if embryo.text.is_empty() {
            return Err((embryo, "no name of an embryo".to_owned()));
        }
        let embryo = self.embryo(options.group_of(columns.group.map(at)), embryo.written(), file);
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
        let embryo = self.embryo(options.group_of(None), embryo_of_file(file), file);
        let (named, line) = (grid_unit(header, &embryo_of_file(file), &options.names)?, header.line as u64);
        let mut places: Vec<Option<usize>> = Vec::new();
        for (column, name) in header.names.iter().enumerate() {
            let cell = options.names.understood(&embryo_of_file(file), split_unit(name).0);
            if cell.is_none() && !is_frame(column, name) {
                let value = Value::of_heading(line, column, name);
                self.skip(file, &(value, options.names.unknown().to_owned()));
            }
            places.push(cell.map(|name| self.cell(embryo, &name, line)));
        }
        // Without a unit a grid is in voxels where these have a size.
        let is_bare = named.is_none() && options.unit.is_none();
        let of_file = embryo_of_file(file);
        let factor = if is_bare { options.voxel_volume(&of_file) } else { factor(named, &of_file, options) };
        // Voxels are counted: a number with decimals is in another unit.
        let (mut is_counted, mut largest) = (true, 0.0_f64);
        while let Some(row) = table.next_row()? {
            if let Err(rejected) = fitting(row) {
                self.skip(file, &rejected);
                continue;
            }
            for (column, cell) in places.iter().enumerate().filter_map(|(column, cell)| Some((column, (*cell)?))) {
                let value = Value::new(row, column);
                // An empty field: the cell does not exist in this frame.
                if value.text.is_empty() || value.text.eq_ignore_ascii_case(b"nan") {
                    continue;
                }
                let noted = positive(value).and_then(|volume| {
                    (is_counted, largest) = (is_counted && volume.fract() == 0.0, largest.max(volume));
                    let lifespan = &mut self.embryos[embryo].cells[cell];
                    lifespan.note(volume * factor, Some(row.line as f64), value.line).map_err(|why| (value, why))
                });
                match noted {
                    Ok(()) => self.used += 1,
                    Err(rejected) => self.skip(file, &rejected),
                }
            }
        }
        let bare = match () {
            () if is_counted || options.voxel.of(&of_file).is_some() => Unit::Voxels,
            () if largest <= LARGEST_FRACTION => Unit::Relative,
            () => Unit::CubicMicrometres,
        };
        Ok(named.map(|unit| unit.kind).or(options.unit).unwrap_or(bare))
    }
}

/// Whether a column of a grid contains the frames, or nothing, rather than a cell.
fn is_frame(column: usize, name: &str) -> bool {
    column == 0 || name.is_empty() || FRAME.contains(&&*split_unit(name).0.to_lowercase())
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

/// The factor from a volume's unit to the unit of results. Without a unit the option gives it.
pub(crate) fn factor(unit: Option<VolumeUnit>, embryo: &str, options: &ReadOptions) -> f64 {
    match unit {
        Some(VolumeUnit { kind: Unit::Voxels, .. }) => options.voxel_volume(embryo),
        Some(unit) => unit.size,
        None if options.unit == Some(Unit::Voxels) => options.voxel_volume(embryo),
        None => 1.0,
    }
}

/// Requires one kind of unit in all rows.
fn note_unit(file: &str, value: &Value<'_>, said: &mut Option<Unit>) -> Result<VolumeUnit, InputError> {
    let written = text(value.text);
    let refused = |allowed: String| InputError::not_allowed(file, value.field(), &written, allowed);
    let unit = unit_of(&written, &VOLUMES).ok_or_else(|| refused(format!("one of {}", units_listed(&VOLUMES))))?;
    match said.replace(unit.kind) {
        Some(before) if before != unit.kind => {
            Err(refused(format!("{}, the unit of the rows before", before.symbol())))
        }
        _ => Ok(*unit),
    }
}
