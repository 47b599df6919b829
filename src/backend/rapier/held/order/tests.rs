//! How firm a rope may be on a body that joints hold.

use super::Order;
use crate::dynamics::element::{End, Path};
use crate::dynamics::tests::{element, point};
use crate::scene::held::{Inside, Leeway};
use bevy::math::DVec3;
use bevy::prelude::default;

/// Mass of the hook at the end of the rope, kg.
const HOOK: f64 = 0.1;

/// Greatest stiffness (N/m) and damping (N s/m) of a rope on a hook whose joints leave the share `jointed` of its inverse mass.
fn firmest(jointed: f64) -> [f64; 2] {
    let bodies = [point(HOOK, DVec3::X, DVec3::ZERO)];
    let fixed = End::Path(Path::straight(DVec3::ZERO, DVec3::ZERO));
    let hook = End::Body {
        index: 0,
        arm: DVec3::ZERO,
    };
    let rope = element(fixed, hook, 1e3, 0.0, 1.0);
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
