//! Measures the time per step so that methods can be compared.
//!
//! All settings of a race run in turns, so that other load on the machine affects all of them alike. Each turn is a
//! batch of whole updates of the app, and the turns are spread over the scene, because a step may take longer where the motion
//! is hard. The result is the mean over the turns, with quartiles. A setting whose mean is well above its shortest turn gets more
//! turns: it was disturbed, or its steps differ. A turn in which the thread had to wait for a core is repeated, where the system
//! reports such waits.

use crate::method::Setting;
use crate::problem::Problem;
use crate::rig::Rig;
use std::time::Instant;

/// Number of updates before timing starts.
const WARM_UP: u32 = 10;
/// Approximate length of a turn, s.
const TURN: f64 = 1.5e-3;
/// Value of [`Track::spread`] in races, s: enough for three seconds at 60 steps a second where a step takes up to 3 ms.
const SPREAD: f64 = 0.5;
/// Simulated time after which a scene restarts, s: the time per step of a scene at rest says little.
const LONGEST: f64 = 10.0;

/// Time per step, s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Times {
    pub mean: f64,
    /// First quartile.
    pub low: f64,
    /// Third quartile.
    pub high: f64,
}

/// Ratio of the mean to the shortest turn above which a setting gets more turns.
const DISTURBED: f64 = 1.2;
/// Most turns of a disturbed setting, as a multiple of the requested number.
const MORE: usize = 4;

/// Share of a turn that the thread may spend waiting for a core. A turn with a larger share is repeated.
const WAIT: f64 = 0.02;
/// Most attempts per turn.
const TRIES: u32 = 8;

/// What a race times, and how.
pub struct Track<'a> {
    pub make: &'a dyn Fn(Setting) -> Rig,
    /// Number of updates before timing starts.
    pub warm_up: u32,
    /// Simulated time after which the scene restarts, s.
    pub longest: f64,
    /// Approximate computing time over which the turns of a setting are spread, if the scene does not restart before, s.
    pub spread: f64,
}

impl Track<'_> {
    fn warm(&self, setting: Setting) -> Rig {
        let mut rig = (self.make)(setting);
        (0..self.warm_up).for_each(|_| rig.tick());
        rig
    }
}

struct Runner {
    rig: Rig,
    setting: Setting,
    /// Number of updates in a turn, and without timing between two turns.
    batch: u32,
    idle: u32,
    /// Number of updates since the scene started.
    ticks: u32,
    turns: Vec<f64>,
}

/// Times the settings of a problem in turns, at least `turns` for each.
pub fn race(problem: &Problem, settings: &[Setting], turns: u32) -> Vec<Times> {
    let track = Track {
        make: &|setting| Rig::new(problem, setting),
        warm_up: WARM_UP,
        longest: problem.seconds.clamp(3.0, LONGEST),
        spread: SPREAD,
    };
    race_on(&track, settings, turns)
}

/// Times settings in turns, like [`race`], but on any [`Track`].
pub fn race_on(track: &Track, settings: &[Setting], turns: u32) -> Vec<Times> {
    let longest = track.longest;
    let mut runners: Vec<Runner> = settings
        .iter()
        .map(|setting| {
            let mut rig = track.warm(*setting);
            let start = Instant::now();
            (0..3).for_each(|_| rig.tick());
            let once = start.elapsed().as_secs_f64() / 3.0;
            let most = (longest / setting.dt()) as u32 - track.warm_up;
            let batch = ((TURN / once).ceil() as u32).clamp(1, most);
            Runner {
                rig,
                setting: *setting,
                batch,
                idle: (most.min((track.spread / once) as u32) / turns).saturating_sub(batch),
                ticks: track.warm_up + 3,
                turns: Vec::new(),
            }
        })
        .collect();
    for turn in 0..MORE * turns as usize {
        let needed = |r: &Runner| turn < turns as usize || r.is_disturbed();
        // The order rotates with each turn, so that no setting is always the first.
        let count = runners.len();
        for i in 0..count {
            let runner = &mut runners[(i + turn) % count];
            if !needed(runner) {
                continue;
            }
            if f64::from(runner.ticks + runner.batch) * runner.setting.dt() > longest {
                runner.rig = track.warm(runner.setting);
                runner.ticks = track.warm_up;
            }
            let mut tick = || {
                runner.rig.tick();
                runner.ticks += 1;
            };
            let each = turn_of(runner.batch, &mut tick);
            (0..runner.idle).for_each(|_| tick());
            runner.turns.push(each);
        }
    }
    runners.into_iter().map(|r| Times::of(r.turns)).collect()
}

impl Runner {
    fn is_disturbed(&self) -> bool {
        let shortest = self.turns.iter().copied().fold(f64::INFINITY, f64::min);
        mean(&self.turns) > DISTURBED * shortest
    }
}

/// Mean time of one update over a batch, s. Repeats a batch during which the thread waited for a core, up to
/// [`TRIES`] times in all, and returns the batch with the smallest share of waiting.
pub fn turn_of(updates: u32, mut update: impl FnMut()) -> f64 {
    let (mut best, mut least) = (f64::NAN, f64::INFINITY);
    for _ in 0..TRIES {
        let before = waiting();
        let start = Instant::now();
        (0..updates).for_each(|_| update());
        let turn = start.elapsed().as_secs_f64();
        let share = match (before, waiting()) {
            (Some(before), Some(after)) => (after - before) / turn,
            _ => 0.0,
        };
        if share < least {
            (best, least) = (turn / f64::from(updates), share);
        }
        if share < WAIT {
            break;
        }
    }
    best
}

fn mean(turns: &[f64]) -> f64 {
    turns.iter().sum::<f64>() / turns.len() as f64
}

/// Total time that this thread has waited for a core, s. `None` where the system does not report it.
fn waiting() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: f64 = text.split_whitespace().nth(1)?.parse().ok()?;
    Some(1e-9 * nanoseconds)
}

impl Times {
    /// Mean and quartiles of at least one turn.
    pub fn of(mut turns: Vec<f64>) -> Self {
        turns.sort_by(f64::total_cmp);
        let at = |share: f64| {
            let last = turns.len().saturating_sub(1);
            turns
                .get((share * last as f64).round() as usize)
                .copied()
                .unwrap_or(f64::NAN)
        };
        Self {
            mean: mean(&turns),
            low: at(0.25),
            high: at(0.75),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Times;

    #[test]
    fn mean_and_quartiles() {
        let times = Times::of(vec![10.0, 1.0, 3.0, 2.0, 4.0]);
        assert_eq!([times.low, times.mean, times.high], [2.0, 4.0, 4.0]);
    }
}
