//! Matches the cells of a tracked embryo to the cells of the lineage, from roots down.

use std::sync::atomic::Ordering;

use furrow_input::{InputError, listed, shown};

use super::order::Lives;
use super::report::{By, Matched, MatchedDivision, MatchedRoot, NEARLY_EQUAL, Unmatched};
use super::{Matching, Root};
use crate::names::Names;
use crate::tracked::{Place, TrackedCell, TrackedLineage};

impl TrackedLineage {
    /// Leaves out links that contradict names of the lineage's cells, then gives cells the names that the matching of `names` finds for
    /// them, and notes how. Other cells keep their names.
    ///
    /// # Errors
    /// A tracked name of several cells, two names of one cell, or a root without its tracked name where several cells have no mother.
    pub fn match_names(&mut self, names: &Names) -> Result<(), InputError> {
        self.follow_names(names);
        let Some(matching) = names.matching() else { return Ok(()) };
        matching.note_skipped(self);
        let mut found = Search::of(self, names, matching)?;
        found.name_by_table()?;
        found.name_roots()?;
        found.name_below();
        let Search { given, mut matched, .. } = found;
        for (cell, name) in self.cells.iter_mut().zip(given) {
            if let Some(name) = name {
                cell.name = name;
            }
        }
        matched.without_name = self.cells.iter().filter(|cell| !names.is_cell(&cell.name)).count();
        self.matched = Some(matched);
        Ok(())
    }
}

/// Generations that were followed below each cell; daughters come after their mothers.
fn generations(embryo: &TrackedLineage) -> Vec<u32> {
    let mut below = vec![0; embryo.cells.len()];
    for (cell, TrackedCell { daughters, .. }) in embryo.cells.iter().enumerate().rev() {
        below[cell] = daughters.iter().map(|daughter| below[*daughter] + 1).max().unwrap_or(0);
    }
    below
}

struct Search<'a> {
    embryo: &'a TrackedLineage,
    names: &'a Names,
    matching: &'a Matching,
    /// Names in the lineage of the cells that have one.
    given: Vec<Option<String>>,
    /// Whether a cell is a root or below one.
    reached: Vec<bool>,
    /// Generations that were followed below each cell.
    generations: Vec<u32>,
    lives: Lives<'a>,
    matched: Matched,
}

impl<'a> Search<'a> {
    fn of(embryo: &'a TrackedLineage, names: &'a Names, matching: &'a Matching) -> Result<Search<'a>, InputError> {
        let own = |cell: &TrackedCell| names.has(&cell.name).then(|| cell.name.clone());
        let given = embryo.cells.iter().map(own).collect();
        let (reached, matched) =
            (vec![false; embryo.cells.len()], Matched { embryo: embryo.name.clone(), ..Matched::default() });
        let (generations, lives) = (generations(embryo), Lives::of(names)?);
        Ok(Search { embryo, names, matching, given, reached, generations, lives, matched })
    }

    /// A cell's name in the file of the tracking program.
    fn tracked(&self, cell: usize) -> String {
        self.embryo.cells[cell].name.clone()
    }

    fn name_by_table(&mut self) -> Result<(), InputError> {
        let map = &self.matching.map;
        map.meet(&self.embryo.name);
        let mut lines: Vec<Option<&str>> = vec![None; self.embryo.cells.len()];
        // Rows of this embryo come before rows of any.
        for any in [false, true] {
            for row in
                map.rows.iter().filter(|row| row.embryo.is_empty() == any && (any || row.embryo == self.embryo.name))
            {
                let cell = match self.embryo.place_of(&row.tracked) {
                    Place::Nowhere => continue,
                    Place::Cell(cell) => cell,
                    Place::Several => {
                        let why = format!(
                            "tracked = {}: several cells of {} have this name",
                            shown(&row.tracked),
                            self.embryo.name
                        );
                        return Err(map.refused(row, why));
                    }
                };
                row.meet();
                if let Some(before) = lines[cell].replace(&row.tracked) {
                    let why = format!("{} and {} are the same cell", shown(before), shown(&row.tracked));
                    return Err(map.refused(row, why));
                }
                self.given[cell] = Some(row.name.clone());
                self.matched.by_table += 1;
            }
        }
        Ok(())
    }

    fn name_roots(&mut self) -> Result<(), InputError> {
        let refused = |value: &str, allowed: String| {
            Err(InputError::not_allowed(&self.matching.source, "root", format!("{value:?}"), allowed))
        };
        let mut roots = Vec::new();
        for Root { tracked, name, met } in &self.matching.roots {
            let cell = match tracked.as_deref().map(|tracked| (tracked, self.embryo.place_of(tracked))) {
                Some((_, Place::Cell(cell))) => cell,
                Some((_, Place::Nowhere)) => continue,
                Some((tracked, Place::Several)) => {
                    return refused(tracked, format!("of one cell; several cells of {} have it", self.embryo.name));
                }
                None => match &self.first_cells()[..] {
                    [one] => *one,
                    several => {
                        let shown: Vec<String> = several.iter().map(|cell| self.shown_first(*cell)).collect();
                        let those = listed(shown.iter().map(String::as_str), ", ");
                        let of = &self.embryo.name;
                        return refused(
                            name,
                            format!("TRACKED={name} with one of the cells of {of} that have no mother: {those}"),
                        );
                    }
                },
            };
            met.store(true, Ordering::Relaxed);
            roots.push((cell, name.clone()));
        }
        for (cell, name) in roots {
            self.matched.roots.push(MatchedRoot { tracked: self.tracked(cell), name: name.clone() });
            self.given[cell] = Some(name);
            self.reached[cell] = true;
        }
        Ok(())
    }

    /// The cells without a mother; those that divide, if there are any.
    fn first_cells(&self) -> Vec<usize> {
        let cells = &self.embryo.cells;
        let first: Vec<usize> = (0..cells.len()).filter(|cell| cells[*cell].mother.is_none()).collect();
        let divide: Vec<usize> = first.iter().copied().filter(|cell| !cells[*cell].daughters.is_empty()).collect();
        if divide.is_empty() { first } else { divide }
    }

    /// A cell without a mother, with the number of its descendants.
    fn shown_first(&self, first: usize) -> String {
        let cells = &self.embryo.cells;
        let (mut count, mut left) = (0, vec![first]);
        while let Some(cell) = left.pop() {
            count += cells[cell].daughters.len();
            left.extend(&cells[cell].daughters);
        }
        format!("{} ({count} descendants)", self.handle(first))
    }

    /// A unique name of a cell: its own name, or the name or id of one of its spots.
    fn handle(&self, cell: usize) -> &str {
        let embryo = self.embryo;
        let is_own = |text: &str| embryo.place_of(text) == Place::Cell(cell);
        let name = embryo.cells[cell].name.as_str();
        if is_own(name) {
            return name;
        }
        let spots = embryo.spots.iter().filter(|(text, of)| **of == Some(cell) && is_own(text));
        spots.map(|(text, _)| text.as_str()).min().unwrap_or(name)
    }

    /// Names the daughters of each cell below a root; mothers come before daughters.
    fn name_below(&mut self) {
        for cell in 0..self.embryo.cells.len() {
            let (true, Some(mother)) = (self.reached[cell], self.given[cell].clone()) else { continue };
            let tracked = self.tracked(cell);
            let named = match self.embryo.cells[cell].daughters[..] {
                [] => continue,
                [_] => Err("only one daughter was followed, so it is not known which".to_owned()),
                [one, other, ..] => self.named_daughters(&mother, [one, other]),
            };
            match named {
                Ok((daughters, cells, by)) => {
                    for (cell, name) in cells.into_iter().zip(&daughters) {
                        self.given[cell] = Some(name.clone());
                        self.reached[cell] = true;
                    }
                    let chi = self.volumes(cells).map(|[a, b]| (a - b).abs() / (a + b));
                    let tracked_daughters = cells.map(|cell| self.tracked(cell));
                    let division = MatchedDivision { mother, tracked, daughters, tracked_daughters, by, chi };
                    self.matched.divisions.push(division);
                }
                Err(why) => self.matched.unmatched.push(Unmatched { mother, tracked, why }),
            }
        }
    }

    /// The names of a mother's daughters, the cells that get them, and what decided.
    fn named_daughters(&self, mother: &str, [one, other]: [usize; 2]) -> Result<([String; 2], [usize; 2], By), String> {
        let Some(daughters) = self.names.daughters(mother) else {
            return Err("the lineage has no names for them".to_owned());
        };
        let ordered = |is_turned: bool| if is_turned { [other, one] } else { [one, other] };
        let known = [one, other].map(|cell| self.given[cell].as_deref());
        let of = |name: Option<&str>| name.map(|name| daughters.iter().position(|daughter| daughter == name));
        let (cells, by) = match known.map(of) {
            [None, None] => self.by_looks(&daughters, [one, other])?,
            [Some(Some(first)), None] => (ordered(first == 1), By::Names),
            [None, Some(Some(second))] => (ordered(second == 0), By::Names),
            [Some(Some(first)), Some(Some(second))] if first != second => (ordered(first == 1), By::Names),
            _ => {
                let shown = known.map(|name| name.unwrap_or("without a name"));
                return Err(format!("they are {} and {}, not {}", shown[0], shown[1], daughters.join(" and ")));
            }
        };
        Ok((daughters, cells, by))
    }

    /// Two sisters without names, in the order of the names.
    fn by_looks(&self, daughters: &[String; 2], sisters: [usize; 2]) -> Result<([usize; 2], By), String> {
        let [one, other] = sisters;
        let ordered = |is_turned: bool| if is_turned { [other, one] } else { sisters };
        let volumes = self.volumes(sisters);
        let is_unequal = volumes.is_some_and(|[a, b]| (a - b).abs() >= NEARLY_EQUAL * (a + b));
        let by_sizes = volumes.filter(|[a, b]| a != b).map(|[a, b]| (ordered(a < b), By::Sizes));
        if let Some(found) = by_sizes.filter(|_| is_unequal) {
            return Ok(found);
        }
        if let Some((named, seen)) = self.lives.first(daughters).zip(self.first_to_divide(sisters)) {
            return Ok((ordered(named != seen), By::Divisions));
        }
        let listed = [0, 1].map(|k| self.names.listed_generations(&daughters[k]));
        let divides = |place: usize| self.alone_divides(sisters[place], sisters[1 - place], listed[0].max(listed[1]));
        if let (true, Some(seen)) = (listed[0] != listed[1], [0, 1].into_iter().find(|place| divides(*place))) {
            return Ok((ordered((listed[1] > listed[0]) != (seen == 1)), By::Descendants));
        }
        if let Some(found) = by_sizes {
            return Ok(found);
        }
        // Founders differ in more than the order of their letters.
        if daughters.iter().any(|name| self.names.founder(name) == Some(name.as_str())) {
            let [first, second] = daughters;
            return Err(format!(
                "sizes and divisions do not show which is {first} and which is {second}: a table of names (--names) can"
            ));
        }
        Ok((self.in_file(sisters), By::Order))
    }

    /// The place of the sister that was seen to divide before the other one, which was followed at least until then.
    fn first_to_divide(&self, sisters: [usize; 2]) -> Option<usize> {
        let [one, other] = sisters.map(|cell| &self.embryo.cells[cell]);
        match (one.division, other.division) {
            (Some(a), Some(b)) if a != b => Some(usize::from(b < a)),
            (Some(a), None) if other.last >= a => Some(0),
            (None, Some(b)) if one.last >= b => Some(1),
            _ => None,
        }
    }

    /// Whether a cell has this many generations below it, at least two, while its sister was followed and did not divide.
    fn alone_divides(&self, cell: usize, sister: usize, generations: u32) -> bool {
        let cells = &self.embryo.cells;
        let needed = generations.max(2);
        if self.generations[cell] < needed || !cells[sister].daughters.is_empty() {
            return false;
        }
        let mut below = vec![cell];
        for _ in 0..needed {
            below = below.into_iter().flat_map(|cell| cells[cell].daughters.iter().copied()).collect();
        }
        below.into_iter().any(|cell| cells[cell].birth <= cells[sister].last)
    }

    /// The cells in the order of the file.
    fn in_file(&self, [one, other]: [usize; 2]) -> [usize; 2] {
        let line = |cell: usize| (&self.embryo.cells[cell].place, cell);
        if line(one) <= line(other) { [one, other] } else { [other, one] }
    }

    fn volumes(&self, [one, other]: [usize; 2]) -> Option<[f64; 2]> {
        Some([self.embryo.cells[one].volume?, self.embryo.cells[other].volume?])
    }
}
