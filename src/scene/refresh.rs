//! Updates existing rows at the start of a step if only parameters have changed or ends have moved.

use crate::backend::{Finder, Place, Stance};
use crate::input::check::{Fault, Parameters, Ties};
use crate::input::companions::{Companion, Companions};
use crate::input::parts::{Acts, Parts};
use crate::scene::report::report;
use crate::scene::rows::{BodyFlags, BodyRow, ElementFlags, ElementRow, Held};
use crate::scene::state::Scene;
use bevy::ecs::entity::EntityHashSet;
use bevy::prelude::*;

/// Reads changed parameters and moved ends. Returns whether the rows still fit the elements; if not, they must be made anew.
pub(crate) fn refresh(
    scene: &mut Scene,
    elements: &Query<Parts, Acts>,
    changed: impl Iterator<Item = Entity>,
    companions: &Companions,
    finder: &impl Finder,
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
    // A change while the context is not stepped is kept until its next step.
    marked.retain(|index| {
        let row = &mut rows[*index as usize];
        let waits = !row.has_acted(bodies, stepped);
        row.flags.set(ElementFlags::CHANGED, waits);
        waits
    });
    if !stepped.worlds.is_empty() {
        *shifted = false;
    }
    for entity in changed.chain(companions.touched.iter().copied()) {
        // Anchors and companion components may be on an entity that is no element.
        let Ok(parts) = elements.get(entity) else {
            continue;
        };
        let Some(index) = row_of.get(&entity) else {
            return false;
        };
        let row = &mut rows[*index as usize];
        if !row.has(ElementFlags::CHANGED) {
            row.flags.insert(ElementFlags::CHANGED);
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
        let (row, end) = (&mut rows[*index as usize], usize::from(*end));
        row.trouble.lasting().is_some() || follow(row, end, finder, bodies, shifted)
    })
}

/// Gives an element new parameters and laws. Returns whether the rest of its row is still valid.
fn refit(
    row: &mut ElementRow,
    (companion, parameters): (Companion, Parameters),
    companions: &Companions,
) -> bool {
    let entity = row.entity;
    if !parameters.ties.is_held_like(&row.rare.ties)
        || companion.guide != row.rare.guide
        || companions.tuning(entity).is_some()
        || companions.pose(entity).is_some()
    {
        return false;
    }
    if parameters != row.parameters() || companions.touched.contains(&entity) {
        row.flags.insert(ElementFlags::REFITTED);
    }
    row.change(|row| {
        row.set_parameters(parameters);
        row.set_companion(companion);
    });
    true
}

/// Looks for an end again and updates the row if the end has moved; then also sets `shifted`. Returns
/// whether the row is still valid.
fn follow(
    row: &mut ElementRow,
    end: usize,
    finder: &impl Finder,
    bodies: &[BodyRow],
    shifted: &mut bool,
) -> bool {
    let rare = &mut *row.rare;
    let found = finder.place(
        rare.ties.ends[end],
        rare.ties.anchors[end],
        rare.ties.names.ends[end],
        &mut rare.scales[end],
    );
    let on = row.movable(end);
    match (&mut row.rare.held[end], found) {
        (
            Held::Body {
                body,
                context,
                local,
            },
            Ok(Place::OnBody {
                body: now_on,
                context: now_in,
                local: now_at,
                ..
            }),
        ) if *body == now_on && *context == now_in => {
            if *local != now_at {
                // The element may turn the body now.
                if on.is_some_and(|b| !bodies[b].has(BodyFlags::TURNS)) {
                    return false;
                }
                *local = now_at;
                *shifted = true;
            }
            true
        }
        (Held::Path { from, to }, Ok(Place::Point(now))) => {
            // The path begins where the end was after the last step.
            *from = row.rare.places[end].unwrap_or(now);
            *to = now;
            *shifted |= from != to;
            true
        }
        _ => false,
    }
}

/// Checks an element with a fault again and reports its present fault. Returns false if the element has no fault any more.
pub(crate) fn still_faulty(
    row: &mut ElementRow,
    companions: &Companions,
    finder: &mut impl Finder,
    modified: &EntityHashSet,
    commands: &mut Commands,
) -> bool {
    if row.trouble.lasting().is_none() || row.rare.ties.ends == Ties::NONE.ends {
        return true;
    }
    let parameters = row.parameters();
    match judge(row, parameters, companions, finder, modified) {
        Err(fault) => {
            row.trouble.set_lasting(Some(fault));
            report(row, commands);
            true
        }
        Ok(_) => false,
    }
}

/// Whether the numbers that were computed for the coming step of an element are still those that its ends give.
pub(crate) fn still_computed(
    row: &mut ElementRow,
    elements: &Query<Parts, Acts>,
    companions: &Companions,
    finder: &mut impl Finder,
    modified: &EntityHashSet,
) -> bool {
    if row.trouble.lasting().is_some() {
        return true;
    }
    let parts = elements.get(row.entity).ok();
    let Some(given) = parts.and_then(|parts| parts.parameters().ok()) else {
        return false;
    };
    let written = companions.written_preload(row.entity);
    let computed = judge(row, given, companions, finder, modified);
    computed.is_ok_and(|(parameters, preload)| {
        parameters == row.parameters() && (preload.is_none() || preload == written)
    })
}

/// Checks an element with the given parameters as if it were new. Returns the parameters that its [`SpringTuning`] makes of
/// them, and the preload of its [`HoldPose`], N.
fn judge(
    row: &mut ElementRow,
    mut parameters: Parameters,
    companions: &Companions,
    finder: &mut impl Finder,
    modified: &EntityHashSet,
) -> Result<(Parameters, Option<f32>), Fault> {
    let entity = row.entity;
    let guide = companions.of(entity, &parameters)?.guide;
    let found = finder.find(&parameters, guide, &mut row.rare.scales, modified)?;
    let stance = Stance {
        guide,
        places: &found.places,
        angle: row.rare.angle,
    };
    if let Some(tuning) = companions.tuning(entity) {
        let allowed = companions.allowance(entity);
        finder.tune(tuning, &stance, allowed, &mut parameters)?;
        parameters.check()?;
    }
    let preload = match companions.pose(entity) {
        Some(pose) => Some(
            companions
                .hold(entity, pose, &parameters, &stance, finder)?
                .1,
        ),
        None => None,
    };
    Ok((parameters, preload))
}
