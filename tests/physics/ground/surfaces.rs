//! What counts as a surface that holds a body: meshes, gentle landings and skins do; sensors and ghosts do not.

use super::rolling::{Ground, ground};
use super::scenes::joints;
use super::stand::*;
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

const LOAD: f32 = 100.0;
const WHEEL: f32 = 20.0;
const RADIUS: f32 = 0.3;

const ROADS: [Ground; 5] = [
    Ground::HalfSpace,
    Ground::Cuboid,
    Ground::Flags,
    Ground::Trimesh,
    Ground::HeightField,
];

/// A load that is guided up and down.
fn load(scene: &mut Stand, at: Vec3) -> Entity {
    let guided = LockedAxes::ROTATION_LOCKED
        | LockedAxes::TRANSLATION_LOCKED_X
        | LockedAxes::TRANSLATION_LOCKED_Z;
    let mass = AdditionalMassProperties::Mass(LOAD);
    scene.body(Transform::from_translation(at), (mass, guided))
}

/// A load over a wheel, `gap` metres above a road. Returns the scene and the spring.
fn on_wheel(road: Ground, gap: f32, skin: f32, stiffness: f32) -> (Stand, Entity) {
    let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
    ground(&mut scene, road);
    let load = load(&mut scene, Vec3::new(0.13, 1.0, 0.07));
    let wheel = (
        Collider::ball(RADIUS),
        ColliderMassProperties::Mass(WHEEL),
        ContactSkin(skin),
    );
    let at = Transform::from_xyz(0.13, RADIUS + skin + gap, 0.07);
    let wheel = scene.body(at, wheel);
    let damping = 0.6 * (stiffness * LOAD).sqrt();
    let element = scene.coil([load, wheel], [Vec3::ZERO; 2], [stiffness, damping], None);
    (scene, element)
}

#[test]
fn on_every_kind_of_road_a_wheel_counts_as_held() {
    for road in ROADS {
        let (mut scene, element) = on_wheel(road, 0.0, 0.0, 30e3);
        scene.lab.run(0.5);
        let mass = scene.lab.readout(element).effective_mass;
        println!("{road:?}: effective mass {mass:.2} kg");
        assert!((mass / LOAD - 1.0).abs() < 0.01, "{road:?}: {mass} kg");
    }
}

#[test]
fn on_every_kind_of_road_a_spring_is_tuned_for_its_load() {
    for road in ROADS {
        let (mut scene, element) = on_wheel(road, 0.0, 0.0, 30e3);
        let world = scene.lab.app.world_mut();
        world
            .entity_mut(element)
            .insert(SpringTuning::frequency(1.5, 0.3));
        scene.lab.run(0.2);
        let stiffness = scene.lab.get::<SpringDamper>(element).stiffness;
        let omega = std::f32::consts::TAU * 1.5;
        let wanted = LOAD * omega * omega;
        println!("{road:?}: {stiffness:.0} N/m of {wanted:.0}");
        assert!(
            (stiffness / wanted - 1.0).abs() < 0.01,
            "{road:?}: {stiffness}"
        );
    }
}

#[test]
fn a_wheel_that_settles_gently_is_held_and_so_is_one_with_a_skin() {
    for (gap, skin) in [(0.0, 0.0), (0.015, 0.0), (0.0, 0.02), (0.01, 0.01)] {
        let (mut scene, element) = on_wheel(Ground::HalfSpace, gap, skin, 5e3);
        scene.lab.run(3.0);
        let read = scene.lab.readout(element);
        println!(
            "gap {gap} m, skin {skin} m: {:?}, {:.2} kg",
            read.method, read.effective_mass
        );
        assert_eq!(read.method, SpringMethod::Engine, "{gap} {skin}");
        assert!(
            (read.effective_mass / LOAD - 1.0).abs() < 0.01,
            "{gap} {skin}"
        );
    }
}

#[test]
fn a_crate_that_lies_on_the_ground_counts_as_fixed_wherever_a_spring_stands_on_it() {
    for at in [Vec3::new(0.3, 0.5, 0.2), Vec3::new(-0.4, 0.5, 0.1)] {
        let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
        ground(&mut scene, Ground::HalfSpace);
        let load = load(&mut scene, at.with_y(2.0));
        let lying = (
            Collider::cuboid(0.5, 0.5, 0.5),
            ColliderMassProperties::Mass(LOAD),
        );
        let lying = scene.body(Transform::from_xyz(0.0, 0.5, 0.0), lying);
        let element = scene.coil([load, lying], [Vec3::ZERO, at], [30e3, 2e3], None);
        scene.lab.run(1.0);
        let mass = scene.lab.readout(element).effective_mass;
        println!("at {at}: effective mass {mass:.2} kg");
        assert!((mass / LOAD - 1.0).abs() < 0.01, "at {at}: {mass} kg");
    }
}

/// Two balls on a stiff spring that fly sideways, close above a floor. What else they carry is `with`.
fn above_floor(with: impl Bundle + Clone, floor: impl Bundle) -> SpringMethod {
    let mut scene = Stand::new(CoiloverPlugin::default(), Engine::weightless());
    let ground = scene.ground();
    scene.lab.app.world_mut().entity_mut(ground).insert(floor);
    let ends = [-0.5_f32, 0.5].map(|x| {
        let ball = (Collider::ball(0.1), ColliderMassProperties::Mass(1.0));
        let body = scene.body(Transform::from_xyz(x, 1.0, 0.0), ball);
        let world = scene.lab.app.world_mut();
        world.spawn((ChildOf(body), Transform::default(), with.clone()));
        body
    });
    let element = scene.coil(ends, [Vec3::ZERO; 2], [5e3, 5.0], Some(0.95));
    scene.lab.run(1.0);
    scene.lab.readout(element).method
}

#[test]
fn what_collides_with_nothing_is_held_by_nothing() {
    let big = (Collider::ball(3.0), ColliderMassProperties::Mass(0.0));
    let solid = above_floor(big.clone(), ());
    let sensor = above_floor((big.clone(), Sensor), ());
    let disabled = above_floor((big.clone(), ColliderDisabled), ());
    let ghost = SolverGroups::new(Group::GROUP_2, Group::NONE);
    let ghost = above_floor(
        (big, ghost),
        SolverGroups::new(Group::GROUP_1, Group::GROUP_1),
    );
    println!("solid {solid:?}, sensor {sensor:?}, disabled {disabled:?}, ghost {ghost:?}");
    assert_eq!(solid, SpringMethod::Engine);
    assert_ne!(sensor, SpringMethod::Engine);
    assert_ne!(disabled, SpringMethod::Engine);
    assert_ne!(ghost, SpringMethod::Engine);
}

#[test]
fn a_held_spring_goes_on_while_the_body_at_its_other_end_is_disabled() {
    let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
    let load = scene.guided(Vec3::NEG_Y, 10.0);
    let hook = scene
        .lab
        .spawn((RigidBody::Dynamic, Transform::from_xyz(0.0, 1.0, 0.0)));
    let heavy = (AdditionalMassProperties::Mass(1e3), GravityScale(0.0));
    scene.lab.app.world_mut().entity_mut(hook).insert(heavy);
    let element = scene.coil([hook, load], [Vec3::ZERO; 2], [1e3, 60.0], None);
    scene.lab.tick();
    let before = scene.lab.position(hook);
    let world = scene.lab.app.world_mut();
    world.entity_mut(hook).insert(RigidBodyDisabled);
    scene.lab.run(8.0);
    let disabled = f64::from(scene.lab.readout(element).length) - 2.0;
    assert!(scene.lab.position(hook).distance(before) < 0.01);
    let world = scene.lab.app.world_mut();
    world.entity_mut(hook).remove::<RigidBodyDisabled>();
    scene.lab.run(0.5);
    let way = scene.lab.position(hook) - before;
    let sag = 10.0 * GRAVITY / 1e3;
    println!(
        "sag {disabled:.4} m of {sag:.4} m; enabled again, the hook goes {way} m, {} joints",
        joints(&mut scene)
    );
    assert!((disabled / sag - 1.0).abs() < 0.01);
    assert!(way.y < -0.005, "it moves again: {way}");
}
