//! Computes the inverse mass that joints and contacts leave at an element's ends, from Rapier's joints and contacts.

use super::joint::is_ours;
use crate::backend::rapier::body::{Bodies, handle, is_movable, read};
use crate::backend::{BodyId, Wrench};
use crate::dynamics::body::Body;
use crate::dynamics::line::Line;
use crate::dynamics::linkage::{Constraint, Linkage};
use bevy::math::{DQuat, DVec3, Vec3};
use bevy_rapier3d::prelude::RapierContextJoints;
use bevy_rapier3d::rapier::dynamics::{GenericJoint, JointAxesMask, RigidBodyHandle, RigidBodySet};
use bevy_rapier3d::rapier::geometry::{ColliderSet, ContactPair, NarrowPhase};

/// Greatest number of linked bodies that are considered; bodies beyond them count as fixed. It is enough for the chassis of a
/// car with wheels, hubs and suspension arms; more only cost time. Pinned by `joints::a_spring_feels_all_bodies_of_a_car`.
const MOST: usize = 16;

/// Greatest number of contact points that are considered per contact manifold. Three points already fix a body to a plane.
/// Pinned by `surfaces::a_crate_that_lies_on_the_ground_counts_as_fixed_wherever_a_spring_stands_on_it`.
const POINTS: usize = 3;

/// The parts of a Rapier context that can hold bodies.
#[derive(Clone, Copy)]
pub(crate) struct Holding<'a> {
    /// Whether contacts count, or only joints.
    pub contacts: bool,
    pub bodies: &'a RigidBodySet,
    pub joints: &'a RapierContextJoints,
    pub colliders: &'a ColliderSet,
    pub narrow: &'a NarrowPhase,
    /// Gravity, m/s².
    pub gravity: Vec3,
}

impl<'a> Holding<'a> {
    /// Whether a body belongs to a multibody.
    pub(crate) fn is_link(&self, body: BodyId) -> bool {
        let links = &self.joints.multibody_joints;
        links.rigid_body_link(handle(body)).is_some()
    }

    /// Read access to the bodies for code that does not know Rapier.
    pub(crate) fn sight(&self) -> Bodies<&'a RigidBodySet> {
        Bodies {
            set: self.bodies,
            gravity: self.gravity,
        }
    }
}

/// Constraints of the locked axes of a joint between the bodies `on`. `rotation` is the rotation of the joint's first frame,
/// `at` the position of the joint, both in the world frame.
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

/// The game's own joints of a body, and those of multibodies, with the bodies that each joins.
pub(crate) fn joints_of(
    joints: &RapierContextJoints,
    body: RigidBodyHandle,
) -> impl Iterator<Item = ([RigidBodyHandle; 2], &GenericJoint)> {
    let impulse = joints.impulse_joints.attached_enabled_joints(body);
    let impulse = impulse
        .filter(|(_, _, _, joint)| !is_ours(joint))
        .map(|(a, b, _, joint)| ([a, b], &joint.data));
    let multibody = &joints.multibody_joints;
    let links = multibody.attached_joints(body).filter_map(|(a, b, joint)| {
        let (multibody, link) = multibody.get(joint)?;
        Some(([a, b], &multibody.link(link)?.joint.data))
    });
    impulse.chain(links)
}

/// Linked bodies found so far, and their constraints.
struct Found<'a> {
    all: Holding<'a>,
    handles: Vec<RigidBodyHandle>,
    linkage: Linkage,
}

impl Found<'_> {
    /// Index of a movable body; adds the body if it is new. `None` if it cannot move or there are [`MOST`] bodies already.
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

    /// Adds the constraints of a contact pair with pressure: at each contact point, no separation and, with friction, no sliding.
    fn contact(&mut self, pair: &ContactPair) {
        let all = self.all;
        let Some(first) = all.colliders.get(pair.collider1) else {
            return;
        };
        let second = all.colliders.get(pair.collider2);
        let on = [Some(first), second].map(|c| self.index(c?.parent()?));
        for manifold in pair.solver_manifolds() {
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

    /// Adds all joints and contacts of a body, except those with bodies before it in the list, which were added with them.
    fn around(&mut self, index: usize) {
        let (all, handle) = (self.all, self.handles[index]);
        let before = |found: &Self, other: RigidBodyHandle| {
            let known = found.handles.iter().position(|h| *h == other);
            known.is_some_and(|known| known < index)
        };
        for (between, joint) in joints_of(all.joints, handle) {
            let [a, b] = between;
            let other = if a == handle { b } else { a };
            if !before(self, other) {
                self.joint(joint, between);
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

/// Inverse mass of an element along its line that the joints and contacts at its ends leave, 1/kg. `on` returns the handle of
/// a body of the line.
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
