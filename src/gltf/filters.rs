//! Converts collision filters to bits. Each filter of the file gets one bit, so that every rule on sets of names
//! holds exactly. Filters that [`export_filters`](super::export_filters) wrote get the bits that they were written from.

use super::physics::{Filter, Shared};
use bevy_rapier3d::prelude::{CollisionGroups, Group};
use std::collections::{BTreeMap, BTreeSet};

/// Bit of the colliders without a filter: the last one.
const UNFILTERED: u32 = 31;

/// Bit that all filters share for which no bit is left.
const SHARED: u32 = UNFILTERED - 1;

/// Greatest number of filters for which every filter has a bit of its own.
pub(super) const MOST: usize = UNFILTERED as usize;

/// Greatest number of filters that are compared with each other to see whether their names say their bits, and of different
/// filters that share a bit. If there are more, the names do not count, and each that shares a bit may touch all of these.
/// The time grows with the square of the number: this many take milliseconds. Pinned by
/// `tests::many_filters_take_no_time_by_the_square_of_their_number`.
const MOST_COMPARED: usize = 256;

/// Returns memberships and filters for each filter of the file, and at the end those for colliders without a filter.
///
/// Filters beyond the 31st share its bit. Two filters that share it touch if each may touch some filter with that bit.
/// All other pairs are exact.
pub(super) fn groups(shared: &Shared) -> Vec<(u32, u32)> {
    let none = Filter::default();
    let filters = shared.filters.iter().map(|f| f.as_ref().unwrap_or(&none));
    let rules: Vec<Rule> = filters.map(Rule::of).collect();
    let unfiltered = Rule::of(&none);
    let (exact, crowd) = rules.split_at(rules.len().min(SHARED as usize));
    // Rules with a bit of their own, and the different ones that share a bit.
    let alone: Vec<(u32, &Rule)> = (0..)
        .zip(exact)
        .chain([(UNFILTERED, &unfiltered)])
        .collect();
    let different: BTreeSet<&Rule> = crowd.iter().collect();
    let touched = |a: &Rule| {
        let with = alone.iter().filter(|(_, b)| collide(a, b));
        with.fold(0, |mask, (bit, _)| mask | 1_u32 << *bit)
    };
    let touches_crowd = |a: &Rule| different.iter().any(|b| collide(a, b));
    let compared = different.len() <= MOST_COMPARED;
    let in_crowd = |a: &Rule| {
        let touches = !compared || touches_crowd(a);
        touched(a) | u32::from(touches) << SHARED
    };
    let masks: BTreeMap<&Rule, u32> = different.iter().map(|&a| (a, in_crowd(a))).collect();
    let own = |&(bit, a): &(u32, &Rule)| {
        let mask = touched(a) | u32::from(touches_crowd(a)) << SHARED;
        (1_u32 << bit, mask)
    };
    let mut groups: Vec<(u32, u32)> = alone[..exact.len()].iter().map(own).collect();
    groups.extend(crowd.iter().map(|a| (1_u32 << SHARED, masks[a])));
    groups.extend(alone[exact.len()..].iter().map(own));
    groups
}

/// What the name of a collision system begins with that stands for the `CollisionGroups` of Rapier.
const OF_RAPIER: &str = "rapier";

/// Returns the name of the collision system of these groups: memberships and filters in hexadecimal digits.
pub(super) fn name(groups: CollisionGroups) -> String {
    let (memberships, filters) = (groups.memberships.bits(), groups.filters.bits());
    format!("{OF_RAPIER} {memberships:08x} {filters:08x}")
}

/// Returns the groups that [`name`] made the only system of a filter from.
fn named(filter: &Filter) -> Option<CollisionGroups> {
    let [system] = &filter.systems[..] else {
        return None;
    };
    let bits = system.strip_prefix(OF_RAPIER)?.strip_prefix(' ')?;
    let (memberships, filters) = bits.split_once(' ')?;
    let group = |digits| {
        Some(Group::from_bits_retain(
            u32::from_str_radix(digits, 16).ok()?,
        ))
    };
    Some(CollisionGroups::new(group(memberships)?, group(filters)?))
}

/// Whether colliders with these groups touch in Rapier.
pub(super) fn touch(a: CollisionGroups, b: CollisionGroups) -> bool {
    a.memberships.intersects(b.filters) && b.memberships.intersects(a.filters)
}

/// Returns memberships and filters for each filter of the file, as [`groups`] does, if the names of the systems say them.
/// `None` if some name does not, or if the file was changed so that others touch than the names say. Colliders without a
/// filter get all bits, which is wrong; there must be none.
pub(super) fn named_groups(shared: &Shared) -> Option<Vec<(u32, u32)>> {
    let count = shared.filters.len();
    if count == 0 || count > MOST_COMPARED {
        return None;
    }
    let filters = shared.filters.iter().map(Option::as_ref);
    let both = filters.map(|filter| Some((Rule::of(filter?), named(filter?)?)));
    let both: Vec<(Rule, CollisionGroups)> = both.collect::<Option<_>>()?;
    let agree = |(a, of_a): &(Rule, CollisionGroups), (b, of_b): &(Rule, CollisionGroups)| {
        collide(a, b) == touch(*of_a, *of_b)
    };
    if both.iter().any(|a| both.iter().any(|b| !agree(a, b))) {
        return None;
    }
    let groups = both.iter().map(|(_, groups)| *groups);
    let groups = groups.chain([CollisionGroups::default()]);
    Some(
        groups
            .map(|g| (g.memberships.bits(), g.filters.bits()))
            .collect(),
    )
}

/// What a filter says. Names are sorted, and none is there twice, so that they are found quickly.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Rule<'a> {
    systems: Vec<&'a str>,
    /// Whether colliders touch whose systems are all in `names`. Otherwise these colliders do not touch.
    only: bool,
    names: Vec<&'a str>,
}

impl<'a> Rule<'a> {
    fn of(filter: &'a Filter) -> Self {
        let (only, names) = match (&filter.only, &filter.never) {
            (Some(only), _) => (true, sorted(only)),
            (None, Some(never)) => (false, sorted(never)),
            (None, None) => (false, Vec::new()),
        };
        Self {
            systems: sorted(&filter.systems),
            only,
            names,
        }
    }

    /// Whether the rule allows contact with a collider that has rule `other`. The reverse must hold too.
    fn accepts(&self, other: &Self) -> bool {
        let mut systems = other.systems.iter();
        // No name is there twice. So a list is not inside a shorter one, and the time depends on the shorter list.
        let inside = !other.systems.is_empty()
            && other.systems.len() <= self.names.len()
            && systems.all(|system| self.names.binary_search(system).is_ok());
        inside == self.only
    }
}

fn sorted(names: &[String]) -> Vec<&str> {
    let mut sorted: Vec<&str> = names.iter().map(String::as_str).collect();
    sorted.sort_unstable();
    sorted.dedup();
    sorted
}

fn collide(a: &Rule, b: &Rule) -> bool {
    a.accepts(b) && b.accepts(a)
}

#[cfg(test)]
mod tests {
    use super::super::json::Told;
    use super::*;
    use serde_json::{Value, json};

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

    #[test]
    fn names_count_only_where_the_rules_of_the_file_agree_with_them() {
        let [one, other] = ["rapier 00000004 00000004", "rapier 00000008 00000008"];
        let file = |filters: [Option<Filter>; 2]| Shared {
            filters: filters.into(),
            ..Default::default()
        };
        let right = file([
            filter(&[one], Some(&[one]), None),
            filter(&[other], Some(&[other]), None),
        ]);
        let all = (u32::MAX, u32::MAX);
        assert_eq!(named_groups(&right), Some(vec![(4, 4), (8, 8), all]));
        // Someone made both touch, or gave one a name of his own.
        let both = [one, other];
        let changed = file([
            filter(&[one], Some(&both), None),
            filter(&[other], Some(&both), None),
        ]);
        let foreign = file([
            filter(&[one], Some(&[one]), None),
            filter(&["wall"], Some(&["wall"]), None),
        ]);
        let broken = file([filter(&[one], Some(&[one]), None), None]);
        for shared in [changed, foreign, broken, Shared::default()] {
            assert_eq!(named_groups(&shared), None, "{shared:?}");
        }
    }

    /// The same by comparison of each filter with each other one.
    fn slowly(shared: &Shared) -> Vec<(u32, u32)> {
        fn accepts(a: &Filter, b: &Filter) -> bool {
            let all_in = |names: &[String]| b.systems.iter().all(|system| names.contains(system));
            match (&a.only, &a.never) {
                (Some(only), _) => !b.systems.is_empty() && all_in(only),
                (None, Some(never)) => b.systems.is_empty() || !all_in(never),
                (None, None) => b.systems.is_empty() || !all_in(&[]),
            }
        }
        let filters = shared
            .filters
            .iter()
            .cloned()
            .map(Option::unwrap_or_default);
        let all: Vec<Filter> = filters.chain([Filter::default()]).collect();
        let bit = |i: usize| {
            if i == all.len() - 1 { 31 } else { i.min(30) }
        };
        let mask = |a: &Filter| {
            let with = (0..all.len()).filter(|i| accepts(a, &all[*i]) && accepts(&all[*i], a));
            with.fold(0, |mask, i| mask | 1_u32 << bit(i))
        };
        let groups = all.iter().enumerate();
        groups.map(|(i, a)| (1_u32 << bit(i), mask(a))).collect()
    }

    #[test]
    fn the_bits_are_those_of_comparing_each_with_each() {
        // A linear congruential generator, by Knuth.
        let mut seed = 1_u64;
        let mut roll = |sides: u64| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 33) % sides
        };
        for count in (0..64).chain(28..36).chain(28..36) {
            let mut filters = Vec::new();
            for _ in 0..count {
                let mut names = || {
                    let names = ["a", "b", "c", "a"].iter().filter(|_| roll(2) == 0);
                    names.copied().collect::<Vec<&str>>()
                };
                let (systems, only, never) = (names(), names(), names());
                filters.push(match roll(5) {
                    0 => None,
                    1 => filter(&systems, Some(&only), None),
                    2 => filter(&systems, None, None),
                    3 => filter(&systems, Some(&only), Some(&never)),
                    _ => filter(&systems, None, Some(&never)),
                });
            }
            let shared = Shared {
                filters,
                ..Default::default()
            };
            assert_eq!(groups(&shared), slowly(&shared), "{shared:?}");
        }
    }

    /// Reads filters from a file.
    fn read(filters: Vec<Value>) -> Vec<(u32, u32)> {
        let told = Told::default();
        let file = json!({ "collisionFilters": filters });
        let shared = Shared::read(Some(&file), None, &told);
        assert_eq!(told.count(), 0);
        groups(&shared)
    }

    #[test]
    fn many_filters_take_no_time_by_the_square_of_their_number() {
        const COUNT: usize = 200_000;
        let alike = read(vec![json!({}); COUNT]);
        assert_eq!(alike.len(), COUNT + 1);
        assert!(alike.iter().all(|(_, mask)| *mask == u32::MAX));
        let few = |i: usize| {
            let system = ["a", "b", "c"][i % 3];
            json!({ "collisionSystems": [system], "notCollideWithSystems": ["a"] })
        };
        let few = read((0..COUNT).map(few).collect());
        // None touches a collider with the system `a`. So the first does not touch itself.
        assert_eq!(few[0].1 & 1, 0);
        assert_eq!(few[1].1 & 0b111, 0b110);
        let each = |i: usize| {
            let system = format!("s{i}");
            json!({ "collisionSystems": [system], "notCollideWithSystems": [system] })
        };
        let each = read((0..COUNT).map(each).collect());
        for i in 0..SHARED {
            assert_eq!(each[i as usize], (1_u32 << i, !(1_u32 << i)));
        }
        assert!(
            each[SHARED as usize..COUNT]
                .iter()
                .all(|g| *g == (1_u32 << SHARED, u32::MAX))
        );
    }

    #[test]
    fn many_names_take_no_time_by_the_square_of_their_number() {
        let names: Vec<String> = (0..200_000).map(|i| format!("s{i}")).collect();
        let never = json!({ "collisionSystems": names, "notCollideWithSystems": names });
        let only = json!({ "collisionSystems": names, "collideWithSystems": names });
        let groups = read(vec![never, only]);
        assert_eq!(
            groups.iter().map(|g| g.1 & 0b11).collect::<Vec<_>>(),
            [0b00, 0b10, 0b01]
        );
    }
}
