//! Counts over a whole tree.

use furrow_lineage::Tree;
use furrow_mechanics::division::Outcome;
use std::collections::BTreeMap;

/// One generation of a tree.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Generation {
    /// Cells born.
    pub cells: usize,
    /// Cells that divided symmetrically.
    pub symmetric: usize,
    /// Cells that divided asymmetrically.
    pub asymmetric: usize,
    /// Cells that did not divide.
    pub ended: usize,
    /// Smallest and largest R0.
    pub r0: [f64; 2],
}

/// Counts over a whole tree.
#[derive(Clone, Debug, PartialEq)]
pub struct TreeSummary {
    /// By generation from the first cell.
    pub generations: Vec<Generation>,
    /// Cells without daughters, by the name of the reason.
    pub ended: BTreeMap<&'static str, usize>,
    /// Cells just above a threshold of division; their long wait there was skipped.
    pub slow: usize,
}

impl TreeSummary {
    /// Counts the cells of `tree`.
    pub fn of(tree: &Tree) -> TreeSummary {
        let mut generations: Vec<Generation> = vec![];
        let (mut ended, mut slow) = (BTreeMap::new(), 0);
        for id in tree.cells() {
            let cell = tree.cell(id);
            let g = cell.generation as usize;
            if generations.len() <= g {
                generations.resize(g + 1, Generation { r0: [f64::INFINITY, 0.0], ..Generation::default() });
            }
            let row = &mut generations[g];
            row.cells += 1;
            row.r0 = [row.r0[0].min(cell.r0), row.r0[1].max(cell.r0)];
            slow += usize::from(cell.fate.division().is_some_and(|d| d.slow_growth_rate.is_some()));
            match (cell.fate.terminal_reason(), cell.fate.outcome()) {
                (Some(reason), _) => {
                    row.ended += 1;
                    *ended.entry(reason.name()).or_insert(0) += 1;
                }
                (None, Some(Outcome::Symmetric)) => row.symmetric += 1,
                _ => row.asymmetric += 1,
            }
        }
        TreeSummary { generations, ended, slow }
    }

    /// Whether some branch was stopped by a limit instead of the mechanics.
    pub fn limited(&self) -> bool {
        self.ended.contains_key("max_depth") || self.ended.contains_key("max_cells")
    }

    /// Why branches end, in words.
    pub(crate) fn ended_text(&self) -> String {
        let words = |name: &str| match name {
            "at_rest" => "at rest undivided",
            "below_pitchfork" => "below the pitchfork boundary",
            "below_cued_fold" => "below the cued fold",
            "below_bent_boundary" => "below the boundary of bent states",
            "undecided" => "undecided",
            "dies" => "dead by the lineage file",
            "most_rounds" => "after most_rounds",
            "max_depth" => "stopped by max_depth",
            _ => "stopped by max_cells",
        };
        let parts: Vec<String> = self.ended.iter().map(|(name, n)| format!("{n} {}", words(name))).collect();
        parts.join(", ")
    }
}
