//! Long runs of scenes from games: a car that drives and a ragdoll that lies for ten minutes, and a bridge that comes to rest.

use super::bridge::bridge;
use super::drive::{LAW, car};
use super::ragdoll::{Muscle, ragdoll};
use super::stand::{SceneSpring, Stand};
use crate::dice::some;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

const MINUTES: usize = 10;

/// Torque on each wheel that holds the car's speed, N m. `short` is the speed it lacks in m/s.
fn drive(short: f32) -> Vec3 {
    Vec3::NEG_Z * (400.0 * short).clamp(-300.0, 300.0)
}

#[test]
fn a_car_that_drives_stands_as_high_in_the_tenth_minute_as_in_the_first() {
    let speed = 12.0;
    for kind in some(["cylinder", "ball"]) {
        let mut car = car(CoiloverPlugin::default(), kind, 0.0, speed, LAW);
        for wheel in &car.wheels {
            let world = car.scene.lab.app.world_mut();
            world.entity_mut(*wheel).insert(ExternalForce::default());
        }
        car.scene.lab.run(3.0);
        for minute in 1..=MINUTES {
            let ticks = car.scene.lab.ticks(60.0);
            let (mut mean, mut worst) = (0.0, 0.0_f64);
            for _ in 0..ticks {
                let short = speed - car.scene.lab.velocity(car.chassis).x;
                for wheel in &car.wheels {
                    car.scene.lab.get_mut::<ExternalForce>(*wheel).torque = drive(short);
                }
                car.scene.lab.tick();
                let sag = car.sag() / car.theory();
                mean += sag / ticks as f64;
                worst = worst.max((sag - 1.0).abs());
            }
            let now = car.scene.lab.velocity(car.chassis).length();
            println!(
                "{kind} wheels, minute {minute}: sag × {mean:.4}, at worst {worst:.4} off, {now:.3} m/s, up {:.5}",
                car.up()
            );
            assert!((mean - 1.0).abs() < 5e-3, "{kind}, {minute}: {mean}");
            assert!(worst < 0.03, "{kind}, {minute}: {worst}");
            assert!(car.up() > 0.999, "{kind}, {minute}");
            assert!(now > 11.9 && now < 12.6, "{kind}, {minute}: {now} m/s");
        }
        for wheel in &car.wheels {
            car.scene.lab.get_mut::<ExternalForce>(*wheel).torque = Vec3::ZERO;
        }
        car.brake();
        car.scene.lab.run(15.0);
        assert_eq!(car.scene.awake(), 0, "{kind}: it stops and sleeps");
    }
}

#[test]
fn a_ragdoll_that_has_fallen_lies_for_ten_minutes() {
    for muscle in [Muscle::Torsion(30.0), Muscle::Linear(30e3)] {
        let mut scene = ragdoll(CoiloverPlugin::default(), muscle);
        scene.lab.run(20.0);
        assert_eq!(scene.awake(), 0, "{muscle:?}");
        let far = scene.wander(60.0 * MINUTES as f64);
        assert_eq!((far, scene.awake()), (0.0, 0), "{muscle:?}");
    }
}

/// Vertical force of a rope on its lower end, N.
fn lift(scene: &Stand, rope: &SceneSpring) -> f64 {
    let [a, b] = [0, 1].map(|end| {
        let holder = scene.lab.get::<Transform>(rope.ends[end]);
        holder.transform_point(rope.anchors[end]).as_dvec3()
    });
    let length = a.distance(b);
    let tension = f64::from(rope.stiffness) * (length - f64::from(rope.rest_length));
    tension * (a.y - b.y).abs() / length
}

#[test]
fn a_bridge_comes_to_rest_under_its_load() {
    // Without hinges the bridge falls by half a metre before its springs bear it. One in twelve
    // boxes of 46 to 55 kg slides off then.
    for (k, load, hinged, still_after) in some([
        (5e5, 100.0, true, 2.0),
        (2e4, 100.0, true, 2.0),
        (5e5, 52.0, false, 3.0),
    ]) {
        let mut scene = bridge(k, load, hinged);
        let world = scene.lab.app.world_mut();
        // This damps the stretching of the ropes at once. No rope damps swinging sideways.
        for mut rope in world.query::<&mut SpringDamper>().iter_mut(world) {
            rope.damping *= 10.0;
        }
        scene.lab.run(60.0 * still_after);
        let far = scene.wander(30.0);
        println!(
            "bridge, {k} N/m, boxes of {load} kg, hinged {hinged}: after {still_after} min {} awake, {far:.1e} m in 30 s, {:.1e} m/s",
            scene.awake(),
            scene.speed()
        );
        let low = |body: &Entity| scene.lab.position(*body).y < 0.0;
        assert!(
            !scene.bodies.iter().any(low),
            "{k}, {hinged}: all are on it"
        );
        if hinged {
            assert_eq!(scene.awake(), 0, "{k}: it sleeps");
            // All its springs are at the banks. Together they carry everything between the banks.
            let carried: f64 = scene.coils.iter().map(|rope| lift(&scene, rope)).sum();
            let share = carried / ((30.0 * 4.0 + 3.0 * f64::from(load)) * scene.gravity);
            println!("bridge, {k} N/m: its banks carry {share:.5} of its weight");
            // It falls asleep during its last swing, at a few mm/s, and not exactly in balance.
            assert!((share - 1.0).abs() < 1e-2, "{k}: {share}");
        } else {
            assert!(scene.speed() < 0.02, "{k}: {} m/s", scene.speed());
        }
    }
}
