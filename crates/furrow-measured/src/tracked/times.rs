//! Units of times in the files of tracking programs.

use furrow_input::table::{NamedUnit, TIMES, unit_of, units_listed};

use super::TimeUnit;

/// Further units of time, beside the units of tables; each in minutes, except for frames.
const MORE_TIMES: [NamedUnit<TimeUnit>; 3] = [
    NamedUnit {
        kind: TimeUnit::Minutes,
        size: 1.0 / 60_000.0,
        words: &["ms", "msec", "msecs", "millisecond", "milliseconds"],
    },
    NamedUnit { kind: TimeUnit::Minutes, size: 1440.0, words: &["d", "day", "days"] },
    NamedUnit { kind: TimeUnit::Frames, size: 1.0, words: &["frame", "frames", "timepoint", "timepoints"] },
];

/// The length of a unit of time, which may be in brackets, in minutes or frames.
pub(super) fn time_unit(text: &str) -> Option<(f64, TimeUnit)> {
    let text = text.trim().trim_matches(['(', ')', '[', ']']);
    let of_tables = unit_of(text, &TIMES).map(|unit| (unit.size, TimeUnit::Minutes));
    of_tables.or_else(|| unit_of(text, &MORE_TIMES).map(|unit| (unit.size, unit.kind)))
}

/// The minutes in a unit of time; `None` for frames and for other texts.
pub(super) fn minutes_in(text: &str) -> Option<f64> {
    time_unit(text).filter(|(_, kind)| *kind == TimeUnit::Minutes).map(|(size, _)| size)
}

/// The units of time, for an error.
pub(super) fn times_listed() -> String {
    format!("{}, {}", units_listed(&TIMES), units_listed(&MORE_TIMES))
}
