//! Detects changes of the scene other than changed parameters: bodies that appear, disappear or change their kind, and removed
//! components.
//!
//! Observers detect what appears and disappears, so a tick without such changes costs nothing. The rest is looked at by
//! [`any_news`], so that a tick without news skips the preparation.

use crate::backend::rapier::forces::SpringLoad;
use crate::compat::{Inserted, Removed};
use crate::element::*;
use crate::input::companions::ChangedBeside;
use crate::input::lists::{with_companions, with_elements};
use crate::input::parts::{Acts, ChangedParts};
use crate::scene::report::forget;
use crate::scene::state::Scene;
use bevy::ecs::entity::EntityHashSet;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::message::MessageReader;
use bevy::ecs::query::Allow;
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use std::sync::atomic::Ordering;

/// Detects bodies whose kind or mass changed.
#[derive(SystemParam)]
pub(crate) struct Watch<'w, 's> {
    changed: Query<'w, 's, Entity, (Changed<RigidBody>, Allow<Disabled>)>,
    masses: MessageReader<'w, 's, MassModifiedEvent>,
    pub(crate) mass_modified: Local<'s, EntityHashSet>,
}

impl Watch<'_, '_> {
    /// Whether any such change happened to the scene since the last tick. Entities that no element uses do not count.
    pub(crate) fn saw_change(&mut self, scene: &mut Scene) -> bool {
        self.mass_modified.clear();
        self.mass_modified.extend(self.masses.read().map(|m| m.0));
        scene.wall_changed |= self.changed.iter().any(|body| scene.walls.contains(&body));
        let is_loaded = |entity: &Entity| scene.body_row(*entity).is_some();
        let mut changed = self.changed.iter().any(|entity| scene.knows(entity));
        changed |= self.mass_modified.iter().any(is_loaded);
        changed | std::mem::take(&mut scene.disturbed)
    }
}

/// Queries that show whether [`prepare`](super::prepare::prepare) has anything to do.
#[derive(SystemParam)]
pub(crate) struct News<'w, 's> {
    elements: Query<'w, 's, (), Acts>,
    parts: Query<'w, 's, (), ChangedParts>,
    beside: Query<'w, 's, (), ChangedBeside>,
    bodies: Query<'w, 's, (), (Changed<RigidBody>, Allow<Disabled>)>,
    /// None without Rapier.
    masses: Option<MessageReader<'w, 's, MassModifiedEvent>>,
}

/// Run condition: something has changed since the scene was last prepared, or has to be looked at in every tick. Preparing
/// would find nothing otherwise.
pub(crate) fn any_news(scene: Res<Scene>, mut news: News) -> bool {
    let masses = news.masses.as_mut().map(|masses| masses.read().count());
    let seen = masses.is_some_and(|count| count > 0)
        || !scene.is_settled()
        || news.elements.iter().len() != scene.elements.len()
        || !news.parts.is_empty()
        || !news.beside.is_empty()
        || !news.bodies.is_empty();
    if seen {
        // Kept until the scene is prepared, which another condition may prevent in this tick.
        scene.news.store(true, Ordering::Relaxed);
    }
    seen || scene.news.load(Ordering::Relaxed)
}

/// Adds the observers to an app. Each of them observes a list of components, for an observer of its own for each component would
/// be compiled as often.
pub(crate) fn watch(app: &mut App) {
    let world = app.world_mut();
    macro_rules! ids {
        ($($component:ident),*) => {[$(world.register_component::<$component>()),*]};
    }
    macro_rules! of_laws {
        ([$($law:ident: $kind:ident),*] $others:tt) => {ids!($($kind),*)};
    }
    // Entities that the scene does not know need no observer: a new element changes the count of elements, and missing
    // ends of an inert element are looked for in every tick.
    let elements = with_elements!(ids);
    let bodies = ids![
        RapierRigidBodyHandle,
        RapierContextEntityLink,
        RigidBodyDisabled,
        Disabled
    ];
    let others = ids![Anchors];
    let lost = elements.into_iter().chain(bodies).chain(others);
    world.spawn(Observer::new(lose).with_components(lost));
    world.spawn(Observer::new(come).with_components(bodies));
    let loads = ids![SpringLoad, ExternalForce];
    world.spawn(Observer::new(unload).with_components(loads));
    let [loaded, _] = loads;
    world.spawn(Observer::new(load).with_component(loaded));
    let laws = with_companions!(of_laws);
    world.spawn(Observer::new(leave).with_components(laws));
}

/// Marks the scene as disturbed if it is `concerned`. While a snapshot is restored there is no scene resource, and nothing is to
/// be noted.
fn notice(entity: Entity, mut scene: Option<ResMut<Scene>>, concerned: impl Fn(&Scene) -> bool) {
    if let Some(scene) = &mut scene
        && scene.walls.contains(&entity)
    {
        scene.wall_changed = true;
    }
    // When many entities go at once, only the first need be looked for.
    let is_noted = |scene: &Scene| scene.disturbed && !scene.undisturbed;
    if let Some(mut scene) = scene.filter(|scene| !is_noted(scene) && concerned(scene)) {
        scene.disturb();
    }
}

/// Observes that a body or an element gets a component.
fn come(on: Inserted<()>, scene: Option<ResMut<Scene>>) {
    notice(on.entity, scene, |scene| scene.knows(on.entity));
}

/// Observes that an element or a body loses a component.
fn lose(
    on: Removed<()>,
    scene: Option<ResMut<Scene>>,
    faulty: Query<(), (With<SpringFault>, Allow<Disabled>)>,
    mut commands: Commands,
) {
    notice(on.entity, scene, |scene| scene.knows(on.entity));
    if faulty.contains(on.entity) {
        // The scene does not know an element that is disabled or waits for its ends.
        forget(on.entity, &mut commands);
    }
}

/// Observes that a body that elements can move loses a component.
fn unload(on: Removed<()>, scene: Option<ResMut<Scene>>) {
    notice(on.entity, scene, |scene| {
        scene.body_row(on.entity).is_some()
    });
}

/// Observes that a body gets a load. If elements cannot move it, it is the copy of another body, whose elements' share must go.
fn load(on: Inserted<()>, scene: Option<ResMut<Scene>>) {
    notice(on.entity, scene, |scene| {
        scene.body_row(on.entity).is_none()
    });
}

/// Observes that an element loses a companion component.
fn leave(on: Removed<()>, scene: Option<ResMut<Scene>>) {
    if let Some(mut scene) = scene.filter(|scene| scene.row_of.contains_key(&on.entity)) {
        scene.touched.push(on.entity);
    }
}
