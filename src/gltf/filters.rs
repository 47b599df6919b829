//! Converts collision filters to bits. Each filter of the file gets one bit, so that every rule on sets of names
//! holds exactly.

use super::physics::{Filter, Shared};

/// Bit of the colliders without a filter: the last one.
const UNFILTERED: u32 = 31;

/// Returns memberships and filters for each filter of the file, and at the end those for colliders without a filter.
pub(super) fn groups(shared: &Shared) -> Vec<(u32, u32)> {
    let none = Filter::default();
    let filters = shared.filters.iter().map(|f| f.as_ref().unwrap_or(&none));
    let all: Vec<&Filter> = filters.chain([&none]).collect();
    let last = all.len() - 1;
    // Filters beyond the 31st share its bit. Two filters that share it touch if each may touch some filter with that
    // bit. All other pairs are exact.
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

/// Greatest number of filters for which every filter has a bit of its own.
pub(super) const MOST: usize = UNFILTERED as usize;

/// Whether the rules of filter `a` allow contact with a collider that has filter `b`. The reverse must hold too.
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
        // Index 4 stands for colliders without a filter.
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
