//! Tables of tracks, a row per track and frame, as napari, ultrack, btrack and ilastik write them, or of spots that are linked by their
//! ids (`id`, `parent_id`), as of funtracks.
//!
//! The columns are `track_id`, a time (`t`; `time (min)` has a unit and comes before frames, unless their minutes are given), coordinates,
//! and the track that each comes from: `parent_track_id` (ultrack) or `parent` (btrack). napari has that in a graph of its own, which is
//! read from a file beside the table: `…_graph.csv` with the columns `child` and `parent`, or `…_graph.json`, `{"child": [parent], …}`.
//! Sizes are `volume` (with its unit, else in voxels or the given unit), `radius` or `diameter` in pixels, or beside a column `z` `area`,
//! which counts voxels unless z is 0 in all rows.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use furrow_input::table::{Header, Row, TIMES, Table, malformed, split_unit, text, unit_of, units_listed};
use furrow_input::{InputError, open_file};
use serde_json::Value as Json;

use super::chains::{self, Chain, Only};
use super::lengths::{
    LENGTHS, LengthUnit, SizeUnit, known_length_unit, length_unit, sphere_in, unit_of_bare, unit_of_pixels,
    unit_of_spheres, voxel,
};
use super::rows::{FirstRows, contents, repeat};
use super::spots::{Spot, Spots};
use super::{Format, TimeUnit, TrackOptions, TrackedLineage, embryo_of, located_file, whole, zarr};
use crate::layout::{MISSING, volume_column};
use crate::volumes::{Skipped, Unit};

const TRACK: [&str; 3] = ["track_id", "trackid", "track"];
/// Ids of tracks in tables without a column of the others, or of single spots.
const ID: [&str; 4] = ["id", "node_id", "spot_id", "cell_id"];
const PARENT_ID: [&str; 3] = ["parent_id", "parentid", "parent_node_id"];
/// Columns of times. Without a unit they are frames, and one that comes first here is: beside `frame`, `time` may be in any unit.
const TIME: [&str; 6] = ["frame", "frame_number", "timepoint", "time_point", "t", "time"];
const PARENT: [&str; 5] = ["parent_track_id", "parent_track", "parenttrackid", "parent", "mother"];
const CHILD: [&str; 3] = ["child", "track_id", "track"];

/// Whether these are the columns of a table of tracks.
pub(super) fn is_table(columns: &[&str]) -> bool {
    // Positions may have units, too.
    let has = |names: &[&str]| columns.iter().any(|name| names.contains(&unified(split_unit(name).0).as_str()));
    let has_time = columns.iter().any(|name| time_unit(name).is_some());
    let has_places = has(&["x"]) && has(&["y"]);
    let has_ids =
        has(&TRACK) && (has_places || has(&PARENT)) || has(&ID) && has_places && (has(&PARENT) || has(&PARENT_ID));
    has_ids && has_time && !["embryo", "embryo_name", "embryo_id"].iter().any(|name| has(&[name]))
}

/// A name of a column in lower case and with underscores.
fn unified(name: &str) -> String {
    name.to_lowercase().replace([' ', '-'], "_")
}

/// The unit in the heading of a column of times, as `t`, `time (min)` or `time_s`; `None` for another column.
fn time_unit(heading: &str) -> Option<&str> {
    let (name, unit) = split_unit(heading);
    if TIME.contains(&unified(name).as_str()) {
        return Some(unit.unwrap_or_default());
    }
    let (name, unit) = heading.rsplit_once(['_', ' '])?;
    let name = unified(name);
    let is_time = TIME.contains(&name.strip_suffix("_in").unwrap_or(&name));
    (is_time && unit_of(unit, &TIMES).is_some()).then_some(unit)
}

/// The column of times, and their minutes unless they are frames. Times in a unit come before frames, unless the minutes of a frame are
/// given.
fn time_column(header: &Header<'_>, options: &TrackOptions) -> Result<Option<(usize, Option<f64>)>, InputError> {
    let units: Vec<(usize, &str)> =
        header.names.iter().enumerate().filter_map(|(column, name)| Some((column, time_unit(name)?))).collect();
    let is_frames = |unit: &str| ["", "frame", "frames"].contains(&unit.to_lowercase().as_str());
    let rank = |column: usize| {
        let name = unified(split_unit(&header.names[column]).0);
        TIME.iter().position(|known| *known == name).unwrap_or(TIME.len())
    };
    let frames = units.iter().filter(|(_, unit)| is_frames(unit)).min_by_key(|(column, _)| rank(*column));
    let timed = units.iter().find(|(_, unit)| unit_of(unit, &TIMES).is_some());
    let (first, second) = if options.frame_minutes.is_some() { (frames, timed) } else { (timed, frames) };
    // Another unit is refused where there are no other times.
    let Some((column, unit)) = first.or(second).or(units.first()).copied() else { return Ok(None) };
    if is_frames(unit) {
        return Ok(Some((column, None)));
    }
    let minutes = unit_of(unit, &TIMES).map(|unit| unit.size).ok_or_else(|| {
        let (heading, allowed) = (&header.names[column], units_listed(&TIMES));
        header.refused(format!("the unit of column {}, {heading:?}, must be frames or one of {allowed}", column + 1))
    })?;
    Ok(Some((column, Some(minutes))))
}

/// The size of a row.
enum Size {
    /// None.
    Unknown,
    /// A column of volumes, and the size of their unit.
    Volume(usize, f64),
    /// A column of lengths, how many of them are a diameter, and their unit.
    Length(usize, f64, LengthUnit),
}

/// The columns of a table.
struct Columns {
    track: usize,
    time: usize,
    /// Minutes in a unit of time; `None` for frames.
    minutes: Option<f64>,
    parent: Option<usize>,
    name: Option<usize>,
    size: Size,
    unit: SizeUnit,
    /// The column z, where the size is an area that is a volume in three dimensions.
    z: Option<usize>,
}

impl Columns {
    fn of(header: &Header<'_>, options: &TrackOptions) -> Result<Columns, InputError> {
        let (track, parent) = links(header);
        let time = time_column(header, options)?;
        let (Some(track), Some((time, minutes))) = (track, time) else {
            let time = time.map(|(column, _)| column);
            return Err(header.missing(&[("track_id", track), ("t", time)], "a table of tracks has them"));
        };
        let (voxel, voxels) = (voxel(options), unit_of_pixels(options));
        let z = header.find(&["z"]);
        let of_region = header.find(&["area", "n_voxels", "num_voxels"]).filter(|_| z.is_some());
        let area = of_region.or_else(|| size_of_ilastik(header));
        let (size, unit) = match volume_column(header)? {
            Some((at, Some(unit))) if unit.kind != Unit::Voxels => (Size::Volume(at, unit.size), unit.kind.into()),
            Some((at, Some(_))) => (Size::Volume(at, voxel), voxels),
            // Programs that count in voxels do not say so.
            Some((at, None)) => {
                let (size, unit) = unit_of_bare(Unit::Voxels, options);
                (Size::Volume(at, size), unit)
            }
            None => match (length(header, options)?, area) {
                (Some((at, part, unit)), _) => (Size::Length(at, part, unit), unit_of_spheres(unit, options)),
                (None, Some(at)) => (Size::Volume(at, voxel), voxels),
                (None, None) => (Size::Unknown, voxels),
            },
        };
        let z = z.filter(|_| matches!(size, Size::Volume(at, _) if Some(at) == of_region));
        // Spots with ids of their own are called by their tracks.
        let name = ["name", "cell_name", "cell"].into_iter().find_map(|name| header.find(&[name]));
        let name = name.or_else(|| header.find(&TRACK)).filter(|name| *name != track);
        Ok(Columns { track, time, minutes, parent, name, size, unit, z })
    }
}

/// The columns of ids and of the ids that they come from: of tracks, or in tables without a track's parent of spots.
fn links(header: &Header<'_>) -> (Option<usize>, Option<usize>) {
    let (track, id) = (header.find(&TRACK), header.find(&ID));
    let [of_track, of_id] = [header.find(&PARENT), header.find(&PARENT_ID)];
    match (track, id) {
        (Some(_), Some(_)) if of_track.is_none() && of_id.is_some() => (id, of_id),
        (None, id) => (id, of_id.or(of_track)),
        (track, None) => (track, of_track.or(of_id)),
        (track, Some(_)) => (track, of_track),
    }
}

/// The column in which ilastik counts voxels; in two dimensions these are an area.
fn size_of_ilastik(header: &Header<'_>) -> Option<usize> {
    let centre = |axis: u32| header.find(&[&format!("center_of_the_object_{axis}"), &format!("object_center_{axis}")]);
    let is_flat = centre(1).is_some() && centre(2).is_none();
    header.find(&["size_in_pixels_0", "size_in_pixels"]).filter(|_| !is_flat)
}

/// The unit in the heading of a column of this name, as `radius`, `radius (um)` or `radius_um`; `None` for another column.
fn unit_behind<'h>(heading: &'h str, name: &str) -> Option<&'h str> {
    let (base, unit) = split_unit(heading);
    if unified(base) == name {
        return Some(unit.unwrap_or_default());
    }
    let (base, unit) = heading.trim().rsplit_once(['_', ' '])?;
    let base = unified(base);
    (base.strip_suffix("_in").unwrap_or(&base) == name && length_unit(unit).is_some()).then_some(unit)
}

/// The column of radii or diameters, its values per diameter (2 or 1), and its unit, pixels unless the heading says another. One with a
/// unit comes before others.
fn length(header: &Header<'_>, options: &TrackOptions) -> Result<Option<(usize, f64, LengthUnit)>, InputError> {
    for (name, part) in [("radius", 2.0), ("diameter", 1.0)] {
        let all = header.names.iter().enumerate();
        let named = all.filter_map(|(at, heading)| Some((at, unit_behind(heading, name)?)));
        let Some((at, unit)) = named.min_by_key(|(_, unit)| unit.is_empty()) else { continue };
        let heading = &header.names[at];
        let unit = known_length_unit(unit, options, || {
            let allowed = units_listed(&LENGTHS);
            header.refused(format!("the unit of column {}, {heading:?}, must be one of {allowed}", at + 1))
        })?;
        return Ok(Some((at, part, unit)));
    }
    Ok(None)
}

/// A track while its rows are read.
struct Track {
    chain: Chain,
    /// The id of the track that it comes from, and the line that says so.
    parent: Option<(u64, u64)>,
}

/// Tracks by their ids, in the order of the table.
#[derive(Default)]
struct Tracks {
    all: Vec<Track>,
    places: HashMap<u64, usize>,
    /// Whether rows are left out: then tracks may be missing.
    has_gaps: bool,
}

pub(super) fn read(path: &Path, options: &TrackOptions) -> Result<TrackedLineage, InputError> {
    let file = path.display().to_string();
    let mut table = Table::open(open_file(path)?, &file)?;
    let header = table.columns(|_| false)?;
    let columns = Columns::of(&header, options)?;
    let (mut spots, mut tracks, mut rows) = (Spots::of(&file), Tracks::default(), FirstRows::new());
    let mut plane = Plane::default();
    while let Some(row) = table.next_row()? {
        let values = match Values::of(row, &columns) {
            Ok(values) => values,
            Err((column, why)) => {
                spots.skip(&file, row.line, row.name(column), &text(row.text(column)), why);
                tracks.has_gaps = true;
                continue;
            }
        };
        if options.frame_minutes.is_some() && columns.minutes.is_none() && values.time.fract() != 0.0 {
            let allowed =
                "must be a whole number of frames, as minutes of a frame are given; times have a unit, as t (min)";
            let why = format!("{} = {}: {allowed}", row.name(columns.time), values.time);
            return Err(malformed(&file, row.line as usize, why));
        }
        let contents = contents(&header.names, |column| row.text(column));
        if let Some(first) = rows.repeated((values.track, values.time.to_bits()), row.line, contents) {
            spots.skip(&file, row.line, row.name(columns.track), &values.track.to_string(), repeat(first));
            continue;
        }
        read_row(row, &values, &columns, &file, options, (&mut spots, &mut tracks))?;
        columns.z.into_iter().for_each(|z| plane.note(row, z));
    }
    let graph = match columns.parent {
        Some(_) => None,
        None => Some(graph_beside(path)?),
    };
    if let Some(graph) = graph {
        read_graph(&graph, &mut spots, &mut tracks)?;
    }
    let mut chains = tracks.chains(&mut spots, &file)?;
    // Where each id is of one spot, spots are linked and not tracks: the only spot after another is the same cell.
    let of_spots = header.find(&TRACK) != Some(columns.track) && chains.iter().all(|chain| chain.spots.len() == 1);
    let only = if of_spots { Only::SameCell } else { Only::Daughter };
    chains::link(&mut spots, &mut chains, (&file, "t"), only)?;
    let time = if columns.minutes.is_some() { TimeUnit::Minutes } else { TimeUnit::Frames };
    let mut lineage = spots.lineage(embryo_of(path), Format::Tracks, time, columns.unit)?;
    lineage.leave_out_sizes(plane.report(&file));
    Ok(lineage)
}

/// The plane z = 0, which films in two dimensions have in all rows: then areas are no volumes.
#[derive(Default)]
struct Plane {
    /// The line of the first row.
    first: Option<u64>,
    /// Whether a row is outside the plane.
    is_left: bool,
}

impl Plane {
    fn note(&mut self, row: Row<'_>, z: usize) {
        self.first.get_or_insert(row.line);
        self.is_left |= row.number(z).ok() != Some(0.0);
    }

    fn report(self, file: &str) -> Option<Skipped> {
        let line = self.first.filter(|_| !self.is_left)?;
        let why = "all rows have this z: areas in a plane are no volumes, and sizes are unknown".to_owned();
        Some(Skipped { file: file.to_owned(), line, column: "z".to_owned(), value: "0".to_owned(), why })
    }
}

/// The required values of a row.
struct Values {
    track: u64,
    time: f64,
    parent: Option<u64>,
}

impl Values {
    /// The values of a row, or the column that makes it useless, and why.
    fn of(row: Row<'_>, columns: &Columns) -> Result<Values, (usize, String)> {
        if let Some(surplus) = row.surplus() {
            return Err(surplus);
        }
        let refused = |column: usize, why: &str| (column, why.to_owned());
        let track = whole(row.text(columns.track));
        let track = track.ok_or_else(|| refused(columns.track, "must be a whole number from 0"))?;
        let time = row.number(columns.time).ok().filter(|time| time.is_finite());
        let allowed = if columns.minutes.is_some() { "must be a time" } else { "must be a number of frames" };
        let time = time.ok_or_else(|| refused(columns.time, allowed))? * columns.minutes.unwrap_or(1.0);
        let parent = columns.parent.map(|column| parent_of(row.text(column)).ok_or(column));
        let parent = parent.transpose().map_err(|column| refused(column, "must be a track_id, or -1"))?.flatten();
        Ok(Values { track, time, parent })
    }
}

fn read_row(
    row: Row<'_>,
    &Values { track: id, time, parent }: &Values,
    columns: &Columns,
    file: &str,
    options: &TrackOptions,
    (spots, tracks): (&mut Spots, &mut Tracks),
) -> Result<(), InputError> {
    let written = |column: usize| text(row.text(column)).into_owned();
    let size = |column: usize| {
        let why = "must be a size above 0";
        match row.number(column) {
            Ok(size) if size > 0.0 && size < 1e30 => Ok(size),
            Ok(_) => Err((column, why.to_owned())),
            Err(more) => Err((column, format!("{why} ({more})"))),
        }
    };
    let volume = match columns.size {
        Size::Unknown => Ok(None),
        Size::Volume(column, unit) => size(column).map(|size| Some(size * unit)),
        Size::Length(column, part, unit) => size(column).map(|size| Some(sphere_in(unit, size * part, options))),
    };
    if let Err((column, why)) = &volume {
        spots.skip(file, row.line, row.name(*column), &written(*column), why.as_str());
    }
    let name = columns.name.map(written).filter(|name| !name.is_empty()).unwrap_or_else(|| id.to_string());
    let volume = volume.ok().flatten();
    let spot = spots.push(Spot { time, name, id: Some(id.into()), volume, file: 0, line: row.line });
    // btrack calls the first tracks their own parents.
    let parent = parent.filter(|parent| *parent != id).map(|parent| (parent, row.line));
    let place = *tracks.places.entry(id).or_insert_with(|| {
        tracks.all.push(Track { chain: Chain { name: id.to_string(), ..Chain::default() }, parent });
        tracks.all.len() - 1
    });
    let track = &mut tracks.all[place];
    track.chain.spots.push(spot);
    let [before, now] = [track.parent, parent].map(|parent| parent.map(|(id, _)| id));
    if before != now {
        let of = |parent: Option<u64>| parent.map_or("no track".to_owned(), |id| format!("track {id}"));
        let why = format!("track {id} comes from {} in rows before, here from {}", of(before), of(now));
        return Err(malformed(file, row.line as usize, why));
    }
    Ok(())
}

/// How spreadsheets and pandas write a missing value, beside the [usual ways](MISSING).
const NOT_AVAILABLE: [&str; 2] = ["#n/a", "<na>"];

/// The track that one comes from, if it comes from one; `None` for a text that is neither.
fn parent_of(written: &[u8]) -> Option<Option<u64>> {
    match text(written).trim() {
        "" | "-1" | "-1.0" => Some(None),
        none if MISSING.iter().chain(&NOT_AVAILABLE).any(|missing| none.eq_ignore_ascii_case(missing)) => Some(None),
        _ => whole(written).map(Some),
    }
}

impl Tracks {
    /// The tracks with the places of their mothers. Mother 0 is no mother if no track has this number.
    ///
    /// # Errors
    /// A mother that is no track of the table, unless rows are left out: then this is reported.
    fn chains(self, spots: &mut Spots, file: &str) -> Result<Vec<Chain>, InputError> {
        let Tracks { all, places, has_gaps } = self;
        let chain = |Track { mut chain, parent }: Track| {
            if let Some((parent, line)) = parent.filter(|(parent, _)| *parent > 0 || places.contains_key(parent)) {
                chain.mother = places.get(&parent).copied();
                let allowed = "must be a track of the table";
                if chain.mother.is_none() && !has_gaps {
                    return Err(malformed(file, line as usize, format!("parent = {parent}: {allowed}")));
                }
                if chain.mother.is_none() {
                    spots.skip(file, line, "parent", &parent.to_string(), allowed);
                }
            }
            Ok(chain)
        };
        all.into_iter().map(chain).collect()
    }
}

/// The file of the graph beside a table of tracks.
fn graph_beside(path: &Path) -> Result<PathBuf, InputError> {
    let stem = embryo_of(path);
    let mut tried = Vec::new();
    for name in [stem.replace("tracks", "graph"), format!("{stem}_graph")] {
        tried.extend(["csv", "json"].map(|extension| format!("{name}.{extension}")));
    }
    // A table without the word has one name only, and is no graph itself.
    tried.retain(|name| path.file_name().is_none_or(|own| own.to_string_lossy() != name.as_str()));
    if !stem.contains("tracks") {
        tried.drain(..tried.len().saturating_sub(2));
    }
    let found = tried.iter().map(|name| path.with_file_name(name)).find(|path| path.is_file());
    found.ok_or_else(|| {
        let allowed =
            format!("a column, or a graph beside the table ({}): else no cell has a mother", tried.join(", "));
        InputError::not_allowed(path.display().to_string(), "parent_track_id", "none", allowed)
    })
}

/// Whether a file has the graph of a table of tracks beside it: it is read with that table.
pub(super) fn is_graph(path: &Path) -> bool {
    let is_one = path.extension().is_some_and(|extension| extension == "csv" || extension == "json");
    let stem = embryo_of(path);
    let tables = [
        stem.contains("graph").then(|| stem.replace("graph", "tracks")),
        stem.strip_suffix("_graph").map(str::to_owned),
    ];
    let beside =
        |stem: String| ["csv", "tsv", "txt"].map(|extension| path.with_file_name(format!("{stem}.{extension}")));
    let is_table = |table: &PathBuf| {
        let has_tracks = || matches!(located_file(table), Ok(Some((Format::Tracks, _))));
        table.is_file() && has_tracks() && graph_beside(table).is_ok_and(|graph| graph == path)
    };
    is_one && tables.into_iter().flatten().flat_map(beside).any(|table| is_table(&table))
}

/// Adds the mothers that a graph gives.
fn read_graph(path: &Path, spots: &mut Spots, tracks: &mut Tracks) -> Result<(), InputError> {
    let file = path.display().to_string();
    let refused = |line: u64, why: String| Err(malformed(&file, line.max(1) as usize, why));
    for (line, child, parent) in edges(path, &file)? {
        let [Some(child_at), Some(_)] = [child, parent].map(|id| tracks.places.get(&id).copied()) else {
            let allowed = "both must be tracks of the table";
            if tracks.has_gaps {
                spots.skip(&file, line, "child", &child.to_string(), format!("its parent is {parent}: {allowed}"));
                continue;
            }
            return refused(line, format!("{child} from {parent}: {allowed}"));
        };
        let track = &mut tracks.all[child_at];
        match track.parent.replace((parent, line)) {
            Some((before, _)) if before != parent => {
                track.parent = None;
                let why = format!("it comes from {before} and from {parent}: it is left without a mother");
                spots.skip(&file, line, "child", &child.to_string(), why);
            }
            _ => {}
        }
    }
    Ok(())
}

/// Line, child and parent of each edge of a graph.
fn edges(path: &Path, file: &str) -> Result<Vec<(u64, u64, u64)>, InputError> {
    let mut edges = Vec::new();
    if path.extension().is_some_and(|extension| extension == "json") {
        let document = zarr::json(path)?;
        let refused = |child: &str, value: &Json| {
            InputError::not_allowed(file, format!("parents of {child}"), value, "a track, or a list of tracks")
        };
        let Some(object) = document.as_object() else {
            return Err(InputError::not_allowed(file, "graph", &document, "{\"child\": [parent], …}"));
        };
        for (child, parents) in object {
            let parents = parents.as_array().cloned().unwrap_or_else(|| vec![parents.clone()]);
            for value in parents {
                let ids = child.parse().ok().zip(value.as_u64());
                let (child, parent) = ids.ok_or_else(|| refused(child, &value))?;
                edges.push((0, child, parent));
            }
        }
        return Ok(edges);
    }
    let mut table = Table::open(open_file(path)?, file)?;
    let header = table.columns(|_| false)?;
    let (child, parent) = (header.find(&CHILD), header.find(&PARENT));
    let (Some(child), Some(parent)) = (child, parent) else {
        return Err(header.missing(&[("child", child), ("parent", parent)], "a graph of tracks has them"));
    };
    while let Some(row) = table.next_row()? {
        let Some((one, other)) = whole(row.text(child)).zip(parent_of(row.text(parent))) else {
            return Err(malformed(file, row.line as usize, "child and parent must be whole numbers from 0"));
        };
        // A line without a parent is of a first track.
        edges.extend(other.map(|other| (row.line, one, other)));
    }
    Ok(edges)
}
