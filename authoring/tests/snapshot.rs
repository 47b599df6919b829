//! Tests that a snapshot is unchanged after it was written as text and read back.

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// A load on a spring over a foot on the ground, and a spinning wheel that hangs on a spring and winds up a torsion spring.
fn scene() -> (App, Vec<Entity>) {
    let mut app = app();
    app.add_plugins(CoiloverPlugin::default().with_tolerance(1e-4));
    app.finish();
    app.cleanup();
    app.update();
    let world = app.world_mut();
    world.spawn((
        Collider::halfspace(Vec3::Y).expect("up"),
        Transform::default(),
    ));
    let body = |at: Vec3| {
        (
            RigidBody::Dynamic,
            Transform::from_translation(at),
            Collider::cuboid(0.1, 0.1, 0.1),
            ColliderMassProperties::Mass(2.0),
            Velocity::default(),
        )
    };
    let foot = world.spawn(body(Vec3::Y * 0.3)).id();
    let load = world.spawn(body(Vec3::Y * 1.0)).id();
    let strut = SpringDamper::new(foot, load).with_stiffness(900.0);
    let strut = world
        .spawn((strut.with_damping(5.0), SpringAction::Push))
        .id();
    let frame = world.spawn(Transform::from_xyz(0.0, 3.0, 3.0)).id();
    let wheel = world.spawn(body(Vec3::new(0.0, 3.0, 3.0))).id();
    let post = world.spawn((RigidBody::Fixed, Transform::default())).id();
    world
        .entity_mut(wheel)
        .insert(Velocity::angular(Vec3::X * 30.0));
    world.spawn(TorsionSpring::new(post, wheel, Vec3::X).with_stiffness(0.02));
    let hang = world
        .spawn(SpringDamper::new(frame, wheel).with_stiffness(300.0))
        .id();
    (app, vec![foot, load, wheel, strut, hang])
}

fn bits(app: &App, cast: &[Entity]) -> Vec<u32> {
    let mut all = Vec::new();
    for entity in cast {
        if let Some(place) = app.world().get::<Transform>(*entity) {
            all.extend(place.translation.to_array());
            all.extend(place.rotation.to_array());
        }
        if let Some(seen) = app.world().get::<SpringReadout>(*entity) {
            all.extend([
                seen.length,
                seen.rate,
                seen.spring_force,
                seen.dissipated_energy,
            ]);
        }
    }
    all.into_iter().map(f32::to_bits).collect()
}

fn read_again<T: serde::Serialize + serde::de::DeserializeOwned>(snapshot: &T) -> T {
    let text = ron::to_string(snapshot).expect("it can be written");
    println!("{} bytes", text.len());
    ron::from_str(&text).expect("it can be read")
}

#[test]
fn a_snapshot_that_was_written_down_is_the_same() {
    let (mut app, cast) = scene();
    for ticks in [1, 30, 200] {
        for _ in 0..ticks {
            app.update();
        }
        let engine = RapierSnapshot::take(app.world());
        let springs = read_again(&CoiloverSnapshot::take(app.world()));
        let watch = |app: &mut App| -> Vec<Vec<u32>> {
            let tick = |_| {
                app.update();
                bits(app, &cast)
            };
            (0..200).map(tick).collect()
        };
        let first = watch(&mut app);
        engine.restore(app.world_mut()).expect("Rapier's side fits");
        springs
            .restore(app.world_mut())
            .expect("the springs' side fits");
        assert_eq!(first, watch(&mut app), "after {ticks} more ticks");
    }
}

#[test]
fn what_was_written_wrong_is_told() {
    let (mut app, _) = scene();
    for _ in 0..30 {
        app.update();
    }
    let text = ron::to_string(&CoiloverSnapshot::take(app.world())).expect("it can be written");
    let start = text.find("on:(").expect("ends") + "on:(".len();
    let end = start + text[start..].find(',').expect("two of them");
    let wrong = format!("{}77{}", &text[..start], &text[end..]);
    let wrong: CoiloverSnapshot = ron::from_str(&wrong).expect("it can be read");
    assert_eq!(wrong.restore(app.world_mut()), Err(SnapshotError::Broken));
}
