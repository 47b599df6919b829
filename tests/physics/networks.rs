//! Do elements that share bodies follow the reference, and stay bounded at any stiffness?

use crate::fit::frequency;
use crate::harness::*;
use bevy::math::DVec3;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use std::f64::consts::PI;

/// What connects the points.
#[derive(Clone, Copy)]
pub enum Link {
    Ours,
    Joint,
}

/// Points of equal mass, some of them fixed. Links connect them in pairs. Their rest lengths are the initial
/// distances.
pub struct Net {
    pub lab: Lab,
    pub points: Vec<Entity>,
}

struct Plan<'a> {
    at: &'a [Vec3],
    fixed: &'a [usize],
    mass: f32,
    pairs: &'a [(usize, usize)],
    stiffness: f32,
    damping: f32,
}

fn net(mut lab: Lab, plan: &Plan, link: Link) -> Net {
    let points: Vec<Entity> = plan
        .at
        .iter()
        .enumerate()
        .map(|(i, at)| {
            if plan.fixed.contains(&i) {
                lab.spawn((RigidBody::Fixed, Transform::from_translation(*at)))
            } else {
                lab.body(plan.mass, *at)
            }
        })
        .collect();
    for (a, b) in plan.pairs {
        let length = plan.at[*a].distance(plan.at[*b]);
        let (a, b) = (points[*a], points[*b]);
        match link {
            Link::Ours => {
                lab.spawn(
                    SpringDamper::new(a, b)
                        .with_stiffness(plan.stiffness)
                        .with_damping(plan.damping)
                        .with_rest_length(length),
                );
            }
            Link::Joint => {
                let joint = SpringJointBuilder::new(length, plan.stiffness, plan.damping);
                // A body may carry several joints as children.
                lab.spawn((ImpulseJoint::new(a, joint), ChildOf(b)));
            }
        }
    }
    Net { lab, points }
}

fn chain(count: usize) -> (Vec<Vec3>, Vec<(usize, usize)>) {
    let at = (0..=count).map(|i| Vec3::X * 0.2 * i as f32).collect();
    (at, (0..count).map(|i| (i, i + 1)).collect())
}

fn lattice(side: usize) -> (Vec<Vec3>, Vec<(usize, usize)>) {
    let at = |i: usize, j: usize| j * side + i;
    let mut pairs = Vec::new();
    for j in 0..side {
        for i in 0..side {
            if i + 1 < side {
                pairs.push((at(i, j), at(i + 1, j)));
            }
            if j + 1 < side {
                pairs.push((at(i, j), at(i, j + 1)));
            }
            if i + 1 < side && j + 1 < side {
                pairs.push((at(i, j), at(i + 1, j + 1)));
                pairs.push((at(i + 1, j), at(i, j + 1)));
            }
        }
    }
    let points = (0..side * side)
        .map(|p| Vec3::new(0.1 * (p % side) as f32, -0.1 * (p / side) as f32, 0.0))
        .collect();
    (points, pairs)
}

/// Largest error of the watched points over the first second, m.
fn error(mut net: Net, file: &str, watched: &[usize]) -> f64 {
    let mut worst = 0.0_f64;
    for row in reference(file).iter().step_by(4).skip(1).take(60) {
        net.lab.tick();
        for (i, p) in watched.iter().enumerate() {
            let wanted = DVec3::new(row[1 + 2 * i], row[2 + 2 * i], 0.0);
            let at = net.lab.position(net.points[*p]).as_dvec3();
            worst = worst.max(at.distance(wanted));
        }
    }
    worst
}

/// The reference's hanging chain of ten, and the points of it whose motion is known.
pub fn swing(lab: Lab, link: Link) -> (Net, &'static str, &'static [usize]) {
    let (at, pairs) = chain(10);
    let plan = Plan {
        at: &at,
        fixed: &[0],
        mass: 0.1,
        pairs: &pairs,
        stiffness: 100.0,
        damping: 0.5,
    };
    let file = include_str!("../data/chain10_k100_c0.5.csv");
    (net(lab, &plan, link), file, &[5, 10])
}

/// The reference's sheet of 6 × 6 points, hung at two corners, and the points of it whose motion is known.
pub fn sheet(lab: Lab, link: Link) -> (Net, &'static str, &'static [usize]) {
    let (at, pairs) = lattice(6);
    let plan = Plan {
        at: &at,
        fixed: &[0, 5],
        mass: 0.05,
        pairs: &pairs,
        stiffness: 100.0,
        damping: 0.5,
    };
    let file = include_str!("../data/lattice6_k100_c0.5.csv");
    (net(lab, &plan, link), file, &[14, 33, 35])
}

#[test]
fn chain_of_ten_and_lattice_of_six_follow_the_reference() {
    let run = |scene: fn(Lab, Link) -> _, link| {
        let (net, file, watched) = scene(Lab::new(), link);
        error(net, file, watched)
    };
    let (ours, joint) = (run(swing, Link::Ours), run(swing, Link::Joint));
    println!(
        "chain of 10: ours {:.2} mm, SpringJoint {:.1} mm",
        1e3 * ours,
        1e3 * joint
    );
    assert!(ours <= 8e-3 && joint > 10.0 * ours, "{ours} {joint}");
    let (ours, joint) = (run(sheet, Link::Ours), run(sheet, Link::Joint));
    println!(
        "lattice 6×6: ours {:.3} mm, SpringJoint {:.1} mm",
        1e3 * ours,
        1e3 * joint
    );
    assert!(ours <= 1e-3 && joint > 10.0 * ours, "{ours} {joint}");
}

#[test]
fn every_normal_mode_of_a_chain_has_its_frequency() {
    // Ten masses between two walls, eleven springs: ω_j = 2 √(k/m) sin(jπ/22).
    let mass = 0.1;
    let k = mass * (0.3 / DT).powi(2);
    for j in 1..=10 {
        let (at, pairs) = chain(11);
        let still = Plan {
            at: &at,
            fixed: &[0, 11],
            mass,
            pairs: &pairs,
            stiffness: k,
            damping: 0.0,
        };
        let mut net = net(Lab::weightless(), &still, Link::Ours);
        let shape = |i: usize| (i as f64 * j as f64 * PI / 11.0).sin();
        for i in 1..=10 {
            net.lab.get_mut::<Transform>(net.points[i]).translation.x += (1e-3 * shape(i)) as f32;
        }
        let samples: Vec<(f64, f64)> = (1..=300)
            .map(|tick| {
                net.lab.tick();
                let along: f64 = (1..=10)
                    .map(|i| {
                        let x = f64::from(net.lab.position(net.points[i]).x) - f64::from(at[i].x);
                        x * shape(i)
                    })
                    .sum();
                (f64::from(tick) * f64::from(DT), along)
            })
            .collect();
        let omega = 2.0 * (f64::from(k) / f64::from(mass)).sqrt() * (j as f64 * PI / 22.0).sin();
        let error = frequency(&samples, omega) / omega - 1.0;
        println!(
            "mode {j}: ω·dt {:.3}, frequency error {error:+.1e}",
            omega * f64::from(DT)
        );
        assert!(error.abs() <= 3e-3, "mode {j}: {error:e}");
    }
}

#[test]
fn strong_dampers_bring_a_row_to_one_speed_at_once() {
    for plugin in [
        CoiloverPlugin::default(),
        CoiloverPlugin::default().with_microsteps(2),
        CoiloverPlugin::default().with_extrapolation(),
    ] {
        let mut lab = Lab::with(plugin, Engine::weightless());
        let row = [0.0, 1.0, 2.0].map(|x| lab.body(1.0, Vec3::X * x));
        for (a, b) in [(row[0], row[1]), (row[1], row[2])] {
            lab.spawn(Damper::new(a, b).with_damping(1000.0 / DT));
        }
        lab.get_mut::<Velocity>(row[0]).linear = Vec3::X;
        for _ in 0..30 {
            lab.tick();
            for body in row {
                let v = lab.velocity(body).x;
                assert!((v - 1.0 / 3.0).abs() < 2e-3, "{plugin:?}: {v}");
            }
        }
    }
}

#[test]
fn an_inert_neighbour_stops_nothing() {
    // Two bodies at the same place give their spring no direction. The next spring still acts.
    let mut lab = Lab::weightless();
    let (a, b, c) = (
        lab.body(1.0, Vec3::ZERO),
        lab.body(1.0, Vec3::ZERO),
        lab.body(1.0, Vec3::X * 2.0),
    );
    let inert = lab.spawn(Spring::new(a, b).with_stiffness(10.0).with_rest_length(1.0));
    lab.spawn(Spring::new(b, c).with_stiffness(10.0).with_rest_length(1.0));
    lab.tick();
    assert!(lab.app.world().get::<SpringFault>(inert).is_some());
    assert!(lab.velocity(c).x < -0.1 && lab.velocity(a).length() < 1e-6);
}

#[test]
fn a_long_stiff_rope_carries_its_weight_without_iterations() {
    // A hundred links of 1 kg and 100 kN/m (ω·dt = 10), of points or of rods, hang at rest from the first step on.
    const LINKS: usize = 100;
    const STIFFNESS: f32 = 1e5;
    for rod in [0.0, 0.1] {
        let mut lab = Lab::new();
        let mut above = lab.point(Vec3::ZERO);
        let mut low = 0.0;
        let springs: Vec<Entity> = (0..LINKS)
            .map(|link| {
                let carried = (LINKS - link) as f32 * GRAVITY as f32;
                low -= 0.1 + carried / STIFFNESS + 2.0 * rod;
                let at = Vec3::Y * (low + rod);
                let here = lab.spawn(brick(1.0, Vec3::splat(0.01), at));
                let foot = if link == 0 { 0.0 } else { -rod };
                let spring = SpringDamper::new(above, here)
                    .with_stiffness(STIFFNESS)
                    .with_damping(500.0)
                    .with_rest_length(0.1);
                above = here;
                lab.spawn((spring, Anchors::new(Vec3::Y * foot, Vec3::Y * rod)))
            })
            .collect();
        lab.run(1.0);
        for (link, spring) in springs.iter().enumerate() {
            let readout = lab.readout(*spring);
            assert_eq!(readout.method, SpringMethod::Direct);
            let carried = (LINKS - link) as f32 * GRAVITY as f32;
            // Its ends are at most 31 m from the origin, where f32 resolves 2 µm, which is 0.2 N for each of the two.
            let off = (readout.force() - carried).abs();
            assert!(off < 2.0, "link {link}, rods of {rod} m: {off} N off");
        }
    }
}

#[test]
fn ten_dampers_side_by_side_stop_a_body_as_one_does() {
    // c h/m is 10, and 1 for each of ten dampers. Where anchors are off the centre of mass, dampers could turn the body.
    for (anchor, count) in [(0.0, 1), (0.0, 10), (0.2, 1), (0.2, 10)] {
        let mut lab = Lab::weightless();
        let hook = lab.point(Vec3::ZERO);
        let cart = lab.moving(body(1.0, Vec3::X * 2.0), Velocity::linear(Vec3::X));
        for _ in 0..count {
            let damper = Damper::new(hook, cart).with_damping(10.0 / DT / count as f32);
            lab.spawn((damper, Anchors::new(Vec3::ZERO, Vec3::X * anchor)));
        }
        for tick in 0..20 {
            lab.tick();
            let speed = lab.velocity(cart).x;
            assert!(
                speed > -1e-3 && speed < 1e-3,
                "{count} dampers at {anchor} m: {speed} m/s in tick {tick}"
            );
        }
        let way = lab.position(cart).x - 2.0;
        println!("{count} dampers at {anchor} m: stopped after {way:.5} m");
        assert!(way > 0.0 && way < 0.51 * DT, "{count} {anchor}: {way} m");
    }
}

#[test]
fn a_spring_that_begins_to_act_in_flight_pushes_with_all_its_force() {
    // Two of three bodies are at the same place, so the spring between them begins to act only after the other has parted them.
    let mut lab = Lab::weightless();
    let [a, b, c] = [0.0, 0.0, 2.0].map(|x| {
        let flight = Velocity::linear(Vec3::Y * 3.0);
        lab.moving(body(1.0, Vec3::X * x), flight)
    });
    for (a, b) in [(a, b), (b, c)] {
        lab.spawn(Spring::new(a, b).with_stiffness(10.0).with_rest_length(1.0));
    }
    let momentum = |lab: &Lab| -> Vec3 { [a, b, c].iter().map(|e| lab.velocity(*e)).sum() };
    let first = momentum(&lab);
    lab.run(0.25);
    // 10 N push body A at first, and 3 N at the end of this time.
    let speed = lab.velocity(a).x;
    println!("a spring that begins to act in flight: {speed:.2} m/s after 0.25 s");
    assert!(speed < -1.0 && speed > -2.5, "{speed} m/s");
    assert!(momentum(&lab).distance(first) < 1e-3);
}
