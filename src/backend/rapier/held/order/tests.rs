//! How firm a rope may be on a body that joints hold.

use super::Order;
use crate::dynamics::body::{Body, Spin};
use crate::dynamics::element::{Element, End, Path};
use crate::dynamics::guide::Guide;
use crate::scene::held::{Inside, Leeway};
use bevy::math::{DQuat, DVec3};
use bevy::prelude::default;

/// Mass of the hook at the end of the rope, kg.
const HOOK: f64 = 0.1;

/// Greatest stiffness (N/m) and damping (N s/m) of a rope on a hook whose joints leave the share `jointed` of its inverse mass.
fn firmest(jointed: f64) -> [f64; 2] {
    let bodies = [Body {
        position: DVec3::X,
        velocity: DVec3::ZERO,
        rotation: DQuat::IDENTITY,
        spin: Spin::Ignored,
        inverse_mass: DVec3::splat(HOOK.recip()),
        inertia: DVec3::ONE,
        principal: DQuat::IDENTITY,
        rotation_locked: [false; 3],
        farthest_turn: f64::INFINITY,
        acceleration: DVec3::ZERO,
        torque: DVec3::ZERO,
        given: (DVec3::ZERO, DVec3::ZERO),
        torque_work: 0.0,
        turned: None,
    }];
    let rope = Element {
        ends: [
            End::Path(Path::straight(DVec3::ZERO, DVec3::ZERO)),
            End::Body {
                index: 0,
                arm: DVec3::ZERO,
            },
        ],
        stiffness: 1e3,
        damping: 0.0,
        rest_length: 1.0,
        guide: Guide::Centres,
        law: None,
        angle: 0.0,
        heat: 0.0,
        work: 0.0,
        direction: None,
        stiff_damper: false,
    };
    let line = rope.line(&bodies).expect("its ends are apart");
    let inside = Inside {
        leeway: Leeway {
            jointed,
            ..default()
        },
        ..default()
    };
    let order = Order::new(0, &inside, (rope, line, None), &bodies, false, 1.0 / 60.0);
    order.reach.firmest
}

#[test]
fn a_rope_on_a_light_hook_yields_a_thousandth_of_a_millimetre_under_what_hangs_on_the_hook() {
    for load in [0.0, 15.0, 200.0, 900.0] {
        let mass = HOOK + load;
        let [stiffness, _] = firmest(HOOK / mass);
        let yields = mass * 9.81 / stiffness;
        assert!(yields < 1.2e-6, "{load} kg: {yields} m");
    }
}

#[test]
fn a_rope_on_what_joints_hold_completely_has_finite_limits() {
    let limits = firmest(0.0);
    assert!(limits.iter().all(|limit| limit.is_finite()), "{limits:?}");
}
