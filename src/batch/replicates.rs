//! One cell divided several times, with noise of different seeds.

use super::memo::Memo;
use super::scheduler::{self, Job, SchedulerError, SchedulerOptions, Summary};
use crate::division::{Division, DivisionError, DivisionInput, divide};

/// Divisions of one cell with the seeds from `input.seed` on, each as soon as a worker is free; fewer than asked for only if
/// the run was interrupted.
///
/// # Errors
/// [`SchedulerError`] if one could not be computed, after all others are done, or if no workers can be started.
pub fn replicates(
    input: &DivisionInput,
    count: usize,
    memo: &Memo<DivisionInput>,
    options: &SchedulerOptions<'_, DivisionInput>,
) -> Result<(Vec<Division>, Summary), SchedulerError<DivisionError>> {
    let seeded = |id: usize| DivisionInput { seed: input.seed.wrapping_add(id as u64), ..input.clone() };
    let jobs = (0..count).map(|id| Job { id, task: seeded(id) }).collect();
    let mut divisions = vec![None; count];
    let summary = scheduler::run(jobs, memo, options, divide, |id, division| {
        divisions[id] = Some(division.clone());
        vec![]
    })?;
    Ok((divisions.into_iter().flatten().collect(), summary))
}
