//! Is a torsion element drawn as a spiral that winds up?

use crate::canvas::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use std::f32::consts::TAU;

const RADIUS: f32 = 0.8;
const TURNS: f32 = 3.0;

#[test]
fn a_spiral_is_as_large_as_it_says_and_has_a_turn_more_where_it_is_wound_by_one() {
    let mut seen = Vec::new();
    for full in [0.0, 1.0] {
        let Some(picture) = draw(|world| {
            let (a, b) = ends(world, Vec3::ZERO, Vec3::ZERO);
            world.spawn((
                TorsionSpring::new(a, b, Vec3::Z).with_rest_angle(0.0),
                // The physics plugin would write this angle for a body that has turned so often.
                SpringReadout {
                    length: full * TAU,
                    ..default()
                },
                TorsionCoil::new(RADIUS, TURNS).with_color(Color::srgb(1.0, 0.0, 0.0)),
            ));
        }) else {
            return;
        };
        let strip = extent(&picture, |pixel, _| is_red(pixel));
        for (side, wanted) in [(strip.high.x, RADIUS), (-strip.low.x, RADIUS)] {
            // The outermost turn ends anywhere within a turn, so a side may be smaller by up to one pitch.
            let pitch = RADIUS / (TURNS + full);
            assert!(side < wanted + 0.03 && side > wanted - pitch, "{side}");
        }
        // A vertical line through the axis crosses each turn once above and once below the axis.
        seen.push(runs(&picture, 0.0, is_red).len());
    }
    println!("crossings of the strip: {seen:?}");
    assert_eq!(seen[1], seen[0] + 2, "{seen:?}");
    assert!((5..=7).contains(&seen[0]), "{seen:?}");
}
