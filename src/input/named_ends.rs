//! Looks up ends by name, before the step. Nothing here runs while no element waits for an end.

use crate::compat::{Added, Removed};
use crate::element::*;
use crate::input::lists::with_elements;
use crate::input::parts::IsElement;
use crate::input::say::{Stays, say};
use crate::readout::SpringReadout;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::system::{SystemParam, SystemState};
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use std::mem::take;

/// Most parents that are followed upwards: more than any real scene has. It keeps parents in a circle from hanging the
/// game. Pinned by `ends`.
pub(crate) const MOST_LEVELS: usize = 4096;

/// An entity and its ancestors, from below.
pub(crate) fn and_above<'a>(
    entity: Entity,
    parents: &'a Query<'a, '_, &ChildOf>,
) -> impl Iterator<Item = Entity> {
    let above = parents.iter_ancestors(entity).take(MOST_LEVELS);
    std::iter::once(entity).chain(above)
}

/// Filter: an element that the engine leaves out until its ends are found.
type Waits = (With<EndNames>, With<AwaitsEnds>, IsElement);

/// Changes that may resolve a name that was missing, or that several entities had.
#[derive(SystemParam)]
pub(crate) struct Chances<'w, 's> {
    names: Query<'w, 's, (), Or<(Changed<Name>, Changed<ChildOf>)>>,
    elements: Query<
        'w,
        's,
        (),
        (
            Waits,
            Or<(
                Changed<EndNames>,
                Changed<AwaitsEnds>,
                Changed<SpringReadout>,
            )>,
        ),
    >,
    news: ResMut<'w, NewsOfNames>,
}

/// Whether an entity has lost its name or its parent, or was disabled or enabled, since names were last looked up. Observers note
/// this, for removals are forgotten after a frame, and a frame may have no tick.
#[derive(Resource, Default)]
pub(crate) struct NewsOfNames(bool);

/// Adds what [`find_named_ends`] needs to an app.
pub(crate) fn watch(app: &mut App) {
    app.init_resource::<NewsOfNames>();
    let world = app.world_mut();
    let lost = [
        world.register_component::<Name>(),
        world.register_component::<ChildOf>(),
        world.register_component::<Disabled>(),
    ];
    let hidden = lost[2];
    world.spawn(Observer::new(lose).with_components(lost));
    world.spawn(Observer::new(hide).with_component(hidden));
}

fn lose(_: Removed<()>, news: Option<ResMut<NewsOfNames>>) {
    note(news);
}

fn hide(_: Added<()>, news: Option<ResMut<NewsOfNames>>) {
    note(news);
}

fn note(news: Option<ResMut<NewsOfNames>>) {
    if let Some(mut news) = news {
        news.0 = true;
    }
}

impl Chances<'_, '_> {
    /// Whether there was such a change since the last call.
    fn any(&mut self) -> bool {
        take(&mut self.news.0) || !self.names.is_empty() || !self.elements.is_empty()
    }
}

/// The names in the world, and the elements that wait for them.
#[derive(SystemParam)]
pub(crate) struct Look<'w, 's> {
    chances: Chances<'w, 's>,
    waiting: Query<'w, 's, (Entity, &'static EndNames), Waits>,
    named: Query<'w, 's, (Entity, &'static Name)>,
    parents: Query<'w, 's, &'static ChildOf>,
    given_up: Query<'w, 's, Entity, (With<AwaitsEnds>, Without<EndNames>)>,
}

/// The entities that have a name, at or below a place: one of them, and their number.
#[derive(Clone, Copy)]
struct Bearers {
    one: Entity,
    count: usize,
}

/// Bearers of the names that are looked up. The key is the place at or below which they are (`None` for the world) and
/// the number of the name.
type Index = HashMap<(Option<Entity>, usize), Bearers>;

/// An end that was found; `None` leaves the end as it is.
type End = Option<Entity>;

/// Looks up ends by name, if something has changed that may resolve one.
pub(crate) fn find_named_ends(
    world: &mut World,
    waiting: &mut QueryState<(), With<AwaitsEnds>>,
    look: &mut SystemState<Look>,
) {
    if waiting.iter(world).next().is_none() {
        // A look would count as one at changes that later elements wait for.
        return;
    }
    let Ok(mut look) = look.get_mut(world) else {
        return;
    };
    let given_up: Vec<_> = look.given_up.iter().collect();
    let found = if look.chances.any() {
        look.find_all()
    } else {
        Vec::new()
    };
    for entity in given_up {
        settle(world, entity);
    }
    for (entity, ends) in found {
        match ends {
            Ok(ends) => {
                tie(world, entity, ends);
                settle(world, entity);
            }
            Err(fault) => {
                if let Ok(mut element) = world.get_entity_mut(entity) {
                    say(&mut element, fault, Stays::UntilMended);
                }
            }
        }
    }
}

impl Look<'_, '_> {
    fn find_all(&self) -> Vec<(Entity, Result<[End; 2], SpringFault>)> {
        let mut wanted = HashMap::<&str, usize>::default();
        for (_, names) in &self.waiting {
            for name in [&names.a, &names.b] {
                let number = wanted.len();
                wanted.entry(name).or_insert(number);
            }
        }
        let mut index = Index::default();
        for (entity, name) in &self.named {
            if let Some(number) = wanted.get(name.as_str()) {
                self.enter(entity, *number, name, &mut index);
            }
        }
        let find = |entity, name: &str, field: &str| -> Result<End, SpringFault> {
            if name.is_empty() {
                return Ok(None);
            }
            let fault = |reason| SpringFault {
                entity,
                field: field.into(),
                reason,
            };
            let Some((place, bearers)) = self.bearers(entity, wanted[name], &index) else {
                return Err(fault(format!("names '{name}', which no entity has")));
            };
            if bearers.count > 1 {
                let count = bearers.count;
                let place = match place.map(|place| (place, self.named.get(place))) {
                    Some((_, Ok((_, name)))) => format!("below '{name}'"),
                    Some((place, Err(_))) => format!("below {place}"),
                    None => "of the world".into(),
                };
                return Err(fault(format!(
                    "names '{name}', which {count} entities {place} have; give each a name of its own"
                )));
            }
            Ok(Some(bearers.one))
        };
        let ends = |(entity, names): (Entity, &EndNames)| {
            let a = find(entity, &names.a, "EndNames::a");
            let b = find(entity, &names.b, "EndNames::b");
            (entity, a.and_then(|a| Ok([a, b?])))
        };
        self.waiting.iter().map(ends).collect()
    }

    /// Adds an entity to the bearers of its name: at its own place, and at all places above it up to the world. It stops
    /// before the first place above that has the same name.
    fn enter(&self, entity: Entity, number: usize, name: &Name, index: &mut Index) {
        let mut add = |place| {
            let bearers = index.entry((place, number)).or_insert(Bearers {
                one: entity,
                count: 0,
            });
            bearers.count += 1;
        };
        add(Some(entity));
        for above in and_above(entity, &self.parents).skip(1) {
            if self.named.get(above).is_ok_and(|(_, other)| other == name) {
                return;
            }
            add(Some(above));
        }
        add(None);
    }

    /// Returns the bearers of a name that are nearest to an element, and their place.
    fn bearers(
        &self,
        entity: Entity,
        number: usize,
        index: &Index,
    ) -> Option<(Option<Entity>, Bearers)> {
        and_above(entity, &self.parents)
            .map(Some)
            .chain([None])
            .find_map(|place| Some((place, *index.get(&(place, number))?)))
    }
}

/// Writes ends into an element, whichever component it is.
fn tie(world: &mut World, entity: Entity, ends: [End; 2]) {
    macro_rules! elements {
        ($($element:ident),*) => {$(
            if let Some(mut element) = world.get_mut::<$element>(entity) {
                element.set_changed();
                element.body_a = ends[0].unwrap_or(element.body_a);
                element.body_b = ends[1].unwrap_or(element.body_b);
            }
        )*};
    }
    with_elements!(elements);
}

/// Ends the waiting of an element, and removes its fault about names. The scene reports other faults.
fn settle(world: &mut World, entity: Entity) {
    if let Ok(mut element) = world.get_entity_mut(entity) {
        element.remove::<AwaitsEnds>();
        let fault = element.get::<SpringFault>();
        if fault.is_some_and(|fault| fault.field.starts_with("EndNames")) {
            element.remove::<SpringFault>();
        }
    }
}
