//! Does a readout tell the speed at which its ends really move?

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// Rapier keeps the velocity of a body that it does not move any more.
#[test]
fn a_body_that_is_disabled_in_motion_stands() {
    let mut lab = Lab::weightless();
    let hook = lab.point(Vec3::ZERO);
    let sled = lab.moving(body(1.0, Vec3::X), Velocity::linear(Vec3::X * 3.0));
    let damper = lab.spawn(Damper::new(hook, sled).with_damping(0.5));
    lab.run(0.1);
    assert!(lab.readout(damper).rate > 2.5);
    let mut entity = lab.app.world_mut().entity_mut(sled);
    entity.insert(RigidBodyDisabled);
    lab.run(0.1);
    let told = lab.readout(damper);
    assert_eq!((told.rate, told.force()), (0.0, 0.0), "{told:?}");
    lab.run(1.0);
    let later = lab.readout(damper);
    assert_eq!(later.dissipated_energy, told.dissipated_energy, "{later:?}");
    let mut entity = lab.app.world_mut().entity_mut(sled);
    entity.remove::<RigidBodyDisabled>();
    lab.run(0.1);
    assert!(lab.readout(damper).rate > 2.0, "it goes on");
}

#[test]
fn no_thread_breaks_by_the_speed_of_a_body_that_was_disabled() {
    let mut lab = Lab::weightless();
    let hook = lab.point(Vec3::ZERO);
    let sled = lab.moving(body(1.0, Vec3::X), Velocity::linear(Vec3::X * 5.0));
    let mut entity = lab.app.world_mut().entity_mut(sled);
    entity.insert(RigidBodyDisabled);
    let damper = Damper::new(hook, sled).with_damping(10.0);
    let thread = lab.spawn((damper, Breakable::at_force(20.0)));
    lab.run(0.5);
    assert!(lab.app.world().get_entity(thread).is_ok());
    assert_eq!(lab.position(sled), Vec3::X);
}

#[test]
fn a_fixed_body_with_a_velocity_stands() {
    let mut lab = Lab::weightless();
    let velocity = Velocity {
        linear: Vec3::X,
        angular: Vec3::Z,
    };
    let post = lab.spawn((RigidBody::Fixed, Transform::default(), velocity));
    let load = lab.body(1.0, Vec3::X);
    let damper = lab.spawn(Damper::new(post, load).with_damping(4.0));
    let torsion = TorsionDamper::new(post, load, Vec3::Z).with_damping(4.0);
    let torsion = lab.spawn(torsion);
    lab.run(0.2);
    for element in [damper, torsion] {
        let told = lab.readout(element);
        assert!(told.rate.abs() < 1e-6, "{told:?}");
        assert!(told.force().abs() < 1e-5, "{told:?}");
    }
    assert!(lab.velocity(load).length() < 1e-6);
}

/// In several steps of one tick, Rapier takes a lift to its place in the first, and it stands in the others.
#[test]
fn a_lift_has_its_mean_speed_whatever_the_number_of_steps_in_a_tick() {
    for substeps in [1, 2, 4] {
        let engine = Engine {
            substeps,
            ..Engine::weightless()
        };
        let mut lab = Lab::with(CoiloverPlugin::default(), engine);
        let lift = lab.spawn((RigidBody::KinematicPositionBased, Transform::default()));
        let load = lab.body(2.0, Vec3::X);
        let damper = lab.spawn(Damper::new(lift, load).with_damping(4.0));
        lab.tick();
        for i in 1..=60 {
            lab.get_mut::<Transform>(lift).translation.x = -0.6 * DT * i as f32;
            lab.tick();
        }
        let (told, wanted) = (lab.readout(damper), lab.velocity(load).x + 0.6);
        println!("{substeps} steps: {} of {wanted} m/s", told.rate);
        assert!((told.rate - wanted).abs() < 1e-3, "{substeps}: {told:?}");
        let force = told.damper_force - 4.0 * wanted;
        assert!(force.abs() < 5e-3, "{substeps}: {told:?}");
    }
}

#[test]
fn a_crank_has_its_mean_speed_whatever_the_number_of_steps_in_a_tick() {
    for substeps in [1, 4] {
        let engine = Engine {
            substeps,
            ..Engine::weightless()
        };
        let mut lab = Lab::with(CoiloverPlugin::default(), engine);
        let crank = lab.spawn((RigidBody::KinematicPositionBased, Transform::default()));
        let wheel = lab.spawn(brick(1.0, Vec3::ONE, Vec3::X));
        let damper = lab.spawn(TorsionDamper::new(crank, wheel, Vec3::Z));
        lab.tick();
        for i in 1..=60 {
            let turned = Quat::from_rotation_z(0.5 * DT * i as f32);
            lab.get_mut::<Transform>(crank).rotation = turned;
            lab.tick();
        }
        let wanted = lab.get::<Velocity>(wheel).angular.z - 0.5;
        let told = lab.readout(damper);
        println!("{substeps} steps: {} of {wanted} rad/s", told.rate);
        assert!((told.rate - wanted).abs() < 2e-3, "{substeps}: {told:?}");
    }
}

/// Two worlds of an interpolated game take turns: where one makes two steps in a frame, the other makes one.
#[test]
fn worlds_that_step_at_different_times_tell_of_their_own_time() {
    let frame = 1.5 * DT;
    let mut lab = Lab::without_plugin(Engine {
        dt: frame,
        ..Engine::weightless()
    });
    let mode = TimestepMode::Interpolated {
        dt: DT,
        time_scale: 1.0,
        substeps: 1,
    };
    lab.app.add_plugins(CoiloverPlugin::default());
    lab.app.insert_resource(mode);
    lab.prime();
    lab.tick();
    let first = lab.app.world_mut();
    let mut contexts = first.query_filtered::<Entity, With<RapierContextSimulation>>();
    let first = contexts.single(first).expect("one world");
    let engine = RapierConfiguration {
        gravity: Vec3::ZERO,
        ..RapierConfiguration::new(1.0)
    };
    let second = lab.spawn((RapierContextSimulation::default(), engine));
    lab.tick();
    let springs = [first, second].map(|world| {
        let (hook, ball) = (lab.point(Vec3::ZERO), lab.body(1.0, Vec3::X));
        let link = RapierContextEntityLink(world);
        lab.app.world_mut().entity_mut(ball).insert(link);
        let spring = lab.spawn(Spring::new(hook, ball).with_stiffness(40.0));
        (world, spring)
    });
    let mut differ = 0;
    for _ in 0..20 {
        let lag = |lab: &Lab, world| lab.get::<SimulationToRenderTime>(world).diff;
        let before = springs.map(|(world, _)| lag(&lab, world));
        lab.tick();
        let mut times = [0.0_f32; 2];
        for (at, (world, spring)) in springs.into_iter().enumerate() {
            let steps = ((before[at] + frame - lag(&lab, world)) / DT).round();
            times[at] = steps * DT;
            let wanted = 40.0_f32.sqrt() * times[at];
            let told = lab.readout(spring).omega_dt;
            assert!(
                steps == 0.0 || (told - wanted).abs() < 1e-4,
                "world {at}, {steps} steps: {told}, not {wanted}"
            );
        }
        differ += usize::from(times[0] != times[1]);
    }
    assert!(differ > 10, "they differ in {differ} frames only");
}
