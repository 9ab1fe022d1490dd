//! Sulston's names: a cell is named after its mother and the side on which it is born, except for the founders.
//!
//! # References
//! Sulston, Schierenberg, White & Thomson, *Dev. Biol.* 100, 64 (1983).

use std::collections::BTreeMap;
use std::sync::Arc;

use furrow_input::table::split_unit;
use furrow_input::{InputError, did_you_mean, listed};

use crate::matching::Matching;

/// Founders: mother, the daughter named first (the anterior one; of EMS and P4 as in Sulston's chart), the other daughter.
const NAMED: [(&str, &str, &str); 6] = [
    ("P0", "AB", "P1"),
    ("P1", "EMS", "P2"),
    ("EMS", "MS", "E"),
    ("P2", "C", "P3"),
    ("P3", "D", "P4"),
    ("P4", "Z3", "Z2"),
];

/// Founders with descendants that are named by letters.
const STEMS: [&str; 5] = ["AB", "MS", "E", "C", "D"];

/// Letters of two sisters: anterior and posterior, left and right, dorsal and ventral.
const SIDES: [(char, char); 3] = [('a', 'p'), ('l', 'r'), ('d', 'v')];

/// Longest name, in bytes: no known lineage has half as many rounds.
const LONGEST: usize = 64;

/// The other letter of a pair of sides, and whether `letter` is named first.
fn other_side(letter: char) -> Option<(char, bool)> {
    let (first, second) = SIDES.iter().find(|(first, second)| [*first, *second].contains(&letter))?;
    Some(if letter == *first { (*second, true) } else { (*first, false) })
}

/// A cell's mother, its sister, and whether the cell is named before its sister; `None` for P0 and for anything that is not
/// the name of a cell.
///
/// # Examples
/// ```
/// use furrow_measured::names::birth;
/// assert_eq!(birth("ABal"), Some(("ABa", "ABar".to_owned(), true)));
/// assert_eq!(birth("Nuc12"), None);
/// ```
pub fn birth(name: &str) -> Option<(&str, String, bool)> {
    for (mother, first, second) in NAMED {
        if name == first || name == second {
            let sister = if name == first { second } else { first };
            return Some((mother, sister.to_owned(), name == first));
        }
    }
    let (at, last) = name.char_indices().next_back().filter(|_| name.len() <= LONGEST)?;
    let mother = &name[..at];
    let letters = STEMS.iter().find_map(|stem| mother.strip_prefix(stem))?;
    let (other, first) = other_side(last)?;
    letters.chars().all(|letter| other_side(letter).is_some()).then(|| (mother, format!("{mother}{other}"), first))
}

/// The name of a cell as it may be written: with blanks or points between its letters, or a descendant of a founder in
/// capitals; `None` for anything that is not the name of a cell.
///
/// `DVA` is a neuron. Therefore only descendants of AB and MS may be in capitals throughout, and of E, C and D those
/// that come from a first division along the anterior axis, as all of Sulston's do.
///
/// # Examples
/// ```
/// use furrow_measured::names::understood;
/// assert_eq!(understood("AB plp").as_deref(), Some("ABplp"));
/// assert_eq!(understood("ABAL").as_deref(), Some("ABal"));
/// assert_eq!(understood("DVA"), None);
/// ```
pub fn understood(text: &str) -> Option<String> {
    let text = text.trim();
    if is_cell(text) {
        return Some(text.to_owned());
    }
    if let Some(name) = by_side(text) {
        return Some(name.to_owned());
    }
    if text.len() > 2 * LONGEST {
        return None;
    }
    let name: String = text.chars().filter(|c| !c.is_whitespace() && !['.', '-', '_'].contains(c)).collect();
    let in_capitals = || {
        let below = |stem: &&str| {
            let letters = name.strip_prefix(*stem)?.to_ascii_lowercase();
            let fine = stem.len() > 1 || letters.starts_with(['a', 'p']);
            Some(format!("{stem}{letters}")).filter(|_| fine)
        };
        name.chars().all(|c| c.is_ascii_uppercase()).then(|| STEMS.iter().find_map(below))?
    };
    if is_cell(&name) { Some(name) } else { in_capitals().filter(|name| is_cell(name)) }
}

/// The name of a germ cell that is written as P4's daughter.
fn by_side(text: &str) -> Option<&'static str> {
    [("P4a", "Z3"), ("P4p", "Z2")].into_iter().find_map(|(other, name)| (text == other).then_some(name))
}

/// The mother of a cell, if it has one.
fn mother(name: &str) -> Option<&str> {
    birth(name).map(|(mother, ..)| mother)
}

/// The founder that a cell is or descends from, the nearest one; `None` for anything that is not the name of a cell.
///
/// # Examples
/// ```
/// use furrow_measured::names::founder;
/// assert_eq!([founder("MSap"), founder("EMS"), founder("Ea")], [Some("MS"), Some("EMS"), Some("E")]);
/// ```
pub fn founder(name: &str) -> Option<&str> {
    is_cell(name).then(|| std::iter::successors(Some(name), |name| mother(name)).find(|name| is_founder(name)))?
}

/// Whether a cell is one of the founders of the chart.
fn is_founder(name: &str) -> bool {
    name == "P0" || NAMED.iter().any(|(_, first, second)| [*first, *second].contains(&name))
}

/// Whether this is the name of a cell.
pub(crate) fn is_cell(name: &str) -> bool {
    name == "P0" || mother(name).is_some()
}

/// Generations from P0 to a cell.
pub fn generation(name: &str) -> u32 {
    std::iter::successors(mother(name), |name| mother(name)).count() as u32
}

/// A founder of an animal's lineage.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedFounder {
    /// Its name.
    pub name: String,
    /// The place of its mother among the founders; `None` for the first cell.
    pub mother: Option<usize>,
    /// Whether it is the smaller of her daughters.
    pub is_smaller: bool,
    /// Letters of the daughters in the generations below it; the animal's own after these.
    pub letters: Vec<(char, char)>,
}

/// The names of an animal's cells: Sulston's, and those that a lineage gives by its rule.
///
/// # Examples
/// ```
/// use furrow_measured::names::{NamedFounder, Names};
/// let founder = |name: &str, mother, is_smaller| {
///     NamedFounder { name: name.to_owned(), mother, is_smaller, letters: Vec::new() }
/// };
/// let founders = vec![founder("zygote", None, false), founder("upper", Some(0), true), founder("lower", Some(0), false)];
/// let names = Names::of(founders, ('1', '2'));
/// assert_eq!(names.birth("lower21"), Some(("lower2", "lower22".to_owned(), true)));
/// assert_eq!(names.birth("upper"), Some(("zygote", "lower".to_owned(), true)));
/// assert_eq!(names.founder("lower21"), Some("lower"));
/// assert_eq!(names.daughters("zygote"), Some(["lower", "upper"].map(str::to_owned)));
/// assert_eq!(names.daughters("upper1"), Some(["upper11", "upper12"].map(str::to_owned)));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Names {
    founders: Vec<NamedFounder>,
    letters: (char, char),
    /// Whether Sulston's names come first: the lineage has his founders.
    of_worm: bool,
    /// Lifetimes that the lineage gives, in minutes.
    lifetimes: Arc<BTreeMap<String, f64>>,
    /// How cells with other names are matched to these.
    matching: Option<Arc<Matching>>,
}

impl Names {
    /// Names of a lineage with these founders and letters; Sulston's are known beside them.
    pub fn of(founders: Vec<NamedFounder>, letters: (char, char)) -> Names {
        let is_of = |(name, other): (&str, &str)| {
            let mother = founders.iter().find(|founder| founder.name == name).and_then(|founder| founder.mother);
            mother.is_some_and(|mother| founders[mother].name == other)
        };
        let of_worm = [("AB", "P0"), ("P1", "P0")].into_iter().all(is_of);
        Names { founders, letters, of_worm, lifetimes: Arc::default(), matching: None }
    }

    /// These names with the lineage's lifetimes of cells, in minutes. They order the divisions of sisters.
    #[must_use]
    pub fn with_lifetimes(self, lifetimes: BTreeMap<String, f64>) -> Names {
        Names { lifetimes: Arc::new(lifetimes), ..self }
    }

    /// The lifetime of a cell that the lineage gives.
    pub(crate) fn lifetime(&self, name: &str) -> Option<f64> {
        self.lifetimes.get(name).copied()
    }

    /// These names, with a matching of other names. Clones share the record of names that were met.
    ///
    /// # Errors
    /// The matching gives a cell a name that the lineage does not have.
    pub fn matched_by(mut self, mut matching: Matching) -> Result<Names, InputError> {
        matching.understand(&self)?;
        self.matching = (!matching.is_empty()).then(|| Arc::new(matching));
        Ok(self)
    }

    /// How cells with other names are matched to these.
    pub(crate) fn matching(&self) -> Option<&Matching> {
        self.matching.as_deref()
    }

    /// Requires, once all tables are read, that each name in the matching was met.
    ///
    /// # Errors
    /// The first name that no table has.
    pub fn require_met(&self) -> Result<(), InputError> {
        self.matching.as_ref().map_or(Ok(()), |matching| matching.require_met())
    }

    /// Whether the cells are the worm's, so that its published measurements are theirs: the lineage has Sulston's founders, or is not
    /// given.
    pub fn are_of_worm(&self) -> bool {
        self.of_worm || self.founders.is_empty()
    }

    /// The founder (an index) that a cell is or descends from by the lineage's rule, and the letters behind its name.
    fn place<'a>(&self, name: &'a str) -> Option<(usize, &'a str)> {
        let has_listed = |k: usize| self.founders.iter().any(|founder| founder.mother == Some(k));
        self.founders.iter().enumerate().find_map(|(k, founder)| {
            let letters = name.strip_prefix(founder.name.as_str())?;
            let named = |(n, letter): (usize, char)| {
                let (first, second) = self.letters_of(k, n);
                letter == first || letter == second
            };
            let fits = letters.is_empty() || !has_listed(k) && letters.chars().enumerate().all(named);
            fits.then_some((k, letters))
        })
    }

    /// The letters of the daughters that are born `generation` rounds below a founder's own, from 0.
    fn letters_of(&self, founder: usize, generation: usize) -> (char, char) {
        self.founders[founder].letters.get(generation).copied().unwrap_or(self.letters)
    }

    /// As [`birth`].
    pub fn birth<'a>(&'a self, name: &'a str) -> Option<(&'a str, String, bool)> {
        let own = || {
            let (k, letters) = self.place(name)?;
            let Some((at, last)) = letters.char_indices().next_back() else {
                let mother = self.founders[k].mother?;
                let is_sister =
                    |(other, founder): &(usize, &NamedFounder)| *other != k && founder.mother == Some(mother);
                let (other, sister) = self.founders.iter().enumerate().find(is_sister)?;
                return Some((self.founders[mother].name.as_str(), sister.name.clone(), k < other));
            };
            let (first, second) = self.letters_of(k, letters.chars().count() - 1);
            let mother = &name[..name.len() - letters.len() + at];
            let other = if last == first { second } else { first };
            Some((mother, format!("{mother}{other}"), last == first))
        };
        if self.of_worm { birth(name).or_else(own) } else { own().or_else(|| birth(name)) }
    }

    /// The daughters of a cell. Of two founders the larger one is first; of other daughters the one with the first letter; `None` for
    /// anything that is not the name of a cell.
    pub fn daughters(&self, name: &str) -> Option<[String; 2]> {
        let of_chart = || {
            let (_, first, second) = NAMED.into_iter().find(|(mother, ..)| *mother == name)?;
            Some([first.to_owned(), second.to_owned()])
        };
        let own = || {
            let (k, letters) = self.place(name)?;
            let below: Vec<&NamedFounder> = self.founders.iter().filter(|founder| founder.mother == Some(k)).collect();
            if let ([one, other], true) = (&below[..], letters.is_empty()) {
                let is_turned = one.is_smaller && !other.is_smaller;
                return Some(if is_turned { [other, one] } else { [one, other] }.map(|founder| founder.name.clone()));
            }
            let (first, second) = self.letters_of(k, letters.chars().count());
            Some([first, second].map(|letter| format!("{name}{letter}")))
        };
        let sulston = || is_cell(name).then(|| [SIDES[0].0, SIDES[0].1].map(|letter| format!("{name}{letter}")));
        match self.are_of_worm() {
            true => of_chart().or_else(own).or_else(sulston),
            false => own().or_else(of_chart).or_else(sulston),
        }
    }

    /// Generations of founders that the lineage lists below a cell; 0 for other cells than founders.
    pub(crate) fn listed_generations(&self, name: &str) -> u32 {
        let Some(k) = self.founders.iter().position(|founder| founder.name == name) else { return 0 };
        let below = self.founders.iter().filter(|founder| founder.mother == Some(k));
        below.map(|founder| 1 + self.listed_generations(&founder.name)).max().unwrap_or(0)
    }

    /// As [`founder`].
    pub fn founder<'a>(&'a self, name: &'a str) -> Option<&'a str> {
        let own = || self.place(name).map(|(k, _)| self.founders[k].name.as_str());
        if self.of_worm { founder(name).or_else(own) } else { own().or_else(|| founder(name)) }
    }

    /// As [`is_cell`].
    pub(crate) fn is_cell(&self, name: &str) -> bool {
        is_cell(name) || self.place(name).is_some()
    }

    /// Whether a cell of the lineage has this name.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.place(name).is_some() || self.are_of_worm() && is_cell(name)
    }

    /// The name of a cell of the lineage as the lineage writes it, or which names are allowed.
    pub(crate) fn known(&self, text: &str) -> Result<String, String> {
        let own = || self.understood("", text).filter(|name| self.has(name));
        own().ok_or_else(|| {
            let founders = || self.founders.iter().map(|founder| founder.name.as_str());
            let of = match self.founders.is_empty() {
                true => "Sulston's".to_owned(),
                false => format!("the lineage's: {}, or one of the cells below them", listed(founders(), ", ")),
            };
            format!("a name of {of}{}", did_you_mean(text, founders()))
        })
    }

    /// As [`understood`], of a cell of an embryo; the lineage's own names have one spelling. A name that the matching gives to the
    /// text comes first.
    pub fn understood(&self, embryo: &str, text: &str) -> Option<String> {
        let text = text.trim();
        let given = self.matching().and_then(|matching| matching.name_of(embryo, text));
        let of_worm = || by_side(text).filter(|_| self.are_of_worm()).map(str::to_owned);
        let own = || of_worm().or_else(|| self.place(text).map(|_| text.to_owned())).or_else(|| understood(text));
        given.map(str::to_owned).or_else(own)
    }

    /// Whether a column after the first, which may be called anything, has the name of a cell.
    pub(crate) fn any_on_top(&self, embryo: &str, header: &[String]) -> bool {
        header.iter().skip(1).any(|name| self.understood(embryo, split_unit(name).0).is_some())
    }

    /// Why another name is not used.
    pub fn unknown(&self) -> &'static str {
        match (self.matching(), self.are_of_worm()) {
            (Some(_), _) => "no name of the lineage's cells, and none was matched to it",
            (None, true) => {
                "no name of Sulston's; other names need the file of their lineage (--lineage), or to be matched (--names, --root)"
            }
            (None, false) => "no name of the lineage's cells; other names can be matched (--names, --root)",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mothers_and_sisters_agree_with_the_chart() {
        for (name, of, other, first) in [
            ("AB", "P0", "P1", true),
            ("P2", "P1", "EMS", false),
            ("E", "EMS", "MS", false),
            ("ABalpa", "ABalp", "ABalpp", true),
            ("Ca", "C", "Cp", true),
            ("MSpr", "MSp", "MSpl", false),
            ("ABplv", "ABpl", "ABpld", false),
        ] {
            assert_eq!(birth(name), Some((of, other.to_owned(), first)));
            assert!(is_cell(name));
        }
        assert_eq!(generation("ABala"), 4);
        assert_eq!(generation("P0"), 0);
    }

    #[test]
    fn blanks_points_and_capitals_are_understood() {
        for (text, name) in [
            ("AB al", "ABal"),
            ("AB.al", "ABal"),
            ("AB-al", "ABal"),
            ("AB_al", "ABal"),
            (" AB\u{a0}plpa ", "ABplpa"),
            ("A B.a.l", "ABal"),
            ("ABAL", "ABal"),
            ("AB PLP", "ABplp"),
            ("MSAP", "MSap"),
            ("E.a", "Ea"),
            ("EAL", "Eal"),
            ("CPA", "Cpa"),
            ("DA", "Da"),
            ("P 4", "P4"),
        ] {
            assert_eq!(understood(text).as_deref(), Some(name), "{text}");
        }
        for name in ["P0", "AB", "P1", "EMS", "MS", "E", "C", "D", "P4", "Z2", "Ea", "Cpa", "Da", "ABplv"] {
            assert_eq!(understood(name).as_deref(), Some(name));
        }
        for other in ["", ".", "DVA", "DD", "CAN", "ADAL", "ABALx", "AbAl", "abal", "EMSA", "P4A", "P5", "Nuc 1", "12"]
        {
            assert_eq!(understood(other), None, "{other}");
        }
        assert_eq!(understood(&format!("AB{}", " ".repeat(1_000_000))).as_deref(), Some("AB"));
    }

    #[test]
    fn other_words_are_not_names() {
        for name in ["", "AB ", "ABx", "abal", "Eaz", "P5", "P", "Nuc1", "ABé", "EMSa", "é"] {
            assert!(!is_cell(name), "{name}");
        }
        assert!(is_cell(&format!("AB{}", "a".repeat(62))) && !is_cell(&format!("AB{}", "a".repeat(1_000_000))));
    }
}
