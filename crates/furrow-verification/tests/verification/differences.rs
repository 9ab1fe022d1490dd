//! The right-hand sides of the equations at one point, and their differences.

use furrow_bvp::{BoundaryValueProblem, CollocationPoint, PointJacobian};
use furrow_mechanics::cortex::Cortex;

/// One point of a random moving cell.
pub const AT: CollocationPoint = CollocationPoint { x: 0.41, index: 0 };

/// Right-hand sides and integrand at a state, in one vector, for scalars that the cortex is prepared for.
pub fn values(cortex: &Cortex, y: &[f64], p: &[f64]) -> Vec<f64> {
    let (mut f, mut g) = (vec![0.0; y.len()], vec![0.0]);
    cortex.rhs(AT, y, p, &mut f, &mut g);
    f.extend(g);
    f
}

/// Derivatives of [`values`] by component k, or by scalar k − n for k ≥ n, as differences of fourth order.
pub fn difference_column(cortex: &mut Cortex, y: &[f64], p: &[f64], k: usize, step: f64) -> Vec<f64> {
    let mut at = |steps: f64| {
        let (mut y, mut p) = (y.to_vec(), p.to_vec());
        match k.checked_sub(y.len()) {
            None => y[k] += steps * step,
            Some(k) => p[k] += steps * step,
        }
        cortex.prepare(&p);
        values(cortex, &y, &p)
    };
    // Close values are subtracted first, since large ones would round.
    let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(&mut at);
    (0..a.len()).map(|i| (8.0 * (c[i] - b[i]) - (d[i] - a[i])) / (12.0 * step)).collect()
}

/// The largest distance of a derivative from its difference, over 1 + |derivative|.
pub fn largest_error(cortex: &mut Cortex, y: &[f64], p: &[f64], step: f64) -> f64 {
    let n = y.len();
    let mut room = [n, n * n, n * p.len(), 1, n, p.len()].map(|size| vec![0.0; size]);
    let [f, fy, fp, g, gy, gp] = room.each_mut().map(|values| &mut values[..]);
    cortex.prepare(p);
    cortex.rhs_jacobian(AT, y, p, &mut PointJacobian { f, fy, fp, g, gy, gp });
    let mut largest = 0.0f64;
    for k in 0..n + p.len() {
        let exact: Vec<f64> = match k.checked_sub(n) {
            None => (0..n).map(|i| room[1][i * n + k]).chain([room[4][k]]).collect(),
            Some(j) => (0..n).map(|i| room[2][i * p.len() + j]).chain([room[5][j]]).collect(),
        };
        for (exact, slope) in exact.into_iter().zip(difference_column(cortex, y, p, k, step)) {
            largest = largest.max((slope - exact).abs() / (1.0 + exact.abs()));
        }
    }
    largest
}
