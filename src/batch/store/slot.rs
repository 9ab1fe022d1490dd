//! One stored division: a slot of fixed size that says what it is and proves that it is whole.
//!
//! ```text
//! 0      8    40       41     48                  132    240       256
//! magic  key  outcome  flags  8 reals, 5 counts   0…     checksum
//! ```
//! Numbers are little-endian, reals by their bits, so that what is read is bit for bit what was solved. The checksum is
//! the first half of the blake3 hash of all that stands before it.

use crate::{
    batch::key::Key,
    division::{Division, Outcome},
};

/// Size of a slot in bytes. A power of two that divides the page size: a slot never straddles two pages.
pub const SLOT: usize = 256;

/// The slot's layout is part of the file's name; a new layout takes a new number and leaves old files alone.
pub const LAYOUT: u32 = 1;

const MAGIC: [u8; 8] = *b"furrow\x00\x01";
const VOID: [u8; 8] = *b"furrow\x00\x00";
const KEY: usize = 8;
const OUTCOME: usize = 40;
const FLAGS: usize = 41;
const NUMBERS: usize = 48;
const CHECKSUM: usize = 240;

/// Writes a division into a slot.
pub fn encode(key: &Key, division: &Division) -> [u8; SLOT] {
    // Taken apart without `..`: a new field does not compile until it has its place.
    let Division {
        outcome,
        chi,
        chi_signed,
        u_furrow,
        t_end,
        daughters,
        growth_rate,
        volume_drift,
        steps,
        rejected,
        newton_iterations,
        factorisations,
        remeshings,
    } = division;
    let mut slot = [0; SLOT];
    slot[..KEY].copy_from_slice(&MAGIC);
    slot[KEY..OUTCOME].copy_from_slice(key.as_bytes());
    slot[OUTCOME] = match outcome {
        Outcome::Symmetric => 0,
        Outcome::Asymmetric => 1,
        Outcome::Failed => 2,
    };
    let present = [chi.is_some(), chi_signed.is_some(), u_furrow.is_some(), daughters.is_some(), growth_rate.is_some()];
    slot[FLAGS] = present.iter().enumerate().map(|(bit, &some)| u8::from(some) << bit).sum();
    let [anterior, posterior] = daughters.unwrap_or_default();
    let reals = [
        chi.unwrap_or_default(),
        chi_signed.unwrap_or_default(),
        u_furrow.unwrap_or_default(),
        anterior,
        posterior,
        growth_rate.unwrap_or_default(),
        *t_end,
        *volume_drift,
    ];
    let counts = [*steps, *rejected, *newton_iterations, *factorisations, *remeshings];
    let bytes =
        reals.iter().flat_map(|x| x.to_bits().to_le_bytes()).chain(counts.iter().flat_map(|count| count.to_le_bytes()));
    for (place, byte) in slot[NUMBERS..CHECKSUM].iter_mut().zip(bytes) {
        *place = byte;
    }
    let checksum = checksum(&slot);
    slot[CHECKSUM..].copy_from_slice(&checksum);
    slot
}

/// What takes the place of a damaged record once it has been given up.
pub fn void() -> [u8; SLOT] {
    let mut slot = [0; SLOT];
    slot[..KEY].copy_from_slice(&VOID);
    let checksum = checksum(&slot);
    slot[CHECKSUM..].copy_from_slice(&checksum);
    slot
}

/// What a slot turned out to hold.
#[derive(Clone, Debug, PartialEq)]
pub enum Content {
    /// A whole record.
    Record(Key, Division),
    /// Nothing, on purpose.
    Void,
    /// Anything else.
    Damaged,
}

/// Reads a slot.
pub fn read(slot: &[u8; SLOT]) -> Content {
    if slot[..KEY] == VOID && *slot == void() {
        return Content::Void;
    }
    decode(slot).map_or(Content::Damaged, |(key, division)| Content::Record(key, division))
}

/// Reads a record; `None` if it is not a whole and unharmed one.
fn decode(slot: &[u8; SLOT]) -> Option<(Key, Division)> {
    if slot[CHECKSUM..] != checksum(slot) || slot[..KEY] != MAGIC {
        return None;
    }
    let mut key = [0; 32];
    key.copy_from_slice(&slot[KEY..OUTCOME]);
    let outcome = match slot[OUTCOME] {
        0 => Outcome::Symmetric,
        1 => Outcome::Asymmetric,
        2 => Outcome::Failed,
        _ => return None,
    };
    let flags = slot[FLAGS];
    let mut numbers = Numbers(&slot[NUMBERS..CHECKSUM]);
    let [chi, chi_signed, u_furrow, anterior, posterior, growth_rate, t_end, volume_drift] =
        std::array::from_fn(|_| f64::from_bits(u64::from_le_bytes(numbers.next())));
    let [steps, rejected, newton_iterations, factorisations, remeshings] =
        std::array::from_fn(|_| u32::from_le_bytes(numbers.next()));
    let division = Division {
        outcome,
        chi: (flags & 1 != 0).then_some(chi),
        chi_signed: (flags & 2 != 0).then_some(chi_signed),
        u_furrow: (flags & 4 != 0).then_some(u_furrow),
        t_end,
        daughters: (flags & 8 != 0).then_some([anterior, posterior]),
        growth_rate: (flags & 16 != 0).then_some(growth_rate),
        volume_drift,
        steps,
        rejected,
        newton_iterations,
        factorisations,
        remeshings,
    };
    Some((Key::from_bytes(key), division))
}

fn checksum(slot: &[u8; SLOT]) -> [u8; SLOT - CHECKSUM] {
    let mut half = [0; SLOT - CHECKSUM];
    half.copy_from_slice(&blake3::hash(&slot[..CHECKSUM]).as_bytes()[..SLOT - CHECKSUM]);
    half
}

/// Reads numbers off the front of a slice that holds enough of them.
struct Numbers<'s>(&'s [u8]);

impl Numbers<'_> {
    fn next<const N: usize>(&mut self) -> [u8; N] {
        let mut bytes = [0; N];
        if let Some((head, rest)) = self.0.split_first_chunk() {
            bytes = *head;
            self.0 = rest;
        }
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::{collection::vec, option, prelude::*};

    fn bits(division: &Division) -> Vec<Option<u64>> {
        let d = division;
        let mut reals = vec![d.chi, d.chi_signed, d.u_furrow, d.growth_rate, Some(d.t_end), Some(d.volume_drift)];
        reals.extend([d.daughters.map(|[a, _]| a), d.daughters.map(|[_, p]| p)]);
        reals.into_iter().map(|real| real.map(f64::to_bits)).collect()
    }

    proptest! {
        #[test]
        fn a_division_comes_back_bit_for_bit_and_no_flipped_bit_passes(
            key in any::<[u8; 32]>(),
            outcome in 0..3_usize,
            reals in vec(any::<u64>().prop_map(f64::from_bits), 4),
            maybe in vec(option::of(any::<u64>().prop_map(f64::from_bits)), 5),
            counts in any::<[u32; 5]>(),
            flip in 0..SLOT * 8,
        ) {
            let division = Division {
                outcome: [Outcome::Symmetric, Outcome::Asymmetric, Outcome::Failed][outcome],
                chi: maybe[0],
                chi_signed: maybe[1],
                u_furrow: maybe[2],
                t_end: reals[0],
                daughters: maybe[3].map(|_| [reals[1], reals[2]]),
                growth_rate: maybe[4],
                volume_drift: reals[3],
                steps: counts[0],
                rejected: counts[1],
                newton_iterations: counts[2],
                factorisations: counts[3],
                remeshings: counts[4],
            };
            let mut slot = encode(&Key::from_bytes(key), &division);
            let (read_key, read) = decode(&slot).unwrap();
            prop_assert_eq!(read_key.as_bytes(), &key);
            prop_assert_eq!(bits(&read), bits(&division));
            prop_assert_eq!(read.outcome, division.outcome);
            prop_assert_eq!(
                [read.steps, read.rejected, read.newton_iterations, read.factorisations, read.remeshings],
                counts
            );
            slot[flip / 8] ^= 1 << (flip % 8);
            prop_assert!(decode(&slot).is_none());
        }
    }

    #[test]
    fn empty_slots_are_no_records() {
        assert!(decode(&[0; SLOT]).is_none());
        assert!(decode(&[0xff; SLOT]).is_none());
        assert_eq!(read(&void()), Content::Void);
        for bit in 0..8 * SLOT {
            let mut slot = void();
            slot[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(read(&slot), Content::Damaged);
        }
    }
}
