//! What is wrong with a run, and how panics are caught.

use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::{Mutex, MutexGuard, Once, PoisonError};

/// First panic of the present run, empty before it panics; `None` between runs. Any thread may panic, not only the one
/// that judges.
static PANIC: Mutex<Option<String>> = Mutex::new(None);

/// Starts of the places of panics that are no fault of the engine: sources of this crate, and of the attack itself.
const OURS: [&str; 2] = ["src/", "attack/"];

/// A fault of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// What sort of fault it is, or the place of a panic: the same for faults that differ only in their numbers.
    pub kind: String,
    /// What was seen.
    pub seen: String,
    /// Whether only this crate can have caused it, so that a run without this crate proves nothing.
    pub is_ours: bool,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}: {}", self.kind, self.seen)
    }
}

impl Fault {
    /// A fault that the engine may have by itself, too.
    pub(crate) fn new(kind: &str, seen: String) -> Self {
        Self {
            kind: kind.into(),
            seen,
            is_ours: false,
        }
    }

    /// A fault of something that only this crate makes.
    pub(crate) fn ours(kind: &str, seen: String) -> Self {
        Self {
            is_ours: true,
            ..Self::new(kind, seen)
        }
    }

    /// Whether the engine itself panicked, in this file.
    pub(crate) fn is_in_the_engine(&self, file: &str) -> bool {
        self.kind.contains("/rapier3d-") && self.kind.contains(file)
    }

    /// The same fault, with the time at which it was seen.
    pub(crate) fn at(self, time: &str) -> Self {
        Self {
            seen: format!("{time}: {}", self.seen),
            ..self
        }
    }

    /// The fault of a run that panicked with this message.
    fn panicked(message: String) -> Self {
        let first = message.lines().next().unwrap_or_default();
        match first.split_once("panicked at ") {
            Some((_, place)) => Self {
                kind: format!("panic at {place}"),
                is_ours: OURS.iter().any(|ours| place.starts_with(ours)),
                seen: message,
            },
            // Without its place it cannot be compared with a panic of the engine.
            None => Self::ours("panic at an unknown place", message),
        }
    }
}

fn last_panic() -> MutexGuard<'static, Option<String>> {
    PANIC.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Makes panics of a run be kept instead of printed. Others are printed as usual.
fn listen() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let usual = take_hook();
        set_hook(Box::new(move |info| match &mut *last_panic() {
            Some(first) if first.is_empty() => *first = info.to_string(),
            Some(_) => {}
            None => usual(info),
        }));
    });
}

/// Plays a run and returns its fault, if it has one.
pub(crate) fn caught(run: impl FnOnce() -> Result<(), Fault>) -> Result<(), Fault> {
    listen();
    // A panic of an earlier run must not be taken for one of this run.
    *last_panic() = Some(String::new());
    let played = catch_unwind(AssertUnwindSafe(run));
    let panic = last_panic().take().unwrap_or_default();
    played.unwrap_or_else(|_| Err(Fault::panicked(panic)))
}
