//! What the work of divisions went into, as a table.

use std::fmt::Write;

use bvp::{Share, Work};
use serde::Serialize;

use super::table::outcome_name;
use crate::batch::Profiled;
use crate::cell::Cue;
use crate::division::profile::{Intervals, Phase, Phases, Stepping};
use crate::division::{Outcome, Profile};

/// The profile of all divisions that were computed, and the slowest of them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProfileReport {
    /// All of them together.
    #[serde(flatten)]
    pub sum: Profile,
    /// The slowest first.
    pub slowest: Vec<SlowDivision>,
}

/// One of the slowest divisions.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SlowDivision {
    /// The cell's name in a tree, or what else tells it from the others.
    pub name: String,
    /// Its radius, in L_h.
    pub r0: f64,
    /// Its cue.
    pub cue: Cue,
    /// How it ended; none if it could not be computed.
    pub outcome: Option<Outcome>,
    /// Seconds that it took.
    pub seconds: f64,
    /// Its steps and what they took.
    #[serde(flatten)]
    pub work: Work,
    /// Mesh intervals over its steps.
    pub intervals: Intervals,
}

/// From so many seconds on times are in seconds, below in milliseconds.
const IN_SECONDS: f64 = 10.0;

/// Width of the first column.
const NAME: usize = 28;

impl ProfileReport {
    /// Of what was taken, with a name for each of the slowest.
    pub fn new((sum, slowest): (Profile, Vec<Profiled>), name: impl Fn(&Profiled) -> String) -> ProfileReport {
        let of = |one: &Profiled| SlowDivision {
            name: name(one),
            r0: one.input.cell.r0,
            cue: one.input.cell.cue.clone(),
            outcome: one.outcome,
            seconds: one.profile.seconds,
            work: one.profile.work,
            intervals: one.profile.intervals,
        };
        ProfileReport { slowest: slowest.iter().map(of).collect(), sum }
    }

    /// Phases with their times, shares and counts, one a line; counts of all; the slowest, where there are several.
    pub fn text(&self) -> String {
        let Profile { divisions, work, intervals, .. } = self.sum;
        let mut out = match divisions {
            0 => return "profile: no division was computed\n".to_owned(),
            1 => "profile of one division\n\n".to_owned(),
            _ => format!("profile of {divisions} divisions that were computed\n\n"),
        };
        self.phases(&mut out);
        let Work { steps, rejected, iterations, factorisations, remeshings } = work;
        let _ = writeln!(
            out,
            "\n{steps} steps ({rejected} rejected), {iterations} Newton iterations, {factorisations} factorisations, \
             {remeshings} meshes\n{} to {} intervals, {:.1} a step; {} condensed, {} solved",
            intervals.least,
            intervals.most,
            intervals.mean(),
            self.sum.condensed(),
            self.sum.solved()
        );
        if divisions > 1 {
            self.slow_divisions(&mut out);
        }
        out
    }

    /// The unit of times, and how many there are in a second.
    fn unit(&self) -> (&'static str, f64) {
        if self.sum.seconds < IN_SECONDS { ("ms", 1e3) } else { ("s", 1.0) }
    }

    fn phases(&self, out: &mut String) {
        let (unit, scale) = self.unit();
        let _ = writeln!(out, "{:NAME$} {unit:>9} {:>6} {:>8} {:>10}", "phase", "%", "times", "intervals");
        let mut row = |name: &str, seconds: f64, times: Option<usize>, intervals: Option<usize>| {
            // Of nothing measured no share is known; what is a rounding below 0 is 0.
            let share = if self.sum.seconds > 0.0 { 100.0 * seconds / self.sum.seconds } else { 0.0 };
            let count = |n: Option<usize>| n.map_or(String::new(), |n| n.to_string());
            let line = format!(
                "{name:NAME$} {:9.2} {:6.1} {:>8} {:>10}",
                (scale * seconds).max(0.0),
                share.max(0.0),
                count(times),
                count(intervals)
            );
            let _ = writeln!(out, "{}", line.trim_end());
        };
        let Phases { start, first_step, steps, meshes, rest_checks, observers, other } = self.sum.phases;
        let mut phase = |name: &str, Phase { times, seconds }: Phase| row(name, seconds, Some(times), None);
        phase("start (passive shape)", start);
        phase("first step", Phase { times: first_step.times, seconds: first_step.seconds });
        phase("other steps", Phase { times: steps.times, seconds: steps.seconds });
        let Stepping { kernels, rest, .. } = steps;
        for (name, Share { calls, intervals, seconds }) in [
            ("  residuals", kernels.residuals),
            ("  derivatives", kernels.derivatives),
            ("  condensing", kernels.condensing),
            ("  block elimination", kernels.elimination),
            ("  solves", kernels.solves),
        ] {
            row(name, seconds, Some(calls), Some(intervals));
        }
        row("  prediction, errors, neck", rest, None, None);
        let mut phase = |name: &str, Phase { times, seconds }: Phase| row(name, seconds, Some(times), None);
        phase("meshes", meshes);
        phase("looks for shapes at rest", rest_checks);
        phase("observers", observers);
        row("everything else", other.seconds, None, None);
        row("whole", self.sum.seconds, None, None);
    }

    fn slow_divisions(&self, out: &mut String) {
        let (unit, scale) = self.unit();
        // Scenarios may have long names.
        let wide = self.slowest.iter().map(|one| one.name.chars().count()).fold(NAME, usize::max);
        let _ = writeln!(
            out,
            "\n{:wide$} {unit:>9} {:>6} {:>8} {:>10} {:>14} {:>9}  outcome",
            "slowest", "%", "steps", "iterations", "factorisations", "intervals"
        );
        for one in &self.slowest {
            let share = if self.sum.seconds > 0.0 { 100.0 * one.seconds / self.sum.seconds } else { 0.0 };
            let _ = writeln!(
                out,
                "{:wide$} {:9.2} {share:6.1} {:8} {:10} {:14} {:9.1}  {}",
                one.name,
                scale * one.seconds,
                one.work.steps,
                one.work.iterations,
                one.work.factorisations,
                one.intervals.mean(),
                outcome_name(one.outcome)
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::Profiles;
    use crate::cell::Cell;
    use crate::division::DivisionInput;

    fn report(divisions: usize, seconds: f64) -> ProfileReport {
        let steps = Stepping { times: 7, seconds: 0.5 * seconds, rest: -1e-18, ..Stepping::default() };
        let phases = Phases { steps, ..Phases::default() };
        let sum = Profile { divisions, seconds, phases, ..Profile::default() };
        ProfileReport { sum, slowest: Vec::new() }
    }

    /// The line of a row, without its name.
    fn row<'a>(text: &'a str, name: &str) -> Vec<&'a str> {
        let line = text.lines().find_map(|line| line.strip_prefix(name)).unwrap();
        line.split_whitespace().collect()
    }

    #[test]
    fn times_have_the_unit_that_suits_them_and_shares_of_the_whole() {
        let (short, long) = (report(1, 0.5).text(), report(3, 20.0).text());
        assert!(short.starts_with("profile of one division\n"), "{short}");
        assert_eq!(row(&short, "phase"), ["ms", "%", "times", "intervals"]);
        assert_eq!(row(&short, "other steps"), ["250.00", "50.0", "7"]);
        assert_eq!(row(&short, "  prediction, errors, neck"), ["0.00", "0.0"], "no -0.0");
        assert_eq!(row(&long, "phase")[0], "s");
        assert_eq!(row(&long, "whole"), ["20.00", "100.0"]);
        assert!(long.starts_with("profile of 3 divisions that were computed\n") && long.contains("\nslowest "));
        assert!(!short.contains("slowest"));
    }

    #[test]
    fn without_divisions_or_without_a_clock_nothing_is_divided_by_nothing() {
        assert_eq!(report(0, 0.0).text(), "profile: no division was computed\n");
        let profiles = Profiles::new(None);
        for r0 in [1.6, 2.5] {
            profiles.divide(&DivisionInput::new(Cell::new(r0))).unwrap();
        }
        let report = ProfileReport::new(profiles.taken(), |one| format!("R0 = {}", one.input.cell.r0));
        let text = report.text();
        assert_eq!(row(&text, "whole"), ["0.00", "0.0"]);
        assert!(!text.contains("NaN"), "{text}");
        assert_eq!(row(&text, "R0 = 2.5").last(), Some(&"symmetric"));
        assert_eq!(row(&text, "  condensing")[3], report.sum.phases.steps.kernels.condensing.intervals.to_string());
        assert_eq!(serde_json::to_value(&report).unwrap()["slowest"][0]["name"], "R0 = 2.5");
    }
}
