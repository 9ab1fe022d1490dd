//! Tests of the kernels together: each is compared with a plain dense, analytic or theoretical counterpart.
//!
//! The tests share a random generator, test problems, the collocation equations written out plainly, and dense linear
//! algebra without blocks.

mod antisymmetric;
#[cfg(feature = "auto")]
mod auto;
#[path = "../../examples/problems/cash_mazzia.rs"]
mod cash_mazzia;
mod dense;
mod limits;
mod linear;
mod meshes;
mod newton;
mod operator;
mod order;
mod problems;
#[path = "../../examples/problems/second_order.rs"]
mod second_order;
mod sized;
mod solution;
mod solver;

/// SplitMix64: small, and the same numbers on every machine.
struct Random(u64);

impl Random {
    /// The next number in [−1, 1).
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn vector(&mut self, len: usize) -> Vec<f64> {
        (0..len).map(|_| self.next()).collect()
    }

    /// An index below `end`.
    fn index(&mut self, end: usize) -> usize {
        ((0.5 + 0.5 * self.next()) * end as f64) as usize
    }

    /// A mesh from −0.3 of the given number of intervals, the widest up to three times as wide as the narrowest.
    fn mesh(&mut self, intervals: usize) -> Vec<f64> {
        let mut mesh = vec![-0.3];
        for i in 0..intervals {
            mesh.push(mesh[i] + (1.0 + 0.5 * self.next()) / intervals as f64);
        }
        mesh
    }
}

/// Largest absolute value.
fn largest(v: &[f64]) -> f64 {
    v.iter().fold(0.0, |l: f64, x| if x.is_nan() { f64::NAN } else { l.max(x.abs()) })
}

/// Largest absolute difference.
fn distance(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    largest(&a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<_>>())
}
