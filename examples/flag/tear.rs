//! Removes what has come loose: cells without an edge, threads across them, and points that the wind has carried
//! away.

use super::cloth::{Flag, Point, Thread, edges_of, triangles};
use super::findings::Seen;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use stage::Skin;
use std::collections::HashSet;

/// Distance from the pole beyond which points are removed, m.
const FAR: f32 = 2.2;
/// Height below which points are removed, m.
const LOW: f32 = 0.6;

/// Records a broken thread.
pub fn snap(
    broke: On<SpringBroke>,
    threads: Query<(&Thread, &Breakable)>,
    mut flag: ResMut<Flag>,
    mut seen: ResMut<Seen>,
) {
    if let Ok((thread, limit)) = threads.get(broke.entity) {
        flag.torn.insert(thread.ends);
        seen.broke.push(broke.force.abs() / limit.force);
    }
}

/// Removes points that are far from the pole.
pub fn carry_off(
    points: Query<(Entity, &Point, &Transform)>,
    threads: Query<(Entity, &Thread)>,
    mut flag: ResMut<Flag>,
    mut commands: Commands,
) {
    let mut gone = HashSet::new();
    for (entity, point, at) in &points {
        if at.translation.x > FAR || at.translation.y < LOW || at.translation.z.abs() > FAR {
            commands.entity(entity).despawn();
            gone.insert(point.0);
        }
    }
    if gone.is_empty() {
        return;
    }
    for (entity, thread) in &threads {
        if thread.ends.iter().any(|end| gone.contains(end)) {
            commands.entity(entity).despawn();
            flag.torn.insert(thread.ends);
        }
    }
    let flag = &mut *flag;
    flag.cells
        .retain(|cell| !cell.iter().any(|i| gone.contains(i)));
}

/// Removes cells and threads that depended on a torn edge.
pub fn fray(
    mut flag: ResMut<Flag>,
    mut before: Local<usize>,
    threads: Query<(Entity, &Thread)>,
    mut skins: Query<&mut Skin>,
    mut commands: Commands,
) {
    if flag.torn.len() == std::mem::replace(&mut *before, flag.torn.len()) {
        return;
    }
    let Flag { torn, cells, .. } = &mut *flag;
    cells.retain(|cell| !edges_of(*cell).iter().any(|edge| torn.contains(edge)));
    for (entity, thread) in &threads {
        if thread.over.iter().any(|edge| torn.contains(edge)) {
            commands.entity(entity).try_despawn();
        }
    }
    for mut skin in &mut skins {
        skin.triangles = triangles(cells);
    }
}
