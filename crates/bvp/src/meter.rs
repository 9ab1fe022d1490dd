//! Metering: how often the parts of a linearised system are worked on, over how many intervals, and for how long.
//!
//! Counts are always kept, being one addition a call. Seconds need a clock, which is not to be had everywhere and is therefore
//! brought along by whoever wants to know.

use std::ops::AddAssign;

use serde::{Deserialize, Serialize};

/// A clock: the seconds since any moment, the same for all calls.
pub type Clock = fn() -> f64;

/// One kind of work.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Share {
    /// How often it was done.
    pub calls: usize,
    /// Mesh intervals that it ran over, summed over the calls.
    pub intervals: usize,
    /// Seconds that it took; 0 without a clock.
    pub seconds: f64,
}

/// Work on the linearised system by its kinds.
///
/// ```
/// use bvp::{Share, Spent};
/// let mut all = Spent::default();
/// all += Spent { solves: Share { calls: 2, intervals: 80, seconds: 0.5 }, ..Spent::default() };
/// all += Spent { residuals: Share { calls: 1, intervals: 40, seconds: 0.25 }, ..all };
/// assert_eq!((all.solves.intervals, all.seconds()), (160, 1.25));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Spent {
    /// Residuals alone, as of chord steps.
    pub residuals: Share,
    /// Residuals together with all derivatives, as for a factorisation.
    pub derivatives: Share,
    /// Condensing the stages of the intervals.
    pub condensing: Share,
    /// Eliminating the blocks that are left.
    pub elimination: Share,
    /// Solving with the factors.
    pub solves: Share,
}

impl Spent {
    /// Seconds of all kinds together.
    pub fn seconds(&self) -> f64 {
        let Spent { residuals, derivatives, condensing, elimination, solves } = self;
        [residuals, derivatives, condensing, elimination, solves].iter().map(|share| share.seconds).sum()
    }
}

impl AddAssign for Share {
    fn add_assign(&mut self, other: Share) {
        self.calls += other.calls;
        self.intervals += other.intervals;
        self.seconds += other.seconds;
    }
}

impl AddAssign for Spent {
    fn add_assign(&mut self, other: Spent) {
        self.residuals += other.residuals;
        self.derivatives += other.derivatives;
        self.condensing += other.condensing;
        self.elimination += other.elimination;
        self.solves += other.solves;
    }
}

/// What a [`System`](crate::System) has done so far: evaluations, factorisations and solves as Newton's method asks for them.
#[derive(Clone, Copy, Debug, Default)]
pub struct Meter {
    /// What tells the time, if it is to be told.
    pub clock: Option<Clock>,
    /// The work so far.
    pub spent: Spent,
}

impl Meter {
    /// The time now; 0 without a clock.
    pub(crate) fn now(&self) -> f64 {
        self.clock.map_or(0.0, |clock| clock())
    }

    /// Counts one call over so many intervals that began at `since`.
    pub(crate) fn count(&mut self, since: f64, intervals: usize, of: impl Fn(&mut Spent) -> &mut Share) {
        let seconds = self.now() - since;
        *of(&mut self.spent) += Share { calls: 1, intervals, seconds };
    }
}
