//! The constants of PAR polarity, by name.

use furrow_input::{InputError, did_you_mean};
use serde::{Deserialize, Serialize};

use crate::settings::Value;

/// Surface per volume of the cytosol, ψ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SurfaceToVolume {
    /// From the cell's passive shape, proportional to 1/R0.
    #[default]
    Shape,
    /// The same value for cells of all sizes, in 1/µm.
    Fixed(f64),
}

/// ψ of the worm's zygote, in 1/µm, measured by Goehring et al.
pub const ZYGOTE_SURFACE_TO_VOLUME: f64 = 0.174;

/// L_h in µm for which the published zygote, R0 = 5.4, has the size of the worm's zygote.
pub const LENGTH_UM: f64 = 3.2;

/// Constants of two antagonists A and P, in µm and s.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ParConstants {
    /// Diffusion of A on the membrane, µm²/s.
    pub d_a: f64,
    /// Diffusion of P, µm²/s.
    pub d_p: f64,
    /// Attachment of A, µm/s.
    pub k_on_a: f64,
    /// Attachment of P, µm/s.
    pub k_on_p: f64,
    /// Detachment of A, 1/s.
    pub k_off_a: f64,
    /// Detachment of P, 1/s.
    pub k_off_p: f64,
    /// Total A, on the membrane and in the cytosol, per volume, 1/µm³.
    pub rho_a: f64,
    /// Total P per volume, 1/µm³.
    pub rho_p: f64,
    /// Removal of A by P, µm²/s, or µm⁴/s if `n_p` is 2.
    pub k_ap: f64,
    /// Removal of P by A, µm⁴/s.
    pub k_pa: f64,
    /// Power of P in the removal of A: 1 or 2. The power of A in the removal of P is 2.
    pub n_p: u8,
    /// Surface per volume.
    pub surface_to_volume: SurfaceToVolume,
}

/// A numeric constant of the chemistry.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ParConstant {
    /// Diffusion of A.
    DA,
    /// Diffusion of P.
    DP,
    /// Attachment of A.
    KOnA,
    /// Attachment of P.
    KOnP,
    /// Detachment of A.
    KOffA,
    /// Detachment of P.
    KOffP,
    /// Total A per volume.
    RhoA,
    /// Total P per volume.
    RhoP,
    /// Removal of A by P.
    KAp,
    /// Removal of P by A.
    KPa,
    /// Surface per volume, if it is the same for cells of all sizes.
    Psi,
}

use ParConstant::{DA, DP, KAp, KOffA, KOffP, KOnA, KOnP, KPa, Psi, RhoA, RhoP};

/// The name of the power of P.
const POWER: &str = "n_p";

impl ParConstant {
    /// All numeric constants.
    pub const ALL: [ParConstant; 11] = [DA, DP, KOnA, KOnP, KOffA, KOffP, RhoA, RhoP, KAp, KPa, Psi];

    /// Its name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            DA => "d_a",
            DP => "d_p",
            KOnA => "k_on_a",
            KOnP => "k_on_p",
            KOffA => "k_off_a",
            KOffP => "k_off_p",
            RhoA => "rho_a",
            RhoP => "rho_p",
            KAp => "k_ap",
            KPa => "k_pa",
            Psi => "psi",
        }
    }

    /// Its unit; for the removal of A by P the unit at `n_p` = 1.
    pub fn unit(self) -> &'static str {
        match self {
            DA | DP | KAp => "µm²/s",
            KOnA | KOnP => "µm/s",
            KOffA | KOffP => "1/s",
            RhoA | RhoP => "1/µm³",
            KPa => "µm⁴/s",
            Psi => "1/µm",
        }
    }

    /// The constant with a given name.
    pub fn named(name: &str) -> Option<ParConstant> {
        ParConstant::ALL.into_iter().find(|constant| constant.name() == name)
    }

    /// The allowed values if this value is invalid.
    pub fn refused(self, value: f64) -> Option<&'static str> {
        let may_vanish = !matches!(self, DA | DP | KOffA | KOffP | Psi);
        let fine = value.is_finite() && (value > 0.0 || may_vanish && value == 0.0);
        let allowed = match (self, may_vanish) {
            (Psi, _) => "shape, or a finite number above 0",
            (_, true) => "a finite number, 0 or above",
            (_, false) => "a finite number above 0",
        };
        (!fine).then_some(allowed)
    }
}

impl Default for ParConstants {
    fn default() -> ParConstants {
        ParConstants::GOEHRING2011
    }
}

impl ParConstants {
    /// The constants of Goehring et al. 2011, with ψ from the shape.
    pub const GOEHRING2011: ParConstants = ParConstants {
        d_a: 0.28,
        d_p: 0.15,
        k_on_a: 0.00858,
        k_on_p: 0.0474,
        k_off_a: 0.0054,
        k_off_p: 0.0073,
        rho_a: 1.56,
        rho_p: 1.0,
        k_ap: 0.19,
        k_pa: 2.0,
        n_p: 1,
        surface_to_volume: SurfaceToVolume::Shape,
    };

    /// The value of a constant; `None` for ψ if it follows from the shape.
    pub fn get(mut self, constant: ParConstant) -> Option<f64> {
        self.slot(constant).copied()
    }

    /// Mutable access to a constant.
    pub(crate) fn slot(&mut self, constant: ParConstant) -> Option<&mut f64> {
        Some(match constant {
            DA => &mut self.d_a,
            DP => &mut self.d_p,
            KOnA => &mut self.k_on_a,
            KOnP => &mut self.k_on_p,
            KOffA => &mut self.k_off_a,
            KOffP => &mut self.k_off_p,
            RhoA => &mut self.rho_a,
            RhoP => &mut self.rho_p,
            KAp => &mut self.k_ap,
            KPa => &mut self.k_pa,
            Psi => match &mut self.surface_to_volume {
                SurfaceToVolume::Fixed(psi) => psi,
                SurfaceToVolume::Shape => return None,
            },
        })
    }

    /// Sets one constant from text such as `d_a=0.3`, `psi=0.174` or `psi=shape`; `place` names the source in errors.
    ///
    /// # Errors
    /// Names the constant, its value and the allowed values.
    pub fn set(&mut self, place: &str, text: &str) -> Result<(), InputError> {
        let Some((name, value)) = text.split_once('=') else {
            return Err(InputError::not_allowed(place, "par", text, "KEY=VALUE, as in k_ap=0.19"));
        };
        self.assign(place, name.trim(), &Value::Text(value.trim().to_owned()))
    }

    /// Sets one constant by its name; `place` names the source of the value in errors.
    ///
    /// # Errors
    /// Names the constant, its value and the allowed values.
    pub fn assign(&mut self, place: &str, name: &str, value: &Value) -> Result<(), InputError> {
        match self.put(name, value) {
            Some(Ok(())) => Ok(()),
            Some(Err(allowed)) => Err(InputError::not_allowed(place, name, value, allowed)),
            None => {
                let known: Vec<&str> = names().collect();
                let hint = did_you_mean(name, names());
                Err(InputError::not_allowed(place, "par", name, format!("one of {}{hint}", known.join(", "))))
            }
        }
    }

    /// Sets one constant by its name; `None` for an unknown name. An error is the text of the allowed values.
    pub(crate) fn put(&mut self, name: &str, value: &Value) -> Option<Result<(), &'static str>> {
        let number = value.number();
        if name == POWER {
            let found = [1, 2].into_iter().find(|n| number == Some(f64::from(*n))).ok_or("1 or 2");
            return Some(found.map(|n| self.n_p = n));
        }
        let constant = ParConstant::named(name)?;
        if constant == Psi {
            self.surface_to_volume =
                if value.text() == "shape" { SurfaceToVolume::Shape } else { SurfaceToVolume::Fixed(f64::NAN) };
        }
        let Some(slot) = self.slot(constant) else { return Some(Ok(())) };
        *slot = number.unwrap_or(f64::NAN);
        Some(constant.refused(*slot).map_or(Ok(()), Err))
    }

    /// The constants that differ from the published ones, as text: names and values.
    pub(crate) fn stated(&self) -> Vec<(&'static str, String)> {
        let published = ParConstants::GOEHRING2011;
        let differs = |constant: &ParConstant| self.get(*constant) != published.get(*constant);
        let number = |constant: ParConstant| Some((constant.name(), self.get(constant)?.to_string()));
        let power = (self.n_p != published.n_p).then(|| (POWER, self.n_p.to_string()));
        ParConstant::ALL.into_iter().filter(differs).filter_map(number).chain(power).collect()
    }
}

/// The names of all constants.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    let (psi, others) = (Psi.name(), ParConstant::ALL.into_iter().filter(|constant| *constant != Psi));
    others.map(ParConstant::name).chain([POWER, psi])
}
