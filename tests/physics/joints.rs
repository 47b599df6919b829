//! Does an element act correctly on a body that a joint holds?

use crate::fit::{exact, frequency};
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// A door of 1 m on a hinge along y at the origin. A spring in tension connects its edge to a post 1 m beyond the
/// edge.
struct Door {
    lab: Lab,
    door: Entity,
    /// Moment of inertia about the hinge, kg m².
    inertia: f64,
}

const MASS: f32 = 8.0;

fn door(angle: f32, stiffness: f32, damping: f32) -> Door {
    let mut lab = Lab::weightless();
    let frame = lab.spawn((RigidBody::Fixed, Transform::default()));
    let own = MASS / 12.0;
    let door = lab.spawn((
        brick(
            MASS,
            Vec3::new(0.1, own, own),
            0.5 * Vec3::new(angle.cos(), 0.0, -angle.sin()),
        ),
        ImpulseJoint::new(
            frame,
            RevoluteJointBuilder::new(Vec3::Y).local_anchor2(Vec3::NEG_X * 0.5),
        ),
    ));
    lab.get_mut::<Transform>(door).rotation = Quat::from_rotation_y(angle);
    let post = lab.point(Vec3::X * 2.0);
    lab.spawn((
        SpringDamper::new(post, door)
            .with_stiffness(stiffness)
            .with_damping(damping)
            .with_rest_length(0.5),
        Anchors::new(Vec3::ZERO, Vec3::X * 0.5),
    ));
    Door {
        lab,
        door,
        inertia: f64::from(own + 0.25 * MASS),
    }
}

impl Door {
    fn angle(&self) -> f64 {
        let x = self.lab.get::<Transform>(self.door).rotation * Vec3::X;
        f64::from(-x.z).atan2(f64::from(x.x))
    }
}

#[test]
fn a_door_on_its_hinge_swings_as_a_spring_in_tension_makes_it() {
    // The tension at the edge is T = k (1 − 0.5), along the line to the post. The restoring torque is T r (r +
    // d)/d θ with r = 1 and d = 1 for small θ.
    for k in [40.0, 400.0] {
        let mut door = door(0.05, k, 0.0);
        let omega = (f64::from(k) * 0.5 * 2.0 / door.inertia).sqrt();
        let samples: Vec<_> = (1..=600)
            .map(|i| {
                door.lab.tick();
                (f64::from(i) * f64::from(DT), door.angle())
            })
            .collect();
        let f = frequency(&samples, omega) / omega;
        let late = samples[480..].iter().fold(0.0_f64, |a, s| a.max(s.1.abs()));
        assert!((f - 1.0).abs() < 2e-3, "k {k}: frequency {f}");
        assert!((late / 0.05 - 1.0).abs() < 2e-3, "k {k}: amplitude {late}");
        println!(
            "door, k {k}: frequency {f:.5} of the analytic one, amplitude after 8 s {:.4} of the first",
            late / 0.05
        );
    }
}

#[test]
fn a_damper_slows_the_door_as_theory_says() {
    // In `door`, the line to the post is at an angle of 2θ to the normal of the edge's path, so a damper hardly
    // damps small swings. Here the post lies in the direction in which the edge moves.
    let mut lab = Lab::weightless();
    let frame = lab.spawn((RigidBody::Fixed, Transform::default()));
    let own = MASS / 12.0;
    let door = lab.spawn((
        brick(MASS, Vec3::new(0.1, own, own), Vec3::X * 0.5),
        ImpulseJoint::new(
            frame,
            RevoluteJointBuilder::new(Vec3::Y).local_anchor2(Vec3::NEG_X * 0.5),
        ),
    ));
    let post = lab.point(Vec3::new(1.0, 0.0, 30.0));
    let (k, c) = (60.0_f32, 6.0_f32);
    lab.spawn((
        SpringDamper::new(post, door)
            .with_stiffness(k)
            .with_damping(c)
            .with_rest_length(30.0),
        Anchors::new(Vec3::ZERO, Vec3::X * 0.5),
    ));
    lab.get_mut::<Velocity>(door).angular = Vec3::Y * 0.1;
    lab.get_mut::<Velocity>(door).linear = Vec3::NEG_Z * 0.05;
    let inertia = f64::from(own + 0.25 * MASS);
    let omega = (f64::from(k) / inertia).sqrt();
    let zeta = f64::from(c) / (2.0 * omega * inertia);
    let mut worst = 0.0_f64;
    for i in 1..=300 {
        lab.tick();
        let x = lab.get::<Transform>(door).rotation * Vec3::X;
        let angle = f64::from(-x.z).atan2(f64::from(x.x));
        let wanted = exact(omega, zeta, 0.0, 0.1, f64::from(i) * f64::from(DT));
        worst = worst.max((angle - wanted).abs() / (0.1 / omega));
    }
    println!("damped door: largest error {worst:.4} of the amplitude");
    assert!(worst < 0.02, "{worst}");
}

#[test]
fn a_wheel_on_a_slider_is_the_quarter_car_again() {
    let (chassis_mass, wheel_mass, k, c) = (250.0_f32, 20.0_f32, 30e3_f32, 2e3_f32);
    let mut lab = Lab::new();
    // A fixed joint holds the wheel to the ground. The chassis slides on a prismatic joint.
    let ground = lab.spawn((RigidBody::Fixed, Transform::default()));
    let wheel = lab.spawn((
        body(wheel_mass, Vec3::Y * 0.3),
        ImpulseJoint::new(
            ground,
            FixedJointBuilder::new().local_anchor1(Vec3::Y * 0.3),
        ),
    ));
    let sag = f64::from(chassis_mass) * GRAVITY / f64::from(k);
    let start = 0.8 - 0.5 * sag as f32;
    let chassis = lab.spawn((
        body(chassis_mass, Vec3::Y * start),
        ImpulseJoint::new(ground, PrismaticJointBuilder::new(Vec3::Y)),
    ));
    lab.spawn(
        SpringDamper::new(wheel, chassis)
            .with_stiffness(k)
            .with_damping(c)
            .with_rest_length(0.5),
    );
    let omega = (f64::from(k) / f64::from(chassis_mass)).sqrt();
    let zeta = f64::from(c) / (2.0 * omega * f64::from(chassis_mass));
    let level = 0.8 - sag;
    let mut worst = 0.0_f64;
    for i in 1..=300 {
        lab.tick();
        let t = f64::from(i) * f64::from(DT);
        let y = f64::from(lab.position(chassis).y) - level;
        let wanted = exact(omega, zeta, f64::from(start) - level, 0.0, t);
        worst = worst.max((y - wanted).abs() / sag);
    }
    assert!(worst < 0.02, "{worst}");
    println!("slider: largest error {worst:.4} of the sag");
}

#[test]
fn a_spring_between_two_links_of_a_multibody_keeps_its_frequency_and_its_energy() {
    // Two carts on one rail; the second cart's joint is attached to the first cart. The multibody has reduced
    // coordinates, so the engine has no free bodies here. A spring connects the carts. Their centre of mass stays
    // where it is.
    for (k, c) in [(40.0_f32, 0.0_f32), (400.0, 0.0), (400.0, 4.0)] {
        let masses = [2.0_f32, 1.0];
        let mut lab = Lab::weightless();
        let rail = lab.spawn((RigidBody::Fixed, Transform::default()));
        // Each link starts where the coordinate of its joint is zero.
        let slider = |at: f32| PrismaticJointBuilder::new(Vec3::X).local_anchor1(Vec3::X * at);
        let first = lab.spawn((
            body(masses[0], Vec3::ZERO),
            MultibodyJoint::new(rail, TypedJoint::PrismaticJoint(slider(0.0).build())),
        ));
        let second = lab.spawn((
            body(masses[1], Vec3::X * 1.1),
            MultibodyJoint::new(first, TypedJoint::PrismaticJoint(slider(1.1).build())),
        ));
        lab.spawn(
            SpringDamper::new(first, second)
                .with_stiffness(k)
                .with_damping(c)
                .with_rest_length(1.0),
        );
        let effective = f64::from(masses[0] * masses[1] / (masses[0] + masses[1]));
        let omega = (f64::from(k) / effective).sqrt();
        let zeta = f64::from(c) / (2.0 * omega * effective);
        let mut worst = 0.0_f64;
        for i in 1..=300 {
            lab.tick();
            let length = f64::from((lab.position(second) - lab.position(first)).x);
            let wanted = exact(omega, zeta, 0.1, 0.0, f64::from(i) * f64::from(DT));
            worst = worst.max((length - 1.0 - wanted).abs() / 0.1);
        }
        println!("multibody, k {k} c {c}: largest error {worst:.4} of the amplitude");
        assert!(worst < 0.02, "k {k} c {c}: {worst}");
    }
}

/// Two bodies on a hinge, with these locked axes, fall on a tilted block with Rapier alone. Returns the greatest
/// speed of the lower body, m/s.
fn fastest_without_springs(locks: LockedAxes) -> f32 {
    let mut lab = Lab::without_plugin(Engine::default());
    let tilt = Transform::from_rotation(Quat::from_rotation_z(0.6));
    lab.spawn((RigidBody::Fixed, Collider::cuboid(0.5, 0.5, 0.5), tilt));
    let lower = lab.body(1.0, Vec3::new(-1.0, 0.8, 0.2));
    let upper = lab.body(10.0, Vec3::new(-1.0, 1.8, 0.4));
    let hinge = RevoluteJointBuilder::new(Vec3::Z)
        .local_anchor1(Vec3::new(0.0, 0.5, 0.1))
        .local_anchor2(Vec3::new(0.0, -0.5, -0.1));
    let joint = ImpulseJoint::new(lower, hinge);
    let solid = || (Collider::cuboid(0.3, 0.3, 0.3), locks);
    lab.app.world_mut().entity_mut(lower).insert(solid());
    lab.app
        .world_mut()
        .entity_mut(upper)
        .insert((solid(), joint));
    lab.get_mut::<Velocity>(lower).linear = Vec3::new(5.0, -3.0, 0.0);
    let mut fastest = 0.0_f32;
    for _ in 0..60 {
        lab.tick();
        fastest = fastest.max(lab.get::<Velocity>(lower).linear.length());
    }
    fastest
}

/// `docs/limits.md` describes this fault of Rapier. When this test fails, Rapier has fixed it, and the entry can
/// go.
#[test]
fn planar_bodies_on_a_hinge_are_thrown_by_rapier_alone() {
    let turns = LockedAxes::ROTATION_LOCKED_X | LockedAxes::ROTATION_LOCKED_Y;
    let planar = fastest_without_springs(turns | LockedAxes::TRANSLATION_LOCKED_Z);
    for locks in [LockedAxes::empty(), LockedAxes::TRANSLATION_LOCKED_Z] {
        let fastest = fastest_without_springs(locks);
        println!("{locks:?}: {fastest} m/s; planar: {planar} m/s");
        assert!(fastest < 30.0, "{locks:?}: {fastest}");
    }
    assert!(planar > 100.0, "{planar}");
}

#[test]
fn beside_links_a_spring_is_as_true_whatever_sleeps_far_from_it() {
    let places = [false, true].map(|sleeper| {
        let mut lab = Lab::new();
        let rail = lab.spawn((RigidBody::Fixed, Transform::from_xyz(0.0, 0.0, 20.0)));
        let hinge = RevoluteJointBuilder::new(Vec3::Z).local_anchor1(Vec3::X);
        lab.spawn((
            body(1.0, Vec3::new(1.0, 0.0, 20.0)),
            MultibodyJoint::new(rail, TypedJoint::RevoluteJoint(hinge.build())),
        ));
        if sleeper {
            let finer = AdditionalSolverIterations(12);
            let far = lab.spawn((body(1.0, Vec3::X * 40.0), GravityScale(0.0), finer));
            lab.get_mut::<Sleeping>(far).sleeping = true;
        }
        let (hook, lamp) = (lab.point(Vec3::ZERO), lab.body(1.0, Vec3::NEG_Y));
        lab.spawn(
            Spring::new(hook, lamp)
                .with_stiffness(100.0)
                .with_rest_length(1.0),
        );
        lab.run(2.0);
        lab.position(lamp)
    });
    assert!(places[0].distance(places[1]) < 1e-5, "{places:?}");
}

#[test]
fn a_spring_feels_all_bodies_of_a_car() {
    // A chassis, and an arm, a hub and a wheel at each corner: as many bodies in a row, on joints that lock all axes.
    const BODIES: usize = 1 + 3 * 4;
    let mut lab = Lab::weightless();
    let first = lab.body(1.0, Vec3::ZERO);
    let mut last = first;
    for i in 1..BODIES {
        let joint = FixedJointBuilder::new()
            .local_anchor1(Vec3::X * 0.5)
            .local_anchor2(Vec3::NEG_X * 0.5);
        let next = body(1.0, Vec3::X * i as f32);
        last = lab.spawn((next, ImpulseJoint::new(last, joint)));
    }
    let hook = lab.point(Vec3::NEG_X);
    let spring = Spring::new(hook, first)
        .with_stiffness(10.0)
        .with_rest_length(1.0);
    let spring = lab.spawn(spring);
    lab.run(0.1);
    let mass = lab.readout(spring).effective_mass;
    assert!((mass / BODIES as f32 - 1.0).abs() < 1e-3, "{mass} kg");
}
