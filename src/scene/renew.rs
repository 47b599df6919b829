//! Makes the rows of all elements and bodies anew, and keeps what is remembered of both.

use crate::backend::{Finder, Found, Place, Stance};
use crate::dynamics::guide::Guide;
use crate::element::{Preload, SpringTuning};
use crate::input::check::{Fault, Parameters, Ties};
use crate::input::companions::{Companion, Companions};
use crate::input::parts::{Acts, Parts, PartsItem};
use crate::scene::lone;
use crate::scene::report::{forget, report};
use crate::scene::rows::{BodyFlags, BodyRow, ElementFlags, ElementRow, Held, mix};
use crate::scene::state::Scene;
use crate::scene::wanted::WantedBody;
use bevy::ecs::entity::EntityHashSet;
use bevy::platform::collections::HashSet;
use bevy::prelude::*;
use std::mem::take;

impl Scene {
    /// Makes all rows anew. Bodies are in the order of their entities. The order of elements within a component does not depend
    /// on the order in which they were spawned.
    pub(crate) fn renew(
        &mut self,
        elements: &Query<Parts, Acts>,
        companions: &Companions,
        finder: &mut impl Finder,
        modified: &EntityHashSet,
        commands: &mut Commands,
    ) {
        let mut found_all = Vec::with_capacity(self.elements.len());
        if self.elements.is_empty() {
            self.elements.reserve_exact(elements.iter().len());
        }
        self.changed.clear();
        self.faulty.clear();
        self.followed.clear();
        self.walls.clear();
        for (index, parts) in elements.iter().enumerate() {
            let is_new = self.place_row(parts.entity, index);
            let row = &mut self.elements[index];
            if parts.told {
                row.trouble.recall();
            }
            // A change while the context is not stepped still has to act.
            let waits =
                row.has(ElementFlags::CHANGED) && !row.has_acted(&self.bodies, &self.stepped);
            let changed = waits
                || is_new
                || companions.is_new(&parts)
                || companions.touched.contains(&parts.entity);
            row.flags.set(ElementFlags::CHANGED, changed);
            let held_by = row.rare.ties;
            let found = row.read_anew(&parts, companions, finder, modified, commands);
            row.trouble.set_lasting(found.as_ref().err().copied());
            report(row, commands);
            if changed {
                self.changed.push(index as u32);
            }
            if found.is_err() {
                self.faulty.push(index as u32);
            }
            let elsewhere = found.as_ref().is_ok_and(|found| row.is_elsewhere(found));
            if found.is_err() || elsewhere || !held_by.acts_like(&row.rare.ties) {
                self.left.extend(row.take_inside());
            }
            found_all.push(found.ok());
        }
        for mut gone in self.elements.drain(found_all.len()..) {
            self.row_of.remove(&gone.entity);
            if gone.trouble.is_told() {
                forget(gone.entity, commands);
            }
            self.left.extend(gone.take_inside());
        }
        self.number_new();
        let (signatures, held) = self.enter_bodies(&found_all, modified);
        self.hold_ends(&found_all, &held);
        self.notice_other_elements(&signatures);
        self.leave_what_moves_nothing();
        self.groups.find(&self.elements, &self.bodies);
        self.number_groups();
        self.awaited = self.elements.iter().any(ElementRow::awaits_step);
    }

    /// Gives numbers to new elements, in the order of their entities.
    fn number_new(&mut self) {
        let rows = self.elements.iter_mut();
        let mut new: Vec<_> = rows.filter(|row| row.rare.serial == 0).collect();
        new.sort_unstable_by_key(|row| row.entity);
        for row in new {
            self.last_serial = self.last_serial.saturating_add(1);
            row.rare.serial = self.last_serial;
        }
    }

    /// Connects rows of elements with the rows of their bodies. `held` has the row index of the body at each end.
    fn hold_ends(&mut self, found_all: &[Option<Found>], held: &[Option<u32>]) {
        for (index, (row, found)) in self.elements.iter_mut().zip(found_all).enumerate() {
            let Some(found) = found else { continue };
            for end in 0..2 {
                row.hold(end, &found.places[end], held[2 * index + end]);
                if row.is_watched(end) {
                    self.followed.push((index as u32, end as u8));
                }
                if let (Place::OnBody { entity, .. }, None) = (found.places[end], row.movable(end))
                {
                    self.walls.insert(entity);
                }
            }
            let plain = row.rare.guide == Guide::Centres && row.movable(0) != row.movable(1);
            row.flags.set(ElementFlags::IS_PLAIN, plain);
            for body in row.all_movable() {
                let rare = &mut self.bodies[body].rare;
                rare.signature = rare.signature.wrapping_add(mix(row.entity.to_bits()));
            }
        }
    }

    /// Marks the bodies whose set of elements has changed. `before` are the earlier signatures of the bodies.
    fn notice_other_elements(&mut self, before: &[u64]) {
        for (body, before) in self.bodies.iter_mut().zip(before) {
            if *before != body.rare.signature {
                body.flags.insert(BodyFlags::DISTURBED);
                // Other elements may push the body elsewhere, so contacts must be looked for again.
                body.clear = 0;
            }
        }
    }

    /// Cleans up elements that move no body any more and therefore are in no component.
    fn leave_what_moves_nothing(&mut self) {
        for row in &mut self.elements {
            if row.moves() == 0 {
                self.left.extend(row.take_inside());
                // The element is not solved, so it cannot have a fault from solving.
                row.trouble.set_passing(None);
            }
        }
        self.immovable = self
            .elements
            .iter()
            .any(|row| row.trouble.lasting().is_none() && row.moves() == 0);
    }

    /// Stores in each body the index of its component, and gives components their assemblies.
    pub(crate) fn number_groups(&mut self) {
        self.handles.clear();
        for (g, group) in self.groups.list().iter().enumerate() {
            for (slot, b) in self.groups.members(group).bodies.iter().enumerate() {
                let row = &mut self.bodies[*b as usize];
                (row.rare.group, row.rare.slot) = (g as u32, slot as u32);
                self.handles.insert(row.rare.context, row.id, *b);
            }
        }
        self.groups
            .assign_assemblies(&mut self.assemblies, &self.elements, &self.bodies);
        self.list_lone();
        self.touch_changed = true;
    }

    /// Lists the elements that need no assembly.
    pub(crate) fn list_lone(&mut self) {
        let groups = self.groups.list();
        let group = |row: &ElementRow| {
            let body = row.all_movable().next()?;
            groups.get(self.bodies[body].rare.group as usize)
        };
        self.lone = lone::list(&self.elements, &self.bodies, |row| {
            group(row).is_some_and(|group| group.assembly.is_none())
        });
    }

    /// Moves the row of an element to `index`. All rows before it must be in place already. Makes a row for a new
    /// element. Returns whether the element is new.
    fn place_row(&mut self, entity: Entity, index: usize) -> bool {
        let rows = &mut self.elements;
        if rows.get(index).is_some_and(|row| row.entity == entity) {
            return false;
        }
        let known = self.row_of.get(&entity).map(|from| *from as usize);
        let from = known.unwrap_or_else(|| {
            rows.push(ElementRow::new(entity));
            rows.len() - 1
        });
        rows.swap(index, from);
        self.row_of.insert(rows[from].entity, from as u32);
        self.row_of.insert(entity, index as u32);
        known.is_none()
    }

    /// Makes the rows of all movable bodies. The row of a body that is still the same is kept. Returns for each body a hash of
    /// the elements that acted on it before, and for each end of each element the row index of the body that it moves.
    fn enter_bodies(
        &mut self,
        found_all: &[Option<Found>],
        modified: &EntityHashSet,
    ) -> (Vec<u64>, Vec<Option<u32>>) {
        let found = found_all.iter().enumerate();
        let mut wanted: Vec<_> = found
            .filter_map(|(element, found)| Some(WantedBody::of(element, found.as_ref()?)))
            .flatten()
            .collect();
        wanted.sort_unstable_by_key(|body| body.entity);
        let held = WantedBody::rows(&wanted, found_all.len());
        wanted.dedup_by(|again, first| {
            let same = again.entity == first.entity;
            first.turns |= same && again.turns;
            same
        });
        let mut rows = self.bodies.iter().zip(&wanted);
        if wanted.len() != self.bodies.len() || !rows.all(|(row, body)| body.is(row)) {
            self.replace_bodies(&wanted);
        }
        let rows = self.bodies.iter_mut().zip(&wanted);
        let signatures = rows.map(|(row, body)| {
            row.flags.set(BodyFlags::TURNS, body.turns);
            row.rare.center = body.center;
            if modified.contains(&row.entity) {
                row.flags.insert(BodyFlags::DISTURBED);
            }
            // A new body has no earlier signature. It is marked as disturbed anyway.
            take(&mut row.rare.signature)
        });
        (signatures.collect(), held)
    }

    /// Replaces the rows of bodies. If no element moves a body any more, its changed settings are stored, to be restored later.
    fn replace_bodies(&mut self, wanted: &[WantedBody]) {
        let before = take(&mut self.bodies);
        // Of bodies of one rank, that of the least entity comes first, and from then on it does so in every world.
        let mut ranks: HashSet<u64> = before.iter().map(|row| row.rare.rank).collect();
        let mut before = before.into_iter().peekable();
        let mut gone = Vec::new();
        self.bodies.reserve_exact(wanted.len());
        for body in wanted {
            while let Some(row) = before.next_if(|row| row.entity < body.entity) {
                gone.push(row);
            }
            let row = before.next_if(|row| row.entity == body.entity);
            let same = row.filter(|row| body.is(row));
            self.bodies.push(same.unwrap_or_else(|| {
                let mut row = BodyRow::new(body.entity, body.id, body.context);
                row.rare.rank = body.rank;
                while !ranks.insert(row.rare.rank) {
                    row.rare.rank = row.rare.rank.wrapping_add(1);
                }
                row
            }));
        }
        let raised = gone.into_iter().chain(before);
        let raised = raised.filter(|row| row.rare.raised.is_any());
        self.unloaded
            .extend(raised.map(|row| (row.rare.context, row.id, row.rare.raised)));
    }
}

impl ElementRow {
    /// Whether its joints in the engine's solver are in another context than one of its ends.
    fn is_elsewhere(&self, found: &Found) -> bool {
        let inside = self.inside.as_ref().and_then(|inside| inside.context);
        let is_other = |place: &Place| matches!(place, Place::OnBody { context, .. } if Some(*context) != inside);
        inside.is_some() && found.places.iter().any(is_other)
    }

    /// Forgets what is no longer valid after ends, anchors or the axis have changed. On the same ends, the places of its ends are kept, because an end
    /// without a body has no other speed than the way from its last place.
    fn retie(&mut self, ties: &Ties, finder: &impl Finder) {
        let known = self.rare.ties;
        if ties.is_held_like(&known) {
            return;
        }
        self.set_direction(None);
        let rare = &mut *self.rare;
        if !ties.turns_like(&known) {
            rare.places = [None; 2];
            rare.scales = [None; 2];
            rare.angle = 0.0;
            rare.leapt = false;
            return;
        }
        rare.leapt = ties.twist.is_none();
        for end in 0..2 {
            let mut scale = rare.scales[end];
            let mut at = |anchor| {
                let field = ties.names.ends[end];
                finder.place(ties.ends[end], anchor, field, &mut scale)
            };
            let found = (at(known.anchors[end]), at(ties.anchors[end]));
            if let (Ok(Place::Point(before)), Ok(Place::Point(now))) = found
                && let Some(place) = &mut rare.places[end]
            {
                // The new anchor is not a motion of the end.
                *place += now - before;
            }
        }
    }

    /// Reads the components of an element as if it were new. Returns where its ends are, or its fault.
    fn read_anew(
        &mut self,
        parts: &PartsItem,
        companions: &Companions,
        finder: &mut impl Finder,
        modified: &EntityHashSet,
        commands: &mut Commands,
    ) -> Result<Found, Fault> {
        let entity = parts.entity;
        // Whether its coefficients were computed in an earlier tick and there was no step since.
        let waits = self.has(ElementFlags::TUNED);
        let was_on_body = self.rare.held.map(|held| matches!(held, Held::Body { .. }));
        self.reset();
        let parameters = parts
            .parameters()
            .inspect_err(|_| self.set_parameters(Parameters::NONE))?;
        self.retie(&parameters.ties, &*finder);
        if parameters != self.parameters() || companions.touched.contains(&entity) {
            self.flags.insert(ElementFlags::REFITTED);
        }
        self.change(|row| row.set_parameters(parameters));
        parameters.check()?;
        let mut companion = companions.of(entity, &parameters)?;
        let guide = companion.guide;
        if guide != self.rare.guide {
            // It is not kept up to date along an axis.
            self.set_direction(None);
            self.rare.leapt = true;
        }
        let found = finder.find(&parameters, guide, &mut self.rare.scales, modified)?;
        for (end, was_on_body) in was_on_body.into_iter().enumerate() {
            if was_on_body && matches!(found.places[end], Place::Point(_)) {
                // The place is a point of a body that is gone, and no path leads from there.
                self.rare.places[end] = None;
            }
        }
        let stance = Stance {
            guide,
            places: &found.places,
            angle: self.rare.angle,
        };
        if let Some(tuning) = companions.tuning(entity) {
            companion = self.tune(tuning, &stance, waits, companions, finder)?;
        } else {
            self.flags.remove(ElementFlags::TUNED_AGAIN);
        }
        if let Some(pose) = companions.pose(entity) {
            let (held, preload) =
                companions.hold(entity, pose, &self.parameters(), &stance, finder)?;
            companion = held;
            // A component that is written counts as changed, and what changed is read anew in the next tick.
            if companions.written_preload(entity) != Some(preload) {
                commands.entity(entity).try_insert(Preload(preload));
            }
            self.flags.insert(ElementFlags::POSED);
        }
        self.change(|row| row.set_companion(companion));
        Ok(found)
    }

    /// Computes its coefficients. `waits` tells whether they were computed in an earlier tick and there was no step since. Returns
    /// what its companions make of it then.
    fn tune(
        &mut self,
        tuning: SpringTuning,
        stance: &Stance,
        waits: bool,
        companions: &Companions,
        finder: &impl Finder,
    ) -> Result<Companion, Fault> {
        let mut tuned = self.parameters();
        let allowed = companions.allowance(self.entity);
        let can_touch = finder.tune(tuning, stance, allowed, &mut tuned)?;
        tuned.check()?;
        let companion = companions.of(self.entity, &tuned)?;
        self.change(|row| row.set_parameters(tuned));
        let again = can_touch && self.has(ElementFlags::TUNED_AGAIN) == waits;
        self.flags.insert(ElementFlags::TUNED);
        self.flags.set(ElementFlags::TUNED_AGAIN, again);
        Ok(companion)
    }
}
