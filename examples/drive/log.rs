//! Records the state of the car in every tick.

use super::car::{Chassis, ends};
use super::driver::{Leg, Pedals, Script};
use super::tyre::{Tyre, place};
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;

/// State in one tick.
pub struct Sample {
    pub leg: Leg,
    /// Time since the leg began, s.
    pub time: f32,
    /// Position of the chassis, m.
    pub at: Vec3,
    /// Velocity of the chassis, m/s.
    pub velocity: Vec3,
    /// Pitch, positive with the nose up, rad.
    pub pitch: f32,
    /// Roll, positive with the right side down, rad.
    pub roll: f32,
    /// Angle between the car's up axis and the world's, rad.
    pub lean: f32,
    /// Lengths of the coilovers, m: front left, front right, rear left, rear right.
    pub lengths: [f32; 4],
    /// Loads of the tyres, N, in the order of `lengths`.
    pub loads: [f32; 4],
    /// Positions of the hubs, m, in the order of `lengths`.
    pub hubs: [Vec3; 4],
}

#[derive(Resource, Default)]
pub struct Log {
    pub samples: Vec<Sample>,
    /// Whether a player has driven the car: the measurements then do not follow the script.
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
