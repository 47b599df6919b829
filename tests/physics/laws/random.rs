//! Random networks of mixed laws: their energy stays bounded.

use crate::dice::{Dice, seeds};
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// Inserts random companion components for a stiffness `k` in N/m, a usual stretch `s` and a rest length in m.
pub fn furnish(lab: &mut Lab, element: Entity, [k, s, rest]: [f32; 3], dice: &mut Dice) {
    let mut entity = lab.app.world_mut().entity_mut(element);
    match dice.pick(6) {
        0 => entity.insert(SpringLaw::polynomial(0.0, 0.0, k / (s * s))),
        1 => entity.insert(SpringLaw::polynomial(k, 0.5 * k / s, k / (s * s))),
        2 => entity.insert(SpringLaw::sided(
            Polynomial::new(k, 0.0, 0.0),
            Polynomial::new(0.2 * k, 0.0, k / (s * s)),
        )),
        3 => entity.insert(SpringLaw::table([
            (-s, -2.0 * k * s),
            (-0.2 * s, -0.1 * k * s),
            (0.3 * s, 0.2 * k * s),
            (s, k * s),
        ])),
        4 => {
            let (k, s) = (f64::from(k), f64::from(s));
            entity.insert(CustomSpringLaw::new(move |x: f64| {
                let y = x / s;
                k * s
                    * if y.abs() < 3.0 {
                        y.sinh()
                    } else {
                        3.0_f64.sinh() * y / 3.0
                    }
            }))
        }
        _ => &mut entity,
    };
    match dice.pick(5) {
        0 => entity.insert(SpringAction::Pull),
        1 => entity.insert(SpringAction::Push),
        2 => entity.insert(
            SpringTravel::new(rest - 0.5 * s, rest + 0.5 * s, 20.0 * k).with_progression(1.0 / s),
        ),
        3 => entity.insert(MaxForce(0.3 * k * s)),
        _ => &mut entity,
    };
    match dice.pick(4) {
        0 => entity.insert(Preload(-0.1 * k * s)),
        _ => &mut entity,
    };
}

/// Greatest energy gain over the kinetic and stored energy, now or at first, whichever is more.
fn scene(seed: u64, phase: f32) -> f64 {
    let mut dice = Dice(seed);
    let mut lab = Lab::new();
    let (mut bodies, mut masses) = (Vec::new(), Vec::new());
    for _ in 0..2 + dice.pick(6) {
        let at = dice.place();
        let mass = dice.between(0.5, 4.0);
        // The bodies are fixed until the stored energy has been read.
        let body = lab.body(mass, at);
        lab.app
            .world_mut()
            .entity_mut(body)
            .insert(RigidBody::Fixed);
        bodies.push(body);
        masses.push(mass);
    }
    let hook = lab.point(Vec3::Y * 5.0);
    let k = (phase * 60.0) * (phase * 60.0);
    for i in 0..bodies.len() + 2 {
        let a = if i == 0 {
            hook
        } else {
            bodies[dice.pick(bodies.len() as u32) as usize]
        };
        let b = bodies[i % bodies.len()];
        if a == b {
            continue;
        }
        let damping = if dice.pick(2) == 0 {
            0.0
        } else {
            0.2 * k.sqrt()
        };
        // Stretch that gives about 3 m/s. Far more would exceed the engine's speed limits.
        let stretch = (3.0 / k.sqrt()).min(0.5);
        let arm = if dice.pick(3) == 0 {
            dice.place() * 0.1
        } else {
            Vec3::ZERO
        };
        let d = lab.position(b) + arm - lab.position(a);
        let axis = (dice.pick(4) == 0).then(|| Vec3::new(1.0, 0.4, 0.0));
        let apart = axis.map_or(d.length(), |axis| d.dot(axis.normalize()));
        let rest = apart + stretch * dice.between(-1.0, 1.0);
        let rest = if axis.is_none() {
            rest.max(0.5 * stretch)
        } else {
            rest
        };
        let element = lab.spawn(
            SpringDamper::new(a, b)
                .with_stiffness(k)
                .with_damping(damping)
                .with_rest_length(rest),
        );
        lab.app
            .world_mut()
            .entity_mut(element)
            .insert(Anchors::new(Vec3::ZERO, arm));
        if let Some(axis) = axis {
            let axis = SpringAxis::World(axis);
            lab.app.world_mut().entity_mut(element).insert(axis);
        }
        furnish(&mut lab, element, [k, stretch, rest], &mut dice);
        if dice.pick(4) == 0 {
            let law = match dice.pick(3) {
                0 => DampingLaw::sided(0.1 * damping, damping),
                1 => DampingLaw::Quadratic {
                    linear: 0.0,
                    quadratic: damping,
                },
                _ => DampingLaw::BlowOff {
                    damping,
                    knee: 0.3,
                    beyond: 0.05 * damping,
                },
            };
            lab.app.world_mut().entity_mut(element).insert(law);
        }
    }
    lab.tick();
    let mut readouts = lab.app.world_mut().query::<&SpringReadout>();
    let mut energy = |lab: &Lab| {
        let (mut motion, mut place, mut stored) = (0.0, 0.0, 0.0);
        for (body, mass) in bodies.iter().zip(&masses) {
            let velocity = lab.get::<Velocity>(*body);
            let at = lab.position(*body);
            assert!(
                at.is_finite() && velocity.linear.is_finite() && velocity.angular.is_finite(),
                "seed {seed}, ω·dt {phase}: NaN"
            );
            let mass = f64::from(*mass);
            motion += 0.5 * mass * f64::from(velocity.linear.length_squared());
            motion += 0.2 * mass * f64::from(velocity.angular.length_squared());
            place += mass * GRAVITY * f64::from(at.y);
        }
        for readout in readouts.iter(lab.app.world()) {
            stored += f64::from(readout.stored_energy);
        }
        (motion + place + stored, motion + stored)
    };
    let (first, scale) = energy(&lab);
    for body in &bodies {
        lab.app
            .world_mut()
            .entity_mut(*body)
            .insert(RigidBody::Dynamic);
    }
    let mut most = 0.0_f64;
    for _ in 0..lab.ticks(4.0) {
        lab.tick();
        let (now, here) = energy(&lab);
        most = most.max((now - first) / here.max(scale));
    }
    most
}

#[test]
fn networks_of_mixed_laws_stay_bounded() {
    for (i, phase) in [0.1, 1.0, 10.0, 100.0].into_iter().enumerate() {
        let seeds = seeds(0..50).into_iter();
        let gains: Vec<f64> = seeds.map(|n| scene(4 * n + i as u64, phase)).collect();
        let most = gains.iter().copied().fold(0.0, f64::max);
        println!("random networks at ω·dt {phase}: energy gained at most {most:.1e}");
        assert!(most < 0.05, "{most}");
    }
}
