//! Rows that are given twice, and links past spots that cannot be used.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};

/// The first rows of things, to tell a repeat from a contradiction.
pub(super) struct FirstRows<K>(HashMap<K, (u64, u64)>);

impl<K: Eq + Hash> FirstRows<K> {
    /// No rows yet.
    pub fn new() -> FirstRows<K> {
        FirstRows(HashMap::new())
    }

    /// The line of an earlier row of the same thing with the same contents.
    pub fn repeated(&mut self, of: K, line: u64, contents: u64) -> Option<u64> {
        let (first, known) = *self.0.entry(of).or_insert((line, contents));
        (first != line && known == contents).then_some(first)
    }
}

/// A hash of a row's fields in the columns with a name: others may count rows.
pub(super) fn contents<'r>(names: &[String], text: impl Fn(usize) -> &'r [u8]) -> u64 {
    let is_named = |name: &String| !name.is_empty() && !name.starts_with("Unnamed: ");
    let texts = names.iter().enumerate().filter(|(_, name)| is_named(name)).map(|(column, _)| text(column));
    contents_of(texts.collect::<Vec<_>>())
}

/// As [`contents`], of values.
pub(super) fn contents_of(values: impl Hash) -> u64 {
    let mut hasher = DefaultHasher::new();
    values.hash(&mut hasher);
    hasher.finish()
}

/// Why a repeated row is not used.
pub(super) fn repeat(first: u64) -> String {
    format!("the row of line {first} a second time")
}

/// The line and the ends of a link.
pub(super) type Link<K> = (u64, [K; 2]);

/// The links between spots that can be used. Where a spot cannot be used, the one before it is linked with those after it, so that its
/// cell goes on. `time` gives the time of a usable spot.
pub(super) fn links_past<K: Copy + Eq + Hash>(links: Vec<Link<K>>, time: impl Fn(K) -> Option<f64>) -> Vec<Link<K>> {
    let mut all: Vec<Option<Link<K>>> = Vec::with_capacity(links.len());
    let (mut links_of, mut lost): (HashMap<K, Vec<usize>>, Vec<K>) = Default::default();
    for link in links {
        for end in link.1.into_iter().filter(|end| time(*end).is_none()) {
            let known = links_of.entry(end).or_default();
            if known.is_empty() {
                lost.push(end);
            }
            known.push(all.len());
        }
        all.push(Some(link));
    }
    for spot in lost {
        let taken: Vec<Link<K>> =
            links_of.remove(&spot).unwrap_or_default().into_iter().filter_map(|at| all[at].take()).collect();
        for link in past(&taken, spot, &time) {
            for end in link.1 {
                links_of.entry(end).and_modify(|known| known.push(all.len()));
            }
            all.push(Some(link));
        }
    }
    all.into_iter().flatten().collect()
}

/// The links of the spots before a spot with those after it, unless there are several of both, or some links lead back in time.
fn past<K: Copy + Eq>(taken: &[Link<K>], spot: K, time: impl Fn(K) -> Option<f64>) -> Vec<Link<K>> {
    let ends = |side: usize| -> Vec<Link<K>> {
        taken.iter().filter(|(_, ends)| ends[1 - side] == spot && ends[side] != spot).copied().collect()
    };
    let [before, after] = [ends(0), ends(1)];
    let times =
        |links: &[Link<K>], side: usize| links.iter().filter_map(|(_, ends)| time(ends[side])).collect::<Vec<_>>();
    let [earlier, later] = [times(&before, 0), times(&after, 1)];
    let all = |is_so: fn(&f64, &f64) -> bool| earlier.iter().all(|one| later.iter().all(|other| is_so(one, other)));
    let is_clear = all(|one, other| one < other) || all(|one, other| one > other);
    if before.len() > 1 && after.len() > 1 || !is_clear {
        return Vec::new();
    }
    let joined = |(_, first): &Link<K>| {
        let first = first[0];
        after.iter().filter(move |(_, last)| last[1] != first).map(move |(line, last)| (*line, [first, last[1]]))
    };
    before.iter().flat_map(joined).collect()
}

#[cfg(test)]
mod tests {
    use super::links_past;

    #[test]
    fn links_lead_past_spots_that_cannot_be_used() {
        for (links, lost, right) in [
            (&[[1, 2], [2, 3]][..], &[2][..], &[[1, 3]][..]),
            (&[[1, 2], [2, 3], [2, 4]], &[2], &[[1, 3], [1, 4]]),
            (&[[1, 2], [2, 3], [3, 4]], &[2, 3], &[[1, 4]]),
            (&[[1, 2], [5, 2], [2, 3], [2, 4]], &[2], &[]),
            (&[[1, 2], [2, 2], [2, 1]], &[2], &[]),
            // Backwards: all links, or one of them.
            (&[[4, 2], [3, 2], [2, 1]], &[2], &[[4, 1], [3, 1]]),
            (&[[1, 2], [4, 2], [2, 3]], &[2], &[]),
            (&[[1, 2]], &[2], &[]),
        ] {
            let numbered = links.iter().enumerate().map(|(line, ends)| (line as u64, *ends)).collect();
            let found: Vec<[i32; 2]> = links_past(numbered, |spot| (!lost.contains(&spot)).then_some(spot.into()))
                .into_iter()
                .map(|(_, ends)| ends)
                .collect();
            assert_eq!(found, right, "{links:?} {lost:?}");
        }
    }
}
