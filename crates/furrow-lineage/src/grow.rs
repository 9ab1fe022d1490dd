//! Growth of a tree: volumes are handed down, every cell's division is solved as soon as its mother's is.

use std::collections::VecDeque;

use super::definition::{Lineage, ListedDaughters, Place};
use super::tree::{CellId, Fate, Side, TerminalReason, Tree, TreeCell, TreeSettings};
use crate::batch::{Job, Memo, SchedulerError, SchedulerOptions, Summary, Unsolved, scheduler};
use furrow_cell::Cell;
use furrow_mechanics::division::{Division, DivisionError, DivisionInput};

/// Why a tree could not be grown.
#[derive(Debug, thiserror::Error)]
pub enum GrowError {
    /// The workers could not be started.
    #[error(transparent)]
    Workers(SchedulerError),
    /// Growth was interrupted.
    #[error("interrupted after {solved} divisions")]
    Interrupted {
        /// Divisions solved before; the memo knows them.
        solved: usize,
    },
}

/// The inputs of a tree.
///
/// # Examples
/// A cell without a cue and its descendants, every division computed once:
///
/// ```
/// use furrow_lineage::batch::{Memo, Quantisation, SchedulerOptions};
/// use furrow_cell::Cell;
/// use furrow_mechanics::division::divide;
/// use furrow_lineage::{Grower, Lineage, TreeSettings, founder_rounds};
/// let lineage = Lineage::parse("Lineage(name: \"one\", founders: [(name: \"S\", r0: 2.4)])", "one.ron")?;
/// let settings = TreeSettings { cell: Cell::new(2.4), ..TreeSettings::default() };
/// let memo = Memo::new(Quantisation::DEFAULT);
/// let options = SchedulerOptions::default();
/// let (tree, summary) = Grower { lineage: &lineage, settings, ends: &|_| None, memo: &memo, options }.grow(divide)?;
/// // It divides into equal halves, and these, at 1.905, into one that divides on and one that is too small.
/// let rounds = founder_rounds(&tree)[0].rounds.ok_or("no such founder")?;
/// assert!(rounds.min < rounds.max && rounds.terminal > 4);
/// assert!(summary.solved < tree.len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Grower<'a> {
    /// Founders and rules.
    pub lineage: &'a Lineage,
    /// Parameters of all divisions.
    pub settings: TreeSettings,
    /// Ends branches ahead of their division; `&|_| None` leaves it to the dynamics.
    pub ends: &'a dyn Fn(&Cell) -> Option<TerminalReason>,
    /// Remembers divisions.
    pub memo: &'a Memo,
    /// Threads, interruption, progress, order of work; for the last see [`expected_work`](super::expected_work).
    pub options: SchedulerOptions<'a>,
}

/// A cell in the order of growth, which depends on timing.
#[derive(Clone, Debug)]
struct GrowingCell {
    /// The cell, whose fate is set when the layout reaches it.
    cell: TreeCell,
    is_founder: bool,
    /// Rounds below the founder.
    round: u32,
    fate: Option<Fate>,
    /// The anterior daughter; the posterior one follows it.
    daughters: Option<usize>,
}

impl GrowingCell {
    fn new(lineage: &Lineage, name: String, place: Place, volume_fraction: f64, is_founder: bool) -> GrowingCell {
        let Place { founder, round, generation, r0 } = place;
        let (cue, fate) = (lineage.cue_at(place), Fate::default());
        let cell = TreeCell { name, founder, generation, r0, volume_fraction, cue, fate };
        GrowingCell { cell, is_founder, round, fate: None, daughters: None }
    }
}

struct Growth<'a> {
    grower: &'a Grower<'a>,
    listed: Vec<Option<ListedDaughters>>,
    cells: Vec<GrowingCell>,
}

impl Grower<'_> {
    /// Grows the tree. Workers compute divisions that the memo lacks with `solve`, at the memo's rounding of R0. The tree
    /// depends on the inputs alone, not on the number of threads or the state of the memo; the [`Summary`] counts the work.
    ///
    /// # Errors
    /// A division that could not be computed, or interruption.
    pub fn grow<S>(&self, solve: S) -> Result<(Tree, Summary), GrowError>
    where
        S: Fn(&DivisionInput) -> Result<Division, DivisionError> + Sync,
    {
        let (mut trees, summary) = grow_all(std::slice::from_ref(self), &solve)?;
        // As many trees as growers: one.
        Ok((trees.remove(0), summary))
    }

    fn first(&self) -> GrowingCell {
        let founder = self.lineage.first();
        let r0 = self.lineage.given_r0(founder).unwrap_or(self.settings.cell.r0);
        let place = Place { founder, round: 0, generation: 0, r0 };
        GrowingCell::new(self.lineage, self.lineage.founders[founder].name.clone(), place, 1.0, true)
    }
}

/// Grows several trees in one run. All their cells share a queue, so that no worker is idle while any tree has a division to
/// solve, and a division that several trees need is solved once. Every tree is the same as grown alone; the [`Summary`]
/// counts the work of all. Memo and options are those of the first grower.
///
/// # Errors
/// As [`Grower::grow`].
pub fn grow_together<S>(growers: &[Grower<'_>], solve: S) -> Result<(Vec<Tree>, Summary), GrowError>
where
    S: Fn(&DivisionInput) -> Result<Division, DivisionError> + Sync,
{
    grow_all(growers, &solve)
}

/// Computes a division.
type Solve<'a> = &'a (dyn Fn(&DivisionInput) -> Result<Division, DivisionError> + Sync);

/// [`grow_together`], not generic, so that it is compiled once.
fn grow_all(growers: &[Grower<'_>], solve: Solve<'_>) -> Result<(Vec<Tree>, Summary), GrowError> {
    let Some(Grower { memo, options, .. }) = growers.first() else { return Ok(Default::default()) };
    let mut growths: Vec<Growth<'_>> = growers.iter().map(Growth::of).collect();
    // The scheduler's number of a job encodes the cell and its tree.
    let trees = growths.len();
    let numbered = |tree: usize, job: Job| Job { id: job.id * trees + tree, ..job };
    let mut roots = Vec::with_capacity(trees);
    for (tree, growth) in growths.iter_mut().enumerate() {
        roots.extend(growth.job(0).map(|job| numbered(tree, job)));
    }
    let run = scheduler::run(roots, memo, options, solve, |id, division| {
        let (cell, tree) = (id / trees, id % trees);
        growths[tree].expand(cell, division).into_iter().map(|job| numbered(tree, job)).collect()
    });
    let summary = completed(run, |id, why| growths[id % trees].note_undecided(id / trees, why))?;
    let trees: Result<Vec<Tree>, GrowError> = growths.into_iter().map(|growth| growth.lay_out(solve)).collect();
    Ok((trees?, summary))
}

/// The summary of a run that was not interrupted. Jobs without a record are passed to `undecided`.
fn completed(
    run: Result<Summary, SchedulerError>,
    mut undecided: impl FnMut(usize, String),
) -> Result<Summary, GrowError> {
    let summary = match run {
        Ok(summary) => summary,
        Err(SchedulerError::Unsolved { jobs, summary }) => {
            for Unsolved { id, failure, .. } in jobs {
                undecided(id, failure.to_string());
            }
            *summary
        }
        Err(error) => return Err(GrowError::Workers(error)),
    };
    if summary.interrupted {
        return Err(GrowError::Interrupted { solved: summary.solved });
    }
    Ok(summary)
}

impl<'a> Growth<'a> {
    /// A tree of its first cell.
    fn of(grower: &'a Grower<'a>) -> Growth<'a> {
        Growth { grower, listed: grower.lineage.daughters(), cells: vec![grower.first()] }
    }
}

impl Growth<'_> {
    /// The jobs that follow from a cell's division. Cells beyond the limit are settled in the layout, in an order that does
    /// not depend on timing.
    fn expand(&mut self, index: usize, division: &Division) -> Vec<Job> {
        let max_cells = self.grower.lineage.limits.max_cells;
        if self.cells.len() + 2 > max_cells { vec![] } else { self.divide(index, division) }
    }

    /// The division a cell needs; none if its fate is known without it, which is then set.
    fn job(&mut self, index: usize) -> Option<Job> {
        let TreeSettings { cell: first, numerics, seed, .. } = &self.grower.settings;
        let TreeCell { founder, generation, r0, ref cue, .. } = self.cells[index].cell;
        let limits = self.grower.lineage.limits;
        let mut cell = Cell { r0, cue: cue.clone(), ..first.clone() };
        self.grower.lineage.founders[founder].physics.apply(&mut cell);
        let ended = if generation >= limits.max_depth {
            Some(TerminalReason::MaxDepth { max_depth: limits.max_depth })
        } else {
            (self.grower.ends)(&cell)
        };
        if let Some(reason) = ended {
            self.cells[index].fate = Some(Fate::ended(reason));
            return None;
        }
        Some(Job { id: index, input: DivisionInput { cell, numerics: *numerics, seed: *seed } })
    }

    /// Sets a cell's fate, adds its daughters and returns the divisions they need.
    fn divide(&mut self, index: usize, division: &Division) -> Vec<Job> {
        let fate = Fate::of(&self.oriented(index, division));
        let pair = self.offspring(index, &fate);
        self.cells[index].fate = Some(fate);
        let Some(pair) = pair else { return vec![] };
        let anterior = self.cells.len();
        self.cells[index].daughters = Some(anterior);
        self.cells.extend(pair);
        [anterior, anterior + 1].into_iter().filter_map(|daughter| self.job(daughter)).collect()
    }

    /// The division with its smaller daughter on the side where it is in this cell.
    ///
    /// Where the poles are alike the mechanics give χ and the side is random: drawn for each cell from the seed and its name,
    /// so that one record serves many cells and the tree is reproducible.
    fn oriented(&self, index: usize, division: &Division) -> Division {
        let cell = &self.cells[index].cell;
        let smaller_posterior = division.chi_signed().is_some_and(|chi| chi > 0.0);
        if cell.cue.is_mirror_symmetric() && smaller_posterior != draws_posterior(self.grower.settings.seed, &cell.name)
        {
            return division.clone().mirrored();
        }
        division.clone()
    }

    /// Ends the branch of a cell whose division could not be computed.
    fn note_undecided(&mut self, index: usize, why: String) {
        self.cells[index].fate = Some(Fate::ended(TerminalReason::Undecided { why }));
    }

    /// Anterior and posterior daughter of a cell, if it divides.
    fn offspring(&self, index: usize, fate: &Fate) -> Option<[GrowingCell; 2]> {
        let mother = &self.cells[index];
        let volumes = fate.daughter_volumes(mother.cell.volume_fraction)?;
        let founders = self.listed[mother.cell.founder].filter(|_| mother.is_founder).map(|listed| {
            match volumes[0].total_cmp(&volumes[1]) {
                std::cmp::Ordering::Equal => [listed.first(), listed.second()],
                std::cmp::Ordering::Greater => [listed.larger, listed.smaller],
                std::cmp::Ordering::Less => [listed.smaller, listed.larger],
            }
        });
        let daughter = |k: usize| {
            let founder = founders.map(|founders| founders[k]);
            self.daughter(index, [Side::Anterior, Side::Posterior][k], volumes[k], founder)
        };
        Some([daughter(0), daughter(1)])
    }

    /// A daughter of a volume given as a part of the first cell's; `founder` is the founder that it is, if it is one.
    fn daughter(&self, mother_index: usize, side: Side, fraction: f64, founder: Option<usize>) -> GrowingCell {
        let (lineage, mother) = (self.grower.lineage, &self.cells[mother_index]);
        let first_r0 = self.cells[0].cell.r0;
        // V = 4πR0³/3, so R0 of the daughter follows from its share of the first cell's volume.
        let (mut r0, mut fraction) = (first_r0 * fraction.cbrt(), fraction);
        if let Some(given) = founder.and_then(|founder| lineage.given_r0(founder)) {
            (r0, fraction) = (given, (given / first_r0).powi(3));
        }
        let round = if founder.is_some() { 0 } else { mother.round + 1 };
        let place = Place {
            founder: founder.unwrap_or(mother.cell.founder),
            round,
            generation: mother.cell.generation + 1,
            r0,
        };
        GrowingCell::new(lineage, self.daughter_name(mother, side, founder), place, fraction, founder.is_some())
    }

    /// Name of a daughter: the founder's, or its mother's and a letter.
    fn daughter_name(&self, mother: &GrowingCell, side: Side, founder: Option<usize>) -> String {
        let lineage = self.grower.lineage;
        if let Some(founder) = founder {
            return lineage.founders[founder].name.clone();
        }
        let (anterior, posterior) = lineage.letters(mother.cell.founder, mother.round as usize + 1);
        let mut name = String::with_capacity(mother.cell.name.len() + 1);
        name.push_str(&mother.cell.name);
        name.push(if side == Side::Anterior { anterior } else { posterior });
        name
    }

    /// The tree in breadth-first order, cut at the limit of cells.
    fn lay_out(mut self, solve: Solve<'_>) -> Result<Tree, GrowError> {
        let max_cells = self.grower.lineage.limits.max_cells;
        let first = self.cells[0].cell.clone();
        let mut tree = Tree::new(self.grower.lineage.clone(), self.grower.settings.clone(), first);
        let mut queue: VecDeque<(CellId, usize)> = VecDeque::from([(tree.first(), 0)]);
        while let Some((id, index)) = queue.pop_front() {
            if self.cells[index].fate.is_none() {
                // Growth stopped short of this cell because of the limit.
                let room = tree.len() + 2 <= max_cells;
                if room {
                    self.settle(index, solve)?
                } else {
                    self.cells[index].fate = Some(Fate::ended(TerminalReason::MaxCells { max_cells }))
                }
            }
            let Some(mut fate) = self.cells[index].fate.take() else { continue };
            if let Some(anterior) = self.cells[index].daughters {
                if tree.len() + 2 <= max_cells {
                    for (daughter, side) in [(anterior, Side::Anterior), (anterior + 1, Side::Posterior)] {
                        let cell = self.cells[daughter].cell.clone();
                        let daughter_id = tree.add(id, side, cell, self.cells[daughter].is_founder);
                        queue.push_back((daughter_id, daughter));
                    }
                } else {
                    fate = Fate::ended(TerminalReason::MaxCells { max_cells });
                }
            }
            tree.cell_mut(id).fate = fate;
        }
        Ok(tree)
    }

    /// Solves one division by itself and adds the daughters.
    fn settle(&mut self, index: usize, solve: Solve<'_>) -> Result<(), GrowError> {
        let Some(job) = self.job(index) else { return Ok(()) };
        let mut solved = None;
        let options = SchedulerOptions { progress: None, ..self.grower.options };
        let run = scheduler::run(vec![job], self.grower.memo, &options, solve, |_, division| {
            solved = Some(division.clone());
            vec![]
        });
        completed(run, |id, why| self.note_undecided(id, why))?;
        if let Some(division) = solved {
            self.divide(index, &division);
        }
        Ok(())
    }
}

/// Whether the smaller daughter of a cell whose poles are alike is the posterior one: a fair coin for every seed and name.
fn draws_posterior(seed: u64, name: &str) -> bool {
    let mut hasher = blake3::Hasher::new();
    hasher.update(&seed.to_le_bytes());
    hasher.update(name.as_bytes());
    hasher.finalize().as_bytes()[0] & 1 == 0
}
