//! CD tables of AceTree: a row per cell and time point.
//!
//! The columns are `cellTime, cell, time, none, global, local, blot, cross, z, x, y, size, gweight`. `cell` is Sulston's name,
//! `time` counts frames, `size` is the nucleus's diameter in pixels. A cell's mother follows from its name.

use std::collections::HashMap;
use std::path::Path;

use furrow_input::{InputError, open_file};

use super::spots::{Spot, Spots};
use super::{Format, TimeUnit, TrackOptions, TrackedLineage, embryo_of, sphere_of_pixels, unit_of_pixels};
use crate::names::birth;
use crate::table::{Table, malformed};

/// Whether these are the columns of a CD table.
pub(super) fn is_table(columns: &[&str]) -> bool {
    columns.first().is_some_and(|first| first.eq_ignore_ascii_case("cellTime"))
}

pub(super) fn read(path: &Path, options: &TrackOptions) -> Result<TrackedLineage, InputError> {
    let file = path.display().to_string();
    let mut table = Table::open(open_file(path)?, &file)?;
    let (_, header) = table.header(|_| true)?;
    let column = |name: &str| {
        let found = header.iter().position(|column| column.eq_ignore_ascii_case(name));
        let why = || malformed(&file, 1, format!("no column is called {name}; a CD table has cell, time and size"));
        found.ok_or_else(why)
    };
    let columns = [column("cell")?, column("time")?, column("size")?];
    let mut spots = Spots::of(&file);
    let mut cells: HashMap<String, Vec<usize>> = HashMap::new();
    let numbers = table.numbers();
    while let Some((line, row)) = table.next()? {
        let [cell, time, size] = columns.map(|at| row.get(at).unwrap_or_default().trim_ascii());
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let name = text(cell);
        let Some(frame) = numbers.read(time).ok().filter(|frame| *frame >= 0.0) else {
            spots.skip(&file, line, "time", &text(time), "must be a number of frames from 0");
            continue;
        };
        if name.is_empty() {
            spots.skip(&file, line, "cell", "", "must be the name of a cell");
            continue;
        }
        let diameter = numbers.read(size).ok().filter(|size| *size > 0.0 && *size < 1e30);
        if diameter.is_none() {
            spots.skip(&file, line, "size", &text(size), "must be a diameter above 0, in pixels");
        }
        let volume = diameter.map(|diameter| sphere_of_pixels(diameter, options));
        let spot = spots.push(Spot { time: frame, name: name.clone(), volume, file: 0, line });
        cells.entry(name).or_default().push(spot);
    }
    link(&mut spots, &mut cells, &file)?;
    spots.lineage(embryo_of(path), Format::CdTable, TimeUnit::Frames, unit_of_pixels(options))
}

/// Links the spots of each cell, and its last one to its daughters' first.
fn link(spots: &mut Spots, cells: &mut HashMap<String, Vec<usize>>, file: &str) -> Result<(), InputError> {
    // In the order of the file, so that the first error is always the same.
    let mut order: Vec<String> = cells.keys().cloned().collect();
    order.sort_by_key(|name| cells[name][0]);
    for name in &order {
        let Some(of) = cells.get_mut(name) else { continue };
        of.sort_by(|a, b| spots.get(*a).time.total_cmp(&spots.get(*b).time));
        for pair in of.windows(2) {
            let [first, second] = [spots.get(pair[0]), spots.get(pair[1])];
            if first.time == second.time {
                let (time, [first, second]) = (first.time, [first.line, second.line]);
                let why =
                    format!("cell {name} a second time at time {time}; the first is on line {}", first.min(second));
                return Err(malformed(file, first.max(second) as usize, why));
            }
            spots.link(pair[0], pair[1], file, second.line)?;
        }
    }
    for name in &order {
        let Some((mother, ..)) = birth(name) else { continue };
        let (Some(of), first) = (cells.get(mother), cells[name][0]) else { continue };
        let (last, born) = (of[of.len() - 1], spots.get(first));
        let (line, until) = (born.line, spots.get(last).time);
        if until < born.time {
            spots.link(last, first, file, line)?;
        } else {
            let why = format!("it is born while its mother {mother} is still there, until time {until}");
            let time = born.time.to_string();
            spots.skip(file, line, "time", &time, why);
        }
    }
    Ok(())
}
