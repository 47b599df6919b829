//! Drawn children that the crate makes for an element. They are seen by the same cameras, and are removed with its
//! looks.

use bevy::camera::visibility::RenderLayers;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;

/// Marks a child that the crate made. A child that users bring along, such as a [`SpringSkin`](super::SpringSkin), does
/// not have it. It is reflected, so that children which a saved world brings back are known.
#[derive(Component, Reflect, Clone, Copy, Debug, Default)]
#[type_path = "bevy_coilover"]
#[reflect(Component, Default, Debug, Clone)]
pub(super) struct Made;

/// Makes children of elements and removes them. It handles the children of one kind, or all of them with [`Made`] as
/// the kind.
#[derive(SystemParam)]
pub(super) struct Maker<'w, 's, Kind: Component> {
    children: Query<'w, 's, &'static Children, Allow<Disabled>>,
    made: Query<'w, 's, (), (With<Kind>, With<Made>, Allow<Disabled>)>,
    layers: Query<'w, 's, &'static RenderLayers>,
    commands: Commands<'w, 's>,
}

impl<Kind: Component> Maker<'_, '_, Kind> {
    /// Spawns a child of an element.
    pub fn make(&mut self, element: Entity, kind: Kind, looks: impl Bundle) {
        let layers = self.layers.get(element).ok().cloned();
        self.commands.queue(move |world: &mut World| {
            // The element may be despawned in the same frame.
            if world.get_entity(element).is_err() {
                return;
            }
            let mut child = world.spawn((Made, kind, looks, ChildOf(element)));
            if let Some(layers) = layers {
                child.insert(layers);
            }
        });
    }

    /// Whether an element has made children.
    pub fn has(&self, element: Entity) -> bool {
        let children = self.children.get(element).into_iter().flatten();
        children.into_iter().any(|child| self.made.contains(*child))
    }

    /// Despawns the made children of an element.
    pub fn clear(&mut self, element: Entity) {
        for child in self.children.get(element).into_iter().flatten() {
            if self.made.contains(*child) {
                self.commands.entity(*child).despawn();
            }
        }
    }

    /// Puts the made children of an element on its render layers, because Bevy does not hand these on to children.
    pub fn put_on_layers(&mut self, element: Entity) {
        let layers = self.layers.get(element).ok();
        for child in self.children.get(element).into_iter().flatten() {
            if !self.made.contains(*child) {
                continue;
            }
            // The child may be despawned in the same frame.
            let mut child = self.commands.entity(*child);
            match layers {
                Some(layers) => child.try_insert(layers.clone()),
                None => child.try_remove::<RenderLayers>(),
            };
        }
    }
}
