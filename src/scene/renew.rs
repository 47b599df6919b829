//! All rows anew: elements and bodies entered, what was known of both carried over.

use crate::backend::{Finder, Found, Place};
use crate::element::{HoldPose, Preload};
use crate::input::check::{Fault, Parameters};
use crate::input::companions::Companions;
use crate::input::parts::{Acts, Parts, PartsItem};
use crate::scene::report::report;
use crate::scene::rows::{BodyRow, ElementRow, mix};
use crate::scene::scratch::{Scratch, Wanted};
use crate::scene::state::Scene;
use bevy::ecs::entity::EntityHashSet;
use bevy::prelude::*;
use std::mem::{swap, take};

impl Scene {
    /// Makes all rows anew. Bodies stand in the order of their entities, and within a component elements
    /// in an order of their own, so that the order in which elements were spawned changes nothing.
    pub(crate) fn renew(
        &mut self,
        elements: &Query<Parts, Acts>,
        companions: &Companions,
        finder: &mut impl Finder,
        modified: &EntityHashSet,
        commands: &mut Commands,
    ) {
        let mut scratch = take(&mut self.scratch);
        self.changed.clear();
        self.faulty.clear();
        self.followed.clear();
        self.walls.clear();
        for (index, parts) in elements.iter().enumerate() {
            let is_new = self.place_row(parts.entity, index);
            let row = &mut self.elements[index];
            // What changed while nothing was stepped has yet to act.
            row.changed &= !row.has_acted(&self.bodies, &self.stepped);
            row.changed |= is_new || companions.is_new(&parts);
            row.changed |= companions.touched.contains(&parts.entity);
            let held_by = row.parameters;
            let found = row.read_anew(&parts, companions, finder, modified, commands);
            row.trouble.set_lasting(found.as_ref().err().copied());
            report(row, commands);
            if row.changed {
                self.changed.push(index);
            }
            if found.is_err() {
                self.faulty.push(index);
            }
            if found.is_err() || !held_by.is_held_like(&row.parameters) {
                self.left.extend(row.take_inside());
            }
            scratch.found.push(found.ok());
        }
        for mut gone in self.elements.drain(scratch.found.len()..) {
            self.row_of.remove(&gone.entity);
            self.left.extend(gone.take_inside());
        }
        self.enter_bodies(&mut scratch, modified);
        self.let_bodies_go(&scratch);
        self.hold_ends(&scratch);
        self.leave_what_moves_nothing();
        self.groups.find(&self.elements, &self.bodies);
        self.number_groups();
        scratch.clear();
        self.scratch = scratch;
    }

    /// Notes what bodies that no element moves any more have besides forces.
    fn let_bodies_go(&mut self, scratch: &Scratch) {
        let entered = |body: &&BodyRow| self.index.contains_key(&body.entity);
        let gone = scratch.bodies.iter().filter(|body| !entered(body));
        let raised = gone.filter(|row| row.raised.is_any());
        self.unloaded
            .extend(raised.map(|row| (row.context, row.id, row.raised)));
    }

    /// Ties rows of elements to those of their bodies.
    fn hold_ends(&mut self, scratch: &Scratch) {
        let found_all = self.elements.iter_mut().zip(&scratch.found);
        for (index, (row, found)) in found_all.enumerate() {
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
        for (body, wanted) in self.bodies.iter_mut().zip(&scratch.wanted) {
            if wanted.signature != body.signature {
                body.disturbed = true;
                // Other elements may push it elsewhere.
                body.clear = 0;
            }
        }
    }

    /// What moves nothing any more is in no component.
    fn leave_what_moves_nothing(&mut self) {
        for row in &mut self.elements {
            if row.moves() == 0 {
                self.left.extend(row.take_inside());
            }
        }
        self.immovable = self
            .elements
            .iter()
            .any(|row| row.trouble.lasting().is_none() && row.moves() == 0);
    }

    /// Tells bodies of their components, and gives these what they are solved in.
    pub(crate) fn number_groups(&mut self) {
        self.handles.clear();
        for (g, group) in self.groups.list().iter().enumerate() {
            for (slot, b) in self.groups.members(group).bodies.iter().enumerate() {
                let row = &mut self.bodies[*b];
                (row.group, row.slot) = (g as u32, slot);
                self.handles.insert((row.context, row.id), *b as u32);
            }
        }
        self.groups
            .assign_assemblies(&mut self.assemblies, &self.elements, &self.bodies);
    }

    /// Brings the row of an element to its place, after all those before it; says whether it is a new one.
    fn place_row(&mut self, entity: Entity, index: usize) -> bool {
        let rows = &mut self.elements;
        if rows.get(index).is_some_and(|row| row.entity == entity) {
            return false;
        }
        let known = self.row_of.get(&entity).copied();
        let from = known.unwrap_or_else(|| {
            rows.push(ElementRow::new(entity));
            rows.len() - 1
        });
        rows.swap(index, from);
        self.row_of.insert(rows[from].entity, from);
        self.row_of.insert(entity, index);
        known.is_none()
    }

    /// Rows of all movable bodies: those that there are, if they are still the same.
    fn enter_bodies(&mut self, scratch: &mut Scratch, modified: &EntityHashSet) {
        let Scratch {
            found,
            bodies,
            wanted,
        } = scratch;
        for found in found.iter().flatten() {
            wanted.extend(Wanted::of(found));
        }
        wanted.sort_unstable_by_key(|body| body.entity);
        wanted.dedup_by(|again, first| {
            let same = again.entity == first.entity;
            first.turns |= same && again.turns;
            same
        });
        let is_same =
            |(row, body): (&BodyRow, &Wanted)| row.entity == body.entity && row.id == body.id;
        if wanted.len() != self.bodies.len() || !self.bodies.iter().zip(&*wanted).all(is_same) {
            swap(&mut self.bodies, bodies);
            self.index.clear();
            let mut before = bodies.iter().peekable();
            for (slot, body) in wanted.iter().enumerate() {
                while before.next_if(|row| row.entity < body.entity).is_some() {}
                let row = before.next_if(|row| row.entity == body.entity);
                let fresh = BodyRow {
                    rank: body.rank,
                    ..BodyRow::new(body.entity, body.id, body.context)
                };
                let same = row.filter(|row| row.id == body.id);
                self.bodies.push(same.copied().unwrap_or(fresh));
                self.index.insert(body.entity, slot);
            }
        }
        for (row, body) in self.bodies.iter_mut().zip(wanted) {
            // A new one is disturbed anyway.
            body.signature = take(&mut row.signature);
            row.turns = body.turns;
            row.elements = 0;
            row.context = body.context;
            row.disturbed |= modified.contains(&row.entity);
        }
    }
}

impl ElementRow {
    /// Reads an element's components as if it were new; says where its ends are, or what is wrong with it.
    fn read_anew(
        &mut self,
        parts: &PartsItem,
        companions: &Companions,
        finder: &mut impl Finder,
        modified: &EntityHashSet,
        commands: &mut Commands,
    ) -> Result<Found, Fault> {
        let entity = parts.entity;
        self.reset();
        let parameters = parts
            .parameters()
            .inspect_err(|_| self.parameters = Parameters::NONE)?;
        if !parameters.is_held_like(&self.parameters) {
            // What is remembered belongs to other ends.
            self.memory.places = [None; 2];
            self.memory.scales = [None; 2];
            self.memory.direction = None;
            self.memory.angle = 0.0;
        }
        self.refitted |= parameters != self.parameters || companions.touched.contains(&entity);
        self.change(|row| row.parameters = parameters);
        parameters.check()?;
        let mut companion = companions.of(entity, &parameters)?;
        if companion.guide != self.companion.guide {
            self.memory.places = [None; 2];
        }
        let guide = companion.guide;
        let found = finder.find(&parameters, guide, &mut self.memory.scales, modified)?;
        if let Some(tuning) = companions.tuning(entity) {
            let mut tuned = parameters;
            let can_touch = finder.tune(tuning, guide, &found.places, &mut tuned)?;
            tuned.check()?;
            companion = companions.of(entity, &tuned)?;
            self.parameters = tuned;
            self.tuned = true;
            self.tuned_again = can_touch && !self.tuned_again;
        }
        if let Some(pose) = companions.pose(entity) {
            let places = &found.places;
            let held = companions.hold(entity, pose, &self.parameters, guide, places, finder)?;
            companion = held.0;
            let mut element = commands.entity(entity);
            element.try_insert(Preload(held.1));
            if !self.tuned_again {
                element.try_remove::<HoldPose>();
            }
        }
        self.change(|row| row.companion = companion);
        Ok(found)
    }
}
