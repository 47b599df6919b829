//! What joints and contacts leave of the mass at an element's ends, read from the engine.

use super::joint::is_ours;
use crate::backend::Wrench;
use crate::backend::rapier::body::{Bodies, is_movable, read};
use crate::compat;
use crate::dynamics::body::Body;
use crate::dynamics::line::Line;
use crate::dynamics::linkage::{Constraint, Linkage};
use bevy::math::{DQuat, DVec3, Vec3};
use bevy_rapier3d::prelude::RapierContextJoints;
use bevy_rapier3d::rapier::dynamics::{GenericJoint, JointAxesMask, RigidBodyHandle, RigidBodySet};
use bevy_rapier3d::rapier::geometry::{ColliderSet, ContactPair, NarrowPhase};

/// Most bodies that are looked at together; what is further away counts as fixed. A car's chassis and its wheels with
/// their hubs and arms are no more.
const MOST: usize = 16;

/// Contact points of a pair that count: no more than three hold a body.
const POINTS: usize = 3;

/// A Rapier context, as far as it holds bodies.
#[derive(Clone, Copy)]
pub(crate) struct Holding<'a> {
    /// Contacts count too.
    pub contacts: bool,
    pub bodies: &'a RigidBodySet,
    pub joints: &'a RapierContextJoints,
    pub colliders: &'a ColliderSet,
    pub narrow: &'a NarrowPhase,
    /// m/s².
    pub gravity: Vec3,
}

impl<'a> Holding<'a> {
    /// Its bodies as all else sees them.
    pub(crate) fn sight(&self) -> Bodies<&'a RigidBodySet> {
        Bodies {
            set: self.bodies,
            gravity: self.gravity,
        }
    }
}

/// What a joint locks between two bodies, where it is, in its first frame's axes.
pub(crate) fn locks(
    joint: &GenericJoint,
    rotation: DQuat,
    at: DVec3,
    on: [Option<(usize, &Body)>; 2],
) -> impl Iterator<Item = Constraint> {
    let masks = [
        [JointAxesMask::LIN_X, JointAxesMask::ANG_X],
        [JointAxesMask::LIN_Y, JointAxesMask::ANG_Y],
        [JointAxesMask::LIN_Z, JointAxesMask::ANG_Z],
    ];
    let turning = on.map(|body| body.map(|(index, _)| index));
    let both = DVec3::AXES.into_iter().zip(masks);
    both.flat_map(move |(axis, [linear, angular])| {
        let axis = rotation * axis;
        let locked = |mask| joint.locked_axes.contains(mask);
        let along = locked(linear).then(|| Constraint::along(axis, at, on));
        let about = locked(angular).then(|| Constraint::about(axis, turning));
        along.into_iter().chain(about)
    })
}

/// Bodies that hang together, as they are found.
struct Found<'a> {
    all: Holding<'a>,
    handles: Vec<RigidBodyHandle>,
    linkage: Linkage,
}

impl Found<'_> {
    /// Index of a body that can be moved and is near enough.
    fn index(&mut self, handle: RigidBodyHandle) -> Option<usize> {
        if let Some(known) = self.handles.iter().position(|h| *h == handle) {
            return Some(known);
        }
        let body = self.all.bodies.get(handle).filter(|b| is_movable(b))?;
        if self.handles.len() >= MOST {
            return None;
        }
        self.handles.push(handle);
        let body = read(body, Vec3::ZERO, &Wrench::default(), true);
        self.linkage.bodies.push(body);
        Some(self.handles.len() - 1)
    }

    fn along(&mut self, axis: DVec3, at: DVec3, on: [Option<usize>; 2]) {
        let bodies: [Option<(usize, &Body)>; 2] =
            on.map(|index| index.map(|index| (index, &self.linkage.bodies[index])));
        let constraint = Constraint::along(axis, at, bodies);
        self.linkage.constraints.push(constraint);
    }

    fn joint(&mut self, joint: &GenericJoint, between: [RigidBodyHandle; 2]) {
        let [Some(first), Some(second)] = between.map(|handle| self.all.bodies.get(handle)) else {
            return;
        };
        let frame = *first.position() * joint.local_frame1;
        let at = (*second.position() * joint.local_frame2)
            .translation
            .as_dvec3();
        let on = between.map(|handle| self.index(handle));
        let rotation = frame.rotation.as_dquat().normalize();
        let linkage = &mut self.linkage;
        let on = on.map(|index| index.map(|index| (index, &linkage.bodies[index])));
        linkage.constraints.extend(locks(joint, rotation, at, on));
    }

    /// What presses on each other neither parts nor slides.
    fn contact(&mut self, pair: &ContactPair) {
        let all = self.all;
        let Some(first) = all.colliders.get(pair.collider1) else {
            return;
        };
        let second = all.colliders.get(pair.collider2);
        let on = [Some(first), second].map(|c| self.index(c?.parent()?));
        for manifold in compat::manifolds(pair) {
            let normal = manifold.data.normal.as_dvec3();
            let (across, along) = normal.any_orthonormal_pair();
            let place = match manifold.subshape_pos1() {
                Some(sub) => *first.position() * sub,
                None => *first.position(),
            };
            let pushing = manifold.points.iter().filter(|p| p.data.impulse > 0.0);
            for point in pushing.take(POINTS) {
                let at = (place * point.local_p1).as_dvec3();
                self.along(normal, at, on);
                if manifold.data.friction > 0.0 {
                    self.along(across, at, on);
                    self.along(along, at, on);
                }
            }
        }
    }

    /// Takes in all that holds a body, but for bodies that are known already.
    fn around(&mut self, index: usize) {
        let (all, handle) = (self.all, self.handles[index]);
        let before = |found: &Self, other: RigidBodyHandle| {
            let known = found.handles.iter().position(|h| *h == other);
            known.is_some_and(|known| known < index)
        };
        let joints = all.joints.impulse_joints.attached_enabled_joints(handle);
        for (a, b, _, joint) in joints.filter(|(_, _, _, joint)| !is_ours(joint)) {
            let other = if a == handle { b } else { a };
            if !before(self, other) {
                self.joint(&joint.data, [a, b]);
            }
        }
        let sets = &all.joints.multibody_joints;
        for (a, b, joint) in sets.attached_joints(handle) {
            let other = if a == handle { b } else { a };
            if !before(self, other)
                && let Some((multibody, link)) = sets.get(joint)
                && let Some(link) = multibody.link(link)
            {
                self.joint(&link.joint.data, [a, b]);
            }
        }
        let Some(body) = all.bodies.get(handle).filter(|_| all.contacts) else {
            return;
        };
        for collider in body.colliders() {
            for pair in all.narrow.contact_pairs_with(*collider) {
                let parent = |c| all.colliders.get(c).and_then(|c| c.parent());
                let [a, b] = [pair.collider1, pair.collider2].map(parent);
                let other = if a == Some(handle) { b } else { a };
                if pair.total_impulse() != Vec3::ZERO
                    && other.is_none_or(|other| !before(self, other))
                {
                    self.contact(pair);
                }
            }
        }
    }
}

/// Inverse mass of an element along its line, with all that holds its ends, 1/kg. `on` are the bodies that the line
/// names.
pub(crate) fn inverse_mass(
    line: &Line,
    on: impl Fn(usize) -> RigidBodyHandle,
    all: Holding,
) -> f64 {
    let mut found = Found {
        all,
        handles: Vec::new(),
        linkage: Linkage::default(),
    };
    let mut line = *line;
    for hold in &mut line.holds {
        hold.body = hold.body.and_then(|body| found.index(on(body)));
    }
    let mut next = 0;
    while next < found.handles.len() {
        found.around(next);
        next += 1;
    }
    found.linkage.inverse_mass(&line)
}
