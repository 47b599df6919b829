//! Rest of bodies that nothing touches, in a component that the engine solves because something touches others.

use super::stand::*;
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

pub const PITCH: f32 = 0.5;
/// Mass of a plank, kg.
pub const PLANK: f32 = 4.0;
/// Of each spring, N/m.
pub const STIFFNESS: f32 = 5e4;

/// Damping of a body by air, 1/s.
pub fn drag(air: f32) -> Damping {
    Damping {
        linear_damping: air,
        angular_damping: air,
    }
}

/// Planks of 4 kg on springs between two ends.
#[derive(Clone, Copy)]
pub struct Bridge {
    pub planks: usize,
    /// Horizontal force of the ropes of a gap together, N. The bridge starts in balance with it. Without it, the bridge
    /// starts level and without tension.
    pub pull: Option<f32>,
    /// Damping of all planks by air, 1/s.
    pub air: f32,
    /// Spawns an end at a place. The number is -1 for the near end and 1 for the far one.
    pub end: fn(&mut Stand, Vec3, f32) -> Entity,
}

/// The bridge of the guide's page on ropes, in balance between two banks.
pub const GUIDE: Bridge = Bridge {
    planks: 16,
    pull: Some(800.0),
    air: 0.5,
    end: bank,
};

/// A bank as high as the planks.
fn bank(scene: &mut Stand, at: Vec3, side: f32) -> Entity {
    let place = Transform::from_translation(at);
    let bank = scene.lab.spawn((RigidBody::Fixed, place));
    let earth = Transform::from_xyz((2.0 - 0.4 * PITCH) * side, -0.47, 0.0);
    let shape = Collider::cuboid(2.0, 0.5, 1.0);
    scene.lab.spawn((shape, earth, ChildOf(bank)));
    bank
}

/// A point in the air.
fn hook(scene: &mut Stand, at: Vec3, _: f32) -> Entity {
    scene.lab.point(at)
}

impl Bridge {
    /// Distance between the ropes' ends at the banks, m.
    pub fn span(&self) -> f32 {
        (self.planks as f32 + 0.2) * PITCH
    }

    /// Weight of the planks, N.
    pub fn weight(&self) -> f32 {
        self.planks as f32 * PLANK * GRAVITY as f32
    }

    pub fn put(&self) -> Stand {
        let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
        let c = 0.1 * (STIFFNESS * PLANK).sqrt();
        // In balance, each gap carries the planks between it and the middle. A plank lies along the sum of the forces at
        // its ends.
        let height = |i: usize| i as f32 / self.planks as f32 - 0.5;
        let force = |i: usize| match self.pull {
            Some(pull) => Vec3::new(pull, height(i) * self.weight(), 0.0),
            None => Vec3::ZERO,
        };
        let along = |force: Vec3| force.try_normalize().unwrap_or(Vec3::X);
        let wood = |i: usize| 0.8 * PITCH * along(force(i) + force(i + 1));
        let open = self.span() - (0..self.planks).map(|i| wood(i).x).sum::<f32>();
        let gap = open / (0..=self.planks).map(|i| along(force(i)).x).sum::<f32>();
        let mut edge = 0.4 * PITCH * Vec3::X;
        let mut last = (self.end)(&mut scene, Vec3::ZERO, -1.0);
        for i in 0..=self.planks {
            let next = if i < self.planks {
                let wood = wood(i);
                let centre = edge + gap * along(force(i)) + 0.5 * wood;
                edge = centre + 0.5 * wood;
                let turn = Quat::from_rotation_arc(Vec3::X, along(wood));
                let plank = (
                    Collider::cuboid(0.4 * PITCH, 0.03, 0.5),
                    ColliderMassProperties::Mass(PLANK),
                    drag(self.air),
                );
                scene.body(
                    Transform::from_translation(centre).with_rotation(turn),
                    plank,
                )
            } else {
                let at = Vec3::X * PITCH * (self.planks + 1) as f32;
                (self.end)(&mut scene, at, 1.0)
            };
            let rest = self.pull.map(|_| gap - 0.5 * force(i).length() / STIFFNESS);
            for z in [-0.45, 0.45] {
                let edge = |side: f32| Vec3::new(0.4 * PITCH * side, 0.0, z);
                scene.coil([last, next], [edge(1.0), edge(-1.0)], [STIFFNESS, c], rest);
            }
            last = next;
        }
        scene
    }
}

/// Ten planks between two points, level and without tension. `air` is the damping of all bodies by air, 1/s.
fn bridge(air: f32) -> Stand {
    let level = Bridge {
        planks: 10,
        pull: None,
        air,
        end: hook,
    };
    level.put()
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
pub fn hardest(scene: &mut Stand) -> f32 {
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
fn a_bridge_that_starts_in_balance_stands_still_as_deep_as_statics_say_and_sleeps() {
    let mut scene = GUIDE.put();
    let wander = scene.wander(5.0);
    let slept = (6..=20).find(|_| {
        scene.lab.run(1.0);
        scene.awake() == 0
    });
    let heights = scene.bodies.iter().map(|b| scene.lab.position(*b).y);
    let sag = -heights.fold(0.0, f32::min);
    let wanted = GUIDE.weight() * GUIDE.span() / (8.0 * 800.0);
    println!(
        "bridge in balance: hangs by {sag:.3} m, {wanted:.3} m by statics, wanders {wander:.1e} m, sleeps after {slept:?} s"
    );
    assert!((sag - wanted).abs() < 0.015 * wanted, "{sag} m");
    assert!(wander < 5e-3, "it wanders by {wander} m");
    assert!(slept.is_some(), "{} planks are awake", scene.awake());
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
