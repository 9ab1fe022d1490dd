//! Warnings about a lineage's first cell and about a grown tree, one sentence each.

use super::definition::{Lineage, matches};
use super::founder::Daughter;
use super::tree::{CellId, TerminalReason, Tree, TreeCell};
use super::units::{Length, size_doubt};
use furrow_cell::Cell;
use furrow_input::rounded_number;
use furrow_mechanics::division::Outcome;
use furrow_mechanics::polarity::resolved;

/// Largest number of undecided cells with a sentence of their own.
const MOST_UNDECIDED: usize = 5;

impl Lineage {
    /// A warning about the size of the first cell. `given` is a radius that replaces the lineage's; `of_run` is the default radius, in L_h.
    /// There is no warning if the file's [radii](Self::doubtful_radii) have their own.
    pub fn first_size_doubt(&self, given: Option<Length>, of_run: f64) -> Option<String> {
        if !self.doubtful_radii().is_empty() {
            return None;
        }
        let of_lineage = self.founders[self.first()].r0;
        size_doubt(given.or(of_lineage).unwrap_or(Length::Natural(of_run)), &self.units())
    }

    /// Says which founders get a cue, as users write it, in a lineage without cues; `cell` has the law of all cells.
    pub fn who_gets(&self, cue: &str, cell: &Cell) -> Option<String> {
        let is_none = cue == "none" || cue.ends_with("=none");
        if is_none || !self.is_without_cues() {
            return None;
        }
        let names: Vec<&str> =
            self.smaller_line().iter().map(|&founder| self.founders[founder].name.as_str()).collect();
        let others = if cell.law_reads_regulator() {
            "; the others have its regulator, without a source that tells one pole from the other"
        } else {
            ""
        };
        Some(format!(
            "no founder of the lineage has a cue: {cue} is given to {}, and to descendants up to the next founder{others}",
            names.join(", ")
        ))
    }
}

impl Tree {
    /// Doubts about the tree: cells that are undecided, cells that die according to the lineage but are not born, a law that names
    /// a regulator which cells lack, a cue that does not act, a larger daughter that is the smaller one, and an origin of the clock that
    /// does not take place.
    pub fn doubts(&self) -> Vec<String> {
        let mut doubts = self.undecided();
        let born = |pattern: &&String| self.cells().any(|id| matches(pattern, &self.cell(id).name));
        let unborn = self.lineage.dies.iter().filter(|pattern| !born(pattern));
        doubts.extend(unborn.map(|pattern| format!("dies: the tree has no cell {pattern:?}")));
        doubts.extend(self.lacks_regulator());
        doubts.extend(self.idle_cues());
        doubts.extend(self.smaller_than_sisters());
        doubts.extend(self.other_origin());
        doubts
    }

    /// Says which cues follow a PAR polarity that the largest of their cells does not have. To save time it is looked for only where the
    /// outcome does not show that the cue acts.
    fn idle_cues(&self) -> impl Iterator<Item = String> + '_ {
        let mut largest: Vec<CellId> = Vec::new();
        for id in self.cells().filter(|id| self.cell(*id).cue.follows_par()) {
            let cell = self.cell(id);
            match largest.iter_mut().find(|other| self.cell(**other).cue == cell.cue) {
                Some(other) if cell.r0 > self.cell(*other).r0 => *other = id,
                Some(_) => {}
                None => largest.push(id),
            }
        }
        largest.into_iter().filter_map(|id| {
            let TreeCell { name, r0, cue, fate, .. } = self.cell(id);
            let is_idle = fate.outcome() != Some(Outcome::Asymmetric)
                && resolved(&self.parameters(id)).is_ok_and(|resolved| resolved.cue.is_none());
            let r0 = rounded_number(*r0, 4);
            is_idle.then(|| {
                format!("the cue {cue} does not act in {name} (R0 = {r0}), the largest cell that has it: the cell has no PAR polarity")
            })
        })
    }

    /// Says which founders are the larger daughter by the lineage, but smaller than their sister, by a radius of their own.
    fn smaller_than_sisters(&self) -> impl Iterator<Item = String> + '_ {
        self.lineage.founders.iter().enumerate().filter_map(|(k, founder)| {
            let larger = self.founder_cell(k).filter(|_| founder.daughter == Some(Daughter::Larger))?;
            let pair = self.daughters(self.mother(larger)?)?;
            let smaller = pair.into_iter().find(|id| *id != larger)?;
            let [(of_larger, large), (of_smaller, small)] =
                [larger, smaller].map(|id| self.cell(id)).map(|cell| (&cell.name, cell.r0));
            let [shown_large, shown_small] = [large, small].map(|r0| rounded_number(r0, 4));
            (large < small).then(|| {
                format!("{of_larger} is the larger daughter by the lineage, but its R0 = {shown_large} is below the {shown_small} of {of_smaller}")
            })
        })
    }

    /// The number of divisions with a second neck.
    pub(crate) fn three_parts(&self) -> usize {
        let divisions = self.cells().filter_map(|id| self.cell(id).fate.division());
        divisions.filter(|division| division.second_neck.is_some()).count()
    }

    /// The undecided cells. Their branches end there; the rest of the tree is valid.
    fn undecided(&self) -> Vec<String> {
        let undecided = self.cells().map(|id| self.cell(id)).filter_map(|cell| match cell.fate.terminal_reason() {
            Some(TerminalReason::Undecided { why }) => Some((cell, why)),
            _ => None,
        });
        let sentence = |(cell, why): (&TreeCell, &String)| {
            let (name, r0) = (&cell.name, rounded_number(cell.r0, 7));
            format!("cell {name} (R0 = {r0}) is undecided, and its branch ends there: {why}")
        };
        let mut sentences: Vec<String> = undecided.take(MOST_UNDECIDED + 1).map(sentence).collect();
        if sentences.len() > MOST_UNDECIDED {
            sentences[MOST_UNDECIDED] = "further cells are undecided: see tree.json".to_owned();
        }
        sentences
    }

    /// Says that the event at minute 0 of the clock does not take place, unless the tree has only one cell.
    fn other_origin(&self) -> Option<String> {
        let wanted = self.lineage.clock.as_ref()?.origin.as_ref()?;
        let origin = self.time_origin()?;
        (*wanted != origin && self.len() > 1)
            .then(|| format!("the {wanted}, minute 0 of the clock, does not take place: minutes are from the {origin}"))
    }
}
