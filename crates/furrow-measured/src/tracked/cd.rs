//! CD tables of AceTree: a row per cell and time point.
//!
//! The columns are `cellTime, cell, time, none, global, local, blot, cross, z, x, y, size, gweight`. `cell` is Sulston's name,
//! `time` counts frames, `size` is the nucleus's diameter in pixels. A cell's mother follows from its name. Some programs write
//! `Cell & Time`, as `AB:3`, in place of the columns of cells and times, and no sizes; pandas writes a column of row numbers before.

use std::collections::HashMap;
use std::path::Path;

use furrow_input::{InputError, open_file};

use super::chains::{self, Chain, Only};
use super::lengths::{sphere_of_pixels, unit_of_pixels};
use super::rows::{FirstRows, contents, repeat};
use super::spots::{Spot, Spots};
use super::{Format, TimeUnit, TrackOptions, TrackedLineage, embryo_of};
use crate::names::{birth, understood};
use furrow_input::table::{Table, malformed, text};

/// Names of the column that has the cell and the time.
const CELL_TIME: [&str; 2] = ["cellTime", "Cell & Time"];

/// The place of a column by any of its names.
fn place(columns: &[impl AsRef<str>], names: &[&str]) -> Option<usize> {
    let is_it = |column: &str| names.iter().any(|name| column.eq_ignore_ascii_case(name));
    columns.iter().position(|column| is_it(column.as_ref()))
}

/// Whether these are the columns of a CD table.
pub(super) fn is_table(columns: &[&str]) -> bool {
    place(columns, &CELL_TIME).is_some()
}

/// Where a row has its cell and its time.
enum Place {
    Columns(usize, usize),
    /// Both in one column, with a colon between them.
    Joined(usize),
}

pub(super) fn read(path: &Path, options: &TrackOptions) -> Result<TrackedLineage, InputError> {
    let file = path.display().to_string();
    let mut table = Table::open(open_file(path)?, &file)?;
    let (_, header) = table.header(|_| false)?;
    let both = place(&header, &["cell"]).zip(place(&header, &["time"]));
    let joined = place(&header, &CELL_TIME).map(Place::Joined);
    let Some(at) = both.map(|(cell, time)| Place::Columns(cell, time)).or(joined) else {
        return Err(malformed(&file, 1, "no columns are called cell and time, as a CD table has"));
    };
    let size = place(&header, &["size"]);
    let mut spots = Spots::of(&file);
    let mut cells: HashMap<String, Vec<usize>> = HashMap::new();
    let (Place::Columns(_, time) | Place::Joined(time)) = at;
    let (of_times, of_sizes) = (table.numbers(time), size.map(|at| table.numbers(at)).unwrap_or_default());
    let mut rows = FirstRows::new();
    while let Some((line, row)) = table.next()? {
        let text = |at: usize| text(row.get(at).unwrap_or_default().trim_ascii()).into_owned();
        let (name, time) = match at {
            Place::Columns(cell, time) => (text(cell), text(time)),
            Place::Joined(at) => match text(at).rsplit_once(':') {
                Some((cell, time)) => (cell.trim().to_owned(), time.trim().to_owned()),
                None => {
                    spots.skip(&file, line, &header[at], &text(at), "must be a cell and a frame, as AB:3");
                    continue;
                }
            },
        };
        let Some(frame) = of_times.read(time.as_bytes()).ok().filter(|frame| *frame >= 0.0) else {
            spots.skip(&file, line, "time", &time, "must be a number of frames from 0");
            continue;
        };
        if name.is_empty() {
            spots.skip(&file, line, "cell", "", "must be the name of a cell");
            continue;
        }
        let name = understood(&name).unwrap_or(name);
        let contents = contents(&header, |at| row.get(at).unwrap_or_default().trim_ascii());
        if let Some(first) = rows.repeated((name.clone(), frame.to_bits()), line, contents) {
            spots.skip(&file, line, "cell", &name, repeat(first));
            continue;
        }
        let written = size.map(text);
        let diameter = written.as_deref().and_then(|size| of_sizes.read(size.as_bytes()).ok());
        let diameter = diameter.filter(|size| *size > 0.0 && *size < 1e30);
        if let (Some(size), None) = (&written, diameter) {
            spots.skip(&file, line, "size", size, "must be a diameter above 0, in pixels");
        }
        let volume = diameter.map(|diameter| sphere_of_pixels(diameter, options));
        let spot = spots.push(Spot { time: frame, id: None, name: name.clone(), volume, file: 0, line });
        cells.entry(name).or_default().push(spot);
    }
    let mut chains = chains(&spots, cells);
    chains::link(&mut spots, &mut chains, (&file, "time"), Only::Daughter)?;
    spots.lineage(embryo_of(path), Format::CdTable, TimeUnit::Frames, unit_of_pixels(options))
}

/// The cells in the order of the file. Names give their mothers.
fn chains(spots: &Spots, cells: HashMap<String, Vec<usize>>) -> Vec<Chain> {
    let mut chains: Vec<Chain> = cells.into_iter().map(|(name, spots)| Chain { name, spots, mother: None }).collect();
    // So that the first error is always the same.
    chains.sort_by_cached_key(|chain| chain.spots.iter().map(|spot| spots.get(*spot).line).min());
    let places: HashMap<String, usize> = chains.iter().enumerate().map(|(k, chain)| (chain.name.clone(), k)).collect();
    for chain in &mut chains {
        chain.mother = birth(&chain.name).and_then(|(mother, ..)| places.get(mother).copied());
    }
    chains
}
