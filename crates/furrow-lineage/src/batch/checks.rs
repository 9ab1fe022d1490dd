//! Whether the noise or the mesh decides how a cell divides.
//!
//! A first check costs little: the division with another seed on half the mesh, with four times the tolerance in time. If it agrees
//! with the division, neither decides. Otherwise the two effects are computed separately, with the other seed on the cell's own mesh
//! and with the cell's own seed on twice the mesh.

use super::memo::{Failure, Memo};
use super::scheduler::{SchedulerError, SchedulerOptions, Solved, Summary, Unsolved, solve_all};
use super::solve::solve;
use furrow_cell::Numerics;
use furrow_mechanics::division::outcome::NOISE_TOLERANCE;
use furrow_mechanics::division::{Division, DivisionInput};

/// The same division with the next seed.
fn next_seed(input: &DivisionInput) -> DivisionInput {
    DivisionInput { seed: input.seed.wrapping_add(1), ..input.clone() }
}

/// The effects of the noise and of the mesh on a division.
#[derive(Clone, Debug, Default)]
pub struct Effects {
    /// The first check, if it shows that neither decides.
    pub settled: Option<Settled>,
    /// The effect of the noise alone.
    pub noise: Option<NoiseEffect>,
    /// The effect of the mesh alone.
    pub mesh: Option<MeshEffect>,
}

/// A division with its checks.
#[derive(Clone, Debug)]
pub struct Checked {
    /// The division.
    pub division: Division,
    /// Its checks.
    pub effects: Effects,
    /// The summary of the work.
    pub summary: Summary,
}

/// Solves a division and its checks, in parallel; `None` if the run was interrupted.
///
/// # Examples
/// Two furrows compete in a large cell, and the seed decides how unequal its daughters are:
///
/// ```
/// use furrow_lineage::batch::{Memo, Quantisation, SchedulerOptions, checks::checked};
/// use furrow_cell::Cell;
/// use furrow_mechanics::division::DivisionInput;
/// let memo = Memo::new(Quantisation::DEFAULT);
/// let effects = |r0: f64| {
///     let found = checked(&DivisionInput::new(Cell::new(r0)), &memo, &SchedulerOptions::default())?;
///     Ok::<_, Box<dyn std::error::Error>>(found.ok_or("interrupted")?.effects)
/// };
/// assert!(effects(2.5)?.settled.is_some());
/// assert!(effects(5.6)?.noise.is_some_and(|noise| noise.decides));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`SchedulerError::Unsolved`] with the division, if it fails itself; a failed check only leaves its effect unknown.
/// [`SchedulerError::Pool`] if no workers can be started.
pub fn checked(
    input: &DivisionInput,
    memo: &Memo,
    options: &SchedulerOptions<'_>,
) -> Result<Option<Checked>, SchedulerError> {
    let check = input.coarsened().map(|half| next_seed(&half));
    let first = std::iter::once(input.clone()).chain(check.clone());
    let Solved { divisions, unsolved, mut summary } = solve_all(first, memo, options, solve)?;
    let mut divisions = divisions.into_iter();
    let Some(division) = divisions.next().flatten() else {
        let failed: Vec<Unsolved> = unsolved.into_iter().filter(|job| job.id == 0).collect();
        return match failed.is_empty() {
            true => Ok(None),
            false => Err(SchedulerError::Unsolved { jobs: failed, summary: Box::new(summary) }),
        };
    };
    let of_check = check.zip(divisions.next().flatten());
    let settled = of_check.and_then(|(check, other)| Settled::of(input, &division, check, other));
    if settled.is_some() {
        return Ok(Some(Checked { division, effects: Effects { settled, ..Effects::default() }, summary }));
    }
    // The refined division takes longest and starts first.
    let (refined, next) = (input.refined(), next_seed(input));
    let separate = refined.iter().chain([&next]).cloned();
    let mut found = solve_all(separate, memo, options, solve)?;
    let other = found.divisions.pop().flatten();
    let noise = NoiseEffect::of(input, &division, other.iter().map(|other| (next.seed, other)));
    let mesh = refined.and_then(|refined| MeshEffect::between(&division, &refined, &mut found));
    summary.add(found.summary);
    Ok(Some(Checked { division, effects: Effects { settled: None, noise, mesh }, summary }))
}

/// The first check of a division that neither the noise nor the mesh decides.
#[derive(Clone, Debug)]
pub struct Settled {
    /// The check: another seed on half the mesh.
    pub check: DivisionInput,
    /// Its division.
    pub other: Division,
    /// The difference in χ, if both divide.
    pub chi_apart: Option<f64>,
}

impl Settled {
    /// The check if both end alike, with χ within the [`NOISE_TOLERANCE`].
    fn of(input: &DivisionInput, division: &Division, check: DivisionInput, other: Division) -> Option<Settled> {
        let parity = input.cell.is_mirror_symmetric();
        let chi_apart = division.chi_apart(&other, parity);
        let agrees = division.agrees_with(&other, parity) && chi_apart.is_none_or(|apart| apart <= NOISE_TOLERANCE);
        agrees.then_some(Settled { check, other, chi_apart })
    }
}

/// The effect of another seed on a division.
#[derive(Clone, Debug)]
pub struct NoiseEffect {
    /// The other seed.
    pub seed: u64,
    /// The division with this seed.
    pub other: Division,
    /// Whether the seed changes more than the side of the furrow.
    pub decides: bool,
}

impl NoiseEffect {
    /// The effect on the division of `input`, from the first of the others that disagrees with it, otherwise from the first.
    pub fn of<'a>(
        input: &DivisionInput,
        division: &Division,
        others: impl IntoIterator<Item = (u64, &'a Division)>,
    ) -> Option<NoiseEffect> {
        let differs = |other: &Division| !division.agrees_with(other, input.cell.is_mirror_symmetric());
        let mut others = others.into_iter().peekable();
        let first = others.peek().copied();
        let found = others.find(|(_, other)| differs(other));
        let (seed, other) = found.or(first)?;
        Some(NoiseEffect { seed, other: other.clone(), decides: found.is_some() })
    }
}

/// The effect of twice the mesh, with a quarter of the tolerance in time, on a division.
#[derive(Clone, Debug)]
pub struct MeshEffect {
    /// The finer mesh and tolerance.
    pub finer: Numerics,
    /// The division on the finer mesh, or its error.
    pub other: Result<Division, Failure>,
    /// Whether it disagrees with the division on the given mesh.
    pub decides: bool,
    /// The difference in χ, if both divide.
    pub chi_apart: Option<f64>,
}

impl MeshEffect {
    /// The effect on the division of `input`; `None` if no mesh may be so fine, or if the run was interrupted.
    ///
    /// # Errors
    /// [`SchedulerError`] if no workers can be started.
    pub fn of(
        input: &DivisionInput,
        division: &Division,
        memo: &Memo,
        options: &SchedulerOptions<'_>,
    ) -> Result<Option<MeshEffect>, SchedulerError> {
        let Some(refined) = input.refined() else { return Ok(None) };
        let mut found = solve_all([refined.clone()], memo, options, solve)?;
        Ok(MeshEffect::between(division, &refined, &mut found))
    }

    /// The effect, from a run whose first job is the refined division; `None` if the run was interrupted before.
    fn between(division: &Division, refined: &DivisionInput, run: &mut Solved) -> Option<MeshEffect> {
        let failed = run.unsolved.iter().find(|job| job.id == 0).map(|job| Err(job.failure.clone()));
        let other = run.divisions.first_mut()?.take().map(Ok).or(failed)?;
        let parity = refined.cell.is_mirror_symmetric();
        let decides = other.as_ref().map_or(true, |other| division.depends_on_numerics(other, parity));
        let chi_apart = other.as_ref().ok().and_then(|other| division.chi_apart(other, parity));
        Some(MeshEffect { finer: refined.numerics, other, decides, chi_apart })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::Quantisation;
    use furrow_cell::Cell;

    fn effects(r0: f64) -> Effects {
        let memo = Memo::new(Quantisation::DEFAULT);
        let input = DivisionInput::new(Cell::new(r0));
        checked(&input, &memo, &SchedulerOptions::default()).unwrap().unwrap().effects
    }

    #[test]
    fn the_first_check_suffices_for_a_cell_with_one_furrow() {
        let Settled { check, chi_apart, .. } = effects(2.5).settled.unwrap();
        assert_eq!((check.seed, check.numerics.intervals), (1, 24));
        assert!(chi_apart.unwrap() < NOISE_TOLERANCE);
    }

    #[test]
    fn the_effects_are_separate_where_two_furrows_compete() {
        let Effects { settled, noise, mesh } = effects(5.6);
        assert!(settled.is_none() && noise.unwrap().decides);
        let mesh = mesh.unwrap();
        assert!(!mesh.decides && mesh.finer.intervals == 96);
    }
}
