//! Cars that roll over kerbs, bumps, a washboard and a ramp, fall, or pull a trailer.

use super::stand::*;
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

pub const RADIUS: f32 = 0.33;
const REST: f32 = 0.5;
pub const CHASSIS: f32 = 1200.0;
pub const WHEEL: f32 = 20.0;

/// A chassis and its wheels that roll along x.
pub struct Car {
    pub scene: Stand,
    pub chassis: Entity,
    pub wheels: Vec<Entity>,
    law: [f32; 2],
}

fn wheel_shape(kind: &str) -> Collider {
    match kind {
        "ball" => Collider::ball(RADIUS),
        _ => Collider::compound(vec![(
            Vec3::ZERO,
            Quat::from_rotation_x(std::f32::consts::FRAC_PI_2),
            Collider::cylinder(0.1, RADIUS),
        )]),
    }
}

/// Adds a chassis with a wheel below each corner. `at` is the point of the ground below the chassis, and lifts the car
/// where its y is positive.
fn put_car(
    scene: &mut Stand,
    kind: &str,
    at: Vec3,
    speed: f32,
    law: [f32; 2],
    corners: &[Vec3],
) -> (Entity, Vec<Entity>) {
    let share = corners.len() as f32 / 4.0;
    let chassis = scene.body(
        Transform::from_translation(at + Vec3::Y * (RADIUS + REST)),
        (
            Collider::cuboid(1.6, 0.15, 0.6),
            ColliderMassProperties::Mass(CHASSIS * share),
            CollisionGroups::new(Group::GROUP_2, Group::GROUP_1),
            Friction::new(0.5),
            Velocity::linear(Vec3::X * speed),
        ),
    );
    let mut wheels = Vec::new();
    for corner in corners {
        let guide = GenericJointBuilder::new(
            JointAxesMask::LIN_X
                | JointAxesMask::LIN_Z
                | JointAxesMask::ANG_X
                | JointAxesMask::ANG_Y,
        )
        .local_anchor1(*corner);
        let wheel = scene.body(
            Transform::from_translation(at + *corner + Vec3::Y * RADIUS),
            (
                wheel_shape(kind),
                ColliderMassProperties::Mass(WHEEL),
                CollisionGroups::new(Group::GROUP_2, Group::GROUP_1),
                Friction::new(1.0),
                Velocity {
                    linear: Vec3::X * speed,
                    angular: Vec3::NEG_Z * speed / RADIUS,
                },
                ImpulseJoint::new(chassis, TypedJoint::GenericJoint(guide.build())),
            ),
        );
        scene.coil([chassis, wheel], [*corner, Vec3::ZERO], law, Some(REST));
        wheels.push(wheel);
    }
    (chassis, wheels)
}

fn corners() -> [Vec3; 4] {
    [(1.3, 0.75), (1.3, -0.75), (-1.3, 0.75), (-1.3, -0.75)].map(|(x, z)| Vec3::new(x, 0.0, z))
}

pub fn car(plugin: CoiloverPlugin, kind: &str, height: f32, speed: f32, law: [f32; 2]) -> Car {
    let mut scene = Stand::new(plugin, Engine::default());
    let ground = scene.ground();
    scene.lab.app.world_mut().entity_mut(ground).insert((
        Friction::new(1.0),
        CollisionGroups::new(Group::GROUP_1, Group::GROUP_2),
    ));
    let (chassis, wheels) = put_car(&mut scene, kind, Vec3::Y * height, speed, law, &corners());
    Car {
        scene,
        chassis,
        wheels,
        law,
    }
}

impl Car {
    /// Adds a fixed obstacle to the road.
    fn obstacle(&mut self, at: Transform, collider: Collider) {
        self.scene.lab.spawn((
            RigidBody::Fixed,
            at,
            collider,
            Friction::new(1.0),
            CollisionGroups::new(Group::GROUP_1, Group::GROUP_2),
        ));
    }

    pub fn sag(&self) -> f64 {
        let lengths: f64 = self.scene.coils.iter().map(|c| self.scene.length(c)).sum();
        f64::from(REST) - lengths / self.scene.coils.len() as f64
    }

    /// Mean sag over the next five seconds, over that of statics.
    pub fn mean_sag(&mut self) -> f64 {
        let mut sum = 0.0;
        for _ in 0..300 {
            self.scene.lab.tick();
            sum += self.sag() / 300.0;
        }
        sum / self.theory()
    }

    pub fn theory(&self) -> f64 {
        let share = self.wheels.len() as f64 / 4.0;
        f64::from(CHASSIS) * share * GRAVITY / (self.wheels.len() as f64 * f64::from(self.law[0]))
    }

    /// Moves both anchors of the springs at some corners inwards, m.
    pub fn move_inwards(&mut self, by: f32, whose: impl Fn(Vec3) -> bool) {
        let inward = |corner: Vec3| {
            let moved = if whose(corner) { by } else { 0.0 };
            Vec3::NEG_Z * moved * corner.z.signum()
        };
        for coil in &mut self.scene.coils {
            let step = inward(coil.anchors[0]);
            coil.anchors = coil.anchors.map(|anchor| anchor + step);
        }
        let world = self.scene.lab.app.world_mut();
        for mut anchors in world.query::<&mut Anchors>().iter_mut(world) {
            let step = inward(anchors.a);
            anchors.a += step;
            anchors.b += step;
        }
    }

    /// Locks the wheels.
    pub fn brake(&mut self) {
        for wheel in &self.wheels {
            self.scene.lab.get_mut::<Velocity>(*wheel).angular = Vec3::ZERO;
            let world = self.scene.lab.app.world_mut();
            world
                .entity_mut(*wheel)
                .insert(LockedAxes::ROTATION_LOCKED_Z);
        }
    }

    /// Runs for a time. Returns the greatest energy over that after the first tick.
    fn run(&mut self, seconds: f64) -> f64 {
        self.scene.lab.tick();
        let first = self.scene.energy();
        self.scene.most(seconds) / first
    }

    pub fn up(&self) -> f32 {
        self.scene.lab.get::<Transform>(self.chassis).up().y
    }
}

#[test]
fn a_car_rolls_at_the_height_at_which_it_stands() {
    for law in [[40e3, 3e3], [25e3, 1.5e3]] {
        for kind in ["ball", "cylinder"] {
            for speed in [0.0, 3.0, 6.0, 12.0, 25.0] {
                let mut car = car(CoiloverPlugin::default(), kind, 0.0, speed, law);
                let gain = car.run(3.0);
                let sag = car.mean_sag();
                let now = car.scene.lab.velocity(car.chassis).x;
                println!(
                    "car on {kind} wheels, {law:?}, {speed} m/s: sag × {sag:.3}, E × {gain:.4}, {now:.2} m/s after 8 s"
                );
                assert!((sag - 1.0).abs() < 0.02, "{kind} {speed}: {sag}");
                assert!(gain < 1.02, "{kind} {speed}: E × {gain}");
                // The engine turns no body by more than an eighth of a turn in a step, which limits these wheels to 15 m/s.
                assert!(now >= 0.95 * speed.min(15.0), "{kind} {speed}: {now} m/s");
            }
        }
    }
}

/// Runs a car over its obstacles, brakes it, and asserts that it gains no energy, stands upright and falls asleep.
fn over(name: &str, mut car: Car, seconds: f64) {
    let gain = car.run(seconds);
    let up = car.up();
    car.brake();
    car.scene.lab.run(15.0);
    println!(
        "{name}: E × {gain:.4}, up {up:.4} then {:.4}; after braking {} awake, {:.1e} m/s, sag × {:.4}",
        car.up(),
        car.scene.awake(),
        car.scene.speed(),
        car.sag() / car.theory()
    );
    assert!(gain < 1.02, "{name}: E × {gain}");
    assert!(car.up() > 0.99, "{name}: it stands");
    assert_eq!(car.scene.awake(), 0, "{name}: it sleeps");
}

pub const LAW: [f32; 2] = [40e3, 3e3];

#[test]
fn a_car_whose_springs_stand_beside_its_wheels_rests_where_statics_say() {
    for kind in ["ball", "cylinder"] {
        let mut car = car(CoiloverPlugin::default(), kind, 0.1, 0.0, LAW);
        car.move_inwards(0.2, |_| true);
        car.brake();
        car.scene.lab.run(20.0);
        let sag = car.sag() / car.theory();
        println!("springs beside {kind} wheels: sag × {sag:.5}");
        assert!((sag - 1.0).abs() < 1e-3, "{kind}: {sag}");
        assert_eq!(car.scene.awake(), 0, "{kind}: it sleeps");
    }
}

#[test]
fn over_a_kerb_at_twelve_metres_a_second() {
    for kind in ["ball", "cylinder"] {
        let mut car = car(CoiloverPlugin::default(), kind, 0.0, 12.0, LAW);
        let kerb = Collider::cuboid(50.0, 0.1, 5.0);
        car.obstacle(Transform::from_xyz(60.0, 0.0, 0.0), kerb);
        over(&format!("kerb, {kind}"), car, 4.0);
    }
}

#[test]
fn over_bumps_and_a_washboard() {
    for kind in ["ball", "cylinder"] {
        let mut bumps = car(CoiloverPlugin::default(), kind, 0.0, 10.0, LAW);
        for i in 0..6 {
            let at = Transform::from_xyz(8.0 + 4.0 * i as f32, -0.42, 0.0)
                .with_rotation(Quat::from_rotation_x(std::f32::consts::FRAC_PI_2));
            bumps.obstacle(at, Collider::cylinder(5.0, 0.5));
        }
        over(&format!("bumps, {kind}"), bumps, 4.0);
        let mut board = car(CoiloverPlugin::default(), kind, 0.0, 15.0, LAW);
        for i in 0..60 {
            let at = Transform::from_xyz(8.0 + 0.6 * i as f32, -0.27, 0.0)
                .with_rotation(Quat::from_rotation_x(std::f32::consts::FRAC_PI_2));
            board.obstacle(at, Collider::cylinder(5.0, 0.3));
        }
        over(&format!("washboard, {kind}"), board, 4.0);
    }
}

#[test]
fn dropped_from_three_metres() {
    for kind in ["ball", "cylinder"] {
        over(
            &format!("drop of 3 m, {kind}"),
            car(CoiloverPlugin::default(), kind, 3.0, 0.0, LAW),
            5.0,
        );
    }
}

#[test]
fn over_a_ramp_at_twenty_metres_a_second() {
    for kind in ["ball", "cylinder"] {
        let mut car = car(CoiloverPlugin::default(), kind, 0.0, 20.0, LAW);
        let ramp = Transform::from_xyz(16.0, 0.0, 0.0).with_rotation(Quat::from_rotation_z(0.15));
        car.obstacle(ramp, Collider::cuboid(6.0, 0.3, 5.0));
        over(&format!("ramp, {kind}"), car, 6.0);
    }
}

#[test]
fn with_a_trailer() {
    let mut car = car(CoiloverPlugin::default(), "cylinder", 0.0, 10.0, LAW);
    let axle = [Vec3::new(-0.2, 0.0, 0.75), Vec3::new(-0.2, 0.0, -0.75)];
    let at = Vec3::NEG_X * 4.2;
    let (trailer, wheels) = put_car(&mut car.scene, "cylinder", at, 10.0, LAW, &axle);
    let hitch = SphericalJointBuilder::new()
        .local_anchor1(Vec3::NEG_X * 2.2)
        .local_anchor2(Vec3::X * 2.0);
    let world = car.scene.lab.app.world_mut();
    // An entity holds one joint component, and the trailer's slot is free.
    world
        .entity_mut(trailer)
        .insert(ImpulseJoint::new(car.chassis, hitch));
    car.wheels.extend(wheels);
    let gain = car.run(6.0);
    car.brake();
    car.scene.lab.run(15.0);
    println!(
        "trailer: E × {gain:.4}, up {:.4}; after braking {} awake, {:.1e} m/s",
        car.up(),
        car.scene.awake(),
        car.scene.speed()
    );
    assert!(gain < 1.02, "E × {gain}");
    assert!(car.up() > 0.99);
    assert_eq!(car.scene.awake(), 0);
}
