//! The seeded noise on the activity.

use furrow_bvp::{Gauss, Solution};
use rand_mt::Mt;

use crate::cortex::equations::noise_factor;
use furrow_cell::{Numerics, Scheme};

/// The factor 1 + Σ r_n cos(nπu) on ξ_s and ξ_b, n = 1 … 10.
///
/// The coefficients r_n are uniform on [−amplitude, amplitude]: doubles (53 bits) of MT19937, seeded with the seed if
/// it has 32 bits and with its two halves otherwise. The first ten act in the first step. Sustained noise draws ten
/// more every `noise_time` and changes smoothly from one set to the next, so that it depends on time alone, not on the
/// steps.
#[derive(Clone, Debug)]
pub struct Noise {
    amplitude: f64,
    /// Time between two sets of coefficients, in τ; `None` if only the first step is noisy.
    time: Option<f64>,
    generator: Mt,
    /// The sets drawn so far, the first at t = 0.
    knots: Vec<[f64; 10]>,
}

/// MT19937 for a seed: its reference code takes 32 bits, or an array of such numbers, here the lower and the upper
/// half.
fn generator(seed: u64) -> Mt {
    match u32::try_from(seed) {
        Ok(seed) => Mt::new(seed),
        Err(_) => Mt::new_with_key([seed as u32, (seed >> 32) as u32]),
    }
}

impl Noise {
    /// The noise of a seed.
    pub fn new(seed: u64, numerics: &Numerics) -> Noise {
        let time = Some(numerics.noise_time).filter(|time| *time > 0.0 && numerics.noise != 0.0);
        Noise { amplitude: numerics.noise, time, generator: generator(seed), knots: Vec::new() }
    }

    /// The time between two sets of coefficients, if the noise is sustained.
    pub(crate) fn sustained(&self) -> Option<f64> {
        self.time
    }

    /// The length of the first step: the paper's noise lasts for one of its time steps.
    pub fn first_step(numerics: &Numerics) -> f64 {
        match numerics.scheme {
            Scheme::Converged => numerics.first_step,
            Scheme::Published => numerics.dt,
        }
    }

    /// The factors at the collocation points of a shape at time t.
    pub fn factors(&mut self, t: f64, y: &Solution, gauss: &Gauss) -> Vec<f64> {
        let coefficients = self.coefficients(t);
        (0..y.intervals() * y.m).map(|i| noise_factor(&coefficients, y.stage_x(gauss, i / y.m, i % y.m))).collect()
    }

    /// The coefficients r_1 … r_10 at time t.
    pub fn coefficients(&mut self, t: f64) -> [f64; 10] {
        let Some(time) = self.time else { return self.set(0) };
        let (k, share) = ((t / time).floor(), (t / time).fract());
        let (before, after) = (self.set(k as usize), self.set(k as usize + 1));
        let share = share * share * (3.0 - 2.0 * share);
        std::array::from_fn(|n| before[n] + share * (after[n] - before[n]))
    }

    /// The set `number` of coefficients: those of sustained noise at successive times, or, without axial symmetry, of successive
    /// azimuthal numbers.
    pub fn set(&mut self, number: usize) -> [f64; 10] {
        while self.knots.len() <= number {
            let generator = &mut self.generator;
            self.knots.push(std::array::from_fn(|_| {
                let (high, low) = (generator.next_u32() >> 5, generator.next_u32() >> 6);
                let uniform = (f64::from(high) * 67_108_864.0 + f64::from(low)) / 9_007_199_254_740_992.0;
                self.amplitude * (2.0 * uniform - 1.0)
            }));
        }
        self.knots[number]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_seed_has_its_own_noise() {
        let numerics = Numerics::default();
        let drawn = |seed: u64| Noise::new(seed, &numerics).coefficients(0.0);
        let seeds = [0, 1, u64::from(u32::MAX), 1 << 32, (1 << 32) + 1, 1 << 33, u64::MAX];
        for (k, seed) in seeds.iter().enumerate() {
            assert!(seeds[..k].iter().all(|other| drawn(*other) != drawn(*seed)), "{seed}");
        }
        // Seeds of 32 bits keep their random numbers: the first double of MT19937 with the seed 0.
        let first = numerics.noise * (2.0 * 0.548_813_503_927_324_8 - 1.0);
        assert!((drawn(0)[0] / first - 1.0).abs() < 1e-12, "{} {first}", drawn(0)[0]);
    }
}
