//! The layouts of tables of volumes, recognised by their first line, and the units of volumes.

use furrow_input::InputError;
use furrow_input::table::{NamedUnit, columns_listed, malformed, only, quantity, unit_of};
use serde::Serialize;

use crate::names::Names;

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

/// A unit of a table, with its size in µm³ or in its own kind.
pub(crate) type VolumeUnit = NamedUnit<Unit>;

/// Units of volumes. A femtolitre is a cubic micrometre.
pub(crate) const VOLUMES: [VolumeUnit; 7] = [
    NamedUnit {
        kind: Unit::CubicMicrometres,
        size: 1.0,
        words: &["um3", "micron3", "microns3", "cubicum", "cubicmicron", "cubicmicrons", "fl"],
    },
    NamedUnit { kind: Unit::CubicMicrometres, size: 1e3, words: &["pl"] },
    NamedUnit { kind: Unit::CubicMicrometres, size: 1e9, words: &["mm3"] },
    NamedUnit { kind: Unit::CubicMicrometres, size: 1e-9, words: &["nm3"] },
    NamedUnit {
        kind: Unit::Voxels,
        size: 1.0,
        words: &["voxels", "voxel", "vox", "voxels3", "voxel3", "px3", "pixels3", "pixel3"],
    },
    NamedUnit { kind: Unit::Relative, size: 1.0, words: &["relative", "1", "fraction"] },
    NamedUnit { kind: Unit::Relative, size: 0.01, words: &["%", "percent"] },
];

impl Unit {
    /// The symbol behind a number.
    pub fn symbol(self) -> &'static str {
        match self {
            Unit::CubicMicrometres => "µm³",
            Unit::Voxels => "voxels",
            Unit::Relative => "relative",
            Unit::OfMother => "of the mother",
        }
    }
}

impl std::str::FromStr for Unit {
    type Err = String;

    fn from_str(text: &str) -> Result<Unit, String> {
        let whole = unit_of(text, &VOLUMES).filter(|unit| unit.size == 1.0);
        whole.map(|unit| unit.kind).ok_or_else(|| "must be um3, voxels or relative".to_owned())
    }
}

/// The columns of a long table.
pub(crate) struct Columns {
    pub(crate) cell: usize,
    pub(crate) volume: (usize, Option<VolumeUnit>),
    pub(crate) embryo: usize,
    pub(crate) group: Option<usize>,
    pub(crate) frame: Option<usize>,
    pub(crate) n: Option<usize>,
    pub(crate) unit: Option<usize>,
}

impl Columns {
    /// The columns of a long table; `None` for a grid.
    pub(crate) fn of(
        header: &[String],
        (file, line): (&str, usize),
        names: &Names,
    ) -> Result<Option<Columns>, InputError> {
        let lower = unified(header, (file, line))?;
        let find = |names: &[&str]| lower.iter().position(|name| names.contains(&name.as_str()));
        // Tables that have both put other names than the cell's in `name`.
        let cell = find(&["cell"]).or_else(|| find(&["cell_name"])).or_else(|| find(&["name"]));
        let volume = volume_column(header).map_err(|why| malformed(file, line, why))?;
        let embryo = find(&["embryo", "embryo_name", "sample"]);
        if let (Some(cell), Some(volume), Some(embryo)) = (cell, volume, embryo) {
            let group = find(&["group", "condition"]);
            let (frame, n, unit) = (find(&["frame", "time", "time_point"]), find(&["n", "n_frames"]), find(&["unit"]));
            return Ok(Some(Columns { cell, volume, embryo, group, frame, n, unit }));
        }
        if names.any_on_top(header) {
            return Ok(None);
        }
        let missing = [("cell", cell), ("volume", volume.map(|(column, _)| column)), ("embryo", embryo)];
        let missing: Vec<&str> = missing.into_iter().filter(|(_, at)| at.is_none()).map(|(name, _)| name).collect();
        let message = format!(
            "no column is called {}; a table of volumes has the columns embryo, cell and volume (also volume_um3, volume_voxels or \
             relative_volume), or one for each cell with its name on top, or of divisions embryo, mother, \
             larger_um3 and smaller_um3, or of χ mother and chi; the columns here are {}",
            missing.join(" or "),
            columns_listed(header)
        );
        Err(malformed(file, line, message))
    }
}

/// The column of volumes, with the unit where its heading gives one.
fn volume_column(header: &[String]) -> Result<Option<(usize, Option<VolumeUnit>)>, String> {
    let mut found = Vec::new();
    for name in ["volume", "mean_volume", "relative_volume", "mean_relative_volume"] {
        for (column, unit) in quantity(header, name, &VOLUMES)? {
            let of_name =
                name.contains("relative").then_some(NamedUnit { kind: Unit::Relative, size: 1.0, words: &[] });
            found.push((column, unit.copied().or(of_name)));
        }
    }
    found.sort_by_key(|(column, _)| *column);
    only(header, "volume", &found)
}

/// Names of columns in lower case and with underscores; no two may be alike.
pub(crate) fn unified(header: &[String], (file, line): (&str, usize)) -> Result<Vec<String>, InputError> {
    furrow_input::table::unified(header).map_err(|why| malformed(file, line, why))
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
    pub(crate) unit: VolumeUnit,
}

impl DivisionColumns {
    /// The columns of a table of divisions; `None` for other tables.
    pub(crate) fn of(header: &[String], (file, line): (&str, usize)) -> Result<Option<Self>, InputError> {
        let lower = unified(header, (file, line))?;
        let find = |name: &str| lower.iter().position(|column| column == name);
        let micrometres = VOLUMES[0];
        // A heading `mother` without a unit is the column of names.
        let volume = |of: &str| {
            let found = quantity(header, of, &VOLUMES).map_err(|why| malformed(file, line, why))?;
            let found: Vec<_> = found.into_iter().filter(|(_, unit)| unit.is_some() || of != "mother").collect();
            let found =
                only(header, &format!("volume of the {of}"), &found).map_err(|why| malformed(file, line, why))?;
            Ok::<_, InputError>(found.map(|(at, unit)| (at, unit.copied().unwrap_or(micrometres))))
        };
        let (larger, smaller) = match (volume("larger")?, volume("smaller")?) {
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
                columns_listed(header)
            );
            return Err(malformed(file, line, message));
        };
        let mother_volume = volume("mother")?;
        if other != unit || mother_volume.is_some_and(|(_, own)| own != unit) {
            return Err(malformed(file, line, "mother, larger and smaller have different units"));
        }
        let mother_volume = mother_volume.map(|(at, _)| at);
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
        // Where a table has both, the signed χ is more informative.
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
