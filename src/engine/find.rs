//! Elements to rows: ends found, bodies entered, what was known of both carried over.

use super::body::is_movable;
use super::check::{Fault, Parameters, Trouble};
use super::companions::{Companion, Companions};
use super::ends::{Ends, Place};
use super::parts::{IsElement, Parts};
use super::prepare::report;
use super::scene::{BodyRow, ElementRow, Held, Memory, Scene};
use crate::dynamics::guide::Guide;
use bevy::ecs::entity::{EntityHashMap, EntityHashSet};
use bevy::ecs::system::SystemParam;
use bevy::math::DVec3;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use std::mem::{swap, take};

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
        ),
    >,
    pub(super) configurations: Query<'w, 's, &'static RapierConfiguration>,
}

/// Both ends of a sound element.
pub(super) struct Found {
    pub(super) places: [Place; 2],
    /// Whether elements can move the body at each end, and if so whether this one turns it.
    turns: [Option<bool>; 2],
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
        let mut turns = [None; 2];
        for (i, place) in places.iter().enumerate() {
            let field = parameters.names.ends[i];
            let alone = matches!(place, Place::Point(_));
            if alone && (parameters.twist.is_some() || (guide.turns() && i == 0)) {
                return Err(Fault::new(
                    field,
                    "is not a rigid body, so it has no frame to turn in",
                ));
            }
            turns[i] = self.turns(place, field, modified)?;
            if let Some(turns) = &mut turns[i] {
                *turns |= guide.turns();
            }
        }
        Ok(Found { places, turns })
    }

    /// Whether the body of this end can be moved, and is held off its centre of mass.
    fn turns(
        &mut self,
        place: &Place,
        field: &'static str,
        modified: &EntityHashSet,
    ) -> Result<Option<bool>, Fault> {
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
        let (mut set, colliders) = self.sets.get_mut(context).map_err(|_| missing)?;
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
                "is a dynamic body without mass; give it a collider or AdditionalMassProperties",
            ));
        }
        let arm = local - body.local_center_of_mass().as_dvec3();
        Ok(Some(arm.length() > 1e-7))
    }
}

/// The rows before they were made anew. Kept between, for their memory alone.
#[derive(Default)]
pub(super) struct Known {
    elements: Vec<ElementRow>,
    row_of: EntityHashMap<usize>,
    bodies: Vec<BodyRow>,
    index: EntityHashMap<usize>,
}

impl Known {
    fn element(&self, entity: Entity) -> Option<&ElementRow> {
        Some(&self.elements[*self.row_of.get(&entity)?])
    }

    fn body(&self, entity: Entity) -> Option<&BodyRow> {
        Some(&self.bodies[*self.index.get(&entity)?])
    }

    fn clear(&mut self) {
        self.elements.clear();
        self.row_of.clear();
        self.bodies.clear();
        self.index.clear();
    }
}

impl Scene {
    /// Makes all rows anew. Bodies stand in the order of their entities, and within a component elements
    /// in an order of their own, so that the order in which elements were spawned changes nothing.
    pub(super) fn renew(
        &mut self,
        elements: &Query<Parts, IsElement>,
        companions: &Companions,
        finder: &mut Finder,
        modified: &EntityHashSet,
        commands: &mut Commands,
    ) {
        let mut known = take(&mut self.known);
        swap(&mut self.elements, &mut known.elements);
        swap(&mut self.row_of, &mut known.row_of);
        swap(&mut self.bodies, &mut known.bodies);
        swap(&mut self.index, &mut known.index);
        self.changed.clear();
        self.faulty.clear();
        self.followed.clear();
        self.walls.clear();
        let mut found_all = Vec::with_capacity(known.elements.len());
        for parts in elements {
            let entity = parts.entity;
            let mut row = ElementRow::fresh(entity, known.element(entity));
            let parameters = parts.parameters();
            if parameters.is_err() {
                row.parameters = Parameters::NONE;
            }
            let found = parameters.and_then(|parameters| {
                if !parameters.is_held_like(&row.parameters) {
                    // What is remembered belongs to other ends.
                    row.memory.places = [None; 2];
                    row.memory.scales = [None; 2];
                }
                row.change(|row| row.parameters = parameters);
                parameters.check()?;
                let mut companion = companions.of(entity, &parameters)?;
                if companion.guide != row.companion.guide {
                    row.memory.places = [None; 2];
                }
                let guide = companion.guide;
                let found = finder.find(&parameters, guide, &mut row.memory.scales, modified)?;
                if let Some(tuning) = companions.tuning(entity) {
                    let mut tuned = parameters;
                    finder.tune(tuning, guide, &found.places, &mut tuned)?;
                    tuned.check()?;
                    companion = companions.of(entity, &tuned)?;
                    row.parameters = tuned;
                    row.tuned = true;
                }
                row.change(|row| row.companion = companion);
                Ok(found)
            });
            row.changed |= parts.is_changed() || companions.touched.contains(&entity);
            row.trouble.set_lasting(found.as_ref().err().copied());
            report(&mut row, commands);
            let index = self.elements.len();
            self.row_of.insert(entity, index);
            if row.changed {
                self.changed.push(index);
            }
            if found.is_err() {
                self.faulty.push(index);
            }
            self.elements.push(row);
            found_all.push(found.ok());
        }
        self.enter_bodies(&found_all, &known, modified);
        for (index, (row, found)) in self.elements.iter_mut().zip(&found_all).enumerate() {
            let Some(found) = found else { continue };
            for end in 0..2 {
                row.hold(end, &found.places[end], &self.index);
                if row.watched[end] {
                    self.followed.push((index, end));
                }
                if let (Place::OnBody { entity, .. }, None) = (found.places[end], row.on[end]) {
                    self.walls.insert(entity);
                }
            }
            for body in row.on.iter().flatten() {
                let body = &mut self.bodies[*body as usize];
                body.elements += 1;
                body.signature = body.signature.wrapping_add(mix(row.entity.to_bits()));
            }
        }
        for body in &mut self.bodies {
            let before = known.body(body.entity).map(|row| row.signature);
            body.disturbed |= before != Some(body.signature);
        }
        self.immovable = self
            .elements
            .iter()
            .any(|row| row.trouble.lasting().is_none() && row.moves() == 0);
        self.groups.find(&self.elements, &self.bodies);
        self.groups
            .furnish(&mut self.assemblies, &self.elements, &self.bodies);
        known.clear();
        self.known = known;
    }

    /// Rows of all movable bodies.
    fn enter_bodies(&mut self, found: &[Option<Found>], known: &Known, modified: &EntityHashSet) {
        for found in found.iter().flatten() {
            for (place, turns) in found.places.iter().zip(found.turns) {
                let (
                    Place::OnBody {
                        entity,
                        handle,
                        context,
                        ..
                    },
                    Some(turns),
                ) = (*place, turns)
                else {
                    continue;
                };
                let slot = *self.index.entry(entity).or_insert_with(|| {
                    let mut row = BodyRow::new(entity, handle, context);
                    if let Some(known) = known.body(entity).filter(|k| k.handle == handle) {
                        row = BodyRow {
                            turns: false,
                            elements: 0,
                            signature: 0,
                            context,
                            ..*known
                        };
                    }
                    row.disturbed |= modified.contains(&entity);
                    self.bodies.push(row);
                    self.bodies.len() - 1
                });
                self.bodies[slot].turns |= turns;
            }
        }
        self.bodies.sort_by_key(|row| row.entity);
        for (slot, row) in self.bodies.iter().enumerate() {
            self.index.insert(row.entity, slot);
        }
    }
}

impl ElementRow {
    /// An inert row, with what is known of the element.
    fn fresh(entity: Entity, known: Option<&Self>) -> Self {
        let mut row = Self {
            entity,
            parameters: Parameters::NONE,
            companion: Companion::default(),
            ledger: default(),
            held: [Held::NOWHERE; 2],
            watched: [true; 2],
            on: [None; 2],
            placed: false,
            trouble: Trouble::default(),
            changed: true,
            captured: false,
            tuned: false,
            active: false,
            memory: Memory::default(),
            inverse_mass: 0.0,
            outcome: default(),
        };
        if let Some(known) = known {
            row.parameters = known.parameters;
            row.companion = known.companion.clone();
            row.ledger = known.ledger;
            row.trouble = known.trouble.clone();
            row.memory = known.memory;
            row.changed = false;
            if known.trouble.lasting().is_some() {
                // Where its ends were when it last acted would make a leap of today's place.
                row.memory.places = [None; 2];
            }
        }
        row
    }

    /// Holds an end where it was found.
    fn hold(&mut self, end: usize, place: &Place, index: &EntityHashMap<usize>) {
        self.held[end] = match *place {
            Place::OnBody {
                entity,
                handle,
                context,
                local,
            } => {
                let direct = entity == self.parameters.ends[end];
                self.watched[end] = !direct || self.parameters.anchors[end] != Vec3::ZERO;
                self.on[end] = index.get(&entity).map(|index| *index as u32);
                Held::Body {
                    handle,
                    context,
                    local,
                    movable: self.on[end].is_some(),
                }
            }
            Place::Point(to) => Held::Path {
                from: self.memory.places[end].unwrap_or(to),
                to,
            },
        };
    }
}

/// Spreads an entity's bits, so that sums of them tell sets apart.
pub(super) fn mix(bits: u64) -> u64 {
    let x = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb)
}
