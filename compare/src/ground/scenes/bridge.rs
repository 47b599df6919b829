//! Scene: a bridge of hinged planks, held by springs at its ends.

use super::{GREATEST, Head, Scene, Unit};
use crate::ground::stage::{Freedom, Motion, Part, Shape, Stage};
use bevy::math::Vec3;

const PLANKS: usize = 30;
const MASS: f32 = 4.0;
const STIFFNESS: f32 = 5e5;
/// Positions of the boxes along the bridge (x), m.
const BOXES: [f32; 3] = [4.0, 7.0, 10.0];

pub const SCENE: Scene = Scene {
    name: "bridge",
    title: "Bridge of planks",
    note: "Thirty planks of 4 kg on revolute joints hang between two banks, on two springs of 500 kN/m at each end, and \
           three boxes of 100 kg fall on them. \
           The figures are the greatest energy over 20 s, divided by that at first with heights counted from 3 m \
           below the bridge, and how many boxes still lie on it then. \
           Where the joints themselves give way, by too few iterations, the bridge throws the boxes off.",
    speeds: &[0.0],
    heads: &[
        GREATEST,
        Head {
            name: "boxes on it after 20 s",
            unit: Unit::Count,
        },
    ],
    make: |_| bridge(),
    figures: |run| {
        let [most, _] = run.most(20.0);
        let on_it = |part: &usize| run.rig.state(*part).position.y > 0.0;
        let boxes = run.stage.parts.len() - BOXES.len()..run.stage.parts.len();
        vec![most / run.first(), boxes.filter(on_it).count() as f64]
    },
    quick: false,
};

fn bridge() -> Stage {
    let mut stage = Stage::default();
    let bank = Some(Shape::Cuboid(Vec3::new(0.2, 0.05, 0.5)));
    let mut hold = |x: f32| {
        let at = Vec3::new(x, 3.0, 0.0);
        stage.part(Part::held(Motion::Fixed, at, bank))
    };
    let (near, far) = (hold(-0.5), hold(PLANKS as f32 * 0.5));
    let plank = Some(Shape::Cuboid(Vec3::new(0.2, 0.03, 0.5)));
    let law = [STIFFNESS, 0.1 * (STIFFNESS * MASS).sqrt()];
    let mut last = near;
    for i in 0..=PLANKS {
        let next = if i < PLANKS {
            stage.part(Part::new(MASS, Vec3::new(0.5 * i as f32, 3.0, 0.0), plank))
        } else {
            far
        };
        if i > 0 && i < PLANKS {
            let anchors = [Vec3::X * 0.25, Vec3::NEG_X * 0.25];
            stage.joint([last, next], anchors, Freedom::Revolute);
        } else {
            for z in [-0.45, 0.45] {
                let anchors = [Vec3::new(0.2, 0.0, z), Vec3::new(-0.2, 0.0, z)];
                stage.coil([last, next], anchors, law, None);
            }
        }
        last = next;
    }
    for x in BOXES {
        let shape = Some(Shape::Cuboid(Vec3::splat(0.3)));
        stage.part(Part::new(100.0, Vec3::new(x, 3.6, 0.0), shape));
    }
    stage
}
