//! Scene: a ragdoll of jointed capsules with springs as muscles, which falls onto the ground.

use super::{GREATEST, Head, Scene, Unit};
use crate::ground::stage::{Freedom, Part, Shape, Stage};
use bevy::math::{Quat, Vec3};

const STIFFNESS: f32 = 30e3;

pub const SCENE: Scene = Scene {
    name: "ragdoll",
    title: "Ragdoll",
    note: "Ten capsules of 1.5 to 30 kg hang together by spherical joints and fall from 2 m onto a plane. \
           Beside every joint is a muscle, a spring of 30 kN/m. \
           The figures are the greatest energy over 20 s, divided by that at first, and the fastest speed of any part on the way. \
           Free fall from there ends at 6 m/s, and a limb that whips round is faster.",
    speeds: &[0.0],
    heads: &[
        GREATEST,
        Head {
            name: "fastest speed",
            unit: Unit::MetrePerSecond,
        },
    ],
    make: |_| ragdoll(),
    figures: |run| {
        let [most, fastest] = run.most(20.0);
        vec![most / run.first(), fastest]
    },
    quick: true,
};

fn ragdoll() -> Stage {
    let mut stage = Stage::default();
    stage.part(Part::ground(0.8));
    let tilt = Quat::from_rotation_x(1.1) * Quat::from_rotation_z(0.3);
    let capsule = |at: Vec3, half: f32, radius: f32, mass: f32| {
        let shape = Some(Shape::Capsule(half, radius));
        let part = Part::new(mass, tilt * at + Vec3::Y * 2.0, shape);
        // Its parts collide with the ground, but not with each other.
        part.turned(tilt).grouped(2, 1)
    };
    let torso = stage.part(capsule(Vec3::ZERO, 0.2, 0.12, 30.0));
    // Index of the holder, centre relative to the torso's centre, half length, radius, mass, and height of the joint above the
    // part's own centre.
    let mut parts = vec![(torso, Vec3::ZERO)];
    for (holder, at, half, radius, mass, up) in [
        (0, Vec3::new(0.0, 0.50, 0.0), 0.05, 0.1, 5.0, -0.15),
        (0, Vec3::new(0.20, 0.05, 0.0), 0.10, 0.05, 2.5, 0.15),
        (2, Vec3::new(0.20, -0.25, 0.0), 0.10, 0.04, 1.5, 0.15),
        (0, Vec3::new(-0.20, 0.05, 0.0), 0.10, 0.05, 2.5, 0.15),
        (4, Vec3::new(-0.20, -0.25, 0.0), 0.10, 0.04, 1.5, 0.15),
        (0, Vec3::new(0.10, -0.55, 0.0), 0.15, 0.07, 8.0, 0.2),
        (6, Vec3::new(0.10, -0.95, 0.0), 0.15, 0.05, 4.0, 0.2),
        (0, Vec3::new(-0.10, -0.55, 0.0), 0.15, 0.07, 8.0, 0.2),
        (8, Vec3::new(-0.10, -0.95, 0.0), 0.15, 0.05, 4.0, 0.2),
    ] {
        let part = stage.part(capsule(at, half, radius, mass));
        let (holder, holder_at) = parts[holder];
        let here = Vec3::Y * up;
        let there = at + here - holder_at;
        stage.joint([holder, part], [there, here], Freedom::Spherical);
        let aside = Vec3::Z * radius;
        let anchors = [there + aside + 0.1 * Vec3::Y, here + aside - 0.1 * Vec3::Y];
        let law = [STIFFNESS, 0.1 * (STIFFNESS * mass).sqrt()];
        stage.coil([holder, part], anchors, law, None);
        parts.push((part, at));
    }
    stage
}
