//! Sulston's names: every cell is called after its mother and the side on which it is born, except for the founders.
//!
//! # References
//! Sulston, Schierenberg, White & Thomson, *Dev. Biol.* 100, 64 (1983).

/// Cells with names of their own: mother, daughter that is named first (the anterior one; of EMS and P4 as in Sulston's chart),
/// the other.
const NAMED: [(&str, &str, &str); 6] = [
    ("P0", "AB", "P1"),
    ("P1", "EMS", "P2"),
    ("EMS", "MS", "E"),
    ("P2", "C", "P3"),
    ("P3", "D", "P4"),
    ("P4", "Z3", "Z2"),
];

/// Founders whose descendants are called by letters.
const STEMS: [&str; 5] = ["AB", "MS", "E", "C", "D"];

/// Letters of two sisters: anterior and posterior, left and right, dorsal and ventral.
const SIDES: [(char, char); 3] = [('a', 'p'), ('l', 'r'), ('d', 'v')];

/// Letters of the longest name that is taken for one: no lineage is known to have half as many rounds.
const LONGEST: usize = 64;

/// The mother of a cell by its name; none for P0 and for what is no name of a cell.
///
/// # Examples
/// ```
/// use furrow_measured::names::mother;
/// assert_eq!(mother("ABal"), Some("ABa"));
/// assert_eq!(mother("P4"), Some("P3"));
/// assert_eq!(mother("Nuc12"), None);
/// ```
pub fn mother(name: &str) -> Option<&str> {
    if let Some((mother, ..)) = NAMED.iter().find(|(_, first, second)| [*first, *second].contains(&name)) {
        return Some(mother);
    }
    let (before, last) = name.char_indices().next_back().map(|(at, last)| (&name[..at], last))?;
    if name.len() > LONGEST {
        return None;
    }
    let is_side = |letter: char| SIDES.iter().any(|(first, second)| [*first, *second].contains(&letter));
    let letters = STEMS.iter().find_map(|stem| before.strip_prefix(stem))?;
    (is_side(last) && letters.chars().all(is_side)).then_some(before)
}

/// Whether a name is one of a cell.
pub fn is_cell(name: &str) -> bool {
    name == "P0" || mother(name).is_some()
}

/// The other daughter of a cell's mother, and whether the cell itself is the one that is named first.
pub fn sister(name: &str) -> Option<(String, bool)> {
    if let Some((_, first, second)) = NAMED.iter().find(|(_, first, second)| [*first, *second].contains(&name)) {
        let is_first = *first == name;
        return Some((if is_first { *second } else { *first }.to_owned(), is_first));
    }
    let before = mother(name)?;
    let last = name.chars().next_back()?;
    let (first, second) = SIDES.iter().find(|(first, second)| [*first, *second].contains(&last))?;
    let other = if last == *first { second } else { first };
    Some((format!("{before}{other}"), last == *first))
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
            assert_eq!(mother(name), Some(of));
            assert_eq!(sister(name), Some((other.to_owned(), first)));
            assert!(is_cell(name));
        }
        assert_eq!(generation("ABala"), 4);
        assert_eq!(generation("P0"), 0);
    }

    #[test]
    fn what_is_no_name_is_told() {
        for name in ["", "AB ", "ABx", "abal", "Eaz", "P5", "P", "Nuc1", "ABé", "EMSa", "é"] {
            assert!(!is_cell(name), "{name}");
        }
        assert!(is_cell(&format!("AB{}", "a".repeat(62))) && !is_cell(&format!("AB{}", "a".repeat(1_000_000))));
    }
}
