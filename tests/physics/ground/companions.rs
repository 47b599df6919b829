//! Companion components of elements that the ground holds: laws, stops, ropes, axes and force limits.

use super::scenes::*;
use super::stand::*;
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// Energy of the scene, with the stored energy that the element itself reports, J.
fn energy(scene: &Stand, element: Entity) -> f64 {
    let stored = f64::from(scene.lab.readout(element).stored_energy);
    scene.energy() - scene.stored() + stored
}

/// Drops a quarter car with a companion component. Returns whether it rests at the given sag in m, gains no energy and sleeps.
fn stands(name: &str, stiffness: f32, sag: f64, companion: impl Bundle) -> bool {
    let setup = Footed {
        drop: 0.1,
        ..Footed::quarter_car()
    };
    let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
    scene.ground();
    let placed = setup.put(&mut scene);
    let world = scene.lab.app.world_mut();
    world.entity_mut(placed.element).insert(companion);
    scene.lab.get_mut::<SpringDamper>(placed.element).stiffness = stiffness;
    let mut most = f64::NEG_INFINITY;
    let mut first = 0.0;
    for i in 0..scene.lab.ticks(20.0) {
        scene.lab.tick();
        if i == 0 {
            first = energy(&scene, placed.element);
        }
        most = most.max(energy(&scene, placed.element));
    }
    // The load falls by at least the drop and the sag. A gain is compared with the energy of that fall.
    let last = energy(&scene, placed.element);
    let most = (most - last) / (first - last);
    let ratio = setup.sag_now(&scene) / sag;
    let (force, awake) = (scene.lab.readout(placed.element).force(), scene.awake());
    println!("{name}: sag × {ratio:.5}, {force:.1} N, E × {most:.4}, {awake} awake");
    (ratio - 1.0).abs() < 0.01 && most < 1.02 && awake == 0
}

#[test]
fn whatever_its_law_a_load_rests_where_statics_say() {
    let weight = 300.0 * GRAVITY as f32;
    let mut good = Vec::new();
    let sag = 0.1_f64;
    good.push(stands("cubic", weight / 1e-3, sag, SpringLaw::Cubic));
    let half = 0.5 * weight;
    let both = SpringLaw::polynomial(half / 0.1, 0.0, half / 1e-3);
    good.push(stands("linear and cubic", 1.0, sag, both));
    let table = SpringLaw::table([
        (-0.3, -4.0 * weight),
        (-0.1, -weight),
        (0.0, 0.0),
        (0.3, weight),
    ]);
    good.push(stands("table", 1.0, sag, table));
    let own = CustomSpringLaw::new(move |x: f64| f64::from(weight) / 0.1_f64.sinh() * x.sinh());
    good.push(stands("a law of one's own", 1.0, sag, own));
    let k = weight / 0.1;
    good.push(stands("pushes only", k, sag, SpringAction::Push));
    good.push(stands(
        "axis of the world",
        k,
        sag,
        SpringAxis::World(Vec3::NEG_Y),
    ));
    good.push(stands(
        "axis of the load",
        k,
        sag,
        SpringAxis::BodyA(Vec3::NEG_Y),
    ));
    let damping = DampingLaw::sided(1e3, 3e3);
    good.push(stands("sided damper", k, sag, damping));
    good.push(stands(
        "most force above the weight",
        k,
        sag,
        MaxForce(3.0 * weight),
    ));
    // A soft spring on its bump stop. Each of them carries half of the weight.
    let soft = half / 0.2;
    let travel = SpringTravel::new(0.31, f32::INFINITY, half / 0.01).with_stop_damping(500.0);
    good.push(stands("on a bump stop", soft, 0.2, travel));
    assert!(good.iter().all(|good| *good), "{good:?}");
}

#[test]
fn along_an_axis_the_ends_may_be_apart_across_it() {
    for (name, axis) in [
        ("of the world", SpringAxis::World(Vec3::NEG_Y)),
        ("of the load", SpringAxis::BodyA(Vec3::NEG_Y)),
    ] {
        let setup = Footed::foot();
        let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
        scene.ground();
        let placed = setup.put(&mut scene);
        let world = scene.lab.app.world_mut();
        world
            .entity_mut(placed.element)
            .insert((axis, Anchors::new(Vec3::X * 0.2, Vec3::NEG_X * 0.05)));
        scene.lab.tick();
        let first = scene.energy() - setup.floor();
        let most = (scene.most(20.0) - setup.floor()) / first;
        let sag = setup.sag_now(&scene) / setup.sag();
        println!(
            "axis {name}: sag × {sag:.5}, E × {most:.4}, {} awake",
            scene.awake()
        );
        assert!(most < 1.02, "{name}: E × {most}");
        assert!((sag - 1.0).abs() < 0.01, "{name}: {sag}");
        assert_eq!(scene.awake(), 0, "{name}: it sleeps");
    }
}

#[test]
fn along_an_axis_of_the_world_nothing_turns_what_is_held_by_its_centre() {
    let weight = 5.0 * GRAVITY as f32;
    for (k, c, seconds) in [
        (0.0, 50.0, 0.8),
        (0.0, 500.0, 0.8),
        (0.0, 1e4, 0.8),
        (1e3, 1.0, 5.0),
        (1e4, 10.0, 5.0),
        (1e6, 100.0, 5.0),
        (1e3, 1e4, 5.0),
    ] {
        let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
        scene.ground();
        let lying = scene.cube(Vec3::new(0.0, 0.25, 0.0), 20.0);
        // Far to the side: a force on one body that acts at the place of the other would turn it fast.
        let hung = scene.cube(Vec3::new(0.6, 2.0, 0.0), 5.0);
        let element = scene.coil([hung, lying], [Vec3::ZERO; 2], [k, c], Some(1.75));
        let axis = SpringAxis::World(Vec3::NEG_Y);
        scene.lab.app.world_mut().entity_mut(element).insert(axis);
        let (mut spin, mut speed) = (0.0_f32, 0.0_f32);
        for _ in 0..scene.lab.ticks(seconds) {
            scene.lab.tick();
            let now = scene.lab.get::<Velocity>(hung);
            spin = spin.max(now.angular.length());
            speed = speed.max(now.linear.length());
        }
        let last = scene.lab.velocity(hung).y;
        println!("{k} N/m, {c} N s/m: up to {speed} m/s, {spin} rad/s, {last} m/s at last");
        assert!(spin < 1e-3, "{k}, {c}: {spin}");
        if k == 0.0 {
            let wanted = -weight / c;
            assert!((last / wanted - 1.0).abs() < 0.05, "{c}: {last}");
        } else {
            // A load released at rest reaches a speed of g/ω.
            let most = GRAVITY as f32 * (5.0 / k).sqrt();
            assert!(speed < 1.02 * most, "{k}, {c}: {speed} of {most}");
        }
    }
}

/// A box of 5 kg on the ground, and a spring from it up to a hand. Returns the scene, and the hand, the box and the spring.
fn hand(k: f32, rest: f32, companion: impl Bundle) -> (Stand, [Entity; 3]) {
    let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
    scene.ground();
    let load = scene.body(
        Transform::from_xyz(0.0, 0.25, 0.0),
        (
            Collider::cuboid(0.25, 0.25, 0.25),
            ColliderMassProperties::Mass(5.0),
        ),
    );
    let hand = scene.lab.spawn((
        RigidBody::KinematicPositionBased,
        Transform::from_xyz(0.0, 1.25, 0.0),
    ));
    let c = 0.2 * (k * 5.0).sqrt();
    let rope = scene.coil([hand, load], [Vec3::ZERO; 2], [k, c], Some(rest));
    scene.lab.app.world_mut().entity_mut(rope).insert(companion);
    (scene, [hand, load, rope])
}

#[test]
fn a_rope_lies_slack_and_then_lifts_its_load() {
    for k in [1e3, 1e4, 1e5] {
        let (mut scene, [hand, load, rope]) = hand(k, 1.2, SpringAction::Pull);
        let still = scene.wander(5.0);
        let slack = scene.lab.readout(rope).force();
        let (mut fastest, mut highest) = (0.0_f64, 0.0_f32);
        for i in 1..=180 {
            scene.lab.get_mut::<Transform>(hand).translation.y = 1.25 + 0.5 * DT * i as f32;
            scene.lab.tick();
            fastest = fastest.max(scene.speed());
            highest = highest.max(scene.lab.readout(rope).force());
        }
        scene.lab.run(20.0);
        let wanted = f64::from(scene.lab.position(hand).y) - 1.2 - 5.0 * GRAVITY / f64::from(k);
        let off = f64::from(scene.lab.position(load).y) - wanted;
        let force = scene.lab.readout(rope).force();
        // A load that is lifted off at a speed v swings up to a speed of 2 v. The force of its rope swings up to m g + v √(k m).
        let most = 5.0 * GRAVITY as f32 + 0.5 * (k * 5.0).sqrt();
        println!(
            "rope of {k} N/m: slack {slack} N, {still:.1e} m; lifted at up to {fastest:.3} m/s and {highest:.1} N of {most:.1}; hangs {off:.1e} m off, {force:.2} N, {} awake",
            scene.awake()
        );
        assert!(slack == 0.0 && still < 1e-4, "{k}: {slack} {still}");
        assert!(
            fastest < 1.02 && highest < 1.02 * most,
            "{k}: {fastest} {highest}"
        );
        assert!(
            off.abs() < 1e-4 && (force - 49.05).abs() < 0.05,
            "{k}: {off} {force}"
        );
    }
}

#[test]
fn with_less_force_than_the_weight_nothing_is_lifted() {
    for k in [1e3, 1e4] {
        let (mut scene, [_, load, spring]) = hand(k, 0.2, MaxForce(40.0));
        scene.lab.run(10.0);
        let (wander, force) = (scene.wander(5.0), scene.lab.readout(spring).force());
        let y = scene.lab.position(load).y;
        println!("{k} N/m, 40 N at most: at {y:.5} m with {force:.3} N, wanders {wander:.1e} m");
        assert!((force - 40.0).abs() < 0.01, "{force} N");
        assert!((y - 0.25).abs() < 2e-3 && wander < 1e-4, "{y} {wander}");
    }
}
