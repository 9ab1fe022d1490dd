//! Tables of lifetimes, from a cell's birth to its division.
//!
//! Columns, in any order: `cell`; `lifetime_min` (or `lifetime_s`, `lifetime_h`); optionally `sd_min`, `birth_min` and `n`. With a
//! column `n` a row is a cell's mean over n embryos; without it a row is a cell of one embryo, and rows of a cell are averaged.
//! Lines that begin with `#` are comments. A row that cannot be used is skipped and reported with its place.

use std::collections::{BTreeMap, HashMap};
use std::io::Read;
use std::path::Path;

use furrow_input::table::{Header, Row, TIMES, Table, columns_listed};
use furrow_input::{InputError, open_file};
use serde::Serialize;

use crate::events::place;
use crate::layout::{cell_column, embryo_of_file};
use crate::matching::Matched;
use crate::names::Names;
use crate::significance::{Sample, Trend, power, sign_test, welch};
use crate::statistics::{mean, sd};
use crate::tracked::{TrackOptions, read_tracked};
use crate::volumes::{Rejected, Skipped, Value, Volumes, fitting, note, require_used};

/// How long a cell lives in some embryos.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Lifetime {
    /// The cell.
    pub cell: String,
    /// The founder that it is or descends from.
    pub founder: String,
    /// Embryos.
    pub n: u64,
    /// Mean from birth to division, in minutes.
    pub mean: f64,
    /// Its standard deviation over embryos.
    pub sd: Option<f64>,
    /// Mean time of birth, in minutes from the origin of the table.
    pub birth: Option<f64>,
}

impl Lifetime {
    /// When it divides, if the table says when it is born.
    pub fn division(&self) -> Option<f64> {
        Some(self.birth? + self.mean)
    }
}

/// Lifetimes of the cells of some embryos.
#[derive(Clone, Debug, Default)]
pub struct Lifetimes {
    /// By cell, in the order of the table.
    pub cells: Vec<Lifetime>,
    /// Rows used.
    pub used: u64,
    /// Rows that could not be used, at most [`MOST_PLACES`](crate::volumes::MOST_PLACES).
    pub skipped: Vec<Skipped>,
    /// How many there are.
    pub skipped_count: u64,
    /// The names of cells.
    pub names: Names,
    /// How the cells of embryos that were followed were matched to the names.
    pub matched: Vec<Matched>,
}

/// A column of times and the minutes in its unit.
type TimeColumn = (usize, f64);

/// The columns of a table.
struct Columns {
    cell: usize,
    lifetime: TimeColumn,
    n: Option<usize>,
    sd: Option<TimeColumn>,
    birth: Option<TimeColumn>,
}

impl Columns {
    fn of(header: &Header<'_>) -> Result<Columns, InputError> {
        let time = |what: &str| -> Result<Option<TimeColumn>, InputError> {
            let refused = |column: usize, why: String| {
                let named: Vec<String> = TIMES.iter().map(|unit| format!("{what}_{}", unit.words[0])).collect();
                header.refused(format!("column {} is {why} {}", column + 1, named.join(", ")))
            };
            match header.quantity(what, &TIMES)?[..] {
                [] => Ok(None),
                [(column, Some(unit))] => Ok(Some((column, unit.size))),
                [(column, None), ..] => {
                    Err(refused(column, format!("called {what:?}: its name must have the unit, as")))
                }
                [_, (second, _), ..] => Err(refused(second, format!("a second one for the {what}; allowed is one of"))),
            }
        };
        let missing = |what: &str| {
            let here = columns_listed(&header.names);
            header.refused(format!("no column is called {what}; the columns are {here}"))
        };
        let cell = cell_column(header).ok_or_else(|| missing("cell"))?;
        let lifetime = time("lifetime")?.ok_or_else(|| missing("lifetime_min"))?;
        let (n, sd, birth) = (header.find(&["n"]), time("sd")?, time("birth")?);
        if let (None, Some((column, _))) = (n, sd) {
            let why = format!("column {} is a standard deviation, but no column is called n", column + 1);
            return Err(header.refused(why));
        }
        Ok(Columns { cell, lifetime, n, sd, birth })
    }
}

/// Limits of a time, in minutes: sums beyond them could overflow.
const TIMES_OF_CELLS: [f64; 2] = [1e-9, 1e12];

/// Minutes in a column that are in the limits.
fn minutes<'r>(row: Row<'r>, (column, unit): TimeColumn, least: f64, allowed: &str) -> Result<f64, Rejected<'r>> {
    let value = Value::new(row, column);
    let time = value.number().map_err(|(value, why)| (value, format!("{allowed} ({why})")))? * unit;
    if (least..=TIMES_OF_CELLS[1]).contains(&time) { Ok(time) } else { Err((value, allowed.to_owned())) }
}

fn read_row<'r>(row: Row<'r>, columns: &Columns, embryo: &str, names: &Names) -> Result<Lifetime, Rejected<'r>> {
    let row = fitting(row)?;
    let at = |column: usize| Value::new(row, column);
    let cell = at(columns.cell);
    let cell = names.understood(embryo, &cell.written()).ok_or_else(|| (cell, names.unknown().to_owned()))?;
    let mean = minutes(row, columns.lifetime, TIMES_OF_CELLS[0], "must be a time above 0")?;
    let n = match columns.n.map(at) {
        None => 1,
        Some(value) => {
            let n = value.number().ok().filter(|n| (1.0..=1e9).contains(n) && n.fract() == 0.0);
            n.ok_or((value, "must be a number of embryos, at least 1".to_owned()))? as u64
        }
    };
    let optional = |column: Option<TimeColumn>, least: f64, allowed: &str| {
        let given = column.filter(|(column, _)| !row.text(*column).is_empty());
        given.map(|column| minutes(row, column, least, allowed)).transpose()
    };
    let sd = optional(columns.sd, 0.0, "must be a time of 0 or more, or empty")?;
    let birth = optional(columns.birth, -TIMES_OF_CELLS[1], "must be a time, or empty")?;
    let founder = names.founder(&cell).unwrap_or_default().to_owned();
    Ok(Lifetime { cell, founder, n, mean, sd, birth })
}

impl Lifetimes {
    /// Reads a table with Sulston's names. Reports name it `file`.
    ///
    /// # Errors
    /// A table without the required columns, or without a row that can be used.
    pub fn read(from: impl Read, file: &str) -> Result<Lifetimes, InputError> {
        Lifetimes::read_named(from, file, &Names::default())
    }

    /// Reads a table of cells with these names.
    ///
    /// # Errors
    /// As [`Lifetimes::read`].
    pub(crate) fn read_named(from: impl Read, file: &str, names: &Names) -> Result<Lifetimes, InputError> {
        let mut table = Table::open(from, file)?;
        let columns = Columns::of(&table.columns(|_| false)?)?;
        let mut found = Lifetimes { names: names.clone(), ..Lifetimes::default() };
        let embryo = embryo_of_file(file);
        let mut rows: Vec<Vec<Lifetime>> = Vec::new();
        // Indices of cells, and the lines of their first rows.
        let mut places: HashMap<String, (usize, u64)> = HashMap::new();
        while let Some(row) = table.next_row()? {
            let noted = read_row(row, &columns, &embryo, names).and_then(|lifetime| {
                let (at, first) = *places.entry(lifetime.cell.clone()).or_insert((rows.len(), row.line));
                match rows.get_mut(at) {
                    Some(_) if columns.n.is_some() => {
                        let why = format!("a second row of this cell; the first is on line {first}");
                        return Err((Value::new(row, columns.cell), why));
                    }
                    Some(of_cell) => of_cell.push(lifetime),
                    None => rows.push(vec![lifetime]),
                }
                Ok(())
            });
            match noted {
                Ok(()) => found.used += 1,
                Err(rejected) => note(&mut found.skipped, &mut found.skipped_count, || Skipped::new(file, &rejected)),
            }
        }
        names.require_met()?;
        require_used(found.used, (file, "lifetimes"), &found.skipped, found.skipped_count)?;
        found.cells = rows.iter().filter_map(|rows| averaged(rows)).collect();
        Ok(found)
    }

    /// Reads a file: a table, or cells that another program [followed over time](crate::tracked) with `frame_minutes` minutes from one
    /// frame to the next. Cells have these names.
    ///
    /// # Errors
    /// As [`Lifetimes::read`] and [`TrackedLineage::lifetimes`](crate::tracked::TrackedLineage::lifetimes).
    pub fn read_file(path: &Path, frame_minutes: Option<f64>, names: &Names) -> Result<Lifetimes, InputError> {
        let name = path.display().to_string();
        match read_tracked(path, &TrackOptions { pixel: None, frame_minutes })? {
            Some(mut embryo) => {
                embryo.match_names(names)?;
                names.require_met()?;
                embryo.lifetimes(&name, names)
            }
            None => Lifetimes::read_named(open_file(path)?, &name, names),
        }
    }

    /// The lifetime of a cell.
    pub fn of(&self, cell: &str) -> Option<&Lifetime> {
        self.cells.iter().find(|lifetime| lifetime.cell == cell)
    }

    /// The cell that aligns another clock with the table's by its birth: the first-born of the cells measured in the most embryos.
    pub fn reference(&self) -> Option<&Lifetime> {
        let most = self.cells.iter().filter(|cell| cell.birth.is_some()).map(|cell| cell.n).max()?;
        let often = self.cells.iter().filter(|cell| cell.n == most && cell.birth.is_some());
        often.min_by(|a, b| a.birth.unwrap_or_default().total_cmp(&b.birth.unwrap_or_default()))
    }
}

/// A single row, or the mean over several rows of one embryo each.
fn averaged(rows: &[Lifetime]) -> Option<Lifetime> {
    let [first, _, ..] = rows else { return rows.first().cloned() };
    let births: Vec<f64> = rows.iter().filter_map(|row| row.birth).collect();
    let lives: Vec<f64> = rows.iter().map(|row| row.mean).collect();
    let birth = (!births.is_empty()).then(|| mean(&births));
    Some(Lifetime { n: rows.len() as u64, mean: mean(&lives), sd: sd(&lives), birth, ..first.clone() })
}

/// Mean volume of every cell over the embryos that have it.
pub fn mean_volumes(volumes: &Volumes) -> BTreeMap<String, f64> {
    let mut all: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    for cell in volumes.embryos.iter().flat_map(|embryo| &embryo.cells) {
        all.entry(cell.cell.clone()).or_default().push(cell.volume());
    }
    all.into_iter().map(|(cell, volumes)| (cell, mean(&volumes))).collect()
}

/// ln lifetime over ln volume of cells: all of them, and by founder.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Slopes {
    /// Over all cells.
    pub all: Option<Trend>,
    /// By founder, for founders with three cells or more.
    pub founders: BTreeMap<String, Trend>,
}

/// The slopes of cells with a founder, a volume and a lifetime.
pub fn slopes<'a>(cells: impl IntoIterator<Item = (&'a str, f64, f64)>) -> Slopes {
    let mut all: Vec<[f64; 2]> = Vec::new();
    let mut founders: BTreeMap<String, Vec<[f64; 2]>> = BTreeMap::new();
    for (founder, volume, lifetime) in cells {
        let point = [volume.ln(), lifetime.ln()];
        all.push(point);
        founders.entry(founder.to_owned()).or_default().push(point);
    }
    let founders = founders.into_iter().filter_map(|(founder, points)| Some((founder, power(&points)?)));
    Slopes { all: power(&all), founders: founders.collect() }
}

/// Two measured sisters.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sisters {
    /// Their mother.
    pub mother: String,
    /// Their names, in the order of names.
    pub daughters: [String; 2],
    /// Mean lifetimes, in minutes.
    pub lifetimes: [f64; 2],
    /// Which divides first: 0 or 1; `None` if their means are equal.
    pub first: Option<usize>,
    /// Two-sided p value of Welch's test of their lifetimes; embryos are not paired.
    pub p: Option<f64>,
}

/// Pairs of sisters that both have a lifetime, by generation and name of the mother.
pub fn sisters(lifetimes: &Lifetimes) -> Vec<Sisters> {
    let by_name: HashMap<&str, &Lifetime> = lifetimes.cells.iter().map(|cell| (cell.cell.as_str(), cell)).collect();
    let of = |cell: &Lifetime| {
        let (mother, other, is_first) = lifetimes.names.birth(&cell.cell)?;
        let other = *by_name.get(other.as_str()).filter(|_| is_first)?;
        let sample = |cell: &Lifetime| Some(Sample { n: cell.n, mean: cell.mean, sd: cell.sd? });
        let lifetimes = [cell.mean, other.mean];
        let p = sample(cell).zip(sample(other)).and_then(|(a, b)| welch(a, b));
        let daughters = [cell.cell.clone(), other.cell.clone()];
        Some(Sisters { mother: mother.to_owned(), daughters, lifetimes, first: smaller(lifetimes), p })
    };
    let mut pairs: Vec<Sisters> = lifetimes.cells.iter().filter_map(of).collect();
    pairs.sort_by(|a, b| place(&a.mother).cmp(&place(&b.mother)));
    pairs
}

/// Which of two values is the smaller; `None` if they are equal.
pub fn smaller([a, b]: [f64; 2]) -> Option<usize> {
    if a == b { None } else { Some(usize::from(b < a)) }
}

/// How often an expected order is the measured one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Agreement {
    /// Pairs with an expected and a measured order.
    pub pairs: usize,
    /// Pairs with the same order in both.
    pub agree: usize,
    /// Probability of at least this many by tosses of a coin.
    pub p: f64,
}

/// How often the order that `expected` gives is the measured one; pairs without an expected order are left out.
pub fn agreement(pairs: &[Sisters], expected: impl Fn(&Sisters) -> Option<usize>) -> Agreement {
    let both = pairs.iter().filter_map(|pair| Some((pair.first?, expected(pair)?)));
    let (pairs, agree) = both.fold((0, 0), |(n, agree), (a, b)| (n + 1, agree + usize::from(a == b)));
    Agreement { pairs, agree, p: sign_test(agree, pairs) }
}

/// A division, and how many cells there are from then on.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Step {
    /// When, in minutes.
    pub min: f64,
    /// The cell that divides.
    pub cell: String,
    /// Cells alive then, its daughters included.
    pub cells: usize,
}

/// Numbers of cells alive over time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CellsOverTime {
    /// The cells before the first division: all others descend from them.
    pub roots: Vec<String>,
    /// Divisions in the order of time.
    pub steps: Vec<Step>,
}

impl CellsOverTime {
    /// The numbers that follow from divisions of some cells and their descendants.
    pub fn new(roots: Vec<String>, divisions: impl IntoIterator<Item = (String, f64)>) -> CellsOverTime {
        let mut divisions: Vec<(String, f64)> = divisions.into_iter().collect();
        divisions.sort_by(|a, b| a.1.total_cmp(&b.1));
        let first = roots.len() + 1;
        let step = |(k, (cell, min))| Step { min, cell, cells: first + k };
        CellsOverTime { steps: divisions.into_iter().enumerate().map(step).collect(), roots }
    }

    /// Cells alive at a time.
    pub fn at(&self, min: f64) -> usize {
        let before = self.steps.partition_point(|step| step.min <= min);
        self.roots.len() + before
    }
}

/// The numbers of cells of an embryo, and up to when they are known.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EmbryoOverTime {
    /// Divisions.
    #[serde(flatten)]
    pub over_time: CellsOverTime,
    /// The first birth of a cell without a lifetime in the table: from there on divisions can be missing.
    pub known_until: f64,
}

/// The numbers of cells that a table's births and lifetimes give; `None` without births. A cell divides where its lifetime ends, or
/// if that is not known where its daughters are born.
pub fn cells_over_time(lifetimes: &Lifetimes) -> Option<EmbryoOverTime> {
    let mut divisions: BTreeMap<String, f64> = BTreeMap::new();
    let mut daughters: HashMap<&str, usize> = HashMap::new();
    for cell in &lifetimes.cells {
        if let (Some((mother, ..)), Some(born)) = (lifetimes.names.birth(&cell.cell), cell.birth) {
            divisions.entry(mother.to_owned()).or_insert(born);
            *daughters.entry(mother).or_default() += 1;
        }
    }
    divisions.extend(lifetimes.cells.iter().filter_map(|cell| Some((cell.cell.clone(), cell.division()?))));
    let is_root =
        |cell: &&String| lifetimes.names.birth(cell).is_none_or(|(mother, ..)| !divisions.contains_key(mother));
    let roots = divisions.keys().filter(is_root).cloned().collect();
    let last = divisions.iter().filter(|(cell, _)| daughters.get(cell.as_str()) != Some(&2));
    let known_until = last.map(|(_, min)| *min).min_by(f64::total_cmp)?;
    Some(EmbryoOverTime { over_time: CellsOverTime::new(roots, divisions), known_until })
}
