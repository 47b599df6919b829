//! Do two free bodies that spin and are held off-centre keep momentum and energy?

use crate::harness::*;
use bevy::math::{DMat3, DVec3};
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

struct Body {
    mass: f32,
    inertia: Vec3,
    at: Vec3,
    linear: Vec3,
    angular: Vec3,
}

fn pair(lab: &mut Lab, stiffness: f32, damping: f32) -> ([Entity; 2], Entity) {
    let bodies = [
        Body {
            mass: 2.0,
            inertia: Vec3::new(0.2, 0.3, 0.45),
            at: Vec3::ZERO,
            linear: Vec3::new(0.0, -0.25, -0.125),
            angular: Vec3::new(1.0, -2.0, 0.5),
        },
        Body {
            mass: 0.5,
            inertia: Vec3::new(0.02, 0.05, 0.06),
            at: Vec3::new(2.0, 0.3, -0.1),
            linear: Vec3::new(0.0, 1.0, 0.5),
            angular: Vec3::new(-1.0, 0.5, 3.0),
        },
    ]
    .map(|b| {
        let entity = lab.spawn(brick(b.mass, b.inertia, b.at));
        *lab.get_mut::<Velocity>(entity) = Velocity {
            linear: b.linear,
            angular: b.angular,
        };
        entity
    });
    let element = lab.spawn((
        SpringDamper::new(bodies[0], bodies[1])
            .with_stiffness(stiffness)
            .with_damping(damping)
            .with_rest_length(1.0),
        Anchors::new(Vec3::new(0.4, 0.2, 0.1), Vec3::new(-0.3, 0.1, 0.2)),
    ));
    (bodies, element)
}

/// Linear momentum, N s, angular momentum about the origin, N m s, and kinetic energy, J.
fn moments(lab: &Lab, bodies: [Entity; 2]) -> (DVec3, DVec3, f64) {
    let (mut p, mut l, mut e) = (DVec3::ZERO, DVec3::ZERO, 0.0);
    for body in bodies {
        let AdditionalMassProperties::MassProperties(mass) =
            *lab.get::<AdditionalMassProperties>(body)
        else {
            panic!("bricks have their own mass properties")
        };
        let at = *lab.get::<Transform>(body);
        let v = *lab.get::<Velocity>(body);
        let m = f64::from(mass.mass);
        let r = DMat3::from_quat(at.rotation.as_dquat());
        let inertia = r * DMat3::from_diagonal(mass.principal_inertia.as_dvec3()) * r.transpose();
        let (linear, angular) = (v.linear.as_dvec3(), v.angular.as_dvec3());
        p += m * linear;
        l += at.translation.as_dvec3().cross(m * linear) + inertia * angular;
        e += 0.5 * (m * linear.length_squared() + angular.dot(inertia * angular));
    }
    (p, l, e)
}

/// Rapier computes the inertia in the world once for each of its steps, and a tick may have several.
#[test]
fn several_steps_of_the_engine_in_a_tick_keep_the_angular_momentum_as_one_does() {
    let wander = |substeps| {
        let engine = Engine {
            substeps,
            ..Engine::weightless()
        };
        let mut lab = Lab::with(CoiloverPlugin::default(), engine);
        let (bodies, _) = pair(&mut lab, 200.0, 0.0);
        lab.tick();
        let (_, before, _) = moments(&lab, bodies);
        let mut most = 0.0_f64;
        for _ in 0..300 {
            lab.tick();
            let (_, now, _) = moments(&lab, bodies);
            most = most.max((now - before).length() / before.length());
        }
        most
    };
    let [once, often] = [1, 4].map(wander);
    println!(
        "angular momentum wanders by {once:.1e} with one step in a tick, by {often:.1e} with four"
    );
    assert!(often < 3.0 * once + 1e-4, "{often:.1e}, {once:.1e}");
}

#[test]
fn momentum_and_energy_stay_for_ten_seconds() {
    let mut lab = Lab::weightless();
    let (bodies, element) = pair(&mut lab, 20.0, 0.0);
    lab.tick();
    let (p0, l0, kinetic) = moments(&lab, bodies);
    let e0 = kinetic + f64::from(lab.readout(element).stored_energy);
    let scale = l0.length();
    let (mut dp, mut dl, mut de) = (0.0_f64, 0.0_f64, 0.0_f64);
    for _ in 0..600 {
        lab.tick();
        let (p, l, kinetic) = moments(&lab, bodies);
        let e = kinetic + f64::from(lab.readout(element).stored_energy);
        dp = dp.max((p - p0).length());
        dl = dl.max((l - l0).length() / scale);
        de = de.max((e / e0 - 1.0).abs());
    }
    println!(
        "spinning pair, 10 s: linear momentum {dp:.1e} N s, angular {dl:.1e} of its size, energy {de:.1e}"
    );
    assert!(
        dp <= 1e-4 && dl <= 1e-4 && de <= 5e-3,
        "{dp:e} {dl:e} {de:e}"
    );
}

#[test]
fn damping_takes_energy_but_no_momentum() {
    let mut lab = Lab::weightless();
    let (bodies, element) = pair(&mut lab, 200.0, 3.0);
    lab.tick();
    let (p0, l0, mut before) = moments(&lab, bodies);
    before += f64::from(lab.readout(element).stored_energy);
    let first = before;
    lab.run(10.0);
    let (p1, l1, kinetic) = moments(&lab, bodies);
    let after = kinetic + f64::from(lab.readout(element).stored_energy);
    assert!((p1 - p0).length() <= 1e-4 && (l1 - l0).length() / l0.length() <= 1e-4);
    assert!(after < 0.9 * first, "{after} of {first}");
}
