//! Tests the joints of `KHR_physics_rigid_bodies`: rigid limits become Rapier joints, soft limits and drives become elements.

use crate::gltf_physics::{G, physics, play};
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use serde_json::{Value, json};
use std::f32::consts::{FRAC_PI_4, TAU};

/// A fixed hook, a body of 2 kg one metre below it, and a joint between them.
fn joint(name: &str, kind: Value) -> (Folder, Stage, Entity) {
    let nodes = json!([
        physics(
            "Hook",
            [0.0, 2.0, 0.0],
            json!({ "joint": { "connectedNode": 1, "joint": 0 } })
        ),
        physics(
            "Body",
            [0.0, 1.0, 0.0],
            json!({ "motion": { "mass": 2, "inertiaDiagonal": [0.1, 0.1, 0.1] } })
        ),
    ]);
    play(
        name,
        nodes,
        json!({ "KHR_physics_rigid_bodies": { "physicsJoints": [kind] } }),
    )
}

#[test]
fn a_limit_of_equal_min_and_max_with_a_stiffness_is_a_spring_damper() {
    let (_folder, mut stage, root) = joint(
        "spring",
        json!({ "limits": [
        { "linearAxes": [0, 1, 2], "min": 1, "max": 1, "stiffness": 80, "damping": 0 }] }),
    );
    let mut pairs = stage.app.world_mut().query::<&SpringDamper>();
    let pair = *pairs.single(stage.app.world()).expect("one element");
    assert_eq!(
        (pair.stiffness, pair.damping, pair.rest_length),
        (80.0, 0.0, Some(1.0))
    );
    assert_eq!(pair.body_a, stage.node(root, "Hook"));
    // Released at rest length, it swings about its sag with the frequency √(k/m)/2π.
    let body = stage.node(root, "Body");
    let mut lowest = (0.0_f32, 0.0);
    let period = TAU / (80.0_f32 / 2.0).sqrt();
    for i in 0..(1.2 * period / DT) as usize {
        stage.app.update();
        let y = stage.place(body).translation.y;
        if y < lowest.0 || i == 0 {
            lowest = (y, i as f32 * DT);
        }
    }
    let sag = 2.0 * G / 80.0;
    assert!(
        (lowest.0 - (1.0 - 2.0 * sag)).abs() < 0.01 * sag,
        "{lowest:?}"
    );
    assert!(
        (lowest.1 - period / 2.0).abs() < 3.0 * DT,
        "{lowest:?} {period}"
    );
    assert!(stage.faults().is_empty(), "{:?}", stage.faults());
}

#[test]
fn a_soft_max_alone_is_a_rope_and_a_rigid_one_too() {
    for (name, stiffness) in [("rope", Some(4000.0)), ("rod", None)] {
        let mut limit = json!({ "linearAxes": [0, 1, 2], "max": 1.5 });
        if let Some(stiffness) = stiffness {
            limit["stiffness"] = json!(stiffness);
            limit["damping"] = json!(200);
        }
        let (_folder, mut stage, root) = joint(name, json!({ "limits": [limit] }));
        let body = stage.node(root, "Body");
        run(&mut stage.app, 0.2);
        let free = 1.0 - 0.5 * G * 0.04;
        assert!(
            (stage.place(body).translation.y - free).abs() < 0.05,
            "slack is slack"
        );
        run(&mut stage.app, 3.0);
        let y = stage.place(body).translation.y;
        let sag = stiffness.map_or(0.0, |k| 2.0 * G / k);
        assert!((y - (0.5 - sag)).abs() < 5e-3, "{name} {y}");
    }
}

#[test]
fn one_axis_is_a_spring_axis_and_stops_are_travel() {
    // A slide along Y: all other axes are rigid.
    let (_folder, mut stage, root) = joint(
        "slide",
        json!({ "limits": [
        { "linearAxes": [0, 2], "max": 0 },
        { "angularAxes": [0, 1, 2], "max": 0 },
        { "linearAxes": [1], "min": -1.25, "max": 0.5, "stiffness": 2000, "damping": 50 }] }),
    );
    run(&mut stage.app, 4.0);
    let body = stage.node(root, "Body");
    let place = stage.place(body);
    let sag = 2.0 * G / 2000.0;
    assert!(
        (place.translation - Vec3::Y * (0.75 - sag)).length() < 2e-3,
        "{place:?}"
    );
    assert_eq!(stage.count::<SpringAxis>(), 1);
    assert_eq!(stage.count::<SpringTravel>(), 1);
    assert!(stage.faults().is_empty(), "{:?}", stage.faults());
}

#[test]
fn a_linear_drive_holds_its_target_against_the_weight_up_to_its_force() {
    for (name, max, wanted) in [
        ("drive", Value::Null, 0.5 - 2.0 * G / 500.0),
        ("weak", json!(10), f32::NAN),
    ] {
        let mut drive = json!({ "type": "linear", "mode": "force", "axis": 1, "positionTarget": -1.5,
            "stiffness": 500, "damping": 60 });
        if !max.is_null() {
            drive["maxForce"] = max;
        }
        let (_folder, mut stage, root) = joint(
            name,
            json!({
                "limits": [{ "linearAxes": [0, 2], "max": 0 }, { "angularAxes": [0, 1, 2], "max": 0 }],
                "drives": [drive],
            }),
        );
        let body = stage.node(root, "Body");
        run(&mut stage.app, 3.0);
        let y = stage.place(body).translation.y;
        if wanted.is_nan() {
            assert!(y < -5.0, "10 N do not hold 2 kg: {y}");
            assert_eq!(stage.count::<MaxForce>(), 1);
        } else {
            assert!((y - wanted).abs() < 2e-3, "{y} is not {wanted}");
        }
    }
}

#[test]
fn drives_reach_their_speed() {
    let slide = json!([{ "linearAxes": [0, 1], "max": 0 }, { "angularAxes": [0, 1, 2], "max": 0 }]);
    let hinge = json!([{ "linearAxes": [0, 1, 2], "min": 0, "max": 0 }, { "angularAxes": [0, 1], "max": 0 }]);
    for mode in ["force", "acceleration"] {
        for (kind, limits) in [("linear", &slide), ("angular", &hinge)] {
            let drive = json!({ "type": kind, "mode": mode, "axis": 2, "velocityTarget": 1.5, "damping": 20 });
            let nodes = json!([
                physics(
                    "Hook",
                    [0.0; 3],
                    json!({ "joint": { "connectedNode": 1, "joint": 0 } })
                ),
                physics(
                    "Body",
                    [0.0; 3],
                    json!({ "motion": {
                    "mass": 2, "inertiaDiagonal": [0.1, 0.1, 0.1], "gravityFactor": 0 } })
                ),
            ]);
            let kinds = json!({ "KHR_physics_rigid_bodies": { "physicsJoints": [{ "limits": limits, "drives": [drive] }] } });
            let (_folder, mut stage, root) = play(&format!("speed_{mode}_{kind}"), nodes, kinds);
            run(&mut stage.app, 2.0);
            let velocity = *stage.get::<Velocity>(stage.node(root, "Body"));
            let found = if kind == "linear" {
                velocity.linear.z
            } else {
                velocity.angular.z
            };
            assert!((found - 1.5).abs() < 0.01, "{mode} {kind}: {velocity:?}");
            assert!(stage.faults().is_empty(), "{:?}", stage.faults());
        }
    }
}

#[test]
fn an_angular_spring_pulls_the_frames_together_not_the_bodies() {
    // The connected node is rotated by 0.4 rad on its body, so the body rests at −0.4 rad.
    let nodes = json!([
        physics("Hook", [0.0; 3], json!({ "joint": { "connectedNode": 2, "joint": 0 } })),
        { "name": "Body", "children": [2], "extensions": { "KHR_physics_rigid_bodies": { "motion": {
            "mass": 2, "inertiaDiagonal": [0.1, 0.1, 0.1], "gravityFactor": 0 } } } },
        { "name": "Frame", "rotation": [0, 0, 0.19866933, 0.9800666] },
    ]);
    let kinds = json!({ "KHR_physics_rigid_bodies": { "physicsJoints": [{ "limits": [
        { "linearAxes": [0, 1, 2], "max": 0 },
        { "angularAxes": [0, 1], "max": 0 },
        { "angularAxes": [2], "min": 0, "max": 0, "stiffness": 5, "damping": 1 }] }] } });
    let (_folder, mut stage, root) = play("twist", nodes, kinds);
    run(&mut stage.app, 3.0);
    let turned = stage.place(stage.node(root, "Body")).rotation;
    assert!(
        turned.angle_between(Quat::from_rotation_z(-0.4)) < 1e-3,
        "{turned:?}"
    );
    assert_eq!(stage.count::<TorsionSpringDamper>(), 1);
    assert!(stage.faults().is_empty(), "{:?}", stage.faults());
}

#[test]
fn an_uneven_scale_of_a_body_does_not_skew_the_frame_of_a_joint() {
    let eighth = Quat::from_rotation_z(FRAC_PI_4);
    let motion = json!({ "mass": 2, "inertiaDiagonal": [0.1, 0.1, 0.1] });
    let joint = json!({ "connectedNode": 2, "joint": 0 });
    let mut body = physics("Body", [0.0, 1.0, 0.0], json!({ "motion": motion }));
    body["scale"] = json!([1, 3, 0.5]);
    body["children"] = json!([2]);
    let nodes = json!([
        physics("Hook", [0.0, 2.0, 0.0], json!({ "joint": joint })),
        body,
        { "name": "Frame", "translation": [0.5, 0.25, 0], "rotation": eighth.to_array() },
    ]);
    let kinds = json!({ "physicsJoints": [{ "limits": [
        { "linearAxes": [0, 1, 2], "max": 0 }, { "angularAxes": [0, 1], "max": 0 }] }] });
    let kinds = json!({ "KHR_physics_rigid_bodies": kinds });
    let (_folder, mut stage, _root) = play("uneven", nodes, kinds);
    let mut joints = stage.app.world_mut().query::<&ImpulseJoint>();
    let joint = joints.single(stage.app.world()).expect("one joint");
    let at = joint.data.as_ref().raw.local_frame2;
    let (turned, off) = (at.rotation, at.translation - Vec3::new(0.5, 0.75, 0.0));
    assert!((turned.length() - 1.0).abs() < 1e-5, "{turned}");
    assert!(turned.angle_between(eighth) < 2e-3, "{turned}");
    assert!(off.length() < 1e-5, "{off}");
}

/// A body of 2 kg one metre below a hook. They may collide, so a joint is needed only if it can hold some limit.
fn hanging(name: &str, limits: Value) -> (Folder, Stage, Entity) {
    let joint = json!({ "connectedNode": 1, "joint": 0, "enableCollision": true });
    let motion = json!({ "mass": 2, "inertiaDiagonal": [0.1, 0.1, 0.1] });
    let nodes = json!([
        physics("Hook", [0.0, 2.0, 0.0], json!({ "joint": joint })),
        physics("Body", [0.0, 1.0, 0.0], json!({ "motion": motion })),
    ]);
    let kinds = json!({ "physicsJoints": [{ "limits": limits }] });
    play(name, nodes, json!({ "KHR_physics_rigid_bodies": kinds }))
}

#[test]
fn a_rigid_limit_whose_min_cannot_be_held_holds_its_max() {
    let limit = json!({ "linearAxes": [0, 1, 2], "min": 0.5, "max": 1.5 });
    let (_folder, mut stage, root) = hanging("min_max", json!([limit]));
    run(&mut stage.app, 3.0);
    assert_eq!(stage.count::<ImpulseJoint>(), 1);
    let y = stage.place(stage.node(root, "Body")).translation.y;
    assert!((y - 0.5).abs() < 5e-3, "{y}");
}

#[test]
fn a_soft_limit_of_no_distance_on_two_axes_pulls_from_both_sides() {
    let limit = json!({ "linearAxes": [0, 2], "max": 0, "stiffness": 200, "damping": 5 });
    let (_folder, mut stage, _root) = hanging("soft_zero", json!([limit]));
    run(&mut stage.app, 0.1);
    assert_eq!(stage.count::<SpringTravel>(), 0);
    let mut pairs = stage
        .app
        .world_mut()
        .query::<(&SpringDamper, &SpringAxis)>();
    let pairs: Vec<_> = pairs.iter(stage.app.world()).collect();
    assert_eq!(pairs.len(), 2);
    assert!(pairs.iter().all(|(pair, _)| pair.rest_length == Some(0.0)));
}

#[test]
fn what_holds_nothing_is_no_joint() {
    let limit = json!({ "linearAxes": [0, 1, 2], "min": 0.5 });
    let (_folder, mut stage, root) = hanging("min_alone", json!([limit]));
    run(&mut stage.app, 1.0);
    assert_eq!(stage.count::<ImpulseJoint>(), 0);
    let y = stage.place(stage.node(root, "Body")).translation.y;
    assert!(y < -2.0, "{y}");
}

#[test]
fn of_rigid_limits_that_share_an_axis_the_first_holds() {
    let range = json!({ "linearAxes": [0], "min": -0.25, "max": 0.5 });
    let disc = json!({ "linearAxes": [0, 1], "max": 5 });
    let still = json!({ "linearAxes": [0], "max": 0, "min": 0 });
    let xy = JointAxesMask::LIN_X | JointAxesMask::LIN_Y;
    for (name, limits, coupled, locked, wanted) in [
        (
            "range_disc",
            [&range, &disc],
            JointAxesMask::empty(),
            JointAxesMask::empty(),
            [-0.25, 0.5],
        ),
        (
            "disc_range",
            [&disc, &range],
            xy,
            JointAxesMask::empty(),
            [0.0, 5.0],
        ),
        (
            "disc_still",
            [&disc, &still],
            xy,
            JointAxesMask::empty(),
            [0.0, 5.0],
        ),
        // What stands still has room for no range: this is exact.
        (
            "range_still",
            [&range, &still],
            JointAxesMask::empty(),
            JointAxesMask::LIN_X,
            [-0.25, 0.5],
        ),
    ] {
        let (_folder, mut stage, _root) = hanging(name, json!(limits));
        let mut joints = stage.app.world_mut().query::<&ImpulseJoint>();
        let joint = joints.single(stage.app.world()).expect("one joint");
        let raw = &joint.data.as_ref().raw;
        assert_eq!(
            (raw.coupled_axes, raw.locked_axes),
            (coupled, locked),
            "{name}"
        );
        assert_eq!([raw.limits[0].min, raw.limits[0].max], wanted, "{name}");
    }
}

#[test]
fn of_two_cones_about_different_axes_the_first_holds_and_nothing_panics() {
    let (_folder, mut stage, root) = hanging(
        "cones",
        json!([
            { "linearAxes": [0, 1, 2], "max": 0 },
            { "angularAxes": [0, 1], "max": 0.3 },
            { "angularAxes": [1, 2], "max": 0.1 },
        ]),
    );
    let body = stage.node(root, "Body");
    let mut spin = *stage.get::<Velocity>(body);
    spin.angular = Vec3::X * 5.0;
    stage.app.world_mut().entity_mut(body).insert(spin);
    let mut most = 0.0_f32;
    for _ in 0..120 {
        run(&mut stage.app, DT);
        let axis = stage.place(body).rotation * Vec3::Z;
        most = most.max(axis.angle_between(Vec3::Z));
    }
    assert!((0.2..0.6).contains(&most), "{most} rad");
}
