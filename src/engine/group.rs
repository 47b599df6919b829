//! Which elements have to be solved together.

use super::scene::{ElementRow, Held, Scene};

/// One component: elements that share bodies, and those bodies, by index into the scene.
#[derive(Default)]
pub(super) struct Group {
    pub elements: Vec<usize>,
    pub bodies: Vec<usize>,
}

/// Elements that share bodies, directly or through others.
pub(super) fn groups(scene: &Scene) -> Vec<Group> {
    let mut parent: Vec<usize> = (0..scene.bodies.len()).collect();
    fn root(parent: &mut [usize], mut at: usize) -> usize {
        while parent[at] != at {
            parent[at] = parent[parent[at]];
            at = parent[at];
        }
        at
    }
    let movable = |row: &ElementRow| {
        row.held.map(|held| match held {
            Held::Body { movable, .. } => movable,
            Held::Path { .. } => None,
        })
    };
    for row in &scene.elements {
        if let [Some(a), Some(b)] = movable(row) {
            let (a, b) = (root(&mut parent, a), root(&mut parent, b));
            parent[a.max(b)] = a.min(b);
        }
    }
    let mut groups: Vec<Group> = Vec::new();
    let mut group_of = vec![usize::MAX; scene.bodies.len()];
    for body in 0..scene.bodies.len() {
        let r = root(&mut parent, body);
        if group_of[r] == usize::MAX {
            group_of[r] = groups.len();
            groups.push(Group::default());
        }
        groups[group_of[r]].bodies.push(body);
    }
    for (i, row) in scene.elements.iter().enumerate() {
        if let Some(body) = movable(row).into_iter().flatten().next() {
            let r = root(&mut parent, body);
            groups[group_of[r]].elements.push(i);
        }
    }
    groups
}
