//! Finds out whether contacts or joints hold a body, before the step.

use super::joint::is_ours;
use crate::backend::rapier::body;
use crate::backend::rapier::held::near::{
    NEAR, is_solid, may_press, place, skins, speed_of, way_of,
};
use crate::compat;
use crate::scene::rows::{BodyFlags, BodyRow, take};
use bevy::math::Vec3;
use bevy_rapier3d::parry;
use bevy_rapier3d::parry::bounding_volume::BoundingVolume;
use bevy_rapier3d::parry::partitioning::{Bvh, BvhBuildStrategy};
use bevy_rapier3d::prelude::RapierContextJoints;
use bevy_rapier3d::rapier::dynamics::{RigidBody as RapierBody, RigidBodyHandle};
use bevy_rapier3d::rapier::geometry::{ColliderHandle, ColliderSet, ContactPair, NarrowPhase};

/// How long a body counts as held after its last contact, s. So a hopping wheel or a drumming foot does not change between the
/// two solvers in every step. Pinned by `ground::bounce::rapier_solves_a_soft_spring_from_the_step_in_which_its_ball_lands`.
const LINGER: f32 = 0.1;

/// All solid colliders of a context, to find contacts of bodies that the engine has not stepped yet. The engine finds contacts
/// only within a step, but a stiff spring needs them before the first step.
pub(crate) struct Crowd {
    tree: Bvh,
    bounded: Vec<ColliderHandle>,
    /// Colliders without bounds, such as half-spaces.
    boundless: Vec<ColliderHandle>,
}

impl Crowd {
    pub(crate) fn new(colliders: &ColliderSet) -> Self {
        let (mut bounded, mut boundless, mut bounds) = (Vec::new(), Vec::new(), Vec::new());
        for (handle, collider) in colliders.iter().filter(|(_, c)| is_solid(c)) {
            let own = collider.compute_aabb();
            if own.extents().max_element() < BOUNDLESS {
                bounds.push(own);
                bounded.push(handle);
            } else {
                boundless.push(handle);
            }
        }
        Self {
            tree: Bvh::from_leaves(BvhBuildStrategy::Binned, &bounds),
            bounded,
            boundless,
        }
    }

    /// Whether another collider is within the distance `way` (m) of a body, so that it may touch the body in its first step.
    fn is_near(
        &self,
        handle: RigidBodyHandle,
        body: &RapierBody,
        way: f32,
        all: &ColliderSet,
    ) -> bool {
        let own = body.colliders().iter().filter_map(|own| all.get(*own));
        let mut own = own.map(|own| (own, place(own, body)));
        own.any(|(own, at)| {
            let bounds = own.shape().compute_aabb(&at);
            let bounds = bounds.loosened(way + own.contact_skin());
            let near = self.tree.intersect_aabb(&bounds);
            let bounded = near.map(|leaf| self.bounded[leaf as usize]);
            let mut others = bounded.chain(self.boundless.iter().copied());
            others.any(|other| {
                let Some(other) = all.get(other) else {
                    return false;
                };
                let (a, b) = ((&at, own.shape()), (other.position(), other.shape()));
                let way = way + skins(own, other);
                other.parent() != Some(handle)
                    && may_press(own, other)
                    && !matches!(parry::query::contact(a.0, a.1, b.0, b.1, way), Ok(None))
            })
        })
    }
}

/// A contact that the engine predicts counts if its distance is less than this number of steps of the body's motion. The distance
/// is that at the start of the last step: a body that arrives in this step was up to two steps away then, and the third is for the
/// motion of what it meets. With less, a soft spring's body lands before the solver knows of it; with far more, bodies that pass by
/// slowly count as touched. Pinned by `ground::bounce`.
const REACH: f32 = 3.0;

/// Size of its bounding box above which a collider counts as boundless, m. This is no tuning constant: any number does between the
/// size of a world in f32, some hundred kilometres, and that of a half-space's box, 3e38 m, whose sums would overflow in a tree.
/// Pinned by `touch::tests`.
const BOUNDLESS: f32 = 1e6;

/// Whether a contact that the engine solves is nearer than `way` (m), contact skins included.
fn will_press(pair: &ContactPair, way: f32) -> bool {
    let all = pair
        .solver_manifolds()
        .iter()
        .map(|manifold| &manifold.data);
    let mut solved = all.filter(|data| data.solver_flags.contains(compat::SOLVED));
    solved.any(|data| {
        data.solver_contacts
            .iter()
            .any(|contact| contact.dist < way)
    })
}

/// Whether a context has any joints.
pub(crate) fn any_joints(joints: &RapierContextJoints) -> bool {
    let mut links = joints.multibody_joints.multibodies();
    links.next().is_some() || !joints.impulse_joints.is_empty()
}

/// The contacts and joints of a Rapier context, which can hold bodies.
pub(crate) struct Surroundings<'a> {
    narrow: &'a NarrowPhase,
    joints: &'a RapierContextJoints,
    colliders: &'a ColliderSet,
    crowd: Option<&'a Crowd>,
    /// Whether the context has any joints.
    pub any_joints: bool,
}

impl<'a> Surroundings<'a> {
    pub(crate) fn new(
        narrow: &'a NarrowPhase,
        joints: &'a RapierContextJoints,
        colliders: &'a ColliderSet,
        crowd: Option<&'a Crowd>,
    ) -> Self {
        Self {
            narrow,
            joints,
            colliders,
            crowd,
            any_joints: any_joints(joints),
        }
    }

    /// Whether a joint that this crate did not make acts on a body.
    fn is_jointed(&self, handle: RigidBodyHandle) -> bool {
        if !self.any_joints {
            return false;
        }
        let RapierContextJoints {
            impulse_joints,
            multibody_joints,
            ..
        } = self.joints;
        multibody_joints.rigid_body_link(handle).is_some()
            || impulse_joints
                .attached_enabled_joints(handle)
                .any(|(_, _, _, joint)| !is_ours(joint))
    }

    /// Returns two facts: whether something touches the body or, as far as the engine predicts, will touch it in the coming step
    /// of `time` seconds; and whether a contact pressed on the body in the last step.
    fn touch(&self, body: &RapierBody, time: f64) -> (bool, bool) {
        let (mut touched, mut pressed) = (false, false);
        // The distances are those at the start of the last step, and the other body moves too, so take more than one step.
        let way = NEAR + REACH * body.linvel().length() * time as f32;
        for collider in body.colliders() {
            for pair in self.narrow.contact_pairs_with(*collider) {
                let presses = pair.total_impulse() != Vec3::ZERO;
                pressed |= presses;
                // While a pair moves little, Rapier keeps the distances at which it first found the contacts.
                touched |= presses || will_press(pair, way);
            }
        }
        (touched, pressed)
    }

    /// Finds what holds a body at the start of a step of `time` seconds and updates its flags. Returns whether anything holds it
    /// now or did a moment ago. `push` is the speed that springs can add in the step, m/s.
    pub(crate) fn look(&self, row: &mut BodyRow, body: &RapierBody, time: f64, push: f32) -> bool {
        let handle = body::handle(row.id);
        let jointed = self.is_jointed(handle);
        let (touched, pressed) = self.touch(body, time);
        if jointed || touched {
            row.rare.lingers = LINGER;
        } else if row.has(BodyFlags::LINGERS) {
            row.rare.lingers = (row.rare.lingers.min(LINGER) - time as f32).max(0.0);
        }
        let lingers = (jointed || touched || row.has(BodyFlags::LINGERS)) && row.rare.lingers > 0.0;
        let flags = &mut row.flags;
        flags.set(BodyFlags::JOINTED, jointed);
        flags.set(BodyFlags::TOUCHED, touched);
        flags.set(BodyFlags::PRESSED, pressed);
        flags.set(BodyFlags::LINGERS, lingers);
        if !take!(flags, BodyFlags::NEW) {
            return lingers;
        }
        let near = |way: f32| {
            self.crowd
                .is_some_and(|crowd| crowd.is_near(handle, body, way, self.colliders))
        };
        if near(NEAR) {
            flags.insert(BodyFlags::PRESSED);
        }
        let way = way_of(speed_of(body) + push, time as f32);
        lingers || flags.contains(BodyFlags::PRESSED) || near(way)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy_rapier3d::parry::shape::SharedShape;
    use bevy_rapier3d::rapier::geometry::ColliderBuilder;

    #[test]
    fn a_half_space_has_no_bounds_and_a_world_of_two_hundred_kilometres_has() {
        let mut colliders = ColliderSet::new();
        let ground = SharedShape::halfspace(Vec3::Y);
        colliders.insert(ColliderBuilder::new(ground));
        colliders.insert(ColliderBuilder::cuboid(1e5, 1.0, 1e5));
        let crowd = Crowd::new(&colliders);
        assert_eq!((crowd.bounded.len(), crowd.boundless.len()), (1, 1));
    }
}
