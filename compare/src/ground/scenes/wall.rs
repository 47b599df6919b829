//! Scene: a box that a spring pulls against a wall.

use super::{Head, Scene, Unit};
use crate::ground::stage::{Motion, Part, Shape, Stage};
use bevy::math::Vec3;

const MASS: f32 = 5.0;
const STIFFNESS: f32 = 5e4;

pub const SCENE: Scene = Scene {
    name: "wall",
    title: "Box at a wall",
    note: "A box of 5 kg on the ground is pulled by a spring of 50 kN/m to a hand, a kinematic body inside a wall, which it \
           cannot reach. \
           The figure is how far the box goes from its place from the 5th to the 10th second: it should lie still.",
    speeds: &[0.0],
    heads: &[Head {
        name: "wobble",
        unit: Unit::Metre,
    }],
    make: |_| wall(),
    figures: |run| {
        run.seconds(5.0, |_| {});
        vec![run.wander(5.0)]
    },
    quick: true,
};

fn wall() -> Stage {
    let mut stage = Stage::default();
    stage.part(Part::ground(0.8));
    let wall = Some(Shape::Cuboid(Vec3::new(0.1, 1.0, 1.0)));
    stage.part(Part::held(Motion::Fixed, Vec3::new(1.0, 1.0, 0.0), wall));
    let shape = Some(Shape::Cuboid(Vec3::splat(0.25)));
    let held = stage.part(Part::new(MASS, Vec3::new(0.6, 0.25, 0.0), shape));
    let at = Vec3::new(1.0, 0.4, 0.0);
    let hand = stage.part(Part::held(Motion::Kinematic, at, None));
    let law = [STIFFNESS, 0.2 * (STIFFNESS * MASS).sqrt()];
    stage.coil([hand, held], [Vec3::ZERO; 2], law, Some(0.0));
    stage
}
