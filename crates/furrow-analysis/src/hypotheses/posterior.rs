//! The numbers of a hypothesis as a sample of their posterior, and which measured cells surprise it.
//!
//! The prior is uniform over the ranges that are searched, by the logarithm where they are searched so. A common σ is integrated out
//! with the prior 1/σ:
//!
//! * \[F.14 common error\] ln L = ln ½Γ(n/2) − ½n ln(π Σ_i (χ_i − χ(cell, θ))²).
//!
//! The check of a cell compares its measured mean with means that the sample predicts for as many divisions with their errors.

use furrow_lineage::batch::SOLVER_VERSION;
use furrow_measured::significance::normal_tail;
use furrow_measured::statistics::{distinct, mean, sd};
use serde::Serialize;
use std::f64::consts::PI;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::Question;
use super::folded;
use super::hierarchy::{self, EmbryoNumber};
use super::noise::{Noise, NoiseKind, UNDIVIDED};
use super::observations::{Observation, Observations};
use super::others::{self, Others};
use super::parts::{ASKED, HYPOTHESIS, LOG_EVIDENCE, PART};
use crate::constants::{EMBRYO, named};
use crate::fit::chain::Model;
use crate::fit::error::check_cancelled;
use crate::fit::{FitError, FitProgress};
use crate::ranges::{Range, correlation};
use crate::shard::Shard;
use crate::table::csv_of;
use crate::tempering::{Particle, Sample, Sampling, sample};

/// Numbers with a correlation above this are called a ridge.
const RIDGE: f64 = 0.9;
/// Cells with a smaller probability surprise a hypothesis.
const SURPRISE: f64 = 0.05;

/// Candidates of the sample in errors, and the usual number of them for each particle.
const SAMPLES: &str = "samples";
pub(super) const USUAL: usize = 25;

/// A number over the sample.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SampledNumber {
    /// Its name.
    pub name: String,
    /// Its mean.
    pub mean: f64,
    /// Its standard deviation.
    pub sd: f64,
    /// Its quantiles.
    #[serde(flatten)]
    pub range: Range,
}

/// Two numbers that the measurements hold together better than each by itself.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Ridge {
    /// Their names.
    pub numbers: [String; 2],
    /// Their correlation over the sample.
    pub correlation: f64,
}

/// A cell over the sample.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PredictedCell {
    /// The cell that divides.
    pub cell: String,
    /// χ, of the part of the sample in which it divides; `None` if it never does.
    pub chi: Option<Range>,
    /// The part of the sample in which it rests.
    pub rests: f64,
    /// Two-sided probability of a mean as far from the predicted ones as the measured mean.
    pub p: f64,
}

/// A hypothesis as a sample.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Posterior {
    /// Points of the sample, which all weigh the same.
    pub samples: usize,
    /// Tempered densities between the prior and the posterior.
    pub stages: usize,
    /// How often the cells were divided.
    pub evaluations: usize,
    /// The share of the last Metropolis steps that was accepted.
    pub accepted: f64,
    /// Log evidence, up to a number that all hypotheses share if the error is a common one.
    pub log_evidence: f64,
    /// Its numbers.
    pub parameters: Vec<SampledNumber>,
    /// Numbers that are open along a line.
    pub ridges: Vec<Ridge>,
    /// The cells, in the order of the lineage.
    pub cells: Vec<PredictedCell>,
    /// The number that differs between embryos, of each of them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub embryos: Vec<EmbryoNumber>,
    /// The sample: the numbers of each point, in their order.
    #[serde(skip)]
    pub points: Vec<Vec<f64>>,
    /// The place of its most likely point in the unit cube.
    #[serde(skip)]
    pub(super) best: Vec<f64>,
    /// A hash of the data and the model, by which parts of one sample know each other.
    #[serde(skip)]
    pub(super) asked: String,
}

/// The results at one point of the sample.
#[derive(Clone)]
struct Computed {
    /// χ of the cells, with the number that all embryos share.
    chi: Vec<Option<f64>>,
    /// Of each embryo, the mean of its number and of its square.
    moments: Vec<[f64; 2]>,
}

impl Posterior {
    /// The cells that surprise the hypothesis.
    pub fn surprising(&self) -> impl Iterator<Item = &PredictedCell> {
        self.cells.iter().filter(|cell| cell.p < SURPRISE)
    }
}

/// ln Γ(n/2).
fn ln_gamma_of_half(n: usize) -> f64 {
    let (first, start) = if n.is_multiple_of(2) { (1.0, 0.0) } else { (0.5, 0.5 * PI.ln()) };
    let count = (n - 1) / 2;
    start + (0..count).map(|k| (first + k as f64).ln()).sum::<f64>()
}

/// ln L of rows, given χ of the cells. A common σ is integrated out.
pub(super) fn log_density_of(rows: &[Observation], chi: &[Option<f64>], noise: &Noise) -> f64 {
    let n = rows.len();
    if noise.kind != NoiseKind::Common {
        return noise.log_likelihood(rows, chi, &noise.sds(rows));
    }
    let sd = noise.fitted(&rows[..1], rows, chi)[0];
    if noise.folded {
        return folded::over_sd(|sd| noise.log_likelihood(rows, chi, &vec![sd; n]), sd, n);
    }
    let squares = n as f64 * sd.powi(2);
    ln_gamma_of_half(n) - 2.0_f64.ln() - 0.5 * n as f64 * (PI * squares).ln()
}

/// A hash of the measurements, their errors, the model and the solver's version.
fn asked(Question { observations, noise, .. }: &Question<'_>, model: &Model<'_>, by_embryo: Option<usize>) -> String {
    let Observations { rows, others, units, .. } = observations;
    let Model { run, template, unknowns, .. } = model;
    let all = format!(
        "{rows:?} {others:?} {units:?} {noise:?} {:?} {:?} {template:?} {unknowns:?} {by_embryo:?} {SOLVER_VERSION}",
        run.lineage, run.settings
    );
    blake3::hash(all.as_bytes()).to_hex()[..16].to_owned()
}

/// Draws the sample of a hypothesis's model.
pub(super) fn posterior(
    question: &Question<'_>,
    (model, by_embryo): (&Model<'_>, Option<usize>),
    sampling: Sampling,
) -> Result<Posterior, FitError> {
    let Question { observations, noise, .. } = question;
    let Observations { rows, cells, units, .. } = observations;
    let of_all: Vec<&Others> = observations.others.iter().collect();
    let (done, usual) = (AtomicUsize::new(0), sampling.particles * USUAL);
    let check = || check_cancelled(model.run.cancel, done.load(Ordering::Relaxed), SAMPLES);
    let likelihood = |place: &[f64]| {
        check().ok()?;
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        if let Some(show) = model.run.progress {
            show(FitProgress { done, of: usual.max(done), least: None });
        }
        let values = model.values(place);
        let chi = model.chi(&values, cells);
        let beside = others::summed(&of_all, model, &values, Others::log_likelihood);
        let (of_chi, moments) = match by_embryo {
            None => (log_density_of(rows, &chi, noise), Vec::new()),
            Some(k) => hierarchy::by_embryo(model, k, place, (observations, noise)),
        };
        Some((of_chi + beside, Computed { chi, moments }))
    };
    let dimensions = model.unknowns.len() + usize::from(by_embryo.is_some());
    let found = sample(dimensions, sampling, &likelihood);
    check()?;
    let tried = done.load(Ordering::Relaxed);
    let interrupted = FitError::Interrupted { tried, what: SAMPLES };
    let Sample { particles, log_evidence, stages, evaluations, accepted } = found.ok_or(interrupted)?;
    if log_evidence == f64::NEG_INFINITY {
        return Err(FitError::Nothing { tried, what: SAMPLES, advice: "give other ranges" });
    }
    let spread = |place: &[f64]| Some(hierarchy::spread(model, by_embryo?, *place.last()?));
    let point = |place: &Vec<f64>| model.values(place).into_iter().chain(spread(place)).collect();
    let points: Vec<Vec<f64>> = particles.iter().map(|particle| point(&particle.place)).collect();
    let of_spread = by_embryo.map(|k| named(model.unknowns[k].kind, Some(EMBRYO)));
    let names: Vec<String> = model.unknowns.iter().map(|unknown| unknown.name()).chain(of_spread).collect();
    let best = particles.iter().max_by(|a, b| a.log_likelihood.total_cmp(&b.log_likelihood));
    Ok(Posterior {
        samples: points.len(),
        stages,
        evaluations,
        accepted,
        log_evidence,
        parameters: names.iter().enumerate().filter_map(|(k, name)| number(name, &points, k)).collect(),
        ridges: ridges(&names, &points),
        cells: (0..cells.len()).map(|cell| predicted(question, &particles, cell)).collect(),
        embryos: match by_embryo {
            Some(_) => hierarchy::numbers(units, particles.iter().map(|particle| &particle.computed.moments)),
            None => Vec::new(),
        },
        asked: asked(question, model, by_embryo),
        best: best.map_or(Vec::new(), |particle| particle.place[..model.unknowns.len()].to_vec()),
        points,
    })
}

fn number(name: &str, points: &[Vec<f64>], k: usize) -> Option<SampledNumber> {
    let values: Vec<f64> = points.iter().map(|point| point[k]).collect();
    let range = Range::of(values.iter().map(|value| (*value, 1.0)).collect())?;
    Some(SampledNumber { name: name.to_owned(), mean: mean(&values), sd: sd(&values).unwrap_or(0.0), range })
}

fn ridges(names: &[String], points: &[Vec<f64>]) -> Vec<Ridge> {
    let column = |k: usize| points.iter().map(|point| point[k]).collect::<Vec<f64>>();
    let pairs = (0..names.len()).flat_map(|b| (0..b).map(move |a| (a, b)));
    let of = |(a, b): (usize, usize)| {
        let correlation = correlation(&column(a), &column(b))?;
        (correlation.abs() > RIDGE).then(|| Ridge { numbers: [names[a].clone(), names[b].clone()], correlation })
    };
    pairs.filter_map(of).collect()
}

/// A cell over the sample. Where it rests, its χ is as wrong as in the likelihood.
fn predicted(question: &Question<'_>, particles: &[Particle<Computed>], cell: usize) -> PredictedCell {
    let Question { observations, noise, .. } = question;
    let rows = &observations.rows;
    let chi: Vec<f64> = particles.iter().filter_map(|particle| particle.computed.chi[cell]).collect();
    // The probability of a smaller mean under each point, with divisions weighted by their errors.
    let below = |particle: &Particle<Computed>| {
        let sds = noise.fitted(rows, rows, &particle.computed.chi);
        let chi = particle.computed.chi[cell];
        let off = |row: &Observation, sd: f64| match chi {
            Some(chi) if noise.folded => {
                let [expected, sd] = folded::moments(chi, sd);
                [row.chi - expected, sd]
            }
            chi => [chi.map_or(UNDIVIDED, |chi| row.chi - chi), sd],
        };
        let own = rows.iter().zip(&sds).filter(|(row, _)| row.cell == cell);
        let [sum, variance] = own.fold([0.0; 2], |[sum, variance], (row, sd)| {
            let [off, error] = off(row, *sd);
            [sum + off / (sd * sd), variance + (error / (sd * sd)).powi(2)]
        });
        normal_tail(sum / variance.sqrt())
    };
    let above = mean(&particles.iter().map(below).collect::<Vec<f64>>());
    PredictedCell {
        cell: observations.cells[cell].clone(),
        rests: 1.0 - chi.len() as f64 / particles.len() as f64,
        chi: Range::of(chi.into_iter().map(|chi| (chi, 1.0)).collect()),
        p: 2.0 * above.min(1.0 - above),
    }
}

/// The samples of hypotheses as a table: a column for each number, and one of the hypotheses' names if there are several. Numbers that
/// a hypothesis does not have are empty. A part of a sample also has its log evidence, a hash of the data and the model, and which part it is.
pub fn samples_csv<'a>(
    hypotheses: impl Iterator<Item = (&'a str, &'a Posterior)> + Clone,
    part: Option<Shard>,
) -> String {
    let numbers = hypotheses.clone().flat_map(|(_, posterior)| &posterior.parameters);
    let names = distinct(numbers.map(|number| number.name.as_str()));
    let is_one = hypotheses.clone().count() == 1;
    let named = |name: &str| if is_one { None } else { Some(name.to_owned()) };
    let head = named(HYPOTHESIS).into_iter().chain(names.iter().map(|name| (*name).to_owned()));
    let of_part = part.iter().flat_map(|_| [LOG_EVIDENCE, ASKED, PART]).map(str::to_owned);
    let head = head.chain(of_part).collect();
    let rows = hypotheses.flat_map(|(hypothesis, posterior)| {
        let places: Vec<Option<usize>> =
            names.iter().map(|name| posterior.parameters.iter().position(|number| number.name == *name)).collect();
        let row = move |point: &Vec<f64>| {
            let value = |place: &Option<usize>| place.map_or(String::new(), |k| point[k].to_string());
            let of_part = |part: Shard| [posterior.log_evidence.to_string(), posterior.asked.clone(), part.to_string()];
            let of_part = part.into_iter().flat_map(of_part);
            named(hypothesis).into_iter().chain(places.iter().map(value)).chain(of_part).collect::<Vec<String>>()
        };
        posterior.points.iter().map(row).collect::<Vec<_>>()
    });
    csv_of(std::iter::once(head).chain(rows.collect::<Vec<_>>()))
}
