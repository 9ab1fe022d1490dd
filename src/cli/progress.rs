//! The progress line on stderr.

use furrow_lineage::batch::Progress;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::output::eprint;

/// Templates of the line for an unknown and for a known amount of work.
const COUNTS: &str = "{spinner} {elapsed} {msg}";
const SHARE: &str = "{spinner} {elapsed} [{bar:24}] {pos} of {len} {msg}, {eta} left";

/// Interval between plain lines if stderr is not a terminal.
const EVERY: Duration = Duration::from_secs(30);

/// A progress line, displayed only if `shown`. If stderr is not a terminal, a new line is printed every 30 s.
pub struct ProgressLine {
    bar: ProgressBar,
    /// The start time, and the time since then of the last plain line.
    plain: Option<(Instant, Mutex<Duration>)>,
}

impl ProgressLine {
    /// Starts the line.
    pub fn new(shown: bool) -> ProgressLine {
        let terminal = std::io::stderr().is_terminal();
        let plain = (shown && !terminal).then(|| (Instant::now(), Mutex::new(Duration::ZERO)));
        let shown = shown && terminal;
        let target = if shown { ProgressDrawTarget::stderr_with_hz(10) } else { ProgressDrawTarget::hidden() };
        let line = ProgressLine { bar: ProgressBar::with_draw_target(None, target), plain };
        line.set_style(COUNTS);
        if shown {
            line.bar.enable_steady_tick(Duration::from_millis(100));
        }
        line
    }

    fn set_style(&self, template: &str) {
        if let Ok(style) = ProgressStyle::with_template(template) {
            self.bar.set_style(style.progress_chars("=> "));
        }
    }

    /// Prints a plain line if one is due.
    fn say(&self, text: impl FnOnce() -> String) {
        let Some((start, last)) = &self.plain else { return };
        let (now, mut last) = (start.elapsed(), last.lock().unwrap_or_else(PoisonError::into_inner));
        if now >= *last + EVERY {
            *last = now;
            eprint(&format!("{} s: {}", now.as_secs(), text()));
        }
    }

    /// Shows the state of a run with an unknown number of divisions: the numbers solved, running and waiting.
    pub fn show(&self, progress: Progress) {
        let Progress { solved, running, queued, memo_hits } = progress;
        self.message(format!("{solved} divisions solved, {running} running, {queued} waiting, {memo_hits} memo hits"));
    }

    /// Shows the state of a run with a known number of divisions.
    pub fn show_all(&self, Progress { solved, running, queued, memo_hits }: Progress) {
        let done = solved + memo_hits;
        self.show_share(done, done + running + queued, || "divisions".to_owned());
    }

    /// Shows a message.
    pub fn message(&self, text: String) {
        if !self.bar.is_hidden() {
            return self.bar.set_message(text);
        }
        self.say(|| text);
    }

    /// Shows the number of finished and of all items, their kind, and the remaining time.
    pub fn show_share(&self, done: usize, of: usize, what: impl FnOnce() -> String) {
        if self.bar.is_hidden() {
            let percent = 100.0 * done as f64 / of.max(1) as f64;
            return self.say(|| format!("{percent:.0} %, {done} of {of} {}", what()));
        }
        self.bar.set_message(what());
        if self.bar.length() == Some(of as u64) {
            // Threads report in any order, but the estimate of the remaining time requires increasing positions.
            return self.bar.set_position(self.bar.position().max(done as u64));
        }
        self.set_style(SHARE);
        self.bar.set_length(of as u64);
        self.bar.set_position(done as u64);
    }
}

impl Drop for ProgressLine {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
