//! An element as a joint of Rapier's: the only place that knows how its motors reckon.
//!
//! A motor with stiffness k, damping c and target s₀ gives in a substep h the impulse h·(k (s − s₀) + (h k + c) ṡ − …),
//! where s is the length at the start and ṡ its rate at the end. So a damping of C is ordered as C − h k; what is left is
//! the symplectic Euler rule with an implicit damper.

use crate::dynamics::pieces::MOST;
use crate::engine::kept::KeptJoint;
use bevy::math::{Quat, Vec3};
use bevy_rapier3d::rapier::dynamics::{
    GenericJoint, GenericJointBuilder, ImpulseJoint, ImpulseJointHandle, ImpulseJointSet,
    JointAxesMask, JointAxis, MotorModel, RigidBodyHandle,
};
use bevy_rapier3d::rapier::math::Pose;

/// Marks the joints that are ours alone.
const OURS: u128 = u128::from_be_bytes(*b"bevy_coilover\0\0\0");

/// Whether elements have made a joint.
pub(in crate::engine) fn is_ours(joint: &ImpulseJoint) -> bool {
    joint.data.user_data == OURS
}

/// What a joint acts along.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(in crate::engine) enum Along {
    /// From anchor to anchor.
    Distance,
    /// The x axis of the first frame.
    Slide,
    /// About the x axis of the first frame.
    Twist,
}

/// One joint, in numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(in crate::engine) struct SoftJoint {
    pub bodies: [RigidBodyHandle; 2],
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

impl SoftJoint {
    fn axis(&self) -> JointAxis {
        match self.along {
            Along::Distance | Along::Slide => JointAxis::LinX,
            Along::Twist => JointAxis::AngX,
        }
    }

    fn data(&self) -> GenericJoint {
        let axis = self.axis();
        let frame = |end: usize| Pose::from_parts(self.anchors[end], self.rotations[end]);
        let coupled = match self.along {
            Along::Distance => JointAxesMask::LIN_AXES,
            Along::Slide | Along::Twist => JointAxesMask::empty(),
        };
        let ordered = ordered_damping(self.stiffness, self.damping, self.substep);
        // As Rapier reckons it: what its damper gives at a speed of 1.
        let acting = self.substep * self.stiffness + ordered;
        let mut joint = GenericJointBuilder::new(JointAxesMask::empty())
            .coupled_axes(coupled)
            .local_frame1(frame(0))
            .local_frame2(frame(1))
            .user_data(OURS)
            .build();
        joint
            .set_motor(
                axis,
                self.target,
                -self.force / acting,
                self.stiffness,
                ordered,
            )
            .set_motor_model(axis, MotorModel::ForceBased)
            .set_motor_max_force(axis, self.most);
        joint
    }
}

/// The damping to order so that in substeps of so long a damping of `wanted` acts. What Rapier makes of it in f32 is a
/// small difference of large numbers, so of its neighbours the one is taken that leaves the stiffness as it is.
fn ordered_damping(stiffness: f32, wanted: f32, substep: f32) -> f32 {
    let (k, h) = (stiffness, substep);
    let ordered = (f64::from(wanted) - f64::from(h) * f64::from(k)) as f32;
    let off = |c: f32| {
        // As in Rapier's `MotorModel::combine_coefficients`.
        let (per_rate, per_speed) = (h * k + c, h * h * k + h * c);
        if per_rate > 0.0 && per_speed > 0.0 {
            (f64::from(per_speed) / (f64::from(per_rate) * f64::from(h)) - 1.0).abs()
        } else {
            f64::INFINITY
        }
    };
    let mut best = (off(ordered), ordered);
    let mut candidate = ordered;
    for _ in 0..NEIGHBOURS {
        if best.0 < EXACT {
            break;
        }
        candidate = candidate.next_up();
        if off(candidate) < best.0 {
            best = (off(candidate), candidate);
        }
    }
    best.1
}

/// Neighbours that are tried, and the relative error of the stiffness that is small enough.
const NEIGHBOURS: usize = 64;
const EXACT: f64 = 3e-7;

/// Joints of one element besides its damper: for each piece of its force a spring, and what moves the middle of its range.
const SPRINGS: usize = 2 * MOST;

type Known = Option<(ImpulseJointHandle, SoftJoint)>;

/// The joints of one element: its damper alone, where that is to be solved before all springs, and its springs with the
/// damper otherwise.
#[derive(Clone, Debug, Default)]
pub(in crate::engine) struct Joints {
    damper: Known,
    springs: [Known; SPRINGS],
}

/// What an element's joints are to be.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::engine) struct Wanted {
    pub damper: Option<SoftJoint>,
    springs: [Option<SoftJoint>; SPRINGS],
    count: usize,
}

impl Wanted {
    /// One more, to be solved after those before it.
    pub(in crate::engine) fn push(&mut self, spring: SoftJoint) {
        self.springs[self.count] = Some(spring);
        self.count += 1;
    }

    pub(in crate::engine) fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// The bodies at both ends.
    pub(in crate::engine) fn bodies(&self) -> Option<[RigidBodyHandle; 2]> {
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

fn insert(set: &mut ImpulseJointSet, wanted: &Option<SoftJoint>) -> Known {
    let wanted = (*wanted)?;
    let [a, b] = wanted.bodies;
    Some((set.insert(a, b, wanted.data(), false), wanted))
}

fn update(set: &mut ImpulseJointSet, known: &mut Known, wanted: &Option<SoftJoint>) {
    if let (Some((handle, known)), Some(wanted)) = (known, wanted)
        && known != wanted
        && let Some(joint) = set.get_mut(*handle, false)
    {
        joint.data = wanted.data();
        *known = *wanted;
    }
}

impl Joints {
    /// Each of them, and which one it is.
    pub(in crate::engine) fn kept(&self) -> impl Iterator<Item = KeptJoint> {
        let places = self.all().enumerate();
        places.filter_map(|(place, known)| {
            let (handle, joint) = (*known)?;
            let place = place as u8;
            Some(KeptJoint {
                place,
                handle,
                joint,
            })
        })
    }

    /// As they were.
    pub(in crate::engine) fn of(kept: &[KeptJoint]) -> Self {
        let mut joints = Self::default();
        for known in kept {
            let place = match known.place.checked_sub(1) {
                None => Some(&mut joints.damper),
                Some(spring) => joints.springs.get_mut(usize::from(spring)),
            };
            if let Some(place) = place {
                *place = Some((known.handle, known.joint));
            }
        }
        joints
    }

    fn all(&self) -> impl Iterator<Item = &Known> {
        [&self.damper].into_iter().chain(&self.springs)
    }

    /// How many there are.
    pub(in crate::engine) fn count(&self) -> usize {
        self.all().flatten().count()
    }

    /// Whether other numbers are all that these need.
    pub(in crate::engine) fn fit(&self, wanted: &Wanted, set: &ImpulseJointSet) -> bool {
        let there = |known: &Known| known.is_none_or(|(handle, _)| set.contains(handle));
        let orders = [&wanted.damper].into_iter().chain(&wanted.springs);
        self.all()
            .zip(orders)
            .all(|(known, wanted)| fits(known, wanted) && there(known))
    }

    /// Takes them out of the engine.
    pub(in crate::engine) fn remove(&mut self, set: &mut ImpulseJointSet) {
        let springs = self.springs.iter_mut().filter_map(Option::take);
        for (handle, _) in self.damper.take().into_iter().chain(springs) {
            set.remove(handle, false);
        }
    }

    /// A damper that is solved before all springs.
    pub(in crate::engine) fn put_damper(&mut self, wanted: &Wanted, set: &mut ImpulseJointSet) {
        self.damper = insert(set, &wanted.damper);
    }

    /// Its springs, the first one last if they are to be.
    pub(in crate::engine) fn put_springs(
        &mut self,
        wanted: &Wanted,
        reversed: bool,
        set: &mut ImpulseJointSet,
    ) {
        for i in 0..SPRINGS {
            let i = if reversed { SPRINGS - 1 - i } else { i };
            self.springs[i] = insert(set, &wanted.springs[i]);
        }
    }

    /// Other numbers.
    pub(in crate::engine) fn update(&mut self, wanted: &Wanted, set: &mut ImpulseJointSet) {
        update(set, &mut self.damper, &wanted.damper);
        for (known, wanted) in self.springs.iter_mut().zip(&wanted.springs) {
            update(set, known, wanted);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_rapier_makes_of_the_order_is_what_was_wanted() {
        let model = MotorModel::ForceBased;
        for substep in [1.0 / 960.0_f32, 1.0 / 3840.0, 1.0 / 240.0] {
            for stiffness in [1.0_f32, 777.0, 30e3, 1.234e6] {
                let least = 5e-4 * substep * stiffness;
                for damping in [least, least.max(0.1), least.max(2e3)] {
                    let ordered = ordered_damping(stiffness, damping, substep);
                    let (bias, _, gain) = model.combine_coefficients(substep, stiffness, ordered);
                    // Force for a stretch, and for a speed.
                    let (bias, gain) = (f64::from(bias), f64::from(gain));
                    let springs = bias / gain / f64::from(substep) / f64::from(stiffness);
                    let dampens = 1.0 / (gain * f64::from(substep)) / f64::from(damping);
                    assert!(
                        (springs - 1.0).abs() < 2e-5,
                        "{stiffness} {damping}: {springs}"
                    );
                    assert!(
                        (dampens - 1.0).abs() < 0.01,
                        "{stiffness} {damping}: {dampens}"
                    );
                }
            }
        }
    }
}
