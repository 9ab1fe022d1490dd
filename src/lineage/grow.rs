//! Growth of a tree: volumes are handed down, every cell's division is solved as soon as its mother's is.

use super::definition::{Lineage, ListedDaughters};
use super::tree::{Cell, EndReason, Fate, Side, Tree, TreeSettings};
use crate::batch::{Failure, Job, Memo, SchedulerError, SchedulerOptions, Summary, scheduler};
use crate::cortex::Cue;
use crate::division::{Division, DivisionError, DivisionInput};
use petgraph::graph::NodeIndex;
use std::collections::VecDeque;

/// Why a tree could not be grown.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GrowError {
    /// A division could not be computed.
    #[error("cell {cell} (R0 = {r0}): {failure}{}", further(*.others))]
    Division {
        /// The cell.
        cell: String,
        /// Its radius R0.
        r0: f64,
        /// What went wrong.
        failure: Failure<DivisionError>,
        /// Further cells that have no result either.
        others: usize,
    },
    /// The workers could not be started.
    #[error(transparent)]
    Workers(SchedulerError<DivisionError>),
    /// Growth was interrupted.
    #[error("interrupted after {solved} divisions")]
    Interrupted {
        /// Divisions solved before; the memo knows them.
        solved: usize,
    },
}

fn further(others: usize) -> String {
    if others > 0 { format!(" ({others} further cells failed)") } else { String::new() }
}

/// What a tree is grown with.
pub struct Grower<'a> {
    /// Founders and rules.
    pub lineage: &'a Lineage,
    /// Parameters of all divisions.
    pub settings: TreeSettings,
    /// Ends branches ahead of their division; `&|_, _| None` leaves it to the dynamics.
    pub ends: &'a dyn Fn(f64, &Cue) -> Option<EndReason>,
    /// Remembers divisions.
    pub memo: &'a Memo<DivisionInput>,
    /// Threads, interruption, progress, order of work; for the last see [`expected_work`](super::expected_work).
    pub options: SchedulerOptions<'a, DivisionInput>,
}

/// A cell in the order of growth, which depends on timing.
#[derive(Clone, Copy, Debug)]
struct Young {
    mother: Option<usize>,
    side: Side,
    founder: usize,
    is_founder: bool,
    /// Rounds below the founder.
    round: u32,
    generation: u32,
    fraction: f64,
    r0: f64,
    cue: Cue,
    fate: Option<Fate>,
    /// The anterior daughter; the posterior one follows it.
    daughters: Option<usize>,
}

struct Nursery<'a> {
    grower: &'a Grower<'a>,
    listed: Vec<Option<ListedDaughters>>,
    cells: Vec<Young>,
}

impl Grower<'_> {
    /// Grows the tree, solving with `solve` (on the workers, with R0 quantised as the memo says) what the memo does not
    /// know. The tree depends on the inputs alone, whatever the number of threads and the state of the memo; the
    /// [`Summary`] tells the work done.
    ///
    /// # Errors
    /// A division that could not be computed, or interruption.
    pub fn grow<S>(&self, solve: S) -> Result<(Tree, Summary), GrowError>
    where
        S: Fn(&DivisionInput) -> Result<Division, DivisionError> + Sync,
    {
        let mut nursery = Nursery { grower: self, listed: self.lineage.daughters(), cells: vec![] };
        let first = self.first();
        nursery.cells.push(first);
        let roots = nursery.job(0).into_iter().collect();
        let max_cells = self.lineage.limits.max_cells;
        let summary = scheduler::run(roots, self.memo, &self.options, &solve, |cell, division| {
            // What lies beyond the limit is settled in the layout, in an order that timing has no part in.
            if nursery.cells.len() + 2 > max_cells { vec![] } else { nursery.divide(cell, Fate::of(division)) }
        })
        .map_err(|e| nursery.error(e))?;
        if summary.interrupted {
            return Err(GrowError::Interrupted { solved: summary.solved });
        }
        let tree = nursery.lay_out(&solve)?;
        Ok((tree, summary))
    }

    fn first(&self) -> Young {
        let founder = self.lineage.first();
        Young {
            mother: None,
            side: Side::Anterior,
            founder,
            is_founder: true,
            round: 0,
            generation: 0,
            fraction: 1.0,
            r0: self.lineage.founders[founder].r0.unwrap_or(self.settings.physics.r0),
            cue: self.lineage.founder_cue(founder),
            fate: None,
            daughters: None,
        }
    }
}

impl Nursery<'_> {
    /// The division a cell needs; none if its fate is known without, and then it is noted.
    fn job(&mut self, index: usize) -> Option<Job<DivisionInput>> {
        let young = &mut self.cells[index];
        let limits = self.grower.lineage.limits;
        let ended = if young.generation >= limits.max_depth {
            Some(EndReason::MaxDepth { max_depth: limits.max_depth })
        } else {
            (self.grower.ends)(young.r0, &young.cue)
        };
        if let Some(reason) = ended {
            young.fate = Some(Fate::ended(reason));
            return None;
        }
        let TreeSettings { physics, numerics, seed, .. } = self.grower.settings;
        Some(Job { id: index, task: DivisionInput { physics, numerics, r0: young.r0, cue: young.cue, seed } })
    }

    /// Notes a cell's fate, adds its daughters and returns the divisions they need.
    fn divide(&mut self, index: usize, fate: Fate) -> Vec<Job<DivisionInput>> {
        self.cells[index].fate = Some(fate);
        let Some(pair) = self.offspring(index, &fate) else { return vec![] };
        let anterior = self.cells.len();
        self.cells[index].daughters = Some(anterior);
        self.cells.extend(pair);
        [anterior, anterior + 1].into_iter().filter_map(|daughter| self.job(daughter)).collect()
    }

    /// Anterior and posterior daughter of a cell, if it divides.
    fn offspring(&self, index: usize, fate: &Fate) -> Option<[Young; 2]> {
        let lineage = self.grower.lineage;
        let mother = &self.cells[index];
        let first_r0 = self.cells[0].r0;
        let volumes = fate.daughter_volumes(mother.fraction)?;
        let young = |side: Side, fraction: f64| Young {
            mother: Some(index),
            side,
            is_founder: false,
            round: mother.round + 1,
            generation: mother.generation + 1,
            fraction,
            // V = 4πR0³/3, so R0 of the daughter follows from its share of the first cell's volume.
            r0: first_r0 * fraction.cbrt(),
            fate: None,
            daughters: None,
            ..*mother
        };
        let mut pair = [young(Side::Anterior, volumes[0]), young(Side::Posterior, volumes[1])];
        if let Some(listed) = self.listed[mother.founder].filter(|_| mother.is_founder) {
            let founders = match volumes[0].total_cmp(&volumes[1]) {
                std::cmp::Ordering::Equal => [listed.first(), listed.second()],
                std::cmp::Ordering::Greater => [listed.larger, listed.smaller],
                std::cmp::Ordering::Less => [listed.smaller, listed.larger],
            };
            for (cell, founder) in pair.iter_mut().zip(founders) {
                cell.founder = founder;
                cell.is_founder = true;
                cell.round = 0;
                cell.cue = lineage.founder_cue(founder);
                if let Some(r0) = lineage.founders[founder].r0 {
                    cell.r0 = r0;
                    cell.fraction = (r0 / first_r0).powi(3);
                }
            }
        }
        Some(pair)
    }

    /// A cell's name, given its mother's.
    fn name(&self, young: &Young, mother: &str) -> String {
        let lineage = self.grower.lineage;
        if young.is_founder {
            return lineage.founders[young.founder].name.clone();
        }
        let (anterior, posterior) = lineage.letters(young.founder, young.round as usize);
        let mut name = String::with_capacity(mother.len() + 1);
        name.push_str(mother);
        name.push(if young.side == Side::Anterior { anterior } else { posterior });
        name
    }

    fn error(&self, error: SchedulerError<DivisionError>) -> GrowError {
        let SchedulerError::Unsolved { id, size, failure, unsolved } = error else {
            return GrowError::Workers(error);
        };
        let mut line = vec![id];
        while let Some(mother) = self.cells[line[line.len() - 1]].mother {
            line.push(mother);
        }
        let name = line.iter().rev().fold(String::new(), |above, &index| self.name(&self.cells[index], &above));
        GrowError::Division { cell: name, r0: size, failure, others: unsolved.saturating_sub(1) }
    }

    /// The tree in breadth-first order, cut at the limit of cells.
    fn lay_out(
        mut self,
        solve: impl Fn(&DivisionInput) -> Result<Division, DivisionError> + Sync,
    ) -> Result<Tree, GrowError> {
        let max_cells = self.grower.lineage.limits.max_cells;
        let mut first = self.cell_of(0, "");
        first.fate = self.cells[0].fate.unwrap_or(first.fate);
        let mut tree = Tree::new(self.grower.lineage.clone(), self.grower.settings, first);
        let mut queue: VecDeque<(NodeIndex, usize)> = VecDeque::from([(tree.first(), 0)]);
        while let Some((node, index)) = queue.pop_front() {
            if self.cells[index].fate.is_none() {
                // Growth stopped short of this cell because of the limit.
                let room = tree.len() + 2 <= max_cells;
                if room {
                    self.settle(index, &solve)?
                } else {
                    self.cells[index].fate = Some(Fate::ended(EndReason::MaxCells { max_cells }))
                }
            }
            let Some(mut fate) = self.cells[index].fate else { continue };
            if let Some(anterior) = self.cells[index].daughters {
                if tree.len() + 2 <= max_cells {
                    for (daughter, side) in [(anterior, Side::Anterior), (anterior + 1, Side::Posterior)] {
                        let cell = self.cell_of(daughter, &tree.cell(node).name);
                        let daughter_node = tree.add(node, side, cell, self.cells[daughter].is_founder);
                        queue.push_back((daughter_node, daughter));
                    }
                } else {
                    fate = Fate::ended(EndReason::MaxCells { max_cells });
                }
            }
            tree.cell_mut(node).fate = fate;
        }
        Ok(tree)
    }

    /// Solves one division by itself and adds the daughters.
    fn settle(
        &mut self,
        index: usize,
        solve: impl Fn(&DivisionInput) -> Result<Division, DivisionError> + Sync,
    ) -> Result<(), GrowError> {
        let Some(job) = self.job(index) else { return Ok(()) };
        let mut fate = None;
        let options = SchedulerOptions { progress: None, ..self.grower.options };
        let summary = scheduler::run(vec![job], self.grower.memo, &options, solve, |_, division| {
            fate = Some(Fate::of(division));
            vec![]
        })
        .map_err(|e| self.error(e))?;
        match fate {
            Some(fate) => {
                self.divide(index, fate);
                Ok(())
            }
            None => Err(GrowError::Interrupted { solved: summary.solved }),
        }
    }

    fn cell_of(&self, index: usize, mother: &str) -> Cell {
        let young = &self.cells[index];
        Cell {
            name: self.name(young, mother),
            founder: young.founder,
            generation: young.generation,
            r0: young.r0,
            volume_fraction: young.fraction,
            cue: young.cue,
            // Noted when the layout reaches the cell.
            fate: Fate { outcome: None, chi: None, chi_signed: None, u_furrow: None, t_end: None, ended: None },
        }
    }
}
