//! The energy balance: stored, kinetic and potential energy, heat, and work put in.

use crate::dice::Dice;
use crate::harness::*;
use bevy::diagnostic::{DiagnosticPath, DiagnosticsStore};
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

struct Scene {
    lab: Lab,
    bodies: Vec<(Entity, f32)>,
    elements: Vec<Entity>,
}

impl Scene {
    fn hang(&mut self, companion: impl Bundle, microphase: f32) -> (Entity, Entity) {
        let n = self.bodies.len() as f32;
        let hook = self.lab.point(Vec3::new(2.0 * n, 0.0, 0.0));
        let mass = 1.0 + 0.3 * n;
        let body = self.lab.body(mass, Vec3::new(2.0 * n + 0.4, -1.2, 0.1));
        let k = mass * (60.0 * microphase) * (60.0 * microphase);
        let pair = SpringDamper::new(hook, body)
            .with_stiffness(k)
            .with_damping(0.02 * (k * mass).sqrt())
            .with_rest_length(1.0);
        let element = self.lab.spawn((pair, companion));
        self.bodies.push((body, mass));
        self.elements.push(element);
        (hook, element)
    }

    /// Mechanical energy and stored energy plus heat minus work put in, J. This sum is constant.
    fn balance(&self) -> f64 {
        let mut sum = 0.0;
        for (body, mass) in &self.bodies {
            let velocity = self.lab.get::<Velocity>(*body);
            let height = f64::from(self.lab.position(*body).y);
            let mass = f64::from(*mass);
            let spin = 0.4 * mass * f64::from(velocity.angular.length_squared());
            sum += mass * (GRAVITY * height + 0.5 * f64::from(velocity.linear.length_squared()));
            sum += 0.5 * spin;
        }
        for element in &self.elements {
            let seen = self.lab.readout(*element);
            sum += f64::from(seen.stored_energy) + f64::from(seen.dissipated_energy)
                - f64::from(seen.work);
        }
        sum
    }

    fn heat(&self) -> f64 {
        let heat = |e: &Entity| f64::from(self.lab.readout(*e).dissipated_energy);
        self.elements.iter().map(heat).sum()
    }
}

#[test]
fn in_a_scene_with_every_law_nothing_is_lost_in_a_minute() {
    let mut lab = Lab::without_plugin(Engine::default());
    let plugin = CoiloverPlugin::default().with_microsteps(4);
    lab.app.add_plugins((plugin, CoiloverDiagnosticsPlugin));
    lab.prime();
    let mut scene = Scene {
        lab,
        bodies: Vec::new(),
        elements: Vec::new(),
    };
    let p = 0.15;
    scene.hang((), p);
    scene.hang(SpringLaw::Cubic, p);
    scene.hang(SpringLaw::polynomial(50.0, 30.0, 200.0), p);
    scene.hang(
        SpringLaw::table([(-0.5, -60.0), (-0.1, -5.0), (0.2, 10.0), (1.0, 90.0)]),
        p,
    );
    scene.hang(
        CustomSpringLaw::new(|x: f64| 90.0 * x + 30.0 * x.powi(5)),
        p,
    );
    scene.hang(DampingLaw::sided(0.5, 2.0), p);
    scene.hang(
        DampingLaw::Quadratic {
            linear: 0.1,
            quadratic: 1.0,
        },
        p,
    );
    scene.hang(
        DampingLaw::BlowOff {
            damping: 2.0,
            knee: 0.4,
            beyond: 0.2,
        },
        p,
    );
    scene.hang(SpringAction::Pull, p);
    scene.hang(
        SpringTravel::new(0.7, 1.15, 3000.0).with_stop_damping(5.0),
        p,
    );
    scene.hang(Preload(-8.0), p);
    scene.hang(MaxForce(60.0), p);
    scene.hang(SpringAxis::World(Vec3::Y), p);
    // A tie joins two of the bodies, which makes a network with a law.
    let [a, b] = [scene.bodies[0].0, scene.bodies[1].0];
    let tie = SpringDamper::new(a, b)
        .with_stiffness(30.0)
        .with_damping(0.3);
    let tie = scene
        .lab
        .spawn((tie, SpringLaw::polynomial(20.0, 5.0, 5.0)));
    scene.elements.push(tie);
    // A hook that moves, and an actuator.
    let (hook, _) = scene.hang((), p);
    let (_, actuator) = scene.hang((), p);
    scene.lab.tick();
    let (first, mut worst) = (scene.balance(), 0.0_f64);
    let start = scene
        .bodies
        .iter()
        .map(|(body, mass)| f64::from(mass * scene.lab.velocity(*body).length_squared()))
        .sum::<f64>();
    let mut dice = Dice(7);
    for i in 0..scene.lab.ticks(60.0) {
        let t = i as f32 * DT;
        let rest = 1.0 + 0.1 * (2.0 * t).sin() + 0.002 * dice.between(-1.0, 1.0);
        scene.lab.get_mut::<SpringDamper>(actuator).rest_length = Some(rest);
        scene.lab.get_mut::<Transform>(hook).translation.y = 0.1 * (3.0 * t).sin();
        scene.lab.tick();
        worst = worst.max((scene.balance() - first).abs());
    }
    let turned_over = scene.heat();
    println!(
        "ledger over 60 s: {turned_over:.1} J turned to heat, balance within {worst:.2e} J (bar {:.2e}), start {start:.1}",
        2e-5 * turned_over
    );
    for element in &scene.elements {
        let seen = scene.lab.readout(*element);
        assert!(seen.dissipated_energy >= -1e-3, "{seen:?}");
    }
    assert!(worst <= 2e-5 * turned_over, "{worst}");

    let store = scene.lab.app.world().resource::<DiagnosticsStore>();
    let value = |path: DiagnosticPath| {
        store
            .get(&path)
            .and_then(|d| d.value())
            .expect("a measurement")
    };
    assert!(
        (value(CoiloverDiagnosticsPlugin::DISSIPATED_ENERGY) - turned_over).abs()
            < 1e-3 * turned_over
    );
    assert!(value(CoiloverDiagnosticsPlugin::STORED_ENERGY) > 0.0);
    assert!(value(CoiloverDiagnosticsPlugin::WORST_OMEGA_DT) > 0.1);
    let solved = value(CoiloverDiagnosticsPlugin::CLOSED_FORM)
        + value(CoiloverDiagnosticsPlugin::DIRECT)
        + value(CoiloverDiagnosticsPlugin::RESTING);
    assert_eq!(solved, scene.elements.len() as f64);
}

/// The game did this work (J) on an element at a body of 1 kg, and it is there as stored energy and motion.
fn assert_work(lab: &Lab, element: Entity, body: Entity, work: f32) {
    let seen = lab.readout(element);
    let motion = 0.5 * lab.velocity(body).length_squared();
    assert!((seen.work - work).abs() < 1e-4, "{seen:?}");
    assert!((seen.stored_energy + motion - work).abs() < 1e-3);
}

#[test]
fn what_an_actuator_does_is_its_work() {
    // Shortening the rest length by Δ = 0.1 m at once puts in ½ k Δ².
    let mut lab = Lab::weightless();
    let hook = lab.point(Vec3::ZERO);
    let body = lab.body(1.0, Vec3::X);
    let element = lab.spawn(
        Spring::new(hook, body)
            .with_stiffness(80.0)
            .with_rest_length(1.0),
    );
    lab.run(0.1);
    lab.get_mut::<Spring>(element).rest_length = Some(0.9);
    lab.run(0.5);
    assert_work(&lab, element, body, 0.4);
}

#[test]
fn an_anchor_that_is_put_elsewhere_on_its_body_does_the_work_of_the_stretch() {
    let mut lab = Lab::weightless();
    let hook = lab.point(Vec3::ZERO);
    let body = lab.body(1.0, Vec3::X);
    let spring = Spring::new(hook, body).with_stiffness(80.0);
    let element = lab.spawn(spring.with_rest_length(1.0));
    lab.run(0.1);
    let farther = Anchors::new(Vec3::ZERO, Vec3::X * 0.1);
    lab.app.world_mut().entity_mut(element).insert(farther);
    lab.run(0.5);
    assert_work(&lab, element, body, 0.4);
}

/// A body of 10 t, which hardly moves, is 0.6 m beside and 0.8 m below a hook, on a spring of 100 N/m and 0.5 m.
#[test]
fn another_axis_or_an_anchor_on_the_hook_does_the_work_of_the_stretch() {
    type Change = fn(&mut EntityWorldMut);
    let changes: [(&str, Change, f64); 3] = [
        (
            "an anchor on the hook",
            |spring| {
                spring.insert(Anchors::new(Vec3::Y * 0.8, Vec3::ZERO));
            },
            0.6,
        ),
        (
            "an axis",
            |spring| {
                spring.insert(SpringAxis::World(Vec3::X));
            },
            0.6,
        ),
        (
            "another axis",
            |spring| {
                spring.insert(SpringAxis::World(Vec3::Y));
            },
            0.8,
        ),
    ];
    let stored = |length: f64| 50.0 * (length - 0.5) * (length - 0.5);
    for (name, change, length) in changes {
        for neighbours in [0, 1] {
            let mut lab = Lab::weightless();
            let hook = lab.point(Vec3::ZERO);
            let body = lab.body(1e4, Vec3::new(0.6, 0.8, 0.0));
            let spring = Spring::new(hook, body)
                .with_stiffness(100.0)
                .with_rest_length(0.5);
            let element = lab.spawn(spring);
            for _ in 0..neighbours {
                let other = lab.body(1e4, Vec3::new(1.6, 0.8, 0.0));
                lab.spawn(Spring::new(body, other));
            }
            lab.run(0.1);
            change(&mut lab.app.world_mut().entity_mut(element));
            lab.run(0.1);
            let seen = lab.readout(element);
            let (was, now) = (stored(1.0), stored(length));
            let about = format!("{name}, {neighbours} neighbours: {seen:?}");
            assert!(
                (f64::from(seen.stored_energy) - now).abs() < 0.01,
                "{about}"
            );
            assert!((f64::from(seen.work) - (now - was)).abs() < 0.01, "{about}");
            // Back again.
            let mut entity = lab.app.world_mut().entity_mut(element);
            entity.remove::<(Anchors, SpringAxis)>();
            lab.run(0.1);
            let work = lab.readout(element).work;
            assert!(work.abs() < 0.01, "{name}: {work} J at last");
        }
    }
}

/// A car body of 1200 kg at 3 m/s on four springs with dampers at its corners. All energy it loses is heat.
#[test]
fn the_heat_of_a_network_is_as_exact_as_its_motion() {
    let steps = |count| CoiloverPlugin::default().with_microsteps(count);
    for (name, plugin, bar) in [
        ("1 micro-step", steps(1), 1e-2),
        ("4 micro-steps", steps(4), 1e-3),
        ("16 micro-steps", steps(16), 1e-4),
        ("extrapolated", steps(1).with_extrapolation(), 1e-4),
    ] {
        let engine = Engine::weightless();
        let mut lab = Lab::with(plugin, engine);
        let car = brick(1200.0, Vec3::new(300.0, 1500.0, 1400.0), Vec3::ZERO);
        let car = lab.moving(car, Velocity::linear(Vec3::Y * 3.0));
        let corners = [(-1.3, -0.7), (-1.3, 0.7), (1.3, -0.7), (1.3, 0.7)].map(|(x, z)| {
            let hook = lab.point(Vec3::new(x, -0.5, z));
            let pair = SpringDamper::new(hook, car)
                .with_stiffness(30e3)
                .with_damping(1500.0)
                .with_rest_length(0.5);
            let b = Vec3::new(x, 0.0, z);
            lab.spawn((pair, Anchors { a: Vec3::ZERO, b }))
        });
        lab.run(3.0);
        let sum = |of: fn(&SpringReadout) -> f32| -> f64 {
            corners
                .iter()
                .map(|e| f64::from(of(&lab.readout(*e))))
                .sum()
        };
        let speed = f64::from(lab.velocity(car).length_squared());
        let lost = 5400.0 - 600.0 * speed - sum(|r| r.stored_energy);
        let heat = sum(|r| r.dissipated_energy);
        let off = heat / lost - 1.0;
        println!(
            "car body on four dampers, {name}: {heat:.1} J of heat for {lost:.1} J lost ({:+.3} %)",
            100.0 * off
        );
        assert!(off.abs() < bar, "{name}: {off}");
    }
}
