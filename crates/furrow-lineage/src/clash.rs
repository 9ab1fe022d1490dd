//! Conflicts between founders' names and names from the naming rule.

/// The first conflict: founders (above, other) such that the name of `other` is the name of `above` followed by letters that the
/// naming rule gives to its descendants. If a founder `has_listed` daughters, their names come from the list instead of the rule.
/// `letters` are the letters of a founder's descendants, by generation from 1.
///
/// In sorted order, the names that begin with a given name follow it directly. A single pass keeps the prefixes of the current
/// name, each a prefix of the next, so that no more letters are read than the names have.
pub(super) fn first(
    names: &[&str],
    has_listed: &[bool],
    mut letters: impl FnMut(usize, usize) -> (char, char),
) -> Option<(usize, usize)> {
    let mut sorted: Vec<usize> = (0..names.len()).collect();
    sorted.sort_unstable_by_key(|&i| names[i]);
    let mut beginnings: Vec<usize> = Vec::new();
    for i in sorted {
        while beginnings.last().is_some_and(|&above| !names[i].starts_with(names[above])) {
            beginnings.pop();
        }
        for &above in &beginnings {
            let behind = &names[i][names[above].len()..];
            let generated = behind.chars().enumerate().all(|(k, c)| {
                let (a, p) = letters(above, k + 1);
                c == a || c == p
            });
            if generated {
                return Some((above, i));
            }
        }
        if !has_listed[i] {
            beginnings.push(i);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares all pairs, directly by the definition of a conflict.
    fn any_by_definition(names: &[&str], has_listed: &[bool]) -> bool {
        let below = |above: &str, name: &str| {
            name.len() > above.len() && name.starts_with(above) && name[above.len()..].chars().all(|c| "ap".contains(c))
        };
        (0..names.len()).any(|i| !has_listed[i] && names.iter().any(|name| below(names[i], name)))
    }

    #[test]
    fn clashes_agree_with_the_definition() {
        let words = ["A", "Aa", "Ab", "Aap", "Abp", "B", "Bx", "Bxa", "a", "ap", "é", "éa", "éb"];
        for chosen in 0..1_u32 << words.len() {
            let names: Vec<&str> = (0..words.len()).filter(|k| chosen >> k & 1 == 1).map(|k| words[k]).collect();
            for listed in [0_u32, 0b101, 0b11] {
                let has_listed: Vec<bool> = (0..names.len()).map(|k| listed >> k & 1 == 1).collect();
                let found = first(&names, &has_listed, |_, _| ('a', 'p'));
                assert_eq!(found.is_some(), any_by_definition(&names, &has_listed), "{names:?}");
                if let Some((above, other)) = found {
                    assert!(any_by_definition(&[names[above], names[other]], &[has_listed[above], true]));
                }
            }
        }
    }

    /// The work is linear in the length of the text, even if every name begins with every shorter one.
    #[test]
    fn the_work_is_bounded_by_the_text() {
        let nested: Vec<String> = (1..2000).map(|n| "bc".repeat(n)).collect();
        let wide: Vec<String> = (0..100_000).map(|n| format!("F{n}")).collect();
        for owned in [nested, wide] {
            let names: Vec<&str> = owned.iter().map(String::as_str).collect();
            let mut asked = 0;
            let found = first(&names, &vec![false; names.len()], |_, _| {
                asked += 1;
                ('a', 'p')
            });
            assert_eq!(found, None);
            let text: usize = names.iter().map(|name| name.len()).sum();
            assert!(asked <= text, "{asked} letters for {text} characters");
        }
    }
}
