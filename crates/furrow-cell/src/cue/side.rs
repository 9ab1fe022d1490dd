//! Profiles of terms of a cue around the axis.

/// A part of the cortex around the angle `at`, S.8: a term's f(u) is multiplied by exp(2(sin πu cos(φ − at) − 1)/spread²). Near the
/// equator this is exp(−(φ − at)²/spread²) for small angles; it is smooth at the poles.
///
/// In a flattened shell φ is measured from the plane midway between the plates, so that 90° faces a plate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Side {
    /// Angle about the axis, in radians.
    pub at: f64,
    /// Width, in radians.
    pub spread: f64,
}

impl Side {
    /// The factor at u and the angle `phi`, at most 1.
    pub fn share(&self, u: f64, phi: f64) -> f64 {
        let nearness = (std::f64::consts::PI * u).sin() * (phi - self.at).cos();
        (2.0 * (nearness - 1.0) / (self.spread * self.spread)).exp()
    }
}
