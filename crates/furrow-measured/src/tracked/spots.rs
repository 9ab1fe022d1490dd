//! Spots and the links between them, as cells: chains of spots between divisions.

use std::collections::{HashMap, HashSet};
use std::hash::Hash;
use std::path::Path;

use furrow_input::InputError;
use ordered_float::OrderedFloat;

use super::lengths::SizeUnit;
use super::rows::{Link, links_past};
use super::{Format, SpotNames, Takes, TimeUnit, TrackedCell, TrackedLineage, namesakes};
use crate::names::{birth, is_cell, understood};
use crate::volumes::{Skipped, note};
use furrow_input::table::malformed;

/// Share by which volumes may differ and be the same: programs write sizes with several digits, also of one size.
const SAME_SIZE: f64 = 1e-6;

/// A cell in one frame.
#[derive(Clone, Debug)]
pub(super) struct Spot {
    /// Its frame or minute.
    pub time: f64,
    /// Its name in that frame; empty without a name.
    pub name: String,
    /// Its id, where the format has ids beside names.
    pub id: Option<i128>,
    /// Its volume in that frame.
    pub volume: Option<f64>,
    /// Index of its file.
    pub file: usize,
    /// Line, from 1.
    pub line: u64,
}

/// A link from a spot to one of a later frame.
#[derive(Clone, Copy, Debug)]
struct SpotLink {
    from: usize,
    to: usize,
    /// Index of its file.
    file: usize,
    line: u64,
}

/// Spots with their links.
#[derive(Debug, Default)]
pub(super) struct Spots {
    /// Names of files.
    pub files: Vec<String>,
    spots: Vec<Spot>,
    /// The spot before each.
    previous: Vec<Option<usize>>,
    /// The spots after each.
    next: Vec<[Option<usize>; 2]>,
    /// All links, in the order of their files.
    links: Vec<SpotLink>,
    /// Files of links.
    link_files: Vec<String>,
    /// The last spots of cells: a link from here leads to a daughter, unless the names are equal.
    parted: HashSet<usize>,
    /// Spots that some link names, used or not.
    linked: HashSet<usize>,
    /// Spots that are no cells.
    left_out: HashSet<usize>,
    /// Names of tracks and their first spots.
    pub tracks: Vec<(String, usize)>,
    skipped: Vec<Skipped>,
    skipped_count: u64,
}

/// The times of a recording.
enum Frames {
    /// Numbers of frames.
    Numbered,
    /// The times of all spots, in order.
    Timed(Vec<f64>),
}

impl Frames {
    fn of(spots: &[Spot], unit: TimeUnit) -> Frames {
        if unit == TimeUnit::Frames {
            return Frames::Numbered;
        }
        let mut times: Vec<f64> = spots.iter().map(|spot| spot.time).collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        Frames::Timed(times)
    }

    /// The shortest time between two frames.
    fn shortest(&self) -> f64 {
        match self {
            Frames::Numbered => 1.0,
            Frames::Timed(times) => times.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min),
        }
    }

    /// The time of the frame after a time.
    fn after(&self, time: f64) -> f64 {
        match self {
            Frames::Numbered => time + 1.0,
            Frames::Timed(times) => {
                times.get(times.partition_point(|other| *other <= time)).copied().unwrap_or(f64::INFINITY)
            }
        }
    }
}

impl Spots {
    /// No spots yet, of a file.
    pub fn of(file: &str) -> Spots {
        Spots { files: vec![file.to_owned()], ..Spots::default() }
    }

    /// Adds a spot. Another spelling of one of Sulston's names is replaced by Sulston's.
    pub fn push(&mut self, mut spot: Spot) -> usize {
        spot.name = understood(&spot.name).unwrap_or(spot.name);
        self.spots.push(spot);
        self.previous.push(None);
        self.next.push([None; 2]);
        self.spots.len() - 1
    }

    /// The spot.
    pub fn get(&self, spot: usize) -> &Spot {
        &self.spots[spot]
    }

    /// The times of all spots.
    pub fn times(&self) -> impl Iterator<Item = f64> {
        self.spots.iter().map(|spot| spot.time)
    }

    /// Gives all spots other times; links come later.
    pub fn set_times(&mut self, times: &[f64]) {
        self.spots.iter_mut().zip(times).for_each(|(spot, time)| spot.time = *time);
    }

    /// Reports a value that cannot be used.
    pub fn skip(&mut self, file: &str, line: u64, column: &str, value: &str, why: impl Into<String>) {
        note(&mut self.skipped, &mut self.skipped_count, || {
            let value = value.chars().take(80).collect();
            Skipped { file: file.into(), line, column: column.into(), value, why: why.into() }
        });
    }

    /// Links a spot to one of a later frame, or the other way round. `file` and `line` give the link's place. If a spot has two mothers or
    /// three daughters, no such link is used, as it is unknown which are right.
    ///
    /// # Errors
    /// A link within a frame.
    pub fn link(&mut self, a: usize, b: usize, file: &str, line: u64) -> Result<(), InputError> {
        self.linked.extend([a, b]);
        let (from, to) = if self.spots[a].time <= self.spots[b].time { (a, b) } else { (b, a) };
        if self.spots[from].time == self.spots[to].time {
            let (a, b, time) = (self.shown(a), self.shown(b), self.spots[a].time);
            let why = format!("a link from {a} to {b}, both at time {time}: links must lead to a later time");
            return Err(malformed(file, line as usize, why));
        }
        if self.link_files.last().is_none_or(|last| last != file) {
            self.link_files.push(file.to_owned());
        }
        self.links.push(SpotLink { from, to, file: self.link_files.len() - 1, line });
        Ok(())
    }

    /// Joins the spots by their links. Links to spots with several mothers are left out before divisions are looked for: otherwise a wrong
    /// link would end the cell that it comes from.
    fn join(&mut self) {
        let links = std::mem::take(&mut self.links);
        let (mut mothers, mut count): (HashMap<usize, usize>, HashMap<usize, usize>) = Default::default();
        let (mut merged, mut known, mut kept) = (HashSet::new(), HashSet::new(), Vec::with_capacity(links.len()));
        for link in links {
            let SpotLink { from, to, .. } = link;
            let before = *mothers.entry(to).or_insert(from);
            if !known.insert((from, to)) {
                let why = format!("a second link from {} to {}: it is used once", self.shown(from), self.shown(to));
                self.refuse(link, why);
            } else if before == from {
                kept.push(link);
            } else {
                let [first, from] = [before, from].map(|spot| self.shown(spot));
                merged.insert(to);
                self.refuse(link, format!("it comes from {first} and from {from}: it is left without a mother"));
            }
        }
        kept.retain(|link| !merged.contains(&link.to));
        kept.iter().for_each(|link| *count.entry(link.from).or_default() += 1);
        let mut seen: HashMap<usize, usize> = HashMap::new();
        for link in kept {
            let SpotLink { from, to, .. } = link;
            let number = seen.entry(from).or_default();
            *number += 1;
            if count.get(&from).is_some_and(|count| *count <= 2) {
                self.next[from][*number - 1] = Some(to);
                self.previous[to] = Some(from);
            } else if *number > 2 {
                let which = if *number == 3 { "a third link" } else { "one more link" };
                let why = format!("{which} from {}: this cell is left without daughters", self.shown(from));
                self.refuse(link, why);
            }
        }
    }

    /// Reports a link that is not used.
    fn refuse(&mut self, SpotLink { to, file, line, .. }: SpotLink, why: String) {
        let (file, value) = (self.link_files[file].clone(), self.spots[to].name.clone());
        self.skip(&file, line, "link", &value, why);
    }

    /// Marks the last spot of a cell: a link from here leads to a daughter, unless the names are equal.
    pub fn part(&mut self, spot: usize) {
        self.parted.insert(spot);
    }

    /// Links spots by their ids, past spots without a place.
    ///
    /// # Errors
    /// As [`Spots::link`].
    pub fn link_all<K: Copy + Eq + Hash>(
        &mut self,
        links: Vec<Link<K>>,
        places: &HashMap<K, usize>,
        file: &str,
    ) -> Result<(), InputError> {
        let time = |id: K| places.get(&id).map(|spot| self.spots[*spot].time);
        for (line, [from, to]) in links_past(links, time) {
            if let (Some(from), Some(to)) = (places.get(&from), places.get(&to)) {
                self.link(*from, *to, file, line)?;
            }
        }
        Ok(())
    }

    /// Leaves out the spots that no link of a file names: they belong to no track.
    pub fn leave_out_unlinked(&mut self, file: &str, links: &Path) {
        self.left_out = (0..self.spots.len()).filter(|spot| !self.linked.contains(spot)).collect();
        let Some(first) = self.left_out.iter().min().map(|first| &self.spots[*first]) else { return };
        let (line, id) = (first.line, first.id.map_or(String::new(), |id| id.to_string()));
        let (links, count) = (links.file_name().unwrap_or_default().to_string_lossy(), self.left_out.len());
        let why = format!("no link of {links} names it, so that it belongs to no track; there are {count} such spots");
        self.skip(file, line, "ID", &id, why);
    }

    /// A spot in a message.
    fn shown(&self, spot: usize) -> String {
        let Spot { name, file, line, .. } = &self.spots[spot];
        let place = if *line > 0 { format!(" ({}:{line})", self.files[*file]) } else { String::new() };
        format!("{}{place}", furrow_input::shown(name))
    }

    /// Whether a cell is born with a spot: at a division, or where only one daughter was followed, and the file or the names say so.
    fn is_born(&self, spot: usize) -> bool {
        let Some(before) = self.previous[spot] else { return true };
        let (name, mother) = (&self.spots[spot].name, &self.spots[before].name);
        self.next[before][1].is_some()
            || self.parted.contains(&before) && !(is_cell(name) && name == mother)
            || birth(name).is_some_and(|(named, ..)| named == mother)
    }

    /// The cells, mothers before daughters.
    ///
    /// # Errors
    /// There are no spots.
    pub fn lineage(
        mut self,
        name: String,
        format: Format,
        time: TimeUnit,
        volumes: impl Into<SizeUnit>,
    ) -> Result<TrackedLineage, InputError> {
        self.join();
        let mut order: Vec<usize> = (0..self.spots.len()).filter(|spot| !self.left_out.contains(spot)).collect();
        if order.is_empty() {
            return Err(self.unusable(format));
        }
        order.sort_by_cached_key(|k| OrderedFloat(self.spots[*k].time));
        let mut cells: Vec<TrackedCell> = Vec::new();
        let mut of_spot = vec![None; self.spots.len()];
        let mut counts: Vec<usize> = Vec::new();
        for spot in order {
            let before = self.previous[spot].and_then(|before| of_spot[before]);
            let index = match before.filter(|_| !self.is_born(spot)) {
                Some(same) => same,
                None => {
                    counts.push(0);
                    self.begin(&mut cells, spot, before)
                }
            };
            of_spot[spot] = Some(index);
            counts[index] += 1;
            self.extend(&mut cells[index], spot);
        }
        let one_size = self.one_size(&cells, &of_spot);
        let places = namesakes::order(&cells, &counts);
        let of_spot: Vec<Option<usize>> = of_spot.into_iter().map(|cell| cell.map(|cell| places[cell])).collect();
        let cells = namesakes::moved(cells, &places);
        let known = self.known(&of_spot);
        let frames = Frames::of(&self.spots, time);
        let Spots { skipped, skipped_count, .. } = self;
        let SizeUnit { unit: volumes, in_pixels, is_bare } = volumes.into();
        let takes = Takes { frame_minutes: time == TimeUnit::Frames, pixel: in_pixels, unit: is_bare };
        let mut lineage = TrackedLineage {
            name,
            format,
            cells,
            time,
            volumes,
            skipped,
            skipped_count,
            matched: None,
            spots: known,
            takes,
            frame: frames.shortest(),
            unknown_sizes: None,
        };
        lineage.leave_out_sizes(one_size);
        // In a graph with a node for each cell, which furrow writes, times between nodes say nothing.
        let is_followed = counts.iter().any(|count| *count > 1);
        lineage.join_births(|last| if is_followed { frames.after(last) } else { f64::INFINITY });
        Ok(lineage)
    }

    /// The error for a file without a spot that can be used.
    fn unusable(&self, format: Format) -> InputError {
        let file = self.files.first().cloned().unwrap_or_default();
        let reason = self.skipped.first().map_or("it has no spots".to_owned(), |first| {
            let Skipped { line, column, value, why, .. } = first;
            format!("line {line}, {column}: {value:?}: {why}")
        });
        InputError::other_file(file, &format!("{} with a cell that can be used", format.name()), reason)
    }

    /// A report if the spots of mothers and daughters have one and the same size: a detector gives it to every spot, and it is no
    /// measurement.
    fn one_size(&self, cells: &[TrackedCell], of_spot: &[Option<usize>]) -> Option<Skipped> {
        let is_sized = |cell: &TrackedCell| cell.sizes > 0;
        let is_daughter = |cell: &TrackedCell| cell.mother.is_some_and(|mother| is_sized(&cells[mother]));
        if !cells.iter().any(|cell| is_sized(cell) && is_daughter(cell)) {
            return None;
        }
        let used = self.spots.iter().zip(of_spot).filter(|(_, cell)| cell.is_some()).map(|(spot, _)| spot);
        let sized: Vec<(&Spot, f64)> = used.filter_map(|spot| Some((spot, spot.volume?))).collect();
        let (first, size) = sized.first()?;
        if sized.iter().any(|(_, other)| (other - size).abs() > SAME_SIZE * size) {
            return None;
        }
        Some(Skipped {
            file: self.files[first.file].clone(),
            line: first.line,
            column: "size".to_owned(),
            value: sized.len().to_string(),
            why: "spots of mothers and daughters, all of one size, as a detector sets it: sizes are unknown".to_owned(),
        })
    }

    /// Names, tracks and ids of spots with their cells. A name comes before an equal id.
    fn known(&self, of_spot: &[Option<usize>]) -> SpotNames {
        let mut known: SpotNames = HashMap::new();
        let mut add = |name: &str, cell: usize| {
            let cells = known.entry(name.to_owned()).or_insert(Some(cell));
            *cells = cells.filter(|before| *before == cell);
        };
        let used = || self.spots.iter().zip(of_spot).filter_map(|(spot, cell)| Some((spot, (*cell)?)));
        used().filter(|(spot, _)| !spot.name.is_empty()).for_each(|(spot, cell)| add(&spot.name, cell));
        for (name, spot) in &self.tracks {
            known.entry(name.clone()).or_insert(of_spot[*spot]);
        }
        for (spot, cell) in used() {
            if let Some(id) = spot.id {
                known.entry(id.to_string()).or_insert(Some(cell));
            }
        }
        known
    }

    /// Adds a cell that begins with a spot.
    fn begin(&self, cells: &mut Vec<TrackedCell>, spot: usize, mother: Option<usize>) -> usize {
        let (index, Spot { time, name, file, line, .. }) = (cells.len(), &self.spots[spot]);
        if let Some(mother) = mother {
            // Spots come in the order of time: this is the first daughter.
            cells[mother].division.get_or_insert(*time);
            cells[mother].daughters.push(index);
        }
        cells.push(TrackedCell {
            name: name.clone(),
            tracked: name.clone(),
            mother,
            birth: *time,
            first: *time,
            last: *time,
            place: (self.files[*file].clone(), *line),
            ..TrackedCell::default()
        });
        index
    }

    /// Adds a spot to its cell.
    fn extend(&mut self, cell: &mut TrackedCell, spot: usize) {
        let Spot { time, name, volume, file, line, .. } = self.spots[spot].clone();
        cell.last = time;
        if let Some(volume) = volume {
            let sum = cell.volume.unwrap_or(0.0) * cell.sizes as f64 + volume;
            cell.sizes += 1;
            cell.volume = Some(sum / cell.sizes as f64);
        }
        if name.is_empty() || name == cell.name {
            return;
        }
        match [is_cell(&cell.name), is_cell(&name)] {
            [false, true] => cell.name = name,
            [true, true] => {
                let (file, why) = (self.files[file].clone(), format!("the cell is called {} before", cell.name));
                self.skip(&file, line, "name", &name, why);
            }
            _ => {}
        }
    }
}
