//! Parameters of a founder for its part of the lineage.

use serde::{Deserialize, Serialize, Serializer};

use furrow_cell::{Cell, Parameter};

/// Parameters of a founder and of its descendants up to the next founder. They replace the run's parameters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields, rename = "Physics")]
pub struct FounderPhysics {
    /// Activity ξ_s.
    pub xi_s: Option<f64>,
    /// Ratio ξ_b/ξ_s.
    pub xi_ratio: Option<f64>,
    /// Gain g.
    pub gain: Option<f64>,
    /// Volume fraction ε.
    pub epsilon: Option<f64>,
    /// Shell aspect ratio a/b.
    pub aspect: Option<f64>,
    /// Shell strength.
    pub p0: Option<f64>,
    /// Shell width w.
    pub w: Option<f64>,
    /// Flattening of the shell.
    pub shell_flattening: Option<f64>,
    /// Bending rigidity κ.
    pub kappa: Option<f64>,
    /// Bulk viscosity η_b.
    pub eta_b: Option<f64>,
    /// Shear viscosity η_s.
    pub eta_s: Option<f64>,
    /// Friction Γ.
    pub friction: Option<f64>,
    /// Tension γ.
    pub tension: Option<f64>,
    /// Spontaneous curvature C0.
    pub spontaneous_curvature: Option<f64>,
    /// Normal friction Γ_n.
    pub normal_friction: Option<f64>,
}

impl FounderPhysics {
    /// The fields and their parameters.
    fn slots(&mut self) -> [(Parameter, &mut Option<f64>); 15] {
        // There is no `..`, so that a new field is a compile error until it has a parameter.
        let FounderPhysics {
            xi_s,
            xi_ratio,
            gain,
            epsilon,
            aspect,
            p0,
            w,
            shell_flattening,
            kappa,
            eta_b,
            eta_s,
            friction,
            tension,
            spontaneous_curvature,
            normal_friction,
        } = self;
        [
            (Parameter::XiS, xi_s),
            (Parameter::XiRatio, xi_ratio),
            (Parameter::Gain, gain),
            (Parameter::Epsilon, epsilon),
            (Parameter::Aspect, aspect),
            (Parameter::P0, p0),
            (Parameter::W, w),
            (Parameter::Flattening, shell_flattening),
            (Parameter::Kappa, kappa),
            (Parameter::EtaB, eta_b),
            (Parameter::EtaS, eta_s),
            (Parameter::Friction, friction),
            (Parameter::Tension, tension),
            (Parameter::SpontaneousCurvature, spontaneous_curvature),
            (Parameter::NormalFriction, normal_friction),
        ]
    }

    /// The parameters that it sets.
    pub fn values(&self) -> impl Iterator<Item = (Parameter, f64)> + use<> {
        let values = self.to_owned().slots().map(|(parameter, value)| (parameter, *value));
        values.into_iter().filter_map(|(parameter, value)| Some((parameter, value?)))
    }

    /// Sets a parameter. R0 and numbers of a cue are ignored.
    pub fn set(&mut self, parameter: Parameter, value: f64) {
        self.slots().into_iter().filter(|(of, _)| *of == parameter).for_each(|(_, slot)| *slot = Some(value));
    }

    /// Whether a parameter is set.
    pub fn has(&self, parameter: Parameter) -> bool {
        self.values().any(|(of, _)| of == parameter)
    }

    /// Whether founders can have a parameter.
    pub fn can_have(parameter: Parameter) -> bool {
        FounderPhysics::default().slots().iter().any(|(of, _)| *of == parameter)
    }

    /// Whether no parameter is set.
    pub fn is_empty(&self) -> bool {
        self.values().next().is_none()
    }

    /// Sets the parameters of a cell.
    pub fn apply(&self, cell: &mut Cell) {
        self.values().for_each(|(parameter, value)| parameter.set(cell, value));
    }
}

impl Serialize for FounderPhysics {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.values().map(|(parameter, value)| (parameter.name(), value)))
    }
}
