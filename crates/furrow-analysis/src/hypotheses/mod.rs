//! Hypotheses beside each other: which cue fits measured χ best, and whether the difference is more than chance.
//!
//! | file | content |
//! |---|---|
//! | [`observations`] | the measured χ, by cell and embryo |
//! | `fit_test` | whether a fit meets the measurements |
//! | `folded` | errors where χ has lost its sign |
//! | [`free`] | hypotheses, and the numbers that are fitted |
//! | `hierarchy` | a number that differs between embryos |
//! | `left_out` | how a fit predicts embryos that were left out of it |
//! | [`noise`] | the errors of χ, and the likelihood |
//! | `scores` | the fit of each hypothesis |
//! | [`others`] | what was observed beside χ: rounds and lifetimes |
//! | [`pairs`] | whether two hypotheses are distinguishable |
//! | [`parts`] | samples of a posterior drawn on several machines |
//! | [`posterior`] | the numbers as a sample of their posterior, and what surprises the hypothesis |
//! | `text` | the answer as text |
//!
//! The residuals of χ are taken to be normal and independent:
//!
//! * \[F.7 log likelihood\] ln L = −½ Σ_i ((χ_i − χ(cell, θ))²/σ_i² + ln 2πσ_i²),
//! * \[F.8 AICc\] AICc = 2k − 2 ln L + 2k(k + 1)/(n − k − 1) for n divisions and k fitted numbers, a common σ among them,
//! * \[F.9 left out\] Σ_e ln p(χ_e | θ₋ₑ, σ₋ₑ), with both fitted to all embryos but e,
//! * \[F.12 lack of fit\] F = Σ_c n_c(mean χ_c − χ(c, θ))²/σ_c²/(m − k) for m cells and k numbers without σ.
//!
//! A measured cell that does not divide in the model counts as if its χ were wrong by 1, more than any division can be.
//!
//! # References
//! Hurvich & Tsai, *Biometrika* 76, 297 (1989), for AICc; Vehtari, Gelman & Gabry, *Stat. Comput.* 27, 1413 (2017), for sums of
//! log densities of left-out data and the standard errors of their differences; Draper & Smith, *Applied Regression Analysis*,
//! 3rd ed., Wiley 1998, § 2.1, for the test by replicates.

#[cfg(test)]
mod calibration;
mod fit_test;
mod folded;
pub mod free;
mod hierarchy;
mod left_out;
pub mod noise;
pub mod observations;
pub mod others;
pub mod pairs;
pub mod parts;
pub mod posterior;
mod scores;
#[cfg(test)]
mod tests;
mod text;
#[cfg(test)]
mod weighting;

pub use fit_test::FitTest;
pub use free::{Hypothesis, Named};
pub use hierarchy::EmbryoNumber;
pub use noise::{Noise, NoiseKind};
pub use observations::Observations;
pub use others::{OtherScore, Others, OthersScore, Quantity};
pub use pairs::Pair;
pub use parts::{MergedSample, merge_parts};
pub use posterior::{Posterior, samples_csv};
pub use scores::{CellScore, FittedNumber, TestedHypothesis};

use std::sync::atomic::{AtomicUsize, Ordering};

use furrow_input::InputError;
use furrow_lineage::batch::{Memo, scheduler};
use furrow_measured::matching::Matched;
use furrow_measured::volumes::{EmbryoSize, Skipped};
use serde::Serialize;

use crate::fit::germline::most_candidates;
use crate::fit::search::{FitProgress, FitRun, SearchBudget};
use crate::fit::{FitError, NumberAtLimit};
use crate::tempering::Sampling;
use observations::{LeftOut, Unused};

/// The input of a test.
pub struct Question<'a> {
    /// The measured χ.
    pub observations: &'a Observations,
    /// The hypotheses, with different names.
    pub hypotheses: &'a [Hypothesis],
    /// The errors of χ.
    pub noise: &'a Noise,
    /// How long each fit is searched.
    pub effort: Effort,
    /// How posteriors are sampled, if they are.
    pub sampling: Option<Sampling>,
    /// Solved divisions.
    pub memo: &'a Memo,
}

/// The particles and moves of the search for each free number of a hypothesis: more numbers have more valleys.
const FOR_EACH: (usize, u64) = (12, 10);

/// How long each fit is searched.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effort {
    /// Particles of the swarm; `None` is 12 for each free number.
    pub particles: Option<usize>,
    /// Moves of each; `None` is 10 for each free number.
    pub moves: Option<u64>,
    /// Seed of their positions and moves.
    pub seed: u64,
}

impl Question<'_> {
    /// Checks whether numbers that differ between embryos can be told from errors: errors come from the table or from replicates, and
    /// there are embryos and a sample. Errors name `source`.
    ///
    /// # Errors
    /// As said.
    pub fn check(&self, source: &str) -> Result<(), InputError> {
        if !self.hypotheses.iter().any(Hypothesis::is_by_embryo) {
            return Ok(());
        }
        let require = |holds, allowed| InputError::require(holds, source, "free", "@embryo", allowed);
        require(self.sampling.is_some(), "used with a sample of the posterior: give samples")?;
        require(
            self.noise.kind != NoiseKind::Common,
            "used with errors that the table gives, or with noise from replicates",
        )?;
        require(self.observations.left_out == LeftOut::Embryo, "used with a table of two embryos or more")
    }

    /// About how many candidates the searches and the sample of a hypothesis try.
    fn candidates(&self, hypothesis: &Hypothesis) -> usize {
        let numbers = hypothesis.unknowns.len();
        let searches = match numbers {
            0 => 1,
            // With other observations χ is fitted alone as well.
            _ => {
                most_candidates(self.effort.budget(numbers), numbers)
                    * if self.observations.others.is_empty() { 1 } else { 2 }
            }
        };
        searches + self.sampling.map_or(0, |sampling| sampling.particles * posterior::USUAL)
    }
}

impl Effort {
    /// The budget of a hypothesis with this number of free numbers.
    fn budget(self, numbers: usize) -> SearchBudget {
        let numbers = numbers.max(1);
        SearchBudget {
            particles: self.particles.unwrap_or(FOR_EACH.0 * numbers),
            moves: self.moves.unwrap_or(FOR_EACH.1 * numbers as u64),
            seed: self.seed,
        }
    }
}

/// Hypotheses beside each other.
#[derive(Clone, Debug, Serialize)]
pub struct HypothesisTest {
    /// Number of divisions that the hypotheses are fitted to.
    pub n: usize,
    /// The kind of unit that was left out in turn.
    pub left_out: LeftOut,
    /// Their names: embryos or, where divisions are left out, their cells.
    pub units: Vec<String>,
    /// The errors of χ.
    pub noise: Noise,
    /// The hypotheses, in their order.
    pub hypotheses: Vec<TestedHypothesis>,
    /// Each pair of them.
    pub pairs: Vec<Pair>,
    /// Cells with a mean \|χ\| within two errors of 0, in the table and in a hypothesis, where errors are not folded. Errors make them look
    /// slightly unequal, which counts for a cue that does so.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub near_zero: Vec<String>,
    /// Measured divisions that cannot be used.
    pub unused: Vec<Unused>,
    /// The first values of the table that could not be read.
    pub skipped: Vec<Skipped>,
    /// How many there are.
    pub skipped_count: u64,
    /// Each embryo beside the others, by size.
    pub embryos: Vec<EmbryoSize>,
    /// How the cells of embryos that were followed were matched to the lineage.
    pub matched: Vec<Matched>,
}

/// Fits each hypothesis and compares all.
///
/// # Errors
/// [`FitError`]: the run was stopped, or no candidate gives a number. A cell that does not divide or cannot be computed is no error.
pub fn test(run: &FitRun<'_>, question: &Question<'_>) -> Result<HypothesisTest, FitError> {
    let Question { observations, hypotheses, noise, .. } = question;
    // Those with few numbers first: others start from their fits too.
    let mut order: Vec<usize> = (0..hypotheses.len()).collect();
    order.sort_by_cached_key(|k| hypotheses[*k].free());
    let work: Vec<usize> = hypotheses.iter().map(|hypothesis| question.candidates(hypothesis)).collect();
    let mut tested = scheduler::pool(run.threads)?.install(|| {
        let (mut all, mut before, mut earlier) = (Vec::new(), Vec::new(), 0);
        for k in order {
            // Searches and samples count their own candidates; together they are counted over all hypotheses.
            let counted = AtomicUsize::new(0);
            let show = |_| {
                let done = earlier + (counted.fetch_add(1, Ordering::Relaxed) + 1).min(work[k]);
                run.progress.inspect(|show| show(FitProgress { done, of: work.iter().sum(), least: None }));
            };
            let shown = FitRun { progress: Some(&show), ..*run };
            let (tested, values) = scores::tested(&shown, question, &hypotheses[k], &before)?;
            earlier += work[k];
            before.push(scores::Before { hypothesis: &hypotheses[k], values });
            all.push((k, tested));
        }
        Ok::<_, FitError>(all)
    })?;
    tested.sort_by_cached_key(|(k, _)| *k);
    let tested = scores::weighed(tested.into_iter().map(|(_, tested)| tested).collect());
    let of = |(k, cell): (usize, &String)| {
        let is_near = !noise.folded && tested.iter().any(|hypothesis| hypothesis.cells[k].is_near_zero);
        is_near.then(|| cell.clone())
    };
    Ok(HypothesisTest {
        near_zero: observations.cells.iter().enumerate().filter_map(of).collect(),
        n: observations.rows.len(),
        left_out: observations.left_out,
        units: observations.units.clone(),
        noise: (*noise).clone(),
        pairs: pairs::pairs(&tested),
        hypotheses: tested,
        unused: observations.unused.clone(),
        skipped: observations.skipped.clone(),
        skipped_count: observations.skipped_count,
        embryos: observations.embryos.clone(),
        matched: observations.matched.clone(),
    })
}

/// The numbers of a hypothesis at an end of their ranges.
pub type AtLimit = Vec<NumberAtLimit>;
