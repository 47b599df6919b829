//! What is needed only while rows are made anew.

use crate::backend::{BodyId, Found, Movable, Place};
use crate::scene::rows::BodyRow;
use bevy::prelude::Entity;

/// Kept between, for its memory alone.
#[derive(Default)]
pub(crate) struct Scratch {
    /// The ends of every element, or none of an inert one.
    pub(crate) found: Vec<Option<Found>>,
    /// The rows of bodies as they were.
    pub(crate) bodies: Vec<BodyRow>,
    /// The bodies that there are to be, in the order of their entities.
    pub(crate) wanted: Vec<Wanted>,
}

impl Scratch {
    pub(crate) fn clear(&mut self) {
        self.found.clear();
        self.bodies.clear();
        self.wanted.clear();
    }
}

/// A body that elements can move.
pub(crate) struct Wanted {
    pub(crate) entity: Entity,
    pub(crate) id: BodyId,
    pub(crate) context: Entity,
    pub(crate) turns: bool,
    /// See [`Movable::rank`].
    pub(crate) rank: u64,
    /// Which elements acted on it before, as a hash.
    pub(crate) signature: u64,
}

impl Wanted {
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
                Some(Movable { turns, rank }),
            ) => Some(Self {
                entity,
                id,
                context,
                turns,
                rank,
                signature: 0,
            }),
            _ => None,
        })
    }
}
