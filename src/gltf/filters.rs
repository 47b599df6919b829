//! Collision filters as bits: one for each filter of the file, so that any rule on sets of names holds exactly.

use super::physics::{Filter, Shared};

/// The last bit is that of colliders without a filter.
const UNFILTERED: u32 = 31;

/// Memberships and filters for each filter of a file, and last for colliders without one.
pub(super) fn groups(shared: &Shared) -> Vec<(u32, u32)> {
    let none = Filter::default();
    let filters = shared.filters.iter().map(|f| f.as_ref().unwrap_or(&none));
    let all: Vec<&Filter> = filters.chain([&none]).collect();
    let last = all.len() - 1;
    // Filters beyond the last bit share it, and collide as if they were the first that has it.
    let bit = |i: usize| {
        if i == last {
            UNFILTERED
        } else {
            (i as u32).min(UNFILTERED - 1)
        }
    };
    let collide = |a: &Filter, b: &Filter| accepts(a, b) && accepts(b, a);
    let mask = |a: &Filter| {
        let with = all.iter().enumerate().filter(|(_, b)| collide(a, b));
        with.fold(0, |mask, (i, _)| mask | 1 << bit(i))
    };
    let groups = all.iter().enumerate();
    groups.map(|(i, a)| (1 << bit(i), mask(a))).collect()
}

/// How many filters a file can have before they mix.
pub(super) const MOST: usize = UNFILTERED as usize;

/// Whether what is in `b`'s systems may touch `a`.
fn accepts(a: &Filter, b: &Filter) -> bool {
    if let Some(only) = &a.only {
        return !b.systems.is_empty() && b.systems.iter().all(|system| only.contains(system));
    }
    let never = a.never.iter().flatten();
    let never: Vec<_> = never.collect();
    b.systems.is_empty() || !b.systems.iter().all(|system| never.contains(&system))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn filter(systems: &[&str], only: Option<&[&str]>, never: Option<&[&str]>) -> Option<Filter> {
        let list = |names: &[&str]| names.iter().map(|n| (*n).to_owned()).collect();
        Some(Filter {
            systems: list(systems),
            only: only.map(list),
            never: never.map(list),
        })
    }

    #[test]
    fn who_touches_whom() {
        let shared = Shared {
            filters: vec![
                filter(&["ghost"], Some(&["ghost"]), None),
                filter(&["wall"], None, Some(&["ghost"])),
                filter(&["ghost", "wall"], None, None),
                filter(&[], None, Some(&["wall"])),
            ],
            ..Default::default()
        };
        let groups = groups(&shared);
        let touch = |a: usize, b: usize| {
            let (a, b) = (groups[a], groups[b]);
            a.0 & b.1 != 0 && b.0 & a.1 != 0
        };
        // The last is that of colliders without a filter.
        let wanted = [
            (0, 0, true),
            (0, 1, false),
            (0, 2, false),
            (0, 3, false),
            (0, 4, false),
            (1, 1, true),
            (1, 2, true),
            (1, 3, false),
            (1, 4, true),
            (2, 2, true),
            (2, 3, true),
            (3, 3, true),
            (3, 4, true),
            (4, 4, true),
        ];
        for (a, b, wanted) in wanted {
            assert_eq!(touch(a, b), wanted, "{a} and {b}");
            assert_eq!(touch(b, a), wanted, "{b} and {a}");
        }
    }

    #[test]
    fn forty_filters_do_not_overflow() {
        let shared = Shared {
            filters: vec![filter(&["x"], None, None); 40],
            ..Default::default()
        };
        assert_eq!(groups(&shared).len(), 41);
    }
}
