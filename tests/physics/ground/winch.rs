//! A winch that lifts and lowers a load: a cable whose rest length the game changes in each tick.

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

const MASS: f32 = 400.0;
/// Cable that is out at first, m, by how much it changes, and how long that takes, s.
const OUT: f32 = 12.0;
const WAY: f32 = 6.0;
const SECONDS: f64 = 30.0;

/// Smooth from 0 to 1.
fn ease(t: f32) -> f32 {
    EaseFunction::SmootherStep.sample_clamped(t)
}

/// Winds a cable of the given stiffness and damping by `way`. Returns the least and the greatest force that its readout tells as
/// shares of the weight, the work that no ledger has as a share of the work done, and whether the cable is left.
fn wind([stiffness, damping]: [f32; 2], way: f32, rail: bool) -> ([f32; 2], f64, bool) {
    let mut lab = Lab::new();
    let weight = MASS * GRAVITY as f32;
    let hook = lab.point(Vec3::Y * 20.0);
    let load = lab.body(MASS, Vec3::Y * (20.0 - OUT - weight / stiffness));
    if rail {
        let shaft = lab.spawn((RigidBody::Fixed, Transform::default()));
        let slider = ImpulseJoint::new(shaft, PrismaticJointBuilder::new(Vec3::Y));
        lab.app.world_mut().entity_mut(load).insert(slider);
    }
    let cable = lab.spawn((
        SpringDamper::new(hook, load)
            .with_stiffness(stiffness)
            .with_damping(damping)
            .with_rest_length(OUT),
        Breakable::at_force(1.1 * weight),
    ));
    let balance = |lab: &Lab| {
        let seen = lab.readout(cable);
        let speed = f64::from(lab.velocity(load).length());
        let own = 0.5 * f64::from(MASS) * speed * speed
            + f64::from(weight) * f64::from(lab.position(load).y);
        own + f64::from(seen.stored_energy) + f64::from(seen.dissipated_energy)
            - f64::from(seen.work)
    };
    lab.run(2.0);
    let (first, start) = (balance(&lab), lab.readout(cable).work);
    let mut range = [f32::INFINITY, f32::NEG_INFINITY];
    for i in 1..=lab.ticks(SECONDS) {
        let out = OUT + way * ease((i as f64 * lab.dt() / SECONDS) as f32);
        lab.get_mut::<SpringDamper>(cable).rest_length = Some(out);
        lab.tick();
        if lab.app.world().get_entity(cable).is_err() {
            return (range, f64::NAN, false);
        }
        let force = lab.readout(cable).force() / weight;
        range = [range[0].min(force), range[1].max(force)];
    }
    lab.run(2.0);
    let work = f64::from(lab.readout(cable).work - start);
    (range, ((balance(&lab) - first) / work).abs(), true)
}

#[test]
fn a_winch_tells_the_weight_that_it_moves_and_its_cable_does_not_break() {
    let mut wrong = Vec::new();
    for law in [[2e5, 300.0], [2e5, 3000.0], [1e6, 300.0]] {
        for way in [-WAY, WAY] {
            for rail in [false, true] {
                let (range, off, whole) = wind(law, way, rail);
                let name = format!("{law:?} by {way} m, on a rail: {rail}");
                println!(
                    "{name}: tells {:.4} to {:.4} of the weight, {off:.1e} of its work off",
                    range[0], range[1]
                );
                // The load is accelerated by up to 0.04 m/s², 0.4 % of gravity.
                if !whole || range[0] < 0.98 || range[1] > 1.02 || off > 2e-3 {
                    wrong.push(name);
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
