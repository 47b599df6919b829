//! Shares work among several threads, where there is more than one and it is worth it.
//!
//! Systems that share work are not `Send`, so that they run on the main thread. Otherwise they would take a thread of the pool, and
//! the main thread would only wait: Bevy does not let it work for the pool while a schedule runs. On two cores the pool has one
//! thread, and nothing would be shared. Pinned by the benchmark `frame/flying cars`.

use bevy::tasks::ComputeTaskPool;
use bevy::tasks::futures_lite::future::yield_now;
use std::cell::RefCell;
use std::hint::spin_loop;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, LazyLock, Mutex, PoisonError};
use std::thread::{self, ThreadId, available_parallelism};

/// Number of processor cores. More threads than cores would only wait for each other.
static CORES: LazyLock<usize> =
    LazyLock::new(|| available_parallelism().map_or(1, NonZeroUsize::get));

/// Number of elements or bodies of a large network in one piece of work. It takes about 20 µs. Pinned by the benchmarks `own/Chain`
/// and `own/Cloth`.
pub(crate) const PIECE: usize = 1024;

/// Number of pieces of that length from which on threads share them. Fewer take no longer than it takes to share them. Pinned by the
/// benchmarks `own/Chain` and `own/Cloth`.
const FEW: usize = 3;

/// Number of times that a thread looks for work, or for the end of others' work, before it does something else: about 30 µs. Pinned
/// by the benchmarks `own/Chain` and `own/Cloth`.
const LOOKS: usize = 1000;

/// Whether Bevy's pools have threads at all. If not, a task that waits would block everything.
const HAS_THREADS: bool = bevy::tasks::cfg::multi_threaded!();

/// Number of pieces of work per thread where the number of threads decides how work is cut. With several pieces, a thread that is
/// done early can take work from others. Pinned by the benchmark `own/isolated`.
pub(crate) const PER_THREAD: usize = 4;

/// Number of threads that share work.
pub(crate) fn count() -> usize {
    #[cfg(test)]
    if ALONE.get() {
        return 1;
    }
    if !HAS_THREADS {
        return 1;
    }
    // The main thread works too.
    let pool = ComputeTaskPool::try_get().map_or(0, |pool| pool.thread_num());
    (*CORES).min(pool + 1)
}

/// Number of values in each piece of work, of `all` values; at least one. `is_worth_it` says whether threads are to share the work.
pub(crate) fn piece_of(all: usize, is_worth_it: bool) -> usize {
    let threads = if is_worth_it { count() } else { 1 };
    if threads == 1 {
        return all.max(1);
    }
    all.div_ceil(PER_THREAD * threads).max(1)
}

/// Calls `work` on each piece, on all threads if there is more than one piece. This wakes other threads and makes a few
/// allocations, so cut the work into pieces only where that is worth it.
pub(crate) fn share<T: Send>(
    pieces: impl ExactSizeIterator<Item = T> + Send,
    work: impl Fn(T) + Sync,
) {
    together(|| {}, pieces, work);
}

/// Like [`share`], for pieces of the length [`PIECE`]. Only several of them are worth it.
pub(crate) fn share_pieces<T: Send>(
    pieces: impl ExactSizeIterator<Item = T> + Send,
    work: impl Fn(T) + Sync,
) {
    beside(|| {}, pieces, work);
}

/// Calls `work` on each value, with the index of the value. Many values are shared among threads.
pub(crate) fn each<T: Send>(all: &mut [T], work: impl Fn(usize, &mut T) + Sync) {
    share_pieces(all.chunks_mut(PIECE).enumerate(), |(piece, values)| {
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
    share_pieces(
        to.chunks_mut(PIECE).zip(from.chunks(PIECE)),
        |(to, from)| {
            to.copy_from_slice(from);
        },
    );
}

/// Whether `is_so` holds for all pieces of the length [`PIECE`].
pub(crate) fn all<T: Send>(
    pieces: impl ExactSizeIterator<Item = T> + Send,
    is_so: impl Fn(T) -> bool + Sync,
) -> bool {
    let so = AtomicBool::new(true);
    share_pieces(pieces, |piece| {
        if !is_so(piece) {
            so.store(false, Ordering::Relaxed);
        }
    });
    so.into_inner()
}

/// Calls `first` on this thread and `work` on each piece of the length [`PIECE`]: at the same time if that is worth it.
pub(crate) fn beside<T: Send>(
    first: impl FnOnce(),
    pieces: impl ExactSizeIterator<Item = T> + Send,
    work: impl Fn(T) + Sync,
) {
    if pieces.len() < FEW {
        first();
        pieces.for_each(work);
    } else {
        together(first, pieces, work);
    }
}

/// Calls `first` on this thread and `work` on each piece: at the same time if there are several pieces and threads.
fn together<T: Send>(
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

/// While it lives, threads that have shared work with this one stay awake. To wake one would take as long as a small piece of work,
/// and a large network has dozens of passes in a step.
pub(crate) struct Awake;

/// What the threads of the pool do for this one between two calls.
#[derive(Default)]
enum Between {
    #[default]
    Sleep,
    /// They will stay awake after the first call.
    Stay,
    /// They wait for the number of calls to change.
    Wait(Arc<AtomicUsize>),
}

/// Number of calls that says that no other will come.
const OVER: usize = usize::MAX;

thread_local! {
    static BETWEEN: RefCell<Between> = const { RefCell::new(Between::Sleep) };
}

impl Awake {
    pub(crate) fn new() -> Self {
        BETWEEN.set(Between::Stay);
        Self
    }
}

impl Drop for Awake {
    fn drop(&mut self) {
        if let Between::Wait(calls) = BETWEEN.take() {
            calls.store(OVER, Ordering::Relaxed);
        }
    }
}

/// Tells the waiting threads that there is a new call. The first call lets `helpers` threads wait from then on.
fn call(helpers: usize) {
    BETWEEN.with_borrow_mut(|between| match between {
        Between::Sleep => {}
        Between::Stay => {
            let calls = Arc::new(AtomicUsize::new(0));
            for _ in 0..helpers {
                let task = wait(calls.clone(), thread::current().id());
                ComputeTaskPool::get().spawn(task).detach();
            }
            *between = Between::Wait(calls);
        }
        Between::Wait(calls) => {
            calls.fetch_add(1, Ordering::Relaxed);
        }
    });
}

/// Keeps the thread that runs it awake. At each call, and else now and then, it lets the thread do what else there is to do. The
/// thread that calls may run it too, while it waits for the end of a call; it does not keep that thread awake.
async fn wait(calls: Arc<AtomicUsize>, caller: ThreadId) {
    let mut seen = 0;
    loop {
        if thread::current().id() != caller {
            look_until(|| calls.load(Ordering::Relaxed) != seen);
        }
        seen = calls.load(Ordering::Relaxed);
        if seen == OVER {
            return;
        }
        yield_now().await;
    }
}

/// Looks whether `is_so`, [`LOOKS`] times at most.
fn look_until(is_so: impl Fn() -> bool) {
    for _ in 0..LOOKS {
        if is_so() {
            return;
        }
        spin_loop();
    }
}

/// Calls `first` and then `work` on this thread, and `work` on other threads as well, once for each of `helpers`.
///
/// It is not generic on purpose: the scope of a task pool is much code, and there would be a copy of it for each kind of work.
fn on_threads(helpers: usize, first: &mut dyn FnMut(), work: &(dyn Fn() + Sync)) {
    let running = &AtomicUsize::new(0);
    ComputeTaskPool::get().scope(|scope| {
        for _ in 0..helpers {
            scope.spawn(async move {
                running.fetch_add(1, Ordering::Relaxed);
                work();
                running.fetch_sub(1, Ordering::Relaxed);
            });
        }
        call(helpers);
        first();
        work();
        // The others are nearly done, too. The scope would let this thread sleep.
        look_until(|| running.load(Ordering::Relaxed) == 0);
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
    use bevy::tasks::{TaskPoolBuilder, block_on};
    use std::time::Instant;

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
    fn threads_that_stay_awake_do_other_work_too_and_sleep_in_the_end() {
        several_threads();
        if count() == 1 {
            return;
        }
        let awake = Awake::new();
        let mut met = vec![0; MANY];
        for _ in 0..100 {
            each(&mut met, |_, met| *met += 1);
        }
        assert!(met.iter().all(|met| *met == 100));
        let Between::Wait(calls) = BETWEEN.replace(Between::Stay) else {
            panic!("no thread waits");
        };
        assert_eq!(calls.load(Ordering::Relaxed), 99);
        let other = ComputeTaskPool::get().spawn(async { 7 });
        assert_eq!(block_on(other), 7);
        BETWEEN.set(Between::Wait(calls.clone()));
        drop(awake);
        let begun = Instant::now();
        while Arc::strong_count(&calls) > 1 {
            assert!(begun.elapsed().as_secs() < 60, "a thread still waits");
            thread::yield_now();
        }
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
