//! Cues as text: `none`, or terms `FIELD:PROFILE,key=value,…` joined by `+`.
//!
//! What is printed is what is read: [`Display`](std::fmt::Display) writes every number with as many digits as it takes to
//! get the same number back.

use std::fmt;
use std::str::FromStr;

use super::profile::NAMES;
use super::{Cue, CueError, Field, Profile, Quantity, Term, Width};
use furrow_input::{did_you_mean, shown};

impl fmt::Display for Term {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.field.name(), self.profile.name())?;
        if let (Some(u0), Some(width)) = (self.quantity(Quantity::U0), self.profile.width()) {
            let unit = if matches!(width, Width::Length(_)) { "Lh" } else { "" };
            write!(f, ",u0={u0},omega={}{unit}", width.value())?;
        }
        write!(f, ",amplitude={}", self.amplitude)
    }
}

impl fmt::Display for Cue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let terms: Vec<String> = self.terms().iter().map(Term::to_string).collect();
        f.write_str(if terms.is_empty() { "none".to_owned() } else { terms.join("+") }.as_str())
    }
}

/// The parts of a sum: text between `+` signs that are neither an exponent's (`1e+3`) nor a number's (`=+0.1`).
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

/// Numbers given for one term, before it is known whether they are all there.
#[derive(Default)]
pub(super) struct Numbers {
    pub u0: Option<f64>,
    pub omega: Option<Width>,
    pub amplitude: Option<f64>,
}

impl Numbers {
    /// The term, if every number its profile needs is given, and no other.
    pub fn term(self, field: Field, profile: &str) -> Result<Term, CueError> {
        let name = field.name();
        let missing = |quantity: Quantity| {
            let field = format!("{name}.{}", quantity.name());
            CueError::new(field, "(not given)", format!("given: a {profile} has no default for it"))
        };
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
            _ => return Err(unknown_profile(field, profile)),
        };
        let amplitude = self.amplitude.ok_or_else(|| missing(Quantity::Amplitude))?;
        Ok(Term { field, profile, amplitude })
    }
}

/// Which of these names there are, with the one nearest to what is written.
fn one_of<const N: usize>(names: [&str; N], written: &str) -> String {
    format!("one of {}{}", names.join(", "), did_you_mean(written, names))
}

/// The error for a profile that there is not.
fn unknown_profile(field: Field, profile: &str) -> CueError {
    CueError::new(field.name(), shown(profile), one_of(NAMES, profile))
}

/// The field of a name.
pub(super) fn field(name: &str) -> Result<Field, CueError> {
    let known = Field::ALL.into_iter().find(|field| field.name() == name);
    let allowed = || format!("a field: {}", one_of(Field::ALL.map(Field::name), name));
    known.ok_or_else(|| CueError::new("cue", shown(name), allowed()))
}

fn parse_term(text: &str) -> Result<Term, CueError> {
    let Some((name, list)) = text.split_once(':') else {
        let is_field = Field::ALL.iter().any(|field| text.starts_with(field.name()));
        let allowed = match (text.is_empty(), is_field) {
            (true, _) => "a term: there is nothing before, between or behind +",
            (_, true) => "a term FIELD:PROFILE,key=value,.. with a colon after the field",
            _ => "none, or terms FIELD:PROFILE,key=value,.. joined by +",
        };
        return Err(CueError::new("cue", shown(text), allowed));
    };
    let field = field(name.trim())?;
    let mut entries = list.split(',').map(str::trim).peekable();
    let profile = entries.next_if(|first| !first.contains('=')).unwrap_or(NAMES[0]);
    if !NAMES.contains(&profile) {
        return Err(unknown_profile(field, profile));
    }
    let mut numbers = Numbers::default();
    for entry in entries {
        let Some((key, value)) = entry.split_once('=') else {
            let allowed = "key=value, set off by single commas";
            return Err(CueError::new(format!("{}:{profile}", field.name()), shown(entry), allowed));
        };
        set(&mut numbers, field, profile, key.trim(), value.trim())?;
    }
    numbers.term(field, profile)
}

fn set(numbers: &mut Numbers, field: Field, profile: &str, key: &str, value: &str) -> Result<(), CueError> {
    let label = format!("{}.{key}", field.name());
    let number = |text: &str, allowed: &str| {
        text.trim().parse::<f64>().map_err(|_| CueError::new(label.as_str(), shown(value), allowed))
    };
    let repeated = match key {
        "u0" => numbers.u0.replace(number(value, "a number")?).is_some(),
        "amplitude" => numbers.amplitude.replace(number(value, "a number")?).is_some(),
        "omega" => {
            const ALLOWED: &str = "a number, in u, or with Lh behind it in L_h";
            let width = match value.strip_suffix("Lh") {
                Some(length) => Width::Length(number(length, ALLOWED)?),
                None => Width::Fraction(number(value, ALLOWED)?),
            };
            numbers.omega.replace(width).is_some()
        }
        other => {
            let allowed = one_of(Quantity::ALL.map(Quantity::name), other);
            return Err(CueError::new(format!("{}:{profile}", field.name()), shown(other), allowed));
        }
    };
    if repeated {
        return Err(CueError::new(label, shown(value), "given once: it is given twice"));
    }
    Ok(())
}

impl FromStr for Cue {
    type Err = CueError;

    fn from_str(text: &str) -> Result<Cue, CueError> {
        Cue::parse_with(text, |_| None)
    }
}

impl Cue {
    /// Reads a cue whose terms may also be names, which `named` knows.
    ///
    /// # Errors
    /// [`CueError`] names the part of the cue, what it is, and what it may be.
    pub fn parse_with(text: &str, named: impl Fn(&str) -> Option<Cue>) -> Result<Cue, CueError> {
        let parts = split_terms(text);
        let mut terms = Vec::new();
        for part in &parts {
            match (*part, named(part)) {
                ("none", _) => {}
                (_, Some(cue)) => terms.extend_from_slice(cue.terms()),
                _ => terms.push(parse_term(part).map_err(|error| match parts.len() {
                    1 => error,
                    // Which of several is told by its place, as in complaints about the sum.
                    _ => CueError { field: format!("cue[{}].{}", terms.len(), error.field), ..error },
                })?),
            }
        }
        Cue::new(terms)
    }
}

#[cfg(test)]
mod tests {
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

    proptest! {
        /// Every field with every profile comes back from its text bit for bit, and from RON and JSON.
        #[test]
        fn what_is_printed_is_what_is_read(
            field in 0..9_usize, kind in 0..3_usize, length in any::<bool>(),
            u0 in 0.001..0.999_f64, omega in 1e-3..2.0_f64, amplitude in -0.99..0.99_f64,
        ) {
            let omega = if length { Width::Length(omega) } else { Width::Fraction(omega) };
            let profile = [Profile::Band { u0, omega }, Profile::Step { u0, omega }, Profile::Gradient][kind];
            let term = Term { field: Field::ALL[field], profile, amplitude };
            let cue = Cue::new(vec![term, Term { field: Field::Tension, ..term }]).unwrap();
            prop_assert_eq!(&cue.to_string().parse::<Cue>().unwrap(), &cue);
            let single = Cue::new(vec![term]).unwrap();
            for cue in [Cue::none(), single, cue] {
                let json = serde_json::to_string(&cue).unwrap();
                prop_assert_eq!(&serde_json::from_str::<Cue>(&json).unwrap(), &cue, "{}", json);
                let ron = ron::to_string(&cue).unwrap();
                prop_assert_eq!(&furrow_input::parse_ron::<Cue>(&ron, "x").unwrap(), &cue, "{}", ron);
            }
        }
    }
}
