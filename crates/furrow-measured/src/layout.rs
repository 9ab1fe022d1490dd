//! The layouts of tables of volumes, recognised by their first line, and the units of volumes.

use std::collections::HashSet;

use furrow_input::InputError;
use serde::Serialize;

use crate::names::understood;
use crate::table::{listed, malformed};

/// Unit of volumes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Unit {
    /// µm³.
    CubicMicrometres,
    /// Voxels of unknown size.
    Voxels,
    /// Fractions, such as of P0's volume.
    Relative,
    /// Fractions of each division's own mother: a table of χ.
    OfMother,
}

/// For each unit its symbol, the columns of volumes named after it, and what a column of units calls it.
const UNITS: [(Unit, &str, &[&str], &[&str]); 4] = [
    (Unit::CubicMicrometres, "µm³", &["volume_um3", "volume_µm3", "volume_µm³"], &["um3", "um^3", "µm3", "µm³", "um³"]),
    (Unit::Voxels, "voxels", &["volume_voxels", "volume_voxel"], &["voxel", "voxels"]),
    (Unit::Relative, "relative", &["relative_volume", "volume_relative", "volume_fraction"], &["relative", "1"]),
    (Unit::OfMother, "of the mother", &[], &[]),
];

impl Unit {
    /// The symbol behind a number.
    pub fn symbol(self) -> &'static str {
        UNITS[self as usize].1
    }

    /// The unit in the name of a column of volumes.
    pub(crate) fn of_column(name: &str) -> Option<Unit> {
        let lower = name.to_lowercase();
        let name = lower.strip_prefix("mean_").unwrap_or(&lower);
        UNITS.iter().find(|(_, _, columns, _)| columns.contains(&name)).map(|(unit, ..)| *unit)
    }

    /// The unit that a column of units names.
    pub(crate) fn written(text: &str) -> Option<Unit> {
        UNITS.iter().find(|(_, _, _, words)| words.contains(&text.to_lowercase().as_str())).map(|(unit, ..)| *unit)
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
    /// The columns of a long table; `None` for a grid.
    pub(crate) fn of(header: &[String], (file, line): (&str, usize)) -> Result<Option<Columns>, InputError> {
        let lower = unified(header, (file, line))?;
        let find = |names: &[&str]| lower.iter().position(|name| names.contains(&name.as_str()));
        let is_volume =
            |name: &String| ["volume", "mean_volume"].contains(&name.as_str()) || Unit::of_column(name).is_some();
        let cell = find(&["cell", "cell_name", "name"]);
        let volume = lower.iter().position(is_volume);
        let embryo = find(&["embryo", "embryo_name", "sample"]);
        if let (Some(cell), Some(volume), Some(embryo)) = (cell, volume, embryo) {
            let group = find(&["group", "condition"]);
            let (frame, n, unit) = (find(&["frame", "time", "time_point"]), find(&["n", "n_frames"]), find(&["unit"]));
            return Ok(Some(Columns { cell, volume, embryo, group, frame, n, unit }));
        }
        if header.iter().skip(1).any(|name| understood(name).is_some()) {
            return Ok(None);
        }
        let missing = [("cell", cell), ("volume", volume), ("embryo", embryo)];
        let missing: Vec<&str> = missing.into_iter().filter(|(_, at)| at.is_none()).map(|(name, _)| name).collect();
        let message = format!(
            "no column is called {}; a table of volumes has the columns embryo, cell and volume (also volume_um3, volume_voxels or \
             relative_volume), or one for each cell with its name on top, or of divisions embryo, mother, \
             larger_um3 and smaller_um3, or of χ mother and chi; the columns here are {}",
            missing.join(" or "),
            listed(header)
        );
        Err(malformed(file, line, message))
    }
}

/// Names of columns in lower case and with underscores; no two may be alike.
pub(crate) fn unified(header: &[String], (file, line): (&str, usize)) -> Result<Vec<String>, InputError> {
    let lower: Vec<String> = header.iter().map(|name| name.to_lowercase().replace([' ', '-'], "_")).collect();
    let mut seen = HashSet::new();
    for (column, name) in lower.iter().enumerate() {
        if !name.is_empty() && !seen.insert(name) {
            return Err(malformed(file, line, format!("two columns are called {:?}", header[column])));
        }
    }
    Ok(lower)
}

/// The columns of a table of divisions.
pub(crate) struct DivisionColumns {
    pub(crate) embryo: usize,
    pub(crate) mother: usize,
    /// Volumes of the larger and of the smaller daughter.
    pub(crate) daughters: [usize; 2],
    pub(crate) mother_volume: Option<usize>,
    pub(crate) population: Option<usize>,
    pub(crate) generation: Option<usize>,
    pub(crate) unit: Unit,
}

impl DivisionColumns {
    /// The columns of a table of divisions; `None` for other tables.
    pub(crate) fn of(header: &[String], (file, line): (&str, usize)) -> Result<Option<Self>, InputError> {
        let endings = [("_um3", Unit::CubicMicrometres), ("_voxels", Unit::Voxels), ("", Unit::CubicMicrometres)];
        let lower = unified(header, (file, line))?;
        let find = |name: &str| lower.iter().position(|column| column == name);
        let volume = |of: &str| endings.iter().find_map(|(end, unit)| Some((find(&format!("{of}{end}"))?, *unit)));
        let (larger, smaller) = match (volume("larger"), volume("smaller")) {
            (None, None) => return Ok(None),
            found => found,
        };
        let (embryo, mother) = (find("embryo"), find("mother"));
        let (Some(embryo), Some(mother), Some((larger, unit)), Some((smaller, other))) =
            (embryo, mother, larger, smaller)
        else {
            let needed = [("embryo", embryo), ("mother", mother)];
            let daughters = [("larger_um3", larger), ("smaller_um3", smaller)];
            let needed = needed.into_iter().chain(daughters.map(|(name, found)| (name, found.map(|(at, _)| at))));
            let missing: Vec<&str> = needed.filter(|(_, at)| at.is_none()).map(|(name, _)| name).collect();
            let message = format!(
                "no column is called {}; a table of divisions has the columns embryo, mother, larger_um3 and smaller_um3 \
                 (or larger_voxels, smaller_voxels); the columns here are {}",
                missing.join(" or "),
                listed(header)
            );
            return Err(malformed(file, line, message));
        };
        if other != unit {
            return Err(malformed(file, line, "larger and smaller have different units"));
        }
        let mother_volume = find(if unit == Unit::Voxels { "mother_voxels" } else { "mother_um3" });
        let (population, generation) = (find("population").or_else(|| find("group")), find("generation"));
        let daughters = [larger, smaller];
        Ok(Some(DivisionColumns { embryo, mother, daughters, mother_volume, population, generation, unit }))
    }
}

/// The columns of a table of χ.
pub(crate) struct ChiColumns {
    pub(crate) mother: usize,
    pub(crate) chi: usize,
    pub(crate) embryo: Option<usize>,
    pub(crate) group: Option<usize>,
}

impl ChiColumns {
    /// The columns of a table of χ; `None` for other tables.
    pub(crate) fn of(header: &[String], place: (&str, usize)) -> Result<Option<Self>, InputError> {
        let lower = unified(header, place)?;
        let find = |names: &[&str]| lower.iter().position(|column| names.contains(&column.as_str()));
        // The signed χ says more where a table has both.
        let (mother, chi) = (find(&["mother"]), find(&["chi_signed"]).or_else(|| find(&["chi"])));
        let (embryo, group) = (find(&["embryo", "sample"]), find(&["group", "condition"]));
        Ok(mother.zip(chi).map(|(mother, chi)| ChiColumns { mother, chi, embryo, group }))
    }
}

/// The embryo of a grid: the file's name without its extension and `_volume`.
pub(crate) fn embryo_of_file(file: &str) -> String {
    let name = std::path::Path::new(file).file_stem().map_or(file.into(), |stem| stem.to_string_lossy());
    let lower = name.to_lowercase();
    let end =
        if lower.len() == name.len() { lower.strip_suffix("_volume").map_or(name.len(), str::len) } else { name.len() };
    name[..end].to_owned()
}
