//! Finds the components of a scene: the elements that must be solved together, because they share bodies.

use crate::scene::assembly::Assembly;
use crate::scene::rows::{BodyFlags, BodyRow, ElementFlags, ElementRow, Members, mix};
use crate::scene::sequence::Neighbours;
use bevy::platform::collections::HashMap;
use bevy::prelude::Entity;
use std::ops::Range;

/// One component: elements that are connected through bodies, and these bodies.
#[derive(Clone, Debug)]
pub(crate) struct Group {
    elements: Range<u32>,
    bodies: Range<u32>,
    /// Hash of its bodies and elements.
    signature: u64,
    /// Entity of the Rapier context that contains its bodies.
    pub context: Entity,
    /// Index of its assembly; none for a lone element that does not turn its bodies.
    pub assembly: Option<u32>,
    /// Whether contacts or joints hold one of its bodies.
    pub held: bool,
    /// Whether the engine solves its elements.
    pub inside: bool,
    /// Whether it was asleep when the backend last read it for the engine's solver.
    pub is_asleep: bool,
}

impl Group {
    /// Whether it is in `context`, and neither contacts nor joints hold it.
    pub(crate) fn is_free(&self, context: Entity) -> bool {
        self.context == context && !self.held
    }

    /// Adds `assembly` to `assemblies` as the assembly of this group, which has the index `index`.
    /// Its next step reads everything anew.
    fn take(&mut self, index: usize, mut assembly: Assembly, assemblies: &mut Vec<Assembly>) {
        assembly.group = index;
        self.assembly = u32::try_from(assemblies.len()).ok();
        assembly.signature = self.signature;
        assembly.read_anew();
        assemblies.push(assembly);
    }
}

/// All components, as ranges of two flat arrays.
#[derive(Default)]
pub(crate) struct Groups {
    elements: Vec<u32>,
    bodies: Vec<u32>,
    list: Vec<Group>,
}

fn root(parent: &mut [usize], mut at: usize) -> usize {
    while parent[at] != at {
        parent[at] = parent[parent[at]];
        at = parent[at];
    }
    at
}

fn is_sound(row: &&ElementRow) -> bool {
    row.trouble.lasting().is_none()
}

/// Returns the parent of each body in a union-find forest. Bodies that elements connect have the same root.
fn join(elements: &[ElementRow], bodies: usize) -> Vec<usize> {
    let mut parent: Vec<usize> = (0..bodies).collect();
    for row in elements.iter().filter(is_sound) {
        if let [Some(a), Some(b)] = [0, 1].map(|end| row.movable(end)) {
            let (a, b) = (root(&mut parent, a), root(&mut parent, b));
            parent[a.max(b)] = a.min(b);
        }
    }
    parent
}

/// Sort key of an element. It does not depend on when elements or bodies were spawned, except that elements with the same bodies,
/// anchors and numbers are sorted by the order in which they became known. `places` are the places of bodies within their components.
fn rank(row: &ElementRow, places: &[u32]) -> impl Ord + use<> {
    let p = row.parameters();
    let on = [0, 1].map(|end| row.movable(end).map(|b| places[b]));
    (
        on.iter().flatten().min().copied(),
        on,
        p.ties.anchors.map(|a| a.to_array().map(f32::to_bits)),
        [
            p.numbers.stiffness,
            p.numbers.damping,
            p.numbers.rest_length.unwrap_or(-1.0),
        ]
        .map(f32::to_bits),
        row.rare.serial,
    )
}

impl Groups {
    /// Finds the components of a scene, in the order in which their first elements became known.
    pub(crate) fn find(&mut self, elements: &[ElementRow], bodies: &[BodyRow]) {
        let mut parent = join(elements, bodies.len());
        // A root has the least index in its component, so the loop reaches it first.
        let mut of_body = Vec::with_capacity(bodies.len());
        let mut count = 0;
        for body in 0..bodies.len() {
            let r = root(&mut parent, body);
            of_body.push(if r == body { count } else { of_body[r] });
            count += usize::from(r == body);
        }
        let of_element = |(e, row): (usize, &ElementRow)| {
            let body = row.movable(0).or(row.movable(1))?;
            is_sound(&row).then_some((e, of_body[body]))
        };
        let body_starts = sort(
            count,
            (0..bodies.len()).map(|b| (b, of_body[b])),
            &mut self.bodies,
        );
        let element_starts = sort(
            count,
            elements.iter().enumerate().filter_map(of_element),
            &mut self.elements,
        );
        let mut neighbours = None;
        let mut places = vec![0; bodies.len()];
        for group in body_starts.windows(2).filter(|g| g[1] > g[0] + 1) {
            let members = &mut self.bodies[group[0]..group[1]];
            members.sort_by_key(|b| bodies[*b as usize].rare.rank);
            if members.len() > 2 {
                let sound = |row: &ElementRow| is_sound(&row);
                let all = neighbours.get_or_insert_with(|| Neighbours::of(elements, bodies, sound));
                all.arrange(members);
            }
            for (place, b) in members.iter().enumerate() {
                places[*b as usize] = place as u32;
            }
        }
        for group in element_starts.windows(2).filter(|g| g[1] > g[0] + 1) {
            self.elements[group[0]..group[1]]
                .sort_by_cached_key(|e| rank(&elements[*e as usize], &places));
        }
        self.list.clear();
        self.list.extend((0..count).map(|g| Group {
            elements: element_starts[g] as u32..element_starts[g + 1] as u32,
            bodies: body_starts[g] as u32..body_starts[g + 1] as u32,
            context: bodies[self.bodies[body_starts[g]] as usize].rare.context,
            signature: 0,
            assembly: None,
            held: false,
            inside: false,
            is_asleep: false,
        }));
        for group in &mut self.list {
            let members = &self.elements[span(&group.elements)];
            group.inside = members
                .iter()
                .any(|e| elements[*e as usize].inside.is_some());
        }
        let Self { elements: all, .. } = self;
        self.list.sort_by_cached_key(|group| {
            let serials = all[span(&group.elements)].iter();
            serials.map(|e| elements[*e as usize].rare.serial).min()
        });
    }

    /// Sorts all components, and the elements and bodies of each, by new places: `elements` and `bodies` have one for each row.
    pub(crate) fn arrange(&mut self, elements: &[u32], bodies: &[u32], rows: &[ElementRow]) {
        for group in &mut self.list {
            let members = &mut self.elements[span(&group.elements)];
            group.inside = members.iter().any(|e| rows[*e as usize].inside.is_some());
            members.sort_by_key(|e| elements[*e as usize]);
            self.bodies[span(&group.bodies)].sort_by_key(|b| bodies[*b as usize]);
        }
        let Self { bodies: all, .. } = self;
        self.list.sort_by_key(|group| {
            all[span(&group.bodies)]
                .first()
                .map(|b| bodies[*b as usize])
        });
    }

    /// Gives an assembly to every group that needs one. A group that existed before keeps its assembly.
    pub(crate) fn assign_assemblies(
        &mut self,
        assemblies: &mut Vec<Assembly>,
        elements: &[ElementRow],
        bodies: &[BodyRow],
    ) {
        let mut known: HashMap<u64, Assembly> =
            assemblies.drain(..).map(|a| (a.signature, a)).collect();
        for g in 0..self.list.len() {
            let members = self.members(&self.list[g]);
            let entities = members.bodies.iter().map(|b| bodies[*b as usize].entity);
            let members_too = members.elements.iter();
            let entities = entities.chain(members_too.map(|e| elements[*e as usize].entity));
            let signature = entities.fold(members.elements.len() as u64, |sum, entity| {
                mix(sum ^ entity.to_bits())
            });
            let turns = |b: &u32| bodies[*b as usize].has(BodyFlags::TURNS);
            let alone = match members.elements {
                [e] => {
                    let row = &elements[*e as usize];
                    row.has(ElementFlags::IS_PLAIN) && !members.bodies.iter().any(turns)
                }
                _ => false,
            };
            let before = known.remove(&signature);
            self.list[g].signature = signature;
            if !alone || before.is_some() {
                self.list[g].take(g, before.unwrap_or_default(), assemblies);
            }
        }
        assemblies.shrink_to_fit();
    }

    /// Stores whether contacts or joints hold a body of a group.
    pub(crate) fn set_held(&mut self, group: usize, held: bool, elements: &mut [ElementRow]) {
        if std::mem::replace(&mut self.list[group].held, held) != held {
            for e in self.members(&self.list[group]).elements {
                elements[*e as usize].flags.set(ElementFlags::HELD, held);
            }
        }
    }

    /// Gives the group of a lone element an assembly.
    pub(crate) fn promote(&mut self, group: usize, assemblies: &mut Vec<Assembly>) {
        self.list[group].take(group, Assembly::default(), assemblies);
    }

    pub(crate) fn list(&self) -> &[Group] {
        &self.list
    }

    pub(crate) fn at(&mut self, group: usize) -> &mut Group {
        &mut self.list[group]
    }

    /// Row indices of a group's elements and bodies.
    pub(crate) fn members(&self, group: &Group) -> Members<'_> {
        Members {
            elements: &self.elements[span(&group.elements)],
            bodies: &self.bodies[span(&group.bodies)],
        }
    }
}

fn span(range: &Range<u32>) -> Range<usize> {
    range.start as usize..range.end as usize
}

/// Sorts (index, group) pairs by group with a stable counting sort. Returns the start of each group,
/// and the total number at the end.
fn sort(
    count: usize,
    items: impl Iterator<Item = (usize, usize)> + Clone,
    sorted: &mut Vec<u32>,
) -> Vec<usize> {
    let mut starts = vec![0; count + 1];
    for (_, group) in items.clone() {
        starts[group + 1] += 1;
    }
    for g in 0..count {
        starts[g + 1] += starts[g];
    }
    sorted.clear();
    sorted.resize(starts[count], 0);
    let mut next = starts.clone();
    for (item, group) in items {
        sorted[next[group]] = item as u32;
        next[group] += 1;
    }
    starts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sorting_keeps_order_within_groups() {
        let items = [(0, 1), (1, 0), (3, 1), (4, 2), (5, 0)];
        let mut sorted = Vec::new();
        assert_eq!(sort(3, items.into_iter(), &mut sorted), [0, 2, 4, 5]);
        assert_eq!(sorted, [1, 5, 0, 3, 4]);
        assert_eq!(sort(0, [].into_iter(), &mut sorted), [0]);
        assert!(sorted.is_empty());
    }
}
