//! Spots and links as CSV: of TrackMate (spots and edges) and Mastodon (spots and links).
//!
//! The table of links lies beside that of spots: `…_spots.csv` and `…_edges.csv` of TrackMate, `…-Spot.csv` and `…-Link.csv`
//! of Mastodon. Both programs repeat their headings: TrackMate has three more lines (names, short names, units), Mastodon two
//! (names of the parts of a column, units). A spot's name is its label.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use csv::ByteRecord;
use furrow_input::{InputError, listed, open_file, shown};

use super::spots::{Spot, Spots};
use super::{Format, TimeUnit, TrackOptions, TrackedLineage, embryo_of, sphere, sphere_of_pixels, unit_of_pixels};
use crate::table::{Table, malformed, number};
use crate::volumes::Unit;

/// Columns of the two tables, and how their files are called.
struct Layout {
    /// Label, id, frame and radius of a spot.
    spot: [&'static str; 4],
    /// Columns of the spots that a link leads from and to; two of Mastodon have one name, with their parts below.
    link: [&'static str; 2],
    /// Lines of a heading.
    heading: usize,
    /// The words for spots in the name of a file, and for links in that of the other.
    words: [(&'static str, &'static str); 3],
}

const TRACKMATE: Layout = Layout {
    spot: ["LABEL", "ID", "FRAME", "RADIUS"],
    link: ["SPOT_SOURCE_ID", "SPOT_TARGET_ID"],
    heading: 4,
    words: [("spots", "edges"), ("Spots", "Edges"), ("spots", "links")],
};

const MASTODON: Layout = Layout {
    spot: ["Label", "ID", "Spot frame", "Spot radius"],
    link: ["Source spot id", "Target spot id"],
    heading: 3,
    words: [("Spot", "Link"), ("spot", "link"), ("spots", "links")],
};

/// The format of a table by the columns in its first line. Links are recognised too, so that they can be refused.
pub(super) fn format_of(columns: &[&str]) -> Option<Format> {
    let has = |name: &str| columns.contains(&name);
    if has("Spot frame") || has("Link target IDs") {
        return Some(Format::Mastodon);
    }
    (has("SPOT_SOURCE_ID") || (has("ID") && has("FRAME") && has("LABEL"))).then_some(Format::TrackMate)
}

pub(super) fn read(path: &Path, format: Format, options: &TrackOptions) -> Result<TrackedLineage, InputError> {
    let layout = if format == Format::Mastodon { MASTODON } else { TRACKMATE };
    let file = path.display().to_string();
    let mut spots = Spots::of(&file);
    let mut ids = HashMap::new();
    let unit = read_spots(&mut spots, &mut ids, path, &layout, options)?;
    let (links, tried) = links_beside(path, &layout);
    let Some(links) = links else {
        let allowed = format!("beside a table of links ({}): without it no cell has a mother", tried.join(" or "));
        return Err(InputError::not_allowed(file, "links", "none", allowed));
    };
    read_links(&mut spots, &ids, &links, &layout)?;
    spots.lineage(embryo_of(path), format, TimeUnit::Frames, unit)
}

/// The table of links beside that of spots, and the names under which it may lie there.
fn links_beside(path: &Path, layout: &Layout) -> (Option<PathBuf>, Vec<String>) {
    let name = path.file_name().map_or(String::new(), |name| name.to_string_lossy().into_owned());
    let renamed = |(spots, links): &(&str, &str)| {
        let at = name.rfind(spots)?;
        Some(format!("{}{links}{}", &name[..at], &name[at + spots.len()..]))
    };
    let mut tried: Vec<String> = layout.words.iter().filter_map(renamed).collect();
    tried.dedup();
    let found = tried.iter().map(|name| path.with_file_name(name)).find(|path| path.is_file());
    if tried.is_empty() {
        let [(spots, links), ..] = layout.words;
        tried.push(format!("the files must be called …{spots}.csv and …{links}.csv"));
    }
    (found, tried)
}

/// The names in the heading of a table: the first line, with the second below it where that names parts of a column.
fn heading(rows: &[ByteRecord], parts: bool) -> Vec<String> {
    let text = |row: Option<&ByteRecord>, at: usize| {
        let text = row.and_then(|row| row.get(at)).unwrap_or_default();
        String::from_utf8_lossy(text).trim().to_owned()
    };
    let width = rows.first().map_or(0, ByteRecord::len);
    let name = |at: usize| match text(rows.get(1), at) {
        part if parts && !part.is_empty() => part,
        _ => text(rows.first(), at),
    };
    (0..width).map(name).collect()
}

/// The lines of a heading.
fn heading_of<R: std::io::Read>(table: &mut Table<'_, R>, layout: &Layout) -> Result<Vec<ByteRecord>, InputError> {
    let mut rows = Vec::new();
    for _ in 0..layout.heading {
        rows.extend(table.next()?.map(|(_, row)| row.clone()));
    }
    Ok(rows)
}

/// The place of a column.
fn column(names: &[String], name: &str, file: &str, allowed: &str) -> Result<usize, InputError> {
    names.iter().position(|column| column == name).ok_or_else(|| {
        let here = listed(names.iter().map(String::as_str), ", ");
        malformed(file, 1, format!("no column is called {name:?}; {allowed}; the columns here are {here}"))
    })
}

/// Adds the spots of a table, and returns the unit of their volumes.
fn read_spots(
    spots: &mut Spots,
    ids: &mut HashMap<u64, usize>,
    path: &Path,
    layout: &Layout,
    options: &TrackOptions,
) -> Result<Unit, InputError> {
    let file = path.display().to_string();
    let mut table = Table::open(open_file(path)?, &file)?;
    let rows = heading_of(&mut table, layout)?;
    let names = heading(&rows, false);
    // From here on a row that is longer is an error.
    table.name_columns(names.clone());
    if heading(&rows, layout.heading == 3).iter().any(|name| layout.link.contains(&name.as_str())) {
        return Err(InputError::other_file(file, "a table of spots", "it has links; they are read with their spots"));
    }
    let [label, id, frame, radius] = layout.spot;
    let columns = [label, id, frame].map(|name| column(&names, name, &file, "a table of spots has it"));
    let [label, id, frame] = columns;
    let columns = [label?, id?, frame?];
    let radius = names.iter().position(|name| name == radius);
    let unit = radius.map_or(Ok(Unit::Voxels), |at| unit_of(&rows, at, options, &file))?;
    let in_pixels = unit_in_heading(&rows, radius) != Some(Unit::CubicMicrometres);
    let numbers = table.numbers();
    while let Some((line, row)) = table.next()? {
        let [label, id, frame] = columns.map(|at| row.get(at).unwrap_or_default().trim_ascii());
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let whole = |name: &str, bytes: &[u8]| {
            let found = number(bytes).filter(|number| *number >= 0.0 && number.fract() == 0.0 && *number < 9e15);
            let why = format!("{name} = {}: must be a whole number from 0", shown(&text(bytes)));
            found.ok_or_else(|| malformed(&file, line as usize, why))
        };
        let (id, time) = (whole("ID", id)? as u64, whole(layout.spot[2], frame)?);
        let size = radius.map(|at| row.get(at).unwrap_or_default().trim_ascii());
        let radius = size.and_then(|size| numbers.read(size).ok()).filter(|radius| *radius > 0.0 && *radius < 1e30);
        if let (Some(size), None) = (size, radius) {
            spots.skip(&file, line, layout.spot[3], &text(size), "must be a radius above 0");
        }
        let sphere = |d: f64| if in_pixels { sphere_of_pixels(d, options) } else { sphere(d) };
        let volume = radius.map(|radius| sphere(2.0 * radius));
        let spot = spots.push(Spot { time, name: text(label), volume, file: 0, line });
        if let Some(first) = ids.insert(id, spot) {
            let first = spots.get(first).line;
            let why = format!("ID = {id}: must be of one spot only; line {first} has it too");
            return Err(malformed(&file, line as usize, why));
        }
    }
    Ok(unit)
}

/// The unit of radii in a heading's last line.
fn unit_in_heading(rows: &[ByteRecord], radius: Option<usize>) -> Option<Unit> {
    let text = rows.last()?.get(radius?)?;
    let text = String::from_utf8_lossy(text).to_lowercase();
    match text.trim().trim_matches(['(', ')']) {
        "micron" | "microns" | "µm" | "μm" | "um" | "micrometer" | "micrometre" => Some(Unit::CubicMicrometres),
        "pixel" | "pixels" | "" => Some(Unit::Voxels),
        _ => None,
    }
}

/// The unit of volumes: µm³ if radii are in µm, or in pixels of known size.
fn unit_of(rows: &[ByteRecord], radius: usize, options: &TrackOptions, file: &str) -> Result<Unit, InputError> {
    let unit = unit_in_heading(rows, Some(radius));
    let text = rows.last().and_then(|row| row.get(radius)).unwrap_or_default();
    let text = shown(&String::from_utf8_lossy(text));
    let why = || malformed(file, rows.len(), format!("the unit of radii is {text}: must be (micron), (µm) or (pixel)"));
    match unit.ok_or_else(why)? {
        Unit::Voxels => Ok(unit_of_pixels(options)),
        unit => Ok(unit),
    }
}

/// Adds the links of a table.
fn read_links(spots: &mut Spots, ids: &HashMap<u64, usize>, path: &Path, layout: &Layout) -> Result<(), InputError> {
    let file = path.display().to_string();
    let mut table = Table::open(open_file(path)?, &file)?;
    let names = heading(&heading_of(&mut table, layout)?, layout.heading == 3);
    table.name_columns(names.clone());
    let [from, to] = layout.link.map(|name| column(&names, name, &file, "a table of links has it"));
    let ends = [from?, to?];
    while let Some((line, row)) = table.next()? {
        let mut found = [0; 2];
        for (k, at) in ends.into_iter().enumerate() {
            let text = row.get(at).unwrap_or_default().trim_ascii();
            let id = number(text).filter(|id| *id >= 0.0 && id.fract() == 0.0).map(|id| id as u64);
            found[k] = *id.and_then(|id| ids.get(&id)).ok_or_else(|| {
                let (name, text) = (layout.link[k], shown(&String::from_utf8_lossy(text)));
                malformed(&file, line as usize, format!("{name} = {text}: must be the ID of a spot"))
            })?;
        }
        spots.link(found[0], found[1], &file, line)?;
    }
    Ok(())
}
