//! Divisions of one cell with noise of several seeds.

use super::memo::{Memo, Solve};
use super::scheduler::{self, SchedulerError, SchedulerOptions, Solved, Summary, Unsolved};
use super::solve::solve;
use furrow_mechanics::division::{Division, DivisionInput};

/// Divisions of one cell with noise of several seeds.
#[derive(Clone, Debug, PartialEq)]
pub struct Replicates {
    /// Seeds and divisions, in the order of the seeds. If they and the undecided ones are fewer than requested, the run was
    /// interrupted.
    pub divisions: Vec<(u64, Division)>,
    /// Divisions that could not be computed; their `id`s count from the first seed.
    pub undecided: Vec<Unsolved>,
    /// The summary of the work.
    pub summary: Summary,
}

/// Divisions of one cell with consecutive seeds from `input.seed`, each started as soon as a worker is free.
///
/// # Examples
/// Noise determines the side of the smaller daughter. It has little effect on her size:
///
/// ```
/// use furrow_lineage::batch::{Memo, Quantisation, SchedulerOptions, replicates};
/// use furrow_cell::Cell;
/// use furrow_mechanics::division::DivisionInput;
/// let memo = Memo::new(Quantisation::DEFAULT);
/// let found = replicates(&DivisionInput::new(Cell::new(2.0)), 3, &memo, &SchedulerOptions::default())?;
/// assert_eq!((found.divisions.len(), found.summary.solved), (3, 3));
/// assert!(found.divisions.iter().all(|(_, division)| (division.chi().unwrap() - 0.823).abs() < 0.005));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`SchedulerError`] if no workers can be started.
pub fn replicates(
    input: &DivisionInput,
    count: usize,
    memo: &Memo,
    options: &SchedulerOptions<'_>,
) -> Result<Replicates, SchedulerError> {
    replicates_by(solve, input, count, memo, options)
}

/// The same with a solver that may keep more than the divisions, such as their shapes. It is not called for divisions in the memo.
///
/// # Errors
/// [`SchedulerError`] if no workers can be started.
pub fn replicates_by(
    solve: impl Solve,
    input: &DivisionInput,
    count: usize,
    memo: &Memo,
    options: &SchedulerOptions<'_>,
) -> Result<Replicates, SchedulerError> {
    let seed = |id: usize| input.seed.wrapping_add(id as u64);
    let inputs = (0..count).map(|id| DivisionInput { seed: seed(id), ..input.clone() });
    let Solved { divisions, unsolved, summary } = scheduler::solve_all(inputs, memo, options, solve)?;
    let solved = divisions.into_iter().enumerate().filter_map(|(id, division)| Some((seed(id), division?)));
    Ok(Replicates { divisions: solved.collect(), undecided: unsolved, summary })
}
