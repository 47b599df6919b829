use bevy::prelude::*;

/// On a child of a [`Spring`](crate::Spring), [`Damper`](crate::Damper) or
/// [`SpringDamper`](crate::SpringDamper): whatever it draws, with any mesh and any material, is laid
/// between the ends, its +Y from end A to end B, scaled along it.
///
/// The mesh has to stand on its origin: its foot at y = 0, its top at y = [`length`](Self::length). Bevy's cylinder, say,
/// has its middle there unless it is made with `CylinderAnchor::Bottom`. The element gets the `Transform` and `Visibility`
/// that a parent of drawn entities needs. Render layers stay yours: those of the element are not handed on to it.
///
/// Once this component is removed, the child stands where its own `Transform` says.
///
/// A mesh scaled like that flattens or fattens its wire; [`Coil`](crate::Coil) does not.
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
    /// Height of what is drawn, from its foot at the origin, where it is not scaled, m.
    pub length: f32,
}

impl Default for SpringSkin {
    fn default() -> Self {
        Self { length: 1.0 }
    }
}
