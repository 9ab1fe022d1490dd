//! The two layouts of tables of volumes, told by their first line.

use std::collections::HashSet;

use furrow_input::InputError;
use serde::Serialize;

use crate::names::is_cell;
use crate::table::malformed;

/// What volumes are measured in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Unit {
    /// µm³.
    CubicMicrometres,
    /// Voxels of a size that is not known.
    Voxels,
    /// Parts of P0's volume, or of anything else.
    Relative,
}

impl Unit {
    /// How it is written behind a number.
    pub fn symbol(self) -> &'static str {
        match self {
            Unit::CubicMicrometres => "µm³",
            Unit::Voxels => "voxels",
            Unit::Relative => "relative",
        }
    }

    /// The unit that a column of volumes has in its name.
    pub(crate) fn of_column(name: &str) -> Option<Unit> {
        let lower = name.to_lowercase();
        match lower.strip_prefix("mean_").unwrap_or(&lower) {
            "volume_um3" | "volume_µm3" | "volume_µm³" => Some(Unit::CubicMicrometres),
            "volume_voxels" | "volume_voxel" => Some(Unit::Voxels),
            "relative_volume" | "volume_relative" | "volume_fraction" => Some(Unit::Relative),
            _ => None,
        }
    }

    /// The unit that a column of units names.
    pub(crate) fn written(text: &str) -> Option<Unit> {
        match text.to_lowercase().as_str() {
            "um3" | "um^3" | "µm3" | "µm³" | "um³" => Some(Unit::CubicMicrometres),
            "voxel" | "voxels" => Some(Unit::Voxels),
            "relative" | "1" => Some(Unit::Relative),
            _ => None,
        }
    }
}

/// The columns of a long table.
pub(crate) struct Columns {
    pub(crate) cell: usize,
    pub(crate) volume: usize,
    pub(crate) embryo: usize,
    pub(crate) group: Option<usize>,
    pub(crate) frame: Option<usize>,
    pub(crate) n: Option<usize>,
    pub(crate) unit: Option<usize>,
}

impl Columns {
    /// The columns of a long table; none if it is a grid.
    pub(crate) fn of(header: &[String], file: &str) -> Result<Option<Columns>, InputError> {
        let lower: Vec<String> = header.iter().map(|name| name.to_lowercase().replace([' ', '-'], "_")).collect();
        let find = |names: &[&str]| lower.iter().position(|name| names.contains(&name.as_str()));
        let is_volume = |name: &String| {
            let name = name.strip_prefix("mean_").unwrap_or(name);
            name == "volume" || Unit::of_column(name).is_some()
        };
        let mut seen = HashSet::new();
        for (column, name) in lower.iter().enumerate() {
            if !name.is_empty() && !seen.insert(name) {
                let message = format!("two columns are called {:?}", header[column]);
                return Err(malformed(file, 1, &message));
            }
        }
        let cell = find(&["cell", "cell_name", "name"]);
        let volume = lower.iter().position(is_volume);
        let embryo = find(&["embryo", "embryo_name", "sample"]);
        if let (Some(cell), Some(volume), Some(embryo)) = (cell, volume, embryo) {
            let group = find(&["group", "condition"]);
            let (frame, n, unit) = (find(&["frame", "time", "time_point"]), find(&["n", "n_frames"]), find(&["unit"]));
            return Ok(Some(Columns { cell, volume, embryo, group, frame, n, unit }));
        }
        if header.iter().skip(1).any(|name| is_cell(name)) {
            return Ok(None);
        }
        let missing = [("cell", cell), ("volume", volume), ("embryo", embryo)];
        let missing: Vec<&str> = missing.into_iter().filter(|(_, at)| at.is_none()).map(|(name, _)| name).collect();
        let message = format!(
            "no column is called {}; a table of volumes has the columns embryo, cell and volume (also volume_um3, volume_voxels or \
             relative_volume), or one for each cell with its name on top; the columns here are {}",
            missing.join(" or "),
            listed(header)
        );
        Err(malformed(file, 1, &message))
    }
}

/// The first few names.
pub(crate) fn listed(header: &[String]) -> String {
    let shown: Vec<String> = header.iter().take(8).map(|name| format!("{name:?}")).collect();
    let more = header.len().saturating_sub(shown.len());
    shown.join(", ") + &if more > 0 { format!(" and {more} more") } else { String::new() }
}

/// The embryo that a grid is of: the file's name without what says that it is a table of volumes.
pub(crate) fn embryo_of_file(file: &str) -> String {
    let name = std::path::Path::new(file).file_stem().map_or(file.into(), |stem| stem.to_string_lossy());
    let lower = name.to_lowercase();
    let end =
        if lower.len() == name.len() { lower.strip_suffix("_volume").map_or(name.len(), str::len) } else { name.len() };
    name[..end].to_owned()
}
