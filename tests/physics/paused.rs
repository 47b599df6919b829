//! Do changes made while the engine is paused, or between the steps of an interpolated game, act when it goes on?

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// A sleeping weight on a spring below a post.
struct Hung {
    lab: Lab,
    post: Entity,
    weight: Entity,
    spring: Entity,
    slept_at: Vec3,
}

impl Hung {
    /// With `watched`, another body flies by. It keeps the engine's bodies under observation in every tick.
    fn new(mut lab: Lab, watched: bool) -> Self {
        let post = lab.spawn((RigidBody::Fixed, Transform::default()));
        let weight = lab.body(1.0, Vec3::NEG_Y);
        let spring = SpringDamper::new(post, weight)
            .with_stiffness(200.0)
            .with_damping(25.0)
            .with_rest_length(1.0);
        let spring = lab.spawn(spring);
        if watched {
            let far = lab.body(1.0, Vec3::Z * 1e3);
            let flies = (GravityScale(0.0), Velocity::linear(Vec3::Z));
            lab.app.world_mut().entity_mut(far).insert(flies);
        }
        lab.run(12.0);
        assert!(lab.is_sleeping(weight));
        let slept_at = lab.position(weight);
        Self {
            lab,
            post,
            weight,
            spring,
            slept_at,
        }
    }

    /// Rise of the weight, m, in the five seconds after a pause during which `change` happens.
    fn rises(mut self, change: impl FnOnce(&mut Self)) -> f32 {
        self.lab.set_stepping(false);
        self.lab.tick();
        change(&mut self);
        self.lab.tick();
        self.lab.tick();
        self.lab.set_stepping(true);
        self.lab.run(5.0);
        self.lab.position(self.weight).y - self.slept_at.y
    }
}

#[test]
fn a_post_moved_while_the_engine_rests_lifts_what_hangs_from_it() {
    for watched in [false, true] {
        let rose = Hung::new(Lab::new(), watched).rises(|hung| {
            hung.lab.get_mut::<Transform>(hung.post).translation.y += 0.5;
        });
        assert!((rose - 0.5).abs() < 0.01, "watched {watched}: {rose} m");
    }
}

#[test]
fn a_spring_shortened_while_the_engine_rests_pulls_even_if_others_come() {
    let rose = Hung::new(Lab::new(), false).rises(|hung| {
        hung.lab.get_mut::<SpringDamper>(hung.spring).rest_length = Some(0.5);
        hung.lab.tick();
        let far = hung.lab.body(1.0, Vec3::Z * 1e3);
        let hook = hung.lab.point(Vec3::new(0.0, 1.0, 1e3));
        hung.lab.spawn(Spring::new(hook, far));
    });
    assert!((rose - 0.5).abs() < 0.01, "{rose} m");
}

#[test]
fn a_weight_moved_while_the_engine_rests_is_held_from_its_first_step() {
    let motion = |watched| {
        let mut hung = Hung::new(Lab::new(), watched);
        hung.lab.set_stepping(false);
        hung.lab.tick();
        hung.lab.get_mut::<Transform>(hung.weight).translation.y -= 0.5;
        hung.lab.tick();
        hung.lab.tick();
        hung.lab.set_stepping(true);
        let ticks = 0..30;
        ticks
            .map(|_| {
                hung.lab.tick();
                hung.lab.position(hung.weight)
            })
            .collect::<Vec<_>>()
    };
    assert_eq!(motion(true), motion(false));
}

#[test]
fn a_post_moved_between_interpolated_steps_lifts_what_hangs_from_it() {
    for phase in 0..3 {
        let frame = DT / 3.0;
        let mut lab = Lab::without_plugin(Engine {
            dt: frame,
            ..default()
        });
        lab.app.add_plugins(CoiloverPlugin::default());
        let mode = TimestepMode::Interpolated {
            dt: DT,
            time_scale: 1.0,
            substeps: 1,
        };
        lab.app.insert_resource(mode);
        lab.prime();
        // Twelve seconds of frames, not of physics steps.
        let mut hung = Hung::new(lab, false);
        for _ in 0..24 * 60 + phase {
            hung.lab.tick();
        }
        let slept_at = hung.lab.position(hung.weight);
        hung.lab.get_mut::<Transform>(hung.post).translation.y += 0.5;
        for _ in 0..15 * 60 {
            hung.lab.tick();
        }
        let rose = hung.lab.position(hung.weight).y - slept_at.y;
        assert!((rose - 0.5).abs() < 0.01, "phase {phase}: {rose} m");
    }
}

/// Adds a physics world beside the default one.
fn second_world(lab: &mut Lab, gravity: Vec3) -> RapierContextEntityLink {
    let engine = RapierConfiguration {
        gravity,
        ..RapierConfiguration::new(1.0)
    };
    let world = lab.spawn((RapierContextSimulation::default(), engine));
    lab.tick();
    RapierContextEntityLink(world)
}

#[test]
fn what_changes_in_a_world_that_rests_while_another_runs_acts_when_it_goes_on() {
    for change in 0..2 {
        let mut lab = Lab::new();
        let link = second_world(&mut lab, Vec3::NEG_Y * GRAVITY as f32);
        let post = lab.spawn((RigidBody::Fixed, Transform::default(), link));
        let arm = lab.spawn((Transform::default(), ChildOf(post)));
        let weight = lab.body(1.0, Vec3::NEG_Y);
        lab.app.world_mut().entity_mut(weight).insert(link);
        let spring = SpringDamper::new(arm, weight)
            .with_stiffness(200.0)
            .with_damping(25.0)
            .with_rest_length(1.0);
        let spring = lab.spawn(spring);
        lab.run(12.0);
        assert!(lab.is_sleeping(weight));
        let slept_at = lab.position(weight).y;
        let runs = |lab: &mut Lab, runs: bool| {
            lab.get_mut::<RapierConfiguration>(link.0)
                .physics_pipeline_active = runs;
        };
        runs(&mut lab, false);
        lab.tick();
        match change {
            0 => lab.get_mut::<Transform>(arm).translation.y += 0.5,
            _ => lab.get_mut::<SpringDamper>(spring).rest_length = Some(0.5),
        }
        lab.run(0.1);
        runs(&mut lab, true);
        lab.run(5.0);
        let rose = lab.position(weight).y - slept_at;
        assert!((rose - 0.5).abs() < 0.01, "change {change}: {rose} m");
    }
}

#[test]
fn equal_networks_in_two_worlds_take_in_the_same_change() {
    let mut lab = Lab::weightless();
    let link = second_world(&mut lab, Vec3::ZERO);
    let mut springs = Vec::new();
    for second in [false, true] {
        let bodies = [0.0, 1.2, 2.4].map(|x| lab.body(1.0, Vec3::X * x));
        if second {
            for body in bodies {
                lab.app.world_mut().entity_mut(body).insert(link);
            }
        }
        for pair in bodies.windows(2) {
            let spring = SpringDamper::new(pair[0], pair[1])
                .with_stiffness(40.0)
                .with_damping(1.0)
                .with_rest_length(1.0);
            springs.push(lab.spawn(spring));
        }
    }
    lab.run(1.0);
    for spring in &springs {
        lab.get_mut::<SpringDamper>(*spring).rest_length = Some(0.5);
    }
    lab.run(5.0);
    let lengths: Vec<_> = springs.iter().map(|s| lab.readout(*s).length).collect();
    assert!(lengths[0] < 0.6, "{lengths:?}");
    assert!((lengths[0] - lengths[2]).abs() < 1e-5, "{lengths:?}");
}

#[test]
fn a_world_that_rests_turns_nothing_into_heat_while_another_runs() {
    let mut lab = Lab::weightless();
    let link = second_world(&mut lab, Vec3::ZERO);
    let (hook, swings) = (lab.point(Vec3::ZERO), lab.body(1.0, Vec3::X * 1.5));
    lab.spawn(
        Spring::new(hook, swings)
            .with_stiffness(40.0)
            .with_rest_length(1.0),
    );
    let led = |lab: &mut Lab, speed: f32| {
        let body = RigidBody::KinematicVelocityBased;
        let velocity = Velocity::linear(Vec3::X * speed);
        lab.spawn((body, Transform::from_xyz(speed, 1.0, 0.0), velocity, link))
    };
    let (a, b) = (led(&mut lab, 0.0), led(&mut lab, 1.0));
    let damper = lab.spawn(Damper::new(a, b).with_damping(3.0));
    lab.run(0.5);
    let before = lab.readout(damper);
    assert!(before.dissipated_energy > 1.0, "{before:?}");
    lab.get_mut::<RapierConfiguration>(link.0)
        .physics_pipeline_active = false;
    lab.run(1.0);
    assert_eq!(lab.readout(damper), before);
}

/// A floor, a box on it, a point, and a spring from the point to the box, in the given world.
fn box_on_floor(lab: &mut Lab, link: RapierContextEntityLink) -> [Entity; 4] {
    let below = Transform::from_xyz(0.0, -0.5, 0.0);
    let floor = lab.spawn((Collider::cuboid(5.0, 0.5, 5.0), below, link));
    let at = Transform::from_xyz(0.0, 0.2, 0.0);
    let block = Collider::cuboid(0.2, 0.2, 0.2);
    let mass = ColliderMassProperties::Mass(2.0);
    let block = lab.spawn((RigidBody::Dynamic, block, mass, at, link));
    let hook = lab.point(Vec3::Y);
    let spring = SpringDamper::new(hook, block)
        .with_stiffness(20.0)
        .with_damping(2.0)
        .with_rest_length(0.5);
    [floor, block, hook, lab.spawn(spring)]
}

fn first_world(lab: &mut Lab) -> RapierContextEntityLink {
    let world = lab.app.world_mut();
    let mut engines = world.query_filtered::<Entity, With<RapierContextSimulation>>();
    RapierContextEntityLink(engines.single(world).expect("one world"))
}

#[test]
fn of_a_world_that_is_gone_no_snapshot_knows_anything() {
    let mut lab = Lab::new();
    let first = first_world(&mut lab);
    box_on_floor(&mut lab, first);
    let link = second_world(&mut lab, Vec3::NEG_Y * GRAVITY as f32);
    let level = box_on_floor(&mut lab, link);
    lab.run(0.5);
    assert_eq!(lab.readout(level[3]).method, SpringMethod::Engine);
    for entity in level.into_iter().chain([link.0]) {
        lab.app.world_mut().despawn(entity);
    }
    lab.run(0.1);
    let then = CoiloverSnapshot::take(lab.app.world());
    assert_eq!(then.restore(lab.app.world_mut()), Ok(()));
}

#[test]
fn a_box_that_goes_to_another_world_harms_nobody_there() {
    let mut lab = Lab::new();
    let first = first_world(&mut lab);
    let [_, block, ..] = box_on_floor(&mut lab, first);
    let link = second_world(&mut lab, Vec3::NEG_Y * GRAVITY as f32);
    let below = Transform::from_xyz(0.0, -0.5, 0.0);
    lab.spawn((Collider::cuboid(9.0, 0.5, 5.0), below, link));
    let others: Vec<_> = (0..6)
        .map(|i| {
            let at = Transform::from_xyz(1.0 + i as f32 * 0.6, 0.2, 0.0);
            let block = Collider::cuboid(0.2, 0.2, 0.2);
            lab.spawn((RigidBody::Dynamic, block, at, link))
        })
        .collect();
    lab.run(1.0);
    let before: Vec<_> = others.iter().map(|other| lab.position(*other)).collect();
    lab.app.world_mut().entity_mut(block).insert(link);
    lab.run(1.0);
    let world = lab.app.world_mut();
    let mut sets = world.query::<&RapierRigidBodySet>();
    let bodies = &sets.get(world, link.0).expect("its bodies").bodies;
    // The box, the six other boxes, and the body that represents the hook. The floor is only a collider.
    assert_eq!(bodies.len(), 8);
    for (other, before) in others.iter().zip(before) {
        assert!(lab.position(*other).distance(before) < 1e-3);
    }
}

/// Number of joints and of bodies in each world, in the order of the worlds' entities.
fn held_in(lab: &mut Lab) -> Vec<(usize, usize)> {
    let world = lab.app.world_mut();
    let mut contexts = world.query::<(Entity, &RapierContextJoints, &RapierRigidBodySet)>();
    let mut all: Vec<_> = contexts.iter(world).collect();
    all.sort_by_key(|(entity, ..)| *entity);
    all.iter()
        .map(|(_, joints, set)| (joints.impulse_joints.len(), set.bodies.len()))
        .collect()
}

/// Two worlds with a box on a spring in each, and snapshots of them. Returns the springs.
fn two_boxes(lab: &mut Lab) -> ([Entity; 2], RapierSnapshot, CoiloverSnapshot) {
    let first = first_world(lab);
    let [.., one] = box_on_floor(lab, first);
    let link = second_world(lab, Vec3::NEG_Y * GRAVITY as f32);
    let [.., other] = box_on_floor(lab, link);
    lab.run(0.5);
    for element in [one, other] {
        assert_eq!(lab.readout(element).method, SpringMethod::Engine);
    }
    let world = lab.app.world();
    let (engine, springs) = (RapierSnapshot::take(world), CoiloverSnapshot::take(world));
    ([one, other], engine, springs)
}

#[test]
fn springs_that_have_a_fault_when_a_snapshot_is_restored_leave_nothing_in_any_world() {
    let mut lab = Lab::new();
    let (elements, engine, springs) = two_boxes(&mut lab);
    for element in elements {
        lab.get_mut::<SpringDamper>(element).stiffness = f32::NAN;
    }
    lab.tick();
    let world = lab.app.world_mut();
    assert_eq!(engine.restore(world), Ok(()));
    assert_eq!(springs.restore(world), Ok(()));
    lab.run(0.1);
    // No joints, and no bodies but the boxes.
    assert_eq!(held_in(&mut lab), [(0, 1), (0, 1)]);
}

#[test]
fn springs_that_start_afresh_leave_nothing_of_a_snapshot_that_does_not_fit_in_any_world() {
    let mut lab = Lab::new();
    let gone = lab.point(Vec3::X * 9.0);
    let free = lab.body(1.0, Vec3::X * 10.0);
    let gone = lab.spawn(Spring::new(gone, free));
    let (_, engine, springs) = two_boxes(&mut lab);
    let before = held_in(&mut lab);
    lab.app.world_mut().despawn(gone);
    let world = lab.app.world_mut();
    assert_eq!(engine.restore(world), Ok(()));
    let told = springs.restore(world);
    assert_eq!(told, Err(SnapshotError::NoElement(gone)));
    lab.run(0.1);
    assert_eq!(held_in(&mut lab), before);
}
