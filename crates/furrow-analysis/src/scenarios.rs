//! Scenarios side by side: lineages and cues in every combination, grown in one run.
//!
//! ```
//! use furrow_lineage::{Lineage, TreeSettings};
//! use furrow_analysis::scenarios::{Source, combine};
//!
//! let worm = Source { label: "c_elegans".into(), lineage: Lineage::c_elegans()?, settings: TreeSettings::default() };
//! let scenarios = combine(&[worm], &["germline", "none", "tension:gradient,amplitude=0.3"])?;
//! let names: Vec<&str> = scenarios.iter().map(|scenario| scenario.name.as_str()).collect();
//! assert_eq!(names, ["c_elegans-germline", "c_elegans-none", "c_elegans-cue-3"]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use furrow_cell::{Cue, CueError};
pub use furrow_lineage::Scenario;
use furrow_lineage::batch::{Memo, SchedulerOptions};
use furrow_lineage::{EndRule, Grower, Length, Lineage, TreeSettings, named_cue};
use std::collections::{BTreeMap, HashSet};

/// Names that scenarios must not have: files beside their folders have them.
const TAKEN: [&str; 6] = ["scenarios.csv", "report.html", "run.json", "tree.json", "tree.nwk", "tree.svg"];
/// Longest name of a scenario before a number is added to make it unique. File systems take 255 bytes.
const LONGEST: usize = 80;

/// A lineage to grow scenarios from.
#[derive(Clone, Debug)]
pub struct Source {
    /// Its name in tables, for example its file's name.
    pub label: String,
    /// Founders and rules.
    pub lineage: Lineage,
    /// Parameters of its divisions.
    pub settings: TreeSettings,
}

/// Why there are no scenarios.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ScenarioError {
    /// An invalid cue, in one of the lineages.
    #[error(transparent)]
    Cue(#[from] CueError),
    /// Two scenarios are one.
    #[error("duplicate scenarios: {first} and {second}")]
    Same {
        /// The first scenario's lineage and cue.
        first: String,
        /// The other scenario's lineage and cue.
        second: String,
    },
}

/// Every lineage with every cue; without cues, every lineage as it is. The result is in the order of lineages, then of cues.
///
/// A scenario with a cue given as `NAME=CUE` has that name, with the lineage's label before it if there are several lineages.
/// Others are named after label and cue: a cue of the lineage by its name, a cue given as terms `cue-2` if it is the second.
///
/// # Errors
/// Two scenarios that would grow the same tree beside the same counts are refused and not merged, even if they are written
/// differently. A merged table would lack a requested column without notice, and a duplicate is usually a mistake.
pub fn combine(sources: &[Source], cues: &[&str]) -> Result<Vec<Scenario>, ScenarioError> {
    let mut scenarios: Vec<Scenario> = Vec::new();
    let (mut folders, mut names) = (HashSet::from(TAKEN.map(str::to_owned)), HashSet::new());
    for Source { label, lineage, settings } in sources {
        let plain = || (label.clone(), false, None, lineage.clone());
        let mut variants = if cues.is_empty() { vec![plain()] } else { Vec::new() };
        for (k, text) in cues.iter().enumerate() {
            let (called, cue) = named_cue(text)?;
            let name = match called {
                Some(called) if sources.len() == 1 => called.to_owned(),
                Some(called) => format!("{label}-{called}"),
                None if lineage.cue(cue).is_some() => format!("{label}-{cue}"),
                None => format!("{label}-cue-{}", k + 1),
            };
            variants.push((name, called.is_some(), Some(cue.to_owned()), lineage.carrying(text, &settings.cell)?));
        }
        for (name, named, cue, lineage) in variants {
            let folder = unique(&safe(&name), &mut folders);
            let name = unique(if named { &name } else { &folder }, &mut names);
            scenarios.push(Scenario { name, folder, label: label.clone(), cue, lineage, settings: settings.clone() });
        }
    }
    refuse_equals(&scenarios)?;
    Ok(scenarios)
}

/// What grows each scenario.
pub fn growers<'s>(
    scenarios: &'s [Scenario],
    ends: EndRule<'s>,
    memo: &'s Memo,
    options: SchedulerOptions<'s>,
) -> Vec<Grower<'s>> {
    let grower = |Scenario { lineage, settings, .. }: &'s Scenario| Grower {
        lineage,
        settings: settings.clone(),
        ends,
        memo,
        options,
    };
    scenarios.iter().map(grower).collect()
}

/// Names of devices on Windows, with any extension.
const DEVICES: [&str; 4] = ["con", "prn", "aux", "nul"];

/// Whether Windows takes a file of that name for a device.
fn is_device(name: &str) -> bool {
    let stem = name.split('.').next().unwrap_or(name).to_lowercase();
    let port = stem.strip_prefix("com").or(stem.strip_prefix("lpt"));
    DEVICES.contains(&stem.as_str())
        || port.is_some_and(|digit| digit.len() == 1 && digit.chars().all(|c| c.is_ascii_digit()))
}

/// A name with what file systems, shells and drawings take everywhere: ASCII letters, digits, `-`, `_` and `.`, no dot at an end
/// of it, and no device.
fn safe(name: &str) -> String {
    let allowed = |c: char| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '-' };
    let name: String = name.chars().map(allowed).take(LONGEST).collect();
    match name.trim_matches('.') {
        "" => "scenario".to_owned(),
        name if is_device(name) => format!("scenario-{name}"),
        name => name.to_owned(),
    }
}

/// The name, with a number behind it if it is taken. Some file systems take `A` and `a` for one.
fn unique(name: &str, taken: &mut HashSet<String>) -> String {
    let numbered = (2..).map(|k| format!("{name}-{k}"));
    let free = std::iter::once(name.to_owned()).chain(numbered).find(|name| taken.insert(name.to_lowercase()));
    free.unwrap_or_else(|| name.to_owned())
}

fn refuse_equals(scenarios: &[Scenario]) -> Result<(), ScenarioError> {
    let essences: Vec<Lineage> = scenarios.iter().map(essence).collect();
    for (k, second) in scenarios.iter().enumerate() {
        for (j, first) in scenarios[..k].iter().enumerate() {
            if essences[j] == essences[k] && first.settings == second.settings {
                return Err(ScenarioError::Same { first: first.made_of(), second: second.made_of() });
            }
        }
    }
    Ok(())
}

/// The lineage without what two that grow alike may differ in: its name and source, how lengths are written, what cues are
/// called, and those that no cell can carry.
fn essence(Scenario { lineage, settings, .. }: &Scenario) -> Lineage {
    let mut bare = lineage.clone();
    let units = lineage.units();
    bare.name.clear();
    (bare.citation, bare.units) = (None, None);
    let text = |cue: &Cue| settings.cell.clone().with_cue(cue.clone()).simplified_cue().to_string();
    let called: BTreeMap<&String, String> = lineage.cues.iter().map(|(name, cue)| (name, text(cue))).collect();
    let mut rename = |name: &mut String| {
        if let Some(text) = called.get(name) {
            name.clone_from(text);
        }
    };
    bare.cue_rules.iter_mut().for_each(|rule| rename(&mut rule.cue));
    for founder in &mut bare.founders {
        founder.cue.iter_mut().for_each(&mut rename);
        founder.cue_rules.iter_mut().for_each(|rule| rename(&mut rule.cue));
        founder.r0 = founder.r0.map(|length| Length::Natural(length.in_units(&units)));
    }
    bare.cues.clear();
    bare
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(label: &str) -> Source {
        let lineage = Lineage::c_elegans().unwrap();
        Source { label: label.to_owned(), lineage, settings: TreeSettings::default() }
    }

    fn names(sources: &[Source], cues: &[&str]) -> Vec<String> {
        combine(sources, cues).unwrap().into_iter().map(|scenario| scenario.name).collect()
    }

    #[test]
    fn names_are_safe_and_unique() {
        let mut other = source("../a b/Käfer.");
        other.settings.seed = 1;
        assert_eq!(names(&[source("worm"), other.clone()], &[]), ["worm", "-a-b-K-fer"]);
        other.label = "WORM".to_owned();
        assert_eq!(names(&[source("worm"), other.clone()], &["none"]), ["worm-none", "WORM-none-2"]);
        for (label, folder) in
            [("con", "scenario-con"), ("NUL.txt", "scenario-NUL.txt"), ("com1", "scenario-com1"), ("comb", "comb")]
        {
            other.label = label.to_owned();
            assert_eq!(names(std::slice::from_ref(&other), &[]), [folder]);
            other.label = "x".to_owned();
            assert_eq!(combine(std::slice::from_ref(&other), &[&format!("{label}=none")]).unwrap()[0].folder, folder);
        }
        other.label = "run.json".to_owned();
        assert_eq!(names(&[source("..."), other.clone()], &[]), ["scenario", "run.json-2"]);
        other.label = "x".repeat(500);
        assert_eq!(names(&[other], &["none"])[0].len(), LONGEST);
    }

    #[test]
    fn a_scenario_has_the_name_that_its_cue_is_given() {
        let cues = [
            "my tension=tension:gradient,amplitude=0.3",
            "germline",
            "My Tension=none",
            "tension:gradient,amplitude=0.2",
        ];
        let found = combine(&[source("worm")], &cues).unwrap();
        let of = |field: fn(&Scenario) -> &str| found.iter().map(field).collect::<Vec<_>>();
        assert_eq!(of(|s| &s.name), ["my tension", "worm-germline", "My Tension-2", "worm-cue-4"]);
        assert_eq!(of(|s| &s.folder), ["my-tension", "worm-germline", "My-Tension-2", "worm-cue-4"]);
        assert_eq!(found[0].cue.as_deref(), Some("tension:gradient,amplitude=0.3"));
        assert!(found[0].lineage.cue("my-tension").is_some());
        assert_eq!(names(&[source("a"), other_seed("b")], &["x=none"]), ["a-x", "b-x"]);
        for wrong in ["=none", "none=germline", "a\u{1}=none"] {
            let said = combine(&[source("worm")], &[wrong]).unwrap_err().to_string();
            assert!(said.contains("a name before ="), "{wrong}: {said}");
        }
    }

    fn other_seed(label: &str) -> Source {
        let mut other = source(label);
        other.settings.seed = 1;
        other
    }

    #[test]
    fn the_same_scenario_is_refused_however_it_is_written() {
        let same = |cues: &[&str]| combine(&[source("worm")], cues).unwrap_err().to_string();
        let said = "duplicate scenarios: worm with the cue none and worm with the cue none";
        assert_eq!(same(&["none", "none"]), said);
        assert!(
            same(&["germline", "none", "kappa:band,u0=0.465,omega=0.0577,amplitude=0.1"])
                .contains("duplicate scenarios")
        );
        assert!(same(&["none", "tension:gradient,amplitude=0"]).contains("duplicate scenarios"));
        assert!(combine(&[source("a"), source("b")], &[]).is_err());
        let mut other = source("b");
        other.lineage.founders[0].r0 = Some(Length::Natural(5.0));
        assert_eq!(names(&[source("a"), other], &["germline", "none"]).len(), 4);
        let wrong = combine(&[source("worm")], &["none", "germlnie"]).unwrap_err().to_string();
        assert!(wrong.contains("germlnie") && wrong.contains("germline"), "{wrong}");
    }
}
