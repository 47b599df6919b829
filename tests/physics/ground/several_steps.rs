//! Held elements whose ends move while the engine takes several steps in a tick.

use super::stand::*;
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;

#[test]
fn an_end_without_a_body_moves_evenly_through_all_engine_steps() {
    for substeps in [1, 2, 4] {
        let engine = Engine {
            substeps,
            ..Engine::weightless()
        };
        let mut scene = Stand::new(CoiloverPlugin::default(), engine);
        let (hook, body) = (scene.lab.point(Vec3::Y), scene.guided(Vec3::NEG_Y, 1.0));
        scene.coil([hook, body], [Vec3::ZERO; 2], [2e4, 60.0], Some(2.0));
        let speed = 2.0_f32;
        let mut worst = 0.0_f32;
        let mut last = 0.0;
        for tick in 0..240 {
            let by = speed * DT;
            scene.lab.get_mut::<Transform>(hook).translation.y += by;
            scene.lab.tick();
            let now = scene.lab.position(body).y;
            if tick >= 120 {
                let mean = (now - last) / DT;
                let off = scene.lab.velocity(body).y - mean;
                worst = worst.max(off.abs()).max((mean - speed).abs());
            }
            last = now;
        }
        println!("{substeps} engine steps: worst speed off by {worst:.4} m/s of {speed}");
        assert!(worst < 0.02, "{substeps}: {worst}");
    }
}
