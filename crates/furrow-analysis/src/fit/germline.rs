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

use super::error::{FitError, check_cancelled};
use super::goodness::Goodness;
use super::jumps::{Jump, jumps};
use super::search::{FitProgress, FitRun, Limit, NumberAtLimit, SearchBudget, descend, swarm};
use super::targets::{MeasuredChi, Targets};
use super::unknowns::{Unknown, unknowns};
use furrow_cell::{Cell, Cue, Parameter};
use furrow_lineage::batch::scheduler;
use furrow_lineage::{Daughter, Mother, Place};
use furrow_mechanics::calibration::Combination;
use furrow_mechanics::division::{Division, DivisionInput, DivisionOptions, Outcome, divide, divide_with};
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
/// Factor on the time tolerance for sensitivities, and the least tolerance: derivatives show errors that χ does not.
const FINER: f64 = 1e-2;
const FINEST: f64 = 1e-8;
/// The candidates' name in errors.
const CUES: &str = "cues";
/// Combinations are open if a factor e, or a shift over all of u, changes χ by less than a standard deviation, scaled by the misfit.
const OPEN: f64 = 1.0;

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
    /// Cues tried.
    pub tried: usize,
}

/// Divisions of founders, each from its mother's.
struct Chain<'a> {
    objective: &'a Objective<'a>,
    /// The cue in place of the one that founders carry, where they carry one.
    cue: &'a Cue,
    /// Given volumes, as shares of the first cell's.
    volumes: &'a BTreeMap<String, f64>,
    divisions: BTreeMap<usize, Option<Division>>,
    slopes: BTreeMap<usize, Option<Slopes>>,
}

impl Chain<'_> {
    /// The radius of a founder; `None` if it is never born.
    fn r0(&mut self, founder: usize) -> Option<f64> {
        let FitRun { lineage, settings, .. } = self.objective.run;
        if let Some(share) = self.volumes.get(&lineage.founders[founder].name) {
            return Some(self.r0(lineage.first())? * share.cbrt());
        }
        let given = lineage.given_r0(founder);
        let Some(mother) = lineage.mother(founder).filter(|_| given.is_none()) else {
            return given.or(Some(settings.cell.r0));
        };
        let [a, b] = self.division(mother)?.daughters()?;
        Some(if lineage.founders[founder].daughter == Some(Daughter::Larger) { a.max(b) } else { a.min(b) })
    }

    fn division(&mut self, founder: usize) -> Option<Division> {
        if let Some(known) = self.divisions.get(&founder) {
            return known.clone();
        }
        let found = self.r0(founder).and_then(|r0| divide(&self.input(founder, r0)?).ok());
        self.divisions.insert(founder, found.clone());
        found
    }

    /// The division of a founder of that radius; `None` if rules give it a value that is not allowed.
    fn input(&mut self, founder: usize, r0: f64) -> Option<DivisionInput> {
        let FitRun { lineage, settings, .. } = self.objective.run;
        let place = Place { founder, round: 0, generation: lineage.generation(founder), r0 };
        let own = lineage.cue_at(place);
        let cue = if own.is_none() { own } else { self.cue.clone() };
        let mut cell = Cell { r0, cue, ..settings.cell.clone() };
        let mother = lineage.mother(founder).filter(|_| lineage.has_physics_rules());
        let mother = mother.and_then(|mother| {
            let r0 = self.r0(mother)?;
            Some((self.input(mother, r0)?.cell, self.division(mother)))
        });
        let mother = mother.as_ref().map(|(cell, division)| Mother::of(cell, division.as_ref()));
        lineage.set_physics(place, &mut cell, mother).ok()?;
        Some(DivisionInput { cell, numerics: settings.numerics, seed: settings.seed })
    }

    /// How a founder's division changes with the numbers of the cue: by itself, and with the radius that its mother leaves it.
    fn slopes(&mut self, founder: usize) -> Option<Slopes> {
        if let Some(known) = self.slopes.get(&founder) {
            return known.clone();
        }
        let found = self.follow(founder);
        self.slopes.insert(founder, found.clone());
        found
    }

    fn follow(&mut self, founder: usize) -> Option<Slopes> {
        let Objective { run: FitRun { lineage, .. }, unknowns, .. } = self.objective;
        let r0 = self.r0(founder)?;
        let mut input = self.input(founder, r0)?;
        input.numerics.time_tolerance = (FINER * input.numerics.time_tolerance).max(FINEST);
        let numbers = unknowns.iter().map(|unknown| unknown.parameter);
        let own: Vec<Parameter> = numbers.filter(|number| number.is_of(&input.cell)).collect();
        let parameters: Vec<Parameter> = [Parameter::R0].into_iter().chain(own.iter().copied()).collect();
        let options = DivisionOptions { parameters: &parameters, ..DivisionOptions::default() };
        let (division, by) = divide_with(&input, options).ok()?;
        let (by, sign) = (by?, division.chi_signed()?.signum());
        let radius = match lineage.mother(founder).filter(|_| lineage.given_r0(founder).is_none()) {
            Some(mother) => self.slopes(mother)?.radius(lineage.founders[founder].daughter),
            None => vec![0.0; unknowns.len()],
        };
        let of = |(unknown, radius): (&Unknown, &f64)| {
            let itself =
                own.iter().position(|number| *number == unknown.parameter).map_or(0.0, |i| by[i + 1].chi_signed);
            sign * (itself + by[0].chi_signed * radius)
        };
        let chi = unknowns.iter().zip(&radius).map(of).collect();
        Some(Slopes { r0, division, radius, chi })
    }
}

/// The objective of the fit.
pub(super) struct Objective<'a> {
    run: FitRun<'a>,
    pub targets: &'a Targets,
    template: &'a Cue,
    pub unknowns: Vec<Unknown>,
    tried: AtomicUsize,
    /// Most cues that are tried.
    of: usize,
    /// The least misfit so far.
    least: Mutex<f64>,
}

impl Objective<'_> {
    pub fn check_cancelled(&self) -> Result<(), FitError> {
        check_cancelled(self.run.cancel, self.tried.load(Ordering::Relaxed), CUES)
    }

    fn cue(&self, place: &[f64]) -> Cue {
        let mut cell = Cell::new(1.0).with_cue(self.template.clone());
        for (unknown, share) in self.unknowns.iter().zip(place) {
            unknown.parameter.set(&mut cell, unknown.value(*share));
        }
        cell.cue
    }

    /// χ of each measurement with a cue.
    pub fn chi(&self, cue: &Cue) -> Vec<Option<f64>> {
        let found = self.residuals(cue, &BTreeMap::new(), &self.targets.chi);
        found.iter().map(|residual| residual.computed).collect()
    }

    /// χ of a cell over its own radius, with a cue; `None` if it does not divide.
    pub fn chi_over_r0(&self, cue: &Cue, name: &str, r0: f64) -> Option<f64> {
        let volumes = BTreeMap::new();
        divide(&self.chain(cue, &volumes).input(self.run.lineage.founder_named(name)?, r0)?).ok()?.chi()
    }

    fn residuals(&self, cue: &Cue, volumes: &BTreeMap<String, f64>, measured: &[MeasuredChi]) -> Vec<ChiResidual> {
        let mut chain = self.chain(cue, volumes);
        let one = |MeasuredChi { cell, mean, sd }: &MeasuredChi| {
            let founder = self.run.lineage.founder_named(cell);
            let r0 = founder.and_then(|founder| chain.r0(founder));
            let computed = founder.and_then(|founder| chain.division(founder)?.chi());
            let residual = computed.map(|chi| (chi - mean) / sd);
            ChiResidual { cell: cell.clone(), r0, measured: *mean, sd: *sd, computed, residual }
        };
        measured.iter().map(one).collect()
    }

    fn fitted(&self, place: &[f64]) -> Vec<ChiResidual> {
        self.residuals(&self.cue(place), &BTreeMap::new(), &self.targets.chi)
    }

    fn chi_squared(&self, place: &[f64]) -> f64 {
        let outside: f64 = place.iter().map(|x| (x - x.clamp(0.0, 1.0)).abs()).sum();
        if self.check_cancelled().is_err() || outside > 0.0 {
            return f64::INFINITY;
        }
        let tried = self.tried.fetch_add(1, Ordering::Relaxed) + 1;
        let misfit = self.fitted(place).iter().map(|r| r.residual.unwrap_or(UNDIVIDED).powi(2)).sum();
        self.show(tried, misfit);
        misfit
    }

    fn show(&self, tried: usize, misfit: f64) {
        let Some(show) = self.run.progress else { return };
        // The number stays valid if a thread panics.
        let mut least = self.least.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        *least = least.min(misfit);
        show(FitProgress { done: tried.min(self.of), of: self.of, least: Some(*least) });
    }

    fn chain<'a>(&'a self, cue: &'a Cue, volumes: &'a BTreeMap<String, f64>) -> Chain<'a> {
        Chain { objective: self, cue, volumes, divisions: BTreeMap::new(), slopes: BTreeMap::new() }
    }

    /// ∂χ/∂(number), rows by measurement; `None` where an outcome is not smooth.
    fn sensitivities(&self, place: &[f64]) -> Option<Vec<Vec<f64>>> {
        let (cue, volumes) = (self.cue(place), BTreeMap::new());
        let mut chain = self.chain(&cue, &volumes);
        let row = |measured: &MeasuredChi| {
            let slopes = chain.slopes(self.run.lineage.founder_named(&measured.cell)?)?.chi;
            let numbers = self.unknowns.iter().zip(place);
            Some(slopes.iter().zip(numbers).map(|(slope, (unknown, share))| slope * unknown.scale(*share)).collect())
        };
        self.targets.chi.iter().map(row).collect()
    }
}

/// How a division changes with the numbers of the cue.
#[derive(Clone)]
struct Slopes {
    r0: f64,
    division: Division,
    /// ∂R0/∂(number) of the cell.
    radius: Vec<f64>,
    /// ∂χ/∂(number) of its division.
    chi: Vec<f64>,
}

impl Slopes {
    /// ∂R0/∂(number) of a daughter. Her R0 is the cell's times the third root of her share (1 ± χ)/2.
    fn radius(&self, which: Option<Daughter>) -> Vec<f64> {
        let way = if which == Some(Daughter::Larger) { 1.0 } else { -1.0 };
        let asymmetric = self.division.outcome() == Outcome::Asymmetric;
        let chi = self.division.chi().filter(|_| asymmetric).unwrap_or(0.0);
        let share = 0.5 * (1.0 + way * chi);
        let of = |(radius, slope): (&f64, &f64)| {
            let change = if asymmetric { 0.5 * way * slope } else { 0.0 };
            radius * share.cbrt() + self.r0 * share.cbrt() / (3.0 * share) * change
        };
        self.radius.iter().zip(&self.chi).map(of).collect()
    }
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
    if !by_rules && !(0..lineage.founders.len()).any(|founder| lineage.gives_cue(founder)) {
        return Err(FitError::NoCue);
    }
    let (unknowns, tried, least) = (unknowns(template), AtomicUsize::new(0), Mutex::new(f64::INFINITY));
    // A simplex asks for its corners and, in most steps, for one or two places.
    let of = effort.evaluations() + unknowns.len() + 1 + 2 * DESCENT as usize;
    let objective = Objective { run: *run, targets, template, unknowns, tried, of, least };
    scheduler::pool(run.threads)?.install(|| {
        let region = vec![[0.0, 1.0]; objective.unknowns.len()];
        let found = swarm(&region, effort, &|place| objective.chi_squared(place));
        objective.check_cancelled()?;
        let (tried, advice) = (objective.tried.load(Ordering::Relaxed), "try terms on other fields");
        let (place, least) = found.ok_or(FitError::Nothing { tried, what: CUES, advice })?;
        let (place, chi_squared) = descend(&place, EDGE, DESCENT, &|place| objective.chi_squared(place))
            .filter(|(_, better)| *better <= least)
            .unwrap_or((place, least));
        objective.check_cancelled()?;
        complete(&objective, &place, chi_squared)
    })
}

fn complete(objective: &Objective<'_>, place: &[f64], chi_squared: f64) -> Result<FittedCue, FitError> {
    let cue = objective.cue(place);
    let sensitivities = objective.sensitivities(place);
    let goodness = Goodness::of(chi_squared, objective.targets.chi.len(), place.len());
    let held = |rows: &Vec<Vec<f64>>| held(rows, &objective.targets.chi, goodness);
    let combinations = sensitivities.as_ref().map(held).transpose()?;
    let sd = |k: usize| {
        let (held, factor) = (combinations.as_ref()?, goodness.error_scale?);
        // Σ (v_k/σ)²: without bound if a direction that this number is part of is held by nothing.
        let sum: f64 = held.iter().map(|h| (h.components[k] / h.singular_value).powi(2)).sum();
        let relative = factor * sum.sqrt();
        let scale = objective.unknowns[k].scale(place[k]).abs();
        (relative.is_finite() && relative < 1.0 / OPEN).then_some(relative * scale)
    };
    let number = |(k, unknown): (usize, &Unknown)| CueNumber {
        name: unknown.parameter.to_string(),
        value: unknown.value(place[k]),
        searched: unknown.limits.map(|limit| limit * unknown.sign),
        sd: sd(k),
    };
    let numbers: Vec<CueNumber> = objective.unknowns.iter().enumerate().map(number).collect();
    let limited = |(number, &share): (&CueNumber, &f64)| {
        let CueNumber { name, value, searched, .. } = number;
        // The range of a negative amplitude runs downwards.
        let share = if searched[0] > searched[1] { 1.0 - share } else { share };
        Some(NumberAtLimit { name: name.clone(), value: *value, limit: Limit::at(share)?, searched: *searched })
    };
    let residuals = objective.fitted(place);
    let at_limit = numbers.iter().zip(place).filter_map(limited).collect();
    let others = objective.targets.out_of_sample.iter();
    let out_of_sample = others.flat_map(|out| objective.residuals(&cue, &out.volumes, &out.chi)).collect();
    Ok(FittedCue {
        cue: cue.to_string(),
        jumps: jumps(objective, &cue, &numbers, &residuals)?,
        numbers,
        goodness,
        residuals,
        sensitivities,
        combinations,
        out_of_sample,
        at_limit,
        tried: objective.tried.load(Ordering::Relaxed),
    })
}

/// Directions of the cue's numbers by how firmly the measurements hold them.
fn held(rows: &[Vec<f64>], measured: &[MeasuredChi], goodness: Goodness) -> Result<Vec<Combination>, FitError> {
    let weighted: Vec<Vec<f64>> =
        rows.iter().zip(measured).map(|(row, m)| row.iter().map(|x| x / m.sd).collect()).collect();
    let Svd { values, right, .. } = Svd::of_rows(&weighted)?;
    let of = |(k, components): (usize, Vec<f64>)| {
        let singular_value = values.get(k).copied().unwrap_or(0.0);
        Combination {
            singular_value,
            determined: singular_value > OPEN * goodness.error_scale.unwrap_or(1.0),
            components,
        }
    };
    Ok(right.into_iter().enumerate().map(of).collect())
}

#[cfg(test)]
mod tests {
    use furrow_cell::Numerics;
    use furrow_lineage::{Lineage, TreeSettings};

    use super::super::unknowns::AMPLITUDES;
    use super::*;

    /// Calls `then` with the objective and the published cue's place in the units of the search.
    fn of_the_embryo<T>(numerics: Numerics, then: impl FnOnce(&Objective<'_>, Vec<f64>) -> T) -> T {
        let (lineage, targets) = (Lineage::c_elegans().unwrap(), Targets::embryo().unwrap());
        let (template, settings) = (Cue::published(), TreeSettings { numerics, ..TreeSettings::default() });
        let unknowns = unknowns(&template);
        let cell = Cell::gao2026_thresholds(1.0).with_cue(template.clone());
        let share = |unknown: &Unknown| {
            let ([from, to], value) = (unknown.limits, unknown.parameter.get(&cell));
            if unknown.logarithmic { (value / from).ln() / (to / from).ln() } else { (value - from) / (to - from) }
        };
        let place = unknowns.iter().map(share).collect();
        let (tried, least, cancel) = (AtomicUsize::new(0), Mutex::new(f64::INFINITY), false.into());
        let run = FitRun::new(&lineage, &settings, 1, &cancel);
        then(&Objective { run, targets: &targets, template: &template, unknowns, tried, of: 0, least }, place)
    }

    #[test]
    fn sensitivities_are_handed_down_from_mother_to_daughter() {
        // Differences of divisions need them solved as finely as their tangents.
        let preset = Numerics::default();
        let fine = Numerics { time_tolerance: FINER * preset.time_tolerance, noise: 0.0, ..preset };
        of_the_embryo(fine, |objective, place| {
            let exact = objective.sensitivities(&place).unwrap();
            assert_eq!(exact.len(), 4);
            for (k, unknown) in objective.unknowns.iter().enumerate() {
                let chi = |share: f64| -> Vec<f64> {
                    let moved = super::super::search::moved(&place, k, share);
                    objective.fitted(&moved).iter().map(|residual| residual.computed.unwrap()).collect()
                };
                // χ of P3 turns quickly with the place of the cue.
                let step = 1e-3;
                let (above, below) = (chi(place[k] + step), chi(place[k] - step));
                let length = unknown.value(place[k] + step) - unknown.value(place[k] - step);
                for (i, row) in exact.iter().enumerate() {
                    let expected = (above[i] - below[i]) / length * unknown.scale(place[k]);
                    let (off, of) = ((row[k] - expected).abs(), unknown.parameter);
                    assert!(off < 0.02 * expected.abs() + 1e-3, "row {i}, {of}: {} {expected}", row[k]);
                }
            }
        });
    }

    #[test]
    fn errors_grow_with_the_misfit() {
        of_the_embryo(Numerics::default(), |objective, place| {
            let [good, poor] = [1.0, 4.0].map(|chi_squared| complete(objective, &place, chi_squared).unwrap());
            assert_eq!((poor.goodness.degrees_of_freedom, poor.goodness.error_scale), (1, Some(2.0)));
            assert!((poor.goodness.p.unwrap() - 0.0455).abs() < 1e-4, "{:?}", poor.goodness);
            let errors: Vec<_> =
                good.numbers.iter().zip(&poor.numbers).filter_map(|(good, poor)| Some([good.sd?, poor.sd?])).collect();
            assert!(!errors.is_empty(), "{:?}", good.numbers);
            assert!(errors.iter().all(|[good, poor]| (poor / good - 2.0).abs() < 1e-12), "{errors:?}");
        });
    }

    #[test]
    fn a_number_at_the_edge_of_its_range_is_named() {
        of_the_embryo(Numerics::default(), |objective, mut place| {
            assert!(complete(objective, &place, 1.0).unwrap().at_limit.is_empty());
            let amplitude = place.len() - 1;
            place[amplitude] = 0.001;
            let found = complete(objective, &place, 1.0).unwrap().at_limit;
            let [NumberAtLimit { name, limit: Limit::Lower, searched, .. }] = &found[..] else { panic!("{found:?}") };
            assert_eq!((name.as_str(), *searched), ("cue[0].amplitude", AMPLITUDES));
        });
    }
}
