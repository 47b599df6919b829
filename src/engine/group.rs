//! Which elements have to be solved together.

use super::scene::{ElementRow, Held, Scene};

/// One component: elements that share bodies, and those bodies, by index into the scene.
#[derive(Clone, Copy)]
pub(super) struct Group<'a> {
    pub elements: &'a [usize],
    pub bodies: &'a [usize],
}

/// All components, as runs of two flat arrays that are kept from tick to tick.
#[derive(Default)]
pub(super) struct Groups {
    elements: Vec<usize>,
    bodies: Vec<usize>,
    /// Where each component's run begins, and a last one where all end.
    element_starts: Vec<usize>,
    body_starts: Vec<usize>,
    parent: Vec<usize>,
    of_body: Vec<usize>,
}

/// The movable bodies of an element's ends.
fn movable(row: &ElementRow) -> [Option<usize>; 2] {
    row.held.map(|held| match held {
        Held::Body { movable, .. } => movable,
        Held::Path { .. } => None,
    })
}

fn root(parent: &mut [usize], mut at: usize) -> usize {
    while parent[at] != at {
        parent[at] = parent[parent[at]];
        at = parent[at];
    }
    at
}

impl Groups {
    /// Finds the components of a scene, in the order of their first bodies.
    pub(super) fn find(&mut self, scene: &Scene) {
        let bodies = scene.bodies.len();
        self.parent.clear();
        self.parent.extend(0..bodies);
        for row in &scene.elements {
            if let [Some(a), Some(b)] = movable(row) {
                let (a, b) = (root(&mut self.parent, a), root(&mut self.parent, b));
                self.parent[a.max(b)] = a.min(b);
            }
        }
        // A root is the least of its component, so it is met first.
        self.of_body.clear();
        let mut count = 0;
        for body in 0..bodies {
            let r = root(&mut self.parent, body);
            self.of_body
                .push(if r == body { count } else { self.of_body[r] });
            count += usize::from(r == body);
        }
        let of_element = |row: &ElementRow| {
            let body = movable(row).into_iter().flatten().next()?;
            Some(self.of_body[body])
        };
        sort(
            count,
            (0..bodies).map(|body| Some(self.of_body[body])),
            &mut self.body_starts,
            &mut self.bodies,
        );
        sort(
            count,
            scene.elements.iter().map(of_element),
            &mut self.element_starts,
            &mut self.elements,
        );
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = Group<'_>> {
        let count = self.body_starts.len().saturating_sub(1);
        (0..count).map(|g| Group {
            elements: &self.elements[self.element_starts[g]..self.element_starts[g + 1]],
            bodies: &self.bodies[self.body_starts[g]..self.body_starts[g + 1]],
        })
    }
}

/// Counting sort of indices by group, stable; those without a group are left out.
fn sort(
    count: usize,
    groups: impl Iterator<Item = Option<usize>> + Clone,
    starts: &mut Vec<usize>,
    sorted: &mut Vec<usize>,
) {
    starts.clear();
    starts.resize(count + 1, 0);
    for group in groups.clone().flatten() {
        starts[group] += 1;
    }
    let mut sum = 0;
    for start in starts.iter_mut() {
        sum += std::mem::replace(start, sum);
    }
    sorted.clear();
    sorted.resize(sum, 0);
    for (i, group) in groups.enumerate() {
        if let Some(group) = group {
            sorted[starts[group]] = i;
            starts[group] += 1;
        }
    }
    // Each start has moved to the next one's place.
    starts.rotate_right(1);
    starts[0] = 0;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sorting_keeps_order_within_groups_and_drops_the_groupless() {
        let groups = [Some(1), Some(0), None, Some(1), Some(2), Some(0)];
        let (mut starts, mut sorted) = (Vec::new(), Vec::new());
        sort(3, groups.into_iter(), &mut starts, &mut sorted);
        assert_eq!(starts, [0, 2, 4, 5]);
        assert_eq!(sorted, [1, 5, 0, 3, 4]);
        sort(0, [].into_iter(), &mut starts, &mut sorted);
        assert_eq!((starts, sorted), (vec![0], vec![]));
    }
}
