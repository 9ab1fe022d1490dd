//! GEFF: a graph of spots or cells as Zarr arrays.
//!
//! Read are the nodes' ids, the edges, the property of the time axis, names (`name`, else `label`), and sizes: the radius that the
//! metadata name as `sphere`, or the property `radius`, or `volume` without a unit. The rest is left aside.
//!
//! # References
//! <https://live-image-tracking-tools.github.io/geff>.

use std::collections::HashMap;
use std::path::Path;

use furrow_input::{InputError, shown_number};
use serde_json::Value;

use super::spots::{Spot, Spots};
use super::zarr::{self, Array, Values};
use super::{Format, TimeUnit, TrackOptions, TrackedLineage, embryo_of, sphere, sphere_of_pixels, unit_of_pixels};
use crate::volumes::Unit;

/// Units of time in minutes.
const MINUTES: [(&str, f64); 5] =
    [("minute", 1.0), ("second", 1.0 / 60.0), ("millisecond", 1.0 / 60_000.0), ("hour", 60.0), ("day", 1440.0)];

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
    let nodes = Nodes { folder: path.join("nodes"), count: None };
    let ids = nodes.numbers("ids", &zarr::read(&path.join("nodes/ids"))?)?;
    let nodes = Nodes { count: Some(ids.len()), ..nodes };
    let axis_name = axis["name"].as_str().unwrap_or("t");
    let (minutes, time) = match axis["unit"].as_str() {
        Some(unit) => match MINUTES.iter().find(|(name, _)| *name == unit) {
            Some((_, minutes)) => (*minutes, TimeUnit::Minutes),
            None if unit == "frame" || unit == "frames" => (1.0, TimeUnit::Frames),
            None => {
                return Err(refused(
                    "geff.axes.unit",
                    &axis["unit"],
                    "minute, second, millisecond, hour, day or frame",
                ));
            }
        },
        None => (1.0, TimeUnit::Frames),
    };
    let times = nodes.property(axis_name)?.ok_or_else(|| {
        refused(&format!("nodes/props/{axis_name}"), &Value::Null, "the property of the time axis, of every node")
    })?;
    let names = nodes.names()?;
    let sizes = Sizes::read(&nodes, metadata, axes, &file, options)?;
    let mut spots = Spots::of(&file);
    let mut places = HashMap::new();
    for (k, id) in ids.iter().enumerate() {
        let time = times[k].filter(|time| time.is_finite()).ok_or_else(|| {
            let field = format!("nodes/props/{axis_name} of node {}", shown_number(*id));
            InputError::not_allowed(&file, field, times[k].unwrap_or(f64::NAN), "a number")
        })?;
        let name = names.get(k).filter(|name| !name.is_empty()).cloned().unwrap_or_else(|| shown_number(*id));
        let volume = sizes.volume(&mut spots, &file, *id, k);
        let spot = spots.push(Spot { time: time * minutes, name, volume, file: 0, line: 0 });
        if places.insert(id.to_bits(), spot).is_some() {
            return Err(InputError::not_allowed(&file, "nodes/ids", shown_number(*id), "of one node only"));
        }
    }
    link(&mut spots, &places, path, &file)?;
    spots.lineage(embryo_of(path), Format::Geff, time, sizes.unit)
}

/// Links the nodes of each edge.
fn link(spots: &mut Spots, places: &HashMap<u64, usize>, path: &Path, file: &str) -> Result<(), InputError> {
    let edges = zarr::read(&path.join("edges/ids"))?;
    let (&[count, 2], Values::Numbers(ends)) = (&edges.shape[..], &edges.values) else {
        let shape = format!("{:?}", edges.shape);
        return Err(InputError::not_allowed(file, "edges/ids", shape, "numbers in two columns, source and target"));
    };
    for row in 0..count {
        let place = |column: usize| {
            let id = ends[2 * row + column];
            let refused =
                || InputError::not_allowed(file, format!("edges/ids[{row}]"), shown_number(id), "a node's id");
            places.get(&id.to_bits()).copied().ok_or_else(refused)
        };
        // Rows are counted as lines are.
        spots.link(place(0)?, place(1)?, &format!("{file}/edges/ids"), row as u64 + 1)?;
    }
    Ok(())
}

/// The arrays of nodes.
struct Nodes {
    folder: std::path::PathBuf,
    /// How many nodes there are.
    count: Option<usize>,
}

impl Nodes {
    /// The numbers of an array with one value per node.
    fn numbers(&self, name: &str, array: &Array) -> Result<Vec<f64>, InputError> {
        match &array.values {
            Values::Numbers(numbers) if self.fits(array) => Ok(numbers.clone()),
            _ => Err(self.refused(name, array, "one number per node")),
        }
    }

    fn fits(&self, array: &Array) -> bool {
        array.shape.len() == 1 && self.count.is_none_or(|count| count == array.shape[0])
    }

    fn refused(&self, name: &str, array: &Array, allowed: &str) -> InputError {
        let kind = if matches!(array.values, Values::Texts(_)) { "texts" } else { "numbers" };
        let value = format!("{kind} of shape {:?}", array.shape);
        InputError::not_allowed(self.folder.display().to_string(), name, value, allowed)
    }

    /// A property that is a number, where it is not missing; `None` if nodes do not have it.
    fn property(&self, name: &str) -> Result<Option<Vec<Option<f64>>>, InputError> {
        let folder = self.folder.join("props").join(name);
        // A name that leads elsewhere is no property.
        if name.contains(['/', '\\']) || !folder.join("values").is_dir() {
            return Ok(None);
        }
        let values = self.numbers(name, &zarr::read(&folder.join("values"))?)?;
        let mut missing = vec![0.0; values.len()];
        if folder.join("missing").is_dir() {
            missing = self.numbers(name, &zarr::read(&folder.join("missing"))?)?;
        }
        Ok(Some(values.into_iter().zip(missing).map(|(value, missing)| (missing == 0.0).then_some(value)).collect()))
    }

    /// The nodes' names; empty if they have none.
    fn names(&self) -> Result<Vec<String>, InputError> {
        for name in ["name", "label"] {
            let folder = self.folder.join("props").join(name).join("values");
            if !folder.is_dir() {
                continue;
            }
            let array = zarr::read(&folder)?;
            match &array.values {
                Values::Texts(names) if self.fits(&array) => return Ok(names.clone()),
                // Labels may be numbers.
                Values::Numbers(_) if name == "label" => {}
                _ => return Err(self.refused(name, &array, "one text per node")),
            }
        }
        Ok(Vec::new())
    }
}

/// The sizes of nodes.
struct Sizes {
    property: String,
    values: Option<Vec<Option<f64>>>,
    /// Whether they are volumes, not radii.
    are_volumes: bool,
    unit: Unit,
    options: Option<TrackOptions>,
}

impl Sizes {
    fn read(
        nodes: &Nodes,
        metadata: &Value,
        axes: &[Value],
        file: &str,
        options: &TrackOptions,
    ) -> Result<Sizes, InputError> {
        let property = metadata["sphere"].as_str().unwrap_or("radius").to_owned();
        let radii = nodes.property(&property)?;
        if radii.is_none() {
            // As furrow writes them.
            let property = "volume".to_owned();
            let values = nodes.property(&property)?;
            return Ok(Sizes { property, values, are_volumes: true, unit: Unit::Relative, options: None });
        }
        let own = &metadata["node_props_metadata"][&property]["unit"];
        let space = axes.iter().find(|axis| axis["type"] == "space").map_or(&Value::Null, |axis| &axis["unit"]);
        let said = if own.is_null() { space } else { own };
        let (unit, options) = match said.as_str() {
            Some("micrometer") => (Unit::CubicMicrometres, None),
            Some("pixel") => (unit_of_pixels(options), Some(*options)),
            None => (Unit::Relative, None),
            Some(other) => {
                let field = format!("unit of {property}");
                return Err(InputError::not_allowed(file, field, other, "micrometer, pixel, or none (relative sizes)"));
            }
        };
        Ok(Sizes { property, values: radii, are_volumes: false, unit, options })
    }

    /// The volume of a node.
    fn volume(&self, spots: &mut Spots, file: &str, id: f64, k: usize) -> Option<f64> {
        let size = self.values.as_ref()?[k]?;
        if !(size > 0.0 && size < 1e30) {
            let column = format!("{} of node {}", self.property, shown_number(id));
            spots.skip(file, 0, &column, &size.to_string(), "must be above 0");
            return None;
        }
        if self.are_volumes {
            return Some(size);
        }
        Some(self.options.map_or_else(|| sphere(2.0 * size), |options| sphere_of_pixels(2.0 * size, &options)))
    }
}
