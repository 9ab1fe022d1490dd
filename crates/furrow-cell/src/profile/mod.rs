//! Shells with a profile r over z from a table instead of the ellipsoid.
//!
//! Let a and b be the half-axes of the ellipsoid of the same volume and the same second moments, Q = z²/a² + r²/b² and
//! μ = (z/a)/√Q. The wall is at E = Q h(μ) = 1, and the shell's potential is P0 exp\[(E − 1)/w²\] \[M.30 profile\]. h = 1 gives
//! the ellipsoid. h is a sum of Legendre polynomials, fitted to the table, with ½ ∫ h^(−3/2) dμ = 1, so that the volume is 4πab²/3
//! for every h.
//!
//! | file | contents |
//! |---|---|
//! | `choice` | the ellipsoid or the profile of a table, as selected by settings and files |
//! | `fit` | h, a/b and the origin from a table |
//! | `file` | tables, and profiles in JSON |

mod choice;
mod file;
mod fit;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::law::{Algebra, Function};

pub use choice::{ELLIPSOID, ShellChoice, WrittenShell};

/// Largest number of terms of h.
pub const MOST_TERMS: usize = 25;

/// Number of derivatives from [`Factor::derivatives`], including h itself.
const DERIVATIVES: usize = 5;

/// The profile of a shell, without its size.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "file::Document", into = "file::Document")]
pub struct ShellProfile {
    /// The name of its table.
    name: String,
    /// a/b of the ellipsoid with the same second moments.
    aspect: f64,
    /// The largest distance of the table's points from the profile, relative to their distance from the origin.
    error: f64,
    factor: Factor,
}

/// h(μ), which describes the deviation of a shell from its ellipsoid.
#[derive(Clone, Debug, PartialEq)]
pub struct Factor(Arc<[f64]>);

impl ShellProfile {
    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Ratio a/b of the half-axes of the ellipsoid with the same second moments.
    pub fn aspect(&self) -> f64 {
        self.aspect
    }

    /// The largest distance of the table's points from the profile, relative to their distance from the centre of volume.
    pub fn error(&self) -> f64 {
        self.error
    }

    /// h(μ).
    pub fn factor(&self) -> &Factor {
        &self.factor
    }

    /// Whether it is symmetric under z → −z.
    pub fn is_mirror_symmetric(&self) -> bool {
        self.factor.0.iter().skip(1).step_by(2).all(|c| *c == 0.0)
    }

    /// The mirror image of the profile.
    pub fn mirrored(&self) -> ShellProfile {
        let signed = |(l, c): (usize, &f64)| if l % 2 == 0 { *c } else { -c };
        let factor = Factor(self.factor.0.iter().enumerate().map(signed).collect());
        ShellProfile { factor, ..self.clone() }
    }

    /// The profile in one line: its name, and the number of terms of h.
    pub fn described(&self) -> String {
        format!("{:?} ({} terms)", self.name, self.factor.0.len())
    }
}

impl Factor {
    /// The coefficients of the Legendre polynomials P_0, P_1, …
    pub fn series(&self) -> &[f64] {
        &self.0
    }

    /// The distance of the wall from the origin at μ, where the ellipsoid is the unit sphere.
    pub fn radius(&self, mu: f64) -> f64 {
        self.derivatives(mu)[0].powf(-0.5)
    }

    /// h and its derivatives at μ, up to the fourth.
    pub fn derivatives(&self, mu: f64) -> [f64; DERIVATIVES] {
        let (mut before, mut here) = ([0.0; DERIVATIVES], [0.0; DERIVATIVES]);
        here[0] = 1.0;
        let mut sum = [0.0; DERIVATIVES];
        for (l, c) in self.0.iter().enumerate() {
            sum.iter_mut().zip(here).for_each(|(sum, p)| *sum += c * p);
            let l = l as f64;
            // (l + 1) P_{l+1} = (2l + 1) μ P_l − l P_{l−1}, and its k-th derivative.
            let next = std::array::from_fn(|k| {
                let lower = if k == 0 { 0.0 } else { k as f64 * here[k - 1] };
                ((2.0 * l + 1.0) * (mu * here[k] + lower) - l * before[k]) / (l + 1.0)
            });
            (before, here) = (here, next);
        }
        sum
    }

    /// h and h′ at μ, for numbers with derivatives up to the third.
    pub fn at<D: Algebra>(&self, mu: D) -> [D; 2] {
        let [h, first, second, third, fourth] = self.derivatives(mu.real());
        // The Taylor series about the value is finite, because the remainder contains only derivatives.
        let rest = mu - D::from(mu.real());
        let series = |t: [f64; 4]| t.into_iter().rev().fold(D::from(0.0), |sum, t| sum * rest + D::from(t));
        [series([h, first, 0.5 * second, third / 6.0]), series([first, second, 0.5 * third, fourth / 6.0])]
    }

    /// E = Q h(μ) at a point, and half of its gradient; the last coordinate is z, and `inverse` are the inverse squares of
    /// the ellipsoid's half-axes.
    pub fn level<D: Algebra, const K: usize>(&self, place: [D; K], inverse: [D; K]) -> (D, [D; K]) {
        let by: [D; K] = std::array::from_fn(|k| place[k] * inverse[k]);
        let square = (0..K).fold(D::from(0.0), |sum, k| sum + place[k] * by[k]);
        let (root, inverse_a) = (square.call(Function::Sqrt), inverse[K - 1].call(Function::Sqrt));
        let mu = place[K - 1] * inverse_a / root;
        let [h, slope] = self.at(mu);
        let radial = h + -(mu * slope * 0.5);
        let mut gradient = by.map(|by| by * radial);
        gradient[K - 1] = gradient[K - 1] + slope * inverse_a * root * 0.5;
        (square * h, gradient)
    }
}
