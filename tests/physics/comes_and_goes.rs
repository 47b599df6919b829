//! What a game changes between two systems of a tick, in a frame without a tick, or by copying and making anew.

use crate::harness::*;
use crate::named_ends::{ends, fault, hook, spring, weight};
use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use std::time::Duration;

/// A game with 240 pictures and 60 ticks a second: most frames have no tick.
fn many_frames(lab: &mut Lab) {
    let frame = Duration::from_secs_f32(DT / 4.0);
    lab.app
        .insert_resource(TimeUpdateStrategy::ManualDuration(frame));
    for _ in 0..8 {
        lab.tick();
    }
}

#[test]
fn what_makes_a_name_plain_counts_also_in_a_frame_without_a_tick() {
    type Deed = fn(&mut EntityWorldMut);
    let deeds: [Deed; 3] = [
        |two| {
            two.remove::<(Name, RigidBody)>();
        },
        |two| {
            two.remove::<Name>();
        },
        |two| {
            two.insert(Disabled);
        },
    ];
    for (number, deed) in deeds.into_iter().enumerate() {
        let mut lab = Lab::new();
        let a = lab.spawn(hook("Hook"));
        let [one, two] = [0, 1].map(|_| lab.spawn(weight("Wheel")));
        let element = lab.spawn(spring("Hook", "Wheel"));
        many_frames(&mut lab);
        assert!(fault(&lab, element).is_some(), "two wheels");
        for _ in 0..4 {
            // Somewhere among these frames is one without a tick.
            lab.tick();
        }
        deed(&mut lab.app.world_mut().entity_mut(two));
        for _ in 0..8 {
            lab.tick();
        }
        assert_eq!(fault(&lab, element), None, "deed {number}");
        assert_eq!(ends(&lab, element), [a, one]);
    }
}

#[test]
fn an_element_that_is_no_more_has_no_fault_though_it_waits_or_is_disabled() {
    let mut lab = Lab::new();
    let waits = lab.spawn(spring("Hook", "Weight"));
    let hidden = lab.spawn(Spring::new(waits, waits).with_stiffness(f32::NAN));
    lab.run(0.1);
    assert!(fault(&lab, waits).is_some() && fault(&lab, hidden).is_some());
    let world = lab.app.world_mut();
    world.entity_mut(hidden).insert(Disabled);
    world.entity_mut(hidden).remove::<Spring>();
    world.entity_mut(hidden).remove::<Disabled>();
    world.entity_mut(waits).remove::<SpringDamper>();
    lab.run(0.1);
    assert_eq!((fault(&lab, waits), fault(&lab, hidden)), (None, None));
}

/// A wall that the game lets go after the engine has read its changes, and before springs are prepared, moves one tick later.
#[test]
fn a_wall_that_is_let_go_between_two_systems_of_a_tick_is_pulled() {
    #[derive(Resource)]
    struct LetGo(Entity);
    let mut lab = Lab::new();
    let top = lab.spawn((
        RigidBody::Fixed,
        Transform::default(),
        AdditionalMassProperties::Mass(1.0),
    ));
    let low = lab.body(2.0, Vec3::NEG_Y);
    lab.spawn(
        SpringDamper::new(top, low)
            .with_stiffness(100.0)
            .with_damping(10.0),
    );
    let let_go = |wall: Res<LetGo>, mut commands: Commands| {
        commands.entity(wall.0).insert(RigidBody::Dynamic);
        commands.remove_resource::<LetGo>();
    };
    lab.app.add_systems(
        FixedUpdate,
        let_go
            .run_if(resource_exists::<LetGo>)
            .after(PhysicsSet::SyncBackend)
            .before(CoiloverSystems::Prepare),
    );
    lab.run(3.0);
    lab.app.insert_resource(LetGo(top));
    lab.run(1.0);
    let apart = lab.position(top).y - lab.position(low).y;
    assert!(lab.position(top).y < -3.0, "it falls");
    assert!((apart - 1.0).abs() < 0.02, "{apart} m apart");
}

/// A weight of 1 kg that hangs on a spring at rest, and the spring.
fn hung() -> (Lab, Entity, Entity) {
    let mut lab = Lab::new();
    let hook = lab.point(Vec3::ZERO);
    let weight = lab.body(1.0, Vec3::NEG_Y * 1.0981);
    let spring = SpringDamper::new(hook, weight)
        .with_stiffness(100.0)
        .with_damping(20.0)
        .with_rest_length(1.0);
    let spring = lab.spawn(spring);
    lab.run(1.0);
    (lab, weight, spring)
}

#[test]
fn a_load_that_is_taken_away_leaves_no_force_to_the_user() {
    for both in [false, true] {
        let (mut lab, weight, _) = hung();
        let before = lab.position(weight);
        let mut body = lab.app.world_mut().entity_mut(weight);
        if both {
            body.remove::<(SpringLoad, ExternalForce)>();
        } else {
            body.remove::<SpringLoad>();
        }
        lab.run(1.0);
        assert_eq!(lab.get::<SpringLoad>(weight).user, ExternalForce::default());
        let moved = lab.position(weight).distance(before);
        assert!(moved < 1e-4, "both {both}: {moved} m");
    }
}

#[test]
fn the_copy_of_a_body_that_hangs_on_a_spring_falls_freely() {
    let (mut lab, weight, _) = hung();
    let world = lab.app.world_mut();
    let copy = world
        .entity_mut(weight)
        .clone_and_spawn_with_opt_out(|copy| {
            copy.deny::<RapierRigidBodyHandle>();
        });
    lab.run(0.2);
    let speed = lab.velocity(copy).y;
    assert!((speed + 0.2 * 9.81).abs() < 0.2, "{speed} m/s");
    assert!(lab.app.world().get::<SpringLoad>(copy).is_none());
}

#[test]
fn a_body_that_is_made_anew_on_the_ground_keeps_no_force_of_its_spring() {
    let (mut lab, weight, spring) = hung();
    let ground = Collider::cuboid(5.0, 0.5, 5.0);
    lab.spawn((ground, Transform::from_xyz(0.0, -5.5, 0.0)));
    lab.get_mut::<SpringDamper>(spring).rest_length = Some(4.5);
    let mut body = lab.app.world_mut().entity_mut(weight);
    body.remove::<RigidBody>();
    body.insert((
        RigidBody::Dynamic,
        Collider::ball(0.5),
        Transform::from_xyz(0.0, -4.5, 0.0),
        Velocity::default(),
    ));
    lab.run(0.5);
    assert_eq!(lab.readout(spring).method, SpringMethod::Engine);
    let handle = lab.get::<RapierRigidBodyHandle>(weight).0;
    let world = lab.app.world_mut();
    let mut sets = world.query::<&RapierRigidBodySet>();
    let set = sets.single(world).expect("one context");
    assert_eq!(set.bodies[handle].user_force(), Vec3::ZERO);
}
