//! Companions and looks on an entity without an element do nothing. A warning says so once.
//!
//! Observers notice them when they are added, so a world in which nothing is added pays nothing.

use crate::compat::Added;
use crate::input::parts::{IsElement, IsLinear};
use bevy::ecs::component::ComponentId;
use bevy::ecs::entity::{EntityHashMap, EntityHashSet};
#[cfg(feature = "visual")]
use bevy::ecs::entity_disabling::Disabled;
#[cfg(feature = "visual")]
use bevy::ecs::query::Allow;
use bevy::prelude::*;

/// Number of ticks that an entity has to get its element, or an end to get its place, before a warning is logged. Pinned by
/// `strays::companions_without_an_element_are_told_once_for_each_entity`.
pub(super) const GRACE: u8 = 4;

/// What a stray component is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Role {
    /// It changes what an element does.
    Companion,
    /// It draws a linear element.
    #[cfg_attr(not(feature = "visual"), allow(dead_code))]
    Look,
    /// It draws a torsion element.
    #[cfg_attr(not(feature = "visual"), allow(dead_code))]
    Spiral,
}

/// Entities with a companion or a look that had no suitable element when the component was added.
#[derive(Resource, Debug, Default)]
pub(crate) struct Strays {
    waiting: EntityHashMap<Stray>,
    told: EntityHashSet,
    /// Skins that got a parent, and the number of ticks that it has left to become a linear element.
    #[cfg(feature = "visual")]
    skins: EntityHashMap<u8>,
    /// `Some(false)` once there is something to draw; `Some(true)` once it was checked that a plugin draws it.
    #[cfg(feature = "visual")]
    undrawn: Option<bool>,
}

#[derive(Clone, Debug, Default)]
struct Stray {
    names: Vec<&'static str>,
    looks: Vec<&'static str>,
    spirals: Vec<&'static str>,
    left: u8,
}

#[cfg(feature = "visual")]
impl Strays {
    /// Notices a skin that got a parent, which may be no element.
    pub(crate) fn notice_skin(&mut self, skin: Entity) {
        if !self.told.contains(&skin) {
            self.skins.insert(skin, GRACE);
        }
    }

    /// Warns about skins whose parent is still no linear element.
    fn tell_skins(
        &mut self,
        skins: &Query<Skin, With<crate::SpringSkin>>,
        elements: &Query<(), IsDrawnOn>,
    ) {
        let Self {
            skins: waiting,
            told,
            ..
        } = self;
        waiting.retain(|&skin, left| {
            let Ok((parent, name)) = skins.get(skin) else {
                return false;
            };
            let parent = parent.parent();
            if elements.contains(parent) {
                return false;
            }
            *left -= 1;
            if *left > 0 {
                return true;
            }
            told.insert(skin);
            log::warn!(
                "{}: SpringSkin: its parent {parent} is no Spring, Damper or SpringDamper, so it is not drawn; make it \
                 a child of one",
                who(skin, name)
            );
            false
        });
    }
}

/// Parent and name of a skin.
#[cfg(feature = "visual")]
type Skin = (&'static ChildOf, Option<&'static Name>);

/// Filter: a linear element, also a disabled one.
#[cfg(feature = "visual")]
type IsDrawnOn = (IsLinear, Allow<Disabled>);

/// How a message calls an entity, as those of faults do.
pub(crate) fn who(entity: Entity, name: Option<&Name>) -> String {
    name.map_or_else(|| entity.to_string(), |name| format!("{name}, {entity}"))
}

/// Id of a type of component, and its name in messages.
pub(crate) type Kind = (ComponentId, &'static str);

/// Returns the kind of the component `C`.
pub(crate) fn kind<C: Component>(app: &mut App) -> Kind {
    let path = std::any::type_name::<C>();
    let name = path.rsplit("::").next().unwrap_or(path);
    (app.world_mut().register_component::<C>(), name)
}

/// Makes an app notice components of these kinds on an entity without a suitable element.
pub(crate) fn notice(app: &mut App, role: Role, kinds: Vec<Kind>) {
    let ids: Vec<ComponentId> = kinds.iter().map(|kind| kind.0).collect();
    let observer = move |added: Added<()>,
                         elements: Query<(), IsElement>,
                         linear: Query<(), IsLinear>,
                         mut strays: ResMut<Strays>| {
        let entity = added.entity;
        #[cfg(feature = "visual")]
        if role != Role::Companion {
            strays.undrawn.get_or_insert(false);
        }
        let at_home = match role {
            Role::Companion => elements.contains(entity),
            Role::Look => linear.contains(entity),
            Role::Spiral => elements.contains(entity) && !linear.contains(entity),
        };
        if at_home || strays.told.contains(&entity) {
            return;
        }
        let stray = strays.waiting.entry(entity).or_insert(Stray {
            names: Vec::new(),
            looks: Vec::new(),
            spirals: Vec::new(),
            left: GRACE,
        });
        let list = match role {
            Role::Companion => &mut stray.names,
            Role::Look => &mut stray.looks,
            Role::Spiral => &mut stray.spirals,
        };
        // All that was added at once.
        for id in added.trigger().components {
            if let Some((_, name)) = kinds.iter().find(|kind| kind.0 == *id)
                && !list.contains(name)
            {
                list.push(name);
            }
        }
    };
    app.world_mut()
        .spawn(Observer::new(observer).with_components(ids));
}

/// Whether there is anything to check.
pub(crate) fn any_strays(strays: Res<Strays>) -> bool {
    #[cfg(feature = "visual")]
    if strays.undrawn == Some(false) || !strays.skins.is_empty() {
        return true;
    }
    !strays.waiting.is_empty()
}

#[cfg(feature = "visual")]
impl Strays {
    /// Warns once about looks that nothing draws.
    fn tell_undrawn(&mut self, is_drawn: bool) {
        if self.undrawn != Some(false) {
            return;
        }
        self.undrawn = Some(true);
        if !is_drawn {
            log::warn!(
                "bevy_coilover: there is a Coil, a Telescope or a TorsionCoil, but CoiloverVisualPlugin is missing, so nothing \
                 is drawn; add CoiloverPlugins instead of CoiloverPlugin (without a window, ignore this)"
            );
        }
    }
}

/// Warns about components that still have no element.
pub(crate) fn tell_strays(
    mut strays: ResMut<Strays>,
    elements: Query<(), IsElement>,
    linear: Query<(), IsLinear>,
    entities: Query<Option<&Name>>,
    #[cfg(feature = "visual")] drawn: Option<Res<crate::visual::IsDrawn>>,
    #[cfg(feature = "visual")] skins: Query<Skin, With<crate::SpringSkin>>,
    #[cfg(feature = "visual")] drawn_on: Query<(), IsDrawnOn>,
) {
    let strays = &mut *strays;
    #[cfg(feature = "visual")]
    strays.tell_skins(&skins, &drawn_on);
    #[cfg(feature = "visual")]
    strays.tell_undrawn(drawn.is_some());
    let Strays { waiting, told, .. } = strays;
    told.retain(|entity| entities.contains(*entity));
    waiting.retain(|&entity, stray| {
        let Ok(name) = entities.get(entity) else {
            return false;
        };
        let is_element = elements.contains(entity);
        let is_linear = linear.contains(entity);
        let misplaced = if is_linear {
            &stray.spirals
        } else {
            &stray.looks
        };
        if is_element && misplaced.is_empty() {
            return false;
        }
        stray.left -= 1;
        if stray.left > 0 {
            return true;
        }
        told.insert(entity);
        let who = who(entity, name);
        if is_element {
            let looks = misplaced.join(", ");
            let (on, other) = if is_linear {
                ("linear", "Coil or Telescope")
            } else {
                ("torsion", "TorsionCoil")
            };
            log::warn!("{who}: {looks} cannot draw a {on} element; use a {other}");
        } else {
            let all = [&stray.names[..], &stray.looks[..], &stray.spirals[..]]
                .concat()
                .join(", ");
            log::warn!(
                "{who}: {all} on an entity without an element, which does nothing; put it on the \
                 entity that has the Spring, Damper, SpringDamper or torsion element"
            );
        }
        false
    });
}
