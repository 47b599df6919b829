//! A heavy ball on a bridge of planks: how hard the ropes pull while it crosses, and whether it stays on.

use super::between_planks::*;
use super::stand::*;
use crate::harness::*;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;

const RADIUS: f32 = 0.35;
/// Mass of the ball, kg.
const BALL: f32 = 10.0 * PLANK;
/// Height of the ball above the middle of a plank that it lies on, m.
const ABOVE: f32 = RADIUS + 0.03;

fn put_kerbs(scene: &mut Stand) {
    for plank in scene.bodies.clone() {
        for z in [-0.47, 0.47] {
            scene.lab.spawn((
                Collider::cuboid(0.4 * PITCH, 0.08, 0.03),
                ColliderMassProperties::Mass(0.0),
                Transform::from_xyz(0.0, 0.11, z),
                ChildOf(plank),
            ));
        }
    }
}

/// Puts a ball that rolls along x.
fn put_ball(scene: &mut Stand, at: Vec3, speed: f32) -> Entity {
    let rolling = Velocity {
        linear: Vec3::X * speed,
        angular: Vec3::NEG_Z * speed / RADIUS,
    };
    let ball = (
        Collider::ball(RADIUS),
        ColliderMassProperties::Mass(BALL),
        Friction::new(0.8),
        drag(0.05),
        rolling,
        ExternalForce::default(),
    );
    scene.body(Transform::from_translation(at), ball)
}

/// The guide's bridge with kerbs, at rest after a level start. It sinks in thicker air, so that it rests sooner.
fn level_start() -> Stand {
    let sinking = Bridge {
        pull: None,
        air: 2.0,
        ..GUIDE
    };
    let mut scene = sinking.put();
    put_kerbs(&mut scene);
    scene.lab.run(8.0);
    for plank in scene.bodies.clone() {
        *scene.lab.get_mut::<Damping>(plank) = drag(GUIDE.air);
    }
    scene
}

/// Greatest force of a rope at rest after a level start, N, with a mass on the middle of the bridge.
///
/// A flat curve is longer than its span L by L/2 times the mean square of its slope V/H, and the ropes by H/k.
fn at_rest(load: f32) -> f32 {
    let (weight, load) = (GUIDE.weight(), load * GRAVITY as f32);
    let stiffness = 2.0 * STIFFNESS / (GUIDE.planks + 1) as f32;
    let mean = load * load / 4.0 + load * weight / 4.0 + weight * weight / 12.0;
    let pull = (0.5 * stiffness * GUIDE.span() * mean).cbrt();
    0.5 * pull.hypot(0.5 * (weight + load))
}

/// Drives a ball from bank to bank. Returns the greatest force of a rope meanwhile, N.
fn cross(scene: &mut Stand, speed: f32) -> f32 {
    let ball = put_ball(scene, Vec3::new(-1.0, ABOVE, 0.0), speed);
    let far = PITCH * (GUIDE.planks + 1) as f32;
    let mut most = 0.0_f32;
    for _ in 0..scene.lab.ticks(15.0) {
        let missing = speed - scene.lab.velocity(ball).x;
        let torque = (150.0 * missing).clamp(-150.0, 150.0);
        scene.lab.get_mut::<ExternalForce>(ball).torque = Vec3::NEG_Z * torque;
        scene.lab.tick();
        most = most.max(hardest(scene));
        if scene.lab.position(ball).x > far {
            return most;
        }
    }
    panic!(
        "at {speed} m/s, the ball comes only to {}",
        scene.lab.position(ball)
    );
}

#[test]
fn a_ball_that_rolls_over_a_bridge_pulls_its_ropes_harder_than_a_ball_at_rest() {
    let (empty, loaded) = (at_rest(0.0), at_rest(BALL));
    for (speed, bounds) in [
        (1.5, loaded..1100.0),
        (3.0, 1000.0..1400.0),
        (5.0, 1200.0..1900.0),
    ] {
        let mut scene = level_start();
        let rest = hardest(&mut scene);
        let most = cross(&mut scene, speed);
        println!(
            "a rope carries {rest:.0} N at rest, {empty:.0} N by statics, {loaded:.0} N with the ball at rest; {most:.0} N as it crosses at {speed} m/s"
        );
        assert!((rest - empty).abs() < 0.03 * empty, "{rest} N at rest");
        assert!(bounds.contains(&most), "{speed} m/s: {most} N");
    }
}

#[test]
fn a_ball_beside_the_middle_of_a_bridge_rolls_off_unless_kerbs_hold_it() {
    for kerbs in [false, true] {
        let mut scene = GUIDE.put();
        if kerbs {
            put_kerbs(&mut scene);
        }
        let lowest = scene.lab.position(scene.bodies[GUIDE.planks / 2]).y;
        let middle = 0.5 * PITCH * (GUIDE.planks + 1) as f32;
        let at = Vec3::new(middle, lowest + ABOVE, 0.01);
        let ball = put_ball(&mut scene, at, 0.0);
        let off = (1..=scene.lab.ticks(20.0)).find(|_| {
            scene.lab.tick();
            scene.lab.position(ball).z.abs() > 0.5
        });
        let after = off.map(|ticks| ticks as f32 * DT);
        println!("ball 1 cm beside the middle, kerbs {kerbs}: rolls off after {after:?} s");
        assert_eq!(off.is_none(), kerbs, "kerbs {kerbs}: {after:?} s");
    }
}
