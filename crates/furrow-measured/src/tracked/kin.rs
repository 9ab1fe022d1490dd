//! Links that contradict names, and the births of sisters.
//!
//! The names of the lineage's cells determine their mothers. Links that contradict the names are dropped and reported.

use std::collections::{HashMap, HashSet};

use super::{Format, TrackedCell, TrackedLineage};
use crate::names::Names;
use crate::volumes::note;

/// What reports call the first time of a cell.
fn column_of_times(cell: &str) -> String {
    format!("first time of {cell}")
}

impl TrackedLineage {
    /// Leaves out the links that contradict names of the lineage's cells. Cells that lose a mother or a daughter by it are linked by their
    /// names, where these fit.
    pub(crate) fn follow_names(&mut self, names: &Names) {
        self.join_namesakes(names);
        let lost = self.leave_out_contradictions(names);
        self.link_by_names(names, &lost);
    }

    /// Whether a cell has a name of the lineage. A number is rather a label.
    fn is_named(&self, cell: usize, names: &Names) -> bool {
        let name = &self.cells[cell].name;
        names.has(name) && !name.bytes().all(|byte| byte.is_ascii_digit())
    }

    /// Reports a link to a cell.
    fn report_link(&mut self, cell: usize, why: &str) {
        let TrackedLineage { cells, skipped, skipped_count, .. } = self;
        note(skipped, skipped_count, || cells[cell].unused(why));
    }

    /// Withdraws the report of a cell's first time: the link that it is about is left out.
    fn forget_times(&mut self, cell: usize) {
        let TrackedCell { name, place: (file, line), .. } = &self.cells[cell];
        let (column, before) = (column_of_times(name), self.skipped.len());
        self.skipped.retain(|report| (&report.file, report.line, &report.column) != (file, *line, &column));
        self.skipped_count -= (before - self.skipped.len()) as u64;
    }

    /// Takes a cell from its mother.
    fn part_from_mother(&mut self, cell: usize) {
        let Some(mother) = self.cells[cell].mother.take() else { return };
        self.cells[cell].birth = self.cells[cell].first;
        self.cells[mother].daughters.retain(|daughter| *daughter != cell);
        self.be_born_together(mother);
    }

    /// Sisters are born at one division, when the first of them is seen.
    fn be_born_together(&mut self, mother: usize) {
        let daughters = self.cells[mother].daughters.clone();
        let born = daughters.iter().map(|daughter| self.cells[*daughter].first).reduce(f64::min);
        self.cells[mother].division = born;
        for daughter in daughters {
            self.cells[daughter].birth = born.unwrap_or(self.cells[daughter].birth);
        }
    }

    /// Joins each cell with a daughter of the same name: by name they are one cell. Her sister is left without a mother.
    fn join_namesakes(&mut self, names: &Names) {
        let mut one_with: HashMap<usize, usize> = HashMap::new();
        for cell in 0..self.cells.len() {
            if one_with.contains_key(&cell) || !self.is_named(cell, names) {
                continue;
            }
            while let Some(same) = self.namesake_below(cell, names) {
                for sister in self.cells[cell].daughters.clone().into_iter().filter(|daughter| *daughter != same) {
                    let name = self.cells[cell].name.clone();
                    let why = format!("it branches off {name}, which goes on by its name: it is left without a mother");
                    self.report_link(sister, &why);
                    self.part_from_mother(sister);
                }
                self.join(cell, same);
                one_with.insert(same, cell);
            }
        }
        if !one_with.is_empty() {
            self.remove(&one_with);
        }
    }

    /// The daughter of a cell with the same name; of two the one that was followed further. Where the other one has the name of a daughter
    /// the division is real, and the name of the first is wrong.
    fn namesake_below(&self, cell: usize, names: &Names) -> Option<usize> {
        let TrackedCell { name, daughters, .. } = &self.cells[cell];
        let is_real =
            |daughter: &usize| names.birth(&self.cells[*daughter].name).is_some_and(|(mother, ..)| mother == name);
        if daughters.iter().any(is_real) {
            return None;
        }
        let alike = daughters.iter().copied().filter(|daughter| self.cells[*daughter].name == *name);
        let further = |cell: usize| (!self.cells[cell].daughters.is_empty(), self.cells[cell].last);
        alike.reduce(|one, other| if further(other) > further(one) { other } else { one })
    }

    /// Makes a daughter a part of her mother.
    fn join(&mut self, cell: usize, daughter: usize) {
        let below = self.cells[daughter].clone();
        below.daughters.iter().for_each(|next| self.cells[*next].mother = Some(cell));
        let own = &mut self.cells[cell];
        let sum = |cell: &TrackedCell| cell.volume.unwrap_or(0.0) * cell.sizes as f64;
        let (volumes, sizes) = (sum(own) + sum(&below), own.sizes + below.sizes);
        own.volume = (sizes > 0).then(|| volumes / sizes as f64);
        (own.sizes, own.last, own.division, own.daughters) = (sizes, below.last, below.division, below.daughters);
    }

    /// Removes cells that are parts of others.
    fn remove(&mut self, one_with: &HashMap<usize, usize>) {
        let mut places = Vec::with_capacity(self.cells.len());
        let mut count = 0;
        for cell in 0..self.cells.len() {
            // A mother comes before her daughters.
            let place = one_with.get(&cell).map_or(count, |mother| places[*mother]);
            count += usize::from(!one_with.contains_key(&cell));
            places.push(place);
        }
        let cells = std::mem::take(&mut self.cells).into_iter().enumerate();
        self.cells = cells.filter(|(k, _)| !one_with.contains_key(k)).map(|(_, cell)| cell).collect();
        for cell in &mut self.cells {
            cell.mother = cell.mother.map(|mother| places[mother]);
            cell.daughters.iter_mut().for_each(|daughter| *daughter = places[*daughter]);
        }
        self.spots.values_mut().flatten().for_each(|cell| *cell = places[*cell]);
    }

    /// Leaves out links from a cell to one that by its name has another mother. Returns the cells that lost one.
    fn leave_out_contradictions(&mut self, names: &Names) -> HashSet<usize> {
        let mut lost = HashSet::new();
        for cell in 0..self.cells.len() {
            let Some(mother) = self.cells[cell].mother.filter(|mother| self.is_named(*mother, names)) else { continue };
            let by_name = names.birth(&self.cells[cell].name).map(|(mother, ..)| mother.to_owned());
            if !self.is_named(cell, names) || by_name.as_ref() == Some(&self.cells[mother].name) {
                continue;
            }
            let own = by_name.map_or("no mother".to_owned(), |mother| format!("the mother {mother}"));
            self.forget_times(cell);
            let TrackedCell { name, place: (_, line), .. } = &self.cells[mother];
            let at = if *line > 0 { format!(" (line {line})") } else { String::new() };
            let why = format!("a link makes it a daughter of {name}{at}, and by its name it has {own}: names are used");
            self.report_link(cell, &why);
            self.part_from_mother(cell);
            lost.extend([cell, mother]);
        }
        lost
    }

    /// Links cells to the mothers that their names give, where the mother was seen in the frame before, and either of them lost a link or
    /// the format has no links.
    fn link_by_names(&mut self, names: &Names, lost: &HashSet<usize>) {
        let has_links = self.format != Format::CdTable;
        if has_links && lost.is_empty() {
            return;
        }
        let named = |cell: &TrackedCell| names.understood(&self.name, &cell.name).unwrap_or_else(|| cell.name.clone());
        let of_cells: Vec<String> = self.cells.iter().map(named).collect();
        let mut places: HashMap<&str, usize> = HashMap::new();
        for (k, name) in of_cells.iter().enumerate() {
            places.entry(name).or_insert(k);
        }
        for (cell, name) in of_cells.iter().enumerate() {
            let TrackedCell { mother: None, birth, .. } = &self.cells[cell] else { continue };
            let by_name = names.birth(name).and_then(|(mother, ..)| places.get(mother).copied());
            // Mothers come before their daughters.
            let Some(mother) = by_name.filter(|mother| *mother < cell && places.get(name.as_str()) == Some(&cell))
            else {
                continue;
            };
            let TrackedCell { last, daughters, .. } = &self.cells[mother];
            let is_next = *last < *birth && *birth - *last < 1.5 * self.frame;
            let is_free = is_next && daughters.len() < 2;
            if is_free && (!has_links || lost.contains(&cell) || lost.contains(&mother)) {
                self.cells[cell].mother = Some(mother);
                self.cells[mother].daughters.push(cell);
                self.be_born_together(mother);
            }
        }
    }

    /// Makes sisters be born together, and reports those that were found late. `next` gives the time of the frame after a time.
    pub(super) fn join_births(&mut self, next: impl Fn(f64) -> f64) {
        for mother in 0..self.cells.len() {
            let TrackedCell { division: Some(born), last, daughters, .. } = self.cells[mother].clone() else {
                continue;
            };
            for daughter in &daughters {
                let seen = self.cells[*daughter].birth;
                if seen <= born {
                    continue;
                }
                self.report_time(
                    *daughter,
                    seen,
                    &format!("its sister is seen from time {born} on: both are born then"),
                );
            }
            if let Some(daughter) = daughters.first().filter(|_| born > next(last)) {
                let why = format!("its mother was seen last at time {last}: the division may be earlier");
                self.report_time(*daughter, born, &why);
            }
            self.be_born_together(mother);
        }
    }

    /// Reports the time of a cell's first spot.
    fn report_time(&mut self, cell: usize, seen: f64, why: &str) {
        let TrackedLineage { cells, skipped, skipped_count, .. } = self;
        let (column, value) = (column_of_times(&cells[cell].name), seen.to_string());
        note(skipped, skipped_count, || crate::volumes::Skipped { column, value, ..cells[cell].unused(why) });
    }
}
