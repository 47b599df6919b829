//! Describes an element as soft constraints for an engine's own solver. The backend makes joints from these numbers.

use crate::backend::{BodyId, JointId};
use crate::dynamics::pieces::MOST;
use bevy::math::{Quat, Vec3};

/// The coordinate on which a joint acts.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum Along {
    /// Distance from anchor to anchor.
    Distance,
    /// Distance along the x axis of the first frame. Both bodies are pushed at the second anchor.
    Slide,
    /// Distance along the x axis of the first frame. Each body is pushed at its own anchor.
    Apart,
    /// Angle about the x axis of the first frame.
    Twist,
}

/// The numbers of one joint. For [`Along::Twist`], angles (rad) replace lengths and torques (N m) replace forces.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct SoftJoint {
    pub bodies: [BodyId; 2],
    pub anchors: [Vec3; 2],
    pub rotations: [Quat; 2],
    pub along: Along,
    /// Duration of a substep, s.
    pub substep: f32,
    /// N/m, or N m/rad.
    pub stiffness: f32,
    /// Total damping that acts, N s/m.
    pub damping: f32,
    /// Length at which the elastic force is `force`, m.
    pub target: f32,
    /// Force at the length `target` without damping, N.
    pub force: f32,
    /// Greatest force, N.
    pub most: f32,
}

/// A joint of the crate in the engine, as a snapshot stores it.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct KeptJoint {
    /// Index of the joint among those of its element: 0 is the damper, then come the springs.
    pub place: u8,
    pub id: JointId,
    pub joint: SoftJoint,
}

/// The set of joints of an engine.
pub(crate) trait SoftJoints {
    /// Inserts a joint.
    fn put(&mut self, joint: &SoftJoint) -> JointId;

    /// Changes the numbers of a joint. Returns whether the joint exists.
    fn change(&mut self, joint: JointId, numbers: &SoftJoint) -> bool;

    /// Removes a joint.
    fn remove(&mut self, joint: JointId);

    /// Whether a joint exists.
    fn has(&self, joint: JointId) -> bool;
}

/// Greatest number of joints of an element besides its damper: for each piece of its force a spring, and a motor
/// that shifts the middle of its range.
const SPRINGS: usize = 2 * MOST;

type Known = Option<(JointId, SoftJoint)>;

/// The joints of one element. `damper` is used only if the damper must be solved before all springs.
/// Otherwise the damper is part of the springs.
#[derive(Clone, Debug, Default)]
pub(crate) struct Joints {
    damper: Known,
    springs: [Known; SPRINGS],
}

/// The joints that an element needs.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct WantedJoints {
    pub damper: Option<SoftJoint>,
    springs: [Option<SoftJoint>; SPRINGS],
    count: usize,
}

impl WantedJoints {
    /// Adds a spring, which is solved after the springs that were added before.
    pub(crate) fn push(&mut self, spring: SoftJoint) {
        self.springs[self.count] = Some(spring);
        self.count += 1;
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// The bodies at both ends.
    pub(crate) fn bodies(&self) -> Option<[BodyId; 2]> {
        self.springs[0].map(|spring| spring.bodies)
    }
}

fn fits(known: &Known, wanted: &Option<SoftJoint>) -> bool {
    match (known, wanted) {
        (None, None) => true,
        (Some((_, known)), Some(wanted)) => {
            known.bodies == wanted.bodies && known.along == wanted.along
        }
        _ => false,
    }
}

fn insert(set: &mut impl SoftJoints, wanted: &Option<SoftJoint>) -> Known {
    wanted.map(|wanted| (set.put(&wanted), wanted))
}

fn update(set: &mut impl SoftJoints, known: &mut Known, wanted: &Option<SoftJoint>) {
    if let (Some((joint, known)), Some(wanted)) = (known, wanted)
        && known != wanted
        && set.change(*joint, wanted)
    {
        *known = *wanted;
    }
}

impl Joints {
    /// All joints with their indices, for a snapshot.
    pub(crate) fn kept(&self) -> impl Iterator<Item = KeptJoint> {
        let places = self.all().enumerate();
        places.filter_map(|(place, known)| {
            let (id, joint) = (*known)?;
            let place = place as u8;
            Some(KeptJoint { place, id, joint })
        })
    }

    /// Restores the joints from a snapshot.
    pub(crate) fn of(kept: &[KeptJoint]) -> Self {
        let mut joints = Self::default();
        for known in kept {
            let place = match known.place.checked_sub(1) {
                None => Some(&mut joints.damper),
                Some(spring) => joints.springs.get_mut(usize::from(spring)),
            };
            if let Some(place) = place {
                *place = Some((known.id, known.joint));
            }
        }
        joints
    }

    fn all(&self) -> impl Iterator<Item = &Known> {
        [&self.damper].into_iter().chain(&self.springs)
    }

    /// Number of joints.
    pub(crate) fn count(&self) -> usize {
        self.all().flatten().count()
    }

    /// Whether all wanted joints exist already, so that only their numbers must be changed.
    pub(crate) fn fit(&self, wanted: &WantedJoints, set: &impl SoftJoints) -> bool {
        let there = |known: &Known| known.is_none_or(|(joint, _)| set.has(joint));
        let orders = [&wanted.damper].into_iter().chain(&wanted.springs);
        self.all()
            .zip(orders)
            .all(|(known, wanted)| fits(known, wanted) && there(known))
    }

    /// Removes all joints from the engine.
    pub(crate) fn remove(&mut self, set: &mut impl SoftJoints) {
        let springs = self.springs.iter_mut().filter_map(Option::take);
        for (joint, _) in self.damper.take().into_iter().chain(springs) {
            set.remove(joint);
        }
    }

    /// Inserts the damper that is solved before all springs, if one is wanted.
    pub(crate) fn put_damper(&mut self, wanted: &WantedJoints, set: &mut impl SoftJoints) {
        self.damper = insert(set, &wanted.damper);
    }

    /// Inserts the springs. If `reversed`, the first spring is inserted last.
    pub(crate) fn put_springs(
        &mut self,
        wanted: &WantedJoints,
        reversed: bool,
        set: &mut impl SoftJoints,
    ) {
        for i in 0..SPRINGS {
            let i = if reversed { SPRINGS - 1 - i } else { i };
            self.springs[i] = insert(set, &wanted.springs[i]);
        }
    }

    /// Changes the numbers of all joints.
    pub(crate) fn update(&mut self, wanted: &WantedJoints, set: &mut impl SoftJoints) {
        update(set, &mut self.damper, &wanted.damper);
        for (known, wanted) in self.springs.iter_mut().zip(&wanted.springs) {
            update(set, known, wanted);
        }
    }
}
