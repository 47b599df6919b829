//! Parts of a shock absorber: bump and rebound damping, stops, preload and force limit.

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use std::f64::consts::TAU;

/// A slider on a prescribed path, and a damper from a fixed point whose bump and rebound coefficients are 1 : 3.
#[test]
fn the_force_velocity_loop_of_a_driven_damper_is_its_law_and_its_work_the_integral() {
    let (amplitude, frequency) = (0.05, 1.0);
    let (bump, rebound) = (400.0_f64, 1200.0_f64);
    let mut lab = Lab::weightless();
    let wall = lab.point(Vec3::ZERO);
    // Kinematic, so that the damper does not change its path.
    let slider = lab.spawn((
        RigidBody::KinematicPositionBased,
        Transform::from_xyz(0.5, 0.0, 0.0),
        Velocity::default(),
    ));
    let damper = Damper::new(wall, slider).with_damping(1.0);
    let damper = lab.spawn((damper, DampingLaw::sided(bump as f32, rebound as f32)));
    let omega = TAU * frequency;
    // The engine must know the slider before it can move it.
    lab.tick();
    let (mut work, mut worst) = (0.0, 0.0_f64);
    let cycles = 4.0;
    for i in 1..=lab.ticks(cycles / frequency) {
        let t = i as f64 * lab.dt();
        lab.get_mut::<Transform>(slider).translation.x =
            0.5 + (amplitude * (omega * t).sin()) as f32;
        lab.tick();
        let seen = lab.readout(damper);
        let rate = f64::from(seen.rate);
        let wanted = rate * if rate < 0.0 { bump } else { rebound };
        worst = worst.max((f64::from(seen.damper_force) - wanted).abs());
        work += f64::from(seen.dissipated_power) * lab.dt();
    }
    // The energy readout agrees. All the heat is work of the slider.
    let seen = lab.readout(damper);
    assert!(
        (f64::from(seen.dissipated_energy) / work - 1.0).abs() < 1e-3,
        "{seen:?}"
    );
    assert!((seen.work - seen.dissipated_energy).abs() < 1e-3 * seen.work);
    // ∮ c ẋ dx over half a cycle is c π A² ω/2.
    let exact =
        cycles * 0.5 * (bump + rebound) * std::f64::consts::PI * amplitude * amplitude * omega;
    println!(
        "bump : rebound 1 : 3: force within {worst:.1e} N of the law, work {:+.2} % of the integral (bar 1 %)",
        100.0 * (work / exact - 1.0)
    );
    assert!(worst < 1e-2 && (work / exact - 1.0).abs() < 0.01);
}

/// A load of 10 kg on a spring with sided damping, driven by a slider on a sine.
#[test]
fn a_damped_body_on_a_driven_carriage_loses_what_the_integral_says() {
    let mut lab = Lab::weightless();
    let slider = lab.spawn((
        RigidBody::KinematicPositionBased,
        Transform::default(),
        Velocity::default(),
    ));
    let load = lab.body(10.0, Vec3::X);
    let pair = SpringDamper::new(slider, load)
        .with_stiffness(2000.0)
        .with_rest_length(1.0);
    let element = lab.spawn((pair, DampingLaw::sided(40.0, 120.0)));
    let omega = TAU * 2.0;
    let path = |t: f64| 0.02 * (omega * t).sin();
    // Reference by the classic Runge–Kutta method in 50 steps per tick. The state is position, velocity and heat.
    let flow = |t: f64, [x, v, _]: [f64; 3]| {
        let rate = v - 0.02 * omega * (omega * t).cos();
        let c = if rate < 0.0 { 40.0 } else { 120.0 };
        let force = 2000.0 * (x - path(t) - 1.0) + c * rate;
        [v, -force / 10.0, c * rate * rate]
    };
    let mut state = [1.0, 0.0, 0.0];
    for i in 1..=lab.ticks(10.0) {
        let t = i as f64 * lab.dt();
        lab.get_mut::<Transform>(slider).translation.x = path(t) as f32;
        lab.tick();
        let h = lab.dt() / 50.0;
        for j in 0..50 {
            let t = t - lab.dt() + h * f64::from(j);
            let go = |by: f64, d: [f64; 3]| [0, 1, 2].map(|n| state[n] + by * d[n]);
            let a = flow(t, state);
            let b = flow(t + 0.5 * h, go(0.5 * h, a));
            let c = flow(t + 0.5 * h, go(0.5 * h, b));
            let d = flow(t + h, go(h, c));
            state = [0, 1, 2].map(|n| state[n] + h / 6.0 * (a[n] + 2.0 * b[n] + 2.0 * c[n] + d[n]));
        }
    }
    let integral = state[2];
    let seen = lab.readout(element);
    let heat = f64::from(seen.dissipated_energy);
    // The work of the drive is stored energy, kinetic energy and heat.
    let v = f64::from(lab.velocity(load).length());
    let balance = f64::from(seen.work) - heat - f64::from(seen.stored_energy) - 5.0 * v * v;
    println!(
        "driven damper: ledger {heat:.3} J, by fine integration {integral:.3} J, balance {balance:+.1e} J"
    );
    assert!((heat / integral - 1.0).abs() < 0.01, "{heat} {integral}");
    assert!(balance.abs() < 5e-3 * heat, "{balance}");
}

fn cart(travel: SpringTravel, speed: f32) -> (Lab, Entity, Entity) {
    let mut lab = Lab::weightless();
    let wall = lab.point(Vec3::ZERO);
    let cart = lab.moving(body(1.0, Vec3::X), Velocity::linear(Vec3::X * speed));
    let spring = Spring::new(wall, cart)
        .with_stiffness(100.0)
        .with_rest_length(1.0);
    let element = lab.spawn((spring, travel));
    (lab, cart, element)
}

#[test]
fn stops_hit_at_speed_give_nothing_back_but_what_they_were_given() {
    for progression in [0.0, 20.0] {
        let travel = SpringTravel::new(0.8, 1.2, 1e4).with_progression(progression);
        let (mut lab, cart, element) = cart(travel, 5.0);
        let energy = |lab: &Lab| {
            let v = f64::from(lab.velocity(cart).length());
            0.5 * v * v + f64::from(lab.readout(element).stored_energy)
        };
        let (mut most, mut least) = (0.0_f64, f64::MAX);
        for _ in 0..lab.ticks(60.0) {
            lab.tick();
            most = most.max(energy(&lab) / 12.5);
            least = least.min(energy(&lab) / 12.5);
        }
        println!(
            "stops of 100 times the stiffness, progression {progression}: energy {least:.4} to {most:.4} of the first"
        );
        assert!(most < 1.002, "gained {most}");
        assert!(least > 0.95, "lost {least}");
    }
}

#[test]
fn pressed_against_its_stop_it_gives_way_as_the_static_law_says() {
    let travel = SpringTravel::new(0.8, 1.2, 1e4)
        .with_progression(20.0)
        .with_stop_damping(100.0);
    let (mut lab, cart, element) = cart(travel, 0.0);
    lab.spawn_force(cart, Vec3::NEG_X * 200.0);
    lab.run(6.0);
    let length = f64::from(lab.readout(element).length);
    // 100 · (1 − L) + 1e4 p (1 + 20 p) = 200 with p = 0.8 − L.
    let mut p = 0.01_f64;
    for _ in 0..50 {
        let f = 100.0 * (0.2 + p) + 1e4 * p * (1.0 + 20.0 * p) - 200.0;
        p -= f / (100.0 + 1e4 * (1.0 + 40.0 * p));
    }
    println!(
        "static penetration {:.6} m, by the law {p:.6} m",
        0.8 - length
    );
    assert!((0.8 - length - p).abs() < 1e-3 * p, "{length}");
}

#[test]
fn preload_shifts_the_place_of_rest_and_a_force_limit_holds() {
    let mut lab = Lab::weightless();
    let wall = lab.point(Vec3::ZERO);
    let body = lab.body(1.0, Vec3::X * 1.1);
    let pair = SpringDamper::new(wall, body)
        .with_stiffness(200.0)
        .with_damping(20.0)
        .with_rest_length(1.0);
    let element = lab.spawn((pair, Preload(-30.0)));
    lab.run(5.0);
    let length = lab.readout(element).length;
    assert!((length - 1.15).abs() < 1e-5, "{length}");

    let (mut lab, cart, element) = cart(SpringTravel::new(0.0, f32::INFINITY, 0.0), 0.0);
    lab.app
        .world_mut()
        .entity_mut(element)
        .remove::<SpringTravel>()
        .insert(MaxForce(5.0));
    lab.spawn_force(cart, Vec3::X * 7.0);
    // The limit leaves 2 N of the load at any stretch.
    lab.run(1.0);
    let speed = lab.velocity(cart).x;
    lab.run(2.0);
    let gained = lab.velocity(cart).x - speed;
    assert!((gained - 4.0).abs() < 1e-3, "{gained}");
    assert!((lab.readout(element).force() - 5.0).abs() < 1e-6);
}

#[test]
fn degressive_quadratic_and_tabled_dampers_brake_as_their_equations_say() {
    // Reference: m v̇ = −f(v) from 4 m/s by the classic Runge–Kutta method in 100 steps per tick.
    let laws: [(&str, DampingLaw, fn(f64) -> f64); 4] = [
        (
            "quadratic",
            DampingLaw::Quadratic {
                linear: 0.5,
                quadratic: 2.0,
            },
            |v| 0.5 * v + 2.0 * v * v,
        ),
        (
            "blow-off",
            DampingLaw::BlowOff {
                damping: 4.0,
                knee: 1.0,
                beyond: 0.5,
            },
            |v| 4.0 * v.min(1.0) + 0.5 * (v - 1.0).max(0.0),
        ),
        ("sided", DampingLaw::sided(9.0, 1.5), |v| 1.5 * v),
        (
            "table",
            DampingLaw::table([(-5.0, -5.0), (0.0, 0.0), (5.0, 5.0)]),
            |v| v,
        ),
    ];
    for (name, law, force) in laws {
        let mut lab = Lab::weightless();
        let wall = lab.point(Vec3::ZERO);
        let body = lab.moving(body(1.0, Vec3::X), Velocity::linear(Vec3::X * 4.0));
        lab.spawn((Damper::new(wall, body), law));
        let (mut v, mut worst) = (4.0_f64, 0.0_f64);
        for _ in 0..lab.ticks(2.0) {
            lab.tick();
            let h = lab.dt() / 100.0;
            for _ in 0..100 {
                let a = -force(v);
                let b = -force(v + 0.5 * h * a);
                let c = -force(v + 0.5 * h * b);
                let d = -force(v + h * c);
                v += h / 6.0 * (a + 2.0 * b + 2.0 * c + d);
            }
            worst = worst.max((f64::from(lab.velocity(body).x) - v).abs());
        }
        println!("{name} damper from 4 m/s: speed within {worst:.1e} m/s");
        assert!(worst < 8e-3, "{name}: {worst}");
    }
}

/// A cart of 1 kg that leaves a wall at 1 m/s.
fn leaving() -> (Lab, Entity, Entity) {
    let mut lab = Lab::weightless();
    let wall = lab.point(Vec3::ZERO);
    let cart = lab.moving(body(1.0, Vec3::X), Velocity::linear(Vec3::X));
    (lab, wall, cart)
}

#[test]
fn a_damper_with_a_limit_brakes_like_a_slipping_clutch_and_then_holds() {
    for damping in [50.0, 1e3, 1e5, 1e8] {
        let (mut lab, wall, cart) = leaving();
        let damper = Damper::new(wall, cart).with_damping(damping);
        let damper = lab.spawn((damper, MaxForce(6.0)));
        for tick in 1..=30 {
            lab.tick();
            let speed = f64::from(lab.velocity(cart).x);
            let slipping = 1.0 - 0.1 * f64::from(tick);
            println!("{damping} N s/m: {speed:.6} m/s after {tick} ticks");
            assert!(speed <= 1.0 && speed > -1e-3, "{damping}: {speed}");
            if slipping > 6.0 / f64::from(damping) + 0.1 {
                assert!(
                    (speed - slipping).abs() < 0.01,
                    "{damping}: {speed} {slipping}"
                );
            }
        }
        let heat = lab.readout(damper).dissipated_energy;
        assert!((heat - 0.5).abs() < 0.01, "{damping}: {heat} J");
        assert!(lab.velocity(cart).x.abs() < 0.02, "{damping}");
    }
}

#[test]
fn a_strong_damper_with_a_law_stops_a_body_as_one_without_does() {
    for damping in [20.0_f32, 600.0, 6e3, 6e5] {
        let law = DampingLaw::sided(damping, damping);
        let ways: [fn(&mut EntityWorldMut); 3] = [
            |_| (),
            |element| _ = element.insert(SpringTravel::new(0.5, 3.0, 1e4)),
            |element| _ = element.insert(Preload(0.0)),
        ];
        for (way, add) in ways.into_iter().enumerate() {
            let (mut lab, wall, cart) = leaving();
            let element = lab.spawn(Damper::new(wall, cart).with_damping(damping));
            let mut element = lab.app.world_mut().entity_mut(element);
            if way == 0 {
                element.insert(law.clone());
            }
            add(&mut element);
            lab.run(0.5);
            let (speed, at) = (lab.velocity(cart).x, lab.position(cart).x - 1.0);
            let exact = (1.0 - (-0.5 * damping).exp()) / damping;
            println!("{damping} N s/m, {way}: {speed:.2e} m/s at {at:.3e} m of {exact:.3e} m");
            assert!(speed.abs() < 1e-3, "{damping} {way}: {speed} m/s");
            assert!(
                (at - exact).abs() < 0.02 * exact + 6e-4,
                "{damping} {way}: {at} m"
            );
        }
    }
}

#[test]
fn two_clutches_side_by_side_slip_and_hold_like_one() {
    for (damping, most) in [(1e3, 6.0), (1e6, 6.0), (1e4, 600.0), (1e6, 6e4)] {
        let (mut lab, wall, cart) = leaving();
        let clutches = [0, 1].map(|_| {
            let damper = Damper::new(wall, cart).with_damping(0.5 * damping);
            lab.spawn((damper, MaxForce(0.5 * most)))
        });
        for tick in 1..=30 {
            lab.tick();
            let speed = f64::from(lab.velocity(cart).x);
            let slipping = 1.0 - f64::from(most) / 60.0 * f64::from(tick);
            println!("{damping} N s/m, {most} N: {speed:.6} m/s after {tick} ticks");
            assert!(speed <= 1.0 && speed > -0.01, "{damping} {most}: {speed}");
            if slipping > f64::from(most / damping) + 0.1 {
                assert!(
                    (speed - slipping).abs() < 0.01,
                    "{damping} {most}: {speed} {slipping}"
                );
            }
        }
        let heat: f32 = clutches
            .map(|e| lab.readout(e).dissipated_energy)
            .iter()
            .sum();
        assert!((heat - 0.5).abs() < 0.01, "{damping} {most}: {heat} J");
        let speed = lab.velocity(cart).x;
        assert!(speed.abs() < 0.02, "{damping} {most}: {speed} m/s");
    }
}

#[test]
fn two_clutches_side_by_side_slip_under_a_load_beyond_their_limit_and_hold_one_below() {
    for (load, speed, wanted) in [
        // m/s after half a second, of a cart of 1 kg.
        (5.0, 0.0, 0.0),
        (15.0, 0.0, 2.5),
        (15.0, 1.0, 3.5),
        (5.0, 1.0, 0.0),
        (-5.0, 1.0, 0.0),
        // At rest after 1/25 s, then pulled back by what is left.
        (-15.0, 1.0, -5.0 * (0.5 - 0.04)),
    ] {
        let (mut lab, wall, cart) = leaving();
        lab.get_mut::<Velocity>(cart).linear = Vec3::X * speed;
        lab.spawn_force(cart, Vec3::X * load);
        for _ in 0..2 {
            let damper = Damper::new(wall, cart).with_damping(5e3);
            lab.spawn((damper, MaxForce(5.0)));
        }
        lab.run(0.5);
        let now = lab.velocity(cart).x;
        println!(
            "clutches of 10 N, load {load} N, {speed} m/s: {now:.4} m/s, by theory {wanted:.4}"
        );
        assert!(
            (now - wanted).abs() < 0.15,
            "{load} {speed}: {now} {wanted}"
        );
    }
}
