//! The bodies that need a row.

use crate::backend::{BodyId, Found, Movable, Place};
use crate::scene::rows::BodyRow;
use bevy::prelude::{Entity, Vec3};

/// A body that elements can move.
pub(crate) struct Wanted {
    pub(crate) entity: Entity,
    pub(crate) id: BodyId,
    pub(crate) context: Entity,
    pub(crate) turns: bool,
    /// See [`Movable::center`].
    pub(crate) center: Vec3,
    /// See [`Movable::rank`].
    pub(crate) rank: u64,
}

impl Wanted {
    /// Whether `row` is the row of this body.
    pub(crate) fn is(&self, row: &BodyRow) -> bool {
        row.entity == self.entity && row.id == self.id && row.rare.context == self.context
    }

    /// The bodies of both ends that elements can move.
    pub(crate) fn of(found: &Found) -> impl Iterator<Item = Self> {
        let ends = found.places.iter().zip(found.movable);
        ends.filter_map(|(place, movable)| match (*place, movable) {
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
            }),
            _ => None,
        })
    }
}
