//! Springs along a world axis between two bodies that both turn. Their ends are far apart across the axis.

use super::stand::Stand;
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;

/// Mass of the load, kg.
const LOAD: f32 = 5.0;

/// Energy in the spring at first, J.
const STORED: f32 = 6.0;

/// A load beside a box of `lying` kg on the ground, and an undamped vertical spring between them that stores [`STORED`].
/// `arm` is the anchor on the load.
fn beside(lying: f32, stiffness: f32, across: f32, arm: Vec3) -> (Stand, [Entity; 2]) {
    let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
    scene.ground();
    let lying = scene.cube(Vec3::new(0.0, 0.25, 0.0), lying);
    let hung = scene.cube(Vec3::new(across, 2.0, 0.0), LOAD);
    let stretch = (2.0 * STORED / stiffness).sqrt();
    let spring = Spring::new(hung, lying)
        .with_stiffness(stiffness)
        .with_rest_length(1.75 + stretch + arm.y);
    let axis = SpringAxis::World(Vec3::NEG_Y);
    let element = scene
        .lab
        .spawn((spring, axis, Anchors::new(arm, Vec3::ZERO)));
    (scene, [hung, element])
}

#[test]
fn a_load_far_beside_its_spring_wins_nothing_at_any_stiffness() {
    for across in [0.6, -2.0] {
        for arm in [Vec3::X * 0.1, Vec3::NEG_X * 0.2, Vec3::Y * 0.1] {
            for omega_dt in [0.1_f32, 0.5, 1.0, 2.0, 5.0, 20.0] {
                let stiffness = LOAD * (60.0 * omega_dt).powi(2);
                let (mut scene, [hung, element]) = beside(LOAD, stiffness, across, arm);
                let energy = |scene: &Stand| {
                    scene.energy() + f64::from(scene.lab.readout(element).stored_energy)
                };
                scene.lab.tick();
                let first = energy(&scene);
                let (mut most, mut fastest) = (first, 0.0_f32);
                for _ in 0..scene.lab.ticks(5.0) {
                    scene.lab.tick();
                    most = most.max(energy(&scene));
                    fastest = fastest.max(scene.lab.velocity(hung).length());
                }
                let won = (most - first) / first;
                println!("{across} m, arm {arm}, ω·dt {omega_dt}: won {won:.1e}, {fastest:.2} m/s");
                assert!(won < 0.01, "{across}, {arm}, {omega_dt}: {won}");
            }
        }
    }
}

#[test]
fn a_load_far_beside_its_spring_keeps_time() {
    for omega_dt in [0.1_f32, 0.25, 0.5] {
        let omega = 60.0 * omega_dt;
        let stiffness = LOAD * omega * omega;
        let (mut scene, [hung, _]) = beside(4.0 * LOAD, stiffness, 0.6, Vec3::ZERO);
        let height = |scene: &Stand| scene.lab.position(hung).y;
        let start = height(&scene);
        // The load swings about its place of balance.
        let stretch = (2.0 * STORED / stiffness).sqrt();
        let middle = start + stretch - GRAVITY as f32 / (omega * omega);
        let amplitude = start - middle;
        let (mut off, mut before, mut count, mut last) = (0.0_f64, start, 0, 0.0);
        let mut extreme = 0.0_f32;
        for tick in 1..=scene.lab.ticks(5.0) {
            scene.lab.tick();
            let now = height(&scene);
            let crosses = (before - middle).signum() != (now - middle).signum();
            if crosses {
                let share = f64::from((middle - before) / (now - before));
                last = (tick as f64 - 1.0 + share) / 60.0;
                count += 1;
                let wanted = (f64::from(count) - 0.5) * std::f64::consts::PI / f64::from(omega);
                off = (last - wanted) / last;
            }
            if tick > scene.lab.ticks(4.5) {
                extreme = extreme.max((now - middle).abs());
            }
            before = now;
        }
        let left = extreme / amplitude.abs();
        println!("ω·dt {omega_dt}: after {last:.2} s late by {off:.1e}, amplitude × {left:.3}");
        // Bounds of the midpoint rule, whose substeps damp with a damping ratio of ω·dt/64.
        let latest = f64::from(omega_dt).powi(2) / 12.0 + 1e-3;
        let least = (-5.0 * omega * omega_dt / 50.0).exp();
        assert!(off > -1e-3 && off < latest, "ω·dt {omega_dt}: {off}");
        assert!(left > least && left < 1.02, "ω·dt {omega_dt}: {left}");
    }
}
