//! From the scene.

use crate::backend::Wrench;
use crate::backend::rapier::forces::{SpringLoad, wrench};
use crate::readout::SpringReadout;
use crate::scene::kept::{Kept, KeptBody, KeptContext, KeptElement, KeptGroup, KeptInside, NONE};
use crate::scene::rows::{BodyRow, ElementRow, Memory};
use crate::scene::state::Scene;
use bevy::prelude::*;

impl Kept {
    /// Reads all of it; nothing where there is no plugin.
    pub(crate) fn take(world: &World) -> Self {
        let Some(scene) = world.get_resource::<Scene>() else {
            return Self::default();
        };
        let mut kept = Self {
            time: scene.time,
            unloaded: scene.unloaded.clone(),
            ..Self::default()
        };
        kept.take_contexts(scene);
        kept.bodies.reserve_exact(scene.bodies.len());
        kept.elements.reserve_exact(scene.elements.len());
        // Indices among what is kept.
        let mut places = vec![NONE; scene.bodies.len()];
        for group in scene.groups.list() {
            let members = scene.groups.members(group);
            let first = kept.bodies.len() as u32;
            for index in members.bodies {
                let row = &scene.bodies[*index];
                places[*index] = kept.bodies.len() as u32;
                kept.bodies.push(take_body(row, world));
            }
            let assembly = group.assembly.map(|index| {
                let assembly = &scene.assemblies[index];
                Box::new(assembly.component.remembered())
            });
            if assembly.is_some() || group.held || group.is_asleep {
                kept.groups.push(KeptGroup {
                    body: first,
                    held: group.held,
                    is_asleep: group.is_asleep,
                    assembly,
                });
            }
        }
        let in_groups = scene.groups.list().iter().flat_map(|group| {
            let members = scene.groups.members(group);
            members.elements.iter().copied()
        });
        let mut others = vec![true; scene.elements.len()];
        for index in in_groups {
            others[index] = false;
            let element = take_element(&scene.elements[index], &places, world);
            kept.elements.push(element);
        }
        let others = others.iter().zip(&scene.elements).filter(|(is, _)| **is);
        let others = others.map(|(_, row)| take_element(row, &places, world));
        kept.elements.extend(others);
        kept
    }

    fn take_contexts(&mut self, scene: &Scene) {
        let with_sweeps = scene.sweeps.keys().filter(|c| !scene.stepped.contains(c));
        let all = scene.stepped.iter().chain(with_sweeps);
        self.contexts.extend(all.map(|context| KeptContext {
            entity: *context,
            stepped: scene.stepped.contains(context),
            sweeps: scene.sweeps.get(context).copied().unwrap_or_default(),
        }));
        self.contexts.sort_by_key(|context| context.entity);
        let left = scene.left.iter();
        self.left
            .extend(left.map(|(context, inside)| (*context, KeptInside::of(inside))));
    }
}

fn take_element(row: &ElementRow, places: &[u32], world: &World) -> KeptElement {
    // What is not kept is found anew from the components.
    let ElementRow {
        parameters,
        changed,
        refitted,
        captured,
        tuned,
        tuned_again,
        active,
        watched: _,
        placed: _,
        entity,
        companion: _,
        trouble: _,
        inverse_mass: _,
        outcome: _,
        ledger,
        on,
        memory,
        held: _,
        inside,
    } = row;
    KeptElement {
        entity: *entity,
        on: on.map(|body| body.map_or(NONE, |body| places[body as usize])),
        numbers: [parameters.stiffness, parameters.damping],
        rest_length: parameters.rest_length,
        changed: *changed,
        refitted: *refitted,
        captured: *captured,
        tuned: *tuned,
        tuned_again: *tuned_again,
        active: *active,
        ledger: *ledger,
        readout: world
            .get::<SpringReadout>(*entity)
            .copied()
            .unwrap_or_default(),
        inside: inside
            .as_deref()
            .map(|inside| Box::new(KeptInside::of(inside))),
        memory: Memory {
            // The same numbers give the same coefficients.
            memo: Default::default(),
            ..*memory
        },
    }
}

/// All fields by their names, a line each, so that none of a body is forgotten.
fn take_body(row: &BodyRow, world: &World) -> KeptBody {
    let BodyRow {
        entity,
        id: _,
        turns: _,
        disturbed,
        rests,
        is_alone,
        is_noted,
        is_fresh,
        is_new,
        can_touch,
        jointed,
        touched,
        pressed,
        creeps,
        lingers,
        clear,
        user,
        // Shown in the components when a tick is over.
        share: _,
        carries_share,
        context: _,
        now,
        rest,
        torque: _,
        raised,
        stiffness: _,
        substep,
        group: _,
        slot: _,
        rank,
        elements: _,
        signature: _,
        pulled,
        turned,
    } = *row;
    let load = world.get::<SpringLoad>(entity);
    let both = |wrench: &Wrench| [wrench.force, wrench.torque];
    KeptBody {
        entity,
        rank,
        disturbed,
        rests,
        is_alone,
        is_noted,
        is_fresh,
        is_new,
        can_touch,
        jointed,
        touched,
        pressed,
        creeps,
        carries_share,
        raised_iterations: load.is_some_and(SpringLoad::raised_iterations),
        lingers,
        clear,
        user: both(&user),
        elements: load.map_or_else(Default::default, |load| both(&wrench(&load.elements))),
        now,
        rest,
        raised,
        substep,
        pulled,
        turned,
    }
}
