//! Predictions of what was left out: fits to all other data, each from the fit to all.

use furrow_lineage::batch::scheduler;
use furrow_spectra::Svd;

use super::Question;
use super::noise::{Noise, NoiseKind};
use super::observations::{Observation, Observations};
use super::others::{self, Others, OthersScore};
use super::scores::{Fitted, beside_all, means, own_deviance};
use crate::fit::FitError;
use crate::fit::chain::Model;
use crate::fit::germline::{Beside, Objective};
use crate::fit::search::{descend, valley};

/// Most steps of a fit without a part of the data, most halvings of a step, and the longest step in shares of the ranges.
const STEPS: usize = 12;
const HALVINGS: usize = 4;
const LONGEST: f64 = 0.25;
/// Steps end here: in shares of the ranges, and relative to the misfit.
const SHORTEST: f64 = 1e-7;
const GAIN: f64 = 1e-10;
/// The misfit that a step must be expected to gain: a hundredth of the error of χ.
const LEAST_GAIN: f64 = 1e-4;
/// Directions held this much less firmly than the firmest one stay where all data put them.
const OPEN: f64 = 1e-4;
/// Edge and steps of the simplex where these steps lead to no minimum, and the first step of a fit of one number.
const EDGE: f64 = 0.01;
const DESCENT: u64 = 40;

/// The rows of all other units.
pub(super) fn without(rows: &[Observation], unit: usize) -> Vec<Observation> {
    rows.iter().filter(|row| row.unit != unit).cloned().collect()
}

/// The log density of the divisions of a unit under χ of the cells, with the errors of all other divisions, the rows `kept`.
pub(super) fn held_out(
    observations: &Observations,
    (kept, noise): (&[Observation], &Noise),
    unit: usize,
    chi: &[Option<f64>],
) -> f64 {
    let own: Vec<Observation> = observations.rows.iter().filter(|row| row.unit == unit).cloned().collect();
    noise.log_likelihood(&own, chi, &noise.fitted(&own, kept, chi))
}

impl Fitted<'_> {
    /// Whether the other data, the rows `kept`, determine the fit and its errors well enough to predict a unit.
    fn is_determined(&self, unit: usize, (kept, noise): (&[Observation], &Noise), numbers: usize) -> bool {
        let Observations { rows, others, cells, .. } = self.question.observations;
        let has = |cell: usize| kept.iter().any(|row| row.cell == cell);
        let beside: usize = others.iter().map(Others::len).sum();
        let has_errors = match noise.kind {
            NoiseKind::Given => true,
            // As many numbers as data leave no residuals.
            NoiseKind::Common => !kept.is_empty() && kept.len() + beside > numbers,
            NoiseKind::Replicates => noise.sd.is_some(),
        };
        let known = (0..cells.len()).filter(|cell| has(*cell)).count() + beside;
        has_errors && (known >= numbers || rows.iter().filter(|row| row.unit == unit).all(|row| has(row.cell)))
    }

    /// The log density of the divisions of a unit, fitted without it; `None` if the other data do not determine it. `chi` is the fit to all
    /// data.
    pub(super) fn left_out(
        &self,
        unit: usize,
        chi: &[Option<f64>],
        (model, beside): (Model<'_>, Option<Beside<'_>>),
    ) -> Result<Option<f64>, FitError> {
        self.objective.check_cancelled()?;
        let Question { observations, noise, .. } = *self.question;
        let kept = without(&observations.rows, unit);
        let own = noise.of_part(&kept);
        if !self.is_determined(unit, (&kept, &own), self.counted(chi)) {
            return Ok(None);
        }
        let predicted = if self.place.is_empty() {
            chi.to_vec()
        } else {
            let measured = means(&kept, &own.sds(&kept), &observations.cells);
            let deviance = own_deviance(observations, &kept, &own);
            let objective = beside_all(model, &measured, beside).by(deviance.as_ref().map(|of| of as _));
            let place = self.refitted(&objective, &kept, &own);
            objective.check_cancelled()?;
            // Also of a cell that only this unit has.
            objective.model.chi(&objective.model.values(&place), &observations.cells)
        };
        Ok(Some(held_out(observations, (&kept, &own), unit, &predicted)))
    }

    /// The scores of rounds and lifetimes, each also predicted by a fit without it. `values` are from the fit to all data.
    pub(super) fn others<'m>(
        &self,
        values: &[f64],
        model: impl Fn() -> Model<'m> + Sync,
    ) -> Result<Vec<OthersScore>, FitError> {
        let Question { observations: Observations { others: all, rows, .. }, noise, .. } = *self.question;
        if all.is_empty() {
            return Ok(Vec::new());
        }
        let tree = others::grown(&self.objective.model, values);
        let one = |k: usize| {
            let own = &all[k];
            let kept: Vec<&Others> =
                all.iter().enumerate().filter(|(j, _)| *j != k).map(|(_, others)| others).collect();
            let beside = |model: &Model<'_>, values: &[f64]| others::summed(&kept, model, values, Others::misfit);
            let objective = beside_all(model(), self.objective.measured, Some(&beside)).by(self.objective.deviance);
            let place = if self.place.is_empty() { Vec::new() } else { self.refitted(&objective, rows, noise) };
            objective.check_cancelled()?;
            let without = others::grown(&objective.model, &objective.model.values(&place));
            Ok(own.scored(tree.as_ref(), own.log_likelihood(without.as_ref())))
        };
        scheduler::in_parallel(all.len(), one).into_iter().collect()
    }

    /// The place of the least misfit of other data near the one of all data, by the rows of χ and their errors: of one number the bottom of
    /// its valley, of several the end of steps with the slopes there or, where these do not lead to one, of a simplex.
    fn refitted(&self, objective: &Objective<'_>, rows: &[Observation], noise: &Noise) -> Vec<f64> {
        let misfit = |place: &[f64]| objective.misfit(place);
        let start = (self.place.to_vec(), misfit(self.place));
        if self.place.len() == 1 {
            return valley(start, EDGE, &misfit).0;
        }
        let step = |place: &[f64]| self.step(objective, place, self.slopes?, (rows, noise));
        let (found, has_ended) = if self.slopes.is_some() { stepped(start, step, &misfit) } else { (start, false) };
        let better = if has_ended { None } else { descend(&found.0, EDGE, DESCENT, &misfit) };
        better.filter(|(_, least)| *least < found.1).unwrap_or(found).0
    }

    /// The step of Gauss and Newton in shares of the ranges, under folded errors by Fisher's information. Cells that do not divide have no
    /// say in it.
    fn step(
        &self,
        objective: &Objective<'_>,
        place: &[f64],
        slopes: &[Vec<f64>],
        (kept, noise): (&[Observation], &Noise),
    ) -> Option<Vec<f64>> {
        let cells = &self.question.observations.cells;
        let chi = objective.model.chi(&objective.model.values(place), cells);
        let sds = noise.fitted(kept, kept, &chi);
        let (mut rows, mut off) = (Vec::new(), Vec::new());
        for (cell, chi) in chi.iter().enumerate().filter_map(|(cell, chi)| Some((cell, (*chi)?))) {
            let of_cell = kept.iter().zip(&sds).filter(|(row, _)| row.cell == cell);
            let [score, information] = of_cell
                .map(|(row, sd)| noise.score(row, chi, *sd))
                .fold([0.0; 2], |sum, one| [sum[0] + one[0], sum[1] + one[1]]);
            // Where an equal division is measured, folded errors say nothing of its χ.
            if information > 0.0 {
                let weight = information.sqrt();
                rows.push(self.by_share(&slopes[cell]).map(|slope| slope * weight).collect::<Vec<f64>>());
                off.push(-score / weight);
            }
        }
        bounded(place, rows, &off)
    }
}

/// The step from a place of the unit cube to the least |rows·x + off|², no longer than [`LONGEST`]; `None` if it is too short or gains too
/// little. Numbers stay at an end of their ranges that they would leave.
fn bounded(place: &[f64], mut rows: Vec<Vec<f64>>, off: &[f64]) -> Option<Vec<f64>> {
    let mut stays = vec![false; place.len()];
    let step = loop {
        let (step, gain) = least_squares(&rows, off)?;
        let leaves = |k: &usize| {
            let way = if step[*k] < 0.0 { place[*k] } else { 1.0 - place[*k] };
            !stays[*k] && step[*k] != 0.0 && way <= SHORTEST
        };
        let Some(k) = (0..place.len()).find(leaves) else { break Some(step).filter(|_| gain > LEAST_GAIN)? };
        stays[k] = true;
        rows.iter_mut().for_each(|row| row[k] = 0.0);
    };
    let longest = step.iter().fold(0.0, |longest: f64, x| longest.max(x.abs()));
    let share = (LONGEST / longest).min(1.0);
    (longest > SHORTEST).then(|| step.iter().map(|x| share * x).collect())
}

/// The place where steps end, each shortened until the misfit falls, its misfit, and whether the last step was short or gained little.
fn stepped(
    (mut place, mut least): (Vec<f64>, f64),
    step: impl Fn(&[f64]) -> Option<Vec<f64>>,
    misfit: &dyn Fn(&[f64]) -> f64,
) -> ((Vec<f64>, f64), bool) {
    for _ in 0..STEPS {
        let Some(step) = step(&place) else { return ((place, least), true) };
        let tried = (0..HALVINGS).find_map(|halvings| {
            let share = 0.5_f64.powi(halvings as i32);
            let next: Vec<f64> = place.iter().zip(&step).map(|(x, d)| (x + share * d).clamp(0.0, 1.0)).collect();
            let found = misfit(&next);
            (found < least).then_some((next, found))
        });
        let Some((next, found)) = tried else { break };
        let is_done = least - found < GAIN * (1.0 + least);
        (place, least) = (next, found);
        if is_done {
            return ((place, least), true);
        }
    }
    ((place, least), false)
}

/// The shortest vector x with the least |rows·x + off|², without the directions that the rows hold least, and by how much it is smaller than
/// |off|².
fn least_squares(rows: &[Vec<f64>], off: &[f64]) -> Option<(Vec<f64>, f64)> {
    let svd = Svd::of_rows(rows).ok()?;
    let firmest = svd.values.first().copied()?;
    let (mut found, mut gain) = (vec![0.0; svd.right.first()?.len()], 0.0);
    for ((value, left), right) in svd.values.iter().zip(&svd.left).zip(&svd.right) {
        if *value > OPEN * firmest {
            let along: f64 = left.iter().zip(off).map(|(u, r)| u * r).sum();
            found.iter_mut().zip(right).for_each(|(x, v)| *x -= along / value * v);
            gain += along * along;
        }
    }
    Some((found, gain))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two numbers that go together, one of them at the end of its range, where it stays: by hand the least of (x − 1.2)² + 4(x + y − 1.5)² with
    /// x at most 1 has y = 0.5. From a place inside the steps lead there too.
    #[test]
    fn steps_end_at_the_least_misfit_within_the_ranges() {
        let off = |place: &[f64]| [place[0] - 1.2, 2.0 * (place[0] + place[1] - 1.5)];
        let misfit = |place: &[f64]| off(place).iter().map(|off| off * off).sum::<f64>();
        let step = |place: &[f64]| bounded(place, vec![vec![1.0, 0.0], vec![2.0, 2.0]], &off(place));
        for start in [[1.0, 0.1], [0.3, 0.9]] {
            let ((place, _), has_ended) = stepped((start.to_vec(), misfit(&start)), step, &misfit);
            assert!(has_ended && place[0] == 1.0 && (place[1] - 0.5).abs() < 1e-6, "{place:?}");
        }
    }
}
