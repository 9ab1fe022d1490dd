//! User-defined parameters: a RON file, then `--set key=value`, with a check of each field.

use std::ops::RangeInclusive;
use std::path::Path;

use serde::Deserialize;

use crate::law::{ConstantName, Law};
use crate::profile::ELLIPSOID;
use crate::value::Kind;
pub use crate::value::Value;
use crate::{Cell, Cue, Numerics, Parameter, RigidityGradient, SIZES, Scheme, ShellChoice, ZYGOTE};
use furrow_input::{InputError, did_you_mean, parse_document, read_text, shown, shown_number};

/// Checked parameters of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// The cell, without a cue; for a tree the first cell.
    pub cell: Cell,
    /// Discretisation.
    pub numerics: Numerics,
    /// ξ_b, if it was given instead of its ratio to ξ_s; it does not change when [`set_number`](Settings::set_number) sets ξ_s.
    pub xi_b: Option<f64>,
}

impl Default for Settings {
    /// The preset `gao2026` and its zygote.
    fn default() -> Settings {
        Settings::of(Cell::new(ZYGOTE), Numerics::default())
    }
}

/// Presets by name: the differences from the first preset, as a configuration file.
const PRESETS: [(&str, &str); 3] = [
    ("gao2026", "Config()"),
    ("gao2026-thresholds", include_str!("../presets/gao2026-thresholds.ron")),
    ("sulston1983", include_str!("../presets/sulston1983.ron")),
];

/// Names of the presets; the first is the default.
pub fn presets() -> impl Iterator<Item = &'static str> {
    PRESETS.into_iter().map(|(name, _)| name)
}

/// A setter returns the allowed values if a value has the wrong kind.
type Set = fn(&mut Settings, &Value) -> Result<(), &'static str>;
/// A check returns the invalid value and the allowed values.
type Valid = fn(&Settings) -> Option<(String, &'static str)>;

struct Field {
    section: &'static str,
    name: &'static str,
    aliases: &'static [&'static str],
    set: Set,
    valid: Valid,
    get: fn(&Settings) -> Value,
    /// The [`Parameter`] of this field, if it has one.
    parameter: &'static [Number],
}

impl Field {
    fn named(name: &str) -> Option<&'static Field> {
        FIELDS.iter().find(|field| field.name == name)
    }
}

/// A row of the table that is a [`Parameter`].
pub(crate) struct Number {
    pub parameter: Parameter,
    pub get: fn(&Cell) -> f64,
    pub slot: fn(&mut Cell) -> &mut f64,
    pub validate: fn(f64) -> Result<(), &'static str>,
}

/// The table of parameters, from which RON files, `--set`, the checks, the listing and [`Parameter`] are generated.
macro_rules! fields {
    ($($section:ident $overrides:ident $shown:literal $part:ident $([$beside:ident])? {
        $($name:ident $([$($alias:literal),*])? at $place:expr => $kind:ty $(as $parameter:ident)?, $allowed:literal, |$v:ident| $ok:expr;)*
    })*) => {
        $(
            /// The settings of one section in a file; all others keep their values.
            #[derive(Deserialize, Default)]
            #[serde(default, deny_unknown_fields, rename = $shown)]
            pub struct $overrides {
                $($(#[serde($(alias = $alias),*)])? $name: Option<$kind>,)*
                $($beside: Option<f64>,)?
                #[serde(skip)]
                _fields: (),
            }

            impl $overrides {
                /// Sets the fields that the file gives.
                fn set(&self, settings: &mut Settings) {
                    let $part = &mut settings.$part;
                    $(if let Some(value) = self.$name { $place = value; })*
                }
            }
        )*

        const FIELDS: &[Field] = &[$($(
            Field {
                section: stringify!($section),
                name: stringify!($name),
                aliases: &[$($($alias),*)?],
                set: |settings, value| {
                    let $part = &mut settings.$part;
                    $place = <$kind as Kind>::of(value).ok_or($allowed)?;
                    Ok(())
                },
                valid: |settings| {
                    let $part = &settings.$part;
                    let $v: $kind = $place;
                    let ok: bool = $ok;
                    (!ok).then(|| ($v.to_string(), $allowed))
                },
                get: |settings| {
                    let $part = &settings.$part;
                    Kind::value($place)
                },
                parameter: &[$(Number {
                    parameter: Parameter::$parameter,
                    get: |$part| $place,
                    slot: |$part| &mut $place,
                    validate: |$v| if $ok { Ok(()) } else { Err($allowed) },
                })?],
            },
        )*)*];
    };
}

fields! {
    physics PhysicsOverrides "Physics" cell [xi_b] {
        kappa at cell.material.kappa => f64 as Kappa, "a finite number above 0", |v| v.is_finite() && v > 0.0;
        eta_b at cell.material.eta_b => f64 as EtaB, "a finite number above 0", |v| v.is_finite() && v > 0.0;
        eta_s at cell.material.eta_s => f64 as EtaS, "a finite number, 0 or above", |v| v.is_finite() && v >= 0.0;
        friction ["Gamma"] at cell.material.friction => f64 as Friction, "a finite number above 0", |v| v.is_finite() && v > 0.0;
        tension ["gamma"] at cell.material.tension => f64 as Tension, "a finite number", |v| v.is_finite();
        spontaneous_curvature ["C0"] at cell.material.spontaneous_curvature => f64 as SpontaneousCurvature, "a finite number", |v| v.is_finite();
        normal_friction at cell.material.normal_friction => f64 as NormalFriction, "a finite number, 0 or above", |v| v.is_finite() && v >= 0.0;
        xi_s ["xi"] at cell.xi_s => f64 as XiS, "a finite number", |v| v.is_finite();
        xi_ratio at cell.material.xi_ratio => f64 as XiRatio, "a number from -1e6 to 1e6", |v| RATIOS.contains(&v);
        gain ["g"] at cell.material.gain => f64 as Gain, "a finite number above 0", |v| v.is_finite() && v > 0.0;
        aspect ["a_over_b"] at cell.shell.aspect => f64 as Aspect, "a finite number above 0", |v| v.is_finite() && v > 0.0;
        p0 ["P0"] at cell.shell.p0 => f64 as P0, "a finite number above 0", |v| v.is_finite() && v > 0.0;
        w at cell.shell.w => f64 as W, "a finite number above 0", |v| v.is_finite() && v > 0.0;
        shell_flattening at cell.shell.flattening => f64 as Flattening, "from 0.65 to 1, the thickness between plates relative to a round shell", |v| (0.65..=1.0).contains(&v);
        r0 ["R0"] at cell.r0 => f64 as R0, "a finite number above 0, from 1e-6 to 1e6", |v| SIZES.contains(&v);
        epsilon ["eps"] at cell.epsilon => f64 as Epsilon, "above 0 and below 1", |v| v > 0.0 && v < 1.0;
        rigidity_gradient at cell.material.rigidity_gradient => RigidityGradient, "full or dropped", |_v| true;
    }
    numerics NumericsOverrides "Numerics" numerics {
        stages at numerics.stages => usize, "a whole number from 1 to 5", |v| (1..=5).contains(&v);
        intervals at numerics.intervals => usize, "an even whole number from 16 to 4096", |v| v.is_multiple_of(2) && (16..=4096).contains(&v);
        scheme at numerics.scheme => Scheme, "converged or published", |_v| true;
        dt at numerics.dt => f64, "above 0 and at most 10", |v| v > 0.0 && v <= 10.0;
        first_step at numerics.first_step => f64, "from 1e-6 to 0.1", |v| (1e-6..=0.1).contains(&v);
        time_tolerance at numerics.time_tolerance => f64, "from 1e-9 to 0.1", |v| (1e-9..=GREATEST_TIME_TOLERANCE).contains(&v);
        step_factor at numerics.step_factor => f64, "from 0.1 to 1", |v| (0.1..=1.0).contains(&v);
        t_max at numerics.t_max => f64, "a finite number above 0", |v| v.is_finite() && v > 0.0;
        noise at numerics.noise => f64, "0 or above and below 1", |v| (0.0..1.0).contains(&v);
        noise_time at numerics.noise_time => f64, "0, or from 0.001 to 1000", |v| v == 0.0 || (1e-3..=1e3).contains(&v);
        chi_symmetric at numerics.chi_symmetric => f64, "0 or above and below 1", |v| (0.0..1.0).contains(&v);
        modes at numerics.modes => usize, "a whole number from 0 (with axial symmetry) to 12", |v| (0..=12).contains(&v);
        elements at numerics.elements => usize, "a whole number from 32 to 256", |v| (32..=256).contains(&v);
        contact at numerics.contact => bool, "true or false", |_v| true;
    }
}

/// The configuration file; a setting that it omits keeps the preset's value.
#[derive(Deserialize, Default)]
#[serde(default, deny_unknown_fields)]
struct Config {
    shell_profile: Option<String>,
    physics: PhysicsOverrides,
    numerics: NumericsOverrides,
}

impl Settings {
    /// A cell and its discretisation.
    pub const fn of(cell: Cell, numerics: Numerics) -> Settings {
        Settings { cell, numerics, xi_b: None }
    }

    /// The parameters of a preset and its zygote.
    ///
    /// ```
    /// use furrow_cell::settings::Settings;
    ///
    /// assert_eq!(Settings::preset("gao2026")?, Settings::default());
    /// assert_eq!(Settings::preset("gao2026-thresholds")?.cell, furrow_cell::Cell::gao2026_thresholds(furrow_cell::ZYGOTE));
    /// assert!(Settings::preset("sulston1983")?.cell.shell.p0 < 0.123);
    /// assert!(Settings::preset("sulston").is_err());
    /// # Ok::<(), furrow_input::InputError>(())
    /// ```
    ///
    /// # Errors
    /// The name is not a preset.
    pub fn preset(name: &str) -> Result<Settings, InputError> {
        let Some((_, text)) = PRESETS.into_iter().find(|(known, _)| *known == name) else {
            let names: Vec<&str> = presets().collect();
            let allowed = format!("one of {}{}", names.join(", "), did_you_mean(name, presets()));
            return Err(InputError::not_allowed("settings", "preset", shown(name), allowed));
        };
        let mut settings = Settings::default();
        settings.apply_config(text, name)?;
        Ok(settings)
    }

    /// A preset with the parameters of a configuration file, if any, the law of a file or a name, if any, and then
    /// `overrides` of the form `key=value`.
    ///
    /// Keys are the fields of [`Cell`], its material and shell, the fields of [`Numerics`], and the aliases `xi`, `g`, `eps`, `a_over_b`, `P0` (the
    /// shell's strength), `R0`, `Gamma`, `gamma`, `C0`. Besides these, `xi_b` sets `xi_ratio` = ξ_b/ξ_s from the ξ_s that all
    /// settings together give: the ratio stays constant if ξ_s varies afterwards. `law.NAME` sets a constant of the law.
    ///
    /// # Errors
    /// Names the file or option, the field, its value and the allowed ones.
    pub fn load(
        preset: &str,
        config: Option<&Path>,
        law: Option<&Path>,
        overrides: &[String],
    ) -> Result<Settings, InputError> {
        Settings::preset(preset)?.with(config, law, overrides)
    }

    /// These settings with a configuration file, a law and overrides, as in [`Settings::load`].
    ///
    /// # Errors
    /// As [`Settings::load`].
    pub fn with(
        mut self,
        config: Option<&Path>,
        law: Option<&Path>,
        overrides: &[String],
    ) -> Result<Settings, InputError> {
        if let Some(path) = law {
            self.cell.law = Law::read(path)?.map(Box::new);
        }
        if let Some(path) = config {
            let file = path.display().to_string();
            self.apply_config(&read_text(path)?, &file)?;
        }
        self.apply_overrides(overrides)?;
        Ok(self)
    }

    /// Applies and checks the text of a configuration file.
    pub fn apply_config(&mut self, text: &str, file: &str) -> Result<(), InputError> {
        let config: Config = parse_document(text, file, "a configuration", "Config")?;
        if let Some(table) = config.shell_profile {
            // The path is relative to the file that contains it.
            let folder = Path::new(file).parent().unwrap_or(Path::new(""));
            self.set_shell_profile(file, &Value::Text(table), folder)?;
        }
        self.apply_physics(&config.physics, file)?;
        self.apply_numerics(&config.numerics);
        self.check(file)
    }

    /// Sets the physics of a file; `xi_b` from the ξ_s that is then in force.
    ///
    /// # Errors
    /// `xi_b` beside `xi_ratio`, and a ratio out of its range; errors say it came from `file`.
    pub fn apply_physics(&mut self, given: &PhysicsOverrides, file: &str) -> Result<(), InputError> {
        given.set(self);
        let ratio = [(XI_RATIO, given.xi_ratio), (XI_B, given.xi_b)];
        let ratio = ratio.into_iter().filter_map(|(name, value)| Some((name, Value::Number(value?))));
        self.assign(file, &ratio.collect::<Vec<_>>())
    }

    /// Sets the numerics of a file.
    pub fn apply_numerics(&mut self, given: &NumericsOverrides) {
        given.set(self);
    }

    /// Applies and checks `key=value` settings, in order; `xi_b` last.
    ///
    /// # Errors
    /// Names the key, its value and the allowed ones.
    pub fn apply_overrides(&mut self, overrides: &[String]) -> Result<(), InputError> {
        self.override_fields(&Overrides::read(overrides)?)?;
        self.check(OVERRIDES)
    }

    /// Applies settings and checks each field separately, since other fields may still change.
    ///
    /// # Errors
    /// Names the key, its value and the allowed ones.
    pub fn override_fields(&mut self, Overrides { source_name, pairs }: &Overrides) -> Result<(), InputError> {
        self.assign(source_name, pairs)?;
        self.check_fields(source_name)
    }

    /// Sets fields by their [canonical names](canonical_name), in order; `xi_b` comes last, uses the final ξ_s, and excludes
    /// `xi_ratio`, which it sets. [`check`](Self::check) checks the values.
    ///
    /// # Errors
    /// A value has the wrong kind for its field; errors name the source `source_name`.
    pub fn assign(&mut self, source_name: &str, pairs: &[(&str, Value)]) -> Result<(), InputError> {
        let given = |wanted: &str| pairs.iter().find(|(name, _)| *name == wanted);
        if let (Some((_, xi_b)), Some(_)) = (given(XI_B), given(XI_RATIO)) {
            let allowed = format!("left out where {XI_RATIO} is given, which it sets");
            return Err(InputError::not_allowed(source_name, XI_B, xi_b, allowed));
        }
        for (name, value) in pairs {
            let refuse = |allowed: &str| InputError::not_allowed(source_name, *name, value, allowed);
            if *name == SHELL_PROFILE {
                self.set_shell_profile(source_name, value, Path::new(""))?;
            } else if *name == XI_B {
                let read = value.number().filter(|v| v.is_finite());
                self.xi_b = Some(read.ok_or_else(|| refuse("a finite number"))?);
            } else if let Some(field) = Field::named(name) {
                (field.set)(self, value).map_err(refuse)?;
                self.xi_b = self.xi_b.filter(|_| *name != XI_RATIO);
            } else if let Some(constant) = ConstantName::read(name) {
                self.set_constant(constant, value).map_err(|allowed| refuse(&allowed))?;
            }
        }
        self.keep_xi_b(source_name)
    }

    /// Sets the ratio ξ_b/ξ_s if ξ_b was given.
    fn keep_xi_b(&mut self, source_name: &str) -> Result<(), InputError> {
        let Some(xi_b) = self.xi_b else { return Ok(()) };
        let ratio = xi_b / self.cell.xi_s;
        if !RATIOS.contains(&ratio) {
            let allowed = format!("from -1e6 to 1e6 times xi_s, which is {}", self.cell.xi_s);
            return Err(InputError::not_allowed(source_name, XI_B, xi_b, allowed));
        }
        self.cell.material.xi_ratio = ratio;
        Ok(())
    }

    /// Sets the profile of the shell from a table in a folder, with its aspect ratio, or to the ellipsoid.
    ///
    /// # Errors
    /// As [`ShellChoice::named`]. Errors name the source `source_name`.
    fn set_shell_profile(&mut self, source_name: &str, given: &Value, folder: &Path) -> Result<(), InputError> {
        let text = given.text();
        let refused = |allowed| InputError::not_allowed(source_name, SHELL_PROFILE, shown(&text), allowed);
        ShellChoice::named(&text, folder, refused)?.apply(&mut self.cell);
        Ok(())
    }

    /// Sets a constant of the law.
    ///
    /// # Errors
    /// The allowed constants, or values.
    fn set_constant(&mut self, name: ConstantName, value: &Value) -> Result<(), String> {
        let Some(slot) = self.cell.law.as_mut().and_then(|law| law.constant_mut(name)) else {
            return Err(Parameter::allowed_of_law(&self.cell, name));
        };
        *slot = value.number().filter(|value| value.is_finite()).ok_or("a finite number")?;
        Ok(())
    }

    /// Sets one number by the name of its field, or of the law's constant, and checks it; errors name the source `source_name`.
    pub fn set_number(&mut self, source_name: &str, name: &str, value: f64) -> Result<(), InputError> {
        if let Some(constant) = ConstantName::read(name) {
            let set = self.set_constant(constant, &Value::Number(value));
            return set.map_err(|allowed| InputError::not_allowed(source_name, name, value, allowed));
        }
        let set = Field::named(name).map_or(Ok(()), |field| (field.set)(self, &Value::Number(value)));
        let checked = set.and_then(|()| self.validate(name));
        checked.map_err(|allowed| InputError::not_allowed(source_name, name, value, allowed))?;
        self.xi_b = self.xi_b.filter(|_| name != XI_RATIO);
        self.keep_xi_b(source_name)
    }

    /// Checks one field, given by its [canonical name](canonical_name).
    ///
    /// # Errors
    /// The allowed values.
    pub fn validate(&self, name: &str) -> Result<(), &'static str> {
        Field::named(name).and_then(|field| (field.valid)(self)).map_or(Ok(()), |(_, allowed)| Err(allowed))
    }

    /// Checks every field separately; errors name the source `source_name`.
    pub fn check_fields(&self, source_name: &str) -> Result<(), InputError> {
        for field in FIELDS {
            if let Some((value, allowed)) = (field.valid)(self) {
                let name = format!("{}.{}", field.section, field.name);
                return Err(InputError::not_allowed(source_name, name, value, allowed));
            }
        }
        Ok(())
    }

    /// Checks every field and their combinations; errors name the source `source_name`.
    pub fn check(&self, source_name: &str) -> Result<(), InputError> {
        self.check_fields(source_name)?;
        let Numerics { scheme, dt, modes, elements, contact, .. } = self.numerics;
        let usual = Numerics::default();
        let used = scheme == Scheme::Published || dt == usual.dt;
        let allowed = "given with scheme = published alone: the converged scheme chooses its own steps";
        InputError::require(used, source_name, "numerics.dt", dt, allowed)?;
        let allowed =
            "given with modes above 0 alone (--three-dimensional): the solver with axial symmetry does not use it";
        let used = modes > 0 || elements == usual.elements;
        InputError::require(used, source_name, "numerics.elements", elements, allowed)?;
        let used = modes > 0 || contact == usual.contact;
        InputError::require(used, source_name, "numerics.contact", contact, allowed)?;
        self.check_law(source_name)?;
        self.check_shell(source_name)
    }

    /// Rejects a law that is not finite with its constants, and a law that needs axial symmetry in a cell without it.
    fn check_law(&self, source_name: &str) -> Result<(), InputError> {
        self.cell.check_law(source_name)?;
        let modes = self.numerics.modes;
        let Some(law) = self.cell.law.as_ref().filter(|_| modes > 0) else { return Ok(()) };
        let Some(reason) = law.needs_axis(&self.cell) else { return Ok(()) };
        let allowed = format!("0 with the law {}: {reason}", shown(law.name()));
        Err(InputError::not_allowed(source_name, "modes", modes, allowed))
    }

    /// Rejects a user-defined law, for computations that support only the paper's law.
    ///
    /// # Errors
    /// Names the law; errors mention the requested `what`.
    pub fn check_paper_law(&self, what: &str) -> Result<(), InputError> {
        let Some(law) = &self.cell.law else { return Ok(()) };
        let allowed = format!("paper, the built-in law, for {what}");
        Err(InputError::not_allowed("--law", "law", shown(law.name()), allowed))
    }

    /// Rejects a user-defined law and a shell with a profile, for computations that support only the paper's model.
    ///
    /// # Errors
    /// Names the law or the profile; errors mention the requested `what`.
    pub fn check_paper_model(&self, what: &str) -> Result<(), InputError> {
        self.check_paper_law(what)?;
        let Some(profile) = &self.cell.shell_profile else { return Ok(()) };
        let allowed = format!("{ELLIPSOID}, the shell without a table, for {what}");
        Err(InputError::not_allowed("settings", SHELL_PROFILE, shown(profile.name()), allowed))
    }

    /// Rejects a one-sided cue for axisymmetric cells.
    ///
    /// # Errors
    /// Names the cue and the source `source_name`.
    pub fn check_cue(&self, source_name: &str, cue: &Cue) -> Result<(), InputError> {
        let fine = self.numerics.modes > 0 || !cue.is_one_sided();
        InputError::require(
            fine,
            source_name,
            "cue",
            cue,
            "without at=PHI for cells with axial symmetry, whose modes are 0",
        )
    }

    /// Checks whether the shell is axisymmetric if cells are, and whether the mesh has enough intervals to resolve the width of its
    /// wall: a fixed number of intervals per part of the contour as long as the wall is wide. With fewer, pitchforks were off by more
    /// than 1e-4 (with 48 at w = 0.01 by 5e-3, on the wrong side and with the wrong criticality).
    ///
    /// # Errors
    /// Gives the smallest w for the number of intervals, and the source `source_name`.
    pub fn check_shell(&self, source_name: &str) -> Result<(), InputError> {
        let (flattening, name) = (self.cell.shell.flattening, "physics.shell_flattening");
        let fine = flattening == 1.0 || self.numerics.modes >= 2;
        InputError::require(fine, source_name, name, flattening, "1 for cells with axial symmetry, whose modes are 0")?;
        let (w, intervals) = (self.cell.shell.w, self.numerics.intervals);
        let least = INTERVALS_OF_WALL / intervals as f64;
        if w >= least * (1.0 - 1e-9) {
            return Ok(());
        }
        let fine = 2 * (0.5 * INTERVALS_OF_WALL / w).ceil().min(1e9) as usize;
        let allowed = if fine <= MOST_INTERVALS {
            format!("at least {least:.3e} where numerics.intervals = {intervals}; or set intervals to {fine}")
        } else {
            let least = INTERVALS_OF_WALL / MOST_INTERVALS as f64;
            format!("at least {least:.3e}, with numerics.intervals = {MOST_INTERVALS}")
        };
        Err(InputError::not_allowed(source_name, "physics.w", w, allowed))
    }

    /// Checks whether divisions can be computed with these numerics; stationary shapes require less.
    pub fn check_divisions(&self, source_name: &str) -> Result<(), InputError> {
        let Numerics { stages, intervals, step_factor, time_tolerance, .. } = self.numerics;
        let least = self.numerics.least_intervals();
        if intervals < least {
            let allowed = format!("at least {least} where numerics.stages = {stages}");
            return Err(InputError::not_allowed(source_name, "numerics.intervals", intervals, allowed));
        }
        let least = self.numerics.least_time_tolerance();
        if time_tolerance < least {
            let allowed = format!("at least {least:.1e} where numerics.step_factor = {step_factor}");
            return Err(InputError::not_allowed(source_name, "numerics.time_tolerance", time_tolerance, allowed));
        }
        Ok(())
    }

    /// Rejects azimuthal modes, for commands with axisymmetric equations.
    pub fn check_axisymmetric(&self, source_name: &str) -> Result<(), InputError> {
        let modes = self.numerics.modes;
        let allowed = "0: only divisions, trees, states at rest, phase diagrams and the boundary of division over R0 or ε can be computed without axial symmetry";
        InputError::require(modes == 0, source_name, "modes", modes, allowed)
    }

    /// Checks the activity of a cell for computations at this activity; errors name the source `source_name`. Branches, curves
    /// and diagrams vary ξ_s and ignore it.
    pub fn check_activity(&self, source_name: &str) -> Result<(), InputError> {
        let Cell { xi_s, ref material, ref law, .. } = self.cell;
        if law.is_some() {
            // The meaning of ξ_s depends on the law.
            return Ok(());
        }
        // The motion depends on the ratio of active stress to rigidity.
        let [least, most] = STRESS.map(|stress| stress * (material.kappa / material.gain));
        if (least..=most).contains(&xi_s) {
            return Ok(());
        }
        let [least, most] = [least, most].map(|end| shown_number(four_digits(end)));
        let [kappa, gain] = [material.kappa, material.gain].map(shown_number);
        let allowed = format!("from {least} to {most} where kappa = {kappa} and gain = {gain}");
        Err(InputError::not_allowed(source_name, "xi_s", xi_s, allowed))
    }
}

/// The first four digits of a number.
fn four_digits(value: f64) -> f64 {
    let decimals = (3.0 - value.abs().log10().floor()).clamp(0.0, 300.0);
    let scale = 10f64.powf(decimals);
    (value * scale).trunc() / scale
}

/// The source of settings of the form `key=value` in errors.
const OVERRIDES: &str = "--set";

/// Parameters that override those in a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overrides {
    /// Their source in errors.
    pub source_name: &'static str,
    /// Their [canonical names](canonical_name) and values, in the order in which they are set.
    pub pairs: Vec<(&'static str, Value)>,
}

impl Overrides {
    /// Parses the entries of `--set`, which have the form `key=value`.
    ///
    /// # Errors
    /// An entry has another form, or a key is unknown.
    pub fn read(entries: &[String]) -> Result<Overrides, InputError> {
        let pair = |entry: &String| {
            let bare = || InputError::not_allowed(OVERRIDES, "setting", format!("{entry:?}"), "of the form key=value");
            let (key, value) = entry.split_once('=').ok_or_else(bare)?;
            let refuse = |allowed| InputError::not_allowed(OVERRIDES, "key", shown(key.trim()), allowed);
            Ok((canonical_name(key.trim()).map_err(refuse)?, Value::Text(value.trim().to_owned())))
        };
        Ok(Overrides { source_name: OVERRIDES, pairs: entries.iter().map(pair).collect::<Result<_, InputError>>()? })
    }
}

/// The rows of the table that are parameters, with their names and aliases.
pub(crate) fn parameters() -> impl Iterator<Item = (&'static Number, &'static str, &'static [&'static str])> {
    FIELDS.iter().flat_map(|field| field.parameter.iter().map(|number| (number, field.name, field.aliases)))
}

/// The key that sets `xi_ratio` from the final ξ_s.
const XI_B: &str = "xi_b";

/// The number that `xi_b` sets.
const XI_RATIO: &str = "xi_ratio";

/// The number that a field sets, by its canonical name: `xi_b` sets `xi_ratio`.
pub fn number_set_by(name: &'static str) -> &'static str {
    if name == XI_B { XI_RATIO } else { name }
}

/// The key that sets the shell's profile from a table, and with it `aspect`.
pub const SHELL_PROFILE: &str = "shell_profile";

/// The name of the field for a key of `--set`: aliases are resolved and the section is removed. A constant of a law
/// keeps its prefix `law.`; its existence is checked when it is set.
///
/// ```
/// use furrow_cell::settings::canonical_name;
///
/// assert_eq!(canonical_name("physics.eps"), Ok("epsilon"));
/// assert!(canonical_name("numerics.eps").is_err());
/// ```
///
/// # Errors
/// Lists the keys.
pub fn canonical_name(key: &str) -> Result<&'static str, String> {
    if let Some(name) = ConstantName::read(key) {
        return Ok(name.whole());
    }
    let (section, plain) = match key.split_once('.') {
        Some((section @ ("physics" | "numerics"), plain)) => (Some(section), plain),
        _ => (None, key),
    };
    // If the key has a section, the parameter must be in this section.
    let misplaced = |right: &str| section.is_some_and(|section| section != right);
    if let Some(name) = [XI_B, SHELL_PROFILE].into_iter().find(|name| *name == plain) {
        return if misplaced("physics") { Err(format!("physics.{name} or {name} alone")) } else { Ok(name) };
    }
    match FIELDS.iter().find(|field| field.name == plain || field.aliases.contains(&plain)) {
        Some(field) if misplaced(field.section) => Err(format!("{}.{plain} or {plain} alone", field.section)),
        Some(field) => Ok(field.name),
        None => {
            let nearest = did_you_mean(plain, names().chain(FIELDS.iter().flat_map(|f| f.aliases).copied()));
            Err(format!("one of {}{nearest}", names().collect::<Vec<_>>().join(", ")))
        }
    }
}

/// The canonical names of all keys.
pub fn names() -> impl Iterator<Item = &'static str> + Clone {
    FIELDS.iter().map(|field| field.name).chain([XI_B, SHELL_PROFILE])
}

/// Number of intervals of the whole contour for a wall of width w = 1.
const INTERVALS_OF_WALL: f64 = 0.96;

/// Largest initial number of mesh intervals.
pub const MOST_INTERVALS: usize = 4096;

/// Largest allowed error per time step.
pub const GREATEST_TIME_TOLERANCE: f64 = 0.1;

/// Values of ξ_b/ξ_s.
const RATIOS: RangeInclusive<f64> = -1e6..=1e6;

/// Smallest and largest active stress g ξ_s/κ for which the first time steps converge.
const STRESS: [f64; 2] = [-150.0, 75.0];

/// Names and values of all parameters by section, for reports.
pub fn listing(settings: &Settings) -> Vec<(&'static str, &'static str, Value)> {
    FIELDS.iter().map(|field| (field.section, field.name, (field.get)(settings))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A new field of the parameters needs a row in the table.
    #[test]
    fn the_activity_of_total_curvature_is_kept_when_the_other_is_set_later() {
        let mut settings = Settings::default();
        settings.apply_overrides(&["xi_b=-2".to_owned()]).unwrap();
        settings.set_number("--xi", "xi_s", 20.0).unwrap();
        assert_eq!(settings.cell.material.xi_ratio, -0.1);
        settings.set_number("--set", "xi_ratio", -0.2).unwrap();
        settings.set_number("--xi", "xi_s", 10.0).unwrap();
        assert_eq!(settings.cell.material.xi_ratio, -0.2);
    }

    #[test]
    fn table_covers_every_field() {
        let Settings { cell: Cell { mut material, mut shell, .. }, numerics, xi_b: _ } = Settings::default();
        // A round shell is written without its flattening, and neither spontaneous curvature nor normal friction is written if it is 0.
        (shell.flattening, material.spontaneous_curvature, material.normal_friction) = (0.9, 0.1, 0.1);
        let parts = [serde_json::to_value(material), serde_json::to_value(shell), serde_json::to_value(numerics)];
        let mut numbers = vec!["r0".to_owned(), "epsilon".to_owned(), "xi_s".to_owned()];
        for part in parts {
            numbers.extend(part.unwrap().as_object().unwrap().keys().cloned());
        }
        let mut of_table: Vec<&str> = FIELDS.iter().map(|f| f.name).collect();
        numbers.sort();
        of_table.sort();
        assert_eq!(numbers, of_table);
        Settings::default().check("preset").unwrap();
    }
}
