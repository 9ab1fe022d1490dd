//! The memo: no task is solved twice.
//!
//! Every task is looked up by its [`Key`]. The first to ask for an unknown key gets a [`Ticket`], the duty to solve it;
//! whoever asks before it is solved leaves the sending end of a channel and goes on with other work. Nobody ever blocks on
//! a key, and no guard of the table is held while solving, sending or waiting.

use std::sync::{Arc, mpsc::Sender};

use dashmap::{DashMap, Entry};

use super::{
    key::{Key, PrefixState, SolverVersion},
    quantisation::Quantisation,
    store::{Claim, Claimed, Store},
    task::{Record, Task},
};

/// Records solved so far or being solved, shared by any number of runs and threads.
#[derive(Debug)]
pub struct Memo<T: Task> {
    quantisation: Quantisation,
    solver: SolverVersion,
    table: DashMap<Key, Slot<T>, PrefixState>,
    store: Option<Store<T::Record>>,
}

#[derive(Debug)]
enum Slot<T: Task> {
    Solved(Arc<T::Record>),
    /// Being solved; these are told when it is.
    InFlight(Vec<Sender<Notice<T>>>),
}

/// Word to a waiter about a key.
#[derive(Clone, Debug)]
pub struct Notice<T: Task> {
    /// The key waited for.
    pub key: Key,
    /// What became of it.
    pub news: News<T>,
}

/// What became of a key that was in flight.
#[derive(Clone, Debug)]
pub enum News<T: Task> {
    /// Solved, just now.
    Solved(Arc<T::Record>),
    /// Another process solved it meanwhile.
    Stored(Arc<T::Record>),
    /// Could not be solved.
    Failed(Failure<T::Error>),
    /// Whoever was to solve it gave up; ask again.
    Abandoned,
}

/// Why a task has no record.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Failure<E> {
    /// The solver says why.
    #[error(transparent)]
    Unsolved(E),
    /// The solver panicked: a defect of the program.
    #[error("the solver broke off: {0} (a defect of furrow, please report it)")]
    Panicked(String),
}

/// The answer to a request.
#[derive(Debug)]
pub enum Request<'m, T: Task> {
    /// Known.
    Known(Arc<T::Record>),
    /// Known to the store, and now to the memo.
    Stored(Arc<T::Record>),
    /// Being solved by another; a [`Notice`] will come.
    Pending,
    /// Nobody has it: the asker is to solve it. A [`Notice`] comes to the asker as well.
    Yours(Ticket<'m, T>),
}

impl<T: Task> Memo<T> {
    /// An empty memo of this build's solver, in memory only.
    pub fn new(quantisation: Quantisation) -> Memo<T> {
        Memo { quantisation, solver: SolverVersion::current(), table: DashMap::default(), store: None }
    }

    /// The same, on a store: what it holds is known, and what is solved is committed to it.
    pub fn with_store(self, store: Store<T::Record>) -> Memo<T> {
        Memo { store: Some(store), ..self }
    }

    /// The store, if there is one.
    pub fn store(&self) -> Option<&Store<T::Record>> {
        self.store.as_ref()
    }

    /// How sizes are rounded.
    pub fn quantisation(&self) -> Quantisation {
        self.quantisation
    }

    /// The task that is solved in place of `task`: its size rounded.
    pub fn canonical(&self, task: &T) -> T {
        task.with_size(self.quantisation.apply(task.size()))
    }

    /// The key of a canonical task.
    pub fn key(&self, canonical: &T) -> Key {
        Key::new(canonical, self.solver)
    }

    /// The record of a task if the memo or its store knows it, for who wants nothing solved.
    ///
    /// ```
    /// use furrow::batch::{Memo, Quantisation};
    /// use furrow::cell::Cell;
    /// use furrow::division::DivisionInput;
    ///
    /// let memo: Memo<DivisionInput> = Memo::new(Quantisation::DEFAULT);
    /// assert_eq!(memo.known(&DivisionInput::new(Cell::new(2.0))), None);
    /// ```
    pub fn known(&self, task: &T) -> Option<T::Record> {
        let canonical = self.canonical(task);
        let key = self.key(&canonical);
        // No guard is held while the store is asked.
        let here = self.table.get(&key).map(|slot| match slot.value() {
            Slot::Solved(record) => Some(Arc::clone(record)),
            Slot::InFlight(_) => None,
        });
        let record = match here {
            Some(here) => here?,
            None => self.store.as_ref()?.get(&key)?,
        };
        Some(record.scaled(task.size() / canonical.size()))
    }

    /// Records known.
    pub fn len(&self) -> usize {
        self.table.iter().filter(|entry| matches!(entry.value(), Slot::Solved(_))).count()
    }

    /// Whether no record is known.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Asks for a record. Unless it is known, `waiter` is told once when it is solved, failed or given up.
    pub fn request(&self, key: Key, waiter: &Sender<Notice<T>>) -> Request<'_, T> {
        // A shared guard suffices for what is known, the usual case.
        let absent = match self.table.get(&key).as_deref() {
            Some(Slot::Solved(record)) => return Request::Known(Arc::clone(record)),
            Some(Slot::InFlight(_)) => false,
            None => true,
        };
        let stored = if absent { self.store.as_ref().and_then(|store| store.get(&key)) } else { None };
        match self.table.entry(key) {
            Entry::Occupied(mut occupied) => match occupied.get_mut() {
                Slot::Solved(record) => Request::Known(Arc::clone(record)),
                Slot::InFlight(waiters) => {
                    waiters.push(waiter.clone());
                    Request::Pending
                }
            },
            Entry::Vacant(vacant) => match stored {
                Some(record) => {
                    vacant.insert(Slot::Solved(Arc::clone(&record)));
                    Request::Stored(record)
                }
                None => {
                    vacant.insert(Slot::InFlight(vec![waiter.clone()]));
                    Request::Yours(Ticket { memo: self, key, open: true })
                }
            },
        }
    }

    /// Replaces an in-flight slot and returns who waited for it. The guard is gone when this returns.
    fn settle(&self, key: Key, solved: Option<Arc<T::Record>>) -> Vec<Sender<Notice<T>>> {
        let before = match solved {
            Some(record) => self.table.insert(key, Slot::Solved(record)),
            None => self.table.remove(&key).map(|(_, slot)| slot),
        };
        match before {
            Some(Slot::InFlight(waiters)) => waiters,
            Some(Slot::Solved(_)) | None => Vec::new(),
        }
    }
}

/// The duty to solve one task, held by exactly one at a time. Dropped unused, it lets the waiters ask again.
#[derive(Debug)]
pub struct Ticket<'m, T: Task> {
    memo: &'m Memo<T>,
    key: Key,
    open: bool,
}

/// What became of a ticket when other processes were asked.
#[derive(Debug)]
pub enum Turn<'m, T: Task> {
    /// To be solved here. The claim is to be kept until it is.
    Solve(Ticket<'m, T>, Option<Claim>),
    /// Another process is at it; claim again later.
    Busy(Ticket<'m, T>),
    /// Another process has solved it; the waiters have been told.
    Stored,
}

impl<'m, T: Task> Ticket<'m, T> {
    /// The key to solve.
    pub fn key(&self) -> Key {
        self.key
    }

    /// Hands in the record just solved, and commits it to the store before anybody is told.
    pub fn solved(self, record: T::Record) {
        let record = Arc::new(record);
        if let Some(store) = &self.memo.store {
            store.commit(&self.key, &record);
        }
        self.close(Some(Arc::clone(&record)), News::Solved(record));
    }

    /// Asks to solve the task as far as other processes are concerned. `insist` solves it even if one is at it.
    pub fn claim(self, insist: bool) -> Turn<'m, T> {
        match self.memo.store.as_ref().map(|store| store.claim(&self.key)) {
            None => Turn::Solve(self, None),
            Some(Claimed::Yours(claim)) => Turn::Solve(self, claim),
            Some(Claimed::Busy) if insist => Turn::Solve(self, None),
            Some(Claimed::Busy) => Turn::Busy(self),
            Some(Claimed::Stored(record)) => {
                self.close(Some(Arc::clone(&record)), News::Stored(record));
                Turn::Stored
            }
        }
    }

    /// Says that the task cannot be solved. Failures are not remembered.
    pub fn failed(self, failure: Failure<T::Error>) {
        self.close(None, News::Failed(failure));
    }

    fn close(mut self, record: Option<Arc<T::Record>>, news: News<T>) {
        self.open = false;
        self.tell(record, &news);
    }

    fn tell(&self, record: Option<Arc<T::Record>>, news: &News<T>) {
        for waiter in self.memo.settle(self.key, record) {
            // A waiter that is gone no longer wants to know.
            let _ = waiter.send(Notice { key: self.key, news: news.clone() });
        }
    }
}

impl<T: Task> Drop for Ticket<'_, T> {
    fn drop(&mut self) {
        if self.open {
            self.tell(None, &News::Abandoned);
        }
    }
}
