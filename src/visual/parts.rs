//! The drawn children of an element: spawned when its looks are added or changed, and removed with them.

use super::coil::Coil;
use super::helix::is_size;
use super::layout::{Layout, Part, SHORT};
use super::made::{Made, Maker};
use super::place::{Line, Lines, Placement};
use super::round_wire::RoundWireMaterial;
use super::shapes::{CoilMeshes, Finish, Shapes};
use super::skin::SpringSkin;
use super::telescope::Telescope;
use super::twist::{Twist, Winding};
use crate::input::strays::Strays;
use bevy::asset::{Assets, Handle};
use bevy::camera::visibility::RenderLayers;
use bevy::color::Color;
use bevy::ecs::entity::EntityHashSet;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::ecs::system::SystemParam;
use bevy::mesh::{Mesh, Mesh3d};
use bevy::pbr::{MeshMaterial3d, StandardMaterial};
use bevy::prelude::*;

/// The meshes of a drawn coil, one for each level of detail.
#[derive(Component, Clone, Debug)]
pub(super) struct Levels(pub CoilMeshes);

/// What is needed to make parts.
#[derive(SystemParam)]
pub(super) struct Workshop<'w, 's> {
    maker: Maker<'w, 's, Part>,
    shapes: ResMut<'w, Shapes>,
    meshes: ResMut<'w, Assets<Mesh>>,
    materials: ResMut<'w, Assets<StandardMaterial>>,
    wires: ResMut<'w, Assets<RoundWireMaterial>>,
    children: Query<'w, 's, &'static Children>,
    painted: Query<'w, 's, (&'static Part, &'static mut MeshMaterial3d<StandardMaterial>)>,
    wired: Query<'w, 's, &'static mut MeshMaterial3d<RoundWireMaterial>>,
}

/// The looks for which an element's parts were made, with sizes in metres.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
// A copy of the element makes its own parts.
#[component(clone_behavior = Ignore)]
pub(super) struct Worn {
    coil: Option<Coil>,
    telescope: Option<Telescope>,
    /// Whether there are parts: not for looks that cannot be drawn.
    has_parts: bool,
}

impl Worn {
    /// Whether it differs from other looks in colours at most, and no parts are lost.
    fn is_shaped_as(&self, other: &Self) -> bool {
        let without_colors = |looks: &Self| Self {
            coil: looks.coil.map(|coil| coil.with_color(Color::NONE)),
            telescope: looks.telescope.map(|t| t.with_color(Color::NONE)),
            ..*looks
        };
        without_colors(self) == without_colors(other)
    }
}

pub(super) const STEEL: Color = Color::srgb(0.78, 0.79, 0.82);
const RUBBER: Color = Color::srgb(0.05, 0.05, 0.05);

impl Workshop<'_, '_> {
    fn coil(&mut self, element: Entity, coil: &Coil) {
        let levels = self.shapes.coil(coil, &mut self.meshes);
        let wire = self.shapes.wire(coil, &mut self.wires);
        let mesh = Mesh3d(levels[0].clone());
        let looks = (mesh, Levels(levels), MeshMaterial3d(wire));
        self.maker.make(element, Part::Coil, looks);
    }

    fn solid(&mut self, element: Entity, part: Part, mesh: Handle<Mesh>, paint: (Color, Finish)) {
        let material = self.shapes.paint(paint.0, paint.1, &mut self.materials);
        let looks = (Mesh3d(mesh), MeshMaterial3d(material));
        self.maker.make(element, part, looks);
    }

    /// Gives other colours to the parts of an element.
    fn paint(&mut self, element: Entity, looks: &Worn) {
        let wire = looks
            .coil
            .map(|coil| self.shapes.wire(&coil, &mut self.wires));
        let enamel = looks.telescope.map(|telescope| {
            let color = telescope.color;
            self.shapes
                .paint(color, Finish::Enamel, &mut self.materials)
        });
        for child in self.children.get(element).into_iter().flatten() {
            if let (Some(wire), Ok(mut of)) = (&wire, self.wired.get_mut(*child)) {
                of.0 = wire.clone();
            }
            if let (Some(enamel), Ok((Part::Tube | Part::Collar | Part::EyeA, mut of))) =
                (&enamel, self.painted.get_mut(*child))
            {
                of.0 = enamel.clone();
            }
        }
    }

    fn telescope(&mut self, element: Entity, telescope: &Telescope, with_seats: bool) {
        let round = self.shapes.cylinder(&mut self.meshes);
        let (enamel, steel) = ((telescope.color, Finish::Enamel), (STEEL, Finish::Steel));
        let mut round_part = |part, paint| self.solid(element, part, round.clone(), paint);
        round_part(Part::Tube, enamel);
        round_part(Part::Collar, enamel);
        round_part(Part::Rod, steel);
        if telescope.bump_rubber {
            round_part(Part::Bump, (RUBBER, Finish::Rubber));
        }
        if with_seats {
            round_part(Part::SeatA, steel);
            round_part(Part::SeatB, steel);
        }
        if telescope.eyes {
            let eye = self.shapes.eye(&mut self.meshes);
            self.solid(element, Part::EyeA, eye.clone(), enamel);
            self.solid(element, Part::EyeB, eye, steel);
        }
    }
}

/// Drops looks that cannot be drawn, and logs why.
fn sound<L>(
    element: Entity,
    name: &str,
    looks: Option<L>,
    check: impl Fn(&L) -> Result<(), String>,
) -> Option<L> {
    let looks = looks?;
    match check(&looks) {
        Ok(()) => Some(looks),
        Err(wrong) => {
            log::warn!("{element}: {name}: {wrong}; it is not drawn until that is mended");
            None
        }
    }
}

/// Spawns, paints, replaces and removes the parts of elements.
pub(super) fn build(
    changed_coils: Query<Entity, Changed<Coil>>,
    changed_telescopes: Query<Entity, Changed<Telescope>>,
    mut no_coil: RemovedComponents<Coil>,
    mut no_telescope: RemovedComponents<Telescope>,
    mut enabled: RemovedComponents<Disabled>,
    mut looks: Query<(
        Line,
        Option<&Coil>,
        Option<&Telescope>,
        Option<&Worn>,
        &mut Placement,
    )>,
    lines: Lines,
    mut waiting: Local<EntityHashSet>,
    mut workshop: Workshop,
    mut commands: Commands,
) {
    // One query after the other: a single query for both takes twice as long.
    for element in &changed_coils {
        waiting.insert(element);
    }
    for element in &changed_telescopes {
        waiting.insert(element);
    }
    waiting.extend(no_coil.read());
    waiting.extend(no_telescope.read());
    // Its looks may have changed while it was disabled.
    waiting.extend(enabled.read().filter(|element| looks.contains(*element)));
    waiting.retain(|&element| {
        let Ok((line, coil, telescope, worn, mut placement)) = looks.get_mut(element) else {
            // Despawned, and its children with it.
            return false;
        };
        // Sizes may depend on the distance between the ends, so the ends must exist.
        let length = lines.ends(&line).map(|ends| ends.from.distance(ends.to));
        // Ends that coincide give no sizes, unless the sizes are already known.
        let tells = |length: &f32| length.is_finite() && (*length > SHORT || placement.is_drawn());
        let length = length.filter(tells);
        // Without looks nothing is drawn, so the length of this moment says nothing about later looks.
        let bare = coil.is_none() && telescope.is_none();
        let first = if bare {
            Some(0.0)
        } else {
            let known = length.map(|length| placement.first(length));
            known.or(placement.known_first())
        };
        let Some(first) = first else {
            return true;
        };
        let mut looks = Worn {
            coil: coil.map(|c| c.at(first)),
            telescope: telescope.map(|t| t.at(first)),
            has_parts: workshop.maker.has(element),
        };
        // A game may write the looks in every frame, above all their colours.
        if let Some(worn) = worn.filter(|worn| worn.is_shaped_as(&looks)) {
            if *worn != looks {
                workshop.paint(element, &looks);
                commands.entity(element).try_insert(looks);
            }
            return false;
        }
        workshop.maker.clear(element);
        let coil = sound(element, "Coil", looks.coil, |c| {
            c.helix(1.0).check().map_err(|e| e.to_string())
        });
        let telescope = sound(element, "Telescope", looks.telescope, Telescope::check);
        placement.dress(Layout::new(coil.as_ref(), telescope.as_ref(), first));
        if let Some(coil) = &coil {
            workshop.coil(element, coil);
        }
        if let Some(telescope) = &telescope {
            workshop.telescope(element, telescope, coil.is_some());
        }
        looks.has_parts = coil.is_some() || telescope.is_some();
        commands.entity(element).try_insert(looks);
        false
    });
}

/// Removes the parts of elements that were disabled: parts are entities of their own, and would stay visible.
pub(super) fn hide_disabled(
    disabled: Query<Entity, (Added<Disabled>, HasParts, Allow<Disabled>)>,
    mut maker: Maker<Made>,
) {
    for element in &disabled {
        maker.clear(element);
    }
}

/// Removes parts that came back with a saved world. They have lost what is not reflected, and their element makes new ones.
pub(super) fn drop_loaded(
    loaded: Query<Entity, (Added<Made>, Without<Part>, Without<Winding>)>,
    mut commands: Commands,
) {
    for part in &loaded {
        commands.entity(part).try_despawn();
    }
}

/// Copies the render layers of an element to its parts, where they have changed or were removed.
pub(super) fn hand_on_layers(
    changed: Query<Entity, (Changed<RenderLayers>, HasParts)>,
    mut removed: RemovedComponents<RenderLayers>,
    mut maker: Maker<Made>,
) {
    for element in changed.iter().chain(removed.read()) {
        maker.put_on_layers(element);
    }
}

/// Filter: an element that has parts.
type HasParts = Or<(With<Placement>, With<Twist>)>;

/// Filter: a skin that has changed or that has another parent.
type Altered = (
    With<SpringSkin>,
    Or<(Changed<SpringSkin>, Changed<ChildOf>)>,
);

/// Takes in the skins that users bring along for an element, and releases entities that are no longer skins.
pub(super) fn take_skins(
    changed: Query<Entity, Altered>,
    skins: Query<(&SpringSkin, Option<&ChildOf>)>,
    mut enabled: RemovedComponents<Disabled>,
    mut removed: RemovedComponents<SpringSkin>,
    bare: Query<(), (With<Part>, Without<SpringSkin>, Allow<Disabled>)>,
    // Only the plugin for physics has it.
    mut strays: Option<ResMut<Strays>>,
    mut commands: Commands,
) {
    for entity in removed.read().filter(|entity| bare.contains(*entity)) {
        let_go(entity, &mut commands);
    }
    // It may have changed while it was disabled.
    let enabled = enabled.read().filter(|entity| !changed.contains(*entity));
    for entity in changed.iter().chain(enabled) {
        let Ok((skin, parent)) = skins.get(entity) else {
            continue;
        };
        let Some(parent) = parent else {
            log::warn!("{entity}: SpringSkin: it must be a child of an element; it is not placed");
            continue;
        };
        // A shorter mesh would be scaled beyond what f32 holds.
        if !is_size(skin.length) || skin.length < SHORT {
            log::warn!(
                "{entity}: SpringSkin: length is {}, and must be from {SHORT} to 1e12 m; it is not placed",
                skin.length
            );
            let_go(entity, &mut commands);
            continue;
        }
        if let Some(strays) = &mut strays {
            strays.notice_skin(entity);
        }
        // The element may be despawned in the same frame, and the skin with it.
        commands
            .entity(entity)
            .try_insert(Part::Custom(skin.length));
        commands
            .entity(parent.parent())
            .try_insert_if_new((
                Placement::default(),
                Transform::default(),
                Visibility::default(),
            ))
            .queue_silenced(|mut element: EntityWorldMut| {
                if let Some(mut placement) = element.get_mut::<Placement>() {
                    placement.recall();
                }
            });
    }
}

/// Releases an entity that was placed between the ends, so that it goes where its own `Transform` says.
fn let_go(skin: Entity, commands: &mut Commands) {
    let mut skin = commands.entity(skin);
    // Transform propagation skipped the entity while it was placed here. It would stay there until its `Transform`
    // changes.
    skin.remove::<Part>()
        .entry::<Transform>()
        .and_modify(|mut place| place.set_changed());
}
