//! Orders of convergence of Gauss collocation.
//!
//! # References
//! de Boor & Swartz, "Collocation at Gaussian points", SIAM J. Numer. Anal. 10, 582–606 (1973); Ascher, Mattheij &
//! Russell 1995, ch. 5: with m Gauss points the error is O(h^2m) at the nodes and, for a system of first order,
//! O(h^(m+1)) between them, where the polynomial of degree m misses ∫ Π(θ − c_j) y^(m+1) h^(m+1)/m!.

use super::problems::{Growth, quadratic, solve_fully, solved};
use crate::gauss::MAX_STAGES;
use crate::{Gauss, Solution, mesh};

/// An uneven mesh on [0, 1], denser towards 0 where 4/(1 + x)² is steep, of 2, 4, 8 … intervals.
pub fn uneven(intervals: usize) -> Vec<f64> {
    let mut mesh = vec![0.0, 0.4, 1.0];
    while mesh.len() <= intervals {
        mesh = mesh::halved(&mesh);
    }
    mesh
}

fn exact(x: f64) -> [f64; 2] {
    [4.0 / ((1.0 + x) * (1.0 + x)), -8.0 / ((1.0 + x) * (1.0 + x) * (1.0 + x))]
}

/// Largest error of (y, y′) at the nodes and anywhere.
fn errors(gauss: &Gauss, y: &Solution) -> [f64; 2] {
    let off = |x: f64, v: &[f64]| exact(x).iter().zip(v).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let nodes = (0..y.mesh.len()).map(|i| off(y.mesh[i], y.node(i))).fold(0.0, f64::max);
    let mut between: f64 = 0.0;
    for i in 0..y.intervals() {
        for k in 0..=20 {
            let (theta, mut v) = (k as f64 / 20.0, [0.0; 2]);
            y.eval_in(gauss, i, theta, &mut v);
            between = between.max(off(y.mesh[i] + theta * (y.mesh[i + 1] - y.mesh[i]), &v));
        }
    }
    [nodes, between]
}

/// Intervals of the coarser of two meshes on which superconvergence with m stages is looked at: fine enough for the
/// order to show, coarse enough for the error to stay above rounding.
const COARSE: [usize; MAX_STAGES] = [32, 16, 8, 4, 4];

/// Half the distance between neighbouring orders.
const HALF: f64 = 0.5;

/// Order of one of the [`errors`] from one mesh to the mesh with halved intervals.
fn order_seen(m: usize, intervals: usize, which: usize) -> f64 {
    let error = |y: Solution| errors(&Gauss::new(m).unwrap(), &y)[which];
    let [coarse, fine] = [1, 2].map(|k| error(solved(&mut quadratic(), m, &uneven(k * intervals))));
    (coarse / fine).log2()
}

#[test]
fn order_2m_at_the_nodes() {
    for m in 1..=MAX_STAGES {
        let order = order_seen(m, COARSE[m - 1], 0);
        assert!((order - 2.0 * m as f64).abs() < HALF, "m={m}: {order}");
    }
}

#[test]
fn order_m_plus_1_between_the_nodes() {
    for m in 1..=MAX_STAGES {
        let order = order_seen(m, 16, 1);
        assert!((order - (m as f64 + 1.0)).abs() < HALF, "m={m}: {order}");
    }
}

/// Error of the scalar unknown of [`Growth`].
fn scalar_error(m: usize, intervals: usize) -> f64 {
    let gauss = Gauss::new(m).unwrap();
    let mut y = Solution::from_fn(&gauss, &uneven(intervals), 1, &[0.3], |_, v| v.fill(1.0)).unwrap();
    solve_fully(&mut Growth, &mut y);
    (y.scalars[0] - 0.5).abs()
}

#[test]
fn scalars_found_by_an_integral_have_order_2m() {
    // Gauss quadrature of the stages has the order of the nodes, thus the scalar too.
    for m in 1..=4 {
        let (coarse, fine) = (scalar_error(m, COARSE[m - 1]), scalar_error(m, 2 * COARSE[m - 1]));
        let order = (coarse / fine).log2();
        assert!((order - 2.0 * m as f64).abs() < HALF, "m={m}: {order} {coarse:.1e} {fine:.1e}");
    }
}
