//! Growth of a tree: daughters inherit volumes, and every cell's division is solved as soon as its mother's is known.

use std::borrow::Cow;
use std::cmp::Ordering;
use std::collections::{HashMap, VecDeque};

use super::definition::Lineage;
use super::physics::FounderPhysics;
use super::rules::{Mother, Place, Ruled};
use super::thresholds::EndRule;
use super::tree::{Fate, Side, TerminalReason, Tree, TreeCell, TreeSettings};
use crate::batch::memo::Solve;
use crate::batch::scheduler::{self, Step};
use crate::batch::{Job, Memo, SchedulerError, SchedulerOptions, Summary, Unsolved};
use furrow_cell::{Cell, Cue};
use furrow_mechanics::critical::{CriticalRadii, Search};
use furrow_mechanics::division::{Division, DivisionInput};

/// The reason why a tree could not be grown.
#[expect(missing_docs, reason = "the messages say what the fields are")]
#[derive(Debug, thiserror::Error)]
pub enum GrowError {
    /// The workers could not be started.
    #[error(transparent)]
    Workers(SchedulerError),
    /// Growth was interrupted.
    #[error("interrupted after {solved} divisions")]
    Interrupted { solved: usize },
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
/// use furrow_lineage::{EndRule, Grower, Lineage, TreeSettings, founder_rounds};
/// let lineage = Lineage::parse("Lineage(name: \"one\", founders: [(name: \"S\", r0: 2.4)])", "one.ron")?;
/// let settings = TreeSettings { cell: Cell::new(2.4), ..TreeSettings::default() };
/// let memo = Memo::new(Quantisation::DEFAULT);
/// let options = SchedulerOptions::default();
/// let (tree, summary) = Grower { lineage: &lineage, settings, ends: EndRule::Dynamics, memo: &memo, options }.grow(divide)?;
/// // It divides into equal halves, and these, at 1.905, into one that divides on and one that is too small.
/// let rounds = founder_rounds(&tree)[0].ok_or("no such founder")?;
/// assert!(rounds.min < rounds.max && rounds.terminal > 4);
/// assert!(summary.solved < tree.len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Grower<'a> {
    /// Founders and rules.
    pub lineage: &'a Lineage,
    /// Parameters of all divisions.
    pub settings: TreeSettings,
    /// The rule that ends branches without computing a division.
    pub ends: EndRule<'a>,
    /// The memo of divisions.
    pub memo: &'a Memo,
    /// Threads, interruption, progress and order of work; for the order see [`expected_work`](super::expected_work).
    pub options: SchedulerOptions<'a>,
}

/// A cell, stored in the order of growth, which depends on timing.
#[derive(Clone, Debug)]
struct GrowingCell {
    name: String,
    place: Place,
    volume_fraction: f64,
    cue: Cue,
    /// Parameters set by rules.
    physics: Option<Box<FounderPhysics>>,
    /// Whether its parameters are unlikely to occur in other cells.
    is_single: bool,
    is_founder: bool,
    fate: Option<Fate>,
    /// The anterior daughter; the posterior one follows it.
    daughters: Option<usize>,
}

impl GrowingCell {
    fn new(lineage: &Lineage, name: String, place: Place, volume_fraction: f64, is_founder: bool) -> GrowingCell {
        let cue = lineage.cue_at(place);
        GrowingCell {
            name,
            place,
            volume_fraction,
            cue,
            physics: None,
            is_single: false,
            is_founder,
            fate: None,
            daughters: None,
        }
    }

    /// The same with the parameters set by rules. If one is not allowed, the cell is undecided.
    fn ruled(self, lineage: &Lineage, run: &Cell, mother: Option<Mother<'_>>) -> GrowingCell {
        let mut cell = Cell { r0: self.place.r0, cue: self.cue.clone(), ..run.clone() };
        match lineage.set_physics(self.place, &mut cell, mother) {
            Ok(Ruled { physics, is_single }) => {
                let physics = Some(physics).filter(|physics| !physics.is_empty()).map(Box::new);
                GrowingCell { cue: cell.cue, physics, is_single, ..self }
            }
            Err(why) => GrowingCell { fate: Some(TerminalReason::Undecided { why }.into()), ..self },
        }
    }

    /// Its parameters.
    fn cell(&self, lineage: &Lineage, run: &Cell) -> Cell {
        lineage.parameters((self.place.founder, self.place.r0, &self.cue), self.physics.as_deref(), run)
    }
}

/// State shared by trees that differ only in the seed of the noise. Divisions that do not depend on the noise come from the first
/// seed.
struct Sharing {
    /// Seed of the first tree.
    first: u64,
    /// For cells that wait for a division with another seed: the division with the first seed, and whether that with the next seed
    /// differs.
    waiting: HashMap<usize, (Division, bool)>,
}

struct Growth<'a> {
    grower: &'a Grower<'a>,
    /// State shared with other replicates, if there are any.
    sharing: Option<Sharing>,
    /// Whether there are rules for parameters of cells.
    has_rules: bool,
    /// The founders (larger, smaller) into which each founder divides.
    listed: Vec<Option<(usize, usize)>>,
    cells: Vec<GrowingCell>,
}

/// The division or the search that is needed to determine the fate of a cell.
enum Request<'a> {
    Division(DivisionInput),
    Search(&'a CriticalRadii<'a>, Search),
}

impl Grower<'_> {
    /// Grows the tree. Workers use `solve` to compute divisions that are not in the memo, with the memo's rounding of R0. The tree
    /// depends only on the inputs, not on the number of threads or the state of the memo; the [`Summary`] counts the work.
    ///
    /// # Errors
    /// A division that could not be computed, or interruption.
    pub fn grow(&self, solve: impl Solve) -> Result<(Tree, Summary), GrowError> {
        let (mut trees, summary) = grow_all(std::slice::from_ref(self), None, &solve)?;
        // One grower gives one tree.
        Ok((trees.remove(0), summary))
    }
}

/// Grows several trees in one run. All their cells share a queue, so that no worker is idle while any tree has a division to
/// solve, and a division needed by several trees is solved once. Every tree is identical to the same tree grown alone; the
/// [`Summary`] counts the work of all. The first grower's memo and options are used.
///
/// # Errors
/// As [`Grower::grow`].
pub fn grow_together(growers: &[Grower<'_>], solve: impl Solve) -> Result<(Vec<Tree>, Summary), GrowError> {
    grow_all(growers, None, &solve)
}

/// As [`grow_together`], for trees that differ only in the seed of the noise, to show the effect of chance. Each division is computed
/// with `first_seed` and the next seed; if the two [agree](Division::agrees_with), the noise has no influence and all trees use
/// the first. The tree of `first_seed` is identical to the same tree grown alone.
///
/// # Errors
/// As [`Grower::grow`].
pub fn grow_replicates(
    growers: &[Grower<'_>],
    first_seed: u64,
    solve: impl Solve,
) -> Result<(Vec<Tree>, Summary), GrowError> {
    grow_all(growers, Some(first_seed), &solve)
}

/// The non-generic part of [`grow_together`] and [`grow_replicates`], which is compiled only once.
fn grow_all(
    growers: &[Grower<'_>],
    first_seed: Option<u64>,
    solve: &dyn Solve,
) -> Result<(Vec<Tree>, Summary), GrowError> {
    let Some(Grower { memo, options, .. }) = growers.first() else { return Ok(Default::default()) };
    let tree = |grower| {
        let sharing = first_seed.map(|first| Sharing { first, waiting: HashMap::new() });
        Growth { sharing, ..Growth::of(grower) }
    };
    let mut all = Growths { trees: growers.iter().map(tree).collect(), searches: Vec::new() };
    let roots = (0..growers.len()).filter_map(|root| all.step(root, None)).collect();
    let run = scheduler::run_steps(roots, memo, options, solve, &mut |id, division| all.expand(id, division));
    let trees = growers.len();
    let summary = completed(run, |id, why| all.trees[id % trees].note_undecided(id / trees, why))?;
    let trees: Result<Vec<Tree>, GrowError> = all.trees.into_iter().map(|growth| growth.lay_out(solve)).collect();
    let trees = trees?;
    // The run has divisions, too, of cells beyond the largest number, and these depend on the order of its jobs.
    let three_parts = trees.iter().map(Tree::three_parts).sum();
    Ok((trees, Summary { three_parts, ..summary }))
}

/// Trees that grow in one run. The scheduler's number of a job encodes the cell and its tree.
struct Growths<'a> {
    trees: Vec<Growth<'a>>,
    /// Started searches for critical radii, and the jobs that wait for them.
    searches: Vec<(&'a CriticalRadii<'a>, Search, Vec<usize>)>,
}

impl<'a> Growths<'a> {
    /// The jobs that follow from a job's division, or from the search for which it waited.
    fn expand(&mut self, id: usize, division: Option<&Division>) -> Vec<Step<'a>> {
        let (count, of) = (self.trees.len(), id % self.trees.len());
        if let Some(division) = division {
            let tree = &mut self.trees[of];
            let Some(division) = tree.settled(id / count, division) else {
                return self.step(id, None).into_iter().collect();
            };
            // Cells beyond the limit are removed in the layout, in an order that does not depend on timing.
            let has_room = tree.cells.len() + 2 <= tree.grower.lineage.limits.max_cells;
            let daughters = if has_room { tree.divide(id / count, &division) } else { None };
            return daughters.into_iter().flatten().filter_map(|cell| self.step(cell * count + of, None)).collect();
        }
        let Some(done) = self.searches.iter().position(|(.., jobs)| jobs[0] == id) else { return vec![] };
        let (_, search, jobs) = self.searches.swap_remove(done);
        jobs.into_iter().filter_map(|id| self.step(id, Some(&search))).collect()
    }

    /// The scheduler's next step for a job. `tried` is the search that has been run for it.
    fn step(&mut self, id: usize, tried: Option<&Search>) -> Option<Step<'a>> {
        let count = self.trees.len();
        let (radii, search) = match self.trees[id % count].request(id / count, tried)? {
            Request::Division(input) => return Some(Step::Solve(Job { id, input })),
            Request::Search(radii, search) => (radii, search),
        };
        let begun = self.searches.iter_mut().find(|(of, begun, _)| std::ptr::eq(*of, radii) && *begun == search);
        if let Some((.., jobs)) = begun {
            jobs.push(id);
            return None;
        }
        self.searches.push((radii, search.clone(), vec![id]));
        Some(Step::Prepare(id, Box::new(move || radii.run(&search))))
    }
}

/// The summary of a run that was not interrupted. Jobs without a record are passed to `undecided`.
fn completed(run: scheduler::Result<Summary>, mut undecided: impl FnMut(usize, String)) -> Result<Summary, GrowError> {
    let (summary, unsolved) = scheduler::parts(run).map_err(GrowError::Workers)?;
    unsolved.into_iter().for_each(|Unsolved { id, failure, .. }| undecided(id, failure.to_string()));
    match summary.interrupted {
        true => Err(GrowError::Interrupted { solved: summary.solved }),
        false => Ok(summary),
    }
}

/// A cell's division with the smaller daughter on the side that applies in a tree of this seed.
///
/// If the poles of `cell` are equivalent, mechanics gives χ and the side is random. It is drawn for each cell from the seed and the
/// cell's name, so that one record serves many cells and the tree is reproducible.
pub fn oriented(division: &Division, cell: &Cell, name: &str, seed: u64) -> Division {
    let smaller_posterior = division.chi_signed().is_some_and(|chi| chi > 0.0);
    // Whether the smaller daughter is posterior, with probability ½ for every seed and name.
    let drawn = [&seed.to_le_bytes(), name.as_bytes()].concat();
    let is_posterior = || blake3::hash(&drawn).as_bytes()[0] & 1 == 0;
    let turned = cell.is_mirror_symmetric() && smaller_posterior != is_posterior();
    if turned { division.clone().mirrored() } else { division.clone() }
}

impl<'a> Growth<'a> {
    /// A tree of its first cell.
    fn of(grower: &'a Grower<'a>) -> Growth<'a> {
        let Grower { lineage, settings, .. } = grower;
        let founder = lineage.first();
        let r0 = lineage.given_r0(founder).unwrap_or(settings.cell.r0);
        let place = Place { founder, round: 0, generation: 0, r0, apart: 0 };
        let first = GrowingCell::new(lineage, lineage.founders[founder].name.clone(), place, 1.0, true);
        let has_rules = lineage.has_physics_rules();
        let first = if has_rules { first.ruled(lineage, &settings.cell, None) } else { first };
        Growth { grower, sharing: None, has_rules, listed: lineage.daughters(), cells: vec![first] }
    }

    /// The division or the search that a cell needs; `None` if its fate is known without either and has been set. If the search
    /// `tried` was interrupted, it is not repeated.
    fn request(&mut self, index: usize, tried: Option<&Search>) -> Option<Request<'a>> {
        let Grower { lineage, settings, ends, .. } = self.grower;
        let growing = &self.cells[index];
        if growing.fate.is_some() {
            return None;
        }
        let (generation, cell) = (growing.place.generation, growing.cell(lineage, &settings.cell));
        let max_depth = lineage.limits.max_depth;
        let most_rounds = lineage.most_rounds(growing.place);
        let reason = match *ends {
            _ if lineage.dies(&growing.name) => Some(TerminalReason::Dies),
            _ if generation >= max_depth => Some(TerminalReason::MaxDepth { max_depth }),
            _ if most_rounds.is_some() => most_rounds.map(TerminalReason::most),
            EndRule::Dynamics => None,
            EndRule::Custom(rule) => rule(&cell),
            // A search for the critical radius with its parameters costs more than its division.
            EndRule::Thresholds(_) if growing.is_single => None,
            EndRule::Thresholds(rule) if !rule.decides(&cell, index == 0) => None,
            EndRule::Thresholds(rule) => match rule.radii.missing(&cell) {
                Some(search) if tried == Some(&search) => None,
                Some(search) => return Some(Request::Search(&rule.radii, search)),
                None => rule.of(&cell),
            },
        };
        self.cells[index].fate = reason.map(Fate::from);
        let undecided = self.cells[index].fate.is_none();
        let seed = self.seed(index);
        undecided.then_some(Request::Division(DivisionInput { cell, numerics: settings.numerics, seed }))
    }

    /// The seed of the next division that a cell needs.
    fn seed(&self, index: usize) -> u64 {
        let own = self.grower.settings.seed;
        let Some(Sharing { first, waiting }) = &self.sharing else { return own };
        match waiting.get(&index) {
            None => *first,
            Some((_, false)) => first.wrapping_add(1),
            Some((_, true)) => own,
        }
    }

    /// The division of a cell, once it is computed; `None` if the division with another seed is needed first, to determine whether the
    /// noise matters.
    fn settled<'d>(&mut self, index: usize, division: &'d Division) -> Option<Cow<'d, Division>> {
        let (own, asked) = (self.grower.settings.seed, self.seed(index));
        let Grower { lineage, settings, .. } = self.grower;
        let Some(Sharing { waiting, .. }) = self.sharing.as_mut().filter(|sharing| sharing.first != own) else {
            return Some(Cow::Borrowed(division));
        };
        let Some((shared, differs)) = waiting.get_mut(&index) else {
            waiting.insert(index, (division.clone(), false));
            return None;
        };
        let alike = || self.cells[index].cell(lineage, &settings.cell).is_mirror_symmetric();
        if !*differs && shared.agrees_with(division, alike()) {
            return waiting.remove(&index).map(|(shared, _)| Cow::Owned(shared));
        }
        *differs = true;
        if asked != own {
            return None;
        }
        waiting.remove(&index);
        Some(Cow::Borrowed(division))
    }

    /// Sets a cell's fate and adds its daughters.
    fn divide(&mut self, index: usize, division: &Division) -> Option<[usize; 2]> {
        let Grower { lineage, settings, .. } = self.grower;
        let growing = &self.cells[index];
        let cell = growing.cell(lineage, &settings.cell);
        let fate = Fate::from(oriented(division, &cell, &growing.name, settings.seed));
        let pair = self.offspring(index, &fate);
        self.cells[index].fate = Some(fate);
        let anterior = self.cells.len();
        self.cells.extend(pair?);
        self.cells[index].daughters = Some(anterior);
        Some([anterior, anterior + 1])
    }

    /// Ends the branch of a cell after its division could not be computed.
    fn note_undecided(&mut self, index: usize, why: String) {
        self.cells[index].fate = Some(TerminalReason::Undecided { why }.into());
    }

    /// Anterior and posterior daughter of a cell, if it divides.
    fn offspring(&self, index: usize, fate: &Fate) -> Option<[GrowingCell; 2]> {
        let mother = &self.cells[index];
        let volumes = fate.daughter_volumes(mother.volume_fraction)?;
        let founders = self.listed[mother.place.founder].filter(|_| mother.is_founder).map(|(larger, smaller)| {
            match volumes[0].total_cmp(&volumes[1]) {
                // If the daughters are equal, the founder listed first is anterior.
                Ordering::Equal => [larger.min(smaller), larger.max(smaller)],
                Ordering::Greater => [larger, smaller],
                Ordering::Less => [smaller, larger],
            }
        });
        let daughters = [Side::Anterior, Side::Posterior].map(|side| self.daughter(index, side, volumes, founders));
        if !self.has_rules {
            return Some(daughters);
        }
        let Grower { lineage, settings, .. } = self.grower;
        let cell = mother.cell(lineage, &settings.cell);
        let mother = Mother::of(&cell, fate.division());
        Some(daughters.map(|daughter| daughter.ruled(lineage, &settings.cell, Some(mother))))
    }

    /// A daughter. The volumes of both, anterior first, are fractions of the first cell's; `founders` are the founders that they are.
    fn daughter(
        &self,
        mother_index: usize,
        side: Side,
        volumes: [f64; 2],
        founders: Option<[usize; 2]>,
    ) -> GrowingCell {
        let (lineage, mother) = (self.grower.lineage, &self.cells[mother_index]);
        let first_r0 = self.cells[0].place.r0;
        let (k, founder) = (side as usize, founders.map(|founders| founders[side as usize]));
        let fraction = volumes[k] * lineage.growth(founder.unwrap_or(mother.place.founder));
        // V = 4πR0³/3, so R0 of the daughter follows from its fraction of the first cell's volume.
        let (mut r0, mut fraction) = (first_r0 * fraction.cbrt(), fraction);
        if let Some(given) = founder.and_then(|founder| lineage.given_r0(founder)) {
            (r0, fraction) = (given, (given / first_r0).powi(3));
        }
        let generation = mother.place.generation + 1;
        if let Some(founder) = founder {
            let place = Place { founder, round: 0, generation, r0, apart: 0 };
            return GrowingCell::new(lineage, lineage.founders[founder].name.clone(), place, fraction, true);
        }
        let (founder, round) = (mother.place.founder, mother.place.round + 1);
        let (anterior, posterior) = lineage.letters(founder, round as usize);
        let name = format!("{}{}", mother.name, if side == Side::Anterior { anterior } else { posterior });
        let apart = lineage.apart(founder, mother.place.apart, side.is_larger(volumes));
        GrowingCell::new(lineage, name, Place { founder, round, generation, r0, apart }, fraction, false)
    }

    /// The tree in breadth-first order, cut at the limit of cells.
    fn lay_out(mut self, solve: &dyn Solve) -> Result<Tree, GrowError> {
        let Grower { lineage, settings, .. } = self.grower;
        let max_cells = lineage.limits.max_cells;
        let mut tree: Option<Tree> = None;
        // The queue of cells with their mothers in the tree, and the number of cells queued so far.
        let (mut queue, mut placed) = (VecDeque::from([(0, None)]), 1);
        while let Some((index, mother)) = queue.pop_front() {
            let has_room = placed + 2 <= max_cells;
            if self.cells[index].fate.is_none() && has_room {
                // Growth stopped short of this cell because of the limit.
                self.settle(index, solve)?;
            }
            let cell = &mut self.cells[index];
            let fate = match (cell.fate.take(), cell.daughters) {
                (Some(fate), None) => fate,
                (Some(fate), Some(_)) if has_room => fate,
                _ => TerminalReason::MaxCells { max_cells }.into(),
            };
            let (divides, daughters) = (matches!(fate, Fate::Divides(_)), cell.daughters);
            let Place { founder, generation, r0, .. } = cell.place;
            let (name, cue) = (std::mem::take(&mut cell.name), std::mem::take(&mut cell.cue));
            let (volume_fraction, is_founder, physics) = (cell.volume_fraction, cell.is_founder, cell.physics.take());
            let cell = TreeCell { name, founder, generation, r0, volume_fraction, cue, physics, fate };
            let id = match (&mut tree, mother) {
                (Some(tree), Some((mother, side))) => tree.add(mother, side, cell, is_founder),
                _ => tree.insert(Tree::new(Lineage::clone(lineage), settings.clone(), cell)).first(),
            };
            if let Some(anterior) = daughters.filter(|_| divides) {
                queue.extend([(anterior, Some((id, Side::Anterior))), (anterior + 1, Some((id, Side::Posterior)))]);
                placed += 2;
            }
        }
        // The queue started with the first cell.
        tree.ok_or(GrowError::Interrupted { solved: 0 })
    }

    /// Solves a single division and adds the daughters.
    fn settle(&mut self, index: usize, solve: &dyn Solve) -> Result<(), GrowError> {
        let options = SchedulerOptions { progress: None, ..self.grower.options };
        while let Some(input) = self.decide(index) {
            let mut solved = None;
            let run =
                scheduler::run(vec![Job { id: index, input }], self.grower.memo, &options, solve, |_, division| {
                    solved = Some(division.clone());
                    vec![]
                });
            completed(run, |id, why| self.note_undecided(id, why))?;
            let Some(division) = solved else { break };
            let Some(division) = self.settled(index, &division) else { continue };
            let daughters = self.divide(index, &division);
            daughters.into_iter().flatten().for_each(|daughter| drop(self.decide(daughter)));
            break;
        }
        Ok(())
    }

    /// As [`need`](Self::need), with searches on this thread, since no worker is busy.
    fn decide(&mut self, index: usize) -> Option<DivisionInput> {
        let mut tried = None;
        loop {
            match self.request(index, tried.as_ref())? {
                Request::Division(input) => return Some(input),
                Request::Search(radii, search) => {
                    radii.run(&search);
                    tried = Some(search);
                }
            }
        }
    }
}
