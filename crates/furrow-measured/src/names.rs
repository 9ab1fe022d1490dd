//! Sulston's names: a cell is named after its mother and the side on which it is born, except for the founders.
//!
//! # References
//! Sulston, Schierenberg, White & Thomson, *Dev. Biol.* 100, 64 (1983).

/// Founders: mother, the daughter named first (the anterior one; of EMS and P4 as in Sulston's chart), the other daughter.
const NAMED: [(&str, &str, &str); 6] = [
    ("P0", "AB", "P1"),
    ("P1", "EMS", "P2"),
    ("EMS", "MS", "E"),
    ("P2", "C", "P3"),
    ("P3", "D", "P4"),
    ("P4", "Z3", "Z2"),
];

/// Founders whose descendants are named by letters.
const STEMS: [&str; 5] = ["AB", "MS", "E", "C", "D"];

/// Letters of two sisters: anterior and posterior, left and right, dorsal and ventral.
const SIDES: [(char, char); 3] = [('a', 'p'), ('l', 'r'), ('d', 'v')];

/// Longest name, in bytes: no known lineage has half as many rounds.
const LONGEST: usize = 64;

/// The other letter of a pair of sides, and whether `letter` is the one that is named first.
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
pub fn is_cell(name: &str) -> bool {
    name == "P0" || mother(name).is_some()
}

/// Generations from P0 to a cell.
pub fn generation(name: &str) -> u32 {
    std::iter::successors(mother(name), |name| mother(name)).count() as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mothers_and_sisters_are_those_of_the_chart() {
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
    fn other_words_are_not_names() {
        for name in ["", "AB ", "ABx", "abal", "Eaz", "P5", "P", "Nuc1", "ABé", "EMSa", "é"] {
            assert!(!is_cell(name), "{name}");
        }
        assert!(is_cell(&format!("AB{}", "a".repeat(62))) && !is_cell(&format!("AB{}", "a".repeat(1_000_000))));
    }
}
