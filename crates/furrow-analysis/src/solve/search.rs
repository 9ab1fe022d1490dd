//! The search for roots: a scan, refined where the outcome passes the wanted one and where cells cease to divide.

use std::cell::RefCell;

use argmin::core::{CostFunction, Error, Executor};
use argmin::solver::brent::BrentRoot;
use furrow_cell::{Parameter, Settings};
use furrow_lineage::batch::scheduler::{self, Solved};
use furrow_lineage::batch::{self, phase::spaced};
use furrow_lineage::batch::{Memo, SchedulerOptions, StoreWarning};
use furrow_mechanics::division::{Division, DivisionInput};
use ordered_float::OrderedFloat;

use super::{Extreme, Gap, Jump, Question, Root, Smaller, Solution, SolveError, TOLERANCE};

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
    let mut search = Search { question, memo, options, tried: Vec::new(), warnings: Vec::new() };
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
        let Some(bracket) = search.brackets().next() else { break };
        search = search.refined(bracket)?;
    }
    Ok(search.solution())
}

/// A value that was tried, with its division or the reason for its absence.
struct Tried {
    value: f64,
    found: Result<Division, String>,
    /// Outcome − wanted.
    off: Option<f64>,
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
        let Question { cell, parameter, numerics, seed, .. } = self.question;
        let mut cell = cell.clone();
        parameter.set(&mut cell, value);
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
        let Question { measure, wanted, .. } = *self.question;
        self.tried.extend(found.into_iter().map(|(value, found)| {
            let off = found.as_ref().ok().and_then(|division| measure.of(division)).map(|outcome| outcome - wanted);
            Tried { value, found, off }
        }));
        self.tried.sort_by_cached_key(|item| OrderedFloat(item.value));
        Ok(())
    }

    /// Outcome − wanted at a value, which is tried unless it was.
    fn off(&mut self, value: f64) -> Result<Option<f64>, SolveError> {
        let known = |search: &Self| search.tried.iter().find(|tried| tried.value == value).map(|tried| tried.off);
        if let Some(off) = known(self) {
            return Ok(off);
        }
        self.try_all(&[value])?;
        Ok(known(self).flatten())
    }

    /// Values beside places where the outcome comes near the wanted one and turns back: there may be two roots between them.
    fn turns(&self) -> Vec<f64> {
        let mut values: Vec<f64> = Vec::new();
        for three in self.tried.windows(3) {
            let [Some(before), Some(here), Some(behind)] = [three[0].off, three[1].off, three[2].off] else { continue };
            let [before, behind] = [before, behind].map(|off| (off - here) * here.signum());
            // As far as it has come, it may go again.
            if before > 0.0 && behind > 0.0 && here.abs() < before.max(behind) && here.abs() > 0.0 {
                values.extend(three.windows(2).map(|two| 0.5 * (two[0].value + two[1].value)));
            }
        }
        values.dedup();
        values
    }

    /// Midpoints between neighbours where only one divides, unless they are close.
    fn edges(&self) -> Vec<f64> {
        let [from, to] = self.question.range;
        let open = |two: &&[Tried]| {
            two[0].off.is_some() != two[1].off.is_some() && two[1].value - two[0].value > EDGE * (to - from).abs()
        };
        self.tried.windows(2).filter(open).map(|two| 0.5 * (two[0].value + two[1].value)).collect()
    }

    /// Neighbours between which the outcome passes the wanted one, and which are not close yet.
    fn brackets(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        let tolerance = 2.0 * self.tolerance();
        self.crossings()
            .filter(move |two| two[1].value - two[0].value > tolerance)
            .map(|two| [two[0].value, two[1].value])
    }

    /// Neighbours between which the outcome passes the wanted one.
    fn crossings(&self) -> impl Iterator<Item = &[Tried]> {
        self.tried.windows(2).filter(|two| matches!((two[0].off, two[1].off), (Some(a), Some(b)) if a * b < 0.0))
    }

    /// The search after Brent's method in a bracket, which ends early where the cell does not divide.
    fn refined(self, [from, to]: [f64; 2]) -> Result<Self, SolveError> {
        struct Off<'s, 'a>(&'s RefCell<Search<'a>>);
        impl CostFunction for Off<'_, '_> {
            type Param = f64;
            type Output = f64;

            fn cost(&self, value: &f64) -> Result<f64, Error> {
                Ok(self.0.borrow_mut().off(*value)?.ok_or(NoDivision)?)
            }
        }
        let (tolerance, search) = (self.tolerance(), RefCell::new(self));
        let run = Executor::new(Off(&search), BrentRoot::new(from, to, tolerance)).run();
        match run.map(drop).map_err(|error| error.downcast::<SolveError>()) {
            Err(Ok(error)) => Err(error),
            _ => Ok(search.into_inner()),
        }
    }

    fn solution(self) -> Solution {
        let Question { measure, wanted, .. } = *self.question;
        let (mut roots, mut jumps): (Vec<Root>, Vec<Jump>) = (Vec::new(), Vec::new());
        roots.extend(self.tried.iter().filter(|tried| tried.off == Some(0.0)).filter_map(|tried| self.root(tried)));
        for two in self.crossings() {
            let [before, behind] = [&two[0], &two[1]].map(|tried| tried.off.unwrap_or(f64::NAN));
            if (behind - before).abs() > measure.continuous(wanted) {
                let outcomes = [before + wanted, behind + wanted];
                jumps.push(Jump { between: [two[0].value, two[1].value], outcomes });
            } else {
                roots.extend(self.root(&two[usize::from(behind.abs() < before.abs())]));
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
        let mut cell = self.question.cell.clone();
        self.question.parameter.set(&mut cell, tried.value);
        Some(Root {
            value: tried.value,
            chi: division.chi()?,
            chi_signed: division.chi_signed()?,
            smaller: Smaller::of(division, cell.is_mirror_symmetric())?,
            u_furrow: division.u_furrow()?,
            t_end: division.t_end,
        })
    }

    /// Runs of values without a division.
    fn gaps(&self) -> Vec<Gap> {
        let runs = self.tried.chunk_by(|a, b| a.off.is_none() && b.off.is_none());
        let gap = |run: &[Tried]| {
            let (first, last) = (run.first()?, run.last()?);
            let why = match &first.found {
                Ok(_) if first.off.is_some() => return None,
                Ok(_) => "the cell comes to rest undivided".to_owned(),
                Err(why) => why.clone(),
            };
            Some(Gap { from: first.value, to: last.value, why })
        };
        runs.filter_map(gap).collect()
    }
}
