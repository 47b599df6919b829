//! The bodies that need a row.

use crate::backend::{BodyId, Found, Movable, Place};
use crate::scene::rows::BodyRow;
use bevy::prelude::{Entity, Vec3};

/// A body that elements can move.
pub(crate) struct WantedBody {
    pub(crate) entity: Entity,
    pub(crate) id: BodyId,
    pub(crate) context: Entity,
    pub(crate) turns: bool,
    /// See [`Movable::center`].
    pub(crate) center: Vec3,
    /// See [`Movable::rank`].
    pub(crate) rank: u64,
    /// The end of an element that is on it: twice the row index of the element, plus the index of the end.
    pub(crate) end: u32,
}

impl WantedBody {
    /// Whether `row` is the row of this body.
    pub(crate) fn is(&self, row: &BodyRow) -> bool {
        row.entity == self.entity && row.id == self.id && row.rare.context == self.context
    }

    /// The bodies of both ends that elements can move. `element` is the row index of their element.
    pub(crate) fn of(element: usize, found: &Found) -> impl Iterator<Item = Self> {
        let ends = found.places.iter().zip(found.movable).enumerate();
        ends.filter_map(move |(end, (place, movable))| match (*place, movable) {
            (
                Place::OnBody {
                    entity,
                    body: id,
                    context,
                    ..
                },
                Some(Movable {
                    turns,
                    center,
                    rank,
                }),
            ) => Some(Self {
                entity,
                id,
                context,
                turns,
                center,
                rank,
                end: (2 * element + end) as u32,
            }),
            _ => None,
        })
    }

    /// For each end of `elements` elements, the row index of the body that it moves. `all` must be sorted by entity.
    pub(crate) fn rows(all: &[Self], elements: usize) -> Vec<Option<u32>> {
        let mut rows = vec![None; 2 * elements];
        let bodies = all.chunk_by(|a, b| a.entity == b.entity);
        for (row, body) in bodies.enumerate() {
            for of in body {
                rows[of.end as usize] = Some(row as u32);
            }
        }
        rows
    }
}
