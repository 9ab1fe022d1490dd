//! The search for roots: a scan, refined where the outcome passes the wanted one and where cells cease to divide.

use std::cell::RefCell;

use argmin::core::{CostFunction, Error, Executor};
use argmin::solver::brent::BrentRoot;
use furrow_cell::{Cell, Parameter, Settings};
use furrow_lineage::batch::scheduler::{self, Solved};
use furrow_lineage::batch::{self, phase::spaced};
use furrow_lineage::batch::{Memo, SchedulerOptions, StoreWarning};
use furrow_mechanics::division::{Division, DivisionInput};
use ordered_float::OrderedFloat;

use super::{Extreme, Gap, Jump, Measure, Question, Root, Smaller, Solution, SolveError, TOLERANCE};

/// Width of the bracket of an end of an interval without divisions, relative to the range.
const EDGE: f64 = 1e-5;
/// Rounds of values added where the outcome comes near the wanted one and turns back.
const TURNS: usize = 6;
/// Rounds in which brackets are refined. More are needed only where cells that divide and cells at rest alternate.
const ROUNDS: usize = 256;

/// Finds all values at which the outcome is the wanted one, as far as the scan brackets them.
///
/// # Errors
/// [`SolveError`] if the workers cannot be started or the search is interrupted. A value at which the cell does not divide is
/// part of a gap.
pub fn solve(question: &Question, memo: &Memo, options: &SchedulerOptions<'_>) -> Result<Solution, SolveError> {
    let Question { range: [from, to], points, .. } = *question;
    let goals = question.measure.goals(question.wanted);
    let mut search = Search { question, memo, options, goals, tried: Vec::new(), warnings: Vec::new() };
    search.try_all(&spaced(from.min(to), from.max(to), points))?;
    for _ in 0..TURNS {
        let values = search.turns();
        search.try_all(&values)?;
    }
    for _ in 0..ROUNDS {
        let edges = search.edges();
        if !edges.is_empty() {
            search.try_all(&edges)?;
            continue;
        }
        let Some((goal, bracket)) = search.brackets().next() else { break };
        search = search.refined(goal, bracket)?;
    }
    Ok(search.solution())
}

/// A value that was tried, with its division or the reason for its absence.
struct Tried {
    value: f64,
    found: Result<Division, String>,
    /// The outcome, with the sign of χ unless chance decides it; `None` without a division.
    outcome: Option<f64>,
}

/// Two neighbours between which the outcome passes a goal, with their distances from it.
struct Crossing<'a> {
    goal: f64,
    two: [&'a Tried; 2],
    off: [f64; 2],
}

/// A cell at rest is a gap of the outcome.
#[derive(Debug, thiserror::Error)]
#[error("the cell does not divide")]
struct NoDivision;

/// Values that were tried, in their order.
struct Search<'a> {
    question: &'a Question,
    memo: &'a Memo,
    options: &'a SchedulerOptions<'a>,
    /// The outcomes that are sought.
    goals: Vec<f64>,
    tried: Vec<Tried>,
    warnings: Vec<StoreWarning>,
}

impl Search<'_> {
    /// Width to which roots are bracketed. A radius is rounded before it is divided.
    fn tolerance(&self) -> f64 {
        let [from, to] = self.question.range;
        let rounding =
            if self.question.parameter == Parameter::R0 { self.memo.quantisation().relative_step() } else { 0.0 };
        (TOLERANCE * (to - from).abs()).max((4.0 * rounding).max(8.0 * f64::EPSILON) * from.abs().max(to.abs()))
    }

    /// The division's input at a value, or the reason why the value is not allowed.
    fn input(&self, value: f64) -> Result<DivisionInput, String> {
        let Question { numerics, seed, .. } = self.question;
        let cell = self.cell(value);
        let settings = Settings::of(cell.clone(), *numerics);
        let checked = settings.check("settings").and_then(|()| settings.check_activity("settings"));
        checked.map_err(|error| error.to_string())?;
        cell.cue.check().map_err(|error| error.to_string())?;
        Ok(DivisionInput { cell, numerics: *numerics, seed: *seed })
    }

    /// Tries values, in parallel.
    fn try_all(&mut self, values: &[f64]) -> Result<(), SolveError> {
        let (mut inputs, mut found) = (Vec::new(), Vec::new());
        for &value in values {
            match self.input(value) {
                Ok(input) => inputs.push((value, input)),
                Err(why) => found.push((value, Err(why))),
            }
        }
        let (values, inputs): (Vec<f64>, Vec<DivisionInput>) = inputs.into_iter().unzip();
        let Solved { divisions, unsolved, summary } =
            scheduler::solve_all(inputs, self.memo, self.options, batch::solve)?;
        self.warnings.extend(summary.warnings);
        if summary.interrupted {
            return Err(SolveError::Interrupted { divisions: self.tried.len() });
        }
        found.extend(unsolved.iter().map(|job| (values[job.id], Err(job.failure.to_string()))));
        found.extend(values.iter().zip(divisions).filter_map(|(value, division)| Some((*value, Ok(division?)))));
        let found = found.into_iter().map(|(value, found)| {
            let outcome = found.as_ref().ok().and_then(|division| self.outcome(value, division));
            Tried { value, found, outcome }
        });
        let found: Vec<Tried> = found.collect();
        self.tried.extend(found);
        self.tried.sort_by_cached_key(|item| OrderedFloat(item.value));
        Ok(())
    }

    /// The cell at a value.
    fn cell(&self, value: f64) -> Cell {
        let mut cell = self.question.cell.clone();
        self.question.parameter.set(&mut cell, value);
        cell
    }

    /// The outcome of a division. For |χ| it is the signed χ, which shows both passages where |χ| turns back at 0. In a mirror-symmetric
    /// cell chance decides the sign.
    fn outcome(&self, value: f64, division: &Division) -> Option<f64> {
        match self.question.measure {
            Measure::Chi if !self.cell(value).is_mirror_symmetric() => division.chi_signed(),
            measure => measure.of(division),
        }
    }

    /// The outcome at a value, which is tried unless it was.
    fn outcome_at(&mut self, value: f64) -> Result<Option<f64>, SolveError> {
        let known = |search: &Self| search.tried.iter().find(|tried| tried.value == value).map(|tried| tried.outcome);
        if let Some(outcome) = known(self) {
            return Ok(outcome);
        }
        self.try_all(&[value])?;
        Ok(known(self).flatten())
    }

    /// Values beside places where the outcome comes near a goal and turns back: there may be two roots between them.
    fn turns(&self) -> Vec<f64> {
        let mut values: Vec<OrderedFloat<f64>> = Vec::new();
        for (three, goal) in self.tried.windows(3).flat_map(|three| self.goals.iter().map(move |goal| (three, goal))) {
            let off = |k: usize| three[k].outcome.map(|outcome| outcome - goal);
            let [Some(before), Some(here), Some(behind)] = [off(0), off(1), off(2)] else { continue };
            let [before, behind] = [before, behind].map(|off| (off - here) * here.signum());
            // As far as it has come, it may go again.
            if before > 0.0 && behind > 0.0 && here.abs() < before.max(behind) && here.abs() > 0.0 {
                values.extend(three.windows(2).map(|two| OrderedFloat(0.5 * (two[0].value + two[1].value))));
            }
        }
        values.sort_unstable();
        values.dedup();
        values.into_iter().map(OrderedFloat::into_inner).collect()
    }

    /// Midpoints between neighbours where only one divides, unless they are close.
    fn edges(&self) -> Vec<f64> {
        let [from, to] = self.question.range;
        let open = |two: &&[Tried]| {
            two[0].outcome.is_some() != two[1].outcome.is_some()
                && two[1].value - two[0].value > EDGE * (to - from).abs()
        };
        self.tried.windows(2).filter(open).map(|two| 0.5 * (two[0].value + two[1].value)).collect()
    }

    /// Neighbours between which the outcome passes a goal, and which are not close yet.
    fn brackets(&self) -> impl Iterator<Item = (f64, [f64; 2])> + '_ {
        let tolerance = 2.0 * self.tolerance();
        self.crossings()
            .map(|Crossing { goal, two, .. }| (goal, two.map(|tried| tried.value)))
            .filter(move |(_, [from, to])| to - from > tolerance)
    }

    /// Neighbours between which the outcome passes a goal.
    fn crossings(&self) -> impl Iterator<Item = Crossing<'_>> {
        let of = |two: [&'_ Tried; 2], goal: f64| {
            let off = [two[0].outcome? - goal, two[1].outcome? - goal];
            (off[0] * off[1] < 0.0).then_some(off)
        };
        let pairs = self.tried.windows(2).map(|two| [&two[0], &two[1]]);
        let all = pairs.flat_map(|two| self.goals.iter().map(move |goal| (two, *goal)));
        all.filter_map(move |(two, goal)| Some(Crossing { goal, two, off: of(two, goal)? }))
    }

    /// The search after Brent's method in a bracket, which ends early where the cell does not divide.
    fn refined(self, goal: f64, [from, to]: [f64; 2]) -> Result<Self, SolveError> {
        struct Off<'s, 'a>(&'s RefCell<Search<'a>>, f64);
        impl CostFunction for Off<'_, '_> {
            type Param = f64;
            type Output = f64;

            fn cost(&self, value: &f64) -> Result<f64, Error> {
                Ok(self.0.borrow_mut().outcome_at(*value)?.ok_or(NoDivision)? - self.1)
            }
        }
        let (tolerance, search) = (self.tolerance(), RefCell::new(self));
        let run = Executor::new(Off(&search, goal), BrentRoot::new(from, to, tolerance)).run();
        match run.map(drop).map_err(|error| error.downcast::<SolveError>()) {
            Err(Ok(error)) => Err(error),
            _ => Ok(search.into_inner()),
        }
    }

    fn solution(self) -> Solution {
        let Question { measure, wanted, .. } = *self.question;
        let (mut roots, mut jumps): (Vec<Root>, Vec<Jump>) = (Vec::new(), Vec::new());
        let exact = |tried: &&Tried| tried.outcome.is_some_and(|outcome| self.goals.contains(&outcome));
        roots.extend(self.tried.iter().filter(exact).filter_map(|tried| self.root(tried)));
        for Crossing { two, off: [before, behind], .. } in self.crossings() {
            if (behind - before).abs() <= measure.continuous(wanted) {
                roots.extend(self.root(two[usize::from(behind.abs() < before.abs())]));
                continue;
            }
            let outcomes = two.map(|tried| tried.found.as_ref().ok().and_then(|division| measure.of(division)));
            // Where χ jumps from one side to the other, |χ| need not jump over the wanted one.
            if let [Some(before), Some(behind)] = outcomes
                && (before - wanted) * (behind - wanted) < 0.0
            {
                jumps.push(Jump { between: two.map(|tried| tried.value), outcomes: [before, behind] });
            }
        }
        roots.sort_by_cached_key(|item| OrderedFloat(item.value));
        let outcomes = self.tried.iter().filter_map(|tried| {
            Some(Extreme {
                outcome: tried.found.as_ref().ok().and_then(|division| measure.of(division))?,
                value: tried.value,
            })
        });
        let least = outcomes.clone().min_by(|a, b| a.outcome.total_cmp(&b.outcome));
        let most = outcomes.max_by(|a, b| a.outcome.total_cmp(&b.outcome));
        let (gaps, divisions) = (self.gaps(), self.tried.len());
        Solution { roots, jumps, gaps, seen: least.zip(most).map(|(a, b)| [a, b]), divisions, warnings: self.warnings }
    }

    fn root(&self, tried: &Tried) -> Option<Root> {
        let division = tried.found.as_ref().ok()?;
        Some(Root {
            value: tried.value,
            chi: division.chi()?,
            chi_signed: division.chi_signed()?,
            smaller: Smaller::of(division, self.cell(tried.value).is_mirror_symmetric())?,
            u_furrow: division.u_furrow()?,
            t_end: division.t_end,
            second_neck: division.second_neck,
        })
    }

    /// Runs of values without a division.
    fn gaps(&self) -> Vec<Gap> {
        let runs = self.tried.chunk_by(|a, b| a.outcome.is_none() && b.outcome.is_none());
        let gap = |run: &[Tried]| {
            let (first, last) = (run.first()?, run.last()?);
            let why = match &first.found {
                Ok(_) if first.outcome.is_some() => return None,
                Ok(_) => "the cell comes to rest undivided".to_owned(),
                Err(why) => why.clone(),
            };
            Some(Gap { from: first.value, to: last.value, why })
        };
        runs.filter_map(gap).collect()
    }
}
