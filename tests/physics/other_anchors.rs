//! Do the ends of an element go on as they were when it is given other anchors, another axis or another kind of end?

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// A change of the element is no stop of an end that the game moves.
#[test]
fn a_moving_point_drags_on_while_the_element_is_given_other_anchors_or_an_axis() {
    type Change = fn(&mut EntityWorldMut);
    let changes: [(&str, Change); 4] = [
        ("an anchor on the point", |element| {
            element.insert(Anchors::new(Vec3::X * 0.1, Vec3::ZERO));
        }),
        ("an anchor on the body", |element| {
            element.insert(Anchors::new(Vec3::ZERO, Vec3::X * 0.1));
        }),
        ("an axis", |element| {
            element.insert(SpringAxis::World(Vec3::X));
        }),
        ("another damping", |element| {
            let mut damper = element.get_mut::<Damper>().expect("a damper");
            damper.damping = 4.0;
        }),
    ];
    for (name, change) in changes {
        let mut lab = Lab::weightless();
        let end = lab.point(Vec3::ZERO);
        let body = lab.body(2.0, Vec3::X);
        let element = lab.spawn(Damper::new(end, body).with_damping(4.0));
        lab.tick();
        for i in 1..=60 {
            if i == 40 {
                change(&mut lab.app.world_mut().entity_mut(element));
            }
            lab.get_mut::<Transform>(end).translation.x = -0.6 * DT * i as f32;
            lab.tick();
        }
        let wanted = -0.6 * (1.0 - (-4.0 / 2.0 * 60.0 * DT).exp());
        let v = lab.velocity(body).x;
        // A point that stood for one tick would be missing 0.01 m/s of it.
        assert!((v - wanted).abs() < 1e-3, "{name}: {v} against {wanted}");
    }
}

#[test]
fn a_body_that_becomes_a_point_stays_where_it_is() {
    let mut lab = Lab::weightless();
    let buoy = lab.body(1.0, Vec3::X * 5.0);
    let body = lab.body(1.0, Vec3::X * 6.0);
    lab.spawn(Damper::new(buoy, body).with_damping(1.0));
    lab.run(0.1);
    lab.app.world_mut().entity_mut(buoy).remove::<RigidBody>();
    lab.run(0.1);
    let v = lab.velocity(body);
    assert!(v.length() < 1e-6, "nothing moved, and it got {v} m/s");
}
