//! Tables that give tracked cells their names in the lineage.

use std::collections::HashMap;
use std::io::Read;
use std::sync::atomic::{AtomicBool, Ordering};

use furrow_input::table::{Table, malformed, text};
use furrow_input::{InputError, csv_value, shown};

use crate::layout::embryo_column;
use crate::names::Names;

/// Names of the columns: of the tracked cell, and of its name in the lineage.
const TRACKED: [&str; 5] = ["tracked", "track", "track_id", "id", "label"];
const NAME: [&str; 3] = ["name", "cell", "lineage"];

/// A row of the table.
#[derive(Debug)]
pub(super) struct MapRow {
    /// Its line.
    line: u64,
    /// The embryo; empty for any.
    pub(super) embryo: String,
    /// The cell's name in the file of the tracking program.
    pub(super) tracked: String,
    /// Its name in the lineage.
    pub(super) name: String,
    /// Whether a table has the cell.
    met: AtomicBool,
}

impl MapRow {
    /// Notes that a table has the cell.
    pub(super) fn meet(&self) {
        self.met.store(true, Ordering::Relaxed);
    }
}

/// The names that a table gives.
#[derive(Debug, Default)]
pub(super) struct NameMap {
    file: String,
    pub(super) rows: Vec<MapRow>,
    /// Rows by embryo and tracked name.
    places: HashMap<(String, String), usize>,
    /// Whether a table has the embryo.
    embryos: HashMap<String, AtomicBool>,
}

impl NameMap {
    /// Reads the table with the columns `tracked` and `name`, and optionally `embryo`.
    ///
    /// # Errors
    /// A table without these columns; a cell or a name that is given twice.
    pub(super) fn read(from: impl Read, file: &str) -> Result<NameMap, InputError> {
        let mut table = Table::open(from, file)?;
        let header = table.columns(|_| false)?;
        let (tracked, name) = (header.find(&TRACKED), header.find(&NAME));
        let (Some(tracked), Some(name)) = (tracked, name) else {
            let needed = [("tracked", tracked), ("name", name)];
            let about = "a map of names has the columns tracked and name, and optionally embryo";
            return Err(header.missing(&needed, about));
        };
        let embryo = embryo_column(&header);
        let mut map = NameMap { file: file.to_owned(), ..NameMap::default() };
        while let Some(row) = table.next_row()? {
            if let Some((_, why)) = row.surplus() {
                return Err(malformed(&map.file, row.line as usize, why));
            }
            let at = |column: usize| csv_value(&text(row.text(column))).trim().to_owned();
            let (embryo, tracked, name) = (embryo.map(at).unwrap_or_default(), at(tracked), at(name));
            map.add(MapRow { line: row.line, embryo, tracked, name, met: AtomicBool::new(false) })?;
        }
        InputError::require(!map.rows.is_empty(), &map.file, "rows", 0, "at least one")?;
        Ok(map)
    }

    fn add(&mut self, row: MapRow) -> Result<(), InputError> {
        for (column, value) in [("tracked", &row.tracked), ("name", &row.name)] {
            if value.is_empty() {
                return Err(self.refused(&row, format!("{column} is empty")));
            }
        }
        let same = |other: &&MapRow| other.embryo == row.embryo && other.name == row.name;
        if let Some(other) = self.rows.iter().find(same) {
            let why = format!("a second cell called {}; {} on line {} is", row.name, shown(&other.tracked), other.line);
            return Err(self.refused(&row, why));
        }
        let key = (row.embryo.clone(), row.tracked.clone());
        if let Some(first) = self.places.insert(key, self.rows.len()) {
            let Some(MapRow { line, name, .. }) = self.rows.get(first) else { return Ok(()) };
            let why = format!("a second name of {}; line {line} calls it {name}", shown(&row.tracked));
            return Err(self.refused(&row, why));
        }
        self.embryos.entry(row.embryo.clone()).or_default();
        self.rows.push(row);
        Ok(())
    }

    /// The error at a row.
    pub(super) fn refused(&self, row: &MapRow, why: impl Into<String>) -> InputError {
        malformed(&self.file, row.line as usize, why)
    }

    /// Requires that the names are of cells, and writes them as the lineage does.
    pub(super) fn understand(&mut self, names: &Names) -> Result<(), InputError> {
        for k in 0..self.rows.len() {
            let row = &self.rows[k];
            let name = names
                .known(&row.name)
                .map_err(|allowed| self.refused(row, format!("name = {}: must be {allowed}", shown(&row.name))))?;
            self.rows[k].name = name;
        }
        Ok(())
    }

    /// The name of a cell of an embryo.
    pub(super) fn name_of(&self, embryo: &str, tracked: &str) -> Option<&str> {
        self.meet(embryo);
        let of = |embryo: &str| self.places.get(&(embryo.to_owned(), tracked.to_owned()));
        let row = &self.rows[*of(embryo).or_else(|| of(""))?];
        row.meet();
        Some(&row.name)
    }

    /// Notes that a table has the embryo.
    pub(super) fn meet(&self, embryo: &str) {
        if let Some(met) = self.embryos.get(embryo) {
            met.store(true, Ordering::Relaxed);
        }
    }

    /// Requires that all cells were met. Cells of embryos that no table has are not required. The error about a missing cell ends with
    /// `after`.
    pub(super) fn require_met(&self, after: &str) -> Result<(), InputError> {
        let is_met = |met: &AtomicBool| met.load(Ordering::Relaxed);
        let of_read = |row: &&MapRow| row.embryo.is_empty() || self.embryos.get(&row.embryo).is_some_and(is_met);
        if let Some(row) = self.rows.first().filter(|_| !self.rows.iter().any(|row| of_read(&row))) {
            let why = format!("embryo = {}: must be an embryo of the tables; no row is", shown(&row.embryo));
            return Err(self.refused(row, why));
        }
        match self.rows.iter().filter(of_read).find(|row| !is_met(&row.met)) {
            None => Ok(()),
            Some(row) => {
                let of = if row.embryo.is_empty() { String::new() } else { format!(" of {}", shown(&row.embryo)) };
                let why = format!("tracked = {}: must be a cell{of} in the tables{after}", shown(&row.tracked));
                Err(self.refused(row, why))
            }
        }
    }
}

/// Equal rows; what was met does not count.
impl PartialEq for NameMap {
    fn eq(&self, other: &NameMap) -> bool {
        let row = |row: &MapRow| (row.embryo.clone(), row.tracked.clone(), row.name.clone());
        self.file == other.file && self.rows.iter().map(row).eq(other.rows.iter().map(row))
    }
}
