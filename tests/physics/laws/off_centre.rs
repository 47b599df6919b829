//! Force laws at anchors off the centre of a body that cannot turn.

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

#[test]
fn a_law_at_the_edge_of_a_body_that_cannot_turn_acts_from_there() {
    let polynomial = Polynomial {
        linear: 100.0,
        ..default()
    };
    // A linear law and an equal stiffness must move the body alike.
    let [by_law, by_stiffness] = [true, false].map(|is_law| {
        let mut lab = Lab::weightless();
        let hook = lab.point(Vec3::new(0.0, 2.0, 0.5));
        let body = lab.body(1.0, Vec3::ZERO);
        let locked = LockedAxes::ROTATION_LOCKED;
        lab.app.world_mut().entity_mut(body).insert(locked);
        let spring = Spring::new(hook, body)
            .with_stiffness(100.0)
            .with_rest_length(1.0);
        let anchors = Anchors::new(Vec3::ZERO, Vec3::new(0.8, 0.3, 0.0));
        let element = lab.spawn((spring, anchors));
        if is_law {
            let law = SpringLaw::Polynomial {
                pull: polynomial,
                push: polynomial,
            };
            lab.app.world_mut().entity_mut(element).insert(law);
        }
        lab.tick();
        let first = lab.readout(element).length;
        let wanted = Vec3::new(0.8, 0.3 - 2.0, -0.5).length();
        assert!((first - wanted).abs() < 0.02, "law {is_law}: {first} m");
        lab.run(0.5);
        lab.position(body)
    });
    let apart = by_law.distance(by_stiffness);
    assert!(by_law.length() > 0.1, "it moves: {by_law}");
    assert!(apart < 0.01, "{by_law} by law, {by_stiffness} by stiffness");
}
