//! The memo: no division is solved twice.
//!
//! Every division is looked up by its [`Key`]. The first caller that requests an unknown key gets a [`Lease`] and must
//! solve it; all other callers leave the sending end of a channel and continue with other work. No thread blocks on a
//! key, and no lock of the table is held while solving, sending or reading the store.

use std::hash::BuildHasherDefault;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, mpsc::Sender};

use dashmap::{DashMap, Entry};

use super::key::{Key, PrefixHasher};
use super::quantisation::Quantisation;
use super::store::Store;
use furrow_cell::Cell;
use furrow_mechanics::division::{Division, DivisionError, DivisionInput};

/// Computes divisions, on any thread.
pub trait Solve: Fn(&DivisionInput) -> Result<Division, DivisionError> + Sync {}

impl<F: Fn(&DivisionInput) -> Result<Division, DivisionError> + Sync> Solve for F {}

/// Solved divisions and divisions in progress, shared by any number of runs and threads.
#[derive(Debug)]
pub struct Memo {
    quantisation: Quantisation,
    table: DashMap<Key, Slot, BuildHasherDefault<PrefixHasher>>,
    store: Option<Store>,
    observer: Option<Observer>,
}

/// Called for every requested division, on any thread.
pub type Observer = fn(&Key, Noted<'_>);

/// The state of a requested division.
#[derive(Clone, Copy, Debug)]
pub enum Noted<'a> {
    /// It is known.
    Known {
        /// The division.
        division: &'a Division,
        /// Whether it came from the store now.
        stored: bool,
    },
    /// It is being solved for another request.
    Awaited,
    /// A solver begins; on the same thread it ends with one of the following.
    Begun,
    /// It is solved.
    Solved(&'a DivisionInput, &'a Division),
    /// It could not be solved.
    Failed(&'a DivisionInput),
}

#[derive(Debug)]
enum Slot {
    Solved(Arc<Division>),
    /// In progress; these senders get the [`Event`].
    InFlight(Vec<Sender<Event>>),
}

/// Messages of workers to waiting runs.
#[expect(missing_docs, reason = "the names of the fields say it")]
#[derive(Clone, Debug)]
pub enum Event {
    /// The end of a lease.
    Completed { key: Key, completion: Completion },
    /// The preparation of the job with this number is done. The memo itself never sends this.
    Prepared(usize),
}

/// The result for a key that was in progress.
#[derive(Clone, Debug)]
pub enum Completion {
    /// Solved now, or read from the store because another process has solved it meanwhile.
    Known {
        /// The division.
        division: Arc<Division>,
        /// Whether it came from the store.
        stored: bool,
    },
    /// Could not be solved.
    Failed(Failure),
    /// The lease was dropped; the key must be requested again.
    Abandoned,
}

/// The reason why a division is unknown.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Failure {
    /// The solver's reason.
    #[error(transparent)]
    Unsolved(DivisionError),
    /// The solver panicked: a defect of the program.
    #[error("internal error: the solver panicked: {0} (please report it)")]
    Panicked(String),
}

/// The answer to a request.
#[derive(Debug)]
pub enum Request<'m> {
    /// Known.
    Known {
        /// The division.
        division: Arc<Division>,
        /// Whether this request read it from the store.
        stored: bool,
    },
    /// Another caller is solving it; an [`Event`] will be sent.
    Pending,
    /// The caller must solve it. The caller gets an [`Event`] too.
    Leased(Lease<'m>),
}

impl Memo {
    /// An empty memo, in memory only.
    pub fn new(quantisation: Quantisation) -> Memo {
        // The default number of shards requires a system call for the number of cores, which takes longer than a look-up.
        let table = DashMap::with_hasher_and_shard_amount(BuildHasherDefault::default(), 16);
        Memo { quantisation, table, store: None, observer: None }
    }

    /// The same memo with an observer.
    ///
    /// ```
    /// use furrow_lineage::batch::{Memo, Noted, Quantisation};
    /// use std::sync::atomic::{AtomicUsize, Ordering};
    ///
    /// static SOLVED: AtomicUsize = AtomicUsize::new(0);
    /// let memo = Memo::new(Quantisation::DEFAULT).observed_by(|_, noted| {
    ///     SOLVED.fetch_add(usize::from(matches!(noted, Noted::Solved(..))), Ordering::Relaxed);
    /// });
    /// let input = furrow_mechanics::division::DivisionInput::new(furrow_cell::Cell::new(1.5));
    /// for _ in 0..2 {
    ///     memo.solve(&input, furrow_lineage::batch::solve)?;
    /// }
    /// assert_eq!(SOLVED.load(Ordering::Relaxed), 1);
    /// # Ok::<(), furrow_lineage::batch::Failure>(())
    /// ```
    pub fn observed_by(self, observer: Observer) -> Memo {
        Memo { observer: Some(observer), ..self }
    }

    fn note(&self, key: &Key, noted: Noted<'_>) {
        if let Some(observer) = self.observer {
            observer(key, noted);
        }
    }

    /// The same memo over a store: it reads the store's divisions and commits new ones to it.
    pub fn with_store(self, store: Store) -> Memo {
        Memo { store: Some(store), ..self }
    }

    /// The store, if there is one.
    pub fn store(&self) -> Option<&Store> {
        self.store.as_ref()
    }

    /// How radii are rounded.
    pub fn quantisation(&self) -> Quantisation {
        self.quantisation
    }

    /// The input that is solved instead of `input`, with a rounded radius.
    pub fn canonical(&self, input: &DivisionInput) -> DivisionInput {
        let cell = Cell { r0: self.quantisation.apply(input.cell.r0), ..input.cell.clone() };
        DivisionInput { cell, ..*input }
    }

    /// The division, if it is in the memo or its store; nothing is solved.
    ///
    /// ```
    /// use furrow_lineage::batch::{Memo, Quantisation};
    /// use furrow_cell::Cell;
    /// use furrow_mechanics::division::DivisionInput;
    ///
    /// let memo = Memo::new(Quantisation::DEFAULT);
    /// assert_eq!(memo.known(&DivisionInput::new(Cell::new(2.0))), None);
    /// ```
    pub fn known(&self, input: &DivisionInput) -> Option<Division> {
        let canonical = self.canonical(input);
        let key = Key::new(&canonical);
        let here = self.table.get(&key).map(|slot| slot.solved());
        let division = here.unwrap_or_else(|| self.stored(&key))?;
        Some(division.as_ref().clone().with_daughters_scaled(input.cell.r0 / canonical.cell.r0))
    }

    /// The number of known divisions.
    pub fn len(&self) -> usize {
        self.table.iter().filter(|slot| slot.solved().is_some()).count()
    }

    /// Whether no division is known.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Requests a division. If it is unknown, `waiter` gets one [`Event`].
    pub fn request(&self, key: Key, waiter: &Sender<Event>) -> Request<'_> {
        let stored = if self.table.contains_key(&key) { None } else { self.stored(&key) };
        match (self.table.entry(key), stored) {
            (Entry::Occupied(mut occupied), _) => match occupied.get_mut() {
                Slot::Solved(division) => {
                    self.note(&key, Noted::Known { division, stored: false });
                    Request::Known { division: Arc::clone(division), stored: false }
                }
                Slot::InFlight(waiters) => {
                    waiters.push(waiter.clone());
                    self.note(&key, Noted::Awaited);
                    Request::Pending
                }
            },
            (Entry::Vacant(vacant), Some(division)) => {
                vacant.insert(Slot::Solved(Arc::clone(&division)));
                self.note(&key, Noted::Known { division: &division, stored: true });
                Request::Known { division, stored: true }
            }
            (Entry::Vacant(vacant), None) => {
                vacant.insert(Slot::InFlight(vec![waiter.clone()]));
                Request::Leased(Lease { memo: self, key, open: true })
            }
        }
    }

    /// The division of `input`. If it is unknown, it is solved here and stored.
    ///
    /// If another thread is solving the same division, this thread solves it too instead of waiting, so that a worker of a pool is
    /// never blocked; both results are the same.
    ///
    /// # Errors
    /// [`Failure`].
    pub fn solve(&self, input: &DivisionInput, solve: impl Solve) -> Result<Division, Failure> {
        let canonical = self.canonical(input);
        let key = Key::new(&canonical);
        let scaled = |division: Division| division.with_daughters_scaled(input.cell.r0 / canonical.cell.r0);
        let (sender, events) = std::sync::mpsc::channel();
        let division = match self.request(key, &sender) {
            Request::Known { division, .. } => return Ok(scaled(division.as_ref().clone())),
            Request::Pending => return solve(&canonical).map(scaled).map_err(Failure::Unsolved),
            Request::Leased(lease) => {
                lease.solve(&canonical, solve);
                events.try_recv()
            }
        };
        match division {
            Ok(Event::Completed { completion: Completion::Known { division, .. }, .. }) => {
                Ok(scaled(division.as_ref().clone()))
            }
            Ok(Event::Completed { completion: Completion::Failed(failure), .. }) => Err(failure),
            _ => Err(Failure::Panicked("a solved division was not reported".to_owned())),
        }
    }

    fn stored(&self, key: &Key) -> Option<Arc<Division>> {
        self.store.as_ref()?.get(key).map(Arc::new)
    }
}

impl Slot {
    fn solved(&self) -> Option<Arc<Division>> {
        match self {
            Slot::Solved(division) => Some(Arc::clone(division)),
            Slot::InFlight(_) => None,
        }
    }
}

/// The obligation to solve one division, held by exactly one caller at a time. If it is dropped unused, the waiters can request
/// the key again.
#[derive(Debug)]
pub struct Lease<'m> {
    memo: &'m Memo,
    key: Key,
    open: bool,
}

impl Lease<'_> {
    /// The key to solve.
    pub fn key(&self) -> Key {
        self.key
    }

    /// Solves `input` unless another process has done so meanwhile, stores the result, and notifies the waiters.
    pub fn solve(mut self, input: &DivisionInput, solve: impl Solve) {
        self.open = false;
        let completion = match self.memo.stored(&self.key) {
            Some(division) => {
                self.memo.note(&self.key, Noted::Known { division: &division, stored: true });
                Completion::Known { division, stored: true }
            }
            // A panic must not end the pool and the process, since the divisions of other workers would be lost.
            None => match self.solved(input, solve) {
                Ok(Ok(division)) => {
                    if let Some(store) = &self.memo.store {
                        store.commit(&self.key, input, &division);
                    }
                    Completion::Known { division: Arc::new(division), stored: false }
                }
                Ok(Err(error)) => Completion::Failed(Failure::Unsolved(error)),
                Err(payload) => Completion::Failed(Failure::Panicked(panic_text(payload.as_ref()))),
            },
        };
        self.complete(completion);
    }

    /// The solver's answer, or its panic.
    fn solved(&self, input: &DivisionInput, solve: impl Solve) -> Result<Result<Division, DivisionError>, Panic> {
        self.memo.note(&self.key, Noted::Begun);
        let found = catch_unwind(AssertUnwindSafe(|| solve(input)));
        self.memo.note(
            &self.key,
            match &found {
                Ok(Ok(division)) => Noted::Solved(input, division),
                _ => Noted::Failed(input),
            },
        );
        found
    }

    /// Replaces the slot in progress and notifies the waiters. Failures are not stored.
    fn complete(&self, completion: Completion) {
        let before = match &completion {
            Completion::Known { division, .. } => self.memo.table.insert(self.key, Slot::Solved(Arc::clone(division))),
            Completion::Failed(_) | Completion::Abandoned => self.memo.table.remove(&self.key).map(|(_, slot)| slot),
        };
        let Some(Slot::InFlight(waiters)) = before else { return };
        for waiter in waiters {
            // The waiter may no longer exist.
            let _ = waiter.send(Event::Completed { key: self.key, completion: completion.clone() });
        }
    }
}

impl Drop for Lease<'_> {
    fn drop(&mut self) {
        if self.open {
            self.complete(Completion::Abandoned);
        }
    }
}

/// The payload of a panic.
type Panic = Box<dyn std::any::Any + Send>;

fn panic_text(payload: &(dyn std::any::Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| payload.downcast_ref::<String>().cloned()).unwrap_or_else(|| "no message".to_owned())
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::{Failure, Memo};
    use crate::batch::{Quantisation, fake};
    use furrow_mechanics::division::DivisionError;

    #[test]
    fn a_division_is_solved_once_and_a_failure_is_not_remembered() {
        let (memo, count) = (Memo::new(Quantisation::with_relative_step(0.01).unwrap()), AtomicUsize::new(0));
        let solve = |input: &_| {
            count.fetch_add(1, Ordering::Relaxed);
            Ok(fake::divide(input))
        };
        let failed = memo.solve(&fake::input(2.0), |_| Err(DivisionError::Cancelled { r0: 2.0, t: 0.0 }));
        assert!(matches!(failed, Err(Failure::Unsolved(_))) && memo.is_empty());
        assert!(matches!(memo.solve(&fake::input(2.0), |_| panic!("broken")), Err(Failure::Panicked(_))));
        let first = memo.solve(&fake::input(2.0), solve).unwrap();
        let beside = memo.solve(&fake::input(2.001), solve).unwrap();
        assert_eq!((count.load(Ordering::Relaxed), memo.len(), first.chi()), (1, 1, beside.chi()));
        // The daughters' volumes add up to the volume of the requested mother, not of the rounded one.
        let volume = |division: &furrow_mechanics::division::Division| -> f64 {
            division.daughters().unwrap().iter().map(|r0| r0.powi(3)).sum()
        };
        assert!((volume(&beside) / volume(&first) - 1.0005_f64.powi(3)).abs() < 1e-12);
    }

    #[test]
    fn the_daughters_of_a_scaled_division_have_its_volume() {
        let division = fake::divide(&fake::input(2.0)).with_daughters_of(2.0);
        let larger = division.clone().with_daughters_scaled(1.001);
        let volume: f64 = larger.daughters().unwrap().iter().map(|r0| r0.powi(3)).sum();
        assert!((volume / 2.002_f64.powi(3) - 1.0).abs() < 1e-14);
        assert_eq!(larger.with_daughters_of(2.0), division);
    }
}
