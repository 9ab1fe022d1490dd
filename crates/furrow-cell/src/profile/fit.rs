//! Fits a smooth closed profile to the points of a table.
//!
//! On the profile 1 = ρ² h(μ), where (ρ, μ) are the polar coordinates of a point after division of z by a/b. This is linear in the
//! coefficients of h. A least-squares fit of the relative error determines them, and generalised cross-validation their number. Origin
//! and a/b follow from the moments of the profile, which is then fitted again.

use std::f64::consts::PI;
use std::sync::Arc;

use super::{Factor, MOST_TERMS};

/// Number of iterations for origin and a/b.
const ROUNDS: usize = 40;

/// Nodes of the quadrature over μ.
const NODES: usize = 256;

/// How much a term counts in generalised cross-validation. With 1, one noisy table in seven of 41 rows keeps many terms that describe
/// noise; with 1.4 (Kim and Gu, 2004) one in fifty.
const TERM: f64 = 1.4;

/// Coefficients below this are rounding errors.
const ROUNDING: f64 = 1e-9;

/// The profile of a table.
pub(super) struct Fitted {
    pub aspect: f64,
    pub factor: Factor,
    /// The largest relative distance of a point.
    pub error: f64,
    /// The point with this distance.
    pub worst: usize,
}

/// The reason why there is no profile.
#[derive(Debug)]
pub(super) enum Unfit {
    /// Seen from the axis at this z, a point lies behind the previous one.
    Hidden { point: usize, origin: f64 },
    /// The gap before a point is too wide: its angle, seen from the origin, in degrees.
    Gap { point: usize, angle: f64 },
    /// The best-fitting profile does not close.
    Open,
}

/// Fits points (z, r), in the order of decreasing z, the first and last on the axis.
pub(super) fn fit(points: &[[f64; 2]]) -> Result<Fitted, Unfit> {
    let widest = points.iter().map(|[_, r]| *r).fold(0.0, f64::max);
    let length = points[0][0] - points[points.len() - 1][0];
    let (mut origin, mut aspect) = (centre(points), 0.5 * length / widest);
    let mut found = None;
    for _ in 0..ROUNDS {
        let polar = polar(points, origin, aspect)?;
        let (factor, error, worst) = least_squares(&polar)?;
        let moments = Moments::of(&factor).ok_or(Unfit::Open)?;
        let [shift, stretch] = [aspect * moments.centre, moments.aspect];
        origin += shift;
        aspect *= stretch;
        let settled = shift.abs() < 1e-13 * length && (stretch - 1.0).abs() < 1e-13;
        found = Some((factor, moments, error, worst));
        if settled {
            break;
        }
    }
    let (factor, moments, error, worst) = found.ok_or(Unfit::Open)?;
    // The profile is scaled to the volume of the ellipsoid.
    let size = moments.volume.powf(2.0 / 3.0);
    let clean = |(l, c): (usize, &f64)| if l % 2 == 1 && c.abs() * size < ROUNDING { 0.0 } else { c * size };
    let factor = Factor(factor.0.iter().enumerate().map(clean).collect());
    Ok(Fitted { aspect, factor, error, worst })
}

/// The centre of the volume of the frusta between the points.
fn centre(points: &[[f64; 2]]) -> f64 {
    let (mut volume, mut moment) = (0.0, 0.0);
    for pair in points.windows(2) {
        let [[z, r], [to, end]] = [pair[0], pair[1]];
        let part = (z - to) * (r * r + r * end + end * end);
        volume += part;
        // The centre of a frustum is closer to its wider end.
        let share =
            (r * r + 2.0 * r * end + 3.0 * end * end) / (4.0 * (r * r + r * end + end * end)).max(f64::MIN_POSITIVE);
        moment += part * (z + share * (to - z));
    }
    moment / volume
}

/// (ρ, μ) of the points.
fn polar(points: &[[f64; 2]], origin: f64, aspect: f64) -> Result<Vec<[f64; 2]>, Unfit> {
    let mut out = Vec::with_capacity(points.len());
    let mut before = 0.0;
    for (point, [z, r]) in points.iter().enumerate() {
        let along = (z - origin) / aspect;
        let angle = r.atan2(along);
        if point > 0 && angle <= before {
            return Err(Unfit::Hidden { point, origin });
        }
        if angle - before > WIDEST_GAP {
            return Err(Unfit::Gap { point, angle: (angle - before).to_degrees() });
        }
        before = angle;
        let rho = along.hypot(*r);
        out.push([rho, along / rho]);
    }
    Ok(out)
}

/// The widest allowed gap between neighbours: half a wavelength of the shortest polynomials that are always tried.
const WIDEST_GAP: f64 = PI / 4.0;

/// The fit of h to the points (ρ, μ), with the largest relative distance of a point from the profile, and that point.
fn least_squares(polar: &[[f64; 2]]) -> Result<(Factor, f64, usize), Unfit> {
    let angles: Vec<f64> = polar.iter().map(|[_, mu]| mu.clamp(-1.0, 1.0).acos()).collect();
    let gap = angles.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
    // Waves shorter than two gaps are not resolved.
    let most = MOST_TERMS.min(2 * polar.len() / 3).min((PI / gap) as usize + 1).max(1);
    let columns = columns(polar, most);
    let (basis, triangle) = orthogonal(&columns);
    let n = polar.len() as f64;
    let mut rest = vec![1.0; polar.len()];
    let (mut projections, mut scores) = (Vec::new(), Vec::new());
    for direction in &basis {
        let share: f64 = direction.iter().zip(&rest).map(|(q, y)| q * y).sum();
        rest.iter_mut().zip(direction).for_each(|(y, q)| *y -= share * q);
        projections.push(share);
        let sum: f64 = rest.iter().map(|y| y * y).sum();
        scores.push(n * sum / (n - TERM * projections.len() as f64).powi(2));
    }
    let least = scores.iter().copied().fold(f64::INFINITY, f64::min);
    // The smallest number of terms that is as good as the best, up to rounding errors.
    let terms = scores.iter().position(|score| *score <= (1.05 * least).max(1e-24)).ok_or(Unfit::Open)? + 1;
    let mut series = projections[..terms].to_vec();
    for l in (0..terms).rev() {
        let known: f64 = (l + 1..terms).map(|k| triangle[k][l] * series[k]).sum();
        series[l] = (series[l] - known) / triangle[l][l];
    }
    let value = |k: usize| (0..terms).map(|l| columns[l][k] * series[l]).sum::<f64>();
    let distances = (0..polar.len()).map(|k| (k, 0.5 * (value(k) - 1.0).abs()));
    let (worst, error) = distances.fold((0, 0.0), |most, next| if next.1 > most.1 { next } else { most });
    Ok((Factor(Arc::from(series)), error, worst))
}

/// ρ² P_l(μ) at the points, for each l.
fn columns(polar: &[[f64; 2]], terms: usize) -> Vec<Vec<f64>> {
    let mut columns = vec![Vec::with_capacity(polar.len()); terms];
    for [rho, mu] in polar {
        let (mut before, mut here) = (0.0, 1.0);
        for (l, column) in columns.iter_mut().enumerate() {
            column.push(rho * rho * here);
            let l = l as f64;
            (before, here) = (here, ((2.0 * l + 1.0) * mu * here - l * before) / (l + 1.0));
        }
    }
    columns
}

/// QR factorisation: orthonormal columns, each orthogonalised twice, and the triangular factor.
fn orthogonal(columns: &[Vec<f64>]) -> (Vec<Vec<f64>>, Vec<Vec<f64>>) {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let mut triangle = Vec::new();
    for column in columns {
        let (mut left, mut shares) = (column.clone(), vec![0.0; basis.len()]);
        for _ in 0..2 {
            for (direction, share) in basis.iter().zip(&mut shares) {
                let part = dot(direction, &left);
                left.iter_mut().zip(direction).for_each(|(x, q)| *x -= part * q);
                *share += part;
            }
        }
        let norm = dot(&left, &left).sqrt();
        left.iter_mut().for_each(|x| *x /= norm);
        shares.push(norm);
        basis.push(left);
        triangle.push(shares);
    }
    (basis, triangle)
}

/// Moments of the volume inside ρ = h^(−½).
pub(super) struct Moments {
    /// ½ ∫ ρ³ dμ: the volume, divided by 4π/3.
    pub volume: f64,
    /// z of the centre of volume.
    pub centre: f64,
    /// a/b of the ellipsoid with the same second moments.
    pub aspect: f64,
}

impl Moments {
    /// Computes the moments by Fejér's rule; `None` if h is not positive everywhere.
    pub fn of(factor: &Factor) -> Option<Moments> {
        let [mut volume, mut first, mut along, mut across] = [0.0; 4];
        for k in 0..NODES {
            let angle = (k as f64 + 0.5) * PI / NODES as f64;
            let even = (1..=NODES / 2).map(|j| (2.0 * j as f64 * angle).cos() / (4.0 * (j * j) as f64 - 1.0));
            let weight = (2.0 - 4.0 * even.sum::<f64>()) / NODES as f64;
            let mu = angle.cos();
            let [h, ..] = factor.derivatives(mu);
            if h.is_nan() || h <= 0.0 {
                return None;
            }
            let rho = h.powf(-0.5);
            let cube = weight * rho.powi(3);
            volume += cube / 3.0;
            first += cube * rho * mu / 4.0;
            along += cube * rho * rho * mu * mu / 5.0;
            across += 0.5 * cube * rho * rho * (1.0 - mu * mu) / 5.0;
        }
        let centre = first / volume;
        let aspect = ((along / volume - centre * centre) / (across / volume)).sqrt();
        let found = Moments { volume: 1.5 * volume, centre, aspect };
        (found.aspect.is_finite() && found.volume.is_finite()).then_some(found)
    }
}
