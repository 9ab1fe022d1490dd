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

use super::{
    key::{Key, Quantisation, SolverVersion},
    store::{Claim, Claimed, Store},
};
use crate::division::{Division, DivisionError, DivisionInput};

/// Divisions solved so far or being solved, shared by any number of trees and threads.
#[derive(Debug)]
pub struct Memo {
    quantisation: Quantisation,
    solver: SolverVersion,
    table: DashMap<Key, Slot, PrefixMap>,
    store: Option<Store>,
}

/// Builds the hasher of maps keyed by [`Key`].
pub type PrefixMap = BuildHasherDefault<PrefixHasher>;

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
    /// Another process solved it meanwhile.
    Stored(Arc<Division>),
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
    /// Known to the store, and now to the memo.
    Stored(Arc<Division>),
    /// Being solved by another; a [`Notice`] will come.
    Pending,
    /// Nobody has it: the asker is to solve it. A [`Notice`] comes to the asker as well.
    Yours(Ticket<'m>),
}

impl Memo {
    /// An empty memo of this build's solver, in memory only.
    pub fn new(quantisation: Quantisation) -> Memo {
        Memo { quantisation, solver: SolverVersion::current(), table: DashMap::default(), store: None }
    }

    /// The same, on a store: what it holds is known, and what is solved is committed to it.
    pub fn with_store(self, store: Store) -> Memo {
        Memo { store: Some(store), ..self }
    }

    /// The store, if there is one.
    pub fn store(&self) -> Option<&Store> {
        self.store.as_ref()
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
        let absent = match self.table.get(&key).as_deref() {
            Some(Slot::Solved(division)) => return Request::Known(Arc::clone(division)),
            Some(Slot::InFlight(_)) => false,
            None => true,
        };
        let stored = if absent { self.store.as_ref().and_then(|store| store.get(&key)) } else { None };
        match self.table.entry(key) {
            Entry::Occupied(mut occupied) => match occupied.get_mut() {
                Slot::Solved(division) => Request::Known(Arc::clone(division)),
                Slot::InFlight(waiters) => {
                    waiters.push(waiter.clone());
                    Request::Pending
                }
            },
            Entry::Vacant(vacant) => match stored {
                Some(division) => {
                    vacant.insert(Slot::Solved(Arc::clone(&division)));
                    Request::Stored(division)
                }
                None => {
                    vacant.insert(Slot::InFlight(vec![waiter.clone()]));
                    Request::Yours(Ticket { memo: self, key, open: true })
                }
            },
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

/// What became of a ticket when other processes were asked.
#[derive(Debug)]
pub enum Turn<'m> {
    /// To be solved here. The claim is to be kept until it is.
    Solve(Ticket<'m>, Option<Claim>),
    /// Another process is at it; claim again later.
    Busy(Ticket<'m>),
    /// Another process has solved it; the waiters have been told.
    Stored,
}

impl<'m> Ticket<'m> {
    /// The key to solve.
    pub fn key(&self) -> Key {
        self.key
    }

    /// Hands in the division just solved, and commits it to the store before anybody is told.
    pub fn solved(self, division: Division) {
        let division = Arc::new(division);
        if let Some(store) = &self.memo.store {
            store.commit(&self.key, &division);
        }
        self.close(Some(Arc::clone(&division)), News::Solved(division));
    }

    /// Asks to solve the division as far as other processes are concerned. `insist` solves it even if one is at it.
    pub fn claim(self, insist: bool) -> Turn<'m> {
        match self.memo.store.as_ref().map(|store| store.claim(&self.key)) {
            None => Turn::Solve(self, None),
            Some(Claimed::Yours(claim)) => Turn::Solve(self, claim),
            Some(Claimed::Busy) if insist => Turn::Solve(self, None),
            Some(Claimed::Busy) => Turn::Busy(self),
            Some(Claimed::Stored(division)) => {
                self.close(Some(Arc::clone(&division)), News::Stored(division));
                Turn::Stored
            }
        }
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
