//! Builds a problem in Rapier, with bevy_coilover's springs, Rapier's own joints, or a force written once per step.

use super::State;
use crate::method::{Dial, Method, Setting};
use crate::problem::{Body, Kind, Link, Problem};
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use bevy_rapier3d::rapier::dynamics::IntegrationParameters;

/// Natural frequency of contacts with the ground, Hz. At Rapier's default, 60 Hz, the contact acts as a second spring in
/// series with the spring of the quarter car, whose reference solution assumes a wheel that stands still.
pub const GROUND_FREQUENCY: f32 = 1000.0;

/// Rapier's limit on the speed of bodies, m/s. Its default of 400 m/s would slow a body that a released spring moves by
/// 3 m in one step of 1/240 s.
const FASTEST: f32 = 1e4;

/// The plugin's default of `with_resolve`.
const RESOLVE: u32 = 1024;

/// Adds Rapier and what the method needs.
pub fn plug(app: &mut App, gravity: Vec3, ground: Option<f32>, setting: Setting) {
    let mut parameters = IntegrationParameters {
        normalized_max_linear_velocity: FASTEST,
        ..Default::default()
    };
    if let Dial::Iterations(n) = setting.dial {
        parameters.num_solver_iterations = n as usize;
    }
    if let Some(frequency) = ground {
        parameters.static_contact_softness.natural_frequency = frequency;
    }
    let initialization = RapierContextInitialization::InitializeDefaultRapierContext {
        integration_parameters: parameters,
        rapier_configuration: RapierConfiguration {
            gravity,
            ..RapierConfiguration::new(1.0)
        },
    };
    app.insert_resource(TimestepMode::Fixed {
        dt: setting.dt() as f32,
        substeps: 1,
    })
    .add_plugins(
        RapierPhysicsPlugin::<NoUserData>::default()
            .in_fixed_schedule()
            .with_custom_initialization(initialization),
    );
    match setting.method {
        Method::Ours => {
            let plugin = CoiloverPlugin::default();
            app.add_plugins(match setting.dial {
                // The plugin's default, in which stiff springs get more micro-steps by themselves.
                Dial::Microsteps(1) => plugin,
                Dial::Microsteps(n) => plugin.with_microsteps(n),
                Dial::Extrapolated(1) => plugin.with_extrapolation(),
                // As by default, stiff springs get more micro-steps.
                Dial::Extrapolated(n) => plugin
                    .with_microsteps(n)
                    .with_resolve(RESOLVE)
                    .with_extrapolation(),
                Dial::Tolerance(n) => plugin.with_tolerance(10.0_f32.powi(-(n as i32))),
                _ => plugin,
            });
        }
        Method::Force => {
            app.add_systems(FixedUpdate, pull.before(PhysicsSet::SyncBackend));
        }
        Method::Joint | Method::Avian | Method::AvianBare => {}
    }
}

/// Spawns the method's spring between two bodies.
pub fn spring(world: &mut World, link: &Link, [a, b]: [Entity; 2], method: Method) {
    match method {
        Method::Ours => {
            let element = SpringDamper::new(a, b)
                .with_stiffness(link.stiffness)
                .with_damping(link.damping)
                .with_rest_length(link.rest);
            let mut element = world.spawn(element);
            if link.cubic > 0.0 {
                element.insert(SpringLaw::polynomial(link.stiffness, 0.0, link.cubic));
            }
            if link.anchors != [Vec3::ZERO; 2] {
                element.insert(Anchors::new(link.anchors[0], link.anchors[1]));
            }
        }
        Method::Joint => {
            let joint = SpringJointBuilder::new(link.rest, link.stiffness, link.damping)
                .local_anchor1(link.anchors[0])
                .local_anchor2(link.anchors[1]);
            let joint = ImpulseJoint::new(a, joint);
            if world.get::<ImpulseJoint>(b).is_none() {
                world.entity_mut(b).insert(joint);
            } else {
                // An entity holds one `ImpulseJoint`, so further joints of a body are on child entities.
                world.spawn((joint, ChildOf(b)));
            }
        }
        Method::Force => {
            world.spawn(Pull {
                ends: [a, b],
                link: *link,
            });
        }
        Method::Avian | Method::AvianBare => {}
    }
}

/// Spawns the ground, the bodies and the springs. Returns the bodies.
pub fn fill(world: &mut World, problem: &Problem, method: Method) -> Vec<Entity> {
    if problem.ground
        && let Some(plane) = Collider::halfspace(Vec3::Y)
    {
        world.spawn((plane, Transform::default()));
    }
    let bodies: Vec<Entity> = problem.bodies.iter().map(|b| spawn(world, b)).collect();
    for link in &problem.links {
        spring(world, link, link.ends.map(|end| bodies[end]), method);
    }
    if method == Method::Force {
        for (body, entity) in problem.bodies.iter().zip(&bodies) {
            if body.inverse_mass() > 0.0 {
                world.entity_mut(*entity).insert(ExternalForce::default());
            }
        }
    }
    bodies
}

fn spawn(world: &mut World, body: &Body) -> Entity {
    let at = Transform::from_translation(body.at);
    let upright = LockedAxes::TRANSLATION_LOCKED_X
        | LockedAxes::TRANSLATION_LOCKED_Z
        | LockedAxes::ROTATION_LOCKED;
    let weight = |mass: f32, principal_inertia: Vec3| {
        AdditionalMassProperties::MassProperties(MassProperties {
            mass,
            principal_inertia,
            ..default()
        })
    };
    let moving = (
        RigidBody::Dynamic,
        at,
        Velocity {
            linear: body.velocity,
            angular: body.spin,
        },
        // A sleeping body takes no computing time, so the measured time would mean nothing.
        Sleeping::disabled(),
    );
    match body.kind {
        Kind::Fixed => world.spawn((RigidBody::Fixed, at, Velocity::default())),
        Kind::Free { mass, inertia } => world.spawn((moving, weight(mass, inertia))),
        Kind::Upright { mass } => {
            world.spawn((moving, weight(mass, Vec3::splat(0.4 * mass)), upright))
        }
        Kind::Wheel { mass, radius } => world.spawn((
            moving,
            Collider::ball(radius),
            ColliderMassProperties::Mass(mass),
            upright,
        )),
    }
    .id()
}

pub fn read(world: &World, entity: Entity) -> Option<State> {
    let (at, v) = (
        world.get::<Transform>(entity)?,
        world.get::<Velocity>(entity)?,
    );
    Some(State {
        position: at.translation.as_dvec3(),
        rotation: at.rotation.as_dquat(),
        velocity: v.linear.as_dvec3(),
        spin: v.angular.as_dvec3(),
    })
}

/// A spring as tutorials write it: a force set once per step.
#[derive(Component)]
struct Pull {
    ends: [Entity; 2],
    link: Link,
}

/// Writes tension = k · stretch + c · rate, plus the cubic term, along the spring as the force for the next step.
fn pull(
    pulls: Query<&Pull>,
    bodies: Query<(&Transform, &Velocity)>,
    mut forces: Query<&mut ExternalForce>,
) {
    for mut force in &mut forces {
        *force = ExternalForce::default();
    }
    for Pull { ends, link } in &pulls {
        let Ok([(at_a, v_a), (at_b, v_b)]) = bodies.get_many(*ends) else {
            continue;
        };
        let arms = [
            at_a.rotation * link.anchors[0],
            at_b.rotation * link.anchors[1],
        ];
        let apart = at_b.translation + arms[1] - at_a.translation - arms[0];
        let speeds = [
            v_a.linear + v_a.angular.cross(arms[0]),
            v_b.linear + v_b.angular.cross(arms[1]),
        ];
        let along = apart.normalize_or_zero();
        let rate = (speeds[1] - speeds[0]).dot(along);
        let stretch = apart.length() - link.rest;
        let tension = link.stiffness * stretch + link.cubic * stretch.powi(3) + link.damping * rate;
        for ((end, arm), sign) in ends.iter().zip(arms).zip([1.0, -1.0]) {
            if let Ok(mut force) = forces.get_mut(*end) {
                force.force += sign * tension * along;
                force.torque += arm.cross(sign * tension * along);
            }
        }
    }
}
