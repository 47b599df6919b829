//! Work on several threads, where there are more than one and it is worth it.

use bevy::tasks::ComputeTaskPool;
use std::num::NonZeroUsize;
use std::sync::LazyLock;
use std::sync::atomic::{AtomicBool, Ordering};
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

/// Does some work on each of these, which many threads share where they are many; it is told the place of each.
pub(crate) fn each<T: Send>(all: &mut [T], work: impl Fn(usize, &mut T) + Sync) {
    share(all.chunks_mut(PIECE).enumerate(), |(piece, values)| {
        for (at, value) in values.iter_mut().enumerate() {
            work(piece * PIECE + at, value);
        }
    });
}

/// Makes one a copy of the other.
pub(crate) fn copy<T: Copy + Send + Sync>(to: &mut Vec<T>, from: &[T]) {
    if to.len() != from.len() {
        to.clear();
        to.extend_from_slice(from);
        return;
    }
    share(
        to.chunks_mut(PIECE).zip(from.chunks(PIECE)),
        |(to, from)| {
            to.copy_from_slice(from);
        },
    );
}

/// Whether this is so of all these pieces.
pub(crate) fn all<T: Send>(
    pieces: impl ExactSizeIterator<Item = T>,
    is_so: impl Fn(T) -> bool + Sync,
) -> bool {
    let so = AtomicBool::new(true);
    share(pieces, |piece| {
        if !is_so(piece) {
            so.store(false, Ordering::Relaxed);
        }
    });
    so.into_inner()
}

/// Does the first work on this thread, and the other on these pieces: at the same time if they are more than one.
pub(crate) fn beside<T: Send>(
    first: impl FnOnce(),
    mut pieces: impl ExactSizeIterator<Item = T>,
    work: impl Fn(T) + Sync,
) {
    if pieces.len() <= 1 || count() == 1 {
        first();
        pieces.by_ref().for_each(work);
        return;
    }
    let work = &work;
    ComputeTaskPool::get().scope(|scope| {
        for piece in pieces {
            scope.spawn(async move { work(piece) });
        }
        first();
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
