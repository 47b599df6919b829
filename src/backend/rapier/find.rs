//! Finds both ends of an element in Rapier and checks them, before the step.

use super::body::{handle, is_movable};
use super::ends::Ends;
use crate::backend::{Allowance, Finder, Found, Movable, Place, SAME_PLACE, Stance};
use crate::dynamics::guide::Guide;
use crate::element::{HoldPose, SpringTuning};
use crate::input::check::{Fault, Parameters};
use crate::scene::rows::mix;
use bevy::ecs::entity::EntityHashSet;
use bevy::ecs::system::SystemParam;
use bevy::math::DVec3;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use bevy_rapier3d::rapier::dynamics::RigidBody as RapierBody;

/// The components of Rapier's contexts that are needed to find ends.
pub(crate) type Contexts<'w, 's> = Query<
    'w,
    's,
    (
        &'static mut RapierRigidBodySet,
        &'static RapierContextColliders,
        &'static RapierContextJoints,
        &'static RapierContextSimulation,
    ),
>;

/// Finds the ends of elements and checks them.
#[derive(SystemParam)]
pub(crate) struct RapierFinder<'w, 's> {
    pub(crate) ends: Ends<'w, 's>,
    pub(crate) sets: Contexts<'w, 's>,
    pub(crate) configurations: Query<'w, 's, &'static RapierConfiguration>,
}

impl Finder for RapierFinder<'_, '_> {
    fn place(
        &self,
        end: Entity,
        anchor: Vec3,
        field: &'static str,
        scale: &mut Option<Vec3>,
    ) -> Result<Place, Fault> {
        self.ends.find(end, anchor, field, scale)
    }

    fn find(
        &mut self,
        parameters: &Parameters,
        guide: Guide,
        scales: &mut [Option<Vec3>; 2],
        modified: &EntityHashSet,
    ) -> Result<Found, Fault> {
        parameters.check()?;
        let mut places = [Place::Point(DVec3::ZERO); 2];
        for (i, place) in places.iter_mut().enumerate() {
            *place = self.ends.find(
                parameters.ties.ends[i],
                parameters.ties.anchors[i],
                parameters.ties.names.ends[i],
                &mut scales[i],
            )?;
        }
        let on = places.map(|place| match place {
            Place::OnBody {
                entity, context, ..
            } => Some((entity, context)),
            Place::Point(_) => None,
        });
        if let [Some(a), Some(b)] = on {
            let fault = |reason| Err(Fault::new(parameters.ties.names.ends[1], reason));
            if a.1 != b.1 {
                return fault("is in another Rapier context than body_a");
            }
            if a.0 == b.0 {
                return fault("is on the same rigid body as body_a");
            }
        }
        let mut movable = [None; 2];
        for (i, place) in places.iter().enumerate() {
            let field = parameters.ties.names.ends[i];
            let alone = matches!(place, Place::Point(_));
            if alone && (parameters.ties.twist.is_some() || (guide.turns() && i == 0)) {
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

    fn tune(
        &self,
        tuning: SpringTuning,
        stance: &Stance,
        allowed: Allowance,
        parameters: &mut Parameters,
    ) -> Result<bool, Fault> {
        self.tuned(tuning, stance, allowed, parameters)
    }

    fn pose(&self, pose: HoldPose, stance: &Stance) -> Result<[f64; 2], Fault> {
        let Some(lever) = self.lever(stance) else {
            return Err(Fault::new(
                "HoldPose",
                "stands on an element whose ends cannot move or coincide",
            ));
        };
        let tension = self.tension_of_pose(&lever, pose)?;
        Ok([tension, lever.line.distance()])
    }
}

impl RapierFinder<'_, '_> {
    /// Returns data about the body at an end, if elements can move it.
    fn movable(
        &mut self,
        place: &Place,
        field: &'static str,
        modified: &EntityHashSet,
    ) -> Result<Option<Movable>, Fault> {
        let Place::OnBody {
            entity,
            body,
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
        let of = handle(body);
        // Read first: mutable access marks the body as modified in the engine.
        let body = set.bodies.get(of).ok_or(missing)?;
        if !is_movable(body) {
            return Ok(None);
        }
        let fresh = body.mass_properties().local_mprops.inv_mass == 0.0;
        if (fresh || modified.contains(&entity))
            && let Some(body) = set.bodies.get_mut(of)
        {
            body.recompute_mass_properties_from_colliders(&colliders.colliders);
        }
        let body = set.bodies.get(of).ok_or(missing)?;
        if body.mass_properties().local_mprops.inv_mass == 0.0 {
            return Err(Fault::new(
                field,
                "is a dynamic body without mass; give it AdditionalMassProperties, or a collider with or after its RigidBody",
            ));
        }
        let center = body.local_center_of_mass();
        Ok(Some(Movable {
            turns: local.distance(center.as_dvec3()) > SAME_PLACE,
            center,
            rank: rank(body),
        }))
    }
}

/// A hash of a body's pose and mass, which does not depend on when the body was spawned. Two bodies of the same mass in the
/// same pose have the same hash.
fn rank(body: &RapierBody) -> u64 {
    let place = body.position();
    let numbers = place.translation.to_array().into_iter();
    let numbers = numbers
        .chain(place.rotation.to_array())
        .chain([body.mass()]);
    numbers.fold(0, |sum, number| mix(sum ^ u64::from(number.to_bits())))
}
