//! Shows the progress of a film and its remaining time.

use indicatif::{ProgressBar, ProgressStyle};
use std::path::Path;
use std::time::{Duration, Instant};

/// Number of pictures between two printed lines where no progress bar is shown.
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

    /// Counts one more written picture.
    pub fn taken(&self, path: &Path) {
        self.bar.inc(1);
        let (done, all) = (self.bar.position(), self.bar.length().unwrap_or(0));
        if done == 1 {
            // The first picture has waited for shaders. The others need not.
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
