//! Scene: a heavy load on a stiff spring above a light foot, dropped onto a plane.

use super::{GREATEST, Head, Scene, Unit};
use crate::ground::figures::RATE;
use crate::ground::stage::{Freedom, Part, Shape, Stage};
use crate::scenes::GRAVITY;
use bevy::math::Vec3;

const FOOT: f32 = 10.0;
const LOAD: f32 = 300.0;
/// Phase ω·dt of load and foot in free flight, rad per step.
const PHASE: f32 = 3.0;
const ZETA: f32 = 0.3;
/// Rest length of the spring between load and foot, m.
const APART: f32 = 0.6;

pub const SCENE: Scene = Scene {
    name: "dropped-foot",
    title: "Dropped foot",
    note: "A load of 300 kg over a box of 10 kg, guided vertically, falls 0.5 m onto a plane. \
           The spring between them has ω·dt = 3 and ζ = 0.3 for the two in free flight. \
           The figures are the greatest energy over 10 s, divided by that at first, and the compression of the spring at \
           rest, divided by load · g / k. Energy is counted from that of the two standing without sag.",
    speeds: &[0.0],
    heads: &[
        GREATEST,
        Head {
            name: "sag at rest over theory",
            unit: Unit::Ratio,
        },
    ],
    make: |_| foot(),
    figures: |run| {
        let standing = f64::from((FOOT * 0.1 + LOAD * 0.7) * GRAVITY);
        let [most, _] = run.most(10.0);
        let sag = f64::from(APART) - run.mean_length(1.0);
        let stiffness = f64::from(law()[0]);
        vec![
            (most - standing) / (run.first() - standing),
            sag * stiffness / f64::from(LOAD * GRAVITY),
        ]
    },
    quick: true,
};

/// Stiffness (N/m) and damping (N s/m) of the spring.
fn law() -> [f32; 2] {
    let effective = FOOT * LOAD / (FOOT + LOAD);
    let omega = PHASE * RATE as f32;
    [effective * omega * omega, 2.0 * ZETA * effective * omega]
}

fn foot() -> Stage {
    let mut stage = Stage::default();
    stage.part(Part::ground(0.8));
    let above = stage.part(Part::new(LOAD, Vec3::Y * (0.6 + APART), None).upright());
    let shape = Shape::Cuboid(Vec3::splat(0.1));
    let below = stage.part(Part::new(FOOT, Vec3::Y * 0.6, Some(shape)).upright());
    stage.joint([above, below], [Vec3::ZERO; 2], Freedom::Slider);
    stage.coil([above, below], [Vec3::ZERO; 2], law(), Some(APART));
    stage
}
