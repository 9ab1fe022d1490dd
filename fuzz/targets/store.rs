//! The store: a file of slots that anything may have happened to.
//!
//! The first byte says what the rest is: a payload, the bytes of a whole file, or payloads that are put into slots with
//! checksums of their own, since no fuzzer guesses one.

use std::path::Path;

use furrow::batch::store::{PAYLOAD, upkeep};
use furrow::batch::{Key, Record, SolverVersion, Store};
use furrow::division::Division;

const SOLVER: SolverVersion = SolverVersion::new(7);

/// Whatever the file holds, it is opened, and what is read of it is what was written.
pub fn check(data: &[u8]) {
    let Some((&how, data)) = data.split_first() else { return };
    match how % 3 {
        0 => check_payload(data),
        1 => check_file(data, None),
        _ => {
            let payloads: Vec<[u8; PAYLOAD]> = data.chunks(PAYLOAD).map(padded).collect();
            let slots: Vec<u8> = payloads.iter().enumerate().flat_map(|(k, payload)| slot(k, payload)).collect();
            check_file(&slots, Some(&payloads));
        }
    }
}

/// What is read from a payload is written as that payload: nothing else stands for it. No number in it is out of bounds.
fn check_payload(data: &[u8]) {
    let payload = padded(data);
    let Some(division) = Division::decode(&payload) else { return };
    assert_eq!(division.encode(), payload);
    assert!(division.chi.is_none_or(|chi| (0.0..=1.0 + 1e-6).contains(&chi)), "{division:?}");
    assert!(division.t_end >= 0.0 && division.t_end.is_finite(), "{division:?}");
    if let Some([below, above]) = division.shares() {
        assert!((below + above - 1.0).abs() < 1e-9 && below > -1e-6 && above > -1e-6, "{division:?}");
    }
    let _ = division.mirrored().with_daughters_of(2.0).scaled(0.5);
}

/// The whole slots that can be read are read, the others counted; appending to it and mending it leave it whole.
fn check_file(bytes: &[u8], payloads: Option<&[[u8; PAYLOAD]]>) {
    let cache = tempfile::tempdir().expect("a folder");
    let folder = cache.path().join(Division::FOLDER);
    std::fs::create_dir_all(&folder).expect("a folder");
    std::fs::write(folder.join(format!("{:016x}.v1.log", SOLVER.number())), bytes).expect("a file");
    let store = open(cache.path());
    if let Some(payloads) = payloads {
        let whole = payloads.iter().filter(|payload| Division::decode(payload).is_some()).count();
        assert_eq!((store.len(), store.damaged()), (whole, payloads.len() - whole));
    }
    let before = store.len();
    let key = Key::from_bytes([0xee; 32]);
    if store.get(&key).is_none() {
        store.commit(&key, &std::sync::Arc::new(division()));
        assert_eq!(store.committed(), 1);
    }
    assert!(open(cache.path()).get(&key).is_some());
    upkeep::repair::<Division>(cache.path(), SOLVER).expect("it is mended");
    let report = upkeep::verify::<Division>(cache.path(), SOLVER).expect("it is read");
    assert_eq!(report.corrupt, 0);
    assert!(report.entries >= before.max(1));
}

fn open(cache: &Path) -> Store<Division> {
    Store::open(cache, SOLVER).expect("a store is opened whatever its file holds")
}

fn padded(data: &[u8]) -> [u8; PAYLOAD] {
    let mut payload = [0; PAYLOAD];
    payload.iter_mut().zip(data).for_each(|(place, byte)| *place = *byte);
    payload
}

/// A slot as the store writes it: magic, key, payload, half of the hash of all that.
fn slot(number: usize, payload: &[u8; PAYLOAD]) -> Vec<u8> {
    let mut slot = b"furrow\x00\x01".to_vec();
    let mut key = [0; 32];
    key[..8].copy_from_slice(&(number as u64).to_le_bytes());
    slot.extend(key);
    slot.extend(payload);
    let hash = blake3::hash(&slot);
    slot.extend(&hash.as_bytes()[..16]);
    slot
}

fn division() -> Division {
    let payload = padded(&[0]);
    Division::decode(&payload).expect("an empty record of a symmetric division")
}
