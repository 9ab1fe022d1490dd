//! The first pitchfork of a mirror-symmetric cell: the threshold ξ_s* at which its symmetry breaks.

use super::branch::{Branch, BranchEnd, BranchEvent, BranchOptions, Pitchfork};
use super::budget::StepBudget;
use super::error::{CellName, PointKind, Result, ShapeError};
use super::primary;
use furrow_cell::{Cell, Numerics};

/// The first pitchfork of the primary branch of a mirror-symmetric cell.
///
/// ```
/// use furrow_cell::{Cell, Numerics};
/// use furrow_mechanics::equilibria::{BranchOptions, pitchfork};
///
/// let found = pitchfork::first(&Cell::new(2.0), &Numerics::default(), &BranchOptions::default())?;
/// assert!((found.point.xi_s - 22.06475).abs() < 1e-5);
/// # Ok::<(), furrow_mechanics::equilibria::ShapeError>(())
/// ```
///
/// # Errors
/// [`ShapeError`]; `NotFound` if there is no pitchfork up to the end of the range, `TurnsBack` if the branch ends without activity, `NoPitchfork` if the cell's cue breaks
/// the symmetry.
pub fn first(cell: &Cell, numerics: &Numerics, options: &BranchOptions) -> Result<Pitchfork> {
    first_within(cell, numerics, options, &StepBudget::unlimited())
}

/// The primary branch of a mirror-symmetric cell, with its first pitchfork and all its folds. If the pitchfork comes
/// first, the branch up to it is computed on a coarse mesh, as in [`first`]; folds lie on the given mesh.
///
/// # Errors
/// The errors of [`primary::follow`].
pub(super) fn branch_beyond(cell: &Cell, numerics: &Numerics) -> Result<Branch> {
    let options = BranchOptions { pitchforks: 1, ..BranchOptions::default() };
    let quick = BranchOptions { coarse: true, ..options.clone() };
    let mut refined = false;
    let found = primary::follow(cell, numerics, &quick, |event| {
        refined |= event.kind() == PointKind::Pitchfork;
        refined
    });
    match found {
        Ok(branch) if branch.events.first().is_some_and(|event| event.pitchfork().is_some()) => Ok(branch),
        _ => primary::follow(cell, numerics, &options, |_| true),
    }
}

/// As [`first`], within a budget.
///
/// # Errors
/// The errors of [`first`] and of [`primary::follow_within`].
pub fn first_within(
    cell: &Cell,
    numerics: &Numerics,
    options: &BranchOptions,
    budget: &StepBudget<'_>,
) -> Result<Pitchfork> {
    let name = CellName::of(cell);
    if !cell.is_mirror_symmetric() {
        let law = cell.law.as_ref().filter(|law| !law.is_mirror_symmetric(cell));
        let shell = cell.shell_profile.as_ref().filter(|profile| !profile.is_mirror_symmetric());
        let cue = match (law, shell) {
            (Some(law), _) => format!("the law {:?}", law.name()),
            (None, Some(shell)) => format!("the shell {:?}", shell.name()),
            (None, None) => format!("the cue {}", cell.cue),
        };
        return Err(ShapeError::NoPitchfork { cell: name, cue });
    }
    let mut unwanted = |event: &BranchEvent| event.kind() != PointKind::Pitchfork;
    // The coarse mesh misses narrow necks: if it gives a fold first, or no pitchfork, the given mesh decides.
    let quick = BranchOptions { coarse: true, ..options.clone() };
    let mut either = |_: &BranchEvent| false;
    if let Ok(Branch { events, .. }) = primary::follow_within(cell, numerics, &quick, budget, &mut either)
        && let Some(found) = events.first().and_then(BranchEvent::pitchfork)
    {
        return Ok(found.clone());
    }
    let Branch { events, ended, .. } = primary::follow_within(cell, numerics, options, budget, &mut unwanted)?;
    let fold = events.iter().take_while(|event| event.kind() == PointKind::Fold).next();
    let beyond_fold = fold.map(|fold| fold.point().xi_s);
    let found = events.iter().find_map(BranchEvent::pitchfork);
    found.map(|found| Pitchfork { beyond_fold, ..found.clone() }).ok_or_else(|| {
        let [least, xi_max] = options.xi;
        let none = match beyond_fold {
            Some(xi_s) if ended == BranchEnd::Bound(least) => ShapeError::TurnsBack { cell: name, xi_s },
            _ => ShapeError::NotFound { cell: name, kind: PointKind::Pitchfork, xi_max },
        };
        ended.error().cloned().unwrap_or(none)
    })
}
