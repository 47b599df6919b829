//! Restores a scene from the data of a snapshot: makes all rows anew from the components, then fills in what was remembered.

use super::anew::engine_went_back;
use crate::backend::rapier::body::id;
use crate::backend::rapier::find::RapierFinder;
use crate::backend::rapier::forces::SpringLoad;
use crate::backend::rapier::held::add_up;

use crate::element::SpringTuning;
use crate::input::companions::Companions;
use crate::input::parts::{Acts, Parts};
use crate::readout::SpringReadout;
use crate::scene::kept::{Kept, KeptElement, NONE};
use crate::scene::rows::{BodyFlags, BodyRow, ElementFlags, ElementRow};
use crate::scene::state::Scene;
use crate::snapshot::SnapshotError;
use bevy::ecs::entity::{EntityHashMap, EntityHashSet};
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::ecs::system::SystemState;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use std::mem::take;

/// The system parameters that are needed to make rows.
type Sources<'w, 's> = (
    Query<'w, 's, Parts, Acts>,
    Companions<'w, 's>,
    RapierFinder<'w, 's>,
    Commands<'w, 's>,
);

impl Kept {
    /// Restores the springs of a world to the state of the snapshot.
    pub(crate) fn put(&self, world: &mut World) -> Result<(), SnapshotError> {
        let engine_went_back = engine_went_back(world);
        let mut kept = self.clone();
        kept.mend();
        kept.name_contexts(world);
        let fits = kept.check(world, engine_went_back);
        if fits.is_err() && engine_went_back {
            kept.begin_anew(world);
        }
        fits?;
        let Some(mut scene) = world.remove_resource::<Scene>() else {
            return Err(SnapshotError::NoPlugin);
        };
        kept.place_rows(&mut scene, world);
        let mut sources = SystemState::<Sources>::new(world);
        if let Ok((elements, companions, mut finder, mut commands)) = sources.get_mut(world) {
            let modified = EntityHashSet::default();
            scene.renew(
                &elements,
                &companions,
                &mut finder,
                &modified,
                &mut commands,
            );
            kept.fill_elements(&mut scene, &companions);
        }
        sources.apply(world);
        kept.fill_bodies(&mut scene);
        kept.fill_groups(&mut scene);
        kept.fill_scene(&mut scene);
        kept.leave_faulty(&mut scene, world);
        if !kept.engine_stays {
            kept.take_share(world, |body| scene.body_row(body).is_none());
        }
        kept.show(&scene, world);
        // Elements may act on other bodies now than in the snapshot. These get their loads with new rows.
        let has_none = |row: &BodyRow| world.get::<SpringLoad>(row.entity).is_none();
        scene.stale |= scene.bodies.iter().any(has_none);
        // Everything written so far belongs to the restored state. Only later writes count as changes.
        scene.since = Some(world.change_tick());
        world.insert_resource(scene);
        world.increment_change_tick();
        Ok(())
    }

    /// If world and snapshot each have only one context, replaces the snapshot's context entity by the world's.
    fn name_contexts(&mut self, world: &mut World) {
        let mut contexts = world.query_filtered::<Entity, With<RapierContextSimulation>>();
        let mut contexts = contexts.iter(world);
        if let ([known], Some(only), None) =
            (&mut self.contexts[..], contexts.next(), contexts.next())
        {
            let left = self.left.iter_mut().map(|(context, _)| context);
            let unloaded = self.unloaded.iter_mut().map(|(context, ..)| context);
            for context in left.chain(unloaded).filter(|c| **c == known.entity) {
                *context = only;
            }
            known.entity = only;
        }
    }

    /// Makes the rows of the snapshot's elements and bodies, before their ends are found.
    fn place_rows(&mut self, scene: &mut Scene, world: &World) {
        if !self.engine_stays {
            scene.left.clear();
            // Making the rows anew adds bodies whose elements have a fault now.
            scene.unloaded.clone_from(&self.unloaded);
        }
        let mut before = EntityHashMap::default();
        for mut row in scene.elements.drain(..) {
            let inside = row.take_inside();
            scene.left.extend(inside.filter(|_| self.engine_stays));
            before.insert(row.entity, row);
        }
        scene.row_of.clear();
        let serials = self.elements.iter().map(|kept| kept.memory.serial);
        scene.last_serial = serials.max().unwrap_or(0);
        for (index, kept) in self.elements.iter().enumerate() {
            let mut row = ElementRow::new(kept.entity);
            if let Some(before) = before.remove(&kept.entity) {
                // Faults that were reported are not reported again.
                row.trouble = before.trouble;
                row.flags
                    .insert(before.flags & ElementFlags::TOLD_UNRESOLVED);
            }
            kept.memory.put(&mut row);
            scene.row_of.insert(kept.entity, index as u32);
            scene.elements.push(row);
        }
        let lent = scene.bodies.drain(..);
        let lent = lent.map(|row| (row.entity, (row.rare.context, row.id, row.rare.raised)));
        let mut lent: EntityHashMap<_> = lent.filter(|_| self.engine_stays).collect();
        for kept in &self.bodies {
            let place = world.get_entity(kept.entity).ok().and_then(|body| {
                let handle = body.get::<RapierRigidBodyHandle>()?.0;
                Some((id(handle), body.get::<RapierContextEntityLink>()?.0))
            });
            if let Some((id, context)) = place {
                let mut row = kept.row(id, context);
                if self.engine_stays {
                    let lent = lent.remove(&kept.entity);
                    row.rare.raised = lent.map(|lent| lent.2).unwrap_or_default();
                }
                scene.bodies.push(row);
            }
        }
        let others = lent.values().filter(|(_, _, raised)| raised.is_any());
        scene.unloaded.extend(others.copied());
        scene.bodies.sort_by_key(|row| row.entity);
        scene.assemblies.clear();
        scene.stale = false;
        scene.touched.clear();
        if take(&mut scene.undisturbed) {
            scene.disturbed = false;
        }
    }

    fn fill_elements(&self, scene: &mut Scene, companions: &Companions) {
        for kept in &self.elements {
            let Some(index) = scene.row_of.get(&kept.entity) else {
                continue;
            };
            let row = &mut scene.elements[*index as usize];
            let body = row.movable(0).or(row.movable(1));
            let context = body.map(|body| scene.bodies[body].rare.context);
            let differs = kept.fill(row, context);
            let to_find =
                companions.tuning(kept.entity).is_some() || companions.pose(kept.entity).is_some();
            if differs {
                scene.touched.push(kept.entity);
            }
            scene.stale |= to_find;
        }
        let rows = scene.elements.iter().enumerate();
        let changed = rows.filter(|(_, row)| row.has(ElementFlags::CHANGED));
        scene.changed = changed.map(|(index, _)| index as u32).collect();
    }

    fn fill_bodies(&self, scene: &mut Scene) {
        for kept in &self.bodies {
            if let Some(row) = scene.body_row(kept.entity)
                && let Some(row) = scene.bodies.get_mut(row)
            {
                let disturbed = kept.flags.contains(BodyFlags::DISTURBED);
                row.flags.set(BodyFlags::DISTURBED, disturbed);
                row.clear = kept.clear;
            }
        }
        add_up(&scene.elements, &mut scene.bodies);
    }

    /// Restores the order of components and of their members, and the remembered state of each component.
    fn fill_groups(&self, scene: &mut Scene) {
        let mut elements = vec![NONE; scene.elements.len()];
        for (place, kept) in self.elements.iter().enumerate() {
            if let Some(index) = scene.row_of.get(&kept.entity) {
                elements[*index as usize] = place as u32;
            }
        }
        let mut bodies = vec![NONE; scene.bodies.len()];
        for (place, kept) in self.bodies.iter().enumerate() {
            if let Some(index) = scene.body_row(kept.entity) {
                bodies[index] = place as u32;
            }
        }
        scene.groups.arrange(&elements, &bodies, &scene.elements);
        scene.assemblies.clear();
        scene.number_groups();
        for kept in &self.groups {
            let body = self.bodies.get(kept.body as usize);
            let row = body.and_then(|body| scene.body_row(body.entity));
            let Some(g) = row.map(|row| scene.bodies[row].rare.group as usize) else {
                continue;
            };
            if g >= scene.groups.list().len() {
                continue;
            }
            scene.groups.set_held(g, kept.held, &mut scene.elements);
            let group = scene.groups.at(g);
            group.is_asleep = kept.is_asleep;
            if let Some(remembered) = &kept.assembly {
                if group.assembly.is_none() {
                    scene.groups.promote(g, &mut scene.assemblies);
                }
                if let Some(index) = scene.groups.list()[g].assembly {
                    scene.assemblies[index as usize]
                        .component
                        .remember(remembered);
                }
            }
        }
    }

    fn fill_scene(&self, scene: &mut Scene) {
        // Some lone elements now have an assembly.
        scene.list_lone();
        scene.time = self.time;
        let stepped = self.contexts.iter().filter(|context| context.stepped);
        scene.stepped.worlds = stepped.map(|context| context.entity).collect();
        if !self.engine_stays {
            let sweeps = self.contexts.iter();
            scene.sweeps = sweeps
                .map(|context| (context.entity, context.sweeps))
                .collect();
            let left = self.left.iter();
            scene.left = left
                .map(|(context, inside)| (*context, inside.put(*context)))
                .collect();
        }
        scene.still = default();
        // Also if there are elements or bodies that the snapshot does not contain.
        scene.stale |=
            scene.elements.len() != self.elements.len() || scene.bodies.len() != self.bodies.len();
        (scene.renewed, scene.shifted) = (false, false);
        (scene.loaded, scene.delivered) = (false, false);
        // Otherwise rows would be made anew after the next step if their order differs from that of the readouts.
        scene.unordered = true;
    }

    /// Makes the next step remove the joints and hidden bodies of elements that have a fault now.
    fn leave_faulty(&self, scene: &mut Scene, world: &World) {
        for kept in self.elements.iter().filter(|_| !self.engine_stays) {
            let row = scene.row_of.get(&kept.entity);
            let row = row.map(|i| &scene.elements[*i as usize]);
            if let Some(inside) = kept.inside.as_deref()
                && row.is_none_or(|row| row.inside.is_none())
                && let Some(context) = self.context_of(kept, world)
            {
                scene.left.push((context, inside.put(context)));
            }
        }
    }

    /// Writes readouts, rest lengths and force shares into the components of elements and bodies.
    fn show(&self, scene: &Scene, world: &mut World) {
        for kept in &self.elements {
            if let Some(mut readout) = world.get_mut::<SpringReadout>(kept.entity) {
                readout.set_if_neq(kept.readout);
            }
            let row = scene.row_of.get(&kept.entity);
            let now = row.map(|row| scene.elements[*row as usize].numbers);
            if kept.rest_length.is_some()
                && let Some(rest) = now.and_then(|numbers| numbers.rest_length)
                && !kept.is_provisional(world)
            {
                write_rest(kept.entity, rest, world);
            }
        }
        let mut loads = world.query_filtered::<Entity, (With<SpringLoad>, Allow<Disabled>)>();
        let is_gone = |entity: &Entity| scene.body_row(*entity).is_none();
        let gone: Vec<Entity> = loads.iter(world).filter(is_gone).collect();
        for entity in gone {
            let mut body = world.entity_mut(entity);
            let user = body.take::<SpringLoad>().map(|load| load.user);
            if let (Some(user), Some(mut force)) = (user, body.get_mut::<ExternalForce>()) {
                // An engine that did not go back still has the force of elements. A change makes it read the user's share.
                if self.engine_stays {
                    *force = user;
                } else {
                    *force.bypass_change_detection() = user;
                }
            }
        }
        let now = world.change_tick();
        for kept in &self.bodies {
            if let (Some(slot), Ok(body)) = (
                scene.body_row(kept.entity),
                world.get_entity_mut(kept.entity),
            ) {
                kept.show(slot, body, now);
            }
        }
    }
}

impl KeptElement {
    /// Whether its rest length is computed once more in the next tick, because a sag needs the contacts.
    fn is_provisional(&self, world: &World) -> bool {
        self.flags.contains(ElementFlags::TUNED_AGAIN)
            && matches!(
                world.get::<SpringTuning>(self.entity),
                Some(SpringTuning::Sag { .. })
            )
    }

    /// Fills a row with the remembered state. Returns whether the parameters in its component differ from those that acted last.
    fn fill(&self, row: &mut ElementRow, context: Option<Entity>) -> bool {
        let given = row.numbers;
        let rest = given.rest_length.or(self.rest_length);
        let differs = [given.stiffness, given.damping] != self.numbers || rest != self.rest_length;
        row.numbers = self.numbers_or(given, row.rare.guide);
        row.flags.remove(ElementFlags::KEPT);
        row.flags.insert(self.flags & ElementFlags::KEPT);
        row.ledger = self.ledger;
        self.memory.put(row);
        let inside = self.inside.as_deref();
        row.inside = inside.and_then(|inside| Some(inside.put(context?)));
        differs
    }
}

/// Writes a remembered rest length into a component that has none, so that it is not captured again.
fn write_rest(entity: Entity, rest: f32, world: &mut World) {
    macro_rules! write {
        ($($element:ident.$field:ident),*) => {$(
            if let Some(mut element) = world.get_mut::<crate::element::$element>(entity)
                && element.$field.is_none()
            {
                element.$field = Some(rest);
            }
        )*};
    }
    write!(
        Spring.rest_length,
        SpringDamper.rest_length,
        TorsionSpring.rest_angle, TorsionSpringDamper.rest_angle
    );
}
