//! Scenes that start again: by themselves when they have shown what there is, or when asked to.

use super::DT;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;
use bevy_coilover::prelude::*;

/// Spawns a scene: at the start, and every time it starts again.
#[derive(ScheduleLabel, Clone, Debug, PartialEq, Eq, Hash)]
pub struct Begin;

/// On what stays when a scene starts again: camera and light.
#[derive(Component)]
pub struct Stays;

/// When the scene starts again.
#[derive(Resource)]
pub struct Again {
    /// At this second of its own time.
    after: f32,
    /// But not before this one: someone has it in hand.
    not_before: f32,
    pub asked: bool,
    /// How often it has.
    pub times: u32,
}

impl Again {
    /// Leaves whoever plays with the scene at `now` some time more.
    pub fn leave_time(&mut self, now: f32) {
        self.not_before = now + 8.0;
    }
}

/// Makes a resource new at each start; the scene's other systems have it from the first tick.
pub fn fresh<R: Resource + Default>(mut commands: Commands) {
    commands.insert_resource(R::default());
}

/// Ticks since the scene began; 1 in the first.
pub fn tick(time: &Time) -> u32 {
    (time.elapsed_secs() / DT).round() as u32
}

/// Runs [`Begin`] once.
pub(super) fn begin(app: &mut App) {
    app.init_schedule(Begin)
        .add_systems(Startup, |world: &mut World| world.run_schedule(Begin));
}

/// Starts the scene again after so many seconds, over and over.
pub(super) fn repeat(app: &mut App, after: f32) {
    app.insert_resource(Again {
        after,
        not_before: 0.0,
        asked: false,
        times: 0,
    })
    // Within the tick: the engine hears of what is gone in the same one, however many frames there are.
    .add_systems(FixedFirst, start_again);
}

fn start_again(world: &mut World) {
    let now = world.resource::<Time>().elapsed_secs();
    let mut again = world.resource_mut::<Again>();
    if !again.asked && now < again.after.max(again.not_before) + 0.5 * DT {
        return;
    }
    again.asked = false;
    again.not_before = 0.0;
    again.times += 1;
    let mut scene = world.query_filtered::<Entity, (
        Or<(With<Transform>, With<SpringReadout>, With<Coil>)>,
        Without<Stays>,
    )>();
    let gone: Vec<Entity> = scene.iter(world).collect();
    for entity in gone {
        // Children went with their parents.
        if let Ok(entity) = world.get_entity_mut(entity) {
            entity.despawn();
        }
    }
    // This is the scene's first tick.
    let mut fixed = Time::<Fixed>::from_seconds(f64::from(DT));
    fixed.advance_by(fixed.timestep());
    fixed.accumulate_overstep(world.resource::<Time<Fixed>>().overstep());
    world.insert_resource(fixed);
    *world.resource_mut::<Time>() = fixed.as_generic();
    world.run_schedule(Begin);
}
