//! What makes two tasks the same: canonical bytes, hashed.

use std::{
    collections::HashMap,
    hash::{BuildHasherDefault, Hasher},
};

use super::task::Task;

/// Raised by hand when results change for a reason outside the solver's sources (a dependency, say).
const SOLVER_REVISION: u32 = 1;

/// Version of how [`CanonicalBytes`] writes.
const KEY_LAYOUT: u32 = 1;

/// Identifies the code that solves. Records of different solvers are never mixed.
///
/// It is derived at build time from the sources listed in the build script, so that editing the solver cannot leave a
/// stale record in a store.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SolverVersion(u64);

impl SolverVersion {
    /// The solver of this build.
    pub fn current() -> Self {
        // The build script prints decimal digits; were they anything else, zero is still one definite version.
        let fingerprint: u64 = env!("FURROW_SOLVER_FINGERPRINT").parse().unwrap_or(0);
        let mut hasher = blake3::Hasher::new();
        hasher.update(&KEY_LAYOUT.to_le_bytes());
        hasher.update(&SOLVER_REVISION.to_le_bytes());
        hasher.update(&fingerprint.to_le_bytes());
        let mut bytes = [0; 8];
        bytes.copy_from_slice(&hasher.finalize().as_bytes()[..8]);
        SolverVersion(u64::from_le_bytes(bytes))
    }

    /// A version with a given number, for stores of other solvers and tests.
    pub const fn new(number: u64) -> Self {
        SolverVersion(number)
    }

    /// The version as a number.
    pub const fn number(self) -> u64 {
        self.0
    }
}

/// Hash of everything the record of a task depends on.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Key([u8; 32]);

impl Key {
    /// The key of `task` as it stands (round its size first) for `solver`.
    pub fn new(task: &impl Task, solver: SolverVersion) -> Key {
        let mut bytes = CanonicalBytes(Vec::with_capacity(256));
        bytes.0.extend_from_slice(&KEY_LAYOUT.to_le_bytes());
        bytes.count(solver.number());
        task.write_canonical(&mut bytes);
        Key(*blake3::hash(&bytes.0).as_bytes())
    }

    /// The key with the given bytes.
    pub const fn from_bytes(bytes: [u8; 32]) -> Key {
        Key(bytes)
    }

    /// The key's bytes.
    pub const fn as_bytes(&self) -> &[u8; 32] {
        &self.0
    }

    /// The key's leading eight bytes as a number, evenly spread.
    pub fn prefix(&self) -> u64 {
        let mut bytes = [0; 8];
        bytes.copy_from_slice(&self.0[..8]);
        u64::from_le_bytes(bytes)
    }
}

impl std::fmt::Display for Key {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl std::fmt::Debug for Key {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Key({self})")
    }
}

/// The bytes a key is the hash of: little-endian, with one form for each value.
#[derive(Debug)]
pub struct CanonicalBytes(Vec<u8>);

impl CanonicalBytes {
    /// Adds a name.
    pub fn name(&mut self, name: &str) {
        self.0.extend_from_slice(name.as_bytes());
        // Never part of a text, so that no two sequences of values run into the same bytes.
        self.0.push(0xff);
    }

    /// Adds which of several alternatives is chosen.
    pub fn choice(&mut self, number: u8) {
        self.0.push(number);
    }

    /// Adds a number of things.
    pub fn count(&mut self, number: u64) {
        self.0.extend_from_slice(&number.to_le_bytes());
    }

    /// Adds a real number; −0 is written as 0 and every NaN as the same one.
    pub fn real(&mut self, value: f64) {
        let canonical = if value.is_nan() {
            f64::NAN
        } else {
            value + 0.0 // −0 + 0 = 0
        };
        self.0.extend_from_slice(&canonical.to_bits().to_le_bytes());
    }
}

/// A table by key.
pub(super) type KeyMap<V> = HashMap<Key, V, PrefixState>;

/// Builds the hasher of tables by key.
pub(super) type PrefixState = BuildHasherDefault<PrefixHasher>;

/// Takes the hash from the key, which is one already.
#[derive(Debug, Default)]
pub(super) struct PrefixHasher(u64);

impl Hasher for PrefixHasher {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        // `[u8; 32]` writes its length first, then its bytes.
        for chunk in bytes.chunks_exact(8).take(1) {
            self.0 = chunk.iter().rev().fold(0, |word, &byte| (word << 8) | u64::from(byte));
        }
    }

    fn write_usize(&mut self, _length: usize) {}
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::stick::Stick;

    #[test]
    fn zeros_of_either_sign_and_all_nans_are_the_same() {
        let key = |length| Key::new(&Stick::new(length), SolverVersion::new(7));
        assert_eq!(key(0.0), key(-0.0));
        assert_eq!(key(f64::NAN), key(-f64::NAN));
        assert_ne!(key(0.0), key(f64::MIN_POSITIVE));
    }

    #[test]
    fn the_solver_is_in_the_key() {
        let stick = Stick::new(2.0);
        assert_ne!(Key::new(&stick, SolverVersion::new(7)), Key::new(&stick, SolverVersion::new(8)));
    }

    #[test]
    fn names_do_not_run_into_each_other() {
        let bytes = |names: [&str; 2]| {
            let mut bytes = CanonicalBytes(Vec::new());
            names.iter().for_each(|name| bytes.name(name));
            bytes.0
        };
        assert_ne!(bytes(["ab", "c"]), bytes(["a", "bc"]));
    }
}
