//! What a long run costs: time per tick and memory, in each tenth of it.

use std::fs;
use std::time::Instant;

/// Ticks of a run whose costs are worth telling: an hour.
const LONG: u32 = 60 * 60 * 60;

/// Memory by which the program may grow after the first tenth of a run, KB. The engine keeps some of each body that is despawned,
/// with or without springs (see docs/limits.md): of the showcase, which restarts 2 880 times in a day, 1 MB.
const GROWTH: i64 = 2048;

/// Costs of a run up to now.
pub struct Toll {
    ticks: u32,
    began: Instant,
    /// Memory after the first tenth, KB, where the system tells it.
    first: Option<i64>,
}

impl Toll {
    /// Begins a run of so many ticks.
    pub fn of(ticks: u32) -> Self {
        Self {
            ticks,
            began: Instant::now(),
            first: None,
        }
    }

    /// Prints the costs of each tenth of a long run. Returns whether the memory has not grown. To be called after each tick.
    pub fn tell(&mut self, tick: u32) -> bool {
        let tenth = self.ticks / 10;
        if self.ticks < LONG || tick == 0 || !tick.is_multiple_of(tenth) {
            return true;
        }
        let micros = self.began.elapsed().as_secs_f64() / f64::from(tenth) * 1e6;
        self.began = Instant::now();
        let hours = f64::from(tick) / f64::from(LONG);
        let Some(resident) = resident() else {
            println!("  {hours:.1} h: {micros:.1} us a tick");
            return true;
        };
        let grown = resident - *self.first.get_or_insert(resident);
        println!("  {hours:.1} h: {micros:.1} us a tick, {resident} KB, {grown:+} KB");
        grown <= GROWTH
    }
}

/// Memory of this program that is not swapped out, KB. Only Linux tells it this way.
fn resident() -> Option<i64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmRSS:"))?;
    line.split_whitespace().nth(1)?.parse().ok()
}
