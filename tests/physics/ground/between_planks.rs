//! Rest of bodies that nothing touches, in a component that the engine solves because something touches others.

use super::stand::*;
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

const PLANKS: usize = 10;
const PITCH: f32 = 0.5;

/// Damping of a body by air, 1/s.
fn drag(air: f32) -> Damping {
    Damping {
        linear_damping: air,
        angular_damping: air,
    }
}

/// Ten planks of 4 kg on springs between two points, level and without tension. `air` is the damping of all bodies by air, 1/s.
fn bridge(air: f32) -> Stand {
    let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
    let (k, mass) = (5e4_f32, 4.0_f32);
    let mut last = scene.lab.point(Vec3::ZERO);
    for i in 1..=PLANKS + 1 {
        let at = Vec3::X * PITCH * i as f32;
        let next = if i <= PLANKS {
            let plank = (
                Collider::cuboid(0.4 * PITCH, 0.03, 0.5),
                ColliderMassProperties::Mass(mass),
                drag(air),
            );
            scene.body(Transform::from_translation(at), plank)
        } else {
            scene.lab.point(at)
        };
        for z in [-0.45, 0.45] {
            let edge = |side: f32| Vec3::new(0.4 * PITCH * side, 0.0, z);
            let c = 0.1 * (k * mass).sqrt();
            scene.coil([last, next], [edge(1.0), edge(-1.0)], [k, c], None);
        }
        last = next;
    }
    scene
}

/// The bridge, and a box of 80 kg that is dropped on it at `x`.
fn loaded_bridge(x: f32, air: f32) -> Stand {
    let mut scene = bridge(air);
    let load = (
        Collider::cuboid(0.2, 0.2, 0.2),
        ColliderMassProperties::Mass(80.0),
        Friction::new(0.8),
        drag(air),
    );
    scene.body(Transform::from_xyz(x, 0.25, 0.0), load);
    scene
}

#[test]
fn a_bridge_sleeps_with_a_box_across_a_gap_between_its_planks() {
    // A plank that the box does not touch trembles at half a millimetre a second, in place.
    for (x, air) in [(2.6, 1.0), (2.75, 0.5)] {
        let mut scene = loaded_bridge(x, air);
        let slept = (1..=60).find(|_| {
            scene.lab.run(1.0);
            scene.awake() == 0
        });
        println!("box at {x} m, air {air} 1/s: sleeps after {slept:?} s");
        assert!(
            slept.is_some(),
            "box at {x} m: {} bodies are awake",
            scene.awake()
        );
    }
}

/// Greatest force of an element in the last step, N.
fn hardest(scene: &mut Stand) -> f32 {
    let world = scene.lab.app.world_mut();
    let mut readouts = world.query::<&SpringReadout>();
    let forces = readouts.iter(world).map(|r| r.force().abs());
    forces.fold(0.0, f32::max)
}

/// A level rope has no stiffness across at first, so its tension grows with the square of the sag, and its energy with the
/// fourth power. The deepest sag is then the cube root of 4 times that at rest, and the tension 2.5 times.
#[test]
fn a_bridge_that_sinks_into_its_curve_pulls_less_than_three_times_as_hard_as_at_rest() {
    let mut scene = bridge(0.5);
    let mut most = 0.0_f32;
    for _ in 0..scene.lab.ticks(5.0) {
        scene.lab.tick();
        most = most.max(hardest(&mut scene));
    }
    scene.lab.run(40.0);
    let rest = hardest(&mut scene);
    let ratio = most / rest;
    println!("bridge: {most:.0} N as it sinks, {rest:.0} N at rest, {ratio:.2} times");
    assert!((2.0..3.0).contains(&ratio), "{most} N, then {rest} N");
}

#[test]
fn a_body_that_swings_slowly_between_boxes_on_the_ground_goes_on() {
    // The two taut springs all but balance each other, and the speed is below what counts as trembling on the ground.
    let (pull, k, mass, amplitude) = (50.0_f32, 100.0_f32, 2.0_f32, 1.5e-3_f32);
    let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
    scene.ground();
    let boxes = [-3.0, 3.0].map(|x| scene.cube(Vec3::new(x, 0.25, 0.0), 80.0));
    let swinging = (AdditionalMassProperties::Mass(mass), GravityScale(0.0));
    let middle = Transform::from_xyz(amplitude, 0.25, 0.0);
    let body = scene.body(middle, swinging);
    for end in boxes {
        let rest = Some(3.0 - pull / k);
        scene.coil([end, body], [Vec3::ZERO; 2], [k, 0.0], rest);
    }
    scene.lab.run(20.0);
    let mut farthest = 0.0_f32;
    for _ in 0..scene.lab.ticks(5.0) {
        scene.lab.tick();
        let [a, b, at] = [boxes[0], boxes[1], body].map(|e| scene.lab.position(e).x);
        farthest = farthest.max((at - 0.5 * (a + b)).abs());
    }
    println!(
        "swings by {:.2} of its first amplitude",
        farthest / amplitude
    );
    assert!(!scene.lab.is_sleeping(body), "it sleeps in its swing");
    assert!(farthest > 0.5 * amplitude, "it swings by {farthest} m");
}
