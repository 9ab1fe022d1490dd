//! Parameters as users give them: a RON file, then `--set key=value`, each field checked.

use crate::cortex::{Cue, Numerics, Physics, RigidityGradient};
use crate::input::{InputError, parse_ron, read_text};
use crate::lineage::{Lineage, check_cue};
use serde::Deserialize;
use std::path::Path;

/// Physical and numerical parameters of a run, checked.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Settings {
    /// Physical parameters.
    pub physics: Physics,
    /// Discretisation.
    pub numerics: Numerics,
}

/// A setter takes the text of a value and says what is allowed if it cannot be read.
type Set = fn(&mut Settings, &str) -> Result<(), &'static str>;
/// A check gives the offending value and what is allowed.
type Valid = fn(&Settings) -> Option<(String, &'static str)>;

struct Field {
    section: &'static str,
    name: &'static str,
    aliases: &'static [&'static str],
    set: Set,
    valid: Valid,
}

/// One table of all fields: the overrides that a RON file may hold, `--set`, and the checks come from it.
macro_rules! fields {
    ($($section:ident $overrides:ident $shown:literal {
        $($name:ident $([$($alias:literal),*])? : $kind:ty, $allowed:literal, |$v:ident| $ok:expr;)*
    })*) => {
        $(
            #[derive(Deserialize, Default)]
            #[serde(default, deny_unknown_fields, rename = $shown)]
            struct $overrides {
                $($(#[serde($(alias = $alias),*)])? $name: Option<$kind>,)*
                #[serde(skip)]
                _fields: (),
            }

            impl $overrides {
                fn apply(self, settings: &mut Settings) {
                    $(if let Some(value) = self.$name { settings.$section.$name = value; })*
                }
            }
        )*

        const FIELDS: &[Field] = &[$($(
            Field {
                section: stringify!($section),
                name: stringify!($name),
                aliases: &[$($($alias),*)?],
                set: |settings, text| {
                    settings.$section.$name = <$kind as Value>::read(text).ok_or($allowed)?;
                    Ok(())
                },
                valid: |settings| {
                    let $v: $kind = settings.$section.$name;
                    let ok: bool = $ok;
                    (!ok).then(|| (Value::show(&$v), $allowed))
                },
            },
        )*)*];
    };
}

fields! {
    physics PhysicsOverrides "Physics" {
        kappa: f64, "a finite number above 0", |v| v.is_finite() && v > 0.0;
        eta_b: f64, "a finite number above 0", |v| v.is_finite() && v > 0.0;
        eta_s: f64, "a finite number, 0 or above", |v| v.is_finite() && v >= 0.0;
        friction ["Gamma"]: f64, "a finite number above 0", |v| v.is_finite() && v > 0.0;
        tension ["gamma"]: f64, "a finite number", |v| v.is_finite();
        xi_s ["xi"]: f64, "a finite number", |v| v.is_finite();
        xi_ratio: f64, "a finite number", |v| v.is_finite();
        gain ["g"]: f64, "a finite number above 0", |v| v.is_finite() && v > 0.0;
        aspect ["a_over_b"]: f64, "a finite number above 0", |v| v.is_finite() && v > 0.0;
        p0 ["P0"]: f64, "a finite number above 0", |v| v.is_finite() && v > 0.0;
        w: f64, "a finite number above 0", |v| v.is_finite() && v > 0.0;
        r0 ["R0"]: f64, "a finite number above 0", |v| v.is_finite() && v > 0.0;
        epsilon ["eps"]: f64, "above 0 and below 1", |v| v > 0.0 && v < 1.0;
        rigidity_gradient: RigidityGradient, "full or dropped", |_v| true;
    }
    numerics NumericsOverrides "Numerics" {
        stages: usize, "a whole number from 1 to 5", |v| (1..=5).contains(&v);
        intervals: usize, "an even whole number from 8 to 4096", |v| v.is_multiple_of(2) && (8..=4096).contains(&v);
        time_tolerance: f64, "above 0 and below 1", |v| v > 0.0 && v < 1.0;
        step_factor: f64, "above 0 and at most 1", |v| v > 0.0 && v <= 1.0;
        t_max: f64, "a finite number above 0", |v| v.is_finite() && v > 0.0;
        chi_symmetric: f64, "0 or above and below 1", |v| (0.0..1.0).contains(&v);
    }
}

trait Value: Sized {
    fn read(text: &str) -> Option<Self>;
    fn show(&self) -> String;
}

impl Value for f64 {
    fn read(text: &str) -> Option<f64> {
        text.parse().ok()
    }
    fn show(&self) -> String {
        self.to_string()
    }
}

impl Value for usize {
    fn read(text: &str) -> Option<usize> {
        text.parse().ok()
    }
    fn show(&self) -> String {
        self.to_string()
    }
}

impl Value for RigidityGradient {
    fn read(text: &str) -> Option<RigidityGradient> {
        match text {
            "full" => Some(RigidityGradient::Full),
            "dropped" => Some(RigidityGradient::Dropped),
            _ => None,
        }
    }
    fn show(&self) -> String {
        match self {
            RigidityGradient::Full => "full".to_owned(),
            RigidityGradient::Dropped => "dropped".to_owned(),
        }
    }
}

/// The configuration file: what it does not name keeps the preset's value.
#[derive(Deserialize, Default)]
#[serde(default, deny_unknown_fields)]
struct Config {
    physics: PhysicsOverrides,
    numerics: NumericsOverrides,
}

impl Settings {
    /// The preset with the parameters of a configuration file, if any, and then with `overrides` of the form
    /// `key=value`.
    ///
    /// Keys are the fields of [`Physics`] and [`Numerics`] and the aliases `xi`, `g`, `eps`, `a_over_b`, `P0` (the
    /// shell's strength), `R0`, `Gamma`, `gamma`. Besides these, `xi_b` sets `xi_ratio` = ξ_b/ξ_s from the ξ_s that all
    /// settings together give: it is the ratio that is kept wherever ξ_s is varied afterwards.
    ///
    /// # Errors
    /// Names the file or option, the field, its value and what is allowed.
    pub fn load(config: Option<&Path>, overrides: &[String]) -> Result<Settings, InputError> {
        let mut settings = Settings::default();
        if let Some(path) = config {
            let file = path.display().to_string();
            settings.apply_config(&read_text(path)?, &file)?;
        }
        settings.apply_overrides(overrides)?;
        Ok(settings)
    }

    /// Applies and checks the text of a configuration file.
    pub fn apply_config(&mut self, text: &str, file: &str) -> Result<(), InputError> {
        let config: Config = parse_ron(text, file)?;
        config.physics.apply(self);
        config.numerics.apply(self);
        self.check(file)
    }

    /// Applies and checks `key=value` settings, in order; `xi_b` last.
    pub fn apply_overrides(&mut self, overrides: &[String]) -> Result<(), InputError> {
        const SOURCE: &str = "--set";
        let mut xi_b = None;
        for entry in overrides {
            let Some((key, value)) = entry.split_once('=') else {
                return Err(InputError::not_allowed(SOURCE, "setting", format!("{entry:?}"), "of the form key=value"));
            };
            let (key, value) = (key.trim(), value.trim());
            let plain = key.strip_prefix("physics.").or(key.strip_prefix("numerics.")).unwrap_or(key);
            if plain == "xi_b" {
                let allowed = "a finite number";
                let read = value.parse::<f64>().ok().filter(|v| v.is_finite());
                xi_b = Some(read.ok_or_else(|| InputError::not_allowed(SOURCE, "xi_b", value, allowed))?);
                continue;
            }
            let Some(field) = FIELDS.iter().find(|f| f.name == plain || f.aliases.contains(&plain)) else {
                let names: Vec<&str> = FIELDS.iter().map(|f| f.name).collect();
                let allowed = format!("one of {}, xi_b", names.join(", "));
                return Err(InputError::not_allowed(SOURCE, "key", format!("{key:?}"), allowed));
            };
            (field.set)(self, value).map_err(|allowed| InputError::not_allowed(SOURCE, field.name, value, allowed))?;
        }
        if let Some(xi_b) = xi_b {
            let ratio = xi_b / self.physics.xi_s;
            if !ratio.is_finite() {
                let allowed = format!("a multiple of xi_s, which is {}", self.physics.xi_s);
                return Err(InputError::not_allowed(SOURCE, "xi_b", xi_b, allowed));
            }
            self.physics.xi_ratio = ratio;
        }
        self.check(SOURCE)
    }

    /// Sets one number by the name of its field and checks it; errors say it came from `source_name`.
    pub fn set_number(&mut self, source_name: &str, name: &str, value: f64) -> Result<(), InputError> {
        if let Some(field) = FIELDS.iter().find(|field| field.name == name) {
            let refuse = |allowed| InputError::not_allowed(source_name, name, value, allowed);
            (field.set)(self, &value.to_string()).map_err(refuse)?;
            if let Some((_, allowed)) = (field.valid)(self) {
                return Err(refuse(allowed));
            }
        }
        Ok(())
    }

    /// Checks every field; errors say the values came from `source_name`.
    pub fn check(&self, source_name: &str) -> Result<(), InputError> {
        for field in FIELDS {
            if let Some((value, allowed)) = (field.valid)(self) {
                let name = format!("{}.{}", field.section, field.name);
                return Err(InputError::not_allowed(source_name, name, value, allowed));
            }
        }
        Ok(())
    }
}

/// Reads a cue: `none`, a name of the lineage file, or `kappa:u0=0.465,omega=0.0577,amplitude=0.1` (what is not given
/// keeps the published value).
///
/// # Errors
/// Names the field, its value and what is allowed.
pub fn parse_cue(text: &str, lineage: &Lineage) -> Result<Cue, InputError> {
    const SOURCE: &str = "--cue";
    let Some(list) = text.strip_prefix("kappa:") else {
        return lineage.cue(text).ok_or_else(|| {
            let names: Vec<&str> = lineage.cues.keys().map(String::as_str).collect();
            let allowed = format!("none, {}, or kappa:u0=..,omega=..,amplitude=..", names.join(", "));
            InputError::not_allowed(SOURCE, "cue", format!("{text:?}"), allowed)
        });
    };
    let (mut u0, mut omega, mut amplitude) = (0.465, 0.0577, 0.1);
    for entry in list.split(',').map(str::trim).filter(|entry| !entry.is_empty()) {
        let (key, value) = entry.split_once('=').unwrap_or((entry, ""));
        let target = match key.trim() {
            "u0" => &mut u0,
            "omega" => &mut omega,
            "amplitude" => &mut amplitude,
            other => {
                let allowed = "one of u0, omega, amplitude";
                return Err(InputError::not_allowed(SOURCE, "kappa", format!("{other:?}"), allowed));
            }
        };
        let value = value.trim();
        *target = value.parse().map_err(|_| {
            InputError::not_allowed(SOURCE, format!("kappa.{}", key.trim()), format!("{value:?}"), "a number")
        })?;
    }
    let cue = Cue::Kappa { u0, omega, amplitude };
    check_cue(&cue, SOURCE, "kappa")?;
    Ok(cue)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A field added to the parameters must get its row in the table.
    #[test]
    fn table_covers_every_field() {
        for (section, value) in [
            ("physics", serde_json::to_value(Physics::default()).unwrap()),
            ("numerics", serde_json::to_value(Numerics::default()).unwrap()),
        ] {
            let mut of_type: Vec<&str> = value.as_object().unwrap().keys().map(String::as_str).collect();
            let mut of_table: Vec<&str> = FIELDS.iter().filter(|f| f.section == section).map(|f| f.name).collect();
            of_type.sort();
            of_table.sort();
            assert_eq!(of_type, of_table);
        }
    }

    #[test]
    fn preset_is_allowed() {
        Settings::default().check("preset").unwrap();
    }
}
