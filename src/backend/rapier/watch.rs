//! What can change a scene besides its elements' numbers: bodies that come, go, or become another kind of
//! body, and components that are taken away.
//!
//! What comes and goes, observers see, so that a tick in which nothing does pays nothing.

use crate::backend::rapier::forces::SpringLoad;
use crate::compat::{Inserted, Removed};
use crate::element::*;
use crate::input::lists::{with_companions, with_elements};
use crate::scene::state::Scene;
use bevy::ecs::entity::EntityHashSet;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::message::MessageReader;
use bevy::ecs::query::Allow;
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;

/// Watches for bodies that become others.
#[derive(SystemParam)]
pub(crate) struct Watch<'w, 's> {
    changed: Query<'w, 's, Entity, (Changed<RigidBody>, Allow<Disabled>)>,
    masses: MessageReader<'w, 's, MassModifiedEvent>,
    pub(crate) mass_modified: Local<'s, EntityHashSet>,
}

impl Watch<'_, '_> {
    /// Whether anything of the kind happened to the scene since the last tick. What elements have nothing to do
    /// with may come and go as it likes.
    pub(crate) fn saw_change(&mut self, scene: &mut Scene) -> bool {
        self.mass_modified.clear();
        self.mass_modified.extend(self.masses.read().map(|m| m.0));
        let is_loaded = |entity: &Entity| scene.index.contains_key(entity);
        let mut changed = self.changed.iter().any(|entity| scene.knows(entity));
        changed |= self.mass_modified.iter().any(is_loaded);
        changed | std::mem::take(&mut scene.disturbed)
    }
}

/// Makes an app notice what comes and goes.
pub(crate) fn watch(app: &mut App) {
    macro_rules! elements {
        ($($element:ident),*) => {$(lost::<$element>(app);)*};
    }
    // One that was not known comes into the count of elements, or is looked for in every tick.
    with_elements!(elements);
    lost::<Anchors>(app);
    lost::<RapierRigidBodyHandle>(app);
    lost::<RapierContextEntityLink>(app);
    lost::<RigidBodyDisabled>(app);
    lost::<Disabled>(app);
    unloaded::<SpringLoad>(app);
    unloaded::<ExternalForce>(app);
    macro_rules! companions {
        ([$($law:ident: $kind:ident),*] $others:tt) => {$(left::<$kind>(app);)*};
    }
    with_companions!(companions);
    came::<RapierRigidBodyHandle>(app);
    came::<RapierContextEntityLink>(app);
    came::<RigidBodyDisabled>(app);
    came::<Disabled>(app);
}

/// Something happened to an entity; while a snapshot is put back, nobody asks.
fn notice(entity: Entity, scene: Option<ResMut<Scene>>) {
    if let Some(mut scene) = scene.filter(|scene| scene.knows(entity)) {
        scene.disturbed = true;
    }
}

/// A body or an element gets a component.
fn came<C: Component>(app: &mut App) {
    app.add_observer(|on: Inserted<C>, scene: Option<ResMut<Scene>>| notice(on.entity, scene));
}

/// An element or a body loses a component.
fn lost<C: Component>(app: &mut App) {
    app.add_observer(|on: Removed<C>, scene: Option<ResMut<Scene>>| notice(on.entity, scene));
}

/// A body that elements move loses a component.
fn unloaded<C: Component>(app: &mut App) {
    app.add_observer(|on: Removed<C>, scene: Option<ResMut<Scene>>| {
        if let Some(mut scene) = scene.filter(|scene| scene.index.contains_key(&on.entity)) {
            scene.disturbed = true;
        }
    });
}

/// An element loses a companion.
fn left<C: Component>(app: &mut App) {
    app.add_observer(|on: Removed<C>, scene: Option<ResMut<Scene>>| {
        if let Some(mut scene) = scene.filter(|scene| scene.row_of.contains_key(&on.entity)) {
            scene.left_behind.push(on.entity);
        }
    });
}
