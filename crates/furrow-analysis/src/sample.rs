//! Values that fill an interval, and several together a box, evenly at every count.
//!
//! # References
//! Halton, "On the efficiency of certain quasi-random sequences of points in evaluating multi-dimensional integrals",
//! Numer. Math. 2 (1960); the random shift follows Cranley & Patterson, SIAM J. Numer. Anal. 13 (1976).

/// The bases of the sequences, one for each axis: Halton's sequences in larger bases fill their boxes late.
const BASES: [u64; 12] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37];

/// Most axes that are sampled together.
pub const MOST_AXES: usize = BASES.len();

/// The first `count` values of Halton's sequence of an axis (from 0, below [`MOST_AXES`]), each in [0, 1), all of them shifted
/// by a number that the seed and the axis give. More values leave the earlier ones as they are.
///
/// ```
/// use furrow_analysis::sample::halton;
///
/// let few = halton(0, 7, 10);
/// assert_eq!(few[..], halton(0, 7, 100)[..10]);
/// assert_ne!(few, halton(0, 8, 10));
/// ```
pub fn halton(axis: usize, seed: u64, count: usize) -> Vec<f64> {
    let base = BASES[axis % MOST_AXES];
    let shift = shift(axis, seed);
    (1..=count as u64).map(|index| (radical_inverse(index, base) + shift).fract()).collect()
}

/// The digits of a number mirrored at the point. Whole numbers and one division, so that all machines agree to the last bit.
fn radical_inverse(mut index: u64, base: u64) -> f64 {
    let (mut mirrored, mut scale) = (0u64, 1u64);
    while index > 0 {
        mirrored = mirrored * base + index % base;
        scale *= base;
        index /= base;
    }
    mirrored as f64 / scale as f64
}

fn shift(axis: usize, seed: u64) -> f64 {
    // A number in [0, 1) holds 53 bits: the leading ones.
    (seed_of(b"sample", seed, axis as u64) >> 11) as f64 / (1u64 << 53) as f64
}

/// The seed of draw `index` for a purpose, from the seed of the whole. It depends neither on earlier draws nor on other
/// purposes.
pub(super) fn seed_of(purpose: &[u8], seed: u64, index: u64) -> u64 {
    let mut hasher = blake3::Hasher::new();
    hasher.update(purpose);
    hasher.update(&seed.to_le_bytes());
    hasher.update(&index.to_le_bytes());
    let mut bytes = [0; 8];
    bytes.copy_from_slice(&hasher.finalize().as_bytes()[..8]);
    u64::from_le_bytes(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_mirrored() {
        assert_eq!([1, 2, 3, 4, 5].map(|k| radical_inverse(k, 2)), [0.5, 0.25, 0.75, 0.125, 0.625]);
        assert_eq!([1, 2, 3].map(|k| radical_inverse(k, 3)), [1.0 / 3.0, 2.0 / 3.0, 1.0 / 9.0]);
    }

    /// Of n values of base b every one of b^k equal parts holds n/b^k, to one more or less for either of its neighbours that
    /// the shift moves over an edge.
    #[test]
    fn every_part_of_the_interval_has_its_share() {
        for (axis, parts) in [(0, 16), (1, 9), (2, 25)] {
            let mut counts = vec![0; parts];
            for value in halton(axis, 3, 900) {
                counts[(value * parts as f64) as usize] += 1;
            }
            let even = 900 / parts;
            assert!(counts.iter().all(|count: &usize| count.abs_diff(even) <= 4), "{counts:?}");
        }
    }
}
