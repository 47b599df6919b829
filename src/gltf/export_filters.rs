//! Writes collision groups as filters. Each distinct `CollisionGroups` value becomes one collision system, whose
//! filter names all systems that it touches.
//!
//! In Rapier, two colliders touch if each has a membership that the other's filters contain. In the file, a collider
//! is let through only if the other collider names all of its systems, and a collider without systems cannot be
//! named. So colliders without groups get a filter too.
//!
//! The name of a system says the bits of its groups, so that they come back as they were.

use super::filters::{name, touch};
use bevy_rapier3d::prelude::CollisionGroups;
use serde_json::{Value, json};

/// The filters of a file: one for each distinct value of `CollisionGroups`.
#[derive(Default)]
pub(super) struct Filters(Vec<CollisionGroups>);

impl Filters {
    /// Returns the filters that colliders with these groups need. There are none if every collider has the default
    /// groups.
    pub(super) fn of(colliders: impl IntoIterator<Item = CollisionGroups>) -> Self {
        let mut all: Vec<CollisionGroups> = Vec::new();
        for groups in colliders {
            if !all.contains(&groups) {
                all.push(groups);
            }
        }
        if all == [CollisionGroups::default()] {
            all.clear();
        }
        Self(all)
    }

    /// Returns the index of a collider's filter, if it needs one.
    pub(super) fn index(&self, groups: CollisionGroups) -> Option<usize> {
        self.0.iter().position(|other| *other == groups)
    }

    /// Returns the JSON objects of the filters.
    pub(super) fn values(&self) -> Vec<Value> {
        let filter = |own: &CollisionGroups| {
            let touched = self.0.iter().filter(|other| touch(*own, **other));
            let mut names: Vec<String> = touched.map(|other| name(*other)).collect();
            if names.is_empty() {
                // The draft of the extension requires at least one name.
                names.push("nothing".into());
            }
            json!({ "collisionSystems": [name(*own)], "collideWithSystems": names })
        };
        self.0.iter().map(filter).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gltf::filters;
    use crate::gltf::json::Told;
    use crate::gltf::physics::Shared;
    use bevy_rapier3d::prelude::Group;

    /// Writes the filters and reads them back.
    fn read(filters: &Filters) -> Shared {
        let file = json!({ "collisionFilters": filters.values() });
        let told = Told::default();
        let shared = Shared::read(Some(&file), None, &told);
        assert_eq!(told.lines(), Vec::<String>::new());
        shared
    }

    #[test]
    fn the_same_pairs_touch_when_groups_went_through_a_file() {
        let [one, two, three] = [Group::GROUP_1, Group::GROUP_2, Group::GROUP_3];
        let colliders = [
            // Without groups.
            CollisionGroups::default(),
            CollisionGroups::new(one, one | three),
            CollisionGroups::new(three, three),
            CollisionGroups::new(one | two, Group::ALL),
            CollisionGroups::new(two, one),
            CollisionGroups::new(Group::GROUP_32, !one),
            CollisionGroups::new(two, Group::NONE),
            CollisionGroups::new(Group::NONE, Group::ALL),
        ];
        let filters = Filters::of(colliders);
        // As another program would read them, which does not know what the names say.
        let read = filters::groups(&read(&filters));
        let of = |groups| read[filters.index(groups).expect("it has a filter")];
        for a in colliders {
            for b in colliders {
                let (again_a, again_b) = (of(a), of(b));
                let again = again_a.0 & again_b.1 != 0 && again_b.0 & again_a.1 != 0;
                assert_eq!(again, touch(a, b), "{a:?} and {b:?}");
            }
        }
    }

    #[test]
    fn more_groups_than_there_are_bits_come_back_bit_for_bit() {
        let colliders: Vec<CollisionGroups> = (0..100)
            .map(|i: u32| {
                let bits = |seed: u32| Group::from_bits_retain(seed.wrapping_mul(0x9E37_79B9));
                CollisionGroups::new(bits(i), bits(i + 1000))
            })
            .collect();
        let filters = Filters::of(colliders.iter().copied());
        let read = filters::named_groups(&read(&filters)).expect("they are named");
        for groups in colliders {
            let found = read[filters.index(groups).expect("it has a filter")];
            assert_eq!(found, (groups.memberships.bits(), groups.filters.bits()));
        }
    }

    #[test]
    fn where_nothing_is_filtered_there_are_no_filters() {
        let filters = Filters::of([CollisionGroups::default(); 3]);
        assert_eq!(filters.index(CollisionGroups::default()), None);
        assert_eq!(filters.values(), Vec::<Value>::new());
    }
}
