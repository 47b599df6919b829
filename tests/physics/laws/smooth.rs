//! Duffing's oscillator and the purely cubic spring. Complete elliptic integrals give their periods.

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;

/// A body of 1 kg on a spring of rest length 3 m from a fixed point, stretched by 1 m.
fn stretched(law: SpringLaw, stiffness: f32, microsteps: u32) -> (Lab, Entity) {
    let mut lab = Lab::with(
        CoiloverPlugin::default().with_microsteps(microsteps),
        Engine::weightless(),
    );
    // The place of rest is the origin, where f32 is most precise.
    let hook = lab.point(Vec3::NEG_X * 3.0);
    let body = lab.body(1.0, Vec3::X);
    let spring = Spring::new(hook, body)
        .with_stiffness(stiffness)
        .with_rest_length(3.0);
    let element = lab.spawn((spring, law));
    (lab, element)
}

/// Mean time between upward zero crossings of the stretch, by cubic interpolation, s.
fn period(lab: &mut Lab, element: Entity, seconds: f64) -> f64 {
    let mut last = (0.0, 1.0, 0.0);
    let mut crossings = Vec::new();
    for i in 1..=lab.ticks(seconds) {
        lab.tick();
        let readout = lab.readout(element);
        let now = (
            i as f64 * lab.dt(),
            f64::from(readout.length) - 3.0,
            f64::from(readout.rate),
        );
        if last.1 < 0.0 && now.1 >= 0.0 {
            let h = now.0 - last.0;
            let at = |s: f64| {
                let r = 1.0 - s;
                r * r * ((1.0 + 2.0 * s) * last.1 + s * h * last.2)
                    + s * s * ((3.0 - 2.0 * s) * now.1 - r * h * now.2)
            };
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..50 {
                let middle = 0.5 * (low + high);
                if at(middle) < 0.0 {
                    low = middle
                } else {
                    high = middle
                }
            }
            crossings.push(last.0 + low * h);
        }
        last = now;
    }
    let count = crossings.len() - 1;
    (crossings[count] - crossings[0]) / count as f64
}

#[test]
fn duffing_has_its_period_and_its_place() {
    // ẍ + ω²(x + x³) = 0 from x = 1 at rest: period 4.768022/ω, and x(1/ω) = 0.2336918.
    for (step, bars) in [(0.1, [5e-4, 5e-6]), (0.5, [1e-2, 1e-4])] {
        for (microsteps, bar) in [1, 16].into_iter().zip(bars) {
            let omega = step * 60.0;
            let k = (omega * omega) as f32;
            let law = SpringLaw::polynomial(k, 0.0, k);
            let (mut lab, element) = stretched(law.clone(), 0.0, microsteps);
            lab.run(1.0 / omega);
            let place = f64::from(lab.readout(element).length) - 3.0;
            let (mut lab, element) = stretched(law, 0.0, microsteps);
            let exact = 4.768_022 / omega;
            let error = period(&mut lab, element, 200.0 * exact) / exact - 1.0;
            println!(
                "Duffing, dt·ω {step} ×{microsteps}: period {error:+.1e} (bar {bar:e}), x(1) {:+.1e}",
                place - 0.233_691_8
            );
            assert!(error.abs() <= bar, "{error}");
            assert!((place - 0.233_691_8).abs() <= 2.0 * bar, "{place}");
        }
    }
}

#[test]
fn the_cubic_springs_period_falls_with_its_amplitude() {
    // T = 7.416299 √(m/k)/A.
    for (microsteps, bar) in [(1, 6e-4), (16, 3e-6)] {
        let omega = 0.1 * 60.0;
        let k = (omega * omega) as f32;
        let (mut lab, element) = stretched(SpringLaw::Cubic, k, microsteps);
        let exact = 7.416_299 / omega;
        let error = period(&mut lab, element, 100.0 * exact) / exact - 1.0;
        println!("cubic spring, dt·√(kA²/m) 0.1 ×{microsteps}: period {error:+.1e} (bar {bar:e})");
        assert!(error.abs() <= bar, "{error}");
    }
}

#[test]
fn a_table_and_a_function_of_ones_own_swing_like_the_polynomial_they_follow() {
    let swing = |law: SpringLaw| {
        let (mut lab, element) = stretched(law, 0.0, 4);
        period(&mut lab, element, 30.0)
    };
    let wanted = swing(SpringLaw::polynomial(36.0, 0.0, 36.0));
    let force = |x: f32| 36.0 * x + 36.0 * x * x * x;
    let points = (-40..=40).map(|i| 0.05 * i as f32).map(|x| (x, force(x)));
    let table = swing(SpringLaw::table(points)) / wanted - 1.0;
    let curve = FunctionCurve::new(Interval::new(-2.0, 2.0).expect("an interval"), force);
    let curved = swing(SpringLaw::Table(ForceTable::from_curve(&curve, 81))) / wanted - 1.0;
    let (mut lab, element) = stretched(SpringLaw::Linear, 0.0, 4);
    lab.app
        .world_mut()
        .entity_mut(element)
        .remove::<SpringLaw>()
        .insert(CustomSpringLaw::new(|x: f64| 36.0 * x + 36.0 * x * x * x));
    let own = period(&mut lab, element, 30.0) / wanted - 1.0;
    println!(
        "period against the polynomial's: table {table:.1e}, curve {curved:.1e}, function {own:.1e}"
    );
    assert!(table.abs() < 1e-3 && own.abs() < 1e-6, "{table} {own}");
    assert!((curved - table).abs() < 1e-5, "{curved}");
}
