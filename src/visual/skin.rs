use bevy::prelude::*;

/// On a child of a [`Spring`](crate::Spring), [`Damper`](crate::Damper) or [`SpringDamper`](crate::SpringDamper):
/// whatever the child draws, with any mesh and any material, is placed between the ends of the element. Its +Y points
/// from end A to end B, and it is scaled along that axis. Beside a [`Telescope`](crate::Telescope) with fittings or a coil, it stands
/// between the spring seats, as a coil does. Its own children, such as the meshes of a node from a glTF file,
/// go with it.
///
/// The mesh must stand on its origin: its foot at y = 0, its top at y = [`length`](Self::length). Bevy's cylinder has
/// its middle at the origin, unless it is made with `CylinderAnchor::Bottom`. The element gets the `Transform` and
/// `Visibility` that a parent of drawn entities needs. The render layers of the child stay yours: those of the element
/// are not copied to it.
///
/// If `length` is not from 1e-5 to 1e12 m, or the entity has no parent, a warning is logged and the child is not
/// placed until that is mended. A warning is also logged if the parent is no such element. The child is not drawn until the
/// parent is one.
///
/// While the element is [disabled](bevy::ecs::entity_disabling::Disabled), the child is not drawn.
///
/// Once this component is removed, the child goes where its own `Transform` says.
///
/// Such scaling flattens or thickens the wire of a mesh; that of a [`Coil`](crate::Coil) stays round.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_coilover::{Helix, Spring, SpringSkin};
/// # fn setup(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>,
/// #     mut materials: ResMut<Assets<StandardMaterial>>) {
/// # let (a, b) = (Entity::PLACEHOLDER, Entity::PLACEHOLDER);
/// let mesh = meshes.add(Helix::new(0.1, 0.01, 8.0, 1.0));
/// let brass = materials.add(Color::srgb(0.7, 0.5, 0.2));
/// commands.spawn((
///     Spring::new(a, b),
///     children![(SpringSkin { length: 1.0 }, Mesh3d(mesh), MeshMaterial3d(brass))],
/// ));
/// # }
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[require(Transform, Visibility)]
pub struct SpringSkin {
    /// Height of the mesh, from its foot at the origin, when it is not scaled, m.
    pub length: f32,
}

impl Default for SpringSkin {
    fn default() -> Self {
        Self { length: 1.0 }
    }
}
