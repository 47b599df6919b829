use bevy::prelude::*;

/// The ends of an element by the names of their entities, for what cannot know an [`Entity`]: scene files, editors,
/// Bevy's remote protocol. Put it beside an element made without ends, such as [`Spring::default`](crate::Spring).
///
/// Before the step both names are looked for, and the entities found are written into the element's `body_a` and
/// `body_b`. The search starts at the element itself and goes up its parents; the first of them with something of that
/// name on it or below it decides, so two instances of one scene do not mix. Only then the whole world counts. Of
/// entities that share a name and stand below each other, the topmost is meant, as importers name a mesh after its object.
///
/// Where a name is missing, or several entities have it with equal right, the element has a
/// [`SpringFault`](crate::SpringFault) that says so, which goes by itself once the name is found. An end that is despawned
/// is looked for again. An empty name leaves its end as the element has it.
///
/// It cannot be changed in place: insert it again, and both ends are looked for anew.
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

/// Stands on an element whose ends by name are not found yet, so that the engine leaves it out.
#[derive(Component, Clone, Copy, Debug, Default)]
#[component(clone_behavior = Ignore)]
pub(crate) struct AwaitsEnds;
