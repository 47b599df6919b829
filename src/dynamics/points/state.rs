//! The points of a network. Each quantity has a list of its own, so that a pass over all points reads only what it needs.

use crate::dynamics::body::Body;
use crate::threads::copy;
use bevy::math::DVec3;

/// The centres of mass of all bodies, and after them the ends with prescribed motion.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct State {
    /// Number of points that are bodies.
    pub bodies: usize,
    pub positions: Vec<DVec3>,
    pub velocities: Vec<DVec3>,
    /// Acceleration of each body from everything but elements, m/s².
    pub accelerations: Vec<DVec3>,
    /// Inverse mass of each body, 1/kg; above zero.
    pub inverse_masses: Vec<f64>,
    /// Impulse from elements on each body so far in this step, N s.
    pub given: Vec<DVec3>,
}

impl State {
    /// Loads the bodies, and removes all other points. Makes room for `led` ends with prescribed motion.
    pub(super) fn load(&mut self, bodies: &[Body], led: usize) {
        fn set<T>(list: &mut Vec<T>, room: usize, bodies: &[Body], of: impl Fn(&Body) -> T) {
            list.clear();
            list.reserve_exact(room);
            list.extend(bodies.iter().map(of));
        }
        self.bodies = bodies.len();
        let (own, all) = (bodies.len(), bodies.len() + led);
        set(&mut self.positions, all, bodies, |body| body.position);
        set(&mut self.velocities, all, bodies, |body| body.velocity);
        set(&mut self.accelerations, own, bodies, |body| {
            body.acceleration
        });
        set(&mut self.inverse_masses, own, bodies, |body| {
            body.inverse_mass.x
        });
        set(&mut self.given, own, bodies, |body| body.given.0);
    }

    /// Adds an end with prescribed motion, and returns its index.
    pub(super) fn push(&mut self, position: DVec3, velocity: DVec3) -> u32 {
        self.positions.push(position);
        self.velocities.push(velocity);
        self.positions.len() as u32 - 1
    }

    /// Copies what steps change.
    pub(super) fn copy_from(&mut self, other: &Self) {
        self.bodies = other.bodies;
        copy(&mut self.positions, &other.positions);
        copy(&mut self.velocities, &other.velocities);
        copy(&mut self.given, &other.given);
    }

    /// Number of points.
    pub(super) fn len(&self) -> usize {
        self.positions.len()
    }

    /// Acceleration of a point from everything but elements, m/s²; zero for an end with prescribed motion.
    #[inline(always)]
    pub(super) fn acceleration(&self, point: u32) -> DVec3 {
        let known = self.accelerations.get(point as usize);
        known.copied().unwrap_or(DVec3::ZERO)
    }

    /// Inverse mass of a point, 1/kg; zero for an end with prescribed motion.
    #[inline(always)]
    pub(super) fn inverse_mass(&self, point: u32) -> f64 {
        let known = self.inverse_masses.get(point as usize);
        known.copied().unwrap_or(0.0)
    }

    /// Whether a point is an end with prescribed motion.
    #[inline(always)]
    pub(super) fn is_led(&self, point: u32) -> bool {
        point as usize >= self.bodies
    }

    /// Velocity of an end with prescribed motion (m/s); none for a body.
    #[inline(always)]
    pub(super) fn led(&self, point: u32) -> Option<DVec3> {
        self.is_led(point).then(|| self.velocities[point as usize])
    }
}
