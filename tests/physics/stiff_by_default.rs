//! Do default settings follow springs that are too stiff for one micro-step?

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;

const AMPLITUDE: f64 = 0.1;

/// Bodies in a row from a hook, given as (mass in kg, stiffness in N/m of the spring before it). The last spring
/// is stretched. Returns the last body.
fn row<const N: usize>(plugin: CoiloverPlugin, bodies: [(f32, f64); N]) -> (Lab, Entity) {
    let mut lab = Lab::with(plugin, Engine::weightless());
    let mut last = lab.point(Vec3::ZERO);
    for (i, (mass, stiffness)) in bodies.into_iter().enumerate() {
        let stretched = if i + 1 == N { AMPLITUDE as f32 } else { 0.0 };
        let next = lab.body(mass, Vec3::X * ((i + 1) as f32 + stretched));
        lab.spawn(
            Spring::new(last, next)
                .with_stiffness(stiffness as f32)
                .with_rest_length(1.0),
        );
        last = next;
    }
    (lab, last)
}

/// Largest distance of the last body from its exact position over three seconds, as a fraction of the amplitude.
fn error(lab: &mut Lab, body: Entity, places: f64, wanted: impl Fn(f64) -> f64) -> f64 {
    let mut worst = 0.0_f64;
    for tick in 1..=180 {
        lab.tick();
        let time = f64::from(tick) * f64::from(DT);
        let off = f64::from(lab.position(body).x) - places - AMPLITUDE * wanted(time);
        worst = worst.max(off.abs() / AMPLITUDE);
    }
    worst
}

#[test]
fn a_lone_spring_keeps_its_phase_at_any_stiffness() {
    for phase in [1.0, 3.0, 10.0, 40.0, 60.0] {
        let stiffness = (phase / f64::from(DT)).powi(2);
        let omega = f64::from(stiffness as f32).sqrt();
        let (mut lab, ball) = row(CoiloverPlugin::default(), [(1.0, stiffness)]);
        let off = error(&mut lab, ball, 1.0, |time| (omega * time).cos());
        println!("lone spring, ω·dt {phase}: off by {off:.1e} of its amplitude in 3 s");
        assert!(off < 0.01, "ω·dt {phase}: {off}");
    }
}

#[test]
fn a_lone_spring_too_stiff_to_be_followed_loses_a_little_energy_in_each_step() {
    const TICKS: u32 = 60;
    // The speed stays far below that at which the engine holds a body back.
    const STRETCH: f64 = 5e-3;
    for phase in [70.0, 100.0, 300.0] {
        let stiffness = f64::from((phase / f64::from(DT)).powi(2) as f32);
        let mut lab = Lab::with(CoiloverPlugin::default(), Engine::weightless());
        let hook = lab.point(Vec3::ZERO);
        let ball = lab.body(1.0, Vec3::X * (1.0 + STRETCH as f32));
        lab.spawn(
            Spring::new(hook, ball)
                .with_stiffness(stiffness as f32)
                .with_rest_length(1.0),
        );
        let energy = |lab: &Lab| {
            let x = f64::from(lab.position(ball).x) - 1.0;
            let v = f64::from(lab.velocity(ball).x);
            0.5 * (stiffness * x * x + v * v)
        };
        let first = energy(&lab);
        (0..TICKS).for_each(|_| lab.tick());
        let left = energy(&lab) / first;
        let lost = 1.0 - left.powf(f64::from(TICKS).recip());
        println!(
            "lone spring, ω·dt {phase}: loses {:.2} % of its energy a step",
            100.0 * lost
        );
        assert!((0.0..0.04).contains(&lost), "ω·dt {phase}: {lost}");
    }
}

#[test]
fn a_heavy_body_behind_a_light_one_keeps_its_phase() {
    for (phase, ratio) in [(0.5, 1.0), (0.1, 1e3), (1.0, 300.0), (10.0, 3.0)] {
        let wanted = ratio * (phase / f64::from(DT)).powi(2);
        let (k, m) = (f64::from(wanted as f32), ratio);
        // Eigenvalues of M⁻¹K = [[2k, −k], [−k/m, k/m]].
        let half = 0.5 * (2.0 * k + k / m);
        let high = half + (half * half - k * k / m).sqrt();
        let squares = [k * k / m / high, high];
        let [slow, fast] = squares.map(|square| 2.0 * k - square);
        let truth = |time: f64| {
            let wave = squares.map(|square| (square.sqrt() * time).cos());
            (slow * wave[0] - fast * wave[1]) / (slow - fast)
        };
        let bodies = [(1.0, wanted), (ratio as f32, wanted)];
        let (mut lab, ball) = row(CoiloverPlugin::default(), bodies);
        let off = error(&mut lab, ball, 2.0, truth);
        println!("1 : {ratio} kg, ω·dt {phase}: off by {off:.1e} of its amplitude in 3 s");
        assert!(off < 0.01, "ω·dt {phase}, 1 : {ratio}: {off}");
    }
}

#[test]
fn who_asks_for_one_micro_step_gets_one_and_what_is_too_stiff_stays_stable() {
    for (plugin, phase, microsteps) in [
        (CoiloverPlugin::default().with_microsteps(1), 39.0, 1),
        (CoiloverPlugin::default().with_resolve(1), 39.0, 1),
        (CoiloverPlugin::default(), 39.0, 20),
        (CoiloverPlugin::default().with_microsteps(32), 39.0, 32),
        (CoiloverPlugin::default(), 1e3, 1),
    ] {
        let stiffness = (phase / f64::from(DT)).powi(2);
        let (mut lab, ball) = row(plugin, [(1.0, stiffness)]);
        let mut farthest = 0.0_f32;
        for _ in 0..180 {
            lab.tick();
            farthest = farthest.max((lab.position(ball).x - 1.0).abs());
        }
        let mut readouts = lab.app.world_mut().query::<&SpringReadout>();
        let taken = readouts.iter(lab.app.world()).map(|r| r.microsteps).max();
        assert_eq!(taken, Some(microsteps), "ω·dt {phase}");
        assert!(f64::from(farthest) < 1.01 * AMPLITUDE, "{farthest} m");
    }
}

/// A hundred networks of two springs. Each network alone would take about half of the budget.
#[test]
fn networks_share_the_budget() {
    let mut lab = Lab::with(CoiloverPlugin::default(), Engine::weightless());
    let stiffness = 30.0 * (10.0 / DT).powi(2);
    for i in 0..100 {
        let at = |x: f32| Vec3::new(x, i as f32, 0.0);
        let mut last = lab.point(at(0.0));
        for (mass, x) in [(1.0, 1.0), (30.0, 2.1)] {
            let next = lab.body(mass, at(x));
            let spring = Spring::new(last, next).with_stiffness(stiffness);
            lab.spawn(spring.with_rest_length(1.0));
            last = next;
        }
    }
    lab.run(0.5);
    let mut readouts = lab.app.world_mut().query::<&SpringReadout>();
    let kicks: u32 = readouts.iter(lab.app.world()).map(|r| r.microsteps).sum();
    assert!(kicks <= 1024, "{kicks} kicks");
}

/// A bridge of planks of 2 kg on 1000 springs, with 500 kg more on the middle plank. It is released from a
/// parabola with all springs at rest length. It has far too many springs for the budget.
#[test]
fn a_long_bridge_falls_as_it_should() {
    const PLANKS: u16 = 1000;
    let rows = reference(include_str!("../data/bridge1000.csv"));
    let mut lab = Lab::new();
    let place = |i: u16| {
        let x = 0.2 * f64::from(i);
        Vec3::new(x as f32, (-1e-3 * x * (200.0 - x)) as f32, 0.0)
    };
    let points: Vec<Entity> = (0..=PLANKS)
        .map(|i| match i {
            0 | PLANKS => lab.point(place(i)),
            500 => lab.body(502.0, place(i)),
            _ => lab.body(2.0, place(i)),
        })
        .collect();
    for (i, ends) in points.windows(2).enumerate() {
        let i = i as u16;
        let spring = SpringDamper::new(ends[0], ends[1])
            .with_stiffness(1e7)
            .with_damping(2e3)
            .with_rest_length(place(i).distance(place(i + 1)));
        lab.spawn(spring);
    }
    for row in &rows[1..] {
        lab.tick();
        let at = lab.position(points[500]).as_dvec3();
        let off = (at.x - row[1]).hypot(at.y - row[2]);
        assert!(off < 0.008, "after {} s: {off} m", row[0]);
    }
    assert!(lab.position(points[500]).y < -20.0);
}

/// Largest number of micro-steps that an element took in the last step.
fn kicks(lab: &mut Lab) -> u32 {
    let mut readouts = lab.app.world_mut().query::<&SpringReadout>();
    let of_all = readouts.iter(lab.app.world()).map(|r| r.microsteps);
    of_all.max().unwrap_or(0)
}

/// A heavy body swings behind a light one. The light one's own mode is not excited until the light body is struck.
#[test]
fn a_stiff_mode_costs_nothing_until_it_is_struck() {
    let m = 3000.0;
    let stiffness = m * (0.3 / f64::from(DT)).powi(2);
    let k = f64::from(stiffness as f32);
    let mut lab = Lab::with(CoiloverPlugin::default(), Engine::weightless());
    let hook = lab.point(Vec3::ZERO);
    // The light body starts where the slow mode places it.
    let light = lab.body(1.0, Vec3::X * 1.05);
    let heavy = lab.body(m as f32, Vec3::X * 2.1);
    for (a, b) in [(hook, light), (light, heavy)] {
        let spring = Spring::new(a, b).with_stiffness(stiffness as f32);
        lab.spawn(spring.with_rest_length(1.0));
    }
    lab.run(0.5);
    let calm = kicks(&mut lab);
    lab.get_mut::<bevy_rapier3d::prelude::Velocity>(light)
        .linear
        .x += 10.0;
    lab.tick();
    let [x, v, w] = [
        lab.position(light).x,
        lab.velocity(light).x,
        lab.velocity(heavy).x,
    ]
    .map(f64::from);
    let from = x - 0.5 * f64::from(lab.position(heavy).x);
    lab.tick();
    let struck = kicks(&mut lab);
    // The light body then oscillates about the place that the slow mode gives it, half-way to the heavy body.
    let half = |lab: &Lab| 0.5 * f64::from(lab.position(heavy).x);
    let omega = (2.0 * k).sqrt();
    let phase = omega * f64::from(DT);
    let wanted = from * phase.cos() + (v - 0.5 * w) / omega * phase.sin();
    let off = f64::from(lab.position(light).x) - half(&lab) - wanted;
    println!(
        "{calm} kicks in calm, {struck} when struck, off by {off:.1e} m of {:.1e} m; slow mode {:.2} rad/s",
        10.0 / omega,
        (k / m / 2.0).sqrt()
    );
    assert!(calm <= 12, "{calm} kicks in calm");
    assert!(struck >= 70, "{struck} kicks when struck");
    assert!(off.abs() < 0.01 * 10.0 / omega, "{off} m");
}

#[test]
fn a_spring_off_the_centre_keeps_its_phase_beside_a_network_that_needs_the_whole_budget() {
    let plugin = CoiloverPlugin::default().with_resolve(300);
    let mut lab = Lab::with(plugin, Engine::weightless());
    let mut last = lab.point(Vec3::Y * 5.0);
    for i in 1..=400 {
        let next = lab.body(1.0, Vec3::new(i as f32, 5.0, 0.0));
        lab.spawn(
            Spring::new(last, next)
                .with_stiffness(1e5)
                .with_rest_length(0.99),
        );
        last = next;
    }
    // ω·dt is 10. The line passes through the centre of mass, so the ball only moves along it.
    let stiffness = (10.0 * 60.0_f64).powi(2);
    let hook = lab.point(Vec3::NEG_X);
    let ball = lab.body(1.0, Vec3::X * (1.0 + AMPLITUDE as f32));
    let spring = lab.spawn((
        Spring::new(hook, ball)
            .with_stiffness(stiffness as f32)
            .with_rest_length(1.0),
        Anchors::new(Vec3::X * 0.2, Vec3::NEG_X * 0.8),
    ));
    let omega = f64::from(stiffness as f32).sqrt();
    let off = error(&mut lab, ball, 1.0, |time| (omega * time).cos());
    println!("beside a network, ω·dt 10: off by {off:.1e} of its amplitude in 3 s");
    assert!(lab.readout(spring).microsteps >= 5);
    assert!(off < 0.01, "{off}");
}
