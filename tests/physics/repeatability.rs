//! Are two runs bitwise equal, however many ticks fall into a frame, and in whatever order the scene was spawned?

use crate::harness::*;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// A pendulum, a spinning pair held off-centre, a chain, and a child entity as an end. Returns the bodies.
fn populate(lab: &mut Lab) -> Vec<Entity> {
    let hook = lab.point(Vec3::new(0.0, 2.0, 0.0));
    let weight = lab.body(1.0, Vec3::new(1.0, 2.0, 0.0));
    lab.spawn(
        SpringDamper::new(hook, weight)
            .with_stiffness(300.0)
            .with_damping(0.5),
    );
    let a = lab.spawn(brick(
        1.0,
        Vec3::new(0.1, 0.2, 0.3),
        Vec3::new(5.0, 0.0, 0.0),
    ));
    let b = lab.spawn(brick(
        2.0,
        Vec3::new(0.2, 0.5, 0.3),
        Vec3::new(6.0, 0.5, 0.2),
    ));
    lab.get_mut::<Velocity>(a).angular = Vec3::new(1.0, 2.0, 3.0);
    let ear = lab.spawn((Transform::from_xyz(0.2, 0.1, 0.0), ChildOf(b)));
    lab.spawn((
        Spring::new(a, ear)
            .with_stiffness(80.0)
            .with_rest_length(0.7),
        Anchors::new(Vec3::new(0.1, 0.2, 0.0), Vec3::ZERO),
    ));
    let mut last = hook;
    let mut bodies = vec![weight, a, b];
    for i in 1..=4 {
        let next = lab.body(0.3, Vec3::new(0.3 * i as f32, 2.0, 1.0));
        lab.spawn(
            SpringDamper::new(last, next)
                .with_stiffness(200.0)
                .with_damping(0.1),
        );
        last = next;
        bodies.push(next);
    }
    bodies
}

fn state(lab: &Lab, bodies: &[Entity]) -> Vec<u32> {
    bodies
        .iter()
        .flat_map(|b| {
            let t = lab.get::<Transform>(*b);
            let v = lab.get::<Velocity>(*b);
            let mut all = t.translation.to_array().to_vec();
            all.extend(t.rotation.to_array());
            all.extend(v.linear.to_array());
            all.extend(v.angular.to_array());
            all.into_iter().map(f32::to_bits).collect::<Vec<_>>()
        })
        .collect()
}

/// State after 240 ticks, with the given number of ticks in each frame.
fn run(ticks_per_frame: u32) -> Vec<u32> {
    let mut lab = Lab::new();
    let bodies = populate(&mut lab);
    let tick = lab.app.world().resource::<Time<Fixed>>().timestep();
    lab.app
        .insert_resource(TimeUpdateStrategy::ManualDuration(tick * ticks_per_frame));
    for _ in 0..240 / ticks_per_frame {
        lab.app.update();
    }
    state(&lab, &bodies)
}

#[test]
fn two_runs_are_bitwise_equal() {
    assert_eq!(run(1), run(1));
}

#[test]
fn four_ticks_in_a_frame_are_four_frames_of_a_tick() {
    assert_eq!(run(1), run(4));
}

#[test]
fn threads_change_nothing() {
    // The schedules of a lab are single-threaded. This test leaves them multi-threaded, as in a game.
    let mut lab = Lab::without_plugin(Engine::default());
    lab.app.add_plugins(CoiloverPlugin::default());
    lab.app.finish();
    lab.app.cleanup();
    lab.app.update();
    let bodies = populate(&mut lab);
    for _ in 0..240 {
        lab.app.update();
    }
    assert_eq!(state(&lab, &bodies), run(1));
}

#[test]
fn networks_that_threads_share_move_as_each_does_alone() {
    // Each network has three springs. From 256 elements on, several threads share the work.
    let run = |networks: usize| {
        let mut lab = Lab::new();
        let mut first = Vec::new();
        for n in 0..networks {
            let mut last = lab.point(Vec3::new(0.0, 0.0, 5.0 * n as f32));
            for i in 1..=3 {
                let at = Vec3::new(i as f32, 0.1 * i as f32, 5.0 * n as f32);
                let next = lab.spawn(brick(0.5, Vec3::new(0.02, 0.03, 0.04), at));
                lab.spawn((
                    SpringDamper::new(last, next)
                        .with_stiffness(90.0)
                        .with_damping(0.1),
                    Anchors::new(Vec3::ZERO, Vec3::new(0.1, 0.05, 0.0)),
                ));
                last = next;
                if n == 0 {
                    first.push(next);
                }
            }
        }
        lab.run(1.0);
        state(&lab, &first)
    };
    assert_eq!(run(1), run(200));
}

/// Nets of 60 by 60 points, large enough that several threads share a step. The first net must move alike alone
/// and beside another one.
#[test]
fn a_net_that_threads_share_moves_beside_another_as_alone() {
    const SIDE: usize = 60;
    let run = |nets: usize| {
        let mut lab = Lab::weightless();
        let mut first = Vec::new();
        for net in 0..nets {
            let points: Vec<Entity> = (0..SIDE * SIDE)
                .map(|i| {
                    let at = Vec3::new((i % SIDE) as f32, 2.0 * net as f32, (i / SIDE) as f32);
                    let point = lab.body(0.1, at);
                    lab.get_mut::<Velocity>(point).linear = Vec3::Y * (i % 7) as f32 * 0.1;
                    point
                })
                .collect();
            for i in 0..SIDE * SIDE {
                let aside = (i % SIDE + 1 < SIDE).then_some(i + 1);
                let ahead = (i + SIDE < SIDE * SIDE).then_some(i + SIDE);
                for other in [aside, ahead].into_iter().flatten() {
                    let spring = SpringDamper::new(points[i], points[other]);
                    lab.spawn(spring.with_stiffness(50.0).with_rest_length(0.9));
                }
            }
            if net == 0 {
                first = points;
            }
        }
        for _ in 0..20 {
            lab.tick();
        }
        state(&lab, &first)
    };
    assert_eq!(run(1), run(2));
}

#[test]
fn the_order_in_which_springs_are_spawned_changes_nothing() {
    let run = |reversed: bool| {
        let mut lab = Lab::new();
        let hook = lab.point(Vec3::ZERO);
        let bodies: Vec<Entity> = (1..=12)
            .map(|i| {
                let i = i as f32;
                lab.spawn(brick(
                    0.1 + 0.05 * i,
                    Vec3::splat(0.01),
                    Vec3::new(0.3 * i, 0.02 * i * i, 0.1 * (i % 3.0)),
                ))
            })
            .collect();
        let all: Vec<Entity> = [hook].into_iter().chain(bodies.iter().copied()).collect();
        let mut pairs: Vec<(Entity, Entity)> = all.windows(2).map(|w| (w[0], w[1])).collect();
        pairs.extend(all.windows(4).map(|w| (w[0], w[3])));
        if reversed {
            pairs.reverse();
        }
        for (a, b) in pairs {
            lab.spawn((
                SpringDamper::new(a, b)
                    .with_stiffness(150.0)
                    .with_damping(0.2),
                Anchors::new(Vec3::ZERO, Vec3::Y * 0.05),
            ));
        }
        lab.run(3.0);
        state(&lab, &bodies)
    };
    assert_eq!(run(false), run(true));
}

/// A chain, a corner of a lattice, a torsion bar, and a pendulum on a hinge. `order` is the spawn order: 0 as
/// written, 1 reversed, 2 every third one first. The index of a body in the returned list does not depend on it.
fn populate_in_order(lab: &mut Lab, order: usize) -> Vec<Entity> {
    const BODIES: usize = 14;
    let shuffled = |count: usize| -> Vec<usize> {
        match order {
            0 => (0..count).collect(),
            1 => (0..count).rev().collect(),
            _ => (0..3).flat_map(|r| (r..count).step_by(3)).collect(),
        }
    };
    let hook = lab.point(Vec3::new(0.0, 3.0, 0.0));
    let mut bodies = vec![Entity::PLACEHOLDER; BODIES];
    for label in shuffled(BODIES) {
        let x = label as f32;
        let at = Vec3::new(0.9 * x, (0.7 * x).sin(), 0.3 * (1.3 * x).cos());
        let inertia = Vec3::new(0.05, 0.08, 0.06) * (1.0 + 0.1 * x);
        bodies[label] = lab.spawn(brick(0.5 + 0.1 * x, inertia, at));
    }
    let joint = RevoluteJointBuilder::new(Vec3::Z)
        .local_anchor1(Vec3::NEG_Y * 0.5)
        .local_anchor2(Vec3::Y * 0.5)
        .build();
    let on_hinge = ImpulseJoint::new(bodies[12], TypedJoint::RevoluteJoint(joint));
    lab.app.world_mut().entity_mut(bodies[13]).insert(on_hinge);
    let mut pairs: Vec<[Entity; 2]> = vec![[hook, bodies[0]]];
    pairs.extend((0..6).map(|i| [bodies[i], bodies[i + 1]]));
    pairs.extend([[7, 8], [8, 9], [9, 7], [7, 10], [10, 11]].map(|p| p.map(|b| bodies[b])));
    pairs.extend([[hook, bodies[12]], [bodies[12], bodies[13]]]);
    for label in shuffled(pairs.len()) {
        let [a, b] = pairs[label];
        let x = label as f32;
        let anchors = Anchors::new(Vec3::ZERO, Vec3::new(0.0, 0.1, 0.02 * x));
        match label % 5 {
            4 if a != hook => {
                lab.spawn(TorsionSpringDamper::new(a, b, Vec3::X).with_stiffness(3.0))
            }
            3 => lab.spawn((
                Spring::new(a, b).with_stiffness(90.0 + x),
                anchors,
                SpringAction::Pull,
            )),
            _ => lab.spawn((
                SpringDamper::new(a, b)
                    .with_stiffness(150.0 + 10.0 * x)
                    .with_damping(0.2),
                anchors,
            )),
        };
    }
    bodies
}

#[test]
fn the_order_in_which_a_scene_is_spawned_changes_no_bit() {
    for plugin in [
        CoiloverPlugin::default(),
        CoiloverPlugin::default().with_extrapolation(),
    ] {
        let [first, second, third] = [0, 1, 2].map(|order| {
            let mut lab = Lab::with(plugin, Engine::default());
            let bodies = populate_in_order(&mut lab, order);
            lab.run(4.0);
            state(&lab, &bodies)
        });
        assert!(first == second, "from the last to the first");
        assert!(first == third, "every third one first");
    }
}
