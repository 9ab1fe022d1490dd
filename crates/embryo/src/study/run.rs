//! Solving the points of a sweep, equal inputs once.

use std::collections::HashMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use rayon::prelude::*;
use serde_json::Value;

use super::points::Point;
use super::shard::Shard;
use super::sweep::{Kind, Sweep};
use super::table::{Row, UNDECIDED};
use crate::batch::{Job, Key, Memo, Progress, SchedulerError, SchedulerOptions, StoreWarning, scheduler};
use crate::cell::Cell;
use crate::division::{Division, DivisionInput, Statistics, divide};
use crate::lineage::{EndReason, Ends, GrowError, Grower, Tree, TreeSettings, founder_rounds};
use crate::shapes::critical::{BoundaryKind, critical_radius_within};
use crate::shapes::{BranchOptions, CriticalRadii, Effort, PointKind, ShapeError, pitchfork};

/// Largest ξ_s up to which pitchforks are searched for.
const XI_MAX: f64 = 100.0;

/// Where a run stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Standing {
    /// Divisions, trees or shapes that are done.
    pub done: usize,
    /// All of them.
    pub of: usize,
}

/// What a sweep is solved with.
///
/// ```
/// use std::sync::atomic::AtomicBool;
///
/// use furrow::batch::{Memo, Quantisation};
/// use furrow::settings::Settings;
/// use furrow::study::table::csv_text;
/// use furrow::study::{Run, Sweep};
///
/// static STOP: AtomicBool = AtomicBool::new(false);
/// let text = r#"Sweep(kind: division, axes: [(parameter: "r0", list: [1.5, 1.6])])"#;
/// let sweep = Sweep::parse(text, "small.ron", &Settings::default(), &[])?;
/// let memo = Memo::new(Quantisation::DEFAULT);
/// let run = Run { sweep: &sweep, shard: None, memo: &memo, threads: 0, interrupt: &STOP, progress: &|_| () };
/// let done = run.solve()?;
/// let csv = String::from_utf8(csv_text(&sweep.columns(), &done.rows)?)?;
/// assert!(csv.starts_with("r0,outcome,chi,u_furrow,t_end\n1.5,failed,,,"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Run<'a> {
    /// The sweep.
    pub sweep: &'a Sweep,
    /// The part of it to be solved; none for all.
    pub shard: Option<Shard>,
    /// Remembers divisions.
    pub memo: &'a Memo,
    /// Threads; 0 is one for each core.
    pub threads: usize,
    /// Set to true to stop.
    pub interrupt: &'static AtomicBool,
    /// Told how far it is.
    pub progress: &'a (dyn Fn(Standing) + Sync),
}

/// A sweep, or a part of it, solved.
#[derive(Debug, Default)]
pub struct Done {
    /// One row a point, in the order of the points.
    pub rows: Vec<Row>,
    /// Points that are undecided, as places in `rows`.
    pub undecided: Vec<usize>,
    /// Divisions (of points or in trees) or shapes solved by this run.
    pub solved: usize,
    /// Divisions or shapes that were known already, or solved for another point.
    pub reused: usize,
    /// Whether it was stopped; there are no rows then.
    pub interrupted: bool,
    /// What the user should know of the store.
    pub warnings: Vec<StoreWarning>,
}

/// Results of a point, and why they are not all there if they are not.
type Results = (Vec<Value>, Option<String>);

impl Run<'_> {
    /// Solves the points. Rows depend on the sweep alone, whatever the threads, the parts and what the memo knows.
    ///
    /// # Errors
    /// [`SchedulerError::Pool`] if no workers can be started. A point that cannot be computed is a row of its own.
    pub fn solve(&self) -> Result<Done, SchedulerError> {
        let quantisation = self.memo.quantisation();
        let all = (0..self.sweep.points()).map(|index| self.sweep.point(index));
        let points: Vec<Point> = all.filter(|point| self.shard.is_none_or(|s| s.has(point, quantisation))).collect();
        match self.sweep.kind {
            Kind::Division => self.divisions(&points),
            Kind::Tree => self.trees(&points),
            Kind::Pitchfork => self.shapes(&points, |cell| pitchfork_results(cell, self.interrupt)),
            Kind::Critical => self.shapes(&points, |cell| critical_results(cell, self.interrupt)),
        }
    }

    /// The rows of points, given what came of each.
    fn rows(&self, points: &[Point], results: impl IntoIterator<Item = Results>) -> (Vec<Row>, Vec<usize>) {
        let mut undecided = Vec::new();
        let row = |(place, (point, (values, why))): (usize, (&Point, Results))| {
            // Nothing computed, or of several replicates not all.
            if why.is_some() {
                undecided.push(place);
            }
            self.sweep.row(point.index, values, why)
        };
        let rows = points.iter().zip(results).enumerate().map(row).collect();
        (rows, undecided)
    }

    fn divisions(&self, points: &[Point]) -> Result<Done, SchedulerError> {
        let replicates = self.sweep.replicates as usize;
        let mut jobs = Vec::new();
        for (place, point) in points.iter().enumerate().filter(|(_, point)| point.refused.is_none()) {
            for k in 0..replicates {
                let seed = point.input.seed.wrapping_add(k as u64);
                jobs.push(Job { id: place * replicates + k, input: DivisionInput { seed, ..point.input.clone() } });
            }
        }
        let of = jobs.len();
        let show = |progress: Progress| (self.progress)(Standing { done: progress.solved + progress.memo_hits, of });
        let options = SchedulerOptions {
            threads: self.threads,
            interrupt: Some(self.interrupt),
            progress: Some(&show),
            ..SchedulerOptions::default()
        };
        let mut divisions: Vec<Option<Division>> = vec![None; points.len() * replicates];
        let run = scheduler::run(jobs, self.memo, &options, divide, |id, division| {
            divisions[id] = Some(division.clone());
            vec![]
        });
        let mut failures: HashMap<usize, String> = HashMap::new();
        let summary = match run {
            Ok(summary) => summary,
            Err(SchedulerError::Unsolved { mut jobs, summary }) => {
                jobs.sort_by_key(|job| job.id);
                for job in jobs {
                    failures.entry(job.id / replicates).or_insert_with(|| job.failure.to_string());
                }
                *summary
            }
            Err(error) => return Err(error),
        };
        let mut done = Done {
            solved: summary.solved,
            reused: summary.memo_hits,
            interrupted: summary.interrupted,
            warnings: summary.warnings,
            ..Done::default()
        };
        if !done.interrupted {
            let results = points.iter().zip(divisions.chunks(replicates)).enumerate().map(|(place, (point, of))| {
                (division_results(of), point.refused.clone().or_else(|| failures.remove(&place)))
            });
            (done.rows, done.undecided) = self.rows(points, results);
        }
        Ok(done)
    }

    /// Points with a number of its own for each distinct input, and the first point of each.
    fn distinct<'p>(&self, points: &'p [Point]) -> (Vec<Option<usize>>, Vec<&'p Point>) {
        let mut known: HashMap<Key, usize> = HashMap::new();
        let mut firsts = Vec::new();
        let number = |point: &'p Point| {
            point.refused.is_none().then(|| {
                *known.entry(Key::new(&point.input)).or_insert_with(|| {
                    firsts.push(point);
                    firsts.len() - 1
                })
            })
        };
        let numbers = points.iter().map(number).collect();
        (numbers, firsts)
    }

    /// The rows of points from the results of distinct inputs.
    fn spread(&self, points: &[Point], numbers: &[Option<usize>], results: &[Results]) -> (Vec<Row>, Vec<usize>) {
        let of = |(point, number): (&Point, &Option<usize>)| match number {
            Some(number) => results[*number].clone(),
            None => (self.nothing(), point.refused.clone()),
        };
        self.rows(points, points.iter().zip(numbers).map(of))
    }

    /// Results of a point of which nothing is known.
    fn nothing(&self) -> Vec<Value> {
        match self.sweep.kind {
            Kind::Pitchfork => vec![Value::Null, UNDECIDED.into(), Value::Null, Value::Null],
            Kind::Critical => vec![Value::Null, UNDECIDED.into()],
            Kind::Division | Kind::Tree => vec![Value::Null; self.sweep.result_columns().len()],
        }
    }

    /// Stationary shapes, on all cores.
    fn shapes(
        &self,
        points: &[Point],
        solve: impl Fn(&DivisionInput) -> Result<Results, String> + Sync,
    ) -> Result<Done, SchedulerError> {
        let (numbers, firsts) = self.distinct(points);
        let count = AtomicUsize::new(0);
        let stopped = || self.interrupt.load(Ordering::Relaxed);
        let one = |point: &&Point| {
            if stopped() {
                return (self.nothing(), None);
            }
            // A defect in one point is no reason to lose the others.
            let solved = catch_unwind(AssertUnwindSafe(|| solve(&point.input)))
                .unwrap_or_else(|_| Err("the solver broke off (a defect of furrow, please report it)".to_owned()));
            let done = count.fetch_add(1, Ordering::Relaxed) + 1;
            (self.progress)(Standing { done, of: firsts.len() });
            solved.unwrap_or_else(|why| (self.nothing(), Some(why)))
        };
        let pool = scheduler::pool(self.threads)?;
        let results: Vec<Results> = pool.install(|| firsts.par_iter().map(one).collect());
        if stopped() {
            return Ok(Done { interrupted: true, ..Done::default() });
        }
        let (rows, undecided) = self.spread(points, &numbers, &results);
        let reused = numbers.iter().flatten().count() - firsts.len();
        Ok(Done { rows, undecided, solved: firsts.len(), reused, ..Done::default() })
    }

    /// Trees, one after the other, each on all cores: their divisions are shared.
    fn trees(&self, points: &[Point]) -> Result<Done, SchedulerError> {
        let (numbers, firsts) = self.distinct(points);
        let mut done = Done::default();
        let mut results = Vec::new();
        let mut rule: Option<(crate::cell::Numerics, Ends)> = None;
        for (place, point) in firsts.iter().enumerate() {
            (self.progress)(Standing { done: place, of: firsts.len() });
            let numerics = point.input.numerics;
            if rule.as_ref().is_none_or(|(of, _)| *of != numerics) {
                rule = Some((numerics, Ends::new(CriticalRadii::new(&numerics).interrupted_by(self.interrupt))));
            }
            let Some((_, ends)) = &rule else { continue };
            match self.tree(&point.input, ends, &mut done) {
                Ok(tree) => results.push((tree_results(&tree), undecided_cells(&tree))),
                Err(GrowError::Interrupted { .. }) => return Ok(Done { interrupted: true, ..done }),
                Err(GrowError::Workers(error)) => return Err(error),
            }
        }
        (done.rows, done.undecided) = self.spread(points, &numbers, &results);
        Ok(done)
    }

    fn tree(&self, input: &DivisionInput, ends: &Ends, done: &mut Done) -> Result<Tree, GrowError> {
        let settings = TreeSettings {
            cell: input.cell.clone(),
            numerics: input.numerics,
            seed: input.seed,
            r0_step: self.memo.quantisation().relative_step(),
        };
        // The first cell's division is always computed: it costs less than a search for the critical radius of its kind, and
        // no row may depend on what was searched for before.
        let first = std::cell::Cell::new(true);
        let ends = |cell: &Cell| if first.replace(false) { None } else { ends.of(cell) };
        let options =
            SchedulerOptions { threads: self.threads, interrupt: Some(self.interrupt), ..SchedulerOptions::default() };
        let lineage = self.sweep.lineage_at(&input.cell);
        let (tree, summary) =
            Grower { lineage: &lineage, settings, ends: &ends, memo: self.memo, options }.grow(divide)?;
        done.solved += summary.solved;
        done.reused += summary.memo_hits;
        done.warnings.extend(summary.warnings);
        Ok(tree)
    }
}

/// The columns of divisions at one point: of a single one, or what several say together.
fn division_results(divisions: &[Option<Division>]) -> Vec<Value> {
    match divisions {
        [None] => vec![UNDECIDED.into(), Value::Null, Value::Null, Value::Null],
        [Some(d)] => vec![d.outcome.name().into(), d.chi.into(), d.u_furrow.into(), d.t_end.into()],
        several => {
            let Statistics { symmetric, asymmetric, failed, chi_mean, chi_sd } =
                Statistics::of(several.iter().flatten());
            vec![symmetric.into(), asymmetric.into(), failed.into(), chi_mean.into(), chi_sd.into()]
        }
    }
}

/// How many cells of a tree are undecided, and why the first is.
fn undecided_cells(tree: &Tree) -> Option<String> {
    let mut cells = tree.cells().filter_map(|id| match &tree.cell(id).fate.ended {
        Some(EndReason::Undecided { why }) => Some((&tree.cell(id).name, why)),
        _ => None,
    });
    let (name, why) = cells.next()?;
    Some(format!("undecided cells: {}, the first of them {name}: {why}", 1 + cells.count()))
}

fn tree_results(tree: &Tree) -> Vec<Value> {
    let mut values = vec![tree.len().into()];
    for found in founder_rounds(tree) {
        let chi = tree.founder_cell(found.founder).and_then(|id| tree.cell(id).fate.chi());
        match found.rounds {
            Some(r) => values.extend([
                r.min.into(),
                r.mean.into(),
                r.max.into(),
                r.full_doublings.into(),
                r.terminal.into(),
                chi.into(),
            ]),
            // It was never born.
            None => values.extend(vec![Value::Null; 6]),
        }
    }
    values
}

/// A cell whose pitchfork does not exist, up to [`XI_MAX`] or because of its cue, has criticality `none`: an answer, too.
fn pitchfork_results(input: &DivisionInput, interrupt: &AtomicBool) -> Result<Results, String> {
    let options = BranchOptions { xi: [0.0, XI_MAX], ..BranchOptions::default() };
    let effort = Effort::new(usize::MAX, Some(interrupt));
    match pitchfork::first_within(&input.cell, &input.numerics, &options, &effort) {
        Ok(found) => {
            let criticality = found.criticality().to_string();
            let point = &found.point;
            Ok((vec![point.xi_s.into(), criticality.into(), found.coefficient.into(), point.elongation.into()], None))
        }
        Err(ShapeError::NotFound { kind: PointKind::Pitchfork, .. } | ShapeError::NoPitchfork { .. }) => {
            Ok((vec![Value::Null, "none".into(), Value::Null, Value::Null], None))
        }
        Err(error) => Err(error.to_string()),
    }
}

fn critical_results(input: &DivisionInput, interrupt: &AtomicBool) -> Result<Results, String> {
    let effort = Effort::new(usize::MAX, Some(interrupt));
    let found = critical_radius_within(&input.cell, &input.numerics, &effort).map_err(|error| error.to_string())?;
    let kind = match found.kind {
        BoundaryKind::CuedFold => "cued_fold",
        _ => "pitchfork",
    };
    Ok((vec![found.r0.into(), kind.into()], None))
}
