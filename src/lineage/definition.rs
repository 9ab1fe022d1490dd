//! The lineage file: founders, cues, naming, limits, and the observed counts they are set beside.

use crate::cortex::Cue;
use crate::input::{InputError, parse_ron, read_text};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, HashMap};
use std::path::Path;

/// The built-in lineage file, `lineages/c_elegans.ron`.
pub const C_ELEGANS: &str = include_str!("../../lineages/c_elegans.ron");

/// Which daughter of an unequal division a founder is. Of equal daughters the one listed first takes the first place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Daughter {
    /// The larger daughter.
    Larger,
    /// The smaller daughter.
    Smaller,
}

/// Rounds of division from a founder to each terminal cell, as observed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObservedRounds {
    /// Fewest rounds.
    pub min: u32,
    /// Mean over terminal cells.
    pub mean: f64,
    /// Most rounds.
    pub max: u32,
    /// Generations, counted from the founder, that doubled fully.
    pub full_doublings: u32,
    /// Terminal cells, deaths included.
    pub terminal: u32,
    /// Terminal cells that die.
    #[serde(default)]
    pub deaths: u32,
}

/// One founder cell.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Founder {
    /// Name, unique in the file.
    pub name: String,
    /// The founder that divides into it; none for the first cell.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mother: Option<String>,
    /// Which of the mother's daughters it is; given exactly when `mother` is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub daughter: Option<Daughter>,
    /// Name of its cue, carried on by its descendants up to the next founder; `none` if not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cue: Option<String>,
    /// Radius R0 in place of the one its mother's division (or the physics, for the first cell) gives, in L_h.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub r0: Option<f64>,
    /// Letters (anterior, posterior) of the generations below it; the file's `naming` after these.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub letters: Vec<(char, char)>,
    /// Observed rounds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sulston: Option<ObservedRounds>,
}

/// Limits that stop a lineage that does not end by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Limits {
    /// Most generations below the first cell.
    pub max_depth: u32,
    /// Most cells, all generations together.
    pub max_cells: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Limits { max_depth: 200, max_cells: 1_000_000 }
    }
}

fn default_naming() -> (char, char) {
    ('a', 'p')
}

/// A lineage as its file gives it. [`Lineage::parse`] has checked it: one first cell, every mother and cue known, no
/// cycle, two founders or none below each founder, names that cannot clash.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lineage {
    /// The organism.
    pub name: String,
    /// Source of the observed counts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub citation: Option<String>,
    /// Letters added to the mother's name for the (anterior, posterior) daughter.
    #[serde(default = "default_naming")]
    pub naming: (char, char),
    /// Limits.
    #[serde(default)]
    pub limits: Limits,
    /// Cues by name. `none` always exists.
    #[serde(default)]
    pub cues: BTreeMap<String, Cue>,
    /// Founders, in the order tables list them.
    pub founders: Vec<Founder>,
}

impl Lineage {
    /// The built-in C. elegans founders.
    pub fn c_elegans() -> Result<Lineage, InputError> {
        Lineage::parse(C_ELEGANS, "c_elegans.ron (built in)")
    }

    /// Reads and checks a lineage file.
    pub fn read(path: &Path) -> Result<Lineage, InputError> {
        Lineage::parse(&read_text(path)?, &path.display().to_string())
    }

    /// The lineage of a file if one is given, else the built-in one.
    pub fn load(path: Option<&Path>) -> Result<Lineage, InputError> {
        path.map_or_else(Lineage::c_elegans, Lineage::read)
    }

    /// Reads and checks a lineage from RON text; `file` is what errors call it.
    pub fn parse(text: &str, file: &str) -> Result<Lineage, InputError> {
        let lineage: Lineage = parse_ron(text, file)?;
        Check { lineage: &lineage, text, file }.run()?;
        Ok(lineage)
    }

    /// The first cell: the founder without a mother (an index into `founders`).
    pub fn first(&self) -> usize {
        self.founders.iter().position(|f| f.mother.is_none()).unwrap_or(0)
    }

    /// The cue called `name`; `none` is always defined.
    pub fn cue(&self, name: &str) -> Option<Cue> {
        match name {
            "none" => Some(Cue::None),
            _ => self.cues.get(name).copied(),
        }
    }

    /// The cue of a founder.
    pub fn founder_cue(&self, founder: usize) -> Cue {
        self.founders[founder].cue.as_deref().and_then(|name| self.cue(name)).unwrap_or(Cue::None)
    }

    /// For each founder its listed daughters (larger, smaller), and whether the larger is listed first.
    pub fn daughters(&self) -> Vec<Option<ListedDaughters>> {
        let index: HashMap<&str, usize> = self.founders.iter().enumerate().map(|(i, f)| (f.name.as_str(), i)).collect();
        let mut pairs = vec![(None, None); self.founders.len()];
        for (i, f) in self.founders.iter().enumerate() {
            if let Some(&mother) = f.mother.as_deref().and_then(|m| index.get(m)) {
                match f.daughter {
                    Some(Daughter::Smaller) => pairs[mother].1 = Some(i),
                    _ => pairs[mother].0 = Some(i),
                }
            }
        }
        pairs
            .into_iter()
            .map(|(larger, smaller)| Some(ListedDaughters { larger: larger?, smaller: smaller? }))
            .collect()
    }

    /// Letters (anterior, posterior) of the daughters born `generation` rounds below a founder (1 = its own daughters).
    pub fn letters(&self, founder: usize, generation: usize) -> (char, char) {
        let below = generation.checked_sub(1).and_then(|k| self.founders[founder].letters.get(k));
        below.copied().unwrap_or(self.naming)
    }
}

/// The two founders a founder divides into (indices into [`Lineage::founders`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ListedDaughters {
    /// The larger.
    pub larger: usize,
    /// The smaller.
    pub smaller: usize,
}

impl ListedDaughters {
    /// The founder listed first, which the anterior of two equal daughters becomes.
    pub fn first(&self) -> usize {
        self.larger.min(self.smaller)
    }

    /// The founder listed second.
    pub fn second(&self) -> usize {
        self.larger.max(self.smaller)
    }
}

struct Check<'a> {
    lineage: &'a Lineage,
    text: &'a str,
    file: &'a str,
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

    fn run(&self) -> Result<(), InputError> {
        let lineage = self.lineage;
        let limits = lineage.limits;
        if !(1..=100_000).contains(&limits.max_depth) {
            return Err(InputError::not_allowed(self.file, "limits.max_depth", limits.max_depth, "from 1 to 100000"));
        }
        if limits.max_cells < 1 {
            return Err(InputError::not_allowed(self.file, "limits.max_cells", limits.max_cells, "at least 1"));
        }
        self.letters("naming", lineage.naming)?;
        for (name, cue) in &lineage.cues {
            if name == "none" {
                let allowed = "another name: none is the absence of a cue";
                return Err(InputError::not_allowed(self.file, "cues", "\"none\"", allowed));
            }
            check_cue(cue, self.file, &format!("cues[{name:?}]"))?;
        }
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
        if let Some(r0) = f.r0.filter(|r| !(r.is_finite() && *r > 0.0)) {
            return Err(self.founder_error(f, "r0", r0, "a finite number above 0"));
        }
        if let Some(cue) = f.cue.as_deref().filter(|name| self.lineage.cue(name).is_none()) {
            let mut known = vec!["none"];
            known.extend(self.lineage.cues.keys().map(String::as_str));
            return Err(self.founder_error(f, "cue", format!("{cue:?}"), format!("one of {}", known.join(", "))));
        }
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
        if let Some(s) = f.sulston.filter(|s| !(f64::from(s.min) <= s.mean && s.mean <= f64::from(s.max))) {
            let allowed = format!("a number from min = {} to max = {}", s.min, s.max);
            return Err(self.founder_error(f, "sulston.mean", s.mean, allowed));
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

/// Checks a cue's numbers; errors call its fields `field.u0` and so on.
pub fn check_cue(cue: &Cue, source_name: &str, field: &str) -> Result<(), InputError> {
    match *cue {
        Cue::None => Ok(()),
        Cue::Kappa { u0, omega, amplitude } => {
            let bad = |name: &str, value: f64, allowed: &str| {
                Err(InputError::not_allowed(source_name, format!("{field}.{name}"), value, allowed))
            };
            if !(u0 > 0.0 && u0 < 1.0) {
                return bad("u0", u0, "above 0 and below 1");
            }
            if !(omega.is_finite() && omega > 0.0) {
                return bad("omega", omega, "a finite number above 0");
            }
            if !(amplitude.is_finite() && amplitude > -1.0) {
                return bad("amplitude", amplitude, "a finite number above -1");
            }
            Ok(())
        }
    }
}
