//! XML of TrackMate, and of MaMuT, which has the same elements.
//!
//! Read are the spots of the tracks that are kept (`FilteredTracks`; without it all), their edges, and the units of the model:
//! `spatialunits` of radii, and `timeunits` of `POSITION_T`. Where times have no unit, or minutes per frame are given, `FRAME` counts.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::Path;

use furrow_input::table::{malformed, units_listed};
use furrow_input::{InputError, read_older_text_up_to, shown};
use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};

use super::lengths::{LENGTHS, LengthUnit, known_length_unit, sphere_in, unit_of_spheres};
use super::rows::{contents_of, repeat};
use super::spots::{Spot, Spots};
use super::times::minutes_in;
use super::{Format, TimeUnit, TrackOptions, TrackedLineage, embryo_of, whole};

/// Most bytes that are read.
const LONGEST: u64 = 1 << 30;

/// Whether the text of a file begins with an element of TrackMate or MaMuT.
pub(super) fn is_model(head: &str) -> bool {
    head.trim_start().starts_with('<') && head.contains("<TrackMate")
}

/// A spot as it is written.
struct Written {
    line: u64,
    id: u64,
    name: String,
    frame: String,
    time: String,
    radius: Option<f64>,
    /// All its attributes.
    contents: u64,
}

/// A track: its name, whether it is kept, and the lines and ends of its edges.
struct Track {
    id: String,
    name: String,
    edges: Vec<(u64, [u64; 2])>,
}

/// The contents of a file.
#[derive(Default)]
struct Document {
    lengths: String,
    times: String,
    spots: Vec<Written>,
    tracks: Vec<Track>,
    /// Ids of the tracks that are kept; `None` without a list.
    kept: Option<HashSet<String>>,
}

/// An element with its place.
struct Element<'a> {
    file: &'a str,
    line: u64,
    name: String,
    attributes: HashMap<String, String>,
}

impl Element<'_> {
    fn text(&self, name: &str) -> &str {
        self.attributes.get(name).map_or("", String::as_str)
    }

    fn refused(&self, name: &str, allowed: &str) -> InputError {
        let value = shown(self.text(name));
        malformed(self.file, self.line as usize, format!("{name} of {} = {value}: must be {allowed}", self.name))
    }

    fn id(&self, name: &str) -> Result<u64, InputError> {
        whole(self.text(name).as_bytes()).ok_or_else(|| self.refused(name, "a whole number from 0"))
    }
}

/// A number; `None` without one.
fn finite(text: &str) -> Option<f64> {
    text.parse().ok().filter(|number: &f64| number.is_finite())
}

pub(super) fn read(path: &Path, options: &TrackOptions) -> Result<TrackedLineage, InputError> {
    let file = path.display().to_string();
    let document = Document::read(&read_older_text_up_to(path, LONGEST)?, &file)?;
    let length = document.length(&file, options)?;
    let minutes = minutes_in(&document.times).filter(|_| options.frame_minutes.is_none());
    let time_unit = if minutes.is_some() { TimeUnit::Minutes } else { TimeUnit::Frames };
    let kept = |track: &&Track| document.kept.as_ref().is_none_or(|kept| kept.contains(&track.id));
    let tracks: Vec<&Track> = document.tracks.iter().filter(kept).collect();
    let tracked: HashSet<u64> = tracks.iter().flat_map(|track| &track.edges).flat_map(|(_, ends)| *ends).collect();
    let (mut spots, mut places, mut first) = (Spots::of(&file), HashMap::new(), HashMap::new());
    for written in document.spots.iter().filter(|spot| tracked.contains(&spot.id)) {
        let Written { line, id, name, frame, time, radius, contents } = written;
        let before = first.entry(*id).or_insert(written);
        if before.line != *line {
            if before.contents != *contents {
                return Err(malformed(&file, *line as usize, format!("ID = {id}: must be of one spot only")));
            }
            spots.skip(&file, *line, "ID", &id.to_string(), repeat(before.line));
            continue;
        }
        let (column, written) = if minutes.is_some() { ("POSITION_T", time) } else { ("FRAME", frame) };
        let Some(time) = finite(written).map(|time| time * minutes.unwrap_or(1.0)) else {
            spots.skip(&file, *line, column, written, format!("must be a number: the spot {id} is left out"));
            continue;
        };
        if radius.is_none() {
            spots.skip(&file, *line, "RADIUS", "", "must be a radius above 0");
        }
        let volume = radius.map(|radius| sphere_in(length, 2.0 * radius, options));
        let spot = spots.push(Spot { time, name: name.clone(), id: Some((*id).into()), volume, file: 0, line: *line });
        places.insert(*id, spot);
    }
    document.link(&tracks, |id| first.contains_key(&id), &places, &mut spots, &file)?;
    let mut left = document.spots.iter().filter(|spot| !tracked.contains(&spot.id)).peekable();
    if let Some((id, line)) = left.peek().map(|spot| (spot.id, spot.line)) {
        let count = left.count();
        let why = format!("it belongs to no track, or to one that was filtered out; there are {count} such spots");
        spots.skip(&file, line, "Spot", &id.to_string(), why);
    }
    spots.lineage(embryo_of(path), Format::TrackMateXml, time_unit, unit_of_spheres(length, options))
}

impl Document {
    fn read(text: &str, file: &str) -> Result<Document, InputError> {
        let (mut reader, mut found) = (Reader::from_str(text), Document::default());
        let (mut line, mut counted) = (1_u64, 0_usize);
        loop {
            let at = reader.buffer_position() as usize;
            line += text.as_bytes()[counted..at].iter().filter(|byte| **byte == b'\n').count() as u64;
            counted = at;
            // Blanks before an element are an event of their own, so an element begins on this line.
            match reader.read_event().map_err(|error| malformed(file, line as usize, error.to_string()))? {
                Event::Start(start) | Event::Empty(start) => found.take(&element(&start, file, line)?)?,
                Event::Eof => return Ok(found),
                _ => {}
            }
        }
    }

    fn take(&mut self, element: &Element<'_>) -> Result<(), InputError> {
        match element.name.as_str() {
            "Model" => {
                self.lengths = element.text("spatialunits").to_owned();
                self.times = element.text("timeunits").to_owned();
            }
            "Spot" => self.spots.push(Written {
                line: element.line,
                id: element.id("ID")?,
                name: element.text("name").to_owned(),
                frame: element.text("FRAME").to_owned(),
                time: element.text("POSITION_T").to_owned(),
                radius: finite(element.text("RADIUS")).filter(|radius| *radius > 0.0 && *radius < 1e30),
                contents: contents_of(element.attributes.iter().collect::<BTreeMap<_, _>>()),
            }),
            "Track" => {
                let (id, name) = (element.text("TRACK_ID").to_owned(), element.text("name").to_owned());
                self.tracks.push(Track { id, name, edges: Vec::new() });
            }
            "Edge" => {
                let ends = [element.id("SPOT_SOURCE_ID")?, element.id("SPOT_TARGET_ID")?];
                let track = self.tracks.last_mut();
                let outside = || malformed(element.file, element.line as usize, "an edge outside a track");
                track.ok_or_else(outside)?.edges.push((element.line, ends));
            }
            "FilteredTracks" => self.kept = Some(HashSet::new()),
            "TrackID" => {
                let id = element.text("TRACK_ID").to_owned();
                self.kept.get_or_insert_default().insert(id);
            }
            _ => {}
        }
        Ok(())
    }

    /// The unit of radii.
    fn length(&self, file: &str, options: &TrackOptions) -> Result<LengthUnit, InputError> {
        known_length_unit(&self.lengths, options, || {
            let allowed = format!("one of {}", units_listed(&LENGTHS));
            InputError::not_allowed(file, "spatialunits of Model", shown(&self.lengths), allowed)
        })
    }

    /// Links the spots of the edges. Of the known spots only those with a place have a time.
    fn link(
        &self,
        tracks: &[&Track],
        is_known: impl Fn(u64) -> bool,
        places: &HashMap<u64, usize>,
        spots: &mut Spots,
        file: &str,
    ) -> Result<(), InputError> {
        for Track { name, edges, .. } in tracks {
            let unknown = |(line, ends): &(u64, [u64; 2])| Some((*line, *ends.iter().find(|id| !is_known(**id))?));
            if let Some((line, id)) = edges.iter().find_map(unknown) {
                return Err(malformed(file, line as usize, format!("{id}: must be the ID of a spot")));
            }
            spots.link_all(edges.clone(), places, file)?;
            let ends = edges.iter().flat_map(|(_, ends)| ends).filter_map(|id| places.get(id).copied());
            let first = ends.min_by(|a, b| spots.get(*a).time.total_cmp(&spots.get(*b).time));
            spots.tracks.extend(first.filter(|_| !name.is_empty()).map(|first| (name.clone(), first)));
        }
        Ok(())
    }
}

/// The element with its attributes.
fn element<'a>(start: &BytesStart<'_>, file: &'a str, line: u64) -> Result<Element<'a>, InputError> {
    let refused = |error: &dyn std::fmt::Display| malformed(file, line as usize, error.to_string());
    let name = start.name().as_ref().to_owned();
    let wanted = ["Model", "Spot", "Track", "Edge", "FilteredTracks", "TrackID"].contains(&name.as_str());
    let mut attributes = HashMap::new();
    for attribute in start.attributes().filter(|_| wanted) {
        let attribute = attribute.map_err(|error| refused(&error))?;
        let key = attribute.key.as_ref().to_owned();
        let value = attribute.normalized_value(XmlVersion::Implicit1_0).map_err(|error| refused(&error))?;
        attributes.insert(key, value.into_owned());
    }
    Ok(Element { file, line, name, attributes })
}
