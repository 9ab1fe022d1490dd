//! The clock: lifetimes of cells, and the times of birth and division of the cells of a tree in minutes.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::definition::Lineage;
use super::tree::{CellId, Tree, TreeCell};
use furrow_input::table::{TIMES, Table, malformed, text as text_of};
use furrow_input::{InputError, read_text, shown, unique_entries};

/// Lifetimes in minutes by the names of cells.
pub type Lifetimes = BTreeMap<String, f64>;

/// The law of lifetimes, from birth to division: `lifetime_min · (V / at_volume)^−exponent` minutes, with the volume V as a
/// fraction of the first cell's.
///
/// `L` is [`WrittenLifetimes`] while a file is read.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, bound(deserialize = "L: Deserialize<'de>"))]
pub struct Clock<L = Lifetimes> {
    /// Lifetime in minutes of a cell of the volume `at_volume`.
    pub lifetime_min: f64,
    /// The volume of cells with the lifetime `lifetime_min`, as a fraction of the first cell's; 1 if not given.
    #[serde(default = "whole", skip_serializing_if = "is_whole")]
    pub at_volume: f64,
    /// Exponent; if not given, 0, with which all cells have the same lifetime.
    #[serde(default)]
    pub exponent: f64,
    /// The smallest and the largest volume to which the law was fitted, as fractions of the first cell's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub volumes: Option<[f64; 2]>,
    /// One τ in minutes. If it is given, the time from the start of a division to pinch-off, `t_end` · `tau_min`, is added
    /// to the lifetimes of the law.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tau_min: Option<f64>,
    /// The event at minute 0; the birth of the first cell if not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub origin: Option<Origin>,
    /// Lifetimes of some cells, from birth to division, which override the law.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lifetimes: Option<L>,
}

/// The law of a founder and its descendants up to the next founder with a clock. A missing field is inherited from the
/// nearest founder above that has it, or from the file's clock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FounderClock {
    /// As [`Clock::lifetime_min`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lifetime_min: Option<f64>,
    /// As [`Clock::at_volume`]; 1 if only `lifetime_min` is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_volume: Option<f64>,
    /// As [`Clock::exponent`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub exponent: Option<f64>,
    /// As [`Clock::volumes`]; unknown if only `lifetime_min` is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub volumes: Option<[f64; 2]>,
}

/// The event at minute 0.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Origin {
    /// The birth of a cell.
    Birth(String),
    /// The division of a cell.
    Division(String),
}

impl Origin {
    /// The cell that is born or divides.
    pub fn cell(&self) -> &str {
        match self {
            Origin::Birth(cell) | Origin::Division(cell) => cell,
        }
    }
}

impl std::fmt::Display for Origin {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Origin::Birth(cell) => write!(f, "birth of {cell}"),
            Origin::Division(cell) => write!(f, "division of {cell}"),
        }
    }
}

fn whole() -> f64 {
    1.0
}

fn is_whole(value: &f64) -> bool {
    *value == 1.0
}

/// Lifetimes as written in a file.
#[derive(Clone, Debug, PartialEq)]
pub enum WrittenLifetimes {
    /// The path of a table with the columns `cell` and `lifetime_min`, relative to the folder of the lineage file.
    File(String),
    /// Minutes by name.
    Inline(Lifetimes),
}

impl<'de> Deserialize<'de> for WrittenLifetimes {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<WrittenLifetimes, D::Error> {
        struct Written;
        impl<'de> serde::de::Visitor<'de> for Written {
            type Value = WrittenLifetimes;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("minutes by name, as in {\"ABa\": 23.9}, or the name of a CSV file")
            }

            fn visit_str<E: serde::de::Error>(self, file: &str) -> Result<WrittenLifetimes, E> {
                Ok(WrittenLifetimes::File(file.to_owned()))
            }

            fn visit_map<A: serde::de::MapAccess<'de>>(self, map: A) -> Result<WrittenLifetimes, A::Error> {
                unique_entries(map, |name| format!("the cell {name} is given twice")).map(WrittenLifetimes::Inline)
            }
        }
        deserializer.deserialize_any(Written)
    }
}

impl Clock<WrittenLifetimes> {
    /// The clock with the lifetimes of its file, which is in the folder of the lineage file `lineage`.
    ///
    /// # Errors
    /// Names the file and its faulty line.
    pub(super) fn resolved(self, lineage: &str) -> Result<Clock, InputError> {
        // There is no `..`, so that a new field is a compile error until it is handled.
        let Clock { lifetime_min, at_volume, exponent, volumes, tau_min, origin, lifetimes } = self;
        let lifetimes = match lifetimes {
            None => None,
            Some(WrittenLifetimes::Inline(lifetimes)) => Some(lifetimes),
            Some(WrittenLifetimes::File(file)) => {
                let path = Path::new(lineage).parent().unwrap_or(Path::new("")).join(file);
                Some(read_lifetimes(&read_text(&path)?, &path.display().to_string())?)
            }
        };
        Ok(Clock { lifetime_min, at_volume, exponent, volumes, tau_min, origin, lifetimes })
    }
}

/// Reads the columns `cell` and `lifetime_min` (or a lifetime in s or h) of a table; lines that begin with # are comments.
fn read_lifetimes(text: &str, file: &str) -> Result<Lifetimes, InputError> {
    let mut table = Table::open(text.as_bytes(), file)?;
    let header = table.columns(|_| false)?;
    let missing = |name: &str| {
        header.refused(format!("no column is called {name}; a table of lifetimes has cell and lifetime_min"))
    };
    let cell = header.find(&["cell"]).ok_or_else(|| missing("cell"))?;
    let (column, unit) = match header.quantity("lifetime", &TIMES)?[..] {
        [(column, Some(unit))] => (column, unit.size),
        [] | [(_, None), ..] => return Err(missing("lifetime_min")),
        [_, (second, _), ..] => {
            return Err(header.refused(format!("column {} is a second one for the lifetime", second + 1)));
        }
    };
    let mut lifetimes = Lifetimes::new();
    while let Some(row) = table.next_row()? {
        let refused = |why: String| malformed(file, row.line as usize, why);
        if let Some((_, why)) = row.surplus() {
            return Err(refused(why));
        }
        let (name, value) = (text_of(row.text(cell)), text_of(row.text(column)));
        let allowed =
            |why: &str| refused(format!("{} = {}: must be a number above 0{why}", header.names[column], shown(&value)));
        let minutes = row.number(column).map_err(|why| allowed(&format!(" ({why})")))? * unit;
        if minutes.is_nan() || minutes <= 0.0 {
            return Err(allowed(""));
        }
        if lifetimes.insert(name.to_string(), minutes).is_some() {
            return Err(refused(format!("the cell {} is given twice", shown(&name))));
        }
    }
    Ok(lifetimes)
}

/// The law of a founder, with inherited values filled in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LifetimeLaw {
    /// Lifetime in minutes of a cell of the volume `at_volume`.
    pub lifetime_min: f64,
    /// The volume of cells with this lifetime, as a fraction of the first cell's.
    pub at_volume: f64,
    /// Exponent.
    pub exponent: f64,
    /// The smallest and the largest volume to which the law was fitted, if known.
    pub volumes: Option<[f64; 2]>,
}

/// Margin of half a division, a factor √2 in volume: cells of a generation differ by less than this from its measured sizes.
const HALF_A_DIVISION: f64 = std::f64::consts::SQRT_2;

impl LifetimeLaw {
    /// The lifetime of a cell in minutes; its volume is a fraction of the first cell's.
    pub fn lifetime(&self, volume: f64) -> f64 {
        self.lifetime_min * (volume / self.at_volume).powf(-self.exponent)
    }

    /// Whether a volume is outside the range to which the law was fitted by more than half a division.
    pub(crate) fn extrapolates_to(&self, volume: f64) -> bool {
        self.volumes.is_some_and(|[least, most]| volume * HALF_A_DIVISION < least || volume > most * HALF_A_DIVISION)
    }
}

impl Lineage {
    /// The law of a founder (an index into the lineage's founders); `None` without a clock.
    pub fn lifetime_law(&self, founder: usize) -> Option<LifetimeLaw> {
        let inherited = match self.mother(founder) {
            Some(mother) => self.lifetime_law(mother)?,
            None => {
                let Clock { lifetime_min, at_volume, exponent, volumes, .. } = *self.clock.as_ref()?;
                LifetimeLaw { lifetime_min, at_volume, exponent, volumes }
            }
        };
        let Some(own) = self.founders[founder].clock else { return Some(inherited) };
        let exponent = own.exponent.unwrap_or(inherited.exponent);
        Some(match own.lifetime_min {
            None => LifetimeLaw { exponent, volumes: own.volumes.or(inherited.volumes), ..inherited },
            Some(lifetime_min) => {
                LifetimeLaw { lifetime_min, at_volume: own.at_volume.unwrap_or(1.0), exponent, volumes: own.volumes }
            }
        })
    }

    /// The nearest founder from which a cell of this name descends by the naming rule, or the cell itself if it is a founder; `None`
    /// if no cell can have the name.
    pub fn founder_of(&self, name: &str) -> Option<usize> {
        let below = self.daughters();
        (0..self.founders.len()).find(|&k| {
            let Some(rest) = name.strip_prefix(self.founders[k].name.as_str()) else { return false };
            let named = |(n, letter): (usize, char)| {
                let (anterior, posterior) = self.letters(k, n + 1);
                letter == anterior || letter == posterior
            };
            rest.is_empty() || below[k].is_none() && rest.chars().enumerate().all(named)
        })
    }
}

/// Times of birth and division of a cell, in minutes from the origin of the lineage's clock.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CellTimes {
    /// Birth.
    pub birth_min: f64,
    /// Division; `None` for a cell without daughters.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub division_min: Option<f64>,
    /// Whether it divides after a lifetime from a law that was fitted to other sizes of cells.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub lifetime_extrapolated: bool,
}

impl CellTimes {
    /// The lifetime of a cell that divides, in minutes.
    pub fn lifetime_min(&self) -> Option<f64> {
        Some(self.division_min? - self.birth_min)
    }
}

impl Tree {
    /// Times of birth and division of every cell, in the order of the cells; `None` if the lineage has no clock.
    pub fn times(&self) -> Option<Vec<CellTimes>> {
        let clock = self.lineage.clock.as_ref()?;
        let laws: Vec<LifetimeLaw> =
            (0..self.lineage.founders.len()).map(|k| self.lineage.lifetime_law(k)).collect::<Option<_>>()?;
        let mut times: Vec<CellTimes> = Vec::with_capacity(self.len());
        for id in self.cells() {
            let cell = self.cell(id);
            // Mothers precede daughters.
            let birth_min = self.mother(id).and_then(|mother| times[mother.index()].division_min).unwrap_or(0.0);
            let divides = self.daughter_count(id) > 0;
            let law = &laws[cell.founder];
            let division_min = divides.then(|| birth_min + clock.lifetime(cell, law));
            let is_measured = clock.lifetimes.as_ref().is_some_and(|known| known.contains_key(&cell.name));
            let lifetime_extrapolated = divides && !is_measured && law.extrapolates_to(cell.volume_fraction);
            times.push(CellTimes { birth_min, division_min, lifetime_extrapolated });
        }
        let zero = self.origin_minute(clock.origin.as_ref(), &times).unwrap_or(0.0);
        for CellTimes { birth_min, division_min, .. } in &mut times {
            *birth_min -= zero;
            division_min.iter_mut().for_each(|division| *division -= zero);
        }
        Some(times)
    }

    /// The event at minute 0 of [`times`](Self::times): the origin of the clock if it occurs in this tree, otherwise the
    /// birth of the first cell; `None` without a clock.
    pub fn time_origin(&self) -> Option<Origin> {
        let clock = self.lineage.clock.as_ref()?;
        let takes_place = |origin: &&Origin| match self.cell_called(origin.cell()) {
            None => false,
            Some(id) => matches!(origin, Origin::Birth(_)) || self.daughter_count(id) > 0,
        };
        let first = || Origin::Birth(self.cell(self.first()).name.clone());
        Some(clock.origin.as_ref().filter(takes_place).cloned().unwrap_or_else(first))
    }

    fn cell_called(&self, name: &str) -> Option<CellId> {
        self.cells().find(|id| self.cell(*id).name == name)
    }

    /// The minute of the origin, counted from the birth of the first cell; `None` if it does not occur.
    fn origin_minute(&self, origin: Option<&Origin>, times: &[CellTimes]) -> Option<f64> {
        let origin = origin?;
        let of = times[self.cell_called(origin.cell())?.index()];
        match origin {
            Origin::Birth(_) => Some(of.birth_min),
            Origin::Division(_) => of.division_min,
        }
    }
}

impl Clock {
    /// The lifetime of a cell that divides, in minutes.
    fn lifetime(&self, cell: &TreeCell, law: &LifetimeLaw) -> f64 {
        if let Some(minutes) = self.lifetimes.as_ref().and_then(|lifetimes| lifetimes.get(&cell.name)) {
            return *minutes;
        }
        let pinch_off = self.tau_min.zip(cell.fate.t_end()).map_or(0.0, |(tau, t_end)| tau * t_end);
        law.lifetime(cell.volume_fraction) + pinch_off
    }
}

/// The number of cells at one time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Alive {
    /// Minutes from the origin of the clock.
    pub min: f64,
    /// Cells that were born by then and have not divided.
    pub cells: usize,
}

/// Largest number of intervals of [`alive`].
const INTERVALS: f64 = 100.0;

/// The number of cells alive over time, from the first birth to the last division, at multiples of 1, 2, 5, 10, … minutes, with at
/// most about a hundred values. Cells without daughters stay alive.
pub fn alive(times: &[CellTimes]) -> Vec<Alive> {
    let mut births: Vec<f64> = times.iter().map(|cell| cell.birth_min).collect();
    let mut divisions: Vec<f64> = times.iter().filter_map(|cell| cell.division_min).collect();
    births.sort_by(f64::total_cmp);
    divisions.sort_by(f64::total_cmp);
    let Some(first) = births.first() else { return Vec::new() };
    let last = divisions.last().unwrap_or(first);
    let step = round_step((last - first) / INTERVALS);
    let count = ((last / step).ceil() - (first / step).ceil()).clamp(0.0, 2.0 * INTERVALS) as usize;
    let by = |sorted: &[f64], min: f64| sorted.partition_point(|time| *time <= min);
    let at = |k: usize| {
        let min = ((first / step).ceil() + k as f64) * step;
        Alive { min, cells: by(&births, min) - by(&divisions, min) }
    };
    (0..=count).map(at).collect()
}

/// The smallest of 1, 2, 5, 10, 20, … that is not below a number.
fn round_step(least: f64) -> f64 {
    let decade = 10_f64.powf(least.max(1.0).log10().floor());
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|k| k * decade).find(|step| *step >= least).unwrap_or(10.0 * decade)
}

/// The time in minutes of the last division among each founder and its descendants, in the order of the lineage's founders;
/// `None` if neither the founder nor a descendant divides.
pub fn last_divisions(tree: &Tree, times: &[CellTimes]) -> Vec<Option<f64>> {
    last_times(tree, times).into_iter().map(|last| last?.division_min).collect()
}

/// The times of the cells of [`last_divisions`].
pub fn last_times(tree: &Tree, times: &[CellTimes]) -> Vec<Option<CellTimes>> {
    let mut last: Vec<Option<CellTimes>> = vec![None; tree.len()];
    let later = |a: CellTimes, b: CellTimes| if b.division_min > a.division_min { b } else { a };
    // In reverse order daughters precede their mothers.
    for id in tree.cells().rev() {
        let below = tree.daughters(id).into_iter().flatten().map(|daughter| last[daughter.index()]);
        let own = Some(times[id.index()]).filter(|times| times.division_min.is_some());
        last[id.index()] = below.flatten().chain(own).reduce(later);
    }
    (0..tree.lineage.founders.len()).map(|k| tree.founder_cell(k).and_then(|id| last[id.index()])).collect()
}
