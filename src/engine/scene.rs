//! Elements and the bodies they act on, as flat arrays, found anew every tick.

use super::body::is_movable;
use super::check::{Fault, Parameters};
use super::ends::{Ends, Place};
use super::forces::SpringLoad;
use super::memory::ElementMemory;
use crate::element::{Anchors, Damper, Spring, SpringDamper};
use bevy::ecs::entity::EntityHashMap;
use bevy::ecs::message::MessageReader;
use bevy::math::DVec3;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use bevy_rapier3d::rapier::dynamics::RigidBodyHandle;

/// Where an element is held this tick.
#[derive(Clone, Copy, Debug)]
pub(super) enum Held {
    /// On a rigid body, movable or not, at a point of its own frame.
    Body {
        handle: RigidBodyHandle,
        context: Entity,
        local: DVec3,
        /// Index into [`Scene::bodies`] if elements can move it.
        movable: Option<usize>,
    },
    /// A plain entity's path over the coming step: it goes where the game has just put it.
    Path { from: DVec3, to: DVec3 },
}

/// One element this tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct ElementRow {
    pub entity: Entity,
    pub held: [Held; 2],
    pub parameters: Parameters,
    pub direction: Option<DVec3>,
    /// A parameter or an end changed since the last tick.
    pub changed: bool,
    /// Where its ends were after the last step: a body's own point if elements can move it, else a point
    /// of the world.
    pub remembered: [Option<DVec3>; 2],
    /// Why it does not act, if it does not.
    pub fault: Option<Fault>,
    /// The rest length was found in this tick and has to be written back.
    pub captured: bool,
}

/// One movable body that elements act on.
#[derive(Clone, Copy, Debug)]
pub(super) struct BodyRow {
    pub entity: Entity,
    pub handle: RigidBodyHandle,
    pub context: Entity,
    /// Some element holds it off its centre of mass.
    pub turns: bool,
    /// How many elements act on it.
    pub elements: u32,
    /// Which ones, as a hash.
    pub signature: u64,
    /// Its mass has changed.
    pub changed: bool,
}

/// The scene as this tick sees it.
#[derive(Resource, Default)]
pub struct Scene {
    pub(super) elements: Vec<ElementRow>,
    pub(super) bodies: Vec<BodyRow>,
    pub(super) index: EntityHashMap<usize>,
    /// Engine steps so far, to tell what an element remembers of the last one.
    pub(super) step: u64,
    /// Seconds that the engine will step in this tick; 0 if it will not.
    pub(super) time: f64,
}

/// The parts of an element.
pub(crate) type ElementParts<'a> = (
    Entity,
    Option<Ref<'a, Spring>>,
    Option<Ref<'a, Damper>>,
    Option<Ref<'a, SpringDamper>>,
    Option<Ref<'a, Anchors>>,
    &'a mut ElementMemory,
);

/// Finds elements, their ends and the bodies they load.
pub(crate) fn prepare(
    mut scene: ResMut<Scene>,
    mut elements: Query<ElementParts, Or<(With<Spring>, With<Damper>, With<SpringDamper>)>>,
    ends: Ends,
    mut sets: Query<(&mut RapierRigidBodySet, &RapierContextColliders)>,
    loads: Query<(Has<SpringLoad>, Option<&ExternalForce>), With<RapierRigidBodyHandle>>,
    mut mass_modified: MessageReader<MassModifiedEvent>,
    mut commands: Commands,
) {
    let scene = &mut *scene;
    scene.elements.clear();
    scene.bodies.clear();
    scene.index.clear();
    let mass_modified: Vec<Entity> = mass_modified.read().map(|m| m.0).collect();

    for (entity, spring, damper, pair, anchors, mut memory) in &mut elements {
        let changed = spring.as_ref().is_some_and(Ref::is_changed)
            || damper.as_ref().is_some_and(Ref::is_changed)
            || pair.as_ref().is_some_and(Ref::is_changed)
            || anchors.as_ref().is_some_and(Ref::is_changed);
        let parameters = Parameters::read(
            spring.as_deref(),
            damper.as_deref(),
            pair.as_deref(),
            anchors.as_deref(),
        );
        let found = parameters.and_then(|parameters| {
            parameters.check()?;
            let held = find(
                &parameters,
                &ends,
                &mut memory,
                &mut sets,
                scene,
                &mass_modified,
            )?;
            Ok((parameters, held))
        });
        match found {
            Ok((parameters, held)) => {
                for end in held {
                    if let Held::Body {
                        movable: Some(index),
                        ..
                    } = end
                    {
                        let body = &mut scene.bodies[index];
                        body.elements += 1;
                        body.signature = body.signature.wrapping_add(mix(entity.to_bits()));
                    }
                }
                scene.elements.push(ElementRow {
                    entity,
                    held,
                    parameters,
                    direction: memory.direction,
                    changed,
                    remembered: memory.ends.map(|end| end.place.map(|(_, place)| place)),
                    fault: None,
                    captured: false,
                });
            }
            Err(fault) => report(entity, Some(fault), &mut memory, &mut commands),
        }
    }

    for body in &scene.bodies {
        let Ok((has_load, force)) = loads.get(body.entity) else {
            continue;
        };
        if force.is_none() || !has_load {
            let engine = sets.get(body.context).ok().and_then(|(set, _)| {
                let body = set.bodies.get(body.handle)?;
                Some(ExternalForce {
                    force: body.user_force(),
                    torque: body.user_torque(),
                })
            });
            // A force written to the engine alone belongs to the user too.
            let present = force.copied().or(engine).unwrap_or_default();
            let mut entity = commands.entity(body.entity);
            if force.is_none() {
                entity.try_insert(present);
            }
            if !has_load {
                entity.try_insert(SpringLoad::new(present));
            }
        }
    }
}

/// Both ends, with their bodies entered into the scene; nothing is entered unless both are sound.
fn find(
    parameters: &Parameters,
    ends: &Ends,
    memory: &mut ElementMemory,
    sets: &mut Query<(&mut RapierRigidBodySet, &RapierContextColliders)>,
    scene: &mut Scene,
    mass_modified: &[Entity],
) -> Result<[Held; 2], Fault> {
    let mut places = [Place::Point(DVec3::ZERO); 2];
    for (i, place) in places.iter_mut().enumerate() {
        *place = ends.find(
            parameters.ends[i],
            parameters.anchors[i],
            parameters.names.ends[i],
            &mut memory.ends[i],
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
        let Place::OnBody {
            entity,
            handle,
            context,
            local,
        } = *place
        else {
            continue;
        };
        let missing = Fault::new(
            parameters.names.ends[i],
            "has a rigid body that the physics engine does not know",
        );
        let (mut set, colliders) = sets.get_mut(context).map_err(|_| missing)?;
        // Read first: a mutable look marks the body as modified in the engine.
        let body = set.bodies.get(handle).ok_or(missing)?;
        if !is_movable(body) {
            continue;
        }
        let fresh = body.mass_properties().local_mprops.inv_mass == 0.0;
        if (fresh || mass_modified.contains(&entity))
            && let Some(body) = set.bodies.get_mut(handle)
        {
            body.recompute_mass_properties_from_colliders(&colliders.colliders);
        }
        let body = set.bodies.get(handle).ok_or(missing)?;
        if body.mass_properties().local_mprops.inv_mass == 0.0 {
            return Err(Fault::new(
                parameters.names.ends[i],
                "is a dynamic body without mass; give it a collider or AdditionalMassProperties",
            ));
        }
        let arm = local - body.local_center_of_mass().as_dvec3();
        movable[i] = Some((entity, arm.length() > 1e-7));
    }
    let mut held = [Held::Path {
        from: DVec3::ZERO,
        to: DVec3::ZERO,
    }; 2];
    for (i, place) in places.iter().enumerate() {
        held[i] = match *place {
            Place::OnBody {
                handle,
                context,
                local,
                ..
            } => Held::Body {
                handle,
                context,
                local,
                movable: movable[i].map(|(entity, off_center)| {
                    let body = scene.enter(entity, handle, context, off_center);
                    scene.bodies[body].changed |= mass_modified.contains(&entity);
                    body
                }),
            },
            Place::Point(to) => {
                // Where it was after the last step; older memories would make a leap of it.
                let last = memory.ends[i].place.filter(|_| memory.step == scene.step);
                let from = last
                    .filter(|(e, _)| *e == parameters.ends[i])
                    .map_or(to, |(_, p)| p);
                Held::Path { from, to }
            }
        };
    }
    Ok(held)
}

impl Scene {
    fn enter(
        &mut self,
        entity: Entity,
        handle: RigidBodyHandle,
        context: Entity,
        off_center: bool,
    ) -> usize {
        let bodies = &mut self.bodies;
        let index = *self.index.entry(entity).or_insert_with(|| {
            bodies.push(BodyRow {
                entity,
                handle,
                context,
                turns: false,
                elements: 0,
                signature: 0,
                changed: false,
            });
            bodies.len() - 1
        });
        bodies[index].turns |= off_center;
        index
    }
}

/// Says once what is wrong with an element, and takes it back once it is mended.
pub(super) fn report(
    entity: Entity,
    fault: Option<Fault>,
    memory: &mut ElementMemory,
    commands: &mut Commands,
) {
    if memory.fault == fault {
        return;
    }
    memory.fault = fault;
    match fault {
        Some(fault) => {
            let fault = crate::element::SpringFault {
                entity,
                field: fault.field.into(),
                reason: fault.reason.into(),
            };
            log::warn!("{fault}");
            commands.entity(entity).try_insert(fault);
        }
        None => {
            commands
                .entity(entity)
                .try_remove::<crate::element::SpringFault>();
        }
    }
}

/// Spreads an entity's bits, so that sums of them tell sets apart.
fn mix(bits: u64) -> u64 {
    let x = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb)
}
