//! Cars whose springs have bump stops, or whose wheels turn on knuckles: their springs carry what those of a plain car carry,
//! and they steer.

use super::drive::{Car, LAW, RADIUS, car};
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

const SPEEDS: [f32; 6] = [0.0, 3.0, 5.0, 8.0, 11.0, 14.0];

/// Mean sag from the third to the eighth second, over that of statics.
fn sag(mut car: Car) -> f64 {
    car.scene.lab.run(3.0);
    car.mean_sag()
}

/// A car whose springs have been changed by `fit`, which gets the car and the entity of each spring.
fn fitted(kind: &str, speed: f32, law: [f32; 2], fit: impl Fn(&mut Car, usize, Entity)) -> Car {
    let mut car = car(CoiloverPlugin::default(), kind, 0.0, speed, law);
    let world = car.scene.lab.app.world_mut();
    let mut springs = world.query::<(Entity, &SpringDamper)>();
    let springs: Vec<_> = springs
        .iter(world)
        .map(|(at, spring)| (at, spring.body_b))
        .collect();
    for at in 0..car.wheels.len() {
        let (spring, _) = *springs
            .iter()
            .find(|(_, b)| *b == car.wheels[at])
            .expect("its spring");
        fit(&mut car, at, spring);
    }
    car
}

/// Puts a knuckle between a wheel and the chassis. A motor holds its steering angle, and the spring ends on it.
fn put_knuckle(car: &mut Car, at: usize, spring: Entity) {
    let wheel = car.wheels[at];
    let level = JointAxesMask::LIN_X | JointAxesMask::LIN_Z | JointAxesMask::ANG_X;
    let guide = GenericJointBuilder::new(level | JointAxesMask::ANG_Z)
        .local_anchor1(car.scene.coils[at].anchors[0])
        .motor_model(JointAxis::AngY, MotorModel::ForceBased)
        .motor_position(JointAxis::AngY, 0.0, 2e4, 1e3);
    let inertia = MassProperties {
        mass: 10.0,
        principal_inertia: Vec3::splat(0.4),
        ..default()
    };
    let place = *car.scene.lab.get::<Transform>(wheel);
    let velocity = Velocity::linear(car.scene.lab.velocity(wheel));
    let knuckle = car.scene.body(
        place,
        (
            AdditionalMassProperties::MassProperties(inertia),
            velocity,
            ImpulseJoint::new(car.chassis, TypedJoint::GenericJoint(guide.build())),
        ),
    );
    let axle = GenericJointBuilder::new(level | JointAxesMask::LIN_Y | JointAxesMask::ANG_Y);
    let axle = ImpulseJoint::new(knuckle, TypedJoint::GenericJoint(axle.build()));
    let world = car.scene.lab.app.world_mut();
    world.entity_mut(wheel).insert(axle);
    world
        .get_mut::<SpringDamper>(spring)
        .expect("a spring")
        .body_b = knuckle;
    car.scene.coils[at].ends[1] = knuckle;
}

#[test]
fn a_rolling_car_with_stops_that_it_does_not_reach_stands_as_high_as_without() {
    for kind in ["ball", "cylinder"] {
        for speed in SPEEDS {
            let sag = sag(fitted(kind, speed, LAW, |car, _, spring| {
                let stops = SpringTravel::new(0.25, 0.7, 2e5).with_stop_damping(2e3);
                car.scene
                    .lab
                    .app
                    .world_mut()
                    .entity_mut(spring)
                    .insert(stops);
            }));
            println!("{kind} wheels, stops, {speed} m/s: sag × {sag:.4}");
            assert!((sag - 1.0).abs() < 0.01, "{kind} {speed}: {sag}");
        }
    }
}

#[test]
fn a_parked_car_with_knuckles_rests_where_statics_say_however_strong_its_dampers() {
    for kind in ["ball", "cylinder"] {
        for damping in [300.0, 1e3, 1.5e3, 2e3, 3e3, 6e3, 12e3] {
            let sag = sag(fitted(kind, 0.0, [LAW[0], damping], put_knuckle));
            println!("{kind} wheels, knuckles, {damping} N s/m: sag × {sag:.4}");
            assert!((sag - 1.0).abs() < 5e-3, "{kind} {damping}: {sag}");
        }
    }
}

/// Within a tick, Rapier lifts a rolling wheel and drops it again, by a millimetre at 14 m/s. A tick ends when it is lowest.
#[test]
fn a_rolling_car_with_knuckles_stands_as_high_as_the_limits_say() {
    for kind in ["ball", "cylinder"] {
        for speed in SPEEDS {
            let sag = sag(fitted(kind, speed, LAW, put_knuckle));
            println!("{kind} wheels, knuckles, {speed} m/s: sag × {sag:.4}");
            assert!((sag - 1.0).abs() < 0.025, "{kind} {speed}: {sag}");
        }
    }
}

/// Place of the front axle on the chassis, m.
const AXLE: f32 = 1.3;

/// The car of the guide: its front wheels point to the left by an `angle` in rad, and its rear wheels drive.
fn steered(speed: f32, angle: f32) -> Car {
    const FRONT: usize = 2;
    let mut car = fitted("ball", speed, LAW, |car, at, spring| {
        if at < FRONT {
            put_knuckle(car, at, spring);
        }
    });
    for at in 0..car.wheels.len() {
        // How hard a motor holds the speed of a wheel, N m s/rad.
        let (spin, hold) = if at < FRONT {
            (0.0, 5.0)
        } else {
            (-speed / RADIUS, 200.0)
        };
        let mut axle = car.scene.lab.get_mut::<ImpulseJoint>(car.wheels[at]);
        axle.data
            .as_mut()
            .set_motor_model(JointAxis::AngZ, MotorModel::ForceBased)
            .set_motor_velocity(JointAxis::AngZ, spin, hold);
        if at < FRONT {
            let knuckle = car.scene.coils[at].ends[1];
            let mut guide = car.scene.lab.get_mut::<ImpulseJoint>(knuckle);
            guide
                .data
                .as_mut()
                .set_motor_position(JointAxis::AngY, angle, 2e4, 1e3);
        }
    }
    car
}

/// Radius of the circle of the rear axle's middle, m: its way over the angle by which the car turns meanwhile.
fn circle(car: &mut Car) -> f32 {
    let middle = |car: &Car| {
        let [left, right] = [2, 3].map(|at| car.scene.lab.position(car.wheels[at]));
        0.5 * (left + right)
    };
    let (mut way, mut turn) = (0.0, 0.0);
    for _ in 0..car.scene.lab.ticks(6.0) {
        let last = middle(car);
        car.scene.lab.tick();
        way += middle(car).distance(last);
        turn += DT * car.scene.lab.get::<Velocity>(car.chassis).angular.y;
    }
    way / turn
}

/// Both knuckles turn by the same angle, so only one front wheel can roll without sliding. If it is the inner one, the circle
/// is wider by half the track.
#[test]
fn a_steered_car_turns_in_a_wider_circle_than_its_wheelbase_says() {
    for angle in [0.3_f32, 0.5] {
        let mut car = steered(1.5, angle);
        car.scene.lab.run(3.0);
        let radius = circle(&mut car);
        let speed = car.scene.lab.velocity(car.chassis).length();
        let plain = 2.0 * AXLE / angle.tan();
        let (ratio, inner) = (radius / plain, (plain + 0.75) / plain);
        println!(
            "{angle} rad, {speed:.2} m/s: radius {radius:.2} m, {ratio:.3} × wheelbase/tan, {inner:.3} if the inner wheel rolls"
        );
        assert!((ratio - inner).abs() < 0.05, "{angle} rad: {ratio}");
    }
}

#[test]
fn a_steered_car_whose_springs_stand_beside_its_knuckles_drops_in_front() {
    let front = |angle: f32| {
        let mut car = steered(0.0, angle);
        car.move_inwards(0.4, |corner| corner.x > 0.0);
        car.scene.lab.run(5.0);
        let chassis = car.scene.lab.get::<Transform>(car.chassis);
        chassis.transform_point(Vec3::X * AXLE).y
    };
    let drop = front(0.0) - front(0.5);
    println!(
        "springs 0.4 m beside the steering axes, 0.5 rad: the front axle drops by {drop:.3} m"
    );
    // By statics, the springs lean by 0.19 m, and the knuckles give way by 0.03 rad: 0.053 m.
    assert!((0.065..0.075).contains(&drop), "{drop} m");
}
