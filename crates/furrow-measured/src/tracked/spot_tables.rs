//! Spots and links as CSV: of TrackMate (spots and edges) and Mastodon (spots and links).
//!
//! The table of links lies beside the table of spots: `…_spots.csv` and `…_edges.csv` of TrackMate, `…-Spot.csv` and `…-Link.csv`
//! of Mastodon. Both programs repeat their headings: TrackMate has three more lines (names, short names, units), Mastodon two
//! (names of the parts of a column, units). Users often remove these lines, so the columns of ids decide how many there are: a
//! row with an id is data. A spot's name is its label. Times are `POSITION_T` where the heading gives its unit, unless the minutes of a
//! frame are given.

use std::collections::HashMap;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use csv::ByteRecord;
use furrow_input::{InputError, listed, open_file, shown};

use super::lengths::{LENGTHS, LengthUnit, PIXELS, SizeUnit, known_length_unit, sphere_in, unit_of_spheres};
use super::rows::{FirstRows, contents, repeat};
use super::spots::{Spot, Spots};
use super::times::minutes_in;
use super::{Format, TimeUnit, TrackOptions, TrackedLineage, embryo_of, whole};
use crate::volumes::Unit;
use furrow_input::table::{Table, malformed, text, units_listed};

/// Columns of the two tables, each under any of several names, and how their files are called.
struct Layout {
    /// Label, id, frame and radius of a spot.
    spot: [&'static [&'static str]; 4],
    /// Columns of the spots that a link leads from and to; two of Mastodon have one name, with their parts below.
    link: [&'static [&'static str]; 2],
    /// The time of a spot in a unit.
    time: &'static [&'static str],
    /// Most lines of a heading.
    heading: usize,
    /// Pairs of words in file names: for the file of spots, and for the file of links.
    words: &'static [(&'static str, &'static str)],
}

const TRACKMATE: Layout = Layout {
    spot: [&["LABEL", "Label"], &["ID", "Spot ID"], &["FRAME", "Frame"], &["RADIUS", "Radius", "R"]],
    link: [&["SPOT_SOURCE_ID", "Source spot ID", "Source ID"], &["SPOT_TARGET_ID", "Target spot ID", "Target ID"]],
    time: &["POSITION_T", "T"],
    heading: 4,
    words: &[("spots", "edges"), ("Spots", "Edges"), ("spots", "links"), ("Spots", "Links")],
};

const MASTODON: Layout = Layout {
    spot: [&["Label"], &["ID"], &["Spot frame"], &["Spot radius"]],
    // Without the line of parts the first of two columns of one name is the source; pandas numbers the second one.
    link: [&["Source spot id", "Link target IDs"], &["Target spot id", "Link target IDs", "Link target IDs.1"]],
    time: &[],
    heading: 3,
    words: &[("Spot", "Link"), ("spot", "link"), ("spots", "links")],
};

/// The format of a table by the columns in its first line. Links are recognised too, so that they can be refused.
pub(super) fn format_of(columns: &[&str]) -> Option<Format> {
    let has = |names: &[&str]| names.iter().any(|name| columns.contains(name));
    if has(&["Spot frame", "Link target IDs"]) {
        return Some(Format::Mastodon);
    }
    let [label, id, frame, _] = TRACKMATE.spot;
    (has(TRACKMATE.link[0]) || (has(label) && has(id) && has(frame))).then_some(Format::TrackMate)
}

/// Whether a file has the links beside a table of spots: that table is read, and its links with it.
pub(super) fn is_of_links(path: &Path) -> bool {
    let words = TRACKMATE.words.iter().chain(MASTODON.words);
    let mut spots = words.filter_map(|(spots, links)| Some(path.with_file_name(renamed(path, links, spots)?)));
    spots.any(|other| other != path && other.is_file())
}

/// The name of a file with the last occurrence of a word replaced; `None` if the word does not occur.
fn renamed(path: &Path, word: &str, other: &str) -> Option<String> {
    let name = path.file_name()?.to_string_lossy();
    let at = name.rfind(word)?;
    Some(format!("{}{other}{}", &name[..at], &name[at + word.len()..]))
}

pub(super) fn read(path: &Path, format: Format, options: &TrackOptions) -> Result<TrackedLineage, InputError> {
    let layout = if format == Format::Mastodon { MASTODON } else { TRACKMATE };
    let file = path.display().to_string();
    let mut spots = Spots::of(&file);
    let (mut ids, mut times) = (Ids::default(), Times::default());
    let unit = read_spots((&mut spots, &mut ids, &mut times), path, &layout, options)?;
    let (links, tried) = links_beside(path, &layout);
    let Some(links) = links else {
        let allowed = format!("beside a table of links ({}): without it no cell has a mother", tried.join(" or "));
        return Err(InputError::not_allowed(file, "links", "none", allowed));
    };
    let time = times.set(&mut spots, &file);
    read_links(&mut spots, &ids, &links, &layout)?;
    // Single spots of TrackMate are outside its tracks. Mastodon has no other cells than its spots.
    if format == Format::TrackMate {
        spots.leave_out_unlinked(&file, &links);
    }
    spots.lineage(embryo_of(path), format, time, unit)
}

/// The table of links beside the table of spots, and the names under which it may lie there.
fn links_beside(path: &Path, layout: &Layout) -> (Option<PathBuf>, Vec<String>) {
    let mut tried: Vec<String> = layout.words.iter().filter_map(|(spots, links)| renamed(path, spots, links)).collect();
    tried.dedup();
    let found = tried.iter().map(|name| path.with_file_name(name)).find(|path| path.is_file());
    if tried.is_empty() {
        let names = layout.words.iter().take(1);
        tried.extend(names.map(|(spots, links)| format!("the files must be called …{spots}.csv and …{links}.csv")));
    }
    (found, tried)
}

/// The heading of a table.
struct Heading {
    /// The names of its columns: of the first line, or where the second line names parts of a column, of that.
    names: Vec<String>,
    /// The line of units, if it has one.
    units: Option<ByteRecord>,
    /// How many lines it has.
    lines: usize,
}

/// A column of ids in a line of a heading below the first.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Below {
    /// A name, such as `Spot ID`.
    Name,
    /// A unit, or an empty text.
    Unit,
}

/// Reads a column of ids; `None` if the row is data.
fn below(text: &[u8]) -> Option<Below> {
    let written = self::text(text).trim().to_lowercase();
    match written.as_str() {
        "" => Some(Below::Unit),
        text if text.starts_with('(') && text.ends_with(')') => Some(Below::Unit),
        text => text.split_whitespace().any(|word| word == "id").then_some(Below::Name),
    }
}

/// Reads the first line of a heading. The lines below it may be longer or empty.
fn first_line<R: Read>(table: &mut Table<'_, R>) -> Result<Vec<String>, InputError> {
    let (_, names) = table.header(|_| false)?;
    table.name_columns(Vec::new());
    Ok(names)
}

impl Heading {
    /// Reads the heading of a table, in which `ids` are the columns of ids.
    fn of<R: Read>(table: &mut Table<'_, R>, layout: &Layout, ids: &[&[&str]]) -> Result<Heading, InputError> {
        let names = first_line(table)?;
        let of = |wanted: &[&str]| names.iter().position(|name| wanted.contains(&name.as_str()));
        let is_id = |name: &String| ids.iter().any(|ids| ids.contains(&name.as_str()));
        let places: Vec<usize> = (0..names.len()).filter(|at| is_id(&names[*at])).collect();
        let label = of(layout.spot[0]);
        let mut found = Heading { names: names.clone(), units: None, lines: 1 };
        while let Some((_, row)) = table.next()?.filter(|_| found.lines < layout.heading) {
            let is_empty = |at: usize| row.get(at).is_none_or(|text| text.trim_ascii().is_empty());
            let kinds: Option<Vec<Below>> = places.iter().map(|at| below(row.get(*at).unwrap_or_default())).collect();
            let all = |kind: Below| kinds.as_ref().is_some_and(|kinds| kinds.iter().all(|found| *found == kind));
            match (all(Below::Name), all(Below::Unit) && label.is_none_or(is_empty)) {
                (true, _) if layout.heading == MASTODON.heading => {
                    let parts = row.iter().map(|part| text(part).trim().to_owned());
                    let named = found.names.iter_mut().zip(parts).filter(|(_, part)| !part.is_empty());
                    named.for_each(|(name, part)| *name = part);
                }
                (true, _) => {}
                (false, true) => found.units = Some(row.clone()),
                _ => break,
            }
            found.lines += 1;
        }
        Ok(found)
    }

    /// The place of the first column, or of the last, with one of these names.
    fn place(&self, names: &[&str], is_last: bool) -> Option<usize> {
        let is_it = |name: &String| names.contains(&name.as_str());
        if is_last { self.names.iter().rposition(is_it) } else { self.names.iter().position(is_it) }
    }

    /// The place of a column that must be there.
    fn column(&self, names: &[&str], is_last: bool, file: &str, allowed: &str) -> Result<usize, InputError> {
        self.place(names, is_last).ok_or_else(|| {
            let here = listed(self.names.iter().map(String::as_str), ", ");
            malformed(file, 1, format!("no column is called {:?}; {allowed}; the columns here are {here}", names[0]))
        })
    }

    /// The column of times with a unit, and the minutes in it.
    fn clock(&self, layout: &Layout) -> Option<(usize, f64)> {
        let at = self.place(layout.time, false)?;
        Some((at, minutes_in(&text(self.units.as_ref()?.get(at)?))?))
    }

    /// The unit of radii: `None` without a line of units.
    fn unit(&self, radius: usize, file: &str, options: &TrackOptions) -> Result<Option<LengthUnit>, InputError> {
        let Some(units) = &self.units else { return Ok(None) };
        let text = text(units.get(radius).unwrap_or_default());
        let unit = known_length_unit(&text, options, || {
            let why = format!("the unit of radii is {}: must be one of {}", shown(&text), units_listed(&LENGTHS));
            malformed(file, self.lines, why)
        })?;
        Ok(Some(unit))
    }
}

/// A table and its heading, ready for the first row below it.
fn opened<'f>(
    path: &Path,
    file: &'f str,
    layout: &Layout,
    ids: &[&[&str]],
) -> Result<(Table<'f, File>, Heading), InputError> {
    let heading = Heading::of(&mut Table::open(open_file(path)?, file)?, layout, ids)?;
    let mut table = Table::open(open_file(path)?, file)?;
    first_line(&mut table)?;
    for _ in 1..heading.lines {
        table.next()?;
    }
    // Later rows that are longer are errors.
    table.name_columns(heading.names.clone());
    Ok((table, heading))
}

/// Spots by their ids.
#[derive(Default)]
struct Ids {
    places: HashMap<u64, usize>,
    /// Whether spots are left out: then links may lead to them.
    have_gaps: bool,
}

/// The minutes of all spots, in their order.
#[derive(Default)]
struct Times {
    minutes: Vec<f64>,
    /// Whether the column of times is empty for some spot.
    has_gaps: bool,
}

impl Times {
    /// Adds the minutes of a spot, which may be unknown or no number; `None` without a column of times.
    fn add(&mut self, minutes: Option<Option<f64>>) {
        let known = minutes.flatten().filter(|minutes| minutes.is_finite());
        self.minutes.extend(known);
        self.has_gaps |= minutes.is_some() && known.is_none();
    }

    /// Gives spots their minutes in place of frames, if later frames have later minutes.
    fn set(self, spots: &mut Spots, file: &str) -> TimeUnit {
        if self.minutes.is_empty() && !self.has_gaps {
            return TimeUnit::Frames;
        }
        let mut both: Vec<(f64, f64)> = spots.times().zip(self.minutes.iter().copied()).collect();
        both.sort_by(|one, other| one.0.total_cmp(&other.0).then(one.1.total_cmp(&other.1)));
        let is_clock = both.windows(2).all(|pair| pair[0].0 == pair[1].0 || pair[0].1 < pair[1].1);
        if self.has_gaps || !is_clock {
            let why = "must be a number in every row, and larger in later frames: frames are used";
            spots.skip(file, 0, TRACKMATE.time[0], "", why);
            return TimeUnit::Frames;
        }
        spots.set_times(&self.minutes);
        TimeUnit::Minutes
    }
}

/// Adds the spots of a table, and returns the unit of their volumes.
fn read_spots(
    (spots, ids, times): (&mut Spots, &mut Ids, &mut Times),
    path: &Path,
    layout: &Layout,
    options: &TrackOptions,
) -> Result<SizeUnit, InputError> {
    let file = path.display().to_string();
    let [label, id, frame, radius] = layout.spot;
    let (mut table, heading) = opened(path, &file, layout, &[id, layout.link[0], layout.link[1]])?;
    if heading.place(layout.link[0], false).is_some() {
        return Err(InputError::other_file(file, "a table of spots", "it has links; they are read with their spots"));
    }
    let columns = [label, id, frame].map(|names| heading.column(names, false, &file, "a table of spots has it"));
    let [label, id, frame] = columns;
    let columns = [label?, id?, frame?];
    let radius = heading.place(radius, false);
    let written = radius.map_or(Ok(None), |at| heading.unit(at, &file, options))?;
    // Without a line of units radii say which cell is larger, and no more, unless pixels are given their size.
    let length = written.unwrap_or(PIXELS);
    let unit = match written {
        None if radius.is_some() && options.pixel.is_none() => Unit::Relative.into(),
        _ => unit_of_spheres(length, options),
    };
    let clock = heading.clock(layout).filter(|_| options.frame_minutes.is_none());
    let of_times = clock.map(|(at, _)| table.numbers(at)).unwrap_or_default();
    let (numbers, mut rows) = (radius.map(|at| table.numbers(at)).unwrap_or_default(), FirstRows::new());
    while let Some((line, row)) = table.next()? {
        let [label, id, frame] = columns.map(|at| row.get(at).unwrap_or_default().trim_ascii());
        let text = |bytes: &[u8]| text(bytes).into_owned();
        let (Some(id), Some(time)) = (whole(id), whole(frame)) else {
            let (name, value) = if whole(id).is_none() { (layout.spot[1][0], id) } else { (layout.spot[2][0], frame) };
            spots.skip(&file, line, name, &text(value), "must be a whole number from 0");
            ids.have_gaps = true;
            continue;
        };
        let contents = contents(&heading.names, |at| row.get(at).unwrap_or_default().trim_ascii());
        if let Some(first) = rows.repeated(id, line, contents) {
            spots.skip(&file, line, layout.spot[1][0], &id.to_string(), repeat(first));
            continue;
        }
        let time = time as f64;
        let size = radius.map(|at| row.get(at).unwrap_or_default().trim_ascii());
        let radius = size.and_then(|size| numbers.read(size).ok()).filter(|radius| *radius > 0.0 && *radius < 1e30);
        if let (Some(size), None) = (size, radius) {
            spots.skip(&file, line, layout.spot[3][0], &text(size), "must be a radius above 0");
        }
        let volume = radius.map(|radius| sphere_in(length, 2.0 * radius, options));
        let spot = spots.push(Spot { time, id: Some(id.into()), name: text(label), volume, file: 0, line });
        let minutes =
            clock.map(|(at, size)| of_times.read(row.get(at).unwrap_or_default().trim_ascii()).ok().map(|t| t * size));
        times.add(minutes);
        if let Some(first) = ids.places.insert(id, spot) {
            let first = spots.get(first).line;
            let why = format!("ID = {id}: must be of one spot only; line {first} has it too");
            return Err(malformed(&file, line as usize, why));
        }
    }
    Ok(unit)
}

/// Adds the links of a table.
fn read_links(spots: &mut Spots, ids: &Ids, path: &Path, layout: &Layout) -> Result<(), InputError> {
    let file = path.display().to_string();
    let (mut table, heading) = opened(path, &file, layout, &layout.link)?;
    let ends = [false, true].map(|is_target| {
        let names = layout.link[usize::from(is_target)];
        heading.column(names, is_target, &file, "a table of links has it")
    });
    let [from, to] = ends;
    let ends = [from?, to?];
    let mut links = Vec::new();
    while let Some((line, row)) = table.next()? {
        let mut found = [0; 2];
        for (k, at) in ends.into_iter().enumerate() {
            let text = row.get(at).unwrap_or_default().trim_ascii();
            let is_known = |id: &u64| ids.have_gaps || ids.places.contains_key(id);
            found[k] = whole(text).filter(is_known).ok_or_else(|| {
                let (name, text) = (layout.link[k][0], shown(&self::text(text)));
                malformed(&file, line as usize, format!("{name} = {text}: must be the ID of a spot"))
            })?;
        }
        links.push((line, found));
    }
    spots.link_all(links, &ids.places, &file)
}
