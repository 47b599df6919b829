//! Scenes that run for days: a standing car, a hanging cloth, a net of a thousand springs. Each is struck again and
//! again, comes nearly to rest in between, and keeps a balance of its energy.

mod car;
mod cloth;
mod net;
mod whole;

pub use car::car;
pub use cloth::cloth;
pub use net::net;

use crate::lab::DT;
use bevy::prelude::*;
use bevy::transform::StaticTransformOptimizations;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use std::collections::BTreeMap;
use whole::Moving;

/// Acceleration of gravity in the scenes that have it, m/s².
pub const GRAVITY: f32 = 9.81;

/// A scene that is struck at equal intervals.
pub struct Endurance {
    /// Name of the scene.
    pub title: &'static str,
    app: App,
    bodies: Vec<Entity>,
    /// Mass in kg and principal inertia in kg m² of each body.
    masses: Vec<(f32, Vec3)>,
    springs: Vec<Entity>,
    gravity: f32,
    /// Seconds from one strike to the next.
    pub period: f32,
    /// Strikes the scene. The number counts strikes.
    strike: fn(&mut Self, u64),
    /// Returns the error of the scene's pose against theory, and the greatest error allowed.
    stands: fn(&Self) -> (f64, f64),
    /// Number of strikes so far.
    pub strikes: u64,
    /// Greatest share of the energy turned over that may be missing. `None` where contacts dissipate energy as well.
    pub missing: Option<f64>,
    /// Greatest share of the energy turned over that may appear without a cause.
    pub surplus: f64,
    /// Greatest root mean square speed of the bodies just before the next strike, m/s, if strikes are no closer than the
    /// scene has them. Unlike the speed of the fastest body it is much the same after each of a thousand strikes.
    pub rests: f64,
    /// What was found wrong so far, in earlier runs too: the first fault of each kind.
    pub faults: BTreeMap<String, String>,
}

/// Results of the time from one strike to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Interval {
    /// Energy that the strike gave, or took if it is negative, J.
    pub work: f64,
    /// Energy that went into the interval and out of it again, J. Each joule counts once: it came from the strike or from
    /// what the scene had before, and it left as heat, to the strike, or is there afterwards in addition.
    pub turned_over: f64,
    /// Energy that went in and did not come out, beyond the rounding of readouts, J.
    pub missing: f64,
    /// Energy that came out and had not gone in, beyond the rounding of readouts, J.
    pub surplus: f64,
    /// Error of the pose just before the next strike, and the greatest error allowed.
    pub off: (f64, f64),
    /// Root mean square speed of the bodies just before the next strike, m/s, weighted by their masses. Spin counts too:
    /// it is the speed at which they have their kinetic energy without spin. The motion of a floating scene as one rigid
    /// body does not count: strikes leave it turning, and no spring notices. Infinite if one is not a number.
    pub speed: f64,
    /// Number of springs that the last step did not solve.
    pub idle: usize,
}

/// The state of a scene between two strikes, from which a later run can continue.
#[derive(Clone, serde::Serialize, serde::Deserialize)]
pub struct Saved {
    strikes: u64,
    engine: RapierSnapshot,
    springs: CoiloverSnapshot,
    /// What was found wrong before it was saved.
    pub faults: BTreeMap<String, String>,
}

/// An app with gravity in m/s².
fn lab(gravity: f32) -> App {
    let mut app = crate::lab::app(true);
    // As in the tests of physics: looking for what rests takes threads in every update.
    app.insert_resource(StaticTransformOptimizations::Disabled);
    let world = app.world_mut();
    for mut configuration in world.query::<&mut RapierConfiguration>().iter_mut(world) {
        configuration.gravity = Vec3::NEG_Y * gravity;
    }
    app
}

impl Endurance {
    /// Takes everything that a new scene of the same kind needs in order to continue this one bit for bit.
    pub fn save(&self) -> Saved {
        let world = self.app.world();
        Saved {
            strikes: self.strikes,
            engine: RapierSnapshot::take(world),
            springs: CoiloverSnapshot::take(world),
            faults: self.faults.clone(),
        }
    }

    /// Continues a scene of the same kind.
    pub fn resume(&mut self, saved: &Saved) -> Result<(), SnapshotError> {
        // So that all bodies have their handles in Rapier.
        self.app.update();
        let world = self.app.world_mut();
        saved.engine.restore(world)?;
        saved.springs.restore(world)?;
        self.strikes = saved.strikes;
        self.faults.clone_from(&saved.faults);
        Ok(())
    }

    /// Whether bodies and readouts of a scene of the same kind are the same.
    pub fn is_like(&self, other: &Self) -> bool {
        let places = |scene: &Self| scene.read::<Transform, _>(&scene.bodies, |at| *at);
        let motions =
            |scene: &Self| scene.read::<Velocity, _>(&scene.bodies, |v| (v.linear, v.angular));
        let readouts = |scene: &Self| scene.read::<SpringReadout, _>(&scene.springs, |read| *read);
        places(self) == places(other)
            && motions(self) == motions(other)
            && readouts(self) == readouts(other)
    }

    /// Strikes the scene and runs until the next strike.
    pub fn interval(&mut self) -> Interval {
        let before = self.energy();
        (self.strike)(self, self.strikes);
        self.strikes += 1;
        // A strike only changes velocities, so the energy rises by its work.
        let work = self.energy() - before;
        let warm = self.heat();
        for _ in 0..(self.period / DT).round() as usize {
            self.app.update();
        }
        let after = self.energy();
        let heat = self.heat() - warm;
        // Readouts are in f32. After a day their rounding exceeds the energy of a weak blow.
        let rounding = f64::from(f32::EPSILON) * warm;
        // Not by `max`, which would ignore NaN.
        let beyond = |error: f64| {
            if error < rounding {
                0.0
            } else {
                error - rounding
            }
        };
        let idle = |read: &SpringReadout| read.method == SpringMethod::None;
        Interval {
            work,
            turned_over: work.max(0.0) + (before - after).max(0.0),
            missing: beyond(before + work - after - heat),
            surplus: beyond(after + heat - before - work),
            off: (self.stands)(self),
            speed: self.speed(),
            idle: self
                .read::<SpringReadout, _>(&self.springs, idle)
                .into_iter()
                .filter(|idle| *idle != Some(false))
                .count(),
        }
    }

    /// Reads a component of each entity. `None` where it is missing.
    fn read<T: Component, V>(&self, of: &[Entity], read: impl Fn(&T) -> V) -> Vec<Option<V>> {
        let world = self.app.world();
        let each = of.iter().map(|entity| world.get::<T>(*entity).map(&read));
        each.collect()
    }

    /// Sum of a number of all readouts. NaN if one is missing, so that it is noticed.
    fn sum(&self, number: impl Fn(&SpringReadout) -> f32) -> f64 {
        let each = self
            .read::<SpringReadout, _>(&self.springs, number)
            .into_iter();
        each.map(|number| number.map_or(f64::NAN, f64::from)).sum()
    }

    /// Where a body is and how it moves. `None` if a component of it is missing.
    fn motion(&self, index: usize) -> Option<(&Transform, &Velocity)> {
        let (world, body) = (self.app.world(), self.bodies[index]);
        world.get(body).zip(world.get(body))
    }

    /// Kinetic energy of a body, J. NaN if a component of it is missing.
    fn kinetic(&self, index: usize) -> f64 {
        let (mass, inertia) = self.masses[index];
        self.motion(index).map_or(f64::NAN, |(at, v)| {
            let spin = at.rotation.inverse() * v.angular;
            0.5 * f64::from(mass * v.linear.length_squared() + (inertia * spin).dot(spin))
        })
    }

    /// Kinetic energy, energy of height and energy stored in springs, J.
    fn energy(&self) -> f64 {
        let each = (0..self.bodies.len()).map(|index| {
            let weight = f64::from(self.masses[index].0 * self.gravity);
            let height = f64::from(self.place(self.bodies[index]).y);
            self.kinetic(index) + weight * height
        });
        each.sum::<f64>() + self.sum(|read| read.stored_energy)
    }

    /// Energy that all dampers have dissipated so far, J.
    fn heat(&self) -> f64 {
        self.sum(|read| read.dissipated_energy)
    }

    /// See [`Interval::speed`].
    fn speed(&self) -> f64 {
        let indices = 0..self.bodies.len();
        let mut kinetic: f64 = indices.map(|index| self.kinetic(index)).sum();
        if self.gravity == 0.0 {
            kinetic -= self.rigid_energy();
        }
        let mass: f64 = self.masses.iter().map(|(mass, _)| f64::from(*mass)).sum();
        let speed = (2.0 * kinetic / mass).sqrt();
        // Infinity instead of NaN, which no comparison would notice.
        if speed.is_finite() {
            speed
        } else {
            f64::INFINITY
        }
    }

    /// Kinetic energy of the motion as one rigid body, J. NaN if a component is missing.
    fn rigid_energy(&self) -> f64 {
        let moving = |index: usize| {
            let (mass, inertia) = self.masses[index];
            let (at, v) = self.motion(index)?;
            let spin = inertia * (at.rotation.inverse() * v.angular);
            Some(Moving {
                mass: mass.into(),
                at: at.translation.as_dvec3(),
                velocity: v.linear.as_dvec3(),
                spin: (at.rotation * spin).as_dvec3(),
            })
        };
        let bodies: Option<Vec<_>> = (0..self.bodies.len()).map(moving).collect();
        bodies.map_or(f64::NAN, |bodies| whole::rigid_energy(&bodies))
    }

    fn place(&self, body: Entity) -> Vec3 {
        self.app
            .world()
            .get::<Transform>(body)
            .map_or(Vec3::NAN, |at| at.translation)
    }

    /// Adds to the velocity of a body.
    fn push(&mut self, body: Entity, by: Vec3) {
        if let Some(mut velocity) = self.app.world_mut().get_mut::<Velocity>(body) {
            velocity.linear += by;
        }
    }
}

/// A body of a mass in kg and a principal inertia in kg m².
fn body(at: Vec3, (mass, principal_inertia): (f32, Vec3)) -> impl Bundle {
    let properties = MassProperties {
        mass,
        principal_inertia,
        ..default()
    };
    (
        RigidBody::Dynamic,
        Transform::from_translation(at),
        AdditionalMassProperties::MassProperties(properties),
        Velocity::default(),
    )
}

/// A pseudo-random vector, always the same for the same numbers.
fn direction(strike: u64, body: u64) -> Vec3 {
    let mut x =
        strike.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ body.wrapping_mul(0xD1B5_4A32_D192_ED03);
    let mut next = || {
        x ^= x >> 29;
        x = x
            .wrapping_mul(0xBF58_476D_1CE4_E5B9)
            .wrapping_add(0x94D0_49BB_1331_11EB);
        (x >> 40) as f32 / (1_u64 << 23) as f32 - 1.0
    };
    Vec3::new(next(), next(), next())
}
