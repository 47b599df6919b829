//! For the case that Rapier's snapshot was restored but the springs' snapshot does not fit. Removes what springs had in Rapier at
//! the time of the snapshot; then springs start afresh.

use super::check::is_in;
use crate::backend::rapier::body::{handle, id, leave};
use crate::backend::{BodyId, Wrench};
use crate::scene::kept::{Kept, KeptElement};
use crate::scene::rows::Raised;
use crate::scene::state::Scene;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use std::mem::take;

impl Kept {
    /// The context of an element in the engine's solver: that of a body that it moves.
    pub(super) fn context_of(&self, element: &KeptElement, world: &World) -> Option<Entity> {
        let mut bodies = element
            .on
            .iter()
            .filter_map(|body| self.bodies.get(*body as usize));
        bodies.find_map(|body| {
            let link = world.get::<RapierContextEntityLink>(body.entity)?;
            Some(link.0)
        })
    }

    /// Takes the elements' share of that time from the forces in the engine, for those bodies that have no elements now: no step
    /// does so.
    pub(super) fn take_share(&self, world: &mut World, is_free: impl Fn(Entity) -> bool) {
        for body in self.bodies.iter().filter(|body| is_free(body.entity)) {
            let [force, torque] = body.user;
            if force.is_finite()
                && torque.is_finite()
                && let Some((context, id)) = place(world, body.entity)
                && let Some(mut set) = world.get_mut::<RapierRigidBodySet>(context)
                && let Some(body) = set.bodies.get_mut(handle(id))
            {
                leave(body, &Wrench { force, torque });
            }
        }
    }

    /// Makes the next step remove from the engine what springs had in it when the snapshot was taken.
    pub(crate) fn begin_anew(&self, world: &mut World) {
        let mut contexts = world.query::<(Entity, &RapierRigidBodySet, &RapierContextJoints)>();
        let elements = self.elements.iter().filter_map(|element| {
            let inside = element.inside.as_deref()?;
            Some((self.context_of(element, world), inside))
        });
        let left = self.left.iter().map(|(of, inside)| (Some(*of), inside));
        let insides = elements.chain(left).filter_map(|(known, inside)| {
            // Two contexts may have the same handles.
            let known = known.filter(|context| {
                let parts = contexts.get(world, *context);
                parts.is_ok_and(|(_, set, joints)| is_in(inside, set, joints))
            });
            let context = known.or_else(|| {
                let mut contexts = contexts.iter(world);
                let found = contexts.find(|(_, set, joints)| is_in(inside, set, joints));
                found.map(|(context, ..)| context)
            })?;
            Some((context, inside.put(context)))
        });
        let insides: Vec<_> = insides.collect();
        let raised = self.bodies.iter().filter(|body| body.raised.is_any());
        let raised = raised.filter_map(|body| {
            let (context, id) = place(world, body.entity)?;
            Some((context, id, body.raised))
        });
        let raised: Vec<_> = raised.chain(self.unloaded.iter().copied()).collect();
        self.take_share(world, |_| true);
        let Some(mut scene) = world.get_resource_mut::<Scene>() else {
            return;
        };
        // The engine no longer contains what the springs have now.
        for row in &mut scene.elements {
            let _ = row.take_inside();
        }
        for row in &mut scene.bodies {
            row.rare.raised = Raised::default();
        }
        scene.left = insides;
        scene.unloaded = raised;
        let sweeps = self.contexts.iter();
        scene.sweeps = sweeps
            .map(|context| (context.entity, context.sweeps))
            .collect();
        scene.stale = true;
    }
}

/// Context and handle of a body.
fn place(world: &World, entity: Entity) -> Option<(Entity, BodyId)> {
    let body = world.get_entity(entity).ok()?;
    let handle = body.get::<RapierRigidBodyHandle>()?.0;
    Some((body.get::<RapierContextEntityLink>()?.0, id(handle)))
}

/// Returns whether Rapier's snapshot was restored after the last step, and resets that fact.
pub(crate) fn engine_went_back(world: &mut World) -> bool {
    let scene = world.get_resource_mut::<Scene>();
    scene.is_some_and(|mut scene| take(&mut scene.engine_went_back))
}

/// Whether the scene is to be made anew because some entity gained or lost a component.
pub(crate) fn is_disturbed(world: &World) -> bool {
    let scene = world.get_resource::<Scene>();
    scene.is_some_and(|scene| scene.disturbed)
}

/// Records that Rapier's snapshot was restored. `undisturbed` tells whether a scene that is restored as well need not be made anew
/// again in the next tick.
pub(crate) fn note_engine(world: &mut World, undisturbed: bool) {
    if let Some(mut scene) = world.get_resource_mut::<Scene>() {
        scene.engine_went_back = true;
        scene.undisturbed = undisturbed;
    }
}
