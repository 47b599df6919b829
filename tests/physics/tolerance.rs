//! Does a tolerance give the requested error at an acceptable cost?

use crate::harness::*;
use crate::networks::{Link, Net, sheet, swing};
use bevy::math::DVec3;
use bevy::prelude::*;
use bevy_coilover::prelude::*;

/// A scene with a reference. Returns the net, the reference file and the points to watch.
type Scene = fn(Lab) -> (Net, &'static str, &'static [usize]);

fn pendulum(
    mut lab: Lab,
    file: &'static str,
    stiffness: f32,
    damping: f32,
) -> (Net, &'static str, &'static [usize]) {
    let pivot = lab.point(Vec3::ZERO);
    let weight = lab.body(1.0, Vec3::X);
    lab.spawn(
        SpringDamper::new(pivot, weight)
            .with_stiffness(stiffness)
            .with_damping(damping)
            .with_rest_length(1.0),
    );
    let points = vec![weight];
    (Net { lab, points }, file, &[0])
}

const SCENES: [(&str, Scene); 5] = [
    ("pendulum 50/0", |lab| {
        pendulum(lab, include_str!("../data/pendulum_k50.csv"), 50.0, 0.0)
    }),
    ("pendulum 500/5", |lab| {
        pendulum(
            lab,
            include_str!("../data/pendulum_k500_c5.csv"),
            500.0,
            5.0,
        )
    }),
    ("pendulum 50000/100", |lab| {
        pendulum(
            lab,
            include_str!("../data/pendulum_k50000_c100.csv"),
            5e4,
            100.0,
        )
    }),
    ("chain of 10", |lab| swing(lab, Link::Ours)),
    ("lattice 6×6", |lab| sheet(lab, Link::Ours)),
];

/// Largest error over the first second, m; micro-steps in that second; sum of the error estimates of its steps, m.
fn run(scene: Scene, plugin: CoiloverPlugin) -> (f64, u32, f64) {
    let (mut net, file, watched) = scene(Lab::with(plugin, Engine::default()));
    let mut springs = net.lab.app.world_mut().query::<&SpringReadout>();
    let (mut worst, mut kicks, mut estimate) = (0.0_f64, 0, 0.0_f64);
    for row in reference(file).iter().step_by(4).skip(1).take(60) {
        net.lab.tick();
        for (i, p) in watched.iter().enumerate() {
            let wanted = DVec3::new(row[1 + 2 * i], row[2 + 2 * i], 0.0);
            let at = net.lab.position(net.points[*p]).as_dvec3();
            worst = worst.max(at.distance(wanted));
        }
        let world = net.lab.app.world();
        let readout = springs.iter(world).next().expect("an element");
        kicks += readout.microsteps;
        estimate += f64::from(readout.error);
    }
    (worst, kicks, estimate)
}

#[test]
fn the_error_of_the_first_second_is_near_the_tolerance() {
    for (name, scene) in SCENES {
        // The errors and the costs of fixed numbers of micro-steps.
        let mut fixed = Vec::new();
        for n in [1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64] {
            let plugin = CoiloverPlugin::default().with_microsteps(n);
            let (error, kicks, _) = run(scene, plugin);
            fixed.push((error, kicks));
            let (error, kicks, _) = run(scene, plugin.with_extrapolation());
            fixed.push((error, kicks));
        }
        let mut priced = 0;
        for tolerance in [1e-2, 1e-3, 1e-4] {
            let plugin = CoiloverPlugin::default().with_tolerance(tolerance);
            let (error, kicks, estimate) = run(scene, plugin);
            let best = fixed
                .iter()
                .filter(|f| f.0 <= error.max(1e-6))
                .map(|f| f.1)
                .min();
            let price = best.map(|best| f64::from(kicks) / f64::from(best));
            println!(
                "{name}, tolerance {tolerance:e} m/s: error {error:.2e} m, estimated {estimate:.2e}, {kicks} kicks, {price:.2?} of the best fixed count's"
            );
            assert!(
                error <= 3.0 * f64::from(tolerance),
                "{name}, {tolerance}: {error}"
            );
            // With a tolerance it is more exact than any of the fixed counts.
            let Some(price) = price else { continue };
            priced += 1;
            assert!(price < 2.0, "{name}, {tolerance}: {price}");
        }
        assert!(priced > 0, "{name}");
    }
}

#[test]
fn a_cap_that_bites_is_told() {
    let plugin = CoiloverPlugin::default()
        .with_tolerance(1e-5)
        .with_max_microsteps(2);
    let (mut net, ..) = SCENES[2].1(Lab::with(plugin, Engine::default()));
    net.lab.run(0.5);
    let mut springs = net.lab.app.world_mut().query::<&SpringReadout>();
    let readout = springs.single(net.lab.app.world()).expect("one element");
    assert!(readout.capped, "{readout:?}");
    // A fixed number of micro-steps below the cap does not set `capped`.
    let plugin = CoiloverPlugin::default().with_microsteps(4);
    let (mut net, ..) = SCENES[2].1(Lab::with(plugin, Engine::default()));
    net.lab.run(0.5);
    let mut springs = net.lab.app.world_mut().query::<&SpringReadout>();
    let readout = springs.single(net.lab.app.world()).expect("one element");
    assert!(!readout.capped && readout.microsteps == 4, "{readout:?}");
}

/// A stiff ladder of points that swings and bounces on one soft spring.
fn ladder(mut lab: Lab) -> (Lab, Vec<Entity>) {
    let mut points = Vec::new();
    let hook = lab.point(Vec3::ZERO);
    let join = |lab: &mut Lab, a, b, stiffness: f32| {
        lab.spawn(SpringDamper::new(a, b).with_stiffness(stiffness));
    };
    for i in 0..8 {
        let (x, y) = (0.2 * (i % 2) as f32, 0.2 * (i / 2) as f32);
        points.push(lab.body(0.1, Vec3::new(1.0 + x, y, 0.0)));
    }
    join(&mut lab, hook, points[0], 10.0);
    for i in 0..8 {
        for j in i + 1..8.min(i + 4) {
            join(&mut lab, points[i], points[j], 400.0);
        }
    }
    (lab, points)
}

#[test]
fn a_soft_swing_of_a_stiff_thing_keeps_the_tolerance() {
    let run = |plugin: CoiloverPlugin| {
        let (mut lab, points) = ladder(Lab::with(plugin, Engine::default()));
        let mut path = Vec::new();
        let mut kicks = 0;
        let mut springs = lab.app.world_mut().query::<&SpringReadout>();
        for _ in 0..120 {
            lab.tick();
            path.extend(points.iter().map(|p| lab.position(*p)));
            kicks += springs
                .iter(lab.app.world())
                .next()
                .expect("one")
                .microsteps;
        }
        (path, kicks)
    };
    let fine = run(CoiloverPlugin::default().with_microsteps(128)).0;
    for tolerance in [1e-2, 1e-3, 1e-4] {
        let (path, kicks) = run(CoiloverPlugin::default().with_tolerance(tolerance));
        let apart = path.iter().zip(&fine).map(|(a, b)| a.distance(*b));
        let worst = apart.fold(0.0, f32::max);
        println!("ladder, tolerance {tolerance:e} m/s: error {worst:.2e} m in 2 s, {kicks} kicks");
        assert!(worst <= 2.0 * 3.0 * tolerance, "{tolerance}: {worst}");
    }
}
