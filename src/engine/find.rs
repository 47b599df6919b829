//! Both ends of an element, and what can be wrong with them.

use super::body::is_movable;
use super::check::{Fault, Parameters};
use super::ends::{Ends, Place};
use super::rows::mix;
use crate::dynamics::guide::Guide;
use bevy::ecs::entity::EntityHashSet;
use bevy::ecs::system::SystemParam;
use bevy::math::DVec3;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use bevy_rapier3d::rapier::dynamics::{RigidBody as RapierBody, RigidBodyHandle};

/// Finds the ends of elements and judges them.
#[derive(SystemParam)]
pub(crate) struct Finder<'w, 's> {
    pub(super) ends: Ends<'w, 's>,
    pub(super) sets: Query<
        'w,
        's,
        (
            &'static mut RapierRigidBodySet,
            &'static RapierContextColliders,
            &'static RapierContextJoints,
            &'static RapierContextSimulation,
        ),
    >,
    pub(super) configurations: Query<'w, 's, &'static RapierConfiguration>,
}

/// Both ends of a sound element.
pub(super) struct Found {
    pub(super) places: [Place; 2],
    /// The bodies at both ends that elements can move.
    movable: [Option<Movable>; 2],
}

/// What is found of a body that elements can move.
#[derive(Clone, Copy)]
struct Movable {
    /// The element turns it.
    turns: bool,
    /// See [`Wanted::rank`].
    rank: u64,
}

/// A body that elements can move.
pub(super) struct Wanted {
    pub(super) entity: Entity,
    pub(super) handle: RigidBodyHandle,
    pub(super) context: Entity,
    pub(super) turns: bool,
    /// Where it stands among the bodies of a component, whenever it was spawned: a hash of how it was first found.
    pub(super) rank: u64,
    /// Which elements acted on it before, as a hash.
    pub(super) signature: u64,
}

impl Found {
    /// The bodies that elements can move.
    pub(super) fn movable(&self) -> impl Iterator<Item = Wanted> {
        let ends = self.places.iter().zip(self.movable);
        ends.filter_map(|(place, movable)| match (*place, movable) {
            (
                Place::OnBody {
                    entity,
                    handle,
                    context,
                    ..
                },
                Some(Movable { turns, rank }),
            ) => Some(Wanted {
                entity,
                handle,
                context,
                turns,
                rank,
                signature: 0,
            }),
            _ => None,
        })
    }
}

impl Finder<'_, '_> {
    /// Both ends, or what is wrong with the element. The mass of `modified` bodies is yet to be worked
    /// out anew by the engine.
    pub(super) fn find(
        &mut self,
        parameters: &Parameters,
        guide: Guide,
        scales: &mut [Option<DVec3>; 2],
        modified: &EntityHashSet,
    ) -> Result<Found, Fault> {
        parameters.check()?;
        let mut places = [Place::Point(DVec3::ZERO); 2];
        for (i, place) in places.iter_mut().enumerate() {
            *place = self.ends.find(
                parameters.ends[i],
                parameters.anchors[i],
                parameters.names.ends[i],
                &mut scales[i],
            )?;
        }
        if let [
            Place::OnBody { context: a, .. },
            Place::OnBody { context: b, .. },
        ] = places
            && a != b
        {
            return Err(Fault::new(
                parameters.names.ends[1],
                "is in another Rapier context than body_a",
            ));
        }
        let mut movable = [None; 2];
        for (i, place) in places.iter().enumerate() {
            let field = parameters.names.ends[i];
            let alone = matches!(place, Place::Point(_));
            if alone && (parameters.twist.is_some() || (guide.turns() && i == 0)) {
                return Err(Fault::new(
                    field,
                    "is not a rigid body, so it has no frame to turn in",
                ));
            }
            movable[i] = self.movable(place, field, modified)?;
            if let Some(body) = &mut movable[i] {
                body.turns |= guide.turns();
            }
        }
        Ok(Found { places, movable })
    }

    /// The body of this end, if it can be moved, and whether it is held off its centre of mass.
    fn movable(
        &mut self,
        place: &Place,
        field: &'static str,
        modified: &EntityHashSet,
    ) -> Result<Option<Movable>, Fault> {
        let Place::OnBody {
            entity,
            handle,
            context,
            local,
        } = *place
        else {
            return Ok(None);
        };
        let missing = Fault::new(
            field,
            "has a rigid body that the physics engine does not know",
        );
        let (mut set, colliders, ..) = self.sets.get_mut(context).map_err(|_| missing)?;
        // Read first: a mutable look marks the body as modified in the engine.
        let body = set.bodies.get(handle).ok_or(missing)?;
        if !is_movable(body) {
            return Ok(None);
        }
        let fresh = body.mass_properties().local_mprops.inv_mass == 0.0;
        if (fresh || modified.contains(&entity))
            && let Some(body) = set.bodies.get_mut(handle)
        {
            body.recompute_mass_properties_from_colliders(&colliders.colliders);
        }
        let body = set.bodies.get(handle).ok_or(missing)?;
        if body.mass_properties().local_mprops.inv_mass == 0.0 {
            return Err(Fault::new(
                field,
                "is a dynamic body without mass; give it AdditionalMassProperties, or a collider with or after its RigidBody",
            ));
        }
        let arm = local - body.local_center_of_mass().as_dvec3();
        Ok(Some(Movable {
            turns: arm.length() > 1e-7,
            rank: rank(body),
        }))
    }
}

/// A number for a body that does not depend on when it was spawned. Two bodies of the same mass at the same place have the
/// same one.
fn rank(body: &RapierBody) -> u64 {
    let place = body.position();
    let numbers = place.translation.to_array().into_iter();
    let numbers = numbers
        .chain(place.rotation.to_array())
        .chain([body.mass()]);
    numbers.fold(0, |sum, number| mix(sum ^ u64::from(number.to_bits())))
}
