//! The progress line on stderr.

use furrow_lineage::batch::Progress;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::time::Duration;

/// The line while the amount of work is not known, and once it is.
const COUNTS: &str = "{spinner} {elapsed} {msg}";
const SHARE: &str = "{spinner} {elapsed} [{bar:24}] {pos} of {len} {msg}, {eta} left";

/// A line that shows how far a run has come; only where `shown`.
pub struct ProgressLine {
    bar: ProgressBar,
}

impl ProgressLine {
    /// Starts the line.
    pub fn new(shown: bool) -> ProgressLine {
        let target = if shown { ProgressDrawTarget::stderr_with_hz(10) } else { ProgressDrawTarget::hidden() };
        let line = ProgressLine { bar: ProgressBar::with_draw_target(None, target) };
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

    /// Shows where a run stands whose number of divisions is not known: it shows those solved, running and waiting.
    pub fn show(&self, progress: Progress) {
        let Progress { solved, running, queued, memo_hits } = progress;
        self.message(format!("{solved} divisions solved, {running} running, {queued} waiting, {memo_hits} memo hits"));
    }

    /// Shows where a run stands that knows all its divisions from the start.
    pub fn show_all(&self, Progress { solved, running, queued, memo_hits }: Progress) {
        let done = solved + memo_hits;
        self.show_share(done, done + running + queued, || "divisions".to_owned());
    }

    /// Shows a message.
    pub fn message(&self, text: String) {
        if !self.bar.is_hidden() {
            self.bar.set_message(text);
        }
    }

    /// Shows how many of all are done, what they are, and when the rest will be.
    pub fn show_share(&self, done: usize, of: usize, what: impl FnOnce() -> String) {
        if self.bar.is_hidden() {
            return;
        }
        self.bar.set_message(what());
        if self.bar.length() == Some(of as u64) {
            // Threads report in any order, and the time left follows from positions that rise.
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
