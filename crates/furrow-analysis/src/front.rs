//! How well constants can meet all thresholds and statements at once: the front between the two.
//!
//! Thresholds have values, statements are true or false. Among all sets of constants that meet at least a given number of
//! statements, the front has the set with the least deviation of its worst threshold. It is found by random search: each generation
//! moves members of the best sets so far by normal steps, some of all sizes, and sometimes mixes two of them.
//!
//! Every candidate has a seed of its own, from the run's seed and its number, so that the front does not depend on how many
//! threads check the candidates.

use super::constraints::{ConstraintCheck, Exclusion, Extent};
use super::ensemble::{ConstantsSearch, EnsembleError, normal, uniform};
use super::sample::seed_of;
use furrow_cell::Parameter;
use furrow_lineage::batch::scheduler;
use furrow_mechanics::calibration::calibrate;
use rand_mt::Mt64;
use serde::Serialize;

/// Candidates of a generation.
const GENERATION: usize = 64;
/// Sets kept for each number of statements met: the parents of the next generation.
const KEPT: usize = 6;
/// Sizes of a step in x = ln θ, drawn evenly by their logarithm.
const STEPS: [f64; 2] = [1e-3, 0.1];
/// How often two parents are mixed.
const MIXED: f64 = 0.3;
/// Where a threshold is off by more, the statements are not looked at.
const WORST: f64 = 0.1;

/// A set of constants on the front.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FrontMember {
    /// Values of the unknowns, in their order.
    pub values: Vec<f64>,
    /// Thresholds ξ_s* in the order of the targets.
    pub thresholds: Vec<f64>,
    /// Largest relative deviation of a threshold.
    pub worst: f64,
    /// Statements met.
    pub met: usize,
    /// Unmet statements with their computed results, by their index among the targets.
    pub missed: Vec<String>,
}

/// The front, from the least worst threshold to the most statements met.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Front {
    /// The unknowns.
    pub parameters: Vec<Parameter>,
    /// Number of statements.
    pub statements: usize,
    /// Sets of constants checked.
    pub checked: usize,
    /// Its members.
    pub members: Vec<FrontMember>,
}

struct Candidate {
    x: Vec<f64>,
    met: usize,
    check: ConstraintCheck,
}

/// The best candidates so far for each number of statements met.
struct Best(Vec<Vec<Candidate>>);

impl Best {
    fn add(&mut self, candidate: Candidate) {
        let kept = &mut self.0[candidate.met];
        let place = kept.partition_point(|other| other.check.worst <= candidate.check.worst);
        kept.insert(place, candidate);
        kept.truncate(KEPT);
    }

    /// The candidates that no other one beats in both, from few statements to many.
    fn front(&self) -> Vec<&Candidate> {
        let mut out: Vec<&Candidate> = Vec::new();
        for best in self.0.iter().rev().filter_map(|kept| kept.first()) {
            if out.last().is_none_or(|last| best.check.worst < last.check.worst) {
                out.push(best);
            }
        }
        out.reverse();
        out
    }

    /// The candidates to start from: the front, and what was nearly as good.
    fn parents(&self) -> Vec<&Candidate> {
        let numbers: Vec<usize> = self.front().iter().map(|candidate| candidate.met).collect();
        numbers.iter().flat_map(|met| &self.0[*met]).collect()
    }
}

/// The next candidate, from the parents.
fn next(parents: &[&Candidate], seed: u64, index: u64) -> Vec<f64> {
    let mut random = Mt64::new(seed_of(b"front", seed, index));
    let mut parent = || {
        let place = (uniform(&mut random) * parents.len() as f64) as usize;
        &parents[place.min(parents.len() - 1)].x
    };
    let (one, other) = (parent(), parent());
    let share = if uniform(&mut random) < MIXED { uniform(&mut random) } else { 0.0 };
    let step = STEPS[0] * (STEPS[1] / STEPS[0]).powf(uniform(&mut random));
    one.iter().zip(other).map(|(a, b)| a + share * (b - a) + step * normal(&mut random)).collect()
}

/// Finds the front among as many sets of constants as the search checks.
///
/// # Errors
/// [`EnsembleError::Workers`], [`EnsembleError::Interrupted`]; [`EnsembleError::NoneAdmissible`] if no set has all thresholds.
pub fn front(search: &ConstantsSearch<'_>) -> Result<Front, EnsembleError> {
    let ConstantsSearch { targets, cell, numerics, count, seed, threads, .. } = *search;
    let (start, statements, pool) = (targets.starts(cell), targets.statements(), scheduler::pool(threads)?);
    let candidate = |(x, check): (Vec<f64>, ConstraintCheck)| {
        let met = match check.worst <= WORST {
            true => statements.saturating_sub(check.excluded.len() + check.off.len()),
            false => 0,
        };
        Candidate { x, met, check }
    };
    let mut best = Best((0..=statements).map(|_| Vec::new()).collect());
    let mut generation = vec![vec![0.0; start.len()]];
    // The best fit to the thresholds alone is the other end of the front.
    if let Ok(fit) = calibrate(targets, cell, numerics) {
        generation.push(fit.moves_from(&start));
    }
    let mut checked = 0;
    while checked < count {
        generation.truncate(count - checked);
        let many = generation.len();
        let found = search.check_all(&pool, checked, &generation, Extent::Within(WORST), count)?;
        let whole = |found: &(_, ConstraintCheck)| found.1.thresholds.len() == targets.thresholds.len();
        found.into_iter().filter(whole).map(candidate).for_each(|candidate| best.add(candidate));
        checked += many;
        let parents = best.parents();
        if parents.is_empty() {
            return Err(EnsembleError::NoneAdmissible { draws: checked, by: "thresholds".to_owned() });
        }
        generation = (0..GENERATION as u64).map(|k| next(&parents, seed, checked as u64 + k)).collect();
    }
    let member = |candidate: &Candidate| FrontMember {
        values: search.values(&candidate.x).into_iter().map(|(_, value)| value).collect(),
        thresholds: candidate.check.thresholds.clone(),
        worst: candidate.check.worst,
        met: candidate.met,
        missed: candidate.check.excluded.iter().chain(&candidate.check.off).map(Exclusion::to_string).collect(),
    };
    let members = best.front().into_iter().map(member).collect();
    Ok(Front { parameters: search.parameters(), statements, checked, members })
}
