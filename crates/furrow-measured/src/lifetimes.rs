//! Tables of lifetimes, from a cell's birth to its division.
//!
//! Columns, in any order: `cell`; `lifetime_min` (or `lifetime_s`, `lifetime_h`), or `birth_min` and `division_min`; optionally `sd_min`,
//! `birth_min`, `n` and `embryo`. With a column `n` a row is a cell's mean over n embryos; without it a row is a cell of one embryo, and
//! rows of a cell are averaged. Where embryos are known, each has its own [pace](EmbryoTimes), and births are counted from the same
//! origin. Lines that begin with `#` are comments. A row that cannot be used is skipped and reported with its place.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::io::Read;

use furrow_input::table::Table;
use furrow_input::{InputError, listed};
use ordered_float::OrderedFloat;
use serde::Serialize;

use crate::events::place;
use crate::layout::embryo_of_file;
use crate::lifetime_table::{Columns, read_row};
use crate::matching::Matched;
use crate::names::Names;
use crate::pace::{InEmbryos, Shares, shares};
use crate::per_embryo::PerEmbryo;
use crate::several::Source;
use crate::significance::{Sample, Trend, paired, power, sign_test, welch};
use crate::statistics::{grouped, mean, sd, smaller};
use crate::tracked::{EmbryoFile, TrackOptions, TrackedLineage, open_table, read_tracked};
use crate::volumes::{EmbryoSize, MOST_PLACES, Skipped, Value, Volumes, note, require_used};

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
    /// Rows that could not be used, at most [`MOST_PLACES`].
    pub skipped: Vec<Skipped>,
    /// How many there are.
    pub skipped_count: u64,
    /// The names of cells.
    pub names: Names,
    /// How the cells of embryos that were followed were matched to the names.
    pub matched: Vec<Matched>,
    /// The embryos, where they are known.
    pub embryos: Vec<EmbryoTimes>,
    /// The lifetimes of the cells of each of them.
    by_embryo: Vec<HashMap<String, f64>>,
}

/// An embryo beside the others.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct EmbryoTimes {
    /// Its name.
    pub embryo: String,
    /// Its cells with a lifetime.
    pub cells: usize,
    /// How many of these other embryos have too.
    pub shared: usize,
    /// Minutes from one frame to the next, where frames are counted.
    pub frame_minutes: Option<f64>,
    /// The lifetimes of its cells divided by the lifetimes in all embryos; `None` if no shared cells connect it with most embryos.
    pub time_factor: Option<f64>,
    /// Standard deviation of ln lifetime about what its factor gives.
    pub scatter: Option<f64>,
    /// The minute of its own clock that is minute 0 of the first embryo's; `None` without births that are shared.
    pub shift_min: Option<f64>,
}

/// Options for lifetimes of embryos.
#[derive(Clone, Debug, Default)]
pub struct LifetimeOptions {
    /// Minutes from one frame to the next, for embryos of programs that count frames.
    pub frame_minutes: PerEmbryo,
    /// Whether lifetimes and births are divided by the time factor of their embryo before they are averaged.
    pub common_pace: bool,
    /// Names of cells.
    pub names: Names,
}

/// A row while tables are read.
struct RowOfEmbryo {
    lifetime: Lifetime,
    /// The place of its embryo, if it is known.
    embryo: Option<usize>,
}

/// Rows of all tables, and their embryos.
#[derive(Default)]
struct Rows {
    rows: Vec<RowOfEmbryo>,
    embryos: Vec<EmbryoTimes>,
    /// Their names in their tables, and the tables.
    sources: Vec<Source>,
    has_means: bool,
}

impl Rows {
    /// The place of an embryo of a file.
    fn embryo(&mut self, name: &str, file: &str, frame_minutes: Option<f64>) -> usize {
        let source = Source { name: name.to_owned(), file: file.to_owned() };
        let known = self.sources.iter().position(|known| *known == source);
        known.unwrap_or_else(|| {
            self.sources.push(source);
            self.embryos.push(EmbryoTimes { embryo: name.to_owned(), frame_minutes, ..EmbryoTimes::default() });
            self.embryos.len() - 1
        })
    }

    /// Compares the embryos from number `first` on with embryos of the same names in other tables: they are one embryo if they have
    /// no cell in common, and else called by their tables too.
    fn join(&mut self, first: usize) {
        let cells: Vec<HashSet<String>> = (0..self.embryos.len())
            .map(|place| {
                let own = self.rows.iter().filter(|row| row.embryo == Some(place));
                own.map(|row| row.lifetime.cell.clone()).collect()
            })
            .collect();
        let mut joined = Vec::new();
        for k in first..self.embryos.len() {
            for other in (0..first).filter(|other| self.sources[*other].name == self.sources[k].name) {
                if cells[other].is_disjoint(&cells[k]) {
                    joined.push((k, other));
                    break;
                }
                let [theirs, own] = Source::labels([&self.sources[other], &self.sources[k]]);
                if self.embryos[other].embryo == self.sources[other].name {
                    self.embryos[other].embryo = theirs;
                }
                self.embryos[k].embryo = own;
            }
        }
        for (k, other) in joined.into_iter().rev() {
            self.embryos.remove(k);
            self.sources.remove(k);
            for embryo in self.rows.iter_mut().filter_map(|row| row.embryo.as_mut()) {
                match *embryo {
                    place if place == k => *embryo = other,
                    place if place > k => *embryo = place - 1,
                    _ => {}
                }
            }
        }
    }

    /// A value of the cells of known embryos.
    fn in_embryos(&self, value: impl Fn(&Lifetime) -> Option<f64>) -> InEmbryos<'_> {
        let of = |row: &'_ RowOfEmbryo| Some((row.embryo?, value(&row.lifetime)?));
        self.rows.iter().filter_map(|row| of(row).map(|(e, value)| (e, row.lifetime.cell.as_str(), value))).collect()
    }

    /// Finds the pace of each embryo. Births are counted from the origin of the first embryo; where embryos have a common pace, the
    /// times of each are divided by its factor.
    fn align(&mut self, common_pace: bool) {
        for RowOfEmbryo { embryo, .. } in &self.rows {
            embryo.iter().for_each(|embryo| self.embryos[*embryo].cells += 1);
        }
        if self.embryos.len() < 2 {
            return;
        }
        let lives = self.in_embryos(|lifetime| Some(lifetime.mean.ln()));
        let Shares { of, scatter, shared } = shares(&lives, self.embryos.len());
        for (embryo, ((share, scatter), shared)) in self.embryos.iter_mut().zip(of.into_iter().zip(scatter).zip(shared))
        {
            (embryo.time_factor, embryo.scatter, embryo.shared) = (share.map(f64::exp), scatter, shared);
        }
        if common_pace {
            for RowOfEmbryo { lifetime, embryo } in &mut self.rows {
                let factor = embryo.and_then(|embryo| self.embryos[embryo].time_factor).unwrap_or(1.0);
                lifetime.mean /= factor;
                lifetime.birth = lifetime.birth.map(|birth| birth / factor);
            }
        }
        let Shares { of: shifts, .. } = shares(&self.in_embryos(|lifetime| lifetime.birth), self.embryos.len());
        let first = shifts.iter().find_map(|shift| *shift).unwrap_or(0.0);
        for (embryo, shift) in self.embryos.iter_mut().zip(shifts) {
            embryo.shift_min = shift.map(|shift| shift - first);
        }
        for RowOfEmbryo { lifetime, embryo } in &mut self.rows {
            let shift = embryo.map(|embryo| self.embryos[embryo].shift_min);
            // A birth on a clock of its own says nothing.
            lifetime.birth = match shift {
                Some(shift) => lifetime.birth.zip(shift).map(|(birth, shift)| birth - shift),
                None => lifetime.birth,
            };
        }
    }

    /// By cell in the order of the tables.
    fn averaged(self) -> Vec<Lifetime> {
        let by_cell = grouped(self.rows.into_iter().map(|row| (row.lifetime.cell.clone(), row.lifetime)));
        by_cell.iter().filter_map(|(_, rows)| averaged(rows)).collect()
    }
}

impl Lifetimes {
    /// Reads a table with Sulston's names. Reports name it `file`.
    ///
    /// # Errors
    /// A table without the required columns, or without a row that can be used.
    pub fn read(from: impl Read, file: &str) -> Result<Lifetimes, InputError> {
        Lifetimes::read_with(from, file, &LifetimeOptions::default())
    }

    /// Reads a table with options.
    ///
    /// # Errors
    /// As [`Lifetimes::read`].
    pub fn read_with(from: impl Read, file: &str, options: &LifetimeOptions) -> Result<Lifetimes, InputError> {
        let (mut found, mut rows) =
            (Lifetimes { names: options.names.clone(), ..Lifetimes::default() }, Rows::default());
        found.read_table(from, (file, false), &mut rows)?;
        found.finished(rows, file, options.common_pace)
    }

    /// Reads files: tables, or embryos that another program [followed over time](crate::tracked). Each of several tables is of one embryo,
    /// unless a column has the embryos.
    ///
    /// # Errors
    /// As [`Lifetimes::read`] and [`TrackedLineage::lifetimes`](crate::tracked::TrackedLineage::lifetimes); a table of means beside other
    /// files; minutes per frame for an embryo that is not there.
    pub fn read_files(files: &[EmbryoFile], options: &LifetimeOptions) -> Result<Lifetimes, InputError> {
        let (mut found, mut rows) =
            (Lifetimes { names: options.names.clone(), ..Lifetimes::default() }, Rows::default());
        let (mut counting, mut cells) = (Vec::new(), 0);
        for EmbryoFile { path, name } in files {
            let (file, frame_minutes) = (path.display().to_string(), options.frame_minutes.of(name));
            match read_tracked(path, &TrackOptions { frame_minutes, without_sizes: true, ..TrackOptions::default() })? {
                None => found.read_table(open_table(path)?, (&file, files.len() > 1), &mut rows)?,
                Some(mut embryo) => {
                    embryo.name.clone_from(name);
                    embryo.match_names(&options.names)?;
                    let frame_minutes = frame_minutes.filter(|_| embryo.takes.frame_minutes);
                    counting.extend(embryo.takes.frame_minutes.then_some(name.as_str()));
                    cells += embryo.cells.len();
                    found.add_tracked(&embryo, frame_minutes, &mut rows)?;
                }
            }
        }
        let allowed = "left out: tables have times in a unit, and no file has frames";
        let is_used = options.frame_minutes.is_empty() || !counting.is_empty();
        InputError::require(is_used, "--frame-minutes", "frame_minutes", "(given)", allowed)?;
        options.frame_minutes.require_known(&counting, "--frame-minutes")?;
        let file = files.first().map_or(String::new(), |file| file.path.display().to_string());
        let allowed = "in a table that is read by itself: its rows are means over embryos";
        let is_alone = !rows.has_means || files.len() < 2;
        InputError::require(is_alone, file, "n", "a column of one of the tables", allowed)?;
        let names: Vec<String> = files.iter().map(|file| file.path.display().to_string()).collect();
        let names = listed(names.iter().map(String::as_str), ", ");
        if found.used == 0 && cells > 0 {
            options.names.require_met()?;
            let first = found
                .skipped
                .first()
                .map_or(String::new(), |first| format!(" (the first of {} skipped: {first})", found.skipped_count));
            let why = "at least one cell with a known name that was followed from its birth to its division";
            return Err(InputError::not_allowed(names, "cells", cells, format!("{why}{first}")));
        }
        found.finished(rows, &names, options.common_pace)
    }

    /// The lifetimes of all rows.
    fn finished(mut self, mut rows: Rows, file: &str, common_pace: bool) -> Result<Lifetimes, InputError> {
        if self.used == 0 {
            self.names.require_met()?;
        }
        let place = self.skipped.first().map_or(file, |skipped| &skipped.file).to_owned();
        require_used(self.used, (&place, "lifetimes"), &self.skipped, self.skipped_count)?;
        rows.align(common_pace);
        self.embryos = std::mem::take(&mut rows.embryos);
        self.by_embryo = vec![HashMap::new(); self.embryos.len()];
        for RowOfEmbryo { lifetime, embryo } in &rows.rows {
            let own = embryo.map(|embryo| &mut self.by_embryo[embryo]);
            own.map(|own| own.insert(lifetime.cell.clone(), lifetime.mean));
        }
        self.cells = rows.averaged();
        Ok(self)
    }

    /// Adds the rows of a table, which is of one embryo if it is one of `several`.
    fn read_table(
        &mut self,
        from: impl Read,
        (file, several): (&str, bool),
        rows: &mut Rows,
    ) -> Result<(), InputError> {
        let mut table = Table::open(from, file)?;
        let columns = Columns::of(&table.columns(|_| false)?)?;
        table.share(columns.times());
        rows.has_means |= columns.n.is_some();
        let (of_file, before) = (embryo_of_file(file), rows.embryos.len());
        // Lines of the first rows of cells, by embryo.
        let mut places: HashMap<(Option<usize>, String), u64> = HashMap::new();
        let mut group = HashMap::new();
        while let Some(row) = table.next_row()? {
            columns.require_group(row, &mut group, file)?;
            let noted = columns.embryo_of(row).and_then(|embryo| {
                let named = embryo.as_deref().or(several.then_some(of_file.as_str()));
                let lifetime = read_row(row, &columns, named.unwrap_or(&of_file), &self.names)?;
                let embryo = named.filter(|_| columns.n.is_none()).map(|embryo| rows.embryo(embryo, file, None));
                let first = *places.entry((embryo, lifetime.cell.clone())).or_insert(row.line);
                if first != row.line && (columns.n.is_some() || embryo.is_some()) {
                    let why = format!("a second row of this cell; the first is on line {first}");
                    return Err((Value::new(row, columns.cell), why));
                }
                rows.rows.push(RowOfEmbryo { lifetime, embryo });
                Ok(())
            });
            match noted {
                Ok(()) => self.used += 1,
                Err(rejected) => note(&mut self.skipped, &mut self.skipped_count, || Skipped::new(file, &rejected)),
            }
        }
        rows.join(before);
        Ok(())
    }

    /// Adds the cells of an embryo.
    fn add_tracked(
        &mut self,
        embryo: &TrackedLineage,
        frame_minutes: Option<f64>,
        rows: &mut Rows,
    ) -> Result<(), InputError> {
        let lives = embryo.lifetimes(&self.names)?;
        self.matched.extend(embryo.matched.clone());
        self.skipped_count += lives.skipped_count;
        self.skipped.extend(lives.skipped.into_iter().take(MOST_PLACES.saturating_sub(self.skipped.len())));
        let file = embryo.cells.first().map_or("", |cell| &cell.place.0);
        let place = rows.embryo(&embryo.name, file, frame_minutes);
        self.used += lives.cells.len() as u64;
        rows.rows.extend(lives.cells.into_iter().map(|lifetime| RowOfEmbryo { lifetime, embryo: Some(place) }));
        Ok(())
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

/// Mean volume of every cell over the embryos that have it, with [`Volumes::common_size`] of volumes divided by the size factor of their
/// embryo.
pub fn mean_volumes(volumes: &Volumes) -> BTreeMap<String, f64> {
    means_at(volumes, volumes.common_size)
}

fn means_at(volumes: &Volumes, common_size: bool) -> BTreeMap<String, f64> {
    let factor = |size: EmbryoSize| size.size_factor.filter(|_| common_size).unwrap_or(1.0);
    let embryos = volumes.embryos.iter().zip(volumes.sizes().into_iter().map(factor));
    let cells = embryos.flat_map(|(embryo, factor)| embryo.cells.iter().map(move |cell| (cell, factor)));
    let cells = cells.filter(|(cell, _)| cell.frames > 0);
    let by_name = grouped(cells.map(|(cell, factor)| (cell.cell.as_str(), cell.volume() / factor)));
    by_name.into_iter().map(|(cell, volumes)| (cell.to_owned(), mean(&volumes))).collect()
}

/// How far the sizes of embryos distort the proportions of cells that some of them lack: the largest change of a ratio of two mean volumes
/// by a common size, as a factor of 1 or more.
pub fn distortion(volumes: &Volumes) -> f64 {
    let changes = means_at(volumes, true).into_values().zip(means_at(volumes, false).into_values()).map(|(a, b)| a / b);
    let [least, most] = changes.fold([f64::INFINITY, 0.0], |[least, most]: [f64; 2], x| [least.min(x), most.max(x)]);
    if most > 0.0 { most / least } else { 1.0 }
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
    let point = |(founder, volume, lifetime): (&'a str, f64, f64)| (founder, [volume.ln(), lifetime.ln()]);
    let points: Vec<(&str, [f64; 2])> = cells.into_iter().map(point).collect();
    let all: Vec<[f64; 2]> = points.iter().map(|(_, point)| *point).collect();
    let of = |(founder, points): (&str, Vec<[f64; 2]>)| Some((founder.to_owned(), power(&points)?));
    Slopes { all: power(&all), founders: grouped(points).into_iter().filter_map(of).collect() }
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
    /// Which divides first: 0 or 1, by the embryos that have both if there are any; `None` if their means are equal.
    pub first: Option<usize>,
    /// Two-sided p value of the difference of their lifetimes: of ln lifetime paired over `embryos`, or Welch's of a table of means.
    pub p: Option<f64>,
    /// Embryos in which both were measured; 0 of a table of means.
    pub embryos: usize,
}

/// Pairs of sisters that both have a lifetime, by generation and name of the mother.
pub fn sisters(lifetimes: &Lifetimes) -> Vec<Sisters> {
    let by_name: HashMap<&str, &Lifetime> = lifetimes.cells.iter().map(|cell| (cell.cell.as_str(), cell)).collect();
    let by_embryo = &lifetimes.by_embryo;
    let of = |cell: &Lifetime| {
        let (mother, other, is_first) = lifetimes.names.birth(&cell.cell)?;
        let other = *by_name.get(other.as_str()).filter(|_| is_first)?;
        let sample = |cell: &Lifetime| Some(Sample { n: cell.n, mean: cell.mean, sd: cell.sd? });
        let lifetimes = [cell.mean, other.mean];
        // Sisters of one embryo share its pace.
        let difference = |own: &HashMap<String, f64>| Some((own.get(&cell.cell)? / own.get(&other.cell)?).ln());
        let differences: Vec<f64> = by_embryo.iter().filter_map(difference).collect();
        let p = match by_embryo.is_empty() {
            true => sample(cell).zip(sample(other)).and_then(|(a, b)| welch(a, b)),
            false => paired(&differences).and_then(|test| test.p),
        };
        let first = smaller(if differences.is_empty() { lifetimes } else { [mean(&differences), 0.0] });
        let (daughters, embryos) = ([cell.cell.clone(), other.cell.clone()], differences.len());
        Some(Sisters { mother: mother.to_owned(), daughters, lifetimes, first, p, embryos })
    };
    let mut pairs: Vec<Sisters> = lifetimes.cells.iter().filter_map(of).collect();
    pairs.sort_by(|a, b| place(&a.mother).cmp(&place(&b.mother)));
    pairs
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
        divisions.sort_by_cached_key(|item| OrderedFloat(item.1));
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
