//! Describes a scene with contacts and joints without reference to an engine: bodies with shapes, joints, springs.

use crate::problem::Link;
use bevy::math::{DVec3, Quat, Vec3};
use bevy::transform::components::Transform;
use std::f32::consts::PI;

/// A scene with contacts and joints.
#[derive(Default)]
pub struct Stage {
    pub parts: Vec<Part>,
    pub joints: Vec<Joint>,
    pub links: Vec<Link>,
}

/// How a body moves.
#[derive(Clone, Copy, PartialEq)]
pub enum Motion {
    Fixed,
    /// Moved by the game only. In these scenes it stays in place.
    Kinematic,
    Dynamic,
}

#[derive(Clone, Copy)]
pub enum Shape {
    /// All space below the plane y = 0.
    HalfSpace,
    /// Radius, m.
    Ball(f32),
    /// Half extents, m.
    Cuboid(Vec3),
    /// Capsule along y: half the distance between the centres of its caps, and its radius, m.
    Capsule(f32, f32),
}

/// A body.
#[derive(Clone, Copy)]
pub struct Part {
    pub motion: Motion,
    pub shape: Option<Shape>,
    pub mass: f32,
    pub at: Transform,
    pub velocity: Vec3,
    pub spin: Vec3,
    pub friction: f32,
    /// Whether its rotation is locked.
    pub upright: bool,
    /// Whether it stays in the plane z = 0.
    pub planar: bool,
    /// Collision groups that it is in, and groups that it collides with, as bit masks.
    pub groups: [u32; 2],
}

/// Motion that a joint leaves free.
#[derive(Clone, Copy)]
pub enum Freedom {
    /// Rotation about all axes.
    Spherical,
    /// Rotation about z.
    Revolute,
    /// Translation along y.
    Slider,
    /// Translation along y, and rotation about all axes.
    Guide,
}

#[derive(Clone, Copy)]
pub struct Joint {
    pub ends: [usize; 2],
    /// Anchors in the local frames of the two bodies, m.
    pub anchors: [Vec3; 2],
    pub freedom: Freedom,
}

impl Part {
    /// A dynamic body of a mass (kg).
    pub fn new(mass: f32, at: Vec3, shape: Option<Shape>) -> Self {
        Self {
            motion: Motion::Dynamic,
            shape,
            mass,
            at: Transform::from_translation(at),
            velocity: Vec3::ZERO,
            spin: Vec3::ZERO,
            friction: 0.5,
            upright: false,
            planar: false,
            groups: [u32::MAX; 2],
        }
    }

    /// A body that is not dynamic and stays in place.
    pub fn held(motion: Motion, at: Vec3, shape: Option<Shape>) -> Self {
        Self {
            motion,
            ..Self::new(0.0, at, shape)
        }
    }

    /// The ground plane y = 0.
    pub fn ground(friction: f32) -> Self {
        Self {
            friction,
            ..Self::held(Motion::Fixed, Vec3::ZERO, Some(Shape::HalfSpace))
        }
    }

    pub fn turned(mut self, rotation: Quat) -> Self {
        self.at.rotation = rotation;
        self
    }

    pub fn upright(mut self) -> Self {
        self.upright = true;
        self
    }

    pub fn grouped(mut self, member: u32, collides: u32) -> Self {
        self.groups = [member, collides];
        self
    }

    /// Principal moments of inertia in the body's frame, kg m².
    pub fn inertia(&self) -> Vec3 {
        match self.shape {
            None | Some(Shape::HalfSpace) => Vec3::splat(0.4 * self.mass),
            Some(Shape::Ball(r)) => Vec3::splat(0.4 * self.mass * r * r),
            Some(Shape::Cuboid(half)) => {
                let s = half * half;
                self.mass / 3.0 * Vec3::new(s.y + s.z, s.z + s.x, s.x + s.y)
            }
            Some(Shape::Capsule(half, r)) => capsule(self.mass, half, r),
        }
    }

    /// Inverse mass, 1/kg. 0 for a body that is not dynamic.
    pub fn inverse_mass(&self) -> f32 {
        if self.motion == Motion::Dynamic {
            self.mass.recip()
        } else {
            0.0
        }
    }
}

fn capsule(mass: f32, half: f32, r: f32) -> Vec3 {
    let volumes = [2.0 * half * PI * r * r, 4.0 / 3.0 * PI * r * r * r];
    let [tube, caps] = volumes.map(|v| mass * v / (volumes[0] + volumes[1]));
    let along = 0.5 * tube * r * r + 0.4 * caps * r * r;
    let across = tube * (half * half / 3.0 + 0.25 * r * r)
        + caps * (0.4 * r * r + half * half + 0.75 * half * r);
    Vec3::new(across, along, across)
}

impl Stage {
    /// Adds a body and returns its index.
    pub fn part(&mut self, part: Part) -> usize {
        self.parts.push(part);
        self.parts.len() - 1
    }

    pub fn joint(&mut self, ends: [usize; 2], anchors: [Vec3; 2], freedom: Freedom) {
        self.joints.push(Joint {
            ends,
            anchors,
            freedom,
        });
    }

    /// Adds a spring between two anchors, in the local frames of the bodies. The default rest length is the present distance.
    pub fn coil(
        &mut self,
        ends: [usize; 2],
        anchors: [Vec3; 2],
        [stiffness, damping]: [f32; 2],
        rest: Option<f32>,
    ) {
        let [a, b] = [0, 1].map(|i| self.parts[ends[i]].at.transform_point(anchors[i]));
        let rest = rest.unwrap_or(a.distance(b));
        let link = Link::new(ends[0], ends[1], stiffness, damping, rest);
        self.links.push(link.anchored(anchors));
    }

    /// Initial state of a body.
    pub fn start(&self, part: usize) -> crate::rig::State {
        let part = &self.parts[part];
        crate::rig::State {
            position: part.at.translation.as_dvec3(),
            rotation: part.at.rotation.as_dquat(),
            velocity: part.velocity.as_dvec3(),
            spin: part.spin.as_dvec3(),
        }
    }

    /// Length of a spring, with the bodies in the given states, m.
    pub fn length(&self, link: &Link, state: impl Fn(usize) -> crate::rig::State) -> f64 {
        let [a, b]: [DVec3; 2] = [0, 1].map(|end| {
            let s = state(link.ends[end]);
            s.position + s.rotation * link.anchors[end].as_dvec3()
        });
        a.distance(b)
    }
}

#[cfg(test)]
mod tests {
    use super::capsule;
    use bevy::math::Vec3;

    #[test]
    fn a_capsule_without_length_is_a_ball() {
        let off = capsule(2.0, 0.0, 0.5) - Vec3::splat(0.2);
        assert!(off.length() < 1e-6);
    }
}
