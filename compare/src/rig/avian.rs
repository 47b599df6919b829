//! Builds a problem in Avian, with its distance joint as the spring.
//!
//! The joint's compliance is 1/k. Its damping is a rate (1/s) at which the whole relative velocity of the two centres
//! decays, across the line of the spring as well as along it. The closest match to a damper of c is c divided by the
//! effective mass.

use super::State;
use crate::method::{Dial, Method};
use crate::problem::{Body, Kind, Link, Problem};
use avian3d::prelude::*;
use bevy::prelude::*;

/// Adds Avian's plugins, gravity and number of substeps.
pub fn plug(app: &mut App, gravity: Vec3, dial: Dial) {
    app.add_plugins(PhysicsPlugins::new(FixedUpdate))
        .insert_resource(Gravity(gravity));
    if let Dial::Substeps(n) = dial {
        app.insert_resource(SubstepCount(n));
    }
}

/// Spawns the ground, the bodies and the joints. Returns the bodies.
pub fn fill(world: &mut World, problem: &Problem, method: Method) -> Vec<Entity> {
    if problem.ground {
        world.spawn((
            RigidBody::Static,
            Collider::half_space(Vec3::Y),
            Transform::default(),
        ));
    }
    let bodies: Vec<Entity> = problem.bodies.iter().map(|b| spawn(world, b)).collect();
    for link in &problem.links {
        let inverse = link.ends.map(|end| problem.bodies[end].inverse_mass());
        let ends = link.ends.map(|end| bodies[end]);
        spring(world, link, ends, inverse[0] + inverse[1], method);
    }
    bodies
}

/// Spawns a joint between two bodies. `inverse` is the sum of their inverse masses, 1/kg.
pub fn spring(world: &mut World, link: &Link, [a, b]: [Entity; 2], inverse: f32, method: Method) {
    let joint = DistanceJoint::new(a, b)
        .with_local_anchor1(link.anchors[0])
        .with_local_anchor2(link.anchors[1])
        .with_limits(link.rest, link.rest)
        .with_compliance(link.stiffness.recip());
    let mut joint = world.spawn(joint);
    if link.damping > 0.0 && method == Method::Avian {
        joint.insert(JointDamping {
            linear: link.damping * inverse,
            angular: 0.0,
        });
    }
}

fn spawn(world: &mut World, body: &Body) -> Entity {
    let at = Transform::from_translation(body.at);
    let upright = LockedAxes::ROTATION_LOCKED
        .lock_translation_x()
        .lock_translation_z();
    let moving = (
        RigidBody::Dynamic,
        at,
        LinearVelocity(body.velocity),
        AngularVelocity(body.spin),
        SleepingDisabled,
    );
    match body.kind {
        Kind::Fixed => world.spawn((RigidBody::Static, at)),
        Kind::Free { mass, inertia } => {
            world.spawn((moving, Mass(mass), AngularInertia::new(inertia)))
        }
        Kind::Upright { mass } => {
            let inertia = AngularInertia::new(Vec3::splat(0.4 * mass));
            world.spawn((moving, Mass(mass), inertia, upright))
        }
        Kind::Wheel { mass, radius } => {
            world.spawn((moving, Mass(mass), Collider::sphere(radius), upright))
        }
    }
    .id()
}

pub fn read(world: &World, entity: Entity) -> Option<State> {
    let (at, rotation) = (
        world.get::<Position>(entity)?,
        world.get::<Rotation>(entity)?,
    );
    let velocity = world.get::<LinearVelocity>(entity);
    let spin = world.get::<AngularVelocity>(entity);
    Some(State {
        position: at.0.as_dvec3(),
        rotation: rotation.0.as_dquat(),
        velocity: velocity.map_or(Vec3::ZERO, |v| v.0).as_dvec3(),
        spin: spin.map_or(Vec3::ZERO, |w| w.0).as_dvec3(),
    })
}
