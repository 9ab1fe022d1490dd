//! Checks of a lineage file: what is wrong is named with its place, its value and what is allowed.

use std::collections::HashMap;

use super::definition::{CueRule, Daughter, Founder, Lineage};
use crate::input::{InputError, did_you_mean, shown};

/// A lineage with the text it was read from.
pub(super) struct Check<'a> {
    pub lineage: &'a Lineage,
    pub text: &'a str,
    /// What errors call the file.
    pub file: &'a str,
}

impl Check<'_> {
    /// `file:line` of a founder, where the line can be told.
    fn place(&self, founder: &str) -> String {
        let quoted = format!("\"{founder}\"");
        let line = self.text.lines().position(|line| {
            let code = line.split("//").next().unwrap_or("");
            code.match_indices(&quoted).any(|(at, _)| code[..at].trim_end().ends_with("name:"))
        });
        match line {
            Some(n) => format!("{}:{}", self.file, n + 1),
            None => self.file.to_owned(),
        }
    }

    fn founder_error(&self, f: &Founder, field: &str, value: impl ToString, allowed: impl Into<String>) -> InputError {
        InputError::not_allowed(self.place(&f.name), format!("founder {:?}: {field}", f.name), value, allowed)
    }

    /// Everything that can be wrong with a lineage that is good RON.
    pub fn run(&self) -> Result<(), InputError> {
        let lineage = self.lineage;
        let limits = lineage.limits;
        if !(1..=100_000).contains(&limits.max_depth) {
            return Err(InputError::not_allowed(self.file, "limits.max_depth", limits.max_depth, "from 1 to 100000"));
        }
        if limits.max_cells < 1 {
            return Err(InputError::not_allowed(self.file, "limits.max_cells", limits.max_cells, "at least 1"));
        }
        self.letters("naming", lineage.naming)?;
        lineage.units().check(self.file)?;
        for (name, cue) in &lineage.cues {
            if name == "none" {
                let allowed = "another name: none is the absence of a cue";
                return Err(InputError::not_allowed(self.file, "cues", "\"none\"", allowed));
            }
            if name.is_empty() || name.chars().any(|c| c.is_control() || c.is_whitespace() || ":+,\"'".contains(c)) {
                let allowed = "a name without blanks, quotes and : + , as in \"polar\"";
                return Err(InputError::not_allowed(self.file, "cues", shown(name), allowed));
            }
            cue.check().map_err(|error| {
                let field = format!("cues[{name:?}].{}", error.field);
                InputError::not_allowed(self.file, field, error.value, error.allowed)
            })?;
        }
        self.rules(self.file, "cue_rules", &lineage.cue_rules)?;
        if lineage.founders.is_empty() {
            return Err(InputError::not_allowed(self.file, "founders", "[]", "a list of at least one founder"));
        }
        let mut index = HashMap::new();
        for (i, f) in lineage.founders.iter().enumerate() {
            self.founder(f)?;
            if index.insert(f.name.as_str(), i).is_some() {
                return Err(self.founder_error(f, "name", format!("{:?}", f.name), "unique in the file"));
            }
        }
        let mother = self.mothers(&index)?;
        self.one_tree(&mother)?;
        self.pairs(&mother)?;
        self.clashes(&mother)
    }

    /// What is allowed in place of the name of a cue that there is not.
    fn known_cue(&self, name: &str) -> Result<(), String> {
        if self.lineage.cue(name).is_some() {
            return Ok(());
        }
        let known: Vec<&str> = ["none"].into_iter().chain(self.lineage.cues.keys().map(String::as_str)).collect();
        let hint = match name.contains(':') {
            true => "; what it is is said under cues".to_owned(),
            false => did_you_mean(name, known.iter().copied()),
        };
        Err(format!("one of {}{hint}", known.join(", ")))
    }

    fn rules(&self, place: &str, field: &str, rules: &[CueRule]) -> Result<(), InputError> {
        let refuse = |k: usize, name: &str, value: String, allowed: String| {
            Err(InputError::not_allowed(place, format!("{field}[{k}].{name}"), value, allowed))
        };
        for (k, rule) in rules.iter().enumerate() {
            if let Err(allowed) = self.known_cue(&rule.cue) {
                return refuse(k, "cue", format!("{:?}", rule.cue), allowed);
            }
            if let Some(last) = rule.to_generation.filter(|last| *last < rule.from_generation) {
                let allowed = format!("from_generation = {} or later", rule.from_generation);
                return refuse(k, "to_generation", last.to_string(), allowed);
            }
            for (name, limit) in [("below_r0", rule.below_r0), ("above_r0", rule.above_r0)] {
                if let Some(limit) = limit.filter(|limit| !(limit.is_finite() && *limit > 0.0)) {
                    return refuse(k, name, limit.to_string(), "a finite number above 0".to_owned());
                }
            }
            if let (Some(below), Some(above)) = (rule.below_r0, rule.above_r0)
                && above >= below
            {
                return refuse(k, "above_r0", above.to_string(), format!("less than below_r0 = {below}"));
            }
        }
        Ok(())
    }

    fn letters(&self, field: &str, (a, p): (char, char)) -> Result<(), InputError> {
        if a == p || !a.is_ascii_alphanumeric() || !p.is_ascii_alphanumeric() {
            let allowed = "two different ASCII letters or digits, anterior first";
            return Err(InputError::not_allowed(self.file, field, format!("({a:?}, {p:?})"), allowed));
        }
        Ok(())
    }

    fn founder(&self, f: &Founder) -> Result<(), InputError> {
        if f.name.is_empty()
            || f.name.chars().any(|c| c.is_control() || c.is_whitespace() || "()[]{}:;,'\"=".contains(c))
        {
            let allowed = "not empty and free of spaces, brackets, quotes and of : ; , = (tree files reserve them)";
            return Err(self.founder_error(f, "name", format!("{:?}", f.name), allowed));
        }
        for &pair in &f.letters {
            self.letters(&format!("founder {:?}: letters", f.name), pair)?;
        }
        self.physics(f)?;
        if let Some(cue) = &f.cue {
            self.known_cue(cue).map_err(|allowed| self.founder_error(f, "cue", format!("{cue:?}"), allowed))?;
            if !f.cue_rules.is_empty() {
                let allowed = "left out where cue_rules are given";
                return Err(self.founder_error(f, "cue", format!("{cue:?}"), allowed));
            }
        }
        if !f.inherit && f.cue.is_none() {
            let allowed =
                "left out where the founder has no cue; cue_rules say themselves which generations they are for";
            return Err(self.founder_error(f, "inherit", "false", allowed));
        }
        self.rules(&self.place(&f.name), &format!("founder {:?}: cue_rules", f.name), &f.cue_rules)?;
        match (&f.mother, f.daughter) {
            (Some(_), None) => {
                return Err(self.founder_error(
                    f,
                    "daughter",
                    "(not given)",
                    "larger or smaller where a mother is given",
                ));
            }
            (None, Some(_)) => {
                return Err(self.founder_error(
                    f,
                    "mother",
                    "(not given)",
                    "the mother's name where a daughter is given",
                ));
            }
            _ => {}
        }
        if let Some((field, value, allowed)) = f.observed.and_then(|observed| observed.contradiction()) {
            return Err(self.founder_error(f, &format!("observed.{field}"), value, allowed));
        }
        Ok(())
    }

    fn physics(&self, f: &Founder) -> Result<(), InputError> {
        if let Some(given) = f.r0 {
            let units = self.lineage.units();
            let r0 = given
                .in_units(&units)
                .map_err(|allowed| self.founder_error(f, "r0", format!("\"{given}\""), allowed))?;
            if !(r0.is_finite() && r0 > 0.0) {
                return Err(self.founder_error(f, "r0", given, "a finite number above 0"));
            }
        }
        for (parameter, value) in f.physics.values() {
            if let Some(allowed) = parameter.refuses(value) {
                return Err(self.founder_error(f, &format!("physics.{parameter}"), value, allowed));
            }
        }
        Ok(())
    }

    fn mothers(&self, index: &HashMap<&str, usize>) -> Result<Vec<Option<usize>>, InputError> {
        let mut mother = Vec::with_capacity(self.lineage.founders.len());
        for f in &self.lineage.founders {
            mother.push(match f.mother.as_deref() {
                None => None,
                Some(name) => Some(*index.get(name).ok_or_else(|| {
                    let names: Vec<&str> = self.lineage.founders.iter().map(|f| f.name.as_str()).collect();
                    let allowed = format!("a founder of this file: {}", names.join(", "));
                    self.founder_error(f, "mother", format!("{name:?}"), allowed)
                })?),
            });
        }
        Ok(mother)
    }

    /// Exactly one first cell, and every founder descends from it.
    fn one_tree(&self, mother: &[Option<usize>]) -> Result<(), InputError> {
        let founders = &self.lineage.founders;
        // Founders known to reach the first cell; each is walked through once.
        let mut reaches = vec![false; founders.len()];
        let mut walk = vec![usize::MAX; founders.len()];
        for start in 0..founders.len() {
            let mut path = vec![];
            let mut at = Some(start);
            while let Some(i) = at {
                if reaches[i] {
                    break;
                }
                if walk[i] == start {
                    let from = path.iter().position(|&j| j == i).unwrap_or(0);
                    let mut ring: Vec<&str> = path[from..].iter().map(|&j: &usize| founders[j].name.as_str()).collect();
                    ring.push(ring[0]);
                    let message = format!(
                        "the founders' mothers form a cycle: {}; one founder must have no mother, and all others descend from it",
                        ring.join(" <- ")
                    );
                    return Err(InputError::Founders { file: self.place(&founders[i].name), message });
                }
                walk[i] = start;
                path.push(i);
                at = mother[i];
            }
            path.into_iter().for_each(|i| reaches[i] = true);
        }
        let first: Vec<&str> = founders.iter().filter(|f| f.mother.is_none()).map(|f| f.name.as_str()).collect();
        if first.len() > 1 {
            let message = format!("founders {} have no mother; exactly one founder may have none", first.join(", "));
            return Err(InputError::Founders { file: self.place(first[1]), message });
        }
        Ok(())
    }

    /// Below each founder: no founder, or a larger and a smaller one.
    fn pairs(&self, mother: &[Option<usize>]) -> Result<(), InputError> {
        let founders = &self.lineage.founders;
        let mut taken: HashMap<(usize, bool), usize> = HashMap::new();
        for (i, f) in founders.iter().enumerate() {
            let (Some(m), Some(daughter)) = (mother[i], f.daughter) else { continue };
            if let Some(other) = taken.insert((m, daughter == Daughter::Larger), i) {
                let which = if daughter == Daughter::Larger { "larger" } else { "smaller" };
                let allowed = format!("the other one: {:?} is already the {which} daughter", founders[other].name);
                return Err(self.founder_error(f, "daughter", which, allowed));
            }
        }
        for (i, f) in founders.iter().enumerate() {
            let Some(m) = mother[i] else { continue };
            let sister_larger = f.daughter == Some(Daughter::Smaller);
            if !taken.contains_key(&(m, sister_larger)) {
                let missing = if sister_larger { "larger" } else { "smaller" };
                let message = format!(
                    "founder {:?} is a daughter of {:?}, whose {missing} daughter is not in the list; list both or neither",
                    f.name, founders[m].name
                );
                return Err(InputError::Founders { file: self.place(&f.name), message });
            }
        }
        Ok(())
    }

    /// No founder is called what the naming rule may call another cell.
    fn clashes(&self, mother: &[Option<usize>]) -> Result<(), InputError> {
        let founders = &self.lineage.founders;
        let mut has_listed = vec![false; founders.len()];
        mother.iter().flatten().for_each(|&m| has_listed[m] = true);
        for (i, above) in founders.iter().enumerate().filter(|(i, _)| !has_listed[*i]) {
            for f in founders.iter().filter(|f| f.name != above.name) {
                let Some(rest) = f.name.strip_prefix(above.name.as_str()) else { continue };
                let generated = rest.chars().enumerate().all(|(k, c)| {
                    let (a, p) = self.lineage.letters(i, k + 1);
                    c == a || c == p
                });
                if generated {
                    let allowed =
                        format!("a name that no descendant of {:?} may be given by the naming rule", above.name);
                    return Err(self.founder_error(f, "name", format!("{:?}", f.name), allowed));
                }
            }
        }
        Ok(())
    }
}
