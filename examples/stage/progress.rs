//! How far a film is, and how long the rest of it takes.

use indicatif::{ProgressBar, ProgressStyle};
use std::path::Path;
use std::time::{Duration, Instant};

/// Where nobody watches a bar, a line is written so often.
const QUIET: u64 = 12;

pub struct Progress {
    bar: ProgressBar,
    begun: Instant,
}

impl Progress {
    pub fn new(pictures: u32) -> Self {
        let bar = ProgressBar::new(pictures.into());
        let style = "  [{bar:32}] {pos} of {len} pictures, {eta} left; {msg}";
        if let Ok(style) = ProgressStyle::with_template(style) {
            bar.set_style(style.progress_chars("=> "));
        }
        bar.set_message("Ctrl-C keeps those that are done");
        bar.enable_steady_tick(Duration::from_millis(250));
        Self {
            bar,
            begun: Instant::now(),
        }
    }

    /// One more is written.
    pub fn taken(&self, path: &Path) {
        self.bar.inc(1);
        let (done, all) = (self.bar.position(), self.bar.length().unwrap_or(0));
        if done == 1 {
            // The first has waited for shaders, which the others need not.
            self.bar.reset_eta();
        }
        if all > 1 && self.bar.is_hidden() && (done == 1 || done.is_multiple_of(QUIET)) {
            let seconds = self.begun.elapsed().as_secs_f32();
            println!("  {done} of {all} after {seconds:.1} s: {}", path.display());
        }
    }

    pub fn done(&self) {
        self.bar.finish_and_clear();
    }
}
