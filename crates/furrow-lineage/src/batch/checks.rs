//! Whether the noise or the mesh decides how a cell divides.
//!
//! A first check costs little: the division with another seed on half the mesh, with four times the tolerance in time. If it agrees
//! with the division, neither decides. Otherwise the two effects are computed separately, with the other seed on the cell's own mesh
//! and with the cell's own seed on twice the mesh.

use super::memo::{Failure, Memo};
use super::scheduler::{SchedulerError, SchedulerOptions, solve_all};
use super::solve::solve;
use furrow_cell::Numerics;
use furrow_mechanics::division::outcome::NOISE_TOLERANCE;
use furrow_mechanics::division::{Division, DivisionInput};

/// The same division with the next seed.
pub fn next_seed(input: &DivisionInput) -> DivisionInput {
    DivisionInput { seed: input.seed.wrapping_add(1), ..input.clone() }
}

/// The division of the first check; `None` if half the mesh is too coarse for a division.
pub fn first_check(input: &DivisionInput) -> Option<DivisionInput> {
    input.coarsened().map(|half| next_seed(&half))
}

/// A division that neither the noise nor the mesh decides.
#[derive(Clone, Debug)]
pub struct Settled {
    /// The division.
    pub division: Division,
    /// The input of the [`first_check`].
    pub check: DivisionInput,
    /// Its division.
    pub other: Division,
    /// The difference in χ, if both divide.
    pub chi_apart: Option<f64>,
}

impl Settled {
    /// The division of `input` if the memo has it and the [`first_check`], and both end alike with χ within the [`NOISE_TOLERANCE`].
    pub fn of_known(input: &DivisionInput, memo: &Memo) -> Option<Settled> {
        let check = first_check(input)?;
        let [division, other] = [memo.known(input)?, memo.known(&check)?];
        let parity = input.cell.is_mirror_symmetric();
        let chi_apart = division.chi_apart(&other, parity);
        let agrees = division.agrees_with(&other, parity) && chi_apart.is_none_or(|apart| apart <= NOISE_TOLERANCE);
        agrees.then_some(Settled { division, check, other, chi_apart })
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
    /// The division with these, or the reason why there is none.
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
        let (parity, finer) = (input.cell.is_mirror_symmetric(), refined.numerics);
        let mut found = solve_all([refined], memo, options, solve)?;
        let other = match (found.divisions.pop().flatten(), found.unsolved.pop()) {
            (Some(division), _) => Ok(division),
            (None, Some(job)) => Err(job.failure),
            (None, None) => return Ok(None),
        };
        let decides = other.as_ref().map_or(true, |other| division.depends_on_numerics(other, parity));
        let chi_apart = other.as_ref().ok().and_then(|other| division.chi_apart(other, parity));
        Ok(Some(MeshEffect { finer, other, decides, chi_apart }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::Quantisation;
    use furrow_cell::Cell;

    /// A memo with the division of `input` and its first check.
    fn solved(input: &DivisionInput) -> Memo {
        let memo = Memo::new(Quantisation::DEFAULT);
        let inputs = [input.clone(), first_check(input).unwrap()];
        solve_all(inputs, &memo, &SchedulerOptions::default(), solve).unwrap();
        memo
    }

    #[test]
    fn the_first_check_suffices_for_a_cell_with_one_furrow() {
        let input = DivisionInput::new(Cell::new(2.5));
        assert!(Settled::of_known(&input, &Memo::new(Quantisation::DEFAULT)).is_none());
        let found = Settled::of_known(&input, &solved(&input)).unwrap();
        assert_eq!((found.check.seed, found.check.numerics.intervals), (1, 24));
        assert!(found.chi_apart.unwrap() < 1e-3);
    }

    #[test]
    fn seeds_decide_where_two_furrows_compete() {
        let input = DivisionInput::new(Cell::new(5.6));
        let memo = solved(&input);
        assert!(Settled::of_known(&input, &memo).is_none());
        let [division, other] = [&input, &next_seed(&input)].map(|one| memo.solve(one, solve).unwrap());
        let mesh = MeshEffect::of(&input, &division, &memo, &SchedulerOptions::default()).unwrap().unwrap();
        assert!(!mesh.decides && mesh.finer.intervals == 96);
        assert!(NoiseEffect::of(&input, &division, [(1, &other)]).unwrap().decides);
    }
}
