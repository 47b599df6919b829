//! Restarts a scene: automatically after its time, or on request.

use super::DT;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;
use bevy_coilover::prelude::*;

/// Schedule that spawns a scene, at the start and at every restart.
#[derive(ScheduleLabel, Clone, Debug, PartialEq, Eq, Hash)]
pub struct Begin;

/// Marks entities that survive a restart: camera and light.
#[derive(Component)]
pub struct Stays;

/// When the scene restarts.
#[derive(Resource)]
pub struct Again {
    /// Time of the scene at which it restarts, s.
    after: f32,
    /// Earliest time of the restart, s: later while a player interacts with the scene.
    not_before: f32,
    pub asked: bool,
    /// Number of restarts so far.
    pub times: u32,
}

impl Again {
    /// Delays the restart, because a player interacts with the scene at `now`, s.
    pub fn leave_time(&mut self, now: f32) {
        self.not_before = now + 8.0;
    }
}

/// Resets a resource at each start. The scene's other systems have it from the first tick.
pub fn fresh<R: Resource + Default>(mut commands: Commands) {
    commands.insert_resource(R::default());
}

/// Returns the number of ticks since the scene began; 1 in the first.
pub fn tick(time: &Time) -> u32 {
    (time.elapsed_secs() / DT).round() as u32
}

/// Runs [`Begin`] once.
pub(super) fn begin(app: &mut App) {
    app.init_schedule(Begin)
        .add_systems(Startup, |world: &mut World| world.run_schedule(Begin));
}

/// Restarts the scene every `after` seconds.
pub(super) fn repeat(app: &mut App, after: f32) {
    app.insert_resource(Again {
        after,
        not_before: 0.0,
        asked: false,
        times: 0,
    })
    // Within the tick, so that Rapier sees removed entities in the same tick, however many frames there are.
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
        // Children were despawned with their parents.
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
