//! Scene: a load on a rolling wheel.

use super::{Head, Scene, Unit};
use crate::ground::stage::{Freedom, Part, Shape, Stage};
use crate::scenes::GRAVITY;
use bevy::math::Vec3;

const RADIUS: f32 = 0.33;
const LOAD: f32 = 300.0;
const REST: f32 = 0.5;
const STIFFNESS: f32 = 30e3;

pub const SCENE: Scene = Scene {
    name: "rolling-wheel",
    title: "Rolling wheel",
    note: "A load of 300 kg that cannot turn stands on a spring of 30 kN/m and 2 kN s/m above a ball of 20 kg. \
           A joint keeps the ball below the load, and the ball rolls freely on a flat plane. \
           The figure is the mean compression of the spring from the 3rd to the 8th second, divided by load · g / k: 1 is \
           exact at every speed.",
    speeds: &[0.0, 3.0, 6.0, 12.0, 25.0],
    heads: &[Head {
        name: "sag over theory",
        unit: Unit::Ratio,
    }],
    make: wheel,
    figures: |run| {
        run.seconds(3.0, |_| {});
        let sag = f64::from(REST) - run.mean_length(5.0);
        vec![sag / f64::from(LOAD * GRAVITY / STIFFNESS)]
    },
    quick: true,
};

fn wheel(speed: f32) -> Stage {
    let mut stage = Stage::default();
    stage.part(Part::ground(1.0));
    let velocity = Vec3::X * speed;
    let load = stage.part(Part {
        velocity,
        planar: true,
        ..Part::new(LOAD, Vec3::Y * (RADIUS + REST), None).upright()
    });
    let wheel = stage.part(Part {
        velocity,
        spin: Vec3::NEG_Z * speed / RADIUS,
        friction: 1.0,
        ..Part::new(20.0, Vec3::Y * RADIUS, Some(Shape::Ball(RADIUS)))
    });
    stage.joint([load, wheel], [Vec3::ZERO; 2], Freedom::Guide);
    let law = [STIFFNESS, 2e3];
    stage.coil([load, wheel], [Vec3::ZERO; 2], law, Some(REST));
    stage
}
