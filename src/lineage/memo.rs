//! The memo: no division is solved twice.
//!
//! Every division is looked up by its [`Key`]. The first to ask for an unknown key gets a [`Ticket`], the duty to solve
//! it; whoever asks before it is solved leaves the sending end of a channel and goes on with other work. Nobody ever
//! blocks on a key, and no guard of the table is held while solving, sending or waiting.

use std::{
    hash::{BuildHasherDefault, Hasher},
    sync::{Arc, mpsc::Sender},
};

use dashmap::{DashMap, Entry};

use super::key::{Key, Quantisation, SolverVersion};
use crate::division::{Division, DivisionError, DivisionInput};

/// Divisions solved so far or being solved, shared by any number of trees and threads.
#[derive(Debug)]
pub struct Memo {
    quantisation: Quantisation,
    solver: SolverVersion,
    table: DashMap<Key, Slot, BuildHasherDefault<PrefixHasher>>,
}

#[derive(Debug)]
enum Slot {
    Solved(Arc<Division>),
    /// Being solved; these are told when it is.
    InFlight(Vec<Sender<Notice>>),
}

/// Word to a waiter about a key.
#[derive(Clone, Debug)]
pub struct Notice {
    /// The key waited for.
    pub key: Key,
    /// What became of it.
    pub news: News,
}

/// What became of a key that was in flight.
#[derive(Clone, Debug)]
pub enum News {
    /// Solved, just now.
    Solved(Arc<Division>),
    /// Could not be solved.
    Failed(Failure),
    /// Whoever was to solve it gave up; ask again.
    Abandoned,
}

/// Why a division has no result.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Failure {
    /// The solver says why.
    #[error(transparent)]
    Division(#[from] DivisionError),
    /// The solver panicked: a defect of the program.
    #[error("the solver broke off: {0} (a defect of furrow, please report it)")]
    Panicked(String),
}

/// The answer to a request.
#[derive(Debug)]
pub enum Request<'m> {
    /// Known.
    Known(Arc<Division>),
    /// Being solved by another; a [`Notice`] will come.
    Pending,
    /// Nobody has it: the asker is to solve it. A [`Notice`] comes to the asker as well.
    Yours(Ticket<'m>),
}

impl Memo {
    /// An empty memo of this build's solver.
    pub fn new(quantisation: Quantisation) -> Memo {
        Memo { quantisation, solver: SolverVersion::current(), table: DashMap::default() }
    }

    /// How R0 is rounded.
    pub fn quantisation(&self) -> Quantisation {
        self.quantisation
    }

    /// The input that is solved in place of `input`: R0 quantised.
    pub fn canonical(&self, input: &DivisionInput) -> DivisionInput {
        DivisionInput { r0: self.quantisation.apply(input.r0), ..*input }
    }

    /// The key of a canonical input.
    pub fn key(&self, canonical: &DivisionInput) -> Key {
        Key::new(canonical, self.solver)
    }

    /// Divisions known.
    pub fn len(&self) -> usize {
        self.table.iter().filter(|entry| matches!(entry.value(), Slot::Solved(_))).count()
    }

    /// Whether no division is known.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Asks for a division. Unless it is known, `waiter` is told once when it is solved, failed or given up.
    pub fn request(&self, key: Key, waiter: &Sender<Notice>) -> Request<'_> {
        // A shared guard suffices for what is known, the usual case.
        if let Some(slot) = self.table.get(&key)
            && let Slot::Solved(division) = slot.value()
        {
            return Request::Known(Arc::clone(division));
        }
        match self.table.entry(key) {
            Entry::Occupied(mut occupied) => match occupied.get_mut() {
                Slot::Solved(division) => Request::Known(Arc::clone(division)),
                Slot::InFlight(waiters) => {
                    waiters.push(waiter.clone());
                    Request::Pending
                }
            },
            Entry::Vacant(vacant) => {
                vacant.insert(Slot::InFlight(vec![waiter.clone()]));
                Request::Yours(Ticket { memo: self, key, open: true })
            }
        }
    }

    /// Replaces an in-flight slot and returns who waited for it. The guard is gone when this returns.
    fn settle(&self, key: Key, solved: Option<Arc<Division>>) -> Vec<Sender<Notice>> {
        let before = match solved {
            Some(division) => self.table.insert(key, Slot::Solved(division)),
            None => self.table.remove(&key).map(|(_, slot)| slot),
        };
        match before {
            Some(Slot::InFlight(waiters)) => waiters,
            Some(Slot::Solved(_)) | None => Vec::new(),
        }
    }
}

/// The duty to solve one division, held by exactly one at a time. Dropped unused, it lets the waiters ask again.
#[derive(Debug)]
pub struct Ticket<'m> {
    memo: &'m Memo,
    key: Key,
    open: bool,
}

impl Ticket<'_> {
    /// The key to solve.
    pub fn key(&self) -> Key {
        self.key
    }

    /// Hands in the division just solved.
    pub fn solved(self, division: Arc<Division>) {
        self.close(Some(Arc::clone(&division)), News::Solved(division));
    }

    /// Says that the division cannot be solved. Failures are not remembered.
    pub fn failed(self, failure: Failure) {
        self.close(None, News::Failed(failure));
    }

    fn close(mut self, division: Option<Arc<Division>>, news: News) {
        self.open = false;
        self.tell(division, &news);
    }

    fn tell(&self, division: Option<Arc<Division>>, news: &News) {
        for waiter in self.memo.settle(self.key, division) {
            // A waiter that is gone no longer wants to know.
            let _ = waiter.send(Notice { key: self.key, news: news.clone() });
        }
    }
}

impl Drop for Ticket<'_> {
    fn drop(&mut self) {
        if self.open {
            self.tell(None, &News::Abandoned);
        }
    }
}

/// Takes the hash from the key, which is one already.
#[derive(Debug, Default)]
pub struct PrefixHasher(u64);

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
