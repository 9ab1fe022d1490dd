//! The fit of each hypothesis, and how it predicts what was left out.

use furrow_lineage::batch::scheduler;
use furrow_measured::significance::mean_interval;
use furrow_measured::statistics::{mean, sd};
use furrow_spectra::Svd;
use serde::Serialize;
use std::f64::consts::TAU;

use super::fit_test::{FitTest, fit_test, squared};
use super::folded;
use super::noise::{Noise, NoiseKind, UNDIVIDED, aicc};
use super::observations::{Observation, Observations};
use super::others::{self, Others, OthersScore};
use super::posterior::{Posterior, posterior};
use super::{AtLimit, Hypothesis, Question};
use crate::fit::chain::{Kin, Model};
use crate::fit::germline::{Beside, CueNumber, Objective, at_limit, held, numbers};
use crate::fit::search::{FitRun, SearchBudget, descend};
use crate::fit::targets::MeasuredChi;
use crate::fit::{ChiResidual, FitError, Goodness};

/// Steps of a fit without a part of the data, halvings of a step, and the longest step in shares of the ranges.
const STEPS: usize = 6;
const HALVINGS: usize = 3;
const LONGEST: f64 = 0.25;
/// Steps end here: in shares of the ranges, and relative to the misfit.
const SHORTEST: f64 = 1e-7;
const GAIN: f64 = 1e-10;
/// Directions held this much less firmly than the firmest one stay where all data put them.
const OPEN: f64 = 1e-4;
/// Edge and steps of the simplex in place of these steps, where an outcome is not smooth.
const EDGE: f64 = 0.01;
const DESCENT: u64 = 40;
/// 97.5 % of a standard normal number lie below.
const NORMAL: f64 = 1.959_963_984_540_054;

/// A number that was fitted.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FittedNumber {
    /// Its name, as `cue[0].amplitude` or `epsilon@somatic`.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// Its standard error, if the measurements determine it.
    pub se: Option<f64>,
    /// Between which values was searched.
    pub searched: [f64; 2],
}

/// A cell in the embryos and in the model.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CellScore {
    /// The cell that divides.
    pub cell: String,
    /// Measured divisions.
    pub n: usize,
    /// Their mean |χ|.
    pub measured: f64,
    /// Their standard deviation; `None` for one.
    pub sd: Option<f64>,
    /// 95 % interval of the mean: by the spread of the divisions or, of one, by its given error.
    pub interval: Option<[f64; 2]>,
    /// R0 in the model; `None` if the cell is never born.
    pub r0: Option<f64>,
    /// χ of the model; `None` if the cell does not divide.
    pub chi: Option<f64>,
    /// Whether it carries the cue.
    pub has_cue: bool,
    /// What its divisions add to the log likelihood.
    pub log_likelihood: f64,
}

/// A hypothesis with its fit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TestedHypothesis {
    /// Its name.
    pub name: String,
    /// Its cue with the fitted numbers that all cells share.
    pub cue: String,
    /// The largest log likelihood.
    pub log_likelihood: f64,
    /// Fitted numbers, a common standard deviation among them.
    pub k: usize,
    /// AICc; `None` for too few divisions.
    pub aicc: Option<f64>,
    /// AICc above the least of all hypotheses.
    pub delta_aicc: Option<f64>,
    /// Akaike's weight.
    pub weight: Option<f64>,
    /// Sum over what was left out of the log density of its divisions, fitted without it.
    pub loo: f64,
    /// Its parts, in the order of the units.
    pub loo_parts: Vec<f64>,
    /// Log evidence by Laplace's approximation, with a uniform prior over the ranges searched; `None` where that does not hold: errors
    /// in common, an outcome that is not smooth, a number that is open or at an end of its range.
    pub log_evidence: Option<f64>,
    /// The common standard deviation of largest likelihood; `None` of other errors.
    pub sigma: Option<f64>,
    /// Whether the fit meets the measurements; `None` where neither errors nor replicates say so.
    pub fit: Option<FitTest>,
    /// The numbers that were fitted.
    pub parameters: Vec<FittedNumber>,
    /// Numbers at an end of their ranges.
    pub at_limit: AtLimit,
    /// The cells, in the order of the lineage.
    pub cells: Vec<CellScore>,
    /// Measured cells that do not divide in the model.
    pub resting: Vec<String>,
    /// What was observed beside χ.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub others: Vec<OthersScore>,
    /// Candidates tried in the search with all data.
    pub tried: usize,
    /// The sample of its posterior, if one was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub posterior: Option<Posterior>,
}

/// The cells' means, weighted by the errors of the rows, with the errors of the means. A cell without a row has no weight.
fn means(rows: &[Observation], sds: &[f64], cells: &[String]) -> Vec<MeasuredChi> {
    let of = |(cell, name): (usize, &String)| {
        let own = || rows.iter().zip(sds).filter(move |(row, _)| row.cell == cell);
        let weight: f64 = own().map(|(_, sd)| sd.powi(-2)).sum();
        let mean = own().map(|(row, sd)| row.chi * sd.powi(-2)).sum::<f64>() / weight;
        (weight > 0.0).then(|| MeasuredChi { cell: name.clone(), mean, sd: weight.sqrt().recip() })
    };
    cells.iter().enumerate().filter_map(of).collect()
}

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

/// The fit of a hypothesis.
pub(super) struct Before<'a> {
    pub hypothesis: &'a Hypothesis,
    /// Values of its numbers.
    pub values: Vec<f64>,
}

/// The place of the least misfit. A search may miss it, so that descents also start from two kinds of fits: the fit to χ alone,
/// `of_chi`, which needs no trees, and fits of the same cue with fewer numbers. A hypothesis then fits no worse than one that it includes.
fn searched(
    objective: &Objective<'_>,
    of_chi: Option<&Objective<'_>>,
    effort: SearchBudget,
    before: &[Before<'_>],
) -> Result<(Vec<f64>, f64), FitError> {
    let mut found = objective.search(effort)?;
    let Model { template, unknowns, .. } = &objective.model;
    if unknowns.is_empty() {
        return Ok(found);
    }
    if let Some(of_chi) = of_chi {
        found = objective.refined(found, &of_chi.search(effort)?.0)?;
    }
    for Before { hypothesis, values } in before.iter().filter(|before| before.hypothesis.template == **template) {
        if let Some(place) = objective.model.place_of(&hypothesis.unknowns, values) {
            found = objective.refined(found, &place)?;
        }
    }
    Ok(found)
}

/// The fit of a hypothesis, with the scores of what was left out, and the values of its numbers. `before` are other fits.
pub(super) fn tested(
    run: &FitRun<'_>,
    question: &Question<'_>,
    hypothesis: &Hypothesis,
    before: &[Before<'_>],
) -> Result<(TestedHypothesis, Vec<f64>), FitError> {
    let Question { observations, noise, effort, memo, .. } = *question;
    let Hypothesis { lineage, template, unknowns, .. } = hypothesis;
    let effort = effort.budget(unknowns.len());
    let Observations { cells, rows, .. } = observations;
    let model = || Model {
        run: FitRun { lineage, ..*run },
        template,
        unknowns: unknowns.clone(),
        kin: Kin::of(lineage, cells.iter().map(String::as_str)),
        memo: Some(memo),
    };
    let sds = noise.sds(rows);
    let measured = means(rows, &sds, cells);
    let of_all: Vec<&Others> = observations.others.iter().collect();
    let beside = |model: &Model<'_>, values: &[f64]| others::misfit(&of_all, model, values);
    let beside: Option<Beside<'_>> = (!of_all.is_empty()).then_some(&beside);
    let deviance = folded_deviance(rows, cells, noise);
    let alone =
        || Objective::new(model(), &measured, |sd| UNDIVIDED / sd, effort).by(deviance.as_ref().map(|of| of as _));
    let (of_chi, objective) = (alone(), alone().with(beside));
    let found = searched(&objective, beside.map(|_| &of_chi), effort, before)?;
    let posterior = question
        .sampling
        .map(|sampling| posterior(question, (&objective.model, hypothesis.by_embryo), sampling))
        .transpose()?;
    let place = match &posterior {
        // A sample may pass ridges and valleys in which the search stays.
        Some(posterior) if !found.0.is_empty() => objective.refined(found, &posterior.best)?.0,
        _ => found.0,
    };
    let values = objective.model.values(&place);
    let chi = objective.chi(&values);
    let slopes = slopes(&objective, &place, &chi);
    let fit = Fitted { question, objective: &objective, place: &place, slopes: slopes.as_deref() };
    let loo_parts =
        scheduler::in_parallel(observations.units.len(), |unit| fit.left_out(unit, &chi, (model(), beside)))
            .into_iter()
            .collect::<Result<Vec<f64>, FitError>>()?;
    let others = fit.others(&values, model)?;
    objective.check_cancelled()?;
    let fitted = noise.fitted(rows, rows, &chi);
    let densities = noise.log_densities(rows, &chi, &fitted);
    let beside_chi = others.iter().fold(0.0, |sum, others| sum + others.log_likelihood);
    let data = observations.others.iter().fold(rows.len(), |count, others| count + others.len());
    let log_likelihood = densities.iter().sum::<f64>() + beside_chi;
    let is_common = noise.kind == NoiseKind::Common;
    let k = place.len() + usize::from(is_common);
    let numbers = fit.numbers(&chi, &sds)?;
    let at_limit = at_limit(&numbers, &place);
    let cells = fit.cells(&densities);
    let tested = TestedHypothesis {
        name: hypothesis.name.clone(),
        cue: objective.model.cue(&values).to_string(),
        log_likelihood,
        k,
        aicc: aicc(log_likelihood, k, data),
        delta_aicc: None,
        weight: None,
        loo: loo_parts.iter().sum(),
        loo_parts,
        log_evidence: fit
            .evidence(log_likelihood)
            .filter(|_| at_limit.is_empty() && !is_common && !noise.folded && others.is_empty()),
        sigma: is_common.then(|| fitted[0]),
        fit: fit_test(observations, noise, &chi, place.len()),
        parameters: numbers.into_iter().map(FittedNumber::from).collect(),
        at_limit,
        resting: cells.iter().filter(|cell| cell.chi.is_none()).map(|cell| cell.cell.clone()).collect(),
        cells,
        others,
        tried: objective.tried(),
        posterior,
    };
    Ok((tested, values))
}

impl From<CueNumber> for FittedNumber {
    fn from(CueNumber { name, value, searched, sd }: CueNumber) -> FittedNumber {
        FittedNumber { name, value, se: sd, searched }
    }
}

/// The objective of a fit to other data, which starts where all data put it and shows no progress.
fn beside_all<'a>(model: Model<'a>, measured: &'a [MeasuredChi], beside: Option<Beside<'a>>) -> Objective<'a> {
    let run = FitRun { progress: None, ..model.run };
    let one = SearchBudget { particles: 1, moves: 1, seed: 0 };
    Objective::new(Model { run, ..model }, measured, |sd| UNDIVIDED / sd, one).with(beside)
}

/// ∂χ/∂(number) by cell, 0 of a cell that does not divide; `None` if an outcome is not smooth, or without numbers.
fn slopes(objective: &Objective<'_>, place: &[f64], chi: &[Option<f64>]) -> Option<Vec<Vec<f64>>> {
    if place.is_empty() {
        return None;
    }
    let rests = || vec![0.0; place.len()];
    let of = |(slopes, chi): (Option<Vec<f64>>, &Option<f64>)| slopes.or_else(|| chi.is_none().then(rests));
    objective.sensitivities(place).into_iter().zip(chi).map(of).collect()
}

/// A hypothesis fitted to all data.
struct Fitted<'a> {
    question: &'a Question<'a>,
    objective: &'a Objective<'a>,
    place: &'a [f64],
    /// ∂χ/∂(number) by cell, 0 of a cell that does not divide; `None` if an outcome is not smooth, or without numbers.
    slopes: Option<&'a [Vec<f64>]>,
}

impl Fitted<'_> {
    /// The log density of the divisions of a unit, fitted without it; `chi` is the fit to all data.
    fn left_out(
        &self,
        unit: usize,
        chi: &[Option<f64>],
        (model, beside): (Model<'_>, Option<Beside<'_>>),
    ) -> Result<f64, FitError> {
        self.objective.check_cancelled()?;
        let Question { observations, noise, .. } = *self.question;
        let kept = without(&observations.rows, unit);
        let own = noise.of_part(&kept);
        let predicted = if self.place.is_empty() {
            chi.to_vec()
        } else {
            let measured = means(&kept, &own.sds(&kept), &observations.cells);
            let deviance = folded_deviance(&kept, &observations.cells, &own);
            let objective = beside_all(model, &measured, beside).by(deviance.as_ref().map(|of| of as _));
            let place = self.refitted(&objective);
            objective.check_cancelled()?;
            // Also of a cell that only this unit has.
            objective.model.chi(&objective.model.values(&place), &observations.cells)
        };
        Ok(held_out(observations, (&kept, &own), unit, &predicted))
    }

    /// The scores of rounds and lifetimes, each also predicted by a fit without it. `values` are from the fit to all data.
    fn others<'m>(&self, values: &[f64], model: impl Fn() -> Model<'m> + Sync) -> Result<Vec<OthersScore>, FitError> {
        let all = &self.question.observations.others;
        if all.is_empty() {
            return Ok(Vec::new());
        }
        let tree = others::grown(&self.objective.model, values);
        let one = |k: usize| {
            let own = &all[k];
            let kept: Vec<&Others> =
                all.iter().enumerate().filter(|(j, _)| *j != k).map(|(_, others)| others).collect();
            let beside = |model: &Model<'_>, values: &[f64]| others::misfit(&kept, model, values);
            let objective = beside_all(model(), self.objective.measured, Some(&beside)).by(self.objective.deviance);
            let place = if self.place.is_empty() { Vec::new() } else { self.refitted(&objective) };
            objective.check_cancelled()?;
            let without = others::grown(&objective.model, &objective.model.values(&place));
            Ok(own.scored(tree.as_ref(), own.log_likelihood(without.as_ref())))
        };
        scheduler::in_parallel(all.len(), one).into_iter().collect()
    }

    /// The place of the least misfit of other data near the one of all data: by steps with the slopes there, as Gauss and Newton make
    /// them, each shortened until the misfit falls.
    fn refitted(&self, objective: &Objective<'_>) -> Vec<f64> {
        let misfit = |place: &[f64]| objective.misfit(place);
        let start = (self.place.to_vec(), misfit(self.place));
        // Steps by slopes are made for normal errors.
        let Some(slopes) = self.slopes.filter(|_| !self.question.noise.folded) else {
            return descend(self.place, EDGE, DESCENT, &misfit)
                .filter(|(_, least)| *least <= start.1)
                .unwrap_or(start)
                .0;
        };
        let (mut place, mut least) = start;
        for _ in 0..STEPS {
            let Some(step) = self.step(objective, &place, slopes) else { break };
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
                break;
            }
        }
        place
    }

    /// The step of Gauss and Newton in shares of the ranges; `None` if it is too short. Cells that do not divide have no say in it.
    fn step(&self, objective: &Objective<'_>, place: &[f64], slopes: &[Vec<f64>]) -> Option<Vec<f64>> {
        let found = objective.residuals(&objective.model.values(place));
        let cells = &self.question.observations.cells;
        let row = |cell: &str, sd: f64| {
            let own = &slopes[cells.iter().position(|name| name == cell)?];
            Some(self.by_share(own).map(|slope| slope / sd).collect::<Vec<f64>>())
        };
        let rows: Vec<Vec<f64>> = found.iter().map(|r| row(&r.cell, r.sd)).collect::<Option<_>>()?;
        let off: Vec<f64> = found.iter().map(|r| r.residual.unwrap_or(0.0)).collect();
        let svd = Svd::of_rows(&rows).ok()?;
        let firmest = svd.values.first().copied()?;
        let mut step = vec![0.0; place.len()];
        for ((value, left), right) in svd.values.iter().zip(&svd.left).zip(&svd.right) {
            if *value > OPEN * firmest {
                let along: f64 = left.iter().zip(&off).map(|(u, r)| u * r).sum::<f64>() / value;
                step.iter_mut().zip(right).for_each(|(step, v)| *step -= along * v);
            }
        }
        let longest = step.iter().fold(0.0, |longest: f64, x| longest.max(x.abs()));
        let share = (LONGEST / longest).min(1.0);
        (longest > SHORTEST).then(|| step.iter().map(|x| share * x).collect())
    }

    /// Slopes by the shares of the ranges.
    fn by_share(&self, slopes: &[f64]) -> impl Iterator<Item = f64> {
        slopes.iter().zip(&self.objective.model.unknowns).map(|(slope, unknown)| slope * unknown.length())
    }

    /// The fitted numbers with their standard errors, which cells that do not divide leave as they are.
    fn numbers(&self, chi: &[Option<f64>], sds: &[f64]) -> Result<Vec<CueNumber>, FitError> {
        let Question { noise, observations, .. } = self.question;
        let off = |(row, sd): (&Observation, &f64)| Some(squared(noise, row, chi[row.cell]?, *sd));
        let squares: Vec<f64> = observations.rows.iter().zip(sds).filter_map(off).collect();
        let chi_squared: f64 = squares.iter().sum();
        let mut goodness = Goodness::of(chi_squared, squares.len(), self.place.len());
        if noise.kind == NoiseKind::Common {
            // The scale of the search is no measured error: the residuals alone give it, whether they are smaller or larger.
            let freedom = goodness.degrees_of_freedom;
            goodness.error_scale = (freedom > 0).then(|| (chi_squared / freedom as f64).sqrt());
        }
        let informative = self.informative(chi);
        let rows = self.slopes.map(|rows| held(rows, &informative, goodness)).transpose()?;
        Ok(numbers(self.objective, self.place, rows.as_deref(), goodness.error_scale))
    }

    /// The measured cells with the errors that say as much about the signed χ as the measurements do.
    fn informative(&self, chi: &[Option<f64>]) -> Vec<MeasuredChi> {
        let Question { noise, observations, .. } = self.question;
        if !noise.folded {
            return self.objective.measured.to_vec();
        }
        let sds = noise.fitted(&observations.rows, &observations.rows, chi);
        let known = |measured: &MeasuredChi| {
            let cell = observations.cells.iter().position(|cell| *cell == measured.cell)?;
            let own = observations.rows.iter().position(|row| row.cell == cell)?;
            Some(folded::information(chi[cell]? / sds[own]))
        };
        let of = |measured: &MeasuredChi| {
            let share = known(measured).unwrap_or(1.0);
            MeasuredChi { sd: measured.sd / share.max(f64::MIN_POSITIVE).sqrt(), ..measured.clone() }
        };
        self.objective.measured.iter().map(of).collect()
    }

    /// Laplace's approximation of the log evidence, for a uniform prior over the ranges; `None` where a number is as open as its range.
    fn evidence(&self, log_likelihood: f64) -> Option<f64> {
        if self.place.is_empty() {
            return Some(log_likelihood);
        }
        let measured = self.objective.measured;
        let row =
            |(slopes, measured): (&Vec<f64>, &MeasuredChi)| self.by_share(slopes).map(|s| s / measured.sd).collect();
        let rows: Vec<Vec<f64>> = self.slopes?.iter().zip(measured).map(row).collect();
        let values = Svd::of_rows(&rows).ok()?.values;
        let is_held = values.len() == self.place.len() && values.iter().all(|value| *value > TAU.sqrt());
        is_held.then(|| log_likelihood + values.iter().map(|value| 0.5 * TAU.ln() - value.ln()).sum::<f64>())
    }

    /// Each cell in the embryos and in the model.
    fn cells(&self, densities: &[f64]) -> Vec<CellScore> {
        let observations = self.question.observations;
        let found = self.objective.residuals(&self.objective.model.values(self.place));
        let of = |(cell, found): (usize, ChiResidual)| {
            let chi = observations.chi_of(cell);
            let own = || observations.rows.iter().zip(densities).filter(move |(row, _)| row.cell == cell);
            let given = own().find_map(|(row, _)| row.sd.filter(|_| chi.len() == 1));
            let one = given.map(|sd| [chi[0] - NORMAL * sd, chi[0] + NORMAL * sd]);
            CellScore {
                cell: found.cell,
                n: chi.len(),
                measured: mean(&chi),
                sd: sd(&chi),
                interval: mean_interval(&chi).or(one),
                r0: found.r0,
                chi: found.computed,
                has_cue: found.has_cue,
                log_likelihood: own().map(|(_, density)| density).sum(),
            }
        };
        found.into_iter().enumerate().map(of).collect()
    }
}

/// −2 ln L of rows by χ of the measured cells; `None` under normal errors, where the means of the cells are enough for a fit.
fn folded_deviance<'a>(
    rows: &'a [Observation],
    cells: &'a [String],
    noise: &'a Noise,
) -> Option<impl Fn(&[ChiResidual]) -> f64 + Sync + 'a> {
    let deviance = move |found: &[ChiResidual]| {
        let of = |cell: &String| found.iter().find(|found| found.cell == *cell)?.computed;
        let chi: Vec<Option<f64>> = cells.iter().map(of).collect();
        -2.0 * noise.log_likelihood(rows, &chi, &noise.fitted(rows, rows, &chi))
    };
    noise.folded.then_some(deviance)
}

/// The hypotheses with differences of AICc and Akaike's weights.
pub(super) fn weighed(mut all: Vec<TestedHypothesis>) -> Vec<TestedHypothesis> {
    let least = all.iter().filter_map(|tested| tested.aicc).fold(f64::INFINITY, f64::min);
    let share = |aicc: f64| (-0.5 * (aicc - least)).exp();
    let sum: f64 = all.iter().filter_map(|tested| tested.aicc).map(share).sum();
    for tested in &mut all {
        tested.delta_aicc = tested.aicc.map(|aicc| aicc - least);
        tested.weight = tested.aicc.map(|aicc| share(aicc) / sum);
    }
    all
}
