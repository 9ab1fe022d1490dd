//! The part of the points that one machine solves.

use std::str::FromStr;

use super::points::Point;
use super::sample::seed_of;
use furrow_lineage::batch::{Key, Quantisation};
use serde::{Deserialize, Serialize};

/// Most parts of a sweep.
const MOST: u64 = 1_000_000;

/// One of several parts of a sweep, which are solved independently.
///
/// A point belongs to the part that the hash of its input gives. So equal inputs are in one part and solved once, every part
/// has cheap and dear points alike, and a point stays where it is when others are added.
///
/// ```
/// use furrow_analysis::Shard;
///
/// assert_eq!("2/4".parse(), Ok(Shard { number: 2, of: 4 }));
/// assert!("5/4".parse::<Shard>().is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Shard {
    /// Which part, from 1.
    pub number: u64,
    /// How many parts there are.
    pub of: u64,
}

impl Shard {
    /// Part `number` of `of`.
    ///
    /// # Errors
    /// The allowed values.
    pub fn new(number: u64, of: u64) -> Result<Shard, String> {
        match (1..=of).contains(&number) && of <= MOST {
            true => Ok(Shard { number, of }),
            false => Err(allowed()),
        }
    }

    /// The seed of this part of a sample; part 1 has the sample's own.
    pub fn seed(self, seed: u64) -> u64 {
        if self.number == 1 { seed } else { seed_of(b"part", seed, self.number) }
    }

    /// Whether a point belongs to this part.
    pub fn has(self, point: &Point, quantisation: Quantisation) -> bool {
        let mut canonical = point.input.clone();
        canonical.cell.r0 = quantisation.apply(canonical.cell.r0);
        Key::new(&canonical).prefix() % self.of == self.number - 1
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Shard, String> {
        let numbers = || {
            let (number, of) = text.split_once('/')?;
            Some((number.trim().parse().ok()?, of.trim().parse().ok()?))
        };
        let (number, of) = numbers().ok_or_else(allowed)?;
        Shard::new(number, of)
    }
}

/// The error for an invalid part.
fn allowed() -> String {
    format!("must be K/N with 1 ≤ K ≤ N ≤ {MOST}, as 2/4")
}

impl std::fmt::Display for Shard {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}
