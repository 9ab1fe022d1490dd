//! The progress line on stderr.

use furrow_lineage::batch::Progress;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::time::Duration;

/// A line that shows divisions solved, running and waiting, and memo hits; only where `shown`.
pub struct ProgressLine {
    bar: ProgressBar,
}

impl ProgressLine {
    /// Starts the line.
    pub fn new(shown: bool) -> ProgressLine {
        let target = if shown { ProgressDrawTarget::stderr_with_hz(10) } else { ProgressDrawTarget::hidden() };
        let bar = ProgressBar::with_draw_target(None, target);
        if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed} {msg}") {
            bar.set_style(style);
        }
        if shown {
            bar.enable_steady_tick(Duration::from_millis(100));
        }
        ProgressLine { bar }
    }

    /// Shows where the run stands.
    pub fn show(&self, progress: Progress) {
        let Progress { solved, running, queued, memo_hits } = progress;
        self.message(format!("{solved} divisions solved, {running} running, {queued} waiting, {memo_hits} memo hits"));
    }

    /// Shows a message.
    pub fn message(&self, text: String) {
        if !self.bar.is_hidden() {
            self.bar.set_message(text);
        }
    }

    /// Shows how many of all are done, and when the rest will be.
    pub fn show_share(&self, done: usize, of: usize) {
        if self.bar.is_hidden() {
            return;
        }
        if self.bar.length() != Some(of as u64) {
            self.bar.set_length(of as u64);
            if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed} {pos} of {len} done, {eta} left") {
                self.bar.set_style(style);
            }
        }
        self.bar.set_position(done as u64);
    }
}

impl Drop for ProgressLine {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
