//! Measures a run: energy (computed from positions and velocities), spring length, speed, and distance moved.

use super::stage::{Motion, Stage};
use crate::rig::{Rig, State};
use crate::scenes::GRAVITY;
use bevy::math::{DVec3, Vec3};

/// Steps per second of every scene here.
pub const RATE: u32 = 60;

/// A running stage.
pub struct Run<'a> {
    pub stage: &'a Stage,
    pub rig: Rig,
}

impl Run<'_> {
    pub fn seconds(&mut self, seconds: f64, mut each: impl FnMut(&Self)) {
        for _ in 0..(seconds * f64::from(RATE)).round() as u64 {
            self.rig.tick();
            each(self);
        }
    }

    /// Initial energy, J.
    pub fn first(&self) -> f64 {
        energy(self.stage, |part| self.stage.start(part))
    }

    /// Greatest energy (J) and greatest speed of a body (m/s) during the next `seconds`.
    pub fn most(&mut self, seconds: f64) -> [f64; 2] {
        let (mut most, mut fastest) = (f64::NEG_INFINITY, 0.0);
        self.seconds(seconds, |run| {
            most = larger(most, energy(run.stage, |part| run.rig.state(part)));
            fastest = larger(fastest, run.speed());
        });
        [most, fastest]
    }

    fn moving(&self) -> impl Iterator<Item = usize> {
        let parts = self.stage.parts.iter().enumerate();
        let moving = parts.filter(|(_, part)| part.motion == Motion::Dynamic);
        moving.map(|(i, _)| i)
    }

    /// Greatest speed among the dynamic bodies, m/s.
    pub fn speed(&self) -> f64 {
        let speeds = self.moving().map(|i| self.rig.state(i).velocity.length());
        speeds.fold(0.0, larger)
    }

    /// Greatest distance of a dynamic body from its present position during the next `seconds`, m.
    pub fn wander(&mut self, seconds: f64) -> f64 {
        let start: Vec<(usize, DVec3)> = self
            .moving()
            .map(|i| (i, self.rig.state(i).position))
            .collect();
        let mut far = 0.0;
        self.seconds(seconds, |run| {
            for (part, from) in &start {
                far = larger(far, run.rig.state(*part).position.distance(*from));
            }
        });
        far
    }

    /// Mean length of the first spring during the next `seconds`, m.
    pub fn mean_length(&mut self, seconds: f64) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        self.seconds(seconds, |run| {
            for link in run.stage.links.iter().take(1) {
                sum += run.stage.length(link, |part| run.rig.state(part));
                count += 1.0;
            }
        });
        sum / count
    }
}

/// The larger number, or NaN if either is NaN.
fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() {
        f64::NAN
    } else {
        a.max(b)
    }
}

/// Kinetic energy, potential energy above y = 0 and energy stored in springs, J.
fn energy(stage: &Stage, state: impl Fn(usize) -> State) -> f64 {
    let mut sum = 0.0;
    for (i, part) in stage.parts.iter().enumerate() {
        if part.motion != Motion::Dynamic {
            continue;
        }
        let (s, mass) = (state(i), f64::from(part.mass));
        let spin = s.rotation.inverse() * s.spin;
        let inertia = if part.upright {
            Vec3::ZERO
        } else {
            part.inertia()
        };
        sum += 0.5 * (mass * s.velocity.length_squared() + (inertia.as_dvec3() * spin).dot(spin))
            + mass * f64::from(GRAVITY) * s.position.y;
    }
    for link in &stage.links {
        let stretch = stage.length(link, &state) - f64::from(link.rest);
        sum += 0.5 * f64::from(link.stiffness) * stretch * stretch;
    }
    sum
}
