//! What the work of a division goes into: time by phases, and counts beside it.
//!
//! A division knows no clock, so that it runs where there is none; whoever wants to know brings one along. Time is told as
//! with a stopwatch whose laps follow each other without gaps: whatever is done belongs to the phase that ends next, and the
//! phases sum to the whole.

use std::ops::AddAssign;

use bvp::{Clock, Meter, Spent, Work};
use serde::Serialize;
use serde::ser::{SerializeStruct, Serializer};

use super::outcome::{Division, DivisionError};
use super::run::run;
use super::start::Start;
use super::stepper::Stepper;
use super::{DivisionInput, Film};

/// One phase of a division.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Phase {
    /// How often it came.
    pub times: usize,
    /// Seconds that it took in all.
    pub seconds: f64,
}

/// A phase of time steps, by the kinds of work in it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Stepping {
    /// Steps accepted.
    pub times: usize,
    /// Seconds that they took with those rejected between them.
    pub seconds: f64,
    /// Of these, in the linearised systems.
    #[serde(flatten)]
    pub kernels: Spent,
    /// Seconds of all else in steps: predictions, norms of corrections, errors, volume and neck.
    pub rest: f64,
}

/// Where the time of a division went. All sum to [`Profile::seconds`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Phases {
    /// The passive shape; `times` counts divisions.
    pub start: Phase,
    /// The first step, whose activity is noisy.
    pub first_step: Stepping,
    /// All other steps.
    pub steps: Stepping,
    /// Moving the mesh; `times` counts the meshes that were moved, the seconds are of all looks at whether they should be.
    pub meshes: Phase,
    /// Looking for a stationary shape next to a slow one, and for its growth rate; `times` counts slow shapes.
    pub rest_checks: Phase,
    /// Whoever watches the shapes, as a film does; `times` counts shapes.
    pub observers: Phase,
    /// Everything else; `times` counts divisions.
    pub other: Phase,
}

/// Mesh intervals over the accepted steps of a division.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Intervals {
    /// Fewest.
    pub least: usize,
    /// Most.
    pub most: usize,
    /// Summed over the steps.
    pub sum: usize,
    /// Steps that were summed over.
    pub steps: usize,
}

/// The work of one division, or of several together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Profile {
    /// Divisions, those included that could not be computed.
    pub divisions: usize,
    /// Seconds from beginning to end, summed over the divisions; 0 without a clock, as all that follow.
    pub seconds: f64,
    /// These by phases.
    pub phases: Phases,
    /// Counts of the whole division.
    #[serde(flatten)]
    pub work: Work,
    /// Mesh intervals.
    pub intervals: Intervals,
}

impl Intervals {
    /// The mean over the steps; 0 without steps.
    pub fn mean(&self) -> f64 {
        if self.steps == 0 { 0.0 } else { self.sum as f64 / self.steps as f64 }
    }

    fn note(&mut self, intervals: usize) {
        *self += Intervals { least: intervals, most: intervals, sum: intervals, steps: 1 };
    }
}

impl Serialize for Intervals {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut out = serializer.serialize_struct("Intervals", 3)?;
        out.serialize_field("least", &self.least)?;
        out.serialize_field("mean", &self.mean())?;
        out.serialize_field("most", &self.most)?;
        out.end()
    }
}

impl Profile {
    /// Kinds of work in all steps, the first included.
    pub fn kernels(&self) -> Spent {
        let mut all = self.phases.first_step.kernels;
        all += self.phases.steps.kernels;
        all
    }

    /// Mesh intervals condensed in all steps, each once a factorisation.
    pub fn condensed(&self) -> usize {
        self.kernels().condensing.intervals
    }

    /// Mesh intervals solved in all steps, each once a Newton iteration.
    pub fn solved(&self) -> usize {
        self.kernels().solves.intervals
    }
}

impl AddAssign for Phase {
    fn add_assign(&mut self, other: Phase) {
        self.times += other.times;
        self.seconds += other.seconds;
    }
}

impl AddAssign for Stepping {
    fn add_assign(&mut self, other: Stepping) {
        self.times += other.times;
        self.seconds += other.seconds;
        self.kernels += other.kernels;
        self.rest += other.rest;
    }
}

impl AddAssign for Phases {
    fn add_assign(&mut self, other: Phases) {
        self.start += other.start;
        self.first_step += other.first_step;
        self.steps += other.steps;
        self.meshes += other.meshes;
        self.rest_checks += other.rest_checks;
        self.observers += other.observers;
        self.other += other.other;
    }
}

impl AddAssign for Intervals {
    fn add_assign(&mut self, other: Intervals) {
        self.least = match (self.steps, other.steps) {
            (0, _) => other.least,
            (_, 0) => self.least,
            _ => self.least.min(other.least),
        };
        self.most = self.most.max(other.most);
        self.sum += other.sum;
        self.steps += other.steps;
    }
}

impl AddAssign for Profile {
    fn add_assign(&mut self, other: Profile) {
        self.divisions += other.divisions;
        self.seconds += other.seconds;
        self.phases += other.phases;
        self.work += other.work;
        self.intervals += other.intervals;
    }
}

/// [`divide`](super::divide) with what it took, told also of a division that could not be computed. The division is the same
/// to the last bit. Without a clock there are counts alone, which are the same every time.
///
/// # Examples
/// ```
/// use mechanics::cell::Cell;
/// use mechanics::division::{DivisionInput, divide_profiled};
/// let (division, profile) = divide_profiled(&DivisionInput::new(Cell::new(2.5)), None);
/// assert_eq!(profile.work, division?.work);
/// assert_eq!(profile.phases.steps.times + profile.phases.first_step.times, profile.work.steps);
/// println!("{} intervals on average, {} condensed", profile.intervals.mean(), profile.condensed());
/// # Ok::<(), mechanics::division::DivisionError>(())
/// ```
pub fn divide_profiled(input: &DivisionInput, clock: Option<Clock>) -> (Result<Division, DivisionError>, Profile) {
    let mut watch = Watch::start(clock);
    let found = run(input, &Start::Passive, &mut |_| {}, &[], &mut watch);
    (found.map(|(division, _)| division), watch.stop())
}

/// [`film`](super::film()) with what it took: that of the division, and the keeping of its shapes as what observes it.
pub fn film_profiled(input: &DivisionInput, clock: Option<Clock>) -> (Result<Film, DivisionError>, Profile) {
    let mut watch = Watch::start(clock);
    let film = super::film::record(input, &mut watch);
    (film, watch.stop())
}

/// The stopwatch of a division, with the laps so far.
#[derive(Clone, Debug, Default)]
pub(crate) struct Watch {
    clock: Option<Clock>,
    began: f64,
    lap: f64,
    profile: Profile,
}

impl Watch {
    /// A watch that begins now.
    fn start(clock: Option<Clock>) -> Watch {
        let now = clock.map_or(0.0, |clock| clock());
        Watch { clock, began: now, lap: now, profile: Profile::default() }
    }

    /// Seconds since the last lap; a new one begins.
    fn lap(&mut self) -> f64 {
        let Some(clock) = self.clock else { return 0.0 };
        let before = std::mem::replace(&mut self.lap, clock());
        self.lap - before
    }

    fn add(&mut self, times: usize, phase: impl Fn(&mut Phases) -> &mut Phase) {
        let seconds = self.lap();
        *phase(&mut self.profile.phases) += Phase { times, seconds };
    }

    /// The start shape is found; what is done in the linearised systems of steps is counted from here.
    pub(super) fn started(&mut self, stepper: &mut Stepper) {
        stepper.system.meter = Meter { clock: self.clock, spent: Spent::default() };
        self.add(1, |phases| &mut phases.start);
    }

    /// The observer has seen a shape.
    pub(super) fn observed(&mut self) {
        self.add(1, |phases| &mut phases.observers);
    }

    /// A step is accepted, or given up. The first is one by itself.
    pub(super) fn stepped(&mut self, stepper: &mut Stepper, steps: usize, rejected: usize) {
        let kernels = stepper.take_spent();
        let seconds = self.lap();
        let before = self.profile.work.steps;
        let times = steps - before;
        let phases = &mut self.profile.phases;
        let phase = if before == 0 { &mut phases.first_step } else { &mut phases.steps };
        *phase += Stepping { times, seconds, kernels, rest: seconds - kernels.seconds() };
        self.profile.work = Work { steps, rejected, ..stepper.work };
        if times > 0 {
            self.profile.intervals.note(stepper.levels[0].y.intervals());
        }
    }

    /// The mesh is moved, or left as it is.
    pub(super) fn meshed(&mut self, stepper: &Stepper) {
        let work = &mut self.profile.work;
        let before = std::mem::replace(&mut work.remeshings, stepper.work.remeshings);
        self.add(stepper.work.remeshings - before, |phases| &mut phases.meshes);
    }

    /// The shape is looked at for whether it rests; `looks` were taken so far.
    pub(super) fn rested(&mut self, looks: usize) {
        self.add(looks - self.profile.phases.rest_checks.times, |phases| &mut phases.rest_checks);
    }

    /// Whatever is in no other phase.
    pub(super) fn other(&mut self) {
        self.add(0, |phases| &mut phases.other);
    }

    /// The end.
    fn stop(mut self) -> Profile {
        self.add(1, |phases| &mut phases.other);
        Profile { divisions: 1, seconds: self.lap - self.began, ..self.profile }
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell as Counter;

    use super::*;
    use crate::cell::{Cell, Cue};
    use crate::division::{divide, film};

    thread_local! {
        static READINGS: Counter<f64> = const { Counter::new(0.0) };
    }

    /// A clock that is one second on whenever it is read, so that spans of time count readings.
    fn readings() -> f64 {
        READINGS.with(|readings| {
            readings.set(readings.get() + 1.0);
            readings.get()
        })
    }

    fn seconds_of(phases: &Phases) -> f64 {
        let Phases { start, first_step, steps, meshes, rest_checks, observers, other } = phases;
        let plain = [start, meshes, rest_checks, observers, other].iter().map(|phase| phase.seconds).sum::<f64>();
        plain + first_step.seconds + steps.seconds
    }

    fn inputs() -> [DivisionInput; 4] {
        let cell = Cell::new;
        let cells = [cell(2.5), cell(2.0), cell(1.6), cell(5.4).with_cue(Cue::published())];
        cells.map(DivisionInput::new)
    }

    #[test]
    fn phases_sum_to_the_whole_and_kernels_to_what_was_counted() {
        for input in inputs() {
            let (division, profile) = divide_profiled(&input, Some(readings));
            let (division, Profile { phases, seconds, .. }) = (division.unwrap(), profile);
            assert_eq!(seconds_of(&phases), seconds);
            let nearly_all = seconds - phases.other.seconds;
            assert!(nearly_all > 0.9 * seconds, "{nearly_all} of {seconds}");
            for stepping in [phases.first_step, phases.steps] {
                assert_eq!(stepping.kernels.seconds() + stepping.rest, stepping.seconds);
                let Spent { residuals, derivatives, condensing, elimination, solves } = stepping.kernels;
                // From one reading to the next a second goes by, in the kernel; so does one to the kernel behind it.
                for share in [residuals, derivatives, condensing, elimination, solves] {
                    assert_eq!(share.seconds, share.calls as f64);
                }
                assert_eq!(condensing.calls, elimination.calls);
                // Each is solved for once, but for the derivatives about which a step on halves solves for its antisymmetric part.
                let unsolved = residuals.calls + derivatives.calls - solves.calls;
                let symmetric = input.cell.is_mirror_symmetric();
                assert!(if symmetric {
                    unsolved <= division.work.steps + division.work.rejected
                } else {
                    unsolved == 0
                });
                assert!(stepping.rest > 0.0);
            }
            assert_eq!(phases.first_step.times + phases.steps.times, division.work.steps);
            assert_eq!(phases.observers.times, division.work.steps, "the start, and all steps but the noisy first");
            assert_eq!(phases.meshes.times, division.work.remeshings);
            let rests = division.growth_rate.is_some();
            assert!(phases.rest_checks.times > 0 || !rests, "what rests was looked at");
            assert_eq!(profile.work, division.work);
        }
    }

    #[test]
    fn a_watch_changes_nothing_and_without_a_clock_it_counts_the_same() {
        for input in inputs() {
            let (division, profile) = divide_profiled(&input, Some(readings));
            let (same, counts) = divide_profiled(&input, None);
            assert_eq!(division.as_ref(), same.as_ref());
            assert_eq!(division, divide(&input));
            assert_eq!(counts.seconds, 0.0);
            assert_eq!((counts.condensed(), counts.solved()), (profile.condensed(), profile.solved()));
            assert_eq!((counts.work, counts.intervals), (profile.work, profile.intervals));
            let Intervals { least, most, sum, steps } = counts.intervals;
            assert_eq!(steps, counts.work.steps);
            assert!(least <= most && (least * steps..=most * steps).contains(&sum));
            let factorisations = counts.kernels().condensing.calls;
            let least = if input.cell.is_mirror_symmetric() { least / 2 } else { least };
            assert!((least * factorisations..=most * factorisations).contains(&counts.condensed()));
        }
    }

    #[test]
    fn what_cannot_be_computed_has_taken_time_too() {
        let mut input = DivisionInput::new(Cell::new(1.6));
        input.numerics.t_max = 0.01;
        let (division, profile) = divide_profiled(&input, Some(readings));
        assert!(division.is_err());
        assert!(profile.work.steps > 2 && profile.phases.steps.times + 1 == profile.work.steps);
        assert_eq!(seconds_of(&profile.phases), profile.seconds);
        let (refused, profile) = divide_profiled(&DivisionInput::new(Cell::new(-1.0)), Some(readings));
        assert!(refused.is_err() && profile.work == Work::default());
    }

    #[test]
    fn a_film_is_an_observer() {
        let input = DivisionInput::new(Cell::new(2.5));
        let (recorded, profile) = film_profiled(&input, Some(readings));
        let recorded = recorded.unwrap();
        assert_eq!(recorded.division, film(&input).unwrap().division);
        assert_eq!(profile.phases.observers.times, recorded.times().len());
    }

    #[test]
    fn profiles_add_up_in_any_order() {
        let [a, b, c, _] = inputs().map(|input| divide_profiled(&input, Some(readings)).1);
        let sum = |parts: [Profile; 3]| {
            parts.into_iter().fold(Profile::default(), |mut sum, part| {
                sum += part;
                sum
            })
        };
        let all = sum([a, b, c]);
        assert_eq!(all, sum([c, a, b]));
        assert_eq!(all.divisions, 3);
        assert_eq!(all.intervals.least, [a, b, c].map(|part| part.intervals.least).into_iter().min().unwrap());
        assert_eq!(all.condensed(), a.condensed() + b.condensed() + c.condensed());
        assert_eq!(seconds_of(&all.phases), all.seconds);
    }
}
