//! Solves the points of a sweep; equal inputs are solved once.

use std::panic::{AssertUnwindSafe, catch_unwind};

use super::boundary::trials;
use super::journal::Journal;
use super::points::Point;
use super::shard::Shard;
use super::sweep::{Kind, Sweep};
use super::table::{Row, UNDECIDED};
use furrow_cell::Numerics;
use furrow_lineage::batch::{
    Job, Key, Memo, Progress, SchedulerError, SchedulerOptions, Summary, critical_radii, method, scheduler, solve,
};
use furrow_lineage::{
    EndRule, GrowError, Grower, Scope, TerminalReason, Thresholds, Tree, TreeSettings, founder_rounds,
};
use furrow_mechanics::division::{Division, DivisionInput, Statistics};
use furrow_mechanics::equilibria::{BranchOptions, PointKind, ShapeError, StepBudget, pitchfork};
use serde_json::{Value, json};
use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Largest ξ_s up to which pitchforks are searched for.
const XI_MAX: f64 = 100.0;

/// How far a sweep is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SweepProgress {
    /// Divisions, trees or shapes that are done.
    pub done: usize,
    /// All of them.
    pub of: usize,
}

/// A sweep, or one shard of it, to be solved.
///
/// ```
/// use std::sync::atomic::AtomicBool;
///
/// use furrow_lineage::batch::{Memo, Quantisation};
/// use furrow_cell::settings::{Overrides, Settings};
/// use furrow_analysis::table::csv_text;
/// use furrow_analysis::{Run, Sweep};
///
/// let text = r#"Sweep(kind: division, axes: [(parameter: "r0", list: [1.5, 1.6])])"#;
/// let sweep = Sweep::parse(text, "small.ron", &Settings::default(), &Overrides::default())?;
/// let (memo, cancel) = (Memo::new(Quantisation::DEFAULT), AtomicBool::new(false));
/// let solved = Run::new(&sweep, &memo, &cancel).solve()?;
/// let csv = csv_text(&sweep.columns(), &solved.rows);
/// assert!(csv.starts_with("r0,outcome,chi,u_furrow,t_end,chi_signed\n1.5,failed,,,"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Run<'a> {
    /// The sweep.
    pub sweep: &'a Sweep,
    /// The shard to solve; `None` for all points.
    pub shard: Option<Shard>,
    /// Remembers divisions.
    pub memo: &'a Memo,
    /// Threads; 0 is one for each core.
    pub threads: usize,
    /// Set to true to stop.
    pub cancel: &'a AtomicBool,
    /// Has the rows of an interrupted run, and receives each solved row.
    pub journal: Option<&'a Journal>,
    /// Called with the progress.
    pub progress: &'a (dyn Fn(SweepProgress) + Sync),
}

/// The rows of a sweep or of one shard of it.
#[derive(Debug, Default)]
pub struct SweepResult {
    /// One row a point, in the order of the points; `None` if the run was interrupted.
    pub rows: Vec<Row>,
    /// Points with rows from an interrupted run.
    pub resumed: usize,
    /// The run's divisions, of points or in trees, or its shapes: `memo_hits` are those that were known, or solved for another point.
    pub summary: Summary,
}

impl SweepResult {
    /// Rows that are undecided, wholly or in part.
    pub fn undecided(&self) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(|row| row.why.is_some())
    }
}

/// Results of a point, and why they are incomplete if they are.
type Results = (Vec<Value>, Option<String>);

/// Computes the results at a point.
type SolveShape = fn(&DivisionInput, &StepBudget<'_>) -> Result<Results, ShapeError>;

/// The distinct inputs of points.
struct Inputs<'p> {
    /// The number of each point's input; `None` for a point that is refused.
    of_point: Vec<Option<usize>>,
    /// The first point of each input.
    firsts: Vec<&'p Point>,
    /// The results of each input, once they are known.
    results: Vec<Option<Results>>,
    /// Inputs without a known result.
    open: Vec<usize>,
}

impl<'a> Run<'a> {
    /// All points on all cores, without a journal.
    pub fn new(sweep: &'a Sweep, memo: &'a Memo, cancel: &'a AtomicBool) -> Run<'a> {
        Run { sweep, shard: None, memo, threads: 0, cancel, journal: None, progress: &|_| () }
    }

    /// Solves the points. Rows depend only on the sweep, not on threads, shards, memo or journal.
    ///
    /// # Errors
    /// [`SchedulerError::Pool`] if no workers can be started. A point that cannot be computed is a row of its own.
    pub fn solve(&self) -> Result<SweepResult, SchedulerError> {
        let quantisation = self.memo.quantisation();
        let all = (0..self.sweep.points()).map(|index| self.sweep.point(index));
        let points: Vec<Point> = all.filter(|point| self.shard.is_none_or(|s| s.has(point, quantisation))).collect();
        let mut inputs = self.inputs(&points);
        let known = |inputs: &Inputs<'_>, number: &usize| inputs.results[*number].is_some();
        let resumed = inputs.of_point.iter().flatten().filter(|number| known(&inputs, number)).count();
        let equal = inputs.of_point.iter().flatten().count() - resumed - inputs.open.len();
        let mut out = match self.sweep.kind {
            Kind::Division => self.divisions(&mut inputs)?,
            Kind::Tree => self.trees(&mut inputs)?,
            Kind::Pitchfork => self.shapes(&mut inputs, pitchfork_results)?,
            Kind::Critical => self.shapes(&mut inputs, critical_results)?,
        };
        out.resumed = resumed;
        out.summary.memo_hits += match self.sweep.kind {
            Kind::Division => equal * self.sweep.replicates as usize,
            Kind::Tree => 0,
            Kind::Pitchfork | Kind::Critical => equal,
        };
        if !out.summary.interrupted {
            let row = |(point, number): (&Point, &Option<usize>)| {
                let results = number.and_then(|number| inputs.results[number].clone());
                let (values, why) = results.unwrap_or_else(|| (self.no_results(), point.invalid.clone()));
                self.sweep.row(point.index, values, why)
            };
            out.rows = points.iter().zip(&inputs.of_point).map(row).collect();
        }
        Ok(out)
    }

    /// The distinct inputs, with the results that the journal holds.
    fn inputs<'p>(&self, points: &'p [Point]) -> Inputs<'p> {
        let mut numbers: HashMap<Key, usize> = HashMap::new();
        let key = |point: &Point| Key::new(&point.input);
        let mut firsts = Vec::new();
        let mut add = |point: &'p Point| {
            firsts.push(point);
            firsts.len() - 1
        };
        let number = |point: &'p Point| {
            point.invalid.is_none().then(|| *numbers.entry(key(point)).or_insert_with(|| add(point)))
        };
        let of_point = points.iter().map(number).collect();
        let mut results = vec![None; firsts.len()];
        for row in self.journal.iter().flat_map(|journal| journal.rows.values()) {
            if row.index < self.sweep.points()
                && let Some(number) = numbers.get(&key(&self.sweep.point(row.index)))
            {
                results[*number] = Some((row.cells[self.sweep.axes.0.len()..].to_vec(), row.why.clone()));
            }
        }
        let open = (0..firsts.len()).filter(|number| results[*number].is_none()).collect();
        Inputs { of_point, firsts, results, open }
    }

    fn options(&self) -> SchedulerOptions<'a> {
        SchedulerOptions { threads: self.threads, interrupt: Some(self.cancel), ..SchedulerOptions::default() }
    }

    fn cancelled(&self) -> bool {
        self.cancel.load(Ordering::Relaxed)
    }

    /// Appends the results of an input to the journal.
    fn record(&self, point: &Point, (values, why): &Results) {
        if let Some(journal) = self.journal {
            journal.append(&self.sweep.row(point.index, values.clone(), why.clone()));
        }
    }

    fn divisions(&self, inputs: &mut Inputs<'_>) -> Result<SweepResult, SchedulerError> {
        let Inputs { firsts, results, open, .. } = inputs;
        let replicates = self.sweep.replicates as usize;
        let job = |number: usize, k: usize| {
            let first = &firsts[number].input;
            let input = DivisionInput { seed: first.seed.wrapping_add(k as u64), ..first.clone() };
            Job { id: number * replicates + k, input }
        };
        let jobs = open.iter().flat_map(|&number| (0..replicates).map(move |k| (number, k)));
        let jobs: Vec<_> = jobs.map(|(number, k)| job(number, k)).collect();
        let of = firsts.len() * replicates;
        let before = of - jobs.len();
        let show = |progress: Progress| {
            (self.progress)(SweepProgress { done: before + progress.solved + progress.memo_hits, of });
        };
        let options = SchedulerOptions { progress: Some(&show), ..self.options() };
        let mut divisions: Vec<Option<Division>> = vec![None; of];
        let run = scheduler::run(jobs, self.memo, &options, solve, |id, division| {
            divisions[id] = Some(division.clone());
            let number = id / replicates;
            let of_input = &divisions[number * replicates..][..replicates];
            if of_input.iter().all(Option::is_some) {
                let found = (self.division_results(of_input), None);
                self.record(firsts[number], &found);
                results[number] = Some(found);
            }
            vec![]
        });
        let summary = match run {
            Ok(summary) => summary,
            Err(SchedulerError::Unsolved { mut jobs, summary }) => {
                jobs.sort_by_cached_key(|job| job.id);
                for job in jobs {
                    let number = job.id / replicates;
                    let of_input = &divisions[number * replicates..][..replicates];
                    results[number]
                        .get_or_insert_with(|| (self.division_results(of_input), Some(job.failure.to_string())));
                }
                *summary
            }
            Err(error) => return Err(error),
        };
        Ok(SweepResult { summary, ..SweepResult::default() })
    }

    /// The columns of the divisions at one point.
    fn division_results(&self, divisions: &[Option<Division>]) -> Vec<Value> {
        let mut values = division_results(divisions);
        if self.sweep.has_neck_offsets() {
            values.push(divisions.iter().flatten().next().and_then(|division| division.neck_offset).into());
        }
        values
    }

    /// The columns of a point without results.
    fn no_results(&self) -> Vec<Value> {
        match self.sweep.kind {
            Kind::Division => self.division_results(&vec![None; self.sweep.replicates as usize]),
            Kind::Pitchfork => vec![Value::Null, UNDECIDED.into(), Value::Null, Value::Null],
            Kind::Critical => vec![Value::Null, UNDECIDED.into()],
            Kind::Tree => vec![Value::Null; self.sweep.result_columns().len()],
        }
    }

    /// Stationary shapes, on all cores.
    fn shapes(&self, inputs: &mut Inputs<'_>, solve: SolveShape) -> Result<SweepResult, SchedulerError> {
        let Inputs { firsts, results, open, .. } = inputs;
        let done = AtomicUsize::new(firsts.len() - open.len());
        let one = |number: &usize| {
            if self.cancelled() {
                return None;
            }
            let point = firsts[*number];
            let budget = StepBudget::new(usize::MAX, Some(self.cancel));
            // A panic at one point must not lose the others.
            let solved = catch_unwind(AssertUnwindSafe(|| solve(&point.input, &budget)));
            let found = match solved {
                Ok(Ok(found)) => found,
                Ok(Err(error)) => (self.no_results(), Some(error.to_string())),
                Err(_) => (self.no_results(), Some("internal error: the solver panicked, please report it".to_owned())),
            };
            // The result of an interrupted search is not valid.
            if self.cancelled() {
                return None;
            }
            self.record(point, &found);
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            (self.progress)(SweepProgress { done, of: firsts.len() });
            Some(found)
        };
        let pool = scheduler::pool(self.threads)?;
        let solved: Vec<Option<Results>> = pool.install(|| scheduler::in_parallel(open.len(), |k| one(&open[k])));
        let interrupted = self.cancelled();
        open.iter().zip(solved).for_each(|(number, found)| results[*number] = found);
        let summary = Summary { solved: open.len(), interrupted, ..Summary::default() };
        Ok(SweepResult { summary, ..SweepResult::default() })
    }

    /// Trees, one after the other, each on all cores: their divisions are shared.
    fn trees(&self, inputs: &mut Inputs<'_>) -> Result<SweepResult, SchedulerError> {
        let mut out = SweepResult::default();
        let of = inputs.firsts.len();
        let before = of - inputs.open.len();
        let mut rule: Option<(Numerics, Thresholds<'_>)> = None;
        for (place, &number) in inputs.open.iter().enumerate() {
            (self.progress)(SweepProgress { done: before + place, of });
            let point = inputs.firsts[number];
            let numerics = point.input.numerics;
            let (_, ends) = match rule.take().filter(|(of, _)| *of == numerics) {
                Some(same) => rule.insert(same),
                None => {
                    let radii = critical_radii(&numerics, self.memo.store()).interrupted_by(self.cancel);
                    // The first cell's division is always computed: it costs less than a search for its critical radius,
                    // and no row may depend on what was searched for before.
                    rule.insert((numerics, Thresholds::new(radii).with_scope(Scope::AllButFirst)))
                }
            };
            let tree = match self.tree(&point.input, ends, &mut out) {
                Err(GrowError::Workers(error)) => return Err(error),
                Ok(tree) if !self.cancelled() => tree,
                Ok(_) | Err(GrowError::Interrupted { .. }) => {
                    out.summary.interrupted = true;
                    return Ok(out);
                }
            };
            let found = (tree_results(&tree), undecided_cells(&tree));
            self.record(point, &found);
            inputs.results[number] = Some(found);
        }
        Ok(out)
    }

    fn tree(&self, input: &DivisionInput, ends: &Thresholds<'_>, out: &mut SweepResult) -> Result<Tree, GrowError> {
        let DivisionInput { cell, numerics, seed } = input.clone();
        let settings = TreeSettings { cell, numerics, seed, r0_step: self.memo.quantisation().relative_step() };
        let (lineage, ends) = (&self.sweep.lineage_at(&input.cell), EndRule::Thresholds(ends));
        let grower = Grower { lineage, settings, ends, memo: self.memo, options: self.options() };
        let (tree, summary) = grower.grow(solve)?;
        out.summary.add(summary);
        Ok(tree)
    }
}

/// The columns of divisions at one point: of a single division, or statistics of several.
fn division_results(divisions: &[Option<Division>]) -> Vec<Value> {
    match divisions {
        [None] => vec![UNDECIDED.into(), Value::Null, Value::Null, Value::Null, Value::Null],
        [Some(d)] => {
            let [chi, signed] = [d.chi(), d.chi_signed()].map(Value::from);
            vec![d.outcome().name().into(), chi, d.u_furrow().into(), d.t_end.into(), signed]
        }
        several => {
            let Statistics { symmetric, asymmetric, failed, chi_mean, chi_sd } =
                Statistics::of(several.iter().flatten());
            vec![symmetric.into(), asymmetric.into(), failed.into(), chi_mean.into(), chi_sd.into()]
        }
    }
}

/// How many cells of a tree are undecided, and why the first is.
fn undecided_cells(tree: &Tree) -> Option<String> {
    let mut cells = tree.cells().filter_map(|id| match tree.cell(id).fate.terminal_reason() {
        Some(TerminalReason::Undecided { why }) => Some((&tree.cell(id).name, why)),
        _ => None,
    });
    let (name, why) = cells.next()?;
    Some(format!("undecided cells: {}, the first of them {name}: {why}", 1 + cells.count()))
}

fn tree_results(tree: &Tree) -> Vec<Value> {
    let mut values = vec![tree.len().into()];
    // No rounds for a founder that was never born.
    for (founder, r) in founder_rounds(tree).into_iter().enumerate() {
        let cell = tree.founder_cell(founder).map(|id| tree.cell(id));
        let division = cell.and_then(|cell| cell.fate.division());
        values.extend([r.map(|r| r.min).into(), r.map(|r| r.mean).into(), r.map(|r| r.max).into()]);
        values.extend([r.map(|r| r.full_doublings).into(), r.map(|r| r.terminal).into()]);
        let chi = [division.and_then(Division::chi), division.and_then(Division::chi_signed)];
        let [chi, signed] = chi.map(|chi| Value::from(chi.filter(|_| r.is_some())));
        values.extend([chi, cell.map(|cell| cell.r0).into(), signed]);
    }
    values
}

/// A cell without a pitchfork, up to [`XI_MAX`] or because of its cue, has criticality `none`: that is also a result.
fn pitchfork_results(input: &DivisionInput, budget: &StepBudget<'_>) -> Result<Results, ShapeError> {
    let options = BranchOptions { xi: [0.0, XI_MAX], ..BranchOptions::default() };
    match pitchfork::first_within(&input.cell, &input.numerics, &options, budget) {
        Ok(found) => {
            let (criticality, point) = (found.criticality().to_string(), &found.point);
            let values = [point.xi_s.into(), criticality.into(), found.coefficient.into(), point.elongation.into()];
            Ok((values.to_vec(), None))
        }
        Err(
            ShapeError::NotFound { kind: PointKind::Pitchfork, .. }
            | ShapeError::TurnsBack { .. }
            | ShapeError::NoPitchfork { .. },
        ) => Ok((vec![Value::Null, "none".into(), Value::Null, Value::Null], None)),
        Err(error) => Err(error),
    }
}

/// The critical radius, and what trial divisions on both sides of it say against it.
fn critical_results(input: &DivisionInput, budget: &StepBudget<'_>) -> Result<Results, ShapeError> {
    let DivisionInput { cell, numerics, .. } = input;
    let method = method(numerics);
    let found = (method.radius)(cell, numerics, budget)?;
    let against: Vec<String> = trials(cell, numerics, (found.kind, found.r0), &method, budget.interrupt()).collect();
    let why = (!against.is_empty()).then(|| against.join("; "));
    Ok((vec![found.r0.into(), json!(found.kind)], why))
}
