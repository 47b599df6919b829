//! Work on several threads, where there are more than one and it is worth it.

use bevy::tasks::ComputeTaskPool;
use std::num::NonZeroUsize;
use std::sync::LazyLock;
use std::thread::available_parallelism;

/// More threads than these would only wait for each other.
static CORES: LazyLock<usize> =
    LazyLock::new(|| available_parallelism().map_or(1, NonZeroUsize::get));

/// Elements or bodies of a large network that are one piece of work: it takes some twenty times as long as to wake a thread. Pinned
/// by the benchmark `own/Lattice`.
pub(crate) const PIECE: usize = 4096;

/// How many threads there are.
pub(crate) fn count() -> usize {
    #[cfg(test)]
    if ALONE.get() {
        return 1;
    }
    // The one that waits for the pool works too: on two cores the pool has just one.
    let pool = ComputeTaskPool::try_get().map_or(0, |pool| pool.thread_num());
    (*CORES).min(pool + 1)
}

/// Does some work on each of these pieces, on all threads if they are more than one: so cut pieces only where the work is worth
/// waking other threads, and the few allocations that this takes.
pub(crate) fn share<T: Send>(
    mut pieces: impl ExactSizeIterator<Item = T>,
    work: impl Fn(T) + Sync,
) {
    if pieces.len() == 1 || count() == 1 {
        pieces.by_ref().for_each(work);
        return;
    }
    let work = &work;
    ComputeTaskPool::get().scope(|scope| {
        for piece in pieces {
            scope.spawn(async move { work(piece) });
        }
    });
}

#[cfg(test)]
thread_local! {
    static ALONE: std::cell::Cell<bool> = const { std::cell::Cell::new(false) };
}

/// Does it all on this thread.
#[cfg(test)]
pub(crate) fn alone<T>(work: impl FnOnce() -> T) -> T {
    ALONE.set(true);
    let done = work();
    ALONE.set(false);
    done
}
