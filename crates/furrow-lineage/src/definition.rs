//! The lineage file: founders, cues, naming, limits, and observed counts for comparison.

use std::collections::{BTreeMap, HashMap};

use serde::{Deserialize, Serialize};

use super::clock::{Clock, Lifetimes};
use super::founder::{Daughter, Founder};
use super::rules::{PhysicsRule, Place, Span};
use super::scenario::named_cue;
use super::units::{Length, Units};
use furrow_cell::cue::{split_terms, starts_with_field};
use furrow_cell::{Cell, Cue, CueError, Parameter, ShellChoice};
use furrow_input::{did_you_mean, listed, shown, unique_map};

/// The built-in lineage file, `lineages/c_elegans.ron`.
pub const C_ELEGANS: &str = include_str!("../lineages/c_elegans.ron");

/// The commented template of a lineage file, `lineages/template.ron`.
pub const TEMPLATE: &str = include_str!("../lineages/template.ron");

/// Selects the cells that carry a cue: by generation, by size, or all.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CueRule {
    /// Name of the cue, or `none`.
    pub cue: String,
    /// First generation it applies to; 0 if not given.
    #[serde(default)]
    pub from_generation: u32,
    /// Last generation it applies to; no last one if not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to_generation: Option<u32>,
    /// It applies to cells of a smaller radius R0 than this, in L_h.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub below_r0: Option<f64>,
    /// It applies to cells of a larger radius R0 than this, in L_h.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub above_r0: Option<f64>,
}

impl CueRule {
    /// A rule for cells of all sizes, up to a last generation if there is one.
    fn within(cue: &str, to_generation: Option<u32>) -> CueRule {
        CueRule { cue: cue.to_owned(), from_generation: 0, to_generation, below_r0: None, above_r0: None }
    }

    /// The cells it applies to.
    pub fn span(&self) -> Span {
        let CueRule { from_generation, to_generation, below_r0, above_r0, .. } = *self;
        Span { from_generation, to_generation, below_r0, above_r0 }
    }
}

/// Limits for a lineage that would not end otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Limits {
    /// Largest number of generations below the first cell.
    pub max_depth: u32,
    /// Largest number of cells in all generations together.
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

/// A lineage as defined by its file. [`Lineage::parse`] has checked it: there is one first cell, every mother and cue is known, there
/// are no cycles, below each founder there are two founders or no founder, and names cannot conflict.
///
/// While a file is read, `C` is a [`WrittenCue`](furrow_cell::cue::WrittenCue), since cues may be in µm and seconds, and `L` is
/// [`WrittenLifetimes`](super::clock::WrittenLifetimes), since lifetimes may be in a separate file. `S` is the parameter of [`Founder`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, bound(deserialize = "C: Deserialize<'de>, L: Deserialize<'de>, S: Deserialize<'de>"))]
pub struct Lineage<C = Cue, L = Lifetimes, S = ShellChoice> {
    /// The organism.
    pub name: String,
    /// Source of the observed counts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub citation: Option<String>,
    /// Letters added to the mother's name for the (anterior, posterior) daughter.
    #[serde(default = "default_naming")]
    pub naming: (char, char),
    /// L_h and τ of this embryo.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub units: Option<Units>,
    /// Limits.
    #[serde(default)]
    pub limits: Limits,
    /// Cues by name. `none` always exists.
    #[serde(default, deserialize_with = "unique")]
    pub cues: BTreeMap<String, C>,
    /// Cues of cells without a cue from their founder, by the first rule that applies. Generations are counted from
    /// the first cell.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cue_rules: Vec<CueRule>,
    /// Parameters of cells without such rules from their founder, by the first rule for each that applies. Generations are
    /// counted from the first cell.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub physics_rules: Vec<PhysicsRule>,
    /// Names of cells that die instead of dividing, with `*` for any letters.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub dies: Vec<String>,
    /// The lifetimes of cells; without a clock trees have no minutes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clock: Option<Clock<L>>,
    /// Founders, in the order of the tables.
    pub founders: Vec<Founder<S>>,
    /// Suspicious features of the notation of the file.
    #[serde(skip)]
    pub written: Written,
}

/// Features of the notation of a lineage file. They are not part of the lineage: lineages in different notations are equal, and other
/// files do not store them.
#[derive(Clone, Copy, Debug, Default)]
pub struct Written {
    /// Whether a cue has a number in µm.
    pub cues_in_micrometres: bool,
}

impl PartialEq for Written {
    fn eq(&self, _: &Written) -> bool {
        true
    }
}

/// Whether a name matches a pattern with `*` for any letters.
///
/// ```
/// use furrow_lineage::definition::matches;
///
/// assert!(matches("AB*aapp", "ABalpaapp") && matches("E", "E") && matches("*", "E"));
/// assert!(!matches("AB*aapp", "ABalpaapa") && !matches("E", "Ea"));
/// ```
pub fn matches(pattern: &str, name: &str) -> bool {
    let Some((first, rest)) = pattern.split_once('*') else { return pattern == name };
    let Some(mut left) = name.strip_prefix(first) else { return false };
    let mut parts = rest.split('*').peekable();
    while let Some(part) = parts.next() {
        if parts.peek().is_none() {
            return left.ends_with(part);
        }
        let Some(at) = left.find(part) else { return false };
        left = &left[at + part.len()..];
    }
    true
}

/// Radius in L_h above which a number without a unit is probably in µm: a zygote has 5.4, and divisions above this limit take long.
const DOUBTFUL: f64 = 12.0;

impl Lineage {
    /// The first cell: the founder without a mother (an index into `founders`).
    pub fn first(&self) -> usize {
        self.founders.iter().position(|f| f.mother.is_none()).unwrap_or(0)
    }

    /// L_h and τ; unknown if the file does not give them, except that radii in µm imply the worm's L_h.
    pub fn units(&self) -> Units {
        let given = self.units.unwrap_or_default();
        self.founders.iter().filter_map(|founder| founder.r0).fold(given, Units::asked_in)
    }

    /// The radius R0 of a founder given in the file, in L_h.
    pub fn given_r0(&self, founder: usize) -> Option<f64> {
        self.founders[founder].r0.map(|length| length.in_units(&self.units()))
    }

    /// Multiplies all radii given in the file by a factor.
    pub fn scale_radii(&mut self, factor: f64) {
        let units = self.units();
        let of_founders = self.founders.iter_mut().filter_map(|founder| founder.r0.as_mut());
        of_founders.for_each(|r0| *r0 = Length::Natural(factor * r0.in_units(&units)));
    }

    /// One sentence for each radius without a unit, and hence in L_h, that is more likely a length in µm. Only files
    /// that give L_h can confuse the two. For other files with radii in µm a message states the L_h that is used.
    pub fn doubtful_radii(&self) -> Vec<String> {
        let units = self.units();
        if self.units.and_then(|units| units.length_um).is_none() && units.length_um.is_some() {
            return vec![self.length_is_taken("radii")];
        }
        let doubt = |founder: &Founder| match (founder.r0, units.length_um) {
            (Some(Length::Natural(r0)), Some(_)) if r0 > DOUBTFUL => Some(format!(
                "founder {:?}: r0 = {r0} is in L_h{}; if it is in µm, write r0: \"{r0}um\"",
                founder.name,
                units.in_micrometres(r0),
            )),
            _ => None,
        };
        self.founders.iter().filter_map(doubt).collect()
    }

    /// Warnings about the file, one sentence each: [`doubtful_radii`](Self::doubtful_radii), [`doubtful_sums`](Self::doubtful_sums),
    /// widths of cues in µm without a value of L_h, and [`idle_rules`](Self::idle_rules).
    pub fn doubts(&self) -> Vec<String> {
        let mut doubts = self.doubtful_radii();
        doubts.extend(self.doubtful_sums());
        if self.written.cues_in_micrometres && self.units().length_um.is_none() {
            doubts.push(self.length_is_taken("numbers of cues"));
        }
        doubts.extend(self.idle_rules());
        doubts
    }

    /// States the L_h that is used if the file does not give it but has lengths in µm.
    fn length_is_taken(&self, what: &str) -> String {
        let length = self.units().length_um();
        format!(
            "{what} are in µm, and the lineage does not say how long L_h is: {length} µm is taken, the worm's; \
             add units: (length_um: …)"
        )
    }

    /// The cue called `name`; `none` is always defined.
    pub fn cue(&self, name: &str) -> Option<Cue> {
        if name == "none" { Some(Cue::none()) } else { self.cues.get(name).cloned() }
    }

    /// Removes the given radius of the first cell, so that another one can be used.
    pub fn forget_first_radius(&mut self) {
        self.founders.iter_mut().filter(|founder| founder.mother.is_none()).for_each(|founder| founder.r0 = None);
    }

    /// The founder that divides into a founder; `None` for the first cell.
    pub fn mother(&self, founder: usize) -> Option<usize> {
        self.founder_named(self.founders[founder].mother.as_ref()?)
    }

    /// The founder of this name.
    pub fn founder_named(&self, name: &str) -> Option<usize> {
        self.founders.iter().position(|founder| founder.name == name)
    }

    /// Volume at division divided by volume at birth, of a founder and its descendants.
    pub fn growth(&self, founder: usize) -> f64 {
        self.founders[founder].growth.unwrap_or(1.0)
    }

    /// Whether a cell dies instead of dividing.
    pub fn dies(&self, name: &str) -> bool {
        self.dies.iter().any(|pattern| matches(pattern, name))
    }

    /// Number of divisions from the first cell to a founder.
    pub fn generation(&self, founder: usize) -> u32 {
        self.mother(founder).map_or(0, |mother| 1 + self.generation(mother))
    }

    /// Name of the cue of a cell at a given place.
    pub(crate) fn cue_name_at(&self, place: Place) -> &str {
        let founder = &self.founders[place.founder];
        let (rules, generation) = match &founder.cue {
            _ if !founder.cue_rules.is_empty() => (&founder.cue_rules, place.round),
            Some(name) if place.apart == 0 && (place.round == 0 || founder.inherit) => return name,
            Some(_) => return "none",
            None => (&self.cue_rules, place.generation),
        };
        rules.iter().find(|rule| rule.span().includes(generation, place.r0)).map_or("none", |rule| &rule.cue)
    }

    /// The cue of a cell at a given place.
    pub fn cue_at(&self, place: Place) -> Cue {
        self.cue(self.cue_name_at(place)).unwrap_or_default()
    }

    /// Whether a founder or its descendants have a cue with an effect in a cell with the law of `cell`.
    pub fn gives_cue(&self, founder: usize, cell: &Cell) -> bool {
        let founder = &self.founders[founder];
        let acts = |name: &String| self.cue(name).is_some_and(|cue| cell.clone().with_cue(cue).has_cue());
        founder.cue.iter().chain(founder.cue_rules.iter().map(|rule| &rule.cue)).any(acts)
    }

    /// Whether every cue named by a founder or a rule is `none`.
    pub fn is_without_cues(&self) -> bool {
        let of_founder = |founder: &Founder| without(founder.cue.iter()) && without(names(&founder.cue_rules));
        self.founders.iter().all(of_founder) && without(names(&self.cue_rules))
    }

    /// The first cell and the successive founders that are smaller daughters: the line that carries the cue in the
    /// built-in lineage.
    pub fn smaller_line(&self) -> Vec<usize> {
        let below = self.daughters();
        std::iter::successors(Some(self.first()), |&founder| below[founder].map(|(_, smaller)| smaller)).collect()
    }

    /// The same lineage with every cue of its founders and rules replaced by another, named cue. If they have no cue,
    /// the founders of [`smaller_line`](Self::smaller_line) get it, and their descendants up to the next founder inherit it.
    ///
    /// ```
    /// use furrow_cell::{Cell, Cue};
    /// use furrow_lineage::Lineage;
    ///
    /// let lineage = Lineage::c_elegans()?.with_cues_replaced("none", &Cue::none());
    /// assert!((0..lineage.founders.len()).all(|founder| !lineage.gives_cue(founder, &Cell::new(5.4))));
    /// # Ok::<(), furrow_input::InputError>(())
    /// ```
    pub fn with_cues_replaced(mut self, name: &str, cue: &Cue) -> Lineage {
        let (mut name, was_without) = (name.to_owned(), self.is_without_cues());
        if name != "none" {
            // A different cue with this name is kept.
            while self.cues.get(&name).is_some_and(|other| other != cue) {
                name.push('*');
            }
            self.cues.insert(name.clone(), cue.clone());
            if was_without {
                for founder in self.smaller_line() {
                    let founder = &mut self.founders[founder];
                    (founder.cue, founder.inherit) = (Some(name.clone()), true);
                    founder.cue_rules.clear();
                }
                return self;
            }
        }
        let of_founders = self
            .founders
            .iter_mut()
            .flat_map(|founder| founder.cue_rules.iter_mut().map(|rule| &mut rule.cue).chain(&mut founder.cue));
        let all = of_founders.chain(self.cue_rules.iter_mut().map(|rule| &mut rule.cue));
        all.filter(|given| given.as_str() != "none").for_each(|given| name.clone_into(given));
        self
    }

    /// [`with_cues_replaced`](Self::with_cues_replaced) for cells like `cell`. If their law uses a regulator, this is a substance in every
    /// cell: cells without the cue have its regulator as the cue `regulator`, without a source that distinguishes the poles.
    pub fn with_cue_in_cells(self, name: &str, cue: &Cue, cell: &Cell) -> Lineage {
        let everywhere = cue.unpolarised().filter(|_| cell.law_reads_regulator() && name != "none");
        let mut lineage = self.with_cues_replaced(name, cue);
        if let Some(alone) = everywhere {
            let mut called = "regulator".to_owned();
            if alone == *cue {
                // The replaced cue may have a name other than the requested one; any name of the same cue is valid.
                let same = lineage.cues.iter().find(|(_, other)| **other == alone).map(|(name, _)| name.clone());
                called = same.unwrap_or(called);
            }
            while lineage.cues.get(&called).is_some_and(|other| *other != alone) {
                called.push('*');
            }
            lineage.cues.insert(called.clone(), alone);
            lineage.give_to_others(&called);
        }
        lineage
    }

    /// Gives a cue to all cells without one, except those that do not inherit a cue because of `cue_passes_to`.
    fn give_to_others(&mut self, cue: &str) {
        let others = |rules: &mut Vec<CueRule>| {
            rules.iter_mut().filter(|rule| rule.cue == "none").for_each(|rule| cue.clone_into(&mut rule.cue));
            rules.push(CueRule::within(cue, None));
        };
        others(&mut self.cue_rules);
        for founder in &mut self.founders {
            match founder.cue.take() {
                _ if !founder.cue_rules.is_empty() => others(&mut founder.cue_rules),
                Some(own) if own == "none" => (founder.cue, founder.inherit) = (Some(cue.to_owned()), true),
                Some(own) if !founder.inherit => {
                    founder.cue_rules = vec![CueRule::within(&own, Some(0)), CueRule::within(cue, None)];
                    founder.inherit = true;
                }
                own => founder.cue = own,
            }
        }
    }

    /// Sets a number of the cue of one founder, in a copy of this cue. Nothing changes if the founder has no cue, or if the cue lacks
    /// this number.
    pub fn set_own_cue(&mut self, founder: usize, parameter: Parameter, value: f64) {
        let Founder { name, cue: Some(called), .. } = &self.founders[founder] else { return };
        let Some(cue) = self.cues.get(called).filter(|cue| parameter.is_of(&Cell::new(1.0).with_cue((*cue).clone())))
        else {
            return;
        };
        let mut cell = Cell::new(1.0).with_cue(cue.clone());
        parameter.set(&mut cell, value);
        let of = format!("@{name}");
        let own = if called.ends_with(&of) { called.clone() } else { format!("{called}{of}") };
        self.cues.insert(own.clone(), cell.cue);
        self.founders[founder].cue = Some(own);
    }

    /// [`with_cue_in_cells`](Self::with_cue_in_cells) like `cell`, for a cue in the user's notation, `CUE` or `NAME=CUE` (see
    /// [`named_cue`]). An unnamed cue of terms is called `given`. Names of cues contain no blanks or quotes, so these become `-`.
    ///
    /// # Errors
    /// As [`parse_cue`](Self::parse_cue).
    pub fn carrying(&self, text: &str, cell: &Cell) -> Result<Lineage, CueError> {
        let (called, text) = named_cue(text)?;
        let cue = self.parse_cue(text)?;
        let called = called.map(|name| name.replace(|c: char| c.is_whitespace() || "\"'".contains(c), "-"));
        let name = match (&called, self.cue(text)) {
            _ if !cell.clone().with_cue(cue.clone()).has_cue() => "none",
            (Some(called), _) => called,
            (None, Some(_)) => text,
            (None, None) => "given",
        };
        Ok(self.clone().with_cue_in_cells(name, &cue, cell))
    }

    /// Parses a cue in the user's notation: `none`, a name of this lineage, or terms, joined by `+`.
    ///
    /// # Errors
    /// [`CueError`] names the part, its text and the allowed values.
    pub fn parse_cue(&self, text: &str) -> Result<Cue, CueError> {
        for part in split_terms(text) {
            if !part.contains(':') && !part.is_empty() && !starts_with_field(part) && self.cue(part).is_none() {
                let names = || self.cues.keys().map(String::as_str);
                let nearest = did_you_mean(part, names().chain(["none"]));
                let known = if self.cues.is_empty() { "none" } else { &format!("none, {},", listed(names(), ", ")) };
                let allowed = format!("{known} or terms FIELD:PROFILE,key=value,.. joined by +{nearest}");
                return Err(CueError { field: "cue".to_owned(), value: shown(part), allowed });
            }
        }
        Cue::parse_with(text, &self.units().scale(), |name| self.cues.get(name).cloned())
    }

    /// The listed daughters (larger, smaller) of each founder.
    pub fn daughters(&self) -> Vec<Option<(usize, usize)>> {
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
        pairs.into_iter().map(|(larger, smaller)| larger.zip(smaller)).collect()
    }

    /// Letters (anterior, posterior) of the daughters born `generation` rounds below a founder (1 = its own daughters).
    pub fn letters(&self, founder: usize, generation: usize) -> (char, char) {
        let below = generation.checked_sub(1).and_then(|k| self.founders[founder].letters.get(k));
        below.copied().unwrap_or(self.naming)
    }
}

/// Names of the cues of rules.
pub(super) fn names(rules: &[CueRule]) -> impl Iterator<Item = &String> {
    rules.iter().map(|rule| &rule.cue)
}

/// Whether all these names of cues are `none`.
fn without<'a>(mut names: impl Iterator<Item = &'a String>) -> bool {
    names.all(|name| name == "none")
}

/// Reads cues by name, and rejects duplicate names.
pub(super) fn unique<'de, C: Deserialize<'de>, D: serde::Deserializer<'de>>(
    deserializer: D,
) -> Result<BTreeMap<String, C>, D::Error> {
    unique_map(deserializer, "cues by name", |name| format!("the cue {name} stands twice"))
}
