//! Tables with a row per cell, its mother and its generation, as `furrow export --to csv` writes trees and embryos.

use std::collections::HashMap;
use std::path::Path;

use furrow_input::table::{Table, text};
use furrow_input::{InputError, csv_value, open_file};

use super::spots::{Spot, Spots};
use super::{Format, TimeUnit, TrackedLineage, embryo_of};
use crate::volumes::Unit;

/// Reads such a table; `None` for a file with other columns. Generations take the place of times, which some cells lack.
pub(super) fn read(path: &Path) -> Result<Option<TrackedLineage>, InputError> {
    let file = path.display().to_string();
    let mut table = Table::open(open_file(path)?, &file)?;
    let Ok(header) = table.columns(|_| false) else { return Ok(None) };
    let [name, mother, generation] = ["name", "mother", "generation"].map(|name| header.find(&[name]));
    let (Some(name), Some(mother), Some(generation)) = (name, mother, generation) else { return Ok(None) };
    let (mut spots, mut links, mut places) = (Spots::of(&file), Vec::new(), HashMap::new());
    while let Some(row) = table.next_row()? {
        let at = |column: usize| csv_value(&text(row.text(column))).trim().to_owned();
        let (line, cell) = (row.line, at(name));
        let why = match row.number(generation).ok().filter(|time| *time >= 0.0) {
            _ if cell.is_empty() => (name, "must be the name of a cell"),
            _ if places.contains_key(&cell) => (name, "a second row of this cell"),
            None => (generation, "must be a number of generations from 0"),
            Some(time) => {
                let spot = Spot { time, name: cell.clone(), id: None, volume: None, file: 0, line };
                places.insert(cell.clone(), spots.push(spot));
                links.push((line, at(mother), cell));
                continue;
            }
        };
        spots.skip(&file, line, row.name(why.0), &at(why.0), why.1);
    }
    for (line, mother, cell) in links.into_iter().filter(|(_, mother, _)| !mother.is_empty()) {
        match places.get(&mother).zip(places.get(&cell)) {
            Some((from, to)) => {
                spots.link(*from, *to, &file, line)?;
                spots.part(*from);
            }
            None => spots.skip(&file, line, "mother", &mother, "must be a cell of the table"),
        }
    }
    spots.lineage(embryo_of(path), Format::Exported, TimeUnit::Frames, Unit::Relative).map(Some)
}
