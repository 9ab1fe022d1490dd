//! Samples of a posterior over the unit cube, by sequential Monte Carlo.
//!
//! Particles start evenly spread over the cube, which is the prior, and are led to the posterior through tempered densities
//!
//! * \[F.13 tempered\] p_β(x) ∝ L(x)^β, β from 0 to 1,
//!
//! with the steps of β chosen such that the weights L^Δβ keep half of the effective sample size. At each β the particles are drawn
//! again by their weights and moved by Metropolis steps with the covariance of the sample. L is only ever compared, so that jumps and
//! kinks do no harm, and several maxima keep their shares. The product of the mean weights estimates ∫ L dx, the evidence.
//!
//! Every particle has random numbers of its own at every β, from the seed and its number: the sample does not depend on threads.
//!
//! # References
//! Del Moral, Doucet & Jasra, "Sequential Monte Carlo samplers", J. R. Statist. Soc. B 68 (2006) 411; Jasra, Stephens, Doucet &
//! Tsagaris, Scand. J. Statist. 38 (2011) 1, for adaptive steps.

use nalgebra::{DMatrix, DVector};
use rand_mt::Mt64;

use crate::ensemble::{mean_and_covariance, normal, relative_weights, uniform};
use crate::sample::{halton, seed_of};
use furrow_lineage::batch::scheduler;

/// The share of the effective sample size that a step of β keeps.
const KEPT: f64 = 0.5;
/// Halvings that find such a step.
const HALVINGS: usize = 60;
/// Metropolis steps at each β: at least, and at most. They end once a particle has moved so often in the mean.
const STEPS: [usize; 2] = [3, 12];
const MOVED: f64 = 3.0;
/// The length of a step in standard deviations, for one dimension: 2.38 is best for normal densities.
const LENGTH: f64 = 2.38;
/// The steps become longer or shorter by this factor where more or fewer than these shares of them are accepted.
const FACTOR: f64 = 1.5;
const ACCEPTED: [f64; 2] = [0.15, 0.4];
/// Variance added to the sample's, in the unit cube.
const FLOOR: f64 = 1e-12;

/// How many particles, and their seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampling {
    /// Particles.
    pub particles: usize,
    /// Seed of the sample.
    pub seed: u64,
}

/// A point of the sample.
#[derive(Clone, Debug, PartialEq)]
pub struct Particle<T> {
    /// Its place in the unit cube.
    pub place: Vec<f64>,
    /// ln L there.
    pub log_likelihood: f64,
    /// What else was computed there.
    pub computed: T,
}

/// A sample of the posterior; all particles weigh the same.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample<T> {
    /// The particles.
    pub particles: Vec<Particle<T>>,
    /// ln ∫ L dx over the cube.
    pub log_evidence: f64,
    /// How often β was raised.
    pub stages: usize,
    /// How often L was computed.
    pub evaluations: usize,
    /// The share of the last Metropolis steps that was accepted; 1 in no dimension.
    pub accepted: f64,
}

/// ln L at a place, and anything else to keep; `None` stops the sampling.
pub type Likelihood<'a, T> = &'a (dyn Fn(&[f64]) -> Option<(f64, T)> + Sync);

/// Draws a sample. `likelihood` gives ln L at a place, −∞ where it vanishes, with anything else to keep, or `None` to stop.
///
/// # Examples
/// ```
/// use furrow_analysis::tempering::{Sampling, sample};
///
/// // A normal likelihood with standard deviation 0.1 about 0.5.
/// let likelihood = |x: &[f64]| Some((-0.5 * ((x[0] - 0.5) / 0.1_f64).powi(2), ()));
/// let sampling = Sampling { particles: 400, seed: 1 };
/// let found = sample(1, sampling, &likelihood).unwrap();
/// let mean = found.particles.iter().map(|particle| particle.place[0]).sum::<f64>() / 400.0;
/// assert!((mean - 0.5).abs() < 0.02);
/// // ln(0.1 √2π)
/// assert!((found.log_evidence + 1.3836).abs() < 0.15);
/// ```
pub fn sample<T: Clone + Send + Sync>(
    dimensions: usize,
    Sampling { particles, seed }: Sampling,
    likelihood: Likelihood<'_, T>,
) -> Option<Sample<T>> {
    let particles = if dimensions == 0 { 1 } else { particles };
    let columns: Vec<Vec<f64>> = (0..dimensions).map(|axis| halton(axis, seed, particles)).collect();
    let start = |k: usize| {
        let place: Vec<f64> = columns.iter().map(|column| column[k]).collect();
        let (log_likelihood, computed) = likelihood(&place)?;
        Some(Particle { place, log_likelihood: finite(log_likelihood), computed })
    };
    let particles = scheduler::in_parallel(particles, start).into_iter().collect::<Option<Vec<_>>>()?;
    let evaluations = particles.len();
    let mut found = Sample { particles, log_evidence: 0.0, stages: 0, evaluations, accepted: 1.0 };
    let (mut beta, mut length) = (0.0, 1.0);
    while beta < 1.0 {
        let step = found.step(1.0 - beta);
        found.log_evidence += found.raise(step, seed);
        if !found.log_evidence.is_finite() {
            return Some(found);
        }
        beta = if step >= 1.0 - beta { 1.0 } else { beta + step };
        found.stages += 1;
        if dimensions > 0 {
            found.moved(beta, &mut length, seed, likelihood)?;
        }
    }
    Some(found)
}

/// NaN counts as ln 0.
fn finite(log: f64) -> f64 {
    if log.is_nan() { f64::NEG_INFINITY } else { log }
}

impl<T: Clone + Send + Sync> Sample<T> {
    fn logs(&self) -> impl Iterator<Item = f64> + Clone + '_ {
        self.particles.iter().map(|particle| particle.log_likelihood)
    }

    /// The step of β that keeps the share of the effective sample size, at most `most`.
    fn step(&self, most: f64) -> f64 {
        // Places where L vanishes leave the sample whatever the step.
        let possible = self.logs().filter(|log| *log > f64::NEG_INFINITY).count() as f64;
        let keeps = |step: f64| {
            let (weights, _) = relative_weights(self.logs(), step);
            let [sum, squares] = weights.iter().fold([0.0, 0.0], |[a, b], w| [a + w, b + w * w]);
            sum * sum / squares >= KEPT * possible
        };
        if possible == 0.0 || keeps(most) {
            return most;
        }
        let (mut low, mut high) = (0.0, most);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if keeps(middle) { low = middle } else { high = middle }
        }
        // At least a step that ends.
        high.max(f64::EPSILON)
    }

    /// Weighs the particles and draws them again by their weights; the logarithm of the mean weight.
    fn raise(&mut self, step: f64, seed: u64) -> f64 {
        let (weights, largest) = relative_weights(self.logs(), step);
        let sum: f64 = weights.iter().sum();
        if sum == 0.0 {
            return f64::NEG_INFINITY;
        }
        let count = self.particles.len();
        let mut random = Mt64::new(seed_of(b"drawn again", seed, self.stages as u64));
        let shift = uniform(&mut random);
        let (mut k, mut above) = (0, weights[0]);
        let drawn = (0..count).map(|j| {
            let at = (j as f64 + shift) / count as f64 * sum;
            while above < at && k + 1 < count {
                k += 1;
                above += weights[k];
            }
            self.particles[k].clone()
        });
        self.particles = drawn.collect();
        largest + (sum / count as f64).ln()
    }

    /// Moves the particles at β; `length` follows the share of accepted steps.
    fn moved(&mut self, beta: f64, length: &mut f64, seed: u64, likelihood: Likelihood<'_, T>) -> Option<()> {
        let root = self.root();
        let count = self.particles.len();
        let mut moved = 0;
        for step in 0..STEPS[1] {
            let stage = (self.stages * STEPS[1] + step) as u64;
            let long = *length * LENGTH / (root.nrows() as f64).sqrt();
            let one = |k: usize| {
                let particle = &self.particles[k];
                let mut random = Mt64::new(seed_of(b"moved", seed, stage * count as u64 + k as u64));
                let normals = DVector::from_fn(root.nrows(), |_, _| normal(&mut random));
                let off = &root * normals * long;
                let place: Vec<f64> =
                    particle.place.iter().zip(off.iter()).map(|(x, off)| reflected(x + off)).collect();
                let (log_likelihood, computed) = likelihood(&place)?;
                let next = Particle { place, log_likelihood: finite(log_likelihood), computed };
                let gain = beta * (next.log_likelihood - particle.log_likelihood);
                let is_accepted = uniform(&mut random).ln() < gain;
                Some(is_accepted.then_some(next))
            };
            let next = scheduler::in_parallel(count, one).into_iter().collect::<Option<Vec<_>>>()?;
            let accepted = next.iter().flatten().count();
            for (particle, next) in self.particles.iter_mut().zip(next) {
                if let Some(next) = next {
                    *particle = next;
                }
            }
            self.evaluations += count;
            self.accepted = accepted as f64 / count as f64;
            moved += accepted;
            match self.accepted {
                share if share < ACCEPTED[0] => *length /= FACTOR,
                share if share > ACCEPTED[1] => *length *= FACTOR,
                _ => {}
            }
            if step + 1 >= STEPS[0] && moved as f64 >= MOVED * count as f64 {
                break;
            }
        }
        Some(())
    }

    /// A lower triangular root of the sample's covariance.
    fn root(&self) -> DMatrix<f64> {
        let dimensions = self.particles.first().map_or(0, |particle| particle.place.len());
        let share = (self.particles.len() as f64).recip();
        let places: Vec<DVector<f64>> =
            self.particles.iter().map(|particle| DVector::from_column_slice(&particle.place)).collect();
        let (_, covariance) = mean_and_covariance(dimensions, places.iter().map(|place| (place, share)), FLOOR);
        let spread = DMatrix::from_diagonal(&covariance.diagonal().map(f64::sqrt));
        covariance.cholesky().map_or(spread, |factors| factors.l())
    }
}

/// Reflects a number at the ends of the unit interval.
fn reflected(x: f64) -> f64 {
    let x = x.rem_euclid(2.0);
    if x > 1.0 { 2.0 - x } else { x }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    const SAMPLING: Sampling = Sampling { particles: 400, seed: 3 };

    fn mean_and_sd<T>(found: &Sample<T>, of: impl Fn(&[f64]) -> f64) -> [f64; 2] {
        let values: Vec<f64> = found.particles.iter().map(|particle| of(&particle.place)).collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        [mean, (values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt()]
    }

    /// A ridge 0.01 wide along the diagonal, 0.1 long: evidence 2π·0.01·0.1.
    #[test]
    fn a_ridge_is_sampled_along_its_length_at_any_number_of_threads() {
        let likelihood = |x: &[f64]| {
            let [along, across] = [x[0] + x[1] - 0.9, x[0] - x[1] + 0.1].map(|y| y / 2.0_f64.sqrt());
            Some((-0.5 * ((along / 0.1).powi(2) + (across / 0.01).powi(2)), ()))
        };
        let [found, again] = [1, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| sample(2, SAMPLING, &likelihood).unwrap())
        });
        assert_eq!(found, again);
        let [along, spread] = mean_and_sd(&found, |x| (x[0] + x[1]) / 2.0_f64.sqrt());
        assert!((along - 0.9 / 2.0_f64.sqrt()).abs() < 0.02 && (spread / 0.1 - 1.0).abs() < 0.2, "{along} {spread}");
        let [_, across] = mean_and_sd(&found, |x| (x[0] - x[1]) / 2.0_f64.sqrt());
        assert!((across / 0.01 - 1.0).abs() < 0.2, "{across}");
        assert!((found.log_evidence - (TAU * 0.001).ln()).abs() < 0.25, "{}", found.log_evidence);
    }

    /// Two peaks with a cliff between them: L is e² on [0.2, 0.3], e on [0.6, 0.9], and 0 elsewhere.
    #[test]
    fn peaks_beside_cliffs_keep_their_shares() {
        let likelihood = |x: &[f64]| {
            let log = match x[0] {
                x if (0.2..=0.3).contains(&x) => 2.0,
                x if (0.6..=0.9).contains(&x) => 1.0,
                _ => f64::NEG_INFINITY,
            };
            Some((log, ()))
        };
        let found = sample(1, Sampling { particles: 1000, seed: 5 }, &likelihood).unwrap();
        let [high, low] = [0.1 * 2f64.exp(), 0.3 * 1f64.exp()];
        let [share, _] = mean_and_sd(&found, |x| f64::from(u8::from(x[0] < 0.5)));
        assert!((share - high / (high + low)).abs() < 0.05, "{share}");
        assert!((found.log_evidence - (high + low).ln()).abs() < 0.05, "{}", found.log_evidence);
    }

    /// The rank of the true value among the sample is uniform (Talts et al. 2018), for a model with a kink and a jump; 90 % intervals
    /// hold the truth in 90 % of the cases.
    #[test]
    fn ranks_of_the_truth_are_uniform() {
        let model = |x: f64| if x < 0.4 { x } else { 0.7 + 0.2 * (x - 0.6).abs() };
        let sd = 0.08;
        let (mut bins, mut covered) = ([0usize; 10], 0);
        let sets = 200;
        for set in 0..sets {
            let mut random = Mt64::new(seed_of(b"truth", 7, set));
            let truth = uniform(&mut random);
            let data: Vec<f64> = (0..3).map(|_| model(truth) + sd * normal(&mut random)).collect();
            let likelihood =
                |x: &[f64]| Some((data.iter().map(|y| -0.5 * ((y - model(x[0])) / sd).powi(2)).sum::<f64>(), ()));
            let found = sample(1, Sampling { particles: 99, seed: set }, &likelihood).unwrap();
            let rank = found.particles.iter().filter(|particle| particle.place[0] < truth).count();
            bins[rank / 10] += 1;
            covered += usize::from((5..=94).contains(&rank));
        }
        let expected = sets as f64 / 10.0;
        let chi_squared: f64 = bins.iter().map(|n| (*n as f64 - expected).powi(2) / expected).sum();
        // χ² with 9 degrees of freedom exceeds 21.67 in 1 % of the cases.
        assert!(chi_squared < 21.67, "{chi_squared} {bins:?}");
        let share = covered as f64 / sets as f64;
        assert!((share - 0.9).abs() < 0.045, "{share}");
    }

    #[test]
    fn a_sample_without_numbers_or_without_likelihood_ends() {
        let found = sample(0, SAMPLING, &|_| Some((-2.5, "kept"))).unwrap();
        assert_eq!((found.log_evidence, found.particles.len(), found.particles[0].computed), (-2.5, 1, "kept"));
        assert_eq!(sample(1, SAMPLING, &|_| Some((f64::NAN, ()))).unwrap().log_evidence, f64::NEG_INFINITY);
        assert!(sample(1, SAMPLING, &|_| None::<(f64, ())>).is_none());
        assert_eq!([-0.2, 0.3, 1.4, 2.5].map(|x: f64| (reflected(x) * 10.0).round() / 10.0), [0.2, 0.3, 0.6, 0.5]);
    }
}
