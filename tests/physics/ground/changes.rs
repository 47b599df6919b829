//! Changes that a game makes to an element on the ground: its coefficients, its component kind, the places of its bodies,
//! and the removal of the ground.

use super::scenes::*;
use super::stand::*;
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// Puts the bodies of `setup` on the ground and lets them come to rest.
fn parked(setup: &Footed) -> (Stand, Placed, Entity) {
    let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
    let ground = scene.ground();
    let placed = setup.put(&mut scene);
    scene.lab.run(10.0);
    (scene, placed, ground)
}

#[test]
fn changed_numbers_are_followed_without_a_jump() {
    for (plain, name) in [
        (Footed::quarter_car(), "car"),
        (
            Footed {
                drop: 0.0,
                ..Footed::foot()
            },
            "foot",
        ),
    ] {
        for (times, longer) in [(2.0, 0.0), (0.6, 0.0), (1.0, 0.1), (1.0, -0.1), (4.0, 0.05)] {
            let (mut scene, placed, _) = parked(&plain);
            let setup = Footed {
                law: [times * plain.law[0], plain.law[1]],
                rest: plain.rest + longer,
                drop: 0.0,
                ..plain.clone()
            };
            let mut element = scene.lab.get_mut::<SpringDamper>(placed.element);
            (element.stiffness, element.rest_length) = (setup.law[0], Some(setup.rest));
            scene.coils[0].stiffness = setup.law[0];
            scene.coils[0].rest_length = setup.rest;
            let first = scene.energy() - setup.floor();
            let most = (scene.most(15.0) - setup.floor()) / first;
            let sag = setup.sag_now(&scene) / setup.sag();
            println!(
                "{name}, stiffness × {times}, {longer} m longer: E × {most:.4}, sag × {sag:.5}, {} awake",
                scene.awake()
            );
            assert!(most < 1.02, "{name} {times} {longer}: E × {most}");
            assert!((sag - 1.0).abs() < 0.01, "{name} {times} {longer}: {sag}");
            assert_eq!(scene.awake(), 0, "{name} {times} {longer}: it sleeps");
        }
    }
}

#[test]
fn a_spring_may_become_a_pair_and_then_nothing() {
    let setup = Footed {
        drop: 0.0,
        ..Footed::foot()
    };
    let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
    scene.ground();
    let placed = setup.put(&mut scene);
    let [a, b] = [placed.above, placed.below];
    let world = scene.lab.app.world_mut();
    world
        .entity_mut(placed.element)
        .remove::<SpringDamper>()
        .insert(
            Spring::new(a, b)
                .with_stiffness(setup.law[0])
                .with_rest_length(setup.rest),
        );
    scene.lab.tick();
    let first = scene.energy() - setup.floor();
    let bare = (scene.most(3.0) - setup.floor()) / first;
    let world = scene.lab.app.world_mut();
    world.entity_mut(placed.element).remove::<Spring>().insert(
        SpringDamper::new(a, b)
            .with_stiffness(setup.law[0])
            .with_damping(setup.law[1])
            .with_rest_length(setup.rest),
    );
    let damped = (scene.most(20.0) - setup.floor()) / first;
    let sag = setup.sag_now(&scene) / setup.sag();
    let held = joints(&mut scene);
    scene
        .lab
        .app
        .world_mut()
        .entity_mut(placed.element)
        .remove::<SpringDamper>();
    let before = scene.lab.velocity(a).y;
    scene.lab.run(0.2);
    let fall = f64::from(scene.lab.velocity(a).y - before) / (0.2 * GRAVITY);
    let left = joints(&mut scene);
    println!(
        "spring: E × {bare:.4}; with a damper E × {damped:.4}, sag × {sag:.5}, {held} joints; then falls at {fall:.5} g, {left} joints"
    );
    assert!(bare < 1.02 && damped < 1.02);
    assert!((sag - 1.0).abs() < 0.01);
    assert!((fall + 1.0).abs() < 1e-3, "{fall}");
    assert_eq!(left, 1, "the guide alone");
}

#[test]
fn what_is_put_elsewhere_wins_only_what_its_place_gives() {
    for (name, load, both) in [
        ("all sideways", Vec3::ZERO, Vec3::X * 20.0),
        ("all up", Vec3::ZERO, Vec3::Y * 1.0),
        ("the load up", Vec3::Y * 0.1, Vec3::ZERO),
        ("the load down", Vec3::NEG_Y * 0.1, Vec3::ZERO),
    ] {
        for setup in [
            Footed::quarter_car(),
            Footed {
                drop: 0.0,
                rest: 1.0,
                ..Footed::foot()
            },
        ] {
            let (mut scene, placed, _) = parked(&setup);
            scene.lab.get_mut::<Transform>(placed.above).translation += load + both;
            scene.lab.get_mut::<Transform>(placed.below).translation += both;
            let first = scene.energy() - setup.floor();
            let most = scene.most(20.0) - setup.floor();
            let sag = setup.sag_now(&scene) / setup.sag();
            println!(
                "{name}: {first:.2} J, at most {most:.2} J, sag × {sag:.5}, {} awake",
                scene.awake()
            );
            // Moved sideways, the bodies start at rest with no energy but rounding, so 0.5 J is allowed.
            assert!(most < 1.02 * first + 0.5, "{name}: {first} J, {most} J");
            assert!((sag - 1.0).abs() < 0.01, "{name}: {sag}");
            assert_eq!(scene.awake(), 0, "{name}: it sleeps");
        }
    }
}

#[test]
fn without_its_ground_it_falls_freely() {
    for setup in [
        Footed::quarter_car(),
        Footed {
            drop: 0.0,
            ..Footed::foot()
        },
    ] {
        let (mut scene, placed, ground) = parked(&setup);
        let first = scene.energy();
        let middle = |scene: &Stand| {
            let of = |body, mass: f32| f64::from(mass * scene.lab.velocity(body).y);
            let sum = of(placed.above, setup.load) + of(placed.below, setup.foot);
            sum / f64::from(setup.load + setup.foot)
        };
        let before = middle(&scene);
        scene.lab.app.world_mut().despawn(ground);
        let mut drift = 0.0_f64;
        for _ in 0..scene.lab.ticks(1.0) {
            scene.lab.tick();
            drift = drift.max(scene.energy() - first);
        }
        let fall = (middle(&scene) - before) / GRAVITY;
        let motion = scene.motion();
        let method = scene.lab.readout(placed.element).method;
        println!("no ground: falls at {fall:.5} g, wins {drift:.3} J of {motion:.0}, {method:?}");
        assert!((fall + 1.0).abs() < 2e-3, "{fall}");
        assert!(drift < 0.02 * motion, "{drift} J of {motion}");
    }
}

#[test]
fn what_stood_on_the_ground_flies_as_if_it_never_had() {
    // No guide joint, so that nothing holds the bodies once the ground is gone.
    let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
    let ground = scene.ground();
    let ball = |at: f32| {
        (
            Transform::from_xyz(0.0, at, 0.0),
            (
                Collider::ball(0.1),
                ColliderMassProperties::Mass(1.0),
                LockedAxes::ROTATION_LOCKED
                    | LockedAxes::TRANSLATION_LOCKED_X
                    | LockedAxes::TRANSLATION_LOCKED_Z,
            ),
        )
    };
    let ends = [0.9, 0.1].map(|at| {
        let (place, rest) = ball(at);
        scene.body(place, rest)
    });
    let element = scene.coil(ends, [Vec3::ZERO; 2], [500.0, 5.0], None);
    scene.lab.run(10.0);
    let held = (joints(&mut scene), scene.lab.readout(element).method);
    let middle = |scene: &Stand| {
        let [a, b] = ends.map(|body| f64::from(scene.lab.velocity(body).y));
        0.5 * (a + b)
    };
    let fall = |scene: &mut Stand, seconds: f64| {
        let before = middle(scene);
        scene.lab.run(seconds);
        (middle(scene) - before) / (seconds * GRAVITY)
    };
    scene.lab.app.world_mut().despawn(ground);
    let early = fall(&mut scene, 0.5);
    let late = fall(&mut scene, 0.5);
    let free = (joints(&mut scene), scene.lab.readout(element).method);
    println!("on the ground {held:?}; then {free:?}, fell at {early:.5} g, then at {late:.5} g");
    // When the bodies return from the engine's solver, half a substep of gravity may be off once.
    assert!((early + 1.0).abs() < 2e-3, "{early}");
    assert!((late + 1.0).abs() < 1e-4, "{late}");
    assert_eq!(
        free,
        (0, SpringMethod::ClosedForm),
        "nothing is left in the engine"
    );
}

#[test]
fn a_load_that_grows_heavier_is_known_in_the_next_steps() {
    let (mut scene, placed, _) = parked(&Footed::quarter_car());
    let before = scene.lab.readout(placed.element).effective_mass;
    let world = scene.lab.app.world_mut();
    let mut load = world.entity_mut(placed.above);
    load.insert(AdditionalMassProperties::Mass(3.0 * before));
    scene.lab.run(0.1);
    let after = scene.lab.readout(placed.element).effective_mass;
    let mass = scene.lab.get::<ReadMassProperties>(placed.above).get().mass;
    println!("{before:.2} kg, then {after:.2} kg of {mass:.2} kg");
    assert!((after / mass - 1.0).abs() < 0.02, "{after} kg of {mass} kg");
}

/// Greatest energy, over that at first, of two balls on a stiff spring that fly down at 20 m/s from 0.1 m and less above the
/// ground. They are put there from far away after `wait` ticks, or are there from the beginning.
fn thrown_down(gap: f32, wait: usize) -> f64 {
    let mut scene = Stand::new(CoiloverPlugin::default(), Engine::weightless());
    scene.ground();
    let far = if wait > 0 { 20.0 } else { 0.0 };
    let ends = [1.1, 0.1].map(|at: f32| {
        let ball = (
            Collider::ball(0.1),
            ColliderMassProperties::Mass(1.0),
            LockedAxes::ROTATION_LOCKED
                | LockedAxes::TRANSLATION_LOCKED_X
                | LockedAxes::TRANSLATION_LOCKED_Z,
        );
        scene.body(Transform::from_xyz(0.0, far + gap + at, 0.0), ball)
    });
    scene.coil(ends, [Vec3::ZERO; 2], [7200.0, 0.0], Some(1.0));
    for _ in 0..wait {
        scene.lab.tick();
    }
    for body in ends {
        scene.lab.get_mut::<Transform>(body).translation.y -= far;
        scene.lab.get_mut::<Velocity>(body).linear = Vec3::NEG_Y * 20.0;
    }
    scene.most(0.5) / 400.0
}

#[test]
fn what_is_thrown_at_the_ground_from_far_away_wins_no_more_than_what_starts_there() {
    for gap in [0.02, 0.1, 0.2, 0.3] {
        let there = thrown_down(gap, 0);
        for wait in 1..=10 {
            let most = thrown_down(gap, wait);
            println!(
                "thrown from {gap} m after {wait} ticks: E × {most:.4}, from the start × {there:.4}"
            );
            assert!(
                most < there.max(1.0) + 0.005,
                "{gap} {wait}: E × {most} {there}"
            );
        }
    }
}
