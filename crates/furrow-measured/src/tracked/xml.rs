//! XML of TrackMate, and of MaMuT, which has the same elements.
//!
//! Read are the spots of the tracks that are kept (`FilteredTracks`; without it all), their edges, and the units of the model:
//! `spatialunits` of radii, and `timeunits` of `POSITION_T`. Where times have no unit, or minutes per frame are given, `FRAME` counts.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use furrow_input::table::{TIMES, malformed, unit_of};
use furrow_input::{InputError, read_text_up_to, shown};
use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};

use super::spot_tables::radius_unit;
use super::spots::{Spot, Spots};
use super::{
    Format, TimeUnit, TrackOptions, TrackedLineage, embryo_of, sphere, sphere_of_pixels, unit_of_pixels, whole,
};
use crate::volumes::Unit;

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
    frame: Option<f64>,
    time: Option<f64>,
    radius: Option<f64>,
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

    /// A number; `None` without one.
    fn number(&self, name: &str) -> Option<f64> {
        self.text(name).parse().ok().filter(|number: &f64| number.is_finite())
    }
}

pub(super) fn read(path: &Path, options: &TrackOptions) -> Result<TrackedLineage, InputError> {
    let file = path.display().to_string();
    let document = Document::read(&read_text_up_to(path, LONGEST)?, &file)?;
    let unit = document.unit(&file, options)?;
    let minutes = unit_of(&document.times, &TIMES).map(|unit| unit.size).filter(|_| options.frame_minutes.is_none());
    let time_unit = if minutes.is_some() { TimeUnit::Minutes } else { TimeUnit::Frames };
    let kept = |track: &&Track| document.kept.as_ref().is_none_or(|kept| kept.contains(&track.id));
    let tracks: Vec<&Track> = document.tracks.iter().filter(kept).collect();
    let tracked: HashSet<u64> = tracks.iter().flat_map(|track| &track.edges).flat_map(|(_, ends)| *ends).collect();
    let (mut spots, mut places) = (Spots::of(&file), HashMap::new());
    for written in document.spots.iter().filter(|spot| tracked.contains(&spot.id)) {
        let Written { line, id, name, frame, time, radius } = written;
        let time = minutes.map_or(*frame, |minutes| time.map(|time| time * minutes)).ok_or_else(|| {
            let wanted = if minutes.is_some() { "POSITION_T" } else { "FRAME" };
            malformed(&file, *line as usize, format!("the spot {id} has no number as its {wanted}"))
        })?;
        if radius.is_none() {
            spots.skip(&file, *line, "RADIUS", "", "must be a radius above 0");
        }
        let in_um = unit == Unit::CubicMicrometres && !document.in_pixels();
        let volume = radius.map(|r| if in_um { sphere(2.0 * r) } else { sphere_of_pixels(2.0 * r, options) });
        let spot = spots.push(Spot { time, name: name.clone(), id: Some((*id).into()), volume, file: 0, line: *line });
        if places.insert(*id, spot).is_some() {
            return Err(malformed(&file, *line as usize, format!("ID = {id}: must be of one spot only")));
        }
    }
    document.link(&tracks, &places, &mut spots, &file)?;
    let left = document.spots.len() - places.len();
    if left > 0 {
        spots.skip(
            &file,
            0,
            "Spot",
            &left.to_string(),
            "spots that belong to no track, or to one that was filtered out",
        );
    }
    spots.lineage(embryo_of(path), Format::TrackMateXml, time_unit, unit)
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
                frame: element.number("FRAME"),
                time: element.number("POSITION_T"),
                radius: element.number("RADIUS").filter(|radius| *radius > 0.0 && *radius < 1e30),
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

    fn in_pixels(&self) -> bool {
        matches!(radius_unit(&self.lengths), Some(Unit::Voxels))
    }

    /// The unit of volumes.
    fn unit(&self, file: &str, options: &TrackOptions) -> Result<Unit, InputError> {
        match radius_unit(&self.lengths) {
            Some(Unit::CubicMicrometres) => Ok(Unit::CubicMicrometres),
            Some(_) => Ok(unit_of_pixels(options)),
            None => {
                let allowed = "micron, µm or pixel";
                Err(InputError::not_allowed(file, "spatialunits of Model", shown(&self.lengths), allowed))
            }
        }
    }

    fn link(
        &self,
        tracks: &[&Track],
        places: &HashMap<u64, usize>,
        spots: &mut Spots,
        file: &str,
    ) -> Result<(), InputError> {
        for Track { name, edges, .. } in tracks {
            let mut first: Option<usize> = None;
            for (line, ends) in edges {
                let place = |id: u64| {
                    let refused = || malformed(file, *line as usize, format!("{id}: must be the ID of a spot"));
                    places.get(&id).copied().ok_or_else(refused)
                };
                let [from, to] = [place(ends[0])?, place(ends[1])?];
                spots.link(from, to, file, *line)?;
                for spot in [from, to] {
                    let is_earlier = |first: usize| spots.get(spot).time < spots.get(first).time;
                    first = Some(first.filter(|first| !is_earlier(*first)).unwrap_or(spot));
                }
            }
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
