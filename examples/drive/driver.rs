//! The script that drives while nobody else does: it goes through the legs of the course and holds line and speed.

use super::car::{Chassis, HALF_BASE};
use super::course;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::DT;
use std::f32::consts::TAU;

/// Input for engine, brakes and front wheels.
#[derive(Resource, Default)]
pub struct Pedals {
    /// Throttle, from -1 (backwards) to 1.
    pub throttle: f32,
    /// Brake pedal, from 0 to 1.
    pub brake: f32,
    /// Steering angle of the front wheels, positive to the left, rad.
    pub steer: f32,
    /// Whether a player drives instead of the script.
    pub by_hand: bool,
}

/// A part of the course, in driving order.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash)]
pub enum Leg {
    Stand,
    SlowWash,
    Waves,
    Kerbs,
    FastWash,
    Brake,
    Corner,
    Jump,
    Climb,
    Slope,
}

/// Target speed on the slow washboard, m/s.
pub const SLOW: f32 = 5.0;
/// Target speed on the fast washboard, m/s.
pub const FAST: f32 = 30.0;
/// Target speed in the corner, m/s.
pub const CORNER_SPEED: f32 = 10.0;
/// Target speed at the jump, m/s.
const JUMP_SPEED: f32 = 16.0;
/// Radius of the circle in the corner, m.
pub const CIRCLE: f32 = 25.0;
/// Brake pedal position in [`Leg::Brake`], from 0 to 1.
const BRAKE: f32 = 0.42;
/// Speed at which [`Leg::Brake`] ends, m/s.
const BRAKED: f32 = 10.0;
/// Distance driven along x on the slope before the car stops, m.
const CLIMB: f32 = 12.0;
/// Throttle for each m/s below the target speed, s/m.
const PEDAL: f32 = 0.5;

#[derive(Resource)]
pub struct Script {
    pub leg: Leg,
    /// Time since the leg began, s.
    pub time: f32,
    /// Angle the car has turned in this leg, positive to the left, rad.
    turned: f32,
}

impl Default for Script {
    fn default() -> Self {
        Self {
            leg: Leg::Stand,
            time: 0.0,
            turned: 0.0,
        }
    }
}

impl Leg {
    /// Returns the next leg once this one is over.
    fn next(self, script: &Script, x: f32, speed: f32) -> Self {
        let over = |over, next| if over { next } else { self };
        match self {
            Leg::Stand => over(script.time >= 3.0, Leg::SlowWash),
            Leg::SlowWash => over(x > course::SLOW_WASH + 42.0, Leg::Waves),
            Leg::Waves => over(x > course::WAVES + 48.0, Leg::Kerbs),
            Leg::Kerbs => over(x > course::KERBS + 32.0, Leg::FastWash),
            Leg::FastWash => over(x > course::FAST_WASH + 60.0, Leg::Brake),
            Leg::Brake => over(speed < BRAKED, Leg::Corner),
            Leg::Corner => over(script.turned >= TAU, Leg::Jump),
            Leg::Jump => over(x > course::JUMP + 60.0, Leg::Climb),
            Leg::Climb => over(x > course::SLOPE + CLIMB, Leg::Slope),
            Leg::Slope => Leg::Slope,
        }
    }

    /// Target speed, m/s.
    fn speed(self) -> f32 {
        match self {
            Leg::Stand | Leg::Brake | Leg::Slope => 0.0,
            Leg::SlowWash => SLOW,
            Leg::Waves => 12.0,
            Leg::Kerbs => 12.0,
            Leg::FastWash => FAST,
            Leg::Corner => CORNER_SPEED,
            Leg::Jump => JUMP_SPEED,
            Leg::Climb => 8.0,
        }
    }
}

pub fn read_script(
    mut script: ResMut<Script>,
    mut pedals: ResMut<Pedals>,
    cars: Query<(&Transform, &Velocity), With<Chassis>>,
) {
    let Ok((at, velocity)) = cars.single() else {
        return;
    };
    if pedals.by_hand {
        return;
    }
    let forward = at.rotation * Vec3::X;
    let speed = velocity.linear.dot(forward);
    script.time += DT;
    script.turned += velocity.angular.y * DT;
    let next = script.leg.next(&script, at.translation.x, speed);
    if next != script.leg {
        *script = Script {
            leg: next,
            ..default()
        };
    }
    let missing = script.leg.speed() - speed;
    pedals.throttle = (PEDAL * missing).clamp(0.0, 1.0);
    pedals.brake = (-0.2 * missing - 0.1).clamp(0.0, 0.5);
    if script.leg == Leg::Brake {
        (pedals.throttle, pedals.brake) = (0.0, BRAKE);
    }
    if matches!(script.leg, Leg::Stand | Leg::Slope) {
        (pedals.throttle, pedals.brake) = (0.0, 1.0);
    }
    // Positive angles turn to the left, towards -z.
    let heading = (-forward.z).atan2(forward.x);
    pedals.steer = if script.leg == Leg::Corner {
        2.0 * HALF_BASE / CIRCLE
    } else {
        // Steer towards the middle of the road, at the distance driven in one second.
        let ahead = speed.max(6.0);
        let aim = (at.translation.z / ahead).atan();
        (2.0 * HALF_BASE / ahead * 2.0 * (aim - heading)).clamp(-0.4, 0.4)
    };
}
