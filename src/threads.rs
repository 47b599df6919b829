//! Shares work among several threads, where there is more than one and it is worth it.
//!
//! Systems that share work are not `Send`, so that they run on the main thread. Otherwise they would take a thread of the pool, and
//! the main thread would only wait: Bevy does not let it work for the pool while a schedule runs. On two cores the pool has one
//! thread, and nothing would be shared. Pinned by the benchmark `frame/flying cars`.

use bevy::tasks::ComputeTaskPool;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{LazyLock, Mutex, PoisonError};
use std::thread::available_parallelism;

/// Number of processor cores. More threads than cores would only wait for each other.
static CORES: LazyLock<usize> =
    LazyLock::new(|| available_parallelism().map_or(1, NonZeroUsize::get));

/// Number of elements or bodies of a large network in one piece of work. Such a piece takes about twenty times as long
/// as waking a thread. Pinned by the benchmark `own/Lattice`.
pub(crate) const PIECE: usize = 4096;

/// Number of pieces of work per thread where the number of threads decides how work is cut. With several pieces, a thread that is
/// done early can take work from others.
pub(crate) const PER_THREAD: usize = 4;

/// Number of threads that share work.
pub(crate) fn count() -> usize {
    #[cfg(test)]
    if ALONE.get() {
        return 1;
    }
    // The main thread works too.
    let pool = ComputeTaskPool::try_get().map_or(0, |pool| pool.thread_num());
    (*CORES).min(pool + 1)
}

/// Calls `work` on each piece, on all threads if there is more than one piece. This wakes other threads and makes a few
/// allocations, so cut the work into pieces only where that is worth it.
pub(crate) fn share<T: Send>(
    pieces: impl ExactSizeIterator<Item = T> + Send,
    work: impl Fn(T) + Sync,
) {
    beside(|| {}, pieces, work);
}

/// Calls `work` on each value, with the index of the value. Many values are shared among threads.
pub(crate) fn each<T: Send>(all: &mut [T], work: impl Fn(usize, &mut T) + Sync) {
    share(all.chunks_mut(PIECE).enumerate(), |(piece, values)| {
        for (at, value) in values.iter_mut().enumerate() {
            work(piece * PIECE + at, value);
        }
    });
}

/// Makes `to` a copy of `from`.
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

/// Whether `is_so` holds for all pieces.
pub(crate) fn all<T: Send>(
    pieces: impl ExactSizeIterator<Item = T> + Send,
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

/// Calls `first` on this thread and `work` on each piece: at the same time if there are several pieces and threads.
pub(crate) fn beside<T: Send>(
    first: impl FnOnce(),
    pieces: impl ExactSizeIterator<Item = T> + Send,
    work: impl Fn(T) + Sync,
) {
    let helpers = count().min(pieces.len()).saturating_sub(1);
    if helpers == 0 {
        first();
        pieces.for_each(work);
        return;
    }
    let pieces = Mutex::new(pieces);
    // The lock is free again before the work on a piece begins.
    let next = || pieces.lock().unwrap_or_else(PoisonError::into_inner).next();
    let mut first = Some(first);
    on_threads(
        helpers,
        &mut || {
            if let Some(first) = first.take() {
                first();
            }
        },
        &|| std::iter::from_fn(next).for_each(&work),
    );
}

/// Calls `first` and then `work` on this thread, and `work` on other threads as well, once for each of `helpers`.
///
/// It is not generic on purpose: the scope of a task pool is much code, and there would be a copy of it for each kind of work.
fn on_threads(helpers: usize, first: &mut dyn FnMut(), work: &(dyn Fn() + Sync)) {
    ComputeTaskPool::get().scope(|scope| {
        for _ in 0..helpers {
            scope.spawn(async move { work() });
        }
        first();
        work();
    });
}

#[cfg(test)]
thread_local! {
    static ALONE: std::cell::Cell<bool> = const { std::cell::Cell::new(false) };
}

/// Calls `work` such that everything in it runs on this thread.
#[cfg(test)]
pub(crate) fn alone<T>(work: impl FnOnce() -> T) -> T {
    ALONE.set(true);
    let done = work();
    ALONE.set(false);
    done
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::tasks::TaskPoolBuilder;
    use std::sync::atomic::AtomicUsize;

    const MANY: usize = 3 * PIECE + 5;

    fn several_threads() {
        ComputeTaskPool::get_or_init(|| TaskPoolBuilder::new().num_threads(3).build());
    }

    #[test]
    fn each_value_is_met_once_and_at_its_place() {
        several_threads();
        for count in [0, 1, PIECE, PIECE + 1, MANY] {
            let mut met = vec![0; count];
            each(&mut met, |at, met| *met += at + 1);
            assert!(met.iter().copied().eq(1..=count));
        }
    }

    #[test]
    fn a_copy_is_the_same_whatever_was_there() {
        several_threads();
        let from: Vec<usize> = (0..MANY).collect();
        for was in [vec![], vec![7; MANY], vec![7; MANY + 1]] {
            let mut to = was;
            copy(&mut to, &from);
            assert_eq!(to, from);
        }
    }

    #[test]
    fn one_piece_of_which_it_is_not_so_decides() {
        several_threads();
        let values: Vec<usize> = (0..MANY).collect();
        let below = |limit: usize| {
            let pieces = values.chunks(PIECE);
            all(pieces, |piece| piece.iter().all(|value| *value < limit))
        };
        assert!(below(MANY));
        assert!(!below(MANY - 1));
        assert!(!below(0));
    }

    #[test]
    fn what_goes_beside_other_work_is_done_once() {
        several_threads();
        for count in [0, 1, 9] {
            let (mut first, done) = (0, AtomicUsize::new(0));
            let work = |piece: usize| {
                done.fetch_add(piece, Ordering::Relaxed);
            };
            beside(|| first += 1, (0..count).map(|piece| piece + 1), work);
            assert_eq!((first, done.into_inner()), (1, count * (count + 1) / 2));
        }
    }
}
