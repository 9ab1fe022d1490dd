//! Rounds of division in a followed embryo.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use serde::Serialize;

use super::{TrackedCell, TrackedLineage};
use crate::names::Names;
use crate::volumes::{Skipped, note};

/// Divisions from a cell to its last descendants that were followed.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackedRounds {
    /// The cell.
    pub cell: String,
    /// Its last descendants: the cells that were not seen to divide.
    pub terminal: u32,
    /// Fewest divisions to one of them.
    pub min: u32,
    /// Their mean.
    pub mean: f64,
    /// Most.
    pub max: u32,
}

/// A founder without rounds.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Absent {
    /// The founder.
    pub founder: String,
    /// Why its rounds are not known.
    pub why: String,
}

/// Rounds of division of an embryo that was followed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FollowedRounds {
    /// Of the founders.
    pub founders: Vec<TrackedRounds>,
    /// The founders without rounds.
    pub absent: Vec<Absent>,
    /// Terminal cells of the embryo: those with a name, and those below a cell with a name.
    pub terminal: u32,
    /// Cells that were not followed although their sisters were: each counts as one terminal cell.
    pub not_followed: Vec<String>,
}

impl TrackedLineage {
    /// Rounds of these founders, and the reason for each founder without rounds. A founder that divided before the recording began has
    /// its daughters' rounds and one more. A daughter that was not followed counts as a terminal cell if her sister was followed: the
    /// division was seen, and she may have divided further. Of several cells of one name the first is used.
    pub fn rounds(&self, founders: &[&str], names: &Names) -> FollowedRounds {
        let Counted { known, lost } = self.counted(names);
        let mut found = FollowedRounds::default();
        for founder in founders {
            let cell = (*founder).to_owned();
            if let Some(DivisionCounts { terminal, sum, min, max }) = known.get(*founder).copied() {
                let mean = sum as f64 / f64::from(terminal);
                found.founders.push(TrackedRounds { cell, terminal, min, mean, max });
                continue;
            }
            let mut daughters: Vec<&String> =
                known.keys().filter(|name| names.birth(name).is_some_and(|(mother, ..)| mother == *founder)).collect();
            daughters.sort();
            let why = match daughters.first() {
                Some(only) => format!("it was not followed, and of its daughters only {only}"),
                None => "neither it nor its daughters were followed".to_owned(),
            };
            found.absent.push(Absent { founder: cell, why });
        }
        let (tops, below_them) = self.tops(names, &known);
        found.terminal = tops.iter().filter_map(|top| known.get(top)).map(|counts| counts.terminal).sum();
        found.not_followed = lost.into_iter().filter(|(cell, _)| below_them[*cell]).map(|(_, name)| name).collect();
        found
    }

    /// The topmost names, from which all other cells with a name descend, and for each cell whether it has a name or descends from one
    /// that has.
    fn tops(&self, names: &Names, known: &HashMap<String, DivisionCounts>) -> (BTreeSet<String>, Vec<bool>) {
        let (mut tops, mut below_them) = (BTreeSet::new(), Vec::with_capacity(self.cells.len()));
        for cell in &self.cells {
            let is_below = cell.mother.is_some_and(|mother| below_them[mother]);
            let is_named = names.is_cell(&cell.name);
            if is_named && !is_below {
                let mothers = std::iter::successors(Some(cell.name.as_str()), |name| {
                    names.birth(name).map(|(mother, ..)| mother).filter(|mother| known.contains_key(*mother))
                });
                tops.extend(mothers.last().map(str::to_owned));
            }
            below_them.push(is_below || is_named);
        }
        (tops, below_them)
    }

    /// Divisions below the cells of each name. A mother who was not followed is added if both her daughters are known. A cell without a
    /// known mother belongs to the mother that its name gives.
    fn counted(&self, names: &Names) -> Counted {
        let mut below = vec![DivisionCounts::ONE; self.cells.len()];
        let (mut known, mut lost, mut orphans) = (HashMap::new(), Vec::new(), Orphans::new());
        // Daughters come after their mothers.
        for (index, cell) in self.cells.iter().enumerate().rev() {
            let mut daughters: Vec<(&str, DivisionCounts)> =
                cell.daughters.iter().map(|daughter| (self.cells[*daughter].name.as_str(), below[*daughter])).collect();
            for (name, counts) in orphans.get(&cell.name).into_iter().flatten() {
                if daughters.len() < 2 && daughters.iter().all(|(daughter, _)| daughter != name) {
                    daughters.push((name, *counts));
                }
            }
            if let [(only, _)] = daughters[..] {
                let sister = names.birth(only).filter(|(mother, ..)| *mother == cell.name).map(|(_, sister, _)| sister);
                lost.push((index, sister.unwrap_or_else(|| format!("the sister of {only}"))));
                daughters.push(("", DivisionCounts::ONE));
            }
            let both = daughters.into_iter().map(|(_, counts)| counts).reduce(DivisionCounts::merged);
            below[index] = both.map_or(DivisionCounts::ONE, DivisionCounts::of_mother);
            // The first cell of a name comes last.
            known.insert(cell.name.clone(), below[index]);
            if cell.mother.is_none() {
                add_orphan(&mut orphans, &mut known, (cell.name.clone(), below[index]), names);
            }
        }
        let is_followed: HashSet<&str> = self.cells.iter().map(|cell| cell.name.as_str()).collect();
        lost.retain(|(_, name)| !is_followed.contains(name.as_str()));
        lost.reverse();
        Counted { known, lost }
    }

    /// What could not be used, the cells without a name, and the cells with a name that another one has: the first of them, and how many
    /// there are.
    pub fn skipped_with_names(&self, names: &Names) -> (Vec<Skipped>, u64) {
        let (mut skipped, mut count) = (self.skipped.clone(), self.skipped_count);
        let mut first: HashMap<&str, &TrackedCell> = HashMap::new();
        for cell in &self.cells {
            if !names.is_cell(&cell.name) {
                note(&mut skipped, &mut count, || cell.unused(names.unknown()));
            } else if let Some(first) = first.get(cell.name.as_str()) {
                let why = format!("a second cell of this name; the first begins on line {}", first.place.1);
                note(&mut skipped, &mut count, || cell.unused(&why));
            } else {
                first.insert(&cell.name, cell);
            }
        }
        (skipped, count)
    }
}

/// Divisions below the cells of each name, and the names of the cells that were not followed, with the places of their mothers.
struct Counted {
    known: HashMap<String, DivisionCounts>,
    lost: Vec<(usize, String)>,
}

/// Cells without a known mother, under her name.
type Orphans = HashMap<String, BTreeMap<String, DivisionCounts>>;

/// Adds a cell without a known mother. If its sister is one too, their mother is added, and so on.
fn add_orphan(
    orphans: &mut Orphans,
    known: &mut HashMap<String, DivisionCounts>,
    (mut cell, mut counts): (String, DivisionCounts),
    names: &Names,
) {
    while let Some((mother, sister, _)) = names.birth(&cell) {
        let (mother, sisters) = (mother.to_owned(), orphans.entry(mother.to_owned()).or_default());
        sisters.insert(cell, counts);
        let Some(other) = sisters.get(&sister) else { return };
        counts = counts.merged(*other).of_mother();
        known.insert(mother.clone(), counts);
        cell = mother;
    }
}

/// Divisions from a cell to its last descendants: how many these are, and the sum, the least and the largest number.
#[derive(Clone, Copy)]
struct DivisionCounts {
    terminal: u32,
    sum: u64,
    min: u32,
    max: u32,
}

impl DivisionCounts {
    /// Of a cell that was not seen to divide.
    const ONE: DivisionCounts = DivisionCounts { terminal: 1, sum: 0, min: 0, max: 0 };

    /// The counts of two sisters together, from each of them.
    fn merged(self, other: DivisionCounts) -> DivisionCounts {
        DivisionCounts {
            terminal: self.terminal + other.terminal,
            sum: self.sum + other.sum,
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// The counts from their mother.
    fn of_mother(self) -> DivisionCounts {
        let DivisionCounts { terminal, sum, min, max } = self;
        DivisionCounts { terminal, sum: sum + u64::from(terminal), min: min + 1, max: max + 1 }
    }
}
