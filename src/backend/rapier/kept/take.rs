//! Reads the data of a snapshot from the scene.

use crate::backend::Wrench;
use crate::backend::rapier::body::joint_handle;
use crate::backend::rapier::forces::{SpringLoad, wrench};
use crate::readout::SpringReadout;
use crate::scene::kept::{
    Kept, KeptBody, KeptContext, KeptElement, KeptGroup, KeptInside, Memory, NONE,
};
use crate::scene::rows::{BodyFlags, BodyRow, ElementFlags, ElementRow, RareBody, RareElement};
use crate::scene::state::Scene;
use bevy::prelude::*;
use bevy_rapier3d::prelude::RapierContextJoints;

impl Kept {
    /// Reads all data of the scene. Empty if there is no `CoiloverPlugin`.
    pub(crate) fn take(world: &World) -> Self {
        let Some(scene) = world.get_resource::<Scene>() else {
            return Self::default();
        };
        let mut kept = Self {
            time: scene.time,
            unloaded: scene.unloaded.clone(),
            ..Self::default()
        };
        kept.take_contexts(scene, world);
        kept.bodies.reserve_exact(scene.bodies.len());
        kept.elements.reserve_exact(scene.elements.len());
        // For each body row, its index in `kept.bodies`.
        let mut places = vec![NONE; scene.bodies.len()];
        for group in scene.groups.list() {
            let members = scene.groups.members(group);
            let first = kept.bodies.len() as u32;
            for index in members.bodies {
                let index = *index as usize;
                let row = &scene.bodies[index];
                places[index] = kept.bodies.len() as u32;
                kept.bodies.push(take_body(row, world));
            }
            let assembly = group.assembly.map(|index| {
                let assembly = &scene.assemblies[index as usize];
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
            members.elements.iter().map(|e| *e as usize)
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

    fn take_contexts(&mut self, scene: &Scene, world: &World) {
        let with_sweeps = scene
            .sweeps
            .keys()
            .filter(|c| !scene.stepped.worlds.contains(c));
        let all = scene.stepped.worlds.iter().chain(with_sweeps);
        self.contexts.extend(all.map(|context| KeptContext {
            entity: *context,
            stepped: scene.stepped.worlds.contains(context),
            sweeps: scene.sweeps.get(context).copied().unwrap_or_default(),
        }));
        self.contexts.sort_by_key(|context| context.entity);
        let left = scene.left.iter();
        self.left.extend(left.map(|(context, inside)| {
            let mut inside = KeptInside::of(inside);
            // Rapier removes joints with their bodies. In a pause, the rest of what is left stays in the engine.
            let joints = world.get::<RapierContextJoints>(*context);
            inside.joints.retain(|kept| {
                joints.is_some_and(|all| all.impulse_joints.contains(joint_handle(kept.id)))
            });
            (*context, inside)
        }));
    }
}

fn take_element(row: &ElementRow, places: &[u32], world: &World) -> KeptElement {
    // Fields that are not kept are found anew from the components.
    let RareElement {
        serial,
        ties: _,
        guide: _,
        held: _,
        places: ends,
        facings: _,
        leapt,
        angle,
        jump,
        scales,
        controller: _,
    } = *row.rare;
    let on = |end: usize| row.movable(end).map_or(NONE, |body| places[body]);
    KeptElement {
        entity: row.entity,
        on: [on(0), on(1)],
        numbers: [row.numbers.stiffness, row.numbers.damping],
        rest_length: row.numbers.rest_length,
        flags: row.flags & ElementFlags::KEPT,
        ledger: row.ledger,
        readout: world
            .get::<SpringReadout>(row.entity)
            .copied()
            .unwrap_or_default(),
        inside: row
            .inside
            .as_deref()
            .map(|inside| Box::new(KeptInside::of(inside))),
        memory: Memory {
            serial,
            direction: row.direction(),
            length: row.length,
            controller: row.rare.controller(),
            places: ends,
            leapt,
            angle,
            facings: row.rare.facings(),
            scales: scales.map(|scale| Some(scale?.as_dvec3())),
            jump,
        },
    }
}

/// Reads a body. All fields are named, one per line, so that no field is forgotten.
fn take_body(row: &BodyRow, world: &World) -> KeptBody {
    let BodyRow {
        entity,
        id: _,
        flags,
        // These are in the components when a tick is over.
        given: _,
        share_force: _,
        user_force: _,
        clear,
        ref rare,
    } = *row;
    let RareBody {
        context: _,
        group: _,
        slot: _,
        rank,
        signature: _,
        center: _,
        rest,
        lingers,
        user_torque: _,
        share_torque: _,
        raised,
        stiffness: _,
        substep,
        now,
        searched,
        pulled,
        turned,
    } = **rare;
    let load = world.get::<SpringLoad>(entity);
    let both = |wrench: &Wrench| [wrench.force, wrench.torque];
    KeptBody {
        entity,
        rank,
        flags: flags & BodyFlags::KEPT,
        raised_iterations: load.is_some_and(SpringLoad::raised_iterations),
        lingers,
        clear,
        user: both(&row.user()),
        elements: load.map_or_else(Default::default, |load| both(&wrench(&load.elements))),
        now,
        searched,
        rest,
        raised,
        substep,
        pulled,
        turned,
    }
}
