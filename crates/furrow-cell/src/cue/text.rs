//! Cues as text, on the command line and in files: `none`, or terms `FIELD:PROFILE,key=value,…` joined by `+`. One term may be a
//! regulator.
//!
//! Parsing the printed text gives the same cue: [`Display`](std::fmt::Display) writes every number with enough digits to recover it
//! exactly.

use std::fmt;
use std::str::FromStr;

use super::profile::NAMES;
use super::regulator_text;
use super::{Cue, CueError, Field, ParConstants, Profile, Quantity, Scale, Side, Term, Width, WrittenCue, par};
use crate::settings::Value;
use furrow_input::{did_you_mean, shown};

impl fmt::Display for Term {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:", self.field.name())?;
        write_spread(f, &self.profile, self.amplitude)?;
        self.side.map_or(Ok(()), |Side { at, spread }| write!(f, ",at={at},spread={spread}"))
    }
}

/// Writes A f.
pub(super) fn write_spread(f: &mut fmt::Formatter<'_>, profile: &Profile, amplitude: f64) -> fmt::Result {
    f.write_str(profile.name())?;
    if let (Some(u0), Some(width)) = (profile.quantity(Quantity::U0), profile.width()) {
        let unit = if matches!(width, Width::Length(_)) { "Lh" } else { "" };
        write!(f, ",u0={u0},omega={}{unit}", width.value())?;
    }
    if let Profile::Par { far, constants, length_um, .. } = profile {
        f.write_str(if *far { ",u0=1" } else { "" })?;
        let length = length_um.map(|um| (LENGTH, um.to_string()));
        constants.stated().into_iter().chain(length).try_for_each(|(name, value)| write!(f, ",{name}={value}"))?;
    }
    write!(f, ",amplitude={amplitude}")
}

impl fmt::Display for Cue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts = self.terms().iter().map(Term::to_string).chain(self.regulator().map(ToString::to_string));
        let parts: Vec<String> = parts.collect();
        f.write_str(if parts.is_empty() { "none".to_owned() } else { parts.join("+") }.as_str())
    }
}

/// The parts of a sum: text between `+` signs that belong neither to an exponent (`1e+3`) nor to a number (`=+0.1`).
pub fn split_terms(text: &str) -> Vec<&str> {
    let bytes = text.as_bytes();
    let mut parts = Vec::new();
    let mut from = 0;
    for (i, _) in text.match_indices('+') {
        let exponent = i >= 2
            && matches!(bytes[i - 1], b'e' | b'E')
            && (bytes[i - 2].is_ascii_digit() || bytes[i - 2] == b'.')
            && bytes.get(i + 1).is_some_and(u8::is_ascii_digit);
        let sign = i >= 1 && bytes[i - 1] == b'=';
        if !(exponent || sign) {
            parts.push(text[from..i].trim());
            from = i + 1;
        }
    }
    parts.push(text[from..].trim());
    parts
}

/// Numbers given for one A f, before they are checked for completeness.
#[derive(Default)]
pub(super) struct Numbers {
    pub u0: Option<f64>,
    pub omega: Option<Width>,
    /// Whether the width is in µm.
    pub micrometres: bool,
    pub amplitude: Option<f64>,
    /// Angle and width of a side, in radians.
    pub at: Option<f64>,
    pub spread: Option<f64>,
    /// Constants of PAR polarity, the names of the given ones, and L_h in µm.
    par: ParConstants,
    par_names: Vec<&'static str>,
    length_um: Option<f64>,
}

/// The key of L_h in µm.
const LENGTH: &str = "length_um";

impl Numbers {
    /// The profile and its amplitude, if exactly the required numbers are given. `name` is its name in errors.
    pub fn profile(self, name: &str, profile: &str) -> Result<(Profile, f64), CueError> {
        let missing = |quantity: Quantity| {
            let field = format!("{name}.{}", quantity.name());
            CueError::new(field, "(not given)", format!("given: a {profile} has no default for it"))
        };
        if let Some(spare) = self.par_names.first().filter(|_| !profile.starts_with("par")) {
            let allowed = "left out: only par and par_band have it";
            return Err(CueError::new(format!("{name}:{profile}"), shown(spare), allowed));
        }
        let Numbers { par: constants, length_um, .. } = self;
        let profile = match (profile, self.u0, self.omega) {
            ("gradient", None, None) => Profile::Gradient,
            ("gradient", u0, _) => {
                let spare = if u0.is_some() { Quantity::U0 } else { Quantity::Omega };
                let allowed = "left out: this profile does not have it";
                return Err(CueError::new(format!("{name}:{profile}"), shown(spare.name()), allowed));
            }
            ("band" | "step", u0, omega) => {
                let u0 = u0.ok_or_else(|| missing(Quantity::U0))?;
                let omega = omega.ok_or_else(|| missing(Quantity::Omega))?;
                if profile == "band" { Profile::Band { u0, omega } } else { Profile::Step { u0, omega } }
            }
            ("par" | "par_band", u0, None) if u0.is_none_or(|u0| u0 == 0.0 || u0 == 1.0) => {
                Profile::Par { band: profile == "par_band", far: u0 == Some(1.0), constants, length_um }
            }
            ("par" | "par_band", u0, omega) => {
                let (field, value, allowed) = match (u0, omega) {
                    (_, Some(omega)) => ("omega", omega.value(), "left out: it follows from PAR polarity"),
                    (u0, _) => {
                        ("u0", u0.unwrap_or(0.0), "0 or 1, the posterior pole: its place follows from PAR polarity")
                    }
                };
                return Err(CueError::new(format!("{name}.{field}"), value, allowed));
            }
            _ => return Err(CueError::new(name, shown(profile), one_of(&NAMES, profile))),
        };
        let amplitude = self.amplitude.ok_or_else(|| missing(Quantity::Amplitude))?;
        Ok((profile, amplitude))
    }

    /// The side of the axis, if one is given.
    fn side(&self, name: &str) -> Result<Option<Side>, CueError> {
        let missing = |key: &str, other: &str| {
            let allowed = format!("given beside {other}, in radians, or in degrees, as 60deg");
            Err(CueError::new(format!("{name}.{key}"), "(not given)", allowed))
        };
        match (self.at, self.spread) {
            (None, None) => Ok(None),
            (Some(at), Some(spread)) => Ok(Some(Side { at, spread })),
            (Some(_), None) => missing("spread", "at"),
            (None, Some(_)) => missing("at", "spread"),
        }
    }

    /// The term of a field with these numbers.
    pub fn term(self, field: Field, profile: &str) -> Result<WrittenCue, CueError> {
        let (micrometres, side) = (self.micrometres, self.side(field.name())?);
        let (profile, amplitude) = self.profile(field.name(), profile)?;
        Ok(WrittenCue::term(Term { field, profile, amplitude, side }, micrometres))
    }
}

/// Lists the names, and suggests the one nearest to the given text.
fn one_of(names: &[&str], written: &str) -> String {
    format!("one of {}{}", names.join(", "), did_you_mean(written, names.iter().copied()))
}

/// The field with a given name.
pub(super) fn field(name: &str) -> Result<Field, CueError> {
    let known = Field::ALL.into_iter().find(|field| field.name() == name);
    let allowed = || format!("a field: {}", one_of(&Field::ALL.map(Field::name), name));
    known.ok_or_else(|| CueError::new("cue", shown(name), allowed()))
}

/// The field with a given name, for a term or a regulator.
fn field_of_term(name: &str) -> Result<Field, CueError> {
    let names = || Field::ALL.map(Field::name).into_iter().chain([REGULATOR]);
    let fields = Field::ALL.map(Field::name).join(", ");
    let allowed = || format!("a field, one of {fields}, or {REGULATOR}{}", did_you_mean(name, names()));
    field(name).map_err(|error| CueError { allowed: allowed(), ..error })
}

fn parse_term(text: &str) -> Result<WrittenCue, CueError> {
    let Some((name, list)) = text.split_once(':') else {
        let is_field = starts_with_field(text);
        let allowed = match (text.is_empty(), is_field) {
            (true, _) => "a term: there is nothing before, between or behind +",
            (_, true) => "a term FIELD:PROFILE,key=value,.. with a colon after the field",
            _ => "none, or terms FIELD:PROFILE,key=value,.. joined by +",
        };
        return Err(CueError::new("cue", shown(text), allowed));
    };
    if name.trim() == REGULATOR {
        return regulator_text::parse(list);
    }
    let field = field_of_term(name.trim())?;
    let name = field.name();
    let (profile, entries) = entries(name, list, &NAMES);
    let profile = profile?.unwrap_or(NAMES[0]);
    let mut numbers = Numbers::default();
    for entry in entries {
        let (key, value) = key_and_value(&format!("{name}:{profile}"), entry)?;
        if !numbers.set(name, key, value)? && !numbers.set_side(name, key, value)? {
            let mut known = Vec::from(Quantity::ALL.map(Quantity::name));
            if profile.starts_with("par") {
                known.extend(par::names().chain([LENGTH]));
            }
            known.extend([AT, SPREAD]);
            let allowed = one_of(&known, key);
            return Err(CueError::new(format!("{name}:{profile}"), shown(key), allowed));
        }
    }
    numbers.term(field, profile)
}

/// Keys of a side.
const AT: &str = "at";
const SPREAD: &str = "spread";

/// Whether a text begins like a term or a regulator.
pub fn starts_with_field(text: &str) -> bool {
    Field::ALL.map(Field::name).into_iter().chain([REGULATOR]).any(|name| text.starts_with(name))
}

/// The word that replaces the name of a field in a regulator.
pub(super) const REGULATOR: &str = "regulator";

/// The profile at the start of a list, if one is given, and the remaining entries.
pub(super) fn entries<'a>(
    name: &str,
    list: &'a str,
    profiles: &[&'static str],
) -> (Result<Option<&'a str>, CueError>, impl Iterator<Item = &'a str>) {
    let mut entries = list.split(',').map(str::trim).peekable();
    let profile = entries.next_if(|first| !first.contains('='));
    let known = profile.is_none_or(|profile| profiles.contains(&profile));
    let unknown = |profile: &str| {
        let allowed = format!("one of {}{}", profiles.join(", "), did_you_mean(profile, profiles.iter().copied()));
        CueError::new(name, shown(profile), allowed)
    };
    (if known { Ok(profile) } else { Err(unknown(profile.unwrap_or_default())) }, entries)
}

/// The two sides of `key=value`.
pub(super) fn key_and_value<'a>(part: &str, entry: &'a str) -> Result<(&'a str, &'a str), CueError> {
    let allowed = "key=value, set off by single commas";
    let (key, value) = entry.split_once('=').ok_or_else(|| CueError::new(part, shown(entry), allowed))?;
    Ok((key.trim(), value.trim()))
}

/// The number before a unit, if the unit is present; the µ of µm has three spellings.
pub(super) fn without_unit<'a>(value: &'a str, unit: &str) -> Option<&'a str> {
    let behind_mu = unit.strip_prefix('u').filter(|rest| rest.starts_with('m'));
    let others = behind_mu.into_iter().flat_map(|rest| ['µ', 'μ'].map(|mu| format!("{mu}{rest}")));
    others.chain([unit.to_owned()]).find_map(|unit| value.strip_suffix(unit.as_str())).map(str::trim_end)
}

/// The value of a key as a number.
pub(super) fn number(name: &str, key: &str, text: &str, value: &str, allowed: &str) -> Result<f64, CueError> {
    text.parse().map_err(|_| CueError::new(format!("{name}.{key}"), shown(value), allowed))
}

/// Rejects a key that is given twice.
pub(super) fn once(repeated: bool, name: &str, key: &str, value: &str) -> Result<(), CueError> {
    let twice = || CueError::new(format!("{name}.{key}"), shown(value), "given once: it is given twice");
    if repeated { Err(twice()) } else { Ok(()) }
}

impl Numbers {
    /// Stores a value if its key is one of these numbers. `name` is the name of the part of the cue in errors.
    pub fn set(&mut self, name: &str, key: &str, value: &str) -> Result<bool, CueError> {
        let plain = || number(name, key, value, value, "a number");
        let repeated = match key {
            "u0" => self.u0.replace(plain()?).is_some(),
            "amplitude" => self.amplitude.replace(plain()?).is_some(),
            "omega" => {
                const ALLOWED: &str = "a number, in u, or with Lh or um behind it in L_h or µm";
                let micrometres = without_unit(value, "um");
                self.micrometres = micrometres.is_some();
                let length = micrometres.or_else(|| value.strip_suffix("Lh").map(str::trim_end));
                let omega = number(name, key, length.unwrap_or(value), value, ALLOWED)?;
                self.omega
                    .replace(if length.is_some() { Width::Length(omega) } else { Width::Fraction(omega) })
                    .is_some()
            }
            LENGTH => {
                let um = plain()?;
                if !(um.is_finite() && um > 0.0) {
                    return Err(CueError::new(format!("{name}.{key}"), shown(value), "a finite number above 0, in µm"));
                }
                self.length_um.replace(um).is_some()
            }
            _ => {
                let Some(known) = par::names().find(|known| *known == key) else { return Ok(false) };
                if let Some(Err(allowed)) = self.par.put(key, &Value::Text(value.to_owned())) {
                    return Err(CueError::new(format!("{name}.{key}"), shown(value), allowed));
                }
                let repeated = self.par_names.contains(&known);
                self.par_names.push(known);
                repeated
            }
        };
        once(repeated, name, key, value)?;
        Ok(true)
    }
}

impl Numbers {
    /// Stores a value if its key belongs to a side. `name` is the name of the term in errors.
    fn set_side(&mut self, name: &str, key: &str, value: &str) -> Result<bool, CueError> {
        const ALLOWED: &str = "a number, in radians, or with deg behind it in degrees";
        let slot = match key {
            AT => &mut self.at,
            SPREAD => &mut self.spread,
            _ => return Ok(false),
        };
        let degrees = without_unit(value, "deg");
        let angle = number(name, key, degrees.unwrap_or(value), value, ALLOWED)?;
        let angle = if degrees.is_some() { angle.to_radians() } else { angle };
        once(slot.replace(angle).is_some(), name, key, value)?;
        Ok(true)
    }
}

impl FromStr for Cue {
    type Err = CueError;

    fn from_str(text: &str) -> Result<Cue, CueError> {
        Cue::parse_with(text, &Scale::default(), |_| None)
    }
}

impl WrittenCue {
    /// Parses a cue; `named` resolves names of cues. Numbers are not checked.
    pub(super) fn parse(text: &str, named: impl Fn(&str) -> Option<Cue>) -> Result<WrittenCue, CueError> {
        let parts = split_terms(text);
        let mut written = WrittenCue::default();
        for part in &parts {
            let added = match (*part, named(part)) {
                ("none", _) => WrittenCue::default(),
                (_, Some(cue)) => WrittenCue::from(cue),
                _ => parse_term(part).map_err(|error| match parts.len() {
                    1 => error,
                    // Only one regulator is allowed.
                    _ if error.field.starts_with(REGULATOR) => error,
                    // Messages about one of several terms include its position in the sum.
                    _ => CueError { field: format!("cue[{}].{}", written.terms(), error.field), ..error },
                })?,
            };
            written.add(added)?;
        }
        Ok(written)
    }
}

impl Cue {
    /// Parses a cue and checks it; `named` resolves names of cues, `scale` converts numbers in µm and seconds.
    ///
    /// # Errors
    /// [`CueError`] names the part of the cue, its value and the values that are allowed.
    pub fn parse_with(text: &str, scale: &Scale, named: impl Fn(&str) -> Option<Cue>) -> Result<Cue, CueError> {
        let cue = WrittenCue::parse(text, named)?.in_units(scale)?;
        cue.check()?;
        Ok(cue)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Coupling, Regulator, Source};
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn complaints_name_the_part_and_what_is_allowed() {
        let complaint = |text: &str| text.parse::<Cue>().unwrap_err().to_string();
        for case in include_str!("complaints.txt").trim_end().split("\n\n") {
            let (text, expected) = case.strip_prefix("> ").unwrap().split_once('\n').unwrap();
            assert_eq!(complaint(text), expected);
        }
        let sum = complaint(
            "kappa:u0=0.4,omega=0.1,amplitude=-0.6+viscosity:gradient,amplitude=0.1+kappa:u0=0.4,omega=0.2,amplitude=-0.6",
        );
        assert!(
            sum.starts_with("cue[2].kappa.amplitude = -0.6: must be such that kappa stays above 0 everywhere"),
            "{sum}"
        );
        let apart = "kappa:u0=0.2,omega=0.05,amplitude=-0.9+kappa:u0=0.8,omega=0.05,amplitude=-0.9";
        assert_eq!(apart.parse::<Cue>().unwrap().to_string().matches("kappa:band").count(), 2);
    }

    #[test]
    fn sums_split_at_their_plus_signs_only() {
        assert_eq!(split_terms("a:x=1e+3,y=+2+b:z=1"), ["a:x=1e+3,y=+2", "b:z=1"]);
        let cue: Cue = "tension:gradient,amplitude=1e+0 + xi_b:u0=0.5,omega=0.3Lh,amplitude=+2".parse().unwrap();
        assert_eq!(cue.to_string(), "tension:gradient,amplitude=1+xi_b:band,u0=0.5,omega=0.3Lh,amplitude=2");
    }

    /// The cue comes back from its text bit for bit, and from RON and JSON.
    fn assert_reads_back(cue: &Cue) {
        assert_eq!(&cue.to_string().parse::<Cue>().unwrap(), cue);
        let json = serde_json::to_string(cue).unwrap();
        assert_eq!(&serde_json::from_str::<Cue>(&json).unwrap(), cue, "{json}");
        let ron = ron::to_string(cue).unwrap();
        assert_eq!(&furrow_input::parse_ron::<Cue>(&ron, "x").unwrap(), cue, "{ron}");
    }

    fn profile(kind: usize, length: bool, u0: f64, omega: f64) -> Profile {
        let omega = if length { Width::Length(omega) } else { Width::Fraction(omega) };
        let constants =
            ParConstants { k_ap: omega.value(), n_p: if length { 2 } else { 1 }, ..ParConstants::GOEHRING2011 };
        let par = Profile::Par { band: length, far: u0 > 0.5, constants, length_um: length.then_some(u0) };
        [Profile::Band { u0, omega }, Profile::Step { u0, omega }, Profile::Gradient, par][kind]
    }

    proptest! {
        /// Every field with every profile.
        #[test]
        fn what_is_printed_is_what_is_read(
            field in 0..9_usize, kind in 0..4_usize, length in any::<bool>(),
            u0 in 0.001..0.999_f64, omega in 1e-3..2.0_f64, amplitude in -0.99..0.99_f64,
        ) {
            let side = length.then_some(Side { at: u0, spread: 0.3 + omega });
            let term = Term { field: Field::ALL[field], profile: profile(kind, length, u0, omega), amplitude, side };
            for terms in [vec![], vec![term], vec![term, Term { field: Field::Tension, ..term }]] {
                assert_reads_back(&Cue::new(terms).unwrap());
            }
        }

        /// Every kind of source and of coupling, alone and beside a term.
        #[test]
        fn what_is_printed_of_a_regulator_is_what_is_read(
            (kind, length, u0, omega, amplitude) in
                (0..5_usize, any::<bool>(), 0.001..0.999_f64, 1e-3..2.0_f64, -0.9..0.9_f64),
            (turnover, diffusion, diluted) in (0.0..100.0_f64, 0.05..10.0_f64, any::<bool>()),
            couplings in proptest::sample::subsequence(Field::ALL.to_vec(), 1..9),
            strength in -0.1..0.1_f64, half in proptest::option::of(1e-3..100.0_f64),
        ) {
            let source = (kind < 4).then(|| Source { profile: profile(kind, length, u0, omega), amplitude });
            let of = |field| Coupling { field, strength, half: half.filter(|_| field != Field::Kappa) };
            let couplings = couplings.into_iter().rev().map(of).collect();
            let regulator = Regulator { source, turnover, diffusion, diluted, couplings };
            let term = Term { field: Field::Tension, profile: Profile::Gradient, amplitude, side: None };
            for terms in [vec![], vec![term]] {
                assert_reads_back(&Cue::with_regulator(terms, Some(regulator.clone())).unwrap());
            }
        }
    }
}
