//! Rules of a lineage that can never apply.

use std::collections::BTreeSet;

use super::definition::Lineage;
use super::founder::Founder;
use super::rules::{PhysicsRule, Span};
use furrow_cell::{Cell, Parameter};
use furrow_input::shown;

/// A list of rules: its position in the file, its field, and the parameter and the cells of each rule.
struct Rules {
    place: String,
    field: &'static str,
    all: Vec<(String, Span)>,
}

impl Rules {
    /// The lists of rules of the file, or of a founder.
    fn of(place: &str, cue_rules: &[super::CueRule], physics_rules: &[PhysicsRule]) -> [Rules; 2] {
        let cues = cue_rules.iter().map(|rule| ("cue".to_owned(), rule.span())).collect();
        let physics = physics_rules.iter().map(|rule| (rule.parameter.to_string(), rule.span())).collect();
        [("cue_rules", cues), ("physics_rules", physics)].map(|(field, all)| Rules {
            place: place.to_owned(),
            field,
            all,
        })
    }

    /// One sentence for each rule that cannot apply because an earlier rule covers all its cells.
    fn covered(&self) -> impl Iterator<Item = String> {
        self.all.iter().enumerate().filter_map(|(k, (sets, span))| {
            let earlier = self.all[..k].iter().position(|(other, wider)| other == sets && wider.covers(span))?;
            let Rules { place, field, .. } = self;
            let of = if sets == "cue" { String::new() } else { format!(" for {sets}") };
            Some(format!(
                "{place}{field}[{k}] never acts: {field}[{earlier}] comes first{of} and applies to all its cells"
            ))
        })
    }
}

/// The position of a founder's fields in the file.
fn place_of(founder: &Founder) -> String {
    format!("founder {}: ", shown(&founder.name))
}

impl Lineage {
    /// Rules that can never apply, because an earlier rule covers all their cells or because all founders have rules. One sentence
    /// for each.
    pub fn idle_rules(&self) -> Vec<String> {
        let of_founders = self
            .founders
            .iter()
            .flat_map(|founder| Rules::of(&place_of(founder), &founder.cue_rules, &founder.physics_rules));
        let lists = Rules::of("", &self.cue_rules, &self.physics_rules).into_iter().chain(of_founders);
        let mut idle: Vec<String> = lists.flat_map(|rules| rules.covered().collect::<Vec<_>>()).collect();
        let own_cues = |founder: &Founder| founder.cue.is_some() || !founder.cue_rules.is_empty();
        if !self.cue_rules.is_empty() && self.founders.iter().all(own_cues) {
            idle.push("cue_rules never act: every founder has a cue or cue_rules of its own".to_owned());
        }
        if !self.physics_rules.is_empty() && self.founders.iter().all(|founder| !founder.physics_rules.is_empty()) {
            idle.push("physics_rules never act: every founder has physics_rules of its own".to_owned());
        }
        idle
    }

    /// Rules for a number that no cue of their cells has; one sentence for each.
    pub fn rules_without_cue(&self) -> Vec<String> {
        let of_file: Vec<&Founder> = self.founders.iter().filter(|founder| founder.physics_rules.is_empty()).collect();
        let names = of_file.iter().flat_map(|founder| self.cues_below(founder)).collect();
        // Rules that apply to no founder are reported by `idle_rules`.
        let rules = if of_file.is_empty() { &[] } else { &self.physics_rules[..] };
        let mut idle = self.without_cue("", rules, &names);
        for founder in &self.founders {
            let names = self.cues_below(founder).collect();
            idle.extend(self.without_cue(&place_of(founder), &founder.physics_rules, &names));
        }
        idle
    }

    /// Names of the possible cues of a founder and its descendants up to the next founder.
    fn cues_below<'a>(&'a self, founder: &'a Founder) -> impl Iterator<Item = &'a str> {
        let rules = match &founder.cue {
            _ if !founder.cue_rules.is_empty() => &founder.cue_rules[..],
            Some(_) => &[],
            None => &self.cue_rules[..],
        };
        founder.cue.iter().chain(rules.iter().map(|rule| &rule.cue)).map(String::as_str)
    }

    fn without_cue(&self, place: &str, rules: &[PhysicsRule], names: &BTreeSet<&str>) -> Vec<String> {
        let has = |parameter: Parameter, name: &&str| {
            self.cue(name).is_some_and(|cue| parameter.is_of(&Cell::new(1.0).with_cue(cue)))
        };
        let acts = |parameter: Parameter| !parameter.is_of_cue() || names.iter().any(|name| has(parameter, name));
        let idle = rules.iter().enumerate().filter(|(_, rule)| !acts(rule.parameter));
        idle.map(|(k, rule)| format!("{place}physics_rules[{k}] never acts: no cell has a cue with {}", rule.parameter))
            .collect()
    }
}
