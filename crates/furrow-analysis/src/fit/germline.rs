//! Fits a cue to the measured size asymmetries of the germline.
//!
//! The misfit of a cue follows from the divisions of the measured founders and their ancestors, each as large as its mother's
//! division makes it:
//!
//! * \[F.5 chi squared\] χ² = Σ ((χ − measured)/sd)².
//!
//! A swarm minimises it over the numbers of the cue's terms, and a simplex refines the minimum. The sensitivities of χ to
//! those numbers, exact by the divisions' tangents and passed from mother to daughter with the radius, show how well the
//! measurements determine each number, and which combinations they leave open. Where χ² is larger than its degrees of freedom,
//! the errors grow by the factor of the misfit ([`super::goodness`]); a division that jumps within them is named ([`super::jumps`]).

use super::chain::{Chain, Kin, Model};
use super::error::{FitError, check_cancelled};
use super::goodness::Goodness;
use super::jumps::{Jump, jumps};
use super::search::{FitProgress, FitRun, Limit, NumberAtLimit, SearchBudget, descend, scan, swarm};
use super::targets::{MeasuredChi, OutOfSample, Targets};
use super::unknowns::{Unknown, unknowns};
use furrow_cell::Cue;
use furrow_lineage::batch::scheduler;
use furrow_mechanics::calibration::Combination;
use furrow_spectra::Svd;
use serde::Serialize;
use std::collections::BTreeMap;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Misfit, in standard deviations, of a cell that does not divide.
const UNDIVIDED: f64 = 10.0;
/// Steps of the simplex, and its edges in the unit cube.
const DESCENT: u64 = 120;
const EDGE: f64 = 0.02;
/// The candidates' name in errors.
const CUES: &str = "cues";
/// Combinations are open if a factor e, or a shift over all of u, changes χ by less than a standard deviation, scaled by the misfit.
const OPEN: f64 = 1.0;
/// Directions held this much less firmly than the firmest one are held by nothing, and numbers with a smaller component have no part in
/// them: there the ratio of the two is one of rounding errors.
const ROUNDING: f64 = 1e-10;
const APART: f64 = 1e-7;

/// A measured χ beside the model's.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChiResidual {
    /// The founder that divides.
    pub cell: String,
    /// Its radius R0 in the model; `None` if it is never born.
    pub r0: Option<f64>,
    /// Mean of the measured χ.
    pub measured: f64,
    /// Its standard deviation.
    pub sd: f64,
    /// χ of the model; `None` if it does not divide.
    pub computed: Option<f64>,
    /// (computed − measured)/sd.
    pub residual: Option<f64>,
    /// Whether it carries the cue.
    #[serde(skip)]
    pub has_cue: bool,
}

/// A number of the cue.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CueNumber {
    /// Its name, as `cue[0].amplitude`.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// Between which values was searched.
    pub searched: [f64; 2],
    /// Its standard deviation, scaled by the misfit, if the measurements determine it.
    pub sd: Option<f64>,
    /// Whether no measured χ changes with it. A cell that does not divide has no χ to tell.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub without_effect: bool,
}

/// The cue that fits best.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FittedCue {
    /// The cue.
    pub cue: String,
    /// Its numbers.
    pub numbers: Vec<CueNumber>,
    /// χ² of the fit, its degrees of freedom and its probability.
    #[serde(flatten)]
    pub goodness: Goodness,
    /// Fitted divisions that jump next to the best cue.
    pub jumps: Vec<Jump>,
    /// Measurements beside the model.
    pub residuals: Vec<ChiResidual>,
    /// ∂χ/∂ln(number), of places ∂χ/∂u: a row for each measurement; `None` where an outcome is not smooth.
    pub sensitivities: Option<Vec<Vec<f64>>>,
    /// Directions in the space of the numbers, by logarithm or in units of u, from the best held to the least, with the standard
    /// deviations of χ by which a step of 1 along each moves the model; `None` where an outcome is not smooth.
    pub combinations: Option<Vec<Combination>>,
    /// Measurements outside the fit, beside the model with this cue.
    pub out_of_sample: Vec<ChiResidual>,
    /// Numbers of the cue that lie at an end of the range in which they were searched.
    pub at_limit: Vec<NumberAtLimit>,
    /// The mirror image of the cue, which gives the same \|χ\|; `None` if it is the cue itself, or out of the ranges.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mirror_image: Option<String>,
    /// Cues tried.
    pub tried: usize,
}

/// The residual of a cell that does not divide, in standard deviations, from its measured standard deviation.
type Undivided = fn(sd: f64) -> f64;

/// What other observations add to χ² at values of the unknowns.
pub(crate) type Beside<'a> = &'a (dyn Fn(&Model<'_>, &[f64]) -> f64 + Sync);

/// χ² by the measured cells beside the model.
pub(crate) type Deviance<'a> = &'a (dyn Fn(&[ChiResidual]) -> f64 + Sync + 'a);

/// The objective of the fit.
pub(crate) struct Objective<'a> {
    pub model: Model<'a>,
    pub measured: &'a [MeasuredChi],
    undivided: Undivided,
    beside: Option<Beside<'a>>,
    /// In place of Σ ((χ − measured)/sd)².
    pub deviance: Option<Deviance<'a>>,
    tried: AtomicUsize,
    /// Most candidates that are tried.
    of: usize,
    /// The least misfit so far.
    least: Mutex<f64>,
}

/// The most candidates that a search tries. A simplex asks for its corners and, in most steps, for one or two places.
pub(crate) fn most_candidates(effort: SearchBudget, numbers: usize) -> usize {
    effort.evaluations() + numbers + 1 + 2 * DESCENT as usize
}

impl<'a> Objective<'a> {
    /// The misfit of a model to measured cells, for a search with this budget.
    pub fn new(model: Model<'a>, measured: &'a [MeasuredChi], undivided: Undivided, effort: SearchBudget) -> Self {
        let of = most_candidates(effort, model.unknowns.len());
        let (tried, least) = (AtomicUsize::new(0), Mutex::new(f64::INFINITY));
        Objective { model, measured, undivided, beside: None, deviance: None, tried, of, least }
    }

    /// With other observations.
    pub fn with(self, beside: Option<Beside<'a>>) -> Self {
        Objective { beside, ..self }
    }

    /// With another misfit of χ.
    pub fn by(self, deviance: Option<Deviance<'a>>) -> Self {
        Objective { deviance, ..self }
    }

    pub fn check_cancelled(&self) -> Result<(), FitError> {
        check_cancelled(self.model.run.cancel, self.tried(), CUES)
    }

    /// Candidates tried so far.
    pub fn tried(&self) -> usize {
        self.tried.load(Ordering::Relaxed)
    }

    /// χ of each measurement at values of the unknowns.
    pub fn chi(&self, values: &[f64]) -> Vec<Option<f64>> {
        self.residuals(values).into_iter().map(|residual| residual.computed).collect()
    }

    /// The measurements beside the model at values of the unknowns.
    pub fn residuals(&self, values: &[f64]) -> Vec<ChiResidual> {
        residuals(&self.model, values, &BTreeMap::new(), self.measured)
    }

    fn chi_squared(&self, place: &[f64]) -> f64 {
        let outside: f64 = place.iter().map(|x| (x - x.clamp(0.0, 1.0)).abs()).sum();
        if self.check_cancelled().is_err() || outside > 0.0 {
            return f64::INFINITY;
        }
        let tried = self.tried.fetch_add(1, Ordering::Relaxed) + 1;
        let misfit = self.misfit(place);
        self.show(tried, misfit);
        misfit
    }

    /// χ² at a place of the unit cube.
    pub fn misfit(&self, place: &[f64]) -> f64 {
        let of = |r: &ChiResidual| r.residual.unwrap_or_else(|| (self.undivided)(r.sd)).powi(2);
        let values = self.model.values(place);
        let found = self.residuals(&values);
        let of_chi = self.deviance.map_or_else(|| found.iter().map(of).sum(), |deviance| deviance(&found));
        self.beside.map_or(of_chi, |beside| of_chi + beside(&self.model, &values))
    }

    fn show(&self, tried: usize, misfit: f64) {
        let Some(show) = self.model.run.progress else { return };
        // The number stays valid if a thread panics.
        let mut least = self.least.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        *least = least.min(misfit);
        show(FitProgress { done: tried.min(self.of), of: self.of, least: Some(*least) });
    }

    /// The place of the least misfit, and the misfit: of one number by a scan, of several by a swarm, and then a simplex.
    ///
    /// # Errors
    /// The search was cancelled, or no candidate has a finite misfit.
    pub fn search(&self, effort: SearchBudget) -> Result<(Vec<f64>, f64), FitError> {
        let misfit = |place: &[f64]| self.chi_squared(place);
        if self.model.unknowns.is_empty() {
            return Ok((Vec::new(), misfit(&[])));
        }
        let found = match self.model.unknowns.len() {
            1 => scan(effort.evaluations(), &misfit),
            count => swarm(&vec![[0.0, 1.0]; count], effort, &misfit).map(|(place, least)| {
                let better = descend(&place, EDGE, DESCENT, &misfit).filter(|(_, better)| *better <= least);
                better.unwrap_or((place, least))
            }),
        };
        self.check_cancelled()?;
        let (tried, advice) = (self.tried(), "try terms on other fields");
        let found = found.ok_or(FitError::Nothing { tried, what: CUES, advice })?;
        // A number that is fitted fits no worse than the one that the files give.
        match self.model.given() {
            Some(given) => self.refined(found, &given),
            None => {
                self.check_cancelled()?;
                Ok(found)
            }
        }
    }

    /// The better of the place that a search found and the minimum near another place.
    ///
    /// # Errors
    /// The search was cancelled.
    pub fn refined(&self, found: (Vec<f64>, f64), other: &[f64]) -> Result<(Vec<f64>, f64), FitError> {
        let misfit = |place: &[f64]| self.chi_squared(place);
        let better = (misfit(other) < found.1).then(|| descend(other, EDGE, DESCENT, &misfit)).flatten();
        self.check_cancelled()?;
        Ok(better.filter(|(_, better)| *better < found.1).unwrap_or(found))
    }

    /// ∂χ/∂(number), by the logarithm where that is searched, rows by measurement; `None` for a cell that does not divide, or if its
    /// outcome is not smooth.
    pub fn sensitivities(&self, place: &[f64]) -> Vec<Option<Vec<f64>>> {
        let (values, volumes) = (self.model.values(place), BTreeMap::new());
        let chain = Chain::of(&self.model, &values, &volumes);
        let row = |slopes: Vec<f64>| {
            let numbers = self.model.unknowns.iter().zip(place);
            slopes.iter().zip(numbers).map(|(slope, (unknown, share))| slope * unknown.scale(*share)).collect()
        };
        let slopes = chain.sensitivities(self.measured.iter().map(|measured| measured.cell.as_str()));
        slopes.into_iter().map(|slopes| slopes.map(row)).collect()
    }
}

/// Measurements beside a model at values of its unknowns; some volumes may be given, as shares of the first cell's.
fn residuals(
    model: &Model<'_>,
    values: &[f64],
    volumes: &BTreeMap<String, f64>,
    measured: &[MeasuredChi],
) -> Vec<ChiResidual> {
    let chain = Chain::of(model, values, volumes);
    let one = |MeasuredChi { cell, mean, sd }: &MeasuredChi| {
        let (r0, computed) = (chain.r0(cell), chain.chi(cell));
        let residual = computed.map(|chi| (chi - mean) / sd);
        let has_cue = chain.has_cue(cell);
        ChiResidual { cell: cell.clone(), r0, measured: *mean, sd: *sd, computed, residual, has_cue }
    };
    measured.iter().map(one).collect()
}

/// Fits all numbers of the terms of `template` to the measured χ.
///
/// # Errors
/// [`FitError`].
pub fn fit_cue(
    run: &FitRun<'_>,
    targets: &Targets,
    template: &Cue,
    effort: SearchBudget,
) -> Result<FittedCue, FitError> {
    let lineage = run.lineage;
    let by_rules = lineage.cue_rules.iter().any(|rule| rule.cue != "none");
    if !by_rules && !(0..lineage.founders.len()).any(|founder| lineage.gives_cue(founder, &run.settings.cell)) {
        return Err(FitError::NoCue);
    }
    let others = targets.out_of_sample.iter().flat_map(|out| &out.chi);
    let kin = Kin::of(lineage, targets.chi.iter().chain(others).map(|chi| chi.cell.as_str()));
    let model = Model { run: *run, template, unknowns: unknowns(template), kin, memo: None };
    let objective = Objective::new(model, &targets.chi, |_| UNDIVIDED, effort);
    scheduler::pool(run.threads)?.install(|| {
        let (place, chi_squared) = objective.search(effort)?;
        complete(&objective, targets, &place, chi_squared)
    })
}

fn complete(
    objective: &Objective<'_>,
    targets: &Targets,
    place: &[f64],
    chi_squared: f64,
) -> Result<FittedCue, FitError> {
    let Objective { model, measured, .. } = objective;
    let values = model.values(place);
    let sensitivities: Option<Vec<Vec<f64>>> = objective.sensitivities(place).into_iter().collect();
    let goodness = Goodness::of(chi_squared, measured.len(), acting(sensitivities.as_deref(), place.len()));
    let combinations = sensitivities.as_ref().map(|rows| held(rows, measured, goodness)).transpose()?;
    let numbers = numbers(objective, place, (sensitivities.as_deref(), combinations.as_deref()), goodness.error_scale);
    let residuals = objective.residuals(&values);
    let others = targets.out_of_sample.iter();
    let predicted = |out: &OutOfSample| self::residuals(model, &values, &out.volumes, &out.chi);
    Ok(FittedCue {
        cue: model.cue(&values).to_string(),
        mirror_image: model.mirror_image(&values),
        jumps: jumps(objective, &numbers, &residuals)?,
        at_limit: at_limit(&numbers, place),
        numbers,
        goodness,
        residuals,
        sensitivities,
        combinations,
        out_of_sample: others.flat_map(predicted).collect(),
        tried: objective.tried(),
    })
}

/// Whether χ of any cell changes with a number, by the slopes of the cells.
pub(crate) fn acts(rows: &[Vec<f64>], number: usize) -> bool {
    rows.iter().any(|row| row[number] != 0.0)
}

/// How many of some numbers change χ of a cell: only these take from the misfit. Without slopes all may.
pub(crate) fn acting(slopes: Option<&[Vec<f64>]>, numbers: usize) -> usize {
    slopes.map_or(numbers, |rows| (0..numbers).filter(|number| acts(rows, *number)).count())
}

/// The unknowns with their values and, from the slopes of the measured cells, the combinations that the measurements hold and the
/// factor on their errors, with their standard deviations.
pub(crate) fn numbers(
    objective: &Objective<'_>,
    place: &[f64],
    (slopes, combinations): (Option<&[Vec<f64>]>, Option<&[Combination]>),
    error_scale: Option<f64>,
) -> Vec<CueNumber> {
    let unknowns = &objective.model.unknowns;
    let sd = |k: usize| {
        let (held, factor) = (combinations?, error_scale?);
        let largest = held.iter().fold(0.0, |largest: f64, h| largest.max(h.singular_value));
        let apart = |h: &&Combination| h.singular_value <= ROUNDING * largest && h.components[k].abs() <= APART;
        // Σ (v_k/σ)²: without bound if a direction that this number is part of is held by nothing.
        let parts = held.iter().filter(|h| !apart(h));
        let sum: f64 = parts.map(|h| (h.components[k] / h.singular_value).powi(2)).sum();
        let relative = factor * sum.sqrt();
        let scale = unknowns[k].scale(place[k]).abs();
        (relative.is_finite() && relative < 1.0 / OPEN).then_some(relative * scale)
    };
    let number = |(k, unknown): (usize, &Unknown)| CueNumber {
        name: unknown.name(),
        value: unknown.value(place[k]),
        searched: unknown.limits.map(|limit| limit * unknown.sign),
        sd: sd(k),
        without_effect: slopes.is_some_and(|rows| !acts(rows, k)),
    };
    unknowns.iter().enumerate().map(number).collect()
}

/// The numbers at an end of their ranges.
pub(crate) fn at_limit(numbers: &[CueNumber], place: &[f64]) -> Vec<NumberAtLimit> {
    let limited = |(number, &share): (&CueNumber, &f64)| {
        let CueNumber { name, value, searched, .. } = number;
        // The range of a negative amplitude runs downwards.
        let share = if searched[0] > searched[1] { 1.0 - share } else { share };
        Some(NumberAtLimit { name: name.clone(), value: *value, limit: Limit::at(share)?, searched: *searched })
    };
    numbers.iter().zip(place).filter_map(limited).collect()
}

/// Directions of the cue's numbers by how firmly the measurements hold them. A number without effect is a direction of its own: by
/// rounding errors it would be part of others, and nothing would hold those either.
pub(crate) fn held(
    rows: &[Vec<f64>],
    measured: &[MeasuredChi],
    goodness: Goodness,
) -> Result<Vec<Combination>, FitError> {
    let count = rows.first().map_or(0, Vec::len);
    let (acting, idle): (Vec<usize>, Vec<usize>) = (0..count).partition(|k| acts(rows, *k));
    let weighted: Vec<Vec<f64>> =
        rows.iter().zip(measured).map(|(row, m)| acting.iter().map(|k| row[*k] / m.sd).collect()).collect();
    let Svd { values, right, .. } = Svd::of_rows(&weighted)?;
    let along = |numbers: &[usize], parts: &[f64]| {
        let mut components = vec![0.0; count];
        numbers.iter().zip(parts).for_each(|(k, part)| components[*k] = *part);
        components
    };
    let of = |(k, parts): (usize, Vec<f64>)| {
        let singular_value = values.get(k).copied().unwrap_or(0.0);
        Combination {
            singular_value,
            determined: singular_value > OPEN * goodness.error_scale.unwrap_or(1.0),
            components: along(&acting, &parts),
        }
    };
    let open = |k| Combination { singular_value: 0.0, determined: false, components: along(&[k], &[1.0]) };
    Ok(right.into_iter().enumerate().map(of).chain(idle.into_iter().map(open)).collect())
}

#[cfg(test)]
mod tests {
    use furrow_cell::{Cell, Numerics};
    use furrow_lineage::{Lineage, TreeSettings};

    use super::super::chain::FINER;
    use super::super::unknowns::AMPLITUDES;
    use super::*;

    /// Calls `then` with the objective and the published cue's place in the units of the search.
    fn of_the_embryo<T>(numerics: Numerics, then: impl FnOnce(&Objective<'_>, Vec<f64>) -> T) -> T {
        let (lineage, targets) = (Lineage::c_elegans().unwrap(), Targets::embryo().unwrap());
        let (template, settings) = (Cue::published(), TreeSettings { numerics, ..TreeSettings::default() });
        let unknowns = unknowns(&template);
        let cell = Cell::gao2026_thresholds(1.0).with_cue(template.clone());
        let share = |unknown: &Unknown| unknown.share(unknown.kind.parameter().unwrap().get(&cell)).unwrap();
        let place = unknowns.iter().map(share).collect();
        let cancel = false.into();
        let run = FitRun::new(&lineage, &settings, 1, &cancel);
        let kin = Kin::of(&lineage, targets.chi.iter().map(|chi| chi.cell.as_str()));
        let model = Model { run, template: &template, unknowns, kin, memo: None };
        let effort = SearchBudget { particles: 1, moves: 1, seed: 0 };
        then(&Objective::new(model, &targets.chi, |_| UNDIVIDED, effort), place)
    }

    fn completed(objective: &Objective<'_>, place: &[f64], chi_squared: f64) -> FittedCue {
        let targets = Targets { out_of_sample: None, ..Targets::embryo().unwrap() };
        complete(objective, &targets, place, chi_squared).unwrap()
    }

    #[test]
    fn sensitivities_are_handed_down_from_mother_to_daughter() {
        // Differences of divisions need them solved as finely as their tangents.
        let preset = Numerics::default();
        let fine = Numerics { time_tolerance: FINER * preset.time_tolerance, noise: 0.0, ..preset };
        of_the_embryo(fine, |objective, place| {
            let exact: Vec<Vec<f64>> = objective.sensitivities(&place).into_iter().map(Option::unwrap).collect();
            assert_eq!(exact.len(), 4);
            for (k, unknown) in objective.model.unknowns.iter().enumerate() {
                let chi = |share: f64| -> Vec<f64> {
                    let moved = super::super::search::moved(&place, k, share);
                    objective.chi(&objective.model.values(&moved)).into_iter().map(Option::unwrap).collect()
                };
                // χ of P3 turns quickly with the place of the cue.
                let step = 1e-3;
                let (above, below) = (chi(place[k] + step), chi(place[k] - step));
                let length = unknown.value(place[k] + step) - unknown.value(place[k] - step);
                for (i, row) in exact.iter().enumerate() {
                    let expected = (above[i] - below[i]) / length * unknown.scale(place[k]);
                    let (off, of) = ((row[k] - expected).abs(), unknown.kind);
                    assert!(off < 0.02 * expected.abs() + 1e-3, "row {i}, {of}: {} {expected}", row[k]);
                }
            }
        });
    }

    #[test]
    fn errors_grow_with_the_misfit() {
        of_the_embryo(Numerics::default(), |objective, place| {
            let [good, poor] = [1.0, 4.0].map(|chi_squared| completed(objective, &place, chi_squared));
            assert_eq!((poor.goodness.degrees_of_freedom, poor.goodness.error_scale), (1, Some(2.0)));
            assert!((poor.goodness.p.unwrap() - 0.0455).abs() < 1e-4, "{:?}", poor.goodness);
            let errors: Vec<_> =
                good.numbers.iter().zip(&poor.numbers).filter_map(|(good, poor)| Some([good.sd?, poor.sd?])).collect();
            assert!(!errors.is_empty(), "{:?}", good.numbers);
            assert!(errors.iter().all(|[good, poor]| (poor / good - 2.0).abs() < 1e-12), "{errors:?}");
        });
    }

    /// Whether another number has no effect or only one together with a third, a number keeps its error: in neither direction it has a part.
    #[test]
    fn open_directions_leave_other_numbers_their_errors() {
        of_the_embryo(Numerics::default(), |objective, place| {
            let errors = |of: [f64; 2]| {
                let row = |[x, y]: [f64; 2]| vec![of[0] * x, of[1] * x, y];
                let rows = [[1.0, 0.2], [0.5, 1.0], [2.0, -0.3], [0.1, 1.0]].map(row);
                let goodness = Goodness::of(1.0, 4, 2);
                let combinations = held(&rows, objective.measured, goodness).unwrap();
                numbers(objective, &place, (Some(&rows), Some(&combinations)), goodness.error_scale)
            };
            let [idle, together] = [[1.0, 0.0], [0.1, 7.3]].map(errors);
            assert_eq!([&idle[0], &idle[1], &together[1]].map(|number| number.sd.is_some()), [true, false, false]);
            assert_eq!([&idle[0], &idle[1], &together[1]].map(|number| number.without_effect), [false, true, false]);
            let (alone, beside) = (idle[2].sd.unwrap(), together[2].sd.unwrap());
            assert!((alone / beside - 1.0).abs() < 1e-6, "{alone} {beside}");
        });
    }

    #[test]
    fn a_number_at_the_edge_of_its_range_is_named() {
        of_the_embryo(Numerics::default(), |objective, mut place| {
            assert!(completed(objective, &place, 1.0).at_limit.is_empty());
            let amplitude = place.len() - 1;
            place[amplitude] = 0.001;
            let found = completed(objective, &place, 1.0).at_limit;
            let [NumberAtLimit { name, limit: Limit::Lower, searched, .. }] = &found[..] else { panic!("{found:?}") };
            assert_eq!((name.as_str(), *searched), ("cue[0].amplitude", AMPLITUDES));
        });
    }
}
