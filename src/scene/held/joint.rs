//! An element as soft constraints of an engine's own solver, in numbers.

use crate::backend::{BodyId, JointId};
use crate::dynamics::pieces::MOST;
use bevy::math::{Quat, Vec3};

/// What a joint acts along.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum Along {
    /// From anchor to anchor.
    Distance,
    /// The x axis of the first frame, both bodies pushed at the second anchor.
    Slide,
    /// The x axis of the first frame, each body pushed at its own anchor.
    Apart,
    /// About the x axis of the first frame.
    Twist,
}

/// One joint, in numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct SoftJoint {
    pub bodies: [BodyId; 2],
    pub anchors: [Vec3; 2],
    pub rotations: [Quat; 2],
    pub along: Along,
    /// Substep, s.
    pub substep: f32,
    /// N/m, or N m/rad.
    pub stiffness: f32,
    /// N s/m that act in all.
    pub damping: f32,
    /// Length without force, m.
    pub target: f32,
    /// Force there and at rest, N.
    pub force: f32,
    /// Greatest force, N.
    pub most: f32,
}

/// A joint of ours in the engine, as snapshots have it.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct KeptJoint {
    /// Which one of its element's.
    pub place: u8,
    pub id: JointId,
    pub joint: SoftJoint,
}

/// Joints of an engine that are such.
pub(crate) trait SoftJoints {
    /// Puts one in.
    fn put(&mut self, joint: &SoftJoint) -> JointId;

    /// Gives one other numbers; says whether it is there.
    fn change(&mut self, joint: JointId, numbers: &SoftJoint) -> bool;

    /// Takes one out.
    fn remove(&mut self, joint: JointId);

    /// Whether one is there.
    fn has(&self, joint: JointId) -> bool;
}

/// Joints of one element besides its damper: for each piece of its force a spring, and what moves the middle of its range.
const SPRINGS: usize = 2 * MOST;

type Known = Option<(JointId, SoftJoint)>;

/// The joints of one element: its damper alone, where that is to be solved before all springs, and its springs with the
/// damper otherwise.
#[derive(Clone, Debug, Default)]
pub(crate) struct Joints {
    damper: Known,
    springs: [Known; SPRINGS],
}

/// What an element's joints are to be.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Wanted {
    pub damper: Option<SoftJoint>,
    springs: [Option<SoftJoint>; SPRINGS],
    count: usize,
}

impl Wanted {
    /// One more, to be solved after those before it.
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
    /// Each of them, and which one it is.
    pub(crate) fn kept(&self) -> impl Iterator<Item = KeptJoint> {
        let places = self.all().enumerate();
        places.filter_map(|(place, known)| {
            let (id, joint) = (*known)?;
            let place = place as u8;
            Some(KeptJoint { place, id, joint })
        })
    }

    /// As they were.
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

    /// How many there are.
    pub(crate) fn count(&self) -> usize {
        self.all().flatten().count()
    }

    /// Whether other numbers are all that these need.
    pub(crate) fn fit(&self, wanted: &Wanted, set: &impl SoftJoints) -> bool {
        let there = |known: &Known| known.is_none_or(|(joint, _)| set.has(joint));
        let orders = [&wanted.damper].into_iter().chain(&wanted.springs);
        self.all()
            .zip(orders)
            .all(|(known, wanted)| fits(known, wanted) && there(known))
    }

    /// Takes them out of the engine.
    pub(crate) fn remove(&mut self, set: &mut impl SoftJoints) {
        let springs = self.springs.iter_mut().filter_map(Option::take);
        for (joint, _) in self.damper.take().into_iter().chain(springs) {
            set.remove(joint);
        }
    }

    /// A damper that is solved before all springs.
    pub(crate) fn put_damper(&mut self, wanted: &Wanted, set: &mut impl SoftJoints) {
        self.damper = insert(set, &wanted.damper);
    }

    /// Its springs, the first one last if they are to be.
    pub(crate) fn put_springs(
        &mut self,
        wanted: &Wanted,
        reversed: bool,
        set: &mut impl SoftJoints,
    ) {
        for i in 0..SPRINGS {
            let i = if reversed { SPRINGS - 1 - i } else { i };
            self.springs[i] = insert(set, &wanted.springs[i]);
        }
    }

    /// Other numbers.
    pub(crate) fn update(&mut self, wanted: &Wanted, set: &mut impl SoftJoints) {
        update(set, &mut self.damper, &wanted.damper);
        for (known, wanted) in self.springs.iter_mut().zip(&wanted.springs) {
            update(set, known, wanted);
        }
    }
}
