//! Reading a lineage file, either complete or with the differences from another: `base: "c_elegans"`.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Deserialize;
use serde::de::IgnoredAny;

use super::check::Check;
use super::clock::{Clock, WrittenLifetimes};
use super::definition::{C_ELEGANS, CueRule, Limits, Lineage, Written, unique};
use super::founder::{Founder, in_shells};
use super::rules::PhysicsRule;
use super::units::Units;
use furrow_cell::cue::WrittenCue;
use furrow_cell::profile::WrittenShell;
use furrow_cell::{Cue, CueError};
use furrow_input::{InputError, did_you_mean, parse_document, parse_ron, read_text, shown};

impl Lineage {
    /// The built-in C. elegans founders.
    pub fn c_elegans() -> Result<Lineage, InputError> {
        let file = "c_elegans.ron (built in)";
        checked(whole(C_ELEGANS, file)?, C_ELEGANS, file)
    }

    /// Reads and checks a lineage file.
    pub fn read(path: &Path) -> Result<Lineage, InputError> {
        Lineage::parse(&read_text(path)?, &path.display().to_string())
    }

    /// The lineage of a file if one is given, otherwise the built-in one.
    pub fn load(path: Option<&Path>) -> Result<Lineage, InputError> {
        path.map_or_else(Lineage::c_elegans, Lineage::read)
    }

    /// Reads and checks a lineage from RON text; `file` is its name in errors. A text with `base: "c_elegans"` overrides
    /// parts of the built-in lineage of that name:
    ///
    /// ```
    /// use furrow_lineage::Lineage;
    ///
    /// let text = r#"(base: "c_elegans", founders: [(name: "P1", cue: "none")])"#;
    /// let lineage = Lineage::parse(text, "mine.ron")?;
    /// assert_eq!(lineage.founders.len(), Lineage::c_elegans()?.founders.len());
    /// # Ok::<(), furrow_input::InputError>(())
    /// ```
    pub fn parse(text: &str, file: &str) -> Result<Lineage, InputError> {
        let lineage = match with_base(text, file)? {
            Some(lineage) => lineage,
            None => whole(text, file)?,
        };
        checked(lineage, text, file)
    }

    /// Checks a lineage that was not read by [`parse`](Self::parse); `file` is the name of its source in errors.
    ///
    /// # Errors
    /// Names the founder, cue or field, its value and the allowed values.
    pub fn check(&self, file: &str) -> Result<(), InputError> {
        Check { lineage: self, text: "", file }.run()
    }
}

fn checked(lineage: Lineage, text: &str, file: &str) -> Result<Lineage, InputError> {
    Check { lineage: &lineage, text, file }.run()?;
    Ok(lineage)
}

/// The unchecked lineage of a text without a base.
fn whole(text: &str, file: &str) -> Result<Lineage, InputError> {
    let written: Lineage<WrittenCue, WrittenLifetimes, WrittenShell> =
        parse_document(text, file, "a lineage file", "Lineage")?;
    // There is no `..`, so that a new field is a compile error until it is handled.
    let Lineage {
        name,
        citation,
        naming,
        units,
        limits,
        cues,
        cue_rules,
        physics_rules,
        dies,
        clock,
        founders,
        written: _,
    } = written;
    let written = Written { cues_in_micrometres: in_micrometres(&cues) };
    let cues = in_units(cues, units, file)?;
    let clock = clock.map(|clock| clock.resolved(file)).transpose()?;
    let founders = in_shells(founders, [text, file])?;
    Ok(Lineage {
        name,
        citation,
        naming,
        units,
        limits,
        cues,
        cue_rules,
        physics_rules,
        dies,
        clock,
        founders,
        written,
    })
}

/// Whether a number of a cue is in µm.
fn in_micrometres(cues: &BTreeMap<String, WrittenCue>) -> bool {
    cues.values().any(WrittenCue::is_in_micrometres)
}

/// Cues in L_h and τ.
fn in_units(
    cues: BTreeMap<String, WrittenCue>,
    units: Option<Units>,
    file: &str,
) -> Result<BTreeMap<String, Cue>, InputError> {
    let scale = units.unwrap_or_default().scale();
    let converted = |(name, cue): (String, WrittenCue)| match cue.in_units(&scale) {
        Ok(cue) => Ok((name, cue)),
        Err(CueError { field, value, allowed }) => {
            Err(InputError::not_allowed(file, format!("cues[{name:?}].{field}"), value, allowed))
        }
    };
    cues.into_iter().map(converted).collect()
}

/// The built-in lineages that may be a base.
const BASE: &str = "c_elegans";

/// Whether a file has a base; other fields are ignored.
#[derive(Deserialize)]
#[serde(rename = "Lineage")]
struct Probe {
    base: Option<IgnoredAny>,
}

/// A file with a base. Missing fields keep the values of the base.
#[derive(Deserialize)]
#[serde(rename = "Lineage", deny_unknown_fields)]
struct Differing {
    base: String,
    name: Option<String>,
    citation: Option<String>,
    naming: Option<(char, char)>,
    units: Option<Units>,
    limits: Option<Limits>,
    /// Cues that are added to the base, or replace its cues of the same name.
    #[serde(default, deserialize_with = "unique")]
    cues: BTreeMap<String, WrittenCue>,
    /// Replace the base's rules, if any are given.
    #[serde(default)]
    cue_rules: Vec<CueRule>,
    /// Replace the base's rules, if any are given.
    #[serde(default)]
    physics_rules: Vec<PhysicsRule>,
    /// Replace the base's `dies`, if any are given.
    #[serde(default)]
    dies: Vec<String>,
    /// Replaces the clocks of the base and of its founders.
    clock: Option<Clock<WrittenLifetimes>>,
    /// Changes of founders of the base, by name, and additional founders.
    #[serde(default)]
    founders: Vec<Founder<WrittenShell>>,
}

/// The unchecked lineage of a text that names a base; `None` if it names no base.
///
/// # Errors
/// As [`Lineage::parse`].
fn with_base(text: &str, file: &str) -> Result<Option<Lineage>, InputError> {
    // Files are parsed twice only if they contain the word. The second parse reports malformed RON.
    if !text.contains("base") || !parse_ron::<Probe>(text, file).is_ok_and(|probe| probe.base.is_some()) {
        return Ok(None);
    }
    let differing: Differing = parse_document(text, file, "a lineage file", "Lineage")?;
    if differing.base != BASE {
        let nearest = did_you_mean(&differing.base, [BASE]);
        let allowed = format!("the name of a built-in lineage: {}{nearest}", shown(BASE));
        return Err(InputError::not_allowed(file, "base", shown(&differing.base), allowed));
    }
    differing.over(Lineage::c_elegans()?, [text, file]).map(Some)
}

impl Differing {
    fn over(self, mut base: Lineage, [text, file]: [&str; 2]) -> Result<Lineage, InputError> {
        let Differing {
            base: _,
            name,
            citation,
            naming,
            units,
            limits,
            cues,
            cue_rules,
            physics_rules,
            dies,
            clock,
            founders,
        } = self;
        base.name = name.unwrap_or(base.name);
        base.citation = citation.or(base.citation);
        base.naming = naming.unwrap_or(base.naming);
        base.units = units.or(base.units);
        base.limits = limits.unwrap_or(base.limits);
        base.written.cues_in_micrometres |= in_micrometres(&cues);
        base.cues.extend(in_units(cues, base.units, file)?);
        if !cue_rules.is_empty() {
            base.cue_rules = cue_rules;
        }
        if !physics_rules.is_empty() {
            base.physics_rules = physics_rules;
        }
        if !dies.is_empty() {
            base.dies = dies;
        }
        if let Some(clock) = clock {
            base.clock = Some(clock.resolved(file)?);
            // Their laws are relative to a clock that no longer exists.
            base.founders.iter_mut().for_each(|founder| founder.clock = None);
        }
        let of_base = base.founders.len();
        let mut changed = vec![false; of_base];
        for founder in in_shells(founders, [text, file])? {
            match base.founders[..of_base].iter().position(|other| other.name == founder.name) {
                None => base.founders.push(founder),
                // In a file without a base this is an error of the check.
                Some(k) if std::mem::replace(&mut changed[k], true) => {
                    let field = format!("founder {}", shown(&founder.name));
                    return Err(InputError::not_allowed(file, field, "(given twice)", "given once"));
                }
                Some(k) => base.founders[k].replace(founder),
            }
        }
        Ok(base)
    }
}
