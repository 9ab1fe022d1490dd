//! Gauss–Legendre collocation on one interval.
//!
//! On an interval of length h the collocation polynomial takes the node value y₀ at θ = 0 and the stage values Y_j at
//! the Gauss points θ = c_j. With A the Runge–Kutta matrix and D = A⁻¹ it satisfies
//!
//! * \[N.1 stages\] Σ_k D_jk (Y_k − y₀) = h f(Y_j),
//! * \[N.2 node\]   y₁ = y₀ + Σ_j d_j (Y_j − y₀), d = bᵀD.
//!
//! Writing the unknowns as stage *values* keeps f on the diagonal of the first equation.
//!
//! # References
//! Ascher, Mattheij & Russell, *Numerical Solution of Boundary Value Problems for Ordinary Differential Equations*,
//! SIAM 1995, ch. 5. Hairer & Wanner, *Solving Ordinary Differential Equations II*, Springer 1996, ch. IV.

use crate::dimensions::TooLarge;
use crate::invalid::InvalidInput;

pub use crate::dimensions::MAX_STAGES;

/// Coefficients of m-stage Gauss collocation (order 2m at the nodes).
#[derive(Clone, Debug, PartialEq)]
pub struct Gauss {
    /// Number of stages m.
    pub m: usize,
    /// Gauss points in (0, 1), ascending; length m.
    pub c: Vec<f64>,
    /// Quadrature weights; length m.
    pub b: Vec<f64>,
    /// Runge–Kutta matrix, m × m row-major: a_jk = ∫₀^{c_j} ℓ_k.
    pub a: Vec<f64>,
    /// D = A⁻¹, m × m row-major.
    pub d_matrix: Vec<f64>,
    /// d = bᵀD; length m.
    pub d: Vec<f64>,
    /// {0, c_1 … c_m, 1}.
    points: Vec<f64>,
    /// Barycentric weights of the points {0, c_1 … c_m}; length m + 1.
    barycentric: Vec<f64>,
    /// Barycentric weights of the points {0, c_1 … c_m, 1}; length m + 2.
    barycentric_between_nodes: Vec<f64>,
}

/// The Legendre polynomial P_k at x by the two before it.
fn next_legendre(k: usize, x: f64, [before, last]: [f64; 2]) -> f64 {
    let k = k as f64;
    ((2.0 * k - 1.0) * x * last - (k - 1.0) * before) / k
}

/// Value and derivative of the Legendre polynomial P_m at x.
fn legendre(m: usize, x: f64) -> (f64, f64) {
    let (mut p0, mut p1) = (1.0, x);
    for k in 2..=m {
        (p0, p1) = (p1, next_legendre(k, x, [p0, p1]));
    }
    let mf = m as f64;
    (p1, mf * (x * p1 - p0) / (x * x - 1.0))
}

/// Nodes and weights of the m-point Gauss–Legendre rule on [0, 1].
pub fn gauss_rule(m: usize) -> (Vec<f64>, Vec<f64>) {
    let mut c = vec![0.5; m];
    let mut b = vec![1.0; m];
    if m == 1 {
        return (c, b);
    }
    for j in 0..m.div_ceil(2) {
        let mut x = -(std::f64::consts::PI * (j as f64 + 0.75) / (m as f64 + 0.5)).cos();
        for _ in 0..100 {
            let (p, dp) = legendre(m, x);
            let step = p / dp;
            x -= step;
            if step.abs() < 1e-16 {
                break;
            }
        }
        if 2 * j + 1 == m {
            x = 0.0;
        }
        let (_, dp) = legendre(m, x);
        let weight = 1.0 / ((1.0 - x * x) * dp * dp);
        c[j] = 0.5 * (1.0 + x);
        c[m - 1 - j] = 0.5 * (1.0 - x);
        b[j] = weight;
        b[m - 1 - j] = weight;
    }
    (c, b)
}

/// Π_k≠i 1 / (x_i − x_k) of every point.
fn barycentric_weights(points: &[f64]) -> Vec<f64> {
    let product = |i: usize| (0..points.len()).filter(|&k| k != i).map(|k| points[i] - points[k]).product::<f64>();
    (0..points.len()).map(|i| 1.0 / product(i)).collect()
}

/// Values at θ of the Lagrange basis on the first of `points`, one for each of the barycentric `weights`.
fn lagrange_basis(points: &[f64], weights: &[f64], theta: f64, out: &mut [f64]) {
    #[inline(always)]
    fn any(points: &[f64], weights: &[f64], theta: f64, out: &mut [f64]) {
        if let Some(i) = points.iter().position(|point| *point == theta) {
            out.fill(0.0);
            out[i] = 1.0;
            return;
        }
        for ((o, weight), point) in out.iter_mut().zip(weights).zip(points) {
            *o = weight / (theta - point);
        }
        let sum: f64 = out.iter().sum();
        out.iter_mut().for_each(|o| *o /= sum);
    }
    let (points, out) = (&points[..weights.len()], &mut out[..weights.len()]);
    // Loops of known length are unrolled: four stages with both nodes.
    match (points.first_chunk::<6>(), <&[f64; 6]>::try_from(weights).ok(), out.first_chunk_mut::<6>()) {
        (Some(points), Some(weights), Some(out)) => any(points, weights, theta, out),
        _ => any(points, weights, theta, out),
    }
}

impl Default for Gauss {
    /// Four stages: order 8.
    fn default() -> Gauss {
        Gauss::nearest(4)
    }
}

impl Gauss {
    /// The m-stage method, 1 ≤ m ≤ [`MAX_STAGES`].
    ///
    /// # Errors
    /// [`TooLarge::Stages`] for any other m.
    pub fn new(m: usize) -> Result<Gauss, InvalidInput> {
        if (1..=MAX_STAGES).contains(&m) { Ok(Gauss::nearest(m)) } else { Err(TooLarge::Stages { stages: m }.into()) }
    }

    /// The method of m stages, or of the nearest number that is offered.
    pub(crate) fn nearest(m: usize) -> Gauss {
        let m = m.clamp(1, MAX_STAGES);
        let (c, b) = gauss_rule(m);
        // a_jk by integrating the Lagrange polynomial ℓ_k (degree m − 1) exactly with the same rule on [0, c_j].
        let lagrange = |k: usize, x: f64| -> f64 {
            (0..m).filter(|&i| i != k).map(|i| (x - c[i]) / (c[k] - c[i])).product::<f64>()
        };
        let mut a = vec![0.0; m * m];
        for j in 0..m {
            for k in 0..m {
                a[j * m + k] = (0..m).map(|i| c[j] * b[i] * lagrange(k, c[j] * c[i])).sum();
            }
        }
        let d_matrix = inverse(m, &a);
        let d = (0..m).map(|k| (0..m).map(|j| b[j] * d_matrix[j * m + k]).sum()).collect();
        let mut points = vec![0.0];
        points.extend(&c);
        let barycentric = barycentric_weights(&points);
        points.push(1.0);
        let barycentric_between_nodes = barycentric_weights(&points);
        Gauss { m, c, b, a, d_matrix, d, points, barycentric, barycentric_between_nodes }
    }

    /// Values at θ of the Lagrange basis on {0, c_1 … c_m}; the first entry multiplies the node value. `out` has length
    /// m + 1.
    pub fn basis(&self, theta: f64, out: &mut [f64]) {
        lagrange_basis(&self.points, &self.barycentric, theta, out);
    }

    /// Values at θ of the Lagrange basis on {0, c_1 … c_m, 1}, between both nodes of an interval. `out` has length m + 2.
    ///
    /// The collocation polynomial of a solution goes through its right node by itself. Where values only approximate one,
    /// as after a change of the mesh, this basis treats the two ends alike and [`basis`](Self::basis) does not.
    pub fn basis_between_nodes(&self, theta: f64, out: &mut [f64]) {
        lagrange_basis(&self.points, &self.barycentric_between_nodes, theta, out);
    }

    /// Derivatives with respect to θ of the same basis. `out` has length m + 1.
    pub fn basis_derivative(&self, theta: f64, out: &mut [f64]) {
        let m = self.m;
        let mut differences = [0.0; MAX_STAGES + 1];
        for (difference, point) in differences.iter_mut().zip(&self.points) {
            *difference = theta - point;
        }
        for (i, o) in out.iter_mut().enumerate().take(m + 1) {
            let mut slope = 0.0;
            for k in (0..=m).filter(|&k| k != i) {
                let mut product = 1.0;
                for (l, difference) in differences[..=m].iter().enumerate() {
                    product *= if l == i || l == k { 1.0 } else { *difference };
                }
                slope += product;
            }
            *o = slope * self.barycentric[i];
        }
    }
}

/// The polynomials that correct a collocation polynomial between the nodes for its slopes there, see [`Gauss::corrections`].
pub(crate) struct Corrections {
    /// Values, those for the slope at the left node first.
    pub values: [f64; 2],
    /// Derivatives with respect to θ.
    pub slopes: [f64; 2],
}

impl Gauss {
    /// Two polynomials of degree m + 2 at θ. They vanish at both nodes. Their derivatives, (1 − θ)P_m(1 − 2θ) and θP_m(2θ − 1) of the
    /// Legendre polynomial P_m, vanish at the Gauss points and at one node, and are 1 at the other.
    pub(crate) fn corrections(&self, theta: f64) -> Corrections {
        let (m, x) = (self.m, 2.0 * theta - 1.0);
        let mut p = [1.0; MAX_STAGES + 3];
        p[1] = x;
        for k in 2..=m + 2 {
            p[k] = next_legendre(k, x, [p[k - 2], p[k - 1]]);
        }
        // ∫ P_k from −1 to x, and ∫ x P_m by (2m + 1)x P_m = (m + 1)P_{m+1} + m P_{m−1}.
        let integral = |k: usize| if k == 0 { x + 1.0 } else { (p[k + 1] - p[k - 1]) / (2.0 * k as f64 + 1.0) };
        let order = m as f64;
        let weighted = ((order + 1.0) * integral(m + 1) + order * integral(m - 1)) / (2.0 * order + 1.0);
        let sign = if m.is_multiple_of(2) { 1.0 } else { -1.0 };
        Corrections {
            values: [sign * 0.25 * (integral(m) - weighted), 0.25 * (integral(m) + weighted)],
            slopes: [sign * (1.0 - theta) * p[m], theta * p[m]],
        }
    }
}

/// Inverse of a small well-conditioned matrix (n ≤ 5) by Gauss–Jordan elimination with row pivoting.
fn inverse(n: usize, a: &[f64]) -> Vec<f64> {
    let mut left = a.to_vec();
    let mut right: Vec<f64> = (0..n * n).map(|i| if i / n == i % n { 1.0 } else { 0.0 }).collect();
    for k in 0..n {
        let pivot = (k..n).max_by(|&i, &j| left[i * n + k].abs().total_cmp(&left[j * n + k].abs())).unwrap_or(k);
        for j in 0..n {
            left.swap(k * n + j, pivot * n + j);
            right.swap(k * n + j, pivot * n + j);
        }
        let scale = 1.0 / left[k * n + k];
        for j in 0..n {
            left[k * n + j] *= scale;
            right[k * n + j] *= scale;
        }
        for i in (0..n).filter(|&i| i != k) {
            let f = left[i * n + k];
            for j in 0..n {
                left[i * n + j] -= f * left[k * n + j];
                right[i * n + j] -= f * right[k * n + j];
            }
        }
    }
    right
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integrates_polynomials_to_degree_2m_minus_1() {
        for m in 1..=MAX_STAGES {
            let g = Gauss::nearest(m);
            for degree in 0..2 * m {
                let q: f64 = g.c.iter().zip(&g.b).map(|(c, b)| b * c.powi(degree as i32)).sum();
                assert!((q - 1.0 / (degree as f64 + 1.0)).abs() < 1e-15, "m={m} degree={degree}: {q}");
            }
        }
    }

    #[test]
    fn stage_matrix_integrates_the_powers() {
        for m in 1..=MAX_STAGES {
            let g = Gauss::nearest(m);
            for degree in 0..m {
                for j in 0..m {
                    let q: f64 = (0..m).map(|k| g.a[j * m + k] * g.c[k].powi(degree as i32)).sum();
                    let exact = g.c[j].powi(degree as i32 + 1) / (degree as f64 + 1.0);
                    assert!((q - exact).abs() < 1e-15);
                }
            }
        }
    }

    #[test]
    fn corrections_are_integrals_of_the_polynomials_for_slopes_at_one_node() {
        let (points, weights) = gauss_rule(6);
        for m in 1..=MAX_STAGES {
            let g = Gauss::nearest(m);
            let product = |t: f64| g.c.iter().map(|c| t - c).product::<f64>();
            let slopes = |t: f64| [(1.0 - t) * product(t) / product(0.0), t * product(t) / product(1.0)];
            for theta in [0.0, 0.2, 0.5, 0.9, 1.0] {
                let found = g.corrections(theta);
                for end in 0..2 {
                    let integral: f64 =
                        points.iter().zip(&weights).map(|(x, w)| theta * w * slopes(theta * x)[end]).sum();
                    assert!((found.values[end] - integral).abs() < 1e-15, "m={m} θ={theta}");
                    assert!((found.slopes[end] - slopes(theta)[end]).abs() < 1e-14, "m={m} θ={theta}");
                }
            }
        }
    }

    #[test]
    fn basis_reproduces_polynomials_and_their_slopes() {
        for m in 1..=MAX_STAGES {
            let g = Gauss::nearest(m);
            let (mut v, mut dv) = (vec![0.0; m + 1], vec![0.0; m + 1]);
            for theta in [0.0, 0.1, 0.37, 0.5, 0.99, 1.0, g.c[0]] {
                g.basis(theta, &mut v);
                g.basis_derivative(theta, &mut dv);
                for degree in 0..=m as i32 {
                    let at = |x: f64| x.powi(degree);
                    let value = v[0] * at(0.0) + (0..m).map(|j| v[j + 1] * at(g.c[j])).sum::<f64>();
                    let slope = dv[0] * at(0.0) + (0..m).map(|j| dv[j + 1] * at(g.c[j])).sum::<f64>();
                    let exact = if degree == 0 { 0.0 } else { degree as f64 * theta.powi(degree - 1) };
                    assert!((value - at(theta)).abs() < 1e-13 && (slope - exact).abs() < 1e-12);
                }
            }
        }
    }
}
