//! Before the step: is the scene still the one we know? Mostly it is, and only what can move is read.

use super::check::{Fault, Parameters};
use super::companions::{Companion, Companions};
use super::ends::{Ends, Place};
use super::find::Finder;
use super::forces::SpringLoad;
use super::parts::{Acts, ChangedParts, Parts};
use super::report::report;
use super::rows::{BodyRow, ElementRow, Held};
use super::scene::Scene;
use super::watch::Watch;
use bevy::ecs::entity::EntityHashSet;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;

/// Finds elements, their ends and the bodies they load.
pub(crate) fn prepare(
    mut scene: ResMut<Scene>,
    elements: Query<Parts, Acts>,
    changed: Query<Entity, ChangedParts>,
    mut finder: Finder,
    mut loads: Query<
        (Option<&mut SpringLoad>, Option<&ExternalForce>),
        With<RapierRigidBodyHandle>,
    >,
    mut watch: Watch,
    mut companions: Companions,
    mut commands: Commands,
) {
    let scene = &mut *scene;
    let mut same = !watch.saw_change(scene);
    same &= !std::mem::take(&mut scene.stale);
    companions.look(scene.since.take());
    // What comes and goes is seen by the watch; this is for whatever else may take elements away.
    same &= elements.iter().len() == scene.elements.len();
    let is_new = |entity: &Entity| {
        let parts = elements.get(*entity);
        parts.is_ok_and(|parts| companions.is_new(&parts))
    };
    let changed = changed.iter().filter(is_new);
    let changed = changed.chain(std::mem::take(&mut scene.pending));
    same = same && refresh(scene, &elements, changed, &companions, &finder.ends);
    let modified = &watch.mass_modified;
    let Scene {
        elements: rows,
        faulty,
        ..
    } = scene;
    same = same
        && faulty.iter().all(|index| {
            let row = &mut rows[*index];
            still_faulty(row, &companions, &mut finder, modified, &mut commands)
        });
    scene.renewed = !same || (scene.renewed && scene.time <= 0.0);
    if same {
        return;
    }
    scene.renew(&elements, &companions, &mut finder, modified, &mut commands);
    enter_loads(scene, &mut loads, &finder, &mut commands);
}

/// Gives each body that elements load the components that show it, and reads which force is the user's.
fn enter_loads(
    scene: &mut Scene,
    loads: &mut Query<
        (Option<&mut SpringLoad>, Option<&ExternalForce>),
        With<RapierRigidBodyHandle>,
    >,
    finder: &Finder,
    commands: &mut Commands,
) {
    for (slot, row) in scene.bodies.iter_mut().enumerate() {
        let Ok((load, force)) = loads.get_mut(row.entity) else {
            continue;
        };
        let known = load.map(|mut load| {
            load.bypass_change_detection().slot = slot;
            load.user
        });
        if let (Some(user), true) = (known, force.is_some()) {
            row.user = user;
            continue;
        }
        let engine = finder.sets.get(row.context).ok().and_then(|(set, ..)| {
            let body = set.bodies.get(row.handle)?;
            Some(ExternalForce {
                force: body.user_force(),
                torque: body.user_torque(),
            })
        });
        // A force written to the engine alone belongs to the user too.
        let present = force.copied().or(engine).unwrap_or_default();
        row.user = known.unwrap_or(present);
        let mut entity = commands.entity(row.entity);
        if force.is_none() {
            entity.try_insert(present);
        }
        if known.is_none() {
            entity.try_insert(SpringLoad::new(present, slot));
        }
    }
}

/// Takes in changed numbers and moved ends; says whether the rows still fit the elements.
fn refresh(
    scene: &mut Scene,
    elements: &Query<Parts, Acts>,
    changed: impl Iterator<Item = Entity>,
    companions: &Companions,
    ends: &Ends,
) -> bool {
    let Scene {
        elements: rows,
        row_of,
        bodies,
        followed,
        changed: marked,
        assemblies,
        stepped,
        shifted,
        ..
    } = scene;
    // What changes while nothing is stepped is kept for the step that comes.
    marked.retain(|index| {
        let row = &mut rows[*index];
        row.changed = !row.has_acted(bodies, stepped);
        row.changed
    });
    if !stepped.is_empty() {
        *shifted = false;
    }
    for entity in changed.chain(companions.touched.iter().copied()) {
        // Anchors and companions can stand where no element is.
        let Ok(parts) = elements.get(entity) else {
            continue;
        };
        let Some(index) = row_of.get(&entity) else {
            return false;
        };
        let row = &mut rows[*index];
        if !std::mem::replace(&mut row.changed, true) {
            marked.push(*index);
        }
        let new = parts.parameters().and_then(|new| {
            new.check()?;
            Ok((companions.of(entity, &new)?, new))
        });
        if !new.is_ok_and(|new| refit(row, new, companions)) {
            return false;
        }
    }
    if !marked.is_empty() {
        for assembly in assemblies {
            assembly.read_anew();
        }
    }
    followed.iter().all(|(index, end)| {
        let row = &mut rows[*index];
        row.trouble.lasting().is_some() || follow(row, *end, ends, bodies, shifted)
    })
}

/// Gives an element new numbers and laws; says whether its row can be as it is otherwise.
fn refit(
    row: &mut ElementRow,
    (companion, parameters): (Companion, Parameters),
    companions: &Companions,
) -> bool {
    let entity = row.entity;
    if !parameters.is_held_like(&row.parameters)
        || companion.guide != row.companion.guide
        || companions.tuning(entity).is_some()
        || companions.pose(entity).is_some()
    {
        return false;
    }
    row.refitted |= parameters != row.parameters || companions.touched.contains(&entity);
    row.change(|row| {
        row.parameters = parameters;
        row.companion = companion;
    });
    true
}

/// Looks for an end again; says whether it is still the same kind of end, and if it has moved.
fn follow(
    row: &mut ElementRow,
    end: usize,
    ends: &Ends,
    bodies: &[BodyRow],
    shifted: &mut bool,
) -> bool {
    let p = &row.parameters;
    let found = ends.find(
        p.ends[end],
        p.anchors[end],
        p.names.ends[end],
        &mut row.memory.scales[end],
    );
    let on = row.movable(end);
    match (&mut row.held[end], found) {
        (
            Held::Body {
                handle,
                context,
                local,
            },
            Ok(Place::OnBody {
                handle: now_on,
                context: now_in,
                local: now_at,
                ..
            }),
        ) if *handle == now_on && *context == now_in => {
            if *local != now_at {
                // Whether it turns the body may have changed.
                if on.is_some_and(|b| !bodies[b].turns) {
                    return false;
                }
                *local = now_at;
                *shifted = true;
            }
            true
        }
        (Held::Path { from, to }, Ok(Place::Point(now))) => {
            // Where it was after the last step.
            *from = row.memory.places[end].unwrap_or(now);
            *to = now;
            *shifted |= from != to;
            true
        }
        _ => false,
    }
}

/// Looks at an inert element again; says whether it still is.
fn still_faulty(
    row: &mut ElementRow,
    companions: &Companions,
    finder: &mut Finder,
    modified: &EntityHashSet,
    commands: &mut Commands,
) -> bool {
    if row.trouble.lasting().is_none() || row.parameters.ends == Parameters::NONE.ends {
        return true;
    }
    match judge(row, companions, finder, modified) {
        Err(fault) => {
            row.trouble.set_lasting(Some(fault));
            report(row, commands);
            true
        }
        Ok(()) => false,
    }
}

/// What is wrong with an inert element now.
fn judge(
    row: &mut ElementRow,
    companions: &Companions,
    finder: &mut Finder,
    modified: &EntityHashSet,
) -> Result<(), Fault> {
    let (entity, mut parameters) = (row.entity, row.parameters);
    let guide = companions.of(entity, &parameters)?.guide;
    let found = finder.find(&parameters, guide, &mut row.memory.scales, modified)?;
    if let Some(tuning) = companions.tuning(entity) {
        finder.tune(tuning, guide, &found.places, &mut parameters)?;
        parameters.check()?;
    }
    if let Some(pose) = companions.pose(entity) {
        companions.hold(entity, pose, &parameters, guide, &found.places, finder)?;
    }
    Ok(())
}
