//! The seeded noise of the first step.

use rand_mt::Mt;

/// Coefficients r_1 … r_10 of the noise 1 + Σ r_n cos(nπu), uniform on [−amplitude, amplitude]: the first ten doubles (53 bits) of
/// MT19937 seeded with the low 32 bits of the seed.
pub fn coefficients(seed: u64, amplitude: f64) -> [f64; 10] {
    let mut generator = Mt::new(seed as u32);
    std::array::from_fn(|_| {
        let (high, low) = (generator.next_u32() >> 5, generator.next_u32() >> 6);
        let uniform = (f64::from(high) * 67_108_864.0 + f64::from(low)) / 9_007_199_254_740_992.0;
        amplitude * (2.0 * uniform - 1.0)
    })
}
