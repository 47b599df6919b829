//! Maps the entities in a snapshot to those of another world.

use crate::scene::kept::Kept;
use bevy::ecs::entity::{EntityMapper, MapEntities};
use bevy::prelude::Entity;

impl Kept {
    /// All entities in the snapshot: first contexts, then bodies, then elements.
    pub(crate) fn entities(&self) -> impl Iterator<Item = Entity> {
        let left = self.left.iter().map(|(context, _)| *context);
        let unloaded = self.unloaded.iter().map(|(context, ..)| *context);
        let contexts = self.contexts.iter().map(|context| context.entity);
        let bodies = self.bodies.iter().map(|body| body.entity);
        let elements = self.elements.iter().map(|element| element.entity);
        contexts
            .chain(left)
            .chain(unloaded)
            .chain(bodies)
            .chain(elements)
    }
}

impl MapEntities for Kept {
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        let Self {
            contexts,
            elements,
            bodies,
            groups: _,
            left,
            unloaded,
            time: _,
            engine_stays: _,
        } = self;
        let contexts = contexts.iter_mut().map(|context| &mut context.entity);
        let left = left.iter_mut().map(|(context, _)| context);
        let unloaded = unloaded.iter_mut().map(|(context, ..)| context);
        let bodies = bodies.iter_mut().map(|body| &mut body.entity);
        let elements = elements.iter_mut().map(|element| &mut element.entity);
        let all = contexts
            .chain(left)
            .chain(unloaded)
            .chain(bodies)
            .chain(elements);
        for entity in all {
            *entity = mapper.get_mapped(*entity);
        }
    }
}
