//! Checks of a lineage file. Errors name the place, the value and the allowed values.

use std::collections::HashMap;
use std::ops::RangeInclusive;

use super::clash;
use super::clock::FounderClock;
use super::definition::{CueRule, Lineage};
use super::founder::{Daughter, Founder};
use super::rules::{PhysicsRule, Span};
use super::units::{Length, MOST_PLAIN, plain_radius};
use furrow_cell::{CueError, SIZES};
use furrow_input::{InputError, did_you_mean, forbidden, listed, shown};

type Checked = Result<(), InputError>;

/// A lineage and the text from which it was read.
pub(super) struct Check<'a> {
    pub lineage: &'a Lineage,
    pub text: &'a str,
    /// The name of the file in errors.
    pub file: &'a str,
}

/// `file:line` of the `nth` founder of a name in the text of a file, counted from 0, if the line is found. It searches the whole
/// text and is used only for errors.
fn place([text, file]: [&str; 2], founder: &str, nth: usize) -> String {
    let quoted = format!("\"{founder}\"");
    let is_named = |(_, line): &(usize, &str)| {
        let code = line.split("//").next().unwrap_or("");
        code.match_indices(&quoted).any(|(at, _)| code[..at].trim_end().ends_with("name:"))
    };
    match text.lines().enumerate().filter(is_named).nth(nth) {
        Some((n, _)) => format!("{file}:{}", n + 1),
        None => file.to_owned(),
    }
}

/// Rejects a value of a founder's field in the text of a file.
pub(super) fn founder_error(
    of: [&str; 2],
    founder: &str,
    field: &str,
    value: impl ToString,
    allowed: impl Into<String>,
) -> InputError {
    InputError::not_allowed(place(of, founder, 0), format!("founder {}: {field}", shown(founder)), value, allowed)
}

/// The first invalid field of a rule's selection of cells: its name, its value and the allowed values.
fn span_complaint(span: Span) -> Option<(&'static str, String, String)> {
    let Span { from_generation, to_generation, below_r0, above_r0 } = span;
    if let Some(last) = to_generation.filter(|last| *last < from_generation) {
        return Some(("to_generation", last.to_string(), format!("from_generation = {from_generation} or later")));
    }
    for (name, limit) in [("below_r0", below_r0), ("above_r0", above_r0)] {
        if let Some(limit) = limit.filter(|limit| !(limit.is_finite() && *limit > 0.0)) {
            return Some((name, limit.to_string(), "a finite number above 0".to_owned()));
        }
    }
    let (above, below) = (above_r0?, below_r0?);
    (above >= below).then(|| ("above_r0", above.to_string(), format!("less than below_r0 = {below}")))
}

/// Allowed numbers of minutes of a clock. With the limits on volumes and exponents no time overflows.
const MINUTES: RangeInclusive<f64> = 1e-6..=1e6;

/// The same range in words.
const MINUTES_ALLOWED: &str = "a number of minutes from 1e-6 to 1e6";

/// The given parameters of a law of lifetimes, with their fields and the allowed values.
fn law_ranges(
    lifetime_min: Option<f64>,
    at_volume: Option<f64>,
    exponent: Option<f64>,
) -> impl Iterator<Item = (&'static str, f64, RangeInclusive<f64>, &'static str)> {
    let of_first = "a fraction of the first cell's volume, from 1e-6 to 1e6";
    let values = [
        ("lifetime_min", lifetime_min, MINUTES, MINUTES_ALLOWED),
        ("at_volume", at_volume, 1e-6..=1e6, of_first),
        ("exponent", exponent, -5.0..=5.0, "a number from -5 to 5"),
    ];
    values.into_iter().filter_map(|(field, value, range, allowed)| Some((field, value?, range, allowed)))
}

/// The allowed `volumes` of a clock.
const VOLUMES_ALLOWED: &str = "the smallest and the largest volume, two fractions of the first cell's above 0";

impl Check<'_> {
    fn place(&self, founder: &str, nth: usize) -> String {
        place([self.text, self.file], founder, nth)
    }

    fn founder_error(&self, f: &Founder, field: &str, value: impl ToString, allowed: impl Into<String>) -> InputError {
        founder_error([self.text, self.file], &f.name, field, value, allowed)
    }

    /// Rejects an invalid value of a field of the file.
    fn ensure(&self, ok: bool, field: &str, value: impl ToString, allowed: impl Into<String>) -> Checked {
        if ok { Ok(()) } else { Err(InputError::not_allowed(self.file, field, value, allowed)) }
    }

    /// The same for a founder.
    fn require(&self, f: &Founder, ok: bool, field: &str, value: impl ToString, allowed: impl Into<String>) -> Checked {
        if ok { Ok(()) } else { Err(self.founder_error(f, field, value, allowed)) }
    }

    /// Names in drawings and pages must be valid XML text.
    fn printable(&self, field: &str, text: &str) -> Checked {
        let Some(c) = forbidden(text) else { return Ok(()) };
        let allowed = format!("free of control characters and of what XML cannot hold, here {c:?}");
        self.ensure(false, field, shown(text), allowed)
    }

    /// Checks a parsed lineage.
    pub fn run(&self) -> Checked {
        let lineage = self.lineage;
        let limits = lineage.limits;
        let deep = (1..=100_000).contains(&limits.max_depth);
        self.ensure(deep, "limits.max_depth", limits.max_depth, "from 1 to 100000")?;
        self.ensure(limits.max_cells >= 1, "limits.max_cells", limits.max_cells, "at least 1")?;
        for name in &lineage.dies {
            let allowed = "the name of a cell, with * for any letters";
            self.ensure(!name.trim().is_empty(), "dies", shown(name), allowed)?;
            self.printable("dies", name)?;
        }
        self.letters("naming", lineage.naming)?;
        lineage.units().check(self.file)?;
        self.printable("name", &lineage.name)?;
        self.ensure(!lineage.name.trim().is_empty(), "name", shown(&lineage.name), "the organism's name, not empty")?;
        self.printable("citation", lineage.citation.as_deref().unwrap_or(""))?;
        self.cues()?;
        self.rules(&|| self.file.to_owned(), "cue_rules", &lineage.cue_rules)?;
        self.physics_rules(&|| self.file.to_owned(), "physics_rules", &lineage.physics_rules)?;
        self.ensure(!lineage.founders.is_empty(), "founders", "[]", "a list of at least one founder")?;
        let mut index = HashMap::new();
        for (i, f) in lineage.founders.iter().enumerate() {
            self.founder(f)?;
            if index.insert(f.name.as_str(), i).is_some() {
                let (first, second) = (self.place(&f.name, 0), self.place(&f.name, 1));
                let field = format!("founders[{i}].name");
                let allowed = format!("unique in the file: it is the name of a founder at {first} already");
                return Err(InputError::not_allowed(second, field, shown(&f.name), allowed));
            }
        }
        let mother = self.mothers(&index)?;
        self.one_tree(&mother)?;
        self.pairs(&mother)?;
        self.sizes_of_pairs()?;
        self.clashes(&mother)?;
        self.clock()
    }

    /// Checks the clocks of the file and of its founders.
    fn clock(&self) -> Checked {
        for f in &self.lineage.founders {
            let Some(own) = f.clock else { continue };
            let allowed = "left out where the file has no clock";
            self.require(f, self.lineage.clock.is_some(), "clock", "(given)", allowed)?;
            let allowed = "given with lifetime_min, which it belongs to";
            self.require(
                f,
                own.lifetime_min.is_some() || own.at_volume.is_none(),
                "clock.at_volume",
                "(alone)",
                allowed,
            )?;
            let FounderClock { lifetime_min, at_volume, exponent, volumes } = own;
            self.volumes(volumes).map_err(|value| self.founder_error(f, "clock.volumes", value, VOLUMES_ALLOWED))?;
            for (field, value, range, allowed) in law_ranges(lifetime_min, at_volume, exponent) {
                self.require(f, range.contains(&value), &format!("clock.{field}"), value, allowed)?;
            }
        }
        let Some(clock) = &self.lineage.clock else { return Ok(()) };
        let (lifetime_min, at_volume) = (Some(clock.lifetime_min), Some(clock.at_volume));
        for (field, value, range, allowed) in law_ranges(lifetime_min, at_volume, Some(clock.exponent)) {
            self.ensure(range.contains(&value), &format!("clock.{field}"), value, allowed)?;
        }
        if let Err(value) = self.volumes(clock.volumes) {
            self.ensure(false, "clock.volumes", value, VOLUMES_ALLOWED)?;
        }
        if let Some(tau) = clock.tau_min {
            self.ensure(MINUTES.contains(&tau), "clock.tau_min", tau, MINUTES_ALLOWED)?;
            if let Some(unit) = self.lineage.units().time_min {
                let same = (tau - unit).abs() <= 1e-9 * unit;
                let allowed =
                    format!("units.time_min = {unit}, since both are one τ in minutes, or only one of them given");
                self.ensure(same, "clock.tau_min", tau, allowed)?;
            }
        }
        let known = |field: &str, name: &str| {
            let allowed = "a founder of this file, or a cell that the naming rule can name below one";
            self.ensure(self.lineage.founder_of(name).is_some(), field, shown(name), allowed)
        };
        if let Some(origin) = &clock.origin {
            known("clock.origin", origin.cell())?;
        }
        for (name, minutes) in clock.lifetimes.iter().flatten() {
            known("clock.lifetimes", name)?;
            let field = format!("clock.lifetimes[{}]", shown(name));
            self.ensure(MINUTES.contains(minutes), &field, minutes, MINUTES_ALLOWED)?;
        }
        Ok(())
    }

    /// Rejects volumes of a clock that do not form a range; the error contains them as text.
    fn volumes(&self, given: Option<[f64; 2]>) -> Result<(), String> {
        let fit = |[least, most]: [f64; 2]| (1e-12..=most).contains(&least) && most.is_finite();
        given.filter(|range| !fit(*range)).map_or(Ok(()), |[least, most]| Err(format!("({least}, {most})")))
    }

    /// The cues named in the file.
    fn cues(&self) -> Checked {
        for (name, cue) in &self.lineage.cues {
            self.ensure(name != "none", "cues", "\"none\"", "another name: none is the absence of a cue")?;
            self.printable("cues", name)?;
            let plain = !name.is_empty() && !name.chars().any(|c| c.is_whitespace() || ":+,\"'".contains(c));
            self.ensure(plain, "cues", shown(name), "a name without blanks, quotes and : + , as in \"polar\"")?;
            if let Err(CueError { field, value, allowed }) = cue.check() {
                return self.ensure(false, &format!("cues[{name:?}].{field}"), value, allowed);
            }
        }
        Ok(())
    }

    /// Checks that a cue exists; the error lists the known cues.
    fn known_cue(&self, name: &str) -> Result<(), String> {
        if self.lineage.cue(name).is_some() {
            return Ok(());
        }
        let known = || ["none"].into_iter().chain(self.lineage.cues.keys().map(String::as_str));
        let hint = match name.contains(':') {
            true => "; what it is is said under cues".to_owned(),
            false => did_you_mean(name, known()),
        };
        Err(match self.lineage.cues.is_empty() {
            true => format!("none, since the file has no cues{hint}"),
            false => format!("one of {}{hint}", listed(known(), ", ")),
        })
    }

    fn rules(&self, place: &dyn Fn() -> String, field: &str, rules: &[CueRule]) -> Checked {
        let refuse = |k: usize, name: &str, value: String, allowed: String| {
            Err(InputError::not_allowed(place(), format!("{field}[{k}].{name}"), value, allowed))
        };
        for (k, rule) in rules.iter().enumerate() {
            if let Err(allowed) = self.known_cue(&rule.cue) {
                return refuse(k, "cue", shown(&rule.cue), allowed);
            }
            if let Some((name, value, allowed)) = span_complaint(rule.span()) {
                return refuse(k, name, value, allowed);
            }
        }
        Ok(())
    }

    fn physics_rules(&self, place: &dyn Fn() -> String, field: &str, rules: &[PhysicsRule]) -> Checked {
        for (k, rule) in rules.iter().enumerate() {
            if let Some((name, value, allowed)) = rule.complaint().or_else(|| span_complaint(rule.span())) {
                return Err(InputError::not_allowed(place(), format!("{field}[{k}].{name}"), value, allowed));
            }
        }
        Ok(())
    }

    fn letters(&self, field: &str, (a, p): (char, char)) -> Checked {
        let right = a != p && a.is_ascii_alphanumeric() && p.is_ascii_alphanumeric();
        let allowed = "two different ASCII letters or digits, anterior first";
        self.ensure(right, field, format!("({a:?}, {p:?})"), allowed)
    }

    fn founder(&self, f: &Founder) -> Checked {
        let reserved = |c: char| c.is_whitespace() || "()[]{}:;,'\"=".contains(c);
        let plain = !f.name.is_empty() && forbidden(&f.name).is_none() && !f.name.chars().any(reserved);
        let allowed = "not empty and free of spaces, control characters, brackets, quotes and of : ; , = (tree files reserve them)";
        self.require(f, plain, "name", shown(&f.name), allowed)?;
        for &pair in &f.letters {
            self.letters(&format!("founder {:?}: letters", f.name), pair)?;
        }
        self.physics(f)?;
        if let Some(cue) = &f.cue {
            self.known_cue(cue).map_err(|allowed| self.founder_error(f, "cue", shown(cue), allowed))?;
            self.require(f, f.cue_rules.is_empty(), "cue", shown(cue), "left out where cue_rules are given")?;
        }
        let allowed = "left out where the founder has no cue; cue_rules say themselves which generations they are for";
        self.require(f, f.inherit || f.cue.is_some(), "inherit", "false", allowed)?;
        let (word, passes) = (f.cue_passes_to.map_or("(not given)", Daughter::word), f.cue_passes_to.is_some());
        let allowed = "left out where the founder has no cue or inherit is false";
        self.require(f, !passes || f.inherit && f.cue.is_some(), "cue_passes_to", word, allowed)?;
        let (rounds, allowed) = (f.rounds_without_cue, "left out without cue_passes_to");
        self.require(f, passes || rounds.is_none(), "rounds_without_cue", rounds.unwrap_or(0), allowed)?;
        self.rules(&|| self.place(&f.name, 0), &format!("founder {}: cue_rules", shown(&f.name)), &f.cue_rules)?;
        let field = format!("founder {}: physics_rules", shown(&f.name));
        self.physics_rules(&|| self.place(&f.name, 0), &field, &f.physics_rules)?;
        let (mother, daughter) = (f.mother.is_some(), f.daughter.is_some());
        let allowed = "larger or smaller where a mother is given";
        self.require(f, daughter || !mother, "daughter", "(not given)", allowed)?;
        let allowed = "the mother's name where a daughter is given";
        self.require(f, mother || !daughter, "mother", "(not given)", allowed)?;
        match f.observed.and_then(|observed| observed.contradiction()) {
            None => Ok(()),
            Some((field, value, allowed)) => self.require(f, false, &format!("observed.{field}"), value, allowed),
        }
    }

    fn physics(&self, f: &Founder) -> Checked {
        if let Some(growth) = f.growth {
            self.require(f, Founder::GROWTH.contains(&growth), "growth", growth, "a number from 0.01 to 100")?;
        }
        if let Some(given) = f.r0 {
            let r0 = given.in_units(&self.lineage.units());
            self.require(f, r0.is_finite() && r0 > 0.0, "r0", given, "a finite number above 0")?;
            self.require(f, SIZES.contains(&r0), "r0", given, "a number of L_h from 1e-6 to 1e6")?;
            let plain = matches!(given, Length::Natural(_));
            self.require(f, !plain || r0 <= MOST_PLAIN, "r0", given, plain_radius(r0))?;
        }
        for (parameter, value) in f.physics.values() {
            let refused = |allowed| self.founder_error(f, &format!("physics.{parameter}"), value, allowed);
            parameter.validate(value).map_err(refused)?;
        }
        Ok(())
    }

    fn mothers(&self, index: &HashMap<&str, usize>) -> Result<Vec<Option<usize>>, InputError> {
        let known = |f: &Founder| {
            let Some(name) = f.mother.as_deref() else { return Ok(None) };
            index.get(name).copied().map(Some).ok_or_else(|| {
                let names = || self.lineage.founders.iter().map(|f| f.name.as_str());
                let nearest = did_you_mean(name, names());
                let allowed = format!("a founder of this file: {}{nearest}", listed(names(), ", "));
                self.founder_error(f, "mother", shown(name), allowed)
            })
        };
        self.lineage.founders.iter().map(known).collect()
    }

    /// Checks that there is exactly one first cell and that every founder descends from it.
    fn one_tree(&self, mother: &[Option<usize>]) -> Checked {
        let founders = &self.lineage.founders;
        // Founders known to descend from the first cell; each is visited once.
        let mut reaches = vec![false; founders.len()];
        let mut walk = vec![usize::MAX; founders.len()];
        for start in 0..founders.len() {
            let (mut path, mut at) = (vec![], Some(start));
            while let Some(i) = at.filter(|&i| !reaches[i]) {
                if walk[i] == start {
                    let from = path.iter().position(|&j| j == i).unwrap_or(0);
                    let ring = listed(path[from..].iter().map(|&j: &usize| founders[j].name.as_str()), " <- ");
                    let message = format!(
                        "the founders' mothers form a cycle: {ring} <- {}; one founder must have no mother, and all others descend from it",
                        listed([founders[i].name.as_str()], "")
                    );
                    return Err(InputError::Founders { file: self.place(&founders[i].name, 0), message });
                }
                walk[i] = start;
                path.push(i);
                at = mother[i];
            }
            path.into_iter().for_each(|i| reaches[i] = true);
        }
        let first = || founders.iter().filter(|f| f.mother.is_none()).map(|f| f.name.as_str());
        if let Some(second) = first().nth(1) {
            let message =
                format!("founders {} have no mother; exactly one founder may have none", listed(first(), ", "));
            return Err(InputError::Founders { file: self.place(second, 0), message });
        }
        Ok(())
    }

    /// Checks that below each founder there is no founder, or a larger and a smaller one.
    fn pairs(&self, mother: &[Option<usize>]) -> Checked {
        let founders = &self.lineage.founders;
        let mut taken: HashMap<(usize, bool), usize> = HashMap::new();
        for (i, f) in founders.iter().enumerate() {
            let (Some(m), Some(daughter)) = (mother[i], f.daughter) else { continue };
            if let Some(other) = taken.insert((m, daughter == Daughter::Larger), i) {
                let which = daughter.word();
                let allowed =
                    format!("the other one: {} is already the {which} daughter", shown(&founders[other].name));
                return Err(self.founder_error(f, "daughter", which, allowed));
            }
        }
        for (i, f) in founders.iter().enumerate() {
            let Some(m) = mother[i] else { continue };
            let sister_larger = f.daughter == Some(Daughter::Smaller);
            if !taken.contains_key(&(m, sister_larger)) {
                let missing = if sister_larger { "larger" } else { "smaller" };
                let message = format!(
                    "founder {} is a daughter of {}, whose {missing} daughter is not in the list; list both or neither",
                    shown(&f.name),
                    shown(&founders[m].name)
                );
                return Err(InputError::Founders { file: self.place(&f.name, 0), message });
            }
        }
        Ok(())
    }

    /// Checks that the `larger` of two daughters with given radii is the larger one at birth.
    fn sizes_of_pairs(&self) -> Checked {
        for (larger, smaller) in self.lineage.daughters().into_iter().flatten() {
            let [larger_volume, smaller_volume] = [larger, smaller].map(|founder| self.lineage.given_at_birth(founder));
            let [f, sister] = [larger, smaller].map(|founder| &self.lineage.founders[founder]);
            let (Some(own), Some(other)) = (f.r0, sister.r0) else { continue };
            let grows = self.lineage.growth(larger) != self.lineage.growth(smaller);
            let at_birth = if grows { ", both over the cube root of growth, as at birth" } else { "" };
            let allowed =
                || format!("smaller, or r0 = {own} at least r0 = {other} of {}{at_birth}", shown(&sister.name));
            if smaller_volume > larger_volume {
                return Err(self.founder_error(f, "daughter", Daughter::Larger.word(), allowed()));
            }
        }
        Ok(())
    }

    /// Checks that no founder has a name that the naming rule may give to another cell.
    fn clashes(&self, mother: &[Option<usize>]) -> Checked {
        let founders = &self.lineage.founders;
        let mut has_listed = vec![false; founders.len()];
        mother.iter().flatten().for_each(|&m| has_listed[m] = true);
        let names: Vec<&str> = founders.iter().map(|f| f.name.as_str()).collect();
        let letters = |founder, generation| self.lineage.letters(founder, generation);
        let Some((above, i)) = clash::first(&names, &has_listed, letters) else { return Ok(()) };
        let (f, above) = (&founders[i], shown(names[above]));
        let allowed = format!("a name that no descendant of {above} may be given by the naming rule");
        Err(self.founder_error(f, "name", shown(&f.name), allowed))
    }
}
