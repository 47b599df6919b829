//! Impacts on stops and ropes of elements that share a body: the energy that an element takes in comes out again.

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// A ball on equal parallel springs from one hook, which share the stiffness.
struct Ball {
    lab: Lab,
    ball: Entity,
    springs: Vec<Entity>,
}

impl Ball {
    /// A ball of 2 kg at rest length and at 2 m/s, so with 4 J.
    fn on(count: usize, stiffness: f32, plugin: CoiloverPlugin, law: impl Bundle + Clone) -> Self {
        let mut lab = Lab::with(plugin, Engine::weightless());
        let hook = lab.point(Vec3::ZERO);
        let ball = lab.moving(body(2.0, Vec3::X), Velocity::linear(Vec3::X * 2.0));
        let spring = Spring::new(hook, ball)
            .with_stiffness(stiffness / count as f32)
            .with_rest_length(1.0);
        let springs = (0..count)
            .map(|_| lab.spawn((spring, law.clone())))
            .collect();
        Self { lab, ball, springs }
    }

    fn energy(&self) -> f64 {
        let stored = |e: &Entity| f64::from(self.lab.readout(*e).stored_energy);
        f64::from(self.lab.velocity(self.ball).length_squared())
            + self.springs.iter().map(stored).sum::<f64>()
    }
}

fn settings() -> [(&'static str, CoiloverPlugin); 5] {
    let plugin = CoiloverPlugin::default;
    [
        ("1 micro-step", plugin()),
        ("4 micro-steps", plugin().with_microsteps(4)),
        ("extrapolated", plugin().with_extrapolation()),
        ("tolerance 1e-2", plugin().with_tolerance(1e-2)),
        ("tolerance 1e-4", plugin().with_tolerance(1e-4)),
    ]
}

#[test]
fn a_ball_between_two_springs_with_stops_keeps_its_energy_and_goes_as_on_one() {
    // ω·dt of the stops is 0.5, 1.7, 5.3 and 17.
    for stops in [2e3, 2e4, 2e5, 2e6] {
        for (name, plugin) in settings() {
            let travel = |count: f32| SpringTravel::new(0.0, 1.1, stops / count);
            let mut two = Ball::on(2, 200.0, plugin, travel(2.0));
            let fine = CoiloverPlugin::default().with_microsteps(64);
            let mut one = Ball::on(1, 200.0, fine, travel(1.0));
            let (mut apart, mut range) = (0.0_f32, [f64::MAX, f64::MIN]);
            for tick in 0..two.lab.ticks(10.0) {
                two.lab.tick();
                one.lab.tick();
                if tick < 60 {
                    let at = two.lab.position(two.ball);
                    apart = apart.max(at.distance(one.lab.position(one.ball)));
                }
                let energy = two.energy();
                range = [range[0].min(energy), range[1].max(energy)];
            }
            println!(
                "two springs with stops of {stops:.0e} N/m, {name}: energy {:.3} to {:.3} of 4 J in 10 s, {:.2} mm \
                 off in the first",
                range[0],
                range[1],
                1e3 * apart
            );
            assert!(range[0] > 3.98 && range[1] < 4.02, "{range:?}");
            assert!(apart < 8e-3, "{apart} m");
        }
    }
}

#[test]
fn a_cap_below_what_a_blow_asks_for_is_told() {
    // The second tolerance is so wide that only the stops need more than one micro-step.
    for plugin in [
        CoiloverPlugin::default(),
        CoiloverPlugin::default().with_tolerance(10.0),
    ] {
        for (most, told) in [(2, true), (64, false)] {
            let travel = SpringTravel::new(0.0, 1.1, 1e6);
            let mut two = Ball::on(2, 200.0, plugin.with_max_microsteps(most), travel);
            let mut capped = false;
            for _ in 0..two.lab.ticks(1.0) {
                two.lab.tick();
                capped |= two.lab.readout(two.springs[0]).capped;
            }
            assert_eq!(capped, told, "{plugin:?}, at most {most}");
        }
    }
}

#[test]
fn two_ropes_side_by_side_lose_no_more_than_one() {
    for (name, plugin) in settings() {
        let mut two = Ball::on(2, 2e4, plugin, SpringAction::Pull);
        let mut taut = false;
        for _ in 0..two.lab.ticks(2.0) {
            two.lab.tick();
            taut |= two.lab.readout(two.springs[0]).spring_force > 0.0;
        }
        println!(
            "two ropes, {name}: after the jerk {:.4} of 4 J",
            two.energy()
        );
        assert!(taut);
        assert!((two.energy() - 4.0).abs() < 0.02, "{}", two.energy());
    }
}

/// A car body of 1200 kg at 3 m/s on four springs of 30 kN/m at its corners. Rotation makes it a network of four elements.
#[test]
fn a_car_body_bounces_between_its_stops_for_a_minute() {
    for stops in [10.0, 100.0] {
        let mut lab = Lab::weightless();
        let car = brick(1200.0, Vec3::new(300.0, 1500.0, 1400.0), Vec3::ZERO);
        let car = lab.moving(car, Velocity::linear(Vec3::Y * 3.0));
        let springs = [(-1.3, -0.7), (-1.3, 0.7), (1.3, -0.7), (1.3, 0.7)].map(|(x, z)| {
            let hook = lab.point(Vec3::new(x, -0.5, z));
            lab.spawn((
                Spring::new(hook, car)
                    .with_stiffness(30e3)
                    .with_rest_length(0.5),
                Anchors {
                    a: Vec3::ZERO,
                    b: Vec3::new(x, 0.0, z),
                },
                SpringTravel::new(0.3, 0.65, stops * 30e3),
            ))
        });
        let mut range = [f64::MAX, f64::MIN];
        for _ in 0..lab.ticks(60.0) {
            lab.tick();
            let stored = springs.map(|e| f64::from(lab.readout(e).stored_energy));
            let speed = f64::from(lab.velocity(car).length_squared());
            let energy = 600.0 * speed + stored.iter().sum::<f64>();
            range = [range[0].min(energy), range[1].max(energy)];
        }
        println!(
            "car body, stops of {stops} times the stiffness: energy {:.0} to {:.0} of 5400 J in 60 s",
            range[0], range[1]
        );
        assert!(range[0] > 5300.0 && range[1] < 5500.0, "{range:?}");
    }
}

#[test]
fn a_tolerance_counts_where_every_element_has_a_law() {
    // Two cubic springs of 4 kN/m³ on both sides of a ball. Reference: 2 ẍ = −2·4000·x³ by the classic Runge–Kutta method.
    let flow = |[x, v]: [f64; 2]| [v, -4000.0 * x * x * x];
    let mut errors = [0.0_f64; 3];
    for (error, tolerance) in errors.iter_mut().zip([1e-2, 1e-3, 1e-4]) {
        let plugin = CoiloverPlugin::default().with_tolerance(tolerance);
        let mut lab = Lab::with(plugin, Engine::weightless());
        let hooks = [0.0, 3.0].map(|x| lab.point(Vec3::X * x));
        let ball = lab.moving(body(2.0, Vec3::X * 1.5), Velocity::linear(Vec3::X * 2.0));
        for hook in hooks {
            let spring = SpringDamper::new(hook, ball)
                .with_stiffness(4e3)
                .with_damping(0.0)
                .with_rest_length(1.5);
            lab.spawn((spring, SpringLaw::Cubic));
        }
        let mut state = [0.0, 2.0];
        let h = lab.dt() / 100.0;
        for _ in 0..lab.ticks(1.0) {
            lab.tick();
            for _ in 0..100 {
                let go = |by: f64, d: [f64; 2]| [state[0] + by * d[0], state[1] + by * d[1]];
                let a = flow(state);
                let b = flow(go(0.5 * h, a));
                let c = flow(go(0.5 * h, b));
                let d = flow(go(h, c));
                state =
                    [0, 1].map(|n| state[n] + h / 6.0 * (a[n] + 2.0 * b[n] + 2.0 * c[n] + d[n]));
            }
            let off = f64::from(lab.position(ball).x) - 1.5 - state[0];
            *error = error.max(off.abs());
        }
        println!("two cubic springs, tolerance {tolerance:.0e}: off by {error:.1e} m in a second");
        assert!(*error <= 3.0 * f64::from(tolerance), "{error}");
    }
    assert!(
        errors[2] < 0.5 * errors[0],
        "it changes something: {errors:?}"
    );
}

/// A weight of 2 kg falls 5 cm until two ropes are taut. In the end it hangs on them.
#[test]
fn a_weight_on_two_ropes_comes_to_rest_and_turns_no_more_to_heat_than_there_was() {
    for (phase, zeta) in [
        (0.3, 0.1),
        (1.0, 0.1),
        (3.0, 0.1),
        (5.0, 0.05),
        (10.0, 0.05),
        (15.0, 0.05),
        (20.0, 0.05),
        (50.0, 0.1),
    ] {
        let mut lab = Lab::new();
        let hook = lab.point(Vec3::ZERO);
        let weight = lab.body(2.0, Vec3::NEG_Y * 0.95);
        let stiffness = 2.0 * (phase / DT) * (phase / DT);
        let damping = 2.0 * zeta * (stiffness * 2.0).sqrt();
        let ropes = [0, 1].map(|_| {
            let rope = SpringDamper::new(hook, weight)
                .with_stiffness(0.5 * stiffness)
                .with_damping(0.5 * damping)
                .with_rest_length(1.0);
            lab.spawn((rope, SpringAction::Pull))
        });
        lab.run(20.0);
        let [a, b] = ropes.map(|rope| lab.readout(rope));
        let heat = f64::from(a.dissipated_energy + b.dissipated_energy);
        let sag = 2.0 * GRAVITY / f64::from(stiffness);
        let there = 2.0 * GRAVITY * (0.05 + sag) - 0.5 * f64::from(stiffness) * sag * sag;
        let off = f64::from(a.length) - 1.0 - sag;
        println!(
            "2 kg on two ropes, ω·dt {phase} ζ {zeta}: {heat:.3} J of heat of {there:.3} J, {:.1e} m off, asleep: {}",
            off,
            lab.is_sleeping(weight)
        );
        assert!(heat < 1.1 * there, "{heat} J of {there} J");
        assert!(off.abs() < 1e-4, "{off}");
        assert!(lab.is_sleeping(weight));
    }
}
