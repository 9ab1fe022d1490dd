//! The fit of each hypothesis.

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
use crate::fit::germline::{Beside, CueNumber, Objective, acting, at_limit, held, numbers};
use crate::fit::search::{FitRun, SearchBudget};
use crate::fit::targets::MeasuredChi;
use crate::fit::{ChiResidual, FitError, Goodness};

/// Means within this number of errors of 0 may have lost their sign.
const NEAR: f64 = 2.0;
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
    /// Whether no measured χ changes with it, where all measured cells divide.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub without_effect: bool,
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
    /// Their mean |χ|, weighted by the errors that the table gives.
    pub measured: f64,
    /// Their standard deviation; `None` for one.
    pub sd: Option<f64>,
    /// 95 % interval of the mean: by the errors that the table gives, or else by the spread of the divisions or, of one, by its error.
    pub interval: Option<[f64; 2]>,
    /// Whether both the mean and χ of the model lie within two errors of 0, where an error changes signs that \|χ\| has lost.
    #[serde(skip)]
    pub(super) is_near_zero: bool,
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
    /// Fitted numbers, a common standard deviation among them and numbers without effect left out.
    pub k: usize,
    /// AICc; `None` for too few divisions.
    pub aicc: Option<f64>,
    /// AICc above the least of all hypotheses.
    pub delta_aicc: Option<f64>,
    /// Akaike's weight; as `delta_aicc` `None` if a hypothesis has no AICc.
    pub weight: Option<f64>,
    /// Sum over what was left out of the log density of its divisions, fitted without it; `None` without one of its parts.
    pub loo: Option<f64>,
    /// Its parts, in the order of the units; `None` where the other data do not determine the fit.
    pub loo_parts: Vec<Option<f64>>,
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
    /// The mirror image of the cue, which gives the same \|χ\|; `None` if it is the cue itself, or out of the ranges.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mirror_image: Option<String>,
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
pub(super) fn means(rows: &[Observation], sds: &[f64], cells: &[String]) -> Vec<MeasuredChi> {
    let of = |(cell, name): (usize, &String)| {
        let own = || rows.iter().zip(sds).filter(move |(row, _)| row.cell == cell);
        let weight: f64 = own().map(|(_, sd)| sd.powi(-2)).sum();
        let mean = own().map(|(row, sd)| row.chi * sd.powi(-2)).sum::<f64>() / weight;
        (weight > 0.0).then(|| MeasuredChi { cell: name.clone(), mean, sd: weight.sqrt().recip() })
    };
    cells.iter().enumerate().filter_map(of).collect()
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
    let beside = |model: &Model<'_>, values: &[f64]| others::summed(&of_all, model, values, Others::misfit);
    let beside: Option<Beside<'_>> = (!of_all.is_empty()).then_some(&beside);
    let deviance = own_deviance(observations, rows, noise);
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
            .collect::<Result<Vec<Option<f64>>, FitError>>()?;
    let others = fit.others(&values, model)?;
    objective.check_cancelled()?;
    let fitted = noise.fitted(rows, rows, &chi);
    let densities = noise.log_densities(rows, &chi, &fitted);
    let beside_chi = others.iter().fold(0.0, |sum, others| sum + others.log_likelihood);
    let data = observations.others.iter().fold(rows.len(), |count, others| count + others.len());
    let log_likelihood = densities.iter().sum::<f64>() + beside_chi;
    let is_common = noise.kind == NoiseKind::Common;
    let k = fit.counted(&chi) + usize::from(is_common);
    let numbers = fit.numbers(&chi, &sds)?;
    let at_limit = at_limit(&numbers, &place);
    let cells = fit.cells(&densities, &fitted);
    let tested = TestedHypothesis {
        name: hypothesis.name.clone(),
        cue: objective.model.cue(&values).to_string(),
        log_likelihood,
        k,
        aicc: aicc(log_likelihood, k, data),
        delta_aicc: None,
        weight: None,
        loo: loo_parts.iter().copied().sum(),
        loo_parts,
        log_evidence: fit
            .evidence(log_likelihood)
            .filter(|_| at_limit.is_empty() && !is_common && !noise.folded && others.is_empty()),
        sigma: is_common.then(|| fitted[0]),
        fit: fit_test(observations, noise, &chi, fit.acting(&chi)),
        parameters: numbers.into_iter().map(FittedNumber::from).collect(),
        at_limit,
        mirror_image: objective.model.mirror_image(&values),
        resting: cells.iter().filter(|cell| cell.chi.is_none()).map(|cell| cell.cell.clone()).collect(),
        cells,
        others,
        tried: objective.tried(),
        posterior,
    };
    Ok((tested, values))
}

impl From<CueNumber> for FittedNumber {
    fn from(CueNumber { name, value, searched, sd, without_effect }: CueNumber) -> FittedNumber {
        FittedNumber { name, value, se: sd, without_effect, searched }
    }
}

/// The objective of a fit to other data, which starts where all data put it and shows no progress.
pub(super) fn beside_all<'a>(
    model: Model<'a>,
    measured: &'a [MeasuredChi],
    beside: Option<Beside<'a>>,
) -> Objective<'a> {
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
pub(super) struct Fitted<'a> {
    pub question: &'a Question<'a>,
    pub objective: &'a Objective<'a>,
    pub place: &'a [f64],
    /// ∂χ/∂(number) by cell, 0 of a cell that does not divide; `None` if an outcome is not smooth, or without numbers.
    pub slopes: Option<&'a [Vec<f64>]>,
}

impl Fitted<'_> {
    /// Slopes by the shares of the ranges.
    pub(super) fn by_share(&self, slopes: &[f64]) -> impl Iterator<Item = f64> {
        slopes.iter().zip(&self.objective.model.unknowns).map(|(slope, unknown)| slope * unknown.length())
    }

    /// How many numbers change the measured χ. All may if a cell does not divide, since it has no χ to tell.
    pub(super) fn acting(&self, chi: &[Option<f64>]) -> usize {
        acting(self.slopes.filter(|_| chi.iter().all(Option::is_some)), self.place.len())
    }

    /// How many numbers are fitted. Rounds and lifetimes may depend on a number that χ does not depend on.
    pub(super) fn counted(&self, chi: &[Option<f64>]) -> usize {
        if self.question.observations.others.is_empty() { self.acting(chi) } else { self.place.len() }
    }

    /// The fitted numbers with their standard errors, which cells that do not divide leave as they are.
    fn numbers(&self, chi: &[Option<f64>], sds: &[f64]) -> Result<Vec<CueNumber>, FitError> {
        let Question { noise, observations, .. } = self.question;
        let off = |(row, sd): (&Observation, &f64)| Some(squared(noise, row, chi[row.cell]?, *sd));
        let squares: Vec<f64> = observations.rows.iter().zip(sds).filter_map(off).collect();
        let chi_squared: f64 = squares.iter().sum();
        let mut goodness = Goodness::of(chi_squared, squares.len(), acting(self.slopes, self.place.len()));
        if noise.kind == NoiseKind::Common {
            // The scale of the search is no measured error: the fitted error alone gives it, whether it is smaller or larger.
            let dividing: Vec<Observation> =
                observations.rows.iter().filter(|row| chi[row.cell].is_some()).cloned().collect();
            let fitted = noise.fitted(&dividing, &dividing, chi);
            let of = |(fitted, sd): (&f64, &f64)| fitted / sd * (squares.len() as f64).sqrt();
            let freedom = Some(goodness.degrees_of_freedom as f64).filter(|freedom| *freedom > 0.0);
            goodness.error_scale =
                fitted.first().zip(sds.first()).map(of).zip(freedom).map(|(of, freedom)| of / freedom.sqrt());
        }
        let informative = self.informative(chi);
        let held = self.slopes.map(|rows| held(rows, &informative, goodness)).transpose()?;
        let slopes = self.slopes.filter(|_| chi.iter().all(Option::is_some));
        Ok(numbers(self.objective, self.place, (slopes, held.as_deref()), goodness.error_scale))
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

    /// Each cell in the embryos and in the model, by the log densities of the rows and their errors.
    fn cells(&self, densities: &[f64], fitted: &[f64]) -> Vec<CellScore> {
        let Question { observations, noise, .. } = self.question;
        let found = self.objective.residuals(&self.objective.model.values(self.place));
        let of = |(cell, found): (usize, ChiResidual)| {
            let chi = observations.chi_of(cell);
            let own = || observations.rows.iter().zip(densities).filter(move |(row, _)| row.cell == cell);
            let given = own().find_map(|(row, _)| row.sd.filter(|_| chi.len() == 1));
            let is_given = noise.kind == NoiseKind::Given;
            let measured = if is_given { found.measured } else { mean(&chi) };
            let about = |sd: f64| [measured - NORMAL * sd, measured + NORMAL * sd];
            let by_spread = mean_interval(&chi).filter(|_| !is_given);
            // A poor fit increases the fitted error, but not the error of replicates.
            let error = observations.rows.iter().zip(fitted).find(|(row, _)| row.cell == cell).map(|(_, sd)| *sd);
            let error = noise.sd.filter(|_| noise.kind == NoiseKind::Common).or(error);
            let is_small = |chi: f64| error.is_some_and(|error| chi.abs() < NEAR * error);
            CellScore {
                cell: found.cell,
                n: chi.len(),
                measured,
                sd: sd(&chi),
                interval: by_spread.or(given.or(Some(found.sd).filter(|_| is_given)).map(about)),
                is_near_zero: is_small(measured) && found.computed.is_some_and(is_small),
                r0: found.r0,
                chi: found.computed,
                has_cue: found.has_cue,
                log_likelihood: own().map(|(_, density)| density).sum(),
            }
        };
        found.into_iter().enumerate().map(of).collect()
    }
}

/// −2 ln L of rows by χ of the measured cells; `None` where the means of the cells are enough for a fit: under normal errors that are
/// known, or that all data share. Beside rounds or lifetimes the size of a fitted error decides how much χ counts.
pub(super) fn own_deviance<'a>(
    observations: &'a Observations,
    rows: &'a [Observation],
    noise: &'a Noise,
) -> Option<impl Fn(&[ChiResidual]) -> f64 + Sync + 'a> {
    let is_needed = noise.folded || noise.kind == NoiseKind::Common && !observations.others.is_empty();
    let deviance = move |found: &[ChiResidual]| {
        let of = |cell: &String| found.iter().find(|found| found.cell == *cell)?.computed;
        let chi: Vec<Option<f64>> = observations.cells.iter().map(of).collect();
        -2.0 * noise.log_likelihood(rows, &chi, &noise.fitted(rows, rows, &chi))
    };
    is_needed.then_some(deviance)
}

/// The hypotheses with differences of AICc and Akaike's weights, which are shares among all and need the AICc of each.
pub(super) fn weighed(mut all: Vec<TestedHypothesis>) -> Vec<TestedHypothesis> {
    if all.iter().any(|tested| tested.aicc.is_none()) {
        return all;
    }
    let least = all.iter().filter_map(|tested| tested.aicc).fold(f64::INFINITY, f64::min);
    let share = |aicc: f64| (-0.5 * (aicc - least)).exp();
    let sum: f64 = all.iter().filter_map(|tested| tested.aicc).map(share).sum();
    for tested in &mut all {
        tested.delta_aicc = tested.aicc.map(|aicc| aicc - least);
        tested.weight = tested.aicc.map(|aicc| share(aicc) / sum);
    }
    all
}
