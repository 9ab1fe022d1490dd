//! A sample of the constants that agree with the targets.
//!
//! The posterior density of the unknowns θ, in x = ln θ (or θ itself where it may have either sign), is
//!
//! * \[F.2 posterior\] p(x) ∝ exp(−½ Σ_i (deviation_i/tolerance_i)² − ½ |x − x₀|²/s²) · \[all statements hold\],
//!
//! where the second term is a wide prior about the starting values: thresholds alone leave some combinations open. It is
//! sampled by importance: proposals from a Student t distribution, weights p/q. The first proposals are shaped by the exact
//! sensitivities at the best fit and lie about the starting values if these meet the thresholds well, later ones by the mean and covariance
//! of the weighted sample before.
//!
//! Every draw has a seed of its own, from the run's seed and its number, so that the ensemble does not depend on how many
//! threads check them.
//!
//! # References
//! Cappé, Guillin, Marin & Robert, "Population Monte Carlo", J. Comput. Graph. Stat. 13 (2004) 907.

use super::constants::{Constant, ConstantKind, Constants};
use super::constraints::{ConstraintCheck, Extent, check_constraints};
use super::journal::Journal;
use super::sample::seed_of;
use super::table::Row;
use furrow_cell::{Cell, Numerics, Parameter};
use furrow_lineage::batch::{SchedulerError, scheduler};
use furrow_mechanics::calibration::{CalibrateError, Targets, calibrate, moved, with_values};
use nalgebra::{DMatrix, DVector};
use rand_mt::Mt64;
use rayon::ThreadPool;
use serde::Serialize;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Standard deviation s of the prior, in x.
const PRIOR: f64 = 0.3;
/// Degrees of freedom of the proposals: tails heavy enough that no admissible set is out of reach.
const FREEDOM: f64 = 6.0;
/// Rounds that adapt the proposal.
const ROUNDS: usize = 6;
/// How much narrower proposals become, in x, where there are too few admissible draws to shape the next.
const NARROWER: f64 = 0.5;
/// How many independent draws a sample must be worth to shape a proposal: for each unknown, and for each admissible draw.
const ENOUGH: [f64; 2] = [4.0, 0.15];
/// How much wider a proposal is, in its covariance, than the sample that shapes it.
const WIDER: f64 = 1.3;
/// Draws of such a round for each member asked for, and at least.
const DRAWS: [usize; 2] = [2, 24];
/// Most draws for each member asked for.
const MOST: usize = 60;

/// The columns of the journal of an ensemble or a front.
pub const JOURNAL_COLUMNS: [&str; 1] = ["check"];

/// One admissible set of constants.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Member {
    /// Values of the unknowns, in their order.
    pub values: Vec<f64>,
    /// Its share of the posterior; all of them sum to 1.
    pub weight: f64,
    /// Thresholds ξ_s* in the order of the targets.
    pub thresholds: Vec<f64>,
}

/// A sample of admissible constants.
#[derive(Clone, Debug, PartialEq)]
pub struct Ensemble {
    /// The unknowns.
    pub parameters: Vec<Parameter>,
    /// The requested number of members, or fewer if admissible sets are too rare.
    pub members: Vec<Member>,
    /// (Σ w)²/Σ w²: how many independent draws from the posterior they are worth.
    pub effective_sample_size: f64,
    /// How many draws each statement excluded.
    pub excluded: BTreeMap<String, usize>,
    /// Draws checked.
    pub draws: usize,
}

impl Ensemble {
    /// The share of the draws that no statement excludes.
    pub fn acceptance(&self) -> f64 {
        1.0 - self.excluded.values().sum::<usize>() as f64 / self.draws.max(1) as f64
    }

    /// Its members with the names of their values.
    pub fn constants(&self) -> Vec<Constants> {
        let value = |(parameter, value): (&Parameter, &f64)| Constant {
            kind: ConstantKind::Parameter(*parameter),
            class: None,
            value: *value,
        };
        let values = |member: &Member| self.parameters.iter().zip(&member.values).map(value).collect();
        self.members.iter().map(|member| Constants { values: values(member), weight: member.weight }).collect()
    }
}

/// Why there is no ensemble.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EnsembleError {
    /// There is no best fit to start from.
    #[error(transparent)]
    Fit(#[from] CalibrateError),
    /// No draw agrees with the targets.
    #[error("none of {draws} draws agrees with the targets; most are excluded by {by}")]
    NoneAdmissible {
        /// Draws checked.
        draws: usize,
        /// The statement that excludes most.
        by: String,
    },
    /// The sensitivities at the best fit give no shape to draw from.
    #[error("the sensitivities at the best fit have no covariance; start the unknowns elsewhere")]
    NoCovariance,
    /// The workers could not be started.
    #[error(transparent)]
    Workers(#[from] SchedulerError),
    /// It was interrupted.
    #[error("interrupted")]
    Interrupted,
}

/// A Student t distribution.
struct Proposal {
    centre: DVector<f64>,
    /// A lower triangular root of its scale matrix.
    root: DMatrix<f64>,
}

impl Proposal {
    /// About a centre, with the scale matrix given; `None` if that is not positive definite.
    fn new(centre: DVector<f64>, scale: DMatrix<f64>) -> Option<Proposal> {
        Some(Proposal { centre, root: scale.cholesky()?.l() })
    }

    /// Draw number `index` of a seed.
    fn draw(&self, seed: u64, index: u64) -> DVector<f64> {
        let mut random = Mt64::new(seed_of(b"ensemble", seed, index));
        let d = self.centre.len();
        let standard = DVector::from_fn(d, |_, _| normal(&mut random));
        // A t-distributed vector is a normal one over the root of a χ² variable per degree of freedom.
        let chi_squared: f64 = (0..FREEDOM as usize).map(|_| normal(&mut random).powi(2)).sum();
        &self.centre + &self.root * standard * (FREEDOM / chi_squared).sqrt()
    }

    /// Logarithm of its density, up to a constant that all proposals of a dimension share.
    fn ln_density(&self, x: &DVector<f64>) -> f64 {
        let d: f64 = self.centre.len() as f64;
        let scaled =
            self.root.solve_lower_triangular(&(x - &self.centre)).unwrap_or_else(|| DVector::repeat(x.len(), 1e9));
        let ln_det: f64 = self.root.diagonal().iter().map(|v| v.ln()).sum();
        -ln_det - 0.5 * (FREEDOM + d) * f64::ln(1.0 + scaled.norm_squared() / FREEDOM)
    }
}

/// Uniform in (0, 1).
pub(crate) fn uniform(random: &mut Mt64) -> f64 {
    ((random.next_u64() >> 11) as f64 + 0.5) / (1u64 << 53) as f64
}

/// A standard normal number (Box & Muller).
pub(crate) fn normal(random: &mut Mt64) -> f64 {
    let radius = (-2.0 * uniform(random).ln()).sqrt();
    radius * (std::f64::consts::TAU * uniform(random)).cos()
}

/// A draw with its check.
struct Draw {
    x: DVector<f64>,
    check: ConstraintCheck,
    /// ln p − ln q.
    ln_weight: f64,
}

impl Draw {
    fn of(x: Vec<f64>, check: ConstraintCheck, proposal: &Proposal) -> Draw {
        let x = DVector::from_vec(x);
        let ln_prior = -0.5 * x.norm_squared() / (PRIOR * PRIOR);
        let ln_weight = ln_prior - check.misfit - proposal.ln_density(&x);
        Draw { x, check, ln_weight }
    }
}

/// A search among sets of constants: about which ones, how many, and how it runs.
#[derive(Clone, Copy)]
pub struct ConstantsSearch<'a> {
    /// The targets of the constants, and the constants that vary.
    pub targets: &'a Targets,
    /// The starting values, and the constants that do not vary.
    pub cell: &'a Cell,
    /// How shapes are computed.
    pub numerics: &'a Numerics,
    /// Sets of constants that are wanted, or that are checked.
    pub count: usize,
    /// Seed of the search.
    pub seed: u64,
    /// Threads; 0 is one for each core.
    pub threads: usize,
    /// Stops the search.
    pub cancel: &'a AtomicBool,
    /// Keeps the checks, from which an interrupted run resumes; its columns are [`JOURNAL_COLUMNS`].
    pub journal: Option<&'a Journal>,
    /// Called with the number of sets checked and the number expected, from any thread.
    pub progress: &'a (dyn Fn(usize, usize) + Sync),
}

impl<'a> ConstantsSearch<'a> {
    /// A search without a journal that shows no progress.
    pub fn new(
        targets: &'a Targets,
        cell: &'a Cell,
        numerics: &'a Numerics,
        (count, seed): (usize, u64),
        cancel: &'a AtomicBool,
    ) -> ConstantsSearch<'a> {
        ConstantsSearch {
            targets,
            cell,
            numerics,
            count,
            seed,
            threads: 0,
            cancel,
            journal: None,
            progress: &|_, _| (),
        }
    }

    /// Values of the unknowns at x, which counts from their starting values.
    pub(super) fn values(&self, x: &[f64]) -> Vec<(Parameter, f64)> {
        moved(&self.targets.starts(self.cell), x)
    }

    /// The unknowns.
    pub(super) fn parameters(&self) -> Vec<Parameter> {
        self.targets.starts(self.cell).into_iter().map(|(parameter, _)| parameter).collect()
    }

    /// Checks the constants at several x, numbered from `first`; `expected` sets are expected in all.
    pub(super) fn check_all(
        &self,
        pool: &ThreadPool,
        first: usize,
        places: &[Vec<f64>],
        extent: Extent,
        expected: usize,
    ) -> Result<Vec<(Vec<f64>, ConstraintCheck)>, EnsembleError> {
        let done = AtomicUsize::new(first);
        let one = |k: usize| {
            if self.cancel.load(Ordering::Relaxed) {
                return Err(EnsembleError::Interrupted);
            }
            let check = self.check(first + k, &places[k], extent);
            (self.progress)(done.fetch_add(1, Ordering::Relaxed) + 1, expected);
            Ok((places[k].clone(), check))
        };
        pool.install(|| scheduler::in_parallel(places.len(), one)).into_iter().collect()
    }

    /// Check number `index` of the journal, or a new one, which is then in it.
    fn check(&self, index: usize, x: &[f64], extent: Extent) -> ConstraintCheck {
        let known = self.journal.and_then(|journal| journal.rows.get(&index)?.cells.first().cloned());
        if let Some(check) = known.and_then(|check| serde_json::from_value(check).ok()) {
            return check;
        }
        let check = check_constraints(self.targets, &with_values(self.cell, &self.values(x)), self.numerics, extent);
        // A check with a number that JSON does not have is made again.
        if let (Some(journal), Ok(cell)) = (self.journal, serde_json::to_value(&check)) {
            journal.append(&Row { index, cells: vec![cell], why: None });
        }
        check
    }

    /// The best fit and the spread that its sensitivities leave, the prior included.
    fn laplace(&self) -> Result<Proposal, EnsembleError> {
        let fit = calibrate(self.targets, self.cell, self.numerics)?;
        let starts = self.targets.starts(self.cell);
        let d = starts.len();
        let weighted = self.targets.thresholds.iter().zip(self.targets.weights());
        let tolerance = weighted.map(|(t, weight)| t.tolerance / weight).fold(f64::INFINITY, f64::min);
        let mut precision = DMatrix::identity(d, d) / (PRIOR * PRIOR);
        for combination in &fit.combinations {
            let direction = DVector::from_column_slice(&combination.components);
            precision += &direction * direction.transpose() * (combination.singular_value / tolerance).powi(2);
        }
        let best = DVector::from_vec(fit.moves_from(&starts));
        let covariance = precision.try_inverse().unwrap_or_else(|| DMatrix::identity(d, d) * (PRIOR * PRIOR));
        let start =
            check_constraints(self.targets, &with_values(self.cell, &starts), self.numerics, Extent::UntilExcluded);
        // About the start, if it meets the thresholds to about twice their tolerance.
        if start.thresholds.len() == self.targets.thresholds.len()
            && start.misfit <= 2.0 * start.thresholds.len() as f64
        {
            return Proposal::new(DVector::zeros(d), covariance).ok_or(EnsembleError::NoCovariance);
        }
        // Between the best fit and the start: either may be excluded.
        let spread = &best * best.transpose() * 0.25;
        Proposal::new(&best * 0.5, covariance * 2.0 + spread).ok_or(EnsembleError::NoCovariance)
    }
}

/// Powers of weights over the largest, from logarithms, and the logarithm of the largest. A weight of 0 stays 0.
pub(crate) fn relative_weights(logs: impl Iterator<Item = f64> + Clone, power: f64) -> (Vec<f64>, f64) {
    let largest = logs.clone().fold(f64::NEG_INFINITY, f64::max);
    let of = |log: f64| if log == f64::NEG_INFINITY { 0.0 } else { (power * (log - largest)).exp() };
    (logs.map(of).collect(), power * largest)
}

/// Normalised weights of draws to a power, 0 for excluded draws.
fn weights(draws: &[Draw], power: f64) -> Vec<f64> {
    let ln = |draw: &Draw| if draw.check.is_admissible() { draw.ln_weight } else { f64::NEG_INFINITY };
    let (raw, _) = relative_weights(draws.iter().map(ln), power);
    let total: f64 = raw.iter().sum();
    raw.into_iter().map(|w| if total > 0.0 { w / total } else { 0.0 }).collect()
}

/// How many independent draws a weighted sample is worth.
fn effective_size(weights: &[f64]) -> f64 {
    1.0 / weights.iter().map(|w| w * w).sum::<f64>()
}

/// The mean and the covariance of points with weights that sum to 1, with `floor` added to each variance.
pub(crate) fn mean_and_covariance<'a>(
    dimensions: usize,
    points: impl Iterator<Item = (&'a DVector<f64>, f64)> + Clone,
    floor: f64,
) -> (DVector<f64>, DMatrix<f64>) {
    let mut mean = DVector::zeros(dimensions);
    points.clone().for_each(|(x, weight)| mean += x * weight);
    let mut covariance = DMatrix::identity(dimensions, dimensions) * floor;
    for (x, weight) in points {
        let off = x - &mean;
        covariance += &off * off.transpose() * weight;
    }
    (mean, covariance)
}

/// The distribution with the mean and covariance of a weighted sample; `None` from too few draws. If a few draws have most of the
/// weight, a smaller power of the weights is used: early proposals lie beside the posterior, and few draws must not narrow the next.
fn fitted(draws: &[Draw]) -> Option<Proposal> {
    let (d, admissible) = (draws.first()?.x.len(), draws.iter().filter(|draw| draw.check.is_admissible()).count());
    let enough = (ENOUGH[0] * d as f64).max(ENOUGH[1] * admissible as f64);
    if (admissible as f64) < enough {
        return None;
    }
    let tempered = (0..16).map(|halvings| weights(draws, 0.5f64.powi(halvings)));
    let weights = tempered.into_iter().find(|weights| effective_size(weights) >= enough)?;
    let (mean, covariance) =
        mean_and_covariance(d, draws.iter().map(|draw| &draw.x).zip(weights.iter().copied()), 1e-8);
    Proposal::new(mean, covariance * WIDER)
}

/// Samples as many admissible sets of constants as the search wants.
///
/// # Errors
/// [`EnsembleError`].
pub fn ensemble(search: &ConstantsSearch<'_>) -> Result<Ensemble, EnsembleError> {
    let (count, pool) = (search.count, scheduler::pool(search.threads)?);
    let mut proposal = search.laplace()?;
    let mut draws = 0;
    let mut excluded = BTreeMap::new();
    let mut draw_all = |proposal: &Proposal, many: usize, expected: usize| -> Result<Vec<Draw>, EnsembleError> {
        let places: Vec<Vec<f64>> =
            (draws..draws + many).map(|index| proposal.draw(search.seed, index as u64).data.into()).collect();
        let checked = search.check_all(&pool, draws, &places, Extent::UntilExcluded, expected)?;
        draws += many;
        for exclusion in checked.iter().filter_map(|(_, check)| check.excluded.first()) {
            *excluded.entry(exclusion.datum.clone()).or_insert(0) += 1;
        }
        Ok(checked.into_iter().map(|(x, check)| Draw::of(x, check, proposal)).collect())
    };
    let many = (DRAWS[0] * count).max(DRAWS[1]);
    for _ in 0..ROUNDS {
        // One round of draws for the sample itself is expected.
        let found = draw_all(&proposal, many, (ROUNDS + 1) * many)?;
        match fitted(&found) {
            Some(better) => proposal = better,
            None => proposal.root *= NARROWER,
        }
    }
    let mut kept: Vec<Draw> = Vec::new();
    let mut tried = 0;
    while kept.len() < count && tried < MOST * count {
        // As many more as the share of admissible draws so far calls for.
        let more = if kept.is_empty() { many } else { ((count - kept.len()) * tried).div_ceil(kept.len()) };
        let expected = ROUNDS * many + tried + more.next_multiple_of(many);
        kept.extend(draw_all(&proposal, many, expected)?.into_iter().filter(|draw| draw.check.is_admissible()));
        tried += many;
    }
    kept.truncate(count);
    let weights = weights(&kept, 1.0);
    if kept.is_empty() {
        let by = excluded.iter().max_by_key(|(_, n)| **n).map_or("-".to_owned(), |(datum, _)| datum.clone());
        return Err(EnsembleError::NoneAdmissible { draws, by });
    }
    let member = |(draw, &weight): (&Draw, &f64)| Member {
        values: search.values(draw.x.as_slice()).into_iter().map(|(_, value)| value).collect(),
        weight,
        thresholds: draw.check.thresholds.clone(),
    };
    Ok(Ensemble {
        parameters: search.parameters(),
        members: kept.iter().zip(&weights).map(member).collect(),
        effective_sample_size: effective_size(&weights),
        excluded,
        draws,
    })
}
