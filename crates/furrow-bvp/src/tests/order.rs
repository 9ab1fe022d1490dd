//! Orders of convergence of Gauss collocation.
//!
//! # References
//! de Boor & Swartz, "Collocation at Gaussian points", SIAM J. Numer. Anal. 10, 582–606 (1973); Ascher, Mattheij &
//! Russell 1995, ch. 5: with m Gauss points the error is O(h^2m) at the nodes and, for a system of first order,
//! O(h^(m+1)) between them, where the polynomial of degree m misses ∫ Π(θ − c_j) y^(m+1) h^(m+1)/m!.

use super::problems::{Growth, quadratic, solve_fully, solved};
use crate::gauss::MAX_STAGES;
use crate::{
    BoundaryJacobian, BoundaryValueProblem, CollocationPoint, Dimensions, Gauss, PointJacobian, Settings, Solution,
    mesh, solve,
};

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

fn off(x: f64, found: &[f64]) -> f64 {
    exact(x).iter().zip(found).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Largest error of (y, y′) at the nodes and anywhere.
fn errors(gauss: &Gauss, y: &Solution) -> [f64; 2] {
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

/// Largest errors of a result between its nodes, of values and of y″ by the slope of y′.
fn errors_of_result(m: usize, intervals: usize) -> [f64; 2] {
    let gauss = Gauss::new(m).unwrap();
    let on_mesh = solved(&mut quadratic(), m, &uneven(intervals));
    // So that this mesh is neither refined nor found wasteful.
    let tolerance = 1.01 * mesh::defect(&gauss, &mut quadratic(), &on_mesh).into_iter().fold(0.0, f64::max);
    let result = solve(&mut quadratic(), &on_mesh, &Settings { tolerance, ..Settings::default() }).unwrap();
    assert_eq!(result.solution.mesh, on_mesh.mesh);
    let (mut values, mut slopes): (f64, f64) = (0.0, 0.0);
    for k in 0..=200 {
        let (x, mut v) = (k as f64 / 200.0, [0.0; 2]);
        result.eval(&gauss, x, &mut v);
        values = values.max(off(x, &v));
        result.slope(&gauss, x, &mut v);
        slopes = slopes.max((v[1] - 24.0 / (1.0 + x).powi(4)).abs());
    }
    [values, slopes]
}

#[test]
fn order_m_plus_2_between_the_nodes_of_a_result() {
    // With two stages or more: one is of second order at the nodes.
    for m in 2..=MAX_STAGES {
        let (coarse, fine) = (errors_of_result(m, 16), errors_of_result(m, 32));
        let orders = [0, 1].map(|which| (coarse[which] / fine[which]).log2());
        let expected = [m as f64 + 2.0, m as f64 + 1.0];
        assert!(orders.iter().zip(expected).all(|(order, at)| (order - at).abs() < HALF), "m={m}: {orders:?}");
    }
}

/// y′ = 1 from some place on and 0 before, and NaN where x is 0.
struct Jump {
    from: f64,
    to: f64,
}

impl BoundaryValueProblem for Jump {
    fn dimensions(&self) -> Dimensions {
        Dimensions { components: 1, left: 1, ..Dimensions::default() }
    }

    fn rhs(&self, at: CollocationPoint, _: &[f64], _: &[f64], f: &mut [f64], _: &mut [f64]) {
        f[0] = if at.x == 0.0 { f64::NAN } else { f64::from((self.from..self.to).contains(&at.x)) };
    }

    fn rhs_jacobian(&self, at: CollocationPoint, y: &[f64], p: &[f64], out: &mut PointJacobian<'_>) {
        self.rhs(at, y, p, out.f, out.g);
    }

    fn left(&self, y: &[f64], _: &[f64], out: &mut BoundaryJacobian<'_>) {
        (out.r[0], out.ry[0]) = (y[0], 1.0);
    }

    fn right(&self, _: &[f64], _: &[f64], _: &mut BoundaryJacobian<'_>) {}
}

/// Largest error of the solution of a jump from a guess on equal intervals.
fn error_of_jump(mut problem: Jump, intervals: usize, tolerance: f64) -> f64 {
    let gauss = Gauss::default();
    let guess = Solution::constant(gauss.m, &mesh::uniform(0.0, 1.0, intervals), &[0.3], &[]);
    let result = solve(&mut problem, &guess, &Settings { tolerance, ..Settings::default() }).unwrap();
    let error = |k: usize| {
        let (x, mut value) = (k as f64 / 200.0, [0.0]);
        result.eval(&gauss, x, &mut value);
        (value[0] - (x.min(problem.to) - problem.from).max(0.0)).abs()
    };
    (0..=200).map(error).fold(0.0, f64::max)
}

#[test]
fn jumps_anywhere_in_an_interval_are_found() {
    for k in 1..200 {
        let from = k as f64 / 200.0 + 3e-4;
        for tolerance in [1e-6, 1e-9] {
            let error = error_of_jump(Jump { from, to: 2.0 }, 4, tolerance);
            assert!(error < 10.0 * tolerance, "{from} at {tolerance}: {error:e}");
        }
    }
    // At nodes of the guess.
    assert!([0.25, 0.5].into_iter().all(|from| error_of_jump(Jump { from, to: 2.0 }, 4, 1e-6) < 1e-12));
}

#[test]
fn a_pulse_that_the_mesh_of_the_guess_sees_is_kept() {
    for from in [0.31, 0.4303, 0.77] {
        let error = error_of_jump(Jump { from, to: from + 0.004 }, 400, 1e-6);
        assert!(error < 1e-5, "{from}: {error:e}");
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
