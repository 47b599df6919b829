//! What happened, tick by tick.

use super::car::{Chassis, ends};
use super::driver::{Leg, Pedals, Script};
use super::tyre::{Tyre, place};
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;

/// One tick.
pub struct Sample {
    pub leg: Leg,
    /// Since the leg began, s.
    pub time: f32,
    pub at: Vec3,
    pub velocity: Vec3,
    /// Of the nose upwards, and of the right side downwards, rad.
    pub pitch: f32,
    pub roll: f32,
    /// Of the car's up against the world's, rad.
    pub lean: f32,
    /// Of the coilovers, m, and what the tyres carry, N: front left, front right, rear left, rear right.
    pub lengths: [f32; 4],
    pub loads: [f32; 4],
    /// Of the hubs, m.
    pub hubs: [Vec3; 4],
}

#[derive(Resource, Default)]
pub struct Log {
    pub samples: Vec<Sample>,
    /// Someone has driven it, so nothing is as the script would have it.
    pub by_hand: bool,
}

impl Log {
    pub fn of(&self, leg: Leg) -> impl Iterator<Item = &Sample> {
        self.samples.iter().filter(move |sample| sample.leg == leg)
    }
}

pub fn write(
    script: Res<Script>,
    pedals: Res<Pedals>,
    mut log: ResMut<Log>,
    cars: Query<(&Transform, &Velocity), With<Chassis>>,
    tyres: Query<(&Transform, &Tyre)>,
) {
    log.by_hand |= pedals.by_hand;
    let Ok((at, velocity)) = cars.single() else {
        return;
    };
    if log.by_hand {
        return;
    }
    let mut sample = Sample {
        leg: script.leg,
        time: script.time,
        at: at.translation,
        velocity: velocity.linear,
        pitch: (at.rotation * Vec3::X).y.asin(),
        roll: -(at.rotation * Vec3::Z).y.asin(),
        lean: (at.rotation * Vec3::Y).angle_between(Vec3::Y),
        lengths: [0.0; 4],
        loads: [0.0; 4],
        hubs: [Vec3::ZERO; 4],
    };
    for (hub, tyre) in &tyres {
        let place = place(tyre.corner);
        let [a, b] = ends(tyre.corner);
        sample.lengths[place] = at.transform_point(a).distance(hub.transform_point(b));
        sample.loads[place] = tyre.load;
        sample.hubs[place] = hub.translation;
    }
    log.samples.push(sample);
}
