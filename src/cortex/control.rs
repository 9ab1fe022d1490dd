//! Every scalar of the model that can be varied: by continuation, by calibration, from the command line.

use serde::{Deserialize, Serialize};

use super::cue::Cue;
use super::parameters::Physics;

/// A scalar parameter of one cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Control {
    /// Anisotropic activity ξ_s at fixed ratio ξ_b/ξ_s.
    Xi,
    /// Ratio ξ_b/ξ_s.
    XiRatio,
    /// Gain g.
    Gain,
    /// Cell radius R0.
    R0,
    /// Volume fraction ε.
    Epsilon,
    /// Shell aspect ratio a/b.
    Aspect,
    /// Shell strength P0.
    P0,
    /// Shell width w.
    W,
    /// Bending rigidity κ.
    Kappa,
    /// Bulk viscosity η_b.
    EtaB,
    /// Shear viscosity η_s.
    EtaS,
    /// Friction Γ.
    Friction,
    /// Tension γ.
    Tension,
    /// Cue centre u0.
    CueU0,
    /// Cue width ω.
    CueOmega,
    /// Cue amplitude Δκ.
    CueAmplitude,
}

impl Control {
    /// Every control, for listings.
    pub const ALL: [Control; 16] = [
        Control::Xi,
        Control::XiRatio,
        Control::Gain,
        Control::R0,
        Control::Epsilon,
        Control::Aspect,
        Control::P0,
        Control::W,
        Control::Kappa,
        Control::EtaB,
        Control::EtaS,
        Control::Friction,
        Control::Tension,
        Control::CueU0,
        Control::CueOmega,
        Control::CueAmplitude,
    ];

    /// Its value. Cue parameters of a cell without cue are those of a band of zero amplitude.
    pub fn get(self, physics: &Physics, r0: f64, cue: &Cue) -> f64 {
        let band = match *cue {
            Cue::None => [0.5, 1.0, 0.0],
            Cue::Kappa { u0, omega, amplitude } => [u0, omega, amplitude],
        };
        match self {
            Control::Xi => physics.xi_s,
            Control::XiRatio => physics.xi_ratio,
            Control::Gain => physics.gain,
            Control::R0 => r0,
            Control::Epsilon => physics.epsilon,
            Control::Aspect => physics.aspect,
            Control::P0 => physics.p0,
            Control::W => physics.w,
            Control::Kappa => physics.kappa,
            Control::EtaB => physics.eta_b,
            Control::EtaS => physics.eta_s,
            Control::Friction => physics.friction,
            Control::Tension => physics.tension,
            Control::CueU0 => band[0],
            Control::CueOmega => band[1],
            Control::CueAmplitude => band[2],
        }
    }

    /// Sets it. Cue parameters of a cell without a cue are left alone.
    pub fn set(self, value: f64, physics: &mut Physics, r0: &mut f64, cue: &mut Cue) {
        match self {
            Control::Xi => physics.xi_s = value,
            Control::XiRatio => physics.xi_ratio = value,
            Control::Gain => physics.gain = value,
            Control::R0 => *r0 = value,
            Control::Epsilon => physics.epsilon = value,
            Control::Aspect => physics.aspect = value,
            Control::P0 => physics.p0 = value,
            Control::W => physics.w = value,
            Control::Kappa => physics.kappa = value,
            Control::EtaB => physics.eta_b = value,
            Control::EtaS => physics.eta_s = value,
            Control::Friction => physics.friction = value,
            Control::Tension => physics.tension = value,
            Control::CueU0 | Control::CueOmega | Control::CueAmplitude => {
                if let Cue::Kappa { u0, omega, amplitude } = cue {
                    match self {
                        Control::CueU0 => *u0 = value,
                        Control::CueOmega => *omega = value,
                        _ => *amplitude = value,
                    }
                }
            }
        }
    }
}
