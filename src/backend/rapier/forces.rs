//! One `ExternalForce` per body, two owners: the user's share and ours, kept apart.

use super::body;
use crate::backend::{Push, Wrench};
use crate::scene::rows::BodyFlags;
use crate::scene::state::Scene;
use crate::threads;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;

/// On a body that elements act on: their share of what stands in its `ExternalForce`.
///
/// `ExternalForce` holds the sum of both shares after every step. Whatever is assigned to it is taken
/// as the user's new share; to change that relative to what it was, start from `user`.
///
/// The share of the elements is the force delivered, not the springs' own: together with an impulse
/// at the start of the step it makes the engine's few substeps end where the springs take the body.
#[derive(Component, Reflect, Clone, Debug)]
#[type_path = "bevy_coilover"]
#[reflect(Component, Debug, Clone)]
pub struct SpringLoad {
    /// Force (N) and torque (N m) delivered by elements over the last step, world frame.
    pub elements: ExternalForce,
    /// Force and torque that the user wrote.
    pub user: ExternalForce,
    /// Index of the body's row in the scene, if that row says so too.
    #[reflect(ignore)]
    pub(crate) slot: usize,
    /// We gave the body a second solver iteration.
    #[reflect(ignore)]
    raised_iterations: bool,
}

/// Loads of bodies, also of disabled ones: their share must be taken back too.
pub(crate) type Loads<'w, 's> = Query<
    'w,
    's,
    (
        Entity,
        &'static mut SpringLoad,
        Option<&'static mut ExternalForce>,
    ),
    Allow<Disabled>,
>;

/// Loads of bodies whose `ExternalForce` somebody has written since the last tick.
pub(crate) type ChangedLoads<'w, 's> = Query<
    'w,
    's,
    (Entity, &'static mut SpringLoad, &'static ExternalForce),
    (Changed<ExternalForce>, Allow<Disabled>),
>;

/// One of them.
type LoadsItem<'a> = (Entity, Mut<'a, SpringLoad>, Option<Mut<'a, ExternalForce>>);

/// Where bodies are in the engine, those of disabled ones too.
pub(crate) type Handles<'w, 's> = Query<
    'w,
    's,
    (
        &'static RapierRigidBodyHandle,
        &'static RapierContextEntityLink,
    ),
    Allow<Disabled>,
>;

/// Bodies above which it is worth waking other threads. Pinned by the benchmark `own/isolated`.
const WORTH_SHARING: usize = 4096;

/// In the crate's own numbers.
pub(crate) fn wrench(force: &ExternalForce) -> Wrench {
    Wrench {
        force: force.force,
        torque: force.torque,
    }
}

/// In the component's.
fn external(wrench: Wrench) -> ExternalForce {
    ExternalForce {
        force: wrench.force,
        torque: wrench.torque,
    }
}

/// What stands in a body's component for both shares.
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

    /// The shares of user and elements as they were, and what stands in the body's component for them.
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

    pub(crate) fn raised_iterations(&self) -> bool {
        self.raised_iterations
    }

    /// Takes in what the user wrote into a component that changed since the last step; says whether
    /// that is new.
    fn read_user(&mut self, now: &ExternalForce) -> bool {
        let before = self.user;
        // What we left in the component.
        let left = sum(&self.elements, &self.user);
        take_in(&mut self.user.force, now.force, left.force);
        take_in(&mut self.user.torque, now.torque, left.torque);
        self.user != before
    }

    /// Shows the shares, the sum without marking it changed: a change would make bevy_rapier write it
    /// again and keep the body awake for ever.
    fn show(&mut self, elements: ExternalForce, component: Option<&mut Mut<ExternalForce>>) {
        self.elements = elements;
        if let Some(component) = component {
            *component.bypass_change_detection() = sum(&elements, &self.user);
        }
    }
}

/// Takes in what users wrote since the last step. The engine wakes a body whose sum changes; ours must
/// wake when the user's share does.
pub(crate) fn read_users(scene: &mut Scene, mut changed: ChangedLoads) {
    scene.loaded = false;
    for (entity, mut load, component) in &mut changed {
        let load = load.bypass_change_detection();
        let new = load.read_user(component);
        scene.loaded |= new;
        if let Some(row) = scene.body(load.slot, entity) {
            if new {
                row.flags.insert(BodyFlags::DISTURBED);
            }
            row.set_user(wrench(&load.user));
        }
    }
}

/// Shows on every stepped body what it was given.
pub(crate) fn show(scene: &Scene, loads: &mut Loads) {
    if !scene.delivered {
        return;
    }
    let (bodies, tick) = (&scene.bodies, scene.tick);
    let show = |(entity, mut load, mut component): LoadsItem| {
        let row = bodies.get(load.slot).filter(|row| row.entity == entity);
        if let Some((row, share)) = row.and_then(|row| Some((row, row.share(tick)?))) {
            load.show(external(share), component.as_mut());
            load.raised_iterations |= row.has(BodyFlags::SECOND_SUBSTEP);
        }
    };
    if bodies.len() >= WORTH_SHARING && threads::count() > 1 {
        loads.par_iter_mut().for_each(show);
    } else {
        loads.iter_mut().for_each(show);
    }
}

/// Axes that differ from what we left there were written by the user.
fn take_in(share: &mut Vec3, now: Vec3, left: Vec3) {
    for axis in 0..3 {
        if now[axis].to_bits() != left[axis].to_bits() {
            share[axis] = now[axis];
        }
    }
}

/// Takes our share back from bodies that no element acts on any more; the user's shares have been read.
pub(crate) fn release(
    scene: &mut Scene,
    loads: &mut Loads,
    handles: &Handles,
    sets: &mut Query<&mut RapierRigidBodySet>,
    commands: &mut Commands,
) {
    for (entity, mut load, mut component) in loads {
        if scene.index.contains_key(&entity) {
            continue;
        }
        if let Ok((handle, link)) = handles.get(entity)
            && let Ok(mut set) = sets.get_mut(link.0)
            && let Some(body) = set.bodies.get_mut(handle.0)
        {
            let nothing = ExternalForce::default();
            body::give(body, &Push::default(), &wrench(&load.user));
            load.show(nothing, component.as_mut());
            if load.raised_iterations && body.additional_solver_iterations() == 1 {
                body.set_additional_solver_iterations(0);
            }
            body.wake_up(true);
        } else if let Some(component) = &mut component {
            // No body any more; one that comes later starts from the component.
            *component.bypass_change_detection() = load.user;
        }
        commands.entity(entity).try_remove::<SpringLoad>();
    }
}
