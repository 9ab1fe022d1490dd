//! The constants of the chemistry, by name, and its uniform states.

use furrow_cell::settings::Value;
use furrow_input::{InputError, did_you_mean};
use serde::{Deserialize, Serialize};

/// Surface per volume of the cytosol, ψ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SurfaceToVolume {
    /// From the cell's own passive shape: proportional to 1/R0.
    #[default]
    Shape,
    /// The same value for cells of all sizes, in 1/µm.
    Fixed(f64),
}

/// ψ of the real zygote, in 1/µm, measured by Goehring et al.
pub const ZYGOTE_SURFACE_TO_VOLUME: f64 = 0.174;

/// L_h in µm for which the published zygote, R0 = 5.4, has the size of the real zygote.
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
    /// All A, on the membrane and in the cytosol, per volume, 1/µm³.
    pub rho_a: f64,
    /// All P per volume, 1/µm³.
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

/// A named constant.
struct Named {
    name: &'static str,
    slot: fn(&mut ParConstants) -> &mut f64,
    /// Whether it may be 0.
    may_vanish: bool,
}

/// The constants that [`ParConstants::set`] knows, besides `n_p` and `psi`.
const NAMED: [Named; 10] = [
    Named { name: "d_a", slot: |c| &mut c.d_a, may_vanish: false },
    Named { name: "d_p", slot: |c| &mut c.d_p, may_vanish: false },
    Named { name: "k_on_a", slot: |c| &mut c.k_on_a, may_vanish: true },
    Named { name: "k_on_p", slot: |c| &mut c.k_on_p, may_vanish: true },
    Named { name: "k_off_a", slot: |c| &mut c.k_off_a, may_vanish: false },
    Named { name: "k_off_p", slot: |c| &mut c.k_off_p, may_vanish: false },
    Named { name: "rho_a", slot: |c| &mut c.rho_a, may_vanish: true },
    Named { name: "rho_p", slot: |c| &mut c.rho_p, may_vanish: true },
    Named { name: "k_ap", slot: |c| &mut c.k_ap, may_vanish: true },
    Named { name: "k_pa", slot: |c| &mut c.k_pa, may_vanish: true },
];

/// The name of ψ.
const PSI: &str = "psi";
/// The name of the power of P.
const POWER: &str = "n_p";

impl ParConstants {
    /// Goehring et al. 2011, with ψ from the shape.
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
        if name == PSI && value.text() == "shape" {
            self.surface_to_volume = SurfaceToVolume::Shape;
            return Ok(());
        }
        let number = value.number().filter(|number| number.is_finite());
        if name == PSI {
            let allowed = "shape, or a finite number above 0";
            let refused = || InputError::not_allowed(place, name, value, allowed);
            self.surface_to_volume = SurfaceToVolume::Fixed(number.filter(|psi| *psi > 0.0).ok_or_else(refused)?);
            return Ok(());
        }
        if name == POWER {
            let refused = || InputError::not_allowed(place, name, value, "1 or 2");
            self.n_p = [1, 2].into_iter().find(|n| number == Some(f64::from(*n))).ok_or_else(refused)?;
            return Ok(());
        }
        let Some(named) = NAMED.iter().find(|named| named.name == name) else {
            let known = Vec::from_iter(NAMED.iter().map(|named| named.name).chain([POWER, PSI]));
            let hint = did_you_mean(name, known.iter().copied());
            return Err(InputError::not_allowed(place, "par", name, format!("one of {}{hint}", known.join(", "))));
        };
        let allowed = if named.may_vanish { "a finite number, 0 or above" } else { "a finite number above 0" };
        let fits = |number: &f64| *number > 0.0 || named.may_vanish && *number == 0.0;
        *(named.slot)(self) =
            number.filter(fits).ok_or_else(|| InputError::not_allowed(place, name, value, allowed))?;
        Ok(())
    }
}
