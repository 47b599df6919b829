//! Each body has one `ExternalForce` with two owners: the user and the elements. This file keeps their shares apart.

use super::body;
use super::find::Contexts;
use crate::backend::Wrench;
use crate::scene::rows::{BodyFlags, BodyRow};
use crate::scene::state::Scene;
use crate::threads;
use bevy::ecs::change_detection::ContiguousMut;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;

/// The shares of elements and user in the `ExternalForce` of a body on which elements act.
///
/// After every step, `ExternalForce` holds the sum of both shares. A value that you assign to it becomes the user's new share.
/// To change the user's share by some amount, start from `user`.
///
/// The share of the elements is not the force of the springs. It is the force that, together with an impulse at the start of
/// the step, makes the engine's few substeps end where the springs take the body.
#[derive(Component, Reflect, Clone, Debug)]
#[type_path = "bevy_coilover"]
#[reflect(Component, Debug, Clone)]
pub struct SpringLoad {
    /// Force (N) and torque (N m) that elements gave to the body over the last step, world frame.
    pub elements: ExternalForce,
    /// Force (N) and torque (N m) that the user wrote, world frame.
    pub user: ExternalForce,
    /// Index of the body's row in the scene. It is valid only if that row has the same entity.
    #[reflect(ignore)]
    pub(crate) slot: usize,
    /// Whether the crate gave the body a second solver iteration.
    #[reflect(ignore)]
    raised_iterations: bool,
}

/// Filter: disabled entities count too. Unlike `Allow`, it lets a query give whole tables.
pub(crate) type WithDisabled = Or<(With<Disabled>, Without<Disabled>)>;

/// Loads of bodies, including disabled bodies, whose share must be removed too. The query cannot return whole tables if the game has
/// registered a disabling component of sparse storage; then all is done one body at a time.
pub(crate) type Loads<'w, 's> = Query<
    'w,
    's,
    (
        Entity,
        &'static mut SpringLoad,
        Option<&'static mut ExternalForce>,
    ),
    WithDisabled,
>;

/// Numbers of solver iterations that the user has given to bodies.
pub(crate) type Iterations<'w, 's> =
    Query<'w, 's, (Entity, Ref<'static, AdditionalSolverIterations>)>;

/// Engine handles and the user's solver iterations of bodies, including disabled bodies.
pub(crate) type Handles<'w, 's> = Query<
    'w,
    's,
    (
        &'static RapierRigidBodyHandle,
        &'static RapierContextEntityLink,
        Option<&'static AdditionalSolverIterations>,
    ),
    Allow<Disabled>,
>;

/// Number of bodies from which on several threads are worth their start-up time. Pinned by the benchmark `own/isolated`.
const WORTH_SHARING: usize = 4096;

/// Converts the component to the crate's own type.
pub(crate) fn wrench(force: &ExternalForce) -> Wrench {
    Wrench {
        force: force.force,
        torque: force.torque,
    }
}

/// Converts the crate's own type to the component.
fn external(wrench: Wrench) -> ExternalForce {
    ExternalForce {
        force: wrench.force,
        torque: wrench.torque,
    }
}

/// The value of a body's `ExternalForce` for both shares.
fn sum(elements: &ExternalForce, user: &ExternalForce) -> ExternalForce {
    external(body::sum(&wrench(elements), &wrench(user)))
}

impl SpringLoad {
    pub(crate) fn new(user: ExternalForce, slot: usize) -> Self {
        Self {
            elements: ExternalForce::default(),
            user,
            slot,
            raised_iterations: false,
        }
    }

    /// Restores the shares of user and elements. Also returns the value of the body's `ExternalForce` for them.
    pub(crate) fn again(
        [user, elements]: [ExternalForce; 2],
        slot: usize,
        raised_iterations: bool,
    ) -> (Self, ExternalForce) {
        let load = Self {
            elements,
            user,
            slot,
            raised_iterations,
        };
        (load, sum(&elements, &user))
    }

    /// Replaces a user's share that is not finite, or larger than the engine can compute with, by none. A scene or a remote
    /// call may have written anything.
    pub(crate) fn mend(&mut self) {
        for share in [&mut self.user.force, &mut self.user.torque] {
            if !share.length_squared().is_finite() {
                *share = Vec3::ZERO;
            }
        }
    }

    pub(crate) fn raised_iterations(&self) -> bool {
        self.raised_iterations
    }

    /// Reads the user's share from an `ExternalForce` that changed since the last step. Returns whether the share differs from
    /// before.
    fn read_user(&mut self, now: &ExternalForce) -> bool {
        let before = self.user;
        // The value that the crate left in the component.
        let left = sum(&self.elements, &self.user);
        take_in(&mut self.user.force, now.force, left.force);
        take_in(&mut self.user.torque, now.torque, left.torque);
        self.user != before
    }

    /// Writes the elements' share, and the sum of both shares to the component. The component is not marked as changed, because
    /// bevy_rapier would then write it to the engine again and keep the body awake for ever.
    fn show(&mut self, elements: ExternalForce, component: Option<&mut ExternalForce>) {
        self.elements = elements;
        if let Some(component) = component {
            *component = sum(&elements, &self.user);
        }
    }

    /// Writes the share that elements gave to the body in the tick with this number, if they did.
    #[inline(always)]
    fn show_of(
        &mut self,
        entity: Entity,
        bodies: &[BodyRow],
        tick: u32,
        component: Option<&mut ExternalForce>,
    ) {
        let row = bodies.get(self.slot).filter(|row| row.entity == entity);
        if let Some((row, share)) = row.and_then(|row| Some((row, row.share(tick)?))) {
            self.show(external(share), component);
            self.raised_iterations |= row.has(BodyFlags::SECOND_SUBSTEP);
        }
    }
}

/// Reads what the user wrote since the last step. The engine wakes a body whose `ExternalForce` changes. The crate marks a body
/// whose user's share changed as disturbed, so that its component wakes.
pub(crate) fn read_users(scene: &mut Scene, loads: &mut Loads) {
    scene.loaded = false;
    let mut read = |entity: Entity, load: &mut SpringLoad, component: &ExternalForce| {
        let new = load.read_user(component);
        scene.loaded |= new;
        if let Some(row) = scene.body(load.slot, entity) {
            if new {
                row.flags.insert(BodyFlags::DISTURBED);
            }
            row.set_user(wrench(&load.user));
        }
    };
    if let Ok(tables) = loads.contiguous_iter_mut() {
        for (entities, loads, components) in tables {
            let Some(components) = components else {
                continue;
            };
            let (loads, _) = ContiguousMut::bypass_change_detection_split(loads);
            let (components, ticks) = ContiguousMut::bypass_change_detection_split(components);
            for (at, _) in ticks.is_changed_iter().enumerate().filter(|(_, new)| *new) {
                read(entities[at], &mut loads[at], &components[at]);
            }
        }
    } else {
        for (entity, mut load, component) in loads {
            if let Some(component) = component.filter(Mut::is_changed) {
                read(entity, load.bypass_change_detection(), &component);
            }
        }
    }
}

/// Reads the numbers of solver iterations that the user has set since the last step. One that the crate had already set is
/// the user's now, and is not taken away later.
pub(crate) fn read_iterations(scene: &mut Scene, users: &Iterations, loads: &mut Loads) {
    for (entity, number) in users.iter().filter(|(_, number)| number.is_changed()) {
        let Ok((_, mut load, _)) = loads.get_mut(entity) else {
            continue;
        };
        let load = load.bypass_change_detection();
        load.raised_iterations &= number.0 != 1;
        if let Some(row) = scene.body(load.slot, entity) {
            row.rare.raised.leave_substeps(number.0);
        }
    }
}

/// Writes the elements' share of every stepped body to its components.
pub(crate) fn show(scene: &Scene, loads: &mut Loads) {
    if !scene.delivered {
        return;
    }
    let (bodies, tick) = (&scene.bodies[..], scene.tick);
    let Ok(tables) = loads.contiguous_iter_mut() else {
        for (entity, mut load, mut component) in loads {
            let component = component.as_mut().map(Mut::bypass_change_detection);
            let load = load.bypass_change_detection();
            load.show_of(entity, bodies, tick, component);
        }
        return;
    };
    for (entities, loads, components) in tables {
        let (loads, _) = ContiguousMut::bypass_change_detection_split(loads);
        let each = threads::piece_of(loads.len(), loads.len() >= WORTH_SHARING);
        let pieces = entities.chunks(each).zip(loads.chunks_mut(each));
        let Some(components) = components else {
            threads::share(pieces, |(entities, loads)| {
                for (entity, load) in entities.iter().zip(loads) {
                    load.show_of(*entity, bodies, tick, None);
                }
            });
            continue;
        };
        let (components, _) = ContiguousMut::bypass_change_detection_split(components);
        let pieces = pieces.zip(components.chunks_mut(each));
        threads::share(pieces, |((entities, loads), components)| {
            for ((entity, load), component) in entities.iter().zip(loads).zip(components) {
                load.show_of(*entity, bodies, tick, Some(component));
            }
        });
    }
}

/// Updates the user's share on axes where the component differs from the value that the crate left there.
fn take_in(share: &mut Vec3, now: Vec3, left: Vec3) {
    for axis in 0..3 {
        if now[axis].to_bits() != left[axis].to_bits() {
            share[axis] = now[axis];
        }
    }
}

/// Removes the elements' share from bodies on which no element acts any more.
pub(crate) fn release(
    scene: &mut Scene,
    loads: &mut Loads,
    handles: &Handles,
    contexts: &mut Contexts,
    commands: &mut Commands,
) {
    for (entity, mut load, mut component) in loads {
        if scene.body(load.slot, entity).is_some() || scene.body_row(entity).is_some() {
            continue;
        }
        let mut component = component.as_mut().map(Mut::bypass_change_detection);
        if let Some(component) = &component {
            // What the user wrote in this tick has not been read yet.
            load.read_user(component);
        }
        load.mend();
        if let Ok((handle, link, users)) = handles.get(entity)
            && let Ok((mut set, ..)) = contexts.get_mut(link.0)
            && let Some(body) = set.bodies.get_mut(handle.0)
        {
            body::leave(body, &wrench(&load.user));
            load.show(ExternalForce::default(), component);
            let is_users = users.is_some_and(|number| number.0 == 1);
            let is_ours = load.raised_iterations && !is_users;
            if is_ours && body.additional_solver_iterations() == 1 {
                body.set_additional_solver_iterations(0);
            }
            body.wake_up(true);
        } else if let Some(component) = &mut component {
            // The engine's body is gone. A later body starts from the component.
            **component = load.user;
        }
        commands.entity(entity).try_remove::<SpringLoad>();
    }
}
