//! Messages of -v: the settings of a command, its divisions, and the work at its end.

use std::cell::Cell;
use std::fmt::Write;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use furrow_input::rounded_number;
use furrow_lineage::batch::{Key, Memo, Noted};
use furrow_mechanics::division::Division;

use super::context::{Context, Globals};
use super::messages::{self, Level};

/// Divisions that were solved, that could not be solved, that were known in memory, and that came from the cache.
static COUNTS: [AtomicUsize; 4] = [const { AtomicUsize::new(0) }; 4];

/// The cache of the command, if it looks divisions up.
static CACHE: OnceLock<String> = OnceLock::new();

thread_local! {
    /// When the solver of this thread began.
    static BEGUN: Cell<Option<Instant>> = const { Cell::new(None) };
}

/// Prints the settings of a command.
pub fn settings(context: &Context) {
    if !messages::is_printed(Level::Info) {
        return;
    }
    let Globals { preset, config, law, set, .. } = &context.globals;
    let files = [("--config", config), ("--law", law)];
    let mut given: Vec<String> =
        files.iter().filter_map(|(name, file)| Some(format!("{name} {:?}", file.as_ref()?))).collect();
    given.extend(set.iter().map(|entry| format!("--set {entry}")));
    let given = if given.is_empty() { String::new() } else { format!(" with {}", given.join(" ")) };
    let (cell, numerics) = (&context.settings.cell, &context.settings.numerics);
    messages::write(
        Level::Info,
        format_args!(
            "settings: preset {preset}{given}: ε = {}, ξ_s = {}, {} intervals; {} threads",
            cell.epsilon,
            cell.xi_s,
            numerics.intervals,
            furrow_lineage::batch::scheduler::workers(context.threads)
        ),
    );
}

/// The memo, which reports its divisions if -v is given. `cache` is the folder of its store.
pub fn watched(memo: Memo, cache: Option<&std::path::Path>) -> Memo {
    if !messages::is_printed(Level::Info) {
        return memo;
    }
    let cache =
        CACHE.get_or_init(|| cache.map_or("no cache".to_owned(), |folder| format!("cache {}", folder.display())));
    messages::write(Level::Debug, format_args!("{cache}"));
    memo.observed_by(note)
}

fn note(key: &Key, noted: Noted<'_>) {
    let which = match noted {
        Noted::Begun => return BEGUN.set(Some(Instant::now())),
        Noted::Solved(..) => 0,
        Noted::Failed(_) => 1,
        Noted::Awaited => 2,
        Noted::Known { stored, .. } => 2 + usize::from(stored),
    };
    COUNTS[which].fetch_add(1, Ordering::Relaxed);
    if messages::is_printed(Level::Debug) {
        tell(key, noted);
    }
}

/// Prints the result of a requested division.
fn tell(key: &Key, noted: Noted<'_>) {
    let key: String = key.as_bytes()[..6].iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    });
    let seconds = || BEGUN.take().map_or(0.0, |begun| begun.elapsed().as_secs_f64());
    let text = match noted {
        Noted::Begun => return,
        Noted::Awaited => "is being solved already".to_owned(),
        Noted::Known { division, stored } => {
            format!("{} {}", if stored { "from the cache:" } else { "known:" }, found(division))
        }
        Noted::Solved(input, division) => {
            let (r0, steps) = (rounded_number(input.cell.r0, 7), division.work.steps);
            format!("R0 = {r0}, cue {}: {}, {steps} steps, {:.3} s", input.cell.cue, found(division), seconds())
        }
        Noted::Failed(input) => {
            format!("R0 = {}: not solved, {:.3} s", rounded_number(input.cell.r0, 7), seconds())
        }
    };
    messages::write(Level::Debug, format_args!("division {key} {text}"));
}

/// The outcome of a division.
fn found(division: &Division) -> String {
    let chi = division.chi().map_or(String::new(), |chi| format!(", χ = {chi:.4}"));
    format!("{}{chi}", division.outcome())
}

/// Prints the time since the start of the command and the number of divisions.
pub fn report(start: Instant) {
    let seconds = start.elapsed().as_secs_f64();
    let Some(cache) = CACHE.get() else {
        return messages::write(Level::Info, format_args!("done in {seconds:.2} s"));
    };
    let [solved, failed, known, stored] = [0, 1, 2, 3].map(|which: usize| COUNTS[which].load(Ordering::Relaxed));
    let failed = if failed > 0 { format!(", {failed} not solved") } else { String::new() };
    messages::write(
        Level::Info,
        format_args!(
            "done in {seconds:.2} s: {solved} divisions solved{failed}, {} reused, {stored} of them from the cache; {cache}",
            known + stored
        ),
    );
}
