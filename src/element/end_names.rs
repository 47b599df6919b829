use bevy::prelude::*;

/// Gives the ends of an element by the names of their entities, where an [`Entity`] is not known: in scene files,
/// editors, and Bevy's remote protocol. Put it beside an element that was made without ends, such as
/// [`Spring::default`](crate::Spring).
///
/// Before the step both names are looked up, and the entities found are written into `body_a` and `body_b` of the
/// element. The search starts at the element and goes up through its parents. The first of them that has the name, or
/// has a descendant with the name, decides, so two instances of one scene do not mix. If there is none, the whole world
/// is searched. If entities with the same name are descendants of each other, the topmost one counts, because importers
/// name a mesh after its object.
///
/// If no entity has the name, or several have it where the search ends, the element gets a
/// [`SpringFault`](crate::SpringFault) that says so. The fault is removed once the name is found. An end that is
/// despawned is looked up again. An empty name leaves that end of the element unchanged.
///
/// This component is immutable. To change a name, insert it again: both ends are then looked up again.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_coilover::prelude::*;
/// # fn hang(commands: &mut Commands) {
/// commands.spawn((Name::new("Hook"), Transform::default()));
/// commands.spawn((
///     SpringDamper::default().with_stiffness(200.0),
///     EndNames::new("Hook", "Lamp"), // the lamp may come later
/// ));
/// # }
/// ```
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[component(immutable)]
#[require(AwaitsEnds)]
#[type_path = "bevy_coilover"]
pub struct EndNames {
    /// Name of end A.
    #[cfg_attr(feature = "serialize", serde(default))]
    pub a: String,
    /// Name of end B.
    #[cfg_attr(feature = "serialize", serde(default))]
    pub b: String,
}

impl EndNames {
    /// Names of end A and end B.
    pub fn new(a: impl Into<String>, b: impl Into<String>) -> Self {
        Self {
            a: a.into(),
            b: b.into(),
        }
    }
}

/// Marks an element whose named ends are not found yet, so that the engine leaves it out.
#[derive(Component, Clone, Copy, Debug, Default)]
#[component(clone_behavior = Ignore)]
pub(crate) struct AwaitsEnds;
