//! Does the motion stay correct with other settings of the engine?

use crate::fit::{Sine, frequency};
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// Trace of an oscillation along x over 5 s, of a body of 1 kg on 40 N/m: time, s, and displacement, m.
fn trace(mut lab: Lab, extra: impl Bundle) -> Vec<(f64, f64)> {
    let hook = lab.point(Vec3::ZERO);
    let body = lab.body(1.0, Vec3::X * 1.3);
    lab.app.world_mut().entity_mut(body).insert(extra);
    lab.spawn(
        Spring::new(hook, body)
            .with_stiffness(40.0)
            .with_rest_length(1.0),
    );
    (1..=lab.ticks(5.0))
        .map(|i| {
            lab.tick();
            (i as f64 * lab.dt(), f64::from(lab.position(body).x) - 1.0)
        })
        .collect()
}

fn engine(iterations: usize, substeps: usize) -> Lab {
    let engine = Engine {
        iterations,
        substeps,
        ..Engine::weightless()
    };
    Lab::with(CoiloverPlugin::default(), engine)
}

#[test]
fn any_number_of_solver_iterations_and_substeps_gives_the_same_motion() {
    let omega = 40.0_f64.sqrt();
    for (iterations, substeps) in [(1, 1), (1, 3), (2, 1), (3, 1), (4, 2), (8, 1), (16, 4)] {
        for (t, x) in trace(engine(iterations, substeps), ()) {
            let wanted = 0.3 * (omega * t).cos();
            assert!(
                (x - wanted).abs() < 2e-5,
                "{iterations}×{substeps}, t {t}: {x} against {wanted}"
            );
        }
    }
    for (t, x) in trace(engine(4, 1), AdditionalSolverIterations(3)) {
        assert!((x - 0.3 * (omega * t).cos()).abs() < 2e-5);
    }
}

#[test]
fn a_single_iteration_is_given_back() {
    let mut lab = engine(1, 1);
    let hook = lab.point(Vec3::ZERO);
    let body = lab.body(1.0, Vec3::X * 1.3);
    let element = lab.spawn(
        Spring::new(hook, body)
            .with_stiffness(40.0)
            .with_rest_length(1.0),
    );
    lab.tick();
    assert_eq!(iterations(&mut lab, body), 1);
    lab.app.world_mut().despawn(element);
    lab.tick();
    assert_eq!(iterations(&mut lab, body), 0);
}

/// Additional solver iterations of a body in the engine.
fn iterations(lab: &mut Lab, body: Entity) -> usize {
    let mut sets = lab.app.world_mut().query::<&RapierRigidBodySet>();
    let set = sets.single(lab.app.world()).expect("one context");
    let body = set.bodies.get(set.entity2body()[&body]);
    body.expect("the body").additional_solver_iterations()
}

#[test]
fn iterations_that_the_game_sets_stay_even_if_the_spring_had_asked_for_as_many() {
    for (held, at_once) in [(false, false), (true, false), (false, true), (true, true)] {
        let mut lab = Lab::with(
            CoiloverPlugin::default(),
            Engine {
                iterations: if held { 4 } else { 1 },
                ..default()
            },
        );
        let body = lab.body(1.0, Vec3::Y * 0.1);
        if held {
            let ground = Collider::halfspace(Vec3::Y).expect("up");
            lab.spawn((ground, Transform::default()));
            lab.app
                .world_mut()
                .entity_mut(body)
                .insert(Collider::ball(0.1));
        }
        let hook = lab.point(Vec3::Y);
        let element = lab.spawn(Spring::new(hook, body).with_stiffness(40.0));
        for _ in 0..3 {
            lab.tick();
        }
        let asked = iterations(&mut lab, body);
        assert!(asked > 0, "held: {held}");
        let set = AdditionalSolverIterations(asked);
        lab.app.world_mut().entity_mut(body).insert(set);
        if !at_once {
            lab.tick();
        }
        lab.app.world_mut().despawn(element);
        for _ in 0..3 {
            lab.tick();
        }
        let count = iterations(&mut lab, body);
        assert_eq!(count, asked, "held: {held}, at once: {at_once}");
    }
}

#[test]
fn damping_of_the_engine_works_on_top() {
    // v/(1 + dt·d) once per step damps the oscillation at a rate of d/2.
    let samples = trace(
        engine(4, 1),
        Damping {
            linear_damping: 0.4,
            angular_damping: 0.0,
        },
    );
    let omega = (40.0_f64 - 0.04).sqrt();
    let early = Sine::fit(&samples[..60], omega).amplitude();
    let late = Sine::fit(&samples[240..], omega).amplitude();
    let wanted = (-0.2 * 4.0_f64).exp();
    assert!(
        (late / early / wanted - 1.0).abs() < 0.02,
        "{} against {wanted}",
        late / early
    );
    let f = frequency(&samples, omega) / omega;
    assert!((f - 1.0).abs() < 3e-3, "{f}");
}

#[test]
fn gravity_scale_counts() {
    for scale in [-1.0, 0.0, 0.5, 3.0] {
        let mut lab = Lab::new();
        let hook = lab.point(Vec3::ZERO);
        let body = lab.body(2.0, Vec3::NEG_Y);
        lab.app
            .world_mut()
            .entity_mut(body)
            .insert(GravityScale(scale));
        lab.spawn(
            SpringDamper::new(hook, body)
                .with_stiffness(300.0)
                .with_damping(20.0)
                .with_rest_length(1.0),
        );
        lab.run(10.0);
        let wanted = -1.0 - scale * 2.0 * 9.81 / 300.0;
        let y = lab.position(body).y;
        assert!((y - wanted).abs() < 5e-5, "{scale}: {y} against {wanted}");
    }
}

#[test]
fn locked_translation_leaves_the_rest_of_the_oscillator() {
    // The body is free along x only, on a spring at 45°. At a small amplitude the stiffness is k cos² 45° = k/2.
    let mut lab = Lab::weightless();
    let hook = lab.point(Vec3::ZERO);
    let body = lab.spawn((
        body(1.0, Vec3::new(1.002, 1.0, 0.0)),
        LockedAxes::TRANSLATION_LOCKED_Y
            | LockedAxes::TRANSLATION_LOCKED_Z
            | LockedAxes::ROTATION_LOCKED,
    ));
    let rest = 2.0_f32.sqrt();
    lab.spawn(
        Spring::new(hook, body)
            .with_stiffness(100.0)
            .with_rest_length(rest),
    );
    let samples: Vec<_> = (1..=600)
        .map(|i| {
            lab.tick();
            assert_eq!(lab.position(body).y, 1.0);
            (
                f64::from(i) * f64::from(DT),
                f64::from(lab.position(body).x) - 1.0,
            )
        })
        .collect();
    let omega = 50.0_f64.sqrt();
    let f = frequency(&samples, omega) / omega;
    assert!((f - 1.0).abs() < 1e-3, "{f}");
}

#[test]
fn locked_rotation_turns_a_pendulum_into_a_hinge_about_one_axis() {
    // A bar is held at its end by a stiff spring of zero length and can turn about z only. It is a compound
    // pendulum with the period 2π √(I_end/(m g r)).
    let mut lab = Lab::with(
        CoiloverPlugin::default().with_microsteps(4),
        Engine::default(),
    );
    let pivot = lab.point(Vec3::ZERO);
    let (r, inertia) = (0.5_f64, 0.12_f64);
    let tilt = 0.05_f32;
    let bar = lab.spawn((
        brick(
            1.0,
            Vec3::new(0.01, 0.12, 0.12),
            0.5 * Vec3::new(tilt.sin(), -tilt.cos(), 0.0),
        ),
        LockedAxes::ROTATION_LOCKED_X | LockedAxes::ROTATION_LOCKED_Y,
    ));
    // The bar's own frame is upright. The anchor is the end at the pivot.
    let up = lab.position(bar) * -1.0;
    lab.spawn((
        SpringDamper::new(pivot, bar)
            .with_stiffness(2e4)
            .with_damping(20.0)
            .with_rest_length(0.0),
        Anchors::new(Vec3::ZERO, up),
    ));
    let samples: Vec<_> = (1..=600)
        .map(|i| {
            lab.tick();
            (f64::from(i) * f64::from(DT), f64::from(lab.position(bar).x))
        })
        .collect();
    let omega = (GRAVITY * r / (inertia + r * r)).sqrt();
    // The finite amplitude θ lowers the frequency by θ²/16.
    let omega = omega * (1.0 - f64::from(tilt * tilt) / 16.0);
    let f = frequency(&samples, omega) / omega;
    assert!((f - 1.0).abs() < 2e-3, "{f}");
}

#[test]
fn length_unit_leaves_the_motion_alone() {
    let mut lab = Lab::without_plugin(Engine::weightless());
    lab.app.add_plugins(CoiloverPlugin::default());
    lab.prime();
    let mut contexts = lab.app.world_mut().query::<&mut RapierContextSimulation>();
    let mut context = contexts
        .single_mut(lab.app.world_mut())
        .expect("one context");
    context.integration_parameters.length_unit = 100.0;
    let omega = 40.0_f64.sqrt();
    for (t, x) in trace(lab, Sleeping::disabled()) {
        assert!((x - 0.3 * (omega * t).cos()).abs() < 2e-5);
    }
}

/// In `TimestepMode::Interpolated`, transforms lag behind the bodies. This must not affect the physics.
#[test]
fn interpolated_transforms_do_not_feed_back() {
    let mut lab = Lab::without_plugin(Engine::weightless());
    lab.app.add_plugins(CoiloverPlugin::default());
    lab.app.insert_resource(TimestepMode::Interpolated {
        dt: 0.01,
        time_scale: 1.0,
        substeps: 1,
    });
    lab.prime();
    let hook = lab.point(Vec3::ZERO);
    let body = lab.body(1.0, Vec3::X * 1.3);
    lab.app
        .world_mut()
        .entity_mut(body)
        .insert(TransformInterpolation::default());
    let spring = lab.spawn(
        Spring::new(hook, body)
            .with_stiffness(40.0)
            .with_rest_length(1.0),
    );
    let omega = 40.0_f64.sqrt();
    // Simulated time is ahead of the ticks by whole engine steps. The readout belongs to the simulated time.
    let mut energies = Vec::new();
    for _ in 0..300 {
        lab.tick();
        let r = lab.readout(spring);
        let y = f64::from(r.length) - 1.0;
        energies.push(y * y + (f64::from(r.rate) / omega).powi(2));
    }
    for e in energies {
        assert!(
            (e.sqrt() / 0.3 - 1.0).abs() < 1e-4,
            "amplitude {}",
            e.sqrt()
        );
    }
}

#[test]
fn a_paused_pipeline_heaps_nothing_up() {
    let mut lab = engine(4, 1);
    let hook = lab.point(Vec3::ZERO);
    let body = lab.body(1.0, Vec3::X * 1.3);
    lab.spawn(
        Spring::new(hook, body)
            .with_stiffness(40.0)
            .with_rest_length(1.0),
    );
    lab.run(0.5);
    lab.set_stepping(false);
    lab.run(1.0);
    lab.set_stepping(true);
    let omega = 40.0_f64.sqrt();
    for i in 1..=60 {
        lab.tick();
        let t = 0.5 + f64::from(i) * f64::from(DT);
        let x = f64::from(lab.position(body).x) - 1.0;
        assert!((x - 0.3 * (omega * t).cos()).abs() < 2e-5, "{i}: {x}");
    }
}

#[test]
fn a_mass_that_changes_is_seen_in_the_same_tick() {
    let mut lab = engine(4, 1);
    let hook = lab.point(Vec3::ZERO);
    let body = lab.spawn((
        RigidBody::Dynamic,
        Transform::from_xyz(1.3, 0.0, 0.0),
        AdditionalMassProperties::Mass(1.0),
        Velocity::default(),
    ));
    lab.spawn(
        Spring::new(hook, body)
            .with_stiffness(40.0)
            .with_rest_length(1.0),
    );
    lab.run(0.5);
    let (x, v) = (lab.position(body).x - 1.0, lab.velocity(body).x);
    lab.app
        .world_mut()
        .entity_mut(body)
        .insert(AdditionalMassProperties::Mass(4.0));
    lab.tick();
    let omega = 10.0_f32.sqrt();
    let wanted = x * (omega * DT).cos() + v / omega * (omega * DT).sin();
    let y = lab.position(body).x - 1.0;
    assert!((y - wanted).abs() < 1e-6, "{y} against {wanted}");
}
