//! Does a car on four springs drive over a step, come to rest without trembling, sleep and wake?

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

const CHASSIS: f32 = 1200.0;
const WHEEL: f32 = 20.0;
const RADIUS: f32 = 0.32;
const STIFFNESS: f32 = 30e3;
const DAMPING: f32 = 3e3;
/// Length of an unloaded spring, m.
const REST: f32 = 0.5;

struct Car {
    lab: Lab,
    chassis: Entity,
    wheels: [Entity; 4],
}

/// Four wheels, each guided vertically along the chassis and rolling about its axle. A step of 6 cm lies ahead.
/// The car drives along −z at `speed`, m/s.
fn car(speed: f32) -> Car {
    let mut lab = Lab::new();
    lab.spawn((
        Collider::halfspace(Vec3::Y).expect("up"),
        Transform::default(),
    ));
    lab.spawn((
        Collider::cuboid(3.0, 0.06, 20.0),
        Transform::from_xyz(0.0, 0.0, -25.0),
    ));
    let velocity = Velocity::linear(Vec3::NEG_Z * speed);
    let height = RADIUS + REST;
    let size = Vec3::new(1.5, 0.4, 3.6);
    let inertia = CHASSIS / 12.0
        * Vec3::new(
            size.y * size.y + size.z * size.z,
            size.x * size.x + size.z * size.z,
            size.x * size.x + size.y * size.y,
        );
    let chassis = lab.spawn(brick(CHASSIS, inertia, Vec3::Y * height));
    *lab.get_mut::<Velocity>(chassis) = velocity;
    let corners = [(-0.75, -1.3), (0.75, -1.3), (-0.75, 1.3), (0.75, 1.3)];
    let wheels = corners.map(|(x, z)| {
        let guide = GenericJointBuilder::new(
            JointAxesMask::LIN_X
                | JointAxesMask::LIN_Z
                | JointAxesMask::ANG_Y
                | JointAxesMask::ANG_Z,
        )
        .local_anchor1(Vec3::new(x, 0.0, z));
        let wheel = lab.spawn((
            RigidBody::Dynamic,
            Collider::ball(RADIUS),
            ColliderMassProperties::Mass(WHEEL),
            Friction::new(1.0),
            Transform::from_xyz(x, RADIUS, z),
            Velocity {
                linear: velocity.linear,
                angular: Vec3::NEG_X * speed / RADIUS,
            },
            Sleeping::default(),
            ImpulseJoint::new(chassis, TypedJoint::GenericJoint(guide.build())),
        ));
        lab.spawn((
            SpringDamper::new(chassis, wheel)
                .with_stiffness(STIFFNESS)
                .with_damping(DAMPING)
                .with_rest_length(REST),
            Anchors::new(Vec3::new(x, 0.0, z), Vec3::ZERO),
        ));
        wheel
    });
    Car {
        lab,
        chassis,
        wheels,
    }
}

impl Car {
    fn speed(&self) -> f32 {
        let mut bodies = vec![self.chassis];
        bodies.extend(self.wheels);
        bodies
            .iter()
            .map(|b| self.lab.velocity(*b).length())
            .fold(0.0, f32::max)
    }

    /// Locks the wheels.
    fn brake(&mut self) {
        for wheel in self.wheels {
            self.lab.get_mut::<Velocity>(wheel).angular = Vec3::ZERO;
            let world = self.lab.app.world_mut();
            world.entity_mut(wheel).insert(LockedAxes::ROTATION_LOCKED);
        }
    }
}

#[test]
fn at_rest_it_stands_on_its_springs_without_trembling_and_sleeps() {
    let mut car = car(0.0);
    car.brake();
    car.lab.run(3.0);
    let sag = f64::from(CHASSIS) * GRAVITY / 4.0 / f64::from(STIFFNESS);
    let ride = f64::from(car.lab.position(car.chassis).y - car.lab.position(car.wheels[0]).y);
    println!("speed after 3 s {:e}, ride height {ride:.5}", car.speed());
    assert!(car.speed() < 1e-3, "{}", car.speed());
    assert!((f64::from(REST) - ride - sag).abs() < 0.005 * sag, "{ride}");
    car.lab.run(6.0);
    assert!(car.lab.is_sleeping(car.chassis));
    assert!(car.wheels.iter().all(|w| car.lab.is_sleeping(*w)));
    // A push at one wheel wakes the whole car.
    car.lab.get_mut::<Velocity>(car.wheels[2]).linear = Vec3::Y * 0.5;
    car.lab.run(0.1);
    assert!(!car.lab.is_sleeping(car.chassis));
}

#[test]
fn over_a_step_it_stays_on_its_wheels_and_comes_to_rest() {
    let mut car = car(6.0);
    let (mut highest, mut lowest) = (0.0_f32, f32::MAX);
    for _ in 0..car.lab.ticks(2.0) {
        car.lab.tick();
        let y = car.lab.position(car.chassis).y;
        highest = highest.max(y);
        lowest = lowest.min(y);
    }
    let z = car.lab.position(car.chassis).z;
    assert!(z < -7.0, "it drove only to {z}");
    car.brake();
    car.lab.run(1.5);
    car.lab.run(3.0);
    let up = car.lab.get::<Transform>(car.chassis).up();
    println!(
        "chassis between {lowest:.3} and {highest:.3} m, speed after braking {:e}, up {up:?}",
        car.speed()
    );
    assert!(car.speed() < 1e-3, "{}", car.speed());
    assert!(up.y > 0.9999, "{up:?}");
    // The car stands on the step, which is 0.06 m high.
    let sag = CHASSIS * GRAVITY as f32 / 4.0 / STIFFNESS;
    let y = car.lab.position(car.chassis).y;
    let wanted = 0.06 + RADIUS + REST - sag;
    assert!((y - wanted).abs() < 0.01, "{y} against {wanted}");
    car.lab.run(6.0);
    assert!(car.lab.is_sleeping(car.chassis));
}
