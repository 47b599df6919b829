//! What can change a scene besides its elements' numbers: bodies that come, go, or become another kind of
//! body, and components that are taken away.

use crate::backend::rapier::forces::SpringLoad;
use crate::element::{
    Anchors, Damper, Spring, SpringDamper, TorsionDamper, TorsionSpring, TorsionSpringDamper,
};
use crate::scene::state::Scene;
use bevy::ecs::entity::EntityHashSet;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::message::MessageReader;
use bevy::ecs::query::Allow;
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;

/// A body that changed its kind or its place in the engine, or was disabled.
type BodyChange = (
    Or<(
        Changed<RapierRigidBodyHandle>,
        Changed<RapierContextEntityLink>,
        Changed<RigidBody>,
        Added<RigidBodyDisabled>,
        Added<Disabled>,
    )>,
    Allow<Disabled>,
);

/// Watches for such changes.
#[derive(SystemParam)]
pub(crate) struct Watch<'w, 's> {
    changed: Query<'w, 's, Entity, BodyChange>,
    handles: RemovedComponents<'w, 's, RapierRigidBodyHandle>,
    links: RemovedComponents<'w, 's, RapierContextEntityLink>,
    disabled: RemovedComponents<'w, 's, RigidBodyDisabled>,
    hidden: RemovedComponents<'w, 's, Disabled>,
    loads: RemovedComponents<'w, 's, SpringLoad>,
    forces: RemovedComponents<'w, 's, ExternalForce>,
    springs: RemovedComponents<'w, 's, Spring>,
    dampers: RemovedComponents<'w, 's, Damper>,
    pairs: RemovedComponents<'w, 's, SpringDamper>,
    torsion: (
        RemovedComponents<'w, 's, TorsionSpring>,
        RemovedComponents<'w, 's, TorsionDamper>,
        RemovedComponents<'w, 's, TorsionSpringDamper>,
    ),
    anchors: RemovedComponents<'w, 's, Anchors>,
    masses: MessageReader<'w, 's, MassModifiedEvent>,
    pub(crate) mass_modified: Local<'s, EntityHashSet>,
}

impl Watch<'_, '_> {
    /// Whether anything of the kind happened to the scene since the last tick. What elements have nothing to do
    /// with may come and go as it likes.
    pub(crate) fn saw_change(&mut self, scene: &Scene) -> bool {
        let is_known = |entity: Entity| scene.knows(entity);
        let is_loaded = |entity: Entity| scene.index.contains_key(&entity);
        self.mass_modified.clear();
        self.mass_modified.extend(self.masses.read().map(|m| m.0));
        let mut changed = self.changed.iter().any(is_known);
        changed |= self.mass_modified.iter().any(|e| is_loaded(*e));
        changed |= any_of(&mut self.handles, is_known);
        changed |= any_of(&mut self.links, is_known);
        changed |= any_of(&mut self.disabled, is_known);
        changed |= any_of(&mut self.loads, is_loaded);
        changed |= any_of(&mut self.forces, is_loaded);
        // One that was not known comes into the count of elements, or is looked for in every tick.
        changed |= any_of(&mut self.hidden, is_known);
        changed |= any_of(&mut self.anchors, is_known);
        changed |= any_of(&mut self.springs, is_known);
        changed |= any_of(&mut self.dampers, is_known);
        changed |= any_of(&mut self.pairs, is_known);
        let torsion = &mut self.torsion;
        changed |= any_of(&mut torsion.0, is_known);
        changed |= any_of(&mut torsion.1, is_known);
        changed |= any_of(&mut torsion.2, is_known);
        changed
    }
}

/// Whether any of what lost a component is of a kind. Each has to be read to its end.
fn any_of<C: Component>(lost: &mut RemovedComponents<C>, is_such: impl Fn(Entity) -> bool) -> bool {
    lost.read().filter(|entity| is_such(*entity)).count() > 0
}
