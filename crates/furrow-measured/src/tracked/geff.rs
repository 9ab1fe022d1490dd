//! GEFF: a graph of spots or cells as Zarr arrays.
//!
//! Read are the nodes' ids, the edges, the property of the time axis, names (`name`, else `label`), and sizes: the radius that the
//! metadata name as `sphere`, or the property `radius`, or `volume`. Values of scaled axes are multiplied by their scale. The rest is
//! left aside.
//!
//! # References
//! <https://live-image-tracking-tools.github.io/geff>.

use std::collections::{HashMap, HashSet};
use std::fs;
use std::path::Path;

use furrow_input::InputError;
use serde_json::Value;

use super::lengths::{LengthUnit, PIXELS, SizeUnit, sphere_in, unit_of_bare, unit_of_spheres};
use super::spots::{Spot, Spots};
use super::zarr::{self, Array, Rows, Values};
use super::{Format, TrackOptions, TrackedLineage, embryo_of, geff_units};
use crate::volumes::Unit;

pub(super) fn read(path: &Path, options: &TrackOptions) -> Result<TrackedLineage, InputError> {
    let file = path.display().to_string();
    let attributes = zarr::attributes(path)?;
    let metadata = &attributes["geff"];
    let refused = |field: &str, value: &Value, allowed: &str| InputError::not_allowed(&file, field, value, allowed);
    if !metadata.is_object() {
        return Err(refused("geff", metadata, "metadata of GEFF in the attributes"));
    }
    if metadata["directed"] != true {
        return Err(refused("geff.directed", &metadata["directed"], "true: edges lead from mothers to daughters"));
    }
    let axes = metadata["axes"].as_array().map_or(&[][..], Vec::as_slice);
    let Some(axis) = axes.iter().find(|axis| axis["type"] == "time") else {
        return Err(refused("geff.axes", &metadata["axes"], "at least one axis of the type \"time\""));
    };
    let ids = ids(path, &file)?;
    let mut known = HashSet::new();
    if let Some(id) = ids.iter().find(|id| !known.insert(**id)) {
        return Err(InputError::not_allowed(&file, "nodes/ids", id, "of one node only"));
    }
    let nodes = Nodes { folder: path.join("nodes"), count: ids.len() };
    let axis_name = axis["name"].as_str().unwrap_or("t");
    let (minutes, time) = geff_units::of_times(axis, &file, options)?;
    let times = nodes.property(axis_name)?.ok_or_else(|| {
        refused(&format!("nodes/props/{axis_name}"), &Value::Null, "the property of the time axis, of every node")
    })?;
    let names = nodes.names()?;
    let sizes = Sizes::read(&nodes, metadata, axes, &file, options)?;
    let (mut spots, mut places) = (Spots::of(&file), HashMap::new());
    for (k, id) in ids.iter().enumerate() {
        let Some(time) = times[k].filter(|time| time.is_finite()) else {
            let (field, value) = (format!("nodes/props/{axis_name} of node {id}"), times[k].unwrap_or(f64::NAN));
            spots.skip(&file, 0, &field, &value.to_string(), "must be a number");
            continue;
        };
        let name = names.get(k).filter(|name| !name.is_empty()).cloned().unwrap_or_else(|| id.to_string());
        let volume = sizes.volume(&mut spots, &file, *id, k);
        places.insert(*id, spots.push(Spot { time: time * minutes, id: Some(*id), name, volume, file: 0, line: 0 }));
    }
    link(&mut spots, (&known, &places), path, &file)?;
    spots.lineage(embryo_of(path), Format::Geff, time, sizes.unit)
}

/// The nodes' ids.
fn ids(path: &Path, file: &str) -> Result<Vec<i128>, InputError> {
    let Array { shape, values } = zarr::read(&path.join("nodes/ids"), Rows::Ids)?;
    let found = format!("{} of shape {shape:?}", values.kind());
    let ids = values.integers().filter(|_| shape.len() == 1);
    ids.ok_or_else(|| InputError::not_allowed(file, "nodes/ids", found, "one whole number per node"))
}

/// Links the nodes of each edge. Of the known nodes only those with a place have a time.
fn link(
    spots: &mut Spots,
    (known, places): (&HashSet<i128>, &HashMap<i128, usize>),
    path: &Path,
    file: &str,
) -> Result<(), InputError> {
    let Array { shape, values } = zarr::read(&path.join("edges/ids"), Rows::Ids)?;
    let found = format!("{} of shape {shape:?}", values.kind());
    let ends = values.integers().filter(|_| matches!(shape[..], [_, 2]));
    let allowed = "whole numbers in two columns, source and target";
    let ends = ends.ok_or_else(|| InputError::not_allowed(file, "edges/ids", found, allowed))?;
    let mut links = Vec::with_capacity(ends.len() / 2);
    for (row, ends) in ends.chunks_exact(2).enumerate() {
        if let Some(id) = ends.iter().find(|id| !known.contains(id)) {
            return Err(InputError::not_allowed(file, format!("edges/ids[{row}]"), id, "a node's id"));
        }
        // Rows are counted as lines are.
        links.push((row as u64 + 1, [ends[0], ends[1]]));
    }
    spots.link_all(links, places, &format!("{file}/edges/ids"))
}

/// The arrays of nodes.
struct Nodes {
    folder: std::path::PathBuf,
    /// How many nodes there are.
    count: usize,
}

impl Nodes {
    /// A property as its folder spells it: programs differ in small and capital letters.
    fn spelled(&self, name: &str) -> String {
        let folder = self.folder.join("props");
        if folder.join(name).is_dir() {
            return name.to_owned();
        }
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        let mut alike: Vec<String> = entries.filter_map(|entry| entry.file_name().into_string().ok()).collect();
        alike.retain(|entry| entry.eq_ignore_ascii_case(name));
        alike.into_iter().min().unwrap_or_else(|| name.to_owned())
    }

    /// The values of a property, and whether each is missing; `None` if nodes do not have it. Errors say that it must be `allowed`.
    fn values<T>(
        &self,
        name: &str,
        of: impl Fn(Values) -> Option<Vec<T>>,
        allowed: &str,
    ) -> Result<Option<Vec<Option<T>>>, InputError> {
        let folder = self.folder.join("props").join(name);
        // A name that leads elsewhere is no property.
        if name.contains(['/', '\\']) || !folder.join("values").is_dir() {
            return Ok(None);
        }
        let values = self.array(name, &folder.join("values"), of, allowed)?;
        if !folder.join("missing").is_dir() {
            return Ok(Some(values.into_iter().map(Some).collect()));
        }
        let missing = self.array(name, &folder.join("missing"), Values::integers, "one truth value per node")?;
        let known = |(value, missing): (T, i128)| (missing == 0).then_some(value);
        Ok(Some(values.into_iter().zip(missing).map(known).collect()))
    }

    /// An array with one value per node.
    fn array<T>(
        &self,
        name: &str,
        folder: &Path,
        of: impl Fn(Values) -> Option<Vec<T>>,
        allowed: &str,
    ) -> Result<Vec<T>, InputError> {
        let Array { shape, values } = zarr::read(folder, Rows::Exactly(self.count))?;
        let found = format!("{} of shape {shape:?}", values.kind());
        let fits = shape == [self.count];
        of(values)
            .filter(|_| fits)
            .ok_or_else(|| InputError::not_allowed(self.folder.display().to_string(), name, found, allowed))
    }

    /// A property that is a number, where it is not missing; `None` if nodes do not have it.
    fn property(&self, name: &str) -> Result<Option<Vec<Option<f64>>>, InputError> {
        self.values(name, Values::numbers, "one number per node")
    }

    /// The names of nodes; empty texts where they are missing.
    fn names(&self) -> Result<Vec<String>, InputError> {
        for (name, may_be_numbers) in [("name", false), ("label", true)] {
            // Labels may be numbers, and then name nothing.
            let texts = |values: Values| match values {
                Values::Texts(texts) => Some(texts),
                _ => may_be_numbers.then(|| vec![String::new(); self.count]),
            };
            if let Some(names) = self.values(&self.spelled(name), texts, "one text per node")? {
                return Ok(names.into_iter().map(Option::unwrap_or_default).collect());
            }
        }
        Ok(Vec::new())
    }
}

/// The sizes of nodes.
struct Sizes {
    property: String,
    values: Option<Vec<Option<f64>>>,
    /// The size of their unit, if they are volumes, not radii.
    volume: Option<f64>,
    unit: SizeUnit,
    /// The unit of radii.
    length: Option<LengthUnit>,
    options: TrackOptions,
}

impl Sizes {
    fn read(
        nodes: &Nodes,
        metadata: &Value,
        axes: &[Value],
        file: &str,
        options: &TrackOptions,
    ) -> Result<Sizes, InputError> {
        let property = nodes.spelled(metadata["sphere"].as_str().unwrap_or("radius"));
        let options = *options;
        let radii = nodes.property(&property)?;
        let unit_of = |property: &str| &metadata["node_props_metadata"][property]["unit"];
        if radii.is_none() {
            let property = nodes.spelled("volume");
            let values = nodes.property(&property)?;
            let (volume, unit) = match unit_of(&property).as_str().filter(|_| values.is_some()) {
                Some(own) => geff_units::of_volumes((&property, own), axes, file, &options)?,
                // As furrow writes them.
                None => unit_of_bare(Unit::Relative, &options),
            };
            return Ok(Sizes { property, values, volume: Some(volume), unit, length: None, options });
        }
        let length = geff_units::of_radii((&property, unit_of(&property)), axes, file, &options)?;
        let unit = length.map_or(Unit::Relative.into(), |length| unit_of_spheres(length, &options));
        Ok(Sizes { property, values: radii, volume: None, unit, length, options })
    }

    /// The volume of a node.
    fn volume(&self, spots: &mut Spots, file: &str, id: i128, k: usize) -> Option<f64> {
        let size = self.values.as_ref()?[k]?;
        if !(size > 0.0 && size < 1e30) {
            let column = format!("{} of node {id}", self.property);
            spots.skip(file, 0, &column, &size.to_string(), "must be above 0");
            return None;
        }
        if let Some(unit) = self.volume {
            return Some(size * unit);
        }
        // Relative sizes are as good as pixels without a size.
        let (length, options) = self.length.map_or((PIXELS, TrackOptions::default()), |length| (length, self.options));
        Some(sphere_in(length, 2.0 * size, &options))
    }
}
