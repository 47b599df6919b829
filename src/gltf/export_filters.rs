//! Collision groups as filters: each combination of groups that colliders have is a system of its own, which names all
//! systems that it touches.
//!
//! Rapier's colliders touch where one group of each is wanted by the other. In the file a collider has to be named by the
//! other with all of its systems, and one without systems is named by nobody. So those without groups get a filter too.

use bevy_rapier3d::prelude::CollisionGroups;
use serde_json::{Value, json};

/// The filters of a file, by their combinations of groups.
#[derive(Default)]
pub(super) struct Filters(Vec<CollisionGroups>);

impl Filters {
    /// Those that colliders with these groups need: none, if all touch all.
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

    /// The index of a collider's filter, if it needs one.
    pub(super) fn index(&self, groups: CollisionGroups) -> Option<usize> {
        self.0.iter().position(|other| *other == groups)
    }

    /// As the file has them.
    pub(super) fn values(&self) -> Vec<Value> {
        let name = |index: usize| format!("group_{index}");
        let filter = |(index, own): (usize, &CollisionGroups)| {
            let others = self.0.iter().enumerate();
            let touched = others.filter(|(_, other)| touch(own, other));
            let mut names: Vec<String> = touched.map(|(index, _)| name(index)).collect();
            if names.is_empty() {
                // The draft asks for one name at least.
                names.push("nothing".into());
            }
            json!({ "collisionSystems": [name(index)], "collideWithSystems": names })
        };
        self.0.iter().enumerate().map(filter).collect()
    }
}

/// Whether colliders with these groups touch in Rapier.
fn touch(a: &CollisionGroups, b: &CollisionGroups) -> bool {
    a.memberships.intersects(b.filters) && b.memberships.intersects(a.filters)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gltf::filters;
    use crate::gltf::json::Told;
    use crate::gltf::physics::Shared;
    use bevy_rapier3d::prelude::Group;

    /// Filters as a file with them is read: memberships and filters of each, as bits.
    fn read(filters: &Filters) -> Vec<(u32, u32)> {
        let file = json!({ "collisionFilters": filters.values() });
        let told = Told::default();
        let shared = Shared::read(Some(&file), None, &told);
        assert_eq!(told.lines(), Vec::<String>::new());
        filters::groups(&shared)
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
        let read = read(&filters);
        let of = |groups| read[filters.index(groups).expect("it has a filter")];
        for a in colliders {
            for b in colliders {
                let (again_a, again_b) = (of(a), of(b));
                let again = again_a.0 & again_b.1 != 0 && again_b.0 & again_a.1 != 0;
                assert_eq!(again, touch(&a, &b), "{a:?} and {b:?}");
            }
        }
    }

    #[test]
    fn where_nothing_is_filtered_there_are_no_filters() {
        let filters = Filters::of([CollisionGroups::default(); 3]);
        assert_eq!(filters.index(CollisionGroups::default()), None);
        assert_eq!(filters.values(), Vec::<Value>::new());
    }
}
