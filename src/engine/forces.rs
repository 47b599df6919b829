//! One `ExternalForce` per body, two owners: the user's share and ours, kept apart.

use super::held::{Expected, Support};
use super::sleep::Rest;
use super::solve::Loads;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use bevy_rapier3d::rapier::dynamics::RigidBody as RapierBody;

/// On a body that elements act on: their share of what stands in its `ExternalForce`.
///
/// `ExternalForce` holds the sum of both shares after every step. Whatever is assigned to it is taken
/// as the user's new share; to change that relative to what it was, start from `user`.
///
/// The share of the elements is the force delivered, not the springs' own: together with an impulse
/// at the start of the step it makes the engine's few substeps end where the springs take the body.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Debug, Clone)]
pub struct SpringLoad {
    /// Force (N) and torque (N m) delivered by elements over the last step, world frame.
    pub elements: ExternalForce,
    /// Force and torque that the user wrote.
    pub user: ExternalForce,
    /// What we left in the component.
    #[reflect(ignore)]
    pub(super) mirrored: ExternalForce,
    /// Since when and where the body has been at rest.
    #[reflect(ignore)]
    pub(super) rest: Option<Rest>,
    /// How much of a free body's motion contacts and joints leave it; see [`super::held`].
    #[reflect(ignore)]
    pub(super) mobility: f64,
    /// What keeps the body from moving freely.
    #[reflect(ignore)]
    pub(super) support: Support,
    /// What the coming step is to do.
    #[reflect(ignore)]
    pub(super) expected: Option<Expected>,
    /// Which elements load the body; a change wakes it.
    #[reflect(ignore)]
    pub(super) signature: u64,
    /// The user's share changed since the last step.
    #[reflect(ignore)]
    pub(super) disturbed: bool,
    /// We gave the body a second solver iteration.
    #[reflect(ignore)]
    pub(super) raised_iterations: bool,
}

impl SpringLoad {
    pub(super) fn new(user: ExternalForce) -> Self {
        Self {
            elements: ExternalForce::default(),
            user,
            mirrored: user,
            rest: None,
            mobility: 1.0,
            support: Support::Unknown,
            expected: None,
            signature: 0,
            disturbed: true,
            raised_iterations: false,
        }
    }

    /// Takes in what the user wrote into a component that changed since the last step.
    pub(super) fn read_user(&mut self, now: &ExternalForce) {
        let before = self.user;
        take_in(&mut self.user.force, now.force, self.mirrored.force);
        take_in(&mut self.user.torque, now.torque, self.mirrored.torque);
        // The engine wakes a body whose sum changes; ours must wake when the user's share does.
        self.disturbed |= self.user != before;
    }

    /// Puts both shares into the engine, and into the component without marking it changed: a change
    /// would make bevy_rapier write it again and keep the body awake for ever.
    pub(super) fn write(
        &mut self,
        elements: ExternalForce,
        body: &mut RapierBody,
        component: Option<&mut Mut<ExternalForce>>,
    ) {
        let finite = elements.force.is_finite() && elements.torque.is_finite();
        self.elements = if finite {
            elements
        } else {
            ExternalForce::default()
        };
        let elements = self.elements;
        self.mirrored = ExternalForce {
            force: told_apart(self.user.force + elements.force, self.user.force),
            torque: told_apart(self.user.torque + elements.torque, self.user.torque),
        };
        body.reset_forces(false);
        body.reset_torques(false);
        body.add_force(self.mirrored.force, false);
        body.add_torque(self.mirrored.torque, false);
        if let Some(component) = component {
            *component.bypass_change_detection() = self.mirrored;
        }
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

/// A sum that happens to be zero is left as the smallest number instead, so that a user who clears it
/// changes it.
fn told_apart(sum: Vec3, user: Vec3) -> Vec3 {
    let hidden = sum.cmpeq(Vec3::ZERO) & user.cmpne(Vec3::ZERO);
    Vec3::select(hidden, Vec3::splat(f32::MIN_POSITIVE), sum)
}

/// Takes our share back from bodies that no element acts on any more; the user's shares have been read.
pub(super) fn release(
    loads: &mut Loads,
    sets: &mut Query<&mut RapierRigidBodySet>,
    is_loaded: impl Fn(Entity) -> bool,
    commands: &mut Commands,
) {
    for (entity, mut load, mut component, handle, link) in loads {
        if is_loaded(entity) {
            continue;
        }
        if let (Some(handle), Some(link)) = (handle, link)
            && let Ok(mut set) = sets.get_mut(link.0)
            && let Some(body) = set.bodies.get_mut(handle.0)
        {
            load.write(ExternalForce::default(), body, component.as_mut());
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
