//! What can change a scene besides its elements' numbers: bodies that come, go, or become another kind of
//! body, and components that are taken away.

use super::forces::SpringLoad;
use crate::element::{
    Anchors, Damper, Spring, SpringDamper, TorsionDamper, TorsionSpring, TorsionSpringDamper,
};
use bevy::ecs::entity::{EntityHashMap, EntityHashSet};
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
    changed: Query<'w, 's, (), BodyChange>,
    handles: RemovedComponents<'w, 's, RapierRigidBodyHandle>,
    links: RemovedComponents<'w, 's, RapierContextEntityLink>,
    disabled: RemovedComponents<'w, 's, RigidBodyDisabled>,
    hidden: RemovedComponents<'w, 's, Disabled>,
    loads: RemovedComponents<'w, 's, SpringLoad>,
    forces: RemovedComponents<'w, 's, ExternalForce>,
    springs: RemovedComponents<'w, 's, Spring>,
    dampers: RemovedComponents<'w, 's, Damper>,
    pairs: RemovedComponents<'w, 's, SpringDamper>,
    torsion_springs: RemovedComponents<'w, 's, TorsionSpring>,
    torsion_dampers: RemovedComponents<'w, 's, TorsionDamper>,
    torsion_pairs: RemovedComponents<'w, 's, TorsionSpringDamper>,
    anchors: RemovedComponents<'w, 's, Anchors>,
    masses: MessageReader<'w, 's, MassModifiedEvent>,
    pub(super) mass_modified: Local<'s, EntityHashSet>,
}

impl Watch<'_, '_> {
    /// Whether anything of the kind happened since the last tick.
    pub(super) fn saw_change(&mut self, index: &EntityHashMap<usize>) -> bool {
        self.mass_modified.clear();
        self.mass_modified.extend(self.masses.read().map(|m| m.0));
        let mut changed = !self.changed.is_empty();
        changed |= self.mass_modified.iter().any(|e| index.contains_key(e));
        // Each has to be read to its end.
        changed |= self.handles.read().count() > 0;
        changed |= self.links.read().count() > 0;
        changed |= self.disabled.read().count() > 0;
        changed |= self.hidden.read().count() > 0;
        changed |= self.springs.read().count() > 0;
        changed |= self.dampers.read().count() > 0;
        changed |= self.pairs.read().count() > 0;
        changed |= self.torsion_springs.read().count() > 0;
        changed |= self.torsion_dampers.read().count() > 0;
        changed |= self.torsion_pairs.read().count() > 0;
        changed |= self.anchors.read().count() > 0;
        changed |= self.loads.read().any(|e| index.contains_key(&e));
        changed |= self.forces.read().any(|e| index.contains_key(&e));
        changed
    }
}
