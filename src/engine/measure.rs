//! After the engine's step: what each element shows.

use super::body::point_of;
use super::forces::SpringLoad;
use super::held::observe;
use super::memory::ElementMemory;
use super::scene::{ElementRow, Held, Scene, report};
use crate::element::{Spring, SpringDamper};
use crate::readout::SpringReadout;
use bevy::math::DVec3;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use bevy_rapier3d::rapier::dynamics::RigidBodyHandle;

/// Writes readouts, captured rest lengths, and faults found while solving.
pub(crate) fn measure(
    mut scene: ResMut<Scene>,
    sets: Query<&RapierRigidBodySet>,
    mut elements: Query<(
        &mut SpringReadout,
        &mut ElementMemory,
        Option<&mut Spring>,
        Option<&mut SpringDamper>,
    )>,
    contexts: Query<(&RapierContextSimulation, &RapierContextJoints)>,
    mut loads: Query<&mut SpringLoad>,
    mut commands: Commands,
) {
    let scene = &mut *scene;
    if scene.time <= 0.0 {
        return;
    }
    scene.step += 1;
    for row in &scene.bodies {
        let (Ok(set), Ok((simulation, joints)), Ok(mut load)) = (
            sets.get(row.context),
            contexts.get(row.context),
            loads.get_mut(row.entity),
        ) else {
            continue;
        };
        if let Some(body) = set.bodies.get(row.handle) {
            observe(&mut load, row.handle, body, simulation, joints);
        }
    }
    for row in &mut scene.elements {
        if row.parameters.rest_length.is_none() {
            // No movable body: it took no part in the solve.
            row.parameters.rest_length = Some(read_out(row, &sets, scene.time).length);
            row.captured = true;
        }
        let Ok((mut readout, mut memory, spring, pair)) = elements.get_mut(row.entity) else {
            continue;
        };
        report(row.entity, row.fault, &mut memory, &mut commands);
        memory.direction = row.direction;
        memory.step = scene.step;
        for (i, held) in row.held.iter().enumerate() {
            let place = match *held {
                Held::Path { to, .. } => to,
                Held::Body {
                    local,
                    movable: Some(_),
                    ..
                } => local,
                Held::Body {
                    handle,
                    context,
                    local,
                    ..
                } => point(&sets, context, handle, local).0,
            };
            memory.ends[i].place = Some((row.parameters.ends[i], place));
        }
        if row.captured && row.fault.is_none() {
            if let Some(mut spring) = spring {
                spring.rest_length = row.parameters.rest_length;
            }
            if let Some(mut pair) = pair {
                pair.rest_length = row.parameters.rest_length;
            }
        }
        let new = read_out(row, &sets, scene.time);
        if *readout != new {
            *readout = new;
        }
    }
}

/// Position and velocity of a point on a body.
fn point(
    sets: &Query<&RapierRigidBodySet>,
    context: Entity,
    handle: RigidBodyHandle,
    local: DVec3,
) -> (DVec3, DVec3) {
    sets.get(context)
        .ok()
        .and_then(|set| set.bodies.get(handle))
        .map_or((DVec3::ZERO, DVec3::ZERO), |body| point_of(body, local))
}

fn read_out(row: &ElementRow, sets: &Query<&RapierRigidBodySet>, time: f64) -> SpringReadout {
    let [a, b] = row.held.map(|held| match held {
        Held::Path { from, to } => (to, (to - from) / time),
        Held::Body {
            handle,
            context,
            local,
            ..
        } => point(sets, context, handle, local),
    });
    let d = b.0 - a.0;
    let length = d.length();
    let direction = if length > 0.0 {
        d / length
    } else {
        row.direction.unwrap_or(DVec3::ZERO)
    };
    let rate = (b.1 - a.1).dot(direction);
    let mut readout = SpringReadout {
        length: length as f32,
        rate: rate as f32,
        ..default()
    };
    if row.fault.is_none() {
        let p = &row.parameters;
        let (k, c) = (f64::from(p.stiffness), f64::from(p.damping));
        let stretch = length - f64::from(p.rest_length.unwrap_or(0.0));
        readout.spring_force = (k * stretch) as f32;
        readout.damper_force = (c * rate) as f32;
        readout.stored_energy = (0.5 * k * stretch * stretch) as f32;
        readout.dissipated_power = (c * rate * rate) as f32;
    }
    readout
}
