//! The system after Rapier's step. It reads the new state of all elements and writes their readouts.

use super::body::Bodies;
use crate::backend::Worlds;
use crate::input::parts::IsElement;
use crate::scene::show::{Readouts, Springs};
use crate::scene::state::Scene;
use crate::threads;
use bevy::ecs::system::NonSendMarker;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use bevy_rapier3d::rapier::dynamics::RigidBodySet;

/// Reads the positions of elements after the step, and writes their readouts.
pub(crate) fn measure(
    mut scene: ResMut<Scene>,
    sets: Query<(Entity, Ref<RapierRigidBodySet>)>,
    mut readouts: Readouts,
    mut springs: Query<Springs, IsElement>,
    mut commands: Commands,
    _on_main_thread: NonSendMarker,
) {
    // bevy_rapier's write-back marks every set as changed in every tick, so note that time.
    let changed = |context| sets.get(context).ok().map(|(_, set)| set.last_changed());
    scene.still.mark(changed);
    let all_asleep = !(scene.delivered || scene.immovable);
    if scene.time <= 0.0 || all_asleep {
        return;
    }
    let _awake = threads::Awake::new();
    scene.observe(&Sets::new(&sets));
    scene.show(&mut readouts, &mut springs, &mut commands);
}

/// The entity of a context, and its bodies.
type Set<'a> = (Entity, Bodies<&'a RigidBodySet>);

/// The bodies of all contexts after the step. Usually there is only one context.
struct Sets<'a> {
    first: Option<Set<'a>>,
    others: Vec<Set<'a>>,
}

impl<'a> Sets<'a> {
    fn new(sets: &'a Query<(Entity, Ref<RapierRigidBodySet>)>) -> Self {
        let mut all = sets.iter().map(|(context, set)| {
            let gravity = Vec3::ZERO;
            let set = &set.into_inner().bodies;
            (context, Bodies { set, gravity })
        });
        Self {
            first: all.next(),
            others: all.collect(),
        }
    }
}

impl<'a> Worlds for Sets<'a> {
    type Sight = Bodies<&'a RigidBodySet>;

    #[inline(always)]
    fn of(&self, context: Entity) -> Option<&Self::Sight> {
        let mut all = self.first.iter().chain(&self.others);
        all.find(|(of, _)| *of == context).map(|(_, set)| set)
    }
}
