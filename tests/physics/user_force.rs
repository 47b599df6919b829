//! Does the user's own `ExternalForce` act exactly as without the plugin?

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// How the user changes the force from tick to tick.
#[derive(Clone, Copy, Debug)]
enum Habit {
    SetOnce,
    SetEveryTick,
    Changed,
    Cleared,
    OneAxisOnly,
    Torque,
    Reinserted,
    Removed,
}

const HABITS: [Habit; 8] = [
    Habit::SetOnce,
    Habit::SetEveryTick,
    Habit::Changed,
    Habit::Cleared,
    Habit::OneAxisOnly,
    Habit::Torque,
    Habit::Reinserted,
    Habit::Removed,
];

const PUSH: Vec3 = Vec3::new(3.0, 1.0, -2.0);

fn act(habit: Habit, tick: usize, lab: &mut Lab, body: Entity) {
    let world = lab.app.world_mut();
    let mut force = |f: &dyn Fn(&mut ExternalForce)| {
        let mut entity = world.entity_mut(body);
        if !entity.contains::<ExternalForce>() {
            entity.insert(ExternalForce::default());
        }
        f(&mut entity.get_mut::<ExternalForce>().expect("just inserted"));
    };
    match habit {
        Habit::SetOnce if tick == 0 => force(&|f| f.force = PUSH),
        Habit::SetEveryTick => force(&|f| f.force = PUSH * (tick as f32 * 0.1).sin()),
        Habit::Changed if tick == 0 => force(&|f| f.force = PUSH),
        Habit::Changed if tick == 30 => force(&|f| f.force = -2.0 * PUSH),
        Habit::Cleared if tick == 0 => force(&|f| f.force = PUSH),
        Habit::Cleared if tick == 30 => force(&|f| *f = ExternalForce::default()),
        Habit::OneAxisOnly if tick == 0 => force(&|f| f.force = PUSH),
        Habit::OneAxisOnly if tick == 20 => force(&|f| f.force.x = -4.0),
        Habit::OneAxisOnly if tick == 40 => force(&|f| f.force.z = 0.0),
        Habit::Torque if tick == 5 => force(&|f| f.torque = Vec3::new(0.1, 0.2, 0.3)),
        Habit::Reinserted if tick.is_multiple_of(7) => {
            let push = PUSH * tick as f32 * 0.1;
            world.entity_mut(body).insert(ExternalForce {
                force: push,
                ..default()
            });
        }
        Habit::Removed if tick == 0 => force(&|f| f.force = PUSH),
        Habit::Removed if tick == 30 => {
            world.entity_mut(body).remove::<ExternalForce>();
        }
        _ => {}
    }
}

/// Path of a body in free space whose force changes by `habit`. With an `element`, a spring-damper without stiffness
/// and damping is attached to it.
fn path(habit: Habit, mut lab: Lab, element: bool) -> Vec<(Vec3, Quat)> {
    let body = lab.body(2.0, Vec3::ZERO);
    lab.get_mut::<Velocity>(body).angular = Vec3::new(0.3, 0.0, 0.1);
    if element {
        let far = lab.point(Vec3::Y * 5.0);
        lab.spawn(
            SpringDamper::new(far, body)
                .with_stiffness(0.0)
                .with_damping(0.0),
        );
    }
    (0..60)
        .map(|tick| {
            act(habit, tick, &mut lab, body);
            lab.tick();
            let at = lab.get::<Transform>(body);
            (at.translation, at.rotation)
        })
        .collect()
}

#[test]
fn a_body_held_by_a_powerless_element_moves_as_without_the_plugin() {
    for habit in HABITS {
        let mut bare = Lab::without_plugin(Engine::default());
        bare.prime();
        let (with, without) = (path(habit, Lab::new(), true), path(habit, bare, false));
        // With substeps of h, the engine falls g·t·h/2 too far (see free_fall.rs). Constant forces have the same
        // error. A body with elements does not have it. The paths may differ by that error and no more.
        for (tick, ((x, r), (y, s))) in with.iter().zip(&without).enumerate() {
            let t = (tick + 1) as f32 * DT;
            let substep = DT / 4.0;
            let bar = 0.5 * t * substep * (9.81 + 2.0 * PUSH.length()) + 2e-5;
            assert!(
                x.distance(*y) < bar,
                "{habit:?}, tick {tick}: {x} against {y}"
            );
            assert!(
                r.angle_between(*s) < 1e-3,
                "{habit:?}, tick {tick}: {r} against {s}"
            );
        }
    }
}

/// Hides entities. It is not kept in tables.
#[derive(Component)]
#[component(storage = "SparseSet")]
struct Hidden;

#[test]
fn a_game_may_hide_entities_with_a_component_that_is_not_kept_in_tables() {
    for habit in HABITS {
        let mut hiding = Lab::without_plugin(Engine::default());
        let world = hiding.app.world_mut();
        world.register_disabling_component::<Hidden>();
        hiding.app.add_plugins(CoiloverPlugin::default());
        hiding.prime();
        let [with, without] = [hiding, Lab::new()].map(|lab| path(habit, lab, true));
        assert_eq!(with, without, "{habit:?}");
    }
}

/// The component contains the sum of the user's force and the elements' force. The engine has the same force.
#[test]
fn the_component_shows_the_sum_and_the_load_keeps_the_shares_apart() {
    let mut lab = Lab::new();
    let hook = lab.point(Vec3::ZERO);
    let body = lab.body(2.0, Vec3::NEG_Y);
    lab.spawn(
        Spring::new(hook, body)
            .with_stiffness(500.0)
            .with_rest_length(1.1),
    );
    for tick in 0..120 {
        if tick == 50 {
            lab.get_mut::<ExternalForce>(body).force = PUSH;
        }
        if tick == 90 {
            lab.get_mut::<ExternalForce>(body).force = Vec3::ZERO;
        }
        lab.tick();
        let force = *lab.get::<ExternalForce>(body);
        let load = lab.get::<SpringLoad>(body).clone();
        assert_eq!(force, load.user + load.elements);
        let user = if (50..90).contains(&tick) {
            PUSH
        } else {
            Vec3::ZERO
        };
        assert_eq!(load.user.force, user, "tick {tick}");
        let set = lab
            .app
            .world_mut()
            .query::<&RapierRigidBodySet>()
            .single(lab.app.world())
            .expect("one context");
        let engine = set
            .bodies
            .get(set.entity2body()[&body])
            .expect("the body")
            .user_force();
        assert_eq!(engine, force.force, "tick {tick}");
    }
}

/// The user's 5 N hold a body against a spring. After 20 s it is at rest: the sum of both forces is zero.
fn balanced() -> (Lab, Entity) {
    let mut lab = Lab::weightless();
    let hook = lab.point(Vec3::ZERO);
    let body = lab.body(1.0, Vec3::X * 1.5);
    lab.spawn(
        SpringDamper::new(hook, body)
            .with_stiffness(10.0)
            .with_damping(5.0)
            .with_rest_length(1.0),
    );
    lab.spawn_force(body, Vec3::X * 5.0);
    lab.run(20.0);
    (lab, body)
}

#[test]
fn clearing_a_share_that_balances_the_spring_counts() {
    let (mut lab, body) = balanced();
    assert!((lab.position(body).x - 1.5).abs() < 1e-3);
    *lab.get_mut::<ExternalForce>(body) = ExternalForce::default();
    lab.run(20.0);
    assert!(
        (lab.position(body).x - 1.0).abs() < 1e-3,
        "{}",
        lab.position(body).x
    );
}

#[test]
fn nothing_of_ours_is_left_behind() {
    enum End {
        Removed,
        Despawned,
        Disabled,
        PartnerGone,
        Broken,
    }
    for end in [
        End::Removed,
        End::Despawned,
        End::Disabled,
        End::PartnerGone,
        End::Broken,
    ] {
        let mut lab = Lab::weightless();
        let hook = lab.point(Vec3::ZERO);
        let body = lab.body(1.0, Vec3::X * 2.0);
        let element = lab.spawn(
            Spring::new(hook, body)
                .with_stiffness(50.0)
                .with_rest_length(1.0),
        );
        lab.spawn_force(body, Vec3::Y);
        lab.run(0.2);
        let world = lab.app.world_mut();
        match end {
            End::Removed => {
                world.entity_mut(element).remove::<Spring>();
            }
            End::Despawned => {
                world.despawn(element);
            }
            End::Disabled => {
                world
                    .entity_mut(element)
                    .insert(bevy::ecs::entity_disabling::Disabled);
            }
            End::PartnerGone => {
                world.despawn(hook);
            }
            End::Broken => {
                world
                    .entity_mut(element)
                    .get_mut::<Spring>()
                    .expect("there")
                    .stiffness = f32::NAN;
            }
        }
        let before = lab.velocity(body);
        lab.run(0.1);
        let change = lab.velocity(body) - before;
        assert!(change.distance(Vec3::Y * 0.1) < 1e-5, "{change}");
        assert_eq!(lab.get::<ExternalForce>(body).force, Vec3::Y);
        assert!(lab.app.world().get::<SpringLoad>(body).is_none());
    }
}

/// When a body gets its rigid body back, the elements' share must not be taken for a force of the user.
#[test]
fn a_body_that_loses_its_rigid_body_keeps_only_the_users_share() {
    let mut lab = Lab::weightless();
    let hook = lab.point(Vec3::ZERO);
    let body = lab.body(1.0, Vec3::X * 2.0);
    lab.spawn(
        Spring::new(hook, body)
            .with_stiffness(50.0)
            .with_rest_length(1.0),
    );
    lab.spawn_force(body, Vec3::Y);
    lab.run(0.1);
    lab.app.world_mut().entity_mut(body).remove::<RigidBody>();
    lab.run(0.1);
    assert_eq!(lab.get::<ExternalForce>(body).force, Vec3::Y);
    lab.app
        .world_mut()
        .entity_mut(body)
        .insert(RigidBody::Dynamic);
    lab.run(0.1);
    assert_eq!(lab.get::<SpringLoad>(body).user.force, Vec3::Y);
}

/// Rapier keeps the force of a body that is fixed for a time, but does not show it.
#[test]
fn a_body_that_is_let_go_has_only_the_users_force_and_torque() {
    for held in [RigidBody::Fixed, RigidBody::KinematicVelocityBased] {
        let mut lab = Lab::weightless();
        let hook = lab.point(Vec3::ZERO);
        let load = lab.body(1.0, Vec3::X * 2.0);
        let spring = Spring::new(hook, load).with_stiffness(50.0);
        let spring = lab.spawn((
            spring.with_rest_length(1.0),
            Anchors::new(Vec3::ZERO, Vec3::Y * 0.3),
        ));
        lab.spawn_force(load, Vec3::Y);
        lab.run(0.1);
        lab.app.world_mut().entity_mut(load).insert(held);
        lab.run(0.1);
        lab.app.world_mut().despawn(spring);
        let mut body = lab.app.world_mut().entity_mut(load);
        body.insert((RigidBody::Dynamic, Velocity::default()));
        lab.run(0.1);
        let gained = *lab.get::<Velocity>(load);
        let gained = [gained.linear, gained.angular];
        assert!(
            gained[0].distance(Vec3::Y * 0.1) < 1e-5,
            "{held:?}: {gained:?}"
        );
        assert_eq!(gained[1], Vec3::ZERO, "{held:?}: it turns by itself");
    }
}

#[test]
fn an_assignment_to_a_sum_of_zero_counts_on_every_axis() {
    let (mut lab, body) = balanced();
    lab.get_mut::<ExternalForce>(body).force = Vec3::Z * 0.1;
    lab.tick();
    assert_eq!(lab.get::<SpringLoad>(body).user.force, Vec3::Z * 0.1);
}
