//! One stored record: a slot of fixed size that says what it is and proves that it is whole.
//!
//! ```text
//! 0      8    40       240       256
//! magic  key  payload  checksum
//! ```
//! The checksum is the first half of the blake3 hash of all that stands before it.

use crate::batch::{key::Key, task::Record};

/// Size of a slot in bytes. A power of two that divides the page size: a slot never straddles two pages.
pub const SLOT: usize = 256;

/// Bytes of a slot that the record itself has.
pub const PAYLOAD: usize = CHECKSUM - CONTENT;

/// The slot's layout is part of the file's name; a new layout takes a new number and leaves old files alone.
pub const LAYOUT: u32 = 1;

const MAGIC: [u8; 8] = *b"furrow\x00\x01";
const VOID: [u8; 8] = *b"furrow\x00\x00";
const KEY: usize = 8;
const CONTENT: usize = 40;
const CHECKSUM: usize = 240;

/// Writes a record into a slot.
pub fn encode<R: Record>(key: &Key, record: &R) -> [u8; SLOT] {
    let mut slot = [0; SLOT];
    slot[..KEY].copy_from_slice(&MAGIC);
    slot[KEY..CONTENT].copy_from_slice(key.as_bytes());
    slot[CONTENT..CHECKSUM].copy_from_slice(&record.encode());
    sealed(slot)
}

/// What takes the place of a damaged record once it has been given up.
pub fn void() -> [u8; SLOT] {
    let mut slot = [0; SLOT];
    slot[..KEY].copy_from_slice(&VOID);
    sealed(slot)
}

/// What a slot turned out to hold.
#[derive(Clone, Debug, PartialEq)]
pub enum Content<R> {
    /// A whole record.
    Record(Key, R),
    /// Nothing, on purpose.
    Void,
    /// Anything else.
    Damaged,
}

/// Reads a slot.
pub fn read<R: Record>(slot: &[u8; SLOT]) -> Content<R> {
    if slot[..KEY] == VOID && *slot == void() {
        return Content::Void;
    }
    decode(slot).map_or(Content::Damaged, |(key, record)| Content::Record(key, record))
}

/// Reads a record; `None` if it is not a whole and unharmed one.
fn decode<R: Record>(slot: &[u8; SLOT]) -> Option<(Key, R)> {
    if slot[CHECKSUM..] != checksum(slot) || slot[..KEY] != MAGIC {
        return None;
    }
    let mut key = [0; CONTENT - KEY];
    key.copy_from_slice(&slot[KEY..CONTENT]);
    let mut payload = [0; PAYLOAD];
    payload.copy_from_slice(&slot[CONTENT..CHECKSUM]);
    Some((Key::from_bytes(key), R::decode(&payload)?))
}

fn sealed(mut slot: [u8; SLOT]) -> [u8; SLOT] {
    let checksum = checksum(&slot);
    slot[CHECKSUM..].copy_from_slice(&checksum);
    slot
}

fn checksum(slot: &[u8; SLOT]) -> [u8; SLOT - CHECKSUM] {
    let mut half = [0; SLOT - CHECKSUM];
    half.copy_from_slice(&blake3::hash(&slot[..CHECKSUM]).as_bytes()[..SLOT - CHECKSUM]);
    half
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::stick::{Broken, Stick};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_record_comes_back_and_no_flipped_bit_passes(
            key in any::<[u8; 32]>(),
            length in 1.0..4.0_f64,
            flip in 0..SLOT * 8,
        ) {
            let record = Stick::new(length).break_in_two();
            let mut slot = encode(&Key::from_bytes(key), &record);
            prop_assert_eq!(read(&slot), Content::Record(Key::from_bytes(key), record));
            slot[flip / 8] ^= 1 << (flip % 8);
            prop_assert_eq!(read::<Broken>(&slot), Content::Damaged);
        }
    }

    #[test]
    fn empty_slots_are_no_records() {
        assert_eq!(read::<Broken>(&[0; SLOT]), Content::Damaged);
        assert_eq!(read::<Broken>(&[0xff; SLOT]), Content::Damaged);
        assert_eq!(read::<Broken>(&void()), Content::Void);
        for bit in 0..8 * SLOT {
            let mut slot = void();
            slot[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(read::<Broken>(&slot), Content::Damaged);
        }
    }

    #[test]
    fn a_whole_slot_whose_payload_means_nothing_is_damaged() {
        let mut slot = encode(&Key::from_bytes([7; 32]), &Stick::new(2.0).break_in_two());
        slot[CONTENT] = 0xff;
        assert_eq!(read::<Broken>(&sealed(slot)), Content::Damaged);
    }
}
