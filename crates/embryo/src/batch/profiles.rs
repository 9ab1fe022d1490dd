//! What the work of many divisions goes into: all of them together, and those that took longest.

use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::Instant;

use bvp::Clock;

use crate::division::{Division, DivisionError, DivisionInput, Film, Outcome, Profile, divide_profiled, film_profiled};

/// How many of the slowest divisions are kept.
pub const SLOWEST: usize = 5;

/// A clock for profiles: seconds since it was first read.
pub fn seconds() -> f64 {
    static BEGIN: OnceLock<Instant> = OnceLock::new();
    BEGIN.get_or_init(Instant::now).elapsed().as_secs_f64()
}

/// One division and what it took.
#[derive(Clone, Debug, PartialEq)]
pub struct Profiled {
    /// The division.
    pub input: DivisionInput,
    /// How it ended; none if it could not be computed.
    pub outcome: Option<Outcome>,
    /// Whether its shapes were kept.
    pub film: bool,
    /// What it took.
    pub profile: Profile,
}

/// The work of divisions on any number of threads, of which the sum and the slowest are kept.
///
/// Its [`divide`](Self::divide) takes the place of [`divide`](crate::division::divide) wherever that is handed to a scheduler;
/// what is known already is not computed, and so takes no time here.
///
/// # Examples
/// ```
/// use furrow::batch::{Memo, Profiles, Quantisation, SchedulerOptions, replicates_by};
/// use furrow::cell::Cell;
/// use furrow::division::DivisionInput;
/// let (memo, profiles) = (Memo::new(Quantisation::DEFAULT), Profiles::new(None));
/// let input = DivisionInput::new(Cell::new(2.5));
/// replicates_by(&input, 2, &memo, &SchedulerOptions::default(), |input| profiles.divide(input))?;
/// let (sum, slowest) = profiles.taken();
/// assert_eq!((sum.divisions, slowest.len()), (2, 2));
/// assert_eq!(sum.work.steps, slowest[0].profile.work.steps + slowest[1].profile.work.steps);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct Profiles {
    clock: Option<Clock>,
    taken: Mutex<Taken>,
}

#[derive(Debug, Default)]
struct Taken {
    sum: Profile,
    /// Slowest first.
    slowest: Vec<Profiled>,
}

impl Profiles {
    /// None yet. Without a clock there are counts alone.
    pub fn new(clock: Option<Clock>) -> Profiles {
        Profiles { clock, taken: Mutex::default() }
    }

    /// Computes a division, and keeps what it took.
    ///
    /// # Errors
    /// As [`divide`](crate::division::divide).
    pub fn divide(&self, input: &DivisionInput) -> Result<Division, DivisionError> {
        let (found, profile) = divide_profiled(input, self.clock);
        self.keep(input, found.as_ref().ok(), false, profile);
        found
    }

    /// Computes a division as a film, and keeps what it took.
    ///
    /// # Errors
    /// As [`film`](crate::division::film()).
    pub fn film(&self, input: &DivisionInput) -> Result<Film, DivisionError> {
        let (found, profile) = film_profiled(input, self.clock);
        self.keep(input, found.as_ref().ok().map(|film| &film.division), true, profile);
        found
    }

    /// All divisions together, and those that took longest, the slowest first.
    pub fn taken(&self) -> (Profile, Vec<Profiled>) {
        let taken = self.lock();
        (taken.sum, taken.slowest.clone())
    }

    fn keep(&self, input: &DivisionInput, division: Option<&Division>, film: bool, profile: Profile) {
        let outcome = division.map(|division| division.outcome);
        let Taken { sum, slowest } = &mut *self.lock();
        *sum += profile;
        slowest.push(Profiled { input: input.clone(), outcome, film, profile });
        // Where there is no clock the work tells; equals have an order of their own, whichever thread was first.
        slowest.sort_by(|a, b| {
            let key = |x: &Profiled| (x.profile.seconds, x.profile.solved());
            let ((a_time, a_work), (b_time, b_work)) = (key(a), key(b));
            let own = |x: &Profiled| x.input.cell.r0;
            b_time
                .total_cmp(&a_time)
                .then(b_work.cmp(&a_work))
                .then(own(a).total_cmp(&own(b)))
                .then(a.input.seed.cmp(&b.input.seed))
        });
        slowest.truncate(SLOWEST);
    }

    /// What was taken by a thread that has panicked is sound: it is put in place in one piece.
    fn lock(&self) -> MutexGuard<'_, Taken> {
        self.taken.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell::Cell;

    #[test]
    fn the_slowest_are_kept_and_all_are_summed() {
        let profiles = Profiles::new(None);
        let sizes = [2.5, 2.0, 1.6, 2.4, 2.3, 2.2];
        let mut solved = 0;
        for r0 in sizes {
            profiles.divide(&DivisionInput::new(Cell::new(r0))).unwrap();
            solved += divide_profiled(&DivisionInput::new(Cell::new(r0)), None).1.solved();
        }
        assert!(profiles.divide(&DivisionInput::new(Cell::new(-1.0))).is_err());
        let (sum, slowest) = profiles.taken();
        assert_eq!((sum.divisions, sum.solved(), slowest.len()), (7, solved, SLOWEST));
        assert!(slowest.windows(2).all(|pair| pair[0].profile.solved() >= pair[1].profile.solved()));
        assert_eq!(slowest[0].outcome, Some(Outcome::Asymmetric));
        assert!(slowest.iter().all(|one| one.input.cell.r0 > 0.0), "what could not be computed took least");
    }
}
