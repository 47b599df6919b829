//! A quarter car ten kilometres from the origin, where an f32 resolves a position to a millimetre.

use super::scenes::*;
use super::stand::*;
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// Distance between neighbouring f32 numbers at ten kilometres, m.
const ULP: f64 = 9.765_625e-4;

fn stand(at: Vec3) -> Stand {
    let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
    scene.lab.spawn((
        Collider::halfspace(Vec3::Y).expect("up"),
        Friction::new(1.0),
        Transform::from_translation(at),
    ));
    scene
}

#[test]
fn a_quarter_car_stands_and_rolls_ten_kilometres_away() {
    for at in [
        Vec3::ZERO,
        Vec3::new(1e4, 0.0, 1e4),
        Vec3::new(-1e4, 0.0, 0.0),
    ] {
        for speed in [0.0, 10.0] {
            let setup = Footed {
                at,
                speed: Some(speed),
                ..Footed::quarter_car()
            };
            let mut scene = stand(at);
            let placed = setup.put(&mut scene);
            scene.lab.tick();
            let first = scene.energy() - setup.floor();
            let most = (scene.most(10.0) - setup.floor()) / first;
            let (mut sum, mut range) = (0.0, [f64::INFINITY, f64::NEG_INFINITY]);
            let ticks = 180;
            for _ in 0..ticks {
                scene.lab.tick();
                let sag = setup.sag_now(&scene);
                sum += sag / f64::from(ticks);
                range = [range[0].min(sag), range[1].max(sag)];
            }
            let (ratio, tremble) = (sum / setup.sag(), range[1] - range[0]);
            let (now, awake) = (scene.lab.velocity(placed.above).x, scene.awake());
            println!(
                "at {at}, {speed} m/s: E × {most:.4}, sag × {ratio:.5}, trembles {tremble:.1e} m, {now:.3} m/s, {awake} awake"
            );
            assert!(most < 1.02, "{at} {speed}: E × {most}");
            let off = (sum - setup.sag()).abs();
            let bar = if speed == 0.0 { 0.01 } else { 0.03 };
            assert!(off < bar * setup.sag(), "{at} {speed}: {ratio}");
            let own = if speed == 0.0 { 1e-4 } else { ULP };
            assert!(tremble < own, "{at} {speed}: {tremble}");
            assert!(now > 0.95 * speed - 1e-3, "{at} {speed}: {now}");
            if speed == 0.0 {
                assert_eq!(awake, 0, "{at}: it sleeps");
            }
        }
    }
}

#[test]
fn a_damped_spring_on_a_rail_carries_its_load_a_hundred_metres_up() {
    let (mass, stiffness) = (50.0, 8e3);
    let sag = mass * GRAVITY as f32 / stiffness;
    for height in [0.0, 100.0, 400.0, 1e3] {
        let mut lab = Lab::new();
        let at = Vec3::Y * height;
        let post = lab.spawn((RigidBody::Fixed, Transform::from_translation(at)));
        let load = lab.body(mass, at - Vec3::Y);
        let slider = ImpulseJoint::new(post, PrismaticJointBuilder::new(Vec3::Y));
        lab.app.world_mut().entity_mut(load).insert(slider);
        let element = lab.spawn(
            SpringDamper::new(post, load)
                .with_stiffness(stiffness)
                .with_damping(2.0 * (stiffness * mass).sqrt())
                .with_rest_length(1.0),
        );
        lab.run(20.0);
        let off = (lab.readout(element).length - 1.0) / sag - 1.0;
        println!("at a height of {height} m: sag {:+.2} % off", 100.0 * off);
        assert!(height > 100.0 || off.abs() < 0.01, "{height} m: {off}");
    }
}
