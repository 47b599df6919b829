//! A heap of fifty boxes that are joined by springs.

use super::stand::*;
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// Fifty boxes in a heap, each on a spring of `k` N/m to the next.
fn heap(k: f32) -> Stand {
    let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
    scene.ground();
    let mut boxes: Vec<Entity> = Vec::new();
    // Without it, a box that hangs between two undamped springs spins about their anchors for ever, and rightly so.
    let air = Damping {
        linear_damping: 0.0,
        angular_damping: 0.5,
    };
    for i in 0..50 {
        let (x, y, z) = ((i % 3) as f32, (i / 9) as f32, ((i / 3) % 3) as f32);
        let at = Vec3::new(0.5 * x + 0.05 * y, 0.5 + 0.5 * y, 0.5 * z - 0.03 * y);
        let turned = Quat::from_scaled_axis(Vec3::new(0.1 * i as f32, 0.3, 0.0));
        boxes.push(scene.body(
            Transform::from_translation(at).with_rotation(turned),
            (
                Collider::cuboid(0.15, 0.15, 0.15),
                ColliderMassProperties::Mass(2.0),
                air,
            ),
        ));
    }
    for pair in boxes.windows(2) {
        let anchors = [Vec3::X * 0.1, Vec3::new(-0.1, 0.1, 0.0)];
        scene.coil([pair[0], pair[1]], anchors, [k, 0.0], None);
    }
    scene
}

#[test]
fn fifty_boxes_on_stiff_springs_win_nothing_and_fall_asleep() {
    for k in [1e4, 1e5, 1e6, 1e7] {
        let mut scene = heap(k);
        scene.lab.tick();
        let first = scene.energy();
        let most = scene.most(20.0) / first;
        let awake = scene.awake();
        println!(
            "heap, {k} N/m: E × {most:.3} of {first:.0} J, {awake} awake after 20 s, {:.1e} m/s",
            scene.speed()
        );
        assert!(most < 1.02, "{k} N/m: E × {most}");
        assert_eq!(awake, 0, "{k} N/m: {:e} m/s", scene.speed());
    }
}
