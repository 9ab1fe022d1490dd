//! The layouts of tables of volumes, recognised by their first line, and the units of volumes.

use std::cell::{Cell, RefCell};
use std::collections::HashMap;

use furrow_input::InputError;
use furrow_input::table::{Header, NamedUnit, Row, TIMES, text, unit_of, units_listed};
use serde::Serialize;

use crate::names::Names;
use crate::volumes::{Rejected, Value};

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
pub(crate) const VOLUMES: [VolumeUnit; 8] = [
    NamedUnit {
        kind: Unit::CubicMicrometres,
        size: 1.0,
        words: &["um3", "micron3", "microns3", "cubicum", "cubicmicron", "cubicmicrons", "fl"],
    },
    NamedUnit { kind: Unit::CubicMicrometres, size: 1e3, words: &["pl", "103um3", "1e3um3", "1000um3"] },
    NamedUnit { kind: Unit::CubicMicrometres, size: 1e6, words: &["nl"] },
    NamedUnit { kind: Unit::CubicMicrometres, size: 1e9, words: &["mm3"] },
    NamedUnit { kind: Unit::CubicMicrometres, size: 1e-9, words: &["nm3"] },
    NamedUnit {
        kind: Unit::Voxels,
        size: 1.0,
        words: &[
            "voxels", "voxel", "vox", "vx", "voxels3", "voxel3", "px", "pixels", "pixel", "px3", "pixels3", "pixel3",
        ],
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
    pub(crate) group: GroupColumn,
    pub(crate) common: Common,
    pub(crate) frame: Option<usize>,
    pub(crate) n: Option<usize>,
    pub(crate) unit: Option<usize>,
}

impl Columns {
    /// The columns of a long table; `None` for a grid.
    pub(crate) fn of(header: &Header<'_>, embryo: &str, names: &Names) -> Result<Option<Columns>, InputError> {
        let (cell, volume, of_file) = (cell_column(header), volume_column(header)?, embryo);
        let embryo = embryo_column(header);
        if let (Some(cell), Some(volume), Some(embryo)) = (cell, volume, embryo) {
            let (group, frame) = (GroupColumn::of(header), frame_column(header)?);
            let (n, unit) = (header.find(&["n", "n_frames"]), header.find(&UNIT));
            let common = Common::of(header, Some(embryo), &group);
            return Ok(Some(Columns { cell, volume, embryo, group, common, frame, n, unit }));
        }
        if names.any_on_top(of_file, &header.names) {
            return Ok(None);
        }
        let needed = [("cell", cell), ("volume", volume.map(|(column, _)| column)), ("embryo", embryo)];
        Err(header.missing(
            &needed,
            "a table of volumes has the columns embryo, cell and volume (also volume_um3, volume_voxels or \
             relative_volume), or one for each cell with its name on top, or of divisions embryo, mother, \
             larger_um3 and smaller_um3, or of χ mother and chi",
        ))
    }
}

/// Names of the column of embryos; one that comes first here counts where a table has several.
const EMBRYO: [&[&str]; 4] = [
    &["embryo", "embryos", "emb", "embryo_name", "embryo_id", "embryo_no", "embryo_nr", "embryo_number"],
    &["sample", "sample_name", "sample_id"],
    &["animal", "animal_id", "individual", "specimen"],
    &["egg", "worm", "replicate"],
];

/// Names of other columns by which rows may be of different embryos or groups.
const OTHERS: [&str; 9] = ["date", "movie", "recording", "experiment", "session", "batch", "slide", "dish", "litter"];

/// Further columns in which all rows of an embryo must have the same value.
#[derive(Default)]
pub(crate) struct Common {
    columns: Vec<usize>,
    /// The values of each embryo's first row, by its name and group.
    first: RefCell<HashMap<(String, String), Vec<String>>>,
}

impl Common {
    /// Columns that could distinguish embryos or groups, beside those that do.
    pub(crate) fn of(header: &Header<'_>, embryo: Option<usize>, group: &GroupColumn) -> Common {
        let names = EMBRYO.concat().into_iter().chain(GROUP).chain(OTHERS);
        let columns = names.filter_map(|name| header.find(&[name]));
        let columns = columns.filter(|column| Some(*column) != embryo && Some(*column) != group.column).collect();
        Common { columns, ..Common::default() }
    }

    /// Requires that a row has the values of its embryo's first row.
    ///
    /// # Errors
    /// The first value that differs: the row is of another embryo.
    pub(crate) fn require<'r>(&self, row: Row<'r>, embryo: &str, group: &str) -> Result<(), Rejected<'r>> {
        if self.columns.is_empty() {
            return Ok(());
        }
        let values = || self.columns.iter().map(|column| Value::new(row, *column));
        let mut known = self.first.borrow_mut();
        let first = known.entry((embryo.to_owned(), group.to_owned()));
        let first = first.or_insert_with(|| values().map(Value::written).collect());
        match values().zip(first).find(|(value, first)| value.written() != **first) {
            None => Ok(()),
            Some((value, first)) => Err((
                value,
                format!(
                    "another embryo than the one called so before, which has {first:?} here: each needs a name of its own"
                ),
            )),
        }
    }
}

/// The column of embryos.
pub(crate) fn embryo_column(header: &Header<'_>) -> Option<usize> {
    EMBRYO.concat().into_iter().find_map(|name| header.find(&[name]))
}

/// The column of populations: groups of cells of the same embryos.
pub(crate) const POPULATION: &str = "population";

/// Names of the column of frames or times.
pub(crate) const FRAME: [&str; 10] =
    ["frame", "time", "time_point", "timepoint", "t", "frame_number", "frame_no", "frame_nr", "time_step", "slice"];

/// The column of frames or times, also with a unit behind its name, as `time_min`.
fn frame_column(header: &Header<'_>) -> Result<Option<usize>, InputError> {
    if let Some(frame) = header.find_with_unit(&FRAME) {
        return Ok(Some(frame));
    }
    let times = [header.quantity("time", &TIMES)?, header.quantity("t", &TIMES)?].concat();
    Ok(times.first().map(|(column, _)| *column))
}

/// Names of the column of groups; one that comes first here counts where a table has several.
pub(crate) const GROUP: [&str; 8] =
    ["group", "condition", "strain", "genotype", "treatment", "rnai", "perturbation", "allele"];

/// The column of groups, if there is one.
#[derive(Default)]
pub(crate) struct GroupColumn {
    pub(crate) column: Option<usize>,
    /// Whether a row had a group.
    is_named: Cell<bool>,
}

impl GroupColumn {
    pub(crate) fn of(header: &Header<'_>) -> GroupColumn {
        GroupColumn { column: GROUP.iter().find_map(|name| header.find(&[name])), ..GroupColumn::default() }
    }

    fn at(column: usize) -> GroupColumn {
        GroupColumn { column: Some(column), ..GroupColumn::default() }
    }

    /// The group of a row; `given` for a row without one.
    ///
    /// # Errors
    /// The field is empty, an earlier row has a group, and no group is given. Spreadsheets fill only the first of merged fields.
    pub(crate) fn group_of<'r>(&self, row: Row<'r>, given: Option<&String>) -> Result<String, Rejected<'r>> {
        match (self.column.map(|column| Value::new(row, column)), given) {
            (Some(value), _) if is_mean(value.text) => Err((value, SUMMARY.to_owned())),
            (Some(value), _) if !is_absent(value.text) => {
                self.is_named.set(true);
                Ok(value.written())
            }
            (Some(value), None) if self.is_named.get() => Err((value, "no group".to_owned())),
            (_, given) => Ok(given.cloned().unwrap_or_default()),
        }
    }
}

/// Names of the column with the unit of each row's volumes.
const UNIT: [&str; 5] = ["unit", "units", "volume_unit", "volume_units", "unit_of_volume"];

/// The column of cells. Tables that have several of these put other names than the cell's in `name`.
pub(crate) fn cell_column(header: &Header<'_>) -> Option<usize> {
    ["cell", "cell_name", "name"].into_iter().find_map(|name| header.find(&[name]))
}

/// The column of volumes, with the unit where its heading gives one.
pub(crate) fn volume_column(header: &Header<'_>) -> Result<Option<(usize, Option<VolumeUnit>)>, InputError> {
    let mut found = Vec::new();
    for name in ["volume", "vol", "cell_volume", "mean_volume", "relative_volume", "mean_relative_volume"] {
        for (column, unit) in header.quantity(name, &VOLUMES)? {
            let of_name =
                name.contains("relative").then_some(NamedUnit { kind: Unit::Relative, size: 1.0, words: &[] });
            found.push((column, unit.copied().or(of_name)));
        }
    }
    found.sort_by_cached_key(|(column, _)| *column);
    header.only("volume", &found)
}

/// Columns of a grid beside its cells.
pub(crate) struct GridColumns {
    /// Embryos, if each row is of one.
    pub(crate) embryo: Option<usize>,
    pub(crate) group: GroupColumn,
    pub(crate) common: Common,
    pub(crate) frame: Option<usize>,
    /// The names of rows: of one of these columns, or of a first one that is no cell.
    pub(crate) label: Option<usize>,
    /// The line below the heading, which may have units.
    pub(crate) first_line: u64,
}

impl GridColumns {
    pub(crate) fn of(header: &Header<'_>, is_cell: impl Fn(&str) -> bool) -> Result<GridColumns, InputError> {
        let group = GroupColumn::of(header);
        let frame = frame_column(header)?;
        // Where rows are not called otherwise, each row of a strain is an embryo.
        let embryo = embryo_column(header).or(group.column.filter(|_| frame.is_none()));
        let is_first = header.names.first().is_some_and(|name| !is_cell(name));
        let label = embryo.or(frame).or(is_first.then_some(0));
        let common = Common::of(header, embryo, &group);
        Ok(GridColumns { embryo, group, common, frame, label, first_line: header.line as u64 + 1 })
    }
}

/// What summaries of other rows are called, without blanks and signs: means, deviations and errors, numbers, ends, and the rest.
/// Letters with accents are left out.
const SUMMARIES: [&[&str]; 9] = [
    &["means", "meansd", "meansem", "mode", "promedio", "media", "overall", "pooled", "all"],
    &[
        "averages",
        "totals",
        "summary",
        "gesamt",
        "durchschnitt",
        "mw",
        "mittel",
        "medio",
        "moy",
        "summa",
        "totale",
        "totaal",
    ],
    &["sd", "std", "stdev", "stddev", "standarddeviation", "stddeviation", "stabw", "stdabw", "standardabweichung"],
    &["carttype", "ecarttype", "desvest", "desviacinestndar", "deviazionestandard"],
    &["se", "sem", "stderr", "stderror", "standarderror", "stderrorofmean", "stderrormean"],
    &[
        "variance",
        "varianz",
        "spannweite",
        "error",
        "fehler",
        "var",
        "samplevariance",
        "cv",
        "coefficientofvariation",
        "kurtosis",
        "skewness",
        "anova",
    ],
    &["n", "count", "anzahl", "nombre", "numberofvalues", "numberofembryos", "nobs", "sum", "summe", "somme", "suma"],
    &["min", "minimum", "max", "maximum", "range", "quartile", "iqr", "1stqu", "3rdqu", "1stquartile", "3rdquartile"],
    &[
        "lower95ciofmean",
        "upper95ciofmean",
        "lower95ci",
        "upper95ci",
        "95ci",
        "ci95",
        "confidencelevel",
        "pvalue",
        "ttest",
    ],
];

/// Words that call a row a summary, whatever else is in its name: Mean WT, Control mean.
const MEANS: [&str; 13] = [
    "gesamtergebnis",
    "mean",
    "average",
    "avg",
    "median",
    "moyenne",
    "mittelwert",
    "mediane",
    "geomean",
    "total",
    "subtotal",
    "diane",
    "mean1",
];

/// The same in writings without letters of the alphabet.
const SIGNS: [&str; 10] = ["平均", "平均値", "標準偏差", "中央値", "合計", "総計", "x̄", "σ", "Σ", "Ø"];

/// Whether a text calls a row a summary of others, such as Mean, Mean WT, S.E.M., SD (n - 1) or 25 % percentile.
pub(crate) fn is_summary(text: &[u8]) -> bool {
    if is_mean(text) || is_count(text) {
        return true;
    }
    let (mut word, mut length) = ([0; 24], 0);
    for byte in text.iter().take_while(|byte| !b"([:".contains(byte)) {
        if length == word.len() {
            return false;
        }
        if byte.is_ascii_alphanumeric() {
            word[length] = byte.to_ascii_lowercase();
            length += 1;
        }
    }
    let word = str::from_utf8(&word[..length]).unwrap_or_default();
    let percent = word.trim_start_matches(|c: char| c.is_ascii_digit());
    let of_percent = percent.len() < word.len() && matches!(percent, "" | "percentile" | "quantile");
    SUMMARIES.iter().any(|names| names.contains(&word)) || of_percent && text.contains(&b'%')
}

/// Whether a text says how many rows there are, as n = 3.
fn is_count(text: &[u8]) -> bool {
    let number = || text.strip_prefix(b"n").or_else(|| text.strip_prefix(b"N"))?.trim_ascii().strip_prefix(b"=");
    number().is_some_and(|number| number.trim_ascii().iter().all(u8::is_ascii_digit))
}

/// Whether a text calls a row a mean. Groups may be called by other words of summaries, such as all.
fn is_mean(text: &[u8]) -> bool {
    let is_one = |word: &[u8]| MEANS.iter().any(|mean| word.eq_ignore_ascii_case(mean.as_bytes()));
    text.split(|byte| !byte.is_ascii_alphanumeric()).any(is_one) || SIGNS.iter().any(|sign| text == sign.as_bytes())
}

/// How programs write missing values, beside an empty field.
pub(crate) const MISSING: [&str; 6] = ["na", "n/a", "nan", "none", "null", "nil"];

/// Whether a value is missing.
pub(crate) fn is_absent(text: &[u8]) -> bool {
    matches!(text, b"" | b"-" | b".") || MISSING.iter().any(|missing| text.eq_ignore_ascii_case(missing.as_bytes()))
}

/// Why a summary is no data.
pub(crate) const SUMMARY: &str = "a summary of other rows, which is no measurement";

/// The unit in a field, which must be the heading's, if that has one, and of the kind of the rows `before`.
///
/// # Errors
/// The allowed units.
pub(crate) fn unit_in(
    field: &[u8],
    of_heading: Option<VolumeUnit>,
    before: Option<VolumeUnit>,
) -> Result<VolumeUnit, String> {
    let unit = unit_of(&text(field), &VOLUMES).ok_or_else(|| format!("one of {}", units_listed(&VOLUMES)))?;
    if let Some(heading) = of_heading.filter(|heading| heading != unit) {
        return Err(format!("{}, the unit of the heading", heading.words.first().unwrap_or(&"relative")));
    }
    match before.filter(|before| before.kind != unit.kind) {
        Some(before) => Err(format!("{}, the unit of the rows before", before.kind.symbol())),
        None => Ok(*unit),
    }
}

/// The columns of a table of divisions.
pub(crate) struct DivisionColumns {
    pub(crate) embryo: usize,
    pub(crate) mother: usize,
    /// Volumes of the larger and of the smaller daughter.
    pub(crate) daughters: [usize; 2],
    pub(crate) mother_volume: Option<usize>,
    pub(crate) population: GroupColumn,
    pub(crate) common: Common,
    /// χ, which must be the volumes'.
    pub(crate) chi: Option<usize>,
    pub(crate) generation: Option<usize>,
    /// The columns of the mother's class.
    pub(crate) class: Vec<usize>,
    /// The unit in the headings.
    pub(crate) unit: Option<VolumeUnit>,
    /// The column with the unit of each row.
    pub(crate) unit_column: Option<usize>,
}

impl DivisionColumns {
    /// The columns of a table of divisions; `None` for other tables.
    pub(crate) fn of(header: &Header<'_>, class: Vec<usize>) -> Result<Option<Self>, InputError> {
        // A heading `mother` without a unit is the column of names.
        let volume = |of: &str| -> Result<Option<(usize, Option<VolumeUnit>)>, InputError> {
            let mut found = header.quantity(of, &VOLUMES)?;
            found.retain(|(_, unit)| unit.is_some() || of != "mother");
            let found = header.only(&format!("volume of the {of}"), &found)?;
            Ok(found.map(|(at, unit)| (at, unit.copied())))
        };
        let (larger, smaller) = match (volume("larger")?, volume("smaller")?) {
            (None, None) => return Ok(None),
            found => found,
        };
        let (embryo, mother) = (embryo_column(header), header.find(&["mother"]));
        let (Some(embryo), Some(mother), Some((larger, unit)), Some((smaller, other))) =
            (embryo, mother, larger, smaller)
        else {
            let [larger, smaller] = [larger, smaller].map(|found| found.map(|(at, _)| at));
            return Err(header.missing(
                &[("embryo", embryo), ("mother", mother), ("larger_um3", larger), ("smaller_um3", smaller)],
                "a table of divisions has the columns embryo, mother, larger_um3 and smaller_um3 \
                 (or larger_voxels, smaller_voxels)",
            ));
        };
        let mother_volume = volume("mother")?;
        let units = [unit, other].into_iter().chain(mother_volume.map(|(_, own)| own));
        let stated: Vec<VolumeUnit> = units.clone().flatten().collect();
        // Beside a unit a volume without one is in µm³.
        if !stated.is_empty() && !units.map(|unit| unit.unwrap_or(VOLUMES[0])).all(|unit| unit == stated[0]) {
            return Err(header.refused("mother, larger and smaller have different units"));
        }
        let population = header.find(&[POPULATION]).map_or_else(|| GroupColumn::of(header), GroupColumn::at);
        Ok(Some(DivisionColumns {
            embryo,
            common: Common::of(header, Some(embryo), &population),
            chi: header.find(&["chi", "chi_signed"]),
            mother,
            daughters: [larger, smaller],
            mother_volume: mother_volume.map(|(at, _)| at),
            population,
            generation: header.find(&["generation"]),
            class,
            unit: stated.first().copied(),
            unit_column: header.find(&UNIT),
        }))
    }
}

/// The columns of a table of χ.
pub(crate) struct ChiColumns {
    /// The cell that divides: in a table with a row for each cell, its own name and not its mother's.
    pub(crate) mother: usize,
    pub(crate) chi: Share,
    pub(crate) is_signed: bool,
    /// |χ|, in a table that has its sign too.
    pub(crate) absolute: Option<Share>,
    pub(crate) embryo: Option<usize>,
    pub(crate) group: GroupColumn,
    pub(crate) common: Common,
    /// The standard deviation of χ.
    pub(crate) chi_sd: Option<Share>,
    /// The mother's volume.
    pub(crate) mother_volume: Option<(usize, VolumeUnit)>,
    /// The columns of the mother's class.
    pub(crate) class: Vec<usize>,
}

impl ChiColumns {
    /// The columns of a table of χ; `None` for other tables.
    pub(crate) fn of(header: &Header<'_>, class: Vec<usize>) -> Result<Option<Self>, InputError> {
        // `bare` is the size of a share without a unit.
        let share = |what: &str, names: &[&str], bare: f64| -> Result<Option<Share>, InputError> {
            let found: Result<Vec<_>, InputError> = names.iter().map(|name| header.quantity(name, &SHARES)).collect();
            let found = header.only(what, &found?.concat())?;
            Ok(found.map(|(column, unit)| Share { column, size: unit.map_or(bare, |unit| unit.size) }))
        };
        // Where a table has both, the signed χ is more informative.
        let (signed, absolute) =
            (share("signed χ", &["chi_signed", "χ_signed"], 1.0)?, share("χ", &["chi", "χ"], 1.0)?);
        let (Some(mother), Some(chi)) = (header.find(&["mother"]), signed.or(absolute)) else { return Ok(None) };
        let mother = cell_column(header).unwrap_or(mother);
        let mut volumes = Vec::new();
        for name in ["mother", "mother_volume", "v_mother"] {
            let found = header.quantity(name, &VOLUMES)?;
            volumes.extend(found.into_iter().filter_map(|(column, unit)| Some((column, *unit?))));
        }
        let (embryo, group) = (embryo_column(header), GroupColumn::of(header));
        Ok(Some(ChiColumns {
            mother,
            chi,
            is_signed: signed.is_some(),
            absolute: absolute.filter(|_| signed.is_some()),
            embryo,
            common: Common::of(header, embryo, &group),
            group,
            chi_sd: share("standard deviation of χ", &CHI_SD, chi.size)?,
            mother_volume: header.only("volume of the mother", &volumes)?,
            class,
        }))
    }
}

/// A column of shares, and how much 1 in it is.
#[derive(Clone, Copy)]
pub(crate) struct Share {
    pub(crate) column: usize,
    pub(crate) size: f64,
}

/// Units of shares.
pub(crate) const SHARES: [NamedUnit<()>; 2] = [
    NamedUnit { kind: (), size: 1.0, words: &["1", "fraction", "relative"] },
    NamedUnit { kind: (), size: 0.01, words: &["%", "percent"] },
];

/// Names of the column with the standard deviation of χ.
const CHI_SD: [&str; 4] = ["chi_sd", "sd_chi", "sd", "sigma"];

/// The embryo of a grid: the file's name without its extension and `_volume`.
pub(crate) fn embryo_of_file(file: &str) -> String {
    let name = std::path::Path::new(file).file_stem().map_or(file.into(), |stem| stem.to_string_lossy());
    let lower = name.to_lowercase();
    let end =
        if lower.len() == name.len() { lower.strip_suffix("_volume").map_or(name.len(), str::len) } else { name.len() };
    name[..end].to_owned()
}
