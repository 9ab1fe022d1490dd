//! Links the spots of cells, where the file lists the spots of a cell together.

use furrow_input::InputError;
use furrow_input::table::malformed;
use ordered_float::OrderedFloat;

use super::spots::Spots;

/// A cell, or a part of one, with all its spots.
#[derive(Debug, Default)]
pub(super) struct Chain {
    /// What messages call it.
    pub name: String,
    /// Its spots in any order; at least one.
    pub spots: Vec<usize>,
    /// The place of the chain that it comes from.
    pub mother: Option<usize>,
}

/// The meaning of a chain without a sister.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Only {
    /// The only daughter that was followed.
    Daughter,
    /// The same cell as its mother.
    SameCell,
    /// The same cell as its mother after a gap of a frame or more, else the only daughter.
    SameCellAfterGap,
}

/// Links the spots of each chain, and its first one to the last of its mother. `time` is the name of the column of times, `only` is
/// the meaning of a chain without a sister. If the sister is left out, it is a daughter.
///
/// # Errors
/// Two spots of a chain at one time.
pub(super) fn link(
    spots: &mut Spots,
    chains: &mut [Chain],
    (file, time): (&str, &str),
    only: Only,
) -> Result<(), InputError> {
    for Chain { name, spots: of, .. } in chains.iter_mut() {
        of.sort_by_cached_key(|k| OrderedFloat(spots.get(*k).time));
        for pair in of.windows(2) {
            let [first, second] = [spots.get(pair[0]), spots.get(pair[1])];
            if first.time == second.time {
                let (time, [first, second]) = (first.time, [first.line, second.line]);
                let why =
                    format!("cell {name} a second time at time {time}; the first is on line {}", first.min(second));
                return Err(malformed(file, first.max(second) as usize, why));
            }
            spots.link(pair[0], pair[1], file, second.line)?;
        }
    }
    for Chain { spots: of, mother, .. } in chains.iter() {
        let Some(mother) = mother.and_then(|mother| chains.get(mother)) else { continue };
        let (Some(first), Some(last)) = (of.first(), mother.spots.last()) else { continue };
        let (line, born, until) = (spots.get(*first).line, spots.get(*first).time, spots.get(*last).time);
        if until < born {
            spots.link(*last, *first, file, line)?;
        } else {
            spots.part(*last);
            let why = format!("it is born while its mother {} is still there, until time {until}", mother.name);
            spots.skip(file, line, time, &born.to_string(), why);
        }
        if only == Only::Daughter || only == Only::SameCellAfterGap && born <= until + 1.0 {
            spots.part(*last);
        }
    }
    Ok(())
}
