//! Whether the noise or the mesh decides how a cell divides.
//!
//! A division is compared with one of another seed, and with one on another mesh. Half the mesh with four times the tolerance in time
//! takes half the work, and the difference in χ was at least as large as to twice the mesh in nine of ten random cells, and twelve
//! times as large in the median. Where both comparisons on half the mesh show no difference, nothing more is solved; otherwise the
//! other seed is solved on the cell's own mesh, and the division on twice the mesh.

use super::memo::{Failure, Memo};
use super::scheduler::{SchedulerError, SchedulerOptions, solve_all};
use super::solve::solve;
use furrow_cell::{Cell, Numerics};
use furrow_mechanics::division::outcome::NOISE_TOLERANCE;
use furrow_mechanics::division::{Division, DivisionInput};

/// A division, and what the noise and the mesh change about it.
#[derive(Clone, Debug)]
pub struct Checked {
    /// The division.
    pub division: Division,
    /// The effect of the noise.
    pub noise: NoiseEffect,
    /// The effect of the mesh.
    pub mesh: MeshEffect,
}

impl Checked {
    /// The division, and those on half the mesh with its seed and the next one; `None` if half the mesh is too coarse for a division.
    pub fn inputs(input: &DivisionInput) -> Option<[DivisionInput; 3]> {
        let half = input.coarsened()?;
        Some([input.clone(), half.clone(), next_seed(&half)])
    }

    /// Compares the three divisions of [`Checked::inputs`] if the memo has them; `None` if it lacks one, or if they differ so much
    /// that finer ones must decide.
    pub fn of_known(input: &DivisionInput, memo: &Memo) -> Option<Checked> {
        let [_, half, next] = Checked::inputs(input)?;
        let [division, of_half, other] = [memo.known(input)?, memo.known(&half)?, memo.known(&next)?];
        let noise = NoiseEffect::of(&half, &of_half, [(next.seed, &other)]).filter(|noise| !noise.decides)?;
        let mesh = MeshEffect::between(&division, Ok(of_half), &half);
        mesh.is_none(&division, &input.cell).then_some(Checked { division, noise, mesh })
    }
}

/// The effect of another seed on a division.
#[derive(Clone, Debug)]
pub struct NoiseEffect {
    /// The other seed.
    pub seed: u64,
    /// The division with this seed.
    pub other: Division,
    /// The numerics of both divisions.
    pub numerics: Numerics,
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
        Some(NoiseEffect { seed, other: other.clone(), numerics: input.numerics, decides: found.is_some() })
    }
}

/// The effect of another mesh, and of another tolerance in time, on a division.
#[derive(Clone, Debug)]
pub struct MeshEffect {
    /// The other mesh and tolerance.
    pub numerics: Numerics,
    /// The division with these, or the reason why there is none.
    pub other: Result<Division, Failure>,
    /// Whether it disagrees with the division on the given mesh.
    pub decides: bool,
    /// The difference in χ, if both divide.
    pub chi_apart: Option<f64>,
}

impl MeshEffect {
    /// The effect on the division of `input`: from half the mesh if this shows no difference, otherwise from twice the mesh.
    ///
    /// # Errors
    /// [`SchedulerError`] if no workers can be started.
    pub fn of(
        input: &DivisionInput,
        division: &Division,
        memo: &Memo,
        options: &SchedulerOptions<'_>,
    ) -> Result<Option<MeshEffect>, SchedulerError> {
        for (other, suffices) in [(input.coarsened(), true), (input.refined(), false)] {
            let Some(other) = other else { continue };
            let mut found = solve_all([other.clone()], memo, options, solve)?;
            let result = match (found.divisions.pop().flatten(), found.unsolved.pop()) {
                (Some(division), _) => Ok(division),
                (None, Some(job)) => Err(job.failure),
                // Interrupted.
                (None, None) => return Ok(None),
            };
            let effect = MeshEffect::between(division, result, &other);
            if !suffices || effect.is_none(division, &input.cell) {
                return Ok(Some(effect));
            }
        }
        Ok(None)
    }

    fn between(division: &Division, other: Result<Division, Failure>, input: &DivisionInput) -> MeshEffect {
        let parity = input.cell.is_mirror_symmetric();
        let decides = other.as_ref().map_or(true, |other| division.depends_on_numerics(other, parity));
        let chi_apart = other.as_ref().ok().and_then(|other| division.chi_apart(other, parity));
        MeshEffect { numerics: input.numerics, other, decides, chi_apart }
    }

    /// Whether both divisions end alike, with χ within the [`NOISE_TOLERANCE`].
    fn is_none(&self, division: &Division, cell: &Cell) -> bool {
        self.chi_apart.is_none_or(|apart| apart <= NOISE_TOLERANCE)
            && self.other.as_ref().is_ok_and(|other| division.agrees_with(other, cell.is_mirror_symmetric()))
    }
}

/// The same division with the next seed.
pub fn next_seed(input: &DivisionInput) -> DivisionInput {
    DivisionInput { seed: input.seed.wrapping_add(1), ..input.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::Quantisation;

    /// A memo with the divisions that [`Checked::of_known`] compares.
    fn solved(input: &DivisionInput) -> Memo {
        let memo = Memo::new(Quantisation::DEFAULT);
        solve_all(Checked::inputs(input).unwrap(), &memo, &SchedulerOptions::default(), solve).unwrap();
        memo
    }

    #[test]
    fn half_the_mesh_suffices_for_a_cell_with_one_furrow() {
        let input = DivisionInput::new(Cell::new(2.5));
        assert!(Checked::of_known(&input, &Memo::new(Quantisation::DEFAULT)).is_none());
        let memo = solved(&input);
        let Checked { division, noise, mesh } = Checked::of_known(&input, &memo).unwrap();
        assert!(!noise.decides && !mesh.decides && mesh.numerics.intervals == 24);
        let found = MeshEffect::of(&input, &division, &memo, &SchedulerOptions::default()).unwrap().unwrap();
        assert_eq!((found.numerics, found.chi_apart), (mesh.numerics, mesh.chi_apart));
    }

    #[test]
    fn twice_the_mesh_decides_where_two_furrows_compete() {
        let input = DivisionInput::new(Cell::new(5.6));
        let memo = solved(&input);
        assert!(Checked::of_known(&input, &memo).is_none());
        let [division, other] = [&input, &next_seed(&input)].map(|one| memo.solve(one, solve).unwrap());
        let mesh = MeshEffect::of(&input, &division, &memo, &SchedulerOptions::default()).unwrap().unwrap();
        assert!(!mesh.decides && mesh.numerics.intervals == 96);
        assert!(NoiseEffect::of(&input, &division, [(1, &other)]).unwrap().decides);
    }
}
